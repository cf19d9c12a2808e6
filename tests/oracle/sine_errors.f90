!> Tests. The errors of the lanes' sines and cosines, measured against those of real128.
module sine_errors
   use, intrinsic :: iso_fortran_env, only: real128
   use kinds, only: wp
   use dice, only: dice_t, new_dice, between
   use lane_sines, only: lane_count, sines
   implicit none
   private
   public :: largest_sine_error

contains

   !> The largest error of sine or cosine, in units of the last digit, of at least `count` angles thrown between -`most`
   !> and `most` (rad).
   real(wp) function largest_sine_error(count, most) result(largest)
      integer, intent(in) :: count
      real(wp), intent(in) :: most
      type(dice_t) :: d
      real(wp) :: x(lane_count), c(lane_count), s(lane_count)
      integer :: i, l

      d = new_dice(1)
      largest = 0.0_wp
      do i = 1, (count + lane_count - 1)/lane_count
         do l = 1, lane_count
            x(l) = between(d, -most, most)
         end do
         call sines(x, c, s)
         do l = 1, lane_count
            largest = max(largest, error_of(sin(real(x(l), real128)), s(l)), error_of(cos(real(x(l), real128)), c(l)))
         end do
      end do
   end function largest_sine_error

   !> By how many last digits `found` is off the `true` value.
   pure real(wp) function error_of(true, found)
      real(real128), intent(in) :: true
      real(wp), intent(in) :: found

      error_of = real(abs(found - true)/spacing(real(true, wp)), wp)
   end function error_of
end module sine_errors
