!> How extremes are found, instant by instant. The instants, and the joints of the drives' laws, are nodes, between
!> which `column_search` searches.
!>
!> Between three instants it searches if a number turns: a velocity, an acceleration or its derivative has changed its
!> sign, or an acceleration is not a simple curve. Otherwise no number has an extreme there. The motion of a set and the
!> lanes of `lane_runs` are searched in one way.
!>
!> Pieces of a step end at change points, limits of motion and instants without velocities. Each piece has nodes up to
!> near that place, and the one-sided limits there may be extremes. The time between is not searched, which the table
!> shows. On each side of a change point a number is a smooth function of the time that is left; at a limit of the
!> motion it is a smooth function of the root s of that time: x0 + x1 s + x2 s^2 ... It is computed at s, 2s, ... 5s,
!> and extrapolated to s = 0 by the polynomial through these five in s^2 or in s; or it grows without bound with 1/s,
!> as velocities do at a limit.
module extreme_search
   use kinds, only: wp
   use motion, only: motion_t, singular_change, diagnostic_change, diagnostic_limit
   use set_motion, only: apart_from
   use set_analysis, only: set_analysis_t, errors_in_doubt, errors_always
   use nodes, only: node_t, extreme_t, times_between, joint_margin
   use extremes, only: extremes_t, piece_end_t, offer, badly_known, add_interval, coordinate_t, greatest, least
   use column_search, only: find_node, find_next, add_node, search_waiting
   use columns, only: is_ratio
   implicit none
   private
   public :: record_instant, is_searched, search_instant

   !> Limits with smaller errors, in characteristic values, are good enough.
   real(wp), parameter :: well_known_limit = max(1.0e-7_wp, 1.0e3_wp*epsilon(1.0_wp))
   !> Otherwise they are tried nearer to a change point by this factor, though roundings grow there; or farther from a
   !> limit of the motion, near which some of the motion may not be found.
   real(wp), parameter :: nearer_by = 0.25_wp, farther_by = 4.0_wp
   !> Up to so many such tries.
   integer, parameter :: max_nearer = 5, max_farther = 8
   !> The places near an end of a piece.
   integer, parameter :: places = 5
   !> The distance of the nearest place from the end, in steps of TIME. At a change point rounding errors of
   !> accelerations are divided by the square of that distance, and the polynomial has an error of its fifth power; at
   !> a limit of the motion the power is 5/2.
   real(wp), parameter :: from_change_point = 1.0_wp/256.0_wp, &
      from_limit = max(1.0e-5_wp, epsilon(1.0_wp)**(1.0_wp/3.0_wp))
   !> (places, 2, 2) The polynomials at s = 0: through the five places, and through the first four for an estimate of
   !> the error; in time, and in its root.
   real(wp), parameter :: at_zero(places, 2, 2) = reshape([ &
      5.0_wp/3.0_wp, -20.0_wp/21.0_wp, 5.0_wp/14.0_wp, -5.0_wp/63.0_wp, 1.0_wp/126.0_wp, &
      1.6_wp, -0.8_wp, 8.0_wp/35.0_wp, -1.0_wp/35.0_wp, 0.0_wp, &
      5.0_wp, -10.0_wp, 10.0_wp, -5.0_wp, 1.0_wp, 4.0_wp, -6.0_wp, 4.0_wp, -1.0_wp, 0.0_wp], [places, 2, 2])
   !> A number that grows by more than this factor when s is halved is UNBOUNDED: 1/s doubles, s^(-2/3) grows by 1.59.
   !> Numbers below this part of their characteristic value are bounded.
   real(wp), parameter :: unbounded_growth = 1.4_wp, bounded_part = 1.0e-3_wp

