!> The errors of a trial against the truth, the motion in real128, and beside them those that --errors estimates.
!>
!> Differences are in the characteristic length and rate, angles to a whole turn; where the largest position, velocity
!> or acceleration of the truth is more than 1 of these, they are parts of it.
module true_errors
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use kinds, only: wp
   use mechanism, only: mechanism_t, place_links
   use motion, only: motion_t, new_motion, mark_none
   use scales, only: characteristic_length, characteristic_rate
   use set_motion, only: put_together
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set, set_errors
   use known_digits, only: nothing_known
   use text_output, only: output_t, put
   use numerals, only: whole
   use trials, only: trial_t, outcome_t, trial_mechanism, trial_instants
   use study_plan, only: plan_t, default_trial
   implicit none
   private
   public :: truth_t, errors_t, new_truth, errors_of, true_sample, put_estimates

   !> An error of the position above this is looked into: it may belong to another position of the mechanism.
   real(dp), parameter :: suspicious = 1.0e-6_dp
   real(qp), parameter :: turn = 6.283185307179586476925286766559005768394_qp

   type :: truth_t
      type(trial_t) :: trial
      type(outcome_t) :: motion
      real(dp) :: unit(3) = 1.0_dp, rate = 1.0_dp
      real(dp) :: size_of(0:2) = 1.0_dp          !< the largest values, 1 at least
      logical, allocatable :: moves(:)           !< (links)
   end type truth_t

   !> (position, velocity, acceleration)
   type :: errors_t
      real(dp) :: largest(0:2) = 0.0_dp, rms(0:2) = 0.0_dp
      integer :: compared = 0                    !< instants
      integer :: unsolved = 0                    !< of which the truth is known, the trial's position not
      integer :: no_velocity = 0                 !< likewise with a position, but no velocities
      integer :: other_assembly = 0              !< at which another position was found, which closes as well
   end type errors_t

   !> Instants at which errors are estimated, about.
   integer, parameter :: max_compared = 40

   !> (position, velocity, acceleration)
   type :: comparison_t
      real(dp) :: true(0:2) = 0.0_dp, estimate(0:2) = 0.0_dp !< the largest
      real(dp) :: logarithms(0:2) = 0.0_dp                   !< of the ratio, estimate over true, summed up
      real(dp) :: min_ratio(0:2) = huge(1.0_dp)
      integer :: instants = 0, unknown = 0
   end type comparison_t

