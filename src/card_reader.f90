!> Level 5. From a card to its labels, whole number and reals; every field is checked, none is
!> understood.
module card_reader
   use kinds, only: wp, label_length
   use cards, only: card_t, field_t, name_field, label_fields, real_fields, wide_fields, card_fields, &
                    no_field, field_text, first_column, card_columns
   use card_forms, only: forms, label_unused, label_needed, form_title, form_add, form_star, find_form, &
                         nearest_form
   use card_borders, only: find_cuts
   use letters, only: capitals
   use numbers, only: read_real, read_whole, flaw_none, flaw_overflow, flaw_underflow, flaw_count
   use deck_codes, only: code_t, card_unknown, card_lower_case, card_indented, past_last_column, &
                         tab_character, control_character, foreign_character, field_unused, field_blank, &
                         label_blank_inside, star_no_reals, star_second, star_twice, star_blank, &
                         number_other, number_letter_o, number_letter_l, number_blank, number_comma, &
                         number_sign, number_nan, number_inf, number_overflow, number_underflow, most_power, &
                         number_no_point, number_point, number_no_digits, number_exponent
   use complaints, only: complaints_t, complain, complain_field, complaint_count, complaints_full
   implicit none
   private
   public :: reading_t, read_card, read_star, reals_taken

   !> A card as it was read. It is kept even if it is wrong, so that its names are known to other cards.
   type :: reading_t
      type(card_t) :: card
      integer :: form = 0                       !< 0: not known
      logical :: sound = .true.                 !< no complaint about it
      logical :: names_sure = .true.            !< its form and labels are what was meant, sound or not
      character(label_length) :: label(3) = ''
      integer :: whole = 0
      logical :: whole_given = .false.
      real(wp) :: real(3) = 0.0_wp              !< 0 where the field is blank
      logical :: given(3) = .false.
      logical :: starred(3) = .false.           !< the next reading, a `*` card, gives this real
   end type reading_t

   !> Decks hold lengths, angles, times: what lies beyond has no use, and its squares would leave the range of reals.
   real(wp), parameter :: largest_real = 10.0_wp**most_power, least_real = 10.0_wp**(-most_power)

   !> The words for the flaws of `numbers`, in their order.
   type(code_t), parameter :: flaw_codes(flaw_count) = [ &
      number_other, number_letter_o, number_letter_l, number_blank, number_comma, number_sign, number_nan, &
      number_inf, number_overflow, number_underflow, number_no_point, number_point, number_no_digits, &
      number_exponent]

