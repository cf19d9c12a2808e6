!> Tests. A line of the CSV as its cells. Nothing of the program is used: the reader of listings stands on it too.
module csv_cells
   implicit none
   private
   public :: cells, cell_length, split, whole_text, blame

   integer, parameter :: cells = 15, cell_length = 48

contains

   !> The cells of a line, a name in quotes without them; `n`: how many, one more than fit where there are more.
   pure subroutine split(line, cell, n)
      character(*), intent(in) :: line
      character(*), intent(out) :: cell(:)
      integer, intent(out) :: n
      integer :: i, length
      logical :: quoted

      cell = ''
      n = 1
      length = 0
      quoted = .false.
      do i = 1, len_trim(line)
         if (line(i:i) == '"') then
            quoted = .not. quoted
            ! The second of two quotes inside stands for itself.
            if (.not. quoted .or. i == 1) cycle
            if (line(i - 1:i - 1) /= '"') cycle
         else if (line(i:i) == ',' .and. .not. quoted) then
            n = n + 1
            length = 0
            if (n > size(cell)) return
            cycle
         end if
         length = min(length + 1, len(cell))
         cell(n)(length:length) = line(i:i)
      end do
   end subroutine split

   !> The first thing that is wrong is kept.
   subroutine blame(wrong, text)
      character(:), allocatable, intent(inout) :: wrong
      character(*), intent(in) :: text

      if (.not. allocated(wrong)) wrong = text
   end subroutine blame

   !> `i` as text.
   pure function whole_text(i) result(text)
      integer, intent(in) :: i
      character(:), allocatable :: text
      character(12) :: buffer

      write (buffer, '(i0)') i
      text = trim(buffer)
   end function whole_text
end module csv_cells
