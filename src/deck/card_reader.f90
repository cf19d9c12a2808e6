!> Reads a card to its labels, whole number and reals, and checks every field. The modules deck_... and card_sets give
!> fields a meaning. Harmless faults are remarks, all others errors.
module card_reader
   use kinds, only: wp, label_length
   use mechanism, only: remark_title_long, remark_title_letters, remark_touching
   use cards
   use input_errors
   use failures, only: capitals
   use numbers, only: read_real, read_whole
   use number_format, only: whole
   implicit none
   private
   public :: parsed_card_t, read_card, read_star, refuse_field, find_long_label

   !> A card as it was read. A wrong card is kept too, so that other cards find its names.
   type :: parsed_card_t
      type(card_t) :: card
      type(card_t), allocatable :: star         !< the `*` card below it
      integer :: form = form_unknown            !< its index in `card_forms`
      logical :: valid = .true.                 !< neither the card nor its `*` card has an error of its own
      logical :: names_certain = .true.         !< its form and labels are as meant, even if it is not valid
      character(label_length) :: label(label_a:label_c) = ''   !< in capitals
      integer :: whole = 0                      !< the whole number in a label field
      logical :: whole_given = .false.          !< the field of the whole number is not blank
      real(wp) :: real(3) = 0.0_wp              !< in the deck's units; 0 where the field is blank
      logical :: given(3) = .false.             !< the field of the real is not blank
      logical :: on_star(3) = .false.           !< the real is on the `*` card
      !> The number of the link, point (of JOINT the first), pair or drive that it defines; 0: none is built.
      integer :: subject = 0
      !> Of an ADD or RISE card the number of its term, and its row in a table, otherwise 1; of other cards 0.
      integer :: term = 0, row = 0
      integer :: below = 0                      !< number of the card above, TOLER and VARY left out; 0: none
   end type parsed_card_t

   !> The largest length, angle or time: larger numbers have no use, and their fourth powers could overflow.
   real(wp), parameter :: max_real = 10.0_wp**max_power
   !> The smallest length, angle or time above zero: fourth powers of smaller numbers could underflow.
   real(wp), parameter :: min_real = 10.0_wp**(-max_power)

