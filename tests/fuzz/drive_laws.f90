!> Tests. The laws of drives as jets in real128, from the numbers of the deck: a polynomial and one term of each form.
module drive_laws
   use quad_jet, only: qp, jet_t, time_jet, operator(+), operator(-), operator(*), sin
   use mechanism, only: term_harmonic, term_table
   use jet_drives, only: term_jet
   implicit none
   private
   public :: law_t, law_jet, variation

   !> R1 + R2 t + R3 t**2/2 and a term, in the deck's units.
   type :: law_t
      real(qp) :: polynomial(3) = 0.0_qp
      integer :: form = 0                      !< of the term: term_harmonic, ..., term_parabola; 0: there is none
      real(qp) :: r(3) = 0.0_qp                !< R1, R2, R3 of its card
      real(qp), allocatable :: time(:), value(:) !< rows of a table
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
      if (law%form == term_harmonic) then
         f = f + law%r(1)*sin(phase_unit*(law%r(2)*time_jet(t) + law%r(3)))
      else if (law%form == term_table) then
         f = f + term_jet(law%form, law%r, law%time, law%value, t)
      else if (law%form > 0) then
         f = f + term_jet(law%form, law%r, [real(qp) ::], [real(qp) ::], t)
      end if
      f = angle_unit*f
   end function law_jet

   !> About the way that the value makes between `a` and `b`, never much too small: what may be missed is a part of the
   !> motion, so that a reference motion takes steps of a part of it.
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
