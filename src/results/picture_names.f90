!> The names in a picture, each where it covers least of what is drawn.
module picture_names
   use kinds, only: wp, label_length
   use mechanism, only: mechanism_t, pair_revolute, request_point
   use drawing, only: point_place
   use canvas, only: canvas_t, to_pixels, find_clear_place
   use picture_parts, only: corner_pixels, color_of
   use svg, only: put_words
   implicit none
   private
   public :: put_names

   !> A picture of more links or points than this has no names: they would cover it.
   integer, parameter :: max_names = 120
   !> Points closer than this, in pixels, have one name.
   real(wp), parameter :: together = 2.0_wp
   !> How far names stay from what is drawn, in pixels. The name of a link must not seem to be that of another.
   real(wp), parameter :: clear_of_point = 4.0_wp, clear_of_link = 8.0_wp
   !> Where along a bar its name may stand, in parts of its length.
   real(wp), parameter :: along(*) = [0.5_wp, 0.35_wp, 0.65_wp, 0.2_wp, 0.8_wp]

contains

   !> The names of the points that are known, then those of the moving links.
   subroutine put_names(c)
      type(canvas_t), intent(inout) :: c

      if (size(c%m%links) > max_names .or. size(c%m%points) > max_names) return
      call put_points(c, is_used(c%m), is_printed(c%m))
      call put_links(c)
   end subroutine put_names

   !> (points) Whether a point may have its name in the picture: of moving links all, of the ground those of joints. The
   !> point of the ground from which a slide is counted need not lie on the guide.
   pure function is_used(m) result(used)
      type(mechanism_t), intent(in) :: m
      logical :: used(size(m%points))
      integer :: i

      used = .not. m%links(m%points%link)%ground
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_revolute) used([m%pairs(i)%point_i, m%pairs(i)%point_j]) = .true.
      end do
   end function is_used

   !> (points) Whether PRINT asks for it.
   pure function is_printed(m) result(printed)
      type(mechanism_t), intent(in) :: m
      logical :: printed(size(m%points))

      printed = .false.
      printed(pack(m%requests%subject, m%requests%kind == request_point)) = .true.
   end function is_printed

   !> A name for each place, first for those of points that are `printed` (points): of the points there a printed one,
   !> of several the one with the shortest name, the first of these. The name of its link would stand there twice.
   subroutine put_points(c, used, printed)
      type(canvas_t), intent(inout) :: c
      logical, intent(in) :: used(:), printed(:)
      logical :: open(size(c%m%points))
      real(wp) :: p(2, size(c%m%points)), start(2)
      integer :: i, best

      open = used .and. c%s%known(c%m%points%link)
      do i = 1, size(c%m%points)
         if (open(i)) p(:, i) = to_pixels(c, point_place(c%m, c%s, i))
      end do
      do while (any(open))
         best = minloc(len_trim(c%m%points%name) + merge(0, label_length + 1, printed), dim=1, mask=open)
         do i = 1, size(c%m%points)
            if (open(i)) open(i) = any(abs(p(:, i) - p(:, best)) > together)
         end do
         if (c%m%points(best)%name == c%m%links(c%m%points(best)%link)%name) cycle
         call find_clear_place(c, p(:, best:best), len_trim(c%m%points(best)%name), clear_of_point, start)
         call put_words(c%o, start, 'start', 'class="name"', trim(c%m%points(best)%name))
      end do
   end subroutine put_points

   !> The names of the moving links, each in its color: beside a bar, in or beside a polygon.
   subroutine put_links(c)
      type(canvas_t), intent(inout) :: c
      real(wp), allocatable :: p(:, :), q(:, :)
      real(wp) :: start(2)
      integer :: i, k, n

      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground .or. .not. c%s%known(i)) cycle
         p = corner_pixels(c, c%d%outlines(i), c%s%place(:, i))
         n = size(p, 2)
         if (n == 0) cycle
         if (n == 1) then
            q = p
         else
            allocate (q(2, size(along)*n))
            do k = 1, n
               associate (next => p(:, 1 + modulo(k, n)))
                  q(:, size(along)*(k - 1) + 1:size(along)*k) = &
                     spread(p(:, k), 2, size(along)) + spread(next - p(:, k), 2, size(along))*spread(along, 1, 2)
               end associate
            end do
         end if
         call find_clear_place(c, q, len_trim(c%m%links(i)%name), clear_of_link, start)
         call put_words(c%o, start, 'start', 'class="link" style="fill:'//color_of(i)//'"', trim(c%m%links(i)%name))
         deallocate (q)
      end do
   end subroutine put_links
end module picture_names
