!> Reads a card to its labels, whole number and reals. Every field is checked; deck_... and card_sets give it a meaning.
!> What is harmless is a remark, all else an error.
module card_reader
   use kinds, only: wp, label_length
   use mechanism, only: remark_title_long, remark_title_letters, remark_touching
   use cards
   use input_errors
   use failures, only: capitals
   use numbers, only: read_real, read_whole
   use numerals, only: whole
   implicit none
   private
   public :: parsed_card_t, read_card, read_star

   !> A card as it was read. It is kept even if it is wrong, so that other cards find its names.
   type :: parsed_card_t
      type(card_t) :: card
      type(card_t), allocatable :: star         !< the `*` card below it
      integer :: form = form_unknown            !< its place in `forms`
      logical :: valid = .true.                 !< it and its `*` card have no error of their own
      logical :: names_certain = .true.         !< its form and labels are what was meant, valid or not
      character(label_length) :: label(label_a:label_c) = ''
      integer :: whole = 0                      !< the whole number in a label field
      logical :: whole_given = .false.          !< that field is not blank
      real(wp) :: real(3) = 0.0_wp              !< in the deck's units; 0 where the field is blank
      logical :: given(3) = .false.             !< which of them are not blank
      logical :: on_star(3) = .false.           !< which of them are on the `*` card
      !> The number of the link, point (of JOINT the first), pair or drive that it defines; 0: none is built.
      integer :: subject = 0
      !> Of a card of a drive's law the numbers of term and row of its table; of the DRIVE card 0.
      integer :: term = 0, row = 0
      integer :: below = 0                      !< the number of the card above it, TOLER and VARY left out; 0: none
   end type parsed_card_t

   !> Bounds of lengths, angles and times. Numbers beyond them have no use, and their squares would leave the range of
   !> reals.
   real(wp), parameter :: max_real = 10.0_wp**max_power, min_real = 10.0_wp**(-max_power)

