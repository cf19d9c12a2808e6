!> The position of all links by Newton's method: the paper's matrix form (20) with tangent reference angles,
!> phi_ref = phi + cot(phi) in cosine rows and phi - tan(phi) in sine rows, where A is the Jacobian itself.
module position_newton
   use kinds, only: wp
   use linear_solver, only: factors_t
   use convergence, only: convergence_t
   use pose, only: system_t, pose_t, set_pose
   use position_iteration, only: iterate
   implicit none
   private
   public :: solve_newton

   integer, parameter :: iteration_limit = 60

contains

   !> Moves the links of `p` to where the drives have the values `driven` (drives); see `iterate`. The factors left in
   !> `f` are the Jacobian's.
   subroutine solve_newton(s, driven, tolerance, p, f, c, reach)
      type(system_t), intent(in) :: s
      real(wp), intent(in) :: driven(:), tolerance
      type(pose_t), intent(inout) :: p
      type(factors_t), intent(inout) :: f
      type(convergence_t), intent(out) :: c
      real(wp), intent(in), optional :: reach

      call set_pose(s, p)
      call iterate(s, driven, tolerance, iteration_limit, p, f, c, reach)
   end subroutine solve_newton
end module position_newton
