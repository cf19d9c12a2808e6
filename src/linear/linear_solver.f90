!> DGESV in its two halves, DGETRF and DGETRS: the factors of the Jacobian that ended Newton's iteration serve velocity
!> and acceleration as well.
module linear_solver
   use kinds, only: wp
   use lapack, only: getrf, getrs
   implicit none
   private
   public :: factors_t, new_factors, factor, solve

   !> A square matrix, before and after its factorization P L U.
   type :: factors_t
      integer :: n = 0
      real(wp), allocatable :: a(:, :)     !< (n, n): the matrix, then its factors
      integer, allocatable :: pivots(:)    !< (n) row exchanges
   end type factors_t

contains

   !> Makes room for a square matrix, and fills the matrix with zeros.
   pure function new_factors(n) result(f)
      integer, intent(in) :: n   !< rows of the matrix, 0 or more
      type(factors_t) :: f

      f%n = n
      allocate (f%a(n, n), source=0.0_wp)
      allocate (f%pivots(n), source=0)
   end function new_factors

   !> Factors a square matrix in place.
   subroutine factor(factors, info)
      type(factors_t), intent(inout) :: factors   !< holds the matrix, then the factors
      integer, intent(out) :: info   !< 0; above 0: exactly singular, the pivot of that number is zero

      info = 0
      if (factors%n > 0) call getrf(factors%n, factors%n, factors%a, factors%n, factors%pivots, info)
   end subroutine factor

   !> Solves equations with the factors of their square matrix.
   subroutine solve(factors, right)
      type(factors_t), intent(in) :: factors !< as `factor` left them
      real(wp), intent(inout) :: right(:)   !< (n) the right-hand side, then the solution
      integer :: info

      if (factors%n == 0) return
      call getrs('N', factors%n, 1, factors%a, factors%n, factors%pivots, right, factors%n, info)
   end subroutine solve
end module linear_solver
