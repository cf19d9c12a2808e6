!> Several variants of a set, of which only rows are requested, solved together. Each variant begins by the ordinary
!> analysis. Lanes take over after three instants, and go on as long as they can certify each step. The ordinary
!> analysis comes in again if a lane is refused. If EXTREMES may have an extreme between instants that a lane has
!> found, the ordinary analysis searches for it. What happens in one lane depends on this lane only.
module lane_runs
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, instant, instant_count
   use motion, only: flag_none
   use predictor, only: has_equal_steps
   use drive_deviation, only: judge_step
   use analysis, only: restore_instant
   use set_analysis, only: set_analysis_t, advance_set, accept_state, errors_in_doubt
   use column_search, only: find_next
   use extreme_search, only: is_searched, search_instant
   use answers, only: answers_t, new_answers, update_answers
   use rows, only: finished_row_t
   use counts, only: counts_t, record_flag
   use system_calls, only: signal_received
   use lane_sines, only: lane_count
   use lane_state, only: lanes_t, is_covered, make_lanes, load_lane, unload_lane, depth
   use lane_steps, only: step_check_t, solve_lanes, accept_lanes, keep_lane
   implicit none
   private
   public :: lane_run_t, begin_run, run_lanes, lane_count

   !> Instants that the ordinary analysis solves after a lane is refused for the first time: a prediction takes three.
   !> Each further time they are twice as many.
   integer, parameter :: first_retry_interval = 3
   !> Steps of one set differ by this part at most: the bounds of the drives are asked for a step that is so much
   !> longer.
   real(wp), parameter :: step_margin = 1.0e-6_wp
   !> A step is short if the prediction from three motions is off by less, in rad or the unit of length.
   real(wp), parameter :: fine_prediction = 1.0e-7_wp

   !> A variant, and how far its run has come.
   type :: lane_run_t
      type(mechanism_t) :: m                !< the variant
      type(counts_t) :: counts              !< of its instants so far
      type(answers_t) :: asked              !< the answers to its cards
      type(set_analysis_t) :: s             !< the analysis, which stays behind while a lane has the run
      integer :: at = -1                    !< the number of the last instant solved
      integer :: last = -1                  !< the number of the last instant of the set
      integer :: retry_after = first_retry_interval  !< instants of the ordinary analysis before a lane is tried again
      logical :: in_simd_lane = .false.     !< a lane has the run
      logical :: is_over = .true.           !< nothing is left to do
   end type lane_run_t

