!> Tests. Seconds a step of several methods on several scenes, all of them one after another within each repeat, so that
!> what disturbs the machine for a while disturbs them alike.
module bench_timing
   use kinds, only: wp
   use motion, only: motion_t, new_motion
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set
   use bench_scenes, only: scene_t, by_method, move_fast, instant_of, by_closed_form
   use study, only: seconds
   implicit none
   private
   public :: job_t, measure

   !> Instants solved before the clock is looked at: from the fourth on, the start of a step is as good as it gets.
   integer, parameter :: warm = 4

   !> One method on one scene.
   type :: job_t
      integer :: scene = 0, method = by_closed_form
      integer :: steps = 0, passes = 1
   end type job_t

contains

   !> Seconds a step (jobs, repeats). Each measurement lasts `least` seconds or more, as far as `jobs` lets it: a pass
   !> over the scene's instants is repeated, or cut short where it takes too long.
   function measure(scenes, jobs, repeats, least) result(time)
      type(scene_t), intent(in) :: scenes(:)
      type(job_t), intent(inout) :: jobs(:)
      integer, intent(in) :: repeats
      real(wp), intent(in) :: least
      real(wp) :: time(size(jobs), repeats)
      integer :: i, k

      do i = 1, size(jobs)
         call settle(scenes(jobs(i)%scene), least, jobs(i))
      end do
      do k = 1, repeats
         do i = 1, size(jobs)
            time(i, k) = one_measurement(scenes(jobs(i)%scene), jobs(i))
         end do
      end do
   end function measure

   !> How many steps and passes a measurement takes.
   subroutine settle(s, least, job)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: least
      type(job_t), intent(inout) :: job
      real(wp) :: one
      integer, parameter :: fewest = 8

      job%steps = min(fewest, s%steps - warm)
      one = one_measurement(s, job)
      if (one*job%steps < least) then
         job%steps = max(job%steps, min(s%steps - warm, ceiling(least/one)))
         one = one_measurement(s, job)
      end if
      job%passes = max(1, ceiling(least/(one*job%steps)))
   end subroutine settle

   !> Seconds a step.
   real(wp) function one_measurement(s, job) result(time)
      type(scene_t), intent(in) :: s
      type(job_t), intent(in) :: job
      type(motion_t) :: q
      real(wp) :: t(0:warm + job%steps)
      integer :: i, k

      t = [(instant_of(s, k), k=0, warm + job%steps)]
      q = new_motion(size(s%m%links))
      time = 0.0_wp
      do i = 1, job%passes
         if (job%method == by_closed_form) then
            call pass_fast(s, t, q, time)
         else
            call pass_solved(s, job%method, t, q, time)
         end if
      end do
      if (.not. all(abs(q%position) <= huge(1.0_wp))) error stop 'A MOTION WITHOUT BOUNDS'
      time = time/(real(job%passes, wp)*job%steps)
   end function one_measurement

   !> Adds the time of one pass over the instants `t` to `time`.
   subroutine pass_fast(s, t, q, time)
      type(scene_t), intent(in) :: s
      real(wp), intent(in) :: t(0:)
      type(motion_t), intent(inout) :: q
      real(wp), intent(inout) :: time
      real(wp) :: begun
      integer :: k

      do k = 0, warm
         call move_fast(s, t(k), q)
      end do
      begun = seconds()
      do k = warm + 1, ubound(t, 1)
         call move_fast(s, t(k), q)
      end do
      time = time + seconds() - begun
   end subroutine pass_fast

   !> Likewise by the program: the whole of a step, but for printing.
   subroutine pass_solved(s, method, t, q, time)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: method
      real(wp), intent(in) :: t(0:)
      type(motion_t), intent(inout) :: q
      real(wp), intent(inout) :: time
      type(set_analysis_t) :: a
      real(wp) :: begun
      integer :: k

      call make_set_analysis(by_method(s, method), a)
      do k = 0, warm
         call advance_set(a, t(k))
      end do
      begun = seconds()
      do k = warm + 1, ubound(t, 1)
         call advance_set(a, t(k))
      end do
      time = time + seconds() - begun
      q = a%now%motions(1)
   end subroutine pass_solved
end module bench_timing
