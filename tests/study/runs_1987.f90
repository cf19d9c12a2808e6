!> Tests. Runs of the iteration of 1987: from how far it arrives, how many iterations that takes, and what a step costs.
module runs_1987
   use kinds, only: wp
   use mechanism, only: instant_count, instant, method_newton, method_dense, method_matrix
   use motion, only: motion_t, new_motion, flag_none
   use analysis, only: analysis_t, make_analysis, advance
   use bench_scenes, only: bench_t => scene_t, new_bench => new_scene, by_method, by_closed_form, move_exactly, &
      steps_of_turn, gap_t, widen
   use bench_timing, only: job_t, measure
   use bench_tools, only: figure
   use scenes_1987, only: scene_t, new_scene, exact, scene_names
   use iteration_1987, only: by_print, by_tangent, variant_names, run_t, iterate_from, went_right, went_wrong
   implicit none
   private
   public :: basins_table, counts_table, decks_table, times_table

   integer, parameter :: limit = 400

contains

   !> Shares of the starts that arrive, by the distance of the start.
   subroutine basins_table()
      integer, parameter :: distances(10) = [1, 5, 10, 15, 30, 45, 60, 90, 120, 180]
      type(scene_t) :: s
      character(8) :: shares(size(distances))
      integer :: i, k, variant

      print '(a)', '', &
         ' FROM HOW FAR IT ARRIVES: per cent of 144 starts, so many degrees of the crank before or after', &
         ' each of 0, 5, ..., 355 deg; after the stroke, per cent that come to another assembly. At most 400', &
         ' iterations', ''
      print '(a, 10i8)', ' MECHANISM         REFERENCES', distances
      do i = 1, size(scene_names)
         s = new_scene(i)
         do variant = by_print, by_tangent
            shares = [(share(s, variant, distances(k)), k=1, size(distances))]
            print '(1x, a16, 2x, a8, 1x, 10a8)', s%name, variant_names(variant), shares
         end do
      end do
   end subroutine basins_table

   function share(s, variant, distance) result(text)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant, distance
      character(8) :: text
      type(run_t) :: run
      integer :: k, side, right, wrong
      integer, parameter :: starts = 144

      right = 0
      wrong = 0
      do k = 0, 355, 5
         do side = -1, 1, 2
            run = iterate_from(s, variant, exact(s, k + side*distance), k, limit)
            if (run%ended == went_right) right = right + 1
            if (run%ended == went_wrong) wrong = wrong + 1
         end do
      end do
      write (text, '(i5)') floor(100.0_wp*right/starts)
      if (wrong > 0) write (text, '(i5, a, i0)') floor(100.0_wp*right/starts), '/', ceiling(100.0_wp*wrong/starts)
   end function share

   !> Iterations from the position 10 degrees before.
   subroutine counts_table()
      type(scene_t) :: s
      type(run_t) :: runs(0:71)
      integer :: i, k, variant

      print '(a)', '', &
         ' ITERATIONS FROM THE POSITION 10 DEG BEFORE, AT 72 ANGLES: mean and most, where it arrives, until', &
         ' the error is below 1E-6, 1E-10 and 1E-13, the limit of rounding', '', &
         ' MECHANISM         REFERENCES  ARRIVES      1E-6        1E-10        1E-13'
      do i = 1, size(scene_names)
         s = new_scene(i)
         do variant = by_print, by_tangent
            runs = [(iterate_from(s, variant, exact(s, 5*k - 10), 5*k, limit), k=0, 71)]
            associate (there => runs%ended == went_right)
               if (.not. any(there)) print '(1x, a16, 2x, a8, i11)', s%name, variant_names(variant), 0
               if (any(there)) print '(1x, a16, 2x, a8, i11, 3(f9.1, i4))', s%name, variant_names(variant), &
                  count(there), &
                  (real(sum(runs%counts(k), mask=there), wp)/count(there), maxval(runs%counts(k), mask=there), k=1, 3)
            end associate
         end do
      end do
   end subroutine counts_table

   !> The decks themselves by METHOD MATRIX and METHOD DENSE, with the program's predictions.
   subroutine decks_table()
      character(12), parameter :: decks(6) = [character(12) :: 'yoke', 'yoke', 'crank_slider', 'four_bar', 'four_bar', &
         'andrews']
      integer, parameter :: sets(6) = [1, 2, 1, 1, 2, 1]
      integer :: i

      print '(a)', '', ' THE DECKS, AS THE PROGRAM SOLVES THEM: each instant from the one before, continued with its', &
         ' velocity and acceleration; ITERATIONS of the last part of a step: mean and most; POSITION, VELOCITY,', &
         ' ACCEL.: largest errors against the closed form in real128, in the characteristic length and rate', '', &
         ' DECK          SET  METHOD  INSTANTS  SOLVED   ITERATIONS  POSITION  VELOCITY    ACCEL.'
      do i = 1, size(decks)
         call deck_row(trim(decks(i)), sets(i), method_matrix, 'MATRIX')
         call deck_row(trim(decks(i)), sets(i), method_dense, 'DENSE ')
      end do
   end subroutine decks_table

   subroutine deck_row(deck, set, method, name)
      character(*), intent(in) :: deck, name
      integer, intent(in) :: set, method
      type(bench_t) :: s
      type(analysis_t) :: a
      type(motion_t) :: found, there
      type(gap_t) :: g
      integer, allocatable :: iterations(:)
      character(13) :: text
      integer :: k

      s = new_bench('input/'//deck//'.deck', deck, set)
      call make_analysis(a, by_method(s, method))
      found = new_motion(size(s%m%links))
      there = found
      iterations = [integer ::]
      do k = 0, instant_count(s%m) - 1
         call advance(a, instant(s%m, k), found)
         if (found%flag /= flag_none) cycle
         iterations = [iterations, a%convergence%iterations]
         call move_exactly(s, instant(s%m, k), there)
         call widen(s, found, there, .true., g)
      end do
      k = size(iterations)
      text = deck
      if (k == 0) print '(1x, a13, i4, 2x, a6, i10, i8)', text, set, name, instant_count(s%m), k
      if (k > 0) print '(1x, a13, i4, 2x, a6, i10, i8, f9.1, i4, 3es10.1)', text, set, name, &
         instant_count(s%m), k, real(sum(iterations), wp)/k, maxval(iterations), g%worst
   end subroutine deck_row

   !> Time of a step as a ratio to the closed form and to METHOD DENSE, in steps of 0.1 and 10 degrees.
   subroutine times_table()
      print '(a)', '', &
         ' TIME OF A STEP, POSITION TO ACCELERATION: the least of 15 repeats over the least of the closed', &
         ' form in the same run', '', &
         ' MECHANISM  STEP/DEG  BLOCKS   DENSE  MATRIX  MATRIX/DENSE'
      call time_rows(1)
      call time_rows(100)
   end subroutine times_table

   subroutine time_rows(longer)
      integer, intent(in) :: longer
      integer, parameter :: repeats = 15, methods(4) = [by_closed_form, method_newton, method_dense, method_matrix]
      character(8), parameter :: names(2) = [character(8) :: 'yoke', 'four_bar']
      type(bench_t) :: scenes(2)
      type(job_t) :: jobs(8)
      real(wp) :: time(8, repeats)
      integer :: i, k

      do i = 1, 2
         scenes(i) = new_bench('input/'//trim(names(i))//'.deck', trim(names(i)), 1)
         scenes(i)%step = longer*scenes(i)%step
         scenes(i)%steps = max(120, steps_of_turn/longer)
         jobs(4*i - 3:4*i) = [(job_t(i, methods(k)), k=1, 4)]
      end do
      time = measure(scenes, jobs, repeats, 0.003_wp)
      do i = 1, 2
         associate (t => minval(time(4*i - 3:4*i, :), dim=2))
            print '(1x, a8, f11.1, 4a8)', names(i), 0.1_wp*longer, (figure(t(k)/t(1)), k=2, 4), figure(t(4)/t(3))
         end associate
      end do
   end subroutine time_rows
end module runs_1987
