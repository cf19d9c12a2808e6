!> DGESV in its two halves, so that the factors of the Jacobian that ended Newton's iteration serve
!> velocity and acceleration as well.
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
      integer, allocatable :: pivots(:)    !< (n)
   end type factors_t

contains

   !> Room for an `n` by `n` matrix.
   pure function new_factors(n) result(f)
      integer, intent(in) :: n
      type(factors_t) :: f

      f%n = n
      allocate (f%a(n, n), source=0.0_wp)
      allocate (f%pivots(n), source=0)
   end function new_factors

   !> Factors `f%a` in place. `info` > 0: exactly singular, the pivot of that number is zero.
   subroutine factor(f, info)
      type(factors_t), intent(inout) :: f
      integer, intent(out) :: info

      info = 0
      if (f%n > 0) call getrf(f%n, f%n, f%a, f%n, f%pivots, info)
   end subroutine factor

   !> Replaces the right-hand side `b` (n) by the solution, from the factors.
   subroutine solve(f, b)
      type(factors_t), intent(in) :: f
      real(wp), intent(inout) :: b(:)
      integer :: info

      if (f%n == 0) return
      call getrs('N', f%n, 1, f%a, f%n, f%pivots, b, f%n, info)
   end subroutine solve
end module linear_solver
