!> Speed against error (--study): every way of solving a deck is timed and compared with the truth, the
!> motion by the same program in real128. The time alone (--time), in any kind.
module study
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use failures, only: failure_t, fail, status_solved, status_rejected, status_flagged
   use mechanism, only: mechanism_t, instant_count, instant
   use structure, only: findings_t, check_structure
   use deck, only: read_deck
   use text_output, only: output_t, open_output, check_apart, put, flush_output, close_output, abandon_output, &
      has_failed
   use numerals, only: whole
   use progress, only: progress_t, start_progress, show_progress, end_progress
   use trials, only: median, outcome_t, kind_single, kind_double, kind_quad, repeats, trial_mechanism, trial_instants, &
      march, can_be_timed, step_time
   use companion, only: ask_companion
   use true_errors, only: truth_t, new_truth, errors_of, put_estimates
   use study_plan, only: plan_t, new_plan, plan_trials, truth_trial
   use study_table, only: row_t, new_rows, put_head, put_refusal, put_rows
   implicit none
   private
   public :: run_study

   integer, parameter :: digits_double = 53
   real(dp), parameter :: micro = 1.0e6_dp
   !> Of a study: the reference, the trials in real128, those in real32, those in real64.
   integer, parameter :: parts = 4

contains

   !> The study of the deck in the file `path`, to `output`, '' for standard output; with `only_times` the time of a
   !> step of each set, of the deck '' on standard input too. `quiet`: without progress on a terminal. `message`: lines
   !> for standard error, '' for none.
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
      integer :: i

      status = status_solved
      message = ''
      ! The table of a set comes at once, when all of it is measured: until then a terminal shows the progress.
      call start_progress(progress, .not. quiet, .false.)
      if (digits(1.0_wp) /= digits_double .and. .not. only_times) then
         call fail(failure, status_rejected, '--study IS AVAILABLE ONLY IN kinmat (REAL64), NOT IN THIS BUILD')
      else
         call read_deck(path, sets, message, failure)
      end if
      if (.not. allocated(failure)) call check_structure(sets, findings, failure)
      if (.not. allocated(failure)) call open_output(o, output, failure)
      if (.not. allocated(failure)) call check_apart([o], path, failure)
      if (allocated(failure)) then
         call abandon_output(o)
      else
         if (only_times) call put(o, '  SET     STEPS ITERATIONS   MEDIAN US/STEP            MIN            MAX')
         do i = 1, size(sets)
            if (only_times) then
               call put_times(o, sets(i), progress, status)
            else
               call study_set(o, path, sets(i), findings(i)%redundant > 0, progress, failure)
            end if
            call end_progress(progress)
            if (allocated(failure)) exit
            call flush_output(o)
            if (has_failed(o)) exit
         end do
         if (.not. allocated(failure)) call close_output(o, failure)
      end if
      if (.not. allocated(failure)) return
      status = failure%status
      if (len(message) == 0) message = ' *** '//failure%text
   end subroutine run_study

   !> Iterations and time of a step of `m`, as the deck asks for it. `status`: status_marked where a position is not
   !> found.
   subroutine put_times(o, m, progress, status)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(progress_t), intent(inout) :: progress
      integer, intent(inout) :: status
      real(wp) :: instants(0:instant_count(m) - 1)
      type(outcome_t) :: one
      real(dp) :: seconds, time(repeats)
      character(80) :: line
      integer :: k, last

      last = ubound(instants, 1)
      instants = [(instant(m, k), k=0, last)]
      call march(m, instants, last + 1, one, seconds)
      write (line, '(i5, i10, f11.2)') m%set_number, last, one%iterations
      if (can_be_timed(one, last)) then
         do k = 1, repeats
            call show_progress(progress, 'MEASUREMENT', k, repeats)
            time(k) = step_time(m, instants, seconds)*micro
         end do
         write (line(27:), '(3f15.4)') median(time), minval(time), maxval(time)
      else if (.not. one%found) then
         line(27:) = '   NOT TIMED: A POSITION IS NOT FOUND'
         status = status_flagged
      else
         line(27:) = '   NOT TIMED: ONE INSTANT'
      end if
      call put(o, trim(line))
   end subroutine put_times

   !> The study of `m`, a set of the deck in the file `path`; `redundant`: it has equations too many.
   subroutine study_set(o, path, m, redundant, progress, failure)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: path
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: redundant
      type(progress_t), intent(inout) :: progress
      type(failure_t), allocatable, intent(out) :: failure
      type(plan_t) :: p
      type(row_t), allocatable :: rows(:)
      type(truth_t) :: truth
      type(outcome_t), allocatable :: outcomes(:)

      p = new_plan(m, redundant)
      if (m%set_number > 1) call put(o, '')
      call put(o, ' SPEED AGAINST ERROR   SET '//whole(m%set_number)//'   '//trim(m%title))
      if (.not. p%possible .or. p%last == 0) then
         call put_refusal(o, p)
         return
      end if
      rows = new_rows(plan_trials(p))
      call ask_companion('kinmat-quad', 'REAL128', path, m, [truth_trial(p)], .false., outcomes, failure)
      if (allocated(failure)) return
      truth = new_truth(m, truth_trial(p), outcomes(1))
      call put_head(o, m, p, truth)
      if (.not. any(truth%motion%known == 2)) return
      call show_progress(progress, 'PART', 2, parts)
      call ask('kinmat-quad', 'REAL128', kind_quad)
      call show_progress(progress, 'PART', 3, parts)
      if (.not. allocated(failure)) call ask('kinmat-single', 'REAL32', kind_single)
      if (allocated(failure)) return
      call solve_rows()
      call put_rows(o, p, rows)
      call put_estimates(o, m, p, truth)

   contains

      !> The rows of one kind, by its program. For kinmat-single a deck of which it cannot read the numbers is none.
      subroutine ask(program, kind_name, kind)
         character(*), intent(in) :: program, kind_name
         integer, intent(in) :: kind
         integer, allocatable :: chosen(:)
         integer :: i

         chosen = pack([(i, i=1, size(rows))], rows%trial%kind == kind)
         call ask_companion(program, kind_name, path, m, rows(chosen)%trial, .true., outcomes, failure)
         if (allocated(failure)) then
            if (kind == kind_single .and. failure%status == status_rejected) deallocate (failure)
            return
         end if
         do i = 1, size(chosen)
            call take_outcome(outcomes(i), rows(chosen(i)))
         end do
      end subroutine ask

      !> Fills `row` from the outcome of its trial: errors against the truth, iterations, times.
      subroutine take_outcome(one, row)
         type(outcome_t), intent(in) :: one
         type(row_t), intent(inout) :: row

         row%errors = errors_of(truth, m, row%trial, one)
         row%iterations = one%iterations
         if (allocated(one%time)) row%time = one%time
      end subroutine take_outcome

      !> The rows in double precision. What is measured is measured in turn, repeat by repeat.
      subroutine solve_rows()
         type(outcome_t) :: one
         real(dp) :: seconds(size(rows))
         integer :: i, k

         do i = 1, size(rows)
            associate (t => rows(i)%trial)
               if (t%kind /= kind_double) cycle
               call march(trial_mechanism(m, t), real(trial_instants(m, t), wp), t%stride, one, seconds(i))
               call take_outcome(one, rows(i))
               rows(i)%time = spread(0.0_dp, 1, merge(repeats, 0, can_be_timed(one, t%last)))
            end associate
         end do
         do k = 1, repeats
            call show_progress(progress, 'MEASUREMENT', k, repeats)
            do i = 1, size(rows)
               associate (t => rows(i)%trial)
                  if (t%kind == kind_double .and. k <= size(rows(i)%time)) rows(i)%time(k) = &
                     step_time(trial_mechanism(m, t), real(trial_instants(m, t), wp), seconds(i))
               end associate
            end do
         end do
      end subroutine solve_rows
   end subroutine study_set
end module study
