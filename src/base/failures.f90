!> A failure is an exit status and a sentence; an unallocated failure is success.
!> Only the main program prints one and stops.
module failures
   implicit none
   private
   public :: failure_t, fail, status_solved, status_refused, status_flagged, status_machine, status_signal

   integer, parameter :: status_solved = 0   !< every step solved
   integer, parameter :: status_refused = 1  !< deck or command refused, nothing computed
   integer, parameter :: status_flagged = 2   !< listing complete, at least one step marked
   integer, parameter :: status_machine = 3  !< the machine's fault: file, memory, disk full
   !> And above: with the number of a signal added, by which the process ends, as a shell would tell it.
   integer, parameter :: status_signal = 128

   type :: failure_t
      integer :: status = status_machine
      character(:), allocatable :: text
   end type failure_t

contains

   !> Makes `failure` hold a status and a sentence.
   subroutine fail(failure, status, text)
      type(failure_t), allocatable, intent(out) :: failure
      integer, intent(in) :: status
      character(*), intent(in) :: text

      allocate (failure)
      failure%status = status
      failure%text = text
   end subroutine fail
end module failures
