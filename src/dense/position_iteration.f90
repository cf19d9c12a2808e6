!> The iteration that both position methods are:
!>
!>    M(q_k) dq = -r(q_k),   q_(k+1) = q_k + dq
!>
!> with M the Jacobian (Newton) or, where the pose is in the frozen form, the paper's A: its A x_z = p - B x_n
!> is the same step, since A x - p + B x_n at the old position is the residual there.
!>
!> It ends when the residual AND the step are within tolerance of the size of the coordinates, or when the
!> residual is at the rounding level and the steps shrink no more: all the digits that the condition leaves.
module position_iteration
   use kinds, only: wp
   use linear_solver, only: factors_t, factor, solve
   use convergence, only: convergence_t, ended_converged, ended_stalled, ended_singular, ended_diverged
   use pose, only: system_t, pose_t, set_pose, add_to_links
   use closure_equations, only: residual, jacobian
   implicit none
   private
   public :: iterate, rounding_level

   !> A residual is a sum of at most six terms of the size of the coordinates, each rounded; twice that for margin.
   real(wp), parameter :: rounding_level = 12.0_wp*epsilon(1.0_wp)
   !> A step this small leaves the Jacobian, and so the velocities, at the rounding level too.
   real(wp), parameter :: step_tolerance = 16.0_wp*epsilon(1.0_wp)
   !> A residual or step beyond this many sizes comes back from nowhere; well below overflow.
   real(wp), parameter :: bound = min(1.0e30_wp, sqrt(sqrt(huge(1.0_wp))))
   !> An angle beyond this has fewer digits after the point than the listing prints.
   real(wp), parameter :: angle_limit = min(1.0e8_wp, 0.01_wp/epsilon(1.0_wp))

contains

   !> Moves the links of `p` to a position where the drives have the values `driven` (drives). `tolerance`: relative,
   !> 0 for the limit of rounding; `limit`: iterations allowed. `f`: room for n equations; leaves the factors of the
   !> last matrix, taken one step of the tolerance's size before the position. `c` says how it ended. `reach`: an angle
   !> that goes further than this from where it began, in radians, will come back by chance alone: diverged.
   subroutine iterate(s, driven, tolerance, limit, p, f, c, reach)
      type(system_t), intent(in) :: s
      real(wp), intent(in) :: driven(:), tolerance
      integer, intent(in) :: limit
      type(pose_t), intent(inout) :: p
      type(factors_t), intent(inout) :: f
      type(convergence_t), intent(out) :: c
      real(wp), intent(in), optional :: reach
      real(wp) :: r(s%n), start(size(p%q, 2)), before, first, highest, furthest
      integer :: info

      start = p%q(3, :)
      furthest = huge(furthest)
      if (present(reach)) furthest = reach
      before = huge(before)
      first = 0.0_wp
      do while (c%iterations < limit)
         c%iterations = c%iterations + 1
         call residual(s, p, driven, r)
         highest = max(1.0_wp, maxval(abs(p%q)))
         c%residual = maxval(abs(r))/highest
         if (c%iterations == 1) first = c%residual
         call jacobian(s, p, f%a)
         call factor(f, info)
         if (info > 0) then
            c%singular = c%residual <= max(rounding_level, tolerance)
            c%ended = merge(ended_stalled, ended_singular, c%singular)
            exit
         end if
         call solve(f, r)
         c%step = maxval(abs(r))/highest
         if (c%residual <= rounding_level .and. c%step > max(step_tolerance, tolerance, 0.5_wp*before)) then
            ! Rounding is all that is left to correct, and the position stays.
            c%ended = ended_stalled
            exit
         end if
         if (all(abs(r) <= bound)) call add_to_links(s, -r, p%q)
         if (.not. (all(abs(r) <= bound) .and. all(abs(p%q(3, :)) <= angle_limit) &
            .and. all(abs(p%q(3, :) - start) <= furthest))) then
            c%ended = ended_diverged
            exit
         end if
         call set_pose(s, p)
         if (c%residual <= max(rounding_level, tolerance) .and. c%step <= max(step_tolerance, tolerance)) then
            c%ended = ended_converged
            exit
         end if
         before = c%step
      end do
      if (c%iterations > 1 .and. first > 0.0_wp) &
         c%rate = (c%residual/first)**(1.0_wp/real(c%iterations - 1, wp))
   end subroutine iterate
end module position_iteration
