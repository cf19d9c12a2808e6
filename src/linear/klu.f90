!> Large sparse matrices by KLU (Davis and Palamadai Natarajan, ACM TOMS 37, 2010; part of SuiteSparse): the part of
!> KLU's C interface that is used.
!>
!> Columns are in the order of COLAMD, rows by true partial pivoting, as in LAPACK. KLU's own choices take a pivot on
!> the diagonal that is a thousand times smaller than another: they lose six digits on nets of rods.
module klu
   use, intrinsic :: iso_c_binding, only: c_int, c_double, c_size_t, c_ptr, c_funptr, c_null_ptr, c_loc, c_associated, &
      c_f_pointer
   use kinds, only: wp
   implicit none
   private
   public :: pattern_t, common_t, klu_defaults, klu_serves
   public :: sparse_factors_t, order_columns, factor, solve, determinant_sign, release

   !> KLU knows double precision only.
   logical, parameter :: klu_serves = kind(1.0_wp) == c_double

   !> Which elements of a square matrix can differ from zero. The entries of column k are in the rows row(first(k) + 1),
   !> ..., row(first(k + 1)); rows and `first` (columns + 1) count from 0. `order`: the columns, from 0, in the order of
   !> elimination; of rows with equally large pivots the first in this order is taken.
   type :: pattern_t
      integer(c_int), allocatable :: first(:), row(:), order(:)
   end type pattern_t

   !> klu_common of klu.h, with room for a longer structure of later releases.
   type, bind(c) :: common_t
      real(c_double) :: tol = 0, memgrow = 0, initmem_amd = 0, initmem = 0, maxwork = 0
      integer(c_int) :: btf = 0, ordering = 0, scale = 0
      type(c_funptr) :: user_order
      type(c_ptr) :: user_data
      integer(c_int) :: halt_if_singular = 0, status = 0, nrealloc = 0, structural_rank = 0, numerical_rank = 0
      integer(c_int) :: singular_col = 0, noffdiag = 0
      real(c_double) :: flops = 0, rcond = 0, condest = 0, rgrowth = 0, work = 0
      integer(c_size_t) :: memusage = 0, mempeak = 0
      integer(c_size_t) :: room(32) = 0
   end type common_t

   !> klu_symbolic of klu.h.
   type, bind(c) :: symbolic_t
      real(c_double) :: symmetry = -1, est_flops = -1, lnz = -1, unz = -1
      type(c_ptr) :: lnz_of = c_null_ptr
      integer(c_int) :: n = 0, nz = 0
      type(c_ptr) :: p = c_null_ptr, q = c_null_ptr, r = c_null_ptr
      integer(c_int) :: nzoff = 0, nblocks = 1, maxblock = 0, ordering = 2, do_btf = 0, structural_rank = -1
   end type symbolic_t

   !> The beginning of klu_numeric of klu.h.
   type, bind(c) :: numeric_t
      integer(c_int) :: n, nblocks, lnz, unz, max_lnz_block, max_unz_block
      type(c_ptr) :: pnum, pinv, lip, uip, llen, ulen, lubx, lusize, udiag
   end type numeric_t

   !> The factors of a matrix, in memory of KLU's until `release`.
   type :: sparse_factors_t
      private
      type(common_t) :: common
      type(symbolic_t) :: symbolic
      type(c_ptr) :: numeric = c_null_ptr
      !> (n + 2) The columns in the order of their elimination, then the ends of its only block, 0 and n.
      integer(c_int), allocatable :: order(:)
   end type sparse_factors_t

   !> The sizes of factors before they are found; never written.
   real(c_double), target, save :: unknown(1) = -1

   !> Of `ordering` and `scale` of klu_common: the columns in the order of COLAMD, the rows as they are.
   integer(c_int), parameter :: colamd = 1, unscaled = -1

   interface
      !> Sets the default parameters of KLU. The result is 1, or 0 for an error.
      integer(c_int) function klu_defaults(common) bind(c)
         import :: c_int, common_t
         type(common_t), intent(inout) :: common   !< becomes the default parameters
      end function klu_defaults
      !> Orders a pattern: block triangular form, then COLAMD or AMD. The result is the ordering, null for an error.
      type(c_ptr) function klu_analyze(n, ap, ai, common) bind(c)
         import :: c_int, c_ptr, common_t
         integer(c_int), value :: n           !< rows of the matrix
         integer(c_int), intent(in) :: ap(*)  !< (n + 1) `first` of the pattern
         integer(c_int), intent(in) :: ai(*)  !< (entries) `row` of the pattern
         type(common_t), intent(inout) :: common   !< parameters; gets the status of the call
      end function klu_analyze
      !> Factors a matrix with pivoting. The result is the factors, null for an error or an exactly singular matrix.
      type(c_ptr) function klu_factor(ap, ai, ax, symbolic, common) bind(c)
         import :: c_int, c_ptr, common_t
         integer(c_int), intent(in) :: ap(*)  !< (n + 1) `first` of the pattern
         integer(c_int), intent(in) :: ai(*)  !< (entries) `row` of the pattern
         type(c_ptr), value :: ax             !< (entries) the matrix
         type(c_ptr), value :: symbolic       !< the ordering of its pattern
         type(common_t), intent(inout) :: common   !< parameters; gets the status of the call
      end function klu_factor
      !> Solves A x = right in place with the factors of A. The result is 1, or 0 for an error.
      integer(c_int) function klu_solve(symbolic, numeric, ldim, nrhs, right, common) bind(c)
         import :: c_int, c_ptr, common_t
         type(c_ptr), value :: symbolic       !< the ordering
         type(c_ptr), value :: numeric        !< the factors
         type(c_ptr), value :: right          !< (ldim, nrhs) right-hand sides, then solutions
         integer(c_int), value :: ldim        !< distance of two right-hand sides, in numbers
         integer(c_int), value :: nrhs        !< how many right-hand sides
         type(common_t), intent(inout) :: common   !< parameters; gets the status of the call
      end function klu_solve
      !> Frees an ordering. The result is 1, or 0 for an error.
      integer(c_int) function klu_free_symbolic(symbolic, common) bind(c)
         import :: c_int, c_ptr, common_t
         type(c_ptr), intent(inout) :: symbolic   !< becomes null
         type(common_t), intent(inout) :: common   !< parameters; gets the status of the call
      end function klu_free_symbolic
   end interface
   !> Solves A' x = right in place with the factors of A. The result is 1, or 0 for an error.
   procedure(klu_solve), bind(c) :: klu_tsolve
   !> Frees the factors of a matrix. The result is 1, or 0 for an error.
   procedure(klu_free_symbolic), bind(c) :: klu_free_numeric

