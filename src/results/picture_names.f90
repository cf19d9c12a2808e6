!> The names in a picture, each where it covers least of what is drawn.
module picture_names
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_revolute
   use drawing, only: snapshot_t, point_place
   use canvas, only: canvas_t, to_pixels, find_clear_place
   use picture_parts, only: corner_pixels, color_of
   use svg, only: put_words
   use text_output, only: output_t
   implicit none
   private
   public :: put_names

   !> A picture of more links or points than this has no names: they would cover it.
   integer, parameter :: max_names = 120
   !> Points closer than this, in pixels, have one name.
   real(wp), parameter :: together = 2.0_wp
   !> Where along a bar its name may stand, in parts of its length.
   real(wp), parameter :: along(*) = [0.5_wp, 0.35_wp, 0.65_wp, 0.2_wp, 0.8_wp]

contains

   !> The names of the points that are known at `s`, then those of the moving links.
   subroutine put_names(o, c, m, s)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(snapshot_t), intent(in) :: s

      if (size(m%links) > max_names .or. size(m%points) > max_names) return
      call put_points(o, c, m, s, is_used(m))
      call put_links(o, c, m, s)
   end subroutine put_names

   !> (points) Whether a point has its name in the picture: of moving links all, of the ground those of joints. The
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

   !> A name for each place: of the points there the one with the shortest name, the first of these.
   subroutine put_points(o, c, m, s, used)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(snapshot_t), intent(in) :: s
      logical, intent(in) :: used(:)
      logical :: open(size(m%points))
      real(wp) :: p(2, size(m%points)), start(2)
      integer :: i, k, best

      open = used .and. s%known(m%points%link)
      do i = 1, size(m%points)
         if (open(i)) p(:, i) = to_pixels(c, point_place(m, s, i))
      end do
      do i = 1, size(m%points)
         if (.not. open(i)) cycle
         best = i
         do k = i + 1, size(m%points)
            if (.not. open(k)) cycle
            if (any(abs(p(:, k) - p(:, i)) > together)) cycle
            open(k) = .false.
            if (len_trim(m%points(k)%name) < len_trim(m%points(best)%name)) best = k
         end do
         call find_clear_place(c, p(:, i:i), len_trim(m%points(best)%name), start)
         call put_words(o, start, 'start', 'class="name"', trim(m%points(best)%name))
      end do
   end subroutine put_points

   !> The names of the moving links, each in its color: beside a bar, in or beside a polygon.
   subroutine put_links(o, c, m, s)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(snapshot_t), intent(in) :: s
      real(wp), allocatable :: p(:, :), q(:, :)
      real(wp) :: start(2)
      integer :: i, k, n

      do i = 1, size(m%links)
         if (m%links(i)%ground .or. .not. s%known(i)) cycle
         p = corner_pixels(c, m, s, i)
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
         call find_clear_place(c, q, len_trim(m%links(i)%name), start)
         call put_words(o, start, 'start', 'class="link" style="fill:'//color_of(i)//'"', trim(m%links(i)%name))
         deallocate (q)
      end do
   end subroutine put_links
end module picture_names
