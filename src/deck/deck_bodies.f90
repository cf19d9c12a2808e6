!> The GROUND, LINK, POINT, REVOLUTE and PRISM cards of a set.
module deck_bodies
   use kinds, only: wp
   use mechanism, only: link_t, point_t, pair_t, pair_revolute, pair_prismatic, request_link, request_point, &
      request_pair
   use card_sets, only: card_set_t, cards_of, define_name, look_up, add_card_error
   use cards, only: label_a, label_b, label_c, form_ground, form_link, form_point, form_revolute, form_prism
   use input_errors, only: pair_one_link, pair_grounds
   implicit none
   private
   public :: build_bodies

contains

   !> Makes the links, points and pairs of `set`%mechanism from the cards. Repeated and unknown names are errors, and so
   !> are pairs that do not join two links.
   subroutine build_bodies(set)
      type(card_set_t), intent(inout) :: set

      call build_links(set)
      call build_points(set)
      call build_pairs(set)
   end subroutine build_bodies

   !> Links: the GROUND and LINK cards in their order.
   subroutine build_links(set)
      type(card_set_t), intent(inout) :: set
      integer :: n

      set%named(request_link)%card = cards_of(set, [form_ground, form_link])
      allocate (set%mechanism%links(size(set%named(request_link)%card)))
      do n = 1, size(set%mechanism%links)
         associate (card => set%cards(set%named(request_link)%card(n)))
            set%mechanism%links(n) = link_t(name=card%label(label_a), ground=card%form == form_ground, &
                                            position=card%real*[1.0_wp, 1.0_wp, set%angle_unit])
         end associate
         call define_name(set, request_link, n, label_a)
      end do
   end subroutine build_links

   !> Points. Their links are there.
   subroutine build_points(set)
      type(card_set_t), intent(inout) :: set
      integer :: k, n, link

      set%named(request_point)%card = cards_of(set, [form_point])
      allocate (set%mechanism%points(size(set%named(request_point)%card)))
      do n = 1, size(set%mechanism%points)
         k = set%named(request_point)%card(n)
         call define_name(set, request_point, n, label_a)
         call look_up(set, request_link, k, label_b, link)
         set%mechanism%points(n) = point_t(name=set%cards(k)%label(label_a), link=link, offset=set%cards(k)%real(1:2))
      end do
   end subroutine build_points

   !> Pairs: the REVOLUTE and PRISM cards in their order. Their points are there.
   subroutine build_pairs(set)
      type(card_set_t), intent(inout) :: set
      integer :: k, n, i, j

      set%named(request_pair)%card = cards_of(set, [form_revolute, form_prism])
      allocate (set%mechanism%pairs(size(set%named(request_pair)%card)))
      do n = 1, size(set%mechanism%pairs)
         k = set%named(request_pair)%card(n)
         call look_up(set, request_point, k, label_a, i)
         call look_up(set, request_point, k, label_b, j)
         associate (card => set%cards(k))
            set%mechanism%pairs(n) = pair_t(kind=merge(pair_revolute, pair_prismatic, card%form == form_revolute), &
               name=card%label(label_c), point_i=i, point_j=j, alpha=card%real(1)*set%angle_unit, offset=card%real(2), &
               beta=card%real(3)*set%angle_unit)
         end associate
         call define_name(set, request_pair, n, label_c)
         if (i > 0 .and. j > 0) call check_links(set, k, set%mechanism%points(i)%link, set%mechanism%points(j)%link)
      end do
   end subroutine build_pairs

   !> The pair of card `k` joins the links `i` and `j` (0: unknown): two links, not both of them ground.
   subroutine check_links(set, k, i, j)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k, i, j

      if (i == 0 .or. j == 0) return
      if (i == j) then
         call add_card_error(set, pair_one_link, k, label_c, trim(set%mechanism%links(i)%name))
      else if (set%mechanism%links(i)%ground .and. set%mechanism%links(j)%ground) then
         call add_card_error(set, pair_grounds, k, label_c)
      end if
   end subroutine check_links
end module deck_bodies
