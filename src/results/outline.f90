!> The shape of a link for the eye: the convex hull of its points, in its own axes. How near other places are to it.
module outline
   use kinds, only: wp
   use grouping, only: sorted_t, sorted, members
   use mechanism, only: mechanism_t
   use planar, only: cross, point_of
   implicit none
   private
   public :: outline_t, outlines_of, hull, corners_at, distance_to

   !> Points of a link closer than this part of the link's extent are one.
   real(wp), parameter :: same_place = 1.0e-6_wp

   type :: outline_t
      real(wp), allocatable :: corner(:, :)  !< (2, corners) two of a bar, one of a single place, none without a point
   end type outline_t

contains

   !> The outlines (links) of all links of `m`, in one pass over its points.
   pure function outlines_of(m) result(list)
      type(mechanism_t), intent(in) :: m
      type(outline_t) :: list(size(m%links))
      type(sorted_t) :: by_link
      real(wp) :: offset(2, size(m%points))
      integer :: i

      do i = 1, size(m%points)
         offset(:, i) = m%points(i)%offset
      end do
      by_link = sorted(m%points%link, size(m%links))
      do i = 1, size(m%links)
         list(i)%corner = hull(offset(:, members(by_link, i)))
      end do
   end function outlines_of

   !> The corners (2, :) of the outline `h` of a link at `position` (x, y, phi).
   pure function corners_at(h, position) result(p)
      type(outline_t), intent(in) :: h
      real(wp), intent(in) :: position(3)
      real(wp) :: p(2, size(h%corner, 2))
      integer :: k

      do k = 1, size(p, 2)
         p(:, k) = point_of(position, h%corner(:, k))
      end do
   end function corners_at

   !> The distance of the place `p` (2) from the outline with the corners `c` (2, 2 or more; counterclockwise), whose
   !> sides are longer at both ends by the part `longer` of their lengths; 0 inside.
   pure real(wp) function distance_to(c, p, longer) result(distance)
      real(wp), intent(in) :: c(:, :), p(2), longer
      real(wp) :: u(2), along
      logical :: inside
      integer :: k, n

      n = size(c, 2)
      inside = n > 2
      distance = huge(distance)
      do k = 1, n
         u = c(:, 1 + modulo(k, n)) - c(:, k)
         along = min(1.0_wp + longer, max(-longer, dot_product(p - c(:, k), u)/dot_product(u, u)))
         distance = min(distance, norm2(p - c(:, k) - along*u))
         inside = inside .and. cross(u, p - c(:, k)) > 0.0_wp
      end do
      if (inside) distance = 0.0_wp
   end function distance_to

   !> The corners of the convex hull of `p` (2, :), counterclockwise, by Jarvis's march; corners in line are left out.
   pure function hull(p) result(corners)
      real(wp), intent(in) :: p(:, :)
      real(wp), allocatable :: corners(:, :)
      integer :: order(size(p, 2)), start, last, next, i, n
      real(wp) :: extent, side

      if (size(p, 2) == 0) then
         corners = p
         return
      end if
      extent = maxval(maxval(p, dim=2) - minval(p, dim=2))
      start = minloc(p(2, :), dim=1, mask=p(1, :) <= minval(p(1, :)))
      n = 0
      last = start
      do
         n = n + 1
         order(n) = last
         next = 0
         do i = 1, size(p, 2)
            if (is_same_place(p(:, i), p(:, last), extent)) cycle
            if (next == 0) then
               next = i
               cycle
            end if
            ! The sine of the angle from the next place to this one.
            associate (u => p(:, next) - p(:, last), v => p(:, i) - p(:, last))
               side = cross(u/norm2(u), v/norm2(v))
               if (side < -same_place .or. (side <= same_place .and. norm2(v) > norm2(u))) next = i
            end associate
         end do
         if (next == 0 .or. n == size(p, 2)) exit
         if (is_same_place(p(:, next), p(:, start), extent)) exit
         last = next
      end do
      corners = p(:, order(:n))
   end function hull

   !> Whether `p` and `q` (2) are one place for the eye, where what is drawn has the given `extent`.
   pure logical function is_same_place(p, q, extent)
      real(wp), intent(in) :: p(2), q(2), extent

      is_same_place = all(abs(p - q) <= same_place*extent)
   end function is_same_place
end module outline
