!> The closure error and the coordinate of a pair, from the positions of its links.
!>
!> A pair has point P of link i and point Q of link j. The guide of a prismatic pair lies in link i: its direction is
!> e = (cos theta, sin theta), theta = phi_i + alpha, and its normal n is e rotated by a quarter turn. The slide is
!> (Q - P) . e, eq. (3) and (4), and the pair is closed if (P - Q) . n = h, eq. (9).
module pair_geometry
   use kinds, only: wp
   use plane_vectors, only: direction, quarter_turn, point_of
   use mechanism, only: mechanism_t, pair_t, has_guide
   use instant_centres, only: seen_from
   implicit none
   private
   public :: way_of, closure_error_of, slide_of, pair_motion

contains

   !> Finds the vector x, y (2) from P to Q of a pair, in the deck's unit of length.
   pure function way_of(m, pair, link_i, link_j) result(way)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      real(wp), intent(in) :: link_i(3), link_j(3)     !< x, y (length) and phi (rad) of its links
      real(wp) :: way(2)

      way = point_of(link_j, m%points(pair%point_j)%offset) - point_of(link_i, m%points(pair%point_i)%offset)
   end function way_of

   !> Finds the closure error of a pair, in the deck's unit of length: of a revolute pair the distance from P to Q, of a
   !> prismatic pair h + (Q - P) . n, eq. (9), with its sign.
   pure real(wp) function closure_error_of(m, pair, link_i, link_j) result(closure_error)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      real(wp), intent(in) :: link_i(3), link_j(3)     !< x, y (length) and phi (rad) of its links

      closure_error = norm2(way_of(m, pair, link_i, link_j))
      if (has_guide(pair%kind)) closure_error = pair%offset + dot_product(way_of(m, pair, link_i, link_j), &
         quarter_turn(direction(link_i(3) + pair%alpha)))
   end function closure_error_of

   !> Finds the slide (Q - P) . e of a prismatic pair, eq. (3) and (4), in the deck's unit of length.
   pure real(wp) function slide_of(m, pair, link_i, link_j) result(slide)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      real(wp), intent(in) :: link_i(3), link_j(3)     !< x, y (length) and phi (rad) of its links

      slide = dot_product(way_of(m, pair, link_i, link_j), direction(link_i(3) + pair%alpha))
   end function slide_of

   !> Finds the coordinate of a pair with its first two derivatives by time (0:2): the slide of a prismatic pair
   !> (length), or the angle phi_j - phi_i of a revolute pair (rad). The slide is found in the axes of link i, in which
   !> P and the guide are at rest.
   pure function pair_motion(m, pair, link_i, link_j, point) result(coordinate)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      real(wp), intent(in) :: link_i(3, 0:2), link_j(3, 0:2) !< x, y (length), phi (rad) of its links; derivatives
      real(wp), intent(in) :: point(2, 0:2)      !< x, y of Q (length), derivatives; of a revolute pair any
      real(wp) :: coordinate(0:2), r(2, 0:2)

      coordinate = link_j(3, :) - link_i(3, :)
      if (.not. has_guide(pair%kind)) return
      r = seen_from(link_i, point)
      r(:, 0) = r(:, 0) - m%points(pair%point_i)%offset
      coordinate = matmul(direction(pair%alpha), r)
   end function pair_motion
end module pair_geometry
