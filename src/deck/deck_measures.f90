!> The cards DISTANCE, LINE, ANGLE, XI, ETA and SUM: the measures of a set. A card may name a measure before the card
!> that defines it. A sum of sums becomes the sum of all their terms.
module deck_measures
   use kinds, only: wp
   use mechanism
   use card_sets, only: card_set_t, define_name, look_up, look_up_kinds, add_card_error
   use parameters, only: angle_in_radians
   use cards
   use input_errors
   use name_table, only: find_name
   use independent, only: part_of_links
   implicit none
   private
   public :: build_measures, check_measures

contains

   !> Builds the measures of a mechanism in the order of their cards. Links, points and pairs must have been built.
   !> Errors are unknown names, sums of a length and an angle, and sums that contain themselves.
   subroutine build_measures(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer :: states(size(set%named(request_measure)%card))   ! of sums: 0 not begun, 1 begun, 2 done
      integer :: n, i

      if (size(states) == 0) return
      allocate (set%mechanism%measures(size(states)))
      do n = 1, size(states)
         associate (k => set%named(request_measure)%card(n), one => set%mechanism%measures(n))
            one%kind = set%cards(k)%form - form_distance + measure_distance
            one%name = set%cards(k)%label(label_c)
            one%is_angle = any(one%kind == [measure_line, measure_angle])
            one%continues = one%kind == measure_line
            allocate (one%subjects(0))
         end associate
         call define_name(set, request_measure, n)
      end do

      ! All names are in the table now.
      do n = 1, size(states)
         associate (k => set%named(request_measure)%card(n), one => set%mechanism%measures(n))
            if (one%kind == measure_angle) then
               call find_sides(set, n)
            else if (one%kind == measure_sum) then
               call find_summands(set, n)
            else
               one%subjects = [subject_t(kind=request_point), subject_t(kind=request_point)]
               if (any(one%kind == [measure_xi, measure_eta])) one%subjects(2)%kind = request_link
               do i = 1, 2
                  call look_up(set, one%subjects(i)%kind, k, label_a + i - 1, one%subjects(i)%number)
               end do
               if (one%subjects(2)%kind == request_point .and. set%cards(k)%valid .and. &
                  set%cards(k)%label(label_a) == set%cards(k)%label(label_b)) &
                  call add_card_error(set, point_twice, k, label_b)
            end if
         end associate
      end do

      states = 0
      do n = 1, size(states)
         if (set%mechanism%measures(n)%kind == measure_sum) call add_up(n)
      end do

   contains

      !> Replaces sums among the subjects of a sum by their terms, recursively, and finds the kind and the constant of
      !> the sum. A sum that contains itself, or adds a length and an angle, is an error.
      recursive subroutine add_up(i)
         integer, intent(in) :: i            !< number of the measure, a sum
         type(subject_t), allocatable :: own(:), terms(:), further(:)
         logical :: is_angle(2)
         integer :: j, k

         if (states(i) == 2) return
         k = set%named(request_measure)%card(i)
         associate (measure => set%mechanism%measures(i))
            if (states(i) == 1) then
               ! The sum contains itself.
               call add_card_error(set, sum_refused, k, label_a)
               measure%subjects = [subject_t ::]
               states(i) = 2
               return
            end if

            states(i) = 1
            own = measure%subjects
            allocate (terms(0))
            do j = 1, size(own)
               further = own(j:j)
               if (own(j)%kind == request_pair) then
                  is_angle(j) = .not. has_guide(set%mechanism%pairs(own(j)%number)%kind)
               else
                  associate (one => set%mechanism%measures(own(j)%number))
                     if (one%kind == measure_sum) then
                        call add_up(own(j)%number)
                        further = one%subjects
                        further%factor = own(j)%factor*further%factor
                     end if
                     is_angle(j) = one%is_angle
                     measure%constant = measure%constant + own(j)%factor*one%constant
                  end associate
               end if

               call add_terms(further, terms)
            end do

            if (states(i) == 2) return
            states(i) = 2
            if (size(own) == 2) then
               if (is_angle(1) .neqv. is_angle(2)) call add_card_error(set, sum_refused, k, label_b)
            end if
            if (size(own) > 0) measure%is_angle = is_angle(1)
            measure%subjects = terms
            measure%constant = measure%constant &
               + set%cards(k)%real(3)*merge(angle_in_radians(set%mechanism), 1.0_wp, measure%is_angle)
         end associate
      end subroutine add_up
   end subroutine build_measures

   !> Finds the two lines or links of an ANGLE card. An unknown name, a name of both a line and a link, and one name
   !> twice are errors.
   subroutine find_sides(set, n)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: n               !< number of the measure
      type(subject_t) :: sides(2)
      integer :: i, k, link

      k = set%named(request_measure)%card(n)
      do i = 1, 2
         associate (one => sides(i), name => set%cards(k)%label(label_a + i - 1))
            link = find_name(set%named(request_link)%table, name)
            one = subject_t(request_measure, find_name(set%named(request_measure)%table, name))
            if (one%number > 0) then
               if (set%mechanism%measures(one%number)%kind /= measure_line) one%number = 0
            end if
            if (one%number > 0 .and. link > 0) then
               call add_card_error(set, side_twofold, k, label_a + i - 1)
            else if (one%number == 0) then
               call look_up_kinds(set, [request_link], side_unknown, k, label_a + i - 1, one%kind, one%number)
            end if
         end associate
      end do

      if (all(sides%number > 0) .and. set%cards(k)%label(label_a) == set%cards(k)%label(label_b)) &
         call add_card_error(set, drive_one_link, k, label_b)
      associate (measure => set%mechanism%measures(n))
         measure%subjects = sides
         measure%continues = any(sides%kind == request_measure)
      end associate
   end subroutine find_sides

   !> Finds the summands of a SUM card, one or two pairs or measures, with their factors: 1 if blank. An unknown name,
   !> and a factor without a summand, are errors.
   subroutine find_summands(set, n)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: n               !< number of the measure
      type(subject_t) :: summands(2)
      integer :: i, k

      k = set%named(request_measure)%card(n)
      associate (card => set%cards(k))
         do i = 1, 2
            call look_up_kinds(set, [request_measure, request_pair], summand_unknown, k, label_a + i - 1, &
               summands(i)%kind, summands(i)%number)
            if (card%given(i)) summands(i)%factor = card%real(i)
         end do
         set%mechanism%measures(n)%subjects = pack(summands, summands%number > 0)
         if (card%label(label_b) == '' .and. card%given(2)) call add_card_error(set, field_unused, k, real_2)
      end associate
   end subroutine find_summands

   !> Adds terms of a sum to a list in which each subject has one term: factors of one subject are added.
   subroutine add_terms(further, terms)
      type(subject_t), intent(in) :: further(:)   !< (any number) the terms
      type(subject_t), allocatable, intent(inout) :: terms(:)   !< (any number) the list, longer afterwards
      integer :: i, j

      do i = 1, size(further)
         j = findloc(terms%kind == further(i)%kind .and. terms%number == further(i)%number, .true., dim=1)
         if (j == 0) then
            terms = [terms, further(i)]
         else
            terms(j)%factor = terms(j)%factor + further(i)%factor
         end if
      end do
   end subroutine add_terms

   !> Checks the measures of a set without errors: a measure of links of several independent mechanisms is an error. A
   !> link that nothing uses must have become ground before.
   subroutine check_measures(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, allocatable :: part(:), parts(:)
      integer :: n, k

      if (.not. allocated(set%mechanism%measures)) return
      part = part_of_links(set%mechanism)
      do n = 1, size(set%mechanism%measures)
         k = set%named(request_measure)%card(n)
         parts = part(measure_links(set%mechanism, set%mechanism%measures(n)))
         parts = pack(parts, parts > 0)
         if (any(parts /= maxval([0, parts]))) call add_card_error(set, centre_apart, k, label_b)
      end do
   end subroutine check_measures
end module deck_measures
