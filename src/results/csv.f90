!> The results as comma-separated values with 17 digits: the deck's length unit, radians or degrees as the deck says. A
!> value that does not exist, or of which no digit is known, is empty and `mark` says why; a name with a comma is
!> quoted. A pole or curve has three rows.
!>
!> The results as a table (--table): a row for each instant at which PRINT asks for anything, a column for each
!> quantity; time first, then the drives, then all positions, velocities and accelerations that PRINT asks for, with
!> all digits.
!>
!> Each row has all columns: NaN stands for a value that does not exist or has no known digit. pandas, R and gnuplot
!> read NaN as a missing value. Commas alone separate the cells, and gnuplot is given its separator. The units are those
!> of the deck. Rejected: a blank behind each comma, for gnuplot's default: pandas takes a column with ' NaN' for text.
module csv
   use kinds, only: wp, label_length
   use planar, only: in_degrees
   use mechanism, only: request_t, request_link, request_point, request_pair, request_pole, &
      request_curve, pair_prismatic
   use scales, only: is_length
   use drives, only: drive_motion
   use motion, only: motion_t, new_motion
   use points, only: row_t, find_row, has_number, is_due, coordinates_of
   use assemblies, only: assemblies_t
   use independent, only: set_t, request_of
   use instant_centres, only: centre_finite, centre_resting
   use name_table, only: name_table_t, put_name, find_name
   use names, only: drive_name, subject_name
   use known_digits, only: nothing_known
   use sensitivities, only: has_tolerances, worst_case, root_of_squares
   use set_motion, only: set_motion_t, find_row_in_set, known_numbers, error_in_set, spread_t, spread_in_set
   use text_output, only: output_t, put, add, replaced
   use numerals, only: whole, full, put_full, full_length
   implicit none
   private
   public :: csv_head, csv_instant, add_name, marks
   public :: table_t, new_table, table_head, table_instant, drive_columns, dotted

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

   !> Characters of the name of a drive's column: RELANGLE.A.B, with a number of up to seven digits.
   integer, parameter :: drive_length = 3*label_length + 10
   !> In the place of a value that does not exist or has no known digit.
   character(*), parameter :: missing = 'NaN'

   !> A column after those of time and drives.
   type :: table_column_t
      integer :: request = 0                        !< its number among those of the set
      integer :: order = 0                          !< of the derivative: 0, 1 or 2
      integer :: coordinate = 1                     !< 1, 2 or 3: x, y, phi; of a pair 1
      logical :: angular = .false.                  !< an angle or a derivative of one
      character(2*label_length + 6) :: name = ''    !< ROCKER.phi, TIP.vx, SLOT.v
   end type table_column_t

   !> The columns of a set.
   type :: table_t
      character(drive_length), allocatable :: drives(:)   !< (drives) names: ANGLE.CRANK
      type(table_column_t), allocatable :: columns(:)     !< the others, by derivative and request
   end type table_t

   !> What the columns of a derivative add to the name of a link or point, a prismatic pair, a revolute pair. Those of
   !> pairs are not those of links, whose names pairs may have.
   character(5), parameter :: link_words(3, 0:2) = reshape([character(5) :: &
      'x', 'y', 'phi', 'vx', 'vy', 'vphi', 'ax', 'ay', 'aphi'], [3, 3])
   character(5), parameter :: slide_words(0:2) = [character(5) :: 's', 'v', 'a']
   character(5), parameter :: turn_words(0:2) = [character(5) :: 'theta', 'omega', 'alpha']

