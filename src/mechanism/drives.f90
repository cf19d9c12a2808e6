!> The law of a drive: value, rate and acceleration at t, always from t itself, never accumulated from step to step.
!>
!>    f(t) = value + rate t + acceleration t**2/2 + the sum of its terms
!>
!> A table is the natural C2 cubic spline through its rows. With h_i = x_(i+1) - x_i, d_i = (y_(i+1) - y_i)/h_i and M_i
!> the second derivative at knot i (M = 0 at both ends):
!>    h_(i-1) M_(i-1) + 2 (h_(i-1) + h_i) M_i + h_i M_(i+1) = 6 (d_i - d_(i-1))
!> (de Boor, A Practical Guide to Splines, ch. IV). Two rows give the straight line.
module drives
   use kinds, only: wp
   use linear_solver, only: solve_tridiagonal
   use mechanism, only: drive_t, term_t, term_harmonic, term_power, term_table
   implicit none
   private
   public :: law_t, new_law, drive_motion, drive_rate, monomial
   public :: spline_t, new_spline, spline_value, piece_at, piece_value

   !> A natural cubic spline, in the units of the drive and of time.
   type :: spline_t
      real(wp), allocatable :: x(:), y(:), m(:)   !< (knots) times, increasing; values; second derivatives
   end type spline_t

   !> A drive made ready for evaluation.
   type :: law_t
      type(drive_t) :: drive
      type(spline_t), allocatable :: splines(:)   !< (terms) the splines of those that are tables
   end type law_t

