!> One, two or three linear equations, those of a correction by Newton's method, in each lane, by Gauss's elimination
!> with the greatest pivot of each column: the operations of the reference DGESV, in its order. Rows are exchanged by
!> choosing between numbers, so that all lanes do the same. A pivot of zero becomes one of rounding, which no
!> certificate takes. What can be done in one loop over the lanes stays in the processor, and takes half the time.
module lane_elimination
   use kinds, only: wp
   use block_solver, only: closed_level, step_tolerance
   use lane_sines, only: width
   implicit none
   private
   public :: max_order, correct, substitute, judge_factors

   !> The largest number of equations.
   integer, parameter :: max_order = 3
   !> What stands for a pivot of zero.
   real(wp), parameter :: no_pivot = epsilon(1.0_wp)

contains

   !> The corrections `d` (lanes, n), to be subtracted from the values `u` (lanes, n), of which the largest is at least
   !> `coarse`: none where the residuals, `d` before, are of rounding, which have nothing to correct. `a` (lanes, n*n by
   !> columns): the Jacobian, and then its factors. `exchanged` (lanes, 3): 1 where the first row was exchanged with the
   !> second, the first with the third, the second with the third; otherwise 0. Those of rows that are not there stay as
   !> they are. `going`: above 0 where another iteration is needed. `v` (lanes, n): other right-hand sides, then their
   !> solutions.
   pure subroutine correct(n, coarse, u, a, exchanged, d, v, going)
      integer, intent(in) :: n
      real(wp), intent(in) :: coarse(width), u(width, n)
      real(wp), intent(inout) :: a(width, n*n), exchanged(width, 3), d(width, n), v(width, n)
      real(wp), intent(out) :: going(width)

      select case (n)
      case (1)
         call correct_one(coarse, u, a, d, v, going)
      case (2)
         call correct_two(coarse, u, a, exchanged, d, v, going)
      case (3)
         call correct_three(coarse, u, a, exchanged, d, v, going)
      end select
   end subroutine correct

   !> The same of one equation.
   pure subroutine correct_one(coarse, u, a, d, v, going)
      real(wp), intent(in) :: coarse(width), u(width)
      real(wp), intent(inout) :: a(width), d(width), v(width)
      real(wp), intent(out) :: going(width)
      real(wp) :: pivot, x
      integer :: l

      do l = 1, width
         pivot = merge(a(l), no_pivot, abs(a(l)) > 0.0_wp)
         x = merge(0.0_wp, d(l), abs(d(l)) <= closed_level*max(coarse(l), abs(u(l))))/pivot
         a(l) = pivot
         d(l) = x
         v(l) = v(l)/pivot
         going(l) = merge(0.0_wp, 1.0_wp, abs(x) <= step_tolerance*max(coarse(l), abs(u(l) - x)))
      end do
   end subroutine correct_one

   !> The same of two.
   pure subroutine correct_two(coarse, u, a, exchanged, d, v, going)
      real(wp), intent(in) :: coarse(width), u(width, 2)
      real(wp), intent(inout) :: a(width, 4), exchanged(width), d(width, 2), v(width, 2)
      real(wp), intent(out) :: going(width)
      real(wp) :: p1, p2, q1, q2, x, y, first, second, residual, rounding
      integer :: l

      do l = 1, width
         residual = max(abs(d(l, 1)), abs(d(l, 2)))
         rounding = closed_level*max(coarse(l), abs(u(l, 1)), abs(u(l, 2)))
         p1 = merge(a(l, 2), a(l, 1), abs(a(l, 2)) > abs(a(l, 1)))
         p2 = merge(a(l, 4), a(l, 3), abs(a(l, 2)) > abs(a(l, 1)))
         q1 = merge(a(l, 1), a(l, 2), abs(a(l, 2)) > abs(a(l, 1)))
         q2 = merge(a(l, 3), a(l, 4), abs(a(l, 2)) > abs(a(l, 1)))
         x = merge(d(l, 2), d(l, 1), abs(a(l, 2)) > abs(a(l, 1)))
         y = merge(d(l, 1), d(l, 2), abs(a(l, 2)) > abs(a(l, 1)))
         first = merge(v(l, 2), v(l, 1), abs(a(l, 2)) > abs(a(l, 1)))
         second = merge(v(l, 1), v(l, 2), abs(a(l, 2)) > abs(a(l, 1)))
         exchanged(l) = merge(1.0_wp, 0.0_wp, abs(a(l, 2)) > abs(a(l, 1)))
         p1 = p1 + merge(0.0_wp, no_pivot, abs(p1) > 0.0_wp)
         q1 = q1*(1.0_wp/p1)
         q2 = q2 - q1*p2
         q2 = q2 + merge(0.0_wp, no_pivot, abs(q2) > 0.0_wp)
         a(l, 1) = p1
         a(l, 2) = q1
         a(l, 3) = p2
         a(l, 4) = q2
         x = merge(0.0_wp, x, residual <= rounding)
         y = (merge(0.0_wp, y, residual <= rounding) - x*q1)/q2
         x = (x - y*p2)/p1
         d(l, 1) = x
         d(l, 2) = y
         second = (second - first*q1)/q2
         v(l, 2) = second
         v(l, 1) = (first - second*p2)/p1
         going(l) = merge(0.0_wp, 1.0_wp, abs(x) <= step_tolerance*max(coarse(l), abs(u(l, 1) - x))) &
            + merge(0.0_wp, 1.0_wp, abs(y) <= step_tolerance*max(coarse(l), abs(u(l, 2) - y)))
      end do
   end subroutine correct_two

   !> The same of three.
   pure subroutine correct_three(coarse, u, a, exchanged, d, v, going)
      real(wp), intent(in) :: coarse(width), u(width, 3)
      real(wp), intent(inout) :: a(width, 9), exchanged(width, 3), d(width, 3), v(width, 3)
      real(wp), intent(out) :: going(width)
      real(wp) :: residual(width), rounding(width)
      integer :: k

      residual = max(abs(d(:, 1)), abs(d(:, 2)), abs(d(:, 3)))
      rounding = closed_level*max(coarse, abs(u(:, 1)), abs(u(:, 2)), abs(u(:, 3)))
      do k = 1, 3
         d(:, k) = merge(0.0_wp, d(:, k), residual <= rounding)
      end do
      call factor_three(a, exchanged)
      call substitute(3, a, exchanged, d)
      call substitute(3, a, exchanged, v)
      going = 0.0_wp
      do k = 1, 3
         going = going + merge(0.0_wp, 1.0_wp, abs(d(:, k)) <= step_tolerance*max(coarse, abs(u(:, k) - d(:, k))))
      end do
   end subroutine correct_three

   !> Makes every zero of the `pivot` a rounding.
   pure subroutine fill_zeros(pivot)
      real(wp), intent(inout) :: pivot(width)

      pivot = merge(pivot, no_pivot, abs(pivot) > 0.0_wp)
   end subroutine fill_zeros

   !> The factors of three equations.
   pure subroutine factor_three(a, exchanged)
      real(wp), intent(inout) :: a(width, 9), exchanged(width, 3)
      real(wp) :: reciprocal
      integer :: l, c

      do l = 1, width
         exchanged(l, 1) = merge(1.0_wp, 0.0_wp, abs(a(l, 2)) > abs(a(l, 1)) .and. abs(a(l, 2)) >= abs(a(l, 3)))
         exchanged(l, 2) = merge(1.0_wp, 0.0_wp, abs(a(l, 3)) > abs(a(l, 1)) .and. abs(a(l, 3)) > abs(a(l, 2)))
      end do
      do c = 1, 7, 3
         call exchange(exchanged(:, 1), a(:, c), a(:, c + 1))
         call exchange(exchanged(:, 2), a(:, c), a(:, c + 2))
      end do
      call fill_zeros(a(:, 1))
      do l = 1, width
         reciprocal = 1.0_wp/a(l, 1)
         a(l, 2) = a(l, 2)*reciprocal
         a(l, 3) = a(l, 3)*reciprocal
         a(l, 5) = a(l, 5) - a(l, 2)*a(l, 4)
         a(l, 6) = a(l, 6) - a(l, 3)*a(l, 4)
         a(l, 8) = a(l, 8) - a(l, 2)*a(l, 7)
         a(l, 9) = a(l, 9) - a(l, 3)*a(l, 7)
         exchanged(l, 3) = merge(1.0_wp, 0.0_wp, abs(a(l, 6)) > abs(a(l, 5)))
      end do
      do c = 2, 8, 3
         call exchange(exchanged(:, 3), a(:, c), a(:, c + 1))
      end do
      call fill_zeros(a(:, 5))
      do l = 1, width
         a(l, 6) = a(l, 6)*(1.0_wp/a(l, 5))
         a(l, 9) = a(l, 9) - a(l, 6)*a(l, 8)
      end do
      call fill_zeros(a(:, 9))
   end subroutine factor_three

   !> Exchanges `x` and `y` in those lanes where `exchanged` is 1.
   pure subroutine exchange(exchanged, x, y)
      real(wp), intent(in) :: exchanged(width)
      real(wp), intent(inout) :: x(width), y(width)
      real(wp) :: z
      integer :: l

      do l = 1, width
         z = merge(y(l), x(l), exchanged(l) > 0.5_wp)
         y(l) = merge(x(l), y(l), exchanged(l) > 0.5_wp)
         x(l) = z
      end do
   end subroutine exchange

   !> Solves the equations with the factors `a` for the right-hand sides `b` (lanes, n), in their place.
   pure subroutine substitute(n, a, exchanged, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(width, n*n), exchanged(width, 3)
      real(wp), intent(inout) :: b(width, n)
      real(wp) :: first, second
      integer :: l

      select case (n)
      case (1)
         do l = 1, width
            b(l, 1) = b(l, 1)/a(l, 1)
         end do
      case (2)
         do l = 1, width
            first = merge(b(l, 2), b(l, 1), exchanged(l, 1) > 0.5_wp)
            second = merge(b(l, 1), b(l, 2), exchanged(l, 1) > 0.5_wp)
            second = (second - first*a(l, 2))/a(l, 4)
            b(l, 2) = second
            b(l, 1) = (first - second*a(l, 3))/a(l, 1)
         end do
      case (3)
         call exchange(exchanged(:, 1), b(:, 1), b(:, 2))
         call exchange(exchanged(:, 2), b(:, 1), b(:, 3))
         call exchange(exchanged(:, 3), b(:, 2), b(:, 3))
         do l = 1, width
            b(l, 2) = b(l, 2) - b(l, 1)*a(l, 2)
            b(l, 3) = ((b(l, 3) - b(l, 1)*a(l, 3)) - b(l, 2)*a(l, 6))/a(l, 9)
            b(l, 2) = (b(l, 2) - b(l, 3)*a(l, 8))/a(l, 5)
            b(l, 1) = ((b(l, 1) - b(l, 3)*a(l, 7)) - b(l, 2)*a(l, 4))/a(l, 1)
         end do
      end select
   end subroutine substitute

   !> From the factors: the smallest and the largest pivot, the sign of the determinant, and |A^-1| in the maximum norm,
   !> the largest sum of sizes in a row of the inverse.
   pure subroutine judge_factors(n, a, exchanged, least, largest, sign_of, inverse)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(width, n*n), exchanged(width, 3)
      real(wp), intent(out) :: least(width), largest(width), sign_of(width), inverse(width)
      integer :: l

      select case (n)
      case (1)
         do l = 1, width
            least(l) = abs(a(l, 1))
            largest(l) = abs(a(l, 1))
            sign_of(l) = sign(1.0_wp, a(l, 1))
            inverse(l) = 1.0_wp/abs(a(l, 1))
         end do
      case (2)
         do l = 1, width
            least(l) = min(abs(a(l, 1)), abs(a(l, 4)))
            largest(l) = max(abs(a(l, 1)), abs(a(l, 4)))
            sign_of(l) = sign(1.0_wp, a(l, 1))*sign(1.0_wp, a(l, 4))*(1.0_wp - 2.0_wp*exchanged(l, 1))
            inverse(l) = max(abs(a(l, 4) + a(l, 3)*a(l, 2)) + abs(a(l, 3)), abs(a(l, 1)*a(l, 2)) + abs(a(l, 1))) &
               /abs(a(l, 1)*a(l, 4))
         end do
      case (3)
         do l = 1, width
            least(l) = min(abs(a(l, 1)), abs(a(l, 5)), abs(a(l, 9)))
            largest(l) = max(abs(a(l, 1)), abs(a(l, 5)), abs(a(l, 9)))
            sign_of(l) = sign(1.0_wp, a(l, 1))*sign(1.0_wp, a(l, 5))*sign(1.0_wp, a(l, 9)) &
               *product(1.0_wp - 2.0_wp*exchanged(l, :))
         end do
         call invert_three(a, exchanged, inverse)
      end select
   end subroutine judge_factors

   !> The norm of the inverse of three equations.
   pure subroutine invert_three(a, exchanged, norm)
      real(wp), intent(in) :: a(width, 9), exchanged(width, 3)
      real(wp), intent(out) :: norm(width)
      real(wp) :: column(width, 3), rows(width, 3)
      integer :: c

      rows = 0.0_wp
      do c = 1, 3
         column = 0.0_wp
         column(:, c) = 1.0_wp
         call substitute(3, a, exchanged, column)
         rows = rows + abs(column)
      end do
      norm = max(rows(:, 1), rows(:, 2), rows(:, 3))
   end subroutine invert_three
end module lane_elimination
