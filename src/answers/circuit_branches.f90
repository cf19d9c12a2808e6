!> Branches, dead points, assemblies and change points of the circuits of a mechanism.
module circuit_branches
   use kinds, only: wp
   use planar, only: pi
   use motion, only: diagnostic_t, diagnostic_limit
   use curve_equations, only: curve_t, drive_value, deck_position
   use circuit_curve, only: curve_point_t, same_place
   use assemblies, only: assembly_t, number_of
   use circuit_trace, only: circuit_t, find_root, of_value, end_closed
   implicit none
   private
   public :: circuits_t, circuit_branch_t, no_sign, dead_point_t, circuit_assembly_t, meeting_t
   public :: add_branches, add_assemblies, add_meetings, number_assemblies, turns_of, find_level, max_circuits

   real(wp), parameter :: turn = 2.0_wp*pi
   !> More than rounding of an angle in turns: ties between whole turns always fall on one side.
   real(wp), parameter :: tie = 1.0e-6_wp
   !> A drive's value is that of a point up to this difference, in rad and lengths.
   real(wp), parameter :: rounding = 1.0e3_wp*epsilon(1.0_wp)

   integer, parameter :: no_sign = 2
   !> More circuits are not looked for.
   integer, parameter :: max_circuits = 100

   !> A piece of a circuit between dead points.
   type :: circuit_branch_t
      integer :: circuit = 0
      integer :: first = 0, last = 0           !< its first and last point on the circuit
      integer :: dead(2) = 0                   !< the dead points at its least and greatest value; 0: none
      real(wp) :: range(2) = 0.0_wp            !< the drive's least and greatest value on it (rad or deck's length)
      !> Of the Jacobian's determinant; 0: it changes, at change points; no_sign: there are too many equations.
      integer :: sign = 0
   end type circuit_branch_t

   type :: dead_point_t
      integer :: circuit = 0
      type(diagnostic_t) :: limit              !< its links, where they are known, and the drive's value
   end type dead_point_t

   !> An assembly at the drive's value of the first instant.
   type :: circuit_assembly_t
      integer :: number = 0                    !< as of card ASSEMBLY
      integer :: branch = 0
      real(wp) :: value = 0.0_wp               !< the drive's value, with whole turns as on its branch
      real(wp), allocatable :: q(:, :)         !< (3, links) in the curve's unit
   end type circuit_assembly_t

   !> A change point: circuits meet there, or one crosses itself.
   type :: meeting_t
      real(wp) :: value = 0.0_wp               !< the drive's
      real(wp), allocatable :: q(:, :)         !< (3, links)
      logical, allocatable :: circuits(:)      !< (circuits) which meet
   end type meeting_t

   type :: circuits_t
      integer :: drive = 0                     !< the number of the free one
      integer :: part = 1                      !< the number of its independent mechanism
      logical :: is_held = .false.             !< its other drives let nothing move
      logical :: is_complete = .true.          !< all assemblies of the first instant were known
      logical :: are_more = .false.            !< than max_circuits
      type(curve_t) :: curve
      type(circuit_t), allocatable :: list(:)
      type(circuit_branch_t), allocatable :: branches(:)
      type(dead_point_t), allocatable :: dead(:)
      type(circuit_assembly_t), allocatable :: assemblies(:)
      type(meeting_t), allocatable :: meetings(:)
   end type circuits_t