contains

   !> The law of `drive`, its splines solved.
   function new_law(drive) result(law)
      type(drive_t), intent(in) :: drive
      type(law_t) :: law
      integer :: i

      law%drive = drive
      if (.not. allocated(law%drive%terms)) allocate (law%drive%terms(0))
      allocate (law%splines(size(law%drive%terms)))
      do i = 1, size(law%splines)
         associate (term => law%drive%terms(i))
            if (term%kind == term_table) law%splines(i) = new_spline(term%knots, term%values)
         end associate
      end do
   end function new_law

   !> Value, rate and acceleration (3) at the time `t`, in the drive's unit (length or rad) and the deck's unit of time.
   pure function drive_motion(law, t) result(f)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: t
      real(wp) :: f(3)
      integer :: i

      associate (c => law%drive%polynomial)
         f = [c(1) + t*(c(2) + t*c(3)/2.0_wp), c(2) + t*c(3), c(3)]
      end associate
      do i = 1, size(law%splines)
         select case (law%drive%terms(i)%kind)
         case (term_harmonic)
            f = f + harmonic(law%drive%terms(i)%r, t)
         case (term_power)
            f = f + power(law%drive%terms(i)%r, t)
         case (term_table)
            f = f + spline_value(law%splines(i), t)
         end select
      end do
   end function drive_motion

   !> r1 sin(r2 t + r3) and its derivatives.
   pure function harmonic(r, t) result(f)
      real(wp), intent(in) :: r(3), t
      real(wp) :: f(3), argument

      argument = r(2)*t + r(3)
      f = r(1)*[sin(argument), r(2)*cos(argument), -r(2)**2*sin(argument)]
   end function harmonic

   !> r1 t**r2 and its derivatives; the deck reader has rejected powers that do not exist.
   pure function power(r, t) result(f)
      real(wp), intent(in) :: r(3), t
      real(wp) :: f(3)

      f(1) = monomial(r(1), r(2), t)
      f(2) = monomial(r(1)*r(2), r(2) - 1.0_wp, t)
      f(3) = monomial(r(1)*r(2)*(r(2) - 1.0_wp), r(2) - 2.0_wp, t)
   end function power

   !> c t**p; a whole number p is an integer exponent, so that t may be zero or negative.
   pure real(wp) function monomial(c, p, t)
      real(wp), intent(in) :: c, p, t
      real(wp), parameter :: largest_whole = 1.0e6_wp

      if (abs(c) <= 0.0_wp) then
         monomial = 0.0_wp
      else if (abs(p) < largest_whole .and. abs(p - anint(p)) <= 0.0_wp) then
         monomial = c*t**nint(p)
      else
         monomial = c*t**p
      end if
   end function monomial

   !> An estimate of the largest |rate| of `drive` for |time| <= `t`, in the drive's unit (length or rad) and the deck's
   !> unit of time; `law_bounds` has true bounds.
   pure real(wp) function drive_rate(drive, t) result(rate)
      type(drive_t), intent(in) :: drive
      real(wp), intent(in) :: t
      integer :: i

      rate = abs(drive%polynomial(2)) + abs(drive%polynomial(3))*t
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         rate = rate + term_rate(drive%terms(i), t)
      end do
   end function drive_rate

   !> The same of one term.
   pure real(wp) function term_rate(term, t) result(rate)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: t

      rate = 0.0_wp
      select case (term%kind)
      case (term_harmonic)
         rate = abs(term%r(1)*term%r(2))
      case (term_power)
         if (t > 0.0_wp) rate = abs(term%r(1)*term%r(2))*t**(term%r(2) - 1.0_wp)
      case (term_table)
         associate (x => term%knots, y => term%values, n => size(term%knots))
            rate = maxval(abs((y(2:) - y(:n - 1))/(x(2:) - x(:n - 1))))
         end associate
      end select
   end function term_rate

   !> The spline through the knots `x` (strictly increasing, at least two) and the values `y`.
   function new_spline(x, y) result(s)
      real(wp), intent(in) :: x(:), y(:)
      type(spline_t) :: s
      real(wp) :: h(size(x) - 1), slope(size(x) - 1), diagonal(size(x) - 2), off(size(x) - 2)
      integer :: n, info

      n = size(x)
      h = x(2:) - x(:n - 1)
      slope = (y(2:) - y(:n - 1))/h
      s%x = x
      s%y = y
      allocate (s%m(n), source=0.0_wp)
      if (n < 3) return
      diagonal = 2.0_wp*(h(:n - 2) + h(2:))
      off(:n - 3) = h(2:n - 2)
      s%m(2:n - 1) = 6.0_wp*(slope(2:) - slope(:n - 2))
      call solve_tridiagonal(diagonal, off, s%m(2:n - 1), info)
   end function new_spline

   !> Value, first and second derivative (3) of `s` at the time `t`.
   pure function spline_value(s, t) result(f)
      type(spline_t), intent(in) :: s
      real(wp), intent(in) :: t
      real(wp) :: f(3)

      f = piece_value(s, piece_at(s, t), t)
   end function spline_value

   !> The same of the cubic between the knots `i` and `i` + 1, which may be continued beyond them.
   pure function piece_value(s, i, t) result(f)
      type(spline_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp), intent(in) :: t
      real(wp) :: f(3)
      real(wp) :: h, u, w

      h = s%x(i + 1) - s%x(i)
      u = t - s%x(i)
      w = s%x(i + 1) - t
      ! Both ends enter alike: at a knot the value is that of the table.
      f(1) = (s%m(i)*w**3 + s%m(i + 1)*u**3)/(6.0_wp*h) &
         + (s%y(i)/h - s%m(i)*h/6.0_wp)*w + (s%y(i + 1)/h - s%m(i + 1)*h/6.0_wp)*u
      f(2) = (s%m(i + 1)*u**2 - s%m(i)*w**2)/(2.0_wp*h) &
         + (s%y(i + 1) - s%y(i))/h - (s%m(i + 1) - s%m(i))*h/6.0_wp
      f(3) = (s%m(i)*w + s%m(i + 1)*u)/h
   end function piece_value

   !> The i with x(i) <= t <= x(i + 1), by bisection; the first or the last where `t` lies beyond the table.
   pure integer function piece_at(s, t) result(low)
      type(spline_t), intent(in) :: s
      real(wp), intent(in) :: t
      integer :: high, middle

      low = 1
      high = size(s%x)
      do while (high - low > 1)
         middle = (low + high)/2
         if (s%x(middle) <= t) then
            low = middle
         else
            high = middle
         end if
      end do
   end function piece_at
end module drives
