!> Tests. How far a motion of the program is from a closed form in real128.
module motion_errors
   use kinds, only: wp
   use quad_jet, only: qp, wrap_angle
   use motion, only: motion_t
   use closed_forms_dyads, only: body_t, motion_of
   implicit none
   private
   public :: away, exactly_away

   !> The closed forms are rounded as well.
   real(qp), parameter :: reference_rounding = 1.0e-30_qp

contains

   !> How far (3, 0:2) link `i` of the motion `q` is from the `exact` one, as it is printed; angles but for whole turns.
   pure function exactly_away(q, i, exact) result(off)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      type(body_t), intent(in) :: exact
      real(qp) :: off(3, 0:2)

      off(:, 0) = [q%position(:2, i) + q%origin, q%position(3, i)]
      off(:, 1) = q%velocity(:, i)
      off(:, 2) = q%acceleration(:, i)
      off = off - motion_of(exact)
      off(3, 0) = wrap_angle(off(3, 0))
      off = abs(off)
   end function exactly_away

   !> How far they are apart, but for what the closed forms are rounded by.
   pure function away(q, i, exact) result(off)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      type(body_t), intent(in) :: exact
      real(wp) :: off(3, 0:2)

      off = real(max(0.0_qp, exactly_away(q, i, exact) - reference_rounding), wp)
   end function away
end module motion_errors
