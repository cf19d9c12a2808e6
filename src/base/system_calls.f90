!> Calls of the system that Fortran does not have: bytes of files, the identity of a file, the reason of an error, and
!> signals. The first SIGINT or SIGTERM is only recorded, and the job ends after its instant, with whole lines; the
!> second one kills.
!>
!> The Fortran run-time library of GNU reports no error of a full disk, neither from WRITE nor from FLUSH nor from
!> CLOSE, and takes a failed read for the end of a file.
module system_calls
   use, intrinsic :: iso_c_binding, only: c_int, c_int16_t, c_int32_t, c_int64_t, c_long, c_size_t, c_char, c_ptr, &
      c_null_char, c_f_pointer, c_intptr_t, c_funptr, c_funloc, c_null_funptr
   implicit none
   private
   public :: signal_terminate, standard_input, identity_t, identity_of, identity_of_open, same_file
   public :: open_to_read, open_to_write, read_bytes, write_bytes, close_descriptor, ftruncate, remove_file
   public :: isatty
   public :: watch_signals, notes_all, signal_received, end_by_signal, signal_pipe
   public :: occupy_standard_descriptors, last_error, reason_of, closed_descriptor

   !> The identity of a file; the default of the type: there is no such file.
   type :: identity_t
      integer(c_int32_t) :: device(2) = 0  !< major and minor number
      integer(c_int64_t) :: inode = 0
      logical :: regular = .false.         !< not a device, not a pipe, not a directory, and not missing
      logical :: device_or_pipe = .false.  !< neither regular nor a directory, and not missing
   end type identity_t

   !> O_RDONLY and O_WRONLY of open. These flags, flags of statx and numbers of errors have one value on every
   !> architecture of Linux.
   integer(c_int), parameter :: read_only = 0, write_only = 1
   !> ENOENT and EBADF.
   integer, parameter :: no_such_file = 2, closed_descriptor = 9
   !> The descriptor of standard input.
   integer(c_int), parameter :: standard_input = 0
   !> AT_FDCWD of statx: paths begin at the working directory. STATX_BASIC_STATS: the facts that stat gives.
   integer(c_int), parameter :: from_working_directory = -100, basic_facts = int(z'7FF', c_int)
   !> AT_EMPTY_PATH: the descriptor itself. AT_SYMLINK_NOFOLLOW: a symbolic link itself.
   integer(c_int), parameter :: empty_path = int(z'1000', c_int), no_links = int(z'100', c_int)
   !> Read and write for all, less the user's mask.
   integer(c_int), parameter :: permissions = int(o'666', c_int)
   !> Kinds of files within a mode.
   integer, parameter :: kind_bits = int(o'170000'), kind_regular = int(o'100000'), kind_directory = int(o'040000')

   !> SIGINT, SIGPIPE, SIGTERM, SIGCHLD, SIGXFSZ: numbers of signals.
   integer(c_int), parameter :: signal_interrupt = 2, signal_pipe = 13, signal_terminate = 15, signal_child = 17, &
      signal_file_size = 25
   !> The signals that are recorded.
   integer(c_int), parameter :: watched(2) = [signal_interrupt, signal_terminate]
   !> The address that means "ignore"; null means the usual action.
   integer(c_intptr_t), parameter :: ignored = 1

   !> The last signal that was recorded: a handler may change nothing else.
   integer(c_int), volatile :: received = 0
   !> Every signal is recorded, not only the first: the process ends by itself afterwards.
   logical, volatile :: notes_all = .false.

   !> The facts of statx: the layout of stat would depend on the architecture.
   type, bind(c) :: statx_t
      integer(c_int32_t) :: head(7)
      integer(c_int16_t) :: mode, spare
      integer(c_int64_t) :: inode
      integer(c_int64_t) :: sizes_and_times(11)
      integer(c_int32_t) :: special_device(2), device(2)
      integer(c_int64_t) :: room(14)
   end type statx_t

   interface
      !> Finds the kind and the identity of a file: statx(2). The result is 0, or -1 for an error.
      integer(c_int) function statx(directory, path, flags, mask, facts) bind(c)
         import :: c_int, c_char, statx_t
         integer(c_int), value :: directory   !< where the path begins: `from_working_directory` or a descriptor
         integer(c_int), value :: flags       !< 0, `empty_path` or `no_links`
         integer(c_int), value :: mask        !< the facts that are wanted: `basic_facts`
         character(kind=c_char), intent(in) :: path(*)   !< (any length) ends with a null
         type(statx_t), intent(out) :: facts !< the facts, if the result is 0
      end function statx
      !> Opens a file that exists: open(2) without a mode. The result is a descriptor, negative for an error.
      integer(c_int) function c_open(path, flags) bind(c, name='open')
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)   !< (any length) ends with a null
         integer(c_int), value :: flags       !< `read_only` or `write_only`
      end function c_open
      !> Creates or empties a file: creat(2). The result is a descriptor, negative for an error.
      integer(c_int) function creat(path, mode) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)   !< (any length) ends with a null
         integer(c_int), value :: mode        !< `permissions`
      end function creat
      !> Reads bytes: read(2). The result is the number of bytes read, 0 at the end of the file, negative for an error.
      integer(c_size_t) function c_read(descriptor, text, length) bind(c, name='read')
         import :: c_int, c_char, c_size_t
         integer(c_int), value :: descriptor  !< of the file
         character(kind=c_char), intent(out) :: text(*)   !< (length) the bytes
         integer(c_size_t), value :: length   !< bytes at most
      end function c_read
      !> Writes bytes: write(2). The result is the number of bytes written, negative for an error.
      integer(c_size_t) function c_write(descriptor, text, length) bind(c, name='write')
         import :: c_int, c_char, c_size_t
         integer(c_int), value :: descriptor  !< of the file
         character(kind=c_char), intent(in) :: text(*)   !< (length) the bytes
         integer(c_size_t), value :: length   !< bytes at most
      end function c_write
      !> Closes a file: close(2). The result is 0, or -1 for an error.
      integer(c_int) function c_close(descriptor) bind(c, name='close')
         import :: c_int
         integer(c_int), value :: descriptor   !< of the file
      end function c_close
      !> Cuts an open file to a length: ftruncate(2). The result is 0, or -1 for an error.
      integer(c_int) function ftruncate(descriptor, length) bind(c)
         import :: c_int, c_long
         integer(c_int), value :: descriptor  !< of the file
         integer(c_long), value :: length     !< bytes that stay
      end function ftruncate
      !> Tells whether an open file is a terminal: isatty(3). The result is 1 for a terminal, otherwise 0.
      integer(c_int) function isatty(descriptor) bind(c)
         import :: c_int
         integer(c_int), value :: descriptor   !< of the file
      end function isatty
      !> Removes a file: unlink(2). The result is 0, or -1 for an error.
      integer(c_int) function unlink(path) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)   !< (any length) ends with a null
      end function unlink
      !> Gives the address of errno, which C offers as a macro only.
      type(c_ptr) function errno_location() bind(c, name='__errno_location')
         import :: c_ptr
      end function errno_location
      !> Writes the text of an error and a null after it: strerror_r(3) of POSIX. The result is 0 for success.
      integer(c_int) function strerror_r(number, text, length) bind(c, name='__xpg_strerror_r')
         import :: c_int, c_char, c_size_t
         integer(c_int), value :: number      !< of the error
         character(kind=c_char), intent(inout) :: text(*)   !< (length) the text
         integer(c_size_t), value :: length   !< characters at most, with the null
      end function strerror_r
      !> Installs the handler of a signal: signal(2). The result is the previous handler.
      type(c_funptr) function signal(number, handler) bind(c)
         import :: c_int, c_funptr
         integer(c_int), value :: number      !< of the signal
         type(c_funptr), value :: handler     !< null: the usual action
      end function signal
      !> Sends this process a signal: raise(3). The result is 0 for success.
      integer(c_int) function raise(number) bind(c)
         import :: c_int
         integer(c_int), value :: number   !< of the signal
      end function raise
   end interface

