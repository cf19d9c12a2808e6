!> The picture of a run as SVG, one set below the other: the mechanism at one instant, faint at some others, the paths
!> of the points that PRINT asks for, the centrodes that POLE asks for, flagged positions, names, and a scale.
module picture
   use kinds, only: wp, label_length
   use mechanism, only: pair_revolute, request_point, is_listed_alone
   use drawing, only: drawing_t, point_place
   use outline, only: corners_at
   use picture_frames, only: candidates, clearest, faint_frames
   use shapes, only: shapes_t, shapes_of, color_of, link_color, pole_name
   use canvas, only: canvas_t, make_canvas, to_pixels, put_shape, put_path, add_box, put_name
   use picture_drives, only: put_drives
   use picture_page, only: place_canvas, paths_of, put_outlines, put_flagged, put_ring, put_set_head, put_flags, &
      put_scale, flag_lines, fitted, width, line_height, centre_radius
   use svg, only: svg_head, put_end, put_group, put_words
   use text_output, only: output_t
   use phrases
   implicit none
   private
   public :: put_pictures, put_centre

   !> A picture of more links or points than this has no names: they would cover it.
   integer, parameter :: max_names = 120
   !> Points closer than this, in pixels, have one name.
   real(wp), parameter :: together = 2.0_wp
   !> How far names stay from what is drawn, in pixels. The name of a link must not seem to be that of another.
   real(wp), parameter :: clear_of_point = 4.0_wp, clear_of_link = 8.0_wp
   !> Where along a bar its name may stand, in parts of its length.
   real(wp), parameter :: along(*) = [0.5_wp, 0.35_wp, 0.65_wp, 0.2_wp, 0.8_wp]

