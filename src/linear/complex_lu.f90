!> Small systems of linear equations with complex coefficients, and null spaces. Written out for all kinds of reals: at
!> the sizes of `assemblies`, up to 14 unknowns, the calls of ZGESV take as long as its work, and the paths followed
!> there are the same with every LAPACK.
module complex_lu
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   implicit none
   private
   public :: factor_complex, solve_complex, find_null_space

contains

   !> LU factors of `a` (n, n) in its place, with partial pivoting; `pivots` (n): the rows exchanged. `is_singular`: a
   !> pivot is zero.
   pure subroutine factor_complex(n, a, pivots, is_singular)
      integer, intent(in) :: n
      complex(dp), intent(inout) :: a(n, n)
      integer, intent(out) :: pivots(n)
      logical, intent(out) :: is_singular
      complex(dp) :: one
      real(dp) :: largest
      integer :: i, j, k

      is_singular = .false.
      do k = 1, n
         largest = 0.0_dp
         pivots(k) = k
         do i = k, n
            if (size_of(a(i, k)) <= largest) cycle
            largest = size_of(a(i, k))
            pivots(k) = i
         end do
         is_singular = .not. largest > sqrt(tiny(1.0_dp))
         if (is_singular) return
         if (pivots(k) /= k) then
            do j = 1, n
               one = a(k, j)
               a(k, j) = a(pivots(k), j)
               a(pivots(k), j) = one
            end do
         end if
         ! The diagonal has the inverse pivots: to multiply is cheaper than to divide.
         a(k, k) = conjg(a(k, k))/(real(a(k, k))**2 + aimag(a(k, k))**2)
         do i = k + 1, n
            a(i, k) = a(i, k)*a(k, k)
         end do
         do j = k + 1, n
            do i = k + 1, n
               a(i, j) = a(i, j) - a(i, k)*a(k, j)
            end do
         end do
      end do

   contains

      !> A size of `z`, without a root.
      pure real(dp) function size_of(z)
         complex(dp), intent(in) :: z

         size_of = abs(real(z)) + abs(aimag(z))
      end function size_of
   end subroutine factor_complex

   !> Solves for `b` (n) with the factors of `factor_complex`.
   pure subroutine solve_complex(n, a, pivots, b)
      integer, intent(in) :: n
      complex(dp), intent(in) :: a(n, n)
      integer, intent(in) :: pivots(n)
      complex(dp), intent(inout) :: b(n)
      complex(dp) :: one
      integer :: i, k

      do k = 1, n
         one = b(pivots(k))
         b(pivots(k)) = b(k)
         b(k) = one
      end do
      do k = 1, n
         do i = k + 1, n
            b(i) = b(i) - a(i, k)*b(k)
         end do
      end do
      do k = n, 1, -1
         b(k) = b(k)*a(k, k)
         do i = 1, k - 1
            b(i) = b(i) - a(i, k)*b(k)
         end do
      end do
   end subroutine solve_complex

   !> The null space of `a` (rows, columns): `basis` (columns, any number). Complete pivoting over the columns from 2
   !> on, the first one last of all; what is below `level` of the largest element counts as zero.
   pure subroutine find_null_space(a, level, basis)
      complex(wp), intent(in) :: a(:, :)
      real(wp), intent(in) :: level
      complex(wp), allocatable, intent(out) :: basis(:, :)
      complex(wp) :: w(size(a, 1), size(a, 2)), row(size(a, 2))
      real(wp) :: left(size(a, 1), size(a, 2)), zero
      integer :: pivot_column(size(a, 1)), at(2), rank, k, i, free
      logical :: is_free(size(a, 2))

      w = a
      is_free = .true.
      rank = 0
      zero = level*maxval([0.0_wp, abs(a)])
      do k = 1, min(size(a, 1), size(a, 2))
         left = merge(abs(w), 0.0_wp, spread(is_free, 1, size(a, 1)))
         left(:k - 1, :) = 0.0_wp
         if (maxval(left(:, 2:)) > zero) left(:, 1) = 0.0_wp
         if (maxval(left) <= zero) exit
         at = maxloc(left)
         rank = k
         row = w(at(1), :)/w(at(1), at(2))
         w(at(1), :) = w(k, :)
         w(k, :) = row
         pivot_column(k) = at(2)
         is_free(at(2)) = .false.
         do i = 1, size(a, 1)
            if (i /= k) w(i, :) = w(i, :) - w(i, at(2))*w(k, :)
         end do
      end do
      allocate (basis(size(a, 2), size(a, 2) - rank), source=(0.0_wp, 0.0_wp))
      k = 0
      do free = 1, size(a, 2)
         if (.not. is_free(free)) cycle
         k = k + 1
         basis(free, k) = 1.0_wp
         basis(pivot_column(:rank), k) = -w(:rank, free)
      end do
   end subroutine find_null_space
end module complex_lu
