!> Child processes, each a copy of this one, and the pipes between them.
!>
!> Parts of a job that processes take from one another and write in order. Who is free takes the next part; its text
!> stays in memory until all parts before are written. Meanwhile the process goes on with further parts, as long as no
!> output holds too much.
!>
!> The system counts the parts that are taken and those that are done, in two files without a name, and keeps a lock for
!> each part at hand: who waits for a part waits for its lock, which the system opens as well if its process dies.
!>
!> Rejected: a pipe from process to process. A part then belongs to a process before it begins, so that unequal parts
!> leave one idle.
module processes
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int16_t, c_int64_t, c_long, c_null_char, c_size_t
   use failures, only: status_system
   use system_calls, only: write_bytes, note_all_signals, close_descriptor, last_error
   use text_output, only: output_t, held_length, write_held, release_output, drop_held, has_failed, turn_lost
   implicit none
   private
   public :: processor_count, make_pipe, has_input, fork_process, wait_for_child, interrupt_child, end_process, killed
   public :: end_without_memory, report, end_of_message, memfd_create
   public :: turns_t, make_turns, close_turns, begin_part, end_part, write_in_turn, write_rest, parts_taken, parts_done

   !> What `wait_for_child` adds to the number of the signal that has killed a child.
   integer, parameter :: killed = 1000

   !> SIGTERM; PR_SET_PDEATHSIG of prctl.
   integer(c_int), parameter :: signal_terminate = 15, when_parent_ends = 1
   !> Bits of a set of processors, as sched_getaffinity takes it.
   integer, parameter :: processor_words = 16
   !> Ends the message that a child reports to its parent.
   character(1), parameter :: end_of_message = achar(2)
   character(*), parameter :: no_memory = ' *** NOT ENOUGH MEMORY FOR THE DECK'
   !> Where this process reports an error: standard error, in a child the pipe to its parent.
   integer(c_int), parameter :: standard_error = 2
   integer(c_int) :: report_to = standard_error

   !> What poll is asked about a descriptor: whether there is input.
   type, bind(c) :: poll_t
      integer(c_int) :: descriptor = -1
      integer(c_int16_t) :: asked = 1, found = 0
   end type poll_t

   !> An output that holds more characters than these waits for its turn after the instant. Its buffer, twice as large
   !> at most, is 128 MB unless the text of an instant is longer.
   integer, parameter :: max_held = 2**26
   !> An output that holds more than these begins no further part.
   integer, parameter :: max_ahead = 2**24
   !> After so many characters it is looked whether the turn has come: in a block's time it may.
   integer, parameter :: look_length = 65536

   type :: turns_t
      !> Descriptors of two files, whose positions all processes share: how many parts are taken, how many are done. The
      !> lock of a part is that of a byte of the first.
      integer(c_int) :: taken = -1, done = -1
      integer :: part = 0                       !< the one at hand
      logical :: held = .false.                 !< its text is held
      integer :: look = 0                       !< it is looked for the turn where an output holds so much
      integer, allocatable :: waiting(:)        !< complete parts before it, whose turn has not come
      integer, allocatable :: lengths(:, :)     !< the characters that each output holds of them
   end type turns_t

   !> Bytes that are locked, as fcntl takes them.
   type, bind(c) :: lock_t
      integer(c_int16_t) :: kind = 0, from = 0
      integer(c_long) :: first = 0, length = 1
      integer(c_int) :: process = 0
   end type lock_t

   !> Of fcntl: sets a lock, and waits for it. Kinds of locks. Of lseek: positions are counted from the present one.
   integer(c_int), parameter :: set_lock = 7, from_here = 1
   integer(c_int16_t), parameter :: locked = 1, unlocked = 2
   !> The system's number of the error that a signal came.
   integer, parameter :: interrupted = 4
   !> The lock of who takes a part: parts are counted from 1.
   integer, parameter :: taking = 0

   interface
      !> fork(2): 0 in the child, its number in the parent, negative for an error.
      integer(c_int) function fork() bind(c)
         import :: c_int
      end function fork
      !> poll(2): waits for input or the end of input, at most so many milliseconds: 0 if there is none, -1 at a signal.
      integer(c_int) function poll(list, count, milliseconds) bind(c)
         import :: c_int, c_long, poll_t
         type(poll_t), intent(inout) :: list(*)
         integer(c_long), value :: count
         integer(c_int), value :: milliseconds
      end function poll
      !> pipe(2): makes a pipe, whose ends are read from and written to; 0, or -1 for an error.
      integer(c_int) function pipe(ends) bind(c)
         import :: c_int
         integer(c_int), intent(out) :: ends(2)
      end function pipe
      !> waitpid(2): waits until the child has ended, -1 for an error.
      integer(c_int) function waitpid(child, status, options) bind(c)
         import :: c_int
         integer(c_int), value :: child, options
         integer(c_int), intent(out) :: status
      end function waitpid
      !> prctl(2): what this process does on an occasion.
      integer(c_int) function prctl(occasion, number) bind(c)
         import :: c_int
         integer(c_int), value :: occasion, number
      end function prctl
      !> kill(2): sends a signal to a process.
      integer(c_int) function kill(process, number) bind(c)
         import :: c_int
         integer(c_int), value :: process, number
      end function kill
      !> _exit(2): ends the process at once with an exit status; nothing that its parent has buffered is written.
      subroutine end_process(status) bind(c, name='_exit')
         import :: c_int
         integer(c_int), value :: status
      end subroutine end_process
      !> sched_getaffinity(2): the processors that this process may use.
      integer(c_int) function sched_getaffinity(process, length, mask) bind(c)
         import :: c_int, c_size_t, c_int64_t
         integer(c_int), value :: process
         integer(c_size_t), value :: length
         integer(c_int64_t), intent(inout) :: mask(*)
      end function sched_getaffinity
      !> memfd_create(2): the descriptor of a file without a name, negative for an error.
      integer(c_int) function memfd_create(name, flags) bind(c)
         import :: c_char, c_int
         character(kind=c_char), intent(in) :: name(*)
         integer(c_int), value :: flags
      end function memfd_create
      !> lseek(2): changes the position of an open file, for all processes that share it and in one piece.
      integer(c_long) function lseek(descriptor, offset, origin) bind(c)
         import :: c_int, c_long
         integer(c_int), value :: descriptor, origin
         integer(c_long), value :: offset
      end function lseek
      !> fcntl(2) with a lock: 0, or -1 for an error, such as a signal.
      integer(c_int) function fcntl(descriptor, command, lock) bind(c)
         import :: c_int, lock_t
         integer(c_int), value :: descriptor, command
         type(lock_t), intent(inout) :: lock
      end function fcntl
   end interface

