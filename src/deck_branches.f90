!> Level 8. The BRANCH cards of a set.
module deck_branches
   use kinds, only: wp
   use mechanism, only: mechanism_t, choice_t, method_newton
   use card_forms, only: form_branch
   use complaints, only: complaints_t, whole_text
   use deck_bodies, only: find_label
   use deck_codes, only: link_unknown, field_blank, branch_ground, branch_method, branch_repeated
   use drafts, only: draft_t, cards_of, complain_name, complain_label, complain_real
   implicit none
   private
   public :: build_branches

contains

   !> Makes `set`%choices, in the order of the cards. A card that asks for the same as an earlier one is an error: it
   !> may be meant for the next change point.
   subroutine build_branches(draft, set, list)
      type(draft_t), intent(in) :: draft
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list
      integer :: k, n, card_of(cards_of(draft, form_branch))

      allocate (set%choices(cards_of(draft, form_branch)))
      n = 0
      do k = 1, draft%count
         if (draft%cards(k)%form /= form_branch .or. .not. draft%cards(k)%sound) cycle
         n = n + 1
         card_of(n) = k
         call read_branch(draft, k, set, set%choices(n), list)
         call check_repeat(draft, set%choices, card_of(:n), list)
      end do
      set%choices = set%choices(:n)
   end subroutine build_branches

   subroutine read_branch(draft, k, set, choice, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(in) :: set
      type(choice_t), intent(out) :: choice
      type(complaints_t), intent(inout) :: list

      if (set%method /= method_newton) call complain_name(list, branch_method, draft, k, '')
      call find_label(draft, draft%links, k, 1, link_unknown, choice%link, list)
      if (choice%link > 0) then
         if (set%links(choice%link)%ground) call complain_label(list, branch_ground, draft, k, 1, '')
      end if
      if (.not. draft%cards(k)%given(1)) call complain_real(list, field_blank, draft, k, 1, '')
      choice%t = draft%cards(k)%real(1)
   end subroutine read_branch

   !> The last card of `card_of` against those before.
   subroutine check_repeat(draft, choices, card_of, list)
      type(draft_t), intent(in) :: draft
      type(choice_t), intent(in) :: choices(:)
      integer, intent(in) :: card_of(:)
      type(complaints_t), intent(inout) :: list
      integer :: i, n

      n = size(card_of)
      do i = 1, n - 1
         if (choices(i)%link /= choices(n)%link .or. abs(choices(i)%t - choices(n)%t) > 0.0_wp) cycle
         call complain_name(list, branch_repeated, draft, card_of(n), whole_text(draft%cards(card_of(i))%card%number))
         return
      end do
   end subroutine check_repeat
end module deck_branches
