!> The TOLER cards of a set: each gives tolerances to the numbers of the card above it.
module deck_tolerances
   use kinds, only: wp
   use mechanism, only: tolerance_t, card_number_t, term_table, number_link, number_point, number_joint, &
      number_pair, number_drive, number_knot, number_time
   use card_numbers, only: unit_t, takes_tolerance, number_name, number_unit
   use card_sets, only: card_set_t, real_text, add_apart_error
   use cards, only: card_name, label_a, real_1, forms, form_unknown, form_ground, form_link, form_point, form_prism, &
      form_joint, form_drive, form_add, form_rise, form_toler, form_time, reals_of
   use input_errors, only: error_count, toler_alone, toler_none, toler_second, toler_blank, number_range
   implicit none
   private
   public :: build_tolerances, number_on_card

contains

   !> Builds `set`%mechanism%tolerances from the TOLER cards, in their order; the bodies and drives are there. A card
   !> that stands below no card with numbers, a number that takes no tolerance, and a tolerance below zero are errors.
   subroutine build_tolerances(set)
      type(card_set_t), intent(inout) :: set
      type(tolerance_t) :: list(3*set%number_of(form_toler))
      integer :: i, n

      n = 0
      do i = 1, size(set%apart)
         if (set%apart(i)%card%form == form_toler .and. set%apart(i)%card%valid) call read_tolerances(set, i, list, n)
      end do
      if (n > 0) set%mechanism%tolerances = list(:n)
   end subroutine build_tolerances

   !> Appends the tolerances of the TOLER card set%apart(`k`) to the `n` in `list`.
   subroutine read_tolerances(set, k, list, n)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k
      type(tolerance_t), intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(card_number_t) :: number
      integer :: above, taken, i

      above = set%apart(k)%below
      taken = 0
      if (above > 0) then
         if (set%cards(above)%form == form_unknown) return
         taken = forms(set%cards(above)%form)%reals
      end if
      associate (card => set%apart(k)%card, before => set%apart(:k - 1))
         if (taken == 0) then
            call add_apart_error(set, toler_alone, k, card_name)
         else if (any(before%below == above .and. before%card%form == form_toler)) then
            call add_apart_error(set, toler_second, k, card_name)
         else if (.not. any(card%given)) then
            call add_apart_error(set, toler_blank, k, card_name)
         else
            do i = 1, 3
               if (.not. card%given(i)) cycle
               number = number_on_card(set, above, i)
               if (.not. takes_tolerance(set%mechanism, number)) then
                  call add_apart_error(set, toler_none, k, real_1 + i - 1)
               else if (card%real(i) < 0.0_wp) then
                  call add_apart_error(set, number_range, k, real_1 + i - 1, '0.0 AND UP')
               else if (card%real(i) > 0.0_wp .and. error_count(set%errors) == 0) then
                  n = n + 1
                  list(n) = tolerance_of(number, i)
               end if
            end do
         end if
      end associate

   contains

      !> The tolerance of `number` by real number `i` of the card.
      function tolerance_of(number, i) result(one)
         type(card_number_t), intent(in) :: number
         integer, intent(in) :: i
         type(tolerance_t) :: one
         type(unit_t) :: unit

         unit = number_unit(set%mechanism, number)
         one%card_number_t = number
         one%size_of = set%apart(k)%card%real(i)
         one%text = real_text(set%apart(k)%card, i)
         one%name = number_name(set%mechanism, number)
         one%unit = unit%factor
         one%powers = unit%powers
         one%unit_name = unit%name
      end function tolerance_of
   end subroutine read_tolerances

   !> Number `i` of card `k` of any form; its kind is 0 if no number of the mechanism is there.
   pure function number_on_card(set, k, i) result(number)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: k, i
      type(card_number_t) :: number

      associate (card => set%cards(k))
         number = card_number_t(0, card%subject, card%term, i)
         if (i > reals_of(card%form, card%label(label_a))) return
         select case (card%form)
         case (form_ground, form_link)
            number%kind = number_link
         case (form_point)
            number%kind = number_point
         case (form_joint)
            number%kind = number_joint
         case (form_prism)
            number%kind = number_pair
         case (form_time)
            number%kind = number_time
         case (form_drive, form_add, form_rise)
            if (card%subject == 0) return
            number%kind = number_drive
            if (card%term == 0) return
            if (set%mechanism%drives(card%subject)%terms(card%term)%kind /= term_table) return
            number%place = card%row
            if (i == 1) number%kind = number_knot
         end select
      end associate
   end function number_on_card
end module deck_tolerances
