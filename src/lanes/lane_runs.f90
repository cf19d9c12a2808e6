!> Several variants of a set, whose rows alone are asked for, solved together. Each begins by the ordinary engine; lanes
!> take over after three instants, and go on as long as they can certify each step. The ordinary engine comes in again
!> where a lane is refused and where a number of EXTREMES may have an extreme: there it goes back to an instant with an
!> even number, from the motions that the lane remembers, and searches as ever. What happens in one lane depends on that
!> lane alone.
module lane_runs
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, request_pair, instant, instant_count
   use motion, only: mark_none
   use structure, only: findings_t
   use points, only: row_t, find_row
   use predictor, only: is_even
   use drive_excursion, only: judge_step
   use analysis, only: come_back
   use block_engine, only: get_motion
   use digits_in_doubt, only: find_growth
   use set_analysis, only: set_analysis_t, make_set_analysis, renew_set_analysis, advance_set
   use extreme_search, only: note_instant
   use nodes, only: times_between
   use answers, only: answers_t, new_answers, take_instant
   use variant_rows, only: variant_row_t, note_flag
   use system_calls, only: signal_received
   use lane_sines, only: width
   use lane_state, only: lanes_t, is_covered, make_lanes, load_lane, unload_lane, depth
   use lane_steps, only: judgement_t, solve_lanes, accept_lanes, keep_lane
   use lane_watch, only: watched_t, look_on, fine_prediction
   implicit none
   private
   public :: lane_run_t, renew_run, begin_run, run_lanes, width

   !> Instants that the ordinary engine solves from where a lane is refused, at first: three, which a prediction takes;
   !> twice as many each time.
   integer, parameter :: first_patience = 3
   !> The steps in which extremes are searched for where a lane does not say how many.
   integer, parameter :: max_searched = 2
   !> What steps may differ by, at the bounds of what drives allow.
   real(wp), parameter :: slack = 1.0e-6_wp

   !> A variant, and how far it has come.
   type :: lane_run_t
      type(mechanism_t) :: m
      type(variant_row_t) :: row
      type(answers_t) :: asked
      type(set_analysis_t) :: s
      type(watched_t), allocatable :: watch(:)   !< (coordinates) of those that EXTREMES ask for
      type(row_t), allocatable :: rows(:)   !< room for theirs
      integer :: at = -1                    !< the last instant solved
      integer :: counted = -1               !< the last instant that the row has counted
      integer :: noted = -1                 !< the last instant that EXTREMES have taken
      integer :: seen = -1                  !< the last instant that the watch has seen
      integer :: patience = first_patience
      logical :: is_laned = .false.         !< a lane has it
      logical :: is_over = .true.           !< nothing is left to do
   end type lane_run_t

