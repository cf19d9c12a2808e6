!> A job's sets, or their variants, in several processes: each computes some that follow one another, a share, and
!> writes to temporary files, which are joined in the deck's order. The first share writes to the job's files
!> themselves.
!>
!> Rejected: threads. gfortran 12 keeps the lengths of character results in static memory, where threads write over each
!> other's: of 2000 sets in two threads, two listings had words cut short.
module shares
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t
   use failures, only: capitals, status_solved, status_system
   use deck, only: share_end
   use numerals, only: whole
   use processes, only: fork_process, wait_for_child, interrupt_child, end_process, temporary_file, &
      from_beginning, killed
   use system_calls, only: read_bytes, write_bytes, close_descriptor, signal_received, note_all_signals, last_error, &
      reason_of
   use text_output, only: add, has_failed
   use progress, only: progress_t, show_progress
   use outputs, only: outputs_t, forget_files
   use command_line, only: out_last
   implicit none
   private
   public :: run_shares, end_share

   !> Shares for each process: of sets that take unequal times the last ones end together.
   integer, parameter :: shares_a_process = 4
   !> The temporary file of a share's message.
   integer, parameter :: message_file = 0
   integer, parameter :: block_length = 65536

   type :: part_t
      character(8) :: kind = 'SETS'                         !< what is shared: SETS or VARIANTS
      integer :: first = 1, last = 0                        !< their numbers
      integer :: process = 0                                !< its number while it is running
      integer :: status = -1                                !< its exit status; -1: it has not ended
      integer(c_int) :: files(message_file:out_last) = -1   !< its temporary files; negative: none
   end type part_t

   !> In a child: the file that takes its message.
   integer(c_int) :: own_message = -1

