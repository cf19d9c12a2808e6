!> Velocities, then accelerations, each from one linear solve with the factors of the same Jacobian:
!>
!>    J v = f'                       (21) with the dependence of A' on the unknown velocities moved to the left
!>    J a = f'' - gamma(q, v)        (22) likewise
!>
!> f' and f'' are the drives' rates and second rates, zero in the pairs' rows; gamma is the acceleration remainder.
module rates
   use kinds, only: wp
   use linear_solver, only: factors_t, solve
   use pose, only: system_t, pose_t, add_to_links
   use closure_equations, only: remainder
   implicit none
   private
   public :: solve_velocity, solve_acceleration

contains

   !> Velocities `v` (3, links) from the drives' rates `rate` (drives).
   subroutine solve_velocity(s, f, rate, v)
      type(system_t), intent(in) :: s
      type(factors_t), intent(in) :: f
      real(wp), intent(in) :: rate(:)
      real(wp), intent(out) :: v(:, :)
      real(wp) :: b(s%n)

      b = 0.0_wp
      b(s%n - size(rate) + 1:) = rate
      call solve(f, b)
      v = 0.0_wp
      call add_to_links(s, b, v)
   end subroutine solve_velocity

   !> Accelerations `a` (3, links) from the second rates `acceleration` (drives) and the velocities `v` (3, links).
   subroutine solve_acceleration(s, f, p, acceleration, v, a)
      type(system_t), intent(in) :: s
      type(factors_t), intent(in) :: f
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: acceleration(:), v(:, :)
      real(wp), intent(out) :: a(:, :)
      real(wp) :: b(s%n)

      call remainder(s, p, v, b)
      b = -b
      associate (last => b(s%n - size(acceleration) + 1:))
         last = last + acceleration
      end associate
      call solve(f, b)
      a = 0.0_wp
      call add_to_links(s, b, a)
   end subroutine solve_acceleration
end module rates
