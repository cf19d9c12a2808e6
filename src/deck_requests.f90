!> Level 8. The PRINT cards of a set.
module deck_requests
   use mechanism, only: mechanism_t, request_t, request_link, request_point, request_pair
   use card_forms, only: form_print
   use complaints, only: complaints_t, whole_text
   use deck_bodies, only: find_label
   use deck_codes, only: link_unknown, point_unknown, pair_unknown, print_kind, print_all_name, &
                         print_repeated, print_nothing, number_range
   use drafts, only: draft_t, cards_of, complain_label, complain_choice
   use names, only: name_table_t, put_name
   implicit none
   private
   public :: build_requests

   integer, parameter :: kinds_asked(3) = [request_link, request_point, request_pair]

   !> The requests so far; `asked` marks each link, point and pair that has one.
   type :: asked_t
      integer :: count = 0
      type(request_t), allocatable :: requests(:)
      logical, allocatable :: link(:), point(:), pair(:)
   end type asked_t

contains

   !> Makes `set`%requests, in the order of the cards and each subject once (the first card for it counts).
   !> Without a PRINT card the links that are not ground are asked for.
   subroutine build_requests(draft, set, list)
      type(draft_t), intent(in) :: draft
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list
      type(asked_t) :: asked
      type(name_table_t) :: seen(4)
      integer :: k

      allocate (asked%requests(size(set%links) + size(set%points) + size(set%pairs)))
      allocate (asked%link(size(set%links)), asked%point(size(set%points)), asked%pair(size(set%pairs)), &
                source=.false.)
      if (cards_of(draft, form_print) == 0) call ask_all(set, request_link, 1, asked)
      do k = 1, draft%count
         if (draft%cards(k)%form /= form_print .or. .not. draft%cards(k)%sound) cycle
         call take_print_card(draft, k, set, seen, asked, list)
      end do
      set%requests = asked%requests(1:asked%count)
   end subroutine build_requests

   !> `seen` holds, for ALL, LINKS, POINTS and PAIRS, the names that were asked for and their cards.
   subroutine take_print_card(draft, k, set, seen, asked, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(in) :: set
      type(name_table_t), intent(inout) :: seen(4)
      type(asked_t), intent(inout) :: asked
      type(complaints_t), intent(inout) :: list
      integer :: every, earlier, kind, i
      character(6), parameter :: words(4) = ['ALL   ', 'LINKS ', 'POINTS', 'PAIRS ']

      associate (card => draft%cards(k))
         every = 1
         if (card%whole_given) every = card%whole
         if (every < 1) call complain_label(list, number_range, draft, k, 3, '1 AND UP')
         kind = 0
         do i = 1, size(words)
            if (card%label(1) == words(i)) kind = i
         end do
         if (kind == 0) then
            call complain_choice(list, print_kind, draft, k, 1)
            return
         end if
         call put_name(seen(kind), card%label(2), k, earlier)
         if (earlier > 0) then
            call complain_label(list, print_repeated, draft, k, 1, &
                                whole_text(draft%cards(earlier)%card%number))
         else if (kind > 1) then
            call ask_kind(draft, k, kinds_asked(kind - 1), every, set, asked, list)
         else if (card%label(2) /= '') then
            call complain_label(list, print_all_name, draft, k, 2, '')
         else
            do i = 1, size(kinds_asked)
               call ask_all(set, kinds_asked(i), every, asked)
            end do
         end if
      end associate
   end subroutine take_print_card

   subroutine ask_kind(draft, k, kind, every, set, asked, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k, kind, every
      type(mechanism_t), intent(in) :: set
      type(asked_t), intent(inout) :: asked
      type(complaints_t), intent(inout) :: list
      integer :: subject

      if (draft%cards(k)%label(2) == '') then
         if (subjects(set, kind) == 0 .and. draft%names_sure) &
            call complain_label(list, print_nothing, draft, k, 1, '')
         call ask_all(set, kind, every, asked)
         return
      end if
      select case (kind)
      case (request_link)
         call find_label(draft, draft%links, k, 2, link_unknown, subject, list)
      case (request_point)
         call find_label(draft, draft%points, k, 2, point_unknown, subject, list)
      case default
         call find_label(draft, draft%pairs, k, 2, pair_unknown, subject, list)
      end select
      if (subject > 0) call ask(kind, subject, every, asked)
   end subroutine ask_kind

   pure integer function subjects(set, kind)
      type(mechanism_t), intent(in) :: set
      integer, intent(in) :: kind

      subjects = size(set%links)
      if (kind == request_point) subjects = size(set%points)
      if (kind == request_pair) subjects = size(set%pairs)
   end function subjects

   !> Asks for all of a kind; of the links for those that move.
   subroutine ask_all(set, kind, every, asked)
      type(mechanism_t), intent(in) :: set
      integer, intent(in) :: kind, every
      type(asked_t), intent(inout) :: asked
      integer :: i

      do i = 1, subjects(set, kind)
         if (kind == request_link) then
            if (set%links(i)%ground) cycle
         end if
         call ask(kind, i, every, asked)
      end do
   end subroutine ask_all

   subroutine ask(kind, subject, every, asked)
      integer, intent(in) :: kind, subject, every
      type(asked_t), intent(inout) :: asked
      logical :: again

      select case (kind)
      case (request_link)
         again = asked%link(subject)
         asked%link(subject) = .true.
      case (request_point)
         again = asked%point(subject)
         asked%point(subject) = .true.
      case default
         again = asked%pair(subject)
         asked%pair(subject) = .true.
      end select
      if (again) return
      asked%count = asked%count + 1
      asked%requests(asked%count) = request_t(kind, subject, every)
   end subroutine ask
end module deck_requests