contains

   !> Computes the sets, or the variants (`kind`: SETS or VARIANTS), `first` to `last` in at most `processes` processes.
   !> It returns more than once: in each child `is_child` is true, `first` and `last` are its share, to be computed and
   !> ended by `end_share`; in the parent it returns when all shares have ended and their text is in `o`. `status`: then
   !> the exit status; `message`: what to say of an error.
   subroutine run_shares(o, first, last, processes, kind, progress, is_child, status, message)
      class(outputs_t), intent(inout) :: o
      integer, intent(inout) :: first, last
      integer, intent(in) :: processes
      character(*), intent(in) :: kind
      type(progress_t), intent(inout) :: progress
      logical, intent(out) :: is_child
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message
      type(part_t) :: list(min(last - first + 1, shares_a_process*processes))
      integer :: begun, joined
      logical :: stops

      list%kind = kind
      call divide(first, last, list)
      is_child = .false.
      begun = 0
      joined = 0
      do
         stops = status >= status_system .or. signal_received() > 0 .or. any(has_failed(o%files(:, 0)))
         if (stops) call interrupt_all(list)
         if (count(list%process > 0) < processes .and. begun < size(list) .and. .not. stops) then
            begun = begun + 1
            call begin_share(o, list(begun), begun == 1, is_child, message)
            if (is_child) then
               first = list(begun)%first
               last = list(begun)%last
               return
            end if
         else if (joined < begun) then
            call end_one(list)
         else
            exit
         end if
         do while (joined < begun)
            if (list(joined + 1)%status < 0) exit
            joined = joined + 1
            ! After a share that was broken off nothing is written.
            if (status < status_system) call join_share(o, list(joined), status, message)
            call show_progress(progress, kind//': NUMBER', list(joined)%last, last)
         end do
      end do
      call forget_files(o, 1, 0)
   end subroutine run_shares

   !> Divides the sets `first` to `last` among the shares of `list`.
   pure subroutine divide(first, last, list)
      integer, intent(in) :: first, last
      type(part_t), intent(inout) :: list(:)
      integer :: k

      do k = 1, size(list)
         list(k)%first = first + share_end(last - first + 1, k - 1, size(list))
         list(k)%last = first + share_end(last - first + 1, k, size(list)) - 1
      end do
   end subroutine divide

   !> Makes a process for the share `s`, which writes to temporary files unless it is the `first_one`. Where that fails
   !> the share has ended, and `message` says why.
   subroutine begin_share(o, s, first_one, is_child, message)
      class(outputs_t), intent(inout) :: o
      type(part_t), intent(inout) :: s
      logical, intent(in) :: first_one
      logical, intent(out) :: is_child
      character(:), allocatable, intent(inout) :: message
      logical :: needed(message_file:out_last)
      integer :: k

      needed = [.true., (allocated(o%files(k, 0)%buffer) .and. .not. first_one, k=1, out_last)]
      do k = message_file, out_last
         if (needed(k)) s%files(k) = temporary_file()
         if (needed(k) .and. s%files(k) < 0) exit
      end do
      is_child = .false.
      if (k > out_last) then
         s%process = fork_process()
         is_child = s%process == 0
         if (is_child) call become_share(o, s)
         ! What the first share has emptied is not emptied again.
         if (.not. is_child) o%files(:, 0)%emptied = .true.
         if (s%process >= 0) return
      end if
      s%status = status_system
      message = ' *** NO PROCESS FOR'//sets_text(s)//' ('//capitals(reason_of(last_error()))//')'
   end subroutine begin_share

   !> In the child: the outputs are those of share `s` alone.
   subroutine become_share(o, s)
      class(outputs_t), intent(inout) :: o
      type(part_t), intent(in) :: s
      integer :: k

      call forget_files(o, s%first, s%last)
      do k = 1, out_last
         if (s%files(k) < 0) cycle
         o%files(k, 0)%descriptor = s%files(k)
         o%files(k, 0)%emptied = .true.
         ! What of shares before it is not written yet is the parent's.
         o%files(k, 0)%used = 0
         o%files(k, 0)%path = 'A TEMPORARY FILE'
      end do
      own_message = s%files(message_file)
      call note_all_signals
   end subroutine become_share

   !> Ends the child: its parent takes over the exit `status` and the `message`.
   subroutine end_share(status, message)
      integer, intent(in) :: status
      character(*), intent(in) :: message
      integer(c_size_t) :: written

      written = write_bytes(own_message, message)
      call end_process(status)
   end subroutine end_share

   !> Waits until one of the shares ends, or a signal comes.
   subroutine end_one(list)
      type(part_t), intent(inout) :: list(:)
      integer :: process, status, k

      call wait_for_child(process, status)
      k = 0
      if (process > 0) k = findloc(list%process, process, dim=1)
      if (k == 0) return
      list(k)%process = 0
      list(k)%status = status
   end subroutine end_one

   !> Asks all processes that are running to end.
   subroutine interrupt_all(list)
      type(part_t), intent(in) :: list(:)
      integer :: k

      do k = 1, size(list)
         if (list(k)%process > 0) call interrupt_child(list(k)%process)
      end do
   end subroutine interrupt_all

   !> Appends the text of the share `s`, which has ended, to the outputs, and takes over its `status` and `message`.
   subroutine join_share(o, s, status, message)
      class(outputs_t), intent(inout) :: o
      type(part_t), intent(inout) :: s
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message
      character(:), allocatable :: text
      integer :: k
      logical :: closed

      do k = message_file, out_last
         if (s%files(k) < 0) cycle
         call from_beginning(s%files(k))
         do
            call read_block(s%files(k), text)
            if (len(text) == 0) exit
            if (k == message_file) message = message//text
            if (k > message_file) call add(o%files(k, 0), text)
         end do
         closed = close_descriptor(s%files(k))
      end do
      if (s%status >= killed) then
         message = ' *** THE PROCESS FOR'//sets_text(s)//' WAS ENDED BY SIGNAL '//whole(s%status - killed)
         status = status_system
      else if (s%status /= status_solved) then
         status = s%status
      end if
   end subroutine join_share

   !> The next `text` in the file `descriptor`; '' at its end.
   subroutine read_block(descriptor, text)
      integer(c_int), intent(in) :: descriptor
      character(:), allocatable, intent(out) :: text
      character(block_length) :: block

      text = block(:max(0, read_bytes(descriptor, block)))
   end subroutine read_block

   !> SETS 5 TO 8, or VARIANTS 5 TO 8
   pure function sets_text(s) result(text)
      type(part_t), intent(in) :: s
      character(:), allocatable :: text

      text = ' '//trim(s%kind)//' '//whole(s%first)//' TO '//whole(s%last)
   end function sets_text
end module shares
