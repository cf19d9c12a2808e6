!> The time between two known ones at which a number of a row, or a derivative of it, is zero: by motions at times
!> between, in a bracket that always holds the zero. The search begins at the zero of the polynomial through the known
!> numbers, and mostly the first motion shows that the zero is no new extreme.
module zero_search
   use kinds, only: wp
   use points, only: row_t, known_at
   use instant_centres, only: points_coincide
   use set_analysis, only: set_analysis_t, rows_at, errors_unasked, errors_in_doubt, errors_always
   use nodes, only: sample_t
   implicit none
   private
   public :: column_t, on_curve, find_zero, find_acceleration_extreme, differ_in_sign, noise_part

   !> Smaller derivatives, in characteristic ones or the largest near them, are zeros that rounding has moved.
   real(wp), parameter :: noise_part = 64.0_wp*epsilon(1.0_wp)
   !> The largest number of steps for one zero.
   integer, parameter :: max_zero_steps = 100
   !> Halvings that find a zero of the polynomial.
   integer, parameter :: curve_halvings = 26
   !> A step of Newton's method that is shorter than this part of the bracket ends at the zero, but for its square.
   real(wp), parameter :: short_newton_part = 1.0e-5_wp
   !> The derivative of the difference between an acceleration and its polynomial is at most this times the difference
   !> over the length of the interval.
   real(wp), parameter :: error_by_length = 16.0_wp
   !> The step of the stencil at an extreme of an acceleration becomes shorter by this factor, or longer by its inverse;
   !> so many stencils are tried at most.
   real(wp), parameter :: stencil_factor = 0.5_wp
   integer, parameter :: max_stencils = 16
   !> The error of a stencil's polynomial is this part of the fifth derivative, which is about the power 3/2 of the
   !> fourth over the second.
   real(wp), parameter :: truncated = 1.0_wp/30.0_wp
   !> An error of a time below this part of the largest time of the run is less than any digit of the time or of a
   !> drive.
   real(wp), parameter :: negligible_time = 1024.0_wp*epsilon(1.0_wp)
   !> A zero nearer to an end of its interval than this part is at the end: no table shows the difference.
   real(wp), parameter :: end_part = 1.0e-6_wp
   !> Steps of the iteration for the extreme of a stencil's polynomial.
   integer, parameter :: turn_steps = 6
   !> A bracket as narrow as so many roundings of the time is closed.
   real(wp), parameter :: closed_roundings = 4.0_wp
   !> The slope at a zero is taken to the last value that is so many times the noise.
   real(wp), parameter :: above_noise = 3.0_wp
   !> A value jumps if its values at both ends of a closed bracket differ by this part of the characteristic one.
   real(wp), parameter :: jump_part = 1.0e-3_wp
   !> Errors are at least two roundings of the characteristic value, this part of the noise.
   real(wp), parameter :: rounding_part = 1.0_wp/32.0_wp
   !> A time whose rounding error has a bound below this part of the largest time of the run needs no estimate of
   !> errors: a hundred times as much is no digit of a table.
   real(wp), parameter :: well_known_time = 2.0_wp**20*epsilon(1.0_wp)

   !> A column in the row of a request, in an interval in which a zero is searched for.
   type :: column_t
      integer :: request = 0, column = 0  !< number of the request in the set, and of the column (1 to 3) in its row
      real(wp) :: step = 0.0_wp           !< of the first stencil that gives the third derivative, in the unit of time
      real(wp) :: range(2) = 0.0_wp       !< times between which the stencil may be longer: the motion is smooth there
      real(wp) :: noise(0:2) = 0.0_wp     !< rounding errors of its derivatives
      real(wp) :: inside(2, 0:2) = 0.0_wp !< an extreme between these values is no new one
      !> The coefficients of its polynomial, in the time from the middle of the interval over half of it; 0: not known.
      real(wp) :: middle = 0.0_wp, half = 1.0_wp, curve(0:8) = 0.0_wp
   end type column_t

