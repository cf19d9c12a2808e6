!> The LENGTH cards of a set: exact distances of two points of a link, or of the ground, which the drawing shows
!> approximately. Numbers as drawn come from the drawing before lengths.
module deck_lengths
   use kinds, only: wp
   use mechanism
   use card_sets, only: card_set_t, joint_points, look_up, add_card_error
   use drawn_lengths, only: reach_t, body_of, is_movable, join_hole, apply_lengths, same_place_tolerance
   use cards
   use input_errors
   use deck_remarks, only: drawn_text
   use drawn_values, only: drawn_place
   use number_format, only: whole
   implicit none
   private
   public :: build_lengths

contains

   !> Builds the lengths of a mechanism from the LENGTH cards, and applies them to the drawing. Bodies and drives must
   !> have been built. The lengths of one hole Q are applied together, holes in the order in which they first appear.
   !> Errors are:
   !>
   !> - a length that is not of two points of one body;
   !> - a hole that moves after a length has used it;
   !> - lengths that do not meet, or that later lengths change.
   subroutine build_lengths(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(length_t) :: lengths(set%number_of(form_length))
      type(reach_t) :: reached(set%number_of(form_length))
      integer, allocatable :: card_of(:), order(:)     ! (lengths) the card of each; their order
      integer :: k, n, i, j

      if (set%number_of(form_length) == 0) return
      card_of = pack([(k, k=1, set%count)], set%cards(:set%count)%form == form_length .and. set%cards(:set%count)%valid)
      n = size(card_of)
      do i = 1, n
         call read_length(set, card_of(i), lengths(i))
      end do
      if (set%errors%count > 0) return

      set%drawing = set%mechanism
      associate (m => set%mechanism)
         do i = 1, n
            do j = 1, 2
               call join_hole(m, lengths(i)%point(j))
               lengths(i)%hole(j) = m%points(lengths(i)%point(j))%hole
            end do
         end do

         order = [integer ::]
         do i = 1, n
            if (all(lengths(:i - 1)%hole(2) /= lengths(i)%hole(2))) &
               order = [order, pack([(j, j=i, n)], lengths(i:n)%hole(2) == lengths(i)%hole(2))]
         end do
         m%lengths = lengths(order)
         card_of = card_of(order)
         set%cards(card_of)%subject = [(i, i=1, n)]
         do i = 1, n
            call check_order(i)
         end do
         if (set%errors%count > 0) return

         call apply_lengths(m, reached)
         do i = 1, n
            if (reached(i)%has_no_side) then
               call add_card_error(set, merge(length_side, length_place, reached(i)%has_two), card_of(i), label_b)
            else if (reached(i)%missing > 0.0_wp) then
               call add_card_error(set, length_missing, card_of(i + 1), real_1, amount(reached(i)%missing))
            end if
         end do
         if (set%errors%count > 0) return
         do i = 1, n
            call check_length(i)
         end do
      end associate

   contains

      !> Checks a length in its order: its points are two holes, no earlier length has used Q as its P, and Q has at
      !> most two lengths, from two holes. Anything else is an error.
      subroutine check_order(i)
         integer, intent(in) :: i            !< number of the length
         integer :: used, one

         associate (list => set%mechanism%lengths)
            used = findloc(list(:i - 1)%hole(1), list(i)%hole(2), dim=1)
            one = findloc(list(:i)%hole(2), list(i)%hole(2), dim=1)
            if (list(i)%hole(1) == list(i)%hole(2)) then
               call add_card_error(set, length_place, card_of(i), label_b)
            else if (used > 0 .and. one == i) then
               call add_card_error(set, length_used, card_of(i), label_b, whole(set%cards(card_of(used))%card%number))
            else if (i - one == 2) then
               call add_card_error(set, length_third, card_of(i), label_b, whole(set%cards(card_of(one))%card%number))
            else if (i - one == 1 .and. list(one)%hole(1) == list(i)%hole(1)) then
               call add_card_error(set, repeated, card_of(i), label_b, whole(set%cards(card_of(one))%card%number))
            end if
         end associate
      end subroutine check_order

      !> Checks a length after all lengths have been applied: another distance of its points is an error.
      subroutine check_length(i)
         integer, intent(in) :: i            !< number of the length
         real(wp) :: position(2, 2), apart
         integer :: j

         associate (m => set%mechanism, one => set%mechanism%lengths(i))
            do j = 1, 2
               position(:, j) = drawn_place(m, one%point(j))
            end do
            apart = norm2(position(:, 2) - position(:, 1))
            if (abs(apart - one%length) > 4.0_wp*same_place_tolerance*(one%length + norm2(position))) &
               call add_card_error(set, length_open, card_of(i), real_1, amount(apart))
         end associate
      end subroutine check_length

      !> Gives a length as text, with the deck's unit.
      function amount(value) result(text)
         real(wp), intent(in) :: value       !< in the deck's unit of length
         character(:), allocatable :: text

         text = drawn_text(value)//' '//trim(set%mechanism%length_unit)
      end function amount
   end subroutine build_lengths

   !> Reads a LENGTH card: its points on one body, and its length. An unknown name, a blank or negative length, and
   !> points that are not on exactly one common body, or cannot be moved, are errors.
   subroutine read_length(set, k, one)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: k            !< number of the card in the set
      type(length_t), intent(inout) :: one   !< gets its points, its link and its length
      integer :: ends(2), link, i, label, common
      integer, allocatable :: p(:), q(:)

      associate (card => set%cards(k), m => set%mechanism)
         do label = label_a, label_b
            call look_up(set, request_point, k, label, ends(label - label_a + 1))
         end do
         link = 0
         if (card%label(label_c) /= '') call look_up(set, request_link, k, label_c, link)
         if (.not. card%given(1)) then
            call add_card_error(set, field_blank, k, real_1)
         else if (card%real(1) <= 0.0_wp) then
            call add_card_error(set, number_range, k, real_1, 'ABOVE 0.0')
         end if
         one%length = card%real(1)
         one%link = card%label(label_c)
         if (any(ends == 0) .or. (link == 0 .and. one%link /= '')) return
         if (ends(1) == ends(2)) then
            call add_card_error(set, point_twice, k, label_b)
            return
         end if

         p = joint_points(set, ends(1))
         q = joint_points(set, ends(2))
         if (any(m%points([p, q])%link == 0)) return
         common = 0
         do i = 1, size(p)
            do label = 1, size(q)
               if (body_of(m, p(i)) /= body_of(m, q(label))) cycle
               if (link > 0) then
                  if (body_of(m, p(i)) /= merge(0, link, m%links(link)%ground)) cycle
               end if
               common = common + 1
               one%point = [p(i), q(label)]
            end do
         end do

         if (common == 0 .and. link > 0) then
            call add_card_error(set, length_off, k, label_c)
         else if (common == 0) then
            call add_card_error(set, length_apart, k, label_b)
         else if (common > 1) then
            call add_card_error(set, length_several, k, label_c)
         else
            do i = 1, 2
               if (.not. is_movable(m, one%point(i))) call add_card_error(set, length_exact, k, label_a + i - 1)
            end do
         end if
      end associate
   end subroutine read_length
end module deck_lengths
