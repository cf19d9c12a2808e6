!> Balls: numbers that are known up to a radius, and their sums and products.
!>
!> Midpoints are the results of the operations on reals, rounded to nearest. A radius bounds the error of its operation,
!> and is enlarged by more than the roundings of the radius (Rump, Acta Numerica 2010): no rounding mode is switched.
!> Radii of sums and products are polynomials of the radii of their terms, without a negative coefficient.
module balls
   use kinds, only: wp
   implicit none
   private
   public :: ball_t, top, distance, operator(+), operator(-), operator(*)

   !> The relative error of an operation at most, twice over: half of it is the bound.
   real(wp), parameter, public :: rounding = epsilon(1.0_wp)
   !> A factor that enlarges a sum of a few products by more than its roundings.
   real(wp), parameter, public :: room = 1.0_wp + 32.0_wp*rounding
   !> A factor that enlarges the radius of one operation by more than its roundings.
   real(wp), parameter, public :: up = 1.0_wp + 8.0_wp*rounding

   !> All numbers within a radius of a midpoint.
   type :: ball_t
      real(wp) :: mid, radius                !< midpoint and radius, in one unit; the radius is 0 or more
   end type ball_t

   interface operator(+)
      module procedure add
   end interface operator(+)
   interface operator(-)
      module procedure subtract, negate
   end interface operator(-)
   interface operator(*)
      module procedure multiply
   end interface operator(*)

contains

   !> Bounds the absolute values of the numbers in a ball.
   elemental real(wp) function top(ball)
      type(ball_t), intent(in) :: ball   !< in any unit

      top = (abs(ball%mid) + ball%radius)*up
   end function top

   !> Bounds the distance of the numbers in a ball from a number.
   elemental real(wp) function distance(ball, number)
      type(ball_t), intent(in) :: ball       !< in any unit
      real(wp), intent(in) :: number         !< in the unit of the ball

      distance = (abs(ball%mid - number) + ball%radius)*up
   end function distance

   !> Gives a ball that holds the sums of the numbers in two balls.
   elemental type(ball_t) function add(first, second) result(c)
      type(ball_t), intent(in) :: first, second   !< in one unit

      c%mid = first%mid + second%mid
      c%radius = (first%radius + second%radius + rounding*abs(c%mid))*up
   end function add

   !> Gives a ball that holds the differences of the numbers in two balls.
   elemental type(ball_t) function subtract(first, second) result(c)
      type(ball_t), intent(in) :: first, second   !< in one unit; the second is subtracted from the first

      c%mid = first%mid - second%mid
      c%radius = (first%radius + second%radius + rounding*abs(c%mid))*up
   end function subtract

   !> Gives the ball of the numbers with opposite signs.
   elemental type(ball_t) function negate(ball) result(c)
      type(ball_t), intent(in) :: ball   !< in any unit

      c = ball_t(-ball%mid, ball%radius)
   end function negate

   !> Gives a ball that holds the products of the numbers in two balls. A product with zero is zero; the radius of any
   !> other product has room for underflow.
   elemental type(ball_t) function multiply(first, second) result(c)
      type(ball_t), intent(in) :: first, second   !< each in its unit
      real(wp) :: of_a, of_b

      of_a = abs(first%mid) + first%radius
      of_b = abs(second%mid)
      c%mid = first%mid*second%mid
      c%radius = (of_a*second%radius + first%radius*of_b + rounding*abs(c%mid) &
         + merge(tiny(1.0_wp), 0.0_wp, of_a > 0.0_wp .and. of_b + second%radius > 0.0_wp))*up
   end function multiply
end module balls
