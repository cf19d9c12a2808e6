!> Tests. A listing read back by its own words: instants with their drives, heads, powers of ten and units of columns, rows.
!> It shares nothing with the modules that print it.
module listing_reader
   use echoed_deck, only: echoed_deck_t, new_echoed_deck, read_card, expand_requests, is_slide, label_length, word_length
   use listing_check, only: next_word
   implicit none
   private
   public :: row_text_t, set_text_t, next_set, word_length

   integer, parameter :: line_length = 400
   !> A row's numbers begin behind its name.
   integer, parameter :: first_number = 10
   character(8), parameter :: kind_words(4, 2) = reshape([character(8) :: &
      'LINK', 'POINT', 'PAIR', 'MEASURE', 'OGNIWO', 'PUNKT', 'PARA', 'WIELKOSC'], [4, 2])
   !> The heads of x, y, phi and their derivatives, in two languages. The slide of a pair counts as x, its angle as phi; the
   !> heads of their derivatives are the same, and follow them.
   character(14), parameter :: head_words(*) = [character(14) :: 'X', 'Y', 'PHI', 'VX', 'VY', 'VPHI', 'AX', 'AY', &
      'APHI', 'FI', 'VFI', 'AFI', 'SLIDE', 'ANGLE', 'VELOCITY', 'ACCELERATION', 'PRZESUW', 'KAT', 'PREDKOSC', &
      'PRZYSPIESZENIE', 'LENGTH', 'DLUGOSC']
   integer, parameter :: head_columns(*) = [1, 2, 3, 4, 5, 6, 7, 8, 9, 3, 6, 9, 1, 3, 4, 7, 1, 3, 4, 7, 1, 1]
   !> Which columns rows of each kind have.
   logical, parameter :: has_column(3, 4) = reshape([.true., .true., .true., .true., .true., .false., &
      .true., .false., .true., .true., .false., .true.], [3, 4])
   !> Of more drives only the first stand over the tables.
   integer, parameter :: most_drives = 6
   !> A number and the blank before it.
   integer, parameter :: column_length = 12

   !> One row of step `step`; `kind`: 1 link, 2 point, 3 pair, 4 measure. Where there is no column, its word is blank.
   type :: row_text_t
      integer :: step = -1, kind = 0
      character(label_length) :: name = ''
      character(5) :: spread = ''            !< WORST or RSS of the row above, otherwise blank
      character(word_length) :: word(9) = '', time = ''
      integer :: power(9) = 0, time_power = 0
   end type row_text_t

   type :: set_text_t
      integer :: number = 0
      type(echoed_deck_t) :: deck
      type(row_text_t), allocatable :: rows(:)
      integer :: row_count = 0
      integer :: instants = -1               !< those solved and those flagged, by the last line
      character(:), allocatable :: wrong     !< the first line that cannot be read
   end type set_text_t

   !> The table at hand; of each column its last character, 0 where it has none.
   type :: table_t
      integer :: step = -1, kind = 0
      character(label_length) :: name = ''   !< of the latest row
      character(word_length) :: time = ''
      integer :: time_power = 0
      integer :: last(9) = 0, power(9) = 0
      character(30) :: unit(9) = ''          !< as it stands in the heads, its lines put together
      integer :: drives = 0                  !< of the instant, that have been read
      logical :: results = .false.           !< the deck and the structure are over
      logical :: is_over = .false.           !< what follows is asked of the whole run
      logical :: centres = .false.           !< of a POLE or CURVE card, which tests/system/centres.sh reads
   end type table_t

