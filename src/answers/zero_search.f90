!> The time between two known ones at which a number of a row, or a derivative of it, is zero: by values of the motion
!> alone, in a bracket that holds the zero from the first to the last.
module zero_search
   use kinds, only: wp
   use points, only: row_t
   use set_analysis, only: set_analysis_t, rows_at
   use nodes, only: sample_t
   implicit none
   private
   public :: column_t, find_zero, find_turn, differ_in_sign, noise_part

   !> Smaller derivatives, in characteristic ones or the largest about them, are zeros that rounding has moved.
   real(wp), parameter :: noise_part = 64.0_wp*epsilon(1.0_wp)
   integer, parameter :: max_iterations = 100
   !> Five times at which the fourth difference is more than this part of the second are brought nearer by this factor;
   !> so many of them at most.
   real(wp), parameter :: fine = 1.0e-5_wp, shorter = 0.5_wp
   integer, parameter :: max_stencils = 16
   !> Steps of the iteration for the extreme of their polynomial.
   integer, parameter :: turn_steps = 6
   !> A bracket as narrow as so many roundings of the time is closed.
   real(wp), parameter :: closed = 4.0_wp
   !> The slope at a zero is that to the last value that is so many times the noise.
   real(wp), parameter :: above_noise = 3.0_wp
   !> Errors are two roundings of the characteristic value at least, this part of the noise.
   real(wp), parameter :: rounding_part = 1.0_wp/32.0_wp
   !> A time that is known to this part of the largest of the run, by a bound of what rounding leaves open, needs no
   !> estimate of errors: a hundred times as much is no digit of a table.
   real(wp), parameter :: well_known = 2.0_wp**20*epsilon(1.0_wp)

   !> Which number: its column (1 to 3) in the row of a request of the set; `step`: of the stencil that gives the third
   !> derivative, in the unit of time; `noise` (0:2): rounding errors of its derivatives.
   type :: column_t
      integer :: request = 0, column = 0
      real(wp) :: step = 0.0_wp
      real(wp) :: noise(0:2) = 0.0_wp
   end type column_t

