!> The routines of LAPACK that are used; LETTER is s or d, the letter of the kind of reals. LAPACK's documentation
!> explains their arguments. LAPACK has no routines for real128: `lapack` then takes KINMAT's own.
#define SAME(text) text
#define NAMED(name) SAME(LETTER)SAME(name)
module lapack_routines
   use, intrinsic :: iso_fortran_env, only: dp => real64
#ifdef LETTER
   use, intrinsic :: iso_fortran_env, only: wp => REAL_KIND
#endif
   implicit none
   public

   interface
      !> Factors a complex matrix by LU with partial pivoting, column by column: a small matrix in half of the time of
      !> ZGETRF. The precision is double, for any kind of reals.
      subroutine zgetf2(m, n, a, lda, ipiv, info)
         import :: dp
         integer, intent(in) :: m, n, lda
         complex(dp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine zgetf2
      !> Solves complex equations with the factors of zgetf2.
      subroutine zgetrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: dp
         character(1), intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
         complex(dp), intent(in) :: a(lda, *)
         complex(dp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine zgetrs
#ifdef LETTER
      !> Factors a matrix by LU with partial pivoting.
      pure subroutine NAMED(getrf)(m, n, a, lda, ipiv, info)
         import :: wp
         integer, intent(in) :: m, n, lda
         real(wp), intent(inout) :: a(lda, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine NAMED(getrf)
      !> Solves equations with the factors of getrf.
      subroutine NAMED(getrs)(trans, n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         character(1), intent(in) :: trans
         integer, intent(in) :: n, nrhs, lda, ldb, ipiv(*)
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine NAMED(getrs)
      !> Factors a matrix and solves its equations: getrf, then getrs.
      subroutine NAMED(gesv)(n, nrhs, a, lda, ipiv, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(inout) :: a(lda, *), b(ldb, *)
         integer, intent(out) :: ipiv(*), info
      end subroutine NAMED(gesv)
      !> Estimates the 1-norm of a matrix from its products with vectors, by reverse communication.
      subroutine NAMED(lacn2)(n, v, x, isgn, est, kase, isave)
         import :: wp
         integer, intent(in) :: n
         real(wp), intent(inout) :: v(*), x(*), est
         integer, intent(inout) :: isgn(*), kase, isave(3)
      end subroutine NAMED(lacn2)
      !> Solves equations with a positive definite tridiagonal matrix.
      subroutine NAMED(ptsv)(n, nrhs, d, e, b, ldb, info)
         import :: wp
         integer, intent(in) :: n, nrhs, ldb
         real(wp), intent(inout) :: d(*), e(*), b(ldb, *)
         integer, intent(out) :: info
      end subroutine NAMED(ptsv)
      !> Factors a matrix by QR.
      pure subroutine NAMED(geqrf)(m, n, a, lda, tau, work, lwork, info)
         import :: wp
         integer, intent(in) :: m, n, lda, lwork
         real(wp), intent(inout) :: a(lda, *), work(*)
         real(wp), intent(out) :: tau(*)
         integer, intent(out) :: info
      end subroutine NAMED(geqrf)
      !> Multiplies a matrix by the orthogonal factor of geqrf.
      pure subroutine NAMED(ormqr)(side, trans, m, n, k, a, lda, tau, c, ldc, work, lwork, info)
         import :: wp
         character(1), intent(in) :: side, trans
         integer, intent(in) :: m, n, k, lda, ldc, lwork
         real(wp), intent(in) :: a(lda, *), tau(*)
         real(wp), intent(inout) :: c(ldc, *), work(*)
         integer, intent(out) :: info
      end subroutine NAMED(ormqr)
      !> Solves equations with a triangular matrix.
      subroutine NAMED(trtrs)(uplo, trans, diag, n, nrhs, a, lda, b, ldb, info)
         import :: wp
         character(1), intent(in) :: uplo, trans, diag
         integer, intent(in) :: n, nrhs, lda, ldb
         real(wp), intent(in) :: a(lda, *)
         real(wp), intent(inout) :: b(ldb, *)
         integer, intent(out) :: info
      end subroutine NAMED(trtrs)
      !> Finds the singular value decomposition of a matrix.
      pure subroutine NAMED(gesvd)(jobu, jobvt, m, n, a, lda, s, u, ldu, vt, ldvt, work, lwork, info)
         import :: wp
         character(1), intent(in) :: jobu, jobvt
         integer, intent(in) :: m, n, lda, ldu, ldvt, lwork
         real(wp), intent(inout) :: a(lda, *), work(*)
         real(wp), intent(out) :: s(*), u(ldu, *), vt(ldvt, *)
         integer, intent(out) :: info
      end subroutine NAMED(gesvd)
#endif
   end interface
end module lapack_routines
