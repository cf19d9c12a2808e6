!> The closure equations (14) of a mechanism: residual, Jacobian and acceleration remainder.
!>
!> Equations: two of every pair, (7), (8) or (9), (10), then one of every drive. One assembly serves Newton and the
!> paper's own iteration: where the configuration is frozen, its slopes are the coefficients of (16) and the matrix is
!> A of (20). The one file that knows the kinds of pairs and of drives.
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
!> and the slide of (3), (4) is x_w = -d . e. Both are projections d . f on a vector f that turns with link i: the pair
!> has f = n, the SLIDE drive f = -e.
!>    (d . f)'  = d' . f + phi_i' d . f',                f' = (-f_y, f_x)
!>    (d . f)'' = d'' . f + phi_i'' d . f' + 2 phi_i' d' . f' - phi_i'^2 d . f
!> where d' = v + slope_u phi_i' and so on. Rejected: the closure with the slide as a further unknown, (3) and (4);
!> it costs one equation and one unknown a pair and prints nothing that the projection does not.
module closure_equations
   use kinds, only: wp
   use plane_vectors, only: pi, rotated, quarter_turn, cross
   use mechanism, only: has_guide, drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use drive_path, only: drive_path_t, drive_at
   use configuration, only: system_t, configuration_t, normal_angle, secants
   implicit none
   private
   public :: residual, jacobian, remainder, find_drive_values, closure_error, normal, projection_row

