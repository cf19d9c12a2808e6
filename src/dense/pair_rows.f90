!> The equations of the two pairs: residuals, rows of the Jacobian, acceleration remainders.
!>
!> Revolute pair of links i and j: the joint is point P of link i and point Q of link j. With the body vectors
!> u = R(phi_i) (xi_P, eta_P) and w = R(phi_j) (xi_Q, eta_Q) from each link's own origin:
!>    x_i + u_x - x_j - w_x = 0        (7), there with u = a_i (cos phi_i, sin phi_i)
!>    y_i + u_y - y_j - w_y = 0        (8)
!> Derivatives by phi are the slopes of the body vectors: u' = (-u_y, u_x). The second derivative by time is
!> J a + (-phi_i'^2 u + phi_j'^2 w): its second part is the acceleration remainder.
!> The pair alone is never singular: its x and y columns hold +1 and -1.
!>
!> Prismatic pair: point P of link i and point Q of link j; the guide lies in link i. Its direction
!> e = (cos theta, sin theta), theta = phi_i + alpha, and its normal n = (-sin theta, cos theta) turn with link i.
!> With d = P - Q:
!>    d . n = h                 (9), in which the print has sin phi_j for one sin phi_i; (6) and (16) are right
!>    phi_j - phi_i = beta      (10)
!> and the slide of (3), (4) is x_w = -d . e. Both are projections d . f on a vector f that turns with
!> link i; the procedures here take f and serve the pair (f = n) and the SLIDE drive (f = -e).
!>    (d . f)'  = d' . f + phi_i' d . f',                f' = (-f_y, f_x)
!>    (d . f)'' = d'' . f + phi_i'' d . f' + 2 phi_i' d' . f' - phi_i'^2 d . f
!> where d' = v + slope_u phi_i' and so on. Rejected: the closure with the slide as a further unknown, (3) and (4);
!> it costs one equation and one unknown a pair and prints nothing that the projection does not.
module pair_rows
   use kinds, only: wp
   use planar, only: rotated, quarter_turn, cross
   use pose, only: system_t, pose_t, secants
   implicit none
   private
   public :: revolute_residual, revolute_jacobian, revolute_remainder
   public :: projection_residual, tangent_gradient, frozen_gradient, projection_jacobian, projection_remainder
   public :: closure_error, normal, along, projection_row, moving_projection

contains

   !> P - Q (2), the closure error of a revolute pair; `origin_i`, `origin_j` (2) are the links' origins, `u`, `w` (2)
   !> the body vectors.
   pure function revolute_residual(origin_i, u, origin_j, w) result(r)
      real(wp), intent(in) :: origin_i(2), u(2), origin_j(2), w(2)
      real(wp) :: r(2)

      r = (origin_i - origin_j) + (u - w)
   end function revolute_residual

   !> Rows (2, 6) by x_i, y_i, phi_i, x_j, y_j, phi_j; `slope_u`, `slope_w` (2): derivatives of the body vectors by
   !> the angles, or the coefficients of the frozen form (16).
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

   !> d . f less its `required` value; `d`, `f` (2).
   pure real(wp) function projection_residual(d, f, required) result(r)
      real(wp), intent(in) :: d(2), f(2), required

      r = dot_product(d, f) - required
   end function projection_residual

   !> Derivatives (3) of d . f by d_x, d_y and the guide's angle.
   pure function tangent_gradient(d, f) result(g)
      real(wp), intent(in) :: d(2), f(2)
      real(wp) :: g(3)

      g = [f(1), f(2), cross(f, d)]
   end function tangent_gradient

   !> Frozen coefficients (3) of d . f instead of its derivatives, as in (16): of the two products d_x f_x
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

   !> Row (6) of d . f by x_i, y_i, phi_i, x_j, y_j, phi_j, from its gradient `g` (3) and the slopes of the body
   !> vectors of P and Q.
   pure function projection_jacobian(g, slope_u, slope_w) result(row)
      real(wp), intent(in) :: g(3), slope_u(2), slope_w(2)
      real(wp) :: row(6)

      row = [g(1), g(2), g(3) + dot_product(g(:2), slope_u), -g(1), -g(2), -dot_product(g(:2), slope_w)]
   end function projection_jacobian

   !> What (d . f)'' holds beside J a; `velocity` (2) = d', `u`, `w` (2) the body vectors, `rate_i`, `rate_j` the
   !> links' phi'.
   pure real(wp) function projection_remainder(d, f, velocity, u, rate_i, w, rate_j) result(gamma)
      real(wp), intent(in) :: d(2), f(2), velocity(2), u(2), rate_i, w(2), rate_j

      gamma = dot_product(rate_j**2*w - rate_i**2*u, f) &
         + rate_i*(2.0_wp*cross(f, velocity) - rate_i*dot_product(d, f))
   end function projection_remainder

   !> Point `a` less point `b` in the pose `p`.
   pure function closure_error(s, p, a, b) result(d)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: a, b
      real(wp) :: d(2)

      d = revolute_residual(p%q(:2, s%link_of(a)), p%body_vector(:, a), p%q(:2, s%link_of(b)), p%body_vector(:, b))
   end function closure_error

   !> Normal n of the guide of pair `k`.
   pure function normal(s, p, k) result(n)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp) :: n(2)

      n = quarter_turn(-along(s, p, k))
   end function normal

   !> Minus the direction e of the guide of pair `k`: the slide is the projection of P - Q on it.
   pure function along(s, p, k) result(f)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp) :: f(2)

      f = -rotated(s%guide(:, k), p%direction(:, s%link_of(s%pairs(k)%point_i)))
   end function along

   !> Row (6) of the projection of prismatic pair `k` on `f` (2), which has the angle `psi` and in the frozen form the
   !> reference angles `zeros` (2).
   pure function projection_row(s, p, k, f, psi, zeros) result(row)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp), intent(in) :: f(2), psi, zeros(2)
      real(wp) :: row(6), g(3), d(2)

      associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
         d = closure_error(s, p, a, b)
         g = tangent_gradient(d, f)
         if (p%frozen) g = frozen_gradient(d, f, secants(psi, zeros))
         row = projection_jacobian(g, p%slope(:, a), p%slope(:, b))
      end associate
   end function projection_row

   !> Acceleration remainder of the projection of prismatic pair `k` on `f` (2), at velocities `v` (3, links).
   pure real(wp) function moving_projection(s, p, v, k, f) result(gamma)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: v(:, :), f(2)
      integer, intent(in) :: k
      real(wp) :: velocity(2)

      associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
         associate (i => s%link_of(a), j => s%link_of(b), u => p%body_vector(:, a), w => p%body_vector(:, b))
            velocity = v(:2, i) - v(:2, j) + v(3, i)*quarter_turn(u) - v(3, j)*quarter_turn(w)
            gamma = projection_remainder(closure_error(s, p, a, b), f, velocity, u, v(3, i), w, v(3, j))
         end associate
      end associate
   end function moving_projection
end module pair_rows
