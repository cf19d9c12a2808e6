!> A trial: one way of solving a set of computations, and what comes of it in this program's own kind of
!> reals: the motion, the iterations, the time of a step.
!>
!> The instants are those of a double-precision program, t0 + (t1 - t0) k/n in its arithmetic, in every kind: a kind of
!> fewer digits rounds them, and that is a part of its error, as is the rounding of the deck's numbers. With twice the
!> steps every second instant is the same one, to the last bit.
module trials
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128, int64
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_link, instant, method_newton, own_predictor
   use motion, only: motion_t, new_motion
   use set_motion, only: put_together, is_flagged
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, iterations_of
   implicit none
   private
   public :: trial_t, outcome_t, kind_single, kind_double, kind_quad, repeats, samples_of, trial_mechanism, &
      trial_instants, march, can_be_timed, step_time, seconds, median

   !> The program that makes a trial: kinmat-single, kinmat, kinmat-quad.
   integer, parameter :: kind_single = 1, kind_double = 2, kind_quad = 3

   type :: trial_t
      integer :: section = 0                     !< of the study's table
      integer :: kind = kind_double
      integer :: method = method_newton
      real(dp) :: tolerance = 0.0_dp             !< 0: the limit of rounding
      integer :: predictor = own_predictor       !< its order, or the method's own
      logical :: keeps = .false.                 !< the reference angles of the first instant, for good
      integer :: steps = 0                       !< of the whole time of the deck; 0: the instants of its AT cards
      integer :: last = 0                        !< the last step that is made, 0 <= last
      integer :: stride = 1                      !< the motion is kept at steps 0, stride, 2 stride, ...
   end type trial_t

   !> In the deck's units, x and y from the first ground link on; angles in radians.
   type :: outcome_t
      real(dp) :: iterations = 0.0_dp            !< a step, those of substeps included
      logical :: found = .false.                 !< a position at every step
      integer, allocatable :: known(:)           !< (samples) -1: no position; 2: accelerations too
      real(qp), allocatable :: value(:, :, :, :) !< (3, links, 0:2, samples)
      real(dp), allocatable :: time(:)           !< seconds a step but the first instant; none: not timed
   end type outcome_t

   !> Measurements of a time.
   integer, parameter :: repeats = 9
   !> Seconds that one measurement takes at least: many clock ticks; and at most, as far as a few steps let it.
   real(dp), parameter :: min_seconds = 0.0005_dp, max_seconds = 0.01_dp
   integer, parameter :: min_steps = 4
   !> A trial that has found nothing at so many instants from the first on is given up; so is one that fails at some
   !> instants when it has taken so many seconds.
   integer, parameter :: patience = 3
   real(dp), parameter :: long = 2.0_dp

