!> Speed against error (--study): methods, tolerances and predictors tried on a deck, each with the time of a step and
!> the error of the printed rows. The time alone (--time).
module study
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128, int64
   use kinds, only: wp, wp_name
   use failures, only: failure_t, status_solved, status_flagged
   use mechanism, only: mechanism_t, request_t, request_pair, method_newton, method_dense, method_matrix, &
      method_words, own_predictor, instant_count, instant
   use independent, only: request_of
   use structure, only: findings_t, check_structure
   use deck, only: read_deck
   use points, only: row_t, has_number, is_due
   use scales, only: characteristic_length, characteristic_rate
   use known_digits, only: nothing_known
   use set_motion, only: is_flagged, find_row_in_set, error_in_set
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set, iterations_of
   use text_output, only: output_t, open_output, check_apart, put, flush_output, close_output, abandon_output, &
      has_failed
   use numerals, only: whole
   use progress, only: progress_t, start_progress, show_progress, end_progress
   use reference_rows, only: reference_t, open_reference, read_reference, close_reference, no_number
   implicit none
   private
   public :: run_study, seconds, median

   !> Measurements of a time.
   integer, parameter :: repeats = 9
   !> One way to solve a set, and what came of it.
   type :: trial_t
      integer :: method = method_newton
      real(dp) :: tolerance = 0.0_dp             !< 0: the limit of rounding
      integer :: predictor = own_predictor       !< its order, or the method's own
      integer :: missed = 0                      !< instants without a whole motion
      real(dp) :: iterations = 0.0_dp            !< a step, those of substeps included
      real(dp) :: seconds = 0.0_dp               !< of the whole motion
      real(dp) :: time(repeats) = 0.0_dp         !< of a step without the first instant, microseconds
      real(dp) :: error(0:2) = 0.0_dp            !< of positions, velocities, accelerations, in parts of the largest
   end type trial_t

   !> What the rows of a set are compared with.
   type :: truth_t
      logical :: is_reference = .false.          !< kinmat-quad's rows; otherwise the estimates of errors
      integer :: compared = 0                    !< instants
      real(qp), allocatable :: value(:, :, :)    !< (3, 0:2, rows of all instants)
   end type truth_t

   !> One measurement takes at least so many seconds: many ticks of the clock; and at most, as far as few steps let it.
   real(dp), parameter :: min_seconds = 0.0005_dp, max_seconds = 0.01_dp
   integer, parameter :: min_steps = 4
   !> A trial ends early if it misses instants and has taken so many seconds.
   real(dp), parameter :: long = 2.0_dp
   !> A study solves this number of links at instants in each trial, and compares this number of rows.
   integer, parameter :: max_solved = 1000000, max_rows = 100000
   !> Methods that solve all equations at once are tried up to this number of equations.
   integer, parameter :: max_equations = 130
   real(dp), parameter :: tolerances(*) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-6_dp, 1.0e-8_dp, 1.0e-10_dp, 1.0e-12_dp, 0.0_dp]
   real(dp), parameter :: micro = 1.0e6_dp
   real(qp), parameter :: radian = 57.29577951308232087679815481410517033_qp

