!> Level 2. The deck's lines as cards, from a file or standard input, each line read once and in
!> bounded memory. Non-advancing formatted reading serves files, pipes and terminals alike; /dev/stdin
!> opened by name does not (no permission after a change of user, and not on every system).
module deck_source
   use, intrinsic :: iso_fortran_env, only: input_unit, iostat_end, iostat_eor
   use failures, only: failure_t, fail, status_machine
   use cards, only: card_t, card_columns
   implicit none
   private
   public :: source_t, open_source, next_card, close_source

   type :: source_t
      private
      character(:), allocatable :: name      !< for messages
      integer :: unit = input_unit
      integer :: lines = 0                   !< read so far
   end type source_t

   !> Characters read at a time from the part of a line that stands past column 80.
   integer, parameter :: chunk_length = 4096
   !> Some editors put this mark in front of a text.
   character(3), parameter :: byte_order_mark = char(239)//char(187)//char(191)

contains

   !> Opens the file `path`; '' or '-' is standard input. Errors: status_machine.
   subroutine open_source(source, path, failure)
      type(source_t), intent(out) :: source
      character(*), intent(in) :: path
      type(failure_t), allocatable, intent(out) :: failure
      character(256) :: reason
      integer :: status
      logical :: there

      source%name = 'STANDARD INPUT'
      if (path /= '' .and. path /= '-') source%name = 'FILE '//trim(path)
      ! Only a directory holds an entry '.'; read as a file it looks empty.
      if (source%name == 'STANDARD INPUT') then
         inquire (file='/dev/stdin/.', exist=there)
      else
         inquire (file=trim(path)//'/.', exist=there)
      end if
      if (there) call fail(failure, status_machine, source%name//' IS A DIRECTORY')
      if (there .or. source%name == 'STANDARD INPUT') return
      inquire (file=path, exist=there)
      if (.not. there) then
         call fail(failure, status_machine, source%name//' DOES NOT EXIST')
         return
      end if
      open (newunit=source%unit, file=path, status='old', action='read', form='formatted', &
            access='sequential', iostat=status, iomsg=reason)
      if (status /= 0) &
         call fail(failure, status_machine, source%name//' CANNOT BE OPENED ('//trim(reason)//')')
   end subroutine open_source

   !> The next card, or `found` false at the end. Errors: status_machine.
   subroutine next_card(source, card, found, failure)
      type(source_t), intent(inout) :: source
      type(card_t), intent(out) :: card
      logical, intent(out) :: found
      type(failure_t), allocatable, intent(out) :: failure
      character(card_columns + len(byte_order_mark)) :: text
      character(256) :: reason
      integer :: length, status, mark

      found = .false.
      read (source%unit, '(a)', advance='no', size=length, iostat=status, iomsg=reason) text
      if (status == iostat_end) return
      source%lines = source%lines + 1
      card%number = source%lines
      mark = 0
      if (source%lines == 1 .and. text(1:len(byte_order_mark)) == byte_order_mark) mark = len(byte_order_mark)
      text = text(mark + 1:)
      card%text = text(1:card_columns)
      call note_beyond(card, text(card_columns + 1:), card_columns)
      if (status == 0) call read_beyond(source, card, len(text) - mark, status, reason)
      found = status == iostat_eor .or. status == iostat_end
      if (.not. found) call fail(failure, status_machine, source%name//' CANNOT BE READ ('//trim(reason)//')')
   end subroutine next_card

   subroutine close_source(source)
      type(source_t), intent(inout) :: source

      if (source%unit /= input_unit) close (source%unit)
   end subroutine close_source

   !> Reads the rest of a line, however long, from the column after `columns`, and keeps only the beginning
   !> of what is not blank.
   subroutine read_beyond(source, card, columns, status, reason)
      type(source_t), intent(in) :: source
      type(card_t), intent(inout) :: card
      integer, intent(in) :: columns
      integer, intent(out) :: status
      character(*), intent(inout) :: reason
      character(chunk_length) :: chunk
      integer :: before, length

      before = columns
      do
         read (source%unit, '(a)', advance='no', size=length, iostat=status, iomsg=reason) chunk
         if (status == 0 .or. status == iostat_eor) call note_beyond(card, chunk(1:length), before)
         if (status /= 0) exit
         before = min(before + length, huge(before) - chunk_length)
      end do
   end subroutine read_beyond

   !> `part` follows column `before`.
   subroutine note_beyond(card, part, before)
      type(card_t), intent(inout) :: card
      character(*), intent(in) :: part
      integer, intent(in) :: before
      integer :: i, known

      if (card%overrun == 0) then
         i = verify(part, ' ')
         if (i == 0) return
         card%overrun = before + i
         card%beyond = part(i:)
      else
         ! The part that is known ends at column `before`.
         known = before - card%overrun + 1
         if (known < len(card%beyond)) card%beyond(known + 1:) = part
      end if
   end subroutine note_beyond
end module deck_source
