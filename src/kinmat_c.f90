!> KINMAT for C, by eight functions, which contrib/kinmat.h describes. A handle is a set and its place in its motion;
!> nothing else is kept, so that threads with a handle each do not meet.
!>
!> Decks are read one at a time: gfortran keeps the length of the text that a function returns in static memory.
module kinmat_c
   use, intrinsic :: iso_c_binding, only: c_int, c_size_t, c_double, c_char, c_long, c_ptr, c_null_ptr, c_null_char, &
      c_loc, c_f_pointer, c_associated
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_value, ieee_quiet_nan
   use kinds, only: wp, program_name
   use failures, only: failure_t, fail, status_solved, status_rejected, status_flagged, status_system
   use mechanism, only: mechanism_t, instant, instant_count
   use deck, only: read_deck_text
   use structure, only: structure_report_t, check_structure
   use set_motion, only: is_flagged
   use rows, only: finished_row_t, find_rows
   use set_analysis, only: set_analysis_t, analyze_set, advance_set, sample_set
   use csv, only: table_t, new_table, find_table_row, table_width
   implicit none
   private

   !> Characters of the name of a column, and the null after it.
   integer, parameter :: column_name_length = 80

   !> Bytes for each character of a deck: without these it is not read. Decks of `tests/make_deck` take up to 17.
   integer(c_size_t), parameter :: memory_of_character = 20

   !> A set, its analysis and its last row.
   type :: handle_t
      type(set_analysis_t) :: set                   !< at the time of the last call
      type(table_t) :: table                        !< the columns
      type(finished_row_t), allocatable :: rows(:)  !< (requests) of the last instant
      real(wp), allocatable :: values(:)            !< (columns) of the last call; in the deck's units
      character(column_name_length), allocatable :: names(:)   !< (columns) with a null after each
      character(:), allocatable :: message          !< why the set is rejected, or ''; with a null after it
      logical :: is_ready = .false.                 !< the set can be solved
      real(wp) :: last = -huge(1.0_wp)              !< time of the last call that was accepted, in the deck's unit
      integer :: calls = 0                          !< accepted calls
      logical :: as_in_deck = .true.                !< all these calls were for the instants of the deck in their order
   end type handle_t

   !> Texts of C: with a null after them.
   character(kind=c_char), target :: version(len(program_name) + 1) = transfer(program_name//c_null_char, c_null_char, &
      len(program_name) + 1)
   character(kind=c_char), target :: no_memory(18) = transfer('NOT ENOUGH MEMORY'//c_null_char, c_null_char, 18)
   !> A mutex of POSIX, which is unlocked if all of it is 0: one deck is read at a time.
   integer(c_long), target :: reading(16) = 0

   interface
      !> Counts the characters of a text of C: strlen(3).
      pure integer(c_size_t) function strlen(text) bind(c)
         import :: c_ptr, c_size_t
         type(c_ptr), value :: text              !< characters with a null after them
      end function strlen
      !> Locks a mutex, and waits until it is free: pthread_mutex_lock(3). Gives 0.
      integer(c_int) function pthread_mutex_lock(mutex) bind(c)
         import :: c_int, c_long
         integer(c_long), intent(inout) :: mutex(*)   !< pthread_mutex_t
      end function pthread_mutex_lock
   end interface
   !> Unlocks a mutex: pthread_mutex_unlock(3). Gives 0.
   procedure(pthread_mutex_lock), bind(c) :: pthread_mutex_unlock

contains

   !> Gives the name of the program and its version, with a null after them.
   type(c_ptr) function kinmat_version() bind(c)
      kinmat_version = c_loc(version)
   end function kinmat_version

   !> Reads set number `number` of a deck. Gives its handle, even if the deck is rejected; null if there is no memory.
   type(c_ptr) function kinmat_read(deck, number, status) bind(c) result(handle)
      type(c_ptr), value :: deck             !< text of the deck, with a null after it; null: an empty deck
      integer(c_int), value :: number        !< of the set, from 1
      integer(c_int), intent(out), optional :: status   !< solved: ready; rejected or system: `kinmat_message` says why
      type(handle_t), pointer :: k
      type(failure_t), allocatable :: failure
      character(:), allocatable :: report
      character(kind=c_char), allocatable :: room(:)
      integer(c_int) :: done
      integer :: error

      handle = c_null_ptr
      if (present(status)) status = status_system
      allocate (k, stat=error)
      if (error /= 0) return
      handle = c_loc(k)
      if (c_associated(deck)) allocate (room(memory_of_character*strlen(deck)), stat=error)
      if (error /= 0) return
      if (allocated(room)) deallocate (room)

      done = pthread_mutex_lock(reading)
      call read_set(text_of(deck), int(number), k, report, failure)
      if (allocated(failure) .and. report == '') report = failure%text
      k%message = report//c_null_char
      done = pthread_mutex_unlock(reading)

      k%is_ready = .not. allocated(failure)
      if (present(status)) status = status_solved
      if (present(status) .and. allocated(failure)) status = failure%status
   end function kinmat_read

   !> Makes a handle ready for the first instant of a set. Errors: status_rejected, or the status of the deck's failure.
   subroutine read_set(text, number, handle, report, failure)
      character(*), intent(in) :: text       !< the deck
      integer, intent(in) :: number          !< of the set, from 1
      type(handle_t), intent(inout) :: handle   !< a new one; gets set, columns and room for a row
      character(:), allocatable, intent(out) :: report   !< all errors of cards; '' if there are none
      type(failure_t), allocatable, intent(out) :: failure   !< not allocated: the handle is ready
      type(mechanism_t), allocatable :: sets(:)
      type(structure_report_t), allocatable :: structure_report(:)
      integer :: i

      call read_deck_text(text, sets, report, failure)
      if (.not. allocated(failure)) call check_structure(sets, structure_report, failure)
      if (allocated(failure)) return
      if (number < 1 .or. number > size(sets)) then
         call fail(failure, status_rejected, 'THE DECK HAS NO SET OF THIS NUMBER')
      else if (sets(number)%variants > 0) then
         call fail(failure, status_rejected, 'THE LIBRARY TAKES NO SET WITH VARY CARDS: CHANGE THE TEXT OF THE DECK')
      end if
      if (allocated(failure)) return

      call analyze_set(sets(number), structure_report(number), handle%set)
      handle%table = new_table(handle%set%now, .false.)
      allocate (handle%rows(size(handle%set%now%rows)), handle%values(table_width(handle%table)))
      handle%names = [character(column_name_length) :: 't', handle%table%drives, handle%table%columns%name]
      do i = 1, size(handle%names)
         handle%names(i) = trim(handle%names(i))//c_null_char
      end do
   end subroutine read_set

   !> Gives a text that says why the set was rejected, or ''.
   type(c_ptr) function kinmat_message(handle) bind(c)
      type(c_ptr), value :: handle           !< of `kinmat_read`; null: there was no memory for one
      type(handle_t), pointer :: k

      kinmat_message = c_loc(no_memory)
      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, k)
      if (allocated(k%message)) kinmat_message = c_loc(k%message)
   end function kinmat_message

   !> Counts the columns: time, drives, numbers that PRINT or COLUMN cards ask for. Gives 0 if the set was rejected.
   integer(c_int) function kinmat_columns(handle) bind(c)
      type(c_ptr), value :: handle           !< of `kinmat_read`; null: none
      type(handle_t), pointer :: k

      kinmat_columns = 0
      if (.not. is_ready(handle)) return
      call c_f_pointer(handle, k)
      kinmat_columns = size(k%values)
   end function kinmat_columns

   !> Gives the name of a column, with a null after it; null if there is no such column.
   type(c_ptr) function kinmat_column(handle, i) bind(c)
      type(c_ptr), value :: handle           !< of `kinmat_read`; null: none
      integer(c_int), value :: i             !< number of the column, from 0
      type(handle_t), pointer :: k

      kinmat_column = c_null_ptr
      if (.not. is_ready(handle)) return
      call c_f_pointer(handle, k)
      if (i < 0 .or. i >= size(k%names)) return
      kinmat_column = c_loc(k%names(i + 1))
   end function kinmat_column

   !> Counts the instants of the deck, and gives the first of them. Gives 0 if the set was rejected.
   integer(c_int) function kinmat_instants(handle, room, n) bind(c)
      type(c_ptr), value :: handle           !< of `kinmat_read`; null: none
      type(c_ptr), value :: room             !< (n) room for their times, in the deck's unit; null: none
      integer(c_int), value :: n             !< number of times that are given at most
      type(handle_t), pointer :: k
      real(c_double), pointer :: times(:)
      integer :: i

      kinmat_instants = 0
      if (.not. is_ready(handle)) return
      call c_f_pointer(handle, k)
      kinmat_instants = instant_count(k%set%now)
      if (n < 1 .or. .not. c_associated(room)) return
      call c_f_pointer(room, times, [n])
      do i = 1, min(n, kinmat_instants)
         times(i) = real(instant(k%set%now, i - 1), c_double)
      end do
   end function kinmat_instants

   !> Solves for a time, and gives the exit status of the command for this instant. The time is not before the time of
   !> the previous call, unless all calls are for the instants of the deck in their order. Otherwise, and for a time
   !> that is not finite, the status is status_rejected and the row NaN. Without a set the row stays as it is.
   integer(c_int) function kinmat_advance(handle, t, row) bind(c) result(status)
      type(c_ptr), value :: handle           !< of `kinmat_read`; null: none
      real(c_double), value :: t             !< time, in the deck's unit
      real(c_double), intent(inout) :: row(*)   !< (columns) NaN: the number does not exist or has no known digit
      type(handle_t), pointer :: k
      real(wp) :: time
      logical :: as_in_deck

      status = status_rejected
      if (.not. is_ready(handle)) return
      call c_f_pointer(handle, k)
      time = real(t, wp)
      as_in_deck = k%as_in_deck .and. k%calls < instant_count(k%set%now)
      if (as_in_deck) as_in_deck = .not. abs(time - instant(k%set%now, k%calls)) > 0.0_wp
      if (.not. ieee_is_finite(t) .or. (time < k%last .and. .not. as_in_deck)) then
         row(:size(k%values)) = ieee_value(0.0_c_double, ieee_quiet_nan)
         return
      end if

      k%as_in_deck = as_in_deck
      k%calls = k%calls + 1
      k%last = time
      call advance_set(k%set, time)
      call sample_set(k%set, .false.)
      call find_rows(k%set%now, k%set%assemblies, k%calls, .true., k%rows)
      call find_table_row(k%table, k%set%now, k%rows, k%values)
      row(:size(k%values)) = real(k%values, c_double)
      status = merge(status_flagged, status_solved, is_flagged(k%set%now))
   end function kinmat_advance

   !> Frees a handle; null is none.
   subroutine kinmat_free(handle) bind(c)
      type(c_ptr), value :: handle           !< of `kinmat_read`; null: none
      type(handle_t), pointer :: k

      if (.not. c_associated(handle)) return
      call c_f_pointer(handle, k)
      deallocate (k)
   end subroutine kinmat_free

   !> Tells whether a handle has a set that can be solved.
   logical function is_ready(handle)
      type(c_ptr), intent(in) :: handle      !< of `kinmat_read`; null: none
      type(handle_t), pointer :: k

      is_ready = c_associated(handle)
      if (.not. is_ready) return
      call c_f_pointer(handle, k)
      is_ready = k%is_ready
   end function is_ready

   !> Copies a text of C; null is ''.
   function text_of(place) result(text)
      type(c_ptr), intent(in) :: place       !< characters with a null after them
      character(:), allocatable :: text
      character(kind=c_char), pointer :: characters(:)
      integer :: i

      allocate (character(0) :: text)
      if (.not. c_associated(place)) return
      call c_f_pointer(place, characters, [strlen(place)])
      deallocate (text)
      allocate (character(size(characters)) :: text)
      do i = 1, size(characters)
         text(i:i) = characters(i)
      end do
   end function text_of
end module kinmat_c
