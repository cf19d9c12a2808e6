!> Columns, forms and kinds of rows as data, for all modules that print, search or sum up the numbers of rows. No other
!> module knows which numbers a row of a kind has, their names, or whether a number exists.
module columns
   use kinds, only: wp
   use plane_vectors, only: degree
   use scales, only: is_length
   use mechanism, only: mechanism_t, request_t, request_link, request_point, request_pair, request_measure, &
      request_pole, request_curve, request_ratio, has_guide
   use instant_centres, only: centre_finite, centre_infinite, points_coincide
   implicit none
   private
   public :: row_column_t, columns_of_rows, forms, kinds_of_rows, form_of, column_at, row_turning, &
      table_turning, last_table, of_length, of_angle, last_dimension
   public :: table_of, table_of_links, is_ratio, usual_size, quantities, drives
   public :: cell_words, cell_of, cell_none, cell_number, cell_count, cell_unbounded, cell_word, cell_spare, &
      last_cell

   !> The dimensions of numbers that are not ratios; derivatives by time are counted apart, by an order.
   integer, parameter :: of_length = 1, of_angle = 2
   !> The dimensions of ratios: a length or an angle by a length or an angle, in the deck's units.
   integer, parameter :: length_by_length = 3, length_by_angle = 4, angle_by_length = 5, angle_by_angle = 6, &
      last_dimension = 6
   !> The dimension of the quantity and the dimension of the drive, for each dimension of a ratio.
   integer, parameter :: quantities(length_by_length:last_dimension) = [of_length, of_length, of_angle, of_angle], &
      drives(length_by_length:last_dimension) = [of_length, of_angle, of_length, of_angle]

   !> One number of a row, wherever it is printed.
   type :: row_column_t
      character(14) :: english = '', polish = ''   !< its head; PRZYSPIESZENIE begins over the previous column
      character(5) :: word = ''              !< after the name in the head of --table; '': no column in --table
      integer :: place = 0                   !< column of the listing, 1 to 9; 0: not in the listing
      integer :: at(2) = 0                   !< indices in the value (3, 0:2) of a row: coordinate; derivative or axes
      integer :: dimension = of_length       !< of_length, ...
      integer :: order = 0                   !< it has the unit, digits and size of this derivative by time (0 to 2)
      integer :: needs = 0                   !< needs 0: the position, 1: velocities too, 2: accelerations too
      logical :: there(centre_finite:points_coincide) = .true.   !< the number exists in a row of this state
   end type row_column_t

   !> A form of rows: all rows of one form have equal columns.
   type :: row_form_t
      integer :: kind = 0                    !< of the rows: request_link, ...
      integer :: first = 0, last = 0         !< its columns in `columns_of_rows`
      integer :: coordinates = 0             !< columns of order 0 whose extremes can be requested
   end type row_form_t

   !> The words and the properties of a kind of rows: the kind of a request, or `table_turning`.
   type :: row_kind_t
      character(12) :: english = '', polish = ''   !< over the names in the listing
      integer :: subject = 0                 !< the kind of the subject of a row: request_link, ...; 0: of ratios
      integer :: names = 1                   !< names in a row, each with a column of its own
      integer :: rows = 1                    !< rows in the CSV: 1, or 3, one for each of the axes of `at`,
      character(7) :: csv(0:2) = ''          !< and the words of their kinds
      integer :: forms(2) = 0                !< of its rows; columns of forms(2) follow columns of forms(1)
      character(8) :: quantities(0:2) = ''   !< words of COLUMN cards, by order of the column; '': the English heads
      logical :: is_centre = .false.         !< instant centres or centres of curvature, which have no derivatives
      logical :: has_centrode = .false.      !< pictures have their path in the fixed plane and in the moving one
   end type row_kind_t

   !> The contents of a cell.
   enum, bind(c)
      enumerator :: cell_none = 0     !< no number: it is not known
      enumerator :: cell_count        !< a whole number
      enumerator :: cell_number       !< a number in the deck's units, of angles in rad
      enumerator :: cell_unbounded    !< there is no bound; the sign of the value says in which direction
      enumerator :: cell_word         !< a word
      enumerator :: cell_spare        !< a number that counts only if the row's first number has no digit
      enumerator :: cell_at_rest      !< AT REST
      enumerator :: cell_infinite     !< INFINITE
      enumerator :: cell_coincide     !< COINCIDE
   end enum
   !> The last of the contents of a cell.
   integer, parameter :: last_cell = cell_coincide

   !> The word of a cell without a number.
   type :: cell_word_t
      character(12) :: english = '', polish = ''   !< in the listing
      character(8) :: mark = ''              !< in the CSV
   end type cell_word_t

   !> The words of all cells, in the order of their enumerators.
   type(cell_word_t), parameter :: cell_words(cell_none:last_cell) = [ &
      cell_word_t('NONE', 'BRAK'), cell_word_t(), cell_word_t(), cell_word_t('UNBOUNDED', 'NIEOGRAN.'), cell_word_t(), &
      cell_word_t(), cell_word_t('AT REST', 'W SPOCZYNKU', 'AT-REST'), &
      cell_word_t('INFINITE', 'NIESKONCZ.', 'INFINITE'), cell_word_t('COINCIDE', 'POKRYCIE', 'COINCIDE')]

   !> For `there`: a number exists in the states finite, infinite, starting, resting, coincide.
   logical, parameter :: finite(5) = [.true., .false., .false., .false., .false.], &
      at_infinity(5) = [.false., .true., .false., .false., .false.], &
      moving(5) = [.true., .true., .true., .false., .false.]

   !> All columns, by forms: heads, word, place, at, dimension, order, needs, there.
   type(row_column_t), parameter :: columns_of_rows(*) = [ &
      ! 1: links.
      row_column_t('X', 'X', 'x', 1, [1, 0], of_length, 0, 0), &
      row_column_t('Y', 'Y', 'y', 2, [2, 0], of_length, 0, 0), &
      row_column_t('PHI', 'FI', 'phi', 3, [3, 0], of_angle, 0, 0), &
      row_column_t('VX', 'VX', 'vx', 4, [1, 1], of_length, 1, 1), &
      row_column_t('VY', 'VY', 'vy', 5, [2, 1], of_length, 1, 1), &
      row_column_t('VPHI', 'VFI', 'vphi', 6, [3, 1], of_angle, 1, 1), &
      row_column_t('AX', 'AX', 'ax', 7, [1, 2], of_length, 2, 2), &
      row_column_t('AY', 'AY', 'ay', 8, [2, 2], of_length, 2, 2), &
      row_column_t('APHI', 'AFI', 'aphi', 9, [3, 2], of_angle, 2, 2), &
      ! 10: links with only their angle in the listing.
      row_column_t('PHI', 'FI', 'phi', 3, [3, 0], of_angle, 0, 0), &
      row_column_t('VPHI', 'VFI', 'vphi', 6, [3, 1], of_angle, 1, 1), &
      row_column_t('APHI', 'AFI', 'aphi', 9, [3, 2], of_angle, 2, 2), &
      ! 13: points.
      row_column_t('X', 'X', 'x', 1, [1, 0], of_length, 0, 0), &
      row_column_t('Y', 'Y', 'y', 2, [2, 0], of_length, 0, 0), &
      row_column_t('VX', 'VX', 'vx', 4, [1, 1], of_length, 1, 1), &
      row_column_t('VY', 'VY', 'vy', 5, [2, 1], of_length, 1, 1), &
      row_column_t('AX', 'AX', 'ax', 7, [1, 2], of_length, 2, 2), &
      row_column_t('AY', 'AY', 'ay', 8, [2, 2], of_length, 2, 2), &
      ! 19: slides of prismatic pairs; 22: angles of revolute pairs. Their words differ from the words of links,
      ! since a pair may have the name of a link.
      row_column_t('SLIDE', 'PRZESUW', 's', 1, [1, 0], of_length, 0, 0), &
      row_column_t('VELOCITY', 'PREDKOSC', 'v', 2, [1, 1], of_length, 1, 1), &
      row_column_t('ACCELERATION', 'PRZYSPIESZENIE', 'a', 4, [1, 2], of_length, 2, 2), &
      row_column_t('ANGLE', 'KAT', 'theta', 1, [1, 0], of_angle, 0, 0), &
      row_column_t('VELOCITY', 'PREDKOSC', 'omega', 2, [1, 1], of_angle, 1, 1), &
      row_column_t('ACCELERATION', 'PRZYSPIESZENIE', 'alpha', 4, [1, 2], of_angle, 2, 2), &
      ! 25: poles in the fixed plane and in the axes of links I and J; at infinity the direction in each of the three.
      row_column_t('X', 'X', '', 1, [1, 0], of_length, 0, 1, finite), &
      row_column_t('Y', 'Y', '', 2, [2, 0], of_length, 0, 1, finite), &
      row_column_t('XI-I', 'KSI-I', '', 3, [1, 1], of_length, 0, 1, finite), &
      row_column_t('ETA-I', 'ETA-I', '', 4, [2, 1], of_length, 0, 1, finite), &
      row_column_t('XI-J', 'KSI-J', '', 5, [1, 2], of_length, 0, 1, finite), &
      row_column_t('ETA-J', 'ETA-J', '', 6, [2, 2], of_length, 0, 1, finite), &
      row_column_t('DIRECTION', 'KIERUNEK', '', 7, [3, 0], of_angle, 0, 1, at_infinity), &
      row_column_t('', '', '', 0, [3, 1], of_angle, 0, 1, at_infinity), &
      row_column_t('', '', '', 0, [3, 2], of_angle, 0, 1, at_infinity), &
      ! 34: paths of points: the point, the tangent, the radius and the centre of curvature.
      row_column_t('X', 'X', '', 1, [1, 0], of_length, 0, 0), &
      row_column_t('Y', 'Y', '', 2, [2, 0], of_length, 0, 0), &
      row_column_t('TANGENT', 'STYCZNA', '', 3, [3, 0], of_angle, 0, 1, moving), &
      row_column_t('RADIUS', 'PROMIEN', '', 4, [1, 2], of_length, 0, 2, finite), &
      row_column_t('X-CENTRE', 'X-SRODKA', '', 5, [1, 1], of_length, 0, 2, finite), &
      row_column_t('Y-CENTRE', 'Y-SRODKA', '', 6, [2, 1], of_length, 0, 2, finite), &
      ! 40: measured lengths, which have no rates if points coincide; 43: measured angles, which have no value then.
      row_column_t('LENGTH', 'DLUGOSC', 's', 1, [1, 0], of_length, 0, 0), &
      row_column_t('VELOCITY', 'PREDKOSC', 'v', 2, [1, 1], of_length, 1, 1, finite), &
      row_column_t('ACCELERATION', 'PRZYSPIESZENIE', 'a', 4, [1, 2], of_length, 2, 2, finite), &
      row_column_t('ANGLE', 'KAT', 'theta', 1, [1, 0], of_angle, 0, 0, finite), &
      row_column_t('VELOCITY', 'PREDKOSC', 'omega', 2, [1, 1], of_angle, 1, 1, finite), &
      row_column_t('ACCELERATION', 'PRZYSPIESZENIE', 'alpha', 4, [1, 2], of_angle, 2, 2, finite), &
      ! 46: ratios, by the dimensions of the quantity and of the drive.
      row_column_t('VALUE', 'WARTOSC', 'by', 1, [1, 0], length_by_length, 0, 0, finite), &
      row_column_t('DERIVATIVE', 'POCHODNA', 'd', 2, [1, 1], length_by_length, 1, 0, finite), &
      row_column_t('VALUE', 'WARTOSC', 'by', 1, [1, 0], length_by_angle, 0, 0, finite), &
      row_column_t('DERIVATIVE', 'POCHODNA', 'd', 2, [1, 1], length_by_angle, 1, 0, finite), &
      row_column_t('VALUE', 'WARTOSC', 'by', 1, [1, 0], angle_by_length, 0, 0, finite), &
      row_column_t('DERIVATIVE', 'POCHODNA', 'd', 2, [1, 1], angle_by_length, 1, 0, finite), &
      row_column_t('VALUE', 'WARTOSC', 'by', 1, [1, 0], angle_by_angle, 0, 0, finite), &
      row_column_t('DERIVATIVE', 'POCHODNA', 'd', 2, [1, 1], angle_by_angle, 1, 0, finite)]

   !> The numbers of rows with one coordinate on COLUMN cards.
   character(8), parameter :: of_value(0:2) = ['VALUE   ', 'VVALUE  ', 'AVALUE  ']

   !> The forms of rows. Ratios have the forms row_ratio to last_form, one for each dimension of a ratio.
   integer, parameter :: row_link = 1, row_turning = 2, row_point = 3, row_slide = 4, row_angle = 5, row_pole = 6, &
      row_curve = 7, row_length = 8, row_direction = 9, row_ratio = 10, last_form = 13
   !> The kind and the columns of each form.
   type(row_form_t), parameter :: forms(last_form) = [ &
      row_form_t(request_link, 1, 9, 3), row_form_t(request_link, 10, 12, 1), row_form_t(request_point, 13, 18, 2), &
      row_form_t(request_pair, 19, 21, 1), row_form_t(request_pair, 22, 24, 1), row_form_t(request_pole, 25, 33), &
      row_form_t(request_curve, 34, 39), row_form_t(request_measure, 40, 42, 1), &
      row_form_t(request_measure, 43, 45, 1), row_form_t(request_ratio, 46, 47, 1), &
      row_form_t(request_ratio, 48, 49, 1), row_form_t(request_ratio, 50, 51, 1), row_form_t(request_ratio, 52, 53, 1)]

   !> The kind of tables of links with angles only. The other kinds of tables are the kinds of rows; ratios have one
   !> kind of table for each of their forms.
   integer, parameter :: table_turning = 0, last_table = request_ratio + last_form - row_ratio
   !> The numbers of rows of ratios on COLUMN cards.
   character(8), parameter :: of_ratio(0:2) = ['VALUE   ', 'DERIV   ', '        ']
   !> The words and the properties of each kind of tables.
   type(row_kind_t), parameter :: kinds_of_rows(table_turning:last_table) = [ &
      row_kind_t('LINK', 'OGNIWO', request_link, 1, 1, 'LINK', [row_turning, 0]), &
      row_kind_t('LINK', 'OGNIWO', request_link, 1, 1, 'LINK', [row_link, 0]), &
      row_kind_t('POINT', 'PUNKT', request_point, 1, 1, 'POINT', [row_point, 0]), &
      row_kind_t('PAIR', 'PARA', request_pair, 1, 1, 'PAIR', [row_slide, row_angle], of_value), &
      row_kind_t('MEASURE', 'WIELKOSC', request_measure, 1, 1, 'MEASURE', [row_length, row_direction], of_value), &
      row_kind_t('POLE', 'BIEGUN', request_link, 2, 3, ['POLE   ', 'POLE-I ', 'POLE-J '], [row_pole, 0], &
         is_centre=.true., has_centrode=.true.), &
      row_kind_t('CURVE', 'TOR', request_point, 2, 3, ['CURVE  ', 'CENTRE ', 'RADIUS '], [row_curve, 0], &
         is_centre=.true.), &
      row_kind_t('RATIO', 'PRZELOZENIE', 0, 5, 1, 'RATIO', [row_ratio, 0], of_ratio), &
      row_kind_t('RATIO', 'PRZELOZENIE', 0, 5, 1, 'RATIO', [row_ratio + 1, 0], of_ratio), &
      row_kind_t('RATIO', 'PRZELOZENIE', 0, 5, 1, 'RATIO', [row_ratio + 2, 0], of_ratio), &
      row_kind_t('RATIO', 'PRZELOZENIE', 0, 5, 1, 'RATIO', [row_ratio + 3, 0], of_ratio)]

