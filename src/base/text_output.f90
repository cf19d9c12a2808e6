!> Lines to a file or to standard output, in large blocks of whole lines. A failed write is an error, never a crash. A
!> file keeps its old contents until the first block is written. If several processes write one file in turn, text is
!> held in memory until the turn has come (`job_chunks`).
module text_output
   use, intrinsic :: iso_c_binding, only: c_int, c_long, c_size_t
   use failures, only: failure_t, fail, capitals, status_system, status_rejected
   use system_calls, only: standard_input, identity_t, identity_of, identity_of_open, same_file, open_to_write, &
      write_bytes, close_descriptor, ftruncate, remove_file, last_error, reason_of, closed_descriptor
   implicit none
   private
   public :: output_t, open_output, open_held, check_apart, put, add, flush_output, close_output, abandon_output
   public :: move_text
   public :: held_length, write_held, release_output, turn_lost, replaced

   !> Characters of a buffer: few calls of the system, and the buffer stays in the processor's cache.
   integer, parameter :: buffer_length = 65536
   !> The error of an output whose turn will never come: the process before it has ended.
   integer, parameter :: turn_lost = -1
   !> The descriptor of standard output.
   integer(c_int), parameter :: standard_output = 1

   !> An open output. `close_output` reports a failed write; all that follows such a write is dropped.
   type :: output_t
      integer(c_int) :: descriptor = standard_output
      character(:), allocatable :: path      !< '' for standard output
      character(:), allocatable :: buffer    !< (buffer_length or more); not allocated: not open
      integer :: written = 0, used = 0       !< characters of the buffer: those after `written`, up to `used`, wait
      logical :: held = .false.              !< its turn to be written has not come: all text stays in the buffer
      logical :: made = .false.              !< the file did not exist before
      logical :: emptied = .false.           !< the old contents of the file are gone
      integer :: error = 0                   !< the system's number of the first write error; 0: none
   end type output_t

