!> The results as comma-separated values with 17 digits: the deck's length unit, radians or degrees
!> as the deck says. A value that does not exist is empty and `mark` says why; a name with a comma is quoted. A pole or
!> curve has three rows.
module csv
   use kinds, only: wp
   use constants, only: in_degrees
   use mechanism, only: mechanism_t, request_t, request_pole, request_curve
   use motion, only: motion_t
   use points, only: row_t, row_of, has_number, is_due
   use instant_centres, only: centre_finite, centre_resting
   use known_digits, only: nothing_known
   use error_estimate, only: error_estimate_t, row_error
   use sensitivities, only: has_tolerances, ground_sensitivities, worst_case, root_of_squares
   use link_bounds, only: row_bound
   use set_motion, only: set_motion_t, row_in_set
   use text_output, only: output_t, put, add
   use numerals, only: whole, full, put_full, full_length
   implicit none
   private
   public :: csv_head, csv_instant, add_name, marks

   character(12), parameter :: marks(0:4) = [character(12) :: '', 'NO-POSITION', 'NO-RATES', 'TOO-LARGE', 'OPEN']
   character(5), parameter :: kinds_of_row(3) = ['LINK ', 'POINT', 'PAIR ']
   !> The three rows of a pole: in the fixed plane, and in the axes of both links; of a curve.
   character(6), parameter :: kinds_of_centre(0:2, request_pole:request_curve) = reshape([character(6) :: &
      'POLE', 'POLE-I', 'POLE-J', 'CURVE', 'CENTRE', 'RADIUS'], [3, 2])
   !> Why a centre has no place, by its state.
   character(8), parameter :: marks_of_centre(centre_finite:centre_resting) = [character(8) :: &
      '', 'INFINITE', 'AT-REST', 'AT-REST']

