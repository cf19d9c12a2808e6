!> From bounds of the errors of the unknowns to those of links, points and pairs, along the tree as `link_motion` has
!> it: each vector adds its length times the error of the unit vector that turns it, and its own rounding.
module link_bounds
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_link, request_point, pair_prismatic, plane_origin
   use motion, only: motion_t
   use points, only: point_motion
   use links_tree, only: tree_t, new_tree
   use block_engine, only: block_engine_t
   use proof_data, only: angle_errors, rounding, of_number, of_vector
   use row_bounds, only: jets_t, turn, turn_errors, product_error, highest
   implicit none
   private
   public :: link_bounds_t, new_link_bounds, bound_links, row_bound, largest_bounds

   !> Lengths of the vectors of each link of the engine's chain of all links, in the deck's unit, and what their
   !> rounding leaves open.
   type :: link_bounds_t
      real(wp), allocatable :: length(:, :)      !< (3, chain) reach, body vector, direction of the slide
      real(wp), allocatable :: weight(:, :)      !< (3, chain)
      real(wp), allocatable :: angle(:)          !< (chain) of the link's angle from its orientation, rad
   end type link_bounds_t

contains

   !> Those of the chain of all links of the engine `e` of `m`.
   function new_link_bounds(m, e) result(l)
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(link_bounds_t) :: l
      type(tree_t) :: t
      real(wp), allocatable :: angle(:)
      real(wp) :: terms(2)
      integer :: i

      t = new_tree(m)
      ! A function's result would bring its own lower bound.
      allocate (angle(0:t%orientations))
      angle(:) = angle_errors(m, t)
      associate (n => size(e%whole%links))
         allocate (l%length(3, n), l%weight(3, n), l%angle(n), source=0.0_wp)
      end associate
      do i = 1, size(l%angle)
         associate (h => e%whole%links(i))
            l%angle(i) = angle(h%orientation)
            l%length(1, i) = norm2(h%place%reach)
            l%length(2, i) = norm2(h%place%body_vector)
            l%length(3, i) = norm2(h%place%slide_body_vector)*e%length
            terms = term_lengths(m, t, h%link)
            l%weight(1, i) = (of_number + 2.0_wp*of_vector + angle(h%parent_orientation))*terms(1)
            l%weight(2, i) = (of_number + 2.0_wp*of_vector + angle(h%orientation))*terms(2)
            l%weight(3, i) = (of_number + 2.0_wp*of_vector + angle(h%parent_orientation))*l%length(3, i)
         end associate
      end do
   end function new_link_bounds

   !> The lengths (2) that are added up to the reach and to the body vector of `link`.
   pure function term_lengths(m, t, link) result(terms)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      integer, intent(in) :: link
      real(wp) :: terms(2)
      integer :: parent

      terms = 0.0_wp
      parent = t%parent(link)
      if (parent == 0) return
      associate (pair => m%pairs(t%parent_joint(link)))
         associate (own_is_j => m%points(pair%point_j)%link == link)
            terms(1) = norm2(m%points(merge(pair%point_i, pair%point_j, own_is_j))%offset)
            terms(2) = norm2(m%points(merge(pair%point_j, pair%point_i, own_is_j))%offset)
         end associate
         if (pair%kind == pair_prismatic) terms(1) = terms(1) + abs(pair%offset)
      end associate
      if (m%links(parent)%ground) terms(1) = terms(1) + norm2(m%links(parent)%position(:2)) + norm2(plane_origin(m))
   end function term_lengths

   !> `error` (3, 0:2, links): the exact place and angle of each link and their derivatives differ by no more from those
   !> of the engine `e` of which `j` has the bounds; those of ground links, of which nothing is computed, by nothing.
   pure subroutine bound_links(l, e, j, error)
      type(link_bounds_t), intent(in) :: l
      type(block_engine_t), intent(in) :: e
      type(jets_t), intent(in) :: j
      real(wp), intent(out) :: error(3, 0:2, size(e%orientation_of))
      real(wp) :: size_of(0:2, 0:size(error, 3)), x, y
      integer :: i, k

      do i = 1, size(error, 3)
         error(:, :, i) = 0.0_wp
      end do
      size_of(:, 0) = 0.0_wp
      do i = 1, size(e%whole%links)
         associate (h => e%whole%links(i), p => e%whole%links(i)%parent_orientation, &
            o => e%whole%links(i)%orientation, own => e%whole%links(i)%link, reach => l%length(:, i), &
            weight => l%weight(:, i))
            do k = 0, 2
               x = reach(1)*j%turn_error(k, p) + weight(1)*j%turn(k, p) + reach(2)*j%turn_error(k, o) &
                  + weight(2)*j%turn(k, o)
               y = reach(1)*j%turn(k, p) + reach(2)*j%turn(k, o)
               if (h%slide > 0) call product_error(k, j%own(:, h%slide), j%own_error(:, h%slide), j%turn(:, p), &
                  j%turn_error(:, p), reach(3), weight(3), y, x)
               if (h%root > 0) then
                  y = e%length*maxval(h%root_unit)*max(j%own(k, h%root), j%own(k, h%root + 1))
                  x = e%length*maxval(h%root_unit)*max(j%own_error(k, h%root), j%own_error(k, h%root + 1))
               end if
               if (h%parent > 0) x = x + error(1, k, h%parent)
               y = y + size_of(k, h%parent)
               size_of(k, own) = y
               x = (x + 8.0_wp*rounding*y)*(1.0_wp + 64.0_wp*rounding)
               error(1, k, own) = x
               error(2, k, own) = x
               error(3, k, own) = j%own_error(k, o)*(1.0_wp + 16.0_wp*rounding)
            end do
            error(3, 0, own) = error(3, 0, own) + l%angle(i) + 2.0_wp*rounding*(j%own(0, o) + abs(h%angle_offset))
         end associate
      end do
   end subroutine bound_links

   !> The same (3, 0:2) of the row of the motion `q` of `m` that `request` asks for, a link, point or pair; `links`
   !> (3, 0:2, links): those of all links.
   pure function row_bound(m, q, links, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      type(request_t), intent(in) :: request
      real(wp) :: error(3, 0:2)

      error = 0.0_wp
      associate (i => request%subject)
         select case (request%kind)
         case (request_link)
            error = links(:, :, i)
            error(:2, 0) = error(:2, 0) + place_rounding(m, q%position(:2, i))
         case (request_point)
            error(:2, :) = spread(point_bound(m, q, links, i), 1, 2)
            error(:2, 0) = error(:2, 0) + place_rounding(m, q%position(:2, m%points(i)%link) + m%points(i)%offset)
         case default
            error(1, :) = pair_bound(m, q, links, i)
         end select
      end associate
      ! Degrees, and the digits of a row.
      error = (error + 4.0_wp*rounding*error)*(1.0_wp + 16.0_wp*rounding)
   end function row_bound

   !> (0:2) The largest of those of `links` (3, 0:2, links), in parts of the characteristic `length` and `rate`.
   pure function largest_bounds(links, length, rate) result(largest)
      real(wp), intent(in) :: links(:, 0:, :), length, rate
      real(wp) :: largest(0:2)
      integer :: i, k

      largest = 0.0_wp
      do i = 1, size(links, 3)
         do k = 0, 2
            largest(k) = max(largest(k), max(links(1, k, i), links(2, k, i))/length, links(3, k, i))
         end do
      end do
      largest = largest/rate**[0, 1, 2]
   end function largest_bounds

   !> What rounding leaves open of a place near `x` (2) counted from the first ground link, when that is added.
   pure real(wp) function place_rounding(m, x)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: x(2)

      place_rounding = 2.0_wp*(of_number + rounding)*norm2(plane_origin(m)) + 4.0_wp*rounding*norm2(x)
   end function place_rounding

   !> Bounds of the angle of `link` of `m` in the motion `q` and of its derivatives, `own`, and of their errors `error`.
   pure subroutine bound_angle(m, q, links, link, own, error)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      integer, intent(in) :: link
      real(wp), intent(out) :: own(0:highest), error(0:highest)

      own = 0.0_wp
      error = 0.0_wp
      if (m%links(link)%ground) then
         own(0) = abs(m%links(link)%position(3))
         error(0) = of_number*own(0)
      else
         own(:2) = abs([q%position(3, link), q%velocity(3, link), q%acceleration(3, link)])
         error(:2) = links(3, :, link)
      end if
   end subroutine bound_angle

   !> (0:2) Those of point number `i`, counted from the first ground link.
   pure function point_bound(m, q, links, i) result(error)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      integer, intent(in) :: i
      real(wp) :: error(0:2), own(0:highest), off(0:highest), arm(0:highest), arm_error(0:highest)

      associate (link => m%points(i)%link, length => norm2(m%points(i)%offset))
         call bound_angle(m, q, links, link, own, off)
         arm = turn(own)
         arm_error = turn_errors(own, off)
         error = length*(arm_error(:2) + (of_number + 2.0_wp*of_vector)*arm(:2))
         if (m%links(link)%ground) then
            error(0) = error(0) + 2.0_wp*of_number*(norm2(m%links(link)%position(:2)) + norm2(plane_origin(m)))
         else
            error = error + links(1, :, link) + 2.0_wp*rounding*[norm2(q%position(:2, link)), &
               norm2(q%velocity(:2, link)), norm2(q%acceleration(:2, link))]
         end if
      end associate
   end function point_bound

   !> (0:2) Those of pair number `k`: its relative angle, or its slide.
   pure function pair_bound(m, q, links, k) result(error)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      integer, intent(in) :: k
      real(wp) :: error(0:2), d(2, 0:2), between(0:highest), between_error(0:highest), size_of
      real(wp), dimension(0:highest) :: own, off, other, other_off
      integer :: a

      associate (pair => m%pairs(k))
         call bound_angle(m, q, links, m%points(pair%point_i)%link, own, off)
         call bound_angle(m, q, links, m%points(pair%point_j)%link, other, other_off)
         error = off(:2) + other_off(:2) + 2.0_wp*rounding*(own(:2) + other(:2))
         if (pair%kind /= pair_prismatic) return
         off(0) = off(0) + (of_number + 2.0_wp*rounding)*abs(pair%alpha) + 2.0_wp*rounding*own(0)
         d = point_motion(m, q, pair%point_j) - point_motion(m, q, pair%point_i)
         between = 0.0_wp
         between(:2) = norm2(d, dim=1)
         between_error = 0.0_wp
         between_error(:2) = 2.0_wp*(point_bound(m, q, links, pair%point_i) + point_bound(m, q, links, pair%point_j))
         do a = 0, 2
            size_of = 0.0_wp
            error(a) = 0.0_wp
            call product_error(a, between, between_error, turn(own), turn_errors(own, off), 1.0_wp, 2.0_wp*of_vector, &
               size_of, error(a))
         end do
      end associate
   end function pair_bound
end module link_bounds
