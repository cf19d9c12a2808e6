!> Level 7. The GROUND, LINK, POINT, REVOLUTE and PRISM cards of a set.
module deck_bodies
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_revolute, pair_prismatic
   use card_forms, only: form_ground, form_link, form_point, form_revolute, form_prism
   use complaints, only: complaints_t, whole_text
   use deck_codes, only: code_t, name_repeated, link_unknown, point_unknown, pair_one_link, pair_grounds
   use drafts, only: draft_t, cards_of, complain_label
   use names, only: name_table_t, put_name, find_name
   implicit none
   private
   public :: build_bodies, find_label

contains

   !> Makes `set`%links, points and pairs of the cards. `angle_unit` is the deck's unit of angles in radians.
   subroutine build_bodies(draft, angle_unit, set, list)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: angle_unit
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list

      call build_links(draft, angle_unit, set, list)
      call build_points(draft, set, list)
      call build_pairs(draft, angle_unit, set, list)
   end subroutine build_bodies

   !> The number in `table` of the name that label `i` of card `k` gives; 0 if it is blank (told already) or
   !> not known. That is told unless a card could not be read that may have defined it.
   subroutine find_label(draft, table, k, i, unknown, number, list)
      type(draft_t), intent(in) :: draft
      type(name_table_t), intent(in) :: table
      integer, intent(in) :: k, i
      type(code_t), intent(in) :: unknown
      integer, intent(out) :: number
      type(complaints_t), intent(inout) :: list

      number = 0
      if (draft%cards(k)%label(i) == '') return
      number = find_name(table, draft%cards(k)%label(i))
      if (number == 0 .and. draft%names_sure) call complain_label(list, unknown, draft, k, i, '')
   end subroutine find_label

   !> Enters the name that label `i` of card `k` gives.
   subroutine define_label(draft, table, k, i, number, card_of, list)
      type(draft_t), intent(in) :: draft
      type(name_table_t), intent(inout) :: table
      integer, intent(in) :: k, i, number
      integer, intent(inout) :: card_of(:)
      type(complaints_t), intent(inout) :: list
      integer :: earlier

      card_of(number) = k
      if (draft%cards(k)%label(i) == '') return
      call put_name(table, draft%cards(k)%label(i), number, earlier)
      if (earlier > 0) call complain_label(list, name_repeated, draft, k, i, &
                                           whole_text(draft%cards(card_of(earlier))%card%number))
   end subroutine define_label

   subroutine build_links(draft, angle_unit, set, list)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: angle_unit
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list
      integer :: k, n

      n = cards_of(draft, form_ground) + cards_of(draft, form_link)
      allocate (set%links(n), draft%link_card(n))
      n = 0
      do k = 1, draft%count
         associate (card => draft%cards(k))
            if (card%form /= form_ground .and. card%form /= form_link) cycle
            n = n + 1
            set%links(n)%name = card%label(1)
            set%links(n)%ground = card%form == form_ground
            set%links(n)%position = card%real*[1.0_wp, 1.0_wp, angle_unit]
         end associate
         call define_label(draft, draft%links, k, 1, n, draft%link_card, list)
      end do
   end subroutine build_links

   subroutine build_points(draft, set, list)
      type(draft_t), intent(inout) :: draft
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list
      integer :: k, n

      n = cards_of(draft, form_point)
      allocate (set%points(n), draft%point_card(n))
      n = 0
      do k = 1, draft%count
         if (draft%cards(k)%form /= form_point) cycle
         n = n + 1
         set%points(n)%name = draft%cards(k)%label(1)
         set%points(n)%offset = draft%cards(k)%real(1:2)
         call define_label(draft, draft%points, k, 1, n, draft%point_card, list)
         call find_label(draft, draft%links, k, 2, link_unknown, set%points(n)%link, list)
      end do
   end subroutine build_points

   subroutine build_pairs(draft, angle_unit, set, list)
      type(draft_t), intent(inout) :: draft
      real(wp), intent(in) :: angle_unit
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list
      integer :: k, n

      n = cards_of(draft, form_revolute) + cards_of(draft, form_prism)
      allocate (set%pairs(n), draft%pair_card(n))
      n = 0
      do k = 1, draft%count
         if (draft%cards(k)%form /= form_revolute .and. draft%cards(k)%form /= form_prism) cycle
         n = n + 1
         associate (pair => set%pairs(n), card => draft%cards(k))
            pair%kind = merge(pair_revolute, pair_prismatic, card%form == form_revolute)
            pair%name = card%label(3)
            pair%alpha = card%real(1)*angle_unit
            pair%offset = card%real(2)
            pair%beta = card%real(3)*angle_unit
            call find_label(draft, draft%points, k, 1, point_unknown, pair%point_i, list)
            call find_label(draft, draft%points, k, 2, point_unknown, pair%point_j, list)
         end associate
         call define_label(draft, draft%pairs, k, 3, n, draft%pair_card, list)
         call check_pair(draft, k, set, n, list)
      end do
   end subroutine build_pairs

   !> A pair joins two links, not both of them ground.
   subroutine check_pair(draft, k, set, n, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k, n
      type(mechanism_t), intent(in) :: set
      type(complaints_t), intent(inout) :: list
      integer :: link_i, link_j

      if (set%pairs(n)%point_i == 0 .or. set%pairs(n)%point_j == 0) return
      link_i = set%points(set%pairs(n)%point_i)%link
      link_j = set%points(set%pairs(n)%point_j)%link
      if (link_i == 0 .or. link_j == 0) return
      if (link_i == link_j) then
         call complain_label(list, pair_one_link, draft, k, 3, trim(set%links(link_i)%name))
      else if (set%links(link_i)%ground .and. set%links(link_j)%ground) then
         call complain_label(list, pair_grounds, draft, k, 3, '')
      end if
   end subroutine check_pair
end module deck_bodies
