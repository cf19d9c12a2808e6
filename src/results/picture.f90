!> The picture of a run as SVG, one set below the other: the mechanism at one instant, faint at some others, the paths
!> of the points that PRINT asks for, the centrodes that POLE asks for, flagged positions, names, and a scale.
module picture
   use kinds, only: wp, label_length
   use mechanism, only: pair_revolute, request_point, is_listed_alone
   use drawing, only: drawing_t, point_place
   use outline, only: is_same_place
   use picture_frames, only: clearest, faint_frames
   use canvas, only: canvas_t, make_canvas, to_pixels, put_name
   use picture_parts, only: put_body, put_outlines, put_flagged, put_guide, put_ground, put_block, put_joint, put_dot, &
      put_path, dots_of, color_of, corner_pixels, joint_point
   use picture_drives, only: put_drives
   use picture_centrodes, only: put_centrodes, put_centres
   use picture_page, only: place_canvas, put_set_head, put_flags, put_scale, flag_lines, fitted, width, line_height
   use svg, only: svg_head, put_end, put_group, put_words
   use text_output, only: output_t
   use phrases
   implicit none
   private
   public :: put_pictures, put_curves

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
      integer :: top, i, k

      top = 0
      do i = 1, size(drawings)
         associate (c => page(i), d => drawings(i))
            call make_canvas(o, drawings(i), c)
            c%best = 1
            c%faint = [(k, k=2, d%frames)]
            if (.not. d%assemblies) then
               c%best = clearest(d)
               c%faint = faint_frames(d, c%best)
            end if
            if (c%best > 0) c%s = d%frame(c%best)
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

   !> One set.
   subroutine put_set(c)
      type(canvas_t), intent(inout) :: c
      integer :: i

      call put_set_head(c, c%s%t)
      call put_group(c%o, 'class="faint"', '')
      do i = 1, size(c%faint)
         call put_outlines(c, c%d%frame(c%faint(i)))
      end do
      call put_end(c%o, 'g')
      call put_curves(c)
      call put_centrodes(c)
      do i = 1, size(c%d%flags)
         call put_flagged(c, c%d%flags(i)%last)
      end do
      call put_mechanism(c)
      call put_drives(c)
      call put_centres(c)
      if (max(size(c%m%links), size(c%m%points)) <= max_names) then
         call put_points(c)
         call put_links(c)
      end if
      call put_times(c)
      call put_flags(c)
      call put_scale(c)
      call put_end(c%o, 'g')
   end subroutine put_set

   !> The paths of the points.
   subroutine put_curves(c)
      type(canvas_t), intent(inout) :: c
      integer :: i

      do i = 1, size(c%d%curves)
         if (moves(c%d, i)) call put_path(c, c%d%curves(i))
      end do
   end subroutine put_curves

   !> Ground, links and pairs in full.
   subroutine put_mechanism(c)
      type(canvas_t), intent(inout) :: c
      integer, allocatable :: dots(:)
      integer :: i

      dots = dots_of(c%m)
      call put_ground(c)
      do i = 1, size(c%d%guides)
         call put_guide(c, c%d%guides(i))
      end do
      do i = 1, size(c%m%links)
         call put_body(c, i)
      end do
      do i = 1, size(c%d%guides)
         call put_block(c, c%d%guides(i))
      end do
      do i = 1, size(c%m%pairs)
         call put_joint(c, i, joint_point(c%m, c%s%known, i))
      end do
      do i = 1, size(dots)
         call put_dot(c, dots(i))
      end do
   end subroutine put_mechanism

   !> Whether curve number `i` is more than one place, and no curve before has the same places.
   pure logical function moves(d, i)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: i
      real(wp) :: extent
      integer :: k, j

      moves = .false.
      associate (curve => d%curves(i))
         if (size(curve%known) == 0) return
         extent = maxval(abs(curve%place))
         do k = 2, size(curve%known)
            moves = moves .or. (all(curve%known(k - 1:k) >= 0) .and. &
               .not. is_same_place(curve%place(:, k), curve%place(:, k - 1), extent))
         end do
         do j = 1, i - 1
            if (all(abs(d%curves(j)%place - curve%place) <= 1.0e-6_wp*extent) &
               .and. all(d%curves(j)%known == curve%known)) moves = .false.
         end do
      end associate
   end function moves

   !> At the foot: the instant that is drawn, and those, or the assemblies, that are faint.
   subroutine put_times(c)
      type(canvas_t), intent(in) :: c
      character(:), allocatable :: now, others
      real(wp) :: y
      integer :: i

      if (c%best == 0) return
      y = real(c%bottom - 16 - line_height*flag_lines(c%d), wp)
      now = 'T = '//fitted(c%d%frame(c%best)%t)//' '//trim(c%m%time_unit)
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
      integer :: i

      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground .or. .not. c%s%known(i)) cycle
         p = name_places(corner_pixels(c, c%d%outlines(i), c%s%place(:, i)))
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
