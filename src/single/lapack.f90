!> Level 2. The routines of LAPACK under the names that they have for every kind: here LAPACK's own, for
!> real32.
module lapack
   use lapack_single, only: gesv => sgesv, getrf => sgetrf, getrs => sgetrs, gecon => sgecon, &
      lacn2 => slacn2, ptsv => sptsv, geqrf => sgeqrf, ormqr => sormqr, trtrs => strtrs, &
      trcon => strcon, gesvd => sgesvd
   implicit none
   private
   public :: gesv, getrf, getrs, gecon, lacn2, ptsv, geqrf, ormqr, trtrs, trcon, gesvd
end module lapack
