!> Card CIRCUITS: the whole motion of a mechanism with one free drive (Chase and Mirth, Circuits and branches of
!> single-degree-of-freedom planar linkages, Journal of Mechanical Design 115, 1993). A circuit has all positions that
!> the mechanism reaches without being taken apart, the drive free to turn back at dead points; its branches lie
!> between dead points.
!>
!> A circuit is traced from each assembly that is on no known circuit: the deck's own, all others of the first instant,
!> and all assemblies at several angles of each link that turns. A circuit between all of these is not found.
!>
!> The links at a dead point are those whose position is singular when a motion begins there.
module circuits
   use kinds, only: wp
   use system_calls, only: signal_received
   use plane_vectors, only: full_turn
   use mechanism, only: mechanism_t, drive_t, drive_angle
   use motion, only: motion_t, new_motion, diagnostic_t, diagnostic_limit, singular_dead
   use analysis, only: analysis_t, make_analysis, advance
   use assemblies, only: assemblies_t, assembly_t, find_assemblies
   use circuit_curve, only: curve_t, make_curve, drive_value, deck_position, curve_point_t, start_point, of_size, &
      of_cylinder, step_between, lies_between, same_place, same_position_tolerance
   use circuit_trace, only: circuit_t, trace, least_step, end_closed
   use ranges, only: held_at, estimate_side
   implicit none
   private
   public :: circuits_t, circuit_branch_t, find_circuits, revolutions_of

   !> More than the rounding of an angle, in turns: ties between whole turns always fall on one side.
   real(wp), parameter :: tie_turns = 1.0e-6_wp

   !> A search ends after so many circuits, or after so much work, points times the cube of the coordinates: its time
   !> has a bound.
   integer, parameter :: max_circuits = 64
   real(wp), parameter :: max_work = 3.0e9_wp

   !> A piece of a circuit between dead points.
   type :: circuit_branch_t
      integer :: circuit = 0                   !< number of the circuit
      integer :: first = 0, last = 0           !< numbers of its first and last point on the circuit
      integer :: dead(2) = 0                   !< the dead points at its least and greatest value; 0: none
      real(wp) :: range(2) = 0.0_wp            !< the drive's least and greatest value on it (rad or deck's length)
      integer, allocatable :: assemblies(:)    !< (any number) on it at the first instant, by card ASSEMBLY
   end type circuit_branch_t

   !> A change point.
   type :: intersection_t
      real(wp), allocatable :: q(:, :)         !< (3, links) its position
      real(wp) :: value = 0.0_wp               !< the drive's (rad or deck's length)
      logical, allocatable :: circuits(:)      !< (circuits) which meet there
   end type intersection_t

   !> The circuits of one free drive, with their branches, dead points and change points.
   type :: circuits_t
      integer :: drive = 0                     !< the number of the free one
      integer :: part = 1                      !< the number of its independent mechanism
      logical :: is_redundant = .false.        !< there are too many equations: none is followed
      logical :: is_complete = .true.          !< all assemblies of the first instant were known
      logical :: are_more = .false.            !< there are more circuits than are followed
      real(wp) :: work = 0.0_wp                !< for the followed ones: points times the cube of the coordinates
      type(curve_t) :: curve                   !< on which the circuits are
      type(circuit_t), allocatable :: list(:)  !< (circuits)
      type(circuit_branch_t), allocatable :: branches(:)   !< (any number) circuit after circuit
      type(diagnostic_t), allocatable :: dead(:)   !< (dead points) the drive's value, and the links if known
      type(intersection_t), allocatable :: meetings(:)   !< (any number) the change points
   end type circuits_t

   !> A slide is followed farther than its largest value in the assemblies of the first instant, by this factor.
   real(wp), parameter :: farther_than_seen = 2.0_wp
   !> All assemblies are found at so many angles of each link; at fewer if that takes more than so many paths.
   integer, parameter :: max_link_angles = 24, max_paths = 500