contains

   !> Prints the study of the deck in the file `path` to `output`, '' for standard output; with `only_times` the time of
   !> a step of each set. Then the deck may be '', standard input. `quiet`: without progress on a terminal. `message`:
   !> lines for standard error, '' for none.
   subroutine run_study(path, output, only_times, quiet, status, message)
      character(*), intent(in) :: path, output
      logical, intent(in) :: only_times, quiet
      integer, intent(out) :: status
      character(:), allocatable, intent(out) :: message
      type(mechanism_t), allocatable :: sets(:)
      type(findings_t), allocatable :: findings(:)
      type(failure_t), allocatable :: failure
      type(output_t) :: o
      type(progress_t) :: progress
      type(reference_t) :: reference
      integer :: i

      status = status_solved
      message = ''
      call start_progress(progress, .not. quiet, .false.)
      call read_deck(path, sets, message, failure)
      if (.not. allocated(failure)) call check_structure(sets, findings, failure)
      if (.not. allocated(failure)) call open_output(o, output, failure)
      if (.not. allocated(failure)) call check_apart([o], path, failure)
      if (allocated(failure)) then
         call abandon_output(o)
      else
         if (only_times) call put(o, '  SET     STEPS ITERATIONS   MEDIAN US/STEP            MIN            MAX')
         if (.not. only_times) call open_reference(path, reference)
         do i = 1, size(sets)
            if (only_times) then
               call put_times(o, sets(i), progress, status)
            else
               call study_set(o, sets(i), findings(i)%redundant > 0, reference, progress)
            end if
            call end_progress(progress)
            call flush_output(o)
            if (has_failed(o)) exit
         end do
         call close_reference(reference)
         call close_output(o, failure)
      end if
      if (.not. allocated(failure)) return
      status = failure%status
      if (len(message) == 0) message = ' *** '//failure%text
   end subroutine run_study

   !> Prints iterations and time of a step of `m`, as the deck asks for it. `status`: status_flagged if a position is
   !> not found.
   subroutine put_times(o, m, progress, status)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(progress_t), intent(inout) :: progress
      integer, intent(inout) :: status
      type(trial_t) :: t
      type(truth_t) :: nothing
      character(80) :: line
      integer :: k, last

      last = instant_count(m) - 1
      call solve(m, last, t, nothing)
      write (line, '(i5, i10, f11.2)') m%set_number, last, t%iterations
      if (t%missed > 0) then
         line(27:) = '   NOT TIMED: A POSITION IS NOT FOUND'
         status = status_flagged
      else if (last == 0) then
         line(27:) = '   NOT TIMED: ONE INSTANT'
      else
         do k = 1, repeats
            call show_progress(progress, 'MEASUREMENT', k, repeats)
            t%time(k) = step_time(m, last, t%seconds)
         end do
         write (line(27:), '(3f15.4)') median(t%time), minval(t%time), maxval(t%time)
      end if
      call put(o, trim(line))
   end subroutine put_times

   !> Prints the study of `m`. `redundant`: it has too many equations. `reference`: rows of the deck in real128.
   subroutine study_set(o, m, redundant, reference, progress)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: redundant
      type(reference_t), intent(in) :: reference
      type(progress_t), intent(inout) :: progress
      type(trial_t), allocatable :: trials(:)
      type(truth_t) :: truth
      integer :: i, k, last, standard

      if (m%set_number > 1) call put(o, '')
      call put(o, ' SPEED AGAINST ERROR   SET '//whole(m%set_number)//'   '//trim(m%title))
      last = min(instant_count(m) - 1, max(8, max_solved/size(m%links)))
      if (last == 0) then
         call put(o, ' NOT STUDIED: ONE INSTANT')
         return
      end if
      trials = all_trials(.not. redundant .and. 3*count(.not. m%links%ground) <= max_equations)
      call read_truth(m, last, reference, truth)
      do i = 1, size(trials)
         call show_progress(progress, 'TRIAL', i, size(trials))
         call solve(trial_mechanism(m, trials(i)), last, trials(i), truth)
      end do
      ! All trials take turns, so that what else the machine does meets all of them.
      do k = 1, repeats
         call show_progress(progress, 'MEASUREMENT', k, repeats)
         do i = 1, size(trials)
            if (trials(i)%missed == 0) &
               trials(i)%time(k) = step_time(trial_mechanism(m, trials(i)), last, trials(i)%seconds)
         end do
      end do

      call put_head(o, m, last, redundant, truth)
      standard = findloc(trials%tolerance, 0.0_dp, dim=1)
      do i = 1, size(trials)
         call put_trial(o, trials(i), median(trials(standard)%time))
      end do
   end subroutine study_set

   !> Returns the trials of a study: each method with each tolerance, if `all_at_once` also those that solve all
   !> equations at once; then the predictors of METHOD NEWTON. The first one without a tolerance is the default.
   function all_trials(all_at_once) result(trials)
      logical, intent(in) :: all_at_once
      type(trial_t), allocatable :: trials(:)
      integer, parameter :: methods(*) = [method_newton, method_dense, method_matrix]
      integer :: i, k

      trials = [((trial_t(method=methods(i), tolerance=tolerances(k)), k=1, size(tolerances)), &
         i=1, merge(size(methods), 1, all_at_once)), (trial_t(predictor=k), k=0, 3)]
   end function all_trials

   !> Returns the mechanism `m` as trial `t` solves it, with no question of the deck but its rows.
   function trial_mechanism(m, t) result(one)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(mechanism_t) :: one

      one = m
      one%method = t%method
      one%tolerance = real(t%tolerance, wp)
      one%predictor = t%predictor
      one%assemblies = .false.
   end function trial_mechanism

   !> Solves `m` at instants 0 to `last`. Fills missed instants, iterations, seconds and errors of `t`; errors only if
   !> something is compared with the `truth`.
   subroutine solve(m, last, t, truth)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last
      type(trial_t), intent(inout) :: t
      type(truth_t), intent(in) :: truth
      type(set_analysis_t) :: a
      real(dp) :: begun, largest(2, 0:2), difference(2, 0:2)
      integer :: k, at_first, row

      ! Of what is zero but for rounding, as the acceleration of a link that turns evenly, the unit is characteristic.
      associate (length => characteristic_length(m))
         largest = reshape([(real([length, 1.0_wp]*characteristic_rate(m, length)**k, dp), k=0, 2)], [2, 3])
      end associate
      difference = 0.0_dp
      row = 0
      t%seconds = 0.0_dp
      call make_set_analysis(m, a)
      do k = 0, last
         begun = seconds()
         call advance_set(a, instant(m, k))
         t%seconds = t%seconds + (seconds() - begun)
         if (k == 0) at_first = iterations_of(a)
         if (is_flagged(a%now)) t%missed = t%missed + 1
         if (k < truth%compared) call compare()
         if (t%missed > 0 .and. t%seconds > long) exit
      end do
      t%iterations = real(iterations_of(a) - at_first, dp)/max(1, min(k, last))
      do k = 0, 2
         t%error(k) = maxval(difference(:, k)/largest(:, k))
      end do

   contains

      !> Notes the largest values of the rows of this instant and their largest differences from the truth: of lengths
      !> and of angles.
      subroutine compare()
         type(row_t) :: r
         real(wp) :: estimate(3, 0:2)
         real(qp) :: value
         integer :: i, c, d, kind

         if (.not. truth%is_reference) call sample_set(a, .true.)
         do i = 1, size(a%now%rows)
            if (.not. is_compared(a, i, k)) cycle
            row = row + 1
            call find_row_in_set(a%now, i, r)
            if (.not. truth%is_reference) estimate = error_in_set(a%now, i)
            do d = 0, 2
               do c = 1, 3
                  if (.not. has_number(r, c, d)) cycle
                  kind = merge(2, 1, c == 3 .or. r%angular)
                  if (.not. truth%is_reference) then
                     difference(kind, d) = max(difference(kind, d), real(estimate(c, d), dp))
                  else if (truth%value(c, d, row) < no_number) then
                     value = truth%value(c, d, row)
                     if (m%degrees .and. kind == 2) value = value/radian
                     difference(kind, d) = max(difference(kind, d), real(abs(real(r%value(c, d), qp) - value), dp))
                  else
                     cycle
                  end if
                  largest(kind, d) = max(largest(kind, d), real(abs(r%value(c, d)), dp))
               end do
            end do
         end do
      end subroutine compare
   end subroutine solve

   !> Whether row number `i` of the set in `a` is compared at instant number `k`: links, points and pairs are.
   logical function is_compared(a, i, k)
      type(set_analysis_t), intent(in) :: a
      integer, intent(in) :: i, k
      type(request_t) :: request

      request = request_of(a%now, i)
      is_compared = request%kind <= request_pair .and. is_due(a%now, request, k)
   end function is_compared

   !> Reads what the rows of `m` at instants 0 to `last` are compared with: the rows of the `reference` as far as they
   !> go. Without a reference, or if it has no row of this set, the program's own estimates of errors stand for them.
   subroutine read_truth(m, last, reference, truth)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last
      type(reference_t), intent(in) :: reference
      type(truth_t), intent(out) :: truth
      type(set_analysis_t) :: a
      type(row_t) :: r
      integer :: i, k, count

      call make_set_analysis(m, a)
      if (reference%is_there) allocate (truth%value(3, 0:2, max_rows))
      count = 0
      do k = 0, merge(last, -1, reference%is_there)
         if (count + size(a%now%rows) > max_rows) exit
         do i = 1, size(a%now%rows)
            if (.not. is_compared(a, i, k)) cycle
            count = count + 1
            call find_row_in_set(a%now, i, r)
            call read_reference(reference, m%set_number, k, r%name, truth%value(:, :, count))
            if (truth%value(1, 0, count) < no_number) truth%compared = k + 1
         end do
         ! The reference ends here, if it misses two instants.
         if (k > truth%compared) exit
      end do
      truth%is_reference = truth%compared > 0
      if (.not. truth%is_reference) truth%compared = min(last + 1, max(1, max_rows/max(1, size(a%now%rows))))
   end subroutine read_truth

   !> Prints the head of the study of `m` over `last` steps.
   subroutine put_head(o, m, last, redundant, truth)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last
      logical, intent(in) :: redundant
      type(truth_t), intent(in) :: truth

      call put(o, ' '//whole(last)//' OF '//whole(instant_count(m) - 1)//' STEPS, '//whole(size(m%links))//' LINKS, ' &
         //wp_name)
      if (truth%is_reference) then
         call put(o, ' ERRORS: AGAINST kinmat-quad (REAL128), AT '//whole(truth%compared)//' OF '//whole(last + 1) &
            //' INSTANTS')
      else
         call put(o, ' ERRORS: THE ESTIMATES OF --errors, AT '//whole(truth%compared)//' OF '//whole(last + 1) &
            //' INSTANTS; kinmat-quad HAS NO ROWS OF THIS SET (make kinds)')
      end if
      if (redundant) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: EQUATIONS ARE REDUNDANT')
      else if (3*count(.not. m%links%ground) > max_equations) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: '//whole(3*count(.not. m%links%ground))//' EQUATIONS')
      end if
      call put(o, '')
      call put(o, repeat(' ', 31)//'TIME OF A STEP, MICROSECONDS'//repeat(' ', 19)//'LARGEST ERROR / LARGEST VALUE')
      call put(o, ' METHOD  PREDICTOR  TOLERANCE    MEDIAN       MIN       MAX   RATIO   ITER   POSITION   VELOCITY' &
         //'   ACCELER.')
   end subroutine put_head

   !> Prints the row of trial `t`. `unit`: microseconds of the default, 0 if that does not find every position.
   subroutine put_trial(o, t, unit)
      type(output_t), intent(inout) :: o
      type(trial_t), intent(in) :: t
      real(dp), intent(in) :: unit
      character(120) :: line
      integer :: d

      line = ' '//method_words(t%method)
      line(10:) = 'OWN'
      if (t%predictor /= own_predictor) line(10:) = 'ORDER '//whole(t%predictor)
      line(21:) = 'ROUNDING'
      if (t%tolerance > 0.0_dp) write (line(21:29), '(es9.1)') t%tolerance
      if (t%missed > 0) then
         line(32:) = 'NOT SOLVED AT '//whole(t%missed)//' INSTANTS OR MORE'
      else
         write (line(30:), '(3f10.3)') median(t%time), minval(t%time), maxval(t%time)
         if (unit > 0.0_dp) write (line(60:), '(f8.2)') median(t%time)/unit
         write (line(68:), '(f7.2)') t%iterations
      end if
      do d = 0, 2
         if (t%missed > 0) cycle
         if (t%error(d) < 1.0e-3_dp*nothing_known) then
            write (line(75 + 11*d:), '(es11.1)') t%error(d)
         else
            line(75 + 11*d:) = '    UNKNOWN'
         end if
      end do
      call put(o, trim(line))
   end subroutine put_trial

   !> Returns microseconds of a step of `m`, position, velocity and acceleration at instants 1 to `last`, without the
   !> first instant. `whole_time`: seconds that all steps take, about.
   real(dp) function step_time(m, last, whole_time) result(time)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last
      real(dp), intent(in) :: whole_time
      type(set_analysis_t) :: a
      real(dp) :: begun
      real(wp) :: instants(0:last)
      integer :: i, k, passes, steps

      instants = [(instant(m, k), k=0, last)]
      steps = last
      if (whole_time > max_seconds) steps = min(last, max(min_steps, int(last*max_seconds/whole_time)))
      passes = max(1, min(1000, ceiling(min_seconds/max(whole_time, 1.0e-6_dp))))
      time = 0.0_dp
      do i = 1, passes
         call make_set_analysis(m, a)
         call advance_set(a, instants(0))
         begun = seconds()
         do k = 1, steps
            call advance_set(a, instants(k))
         end do
         time = time + (seconds() - begun)
      end do
      time = micro*time/(real(passes, dp)*steps)
   end function step_time

   !> Returns the clock (s), from some instant.
   real(dp) function seconds()
      integer(int64) :: ticks, per_second

      call system_clock(ticks, per_second)
      seconds = real(ticks, dp)/real(per_second, dp)
   end function seconds

   !> Returns the median of the sample `x`, which has one value at least.
   pure real(dp) function median(x)
      real(dp), intent(in) :: x(:)
      integer :: twice(size(x)), i               ! twice the number of values that are no larger

      twice = [(2*count(x <= x(i)), i=1, size(x))]
      median = 0.5_dp*(minval(x, mask=twice >= size(x)) + minval(x, mask=twice > size(x)))
   end function median
end module study
