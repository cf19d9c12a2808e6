!> The frozen coefficients of the method of 1987: (15) c(phi) = cos(phi)/phi, s(phi) = sin(phi)/phi.
!>
!> Here h, the angle that multiplies them, is counted from the nearest zero of the cosine or sine itself,
!> for each row its own:  cos psi = c(h) h  with c(h) = -+ sin(h)/h,  sin psi = s(h) h  with s(h) = +- sin(h)/h.
!> So h = 0, at which the print divides by zero and the iteration has a false attractor, is an ordinary
!> place: sin(h)/h is 1 there.
module frozen_form
   use kinds, only: wp
   use constants, only: pi
   implicit none
   private
   public :: nearest_zeros, secants

contains

   !> The angles (2) nearest to `psi` at which cos, then sin, is zero.
   pure function nearest_zeros(psi) result(zeros)
      real(wp), intent(in) :: psi
      real(wp) :: zeros(2)

      zeros(1) = (anint(psi/pi - 0.5_wp) + 0.5_wp)*pi
      zeros(2) = anint(psi/pi)*pi
   end function nearest_zeros

   !> The frozen coefficients (2): cos(psi)/(psi - zeros(1)) and sin(psi)/(psi - zeros(2)).
   pure function secants(psi, zeros) result(c)
      real(wp), intent(in) :: psi, zeros(2)
      real(wp) :: c(2)

      c(1) = -sin(zeros(1))*sinc(psi - zeros(1))
      c(2) = cos(zeros(2))*sinc(psi - zeros(2))
   end function secants

   !> sin(h)/h.
   pure real(wp) function sinc(h)
      real(wp), intent(in) :: h

      sinc = 1.0_wp
      if (abs(h) > tiny(h)) sinc = sin(h)/h
   end function sinc
end module frozen_form
