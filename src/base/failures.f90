!> A failure is an exit status and a sentence in capitals; an unallocated failure is success. Only the main program
!> prints one and stops.
module failures
   implicit none
   private
   public :: failure_t, fail, capitals, status_solved, status_rejected, status_flagged, status_system, status_signal

   integer, parameter :: status_solved = 0   !< every instant solved
   integer, parameter :: status_rejected = 1 !< deck or command rejected, nothing computed
   integer, parameter :: status_flagged = 2  !< listing complete, at least one instant flagged
   integer, parameter :: status_system = 3   !< system error: file, memory, disk full
   integer, parameter :: status_signal = 128 !< plus the number of the signal that ended the process, as in a shell

   type :: failure_t
      integer :: status = status_system     !< exit status
      character(:), allocatable :: text     !< the sentence, in capitals, without a full stop
   end type failure_t

contains

   !> Makes a failure from an exit status and a sentence. An earlier failure is replaced.
   subroutine fail(failure, status, text)
      type(failure_t), allocatable, intent(out) :: failure   !< the failure
      integer, intent(in) :: status   !< exit status: one of the parameters above
      character(*), intent(in) :: text   !< the sentence, in capitals, without a full stop

      allocate (failure)
      failure%status = status
      failure%text = text
   end subroutine fail

   !> Gives a text in capitals, as messages have it. Only small letters of ASCII change.
   elemental function capitals(text) result(upper)
      character(*), intent(in) :: text   !< any characters
      character(len(text)) :: upper
      integer :: i

      upper = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') upper(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function capitals
end module failures
