!> One job: deck in, listing out. Solve an instant, write an instant; nothing is kept for later.
module job
   use failures, only: failure_t, status_solved, status_flagged, status_signal
   use mechanism, only: mechanism_t, instant_count, instant
   use structure, only: findings_t, check_structure
   use deck, only: read_deck
   use text_output, only: output_t, open_output, check_apart, flush_output, close_output, abandon_output, &
      has_failed, has_broken_pipe
   use system_calls, only: watch_signals, signal_received, broken_pipe_kills, signal_pipe
   use listing, only: layout_t, new_layout, listing_head, listing_instant, listing_end, listing_broken_off
   use csv, only: csv_head, csv_instant
   use drawing, only: drawing_t, new_drawing, record_instant
   use picture, only: picture_head, put_pictures
   use solver_log, only: log_head, log_instant
   use convergence, only: convergence_t
   use branch_certificate, only: branch_t
   use points, only: strides, any_due
   use set_motion, only: is_flagged, has_words
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set, set_record, set_errors, &
      set_closure_error, set_closing_diagnostics
   use command_line, only: options_t, out_listing, out_csv, out_log, out_svg, out_last
   implicit none
   private
   public :: run_job

   !> The job's outputs.
   type :: outputs_t
      logical :: asked(out_last) = .false.          !< the command asks for them: no other is open
      type(output_t) :: files(out_last)
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
         call close_all(o, failure)
      end if
      if (allocated(failure)) then
         status = failure%status
         if (len(message) == 0) message = ' *** '//failure%text
      end if
      call look_at_signals(o, status, message)
   end subroutine run_job

   !> A run that a signal has ended ends by that signal; so does one whose reader has gone (kinmat DECK | head), and
   !> without a word, unless other outputs were asked for, which end there too.
   subroutine look_at_signals(o, status, message)
      type(outputs_t), intent(in) :: o
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message

      if (signal_received() > 0) then
         status = status_signal + signal_received()
      else if (broken_pipe_kills() .and. any(has_broken_pipe(o%files))) then
         status = status_signal + signal_pipe
         if (count(o%asked) == 1) message = ''
      end if
   end subroutine look_at_signals

   !> Opens the outputs that `options` name. Errors: status_system; status_rejected where two of them are one file.
   subroutine open_all(options, o, failure)
      type(options_t), intent(in) :: options
      type(outputs_t), intent(out) :: o
      type(failure_t), allocatable, intent(out) :: failure

      integer :: k

      do k = 1, out_last
         o%asked(k) = allocated(options%files(k)%text)
         if (o%asked(k) .and. .not. allocated(failure)) call open_output(o%files(k), options%files(k)%text, failure)
      end do
      if (.not. allocated(failure)) call check_apart(o%files, options%deck, failure)
      if (.not. allocated(failure)) return
      do k = 1, out_last
         call abandon_output(o%files(k))
      end do
   end subroutine open_all

   !> Writes the heads at once, so that an output that takes nothing is known before anything is computed.
   subroutine flush_all(o)
      type(outputs_t), intent(inout) :: o
      integer :: k

      do k = 1, out_last
         if (o%asked(k)) call flush_output(o%files(k))
      end do
   end subroutine flush_all

   !> Closes all outputs; `failure`: that of the last one that could not be written.
   subroutine close_all(o, failure)
      type(outputs_t), intent(inout) :: o
      type(failure_t), allocatable, intent(out) :: failure
      type(failure_t), allocatable :: other
      integer :: k

      do k = 1, out_last
         if (.not. o%asked(k)) cycle
         call close_output(o%files(k), other)
         if (allocated(other)) call move_alloc(other, failure)
      end do
   end subroutine close_all

   !> What follows need not be computed: a write has failed, or a signal has come.
   logical function is_over(o)
      type(outputs_t), intent(in) :: o

      is_over = any(has_failed(o%files)) .or. signal_received() > 0
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
      if (o%asked(out_csv) .and. options%share == 1) call csv_head(o%files(out_csv), options%errors)
      if (o%asked(out_svg)) call picture_head(o%files(out_svg))
      if (o%asked(out_svg)) allocate (o%drawings(first:last))
      do i = first, last
         if (o%asked(out_svg)) o%drawings(i) = new_drawing(sets(i))
         call run_set(options, sets(i), i, findings(i), o, status)
         if (is_over(o)) exit
      end do
      i = min(i, last)
      if (o%asked(out_svg)) call put_pictures(o%files(out_svg), sets(first:i), o%drawings(first:i))
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

      associate (listing => o%files(out_listing))
         if (o%asked(out_listing)) then
            layout = new_layout(m, findings%parts, findings%own)
            call listing_head(listing, layout, m, findings)
         end if
         if (options%check) return
         if (o%asked(out_log)) call log_head(o%files(out_log), m, options%errors)
         call flush_all(o)
         if (is_over(o)) return
         call make_set_analysis(m, a, findings)
         flagged = 0
         every = strides(m)
         do k = 0, instant_count(m) - 1
            call advance_set(a, instant(m, k))
            if (is_flagged(a%now)) flagged = flagged + 1
            call write_instant(options, m, k, any_due(m, every, k), layout, a, o)
            if (o%asked(out_svg)) call record_instant(o%drawings(i), m, a%now, k)
            if (.not. is_over(o)) cycle
            if (o%asked(out_listing)) call listing_broken_off(listing, m, k)
            return
         end do
         if (o%asked(out_listing)) call listing_end(listing, m, instant_count(m) - flagged, flagged, &
            a%certificate_counts, set_closure_error(a), set_closing_diagnostics(a, m))
      end associate
      if (flagged > 0) status = status_flagged
   end subroutine run_set

   !> Writes instant number `k` of `m`, to which `a` has advanced; `due`: PRINT asks for it. Only the listing and
   !> estimates that are asked for need samples.
   subroutine write_instant(options, m, k, due, layout, a, o)
      type(options_t), intent(in) :: options
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      logical, intent(in) :: due
      type(layout_t), intent(in) :: layout
      type(set_analysis_t), intent(inout) :: a
      type(outputs_t), intent(inout) :: o

      if (options%errors .or. (due .and. o%asked(out_listing))) call sample_set(a, options%errors)
      if (o%asked(out_listing) .and. (due .or. has_words(a%now))) &
         call listing_instant(o%files(out_listing), layout, m, a%now, k)
      if (o%asked(out_csv) .and. due) call csv_instant(o%files(out_csv), m, a%now, k)
      if (o%asked(out_log)) call put_log(o%files(out_log), options, m, a, k)
   end subroutine write_instant

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
