!> The matrix of a block: dense and square (DGESV), sparse (KLU), or with more rows than columns, in the sense
!> of least squares (DGEQRF). Dense ones are factored where they stand.
!>
!> One right-hand side a call: for more OpenBLAS starts threads, at ten times the cost of a small system.
module block_matrix
   use kinds, only: wp
   use lapack, only: gesv, getrs, geqrf, ormqr, trtrs, lacn2
   use klu, only: klu_t, klu_serves, factor, solve, determinant_sign
   implicit none
   private
   public :: shape_t, is_sparse_better, entries_of, solve_first, solve_again, pivot_range, inverse_norm, work_length
   public :: inverse_norm_of_two, spread_by_inverse

   !> `pattern` = 0: dense, by columns. Otherwise sparse and square: the number of its pattern, and its entries, in the
   !> order of the pattern.
   type :: shape_t
      integer :: rows = 0, n = 0, pattern = 0, entries = 0
   end type shape_t

   !> From this many unknowns on KLU is not slower than DGESV (lattices, reference LAPACK and OpenBLAS).
   integer, parameter :: min_sparse = merge(12, huge(1), klu_serves)
   !> Columns that DGEQRF takes together.
   integer, parameter :: panel = 32

contains

   !> A square matrix of `n` rows with so many entries is best sparse. Where many stand in a row, most of the others
   !> fill up.
   pure logical function is_sparse_better(n, entries)
      integer, intent(in) :: n, entries

      is_sparse_better = n >= min_sparse .and. entries/max(n, 1) < 8 + n/50
   end function is_sparse_better

   !> Numbers that the matrix takes.
   elemental integer function entries_of(s)
      type(shape_t), intent(in) :: s

      entries_of = s%entries
      if (s%pattern == 0) entries_of = s%rows*s%n
   end function entries_of

   !> Numbers that `work` takes below.
   elemental integer function work_length(s)
      type(shape_t), intent(in) :: s

      work_length = merge(4*s%n, s%n*(panel + 4) + s%rows, s%rows == s%n)
   end function work_length

   !> Solves `a` x = `b` (rows); the first n of `b` become x, `a` its factors where it is dense. `info` > 0: exactly
   !> singular. `pivots` (n), `work` (work_length), and `k`, of its pattern, where it is sparse: to be kept for the
   !> calls that follow.
   subroutine solve_first(s, a, pivots, work, b, info, k)
      type(shape_t), intent(in) :: s
      real(wp), intent(inout) :: a(*), work(*), b(*)
      integer, intent(out) :: pivots(*), info
      type(klu_t), intent(inout), optional :: k
      integer :: i

      info = 0
      if (s%pattern == 0 .and. s%rows == s%n .and. s%n > 1) then
         call gesv(s%n, 1, a, s%n, pivots, b, s%n, info)
      else if (s%pattern > 0) then
         call factor(k, a, info)
         if (info == 0) call solve(k, b, .false.)
      else if (s%rows > s%n .and. s%n > 0) then
         call geqrf(s%rows, s%n, a, s%rows, work, work(s%n + 1), s%n*panel, info)
         do i = s%n, 1, -1
            pivots(i) = i
            if (abs(a((i - 1)*s%rows + i)) <= 0.0_wp) info = i
         end do
         if (info == 0) call solve_again(s, a, pivots, work, b)
      else if (s%n == 1) then
         ! One equation needs no DGESV, which takes long.
         if (abs(a(1)) <= 0.0_wp) info = 1
         if (info == 0) b(1) = b(1)/a(1)
         pivots(1) = 1
      end if
   end subroutine solve_first

   !> Solves for another right-hand side, from the factors.
   subroutine solve_again(s, a, pivots, work, b, k)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*), b(*)
      type(klu_t), intent(inout), optional :: k
      integer :: info

      if (s%n == 2 .and. s%rows == 2) then
         ! DGETRS in the order of its operations: the call itself takes many times as long.
         if (pivots(1) == 2) b(:2) = [b(2), b(1)]
         b(2) = b(2) - b(1)*a(2)
         ! DTRSM leaves a zero as it is, with its sign.
         if (abs(b(2)) > 0.0_wp) b(2) = b(2)/a(4)
         b(1) = b(1) - b(2)*a(3)
         if (abs(b(1)) > 0.0_wp) b(1) = b(1)/a(1)
      else if (s%pattern > 0) then
         call solve(k, b, .false.)
      else if (s%rows > s%n .and. s%n > 0) then
         call ormqr('L', 'T', s%rows, 1, s%n, a, s%rows, work, b, s%rows, work(s%n + 1), s%n*panel, info)
         call trtrs('U', 'N', 'N', s%n, 1, a, s%rows, b, s%rows, info)
      else if (s%n == 1) then
         b(1) = b(1)/a(1)
      else if (s%n > 1) then
         call getrs('N', s%n, 1, a, s%n, pivots, b, s%n, info)
      end if
   end subroutine solve_again

   !> From the factors: the smallest and the largest pivot, and the sign of the determinant (1 where there is none).
   !> The pivots of a sparse matrix can be another's choice: 0 and the largest entry are in their place.
   subroutine pivot_range(s, a, pivots, least, largest, sign_of, k)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(out) :: least, largest
      integer, intent(out) :: sign_of
      type(klu_t), intent(in), optional :: k
      real(wp) :: pivot
      integer :: i

      sign_of = 1
      if (s%pattern > 0) then
         least = 0.0_wp
         largest = maxval(abs(a(:s%entries)))
         sign_of = determinant_sign(k)
         return
      end if
      least = huge(least)
      largest = 0.0_wp
      do i = 1, s%n
         pivot = a(i + (i - 1)*s%rows)
         least = min(least, abs(pivot))
         largest = max(largest, abs(pivot))
         if ((pivot < 0.0_wp) .neqv. (pivots(i) /= i)) sign_of = -sign_of
      end do
      if (s%rows > s%n) sign_of = 1
   end subroutine pivot_range

   !> |A^-1| in the maximum norm, from the factors: exact for n <= 2, an estimate otherwise (DLACN2); `iwork` (n).
   !> `work` keeps what the next solve_again needs.
   real(wp) function inverse_norm(s, a, pivots, work, iwork, k) result(norm)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*)
      integer, intent(inout) :: iwork(*)
      type(klu_t), intent(inout), optional :: k
      integer :: asks, state(3), info

      if (s%rows == 1) then
         norm = 1.0_wp/abs(a(1))
         return
      else if (s%rows == 2 .and. s%n == 2) then
         norm = inverse_norm_of_two(a)
         return
      end if
      asks = 0
      norm = 0.0_wp
      state = 0
      do
         associate (x => work(2*s%n + 1:3*s%n))
            call lacn2(s%n, work(s%n + 1:2*s%n), x, iwork, norm, asks, state)
            if (asks == 0) exit
            ! DLACN2 estimates the largest column sum: that of the transposed inverse.
            associate (side => merge('T', 'N', asks == 1))
               if (s%rows > s%n) then
                  call trtrs('U', side, 'N', s%n, 1, a, s%rows, x, s%n, info)
               else if (s%pattern == 0) then
                  call getrs(side, s%n, 1, a, s%n, pivots, x, s%n, info)
               else
                  call solve(k, x, transposed=asks == 1)
               end if
            end associate
         end associate
      end do
      if (.not. norm <= huge(norm)) norm = huge(norm)
   end function inverse_norm

   !> Computes that norm of the inverse for two unknowns, from the factors l = `a`(2), u = a(1), a(3), a(4): columns
   !> are swapped by the pivots, row sums are not.
   pure real(wp) function inverse_norm_of_two(a) result(norm)
      real(wp), intent(in) :: a(4)

      norm = max(abs(a(4) + a(3)*a(2)) + abs(a(3)), abs(a(1)*a(2)) + abs(a(1)))/abs(a(1)*a(4))
   end function inverse_norm_of_two

   !> |A^-1| h for the vector `h` (rows), as `spread` (n), from the factors, column by column.
   subroutine spread_by_inverse(s, a, pivots, work, h, spread, k)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*)
      real(wp), intent(in) :: h(:)
      real(wp), intent(out) :: spread(:)
      type(klu_t), intent(inout), optional :: k
      real(wp) :: column(s%rows)
      integer :: j

      spread = 0.0_wp
      do j = 1, s%rows
         column = 0.0_wp
         column(j) = h(j)
         call solve_again(s, a, pivots, work, column, k)
         spread = spread + abs(column(:s%n))
      end do
   end subroutine spread_by_inverse
end module block_matrix
