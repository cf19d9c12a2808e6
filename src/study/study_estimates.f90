!> The errors that the program tells of its own results (--errors) beside the true ones.
module study_estimates
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use set_motion, only: put_together
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set, set_errors
   use known_digits, only: nothing_known
   use text_output, only: output_t, put
   use numerals, only: whole
   use trials, only: trial_t, trial_mechanism, trial_instants
   use true_errors, only: truth_t, true_sample, differences
   use study_plan, only: plan_t, default_trial
   implicit none
   private
   public :: put_estimates

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

      if (any(estimate >= nothing_known)) then
         c%unknown = c%unknown + 1
         return
      end if
      true = [maxval(differences(truth, there, 0, real(q%position, qp))), &
         maxval(differences(truth, there, 1, real(q%velocity, qp))), &
         maxval(differences(truth, there, 2, real(q%acceleration, qp)))]
      ! By chance an error may be small: one below a rounding counts as that.
      ratio = real(estimate, dp)/max(true, real(epsilon(1.0_wp), dp))
      c%instants = c%instants + 1
      c%true = max(c%true, true)
      c%estimate = max(c%estimate, real(estimate, dp))
      c%min_ratio = min(c%min_ratio, ratio)
      c%logarithms = c%logarithms + log(max(ratio, tiny(1.0_dp)))
   end subroutine add_instant
end module study_estimates
