!> Level 2. The only file that calls LAPACK. DGESV in its two halves, so that the factors of the
!> Jacobian that ended Newton's iteration serve velocity and acceleration as well.
module linear_solver
   use kinds, only: wp
   implicit none
   private
   public :: factors_t, new_factors, factor, solve, reciprocal_condition, determinant_sign
   public :: solve_tridiagonal, entries_of, solve_first, solve_again, pivot_range, inverse_norm

   !> A square matrix, before and after its factorization P L U.
   type :: factors_t
      integer :: n = 0
      real(wp), allocatable :: a(:, :)     !< (n, n): the matrix, then its factors
      integer, allocatable :: pivots(:)    !< (n)
      real(wp) :: norm = 0.0_wp            !< 1-norm of the matrix
      real(wp), allocatable :: work(:)     !< (4 n): for the condition estimate
      integer, allocatable :: iwork(:)     !< (n)
   end type factors_t

   interface
      subroutine dgetrf(m, n, a, lda, ipiv, info)
         import :: wp
         integer, intent(in) :: m, n, lda
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgetrf
      subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         character(1), intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgetrs
      subroutine dgecon(norm, n, a, lda, anorm, rcond, work, iwork, info)
         import :: wp
         character(1), intent(in) :: norm
         integer, intent(in) :: n, lda
         real(wp), intent(in) :: a(lda, *), anorm
         real(wp), intent(out) :: rcond
         real(wp), intent(inout) :: work(*)
         integer, intent(inout) :: iwork(*)
         integer, intent(out) :: info
      end subroutine dgecon
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv
      subroutine dgbsv(n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb
         real(wp), intent(inout) :: ab(ldab, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgbsv
      subroutine dgbcon(norm, n, kl, ku, ab, ldab, ipiv, anorm, rcond, work, iwork, info)
         import :: wp
         character(1), intent(in) :: norm
         integer, intent(in) :: n, kl, ku, ldab, ipiv(*)
         real(wp), intent(in) :: ab(ldab, *), anorm
         real(wp), intent(out) :: rcond
         real(wp), intent(inout) :: work(*)
         integer, intent(inout) :: iwork(*)
         integer, intent(out) :: info
      end subroutine dgbcon
      subroutine dgbtrs(trans, n, kl, ku, nrhs, ab, ldab, ipiv, b, ldb, info)
         import :: wp
         character(1), intent(in) :: trans
         integer, intent(in) :: n, kl, ku, nrhs, ldab, ldb, ipiv(*)
         real(wp), intent(in) :: ab(ldab, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgbtrs
      subroutine dptsv(n, nrhs, d, e, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, nrhs, ldb
         real(wp), intent(inout) :: d(*), e(*), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dptsv
   end interface

contains

   !> Room for an `n` by `n` matrix.
   pure function new_factors(n) result(f)
      integer, intent(in) :: n
      type(factors_t) :: f

      f%n = n
      allocate (f%a(n, n), f%work(4*n), source=0.0_wp)
      allocate (f%pivots(n), f%iwork(n), source=0)
   end function new_factors

   !> Factors `f%a` in place. `info` > 0: exactly singular, the pivot of that number is zero.
   subroutine factor(f, info)
      type(factors_t), intent(inout) :: f
      integer, intent(out) :: info
      integer :: j

      info = 0
      f%norm = 0.0_wp
      if (f%n == 0) return
      do j = 1, f%n
         f%norm = max(f%norm, sum(abs(f%a(:, j))))
      end do
      call dgetrf(f%n, f%n, f%a, f%n, f%pivots, info)
   end subroutine factor

   !> Replaces the right-hand side `b` (n) by the solution, from the factors.
   subroutine solve(f, b)
      type(factors_t), intent(in) :: f
      real(wp), intent(inout) :: b(:)
      integer :: info

      if (f%n == 0) return
      call dgetrs('N', f%n, 1, f%a, f%n, f%pivots, b, f%n, info)
   end subroutine solve

   !> Estimate of 1 / (|A| |A^-1|) in the 1-norm, from the factors (DGECON).
   subroutine reciprocal_condition(f, rcond)
      type(factors_t), intent(inout) :: f
      real(wp), intent(out) :: rcond
      integer :: info

      rcond = 1.0_wp
      if (f%n == 0) return
      call dgecon('1', f%n, f%a, f%n, f%norm, rcond, f%work, f%iwork, info)
   end subroutine reciprocal_condition

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

   !> Numbers that an `n` by `n` matrix takes, dense or as a band; see solve_first.
   pure integer function entries_of(n, below, above)
      integer, intent(in) :: n, below, above

      entries_of = n*merge(n, 2*below + above + 1, below < 0)
   end function entries_of

   !> Solves the `n` by `n` system `a` x = `b` (DGESV, DGBSV); `b` (n) becomes x, `a` its factors. Dense where
   !> `below` < 0, otherwise a band with `below` and `above` diagonals beside the main one, stored as DGBSV has
   !> it. `info` > 0: exactly singular. One right-hand side a call: for more OpenBLAS starts threads, at ten times
   !> the cost of a small system.
   subroutine solve_first(n, below, above, a, pivots, b, info)
      integer, intent(in) :: n, below, above
      real(wp), intent(inout) :: a(*), b(*)
      integer, intent(out) :: pivots(*), info

      if (n == 1) then
         info = merge(1, 0, abs(a(1)) <= 0.0_wp)
         pivots(1) = 1
         if (info == 0) b(1) = b(1)/a(1)
      else if (below < 0) then
         call dgesv(n, 1, a, n, pivots, b, n, info)
      else
         call dgbsv(n, below, above, 1, a, 2*below + above + 1, pivots, b, n, info)
      end if
   end subroutine solve_first

   !> The same for another right-hand side, from the factors.
   subroutine solve_again(n, below, above, a, pivots, b)
      integer, intent(in) :: n, below, above
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: b(*)
      integer :: info

      if (n == 1) then
         b(1) = b(1)/a(1)
      else if (below < 0) then
         call dgetrs('N', n, 1, a, n, pivots, b, n, info)
      else
         call dgbtrs('N', n, below, above, 1, a, 2*below + above + 1, pivots, b, n, info)
      end if
   end subroutine solve_again

   !> From the factors: the smallest and the largest pivot, and the sign of the determinant.
   pure subroutine pivot_range(n, below, above, a, pivots, least, largest, sign_of)
      integer, intent(in) :: n, below, above
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(out) :: least, largest
      integer, intent(out) :: sign_of
      real(wp) :: pivot
      integer :: k, at, stride

      at = merge(1, below + above + 1, below < 0)
      stride = merge(n, 2*below + above, below < 0) + 1
      least = huge(least)
      largest = 0.0_wp
      sign_of = 1
      do k = 1, n
         pivot = a(at + (k - 1)*stride)
         least = min(least, abs(pivot))
         largest = max(largest, abs(pivot))
         if ((pivot < 0.0_wp) .neqv. (pivots(k) /= k)) sign_of = -sign_of
      end do
   end subroutine pivot_range

   !> |A^-1| in the maximum norm, from the factors: exact for n <= 2, an estimate otherwise (DGECON, DGBCON).
   !> `work` (4 n), `iwork` (n).
   real(wp) function inverse_norm(n, below, above, a, pivots, work, iwork)
      integer, intent(in) :: n, below, above
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*)
      integer, intent(inout) :: iwork(*)
      real(wp) :: rcond
      integer :: info

      rcond = 0.0_wp
      if (n == 1) then
         inverse_norm = 1.0_wp/abs(a(1))
      else if (n == 2) then
         ! The factors are l = a(2), u = a(1), a(3), a(4); columns are swapped by the pivots, row sums are not.
         inverse_norm = max(abs(a(4) + a(3)*a(2)) + abs(a(3)), abs(a(1)*a(2)) + abs(a(1)))/abs(a(1)*a(4))
      else
         if (below < 0) then
            call dgecon('I', n, a, n, 1.0_wp, rcond, work, iwork, info)
         else
            call dgbcon('I', n, below, above, a, 2*below + above + 1, pivots, 1.0_wp, rcond, work, iwork, info)
         end if
         inverse_norm = 1.0_wp/max(rcond, tiny(rcond))
      end if
   end function inverse_norm

   !> Solves the symmetric positive definite tridiagonal system with diagonal `d` (n) and
   !> off-diagonal `e` (n - 1); `b` (n) becomes the solution. `info` > 0: not positive definite.
   subroutine solve_tridiagonal(d, e, b, info)
      real(wp), intent(inout) :: d(:), e(:), b(:)
      integer, intent(out) :: info

      info = 0
      if (size(d) > 0) call dptsv(size(d), 1, d, e, b, size(d), info)
   end subroutine solve_tridiagonal
end module linear_solver
