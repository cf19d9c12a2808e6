!> Instant centres and their centrodes in a picture: each centrode lies in its link as that is drawn, so that the two
!> touch at the instant centre. They may run to infinity, and are cut where the picture ends.
module picture_centrodes
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use planar, only: point_of
   use drawing, only: centrode_t
   use canvas, only: canvas_t, to_pixels, add_line, add_box, put_name, find_inside
   use picture_parts, only: color_of
   use svg, only: put_group, put_end, put_circle, put_line, attribute
   implicit none
   private
   public :: put_centrodes, put_centres, put_ring, pair_name

   !> The ring of an instant centre, in pixels, and how far its name stays from what is drawn.
   real(wp), parameter :: centre_radius = 4.0_wp, clear = 4.0_wp
   !> The weight of a centrode against that of a bar, for names.
   real(wp), parameter :: centrode_weight = 0.4_wp
   !> A place so near to the first one, in pixels, is the same.
   real(wp), parameter :: come_back = 0.5_wp
   !> The color of what belongs to the ground.
   character(*), parameter :: ground_color = '#222'

contains

   !> The centrodes of all poles; those that lie in link number `own` alone, if it is given.
   subroutine put_centrodes(c, own)
      type(canvas_t), intent(inout) :: c
      integer, intent(in), optional :: own
      integer :: i, side

      do i = 1, size(c%d%centrodes)
         do side = 1, 2
            associate (link => c%d%centrodes(i)%link(side))
               if (present(own)) then
                  if (link /= own) cycle
               end if
               if (c%s%known(link)) call put_centrode(c, c%d%centrodes(i), side)
            end associate
         end do
      end do
   end subroutine put_centrodes

   !> A ring and the names of both links at each instant centre, where the picture has room for it.
   subroutine put_centres(c)
      type(canvas_t), intent(inout) :: c
      real(wp) :: p(2, 1)
      integer :: i

      do i = 1, size(c%d%centrodes)
         if (.not. c%s%has_centre(i)) cycle
         p(:, 1) = to_pixels(c, c%s%centre(:, i))
         if (any(p(:, 1) < c%low) .or. any(p(:, 1) > c%high)) cycle
         call put_ring(c, i, p(:, 1))
         call add_box(c, p(:, 1) - centre_radius, p(:, 1) + centre_radius)
         call put_name(c, p, clear, 'class="link" style="fill:'//link_color(c%m, c%d%centrodes(i)%link(2))//'"', &
            pair_name(c%m, c%d%centrodes(i)))
      end do
   end subroutine put_centres

   !> The ring of the instant centre of pole number `i` at the pixel `p` (2).
   subroutine put_ring(c, i, p)
      type(canvas_t), intent(in) :: c
      integer, intent(in) :: i
      real(wp), intent(in) :: p(2)

      call put_circle(c%o, p, centre_radius, 'class="centre" style="stroke:' &
         //link_color(c%m, c%d%centrodes(i)%link(2))//'"')
      call put_circle(c%o, p, 1.0_wp, 'class="point"')
   end subroutine put_ring

   !> The names of both links.
   pure function pair_name(m, centrode) result(name)
      type(mechanism_t), intent(in) :: m
      type(centrode_t), intent(in) :: centrode
      character(:), allocatable :: name

      name = trim(m%links(centrode%link(1))%name)//'-'//trim(m%links(centrode%link(2))%name)
   end function pair_name

   !> The color of what belongs to link number `i`.
   pure function link_color(m, i) result(color)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      character(:), allocatable :: color

      color = ground_color
      if (.not. m%links(i)%ground) color = color_of(i)
   end function link_color

   !> The centrode in link I or J (`side` 1 or 2): lines from place to place, as far as they are in
   !> the picture. Where the sense of the relative turn changes, the centre has passed through infinity.
   subroutine put_centrode(c, centrode, side)
      type(canvas_t), intent(inout) :: c
      type(centrode_t), intent(in) :: centrode
      integer, intent(in) :: side
      character(:), allocatable :: name
      real(wp) :: line(2, size(centrode%side) + 1), p(2, size(centrode%side)), from, to
      integer :: k, n, last

      name = pair_name(c%m, centrode)
      call put_group(c%o, attribute('data-centrode', name), name)
      do k = 1, size(centrode%side)
         p(:, k) = to_pixels(c, point_of(c%s%place(:, centrode%link(side)), centrode%place(:, k, side)))
      end do
      last = last_of(p, centrode%side)
      n = 0
      do k = 1, last - 1
         from = 0.0_wp
         to = -1.0_wp
         if (centrode%side(k)*centrode%side(k + 1) == 1) &
            call find_inside(p(:, k), p(:, k + 1), c%low, c%high, from, to)
         if (to > from) then
            if (n == 0) line(:, 1) = p(:, k) + from*(p(:, k + 1) - p(:, k))
            n = max(n, 1) + 1
            line(:, n) = p(:, k) + to*(p(:, k + 1) - p(:, k))
            call add_line(c, line(:, n - 1), line(:, n), centrode_weight)
         end if
         if (n > 0 .and. (to < 1.0_wp .or. k == last - 1)) then
            call put_line(c%o, 'polyline', line(:, :n), &
               'class="centrode" style="stroke:'//link_color(c%m, centrode%link(side))//'"')
            n = 0
         end if
      end do
      call put_end(c%o, 'g')
   end subroutine put_centrode

   !> The number of the last of the places `p` (2, :), in pixels, before the centrode comes back to its first place and
   !> goes on as it began: drawn twice, dashes would fill one another's gaps. `side` (places): as in `centrode_t`.
   pure integer function last_of(p, side) result(last)
      real(wp), intent(in) :: p(:, :)
      integer, intent(in) :: side(:)
      real(wp) :: d(2), e(2)

      do last = 3, size(side) - 1
         if (any(side([1, 2, last, last + 1]) == 0) .or. norm2(p(:, last) - p(:, 1)) > come_back) cycle
         d = p(:, 2) - p(:, 1)
         e = p(:, last + 1) - p(:, last)
         if (dot_product(d, e) > 0.9_wp*norm2(d)*norm2(e)) return
      end do
      last = size(side)
   end function last_of
end module picture_centrodes
