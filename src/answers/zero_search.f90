!> The time between two known ones at which a number of a row, or a derivative of it, is zero: by values of the motion
!> alone, in a bracket that holds the zero from the first to the last.
module zero_search
   use kinds, only: wp
   use points, only: row_t
   use set_analysis, only: set_analysis_t, rows_at
   implicit none
   private
   public :: sample_t, column_t, look, find_zero, differ_in_sign

   integer, parameter :: max_iterations = 100
   !> A bracket as narrow as so many roundings of the time is closed.
   real(wp), parameter :: closed = 4.0_wp
   !> The slope at a zero is that to the nearest value that is so many times the noise.
   real(wp), parameter :: above_noise = 3.0_wp
   !> Errors are two roundings of the characteristic value at least, this part of the noise.
   real(wp), parameter :: rounding_part = 1.0_wp/32.0_wp

   !> A number of a row at one time, in the deck's units and rad.
   type :: sample_t
      real(wp) :: t = 0.0_wp
      real(wp) :: f(0:2) = 0.0_wp   !< value, rate, acceleration
      real(wp) :: error(0:2) = 0.0_wp   !< of them, where it is asked for
      logical :: exists = .false.
      real(wp) :: t_error = 0.0_wp      !< of the time of a zero
   end type sample_t

   !> Which number: its column (1 to 3) in the row of a request of the set; `step`: of the difference that stands for
   !> the third derivative, in the unit of time; `noise` (0:3): rounding errors of its derivatives.
   type :: column_t
      integer :: request = 0, column = 0
      real(wp) :: step = 0.0_wp
      real(wp) :: noise(0:3) = 0.0_wp
   end type column_t

contains

   !> The column `c` at the time `t`; `with_errors`: which are estimated.
   subroutine look(s, c, t, sample, with_errors)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      real(wp), intent(in) :: t
      type(sample_t), intent(out) :: sample
      logical, intent(in), optional :: with_errors
      type(row_t) :: row(1)
      real(wp) :: error(3, 0:2, 1)

      sample%t = t
      associate (part => s%now%parts%part(c%request))
         if (present(with_errors)) then
            call rows_at(s, part, [c%request], t, row, sample%exists, with_errors, error)
            sample%error = error(c%column, :, 1)
         else
            call rows_at(s, part, [c%request], t, row, sample%exists)
         end if
      end associate
      sample%f = row(1)%value(c%column, :)
   end subroutine look

   !> Where between `a` and `b` the derivative number `order` (0 to 3) of column `c`, less `level`, is zero: it has
   !> opposite signs there. The method of false position with halved values (Illinois: Dowell and Jarratt, BIT 11,
   !> 1971). Where a time between has no motion, the nearest known one is the zero. `zero`%exists is false where the
   !> signs were the same. Its time is off by the error of what is zero over its slope.
   subroutine find_zero(s, c, order, level, a, b, zero)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      integer, intent(in) :: order
      real(wp), intent(in) :: level
      type(sample_t), intent(in) :: a, b
      type(sample_t), intent(out) :: zero
      real(wp) :: t, t1, t2, g1, g2, g, last, width, slope, of_zero
      real(wp) :: times(max_iterations + 2), values(max_iterations + 2)
      integer :: i, n
      logical :: known(2)

      t1 = a%t
      t2 = b%t
      known = .true.
      width = 0.0_wp
      n = 0
      if (order < 3) then
         g1 = a%f(order) - level
         g2 = b%f(order) - level
      else
         call evaluate(t1, g1, known(1))
         call evaluate(t2, g2, known(2))
      end if
      if (.not. (all(known) .and. differ_in_sign(g1, g2))) return
      call note(t1, g1)
      call note(t2, g2)
      last = t2
      t = t1
      do i = 1, max_iterations
         t = t2 - g2*((t2 - t1)/(g2 - g1))
         if (.not. (t - t1)*(t2 - t) > 0.0_wp) t = t1 + 0.5_wp*(t2 - t1)
         if (min(abs(t2 - t1), abs(t - last)) <= closed*spacing(max(abs(t1), abs(t2)))) exit
         last = t
         call evaluate(t, g, known(1))
         if (.not. known(1)) then
            width = abs(t2 - t1)
            t = t2
            exit
         end if
         if (abs(g) <= 0.0_wp) exit
         call note(t, g)
         if (differ_in_sign(g, g2)) then
            t1 = t2
            g1 = g2
         else
            g1 = 0.5_wp*g1
         end if
         t2 = t
         g2 = g
      end do
      call look(s, c, t, zero, .true.)
      slope = slope_at(t)
      zero%t_error = width + epsilon(1.0_wp)*max(abs(a%t), abs(b%t))
      if (slope > 0.0_wp) then
         of_zero = zero%error(min(order, 2))
         if (order == 3) of_zero = of_zero/c%step
         zero%t_error = zero%t_error + (of_zero + rounding_part*c%noise(order))/slope
      else
         zero%t_error = abs(b%t - a%t)
      end if

   contains

      !> Notes the value `g` at a `time`.
      subroutine note(time, g)
         real(wp), intent(in) :: time, g

         n = n + 1
         times(n) = time
         values(n) = g
      end subroutine note

      !> The slope from `time`, the zero, to the nearest value that is more than noise.
      real(wp) function slope_at(time) result(slope)
         real(wp), intent(in) :: time
         real(wp) :: nearest
         integer :: k

         slope = 0.0_wp
         nearest = huge(1.0_wp)
         do k = 1, n
            if (abs(values(k)) <= above_noise*c%noise(order) .or. abs(times(k) - time) >= nearest) cycle
            if (abs(times(k) - time) <= 0.0_wp) cycle
            nearest = abs(times(k) - time)
            slope = abs(values(k))/nearest
         end do
      end function slope_at

      !> The function `g` at a `time`.
      subroutine evaluate(time, g, known)
         real(wp), intent(in) :: time
         real(wp), intent(out) :: g
         logical, intent(out) :: known
         type(sample_t) :: at(-2:2)
         integer :: k

         if (order < 3) then
            call look(s, c, time, at(0))
            g = at(0)%f(order) - level
            known = at(0)%exists
            return
         end if
         do k = -2, 2
            if (k /= 0) call look(s, c, time + k*c%step, at(k))
         end do
         g = (8.0_wp*(at(1)%f(2) - at(-1)%f(2)) - (at(2)%f(2) - at(-2)%f(2)))/(12.0_wp*c%step)
         known = all(at([-2, -1, 1, 2])%exists)
      end subroutine evaluate
   end subroutine find_zero

   !> One is positive, the other negative.
   pure logical function differ_in_sign(x, y)
      real(wp), intent(in) :: x, y

      differ_in_sign = (x > 0.0_wp .and. y < 0.0_wp) .or. (x < 0.0_wp .and. y > 0.0_wp)
   end function differ_in_sign
end module zero_search
