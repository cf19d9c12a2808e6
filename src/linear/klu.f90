!> Large sparse matrices by KLU (Davis and Palamadai Natarajan, ACM TOMS 37, 2010; part of SuiteSparse):
!> what is used of its C interface.
!>
!> Columns in the order of COLAMD and rows by true partial pivoting, as in LAPACK: KLU's own choices, which take a pivot
!> on the diagonal a thousand times smaller than another, lose six digits on nets of rods.
module klu
   use, intrinsic :: iso_c_binding, only: c_int, c_double, c_size_t, c_ptr, c_funptr, c_null_ptr, c_loc, c_associated, &
      c_f_pointer
   use kinds, only: wp
   implicit none
   private
   public :: pattern_t, common_t, klu_t, klu_defaults, klu_serves
   public :: order_columns, factor, solve, solve_transposed, pivots_of

   !> KLU knows double precision only.
   logical, parameter :: klu_serves = kind(1.0_wp) == c_double

   !> The entries of column k are in the rows row(first(k) + 1), ..., row(first(k + 1)); rows and `first` count from 0.
   !> `order`: the columns, from 0, in the order in which they are eliminated; of rows that serve as well the first in
   !> this order is the pivot's.
   type :: pattern_t
      integer(c_int), allocatable :: first(:), row(:), order(:)
   end type pattern_t

   !> klu_common of klu.h, with room for a longer one.
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

   !> How klu_symbolic of klu.h begins, up to the column order.
   type, bind(c) :: symbolic_t
      real(c_double) :: symmetry, est_flops, lnz, unz
      type(c_ptr) :: lnz_of
      integer(c_int) :: n, nz
      type(c_ptr) :: p, q
   end type symbolic_t

   !> How klu_numeric of klu.h begins, up to the diagonal of U.
   type, bind(c) :: numeric_t
      integer(c_int) :: n, nblocks, lnz, unz, max_lnz_block, max_unz_block
      type(c_ptr) :: pnum, pinv, lip, uip, llen, ulen, lubx, lusize, udiag
   end type numeric_t

   !> A pattern and the factors of the last matrix of that pattern. They are freed when the variable ends: it is
   !> declared where a block is solved, and a component of nothing.
   type :: klu_t
      type(pattern_t) :: pattern
      type(common_t) :: common
      type(c_ptr) :: symbolic = c_null_ptr, numeric = c_null_ptr
      integer :: exchanges = 1                    !< the sign of both permutations together
   contains
      final :: free_factors
   end type klu_t

   integer(c_int), parameter :: colamd = 1, unscaled = -1

   interface
      !> Sets the default parameters.
      integer(c_int) function klu_defaults(common) bind(c)
         import :: c_int, common_t
         type(common_t), intent(inout) :: common
      end function klu_defaults
      !> Orders the pattern: block triangular form, then COLAMD or AMD.
      type(c_ptr) function klu_analyze(n, ap, ai, common) bind(c)
         import :: c_int, c_ptr, common_t
         integer(c_int), value :: n
         integer(c_int), intent(in) :: ap(*), ai(*)
         type(common_t), intent(inout) :: common
      end function klu_analyze
      !> Takes the rows and columns of the pattern in the orders `p` and `q`.
      type(c_ptr) function klu_analyze_given(n, ap, ai, p, q, common) bind(c)
         import :: c_int, c_ptr, common_t
         integer(c_int), value :: n
         integer(c_int), intent(in) :: ap(*), ai(*), p(*), q(*)
         type(common_t), intent(inout) :: common
      end function klu_analyze_given
      !> Factors with pivoting.
      type(c_ptr) function klu_factor(ap, ai, ax, symbolic, common) bind(c)
         import :: c_int, c_ptr, common_t
         integer(c_int), intent(in) :: ap(*), ai(*)
         type(c_ptr), value :: ax, symbolic
         type(common_t), intent(inout) :: common
      end function klu_factor
      !> Solves A x = b in place.
      integer(c_int) function klu_solve(symbolic, numeric, ldim, nrhs, b, common) bind(c)
         import :: c_int, c_ptr, common_t
         type(c_ptr), value :: symbolic, numeric, b
         integer(c_int), value :: ldim, nrhs
         type(common_t), intent(inout) :: common
      end function klu_solve
      !> Solves A' x = b in place.
      integer(c_int) function klu_tsolve(symbolic, numeric, ldim, nrhs, b, common) bind(c)
         import :: c_int, c_ptr, common_t
         type(c_ptr), value :: symbolic, numeric, b
         integer(c_int), value :: ldim, nrhs
         type(common_t), intent(inout) :: common
      end function klu_tsolve
      !> Copies out the factors; arguments that are null are left out.
      integer(c_int) function klu_extract(numeric, symbolic, lp, li, lx, up, ui, ux, fp, fi, fx, p, q, rs, r, common) &
         bind(c)
         import :: c_int, c_ptr, common_t
         type(c_ptr), value :: numeric, symbolic, lp, li, lx, up, ui, ux, fp, fi, fx, rs, r
         integer(c_int), intent(out) :: p(*), q(*)
         type(common_t), intent(inout) :: common
      end function klu_extract
      !> Frees the ordering.
      integer(c_int) function klu_free_symbolic(symbolic, common) bind(c)
         import :: c_int, c_ptr, common_t
         type(c_ptr), intent(inout) :: symbolic
         type(common_t), intent(inout) :: common
      end function klu_free_symbolic
      !> Frees the factors.
      integer(c_int) function klu_free_numeric(numeric, common) bind(c)
         import :: c_int, c_ptr, common_t
         type(c_ptr), intent(inout) :: numeric
         type(common_t), intent(inout) :: common
      end function klu_free_numeric
   end interface

