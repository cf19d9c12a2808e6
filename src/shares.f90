!> A job's sets, or their variants, in several processes. They are divided into parts that follow one another; whoever
!> is free takes the next one, and its text stays in memory until the parts before it are written (`parts_in_turn`). One
!> that dies or is broken off leaves its part undone, and nothing after that is written.
!>
!> Rejected: threads. gfortran 12 keeps the lengths of character results in static memory, where threads write over each
!> other's: of 2000 sets in two threads, two listings had words cut short.
module shares
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t
   use failures, only: capitals, status_solved, status_system
   use deck, only: share_end
   use numerals, only: whole
   use processes, only: make_pipe, has_input, fork_process, wait_for_child, interrupt_child, end_process, &
      killed, report_to, end_of_message
   use system_calls, only: read_bytes, write_bytes, close_descriptor, signal_received, note_all_signals, last_error, &
      reason_of
   use text_output, only: has_failed, turn_lost
   use turns, only: make_turns, close_turns, parts_taken, parts_done
   use parts_in_turn, only: begin_part, end_part, write_rest
   use progress, only: progress_t, show_progress
   use outputs, only: outputs_t, flush_sets, forget_files
   implicit none
   private
   public :: share_of_job_t, run_shares, next_part, end_share

   !> Parts for each process: the last ones end together, and text that waits is still in the processor's cache. Of
   !> variants solved together there are fewer: a part begins with a structure anew, as long as several of them take.
   integer, parameter :: parts_a_process = 1024, parts_together = 32
   !> Milliseconds after which the parent looks whether a signal has come, and how far the job is.
   integer, parameter :: look_time = 200

   !> What this process computes.
   type :: share_of_job_t
      character(:), allocatable :: kind             !< SETS or VARIANTS
      integer :: first = 1, last = 0                !< all of them
      integer :: parts = 1                          !< so many parts there are; in the parent of other processes none
      integer :: part = 0                           !< the one at hand
      integer :: unit = 1                           !< so many variants are solved together
      integer :: own_first = 1, own_last = 0        !< the sets or variants of the part at hand
      logical :: is_child = .false.
      integer(c_int) :: report = -1                 !< a pipe to or from the parent
   end type share_of_job_t

