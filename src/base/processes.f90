!> Child processes, each a copy of this one, and the system's calls for them.
module processes
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int16_t, c_int64_t, c_long, c_size_t
   use system_calls, only: notes_all, signal_terminate, watch_signals, last_error
   implicit none
   private
   public :: processor_count, fork_process, interrupt_child, end_process
   public :: waitpid, no_hang, usleep, memfd_create, lseek, from_here, change_lock, locked, unlocked

   !> PR_SET_PDEATHSIG of prctl.
   integer(c_int), parameter :: when_parent_ends = 1
   !> Words of 64 bits in a set of processors, as sched_getaffinity takes it: the 1024 processors of the GNU library.
   integer, parameter :: processor_words = 16

   !> Bytes that are locked, as fcntl takes them: l_type, l_whence, l_start, l_len and l_pid of struct flock.
   type, bind(c) :: lock_t
      integer(c_int16_t) :: kind = 0, from = 0
      integer(c_long) :: first = 0, length = 1
      integer(c_int) :: process = 0
   end type lock_t

   !> F_SETLKW of fcntl: sets a lock, and waits for it.
   integer(c_int), parameter :: set_lock = 7
   !> SEEK_CUR of lseek: positions are counted from the present one.
   integer(c_int), parameter :: from_here = 1
   !> WNOHANG of waitpid: does not wait.
   integer(c_int), parameter :: no_hang = 1
   !> F_WRLCK and F_UNLCK, kinds of locks: one process has the byte; none has it.
   integer(c_int16_t), parameter :: locked = 1, unlocked = 2
   !> EINTR: the system's number of the error that a signal has interrupted the call.
   integer, parameter :: interrupted = 4

   interface
      !> Makes a copy of this process: fork(2). The result is 0 in the child, the child's number in the parent, -1 for
      !> an error.
      integer(c_int) function fork() bind(c)
         import :: c_int
      end function fork
      !> Waits some time, or until a signal comes: usleep(3). The result is 0, or -1 for an error, such as a signal.
      integer(c_int) function usleep(microseconds) bind(c)
         import :: c_int
         integer(c_int), value :: microseconds   !< how long
      end function usleep
      !> Tells how a child has ended: waitpid(2). The result is the child's number, 0 if the child still runs (only with
      !> `no_hang`), or -1 for an error.
      integer(c_int) function waitpid(child, status, options) bind(c)
         import :: c_int
         integer(c_int), value :: child       !< its number
         integer(c_int), value :: options     !< 0: waits until the child ends; `no_hang`: does not
         integer(c_int), intent(out) :: status   !< how it has ended, in the bits of the system
      end function waitpid
      !> Sets an option of this process: prctl(2). The result is 0, or -1 for an error.
      integer(c_int) function prctl(occasion, number) bind(c)
         import :: c_int
         integer(c_int), value :: occasion    !< the option: `when_parent_ends`
         integer(c_int), value :: number      !< its value: the number of the signal sent on this occasion
      end function prctl
      !> Sends a signal to a process: kill(2). The result is 0, or -1 for an error.
      integer(c_int) function kill(process, number) bind(c)
         import :: c_int
         integer(c_int), value :: process     !< its number
         integer(c_int), value :: number      !< the number of the signal
      end function kill
      !> Ends this process at once: _exit(2). Buffered text, such as a copy of the parent's, is not written.
      subroutine end_process(status) bind(c, name='_exit')
         import :: c_int
         integer(c_int), value :: status   !< exit status
      end subroutine end_process
      !> Finds the processors that a process may use: sched_getaffinity(2). The result is 0, or -1 for an error.
      integer(c_int) function sched_getaffinity(process, length, mask) bind(c)
         import :: c_int, c_size_t, c_int64_t
         integer(c_int), value :: process     !< its number; 0: this one
         integer(c_size_t), value :: length   !< bytes of `mask`
         integer(c_int64_t), intent(inout) :: mask(*)   !< (length/8) a bit for each processor; 1: may be used
      end function sched_getaffinity
      !> Makes a file without a name in memory: memfd_create(2). The result is the file's descriptor, or -1 for an
      !> error.
      integer(c_int) function memfd_create(name, flags) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: name(*)   !< (any length) shown by the system; ends with a null
         integer(c_int), value :: flags       !< 0
      end function memfd_create
      !> Changes the position of an open file, for all processes that share the file, without an interruption: lseek(2).
      !> The result is the new position in bytes, or -1 for an error.
      integer(c_long) function lseek(descriptor, offset, origin) bind(c)
         import :: c_int, c_long
         integer(c_int), value :: descriptor  !< of the file
         integer(c_int), value :: origin      !< from where the position is counted: `from_here`
         integer(c_long), value :: offset     !< bytes
      end function lseek
      !> Sets a lock of a file: fcntl(2). The result is 0, or -1 for an error, such as a signal.
      integer(c_int) function fcntl(descriptor, command, lock) bind(c)
         import :: c_int, lock_t
         integer(c_int), value :: descriptor  !< of the file
         integer(c_int), value :: command     !< `set_lock`
         type(lock_t), intent(inout) :: lock !< the byte, and the kind of the lock
      end function fcntl
   end interface

contains

   !> Counts the processors that this process may use: 1 or more; 1 if the system gives no answer.
   integer function processor_count()
      integer(c_int64_t) :: mask(processor_words)

      mask = 0
      processor_count = 1
      if (sched_getaffinity(0_c_int, storage_size(mask)/8_c_size_t*processor_words, mask) == 0) &
         processor_count = max(1, sum(popcnt(mask)))
   end function processor_count

   !> Makes a child, a copy of this process, and gives 0 in the child, the child's number in the parent, or -1 for an
   !> error. The child gets SIGTERM when its parent ends; it records all signals and ends by itself.
   integer function fork_process()
      integer(c_int) :: ignored

      ! The child begins with the handler that records all signals, also if a signal has come before.
      notes_all = .true.
      call watch_signals
      fork_process = fork()
      notes_all = fork_process == 0
      if (notes_all) ignored = prctl(when_parent_ends, signal_terminate)
   end function fork_process

   !> Sends a child SIGTERM, so that the child ends after its instant.
   impure elemental subroutine interrupt_child(child)
      integer, intent(in) :: child   !< the number of the process
      integer(c_int) :: ignored

      ignored = kill(int(child, c_int), signal_terminate)
   end subroutine interrupt_child

   !> Sets or opens a lock of one byte of a file; waits until no other process holds the lock, even if signals come.
   !> After any other error the lock stays as it was.
   subroutine change_lock(descriptor, k, kind)
      integer(c_int), intent(in) :: descriptor   !< of the file
      integer, intent(in) :: k               !< the byte, counted from 0
      integer(c_int16_t), intent(in) :: kind   !< `locked` or `unlocked`
      type(lock_t) :: lock

      lock%kind = kind
      lock%first = k
      do while (fcntl(descriptor, set_lock, lock) /= 0)
         if (last_error() /= interrupted) exit
      end do
   end subroutine change_lock
end module processes
