!> Tests. The laws of drives as jets in real128, from the numbers of the deck: a polynomial and one term of each form.
module drive_laws
   use quad_jet, only: qp, jet_t, time_jet, operator(+), operator(-), operator(*), sin
   use rise_laws, only: rise_jet, fine_joint_part
   implicit none
   private
   public :: law_t, law_jet, set_spline, variation, term_none, term_harmonic, term_power, term_table, term_rise

   enum, bind(c)
      enumerator :: term_none, term_harmonic, term_power, term_table, term_rise
   end enum

   !> R1 + R2 t + R3 t**2/2 and a term, in the deck's units.
   type :: law_t
      real(qp) :: polynomial(3) = 0.0_qp
      integer :: form = term_none
      real(qp) :: r(3) = 0.0_qp                !< R1, R2, R3 of HARMONIC, POWER or RISE
      character(8) :: word = ''                !< the law of a RISE
      real(qp), allocatable :: time(:), value(:) !< rows of a table
      real(qp), allocatable :: bend(:)         !< second derivatives of the spline at the rows
   end type law_t

contains

   !> The value of `law` at `t` and its derivatives. `angle_unit`: the deck's unit of angles in radians, 1 where a
   !> length is driven; `phase_unit`: the unit of the argument of a sine.
   function law_jet(law, t, angle_unit, phase_unit) result(f)
      type(law_t), intent(in) :: law
      real(qp), intent(in) :: t, angle_unit, phase_unit
      type(jet_t) :: f

      associate (p => law%polynomial)
         f = jet_t(p(1) + t*(p(2) + t*p(3)/2.0_qp), p(2) + t*p(3), p(3))
      end associate
      select case (law%form)
      case (term_harmonic)
         f = f + law%r(1)*sin(phase_unit*(law%r(2)*time_jet(t) + law%r(3)))
      case (term_power)
         f = f + power_jet(law%r(1), law%r(2), t)
      case (term_table)
         f = f + spline_jet(law, t)
      case (term_rise)
         f = f + rise_jet(trim(law%word), law%r(1), law%r(2), law%r(3), t, fine_joint_part)
      end select
      f = angle_unit*f
   end function law_jet

   pure type(jet_t) function power_jet(factor, power, t) result(f)
      real(qp), intent(in) :: factor, power, t

      if (power >= 0.0_qp .and. .not. abs(power - anint(power)) > 0.0_qp) then
         associate (n => nint(power))
            f = jet_t(factor*t**n, 0.0_qp, 0.0_qp)
            if (n >= 1) f%d = factor*n*t**(n - 1)
            if (n >= 2) f%dd = factor*n*(n - 1)*t**(n - 2)
         end associate
      else
         f = factor*jet_t(t**power, power*t**(power - 1.0_qp), power*(power - 1.0_qp)*t**(power - 2.0_qp))
      end if
   end function power_jet

   !> Second derivatives of the natural cubic spline at its rows: of (h_k/6) m_{k-1} + ((h_k + h_{k+1})/3) m_k
   !> + (h_{k+1}/6) m_{k+1} = d_{k+1} - d_k, with d the slopes of the chords, by elimination from row to row.
   subroutine set_spline(law)
      type(law_t), intent(inout) :: law
      real(qp) :: h(size(law%time)), slope(size(law%time)), diagonal(size(law%time)), right(size(law%time)), factor
      integer :: n, k

      n = size(law%time)
      law%bend = spread(0.0_qp, 1, n)
      h(2:) = law%time(2:) - law%time(:n - 1)
      slope(2:) = (law%value(2:) - law%value(:n - 1))/h(2:)
      do k = 2, n - 1
         diagonal(k) = (h(k) + h(k + 1))/3.0_qp
         right(k) = slope(k + 1) - slope(k)
         if (k == 2) cycle
         factor = h(k)/6.0_qp/diagonal(k - 1)
         diagonal(k) = diagonal(k) - factor*h(k)/6.0_qp
         right(k) = right(k) - factor*right(k - 1)
      end do
      do k = n - 1, 2, -1
         law%bend(k) = (right(k) - h(k + 1)/6.0_qp*law%bend(k + 1))/diagonal(k)
      end do
   end subroutine set_spline

   pure type(jet_t) function spline_jet(law, t) result(f)
      type(law_t), intent(in) :: law
      real(qp), intent(in) :: t
      real(qp) :: h, a, b
      integer :: k

      k = min(max(2, count(law%time <= t) + 1), size(law%time))
      associate (x => law%time, y => law%value, m => law%bend)
         h = x(k) - x(k - 1)
         a = (x(k) - t)/h
         b = (t - x(k - 1))/h
         f%v = a*y(k - 1) + b*y(k) + ((a**3 - a)*m(k - 1) + (b**3 - b)*m(k))*h**2/6.0_qp
         f%d = (y(k) - y(k - 1))/h + ((3.0_qp*b**2 - 1.0_qp)*m(k) - (3.0_qp*a**2 - 1.0_qp)*m(k - 1))*h/6.0_qp
         f%dd = a*m(k - 1) + b*m(k)
      end associate
   end function spline_jet

   !> About the way that the value makes between `a` and `b`, never much too small: what may be missed is a part of the
   !> motion, so that a truth takes steps of a part of it.
   real(qp) function variation(law, a, b, angle_unit, phase_unit)
      type(law_t), intent(in) :: law
      real(qp), intent(in) :: a, b, angle_unit, phase_unit
      integer, parameter :: pieces = 8
      type(jet_t) :: f, g
      integer :: k

      variation = 0.0_qp
      f = law_jet(law, a, angle_unit, phase_unit)
      do k = 1, pieces
         g = law_jet(law, a + (b - a)*k/pieces, angle_unit, phase_unit)
         variation = variation + max(abs(g%v - f%v), abs(b - a)*max(abs(f%d), abs(g%d))/pieces)
         f = g
      end do
      if (law%form == term_harmonic) variation = variation + angle_unit*abs(law%r(1))*min(4.0_qp, &
         phase_unit*abs(law%r(2)*(b - a)))
   end function variation
end module drive_laws
