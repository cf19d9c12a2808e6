!> The TOLER cards of a set: each gives tolerances to the numbers of the card above it.
module deck_tolerances
   use kinds, only: wp, label_length
   use mechanism, only: tolerance_t, term_words, term_power, term_table, drive_words, drive_relangle, driven_kinds, &
      request_link, request_point, request_pair, number_ground, number_point, number_joint, number_pair, number_drive
   use card_reader, only: parsed_card_t
   use card_sets, only: card_set_t, add_card_error
   use cards, only: card_fields, wide_fields, field_text, card_name, label_a, label_b, label_c, real_1, forms, &
      form_unknown, form_ground, form_point, form_prism, form_joint, form_drive, form_add, form_rise, form_toler, &
      reals_of
   use deck_drives, only: turns_a_minute, turns_unit, continues_table
   use input_errors, only: toler_alone, toler_none, toler_second, toler_blank, number_range
   use numerals, only: whole
   implicit none
   private
   public :: build_tolerances, number_on_card

   !> What the numbers R1 to R3 of a card are called.
   character(12), parameter :: ground_words(3) = [character(12) :: 'X', 'Y', 'PHI'], &
      point_words(3) = [character(12) :: 'XI', 'ETA', ''], guide_words(3) = [character(12) :: 'ALPHA', 'H', 'BETA'], &
      drive_numbers(3) = [character(12) :: 'VALUE', 'RATE', 'ACCELERATION'], &
      harmonic_words(3) = [character(12) :: 'AMPLITUDE', 'FREQUENCY', 'PHASE'], &
      rise_numbers(3) = [character(12) :: 'START', 'DURATION', 'LIFT']

   !> The drive and the term to which the cards at hand belong.
   type :: place_t
      integer :: card = 0                    !< the DRIVE card
      integer :: drive = 0, term = 0, row = 0   !< numbers: of the drive, of its term, of the row of its table
   end type place_t

