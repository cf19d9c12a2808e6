!> Level 20. What --study asks its kin for (--trials): trials of the sets of a deck, their outcomes as records on
!> standard output.
module trials_job
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use failures, only: failure_t, fail, status_solved, status_refused
   use mechanism, only: mechanism_t, instant_count
   use deck, only: read_deck
   use text_output, only: output_t, open_output, close_output
   use trial_forms, only: trial_t, outcome_t, read_trial
   use trial_records, only: put_record
   use trials, only: try, measure, can_be_timed
   implicit none
   private
   public :: run_trials

contains

   !> Tries what `words`, divided by blanks, tell on the deck in the file `path`; records to `output`, '' for standard
   !> output. `message`: a line for standard error, '' for none.
   subroutine run_trials(words, path, output, status, message)
      character(*), intent(in) :: words, path, output
      integer, intent(out) :: status
      character(:), allocatable, intent(out) :: message
      type(mechanism_t), allocatable :: sets(:)
      type(trial_t), allocatable :: list(:)
      type(failure_t), allocatable :: failure
      type(output_t) :: o
      integer :: i

      status = status_solved
      call read_deck(path, sets, message, failure)
      if (.not. allocated(failure)) call read_words(words, sets, list, failure)
      if (.not. allocated(failure)) call open_output(o, output, failure)
      if (.not. allocated(failure)) then
         do i = 1, size(list)
            call run_trial(sets(list(i)%set), list(i), o)
         end do
         call close_output(o, failure)
      end if
      if (.not. allocated(failure)) return
      status = failure%status
      if (len(message) == 0) message = ' *** '//failure%text
   end subroutine run_trials

   subroutine read_words(words, sets, list, failure)
      character(*), intent(in) :: words
      type(mechanism_t), intent(in) :: sets(:)
      type(trial_t), allocatable, intent(out) :: list(:)
      type(failure_t), allocatable, intent(out) :: failure
      type(trial_t) :: one
      logical :: good
      integer :: first, last

      allocate (list(0))
      first = 1
      do while (first <= len_trim(words))
         last = first + index(words(first:)//' ', ' ') - 2
         call read_trial(words(first:last), one, good)
         if (good) good = one%set <= size(sets)
         if (good) good = fits(sets(one%set), one)
         if (.not. good) then
            call fail(failure, status_refused, 'OPTION --trials: "'//words(first:last)//'" IS NO TRIAL OF THIS DECK')
            return
         end if
         list = [list, one]
         first = last + 2
      end do
   end subroutine read_words

   !> The instants of `t` are there.
   pure logical function fits(m, t)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t

      if (t%steps == 0) then
         fits = t%last < instant_count(m)
      else
         fits = t%last <= t%steps .and. m%steps > 0
      end if
   end function fits

   subroutine run_trial(m, t, o)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(output_t), intent(inout) :: o
      type(outcome_t) :: one
      real(dp) :: whole
      integer :: i

      call try(m, t, one, whole)
      allocate (one%time(merge(t%repeats, 0, can_be_timed(t, one))))
      do i = 1, size(one%time)
         one%time(i) = measure(m, t, whole)
      end do
      call put_record(o, one)
   end subroutine run_trial
end module trials_job
