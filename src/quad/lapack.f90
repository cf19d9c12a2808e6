!> Level 2. The routines of LAPACK under the names that they have for every kind: LAPACK has none for
!> real128, and these are our own.
module lapack
   use quad_dense, only: gesv, getrf, getrs, gecon, lacn2, ptsv
   use quad_orthogonal, only: geqrf, ormqr, trtrs, trcon
   use quad_singular, only: gesvd
   implicit none
   private
   public :: gesv, getrf, getrs, gecon, lacn2, ptsv, geqrf, ormqr, trtrs, trcon, gesvd
end module lapack
