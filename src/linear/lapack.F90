!> The routines of LAPACK under one name for every kind of reals: LAPACK's own or, for real128, KINMAT's.
#define SAME(text) text
#define OF_KIND(name) name=>SAME(LETTER)SAME(name)
module lapack
#ifdef LETTER
   use lapack_routines, only: zgetf2, zgetrs, OF_KIND(gesv), OF_KIND(getrf), OF_KIND(getrs), OF_KIND(lacn2), &
      OF_KIND(ptsv), OF_KIND(geqrf), OF_KIND(ormqr), OF_KIND(trtrs), OF_KIND(gesvd)
#else
   use lapack_routines, only: zgetf2, zgetrs
   use quad_lapack, only: gesv, getrf, getrs, lacn2, ptsv, geqrf, ormqr, trtrs, gesvd
#endif
   implicit none
   private
   public :: zgetf2, zgetrs, gesv, getrf, getrs, lacn2, ptsv, geqrf, ormqr, trtrs, gesvd
end module lapack