contains

   !> Makes `r`, which has solved a variant before, ready for the first instant of the variant r%m if that has the same
   !> structure: `is_done`.
   subroutine renew_run(r, is_done)
      type(lane_run_t), intent(inout) :: r
      logical, intent(out) :: is_done

      call renew_set_analysis(r%m, r%s, is_done)
      if (is_done) call begin_answers(r)
   end subroutine renew_run

   !> Makes `r` ready for the first instant of the variant r%m, whose structure is `findings`.
   subroutine begin_run(r, findings)
      type(lane_run_t), intent(inout) :: r
      type(findings_t), intent(inout) :: findings

      call make_set_analysis(r%m, r%s, findings)
      call begin_answers(r)
   end subroutine begin_run

   !> Nothing is known of any instant of `r` yet.
   subroutine begin_answers(r)
      type(lane_run_t), intent(inout) :: r

      call new_answers(r%s, .false., r%asked)
      if (r%asked%extremes_asked) then
         if (allocated(r%watch)) deallocate (r%watch)
         allocate (r%watch(size(r%asked%extremes%tracks(1)%coordinates)))
      end if
      r%at = -1
      r%counted = -1
      r%noted = -1
      r%seen = -1
      r%patience = first_patience
      r%is_over = .false.
      r%is_laned = .false.
   end subroutine begin_answers

   !> Solves all `runs` that are not over, at most as many as there are lanes, to their ends, or to a signal.
   subroutine run_lanes(runs, l)
      type(lane_run_t), intent(inout) :: runs(:)
      type(lanes_t), intent(inout) :: l
      type(judgement_t) :: j
      real(wp), dimension(width) :: t, t0, span, at, all_steps, goes_on
      integer :: i, k, steps
      logical :: is_laned

      do i = 1, size(runs)
         call take_over(runs(i), l, i)
      end do
      ! Lanes that no variant has do what one of them does: their numbers must be numbers.
      if (any(runs%is_laned)) then
         k = findloc(runs%is_laned, .true., dim=1)
         do i = 1, width
            is_laned = .false.
            if (i <= size(runs)) is_laned = runs(i)%is_laned
            if (.not. is_laned) call load_run(runs(k), l, i, is_laned)
         end do
      end if
      do while (any(runs%is_laned) .and. signal_received() == 0)
         ! Step k ends at t0 + span (at + k)/all_steps, as `instant` has it. Lanes without a variant stay where they
         ! are.
         steps = huge(steps)
         t0 = l%t(:, l%slot(0))
         span = 0.0_wp
         at = 0.0_wp
         all_steps = 1.0_wp
         goes_on = 0.0_wp
         do i = 1, size(runs)
            if (.not. runs(i)%is_laned) cycle
            associate (m => runs(i)%m)
               t0(i) = m%t0
               span(i) = m%t1 - m%t0
               at(i) = real(runs(i)%at, wp)
               all_steps(i) = real(m%steps, wp)
               goes_on(i) = 1.0_wp
               steps = min(steps, merge(1, m%steps - runs(i)%at, runs(i)%asked%extremes_asked))
            end associate
         end do
         do k = 1, steps
            t = t0 + span*(at + k)/all_steps
            call solve_lanes(l, t, j)
            if (k == steps .or. dot_product(j%refused, goes_on) > 0.5_wp .or. signal_received() > 0) exit
            call accept_lanes(l, t)
         end do
         do i = 1, size(runs)
            if (.not. runs(i)%is_laned) cycle
            call count_instants(runs(i), k - 1)
            call look_at_step(runs(i), l, i, j, t(i))
         end do
         call accept_lanes(l, t)
         do i = 1, size(runs)
            call take_over(runs(i), l, i)
         end do
      end do
   end subroutine run_lanes

   !> Lane `i` has made a step of `r`, to the time `t`: it counts, unless the engine must look.
   subroutine look_at_step(r, l, i, j, t)
      type(lane_run_t), intent(inout) :: r
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i
      type(judgement_t), intent(in) :: j
      real(wp), intent(inout) :: t
      integer :: steps

      steps = 0
      if (j%refused(i) > 0.5_wp) then
         steps = max_searched
         r%patience = 2*r%patience
      else if (r%at + 1 == r%m%steps .and. (r%asked%extremes_asked .or. instant_count(r%m) - 1 > r%m%steps)) then
         ! EXTREMES take more than instants beside the end of TIME, and beyond it there may be instants of AT.
         steps = max_searched
      else if (r%asked%extremes_asked) then
         call watch_lane(r, l, i, j%correction(i), steps)
      end if
      if (steps == 0) then
         call count_instants(r, 1)
      else
         call go_on_from_lane(r, l, i, steps, j%refused(i) > 0.5_wp)
         call keep_lane(l, i)
         t = l%t(i, l%slot(0))
      end if
   end subroutine look_at_step

   !> The next `n` instants of `r` are solved and regular.
   pure subroutine count_instants(r, n)
      type(lane_run_t), intent(inout) :: r
      integer, intent(in) :: n

      r%at = r%at + n
      r%counted = r%at
      r%row%solved = r%row%solved + n
      r%is_over = r%at == instant_count(r%m) - 1
      r%is_laned = .not. r%is_over
   end subroutine count_instants

   !> Lane `i` takes over `r`, unless it has it or `r` is over, as soon as it can; until then the engine solves it.
   subroutine take_over(r, l, i)
      type(lane_run_t), intent(inout) :: r
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i

      do while (.not. (r%is_over .or. r%is_laned) .and. signal_received() == 0)
         call load_run(r, l, i, r%is_laned)
         if (r%is_laned) return
         if (r%at >= 2) r%patience = 2*r%patience
         call by_engine(r, r%at + 1, r%at + r%patience, .false.)
      end do
   end subroutine take_over

   !> Loads lane `i` with the motions of `r`, if they are such as lanes need: `is_done`.
   subroutine load_run(r, l, i, is_done)
      type(lane_run_t), intent(inout) :: r
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i
      logical, intent(out) :: is_done
      real(wp) :: step, away

      is_done = .false.
      if (r%at < 2 .or. r%at >= r%m%steps .or. .not. may_be_laned(r)) return
      step = instant(r%m, r%at + 1) - instant(r%m, r%at)
      associate (a => r%s%list(1))
         call come_back(a)
         if (.not. a%follows .or. any(a%limits%known) .or. r%s%now%motions(1)%rests) return
         call judge_step(a%drives, (1.0_wp + slack)*step, away, is_done)
         if (.not. is_done) return
         is_done = .false.
         associate (e => a%engine)
            if (.not. is_covered(e)) return
            if (.not. is_even(e%history, step)) return
            if (.not. allocated(l%moving)) call make_lanes(l, e)
            call load_lane(l, i, e, is_done)
            l%excursion(i) = away
         end associate
      end associate
   end subroutine load_run

   !> One mechanism by METHOD NEWTON, whose last instant has all of its motion, and rows that lanes can watch.
   pure logical function may_be_laned(r)
      type(lane_run_t), intent(in) :: r

      may_be_laned = size(r%s%list) == 1 .and. r%m%method == method_newton
      if (.not. may_be_laned) return
      may_be_laned = r%s%now%motions(1)%known == 2 .and. r%s%now%motions(1)%mark == mark_none
      if (r%asked%extremes_asked) may_be_laned = may_be_laned &
         .and. all(r%m%requests(r%asked%extremes%asked)%kind <= request_pair)
   end function may_be_laned

   !> Instants `first` to `last` of `r`, as far as there are such, by the engine; one more, if EXTREMES search the last
   !> step with the next one. `starts`: EXTREMES begin anew there.
   subroutine by_engine(r, first, last, starts)
      type(lane_run_t), intent(inout) :: r
      integer, intent(in) :: first, last
      logical, intent(in) :: starts
      integer :: end, k, steps

      end = last
      if (r%asked%extremes_asked) end = end + mod(end, 2)
      do k = first, min(end, instant_count(r%m) - 1)
         call advance_set(r%s, instant(r%m, k))
         if (k > r%counted) call note_flag(r%row, r%s)
         r%counted = max(k, r%counted)
         if (starts .and. k == first) then
            call note_instant(r%asked%extremes, r%s, k, .true.)
         else
            call take_instant(r%asked, r%s, k, .true.)
         end if
         r%noted = k
         r%at = k
         if (r%asked%extremes_asked .and. k > r%seen .and. may_be_laned(r)) call show_rows(r, steps)
         r%seen = max(k, r%seen)
         if (signal_received() > 0) return
      end do
      r%is_over = r%at == instant_count(r%m) - 1
   end subroutine by_engine

   !> Shows the watch of `r` the rows that EXTREMES ask for, by the motion found last; `steps`: see `look_on`.
   subroutine show_rows(r, steps)
      type(lane_run_t), intent(inout) :: r
      integer, intent(out) :: steps
      integer :: i

      associate (asked => r%asked%extremes%asked, now => r%s%now)
         if (.not. allocated(r%rows)) allocate (r%rows(size(asked)))
         do i = 1, size(asked)
            call find_row(now%parts(1), now%motions(1), now%parts(1)%requests(asked(i)), r%rows(i))
         end do
      end associate
      call look_on(r%watch, r%asked%extremes%tracks(1)%coordinates, r%rows, steps)
   end subroutine show_rows

   !> The engine goes on with `r`, where lane `i` has not found the next instant (`is_refused`) or extremes may be in
   !> the last `steps`.
   subroutine go_on_from_lane(r, l, i, steps, is_refused)
      type(lane_run_t), intent(inout) :: r
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: i, steps
      logical, intent(in) :: is_refused
      integer :: first, last
      logical :: starts

      starts = .false.
      first = r%at + 1
      if (r%asked%extremes_asked) then
         first = r%at + 1 - steps
         first = max(first - mod(first, 2), r%noted + 1)
         starts = first > r%noted + 1
      end if
      last = r%at + 1
      if (is_refused) last = r%at + r%patience
      associate (a => r%s%list(1))
         call come_back(a)
         associate (e => a%engine)
            call unload_lane(l, i, r%at + 1 - first, e)
            a%t = e%history%t(0)
         end associate
      end associate
      r%is_laned = .false.
      call by_engine(r, first, last, starts)
   end subroutine go_on_from_lane

   !> At so many `steps` of `r` the engine must look, of which lane `i` has made the last.
   subroutine watch_lane(r, l, i, correction, steps)
      type(lane_run_t), intent(inout) :: r
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: i
      real(wp), intent(in) :: correction
      integer, intent(out) :: steps
      logical :: finite, turned
      real(wp) :: growth
      integer :: u, k

      steps = max_searched
      turned = correction > fine_prediction
      ! A step with joints, or that the engine divides, it searches.
      associate (track => r%asked%extremes%tracks(1), t1 => l%t(i, l%slot(0)), t2 => instant(r%m, r%at + 1))
         turned = turned .or. abs(t2 - t1) > track%longest
         if (size(track%joints) > 0) turned = turned .or. any((track%joints - t1)*(t2 - track%joints) >= 0.0_wp) &
            .or. size(times_between(track%joints, track%longest, r%asked%extremes%run, t1, t2)) > 0
      end associate
      if (turned) return
      associate (e => r%s%list(1)%engine)
         do u = 1, e%blocks%unknowns
            associate (x => e%state%u(u))
               x%value = l%u(u)%value(i)
               x%rate = l%u(u)%rate(i)
               x%acceleration = l%u(u)%acceleration(i)
               x%c = l%u(u)%c(i)
               x%s = l%u(u)%s(i)
            end associate
         end do
         do k = 1, size(l%moving)
            e%found(l%moving(k))%pivot = l%block(l%moving(k))%pivot(i, l%slot(depth - 1))
         end do
         call get_motion(e, r%s%now%motions(1), finite)
         call find_growth(r%s%estimators(1)%sizes, r%s%now%parts(1), e, r%s%now%motions(1), growth, turned)
         turned = turned .or. .not. finite
      end associate
      if (turned) return
      call show_rows(r, steps)
      r%seen = r%at + 1
   end subroutine watch_lane
end module lane_runs
