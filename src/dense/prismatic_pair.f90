!> The prismatic pair: point P of link i and point Q of link j; the guide lies in link i.
!>
!> The guide's direction e = (cos theta, sin theta), theta = phi_i + alpha, and its normal
!> n = (-sin theta, cos theta) turn with link i. With d = P - Q:
!>    d . n = h                 (9), in which the print has sin phi_j for one sin phi_i; (6) and (16) are right
!>    phi_j - phi_i = beta      (10)
!> and the slide of (3), (4) is x_w = -d . e. Both are projections d . f on a vector f that turns with
!> link i; the procedures here take f and serve the pair (f = n) and the SLIDE drive (f = -e).
!>    (d . f)'  = d' . f + phi_i' d . f',                f' = (-f_y, f_x)
!>    (d . f)'' = d'' . f + phi_i'' d . f' + 2 phi_i' d' . f' - phi_i'^2 d . f
!> where d' = v + slope_u phi_i' and so on. Rejected: the closure with the slide as a further unknown, (3) and (4);
!> it costs one equation and one unknown a pair and prints nothing that the projection does not.
module prismatic_pair
   use kinds, only: wp
   implicit none
   private
   public :: projection_residual, tangent_gradient, frozen_gradient, projection_jacobian, projection_remainder

contains

   !> d . f, less the value it must have; `d`, `f` (2).
   pure real(wp) function projection_residual(d, f, required) result(r)
      real(wp), intent(in) :: d(2), f(2), required

      r = dot_product(d, f) - required
   end function projection_residual

   !> Derivatives (3) of d . f by d_x, d_y and the guide's angle.
   pure function tangent_gradient(d, f) result(g)
      real(wp), intent(in) :: d(2), f(2)
      real(wp) :: g(3)

      g = [f(1), f(2), d(2)*f(1) - d(1)*f(2)]
   end function tangent_gradient

   !> Frozen coefficients (3) of d . f in the place of its derivatives, as (16) has them: of the two products d_x f_x
   !> and d_y f_y the one whose f is nearer to zero becomes d s(h) h, with `secant` (2) the ratios f/h, h counted from
   !> the nearest zero of f; the other keeps its sine or cosine as the coefficient of d. With x and y columns
   !> alone, as printed, the slot of the yoke mechanism makes the matrix singular at every position.
   pure function frozen_gradient(d, f, secant) result(g)
      real(wp), intent(in) :: d(2), f(2), secant(2)
      real(wp) :: g(3)

      if (abs(f(2)) <= abs(f(1))) then
         g = [f(1), 0.0_wp, d(2)*secant(2)]
      else
         g = [0.0_wp, f(2), d(1)*secant(1)]
      end if
   end function frozen_gradient

   !> Row (6) of d . f by x_i, y_i, phi_i, x_j, y_j, phi_j, from its gradient `g` (3) and the slopes of the arms to P
   !> and Q.
   pure function projection_jacobian(g, slope_u, slope_w) result(row)
      real(wp), intent(in) :: g(3), slope_u(2), slope_w(2)
      real(wp) :: row(6)

      row = [g(1), g(2), g(3) + dot_product(g(:2), slope_u), -g(1), -g(2), -dot_product(g(:2), slope_w)]
   end function projection_jacobian

   !> What (d . f)'' holds beside J a; `velocity` (2) = d', `u`, `w` (2) the arms, `rate_i`, `rate_j` the links' phi'.
   pure real(wp) function projection_remainder(d, f, velocity, u, rate_i, w, rate_j) result(gamma)
      real(wp), intent(in) :: d(2), f(2), velocity(2), u(2), rate_i, w(2), rate_j

      gamma = dot_product(rate_j**2*w - rate_i**2*u, f) &
         + rate_i*(2.0_wp*(velocity(2)*f(1) - velocity(1)*f(2)) - rate_i*dot_product(d, f))
   end function projection_remainder
end module prismatic_pair