contains

   !> The names of the columns; with `errors`, those of the error estimates after them; where a set of the deck
   !> `varies`, the number of the variant behind that of the set.
   subroutine csv_head(o, errors, varies)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: errors, varies

      call add(o, 'set,')
      if (varies) call add(o, 'variant,')
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
      logical, intent(in) :: varies
      type(assemblies_t), intent(in), optional :: assemblies(:)
      character(:), allocatable :: start
      type(row_t) :: row, other
      type(request_t) :: request
      type(spread_t) :: spread
      type(motion_t) :: q
      real(wp) :: error(3, 0:2)
      logical :: known(3, 0:2), there(3, 0:2), asked
      character(12) :: mark
      integer :: i, k

      start = whole(s%set_number)//','
      if (varies) start = start//whole(s%variant)//','
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
            ! Three rows: each has one third of the numbers under x, y, phi.
            there = numbers_of(row)
            other = row
            do k = 0, 2
               other%value(:, 0) = row%value(:, k)
               mark = marks(row%mark)
               if (mark == '' .and. .not. all(there(:, k))) mark = marks_of_centre(row%state)
               call add_row(kinds_of_centre(k, row%kind), other, reshape(there(:, k), [3, 3], [.false.]), &
                  reshape(known(:, k), [3, 3], [.false.]), reshape(error(:, k), [3, 3], [0.0_wp]), mark)
            end do
            cycle
         end if
         call add_row(kinds_of_row(row%kind), row, numbers_of(row), known, error, marks(row%mark))

         associate (c => s%rows(i)%part)
            ! What tolerances do to the row.
            if (has_tolerances(s%parts(c), request)) then
               other = row
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
            ! The row in each assembly at the first instant.
            if (.not. present(assemblies) .or. step > 0) cycle
            q = new_motion(size(s%parts(c)%links))
            q%known = 0
            q%origin = s%motions(c)%origin
            do k = 1, size(assemblies(c)%list)
               q%position = assemblies(c)%list(k)%position
               call find_row(s%parts(c), q, request, other)
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

      do k = 0, 2
         do c = 1, 3
            there(c, k) = has_number(row, c, k)
         end do
      end do
   end function numbers_of

   !> A name as a cell: in quotes where it holds a comma or a quote.
   subroutine add_name(o, name)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: name

      if (scan(name, ',"') == 0) then
         call add(o, name)
      else
         call add(o, '"'//replaced(name, '"', ['""'])//'"')
      end if
   end subroutine add_name

   !> The table of the set `s`; `chosen`: of these rows alone, whether they are printed or not.
   function new_table(s, chosen) result(t)
      class(set_t), intent(in) :: s
      integer, intent(in), optional :: chosen(:)
      type(table_t) :: t
      type(name_table_t) :: links
      type(request_t), allocatable :: requests(:)
      integer, allocatable :: rows(:)
      character(:), allocatable :: name
      integer :: i, k, n, c
      logical :: turns
      character(5) :: word

      t%drives = drive_columns(s)
      requests = [(request_of(s, i), i=1, size(s%rows))]
      if (present(chosen)) then
         rows = chosen
      else
         rows = pack([(i, i=1, size(s%rows))], requests%every > 0 .and. requests%kind < request_pole)
      end if
      allocate (t%columns(3*sum(coordinates_of(requests(rows)%kind))))
      do i = 1, size(rows)
         if (requests(rows(i))%kind /= request_link) cycle
         associate (own => s%parts(s%rows(rows(i))%part))
            call put_name(links, own%links(requests(rows(i))%subject)%name, i, k)
         end associate
      end do
      n = 0
      do k = 0, 2
         do i = 1, size(rows)
            associate (request => requests(rows(i)), own => s%parts(s%rows(rows(i))%part))
               name = trim(subject_name(own, request%kind, request%subject))
               ! A point that has the name of a link in the table has that of its own link before it.
               if (request%kind == request_point .and. find_name(links, name) > 0) &
                  name = trim(own%links(own%points(request%subject)%link)%name)//'.'//name
               turns = .false.
               if (request%kind == request_pair) turns = own%pairs(request%subject)%kind /= pair_prismatic
               do c = 1, coordinates_of(request%kind)
                  word = link_words(c, k)
                  if (request%kind == request_pair) word = merge(turn_words(k), slide_words(k), turns)
                  n = n + 1
                  t%columns(n) = table_column_t(rows(i), k, c, c == 3 .or. turns, name//'.'//word)
               end do
            end associate
         end do
      end do
   end function new_table

   !> The names of the columns of all drives of `s`. Of drives of one thing, the second has .2 after it, and so on:
   !> ANGLE.CRANK, ANGLE.CRANK.2.
   function drive_columns(s) result(columns)
      class(set_t), intent(in) :: s
      character(drive_length), allocatable :: columns(:)
      integer :: i, number

      allocate (columns(size(s%drives)))
      do i = 1, size(columns)
         associate (own => s%parts(s%drives(i)%part), n => s%drives(i)%number)
            columns(i) = dotted(drive_name(own, own%drives(n)))
            associate (these => own%drives(:n))
               number = count(these%kind == these(n)%kind .and. these%subject == these(n)%subject &
                  .and. these%second == these(n)%second)
            end associate
            if (number > 1) columns(i) = trim(columns(i))//'.'//whole(number)
         end associate
      end do
   end function drive_columns

   !> `name` with a dot for each blank inside.
   pure function dotted(name) result(text)
      character(*), intent(in) :: name
      character(len(name)) :: text

      text = replaced(trim(name), ' ', ['.'])
   end function dotted

   !> The heading: the names of all columns.
   subroutine table_head(o, t)
      type(output_t), intent(inout) :: o
      type(table_t), intent(in) :: t
      integer :: i

      call add(o, 't')
      do i = 1, size(t%drives)
         call add(o, ',')
         call add_name(o, trim(t%drives(i)))
      end do
      do i = 1, size(t%columns)
         call add(o, ',')
         call add_name(o, trim(t%columns(i)%name))
      end do
      call put(o, '')
   end subroutine table_head

   !> The row of the motions `s`.
   subroutine table_instant(o, t, s)
      type(output_t), intent(inout) :: o
      type(table_t), intent(in) :: t
      type(set_motion_t), intent(in) :: s
      type(row_t) :: rows(size(s%rows))
      logical :: known(3, 0:2, size(s%rows))
      real(wp) :: f(3)
      integer :: i

      call add_cell('', s%motions(1)%t, .false.)
      do i = 1, size(s%drives)
         associate (drive => s%parts(s%drives(i)%part)%drives(s%drives(i)%number))
            f = drive_motion(drive, s%motions(1)%t)
            call add_cell(',', f(1), .not. is_length(drive))
         end associate
      end do
      do i = 1, size(s%rows)
         call find_row_in_set(s, i, rows(i))
         known(:, :, i) = known_numbers(rows(i), s, i)
      end do
      do i = 1, size(t%columns)
         associate (c => t%columns(i), row => rows(t%columns(i)%request))
            if (known(c%coordinate, c%order, c%request) .and. has_number(row, c%coordinate, c%order)) then
               call add_cell(',', row%value(c%coordinate, c%order), c%angular)
            else
               call add(o, ','//missing)
            end if
         end associate
      end do
      call put(o, '')

   contains

      !> A cell: `before`, then `value`; `angular`: an angle in radians, or a derivative of one.
      subroutine add_cell(before, value, angular)
         character(*), intent(in) :: before
         real(wp), intent(in) :: value
         logical, intent(in) :: angular
         character(full_length) :: cell
         real(wp) :: x
         integer :: length

         x = value
         if (s%degrees .and. angular) x = in_degrees(x)
         call put_full(x, cell, length)
         call add(o, before)
         call add(o, cell(:length))
      end subroutine add_cell
   end subroutine table_instant
end module csv