contains

   !> Motions that are kept of trial `t`.
   pure integer function samples_of(t)
      type(trial_t), intent(in) :: t

      samples_of = t%last/t%stride + 1
   end function samples_of

   !> The mechanism `m` as trial `t` asks for it: all links, by its method.
   pure function trial_mechanism(m, t) result(one)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(mechanism_t) :: one
      integer :: i

      one = m
      one%method = t%method
      one%tolerance = real(t%tolerance, wp)
      one%predictor = t%predictor
      one%keeps_references = t%keeps
      one%requests = [(request_t(request_link, i, 1), i=1, size(m%links))]
   end function trial_mechanism

   !> Instants 0 to `last` (0:last) of trial `t`.
   pure function trial_instants(m, t) result(instants)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      real(dp) :: instants(0:t%last)
      real(dp) :: first, last
      integer :: k

      if (t%steps == 0) then
         instants = [(real(instant(m, k), dp), k=0, t%last)]
         return
      end if
      first = real(m%t0, dp)
      last = real(m%t1, dp)
      do k = 0, t%last
         instants(k) = last
         if (k /= t%steps) instants(k) = first + (last - first)*real(k, dp)/real(t%steps, dp)
      end do
   end function trial_instants

   !> Solves `m` at the `instants` (0:); the motion of every `stride`-th is kept in `o`, which has no times yet.
   !> `seconds_taken`: by all of it.
   subroutine march(m, instants, stride, o, seconds_taken)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: instants(0:)
      integer, intent(in) :: stride
      type(outcome_t), intent(out) :: o
      real(dp), intent(out) :: seconds_taken
      type(set_analysis_t) :: a
      type(motion_t) :: q
      real(dp) :: begun
      integer :: k, i, failures, at_first

      allocate (o%known(ubound(instants, 1)/stride + 1), source=-1)
      allocate (o%value(3, size(m%links), 0:2, size(o%known)), source=0.0_qp)
      o%found = .true.
      q = new_motion(size(m%links))
      call make_set_analysis(m, a)
      begun = seconds()
      failures = 0
      do k = 0, ubound(instants, 1)
         call advance_set(a, instants(k))
         if (k == 0) at_first = iterations_of(a)
         if (is_flagged(a%now)) failures = failures + 1
         seconds_taken = seconds() - begun
         call put_together(a%now, q)
         o%found = o%found .and. q%known >= 0
         if (failures > 0 .and. (failures == k + 1 .and. failures == patience .or. seconds_taken > long)) exit
         if (mod(k, stride) /= 0) cycle
         i = k/stride + 1
         o%known(i) = q%known
         o%value(:, :, 0, i) = q%position
         o%value(:, :, 1, i) = q%velocity
         o%value(:, :, 2, i) = q%acceleration
      end do
      o%found = o%found .and. k > ubound(instants, 1)
      o%iterations = real(iterations_of(a) - at_first, dp)/max(1, min(k, ubound(instants, 1)))
   end subroutine march

   !> A time a step of so many `steps` has a meaning: there are steps, and every position was found.
   pure logical function can_be_timed(o, steps)
      type(outcome_t), intent(in) :: o
      integer, intent(in) :: steps

      can_be_timed = steps > 0 .and. o%found
   end function can_be_timed

   !> Seconds a step of `m`, position, velocity and acceleration at the `instants` (0:), without the first of them.
   !> `whole`: seconds that all of it takes, about.
   real(dp) function step_time(m, instants, whole) result(time)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: instants(0:)
      real(dp), intent(in) :: whole
      type(set_analysis_t) :: a
      real(dp) :: begun
      integer :: i, k, passes, last

      last = ubound(instants, 1)
      if (whole > max_seconds) last = min(last, max(min_steps, int(last*max_seconds/whole)))
      passes = max(1, min(1000, ceiling(min_seconds/max(whole, 1.0e-6_dp))))
      time = 0.0_dp
      do i = 1, passes
         call make_set_analysis(m, a)
         call advance_set(a, instants(0))
         begun = seconds()
         do k = 1, last
            call advance_set(a, instants(k))
         end do
         time = time + (seconds() - begun)
      end do
      time = time/(real(passes, dp)*last)
   end function step_time

   !> The clock (s), from some instant.
   real(dp) function seconds()
      integer(int64) :: ticks, per_second

      call system_clock(ticks, per_second)
      seconds = real(ticks, dp)/real(per_second, dp)
   end function seconds

   !> The median of `x`; 0 if x is empty.
   pure real(dp) function median(x)
      real(dp), intent(in) :: x(:)
      real(dp) :: sorted(size(x)), one
      integer :: i, k

      median = 0.0_dp
      if (size(x) == 0) return
      sorted = x
      do i = 2, size(x)
         one = sorted(i)
         do k = i - 1, 1, -1
            if (sorted(k) <= one) exit
            sorted(k + 1) = sorted(k)
         end do
         sorted(k + 1) = one
      end do
      i = (size(x) + 1)/2
      median = 0.5_dp*(sorted(i) + sorted(size(x) + 1 - i))
   end function median
end module trials
