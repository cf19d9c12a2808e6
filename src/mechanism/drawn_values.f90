!> The values of a drawing: the numbers of pairs and the values of drives for the positions of links on their cards. In
!> a deck with JOINT cards a blank number means "as drawn".
module drawn_values
   use kinds, only: wp
   use plane_vectors, only: point_of, pi
   use pair_geometry, only: way_of, closure_error_of, slide_of
   use mechanism, only: mechanism_t, pair_t, drive_t, pair_links, drive_angle, drive_x, drive_y, drive_relangle
   implicit none
   private
   public :: complete_from_drawing, drawn_place, drawn_drive, drawn_way, drawn_closure_error, coincides

   !> A relative difference below this is zero. A coordinate passes through about ten operations, each with an error of
   !> half a rounding of the coordinates involved; coordinates that another program has printed are off by one or two
   !> roundings more.
   real(wp), parameter :: drawing_error = 32.0_wp*epsilon(1.0_wp)

contains

   !> Computes the numbers of a prismatic pair that are as drawn: alpha (rad), h (length) and beta (rad).
   !>
   !> - If alpha is as drawn, the guide runs from P to Q: alpha is the direction of PQ, in (-pi, pi], less the angle of
   !>   link i, and h is 0.
   !> - Differences that are only rounding become exactly 0.
   !> - The block of a slot gets the position of the pin in the drawing, with the angle of link i.
   pure subroutine complete_from_drawing(m, i)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: i               !< number of the pair
      type(pair_t) :: pair
      real(wp) :: d(2), phi(2), theta

      pair = m%pairs(i)
      if (pair%pin > 0) m%links(m%points(pair%point_j)%link)%position = &
         [drawn_place(m, pair%pin), m%links(m%points(pair%point_i)%link)%position(3)]
      phi = m%links(pair_links(m, pair))%position(3)
      if (pair%drawn(2)) then
         pair%offset = 0.0_wp
         if (.not. pair%drawn(1)) pair%offset = drawn_closure_error(m, pair)
      end if
      if (pair%drawn(1)) then
         d = drawn_way(m, pair)
         theta = atan2(d(2), d(1))
         if (theta <= -pi) theta = pi
         pair%alpha = theta - phi(1)
      end if
      if (pair%drawn(3)) pair%beta = without_rounding(phi(2) - phi(1), sum(abs(phi)))
      m%pairs(i) = pair
   end subroutine complete_from_drawing

   !> Finds by how much h of a prismatic pair is greater in the drawing than on its card: (P - Q) . n - h (eq. 9), in
   !> the deck's unit of length; exactly 0 if the difference is only rounding.
   pure real(wp) function drawn_closure_error(m, pair) result(closure_error)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      integer :: links(2)

      links = pair_links(m, pair)
      closure_error = -closure_error_of(m, pair, m%links(links(1))%position, m%links(links(2))%position)
      closure_error = without_rounding(closure_error, size_of_pair(m, pair) + abs(pair%offset))
   end function drawn_closure_error

   !> Finds the value (length or rad) of the coordinate of a drive in the drawing; exactly 0 if the value is only
   !> rounding.
   pure real(wp) function drawn_drive(m, drive) result(value)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive     !< of `m`
      real(wp) :: p(2)

      associate (k => drive%subject)
         select case (drive%kind)
         case (drive_angle)
            value = m%links(k)%position(3)
         case (drive_relangle)
            value = m%links(drive%second)%position(3) - m%links(k)%position(3)
            value = without_rounding(value, abs(m%links(drive%second)%position(3)) + abs(m%links(k)%position(3)))
         case (drive_x, drive_y)
            p = drawn_place(m, k)
            value = without_rounding(merge(p(1), p(2), drive%kind == drive_x), size_of_point(m, k))
         case default
            associate (pair => m%pairs(k), links => pair_links(m, m%pairs(k)))
               value = slide_of(m, pair, m%links(links(1))%position, m%links(links(2))%position)
               value = without_rounding(value, size_of_pair(m, pair))
            end associate
         end select
      end associate
   end function drawn_drive

   !> Finds the vector (2) from P to Q of a pair in the drawing, in the deck's unit of length.
   pure function drawn_way(m, pair) result(d)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`
      real(wp) :: d(2)

      associate (links => pair_links(m, pair))
         d = way_of(m, pair, m%links(links(1))%position, m%links(links(2))%position)
      end associate
   end function drawn_way

   !> Tells whether P and Q of a pair coincide in the drawing, but for rounding.
   pure logical function coincides(m, pair)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`

      coincides = .not. abs(without_rounding(norm2(drawn_way(m, pair)), size_of_pair(m, pair))) > 0.0_wp
   end function coincides

   !> Finds the position x, y (2) of a point in the drawing, in the deck's unit of length.
   pure function drawn_place(m, k) result(p)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k               !< number of the point
      real(wp) :: p(2)

      p = point_of(m%links(m%points(k)%link)%position, m%points(k)%offset)
   end function drawn_place

   !> Gives the length to which the rounding error of the position of a point is relative, in the deck's unit.
   pure real(wp) function size_of_point(m, k) result(length)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k               !< number of the point

      associate (link => m%links(m%points(k)%link))
         length = norm2(link%position(:2)) + norm2(m%points(k)%offset)*(1.0_wp + abs(link%position(3)))
      end associate
   end function size_of_point

   !> Gives the length to which the rounding error of the vector from P to Q of a pair is relative, along and across the
   !> guide, in the deck's unit. Of a slot Q is the pin.
   pure real(wp) function size_of_pair(m, pair) result(length)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair       !< of `m`

      length = size_of_point(m, pair%point_i) + size_of_point(m, merge(pair%pin, pair%point_j, pair%pin > 0)) &
         + norm2(drawn_way(m, pair)) &
         *(abs(pair%alpha) + abs(m%links(m%points(pair%point_i)%link)%position(3)))
   end function size_of_pair

   !> Gives a value, or 0 if the value is within the rounding error of the numbers from which it was found.
   pure real(wp) function without_rounding(value, size_of) result(rest)
      real(wp), intent(in) :: value          !< length or rad
      real(wp), intent(in) :: size_of        !< sum of the sizes of these numbers, in the unit of `value`

      rest = merge(0.0_wp, value, abs(value) <= drawing_error*size_of)
   end function without_rounding
end module drawn_values
