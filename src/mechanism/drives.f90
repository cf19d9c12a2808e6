!> The law of a drive: value, rate and acceleration at t, always from t itself, never accumulated from step to step.
!>
!>    f(t) = value + rate t + acceleration t**2/2 + the sum of its terms
!>
!> A table is the natural cubic spline through its rows. The laws of rises are laws of cams (Norton, Cam Design and
!> Manufacturing Handbook, ch. 2 and 3). At a jump of the acceleration the value after the jump counts.
!>
!> `bounds_of` encloses value, rate and acceleration over an interval of time. The bounds are true: they include the
!> rounding errors of their own evaluation. For one polynomial, harmonic, power, table or rise the bounds are the
!> extremes of the law; for a sum they are the sums of the bounds of all terms, wider than its extremes.
!>
!> `growing_sizes` bounds the sizes of the numbers that a law adds up. Its value and its rates may be small differences
!> of large numbers, and have then so many fewer known digits.
!>
!> The procedures of each kind of term stand together, kind by kind, below the laws.
module drives
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use plane_vectors, only: pi
   use splines, only: spline_t, piece_at, piece_value
   use mechanism, only: drive_t, term_t, term_harmonic, term_power, term_table, term_cycloid, term_345, term_cosine, &
      term_kinds
   implicit none
   private
   public :: drive_motion, bounds_t, bounds_of, drive_rate, joints_of, largest_frequency
   public :: joint_distance, growing_sizes, is_at_rest, halve, middle_of

   !> An interval for each derivative of a law; the default has no value in it.
   type :: bounds_t
      !> Of the derivatives 0 to 2, in the drive's unit (length or rad) and the unit of time. -huge, huge: no bounds.
      real(wp) :: low(0:2) = huge(1.0_wp), high(0:2) = -huge(1.0_wp)
   end type bounds_t

   !> An instant that is before a joint by less than this part of the rise's times counts as at the joint: decimals and
   !> quotients of TIME shift an instant by some roundings. Error estimates change both the instant and the duration by
   !> 256 roundings times a normal deviate. Their difference changes by 362 times such a deviate, which exceeds 2048
   !> once in a hundred million times. In real128 instants that are doubles have the roundings of doubles.
   real(wp), parameter :: joint_tolerance = 2048.0_wp*max(epsilon(1.0_wp), real(epsilon(1.0_dp), wp))
   !> Rounding error of a law at most, relative to the sum of the absolute values of its terms: some ten operations.
   real(wp), parameter :: law_rounding = 16.0_wp*epsilon(1.0_wp)
   !> Bounds of the derivatives 0 to 3 of any rise with lift 1 and duration 1: 6.3 by the cycloid, 60 by 3-4-5.
   real(wp), parameter :: rise_most(0:3) = [1.0_wp, 2.0_wp, 6.3_wp, 60.0_wp]
   !> A joint may be so far from the start or stop of a drive, as a part of the times: twice `joint_tolerance`.
   real(wp), parameter :: rest_part = 4096.0_wp*max(epsilon(1.0_wp), real(epsilon(1.0_dp), wp))

