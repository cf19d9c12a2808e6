!> Least squares in real128, with the arguments and the results of LAPACK's routines of the same
!> names: A = Q R by Householder's reflections I - tau v v^T, v(1) = 1. Only what is asked of them here;
!> `info` < 0 for anything else.
module quad_orthogonal
   use, intrinsic :: iso_fortran_env, only: qp => real128
   implicit none
   private
   public :: geqrf, ormqr, trtrs, trcon

contains

   !> `a` (m, n), m >= n, becomes R on and above its diagonal and the vectors v below it; `tau` (n).
   pure subroutine geqrf(m, n, a, lda, tau, work, lwork, info)
      integer, intent(in) :: m, n, lda, lwork
      real(qp), intent(inout) :: a(lda, *), work(*)
      real(qp), intent(out) :: tau(*)
      integer, intent(out) :: info
      real(qp) :: diagonal
      integer :: j, k

      info = merge(0, -7, m >= n .and. lwork >= n)
      if (info < 0) return
      do k = 1, n
         tau(k) = 0.0_qp
         if (k == m) exit
         if (maxval(abs(a(k + 1:m, k))) <= 0.0_qp) cycle
         diagonal = -sign(norm2(a(k:m, k)), a(k, k))
         tau(k) = (diagonal - a(k, k))/diagonal
         a(k + 1:m, k) = a(k + 1:m, k)/(a(k, k) - diagonal)
         a(k, k) = diagonal
         do j = k + 1, n
            work(j) = a(k, j) + dot_product(a(k + 1:m, k), a(k + 1:m, j))
            a(k, j) = a(k, j) - tau(k)*work(j)
            a(k + 1:m, j) = a(k + 1:m, j) - tau(k)*work(j)*a(k + 1:m, k)
         end do
      end do
   end subroutine geqrf

   !> Q^T `c`, `c` (m, n), with the first `k` reflections of `geqrf`; `side` is L, `trans` T.
   pure subroutine ormqr(side, trans, m, n, k, a, lda, tau, c, ldc, work, lwork, info)
      character(1), intent(in) :: side, trans
      integer, intent(in) :: m, n, k, lda, ldc, lwork
      real(qp), intent(in) :: a(lda, *), tau(*)
      real(qp), intent(inout) :: c(ldc, *), work(*)
      integer, intent(out) :: info
      integer :: i, j

      info = merge(0, -1, side == 'L' .and. trans == 'T' .and. lwork >= n)
      if (info < 0) return
      do i = 1, k
         do j = 1, n
            work(j) = c(i, j) + dot_product(a(i + 1:m, i), c(i + 1:m, j))
            c(i, j) = c(i, j) - tau(i)*work(j)
            c(i + 1:m, j) = c(i + 1:m, j) - tau(i)*work(j)*a(i + 1:m, i)
         end do
      end do
   end subroutine ormqr

   !> Solves R x = `b` (n, nrhs); `uplo` is U, `trans` N, `diag` N. `info` > 0: that diagonal entry is zero.
   pure subroutine trtrs(uplo, trans, diag, n, nrhs, a, lda, b, ldb, info)
      character(1), intent(in) :: uplo, trans, diag
      integer, intent(in) :: n, nrhs, lda, ldb
      real(qp), intent(in) :: a(lda, *)
      real(qp), intent(inout) :: b(ldb, *)
      integer, intent(out) :: info
      integer :: j, k

      info = merge(0, -1, uplo == 'U' .and. trans == 'N' .and. diag == 'N')
      if (info < 0) return
      do k = 1, n
         if (abs(a(k, k)) <= 0.0_qp) info = k
         if (info > 0) return
      end do
      do j = 1, nrhs
         do k = n, 1, -1
            b(k, j) = b(k, j)/a(k, k)
            b(:k - 1, j) = b(:k - 1, j) - b(k, j)*a(:k - 1, k)
         end do
      end do
   end subroutine trtrs

   !> 1/(|R| |R^-1|) in the maximum norm, exactly, row by row; `norm` is I, `uplo` U, `diag` N. `work` (2 n).
   pure subroutine trcon(norm, uplo, diag, n, a, lda, rcond, work, iwork, info)
      character(1), intent(in) :: norm, uplo, diag
      integer, intent(in) :: n, lda
      real(qp), intent(in) :: a(lda, *)
      real(qp), intent(out) :: rcond
      real(qp), intent(inout) :: work(*)
      integer, intent(inout) :: iwork(*)
      integer, intent(out) :: info
      real(qp) :: largest
      integer :: k

      rcond = 0.0_qp
      info = merge(0, -1, norm == 'I')
      if (info < 0) return
      iwork(:n) = 0
      work(n + 1:2*n) = 0.0_qp
      largest = 0.0_qp
      do k = 1, n
         largest = max(largest, sum(abs(a(k, k:n))))
         work(:n) = 0.0_qp
         work(k) = 1.0_qp
         call trtrs(uplo, 'N', diag, n, 1, a, lda, work, n, info)
         if (info /= 0) return
         work(n + 1:2*n) = work(n + 1:2*n) + abs(work(:n))
      end do
      if (n > 0) rcond = 1.0_qp/(largest*maxval(work(n + 1:2*n)))
   end subroutine trcon
end module quad_orthogonal
