!> Card CIRCUITS: the whole motion of a mechanism with one free drive (Chase and Mirth, Circuits and branches of
!> single-degree-of-freedom planar linkages, Journal of Mechanical Design 115, 1993). A circuit is what the mechanism
!> reaches without being taken apart, the drive free to turn back at dead points; its branches lie between dead points.
!>
!> A circuit is traced from each assembly that is on none of those known: the deck's own, all others of the first
!> instant, and all assemblies at values over the whole range of the drive and at angles of each link: a circuit between
!> all of these is not found.
!>
!> The links at dead points are those that card RANGE finds there, from the middle of each branch.
module circuits
   use kinds, only: wp
   use system_calls, only: signal_received
   use planar, only: pi, without_turns
   use mechanism, only: mechanism_t, drive_t, drive_angle
   use scales, only: characteristic_length
   use motion, only: motion_t, new_motion, diagnostic_t, diagnostic_limit
   use assemblies, only: assemblies_t, assembly_t, find_assemblies, number_of
   use circuit_curve, only: curve_t, make_curve, is_redundant, drive_value, deck_position, curve_point_t, start_point, &
      of_value, of_size, step_between, lies_between, beside, same_place
   use circuit_trace, only: circuit_t, trace, least_step, find_root, end_closed
   use ranges, only: range_t, find_range, is_lost, held_at, low, high
   implicit none
   private
   public :: circuits_t, circuit_branch_t, find_circuits, free_drives, turns_of, no_sign

   real(wp), parameter :: turn = 2.0_wp*pi
   !> More than rounding of an angle in turns: ties between whole turns always fall on one side.
   real(wp), parameter :: tie = 1.0e-6_wp
   !> A drive's value is that of a point up to this difference, in rad and lengths.
   real(wp), parameter :: rounding = 1.0e3_wp*epsilon(1.0_wp)

   integer, parameter :: no_sign = 2
   !> More circuits are not looked for, nor any after so much work: points times the cube of the coordinates.
   integer, parameter :: max_circuits = 64
   real(wp), parameter :: max_work = 1.0e9_wp

   !> A piece of a circuit between dead points.
   type :: circuit_branch_t
      integer :: circuit = 0
      integer :: first = 0, last = 0           !< its first and last point on the circuit
      integer :: dead(2) = 0                   !< the dead points at its least and greatest value; 0: none
      real(wp) :: range(2) = 0.0_wp            !< the drive's least and greatest value on it (rad or deck's length)
      !> Of the Jacobian's determinant; 0: it changes, at change points; no_sign: there are too many equations.
      integer :: sign = 0
   end type circuit_branch_t

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
      logical :: are_more = .false.            !< than are followed
      real(wp) :: work = 0.0_wp                !< of those that are followed
      type(curve_t) :: curve
      type(circuit_t), allocatable :: list(:)
      type(circuit_branch_t), allocatable :: branches(:)
      type(diagnostic_t), allocatable :: dead(:)   !< dead points: the drive's value, and the links where known
      type(circuit_assembly_t), allocatable :: assemblies(:)
      type(meeting_t), allocatable :: meetings(:)
   end type circuits_t

   !> A limit found by both methods is one up to this difference, in rad and lengths.
   real(wp), parameter :: agrees = max(1.0e-6_wp, 1.0e3_wp*epsilon(1.0_wp))

   !> A slide is followed farther than it goes in any assembly of the first instant, by this factor.
   real(wp), parameter :: beyond = 2.0_wp
   !> Values of the drive at which all assemblies are found, for an angle each 5 deg, and of the angle of each link;
   !> fewer where that takes more than so many paths.
   integer, parameter :: most_values = 72, link_values = 8, max_paths = 1000

