!> Tests. A listing read back by its own words: units, powers of ten, heads and rows. It shares nothing with the modules
!> that print it.
module listing_reader
   use echoed_deck, only: echoed_deck_t, new_echoed_deck, read_card, expand_requests, label_length
   use listing_check, only: next_word
   implicit none
   private
   public :: row_text_t, set_text_t, next_set, word_length

   integer, parameter :: line_length = 400, word_length = 16
   !> A row's numbers begin behind its name.
   integer, parameter :: first_number = 10
   character(8), parameter :: kind_words(3, 2) = reshape([character(8) :: &
      'LINK', 'POINT', 'PAIR', 'OGNIWO', 'PUNKT', 'PARA'], [3, 2])
   !> The heads of the nine columns, in two languages; a pair has the first, fourth and seventh. The second word of
   !> 2ND RATE stands over its numbers' end.
   character(8), parameter :: head_words(*) = [character(8) :: 'X', 'Y', 'PHI', 'VX', 'VY', 'VPHI', 'AX', 'AY', &
      'APHI', 'FI', 'VFI', 'AFI', 'VALUE', 'RATE', '2ND', 'WARTOSC', 'PREDKOSC', 'PRZYSP.']
   integer, parameter :: head_columns(*) = [1, 2, 3, 4, 5, 6, 7, 8, 9, 3, 6, 9, 1, 4, 0, 1, 4, 7]

   !> One row of step `step`; `kind`: 1 link, 2 point, 3 pair. Where there is no column, its word is blank.
   type :: row_text_t
      integer :: step = -1, kind = 0
      character(label_length) :: name = ''
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
      character(word_length) :: time = ''
      integer :: last(9) = 0, power(9) = 0
      integer :: time_power = 0, unit_power(2, 0:2) = 0   !< (length or angle, derivative)
      logical :: results = .false.                        !< the deck and the structure are over
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
      else if (starts(line, ' INSTANT ', ' CHWILA ') .and. table%results) then
         call read_wholes(line(:index(line, 'T =')), counts, used)
         if (used /= 1) call blame(set, line)
         table%step = counts(1)
         table%kind = 0
         table%time = adjustl(line(index(line, 'T =') + 3:))
      else if (.not. table%results) then
         call read_card(set%deck, line)
      else if (table%step < 0) then
         call read_units(line, set, table)
      else if (is_row(line)) then
         call read_table_line(line, set, table)
      end if
   end subroutine read_line

   !> The line is of a table: no remark, not what is said of branches.
   pure logical function is_row(line)
      character(*), intent(in) :: line

      is_row = line /= '' .and. .not. (starts(line, ' *** ', ' --- ') .or. starts(line, ' BRANCH: ', ' GALAZ: ') &
         .or. starts(line, ' LARGEST GAP OF ', ' NAJWIEKSZA NIEZGODNOSC '))
   end function is_row

   !> One of the four lines of units, which must be those of the deck.
   subroutine read_units(line, set, table)
      character(*), intent(in) :: line
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      character(:), allocatable :: per
      integer :: k, last
      character(8), parameter :: line_starts(0:2) = [character(8) :: ' X, Y [', ' VX, VY', ' AX, AY']

      associate (unit => set%deck%units)
         if (starts(line, ' T [', ' T [')) call read_bracket(line, 1, trim(unit(3)), table%time_power, last, set)
         do k = 0, 2
            if (.not. starts(line, trim(line_starts(k)), trim(line_starts(k)))) cycle
            per = ''
            if (k == 1) per = '/'//trim(unit(3))
            if (k == 2) per = '/'//trim(unit(3))//'**2'
            call read_bracket(line, 1, trim(unit(1))//per, table%unit_power(1, k), last, set)
            call read_bracket(line, last + 1, trim(unit(2))//per, table%unit_power(2, k), last, set)
         end do
      end associate
   end subroutine read_units

   !> The power of ten in the first brackets from column `first` on, whose unit must be `unit`; `last`: their end.
   subroutine read_bracket(line, first, unit, power, last, set)
      character(*), intent(in) :: line, unit
      integer, intent(in) :: first
      integer, intent(out) :: power, last
      type(set_text_t), intent(inout) :: set
      integer :: start, blank, status

      power = 0
      start = first + index(line(first:), '[')
      last = start + index(line(start:), ']') - 1
      if (line(start:min(start + 3, last)) == '10**') then
         blank = start + index(line(start:), ' ') - 1
         read (line(start + 4:blank), *, iostat=status) power
         if (status /= 0) call blame(set, line)
         start = blank + 1
      end if
      if (line(start:last - 1) /= unit) call blame(set, line)
   end subroutine read_bracket

   !> Heads, powers of ten under them, or a row.
   subroutine read_table_line(line, set, table)
      character(*), intent(in) :: line
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      type(row_text_t) :: row
      integer :: first, last, column, status
      logical :: powers

      if (index(line, '.') == 0 .or. index(line, 'PRZYSP.') > 0) then
         if (any(kind_words == line(2:first_number - 1))) then
            call read_heads(line, set, table)
            if (table%kind > 0) return
         end if
      end if
      if (table%kind == 0) call blame(set, line)
      row = row_text_t(step=table%step, kind=table%kind, name=line(2:first_number - 1), time=table%time, &
         time_power=table%time_power)
      powers = row%name == '' .and. index(line, '10**') > 0
      last = first_number - 1
      do
         call next_word(line, first, last)
         if (first == 0) exit
         column = findloc(table%last, last, dim=1)
         if (column == 0 .or. last - first >= word_length) call blame(set, line)
         if (column == 0) return
         if (powers) then
            read (line(first + len('10**'):last), *, iostat=status) table%power(column)
            if (status /= 0 .or. line(first:first + 3) /= '10**') call blame(set, line)
         else
            row%word(column) = line(first:last)
         end if
      end do
      if (powers) return
      row%power = table%power + powers_of_units(set%deck, table, row%name)
      if (any((row%word == '') .neqv. (table%last == 0))) call blame(set, line)
      call add_row(set, row)
   end subroutine read_table_line

   !> The columns under the heads of a `line`, which begins with the kind of its rows.
   subroutine read_heads(line, set, table)
      character(*), intent(in) :: line
      type(set_text_t), intent(inout) :: set
      type(table_t), intent(inout) :: table
      integer :: first, last, head, place(2)
      logical :: second

      table%last = 0
      table%power = 0
      place = findloc(kind_words, line(2:first_number - 1))
      table%kind = place(1)
      second = .false.
      last = first_number - 1
      do
         call next_word(line, first, last)
         if (first == 0) exit
         head = findloc(head_words == line(first:last), .true., dim=1)
         if (head == 0) call blame(set, line)
         if (head == 0) return
         if (head_columns(head) > 0) table%last(head_columns(head) + merge(3, 0, second)) = last
         second = line(first:last) == '2ND'
      end do
      if (count(table%last > 0) /= 3*(4 - table%kind)) call blame(set, line)
   end subroutine read_heads

   !> The powers of ten that the units give to the columns of the row of `name`.
   function powers_of_units(deck, table, name) result(power)
      type(echoed_deck_t), intent(in) :: deck
      type(table_t), intent(in) :: table
      character(*), intent(in) :: name
      integer :: power(9)
      logical :: angle

      power(1::3) = table%unit_power(1, :)
      power(2::3) = table%unit_power(1, :)
      power(3::3) = table%unit_power(2, :)
      if (table%kind < 3) return
      angle = any(deck%named%kind == 3 .and. deck%named%name == name .and. .not. deck%slides)
      if (angle) power(1::3) = table%unit_power(2, :)
   end function powers_of_units

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
