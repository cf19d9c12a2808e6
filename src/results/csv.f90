!> The results as comma-separated values with 17 digits, in the deck's units of length and angles. A value that does not
!> exist, or has no known digit, is empty, and `mark` has the reason; a name with a comma is quoted. A pole or curve has
!> three rows.
!>
!> The results as a table (--table): a row for each instant at which PRINT asks for anything, a column for each
!> quantity; time first, then the drives, then all positions, velocities and accelerations that PRINT asks for, with
!> all digits.
!>
!> Each row has all columns: NaN stands for a value that does not exist or has no known digit. pandas, R and gnuplot
!> read NaN as a missing value. Only commas separate the cells: set gnuplot's separator. The units are those of the
!> deck. Rejected: a blank after each comma, for gnuplot's default: pandas takes a column with ' NaN' for text.
module csv
   use, intrinsic :: ieee_arithmetic, only: ieee_is_nan, ieee_value, ieee_quiet_nan
   use kinds, only: wp, label_length
   use plane_vectors, only: in_degrees
   use mechanism, only: drive_t, request_t, request_link, request_point
   use columns, only: row_column_t, columns_of_rows, forms, kinds_of_rows, column_at, is_ratio, cell_of, &
      cell_words, cell_number, of_angle
   use scales, only: is_length
   use drives, only: drive_motion
   use points, only: row_t
   use independent, only: set_t
   use set_members, only: requests_of, row_form, row_subject, link_of_point, ratio_drive, moving_extremes, drive_of, &
      drive_title, same_before
   use name_table, only: name_table_t, store_name, find_name
   use masked_numbers, only: nothing_known
   use set_motion, only: set_motion_t
   use rows, only: finished_row_t
   use table, only: add_name, add_number
   use text_output, only: output_t, put, add, replaced
   use number_format, only: whole, full, write_full, full_length
   implicit none
   private
   public :: csv_head, csv_instant, marks
   public :: table_t, table_column_t, new_table, table_head, table_instant, find_table_row, table_width
   public :: drive_columns, dotted

   !> The marks of rows that are not complete, by the mark of the motion.
   character(12), parameter :: marks(0:5) = [character(12) :: '', 'NO-POSITION', 'NO-RATES', 'TOO-LARGE', 'OPEN', &
      'STROKE']
   !> The mark of a row in which only known digits are missing.
   character(*), parameter :: flag_unknown = 'UNKNOWN'
   !> All numbers of a row have a known digit.
   logical, parameter :: all_known(3, 0:2) = .true.
   !> The errors of a row whose errors are not known.
   real(wp), parameter :: no_errors(3, 0:2) = nothing_known

   !> Characters of the name of a drive's column: RELANGLE.A.B, with a number of up to seven digits.
   integer, parameter :: drive_column_length = 3*label_length + 10
   !> A value that does not exist or has no known digit.
   character(*), parameter :: missing = 'NaN'

   !> A column of the table after those of time and drives.
   type, extends(row_column_t) :: table_column_t
      integer :: request = 0                        !< number of the row among the requests of the set
      character(6*label_length) :: name = ''        !< ROCKER.phi, TIP.vx, SLOT.v, MU.by.ANGLE.CRANK
   end type table_column_t

   !> The columns of the table of a set.
   type :: table_t
      character(drive_column_length), allocatable :: drives(:)   !< (drives) names: ANGLE.CRANK
      type(table_column_t), allocatable :: columns(:)     !< (any number) the others, by derivative and request
      type(drive_t), allocatable :: laws(:)               !< (drives) functions of time
   end type table_t

