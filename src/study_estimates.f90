!> Level 21. The errors that the program tells of its own results (--errors) beside the true ones.
module study_estimates
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use set_motion, only: put_together
   use set_analysis, only: set_analysis_t, new_set_analysis, advance_set, sample_set, set_errors
   use known_digits, only: nothing_known
   use text_output, only: output_t, put
   use numerals, only: whole
   use trial_forms, only: trial_t
   use trials, only: tried, instant_of
   use true_errors, only: truth_t, true_sample, differences
   use study_plan, only: plan_t, default_trial
   implicit none
   private
   public :: put_estimates

   !> Instants at which errors are estimated, about.
   integer, parameter :: enough = 40

   !> (position, velocity, acceleration)
   type :: tally_t
      real(dp) :: true(0:2) = 0.0_dp, told(0:2) = 0.0_dp   !< the largest
      real(dp) :: logarithms(0:2) = 0.0_dp                 !< of told over true, summed up
      real(dp) :: least(0:2) = huge(1.0_dp)                !< told over true
      integer :: instants = 0, open = 0
   end type tally_t

contains

   !> The section of the estimates: METHOD NEWTON at the deck's steps, by tolerance.
   subroutine put_estimates(o, m, p, truth)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(plan_t), intent(in) :: p
      type(truth_t), intent(in) :: truth
      real(dp), parameter :: tolerances(4) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-8_dp, 0.0_dp]
      type(tally_t) :: tally
      type(trial_t) :: t
      character(120) :: line
      integer :: i, k

      call put(o, '')
      call put(o, ' WHAT --errors TELLS, AGAINST THE TRUE ERROR: blocks, the deck''s steps; of each instant the')
      call put(o, ' largest number, in the characteristic length and rate. TRUE, TOLD: the largest of all')
      call put(o, ' instants; LEAST, MEAN: told over true')
      call put(o, '')
      call put(o, ' TOLERANCE INSTANTS   POSITION'//repeat(' ', 24)//'VELOCITY'//repeat(' ', 24)//'ACCELERATION')
      call put(o, repeat(' ', 19)//repeat('    TRUE    TOLD   LEAST    MEAN', 3))
      do i = 1, size(tolerances)
         t = default_trial(p)
         t%tolerance = tolerances(i)
         call compare(m, t, truth, tally)
         write (line, '(es10.0, i9)') tolerances(i), tally%instants
         if (.not. tolerances(i) > 0.0_dp) line(:10) = '  ROUNDING'
         if (tally%instants > 0) then
            do k = 0, 2
               write (line(20 + 32*k:), '(4es8.1)') tally%true(k), tally%told(k), tally%least(k), &
                  exp(tally%logarithms(k)/tally%instants)
            end do
         end if
         call put(o, trim(line))
         if (tally%open > 0) call put(o, '    TOLD TO BE WITHOUT A KNOWN DIGIT: '//whole(tally%open)//' INSTANTS')
      end do
   end subroutine put_estimates

   subroutine compare(m, t, truth, tally)
      type(mechanism_t), intent(in) :: m
      type(trial_t), intent(in) :: t
      type(truth_t), intent(in) :: truth
      type(tally_t), intent(out) :: tally
      type(mechanism_t) :: one
      type(set_analysis_t) :: a
      type(motion_t) :: q
      integer :: k, there, every

      one = tried(m, t)
      call new_set_analysis(one, a)
      q = new_motion(size(m%links))
      every = t%stride*max(1, (t%last/t%stride)/enough)
      do k = 0, t%last
         call advance_set(a, one, real(instant_of(m, t, k), wp))
         if (mod(k, every) /= 0) cycle
         call put_together(a%now, q)
         if (q%known < 2) cycle
         there = true_sample(truth, t, k)
         if (truth%motion%known(there) < 2) cycle
         call sample_set(a, one, .true.)
         call add_instant(truth, there, q, set_errors(a, one), tally)
      end do
   end subroutine compare

   subroutine add_instant(truth, there, q, told, tally)
      type(truth_t), intent(in) :: truth
      integer, intent(in) :: there
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: told(0:2)
      type(tally_t), intent(inout) :: tally
      real(dp) :: true(0:2), ratio(0:2)

      if (any(told >= nothing_known)) then
         tally%open = tally%open + 1
         return
      end if
      true = [maxval(differences(truth, there, 0, real(q%position, qp))), &
         maxval(differences(truth, there, 1, real(q%velocity, qp))), &
         maxval(differences(truth, there, 2, real(q%acceleration, qp)))]
      ! By chance an error may be small: one below a rounding counts as that.
      ratio = real(told, dp)/max(true, real(epsilon(1.0_wp), dp))
      tally%instants = tally%instants + 1
      tally%true = max(tally%true, true)
      tally%told = max(tally%told, real(told, dp))
      tally%least = min(tally%least, ratio)
      tally%logarithms = tally%logarithms + log(max(ratio, tiny(1.0_dp)))
   end subroutine add_instant
end module study_estimates