contains

   !> The names of the columns; with `errors`, those of the error estimates after them; where a set of the deck
   !> `varies`, the number of the variant behind that of the set.
   subroutine csv_head(o, errors, varies)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: errors
      logical, intent(in), optional :: varies

      call add(o, 'set,')
      if (present(varies)) call add(o, trim(merge('variant,', '        ', varies)))
      call add(o, 'step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark')
      if (errors) call add(o, ',ex,ey,ephi,evx,evy,evphi,eax,eay,eaphi')
      call put(o, '')
   end subroutine csv_head

   !> The rows of instant number `step` (0, 1, ...) of the motions `s` of `m` that the deck asks for there, with their
   !> errors where these are asked for. `varies`: as in the head.
   subroutine csv_instant(o, m, s, step, varies)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: step
      logical, intent(in), optional :: varies
      character(:), allocatable :: start
      integer :: i, c

      start = whole(m%set_number)//','
      if (present(varies)) then
         if (varies) start = start//whole(m%variant)//','
      end if
      start = start//whole(step)//','//full(s%motions(1)%t)//','
      do i = 1, size(m%requests)
         if (.not. is_due(m, m%requests(i), step)) cycle
         c = s%parts%part(i)
         if (c > 0) then
            call add_row(o, start, s%own(c), s%motions(c), s%own(c)%requests(s%parts%number(i)), s%errors(c))
         else
            ! A row of the ground is known by the deck alone.
            call add_row(o, start, m, s%motions(1), m%requests(i), error_estimate_t(asked=s%errors(1)%asked))
         end if
         if (has_tolerances(m, m%requests(i))) call add_tolerances(o, start, m, s, i)
         if (c > 0 .and. m%requests(i)%kind < request_pole) call add_bound(o, start, m, s, i)
      end do
   end subroutine csv_instant

   !> The row that `request` asks for, or its three rows, each with the cells `start` before it.
   subroutine add_row(o, start, m, q, request, errors)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: start
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(error_estimate_t), intent(in) :: errors
      type(row_t) :: row
      real(wp) :: error(3, 0:2)
      logical :: there(3, 0:2)

      row = row_of(m, q, request)
      there = numbers_of(row)
      error = 0.0_wp
      if (errors%asked) error = row_error(m, errors, q, request)
      if (row%kind < request_pole) then
         call add(o, start)
         call add_cells(o, kinds_of_row(row%kind), row, there, errors%asked, error, m%degrees, marks(row%mark))
      else
         call add_centre(o, start, row, there, errors%asked, error, m%degrees)
      end if
   end subroutine add_row

   !> Which of its numbers (3, 0:2) `row` has.
   pure function numbers_of(row) result(there)
      type(row_t), intent(in) :: row
      logical :: there(3, 0:2)
      integer :: c, k

      do k = 0, 2
         do c = 1, 3
            there(c, k) = has_number(row, c, k)
         end do
      end do
   end function numbers_of

   !> What tolerances do to the row of request number `i`: its worst case, its root of the sum of squares, and its
   !> sensitivity to each number. `start`: the cells before the kind.
   subroutine add_tolerances(o, start, m, s, i)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: start
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      type(row_t) :: row
      integer :: c

      c = s%parts%part(i)
      row = row_in_set(m, s, i)
      if (c == 0) then
         call add_sensitivities(o, start, m, row, ground_sensitivities(m, m%requests(i)), s%errors(1)%asked)
      else
         associate (k => s%parts%number(i), found => s%sensitivities(c))
            row%known = found%known(k)
            call add_sensitivities(o, start, s%own(c), row, found%of(:, :, :, k), s%errors(c)%asked)
         end associate
      end if
   end subroutine add_tolerances

   !> The same of `row` with the sensitivities `s` (3, 0:2, numbers) of `m`. `asked`: errors have columns, which stay
   !> empty.
   subroutine add_sensitivities(o, start, m, row, s, asked)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: start
      type(mechanism_t), intent(in) :: m
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: s(:, 0:, :)
      logical, intent(in) :: asked
      integer :: d

      call add_one('WORST', worst_case(m, s))
      call add_one('RSS', root_of_squares(m, s))
      do d = 1, size(m%tolerances)
         call add_one('PER '//trim(m%tolerances(d)%name), s(:, :, d))
      end do

   contains

      !> The row of what `word` says, with its values (3, 0:2).
      subroutine add_one(word, value)
         character(*), intent(in) :: word
         real(wp), intent(in) :: value(:, :)
         type(row_t) :: one

         one = row
         one%value = value
         call add(o, start)
         call add_cells(o, trim(kinds_of_row(row%kind))//' '//word, one, numbers_of(one), asked, &
            spread(spread(nothing_known, 1, 3), 2, 3), m%degrees, marks(row%mark))
      end subroutine add_one
   end subroutine add_sensitivities

   !> The bounds of the errors of the row of request number `i` that are proved, if proofs are asked for.
   subroutine add_bound(o, start, m, s, i)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: start
      type(mechanism_t), intent(in) :: m
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: i
      type(row_t) :: row

      associate (c => s%parts%part(i))
         associate (own => s%own(c), proof => s%proofs(c), request => s%own(c)%requests(s%parts%number(i)))
            if (.not. proof%taken) return
            row = row_of(own, s%motions(c), request)
            if (.not. proof%is_proved) row%known = -1
            if (proof%is_proved) row%value = row_bound(own, s%motions(c), proof%links, request)
            call add(o, start)
            call add_cells(o, trim(kinds_of_row(row%kind))//' BOUND', row, numbers_of(row), s%errors(c)%asked, &
               spread(spread(nothing_known, 1, 3), 2, 3), m%degrees, marks(row%mark))
         end associate
      end associate
   end subroutine add_bound

   !> The three rows of a pole or curve: each has one third of the numbers under x, y, phi.
   subroutine add_centre(o, start, row, there, asked, error, degrees)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: start
      type(row_t), intent(in) :: row
      logical, intent(in) :: there(3, 0:2), asked, degrees
      real(wp), intent(in) :: error(3, 0:2)
      type(row_t) :: third
      character(12) :: mark
      integer :: k

      do k = 0, 2
         third = row
         third%value(:, 0) = row%value(:, k)
         mark = marks(row%mark)
         if (mark == '' .and. .not. all(there(:, k))) mark = marks_of_centre(row%state)
         call add(o, start)
         call add_cells(o, kinds_of_centre(k, row%kind), third, reshape(there(:, k), [3, 3], [.false.]), asked, &
            reshape(error(:, k), [3, 3], [0.0_wp]), degrees, mark)
      end do
   end subroutine add_centre

   !> The cells of a row from its `kind` on: its name, the values that are `there` (3, 0:2), its `mark`; their errors
   !> (3, 0:2) where `asked`.
   subroutine add_cells(o, kind, row, there, asked, error, degrees, mark)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: kind, mark
      type(row_t), intent(in) :: row
      logical, intent(in) :: there(3, 0:2), asked, degrees
      real(wp), intent(in) :: error(3, 0:2)

      call add_name(o, kind(:len_trim(kind)))
      call add(o, ',')
      call add_name(o, row%name(:len_trim(row%name)))
      call add_values(o, row, there, degrees)
      call add(o, ',')
      call add(o, mark(:len_trim(mark)))
      if (asked) call add_errors(o, row, there, error, degrees)
      call put(o, '')
   end subroutine add_cells

   !> Nine values, a comma before each; empty where they are not `there` (3, 0:2).
   subroutine add_values(o, row, there, degrees)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: row
      logical, intent(in) :: there(3, 0:2), degrees
      character(9*(full_length + 1)) :: cells
      real(wp) :: value
      integer :: k, c, used, length

      used = 0
      do k = 0, 2
         do c = 1, 3
            used = used + 1
            cells(used:used) = ','
            if (there(c, k)) then
               value = row%value(c, k)
               if (degrees .and. (c == 3 .or. row%angular)) value = in_degrees(value)
               call put_full(value, cells(used + 1:used + full_length), length)
               used = used + length
            end if
         end do
      end do
      call add(o, cells(:used))
   end subroutine add_values

   !> The nine errors (3, 0:2) of `row`, those of numbers that are `there` (3, 0:2); empty too where no digit is known.
   subroutine add_errors(o, row, there, error, degrees)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: row
      logical, intent(in) :: there(3, 0:2), degrees
      real(wp), intent(in) :: error(3, 0:2)
      type(row_t) :: errors
      logical :: known(3, 0:2)
      integer :: k

      errors = row
      errors%value = error
      known = there
      do k = 0, 2
         if (any(known(:, k) .and. error(:, k) >= nothing_known)) known(:, k:) = .false.
      end do
      call add_values(o, errors, known, degrees)
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
end module csv
