!> Level 5. The results as comma-separated values with 17 digits: the deck's length unit, radians or degrees
!> as the deck says. A value that does not exist is empty and `mark` says why; a name with a comma is quoted.
module csv
   use kinds, only: wp
   use constants, only: degree
   use mechanism, only: mechanism_t, request_link, request_point
   use motion, only: motion_t
   use points, only: row_t, row_of, is_due
   use text_output, only: output_t, put, add
   use numerals, only: whole, full, put_full, full_length
   implicit none
   private
   public :: csv_head, csv_instant

   character(12), parameter :: marks(0:4) = [character(12) :: '', 'NO-POSITION', 'NO-RATES', 'TOO-LARGE', 'OPEN']
   character(5), parameter :: kinds_of_row(3) = ['LINK ', 'POINT', 'PAIR ']

contains

   !> The names of the columns.
   subroutine csv_head(o)
      type(output_t), intent(inout) :: o

      call put(o, 'set,step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark')
   end subroutine csv_head

   !> The rows of instant number `step` (0, 1, ...) that the deck asks for there.
   subroutine csv_instant(o, m, q, step)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: step
      character(:), allocatable :: start
      integer :: i

      start = whole(m%set_number)//','//whole(step)//','//full(q%t)//','
      do i = 1, size(m%requests)
         if (.not. is_due(m, m%requests(i), step)) cycle
         call add(o, start)
         call add_cells(o, row_of(m, q, m%requests(i)), q%known, m%degrees)
         call put(o, marks(q%mark)(:len_trim(marks(q%mark))))
      end do
   end subroutine csv_instant

   !> Kind, name and nine values, a comma after each.
   subroutine add_cells(o, row, known, degrees)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: row
      integer, intent(in) :: known
      logical, intent(in) :: degrees
      character(9*(full_length + 1)) :: cells
      real(wp) :: unit
      integer :: k, c, used, length

      call add(o, kinds_of_row(row%kind)(:len_trim(kinds_of_row(row%kind))))
      call add(o, ',')
      call add_name(o, row%name(:len_trim(row%name)))
      used = 0
      do k = 0, 2
         do c = 1, 3
            if (k <= known .and. has_column(row%kind, c)) then
               unit = merge(degree, 1.0_wp, degrees .and. (c == 3 .or. row%angular))
               call put_full(row%value(c, k)/unit, cells(used + 1:used + full_length), length)
               used = used + length
            end if
            used = used + 1
            cells(used:used) = ','
         end do
      end do
      call add(o, ',')
      call add(o, cells(:used))
   end subroutine add_cells

   !> A name as a cell: in quotes where it holds a comma or a quote.
   subroutine add_name(o, name)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: name
      integer :: i

      if (scan(name, ',"') == 0) then
         call add(o, name)
         return
      end if
      call add(o, '"')
      do i = 1, len(name)
         if (name(i:i) == '"') call add(o, '"')
         call add(o, name(i:i))
      end do
      call add(o, '"')
   end subroutine add_name

   pure logical function has_column(kind, c)
      integer, intent(in) :: kind, c

      has_column = kind == request_link .or. c == 1 .or. (kind == request_point .and. c == 2)
   end function has_column
end module csv