contains

   !> Gives the identity of a file. If there is no such file, the result is the default of its type.
   type(identity_t) function identity_of(path) result(id)
      character(*), intent(in) :: path       !< of the file; symbolic links are followed
      type(statx_t) :: facts

      if (statx(from_working_directory, path//c_null_char, 0_c_int, basic_facts, facts) == 0) id = identity_from(facts)
   end function identity_of

   !> Gives the identity of an open file. If the descriptor is not open, the result is the default of its type.
   type(identity_t) function identity_of_open(descriptor) result(id)
      integer(c_int), intent(in) :: descriptor   !< of the file
      type(statx_t) :: facts

      if (statx(descriptor, c_null_char, empty_path, basic_facts, facts) == 0) id = identity_from(facts)
   end function identity_of_open

   !> Takes the identity of a file from the facts of the system.
   pure type(identity_t) function identity_from(facts) result(id)
      type(statx_t), intent(in) :: facts     !< those that `statx` has found

      id%device = facts%device
      id%inode = facts%inode
      id%regular = iand(int(facts%mode), kind_bits) == kind_regular
      id%device_or_pipe = .not. (id%regular .or. iand(int(facts%mode), kind_bits) == kind_directory)
   end function identity_from

   !> Tells whether two identities are of one regular file. A device, pipe or terminal may be used twice without harm.
   elemental logical function same_file(first, second)
      type(identity_t), intent(in) :: first, second   !< the identities of two files

      same_file = first%regular .and. second%regular .and. first%inode == second%inode .and. all(first%device == &
         second%device)
   end function same_file

   !> Opens a file for reading. The result is its descriptor, negative for an error, which `last_error` has.
   integer(c_int) function open_to_read(path)
      character(*), intent(in) :: path   !< of the file

      open_to_read = c_open(path//c_null_char, read_only)
   end function open_to_read

   !> Opens a file for writing and keeps its contents, or creates the file if there is none.
   subroutine open_to_write(path, descriptor, made)
      character(*), intent(in) :: path       !< of the file
      integer(c_int), intent(out) :: descriptor   !< negative for an error, which `last_error` has
      logical, intent(out) :: made           !< the file did not exist
      integer :: error

      descriptor = c_open(path//c_null_char, write_only)
      error = last_error()
      made = .false.
      if (descriptor >= 0 .or. error /= no_such_file) return
      descriptor = creat(path//c_null_char, permissions)
      made = descriptor >= 0
   end subroutine open_to_write

   !> Reads bytes of an open file. The result is the number of bytes read: 0 at the end of the file, negative for an
   !> error, which `last_error` has.
   integer function read_bytes(descriptor, text)
      integer(c_int), intent(in) :: descriptor   !< of an open file
      character(*), intent(out) :: text   !< gets the bytes, at most its length; the rest is undefined

      read_bytes = int(c_read(descriptor, text, len(text, c_size_t)))
   end function read_bytes

   !> Writes a text, or the first part of a text, to an open file. The result is the number of bytes written, negative
   !> for an error, which `last_error` has.
   integer(c_size_t) function write_bytes(descriptor, text)
      integer(c_int), intent(in) :: descriptor   !< of an open file
      character(*), intent(in) :: text   !< the bytes

      write_bytes = c_write(descriptor, text, len(text, c_size_t))
   end function write_bytes

   !> Closes an open file. The result is false if the system reports an error, such as a delayed write error.
   logical function close_descriptor(descriptor)
      integer(c_int), intent(in) :: descriptor   !< of an open file

      close_descriptor = c_close(descriptor) == 0
   end function close_descriptor

   !> Removes a regular file. A symbolic link stays, and the file to which the link leads. Errors are ignored.
   subroutine remove_file(path)
      character(*), intent(in) :: path   !< of the file
      type(statx_t) :: facts
      integer(c_int) :: status

      status = statx(from_working_directory, path//c_null_char, no_links, basic_facts, facts)
      if (iand(int(facts%mode), kind_bits) == kind_regular) status = unlink(path//c_null_char)
   end subroutine remove_file

   !> Opens standard input, output and error for reading /dev/null if they are closed: then no deck is read, and writing
   !> fails. Otherwise the next file would take their descriptors, and printed text would go into that file.
   subroutine occupy_standard_descriptors
      integer(c_int) :: descriptor
      logical :: closed

      do
         ! The system gives the lowest free number.
         descriptor = c_open('/dev/null'//c_null_char, read_only)
         if (descriptor < 0 .or. descriptor > 2) exit
      end do
      if (descriptor > 2) closed = close_descriptor(descriptor)
   end subroutine occupy_standard_descriptors

   !> Gives the system's number of its last error (errno).
   integer function last_error()
      integer(c_int), pointer :: number

      call c_f_pointer(errno_location(), number)
      last_error = number
   end function last_error

   !> Gives the system's text for an error; '' if the system has none.
   function reason_of(error) result(text)
      integer, intent(in) :: error   !< the system's number of the error
      character(:), allocatable :: text
      character(256) :: words
      integer(c_int) :: status

      words = c_null_char
      status = strerror_r(int(error, c_int), words, len(words, c_size_t))
      text = words(:index(words, c_null_char) - 1)
   end function reason_of

   !> Records SIGINT and SIGTERM from now on, unless they were ignored. The limit of file sizes becomes a write error
   !> and is no longer a signal that kills.
   subroutine watch_signals
      type(c_funptr) :: before
      integer :: i

      do i = 1, size(watched)
         before = signal(watched(i), c_funloc(record_signal))
         if (address(before) == ignored) before = signal(watched(i), before)
      end do
      before = signal(signal_file_size, transfer(ignored, c_null_funptr))
      ! If this process inherited that SIGCHLD is ignored, children would leave no exit status.
      before = signal(signal_child, c_null_funptr)
   end subroutine watch_signals

   !> Handles a signal by actions that are safe at any moment: keeps its number, and restores the usual actions unless
   !> all signals are recorded.
   subroutine record_signal(number) bind(c)
      integer(c_int), value :: number   !< of the signal
      type(c_funptr) :: before
      integer :: i

      received = number
      if (notes_all) return
      do i = 1, size(watched)
         before = signal(watched(i), c_null_funptr)
      end do
   end subroutine record_signal

   !> Gives the number of the last signal that was recorded; 0: none.
   integer function signal_received()
      signal_received = received
   end function signal_received

   !> Ends the process by a signal, so that a shell sees the usual status.
   subroutine end_by_signal(number)
      integer, intent(in) :: number   !< of the signal
      type(c_funptr) :: before
      integer(c_int) :: status

      before = signal(int(number, c_int), c_null_funptr)
      status = raise(int(number, c_int))
   end subroutine end_by_signal

   !> Gives the address of a handler as a number.
   pure integer(c_intptr_t) function address(handler)
      type(c_funptr), intent(in) :: handler  !< of a signal; null: the usual action

      address = transfer(handler, 0_c_intptr_t)
   end function address
end module system_calls
