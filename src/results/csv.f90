!> The results as comma-separated values with 17 digits: the deck's length unit, radians or degrees
!> as the deck says. A value that does not exist is empty and `mark` says why; a name with a comma is quoted.
module csv
   use kinds, only: wp
   use constants, only: in_degrees
   use mechanism, only: mechanism_t, request_t, request_link, request_point
   use motion, only: motion_t
   use points, only: row_t, row_of, is_due
   use known_digits, only: nothing_known
   use error_estimate, only: error_estimate_t, row_error
   use set_motion, only: set_motion_t
   use text_output, only: output_t, put, add
   use numerals, only: whole, full, put_full, full_length
   implicit none
   private
   public :: csv_head, csv_instant, add_name

   character(12), parameter :: marks(0:4) = [character(12) :: '', 'NO-POSITION', 'NO-RATES', 'TOO-LARGE', 'OPEN']
   character(5), parameter :: kinds_of_row(3) = ['LINK ', 'POINT', 'PAIR ']

contains

   !> The names of the columns; with `errors`, those of the error estimates after them.
   subroutine csv_head(o, errors)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: errors

      call add(o, 'set,step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark')
      if (errors) call add(o, ',ex,ey,ephi,evx,evy,evphi,eax,eay,eaphi')
      call put(o, '')
   end subroutine csv_head

   !> The rows of instant number `step` (0, 1, ...) of the motions `s` of `m` that the deck asks for there, with their
   !> errors where these are asked for.
   subroutine csv_instant(o, m, s, step)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: step
      character(:), allocatable :: start
      integer :: i, c

      start = whole(m%set_number)//','//whole(step)//','//full(s%motions(1)%t)//','
      do i = 1, size(m%requests)
         if (.not. is_due(m, m%requests(i), step)) cycle
         call add(o, start)
         c = s%parts%part(i)
         if (c > 0) then
            call add_row(o, s%own(c), s%motions(c), s%own(c)%requests(s%parts%number(i)), s%errors(c))
         else
            ! A row of the ground is known by the deck alone.
            call add_row(o, m, s%motions(1), m%requests(i), error_estimate_t(asked=s%errors(1)%asked))
         end if
      end do
   end subroutine csv_instant

   !> The cells of one row from its kind on.
   subroutine add_row(o, m, q, request, errors)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(error_estimate_t), intent(in) :: errors
      type(row_t) :: row

      row = row_of(m, q, request)
      call add(o, kinds_of_row(row%kind)(:len_trim(kinds_of_row(row%kind))))
      call add(o, ',')
      call add_name(o, row%name(:len_trim(row%name)))
      call add_values(o, row, m%degrees)
      call add(o, ',')
      call add(o, marks(row%mark)(:len_trim(marks(row%mark))))
      if (errors%asked) call add_errors(o, row, row_error(m, errors, q, request), m%degrees)
      call put(o, '')
   end subroutine add_row

   !> Nine values, a comma before each; empty where they are not known or the row has none.
   subroutine add_values(o, row, degrees)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: row
      logical, intent(in) :: degrees
      character(9*(full_length + 1)) :: cells
      real(wp) :: value
      integer :: k, c, used, length

      used = 0
      do k = 0, 2
         do c = 1, 3
            used = used + 1
            cells(used:used) = ','
            if (k <= row%known .and. has_column(row%kind, c)) then
               value = row%value(c, k)
               if (degrees .and. (c == 3 .or. row%angular)) value = in_degrees(value)
               call put_full(value, cells(used + 1:used + full_length), length)
               used = used + length
            end if
         end do
      end do
      call add(o, cells(:used))
   end subroutine add_values

   !> The nine errors (3, 0:2) of `row`, those of numbers that exist; empty too where no digit is known.
   subroutine add_errors(o, row, error, degrees)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: error(3, 0:2)
      logical, intent(in) :: degrees
      type(row_t) :: errors
      integer :: k

      errors = row
      errors%value = error
      errors%known = -1
      do k = 0, row%known
         if (any(error(:, k) >= nothing_known)) exit
         errors%known = k
      end do
      call add_values(o, errors, degrees)
   end subroutine add_errors

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

   !> Rows of the given `kind` have a column number `c` (x, y, phi) of each derivative.
   pure logical function has_column(kind, c)
      integer, intent(in) :: kind, c

      has_column = kind == request_link .or. c == 1 .or. (kind == request_point .and. c == 2)
   end function has_column
end module csv
