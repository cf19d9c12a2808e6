!> What a drawing shows: the numbers of pairs and the values of drives where the cards put the links. With JOINT cards a
!> blank number means "as drawn".
module drawn_values
   use kinds, only: wp
   use plane_vectors, only: point_of, pi
   use pair_geometry, only: way_of, opening_of, slide_of
   use mechanism, only: mechanism_t, pair_t, drive_t, pair_links, drive_angle, drive_x, drive_y, drive_relangle
   implicit none
   private
   public :: take_drawn, follow_drawing, drawn_place, drawn_drive, drawn_way, drawn_opening, coincides

   !> A coordinate passes through about ten operations, each with an error of half a rounding of the places involved;
   !> coordinates that another program has printed are off by one or two more. A difference below this is zero.
   real(wp), parameter :: roundings = 32.0_wp*epsilon(1.0_wp)

contains

   !> Gives prismatic pair number `i` of `m` those of its numbers alpha, h and beta (length, rad) that are as drawn.
   !> Along a guide that is drawn from P to Q the direction is that of PQ, in (-pi, pi], less the angle of link i, and h
   !> is 0. Differences that rounding alone makes are exactly 0. The block of a slot is where the point in the slot is
   !> drawn, and turned as link i.
   pure subroutine take_drawn(m, i)
      type(mechanism_t), intent(inout) :: m
      integer, intent(in) :: i
      type(pair_t) :: pair
      real(wp) :: d(2), phi(2), theta

      pair = m%pairs(i)
      if (pair%pin > 0) m%links(m%points(pair%point_j)%link)%position = &
         [drawn_place(m, pair%pin), m%links(m%points(pair%point_i)%link)%position(3)]
      phi = m%links(pair_links(m, pair))%position(3)
      if (pair%drawn(2)) then
         pair%offset = 0.0_wp
         if (.not. pair%drawn(1)) pair%offset = drawn_opening(m, pair)
      end if
      if (pair%drawn(1)) then
         d = drawn_way(m, pair)
         theta = atan2(d(2), d(1))
         if (theta <= -pi) theta = pi
         pair%alpha = theta - phi(1)
      end if
      if (pair%drawn(3)) pair%beta = without_rounding(phi(2) - phi(1), sum(abs(phi)))
      m%pairs(i) = pair
   end subroutine take_drawn

   !> Gives all numbers of `m` that are as drawn the values of the drawing of `m`. Lengths have moved points since these
   !> numbers were taken: they change by as much as in the drawing since `before`, which has no room without lengths.
   pure recursive subroutine follow_drawing(m, before)
      type(mechanism_t), intent(inout) :: m
      type(mechanism_t), allocatable, intent(in) :: before
      type(mechanism_t), allocatable :: taken, none
      integer :: i

      do i = 1, size(m%pairs)
         if (any(m%pairs(i)%drawn) .or. m%pairs(i)%pin > 0) call take_drawn(m, i)
      end do
      do i = 1, size(m%drives)
         if (m%drives(i)%drawn) m%drives(i)%polynomial(1) = drawn_drive(m, m%drives(i))
      end do
      if (.not. allocated(before)) return
      taken = before
      call follow_drawing(taken, none)
      where (m%pairs%drawn(1)) m%pairs%alpha = before%pairs%alpha + (m%pairs%alpha - taken%pairs%alpha)
      where (m%pairs%drawn(2)) m%pairs%offset = before%pairs%offset + (m%pairs%offset - taken%pairs%offset)
      where (m%pairs%drawn(3)) m%pairs%beta = before%pairs%beta + (m%pairs%beta - taken%pairs%beta)
      where (m%drives%drawn) m%drives%polynomial(1) = before%drives%polynomial(1) &
         + (m%drives%polynomial(1) - taken%drives%polynomial(1))
   end subroutine follow_drawing

   !> By how much h of the prismatic `pair` is greater in the drawing of `m` than on its card: (P - Q) . n - h.
   pure real(wp) function drawn_opening(m, pair) result(opening)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair
      integer :: links(2)

      links = pair_links(m, pair)
      opening = -opening_of(m, pair, m%links(links(1))%position, m%links(links(2))%position)
      opening = without_rounding(opening, size_of_pair(m, pair) + abs(pair%offset))
   end function drawn_opening

   !> The value (length, rad) of the coordinate of `drive` in the drawing of `m`.
   pure real(wp) function drawn_drive(m, drive) result(value)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive
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

   !> The vector (2) from P to Q of `pair` in the drawing of `m`.
   pure function drawn_way(m, pair) result(d)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair
      real(wp) :: d(2)

      associate (links => pair_links(m, pair))
         d = way_of(m, pair, m%links(links(1))%position, m%links(links(2))%position)
      end associate
   end function drawn_way

   !> Whether P and Q of `pair` are at one place in the drawing of `m`.
   pure logical function coincides(m, pair)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair

      coincides = .not. abs(without_rounding(norm2(drawn_way(m, pair)), size_of_pair(m, pair))) > 0.0_wp
   end function coincides

   !> The place (2) of point number `k` in the drawing of `m`.
   pure function drawn_place(m, k) result(p)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      real(wp) :: p(2)

      p = point_of(m%links(m%points(k)%link)%position, m%points(k)%offset)
   end function drawn_place

   !> The length by which the roundings of the place of point number `k` go.
   pure real(wp) function size_of_point(m, k) result(length)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k

      associate (link => m%links(m%points(k)%link))
         length = norm2(link%position(:2)) + norm2(m%points(k)%offset)*(1.0_wp + abs(link%position(3)))
      end associate
   end function size_of_point

   !> Tells the size of what is added up to the way from P to Q of `pair`, along and across its guide.
   pure real(wp) function size_of_pair(m, pair) result(length)
      type(mechanism_t), intent(in) :: m
      type(pair_t), intent(in) :: pair

      length = size_of_point(m, pair%point_i) + size_of_point(m, merge(pair%pin, pair%point_j, pair%pin > 0)) &
         + norm2(drawn_way(m, pair)) &
         *(abs(pair%alpha) + abs(m%links(m%points(pair%point_i)%link)%position(3)))
   end function size_of_pair

   !> `value`; 0 where the roundings of numbers of the size `size_of` are larger.
   pure real(wp) function without_rounding(value, size_of) result(rest)
      real(wp), intent(in) :: value, size_of

      rest = merge(0.0_wp, value, abs(value) <= roundings*size_of)
   end function without_rounding
end module drawn_values