contains

   !> Finds the order of elimination of `p`: the columns in that of COLAMD, so that the factors fill up little.
   subroutine order_columns(p)
      type(pattern_t), intent(inout) :: p
      type(common_t) :: common
      type(c_ptr) :: symbolic
      type(symbolic_t), pointer :: found
      integer(c_int), pointer :: q(:)
      integer(c_int) :: n, done

      n = size(p%first, kind=c_int) - 1_c_int
      call set_common(common)
      symbolic = klu_analyze(n, p%first, p%row, common)
      call c_f_pointer(symbolic, found)
      call c_f_pointer(found%q, q, [n])
      p%order = q
      done = klu_free_symbolic(symbolic, common)
   end subroutine order_columns

   !> The settings: see the head of the module. The blocks of a mechanism have been found before.
   subroutine set_common(common)
      type(common_t), intent(inout) :: common
      integer(c_int) :: done

      done = klu_defaults(common)
      common%ordering = colamd
      common%tol = 1.0_c_double
      common%scale = unscaled
      common%btf = 0
   end subroutine set_common

   !> Factors the matrix `a` (entries of the pattern, column by column). `info` > 0: exactly singular, no factors.
   !>
   !> Rejected: the pivots of the matrix before (klu_refactor), in less than half the time. They make what is told of a
   !> position depend on the way there, and nets of rods were lost at change points.
   subroutine factor(k, a, info)
      type(klu_t), intent(inout) :: k
      real(wp), intent(in), target :: a(*)
      integer, intent(out) :: info
      integer(c_int) :: done

      info = 1
      if (.not. c_associated(k%symbolic)) then
         call set_common(k%common)
         associate (p => k%pattern)
            k%symbolic = klu_analyze_given(order_of(k), p%first, p%row, p%order, p%order, k%common)
         end associate
         if (.not. c_associated(k%symbolic)) return
      end if
      if (c_associated(k%numeric)) done = klu_free_numeric(k%numeric, k%common)
      k%numeric = klu_factor(k%pattern%first, k%pattern%row, c_loc(a), k%symbolic, k%common)
      if (.not. c_associated(k%numeric)) return
      info = 0
      call note_exchanges(k)
   end subroutine factor

   !> `b` (n): the right-hand side, then the solution.
   subroutine solve(k, b)
      type(klu_t), intent(inout) :: k
      real(wp), intent(inout), target :: b(*)
      integer(c_int) :: done

      done = klu_solve(k%symbolic, k%numeric, order_of(k), 1_c_int, c_loc(b), k%common)
   end subroutine solve

   !> The same with the matrix transposed.
   subroutine solve_transposed(k, b)
      type(klu_t), intent(inout) :: k
      real(wp), intent(inout), target :: b(*)
      integer(c_int) :: done

      done = klu_tsolve(k%symbolic, k%numeric, order_of(k), 1_c_int, c_loc(b), k%common)
   end subroutine solve_transposed

   !> The pivots (n); the product of their signs and of k%exchanges is the sign of the determinant.
   function pivots_of(k) result(diagonal)
      type(klu_t), intent(in) :: k
      real(wp) :: diagonal(size(k%pattern%first) - 1)
      type(numeric_t), pointer :: numeric
      real(c_double), pointer :: u(:)

      call c_f_pointer(k%numeric, numeric)
      call c_f_pointer(numeric%udiag, u, [order_of(k)])
      diagonal = real(u, wp)
   end function pivots_of

   !> The order of the matrix.
   pure integer(c_int) function order_of(k)
      type(klu_t), intent(in) :: k

      order_of = size(k%pattern%first, kind=c_int) - 1_c_int
   end function order_of

   !> Notes the sign of the row and column permutations of the factors just made.
   subroutine note_exchanges(k)
      type(klu_t), intent(inout) :: k
      integer(c_int), allocatable :: rows(:), columns(:)
      integer(c_int) :: done

      allocate (rows(order_of(k)), columns(order_of(k)))
      done = klu_extract(k%numeric, k%symbolic, c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, &
         c_null_ptr, c_null_ptr, c_null_ptr, c_null_ptr, rows, columns, c_null_ptr, c_null_ptr, k%common)
      k%exchanges = sign_of(rows)*sign_of(columns)
   end subroutine note_exchanges

   !> The sign of a permutation of 0 to n - 1, which is undone: a cycle of length c is c - 1 exchanges.
   integer function sign_of(p)
      integer(c_int), intent(inout) :: p(0:)
      integer(c_int) :: i, next

      sign_of = 1
      do i = 0, size(p, kind=c_int) - 1_c_int
         do while (p(i) /= i)
            next = p(i)
            p(i) = p(next)
            p(next) = next
            sign_of = -sign_of
         end do
      end do
   end function sign_of

   !> Frees what KLU has allocated for `k`.
   impure elemental subroutine free_factors(k)
      type(klu_t), intent(inout) :: k
      integer(c_int) :: done

      if (c_associated(k%numeric)) done = klu_free_numeric(k%numeric, k%common)
      if (c_associated(k%symbolic)) done = klu_free_symbolic(k%symbolic, k%common)
   end subroutine free_factors
end module klu
