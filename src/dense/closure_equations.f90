!> The closure equations (14) of a mechanism: residuals, Jacobian and acceleration remainder.
!>
!> Equations: two of every pair, (7), (8) or (9), (10), then one of every drive. One assembly serves Newton and the
!> paper's own iteration: if the configuration is frozen, its slopes are the coefficients of (16) and the matrix is
!> A of (20).
!>
!> Revolute pair of links i and j: the joint is point P of link i and point Q of link j. With the body vectors
!> u = R(phi_i) (xi_P, eta_P) and w = R(phi_j) (xi_Q, eta_Q) from each link's own origin:
!>    x_i + u_x - x_j - w_x = 0        (7), there with u = a_i (cos phi_i, sin phi_i)
!>    y_i + u_y - y_j - w_y = 0        (8)
!> Derivatives by phi are the slopes of the body vectors: u' = (-u_y, u_x). The second derivative by time is
!> J a + (-phi_i'^2 u + phi_j'^2 w): its second part is the acceleration remainder.
!> By itself the pair is never singular: its x and y columns hold +1 and -1.
!>
!> Prismatic pair: point P of link i and point Q of link j; the guide lies in link i. Its direction
!> e = (cos theta, sin theta), theta = phi_i + alpha, and its normal n = (-sin theta, cos theta) turn with link i.
!> With d = P - Q:
!>    d . n = h                 (9), in which the print of 1987 has sin phi_j for one sin phi_i; (6), (16) are right
!>    phi_j - phi_i = beta      (10)
!> and the slide of (3), (4) is x_w = -d . e. Both are projections d . f on a vector f that turns with link i: f = n for
!> the pair, f = -e for the SLIDE drive.
!>    (d . f)'  = d' . f + phi_i' d . f',                f' = (-f_y, f_x)
!>    (d . f)'' = d'' . f + phi_i'' d . f' + 2 phi_i' d' . f' - phi_i'^2 d . f
!> with d' = v + slope_u phi_i' and so on. Rejected: the closure with the slide as a further unknown, (3) and (4);
!> it costs one equation and one unknown a pair, and gives no row that the projection does not give.
module closure_equations
   use kinds, only: wp
   use plane_vectors, only: pi, rotated, quarter_turn, cross
   use mechanism, only: has_guide, drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use drive_path, only: drive_path_t, drive_at
   use configuration, only: system_t, configuration_t, normal_angle, secants
   implicit none
   private
   public :: residual, jacobian, remainder, find_drive_values

