!> A job's sets, or their variants, in several processes. They are divided into parts that follow one another. A free
!> child takes the next part, and writes its text in frames to a pipe. The parent writes the parts in their order: it
!> keeps what a child is ahead, up to a limit, and then reads no more of it. A child that dies or is broken off leaves
!> its part undone, and no part after that is written.
!>
!> Rejected: a part that belongs to a process before it begins. Unequal parts then leave one process idle.
!>
!> Rejected: threads. gfortran 12 keeps the lengths of character results in static memory, where threads write over each
!> other's: of 2000 sets in two threads, two listings had words cut short.
module shares
   use, intrinsic :: iso_c_binding, only: c_int, c_long, c_null_char
   use failures, only: capitals, status_system
   use numerals, only: whole
   use processes, only: poll, poll_t, waitpid, fork_process, interrupt_child, end_process, memfd_create, lseek, &
      from_here
   use system_calls, only: read_bytes, close_descriptor, signal_received, last_error, reason_of
   use text_output, only: add, flush_output, write_text, has_failed, frame_head
   use command_line, only: out_shared
   use outputs, only: outputs_t, share_of_job_t
   implicit none
   private
   public :: run_shares, next_part, end_child

   !> Parts for each process: the last ones end together, and text that waits is still in the processor's cache. Of
   !> variants solved together there are fewer: a part begins with a structure anew, as long as several of them take.
   integer, parameter :: parts_a_process = 1024, parts_together = 32
   !> Milliseconds after which the parent looks whether a signal has come.
   integer(c_int), parameter :: look_time = 200
   !> A child that is so many characters ahead waits. Characters that are read at once.
   integer, parameter :: max_ahead = 2**26, block_length = 65536
   !> Frames that hold no text of an output: a part begins, whose number is the text; it is done; the child ends, and
   !> the text is its exit status, a blank, and its message.
   integer, parameter :: part_begins = out_shared + 1, part_done = out_shared + 2, child_ends = out_shared + 3

   !> A child, and what was read from it: frames, of which the first begins at `first`.
   type :: child_t
      integer :: process = 0
      integer(c_int) :: descriptor = -1         !< negative: all is read
      character(:), allocatable :: text
      integer :: first = 1, last = 0
      integer :: part = 0                       !< to which the first frame belongs; 0: to none
      logical :: has_ended = .false.            !< by itself
   end type child_t

