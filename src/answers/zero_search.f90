!> The time between two known ones at which a number of a row, or a derivative of it, is zero: by values of the motion
!> alone, in a bracket that holds the zero from the first to the last.
module zero_search
   use kinds, only: wp
   use points, only: row_t
   use set_analysis, only: set_analysis_t, rows_at
   implicit none
   private
   public :: sample_t, column_t, look, find_zero, differ_in_sign, slope_in, noise_part

   !> Smaller derivatives, in characteristic ones or the largest about them, are zeros that rounding has moved.
   real(wp), parameter :: noise_part = 64.0_wp*epsilon(1.0_wp)
   integer, parameter :: max_iterations = 100
   !> A stencil that is too long is shortened by this.
   real(wp), parameter :: shorter = 0.25_wp
   !> So often where it has derivatives of one sign at both ends.
   integer, parameter :: max_shortenings = 3
   !> A bracket as narrow as so many roundings of the time is closed.
   real(wp), parameter :: closed = 4.0_wp
   !> The slope at a zero is that to the nearest value that is so many times the noise.
   real(wp), parameter :: above_noise = 3.0_wp
   !> Errors are two roundings of the characteristic value at least, this part of the noise.
   real(wp), parameter :: rounding_part = 1.0_wp/32.0_wp
   !> A time that is known to this part of it, by a bound of what rounding leaves open, needs no estimate of errors.
   real(wp), parameter :: well_known = 65536.0_wp*epsilon(1.0_wp)

   !> A number of a row at one time, in the deck's units and rad.
   type :: sample_t
      real(wp) :: t = 0.0_wp
      real(wp) :: f(0:2) = 0.0_wp   !< value, rate, acceleration
      real(wp) :: error(0:2) = 0.0_wp   !< of them, where it is asked for
      logical :: exists = .false.
      real(wp) :: t_error = 0.0_wp      !< of the time of a zero
      real(wp) :: growth = 0.0_wp       !< of roundings, where errors are asked for
      integer :: order = 0              !< of the derivative that has an extreme there
   end type sample_t

   !> Which number: its column (1 to 3) in the row of a request of the set; `step`: of the stencil that gives the third
   !> derivative, in the unit of time; `noise` (0:2): rounding errors of its derivatives.
   type :: column_t
      integer :: request = 0, column = 0
      real(wp) :: step = 0.0_wp
      real(wp) :: noise(0:2) = 0.0_wp
      real(wp) :: flat = 0.0_wp       !< accelerations that differ by no more are alike
   end type column_t

