!> The sensitivities s of the rows of a motion to the numbers that have tolerances, at one instant, and the effect of
!> the tolerances: the worst case, which is the sum of |s| times the tolerance, and the root of the sum of squares. A
!> sensitivity is the difference of two rows of the mechanism with one number a little above and below.
module sensitivities
   use kinds, only: wp
   use mechanism, only: mechanism_t, tolerance_t, request_t, parameter_drive, term_kinds
   use drives, only: joint_distance
   use parameters, only: parameter_value, change_parameter
   use masked_numbers, only: nothing_known
   use motion, only: motion_t
   use columns, only: kinds_of_rows
   use points, only: row_t, find_row
   use instant_centres, only: points_coincide
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t
   use significance_check, only: sizes_t
   use rounded_numbers, only: safety_factor
   use error_estimate, only: error_estimate_t, estimator_t
   use changed_rows, only: find_place, make_ready, assign_changes, rows_with
   use convergence, only: inconsistent_level
   implicit none
   private
   public :: sensitivities_t, find_sensitivities, has_tolerances

   !> The sensitivities at one instant, in the units of the rows (deck's lengths, radians) over the units of the numbers
   !> on their cards. Numbers are those with a tolerance.
   type :: sensitivities_t
      logical :: taken = .false.                     !< some number has a tolerance
      real(wp), allocatable :: of(:, :, :, :)        !< (3, 0:2, numbers, requests) the sensitivities
      real(wp), allocatable :: error(:, :, :, :)     !< (3, 0:2, numbers, requests) their errors by rounding
      integer, allocatable :: known(:)               !< (requests) the highest derivative that exists; -1: none
      logical, allocatable :: jams(:)                !< (numbers) redundant equations do not allow it to change
   end type sensitivities_t

   !> A number is changed by about this part of its natural unit, the ninth root of a rounding. With three steps of
   !> Richardson's extrapolation the error of the difference is the eighth power of the change, about as large as the
   !> error that rounding leaves in it.
   real(wp), parameter :: usual_step = 0.5_wp*epsilon(1.0_wp)**(1.0_wp/9.0_wp)
   !> A number that changes to one side only: the error is the fourth power, and the change the fifth root.
   real(wp), parameter :: step_to_one_side = 0.5_wp*epsilon(1.0_wp)**0.2_wp
   !> There are so many steps, each half the one before; the sensitivity is the sum of these parts of their slopes.
   integer, parameter :: halvings = 4
   real(wp), parameter :: of_both_sides(halvings) = [-1.0_wp, 84.0_wp, -1344.0_wp, 4096.0_wp]/2835.0_wp
   real(wp), parameter :: of_one_side(halvings) = [-1.0_wp, 14.0_wp, -56.0_wp, 64.0_wp]/21.0_wp
   !> The error of a sensitivity is the rounding error of a row over the step, times this factor: errors of rows are
   !> independent.
   real(wp), parameter :: amplification_of_both = norm2(of_both_sides*[1.0_wp, 2.0_wp, 4.0_wp, 8.0_wp])/sqrt(2.0_wp)
   real(wp), parameter :: amplification_of_one = norm2(of_one_side*[1.0_wp, 2.0_wp, 4.0_wp, 8.0_wp])*sqrt(2.0_wp)
   !> The step is shorter if an unknown would change by more than this (rad, unit of the block), or with a larger
   !> Kantorovich ratio r. At the distance d from a dead point a change by h has r = h/(2 d). Accelerations are as
   !> d**-2.5 there, and their difference has the relative error 0.6 r**8.
   real(wp), parameter :: max_unknown_change = 4.0_wp*usual_step, max_ratio = 6.0e-2_wp
   !> A step below this part of the largest step that these limits allow is too short: rounding is larger than needed.
   real(wp), parameter :: too_near = 0.25_wp
   !> Beyond the limit of a motion there is no root: the step counts as so many times too long, or more.
   real(wp), parameter :: beyond_limit_factor = 4.0_wp
   integer, parameter :: max_attempts = 12        !< steps that are tried; each attempt may be a thousand times shorter
   !> The closure error of redundant equations grows at most by this factor if a number may change.
   real(wp), parameter :: max_closure_growth = 2.0_wp

contains

   !> Finds the sensitivities of all requests of a mechanism at a motion. Of sensitivities that do not exist found%known
   !> is -1, of numbers that cannot change found%jams is true.
   subroutine find_sensitivities(estimator, m, b, x, state, q, estimate, found)
      type(estimator_t), intent(inout) :: estimator   !< of `m`
      type(mechanism_t), intent(in) :: m     !< with tolerances
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: state     !< of the motion
      type(motion_t), intent(in) :: q        !< the motion
      type(error_estimate_t), intent(in) :: estimate   !< of the motion, by `estimator`
      type(sensitivities_t), intent(inout) :: found   !< the sensitivities
      type(row_t), dimension(size(m%requests)) :: middle, up, down
      type(row_t) :: row
      real(wp) :: step, h, factor
      integer :: i, d, k, side, order

      found%taken = .true.
      associate (numbers => size(m%tolerances), requests => size(m%requests))
         if (.not. allocated(found%of)) allocate (found%of(3, 0:2, numbers, requests), &
            found%error(3, 0:2, numbers, requests), found%known(requests), found%jams(numbers))
      end associate
      found%of = 0.0_wp
      found%error = 0.0_wp
      found%jams = .false.

      call find_place(b, x, state, q, estimator%place)
      call make_ready(estimator%perturbed, 0, m, x, i)
      estimator%place%room = huge(1.0_wp)
      call find_rows(middle, m)
      ! A change that enlarges the closure error of redundant equations jams, even within a closing tolerance.
      estimator%place%room = inconsistent_level + max_closure_growth*estimator%place%opened

      do i = 1, size(m%requests)
         call find_row(m, q, m%requests(i), row)
         found%known(i) = merge(2, -1, min(row%known, middle(i)%known) == 2 .and. has_tolerances(m, m%requests(i)) &
            .and. row%state /= points_coincide)
      end do

      do d = 1, size(m%tolerances)
         associate (one => m%tolerances(d))
            call check_joints(m, one, q%t, usual_step*natural_unit(one, estimator%sizes), side, order)
            call find_step(one, side, step)

            down = middle
            do k = 1, halvings
               h = step*0.5_wp**(k - 1)
               if (k > 1) call find_changed_rows(up, one, h)
               if (side == 0) call find_changed_rows(down, one, -h)
               factor = merge(of_both_sides(k), of_one_side(k), side == 0)*one%unit/(merge(2.0_wp, 1.0_wp, side == 0)*h)
               where (min(up%known, down%known) < 2) found%known = -1
               do i = 1, size(m%requests)
                  if (found%known(i) >= 0) &
                     found%of(:, :, d, i) = found%of(:, :, d, i) + factor*(up(i)%value - down(i)%value)
               end do
            end do

            do i = 1, size(m%requests)
               found%known(i) = min(found%known(i), order)
               if (.not. (estimate%taken .and. estimate%may_lose_digits)) cycle
               associate (error => found%error(:, :, d, i), rounding => estimate%changes(:, :, i))
                  error = nothing_known
                  where (rounding < nothing_known) &
                     error = merge(amplification_of_both, amplification_of_one, side == 0) &
                     *safety_factor*rounding*abs(one%unit/step)
               end associate
            end do
         end associate
      end do
      ! The numbers of changed mechanism 0 belong to no direction of an error estimate.
      estimator%perturbed(0)%is_ready = .false.

   contains

      !> Finds the rows of a mechanism with changed numbers near the motion.
      subroutine find_rows(rows, changed)
         type(row_t), intent(inout) :: rows(:)   !< (requests)
         type(mechanism_t), intent(in) :: changed   !< with the links, points, pairs and drives of `m`

         associate (p => estimator%perturbed(0))
            p%m = changed
            call assign_changes(b, p, by_roundings=.false.)
            call rows_with(b, p, q%t, estimator%place, rows)
         end associate
      end subroutine find_rows

      !> Finds the rows with number `d` changed near the motion. If redundant equations do not allow the change,
      !> found%jams becomes true.
      subroutine find_changed_rows(rows, one, by)
         type(row_t), intent(inout) :: rows(:)   !< (requests)
         type(tolerance_t), intent(in) :: one   !< of the number
         real(wp), intent(in) :: by          !< the change of the number, in the units of `mechanism_t`
         type(mechanism_t) :: changed

         changed = m
         call change_parameter(changed, one%parameter_t, parameter_value(m, one%parameter_t) + by)
         call find_rows(rows, changed)
         found%jams(d) = found%jams(d) .or. estimator%place%jams
      end subroutine find_changed_rows

      !> Finds the step by which a number is changed, and the rows with the changed number, in `up`.
      subroutine find_step(one, side, step)
         type(tolerance_t), intent(in) :: one   !< of the number
         integer, intent(in) :: side         !< to which the number may change: 1 up, -1 down, 0 to both
         real(wp), intent(out) :: step       !< in the units of `mechanism_t`; above 0 unless `side` is -1
         real(wp) :: usual, too_far
         integer :: k

         usual = merge(usual_step, step_to_one_side, side == 0)*natural_unit(one, estimator%sizes)
         step = merge(usual, -usual, side >= 0)
         do k = 1, max_attempts
            call find_changed_rows(up, one, step)
            ! On a dead point only links that drives move are known, and no step is too near the dead point.
            if (estimator%place%is_singular .or. found%jams(d) .or. k == max_attempts) exit
            too_far = max(estimator%place%change/max_unknown_change, estimator%place%ratio/max_ratio, too_near/2.0_wp)
            if (any(up%known < middle%known)) too_far = max(too_far, beyond_limit_factor)
            if (too_far <= 1.0_wp .and. (too_far >= too_near .or. .not. abs(step) < usual)) exit
            step = sign(min(usual, abs(step)*max(0.5_wp/too_far, 1.0e-3_wp)), step)
         end do
      end subroutine find_step
   end subroutine find_sensitivities

   !> Gives the natural unit of a number, a product of powers of characteristic length and rate, in the units of
   !> `mechanism_t`: a change by this unit changes the motion by about 1 characteristic length or rad.
   pure real(wp) function natural_unit(one, sizes)
      type(tolerance_t), intent(in) :: one   !< of the number
      type(sizes_t), intent(in) :: sizes     !< of the mechanism

      natural_unit = sizes%length**one%powers(1)*sizes%rate**(-one%powers(2))
   end function natural_unit

   !> Tells whether a request has sensitivities: some number has a tolerance, and the request is no pole, curve or
   !> ratio.
   pure logical function has_tolerances(m, request)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request   !< of `m`

      has_tolerances = allocated(m%tolerances) .and. .not. kinds_of_rows(request%kind)%is_centre &
         .and. request%drive == 0
   end function has_tolerances

   !> Finds which derivatives with respect to a number exist at a time, and on which side: the joints of a rise may be
   !> near. A start or a duration that grows moves joints to later times. At a joint that moves, the derivative of the
   !> acceleration, or of the velocity, with respect to the number differs from one side to the other.
   pure subroutine check_joints(m, one, t, step, side, order)
      type(mechanism_t), intent(in) :: m
      type(tolerance_t), intent(in) :: one   !< of the number
      real(wp), intent(in) :: t              !< time, in the deck's unit
      real(wp), intent(in) :: step           !< the change of the number, in the units of `mechanism_t`
      integer, intent(out) :: side           !< to which it may change by a few steps: 1 up, -1 down, 0 to both
      integer, intent(out) :: order          !< highest derivative with respect to time, 0 to 2, that has a sensitivity
      real(wp) :: joints(3), ahead

      side = 0
      order = 2
      if (one%kind /= parameter_drive .or. one%term == 0) return
      associate (term => m%drives(one%subject)%terms(one%term))
         if (.not. term_kinds(term%kind)%is_rise .or. one%place == 3) return
         joints = term_kinds(term%kind)%joints - (t - term%r(1))/term%r(2)
         ahead = joints(minloc(abs(joints), dim=1))
         if (abs(ahead) <= joint_distance(term)) order = merge(0, 1, term_kinds(term%kind)%jumps)
         if (abs(ahead) > 2.0_wp*step/term%r(2)*max(1.0_wp, abs(t - term%r(1))/term%r(2))) return
         ! At the joint itself the derivative from the right is taken.
         side = merge(1, -1, ahead > joint_distance(term))
      end associate
   end subroutine check_joints
end module sensitivities