contains

   !> The column `c` at the time `t`; `with_errors` (if present): they are estimated also where no digit is in doubt.
   subroutine look_at_column(s, c, t, sample, with_errors)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      real(wp), intent(in) :: t
      type(sample_t), intent(out) :: sample
      logical, intent(in), optional :: with_errors
      type(row_t) :: row(1)
      real(wp) :: error(3, 0:2, 1), growth

      call rows_at(s, s%now%rows(c%request)%part, [c%request], t, row, with_errors, error, growth)
      sample = sample_t(t, row(1)%value(c%column, :), error(c%column, :, 1), row(1)%known, growth)
   end subroutine look_at_column

   !> Where between `a` and `b` the derivative number `order` (0 to 2) of column `c`, less `level`, is zero: it has
   !> opposite signs there. The method of false position with halved values (Illinois: Dowell and Jarratt, BIT 11,
   !> 1971). Where a time between has no motion, the nearest known one is the zero. `zero`%known is -1 where the
   !> signs were the same.
   subroutine find_zero(s, c, order, level, a, b, zero)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      integer, intent(in) :: order
      real(wp), intent(in) :: level
      type(sample_t), intent(in) :: a, b
      type(sample_t), intent(out) :: zero
      type(sample_t) :: at
      real(wp) :: t, t1, t2, g1, g2, g, last, width, slope, clear(2)
      integer :: n

      if (min(a%known, b%known) < 2) return
      t1 = a%t
      t2 = b%t
      g1 = a%f(order) - level
      g2 = b%f(order) - level
      if (.not. differ_in_sign(g1, g2)) return
      width = 0.0_wp
      clear = merge([t1, g1], [t2, g2], abs(g1) > abs(g2))
      last = t2
      do n = 1, max_iterations
         t = t2 - g2*((t2 - t1)/(g2 - g1))
         if (.not. (t - t1)*(t2 - t) > 0.0_wp) t = t1 + 0.5_wp*(t2 - t1)
         if (min(abs(t2 - t1), abs(t - last)) <= closed*spacing(max(abs(t1), abs(t2)))) exit
         last = t
         call look_at_column(s, c, t, at)
         if (at%known < 2) then
            width = abs(t2 - t1)
            t = t2
            exit
         end if
         g = at%f(order) - level
         ! What is left is rounding: further steps only follow it.
         if (abs(g) <= rounding_part*c%noise(order)) exit
         if (abs(g) > above_noise*c%noise(order)) clear = [t, g]
         if (differ_in_sign(g, g2)) then
            t1 = t2
            g1 = g2
         else
            g1 = 0.5_wp*g1
         end if
         t2 = t
         g2 = g
      end do
      ! The slope from the zero to the last value that is more than noise.
      slope = 0.0_wp
      if (abs(clear(2)) > above_noise*c%noise(order) .and. abs(clear(1) - t) > 0.0_wp) &
         slope = abs(clear(2)/(clear(1) - t))
      call settle(s, c, order, [a%t, b%t], t, slope, 1.0_wp, c%noise(order), width, zero)
   end subroutine find_zero

   !> The extreme `turn` of the acceleration of column `c` between the first and the last of three `points`, at which
   !> its derivative `jerk` (2) has different signs: that of the polynomial through accelerations at five times about
   !> it, beginning where the parabola of the derivative with the change of the accelerations is zero. Where the fourth
   !> difference counts, the times are too far apart. `turn`%known is -1 where it is not found.
   subroutine find_turn(s, c, points, jerk, turn)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      type(sample_t), intent(in) :: points(:)
      real(wp), intent(in) :: jerk(2)
      type(sample_t), intent(out) :: turn
      type(sample_t) :: at
      real(wp) :: f(-2:2), d(4), t, step, length, bend, steep, u, noise
      integer :: i, k

      associate (a => points(1), b => points(3))
         length = b%t - a%t
         bend = 3.0_wp*(2.0_wp*(b%f(2) - a%f(2))/length - jerk(1) - jerk(2))
         steep = jerk(2) - jerk(1) + bend
         t = -2.0_wp*length*jerk(1)/(steep + sign(sqrt(max(0.0_wp, steep**2 + 4.0_wp*bend*jerk(1))), jerk(2)))
         step = sign(c%step, length)
         do i = 1, max_stencils
            ! From `a`, at five times that are all between the ends.
            t = step*min(max(t/step, 2.0_wp), length/step - 2.0_wp)
            do k = -2, 2
               call look_at_column(s, c, a%t + (t + k*step), at)
               if (at%known < 2) return
               f(k) = at%f(2)
            end do
            d = [(8.0_wp*(f(1) - f(-1)) - f(2) + f(-2))/12.0_wp, &
               (16.0_wp*(f(1) + f(-1)) - 30.0_wp*f(0) - f(2) - f(-2))/12.0_wp, &
               0.5_wp*(f(2) - f(-2)) - f(1) + f(-1), f(2) + f(-2) - 4.0_wp*(f(1) + f(-1)) + 6.0_wp*f(0)]
            if (.not. abs(d(2)) > 0.0_wp) return
            noise = max(c%noise(2), noise_part*maxval(abs(f)))
            u = 0.0_wp
            do k = 1, turn_steps
               u = -(d(1) + u**2*(0.5_wp*d(3) + u*d(4)/6.0_wp))/d(2)
               u = min(max(u, -t/step), (length - t)/step)
            end do
            t = t + u*step
            if (abs(d(4)) > max(fine*abs(d(2)), noise)) then
               step = shorter*step
            else if (abs(u) <= 2.0_wp) then
               call settle(s, c, 2, [a%t, b%t], a%t + t, abs(d(2))/step**2, abs(step), noise/abs(step), 0.0_wp, turn)
               return
            end if
         end do
      end associate
   end subroutine find_turn

   !> The column `c` at the time `t` between the `ends` (2) at which a derivative that has this `slope` is zero: it is
   !> open by the error of derivative number `order` over the `step` of a difference, by `noise`, and by `width`.
   subroutine settle(s, c, order, ends, t, slope, step, noise, width, zero)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      integer, intent(in) :: order
      real(wp), intent(in) :: ends(2), t, slope, step, noise, width
      type(sample_t), intent(out) :: zero
      real(wp) :: open
      integer :: i

      do i = 1, 2
         ! An estimate of errors takes nine solutions.
         call look_at_column(s, c, t, zero, i == 2)
         open = zero%error(order)
         if (.not. open > 0.0_wp) open = zero%growth*(epsilon(1.0_wp)/noise_part)*c%noise(order)
         zero%t_error = abs(ends(2) - ends(1))
         if (slope > 0.0_wp) zero%t_error = width + epsilon(1.0_wp)*maxval(abs(ends)) &
            + (open/step + rounding_part*noise)/slope
         if (zero%t_error <= well_known*max(abs(s%now%t0), abs(s%now%t1))) exit
      end do
   end subroutine settle

   !> One is positive, the other negative.
   pure logical function differ_in_sign(x, y)
      real(wp), intent(in) :: x, y

      differ_in_sign = (x > 0.0_wp .and. y < 0.0_wp) .or. (x < 0.0_wp .and. y > 0.0_wp)
   end function differ_in_sign
end module zero_search
