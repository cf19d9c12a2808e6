!> A number of a row, its rate and its acceleration between two times as polynomials of degree twelve, by motions at
!> places that all numbers share: where many numbers are searched for extremes, motions for each of them would take a
!> time that goes with the square of their number.
module curves
   use kinds, only: wp
   implicit none
   private
   public :: curve_t, curve_places, check_places, make_curve, on_curve

   !> The places in sixteenths of the interval: closer at its ends, so that roundings grow by 12 at most between them.
   integer, parameter :: curve_places(0:12) = [0, 1, 2, 3, 4, 6, 8, 10, 12, 13, 14, 15, 16]
   !> Where the product of the distances to the places, and so the error of the polynomial, is greatest.
   real(wp), parameter :: check_places(2) = [0.3_wp, 15.7_wp]
   !> 1 over the product of the distances of each place to the others, times a common factor (barycentric interpolation:
   !> Berrut and Trefethen, SIAM Rev. 46, 2004).
   real(wp), parameter :: weights(0:12) = [231.0_wp, -2048.0_wp, 7560.0_wp, -14336.0_wp, 12740.0_wp, -8008.0_wp, &
      7722.0_wp, -8008.0_wp, 12740.0_wp, -14336.0_wp, 7560.0_wp, -2048.0_wp, 231.0_wp]

   !> From the time `t` on, for the `length`, in the unit of time.
   type :: curve_t
      real(wp) :: t = 0.0_wp, length = 0.0_wp
      real(wp) :: f(0:2, 0:12) = 0.0_wp                !< value, rate, acceleration at the places
      real(wp) :: error(0:2) = 0.0_wp                  !< of each anywhere in the interval
   end type curve_t

contains

   !> The `curve` from the time `t` on, for the `length`, through `f` (0:2, 0:12). It `fits` if it meets the values
   !> `checks` (0:2, 2) at `check_places` but for what is `open` (0:2) of each number.
   pure subroutine make_curve(t, length, f, checks, open, curve, fits)
      real(wp), intent(in) :: t, length, f(0:2, 0:12), checks(0:2, 2), open(0:2)
      type(curve_t), intent(out) :: curve
      logical, intent(out) :: fits
      integer :: i

      curve%t = t
      curve%length = length
      curve%f = f
      do i = 1, 2
         curve%error = max(curve%error, abs(on_curve(curve, t + length*(check_places(i)/16.0_wp)) - checks(:, i)))
      end do
      fits = all(curve%error <= open)
   end subroutine make_curve

   !> Value, rate and acceleration at the time `t`.
   pure function on_curve(curve, t) result(f)
      type(curve_t), intent(in) :: curve
      real(wp), intent(in) :: t
      real(wp) :: f(0:2), distance(0:12), part(0:12)
      integer :: k

      distance = 16.0_wp*((t - curve%t)/curve%length) - curve_places
      k = minloc(abs(distance), dim=1) - 1
      f = curve%f(:, k)
      if (.not. abs(distance(k)) > 0.0_wp) return
      part = weights/distance
      f = matmul(curve%f, part)/sum(part)
   end function on_curve
end module curves
