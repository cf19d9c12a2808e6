!> How extremes are found, instant by instant. The instants, and the joints of the drives' laws, are nodes, between
!> which `column_search` searches.
!>
!> In short steps that is done where a number has turned: a velocity or an acceleration has changed its sign, or an
!> acceleration has begun to fall or to rise, or its values at five instants are not those of a simple curve. Where
!> nothing of that has happened no number has an extreme. The engine and the lanes of `lane_runs` are watched alike.
!>
!> A step is divided where not all of the motion exists: at change points and at a limit of the motion, and it has such
!> an end at an instant without all of its motion. Each piece has nodes up to beside that place, and the one-sided
!> limits there may be extremes. What is closer is not searched, and the table says so.
module extreme_search
   use kinds, only: wp
   use motion, only: motion_t, singular_change, diagnostic_change, diagnostic_limit
   use set_analysis, only: set_analysis_t
   use predictor, only: is_even
   use digits_in_doubt, only: safe_growth
   use zero_search, only: noise_part
   use nodes, only: node_t, sample_of, extreme_t, times_between, beside_joint, limits_of, places, &
      places_beside
   use extremes, only: extremes_t, coordinate_t, watch_t, end_t, alike, offer, badly_known, note_end, note_interval
   use column_search, only: find_node, add_node, search_passed, search_waiting, misses_by, overlooked
   implicit none
   private
   public :: note_instant, watch_instant, search_instant, fine_prediction

   !> Steps are short where the prediction from three motions is off by less, in rad or the unit of length: its error is
   !> that of the seventh order. Longer ones are always searched.
   real(wp), parameter :: fine_prediction = 1.0e-7_wp
   !> Limits with smaller errors are good enough. Otherwise they are tried from this much nearer to a change point,
   !> where roundings grow, or farther from a limit of the motion, beside which some of it may not be found; so many
   !> times at most.
   real(wp), parameter :: well_known = max(1.0e-7_wp, 1.0e3_wp*epsilon(1.0_wp)), nearer = 0.25_wp, farther = 4.0_wp
   integer, parameter :: max_nearer = 5, max_farther = 8