contains

   !> Finds the residuals of all closure equations (14), by (7) to (10) of the pairs.
   pure subroutine residual(system, configuration, driven, residuals)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      real(wp), intent(in) :: driven(:)      !< (drives) their values in the system's unit of length or rad
      real(wp), intent(out) :: residuals(:)  !< (n) in the system's unit of length or rad
      integer :: k

      do k = 1, size(system%pairs)
         associate (pair => system%pairs(k), d => residuals(2*k - 1:2*k))
            d = closure_error(system, configuration, k)
            if (.not. has_guide(pair%kind)) cycle
            d = [dot_product(d, normal(system, configuration, k)) - pair%offset, &
               configuration%q(3, system%link_of(pair%point_j)) &
               - configuration%q(3, system%link_of(pair%point_i)) - pair%beta]
         end associate
      end do

      do k = 1, size(system%drives)
         associate (row => residuals(2*size(system%pairs) + k), subject => system%drives(k)%subject, &
            axis => axis_of(system%drives(k)%kind))
            select case (system%drives(k)%kind)
            case (drive_angle)
               row = configuration%q(3, subject)
            case (drive_x, drive_y)
               row = configuration%q(axis, system%link_of(subject)) + configuration%body_vector(axis, subject)
            case (drive_relangle)
               row = configuration%q(3, system%drives(k)%second) - configuration%q(3, subject)
            case default
               row = dot_product(closure_error(system, configuration, subject), along(system, configuration, subject))
            end select
            row = row - driven(k)
         end associate
      end do
   end subroutine residual

   !> Finds the Jacobian of the residuals. If the configuration is in the frozen form, the result is the matrix A of
   !> (20) instead.
   pure subroutine jacobian(system, configuration, a)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      real(wp), intent(out) :: a(:, :)       !< (n, n) in the system's unit of length and rad
      real(wp) :: coefficients(3)
      integer :: k, row

      a = 0.0_wp
      do k = 1, size(system%pairs)
         associate (u => configuration%slope(:, system%pairs(k)%point_i), &
            w => configuration%slope(:, system%pairs(k)%point_j))
            if (.not. has_guide(system%pairs(k)%kind)) then
               call add_to_row_of_pair(system, a, 2*k - 1, k, [1.0_wp, 0.0_wp, u(1), -1.0_wp, 0.0_wp, -w(1)])
               call add_to_row_of_pair(system, a, 2*k, k, [0.0_wp, 1.0_wp, u(2), 0.0_wp, -1.0_wp, -w(2)])
            else
               call add_to_row_of_pair(system, a, 2*k - 1, k, projection_row(system, configuration, k, &
                  normal(system, configuration, k), normal_angle(system, configuration, k), &
                  configuration%guide_zeros(:, k)))
               call add_to_row_of_pair(system, a, 2*k, k, [0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp])
            end if
         end associate
      end do

      do k = 1, size(system%drives)
         row = 2*size(system%pairs) + k
         coefficients = [0.0_wp, 0.0_wp, 1.0_wp]
         associate (drive => system%drives(k), subject => system%drives(k)%subject, &
            axis => axis_of(system%drives(k)%kind))
            select case (drive%kind)
            case (drive_angle)
               call add_to_row(system, a, row, subject, coefficients)
            case (drive_x, drive_y)
               coefficients(axis) = 1.0_wp
               coefficients(3) = configuration%slope(axis, subject)
               call add_to_row(system, a, row, system%link_of(subject), coefficients)
            case (drive_relangle)
               call add_to_row(system, a, row, drive%second, coefficients)
               call add_to_row(system, a, row, subject, -coefficients)

            case (drive_slide)
               call add_to_row_of_pair(system, a, row, subject, projection_row(system, configuration, subject, &
                  along(system, configuration, subject), normal_angle(system, configuration, subject) + pi/2.0_wp, &
                  configuration%guide_zeros([2, 1], subject) + pi/2.0_wp))
            end select
         end associate
      end do
   end subroutine jacobian

   !> Finds the acceleration remainder gamma of (22). The second derivative of the residuals with respect to time is
   !> J a + gamma, with the Jacobian J and the accelerations a.
   pure subroutine remainder(system, configuration, rates, gamma)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system, not frozen
      real(wp), intent(in) :: rates(:, :)    !< (3, links) velocities: x', y' (system's unit of length), phi' (rad)
      real(wp), intent(out) :: gamma(:)      !< (n) in the system's unit of length or rad, per unit of time squared
      integer :: k

      gamma = 0.0_wp
      do k = 1, size(system%pairs)
         if (.not. has_guide(system%pairs(k)%kind)) then
            gamma(2*k - 1:2*k) = turning_part(system, configuration, rates, k)
         else
            gamma(2*k - 1) = projection_remainder(system, configuration, rates, k, normal(system, configuration, k))
         end if
      end do

      do k = 1, size(system%drives)
         associate (row => gamma(2*size(system%pairs) + k), subject => system%drives(k)%subject, &
            kind => system%drives(k)%kind)
            if (any(kind == [drive_x, drive_y])) &
               row = -rates(3, system%link_of(subject))**2*configuration%body_vector(axis_of(kind), subject)
            if (kind == drive_slide) row = projection_remainder(system, configuration, rates, subject, &
               along(system, configuration, subject))
         end associate
      end do
   end subroutine remainder

   !> Finds value, rate and acceleration of all drives, in the system's unit and from its origin, at a parameter of
   !> their path.
   pure subroutine find_drive_values(system, path, parameter, values)
      type(system_t), intent(in) :: system   !< the closure equations
      type(drive_path_t), intent(in) :: path   !< of the drives
      real(wp), intent(in) :: parameter      !< of the path, in the deck's unit of time
      real(wp), intent(out) :: values(:, :)  !< (3, drives) in the system's unit of length or rad, by the parameter
      integer :: i

      do i = 1, size(system%drives)
         values(:, i) = drive_at(path, i, parameter)
         associate (kind => system%drives(i)%kind)
            if (any(kind == [drive_x, drive_y])) values(1, i) = values(1, i) - system%origin(axis_of(kind))
            if (any(kind == [drive_x, drive_y, drive_slide])) values(:, i) = values(:, i)/system%length
         end associate
      end do
   end subroutine find_drive_values

   !> Gives the number of the coordinate of a drive X or Y: 1 for x, 2 for y.
   pure integer function axis_of(kind)
      integer, intent(in) :: kind   !< drive_x or drive_y

      axis_of = merge(1, 2, kind == drive_x)
   end function axis_of

   !> Adds coefficients to a row of the Jacobian, at the columns of the two links of a pair.
   pure subroutine add_to_row_of_pair(system, a, row, k, coefficients)
      type(system_t), intent(in) :: system   !< the closure equations
      real(wp), intent(inout) :: a(:, :)     !< (n, n) the Jacobian
      integer, intent(in) :: row             !< the number of the row
      integer, intent(in) :: k               !< the number of the pair
      real(wp), intent(in) :: coefficients(6)   !< of x_i, y_i, phi_i, x_j, y_j, phi_j

      call add_to_row(system, a, row, system%link_of(system%pairs(k)%point_i), coefficients(:3))
      call add_to_row(system, a, row, system%link_of(system%pairs(k)%point_j), coefficients(4:))
   end subroutine add_to_row_of_pair

   !> Adds coefficients to a row of the Jacobian, at the columns of a link; a ground link has none.
   pure subroutine add_to_row(system, a, row, link, coefficients)
      type(system_t), intent(in) :: system   !< the closure equations
      real(wp), intent(inout) :: a(:, :)     !< (n, n) the Jacobian
      integer, intent(in) :: row             !< the number of the row
      integer, intent(in) :: link            !< the number of the link
      real(wp), intent(in) :: coefficients(3)   !< of x, y, phi

      associate (c => system%column(link))
         if (c > 0) a(row, c:c + 2) = a(row, c:c + 2) + coefficients
      end associate
   end subroutine add_to_row

   !> Gives the vector P - Q (2) of a pair, in the system's unit of length.
   pure function closure_error(system, configuration, k) result(d)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      integer, intent(in) :: k   !< the number of the pair
      real(wp) :: d(2)

      associate (a => system%pairs(k)%point_i, b => system%pairs(k)%point_j)
         d = (configuration%q(:2, system%link_of(a)) - configuration%q(:2, system%link_of(b))) + &
            (configuration%body_vector(:, a) - configuration%body_vector(:, b))
      end associate
   end function closure_error

   !> Gives the normal n (2) of the guide of a prismatic pair, a unit vector in the fixed axes.
   pure function normal(system, configuration, k) result(n)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      integer, intent(in) :: k   !< the number of the pair
      real(wp) :: n(2)

      n = quarter_turn(-along(system, configuration, k))
   end function normal

   !> Gives -e (2) for the direction e of the guide of a prismatic pair, in the fixed axes: the slide is (P - Q) . (-e).
   pure function along(system, configuration, k) result(f)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      integer, intent(in) :: k   !< the number of the pair
      real(wp) :: f(2)

      f = -rotated(system%guide(:, k), configuration%direction(:, system%link_of(system%pairs(k)%point_i)))
   end function along

   !> Gives the derivatives (6) of the projection d . f of a prismatic pair by x_i, y_i, phi_i, x_j, y_j, phi_j, the row
   !> (6). In the frozen form (16), d . f is d_x f_x + d_y f_y. The product whose f is nearer to zero becomes d s(h) h,
   !> with h counted from the nearest zero of f; the other keeps its sine or cosine as the coefficient of d. With x and
   !> y columns only, as printed, the slot of the yoke mechanism makes the matrix singular at every position.
   pure function projection_row(system, configuration, k, direction, psi, zeros) result(row)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      integer, intent(in) :: k               !< the number of the pair
      real(wp), intent(in) :: direction(2)   !< f, the unit vector on which P - Q is projected
      real(wp), intent(in) :: psi            !< rad: the angle of `direction`
      real(wp), intent(in) :: zeros(2)       !< rad: reference angles of its cosine and sine, in the frozen form
      real(wp) :: row(6), g(3), d(2), secant(2)

      d = closure_error(system, configuration, k)
      g = [direction(1), direction(2), cross(direction, d)]
      if (configuration%frozen) then
         secant = secants(psi, zeros)
         g = [direction(1), 0.0_wp, d(2)*secant(2)]
         if (abs(direction(2)) > abs(direction(1))) g = [0.0_wp, direction(2), d(1)*secant(1)]
      end if
      associate (u => configuration%slope(:, system%pairs(k)%point_i), &
         w => configuration%slope(:, system%pairs(k)%point_j))
         row = [g(1), g(2), g(3) + dot_product(g(:2), u), -g(1), -g(2), -dot_product(g(:2), w)]
      end associate
   end function projection_row

   !> Gives the acceleration remainder of the projection (d . f)'' of a prismatic pair, in the system's unit of length
   !> per unit of time squared, by the formulas of the module's head.
   pure real(wp) function projection_remainder(system, configuration, rates, k, direction) result(gamma)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      real(wp), intent(in) :: rates(:, :)    !< (3, links) velocities: x', y' (system's unit of length), phi' (rad)
      real(wp), intent(in) :: direction(2)   !< f, the unit vector on which P - Q is projected
      integer, intent(in) :: k               !< the number of the pair
      real(wp) :: velocity(2)

      associate (a => system%pairs(k)%point_i, b => system%pairs(k)%point_j)
         associate (i => system%link_of(a), j => system%link_of(b), u => configuration%body_vector(:, a), &
            w => configuration%body_vector(:, b))
            velocity = rates(:2, i) - rates(:2, j) + rates(3, i)*quarter_turn(u) - rates(3, j)*quarter_turn(w)
            gamma = dot_product(turning_part(system, configuration, rates, k), direction) &
               + rates(3, i)*(2.0_wp*cross(direction, velocity) &
               - rates(3, i)*dot_product(closure_error(system, configuration, k), direction))
         end associate
      end associate
   end function projection_remainder

   !> Gives the part (2) of the second derivative of P - Q of a pair that has no accelerations, -phi_i'^2 u + phi_j'^2
   !> w, in the system's unit of length per unit of time squared.
   pure function turning_part(system, configuration, rates, k) result(gamma)
      type(system_t), intent(in) :: system   !< the closure equations
      type(configuration_t), intent(in) :: configuration   !< of the system
      real(wp), intent(in) :: rates(:, :)    !< (3, links) velocities: x', y' (system's unit of length), phi' (rad)
      integer, intent(in) :: k               !< the number of the pair
      real(wp) :: gamma(2)

      associate (a => system%pairs(k)%point_i, b => system%pairs(k)%point_j)
         gamma = rates(3, system%link_of(b))**2*configuration%body_vector(:, b) &
            - rates(3, system%link_of(a))**2*configuration%body_vector(:, a)
      end associate
   end function turning_part
end module closure_equations
