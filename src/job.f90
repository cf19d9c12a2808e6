!> One job: deck in, listing out. Solve an instant, write an instant; nothing is kept for later.
module job
   use failures, only: failure_t, status_solved, status_flagged, status_signal
   use mechanism, only: mechanism_t, instant_count, instant
   use structure, only: findings_t, check_structure
   use deck, only: read_deck
   use text_output, only: output_t, open_output, put, check_apart, flush_output, close_output, abandon_output, &
      has_failed, has_broken_pipe
   use system_calls, only: watch_signals, signal_received, broken_pipe_kills, signal_pipe
   use listing, only: layout_t, new_layout, listing_head, listing_instant, listing_end, listing_broken_off
   use csv, only: csv_head, csv_instant
   use drawing, only: drawing_t, new_drawing, record_instant
   use picture, only: put_pictures
   use solver_log, only: log_head, log_instant
   use convergence, only: convergence_t
   use branch_certificate, only: branch_t
   use points, only: strides, any_due
   use set_motion, only: is_flagged, has_words
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set, set_record, set_errors, &
      set_closure_error, set_closing_diagnostics
   use command_line, only: options_t
   implicit none
   private
   public :: run_job

   !> The job's outputs; csv, log and picture only where asked for.
   type :: outputs_t
      type(output_t) :: listing, csv, log, svg
      type(drawing_t), allocatable :: drawings(:)   !< (sets of this share)
   end type outputs_t

