!> The position of all links by an iteration, of which METHOD DENSE and METHOD MATRIX are two cases:
!>
!>    M(q_k) dq = -r(q_k),   q_(k+1) = q_k + dq
!>
!> METHOD DENSE: M is the Jacobian J, Newton's method. It is the paper's matrix form (20) with tangent reference angles,
!> phi_ref = phi + cot(phi) in cosine rows and phi - tan(phi) in sine rows, where A is the Jacobian itself.
!>
!> METHOD MATRIX: M is the paper's A, A x_z = p - B x_n (20) with the coefficients c(phi), s(phi) of the last iterate;
!> the step is equal, since A x - p + B x_n at the old position is the residual there. It converges linearly, like
!> G = I - A^-1 J, or not at all. The reference angles, one for each row of each link, are the zeros nearest to the
!> predicted position, and stay during the iteration.
!>
!> The iteration ends when the residual AND the step are within the tolerance of the size of the coordinates (vanishing
!> steps prove nothing in METHOD MATRIX). It also ends when the residual is at the rounding level and the steps shrink
!> no more: then the position has all digits that the condition leaves.
module position_iteration
   use kinds, only: wp
   use linear_solver, only: factors_t, factor, solve
   use convergence, only: solve_report_t, is_solved, ended_converged, ended_stalled, ended_singular, ended_diverged, &
      rounding_level
   use block_solver, only: angle_limit
   use predictor, only: largest_predicted_change
   use configuration, only: system_t, configuration_t, set_configuration, choose_references, add_to_links
   use closure_equations, only: residual, jacobian
   implicit none
   private
   public :: solve_position

   !> rad: an iteration that turns a link further wanders, and its end depends on rounding: it has diverged.
   real(wp), parameter :: max_angle_change = largest_predicted_change
   !> Iterations of Newton's method at most. Near a singular position it only halves the step: 53 bits take 53.
   integer, parameter :: newton_iterations = 60
   !> Iterations of 1987 at most. At a rate of 0.9 a bit takes 6.6 iterations, and the rounding level of 53 bits 340.
   integer, parameter :: matrix_iterations = nint(7.55*digits(1.0_wp))
   !> A step this small, over the size of the coordinates, leaves Jacobian and velocities at the rounding level too.
   real(wp), parameter :: dense_step_tolerance = 16.0_wp*epsilon(1.0_wp)
   !> Over the size of the coordinates: with a residual at the rounding level even a singular Jacobian leaves no larger
   !> step.
   real(wp), parameter :: root_of_rounding = 64.0_wp*sqrt(epsilon(1.0_wp))
   !> An iteration does not come back from a step of this size, in rad or the system's unit; well below overflow.
   real(wp), parameter :: max_correction = min(1.0e30_wp, sqrt(sqrt(huge(1.0_wp))))

contains

   !> Moves all links to a position at which the drives have given values: by Newton's method or by the iteration of
   !> 1987, (20). If the position is found, the factors are those of the Jacobian, for (21) and (22). They belong to the
   !> position or, by Newton's method, to the iterate one step of the tolerance's size before. Otherwise they are the
   !> factors of the last matrix.
   subroutine solve_position(system, driven, tolerance, is_matrix, configuration, factors, convergence)
      type(system_t), intent(in) :: system   !< the closure equations
      real(wp), intent(in) :: driven(:)      !< (drives) their values in the system's unit of length or rad
      real(wp), intent(in) :: tolerance      !< over the size of the coordinates; 0: the limit of rounding
      logical, intent(in) :: is_matrix       !< by the iteration of 1987; otherwise by Newton's method
      type(configuration_t), intent(inout) :: configuration   !< the initial guess, then the last iterate
      type(factors_t), intent(inout) :: factors   !< with room for n equations
      type(solve_report_t), intent(out) :: convergence   !< how the iteration ended; singular: without an inverse
      real(wp) :: r(system%n), start(size(configuration%q, 2)), before, highest
      logical :: stays
      integer :: info

      call set_configuration(system, configuration)
      if (is_matrix) call choose_references(system, configuration)
      start = configuration%q(3, :)
      before = huge(before)
      do while (convergence%iterations < merge(matrix_iterations, newton_iterations, is_matrix))
         convergence%iterations = convergence%iterations + 1
         call residual(system, configuration, driven, r)
         highest = max(1.0_wp, maxval(abs(configuration%q)))
         convergence%residual = maxval(abs(r))/highest
         call jacobian(system, configuration, factors%a)
         call factor(factors, info)

         if (info > 0) then
            convergence%singular = convergence%residual <= max(rounding_level, tolerance)
            convergence%ended = merge(ended_stalled, ended_singular, convergence%singular)
            exit
         end if
         call solve(factors, r)
         convergence%step = maxval(abs(r))/highest
         if (convergence%residual <= rounding_level .and. &
            convergence%step > max(dense_step_tolerance, tolerance, min(0.5_wp*before, root_of_rounding))) then
            ! Rounding is all that is left to correct, and the position stays.
            convergence%ended = ended_stalled
            exit
         end if

         stays = all(abs(r) <= max_correction)
         if (stays) then
            call add_to_links(system, -r, configuration%q)
            stays = all(abs(configuration%q(3, :)) <= angle_limit) .and. &
               all(abs(configuration%q(3, :) - start) <= max_angle_change)
         end if
         if (.not. stays) then
            convergence%ended = ended_diverged
            exit
         end if

         call set_configuration(system, configuration)
         if (convergence%residual <= max(rounding_level, tolerance) .and. &
            convergence%step <= max(dense_step_tolerance, tolerance)) then
            convergence%ended = ended_converged
            exit
         end if
         before = convergence%step
      end do
      if (.not. is_matrix) return

      configuration%frozen = .false.
      call set_configuration(system, configuration)
      if (.not. is_solved(convergence)) return
      call jacobian(system, configuration, factors%a)
      call factor(factors, info)
      convergence%singular = info > 0
   end subroutine solve_position
end module position_iteration