contains

   !> Computes the sets or variants of `s` in `processes` processes. It returns more than once: in each child, to
   !> compute the parts that `next_part` gives and to end by `end_share`; in the parent when all is done. `status`: then
   !> the exit status; `message`: what to say of an error.
   subroutine run_shares(o, s, processes, progress, status, message)
      class(outputs_t), intent(inout) :: o
      type(share_of_job_t), intent(inout) :: s
      integer, intent(in) :: processes
      type(progress_t), intent(inout) :: progress
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message
      integer :: list(processes), k
      integer(c_int) :: report

      call divide(s, processes)
      call make_pipe(s%report, report)
      do k = 1, processes
         list(k) = -1
         if (s%report < 0) exit
         if (k == 1) then
            if (.not. make_turns(o%parts%turns)) exit
         end if
         list(k) = fork_process()
         s%is_child = list(k) == 0
         if (s%is_child) call begin_child()
         if (s%is_child) return
         if (list(k) < 0) exit
      end do
      if (k <= processes) then
         status = status_system
         message = ' *** CANNOT START A PROCESS FOR'//text_of(k)//' ('//capitals(reason_of(last_error()))//')'
         call interrupt_all(list(:k - 1))
      end if
      call close_one(report)
      call follow(list(:min(k, processes)), message)
      call close_one(s%report)
      call leave_files()
      call close_turns(o%parts%turns)
      s%parts = 0

   contains

      !> What a child does first.
      subroutine begin_child()
         call note_all_signals
         call close_one(s%report)
         s%report = report
         call report_to(report)
         ! Those that it computes no part of are left as they are.
         o%files(:, 0)%emptied = .true.
      end subroutine begin_child

      !> Leaves to the children the files that they have written.
      subroutine leave_files()
         integer :: taken

         taken = min(parts_taken(o%parts%turns), s%parts)
         if (taken > 0) o%files(:, 0)%emptied = .true.
         call forget_files(o, s%first, first_of(s, taken + 1) - 1)
      end subroutine leave_files

      !> Waits for the children of `list`, takes over the first `message`, and finds the `status` of the whole.
      subroutine follow(list, message)
         integer, intent(in) :: list(:)
         character(:), allocatable, intent(inout) :: message
         character(4096) :: block
         character(:), allocatable :: said
         integer :: ended, k, n

         said = ''
         do while (s%report >= 0)
            if (signal_received() > 0) call interrupt_all(list)
            if (has_input(s%report, look_time)) then
               n = read_bytes(s%report, block)
               if (n <= 0) exit
               said = said//block(:n)
            end if
            call show_progress(progress, s%kind//': NUMBER', first_of(s, parts_done(o%parts%turns) + 1) - 1, s%last)
         end do
         if (len(message) == 0 .and. len(said) > 0) message = said(:index(said, end_of_message) - 1)
         do k = 1, size(list)
            if (list(k) <= 0) cycle
            call wait_for_child(list(k), ended)
            if (ended >= killed .and. status < status_system) then
               ! All parts before its own are done.
               message = ' *** THE PROCESS FOR'//text_of(min(parts_done(o%parts%turns) + 1, s%parts)) &
                  //' WAS ENDED BY SIGNAL '//whole(ended - killed)
               status = status_system
            else if (ended < killed) then
               status = max(status, ended)
            end if
         end do
      end subroutine follow

      !> Asks all processes of `list` to end.
      subroutine interrupt_all(list)
         integer, intent(in) :: list(:)
         integer :: k

         do k = 1, size(list)
            if (list(k) > 0) call interrupt_child(list(k))
         end do
      end subroutine interrupt_all

      !> Closes one end of a pipe, unless it has none.
      subroutine close_one(descriptor)
         integer(c_int), intent(in) :: descriptor
         logical :: closed

         if (descriptor >= 0) closed = close_descriptor(descriptor)
      end subroutine close_one

      !> SETS 5 TO 8, or VARIANTS 5 TO 8: part `p`.
      pure function text_of(p) result(text)
         integer, intent(in) :: p
         character(:), allocatable :: text

         text = ' '//s%kind//' '//whole(first_of(s, p))//' TO '//whole(first_of(s, p + 1) - 1)
      end function text_of
   end subroutine run_shares

   !> Divides the sets or variants of `s` for `processes` processes.
   pure subroutine divide(s, processes)
      type(share_of_job_t), intent(inout) :: s
      integer, intent(in) :: processes

      associate (count => s%last - s%first + 1)
         ! A part of one variant more than are solved together takes as long as one of twice as many.
         s%parts = min((count - 1)/s%unit + 1, merge(parts_together, parts_a_process, s%unit > 1)*processes)
         if (s%parts < processes) then
            s%unit = 1
            s%parts = min(count, processes)
         end if
      end associate
      s%own_last = s%first - 1
   end subroutine divide

   !> Ends the part at hand, if there is one, and begins the next: `first` to `last`. False where there is none, or the
   !> job is over; then all is written.
   logical function next_part(o, s, first, last)
      class(outputs_t), intent(inout) :: o
      type(share_of_job_t), intent(inout) :: s
      integer, intent(out) :: first, last
      integer :: before

      before = s%own_last
      if (s%is_child .and. s%part > 0) then
         call flush_sets(o, s%own_first, s%own_last)
         call end_part(o%parts, o%files(:, 0), goes_on(o, s))
      end if
      next_part = goes_on(o, s)
      s%part = s%part + 1
      if (next_part .and. s%is_child) then
         call begin_part(o%parts, s%parts, o%files(:, 0))
         s%part = o%parts%part
      end if
      next_part = next_part .and. s%part <= s%parts
      first = first_of(s, s%part)
      last = first_of(s, s%part + 1) - 1
      s%own_first = first
      s%own_last = last
      if (.not. s%is_child) return
      ! The sets between are those of other processes.
      call forget_files(o, before + 1, merge(first - 1, s%last, next_part))
      if (.not. next_part) call write_rest(o%parts, o%files(:, 0))
   end function next_part

   !> The run has not ended before its time, and no write has failed.
   logical function goes_on(o, s)
      class(outputs_t), intent(in) :: o
      type(share_of_job_t), intent(in) :: s
      integer :: i

      goes_on = .not. (o%ended .or. any(has_failed(o%files(:, 0))))
      do i = s%own_first, min(s%own_last, ubound(o%files, 2))
         if (any(has_failed(o%files(:, i)))) goes_on = .false.
      end do
   end function goes_on

   !> Ends the child: its parent takes over the exit `status` and the `message`, unless its turn has never come.
   subroutine end_share(o, s, status, message)
      class(outputs_t), intent(in) :: o
      type(share_of_job_t), intent(in) :: s
      integer, intent(in) :: status
      character(*), intent(in) :: message
      integer(c_size_t) :: written

      if (any(o%files%error == turn_lost)) call end_process(status_solved)
      if (len(message) > 0) written = write_bytes(s%report, message//end_of_message)
      call end_process(status)
   end subroutine end_share

   !> The first set or variant of part `p`, of those beyond the last one the number after the last.
   pure integer function first_of(s, p)
      type(share_of_job_t), intent(in) :: s
      integer, intent(in) :: p

      first_of = s%first + s%unit*share_end((s%last - s%first)/s%unit + 1, min(p, s%parts + 1) - 1, max(1, s%parts))
      first_of = min(first_of, s%last + 1)
   end function first_of
end module shares
