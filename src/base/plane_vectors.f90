!> Angles in degrees and without whole turns. Vectors of the plane as x and y: rotation, quarter turn, cross product, a
!> point that rotates with a link.
module plane_vectors
   use kinds, only: wp, exact_power
   use number_types, only: vector_t
   implicit none
   private
   public :: pi, full_turn, degree, in_degrees, wrap_angle
   public :: vector_t, length_of, direction, rotated, quarter_turn, cross, point_of, add_rotating

   !> Half a turn in radians, with the digits of real128 and more.
   real(wp), parameter :: pi = 3.14159265358979323846264338327950288419716939937510_wp
   !> One turn in radians.
   real(wp), parameter :: full_turn = 2.0_wp*pi
   !> One degree in radians.
   real(wp), parameter :: degree = pi/180.0_wp

contains

   !> Gives the length of a vector, in its unit.
   elemental real(wp) function length_of(vector) result(length)
      type(vector_t), intent(in) :: vector   !< x and y, in any unit

      length = norm2([vector%x, vector%y])
   end function length_of

   !> Gives an angle in degrees. Degrees of a deck with at most precision(1.0_wp) digits come back as they were: several
   !> numbers of degrees have one nearest number of radians, and the result has the fewest digits. Any other
   !> angle is right within one rounding.
   pure elemental real(wp) function in_degrees(angle) result(d)
      real(wp), intent(in) :: angle          !< rad, or rad per unit of time to any power
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

   !> Gives an angle without its whole turns, between -pi and pi (rad). An angle inside this range stays as it is; pi
   !> and -pi may become one another.
   pure elemental real(wp) function wrap_angle(angle) result(rest)
      real(wp), intent(in) :: angle          !< rad

      rest = angle - full_turn*anint(angle/full_turn)
   end function wrap_angle

   !> Gives the unit vector x, y (2) at an angle.
   pure function direction(angle) result(e)
      real(wp), intent(in) :: angle          !< rad, from the x axis
      real(wp) :: e(2)

      e = [cos(angle), sin(angle)]
   end function direction

   !> Rotates a vector (2) by the angle of a direction. The unit stays.
   pure function rotated(vector, direction) result(w)
      real(wp), intent(in) :: vector(2)      !< x, y, in any unit
      real(wp), intent(in) :: direction(2)   !< x, y of the unit vector at the angle
      real(wp) :: w(2)

      w = [vector(1)*direction(1) - vector(2)*direction(2), vector(1)*direction(2) + vector(2)*direction(1)]
   end function rotated

   !> Rotates a vector (2) by a right angle, counterclockwise: the derivative of a rotating vector with respect to its
   !> angle. The unit stays.
   pure function quarter_turn(vector) result(w)
      real(wp), intent(in) :: vector(2)      !< x, y, in any unit
      real(wp) :: w(2)

      w = [-vector(2), vector(1)]
   end function quarter_turn

   !> Gives the cross product u_x v_y - u_y v_x of u = `first` and v = `second`, in the product of their units. It is
   !> also the scalar product of v with the quarter turn of u.
   pure real(wp) function cross(first, second)
      real(wp), intent(in) :: first(2)       !< x, y, in any unit
      real(wp), intent(in) :: second(2)      !< x, y, in any unit

      cross = first(1)*second(2) - first(2)*second(1)
   end function cross

   !> Gives the position x, y (2, length) of a point of a link.
   pure function point_of(position, offset) result(p)
      real(wp), intent(in) :: position(3)    !< of the link: x, y (length), phi (rad)
      real(wp), intent(in) :: offset(2)      !< length, in the link's own axes, from its origin
      real(wp) :: p(2)

      p = position(:2) + rotated(offset, direction(position(3)))
   end function point_of

   !> Adds a rotating vector u and its first two derivatives with respect to time to three sums:
   !> u,  phi' u',  phi'' u' - phi'^2 u.
   pure subroutine add_rotating(along, across, rate, acceleration, position, velocity, change)
      real(wp), intent(in) :: along          !< x of the vector, length
      real(wp), intent(in) :: across         !< y of the vector, length
      real(wp), intent(in) :: rate           !< phi', rad per unit of time
      real(wp), intent(in) :: acceleration   !< phi'', rad per unit of time squared
      real(wp), intent(inout) :: position(2)   !< length
      real(wp), intent(inout) :: velocity(2)   !< length per unit of time
      real(wp), intent(inout) :: change(2)   !< acceleration: length per unit of time squared
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
