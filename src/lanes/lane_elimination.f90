!> Two linear equations in each lane, for a correction by Newton's method. Gauss's elimination takes the greatest pivot
!> of each column: the operations of the reference DGESV, in its order. Rows are exchanged by a choice between numbers:
!> all lanes then do the same operations. A pivot of zero becomes one of rounding, which no certificate takes. One loop
!> over the lanes for all of it stays in the registers, and takes half the time. A single equation is the first of two:
!> the second one has an unknown of its own, which is 0.
module lane_elimination
   use kinds, only: wp
   use block_solver, only: closed_level, step_tolerance
   use lane_sines, only: lane_count
   implicit none
   private
   public :: max_order, make_room, correct, substitute, judge_factors

   !> Equations at most: a group of two links has two, and a group of more links four at least.
   integer, parameter :: max_order = 2
   !> Replaces a pivot of zero.
   real(wp), parameter :: no_pivot = epsilon(1.0_wp)
   !> The pivot of an idle equation: larger than any other, and a power of two, which changes no digit.
   real(wp), parameter :: idle_pivot = 2.0_wp**100

contains

   !> Makes the second of two equations idle: its unknown is 0. The equation stays idle in all iterations.
   pure subroutine make_room(values, a, corrections, right_sides)
      real(wp), intent(inout) :: values(lane_count, max_order)        !< of the unknowns (rad, unit of the loop)
      real(wp), intent(inout) :: a(lane_count, max_order**2)          !< the Jacobian (2, 2), by columns
      real(wp), intent(inout) :: corrections(lane_count, max_order)   !< (lanes, unknowns) of the values
      real(wp), intent(inout) :: right_sides(lane_count, max_order)   !< (lanes, rows) for the velocities

      values(:, 2) = 0.0_wp
      a(:, 2:3) = 0.0_wp
      a(:, 4) = idle_pivot
      corrections(:, 2) = 0.0_wp
      right_sides(:, 2) = 0.0_wp
   end subroutine make_room

   !> Finds the corrections, to be subtracted from the values, and tells which lanes need another iteration. Residuals
   !> of rounding have nothing to correct: their corrections are 0.
   pure subroutine correct(coarse, values, a, exchanged, corrections, right_sides, going)
      real(wp), intent(in) :: coarse(lane_count)                      !< the least size that the values count as
      real(wp), intent(in) :: values(lane_count, max_order)           !< of the unknowns (rad, unit of the loop)
      real(wp), intent(inout) :: a(lane_count, max_order**2)          !< the Jacobian (2, 2), by columns; then factors
      real(wp), intent(inout) :: exchanged(lane_count)                !< 1: the two rows were exchanged; otherwise 0
      real(wp), intent(inout) :: corrections(lane_count, max_order)   !< the residuals; then the corrections
      real(wp), intent(inout) :: right_sides(lane_count, max_order)   !< other right-hand sides; then their solutions
      real(wp), intent(out) :: going(lane_count)                      !< above 0: another iteration is needed
      real(wp) :: p1, p2, q1, q2, x, y, first, second, residual, rounding
      integer :: l

      do l = 1, lane_count
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

   !> Solves the equations with their factors.
   pure subroutine substitute(a, exchanged, right_sides)
      real(wp), intent(in) :: a(lane_count, max_order**2)             !< the factors, as `correct` leaves them
      real(wp), intent(in) :: exchanged(lane_count)                   !< 1: the two rows were exchanged; otherwise 0
      real(wp), intent(inout) :: right_sides(lane_count, max_order)   !< the right-hand sides; then their solutions
      real(wp) :: first, second
      integer :: l

      do l = 1, lane_count
         first = merge(right_sides(l, 2), right_sides(l, 1), exchanged(l) > 0.5_wp)
         second = merge(right_sides(l, 1), right_sides(l, 2), exchanged(l) > 0.5_wp)
         second = (second - first*a(l, 2))/a(l, 4)
         right_sides(l, 2) = second
         right_sides(l, 1) = (first - second*a(l, 3))/a(l, 1)
      end do
   end subroutine substitute

   !> Finds from the factors the pivots, the sign of the determinant and the size of the inverse.
   pure subroutine judge_factors(a, exchanged, least, largest, sign_of, inverse)
      real(wp), intent(in) :: a(lane_count, max_order**2)   !< the factors, as `correct` leaves them
      real(wp), intent(in) :: exchanged(lane_count)         !< 1: the two rows were exchanged; otherwise 0
      real(wp), intent(out) :: least(lane_count)            !< |pivot|, the smaller one
      real(wp), intent(out) :: largest(lane_count)          !< |pivot|, the larger one
      real(wp), intent(out) :: sign_of(lane_count)          !< of the determinant: 1 or -1
      real(wp), intent(out) :: inverse(lane_count)          !< |A^-1|: the largest sum of |elements| of a row
      integer :: l

      do l = 1, lane_count
         least(l) = min(abs(a(l, 1)), abs(a(l, 4)))
         largest(l) = max(abs(a(l, 1)), abs(a(l, 4)))
         sign_of(l) = sign(1.0_wp, a(l, 1))*sign(1.0_wp, a(l, 4))*(1.0_wp - 2.0_wp*exchanged(l))
         inverse(l) = max(abs(a(l, 4) + a(l, 3)*a(l, 2)) + abs(a(l, 3)), abs(a(l, 1)*a(l, 2)) + abs(a(l, 1))) &
            /abs(a(l, 1)*a(l, 4))
      end do
   end subroutine judge_factors
end module lane_elimination
