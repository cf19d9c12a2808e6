!> From a card deck to sets of computations. The whole deck is read and every error is reported;
!> nothing is computed from a deck that has one.
module deck
   use mechanism, only: mechanism_t
   use card_reader, only: parsed_card_t, read_card, read_star
   use card_sets, only: card_set_t, begin_set, append_card
   use cards, only: card_t, card_fields, card_name, is_passed_over, form_end
   use deck_bodies, only: build_bodies
   use deck_checks, only: check_missing, check_unused, check_instants
   use deck_drives, only: build_drives
   use deck_echo, only: build_echo
   use deck_options, only: build_options, build_requests, build_branches
   use deck_source, only: source_t, open_source, next_card, close_source
   use failures, only: failure_t, fail, status_rejected
   use input_errors, only: add_field_error, add_deck_error, error_count, error_report, deck_empty, deck_long, &
      end_missing, set_empty, star_first
   use numerals, only: whole
   implicit none
   private
   public :: read_deck

   !> Cards of a deck, comments and blank cards included.
   integer, parameter :: max_cards = 2000000

   !> What has been read so far.
   type :: progress_t
      type(mechanism_t), allocatable :: sets(:)   !< (closed), with room behind
      integer :: closed = 0
      type(card_set_t) :: set                     !< the open one, and the errors of the deck
      integer :: errors_before = 0                !< of the deck, before the open set
   end type progress_t

contains

   !> Reads the deck in the file `path` ('' or '-': standard input).
   !> `sets`: (number of sets), empty on any failure. `report`: all error messages, lines joined by
   !> new_line('a'), empty if there are none. Errors: status_rejected (the report says why) or status_system.
   subroutine read_deck(path, sets, report, failure)
      character(*), intent(in) :: path
      type(mechanism_t), allocatable, intent(out) :: sets(:)
      character(:), allocatable, intent(out) :: report
      type(failure_t), allocatable, intent(out) :: failure
      type(progress_t) :: progress
      type(source_t) :: source
      integer :: errors

      allocate (progress%sets(4))
      call begin_set(progress%set, 1)
      call open_source(source, path, failure)
      if (.not. allocated(failure)) then
         call read_cards(source, progress, failure)
         call close_source(source)
      end if
      report = error_report(progress%set%errors)
      errors = error_count(progress%set%errors)
      if (.not. allocated(failure) .and. errors > 0) &
         call fail(failure, status_rejected, 'THE DECK IS REFUSED, ERRORS: '//whole(errors))
      if (allocated(failure)) progress%closed = 0
      if (progress%closed == size(progress%sets)) then
         call move_alloc(progress%sets, sets)
      else
         sets = progress%sets(1:progress%closed)
      end if
   end subroutine read_deck

   !> All cards of the deck. Errors: status_system.
   subroutine read_cards(source, progress, failure)
      type(source_t), intent(inout) :: source
      type(progress_t), intent(inout) :: progress
      type(failure_t), allocatable, intent(out) :: failure
      type(card_t) :: card, last
      logical :: found

      do
         call next_card(source, card, found, failure)
         if (allocated(failure)) return
         if (.not. found) exit
         if (card%number > max_cards) then
            call add_deck_error(progress%set%errors, deck_long, whole(max_cards))
            return
         end if
         if (is_passed_over(card)) cycle
         last = card
         call take_card(card, progress, failure)
         if (allocated(failure)) return
      end do
      if (last%number == 0) then
         call add_deck_error(progress%set%errors, deck_empty)
      else if (progress%set%count > 0) then
         call add_field_error(progress%set%errors, end_missing, last, card_fields(card_name))
         progress%set%names_certain = .false.
         call close_set(progress)
      end if
   end subroutine read_cards

   !> Adds `card` to the open set, or closes the set.
   subroutine take_card(card, progress, failure)
      type(card_t), intent(in) :: card
      type(progress_t), intent(inout) :: progress
      type(failure_t), allocatable, intent(out) :: failure
      type(parsed_card_t) :: parsed

      associate (set => progress%set)
         if (card%text(1:1) == '*') then
            if (set%count == 0) then
               call add_field_error(set%errors, star_first, card, card_fields(card_name))
            else
               call read_star(card, set%cards(set%count), set%errors)
            end if
            return
         end if
         call read_card(card, parsed, set%errors)
         if (parsed%form /= form_end) then
            call append_card(set, parsed, failure)
         else if (set%count == 0) then
            call add_field_error(set%errors, set_empty, card, card_fields(card_name))
         else
            call check_missing(set, card)
            call close_set(progress)
         end if
      end associate
   end subroutine take_card

   !> Makes a mechanism of the cards of the open set, and opens the next. What nothing uses is asked only of a set
   !> without errors: a card with an error would make others look unused.
   subroutine close_set(progress)
      type(progress_t), intent(inout) :: progress

      associate (set => progress%set)
         call build_options(set)
         call build_bodies(set)
         call build_drives(set)
         call build_requests(set)
         call build_branches(set)
         if (error_count(set%errors) == progress%errors_before) then
            call check_unused(set)
            call check_instants(set)
            call build_echo(set)
         end if
         progress%errors_before = error_count(set%errors)
      end associate
      call keep_set(progress)
      call begin_set(progress%set, progress%closed + 1)
   end subroutine close_set

   !> Adds the mechanism of the open set to the sets that are closed.
   subroutine keep_set(progress)
      type(progress_t), intent(inout) :: progress
      type(mechanism_t), allocatable :: larger(:)

      if (progress%closed == size(progress%sets)) then
         allocate (larger(2*progress%closed))
         larger(1:progress%closed) = progress%sets
         call move_alloc(larger, progress%sets)
      end if
      progress%closed = progress%closed + 1
      progress%sets(progress%closed) = progress%set%mechanism
   end subroutine keep_set
end module deck
