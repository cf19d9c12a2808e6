!> Level 2. The catalogue of what can be wrong with a deck: a code and its sentence, each declared once.
!> A complaint reads `"text" SENTENCE`, or only the sentence; some sentences are completed by the caller.
module deck_codes
   use kinds, only: wp
   implicit none
   private
   public :: code_t

   type :: code_t
      integer :: number = 0
      character(72) :: sentence = ''
   end type code_t

   ! The deck and its sets.
   type(code_t), parameter, public :: &
      deck_empty = code_t(1, 'THE DECK IS EMPTY'), &
      end_missing = code_t(2, 'IS THE LAST CARD OF THE DECK, BUT NOT END'), &
      set_empty = code_t(3, 'CLOSES A SET WITHOUT CARDS'), &
      link_missing = code_t(4, 'CLOSES A SET WITHOUT A LINK CARD'), &
      time_missing = code_t(5, 'CLOSES A SET WITHOUT A TIME OR AT CARD'), &
      deck_long = code_t(6, 'THE DECK IS TOO LONG; CARDS ALLOWED:')
   ! A card as a whole, and its characters.
   type(code_t), parameter, public :: &
      card_unknown = code_t(10, 'IS NOT THE NAME OF A CARD'), &
      card_lower_case = code_t(11, 'CARD NAMES ARE IN CAPITALS'), &
      card_indented = code_t(12, 'THE CARD NAME MUST BEGIN IN COLUMN 1'), &
      card_repeated = code_t(13, 'MAY STAND ONCE IN A SET; FIRST ON CARD'), &
      past_last_column = code_t(14, 'STANDS PAST COLUMN 80'), &
      tab_character = code_t(15, 'IS OR HOLDS A TAB'), &
      control_character = code_t(16, 'IS OR HOLDS A CONTROL CHARACTER'), &
      foreign_character = code_t(17, 'IS OR HOLDS A CHARACTER THAT IS NOT ASCII'), &
      border_crossed = code_t(18, 'RUNS ACROSS THE BORDER OF COLUMNS'), &
      field_unused = code_t(19, 'THIS FIELD IS NOT USED BY THIS CARD')
   ! Numbers: those whose squares are in range, and the squares of these.
   integer, parameter, public :: most_power = min(60, int(0.25*range(1.0_wp)))
   character(*), parameter :: power_text = trim(merge('60', '9 ', most_power == 60))
   type(code_t), parameter, public :: &
      number_other = code_t(20, 'IS NOT A NUMBER'), &
      number_letter_o = code_t(21, 'IS NOT A NUMBER (LETTER O)'), &
      number_letter_l = code_t(22, 'IS NOT A NUMBER (LETTER L OR I)'), &
      number_blank = code_t(23, 'IS NOT A NUMBER (EMBEDDED BLANK)'), &
      number_comma = code_t(24, 'IS NOT A NUMBER (DECIMAL COMMA)'), &
      number_sign = code_t(25, 'IS NOT A NUMBER (SIGN INSIDE: EXPONENT WITHOUT E?)'), &
      number_nan = code_t(26, 'IS NOT A NUMBER (NAN)'), &
      number_inf = code_t(27, 'IS NOT A FINITE NUMBER'), &
      number_overflow = code_t(28, 'IS TOO LARGE A NUMBER: THE LARGEST IS 1E'//power_text), &
      number_underflow = code_t(29, 'IS TOO SMALL A NUMBER: THE LEAST BESIDE ZERO IS 1E-'//power_text), &
      number_no_point = code_t(30, 'A REAL NUMBER NEEDS A POINT OR AN EXPONENT'), &
      number_point = code_t(31, 'A WHOLE NUMBER HAS NO POINT AND NO EXPONENT'), &
      number_no_digits = code_t(32, 'IS NOT A NUMBER (NO DIGITS)'), &
      number_exponent = code_t(33, 'IS NOT A NUMBER (NO DIGITS IN THE EXPONENT)')
   ! Fields, and the continuation by a `*` card.
   type(code_t), parameter, public :: &
      field_blank = code_t(34, 'THIS FIELD MUST NOT BE BLANK'), &
      label_blank_inside = code_t(35, 'A LABEL HAS NO BLANKS INSIDE'), &
      number_range = code_t(36, 'IS OUT OF THE RANGE'), &
      star_first = code_t(40, 'NO CARD STANDS ABOVE THIS ONE IN THE SET'), &
      star_no_reals = code_t(41, 'THE CARD ABOVE TAKES NO REALS'), &
      star_second = code_t(42, 'IS A SECOND * CARD FOR THE SAME CARD'), &
      star_twice = code_t(43, 'IS GIVEN TWICE: THE CARD ABOVE HAS IT TOO'), &
      star_blank = code_t(44, 'GIVES NO NUMBERS')
   ! Names.
   type(code_t), parameter, public :: &
      name_repeated = code_t(50, 'THIS NAME IS REPEATED; FIRST ON CARD'), &
      link_unknown = code_t(51, 'NO LINK HAS THIS NAME'), &
      point_unknown = code_t(52, 'NO POINT HAS THIS NAME'), &
      pair_unknown = code_t(53, 'NO PAIR HAS THIS NAME'), &
      link_unused = code_t(54, 'NO PAIR AND NO DRIVE USES THIS LINK'), &
      point_unused = code_t(55, 'NO PAIR, DRIVE OR PRINT CARD USES THIS POINT')
   ! Pairs and drives.
   type(code_t), parameter, public :: &
      pair_one_link = code_t(60, 'JOINS TWO POINTS OF ONE LINK'), &
      pair_grounds = code_t(61, 'JOINS TWO GROUND LINKS'), &
      drive_kind = code_t(70, 'IS NOT ANGLE, X, Y, RELANGLE OR SLIDE'), &
      drive_ground = code_t(71, 'A GROUND LINK CANNOT BE DRIVEN'), &
      drive_ground_point = code_t(72, 'A POINT OF A GROUND LINK CANNOT BE DRIVEN'), &
      drive_grounds = code_t(73, 'BOTH LINKS ARE GROUND LINKS'), &
      drive_one_link = code_t(74, 'BOTH LINKS ARE THE SAME'), &
      drive_revolute = code_t(75, 'A REVOLUTE PAIR HAS NO SLIDE'), &
      add_alone = code_t(76, 'NO DRIVE OR ADD CARD STANDS ABOVE THIS ONE'), &
      add_kind = code_t(77, 'IS NOT HARMONIC, POWER OR TABLE'), &
      add_blank = code_t(78, 'GIVES NO NUMBERS'), &
      power_negative = code_t(79, 'THIS POWER DOES NOT EXIST AT THE INSTANT'), &
      power_zero = code_t(80, 'THIS POWER OR ITS DERIVATIVES DO NOT EXIST AT THE INSTANT'), &
      power_large = code_t(84, 'THIS POWER IS TOO LARGE A NUMBER AT THE INSTANT'), &
      table_short = code_t(81, 'A TABLE NEEDS AT LEAST TWO ROWS'), &
      table_order = code_t(82, 'THE TIMES OF A TABLE MUST INCREASE'), &
      table_range = code_t(83, 'THIS TABLE DOES NOT REACH THE INSTANT')
   ! Times and options.
   type(code_t), parameter, public :: &
      time_point = code_t(85, 'T0 AND T1 ARE EQUAL'), &
      branch_ground = code_t(86, 'A GROUND LINK HAS NO OTHER BRANCH'), &
      branch_method = code_t(87, 'ONLY METHOD NEWTON TAKES ANOTHER BRANCH'), &
      branch_repeated = code_t(88, 'THIS BRANCH CARD IS REPEATED; FIRST ON CARD'), &
      lang_kind = code_t(90, 'IS NOT EN OR PL'), &
      units_angle = code_t(91, 'IS NOT RAD OR DEG'), &
      units_place = code_t(89, 'IS A UNIT OF ANGLES, WHICH STANDS IN COLUMNS 17-24 (LABEL-B)'), &
      method_kind = code_t(92, 'IS NOT NEWTON, DENSE OR MATRIX'), &
      tolerance_range = code_t(93, 'A TOLERANCE IS ABOVE 1E-15 AND AT MOST 1E-2'), &
      print_kind = code_t(94, 'IS NOT ALL, LINKS, POINTS OR PAIRS'), &
      print_all_name = code_t(95, 'PRINT ALL TAKES NO NAME'), &
      print_repeated = code_t(96, 'THIS PRINT CARD IS REPEATED; FIRST ON CARD'), &
      print_nothing = code_t(97, 'THE SET HAS NONE OF THESE')
end module deck_codes