contains

   !> How many processors this process may use; 1 where the system does not say.
   integer function processor_count()
      integer(c_int64_t) :: mask(processor_words)

      mask = 0
      processor_count = 1
      if (sched_getaffinity(0_c_int, storage_size(mask)/8_c_size_t*processor_words, mask) == 0) &
         processor_count = max(1, sum(popcnt(mask)))
   end function processor_count

   !> Makes a pipe. `reads` and `writes`: the descriptors of its ends, negative for an error, see `last_error`.
   subroutine make_pipe(reads, writes)
      integer(c_int), intent(out) :: reads, writes
      integer(c_int) :: ends(2)

      if (pipe(ends) /= 0) ends = -1
      reads = ends(1)
      writes = ends(2)
   end subroutine make_pipe

   !> Whether `descriptor` has input or has come to its end, now or, unless a signal comes, in so many milliseconds.
   logical function has_input(descriptor, milliseconds)
      integer(c_int), intent(in) :: descriptor
      integer, intent(in) :: milliseconds
      type(poll_t) :: list(1)

      list%descriptor = descriptor
      has_input = poll(list, 1_c_long, int(milliseconds, c_int)) > 0
   end function has_input

   !> Makes a child, a copy of this process, which ends when this one does, and after the first signal by itself. It
   !> reports to the pipe `writes`. The result is 0 in the child, its number in the parent, negative for an error.
   integer function fork_process(writes)
      integer(c_int), intent(in) :: writes
      integer(c_int) :: ignored

      fork_process = fork()
      if (fork_process /= 0) return
      ignored = prctl(when_parent_ends, signal_terminate)
      call note_all_signals
      report_to = writes
   end function fork_process

   !> Waits until the process `child` has ended. `status`: its exit status, or `killed` + the number of the signal that
   !> has killed it.
   subroutine wait_for_child(child, status)
      integer, intent(in) :: child
      integer, intent(out) :: status
      integer(c_int) :: ended, ignored

      ended = 0
      ignored = waitpid(int(child, c_int), ended, 0_c_int)
      status = ishft(iand(ended, 65535), -8)
      if (iand(ended, 127) /= 0) status = killed + iand(ended, 127)
   end subroutine wait_for_child

   !> Asks the process `child` to end.
   impure elemental subroutine interrupt_child(child)
      integer, intent(in) :: child
      integer(c_int) :: ignored

      ignored = kill(int(child, c_int), signal_terminate)
   end subroutine interrupt_child

   !> Reports the `message` of this process, a child, to its parent, in one piece.
   subroutine report(message)
      character(*), intent(in) :: message
      integer(c_size_t) :: written

      written = write_bytes(report_to, message//end_of_message)
   end subroutine report

   !> Ends this process because memory lacks, and uses none for it. Outputs end with the last block of lines written.
   subroutine end_without_memory
      integer(c_size_t) :: written

      written = write_bytes(report_to, &
         no_memory//merge(new_line('a'), end_of_message, report_to == standard_error))
      call end_process(status_system)
   end subroutine end_without_memory

   !> Begins to count parts, for this process and its children; false for an error, see `last_error`.
   logical function make_turns(t)
      type(turns_t), intent(out) :: t

      t%taken = memfd_create('taken'//c_null_char, 0_c_int)
      if (t%taken >= 0) t%done = memfd_create('done'//c_null_char, 0_c_int)
      make_turns = t%done >= 0
   end function make_turns

   !> Gives the files back, and with them the locks of this process.
   subroutine close_turns(t)
      type(turns_t), intent(inout) :: t
      logical :: closed

      if (t%taken >= 0) closed = close_descriptor(t%taken)
      if (t%done >= 0) closed = close_descriptor(t%done)
      t = turns_t()
   end subroutine close_turns

   !> How often a part was taken, by all processes; 0 where none are counted.
   integer function parts_taken(t)
      type(turns_t), intent(in) :: t

      parts_taken = max(0, int(lseek(t%taken, 0_c_long, from_here)))
   end function parts_taken

   !> How many parts are done; 0 where none are counted.
   integer function parts_done(t)
      type(turns_t), intent(in) :: t

      parts_done = max(0, int(lseek(t%done, 0_c_long, from_here)))
   end function parts_done

   !> Takes the next part; t%part is greater than `parts` if there is none. `files`: the outputs that all parts share.
   subroutine begin_part(t, parts, files)
      type(turns_t), intent(inout) :: t
      integer, intent(in) :: parts
      type(output_t), intent(inout) :: files(:)
      integer :: k

      if (.not. allocated(t%waiting)) allocate (t%waiting(0), t%lengths(size(files), 0))
      ! Nobody takes the one after it before it is locked.
      call change_lock(t, taking, locked)
      t%part = int(lseek(t%taken, 1_c_long, from_here))
      call change_lock(t, t%part, locked)
      call change_lock(t, taking, unlocked)

      t%held = t%part <= parts
      if (.not. t%held) return
      files%held = .true.
      do k = 1, size(files)
         ! What the first part has emptied is not emptied again.
         if (allocated(files(k)%buffer)) files(k)%emptied = t%part > 1 .or. len(files(k)%path) == 0
      end do
      call write_what_may_be(t, files, max_held)
   end subroutine begin_part

   !> Ends the part at hand. One that is not `complete` is written in its turn, and no part after it.
   subroutine end_part(t, files, complete)
      type(turns_t), intent(inout) :: t
      type(output_t), intent(inout) :: files(:)
      logical, intent(in) :: complete
      integer :: lengths(size(files))

      if (.not. complete) then
         call write_rest(t, files)
         return
      end if
      lengths = held_length(files) - sum(t%lengths, 2)
      t%lengths = reshape([t%lengths, lengths], [size(files), size(t%waiting) + 1])
      t%waiting = [t%waiting, t%part]
      t%held = .false.
      call write_what_may_be(t, files, max_ahead)
   end subroutine end_part

   !> Writes what may be written, if there is much; waits where an output holds too much.
   subroutine write_in_turn(t, files)
      type(turns_t), intent(inout) :: t
      type(output_t), intent(inout) :: files(:)

      if (.not. t%held) return
      if (maxval(held_length(files)) >= t%look) call write_what_may_be(t, files, max_held)
   end subroutine write_in_turn

   !> Writes all, when its turn has come.
   subroutine write_rest(t, files)
      type(turns_t), intent(inout) :: t
      type(output_t), intent(inout) :: files(:)

      call write_what_may_be(t, files, -1)
   end subroutine write_rest

   !> Writes the parts whose turn has come; waits for it as long as an output holds more than `most` characters. An
   !> error, or a turn that never comes, is that of `files`, and what is held is dropped.
   subroutine write_what_may_be(t, files, most)
      type(turns_t), intent(inout) :: t
      type(output_t), intent(inout) :: files(:)
      integer, intent(in) :: most
      integer(c_long) :: done
      integer :: part, k

      do while (size(t%waiting) > 0 .or. t%held)
         if (any(has_failed(files))) exit
         part = t%part
         if (size(t%waiting) > 0) part = t%waiting(1)

         if (parts_done(t) < part - 1) then
            t%look = maxval(held_length(files)) + look_length
            if (t%look - look_length <= most) return
            ! The part before is done, or will never be, when its lock is open.
            call change_lock(t, part - 1, locked)
            call change_lock(t, part - 1, unlocked)
            if (parts_done(t) < part - 1) files%error = turn_lost
            cycle
         end if

         do k = 1, size(files)
            if (.not. allocated(files(k)%buffer)) cycle
            if (size(t%waiting) > 0) call write_held(files(k), t%lengths(k, 1))
            ! Further text of the part at hand is not held.
            if (size(t%waiting) == 0) call release_output(files(k))
         end do
         if (size(t%waiting) == 0) t%held = .false.
         if (size(t%waiting) == 0 .or. any(has_failed(files))) cycle
         done = lseek(t%done, 1_c_long, from_here)
         call change_lock(t, part, unlocked)
         t%waiting = t%waiting(2:)
         t%lengths = t%lengths(:, 2:)
      end do
      if (size(t%waiting) > 0 .or. t%held) call drop_held(files)
   end subroutine write_what_may_be

   !> Sets or opens the lock of part `part` when it can be had, whatever signals come meanwhile.
   subroutine change_lock(t, part, kind)
      type(turns_t), intent(in) :: t
      integer, intent(in) :: part
      integer(c_int16_t), intent(in) :: kind
      type(lock_t) :: lock

      lock%kind = kind
      lock%first = part
      do while (fcntl(t%taken, set_lock, lock) /= 0)
         if (last_error() /= interrupted) exit
      end do
   end subroutine change_lock
end module processes
