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

   !> The position is known to eps/rcond, and so the Jacobian; below the root of eps no digit of a velocity is certain.
   real(wp), parameter :: least_condition = 4.0_wp*sqrt(epsilon(1.0_wp))
   !> The largest correction, in the system's length and in radians, of a predicted position that is still taken for
   !> the continuation of the motion; where the prediction is off by more, the step is divided.
   real(wp), parameter :: largest_correction = 0.1_wp
   !> A part of a step smaller than this is the end of the way; and so are that many parts.
   real(wp), parameter :: smallest_part = 1.0e-10_wp
   integer, parameter :: most_parts = 2000

   !> Everything that is kept from one instant to the next; lengths in the system's unit.
   type :: analysis_t
      type(system_t) :: system
      type(pose_t) :: pose                       !< room for the position that is being sought
      real(wp), allocatable :: rough(:, :)       !< (3, links) the deck's positions
      real(wp), allocatable :: predicted(:, :)   !< (3, links) where the last search began
      type(factors_t) :: factors
      type(convergence_t) :: convergence         !< of the last position sought
      type(motion_t) :: last                     !< the last motion found whose Jacobian has an inverse
      integer :: determinant = 0                 !< the sign of its determinant
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
      a%pose = new_pose(a%system, m)
      a%rough = a%pose%q
      a%factors = new_factors(a%system%n)
      a%last = new_motion(size(m%links))
      allocate (a%targets(3, size(m%drives)))
      a%method = m%method
      a%tolerance = m%tolerance
   end function new_analysis

   !> Solves instant `t`; `found` is its motion in the deck's units, with what could not be found marked. The motion is
   !> followed from the last one found, in as many parts as that takes: an assembly is never changed in silence.
   subroutine advance(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      real(wp) :: part
      integer :: parts
      logical :: accepted, arrived

      part = t - a%last%t
      do parts = 1, most_parts
         arrived = a%last%known < 2 .or. abs(part) >= abs(t - a%last%t)
         found%t = merge(t, a%last%t + part, arrived)
         call attempt(a, found, accepted)
         arrived = arrived .and. accepted
         if (accepted .and. found%known == 2) call keep(a, found)
         if (arrived .or. a%last%known < 2) exit
         part = merge(1.5_wp, 0.5_wp, accepted .and. found%known == 2)*part
         if (abs(part) <= smallest_part*abs(t - a%last%t)) exit
      end do
      found%t = t
      if (.not. arrived) call cut(found, -1, mark_not_converged)
      call to_deck_units(a%system%length, found)
      call check_range(found)
   end subroutine advance

   !> Seeks the motion at `found%t`; `accepted`: it is the continuation of the last one, or the first.
   subroutine attempt(a, found, accepted)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      logical, intent(out) :: accepted
      logical :: follows

      follows = a%last%known == 2
      a%predicted = a%rough
      if (follows) a%predicted = continued(a%last, found%t)
      a%pose%q = a%predicted
      call drive_targets(a%system, found%t, a%targets)
      if (a%method == method_matrix) then
         call solve_matrix(a%system, a%targets(1, :), a%tolerance, a%pose, a%factors, a%convergence)
      else
         call solve_newton(a%system, a%targets(1, :), a%tolerance, a%pose, a%factors, a%convergence)
      end if
      accepted = is_solved(a%convergence)
      if (follows) accepted = accepted .and. all(abs(a%pose%q - a%predicted) <= largest_correction)
      if (.not. accepted) return
      call solve_rates(a, found)
      if (follows .and. found%known == 2) accepted = a%convergence%determinant == a%determinant
   end subroutine attempt

   !> Velocities and accelerations at the position found, where the Jacobian has an inverse.
   subroutine solve_rates(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found

      found%position = a%pose%q
      call cut(found, 0, mark_singular)
      if (a%convergence%singular) return
      call reciprocal_condition(a%factors, a%convergence%reciprocal_condition)
      a%convergence%determinant = determinant_sign(a%factors)
      if (a%convergence%reciprocal_condition <= least_condition) return
      call solve_velocity(a%system, a%factors, a%targets(2, :), found%velocity)
      call solve_acceleration(a%system, a%factors, a%pose, a%targets(3, :), found%velocity, found%acceleration)
      call cut(found, 2, mark_none)
      call check_range(found)
   end subroutine solve_rates

   !> Makes a regular motion the last one.
   pure subroutine keep(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(in) :: found

      a%last%t = found%t
      a%last%known = 2
      a%last%position = found%position
      a%last%velocity = found%velocity
      a%last%acceleration = found%acceleration
      a%determinant = a%convergence%determinant
   end subroutine keep

   !> The start at `t` (3, links): the state before, corrected through its velocity and acceleration.
   pure function continued(last, t) result(q)
      type(motion_t), intent(in) :: last
      real(wp), intent(in) :: t
      real(wp) :: q(3, size(last%position, 2))

      q = last%position + (t - last%t)*(last%velocity + 0.5_wp*(t - last%t)*last%acceleration)
   end function continued

   !> Marks a motion that holds a number beyond the range of the real kind.
   pure subroutine check_range(q)
      type(motion_t), intent(inout) :: q

      if (q%known >= 2 .and. .not. all(abs(q%acceleration) <= huge(1.0_wp))) call cut(q, 1, mark_overflow)
      if (q%known >= 1 .and. .not. all(abs(q%velocity) <= huge(1.0_wp))) call cut(q, 0, mark_overflow)
      if (q%known >= 0 .and. .not. all(abs(q%position) <= huge(1.0_wp))) call cut(q, -1, mark_overflow)
   end subroutine check_range

   !> Only derivatives up to number `known` exist, and `mark` says why.
   pure subroutine cut(q, known, mark)
      type(motion_t), intent(inout) :: q
      integer, intent(in) :: known, mark

      q%known = known
      q%mark = mark
   end subroutine cut

   !> Multiplies the lengths of a motion by the system's `length`.
   pure subroutine to_deck_units(length, q)
      real(wp), intent(in) :: length
      type(motion_t), intent(inout) :: q

      if (q%known >= 0) q%position(:2, :) = length*q%position(:2, :)
      if (q%known >= 1) q%velocity(:2, :) = length*q%velocity(:2, :)
      if (q%known >= 2) q%acceleration(:2, :) = length*q%acceleration(:2, :)
   end subroutine to_deck_units
end module analysis
