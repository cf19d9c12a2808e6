!> The matrix of a block: dense and square (DGESV), sparse (KLU), or with more rows than columns, in the sense of least
!> squares (DGEQRF). Dense matrices are factored in place.
!>
!> Each call takes one right-hand side: for several OpenBLAS starts threads, at ten times the cost of a small system.
module block_matrix
   use kinds, only: wp
   use lapack, only: gesv, getrs, geqrf, ormqr, trtrs, lacn2
   use klu, only: pattern_t, sparse_factors_t, klu_serves, factor, solve, determinant_sign, release
   implicit none
   private
   public :: matrix_layout_t, is_sparse_better, entries_of, solve_first, solve_again, pivot_range, inverse_norm, &
      work_length
   public :: spread_by_inverse, nearby_t, stay_near, solve_nearby, sparse_factors_t, release

   !> The layout of a matrix of `rows` rows and `n` columns. `pattern` = 0: dense, by columns. Otherwise sparse and
   !> square: `pattern` is the number of its pattern, `entries` counts its entries, which are in the order of the
   !> pattern.
   type :: matrix_layout_t
      integer :: rows = 0, n = 0, pattern = 0, entries = 0
   end type matrix_layout_t

   !> From this many unknowns on KLU is not slower than DGESV: measured on lattices with reference LAPACK and OpenBLAS.
   integer, parameter :: min_sparse = merge(12, huge(1), klu_serves)
   !> Columns that DGEQRF takes together: the block size of reference LAPACK.
   integer, parameter :: panel = 32

   !> The matrix A of a block of two unknowns so near another matrix A0 that its equations are solved with the inverse
   !> of A0. In steps of some degrees this saves a second DGESV, a sixth of the step.
   type :: nearby_t
      real(wp) :: a(4) = 0.0_wp                  !< A, by columns
      real(wp) :: factors(4) = 0.0_wp            !< of A0, kept here while A is assembled in their place
      real(wp) :: inverse(4) = 0.0_wp            !< of A0, by columns
      real(wp) :: distance = 0.0_wp              !< |A0^-1 (A - A0)| at most, maximum norm; 0: not in use
   end type nearby_t

   !> With a larger `distance` a matrix is factored itself: each pass of refinement gains its four digits.
   real(wp), parameter :: max_distance = 1.0e-4_wp
   !> A relative error below this is negligible compared with the error of a factorization.
   real(wp), parameter :: negligible_error = 0.125_wp*epsilon(1.0_wp)