contains

   !> Computes value, rate and acceleration (3) of a law at a time, in the drive's unit (length, rad) and unit of time.
   pure function drive_motion(law, t) result(f)
      type(drive_t), intent(in) :: law       !< the drive that has the law
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3)

      associate (c => law%polynomial)
         f(1) = c(1) + t*(c(2) + t*c(3)/2.0_wp)
         f(2) = c(2) + t*c(3)
         f(3) = c(3)
      end associate
      if (allocated(law%terms)) call add_terms(law%terms, t, f)
   end function drive_motion

   !> Adds the values, rates and accelerations of the terms of a law at a time to sums.
   pure subroutine add_terms(terms, t, motion)
      type(term_t), intent(in) :: terms(:)   !< (any number) of one law
      real(wp), intent(in) :: t              !< time
      real(wp), intent(inout) :: motion(3)   !< the sums, in the drive's unit (length or rad) and the unit of time
      integer :: i

      do i = 1, size(terms)
         associate (term => terms(i))
            select case (term%kind)
            case (term_harmonic)
               motion = motion + harmonic_motion(term%r, t)
            case (term_power)
               ! The deck reader has rejected powers that do not exist.
               motion = motion + power_motion(term%r, t)
            case (term_table)
               motion = motion + piece_value(term%table, piece_at(term%table, t), t)
            case default
               motion = motion + rise_motion(term, t)
            end select
         end associate
      end do
   end subroutine add_terms

   !> Finds true bounds of value, rate and acceleration of a law between two times, in the drive's unit and the deck's
   !> unit of time. A table continues beyond its ends with its last pieces. If a power does not exist somewhere in the
   !> interval, there are no bounds: -huge and huge.
   pure function bounds_of(law, t1, t2, is_instant) result(b)
      type(drive_t), intent(in) :: law       !< the drive that has the law
      real(wp), intent(in) :: t1, t2         !< times in either order
      logical, intent(in) :: is_instant      !< the interval is one instant: an acceleration that jumps has one value
      type(bounds_t) :: b, of_term
      real(wp) :: from, to, times(3)
      integer :: i, k

      from = min(t1, t2)
      to = max(t1, t2)
      ! Of the polynomial: from its values at both ends, and where its rate is zero.
      times = [from, to, from]
      associate (c => law%polynomial)
         if (abs(c(3)) > 0.0_wp) times(3) = within(-c(2)/c(3), from, to)
         do k = 1, 3
            associate (t => times(k))
               call widen(b, [c(1) + t*(c(2) + t*c(3)/2.0_wp), c(2) + t*c(3), c(3)], &
                  [abs(c(1)) + abs(t)*(abs(c(2)) + abs(t*c(3))), abs(c(2)) + abs(t*c(3)), 0.0_wp])
            end associate
         end do
      end associate

      if (.not. allocated(law%terms)) return
      do i = 1, size(law%terms)
         associate (term => law%terms(i))
            select case (term%kind)
            case (term_harmonic)
               of_term = harmonic_bounds(term%r, from, to)
            case (term_power)
               of_term = power_bounds(term%r, from, to)
            case (term_table)
               of_term = table_bounds(term%table, from, to)
            case default
               of_term = rise_bounds(term, from, to, is_instant)
            end select
         end associate

         if (all(of_term%low <= -huge(1.0_wp))) then
            b = of_term
            return
         end if
         b%low = b%low + of_term%low
         b%high = b%high + of_term%high
      end do
   end function bounds_of

   !> Widens bounds so that they enclose a value and its derivatives, with their rounding errors.
   pure subroutine widen(bounds, values, magnitudes)
      type(bounds_t), intent(inout) :: bounds   !< are widened
      real(wp), intent(in) :: values(0:2)    !< value and derivatives, in the units of the bounds
      real(wp), intent(in) :: magnitudes(0:2)   !< of each, the sum of the absolute values of its terms, in its unit

      bounds%low = min(bounds%low, values - law_rounding*magnitudes)
      bounds%high = max(bounds%high, values + law_rounding*magnitudes)
   end subroutine widen

   !> Finds the time of an interval that is nearest to a given time.
   elemental real(wp) function within(t, from, to)
      real(wp), intent(in) :: t              !< the given time
      real(wp), intent(in) :: from, to       !< times: the ends of the interval, in their order

      within = min(max(t, from), to)
   end function within

   !> Estimates the largest |rate| of a drive for |time| <= `t`, in the drive's unit (length or rad) per unit of time.
   !> An estimate takes less time than the true bounds of `bounds_of`.
   pure real(wp) function drive_rate(drive, t) result(rate)
      type(drive_t), intent(in) :: drive     !< with its law
      real(wp), intent(in) :: t              !< time, at least 0
      integer :: i

      rate = abs(drive%polynomial(2)) + abs(drive%polynomial(3))*t
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         associate (term => drive%terms(i), r => drive%terms(i)%r)
            select case (term%kind)
            case (term_harmonic)
               rate = rate + abs(r(1)*r(2))
            case (term_power)
               if (t > 0.0_wp) rate = rate + abs(r(1)*r(2))*t**(r(2) - 1.0_wp)
            case (term_table)
               rate = rate + table_rate(term%table)
            case default
               rate = rate + rise_rate(term)
            end select
         end associate
      end do
   end function drive_rate

   !> Finds the times (any number, unordered) at which a derivative of a law jumps: knots of tables, joints of rises.
   pure function joints_of(drive) result(times)
      type(drive_t), intent(in) :: drive     !< with its law
      real(wp), allocatable :: times(:)
      integer :: i

      allocate (times(0))
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         associate (r => drive%terms(i)%r, kind => term_kinds(drive%terms(i)%kind))
            if (kind%has_rows) times = [times, drive%terms(i)%table%x]
            if (kind%is_rise) times = [times, r(1) + kind%joints(:2)*r(2)]
            if (kind%is_rise .and. kind%joints(3) < kind%joints(2)) times = [times, r(1) + kind%joints(3)*r(2)]
         end associate
      end do
   end function joints_of

   !> Finds the largest frequency of the harmonics of a drive, in rad per unit of time; 0 if the drive has none.
   pure real(wp) function largest_frequency(drive) result(largest)
      type(drive_t), intent(in) :: drive     !< with its law

      largest = 0.0_wp
      if (.not. allocated(drive%terms)) return
      largest = maxval([largest, pack(abs(drive%terms%r(2)), drive%terms%kind == term_harmonic)])
   end function largest_frequency

   !> Computes r1 sin(r2 t + r3) and its first two derivatives (3) at a time, in the unit of r1 and the unit of time.
   pure function harmonic_motion(numbers, t) result(f)
      real(wp), intent(in) :: numbers(3)     !< amplitude (drive's unit), frequency (rad per unit of time), phase (rad)
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3), u

      u = numbers(2)*t + numbers(3)
      f = numbers(1)*[sin(u), numbers(2)*cos(u), -numbers(2)**2*sin(u)]
   end function harmonic_motion

   !> Finds true bounds of r1 sin(r2 t + r3) and its first two derivatives between two times. Each derivative is again a
   !> sine, with its phase advanced by a quarter turn. Its extremes are at the ends of the interval and at whole numbers
   !> of quarter turns; after four of these they repeat.
   pure function harmonic_bounds(numbers, from, to) result(b)
      real(wp), intent(in) :: numbers(3)     !< amplitude (drive's unit), frequency (rad per unit of time), phase (rad)
      real(wp), intent(in) :: from, to       !< times, in their order
      type(bounds_t) :: b
      !> A quarter turn (rad); the phases of the derivatives 0 to 2; the sine at whole quarter turns.
      real(wp), parameter :: quarter = 0.5_wp*pi, quarters(0:2) = quarter*[0.0_wp, 1.0_wp, 2.0_wp], &
         sines(0:5) = [0.0_wp, 1.0_wp, 0.0_wp, -1.0_wp, 0.0_wp, 1.0_wp]
      real(wp) :: amplitudes(0:2), u1, u2, magnitude, first, last
      integer :: i, k

      u1 = min(numbers(2)*from, numbers(2)*to) + numbers(3)
      u2 = max(numbers(2)*from, numbers(2)*to) + numbers(3)
      magnitude = max(1.0_wp, abs(numbers(2)*from), abs(numbers(2)*to)) + abs(numbers(3))
      amplitudes = numbers(1)*[1.0_wp, numbers(2), numbers(2)**2]
      call widen(b, amplitudes*sin(u1 + quarters), abs(amplitudes)*magnitude)
      call widen(b, amplitudes*sin(u2 + quarters), abs(amplitudes)*magnitude)
      first = (u1 - law_rounding*magnitude)/quarter
      first = first + modulo(-first, 1.0_wp)
      last = (u2 + law_rounding*magnitude)/quarter
      do i = 0, 3
         if (first + i > last) exit
         k = modulo(int(modulo(first, 4.0_wp)) + i, 4)
         call widen(b, amplitudes*sines(k:k + 2), abs(amplitudes)*magnitude)
      end do
      ! Rounding does not exceed the amplitude.
      b%low = max(b%low, -(1.0_wp + law_rounding)*abs(amplitudes))
      b%high = min(b%high, (1.0_wp + law_rounding)*abs(amplitudes))
   end function harmonic_bounds

   !> Finds the sizes (3) of value, rate and acceleration of a harmonic at the times -t and t, for `growing_sizes`.
   pure function harmonic_sizes(numbers, t) result(sizes)
      real(wp), intent(in) :: numbers(3)     !< |amplitude|, |frequency| (rad per unit of time), |phase|
      real(wp), intent(in) :: t              !< time
      real(wp) :: sizes(3)

      sizes = (1.0_wp + numbers(2)*t + numbers(3))*numbers(1)*[1.0_wp, numbers(2), numbers(2)**2]
   end function harmonic_sizes

   !> Computes factor t**exponent. A whole exponent is taken as an integer, so that t may be zero or negative; for any
   !> other exponent t must be above 0. With a factor of 0 the result is 0.
   pure real(wp) function monomial(factor, exponent, t)
      real(wp), intent(in) :: factor         !< in the unit of the result per unit of time to the exponent
      real(wp), intent(in) :: exponent       !< any number
      real(wp), intent(in) :: t              !< time
      !> Whole exponents up to this fit into integers of the default kind.
      real(wp), parameter :: largest_whole = 1.0e6_wp

      if (abs(factor) <= 0.0_wp) then
         monomial = 0.0_wp
      else if (abs(exponent) < largest_whole .and. abs(exponent - anint(exponent)) <= 0.0_wp) then
         monomial = factor*t**nint(exponent)
      else
         monomial = factor*t**exponent
      end if
   end function monomial

   !> Computes r1 t**r2 and its first two derivatives (3), if they exist at a time, in the drive's and time's units.
   pure function power_motion(numbers, t) result(f)
      real(wp), intent(in) :: numbers(3)     !< factor, exponent
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3)

      f = [monomial(numbers(1), numbers(2), t), monomial(numbers(1)*numbers(2), numbers(2) - 1.0_wp, t), &
         monomial(numbers(1)*numbers(2)*(numbers(2) - 1.0_wp), numbers(2) - 2.0_wp, t)]
   end function power_motion

   !> Finds true bounds of r1 t**r2 and its first two derivatives between two times: on either side of t = 0 each is
   !> monotonic. If the power or a derivative does not exist somewhere, there are no bounds: -huge and huge.
   pure function power_bounds(numbers, from, to) result(b)
      real(wp), intent(in) :: numbers(3)     !< factor, exponent
      real(wp), intent(in) :: from, to       !< times, in their order
      type(bounds_t) :: b
      real(wp) :: times(3), f(3)
      integer :: k

      times = [from, to, within(0.0_wp, from, to)]
      do k = 1, 3
         if (.not. exists(numbers(2), times(k))) then
            b = bounds_t(-huge(1.0_wp), huge(1.0_wp))
            return
         end if
         f = power_motion(numbers, times(k))
         call widen(b, f, abs(f))
      end do
   end function power_bounds

   !> Finds the sizes (3) of value, rate and acceleration of a power, for `growing_sizes`. A derivative that grows more
   !> slowly than the time has its size at `last`, so that the chord is a bound.
   pure function power_sizes(numbers, t, last) result(sizes)
      real(wp), intent(in) :: numbers(3)     !< factor, exponent
      real(wp), intent(in) :: t              !< time, at least 0: sizes at -t and t
      real(wp), intent(in) :: last           !< largest |time|
      real(wp) :: sizes(3), c, power, time
      integer :: k

      sizes = 0.0_wp
      c = abs(numbers(1))
      do k = 1, 3
         power = numbers(2) - (k - 1)
         time = merge(t, last, power >= 1.0_wp)
         if (time > 0.0_wp) sizes(k) = (1.0_wp + abs(numbers(2)))*monomial(c, power, time)
         c = c*abs(power)
      end do
   end function power_sizes

   !> Tells whether t**exponent and its first two derivatives exist at a time.
   pure logical function exists(exponent, t)
      real(wp), intent(in) :: exponent       !< any number
      real(wp), intent(in) :: t              !< time

      exists = t > 0.0_wp .or. abs(exponent - anint(exponent)) <= 0.0_wp
      if (abs(t) <= 0.0_wp) exists = exponent >= 2.0_wp .or. abs(exponent*(exponent - 1.0_wp)) <= 0.0_wp
   end function exists

   !> Finds true bounds of a table and its first two derivatives between two times, piece by piece: each is a cubic.
   pure function table_bounds(spline, from, to) result(b)
      type(spline_t), intent(in) :: spline   !< the table
      real(wp), intent(in) :: from, to       !< times, in their order
      type(bounds_t) :: b
      integer :: k, first, last

      first = piece_at(spline, from)
      last = piece_at(spline, to)
      do k = first, last
         call widen_by_piece(b, spline, k, merge(from, spline%x(k), k == first), merge(to, spline%x(k + 1), k == last))
      end do
   end function table_bounds

   !> Finds the largest |mean rate| between two successive rows of a table, in the unit of its values per unit of time.
   pure real(wp) function table_rate(spline) result(rate)
      type(spline_t), intent(in) :: spline   !< the table

      associate (n => size(spline%x))
         rate = maxval(abs((spline%y(2:) - spline%y(:n - 1))/(spline%x(2:) - spline%x(:n - 1))))
      end associate
   end function table_rate

   !> Finds the sizes (3) of value, rate and acceleration of a table at the times -t and t, for `growing_sizes`.
   pure function table_sizes(spline, t) result(sizes)
      type(spline_t), intent(in) :: spline   !< the table
      real(wp), intent(in) :: t              !< time
      real(wp) :: sizes(3), bend, slope, h(size(spline%x) - 1)

      associate (n => size(spline%x))
         h = spline%x(2:) - spline%x(:n - 1)
         bend = maxval(abs(spline%m))
         slope = maxval(abs(spline%y(2:) - spline%y(:n - 1))/h) + bend*maxval(h)
         sizes = [maxval(abs(spline%y)) + t*slope, slope + t*bend, bend + &
            t*maxval(abs(spline%m(2:) - spline%m(:n - 1))/h)]
      end associate
   end function table_sizes

   !> Widens bounds so that they enclose a piece of a spline between two times: its values at both ends, and at the
   !> times at which its second or first derivative is zero.
   pure subroutine widen_by_piece(bounds, spline, i, t1, t2)
      type(bounds_t), intent(inout) :: bounds   !< are widened
      type(spline_t), intent(in) :: spline   !< the table
      integer, intent(in) :: i               !< number of the piece: between the knots i and i + 1
      real(wp), intent(in) :: t1, t2         !< times in their order
      real(wp) :: f(3), u(5), h, farthest, slope, q, root, magnitude, curve, away
      integer :: k

      ! f' = f'(x_i) + m_i u + slope u^2/2, u from the knot.
      f = piece_value(spline, i, spline%x(i))
      h = spline%x(i + 1) - spline%x(i)
      slope = (spline%m(i + 1) - spline%m(i))/h
      farthest = max(abs(t1 - spline%x(i)), abs(t2 - spline%x(i)))
      u = 0.0_wp
      if (abs(spline%m(i)) < abs(slope)*farthest) u(3) = -spline%m(i)/slope
      root = spline%m(i)**2 - 2.0_wp*slope*f(2)
      if (root >= 0.0_wp) then
         q = -(spline%m(i) + sign(sqrt(root), spline%m(i)))
         if (abs(q) < abs(slope)*farthest) u(4) = q/slope
         if (2.0_wp*abs(f(2)) < abs(q)*farthest) u(5) = 2.0_wp*f(2)/q
      end if
      u = within(spline%x(i) + u, t1, t2)
      u(:2) = [t1, t2]

      magnitude = abs(spline%y(i)) + abs(spline%y(i + 1))
      curve = abs(spline%m(i)) + abs(spline%m(i + 1))
      do k = 1, size(u)
         away = max(1.0_wp, abs(u(k) - spline%x(i))/h, abs(u(k) - spline%x(i + 1))/h)
         call widen(bounds, piece_value(spline, i, u(k)), &
            [(magnitude + curve*h**2)*away**3, (magnitude/h + curve*h)*away**2, curve*away])
      end do
   end subroutine widen_by_piece

   !> Finds how far before a joint a rise has the acceleration after the joint, as a part of the duration; 0: no jump.
   pure real(wp) function joint_width(term) result(width)
      type(term_t), intent(in) :: term       !< a rise

      width = 0.0_wp
      if (term_kinds(term%kind)%jumps) width = joint_distance(term)
   end function joint_width

   !> Finds how far from a joint of a rise an instant may be that counts as at the joint, as a part of the duration.
   pure real(wp) function joint_distance(term) result(distance)
      type(term_t), intent(in) :: term       !< a rise

      distance = joint_tolerance*(1.0_wp + abs(term%r(1))/term%r(2))
   end function joint_distance

   !> Computes s(u) of a rise with the lift 1 and the duration 1, and its first two derivatives by u (3). s is 0 before
   !> u = 0, and 1 from u = 1 on (Norton, Cam Design and Manufacturing Handbook, ch. 2 and 3).
   pure function rise_shape(kind, part, at) result(s)
      integer, intent(in) :: kind            !< term_cycloid, ..., term_parabola
      real(wp), intent(in) :: part           !< u, a part of the duration
      real(wp), intent(in) :: at             !< a part of the duration in the piece whose second derivative is taken
      real(wp) :: s(3), v, w

      v = min(max(part, 0.0_wp), 1.0_wp)
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
      if (part >= 1.0_wp) s(:2) = [1.0_wp, 0.0_wp]
      if (at < 0.0_wp .or. at >= 1.0_wp) s(3) = 0.0_wp
   end function rise_shape

   !> Computes value, rate and acceleration (3) of a rise at a time, in the drive's unit and the deck's unit of time. At
   !> a joint the acceleration has its value after the joint.
   pure function rise_motion(term, t) result(f)
      type(term_t), intent(in) :: term       !< a rise
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3), u

      associate (r => term%r)
         u = (t - r(1))/r(2)
         f = r(3)*rise_shape(term%kind, u, u + joint_width(term))/[1.0_wp, r(2), r(2)**2]
      end associate
   end function rise_motion

   !> Finds the largest |rate| of a rise, at its middle, in the drive's unit per unit of time.
   pure real(wp) function rise_rate(term) result(rate)
      type(term_t), intent(in) :: term       !< a rise
      real(wp) :: s(3)

      s = rise_shape(term%kind, 0.5_wp, 0.5_wp)
      rate = abs(term%r(3)*s(2))/term%r(2)
   end function rise_rate

   !> Finds the sizes (3) of value, rate and acceleration of a rise, for `growing_sizes`, at any time.
   pure function rise_sizes(numbers) result(sizes)
      real(wp), intent(in) :: numbers(3)     !< |start|, duration (time), |lift| (drive's unit)
      real(wp) :: sizes(3)

      sizes = numbers(3)*(rise_most(:2) + (2.0_wp*numbers(1)/numbers(2) + 1.0_wp)*rise_most(1:))/[1.0_wp, numbers(2), &
         numbers(2)**2]
   end function rise_sizes

   !> Finds true bounds of a rise and its first two derivatives between two times: from its values at both ends, and at
   !> all points in between at which any law has an extreme of a derivative; at a joint with both accelerations.
   pure function rise_bounds(term, from, to, is_instant) result(b)
      type(term_t), intent(in) :: term       !< a rise
      real(wp), intent(in) :: from, to       !< times in their order
      logical, intent(in) :: is_instant      !< the interval is one instant: an acceleration has one value
      type(bounds_t) :: b
      !> Distance of the extremes of the acceleration of the 3-4-5 polynomial from its middle: at (3 -+ sqrt(3))/6.
      real(wp), parameter :: aside = sqrt(3.0_wp)/6.0_wp
      !> Parts of the duration: these extremes, the extremes of the other laws, and all joints.
      real(wp), parameter :: extreme_places(7) = [0.0_wp, 0.5_wp - aside, 0.25_wp, 0.5_wp, 0.75_wp, 0.5_wp + aside, &
         1.0_wp]
      real(wp) :: u1, u2, width
      integer :: i

      width = joint_width(term)
      u1 = (from - term%r(1))/term%r(2)
      u2 = (to - term%r(1))/term%r(2)
      call widen_by_rise(b, term, u1, u1 + width)
      call widen_by_rise(b, term, u2, u2 + width)
      if (is_instant) return
      do i = 1, size(extreme_places)
         if (extreme_places(i) < u1 - width .or. extreme_places(i) > u2 + width) cycle
         call widen_by_rise(b, term, extreme_places(i), extreme_places(i) - 0.1_wp)
         call widen_by_rise(b, term, extreme_places(i), extreme_places(i) + 0.1_wp)
      end do
   end function rise_bounds

   !> Widens bounds so that they enclose a rise at a part of its duration. At its steepest, a rounding of `part` changes
   !> the second derivative by 60 roundings; in a dwell zeros are exact.
   pure subroutine widen_by_rise(bounds, term, part, at)
      type(bounds_t), intent(inout) :: bounds   !< are widened
      type(term_t), intent(in) :: term       !< a rise
      real(wp), intent(in) :: part           !< the part of the duration
      real(wp), intent(in) :: at             !< a part of the duration in the piece whose acceleration is taken
      real(wp) :: s(0:2), factors(0:2), magnitudes(0:2)

      s = rise_shape(term%kind, part, at)
      factors = term%r(3)/[1.0_wp, term%r(2), term%r(2)**2]
      magnitudes = abs(factors)*[1.0_wp, 8.0_wp, 64.0_wp]
      if (part < -law_rounding .or. part > 1.0_wp + law_rounding) &
         magnitudes = merge(0.0_wp, magnitudes, abs(s) <= 0.0_wp)
      call widen(bounds, factors*s, magnitudes)
   end subroutine widen_by_rise

   !> Bounds how much value, rate and acceleration (3) of a law change with a relative change of each of its numbers, or
   !> of the time: by the relative change times (:, 0) + |t| (:, 1) at each time t from -`last` to `last`, in the
   !> drive's unit (length or rad) and the deck's unit of time. For a power with a negative exponent the bounds hold
   !> only at `last`: before, the law itself is as large.
   pure function growing_sizes(law, last) result(sizes)
      type(drive_t), intent(in) :: law       !< the drive that has the law
      real(wp), intent(in) :: last           !< largest |time|
      real(wp) :: sizes(3, 0:1)

      sizes(:, 0) = sizes_at(law, 0.0_wp, last)
      sizes(:, 1) = (sizes_at(law, last, last) - sizes(:, 0))/merge(last, 1.0_wp, last > 0.0_wp)
   end function growing_sizes

   !> Finds the sizes (3) of value, rate and acceleration of a law at the times -t and t, for `growing_sizes`: the sums
   !> of the sizes of all terms. Between 0 and `last` no size is above the chord of its end values.
   pure function sizes_at(law, t, last) result(sizes)
      type(drive_t), intent(in) :: law       !< the drive that has the law
      real(wp), intent(in) :: t              !< time, from 0 to `last`
      real(wp), intent(in) :: last           !< largest |time|
      real(wp) :: sizes(3)
      integer :: i

      associate (c => abs(law%polynomial))
         sizes = [c(1) + t*(c(2) + t*c(3)), c(2) + t*c(3), c(3)]
      end associate
      if (.not. allocated(law%terms)) return
      do i = 1, size(law%terms)
         associate (term => law%terms(i))
            select case (term%kind)
            case (term_harmonic)
               sizes = sizes + harmonic_sizes(abs(term%r), t)
            case (term_power)
               sizes = sizes + power_sizes(term%r, t, last)
            case (term_table)
               sizes = sizes + table_sizes(term%table, t)
            case default
               sizes = sizes + rise_sizes(abs(term%r))
            end select
         end associate
      end do
   end function sizes_at

   !> Tells whether a drive does not move between two times, by the bounds of its rate. For two equal times: whether the
   !> drive does not move just after. Near a joint the interval begins after the joint, or ends before it.
   elemental logical function is_at_rest(law, t1, t2)
      type(drive_t), intent(in) :: law       !< the drive that has the law
      real(wp), intent(in) :: t1, t2         !< times in either order
      type(bounds_t) :: b
      real(wp) :: width, from

      ! A law without joints rests always or never.
      width = rest_part*maxval(abs([t1, t2, joints_of(law)]))
      if (.not. width > 0.0_wp) width = 1.0_wp
      from = min(t1, t2) + width
      b = bounds_of(law, from, max(max(t1, t2) - width, from + width), .false.)
      is_at_rest = b%low(1) >= 0.0_wp .and. b%high(1) <= 0.0_wp
   end function is_at_rest

   !> Halves an interval of time with a condition that holds at its lower end and not at its upper end. After
   !> digits(1.0_wp) calls its ends are neighbours, but for an interval around 0.
   pure subroutine halve(holds, low, high)
      logical, intent(in) :: holds           !< the condition holds at the middle of the interval
      real(wp), intent(inout) :: low         !< time up to which the condition holds
      real(wp), intent(inout) :: high        !< time from which it does not hold
      real(wp) :: middle

      middle = middle_of(low, high)
      if (holds) low = middle
      if (.not. holds) high = middle
   end subroutine halve

   !> Gives the time halfway between two times.
   pure real(wp) function middle_of(low, high) result(middle)
      real(wp), intent(in) :: low, high      !< times: the ends of an interval

      middle = low + 0.5_wp*(high - low)
   end function middle_of
end module drives