contains

   !> Finds the circuits of a mechanism with one free drive; the others keep their values. A mechanism with redundant
   !> equations has none, and `is_redundant` is true.
   subroutine find_circuits(m, start, drive, first, found)
      type(mechanism_t), intent(in) :: m     !< one independent mechanism
      type(motion_t), intent(in) :: start    !< at its first instant, known or not
      integer, intent(in) :: drive           !< number of the free drive
      type(assemblies_t), intent(in) :: first   !< all assemblies of the first instant that are known
      type(circuits_t), intent(out) :: found   !< of the free drive
      type(mechanism_t) :: held
      integer :: i

      found%drive = drive
      found%is_complete = first%is_known
      allocate (found%list(0), found%branches(0), found%dead(0), found%meetings(0))
      call make_curve(found%curve, m, drive, start%t)
      found%is_redundant = is_redundant(found%curve)
      if (found%is_redundant) return
      do i = 1, size(first%list)
         associate (size_of => maxval(abs(first%list(i)%position(:2, :)))/found%curve%closure%length)
            found%curve%far = max(found%curve%far, farther_than_seen*size_of)
         end associate
      end do

      held = held_at(m, start%t)
      if (start%known >= 0) call add_circuit(found, start%position, .false.)
      do i = 1, size(first%list)
         call add_circuit(found, first%list(i)%position, .false.)
      end do
      call search_whole_range(held, found)
      ! The run's own assembly has a row, even if its circuit cannot be followed.
      if (start%known >= 0) call add_circuit(found, start%position, .true.)

      do i = 1, size(found%list)
         call add_branches(found, held, i)
         call add_intersections(found, i)
      end do
      call add_assemblies(found, first%list)
   end subroutine find_circuits

   !> Adds the circuits through all assemblies at angles of each link that turns on a known circuit. The link is driven
   !> instead of the free drive: a circuit that is narrow in the drive is mostly wide in some link. Links that turn
   !> together are one; if no circuit is known, any may turn.
   subroutine search_whole_range(m, found)
      type(mechanism_t), intent(in) :: m     !< all drives rest, all links are asked for
      type(circuits_t), intent(inout) :: found   !< with the circuits known so far; gets further ones
      logical :: is_left(found%curve%nonlinear%angles)
      integer :: k

      is_left = .true.
      do
         k = findloc(is_left .and. [(turns(k), k=1, size(is_left))], .true., dim=1)
         if (k == 0) exit
         call search_at_angles(m, findloc(found%curve%nonlinear%angle_of, k, dim=1), found)
         is_left(k) = .false.
      end do

   contains

      !> Tells whether an angle changes on a known circuit; if no circuit is known, that it may change.
      pure logical function turns(k)
         integer, intent(in) :: k            !< the angle's number in `nonlinear`
         integer :: link, i, j

         link = findloc(found%curve%nonlinear%angle_of, k, dim=1)
         turns = size(found%list) == 0
         do i = 1, size(found%list)
            associate (p => found%list(i)%points)
               turns = turns .or. &
                  any([(abs(p(j)%q(3, link) - p(1)%q(3, link)) > same_position_tolerance, j=1, size(p))])
            end associate
         end do
      end function turns
   end subroutine search_whole_range

   !> Adds the circuits through all assemblies at several angles of a link.
   subroutine search_at_angles(m, link, found)
      type(mechanism_t), intent(in) :: m     !< all drives rest, all links are asked for
      integer, intent(in) :: link            !< number of the link
      type(circuits_t), intent(inout) :: found   !< with the circuits known so far; gets further ones
      type(mechanism_t) :: driven
      type(assemblies_t) :: more
      real(wp) :: from
      integer :: k, n, i

      driven = m
      driven%drives(found%drive) = drive_t(kind=drive_angle, subject=link)
      from = 0.0_wp
      if (size(found%list) > 0) from = found%list(1)%points(1)%q(3, link)
      n = max_link_angles
      k = 0
      do while (k < n .and. .not. found%are_more .and. signal_received() == 0)
         driven%drives(found%drive)%polynomial(1) = from + full_turn*real(k, wp)/real(n, wp)
         call find_assemblies(driven, 0.0_wp, more)
         do i = 1, size(more%list)
            call add_circuit(found, more%list(i)%position, .false.)
         end do
         if (k == 0) n = min(n, max_paths/max(1, sum(more%blocks%paths)))
         k = k + 1
      end do
   end subroutine search_at_angles

   !> Adds the circuit through a position, unless it is known, or its first point cannot be found. A circuit cannot be
   !> followed from a change point, nor from a cylinder of the length 0: there, and from a slide beyond curve%far, it is
   !> added only if it is needed. If there are too many circuits, `are_more` becomes true.
   subroutine add_circuit(found, position, needed)
      type(circuits_t), intent(inout) :: found   !< with the circuits known so far; gets the circuit
      real(wp), intent(in) :: position(:, :)   !< (3, links) x and y in the deck's unit from the origin, phi in rad
      logical, intent(in) :: needed          !< the circuit is added in any case
      type(curve_point_t) :: p
      type(circuit_t), allocatable :: more(:)
      integer :: n, i, k
      logical :: ok

      n = size(found%list) + 1
      if (.not. needed .and. (found%are_more .or. signal_received() > 0)) return
      call start_point(found%curve, position, p, ok)
      if (.not. ok) return
      if (.not. needed .and. (p%room < least_step .or. p%value(of_size) > found%curve%far .or. &
         p%value(of_cylinder) <= same_position_tolerance*found%curve%closure%length)) return
      call locate(found, p, i, k)
      if (i > 0) return
      found%are_more = found%are_more .or. .not. needed .and. (n > max_circuits .or. found%work > max_work)
      if (found%are_more .and. .not. needed) return
      allocate (more(n))
      more(:n - 1) = found%list
      call trace(found%curve, p, more(n))
      found%work = found%work + size(more(n)%points)*real(found%curve%closure%n, wp)**3
      call move_alloc(more, found%list)
   end subroutine add_circuit

   !> Finds the place of a point on the known circuits.
   subroutine locate(found, point, i, k)
      type(circuits_t), intent(inout) :: found   !< gets another configuration
      type(curve_point_t), intent(in) :: point   !< a point of the curve
      integer, intent(out) :: i              !< number of the circuit; 0: the point is on none
      integer, intent(out) :: k              !< the point lies between points `k` and k + 1, or at the only one
      type(curve_point_t) :: again
      real(wp) :: least, greatest
      logical :: passes
      integer :: n

      do i = 1, size(found%list)
         n = size(found%list(i)%points)
         do k = 1, max(1, n - 1)
            associate (a => found%list(i)%points(k), b => found%list(i)%points(min(k + 1, n)), value => point%value(0))
               ! The drive has the value of `point`, but for whole turns, between these neighbours or near them.
               least = min(a%value(0), b%value(0)) - same_position_tolerance
               greatest = max(a%value(0), b%value(0)) + same_position_tolerance
               passes = value >= least .and. value <= greatest
               if (found%curve%is_angle) passes = modulo(value - least, full_turn) <= greatest - least
               if (passes) call lies_between(found%curve, a, step_between(found%curve, a, b), point%q, again, passes)
               if (passes) return
            end associate
         end do
      end do
      i = 0
   end subroutine locate

   !> Makes the diagnostic of a dead point. The diagnostic has the links whose position is singular at a first instant
   !> there; no links if such an instant is not found.
   function dead_point(found, held, point, value) result(dead)
      type(circuits_t), intent(in) :: found   !< with its curve and free drive
      type(mechanism_t), intent(in) :: held   !< all drives rest, all links are asked for
      type(curve_point_t), intent(in) :: point   !< the dead point
      real(wp), intent(in) :: value          !< of the free drive there, rad or the deck's length
      type(diagnostic_t) :: dead
      type(mechanism_t) :: there
      type(analysis_t) :: a
      type(motion_t) :: q

      dead = diagnostic_t(kind=diagnostic_limit, drive=found%drive, is_angle=found%curve%is_angle, value=value)
      there = held
      ! With a drive at rest the kind of singular position would not be known.
      there%drives(found%drive)%polynomial(:2) = [drive_value(found%curve, point%value(0)), &
         merge(1.0_wp, found%curve%closure%length, found%curve%is_angle)]
      call estimate_side(there, deck_position(found%curve, point%q))
      call make_analysis(a, there)
      q = new_motion(size(there%links))
      call advance(a, 0.0_wp, q)
      if (q%singularity /= singular_dead) return
      dead%links = q%singular_links%links
      dead%more = q%singular_links%more
      dead%in_line = q%singular_links%in_line
   end function dead_point

   !> Adds the branches and dead points of a circuit, and finds its shift.
   subroutine add_branches(found, held, i)
      type(circuits_t), intent(inout) :: found   !< gets the branches, the dead points and the shift
      type(mechanism_t), intent(in) :: held   !< all drives rest, all links are asked for
      integer, intent(in) :: i               !< number of the circuit
      type(circuit_branch_t) :: b
      integer, allocatable :: ends(:), numbers(:)
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
            if (numbers(k) == dead + k) &
               found%dead = [found%dead, dead_point(found, held, points(ends(k)), values(ends(k)))]
         end do
         if (found%list(i)%ends(1) /= end_closed .or. size(ends) == 0) then
            ends = [1, ends, n]
            numbers = [0, numbers, 0]
         end if

         do k = 2, size(ends)
            b = circuit_branch_t(circuit=i, first=ends(k - 1), last=ends(k), dead=numbers(k - 1:k), &
               assemblies=[integer ::])
            b%range = values([b%first, b%last])
            if (b%range(1) > b%range(2)) then
               b%range = b%range(2:1:-1)
               b%dead = b%dead(2:1:-1)
            end if
            found%branches = [found%branches, b]
         end do
      end associate
   end subroutine add_branches

   !> Adds to each branch the assemblies of card ASSEMBLY that are on it.
   subroutine add_assemblies(found, list)
      type(circuits_t), intent(inout) :: found   !< with all branches
      type(assembly_t), intent(in) :: list(:)   !< (any number) of the first instant, in the order of card ASSEMBLY
      type(curve_point_t) :: p
      integer :: number, i, k, b
      logical :: ok

      do number = 1, size(list)
         call start_point(found%curve, list(number)%position, p, ok)
         if (.not. ok) cycle
         call locate(found, p, i, k)
         if (i == 0) cycle
         b = findloc(found%branches%circuit == i .and. found%branches%first <= k &
            .and. k < max(found%branches%first + 1, found%branches%last), .true., dim=1)
         found%branches(b)%assemblies = [found%branches(b)%assemblies, number]
      end do
   end subroutine add_assemblies

   !> Adds the change points of a circuit. A change point that another circuit has already gets only the circuit.
   subroutine add_intersections(found, i)
      type(circuits_t), intent(inout) :: found   !< with all circuits and their shifts
      integer, intent(in) :: i               !< number of the circuit
      real(wp) :: value
      integer :: k, j

      do k = 1, size(found%list(i)%points)
         associate (p => found%list(i)%points(k))
            if (.not. p%is_change) cycle
            do j = 1, size(found%meetings)
               if (same_place(found%meetings(j)%q, p%q)) exit
            end do
            if (j > size(found%meetings)) then
               value = p%value(0) + found%list(i)%shift
               if (.not. any(found%list(i)%points%is_dead)) value = near_first(found%curve, p%value(0))
               found%meetings = [found%meetings, &
                  intersection_t(p%q, drive_value(found%curve, value), spread(.false., 1, size(found%list)))]
            end if
            found%meetings(j)%circuits(i) = .true.
         end associate
      end do
   end subroutine add_intersections

   !> Removes whole turns from a value of the free drive: the result is within half a turn of the value at the first
   !> instant. A value that is no angle stays.
   pure real(wp) function near_first(curve, given) result(value)
      type(curve_t), intent(in) :: curve     !< of the drive
      real(wp), intent(in) :: given          !< rad or lengths of the curve

      value = given
      if (curve%is_angle) value = given - full_turn*floor((given - curve%first)/full_turn + 0.5_wp - tie_turns)
   end function near_first

   !> Gives the number of turns of the drive after which a circuit closes; of no meaning if the drive is no angle.
   pure integer function revolutions_of(circuit) result(turns)
      type(circuit_t), intent(in) :: circuit   !< closed

      turns = nint(abs(circuit%points(size(circuit%points))%value(0) - circuit%points(1)%value(0))/full_turn)
   end function revolutions_of

   !> Tells whether some equations are redundant, by count: two of each pair, one of each drive that is held.
   pure logical function is_redundant(curve)
      type(curve_t), intent(in) :: curve     !< with its pairs and drives

      is_redundant = 2*size(curve%closure%pairs) + size(curve%closure%drives) > curve%closure%n - 1
   end function is_redundant
end module circuits
