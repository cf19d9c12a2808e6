!> Level 3. The matrix of a block, factored where it stands: dense and square (DGESV), a band (DGBSV), or with more rows
!> than columns, in the sense of least squares (DGEQRF).
!>
!> One right-hand side a call: for more OpenBLAS starts threads, at ten times the cost of a small system.
module block_matrix
   use kinds, only: wp
   use lapack, only: dgesv, dgetrs, dgecon, dgbsv, dgbtrs, dgbcon, dgeqrf, dormqr, dtrtrs, dtrcon
   implicit none
   private
   public :: shape_t, entries_of, solve_first, solve_again, pivot_range, inverse_norm, work_length

   !> `below` < 0: dense; otherwise a band with `below` and `above` diagonals beside the main one, stored as DGBSV
   !> has it. More rows than columns: dense.
   type :: shape_t
      integer :: rows = 0, n = 0, below = -1, above = -1
   end type shape_t

   !> Columns that DGEQRF takes together.
   integer, parameter :: panel = 32

contains

   !> Numbers that the matrix takes.
   pure integer function entries_of(s)
      type(shape_t), intent(in) :: s

      entries_of = s%n*merge(s%rows, 2*s%below + s%above + 1, s%below < 0)
   end function entries_of

   !> Numbers that `work` takes below.
   pure integer function work_length(s)
      type(shape_t), intent(in) :: s

      work_length = merge(4*s%n, s%n*(panel + 4) + s%rows, s%rows == s%n)
   end function work_length

   !> Solves `a` x = `b` (rows); the first n of `b` become x, `a` its factors. `info` > 0: exactly singular.
   !> `pivots` (n), `work` (work_length): to be kept for the calls that follow.
   subroutine solve_first(s, a, pivots, work, b, info)
      type(shape_t), intent(in) :: s
      real(wp), intent(inout) :: a(*), work(*), b(*)
      integer, intent(out) :: pivots(*), info
      integer :: k

      info = 0
      if (s%n == 0) return
      if (s%rows > s%n) then
         call dgeqrf(s%rows, s%n, a, s%rows, work, work(s%n + 1), s%n*panel, info)
         do k = s%n, 1, -1
            pivots(k) = k
            if (abs(a((k - 1)*s%rows + k)) <= 0.0_wp) info = k
         end do
         if (info == 0) call solve_again(s, a, pivots, work, b)
      else if (s%n == 1) then
         if (abs(a(1)) <= 0.0_wp) info = 1
         pivots(1) = 1
         if (info == 0) b(1) = b(1)/a(1)
      else if (s%below < 0) then
         call dgesv(s%n, 1, a, s%n, pivots, b, s%n, info)
      else
         call dgbsv(s%n, s%below, s%above, 1, a, 2*s%below + s%above + 1, pivots, b, s%n, info)
      end if
   end subroutine solve_first

   !> The same for another right-hand side, from the factors.
   subroutine solve_again(s, a, pivots, work, b)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*), b(*)
      integer :: info

      if (s%n == 0) return
      if (s%rows > s%n) then
         call dormqr('L', 'T', s%rows, 1, s%n, a, s%rows, work, b, s%rows, work(s%n + 1), s%n*panel, info)
         call dtrtrs('U', 'N', 'N', s%n, 1, a, s%rows, b, s%rows, info)
      else if (s%n == 1) then
         b(1) = b(1)/a(1)
      else if (s%below < 0) then
         call dgetrs('N', s%n, 1, a, s%n, pivots, b, s%n, info)
      else
         call dgbtrs('N', s%n, s%below, s%above, 1, a, 2*s%below + s%above + 1, pivots, b, s%n, info)
      end if
   end subroutine solve_again

   !> From the factors: the smallest and the largest pivot, and the sign of the determinant (1 where there is none).
   pure subroutine pivot_range(s, a, pivots, least, largest, sign_of)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(out) :: least, largest
      integer, intent(out) :: sign_of
      real(wp) :: pivot
      integer :: k, at, stride

      at = merge(1, s%below + s%above + 1, s%below < 0)
      stride = merge(s%rows, 2*s%below + s%above, s%below < 0) + 1
      least = huge(least)
      largest = 0.0_wp
      sign_of = 1
      do k = 1, s%n
         pivot = a(at + (k - 1)*stride)
         least = min(least, abs(pivot))
         largest = max(largest, abs(pivot))
         if ((pivot < 0.0_wp) .neqv. (pivots(k) /= k)) sign_of = -sign_of
      end do
      if (s%rows > s%n) sign_of = 1
   end subroutine pivot_range

   !> |A^-1| in the maximum norm, from the factors: exact for n <= 2, an estimate otherwise (DGECON, DGBCON, DTRCON);
   !> `iwork` (n). `work` keeps what the next solve_again needs.
   real(wp) function inverse_norm(s, a, pivots, work, iwork)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*)
      integer, intent(in) :: pivots(*)
      real(wp), intent(inout) :: work(*)
      integer, intent(inout) :: iwork(*)
      real(wp) :: rcond
      integer :: info

      rcond = 0.0_wp
      if (s%rows > s%n) then
         call dtrcon('I', 'U', 'N', s%n, a, s%rows, rcond, work(s%n + 1), iwork, info)
         inverse_norm = 1.0_wp/(max(rcond, tiny(rcond))*triangle_norm(s, a))
      else if (s%n == 1) then
         inverse_norm = 1.0_wp/abs(a(1))
      else if (s%n == 2) then
         ! The factors are l = a(2), u = a(1), a(3), a(4); columns are swapped by the pivots, row sums are not.
         inverse_norm = max(abs(a(4) + a(3)*a(2)) + abs(a(3)), abs(a(1)*a(2)) + abs(a(1)))/abs(a(1)*a(4))
      else
         if (s%below < 0) then
            call dgecon('I', s%n, a, s%n, 1.0_wp, rcond, work, iwork, info)
         else
            call dgbcon('I', s%n, s%below, s%above, a, 2*s%below + s%above + 1, pivots, 1.0_wp, rcond, work, &
               iwork, info)
         end if
         inverse_norm = 1.0_wp/max(rcond, tiny(rcond))
      end if
   end function inverse_norm

   !> The largest row sum of R.
   pure real(wp) function triangle_norm(s, a) result(norm)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(s%rows, *)
      integer :: k

      norm = tiny(norm)
      do k = 1, s%n
         norm = max(norm, sum(abs(a(k, k:s%n))))
      end do
   end function triangle_norm
end module block_matrix