contains

   !> Finds the form of the rows of a request: row_link, ..., last_form.
   pure integer function form_of(m, request)
      type(mechanism_t), intent(in) :: m     !< whose request it is
      type(request_t), intent(in) :: request !< of `m`

      form_of = kinds_of_rows(request%kind)%forms(1)
      if (request%kind == request_pair) then
         if (.not. has_guide(m%pairs(request%subject)%kind)) form_of = row_angle
      else if (request%kind == request_measure) then
         if (m%measures(request%subject)%is_angle) form_of = row_direction
      end if
      if (request%drive == 0) return
      form_of = row_ratio + 2*(columns_of_rows(forms(form_of)%first)%dimension - of_length) &
         + merge(0, 1, is_length(m%drives(request%drive)))
   end function form_of

   !> Finds the kind of the table in which a row is printed: table_turning, ..., last_table.
   pure integer function table_of(kind, form, links_table) result(table)
      integer, intent(in) :: kind            !< of the row: request_link, ...
      integer, intent(in) :: form            !< of the row: row_link, ...
      integer, intent(in) :: links_table     !< the kind of the tables of links: table_turning or request_link

      table = merge(links_table, kind, kind == request_link)
      if (kind == request_ratio) table = kind + form - row_ratio
   end function table_of

   !> Finds the kind of the tables of links: table_turning, with angles only, if no link shows its position; otherwise
   !> request_link.
   pure integer function table_of_links(requests, shows_place) result(table)
      type(request_t), intent(in) :: requests(:)   !< (any number)
      logical, intent(in) :: shows_place(:)  !< (requests) of a link: the tables have its position

      table = merge(request_link, table_turning, any(requests%kind == request_link .and. shows_place))
   end function table_of_links

   !> Tells whether rows of a form are ratios.
   elemental logical function is_ratio(form)
      integer, intent(in) :: form            !< row_link, ...

      is_ratio = forms(form)%kind == request_ratio
   end function is_ratio

   !> Gives the size that numbers of a dimension usually have, from the characteristic length and rate. A ratio is in
   !> the deck's units; any other number in the deck's units of length and time, and in rad.
   pure real(wp) function usual_size(dimension, order, length, rate, degrees) result(size_of)
      integer, intent(in) :: dimension       !< of_length, ...
      integer, intent(in) :: order           !< of the derivative, from 0: by the time, of a ratio by the drive
      real(wp), intent(in) :: length         !< characteristic length of the mechanism
      real(wp), intent(in) :: rate           !< its characteristic rate, 1 over the unit of time
      logical, intent(in) :: degrees         !< the deck's unit of angles is the degree
      real(wp) :: sizes(of_length:of_angle)

      if (dimension <= of_angle) then
         size_of = merge(length, 1.0_wp, dimension == of_length)*rate**order
      else
         sizes = [length, merge(1.0_wp/degree, 1.0_wp, degrees)]
         size_of = sizes(quantities(dimension))/sizes(drives(dimension))**(order + 1)
      end if
   end function usual_size

   !> Finds the column of `columns_of_rows` for one number of the values of rows; 0: no column has this number.
   pure integer function column_at(form, coordinate, k) result(j)
      integer, intent(in) :: form            !< of the rows: row_link, ...
      integer, intent(in) :: coordinate      !< 1 to 3
      integer, intent(in) :: k               !< derivative or axes, 0 to 2

      do j = forms(form)%first, forms(form)%last
         if (all(columns_of_rows(j)%at == [coordinate, k])) return
      end do
      j = 0
   end function column_at

   !> Finds the contents of a cell: cell_number, cell_none, cell_spare, or the word for the state of its row. This is
   !> the only rule of which numbers exist.
   pure integer function cell_of(column, known, state) result(cell)
      type(row_column_t), intent(in) :: column   !< one of `columns_of_rows`
      integer, intent(in) :: known           !< -1: nothing exists, 0: position, 1: velocity too, 2: acceleration too
      integer, intent(in) :: state           !< of the row: centre_finite, ...

      cell = cell_number
      if (column%needs > known) then
         cell = cell_none
      else if (.not. column%there(state)) then
         select case (state)
         case (centre_finite)
            cell = cell_spare
         case (centre_infinite)
            cell = cell_infinite
         case (points_coincide)
            cell = cell_coincide
         case default
            cell = cell_at_rest
         end select
      end if
   end function cell_of
end module columns
