!> Level 1. The routines of LAPACK that are used, for real32, and nothing else of it.
module lapack_single
   use, intrinsic :: iso_fortran_env, only: sp => real32
   implicit none
   private
   public :: sgesv, sgetrf, sgetrs, sgecon, slacn2, sptsv
   public :: sgeqrf, sormqr, strtrs, strcon, sgesvd

   interface
      subroutine sgetrf(m, n, a, lda, ipiv, info)
         import :: sp
         integer, intent(in) :: m, n, lda
         real(sp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine sgetrf
      subroutine sgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: sp
         character(1), intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
         real(sp), intent(in) :: a(lda, *)
         real(sp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine sgetrs
      subroutine sgecon(norm, n, a, lda, anorm, rcond, work, iwork, info)
         import :: sp
         character(1), intent(in) :: norm
         integer, intent(in) :: n, lda
         real(sp), intent(in) :: a(lda, *), anorm
         real(sp), intent(out) :: rcond
         real(sp), intent(inout) :: work(*)
         integer, intent(inout) :: iwork(*)
         integer, intent(out) :: info
      end subroutine sgecon
      subroutine sgesv(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: sp
         integer, intent(in) :: n, nrhs, lda, ldb
         real(sp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine sgesv
      subroutine slacn2(n, v, x, isgn, est, kase, isave)
         import :: sp
         integer, intent(in) :: n
         real(sp), intent(inout) :: v(*), x(*), est
         integer, intent(inout) :: isgn(*), kase, isave(3)
      end subroutine slacn2
      subroutine sptsv(n, nrhs, d, e, b, ldb, info)
         import :: sp
         integer, intent(in) :: n, nrhs, ldb
         real(sp), intent(inout) :: d(*), e(*), b(ldb, *)
         integer, intent(out) :: info
      end subroutine sptsv
      subroutine sgeqrf(m, n, a, lda, tau, work, lwork, info)
         import :: sp
         integer, intent(in) :: m, n, lda, lwork
         real(sp), intent(inout) :: a(lda, *), work(*)
         real(sp), intent(out) :: tau(*)
         integer, intent(out) :: info
      end subroutine sgeqrf
      subroutine sormqr(side, trans, m, n, k, a, lda, tau, c, ldc, work, lwork, info)
         import :: sp
         character(1), intent(in) :: side, trans
         integer, intent(in) :: m, n, k, lda, ldc, lwork
         real(sp), intent(in) :: a(lda, *), tau(*)
         real(sp), intent(inout) :: c(ldc, *), work(*)
         integer, intent(out) :: info
      end subroutine sormqr
      subroutine strtrs(uplo, trans, diag, n, nrhs, a, lda, b, ldb, info)
         import :: sp
         character(1), intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, nrhs, lda, ldb
         real(sp), intent(in) :: a(lda, *)
         real(sp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine strtrs
      subroutine strcon(norm, uplo, diag, n, a, lda, rcond, work, iwork, info)
         import :: sp
         character(1), intent(in) :: norm, uplo, diag
         integer, intent(in) :: n, lda
         real(sp), intent(in) :: a(lda, *)
         real(sp), intent(out) :: rcond
         real(sp), intent(inout) :: work(*)
         integer, intent(inout) :: iwork(*)
         integer, intent(out) :: info
      end subroutine strcon
      subroutine sgesvd(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
         import :: sp
         character(1), intent(in) :: jobu, jobvt
         integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
         real(sp), intent(inout) :: a(lda, *), work(*)
         real(sp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *)
         integer, intent(out) :: info
      end subroutine sgesvd
   end interface
end module lapack_single
