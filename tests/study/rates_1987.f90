!> Tests. Rates of the iteration of 1987 over a turn of the crank, measured beside the theory: the table, the numbers of
!> the picture, and the short form of both that judges.
module rates_1987
   use kinds, only: wp
   use quad_jet, only: degree_q
   use test_counter, only: test_counter_t, count_one
   use scenes_1987, only: scene_t, new_scene, exact, scene_names
   use iteration_1987, only: by_print, by_step, by_tangent, by_dyad, variant_names, rate_by_theory, rate_measured, &
      order_measured, run_t, iterate_from, went_right
   implicit none
   private
   public :: rates_table, constants_table, picture_numbers, judge_rates

   !> Iterations over which a rate is the mean: two eigenvalues of one modulus make it swing by some per cent of
   !> 1/steps.
   integer, parameter :: steps = 400

contains

   !> Least and largest rate over the turn, and where the iteration converges.
   subroutine rates_table()
      type(scene_t) :: s
      integer :: i, variant

      print '(a)', ' THE ITERATION OF 1987: ITS RATE NEAR THE SOLUTION, AT EVERY SECOND DEGREE OF THE CRANK', &
         ' THEORY: spectral radius of I - A^-1 J at the closed form, in real128; MEASURED: mean factor of the error', &
         ' over 400 iterations, the error brought back to 1E-6 after each; OFF: the largest difference of the two, relative', &
         ' or, below 0.01, in parts of 0.01', &
         ' NO MATRIX: angles at which A is singular or c(0) infinite; CONVERGES: angles with a rate below 1, of 180', &
         '', &
         ' MECHANISM         REFERENCES     THEORY              MEASURED          OFF     NO MATRIX  CONVERGES'
      do i = 1, size(scene_names)
         s = new_scene(i)
         do variant = by_print, by_step
            call rates_row(s, variant)
         end do
         call newton_row(s)
      end do
   end subroutine rates_table

   subroutine rates_row(s, variant)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant
      real(wp) :: expected(0:179), found(0:179), off
      character(60) :: ranges
      integer :: k

      do k = 0, 179
         expected(k) = rate_by_theory(s, variant, 2*k)
         found(k) = rate_measured(s, variant, 2*k, steps)
      end do
      associate (there => expected >= 0.0_wp .and. found >= 0.0_wp)
         off = 0.0_wp
         if (any(there)) off = maxval(abs(found - expected)/max(0.01_wp, expected), mask=there)
         ranges = '        -                   -              -'
         if (any(there)) write (ranges, '(2f9.3, 2x, 2f9.3, f10.4)') minval(expected, mask=there), &
            maxval(expected, mask=there), minval(found, mask=there), maxval(found, mask=there), off
         print '(1x, a16, 2x, a8, a50, i8, i11)', s%name, variant_names(variant), ranges, count(.not. there), &
            count(there .and. found < 1.0_wp)
      end associate
   end subroutine rates_row

   !> Newton's order in the place of a rate.
   subroutine newton_row(s)
      type(scene_t), intent(inout) :: s
      real(wp) :: order(0:179)
      integer :: k

      order = [(order_measured(s, by_tangent, 2*k), k=0, 179)]
      print '(1x, a16, 2x, a8, a, f6.3, a, f6.3)', s%name, variant_names(by_tangent), '  order of the error: ', &
         minval(order), ' to', maxval(order)
   end subroutine newton_row

   !> One reference for each link of the four-bar's dyad: constants for the whole turn, and anew at each step.
   subroutine constants_table()
      type(scene_t) :: s
      type(run_t) :: run
      integer :: best(2), k, one_degree, ten_degrees
      real(wp) :: largest

      s = new_scene(3)
      call best_constants(s, best, largest)
      print '(a)', '', ' FOUR-BAR, ONE REFERENCE FOR BOTH ROWS OF A LINK'
      print '(a, f6.3, a, i0, a, i0, a)', &
         ' Constants for the whole turn, the best of -720, -718, ..., 720 deg: largest rate', &
         largest, ' (coupler ', best(1), ', rocker ', best(2), ' deg)'
      one_degree = 0
      ten_degrees = 0
      do k = 0, 355, 5
         run = iterate_from(s, by_dyad, exact(s, k - 1), k, 400)
         if (run%ended == went_right) one_degree = one_degree + 1
         run = iterate_from(s, by_dyad, exact(s, k - 10), k, 400)
         if (run%ended == went_right) ten_degrees = ten_degrees + 1
      end do
      print '(a, es8.1)', ' Those with which G is nilpotent at the solution: largest rate by theory', &
         maxval([(rate_by_theory(s, by_dyad, k), k=0, 350, 10)])
      print '(a, i0, a, i0, a)', ' Chosen so at the start of the step, it arrives from 1 deg before at ', one_degree, &
         ' of 72 angles, from 10 deg before at ', ten_degrees
   end subroutine constants_table

   !> The constants (deg) of coupler and rocker with the least largest rate over the turn.
   subroutine best_constants(s, best, largest)
      type(scene_t), intent(in) :: s
      integer, intent(out) :: best(2)
      real(wp), intent(out) :: largest
      real(wp), allocatable :: three(:), four(:), half(:)
      complex(wp), allocatable :: root(:)
      real(wp), parameter :: degree = real(degree_q, wp)
      real(wp) :: rate
      integer :: a, b

      associate (phi => real(s%turn(3, :, ::3), wp))
         largest = huge(largest)
         do a = -720, 720, 2
            three = phi(3, :) - a*degree
            do b = -720, 720, 2
               four = phi(4, :) - b*degree
               half = 0.5_wp*(four - three)/tan(phi(4, :) - phi(3, :))
               root = sqrt(cmplx(half**2 - three*four, 0.0_wp, wp))
               rate = maxval(max(abs(1.0_wp - half - root), abs(1.0_wp - half + root)))
               if (rate >= largest) cycle
               largest = rate
               best = [a, b]
            end do
         end do
      end associate
   end subroutine best_constants

   !> For the picture, a block for each of the first five mechanisms: crank angle, then theory and measurement of
   !> printed, once and nearest; last a block with the errors of the four-bar, iteration by iteration. '-' where there
   !> is none.
   subroutine picture_numbers()
      type(scene_t) :: s
      type(run_t) :: runs(3)
      integer :: i, k, variant
      integer, parameter :: shown(3) = [by_print, by_step, by_tangent]

      do i = 1, 5
         s = new_scene(i)
         print '(2a)', '# ', s%name
         do k = 0, 360, 2
            print '(i4, 6a10)', k, (number(rate_by_theory(s, variant, k)), number(rate_measured(s, variant, k, &
               steps)), &
               variant=by_print, by_step)
         end do
         print '(a)', '', ''
      end do
      s = new_scene(3)
      runs = [(iterate_from(s, shown(i), exact(s, 50), 60, 400), i=1, 3)]
      print '(a)', '# four-bar: errors at 60 deg from 50 deg, printed, nearest, Newton'
      do k = 0, 20
         print '(i4, 3a12)', k, (error_text(runs(i)%errors(k)), i=1, 3)
      end do
   end subroutine picture_numbers

   function number(rate) result(text)
      real(wp), intent(in) :: rate
      character(10) :: text

      text = '         -'
      if (rate >= 1.0e-4_wp) write (text, '(f10.5)') rate
   end function number

   !> Nothing beyond the end of a run.
   function error_text(error) result(text)
      real(wp), intent(in) :: error
      character(12) :: text

      text = '           -'
      if (error > 0.0_wp) write (text, '(es12.3)') error
   end function error_text

   !> At every 15 degrees: measurement and theory agree; from close by the iteration arrives where the theory says less
   !> than 1, and nowhere else; Newton's order is 2.
   subroutine judge_rates(counter)
      type(test_counter_t), intent(inout) :: counter
      type(scene_t) :: s
      integer :: i, k, variant

      do i = 1, size(scene_names)
         s = new_scene(i)
         do variant = by_print, by_step
            do k = 0, 345, 15
               call judge_one(s, variant, k, counter)
            end do
         end do
         do k = 0, 345, 15
            ! The next term of the error, 1e-3 of the second, and its factor of some units.
            call count_one(counter, abs(order_measured(s, by_tangent, k) - 2.0_wp) <= 0.02_wp, &
               scene_text(s, by_tangent, k)//'order 2')
         end do
      end do
   end subroutine judge_rates

   subroutine judge_one(s, variant, angle, counter)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant, angle
      type(test_counter_t), intent(inout) :: counter
      !> Relative, and what rounding (1e-16 of 1e-6 a step, times a condition of 100) and the square of the error leave.
      real(wp), parameter :: tolerance = 0.05_wp, rounding = 1.0e-3_wp
      !> At a rate of 0.98 an error of 0.01 takes 1300 iterations to the rounding level.
      integer, parameter :: limit = 2000
      type(run_t) :: run
      real(wp) :: expected, found

      expected = rate_by_theory(s, variant, angle)
      found = rate_measured(s, variant, angle, steps)
      ! Beside a place where A is singular it has an inverse, which throws the iteration far away.
      call count_one(counter, merge(found < 0.0_wp .or. found > 1.0e3_wp, &
         abs(found - expected) <= tolerance*expected + rounding, expected < 0.0_wp), &
         scene_text(s, variant, angle)//'the rate is that of the theory')
      ! So close to 1 neither end would come.
      if (abs(expected - 1.0_wp) < 0.02_wp) return
      run = iterate_from(s, variant, exact(s, angle - 1), angle, limit)
      call count_one(counter, (run%ended == went_right) .eqv. (expected >= 0.0_wp .and. expected < 1.0_wp), &
         scene_text(s, variant, angle)//'it arrives where the rate is below 1')
   end subroutine judge_one

   !> What is judged: the mechanism, the references, the crank's angle.
   function scene_text(s, variant, angle) result(text)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: variant, angle
      character(60) :: text

      write (text, '(4a, i0, a)') trim(s%name), ', ', trim(variant_names(variant)), ', crank at ', angle, ' deg: '
   end function scene_text
end module rates_1987
