!> The results as a table (--table): a row for each instant at which PRINT asks for anything, a column for each
!> quantity; time first, then the drives, then all positions, velocities and accelerations that PRINT asks for, with
!> all digits; what tolerances do to them; then curves and poles, which have no place where it is at infinity.
!>
!> Each row has all columns: NaN stands for a value that does not exist or has no known digit. pandas, R and gnuplot
!> read NaN as a missing value. Commas alone separate the cells, and gnuplot is given its separator. The units are those
!> of the deck. Rejected: a blank behind each comma, for gnuplot's default: pandas takes a column with ' NaN' for text.
module table
   use kinds, only: wp, label_length
   use planar, only: in_degrees
   use mechanism, only: mechanism_t, request_t, request_link, request_point, request_pair, request_pole, &
      request_curve, pair_prismatic
   use scales, only: is_length
   use drives, only: law_t, new_law, drive_motion
   use independent, only: set_t, request_of
   use name_table, only: name_table_t, put_name, find_name
   use names, only: drive_name, subject_name
   use points, only: row_t, has_number, centre_numbers, coordinates_of
   use sensitivities, only: has_tolerances, worst_case, root_of_squares
   use set_motion, only: set_motion_t, find_row_in_set, known_numbers, spread_t, spread_in_set
   use csv, only: add_name
   use text_output, only: output_t, put, add
   use numerals, only: put_full, full_length, whole
   implicit none
   private
   public :: table_t, table_column_t, new_table, table_head, table_instant, drive_columns, dotted

   !> Characters of the name of a drive's column: RELANGLE.A.B, with a number of up to seven digits.
   integer, parameter :: drive_length = 3*label_length + 10
   !> In the place of a value that does not exist or has no known digit.
   character(*), parameter :: missing = 'NaN'

   !> A column after those of time and drives.
   type :: table_column_t
      integer :: request = 0                        !< its number among those of the set
      !> The number of the request among those of which links, points and pairs are printed; 0: a pole or curve.
      integer :: row = 0
      integer :: order = 0                          !< of the derivative: 0, 1 or 2; of a pole or curve as in `centre_t`
      integer :: coordinate = 1                     !< 1, 2 or 3: x, y, phi; of a pair 1
      logical :: angular = .false.                  !< an angle or a derivative of one
      integer :: spread = 0                         !< by tolerances: 1 worst case, 2 root of squares; 0: none
      character(2*label_length + 12) :: name = ''   !< ROCKER.phi, TIP.vx, SLOT.v, POLE.BASE.COUPLER.x
   end type table_column_t

   !> The columns of a set.
   type :: table_t
      type(law_t), allocatable :: laws(:)           !< (drives)
      character(drive_length), allocatable :: drives(:)   !< (drives) names: ANGLE.CRANK
      logical, allocatable :: angular(:)            !< (drives) the drive is an angle
      type(table_column_t), allocatable :: columns(:)     !< the others, by derivative and request
   end type table_t

   !> What the columns of a derivative add to the name of a link or point, a prismatic pair, a revolute pair. Those of
   !> pairs are not those of links, whose names pairs may have.
   character(5), parameter :: link_words(3, 0:2) = reshape([character(5) :: &
      'x', 'y', 'phi', 'vx', 'vy', 'vphi', 'ax', 'ay', 'aphi'], [3, 3])
   character(5), parameter :: slide_words(0:2) = [character(5) :: 's', 'v', 'a']
   character(5), parameter :: turn_words(0:2) = [character(5) :: 'theta', 'omega', 'alpha']
   character(6), parameter :: spread_words(0:2) = [character(6) :: '', '.worst', '.rss']
   !> What the columns of a pole add to the names of both links, those of a curve to that of the point, in the order of
   !> `centre_numbers`.
   character(7), parameter :: centre_words(6, request_pole:request_curve) = reshape([character(7) :: &
      'x', 'y', 'xi_i', 'eta_i', 'xi_j', 'eta_j', 'x', 'y', 'tangent', 'radius', 'xc', 'yc'], [6, 2])

