!> Tests. A library loaded before LAPACK (LD_PRELOAD): it notes the size of each system that DGETRF factors and DGETRS solves, the
!> halves of DGESV, a line each in the file of the variable SOLVES.
module count_solves
   use, intrinsic :: iso_c_binding, only: c_ptr, c_funptr, c_char, c_int, c_size_t, c_intptr_t, c_null_char, c_f_pointer, &
      c_f_procpointer
   implicit none
   private

   interface
      !> The next procedure of this name in the libraries loaded.
      type(c_funptr) function dlsym(handle, name) bind(c)
         import :: c_funptr, c_intptr_t, c_char
         integer(c_intptr_t), value :: handle
         character(c_char), intent(in) :: name(*)
      end function dlsym
   end interface

   abstract interface
      subroutine getrf_interface(m, n, a, lda, ipiv, info) bind(c)
         import :: c_ptr
         type(c_ptr), value :: m, n, a, lda, ipiv, info
      end subroutine getrf_interface

      subroutine getrs_interface(trans, n, nrhs, a, lda, ipiv, b, ldb, info, length) bind(c)
         import :: c_ptr, c_size_t
         type(c_ptr), value :: trans, n, nrhs, a, lda, ipiv, b, ldb, info
         integer(c_size_t), value :: length
      end subroutine getrs_interface
   end interface

   !> RTLD_NEXT of dlfcn.h.
   integer(c_intptr_t), parameter :: next = -1

contains

   !> DGETRF of LAPACK; the arguments are addresses.
   subroutine getrf(m, n, a, lda, ipiv, info) bind(c, name='dgetrf_')
      type(c_ptr), value :: m, n, a, lda, ipiv, info
      procedure(getrf_interface), pointer :: real_one

      call note('DGETRF', n)
      call c_f_procpointer(dlsym(next, 'dgetrf_'//c_null_char), real_one)
      call real_one(m, n, a, lda, ipiv, info)
   end subroutine getrf

   !> DGETRS of LAPACK; the arguments are addresses but for the length of the first.
   subroutine getrs(trans, n, nrhs, a, lda, ipiv, b, ldb, info, length) bind(c, name='dgetrs_')
      type(c_ptr), value :: trans, n, nrhs, a, lda, ipiv, b, ldb, info
      integer(c_size_t), value :: length
      procedure(getrs_interface), pointer :: real_one

      call note('DGETRS', n)
      call c_f_procpointer(dlsym(next, 'dgetrs_'//c_null_char), real_one)
      call real_one(trans, n, nrhs, a, lda, ipiv, b, ldb, info, length)
   end subroutine getrs

   !> Notes that the procedure `name` is called for `n` equations.
   subroutine note(name, n)
      character(*), intent(in) :: name
      type(c_ptr), intent(in) :: n
      integer(c_int), pointer :: equations
      character(200) :: path
      integer :: unit

      call c_f_pointer(n, equations)
      call get_environment_variable('SOLVES', path)
      open (newunit=unit, file=path, position='append', action='write')
      write (unit, '(a, 1x, i0)') name, equations
      close (unit)
   end subroutine note
end module count_solves
