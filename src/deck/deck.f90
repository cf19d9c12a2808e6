!> Reads a card deck to sets of computations. The whole deck is read, and all its errors are reported; nothing is
!> computed from a deck with an error.
module deck
   use mechanism, only: mechanism_t
   use card_reader, only: parsed_card_t, read_card, read_star
   use card_sets, only: card_set_t, begin_set, build_bodies
   use deck_variants, only: variation_t, build_tolerances, build_variation, apply_variant
   use cards
   use deck_measures, only: build_measures, check_measures
   use deck_drives, only: build_drives, set_turns, check_terms
   use deck_lengths, only: build_lengths
   use deck_options, only: build_options, build_requests, build_branches, check_centres
   use deck_remarks, only: check_unused, check_angles, check_drives, check_drawing, build_echo
   use deck_source, only: source_t, open_source, source_of, next_card
   use failures, only: failure_t, fail, status_rejected
   use input_errors
   use number_format, only: whole
   implicit none
   private
   public :: read_deck, read_deck_text, build_variant

   !> The largest number of cards, with comments and blank cards: it bounds the memory.
   integer, parameter :: max_cards = 2000000

   !> A set that has had its END card.
   type :: closed_t
      type(mechanism_t) :: mechanism
      type(variation_t) :: variation              !< empty for a set without VARY cards
   end type closed_t

   !> The sets read so far.
   type :: reading_t
      type(closed_t), allocatable :: sets(:)      !< (closed or more) the first `closed` are in use
      integer :: closed = 0                       !< number of sets that have had their END card
      type(card_set_t) :: set                     !< the open set, and the errors of the deck
      integer :: errors_before = 0                !< errors of the deck before the open set
   end type reading_t