contains

   !> Finds the order of elimination of a pattern by COLAMD, so that few zeros fill up in the factors.
   subroutine order_columns(pattern)
      type(pattern_t), intent(inout) :: pattern   !< square; gets its `order`
      type(common_t) :: common
      type(c_ptr) :: symbolic
      type(symbolic_t), pointer :: found
      integer(c_int), pointer :: q(:)
      integer(c_int) :: n, done

      n = size(pattern%first, kind=c_int) - 1_c_int
      call set_common(common)
      symbolic = klu_analyze(n, pattern%first, pattern%row, common)
      call c_f_pointer(symbolic, found)
      call c_f_pointer(found%q, q, [n])
      pattern%order = q
      done = klu_free_symbolic(symbolic, common)
   end subroutine order_columns

   !> Sets the parameters of KLU: columns by COLAMD, true partial pivoting, and no search for blocks, which the
   !> structure of a mechanism has found already.
   subroutine set_common(common)
      type(common_t), intent(inout) :: common   !< the parameters; its room for results is emptied
      integer(c_int) :: done

      done = klu_defaults(common)
      common%ordering = colamd
      common%tol = 1.0_c_double
      common%scale = unscaled
      common%btf = 0
   end subroutine set_common

   !> Factors a sparse matrix. Rejected: the pivots of the previous matrix as long as they are large enough. They halve
   !> the time of large matrices, but digits then depend on earlier matrices.
   subroutine factor(pattern, a, factors, info)
      type(pattern_t), intent(in) :: pattern !< of the matrix, ordered
      real(wp), intent(in), target :: a(*)   !< (entries of the pattern) the matrix, column by column
      type(sparse_factors_t), intent(inout), target :: factors   !< become factors of the matrix; earlier ones are freed
      integer, intent(out) :: info           !< 0; above 0: exactly singular, no factors
      integer(c_int) :: n

      call release(factors)
      call set_common(factors%common)
      n = size(pattern%order, kind=c_int)
      factors%order = [pattern%order, 0_c_int, n]
      factors%symbolic%n = n
      factors%symbolic%maxblock = n
      factors%symbolic%nz = size(pattern%row, kind=c_int)
      factors%symbolic%lnz_of = c_loc(unknown)
      ! In one block no entry is outside the diagonal blocks.
      factors%symbolic%p = c_loc(factors%order)
      factors%symbolic%q = factors%symbolic%p
      factors%symbolic%r = c_loc(factors%order(n + 1))
      factors%numeric = klu_factor(pattern%first, pattern%row, c_loc(a), c_loc(factors%symbolic), factors%common)
      info = merge(0, 1, c_associated(factors%numeric))
   end subroutine factor

   !> Frees the factors of a sparse matrix, if there are any.
   subroutine release(factors)
      type(sparse_factors_t), intent(inout) :: factors   !< there are none then
      integer(c_int) :: done

      if (c_associated(factors%numeric)) done = klu_free_numeric(factors%numeric, factors%common)
      factors%numeric = c_null_ptr
   end subroutine release

   !> Solves equations with the factors of their sparse matrix.
   subroutine solve(factors, right, transposed)
      type(sparse_factors_t), intent(inout), target :: factors   !< of the matrix, as `factor` left them
      real(wp), intent(inout), target :: right(*)   !< (n) the right-hand side, then the solution
      logical, intent(in) :: transposed      !< of the equations with the transposed matrix
      integer(c_int) :: done

      associate (symbolic => c_loc(factors%symbolic), n => factors%symbolic%n)
         if (transposed) done = klu_tsolve(symbolic, factors%numeric, n, 1_c_int, c_loc(right), factors%common)
         if (.not. transposed) done = klu_solve(symbolic, factors%numeric, n, 1_c_int, c_loc(right), factors%common)
      end associate
   end subroutine solve

   !> Finds the sign of the determinant of a sparse matrix, 1 or -1, from its factors.
   integer function determinant_sign(numbers) result(sign_of)
      type(sparse_factors_t), intent(in) :: numbers   !< the factors, as `factor` left them
      type(numeric_t), pointer :: factors
      integer(c_int), pointer :: pivot_row(:)
      real(c_double), pointer :: pivots(:)

      call c_f_pointer(numbers%numeric, factors)
      call c_f_pointer(factors%pnum, pivot_row, [numbers%symbolic%n])
      call c_f_pointer(factors%udiag, pivots, [numbers%symbolic%n])
      sign_of = sign_of_permutation(pivot_row)*sign_of_permutation(numbers%order(:numbers%symbolic%n))
      if (mod(count(pivots < 0.0_c_double), 2) == 1) sign_of = -sign_of
   end function determinant_sign

   !> Finds the sign of a permutation, 1 or -1: a cycle of length c is c - 1 exchanges.
   pure integer function sign_of_permutation(permutation) result(sign_of)
      integer(c_int), intent(in) :: permutation(:)   !< (n) each of 0 to n - 1 once
      logical :: is_seen(size(permutation))
      integer :: i, next

      sign_of = 1
      is_seen = .false.
      do i = 1, size(permutation)
         next = permutation(i) + 1
         do while (next /= i .and. .not. is_seen(i))
            is_seen(next) = .true.
            next = permutation(next) + 1
            sign_of = -sign_of
         end do
      end do
   end function sign_of_permutation
end module klu
