!> The results as comma-separated values with 17 digits: the deck's length unit, radians or degrees as the deck says. A
!> value that does not exist, or of which no digit is known, is empty and `mark` says why; a name with a comma is
!> quoted. A pole or curve has three rows.
module csv
   use kinds, only: wp
   use planar, only: in_degrees
   use mechanism, only: request_t, request_pole, request_curve
   use motion, only: motion_t, new_motion
   use points, only: row_t, row_of, has_number, is_due
   use assemblies, only: assemblies_t
   use independent, only: request_of
   use instant_centres, only: centre_finite, centre_resting
   use known_digits, only: nothing_known
   use sensitivities, only: has_tolerances, worst_case, root_of_squares
   use link_bounds, only: row_bound
   use set_motion, only: set_motion_t, find_row_in_set, known_numbers, error_in_set, spread_t, spread_in_set
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
   !> The mark where nothing is missing but known digits.
   character(*), parameter :: mark_unknown = 'UNKNOWN'
   logical, parameter :: all_known(3, 0:2) = .true.
   !> Why a centre has no place, by its state.
   character(8), parameter :: marks_of_centre(centre_finite:centre_resting) = [character(8) :: &
      '', 'INFINITE', 'AT-REST', 'AT-REST']
   !> Of a row whose errors are not known.
   real(wp), parameter :: no_errors(3, 0:2) = nothing_known

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

   !> The rows of instant number `step` (0, 1, ...) of the motions `s` that the deck asks for there, with their
   !> errors where these are asked for. `varies`: as in the head. `assemblies` (parts), where they are asked for: those
   !> of the first instant.
   subroutine csv_instant(o, s, step, varies, assemblies)
      type(output_t), intent(inout) :: o
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: step
      logical, intent(in), optional :: varies
      type(assemblies_t), intent(in), optional :: assemblies(:)
      character(:), allocatable :: start
      type(row_t) :: row, other
      type(request_t) :: request
      type(spread_t) :: spread
      type(motion_t) :: q
      real(wp) :: error(3, 0:2)
      logical :: known(3, 0:2), asked
      integer :: i, k

      start = whole(s%set_number)//','
      if (present(varies)) then
         if (varies) start = start//whole(s%variant)//','
      end if
      start = start//whole(step)//','//full(s%motions(1)%t)//','
      asked = s%errors(1)%asked
      error = 0.0_wp
      do i = 1, size(s%rows)
         request = request_of(s, i)
         if (.not. is_due(s, request, step)) cycle
         call find_row_in_set(s, i, row)
         known = known_numbers(row, s, i)
         if (asked) error = error_in_set(s, i)
         if (row%kind >= request_pole) then
            call add_centre()
            cycle
         end if
         call add_row(kinds_of_row(row%kind), row, numbers_of(row), known, error, marks(row%mark))

         associate (c => s%rows(i)%part)
            other = row
            ! What tolerances do to the row.
            if (has_tolerances(s%parts(c), request)) then
               spread = spread_in_set(s, i)
               other%known = spread%known
               other%value = worst_case(spread%tolerances, spread%of)
               call add_other('WORST')
               other%value = root_of_squares(spread%tolerances, spread%of)
               call add_other('RSS')
               do k = 1, size(spread%tolerances)
                  other%value = spread%of(:, :, k)
                  call add_other('PER '//trim(spread%tolerances(k)%name))
               end do
            end if
            ! The bounds of its errors that are proved, if proofs are asked for.
            if (s%proofs(c)%taken) then
               other%known = merge(row%known, -1, s%proofs(c)%is_proved)
               if (s%proofs(c)%is_proved) &
                  other%value = row_bound(s%parts(c), s%motions(c), s%proofs(c)%links, request)
               call add_other('BOUND')
            end if
            ! The row in each assembly at the first instant.
            if (.not. present(assemblies) .or. step > 0 .or. c == 0) cycle
            q = new_motion(size(s%parts(c)%links))
            q%known = 0
            q%origin = s%motions(c)%origin
            do k = 1, size(assemblies(c)%list)
               q%position = assemblies(c)%list(k)%position
               other = row_of(s%parts(c), q, request)
               call add_other('ASSEMBLY '//whole(k))
            end do
         end associate
      end do

   contains

      !> A row: its `kind` and name, the values (3, 0:2) that are `there` and `known`, its `mark`; where asked, the
      !> errors of those that are there.
      subroutine add_row(kind, row, there, known, error, mark)
         character(*), intent(in) :: kind, mark
         type(row_t), intent(in) :: row
         logical, intent(in) :: there(3, 0:2), known(3, 0:2)
         real(wp), intent(in) :: error(3, 0:2)
         logical :: has_error(3, 0:2)
         integer :: k

         call add(o, start)
         call add_name(o, kind(:len_trim(kind)))
         call add(o, ',')
         call add_name(o, row%name(:len_trim(row%name)))
         call add_values(row%value, row%angular, there .and. known)
         call add(o, ',')
         if (mark == '' .and. any(there .and. .not. known)) then
            call add(o, mark_unknown)
         else
            call add(o, mark(:len_trim(mark)))
         end if
         if (asked) then
            ! A derivative has no error where no digit of the one before is known.
            has_error = there
            do k = 0, 2
               if (any(has_error(:, k) .and. error(:, k) >= nothing_known)) has_error(:, k:) = .false.
            end do
            call add_values(error, row%angular, has_error)
         end if
         call put(o, '')
      end subroutine add_row

      !> Nine values (3, 0:2), a comma before each; empty where they are not `there`. `angular`: all of them are angles.
      subroutine add_values(value, angular, there)
         real(wp), intent(in) :: value(3, 0:2)
         logical, intent(in) :: angular, there(3, 0:2)
         character(9*(full_length + 1)) :: cells
         real(wp) :: x
         integer :: k, c, used, length

         used = 0
         do k = 0, 2
            do c = 1, 3
               used = used + 1
               cells(used:used) = ','
               if (there(c, k)) then
                  x = value(c, k)
                  if (s%degrees .and. (c == 3 .or. angular)) x = in_degrees(x)
                  call put_full(x, cells(used + 1:used + full_length), length)
                  used = used + length
               end if
            end do
         end do
         call add(o, cells(:used))
      end subroutine add_values

      !> The three rows of a pole or curve: each has one third of the numbers under x, y, phi.
      subroutine add_centre()
         logical :: there(3, 0:2)
         character(12) :: mark
         integer :: k

         there = numbers_of(row)
         other = row
         do k = 0, 2
            other%value(:, 0) = row%value(:, k)
            mark = marks(row%mark)
            if (mark == '' .and. .not. all(there(:, k))) mark = marks_of_centre(row%state)
            call add_row(kinds_of_centre(k, row%kind), other, reshape(there(:, k), [3, 3], [.false.]), &
               reshape(known(:, k), [3, 3], [.false.]), reshape(error(:, k), [3, 3], [0.0_wp]), mark)
         end do
      end subroutine add_centre

      !> The row `other`, which is what `word` says of the row; it has no errors.
      subroutine add_other(word)
         character(*), intent(in) :: word

         call add_row(trim(kinds_of_row(row%kind))//' '//word, other, numbers_of(other), all_known, no_errors, &
            marks(other%mark))
      end subroutine add_other
   end subroutine csv_instant

   !> Which of its numbers (3, 0:2) `row` has.
   pure function numbers_of(row) result(there)
      type(row_t), intent(in) :: row
      logical :: there(3, 0:2)
      integer :: c, k

      there = reshape([((has_number(row, c, k), c=1, 3), k=0, 2)], [3, 3])
   end function numbers_of

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
