!> The results as comma-separated values with 17 digits: the deck's length unit, radians or degrees as the deck says. A
!> value that does not exist, or of which no digit is known, is empty and `mark` says why; a name with a comma is
!> quoted. A pole or curve has three rows.
module csv
   use kinds, only: wp
   use planar, only: in_degrees
   use mechanism, only: mechanism_t, request_t, request_pole, request_curve
   use motion, only: motion_t, new_motion
   use points, only: row_t, row_of, has_number, is_due
   use assemblies, only: assemblies_t, assembly_t
   use independent, only: request_of
   use motion_proof, only: motion_proof_t
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
      type(row_t) :: row
      real(wp) :: error(3, 0:2)
      logical :: known(3, 0:2), asked
      type(request_t) :: request
      integer :: i

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
            if (has_tolerances(s%parts(c), request)) call add_spreads(spread_in_set(s, i))
            call add_bound(s%parts(c), s%motions(c), s%proofs(c))
            if (present(assemblies) .and. step == 0 .and. c > 0) &
               call add_assemblies(s%parts(c), s%motions(c)%origin, assemblies(c)%list)
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

         call add(o, start)
         call add_name(o, kind(:len_trim(kind)))
         call add(o, ',')
         call add_name(o, row%name(:len_trim(row%name)))
         call add_values(o, row, there .and. known, s%degrees)
         call add(o, ',')
         if (mark == '' .and. any(there .and. .not. known)) then
            call add(o, mark_unknown)
         else
            call add(o, mark(:len_trim(mark)))
         end if
         if (asked) call add_errors(o, row, there, error, s%degrees)
         call put(o, '')
      end subroutine add_row

      !> The three rows of a pole or curve: each has one third of the numbers under x, y, phi.
      subroutine add_centre()
         type(row_t) :: third
         logical :: there(3, 0:2)
         character(12) :: mark
         integer :: k

         there = numbers_of(row)
         do k = 0, 2
            third = row
            third%value(:, 0) = row%value(:, k)
            mark = marks(row%mark)
            if (mark == '' .and. .not. all(there(:, k))) mark = marks_of_centre(row%state)
            call add_row(kinds_of_centre(k, row%kind), third, reshape(there(:, k), [3, 3], [.false.]), &
               reshape(known(:, k), [3, 3], [.false.]), reshape(error(:, k), [3, 3], [0.0_wp]), mark)
         end do
      end subroutine add_centre

      !> What tolerances do to the row, with its sensitivities `x`: its worst case, its root of the sum of squares, and
      !> its sensitivity to each number.
      subroutine add_spreads(x)
         type(spread_t), intent(in) :: x
         integer :: d

         call add_other('WORST', x%known, worst_case(x%tolerances, x%of))
         call add_other('RSS', x%known, root_of_squares(x%tolerances, x%of))
         do d = 1, size(x%tolerances)
            call add_other('PER '//trim(x%tolerances(d)%name), x%known, x%of(:, :, d))
         end do
      end subroutine add_spreads

      !> The bounds of the errors of the row of the mechanism `own` that are proved, if proofs are asked for.
      subroutine add_bound(own, q, proof)
         type(mechanism_t), intent(in) :: own
         type(motion_t), intent(in) :: q
         type(motion_proof_t), intent(in) :: proof

         if (.not. proof%taken) return
         if (proof%is_proved) then
            call add_other('BOUND', row%known, row_bound(own, q, proof%links, request))
         else
            call add_other('BOUND', -1, row%value)
         end if
      end subroutine add_bound

      !> The row of the mechanism `own` in each assembly at the first instant, of which the `list` is; none has errors.
      subroutine add_assemblies(own, origin, list)
         type(mechanism_t), intent(in) :: own
         real(wp), intent(in) :: origin(2)
         type(assembly_t), intent(in) :: list(:)
         type(motion_t) :: q
         type(row_t) :: other
         integer :: number

         q = new_motion(size(own%links))
         q%known = 0
         q%origin = origin
         do number = 1, size(list)
            q%position = list(number)%position
            other = row_of(own, q, request)
            call add_row(trim(kinds_of_row(row%kind))//' ASSEMBLY '//whole(number), other, numbers_of(other), &
               all_known, no_errors, '')
         end do
      end subroutine add_assemblies

      !> What `word` says of the row: values (3, 0:2), as far as they are `known`; they have no errors.
      subroutine add_other(word, known, value)
         character(*), intent(in) :: word
         integer, intent(in) :: known
         real(wp), intent(in) :: value(:, :)
         type(row_t) :: other

         other = row
         other%known = known
         other%value = value
         call add_row(trim(kinds_of_row(row%kind))//' '//word, other, numbers_of(other), all_known, no_errors, &
            marks(row%mark))
      end subroutine add_other
   end subroutine csv_instant

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
