!> The revolute pair of links i and j: the joint is point P of link i and point Q of link j.
!>
!> With the arms u = R(phi_i) (xi_P, eta_P) and w = R(phi_j) (xi_Q, eta_Q) from each link's own origin:
!>    x_i + u_x - x_j - w_x = 0        (7), there with u = a_i (cos phi_i, sin phi_i)
!>    y_i + u_y - y_j - w_y = 0        (8)
!> Derivatives by phi are the slopes of the arms: u' = (-u_y, u_x). The second derivative by time is
!> J a + (-phi_i'^2 u + phi_j'^2 w): its second part is the acceleration remainder.
!> The pair alone is never singular: its x and y columns hold +1 and -1.
module revolute_pair
   use kinds, only: wp
   implicit none
   private
   public :: revolute_residual, revolute_jacobian, revolute_remainder

contains

   !> Gap (2) between the joint's two points; `origin_i`, `origin_j` (2) are the links' origins, `u`, `w` the arms.
   pure function revolute_residual(origin_i, u, origin_j, w) result(r)
      real(wp), intent(in) :: origin_i(2), u(2), origin_j(2), w(2)
      real(wp) :: r(2)

      r = (origin_i - origin_j) + (u - w)
   end function revolute_residual

   !> Rows (2, 6) by x_i, y_i, phi_i, x_j, y_j, phi_j; `slope_u`, `slope_w` (2): derivatives of the arms by
   !> the angles, or what the frozen form of (16) puts in their place.
   pure function revolute_jacobian(slope_u, slope_w) result(row)
      real(wp), intent(in) :: slope_u(2), slope_w(2)
      real(wp) :: row(2, 6)

      row(1, :) = [1.0_wp, 0.0_wp, slope_u(1), -1.0_wp, 0.0_wp, -slope_w(1)]
      row(2, :) = [0.0_wp, 1.0_wp, slope_u(2), 0.0_wp, -1.0_wp, -slope_w(2)]
   end function revolute_jacobian

   !> What the second derivative of (7), (8) holds beside J a; `rate_i`, `rate_j`: phi' of the links.
   pure function revolute_remainder(u, rate_i, w, rate_j) result(gamma)
      real(wp), intent(in) :: u(2), rate_i, w(2), rate_j
      real(wp) :: gamma(2)

      gamma = rate_j**2*w - rate_i**2*u
   end function revolute_remainder
end module revolute_pair
