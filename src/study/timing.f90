!> Measurement of time: a clock, and the median of a sample.
module timing
   use, intrinsic :: iso_fortran_env, only: dp => real64, int64
   implicit none
   private
   public :: seconds, median

contains

   !> The clock (s), from some instant.
   real(dp) function seconds()
      integer(int64) :: ticks, per_second

      call system_clock(ticks, per_second)
      seconds = real(ticks, dp)/real(per_second, dp)
   end function seconds

   !> The median of `x`; 0 if x is empty.
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
