!> Level 9. From a card deck to sets of computations. The whole deck is read and every error is told;
!> nothing is computed from a deck that has one.
module deck
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use cards, only: card_t, name_field, is_passed_over
   use card_forms, only: form_end, form_star
   use card_reader, only: reading_t, read_card, read_star
   use complaints, only: complaints_t, complain_field, complain_deck, complaint_count, &
                         complaints_report, whole_text
   use deck_branches, only: build_branches
   use deck_bodies, only: build_bodies
   use deck_checks, only: check_missing, check_unused, check_instants
   use deck_codes, only: deck_empty, deck_long, end_missing, set_empty, star_first
   use deck_drives, only: build_drives
   use deck_echo, only: build_echo
   use deck_options, only: build_options
   use deck_requests, only: build_requests
   use deck_source, only: source_t, open_source, next_card, close_source
   use drafts, only: draft_t, add_reading
   use failures, only: failure_t, fail, status_refused
   implicit none
   private
   public :: read_deck

   !> Cards of a deck, comments and blank cards included.
   integer, parameter :: most_cards = 2000000

   !> What has been read so far: the sets that are closed, the cards of the open one, the errors.
   type :: progress_t
      type(mechanism_t), allocatable :: sets(:)   !< (closed), with room behind
      integer :: closed = 0
      type(draft_t) :: draft
      integer :: complaints_before = 0            !< of the open set
      type(complaints_t) :: list
   end type progress_t

contains

   !> Reads the deck in the file `path` ('' or '-': standard input).
   !> `sets`: (number of sets), empty on any failure. `report`: all error messages, lines joined by
   !> new_line('a'), empty if there are none. Errors: status_refused (the report says why) or status_machine.
   subroutine read_deck(path, sets, report, failure)
      character(*), intent(in) :: path
      type(mechanism_t), allocatable, intent(out) :: sets(:)
      character(:), allocatable, intent(out) :: report
      type(failure_t), allocatable, intent(out) :: failure
      type(progress_t) :: progress
      type(source_t) :: source
      integer :: errors

      allocate (progress%sets(4))
      call open_source(source, path, failure)
      if (.not. allocated(failure)) then
         call read_cards(source, progress, failure)
         call close_source(source)
      end if
      report = complaints_report(progress%list)
      errors = complaint_count(progress%list)
      if (.not. allocated(failure) .and. errors > 0) &
         call fail(failure, status_refused, 'THE DECK IS REFUSED, ERRORS: '//whole_text(errors))
      if (allocated(failure)) progress%closed = 0
      if (progress%closed == size(progress%sets)) then
         call move_alloc(progress%sets, sets)
      else
         sets = progress%sets(1:progress%closed)
      end if
   end subroutine read_deck

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
         if (card%number > most_cards) then
            call complain_deck(progress%list, deck_long, whole_text(most_cards))
            return
         end if
         if (is_passed_over(card)) cycle
         last = card
         call take_card(card, progress, failure)
         if (allocated(failure)) return
      end do
      if (last%number == 0) then
         call complain_deck(progress%list, deck_empty, '')
      else if (progress%draft%count > 0) then
         call complain_field(progress%list, end_missing, last, name_field, '')
         progress%draft%names_sure = .false.
         call close_set(progress)
      end if
   end subroutine read_cards

   subroutine take_card(card, progress, failure)
      type(card_t), intent(in) :: card
      type(progress_t), intent(inout) :: progress
      type(failure_t), allocatable, intent(out) :: failure
      type(reading_t) :: reading

      if (card%text(1:1) == '*') then
         call take_star(card, progress, failure)
         return
      end if
      call read_card(card, reading, progress%list)
      if (reading%form /= form_end) then
         call add_reading(progress%draft, reading, failure)
      else if (progress%draft%count == 0) then
         call complain_field(progress%list, set_empty, card, name_field, '')
      else
         call check_missing(progress%draft, card, progress%list)
         call close_set(progress)
      end if
   end subroutine take_card

   subroutine take_star(card, progress, failure)
      type(card_t), intent(in) :: card
      type(progress_t), intent(inout) :: progress
      type(failure_t), allocatable, intent(out) :: failure
      type(reading_t) :: star
      integer :: above

      above = progress%draft%count
      if (above == 0) then
         call complain_field(progress%list, star_first, card, name_field, '')
         return
      end if
      call read_star(card, progress%draft%cards(above), progress%draft%cards(above)%form == form_star, star, &
                     progress%list)
      call add_reading(progress%draft, star, failure)
   end subroutine take_star

   !> Makes a mechanism of the cards of the open set. What nothing uses is asked only of a set without
   !> errors: a refused card would make its neighbours look unused.
   subroutine close_set(progress)
      type(progress_t), intent(inout) :: progress
      type(mechanism_t) :: set
      real(wp) :: angle_unit

      associate (draft => progress%draft, list => progress%list)
         set%set_number = progress%closed + 1
         call build_options(draft, set, angle_unit, list)
         call build_bodies(draft, angle_unit, set, list)
         call build_drives(draft, angle_unit, set, list)
         call build_requests(draft, set, list)
         call build_branches(draft, set, list)
         if (complaint_count(list) == progress%complaints_before) then
            call check_unused(draft, set, list)
            call check_instants(draft, set, list)
            call build_echo(draft, set)
         end if
         progress%complaints_before = complaint_count(list)
      end associate
      progress%draft = draft_t()
      call add_set(progress, set)
   end subroutine close_set

   subroutine add_set(progress, set)
      type(progress_t), intent(inout) :: progress
      type(mechanism_t), intent(in) :: set
      type(mechanism_t), allocatable :: larger(:)

      if (progress%closed == size(progress%sets)) then
         allocate (larger(2*progress%closed))
         larger(1:progress%closed) = progress%sets
         call move_alloc(larger, progress%sets)
      end if
      progress%closed = progress%closed + 1
      progress%sets(progress%closed) = set
   end subroutine add_set
end module deck
