!> Child processes, each a copy of this one, and the pipes between them.
module processes
   use, intrinsic :: iso_c_binding, only: c_int, c_int16_t, c_int64_t, c_long, c_size_t
   use failures, only: status_system
   use system_calls, only: write_bytes, note_all_signals
   implicit none
   private
   public :: processor_count, make_pipe, has_input, fork_process, wait_for_child, interrupt_child, end_process, killed
   public :: end_without_memory, report, end_of_message

   !> What `wait_for_child` adds to the number of the signal that has killed a child.
   integer, parameter :: killed = 1000

   !> SIGTERM; PR_SET_PDEATHSIG of prctl.
   integer(c_int), parameter :: signal_terminate = 15, when_parent_ends = 1
   !> Bits of a set of processors, as sched_getaffinity takes it.
   integer, parameter :: processor_words = 16
   !> Ends the message that a child reports to its parent.
   character(1), parameter :: end_of_message = achar(2)
   character(*), parameter :: no_memory = ' *** NOT ENOUGH MEMORY FOR THE DECK'
   !> Where this process reports an error: standard error, in a child the pipe to its parent.
   integer(c_int), parameter :: standard_error = 2
   integer(c_int) :: report_to = standard_error

   !> What poll is asked about a descriptor: whether there is input.
   type, bind(c) :: poll_t
      integer(c_int) :: descriptor = -1
      integer(c_int16_t) :: asked = 1, found = 0
   end type poll_t

   interface
      !> fork(2): 0 in the child, its number in the parent, negative for an error.
      integer(c_int) function fork() bind(c)
         import :: c_int
      end function fork
      !> poll(2): waits for input or the end of input, at most so many milliseconds: 0 if there is none, -1 at a signal.
      integer(c_int) function poll(list, count, milliseconds) bind(c)
         import :: c_int, c_long, poll_t
         type(poll_t), intent(inout) :: list(*)
         integer(c_long), value :: count
         integer(c_int), value :: milliseconds
      end function poll
      !> pipe(2): makes a pipe, whose ends are read from and written to; 0, or -1 for an error.
      integer(c_int) function pipe(ends) bind(c)
         import :: c_int
         integer(c_int), intent(out) :: ends(2)
      end function pipe
      !> waitpid(2): waits until the child has ended, -1 for an error.
      integer(c_int) function waitpid(child, status, options) bind(c)
         import :: c_int
         integer(c_int), value :: child, options
         integer(c_int), intent(out) :: status
      end function waitpid
      !> prctl(2): what this process does on an occasion.
      integer(c_int) function prctl(occasion, number) bind(c)
         import :: c_int
         integer(c_int), value :: occasion, number
      end function prctl
      !> kill(2): sends a signal to a process.
      integer(c_int) function kill(process, number) bind(c)
         import :: c_int
         integer(c_int), value :: process, number
      end function kill
      !> _exit(2): ends the process at once.
      subroutine exit_at_once(status) bind(c, name='_exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine exit_at_once
      !> sched_getaffinity(2): the processors that this process may use.
      integer(c_int) function sched_getaffinity(process, length, mask) bind(c)
         import :: c_int, c_size_t, c_int64_t
         integer(c_int), value :: process
         integer(c_size_t), value :: length
         integer(c_int64_t), intent(inout) :: mask(*)
      end function sched_getaffinity
   end interface

contains

   !> How many processors this process may use; 1 where the system does not say.
   integer function processor_count()
      integer(c_int64_t) :: mask(processor_words)

      mask = 0
      processor_count = 1
      if (sched_getaffinity(0_c_int, storage_size(mask)/8_c_size_t*processor_words, mask) == 0) &
         processor_count = max(1, sum(popcnt(mask)))
   end function processor_count

   !> Makes a pipe. `reads` and `writes`: the descriptors of its ends, negative for an error, see `last_error`.
   subroutine make_pipe(reads, writes)
      integer(c_int), intent(out) :: reads, writes
      integer(c_int) :: ends(2)

      if (pipe(ends) /= 0) ends = -1
      reads = ends(1)
      writes = ends(2)
   end subroutine make_pipe

   !> Whether `descriptor` has input or has come to its end, now or, unless a signal comes, in so many milliseconds.
   logical function has_input(descriptor, milliseconds)
      integer(c_int), intent(in) :: descriptor
      integer, intent(in) :: milliseconds
      type(poll_t) :: list(1)

      list%descriptor = descriptor
      has_input = poll(list, 1_c_long, int(milliseconds, c_int)) > 0
   end function has_input

   !> Makes a child, a copy of this process, which ends when this one does, and after the first signal by itself. It
   !> reports to the pipe `writes`. The result is 0 in the child, its number in the parent, negative for an error.
   integer function fork_process(writes)
      integer(c_int), intent(in) :: writes
      integer(c_int) :: ignored

      fork_process = fork()
      if (fork_process /= 0) return
      ignored = prctl(when_parent_ends, signal_terminate)
      call note_all_signals
      report_to = writes
   end function fork_process

   !> Waits until the process `child` has ended. `status`: its exit status, or `killed` + the number of the signal that
   !> has killed it.
   subroutine wait_for_child(child, status)
      integer, intent(in) :: child
      integer, intent(out) :: status
      integer(c_int) :: ended, ignored

      ended = 0
      ignored = waitpid(int(child, c_int), ended, 0_c_int)
      status = ishft(iand(ended, 65535), -8)
      if (iand(ended, 127) /= 0) status = killed + iand(ended, 127)
   end subroutine wait_for_child

   !> Asks the process `child` to end.
   subroutine interrupt_child(child)
      integer, intent(in) :: child
      integer(c_int) :: ignored

      ignored = kill(int(child, c_int), signal_terminate)
   end subroutine interrupt_child

   !> Ends this process with the exit status `status`; nothing that its parent has buffered is written.
   subroutine end_process(status)
      integer, intent(in) :: status

      call exit_at_once(int(status, c_int))
   end subroutine end_process

   !> Reports the `message` of this process, a child, to its parent, in one piece.
   subroutine report(message)
      character(*), intent(in) :: message
      integer(c_size_t) :: written

      written = write_bytes(report_to, message//end_of_message)
   end subroutine report

   !> Ends this process because memory lacks, and uses none for it. Outputs end with the last block of lines written.
   subroutine end_without_memory
      integer(c_size_t) :: written

      if (report_to == standard_error) then
         written = write_bytes(report_to, no_memory//new_line('a'))
      else
         written = write_bytes(report_to, no_memory//end_of_message)
      end if
      call end_process(status_system)
   end subroutine end_without_memory
end module processes