contains

   !> Writes the picture of the sets that the `drawings` have recorded.
   subroutine put_pictures(o, drawings)
      type(output_t), intent(inout), target :: o
      type(drawing_t), intent(in), target :: drawings(:)
      type(canvas_t) :: page(size(drawings))
      integer, allocatable :: list(:)
      integer :: top, best, i

      top = 0
      do i = 1, size(drawings)
         associate (c => page(i), d => drawings(i))
            call make_canvas(o, drawings(i), c)
            if (size(d%own) > 0) then
               list = candidates(d)
               best = clearest(d, list)
               c%faint = faint_frames(d, list, best)
               if (d%assemblies) best = d%own(1)
               if (d%assemblies) c%faint = d%own(2:)
               c%s = d%frame(best)
            end if
            if (d%every > 0) c%paths = paths_of(d)
            call place_canvas(c, top)
            top = c%bottom
         end associate
      end do
      call svg_head(o, width, max(1, top))
      do i = 1, size(page)
         call put_set(page(i))
      end do
      call put_end(o, 'svg')
   end subroutine put_pictures

   !> Draws one set.
   subroutine put_set(c)
      type(canvas_t), intent(inout) :: c
      type(shapes_t) :: list
      integer :: i

      call put_set_head(c, c%s%t)
      call put_group(c%o, 'class="faint"', '')
      do i = 1, size(c%faint)
         call put_outlines(c, c%d%frame(c%faint(i)), .false.)
      end do
      call put_end(c%o, 'g')
      do i = 1, size(c%paths)
         call put_path(c, c%paths(i))
      end do
      do i = 1, size(c%d%flags)
         call put_flagged(c, c%d%flags(i)%last)
      end do
      list = shapes_of(c%d, c%s%known, c%scale)
      do i = 1, list%count
         call put_shape(c, list%list(i))
      end do
      call put_drives(c)
      do i = 1, size(c%d%poles)
         call put_centre(c, i)
      end do
      if (max(size(c%m%links), size(c%m%points)) <= max_names) then
         call put_points(c)
         call put_links(c)
      end if
      if (size(c%d%own) > 0) call put_times(c)
      call put_flags(c)
      call put_scale(c)
      call put_end(c%o, 'g')
   end subroutine put_set

   !> Draws the ring of the instant centre of pole number `i`, with its name, if it is in the picture.
   subroutine put_centre(c, i)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: i
      real(wp) :: p(2)

      if (.not. c%s%has_centre(i)) return
      p = to_pixels(c, c%s%centre(:, i))
      if (any(p < c%low) .or. any(p > c%high)) return
      call put_ring(c, i, p)
      call add_box(c, p - centre_radius, p + centre_radius)
      call put_name(c, reshape(p, [2, 1]), clear_of_point, 'class="link" style="fill:' &
         //link_color(c%m, c%m%requests(c%d%poles(i))%subject)//'"', pole_name(c%m, c%d%poles(i)))
   end subroutine put_centre

   !> At the foot: the instant that is drawn, and those, or the assemblies, that are faint.
   subroutine put_times(c)
      type(canvas_t), intent(in) :: c
      character(:), allocatable :: now, others
      real(wp) :: y
      integer :: i

      y = real(c%bottom - 16 - line_height*flag_lines(c%d), wp)
      now = 'T = '//fitted(c%s%t)//' '//trim(c%m%time_unit)
      call put_words(c%o, [14.0_wp, y], 'start', 'class="time"', now)
      others = ''
      do i = 1, size(c%faint)
         if (i > 1) others = others//', '
         others = others//fitted(c%d%frame(c%faint(i))%t)
      end do
      others = phrase(say_faint, c%m%polish)//' '//others
      if (c%d%assemblies) others = phrase(say_faint_assemblies, c%m%polish)
      if (size(c%faint) > 0) &
         call put_words(c%o, [real(32 + 9*len(now), wp), y], 'start', 'class="between"', others)
   end subroutine put_times

   !> A name for each place of points that are known: of moving links all, of the ground those of joints, since the
   !> point of the ground from which a slide is counted need not lie on the guide. Of the points there one that PRINT
   !> asks for, of several the one with the shortest name, the first of these. The name of its link would stand there
   !> twice.
   subroutine put_points(c)
      type(canvas_t), intent(inout) :: c
      logical, dimension(size(c%m%points)) :: open, printed
      real(wp) :: p(2, size(c%m%points))
      integer :: i, best

      open = .not. c%m%links(c%m%points%link)%ground
      do i = 1, size(c%m%pairs)
         if (c%m%pairs(i)%kind == pair_revolute) open([c%m%pairs(i)%point_i, c%m%pairs(i)%point_j]) = .true.
      end do
      open = open .and. c%s%known(c%m%points%link)
      printed = .false.
      printed(pack(c%m%requests%subject, c%m%requests%kind == request_point &
         .and. .not. is_listed_alone(c%m%requests))) = .true.
      do i = 1, size(c%m%points)
         if (open(i)) p(:, i) = to_pixels(c, point_place(c%m, c%s, i))
      end do
      do while (any(open))
         best = minloc(len_trim(c%m%points%name) + merge(0, label_length + 1, printed), dim=1, mask=open)
         do i = 1, size(c%m%points)
            if (open(i)) open(i) = any(abs(p(:, i) - p(:, best)) > together)
         end do
         if (c%m%points(best)%name == c%m%links(c%m%points(best)%link)%name) cycle
         call put_name(c, p(:, best:best), clear_of_point, 'class="name"', trim(c%m%points(best)%name))
      end do
   end subroutine put_points

   !> The names of the moving links, each in its color: beside a bar, in or beside a polygon.
   subroutine put_links(c)
      type(canvas_t), intent(inout) :: c
      real(wp), allocatable :: p(:, :)
      integer :: i, k

      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground .or. .not. c%s%known(i)) cycle
         p = name_places(corners_at(c%d%outlines(i), c%s%place(:, i)))
         do k = 1, size(p, 2)
            p(:, k) = to_pixels(c, p(:, k))
         end do
         if (size(p) > 0) call put_name(c, p, clear_of_link, 'class="link" style="fill:'//color_of(i)//'"', &
            trim(c%m%links(i)%name))
      end do
   end subroutine put_links

   !> Where the name of a link with the `corners` (2, :) may stand (2, :): along its sides, or at its only place.
   pure function name_places(corners) result(p)
      real(wp), intent(in) :: corners(:, :)
      real(wp), allocatable :: p(:, :)
      integer :: i, k, n, places

      n = size(corners, 2)
      places = merge(size(along), 1, n > 1)
      allocate (p(2, places*n))
      do k = 1, n
         associate (side => corners(:, 1 + modulo(k, n)) - corners(:, k))
            do i = 1, places
               p(:, places*(k - 1) + i) = corners(:, k) + along(i)*side
            end do
         end associate
      end do
   end function name_places
end module picture