contains

   !> Builds `set`%mechanism%tolerances from the TOLER cards, in their order; the bodies and drives are there. A card
   !> that stands below no card with numbers, a number that takes no tolerance, and a tolerance below zero are errors.
   subroutine build_tolerances(set)
      type(card_set_t), intent(inout) :: set
      type(tolerance_t) :: list(3*set%number_of(form_toler))
      type(place_t) :: at
      integer :: k, n, above

      if (set%number_of(form_toler) == 0) return
      n = 0
      above = 0
      do k = 1, set%count
         if (set%cards(k)%form /= form_toler) then
            above = k
            call follow_drives(set, k, at)
         else
            call read_tolerances(set, k, above, at, list, n)
         end if
      end do
      if (n > 0) set%mechanism%tolerances = list(:n)
   end subroutine build_tolerances

   !> Keeps `at` up to card `k`.
   subroutine follow_drives(set, k, at)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: k
      type(place_t), intent(inout) :: at

      select case (set%cards(k)%form)
      case (form_drive)
         at = place_t(card=k, drive=at%drive + 1)
      case (form_add, form_rise)
         at%row = at%row + 1
         if (continues_table(set, k)) return
         at%term = at%term + 1
         at%row = 1
      end select
   end subroutine follow_drives

   !> Appends the tolerances of the TOLER card `k`, which belong to card `above`, to the `n` in `list`.
   subroutine read_tolerances(set, k, above, at, list, n)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k, above
      type(place_t), intent(in) :: at
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
            one = number_of(set, above, i, at)
            if (one%kind == 0) then
               call add_card_error(set, toler_none, k, real_1 + i - 1)
            else if (set%cards(k)%real(i) < 0.0_wp) then
               call add_card_error(set, number_range, k, real_1 + i - 1, '0.0 AND UP')
            else if (set%cards(k)%real(i) > 0.0_wp) then
               one%size_of = set%cards(k)%real(i)
               one%text = number_text(set%cards(k), i)
               n = n + 1
               list(n) = one
            end if
         end do
      end if
   end subroutine read_tolerances

   !> Real number `i` of `card` as it stands there or on its `*` card.
   pure function number_text(card, i) result(text)
      type(parsed_card_t), intent(in) :: card
      integer, intent(in) :: i
      character(24) :: text

      if (card%on_star(i)) then
         text = field_text(card%star, wide_fields(i))
      else
         text = field_text(card%card, card_fields(real_1 + i - 1))
      end if
   end function number_text

   !> Number `i` of card `k` of any form, as `number_of` knows it.
   function number_on_card(set, k, i) result(one)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: k, i
      type(tolerance_t) :: one
      type(place_t) :: at
      integer :: j

      do j = 1, k
         call follow_drives(set, j, at)
      end do
      one = number_of(set, k, i, at)
   end function number_on_card

   !> Number `i` of card `k`, its tolerance still open; its kind is 0 where it takes none. `at`: the drive and term that
   !> card `k` belongs to, if it does.
   function number_of(set, k, i, at) result(one)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: k, i
      type(place_t), intent(in) :: at
      type(tolerance_t) :: one
      character(label_length) :: angle

      one = tolerance_t(kind=0, place=i, unit_name=set%mechanism%length_unit)
      if (i > reals_of(set%cards(k)%form, set%cards(k)%label(label_a))) return
      angle = merge('DEG', 'RAD', set%mechanism%degrees)
      associate (card => set%cards(k))
         select case (card%form)
         case (form_ground)
            one%subject = findloc(set%named(request_link)%card, k, dim=1)
            if (has_joint(set, one%subject)) return
            call name_it(number_ground, 'GROUND '//trim(card%label(label_a))//' '//ground_words(i))
            if (i == 3) call take_angle
         case (form_point)
            one%subject = findloc(set%named(request_point)%card, k, dim=1)
            call name_it(number_point, 'POINT '//trim(card%label(label_a))//' '//point_words(i))
         case (form_joint)
            one%subject = card%point
            call name_it(number_joint, 'JOINT '//trim(card%label(label_a))//' '//ground_words(i))
         case (form_prism)
            one%subject = findloc(set%named(request_pair)%card, k, dim=1)
            call name_it(number_pair, 'PRISM '//trim(card%label(label_c))//' '//guide_words(i))
            if (i /= 2) call take_angle
         case (form_drive, form_add, form_rise)
            if (at%drive == 0) return
            one%subject = at%drive
            one%term = at%term
            call take_law(set, set%cards(at%card), card, at%row, angle, one)
         end select
      end associate

   contains

      !> Its kind and its name.
      subroutine name_it(kind, name)
         integer, intent(in) :: kind
         character(*), intent(in) :: name

         one%kind = kind
         one%name = name
      end subroutine name_it

      !> It is an angle.
      subroutine take_angle
         one%unit = set%angle_unit
         one%powers = 0.0_wp
         one%unit_name = angle
      end subroutine take_angle
   end function number_of

   !> A JOINT card gives its place in the drawing: what the axes of a ground link change then is no dimension.
   pure logical function has_joint(set, link)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: link
      integer :: i

      has_joint = .false.
      do i = 1, size(set%mechanism%points)
         if (set%mechanism%points(i)%link == link) &
            has_joint = has_joint .or. set%cards(set%named(request_point)%card(i))%form == form_joint
      end do
   end function has_joint

   !> Number `one` is on `card`, a card of the law of the drive on the card `drive`: its kind, name and unit. `row`: of
   !> a table. `angle`: the name of the deck's unit of angles.
   subroutine take_law(set, drive, card, row, angle, one)
      type(card_set_t), intent(in) :: set
      type(parsed_card_t), intent(in) :: drive, card
      integer, intent(in) :: row
      character(*), intent(in) :: angle
      type(tolerance_t), intent(inout) :: one
      character(:), allocatable :: value, time, word
      integer :: kind

      kind = findloc(drive_words, drive%label(label_a), dim=1)
      if (kind == 0) return
      time = '/'//trim(set%mechanism%time_unit)
      value = trim(set%mechanism%length_unit)
      if (driven_kinds(kind) == request_link) then
         value = trim(angle)
         one%unit = set%angle_unit
         one%powers = 0.0_wp
      end if
      one%unit_name = value
      select case (card%form)
      case (form_drive)
         word = drive_numbers(one%place)
         if (one%place == 2) one%unit_name = value//time
         if (one%place == 3) one%unit_name = value//time//'**2'
         one%powers(2) = real(1 - one%place, wp)
         if (one%place == 2 .and. card%label(label_c) == turns_a_minute) then
            one%unit_name = turns_a_minute
            one%unit = turns_unit(set)
         end if
      case (form_rise)
         word = rise_numbers(one%place)
         if (one%place < 3) then
            one%unit = 1.0_wp
            one%powers = [0.0_wp, 1.0_wp]
            one%unit_name = set%mechanism%time_unit
         end if
      case default
         call take_term(set, card, row, value//time, angle, one, word)
         if (.not. allocated(word)) return
      end select
      one%kind = number_drive
      one%name = trim(drive%label(label_a))//' '//drive%label(label_b)
      if (kind == drive_relangle) one%name = trim(one%name)//' '//drive%label(label_c)
      if (card%form /= form_drive) one%name = trim(one%name)//' '//trim(card%label(label_a))//' '//whole(one%term)
      one%name = trim(one%name)//' '//word
   end subroutine take_law

   !> The same of the ADD card `card`: the unit and the `word` of its number, which stays unallocated where that takes
   !> no tolerance. `rate`: the name of the unit of the drive's rate.
   subroutine take_term(set, card, row, rate, angle, one, word)
      type(card_set_t), intent(in) :: set
      type(parsed_card_t), intent(in) :: card
      integer, intent(in) :: row
      character(*), intent(in) :: rate, angle
      type(tolerance_t), intent(inout) :: one
      character(:), allocatable, intent(out) :: word

      if (card%label(label_a) == term_words(term_table)) then
         ! The times of a table are those at which its values are meant.
         if (one%place == 1) return
         word = 'ROW '//whole(row)
         one%place = row
      else if (card%label(label_a) == term_words(term_power)) then
         ! The power says what kind of function it is.
         if (one%place == 2) return
         word = 'FACTOR'
         one%powers(2) = -card%real(2)
         one%unit_name = rate//'**R2'
      else
         word = harmonic_words(one%place)
         if (one%place == 1) return
         one%unit = set%angle_unit
         one%powers = [0.0_wp, real(one%place - 3, wp)]
         one%unit_name = angle
         if (one%place == 2) one%unit_name = trim(angle)//'/'//trim(set%mechanism%time_unit)
      end if
   end subroutine take_term
end module deck_tolerances
