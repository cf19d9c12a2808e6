!> All errors of decks, by number and sentence, and the errors found in one deck. A message shows the card, a mark under
!> the column and, if it helps, the layout of the card. It is `"text" SENTENCE`, or only the sentence. Remarks are
!> collected in addition to errors; they reject nothing.
module input_errors
   use kinds, only: wp, label_length
   use mechanism, only: remark_t, remark_more
   use cards
   use number_format, only: whole
   implicit none
   private
   public :: error_code_t, input_errors_t, add_error, add_field_error, error_report, add_remark, near_name

   !> The largest number of errors of a deck, and of remarks of a set, that are printed: nobody reads more. All others
   !> are only counted.
   integer, parameter, public :: max_printed = 50
   !> The ruler below a card, for its 80 columns and ten more.
   character(*), parameter :: ruler = &
      '....+....1....+....2....+....3....+....4....+....5....+....6....+....7....+....8....+....9'
   !> Stands for the layout of the card that has the error.
   integer, parameter :: own_layout = -1

   !> A kind of error.
   type :: error_code_t
      integer :: number = 0              !< printed as E and three digits; 0: no error
      character(160) :: sentence = ''    !< in capitals; begins with a verb if the wrong text is its subject
      integer :: layout = form_unknown   !< the form whose layout is printed below the message, or own_layout
   end type error_code_t

   !> The errors of a deck.
   type :: input_errors_t
      integer :: count = 0               !< number of errors, also of those that are not printed
      logical :: is_free = .false.       !< a card in free format has its error: later such cards have none
      character(:), allocatable :: lines !< the messages, joined by new_line('a'); none: not allocated
      integer :: remarked = 0            !< number of remarks about the open set, also beyond the list
      type(remark_t) :: remarks(max_printed + 1)   !< the last counts those beyond the list
   end type input_errors_t

   ! The deck and its sets.
   type(error_code_t), parameter, public :: &
      deck_empty = error_code_t(1, 'THE DECK IS EMPTY'), &
      end_missing = error_code_t(2, 'IS THE LAST CARD OF THE DECK: ADD AN END CARD AFTER IT', form_end), &
      link_missing = error_code_t(4, 'CLOSES A SET WITHOUT A LINK CARD', form_link), &
      time_missing = error_code_t(5, 'CLOSES A SET WITHOUT A TIME OR AT CARD', form_time), &
      deck_long = error_code_t(6, 'THE DECK IS TOO LONG; CARDS ALLOWED:')
   ! A card as a whole, and its characters.
   type(error_code_t), parameter, public :: &
      card_unknown = error_code_t(10, 'IS NOT THE NAME OF A CARD'), &
      card_free = &
         error_code_t(11, 'IS NOT IN ITS COLUMNS: LABELS BEGIN IN COLUMN 9, 17 AND 25, NUMBERS IN 33, 49, 65'), &
      card_indented = error_code_t(12, 'DOES NOT BEGIN IN COLUMN 1: MOVE THE CARD TO THE LEFT'), &
      card_repeated = error_code_t(13, 'IS ALLOWED ONLY ONCE IN A SET; FIRST ON CARD'), &
      past_last_column = error_code_t(14, 'IS BEYOND COLUMN 80'), &
      tab_character = error_code_t(15, 'CONTAINS A TAB'), &
      foreign_character = error_code_t(16, 'CONTAINS A CHARACTER THAT IS NOT PRINTABLE ASCII'), &
      border_crossed = error_code_t(18, 'CROSSES THE FIELD BORDER BETWEEN COLUMNS', own_layout), &
      field_unused = error_code_t(19, 'IS IN A FIELD THAT THIS CARD DOES NOT USE', own_layout)
   !> Numbers on cards are 0 or of size 1E-max_power to 1Emax_power: this leaves room for fourth powers in the kind of
   !> reals.
   integer, parameter, public :: max_power = min(60, int(0.25*range(1.0_wp)))
   !> The number `max_power` as text: 60, or 9 in single precision.
   character(*), parameter :: power_text = trim(merge('60', '9 ', max_power == 60))
   type(error_code_t), parameter, public :: &
      number_other = error_code_t(20, 'IS NOT A NUMBER'), &
      number_comma = error_code_t(21, 'IS NOT A NUMBER: WRITE A POINT FOR THE COMMA'), &
      numbers_touch = error_code_t(22, 'TOUCHES THE NUMBER BEFORE IT: KEEP A BLANK BETWEEN', own_layout), &
      number_overflow = error_code_t(28, 'IS TOO LARGE A NUMBER: THE LARGEST IS 1E'//power_text), &
      number_underflow = error_code_t(29, 'IS TOO SMALL A NUMBER: THE SMALLEST ABOVE ZERO IS 1E-'//power_text), &
      number_no_point = error_code_t(30, 'IS NOT A REAL NUMBER: WRITE A DECIMAL POINT OR AN EXPONENT (5.0)'), &
      number_fraction = error_code_t(31, 'IS NOT AN INTEGER: REMOVE THE POINT OR EXPONENT')
   ! Fields, and cards that belong to the card above them: `*`, TOLER, VARY, ADD and RISE.
   type(error_code_t), parameter, public :: &
      field_blank = error_code_t(34, 'THE FIELD IS BLANK: FILL IT IN', own_layout), &
      label_blank_inside = error_code_t(35, 'IS NOT A LABEL: LABELS CANNOT CONTAIN BLANKS', own_layout), &
      number_range = error_code_t(36, 'IS OUT OF RANGE; ALLOWED:'), &
      label_long = error_code_t(37, 'IS TOO LONG: NAMES AND INTEGERS HAVE AT MOST 8 CHARACTERS', own_layout), &
      card_second = error_code_t(42, 'IS A SECOND * OR TOLER CARD FOR THE SAME CARD'), &
      star_twice = error_code_t(43, 'IS GIVEN TWICE: ALSO ON THE CARD THAT THIS ONE CONTINUES'), &
      card_alone = error_code_t(45, 'MUST FOLLOW THE CARD TO WHICH IT APPLIES'), &
      toler_none = error_code_t(46, 'IS A TOLERANCE FOR A FIELD THAT CANNOT HAVE ONE'), &
      toler_placed = error_code_t(48, 'IS FOR A PLACE THAT TWO LENGTHS GIVE: PUT IT BELOW THE LENGTH CARDS'), &
      toler_link = error_code_t(44, 'IS NO LINK OF THE JOINT ABOVE: NAME ONE OF ITS LINKS, OR BOTH', own_layout)
   ! Names.
   type(error_code_t), parameter, public :: &
      name_repeated = error_code_t(50, 'IS A NAME DEFINED TWICE; FIRST ON CARD'), &
      link_unknown = error_code_t(51, 'IS NOT THE NAME OF A LINK', own_layout), &
      point_unknown = error_code_t(52, 'IS NOT THE NAME OF A POINT', own_layout), &
      pair_unknown = error_code_t(53, 'IS NOT THE NAME OF A PAIR', own_layout), &
      measure_unknown = error_code_t(47, 'IS NOT THE NAME OF A MEASURE', own_layout), &
      summand_unknown = error_code_t(55, 'IS NOT THE NAME OF A PAIR OR MEASURE', own_layout), &
      side_unknown = error_code_t(59, 'IS NOT THE NAME OF A LINE OR LINK', own_layout), &
      side_twofold = error_code_t(67, 'IS A LINE AND A LINK: RENAME ONE'), &
      point_twice = error_code_t(62, 'IS NAMED TWICE: NAME TWO POINTS'), &
      sum_refused = error_code_t(61, 'CANNOT BE ADDED: A LENGTH AND AN ANGLE, OR A SUM THAT CONTAINS ITSELF'), &
      link_unused = error_code_t(54, 'IS A LINK WITHOUT PAIR OR DRIVE, AND NO OTHER LINK MOVES')
   ! Numbers that vary.
   type(error_code_t), parameter, public :: &
      vary_number = error_code_t(56, 'IS NO NUMBER OF THE CARD ABOVE: NAME ONE, R1, R2 OR R3', own_layout), &
      vary_count = error_code_t(57, 'MUST BE LIST OR THE NUMBER OF VALUES, FROM 1 TO', own_layout), &
      vary_equal = error_code_t(58, 'EQUALS THE FIRST VALUE: A RANGE NEEDS TWO DIFFERENT VALUES'), &
      ratio_drives = error_code_t(66, 'HAS SEVERAL DRIVES: EXTREMES OF ITS RATIOS ARE NOT SEARCHED'), &
      vary_tie = error_code_t(63, 'TIES NUMBERS WITH DIFFERENT COUNTS OF VALUES; SEE CARD'), &
      vary_many = error_code_t(64, 'THE GRID HAS TOO MANY VARIANTS; ALLOWED:')
   ! Pairs and drives.
   type(error_code_t), parameter, public :: &
      pair_one_link = error_code_t(60, 'JOINS TWO POINTS OF ONE LINK OR OF GROUND', own_layout), &
      cylinder_drawing = error_code_t(65, 'A CYLINDER NEEDS A DRAWING, THAT IS JOINT CARDS; OTHERWISE USE PRISM'), &
      cylinder_points = error_code_t(69, 'BOTH POINTS ARE DRAWN AT ONE PLACE: THE CYLINDER HAS NO DIRECTION'), &
      cylinder_stroke = error_code_t(78, 'IS NOT ABOVE THE LEAST LENGTH: GIVE THE LEAST LENGTH FIRST'), &
      cylinder_begins = error_code_t(109, &
         'THE CYLINDER BEGINS AT A LENGTH OF 0 OR LESS: FOR A SLIDE THROUGH 0 USE PRISM'), &
      word_unknown = error_code_t(70, 'IS NOT ONE OF', own_layout), &
      is_ground = error_code_t(71, 'IS GROUND: NAME WHAT MOVES'), &
      drive_one_link = error_code_t(74, 'IS NAMED TWICE: NAME TWO LINKS'), &
      drive_revolute = error_code_t(75, 'IS A REVOLUTE PAIR, WHICH HAS NO SLIDE'), &
      power_negative = &
         error_code_t(79, 'MUST HAVE AN INTEGER POWER, SINCE T < 0 AT THE INSTANT', own_layout), &
      power_zero = &
         error_code_t(80, 'AT T = 0 THE POWER MUST BE 0, 1, OR AT LEAST 2; BEGIN LATER THAN', own_layout), &
      table_short = error_code_t(81, 'HAS ONE ROW: A TABLE NEEDS AT LEAST TWO'), &
      table_order = error_code_t(82, 'IS NOT LATER THAN THE ROW ABOVE: TIMES OF A TABLE INCREASE'), &
      table_range = error_code_t(83, 'HAS NO ROWS AROUND THE INSTANT'), &
      power_large = error_code_t(84, 'OVERFLOWS (R1 T**R2) AT THE INSTANT'), &
      rpm_unit = error_code_t(68, 'IS ONLY ALLOWED IF THE UNIT OF TIME IS S, MS, MIN OR H')
   ! Drawings with lengths, and axes along bars.
   type(error_code_t), parameter, public :: &
      bar_drawing = error_code_t(72, 'NEEDS A DRAWING, THAT IS JOINT CARDS: AXES ALONG A BAR BEGIN AT A JOINT'), &
      bar_joint = error_code_t(73, 'IS NOT A JOINT OF THIS LINK', own_layout), &
      bar_place = error_code_t(76, 'IS DRAWN AT THE PLACE OF THE OTHER JOINT: THE AXES HAVE NO DIRECTION'), &
      length_apart = &
         error_code_t(90, 'IS ON NO LINK OF THE POINT BEFORE IT: NAME POINTS OF ONE LINK OR OF GROUND', own_layout), &
      length_several = error_code_t(91, 'BOTH POINTS ARE ON SEVERAL LINKS: NAME ONE OF THESE LINKS', own_layout), &
      length_off = error_code_t(92, 'IS NOT A LINK OF BOTH POINTS', own_layout), &
      length_place = error_code_t(93, 'IS DRAWN AT THE PLACE OF THE OTHER POINT: DRAW THEM APART'), &
      length_exact = error_code_t(94, 'HAS EXACT COORDINATES, COUNTED ALONG THE BAR OF ITS LINK: OMIT ITS LENGTH'), &
      length_used = error_code_t(95, 'WOULD MOVE AFTER ITS USE: EXCHANGE THE TWO POINTS; IT WAS USED ON CARD'), &
      length_third = error_code_t(97, 'HAS TWO LENGTHS ALREADY: REMOVE ONE OF THE THREE; FIRST ON CARD'), &
      length_missing = error_code_t(99, 'DOES NOT MEET THE OTHER LENGTH OF THIS POINT; MISSING'), &
      length_side = error_code_t(86, 'IS DRAWN IN LINE WITH BOTH OTHER POINTS: DRAW IT ON ITS SIDE OF THEM'), &
      length_open = error_code_t(88, 'IS NOT KEPT WHEN ALL LENGTHS ARE PUT; THE POINTS ARE APART BY')
   ! Times and options.
   type(error_code_t), parameter, public :: &
      time_point = error_code_t(85, 'EQUALS T0: USE AN AT CARD FOR ONE INSTANT'), &
      turns_drive = error_code_t(77, 'NEEDS ONE DRIVE WITH A RATE: ANGLE OR RELANGLE, WITHOUT ADD, RISE OR ' &
         //'ACCELERATION'), &
      newton_needed = error_code_t(87, 'REQUIRES METHOD NEWTON'), &
      units_place = error_code_t(89, 'IS A UNIT OF ANGLES: IT BELONGS IN COLUMNS 17-24 (LABEL-B)', own_layout), &
      repeated = error_code_t(96, 'IS REPEATED; FIRST ON CARD'), &
      extremes_time = error_code_t(98, 'NEEDS A TIME CARD: IT SEARCHES BETWEEN THE INSTANTS OF TIME'), &
      centre_still = error_code_t(100, 'HAS NO RELATIVE MOTION: BOTH ARE ON ONE LINK OR ON GROUND'), &
      centre_apart = error_code_t(107, 'IS IN ANOTHER INDEPENDENT MECHANISM: NAME A GROUND LINK INSTEAD')

contains

   !> Adds an error to the errors of a deck. Above its sentence stand the card, a ruler in tens up to the end of the
   !> card or to the mark, and the mark under the column.
   subroutine add_error(errors, code, card, field, column, text, more)
      type(input_errors_t), intent(inout) :: errors   !< gets the error
      type(error_code_t), intent(in) :: code !< its number and sentence
      type(card_t), intent(in) :: card       !< the wrong card; its number is 0: the whole deck is wrong
      type(field_t), intent(in) :: field     !< the field in which the text begins
      integer, intent(in) :: column          !< of the card at which the text begins
      character(*), intent(in) :: text       !< the wrong text; '': none
      character(*), intent(in), optional :: more   !< the end of the sentence, if it has one
      character(1), parameter :: next = new_line('a')
      character(:), allocatable :: lines, head, shown, margin, address
      character(3) :: number
      integer :: form, tens

      errors%count = errors%count + 1
      if (errors%count > max_printed) return
      lines = ''
      if (allocated(errors%lines)) lines = errors%lines//next
      address = ''
      form = code%layout
      if (card%number > 0) then
         head = whole(card%number)//' |'
         head = ' CARD '//repeat(' ', max(6 - len(head), 0))//head
         shown = trim(card%text)
         ! Text beyond the last column is shown if there is room for it in a line.
         if (card%overrun > 0 .and. card%overrun <= card_columns + 10) &
            shown = card%text//repeat(' ', card%overrun - card_columns - 1)//trim(card%beyond)
         margin = next//repeat(' ', len(head) - 1)//'|'
         tens = min(max(len(shown)/10, (column + 9)/10), card_columns/10 + 1)
         lines = lines//head//printable(shown)//margin//ruler(:10*tens)
         if (column <= 10*tens) lines = lines//margin//repeat(' ', column - 1)//'^'
         lines = lines//next

         address = 'CARD '//whole(card%number)//'  COLUMN '//whole(column)//'  FIELD '//trim(field%name)//': '
         if (text /= '') address = address//'"'//printable(trim(text))//'" '
         ! Without a text the sentence would have no subject.
         if (text == '' .and. index(code%sentence, 'IS ') == 1) address = address//'A BLANK FIELD '
         if (form == own_layout) form = find_form(card%text(:label_length))
      end if

      write (number, '(i3.3)') code%number
      lines = lines//' *** E'//number//'  '//address//trim(code%sentence)
      if (present(more)) lines = trim(lines//' '//more)
      if (form /= form_unknown) lines = lines//next//' LAYOUT    |'//trim(card_forms(form)%layout)
      call move_alloc(lines, errors%lines)
   end subroutine add_error

   !> Adds an error about the whole text in a field of a card to the errors of a deck.
   subroutine add_field_error(errors, code, card, field, more, place)
      type(input_errors_t), intent(inout) :: errors   !< gets the error
      type(error_code_t), intent(in) :: code !< its number and sentence
      type(card_t), intent(in) :: card       !< the wrong card
      type(field_t), intent(in) :: field     !< a field of the card
      character(*), intent(in), optional :: more   !< the end of the sentence, if it has one
      integer, intent(in), optional :: place   !< character of the text under which the mark stands; else 1
      integer :: column

      column = first_column(card, field)
      if (present(place)) column = column + place - 1
      call add_error(errors, code, card, field, column, field_text(card, field), more)
   end subroutine add_field_error

   !> Adds a remark about a card of the open set. Beyond `max_printed` remarks are only counted.
   subroutine add_remark(errors, kind, card, column, text, value)
      type(input_errors_t), intent(inout) :: errors   !< gets the remark
      integer, intent(in) :: kind            !< remark_title_long, ...
      integer, intent(in) :: column          !< of the card at which the text begins
      type(card_t), intent(in) :: card       !< that the remark is about
      character(*), intent(in) :: text       !< of the card, or names of drives; '': none
      character(*), intent(in), optional :: value   !< the end of the sentence, if it has one
      integer :: n

      errors%remarked = errors%remarked + 1
      n = min(errors%remarked, size(errors%remarks))
      errors%remarks(n) = remark_t(kind, card%number, column, text)
      if (present(value)) errors%remarks(n)%value = value
      if (n > max_printed) errors%remarks(n) = remark_t(remark_more, text=whole(errors%remarked - max_printed))
   end subroutine add_remark

   !> Gives the text that ends the error of an unknown name: the nearest name.
   pure function near_name(name) result(text)
      character(*), intent(in) :: name       !< the nearest name
      character(:), allocatable :: text

      text = '(NEAREST NAME: '//trim(name)//')'
   end function near_name

   !> Gives all error messages of a deck, lines joined by new_line('a'); '' if there is no error.
   pure function error_report(errors) result(report)
      type(input_errors_t), intent(in) :: errors   !< of a deck
      character(:), allocatable :: report

      report = ''
      if (allocated(errors%lines)) report = errors%lines
      if (errors%count > max_printed) &
         report = report//new_line('a')//' *** AND '//whole(errors%count - max_printed)//' MORE'
   end function error_report

   !> Gives a text with ? in place of each byte that is not printable ASCII, so that every column stays one character
   !> wide.
   pure function printable(text) result(shown)
      character(*), intent(in) :: text       !< any bytes of a card
      character(len(text)) :: shown
      integer :: i

      shown = text
      do i = 1, len(text)
         if (ichar(text(i:i)) < 32 .or. ichar(text(i:i)) > 126) shown(i:i) = '?'
      end do
   end function printable
end module input_errors
