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
   public :: order_columns, factor, solve, determinant_sign

   !> KLU knows double precision only.
   logical, parameter :: klu_serves = kind(1.0_wp) == c_double
   !> Pivots of an earlier matrix serve while no multiplier is larger. Partial pivoting has 1; sparse direct solvers
   !> usually allow 10 (threshold pivoting: Duff, Erisman and Reid, Direct Methods for Sparse Matrices, 2017, ch. 5).
   real(c_double), parameter :: max_multiplier = 10.0_c_double

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

   !> klu_symbolic of klu.h.
   type, bind(c) :: symbolic_t
      real(c_double) :: symmetry = -1, est_flops = -1, lnz = -1, unz = -1
      type(c_ptr) :: lnz_of = c_null_ptr
      integer(c_int) :: n = 0, nz = 0
      type(c_ptr) :: p = c_null_ptr, q = c_null_ptr, r = c_null_ptr
      integer(c_int) :: nzoff = 0, nblocks = 1, maxblock = 0, ordering = 2, do_btf = 0, structural_rank = -1
   end type symbolic_t

   !> klu_numeric of klu.h.
   type, bind(c) :: numeric_t
      integer(c_int) :: n = 0, nblocks = 1, lnz = 0, unz = 0, max_lnz_block = 0, max_unz_block = 0
      type(c_ptr) :: pnum = c_null_ptr, pinv = c_null_ptr, lip = c_null_ptr, uip = c_null_ptr, llen = c_null_ptr
      type(c_ptr) :: ulen = c_null_ptr, lubx = c_null_ptr, lusize = c_null_ptr, udiag = c_null_ptr, rs = c_null_ptr
      integer(c_size_t) :: worksize = 0
      type(c_ptr) :: work = c_null_ptr, xwork = c_null_ptr, iwork = c_null_ptr
      type(c_ptr) :: offp = c_null_ptr, offi = c_null_ptr, offx = c_null_ptr
      integer(c_int) :: nzoff = 0
   end type numeric_t

   !> A pattern and the factors of the last matrix of that pattern, none at first. It holds no memory of KLU: a copy
   !> has factors of its own.
   type :: klu_t
      type(pattern_t) :: pattern
      type(common_t) :: common
      integer(c_int), allocatable :: pivot_row(:), place_of(:)   !< (n) the row of each pivot; the inverse of that
      integer(c_int), allocatable :: l_at(:), l_length(:), u_at(:), u_length(:)   !< (n) columns in `lu`, and entries
      real(c_double), allocatable :: lu(:)        !< of each column its row numbers, two in one, and then its entries
      real(c_double), allocatable :: pivots(:)    !< (n)
      real(c_double), allocatable :: room(:)      !< (n)
      integer :: exchanges = 1                    !< the sign of both permutations together
   end type klu_t

   !> A klu_t as the routines of KLU take it.
   type :: view_t
      type(symbolic_t) :: symbolic
      type(numeric_t) :: numeric
      type(c_ptr) :: lu(1)
      integer(c_int) :: ends(2)
      real(c_double) :: unknown(1) = -1
   end type view_t

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
      !> Factors with pivoting.
      type(c_ptr) function klu_factor(ap, ai, ax, symbolic, common) bind(c)
         import :: c_int, c_ptr, common_t
         integer(c_int), intent(in) :: ap(*), ai(*)
         type(c_ptr), value :: ax, symbolic
         type(common_t), intent(inout) :: common
      end function klu_factor
      !> Factors with the pivots that `numeric` has.
      integer(c_int) function klu_refactor(ap, ai, ax, symbolic, numeric, common) bind(c)
         import :: c_int, c_ptr, common_t
         integer(c_int), intent(in) :: ap(*), ai(*)
         type(c_ptr), value :: ax, symbolic, numeric
         type(common_t), intent(inout) :: common
      end function klu_refactor
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
   !> The pivots of the matrix before serve, in less than half the time, while all multipliers are small: rounding
   !> errors are then as with pivots of its own. Rejected: without that limit. Factors depended on the way there, and
   !> nets of rods were lost at change points.
   subroutine factor(k, a, info)
      type(klu_t), intent(inout), target :: k
      real(wp), intent(in), target :: a(*)
      integer, intent(out) :: info
      type(view_t), target :: v
      type(c_ptr) :: numeric
      integer(c_int) :: done
      integer :: i, at
      logical :: serves

      call set_view(k, v)
      associate (p => k%pattern)
         if (allocated(k%lu)) then
            done = klu_refactor(p%first, p%row, c_loc(a), c_loc(v%symbolic), c_loc(v%numeric), k%common)
            serves = done /= 0 .and. k%common%status == 0
            do i = 1, size(k%pivots)
               at = k%l_at(i) + (k%l_length(i) + 1)/2
               serves = serves .and. all(abs(k%lu(at + 1:at + k%l_length(i))) <= max_multiplier)
            end do
            info = 0
            if (serves) return
         end if
         call set_common(k%common)
         numeric = klu_factor(p%first, p%row, c_loc(a), c_loc(v%symbolic), k%common)
      end associate
      info = merge(0, 1, c_associated(numeric))
      if (info > 0) return
      call take_factors(numeric, k)
      done = klu_free_numeric(numeric, k%common)
   end subroutine factor

   !> Copies the factors `numeric` that KLU has made.
   subroutine take_factors(numeric, k)
      type(c_ptr), intent(in) :: numeric
      type(klu_t), intent(inout) :: k
      type(numeric_t), pointer :: f
      type(c_ptr), pointer :: lu_of(:)
      integer(c_size_t), pointer :: length(:)
      real(c_double), pointer :: x(:)

      call c_f_pointer(numeric, f)
      k%pivot_row = integers(f%pnum)
      k%place_of = integers(f%pinv)
      k%l_at = integers(f%lip)
      k%l_length = integers(f%llen)
      k%u_at = integers(f%uip)
      k%u_length = integers(f%ulen)
      call c_f_pointer(f%udiag, x, [f%n])
      k%pivots = x
      call c_f_pointer(f%lubx, lu_of, [1])
      call c_f_pointer(f%lusize, length, [1])
      call c_f_pointer(lu_of(1), x, [length(1)])
      k%lu = x
      k%exchanges = sign_of(k%pivot_row)*sign_of(k%pattern%order)
      if (.not. allocated(k%room)) allocate (k%room(f%n))

   contains

      !> The integers at `at`, one for each unknown.
      function integers(at) result(list)
         type(c_ptr), intent(in) :: at
         integer(c_int) :: list(f%n)
         integer(c_int), pointer :: p(:)

         call c_f_pointer(at, p, [f%n])
         list = p
      end function integers
   end subroutine take_factors

   !> Makes `v` point to the pattern and, where there are some, the factors of `k`. Of one block nothing is off its
   !> diagonal.
   subroutine set_view(k, v)
      type(klu_t), intent(in), target :: k
      type(view_t), intent(out), target :: v

      v%ends = [0_c_int, order_of(k)]
      associate (s => v%symbolic, f => v%numeric)
         s%n = order_of(k)
         s%maxblock = s%n
         s%nz = size(k%pattern%row, kind=c_int)
         s%lnz_of = c_loc(v%unknown)
         s%p = c_loc(k%pattern%order)
         s%q = s%p
         s%r = c_loc(v%ends)
         if (.not. allocated(k%lu)) return
         f%n = s%n
         f%pnum = c_loc(k%pivot_row)
         f%pinv = c_loc(k%place_of)
         f%lip = c_loc(k%l_at)
         f%llen = c_loc(k%l_length)
         f%uip = c_loc(k%u_at)
         f%ulen = c_loc(k%u_length)
         v%lu = c_loc(k%lu)
         f%lubx = c_loc(v%lu)
         f%udiag = c_loc(k%pivots)
         f%xwork = c_loc(k%room)
      end associate
   end subroutine set_view

   !> `b` (n): the right-hand side, then the solution; with the matrix `transposed` or not.
   subroutine solve(k, b, transposed)
      type(klu_t), intent(inout), target :: k
      real(wp), intent(inout), target :: b(*)
      logical, intent(in) :: transposed
      type(view_t), target :: v
      integer(c_int) :: done

      call set_view(k, v)
      associate (symbolic => c_loc(v%symbolic), numeric => c_loc(v%numeric))
         if (transposed) done = klu_tsolve(symbolic, numeric, order_of(k), 1_c_int, c_loc(b), k%common)
         if (.not. transposed) done = klu_solve(symbolic, numeric, order_of(k), 1_c_int, c_loc(b), k%common)
      end associate
   end subroutine solve

   !> The sign of the determinant, from the factors.
   pure integer function determinant_sign(k) result(sign_of)
      type(klu_t), intent(in) :: k

      sign_of = merge(-k%exchanges, k%exchanges, mod(count(k%pivots < 0.0_c_double), 2) == 1)
   end function determinant_sign

   !> The order of the matrix.
   pure integer(c_int) function order_of(k)
      type(klu_t), intent(in) :: k

      order_of = size(k%pattern%first, kind=c_int) - 1_c_int
   end function order_of

   !> The sign of the permutation `p` of 0 to n - 1: a cycle of length c is c - 1 exchanges.
   pure integer function sign_of(p)
      integer(c_int), intent(in) :: p(:)
      logical :: is_seen(size(p))
      integer :: i, next

      sign_of = 1
      is_seen = .false.
      do i = 1, size(p)
         next = p(i) + 1
         do while (next /= i .and. .not. is_seen(i))
            is_seen(next) = .true.
            next = p(next) + 1
            sign_of = -sign_of
         end do
      end do
   end function sign_of
end module klu