contains

   !> Tells whether a square matrix is solved faster as sparse. With many entries in a row, most zeros fill up during
   !> the elimination.
   pure logical function is_sparse_better(n, entries)
      integer, intent(in) :: n               !< rows of the matrix
      integer, intent(in) :: entries         !< elements of the matrix that are not always zero

      is_sparse_better = n >= min_sparse .and. entries/max(n, 1) < 8 + n/50
   end function is_sparse_better

   !> Counts the numbers that a matrix takes in memory.
   elemental integer function entries_of(shape)
      type(matrix_layout_t), intent(in) :: shape   !< of the matrix

      entries_of = shape%entries
      if (shape%pattern == 0) entries_of = shape%rows*shape%n
   end function entries_of

   !> Counts the numbers that the workspace of `solve_first` takes.
   elemental integer function work_length(shape)
      type(matrix_layout_t), intent(in) :: shape   !< of the matrix

      work_length = merge(4*shape%n, shape%n*(panel + 4) + shape%rows, shape%rows == shape%n)
   end function work_length

   !> Factors a matrix and solves its equations, in the sense of least squares if there are more rows than unknowns. The
   !> factors of a sparse matrix stay in `sparse` until `release`.
   subroutine solve_first(shape, a, pivots, work, right, info, patterns, sparse)
      type(matrix_layout_t), intent(in) :: shape   !< of the matrix
      real(wp), intent(inout) :: a(*)        !< (entries_of) the matrix; a dense one becomes its factors
      real(wp), intent(inout) :: work(*)     !< (work_length) kept for the calls that follow
      real(wp), intent(inout) :: right(*)    !< (rows) the right-hand side; its first n numbers become the solution
      integer, intent(out) :: pivots(*)      !< (n) kept for the calls that follow
      integer, intent(out) :: info           !< 0; above 0: exactly singular, `right` is no solution
      type(pattern_t), intent(in), optional :: patterns(:)   !< (patterns) of a sparse matrix: `shape` has the number
      type(sparse_factors_t), intent(inout), optional :: sparse   !< of a sparse matrix: its factors
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

   !> Solves equations with the factors of their matrix for another right-hand side.
   subroutine solve_again(shape, a, pivots, work, right, sparse)
      type(matrix_layout_t), intent(in) :: shape   !< of the matrix
      real(wp), intent(in) :: a(*)           !< (entries_of) the factors of a dense matrix
      integer, intent(in) :: pivots(*)       !< (n) as `solve_first` left them
      real(wp), intent(inout) :: work(*)     !< (work_length) as `solve_first` left it
      real(wp), intent(inout) :: right(*)    !< (rows) the right-hand side; its first n numbers become the solution
      type(sparse_factors_t), intent(inout), optional :: sparse   !< of a sparse matrix: its factors
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

   !> Finds the sizes of the smallest and the largest pivot, and the sign of the determinant, from the factors of a
   !> matrix. For a sparse matrix the sizes are 0 and the largest |entry|: KLU may have chosen other pivots than LAPACK.
   subroutine pivot_range(shape, a, pivots, least, largest, sign_of, sparse)
      type(matrix_layout_t), intent(in) :: shape   !< of the matrix
      real(wp), intent(in) :: a(*)           !< (entries_of) the factors of a dense matrix; of a sparse one, its entries
      integer, intent(in) :: pivots(*)       !< (n) as `solve_first` left them
      real(wp), intent(out) :: least         !< size of the smallest pivot; 0 if sparse, huge if n = 0
      real(wp), intent(out) :: largest       !< size of the largest pivot; if sparse, largest |entry|
      integer, intent(out) :: sign_of        !< 1 or -1; 1 if rows are more than unknowns
      type(sparse_factors_t), intent(in), optional :: sparse   !< of a sparse matrix: its factors
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

   !> Gives |A^-1| in the maximum norm, from the factors of A: exact for up to two equations, else an estimate (DLACN2;
   !> Higham, ACM TOMS 14 (1988) 381). With more rows than unknowns A is the triangle of its QR factors. An estimate
   !> that is no finite number becomes huge(norm).
   real(wp) function inverse_norm(shape, a, pivots, work, iwork, sparse) result(norm)
      type(matrix_layout_t), intent(in) :: shape   !< of the matrix
      real(wp), intent(in) :: a(*)           !< (entries_of) the factors of a dense matrix
      integer, intent(in) :: pivots(*)       !< (n) as `solve_first` left them
      real(wp), intent(inout) :: work(*)     !< (work_length) the part that `solve_again` needs stays
      integer, intent(inout) :: iwork(*)     !< (n) scratch
      type(sparse_factors_t), intent(inout), optional :: sparse   !< of a sparse matrix: its factors
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

            ! DLACN2 estimates the largest column sum. Row sums of the inverse are column sums of its transpose.
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

   !> Bounds the unknowns by |A^-1| times bounds of the right-hand side, from the factors of A, column by column. With
   !> more rows than unknowns A^-1 is the inverse in the sense of least squares.
   subroutine spread_by_inverse(shape, a, pivots, work, bounds, spread, sparse)
      type(matrix_layout_t), intent(in) :: shape   !< of the matrix
      real(wp), intent(in) :: a(*)           !< (entries_of) the factors of a dense matrix
      integer, intent(in) :: pivots(*)       !< (n) as `solve_first` left them
      real(wp), intent(inout) :: work(*)     !< (work_length) as `solve_first` left it
      real(wp), intent(in) :: bounds(:)      !< (rows) bounds of the right-hand sides, in their units
      real(wp), intent(out) :: spread(:)     !< (n) bounds of the unknowns, in their units
      type(sparse_factors_t), intent(inout), optional :: sparse   !< of a sparse matrix: its factors
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

   !> Prepares the solution of equations whose matrix is near a factored matrix. If both differ too much, the near
   !> matrix must be factored itself.
   pure subroutine stay_near(shape, a, pivots, change, near)
      type(matrix_layout_t), intent(in) :: shape     !< with two rows and two unknowns; otherwise nothing is done
      real(wp), intent(in) :: a(*)           !< (4) factors of the factored matrix, by columns
      real(wp), intent(in) :: change         !< bound of the change since the last call (maximum norm)
      integer, intent(in) :: pivots(*)       !< (2) as `solve_first` left them
      type(nearby_t), intent(inout) :: near  !< gets its components but `a`; distance 0: not in use

      if (shape%n /= 2 .or. shape%rows /= 2) return
      near%factors = a(:4)
      near%inverse = [a(4) + a(2)*a(3), -a(1)*a(2), -a(3), a(1)]/(a(1)*a(4))
      if (pivots(1) == 2) near%inverse = near%inverse([3, 4, 1, 2])
      associate (v => near%inverse)
         near%distance = near%distance + change*max(abs(v(1)) + abs(v(3)), abs(v(2)) + abs(v(4)))
      end associate
      if (.not. near%distance <= max_distance) near%distance = 0.0_wp
   end subroutine stay_near

   !> Solves the equations of a nearby matrix with the inverse of the factored matrix, by iterative refinement (Higham,
   !> Accuracy and Stability of Numerical Algorithms, 2002, ch. 12). Each pass multiplies the relative error by the
   !> distance of the two matrices, until a factorization of the nearby matrix would have as much error.
   pure subroutine solve_nearby(near, right)
      type(nearby_t), intent(in) :: near     !< the matrix, with a distance above 0
      real(wp), intent(inout) :: right(2)    !< the right-hand side, then the solution
      real(wp) :: x(2), error

      x = times(near%inverse, right)
      error = near%distance
      do while (error > negligible_error)
         x = x + times(near%inverse, right - times(near%a, x))
         error = error*near%distance
      end do
      right = x

   contains

      !> Multiplies a matrix by a vector (2).
      pure function times(a, vector) result(y)
         real(wp), intent(in) :: a(4)        !< the matrix, by columns
         real(wp), intent(in) :: vector(2)   !< in any unit
         real(wp) :: y(2)

         y(1) = a(1)*vector(1) + a(3)*vector(2)
         y(2) = a(2)*vector(1) + a(4)*vector(2)
      end function times
   end subroutine solve_nearby
end module block_matrix
