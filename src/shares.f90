!> A job's sets, or their variants, in several processes. They are divided into parts that follow one another, of which
!> each process computes every so many-th. Its text stays in memory until the part before it has been written: a ring of
!> pipes hands the turn to write from process to process. One that dies or is broken off closes its pipe, and nothing
!> more is written.
!>
!> Rejected: threads. gfortran 12 keeps the lengths of character results in static memory, where threads write over each
!> other's: of 2000 sets in two threads, two listings had words cut short.
module shares
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t
   use failures, only: capitals, status_solved, status_system
   use deck, only: share_end
   use numerals, only: whole
   use processes, only: make_pipe, has_input, fork_process, wait_for_child, interrupt_child, end_process, &
      killed
   use system_calls, only: read_bytes, write_bytes, close_descriptor, signal_received, note_all_signals, last_error, &
      reason_of
   use text_output, only: write_block, take_turn, has_failed, turn_lost
   use progress, only: progress_t, show_progress
   use outputs, only: outputs_t, forget_files
   implicit none
   private
   public :: share_of_job_t, run_shares, next_part, end_share

   !> Parts for each process: of sets that take unequal times the last ones end together.
   integer, parameter :: parts_a_process = 64
   !> The least variants in a part: they fill the lanes.
   integer, parameter :: least_variants = 8
   !> Milliseconds after which the parent looks whether a signal has come.
   integer, parameter :: look_time = 500
   !> What a child reports to its parent: that a part is written, or, after its message, that it ends.
   character(1), parameter :: part_written = achar(1), end_of_message = achar(2)

   !> What this process computes.
   type :: share_of_job_t
      character(:), allocatable :: kind             !< SETS or VARIANTS
      integer :: first = 1, last = 0                !< all of them
      integer :: parts = 1                          !< so many parts there are; in the parent of other processes none
      integer :: part = 0                           !< the one at hand
      integer :: processes = 1
      logical :: is_child = .false.
      integer(c_int) :: turn = -1, next_turn = -1   !< pipes: a byte for each output, and one; see `text_output`
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
      integer(c_int) :: last_turn, report

      associate (count => s%last - s%first + 1)
         s%parts = count
         if (s%kind == 'VARIANTS') s%parts = count/least_variants
         s%parts = min(count, max(processes, min(s%parts, parts_a_process*processes)))
      end associate
      s%processes = processes
      call make_pipe(s%report, report)
      call make_pipe(s%turn, last_turn)
      if (s%turn >= 0) call pass_turn(o, last_turn)
      do k = 1, processes
         list(k) = -1
         if (k == processes) s%next_turn = last_turn
         if (s%report < 0 .or. s%turn < 0) exit
         call make_child(list(k))
         if (s%is_child) return
         if (list(k) < 0) exit
      end do
      if (k <= processes) then
         status = status_system
         message = ' *** NO PROCESS FOR'//text_of(k)//' ('//capitals(reason_of(last_error()))//')'
         call interrupt_all(list(:k - 1))
         call close_one(last_turn)
      end if
      call close_one(s%turn)
      call close_one(report)
      call forget_files(o, s%first, s%last)
      call follow(list(:min(k, processes)), message)
      s%parts = 0

   contains

      !> Makes process number `k`, whose number among all processes is `child`, negative if there is none. s%turn: in
      !> its parent that of the next process from now on.
      subroutine make_child(child)
         integer, intent(out) :: child
         integer(c_int) :: next

         next = -1
         child = -1
         if (k < s%processes) call make_pipe(next, s%next_turn)
         if (s%next_turn < 0) return
         child = fork_process()
         s%is_child = child == 0
         if (s%is_child) then
            call note_all_signals
            call close_one(s%report)
            s%report = report
            if (k < s%processes) call close_one(last_turn)
            if (k < s%processes) call close_one(next)
            s%part = k - s%processes
            call forget_others()
         else
            call close_one(s%turn)
            call close_one(s%next_turn)
            s%turn = next
            ! What the first process has emptied is not emptied again.
            if (child > 0) o%files(:, 0)%emptied = .true.
         end if
      end subroutine make_child

      !> Leaves to other processes the files of those sets that process number `k` does not compute.
      subroutine forget_others()
         integer :: p

         do p = 1, s%parts
            if (modulo(p - k, s%processes) /= 0) call forget_files(o, first_of(s, p), first_of(s, p + 1) - 1)
         end do
      end subroutine forget_others

      !> Waits for the children of `list`, takes over the first `message`, and finds the `status` of the whole.
      subroutine follow(list, message)
         integer, intent(in) :: list(:)
         character(:), allocatable, intent(inout) :: message
         character(4096) :: block
         character(:), allocatable :: said
         integer :: ended, k, p, i, n

         p = 0
         said = ''
         do while (s%report >= 0)
            if (signal_received() > 0) call interrupt_all(list)
            if (.not. has_input(s%report, look_time)) cycle
            n = read_bytes(s%report, block)
            if (n <= 0) exit
            do i = 1, n
               if (block(i:i) /= part_written) said = said//block(i:i)
               if (block(i:i) == part_written) p = p + 1
            end do
            if (p > 0) call show_progress(progress, s%kind//': NUMBER', first_of(s, p + 1) - 1, s%last)
         end do
         if (len(message) == 0 .and. len(said) > 0) message = said(:index(said, end_of_message) - 1)
         do k = 1, size(list)
            if (list(k) <= 0) cycle
            call wait_for_child(list(k), ended)
            if (ended >= killed .and. status < status_system) then
               ! The first of its parts that is not written.
               message = ' *** THE PROCESS FOR'//text_of(p + 1 + modulo(k - p - 1, s%processes)) &
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

   !> Ends the part at hand, if there is one, and begins the next: `first` to `last`. False where there is none, or the
   !> job is over.
   logical function next_part(o, s, first, last)
      class(outputs_t), intent(inout) :: o
      type(share_of_job_t), intent(inout) :: s
      integer, intent(out) :: first, last

      if (s%part > 0 .and. s%is_child) call end_part(o, s)
      s%part = s%part + s%processes
      first = first_of(s, s%part)
      last = first_of(s, s%part + 1) - 1
      next_part = s%part <= s%parts .and. signal_received() == 0 .and. .not. any(has_failed(o%files))
      if (next_part .and. s%is_child) o%files(:, 0)%turn = s%turn
   end function next_part

   !> Writes the text of the part at hand as soon as its turn has come, and passes the turn on unless the job is over.
   subroutine end_part(o, s)
      class(outputs_t), intent(inout) :: o
      type(share_of_job_t), intent(inout) :: s
      integer(c_int) :: turn
      integer(c_size_t) :: written
      integer :: k

      do k = 1, size(o%files, 1)
         if (allocated(o%files(k, 0)%buffer)) call write_block(o%files(k, 0))
      end do
      turn = s%turn
      call take_turn(turn, o%files(1, 0)%error)
      if (signal_received() > 0 .or. any(has_failed(o%files))) return
      written = write_bytes(s%report, part_written)
      if (s%part == s%parts) return
      call pass_turn(o, s%next_turn)
   end subroutine end_part

   !> Gives the turn to the process that reads from `pipe`.
   subroutine pass_turn(o, pipe)
      class(outputs_t), intent(in) :: o
      integer(c_int), intent(in) :: pipe
      integer(c_size_t) :: written
      integer :: k

      written = write_bytes(pipe, repeat('.', 1 + count([(allocated(o%files(k, 0)%buffer), k=1, size(o%files, 1))])))
   end subroutine pass_turn

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

      first_of = s%first + share_end(s%last - s%first + 1, min(p, s%parts + 1) - 1, max(1, s%parts))
   end function first_of
end module shares
