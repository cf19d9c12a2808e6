!> Bounds of the law of a drive over an interval of time: of its value and of its first two derivatives.
!>
!> The bounds are true: they are widened by the rounding errors of their own evaluation. For one polynomial, harmonic,
!> power, table or rise they are its extremes; for a sum they are the sums of these bounds, which may lie outside its
!> extremes.
module law_bounds
   use kinds, only: wp
   use planar, only: pi
   use mechanism, only: term_t, term_harmonic, term_power, term_table, term_cycloid, term_parabola
   use drives, only: law_t, monomial, spline_t, piece_at, piece_value, rise_shape, joint_width
   implicit none
   private
   public :: bounds_t, bounds_of

   !> An interval for each derivative of a law.
   type :: bounds_t
      !> Of the derivatives 0 to 2, in the drive's unit (length or rad) and the deck's unit of time. -huge, huge: no
      !> bound; huge, -huge: no value.
      real(wp) :: low(0:2) = huge(1.0_wp), high(0:2) = -huge(1.0_wp)
   end type bounds_t

   !> Rounding error of a value relative to the sum of the absolute values of its terms: some ten operations.
   real(wp), parameter :: margin = 16.0_wp*epsilon(1.0_wp)

contains

   !> The bounds of `law` between the times `t1` and `t2`, in either order. A table continues beyond its ends with its
   !> last pieces; a power that is not defined somewhere in the interval has no bounds. `one_instant`: the interval is
   !> one instant and its roundings, at which accelerations that jump are those of `drive_motion`.
   pure function bounds_of(law, t1, t2, one_instant) result(b)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: t1, t2
      logical, intent(in), optional :: one_instant
      type(bounds_t) :: b
      real(wp) :: from, to
      integer :: i

      from = min(t1, t2)
      to = max(t1, t2)
      b = polynomial(law%drive%polynomial, from, to)
      do i = 1, size(law%splines)
         select case (law%drive%terms(i)%kind)
         case (term_harmonic)
            call add(harmonic(law%drive%terms(i)%r, from, to), b)
         case (term_power)
            call add(power(law%drive%terms(i)%r, from, to), b)
         case (term_table)
            call add(table(law%splines(i), from, to), b)
         case (term_cycloid:term_parabola)
            call add(rise(law%drive%terms(i), from, to, one_instant), b)
         end select
      end do
   end function bounds_of

   !> The bounds of c1 + c2 t + c3 t^2/2: from its values at both ends, and where its rate is zero.
   pure function polynomial(c, from, to) result(b)
      real(wp), intent(in) :: c(3), from, to
      type(bounds_t) :: b
      real(wp) :: t

      call widen_by_polynomial(b, c, from)
      call widen_by_polynomial(b, c, to)
      if (abs(c(3)) <= 0.0_wp) return
      t = -c(2)/c(3)
      if (t > from .and. t < to) call widen_by_polynomial(b, c, t)
   end function polynomial

   !> Widens `b` by the polynomial `c` at the time `t`.
   pure subroutine widen_by_polynomial(b, c, t)
      type(bounds_t), intent(inout) :: b
      real(wp), intent(in) :: c(3), t

      call widen(b, 0, c(1) + t*(c(2) + t*c(3)/2.0_wp), abs(c(1)) + abs(t)*(abs(c(2)) + abs(t*c(3))))
      call widen(b, 1, c(2) + t*c(3), abs(c(2)) + abs(t*c(3)))
      call widen(b, 2, c(3), 0.0_wp)
   end subroutine widen_by_polynomial

   !> The bounds of r1 sin(r2 t + r3): each derivative is again a sine, with its phase advanced by a quarter turn.
   pure function harmonic(r, from, to) result(b)
      real(wp), intent(in) :: r(3), from, to
      type(bounds_t) :: b
      real(wp) :: u1, u2, low, high, magnitude
      integer :: k

      u1 = min(r(2)*from, r(2)*to) + r(3)
      u2 = max(r(2)*from, r(2)*to) + r(3)
      magnitude = max(1.0_wp, abs(r(2)*from), abs(r(2)*to)) + abs(r(3))
      do k = 0, 2
         call sine(u1 + 0.5_wp*k*pi, u2 + 0.5_wp*k*pi, magnitude, low, high)
         call widen(b, k, r(1)*r(2)**k*low, abs(r(1)*r(2)**k)*magnitude)
         call widen(b, k, r(1)*r(2)**k*high, abs(r(1)*r(2)**k)*magnitude)
         ! Rounding does not exceed the amplitude.
         b%low(k) = max(b%low(k), -(1.0_wp + margin)*abs(r(1)*r(2)**k))
         b%high(k) = min(b%high(k), (1.0_wp + margin)*abs(r(1)*r(2)**k))
      end do
   end function harmonic

   !> The smallest and the largest sine of the angles from `u1` to `u2`, whose rounding errors are those of numbers of
   !> the size `magnitude`.
   pure subroutine sine(u1, u2, magnitude, low, high)
      real(wp), intent(in) :: u1, u2, magnitude
      real(wp), intent(out) :: low, high

      low = min(sin(u1), sin(u2))
      high = max(sin(u1), sin(u2))
      if (holds_phase(0.5_wp*pi)) high = 1.0_wp
      if (holds_phase(-0.5_wp*pi)) low = -1.0_wp

   contains

      !> Whether `phase`, plus any number of whole turns, lies between u1 and u2.
      pure logical function holds_phase(phase)
         real(wp), intent(in) :: phase
         real(wp) :: turns, whole

         turns = (u2 + margin*magnitude - phase)/(2.0_wp*pi)
         whole = aint(turns)
         if (whole > turns) whole = whole - 1.0_wp
         holds_phase = whole >= (u1 - margin*magnitude - phase)/(2.0_wp*pi)
      end function holds_phase
   end subroutine sine

   !> The bounds of r1 t^r2. On either side of t = 0 each derivative is monotonic.
   pure function power(r, from, to) result(b)
      real(wp), intent(in) :: r(3), from, to
      type(bounds_t) :: b
      real(wp) :: c
      integer :: k

      c = r(1)
      do k = 0, 2
         call widen_by_power(b, k, c, r(2) - k, from)
         call widen_by_power(b, k, c, r(2) - k, to)
         if (from < 0.0_wp .and. to > 0.0_wp) call widen_by_power(b, k, c, r(2) - k, 0.0_wp)
         c = c*(r(2) - k)
      end do
   end function power

   !> Widens `b` by c t^p, which is derivative `k`, at the time `t`.
   pure subroutine widen_by_power(b, k, c, p, t)
      type(bounds_t), intent(inout) :: b
      integer, intent(in) :: k
      real(wp), intent(in) :: c, p, t

      if (is_finite(c, p, t)) then
         call widen(b, k, monomial(c, p, t), abs(monomial(c, p, t)))
      else
         b%low(k) = -huge(1.0_wp)
         b%high(k) = huge(1.0_wp)
      end if
   end subroutine widen_by_power

   !> Whether c t^p is defined and within the range of reals.
   pure logical function is_finite(c, p, t)
      real(wp), intent(in) :: c, p, t

      is_finite = .true.
      if (abs(c) <= 0.0_wp) return
      if (abs(t) <= 0.0_wp) then
         is_finite = p >= 0.0_wp
      else if (t < 0.0_wp .and. abs(p - anint(p)) > 0.0_wp) then
         is_finite = .false.
      else
         is_finite = p*log(abs(t)) + max(0.0_wp, log(abs(c))) < log(huge(1.0_wp)) - 1.0_wp
      end if
   end function is_finite

   !> The bounds of the spline `s`: those of its pieces in the interval, each a cubic.
   pure function table(s, from, to) result(b)
      type(spline_t), intent(in) :: s
      real(wp), intent(in) :: from, to
      type(bounds_t) :: b
      integer :: i, first, last

      first = piece_at(s, from)
      last = piece_at(s, to)
      do i = first, last
         call widen_by_piece(b, s, i, merge(from, s%x(i), i == first), merge(to, s%x(i + 1), i == last))
      end do
   end function table

   !> Widens `b` by piece `i` from `t1` to `t2`: by its values at both ends and where its second or first derivative is
   !> zero.
   pure subroutine widen_by_piece(b, s, i, t1, t2)
      type(bounds_t), intent(inout) :: b
      type(spline_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp), intent(in) :: t1, t2
      real(wp) :: f(3), u(3), reach, slope, q, root
      integer :: k

      ! f' = f'(x_i) + m_i u + slope u^2/2, u from the knot.
      f = piece_value(s, i, s%x(i))
      slope = (s%m(i + 1) - s%m(i))/(s%x(i + 1) - s%x(i))
      reach = max(abs(t1 - s%x(i)), abs(t2 - s%x(i)))
      u = 0.0_wp
      if (abs(s%m(i)) < abs(slope)*reach) u(1) = -s%m(i)/slope
      root = s%m(i)**2 - 2.0_wp*slope*f(2)
      if (root >= 0.0_wp) then
         q = -(s%m(i) + sign(sqrt(root), s%m(i)))
         if (abs(q) < abs(slope)*reach) u(2) = q/slope
         if (2.0_wp*abs(f(2)) < abs(q)*reach) u(3) = 2.0_wp*f(2)/q
      end if
      call widen_by_piece_at(b, s, i, t1)
      call widen_by_piece_at(b, s, i, t2)
      do k = 1, 3
         if (s%x(i) + u(k) > t1 .and. s%x(i) + u(k) < t2) call widen_by_piece_at(b, s, i, s%x(i) + u(k))
      end do
   end subroutine widen_by_piece

   !> Widens `b` by piece `i` at the time `t`.
   pure subroutine widen_by_piece_at(b, s, i, t)
      type(bounds_t), intent(inout) :: b
      type(spline_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp), intent(in) :: t
      real(wp) :: f(3), h, magnitude, curve, away

      f = piece_value(s, i, t)
      h = s%x(i + 1) - s%x(i)
      away = max(1.0_wp, abs(t - s%x(i))/h, abs(t - s%x(i + 1))/h)
      magnitude = abs(s%y(i)) + abs(s%y(i + 1))
      curve = abs(s%m(i)) + abs(s%m(i + 1))
      call widen(b, 0, f(1), (magnitude + curve*h**2)*away**3)
      call widen(b, 1, f(2), (magnitude/h + curve*h)*away**2)
      call widen(b, 2, f(3), curve*away)
   end subroutine widen_by_piece_at

   !> The bounds of the rise `term`: its values at both ends and at the places in between where any law has an extreme
   !> of a derivative. At a joint an acceleration may have two values, but not at `one_instant`.
   pure function rise(term, from, to, one_instant) result(b)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: from, to
      logical, intent(in), optional :: one_instant
      type(bounds_t) :: b
      !> Of the acceleration of the 3-4-5 polynomial, (3 -+ sqrt(3))/6; of the others, and their joints.
      real(wp), parameter :: aside = sqrt(3.0_wp)/6.0_wp
      real(wp), parameter :: places(7) = [0.0_wp, 0.5_wp - aside, 0.25_wp, 0.5_wp, 0.75_wp, 0.5_wp + aside, 1.0_wp]
      real(wp) :: u1, u2, width
      integer :: i

      width = joint_width(term)
      u1 = (from - term%r(1))/term%r(2)
      u2 = (to - term%r(1))/term%r(2)
      call widen_by_rise(b, term, u1, u1 + width)
      call widen_by_rise(b, term, u2, u2 + width)
      if (present(one_instant)) return
      do i = 1, size(places)
         if (places(i) < u1 - width .or. places(i) > u2 + width) cycle
         call widen_by_rise(b, term, places(i), places(i) - 0.1_wp)
         call widen_by_rise(b, term, places(i), places(i) + 0.1_wp)
      end do
   end function rise

   !> Widens `b` by the rise `term` at the part `u` of its duration, with the acceleration of the piece in which `at`
   !> lies. Where a law is steepest, a rounding of u changes its second derivative by 60 roundings; in a dwell zeros are
   !> exact.
   pure subroutine widen_by_rise(b, term, u, at)
      type(bounds_t), intent(inout) :: b
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: u, at
      real(wp) :: s(3), factor
      integer :: k
      logical :: dwells

      s = rise_shape(term%kind, u, at)
      dwells = u < -margin .or. u > 1.0_wp + margin
      do k = 0, 2
         factor = term%r(3)/term%r(2)**k
         call widen(b, k, factor*s(k + 1), merge(0.0_wp, abs(factor)*8.0_wp**k, dwells .and. abs(s(k + 1)) <= 0.0_wp))
      end do
   end subroutine widen_by_rise

   !> Widens the bounds of derivative `k` by `value`, whose terms have absolute values with the sum `magnitude`.
   pure subroutine widen(b, k, value, magnitude)
      type(bounds_t), intent(inout) :: b
      integer, intent(in) :: k
      real(wp), intent(in) :: value, magnitude

      b%low(k) = min(b%low(k), below(value, margin*magnitude))
      b%high(k) = max(b%high(k), -below(-value, margin*magnitude))
   end subroutine widen

   !> x - d, but not below -huge.
   elemental real(wp) function below(x, d)
      real(wp), intent(in) :: x, d

      below = -huge(1.0_wp)
      if (x > d - huge(1.0_wp)) below = x - d
   end function below

   !> Adds the bounds of a term to those of the sum.
   pure subroutine add(term, sum_of)
      type(bounds_t), intent(in) :: term
      type(bounds_t), intent(inout) :: sum_of

      sum_of%low = plus(sum_of%low, term%low)
      sum_of%high = -plus(-sum_of%high, -term%high)
   end subroutine add

   !> The sum of two lower bounds, but not below -huge.
   elemental real(wp) function plus(x, y)
      real(wp), intent(in) :: x, y

      plus = -huge(1.0_wp)
      if (min(x, y) > -huge(1.0_wp)) plus = x + y
   end function plus
end module law_bounds
