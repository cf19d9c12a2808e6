!> Vectors of the plane, as x and y: rotation, quarter turn, cross product, and a point that rotates with a link.
module planar
   use kinds, only: wp
   implicit none
   private
   public :: direction, rotated, quarter_turn, cross, point_of, add_rotating

contains

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
end module planar
