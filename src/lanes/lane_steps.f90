!> One instant in all lanes: predicted, solved and certified as `block_solver` and `continuation` do it. These look more
!> closely at some steps: a long substep, small pivots, a determinant of another sign, a Kantorovich ratio above the
!> largest, more than a few iterations, numbers out of range. Lanes do not: such a lane is refused, and the analysis
!> from which it came solves the instant. No lane depends on another.
module lane_steps
   use kinds, only: wp
   use predictor, only: largest_predicted_change, rate_weight, acceleration_weight
   use block_solver, only: suspicious_pivot
   use convergence, only: max_kantorovich_ratio
   use continuation, only: largest_correction
   use drive_path, only: drive_at
   use lane_sines, only: lane_count, max_angle
   use lane_elimination, only: max_order, make_room, correct, substitute, judge_factors
   use lane_state, only: lanes_t, lane_block_t, unknown_t, depth
   use lane_equations, only: set_lane_direction, find_lane_direct, find_lane_known, assemble_lanes, lane_accelerations
   implicit none
   private
   public :: step_check_t, solve_lanes, accept_lanes, keep_lane

   !> A lane that needs more iterations is refused.
   integer, parameter :: max_lane_iterations = 5

   !> The certificate of each lane's step.
   type :: step_check_t
      real(wp) :: refused(lane_count) = 0.0_wp      !< above 0: lanes cannot certify that it continues the motion
      real(wp) :: correction(lane_count) = 0.0_wp   !< largest correction of a predicted value, rad or unit of length
      real(wp) :: ratio(lane_count) = 0.0_wp        !< Kantorovich's ratio, without the excursions of the drives
      real(wp) :: amplification(lane_count) = 0.0_wp   !< of the ratio per excursion of the drives
   end type step_check_t

