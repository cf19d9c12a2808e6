!> One instant in all lanes: predicted, solved, certified as `block_solver` and `following` do it. Whatever these would
!> look at more closely (a long substep, small pivots, another sign of a determinant, a Kantorovich ratio above the
!> largest, more than a few iterations, numbers out of range) is no matter for lanes: such a lane is refused, and the
!> engine from which it came solves that instant. Lanes never look at one another.
module lane_steps
   use kinds, only: wp
   use predictor, only: largest_change, weight, weight2
   use block_solver, only: suspicious_pivot
   use convergence, only: max_kantorovich_ratio
   use following, only: largest_correction
   use drive_path, only: drive_at
   use lane_sines, only: width, max_angle
   use lane_elimination, only: max_order, make_room, correct, substitute, judge_factors
   use lane_state, only: lanes_t, lane_block_t, unknown_t, depth
   use lane_equations, only: set_lane_direction, find_lane_direct, find_lane_known, assemble_lanes, lane_accelerations
   implicit none
   private
   public :: step_check_t, solve_lanes, accept_lanes, keep_lane

   !> What takes more iterations is refused.
   integer, parameter :: max_iterations = 5
   !> What each lane's motion is worth.
   type :: step_check_t
      real(wp) :: refused(width) = 0.0_wp      !< above 0: it is no continuation that lanes can certify
      real(wp) :: correction(width) = 0.0_wp   !< the largest change of a predicted value, rad or unit of length
      real(wp) :: ratio(width) = 0.0_wp        !< Kantorovich's, without the excursions of the drives
      real(wp) :: growth(width) = 0.0_wp       !< of that ratio with them
   end type step_check_t

