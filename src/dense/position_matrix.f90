!> The position of all links by the paper's own iteration (METHOD MATRIX): A x_z = p - B x_n (20) with the
!> coefficients c(phi), s(phi) of the last iterate. It converges linearly, like G = I - A^-1 J, or not at all.
!>
!> The reference angles, one for each row of each link, are the zeros nearest to the position predicted, and are kept
!> during the iteration. The stop test is the closure residual: increments that vanish prove nothing here.
module position_matrix
   use kinds, only: wp
   use linear_solver, only: factors_t, factor
   use convergence, only: convergence_t, is_solved
   use pose, only: system_t, pose_t, set_pose, choose_references
   use closure_equations, only: jacobian
   use position_iteration, only: iterate
   implicit none
   private
   public :: solve_matrix

   !> At a rate of 0.9 a bit takes 6.6 iterations, and the rounding level of 53 bits 340.
   integer, parameter :: iteration_limit = nint(7.55*digits(1.0_wp))

contains

   !> Moves the links of `p` to where the drives have the values `driven` (drives); see `iterate`. The factors left in
   !> `f` are the Jacobian's at the position found, for the velocities of (21) and the accelerations of (22).
   subroutine solve_matrix(s, driven, tolerance, p, f, c, reach)
      type(system_t), intent(in) :: s
      real(wp), intent(in) :: driven(:), tolerance
      type(pose_t), intent(inout) :: p
      type(factors_t), intent(inout) :: f
      type(convergence_t), intent(out) :: c
      real(wp), intent(in), optional :: reach
      integer :: info

      call set_pose(s, p)
      call choose_references(s, p)
      call iterate(s, driven, tolerance, iteration_limit, p, f, c, reach)
      p%frozen = .false.
      call set_pose(s, p)
      if (.not. is_solved(c)) return
      call jacobian(s, p, f%a)
      call factor(f, info)
      c%singular = info > 0
   end subroutine solve_matrix
end module position_matrix
