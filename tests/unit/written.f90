!> What a procedure writes to an output, as text.
module written
   use kinds, only: wp
   use failures, only: failure_t
   use text_output, only: output_t, open_output, close_output
   implicit none
   private
   public :: open_text, text_of, taken, count_of, numbers_after

   character(*), parameter :: file = 'unit_test_output.tmp'

contains

   !> An output whose text `text_of` gives.
   subroutine open_text(o)
      type(output_t), intent(out) :: o
      type(failure_t), allocatable :: failure

      call open_output(o, file, failure)
   end subroutine open_text

   !> All that was written to `o`, which is closed.
   function text_of(o) result(text)
      type(output_t), intent(inout) :: o
      character(:), allocatable :: text
      type(failure_t), allocatable :: failure

      call close_output(o, failure)
      text = taken(file)
   end function text_of

   !> The bytes of the file `path`, which is deleted; '' where there is none.
   function taken(path) result(text)
      character(*), intent(in) :: path
      character(:), allocatable :: text
      integer :: unit, length
      logical :: exists

      text = ''
      inquire (file=path, exist=exists)
      if (.not. exists) return
      open (newunit=unit, file=path, access='stream', form='unformatted', status='old')
      inquire (unit=unit, size=length)
      deallocate (text)
      allocate (character(length) :: text)
      if (length > 0) read (unit) text
      close (unit, status='delete')
   end function taken

   !> How often `part` stands in `text`.
   pure integer function count_of(text, part)
      character(*), intent(in) :: text, part
      integer :: i

      count_of = count([(text(i:i + len(part) - 1) == part, i=1, len(text) - len(part) + 1)])
   end function count_of

   !> The first `n` numbers behind the first `part` of `text`, up to the end of its attribute: a comma, semicolon or blank between two.
   function numbers_after(text, part, n) result(numbers)
      character(*), intent(in) :: text, part
      integer, intent(in) :: n
      real(wp) :: numbers(n)
      character(:), allocatable :: list
      integer :: first, i

      first = index(text, part) + len(part)
      list = text(first:first + index(text(first:), '"') - 2)
      do i = 1, len(list)
         if (index(',;', list(i:i)) > 0) list(i:i) = ' '
      end do
      read (list, *) numbers
   end function numbers_after
end module written
