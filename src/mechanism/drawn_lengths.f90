!> A drawing with dimensions. LENGTH cards give exact distances between points of a link that the drawing shows
!> approximately. Axes of links can begin at a joint of the link and point to another joint. All ground links are one
!> body. The points that are drawn at one position of a body are one hole, which moves as a whole.
module drawn_lengths
   use kinds, only: wp
   use plane_vectors, only: pi, direction, rotated, point_of, cross
   use mechanism, only: mechanism_t
   implicit none
   private
   public :: reach_t, body_of, join_hole, is_movable, set_axes, apply_lengths, same_place_tolerance

   !> The faults of the LENGTH cards of one hole, if there are any.
   type :: reach_t
      logical :: has_two = .false.           !< two LENGTH cards give its position
      real(wp) :: missing = 0.0_wp           !< length by which the two circles do not meet; 0: they meet
      logical :: has_no_side = .false.       !< drawn in line with both other points; with one length: drawn at P
   end type reach_t

   !> Two positions are one if they differ by less than this part of their distances from the origin: by the roundings
   !> of several sums, or of another program that printed them.
   real(wp), parameter :: same_place_tolerance = 64.0_wp*epsilon(1.0_wp)

contains

   !> Finds the body of a point: the number of the point's link; 0 if the link is ground.
   pure integer function body_of(m, i) result(body)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< the number of the point

      body = m%points(i)%link
      if (m%links(body)%ground) body = 0
   end function body_of

   !> Tells whether a length may move a point: the drawing gives its position. A POINT card of a link with axes along a
   !> bar gives exact coordinates instead.
   pure logical function is_movable(m, i)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< the number of the point

      is_movable = m%points(i)%drawn .or. m%links(m%points(i)%link)%from == 0
   end function is_movable

   !> Joins to one hole all movable points of a body that are drawn at the position of one point: all get one number
   !> `hole` and one position in the drawing. If the point has a hole already, nothing changes.
   pure subroutine join_hole(m, i)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: i               !< the number of the point
      real(wp) :: here(2)
      integer :: j

      if (m%points(i)%hole > 0) return
      here = position_on_card(m, i)
      do j = 1, size(m%points)
         if (m%points(j)%link == 0) cycle
         if (body_of(m, j) /= body_of(m, i) .or. .not. is_movable(m, j)) cycle
         associate (position => position_on_card(m, j))
            if (norm2(position - here) > same_place_tolerance*(norm2(position) + norm2(here))) cycle
         end associate
         m%points(j)%place = merge(here, m%points(j)%offset, m%points(j)%drawn)
         m%points(j)%hole = i
      end do
   end subroutine join_hole

   !> Finds the position x, y (2) of a point in the drawing before lengths move it, in the deck's unit of length.
   pure function position_on_card(m, i) result(position)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< the number of the point
      real(wp) :: position(2)

      associate (point => m%points(i))
         position = merge(point%place, point%offset, point%drawn .or. point%moves)
         if (.not. point%drawn) position = point_of(m%links(point%link)%position, position)
      end associate
   end function position_on_card

   !> Computes the axes of each link that begin at FROM and point to TO, with the angle in (-pi, pi]. Then computes xi
   !> and eta of all points of JOINT cards, and of all points that lengths have moved, in the axes of their links.
   pure subroutine set_axes(m, position)
      type(mechanism_t), intent(inout) :: m
      real(wp), intent(in) :: position(:, :) !< (2, points) x, y of all points in the drawing, length
      real(wp) :: axes(3)
      integer :: i, k

      do i = 1, size(m%links)
         associate (link => m%links(i))
            if (link%from == 0) cycle
            axes(:2) = position(:, link%to) - position(:, link%from)
            axes = [position(:, link%from), atan2(axes(2), axes(1))]
            if (axes(3) <= -pi) axes(3) = pi
            where (link%along) link%position = axes
         end associate
      end do

      do i = 1, size(m%points)
         associate (point => m%points(i))
            if (point%link == 0 .or. .not. (point%drawn .or. point%moves)) cycle
            point%offset = rotated(position(:, i) - m%links(point%link)%position(:2), &
               direction(-m%links(point%link)%position(3)))
         end associate
      end do

      ! The end of a bar with a length lies exactly on its axis, at this length: without a rounding.
      if (.not. allocated(m%lengths)) return
      do i = 1, size(m%lengths)
         associate (p => m%points(m%lengths(i)%point(1)), q => m%points(m%lengths(i)%point(2)))
            if (p%link /= q%link .or. .not. all(m%links(q%link)%along)) cycle
            do k = 1, size(m%points)
               associate (from => m%points(m%links(q%link)%from), to => m%points(m%links(q%link)%to))
                  if (m%points(k)%hole /= to%hole .or. m%points(k)%link /= q%link) cycle
                  if (all([from%hole, to%hole] == m%lengths(i)%hole) .or. &
                     all([to%hole, from%hole] == m%lengths(i)%hole)) &
                     m%points(k)%offset = [m%lengths(i)%length, 0.0_wp]
               end associate
            end do
         end associate
      end do
   end subroutine set_axes

   !> Applies the lengths of a mechanism to its drawing, in their order. Each length moves the hole of its point Q along
   !> the line from P. If the next length has the same hole, the hole moves to the intersection of two circles, on the
   !> side on which the hole is drawn. Axes and points follow; numbers as drawn do not.
   !>
   !> If an earlier call has found the intersection and the lengths have changed, the new one is found by one step of
   !> Newton's method: differences of positions then have no rounding of the square root.
   pure subroutine apply_lengths(m, reached)
      type(mechanism_t), intent(inout) :: m
      type(reach_t), intent(out), optional :: reached(:)   !< (lengths) faults of each hole, at its first length
      type(reach_t) :: reach
      real(wp) :: position(2, size(m%points)), q(2), way(2), ray(2, 2), correction(2)
      integer :: i, k, lengths
      logical :: is_one

      do i = 1, size(m%points)
         if (m%points(i)%link > 0) position(:, i) = position_on_card(m, i)
      end do

      lengths = 0
      if (allocated(m%lengths)) lengths = size(m%lengths)
      k = 1
      do while (k <= lengths)
         associate (one => m%lengths(k), next => m%lengths(min(k + 1, lengths)))
            is_one = k == lengths .or. next%hole(2) /= one%hole(2)
            reach = reach_t(has_two=.not. is_one)
            q = position_on_card(m, one%point(2))

            ! With one length the hole keeps its direction from P.
            if (is_one) then
               way = q - position(:, one%point(1))
               reach%has_no_side = norm2(way) <= same_place_tolerance*(norm2(q) + norm2(position(:, one%point(1))))
               if (.not. reach%has_no_side) q = position(:, one%point(1)) + one%length*(way/norm2(way))
            else
               associate (centre => position(:, [one%point(1), next%point(1)]), radius => [one%length, next%length], &
                     point => m%points(one%point(2)))
                  ray = spread(point_of(m%links(point%link)%position, point%offset), 2, 2) - centre
                  if (point%moves .and. abs(cross(ray(:, 1), ray(:, 2))) > same_place_tolerance*product(radius)) then
                     correction = 0.5_wp*(radius**2 - sum(ray**2, dim=1))/cross(ray(:, 1), ray(:, 2))
                     q = centre(:, 1) + ray(:, 1) + [correction(1)*ray(2, 2) - correction(2)*ray(2, 1), &
                        correction(2)*ray(1, 1) - correction(1)*ray(1, 2)]
                  else
                     call find_intersection(centre, radius, q, reach)
                  end if
               end associate
            end if

            do i = 1, size(m%points)
               if (m%points(i)%hole /= one%hole(2)) cycle
               position(:, i) = q
               m%points(i)%moves = .true.
            end do
            if (present(reached)) reached(k) = reach
         end associate
         k = k + merge(1, 2, is_one)
      end do
      call set_axes(m, position)
   end subroutine apply_lengths

   !> Finds that intersection of two circles that lies on the side of a point. If the circles do not meet, the result is
   !> a point on the line through their centres, and `missing` is above 0. Concentric circles leave the point.
   pure subroutine find_intersection(centre, radius, point, reach)
      real(wp), intent(in) :: centre(2, 2)   !< (coordinates, circles) in the deck's unit of length
      real(wp), intent(in) :: radius(2)      !< (circles) in the deck's unit of length
      real(wp), intent(inout) :: point(2)    !< x, y of the point (length); becomes the intersection
      type(reach_t), intent(inout) :: reach  !< gets `missing` and `has_no_side`
      real(wp) :: way(2), e(2), d, along, square, side

      way = centre(:, 2) - centre(:, 1)
      d = norm2(way)
      reach%missing = max(d - sum(radius), abs(radius(1) - radius(2)) - d)
      if (reach%missing <= same_place_tolerance*(d + sum(radius))) reach%missing = 0.0_wp
      if (.not. d > 0.0_wp) return
      e = way/d
      along = 0.5_wp*(d + (radius(1) - radius(2))*((radius(1) + radius(2))/d))
      square = (radius(1) - along)*(radius(1) + along)
      ! The circles touch but for rounding.
      if (square <= same_place_tolerance*radius(1)**2) square = 0.0_wp
      side = cross(e, point - centre(:, 1))
      reach%has_no_side = square > 0.0_wp .and. &
         abs(side) <= same_place_tolerance*(norm2(point) + norm2(centre(:, 1)) + norm2(centre(:, 2)))
      point = centre(:, 1) + along*e + sign(sqrt(square), side)*[-e(2), e(1)]
   end subroutine find_intersection
end module drawn_lengths
