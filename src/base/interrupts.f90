!> Signals that end a run. The first SIGINT or SIGTERM is noted only: the job ends after its instant, with
!> whole lines. The second one kills.
module interrupts
   use, intrinsic :: iso_c_binding, only: c_int, c_intptr_t, c_funptr, c_funloc, c_null_funptr
   implicit none
   private
   public :: watch_signals, signal_received, broken_pipe_kills, end_by_signal, signal_pipe

   integer(c_int), parameter :: signal_interrupt = 2, signal_pipe = 13, signal_terminate = 15, &
      signal_file_size = 25
   integer(c_int), parameter :: watched(2) = [signal_interrupt, signal_terminate]
   !> The address that stands for "ignored"; that for the usual action is null.
   integer(c_intptr_t), parameter :: ignored = 1

   !> What a handler may touch.
   integer(c_int), volatile :: received = 0
   logical :: pipe_kills = .false.

   interface
      type(c_funptr) function signal(number, handler) bind(c)
         import :: c_int, c_funptr
         integer(c_int), value :: number
         type(c_funptr), value :: handler
      end function signal
      integer(c_int) function raise(number) bind(c)
         import :: c_int
         integer(c_int), value :: number
      end function raise
   end interface

contains

   !> From now on SIGINT and SIGTERM are noted, unless they were ignored, and a broken pipe, or a file that
   !> may not grow, is a write that fails.
   subroutine watch_signals
      type(c_funptr) :: before
      integer :: i

      do i = 1, size(watched)
         before = signal(watched(i), c_funloc(note_signal))
         if (address(before) == ignored) before = signal(watched(i), before)
      end do
      before = signal(signal_pipe, transfer(ignored, c_null_funptr))
      if (address(before) == 0_c_intptr_t) pipe_kills = .true.
      before = signal(signal_file_size, transfer(ignored, c_null_funptr))
   end subroutine watch_signals

   !> Nothing but what is safe at any moment: the number is kept, and the usual actions are back.
   subroutine note_signal(number) bind(c)
      integer(c_int), value :: number
      type(c_funptr) :: before
      integer :: i

      received = number
      do i = 1, size(watched)
         before = signal(watched(i), c_null_funptr)
      end do
   end subroutine note_signal

   !> The number of the signal noted, 0 for none.
   integer function signal_received()
      signal_received = received
   end function signal_received

   !> A broken pipe would have ended this process if it had not been for `watch_signals`.
   logical function broken_pipe_kills()
      broken_pipe_kills = pipe_kills
   end function broken_pipe_kills

   !> Ends the process as the signal does, so that a shell sees its usual status.
   subroutine end_by_signal(number)
      integer, intent(in) :: number
      type(c_funptr) :: before
      integer(c_int) :: status

      before = signal(int(number, c_int), c_null_funptr)
      status = raise(int(number, c_int))
   end subroutine end_by_signal

   pure integer(c_intptr_t) function address(handler)
      type(c_funptr), intent(in) :: handler

      address = transfer(handler, 0_c_intptr_t)
   end function address
end module interrupts
