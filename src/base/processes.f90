!> Child processes, each a copy of this one, and the files that they hand over.
module processes
   use, intrinsic :: iso_c_binding, only: c_int, c_int64_t, c_long, c_size_t, c_char, c_null_char
   use system_calls, only: signal_received, remove_file
   implicit none
   private
   public :: processor_count, fork_process, wait_for_child, interrupt_child, end_process, killed, temporary_file, &
      from_beginning

   !> What `wait_for_child` adds to the number of the signal that has killed a child.
   integer, parameter :: killed = 1000

   !> SIGTERM; WNOHANG of waitpid, SEEK_SET of lseek, PR_SET_PDEATHSIG of prctl.
   integer(c_int), parameter :: signal_terminate = 15, at_once = 1, seek_set = 0, when_parent_ends = 1
   !> Microseconds between two looks at the children.
   integer(c_int), parameter :: pause = 500
   !> Bits of a set of processors, as sched_getaffinity takes it.
   integer, parameter :: processor_words = 16

   interface
      !> fork(2): 0 in the child, its number in the parent, negative for an error.
      integer(c_int) function fork() bind(c)
         import :: c_int
      end function fork
      !> waitpid(2): the number of a child that has ended, 0 where none has, -1 for an error.
      integer(c_int) function waitpid(child, status, options) bind(c)
         import :: c_int
         integer(c_int), value :: child, options
         integer(c_int), intent(out) :: status
      end function waitpid
      !> usleep(3): waits so many microseconds.
      integer(c_int) function usleep(microseconds) bind(c)
         import :: c_int
         integer(c_int), value :: microseconds
      end function usleep
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
      !> mkstemp(3): makes and opens a file whose name ends in letters of its own instead of XXXXXX.
      integer(c_int) function mkstemp(template) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(inout) :: template(*)
      end function mkstemp
      !> lseek(2): where in a file the next byte is read or written.
      integer(c_long) function lseek(descriptor, offset, whence) bind(c)
         import :: c_int, c_long
         integer(c_int), value :: descriptor, whence
         integer(c_long), value :: offset
      end function lseek
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

   !> Makes a child, a copy of this process, which ends when this one does. The result is 0 in the child, its number in
   !> the parent, negative for an error.
   integer function fork_process()
      integer(c_int) :: ignored

      fork_process = fork()
      if (fork_process == 0) ignored = prctl(when_parent_ends, signal_terminate)
   end function fork_process

   !> Waits until a child has ended or a signal has come. `child`: its number, 0 for none; `status`: its exit status, or
   !> `killed` + the number of the signal that has killed it.
   subroutine wait_for_child(child, status)
      integer, intent(out) :: child, status
      integer(c_int) :: ended, ignored

      do
         child = waitpid(-1_c_int, ended, at_once)
         if (child /= 0 .or. signal_received() > 0) exit
         ignored = usleep(pause)
      end do
      child = max(0, child)
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

   !> Opens a file without a name, in the directory that TMPDIR names, /tmp without it. The result is its descriptor,
   !> negative for an error, see `last_error`.
   integer(c_int) function temporary_file() result(descriptor)
      character(:), allocatable :: path
      integer :: length

      call get_environment_variable('TMPDIR', length=length)
      allocate (character(length) :: path)
      if (length > 0) call get_environment_variable('TMPDIR', path)
      if (length == 0) path = '/tmp'
      path = path//'/kinmat-XXXXXX'//c_null_char
      descriptor = mkstemp(path)
      if (descriptor >= 0) call remove_file(path(:len(path) - 1))
   end function temporary_file

   !> The next byte read from `descriptor` is its first one.
   subroutine from_beginning(descriptor)
      integer(c_int), intent(in) :: descriptor
      integer(c_long) :: place

      place = lseek(descriptor, 0_c_long, seek_set)
   end subroutine from_beginning
end module processes
