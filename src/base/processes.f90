!> Child processes, each a copy of this one, and the system's calls for them.
module processes
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int16_t, c_int64_t, c_long, c_size_t
   use system_calls, only: note_all_signals, close_descriptor
   implicit none
   private
   public :: processor_count, fork_process, interrupt_child, end_process, poll, poll_t, waitpid
   public :: memfd_create, lseek, from_here

   !> SIGTERM; of lseek: positions are counted from the present one.
   integer(c_int), parameter :: signal_terminate = 15, from_here = 1
   !> Bits of a set of processors, as sched_getaffinity takes it.
   integer, parameter :: processor_words = 16

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
      !> kill(2): sends a signal to a process.
      integer(c_int) function kill(process, number) bind(c)
         import :: c_int
         integer(c_int), value :: process, number
      end function kill
      !> _exit(2): ends the process at once with an exit status; nothing that its parent has buffered is written.
      subroutine end_process(status) bind(c, name='_exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine end_process
      !> sched_getaffinity(2): the processors that this process may use.
      integer(c_int) function sched_getaffinity(process, length, mask) bind(c)
         import :: c_int, c_size_t, c_int64_t
         integer(c_int), value :: process
         integer(c_size_t), value :: length
         integer(c_int64_t), intent(inout) :: mask(*)
      end function sched_getaffinity
      !> memfd_create(2): the descriptor of a file without a name, negative for an error.
      integer(c_int) function memfd_create(name, flags) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: name(*)
         integer(c_int), value :: flags
      end function memfd_create
      !> lseek(2): changes the position of an open file, for all processes that share it and in one piece.
      integer(c_long) function lseek(descriptor, offset, origin) bind(c)
         import :: c_int, c_long
         integer(c_int), value :: descriptor, origin
         integer(c_long), value :: offset
      end function lseek
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

   !> Makes a child, a copy of this process, which ends by itself after the first signal, or when it writes and this
   !> process is gone. A pipe leads from it to this process: `descriptor` is the end that the child writes to, here the
   !> end that is read. The result is 0 in the child, its number in the parent, negative for an error.
   integer function fork_process(descriptor)
      integer(c_int), intent(out) :: descriptor
      integer(c_int) :: ends(2)
      logical :: closed

      fork_process = -1
      if (pipe(ends) /= 0) return
      fork_process = fork()
      descriptor = ends(merge(2, 1, fork_process == 0))
      closed = close_descriptor(ends(merge(1, 2, fork_process == 0)))
      if (fork_process == 0) call note_all_signals
   end function fork_process

   !> Asks the process `child` to end.
   impure elemental subroutine interrupt_child(child)
      integer, intent(in) :: child
      integer(c_int) :: ignored

      ignored = kill(int(child, c_int), signal_terminate)
   end subroutine interrupt_child
end module processes