contains

   !> Reads `card`, not a `*` card. Errors go to `list`, in the order of the columns.
   subroutine read_card(card, reading, list)
      type(card_t), intent(in) :: card
      type(reading_t), intent(out) :: reading
      type(complaints_t), intent(inout) :: list
      logical :: cut(size(card_fields))
      integer :: before, i

      before = complaint_count(list)
      reading%card = card
      do i = 1, 3
         reading%label(i) = adjustl(card%text(label_fields(i)%first:label_fields(i)%last))
      end do
      call check_characters(card, reading%names_sure, list)
      if (complaint_count(list) == before) then
         call read_name(card, reading%form, list)
      else
         reading%form = find_form(card%text(name_field%first:name_field%last))
      end if
      reading%names_sure = reading%names_sure .and. reading%form > 0
      reading%sound = complaint_count(list) == before
      if (.not. reading%sound) return
      if (reading%form /= form_title) then
         call find_cuts(card, card_fields, may_begin_number(reading%form), cut, list)
         reading%names_sure = .not. any(cut(2:4))
         call read_labels(reading, cut, list)
         do i = 1, 3
            if (.not. cut(4 + i)) call read_real_field(reading, card, real_fields(i), i, list)
         end do
      end if
      reading%sound = complaint_count(list) == before
   end subroutine read_card

   !> Reads the `*` card `card` that stands below `above`; `star` is kept for its picture and the echo.
   subroutine read_star(card, above, above_is_star, star, list)
      type(card_t), intent(in) :: card
      type(reading_t), intent(inout) :: above
      logical, intent(in) :: above_is_star
      type(reading_t), intent(out) :: star
      type(complaints_t), intent(inout) :: list
      integer :: before
      logical :: clean

      before = complaint_count(list)
      star%card = card
      star%form = form_star
      call check_characters(card, clean, list)
      if (complaint_count(list) > before) then
         continue
      else if (field_text(card, name_field) /= '*') then
         call complain_field(list, card_unknown, card, name_field, '')
      else if (above_is_star) then
         call complain_field(list, star_second, card, name_field, '')
      else if (reals_taken(above) == 0 .and. above%form > 0) then
         call complain_field(list, star_no_reals, card, name_field, '')
      else if (above%form > 0) then
         call read_wide_fields(card, above, list)
      end if
      star%sound = complaint_count(list) == before
      if (.not. above_is_star) above%sound = above%sound .and. star%sound
   end subroutine read_star

   !> How many of the real fields the card takes.
   pure integer function reals_taken(reading) result(taken)
      type(reading_t), intent(in) :: reading

      taken = 0
      if (reading%form < 1 .or. reading%form > size(forms)) return
      taken = forms(reading%form)%reals
      if (reading%form == form_add .and. any(reading%label(1) == ['POWER', 'TABLE'])) taken = 2
   end function reals_taken

   !> Only printable ASCII and nothing past column 80: the first offence is told.
   !> `clean`: the card itself is printable ASCII.
   subroutine check_characters(card, clean, list)
      type(card_t), intent(in) :: card
      logical, intent(out) :: clean
      type(complaints_t), intent(inout) :: list
      type(code_t) :: code
      type(field_t) :: field
      integer :: column, i

      do column = 1, card_columns
         if (card%text(column:column) < ' ' .or. card%text(column:column) > '~') exit
      end do
      clean = column > card_columns
      if (clean) then
         if (card%overrun > 0) &
            call complain(list, past_last_column, card, field_t('PAST-80', 81, 81), card%overrun, &
                          card%beyond, '')
         return
      end if
      select case (ichar(card%text(column:column)))
      case (9)
         code = tab_character
      case (128:)
         code = foreign_character
      case default
         code = control_character
      end select
      field = no_field
      do i = 1, size(card_fields)
         if (column >= card_fields(i)%first .and. column <= card_fields(i)%last) field = card_fields(i)
      end do
      call complain(list, code, card, field, column, field_text(card, field), '')
   end subroutine check_characters

   !> `form` is known too where the name is wrong but its meaning is clear.
   subroutine read_name(card, form, list)
      type(card_t), intent(in) :: card
      integer, intent(out) :: form
      type(complaints_t), intent(inout) :: list
      character(:), allocatable :: name
      type(code_t) :: code

      form = find_form(card%text(name_field%first:name_field%last))
      if (form > 0) return
      name = field_text(card, name_field)
      form = find_form(capitals(name))
      if (form > 0) then
         code = merge(card_indented, card_lower_case, card%text(1:1) == ' ')
         call complain_field(list, code, card, name_field, '')
      else if (name == '') then
         call complain(list, field_blank, card, name_field, name_field%first, '', '')
      else if (complaints_full(list)) then
         call complain_field(list, card_unknown, card, name_field, '')
      else
         form = nearest_form(name)
         if (form > 0) then
            call complain_field(list, card_unknown, card, name_field, '(IS IT '//trim(forms(form)%name)//'?)')
         else
            call complain_field(list, card_unknown, card, name_field, '')
         end if
      end if
   end subroutine read_name

   subroutine read_labels(reading, cut, list)
      type(reading_t), intent(inout) :: reading
      logical, intent(in) :: cut(:)
      type(complaints_t), intent(inout) :: list
      integer :: i, flaw, place

      associate (form => forms(reading%form))
         do i = 1, 3
            if (cut(i + 1)) then
               reading%label(i) = ''
            else if (reading%label(i) == '') then
               if (form%labels(i) == label_needed) &
                  call complain_field(list, field_blank, reading%card, label_fields(i), '')
            else if (form%labels(i) == label_unused) then
               call complain_field(list, field_unused, reading%card, label_fields(i), '')
            else if (form%whole == i) then
               call read_whole(trim(reading%label(i)), reading%whole, flaw, place)
               reading%whole_given = .true.
               if (flaw /= flaw_none) call complain_flaw(reading%card, label_fields(i), flaw, place, list)
            else if (index(trim(reading%label(i)), ' ') > 0) then
               reading%names_sure = .false.
               call complain_field(list, label_blank_inside, reading%card, label_fields(i), '')
            end if
         end do
      end associate
   end subroutine read_labels

   subroutine read_wide_fields(card, above, list)
      type(card_t), intent(in) :: card
      type(reading_t), intent(inout) :: above
      type(complaints_t), intent(inout) :: list
      logical :: cut(3)
      integer :: i

      if (card%text(wide_fields(1)%first:) == '') then
         call complain_field(list, star_blank, card, name_field, '')
         return
      end if
      call find_cuts(card, wide_fields, [.true., .true., .true.], cut, list)
      do i = 1, 3
         if (cut(i) .or. field_text(card, wide_fields(i)) == '') cycle
         if (above%given(i)) then
            call complain_field(list, star_twice, card, wide_fields(i), '')
         else
            above%starred(i) = .true.
            call read_real_field(above, card, wide_fields(i), i, list)
         end if
      end do
   end subroutine read_wide_fields

   !> Which fields of a card may hold the beginning of a number: the reals and the labels it does not take.
   pure function may_begin_number(form) result(may)
      integer, intent(in) :: form
      logical :: may(size(card_fields))

      may = [.false., forms(form)%labels == label_unused, .true., .true., .true.]
   end function may_begin_number

   !> Real number `i` of `reading` from `field` of `card`, which is its own card or the `*` card below.
   subroutine read_real_field(reading, card, field, i, list)
      type(reading_t), intent(inout) :: reading
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: field
      integer, intent(in) :: i
      type(complaints_t), intent(inout) :: list
      integer :: flaw, place, start

      if (card%text(field%first:field%last) == '') return
      reading%given(i) = .true.
      if (i > reals_taken(reading)) then
         call complain_field(list, field_unused, card, field, '')
         return
      end if
      start = first_column(card, field)
      call read_real(trim(card%text(start:field%last)), reading%real(i), flaw, place)
      if (flaw == flaw_none) flaw = flaw_of_size(reading%real(i))
      if (flaw /= flaw_none) call complain_flaw(card, field, flaw, place, list)
   end subroutine read_real_field

   !> Squares and products of two numbers of a deck stay in the range of the real kind.
   pure integer function flaw_of_size(x) result(flaw)
      real(wp), intent(in) :: x

      flaw = flaw_none
      if (abs(x) > largest_real) flaw = flaw_overflow
      if (abs(x) > 0.0_wp .and. abs(x) < least_real) flaw = flaw_underflow
   end function flaw_of_size

   subroutine complain_flaw(card, field, flaw, place, list)
      type(card_t), intent(in) :: card
      type(field_t), intent(in) :: field
      integer, intent(in) :: flaw, place
      type(complaints_t), intent(inout) :: list

      call complain(list, flaw_codes(flaw), card, field, first_column(card, field) + place - 1, &
                    field_text(card, field), '')
   end subroutine complain_flaw
end module card_reader
