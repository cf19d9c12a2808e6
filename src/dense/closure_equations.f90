!> The closure equations (14) of a mechanism: residual, Jacobian and acceleration remainder.
!>
!> Equations: two of every pair, (7), (8) or (9), (10), then one of every drive. One assembly serves Newton and the
!> paper's own iteration: where the pose is frozen, its slopes are the coefficients of (16) and the matrix is A of (20).
!> The one file that knows the kinds of pairs and of drives.
module closure_equations
   use kinds, only: wp
   use constants, only: pi
   use mechanism, only: pair_revolute, drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use drives, only: drive_motion
   use pose, only: system_t, pose_t, normal_angle
   use pair_rows, only: revolute_jacobian, revolute_remainder, projection_residual, closure_error, normal, along, &
      projection_row, moving_projection
   implicit none
   private
   public :: residual, jacobian, remainder
   public :: find_drive_values, drive_residual, drive_row, drive_remainder, place

contains

   !> Residual (n) of all equations at pose `p`; `driven` (drives): the drives' values.
   pure subroutine residual(s, p, driven, r)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: driven(:)
      real(wp), intent(out) :: r(:)
      real(wp) :: d(2)
      integer :: k

      do k = 1, size(s%pairs)
         associate (pair => s%pairs(k))
            d = closure_error(s, p, pair%point_i, pair%point_j)
            if (pair%kind == pair_revolute) then
               r(2*k - 1:2*k) = d
            else
               r(2*k - 1) = projection_residual(d, normal(s, p, k), pair%offset)
               r(2*k) = p%q(3, s%link_of(pair%point_j)) - p%q(3, s%link_of(pair%point_i)) - pair%beta
            end if
         end associate
      end do
      do k = 1, size(s%laws)
         r(2*size(s%pairs) + k) = drive_residual(s, p, k, driven(k))
      end do
   end subroutine residual

   !> Jacobian (n, n) of the residual at pose `p`, or the matrix A of (20) where the pose is in the frozen form.
   pure subroutine jacobian(s, p, a)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(out) :: a(:, :)
      real(wp) :: rows(2, 6)
      integer :: k

      a = 0.0_wp
      do k = 1, size(s%pairs)
         associate (pair => s%pairs(k))
            if (pair%kind == pair_revolute) then
               rows = revolute_jacobian(p%slope(:, pair%point_i), p%slope(:, pair%point_j))
            else
               rows(1, :) = projection_row(s, p, k, normal(s, p, k), normal_angle(s, p, k), p%guide_zeros(:, k))
               rows(2, :) = [0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]
            end if
            call place_both(s, a, 2*k - 1, k, rows(1, :))
            call place_both(s, a, 2*k, k, rows(2, :))
         end associate
      end do
      do k = 1, size(s%laws)
         call drive_row(s, p, k, a, 2*size(s%pairs) + k)
      end do
   end subroutine jacobian

   !> Acceleration remainder (n): what the second derivative of the residual holds beside J a, at velocities
   !> `v` (3, links).
   pure subroutine remainder(s, p, v, gamma)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: v(:, :)
      real(wp), intent(out) :: gamma(:)
      integer :: k

      gamma = 0.0_wp
      do k = 1, size(s%pairs)
         associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
            if (s%pairs(k)%kind == pair_revolute) then
               gamma(2*k - 1:2*k) = revolute_remainder(p%body_vector(:, a), v(3, s%link_of(a)), &
                  p%body_vector(:, b), v(3, s%link_of(b)))
            else
               gamma(2*k - 1) = moving_projection(s, p, v, k, normal(s, p, k))
            end if
         end associate
      end do
      do k = 1, size(s%laws)
         gamma(2*size(s%pairs) + k) = drive_remainder(s, p, v, k)
      end do
   end subroutine remainder

   !> Value, rate and acceleration (3, drives) of the drives at time `t`, in the system's unit and from its origin.
   pure subroutine find_drive_values(s, t, f)
      type(system_t), intent(in) :: s
      real(wp), intent(in) :: t
      real(wp), intent(out) :: f(:, :)
      integer :: i

      do i = 1, size(s%laws)
         f(:, i) = drive_motion(s%laws(i), t)
         if (s%laws(i)%drive%kind == drive_x) f(1, i) = f(1, i) - s%origin(1)
         if (s%laws(i)%drive%kind == drive_y) f(1, i) = f(1, i) - s%origin(2)
         if (any(s%laws(i)%drive%kind == [drive_x, drive_y, drive_slide])) f(:, i) = f(:, i)/s%length
      end do
   end subroutine find_drive_values

   !> The coordinate of drive `k` less its value `driven`.
   pure real(wp) function drive_residual(s, p, k, driven) result(r)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp), intent(in) :: driven

      r = 0.0_wp
      associate (subject => s%laws(k)%drive%subject)
         select case (s%laws(k)%drive%kind)
         case (drive_angle)
            r = p%q(3, subject) - driven
         case (drive_x)
            r = p%q(1, s%link_of(subject)) + p%body_vector(1, subject) - driven
         case (drive_y)
            r = p%q(2, s%link_of(subject)) + p%body_vector(2, subject) - driven
         case (drive_relangle)
            r = p%q(3, s%laws(k)%drive%second) - p%q(3, subject) - driven
         case (drive_slide)
            associate (pair => s%pairs(subject))
               r = projection_residual(closure_error(s, p, pair%point_i, pair%point_j), along(s, p, subject), driven)
            end associate
         end select
      end associate
   end function drive_residual

   !> Adds the coefficients of drive `k` to `row` of `a` (n, n).
   pure subroutine drive_row(s, p, k, a, row)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k, row
      real(wp), intent(inout) :: a(:, :)

      associate (subject => s%laws(k)%drive%subject)
         select case (s%laws(k)%drive%kind)
         case (drive_angle)
            call place(s, a, row, subject, [0.0_wp, 0.0_wp, 1.0_wp])
         case (drive_x)
            call place(s, a, row, s%link_of(subject), [1.0_wp, 0.0_wp, p%slope(1, subject)])
         case (drive_y)
            call place(s, a, row, s%link_of(subject), [0.0_wp, 1.0_wp, p%slope(2, subject)])
         case (drive_relangle)
            call place(s, a, row, s%laws(k)%drive%second, [0.0_wp, 0.0_wp, 1.0_wp])
            call place(s, a, row, subject, [0.0_wp, 0.0_wp, -1.0_wp])
         case (drive_slide)
            call place_both(s, a, row, subject, projection_row(s, p, subject, along(s, p, subject), &
               normal_angle(s, p, subject) + pi/2.0_wp, p%slide_zeros(:, k)))
         end select
      end associate
   end subroutine drive_row

   !> What the second derivative of the residual of drive `k` holds beside J a, at velocities `v` (3, links).
   pure real(wp) function drive_remainder(s, p, v, k) result(gamma)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: v(:, :)
      integer, intent(in) :: k

      gamma = 0.0_wp
      associate (subject => s%laws(k)%drive%subject)
         select case (s%laws(k)%drive%kind)
         case (drive_x)
            gamma = -v(3, s%link_of(subject))**2*p%body_vector(1, subject)
         case (drive_y)
            gamma = -v(3, s%link_of(subject))**2*p%body_vector(2, subject)
         case (drive_slide)
            gamma = moving_projection(s, p, v, subject, along(s, p, subject))
         end select
      end associate
   end function drive_remainder

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
end module closure_equations
