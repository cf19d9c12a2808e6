!> Tests. What a measurement needs beside a clock: the spread of a sample, the slope of a line.
module bench_tools
   use kinds, only: wp
   use study, only: median
   implicit none
   private
   public :: spread_t, spread_of, slope, figure

   !> The middle of a sample, and its ends.
   type :: spread_t
      real(wp) :: median = 0.0_wp, least = 0.0_wp, most = 0.0_wp
   end type spread_t

contains

   !> The spread of the sample `x`.
   pure type(spread_t) function spread_of(x) result(s)
      real(wp), intent(in) :: x(:)

      s = spread_t(median(x), minval(x), maxval(x))
   end function spread_of

   !> Least squares: the slope of log `y` over log `x`.
   pure real(wp) function slope(x, y)
      real(wp), intent(in) :: x(:), y(:)
      real(wp) :: u(size(x))

      u = log(x) - sum(log(x))/size(x)
      slope = sum(u*log(y))/sum(u*u)
   end function slope

   !> `x` in 8 columns with three digits or so; '-' where it is not a number above zero.
   function figure(x) result(text)
      real(wp), intent(in) :: x
      character(8) :: text

      if (.not. x > 0.0_wp) then
         text = '       -'
      else if (x < 9.995_wp) then
         write (text, '(f8.2)') x
      else if (x < 99.95_wp) then
         write (text, '(f8.1)') x
      else
         write (text, '(i8)') nint(x)
      end if
   end function figure
end module bench_tools