contains

   !> Reads a card that is not a `*` card. Its errors are added in the order of the columns.
   subroutine read_card(card, parsed, errors)
      type(card_t), intent(in) :: card       !< of any name but `*`
      type(parsed_card_t), intent(out) :: parsed   !< the card as it was read, right or wrong
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      type(error_code_t) :: code
      character(:), allocatable :: name
      logical :: cut(size(card_fields))
      integer :: before, last, i, near

      before = errors%count
      parsed%card = card
      last = len_trim(card%text)
      do i = label_a, label_c
         if (card_fields(i)%first > last) exit
         parsed%label(i) = card%text(card_fields(i)%first:card_fields(i)%last)
         if (parsed%label(i)(1:1) <= ' ') parsed%label(i) = adjustl(parsed%label(i))
      end do

      parsed%form = find_form(card%text(:label_length))
      if (parsed%form == form_title) call read_title(parsed%card, errors)
      call check_characters(parsed%card, parsed%names_certain, errors)
      parsed%label = capitals(parsed%label)

      if (errors%count == before .and. parsed%form == form_unknown) then
         name = field_text(card, card_fields(card_name))
         parsed%form = find_form(name)
         near = nearest_word(capitals(name), card_forms%layout(:label_length))

         if (name == '') then
            call add_field_error(errors, field_blank, card, card_fields(card_name))
         else if (parsed%form /= form_unknown) then
            call add_field_error(errors, card_indented, card, card_fields(card_name))
         else if (find_form(name(:index(name//' ', ' ') - 1)) /= form_unknown) then
            call refuse_free(card, parsed%form, errors)
         else if (near > 0) then
            code = card_unknown
            code%layout = near
            call add_field_error(errors, code, card, card_fields(card_name), near_name(form_name(near)))
         else
            call add_field_error(errors, card_unknown, card, card_fields(card_name))
         end if
      else if (errors%count == before .and. is_free(parsed, errors%is_free)) then
         call refuse_free(card, parsed%form, errors)
      end if

      parsed%names_certain = parsed%names_certain .and. parsed%form /= form_unknown
      parsed%valid = errors%count == before .and. parsed%form /= form_unknown
      if (.not. parsed%valid .or. parsed%form == form_title) return

      ! The reals, and the label fields that the card does not take, may hold the beginning of a number.
      call find_cuts(card, card_fields, 'L'//card_forms(parsed%form)%labels//'---', cut, errors)
      parsed%names_certain = .not. any(cut(label_a:label_c))
      call read_labels(parsed, cut(label_a:label_c), errors)
      do i = 1, 3
         if (card_fields(label_c + i)%first > last) exit
         if (.not. cut(label_c + i)) call read_real_field(parsed, card, card_fields(label_c + i), i, errors)
      end do
      parsed%valid = errors%count == before
   end subroutine read_card

   !> Tells whether a card is in free format: after its name all blanks are single, and a label field has a blank
   !> inside. The first such card of a deck must also have a name that fills its field, and a blank after the name.
   pure logical function is_free(parsed, in_free_deck)
      type(parsed_card_t), intent(in) :: parsed   !< a card with a known name
      logical, intent(in) :: in_free_deck    !< an earlier card of the deck was in free format
      integer :: i

      is_free = .false.
      associate (text => parsed%card%text, border => card_fields(card_name)%last)
         if (.not. in_free_deck .and. (text(border:border) <= ' ' .or. text(border + 1:border + 1) > ' ')) return
         if (index(trim(text(border + 1:)), '  ') == 0) &
            is_free = any([(index(trim(parsed%label(i)), ' ') > 0, i=label_a, label_c)])
      end associate
   end function is_free

   !> Adds the error of the first card of the deck in free format, about its second word. Later cards in free format
   !> have no error.
   subroutine refuse_free(card, form, errors)
      type(card_t), intent(in) :: card       !< in free format
      integer, intent(out) :: form           !< form_unknown
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      type(error_code_t) :: code
      integer :: first, finish

      form = form_unknown
      if (errors%is_free) return
      errors%is_free = .true.
      first = verify(card%text, ' ')
      finish = first + index(card%text(first:), ' ') - 2
      code = card_free
      code%layout = find_form(card%text(first:finish))
      first = finish + verify(card%text(finish + 1:), ' ')
      finish = first + index(card%text(first:)//' ', ' ') - 2
      call add_error(errors, code, card, card_fields(merge(card_name, label_a, first < card_fields(label_a)%first)), &
         first, card%text(first:finish))
   end subroutine refuse_free

   !> Makes the text of a TITLE card printable: with ? for each letter that is not ASCII, and cut at the last column.
   !> Each of the two changes is a remark.
   subroutine read_title(card, errors)
      type(card_t), intent(inout) :: card    !< a TITLE card; its text changes
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      character(:), allocatable :: title
      integer :: i, first

      title = ''
      first = 0
      do i = title_field%first, card_columns
         associate (code => ichar(card%text(i:i)))
            if (code > 127 .and. first == 0) first = i
            ! Bytes of 128 to 191 continue a character of UTF-8.
            if (code < 128) title = title//card%text(i:i)
            if (code > 191) title = title//'?'
         end associate
      end do
      if (first > 0) call add_remark(errors, remark_title_letters, card, first, '')
      if (card%overrun > 0) call add_remark(errors, remark_title_long, card, card_columns + 1, '')
      card%text(title_field%first:) = title
      card%overrun = 0
   end subroutine read_title

   !> Reads a `*` card, and gives its reals to the card above it. Its errors are added in the order of the columns.
   subroutine read_star(card, above, errors)
      type(card_t), intent(in) :: card       !< the `*` card
      type(parsed_card_t), intent(inout) :: above   !< the card above; gets the reals, `on_star` and `star`
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      integer :: before, i
      logical :: clean, cut(3)

      before = errors%count
      call check_characters(card, clean, errors)

      if (errors%count > before) then
         continue
      else if (field_text(card, card_fields(card_name)) /= '*') then
         if (.not. errors%is_free) call add_field_error(errors, card_unknown, card, card_fields(card_name))
      else if (allocated(above%star)) then
         call add_field_error(errors, card_second, card, card_fields(card_name))
      else if (above%form /= form_unknown) then
         call find_cuts(card, wide_fields, '---', cut, errors)
         do i = 1, 3
            if (cut(i) .or. field_text(card, wide_fields(i)) == '') cycle
            if (above%given(i)) then
               call add_field_error(errors, star_twice, card, wide_fields(i))
            else
               above%on_star(i) = .true.
               call read_real_field(above, card, wide_fields(i), i, errors)
            end if
         end do
      end if

      if (allocated(above%star)) return
      above%star = card
      above%valid = above%valid .and. errors%count == before
   end subroutine read_star

   !> Checks the characters of a card: the first character that is not printable ASCII, or is past column 80, is an
   !> error.
   subroutine check_characters(card, clean, errors)
      type(card_t), intent(in) :: card       !< as it stands in the deck
      logical, intent(out) :: clean          !< columns 1 to 80 are printable ASCII
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      type(field_t) :: field
      integer :: column, last

      last = len_trim(card%text)
      do column = 1, last
         if (card%text(column:column) < ' ' .or. card%text(column:column) > '~') exit
      end do
      clean = column > last
      if (clean) then
         if (card%overrun > 0) &
            call add_error(errors, past_last_column, card, field_t('PAST-80', 81, 81), card%overrun, card%beyond)
         return
      end if
      field = card_fields(findloc(card_fields%last >= column, .true., dim=1))
      call add_error(errors, merge(tab_character, foreign_character, ichar(card%text(column:column)) == 9), card, &
         field, column, field_text(card, field))
   end subroutine check_characters

   !> Finds the fields whose text is cut by a border of fields, and adds an error for each such border. Text on both
   !> sides of a border is in one of these cases:
   !>
   !> - a label fills its field: not cut;
   !> - a number fills its field, and is one number with the text after the border: cut;
   !> - a number fills its field, and ends with an exponent of three digits or of a sign and two: not cut;
   !> - a number fills its field, and the second number has a sign: not cut;
   !> - two numbers without signs between them fill their fields: not cut, a remark;
   !> - a number fills its field, and the second number does not: cut, an error with both readings;
   !> - text does not fill its field, and a number with a sign follows: not cut, a remark;
   !> - any other text that does not fill its field: cut.
   subroutine find_cuts(card, fields, letters, cut, errors)
      type(card_t), intent(in) :: card       !< with the fields
      type(field_t), intent(in) :: fields(:) !< (fields) in the order of their columns, without gaps
      character(*), intent(in) :: letters    !< a character for each field; -: no label, perhaps a number
      logical, intent(out) :: cut(:)         !< (fields) the text of the field is cut
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      integer :: i, start, finish, border
      logical :: numeric, fills

      cut = .false.
      do i = 1, size(fields) - 1
         border = fields(i)%last
         ! No printable character comes before the blank; a test for equality with the blank would cost a call.
         if (cut(i) .or. card%text(border:border) <= ' ' .or. card%text(border + 1:border + 1) <= ' ') cycle
         start = fields(i)%first + index(card%text(fields(i)%first:border), ' ', back=.true.)
         ! Two numbers that fill their fields may touch; the first may have a blank in place of a plus sign.
         numeric = letters(i:i) == '-'
         fills = start <= fields(i)%first + merge(1, 0, numeric)
         if (fills .and. .not. numeric) cycle
         finish = border + index(card%text(border + 1:fields(i + 1)%last)//' ', ' ') - 1

         if (fills .and. .not. is_real(card%text(start:finish))) then
            ! Text that is not a number has an error of its own.
            if (scan(card%text(border + 1:border + 1), '+-') == 1 .or. .not. is_real(card%text(start:border)) .or. &
               .not. is_real(card%text(border + 1:finish))) cycle
            ! An exponent of three digits, or of a sign and two, is complete: programs write exponents so.
            if (scan(card%text(border - 4:border - 4), 'EeDd') == 1) cycle
            if (scan(card%text(border - 3:border - 3), 'EeDd')*scan(card%text(border - 2:border - 2), '+-') == 1) cycle
            if (finish == fields(i + 1)%last) then
               call add_remark(errors, remark_touching, card, border + 1, card%text(border + 1:finish))
            else
               cut(i:i + 1) = .true.
               call add_error(errors, numbers_touch, card, fields(i + 1), border + 1, card%text(border + 1:finish), &
                  readings(card%text(start:border), card%text(border + 1:finish)))
            end if
            cycle
         else if (.not. fills .and. scan(card%text(border + 1:border + 1), '+-') == 1) then
            ! The sign must not belong to the exponent of a number before it; after a label a number must follow.
            if (merge(scan(card%text(border:border), 'EeDd') == 0, is_real(card%text(border + 1:finish)), numeric)) then
               call add_remark(errors, remark_touching, card, border + 1, card%text(border + 1:finish))
               cycle
            end if
         end if

         cut(i:i + 1) = .true.
         if (.not. numeric .and. finish - start >= label_length) then
            call add_error(errors, label_long, card, fields(i), start, card%text(start:finish))
         else
            call add_error(errors, border_crossed, card, fields(i), start, card%text(start:finish), whole(border) &
               //' AND '//whole(border + 1))
         end if
      end do
   end subroutine find_cuts

   !> Gives the readings of two numbers that touch at a border, for a message: cut at the border and, if both parts are
   !> numbers then, cut one column after or before the border.
   pure function readings(first, second) result(text)
      character(*), intent(in) :: first, second   !< the texts before and after the border, not empty
      character(:), allocatable :: text
      integer :: n

      n = len(first)
      text = first//' AND '//second
      if (is_real(first//second(:1)) .and. is_real(second(2:))) then
         text = text//', OR '//first//second(:1)//' AND '//second(2:)
      else if (is_real(first(:n - 1)) .and. is_real(first(n:)//second)) then
         text = text//', OR '//first(:n - 1)//' AND '//first(n:)//second
      end if
   end function readings

   !> Tells whether a text is a real number by the grammar of `numbers`.
   pure logical function is_real(text)
      character(*), intent(in) :: text       !< without blanks around it, not empty
      type(error_code_t) :: error
      real(wp) :: value
      integer :: wrong

      call read_real(text, value, error, wrong)
      is_real = error%number == 0
   end function is_real

   !> Reads the labels and the whole number of a card. Its errors are added in the order of the columns.
   subroutine read_labels(parsed, cut, errors)
      type(parsed_card_t), intent(inout) :: parsed   !< the card; gets its whole number, and labels without cut ones
      logical, intent(in) :: cut(label_a:label_c)   !< the label field has an error already
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      type(error_code_t) :: error
      character(1) :: letter
      integer :: i, last, wrong
      logical :: is_long

      do i = label_a, label_c
         if (cut(i)) parsed%label(i) = ''
         if (cut(i)) cycle
         letter = card_forms(parsed%form)%labels(i - card_name:i - card_name)

         associate (label => parsed%label(i), field => card_fields(i))
            last = len_trim(label)
            if (last == 0) then
               if (letter == 'L' .or. letter == 'W') call add_field_error(errors, field_blank, parsed%card, field)
            else if (letter == '-') then
               call refuse_field(parsed, i, errors)
            else if (letter == 'W' .or. letter == 'w') then
               parsed%whole_given = .true.
               call read_whole(label(:last), parsed%whole, error, wrong)
               if (error%number > 0) call refuse_number(parsed, parsed%card, i, field, error, wrong, errors)

            else if (index(label(:last), ' ') > 0) then
               parsed%names_certain = .false.
               call refuse_long_label(parsed, i, errors, is_long)
               if (.not. is_long) call add_field_error(errors, label_blank_inside, parsed%card, field)
            else if (i == label_b .and. any(parsed%form == [form_link, form_time]) &
               .and. parsed%label(label_c) == '') then
               ! One word in both fields: a name or a number of steps. A bar needs FROM and TO.
               call refuse_long_label(parsed, i, errors, is_long)
            end if
         end associate
      end do
   end subroutine read_labels

   !> Adds the error of text in a field that the card does not take: the text belongs to a label that is too long, or
   !> the field must be blank.
   subroutine refuse_field(parsed, i, errors)
      type(parsed_card_t), intent(inout) :: parsed   !< the card; a long label makes its names uncertain
      integer, intent(in) :: i               !< the field: label_a, ..., real_3
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      logical :: is_found

      call refuse_long_label(parsed, i, errors, is_found)
      if (.not. is_found) call add_field_error(errors, field_unused, parsed%card, card_fields(i))
   end subroutine refuse_field

   !> Adds the error of a wrong number in a field: the text belongs to a label that is too long, the number has a comma,
   !> or any other error of the number.
   subroutine refuse_number(parsed, card, i, field, error, wrong, errors)
      type(parsed_card_t), intent(inout) :: parsed   !< the card; a long label makes its names uncertain
      type(card_t), intent(in) :: card       !< on which the number stands: its own card or the `*` card below it
      integer, intent(in) :: i               !< the field of `parsed`: label_a, ..., real_3
      integer, intent(in) :: wrong           !< number of the first wrong character of the number, from 1
      type(field_t), intent(in) :: field     !< the field of `card` in which the number stands
      type(error_code_t), intent(in) :: error   !< of the number itself: number_...
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      type(error_code_t) :: code
      character(:), allocatable :: text
      integer :: comma
      logical :: is_found

      text = field_text(card, field)
      if (text(1:1) >= 'A' .and. card%number == parsed%card%number) then
         call refuse_long_label(parsed, i, errors, is_found)
         if (is_found) return
      end if
      code = error
      comma = index(text, ',')
      if (comma > 0) then
         if (is_real(text(:comma - 1)//'.'//text(comma + 1:))) code = merge(number_comma, number_fraction, i >= real_1)
      end if
      call add_field_error(errors, code, card, field, place=wrong)
   end subroutine refuse_number

   !> Adds the error of a label that is longer than its field, if text in a given field shows such a label before it:
   !> the end of the label stands in the given field, or has moved the labels after it.
   subroutine refuse_long_label(parsed, i, errors, is_found)
      type(parsed_card_t), intent(inout) :: parsed   !< the card; a long label makes its names uncertain
      integer, intent(in) :: i               !< the field: label_a, ..., real_3
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      logical, intent(out) :: is_found       !< there is such a label, and its error is added
      character(:), allocatable :: word
      integer :: first, border

      is_found = .false.
      ! A long label can move one label into the first real, and none beyond.
      if (i > real_1 .or. (i == real_1 .and. card_forms(parsed%form)%labels(3:) == '-')) return
      do border = i, label_b, -1
         call find_long_label(parsed%card, border, first, word)
         is_found = word /= ''
         if (is_found) exit
      end do
      if (.not. is_found) return
      parsed%names_certain = .false.
      call add_error(errors, label_long, parsed%card, card_fields(border - 1), first, word)
   end subroutine refuse_long_label

   !> Finds the word that begins in a label field and goes on in the next field. The words RELANGLE and MEASURES fill
   !> LABEL-A: a name begins after them.
   pure subroutine find_long_label(card, i, first, word)
      type(card_t), intent(in) :: card       !< as it stands in the deck
      integer, intent(in) :: i               !< field in which the word goes on: label_b, ..., real_1
      integer, intent(out) :: first          !< first column of the word, if there is one
      character(:), allocatable, intent(out) :: word   !< the whole word; '': there is none

      word = ''
      first = 0
      if (i <= label_a .or. i > real_1) return
      if (i == label_b .and. any(capitals(card%text(card_fields(label_a)%first:card_fields(label_a)%last)) &
         == ['RELANGLE', 'MEASURES'])) return
      associate (border => card_fields(i)%first)
         first = first_column(card, card_fields(i - 1))
         if (index(card%text(first:border), ' ') == 0) &
            word = card%text(first:border + index(card%text(border:card_fields(i)%last)//' ', ' ') - 2)
      end associate
   end subroutine find_long_label

   !> Reads a real of a card from its field. A number that is wrong or out of bounds, or that the card does not take, is
   !> an error.
   subroutine read_real_field(parsed, card, field, i, errors)
      type(parsed_card_t), intent(inout) :: parsed   !< the card; gets the number
      type(card_t), intent(in) :: card       !< on which the number stands: its own card or the `*` card below it
      type(field_t), intent(in) :: field     !< the field of the number on `card`
      integer, intent(in) :: i               !< number of the real, 1 to 3
      type(input_errors_t), intent(inout) :: errors   !< of the deck so far
      type(error_code_t) :: error
      integer :: last, wrong

      last = len_trim(card%text(:field%last))
      if (last < field%first) return
      parsed%given(i) = .true.
      if (i > reals_of(parsed%form, parsed%label(label_a))) then
         if (parsed%on_star(i)) then
            call add_field_error(errors, field_unused, card, field)
         else
            call refuse_field(parsed, label_c + i, errors)
         end if
         return
      end if
      call read_real(card%text(first_column(card, field):last), parsed%real(i), error, wrong)
      if (abs(parsed%real(i)) > max_real) error = number_overflow
      if (abs(parsed%real(i)) > 0.0_wp .and. abs(parsed%real(i)) < min_real) error = number_underflow
      if (error%number > 0) call refuse_number(parsed, card, label_c + i, field, error, wrong, errors)
   end subroutine read_real_field
end module card_reader