contains

   !> Takes an instant, to which the set has advanced, and searches up to it. Only the instants of TIME count.
   subroutine record_instant(extremes, set, k)
      type(extremes_t), intent(inout) :: extremes   !< of the run so far
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      integer, intent(in) :: k               !< the number of the instant, from 0
      integer :: c

      if (k > set%now%steps) return
      do c = 1, size(extremes%tracks)
         if (size(extremes%tracks(c)%coordinates) == 0) cycle
         call find_next(extremes, set, c, set%now%motions(c)%t, errors_in_doubt)
         call search_instant(extremes, set, c, k, is_searched(extremes, set, c))
      end do
   end subroutine record_instant

   !> Tells whether something is searched for between the last instant of a mechanism and the one whose node is found: a
   !> number may turn, the step is divided, or the motion is not known at one of both.
   pure logical function is_searched(extremes, set, part)
      type(extremes_t), intent(in) :: extremes   !< of the run so far
      type(set_analysis_t), intent(in) :: set   !< at the instant
      integer, intent(in) :: part            !< number of the mechanism

      associate (track => extremes%tracks(part), q => set%now%motions(part))
         is_searched = (track%filled == 2 .and. track%turns) .or. track%last%is_open .or. allocated(q%diagnostics) &
            .or. .not. track%nodes(track%filled + 1)%is_known .or. abs(q%t - track%last%t) > track%longest
         if (.not. is_searched .and. size(track%joints) > 0) &
            is_searched = size(times_between(track%joints, track%longest, extremes%run, track%last%t, q%t)) > 0
      end associate
   end function is_searched

   !> Searches for extremes of a mechanism up to an instant whose node is found, and goes on from there.
   subroutine search_instant(extremes, set, part, k, searches)
      type(extremes_t), intent(inout) :: extremes   !< of the run so far
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      integer, intent(in) :: part            !< number of the mechanism
      integer, intent(in) :: k               !< number of the instant, from 0
      logical, intent(in) :: searches        !< something is searched for, by `is_searched`
      type(node_t) :: now
      real(wp) :: t
      logical :: known

      associate (track => extremes%tracks(part), q => set%now%motions(part))
         t = q%t
         track%halvings = 0
         if (searches .and. k > 0) then
            now = track%nodes(track%filled + 1)
            known = now%is_known
            call search_step()
            track%nodes(track%filled + 1) = now
            track%turns = .true.
         end if

         associate (node => track%nodes(track%filled + 1))
            known = node%is_known
            track%is_lost = node%is_lost
         end associate
         call add_node(extremes, set, part)
         if (k == set%now%steps) call search_waiting(extremes, set, part)
         if (k == set%now%steps) then
            track%closure = apart_from(set%now, part, set%now%first(part))
            call convert_ratio_extremes(track%coordinates)
         end if
         if (.not. known) call add_interval(extremes%gaps, extremes%way, t, t, 0.0_wp)
         track%last = piece_end_t(t, .not. known, q%singularity == singular_change)
      end associate

   contains

      !> Searches between the last instant of mechanism `part` and instant number `k`, at `t`.
      subroutine search_step()
         real(wp), allocatable :: ends(:), times(:)
         type(piece_end_t) :: from, to
         logical :: is_limit
         integer :: i

         associate (track => extremes%tracks(part), t1 => extremes%tracks(part)%last%t)
            call find_ends(extremes, set%now%motions(part), t1, ends, is_limit)
            if (set%now%motions(part)%known >= 0) ends = [ends, t]
            if (track%is_lost) ends = [real(wp) ::]
            times = times_between(track%joints, track%longest, extremes%run, t1, t)
            from = track%last
            do i = 1, size(ends)
               to = piece_end_t(ends(i), i < size(ends) .or. is_limit .or. .not. known, &
                  i < size(ends) .or. (set%now%motions(part)%singularity == singular_change .and. .not. is_limit))
               call search_piece(times, from, to)
               from = piece_end_t(ends(i), .true., .true.)
            end do
            if (abs(t - from%t) > 0.0_wp) call add_interval(extremes%gaps, extremes%way, from%t, t, 0.0_wp)
         end associate
      end subroutine search_step

      !> Searches a piece of a step, with nodes at the times that are inside.
      subroutine search_piece(times, from, to)
         real(wp), intent(in) :: times(:)    !< (any number) of nodes, in the run's order
         type(piece_end_t), intent(in) :: from, to   !< the ends of the piece, in the run's order
         real(wp) :: low, high, near(places)
         integer :: i

         low = from%t
         high = to%t

         if (from%is_open) then
            call search_waiting(extremes, set, part)
            extremes%tracks(part)%filled = 0
            call accept_limits(extremes, set, part, from, to%t, near)
            low = near(places)
            call evaluate_at(near(1), .true.)
            call add_interval(extremes%open, extremes%way, from%t, &
               merge(near(1), to%t, extremes%tracks(part)%filled > 0), 0.0_wp)
            call evaluate_at(low, .true.)
         end if
         if (to%is_open) then
            call accept_limits(extremes, set, part, to, from%t, near)
            high = near(places)
         end if

         do i = 1, size(times)
            if ((times(i) - low)*extremes%way > 0.0_wp .and. (high - times(i))*extremes%way > 0.0_wp) &
               call evaluate_at(times(i), .false.)
         end do

         if (.not. to%is_open) return
         call evaluate_at(high, .true.)
         call evaluate_at(near(1), .true.)
         call search_waiting(extremes, set, part)
         low = from%t
         if (extremes%tracks(part)%filled > 0) low = extremes%tracks(part)%nodes(1)%t
         call add_interval(extremes%open, extremes%way, low, to%t, 0.0_wp)
      end subroutine search_piece

      !> Takes a node at a time, and searches up to it. If its motion is not known, the time is a gap.
      subroutine evaluate_at(t, always)
         real(wp), intent(in) :: t           !< time
         logical, intent(in) :: always       !< errors are estimated even if no digit of a table is in doubt

         associate (track => extremes%tracks(part))
            call find_next(extremes, set, part, t, merge(errors_always, errors_in_doubt, always))
            if (track%nodes(track%filled + 1)%is_known) then
               call add_node(extremes, set, part)
            else
               call add_interval(extremes%gaps, extremes%way, t, t, 0.0_wp)
            end if
         end associate
      end subroutine evaluate_at
   end subroutine search_instant

   !> Finds the times at which a change point was passed, or the limit of the motion was reached, which is the last
   !> one. A change point that is later only by rounding is the one before, or the last instant itself.
   pure subroutine find_ends(extremes, q, from, ends, is_limit)
      type(extremes_t), intent(in) :: extremes   !< of the set
      type(motion_t), intent(in) :: q        !< at the end of the step: has diagnostics
      real(wp), intent(in) :: from           !< time of the last instant
      real(wp), allocatable, intent(out) :: ends(:)   !< (any number) times, in the run's order
      logical, intent(out) :: is_limit       !< the last one is a limit of the motion
      real(wp) :: last
      integer :: i

      allocate (ends(0))
      is_limit = .false.
      if (.not. allocated(q%diagnostics)) return
      last = from
      do i = 1, size(q%diagnostics)
         associate (d => q%diagnostics(i))
            if (d%kind /= diagnostic_limit .and. .not. (d%kind == diagnostic_change .and. .not. d%here)) cycle
            if ((d%t - last)*extremes%way <= merge(joint_margin(extremes%run, last), 0.0_wp, &
               d%kind == diagnostic_change)) cycle
            is_limit = d%kind == diagnostic_limit
            if ((q%t - d%t)*extremes%way <= 0.0_wp .and. .not. is_limit) cycle
            ! A limit at the instant itself is later only by rounding.
            last = extremes%way*min(extremes%way*d%t, extremes%way*q%t)
            ends = [ends, last]
         end associate
      end do
   end subroutine find_ends

   !> Offers the one-sided limits at an end of a piece as extremes, by the motion at times near the end. Of the times
   !> that were tried those count from which the limits are known best. If the motion is not known at any, nothing is
   !> offered.
   subroutine accept_limits(extremes, set, part, at, other, near)
      type(extremes_t), intent(inout) :: extremes   !< gets the limits
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      integer, intent(in) :: part            !< number of the mechanism
      type(piece_end_t), intent(in) :: at    !< the end of the piece
      real(wp), intent(in) :: other          !< time of the other end of the piece
      real(wp), intent(out) :: near(places)   !< the times that count, the nearest first, or the last ones tried
      type(node_t) :: nodes(places)
      type(extreme_t), dimension(0:2, size(extremes%tracks(part)%coordinates)) :: limits, best
      real(wp) :: times(places), nearest, error, least_error, f(places), five(places), four(places)
      integer :: i, k, n, try

      five = at_zero(:, 1, merge(1, 2, at%is_change))
      four = at_zero(:, 2, merge(1, 2, at%is_change))
      least_error = huge(1.0_wp)
      do try = 0, merge(max_nearer, max_farther, at%is_change)
         ! The nearest first, on the side of `other`.
         nearest = merge(nearer_by**try*from_change_point, farther_by**try*from_limit, at%is_change)*extremes%step
         nearest = min(nearest, abs(other - at%t)/(2*places**2))
         times = at%t + sign(nearest, other - at%t)*[(i**2, i=1, places)]
         do i = 1, places
            call find_node(set, extremes%tracks(part), times(i), errors_always, nodes(i))
            if (.not. nodes(i)%is_known) exit
         end do
         if (i <= places) cycle

         ! The largest error of the limits that have a bound, in characteristic values or as a part of larger ones.
         ! A limit that is badly known does not exist.
         error = 0.0_wp
         do k = 1, size(limits, 2)
            do i = 0, 2
               associate (one => limits(i, k), size_of => extremes%tracks(part)%coordinates(k)%size_of(i))
                  one = extreme_t()
                  ! Points of a measure coincide.
                  if (any([(nodes(n)%samples(k)%known < 2, n=1, places)])) cycle
                  f = [(nodes(n)%samples(k)%f(i), n=1, places)]
                  one = extreme_t(is_located=.true., t=at%t, value=dot_product(five, f))
                  one%error = 2.0_wp*abs(dot_product(five - four, f)) &
                     + maxval([(nodes(n)%samples(k)%error(i), n=1, places)])
                  one%has_bound = at%is_change .or. abs(f(1)) < unbounded_growth*abs(f(2)) &
                     .or. abs(f(1)) < bounded_part*size_of
                  if (.not. one%has_bound) one%value = f(1)
                  one%exists = .not. one%has_bound .or. one%error <= badly_known*max(size_of, abs(one%value))
                  if (one%has_bound) error = max(error, one%error/max(size_of, abs(one%value)))
               end associate
            end do
         end do

         if (error < least_error) then
            least_error = error
            best = limits
            near = times
         end if
         if (least_error < well_known_limit) exit
      end do

      if (least_error >= huge(1.0_wp)) near = times
      do k = 1, size(best, 2)
         do i = 0, 2
            if (best(i, k)%exists) call offer(extremes%tracks(part)%coordinates(k), i, best(i, k), 0.0_wp)
         end do
      end do
   end subroutine accept_limits

   !> Converts the extremes of the rates of ratios to extremes of the derivatives of the ratios by the drive.
   pure subroutine convert_ratio_extremes(coordinates)
      type(coordinate_t), intent(inout) :: coordinates(:)   !< (any number) after the last instant
      integer :: i

      do i = 1, size(coordinates)
         associate (c => coordinates(i), rate => coordinates(i)%drive_rate)
            if (.not. (is_ratio(c%form) .and. c%sought(2))) cycle
            c%found(:, 2)%value = c%found(:, 2)%value/rate
            c%found(:, 2)%error = c%found(:, 2)%error/abs(rate)
            c%size_of(2) = c%size_of(2)/abs(rate)
            if (rate < 0.0_wp) c%found(:, 2) = c%found([greatest, least], 2)
         end associate
      end do
   end subroutine convert_ratio_extremes
end module extreme_search