contains

   !> Makes a run ready for its first instant.
   subroutine begin_run(run)
      type(lane_run_t), intent(inout) :: run   !< run%s is ready for the first instant of the variant run%m

      call new_answers(run%s, .false., run%asked)
      run%at = -1
      run%last = instant_count(run%m) - 1
      run%retry_after = first_retry_interval
      run%is_over = .false.
      run%in_simd_lane = .false.
      run%counts = counts_t()
   end subroutine begin_run

   !> Solves the runs that are not over to their ends, or to a signal. Instants that lanes refuse are solved by the
   !> analysis of the run.
   subroutine run_lanes(runs, lanes)
      type(lane_run_t), intent(inout) :: runs(:)   !< at most as many as there are lanes; run i has lane i
      type(lanes_t), intent(inout) :: lanes   !< made for the first run that they take
      type(step_check_t) :: check
      real(wp), dimension(lane_count) :: t, t0, span, at, all_steps, active
      integer :: i, k, steps
      logical :: in_simd_lane, searches

      do i = 1, size(runs)
         call hand_to_lane(runs(i), lanes, i)
      end do

      ! Lanes without a variant do what one of the others does: their numbers must be numbers.
      if (any(runs%in_simd_lane)) then
         k = findloc(runs%in_simd_lane, .true., dim=1)
         do i = 1, lane_count
            in_simd_lane = .false.
            if (i <= size(runs)) in_simd_lane = runs(i)%in_simd_lane
            if (.not. in_simd_lane) call load_run(runs(k), lanes, i, in_simd_lane)
         end do
      end if

      do while (any(runs%in_simd_lane) .and. signal_received() == 0)
         ! Step k ends at t0 + span (at + k)/all_steps, as in `instant`. Lanes without a variant stay where they are.
         steps = huge(steps)
         t0 = lanes%t(:, lanes%slot(0))
         span = 0.0_wp
         at = 0.0_wp
         all_steps = 1.0_wp
         active = 0.0_wp
         do i = 1, size(runs)
            if (.not. runs(i)%in_simd_lane) cycle
            associate (m => runs(i)%m)
               t0(i) = m%t0
               span(i) = m%t1 - m%t0
               at(i) = real(runs(i)%at, wp)
               all_steps(i) = real(m%steps, wp)
               active(i) = 1.0_wp
               steps = min(steps, merge(1, m%steps - runs(i)%at, runs(i)%asked%wants_extremes))
            end associate
         end do

         do k = 1, steps
            t = t0 + span*(at + k)/all_steps
            call solve_lanes(lanes, t, check)
            if (k == steps .or. dot_product(check%refused, active) > 0.5_wp .or. signal_received() > 0) exit
            call accept_lanes(lanes, t)
         end do
         do i = 1, size(runs)
            if (.not. runs(i)%in_simd_lane) cycle
            call count_instants(runs(i), k - 1)
            call accept_step(runs(i), lanes, i, check, t(i))
         end do
         call accept_lanes(lanes, t)

         do i = 1, size(runs)
            associate (r => runs(i), x => runs(i)%asked%extremes)
               if (r%in_simd_lane .and. r%asked%wants_extremes) then
                  searches = is_searched(x, r%s, 1)
                  if (searches) call return_to_analysis(r, lanes, i)
                  call search_instant(x, r%s, 1, r%at, searches)
               end if
            end associate
            call hand_to_lane(runs(i), lanes, i)
         end do
      end do
   end subroutine run_lanes

   !> Takes the step of a run that its lane has made, unless the ordinary analysis must make the step:
   !>
   !> - the lane is refused;
   !> - the instant is the last of TIME, and instants of AT follow;
   !> - with EXTREMES also in long steps and at the last instant of TIME, of which they take more.
   subroutine accept_step(run, lanes, i, check, t)
      type(lane_run_t), intent(inout) :: run   !< in its lane
      type(lanes_t), intent(inout) :: lanes   !< with the step; get the run's motion again if the analysis solves it
      integer, intent(in) :: i               !< the number of the lane
      type(step_check_t), intent(in) :: check   !< of the step
      real(wp), intent(inout) :: t           !< time of the end of the step; then of the run's last instant
      logical :: is_refused, counts

      is_refused = check%refused(i) > 0.5_wp
      if (is_refused) run%retry_after = 2*run%retry_after
      counts = .not. is_refused
      if (run%asked%wants_extremes) then
         counts = counts .and. check%correction(i) <= fine_prediction .and. run%at + 1 < run%m%steps
         if (counts) call update_extremes(run, lanes, i, t, counts)
      else if (run%at + 1 == run%m%steps) then
         counts = counts .and. run%at + 1 == run%last
      end if
      if (counts) then
         call count_instants(run, 1)
         return
      end if

      call return_to_analysis(run, lanes, i)
      run%in_simd_lane = .false.
      call advance_run(run, run%at + merge(run%retry_after, 1, is_refused))
      call keep_lane(lanes, i)
      t = lanes%t(i, lanes%slot(0))
   end subroutine accept_step

   !> Counts instants of a run that are solved and regular.
   pure subroutine count_instants(run, n)
      type(lane_run_t), intent(inout) :: run   !< in its lane
      integer, intent(in) :: n               !< how many instants are new, at least 0

      run%at = run%at + n
      run%counts%solved = run%counts%solved + n
      run%is_over = run%at == run%last
      run%in_simd_lane = .not. run%is_over
   end subroutine count_instants

   !> Hands a run to a lane as soon as the lane can take it; until then the ordinary analysis solves the instants. A run
   !> that is over or has its lane stays as it is.
   subroutine hand_to_lane(run, lanes, i)
      type(lane_run_t), intent(inout) :: run   !< with its analysis at its last instant
      type(lanes_t), intent(inout) :: lanes   !< with a lane that is free
      integer, intent(in) :: i               !< the number of the lane

      do while (.not. (run%is_over .or. run%in_simd_lane) .and. signal_received() == 0)
         call load_run(run, lanes, i, run%in_simd_lane)
         if (run%in_simd_lane) return
         if (run%at >= 2) run%retry_after = 2*run%retry_after
         call advance_run(run, run%at + run%retry_after)
      end do
   end subroutine hand_to_lane

   !> Loads a lane with the motions of a run, if lanes can take them. Lanes take one mechanism by METHOD NEWTON whose
   !> last instant has all of its motion. Its last three motions have equal steps, which need no substeps, and no limit
   !> is known.
   subroutine load_run(run, lanes, i, is_done)
      type(lane_run_t), intent(inout) :: run   !< with its analysis at its last instant
      type(lanes_t), intent(inout) :: lanes   !< made, if they are not yet
      integer, intent(in) :: i               !< the number of the lane
      logical, intent(out) :: is_done        !< the lane has the motions
      real(wp) :: step, away

      is_done = .false.
      if (run%at < 2 .or. run%at >= run%m%steps .or. size(run%s%list) > 1 .or. run%m%method /= method_newton) return
      if (run%s%now%motions(1)%known < 2 .or. run%s%now%motions(1)%flag /= flag_none) return
      step = instant(run%m, run%at + 1) - instant(run%m, run%at)
      associate (a => run%s%list(1))
         call restore_instant(a)
         if (.not. a%follows .or. any(a%limits%known) .or. run%s%now%motions(1)%rests) return
         call judge_step(a%drives, (1.0_wp + step_margin)*step, away, is_done)
         if (.not. is_done) return
         is_done = .false.
         if (.not. is_covered(a%continuation_t)) return
         if (.not. has_equal_steps(a%history, step)) return
         if (.not. allocated(lanes%moving)) call make_lanes(lanes, a%continuation_t)
         call load_lane(lanes, i, a%continuation_t, is_done)
         lanes%excursion(i) = away
      end associate
   end subroutine load_run

   !> Solves the next instants of a run by the ordinary analysis, or fewer at a signal.
   subroutine advance_run(run, last)
      type(lane_run_t), intent(inout) :: run   !< without a lane
      integer, intent(in) :: last            !< the number of the last instant to be solved, if there is one
      type(finished_row_t) :: no_rows(0)
      integer :: k

      do k = run%at + 1, min(last, run%last)
         call advance_set(run%s, instant(run%m, k))
         call record_flag(run%counts, run%s)
         if (run%asked%takes_instants) call update_answers(run%asked, run%s, no_rows, k, .true.)
         run%at = k
         if (signal_received() > 0) return
      end do
      run%is_over = run%at == run%last
   end subroutine advance_run

   !> Gives the EXTREMES of a run the motion that its lane has found. They do not take the motion if a number is out of
   !> range or a digit is in doubt.
   subroutine update_extremes(run, lanes, i, t, is_done)
      type(lane_run_t), intent(inout) :: run   !< in its lane; its analysis gets the state
      type(lanes_t), intent(in) :: lanes     !< with the motion
      integer, intent(in) :: i               !< the number of the lane
      real(wp), intent(in) :: t              !< time of the motion
      logical, intent(out) :: is_done        !< the motion is taken
      integer :: u, k

      call restore_instant(run%s%list(1))
      associate (s => run%s%list(1)%state)
         do u = 1, ubound(s%u, 1)
            associate (x => s%u(u))
               x%value = lanes%u(u)%value(i)
               x%rate = lanes%u(u)%rate(i)
               x%acceleration = lanes%u(u)%acceleration(i)
               x%c = lanes%u(u)%c(i)
               x%s = lanes%u(u)%s(i)
            end associate
         end do
         do k = 1, size(lanes%moving)
            s%jacobian(lanes%moving(k))%pivot = lanes%block(lanes%moving(k))%pivot(i, lanes%slot(depth - 1))
         end do
      end associate
      call accept_state(run%s, t, is_done)
      if (is_done) call find_next(run%asked%extremes, run%s, 1, t, errors_in_doubt)
   end subroutine update_extremes

   !> Gives the analysis of a run the motions of its lane, for the next instants or for times between instants.
   subroutine return_to_analysis(run, lanes, i)
      type(lane_run_t), intent(inout) :: run   !< the analysis of the run gets the motions
      type(lanes_t), intent(in) :: lanes     !< with three motions of the run
      integer, intent(in) :: i               !< the number of the lane

      associate (a => run%s%list(1))
         call restore_instant(a)
         call unload_lane(lanes, i, a%continuation_t)
         run%s%is_in_lane = .false.
         a%t = a%history%t(0)
      end associate
   end subroutine return_to_analysis
end module lane_runs