contains

   !> The next set of the listing on `unit`; `found`: there is one.
   subroutine next_set(unit, set, found)
      integer, intent(in) :: unit
      type(set_text_t), intent(out) :: set
      logical, intent(out) :: found
      character(line_length) :: line
      type(table_t) :: table
      integer :: status, counts(3), used

      set%deck = new_echoed_deck()
      allocate (set%rows(1000))
      found = .false.
      do
         read (unit, '(a)', iostat=status) line
         if (status /= 0) exit
         if (starts(line, ' SET OF COMPUTATIONS NO. ', ' KOMPLET OBLICZEN NR ')) then
            found = .true.
            call read_wholes(line, counts, used)
            set%number = counts(1)
         else if (starts(line, ' END OF SET ', ' KONIEC KOMPLETU ')) then
            call read_wholes(line, counts, used)
            if (used /= 3 .or. counts(1) /= set%number) call blame(set, line)
            set%instants = sum(counts(2:))
            exit
         else if (found) then
            call read_line(line, set, table)
         end if
         if (allocated(set%wrong)) exit
      end do
   end subroutine next_set

   !> One line between the first and the last of a set.
   subroutine read_line(line, set, table)
      character(*), intent(in) :: line
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      integer :: counts(3), used

      if (line == ' RESULTS' .or. line == ' WYNIKI') then
         table%results = .true.
         call expand_requests(set%deck)
      else if (table%results .and. (table%is_over .or. starts(line, ' EXTREMES ', ' EKSTREMA ') &
         .or. starts(line, ' RANGES OF THE DRIVES', ' ZAKRESY NAPEDOW') &
         .or. starts(line, ' CIRCUITS AND ', ' OBWODY I ') .or. starts(line, ' ASSEMBLIES ', ' MONTAZE ') &
         .or. starts(line, ' PROOF: ', ' DOWOD: ') &
         .or. starts(line, ' TOLERANCES: ', ' TOLERANCJE: '))) then
         table%is_over = .true.
      else if (starts(line, ' INSTANT ', ' CHWILA ') .and. table%results) then
         ! An instant like an earlier one beyond a limit has no row.
         if (index(line, ': AS INSTANT ') > 0 .or. index(line, ': JAK CHWILA ') > 0) return
         call read_wholes(line(:index(line, 'T =')), counts, used)
         if (used /= 1) call blame(set, line)
         table%step = counts(1)
         table%drives = 0
         used = index(line, 'T =') + 2
         call read_value(line, set%deck%units(3), used, table%time, table%time_power, set)
         call read_drives(line, used, set, table)
      else if (.not. table%results) then
         call read_card(set%deck, line)
      else if (starts(line, ' POLE   ', ' BIEGUN ') .or. starts(line, ' CURVE  ', ' TOR    ')) then
         table%centres = .true.
      else if (is_row(line) .and. index(line, ' = ') > 0 .and. line(2:first_number - 1) == '') then
         call read_drives(line, 0, set, table)
      else if (table%centres .and. .not. is_head(line)) then
         return
      else if (is_row(line)) then
         call read_table_line(line, set, table)
      end if
   end subroutine read_line

   !> The line has the heads of links, points or pairs.
   pure logical function is_head(line)
      character(*), intent(in) :: line

      is_head = index(line, '.') == 0 .and. any(kind_words == line(2:first_number - 1))
   end function is_head

   !> The line is of a table: no remark, not what is said of branches.
   pure logical function is_row(line)
      character(*), intent(in) :: line

      is_row = line /= '' .and. .not. (starts(line, ' *** ', ' --- ') .or. starts(line, ' INSTANTS ', ' CHWILE ') &
         .or. starts(line, ' CONTINUATION: ', ' KONTYNUACJA: ') &
         .or. starts(line, ' LARGEST CLOSURE ERROR ', ' NAJWIEKSZY BLAD '))
   end function is_row

   !> The drives of an instant behind column `last` of `line`, in the order of their cards.
   subroutine read_drives(line, last, set, table)
      character(*), intent(in) :: line
      integer, intent(in) :: last
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      integer :: at

      at = last
      do while (line(at + 1:) /= '' .and. .not. starts(line(at + 1:), ' AND ', ' I '))
         table%drives = table%drives + 1
         if (table%drives > size(set%deck%drives)) call blame(set, line)
         if (allocated(set%wrong)) return
         associate (d => set%deck%drives(table%drives))
            at = at + verify(line(at + 1:), ' ') - 1
            if (index(line(at + 1:), trim(d%words)//' = ') /= 1) call blame(set, line)
            at = at + len_trim(d%words) + 2
            call read_value(line, set%deck%units(merge(2, 1, d%is_angle)), at, d%value, d%power, set)
         end associate
      end do
   end subroutine read_drives

   !> The number behind column `last` of `line`, its power of ten, if it has one, and its unit, which must be `unit`; `last`
   !> becomes the end of the unit.
   subroutine read_value(line, unit, last, word, power, set)
      character(*), intent(in) :: line, unit
      integer, intent(inout) :: last
      character(word_length), intent(out) :: word
      integer, intent(out) :: power
      type(set_text_t), intent(inout) :: set
      integer :: first, status

      power = 0
      status = 0
      call next_word(line, first, last)
      word = line(first:last)
      call next_word(line, first, last)
      if (line(first:min(first + 2, last)) == '1.E') then
         read (line(first + 3:last), *, iostat=status) power
         call next_word(line, first, last)
      end if
      if (status /= 0 .or. line(first:last) /= unit) call blame(set, line)
   end subroutine read_value

   !> Heads, powers of ten and units under them, or a row.
   subroutine read_table_line(line, set, table)
      character(*), intent(in) :: line
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      type(row_text_t) :: row
      integer :: first, last, column
      logical :: has(9)

      if (is_head(line)) then
         call read_heads(line, set, table)
         return
      end if
      if (table%kind == 0 .or. table%drives /= min(size(set%deck%drives), most_drives)) call blame(set, line)
      if (allocated(set%wrong)) return
      if (line(2:first_number - 1) == '') then
         call read_units(line, set, table)
         return
      end if
      row = row_text_t(step=table%step, kind=table%kind, name=line(2:first_number - 1), time=table%time, &
         time_power=table%time_power, power=table%power)
      if (row%name(:1) == ' ') then
         row%spread = spread_word(row%name)
         if (row%spread == '') call blame(set, line)
         row%name = table%name
      end if
      table%name = row%name
      last = first_number - 1
      do
         call next_word(line, first, last)
         if (first == 0) exit
         column = findloc(table%last, last, dim=1)
         if (column == 0 .or. last - first >= word_length) call blame(set, line)
         if (column == 0) return
         row%word(column) = line(first:last)
      end do
      has = table%last > 0
      if (row%kind >= 3) call choose_columns(is_slide(set%deck, row%kind, row%name), has)
      if (any((row%word == '') .eqv. has)) call blame(set, line)
      if (any(table%unit /= units_wanted(set%deck, table))) call blame(set, 'UNITS OVER '//line)
      if (row%spread == '') call compare_drives(line, row, set)
      if (row%kind >= 3 .and. .not. has(1)) then
         ! The CSV has one value of a pair.
         row%word(1::3) = row%word(3::3)
         row%word(3::3) = ''
         row%power(1::3) = row%power(3::3)
      end if
      call add_row(set, row)
   end subroutine read_table_line

   !> What the row above with the name `word` says of tolerances, as the CSV has it; '' where it says nothing.
   pure character(5) function spread_word(word)
      character(*), intent(in) :: word

      spread_word = ''
      if (word == ' WORST' .or. word == ' NAJGOR.') spread_word = 'WORST'
      if (word == ' RSS') spread_word = 'RSS'
   end function spread_word

   !> The columns that are not those of a pair's own value.
   pure subroutine choose_columns(slide, has)
      logical, intent(in) :: slide
      logical, intent(inout) :: has(9)

      has(1::3) = has(1::3) .and. slide
      has(3::3) = has(3::3) .and. .not. slide
   end subroutine choose_columns

   !> The drives of the instant have the values that `row`, read from `line`, has: where it has a number, and no digit of it
   !> is masked.
   subroutine compare_drives(line, row, set)
      character(*), intent(in) :: line
      type(row_text_t), intent(in) :: row
      type(set_text_t), intent(inout) :: set
      integer :: i

      do i = 1, size(set%deck%drives)
         associate (d => set%deck%drives(i))
            if (d%kind /= row%kind .or. d%name /= row%name .or. d%value == '') cycle
            if (scan(row%word(d%column), '?NB') > 0) cycle
            if (row%word(d%column) /= d%value .or. row%power(d%column) /= d%power) call blame(set, line)
         end associate
      end do
   end subroutine compare_drives

   !> The columns under the heads of a `line`, which begins with the kind of its rows.
   subroutine read_heads(line, set, table)
      character(*), intent(in) :: line
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      integer :: first, last, head, column, place(2)
      logical :: angular

      table%centres = .false.
      table%last = 0
      table%power = 0
      table%unit = ''
      place = findloc(kind_words, line(2:first_number - 1))
      table%kind = place(1)
      angular = .false.
      last = first_number - 1
      do
         call next_word(line, first, last)
         if (first == 0) exit
         head = findloc(head_words == line(first:last), .true., dim=1)
         if (head == 0) call blame(set, line)
         if (head == 0) return
         column = head_columns(head)
         if (column == 3) angular = .true.
         if (table%kind >= 3 .and. column > 3 .and. angular) column = column + 2
         if (table%last(column) > 0) call blame(set, line)
         table%last(column) = last
      end do
      ! Derivatives are those of the coordinates; of links the angle may stand alone, of pairs one kind.
      if (any((table%last(:3) > 0) .neqv. (table%last(4:6) > 0)) .or. any((table%last(:3) > 0) .neqv. (table%last(7:) > 0)) &
         .or. any(table%last(:3) > 0 .and. .not. has_column(:, table%kind)) .or. all(table%last == 0)) call blame(set, line)
      if (table%kind == 2 .and. any(table%last(:2) == 0)) call blame(set, line)
   end subroutine read_heads

   !> A line under the heads: powers of ten, or units.
   subroutine read_units(line, set, table)
      character(*), intent(in) :: line
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      character(column_length) :: word
      integer :: c, status, read_so_far

      read_so_far = 0
      do c = 1, 9
         if (table%last(c) == 0) cycle
         word = adjustl(line(table%last(c) - column_length + 1:table%last(c)))
         read_so_far = read_so_far + len_trim(word)
         if (word(:3) /= '1.E') then
            table%unit(c) = trim(table%unit(c))//word
         else
            read (word(4:), *, iostat=status) table%power(c)
            if (status /= 0 .or. table%unit(c) /= '') call blame(set, line)
         end if
      end do
      if (read_so_far /= count([(line(c:c) /= ' ', c=1, len(line))])) call blame(set, line)
   end subroutine read_units

   !> The units of the columns of `table`.
   pure function units_wanted(deck, table) result(unit)
      type(echoed_deck_t), intent(in) :: deck
      type(table_t), intent(in) :: table
      character(30) :: unit(9)
      integer :: c

      do c = 1, 9
         unit(c) = deck%units(merge(2, 1, modulo(c, 3) == 0))
         if (c > 3) unit(c) = trim(unit(c))//'/'//deck%units(3)
         if (c > 6) unit(c) = trim(unit(c))//'**2'
         if (table%last(c) == 0) unit(c) = ''
      end do
   end function units_wanted

   subroutine add_row(set, row)
      type(set_text_t), intent(inout) :: set
      type(row_text_t), intent(in) :: row

      if (set%row_count == size(set%rows)) set%rows = [set%rows, set%rows]
      set%row_count = set%row_count + 1
      set%rows(set%row_count) = row
   end subroutine add_row

   !> The first line that is wrong is kept.
   subroutine blame(set, line)
      type(set_text_t), intent(inout) :: set
      character(*), intent(in) :: line

      if (.not. allocated(set%wrong)) set%wrong = 'CANNOT BE READ: '//trim(line)
   end subroutine blame

   !> The first three whole numbers of `line`, `used` of which there are.
   pure subroutine read_wholes(line, number, used)
      character(*), intent(in) :: line
      integer, intent(out) :: number(3), used
      integer :: i
      logical :: inside

      number = 0
      used = 0
      inside = .false.
      do i = 1, len_trim(line)
         if (scan(line(i:i), '0123456789') == 0) then
            inside = .false.
            cycle
         end if
         if (.not. inside) used = used + 1
         if (used > size(number)) return
         inside = .true.
         number(used) = 10*number(used) + iachar(line(i:i)) - iachar('0')
      end do
   end subroutine read_wholes

   pure logical function starts(line, english, polish)
      character(*), intent(in) :: line, english, polish

      starts = line(:len(english)) == english .or. line(:len(polish)) == polish
   end function starts
end module listing_reader
