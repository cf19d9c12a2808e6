!> Level 6. The cards of one set of computations as they were read, before END makes a mechanism
!> of them: names may be used before the card that defines them.
module drafts
   use cards, only: name_field, label_fields, real_fields, wide_fields
   use card_forms, only: form_star, forms
   use card_reader, only: reading_t
   use complaints, only: complaints_t, complain_field, show_layout
   use deck_codes, only: code_t
   use failures, only: failure_t, fail, status_machine
   use names, only: name_table_t
   implicit none
   private
   public :: draft_t, add_reading, cards_of, next_reading
   public :: complain_name, complain_label, complain_choice, complain_real

   type :: draft_t
      integer :: count = 0
      type(reading_t), allocatable :: cards(:)      !< (count), with room behind
      logical :: names_sure = .true.                !< of every card: no missing name may be one misread
      type(name_table_t) :: links, points, pairs    !< name -> place in the mechanism's array
      integer, allocatable :: link_card(:), point_card(:), pair_card(:)  !< where each was defined
   end type draft_t

   integer, parameter :: first_room = 64

contains

   !> Appends a card. Errors: status_machine, if the machine has no memory for it.
   subroutine add_reading(draft, reading, failure)
      type(draft_t), intent(inout) :: draft
      type(reading_t), intent(in) :: reading
      type(failure_t), allocatable, intent(out) :: failure
      type(reading_t), allocatable :: larger(:)
      integer :: status

      if (.not. allocated(draft%cards)) allocate (draft%cards(first_room))
      if (draft%count == size(draft%cards)) then
         allocate (larger(2*draft%count), stat=status)
         if (status /= 0) then
            call fail(failure, status_machine, 'NOT ENOUGH MEMORY FOR THE DECK')
            return
         end if
         larger(1:draft%count) = draft%cards
         call move_alloc(larger, draft%cards)
      end if
      draft%count = draft%count + 1
      draft%cards(draft%count) = reading
      draft%names_sure = draft%names_sure .and. reading%names_sure
   end subroutine add_reading

   !> Number of cards of one form.
   pure integer function cards_of(draft, form)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: form
      integer :: k

      cards_of = 0
      do k = 1, draft%count
         if (draft%cards(k)%form == form) cards_of = cards_of + 1
      end do
   end function cards_of

   !> The card behind card `k` that is no `*` card; draft%count + 1 if there is none.
   pure integer function next_reading(draft, k) result(next)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k

      do next = k + 1, draft%count
         if (draft%cards(next)%form /= form_star) return
      end do
   end function next_reading

   !> A complaint about the name of card `k`.
   subroutine complain_name(list, code, draft, k, more)
      type(complaints_t), intent(inout) :: list
      type(code_t), intent(in) :: code
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      character(*), intent(in) :: more

      call complain_field(list, code, draft%cards(k)%card, name_field, more)
   end subroutine complain_name

   !> A complaint about label `i` of card `k`.
   subroutine complain_label(list, code, draft, k, i, more)
      type(complaints_t), intent(inout) :: list
      type(code_t), intent(in) :: code
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k, i
      character(*), intent(in) :: more

      call complain_field(list, code, draft%cards(k)%card, label_fields(i), more)
   end subroutine complain_label

   !> The same about a word that has to be one of a few, or in another field: the card's layout is shown below.
   subroutine complain_choice(list, code, draft, k, i)
      type(complaints_t), intent(inout) :: list
      type(code_t), intent(in) :: code
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k, i

      call complain_label(list, code, draft, k, i, '')
      call show_layout(list, forms(draft%cards(k)%form)%layout)
   end subroutine complain_choice

   !> A complaint about real `i` of card `k`, wherever it stands.
   subroutine complain_real(list, code, draft, k, i, more)
      type(complaints_t), intent(inout) :: list
      type(code_t), intent(in) :: code
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k, i
      character(*), intent(in) :: more

      if (draft%cards(k)%starred(i)) then
         call complain_field(list, code, draft%cards(k + 1)%card, wide_fields(i), more)
      else
         call complain_field(list, code, draft%cards(k)%card, real_fields(i), more)
      end if
   end subroutine complain_real
end module drafts
