!> The prediction of the next position from the motions before: the initial guess of Newton's method.
!>
!> From one motion:  x + h (v + h a/2), error h^3 x'''/6.
!> From three at equal steps h, latest first: the integral over the next step of the quintic that has their velocities
!> and accelerations (Hermite),
!>    x_0 + h (-949 v_0 + 608 v_1 + 581 v_2)/240 + h^2 (637 a_0 + 1080 a_1 + 173 a_2)/240,  error 0.0112 h^7 x^(7).
!> Rejected: a polynomial through earlier positions as well. It gains an order, but brings their rounding back
!> many times over, and a guess that is wrong only by rounding costs a second factorization. Rejected, too: four
!> motions instead of three, with an error of 0.00291 h^9 x^(9): steps of a degree then need 1.0 iterations instead of
!> 1.6, but take as long to 3 per cent, and so do steps of ten degrees.
!>
!> Near a change point rounding spoils accelerations, and the first of these formulas takes an earlier one.
!>
!> For comparison (--study) the order can be given: 0 takes x_0 only, 1 its velocity as well, 2 its acceleration as
!> well, 3 the third derivative as well, as the difference of two accelerations.
module predictor
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: own_predictor
   use drive_path, only: drive_path_t
   use convergence, only: solve_report_t
   use blocks, only: blocks_t, geometry_t, own_unknowns
   use block_state, only: unknown_t, state_t, jacobian_t, set_drive_values, set_direction, set_values, &
      largest_drive_rate
   use block_solver, only: solve_explicit
   use block_rank, only: jacobian_of, relative_sign
   implicit none
   private
   public :: history_t, new_history, begin_at, accept, predict, compare, recall, has_equal_steps, &
      largest_predicted_change, order_weights

   !> The largest predicted change, in radians and units of the loop, that one step may have. A larger predicted change
   !> may end at another assembly and still look right.
   real(wp), parameter :: largest_predicted_change = 1.0_wp
   !> Weights of velocities and of accelerations in the formula for three motions, the latest first.
   real(wp), parameter, public :: rate_weight(0:2) = [-949.0_wp, 608.0_wp, 581.0_wp]/240.0_wp
   real(wp), parameter, public :: acceleration_weight(0:2) = [637.0_wp, 1080.0_wp, 173.0_wp]/240.0_wp
   !> An acceleration does not serve a prediction if it makes more than this part of the change uncertain: such a start
   !> could come nearer to another branch than to its own.
   real(wp), parameter :: max_uncertain_part = 0.01_wp
   !> Accelerations that are uncertain by less than this part of the largest count as certain.
   real(wp), parameter :: certain_acceleration_part = 0.01_wp
   !> With a larger pivot no acceleration is so uncertain by rounding that a substep depends on it.
   real(wp), parameter :: safe_pivot = epsilon(1.0_wp)**0.2_wp
   !> Steps that differ by less than this part count as equal: instants are rounded too.
   real(wp), parameter :: equal_step_part = max(1.0e-6_wp, 4096.0_wp*epsilon(1.0_wp))

   !> One unknown in the last three motions: the latest of its values; rates and accelerations by `slot` of `history_t`.
   type :: unknown_history_t
      !> In rad or the unit of the loop, by time and its square.
      real(wp) :: value = 0.0_wp, rate(0:2) = 0.0_wp, acceleration(0:2) = 0.0_wp
   end type unknown_history_t

   !> The last three motions accepted, and the findings from the Jacobians of the latest.
   type :: history_t
      integer, allocatable :: predicted(:)              !< numbers of the unknowns that iterations solve for
      integer :: order = own_predictor                  !< of predictions, 0 to 3; own_predictor: the highest possible
      integer :: filled = 0                             !< how many motions there are, 0 to 3
      integer :: slot(0:2) = [0, 1, 2]                  !< where `past` has the motions, the latest first
      real(wp) :: t(0:2) = 0.0_wp                       !< their parameters of the path (time), the latest first
      real(wp) :: uncertain(0:2) = 0.0_wp               !< uncertainty of their accelerations over velocities, 1/time
      type(unknown_history_t), allocatable :: past(:)   !< (0:unknowns) only those of `predicted` are set
      type(jacobian_t), allocatable :: jacobian(:)      !< (blocks) of the latest motion
      real(wp), allocatable :: entries(:)               !< (rows*n) the latest Jacobian of a block with too many rows
   end type history_t

contains

   !> Makes the history before the first motion, which is empty.
   pure function new_history(b, order) result(h)
      type(blocks_t), intent(in) :: b                   !< with the blocks that move
      integer, intent(in) :: order                      !< of predictions, 0 to 3, or own_predictor
      type(history_t) :: h

      h%predicted = iterated_unknowns(b, b%moving)
      h%order = order
      allocate (h%past(0:b%unknowns), h%jacobian(size(b%list)))
   end function new_history

   !> Makes a motion the latest motion of a history, with its Jacobians and the uncertainty of its accelerations.
   subroutine accept(b, x, s, history)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s                    !< the motion
      type(history_t), intent(inout) :: history   !< the motions before
      real(wp) :: uncertain, least
      integer :: k

      if (history%filled == 0) history%jacobian = s%jacobian
      call copy_jacobians(size(b%moving), b%moving, s%jacobian, history%jacobian, least)
      uncertain = 0.0_wp
      if (least <= safe_pivot) then
         do k = 1, size(b%moving)
            uncertain = max(uncertain, uncertain_part(b, x, b%moving(k), history%jacobian(b%moving(k))%pivot, s))
         end do
      end if
      call record_motion(history, s%t, s%u, uncertain)
      if (b%redundant > 0) history%entries = jacobian_of(b, x, 1, s)
   end subroutine accept

   !> Copies the findings from the Jacobians of a motion and finds the least pivot. Reason for plain arrays: each step
   !> does it, and descriptors cost time.
   pure subroutine copy_jacobians(n, list, found, kept, least)
      integer, intent(in) :: n                          !< the length of the list
      integer, intent(in) :: list(n)                    !< numbers of the blocks
      type(jacobian_t), intent(in) :: found(*)          !< (blocks) of the motion
      type(jacobian_t), intent(inout) :: kept(*)        !< (blocks) the copy; blocks not in the list stay
      real(wp), intent(out) :: least                    !< the least |pivot| of these blocks; huge without blocks
      integer :: k

      least = huge(least)
      do k = 1, n
         kept(list(k)) = found(list(k))
         least = min(least, found(list(k))%pivot)
      end do
   end subroutine copy_jacobians

   !> Compares a motion with the latest motion of a history: whether determinants keep their signs, and how much its
   !> Kantorovich ratio grows with the excursion of the drives.
   subroutine compare(b, x, list, history, s, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in), contiguous :: list(:)        !< (any number) numbers of the blocks that were solved
      type(history_t), intent(in) :: history   !< the motions before
      type(state_t), intent(inout) :: s                 !< the motion; `crossed` of the blocks is set
      !> Of the motion: determinant_signs_kept becomes false if a block has crossed; amplification is raised.
      type(solve_report_t), intent(inout) :: convergence
      logical :: crosses
      integer :: k

      if (allocated(history%entries)) then
         s%jacobian(1)%sign_of = history%jacobian(1)%sign_of*relative_sign(b, x, 1, history%entries, s)
         convergence%determinant = product(s%jacobian(list)%sign_of)
      end if
      call compare_signs(size(list), list, history%jacobian, s%jacobian, s%is_singular, s%crossed, crosses)
      if (crosses) convergence%determinant_signs_kept = .false.
      if (.not. s%excursion > 0.0_wp) return
      do k = 1, size(list)
         associate (i => list(k))
            if (.not. s%is_singular(i)) convergence%amplification = max(convergence%amplification, &
               x%blocks(i)%lipschitz*max(s%jacobian(i)%inverse, history%jacobian(i)%inverse)**2)
         end associate
      end do
   end subroutine compare

   !> Finds which blocks of a list have crossed a change point: the signs of their determinants have changed. At a
   !> change point itself the sign is random, and the block has not crossed.
   pure subroutine compare_signs(n, list, before, now, is_singular, crossed, crosses)
      integer, intent(in) :: n                          !< the length of the list
      integer, intent(in) :: list(n)                    !< numbers of the blocks
      type(jacobian_t), intent(in) :: before(*), now(*) !< (blocks) of the motion before and of this motion
      logical, intent(in) :: is_singular(*)             !< (blocks) now its Jacobian has no inverse
      logical, intent(inout) :: crossed(*)              !< (blocks) it has crossed; blocks not in the list stay
      logical, intent(out) :: crosses                   !< some block of the list has crossed
      integer :: k

      crosses = .false.
      do k = 1, n
         associate (i => list(k))
            crossed(i) = now(i)%sign_of /= before(i)%sign_of .and. .not. is_singular(i)
            crosses = crosses .or. crossed(i)
         end associate
      end do
   end subroutine compare_signs

   !> Puts the latest motion of a history into a state. If the history is empty, blocks that iterate get the estimated
   !> values instead. Unknowns of explicit blocks follow from the drives.
   subroutine recall(b, x, path, history, estimated, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      type(history_t), intent(in) :: history   !< the motions before
      real(wp), intent(in) :: estimated(0:)             !< (0:unknowns) rad or unit of the loop
      type(state_t), intent(inout) :: s                 !< if the history is empty, with the drives
      integer :: k

      if (history%filled > 0) then
         call set_drive_values(path, history%t(0), s)
         do k = 1, size(history%predicted)
            associate (i => history%predicted(k), past => history%past(history%predicted(k)))
               s%u(i)%value = past%value
               s%u(i)%rate = past%rate(history%slot(0))
               s%u(i)%acceleration = past%acceleration(history%slot(0))
               call set_direction(b, i, s)
            end associate
         end do
      end if

      do k = 1, size(b%needed)
         associate (i => b%needed(k))
            if (b%list(i)%explicit) then
               call solve_explicit(b, x, i, s)
            else if (history%filled == 0) then
               call set_values(b, i, estimated(own_unknowns(b, i)), s)
            end if
         end associate
      end do
   end subroutine recall

   !> Records a motion as the latest of a history, which forgets the motion before the last two.
   pure subroutine record_motion(history, t, unknown, uncertain)
      type(history_t), intent(inout) :: history   !< the motions before
      real(wp), intent(in) :: t                         !< the parameter of the path, in the deck's unit of time
      type(unknown_t), intent(in) :: unknown(0:*)       !< (0:unknowns) of the motion
      real(wp), intent(in) :: uncertain                 !< uncertainty of its accelerations over velocities, 1/time
      integer :: slot, k

      slot = history%slot(2)
      history%slot = [slot, history%slot(0), history%slot(1)]
      history%t = [t, history%t(0), history%t(1)]
      history%uncertain = [uncertain, history%uncertain(0), history%uncertain(1)]
      do k = 1, size(history%predicted)
         associate (x => history%past(history%predicted(k)), now => unknown(history%predicted(k)))
            x%value = now%value
            x%rate(slot) = now%rate
            x%acceleration(slot) = now%acceleration
         end associate
      end do
      history%filled = min(history%filled + 1, 3)
   end subroutine record_motion

   !> Puts the latest motion of a history at a parameter of another path, and empties the history: rates on the path
   !> before predict nothing on the other path.
   pure subroutine begin_at(history, t)
      type(history_t), intent(inout) :: history   !< the motions before
      real(wp), intent(in) :: t                         !< the parameter, in the deck's unit of time

      history%t(0) = t
      history%filled = 0
   end subroutine begin_at

   !> Predicts the values of all unknowns that iterations solve for, by the formulas of the module's head. If one
   !> acceleration is too uncertain, the latest certain one serves, or none.
   pure subroutine predict(history, t, unknown, change)
      type(history_t), intent(in) :: history            !< with one motion at least, unless `t` is its parameter
      real(wp), intent(in) :: t                         !< the parameter of the path, in the deck's unit of time
      type(unknown_t), intent(inout) :: unknown(0:*)    !< (0:unknowns) the values are predicted, rates stay
      real(wp), intent(out) :: change                   !< the largest change from the latest, rad or unit of the loop
      real(wp) :: step, d, w(3)
      integer :: i, k, certain, s0, s1, s2

      if (asserts) call assert(history%filled > 0 .or. .not. abs(t - history%t(0)) > 0.0_wp, &
         'predict: a motion that is remembered, or its parameter')

      change = 0.0_wp
      step = t - history%t(0)
      s0 = history%slot(0)
      s1 = history%slot(1)
      s2 = history%slot(2)

      certain = 0
      if (max(history%uncertain(0), history%uncertain(1), history%uncertain(2))*abs(step) > max_uncertain_part) then
         certain = findloc(history%uncertain(:history%filled - 1)*abs(step) <= max_uncertain_part, .true., dim=1) - 1
      else if (has_equal_steps(history, step)) then
         do k = 1, size(history%predicted)
            associate (p => history%past(history%predicted(k)))
               d = step*(rate_weight(0)*p%rate(s0) + rate_weight(1)*p%rate(s1) + rate_weight(2)*p%rate(s2) &
                  + step*(acceleration_weight(0)*p%acceleration(s0) + acceleration_weight(1)*p%acceleration(s1) &
                  + acceleration_weight(2)*p%acceleration(s2)))
               unknown(history%predicted(k))%value = p%value + d
            end associate
            change = max(change, abs(d))
         end do
         return
      end if

      if (history%order /= own_predictor) w = order_weights(history%order, step, &
         merge(history%t(0) - history%t(1), 0.0_wp, history%filled > 1))
      do k = 1, size(history%predicted)
         i = history%predicted(k)
         associate (v => history%past(i)%rate, a => history%past(i)%acceleration)
            if (history%order /= own_predictor) then
               d = w(1)*v(s0) + w(2)*a(s0) + w(3)*(a(s0) - a(s1))
            else
               d = step*v(s0)
               if (certain >= 0) d = step*(v(s0) + 0.5_wp*step*a(history%slot(certain)))
            end if
         end associate
         unknown(i)%value = history%past(i)%value + d
         change = max(change, abs(d))
      end do
   end subroutine predict

   !> Estimates the uncertainty of the accelerations of a block over its velocities, in 1/time; 0: they are certain.
   !> With its least pivot p, and with L the Lipschitz constant of its Jacobian, positions are known to eps/p, and the
   !> other branch is about p/L away. Let v be the largest velocity of the block or of a drive. The velocities are
   !> uncertain by (eps/p)/(p/L) v, the accelerations by this over p/L times v. At dead points the accelerations grow as
   !> the velocities do, and are certain.
   pure real(wp) function uncertain_part(b, x, i, pivot, s) result(part)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                          !< the number of the block
      real(wp), intent(in) :: pivot                     !< the least |pivot| of its Jacobian
      type(state_t), intent(in) :: s                    !< the motion
      real(wp) :: v, fastest

      part = 0.0_wp
      if (pivot > safe_pivot) return
      associate (u => b%unknown(b%list(i)%first:b%list(i)%last))
         v = maxval(abs(s%u(u)%rate))
         fastest = max(v, largest_drive_rate(s))
         v = max(v, epsilon(1.0_wp)*fastest)
         if (.not. v > 0.0_wp) return
         part = epsilon(1.0_wp)*x%blocks(i)%lipschitz**2*fastest*(fastest/v)/max(pivot, epsilon(1.0_wp))**3
         if (.not. part*v > certain_acceleration_part*maxval(abs(s%u(u)%acceleration))) part = 0.0_wp
      end associate
   end function uncertain_part

   !> Gives the weights (3) of the velocity (time), the acceleration (time^2) and the last change of the acceleration
   !> (time^2) in a prediction of given order by Taylor's series.
   pure function order_weights(order, step, before) result(w)
      integer, intent(in) :: order                      !< 0 to 3
      real(wp), intent(in) :: step                      !< from the latest motion, in the deck's unit of time
      real(wp), intent(in) :: before                    !< the step that led to that motion; 0: there was none
      real(wp) :: w(3)

      w = 0.0_wp
      if (order >= 1) w(1) = step
      if (order >= 2) w(2) = 0.5_wp*step**2
      if (order >= 3 .and. abs(before) > 0.0_wp) w(3) = step**3/(6.0_wp*before)
   end function order_weights

   !> Tells whether the formula for three motions serves: the history has three motions at equal steps, the next step is
   !> equal, and no order is given.
   pure logical function has_equal_steps(history, step)
      type(history_t), intent(in) :: history   !< the motions before
      real(wp), intent(in) :: step                      !< from the latest motion, in the deck's unit of time

      has_equal_steps = history%filled == 3 .and. history%order == own_predictor
      if (.not. has_equal_steps) return
      has_equal_steps = abs(history%t(0) - history%t(1) - step) <= equal_step_part*abs(step) &
         .and. abs(history%t(1) - history%t(2) - step) <= equal_step_part*abs(step)
   end function has_equal_steps

   !> Lists the unknowns of the blocks of a list that are not explicit, increasing.
   pure function iterated_unknowns(b, list) result(unknowns)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)   !< (any number) numbers of blocks
      integer, allocatable :: unknowns(:)   !< their numbers
      logical :: iterated(size(b%list))
      integer :: u

      iterated = .false.
      iterated(list) = .not. b%list(list)%explicit
      unknowns = pack([(u, u=1, b%unknowns)], iterated(b%block_of))
   end function iterated_unknowns
end module predictor