contains

   !> Computes the sets or variants of the share `o%share` in `processes` processes. It returns more than once: in each
   !> child, to compute the parts that `next_part` gives and to end then; in the parent when all is done. `status`: then
   !> the exit status; `message`: what to say of an error.
   subroutine run_shares(o, processes, status, message)
      class(outputs_t), intent(inout) :: o
      integer, intent(in) :: processes
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message
      type(child_t) :: children(processes)
      type(poll_t) :: list(processes)
      integer :: turn, before, lost, k, n
      integer(c_int) :: descriptor, ended, ignored
      logical :: is_stopped, is_interrupted

      associate (s => o%share, total => o%share%last - o%share%first + 1)
         s%length = s%unit*max(1, total/(s%unit*processes*merge(parts_together, parts_a_process, s%unit > 1)))
         if (total < processes*s%length) s%length = (total - 1)/processes + 1
         s%counter = memfd_create('parts'//c_null_char, 0_c_int)
         do k = 1, merge(processes, 0, s%counter >= 0)
            children(k)%process = fork_process(descriptor)
            if (children(k)%process < 0) exit
            s%is_child = children(k)%process == 0
            if (s%is_child) then
               call begin_child(o, descriptor)
               return
            end if
            children(k)%descriptor = descriptor
            allocate (character(2*block_length) :: children(k)%text)
         end do
         s%is_parent = .true.
         n = count(children%descriptor >= 0)
         is_stopped = n < processes
         if (is_stopped) then
            status = status_system
            message = ' *** CANNOT START A PROCESS FOR'//text_of(s, n + 1)//' ('//capitals(reason_of(last_error()))//')'
         end if

         turn = 1
         lost = 0
         is_interrupted = .false.
         do while (any(children%descriptor >= 0))
            if (.not. is_interrupted .and. (is_stopped .or. signal_received() > 0 .or. any(has_failed(o%files)))) then
               ! Once: a child that has only just begun takes a second signal as other processes do.
               is_interrupted = .true.
               call interrupt_child(children(:n)%process)
            end if
            list%descriptor = merge(children%descriptor, -1, is_stopped .or. children%part <= turn .or. &
               children%last - children%first < max_ahead)
            ! The system refuses a longer list than the number of files that a process may open.
            if (poll(list, int(n, c_long), look_time) <= 0) cycle
            do k = 1, n
               if (list(k)%found /= 0) call read_from(children(k))
               if (is_stopped) children(k)%last = children(k)%first - 1
            end do
            do
               before = turn
               do k = 1, n
                  call write_frames(o, children(k), turn, status, message)
               end do
               if (turn == before) exit
            end do

            ! No part is written after one that is not done.
            do k = 1, n
               associate (c => children(k))
                  if (is_stopped .or. c%descriptor >= 0 .or. all(c%part /= [0, turn])) cycle
                  is_stopped = c%part == turn .or. .not. c%has_ended
                  if (.not. c%has_ended) lost = k
               end associate
            end do
         end do

         do k = 1, n
            ended = 0
            ignored = waitpid(int(children(k)%process, c_int), ended, 0_c_int)
            if (k /= lost .or. any(has_failed(o%files))) cycle
            ! All parts before its own are written.
            status = status_system
            message = ' *** THE PROCESS FOR'//text_of(s, min(turn, part_count(s)))//' HAS FAILED'
            if (iand(ended, 127) > 0) message = message(:len(message) - len('HAS FAILED')) &
               //'WAS ENDED BY SIGNAL '//whole(iand(ended, 127))
         end do
      end associate
   end subroutine run_shares

   !> Makes this process a child, whose outputs of all sets go in frames to the pipe `descriptor`.
   subroutine begin_child(o, descriptor)
      class(outputs_t), intent(inout) :: o
      integer(c_int), intent(in) :: descriptor
      integer :: k

      do k = 1, out_shared
         ! Without a path the pipe is not closed with the output.
         o%files(k)%path = ''
         o%files(k)%descriptor = descriptor
         o%files(k)%frame = k
         o%files(k)%emptied = .true.
      end do
      o%share%reports%descriptor = descriptor
      o%share%reports%emptied = .true.
   end subroutine begin_child

   !> Ends this process, a child whose outputs are closed; its parent takes over the `message` and the exit `status`.
   !> The system keeps no exit status for a parent that was started with SIGCHLD ignored.
   subroutine end_child(o, status, message)
      class(outputs_t), intent(inout) :: o
      integer, intent(in) :: status
      character(*), intent(in) :: message

      call report(o%share, child_ends, whole(status)//' '//message)
      call end_process(0_c_int)
   end subroutine end_child

   !> Sends a frame to the parent: `kind`, as above, and a text.
   subroutine report(s, kind, text)
      type(share_of_job_t), intent(inout) :: s
      integer, intent(in) :: kind
      character(*), intent(in) :: text

      s%reports%frame = kind
      call write_text(s%reports, text)
   end subroutine report

   !> Reads what the child `c` has written since.
   subroutine read_from(c)
      type(child_t), intent(inout) :: c
      character(:), allocatable :: larger
      integer :: n
      logical :: closed

      n = c%last - c%first + 1
      if (c%first > 1) c%text(:n) = c%text(c%first:c%last)
      c%first = 1
      c%last = n
      if (len(c%text) - c%last < block_length) then
         allocate (character(2*len(c%text)) :: larger)
         larger(:n) = c%text(:n)
         call move_alloc(larger, c%text)
      end if

      n = read_bytes(c%descriptor, c%text(c%last + 1:))
      c%last = c%last + max(0, n)
      if (n > 0) return
      closed = close_descriptor(c%descriptor)
      c%descriptor = -1
   end subroutine read_from

   !> Writes the text of the child `c` that may be written: of the part whose `turn` it is, which is counted when it is
   !> done. `status`: the worst of the exit statuses; `message`: that of a child, if it is the first.
   subroutine write_frames(o, c, turn, status, message)
      class(outputs_t), intent(inout) :: o
      type(child_t), intent(inout) :: c
      integer, intent(inout) :: turn, status
      character(:), allocatable, intent(inout) :: message
      integer :: head(2), from, to, own

      do while (c%part <= turn .and. c%last - c%first + 1 >= frame_head)
         head = transfer(c%text(c%first:c%first + frame_head - 1), head)
         from = c%first + frame_head
         to = from + head(2) - 1
         if (to > c%last) exit
         select case (head(1))
         case (part_begins)
            read (c%text(from:to), *) c%part
         case (part_done)
            c%part = 0
            turn = turn + 1
            call flush_output(o%files(:out_shared))
         case (child_ends)
            c%has_ended = .true.
            read (c%text(from:to), *) own
            status = max(status, own)
            if (len(message) == 0) message = c%text(from + index(c%text(from:to), ' '):to)
         case default
            call add(o%files(head(1)), c%text(from:to))
         end select
         c%first = to + 1
      end do
   end subroutine write_frames

   !> Ends the part at hand, if there is one, and begins the next, of which o%own_first to o%own_last are the sets or
   !> variants. False where there is none, or the job is over.
   logical function next_part(o)
      class(outputs_t), intent(inout) :: o

      associate (s => o%share)
         next_part = .not. (s%is_parent .or. o%ended .or. allocated(o%failure) .or. any(has_failed(o%files)))
         if (.not. next_part) return
         if (s%is_child) then
            call flush_output(o%files(:out_shared))
            if (s%part > 0) call report(s, part_done, '')
            s%part = int(lseek(s%counter, 1_c_long, from_here))
         else
            s%part = s%part + 1
         end if
         next_part = s%part <= part_count(s)
         if (s%is_child .and. next_part) call report(s, part_begins, whole(s%part))
         o%own_first = first_of(s, s%part)
         o%own_last = first_of(s, s%part + 1) - 1
      end associate
   end function next_part

   !> How many parts there are; one where there is nothing to compute.
   pure integer function part_count(s)
      type(share_of_job_t), intent(in) :: s

      part_count = max(1, (s%last - s%first)/s%length + 1)
   end function part_count

   !> The first set or variant of part `p`, of those beyond the last one the number after the last.
   pure integer function first_of(s, p)
      type(share_of_job_t), intent(in) :: s
      integer, intent(in) :: p

      first_of = s%last + 1
      if (p <= part_count(s)) first_of = s%first + (p - 1)*s%length
   end function first_of

   !> SETS 5 TO 8, or VARIANTS 5 TO 8: part `p`.
   pure function text_of(s, p) result(text)
      type(share_of_job_t), intent(in) :: s
      integer, intent(in) :: p
      character(:), allocatable :: text

      text = ' '//s%kind//' '//whole(first_of(s, p))//' TO '//whole(first_of(s, p + 1) - 1)
   end function text_of
end module shares
