!> What callers of public procedures must pass. The debug build asserts it; in others the conditions are not compiled.
module assertions
   implicit none
   private
   public :: asserts, assert

   !> Each call of `assert` stands behind it: a condition that is never evaluated costs nothing.
#ifdef ASSERTIONS
   logical, parameter :: asserts = .true.
#else
   logical, parameter :: asserts = .false.
#endif

contains

   !> Ends the program if a condition does not hold.
   pure subroutine assert(holds, what)
      logical, intent(in) :: holds           !< the condition
      character(*), intent(in) :: what       !< the procedure, and what it needs

      if (.not. holds) error stop what
   end subroutine assert
end module assertions
