!> Level 11. The analysis of one set of computations, instant by instant: position, then velocity, then acceleration.
module analysis
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_matrix
   use motion, only: motion_t, new_motion, mark_none, mark_not_converged, mark_singular, mark_overflow
   use linear_solver, only: factors_t, new_factors, reciprocal_condition, determinant_sign
   use convergence, only: convergence_t, is_solved
   use pose, only: system_t, pose_t, new_system, new_pose
   use drive_rows, only: drive_targets
   use position_newton, only: solve_newton
   use position_matrix, only: solve_matrix
   use rates, only: solve_velocity, solve_acceleration
   implicit none
   private
   public :: analysis_t, new_analysis, advance

   !> Below this reciprocal condition no digit of a velocity is certain.
   real(wp), parameter :: least_condition = 4.0_wp*epsilon(1.0_wp)

   !> Everything that is kept from one instant to the next; lengths in the system's unit.
   type :: analysis_t
      type(system_t) :: system
      type(pose_t) :: start                      !< the last position found, or the deck's rough one
      type(factors_t) :: factors
      type(convergence_t) :: convergence         !< of the last instant
      type(motion_t) :: last                     !< the last motion found, in the system's unit
      real(wp), allocatable :: targets(:, :)     !< (3, drives) value, rate, second rate
      integer :: method = 0
      real(wp) :: tolerance = 0.0_wp
   end type analysis_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns.
   function new_analysis(m) result(a)
      type(mechanism_t), intent(in) :: m
      type(analysis_t) :: a

      a%system = new_system(m)
      a%start = new_pose(a%system, m)
      a%factors = new_factors(a%system%n)
      a%last = new_motion(size(m%links))
      allocate (a%targets(3, size(m%drives)))
      a%method = m%method
      a%tolerance = m%tolerance
   end function new_analysis

   !> Solves instant `t`; `found` is its motion in the deck's units, with what could not be found marked.
   subroutine advance(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(pose_t) :: p

      p = a%start
      call predict(a%last, t, p%q)
      call drive_targets(a%system, t, a%targets)
      if (a%method == method_matrix) then
         call solve_matrix(a%system, a%targets(1, :), a%tolerance, p, a%factors, a%convergence)
      else
         call solve_newton(a%system, a%targets(1, :), a%tolerance, p, a%factors, a%convergence)
      end if
      found%t = t
      found%known = -1
      found%mark = mark_not_converged
      if (.not. is_solved(a%convergence)) return
      call solve_rates(a, p, t)
      a%start%q = p%q
      found%mark = a%last%mark
      found%known = a%last%known
      call in_deck_units(a%system%length, a%last, found)
      call check_range(found)
   end subroutine advance

   !> Marks a motion that holds a number beyond the range of the real kind.
   pure subroutine check_range(q)
      type(motion_t), intent(inout) :: q

      if (q%known >= 2 .and. .not. all(abs(q%acceleration) <= huge(1.0_wp))) call cut(q, 1)
      if (q%known >= 1 .and. .not. all(abs(q%velocity) <= huge(1.0_wp))) call cut(q, 0)
      if (q%known >= 0 .and. .not. all(abs(q%position) <= huge(1.0_wp))) call cut(q, -1)
   end subroutine check_range

   !> Only derivatives up to number `known` exist.
   pure subroutine cut(q, known)
      type(motion_t), intent(inout) :: q
      integer, intent(in) :: known

      q%known = known
      q%mark = mark_overflow
   end subroutine cut

   !> The start of the next step: the state before, corrected through its velocity and acceleration.
   pure subroutine predict(last, t, q)
      type(motion_t), intent(in) :: last
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: q(:, :)

      if (last%known < 2) return
      q = last%position + (t - last%t)*(last%velocity + 0.5_wp*(t - last%t)*last%acceleration)
   end subroutine predict

   !> Velocities and accelerations at the position found, where the Jacobian has an inverse.
   subroutine solve_rates(a, p, t)
      type(analysis_t), intent(inout) :: a
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: t

      a%last%t = t
      a%last%position = p%q
      a%last%known = 0
      a%last%mark = mark_singular
      if (.not. a%convergence%singular) then
         call reciprocal_condition(a%factors, a%convergence%reciprocal_condition)
         a%convergence%determinant = determinant_sign(a%factors)
      end if
      if (a%convergence%reciprocal_condition <= least_condition) return
      call solve_velocity(a%system, a%factors, a%targets(2, :), a%last%velocity)
      call solve_acceleration(a%system, a%factors, p, a%targets(3, :), a%last%velocity, a%last%acceleration)
      a%last%known = 2
      a%last%mark = mark_none
   end subroutine solve_rates

   !> Copies a motion, its lengths multiplied by the system's `length`.
   pure subroutine in_deck_units(length, inner, outer)
      real(wp), intent(in) :: length
      type(motion_t), intent(in) :: inner
      type(motion_t), intent(inout) :: outer
      integer :: i

      outer%position = inner%position
      outer%velocity = inner%velocity
      outer%acceleration = inner%acceleration
      do i = 1, 2
         outer%position(i, :) = length*outer%position(i, :)
         outer%velocity(i, :) = length*outer%velocity(i, :)
         outer%acceleration(i, :) = length*outer%acceleration(i, :)
      end do
   end subroutine in_deck_units
end module analysis
