!> One set of computations while it is read: its cards, the mechanism made of them at END, the deck's errors.
!> A name may be used before the card that defines it, so names are looked up only at END.
module card_sets
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_link, request_pair
   use cards, only: form_end, card_fields, wide_fields, label_a, label_c, real_1, real_2, real_3
   use card_reader, only: parsed_card_t
   use failures, only: failure_t, fail, status_system
   use input_errors, only: error_code_t, input_errors_t, add_field_error, link_unknown, point_unknown, &
      pair_unknown, name_repeated
   use names, only: name_table_t, put_name, find_name
   use numerals, only: whole
   implicit none
   private
   public :: card_set_t, begin_set, append_card, cards_of, define_name, look_up, match_word, add_card_error

   !> The links, the points or the pairs of a set.
   type :: named_t
      integer, allocatable :: card(:)               !< the cards that define them
      type(name_table_t) :: table                   !< from their names to their places in `card`
   end type named_t

   type :: card_set_t
      integer :: count = 0
      type(parsed_card_t), allocatable :: cards(:)  !< (count), with room behind
      integer :: number_of(0:form_end) = 0          !< cards of each form
      logical :: names_certain = .true.             !< of every card: no missing name may be one misread
      real(wp) :: angle_unit = 1.0_wp               !< the deck's unit of angles in radians
      type(named_t) :: named(request_link:request_pair)
      type(mechanism_t) :: mechanism
      type(input_errors_t) :: errors                !< of the deck up to here
   end type card_set_t

   integer, parameter :: first_room = 64
   !> The errors of names that no link, no point, no pair has.
   type(error_code_t), parameter :: unknown(request_link:request_pair) = [link_unknown, point_unknown, pair_unknown]

contains

   !> Makes `set` empty for the set of computations `number`; the errors of the deck stay.
   subroutine begin_set(set, number)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: number
      integer :: kind

      set%count = 0
      if (allocated(set%cards)) deallocate (set%cards)
      set%number_of = 0
      set%names_certain = .true.
      set%angle_unit = 1.0_wp
      do kind = request_link, request_pair
         set%named(kind) = named_t()
      end do
      set%mechanism = mechanism_t(set_number=number)
   end subroutine begin_set

   !> Appends a card. Errors: status_system, if there is no memory for it.
   subroutine append_card(set, card, failure)
      type(card_set_t), intent(inout) :: set
      type(parsed_card_t), intent(in) :: card
      type(failure_t), allocatable, intent(out) :: failure
      type(parsed_card_t), allocatable :: larger(:)
      integer :: status

      if (.not. allocated(set%cards)) allocate (set%cards(first_room))
      if (set%count == size(set%cards)) then
         allocate (larger(2*set%count), stat=status)
         if (status /= 0) then
            call fail(failure, status_system, 'NOT ENOUGH MEMORY FOR THE DECK')
            return
         end if
         larger(1:set%count) = set%cards
         call move_alloc(larger, set%cards)
      end if
      set%count = set%count + 1
      set%cards(set%count) = card
      set%number_of(card%form) = set%number_of(card%form) + 1
      set%names_certain = set%names_certain .and. card%names_certain
   end subroutine append_card

   !> The places of all cards of some forms, in the order of the deck.
   pure function cards_of(set, forms_asked) result(places)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: forms_asked(:)
      integer :: places(sum(set%number_of(forms_asked)))
      integer :: k, n

      n = 0
      do k = 1, set%count
         if (n == size(places)) return
         if (all(set%cards(k)%form /= forms_asked)) cycle
         n = n + 1
         places(n) = k
      end do
   end function cards_of

   !> Enters the name that label `i` (label_a to label_c) of the card of link, point or pair (`kind`) number `n` gives.
   !> A name that is there already is an error.
   subroutine define_name(set, kind, n, i)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: kind, n, i
      integer :: k, earlier

      k = set%named(kind)%card(n)
      if (set%cards(k)%label(i) == '') return
      call put_name(set%named(kind)%table, set%cards(k)%label(i), n, earlier)
      if (earlier == 0) return
      call add_card_error(set, name_repeated, k, i, whole(set%cards(set%named(kind)%card(earlier))%card%number))
   end subroutine define_name

   !> The number `n` of the link, point or pair (`kind`) that label `i` (label_a to label_c) of card `k` names; 0 if the
   !> label is blank, an error of its own, or unknown: an error unless a card that may define it could not be read.
   subroutine look_up(set, kind, k, i, n)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: kind, k, i
      integer, intent(out) :: n

      n = 0
      if (set%cards(k)%label(i) == '') return
      n = find_name(set%named(kind)%table, set%cards(k)%label(i))
      if (n == 0 .and. set%names_certain) call add_card_error(set, unknown(kind), k, i)
   end subroutine look_up

   !> The place in `words` of label A of card `k`; 0 if it is none of them, which is the error `code` of a card without
   !> other errors.
   subroutine match_word(set, k, words, code, place)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k
      character(*), intent(in) :: words(:)
      type(error_code_t), intent(in) :: code
      integer, intent(out) :: place

      place = findloc(words, set%cards(k)%label(label_a), dim=1)
      if (place == 0 .and. set%cards(k)%valid) call add_card_error(set, code, k, label_a)
   end subroutine match_word

   !> The error `code` about `field` (card_name, label_a to real_3) of card `k`; a real may stand on its `*` card.
   !> `more` ends the sentence.
   subroutine add_card_error(set, code, k, field, more)
      type(card_set_t), intent(inout) :: set
      type(error_code_t), intent(in) :: code
      integer, intent(in) :: k, field
      character(*), intent(in), optional :: more

      associate (card => set%cards(k))
         if (any(card%on_star .and. field == [real_1, real_2, real_3])) then
            call add_field_error(set%errors, code, card%star, wide_fields(field - label_c), more)
         else
            call add_field_error(set%errors, code, card%card, card_fields(field), more)
         end if
      end associate
   end subroutine add_card_error
end module card_sets
