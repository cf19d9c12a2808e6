!> Child processes, each a copy of this one, and the system's calls for them.
module processes
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int16_t, c_int64_t, c_long, c_size_t
   use system_calls, only: notes_all, last_error
   implicit none
   private
   public :: processor_count, fork_process, interrupt_child, end_process
   public :: waitpid, no_hang, usleep, memfd_create, lseek, from_here, change_lock, locked, unlocked

   !> SIGTERM; PR_SET_PDEATHSIG of prctl.
   integer(c_int), parameter :: signal_terminate = 15, when_parent_ends = 1
   !> Bits of a set of processors, as sched_getaffinity takes it.
   integer, parameter :: processor_words = 16

   !> Bytes that are locked, as fcntl takes them.
   type, bind(c) :: lock_t
      integer(c_int16_t) :: kind = 0, from = 0
      integer(c_long) :: first = 0, length = 1
      integer(c_int) :: process = 0
   end type lock_t

   !> Of fcntl: sets a lock, and waits for it. Kinds of locks. Of lseek: positions are counted from the present one. Of
   !> waitpid: does not wait.
   integer(c_int), parameter :: set_lock = 7, from_here = 1, no_hang = 1
   integer(c_int16_t), parameter :: locked = 1, unlocked = 2
   !> The system's number of the error that a signal came.
   integer, parameter :: interrupted = 4

   interface
      !> fork(2): 0 in the child, its number in the parent, negative for an error.
      integer(c_int) function fork() bind(c)
         import :: c_int
      end function fork
      !> usleep(3): waits so many microseconds, or until a signal comes.
      integer(c_int) function usleep(microseconds) bind(c)
         import :: c_int
         integer(c_int), value :: microseconds
      end function usleep
      !> waitpid(2): how the child has ended; 0 with `no_hang` if it runs, -1 for an error.
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
      !> fcntl(2) with a lock: 0, or -1 for an error, such as a signal.
      integer(c_int) function fcntl(descriptor, command, lock) bind(c)
         import :: c_int, lock_t
         integer(c_int), value :: descriptor, command
         type(lock_t), intent(inout) :: lock
      end function fcntl
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

   !> Makes a child, a copy of this process, which ends when this one does, and after the first signal by itself. The
   !> result is 0 in the child, its number in the parent, negative for an error.
   integer function fork_process()
      integer(c_int) :: ignored

      fork_process = fork()
      if (fork_process /= 0) return
      ignored = prctl(when_parent_ends, signal_terminate)
      notes_all = .true.
   end function fork_process

   !> Asks the process `child` to end.
   impure elemental subroutine interrupt_child(child)
      integer, intent(in) :: child
      integer(c_int) :: ignored

      ignored = kill(int(child, c_int), signal_terminate)
   end subroutine interrupt_child

   !> Sets or opens the lock of byte `k` of the file `descriptor` when it can be had, whatever signals come meanwhile.
   subroutine change_lock(descriptor, k, kind)
      integer(c_int), intent(in) :: descriptor
      integer, intent(in) :: k
      integer(c_int16_t), intent(in) :: kind
      type(lock_t) :: lock

      lock%kind = kind
      lock%first = k
      do while (fcntl(descriptor, set_lock, lock) /= 0)
         if (last_error() /= interrupted) exit
      end do
   end subroutine change_lock
end module processes
