!> The law of a drive: value, rate and acceleration at t, always from t itself, never accumulated from step to step.
!>
!>    f(t) = value + rate t + acceleration t**2/2 + the sum of its terms
!>
!> A table is the natural C2 cubic spline through its rows. With h_i = x_(i+1) - x_i, d_i = (y_(i+1) - y_i)/h_i and M_i
!> the second derivative at knot i (M = 0 at both ends):
!>    h_(i-1) M_(i-1) + 2 (h_(i-1) + h_i) M_i + h_i M_(i+1) = 6 (d_i - d_(i-1))
!> (de Boor, A Practical Guide to Splines, ch. IV). Two rows give the straight line.
!>
!> The laws of rises are those of cams (Norton, Cam Design and Manufacturing Handbook, ch. 2 and 3). Where their
!> acceleration jumps it is that from the right.
module drives
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use planar, only: pi
   use linear_solver, only: solve_tridiagonal
   use mechanism, only: drive_t, term_t, term_harmonic, term_power, term_table, term_cycloid, term_345, term_cosine, &
      term_parabola
   implicit none
   private
   public :: law_t, new_law, drive_motion, drive_rate, joints_of, monomial, rise_shape, joint_width, joint_distance
   public :: find_drive_motion, pole_value, spline_t, new_spline, spline_value, piece_at, piece_value

   !> A natural cubic spline, in the units of the drive and of time.
   type :: spline_t
      real(wp), allocatable :: x(:), y(:), m(:)   !< (knots) times, increasing; values; second derivatives
   end type spline_t

   !> A drive made ready for evaluation.
   type :: law_t
      type(drive_t) :: drive
      type(spline_t), allocatable :: splines(:)   !< (terms) the splines of those that are tables
   end type law_t

   !> An instant that is before a joint by less than this part of the rise's times is meant to be at it: decimals,
   !> quotients of TIME, and error estimates put it up to twice 256 roundings aside. Instants of
   !> doubles are as far off in real128.
   real(wp), parameter :: joint_part = 1024.0_wp*max(epsilon(1.0_wp), real(epsilon(1.0_dp), wp))

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

      call find_drive_motion(law, t, f)
   end function drive_motion

   !> The same, without a result that is copied.
   pure subroutine find_drive_motion(law, t, f)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: t
      real(wp), intent(out) :: f(3)
      integer :: i

      associate (c => law%drive%polynomial)
         f(1) = c(1) + t*(c(2) + t*c(3)/2.0_wp)
         f(2) = c(2) + t*c(3)
         f(3) = c(3)
      end associate
      do i = 1, size(law%splines)
         select case (law%drive%terms(i)%kind)
         case (term_harmonic)
            f = f + harmonic(law%drive%terms(i)%r, t)
         case (term_power)
            f = f + power(law%drive%terms(i)%r, t)
         case (term_table)
            f = f + spline_value(law%splines(i), t)
         case (term_cycloid:term_parabola)
            f = f + rise(law%drive%terms(i), t)
         end select
      end do
   end subroutine find_drive_motion

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

   !> A rise and its derivatives.
   pure function rise(term, t) result(f)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: t
      real(wp) :: f(3), u

      u = (t - term%r(1))/term%r(2)
      f = term%r(3)*rise_shape(term%kind, u, u + joint_width(term))/[1.0_wp, term%r(2), term%r(2)**2]
   end function rise

   !> How far before a joint `term` has the acceleration from the right already, as a part of the rise's duration; 0
   !> where its law has a continuous acceleration.
   pure real(wp) function joint_width(term) result(width)
      type(term_t), intent(in) :: term

      width = 0.0_wp
      if (term%kind >= term_cosine) width = joint_distance(term)
   end function joint_width

   !> How far from a joint of `term` an instant may be that is meant to be at it, as a part of the rise's duration.
   pure real(wp) function joint_distance(term) result(distance)
      type(term_t), intent(in) :: term

      distance = joint_part*(1.0_wp + abs(term%r(1))/term%r(2))
   end function joint_distance

   !> s(u) of the law `kind`, term_cycloid to term_parabola, and its derivatives; 0 before u = 0, and 1 from u = 1 on.
   !> The second derivative is that of the piece in which `at` lies, continued to u.
   pure function rise_shape(kind, u, at) result(s)
      integer, intent(in) :: kind
      real(wp), intent(in) :: u, at
      real(wp) :: s(3), v, w

      v = min(max(u, 0.0_wp), 1.0_wp)
      w = 1.0_wp - v
      select case (kind)
      case (term_cycloid)
         s = [v - sin(2.0_wp*pi*v)/(2.0_wp*pi), 2.0_wp*sin(pi*v)**2, 2.0_wp*pi*sin(2.0_wp*pi*v)]
      case (term_345)
         s = [v**3*(10.0_wp - v*(15.0_wp - 6.0_wp*v)), 30.0_wp*(v*w)**2, 60.0_wp*v*w*(w - v)]
      case (term_cosine)
         s = [sin(0.5_wp*pi*v)**2, 0.5_wp*pi*sin(pi*v), 0.5_wp*pi**2*cos(pi*v)]
      case default
         s = [merge(2.0_wp*v**2, 1.0_wp - 2.0_wp*w**2, v < w), 4.0_wp*min(v, w), merge(4.0_wp, -4.0_wp, at < 0.5_wp)]
      end select
      ! A sine of pi is not zero: a drive at rest has no rate.
      if (u >= 1.0_wp) s(:2) = [1.0_wp, 0.0_wp]
      if (at < 0.0_wp .or. at >= 1.0_wp) s(3) = 0.0_wp
   end function rise_shape

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
      real(wp) :: s(3)

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
      case (term_cycloid:term_parabola)
         s = rise_shape(term%kind, 0.5_wp, 0.5_wp)
         rate = abs(term%r(3)*s(2))/term%r(2)
      end select
   end function term_rate

   !> Where the law of `drive` goes as the time comes to 0 from the side of `t`: -huge or huge, to infinity, as a
   !> negative power does; 0: the law is finite there. No law has a pole at another time.
   pure real(wp) function pole_value(drive, t) result(value)
      type(drive_t), intent(in) :: drive
      real(wp), intent(in) :: t
      real(wp) :: least
      integer :: i

      value = 0.0_wp
      least = 0.0_wp
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         associate (term => drive%terms(i))
            if (term%kind /= term_power .or. term%r(2) >= least .or. abs(term%r(1)) <= 0.0_wp) cycle
            least = term%r(2)
            value = sign(huge(1.0_wp), monomial(term%r(1), term%r(2), sign(1.0_wp, t)))
         end associate
      end do
   end function pole_value

   !> The times at which some derivative of the law of `drive` jumps: the knots of its tables, the joints of its rises.
   pure function joints_of(drive) result(times)
      type(drive_t), intent(in) :: drive
      real(wp), allocatable :: times(:)
      integer :: i

      allocate (times(0))
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         associate (r => drive%terms(i)%r)
            select case (drive%terms(i)%kind)
            case (term_table)
               times = [times, drive%terms(i)%knots]
            case (term_cycloid:term_parabola)
               times = [times, r(1), r(1) + r(2)]
               if (drive%terms(i)%kind == term_parabola) times = [times, r(1) + 0.5_wp*r(2)]
            end select
         end associate
      end do
   end function joints_of

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
      real(wp) :: h, u, w, slope, bend

      h = s%x(i + 1) - s%x(i)
      u = t - s%x(i)
      w = s%x(i + 1) - t
      slope = (s%y(i + 1) - s%y(i))/h
      bend = (s%m(i + 1) - s%m(i))/h
      ! From the nearer knot: at that the value is that of the table, and beside it, in a piece that is much longer than
      ! its neighbour, no cubes of the long way cancel.
      if (u < w) then
         slope = slope - h*(2.0_wp*s%m(i) + s%m(i + 1))/6.0_wp
         f = [s%y(i) + u*(slope + u*(s%m(i)/2.0_wp + u*bend/6.0_wp)), slope + u*(s%m(i) + u*bend/2.0_wp), &
            s%m(i) + u*bend]
      else
         slope = slope + h*(s%m(i) + 2.0_wp*s%m(i + 1))/6.0_wp
         f = [s%y(i + 1) - w*(slope - w*(s%m(i + 1)/2.0_wp - w*bend/6.0_wp)), slope - w*(s%m(i + 1) - w*bend/2.0_wp), &
            s%m(i + 1) - w*bend]
      end if
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
