!> Level 19. A set of computations solved in one way, in this program's own kind of reals: its motion, and its time.
!>
!> The instants are those of a double-precision program, t0 + (t1 - t0) k/n in its arithmetic, in every kind: a kind of
!> fewer digits rounds them, and that is a part of its error, as is the rounding of the deck's numbers. With twice the
!> steps every second instant is the same one, to the last digit.
module trials
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_link, instant
   use motion, only: motion_t, new_motion
   use set_motion, only: put_together, is_flagged
   use set_analysis, only: set_analysis_t, new_set_analysis, advance_set, iterations_of
   use trial_forms, only: trial_t, outcome_t, samples_of
   use timing, only: seconds
   implicit none
   private
   public :: try, measure, tried, instant_of, can_be_timed

   !> Seconds that one measurement takes at least: many clock ticks; and at most, as far as a few steps let it.
   real(dp), parameter :: least = 0.002_dp, most = 0.02_dp
   integer, parameter :: fewest_steps = 4
   !> A way that has found nothing at so many instants from the first on is given up; so is one that fails at some
   !> instants when it has taken so many seconds.
   integer, parameter :: patience = 3
   real(dp), parameter :: long = 2.0_dp

contains

   !> The mechanism as trial `t` asks for it: all links, by its method.
   pure function tried(m, t) result(one)
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
   end function tried

   !> Instant number `k` of trial `t`, as a double.
   pure real(dp) function instant_of(m, t, k)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      integer, intent(in) :: k
      real(dp) :: first, last

      if (t%steps == 0) then
         instant_of = real(instant(m, k), dp)
         return
      end if
      first = real(m%t0, dp)
      last = real(m%t1, dp)
      instant_of = last
      if (k /= t%steps) instant_of = first + (last - first)*real(k, dp)/real(t%steps, dp)
   end function instant_of

   !> The motion of trial `t`; `o` has no times yet. `seconds_taken`: by the whole of it.
   subroutine try(m, t, o, seconds_taken)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(outcome_t), intent(out) :: o
      real(dp), intent(out) :: seconds_taken
      type(mechanism_t) :: one
      type(set_analysis_t) :: a
      type(motion_t) :: q
      real(dp) :: begun
      integer :: k, i, marked, done

      o%digits = digits(1.0_wp)
      allocate (o%known(samples_of(t)), source=-1)
      allocate (o%value(3, size(m%links), 0:2, samples_of(t)), source=0.0_qp)
      q = new_motion(size(m%links))
      one = tried(m, t)
      call new_set_analysis(one, a)
      begun = seconds()
      seconds_taken = 0.0_dp
      marked = 0
      done = 0
      do k = 0, t%last
         call advance_set(a, one, real(instant_of(m, t, k), wp))
         if (is_flagged(a%now)) marked = marked + 1
         seconds_taken = seconds() - begun
         if (k == 0) done = iterations_of(a)
         if (marked == k + 1 .and. marked == patience) exit
         if (marked > 0 .and. seconds_taken > long) exit
         if (mod(k, t%stride) /= 0) cycle
         i = k/t%stride + 1
         call put_together(a%now, q)
         o%known(i) = q%known
         o%value(:, :, 0, i) = q%position
         o%value(:, :, 1, i) = q%velocity
         o%value(:, :, 2, i) = q%acceleration
      end do
      o%iterations = real(iterations_of(a) - done, dp)/max(1, min(k, t%last))
   end subroutine try

   !> A time a step has a meaning: every position was found.
   pure logical function can_be_timed(t, o)
      type(trial_t), intent(in) :: t
      type(outcome_t), intent(in) :: o

      can_be_timed = t%repeats > 0 .and. t%last > 0 .and. all(o%known >= 0)
   end function can_be_timed

   !> Seconds a step of trial `t`, position, velocity and acceleration of all links, without the first instant.
   !> `whole`: what the whole of it takes, about.
   real(dp) function measure(m, t, whole) result(time)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      real(dp), intent(in) :: whole
      type(mechanism_t) :: one
      type(set_analysis_t) :: a
      real(wp), allocatable :: instants(:)
      real(dp) :: begun
      integer :: i, k, passes, last

      last = t%last
      if (whole > most) last = min(last, max(fewest_steps, int(last*most/whole)))
      passes = max(1, min(1000, ceiling(least/max(whole, 1.0e-6_dp))))
      instants = [(real(instant_of(m, t, k), wp), k=0, last)]
      one = tried(m, t)
      time = 0.0_dp
      do i = 1, passes
         call new_set_analysis(one, a)
         call advance_set(a, one, instants(1))
         begun = seconds()
         do k = 1, last
            call advance_set(a, one, instants(k + 1))
         end do
         time = time + (seconds() - begun)
      end do
      time = time/(real(passes, dp)*last)
   end function measure
end module trials