contains

   !> Finds the circuits of `m`, one independent mechanism with the motion `start` at its first instant, known or not;
   !> drive number `drive` is free, the others keep their values. `first`: the assemblies there, if they are known.
   subroutine find_circuits(m, start, drive, found, first)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: start
      integer, intent(in) :: drive
      type(circuits_t), intent(out) :: found
      type(assemblies_t), intent(in), optional :: first
      type(assemblies_t) :: all_of_them
      type(curve_point_t) :: p
      logical :: ok
      integer :: i

      if (present(first)) then
         all_of_them = first
      else
         call find_assemblies(m, start%t, all_of_them)
      end if
      found%drive = drive
      found%is_complete = all_of_them%is_known
      allocate (found%list(0), found%branches(0), found%dead(0), found%assemblies(0), found%meetings(0))
      call make_curve(found%curve, m, drive, start%t)
      do i = 1, size(all_of_them%list)
         associate (size_of => maxval(abs(all_of_them%list(i)%position(:2, :)))/found%curve%closure%length)
            found%curve%far = max(found%curve%far, beyond*size_of)
         end associate
      end do

      if (start%known >= 0) then
         call start_point(found%curve, start%position, p, ok)
         if (ok) call add_circuit(found, p)
      end if
      call add_through(found, all_of_them)
      call search_whole_range(m, start%t, found, all_of_them)

      do i = 1, size(found%list)
         call add_branches(found, i)
         call add_assemblies(found, i)
         call add_meetings(found, i)
      end do
      found%is_held = found%curve%is_held .and. size(found%list) == 0
      call number_assemblies(found, all_of_them%list)
      if (is_redundant(found%curve)) found%branches%sign = no_sign
      call name_limits(m, start%t, found)
   end subroutine find_circuits

   !> Adds the circuits through assemblies.
   subroutine add_through(found, all_of_them)
      type(circuits_t), intent(inout) :: found
      type(assemblies_t), intent(in) :: all_of_them
      type(curve_point_t) :: p
      integer :: k
      logical :: ok

      do k = 1, size(all_of_them%list)
         if (found%are_more .or. signal_received() > 0) return
         call start_point(found%curve, all_of_them%list(k)%position, p, ok)
         if (ok) call add_circuit(found, p)
      end do
   end subroutine add_through

   !> Adds the circuits through the assemblies of `m` at values of the drive over its whole range: a turn, or as far as
   !> all links together reach; and at angles of each link that moves, driven instead: a circuit that is narrow in the
   !> drive is mostly wide in some link. `first`: the assemblies at the time `t`.
   subroutine search_whole_range(m, t, found, first)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t
      type(circuits_t), intent(inout) :: found
      type(assemblies_t), intent(in) :: first
      type(mechanism_t) :: held
      type(assemblies_t) :: more
      real(wp) :: from, range
      integer :: link, k, n

      held = held_at(m, t)
      do link = 0, size(m%links)
         range = turn
         if (link == 0) then
            ! The drive itself.
            if (any(first%blocks%is_wide)) cycle
            n = most_values
            from = found%curve%first
            if (.not. found%curve%is_angle) then
               range = 2.0_wp*characteristic_length(m)*count(.not. m%links%ground)
               from = from - 0.5_wp*(range/found%curve%closure%length)
            end if
            from = drive_value(found%curve, from)
         else
            if (m%links(link)%ground) cycle
            n = link_values
            held%drives(found%drive) = drive_t(kind=drive_angle, subject=link)
            from = 0.0_wp
            if (size(found%list) > 0) from = found%list(1)%points(1)%q(3, link)
         end if

         k = 0
         do while (k < n .and. .not. found%are_more .and. signal_received() == 0)
            held%drives(found%drive)%polynomial(1) = from + range*real(k, wp)/real(n, wp)
            call find_assemblies(held, 0.0_wp, more)
            call add_through(found, more)
            if (k == 0) n = min(n, max_paths/max(1, sum(more%blocks%paths)))
            k = k + 1
         end do
      end do
   end subroutine search_whole_range

   !> The drives of `m` that are set free, each alone: those that move; if none does, all.
   pure function free_drives(m) result(list)
      type(mechanism_t), intent(in) :: m
      integer, allocatable :: list(:)
      logical :: moves
      integer :: i

      allocate (list(0))
      do i = 1, size(m%drives)
         moves = any(abs(m%drives(i)%polynomial(2:)) > 0.0_wp)
         if (allocated(m%drives(i)%terms)) moves = moves .or. size(m%drives(i)%terms) > 0
         if (moves) list = [list, i]
      end do
      if (size(list) == 0) list = [(i, i=1, size(m%drives))]
   end function free_drives

   !> Adds the circuit through `p`, unless it is known.
   subroutine add_circuit(found, p)
      type(circuits_t), intent(inout) :: found
      type(curve_point_t), intent(in) :: p
      type(circuit_t), allocatable :: more(:)
      integer :: n

      n = size(found%list) + 1
      if (found%are_more .or. signal_received() > 0) return
      if (p%reach < least_step .or. p%value(of_size) > found%curve%far) return
      if (is_known(found, p)) return
      found%are_more = n > max_circuits .or. found%work > max_work
      if (found%are_more) return
      allocate (more(n))
      more(:n - 1) = found%list
      call trace(found%curve, p, more(n))
      found%work = found%work + size(more(n)%points)*real(found%curve%closure%n, wp)**3
      call move_alloc(more, found%list)
   end subroutine add_circuit

   !> Whether some circuit goes through `p`.
   logical function is_known(found, p)
      type(circuits_t), intent(inout) :: found
      type(curve_point_t), intent(in) :: p
      type(curve_point_t) :: again
      real(wp) :: least, greatest
      logical :: passes
      integer :: i, k

      is_known = .false.
      do i = 1, size(found%list)
         do k = 1, size(found%list(i)%points) - 1
            associate (a => found%list(i)%points(k), b => found%list(i)%points(k + 1), value => p%value(0))
               ! The drive has the value of `p`, but for whole turns, between these neighbours, or nearly there.
               least = min(a%value(0), b%value(0)) - beside(a)
               greatest = max(a%value(0), b%value(0)) + beside(a)
               passes = value >= least .and. value <= greatest
               if (found%curve%is_angle) passes = modulo(value - least, turn) <= greatest - least
               if (.not. passes) cycle
               call lies_between(found%curve, a, step_between(found%curve, a, b), p%q, again, is_known)
               if (is_known) return
            end associate
         end do
      end do
   end function is_known

   !> Names the links at the dead points of `m`: those at the limits of a motion from where the drive moves the fastest
   !> on each branch. Drives that are held have their values of the time `t`.
   subroutine name_limits(m, t, found)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t
      type(circuits_t), intent(inout) :: found
      type(mechanism_t) :: held
      type(motion_t) :: middle
      type(range_t) :: r
      real(wp) :: off
      integer :: i, k, side

      held = held_at(m, t)
      middle = new_motion(size(m%links))
      do i = 1, size(found%branches)
         if (signal_received() > 0) return
         associate (b => found%branches(i), points => found%list(found%branches(i)%circuit)%points)
            if (all(b%dead == 0) .or. found%list(b%circuit)%rests) cycle
            if (all(found%dead(pack(b%dead, b%dead > 0))%links(1) > 0)) cycle
            k = b%first - 1 + maxloc(abs(points(b%first:b%last)%value(1)), dim=1)
            middle%position = deck_position(found%curve, points(k)%q)
            held%drives(found%drive)%polynomial(1) = drive_value(found%curve, points(k)%value(0))
            call find_range(held, middle, found%drive, .true., r)
            ! Lost slowly, and so would the others be: their links stay without names.
            if (is_lost(r, low) .or. is_lost(r, high)) return
            do side = low, high
               if (b%dead(side) == 0 .or. .not. r%has_limit(side)) cycle
               associate (dead => found%dead(b%dead(side)))
                  off = r%limit(side)%value - dead%value
                  off = merge(without_turns(off), off/found%curve%closure%length, found%curve%is_angle)
                  if (dead%links(1) > 0 .or. abs(off) > agrees) cycle
                  r%limit(side)%value = dead%value
                  dead = r%limit(side)
               end associate
            end do
         end associate
      end do
   end subroutine name_limits

   !> Adds the branches and dead points of circuit number `i`, and its shift.
   subroutine add_branches(found, i)
      type(circuits_t), intent(inout) :: found
      integer, intent(in) :: i
      type(circuit_branch_t) :: b
      integer, allocatable :: ends(:), numbers(:), signs(:)
      real(wp), allocatable :: values(:)       ! of the drive at the points, in the deck's unit
      real(wp) :: middle
      integer :: k, n, dead

      middle = 0.5_wp*(minval(found%list(i)%points%value(0)) + maxval(found%list(i)%points%value(0)))
      found%list(i)%shift = near_first(found%curve, middle) - middle
      associate (points => found%list(i)%points)
         n = size(points)
         values = [(drive_value(found%curve, points(k)%value(0) + found%list(i)%shift), k=1, n)]
         ends = pack([(k, k=1, n)], points%is_dead)
         dead = size(found%dead)
         numbers = [(dead + k, k=1, size(ends))]
         ! A closed circuit with dead points begins and ends at its first one.
         if (found%list(i)%ends(1) == end_closed .and. size(ends) > 1) numbers(size(ends)) = dead + 1
         do k = 1, size(ends)
            if (numbers(k) == dead + k) found%dead = [found%dead, diagnostic_t(kind=diagnostic_limit, &
               drive=found%drive, is_angle=found%curve%is_angle, value=values(ends(k)))]
         end do
         if (found%list(i)%ends(1) /= end_closed .or. size(ends) == 0) then
            ends = [1, ends, n]
            numbers = [0, numbers, 0]
         end if
         do k = 2, size(ends)
            b = circuit_branch_t(circuit=i, first=ends(k - 1), last=ends(k), dead=numbers(k - 1:k))
            b%range = values([b%first, b%last])
            if (b%range(1) > b%range(2)) then
               b%range = b%range(2:1:-1)
               b%dead = b%dead(2:1:-1)
            end if
            ! The determinant with the drive's row is that with the tangent as its row times the drive's derivative.
            associate (p => points(b%first:b%last))
               signs = pack(p%sign*nint(sign(1.0_wp, p%value(1))), .not. p%is_dead)
            end associate
            b%sign = 0
            if (size(signs) > 0) then
               if (all(signs == signs(1))) b%sign = signs(1)
            end if
            found%branches = [found%branches, b]
         end do
      end associate
   end subroutine add_branches

   !> Adds the assemblies on circuit number `i` at the drive's value of the first instant.
   subroutine add_assemblies(found, i)
      type(circuits_t), intent(inout) :: found
      integer, intent(in) :: i
      type(curve_point_t) :: p
      real(wp) :: level, least, greatest, off(2)
      integer :: b, k, m, j
      logical :: ok

      do b = 1, size(found%branches)
         if (found%branches(b)%circuit /= i .or. found%list(i)%rests) cycle
         do k = found%branches(b)%first, found%branches(b)%last - 1
            associate (from => found%list(i)%points(k), to => found%list(i)%points(k + 1))
               least = min(from%value(0), to%value(0)) - rounding
               greatest = max(from%value(0), to%value(0)) + rounding
               do m = 0, merge(1, 0, found%curve%is_angle)
                  level = found%curve%first
                  if (found%curve%is_angle) level = level + turn*ceiling((least - level)/turn)
                  level = level + m*turn
                  if (level < least .or. level > greatest) cycle
                  ! One of the two has it up to rounding, or it is between them.
                  off = [from%value(0), to%value(0)] - level
                  ok = any(abs(off) <= rounding)
                  if (ok) then
                     p = from
                     if (abs(off(2)) < abs(off(1))) p = to
                  else if (off(1)*off(2) < 0.0_wp) then
                     call find_root(found%curve, from, to, of_value, level, p, ok)
                  end if
                  if (.not. ok) cycle
                  do j = 1, size(found%assemblies)
                     if (found%branches(found%assemblies(j)%branch)%circuit == i &
                        .and. same_place(found%curve, found%assemblies(j)%q, p%q)) exit
                  end do
                  if (j > size(found%assemblies)) found%assemblies = [found%assemblies, circuit_assembly_t(branch=b, &
                     value=drive_value(found%curve, p%value(0) + found%list(i)%shift), q=p%q)]
               end do
            end associate
         end do
      end do
   end subroutine add_assemblies

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
end module circuits
