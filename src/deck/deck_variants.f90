!> The TOLER and VARY cards of a set. They give tolerances, or a range or a list of values, to numbers of the card above
!> them. A variant is the cards of the set with other numbers, built like the cards of any set. Therefore numbers as
!> drawn, revolutions per minute, degrees and all checks need no code of their own. Numbers that are not tied to one
!> another make a grid; the last number changes fastest.
module deck_variants
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp, label_length
   use mechanism
   use parameters, only: unit_t, takes_tolerance, parameter_name, parameter_unit, set_parameter
   use card_sets, only: card_set_t, begin_mechanism, has_drawing, look_up, add_card_error, real_text
   use drawn_lengths, only: join_hole
   use cards
   use input_errors
   use numbers, only: read_whole
   use number_format, only: whole
   implicit none
   private
   public :: build_tolerances, parameter_on_card, variation_t, varied_t, build_variation, apply_variant, &
      values_of_variant

   !> The largest number of variants of a set: seven digits fit into LABEL-B and into the tables.
   integer, parameter :: max_variants = 9999999
   !> The word of a VARY card with a list of values.
   character(*), parameter :: list_word = 'LIST'
   !> The word of a TOLER card for both holes of a joint together.
   character(*), parameter :: both_word = 'BOTH'
   !> The words of a VARY card for the reals of the card above it.
   character(2), parameter :: real_words(3) = ['R1', 'R2', 'R3']
   !> The cards whose numbers can vary, and the kinds of these numbers.
   integer, parameter :: varied_forms(*) = [form_ground, form_link, form_point, form_prism, form_slot, form_joint, &
      form_drive, form_add, form_rise, form_time, form_length, form_cylinder]
   integer, parameter :: parameter_kinds(*) = [parameter_link, parameter_link, parameter_point, parameter_pair, &
      parameter_pair, parameter_joint, parameter_drive, parameter_drive, parameter_drive, parameter_time, &
      parameter_length, parameter_stroke]

   !> A number that varies.
   type :: varied_t
      integer :: card = 0, place = 0                !< its card in the set; which real of the card, 1 to 3
      integer :: vary = 0                           !< its first VARY card, in set%cards
      integer :: axis = 0                           !< the axis of the grid along which it changes
      integer :: count = 0                          !< number of its values
      real(wp) :: first = 0.0_wp, last = 0.0_wp     !< ends of a range, in the deck's units
      real(wp), allocatable :: list(:)              !< (count) values of a list, in the deck's units
      character(4*label_length) :: owner = ''       !< the card, its name or its drive: POINT A, ANGLE CRANK HARMONIC 1
      character(2*label_length) :: word = ''        !< the card's word for the number: XI, AMPLITUDE
      character(2*label_length + 5) :: unit = ''        !< the deck's unit of the number, as text
      type(parameter_t) :: number                 !< its address in the mechanism
      real(wp) :: factor = 1.0_wp                   !< its unit in the units of `mechanism_t`
      !> Nothing else in the mechanism depends on the number, and no value of it is an error: a variant need not be
      !> built from the cards.
      logical :: stands_alone = .false.
   end type varied_t

   !> The variants of a set.
   type :: variation_t
      type(card_set_t), allocatable :: set          !< its cards, with the numbers of the variant built last
      type(varied_t), allocatable :: numbers(:)     !< (any number) that vary, in the order of the VARY cards
      integer, allocatable :: counts(:)             !< (axes) number of values along each axis of the grid
      integer :: total = 0                          !< number of variants; 0: no VARY cards
   end type variation_t

