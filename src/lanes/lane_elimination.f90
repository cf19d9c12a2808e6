!> Two linear equations, those of a correction by Newton's method, in each lane, by Gauss's elimination with the
!> greatest pivot of each column: the operations of the reference DGESV, in its order. Rows are exchanged by
!> choosing between numbers, so that all lanes do the same. A pivot of zero becomes one of rounding, which no
!> certificate takes. What can be done in one loop over the lanes stays in the processor, and takes half the time.
!> A single equation is the first of two: the second one has an unknown of its own, which is 0.
module lane_elimination
   use kinds, only: wp
   use block_solver, only: closed_level, step_tolerance
   use lane_sines, only: width
   implicit none
   private
   public :: max_order, make_room, correct, substitute, judge_factors

   !> The largest number of equations: groups of two links have two, and a group of more links four at least.
   integer, parameter :: max_order = 2
   !> What stands for a pivot of zero.
   real(wp), parameter :: no_pivot = epsilon(1.0_wp)
   !> The pivot of an equation that is none: larger than any, and a power of two, so that it changes no digit.
   real(wp), parameter :: idle_pivot = 2.0_wp**100

contains

   !> Makes the second of two equations, with the Jacobian `a` (lanes, 4 by columns), idle: `values`, `corrections` and
   !> `right_sides` (lanes, 2) see `correct`. It stays so in all iterations.
   pure subroutine make_room(values, a, corrections, right_sides)
      real(wp), intent(inout) :: values(width, max_order), a(width, max_order**2), corrections(width, max_order), &
         right_sides(width, max_order)

      values(:, 2) = 0.0_wp
      a(:, 2:3) = 0.0_wp
      a(:, 4) = idle_pivot
      corrections(:, 2) = 0.0_wp
      right_sides(:, 2) = 0.0_wp
   end subroutine make_room

   !> The `corrections` (lanes, 2), to be subtracted from the `values` (lanes, 2), of which the largest is at least
   !> `coarse`: none where the residuals, `corrections` before, are of rounding, which have nothing to correct. `a`
   !> (lanes, 4 by columns): the Jacobian, and then its factors. `exchanged`: 1 where the first row was exchanged with
   !> the second, otherwise 0. `going`: above 0 where another iteration is needed. `right_sides` (lanes, 2): other
   !> right-hand sides, then their solutions.
   pure subroutine correct(coarse, values, a, exchanged, corrections, right_sides, going)
      real(wp), intent(in) :: coarse(width), values(width, max_order)
      real(wp), intent(inout) :: a(width, max_order**2), exchanged(width), corrections(width, max_order), &
         right_sides(width, max_order)
      real(wp), intent(out) :: going(width)
      real(wp) :: p1, p2, q1, q2, x, y, first, second, residual, rounding
      integer :: l

      do l = 1, width
         residual = max(abs(corrections(l, 1)), abs(corrections(l, 2)))
         rounding = closed_level*max(coarse(l), abs(values(l, 1)), abs(values(l, 2)))
         p1 = merge(a(l, 2), a(l, 1), abs(a(l, 2)) > abs(a(l, 1)))
         p2 = merge(a(l, 4), a(l, 3), abs(a(l, 2)) > abs(a(l, 1)))
         q1 = merge(a(l, 1), a(l, 2), abs(a(l, 2)) > abs(a(l, 1)))
         q2 = merge(a(l, 3), a(l, 4), abs(a(l, 2)) > abs(a(l, 1)))
         x = merge(corrections(l, 2), corrections(l, 1), abs(a(l, 2)) > abs(a(l, 1)))
         y = merge(corrections(l, 1), corrections(l, 2), abs(a(l, 2)) > abs(a(l, 1)))
         first = merge(right_sides(l, 2), right_sides(l, 1), abs(a(l, 2)) > abs(a(l, 1)))
         second = merge(right_sides(l, 1), right_sides(l, 2), abs(a(l, 2)) > abs(a(l, 1)))
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
         corrections(l, 1) = x
         corrections(l, 2) = y
         second = (second - first*q1)/q2
         right_sides(l, 2) = second
         right_sides(l, 1) = (first - second*p2)/p1
         going(l) = merge(0.0_wp, 1.0_wp, abs(x) <= step_tolerance*max(coarse(l), abs(values(l, 1) - x))) &
            + merge(0.0_wp, 1.0_wp, abs(y) <= step_tolerance*max(coarse(l), abs(values(l, 2) - y)))
      end do
   end subroutine correct

   !> Solves the equations with the factors `a` for the right-hand sides `right_sides` (lanes, 2), in their place.
   pure subroutine substitute(a, exchanged, right_sides)
      real(wp), intent(in) :: a(width, max_order**2), exchanged(width)
      real(wp), intent(inout) :: right_sides(width, max_order)
      real(wp) :: first, second
      integer :: l

      do l = 1, width
         first = merge(right_sides(l, 2), right_sides(l, 1), exchanged(l) > 0.5_wp)
         second = merge(right_sides(l, 1), right_sides(l, 2), exchanged(l) > 0.5_wp)
         second = (second - first*a(l, 2))/a(l, 4)
         right_sides(l, 2) = second
         right_sides(l, 1) = (first - second*a(l, 3))/a(l, 1)
      end do
   end subroutine substitute

   !> From the factors: the smallest and the largest pivot, the sign of the determinant, and |A^-1| in the maximum norm,
   !> the largest sum of sizes in a row of the inverse.
   pure subroutine judge_factors(a, exchanged, least, largest, sign_of, inverse)
      real(wp), intent(in) :: a(width, max_order**2), exchanged(width)
      real(wp), intent(out) :: least(width), largest(width), sign_of(width), inverse(width)
      integer :: l

      do l = 1, width
         least(l) = min(abs(a(l, 1)), abs(a(l, 4)))
         largest(l) = max(abs(a(l, 1)), abs(a(l, 4)))
         sign_of(l) = sign(1.0_wp, a(l, 1))*sign(1.0_wp, a(l, 4))*(1.0_wp - 2.0_wp*exchanged(l))
         inverse(l) = max(abs(a(l, 4) + a(l, 3)*a(l, 2)) + abs(a(l, 3)), abs(a(l, 1)*a(l, 2)) + abs(a(l, 1))) &
            /abs(a(l, 1)*a(l, 4))
      end do
   end subroutine judge_factors
end module lane_elimination
