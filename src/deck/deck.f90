!> Reads a card deck to sets of computations. The whole deck is read and all its errors are reported; nothing is
!> computed from a deck with an error.
module deck
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: label_length
   use mechanism, only: mechanism_t, method_words, method_newton
   use card_reader, only: parsed_card_t, read_card, read_star
   use card_sets, only: card_set_t, begin_set, append_card, read_small_letters, build_bodies
   use cards, only: card_t, card_fields, wide_fields, card_name, label_a, real_1, field_text, small_field, &
      is_passed_over, find_form, form_name, reals_of, form_title, form_units, form_link, form_time, form_at, &
      form_method, form_print, form_pole, form_curve, form_end
   use deck_drives, only: build_drives, check_terms
   use deck_options, only: build_options, build_requests, build_branches
   use deck_centres, only: build_centres, check_centres
   use deck_tolerances, only: build_tolerances
   use deck_remarks, only: check_unused, check_angles, check_guides
   use deck_source, only: source_t, open_source, next_card, close_source
   use system_calls, only: identity_t, identity_of_path
   use failures, only: failure_t, fail, status_rejected
   use input_errors, only: add_field_error, add_deck_error, error_count, error_report, take_remarks, &
      deck_empty, deck_long, end_missing, set_empty, star_first, link_missing, time_missing
   use numerals, only: whole
   implicit none
   private
   public :: read_deck, share_t, share_end

   !> The largest number of cards, with comments and blank cards.
   integer, parameter :: max_cards = 2000000

   !> A share of a deck's sets: the `number`-th of `count`. The shares one after another are all sets.
   type :: share_t
      integer :: number = 1, count = 1
      integer :: first = 1, last = 0              !< numbers of its sets; set by `read_deck`
      integer :: sets = 0                         !< of the whole deck; the same
   end type share_t

   !> What has been read so far.
   type :: progress_t
      type(mechanism_t), allocatable :: sets(:)   !< (closed) and room for more
      integer :: closed = 0                       !< number of those that have their END
      integer :: passed = 0                       !< sets before the first of them
      type(card_set_t) :: set                     !< the open set, and the errors of the deck
      integer :: errors_before = 0                !< errors of the deck before the open set
   end type progress_t

   !> The echo: its characters in a line, and in a real.
   integer, parameter :: line_length = 119, real_width = 25
   !> Column of the first label, column of the first real, and columns from one label to the next.
   integer, parameter :: label_column = 10, real_column = 37, label_step = 9
   character(*), parameter :: default_mark = '(DEFAULT)'

