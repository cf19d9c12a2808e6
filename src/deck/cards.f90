!> One card: its 80 columns, its fields by column, and the forms of cards: which fields each card takes. Fields and
!> forms are declared only here. A new card is one enumerator and one line of `card_forms`.
module cards
   use kinds, only: label_length
   use failures, only: capitals
   implicit none
   private :: label_length, capitals, form_t, star_layout

   !> Columns of a card.
   integer, parameter :: card_columns = 80

   !> A card as it stands in the deck: one line.
   type :: card_t
      integer :: number = 0                 !< number of the line in the deck, from 1; 0: no card
      integer :: overrun = 0                !< first column past 80 that is not blank; 0: none
      character(card_columns) :: text = ''  !< columns 1 to 80
      character(24) :: beyond = ''          !< the beginning of the text from column `overrun` on
   end type card_t

   !> A field: some columns of a card.
   type :: field_t
      character(8) :: name = ''             !< as messages and the ruler show it
      integer :: first = 1, last = 0        !< its first and its last column
   end type field_t

   !> The fields of a card in the order of their columns: field i + 1 begins where field i ends.
   enum, bind(c)
      enumerator :: card_name = 1, label_a, label_b, label_c, real_1, real_2, real_3
   end enum
   type(field_t), parameter :: card_fields(7) = [field_t('NAME', 1, 8), field_t('LABEL-A', 9, 16), &
      field_t('LABEL-B', 17, 24), field_t('LABEL-C', 25, 32), field_t('REAL-1', 33, 48), field_t('REAL-2', 49, 64), &
      field_t('REAL-3', 65, 80)]
   !> The reals of a `*` card: wide enough for every double.
   type(field_t), parameter :: wide_fields(3) = &
      [field_t('REAL-1', 9, 32), field_t('REAL-2', 33, 56), field_t('REAL-3', 57, 80)]
   !> The field of the TITLE card, in place of all labels and reals.
   type(field_t), parameter :: title_field = field_t('TITLE', 9, 80)

   !> The comment card that shows the columns of all fields.
   character(card_columns), parameter :: ruler_card = &
      '$NAME---LABEL-A|LABEL-B|LABEL-C|REAL-1---------|REAL-2---------|REAL-3---------|'

   !> The fields that a card takes.
   type :: form_t
      !> A letter for each label field: L for a label, W for a whole number, a small letter if the field may be blank, -
      !> if it must be blank.
      character(3) :: labels = '---'
      integer :: reals = 0           !< number of real fields, from REAL-1 on
      logical :: once = .false.      !< at most one such card in a set
      character(78) :: layout = ''   !< the name of the card, then the word of each field in its columns
   end type form_t

   !> The forms of cards: indices in `card_forms`.
   enum, bind(c)
      enumerator :: form_unknown = 0, form_title, form_units, form_lang, form_ground, form_link, form_point
      enumerator :: form_revolute, form_prism, form_slot, form_cylinder, form_joint, form_drive, form_add, form_rise
      enumerator :: form_length, form_toler
      enumerator :: form_time, form_at, form_method, form_print, form_column, form_extremes, form_range, form_circuits
      enumerator :: form_pole, form_curve, form_branch, form_vary, form_assembly, form_prove
      enumerator :: form_distance, form_line, form_angle, form_xi, form_eta, form_sum, form_end
   end enum

   !> The fields of all forms. The text of TITLE is not a label.
   type(form_t), parameter :: card_forms(form_end) = [ &
      form_t('---', 0, .true.,  'TITLE   TEXT, COLUMNS 9 TO 80'), &
      form_t('lll', 0, .true.,  'UNITS   LENGTH  RAD/DEG TIME'), &
      form_t('L--', 0, .true.,  'LANG    EN/PL'), &
      form_t('L--', 3, .false., 'GROUND  LINK                    X               Y               PHI'), &
      form_t('Lll', 3, .false., 'LINK    LINK    FROM    TO      X               Y               PHI'), &
      form_t('LL-', 2, .false., 'POINT   POINT   LINK            XI              ETA'), &
      form_t('LLL', 0, .false., 'REVOLUTEPOINT-I POINT-J PAIR'), &
      form_t('LLL', 3, .false., 'PRISM   POINT-I POINT-J PAIR    ALPHA           H               BETA'), &
      form_t('LLL', 2, .false., 'SLOT    POINT-I POINT-J PAIR    ALPHA           H'), &
      form_t('LLL', 2, .false., 'CYLINDERPOINT-P POINT-Q PAIR    LEAST           GREATEST'), &
      form_t('LLL', 2, .false., 'JOINT   PAIR    LINK-I  LINK-J  X               Y'), &
      ! Drives and lengths.
      form_t('LLl', 3, .false., 'DRIVE   KIND    DRIVEN  2ND/RPM VALUE AT 0.0    RATE            ACCELERATION'), &
      form_t('L--', 3, .false., 'ADD     KIND                    R1              R2              R3'), &
      form_t('L--', 3, .false., 'RISE    LAW                     START           DURATION        LIFT'), &
      form_t('LLl', 1, .false., 'LENGTH  POINT-P POINT-Q LINK    LENGTH'), &
      form_t('l--', 3, .false., 'TOLER   LINK                    OF R1           OF R2           OF R3'), &
      ! The run and the method, and rows.
      form_t('Wl-', 2, .true.,  'TIME    STEPS   TURNS           T0              T1/TURNS'), &
      form_t('---', 3, .false., 'AT                              T               T               T'), &
      form_t('l--', 2, .true.,  'METHOD  METHOD                  TOLERANCE       CLOSING'), &
      form_t('Llw', 0, .false., 'PRINT   KIND    NAME    EVERY'), &
      form_t('LLl', 0, .false., 'COLUMN  KIND    NAME    QUANTITY'), &
      form_t('Ll-', 2, .false., 'EXTREMESKIND    NAME            DWELL LENGTH    DWELL ANGLE'), &
      form_t('---', 0, .true.,  'RANGE'), &
      form_t('---', 0, .true.,  'CIRCUITS'), &
      form_t('LLw', 0, .false., 'POLE    LINK-I  LINK-J  EVERY'), &
      form_t('Llw', 0, .false., 'CURVE   POINT   LINK    EVERY'), &
      form_t('l--', 1, .false., 'BRANCH  LINK                    T'), &
      form_t('LLl', 3, .false., 'VARY    R1/2/3  N/LIST  TIE     FROM/VALUE      TO/VALUE        VALUE'), &
      form_t('---', 0, .true.,  'ASSEMBLY'), &
      form_t('---', 0, .true.,  'PROVE'), &
      ! Measures.
      form_t('LLL', 0, .false., 'DISTANCEPOINT-P POINT-Q MEASURE'), &
      form_t('LLL', 0, .false., 'LINE    POINT-P POINT-Q MEASURE'), &
      form_t('LLL', 0, .false., 'ANGLE   FROM    TO      MEASURE'), &
      form_t('LLL', 0, .false., 'XI      POINT   LINK    MEASURE'), &
      form_t('LLL', 0, .false., 'ETA     POINT   LINK    MEASURE'), &
      form_t('LlL', 3, .false., 'SUM     A       B       MEASURE C1              C2              C0'), &
      form_t('---', 0, .false., 'END')]
   !> The layout of the `*` card, by `wide_fields`.
   character(*), parameter :: star_layout = '*       R1 OF THE CARD ABOVE    R2                      R3'

