!> Tests. How far a motion of the program is from a closed form in real128.
module motion_errors
   use kinds, only: wp
   use quad_jet, only: qp, pi_q
   use motion, only: motion_t
   use closed_forms_dyads, only: body_t
   implicit none
   private
   public :: away, difference

   !> The closed forms are rounded as well.
   real(qp), parameter :: reference_rounding = 1.0e-30_qp

contains

   !> How far (3, 0:2) link `i` of the motion `q` is from the `exact` one, as it is printed; angles but for whole turns.
   pure function away(q, i, exact) result(off)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      type(body_t), intent(in) :: exact
      real(wp) :: off(3, 0:2)
      real(qp) :: d(3, 0:2)

      d(:, 0) = [q%position(:2, i) + q%origin, q%position(3, i)] - [exact%x%v, exact%y%v, exact%phi%v]
      d(3, 0) = d(3, 0) - 2.0_qp*pi_q*anint(d(3, 0)/(2.0_qp*pi_q))
      d(:, 1) = q%velocity(:, i) - [exact%x%d, exact%y%d, exact%phi%d]
      d(:, 2) = q%acceleration(:, i) - [exact%x%dd, exact%y%dd, exact%phi%dd]
      off = real(max(0.0_qp, abs(d) - reference_rounding), wp)
   end function away

   !> Largest difference (0:2) of position, velocity, acceleration of all links.
   pure function difference(q, exact) result(d)
      type(motion_t), intent(in) :: q
      type(body_t), intent(in) :: exact(:)
      real(wp) :: d(0:2)
      integer :: i

      d = 0.0_wp
      do i = 1, size(exact)
         d = max(d, maxval(away(q, i, exact(i)), dim=1))
      end do
   end function difference
end module motion_errors