contains

   !> Opens a file for writing. The first block that is written replaces the old contents of the file.
   subroutine open_output(o, path, failure)
      type(output_t), intent(out) :: o
      character(*), intent(in) :: path   !< of the file; '' is standard output
      type(failure_t), allocatable, intent(out) :: failure   !< status_system; not allocated: the output is open

      o%path = path
      allocate (character(buffer_length) :: o%buffer)
      o%emptied = len(path) == 0
      if (o%emptied) then
         ! Writing no characters shows whether the descriptor is open.
         if (write_bytes(o%descriptor, '') >= 0) return
         o%error = last_error()
         if (o%error == closed_descriptor) call fail(failure, status_system, 'STANDARD OUTPUT IS CLOSED')
         return
      end if
      call open_to_write(path, o%descriptor, o%made)
      if (o%descriptor >= 0) return
      o%error = last_error()
      call fail(failure, status_system, 'FILE '//path//' CANNOT BE OPENED FOR WRITING (' &
         //capitals(reason_of(o%error))//')')
   end subroutine open_output

   !> Opens an output that is no file: all its text is held in memory.
   subroutine open_held(o)
      type(output_t), intent(out) :: o

      o%held = .true.
      allocate (character(buffer_length) :: o%buffer)
   end subroutine open_held

   !> Moves the text that one output holds to the end of another output.
   subroutine move_text(from, o)
      type(output_t), intent(inout) :: from  !< open; holds nothing afterwards
      type(output_t), intent(inout) :: o     !< open; has the text afterwards, after its own

      call add(o, from%buffer(from%written + 1:from%used))
      from%written = 0
      from%used = 0
   end subroutine move_text

   !> Rejects a file that would be both read and written, or written twice, under any names.
   subroutine check_apart(list, deck, failure)
      type(output_t), intent(in) :: list(:)  !< (outputs) those that are open count
      character(*), intent(in) :: deck       !< the file of the deck; '' is standard input
      type(failure_t), allocatable, intent(out) :: failure   !< status_rejected; not allocated: the files are apart
      type(identity_t) :: id(size(list)), read_from      ! of outputs that are not open: no file
      character(:), allocatable :: name
      integer :: i

      read_from = identity_of_open(standard_input)
      name = 'THE DECK ON STANDARD INPUT'
      if (len(deck) > 0) then
         read_from = identity_of(deck)
         name = 'THE DECK '//deck
      end if
      do i = 1, size(list)
         if (.not. allocated(list(i)%buffer)) cycle
         id(i) = identity_of_open(list(i)%descriptor)
         if (any(same_file(id(i), id(:i - 1)))) &
            call fail(failure, status_rejected, 'ONE FILE IS NAMED FOR TWO OUTPUTS')
      end do
      if (any(same_file(read_from, id))) call fail(failure, status_rejected, name//' WOULD BE OVERWRITTEN')
   end subroutine check_apart

   !> Appends a line to an open output, or the rest of a line that `add` began.
   subroutine put(o, line)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: line   !< any characters, without the end of the line

      if (len(line) >= len(o%buffer) - o%used) then
         call add(o, line)
         call add(o, new_line('a'))
         return
      end if
      o%buffer(o%used + 1:o%used + len(line)) = line
      o%used = o%used + len(line) + 1
      o%buffer(o%used:o%used) = new_line('a')
   end subroutine put

   !> Appends a part of a line to an open output.
   subroutine add(o, text)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: text   !< any characters
      character(:), allocatable :: other
      integer :: held, last

      if (len(text) > len(o%buffer) - o%used .and. o%held) then
         ! A larger buffer for all held text, with as much room again, up to 2**26 characters. Written text is dropped.
         held = held_length(o)
         allocate (character(max(len(o%buffer), held + len(text) + min(held + len(text), 2**26))) :: other)
         other(:held) = o%buffer(o%written + 1:o%used)
         call move_alloc(other, o%buffer)
         o%used = held
         o%written = 0
      end if

      if (len(text) > len(o%buffer) - o%used) then
         ! Whole lines are written, so that a killed process leaves no partial line.
         last = index(o%buffer(:o%used), new_line('a'), back=.true.)
         call write_text(o, o%buffer(:last))
         o%buffer(:o%used - last) = o%buffer(last + 1:o%used)
         o%used = o%used - last
      end if
      if (len(text) > len(o%buffer) - o%used) call write_held(o, held_length(o))
      if (len(text) > len(o%buffer)) then
         call write_text(o, text)
         return
      end if
      o%buffer(o%used + 1:o%used + len(text)) = text
      o%used = o%used + len(text)
   end subroutine add

   !> Counts the characters of an open output that are held, or wait for a block to be full.
   elemental integer function held_length(o)
      type(output_t), intent(in) :: o

      held_length = o%used - o%written
   end function held_length

   !> Writes the first of the characters that an open output holds. After a write error these are dropped.
   subroutine write_held(o, length)
      type(output_t), intent(inout) :: o
      integer, intent(in) :: length   !< how many characters, at most `held_length`

      call write_text(o, o%buffer(o%written + 1:o%written + length))
      o%written = o%written + length
      if (o%written < o%used) return
      o%written = 0
      o%used = 0
   end subroutine write_held

   !> Writes all text that an open output holds; later text is written block by block. The buffer is short again, so
   !> that it stays in the processor's cache.
   subroutine release_output(o)
      type(output_t), intent(inout) :: o

      call write_held(o, held_length(o))
      o%held = .false.
      if (len(o%buffer) == buffer_length) return
      deallocate (o%buffer)
      allocate (character(buffer_length) :: o%buffer)
   end subroutine release_output

   !> Writes the buffer of an output at once, if the output is open and not held: a reader that waits gets its lines,
   !> and a write error shows.
   impure elemental subroutine flush_output(o)
      type(output_t), intent(inout) :: o

      if (allocated(o%buffer) .and. .not. o%held) call write_held(o, held_length(o))
   end subroutine flush_output

   !> Writes the rest of the buffer of an open output and closes the output. If any line could not be written, this is a
   !> failure.
   subroutine close_output(o, failure)
      type(output_t), intent(inout) :: o
      type(failure_t), allocatable, intent(out) :: failure   !< status_system; not allocated: all lines are written

      call write_held(o, held_length(o))
      deallocate (o%buffer)
      if (len(o%path) > 0) then
         if (.not. close_descriptor(o%descriptor) .and. o%error == 0) o%error = last_error()
      else
         o%path = 'STANDARD OUTPUT'
      end if
      if (o%error == 0) return
      call fail(failure, status_system, 'WRITING '//o%path//' FAILED ('//capitals(reason_of(o%error))//')')
   end subroutine close_output

   !> Closes an output without writing its buffer, if the output is open. A file that did not exist before is removed.
   impure elemental subroutine abandon_output(o)
      type(output_t), intent(inout) :: o
      logical :: closed

      if (.not. allocated(o%buffer)) return
      deallocate (o%buffer)
      if (len(o%path) == 0 .or. o%descriptor < 0) return
      closed = close_descriptor(o%descriptor)
      if (o%made) call remove_file(o%path)
   end subroutine abandon_output

   !> Writes a text to the file of an open output, in as many pieces as the system takes. After a write error nothing is
   !> written. The first text replaces the old contents of the file.
   subroutine write_text(o, text)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: text   !< any characters
      type(identity_t) :: id
      integer(c_size_t) :: written, done

      ! Devices and pipes have no old contents.
      if (.not. (o%emptied .or. o%error /= 0)) then
         o%emptied = .true.
         id = identity_of_open(o%descriptor)
         if (id%regular) then
            if (ftruncate(o%descriptor, 0_c_long) /= 0) o%error = last_error()
         end if
      end if
      done = 0
      do while (done < len(text) .and. o%error == 0)
         written = write_bytes(o%descriptor, text(done + 1:))
         if (written <= 0) o%error = last_error()
         done = done + written
      end do
   end subroutine write_text

   !> Gives a text in which each letter of a list is replaced by a word.
   pure function replaced(text, letters, words) result(other)
      character(*), intent(in) :: text       !< any characters
      character(*), intent(in) :: letters    !< the letters that are replaced
      character(*), intent(in) :: words(:)   !< (letters) the word for each; blanks at its end do not count
      character(:), allocatable :: other
      integer :: i, k

      other = ''
      do i = 1, len(text)
         k = index(letters, text(i:i))
         if (k > 0) then
            other = other//trim(words(k))
         else
            other = other//text(i:i)
         end if
      end do
   end function replaced
end module text_output
