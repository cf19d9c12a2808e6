!> DGESV in its two halves, so that the factors of the Jacobian that ended Newton's iteration serve
!> velocity and acceleration as well.
module linear_solver
   use kinds, only: wp
   use lapack, only: getrf, getrs
   implicit none
   private
   public :: factors_t, new_factors, factor, solve, reciprocal_condition, determinant_sign

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

   !> About how near the matrix is to having no inverse, from the factors: the least pivot over the largest.
   pure real(wp) function reciprocal_condition(f)
      type(factors_t), intent(in) :: f
      real(wp) :: pivots(f%n)
      integer :: i

      pivots = [(abs(f%a(i, i)), i=1, f%n)]
      reciprocal_condition = 1.0_wp
      if (f%n > 0) reciprocal_condition = minval(pivots)/maxval(pivots)
   end function reciprocal_condition

   !> Sign of the determinant, +1, -1 or 0, from the factors.
   pure integer function determinant_sign(f) result(sign_of)
      type(factors_t), intent(in) :: f
      integer :: i

      sign_of = 1
      do i = 1, f%n
         if (f%pivots(i) /= i) sign_of = -sign_of
         if (f%a(i, i) < 0.0_wp) sign_of = -sign_of
         if (abs(f%a(i, i)) <= 0.0_wp) sign_of = 0
      end do
   end function determinant_sign
end module linear_solver