contains

   !> Takes instant number `k`, to which `s` has advanced. Only the instants of TIME count.
   subroutine note_instant(x, s, k)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: k
      logical :: is_fine
      integer :: c

      if (k > s%now%steps) return
      do c = 1, size(x%tracks)
         associate (track => x%tracks(c), a => s%list(c), e => s%list(c)%engine)
            if (size(track%coordinates) == 0) cycle
            call find_node(s, track%asked, track%coordinates, s%now%motions(c)%t, track%nodes(track%place(7)), .false.)
            is_fine = a%follows .and. a%convergence%change <= fine_prediction .and. .not. e%tolerance > 0.0_wp
            if (is_fine) is_fine = size(e%history%predicted) > 0 &
               .and. is_even(e%history, s%now%motions(c)%t - track%last%t)
         end associate
         call watch_instant(x, s, c, k, is_fine)
         call search_instant(x, s, c, k)
      end do
   end subroutine note_instant

   !> Takes the node at instant number `k` of mechanism `c`. `turned_in` of its track: in so many of the last steps
   !> something may have turned; in both of the last two, if the step was divided, or if it is not known to be a short
   !> one (`is_fine`).
   subroutine watch_instant(x, s, c, k, is_fine)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(in) :: s
      integer, intent(in) :: c, k
      logical, intent(in) :: is_fine
      logical :: is_plain

      associate (track => x%tracks(c), now => x%tracks(c)%nodes(x%tracks(c)%place(7)), t1 => x%tracks(c)%last%t, &
         q => s%now%motions(c))
         now%begins_pair = mod(k, 2) == 0
         if (now%is_known) then
            call look_on(track%coordinates, now, track%turned_in)
         else
            track%coordinates%watch = watch_t()
         end if
         ! At its ends a run is searched.
         is_plain = now%is_known .and. is_fine .and. k > 0 .and. k < s%now%steps .and. now%growth < safe_growth &
            .and. .not. (track%last%is_open .or. q%rests .or. allocated(q%diagnostics)) &
            .and. 2.0_wp*abs(now%t - t1) <= track%longest
         if (is_plain .and. size(track%joints) > 0) is_plain = .not. any((track%joints - t1)*(now%t - track%joints) &
            >= 0.0_wp) .and. size(times_between(track%joints, track%longest, x%run, t1, now%t)) == 0
         if (.not. is_plain) track%turned_in = 2
      end associate
   end subroutine watch_instant

   !> Takes the `node` of the next instant of the coordinates in the `list`. `turned_in`: in so many of the last steps
   !> one of them may have turned: a sign changes in the last one, an acceleration that begins to rise may have been at
   !> its least before that.
   pure subroutine look_on(list, node, turned_in)
      type(coordinate_t), intent(inout) :: list(:)
      type(node_t), intent(in) :: node
      integer, intent(out) :: turned_in
      real(wp) :: f(0:2), change, next(0:3)
      integer :: i, k, now

      turned_in = 0
      do i = 1, size(list)
         f = node%f(:, i)
         associate (one => list(i)%watch, size_of => list(i)%size_of)
            do k = 1, 2
               now = 0
               if (abs(f(k)) > noise_part*size_of(k)) now = merge(1, -1, f(k) > 0.0_wp)
               if (now /= one%signs(k)) turned_in = max(1, turned_in)
               one%signs(k) = now
            end do

            ! It goes on as a cubic does, but for a part of its last change.
            next(0) = f(2)
            do k = 1, 3
               next(k) = next(k - 1) - one%differences(k - 1)
            end do
            if (abs(next(3) - one%differences(3)) > misses_by*abs(next(1)) + overlooked*size_of(2)) turned_in = 2
            one%differences = next

            change = f(2) - one%acceleration
            if (.not. abs(change) > alike*size_of(2)) cycle
            now = merge(1, -1, change > 0.0_wp)
            if (now /= one%trend) turned_in = 2
            one%trend = now
            one%acceleration = f(2)
         end associate
      end do
   end subroutine look_on

   !> Searches up to instant number `k` of mechanism `c`, where `watch_instant` says so, and goes on from there.
   subroutine search_instant(x, s, c, k)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c, k
      real(wp) :: t
      logical :: known, is_lost

      associate (track => x%tracks(c), now => x%tracks(c)%nodes(x%tracks(c)%place(7)))
         t = now%t
         known = now%is_known
         is_lost = any(now%known < 0)
         track%halvings = 0
         if (track%turned_in > 0) call search_passed(x, s, c)
         if (k == 0) then
            track%start = s%now%motions(c)
         else if (track%turned_in > 0) then
            call search_step()
         end if
         track%place([6, 7]) = track%place([7, 6])
         call add_node(x, s, c)
         if (k == s%now%steps) call search_waiting(x, s, c)
         if (k == s%now%steps) call note_end(x, s%now%parts(c), c, s%now%motions(c))
         if (.not. known) call note_interval(x%gaps, x%way, t, t, 0.0_wp)
         track%last = end_t(t, .not. known, s%now%motions(c)%singularity == singular_change)
         track%is_lost = is_lost
      end associate

   contains

      !> Searches between the last instant of mechanism `c` and instant number `k`, at `t`.
      subroutine search_step()
         real(wp), allocatable :: ends(:), times(:)
         type(end_t) :: from, to
         logical :: is_limit
         integer :: i

         associate (track => x%tracks(c), t1 => x%tracks(c)%last%t)
            call find_ends(s%now%motions(c), t1, x%way, ends, is_limit)
            if (s%now%motions(c)%known >= 0) ends = [ends, t]
            if (track%is_lost) ends = [real(wp) ::]
            times = times_between(track%joints, track%longest, x%run, t1, t)
            from = track%last
            do i = 1, size(ends)
               to = end_t(ends(i), i < size(ends) .or. is_limit .or. .not. known, &
                  i < size(ends) .or. (s%now%motions(c)%singularity == singular_change .and. .not. is_limit))
               call search_piece(times, from, to)
               from = end_t(ends(i), .true., .true.)
            end do
            if (abs(t - from%t) > 0.0_wp) call note_interval(x%gaps, x%way, from%t, t, 0.0_wp)
         end associate
      end subroutine search_step

      !> The times after `from` at which the motion `q` says that a change point was passed, or its limit was reached:
      !> that is the last. A change point that is later only by rounding is the same one, or at `from` itself.
      pure subroutine find_ends(q, from, way, ends, is_limit)
         type(motion_t), intent(in) :: q
         real(wp), intent(in) :: from, way
         real(wp), allocatable, intent(out) :: ends(:)
         logical, intent(out) :: is_limit
         real(wp) :: last
         integer :: i

         allocate (ends(0))
         is_limit = .false.
         if (.not. allocated(q%diagnostics)) return
         last = from
         do i = 1, size(q%diagnostics)
            associate (d => q%diagnostics(i))
               if (d%kind /= diagnostic_limit .and. .not. (d%kind == diagnostic_change .and. .not. d%here)) cycle
               if ((d%t - last)*way <= merge(beside_joint(x%run, last), 0.0_wp, d%kind == diagnostic_change)) cycle
               is_limit = d%kind == diagnostic_limit
               if ((q%t - d%t)*way <= 0.0_wp .and. .not. is_limit) cycle
               ! A limit at the instant itself is later only by rounding.
               last = way*min(way*d%t, way*q%t)
               ends = [ends, last]
            end associate
         end do
      end subroutine find_ends

      !> Searches between the ends `from` and `to`, with nodes at those of the `times` that are between.
      subroutine search_piece(times, from, to)
         real(wp), intent(in) :: times(:)
         type(end_t), intent(in) :: from, to
         real(wp) :: low, high, beside(places)
         integer :: i

         low = from%t
         high = to%t
         if (from%is_open) then
            call search_waiting(x, s, c)
            x%tracks(c)%filled = 0
            call take_limits(from, to%t, beside)
            low = beside(places)
            call look_at(beside(1), .true.)
            call note_interval(x%open, x%way, from%t, merge(beside(1), to%t, x%tracks(c)%filled > 0), 0.0_wp)
            call look_at(low, .true.)
         end if
         if (to%is_open) then
            call take_limits(to, from%t, beside)
            high = beside(places)
         end if
         do i = 1, size(times)
            if ((times(i) - low)*x%way > 0.0_wp .and. (high - times(i))*x%way > 0.0_wp) &
               call look_at(times(i), .false.)
         end do
         if (.not. to%is_open) return
         call look_at(high, .true.)
         call look_at(beside(1), .true.)
         call search_waiting(x, s, c)
         low = from%t
         if (x%tracks(c)%filled > 0) low = x%tracks(c)%nodes(x%tracks(c)%place(1))%t
         call note_interval(x%open, x%way, low, to%t, 0.0_wp)
      end subroutine search_piece

      !> The one-sided limits at the end `at` of a piece to `other` may be extremes, by the motion at the times
      !> `beside`: of those that were tried the ones from which the limits are known best.
      subroutine take_limits(at, other, beside)
         type(end_t), intent(in) :: at
         real(wp), intent(in) :: other
         real(wp), intent(out) :: beside(places)
         type(node_t) :: near(places)
         type(extreme_t), dimension(0:2, size(x%tracks(c)%coordinates)) :: limits, best
         real(wp) :: times(places), sizes(0:2), error, least_error
         integer :: i, k, try

         least_error = huge(1.0_wp)
         do try = 0, merge(max_nearer, max_farther, at%is_change)
            times = places_beside(at%t, other, x%step, at%is_change, merge(nearer, farther, at%is_change)**try)
            do i = 1, places
               call find_node(s, x%tracks(c)%asked, x%tracks(c)%coordinates, times(i), near(i), .true.)
               if (.not. near(i)%is_known) exit
            end do
            if (i <= places) cycle

            ! The largest error of those that have a bound, in characteristic values or as a part of larger ones. What
            ! is badly known counts for nothing.
            error = 0.0_wp
            do k = 1, size(limits, 2)
               associate (size_of => x%tracks(c)%coordinates(k)%size_of, one => limits(:, k))
                  one = limits_of([(sample_of(near(i), k), i=1, places)], at%t, at%is_change, size_of)
                  sizes = max(size_of, abs(one%value))
                  error = max(error, maxval(one%error/sizes, mask=one%has_bound))
                  one%exists = one%error <= badly_known*sizes .or. .not. one%has_bound
               end associate
            end do
            if (error < least_error) then
               least_error = error
               best = limits
               beside = times
            end if
            if (least_error < well_known) exit
         end do
         if (least_error >= huge(1.0_wp)) beside = times
         do k = 1, size(best, 2)
            do i = 0, 2
               if (best(i, k)%exists) call offer(x%tracks(c)%coordinates(k), i, best(i, k), 0.0_wp)
            end do
         end do
      end subroutine take_limits

      !> Takes a node at the time `t`; `always`: see `look`.
      subroutine look_at(t, always)
         real(wp), intent(in) :: t
         logical, intent(in) :: always

         associate (track => x%tracks(c), node => x%tracks(c)%nodes(x%tracks(c)%place(6)))
            node%begins_pair = .false.
            call find_node(s, track%asked, track%coordinates, t, node, always)
            if (node%is_known) then
               call add_node(x, s, c)
            else
               call note_interval(x%gaps, x%way, t, t, 0.0_wp)
            end if
         end associate
      end subroutine look_at
   end subroutine search_instant
end module extreme_search
