!> Systems of 2p equations x^T C y = 0 in two groups of p unknowns each, in homogeneous coordinates x and y (0:p). With
!> random coefficients they have C(2p, p) solutions (the two-homogeneous number of Bezout), some of them at infinity.
!> Systems with p = 1 are solved in closed form.
module bilinear
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   implicit none
   private
   public :: bilinear_t, path_start_t, kept_start_t, path_end_t, ends_t, solve_quadratic, find_null_space, finiteness, &
      infinity_level, coarser_rounding

   !> A system. A solution is at infinity if plane . x = 0, or if conjugate(plane) . y = 0.
   type :: bilinear_t
      integer :: p = 0                                !< unknowns of each group
      complex(dp), allocatable :: c(:, :, :)          !< (0:p, 0:p, 2p); the largest element of each is about 1
      complex(dp), allocatable :: plane(:)            !< (0:p)
   end type bilinear_t

   !> A bilinear system with its solutions, in the chart x_0 = 1 + sum(chart_k x_k), y_0 = 1 + sum(chart_k y_k).
   type :: path_start_t
      integer :: p = 0                                !< unknowns of each group
      complex(dp), allocatable :: chart(:, :)         !< (p, 2) the numbers chart_k, of x and of y
      complex(dp), allocatable :: c(:, :, :)          !< (0:p, 0:p, 2p) coefficients of 1, x_1, ... by 1, y_1, ...
      complex(dp), allocatable :: z(:, :)             !< (2p, paths) the solutions: x_1 to x_p, then y_1 to y_p
   end type path_start_t

   !> The start of a block's paths, not allocated before paths are followed: many blocks never have any.
   type :: kept_start_t
      type(path_start_t), allocatable :: paths
   end type kept_start_t

   !> A solution, up to a factor of x and one of y.
   type :: path_end_t
      complex(dp), allocatable :: x(:), y(:)          !< (p + 1) x_0 and y_0 first
      logical :: is_singular = .false.                !< several solutions in one, or a point of a curve of solutions
   end type path_end_t

   !> All solutions: paths = size(list) + infinite + failed. A singular solution is in the list once for each path that
   !> leads to the solution.
   type :: ends_t
      integer :: paths = 0                            !< paths that were followed
      integer :: infinite = 0                         !< paths that lead to infinity
      integer :: failed = 0                           !< paths that could not be followed to their end
      type(path_end_t), allocatable :: list(:)             !< the finite solutions
   end type ends_t

   !> The relative rounding of coefficients: of the coarser one of real64 and `wp`, from which they come.
   real(dp), parameter :: coarser_rounding = max(epsilon(1.0_dp), real(epsilon(1.0_wp), dp))
   !> A determinant, a discriminant or a row below this part of its terms is zero: some hundred roundings.
   real(dp), parameter :: zero_part = 256.0_dp*coarser_rounding
   !> Solutions with less `finiteness` are at infinity: no slide is a million times as long as its loop.
   real(dp), parameter :: infinity_level = max(1.0e-6_dp, 64.0_dp*coarser_rounding)

contains

   !> Measures how far a solution is from infinity: 0 at infinity, about 1 if no coordinate is large. No unit.
   pure real(dp) function finiteness(bilinear, one, other)
      type(bilinear_t), intent(in) :: bilinear   !< the system
      complex(dp), intent(in) :: one(0:)     !< (0:p) x, up to a factor
      complex(dp), intent(in) :: other(0:)   !< (0:p) y, up to a factor

      finiteness = min(abs(sum(bilinear%plane*one))/maxval(abs(one)), &
         abs(sum(conjg(bilinear%plane)*other))/maxval(abs(other)))
   end function finiteness

   !> Finds the solutions of a system with p = 1 in closed form: the x that make both rows x^T C parallel, each with the
   !> y that both rows give. If all x do, no solution is listed, and no path is counted.
   subroutine solve_quadratic(bilinear, ends, moves)
      type(bilinear_t), intent(in) :: bilinear   !< the system
      type(ends_t), intent(out) :: ends      !< its solutions
      logical, intent(out) :: moves   !< solutions form a curve: of every x, or of every y with one x
      complex(dp) :: q(0:2), root, x(0:1), r(0:1, 2), y(0:1)
      real(dp) :: size_of
      type(path_end_t) :: e
      integer :: k

      ends%paths = 2
      allocate (ends%list(0))

      ! The two rows x^T C are parallel where their determinant, a quadratic form in x, is zero.
      associate (c => bilinear%c)
         q(0) = c(0, 0, 1)*c(0, 1, 2) - c(0, 1, 1)*c(0, 0, 2)
         q(1) = c(0, 0, 1)*c(1, 1, 2) + c(1, 0, 1)*c(0, 1, 2) - c(0, 1, 1)*c(1, 0, 2) - c(1, 1, 1)*c(0, 0, 2)
         q(2) = c(1, 0, 1)*c(1, 1, 2) - c(1, 1, 1)*c(1, 0, 2)
      end associate
      size_of = maxval(abs(q))

      moves = size_of <= zero_part
      if (moves) ends%paths = 0
      if (moves) return

      e%is_singular = abs(q(1)**2 - 4.0_dp*q(0)*q(2)) <= zero_part*size_of**2
      root = 0.0_dp
      if (.not. e%is_singular) root = sqrt(q(1)**2 - 4.0_dp*q(0)*q(2))
      if (real(conjg(q(1))*root) < 0.0_dp) root = -root
      do k = 1, 2
         ! (x_1 : x_0) = (-q_1 - root : 2 q_2) = (2 q_0 : -q_1 + root): the first solution by the first ratio, the other
         ! one, with the other sign of the root, by the second ratio. Then nothing cancels.
         x = [2.0_dp*q(2), -q(1) - root]
         if (k == 2) x = [-q(1) - root, 2.0_dp*q(0)]
         if (e%is_singular .and. abs(q(2)) < abs(q(0))) x = [-q(1), 2.0_dp*q(0)]
         if (e%is_singular .and. abs(q(2)) >= abs(q(0))) x = [2.0_dp*q(2), -q(1)]

         r(:, 1) = x(0)*bilinear%c(0, :, 1) + x(1)*bilinear%c(1, :, 1)
         r(:, 2) = x(0)*bilinear%c(0, :, 2) + x(1)*bilinear%c(1, :, 2)
         if (sum(abs(r(:, 2))) > sum(abs(r(:, 1)))) r(:, 1) = r(:, 2)
         y = [r(1, 1), -r(0, 1)]
         if (sum(abs(y)) <= zero_part*sum(abs(x))) then
            moves = .true.
            ends%failed = ends%failed + 1
         else if (finiteness(bilinear, x, y) > infinity_level) then
            e%x = [x]
            e%y = [y]
            ends%list = [ends%list, e]
         else
            ends%infinite = ends%infinite + 1
         end if
      end do
   end subroutine solve_quadratic

   !> Finds a basis of the null space of a matrix by Gauss-Jordan elimination. Pivoting is complete over the columns
   !> from 2 on; the first column is a pivot's only if no other is left.
   pure subroutine find_null_space(a, level, basis)
      complex(wp), intent(in) :: a(:, :)     !< (rows, columns)
      real(wp), intent(in) :: level          !< relative to the largest element: smaller elements count as zero
      complex(wp), allocatable, intent(out) :: basis(:, :)   !< (columns, dimension of the null space, perhaps 0)
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
end module bilinear
