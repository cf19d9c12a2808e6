!> The picture of a set as SVG: the mechanism at one instant, faint at some others, the paths of the points that PRINT
!> asks for, the centrodes that POLE asks for, the first flagged instant in words, names, and a scale. Which frames it
!> shows: the one in which the mechanism is read best, and a few others.
module picture
   use kinds, only: wp, label_length
   use mechanism, only: has_guide, request_point, is_listed_alone, drive_angle, drive_x, drive_y, drive_relangle, &
      drive_slide
   use planar, only: degree, direction, quarter_turn
   use drives, only: drive_motion
   use names, only: drive_name
   use drawing, only: drawing_t, snapshot_t, point_place, moved
   use shapes, only: element_t, shapes_of, color_of, link_color, pole_name, half_block
   use canvas, only: canvas_t, make_canvas, to_pixels, put_shape, put_outlines, put_name, put_foot, &
      add_lines, add_box, cover_of, line_height
   use svg, only: page_t, tie, put_end, put_group, put_window, put_circle, put_line, put_words, fitted
   use phrases
   implicit none
   private
   public :: put_picture, clearest, faint_frames

   !> A picture of more links or points than this has no names: they would cover it.
   integer, parameter :: max_names = 120
   !> Points closer than this, in pixels, have one name.
   real(wp), parameter :: together = 2.0_wp
   !> How far names stay from what is drawn, in pixels. The name of a link must not seem to be that of another.
   real(wp), parameter :: clear_of_point = 4.0_wp, clear_of_link = 8.0_wp
   !> Where along a bar its name may stand, in parts of its length.
   real(wp), parameter :: along(*) = [0.5_wp, 0.35_wp, 0.65_wp, 0.2_wp, 0.8_wp]
   !> The arrow of a drive is a line of so many pieces, the last ones its tip.
   integer, parameter :: pieces = 10, of_tip = 2
   !> Its pixels: length of a straight one, its distance aside, half the tip; radius of an arc.
   real(wp), parameter :: arrow_length = 45.0_wp, arrow_aside = half_block(2) + 10.0_wp, &
      tip_half = 4.5_wp, arc_radius = 24.0_wp
   !> The angle of an arc, and where it may begin, from the side of the link in its own sense (degrees).
   real(wp), parameter :: arc_angle = 130.0_wp, &
      arc_starts(*) = [25.0_wp, 200.0_wp, 45.0_wp, 180.0_wp, 65.0_wp, 160.0_wp, 85.0_wp, 140.0_wp, 105.0_wp, 120.0_wp]
   !> The weight of an arrow for names.
   real(wp), parameter :: arrow_weight = 3.0_wp

   !> The first frame is drawn in full that is so wide across, in parts of the widest. Reason: the first instant is what
   !> a reader expects, and rounding errors must not choose.
   real(wp), parameter :: wide = 0.7_wp
   !> A picture has this many faint positions at most and at least, and about this many faint links.
   integer, parameter :: max_faint = 4, min_faint = 2, faint_links = 15
   !> Positions that differ by less than this part of the mechanism would cover one another.
   real(wp), parameter :: alike = 0.03_wp