contains

   !> Adds the branches and dead points of circuit number `i`, and its shift.
   subroutine add_branches(found, i)
      type(circuits_t), intent(inout) :: found
      integer, intent(in) :: i
      type(circuit_branch_t) :: b
      integer, allocatable :: ends(:), numbers(:)
      integer :: k, n, dead

      found%list(i)%shift = shift_of(found%curve, found%list(i))
      associate (points => found%list(i)%points)
         n = size(points)
         ends = pack([(k, k=1, n)], points%is_dead)
         dead = size(found%dead)
         numbers = [(dead + k, k=1, size(ends))]
         ! A closed circuit with dead points begins and ends at its first one.
         if (found%list(i)%ends(1) == end_closed .and. size(ends) > 1) numbers(size(ends)) = dead + 1
         do k = 1, size(ends)
            if (numbers(k) == dead + k) found%dead = [found%dead, dead_point_t(i, diagnostic_t(kind=diagnostic_limit, &
               drive=found%drive, is_angle=found%curve%is_angle, value=value_at(points(ends(k)))))]
         end do
         if (found%list(i)%ends(1) /= end_closed .or. size(ends) == 0) then
            ends = [1, ends, n]
            numbers = [0, numbers, 0]
         end if
         do k = 2, size(ends)
            b = circuit_branch_t(circuit=i, first=ends(k - 1), last=ends(k), dead=numbers(k - 1:k))
            b%range = [value_at(points(b%first)), value_at(points(b%last))]
            if (b%range(1) > b%range(2)) then
               b%range = b%range(2:1:-1)
               b%dead = b%dead(2:1:-1)
            end if
            b%sign = sign_of(points(b%first:b%last))
            found%branches = [found%branches, b]
         end do
      end associate

   contains

      !> The drive's value at `p`, in the deck's unit.
      pure real(wp) function value_at(p)
         type(curve_point_t), intent(in) :: p

         value_at = drive_value(found%curve, p%value(0) + found%list(i)%shift)
      end function value_at
   end subroutine add_branches

   !> The sign of the determinant of the Jacobian with the drive's row, from the points of a branch: that of the
   !> determinant with the tangent as its row, times that of the drive's derivative. 0 where it changes.
   pure integer function sign_of(points)
      type(curve_point_t), intent(in) :: points(:)
      integer :: k, one

      sign_of = 0
      do k = 1, size(points)
         if (points(k)%is_dead) cycle
         one = points(k)%sign*nint(sign(1.0_wp, points(k)%value(1)))
         if (sign_of == 0) sign_of = one
         if (one /= sign_of) exit
      end do
      if (k <= size(points)) sign_of = 0
   end function sign_of

   !> Adds the assemblies on circuit number `i` at the drive's value of the first instant.
   subroutine add_assemblies(found, i)
      type(circuits_t), intent(inout) :: found
      integer, intent(in) :: i
      type(curve_point_t) :: p
      real(wp) :: level, least, greatest
      integer :: b, k, m
      logical :: ok

      do b = 1, size(found%branches)
         if (found%branches(b)%circuit /= i .or. found%list(i)%rests) cycle
         do k = found%branches(b)%first, found%branches(b)%last - 1
            associate (from => found%list(i)%points(k), to => found%list(i)%points(k + 1))
               least = min(from%value(0), to%value(0)) - rounding
               greatest = max(from%value(0), to%value(0)) + rounding
               level = found%curve%first
               if (found%curve%is_angle) level = level + turn*ceiling((least - level)/turn)
               do m = 0, merge(1, 0, found%curve%is_angle)
                  if (level + m*turn < least .or. level + m*turn > greatest) cycle
                  call find_level(found%curve, from, to, level + m*turn, p, ok)
                  if (ok) call add_assembly(found, b, p)
               end do
            end associate
         end do
      end do
   end subroutine add_assemblies

   !> The point `p` between `from` and `to` at which the drive's value is `level`; that of the two that has it up to
   !> rounding.
   subroutine find_level(c, from, to, level, p, ok)
      type(curve_t), intent(inout) :: c
      type(curve_point_t), intent(in) :: from, to
      real(wp), intent(in) :: level
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok
      real(wp) :: off(2)

      off = [from%value(0), to%value(0)] - level
      ok = any(abs(off) <= rounding)
      if (ok) then
         if (abs(off(1)) <= abs(off(2))) then
            p = from
         else
            p = to
         end if
      else if (off(1)*off(2) < 0.0_wp) then
         call find_root(c, from, to, of_value, level, p, ok)
      end if
   end subroutine find_level

   !> Adds the assembly `p` on branch number `b`, unless it is there.
   subroutine add_assembly(found, b, p)
      type(circuits_t), intent(inout) :: found
      integer, intent(in) :: b
      type(curve_point_t), intent(in) :: p
      type(circuit_assembly_t) :: one
      integer :: k

      do k = 1, size(found%assemblies)
         if (found%branches(found%assemblies(k)%branch)%circuit == found%branches(b)%circuit &
            .and. same_place(found%curve, found%assemblies(k)%q, p%q)) return
      end do
      one%branch = b
      one%value = drive_value(found%curve, p%value(0) + found%list(found%branches(b)%circuit)%shift)
      one%q = p%q
      found%assemblies = [found%assemblies, one]
   end subroutine add_assembly

   !> Adds the change points of circuit number `i`.
   subroutine add_meetings(found, i)
      type(circuits_t), intent(inout) :: found
      integer, intent(in) :: i
      type(meeting_t) :: one
      integer :: k, j

      do k = 1, size(found%list(i)%changes)
         associate (change => found%list(i)%changes(k))
            do j = 1, size(found%meetings)
               if (same_place(found%curve, found%meetings(j)%q, change%q)) exit
            end do
            if (j > size(found%meetings)) then
               one%q = change%q
               one%value = change%value + found%list(i)%shift
               if (.not. any(found%list(i)%points%is_dead)) one%value = near_first(found%curve, change%value)
               one%value = drive_value(found%curve, one%value)
               one%circuits = spread(.false., 1, size(found%list))
               found%meetings = [found%meetings, one]
            end if
            found%meetings(j)%circuits(i) = .true.
         end associate
      end do
   end subroutine add_meetings

   !> Gives the assemblies their numbers in `list`, that of card ASSEMBLY; further ones follow. The determinant has the
   !> sign of the product of its blocks'.
   subroutine number_assemblies(found, list)
      type(circuits_t), intent(inout) :: found
      type(assembly_t), intent(in) :: list(:)
      integer :: k, j, next, turn_round

      turn_round = 0
      next = size(list)
      do k = 1, size(found%assemblies)
         associate (one => found%assemblies(k))
            j = number_of(deck_position(found%curve, one%q), list, found%curve%closure%length)
            if (j == 0) then
               next = next + 1
               j = next
            else if (turn_round == 0) then
               turn_round = found%branches(one%branch)%sign*product(list(j)%sign_of)
            end if
            one%number = j
         end associate
      end do
      if (turn_round < 0) found%branches%sign = -found%branches%sign
   end subroutine number_assemblies

   !> The value `x` of the free drive without whole turns: within half a turn of the first instant's.
   pure real(wp) function near_first(c, x) result(value)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: x

      value = x
      if (c%is_angle) value = x - turn*floor((x - c%first)/turn + 0.5_wp - tie)
   end function near_first

   !> The turns of the drive after which `circuit` closes.
   pure integer function turns_of(circuit) result(turns)
      type(circuit_t), intent(in) :: circuit

      turns = nint(abs(circuit%points(size(circuit%points))%value(0) - circuit%points(1)%value(0))/turn)
   end function turns_of

   !> The whole turns (rad) by which the drive's angle on `circuit` is shifted in results: the middle of its values is
   !> then within half a turn of the first instant's.
   pure real(wp) function shift_of(c, circuit) result(shift)
      type(curve_t), intent(in) :: c
      type(circuit_t), intent(in) :: circuit
      real(wp) :: middle

      middle = 0.5_wp*(minval(circuit%points%value(0)) + maxval(circuit%points%value(0)))
      shift = near_first(c, middle) - middle
   end function shift_of
end module circuit_branches
