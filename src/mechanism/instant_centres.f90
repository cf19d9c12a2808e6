!> The instant centre of the motion of two links, and the centre of curvature of a point's path, from positions,
!> velocities and accelerations. A centre may be at infinity, or nothing may move: which of these holds depends on no
!> unit.
module instant_centres
   use kinds, only: wp
   use plane_vectors, only: pi, rotated, quarter_turn, cross
   implicit none
   private
   public :: centre_t, pole_of, curve_of, seen_from
   public :: centre_finite, centre_infinite, centre_starting, centre_resting, points_coincide

   !> The states of a centre.
   enum, bind(c)
      enumerator :: centre_finite = 0 !< all numbers of the centre exist
      enumerator :: centre_infinite   !< farther than any length of the mechanism: only its direction exists
      enumerator :: centre_starting   !< of a curve: the point stands still, and its acceleration has a direction
      enumerator :: centre_resting    !< nothing moves
      enumerator :: points_coincide   !< of a measure: two points are at one place
   end enum

   !> A motion below this part of the characteristic motion is rest. A centre that is farther than 1/negligible_motion
   !> (6.7E7 in real64) characteristic lengths is at infinity. Reason: angular velocities have an error of one rounding
   !> or, if the mechanism is ill-conditioned, of many. With half of the digits, parallel cranks differ from nearly
   !> parallel cranks as long as half of the digits are right, and a finite centre has the other half.
   real(wp), parameter :: negligible_motion = sqrt(epsilon(1.0_wp))
   !> A weight is at least this part of the velocity with which it is compared, so that the division by it is finite.
   real(wp), parameter :: least_weight = epsilon(1.0_wp)**2
   !> A direction within this distance (rad) of the lower end of the range of angles becomes the upper end: rounding
   !> must not choose between both. Half of the digits are more than any rounding.
   real(wp), parameter :: end_of_range = sqrt(epsilon(1.0_wp))

   !> A centre. Its coordinates times its `weight` are finite even at infinity. `value` has:
   !>
   !> - of a pole, x, y and direction in the fixed plane (:, 0), in the axes of link I (:, 1) and of link J (:, 2);
   !> - of a curve, the point and the tangent (:, 0), the centre of curvature (:2, 1), the radius (1, 2), speed and
   !>   acceleration in units of the characteristic length and rate (3, 1:).
   type :: centre_t
      integer :: state = centre_finite       !< centre_finite, ...
      !> Of a pole the relative angular velocity (rad per unit of time); of a curve v x a in units of the characteristic
      !> length and rate; of a measure the least distance of two of its points, in characteristic lengths.
      real(wp) :: weight = 1.0_wp
      real(wp) :: value(3, 0:2) = 0.0_wp     !< lengths in the deck's unit, angles in rad
   end type centre_t

