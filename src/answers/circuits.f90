!> Card CIRCUITS: the whole motion of a mechanism with one free drive (Chase and Mirth, Circuits and branches of
!> single-degree-of-freedom planar linkages, Journal of Mechanical Design 115, 1993). A circuit is what the mechanism
!> reaches without being taken apart, the drive free to turn back at dead points; its branches lie between dead points.
!>
!> A circuit is traced from each assembly that is on none of those known: the deck's own, all others of the first
!> instant, those of the crossings at change points, and all assemblies at values over the whole range of the drive, and
!> at angles of each link: a circuit between all of these is not found.
!>
!> The links at dead points are those that card RANGE finds there, from the middle of each branch.
module circuits
   use kinds, only: wp
   use system_calls, only: signal_received
   use planar, only: pi, without_turns
   use mechanism, only: mechanism_t, drive_t, drive_angle
   use scales, only: characteristic_length
   use motion, only: motion_t, new_motion
   use assemblies, only: assemblies_t, find_assemblies
   use curve_equations, only: curve_t, make_curve, is_redundant, drive_value, deck_position
   use circuit_curve, only: curve_point_t, start_point, step_between, lies_between, beside
   use circuit_trace, only: circuit_t, trace, come_near, least_step
   use circuit_crossing, only: other_circuit
   use circuit_branches, only: circuits_t, no_sign, max_circuits, add_branches, add_assemblies, add_meetings, &
      number_assemblies, circuit_branch_t
   use ranges, only: range_t, find_range, is_lost, held_at, low, high
   implicit none
   private
   public :: find_circuits, free_drives, name_limits

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
         if (ok) call add_circuits(found, p)
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
         if (ok) call add_circuits(found, p)
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
      real(wp) :: from, range
      integer :: k

      held = held_at(m, t)
      from = found%curve%first
      range = 2.0_wp*pi
      if (.not. found%curve%is_angle) then
         range = 2.0_wp*characteristic_length(m)*count(.not. m%links%ground)
         from = from - 0.5_wp*(range/found%curve%closure%length)
      end if
      from = drive_value(found%curve, from)
      if (.not. any(first%blocks%is_wide)) call search(held, from, range, most_values, found)
      do k = 1, size(m%links)
         if (m%links(k)%ground) cycle
         held%drives(found%drive) = drive_t(kind=drive_angle, subject=k)
         from = 0.0_wp
         if (size(found%list) > 0) from = found%list(1)%points(1)%q(3, k)
         call search(held, from, 2.0_wp*pi, link_values, found)
      end do
   end subroutine search_whole_range

   !> Adds the circuits through the assemblies of `m` at up to `most` values of the drive that is free in `found`, over
   !> a `range` that begins at `from`; fewer where that takes many paths.
   subroutine search(m, from, range, most, found)
      type(mechanism_t), intent(inout) :: m
      real(wp), intent(in) :: from, range
      integer, intent(in) :: most
      type(circuits_t), intent(inout) :: found
      type(assemblies_t) :: more
      integer :: k, n

      n = most
      k = 0
      do while (k < n .and. .not. found%are_more .and. signal_received() == 0)
         m%drives(found%drive)%polynomial(1) = from + range*real(k, wp)/real(n, wp)
         call find_assemblies(m, 0.0_wp, more)
         call add_through(found, more)
         if (k == 0) n = min(most, max_paths/max(1, sum(more%blocks%paths)))
         k = k + 1
      end do
   end subroutine search

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

   !> Adds the circuit through `p`, unless it is known, and those that it meets. From a change point the sense is not
   !> known in which circuits go on: others are found from elsewhere.
   recursive subroutine add_circuits(found, p)
      type(circuits_t), intent(inout) :: found
      type(curve_point_t), intent(in) :: p
      type(circuit_t), allocatable :: more(:)
      type(curve_point_t) :: from, other
      integer :: n, k
      logical :: ok

      n = size(found%list) + 1
      if (found%are_more .or. p%reach < least_step .or. signal_received() > 0) return
      from = p
      call come_near(found%curve, from, ok)
      if (.not. ok) return
      if (is_known(found, from)) return
      found%are_more = n > max_circuits
      if (found%are_more) return
      allocate (more(n))
      more(:n - 1) = found%list
      call trace(found%curve, from, more(n))
      call move_alloc(more, found%list)
      do k = 1, size(found%list(n)%changes)
         associate (circuit => found%list(n))
            call other_circuit(found%curve, circuit%points(circuit%changes(k)%after), circuit%changes(k), other, ok)
         end associate
         if (ok) call add_circuits(found, other)
      end do
   end subroutine add_circuits

   !> Whether some circuit goes through `p`.
   logical function is_known(found, p)
      type(circuits_t), intent(inout) :: found
      type(curve_point_t), intent(in) :: p
      type(curve_point_t) :: again
      integer :: i, k

      is_known = .false.
      do i = 1, size(found%list)
         associate (points => found%list(i)%points)
            do k = 1, size(points) - 1
               if (.not. passes(found%curve, points(k), points(k + 1), p%value(0))) cycle
               call lies_between(found%curve, points(k), step_between(found%curve, points(k), points(k + 1)), p%q, &
                  again, is_known)
               if (is_known) return
            end do
         end associate
      end do
   end function is_known

   !> Whether the drive has the `value`, but for whole turns, between the neighbours `a` and `b`, or nearly there.
   pure logical function passes(c, a, b, value)
      type(curve_t), intent(in) :: c
      type(curve_point_t), intent(in) :: a, b
      real(wp), intent(in) :: value
      real(wp) :: least, greatest

      least = min(a%value(0), b%value(0)) - beside(a)
      greatest = max(a%value(0), b%value(0)) + beside(a)
      passes = value >= least .and. value <= greatest
      if (c%is_angle) passes = modulo(value - least, 2.0_wp*pi) <= greatest - least
   end function passes

   !> Names the links at the dead points of `m`. Drives that are held have their values of the time `t`.
   subroutine name_limits(m, t, found)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t
      type(circuits_t), intent(inout) :: found
      type(mechanism_t) :: held
      type(motion_t) :: middle
      type(range_t) :: r
      integer :: b, side

      held = held_at(m, t)
      middle = new_motion(size(m%links))
      do b = 1, size(found%branches)
         if (signal_received() > 0) return
         if (all(found%branches(b)%dead == 0) .or. found%list(found%branches(b)%circuit)%rests) cycle
         if (all(found%dead(pack(found%branches(b)%dead, found%branches(b)%dead > 0))%limit%links(1) > 0)) cycle
         call set_middle(found, found%branches(b), held, middle)
         call find_range(held, middle, found%drive, r, limits_only=.true.)
         ! Lost slowly, and so would the others be: their links stay without names.
         if (is_lost(r, low) .or. is_lost(r, high)) return
         do side = low, high
            if (found%branches(b)%dead(side) == 0 .or. .not. r%has_limit(side)) cycle
            associate (dead => found%dead(found%branches(b)%dead(side))%limit)
               if (dead%links(1) > 0 .or. abs(off_by(found%curve, r%limit(side)%value - dead%value)) > agrees) cycle
               r%limit(side)%value = dead%value
               dead = r%limit(side)
            end associate
         end do
      end do
   end subroutine name_limits

   !> Puts `middle` where the drive moves the fastest on branch `b`, with the drive of `held` there.
   subroutine set_middle(found, b, held, middle)
      type(circuits_t), intent(in) :: found
      type(circuit_branch_t), intent(in) :: b
      type(mechanism_t), intent(inout) :: held
      type(motion_t), intent(inout) :: middle
      integer :: k

      associate (points => found%list(b%circuit)%points)
         k = b%first - 1 + maxloc(abs(points(b%first:b%last)%value(1)), dim=1)
         middle%position = deck_position(found%curve, points(k)%q)
         held%drives(found%drive)%polynomial(1) = drive_value(found%curve, points(k)%value(0))
      end associate
   end subroutine set_middle

   !> A difference `x` of the drive's values in rad, without whole turns, or in lengths of the curve.
   pure real(wp) function off_by(c, x)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: x

      off_by = x/c%closure%length
      if (c%is_angle) off_by = without_turns(x)
   end function off_by
end module circuits