contains

   !> The table of the set `s`; `chosen`: of these rows alone, whether they are printed or not, without tolerances.
   function new_table(s, chosen) result(t)
      class(set_t), intent(in) :: s
      integer, intent(in), optional :: chosen(:)
      type(table_t) :: t
      type(name_table_t) :: links
      type(request_t), allocatable :: requests(:)
      integer, allocatable :: rows(:)
      integer :: i, k, n, c, row, kind, spread, last
      logical :: turns
      character(5) :: word

      allocate (t%laws(size(s%drives)), t%angular(size(s%drives)))
      do i = 1, size(s%drives)
         associate (drive => s%parts(s%drives(i)%part)%drives(s%drives(i)%number))
            t%laws(i) = new_law(drive)
            t%angular(i) = .not. is_length(drive)
         end associate
      end do
      t%drives = drive_columns(s)

      last = merge(2, 0, s%largest_tolerance > 0.0_wp)
      requests = [(request_of(s, i), i=1, size(s%rows))]
      if (present(chosen)) then
         last = 0
         rows = chosen
      else
         rows = pack([(i, i=1, size(s%rows))], requests%every > 0)
      end if
      associate (kinds => requests(rows)%kind)
         n = sum(coordinates_of(kinds)) + last*sum(coordinates_of(kinds), mask=kinds < request_pole)
         allocate (t%columns(3*n))
      end associate
      do i = 1, size(rows)
         if (requests(rows(i))%kind /= request_link) cycle
         associate (own => s%parts(s%rows(rows(i))%part))
            call put_name(links, own%links(requests(rows(i))%subject)%name, i, k)
         end associate
      end do
      n = 0
      do spread = 0, last
         do k = 0, 2
            row = 0
            do i = 1, size(rows)
               associate (request => requests(rows(i)), own => s%parts(s%rows(rows(i))%part))
                  if (request%kind >= request_pole) cycle
                  row = row + 1
                  turns = .false.
                  if (request%kind == request_pair) turns = own%pairs(request%subject)%kind /= pair_prismatic
                  do c = 1, coordinates_of(request%kind)
                     word = link_words(c, k)
                     if (request%kind == request_pair) word = merge(turn_words(k), slide_words(k), turns)
                     call add_column(i, merge(row, 0, spread == 0), k, c, c == 3 .or. turns, &
                        trim(word)//spread_words(spread))
                  end do
               end associate
            end do
         end do
      end do
      spread = 0
      do kind = request_curve, request_pole, -1
         do i = 1, size(rows)
            if (requests(rows(i))%kind /= kind) cycle
            do c = 1, size(centre_numbers, 2)
               associate (number => centre_numbers(:, c, kind))
                  call add_column(i, 0, number(2), number(1), number(1) == 3, centre_words(c, kind))
               end associate
            end do
         end do
      end do

   contains

      !> Adds a column of row number `i` of the table, whose name ends with `word`; what it is: as in its type.
      subroutine add_column(i, row, order, coordinate, angular, word)
         integer, intent(in) :: i, row, order, coordinate
         logical, intent(in) :: angular
         character(*), intent(in) :: word

         n = n + 1
         t%columns(n) = table_column_t(rows(i), row, order, coordinate, angular, spread)
         t%columns(n)%name = name_of(s%parts(s%rows(rows(i))%part), requests(rows(i)))//'.'//word
      end subroutine add_column

      !> What the names of the columns of `request` begin with. A point that has the name of one of the `links` in the
      !> table has that of its own link before it.
      function name_of(m, request) result(name)
         type(mechanism_t), intent(in) :: m
         type(request_t), intent(in) :: request
         character(:), allocatable :: name

         associate (subject => request%subject)
            select case (request%kind)
            case (request_pole)
               name = 'POLE.'//trim(m%links(request%second)%name)//'.'//trim(m%links(subject)%name)
            case (request_curve)
               name = 'CURVE.'//trim(m%points(subject)%name)
               if (request%second > 0) name = name//'.'//trim(m%links(request%second)%name)
            case default
               name = trim(subject_name(m, request%kind, subject))
               if (request%kind /= request_point) return
               if (find_name(links, name) > 0) name = trim(m%links(m%points(subject)%link)%name)//'.'//name
            end select
         end associate
      end function name_of
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
      integer :: i

      text = name
      do i = 1, len_trim(name)
         if (text(i:i) == ' ') text(i:i) = '.'
      end do
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
      type(row_t), allocatable :: rows(:, :)
      logical :: known(3, 0:2, size(s%rows))
      type(request_t) :: request
      type(spread_t) :: x
      real(wp) :: f(3)
      integer :: i

      call add_cell('', s%motions(1)%t, .false.)
      do i = 1, size(t%laws)
         f = drive_motion(t%laws(i), s%motions(1)%t)
         call add_cell(',', f(1), t%angular(i))
      end do
      allocate (rows(0:2, size(s%rows)))
      do i = 1, size(s%rows)
         request = request_of(s, i)
         call find_row_in_set(s, i, rows(0, i))
         known(:, :, i) = known_numbers(rows(0, i), s, i)
         rows(1:, i) = rows(0, i)
         if (request%every == 0 .or. .not. has_tolerances(s%parts(s%rows(i)%part), request)) cycle
         x = spread_in_set(s, i)
         rows(1:, i)%known = x%known
         rows(1, i)%value = worst_case(x%tolerances, x%of)
         rows(2, i)%value = root_of_squares(x%tolerances, x%of)
      end do
      do i = 1, size(t%columns)
         associate (c => t%columns(i), row => rows(t%columns(i)%spread, t%columns(i)%request))
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
end module table