contains

   !> Finds the instant centre of the motion of link J relative to link I. With o the origin of link J, u its velocity
   !> relative to link I, w the relative angular velocity and R a quarter turn:  p = o + R u/w  (Bottema and Roth,
   !> Theoretical Kinematics, 1979, ch. VIII). At infinity the centre is in the direction of R u.
   pure function pole_of(link_i, link_j, length, rate) result(c)
      real(wp), intent(in) :: link_i(3, 0:2), link_j(3, 0:2)   !< x, y (length), phi (rad); derivatives by time
      real(wp), intent(in) :: length         !< characteristic length, above 0
      real(wp), intent(in) :: rate           !< characteristic rate, above 0, 1 over the unit of time
      type(centre_t) :: c
      real(wp) :: d(2), u(2), w, to_pole(2), to_i(2), to_j(2)

      to_i = [cos(link_i(3, 0)), -sin(link_i(3, 0))]
      to_j = [cos(link_j(3, 0)), -sin(link_j(3, 0))]
      d = link_j(:2, 0) - link_i(:2, 0)
      u = link_j(:2, 1) - link_i(:2, 1) - link_i(3, 1)*quarter_turn(d)
      w = link_j(3, 1) - link_i(3, 1)
      if (max(norm2(u), abs(w)*length) <= negligible_motion*length*rate) then
         c%state = centre_resting
         return
      end if
      if (abs(w)*length <= negligible_motion*norm2(u)) c%state = centre_infinite
      c%weight = sign(max(abs(w), least_weight*norm2(u)/length), w)
      to_pole = quarter_turn(u)/c%weight
      c%value(:2, 0) = link_j(:2, 0) + to_pole
      c%value(:2, 1) = rotated(d + to_pole, to_i)
      c%value(:2, 2) = rotated(to_pole, to_j)
      c%value(3, :) = [line_angle(quarter_turn(u)), line_angle(rotated(quarter_turn(u), to_i)), &
         line_angle(rotated(quarter_turn(u), to_j))]
   end function pole_of

   !> Finds the position, velocity and acceleration x, y (2, 0:2) of a point relative to a moving link, in the axes of
   !> the link and the deck's units.
   pure function seen_from(frame, motion) result(r)
      real(wp), intent(in) :: frame(3, 0:2)  !< of the link: x, y (length), phi (rad); derivatives by time
      real(wp), intent(in) :: motion(2, 0:2) !< of the point in the fixed plane: x, y (length); derivatives by time
      real(wp) :: r(2, 0:2), back(2)

      r = motion - frame(:2, :)
      r(:, 1) = r(:, 1) - frame(3, 1)*quarter_turn(r(:, 0))
      r(:, 2) = r(:, 2) - frame(3, 2)*quarter_turn(r(:, 0)) + frame(3, 1)**2*r(:, 0) &
         - 2.0_wp*frame(3, 1)*quarter_turn(r(:, 1))
      back = [cos(frame(3, 0)), -sin(frame(3, 0))]
      r(:, 0) = rotated(r(:, 0), back)
      r(:, 1) = rotated(r(:, 1), back)
      r(:, 2) = rotated(r(:, 2), back)
   end function seen_from

   !> Finds the tangent, radius and centre of curvature of the path of a point P with the velocity v and the
   !> acceleration a:  radius |v|**3/|v x a|,  centre P + R v |v|**2/(v x a),  R a quarter turn. If the point is at
   !> rest, its path begins in the direction of a, and its curvature does not follow from v and a: only the tangent is
   !> found.
   pure function curve_of(motion, length, rate) result(c)
      real(wp), intent(in) :: motion(2, 0:2) !< of the point: x, y (length); derivatives by time
      real(wp), intent(in) :: length         !< characteristic length, above 0
      real(wp), intent(in) :: rate           !< characteristic rate, above 0, 1 over the unit of time
      type(centre_t) :: c
      real(wp) :: v(2), a(2), speed

      ! In units of the characteristic length and rate, cubes do not overflow.
      v = motion(:, 1)/(length*rate)
      a = motion(:, 2)/(length*rate**2)
      speed = norm2(v)
      c%value(3, 1:) = [speed, norm2(a)]
      c%value(:2, 0) = motion(:, 0)
      c%value(3, 0) = arrow_angle(v)
      if (speed <= negligible_motion) then
         c%state = merge(centre_starting, centre_resting, norm2(a) > negligible_motion)
         c%value(3, 0) = arrow_angle(a)
         return
      end if
      c%weight = cross(v, a)
      ! Rejected: parts of |v| |a|. Near an end of its stroke a point is slow, and its acceleration nearly all
      ! tangential.
      if (abs(c%weight) <= negligible_motion*speed**3) c%state = centre_infinite
      c%weight = sign(max(abs(c%weight), least_weight*speed**3), c%weight)
      c%value(:2, 1) = motion(:, 0) + quarter_turn(v)*(length*speed**2/c%weight)
      c%value(1, 2) = length*speed**3/abs(c%weight)
   end function curve_of

   !> Gives the direction of a vector (rad), from -pi (excluded) to pi, but for `end_of_range`; 0 for a zero vector.
   pure real(wp) function arrow_angle(vector)
      real(wp), intent(in) :: vector(2)      !< in any unit

      arrow_angle = 0.0_wp
      if (any(abs(vector) > 0.0_wp)) arrow_angle = atan2(vector(2), vector(1))
      if (arrow_angle <= end_of_range - pi) arrow_angle = arrow_angle + 2.0_wp*pi
   end function arrow_angle

   !> Gives the direction of the line along a vector (rad), from -pi/2 (excluded) to pi/2, but for `end_of_range`; 0 for
   !> a zero vector.
   pure real(wp) function line_angle(vector)
      real(wp), intent(in) :: vector(2)      !< in any unit

      line_angle = arrow_angle(vector)
      if (line_angle > 0.5_wp*pi + end_of_range) line_angle = line_angle - pi
      if (line_angle <= end_of_range - 0.5_wp*pi) line_angle = line_angle + pi
   end function line_angle
end module instant_centres
