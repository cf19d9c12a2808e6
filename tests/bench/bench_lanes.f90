!> Tests. Variants in the lanes of the processor: the time of a step of one of them beside the closed form, and the
!> errors of the lanes' sines.
module bench_lanes
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use set_analysis, only: make_set_analysis
   use lane_runs, only: lane_run_t, begin_run, run_lanes, lane_count
   use lane_state, only: lanes_t
   use lane_sines, only: max_angle
   use study, only: seconds
   use test_counter, only: test_counter_t, count_one, conclude
   use sine_errors, only: largest_sine_error
   use bench_tools, only: spread_t, spread_of, figure
   use bench_scenes, only: scene_t, new_scene, chain_scene, by_closed_form, steps_of_turn
   use bench_timing, only: job_t, measure
   implicit none
   private
   public :: lanes_table, judge_sines

   integer, parameter :: repeats = 15
   real(wp), parameter :: least = 0.003_wp, nano = 1.0e9_wp

contains

   !> One turn in steps of 0.1 deg of as many variants at a time as there are lanes, whose instants are counted, and
   !> with EXTREMES of all their links. `decks`: the directory of the chains.
   subroutine lanes_table(decks)
      character(*), intent(in) :: decks
      type(scene_t) :: scenes(5)
      type(job_t) :: jobs(size(scenes))
      real(wp) :: closed(size(scenes), repeats), time(size(scenes), 2, repeats), one(size(scenes), 1)
      type(spread_t) :: ratio, own
      integer :: i, k, with

      scenes(1) = new_scene('input/four_bar.deck', 'four_bar', 1)
      scenes(2) = new_scene('input/yoke.deck', 'yoke', 1)
      scenes(3) = new_scene('input/andrews.deck', 'andrews', 1)
      scenes(4) = new_scene('input/jansen.deck', 'jansen', 1)
      scenes(5) = chain_scene(decks, 'windows', 10)
      jobs = [(job_t(i, by_closed_form), i=1, size(scenes))]
      do k = 1, repeats
         one = measure(scenes, jobs, 1, least)
         closed(:, k) = one(:, 1)
         do i = 1, size(scenes)
            time(i, 1, k) = time_of(scenes(i), .false.)
            time(i, 2, k) = time_of(scenes(i), .true.)
         end do
      end do
      print '(a)', '', &
         ' VARIANTS IN LANES, 3600 STEPS A TURN: A STEP OF ONE VARIANT, FROM THE THIRD INSTANT TO THE LAST', &
         ' RATIO, BEST AND NS AS ABOVE; EXTREMES: of all links', '', &
         ' MECHANISM             RATIO   LEAST    MOST    BEST      NS'
      do i = 1, size(scenes)
         do with = 1, 2
            ratio = spread_of(time(i, with, :)/closed(i, :))
            own = spread_of(time(i, with, :)*nano)
            print '(1x, a10, 1x, a8, 5a8)', scenes(i)%name//repeat(' ', 10), trim(merge('EXTREMES', '        ', &
               with == 2)) &
               //repeat(' ', 8), figure(ratio%median), figure(ratio%least), figure(ratio%most), &
               figure(own%least/(nano*minval(closed(i, :)))), figure(own%median)
         end do
      end do
   end subroutine lanes_table

   !> Seconds a step and variant of the scene `s`.
   real(wp) function time_of(s, extremes) result(time)
      type(scene_t), intent(in) :: s
      logical, intent(in) :: extremes
      type(mechanism_t) :: m(1)
      type(lane_run_t), allocatable :: runs(:)
      type(lanes_t) :: lanes
      integer :: i

      allocate (runs(lane_count))
      m(1) = s%m
      m(1)%steps = steps_of_turn
      m(1)%t1 = m(1)%t0 + steps_of_turn*s%step
      m(1)%at = [real(wp) ::]
      m(1)%requests%extremes = extremes
      do i = 1, lane_count
         runs(i)%m = m(1)
         call make_set_analysis(runs(i)%m, runs(i)%s)
         call begin_run(runs(i))
      end do
      time = seconds()
      call run_lanes(runs, lanes)
      time = (seconds() - time)/(steps_of_turn*lane_count)
      if (.not. all(runs%is_over) .or. any(runs%counts%flagged > 0)) error stop 'A VARIANT OF THE BENCH HAS NO MOTION'
   end function time_of

   !> Compares the lanes' sines and cosines of `count` angles with those of real128; ends with status 1 if one is off by
   !> more than 0.8 of its last digit.
   subroutine judge_sines(count)
      integer, intent(in) :: count
      type(test_counter_t) :: counter
      real(wp) :: largest

      largest = max(largest_sine_error(count/2, 7.0_wp), largest_sine_error(count/2, max_angle))
      print '(a, i0, a, f5.3)', ' SINES AND COSINES IN LANES OF ', count, &
         ' ANGLES: THE LARGEST ERROR IN LAST DIGITS: ', largest
      call count_one(counter, largest < 0.8_wp, 'sines and cosines')
      call conclude(counter)
   end subroutine judge_sines
end module bench_lanes
