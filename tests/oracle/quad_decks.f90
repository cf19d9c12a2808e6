!> Tests. What a deck's cards say, in real128: the doubles of the deck reader taken back to the decimals on the cards,
!> and the laws of the drives, written once more.
module quad_decks
   use kinds, only: wp
   use mechanism, only: mechanism_t, drive_t, term_t, drive_angle, drive_relangle, term_harmonic, term_power
   use quad_jet, only: qp, jet_t, degree_q, time_jet, operator(+), operator(*), sin
   implicit none
   private
   public :: length, angle, law

contains

   !> The number that the card holds: the decimal of at most 14 digits that the double stands for, or the double.
   real(qp) function length(x)
      real(wp), intent(in) :: x
      character(24) :: text

      write (text, '(es24.13e3)') x
      read (text, *) length
      if (abs(real(length, wp) - x) > 0.0_wp) length = real(x, qp)
   end function length

   !> As `length`, for an angle in radians that may stand on the card in degrees, or be a whole number of degrees.
   real(qp) function angle(m, x)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: x
      real(qp), parameter :: few_roundings = 8.0_qp*epsilon(1.0_wp)
      character(24) :: text

      write (text, '(es24.13e3)') real(x, qp)/degree_q
      read (text, *) angle
      if (.not. m%degrees) angle = anint(angle)
      angle = angle*degree_q
      if (abs(angle - x) > few_roundings*abs(x)) angle = length(x)
   end function angle

   real(qp) function number(m, x, turns)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: x
      logical, intent(in) :: turns

      if (turns) then
         number = angle(m, x)
      else
         number = length(x)
      end if
   end function number

   !> The law of a drive, with the deck's decimals.
   type(jet_t) function law(m, drive, t) result(f)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive
      real(qp), intent(in) :: t
      type(jet_t) :: time
      logical :: turns
      integer :: i

      time = time_jet(t)
      turns = any(drive%kind == [drive_angle, drive_relangle])
      associate (c => drive%polynomial)
         f = number(m, c(1), turns) + number(m, c(2), turns)*time + 0.5_qp*number(m, c(3), turns)*time*time
      end associate
      do i = 1, size(drive%terms)
         associate (r => drive%terms(i)%r)
            select case (drive%terms(i)%kind)
            case (term_harmonic)
               f = f + number(m, r(1), turns)*sin(angle(m, r(2))*time + angle(m, r(3)))
            case (term_power)
               f = f + number(m, r(1), turns)*power(t, length(r(2)))
            case default
               f = f + spline(m, drive%terms(i), turns, t)
            end select
         end associate
      end do
   end function law

   type(jet_t) function power(t, p) result(f)
      real(qp), intent(in) :: t, p
      real(qp) :: factor(0:2), one(0:2)
      integer :: k

      factor = [1.0_qp, p, p*(p - 1.0_qp)]
      one = 0.0_qp
      do k = 0, 2
         if (abs(factor(k)) <= 0.0_qp) cycle
         if (abs(p - anint(p)) <= 0.0_qp) then
            one(k) = factor(k)*t**(nint(p) - k)
         else
            one(k) = factor(k)*t**(p - k)
         end if
      end do
      f = jet_t(one(0), one(1), one(2))
   end function power

   !> The natural cubic spline of a table: second derivatives s(i) at its rows from
   !> h(i-1) s(i-1) + 2 (h(i-1) + h(i)) s(i) + h(i) s(i+1) = 6 (slope(i) - slope(i-1)), by Gauss's elimination.
   type(jet_t) function spline(m, term, turns, t) result(f)
      type(mechanism_t), intent(in) :: m
      type(term_t), intent(in) :: term
      logical, intent(in) :: turns
      real(qp), intent(in) :: t
      real(qp) :: x(size(term%knots)), y(size(x)), h(size(x) - 1), slope(size(x) - 1), s(size(x)), d(size(x))
      integer :: i, n

      n = size(x)
      x = [(length(term%knots(i)), i=1, n)]
      y = [(number(m, term%values(i), turns), i=1, n)]
      h = x(2:) - x(:n - 1)
      slope = (y(2:) - y(:n - 1))/h
      s = 0.0_qp
      d = 1.0_qp
      do i = 2, n - 1
         d(i) = 2.0_qp*(h(i - 1) + h(i))
         s(i) = 6.0_qp*(slope(i) - slope(i - 1))
         if (i == 2) cycle
         s(i) = s(i) - h(i - 1)/d(i - 1)*s(i - 1)
         d(i) = d(i) - h(i - 1)**2/d(i - 1)
      end do
      do i = n - 1, 2, -1
         s(i) = (s(i) - h(i)*s(i + 1))/d(i)
      end do
      i = max(1, min(n - 1, count(x <= t)))
      associate (a => (x(i + 1) - t)/h(i), b => (t - x(i))/h(i))
         f%v = a*y(i) + b*y(i + 1) + ((a**3 - a)*s(i) + (b**3 - b)*s(i + 1))*h(i)**2/6.0_qp
         f%d = slope(i) + ((1.0_qp - 3.0_qp*a**2)*s(i) + (3.0_qp*b**2 - 1.0_qp)*s(i + 1))*h(i)/6.0_qp
         f%dd = a*s(i) + b*s(i + 1)
      end associate
   end function spline
end module quad_decks