contains

   !> Solves all lanes at the times `t`, each a step after its latest motion.
   subroutine solve_lanes(l, t, j)
      type(lanes_t), intent(inout) :: l
      real(wp), intent(in) :: t(width)
      type(step_check_t), intent(out) :: j
      integer :: k, i

      call set_drives(l, t)
      call predict_lanes(l, t, j)
      do k = 1, size(l%moving)
         i = l%moving(k)
         if (l%blocks%list(i)%direct) then
            call find_lane_direct(l, i)
         else
            call solve_block(l, i, l%blocks%list(i)%shape%n, j)
         end if
      end do
      ! Comparisons that are false where something is no number.
      j%refused = j%refused + merge(0.0_wp, 1.0_wp, j%correction <= largest_correction) &
         + merge(0.0_wp, 1.0_wp, j%ratio + j%growth*l%excursion <= max_kantorovich_ratio)
   end subroutine solve_lanes

   !> Value, rate and acceleration of the drives.
   subroutine set_drives(l, t)
      type(lanes_t), intent(inout) :: l
      real(wp), intent(in) :: t(width)
      integer :: i, lane

      do i = 1, size(l%unit, 2)
         if (l%is_polynomial) then
            associate (c => l%polynomial(:, :, i), unit => l%unit(:, i))
               l%drive(:, 0, i) = (c(:, 1) + t*(c(:, 2) + t*c(:, 3)/2.0_wp))*unit
               l%drive(:, 1, i) = (c(:, 2) + t*c(:, 3))*unit
               l%drive(:, 2, i) = c(:, 3)*unit
            end associate
         else
            do lane = 1, width
               l%drive(lane, :, i) = drive_at(l%path(lane), i, t(lane))*l%unit(lane, i)
            end do
         end if
      end do
   end subroutine set_drives

   !> The values expected at `t` of all unknowns that are iterated: see `predictor`.
   subroutine predict_lanes(l, t, j)
      type(lanes_t), intent(inout) :: l
      real(wp), intent(in) :: t(width)
      type(step_check_t), intent(inout) :: j
      real(wp) :: step(width)
      integer :: k, u

      step = t - l%t(:, l%slot(0))
      do k = 1, size(l%predicted)
         u = l%predicted(k)
         call predict_one(step, l%past(1, 1, l%slot(0), u), l%past(1, 1, l%slot(1), u), l%past(1, 1, l%slot(2), u), &
            l%u(u)%value, j%refused)
         call set_lane_direction(l, l%predicted(k))
      end do
   end subroutine predict_lanes

   !> The value `u`, from the motions `p` (latest), `q` and `r`; too large a change is refused, and too large a value.
   pure subroutine predict_one(step, p, q, r, u, refused)
      real(wp), intent(in) :: step(width), p(width, 3), q(width, 3), r(width, 3)
      real(wp), intent(inout) :: u(width), refused(width)
      real(wp) :: d
      integer :: l

      do l = 1, width
         d = step(l)*(weight(0)*p(l, 2) + weight(1)*q(l, 2) + weight(2)*r(l, 2) &
            + step(l)*(weight2(0)*p(l, 3) + weight2(1)*q(l, 3) + weight2(2)*r(l, 3)))
         u(l) = p(l, 1) + d
         refused(l) = refused(l) + merge(0.0_wp, 1.0_wp, abs(d) <= largest_change) &
            + merge(0.0_wp, 1.0_wp, abs(p(l, 1) + d) <= max_angle)
      end do
   end subroutine predict_one

   !> Solves block `i`, of `n` unknowns: position, velocities, accelerations.
   subroutine solve_block(l, i, n, j)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n
      type(step_check_t), intent(inout) :: j
      ! Of fixed size: what has to be made for each block takes longer than its elimination.
      real(wp) :: a(width, max_order**2), d(width, max_order), v(width, max_order), exchanged(width), &
         start(width, max_order), change(width)
      integer :: k

      do k = 1, n
         start(:, k) = l%u(l%blocks%unknown(l%blocks%list(i)%first + k - 1))%value
      end do
      call find_lane_known(l, i)
      call iterate(l, i, n, start, a, d, v, exchanged, j)
      change = 0.0_wp
      do k = 1, n
         associate (u => l%blocks%unknown(l%blocks%list(i)%first + k - 1))
            call turn(u <= l%blocks%orientations, d(1, k), v(1, k), start(1, k), l%u(u), change)
         end associate
      end do
      call judge(n, a, exchanged, change, l%slot(0), l%slot(depth - 1), l%block(i), j)
      call lane_accelerations(l, i, n, v)
      call substitute(a, exchanged, v)
      do k = 1, n
         l%u(l%blocks%unknown(l%blocks%list(i)%first + k - 1))%acceleration = v(:, k)
      end do
   end subroutine solve_block

   !> Newton's method in all lanes, from the values `start`. Those that are done keep their values, so that what comes
   !> after their last iteration is the same however long the others take: `a`: the factors, `d`: the last corrections,
   !> not applied yet, `v`: the velocities.
   subroutine iterate(l, i, n, start, a, d, v, exchanged, j)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n
      real(wp), intent(in) :: start(width, n)
      real(wp), intent(inout) :: a(width, max_order**2), d(width, max_order), v(width, max_order), exchanged(width)
      type(step_check_t), intent(inout) :: j
      real(wp) :: u(width, max_order), going(width)
      integer :: iteration, k

      u(:, :n) = start
      if (n == 1) call make_room(u, a, d, v)
      do iteration = 1, max_iterations
         do k = 1, merge(0, n, iteration == 1)
            associate (unknown => l%blocks%unknown(l%blocks%list(i)%first + k - 1))
               u(:, k) = u(:, k) - merge(d(:, k), 0.0_wp, going > 0.5_wp)
               l%u(unknown)%value = u(:, k)
               call set_lane_direction(l, unknown)
            end associate
         end do
         call assemble_lanes(l, i, n, a, d, v)
         call correct(l%block(i)%coarse, u, a, exchanged, d, v, going)
         if (sum(going) < 0.5_wp) return
         going = merge(going, 0.0_wp, j%refused < 0.5_wp)
         if (sum(going) < 0.5_wp) return
      end do
      j%refused = j%refused + going
   end subroutine iterate

   !> Applies the last correction `d` of an unknown, an angle or not, and its rate `v`; `change`: the largest from its
   !> `start`.
   pure subroutine turn(is_angle, d, v, start, u, change)
      logical, intent(in) :: is_angle
      real(wp), intent(in) :: d(width), v(width), start(width)
      type(unknown_t), intent(inout) :: u
      real(wp), intent(inout) :: change(width)
      real(wp) :: x
      integer :: l

      do l = 1, width
         x = u%value(l) - d(l)
         u%value(l) = x
         u%rate(l) = v(l)
         change(l) = max(change(l), abs(x - start(l)))
      end do
      if (.not. is_angle) return
      do l = 1, width
         x = u%c(l)
         u%c(l) = x + d(l)*u%s(l)
         u%s(l) = u%s(l) - d(l)*x
      end do
   end subroutine turn

   !> Refuses lanes that have too small a pivot, compared with the largest, or a determinant of another sign than
   !> before, as `judge` of `block_solver` and the continuation refuse an instant. `change`: of the values of `block`,
   !> from the motion in the slot `before` to that in the slot `next`.
   pure subroutine judge(n, a, exchanged, change, before, next, block, j)
      integer, intent(in) :: n, before, next
      real(wp), intent(in) :: a(width, max_order**2), exchanged(width), change(width)
      type(lane_block_t), intent(inout) :: block
      type(step_check_t), intent(inout) :: j
      real(wp) :: largest(width), sign_of(width)
      integer :: l

      call judge_factors(a, exchanged, block%pivot(1, next), largest, sign_of, block%inverse(1, next))
      ! One equation has no other pivot to compare with.
      if (n == 1) largest = block%lipschitz
      do l = 1, width
         j%refused(l) = j%refused(l) + merge(0.0_wp, 1.0_wp, sign_of(l)*block%sign_of(l) > 0.0_wp) &
            + merge(0.0_wp, 1.0_wp, block%pivot(l, next) >= suspicious_pivot*max(largest(l), 1.0_wp))
         j%correction(l) = max(j%correction(l), change(l))
         j%ratio(l) = max(j%ratio(l), change(l)*block%lipschitz(l)*block%inverse(l, next))
         j%growth(l) = max(j%growth(l), block%lipschitz(l)*max(block%inverse(l, next), block%inverse(l, before))**2)
      end do
   end subroutine judge

   !> The motions found last, at `t`, are now the latest of their lanes.
   subroutine accept_lanes(l, t)
      type(lanes_t), intent(inout) :: l
      real(wp), intent(in) :: t(width)
      integer :: k, u

      l%slot = [l%slot(depth - 1), l%slot(:depth - 2)]
      l%t(:, l%slot(0)) = t
      do k = 1, size(l%predicted)
         u = l%predicted(k)
         l%past(:, 1, l%slot(0), u) = l%u(u)%value
         l%past(:, 2, l%slot(0), u) = l%u(u)%rate
         l%past(:, 3, l%slot(0), u) = l%u(u)%acceleration
      end do
   end subroutine accept_lanes

   !> Puts `lane` back to its latest motion, as if that had been found last.
   subroutine keep_lane(l, lane)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: lane
      integer :: k, u

      do k = 1, size(l%predicted)
         u = l%predicted(k)
         l%u(u)%value(lane) = l%past(lane, 1, l%slot(0), u)
         l%u(u)%rate(lane) = l%past(lane, 2, l%slot(0), u)
         l%u(u)%acceleration(lane) = l%past(lane, 3, l%slot(0), u)
      end do
      associate (next => l%slot(depth - 1))
         do k = 1, size(l%block)
            l%block(k)%pivot(lane, next) = l%block(k)%pivot(lane, l%slot(0))
            l%block(k)%inverse(lane, next) = l%block(k)%inverse(lane, l%slot(0))
         end do
      end associate
   end subroutine keep_lane
end module lane_steps
