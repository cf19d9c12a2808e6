!> One or two linear equations, those of a correction by Newton's method, in each lane, by Gauss's elimination with the
!> greatest pivot of each column: the operations of the reference DGESV, in its order. Rows are exchanged by
!> choosing between numbers, so that all lanes do the same. A pivot of zero becomes one of rounding, which no
!> certificate takes. What can be done in one loop over the lanes stays in the processor, and takes half the time.
module lane_elimination
   use kinds, only: wp
   use block_solver, only: closed_level, step_tolerance
   use lane_sines, only: width
   implicit none
   private
   public :: max_order, correct, substitute, judge_factors

   !> The largest number of equations: groups of two links have two, and a group of more links four at least.
   integer, parameter :: max_order = 2
   !> What stands for a pivot of zero.
   real(wp), parameter :: no_pivot = epsilon(1.0_wp)

contains

   !> The corrections `d` (lanes, n), to be subtracted from the values `u` (lanes, n), of which the largest is at least
   !> `coarse`: none where the residuals, `d` before, are of rounding, which have nothing to correct. `a` (lanes, n*n by
   !> columns): the Jacobian, and then its factors. `exchanged`: 1 where the first row of two was exchanged with the
   !> second, otherwise 0. `going`: above 0 where another iteration is needed. `v` (lanes, n): other right-hand sides,
   !> then their solutions.
   pure subroutine correct(n, coarse, u, a, exchanged, d, v, going)
      integer, intent(in) :: n
      real(wp), intent(in) :: coarse(width), u(width, n)
      real(wp), intent(inout) :: a(width, n*n), exchanged(width), d(width, n), v(width, n)
      real(wp), intent(out) :: going(width)
      real(wp) :: p1, p2, q1, q2, x, y, first, second, residual, rounding
      integer :: l

      if (n == 1) then
         do l = 1, width
            p1 = merge(a(l, 1), no_pivot, abs(a(l, 1)) > 0.0_wp)
            x = merge(0.0_wp, d(l, 1), abs(d(l, 1)) <= closed_level*max(coarse(l), abs(u(l, 1))))/p1
            a(l, 1) = p1
            d(l, 1) = x
            v(l, 1) = v(l, 1)/p1
            going(l) = merge(0.0_wp, 1.0_wp, abs(x) <= step_tolerance*max(coarse(l), abs(u(l, 1) - x)))
         end do
         return
      end if
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
   end subroutine correct

   !> Solves the equations with the factors `a` for the right-hand sides `b` (lanes, n), in their place.
   pure subroutine substitute(n, a, exchanged, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(width, n*n), exchanged(width)
      real(wp), intent(inout) :: b(width, n)
      real(wp) :: first, second
      integer :: l

      if (n == 1) then
         do l = 1, width
            b(l, 1) = b(l, 1)/a(l, 1)
         end do
         return
      end if
      do l = 1, width
         first = merge(b(l, 2), b(l, 1), exchanged(l) > 0.5_wp)
         second = merge(b(l, 1), b(l, 2), exchanged(l) > 0.5_wp)
         second = (second - first*a(l, 2))/a(l, 4)
         b(l, 2) = second
         b(l, 1) = (first - second*a(l, 3))/a(l, 1)
      end do
   end subroutine substitute

   !> From the factors: the smallest and the largest pivot, the sign of the determinant, and |A^-1| in the maximum norm,
   !> the largest sum of sizes in a row of the inverse.
   pure subroutine judge_factors(n, a, exchanged, least, largest, sign_of, inverse)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(width, n*n), exchanged(width)
      real(wp), intent(out) :: least(width), largest(width), sign_of(width), inverse(width)
      integer :: l

      if (n == 1) then
         do l = 1, width
            least(l) = abs(a(l, 1))
            largest(l) = abs(a(l, 1))
            sign_of(l) = sign(1.0_wp, a(l, 1))
            inverse(l) = 1.0_wp/abs(a(l, 1))
         end do
         return
      end if
      do l = 1, width
         least(l) = min(abs(a(l, 1)), abs(a(l, 4)))
         largest(l) = max(abs(a(l, 1)), abs(a(l, 4)))
         sign_of(l) = sign(1.0_wp, a(l, 1))*sign(1.0_wp, a(l, 4))*(1.0_wp - 2.0_wp*exchanged(l))
         inverse(l) = max(abs(a(l, 4) + a(l, 3)*a(l, 2)) + abs(a(l, 3)), abs(a(l, 1)*a(l, 2)) + abs(a(l, 1))) &
            /abs(a(l, 1)*a(l, 4))
      end do
   end subroutine judge_factors
end module lane_elimination
