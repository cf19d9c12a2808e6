!> Reads a card deck to sets of computations. The whole deck is read and all its errors are reported; nothing is
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

   !> The largest number of cards, with comments and blank cards.
   integer, parameter :: max_cards = 2000000

   !> A set that has its END.
   type :: closed_t
      type(mechanism_t) :: mechanism
      type(variation_t) :: variation              !< empty of a set without VARY cards
   end type closed_t

   !> The sets read so far.
   type :: reading_t
      type(closed_t), allocatable :: sets(:)      !< (closed) and room for more
      integer :: closed = 0                       !< number of those that have their END
      type(card_set_t) :: set                     !< the open set, and the errors of the deck
      integer :: errors_before = 0                !< errors of the deck before the open set
   end type reading_t

contains

   !> Reads the deck in a file. Errors: status_rejected (`report` has the reasons) or status_system.
   subroutine read_deck(path, sets, report, failure, variations)
      character(*), intent(in) :: path       !< of the file; '' or '-': standard input
      type(mechanism_t), allocatable, intent(out) :: sets(:)   !< of size 0 on any failure
      character(:), allocatable, intent(out) :: report   !< all error messages, joined by new_line('a'); '': none
      type(failure_t), allocatable, intent(out) :: failure
      type(variation_t), allocatable, intent(out), optional :: variations(:)   !< (sets) empty without VARY cards
      type(reading_t) :: progress
      type(source_t) :: source

      call open_source(source, path, failure)
      call read_sets(source, progress, sets, report, failure)
      if (present(variations)) variations = progress%sets(:progress%closed)%variation
   end subroutine read_deck

   !> Reads a deck from a text. Errors: status_rejected (`report` has the reasons).
   subroutine read_deck_text(text, sets, report, failure)
      character(*), intent(in) :: text       !< lines that end in LF or CR-LF
      type(mechanism_t), allocatable, intent(out) :: sets(:)   !< of size 0 on any failure
      character(:), allocatable, intent(out) :: report   !< all error messages, joined by new_line('a'); '': none
      type(failure_t), allocatable, intent(out) :: failure     !< status_rejected
      type(reading_t) :: progress
      type(source_t) :: source

      source = source_of(text)
      call read_sets(source, progress, sets, report, failure)
   end subroutine read_deck_text

   !> Reads all sets of an open deck. If there is a failure, of opening the deck or of reading it, there are no sets.
   subroutine read_sets(source, progress, sets, report, failure)
      type(source_t), intent(inout) :: source
      type(reading_t), intent(inout) :: progress
      type(mechanism_t), allocatable, intent(out) :: sets(:)
      character(:), allocatable, intent(out) :: report   !< all error messages, joined by new_line('a'); '': none
      type(failure_t), allocatable, intent(inout) :: failure

      allocate (progress%sets(4))
      call begin_set(progress%set, 1)
      if (.not. allocated(failure)) call read_cards(source, progress, failure)
      report = error_report(progress%set%errors)
      if (.not. allocated(failure) .and. progress%set%errors%count > 0) &
         call fail(failure, status_rejected, 'THE DECK IS REJECTED, ERRORS: '//whole(progress%set%errors%count))
      if (allocated(failure)) progress%closed = 0
      sets = progress%sets(:progress%closed)%mechanism
   end subroutine read_sets

   !> Reads all cards of the deck, and closes its sets. Errors: status_system, and status_rejected for lines that are no
   !> cards.
   subroutine read_cards(source, progress, failure)
      type(source_t), intent(inout) :: source
      type(reading_t), intent(inout) :: progress
      type(failure_t), allocatable, intent(out) :: failure
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

   !> Adds a card to the open set; an END card closes the set.
   subroutine add_card(card, progress)
      type(card_t), intent(in) :: card
      type(reading_t), intent(inout) :: progress
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
            ! A card that was not understood may be the missing one.
            if (set%names_certain .and. set%number_of(form_link) == 0) &
               call add_field_error(set%errors, link_missing, card, card_fields(card_name))
            if (set%names_certain .and. sum(set%number_of([form_time, form_at])) == 0) &
               call add_field_error(set%errors, time_missing, card, card_fields(card_name))
            call close_set(progress)
         end if
      end associate
   end subroutine add_card

   !> Builds the mechanism of the open set from its cards, and opens the next set. Only a set without errors is checked
   !> for unused parts and for numbers that look wrong: a card with an error could make others look so.
   subroutine close_set(progress)
      type(reading_t), intent(inout) :: progress
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

   !> Builds the mechanism of a set from its cards.
   subroutine build_mechanism(set)
      type(card_set_t), intent(inout) :: set

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

   !> Builds a variant, like a deck in which its numbers are typed.
   subroutine build_variant(variation, n, m, message)
      type(variation_t), intent(inout) :: variation
      integer, intent(in) :: n               !< number of the variant, 1 to variation%total
      type(mechanism_t), intent(inout) :: m  !< new, or an earlier variant; becomes the variant
      character(:), allocatable, intent(out) :: message   !< its first error; '': none
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
      ! The lines before it show the card.
      if (len(message) > 0) message = message(index(message, ' *** ') + 5:)
      message = message(:index(message//new_line('a'), new_line('a')) - 1)
      m = variation%set%mechanism
      m%variants = variation%total
      m%variant = merge(n, 0, message == '')
   end subroutine build_variant
end module deck
