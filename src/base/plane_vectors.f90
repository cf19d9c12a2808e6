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

   !> The length of `vector`.
   elemental real(wp) function length_of(vector) result(length)
      type(vector_t), intent(in) :: vector

      length = norm2([vector%x, vector%y])
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

   !> `vector` (2) rotated by the angle at which the unit vector `direction` (2) stands.
   pure function rotated(vector, direction) result(w)
      real(wp), intent(in) :: vector(2), direction(2)
      real(wp) :: w(2)

      w = [vector(1)*direction(1) - vector(2)*direction(2), vector(1)*direction(2) + vector(2)*direction(1)]
   end function rotated

   !> `vector` (2) rotated by a right angle, counterclockwise: the derivative of a rotating vector with respect to its
   !> angle.
   pure function quarter_turn(vector) result(w)
      real(wp), intent(in) :: vector(2)
      real(wp) :: w(2)

      w = [-vector(2), vector(1)]
   end function quarter_turn

   !> The cross product u_x v_y - u_y v_x of u = `first` (2) and v = `second` (2); also v . u' with the quarter turn u'
   !> of u.
   pure real(wp) function cross(first, second)
      real(wp), intent(in) :: first(2), second(2)

      cross = first(1)*second(2) - first(2)*second(1)
   end function cross

   !> Place (2) of a point of a link at `position` (x, y, phi); `offset` (2): in the link's own axes, from its origin.
   pure function point_of(position, offset) result(p)
      real(wp), intent(in) :: position(3), offset(2)
      real(wp) :: p(2)

      p = position(:2) + rotated(offset, direction(position(3)))
   end function point_of

   !> Adds the vector (`along`, `across`), which rotates at `rate` with the angular `acceleration`, and its first two
   !> derivatives with respect to time to `position`, `velocity` and `change` (2):  u,  phi' u',  phi'' u' - phi'^2 u.
   pure subroutine add_rotating(along, across, rate, acceleration, position, velocity, change)
      real(wp), intent(in) :: along, across, rate, acceleration
      real(wp), intent(inout) :: position(2), velocity(2), change(2)
      real(wp) :: square

      square = rate*rate
      position(1) = position(1) + along
      position(2) = position(2) + across
      velocity(1) = velocity(1) - rate*across
      velocity(2) = velocity(2) + rate*along
      change(1) = change(1) - acceleration*across - square*along
      change(2) = change(2) + acceleration*along - square*across
   end subroutine add_rotating
end module plane_vectors
