!> The closure equations of a mechanism: residual, Jacobian and acceleration remainder.
!>
!> Equations: two of every pair, (7), (8) or (9), (10), then one of every drive. One assembly serves Newton and the
!> paper's own iteration: where the pose is frozen, its slopes are the coefficients of (16) and the matrix is A of (20).
!> The one place that knows the kinds of pairs.
module closure_equations
   use kinds, only: wp
   use mechanism, only: pair_revolute, pair_prismatic
   use pose, only: system_t, pose_t, normal_angle
   use revolute_pair, only: revolute_residual, revolute_jacobian, revolute_remainder
   use prismatic_pair, only: projection_residual
   use sliding, only: closure_error, normal, projection_row, moving_projection
   use drive_rows, only: drive_residual, drive_row, drive_remainder, place
   implicit none
   private
   public :: residual, jacobian, remainder

contains

   !> Residual (n) of all equations at pose `p`; `driven` (drives): the values that the drives ask for.
   pure subroutine residual(s, p, driven, r)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: driven(:)
      real(wp), intent(out) :: r(:)
      integer :: k, row

      row = 1
      do k = 1, size(s%pairs)
         associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
            associate (i => s%link_of(a), j => s%link_of(b))
               select case (s%pairs(k)%kind)
               case (pair_revolute)
                  r(row:row + 1) = revolute_residual(p%q(:2, i), p%body_vector(:, a), p%q(:2, j), p%body_vector(:, b))
               case (pair_prismatic)
                  r(row) = projection_residual(closure_error(s, p, a, b), normal(s, p, k), s%pairs(k)%offset)
                  r(row + 1) = p%q(3, j) - p%q(3, i) - s%pairs(k)%beta
               end select
            end associate
         end associate
         row = row + 2
      end do
      do k = 1, size(s%laws)
         r(row) = drive_residual(s, p, k, driven(k))
         row = row + 1
      end do
   end subroutine residual

   !> Jacobian (n, n) of the residual at pose `p`, or the matrix A of (20) where the pose is in the frozen form.
   pure subroutine jacobian(s, p, a)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(out) :: a(:, :)
      real(wp) :: rows(2, 6)
      integer :: k, row

      a = 0.0_wp
      row = 1
      do k = 1, size(s%pairs)
         associate (pair => s%pairs(k))
            associate (i => s%link_of(pair%point_i), j => s%link_of(pair%point_j))
               if (pair%kind == pair_revolute) then
                  rows = revolute_jacobian(p%slope(:, pair%point_i), p%slope(:, pair%point_j))
               else
                  rows(1, :) = projection_row(s, p, k, normal(s, p, k), &
                     normal_angle(s, p, k), p%guide_zeros(:, k))
                  rows(2, :) = [0.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp]
               end if
               call place(s, a, row, i, rows(1, :3))
               call place(s, a, row, j, rows(1, 4:))
               call place(s, a, row + 1, i, rows(2, :3))
               call place(s, a, row + 1, j, rows(2, 4:))
            end associate
         end associate
         row = row + 2
      end do
      do k = 1, size(s%laws)
         call drive_row(s, p, k, a, row)
         row = row + 1
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
            associate (i => s%link_of(a), j => s%link_of(b))
               if (s%pairs(k)%kind == pair_revolute) then
                  gamma(2*k - 1:2*k) = revolute_remainder(p%body_vector(:, a), v(3, i), p%body_vector(:, b), v(3, j))
               else
                  gamma(2*k - 1) = moving_projection(s, p, v, k, normal(s, p, k))
               end if
            end associate
         end associate
      end do
      do k = 1, size(s%laws)
         gamma(2*size(s%pairs) + k) = drive_remainder(s, p, v, k)
      end do
   end subroutine remainder
end module closure_equations
