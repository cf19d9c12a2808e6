!> The equation of a drive: what it asks for, its residual, its row of the Jacobian, its acceleration
!> remainder. The one place that knows the kinds of drives.
module drive_rows
   use kinds, only: wp
   use constants, only: pi
   use mechanism, only: drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use drives, only: drive_motion
   use pose, only: system_t, pose_t, normal_angle
   use prismatic_pair, only: projection_residual
   use sliding, only: closure_error, along, projection_row, moving_projection
   implicit none
   private
   public :: find_drive_values, drive_residual, drive_row, drive_remainder, place

contains

   !> Value, rate and second rate (3, drives) that the drives ask for at time `t`.
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

   !> What drive `k` lacks of the value `driven`.
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

   !> The row of drive `k`.
   pure subroutine drive_row(s, p, k, a, row)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k, row
      real(wp), intent(inout) :: a(:, :)
      real(wp) :: both(6)

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
            both = projection_row(s, p, subject, along(s, p, subject), &
               normal_angle(s, p, subject) + pi/2.0_wp, p%slide_zeros(:, k))
            call place(s, a, row, s%link_of(s%pairs(subject)%point_i), both(:3))
            call place(s, a, row, s%link_of(s%pairs(subject)%point_j), both(4:))
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

   !> Adds three coefficients to `row` at the columns of `link`; a ground link has none.
   pure subroutine place(s, a, row, link, coefficients)
      type(system_t), intent(in) :: s
      real(wp), intent(inout) :: a(:, :)
      integer, intent(in) :: row, link
      real(wp), intent(in) :: coefficients(3)

      associate (c => s%column(link))
         if (c > 0) a(row, c:c + 2) = a(row, c:c + 2) + coefficients
      end associate
   end subroutine place
end module drive_rows
