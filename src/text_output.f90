!> Level 2. Lines to a file or to standard output, in large blocks; a full disk is noticed, never a crash.
module text_output
   use, intrinsic :: iso_fortran_env, only: output_unit
   use failures, only: failure_t, fail, status_machine
   implicit none
   private
   public :: output_t, open_output, put, close_output

   integer, parameter :: block_length = 65536

   !> An open text. A failed write is remembered and told by `close_output`; what follows it is dropped.
   type :: output_t
      integer :: unit = output_unit
      character(:), allocatable :: path      !< '' for standard output
      character(:), allocatable :: buffer    !< (block_length)
      integer :: used = 0
      logical :: failed = .false.
   end type output_t

contains

   !> Opens `path` for writing in the place of what it held; '' is standard output.
   subroutine open_output(o, path, failure)
      type(output_t), intent(out) :: o
      character(*), intent(in) :: path
      type(failure_t), allocatable, intent(out) :: failure
      integer :: iostat

      o%path = path
      allocate (character(block_length) :: o%buffer)
      if (len(path) == 0) return
      open (newunit=o%unit, file=path, status='replace', action='write', iostat=iostat)
      if (iostat /= 0) call fail(failure, status_machine, 'FILE '//path//' CANNOT BE OPENED FOR WRITING')
   end subroutine open_output

   !> Appends one line.
   subroutine put(o, line)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: line

      if (o%used + len(line) + 1 > block_length) call write_block(o)
      if (len(line) >= block_length) then
         if (.not. o%failed) call write_text(o, line)
         return
      end if
      o%buffer(o%used + 1:o%used + len(line)) = line
      o%used = o%used + len(line) + 1
      o%buffer(o%used:o%used) = new_line('a')
   end subroutine put

   !> Writes what is left and closes; `failure` tells of any line that could not be written.
   subroutine close_output(o, failure)
      type(output_t), intent(inout) :: o
      type(failure_t), allocatable, intent(out) :: failure
      integer :: iostat

      call write_block(o)
      if (len(o%path) > 0) then
         close (o%unit, iostat=iostat)
         o%failed = o%failed .or. iostat /= 0
      end if
      if (.not. o%failed) return
      if (len(o%path) == 0) o%path = 'STANDARD OUTPUT'
      call fail(failure, status_machine, 'WRITING '//o%path//' FAILED: NO SPACE LEFT, OR NO PERMISSION')
   end subroutine close_output

   subroutine write_block(o)
      type(output_t), intent(inout) :: o

      ! The record's own end is the newline of the last line.
      if (o%used > 0 .and. .not. o%failed) call write_text(o, o%buffer(:o%used - 1))
      o%used = 0
   end subroutine write_block

   subroutine write_text(o, text)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: text
      integer :: iostat

      write (o%unit, '(a)', iostat=iostat) text
      o%failed = o%failed .or. iostat /= 0
      flush (o%unit, iostat=iostat)
      o%failed = o%failed .or. iostat /= 0
   end subroutine write_text
end module text_output
