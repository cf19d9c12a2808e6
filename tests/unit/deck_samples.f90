!> Small decks for the tests of the reader, and its words about them.
module deck_samples
   use mechanism, only: mechanism_t
   use number_format, only: whole
   use failures, only: failure_t
   use deck, only: read_deck
   use printed_cards, only: row
   implicit none
   private
   public :: row, sample, replaced, inserted, read_lines, read_bytes, sentences, remarks_of, set_of, four_bar

   !> The deck under test, beside the program; every reading deletes it.
   character(*), parameter :: deck_file = 'unit_test_deck.tmp'

contains

   !> A crank that turns about a fixed point: the shortest deck without an error, eight cards.
   pure function sample() result(lines)
      character(80) :: lines(8)

      lines = [row('GROUND', 'BASE'), row('LINK', 'CRANK'), row('POINT', 'A0', 'BASE'), row('POINT', 'A1', 'CRANK'), &
               row('REVOLUTE', 'A0', 'A1', 'O'), row('DRIVE', 'ANGLE', 'CRANK', r2='1.0'), &
               row('TIME', '10', r1='0.0', r2='1.0'), row('END')]
   end function sample

   !> A four-bar with the base 4 and these lengths, its crank driven from `start`; the rocker above.
   pure function four_bar(crank, coupler, rocker, start, phi_coupler, phi_rocker, driven) result(lines)
      character(*), intent(in) :: crank, coupler, rocker, start, phi_coupler, phi_rocker, driven
      character(80) :: lines(19)

      lines = [row('GROUND', 'BASE'), row('LINK', 'CRANK', r3=start), row('LINK', 'COUPLER', r3=phi_coupler), &
         row('LINK', 'ROCKER', r1='4.0', r3=phi_rocker), row('POINT', 'A0', 'BASE'), row('POINT', 'B0', 'BASE', r1='4.0'), &
         row('POINT', 'A0-CR', 'CRANK'), row('POINT', 'A-CR', 'CRANK', r1=crank), row('POINT', 'A-CO', 'COUPLER'), &
         row('POINT', 'B-CO', 'COUPLER', r1=coupler), row('POINT', 'B0-RO', 'ROCKER'), &
         row('POINT', 'B-RO', 'ROCKER', r1=rocker), row('REVOLUTE', 'A0', 'A0-CR', 'PA0'), &
         row('REVOLUTE', 'A-CR', 'A-CO', 'PA'), row('REVOLUTE', 'B-CO', 'B-RO', 'PB'), &
         row('REVOLUTE', 'B0', 'B0-RO', 'PB0'), row('DRIVE', 'ANGLE', driven, r1=start, r2='0.5'), &
         row('TIME', '2', r1='0.0', r2='0.1'), row('END')]
   end function four_bar

   !> The sample with `line` in place of card `k`.
   pure function replaced(k, line) result(lines)
      integer, intent(in) :: k
      character(*), intent(in) :: line
      character(80) :: lines(8)

      lines = sample()
      lines(k) = line
   end function replaced

   !> The sample with `more` behind card `k`.
   pure function inserted(k, more) result(lines)
      integer, intent(in) :: k
      character(80), intent(in) :: more(:)
      character(80) :: lines(8 + size(more))
      character(80) :: base(8)

      base = sample()
      lines(1:k) = base(1:k)
      lines(k + 1:k + size(more)) = more
      lines(k + 1 + size(more):) = base(k + 1:)
   end function inserted

   !> `read_deck` on a file of these cards.
   subroutine read_lines(lines, sets, report, failure)
      character(*), intent(in) :: lines(:)
      type(mechanism_t), allocatable, intent(out) :: sets(:)
      character(:), allocatable, intent(out) :: report
      type(failure_t), allocatable, intent(out) :: failure
      character(:), allocatable :: bytes
      integer :: i, last

      allocate (character(sum(len_trim(lines)) + size(lines)) :: bytes)
      last = 0
      do i = 1, size(lines)
         bytes(last + 1:last + len_trim(lines(i)) + 1) = trim(lines(i))//achar(10)
         last = last + len_trim(lines(i)) + 1
      end do
      call read_bytes(bytes, sets, report, failure)
   end subroutine read_lines

   !> `read_deck` on a file of exactly these bytes.
   subroutine read_bytes(bytes, sets, report, failure)
      character(*), intent(in) :: bytes
      type(mechanism_t), allocatable, intent(out) :: sets(:)
      character(:), allocatable, intent(out) :: report
      type(failure_t), allocatable, intent(out) :: failure
      integer :: unit

      open (newunit=unit, file=deck_file, access='stream', form='unformatted', status='replace')
      write (unit) bytes
      close (unit)
      call read_deck(deck_file, sets, report, failure)
      open (newunit=unit, file=deck_file, status='old')
      close (unit, status='delete')
   end subroutine read_bytes

   !> The error sentences about a deck, from the code on, without the pictures; several joined by ' / '.
   function sentences(lines) result(text)
      character(*), intent(in) :: lines(:)
      character(:), allocatable :: text
      type(mechanism_t), allocatable :: sets(:)
      type(failure_t), allocatable :: failure
      character(:), allocatable :: report
      character(*), parameter :: mark = ' *** '
      integer :: first, last

      call read_lines(lines, sets, report, failure)
      text = ''
      report = new_line('a')//report//new_line('a')
      do
         first = index(report, new_line('a')//mark)
         if (first == 0) exit
         report = report(first + 1 + len(mark):)
         last = index(report, new_line('a')) - 1
         if (text /= '') text = text//' / '
         text = text//report(1:last)
         report = report(last + 1:)
      end do
   end function sentences

   !> The remarks about the first set of a deck, each as kind, card, column and text; several joined by ' / '. '*' for a
   !> deck that is rejected.
   function remarks_of(lines) result(text)
      character(*), intent(in) :: lines(:)
      character(:), allocatable :: text
      type(mechanism_t) :: set
      integer :: i

      set = set_of(lines)
      text = trim(merge('*', ' ', set%set_number == 0))
      if (.not. allocated(set%remarks)) return
      do i = 1, size(set%remarks)
         if (i > 1) text = text//' / '
         associate (r => set%remarks(i))
            text = trim(text//whole(r%kind)//' '//whole(r%card)//' '//whole(r%column)//' '//r%text)
         end associate
      end do
   end function remarks_of

   !> The first set of a deck; its number is 0 if the deck was rejected.
   function set_of(lines) result(set)
      character(*), intent(in) :: lines(:)
      type(mechanism_t) :: set
      type(mechanism_t), allocatable :: sets(:)
      type(failure_t), allocatable :: failure
      character(:), allocatable :: report

      call read_lines(lines, sets, report, failure)
      set%set_number = 0
      if (size(sets) > 0) set = sets(1)
   end function set_of
end module deck_samples