contains

   !> Builds the tolerances of a mechanism from its TOLER cards, in their order. Bodies and drives must have been built.
   !> A JOINT card has tolerances of the hole of each of its links, of the hole of one link, or of both holes together.
   !> Errors are a card below no card with numbers, a number that takes no tolerance, and a tolerance below zero.
   subroutine build_tolerances(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(tolerance_t) :: list(6*set%number_of(form_toler))
      type(parameter_t) :: number
      integer, allocatable :: holes(:)              ! the points of a JOINT card whose holes have tolerances
      integer :: k, i, j, n, form

      n = 0
      do k = 1, set%count
         if (set%cards(k)%form /= form_toler .or. .not. set%cards(k)%valid) cycle
         associate (card => set%cards(k), above => set%cards(k)%below)
            form = form_end
            if (above > 0) form = set%cards(above)%form
            if (form == form_unknown) cycle

            if (card_forms(form)%reals == 0) then
               call add_card_error(set, card_alone, k, card_name)
            else if (is_second(set, k, above)) then
               call add_card_error(set, card_second, k, card_name)
            else if (card%label(label_a) /= '' .and. form /= form_joint) then
               call add_card_error(set, field_unused, k, label_a)
            else
               call find_holes(k, above, holes)
               if (is_placed(above, holes)) call add_card_error(set, toler_placed, k, card_name)

               do i = 1, 3
                  if (.not. card%given(i)) cycle
                  number = parameter_on_card(set, above, i)
                  if (.not. takes_tolerance(set%mechanism, number)) then
                     call add_card_error(set, toler_none, k, real_1 + i - 1)
                  else if (card%real(i) < 0.0_wp) then
                     call add_card_error(set, number_range, k, real_1 + i - 1, '0.0 AND UP')
                  else if (card%real(i) > 0.0_wp .and. set%errors%count == 0) then
                     if (size(holes) == 0) call add_tolerance(number, card%real(i), real_text(card, i))
                     do j = 1, size(holes)
                        call add_tolerance(parameter_t(parameter_hole, holes(j), 0, i), card%real(i), real_text(card, &
                           i))
                     end do
                  end if
               end do
            end if
         end associate
      end do

      if (n > 0) set%mechanism%tolerances = list(:n)

   contains

      !> Finds the points of a JOINT card whose holes have the tolerances of a TOLER card, and joins all points of the
      !> holes of the joint (`join_hole`). A name that is no link of the joint is an error.
      subroutine find_holes(k, above, holes)
         integer, intent(in) :: k            !< number of the TOLER card
         integer, intent(in) :: above        !< number of the card above it
         integer, allocatable, intent(out) :: holes(:)   !< (0 to 2) points; none: no JOINT, or both move together
         integer :: i, link

         allocate (holes(0))
         if (set%cards(above)%form /= form_joint .or. set%cards(above)%subject == 0) return
         holes = set%cards(above)%subject + [0, 1]
         if (any(set%mechanism%points(holes)%link == 0)) return
         do i = 1, 2
            call join_hole(set%mechanism, holes(i))
         end do
         if (set%cards(k)%label(label_a) == both_word) then
            deallocate (holes)
            allocate (holes(0))
         else if (set%cards(k)%label(label_a) /= '') then
            call look_up(set, request_link, k, label_a, link)
            if (link > 0 .and. all(set%mechanism%points(holes)%link /= link)) &
               call add_card_error(set, toler_link, k, label_a)
            holes = pack(holes, set%mechanism%points(holes)%link == link)
         end if
      end subroutine find_holes

      !> Tells whether two lengths give the position of a hole of a TOLER card or, if the card moves its points
      !> together, the positions of all these points.
      logical function is_placed(above, holes)
         integer, intent(in) :: above        !< number of the card above the TOLER card
         integer, intent(in) :: holes(:)     !< (0 to 2) points, as `find_holes` gives them
         integer, allocatable :: points(:)
         integer :: j

         is_placed = .false.
         associate (card => set%cards(above), m => set%mechanism)
            if (all(card%form /= [form_point, form_joint]) .or. card%subject == 0) return
            if (.not. allocated(m%lengths)) return
            points = holes
            if (size(holes) == 0) points = [(j, j=card%subject, card%subject + merge(1, 0, card%form == form_joint))]
            associate (by_two => [(m%points(points(j))%hole > 0 .and. &
                  count(m%lengths%hole(2) == m%points(points(j))%hole) == 2, j=1, size(points))])
               is_placed = merge(all(by_two), any(by_two), size(holes) == 0)
            end associate
         end associate
      end function is_placed

      !> Adds the tolerance of a number to the list of tolerances.
      subroutine add_tolerance(number, size_of, text)
         type(parameter_t), intent(in) :: number   !< its address
         real(wp), intent(in) :: size_of     !< the tolerance, in the unit of the number on its card
         character(*), intent(in) :: text    !< the tolerance as it stands on its card
         type(unit_t) :: unit

         n = n + 1
         unit = parameter_unit(set%mechanism, number)
         list(n) = tolerance_t(parameter_t=number, size_of=size_of, text=text, &
            name=parameter_name(set%mechanism, number), unit=unit%factor, powers=unit%powers, unit_name=unit%name)
      end subroutine add_tolerance
   end subroutine build_tolerances

   !> Tells whether a TOLER card is a second TOLER card for one card. For a JOINT card each link may have a TOLER card.
   pure logical function is_second(set, k, above)
      type(card_set_t), intent(in) :: set    !< the cards, and the mechanism made of them
      integer, intent(in) :: k            !< number of the TOLER card
      integer, intent(in) :: above        !< number of the card above it
      integer :: i

      is_second = .false.
      do i = above + 1, k - 1
         if (set%cards(i)%form /= form_toler) cycle
         associate (labels => [set%cards(i)%label(label_a), set%cards(k)%label(label_a)])
            is_second = is_second .or. set%cards(above)%form /= form_joint .or. any(labels == '') .or. &
               any(labels == both_word) .or. labels(1) == labels(2)
         end associate
      end do
   end function is_second

   !> Finds the address of the number that a real of a card gives; the kind is 0 if no number of a mechanism is there.
   pure function parameter_on_card(set, k, i) result(number)
      type(card_set_t), intent(in) :: set    !< the cards, and the mechanism made of them
      integer, intent(in) :: k               !< number of the card, of any form
      integer, intent(in) :: i               !< number of the real, 1 to 3
      type(parameter_t) :: number
      integer :: n

      associate (card => set%cards(k))
         number = parameter_t(0, card%subject, card%term, i)
         n = findloc(varied_forms, card%form, dim=1)
         if (n == 0 .or. i > reals_of(card%form, card%label(label_a))) return
         if (parameter_kinds(n) == parameter_drive .and. card%subject == 0) return
         number%kind = parameter_kinds(n)
         if (card%term == 0) return
         if (.not. term_kinds(set%mechanism%drives(card%subject)%terms(card%term)%kind)%has_rows) return
         number%place = card%row
         if (i == 1) number%kind = parameter_knot
      end associate
   end function parameter_on_card

   !> Builds the variants of a set from its VARY cards, and counts them in its mechanism, which must have been built.
   !> Errors are wrong VARY cards, tied numbers with different counts, and too many variants. If the set has an error,
   !> `variation` is of no use.
   subroutine build_variation(set, variation)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(variation_t), intent(out) :: variation   !< the variants; empty without VARY cards
      type(varied_t) :: one
      integer(int64) :: total
      integer :: i, first

      if (set%number_of(form_vary) == 0) return

      allocate (variation%numbers(0), variation%counts(0))
      do i = 1, set%count
         if (set%cards(i)%form == form_vary .and. set%cards(i)%valid) call read_variation()
      end do

      ! Tied numbers must have equal counts; the grid must not be too large.
      total = 1
      do i = 1, size(variation%numbers)
         one = variation%numbers(i)
         first = findloc(variation%numbers%axis, one%axis, dim=1)
         if (first < i) then
            if (one%count /= variation%numbers(first)%count) call add_card_error(set, vary_tie, one%vary, label_c, &
               whole(set%cards(variation%numbers(first)%vary)%card%number))
            cycle
         end if

         variation%counts(one%axis) = one%count
         total = total*one%count
         if (total <= max_variants) cycle
         call add_card_error(set, vary_many, one%vary, label_b, whole(max_variants))
         total = 1
         exit
      end do
      variation%total = int(total)
      set%mechanism%variants = max(1, variation%total)
      if (set%errors%count > 0) return
      variation%set = set

   contains

      !> Reads the VARY card `i`: a number that varies, or more values of the list on the VARY card above. A VARY card
      !> below no card with numbers, an unknown number and a repeated number are errors.
      subroutine read_variation()
         type(unit_t) :: unit
         character(:), allocatable :: name
         logical :: continues
         integer :: form, n, k, border

         one = varied_t(card=set%cards(i)%below, vary=i)
         associate (card => set%cards(i), above => set%cards(i)%below)
            one%place = findloc(real_words, card%label(label_a), dim=1)
            form = form_vary
            if (above > 0) form = set%cards(above)%form
            if (form == form_unknown) return
            if (all(form /= varied_forms)) then
               call add_card_error(set, card_alone, i, card_name)
               return
            end if
            if (one%place == 0 .or. one%place > reals_of(form, set%cards(above)%label(label_a))) then
               call add_card_error(set, vary_number, i, label_a)
               return
            end if
            call read_values(set, i, one)
            if (one%count == 0) return

            n = findloc(variation%numbers%card == above .and. variation%numbers%place == one%place, .true., dim=1)
            ! More values of the list on the VARY card above.
            continues = card%below == set%cards(i - 1)%below .and. all(card%label == set%cards(i - 1)%label)

            if (n == 0) then
               if (set%errors%count == 0) then
                  one%number = parameter_on_card(set, one%card, one%place)
                  name = parameter_name(set%mechanism, one%number)
                  border = index(name, ' ', back=.true.)
                  one%owner = name(:border - 1)
                  one%word = name(border + 1:)
                  unit = parameter_unit(set%mechanism, one%number)
                  one%unit = unit%name
                  one%factor = unit%factor
                  one%stands_alone = stands_alone(set, form)
               end if

               ! The axis of the number: the axis of the first number with this name of a tie, or a new axis.
               do k = 1, size(variation%numbers)
                  if (card%label(label_c) /= '' .and. &
                      set%cards(variation%numbers(k)%vary)%label(label_c) == card%label(label_c)) one%axis = &
                         variation%numbers(k)%axis
               end do
               if (one%axis == 0) then
                  variation%counts = [variation%counts, 0]
                  one%axis = size(variation%counts)
               end if
               variation%numbers = [variation%numbers, one]
            else if (continues .and. allocated(one%list)) then
               variation%numbers(n)%list = [variation%numbers(n)%list, one%list]
               variation%numbers(n)%count = size(variation%numbers(n)%list)
            else
               call add_card_error(set, repeated, i, label_a, whole(set%cards(variation%numbers(n)%vary)%card%number))
            end if
         end associate
      end subroutine read_variation
   end subroutine build_variation

   !> Reads the values of a number from its VARY card: a list, or the ends of a range and a count. If the card is wrong,
   !> this is an error, and the count of the number stays 0.
   subroutine read_values(set, i, one)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: i               !< number of the VARY card
      type(varied_t), intent(inout) :: one   !< gets `list`, or `first` and `last`, and `count`
      type(error_code_t) :: error
      integer :: count_given, wrong

      associate (card => set%cards(i))
         if (card%label(label_b) == list_word) then
            one%list = pack(card%real, card%given)
            one%count = size(one%list)
            if (one%count == 0) call add_card_error(set, field_blank, i, real_1)
            return
         end if

         call read_whole(trim(card%label(label_b)), count_given, error, wrong)
         if (error%number > 0 .or. count_given < 1 .or. count_given > max_variants) then
            call add_card_error(set, vary_count, i, label_b, whole(max_variants))
         else if (card%given(3) .or. (count_given == 1 .and. card%given(2))) then
            call add_card_error(set, field_unused, i, merge(real_3, real_2, card%given(3)))
         else if (.not. any(card%given(1:2))) then
            call add_card_error(set, field_blank, i, real_1)
         else if (count_given > 1 .and. .not. abs(card%real(2) - card%real(1)) > 0.0_wp) then
            call add_card_error(set, vary_equal, i, real_2)
         else
            one%count = count_given
            one%first = card%real(1)
            one%last = card%real(2)
         end if
      end associate
   end subroutine read_values

   !> Tells whether nothing else in a mechanism depends on the numbers of cards of a form. Other numbers can depend on
   !> them:
   !>
   !> - in a drawing, points of JOINT cards depend on the positions of links, and numbers as drawn on points and guides;
   !> - the position of the block of a slot depends on the point in the slot;
   !> - whether a term of a drive is defined depends on the times of TIME;
   !> - if TIME counts turns, the last instant depends on the rate;
   !> - whether a cylinder begins with a length above 0 depends on the law of its drive.
   pure logical function stands_alone(set, form)
      type(card_set_t), intent(in) :: set    !< the cards, and the mechanism made of them
      integer, intent(in) :: form            !< of the card: form_ground, ...

      select case (form)
      case (form_ground, form_link, form_point, form_prism, form_slot)
         stands_alone = .not. has_drawing(set) .and. set%number_of(form_slot) == 0
      case (form_time)
         stands_alone = sum(set%number_of([form_add, form_rise])) == 0 .and. .not. (set%mechanism%turns > 0.0_wp .or. &
            any(set%mechanism%pairs%is_cylinder))
      case default
         stands_alone = form == form_drive .and. .not. (set%mechanism%turns > 0.0_wp .or. &
            any(set%mechanism%pairs%is_cylinder))
      end select
   end function stands_alone

   !> Writes the numbers of a variant into an earlier variant. If the mechanism is no earlier variant, or other numbers
   !> may depend on those that vary, writes them to the cards of the variation: the variant must then be built from the
   !> cards.
   subroutine apply_variant(variation, n, m, is_done)
      type(variation_t), intent(inout) :: variation   !< of the set; its cards may get the numbers
      integer, intent(in) :: n               !< number of the variant, 1 to variation%total
      type(mechanism_t), intent(inout) :: m  !< new, or an earlier variant; the variant, if `is_done`
      logical, intent(out) :: is_done        !< `m` is the variant; false: the cards have its numbers
      type(input_errors_t) :: none
      real(wp) :: values(size(variation%numbers))
      integer :: i

      values = values_of_variant(variation, n)
      is_done = m%variant > 0 .and. all(variation%numbers%stands_alone)
      if (is_done) then
         do i = 1, size(values)
            call set_parameter(m, variation%numbers(i)%number, values(i)*variation%numbers(i)%factor)
         end do
         m%variant = n
         ! A TIME card with one time for both ends is an error, which the building of the cards reports.
         is_done = m%steps < 0 .or. abs(m%t1 - m%t0) > 0.0_wp
      end if
      if (is_done) return
      do i = 1, size(values)
         associate (card => variation%set%cards(variation%numbers(i)%card), real_number => variation%numbers(i)%place)
            card%real(real_number) = values(i)
            card%given(real_number) = .true.
         end associate
      end do
      variation%set%errors = none
      call begin_mechanism(variation%set, variation%set%mechanism%set_number)
   end subroutine apply_variant

   !> Gives the values (numbers that vary) of a variant, in the deck's units. The last value of a range is exactly its
   !> end.
   pure function values_of_variant(variation, n) result(values)
      type(variation_t), intent(in) :: variation   !< of the set
      integer, intent(in) :: n               !< number of the variant, 1 to variation%total
      real(wp) :: values(size(variation%numbers))
      integer :: index_on_axis(size(variation%counts)), rest, i, k

      rest = n - 1
      do i = size(index_on_axis), 1, -1
         index_on_axis(i) = mod(rest, variation%counts(i))
         rest = rest/variation%counts(i)
      end do
      do i = 1, size(values)
         associate (one => variation%numbers(i))
            k = index_on_axis(one%axis)
            if (allocated(one%list)) then
               values(i) = one%list(k + 1)
            else if (k > 0 .and. k == one%count - 1) then
               values(i) = one%last
            else
               values(i) = one%first + (one%last - one%first)*real(k, wp)/real(max(1, one%count - 1), wp)
            end if
         end associate
      end do
   end function values_of_variant
end module deck_variants