contains

   !> Residual (n) of all equations at configuration `p`; `driven` (drives): the drives' values.
   pure subroutine residual(s, p, driven, r)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      real(wp), intent(in) :: driven(:)
      real(wp), intent(out) :: r(:)
      integer :: k

      do k = 1, size(s%pairs)
         associate (pair => s%pairs(k), d => r(2*k - 1:2*k))
            d = closure_error(s, p, k)
            if (.not. has_guide(pair%kind)) cycle
            d = [dot_product(d, normal(s, p, k)) - pair%offset, &
               p%q(3, s%link_of(pair%point_j)) - p%q(3, s%link_of(pair%point_i)) - pair%beta]
         end associate
      end do
      do k = 1, size(s%drives)
         associate (row => r(2*size(s%pairs) + k), subject => s%drives(k)%subject, axis => axis_of(s%drives(k)%kind))
            select case (s%drives(k)%kind)
            case (drive_angle)
               row = p%q(3, subject)
            case (drive_x, drive_y)
               row = p%q(axis, s%link_of(subject)) + p%body_vector(axis, subject)
            case (drive_relangle)
               row = p%q(3, s%drives(k)%second) - p%q(3, subject)
            case default
               row = dot_product(closure_error(s, p, subject), along(s, p, subject))
            end select
            row = row - driven(k)
         end associate
      end do
   end subroutine residual

   !> Jacobian (n, n) of the residual at configuration `p`, or the matrix A of (20) where the configuration is in the
   !> frozen form.
   pure subroutine jacobian(s, p, a)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      real(wp), intent(out) :: a(:, :)
      real(wp) :: coefficients(3)
      integer :: k, row

      a = 0.0_wp
      do k = 1, size(s%pairs)
         associate (u => p%slope(:, s%pairs(k)%point_i), w => p%slope(:, s%pairs(k)%point_j))
            if (.not. has_guide(s%pairs(k)%kind)) then
               call place_both(s, a, 2*k - 1, k, [1.0_wp, 0.0_wp, u(1), -1.0_wp, 0.0_wp, -w(1)])
               call place_both(s, a, 2*k, k, [0.0_wp, 1.0_wp, u(2), 0.0_wp, -1.0_wp, -w(2)])
            else
               call place_both(s, a, 2*k - 1, k, projection_row(s, p, k, normal(s, p, k), normal_angle(s, p, k), &
                  p%guide_zeros(:, k)))
               call place_both(s, a, 2*k, k, [0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp])
            end if
         end associate
      end do
      do k = 1, size(s%drives)
         row = 2*size(s%pairs) + k
         coefficients = [0.0_wp, 0.0_wp, 1.0_wp]
         associate (drive => s%drives(k), subject => s%drives(k)%subject, axis => axis_of(s%drives(k)%kind))
            select case (drive%kind)
            case (drive_angle)
               call place(s, a, row, subject, coefficients)
            case (drive_x, drive_y)
               coefficients(axis) = 1.0_wp
               coefficients(3) = p%slope(axis, subject)
               call place(s, a, row, s%link_of(subject), coefficients)
            case (drive_relangle)
               call place(s, a, row, drive%second, coefficients)
               call place(s, a, row, subject, -coefficients)
            case (drive_slide)
               call place_both(s, a, row, subject, projection_row(s, p, subject, along(s, p, subject), &
                  normal_angle(s, p, subject) + pi/2.0_wp, p%guide_zeros([2, 1], subject) + pi/2.0_wp))
            end select
         end associate
      end do
   end subroutine jacobian

   !> Acceleration remainder (n): what the second derivative of the residual holds beside J a, at velocities
   !> `v` (3, links).
   pure subroutine remainder(s, p, v, gamma)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      real(wp), intent(in) :: v(:, :)
      real(wp), intent(out) :: gamma(:)
      integer :: k

      gamma = 0.0_wp
      do k = 1, size(s%pairs)
         if (.not. has_guide(s%pairs(k)%kind)) then
            gamma(2*k - 1:2*k) = turning_part(s, p, v, k)
         else
            gamma(2*k - 1) = projection_remainder(s, p, v, k, normal(s, p, k))
         end if
      end do
      do k = 1, size(s%drives)
         associate (row => gamma(2*size(s%pairs) + k), subject => s%drives(k)%subject, kind => s%drives(k)%kind)
            if (any(kind == [drive_x, drive_y])) &
               row = -v(3, s%link_of(subject))**2*p%body_vector(axis_of(kind), subject)
            if (kind == drive_slide) row = projection_remainder(s, p, v, subject, along(s, p, subject))
         end associate
      end do
   end subroutine remainder

   !> Value, rate and acceleration (3, drives) of the drives on `path` at the parameter `p`, in the system's unit and
   !> from its origin.
   pure subroutine find_drive_values(s, path, p, f)
      type(system_t), intent(in) :: s
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: p
      real(wp), intent(out) :: f(:, :)
      integer :: i

      do i = 1, size(s%drives)
         f(:, i) = drive_at(path, i, p)
         associate (kind => s%drives(i)%kind)
            if (any(kind == [drive_x, drive_y])) f(1, i) = f(1, i) - s%origin(axis_of(kind))
            if (any(kind == [drive_x, drive_y, drive_slide])) f(:, i) = f(:, i)/s%length
         end associate
      end do
   end subroutine find_drive_values

   !> The coordinate that a drive of this `kind`, X or Y, gives.
   pure integer function axis_of(kind)
      integer, intent(in) :: kind

      axis_of = merge(1, 2, kind == drive_x)
   end function axis_of

   !> Adds six `coefficients` to `row` of `a`, at the columns of the two links of pair `k`.
   pure subroutine place_both(s, a, row, k, coefficients)
      type(system_t), intent(in) :: s
      real(wp), intent(inout) :: a(:, :)
      integer, intent(in) :: row, k
      real(wp), intent(in) :: coefficients(6)

      call place(s, a, row, s%link_of(s%pairs(k)%point_i), coefficients(:3))
      call place(s, a, row, s%link_of(s%pairs(k)%point_j), coefficients(4:))
   end subroutine place_both

   !> Adds three `coefficients` to `row` of `a` at the columns of `link`; a ground link has none.
   pure subroutine place(s, a, row, link, coefficients)
      type(system_t), intent(in) :: s
      real(wp), intent(inout) :: a(:, :)
      integer, intent(in) :: row, link
      real(wp), intent(in) :: coefficients(3)

      associate (c => s%column(link))
         if (c > 0) a(row, c:c + 2) = a(row, c:c + 2) + coefficients
      end associate
   end subroutine place

   !> P - Q (2) of pair `k` in the configuration `p`.
   pure function closure_error(s, p, k) result(d)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp) :: d(2)

      associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
         d = (p%q(:2, s%link_of(a)) - p%q(:2, s%link_of(b))) + (p%body_vector(:, a) - p%body_vector(:, b))
      end associate
   end function closure_error

   !> Normal n of the guide of pair `k`.
   pure function normal(s, p, k) result(n)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp) :: n(2)

      n = quarter_turn(-along(s, p, k))
   end function normal

   !> Minus the direction e of the guide of pair `k`: the slide is the projection of P - Q on it.
   pure function along(s, p, k) result(f)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp) :: f(2)

      f = -rotated(s%guide(:, k), p%direction(:, s%link_of(s%pairs(k)%point_i)))
   end function along

   !> Row (6) by x_i, y_i, phi_i, x_j, y_j, phi_j of the projection of prismatic pair `k` on `f` (2), which has the
   !> angle `psi` and in the frozen form the reference angles `zeros` (2).
   !>
   !> In the frozen form (16), d . f is d_x f_x + d_y f_y. The product whose f is nearer to zero becomes d s(h) h, with
   !> h counted from the nearest zero of f; the other keeps its sine or cosine as the coefficient of d. With x and y
   !> columns alone, as printed, the slot of the yoke mechanism makes the matrix singular at every position.
   pure function projection_row(s, p, k, f, psi, zeros) result(row)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp), intent(in) :: f(2), psi, zeros(2)
      real(wp) :: row(6), g(3), d(2), secant(2)

      d = closure_error(s, p, k)
      g = [f(1), f(2), cross(f, d)]
      if (p%frozen) then
         secant = secants(psi, zeros)
         g = [f(1), 0.0_wp, d(2)*secant(2)]
         if (abs(f(2)) > abs(f(1))) g = [0.0_wp, f(2), d(1)*secant(1)]
      end if
      associate (u => p%slope(:, s%pairs(k)%point_i), w => p%slope(:, s%pairs(k)%point_j))
         row = [g(1), g(2), g(3) + dot_product(g(:2), u), -g(1), -g(2), -dot_product(g(:2), w)]
      end associate
   end function projection_row

   !> Acceleration remainder of the projection of prismatic pair `k` on `f` (2), at velocities `v` (3, links).
   pure real(wp) function projection_remainder(s, p, v, k, f) result(gamma)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      real(wp), intent(in) :: v(:, :), f(2)
      integer, intent(in) :: k
      real(wp) :: velocity(2)

      associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
         associate (i => s%link_of(a), j => s%link_of(b), u => p%body_vector(:, a), w => p%body_vector(:, b))
            velocity = v(:2, i) - v(:2, j) + v(3, i)*quarter_turn(u) - v(3, j)*quarter_turn(w)
            gamma = dot_product(turning_part(s, p, v, k), f) &
               + v(3, i)*(2.0_wp*cross(f, velocity) - v(3, i)*dot_product(closure_error(s, p, k), f))
         end associate
      end associate
   end function projection_remainder

   !> Computes what the second derivative of P - Q (2) of pair `k` holds beside the accelerations: -phi_i'^2 u +
   !> phi_j'^2 w.
   pure function turning_part(s, p, v, k) result(gamma)
      type(system_t), intent(in) :: s
      type(configuration_t), intent(in) :: p
      real(wp), intent(in) :: v(:, :)
      integer, intent(in) :: k
      real(wp) :: gamma(2)

      associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
         gamma = v(3, s%link_of(b))**2*p%body_vector(:, b) - v(3, s%link_of(a))**2*p%body_vector(:, a)
      end associate
   end function turning_part
end module closure_equations