contains

   !> Does what `options` say. `status`: the exit status; `message`: lines for standard error, '' for none.
   subroutine run_job(options, status, message)
      type(options_t), intent(in) :: options
      integer, intent(out) :: status
      character(:), allocatable, intent(out) :: message
      type(mechanism_t), allocatable :: sets(:)
      type(findings_t), allocatable :: findings(:)
      type(failure_t), allocatable :: failure
      type(outputs_t) :: o

      status = status_solved
      call read_deck(options%deck, sets, message, failure)
      if (.not. allocated(failure)) call check_structure(sets, findings, failure)
      if (.not. allocated(failure)) call open_all(options, o, failure)
      if (.not. allocated(failure)) then
         call watch_signals
         call run_sets(options, sets, findings, o, status)
         call close_all(options, o, failure)
      end if
      if (allocated(failure)) then
         status = failure%status
         if (len(message) == 0) message = ' *** '//failure%text
      end if
      call look_at_signals(options, o, status, message)
   end subroutine run_job

   !> A run that a signal has ended ends by that signal; so does one whose reader has gone (kinmat DECK | head), and
   !> without a word, unless other outputs were asked for, which end there too.
   subroutine look_at_signals(options, o, status, message)
      type(options_t), intent(in) :: options
      type(outputs_t), intent(in) :: o
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message

      if (signal_received() > 0) then
         status = status_signal + signal_received()
      else if (broken_pipe_kills() .and. any(has_broken_pipe([o%listing, o%csv, o%log, o%svg]))) then
         status = status_signal + signal_pipe
         if (len(options%csv) == 0 .and. len(options%log) == 0 .and. len(options%svg) == 0) message = ''
      end if
   end subroutine look_at_signals

   !> Opens the outputs that `options` name. Errors: status_system; status_rejected where two of them are one file.
   subroutine open_all(options, o, failure)
      type(options_t), intent(in) :: options
      type(outputs_t), intent(out) :: o
      type(failure_t), allocatable, intent(out) :: failure

      call open_output(o%listing, options%output, failure)
      if (.not. allocated(failure) .and. len(options%csv) > 0) call open_output(o%csv, options%csv, failure)
      if (.not. allocated(failure) .and. len(options%log) > 0) call open_output(o%log, options%log, failure)
      if (.not. allocated(failure) .and. len(options%svg) > 0) call open_output(o%svg, options%svg, failure)
      if (.not. allocated(failure)) call check_apart([o%listing, o%csv, o%log, o%svg], options%deck, failure)
      if (.not. allocated(failure)) return
      call abandon_output(o%listing)
      call abandon_output(o%csv)
      call abandon_output(o%log)
      call abandon_output(o%svg)
   end subroutine open_all

   !> Writes the heads at once, so that an output that takes nothing is known before anything is computed.
   subroutine flush_all(options, o)
      type(options_t), intent(in) :: options
      type(outputs_t), intent(inout) :: o

      call flush_output(o%listing)
      if (len(options%csv) > 0) call flush_output(o%csv)
      if (len(options%log) > 0) call flush_output(o%log)
      if (len(options%svg) > 0) call flush_output(o%svg)
   end subroutine flush_all

   !> Closes all outputs; `failure`: that of the last one that could not be written.
   subroutine close_all(options, o, failure)
      type(options_t), intent(in) :: options
      type(outputs_t), intent(inout) :: o
      type(failure_t), allocatable, intent(out) :: failure
      type(failure_t), allocatable :: other

      call close_output(o%listing, failure)
      if (len(options%csv) > 0) call close_output(o%csv, other)
      if (allocated(other)) call move_alloc(other, failure)
      if (len(options%log) > 0) call close_output(o%log, other)
      if (allocated(other)) call move_alloc(other, failure)
      if (len(options%svg) > 0) call close_output(o%svg, other)
      if (allocated(other)) call move_alloc(other, failure)
   end subroutine close_all

   !> What follows need not be computed: a write has failed, or a signal has come.
   logical function is_over(o)
      type(outputs_t), intent(in) :: o

      is_over = has_failed(o%listing) .or. has_failed(o%csv) .or. has_failed(o%log) .or. has_failed(o%svg) &
         .or. signal_received() > 0
   end function is_over

   !> The sets of this share, one after another: shares put together in their order are the whole.
   subroutine run_sets(options, sets, findings, o, status)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: sets(:)
      type(findings_t), intent(inout) :: findings(:)
      type(outputs_t), intent(inout) :: o
      integer, intent(inout) :: status
      integer :: i, first, last

      first = share_end(size(sets), options%share - 1, options%shares) + 1
      last = share_end(size(sets), options%share, options%shares)
      if (len(options%csv) > 0 .and. options%share == 1) call csv_head(o%csv, options%errors)
      if (len(options%svg) > 0) call put(o%svg, '<?xml version="1.0" encoding="US-ASCII"?>')
      if (len(options%svg) > 0) allocate (o%drawings(first:last))
      do i = first, last
         if (len(options%svg) > 0) o%drawings(i) = new_drawing(sets(i))
         call run_set(options, sets(i), i, findings(i), o, status)
         if (is_over(o)) exit
      end do
      i = min(i, last)
      if (len(options%svg) > 0) call put_pictures(o%svg, sets(first:i), o%drawings(first:i))
   end subroutine run_sets

   !> Last set of share `k` of `n` shares of `count` sets.
   pure integer function share_end(count, k, n)
      use, intrinsic :: iso_fortran_env, only: int64
      integer, intent(in) :: count, k, n

      share_end = int(int(count, int64)*k/n)
   end function share_end

   !> Solves and writes set number `i`, `m`, instant by instant.
   subroutine run_set(options, m, i, findings, o, status)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      type(findings_t), intent(inout) :: findings
      type(outputs_t), intent(inout) :: o
      integer, intent(inout) :: status
      type(layout_t) :: layout
      type(set_analysis_t) :: a
      integer, allocatable :: every(:)
      integer :: k, flagged
      logical :: due

      layout = new_layout(m, findings%parts, findings%own)
      call listing_head(o%listing, layout, m, findings)
      if (options%check) return
      if (len(options%log) > 0) call log_head(o%log, m, options%errors)
      call flush_all(options, o)
      if (is_over(o)) return
      call make_set_analysis(m, a, findings)
      flagged = 0
      every = strides(m)
      do k = 0, instant_count(m) - 1
         call advance_set(a, instant(m, k))
         if (is_flagged(a%now)) flagged = flagged + 1
         due = any_due(m, every, k)
         if (due .or. options%errors) call sample_set(a, options%errors)
         if (due .or. has_words(a%now)) call listing_instant(o%listing, layout, m, a%now, k)
         if (due .and. len(options%csv) > 0) call csv_instant(o%csv, m, a%now, k)
         if (len(options%svg) > 0) call record_instant(o%drawings(i), m, a%now, k)
         if (len(options%log) > 0) call put_log(o%log, options, m, a, k)
         if (.not. is_over(o)) cycle
         call listing_broken_off(o%listing, m, k)
         return
      end do
      call listing_end(o%listing, m, instant_count(m) - flagged, flagged, a%certificate_counts, set_closure_error(a), &
         set_closing_diagnostics(a, m))
      if (flagged > 0) status = status_flagged
   end subroutine run_set

   !> The line of instant number `k` in the log.
   subroutine put_log(log, options, m, a, k)
      type(output_t), intent(inout) :: log
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: a
      integer, intent(in) :: k
      type(convergence_t) :: record
      type(branch_t) :: branch

      call set_record(a, record, branch)
      if (options%errors) then
         call log_instant(log, k, instant(m, k), record, branch, set_errors(a))
      else
         call log_instant(log, k, instant(m, k), record, branch)
      end if
   end subroutine put_log
end module job
