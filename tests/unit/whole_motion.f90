!> A motion as writers take it, of a mechanism that is not divided.
module whole_motion
   use mechanism, only: mechanism_t
   use motion, only: motion_t
   use error_estimate, only: error_estimate_t
   use set_motion, only: set_motion_t, take_whole
   implicit none
   private
   public :: one_motion

contains

   !> The motion `q` of all of `m`, and how far it is known, as a set of one part.
   function one_motion(m, q, errors) result(s)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(error_estimate_t), intent(in) :: errors
      type(set_motion_t) :: s

      call take_whole(m, s%parts)
      allocate (s%own(1), s%motions(1), s%errors(1), s%sensitivities(1), s%proofs(1))
      s%own(1) = m
      s%motions(1) = q
      s%errors(1) = errors
   end function one_motion
end module whole_motion
