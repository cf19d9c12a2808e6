!> The matrix of a block: dense and square (DGESV), sparse (KLU), or with more rows than columns, in the sense
!> of least squares (DGEQRF). Dense ones are factored where they stand.
!>
!> One right-hand side a call: for more OpenBLAS starts threads, at ten times the cost of a small system.
module block_matrix
   use kinds, only: wp
   use lapack, only: gesv, getrs, geqrf, ormqr, trtrs, lacn2
   use klu, only: pattern_t, sparse_factors_t, klu_serves, factor, solve, determinant_sign, release
   implicit none
   private
   public :: shape_t, is_sparse_better, entries_of, solve_first, solve_again, pivot_range, inverse_norm, work_length
   public :: spread_by_inverse, nearby_t, stay_near, solve_nearby, sparse_factors_t, release

   !> `pattern` = 0: dense, by columns. Otherwise sparse and square: the number of its pattern, and its entries, in the
   !> order of the pattern.
   type :: shape_t
      integer :: rows = 0, n = 0, pattern = 0, entries = 0
   end type shape_t

   !> From this many unknowns on KLU is not slower than DGESV (lattices, reference LAPACK and OpenBLAS).
   integer, parameter :: min_sparse = merge(12, huge(1), klu_serves)
   !> Columns that DGEQRF takes together.
   integer, parameter :: panel = 32

   !> The matrix of a block of two unknowns beside one that is factored: so near that its equations are solved by the
   !> factors there are. In steps of some degrees that saves a second DGESV, a sixth of the step.
   type :: nearby_t
      real(wp) :: a(4) = 0.0_wp                  !< the matrix, by columns
      real(wp) :: factors(4) = 0.0_wp            !< of the other, while the matrix is assembled
      real(wp) :: inverse(4) = 0.0_wp            !< of the other, by columns
      real(wp) :: distance = 0.0_wp              !< |A0^-1 (A - A0)| at most, A0 being factored; 0: `a` is not in use
   end type nearby_t

   !> A matrix that differs from the factored one by more than this part is factored itself.
   real(wp), parameter :: max_distance = 1.0e-4_wp
   !> A relative error below this is lost in that of a factorization.
   real(wp), parameter :: lost = 0.125_wp*epsilon(1.0_wp)

