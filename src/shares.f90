!> A job's sets, or their variants, in several processes. They are divided into parts that follow one another; whoever
!> is free takes the next one, and parts are written in their order (`processes`). One that dies or is broken off leaves
!> its part undone, and nothing after that is written.
!>
!> Rejected: threads. gfortran 12 keeps the lengths of character results in static memory, where threads write over each
!> other's: of 2000 sets in two threads, two listings had words cut short.
module shares
   use, intrinsic :: iso_c_binding, only: c_int
   use failures, only: capitals, status_system
   use numerals, only: whole
   use processes, only: make_pipe, has_input, fork_process, wait_for_child, interrupt_child, killed, end_of_message, &
      make_turns, close_turns, begin_part, end_part, write_rest, parts_taken, parts_done
   use system_calls, only: read_bytes, close_descriptor, signal_received, last_error, reason_of
   use text_output, only: has_failed
   use progress, only: progress_t, show_progress
   use outputs, only: outputs_t, flush_files, forget_files
   implicit none
   private
   public :: share_of_job_t, run_shares, next_part

   !> Parts for each process: the last ones end together, and text that waits is still in the processor's cache. Of
   !> variants solved together there are fewer: a part begins with a structure anew, as long as several of them take.
   integer, parameter :: parts_a_process = 1024, parts_together = 32
   !> Milliseconds after which the parent looks whether a signal has come, and how far the job is.
   integer, parameter :: look_time = 200

   !> What this process computes.
   type :: share_of_job_t
      character(:), allocatable :: kind             !< SETS or VARIANTS
      integer :: first = 1, last = 0                !< all of them
      integer :: length = huge(1)                   !< so many of them are a part
      integer :: unit = 1                           !< so many variants are solved together
      logical :: is_child = .false., is_parent = .false.
   end type share_of_job_t

contains

   !> Computes the sets or variants of `s` in `processes` processes. It returns more than once: in each child, to
   !> compute the parts that `next_part` gives and to end then; in the parent when all is done. `status`: then
   !> the exit status; `message`: what to say of an error.
   subroutine run_shares(o, s, processes, progress, status, message)
      class(outputs_t), intent(inout) :: o
      type(share_of_job_t), intent(inout) :: s
      integer, intent(in) :: processes
      type(progress_t), intent(inout) :: progress
      integer, intent(inout) :: status
      character(:), allocatable, intent(inout) :: message
      character(4096) :: block
      character(:), allocatable :: said
      integer :: list(processes), started, taken, ended, k, n
      integer(c_int) :: reads, writes
      logical :: closed

      associate (count => s%last - s%first + 1)
         s%length = s%unit*max(1, count/(s%unit*processes*merge(parts_together, parts_a_process, s%unit > 1)))
         if (count < processes*s%length) s%length = (count - 1)/processes + 1
      end associate
      s%is_parent = .true.

      started = 0
      call make_pipe(reads, writes)
      if (reads >= 0) then
         if (make_turns(o%turns)) started = processes
      end if
      do k = 1, started
         list(k) = fork_process(writes)
         s%is_child = list(k) == 0
         if (s%is_child) then
            s%is_parent = .false.
            ! Files that it computes no part of are left as they are.
            o%files(:, 0)%emptied = .true.
            return
         end if
         if (list(k) < 0) started = k - 1
         if (list(k) < 0) exit
      end do
      if (started < processes) then
         status = status_system
         message = ' *** CANNOT START A PROCESS FOR'//text_of(started + 1)//' ('//capitals(reason_of(last_error()))//')'
         call interrupt_child(list(:started))
      end if
      if (reads >= 0) then
         closed = close_descriptor(writes)
         ! The children end; their first message is that of the whole, and so is the worst status.
         said = ''
         do
            if (signal_received() > 0) call interrupt_child(list(:started))
            if (has_input(reads, look_time)) then
               n = read_bytes(reads, block)
               if (n <= 0) exit
               said = said//block(:n)
            end if
            call show_progress(progress, s%kind//': NUMBER', first_of(s, parts_done(o%turns) + 1) - 1, s%last)
         end do
         if (len(message) == 0 .and. len(said) > 0) message = said(:index(said, end_of_message) - 1)

         do k = 1, started
            call wait_for_child(list(k), ended)
            if (ended >= killed .and. status < status_system) then
               ! All parts before its own are done.
               message = ' *** THE PROCESS FOR'//text_of(min(parts_done(o%turns) + 1, part_count(s))) &
                  //' WAS ENDED BY SIGNAL '//whole(ended - killed)
               status = status_system
            else if (ended < killed) then
               status = max(status, ended)
            end if
         end do
         closed = close_descriptor(reads)
      end if

      ! The children have written these files.
      taken = min(parts_taken(o%turns), part_count(s))
      if (taken > 0) o%files(:, 0)%emptied = .true.
      call forget_files(o, s%first, first_of(s, taken + 1) - 1)
      call close_turns(o%turns)

   contains

      !> SETS 5 TO 8, or VARIANTS 5 TO 8: part `p`.
      pure function text_of(p) result(text)
         integer, intent(in) :: p
         character(:), allocatable :: text

         text = ' '//s%kind//' '//whole(first_of(s, p))//' TO '//whole(first_of(s, p + 1) - 1)
      end function text_of
   end subroutine run_shares

   !> Ends the part at hand, if there is one, and begins the next, of which o%own_first to o%own_last are the sets or
   !> variants. False where there is none, or the job is over; then all is written.
   logical function next_part(o, s)
      class(outputs_t), intent(inout) :: o
      type(share_of_job_t), intent(in) :: s
      integer :: before

      next_part = .not. s%is_parent
      if (s%is_parent) return
      before = merge(o%own_last, s%first - 1, o%turns%part > 0)
      if (s%is_child .and. o%turns%part > 0) then
         call flush_files(o, o%own_first, o%own_last)
         call end_part(o%turns, o%files(:, 0), goes_on(o))
      end if

      next_part = goes_on(o)
      if (.not. s%is_child) o%turns%part = o%turns%part + 1
      if (s%is_child .and. next_part) call begin_part(o%turns, part_count(s), o%files(:, 0))
      next_part = next_part .and. o%turns%part <= part_count(s)
      o%own_first = first_of(s, o%turns%part)
      o%own_last = first_of(s, o%turns%part + 1) - 1

      if (.not. s%is_child) return
      ! The sets between are those of other processes.
      call forget_files(o, before + 1, merge(o%own_first - 1, s%last, next_part))
      if (.not. next_part) call write_rest(o%turns, o%files(:, 0))
   end function next_part

   !> The run has not ended before its time, and no write has failed.
   logical function goes_on(o)
      class(outputs_t), intent(in) :: o
      integer :: i

      goes_on = .not. (o%ended .or. any(has_failed(o%files(:, 0))))
      do i = o%own_first, min(o%own_last, ubound(o%files, 2))
         if (any(has_failed(o%files(:, i)))) goes_on = .false.
      end do
   end function goes_on

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
end module shares