contains

   !> Draws the set that the drawing `d` has recorded, at the end of the `page`.
   subroutine put_picture(page, d)
      type(page_t), intent(inout), target :: page
      type(drawing_t), intent(in), target :: d
      type(canvas_t) :: c
      type(snapshot_t) :: s
      type(element_t), allocatable :: list(:)
      integer, allocatable :: faint(:)
      integer :: best, k

      s = d%now
      faint = [integer ::]
      if (size(d%own) > 0) then
         best = clearest(d, d%own)
         faint = faint_frames(d, d%own, best)
         s = d%frame(best)
      end if
      call make_canvas(page, d, s, faint, c)

      call put_group(c%o, 'class="faint"', '')
      do k = 1, size(faint)
         call put_outlines(c, d%frame(faint(k)))
      end do
      call put_end(c%o, 'g')
      list = shapes_of(d, c%scale)
      call put_window(c%o, c%low, c%high)
      do k = 1, size(list)
         call put_shape(c, list(k))
      end do
      call put_end(c%o, 'svg')
      call put_drives(c)
      do k = 1, size(d%poles)
         call put_centre(c, k)
      end do
      if (max(size(d%m%links), size(d%m%points)) <= max_names) then
         call put_points(c)
         call put_links(c)
      end if

      ! At the foot: the instant that is drawn in full.
      if (size(d%own) > 0) call put_words(c%o, [14.0_wp, real(c%bottom - 16 - line_height, wp)], 'start', &
         'class="time"', 'T = '//fitted(s%t)//' '//trim(d%m%time_unit))
      call put_foot(c)
   end subroutine put_picture

   !> Draws an arrow for each drive, in the sense in which it moves at the position that the canvas shows; at rest, in
   !> that of its acceleration.
   subroutine put_drives(c)
      type(canvas_t), intent(inout) :: c
      real(wp) :: f(0:2), sense
      integer :: i, k

      do i = 1, size(c%m%drives)
         associate (drive => c%m%drives(i), known => c%s%known)
            f = drive_motion(drive, c%s%t)
            sense = sign(1.0_wp, f(2))
            if (abs(f(1)) > 0.0_wp) sense = sign(1.0_wp, f(1))
            call put_group(c%o, 'class="drives"', trim(drive_name(c%m, drive)))
            select case (drive%kind)
            case (drive_angle)
               if (known(drive%subject)) call put_arc(0, drive%subject, sense)
            case (drive_relangle)
               if (known(drive%subject) .and. known(drive%second)) call put_arc(drive%subject, drive%second, sense)
            case (drive_x, drive_y)
               if (known(c%m%points(drive%subject)%link)) call put_arrow(drive%subject, &
                  sense*merge([1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], drive%kind == drive_x))
            case (drive_slide)
               k = findloc(c%d%guides%pair, drive%subject, dim=1)
               associate (g => c%d%guides(k))
                  if (known(g%carrier) .and. known(g%block)) call put_arrow(g%point, &
                     sense*real(g%sense, wp)*direction(c%s%place(3, g%carrier) + g%angle))
               end associate
            end select
            call put_end(c%o, 'g')
         end associate
      end do

   contains

      !> Draws an arc about a joint of `link` with an arrow: about its joint with `base`, 0 for the ground, otherwise
      !> about its first joint.
      subroutine put_arc(base, link, sense)
         integer, intent(in) :: base, link
         real(wp), intent(in) :: sense
         real(wp) :: center(2), start, e(2), lines(2, 0:pieces, size(arc_starts))
         integer :: i, k, ends(2), point

         point = 0
         do i = 1, size(c%m%pairs)
            ends = [c%m%pairs(i)%point_i, c%m%pairs(i)%point_j]
            k = findloc(c%m%points(ends)%link, link, dim=1)
            if (has_guide(c%m%pairs(i)%kind) .or. k == 0) cycle
            associate (other => c%m%points(ends(3 - k))%link)
               if (point == 0 .or. other == base .or. (base == 0 .and. c%m%links(other)%ground)) point = ends(k)
            end associate
         end do
         center = c%s%place(:2, link)
         if (point > 0) center = point_place(c%m, c%s, point)
         start = c%s%place(3, link)
         associate (corners => moved(c%d%outlines(link)%corner, c%s%place(:, link)))
            if (size(corners, 2) > 1) then
               e = sum(corners, dim=2)/real(size(corners, 2), wp) - center
               if (c%scale*norm2(e) > 1.0_wp) start = atan2(e(2), e(1))
            end if
         end associate
         do k = 1, size(arc_starts)
            do i = 0, pieces
               e = direction(start + sense*degree*(arc_starts(k) + arc_angle*real(i, wp)/real(pieces, wp)))
               lines(:, i, k) = to_pixels(c, center) + arc_radius*[e(1), -e(2)]
            end do
         end do
         call put_clearest(lines)
      end subroutine put_arc

      !> Draws a straight arrow in the `sense` (2), a unit vector of the plane, beside `point`: on either side.
      subroutine put_arrow(point, sense)
         integer, intent(in) :: point
         real(wp), intent(in) :: sense(2)
         real(wp), parameter :: asides(2) = arrow_aside*[1.0_wp, -1.0_wp]
         real(wp) :: e(2), start(2), lines(2, 0:pieces, size(asides))
         integer :: i, k

         e = sense*[1.0_wp, -1.0_wp]
         do k = 1, size(asides)
            start = to_pixels(c, point_place(c%m, c%s, point)) - 0.5_wp*arrow_length*e &
               + merge(asides(k), -asides(k), e(1) < 0.0_wp)*quarter_turn(e)
            do i = 0, pieces
               lines(:, i, k) = start + arrow_length*real(i, wp)/real(pieces, wp)*e
            end do
         end do
         call put_clearest(lines)
      end subroutine put_arrow

      !> Draws the first of the `lines` (2, 0:pieces, :), in pixels, that cover least, as an arrow.
      subroutine put_clearest(lines)
         real(wp), intent(in) :: lines(:, 0:, :)
         real(wp) :: cover, least, e(2)
         integer :: k, best

         best = 1
         least = huge(least)
         do k = 1, size(lines, 3)
            cover = cover_of(c, lines(:, :, k))
            if (cover >= least - tie) cycle
            least = cover
            best = k
         end do
         associate (line => lines(:, :, best), tail => lines(:, pieces - of_tip, best), tip => lines(:, pieces, best))
            e = tip_half*quarter_turn(tip - tail)/norm2(tip - tail)
            call put_line(c%o, 'polyline', line(:, :1 + pieces - of_tip), 'class="drive"')
            call put_line(c%o, 'polygon', reshape([tip, tail + e, tail - e], [2, 3]), 'class="tip"')
            call add_lines(c, line, arrow_weight)
         end associate
      end subroutine put_clearest
   end subroutine put_drives

   !> Draws the ring of the instant centre of pole number `i`, with its name, if it is in the picture.
   subroutine put_centre(c, i)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: i
      real(wp), parameter :: radius = 4.0_wp
      character(:), allocatable :: color
      real(wp) :: p(2)

      if (.not. c%s%has_centre(i)) return
      p = to_pixels(c, c%s%centre(:, i))
      if (any(p < c%low) .or. any(p > c%high)) return
      color = link_color(c%m, c%m%requests(c%d%poles(i))%subject)
      call put_circle(c%o, p, radius, 'class="centre" style="stroke:'//color//'"')
      call put_circle(c%o, p, 1.0_wp, 'class="point"')
      call add_box(c, p - radius, p + radius)
      call put_name(c, reshape(p, [2, 1]), clear_of_point, 'class="link" style="fill:'//color//'"', &
         pole_name(c%m, c%d%poles(i)))
   end subroutine put_centre

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
         if (.not. has_guide(c%m%pairs(i)%kind)) open([c%m%pairs(i)%point_i, c%m%pairs(i)%point_j]) = .true.
      end do
      open = open .and. .not. c%m%links(c%m%points%link)%hidden
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

   !> The names of the moving links, each in its color: beside a bar, in or beside a polygon. They may stand along the
   !> sides of the link, or at its only place.
   subroutine put_links(c)
      type(canvas_t), intent(inout) :: c
      real(wp), allocatable :: corners(:, :), p(:, :)
      integer :: i, j, k, n, places

      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground .or. c%m%links(i)%hidden .or. .not. c%s%known(i)) cycle
         corners = moved(c%d%outlines(i)%corner, c%s%place(:, i))
         n = size(corners, 2)
         if (n == 0) cycle
         places = merge(size(along), 1, n > 1)
         allocate (p(2, places*n))
         do k = 1, n
            associate (side => corners(:, 1 + modulo(k, n)) - corners(:, k))
               do j = 1, places
                  p(:, places*(k - 1) + j) = to_pixels(c, corners(:, k) + along(j)*side)
               end do
            end associate
         end do
         call put_name(c, p, clear_of_link, 'class="link" style="fill:'//color_of(i)//'"', trim(c%m%links(i)%name))
         deallocate (p)
      end do
   end subroutine put_links

   !> Returns the one of the frames `list` that is drawn in full: of those of which most links are known the first that
   !> is `wide` across. Reason: links that are collinear at the first instant are read better later.
   integer function clearest(d, list) result(best)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: list(:)
      real(wp) :: across(size(list))
      logical :: most(size(list))
      integer :: i, known(size(list))

      known = [(count(d%frame(list(i))%known), i=1, size(list))]
      most = known == maxval(known)
      across = [(minval(sides_of(d, d%frame(list(i)))), i=1, size(list))]
      best = list(findloc(most .and. across >= wide*maxval(across, mask=most), .true., dim=1))
   end function clearest

   !> The sides (2) of the box that the known moving links cover at the position `s`.
   pure function sides_of(d, s) result(sides)
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      real(wp) :: sides(2), low(2), high(2)
      integer :: i

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do i = 1, size(d%m%links)
         if (d%m%links(i)%ground .or. .not. s%known(i)) cycle
         associate (p => moved(d%outlines(i)%corner, s%place(:, i)))
            low = min(low, minval(p, dim=2))
            high = max(high, maxval(p, dim=2))
         end associate
      end do
      sides = 0.0_wp
      if (all(high >= low)) sides = high - low
   end function sides_of

   !> Chooses those of the frames `own` that are faint beside frame `best`: evenly spaced, without those that are
   !> like it or like one another.
   function faint_frames(d, own, best) result(list)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: own(:), best
      integer, allocatable :: list(:)
      integer :: i, j, k, n

      allocate (list(0))
      n = max(min_faint, min(max_faint, faint_links/max(1, count(.not. (d%m%links%ground .or. d%m%links%hidden)))))
      do i = 0, n
         k = own(1 + i*(size(own) - 1)/n)
         if (distance(d, k, best) < alike) cycle
         if (any([(distance(d, k, list(j)) < alike, j=1, size(list))])) cycle
         list = [list, k]
      end do
   end function faint_frames

   !> The largest distance of a corner between frames `i` and `j`, in parts of the mechanism; 1 if one of them lacks a
   !> link.
   real(wp) function distance(d, i, j)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: i, j
      real(wp) :: extent
      integer :: k

      distance = 1.0_wp
      if (any(d%frame(i)%known .neqv. d%frame(j)%known)) return
      distance = 0.0_wp
      extent = maxval(sides_of(d, d%frame(i)))
      do k = 1, size(d%m%links)
         if (d%m%links(k)%ground .or. .not. d%frame(i)%known(k)) cycle
         associate (p => moved(d%outlines(k)%corner, d%frame(i)%place(:, k)), &
            q => moved(d%outlines(k)%corner, d%frame(j)%place(:, k)))
            if (size(p) > 0) distance = max(distance, maxval(abs(p - q)))
         end associate
      end do
      if (distance > 0.0_wp) distance = distance/max(extent, distance)
   end function distance
end module picture
