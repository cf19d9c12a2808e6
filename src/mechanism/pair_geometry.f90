!> The closure error and the coordinate of a pair, from the positions of its links.
!>
!> Point P of link i and point Q of link j. The guide of a prismatic pair lies in link i: its direction is
!> e = (cos theta, sin theta), theta = phi_i + alpha, and its normal n is e turned by a quarter turn. Its slide is
!> (Q - P) . e, eq. (3) and (4), and it is closed if (P - Q) . n = h, eq. (9).
module pair_geometry
   use kinds, only: wp
   use plane_vectors, only: direction, quarter_turn, point_of
   use mechanism, only: mechanism_t, pair_t, has_guide
   use instant_centres, only: seen_from
   implicit none
   private
   public :: way_of, closure_error_of, slide_of, pair_motion

contains

   !> Finds the vector (2) from P to Q of a pair, in the deck's unit.
   pure function way_of(m, pair, link_i, link_j) result(way)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: link_i(3), link_j(3)     !< x, y (length) and phi (rad) of its links
      real(wp) :: way(2)

      way = point_of(link_j, m%points(pair%point_j)%offset) - point_of(link_i, m%points(pair%point_i)%offset)
   end function way_of

   !> Finds the closure error of a pair, in the deck's unit of length: the distance from P to Q, or h + (Q - P) . n
   !> across a guide.
   pure real(wp) function closure_error_of(m, pair, link_i, link_j) result(closure_error)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: link_i(3), link_j(3)     !< x, y (length) and phi (rad) of its links

      closure_error = norm2(way_of(m, pair, link_i, link_j))
      if (has_guide(pair%kind)) closure_error = pair%offset + dot_product(way_of(m, pair, link_i, link_j), &
         quarter_turn(direction(link_i(3) + pair%alpha)))
   end function closure_error_of

   !> Finds the slide of a prismatic pair, in the deck's unit.
   pure real(wp) function slide_of(m, pair, link_i, link_j) result(slide)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: link_i(3), link_j(3)     !< x, y (length) and phi (rad) of its links

      slide = dot_product(way_of(m, pair, link_i, link_j), direction(link_i(3) + pair%alpha))
   end function slide_of

   !> Finds the coordinate of a pair with its derivatives (0:2): the slide of a prismatic pair (length), or the angle
   !> phi_j - phi_i (rad). The slide is found in the axes of `link_i`, in which P and the guide are at rest.
   pure function pair_motion(m, pair, link_i, link_j, point) result(coordinate)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair
      real(wp), intent(in) :: link_i(3, 0:2), link_j(3, 0:2) !< x, y (length), phi (rad); derivatives
      real(wp), intent(in) :: point(2, 0:2)      !< x and y (length) of Q, with derivatives
      real(wp) :: coordinate(0:2), r(2, 0:2)

      coordinate = link_j(3, :) - link_i(3, :)
      if (.not. has_guide(pair%kind)) return
      r = seen_from(link_i, point)
      r(:, 0) = r(:, 0) - m%points(pair%point_i)%offset
      coordinate = matmul(direction(pair%alpha), r)
   end function pair_motion
end module pair_geometry
