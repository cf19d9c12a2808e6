!> Level 2. Lines to a file or to standard output, in large blocks; a full disk is noticed, never a crash.
!>
!> The system's own creat, write and close are called: the Fortran run-time library of GNU reports no error of
!> a full disk, neither from WRITE nor from FLUSH nor from CLOSE.
module text_output
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_char, c_null_char
   use failures, only: failure_t, fail, status_machine
   implicit none
   private
   public :: output_t, open_output, put, add, close_output

   integer, parameter :: block_length = 65536
   integer(c_int), parameter :: standard_output = 1
   !> Read and write for all, less the user's mask.
   integer(c_int), parameter :: permissions = int(o'666', c_int)

   !> An open text. A failed write is remembered and told by `close_output`; what follows it is dropped.
   type :: output_t
      integer(c_int) :: descriptor = standard_output
      character(:), allocatable :: path      !< '' for standard output
      character(:), allocatable :: buffer    !< (block_length)
      integer :: used = 0
      logical :: failed = .false.
   end type output_t

   interface
      integer(c_int) function creat(path, mode) bind(c)
         import :: c_int, c_char
         character(kind=c_char), intent(in) :: path(*)
         integer(c_int), value :: mode
      end function creat
      integer(c_size_t) function c_write(descriptor, text, length) bind(c, name='write')
         import :: c_int, c_char, c_size_t
         integer(c_int), value :: descriptor
         character(kind=c_char), intent(in) :: text(*)
         integer(c_size_t), value :: length
      end function c_write
      integer(c_int) function c_close(descriptor) bind(c, name='close')
         import :: c_int
         integer(c_int), value :: descriptor
      end function c_close
   end interface

contains

   !> Opens `path` for writing in the place of what it held; '' is standard output.
   subroutine open_output(o, path, failure)
      type(output_t), intent(out) :: o
      character(*), intent(in) :: path
      type(failure_t), allocatable, intent(out) :: failure

      o%path = path
      allocate (character(block_length) :: o%buffer)
      if (len(path) == 0) return
      o%descriptor = creat(path//c_null_char, permissions)
      if (o%descriptor < 0) call fail(failure, status_machine, 'FILE '//path//' CANNOT BE OPENED FOR WRITING')
   end subroutine open_output

   !> Appends one line, or the rest of one that `add` began.
   subroutine put(o, line)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: line

      if (len(line) >= block_length - o%used) then
         call add(o, line)
         call add(o, new_line('a'))
         return
      end if
      o%buffer(o%used + 1:o%used + len(line)) = line
      o%used = o%used + len(line) + 1
      o%buffer(o%used:o%used) = new_line('a')
   end subroutine put

   !> Appends a part of a line.
   subroutine add(o, text)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: text

      if (len(text) > block_length - o%used) call write_block(o)
      if (len(text) > block_length) then
         call write_text(o, text)
         return
      end if
      o%buffer(o%used + 1:o%used + len(text)) = text
      o%used = o%used + len(text)
   end subroutine add

   !> Writes what is left and closes; `failure` tells of any line that could not be written.
   subroutine close_output(o, failure)
      type(output_t), intent(inout) :: o
      type(failure_t), allocatable, intent(out) :: failure

      call write_block(o)
      if (len(o%path) > 0) then
         if (c_close(o%descriptor) /= 0) o%failed = .true.
      else
         o%path = 'STANDARD OUTPUT'
      end if
      if (.not. o%failed) return
      call fail(failure, status_machine, 'WRITING '//o%path//' FAILED: NO SPACE LEFT, OR NO PERMISSION')
   end subroutine close_output

   subroutine write_block(o)
      type(output_t), intent(inout) :: o

      call write_text(o, o%buffer(:o%used))
      o%used = 0
   end subroutine write_block

   !> Writes all of `text`, in as many pieces as the system wants it.
   subroutine write_text(o, text)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: text
      integer(c_size_t) :: written, done

      done = 0
      do while (done < len(text) .and. .not. o%failed)
         written = c_write(o%descriptor, text(done + 1:), len(text, c_size_t) - done)
         ! The system returns -1 for an error.
         o%failed = written <= 0
         done = done + written
      end do
   end subroutine write_text
end module text_output