contains

   !> The column `c` at the time `t`; `with_errors` (if present): they are estimated also where no digit is in doubt.
   subroutine look(s, c, t, sample, with_errors)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      real(wp), intent(in) :: t
      type(sample_t), intent(out) :: sample
      logical, intent(in), optional :: with_errors
      type(row_t) :: row(1)
      real(wp) :: error(3, 0:2, 1)

      sample%t = t
      associate (part => s%now%rows(c%request)%part)
         if (present(with_errors)) then
            call rows_at(s, part, [c%request], t, row, sample%exists, with_errors, error, sample%growth)
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
   !>
   !> The third derivative is that of the polynomial of degree four through accelerations at five times between `a` and
   !> `b`. A stencil whose derivative at the zero differs from that of a shorter one by more than rounding is too long.
   !> `ends` (2): the third derivative at `a` and `b`, where it is known.
   subroutine find_zero(s, c, order, level, a, b, zero, ends)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      integer, intent(in) :: order
      real(wp), intent(in) :: level
      type(sample_t), intent(in) :: a, b
      type(sample_t), intent(out) :: zero
      real(wp), intent(in), optional :: ends(2)
      real(wp) :: t, t_shorter, g, last_g, step, noise, width, slope, open, nearest
      real(wp) :: times(max_iterations + 2), values(max_iterations + 2)
      integer :: n, i
      logical :: is_found, estimated

      step = sign(c%step, b%t - a%t)
      do i = 1, max_shortenings
         call close_in(t, width, is_found)
         if (is_found .or. order < 3) exit
         step = shorter*step
      end do
      if (.not. is_found) return
      last_g = huge(1.0_wp)
      do while (order == 3)
         step = shorter*step
         call evaluate(t, g, is_found)
         ! What does not get less with the stencil is rounding.
         if (is_found) is_found = abs(g) < shorter*last_g
         last_g = abs(g)
         if (is_found) is_found = abs(g) > noise_of_stencil() .and. abs(step) > noise_part*max(abs(a%t), abs(b%t))
         if (is_found) call close_in(t_shorter, width, is_found)
         if (.not. is_found) exit
         t = t_shorter
      end do
      if (order == 3) step = step/shorter
      noise = c%noise(min(order, 2))
      if (order == 3) noise = noise_of_stencil()
      ! The slope from the zero to the nearest value that is more than noise.
      slope = 0.0_wp
      nearest = huge(1.0_wp)
      do i = 1, n
         if (abs(values(i)) <= above_noise*noise .or. abs(times(i) - t) >= nearest) cycle
         if (abs(times(i) - t) <= 0.0_wp) cycle
         nearest = abs(times(i) - t)
         slope = abs(values(i))/nearest
      end do
      do i = 1, 2
         ! An estimate takes nine solutions. A level that a coordinate passes has its error.
         estimated = order == 0 .or. i == 2
         call look(s, c, t, zero, estimated)
         associate (k => min(order, 2))
            open = zero%error(k)
            if (.not. open > 0.0_wp) open = zero%growth*(epsilon(1.0_wp)/noise_part)*c%noise(k)
         end associate
         zero%t_error = width + epsilon(1.0_wp)*max(abs(a%t), abs(b%t))
         if (slope > 0.0_wp) then
            zero%t_error = zero%t_error + (open/merge(abs(step), 1.0_wp, order == 3) + rounding_part*noise)/slope
         else
            zero%t_error = abs(b%t - a%t)
         end if
         if (estimated .or. zero%t_error <= well_known*max(abs(a%t), abs(b%t))) exit
      end do

   contains

      !> The zero `t`, if it is found; it is open by `width`.
      subroutine close_in(t, width, is_found)
         real(wp), intent(out) :: t, width
         logical, intent(out) :: is_found
         real(wp) :: t1, t2, g1, g2, g, last
         integer :: i
         logical :: known

         t = a%t
         t1 = a%t
         t2 = b%t
         width = 0.0_wp
         n = 0
         is_found = present(ends)
         if (is_found) then
            g1 = ends(1)
            g2 = ends(2)
         else
            call evaluate(t1, g1, is_found)
            if (is_found) call evaluate(t2, g2, is_found)
         end if
         if (is_found) is_found = differ_in_sign(g1, g2)
         if (.not. is_found) return
         call note(t1, g1)
         call note(t2, g2)
         last = t2
         do i = 1, max_iterations
            t = t2 - g2*((t2 - t1)/(g2 - g1))
            if (.not. (t - t1)*(t2 - t) > 0.0_wp) t = t1 + 0.5_wp*(t2 - t1)
            if (min(abs(t2 - t1), abs(t - last)) <= closed*spacing(max(abs(t1), abs(t2)))) exit
            last = t
            call evaluate(t, g, known)
            if (.not. known) then
               width = abs(t2 - t1)
               t = t2
               exit
            end if
            ! What is left is rounding: further steps only follow it.
            if (order == 3) then
               if (abs(g) <= noise_of_stencil()) exit
            else if (abs(g) <= rounding_part*c%noise(order)) then
               exit
            end if
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
      end subroutine close_in

      !> The rounding error of a derivative by the stencil.
      real(wp) function noise_of_stencil()
         noise_of_stencil = max(c%noise(2), noise_part*max(abs(a%f(2)), abs(b%f(2))))/abs(step)
      end function noise_of_stencil

      !> Notes the value `g` at a `time`.
      subroutine note(time, g)
         real(wp), intent(in) :: time, g

         n = n + 1
         times(n) = time
         values(n) = g
      end subroutine note

      !> The function `g` at a `time`.
      subroutine evaluate(time, g, known)
         real(wp), intent(in) :: time
         real(wp), intent(out) :: g
         logical, intent(out) :: known
         type(sample_t) :: at
         real(wp) :: first, f(0:4)
         integer :: k

         known = .true.
         if (order < 3) then
            at = a
            if (abs(time - a%t) > 0.0_wp) at = b
            if (abs(time - at%t) > 0.0_wp) call look(s, c, time, at)
            g = at%f(order) - level
            known = at%exists
            return
         end if
         first = time - 2.0_wp*step
         if ((first - a%t)*step < 0.0_wp) first = a%t
         if ((b%t - 4.0_wp*step - first)*step < 0.0_wp) first = b%t - 4.0_wp*step
         do k = 0, 4
            call look(s, c, first + k*step, at)
            known = known .and. at%exists
            f(k) = at%f(2)
         end do
         g = slope_in(f, (time - first)/step)/step
      end subroutine evaluate
   end subroutine find_zero

   !> The derivative at `u` of the polynomial of degree four that has the values `f` at 0, 1, 2, 3 and 4: Newton's
   !> formula of forward differences.
   pure real(wp) function slope_in(f, u) result(slope)
      real(wp), intent(in) :: f(0:4), u

      slope = f(1) - f(0) + (u - 0.5_wp)*(f(2) - 2.0_wp*f(1) + f(0)) &
         + (0.5_wp*u**2 - u + 1.0_wp/3.0_wp)*(f(3) - 3.0_wp*(f(2) - f(1)) - f(0)) &
         + (u**3/6.0_wp - 0.75_wp*u**2 + 11.0_wp*u/12.0_wp - 0.25_wp)*(f(4) - 4.0_wp*(f(3) + f(1)) + 6.0_wp*f(2) + f(0))
   end function slope_in

   !> One is positive, the other negative.
   pure logical function differ_in_sign(x, y)
      real(wp), intent(in) :: x, y

      differ_in_sign = (x > 0.0_wp .and. y < 0.0_wp) .or. (x < 0.0_wp .and. y > 0.0_wp)
   end function differ_in_sign
end module zero_search
