!> All closure equations as one block, x, y, phi of every link its unknowns: the form of the paper, by Newton
!> (METHOD DENSE) or by the iteration of 1987 (METHOD MATRIX). What the blocks are compared with.
!>
!> The first position is one near the estimate, or in the assembly that the blocks find from it: an iteration that goes
!> further falls where rounding lets it. Newton's method then begins again from there; that of 1987, which is repelled
!> from some assemblies, has found nothing.
module dense_engine
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_matrix, own_predictor
   use motion, only: motion_t, new_motion
   use linear_solver, only: factors_t, new_factors, reciprocal_condition, determinant_sign
   use convergence, only: convergence_t, is_solved, ended_elsewhere
   use predictor, only: largest_change, order_weights
   use pose, only: system_t, pose_t, new_system, new_pose
   use closure_equations, only: find_drive_values
   use position_iteration, only: solve_newton, solve_matrix
   use rates, only: solve_velocity, solve_acceleration
   use root_distance, only: coordinates_t, new_coordinates, distance, kantorovich, jacobian_lipschitz
   use dense_start, only: by_blocks, find_start
   use constants, only: without_turns
   implicit none
   private
   public :: dense_t, new_dense, solve_dense, accept_dense, get_dense_motion
   public :: dense_checkpoint_t, checkpoint_dense, restore_dense

   !> The position is known to eps/rcond, and so the Jacobian; below the root of eps no digit of a velocity is certain.
   real(wp), parameter :: min_condition = 4.0_wp*sqrt(epsilon(1.0_wp))
   !> A change over the distance of the next root, at least: below it the root is the only one as near, and near enough.
   real(wp), parameter :: certain = 0.5_wp
   !> What is certainly below this needs no closer look: doubts are of importance from 0.1 on.
   real(wp), parameter :: small_kantorovich_ratio = 1.0e-3_wp
   !> A change of more than this, in radians and in the unit of length, is a leap, as the blocks have it.
   real(wp), parameter :: branch_jump = 0.5_wp
   !> An iteration that goes further than this on its way wanders, and where it ends up is up to rounding.
   real(wp), parameter :: reach = largest_change
   !> Where the Jacobian has no inverse a position is known to the root of eps; a root this near is that position.
   real(wp), parameter :: same_place = min(1.0e4_wp*sqrt(epsilon(1.0_wp)), 1.0e-2_wp)

   !> Lengths in the system's unit.
   type :: dense_t
      type(system_t) :: system
      type(mechanism_t) :: blocks                !< to be solved by blocks, at the first instant
      type(coordinates_t) :: coordinates         !< whose changes the guard of continuity looks at
      type(pose_t) :: pose                       !< room for the position that is being sought
      real(wp), allocatable :: estimated(:, :)       !< (3, links) the deck's positions
      real(wp), allocatable :: start(:, :)       !< (3, links) where the last search began
      type(factors_t) :: factors
      type(motion_t) :: now                      !< the motion sought last
      type(motion_t) :: last                     !< the last one kept
      type(motion_t) :: before                   !< the one kept before, where the order is 3
      integer :: determinant_now = 0, determinant = 0
      real(wp), allocatable :: drive_values(:, :)     !< (3, drives) value, rate, second rate
      logical :: has_missed = .false.            !< the assembly meant at an earlier instant was not found
      integer :: method = 0, order = own_predictor
      real(wp) :: tolerance = 0.0_wp
   end type dense_t

   !> All that depends on the way so far: the motion that is followed, and that found last. No workspace.
   type :: dense_checkpoint_t
      type(motion_t) :: last, before, now
      integer :: determinant = 0, determinant_now = 0
   end type dense_checkpoint_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns.
   function new_dense(m) result(e)
      type(mechanism_t), intent(in) :: m
      type(dense_t) :: e

      e%system = new_system(m)
      e%pose = new_pose(e%system, m)
      e%blocks = by_blocks(m)
      e%coordinates = new_coordinates(e%system)
      e%estimated = e%pose%q
      e%start = e%estimated
      e%factors = new_factors(e%system%n)
      e%now = new_motion(size(m%links))
      e%last = e%now
      e%before = e%now
      allocate (e%drive_values(3, size(m%drives)))
      e%method = m%method
      e%order = m%predictor
      e%tolerance = m%tolerance
   end function new_dense

   !> Seeks the motion at `t`, from the last one kept (`follows`) or from the deck's. `c`: how it ended,
   !> `correction`: the largest change of the predicted coordinates, `same`: the determinant has kept its sign.
   subroutine solve_dense(e, t, follows, c, correction, same)
      type(dense_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: follows
      type(convergence_t), intent(out) :: c
      real(wp), intent(out) :: correction
      logical, intent(out) :: same

      e%now%t = t
      same = .true.
      call find_drive_values(e%system, t, e%drive_values)
      if (follows) then
         e%start = continued(e, t)
         same = maxval(abs(e%start - e%last%position)) <= largest_change
         if (same) call search(e, e%start, c)
      else
         call search_first(e, t, c)
      end if
      correction = maxval(abs(e%pose%q - e%start))
      if (.not. (same .and. is_solved(c))) return
      call solve_rates(e, c)
      if (follows .and. .not. c%singular) same = e%determinant_now == e%determinant
   end subroutine solve_dense

   !> The position by the method's iteration from `start` (3, links), and how far it is from there.
   subroutine search(e, start, c)
      type(dense_t), intent(inout) :: e
      real(wp), intent(in) :: start(:, :)
      type(convergence_t), intent(out) :: c

      e%pose%q = start
      if (e%method == method_matrix) then
         call solve_matrix(e%system, e%drive_values(1, :), e%tolerance, e%pose, e%factors, c, &
            reach)
      else
         call solve_newton(e%system, e%drive_values(1, :), e%tolerance, e%pose, e%factors, c, &
            reach)
      end if
      if (.not. is_solved(c)) return
      c%change = distance(e%system, e%coordinates, e%pose%q, start)
      call judge(e, c)
   end subroutine search

   !> Condition and sign of the Jacobian at the position found, and how certain it is that the root is the one that was
   !> predicted.
   subroutine judge(e, c)
      type(dense_t), intent(inout) :: e
      type(convergence_t), intent(inout) :: c
      real(wp) :: k

      if (c%singular) return
      call reciprocal_condition(e%factors, c%reciprocal_condition)
      c%determinant = determinant_sign(e%factors)
      c%singular = c%reciprocal_condition <= min_condition
      if (c%singular) return
      c%kantorovich_ratio = kantorovich_bound(e, c)
      if (c%kantorovich_ratio <= small_kantorovich_ratio) return
      call kantorovich(e%system, e%coordinates, e%factors, e%pose, k)
      c%kantorovich_ratio = c%change*k
   end subroutine judge

   !> More than the doubt, from the condition alone: no row sum of the inverse is more than n times its largest column
   !> sum, of which DGECON tells a third or more, and a slot has two rows.
   real(wp) function kantorovich_bound(e, c) result(kantorovich_ratio)
      type(dense_t), intent(in) :: e
      type(convergence_t), intent(in) :: c

      kantorovich_ratio = 0.0_wp
      if (c%change <= 0.0_wp) return
      kantorovich_ratio = 6.0_wp*c%change*real(e%system%n, wp)*maxval(jacobian_lipschitz(e%system, e%coordinates, &
         e%pose)) &
         /(c%reciprocal_condition*e%factors%norm)
   end function kantorovich_bound

   !> The first position, from the deck's estimate.
   subroutine search_first(e, t, c)
      type(dense_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(out) :: c
      real(wp) :: meant(3, size(e%estimated, 2)), unit(3, size(e%estimated, 2))
      logical :: is_known

      unit = spread([e%system%length, e%system%length, 1.0_wp], 2, size(unit, 2))
      e%start = e%estimated*unit
      call find_start(e%blocks, t, e%start, meant, is_known)
      e%start = e%start/unit
      call search(e, e%start, c)
      if (is_solved(c) .and. .not. c%singular .and. c%kantorovich_ratio <= certain) return
      if (is_known .and. .not. e%has_missed) then
         meant = meant/unit
         if (e%method /= method_matrix) call search(e, meant, c)
         if (is_solved(c)) call compare(e, meant, c)
         e%has_missed = .not. is_solved(c)
      else if (is_solved(c) .and. (c%change > branch_jump .or. e%has_missed)) then
         c%ended = ended_elsewhere
      end if
   end subroutine search_first

   !> Is the position found the assembly `meant` (3, links)? If so it gets its turns.
   subroutine compare(e, meant, c)
      type(dense_t), intent(inout) :: e
      real(wp), intent(in) :: meant(:, :)
      type(convergence_t), intent(inout) :: c
      real(wp) :: apart, k

      e%pose%q(3, :) = meant(3, :) + without_turns(e%pose%q(3, :) - meant(3, :))
      apart = distance(e%system, e%coordinates, e%pose%q, meant)
      if (c%singular) then
         if (apart > same_place) c%ended = ended_elsewhere
      else
         call kantorovich(e%system, e%coordinates, e%factors, e%pose, k)
         if (apart*k > certain) c%ended = ended_elsewhere
      end if
   end subroutine compare

   !> Velocities and accelerations at the position found, where the Jacobian has an inverse.
   subroutine solve_rates(e, c)
      type(dense_t), intent(inout) :: e
      type(convergence_t), intent(inout) :: c

      e%now%position = e%pose%q
      if (c%singular) return
      e%determinant_now = c%determinant
      call solve_velocity(e%system, e%factors, e%drive_values(2, :), e%now%velocity)
      call solve_acceleration(e%system, e%factors, e%pose, e%drive_values(3, :), e%now%velocity, e%now%acceleration)
   end subroutine solve_rates

   !> Makes the motion found last the one that is followed.
   pure subroutine accept_dense(e)
      type(dense_t), intent(inout) :: e

      if (e%order == 3 .and. e%determinant /= 0) then
         e%before = e%last
         e%before%known = 2
      end if
      e%last = e%now
      e%determinant = e%determinant_now
   end subroutine accept_dense

   !> Notes in `c` all that depends on the way so far.
   pure subroutine checkpoint_dense(e, c)
      type(dense_t), intent(in) :: e
      type(dense_checkpoint_t), intent(inout) :: c

      c%last = e%last
      c%before = e%before
      c%determinant = e%determinant
      c%now = e%now
      c%determinant_now = e%determinant_now
   end subroutine checkpoint_dense

   !> Makes the motion that was followed at the checkpoint `c` the one that is followed, and what was found last there
   !> what was found last; `keeps_found`: that stays as it is now.
   pure subroutine restore_dense(e, c, keeps_found)
      type(dense_t), intent(inout) :: e
      type(dense_checkpoint_t), intent(in) :: c
      logical, intent(in) :: keeps_found

      e%last = c%last
      e%before = c%before
      e%determinant = c%determinant
      if (keeps_found) return
      e%now = c%now
      e%determinant_now = c%determinant_now
   end subroutine restore_dense

   !> The motion found last, in the deck's units.
   pure subroutine get_dense_motion(e, found)
      type(dense_t), intent(in) :: e
      type(motion_t), intent(inout) :: found

      found%origin = e%system%origin
      found%position = e%now%position
      found%velocity = e%now%velocity
      found%acceleration = e%now%acceleration
      found%position(:2, :) = e%system%length*found%position(:2, :)
      found%velocity(:2, :) = e%system%length*found%velocity(:2, :)
      found%acceleration(:2, :) = e%system%length*found%acceleration(:2, :)
   end subroutine get_dense_motion

   !> The start at `t` (3, links): the state before, corrected through its velocity and acceleration, or by the order
   !> that is asked for.
   pure function continued(e, t) result(q)
      type(dense_t), intent(in) :: e
      real(wp), intent(in) :: t
      real(wp) :: q(3, size(e%last%position, 2)), w(3)

      associate (last => e%last, before => e%before)
         if (e%order == own_predictor) then
            q = last%position + (t - last%t)*(last%velocity + 0.5_wp*(t - last%t)*last%acceleration)
         else
            w = order_weights(e%order, t - last%t, merge(last%t - before%t, 0.0_wp, before%known == 2))
            q = last%position + w(1)*last%velocity + w(2)*last%acceleration &
               + w(3)*(last%acceleration - before%acceleration)
         end if
      end associate
   end function continued
end module dense_engine
