!> Level 2. The routines of LAPACK under the names that they have for every kind: here LAPACK's own, for
!> real64.
module lapack
   use lapack_double, only: gesv => dgesv, getrf => dgetrf, getrs => dgetrs, gecon => dgecon, &
      lacn2 => dlacn2, ptsv => dptsv, geqrf => dgeqrf, ormqr => dormqr, trtrs => dtrtrs, &
      trcon => dtrcon, gesvd => dgesvd
   implicit none
   private
   public :: gesv, getrf, getrs, gecon, lacn2, ptsv, geqrf, ormqr, trtrs, trcon, gesvd
end module lapack
