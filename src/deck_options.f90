!> Level 7. The TITLE, UNITS, LANG, METHOD, TIME and AT cards of a set.
module deck_options
   use kinds, only: wp
   use constants, only: degree
   use mechanism, only: mechanism_t, method_newton, method_matrix, method_dense
   use cards, only: title_field
   use card_forms, only: forms, form_title, form_units, form_lang, form_time, form_at, form_method
   use complaints, only: complaints_t, whole_text
   use deck_codes, only: card_repeated, lang_kind, units_angle, units_place, method_kind, tolerance_range, time_point, &
                         number_range, field_blank
   use drafts, only: draft_t, complain_name, complain_label, complain_choice, complain_real
   implicit none
   private
   public :: build_options

   !> Steps of a TIME card: what its field can hold.
   integer, parameter :: most_steps = 99999999
   !> Relative tolerances allowed: above what rounding permits, below what would be no solution.
   real(wp), parameter :: least_tolerance = min(1.0e-15_wp, 5.0_wp*epsilon(1.0_wp))
   real(wp), parameter :: most_tolerance = 1.0e-2_wp
   !> Words that can only be meant as a unit of angles.
   character(7), parameter :: angle_words(*) = [character(7) :: 'DEG', 'RAD', 'GRAD', 'DEGREE', 'DEGREES', 'RADIAN', &
      'RADIANS']

contains

   !> Sets everything in `set` that is not a list of bodies, drives or requests. `angle_unit`: the deck's
   !> unit of angles in radians.
   subroutine build_options(draft, set, angle_unit, list)
      type(draft_t), intent(in) :: draft
      type(mechanism_t), intent(inout) :: set
      real(wp), intent(out) :: angle_unit
      type(complaints_t), intent(inout) :: list
      integer :: k

      call check_repeats(draft, list)
      do k = 1, draft%count
         select case (draft%cards(k)%form)
         case (form_title)
            set%title = draft%cards(k)%card%text(title_field%first:title_field%last)
         case (form_units)
            call read_units(draft, k, set, list)
         case (form_lang)
            set%polish = draft%cards(k)%label(1) == 'PL'
            if (draft%cards(k)%sound .and. all(draft%cards(k)%label(1) /= ['EN', 'PL'])) &
               call complain_choice(list, lang_kind, draft, k, 1)
         case (form_method)
            call read_method(draft, k, set, list)
         case (form_time)
            call read_time(draft, k, set, list)
         end select
      end do
      call read_instants(draft, set, list)
      angle_unit = merge(degree, 1.0_wp, set%degrees)
   end subroutine build_options

   !> Some cards may stand only once in a set.
   subroutine check_repeats(draft, list)
      type(draft_t), intent(in) :: draft
      type(complaints_t), intent(inout) :: list
      integer :: first(size(forms)), form, k

      first = 0
      do k = 1, draft%count
         form = draft%cards(k)%form
         if (form < 1 .or. form > size(forms)) cycle
         if (.not. forms(form)%once) cycle
         if (first(form) == 0) then
            first(form) = k
         else
            call complain_name(list, card_repeated, draft, k, &
                               whole_text(draft%cards(first(form))%card%number))
         end if
      end do
   end subroutine check_repeats

   subroutine read_units(draft, k, set, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list

      integer :: i

      associate (label => draft%cards(k)%label)
         if (label(1) /= '') set%length_unit = label(1)
         if (label(3) /= '') set%time_unit = label(3)
         set%degrees = label(2) == 'DEG'
         if (.not. draft%cards(k)%sound) return
         ! Taken for a length, DEG would leave all angles in radians.
         do i = 1, 3, 2
            if (any(label(i) == angle_words)) call complain_choice(list, units_place, draft, k, i)
         end do
         if (all(label(2) /= [character(3) :: '', 'RAD', 'DEG'])) call complain_choice(list, units_angle, draft, k, 2)
      end associate
   end subroutine read_units

   subroutine read_method(draft, k, set, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list

      if (.not. draft%cards(k)%sound) return
      select case (draft%cards(k)%label(1))
      case ('NEWTON')
         set%method = method_newton
      case ('DENSE')
         set%method = method_dense
      case ('MATRIX')
         set%method = method_matrix
      case default
         call complain_choice(list, method_kind, draft, k, 1)
      end select
      set%tolerance = draft%cards(k)%real(1)
      if (set%tolerance < 0.0_wp .or. set%tolerance > most_tolerance .or. &
          (set%tolerance > 0.0_wp .and. set%tolerance <= least_tolerance)) &
         call complain_real(list, tolerance_range, draft, k, 1, '')
   end subroutine read_method

   subroutine read_time(draft, k, set, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list

      if (.not. draft%cards(k)%sound) return
      associate (card => draft%cards(k))
         if (card%whole < 1 .or. card%whole > most_steps) then
            call complain_label(list, number_range, draft, k, 1, '1 TO '//whole_text(most_steps))
         else if (.not. any(card%given(1:2))) then
            call complain_real(list, field_blank, draft, k, 2, '')
         else if (.not. (card%real(1) < card%real(2) .or. card%real(1) > card%real(2))) then
            call complain_real(list, time_point, draft, k, 2, '')
         else
            set%steps = card%whole
            set%t0 = card%real(1)
            set%t1 = card%real(2)
         end if
      end associate
   end subroutine read_time

   !> The instants of the AT cards, in their order.
   subroutine read_instants(draft, set, list)
      type(draft_t), intent(in) :: draft
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list
      integer :: k, n

      n = 0
      do k = 1, draft%count
         if (draft%cards(k)%form /= form_at) cycle
         n = n + count(draft%cards(k)%given)
         if (draft%cards(k)%sound .and. .not. any(draft%cards(k)%given)) &
            call complain_real(list, field_blank, draft, k, 1, '')
      end do
      allocate (set%at(n))
      n = 0
      do k = 1, draft%count
         associate (card => draft%cards(k))
            if (card%form /= form_at) cycle
            set%at(n + 1:n + count(card%given)) = pack(card%real, card%given)
            n = n + count(card%given)
         end associate
      end do
   end subroutine read_instants
end module deck_options