contains

   !> Reads the deck in a file. A failure is status_rejected (`report` has the reasons) or status_system.
   subroutine read_deck(path, sets, report, failure, variations)
      character(*), intent(in) :: path       !< of the file; '' or '-': standard input
      type(mechanism_t), allocatable, intent(out) :: sets(:)   !< (sets of the deck) none on any failure
      character(:), allocatable, intent(out) :: report   !< all error messages, joined by new_line('a'); '': none
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: the deck is right
      type(variation_t), allocatable, intent(out), optional :: variations(:)   !< (sets) empty without VARY cards
      type(reading_t) :: progress
      type(source_t) :: source

      call open_source(source, path, failure)
      call read_sets(source, progress, sets, report, failure)
      if (present(variations)) variations = progress%sets(:progress%closed)%variation
   end subroutine read_deck

   !> Reads the deck in a text. A failure is status_rejected (`report` has the reasons).
   subroutine read_deck_text(text, sets, report, failure)
      character(*), intent(in) :: text       !< lines that end in LF or CR-LF
      type(mechanism_t), allocatable, intent(out) :: sets(:)   !< (sets of the deck) none on any failure
      character(:), allocatable, intent(out) :: report   !< all error messages, joined by new_line('a'); '': none
      type(failure_t), allocatable, intent(out) :: failure     !< status_rejected; not allocated: the deck is right
      type(reading_t) :: progress
      type(source_t) :: source

      source = source_of(text)
      call read_sets(source, progress, sets, report, failure)
   end subroutine read_deck_text

   !> Reads all sets of a deck. If opening the deck has failed, or reading fails, there are no sets.
   subroutine read_sets(source, progress, sets, report, failure)
      type(source_t), intent(inout) :: source   !< the open deck; not read if there is a failure
      type(reading_t), intent(inout) :: progress   !< new; gets the sets and the errors
      type(mechanism_t), allocatable, intent(out) :: sets(:)   !< (sets of the deck) none on any failure
      character(:), allocatable, intent(out) :: report   !< all error messages, joined by new_line('a'); '': none
      type(failure_t), allocatable, intent(inout) :: failure   !< of opening the deck; otherwise of reading it

      allocate (progress%sets(4))
      call begin_set(progress%set, 1)
      if (.not. allocated(failure)) call read_cards(source, progress, failure)
      report = error_report(progress%set%errors)
      if (.not. allocated(failure) .and. progress%set%errors%count > 0) &
         call fail(failure, status_rejected, 'THE DECK IS REJECTED, ERRORS: '//whole(progress%set%errors%count))
      if (allocated(failure)) progress%closed = 0
      sets = progress%sets(:progress%closed)%mechanism
   end subroutine read_sets

   !> Reads all cards of a deck, and closes its sets. A failure is status_system, or status_rejected for a line that is
   !> no card. A deck with too many cards, without cards, or without an END card at its end is an error of the deck.
   subroutine read_cards(source, progress, failure)
      type(source_t), intent(inout) :: source   !< the open deck
      type(reading_t), intent(inout) :: progress   !< gets the sets and the errors
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: all lines are read
      type(card_t) :: card, last
      logical :: found

      do
         call next_card(source, card, found, failure)
         if (allocated(failure)) return
         if (.not. found) exit
         if (card%number > max_cards) then
            call add_error(progress%set%errors, deck_long, card_t(), card_fields(card_name), 1, '', whole(max_cards))
            return
         end if
         if (is_passed_over(card)) cycle
         last = card
         call add_card(card, progress)
      end do

      if (last%number == 0) then
         call add_error(progress%set%errors, deck_empty, card_t(), card_fields(card_name), 1, '')
      else if (progress%set%count > 0) then
         call add_field_error(progress%set%errors, end_missing, last, card_fields(card_name))
         progress%set%names_certain = .false.
         call close_set(progress)
      end if
   end subroutine read_cards

   !> Adds a card to the open set, or its reals if it is a `*` card. An END card closes the set.
   subroutine add_card(card, progress)
      type(card_t), intent(in) :: card       !< neither blank nor a comment
      type(reading_t), intent(inout) :: progress   !< its open set gets the card
      type(parsed_card_t), allocatable :: larger(:)
      integer :: n

      associate (set => progress%set)
         if (card%text(1:1) == '*') then
            if (set%count == 0) then
               call add_field_error(set%errors, card_alone, card, card_fields(card_name))
            else
               call read_star(card, set%cards(set%count), set%errors)
            end if
            return
         end if

         n = set%count + 1
         if (n > size(set%cards)) then
            allocate (larger(2*set%count))
            larger(1:set%count) = set%cards
            call move_alloc(larger, set%cards)
         end if
         call read_card(card, set%cards(n), set%errors)

         if (set%cards(n)%form /= form_end) then
            if (n > 1) then
               set%cards(n)%below = n - 1
               if (any(set%cards(n - 1)%form == [form_toler, form_vary])) set%cards(n)%below = set%cards(n - 1)%below
            end if
            set%count = n
            set%number_of(set%cards(n)%form) = set%number_of(set%cards(n)%form) + 1
            set%names_certain = set%names_certain .and. set%cards(n)%names_certain
         else
            ! A card that was not understood may be the missing card.
            if (set%names_certain .and. set%number_of(form_link) == 0) &
               call add_field_error(set%errors, link_missing, card, card_fields(card_name))
            if (set%names_certain .and. sum(set%number_of([form_time, form_at])) == 0) &
               call add_field_error(set%errors, time_missing, card, card_fields(card_name))
            call close_set(progress)
         end if
      end associate
   end subroutine add_card

   !> Builds the mechanism and the variants of the open set from its cards, and opens the next set. Only a set without
   !> errors is checked for unused links and points and for suspicious numbers: a card with an error could make others
   !> look unused or suspicious.
   subroutine close_set(progress)
      type(reading_t), intent(inout) :: progress   !< gets a closed set and an empty open one
      type(closed_t), allocatable :: larger(:)
      integer :: n

      if (progress%closed == size(progress%sets)) then
         allocate (larger(2*progress%closed))
         larger(:progress%closed) = progress%sets
         call move_alloc(larger, progress%sets)
      end if
      progress%closed = progress%closed + 1

      associate (set => progress%set)
         call build_mechanism(set)
         call build_variation(set, progress%sets(progress%closed)%variation)
         if (set%errors%count == progress%errors_before .and. set%names_certain) then
            call check_terms(set)
            call check_unused(set)
            call check_centres(set)
            call check_measures(set)
            call check_angles(set)
            if (set%errors%count == progress%errors_before) call check_drives(set)
            if (set%errors%count == progress%errors_before) call check_drawing(set)
            call build_echo(set)
         end if
         n = min(set%errors%remarked, size(set%errors%remarks))
         if (n > 0) set%mechanism%remarks = set%errors%remarks(:n)
         set%errors%remarked = 0
         progress%errors_before = set%errors%count
      end associate

      progress%sets(progress%closed)%mechanism = progress%set%mechanism
      call begin_set(progress%set, progress%closed + 1)
   end subroutine close_set

   !> Builds the mechanism of a set from its cards, and adds the errors of the cards to the set.
   subroutine build_mechanism(set)
      type(card_set_t), intent(inout) :: set !< its cards; gets the mechanism and the errors

      call build_options(set)
      call build_bodies(set)
      call build_measures(set)
      call build_drives(set)
      call set_turns(set)
      call build_lengths(set)
      call build_requests(set)
      call build_branches(set)
      call build_tolerances(set)
   end subroutine build_mechanism

   !> Builds a variant of a set, as if its numbers stood in the deck.
   subroutine build_variant(variation, n, m, message)
      type(variation_t), intent(inout) :: variation   !< of the set; its cards may get the numbers
      integer, intent(in) :: n               !< number of the variant, 1 to variation%total
      type(mechanism_t), intent(inout) :: m  !< new, or an earlier variant; becomes the variant
      character(:), allocatable, intent(out) :: message   !< first error of the variant, a sentence; '': none
      logical :: is_done

      message = ''
      call apply_variant(variation, n, m, is_done)
      if (is_done) return
      call build_mechanism(variation%set)
      if (variation%set%errors%count == 0) then
         call check_terms(variation%set)
         call check_centres(variation%set)
         call check_measures(variation%set)
      end if
      message = error_report(variation%set%errors)
      ! The lines before the first message show the card.
      if (len(message) > 0) message = message(index(message, ' *** ') + 5:)
      message = message(:index(message//new_line('a'), new_line('a')) - 1)
      m = variation%set%mechanism
      m%variants = variation%total
      m%variant = merge(n, 0, message == '')
   end subroutine build_variant
end module deck
