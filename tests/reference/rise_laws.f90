!> Tests. The laws of rises in real128: s(u) alone is written down, its derivatives are those of the jets.
module rise_laws
   use, intrinsic :: iso_fortran_env, only: real64
   use quad_jet, only: qp, jet_t, pi_q, constant_jet, time_jet, operator(+), operator(-), operator(*), operator(/), &
      sin, &
      cos
   implicit none
   private
   public :: rise_jet, peak_rate, rise_words, fine_joint_part

   character(8), parameter :: rise_words(4) = [character(8) :: 'CYCLOID', '3-4-5', 'HARMONIC', 'PARABOLA']
   !> An instant that is before a joint by less than this part of the rise's times is meant to be at it, if it has the
   !> digits of a single.
   real(qp), parameter :: joint_part = 1.0e-6_qp
   !> The same of instants that have the digits of a double, as docs/cards.md says.
   real(qp), parameter :: fine_joint_part = 2048.0_qp*epsilon(1.0_real64)

contains

   !> 0, `lift` s((t - `start`)/`duration`), `lift`. Where the acceleration of `law` jumps it is that from the right;
   !> `part`: as `joint_part`, of instants that have more digits.
   pure type(jet_t) function rise_jet(law, start, duration, lift, t, part) result(f)
      character(*), intent(in) :: law
      real(qp), intent(in) :: start, duration, lift, t
      real(qp), intent(in), optional :: part
      type(jet_t) :: u, right
      real(qp) :: width

      u = (time_jet(t) - start)/duration
      f = lift*piece(law, u, u%v)
      if (law /= 'HARMONIC' .and. law /= 'PARABOLA') return
      width = joint_part
      if (present(part)) width = part
      right = lift*piece(law, u, u%v + width*(1.0_qp + abs(start)/duration))
      f%dd = right%dd
   end function rise_jet

   !> s(u) by the formula for `at`.
   pure type(jet_t) function piece(law, u, at) result(s)
      character(*), intent(in) :: law
      type(jet_t), intent(in) :: u
      real(qp), intent(in) :: at

      if (at < 0.0_qp) then
         s = constant_jet(0.0_qp)
      else if (at >= 1.0_qp) then
         s = constant_jet(1.0_qp)
      else if (law == 'CYCLOID') then
         s = u - sin(2.0_qp*pi_q*u)/(2.0_qp*pi_q)
      else if (law == '3-4-5') then
         s = u*u*u*(10.0_qp - 15.0_qp*u + 6.0_qp*u*u)
      else if (law == 'HARMONIC') then
         s = 0.5_qp*(1.0_qp - cos(pi_q*u))
      else if (at < 0.5_qp) then
         s = 2.0_qp*u*u
      else
         s = 1.0_qp - 2.0_qp*(1.0_qp - u)*(1.0_qp - u)
      end if
   end function piece

   !> The largest rate of s(u), at u = 1/2.
   pure real(qp) function peak_rate(law)
      character(*), intent(in) :: law
      type(jet_t) :: s

      s = piece(law, time_jet(0.5_qp), 0.5_qp)
      peak_rate = s%d
   end function peak_rate
end module rise_laws
