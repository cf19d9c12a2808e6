!> The numbers of a job's parts, which processes take from one another and end one after another. The system keeps how
!> many are taken and how many are done, in files without a name, and a lock for each part that is taken: who waits for
!> a part waits for its lock, which the system opens as well if the process that holds it dies.
!>
!> Rejected: a pipe from process to process. A part then belongs to a process before it begins, so that unequal parts
!> leave one idle.
module turns
   use, intrinsic :: iso_c_binding, only: c_char, c_int, c_int16_t, c_long, c_null_char
   use system_calls, only: close_descriptor, last_error
   implicit none
   private
   public :: turns_t, make_turns, close_turns, take_part, has_turn, wait_for_turn, pass_turn, parts_taken, parts_done

   !> Descriptors of two files. Their positions, which processes share, are the numbers of parts that are taken and that
   !> are done; the locks are those of the bytes of the first.
   type :: turns_t
      integer(c_int) :: taken = -1, done = -1
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

   !> Takes the next part. Nobody takes the one after it before it is locked.
   integer function take_part(t)
      type(turns_t), intent(in) :: t

      call change_lock(t, taking, locked)
      take_part = int(lseek(t%taken, 1_c_long, from_here))
      call change_lock(t, take_part, locked)
      call change_lock(t, taking, unlocked)
   end function take_part

   !> Whether all parts before `part` are done.
   logical function has_turn(t, part)
      type(turns_t), intent(in) :: t
      integer, intent(in) :: part

      has_turn = parts_done(t) == part - 1
   end function has_turn

   !> Waits until the part before `part` is done or will never be; true: all parts before it are done.
   logical function wait_for_turn(t, part)
      type(turns_t), intent(in) :: t
      integer, intent(in) :: part

      if (.not. has_turn(t, part)) then
         call change_lock(t, part - 1, locked)
         call change_lock(t, part - 1, unlocked)
      end if
      wait_for_turn = has_turn(t, part)
   end function wait_for_turn

   !> Part `part` of this process is done.
   subroutine pass_turn(t, part)
      type(turns_t), intent(in) :: t
      integer, intent(in) :: part
      integer(c_long) :: done

      done = lseek(t%done, 1_c_long, from_here)
      call change_lock(t, part, unlocked)
   end subroutine pass_turn

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
end module turns