contains

   !> A square matrix of `n` rows with so many entries is best sparse. Where many stand in a row, most of the others
   !> fill up.
   pure logical function is_sparse_better(n, entries)
      integer, intent(in) :: n, entries

      is_sparse_better = n >= min_sparse .and. entries/max(n, 1) < 8 + n/50
   end function is_sparse_better

   !> Numbers that the matrix takes.
   elemental integer function entries_of(shape)
      type(shape_t), intent(in) :: shape

      entries_of = shape%entries
      if (shape%pattern == 0) entries_of = shape%rows*shape%n
   end function entries_of

   !> Numbers that `work` takes below.
   elemental integer function work_length(shape)
      type(shape_t), intent(in) :: shape

      work_length = merge(4*shape%n, shape%n*(panel + 4) + shape%rows, shape%rows == shape%n)
   end function work_length

   !> Solves `a` x = `right` (rows); the first n of `right` become x, `a` its factors where it is dense. `info` > 0:
   !> exactly singular. `pivots` (n), `work` (work_length): to be kept for the calls that follow. A sparse matrix is one
   !> of the `patterns`; its factors are kept in `sparse`, until `release`.
   subroutine solve_first(shape, a, pivots, work, right, info, patterns, sparse)
      type(shape_t), intent(in) :: shape
      real(wp), intent(inout) :: a(*), work(*), right(*)
      integer, intent(out) :: pivots(*), info
      type(pattern_t), intent(in), optional :: patterns(:)
      type(sparse_factors_t), intent(inout), optional :: sparse
      integer :: i

      info = 0
      if (shape%pattern == 0 .and. shape%rows == shape%n .and. shape%n > 1) then
         call gesv(shape%n, 1, a, shape%n, pivots, right, shape%n, info)
      else if (shape%pattern > 0) then
         call factor(patterns(shape%pattern), a, sparse, info)
         if (info == 0) call solve(sparse, right, .false.)
      else if (shape%rows > shape%n .and. shape%n > 0) then
         call geqrf(shape%rows, shape%n, a, shape%rows, work, work(shape%n + 1), shape%n*panel, info)
         do i = shape%n, 1, -1
            pivots(i) = i
            if (abs(a((i - 1)*shape%rows + i)) <= 0.0_wp) info = i
         end do
         if (info == 0) call solve_again(shape, a, pivots, work, right)
      else if (shape%n == 1) then
         ! One equation needs no DGESV, which takes long.
         if (abs(a(1)) <= 0.0_wp) info = 1
         if (info == 0) right(1) = right(1)/a(1)
         pivots(1) = 1
      end if
   end subroutine solve_first

   !> Solves for another right-hand side, from the factors.
   subroutine solve_again(shape, a, pivots, work, right, sparse)
      type(shape_t), intent(in) :: shape
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*), right(*)
      type(sparse_factors_t), intent(inout), optional :: sparse
      integer :: info

      if (shape%n == 2 .and. shape%rows == 2) then
         ! DGETRS in the order of its operations: the call itself takes many times as long.
         if (pivots(1) == 2) right(:2) = [right(2), right(1)]
         right(2) = right(2) - right(1)*a(2)
         ! DTRSM leaves a zero as it is, with its sign.
         if (abs(right(2)) > 0.0_wp) right(2) = right(2)/a(4)
         right(1) = right(1) - right(2)*a(3)
         if (abs(right(1)) > 0.0_wp) right(1) = right(1)/a(1)
      else if (shape%pattern > 0) then
         call solve(sparse, right, .false.)
      else if (shape%rows > shape%n .and. shape%n > 0) then
         call ormqr('L', 'T', shape%rows, 1, shape%n, a, shape%rows, work, right, shape%rows, work(shape%n + 1), &
            shape%n*panel, info)
         call trtrs('U', 'N', 'N', shape%n, 1, a, shape%rows, right, shape%rows, info)
      else if (shape%n == 1) then
         right(1) = right(1)/a(1)
      else if (shape%n > 1) then
         call getrs('N', shape%n, 1, a, shape%n, pivots, right, shape%n, info)
      end if
   end subroutine solve_again

   !> From the factors: the smallest and the largest pivot, and the sign of the determinant (1 where there is none).
   !> The pivots of a sparse matrix can be another's choice: 0 and the largest entry are in their place.
   subroutine pivot_range(shape, a, pivots, least, largest, sign_of, sparse)
      type(shape_t), intent(in) :: shape
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(out) :: least, largest
      integer, intent(out) :: sign_of
      type(sparse_factors_t), intent(in), optional :: sparse
      real(wp) :: pivot
      integer :: i

      sign_of = 1
      if (shape%pattern > 0) then
         least = 0.0_wp
         largest = maxval(abs(a(:shape%entries)))
         sign_of = determinant_sign(sparse)
         return
      end if
      least = huge(least)
      largest = 0.0_wp
      do i = 1, shape%n
         pivot = a(i + (i - 1)*shape%rows)
         least = min(least, abs(pivot))
         largest = max(largest, abs(pivot))
         if ((pivot < 0.0_wp) .neqv. (pivots(i) /= i)) sign_of = -sign_of
      end do
      if (shape%rows > shape%n) sign_of = 1
   end subroutine pivot_range

   !> |A^-1| in the maximum norm, from the factors: exact for n <= 2, an estimate otherwise (DLACN2); `iwork` (n).
   !> `work` keeps what the next solve_again needs.
   real(wp) function inverse_norm(shape, a, pivots, work, iwork, sparse) result(norm)
      type(shape_t), intent(in) :: shape
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*)
      integer, intent(inout) :: iwork(*)
      type(sparse_factors_t), intent(inout), optional :: sparse
      integer :: asks, state(3), info

      if (shape%rows == 1) then
         norm = 1.0_wp/abs(a(1))
         return
      else if (shape%rows == 2 .and. shape%n == 2) then
         ! By l = a(2) and u = a(1), a(3), a(4): columns are swapped by the pivots, row sums are not.
         norm = max(abs(a(4) + a(3)*a(2)) + abs(a(3)), abs(a(1)*a(2)) + abs(a(1)))/abs(a(1)*a(4))
         return
      end if
      asks = 0
      norm = 0.0_wp
      state = 0
      do
         associate (x => work(2*shape%n + 1:3*shape%n))
            call lacn2(shape%n, work(shape%n + 1:2*shape%n), x, iwork, norm, asks, state)
            if (asks == 0) exit
            ! DLACN2 estimates the largest column sum: that of the transposed inverse.
            associate (side => merge('T', 'N', asks == 1))
               if (shape%rows > shape%n) then
                  call trtrs('U', side, 'N', shape%n, 1, a, shape%rows, x, shape%n, info)
               else if (shape%pattern == 0) then
                  call getrs(side, shape%n, 1, a, shape%n, pivots, x, shape%n, info)
               else
                  call solve(sparse, x, transposed=asks == 1)
               end if
            end associate
         end associate
      end do
      if (.not. norm <= huge(norm)) norm = huge(norm)
   end function inverse_norm

   !> |A^-1| bounds for the vector `bounds` (rows), as `spread` (n), from the factors, column by column.
   subroutine spread_by_inverse(shape, a, pivots, work, bounds, spread, sparse)
      type(shape_t), intent(in) :: shape
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*)
      real(wp), intent(in) :: bounds(:)
      real(wp), intent(out) :: spread(:)
      type(sparse_factors_t), intent(inout), optional :: sparse
      real(wp) :: column(shape%rows)
      integer :: j

      spread = 0.0_wp
      do j = 1, shape%rows
         column = 0.0_wp
         column(j) = bounds(j)
         call solve_again(shape, a, pivots, work, column, sparse)
         spread = spread + abs(column(:shape%n))
      end do
   end subroutine spread_by_inverse

   !> The matrix of `shape` whose factors are in `a` changes by `change` at most, or once more: `near` can be it,
   !> unless it is better factored itself.
   pure subroutine stay_near(shape, a, pivots, change, near)
      type(shape_t), intent(in) :: shape
      real(wp), intent(in) :: a(*), change
      integer, intent(in) :: pivots(*)
      type(nearby_t), intent(inout) :: near

      if (shape%n /= 2 .or. shape%rows /= 2) return
      near%factors = a(:4)
      near%inverse = [a(4) + a(2)*a(3), -a(1)*a(2), -a(3), a(1)]/(a(1)*a(4))
      if (pivots(1) == 2) near%inverse = near%inverse([3, 4, 1, 2])
      associate (v => near%inverse)
         near%distance = near%distance + change*max(abs(v(1)) + abs(v(3)), abs(v(2)) + abs(v(4)))
      end associate
      if (.not. near%distance <= max_distance) near%distance = 0.0_wp
   end subroutine stay_near

   !> Solves `near` x = `right` (2) with the inverse of the matrix beside it, by iterative refinement (Higham, Accuracy
   !> and Stability of Numerical Algorithms, 2002, ch. 12): each pass takes the error down by the distance of the two,
   !> to what a factorization of its own would leave.
   pure subroutine solve_nearby(near, right)
      type(nearby_t), intent(in) :: near
      real(wp), intent(inout) :: right(2)
      real(wp) :: x(2), error

      x = times(near%inverse, right)
      error = near%distance
      do while (error > lost)
         x = x + times(near%inverse, right - times(near%a, x))
         error = error*near%distance
      end do
      right = x

   contains

      !> `a` (4, by columns) times `vector`.
      pure function times(a, vector) result(y)
         real(wp), intent(in) :: a(4), vector(2)
         real(wp) :: y(2)

         y(1) = a(1)*vector(1) + a(3)*vector(2)
         y(2) = a(2)*vector(1) + a(4)*vector(2)
      end function times
   end subroutine solve_nearby
end module block_matrix