contains

   !> Solves all lanes at new times. A lane whose motion is not certified is refused.
   subroutine solve_lanes(lanes, t, check)
      type(lanes_t), intent(inout) :: lanes   !< with three motions each; get the motions at `t`
      real(wp), intent(in) :: t(lane_count)       !< times, each a step after the latest motion of its lane
      type(step_check_t), intent(out) :: check   !< of the step
      integer :: k, i

      call set_drives(lanes, t)
      call predict_lanes(lanes, t, check)
      do k = 1, size(lanes%moving)
         i = lanes%moving(k)
         if (lanes%blocks%list(i)%explicit) then
            call find_lane_direct(lanes, i)
         else
            call solve_block(lanes, i, lanes%blocks%list(i)%shape%n, check)
         end if
      end do
      ! These comparisons are false if something is no number.
      check%refused = check%refused + merge(0.0_wp, 1.0_wp, check%correction <= largest_correction) &
         + merge(0.0_wp, 1.0_wp, check%ratio + check%amplification*lanes%excursion <= max_kantorovich_ratio)
   end subroutine solve_lanes

   !> Finds value, rate and acceleration of the drives.
   subroutine set_drives(lanes, t)
      type(lanes_t), intent(inout) :: lanes   !< get the values at `t`
      real(wp), intent(in) :: t(lane_count)       !< a time of each lane
      integer :: i, lane

      do i = 1, size(lanes%unit, 2)
         if (lanes%is_polynomial) then
            associate (c => lanes%polynomial(:, :, i), unit => lanes%unit(:, i))
               lanes%drive(:, 0, i) = (c(:, 1) + t*(c(:, 2) + t*c(:, 3)/2.0_wp))*unit
               lanes%drive(:, 1, i) = (c(:, 2) + t*c(:, 3))*unit
               lanes%drive(:, 2, i) = c(:, 3)*unit
            end associate
         else
            do lane = 1, lane_count
               lanes%drive(lane, :, i) = drive_at(lanes%path(lane), i, t(lane))*lanes%unit(lane, i)
            end do
         end if
      end do
   end subroutine set_drives

   !> Predicts all unknowns that are iterated, from the last three motions, with the weights of `predictor`.
   subroutine predict_lanes(lanes, t, check)
      type(lanes_t), intent(inout) :: lanes   !< get values and directions at `t`
      real(wp), intent(in) :: t(lane_count)       !< a time of each lane
      type(step_check_t), intent(inout) :: check   !< gets lanes that are refused
      real(wp) :: step(lane_count)
      integer :: k, u

      step = t - lanes%t(:, lanes%slot(0))
      do k = 1, size(lanes%predicted)
         u = lanes%predicted(k)
         call predict_one(step, lanes%past(1, 1, lanes%slot(0), u), lanes%past(1, 1, lanes%slot(1), u), &
            lanes%past(1, 1, lanes%slot(2), u), lanes%u(u)%value, check%refused)
         call set_lane_direction(lanes, lanes%predicted(k))
      end do
   end subroutine predict_lanes

   !> Predicts an unknown from its last three motions. Too large a change is refused, and too large a value.
   pure subroutine predict_one(step, latest, second, third, values, refused)
      real(wp), intent(in) :: step(lane_count)       !< time from the latest motion
      real(wp), intent(in) :: latest(lane_count, 3)  !< value, rate, acceleration (rad or unit of length, unit of time)
      real(wp), intent(in) :: second(lane_count, 3)  !< of the motion before
      real(wp), intent(in) :: third(lane_count, 3)   !< of the motion before `second`
      real(wp), intent(inout) :: values(lane_count)  !< the prediction, in rad or the unit of length
      real(wp), intent(inout) :: refused(lane_count) !< above 0: the lane is refused
      real(wp) :: d
      integer :: l

      do l = 1, lane_count
         d = step(l)*(rate_weight(0)*latest(l, 2) + rate_weight(1)*second(l, 2) + rate_weight(2)*third(l, 2) &
            + step(l)*(acceleration_weight(0)*latest(l, 3) + acceleration_weight(1)*second(l, 3) &
            + acceleration_weight(2)*third(l, 3)))
         values(l) = latest(l, 1) + d
         refused(l) = refused(l) + merge(0.0_wp, 1.0_wp, abs(d) <= largest_predicted_change) &
            + merge(0.0_wp, 1.0_wp, abs(latest(l, 1) + d) <= max_angle)
      end do
   end subroutine predict_one

   !> Solves a block in all lanes: position, velocities, accelerations. The sources are equations.inc and, of the
   !> elimination, `lane_elimination`.
   subroutine solve_block(lanes, i, n, check)
      type(lanes_t), intent(inout) :: lanes   !< with predicted values; get the motion of the block
      integer, intent(in) :: i               !< the number of the block
      integer, intent(in) :: n               !< the number of its unknowns
      type(step_check_t), intent(inout) :: check   !< gets the certificate of the block
      ! Of fixed size: arrays that are made for each block take longer than its elimination.
      real(wp) :: a(lane_count, max_order**2), d(lane_count, max_order), v(lane_count, max_order), &
         exchanged(lane_count), start(lane_count, max_order), change(lane_count)
      integer :: k

      do k = 1, n
         start(:, k) = lanes%u(lanes%blocks%unknown(lanes%blocks%list(i)%first + k - 1))%value
      end do
      call find_lane_known(lanes, i)
      call iterate(lanes, i, n, start, a, d, v, exchanged, check)
      change = 0.0_wp

      do k = 1, n
         associate (u => lanes%blocks%unknown(lanes%blocks%list(i)%first + k - 1))
            call turn(u <= lanes%blocks%orientations, d(1, k), v(1, k), start(1, k), lanes%u(u), change)
         end associate
      end do
      call certify_lanes(n, a, exchanged, change, lanes%slot(0), lanes%slot(depth - 1), lanes%block(i), check)
      call lane_accelerations(lanes, i, n, v)
      call substitute(a, exchanged, v)
      do k = 1, n
         lanes%u(lanes%blocks%unknown(lanes%blocks%list(i)%first + k - 1))%acceleration = v(:, k)
      end do
   end subroutine solve_block

   !> Iterates in all lanes by Newton's method. Lanes that are done keep their values: their results do not depend on
   !> how long the others take. A lane that needs too many iterations is refused.
   subroutine iterate(lanes, i, n, start, a, corrections, right_sides, exchanged, check)
      type(lanes_t), intent(inout) :: lanes   !< with predicted values and directions; get the last ones
      integer, intent(in) :: i                                   !< the number of the block
      integer, intent(in) :: n                                   !< the number of its unknowns
      real(wp), intent(in) :: start(lane_count, n)                    !< the predicted values, rad or unit of length
      real(wp), intent(inout) :: a(lane_count, max_order**2)          !< the factors of the last Jacobian
      real(wp), intent(inout) :: corrections(lane_count, max_order)   !< the last ones, not applied yet
      real(wp), intent(inout) :: right_sides(lane_count, max_order)   !< the velocities
      real(wp), intent(inout) :: exchanged(lane_count)                !< 1: the two rows were exchanged; otherwise 0
      type(step_check_t), intent(inout) :: check   !< gets lanes that are refused
      real(wp) :: u(lane_count, max_order), going(lane_count)
      integer :: iteration, k

      u(:, :n) = start
      if (n == 1) call make_room(u, a, corrections, right_sides)
      do iteration = 1, max_lane_iterations
         do k = 1, merge(0, n, iteration == 1)
            associate (unknown => lanes%blocks%unknown(lanes%blocks%list(i)%first + k - 1))
               u(:, k) = u(:, k) - merge(corrections(:, k), 0.0_wp, going > 0.5_wp)
               lanes%u(unknown)%value = u(:, k)
               call set_lane_direction(lanes, unknown)
            end associate
         end do
         call assemble_lanes(lanes, i, n, a, corrections, right_sides)
         call correct(lanes%block(i)%coarse, u, a, exchanged, corrections, right_sides, going)
         if (sum(going) < 0.5_wp) return
         going = merge(going, 0.0_wp, check%refused < 0.5_wp)
         if (sum(going) < 0.5_wp) return
      end do
      check%refused = check%refused + going
   end subroutine iterate

   !> Applies the last correction of an unknown and its rate. The direction of an angle turns by the correction: the
   !> square of the correction is lost in rounding.
   pure subroutine turn(is_angle, correction, rate, start, unknown, change)
      logical, intent(in) :: is_angle            !< the unknown is an angle
      real(wp), intent(in) :: correction(lane_count)  !< to be subtracted, rad or unit of length
      real(wp), intent(in) :: rate(lane_count)        !< rad or unit of length, per unit of time
      real(wp), intent(in) :: start(lane_count)       !< the predicted value, rad or unit of length
      type(unknown_t), intent(inout) :: unknown   !< gets value, rate and direction
      real(wp), intent(inout) :: change(lane_count)   !< the largest |correction| of a prediction in the block so far
      real(wp) :: x
      integer :: l

      do l = 1, lane_count
         x = unknown%value(l) - correction(l)
         unknown%value(l) = x
         unknown%rate(l) = rate(l)
         change(l) = max(change(l), abs(x - start(l)))
      end do
      if (.not. is_angle) return
      do l = 1, lane_count
         x = unknown%c(l)
         unknown%c(l) = x + correction(l)*unknown%s(l)
         unknown%s(l) = unknown%s(l) - correction(l)*x
      end do
   end subroutine turn

   !> Refuses a lane if a pivot is too small compared with the largest, or if the determinant has another sign than
   !> before: as `block_solver` and the continuation refuse an instant. Adds the block to the certificate of the step.
   pure subroutine certify_lanes(n, a, exchanged, change, before, next, block, check)
      integer, intent(in) :: n                          !< the number of unknowns of the block
      integer, intent(in) :: before                     !< the slot of the latest motion
      integer, intent(in) :: next                       !< the slot of the motion that is judged
      real(wp), intent(in) :: a(lane_count, max_order**2)    !< the factors of its Jacobian
      real(wp), intent(in) :: exchanged(lane_count)          !< 1: the two rows were exchanged; otherwise 0
      real(wp), intent(in) :: change(lane_count)             !< the largest |correction| of a prediction in the block
      type(lane_block_t), intent(inout) :: block   !< gets pivot and inverse of the motion
      type(step_check_t), intent(inout) :: check   !< gets the certificate of the block
      real(wp) :: largest(lane_count), sign_of(lane_count)
      integer :: l

      call judge_factors(a, exchanged, block%pivot(1, next), largest, sign_of, block%inverse(1, next))
      ! One equation has no other pivot to compare with.
      if (n == 1) largest = block%lipschitz
      do l = 1, lane_count
         check%refused(l) = check%refused(l) + merge(0.0_wp, 1.0_wp, sign_of(l)*block%sign_of(l) > 0.0_wp) &
            + merge(0.0_wp, 1.0_wp, block%pivot(l, next) >= suspicious_pivot*max(largest(l), 1.0_wp))
         check%correction(l) = max(check%correction(l), change(l))
         check%ratio(l) = max(check%ratio(l), change(l)*block%lipschitz(l)*block%inverse(l, next))
         check%amplification(l) = max(check%amplification(l), &
            block%lipschitz(l)*max(block%inverse(l, next), block%inverse(l, before))**2)
      end do
   end subroutine certify_lanes

   !> Makes the motions found last the latest of their lanes.
   subroutine accept_lanes(lanes, t)
      type(lanes_t), intent(inout) :: lanes   !< with the motions found last
      real(wp), intent(in) :: t(lane_count)       !< times of these motions
      integer :: k, u

      lanes%slot = [lanes%slot(depth - 1), lanes%slot(:depth - 2)]
      lanes%t(:, lanes%slot(0)) = t
      do k = 1, size(lanes%predicted)
         u = lanes%predicted(k)
         lanes%past(:, 1, lanes%slot(0), u) = lanes%u(u)%value
         lanes%past(:, 2, lanes%slot(0), u) = lanes%u(u)%rate
         lanes%past(:, 3, lanes%slot(0), u) = lanes%u(u)%acceleration
      end do
   end subroutine accept_lanes

   !> Puts a lane back to its latest motion, as if the latest motion had been found last.
   subroutine keep_lane(lanes, lane)
      type(lanes_t), intent(inout) :: lanes   !< with a latest motion of the lane
      integer, intent(in) :: lane            !< the number of the lane
      integer :: k, u

      do k = 1, size(lanes%predicted)
         u = lanes%predicted(k)
         lanes%u(u)%value(lane) = lanes%past(lane, 1, lanes%slot(0), u)
         lanes%u(u)%rate(lane) = lanes%past(lane, 2, lanes%slot(0), u)
         lanes%u(u)%acceleration(lane) = lanes%past(lane, 3, lanes%slot(0), u)
      end do
      associate (next => lanes%slot(depth - 1))
         do k = 1, size(lanes%block)
            lanes%block(k)%pivot(lane, next) = lanes%block(k)%pivot(lane, lanes%slot(0))
            lanes%block(k)%inverse(lane, next) = lanes%block(k)%inverse(lane, lanes%slot(0))
         end do
      end associate
   end subroutine keep_lane
end module lane_steps