contains

   !> Gives a derivative of the polynomial of a column at a time.
   pure real(wp) function on_curve(column, k, t) result(f)
      type(column_t), intent(in) :: column   !< with its polynomial
      integer, intent(in) :: k               !< which derivative, at least 0
      real(wp), intent(in) :: t              !< time
      integer :: n, i

      f = 0.0_wp
      do n = ubound(column%curve, 1), k, -1
         f = f*((t - column%middle)/column%half) + column%curve(n)*real(product([(i, i=n - k + 1, n)]), wp)
      end do
      f = f/column%half**k
   end function on_curve

   !> Estimates the time at which a derivative of a column has a level, by the polynomial of the column. If the
   !> polynomial less the level does not change its sign, a straight line serves.
   pure real(wp) function guess(column, order, level, t, values)
      type(column_t), intent(in) :: column   !< with its polynomial
      integer, intent(in) :: order           !< which derivative
      real(wp), intent(in) :: level          !< in the unit of the derivative
      real(wp), intent(in) :: t(2)           !< times, the ends of the interval
      real(wp), intent(in) :: values(2)      !< the derivative less the level at the ends, of opposite signs
      real(wp) :: ends(2), first
      integer :: n

      ends = t
      first = on_curve(column, order, t(1)) - level
      if (differ_in_sign(first, on_curve(column, order, t(2)) - level)) then
         do n = 1, curve_halvings
            guess = ends(1) + 0.5_wp*(ends(2) - ends(1))
            ends(merge(2, 1, differ_in_sign(first, on_curve(column, order, guess) - level))) = guess
         end do
      else
         guess = t(2) - values(2)*((t(2) - t(1))/(values(2) - values(1)))
      end if
   end function guess

   !> Finds a column at a time. If the motion is not known there, sample%known is -1.
   subroutine evaluate_column(set, column, t, effort, sample)
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      type(column_t), intent(in) :: column   !< of a row of the set
      real(wp), intent(in) :: t              !< time
      integer, intent(in) :: effort          !< whether errors are estimated: errors_unasked, ...
      type(sample_t), intent(out) :: sample   !< at the time
      type(row_t) :: row(1)
      real(wp) :: error(3, 0:2, 1), amplification

      call rows_at(set, [column%request], t, effort, row, error, amplification)
      sample = sample_t(t, row(1)%value(column%column, :), error(column%column, :, 1), known_at(row(1)), &
         row(1)%state == points_coincide, amplification)
   end subroutine evaluate_column

   !> Finds a zero of a derivative of a column less a level. Newton's method runs in a bracket, which is halved if the
   !> method does not advance. If a time between has no motion, the nearest known one is the zero. Without a change of
   !> sign zero%known is -1.
   subroutine find_zero(set, column, order, level, before, after, zero)
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      type(column_t), intent(in) :: column   !< with its polynomial
      integer, intent(in) :: order           !< which derivative, 0 to 2
      real(wp), intent(in) :: level          !< in the unit of the derivative
      type(sample_t), intent(in) :: before, after   !< at the ends of the interval
      type(sample_t), intent(out) :: zero    !< at the time of the zero
      type(sample_t) :: at
      real(wp) :: t, ends(2), g(2), g_end(2), last, last_g, slope, step, width, clear(2)
      logical :: jumps
      integer :: n

      if (min(before%known, after%known) < 2) return
      ends = [before%t, after%t]
      g = [before%f(order), after%f(order)] - level
      if (.not. differ_in_sign(g(1), g(2))) return
      g_end = g
      jumps = .false.
      width = 0.0_wp
      clear = merge([before%t, g(1)], [after%t, g(2)], abs(g(1)) > abs(g(2)))
      last = after%t
      last_g = huge(1.0_wp)
      slope = 0.0_wp
      t = guess(column, order, level, ends, g)

      do n = 1, max_zero_steps
         if (.not. (t - ends(1))*(ends(2) - t) > 0.0_wp) t = ends(1) + 0.5_wp*(ends(2) - ends(1))
         if (abs(ends(2) - ends(1)) <= closed_roundings*spacing(maxval(abs(ends)))) then
            jumps = order == 0 .and. abs(g_end(2) - g_end(1)) > jump_part*column%noise(0)/noise_part
            exit
         end if
         call evaluate_column(set, column, t, errors_unasked, at)

         if (at%meets .and. order <= max(0, at%known + 1)) then
            ! A length whose points coincide turns there, and a direction jumps.
            zero = at
            zero%known = 2
            zero%t_error = closed_roundings*spacing(t)
            return
         end if
         if (at%known < 2) then
            width = abs(ends(2) - ends(1))
            t = last
            exit
         end if

         associate (f => at%f(order) - level)
            ends(merge(2, 1, differ_in_sign(f, g(1)))) = t
            g_end(merge(2, 1, differ_in_sign(f, g(1)))) = f
            if (order == 2) then
               slope = on_curve(column, 3, t)
            else
               slope = at%f(order + 1)
            end if

            step = 0.0_wp
            if (abs(slope) > 0.0_wp) step = -f/slope
            if (order > 0 .and. abs(step) <= short_newton_part*abs(after%t - before%t)) then
               zero = at
               zero%t = t + step
               if (order == 2) zero%f(2) = 0.0_wp
               zero%f(1) = at%f(1) + 0.5_wp*step*(at%f(2) + zero%f(2))
               zero%f(0) = at%f(0) + 0.5_wp*step*(at%f(1) + zero%f(1))
               if (is_inside(column, order - 1, zero%f(order - 1), 0.0_wp)) return
            end if
            ! The rest is rounding: further steps only follow it.
            if (abs(f) <= rounding_part*column%noise(order)) exit
            if (abs(slope) > 0.0_wp .and. abs(step) <= closed_roundings*spacing(t)) exit
            if (abs(f) <= column%noise(order) .and. abs(f) > 0.5_wp*abs(last_g)) exit
            if (abs(f) > above_noise*column%noise(order)) clear = [t, f]
            last = t
            t = t + step
            if (abs(f) > 0.5_wp*abs(last_g)) t = ends(1) + 0.5_wp*(ends(2) - ends(1))
            last_g = f
         end associate
      end do

      if (jumps) then
         ! A direction jumps if two points pass one another.
         call evaluate_column(set, column, t, errors_unasked, zero)
         zero%t_error = abs(ends(2) - ends(1)) + epsilon(1.0_wp)*maxval(abs(ends))
         zero%error = 0.0_wp
         return
      end if
      ! The slope from the zero to the last value that is more than noise, unless the slope near the zero is less.
      if (.not. (abs(clear(2)) > above_noise*column%noise(order) .and. abs(clear(1) - t) > 0.0_wp)) slope = 0.0_wp
      if (abs(slope) > 0.0_wp) slope = min(abs(slope), abs(clear(2)/(clear(1) - t)))
      call finish_zero(set, column, order, [before%t, after%t], t, slope, 1.0_wp, column%noise(order), width, zero)
   end subroutine find_zero

   !> Finds the extreme of the acceleration of a column between two times at which the third derivative of its
   !> polynomial has different signs: the extreme of another polynomial, through accelerations at five times near it.
   !> If the fourth difference counts, the times are too far apart; if rounding counts, they are too near. If the
   !> extreme is not found or is at an end, turn%known is -1.
   subroutine find_acceleration_extreme(set, column, before, after, turn)
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      type(column_t), intent(in) :: column   !< with its polynomial and the step of the first stencil
      type(sample_t), intent(in) :: before, after   !< at the ends of the interval
      type(sample_t), intent(out) :: turn    !< at the time of the extreme
      type(sample_t) :: at
      real(wp) :: f(-2:2), d(4), first, t, step, u, left, noise, slope, run
      real(wp) :: best_t, bend, best_step, best_noise, width, value
      integer :: i, k

      associate (length => after%t - before%t)
         first = guess(column, 3, 0.0_wp, [before%t, after%t], [-1.0_wp, 1.0_wp])
         t = first
         ! An extreme so near an end is at the end.
         if (min(abs(t - before%t), abs(after%t - t)) <= end_part*abs(length)) return
         call evaluate_column(set, column, t, errors_unasked, at)
         if (at%known < 2) return
         value = at%f(2)
         slope = abs(on_curve(column, 4, t))
         if (slope > 0.0_wp) then
            if (is_inside(column, 2, at%f(2), &
               0.5_wp*(error_by_length*(at%f(2) - on_curve(column, 2, t))/length)**2/slope)) then
               turn = at
               return
            end if
         end if

         run = max(abs(set%now%t0), abs(set%now%t1))
         step = sign(column%step, length)
         ! The extreme of the best stencil so far: none.
         best_t = first
         bend = 0.0_wp
         best_step = 1.0_wp
         best_noise = 0.0_wp
         width = 0.0_wp
         do i = 1, max_stencils
            ! The five times are all in the range.
            if (4.0_wp*abs(step) > abs(column%range(2) - column%range(1))) exit
            u = min(max((t - column%range(1))/step, 2.0_wp), &
               (column%range(2) - column%range(1))/step - 2.0_wp) - (t - column%range(1))/step
            t = t + u*step
            do k = -2, 2
               call evaluate_column(set, column, t + k*step, errors_unasked, at)
               if (at%known < 2) exit
               f(k) = at%f(2)
            end do
            if (at%known < 2) exit
            d = [(8.0_wp*(f(1) - f(-1)) - f(2) + f(-2))/12.0_wp, &
               (16.0_wp*(f(1) + f(-1)) - 30.0_wp*f(0) - f(2) - f(-2))/12.0_wp, &
               0.5_wp*(f(2) - f(-2)) - f(1) + f(-1), f(2) + f(-2) - 4.0_wp*(f(1) + f(-1)) + 6.0_wp*f(0)]
            if (.not. abs(d(2)) > 0.0_wp) exit

            noise = max(column%noise(2), noise_part*maxval(abs(f)))
            u = 0.0_wp
            do k = 1, turn_steps
               u = -(d(1) + u**2*(0.5_wp*d(3) + u*d(4)/6.0_wp))/d(2)
               u = min(max(u, (before%t - t)/step), (after%t - t)/step)
            end do
            t = t + u*step
            left = truncated*abs(step)*abs(d(4)/d(2))**1.5_wp

            if (abs(d(4)) > noise .and. left > max(negligible_time*run, rounding_part*noise*abs(step/d(2)))) then
               if (bend > 0.0_wp) exit
               step = stencil_factor*step
            else if (abs(u) <= 2.0_wp) then
               best_t = t
               bend = abs(d(2))/step**2
               best_step = abs(step)
               best_noise = noise/abs(step)
               width = left
               if (rounding_part*best_noise <= well_known_time*run*bend) exit
               step = step/stencil_factor
            end if
         end do

         ! If no stencil serves, the time may be anywhere in the interval, unless an end is more extreme. If the
         ! extreme of a stencil is at an end, the extreme of the polynomial counts, and the time between both is its
         ! error; within a step they are one, at the end.
         if (.not. bend > 0.0_wp .and. maxval([before%f(2), after%f(2)]*sign(1.0_wp, -on_curve(column, 4, first))) &
            >= value*sign(1.0_wp, -on_curve(column, 4, first))) return
         if (min(abs(best_t - before%t), abs(after%t - best_t)) <= end_part*abs(length)) then
            left = abs(best_t - first)
            if (left <= best_step) return
            best_t = first
            width = max(width, left)
         end if
         call finish_zero(set, column, 2, [before%t, after%t], best_t, bend, best_step, best_noise, width, turn)
      end associate
   end subroutine find_acceleration_extreme

   !> Finds a column at the time of a zero, and the error of that time: the error of the derivative, or of its
   !> difference, over the slope, and the width of the bracket. Errors of the column are estimated only if the error of
   !> the time may count.
   subroutine finish_zero(set, column, order, ends, t, slope, step, noise, width, zero)
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      type(column_t), intent(in) :: column   !< with its noise
      integer, intent(in) :: order           !< the derivative whose error counts
      real(wp), intent(in) :: ends(2)        !< times, the ends of the interval: without a slope its length is the error
      real(wp), intent(in) :: t              !< time of the zero
      real(wp), intent(in) :: slope          !< of the derivative, or of its difference over `step`, by time; 0: unknown
      real(wp), intent(in) :: step           !< time over which the derivative is a difference; 1: it is none
      real(wp), intent(in) :: noise          !< rounding error of the derivative over `step`
      real(wp), intent(in) :: width          !< time: further error
      type(sample_t), intent(out) :: zero    !< with the error of its time
      real(wp) :: open
      integer :: i

      do i = 1, 2
         ! An estimate of errors takes nine solutions.
         call evaluate_column(set, column, t, merge(errors_always, errors_in_doubt, i == 2), zero)
         open = zero%error(order)
         if (.not. open > 0.0_wp) open = zero%amplification*(epsilon(1.0_wp)/noise_part)*column%noise(order)
         zero%t_error = abs(ends(2) - ends(1))
         if (slope > 0.0_wp) zero%t_error = width + epsilon(1.0_wp)*maxval(abs(ends)) &
            + (open/step + rounding_part*noise)/slope
         if (zero%t_error <= well_known_time*max(abs(set%now%t0), abs(set%now%t1))) exit
      end do
   end subroutine finish_zero

   !> Tells whether a value of a derivative of a column is no new extreme.
   pure logical function is_inside(column, k, value, open)
      type(column_t), intent(in) :: column   !< with `inside`
      integer, intent(in) :: k               !< which derivative, 0 to 2
      real(wp), intent(in) :: value          !< in the unit of the derivative
      real(wp), intent(in) :: open           !< bound of the error of the value

      is_inside = value - open > column%inside(1, k) .and. value + open < column%inside(2, k)
   end function is_inside

   !> Tells whether one number is positive and the other negative.
   pure logical function differ_in_sign(first, second)
      real(wp), intent(in) :: first, second   !< in any unit

      differ_in_sign = (first > 0.0_wp .and. second < 0.0_wp) .or. (first < 0.0_wp .and. second > 0.0_wp)
   end function differ_in_sign
end module zero_search