contains

   !> Writes the heading of the comma-separated values: the names of the columns.
   subroutine csv_head(o, errors, varies)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: errors          !< rows have estimates of errors after their values
      logical, intent(in) :: varies          !< some set of the deck has variants: rows have the number of theirs

      call add(o, 'set,')
      if (varies) call add(o, 'variant,')
      call add(o, 'step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark')
      if (errors) call add(o, ',ex,ey,ephi,evx,evy,evphi,eax,eay,eaphi')
      call put(o, '')
   end subroutine csv_head

   !> Writes the rows of an instant that are due, with their errors if these are asked for.
   subroutine csv_instant(o, motions, rows, step, varies)
      type(output_t), intent(inout) :: o
      type(set_motion_t), intent(in) :: motions   !< at the instant
      type(finished_row_t), intent(in) :: rows(:)   !< (requests of the set) at the instant
      integer, intent(in) :: step            !< the number of the instant, from 0
      logical, intent(in) :: varies          !< as in the heading
      character(:), allocatable :: start
      integer :: i, k

      start = whole(motions%set_number)//','
      if (varies) start = start//whole(motions%variant)//','
      start = start//whole(step)//','//full(motions%motions(1)%t)//','
      do i = 1, size(rows)
         associate (row => rows(i))
            if (.not. row%due) cycle
            call add_rows('', row, row%has_digit, row%error)
            if (.not. allocated(row%others)) cycle
            do k = 1, size(row%others)
               call add_rows(' '//trim(row%others(k)%word), row%others(k)%row, all_known, no_errors)
            end do
         end associate
      end do

   contains

      !> Writes a row, or three for its three axes: kind, name, the values that exist and have a digit, mark; then the
      !> errors of the values that exist, if these are asked for.
      subroutine add_rows(what, row, has_digit, error)
         character(*), intent(in) :: what    !< words that follow the kind: ' WORST', ...; '': none
         class(row_t), intent(in) :: row     !< the row
         logical, intent(in) :: has_digit(3, 0:2)   !< at least one digit of the number is known
         real(wp), intent(in) :: error(3, 0:2)   !< the estimated errors of the value, in the deck's units and rad
         integer :: place(3, 0:2)            ! the columns of the nine cells; 0: none
         character(12) :: mark
         integer :: n, j, k, at_k, cell
         logical :: is_unknown, has_error(3, 0:2)

         associate (kind => kinds_of_rows(row%kind))
            do n = 0, kind%rows - 1
               place = 0
               mark = marks(row%flag)
               is_unknown = .false.
               do j = forms(row%form)%first, forms(row%form)%last
                  associate (at => columns_of_rows(j)%at)
                     if (kind%rows > 1 .and. at(2) /= n) cycle
                     cell = cell_of(columns_of_rows(j), row%known, row%state)
                     if (cell /= cell_number) then
                        if (mark == '') mark = cell_words(cell)%mark
                        cycle
                     end if
                     place(at(1), merge(at(2), 0, kind%rows == 1)) = j
                     is_unknown = is_unknown .or. .not. has_digit(at(1), at(2))
                  end associate
               end do

               call add(o, start)
               if (what == '') then
                  call add(o, kind%csv(n)(:len_trim(kind%csv(n))))
               else
                  call add_name(o, trim(kind%csv(n))//what)
               end if
               call add(o, ',')
               call add_name(o, row%name(:len_trim(row%name)))
               call add_values(place, row%value, has_digit)
               call add(o, ',')
               if (mark == '' .and. is_unknown) mark = flag_unknown
               call add(o, mark(:len_trim(mark)))

               if (motions%errors(1)%asked) then
                  has_error = error < nothing_known
                  ! A derivative has no error if no digit of the one before is known.
                  do k = 0, 2
                     at_k = merge(k, n, kind%rows == 1)
                     if (any(place(:, k) > 0 .and. .not. has_error(:, at_k))) has_error(:, at_k:) = .false.
                  end do
                  call add_values(place, error, has_error)
               end if
               call put(o, '')
            end do
         end associate
      end subroutine add_rows

      !> Appends nine cells, a comma before each.
      subroutine add_values(place, value, has_digit)
         integer, intent(in) :: place(3, 0:2)   !< of each cell the column whose number it has; 0: empty
         real(wp), intent(in) :: value(3, 0:2)   !< in the deck's units and rad
         logical, intent(in) :: has_digit(3, 0:2)   !< a cell whose number has no known digit is empty
         character(9*(full_length + 1)) :: cells
         real(wp) :: x
         integer :: k, c, used, length

         used = 0
         do k = 0, 2
            do c = 1, 3
               used = used + 1
               cells(used:used) = ','
               if (place(c, k) == 0) cycle
               associate (column => columns_of_rows(place(c, k)), at => columns_of_rows(place(c, k))%at)
                  if (.not. has_digit(at(1), at(2))) cycle
                  x = value(at(1), at(2))
                  if (motions%degrees .and. column%dimension == of_angle) x = in_degrees(x)
               end associate
               call write_full(x, cells(used + 1:used + full_length), length)
               used = used + length
            end do
         end do
         call add(o, cells(:used))
      end subroutine add_values
   end subroutine csv_instant

   !> Makes the columns of the table of a set: those of COLUMN cards in their order; without such cards, all columns of
   !> the rows of PRINT. A table of extremes has the sought numbers of the rows with EXTREMES cards.
   function new_table(set, of_extremes) result(t)
      class(set_t), intent(in) :: set        !< divided
      logical, intent(in) :: of_extremes     !< the table has extremes
      type(table_t) :: t
      type(name_table_t) :: links
      type(request_t), allocatable :: requests(:)
      integer, allocatable :: rows(:), form(:)
      integer :: i, j, k, n

      t%drives = drive_columns(set)
      allocate (t%laws(size(set%drives)))
      do i = 1, size(t%laws)
         t%laws(i) = drive_of(set, i)
      end do

      ! The rows, and which names links have among them.
      requests = requests_of(set)
      rows = [(i, i=1, size(set%rows))]
      form = [(row_form(set, i), i=1, size(set%rows))]
      if (of_extremes) then
         rows = moving_extremes(set)
      else if (allocated(set%columns)) then
         rows = set%columns%request
      else
         rows = pack(rows, requests%every > 0)
      end if
      do i = 1, size(rows)
         if (requests(rows(i))%kind /= request_link) cycle
         call store_name(links, row_subject(set, rows(i)), i, k)
      end do

      allocate (t%columns(sum(forms(form(rows))%last - forms(form(rows))%first + 1)))

      n = 0
      if (allocated(set%columns) .and. .not. of_extremes) then
         do i = 1, size(set%columns)
            associate (one => set%columns(i))
               call add_column(one%request, column_at(form(one%request), one%at(1), one%at(2)))
            end associate
         end do
      else
         ! Positions first, then velocities, then accelerations.
         do k = 0, 2
            do i = 1, size(rows)
               do j = forms(form(rows(i)))%first, forms(form(rows(i)))%last
                  associate (column => columns_of_rows(j))
                     if (column%word == '' .or. column%order /= k) cycle
                     if (of_extremes .and. .not. requests(rows(i))%sought(column%at(1), column%at(2))) cycle
                  end associate
                  call add_column(rows(i), j)
               end do
            end do
         end do
      end if
      t%columns = t%columns(:n)

   contains

      !> Adds a column to the table, with its name.
      subroutine add_column(i, j)
         integer, intent(in) :: i            !< the number of its row among the requests of the set
         integer, intent(in) :: j            !< the column, in `columns_of_rows`
         character(:), allocatable :: name

         associate (request => requests(i))
            name = trim(row_subject(set, i))
            ! A point that has the name of a link in the table has that of its own link before it.
            if (request%kind == request_point .and. find_name(links, name) > 0) &
               name = trim(link_of_point(set, i))//'.'//name
            ! The first word of a ratio comes before the name of the drive.
            if (request%drive > 0) name = name//'.'//trim(columns_of_rows(forms(form(i))%first)%word)//'.' &
               //trim(t%drives(ratio_drive(set, i)))
         end associate
         n = n + 1
         t%columns(n)%row_column_t = columns_of_rows(j)
         t%columns(n)%request = i
         t%columns(n)%name = name
         if (.not. (is_ratio(form(i)) .and. j == forms(form(i))%first)) &
            t%columns(n)%name = name//'.'//columns_of_rows(j)%word
      end subroutine add_column
   end function new_table

   !> Names the columns (drives) of all drives. If several drive one coordinate, the second has .2 after its name, and
   !> so on: ANGLE.CRANK, ANGLE.CRANK.2.
   function drive_columns(set) result(columns)
      class(set_t), intent(in) :: set        !< of the drives
      character(drive_column_length), allocatable :: columns(:)
      integer :: i, number

      allocate (columns(size(set%drives)))
      do i = 1, size(columns)
         columns(i) = dotted(drive_title(set, i))
         number = same_before(set, i) + 1
         if (number > 1) columns(i) = trim(columns(i))//'.'//whole(number)
      end do
   end function drive_columns

   !> Gives a name with a dot for each blank inside the name.
   pure function dotted(name) result(text)
      character(*), intent(in) :: name       !< as in the listing
      character(len(name)) :: text

      text = replaced(trim(name), ' ', ['.'])
   end function dotted

   !> Writes the heading of the table: the names of all columns.
   subroutine table_head(o, table)
      type(output_t), intent(inout) :: o
      type(table_t), intent(in) :: table     !< of the set
      integer :: i

      call add(o, 't')
      do i = 1, size(table%drives)
         call add(o, ',')
         call add_name(o, trim(table%drives(i)))
      end do
      do i = 1, size(table%columns)
         call add(o, ',')
         call add_name(o, trim(table%columns(i)%name))
      end do
      call put(o, '')
   end subroutine table_head

   !> Writes the row of the table for an instant.
   subroutine table_instant(o, table, motions, rows)
      type(output_t), intent(inout) :: o
      type(table_t), intent(in) :: table     !< of the set
      type(set_motion_t), intent(in) :: motions   !< at the instant
      type(finished_row_t), intent(in) :: rows(:)   !< (requests of the set) at the instant
      real(wp) :: values(table_width(table))
      integer :: i

      call find_table_row(table, motions, rows, values)
      do i = 1, size(values)
         if (i > 1) call add(o, ',')
         if (ieee_is_nan(values(i))) then
            call add(o, missing)
         else
            call add_number(o, values(i), .false.)
         end if
      end do
      call put(o, '')
   end subroutine table_instant

   !> Finds the numbers of the row of the table for an instant, in the deck's units.
   subroutine find_table_row(table, motions, rows, values)
      type(table_t), intent(in) :: table     !< of the set
      type(set_motion_t), intent(in) :: motions   !< at the instant
      type(finished_row_t), intent(in) :: rows(:)   !< (requests of the set) at the instant
      real(wp), intent(out) :: values(:)     !< (table_width) NaN: the number does not exist or has no known digit
      real(wp) :: f(3)
      integer :: i, n

      values(1) = motions%motions(1)%t
      n = 1
      do i = 1, size(motions%drives)
         f = drive_motion(table%laws(i), motions%motions(1)%t)
         n = n + 1
         values(n) = in_units(f(1), .not. is_length(table%laws(i)))
      end do
      do i = 1, size(table%columns)
         associate (c => table%columns(i), at => table%columns(i)%at, row => rows(table%columns(i)%request))
            n = n + 1
            if (row%has_digit(at(1), at(2)) .and. cell_of(c%row_column_t, row%known, row%state) == cell_number) then
               values(n) = in_units(row%value(at(1), at(2)), c%dimension == of_angle)
            else
               values(n) = ieee_value(values(n), ieee_quiet_nan)
            end if
         end associate
      end do

   contains

      !> Gives a number in the unit of the deck.
      pure real(wp) function in_units(value, is_angle)
         real(wp), intent(in) :: value       !< in the deck's units and rad
         logical, intent(in) :: is_angle     !< the number is an angle, or its derivative

         in_units = value
         if (motions%degrees .and. is_angle) in_units = in_degrees(value)
      end function in_units
   end subroutine find_table_row

   !> Counts the columns of the table, the time included.
   pure integer function table_width(table)
      type(table_t), intent(in) :: table     !< of a set

      table_width = 1 + size(table%drives) + size(table%columns)
   end function table_width
end module csv
