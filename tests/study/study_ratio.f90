!> Tests. `study_ratio NAME [WINDOWS-DECK]`: how many times a step by the default method takes the time of the closed
!> form written for speed, at the steps of the deck input/NAME.deck, set 1, or of the deck of so many windows: what
!> turns the ratios of `kinmat --study` into ratios to the closed form. Prints the least time over the least, since what
!> else the machine does only adds to either; 0 where there is no closed form.
program study_ratio
   use kinds, only: wp
   use mechanism, only: method_newton
   use bench_scenes, only: scene_t, new_scene, chain_scene, by_closed_form
   use bench_timing, only: job_t, measure
   implicit none
   integer, parameter :: repeats = 25
   !> Seconds of one measurement, at least.
   real(wp), parameter :: least = 0.003_wp
   type(scene_t) :: s(1)
   type(job_t) :: jobs(2)
   real(wp) :: time(2, repeats)
   character(200) :: name, decks

   call get_command_argument(1, name)
   call get_command_argument(2, decks)
   if (decks /= '') then
      s(1) = chain_scene(trim(decks), 'windows', 1000)
   else
      s(1) = new_scene('input/'//trim(name)//'.deck', trim(name), 1)
   end if
   if (.not. associated(s(1)%fast) .and. s(1)%chain%n == 0) then
      print '(a)', '0'
   else
      s(1)%steps = s(1)%m%steps
      s(1)%t0 = s(1)%m%t0
      s(1)%step = (s(1)%m%t1 - s(1)%m%t0)/s(1)%m%steps
      jobs = [job_t(1, by_closed_form), job_t(1, method_newton)]
      time = measure(s, jobs, repeats, least)
      print '(f0.3)', minval(time(2, :))/minval(time(1, :))
   end if
end program study_ratio