contains

   !> Reads `card`, which is not a `*` card, to `parsed`. Errors are added to `errors`, in the order of the columns.
   subroutine read_card(card, parsed, errors)
      type(card_t), intent(in) :: card
      type(parsed_card_t), intent(out) :: parsed
      type(input_errors_t), intent(inout) :: errors
      type(error_code_t) :: code
      character(:), allocatable :: name
      logical :: cut(size(card_fields))
      integer :: before, last, i

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
         code = merge(card_unknown, card_indented, parsed%form == form_unknown)
         if (name == '') code = field_blank
         call add_field_error(errors, code, card, card_fields(card_name))
      end if
      parsed%names_certain = parsed%names_certain .and. parsed%form /= form_unknown
      parsed%valid = errors%count == before
      if (.not. parsed%valid .or. parsed%form == form_title) return
      ! The reals, and the labels that the card does not take, may hold the beginning of a number.
      call find_cuts(card, card_fields, 'L'//forms(parsed%form)%labels//'---', cut, errors)
      parsed%names_certain = .not. any(cut(label_a:label_c))
      call read_labels(parsed, cut(label_a:label_c), errors)
      do i = 1, 3
         if (card_fields(label_c + i)%first > last) exit
         if (.not. cut(label_c + i)) call read_real_field(parsed, card, card_fields(label_c + i), i, errors)
      end do
      parsed%valid = errors%count == before
   end subroutine read_card

   !> Makes the text of the TITLE card `card` printable: with ? for a letter that is not ASCII, cut at the last column.
   !> Both are remarks.
   subroutine read_title(card, errors)
      type(card_t), intent(inout) :: card
      type(input_errors_t), intent(inout) :: errors
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

   !> Reads the `*` card `card` to `above`, the card above it, whose reals it gives. Errors are added to `errors`.
   subroutine read_star(card, above, errors)
      type(card_t), intent(in) :: card
      type(parsed_card_t), intent(inout) :: above
      type(input_errors_t), intent(inout) :: errors
      integer :: before, i
      logical :: clean, cut(3)

      before = errors%count
      call check_characters(card, clean, errors)
      if (errors%count > before) then
         continue
      else if (field_text(card, card_fields(card_name)) /= '*') then
         call add_field_error(errors, card_unknown, card, card_fields(card_name))
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

   !> Adds the first error of a character that is not printable ASCII or is past column 80. `clean`: columns 1 to 80 are
   !> printable ASCII.
   subroutine check_characters(card, clean, errors)
      type(card_t), intent(in) :: card
      logical, intent(out) :: clean
      type(input_errors_t), intent(inout) :: errors
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

   !> Sets `cut` for the `fields` (in the order of their columns, each ending where the next one begins) whose text is
   !> cut by a border, and adds an error for each border. Text is cut if it does not begin at its field and continues
   !> beyond the border. It is also cut if it is a real number together with what follows the border; that is checked
   !> where `taken(i:i)` is -: field i takes no label, and may hold the beginning of a number. Two full labels side by
   !> side are not cut, nor are two reals that cannot be one number: two full ones, or any two if the second has a sign,
   !> which is a remark.
   subroutine find_cuts(card, fields, taken, cut, errors)
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: fields(:)
      character(*), intent(in) :: taken
      logical, intent(out) :: cut(:)
      type(input_errors_t), intent(inout) :: errors
      integer :: i, start, finish, border
      logical :: numeric, fills

      cut = .false.
      do i = 1, size(fields) - 1
         border = fields(i)%last
         ! No character comes before the blank, and to ask for equality with it costs a call.
         if (cut(i) .or. card%text(border:border) <= ' ' .or. card%text(border + 1:border + 1) <= ' ') cycle
         start = fields(i)%first + index(card%text(fields(i)%first:border), ' ', back=.true.)
         ! Two numbers that fill their fields may touch; the first may have a blank in place of a plus sign.
         numeric = taken(i:i) == '-'
         fills = start <= fields(i)%first + merge(1, 0, numeric)
         if (fills .and. .not. numeric) cycle
         finish = border + index(card%text(border + 1:fields(i + 1)%last)//' ', ' ') - 1
         if (fills) then
            if (.not. is_real(card%text(start:finish))) cycle
         else if (scan(card%text(border + 1:border + 1), '+-') == 1) then
            ! The sign must not be that of the exponent of a number before it; after a label a number must follow.
            if (merge(scan(card%text(border:border), 'EeDd') == 0, is_real(card%text(border + 1:finish)), numeric)) then
               call add_remark(errors, remark_touching, card, border + 1, card%text(border + 1:finish))
               cycle
            end if
         end if
         cut(i:i + 1) = .true.
         call add_error(errors, border_crossed, card, fields(i), start, card%text(start:finish), whole(border) &
            //' AND '//whole(border + 1))
      end do
   end subroutine find_cuts

   !> Whether `text` is a real number without an error.
   pure logical function is_real(text)
      character(*), intent(in) :: text
      type(error_code_t) :: error
      real(wp) :: value
      integer :: place

      call read_real(text, value, error, place)
      is_real = error%number == 0
   end function is_real

   !> Reads the labels and the whole number of `parsed`. `cut`: label fields that have an error already.
   subroutine read_labels(parsed, cut, errors)
      type(parsed_card_t), intent(inout) :: parsed
      logical, intent(in) :: cut(label_a:label_c)
      type(input_errors_t), intent(inout) :: errors
      type(error_code_t) :: error
      character(1) :: taken
      integer :: i, last, place

      do i = label_a, label_c
         if (cut(i)) parsed%label(i) = ''
         if (cut(i)) cycle
         taken = forms(parsed%form)%labels(i - card_name:i - card_name)
         associate (label => parsed%label(i), field => card_fields(i))
            last = len_trim(label)
            if (last == 0) then
               if (taken == 'L' .or. taken == 'W') call add_field_error(errors, field_blank, parsed%card, field)
            else if (taken == '-') then
               call refuse_field(parsed, i, errors)
            else if (taken == 'W' .or. taken == 'w') then
               parsed%whole_given = .true.
               call read_whole(label(:last), parsed%whole, error, place)
               if (error%number > 0) call add_field_error(errors, error, parsed%card, field, place=place)
            else if (index(label(:last), ' ') > 0) then
               parsed%names_certain = .false.
               call add_field_error(errors, label_blank_inside, parsed%card, field)
            end if
         end associate
      end do
   end subroutine read_labels

   !> Adds the error of text in field number `i`, which the card `parsed` does not take: it may belong to a name or a
   !> whole number in the field before, which is longer than a label.
   subroutine refuse_field(parsed, i, errors)
      type(parsed_card_t), intent(inout) :: parsed
      integer, intent(in) :: i
      type(input_errors_t), intent(inout) :: errors
      integer :: first, finish

      associate (text => parsed%card%text, border => card_fields(i)%first)
         if (i > label_a .and. i <= label_c + 1 .and. index(text(border - 1:border), ' ') == 0) then
            parsed%names_certain = .false.
            first = first_column(parsed%card, card_fields(i - 1))
            finish = border + index(text(border:card_fields(i)%last)//' ', ' ') - 2
            call add_error(errors, label_long, parsed%card, card_fields(i - 1), first, text(first:finish))
         else
            call add_field_error(errors, field_unused, parsed%card, card_fields(i))
         end if
      end associate
   end subroutine refuse_field

   !> Reads real number `i` of `parsed` from `field` of `card`, which is its own card or the `*` card below it.
   subroutine read_real_field(parsed, card, field, i, errors)
      type(parsed_card_t), intent(inout) :: parsed
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: field
      integer, intent(in) :: i
      type(input_errors_t), intent(inout) :: errors
      type(error_code_t) :: error
      integer :: last, place

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
      call read_real(card%text(first_column(card, field):last), parsed%real(i), error, place)
      if (abs(parsed%real(i)) > max_real) error = number_overflow
      if (abs(parsed%real(i)) > 0.0_wp .and. abs(parsed%real(i)) < min_real) error = number_underflow
      if (error%number > 0) call add_field_error(errors, error, card, field, place=place)
   end subroutine read_real_field
end module card_reader
