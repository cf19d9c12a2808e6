!> Conditions that callers of public procedures must meet. Only the debug build asserts them: other builds leave them
!> out.
module assertions
   implicit none
   private
   public :: asserts, assert

   !> The build asserts conditions. Callers write `if (asserts) call assert(...)`: a condition that is never evaluated
   !> costs nothing.
#ifdef ASSERTIONS
   logical, parameter :: asserts = .true.
#else
   logical, parameter :: asserts = .false.
#endif

contains

   !> Ends the program with a message if a condition does not hold.
   pure subroutine assert(holds, what)
      logical, intent(in) :: holds           !< the condition
      character(*), intent(in) :: what       !< the message: the procedure and the condition

      if (.not. holds) error stop what
   end subroutine assert
end module assertions
