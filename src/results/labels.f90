!> The names of points and of moving links in a picture, each at the place at which it covers least. The canvas shows
!> the position.
module labels
   use kinds, only: wp, label_length
   use mechanism, only: has_guide, has_path
   use drawing, only: point_place, moved
   use shapes, only: color_of
   use canvas, only: canvas_t, label_t, to_pixels, place_name
   implicit none
   private
   public :: labels_of, clear_of_point

   !> A picture of more links or points than this has no names: they would cover it.
   integer, parameter :: max_named = 120
   !> Points closer than this, in pixels, have one name.
   real(wp), parameter :: same_name_distance = 2.0_wp
   !> Names stay so far from all other things, in pixels. The name of a link must not seem to belong to another.
   real(wp), parameter :: clear_of_point = 4.0_wp, clear_of_link = 8.0_wp
   !> The places along a bar at which its name may stand, in parts of its length.
   real(wp), parameter :: name_places(*) = [0.5_wp, 0.35_wp, 0.65_wp, 0.2_wp, 0.8_wp]

contains

   !> Finds the names of points and links in a picture with their places; no names if there are too many.
   subroutine labels_of(canvas, labels)
      type(canvas_t), intent(inout) :: canvas   !< with all shapes; gets the names
      type(label_t), allocatable, intent(out) :: labels(:)   !< (any number)
      integer :: used

      used = 0
      allocate (labels(size(canvas%mechanism%points) + size(canvas%mechanism%links)))
      if (max(size(canvas%mechanism%links), size(canvas%mechanism%points)) <= max_named) then
         call name_points(canvas, labels, used)
         call name_links(canvas, labels, used)
      end if
      labels = labels(:used)
   end subroutine labels_of

   !> Finds a name for each place of points that are known. All points of moving links count; of the ground only joints,
   !> since the point from which a slide is counted need not be on the guide. If several points are at one place, the
   !> name is of a point that PRINT asks for, then the shortest, then the first. A point with the name of its link has
   !> none, since the link has it.
   subroutine name_points(canvas, labels, used)
      type(canvas_t), intent(inout) :: canvas   !< with all shapes; gets the names
      type(label_t), intent(inout) :: labels(:)   !< (any number) with room for further ones
      integer, intent(inout) :: used         !< number of labels that are found
      logical, dimension(size(canvas%mechanism%points)) :: free, printed   ! free: without a name yet
      real(wp) :: p(2, size(canvas%mechanism%points))
      integer :: i, best

      free = .not. canvas%mechanism%links(canvas%mechanism%points%link)%ground
      do i = 1, size(canvas%mechanism%pairs)
         if (.not. has_guide(canvas%mechanism%pairs(i)%kind)) &
            free([canvas%mechanism%pairs(i)%point_i, canvas%mechanism%pairs(i)%point_j]) = .true.
      end do
      free = free .and. .not. canvas%mechanism%links(canvas%mechanism%points%link)%hidden
      free = free .and. canvas%snapshot%known(canvas%mechanism%points%link)
      printed = .false.
      printed(pack(canvas%mechanism%requests%subject, has_path(canvas%mechanism%requests))) = .true.
      do i = 1, size(canvas%mechanism%points)
         if (free(i)) p(:, i) = to_pixels(canvas, point_place(canvas%mechanism, canvas%snapshot, i))
      end do

      do while (any(free))
         best = minloc(len_trim(canvas%mechanism%points%name) + merge(0, label_length + 1, printed), dim=1, mask=free)
         do i = 1, size(canvas%mechanism%points)
            if (free(i)) free(i) = any(abs(p(:, i) - p(:, best)) > same_name_distance)
         end do
         if (canvas%mechanism%points(best)%name == &
            canvas%mechanism%links(canvas%mechanism%points(best)%link)%name) cycle
         used = used + 1
         labels(used)%attributes = 'class="name"'
         labels(used)%link = canvas%mechanism%points(best)%link
         call place_name(canvas, p(:, best:best), clear_of_point, &
            trim(canvas%mechanism%points(best)%name), labels(used))
      end do
   end subroutine name_points

   !> Finds the names of the moving links, each in its color: near a bar, in or near a polygon. They may stand along the
   !> sides of the link, or at its only place.
   subroutine name_links(canvas, labels, used)
      type(canvas_t), intent(inout) :: canvas   !< with all shapes; gets the names
      type(label_t), intent(inout) :: labels(:)   !< (any number) with room for further ones
      integer, intent(inout) :: used         !< number of labels that are found
      real(wp), allocatable :: corners(:, :), p(:, :)
      integer :: i, j, k, n, places

      do i = 1, size(canvas%mechanism%links)
         if (canvas%mechanism%links(i)%ground .or. canvas%mechanism%links(i)%hidden .or. &
            .not. canvas%snapshot%known(i)) cycle
         corners = moved(canvas%drawing%outlines(i)%corner, canvas%snapshot%place(:, i))
         n = size(corners, 2)
         if (n == 0) cycle
         places = merge(size(name_places), 1, n > 1)
         allocate (p(2, places*n))
         do k = 1, n
            associate (side => corners(:, 1 + modulo(k, n)) - corners(:, k))
               do j = 1, places
                  p(:, places*(k - 1) + j) = to_pixels(canvas, corners(:, k) + name_places(j)*side)
               end do
            end associate
         end do

         used = used + 1
         labels(used)%attributes = 'class="link" style="fill:'//color_of(i)//'"'
         labels(used)%link = i
         call place_name(canvas, p, clear_of_link, trim(canvas%mechanism%links(i)%name), labels(used))
         deallocate (p)
      end do
   end subroutine name_links
end module labels
