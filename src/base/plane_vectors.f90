!> Angles, in degrees and without whole turns, and vectors of the plane, as x and y: rotation, quarter turn, cross
!> product, a point that rotates with a link.
module plane_vectors
   use kinds, only: wp
   use number_types, only: vector_t
   implicit none
   private
   public :: pi, degree, in_degrees, wrap_angle
   public :: vector_t, length_of, direction, rotated, quarter_turn, cross, point_of, add_rotating

   real(wp), parameter :: pi = 3.14159265358979323846264338327950288419716939937510_wp
   !> One degree in radians.
   real(wp), parameter :: degree = pi/180.0_wp
   !> The largest power of 10 without a rounding error: its power of 5 fits in the digits of `wp`.
   integer, parameter :: exact_power = int(digits(1.0_wp)*(log10(2.0)/log10(5.0)))

contains

   !> The length of `v`.
   elemental real(wp) function length_of(v) result(length)
      type(vector_t), intent(in) :: v

      length = norm2([v%x, v%y])
   end function length_of

   !> `angle` (rad, or rad per unit of time to any power) in degrees. Degrees of a deck with at most precision(1.0_wp)
   !> digits come back as they were: several numbers of degrees have the same nearest radians, and the one with the
   !> fewest digits is meant. Any other comes back within one rounding.
   pure elemental real(wp) function in_degrees(angle) result(d)
      real(wp), intent(in) :: angle
      real(wp) :: power, rounded
      integer :: decimals

      d = angle/degree
      if (.not. (abs(d) > 0.0_wp .and. abs(d) <= huge(d))) return
      decimals = precision(d) - 1 - floor(log10(abs(d)))
      if (decimals < 0 .or. decimals > exact_power) return
      power = 10.0_wp**decimals
      rounded = anint(d*power)/power
      if (abs(rounded*degree - angle) <= 0.0_wp) d = rounded
   end function in_degrees

   !> `angle` (rad) less whole turns, between -pi and pi: the same direction. An angle in this range stays as it is.
   pure elemental real(wp) function wrap_angle(angle) result(rest)
      real(wp), intent(in) :: angle
      real(wp), parameter :: turn = 2.0_wp*pi

      rest = angle - turn*anint(angle/turn)
   end function wrap_angle

   !> Unit vector (2) at `angle` (rad) from the x axis.
   pure function direction(angle) result(e)
      real(wp), intent(in) :: angle
      real(wp) :: e(2)

      e = [cos(angle), sin(angle)]
   end function direction

   !> `v` (2) rotated by the angle at which the unit vector `e` (2) stands.
   pure function rotated(v, e) result(w)
      real(wp), intent(in) :: v(2), e(2)
      real(wp) :: w(2)

      w = [v(1)*e(1) - v(2)*e(2), v(1)*e(2) + v(2)*e(1)]
   end function rotated

   !> `v` (2) rotated by a right angle, counterclockwise: the derivative of a rotating vector with respect to its angle.
   pure function quarter_turn(v) result(w)
      real(wp), intent(in) :: v(2)
      real(wp) :: w(2)

      w = [-v(2), v(1)]
   end function quarter_turn

   !> u_x v_y - u_y v_x of `u` (2) and `v` (2); also v . u' with the quarter turn u' of u.
   pure real(wp) function cross(u, v)
      real(wp), intent(in) :: u(2), v(2)

      cross = u(1)*v(2) - u(2)*v(1)
   end function cross

   !> Place (2) of a point of a link at `position` (x, y, phi); `offset` (2): in the link's own axes, from its origin.
   pure function point_of(position, offset) result(p)
      real(wp), intent(in) :: position(3), offset(2)
      real(wp) :: p(2)

      p = position(:2) + rotated(offset, direction(position(3)))
   end function point_of

   !> Adds the vector (x, y), which rotates at `rate` with the angular `acceleration`, and its first two derivatives
   !> with respect to time to `p`, `v` and `a` (2):  u,  phi' u',  phi'' u' - phi'^2 u.
   pure subroutine add_rotating(x, y, rate, acceleration, p, v, a)
      real(wp), intent(in) :: x, y, rate, acceleration
      real(wp), intent(inout) :: p(2), v(2), a(2)
      real(wp) :: square

      square = rate*rate
      p(1) = p(1) + x
      p(2) = p(2) + y
      v(1) = v(1) - rate*y
      v(2) = v(2) + rate*x
      a(1) = a(1) - acceleration*y - square*x
      a(2) = a(2) + acceleration*x - square*y
   end subroutine add_rotating
end module plane_vectors