contains

   !> Reads the deck in the file `path` ('' or '-': standard input). `sets` (number of sets): of size 0 on any failure.
   !> `report`: all error messages, lines joined by new_line('a'); '' if there are none. Errors: status_rejected
   !> (`report` says why) or status_system. `share`: only its sets are wanted. Of a file only they are read: errors of
   !> other sets are not found. A pipe is read wholly.
   subroutine read_deck(path, sets, report, failure, share)
      character(*), intent(in) :: path
      type(mechanism_t), allocatable, intent(out) :: sets(:)
      character(:), allocatable, intent(out) :: report
      type(failure_t), allocatable, intent(out) :: failure
      type(share_t), intent(inout), optional :: share
      type(progress_t) :: progress
      type(source_t) :: source
      integer :: errors, first, last

      first = 1
      last = huge(last)
      if (present(share)) call find_share(path, share, first, last)
      allocate (progress%sets(4))
      progress%passed = first - 1
      call begin_set(progress%set, first)
      call open_source(source, path, failure)
      if (.not. allocated(failure)) then
         call pass_sets(source, first - 1, failure)
         if (.not. allocated(failure)) call read_cards(source, last, progress, failure)
         call close_source(source)
      end if
      report = error_report(progress%set%errors)
      errors = error_count(progress%set%errors)
      if (.not. allocated(failure) .and. errors > 0) &
         call fail(failure, status_rejected, 'THE DECK IS REJECTED, ERRORS: '//whole(errors))
      if (allocated(failure)) progress%closed = 0
      if (present(share)) then
         if (share%sets == 0) call divide(share, progress%closed)
         ! Of a pipe all sets are there.
         sets = progress%sets(share%first - progress%passed:min(progress%closed, share%last - progress%passed))
      else if (progress%closed == size(progress%sets)) then
         call move_alloc(progress%sets, sets)
      else
         sets = progress%sets(1:progress%closed)
      end if
   end subroutine read_deck

   !> The sets `first` to `last` of the file `path` are those to be read for `share`: all, if it is no file or there is
   !> nothing to choose. The last share reads to the end of the deck.
   subroutine find_share(path, share, first, last)
      character(*), intent(in) :: path
      type(share_t), intent(inout) :: share
      integer, intent(inout) :: first, last
      type(source_t) :: source
      type(identity_t) :: id
      type(failure_t), allocatable :: failure
      integer :: passed

      id = identity_of_path(path)
      if (share%count == 1 .or. .not. id%regular) return
      call open_source(source, path, failure)
      if (.not. allocated(failure)) call pass_sets(source, huge(passed), failure, passed)
      call close_source(source)
      if (allocated(failure) .or. passed == 0) return
      call divide(share, passed)
      first = share%first
      if (share%last < passed) last = share%last
   end subroutine find_share

   !> The sets of `share` if the deck has so many `sets`.
   pure subroutine divide(share, sets)
      type(share_t), intent(inout) :: share
      integer, intent(in) :: sets

      share%sets = sets
      share%first = share_end(sets, share%number - 1, share%count) + 1
      share%last = share_end(sets, share%number, share%count)
   end subroutine divide

   !> The last set of share `k` of `n` shares of `count` sets.
   pure integer function share_end(count, k, n)
      integer, intent(in) :: count, k, n

      share_end = int(int(count, int64)*k/n)
   end function share_end

   !> Passes over the next `count` sets, or as many as there are: `passed`. Errors: status_system.
   subroutine pass_sets(source, count, failure, passed)
      type(source_t), intent(inout) :: source
      integer, intent(in) :: count
      type(failure_t), allocatable, intent(out) :: failure
      integer, intent(out), optional :: passed
      type(card_t) :: card
      integer :: n
      logical :: found

      n = 0
      do while (n < count)
         call next_card(source, card, found, failure)
         if (.not. found .or. card%number > max_cards) exit
         if (is_passed_over(card)) cycle
         if (find_form(card%text(:label_length)) == form_end) n = n + 1
      end do
      if (present(passed)) passed = n
   end subroutine pass_sets

   !> Reads all cards of the deck, or those up to the end of set number `last_set`. Errors: status_system.
   subroutine read_cards(source, last_set, progress, failure)
      type(source_t), intent(inout) :: source
      integer, intent(in) :: last_set
      type(progress_t), intent(inout) :: progress
      type(failure_t), allocatable, intent(out) :: failure
      type(card_t) :: card, last
      logical :: found

      do while (progress%passed + progress%closed < last_set)
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
      if (last%number == 0 .and. progress%passed == 0 .and. last_set > 0) then
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
         if (set%small%number == 0 .and. small_field(card) > 0) set%small = card
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

   !> Builds the mechanism of the open set from its cards, and opens the next set. Only a set without errors is checked
   !> for what nothing uses and for what looks wrong: a card with an error could make others look so.
   subroutine close_set(progress)
      type(progress_t), intent(inout) :: progress

      associate (set => progress%set)
         call read_small_letters(set)
         call build_options(set)
         call build_bodies(set)
         call build_drives(set)
         call build_requests(set)
         call build_centres(set)
         call build_branches(set)
         call build_tolerances(set)
         if (error_count(set%errors) == progress%errors_before) then
            call check_terms(set)
            call check_unused(set)
            call check_centres(set)
            call check_angles(set)
            call check_guides(set)
            call build_echo(set)
         end if
         call take_remarks(set%errors, set%mechanism%remarks)
         progress%errors_before = error_count(set%errors)
      end associate
      call append_set(progress)
      call begin_set(progress%set, progress%passed + progress%closed + 1)
   end subroutine close_set

   !> Appends the mechanism of the open set to the closed ones.
   subroutine append_set(progress)
      type(progress_t), intent(inout) :: progress
      type(mechanism_t), allocatable :: larger(:)

      if (progress%closed == size(progress%sets)) then
         allocate (larger(2*progress%closed))
         larger(1:progress%closed) = progress%sets
         call move_alloc(larger, progress%sets)
      end if
      progress%closed = progress%closed + 1
      progress%sets(progress%closed) = progress%set%mechanism
   end subroutine append_set

   !> Adds an error at the END card `closing` of a set without a LINK card or without an instant, unless a card that was
   !> not understood may be the missing one.
   subroutine check_missing(set, closing)
      type(card_set_t), intent(inout) :: set
      type(card_t), intent(in) :: closing

      if (.not. set%names_certain) return
      if (set%number_of(form_link) == 0) call add_field_error(set%errors, link_missing, closing, card_fields(card_name))
      if (sum(set%number_of([form_time, form_at])) == 0) &
         call add_field_error(set%errors, time_missing, closing, card_fields(card_name))
   end subroutine check_missing

   !> Builds `set`%mechanism%echo, the cards as they were understood with the values in use: a line for each card but
   !> TITLE, and one for each default that no card replaces.
   subroutine build_echo(set)
      type(card_set_t), intent(inout) :: set
      integer :: k, n

      associate (m => set%mechanism)
         allocate (m%echo(set%count + 3))
         n = 0
         do k = 1, set%count
            if (set%cards(k)%form == form_title) cycle
            n = n + 1
            m%echo(n) = card_line(set%cards(k), m%length_unit, m%time_unit)
         end do
         call add_default(form_units, [m%length_unit, 'RAD     ', m%time_unit])
         call add_default(form_method, [character(label_length) :: method_words(method_newton), '', ''])
         call add_default(form_print, [character(label_length) :: 'LINKS', '', '1'])
         m%echo = m%echo(1:n)
      end associate

   contains

      !> Adds the line of a form that has no card in the set: its defaults.
      subroutine add_default(form, labels)
         integer, intent(in) :: form
         character(label_length), intent(in) :: labels(3)

         if (set%number_of(form) > 0) return
         n = n + 1
         set%mechanism%echo(n) = head_line(form, labels)
         set%mechanism%echo(n)(line_length - len(default_mark) + 1:) = default_mark
      end subroutine add_default
   end subroutine build_echo

   !> The line of one card. A blank real is shown as 0.0, its value; a blank field of AT has none.
   pure function card_line(card, length_unit, time_unit) result(line)
      type(parsed_card_t), intent(in) :: card
      character(label_length), intent(in) :: length_unit, time_unit
      character(line_length) :: line
      character(label_length) :: labels(3)
      character(real_width) :: text
      integer :: i, column

      labels = card%label
      if (any(card%form == [form_print, form_pole, form_curve]) .and. labels(3) == '') labels(3) = '1'
      if (card%form == form_units) then
         labels(1) = length_unit
         if (labels(2) == '') labels(2) = 'RAD'
         labels(3) = time_unit
      end if
      line = head_line(card%form, labels)
      do i = 1, reals_of(card%form, card%label(label_a))
         if (card%on_star(i)) then
            text = field_text(card%star, wide_fields(i))
         else if (card%given(i)) then
            text = field_text(card%card, card_fields(real_1 + i - 1))
         else
            text = merge('   ', '0.0', card%form == form_at)
         end if
         column = real_column + (i - 1)*real_width
         line(column:column + real_width - 1) = text
      end do
   end function card_line

   !> The name and the labels of a card, in the columns of the echo.
   pure function head_line(form, labels) result(line)
      integer, intent(in) :: form
      character(label_length), intent(in) :: labels(3)
      character(line_length) :: line
      integer :: i, column

      line = form_name(form)
      do i = 1, 3
         column = label_column + (i - 1)*label_step
         line(column:column + label_length - 1) = labels(i)
      end do
   end function head_line
end module deck
