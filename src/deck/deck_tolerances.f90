!> The TOLER cards of a set: each gives tolerances to the numbers of the card above it.
module deck_tolerances
   use kinds, only: wp
   use mechanism, only: tolerance_t, term_words, term_power, term_table, drive_words, drive_angle, drive_relangle, &
      driven_kinds, request_link, request_point, request_pair, number_ground, number_point, number_joint, &
      number_pair, number_drive
   use card_reader, only: parsed_card_t
   use card_sets, only: card_set_t, real_text, add_card_error
   use cards, only: card_name, label_a, label_b, label_c, real_1, forms, form_name, number_word, form_unknown, &
      form_ground, form_link, form_point, form_prism, form_joint, form_drive, form_add, form_rise, form_toler, &
      form_time, reals_of
   use deck_drives, only: turns_a_minute, turns_unit
   use input_errors, only: toler_alone, toler_none, toler_second, toler_blank, number_range
   use numerals, only: whole
   implicit none
   private
   public :: build_tolerances, number_on_card

   !> What the numbers R1 to R3 of a harmonic are called.
   character(9), parameter :: harmonic_words(3) = ['AMPLITUDE', 'FREQUENCY', 'PHASE    ']

contains

   !> Builds `set`%mechanism%tolerances from the TOLER cards, in their order; the bodies and drives are there. A card
   !> that stands below no card with numbers, a number that takes no tolerance, and a tolerance below zero are errors.
   subroutine build_tolerances(set)
      type(card_set_t), intent(inout) :: set
      type(tolerance_t) :: list(3*set%number_of(form_toler))
      integer :: k, n, above

      if (set%number_of(form_toler) == 0) return
      n = 0
      above = 0
      do k = 1, set%count
         if (set%cards(k)%form == form_toler) then
            call read_tolerances(set, k, above, list, n)
         else
            above = k
         end if
      end do
      if (n > 0) set%mechanism%tolerances = list(:n)
   end subroutine build_tolerances

   !> Appends the tolerances of the TOLER card `k`, which belong to card `above`, to the `n` in `list`.
   subroutine read_tolerances(set, k, above, list, n)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k, above
      type(tolerance_t), intent(inout) :: list(:)
      integer, intent(inout) :: n
      type(tolerance_t) :: one
      integer :: i

      if (.not. set%cards(k)%valid) return
      if (above == 0) then
         call add_card_error(set, toler_alone, k, card_name)
         return
      end if
      if (set%cards(above)%form == form_unknown) return
      if (forms(set%cards(above)%form)%reals == 0) then
         call add_card_error(set, toler_alone, k, card_name)
      else if (above < k - 1) then
         call add_card_error(set, toler_second, k, card_name)
      else if (.not. any(set%cards(k)%given)) then
         call add_card_error(set, toler_blank, k, card_name)
      else
         do i = 1, 3
            if (.not. set%cards(k)%given(i)) cycle
            one = number_on_card(set, above, i)
            if (one%kind == 0) then
               call add_card_error(set, toler_none, k, real_1 + i - 1)
            else if (set%cards(k)%real(i) < 0.0_wp) then
               call add_card_error(set, number_range, k, real_1 + i - 1, '0.0 AND UP')
            else if (set%cards(k)%real(i) > 0.0_wp) then
               one%size_of = set%cards(k)%real(i)
               one%text = real_text(set%cards(k), i)
               n = n + 1
               list(n) = one
            end if
         end do
      end if
   end subroutine read_tolerances

   !> Number `i` of card `k` of any form: its name and unit and, as far as it can have a tolerance, what it is on, the
   !> tolerance still open. The kind of any other is 0.
   function number_on_card(set, k, i) result(one)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: k, i
      type(tolerance_t) :: one

      one = tolerance_t(kind=0, place=i, unit_name=set%mechanism%length_unit)
      associate (card => set%cards(k))
         if (i > reals_of(card%form, card%label(label_a))) return
         one%name = form_name(card%form)
         if (any(card%form == [form_ground, form_link, form_point, form_joint])) &
            one%name = trim(one%name)//' '//card%label(label_a)
         if (card%form == form_prism) one%name = trim(one%name)//' '//card%label(label_c)
         one%name = trim(one%name)//' '//number_word(card%form, i)
         select case (card%form)
         case (form_ground, form_link)
            one%subject = findloc(set%named(request_link)%card, k, dim=1)
            if (i == 3) call take_angle()
            if (card%form == form_ground .and. .not. has_joint(one%subject)) one%kind = number_ground
         case (form_point)
            one%kind = number_point
            one%subject = findloc(set%named(request_point)%card, k, dim=1)
         case (form_joint)
            one%kind = number_joint
            one%subject = card%point
         case (form_prism)
            one%kind = number_pair
            one%subject = findloc(set%named(request_pair)%card, k, dim=1)
            if (i /= 2) call take_angle()
         case (form_time)
            one%unit_name = set%mechanism%time_unit
         case (form_drive, form_add, form_rise)
            if (card%drive > 0) &
               call take_law(set%cards(findloc(set%cards(:set%count)%drive, card%drive, dim=1)), card)
         end select
      end associate

   contains

      !> Number `one` is an angle.
      pure subroutine take_angle()

         one%unit = set%angle_unit
         one%powers = 0.0_wp
         one%unit_name = merge('DEG', 'RAD', set%mechanism%degrees)
      end subroutine take_angle

      !> A JOINT card gives its place in the drawing: what the axes of a ground link change then is no dimension.
      pure logical function has_joint(link)
         integer, intent(in) :: link

         has_joint = any(set%mechanism%points%link == link &
            .and. set%cards(set%named(request_point)%card)%form == form_joint)
      end function has_joint

      !> Number `one` is on `card`, a card of the law of the drive on the card `drive`: its kind, name and unit.
      subroutine take_law(drive, card)
         type(parsed_card_t), intent(in) :: drive, card
         character(:), allocatable :: time, word
         integer :: kind

         kind = findloc(drive_words, drive%label(label_a), dim=1)
         if (kind == 0) return
         one%subject = card%drive
         one%term = card%term
         if (driven_kinds(kind) == request_link) call take_angle()
         time = '/'//trim(set%mechanism%time_unit)
         word = number_word(card%form, one%place)
         select case (card%form)
         case (form_drive)
            one%powers(2) = real(1 - one%place, wp)
            if (one%place > 1) one%unit_name = trim(one%unit_name)//time//merge('**2', '   ', one%place == 3)
            if (kind == drive_angle .and. one%place == 2 .and. card%label(label_c) == turns_a_minute) then
               one%unit_name = turns_a_minute
               one%unit = turns_unit(set)
            end if
         case (form_rise)
            if (one%place < 3) then
               one%unit = 1.0_wp
               one%powers = [0.0_wp, 1.0_wp]
               one%unit_name = set%mechanism%time_unit
            end if
         case default
            call take_term(card, time, word)
            if (.not. allocated(word)) return
         end select
         one%kind = number_drive
         one%name = trim(drive%label(label_a))//' '//drive%label(label_b)
         if (kind == drive_relangle) one%name = trim(one%name)//' '//drive%label(label_c)
         if (card%form /= form_drive) one%name = trim(one%name)//' '//trim(card%label(label_a))//' '//whole(one%term)
         one%name = trim(one%name)//' '//word
      end subroutine take_law

      !> The same of the ADD card `card`: the unit and the `word` of its number, which becomes unallocated where that
      !> takes no tolerance. `time`: how the name of a rate's unit ends.
      subroutine take_term(card, time, word)
         type(parsed_card_t), intent(in) :: card
         character(*), intent(in) :: time
         character(:), allocatable, intent(out) :: word

         if (card%label(label_a) == term_words(term_table)) then
            ! The times of a table are those at which its values are meant.
            if (one%place == 1) return
            word = 'ROW '//whole(card%row)
            one%place = card%row
         else if (card%label(label_a) == term_words(term_power)) then
            ! The power says what kind of function it is.
            if (one%place == 2) return
            word = 'FACTOR'
            one%powers(2) = -card%real(2)
            one%unit_name = trim(one%unit_name)//time//'**R2'
         else
            word = harmonic_words(one%place)
            if (one%place == 1) return
            call take_angle()
            one%powers(2) = real(one%place - 3, wp)
            if (one%place == 2) one%unit_name = trim(one%unit_name)//time
         end if
      end subroutine take_term
   end function number_on_card
end module deck_tolerances
