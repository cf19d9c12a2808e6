!> Square systems in real128, with the arguments and the results of LAPACK's routines of the same
!> names: Gauss's elimination with partial pivoting, P A = L U. Only what is asked of them here; `info` < 0
!> for anything else.
module quad_dense
   use, intrinsic :: iso_fortran_env, only: qp => real128
   implicit none
   private
   public :: gesv, getrf, getrs, gecon, lacn2, ptsv

contains

   !> Solves `a` x = `b`; `a` (n, n) becomes its factors, `b` (n, nrhs) the solutions. `info` > 0: the pivot
   !> of that number is zero.
   pure subroutine gesv(n, nrhs, a, lda, ipiv, b, ldb, info)
      integer, intent(in) :: n, nrhs, lda, ldb
      real(qp), intent(inout) :: a(lda, *), b(ldb, *)
      integer, intent(out) :: ipiv(*), info

      call getrf(n, n, a, lda, ipiv, info)
      if (info == 0) call getrs('N', n, nrhs, a, lda, ipiv, b, ldb, info)
   end subroutine gesv

   !> Factors `a` (n, n) in place, row k exchanged with row `ipiv`(k).
   pure subroutine getrf(m, n, a, lda, ipiv, info)
      integer, intent(in) :: m, n, lda
      real(qp), intent(inout) :: a(lda, *)
      integer, intent(out) :: ipiv(*), info
      integer :: j, k

      info = merge(0, -1, m == n)
      if (info < 0) return
      do k = 1, n
         ipiv(k) = k - 1 + maxloc(abs(a(k:n, k)), dim=1)
         if (abs(a(ipiv(k), k)) <= 0.0_qp) then
            if (info == 0) info = k
            cycle
         end if
         if (ipiv(k) /= k) a([k, ipiv(k)], :n) = a([ipiv(k), k], :n)
         a(k + 1:n, k) = a(k + 1:n, k)/a(k, k)
         do j = k + 1, n
            a(k + 1:n, j) = a(k + 1:n, j) - a(k, j)*a(k + 1:n, k)
         end do
      end do
   end subroutine getrf

   !> Solves for the columns of `b` (n, nrhs) by the factors, or (`trans` is T, not N) with the matrix
   !> transposed.
   pure subroutine getrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
      character(1), intent(in) :: trans
      integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
      real(qp), intent(in) :: a(lda, *)
      real(qp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
      integer :: j, k

      info = merge(0, -1, any(trans == ['N', 'T']))
      if (info < 0) return
      do j = 1, nrhs
         if (trans == 'T') then
            call solve_transposed(n, a, lda, ipiv, b(1:n, j))
            cycle
         end if
         do k = 1, n
            if (ipiv(k) /= k) b([k, ipiv(k)], j) = b([ipiv(k), k], j)
         end do
         do k = 1, n
            b(k + 1:n, j) = b(k + 1:n, j) - b(k, j)*a(k + 1:n, k)
         end do
         do k = n, 1, -1
            b(k, j) = b(k, j)/a(k, k)
            b(:k - 1, j) = b(:k - 1, j) - b(k, j)*a(:k - 1, k)
         end do
      end do
   end subroutine getrs

   pure subroutine solve_transposed(n, a, lda, ipiv, b)
      integer, intent(in) :: n, lda, ipiv(*)
      real(qp), intent(in) :: a(lda, *)
      real(qp), intent(inout) :: b(n)
      integer :: k

      do k = 1, n
         b(k) = (b(k) - dot_product(a(:k - 1, k), b(:k - 1)))/a(k, k)
      end do
      do k = n, 1, -1
         b(k) = b(k) - dot_product(a(k + 1:n, k), b(k + 1:))
      end do
      do k = n, 1, -1
         if (ipiv(k) /= k) b([k, ipiv(k)]) = b([ipiv(k), k])
      end do
   end subroutine solve_transposed

   !> 1/(`anorm` |A^-1|), exactly, from the factors: column by column of the inverse. `norm`: I for the
   !> maximum norm, otherwise the 1-norm. The inverse of P^T L U has the columns of that of L U in another
   !> order: no pivots here, and the norms are the same. `work` (2 n).
   pure subroutine gecon(norm, n, a, lda, anorm, rcond, work, iwork, info)
      character(1), intent(in) :: norm
      integer, intent(in) :: n, lda
      real(qp), intent(in) :: a(lda, *), anorm
      real(qp), intent(out) :: rcond
      real(qp), intent(inout) :: work(*)
      integer, intent(inout) :: iwork(*)
      integer, intent(out) :: info
      real(qp) :: largest
      integer :: k

      rcond = 0.0_qp
      info = 0
      do k = 1, n
         iwork(k) = k
         if (abs(a(k, k)) <= 0.0_qp) return
      end do
      largest = 0.0_qp
      work(n + 1:2*n) = 0.0_qp
      do k = 1, n
         work(:n) = 0.0_qp
         work(k) = 1.0_qp
         call getrs('N', n, 1, a, lda, iwork, work, n, info)
         work(n + 1:2*n) = work(n + 1:2*n) + abs(work(:n))
         largest = max(largest, sum(abs(work(:n))))
      end do
      if (norm == 'I') largest = maxval(work(n + 1:2*n))
      rcond = 1.0_qp/(anorm*largest)
   end subroutine gecon

   !> The 1-norm of a matrix that only its products are known of, exactly, column by column: begun with `kase` = 0,
   !> it asks for A `x` in the place of `x` (n) as long as it returns `kase` = 1; `kase` = 0: `est` is the norm. `v`
   !> (n): the column of the largest sum.
   pure subroutine lacn2(n, v, x, isgn, est, kase, isave)
      integer, intent(in) :: n
      real(qp), intent(inout) :: v(*), x(*), est
      integer, intent(inout) :: isgn(*), kase, isave(3)

      if (kase == 0) then
         isave = 0
         isgn(:n) = 0
         est = -1.0_qp
      else if (sum(abs(x(:n))) > est) then
         est = sum(abs(x(:n)))
         v(:n) = x(:n)
      end if
      isave(1) = isave(1) + 1
      kase = merge(1, 0, isave(1) <= n)
      if (kase == 0) return
      x(:n) = 0.0_qp
      x(isave(1)) = 1.0_qp
   end subroutine lacn2

   !> Solves the symmetric positive definite tridiagonal system with diagonal `d` (n) and off-diagonal `e` (n
   !> - 1), which become its factors L D L^T; `b` (n, nrhs) becomes the solutions. `info` > 0: not positive
   !> definite.
   pure subroutine ptsv(n, nrhs, d, e, b, ldb, info)
      integer, intent(in) :: n, nrhs, ldb
      real(qp), intent(inout) :: d(*), e(*), b(ldb, *)
      integer, intent(out) :: info
      real(qp) :: ratio
      integer :: k

      info = 0
      do k = 1, n
         if (.not. d(k) > 0.0_qp) info = k
         if (info > 0) return
         if (k == n) exit
         ratio = e(k)/d(k)
         d(k + 1) = d(k + 1) - ratio*e(k)
         e(k) = ratio
         b(k + 1, :nrhs) = b(k + 1, :nrhs) - ratio*b(k, :nrhs)
      end do
      do k = n, 1, -1
         b(k, :nrhs) = b(k, :nrhs)/d(k)
         if (k < n) b(k, :nrhs) = b(k, :nrhs) - e(k)*b(k + 1, :nrhs)
      end do
   end subroutine ptsv
end module quad_dense
