!> The lines of the deck as cards, from a file, standard input or a text, each read once; a file in bounded memory.
!> Files, pipes and terminals are all read by the system's own read: the Fortran run-time library of GNU takes an error
!> for the end of the file.
module deck_source
   use, intrinsic :: iso_c_binding, only: c_int
   use failures, only: failure_t, fail, capitals, status_system, status_rejected
   use cards, only: card_t, card_columns
   use number_format, only: whole
   use system_calls, only: standard_input, open_to_read, read_bytes, close_descriptor, last_error, reason_of
   implicit none
   private
   public :: source_t, open_source, source_of, next_card

   !> Bytes that one call of the system reads at most: few calls.
   integer, parameter :: read_length = 2**20
   !> The largest number of columns of a line. A longer line is no card: a source without lines, such as /dev/zero, is
   !> rejected then.
   integer, parameter :: max_columns = 10000000
   !> The byte order mark of UTF-8, which some editors write at the beginning of a file.
   character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)
   !> The ends of lines.
   character(1), parameter :: line_feed = achar(10), carriage_return = achar(13)

   !> An open deck.
   type :: source_t
      private
      character(:), allocatable :: name      !< for messages
      integer(c_int) :: descriptor = standard_input
      integer :: lines = 0                   !< lines read so far
      character(:), allocatable :: buffer    !< bytes of the deck
      character(:), allocatable :: block     !< (read_length) the bytes of the last call
      integer :: at = 1                      !< the next byte of the buffer
      logical :: ended = .false.             !< all bytes of the deck are in the buffer, or were there
   end type source_t

contains

   !> Opens a deck for reading, and reads its beginning.
   subroutine open_source(source, path, failure)
      type(source_t), intent(out) :: source  !< the deck, if there is no failure
      character(*), intent(in) :: path       !< of the file; '' or '-': standard input
      type(failure_t), allocatable, intent(out) :: failure   !< status_system; not allocated: the deck is open
      integer :: error

      source%name = 'STANDARD INPUT'
      if (path /= '' .and. path /= '-') then
         source%name = 'FILE '//trim(path)
         source%descriptor = open_to_read(path)
      end if
      error = last_error()
      if (source%descriptor >= 0) then
         source%buffer = ''
         allocate (character(read_length) :: source%block)
         do while (.not. source%ended .and. len(source%buffer) < len(byte_order_mark))
            call read_on(source, failure)
         end do
         call pass_byte_order_mark(source)
      else
         call fail(failure, status_system, source%name//' CANNOT BE OPENED ('//capitals(reason_of(error))//')')
      end if
   end subroutine open_source

   !> Makes a source of the lines of a text.
   function source_of(text) result(source)
      character(*), intent(in) :: text       !< lines of a deck that end in LF or CR-LF
      type(source_t) :: source

      source%name = 'THE TEXT'
      source%buffer = text
      source%ended = .true.
      call pass_byte_order_mark(source)
   end function source_of

   !> Skips the byte order mark at the beginning of a deck, if there is one.
   subroutine pass_byte_order_mark(source)
      type(source_t), intent(inout) :: source   !< with the beginning of the deck in its buffer

      if (index(source%buffer(:min(len(byte_order_mark), len(source%buffer))), byte_order_mark) == 1) &
         source%at = len(byte_order_mark) + 1
   end subroutine pass_byte_order_mark

   !> Reads the next card of a deck, a line that ends in LF or CR-LF. A failure is status_system; or status_rejected,
   !> for a line of more than `max_columns` columns or with a carriage return inside. Reason: a comment in a file whose
   !> lines end in CR would hide the cards after it.
   subroutine next_card(source, card, found, failure)
      type(source_t), intent(inout) :: source   !< an open deck
      type(card_t), intent(out) :: card      !< the line, if `found`
      logical, intent(out) :: found          !< false at the end of the deck and after a failure
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: a card, or the end of the deck
      integer :: length, next, i
      logical :: is_whole

      found = .false.
      do
         do length = 0, len(source%buffer) - source%at
            if (source%buffer(source%at + length:source%at + length) == line_feed) exit
         end do
         is_whole = source%at + length <= len(source%buffer)
         if (length > max_columns) then
            call fail(failure, status_rejected, source%name//' IS NOT A DECK: LINE '//whole(source%lines + 1) &
               //' HAS MORE THAN '//whole(max_columns)//' COLUMNS')
            return
         end if
         if (is_whole .or. source%ended) exit
         call read_on(source, failure)
         if (allocated(failure)) return
      end do

      found = is_whole .or. length > 0
      if (.not. found) return
      source%lines = source%lines + 1
      card%number = source%lines
      next = source%at + length + 1
      if (length > 0) then
         if (source%buffer(next - 2:next - 2) == carriage_return) length = length - 1
      end if

      associate (line => source%buffer(source%at:source%at + length - 1))
         found = index(line, carriage_return) == 0
         if (.not. found) then
            call fail(failure, status_rejected, source%name//' IS NOT A DECK: LINE '//whole(source%lines) &
               //' HAS A CARRIAGE RETURN INSIDE; END LINES WITH LF OR CR-LF')
            return
         end if
         card%text = line(:min(length, card_columns))
         i = 0
         if (length > card_columns) i = verify(line(card_columns + 1:), ' ')
         if (i > 0) card%overrun = card_columns + i
         if (i > 0) card%beyond = line(card%overrun:)
      end associate
      source%at = next
   end subroutine next_card

   !> Appends a block of the deck to the buffer, and drops the bytes of the buffer that have become cards. Closes the
   !> file at its end.
   subroutine read_on(source, failure)
      type(source_t), intent(inout) :: source   !< an open deck; `ended` at the end or on an error
      type(failure_t), allocatable, intent(out) :: failure   !< status_system; not allocated: no error
      integer :: length, error
      logical :: closed

      length = read_bytes(source%descriptor, source%block)
      error = last_error()
      source%ended = length <= 0
      if (source%ended .and. source%descriptor /= standard_input) closed = close_descriptor(source%descriptor)
      source%buffer = source%buffer(source%at:)//source%block(:max(0, length))
      source%at = 1
      if (length < 0) call fail(failure, status_system, &
         source%name//' CANNOT BE READ ('//capitals(reason_of(error))//')')
   end subroutine read_on
end module deck_source