contains

   !> `motion`: of trial `t`, whose stride is 1.
   function new_truth(m, t, motion) result(truth)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(outcome_t), intent(in) :: motion
      type(truth_t) :: truth
      integer :: i, k

      truth%trial = t
      truth%motion = motion
      truth%moves = .not. m%links%ground
      truth%unit(:2) = real(characteristic_length(m), dp)
      truth%rate = real(characteristic_rate(m, characteristic_length(m)), dp)
      do i = 1, size(motion%known)
         do k = 0, motion%known(i)
            truth%size_of(k) = max(truth%size_of(k), maxval(scaled(truth, k, motion%value(:, :, k, i))))
         end do
      end do
   end function new_truth

   !> The sample of the truth at step `k` of trial `t`.
   pure integer function true_sample(truth, t, k)
      use, intrinsic :: iso_fortran_env, only: int64
      type(truth_t), intent(in) :: truth
      type(trial_t), intent(in) :: t
      integer, intent(in) :: k

      true_sample = k + 1
      if (t%steps > 0) true_sample = int(int(k, int64)*truth%trial%steps/t%steps) + 1
   end function true_sample

   !> Magnitudes of derivative number `k` of the moving links (3, moving links), in the characteristic length and rate.
   pure function scaled(truth, k, value) result(x)
      type(truth_t), intent(in) :: truth
      integer, intent(in) :: k
      real(qp), intent(in) :: value(:, :)
      real(dp), allocatable :: x(:, :)
      integer :: i

      allocate (x(3, count(truth%moves)))
      do i = 1, 3
         x(i, :) = real(abs(pack(value(i, :), truth%moves))/(truth%unit(i)*real(truth%rate, qp)**k), dp)
      end do
   end function scaled

   !> Differences of derivative number `k` from sample `i` of the truth, likewise.
   pure function differences(truth, i, k, value) result(d)
      type(truth_t), intent(in) :: truth
      integer, intent(in) :: i, k
      real(qp), intent(in) :: value(:, :)
      real(dp), allocatable :: d(:, :)
      real(qp) :: x(3, size(value, 2))

      x = value - truth%motion%value(:, :, k, i)
      ! In real128: `without_turns` would add a rounding of a turn to errors that are no larger.
      if (k == 0) x(3, :) = x(3, :) - turn*anint(x(3, :)/turn)
      d = scaled(truth, k, x)
   end function differences

   !> The errors of trial `t` of `m`, from what came of it.
   function errors_of(truth, m, t, o) result(e)
      type(truth_t), intent(in) :: truth
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(outcome_t), intent(in) :: o
      type(errors_t) :: e
      real(dp) :: position(size(o%known)), sums(0:2)
      real(dp), allocatable :: d(:, :)
      integer :: i, k, there

      sums = 0.0_dp
      position = 0.0_dp
      do i = 1, size(o%known)
         there = true_sample(truth, t, (i - 1)*t%stride)
         if (truth%motion%known(there) < 2) cycle
         if (o%known(i) < 0) e%unsolved = e%unsolved + 1
         if (o%known(i) == 0 .or. o%known(i) == 1) e%no_velocity = e%no_velocity + 1
         if (o%known(i) < 2) cycle
         e%compared = e%compared + 1
         do k = 0, 2
            d = differences(truth, there, k, o%value(:, :, k, i))/truth%size_of(k)
            if (k == 0) position(i) = maxval(d)
            e%largest(k) = max(e%largest(k), maxval(d))
            sums(k) = sums(k) + sum(d**2)
         end do
      end do
      e%rms = sqrt(sums/max(1, 3*count(truth%moves)*e%compared))
      i = maxloc(position, dim=1)
      if (position(i) > suspicious) then
         if (is_other_assembly(truth, m, t, o, i)) e%other_assembly = count(position > 0.5_dp*position(i))
      end if
   end function errors_of

   !> From the position of sample `i` Newton's method does not come to the truth, but stays where it is: that is
   !> another solution of the equations.
   logical function is_other_assembly(truth, m, t, o, i)
      type(truth_t), intent(in) :: truth
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(outcome_t), intent(in) :: o
      integer, intent(in) :: i
      type(mechanism_t) :: there
      type(set_analysis_t) :: a
      type(motion_t) :: q
      real(dp) :: before, after, instants(0:t%last)
      integer :: k, sample

      there = trial_mechanism(m, trial_t())
      call place_links(there, real(o%value(:, :, 0, i), wp))
      q = new_motion(size(m%links))
      call make_set_analysis(there, a)
      k = (i - 1)*t%stride
      instants = trial_instants(m, t)
      call advance_set(a, real(instants(k), wp))
      call put_together(a%now, q)
      is_other_assembly = q%mark == mark_none
      if (.not. is_other_assembly) return
      sample = true_sample(truth, t, k)
      before = maxval(differences(truth, sample, 0, o%value(:, :, 0, i)))
      after = maxval(differences(truth, sample, 0, real(q%position, qp)))
      is_other_assembly = after > 0.5_dp*before
   end function is_other_assembly

   !> The section of the estimates: METHOD NEWTON at the deck's steps, by tolerance.
   subroutine put_estimates(o, m, p, truth)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(plan_t), intent(in) :: p
      type(truth_t), intent(in) :: truth
      real(dp), parameter :: tolerances(4) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-8_dp, 0.0_dp]
      type(comparison_t) :: c
      type(trial_t) :: t
      character(120) :: line
      integer :: i, k

      call put(o, '')
      call put(o, ' ERROR ESTIMATES OF --errors AGAINST THE TRUE ERRORS: BLOCKS, at the deck''s steps; of each')
      call put(o, ' instant the largest number, in the characteristic length and rate. TRUE, ESTIM: the largest')
      call put(o, ' of all instants; MIN, MEAN: of the estimate over the true error')
      call put(o, '')
      call put(o, ' TOLERANCE INSTANTS   POSITION'//repeat(' ', 24)//'VELOCITY'//repeat(' ', 24)//'ACCELERATION')
      call put(o, repeat(' ', 19)//repeat('    TRUE   ESTIM     MIN    MEAN', 3))
      do i = 1, size(tolerances)
         t = default_trial(p)
         t%tolerance = tolerances(i)
         call compare(m, t, truth, c)
         write (line, '(es10.0, i9)') tolerances(i), c%instants
         if (.not. tolerances(i) > 0.0_dp) line(:10) = '  ROUNDING'
         if (c%instants > 0) then
            do k = 0, 2
               write (line(20 + 32*k:), '(4es8.1)') c%true(k), c%estimate(k), c%min_ratio(k), &
                  exp(c%logarithms(k)/c%instants)
            end do
         end if
         call put(o, trim(line))
         if (c%unknown > 0) call put(o, '    ESTIMATED TO BE WITHOUT A KNOWN DIGIT: '//whole(c%unknown)//' INSTANTS')
      end do
   end subroutine put_estimates

   !> Compares estimates and true errors of trial `t` at up to about max_compared instants.
   subroutine compare(m, t, truth, c)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(truth_t), intent(in) :: truth
      type(comparison_t), intent(out) :: c
      type(mechanism_t) :: one
      type(set_analysis_t) :: a
      type(motion_t) :: q
      real(wp) :: instants(0:t%last)
      integer :: k, there, every

      one = trial_mechanism(m, t)
      instants = real(trial_instants(m, t), wp)
      call make_set_analysis(one, a)
      q = new_motion(size(m%links))
      every = t%stride*max(1, (t%last/t%stride)/max_compared)
      do k = 0, t%last
         call advance_set(a, instants(k))
         if (mod(k, every) /= 0) cycle
         call put_together(a%now, q)
         if (q%known < 2) cycle
         there = true_sample(truth, t, k)
         if (truth%motion%known(there) < 2) cycle
         call sample_set(a, .true.)
         call add_instant(truth, there, q, set_errors(a), c)
      end do
   end subroutine compare

   !> Counts the errors of `q` and their `estimate` (0:2), at sample `there` of the truth.
   subroutine add_instant(truth, there, q, estimate, c)
      type(truth_t), intent(in) :: truth
      integer, intent(in) :: there
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: estimate(0:2)
      type(comparison_t), intent(inout) :: c
      real(dp) :: true(0:2), ratio(0:2)
      real(dp), parameter :: rounding = real(epsilon(1.0_wp), dp)

      if (any(estimate >= nothing_known)) then
         c%unknown = c%unknown + 1
         return
      end if
      true = [maxval(differences(truth, there, 0, real(q%position, qp))), &
         maxval(differences(truth, there, 1, real(q%velocity, qp))), &
         maxval(differences(truth, there, 2, real(q%acceleration, qp)))]
      ! By chance an error may be small: one below a rounding counts as that, and so does an estimate that covers it.
      ratio = real(estimate, dp)
      where (ratio >= true) ratio = max(ratio, rounding)
      ratio = ratio/max(true, rounding)
      c%instants = c%instants + 1
      c%true = max(c%true, true)
      c%estimate = max(c%estimate, real(estimate, dp))
      c%min_ratio = min(c%min_ratio, ratio)
      c%logarithms = c%logarithms + log(max(ratio, tiny(1.0_dp)))
   end subroutine add_instant
end module true_errors