contains

   !> Gives the text of a card in a field, without blanks before and after the text; '' for a blank field.
   pure function field_text(card, field) result(text)
      type(card_t), intent(in) :: card       !< a line of the deck
      type(field_t), intent(in) :: field     !< columns of the card
      character(:), allocatable :: text

      text = trim(adjustl(card%text(field%first:field%last)))
   end function field_text

   !> Finds the column of the first character of a field that is not blank; the first column of a blank field.
   pure integer function first_column(card, field) result(column)
      type(card_t), intent(in) :: card       !< a line of the deck
      type(field_t), intent(in) :: field     !< columns of the card

      column = field%first + max(verify(card%text(field%first:field%last), ' '), 1) - 1
   end function first_column

   !> Tells whether a card is a comment ($, # or ! before all else) or blank: such cards are skipped.
   pure logical function is_passed_over(card)
      type(card_t), intent(in) :: card       !< a line of the deck
      integer :: first

      first = max(verify(card%text, ' '), 1)
      is_passed_over = scan(card%text(first:first), '$#!') > 0 .or. (card%text == '' .and. card%overrun == 0)
   end function is_passed_over

   !> Gives the ruler and, below it, the layout of a card, or the layouts of all cards, the `*` card last; lines are
   !> joined by new_line('a'). An unknown name gives only the ruler.
   pure function layout_of(name) result(text)
      character(*), intent(in) :: name       !< of the card, in capitals or small letters; '': all cards
      character(:), allocatable :: text
      integer :: form

      text = ruler_card
      do form = 1, size(card_forms)
         if (name == '' .or. form == find_form(name)) text = text//new_line('a')//trim(card_forms(form)%layout)
      end do
      if (name == '') text = text//new_line('a')//star_layout
   end function layout_of

   !> Counts the real fields that a card takes, from REAL-1 on.
   pure integer function reals_of(form, word) result(reals)
      integer, intent(in) :: form            !< of the card: form_title, ...; form_unknown: it takes none
      character(label_length), intent(in) :: word   !< its label A

      reals = 0
      if (form /= form_unknown) reals = card_forms(form)%reals
      if (form /= form_add) return
      if (any(word == ['POWER', 'TABLE'])) reals = 2
   end function reals_of

   !> Gives the name that the cards of a form have in columns 1 to 8.
   pure character(label_length) function form_name(form)
      integer, intent(in) :: form            !< form_title, ..., form_end

      form_name = card_forms(form)%layout(:label_length)
   end function form_name

   !> Finds the index of the first word in a list that differs from a name by one slip of typing (`is_near`); 0 if there
   !> is none.
   pure integer function nearest_word(name, words) result(number)
      character(*), intent(in) :: name       !< the name for which a word is sought
      character(*), intent(in) :: words(:)   !< (any number) the words

      do number = 1, size(words)
         if (is_near(name, words(number))) return
      end do
      number = 0
   end function nearest_word

   !> Tells whether a word becomes another word if at most one letter is changed, left out or added, or if two
   !> neighbouring letters are exchanged. Two names of one letter are never near.
   pure logical function is_near(word, other)
      character(*), intent(in) :: word, other   !< the two words
      character(max(len(word), len(other)) + 2) :: x, y
      integer :: i

      x = word
      y = other
      do i = 1, len(x) - 2
         if (x(i:i) /= y(i:i)) exit
      end do
      is_near = x(i + 1:) == y(i + 1:) .or. x(i:) == y(i + 1:) .or. x(i + 1:) == y(i:) .or. &
         x(i:) == y(i + 1:i + 1)//y(i:i)//y(i + 2:)
      is_near = is_near .and. max(len_trim(word), len_trim(other)) > 1
   end function is_near

   !> Finds the form of the cards with a given name; form_unknown if no form has this name.
   pure integer function find_form(name) result(form)
      character(*), intent(in) :: name       !< in capitals or small letters
      character(label_length) :: word

      if (len_trim(name) <= label_length) then
         word = capitals(name)
         do form = 1, size(card_forms)
            if (card_forms(form)%layout(:label_length) == word) return
         end do
      end if
      form = form_unknown
   end function find_form
end module cards
