!> What a measurement of time needs: a clock, and the middle of a sample.
module timing
   use, intrinsic :: iso_fortran_env, only: dp => real64, int64
   implicit none
   private
   public :: seconds, median

contains

   !> The clock, in seconds from some instant.
   real(dp) function seconds()
      integer(int64) :: ticks, per_second

      call system_clock(ticks, per_second)
      seconds = real(ticks, dp)/real(per_second, dp)
   end function seconds

   !> The middle of a sample, 0 where there is none.
   pure real(dp) function median(x)
      real(dp), intent(in) :: x(:)
      real(dp) :: sorted(size(x)), one
      integer :: i, k

      median = 0.0_dp
      if (size(x) == 0) return
      sorted = x
      do i = 2, size(x)
         one = sorted(i)
         do k = i - 1, 1, -1
            if (sorted(k) <= one) exit
            sorted(k + 1) = sorted(k)
         end do
         sorted(k + 1) = one
      end do
      i = (size(x) + 1)/2
      median = 0.5_dp*(sorted(i) + sorted(size(x) + 1 - i))
   end function median
end module timing
