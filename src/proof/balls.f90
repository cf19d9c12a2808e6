!> Balls: numbers that are known up to a radius, and their sums and products.
!>
!> Midpoints are what the same operations make of reals, rounded to nearest. A radius holds what its operation leaves
!> open, and is enlarged by more than its own roundings (Rump, Acta Numerica 2010): no rounding mode is switched.
!> Radii of sums and products are polynomials of those of their terms, without a negative coefficient.
module balls
   use kinds, only: wp
   implicit none
   private
   public :: ball_t, top, distance, operator(+), operator(-), operator(*)

   !> One rounding error, with room: half of it is the bound of one operation.
   real(wp), parameter, public :: rounding = epsilon(1.0_wp)
   !> Enlarges a sum of a few numbers by more than its roundings.
   real(wp), parameter, public :: room = 1.0_wp + 32.0_wp*rounding
   real(wp), parameter, public :: up = 1.0_wp + 8.0_wp*rounding

   type :: ball_t
      real(wp) :: mid, radius
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

   !> The largest absolute value in `a`.
   elemental real(wp) function top(a)
      type(ball_t), intent(in) :: a

      top = (abs(a%mid) + a%radius)*up
   end function top

   !> The largest distance of a number in `a` from `x`.
   elemental real(wp) function distance(a, x)
      type(ball_t), intent(in) :: a
      real(wp), intent(in) :: x

      distance = (abs(a%mid - x) + a%radius)*up
   end function distance

   !> a + b.
   elemental type(ball_t) function add(a, b) result(c)
      type(ball_t), intent(in) :: a, b

      c%mid = a%mid + b%mid
      c%radius = (a%radius + b%radius + rounding*abs(c%mid))*up
   end function add

   !> a - b.
   elemental type(ball_t) function subtract(a, b) result(c)
      type(ball_t), intent(in) :: a, b

      c%mid = a%mid - b%mid
      c%radius = (a%radius + b%radius + rounding*abs(c%mid))*up
   end function subtract

   !> -a.
   elemental type(ball_t) function negate(a) result(c)
      type(ball_t), intent(in) :: a

      c = ball_t(-a%mid, a%radius)
   end function negate

   !> a b: with zero zero; any other has room for underflow.
   elemental type(ball_t) function multiply(a, b) result(c)
      type(ball_t), intent(in) :: a, b
      real(wp) :: of_a, of_b

      of_a = abs(a%mid) + a%radius
      of_b = abs(b%mid)
      c%mid = a%mid*b%mid
      c%radius = (of_a*b%radius + a%radius*of_b + rounding*abs(c%mid) &
         + merge(tiny(1.0_wp), 0.0_wp, of_a > 0.0_wp .and. of_b + b%radius > 0.0_wp))*up
   end function multiply
end module balls
