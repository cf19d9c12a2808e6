!> Level 1. The routines of LAPACK that are used, for real64, and nothing else of it.
module lapack_double
   use, intrinsic :: iso_fortran_env, only: dp => real64
   implicit none
   private
   public :: dgesv, dgetrf, dgetrs, dgecon, dlacn2, dptsv
   public :: dgeqrf, dormqr, dtrtrs, dtrcon, dgesvd

   interface
      subroutine dgetrf(m, n, a, lda, ipiv, info)
         import :: dp
         integer, intent(in) :: m, n, lda
         real(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgetrf
      subroutine dgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: dp
         character(1), intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dgetrs
      subroutine dgecon(norm, n, a, lda, anorm, rcond, work, iwork, info)
         import :: dp
         character(1), intent(in) :: norm
         integer, intent(in) :: n, lda
         real(dp), intent(in) :: a(lda, *), anorm
         real(dp), intent(out) :: rcond
         real(dp), intent(inout) :: work(*)
         integer, intent(inout) :: iwork(*)
         integer, intent(out) :: info
      end subroutine dgecon
      subroutine dgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: dp
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine dgesv
      subroutine dlacn2(n, v, x, isgn, est, kase, isave)
         import :: dp
         integer, intent(in) :: n
         real(dp), intent(inout) :: v(*), x(*), est
         integer, intent(inout) :: isgn(*), kase, isave(3)
      end subroutine dlacn2
      subroutine dptsv(n, nrhs, d, e, b, ldb, info)
         import :: dp
         integer, intent(in) :: n, nrhs, ldb
         real(dp), intent(inout) :: d(*), e(*), b(ldb, *)
         integer, intent(out) :: info
      end subroutine dptsv
      subroutine dgeqrf(m, n, a, lda, tau, work, lwork, info)
         import :: dp
         integer, intent(in) :: m, n, lda, lwork
         real(dp), intent(inout) :: a(lda, *), work(*)
         real(dp), intent(out) :: tau(*)
         integer, intent(out) :: info
      end subroutine dgeqrf
      subroutine dormqr(side, trans, m, n, k, a, lda, tau, c, ldc, work, lwork, info)
         import :: dp
         character(1), intent(in) :: side, trans
         integer, intent(in) :: m, n, k, lda, ldc, lwork
         real(dp), intent(in) :: a(lda, *), tau(*)
         real(dp), intent(inout) :: c(ldc, *), work(*)
         integer, intent(out) :: info
      end subroutine dormqr
      subroutine dtrtrs(uplo, trans, diag, n, nrhs, a, lda, b, ldb, info)
         import :: dp
         character(1), intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, nrhs, lda, ldb
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine dtrtrs
      subroutine dtrcon(norm, uplo, diag, n, a, lda, rcond, work, iwork, info)
         import :: dp
         character(1), intent(in) :: norm, uplo, diag
         integer, intent(in) :: n, lda
         real(dp), intent(in) :: a(lda, *)
         real(dp), intent(out) :: rcond
         real(dp), intent(inout) :: work(*)
         integer, intent(inout) :: iwork(*)
         integer, intent(out) :: info
      end subroutine dtrcon
      subroutine dgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
         import :: dp
         character(1), intent(in) :: jobu, jobvt
         integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
         real(dp), intent(inout) :: a(lda, *), work(*)
         real(dp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *)
         integer, intent(out) :: info
      end subroutine dgesvd
   end interface
end module lapack_double
