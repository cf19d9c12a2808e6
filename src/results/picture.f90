!> The picture of a set as SVG. It has the mechanism at one instant, faint at some others, names and a scale; the paths
!> of the points that PRINT asks for, the centrodes that POLE asks for, and the first flagged instant in words. It
!> shows the frame in which the mechanism is read best, and a few others.
module picture
   use kinds, only: wp
   use mechanism, only: has_guide, drive_angle, drive_x, drive_y, drive_relangle, drive_slide, mechanism_t
   use plane_vectors, only: degree, direction, quarter_turn
   use drives, only: drive_motion
   use names, only: drive_name
   use drawing, only: drawing_t, snapshot_t, point_place, moved
   use shapes, only: element_t, shapes_of, link_color, pole_name, half_block
   use canvas, only: canvas_t, label_t, make_canvas, to_pixels, draw_shape, record_shape, draw_outlines, place_name, &
      draw_label, draw_foot, draw_bar, caption, add_lines, add_box, cover_of, line_height
   use labels, only: labels_of, clear_of_point
   use svg, only: page_t, tie, close_group, open_group, draw_window, draw_circle, draw_line, draw_words, attribute, &
      fitted
   use number_format, only: full
   use phrases
   implicit none
   private
   public :: draw_picture

   !> The arrow of a drive is a line of so many pieces; the last ones are its tip.
   integer, parameter :: arrow_pieces = 10, tip_pieces = 2
   !> Pixels of a straight arrow: its length, its distance from the point; radius of an arc.
   real(wp), parameter :: arrow_length = 45.0_wp, arrow_aside = half_block(2) + 10.0_wp, arc_radius = 24.0_wp
   !> The angle of an arc, and the angles at which it may begin, from the side of the link in its own sense (degrees).
   real(wp), parameter :: arc_angle = 130.0_wp, &
      arc_starts(*) = [25.0_wp, 200.0_wp, 45.0_wp, 180.0_wp, 65.0_wp, 160.0_wp, 85.0_wp, 140.0_wp, 105.0_wp, 120.0_wp]
   !> The longest arrow of a velocity, and the length of a tip, which is as wide (pixels).
   real(wp), parameter :: longest_velocity = 55.0_wp, tip_length = 9.0_wp
   !> The weight of an arrow for names.
   real(wp), parameter :: arrow_weight = 3.0_wp

   !> The first frame that is so wide across, in parts of the widest, is drawn in full. Reason: a reader expects the
   !> first instant, and rounding errors must not choose.
   real(wp), parameter :: clear_width = 0.7_wp
   !> The largest and the least number of faint positions, and the approximate number of faint links.
   integer, parameter :: max_faint = 4, min_faint = 2, faint_links = 15
   !> Positions that differ by less than this part of the mechanism would cover one another.
   real(wp), parameter :: same_position_part = 0.03_wp

contains

   !> Draws a set at the end of a page; without a frame its last known position.
   subroutine draw_picture(page, drawing)
      type(page_t), intent(inout), target :: page   !< gets the picture
      type(drawing_t), intent(in), target :: drawing   !< the record of the set
      type(canvas_t) :: c
      type(snapshot_t) :: s
      type(element_t), allocatable :: list(:)
      type(label_t), allocatable :: labels(:)
      integer, allocatable :: faint(:)
      integer :: best, k

      s = drawing%now
      faint = [integer ::]
      if (size(drawing%own) > 0) then
         best = clearest(drawing, drawing%own)
         faint = faint_frames(drawing, drawing%own, best)
         s = drawing%frame(best)
      end if
      call make_canvas(page, drawing, s, faint, c)

      list = shapes_of(drawing, c%scale)
      call draw_window(c%output, c%low, c%high)
      call open_group(c%output, 'class="faint"', '')
      do k = 1, size(faint)
         call draw_outlines(c, list, drawing%frame(faint(k)))
      end do
      call close_group(c%output, 'g')
      do k = 1, size(list)
         call draw_shape(c, list(k))
         call record_shape(c, list(k))
      end do
      call close_group(c%output, 'svg')

      call draw_drives(c)
      if (drawing%has_arrows) call draw_velocities(c)
      do k = 1, size(drawing%poles)
         call draw_centre(c, page, k)
      end do
      call labels_of(c, labels)
      do k = 1, size(labels)
         call draw_label(c, labels(k))
      end do

      ! At the foot: the instant that is drawn in full.
      if (size(drawing%own) > 0) call draw_words(c%output, [14.0_wp, c%high(2) + 28.0_wp], 'start', 'class="time"', &
         caption(c, s%t))
      call draw_foot(c)
   end subroutine draw_picture

   !> Draws an arrow for each drive, in the sense in which it moves at the position that the canvas shows; at rest, in
   !> the sense of its acceleration.
   subroutine draw_drives(canvas)
      type(canvas_t), intent(inout) :: canvas   !< of the set; gets the arrows
      real(wp) :: f(0:2), sense
      integer :: i, k

      do i = 1, size(canvas%mechanism%drives)
         associate (drive => canvas%mechanism%drives(i), known => canvas%snapshot%known)
            f = drive_motion(drive, canvas%snapshot%t)
            sense = sign(1.0_wp, f(2))
            if (abs(f(1)) > 0.0_wp) sense = sign(1.0_wp, f(1))
            call open_group(canvas%output, 'class="drives"', trim(drive_name(canvas%mechanism, drive)))

            select case (drive%kind)
            case (drive_angle)
               if (known(drive%subject)) call draw_arc(0, drive%subject, sense)
            case (drive_relangle)
               if (known(drive%subject) .and. known(drive%second)) call draw_arc(drive%subject, drive%second, sense)
            case (drive_x, drive_y)
               if (known(canvas%mechanism%points(drive%subject)%link)) call draw_arrow(drive%subject, &
                  sense*merge([1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], drive%kind == drive_x))
            case (drive_slide)
               k = findloc(canvas%drawing%guides%pair, drive%subject, dim=1)
               associate (g => canvas%drawing%guides(k))
                  if (known(g%carrier) .and. known(g%block)) call draw_arrow(g%point, &
                     sense*real(g%sense, wp)*direction(canvas%snapshot%place(3, g%carrier) + g%angle))
               end associate
            end select
            call close_group(canvas%output, 'g')
         end associate
      end do

   contains

      !> Draws an arc with an arrow about the joint of two links; without such a joint, about the first joint of the
      !> second link.
      subroutine draw_arc(base, link, sense)
         integer, intent(in) :: base         !< number of the first link; 0: the ground
         integer, intent(in) :: link         !< number of the second link, which turns
         real(wp), intent(in) :: sense       !< 1: counterclockwise; -1: clockwise
         real(wp) :: center(2), start, e(2), lines(2, 0:arrow_pieces, size(arc_starts))
         integer :: i, k, ends(2), point

         point = 0
         do i = 1, size(canvas%mechanism%pairs)
            ends = [canvas%mechanism%pairs(i)%point_i, canvas%mechanism%pairs(i)%point_j]
            k = findloc(canvas%mechanism%points(ends)%link, link, dim=1)
            if (has_guide(canvas%mechanism%pairs(i)%kind) .or. k == 0) cycle
            associate (other => canvas%mechanism%points(ends(3 - k))%link)
               if (point == 0 .or. other == base .or. &
                  (base == 0 .and. canvas%mechanism%links(other)%ground)) point = ends(k)
            end associate
         end do
         center = canvas%snapshot%place(:2, link)
         if (point > 0) center = point_place(canvas%mechanism, canvas%snapshot, point)

         start = canvas%snapshot%place(3, link)
         associate (corners => moved(canvas%drawing%outlines(link)%corner, canvas%snapshot%place(:, link)))
            if (size(corners, 2) > 1) then
               e = sum(corners, dim=2)/real(size(corners, 2), wp) - center
               if (canvas%scale*norm2(e) > 1.0_wp) start = atan2(e(2), e(1))
            end if
         end associate
         do k = 1, size(arc_starts)
            do i = 0, arrow_pieces
               e = direction(start + sense*degree*(arc_starts(k) + arc_angle*real(i, wp)/real(arrow_pieces, wp)))
               lines(:, i, k) = to_pixels(canvas, center) + arc_radius*[e(1), -e(2)]
            end do
         end do
         call draw_clearest(lines)
      end subroutine draw_arc

      !> Draws a straight arrow next to a point, on the clearer of both sides.
      subroutine draw_arrow(point, sense)
         integer, intent(in) :: point        !< number of the point
         real(wp), intent(in) :: sense(2)    !< unit vector of the plane
         real(wp), parameter :: asides(2) = arrow_aside*[1.0_wp, -1.0_wp]
         real(wp) :: e(2), start(2), lines(2, 0:arrow_pieces, size(asides))
         integer :: i, k

         e = sense*[1.0_wp, -1.0_wp]
         do k = 1, size(asides)
            start = to_pixels(canvas, point_place(canvas%mechanism, canvas%snapshot, point)) - 0.5_wp*arrow_length*e &
               + merge(asides(k), -asides(k), e(1) < 0.0_wp)*quarter_turn(e)
            do i = 0, arrow_pieces
               lines(:, i, k) = start + arrow_length*real(i, wp)/real(arrow_pieces, wp)*e
            end do
         end do
         call draw_clearest(lines)
      end subroutine draw_arrow

      !> Draws the line that covers least, the first of several, as an arrow.
      subroutine draw_clearest(lines)
         real(wp), intent(in) :: lines(:, 0:, :)   !< (2, 0:pieces, lines) pixels
         real(wp) :: cover, least
         integer :: k, best

         best = 1
         least = huge(least)
         do k = 1, size(lines, 3)
            cover = cover_of(canvas, lines(:, :, k))
            if (cover >= least - tie) cycle
            least = cover
            best = k
         end do
         call draw_arrow_line(canvas, &
            reshape([lines(:, :arrow_pieces - tip_pieces, best), lines(:, arrow_pieces, best)], &
            [2, 2 + arrow_pieces - tip_pieces]), 'class="drive"', 'class="tip"')
      end subroutine draw_clearest
   end subroutine draw_drives

   !> Draws an arrow along a line, and records its line so that names keep clear of it.
   subroutine draw_arrow_line(canvas, line, of_line, of_tip)
      type(canvas_t), intent(inout) :: canvas   !< of the set; gets the arrow
      real(wp), intent(in) :: line(:, :)     !< (2, points) pixels; the last piece is the tip of the arrow
      character(*), intent(in) :: of_line, of_tip   !< attributes of the line and of the tip, as SVG
      real(wp) :: e(2)

      associate (n => size(line, 2), tip => line(:, size(line, 2)), tail => line(:, size(line, 2) - 1))
         e = 0.5_wp*tip_length*quarter_turn(tip - tail)/norm2(tip - tail)
         call draw_line(canvas%output, 'polyline', line(:, :n - 1), of_line)
         call draw_line(canvas%output, 'polygon', reshape([tip, tail + e, tail - e], [2, 3]), of_tip)
      end associate
      call add_lines(canvas, line, arrow_weight)
   end subroutine draw_arrow_line

   !> Draws the ring of an instant centre, with its name; if the centre is outside the picture, writes a line with its
   !> place at the foot of the page. An instant centre at infinity has none.
   subroutine draw_centre(canvas, page, i)
      type(canvas_t), intent(inout) :: canvas   !< of the set; gets the ring
      type(page_t), intent(inout) :: page    !< with the canvas at its end
      integer, intent(in) :: i               !< number of the pole among those of the drawing
      real(wp), parameter :: radius = 4.0_wp   !< pixels
      type(label_t) :: label
      character(:), allocatable :: color, name
      real(wp) :: p(2)

      if (.not. canvas%snapshot%has_centre(i)) return
      p = to_pixels(canvas, canvas%snapshot%centre(:, i))
      color = 'style="fill:'//link_color(canvas%mechanism, &
         canvas%mechanism%requests(canvas%drawing%poles(i))%subject)//'"'
      name = pole_name(canvas%mechanism, canvas%drawing%poles(i))

      if (any(p < canvas%low) .or. any(p > canvas%high)) then
         associate (at => canvas%snapshot%centre(:, i) + canvas%drawing%origin)
            call draw_words(canvas%output, [14.0_wp, real(page%height, wp)], 'start', 'class="name"', &
               phrase(text_centre_outside, canvas%mechanism%polish)//': ' &
               //fitted(at(1))//', '//fitted(at(2))//' ('//name//')')
         end associate
         page%height = page%height + line_height
         return
      end if
      call draw_circle(canvas%output, p, radius, 'class="centre" style="stroke:' &
         //link_color(canvas%mechanism, canvas%mechanism%requests(canvas%drawing%poles(i))%subject)//'"')
      call draw_circle(canvas%output, p, 1.0_wp, 'class="point"')
      call add_box(canvas, p - radius, p + radius)
      label%attributes = 'class="link" '//color
      call place_name(canvas, reshape(p, [2, 1]), clear_of_point, name, label)
      call draw_label(canvas, label)
   end subroutine draw_centre

   !> Draws the velocities of the points whose paths are drawn, as arrows, and their scale below that of lengths.
   subroutine draw_velocities(canvas)
      type(canvas_t), intent(inout) :: canvas   !< of the set, with arrows; gets the velocities
      real(wp) :: v(2, size(canvas%drawing%curves)), scale, p(2), tip(2)
      integer :: k

      do k = 1, size(canvas%drawing%curves)
         v(:, k) = point_velocity(canvas%mechanism, canvas%snapshot, canvas%drawing%curves(k))*[1.0_wp, -1.0_wp]
      end do
      if (.not. any(abs(v) > 0.0_wp)) return
      scale = longest_velocity/maxval(norm2(v, dim=1))

      do k = 1, size(canvas%drawing%curves)
         if (norm2(v(:, k))*scale < tip_length) cycle
         associate (point => canvas%drawing%curves(k))
            p = to_pixels(canvas, point_place(canvas%mechanism, canvas%snapshot, point))
            call open_group(canvas%output, 'class="velocity" ' &
               //attribute('data-point', trim(canvas%mechanism%points(point)%name)) &
               //' data-scale="'//full(scale)//'"', '')
            tip = p + scale*v(:, k)
            call draw_arrow_line(canvas, reshape([p, tip - tip_length*v(:, k)/norm2(v(:, k)), tip], [2, 3]), &
               'class="arrow"', 'class="tip arrow"')
            call close_group(canvas%output, 'g')
         end associate
      end do
      call draw_bar(canvas, canvas%high(2) + 36.0_wp, scale, trim(canvas%mechanism%length_unit)//'/' &
         //trim(canvas%mechanism%time_unit), 'class="arrow"')
   end subroutine draw_velocities

   !> Finds the number of the frame that is drawn in full: the first frame that is wide across, of those in which most
   !> links are known. Reason: links that are collinear at the first instant are read better later.
   integer function clearest(drawing, list) result(best)
      type(drawing_t), intent(in) :: drawing   !< of the set
      integer, intent(in) :: list(:)         !< (1 or more) numbers of the frames to choose from
      real(wp) :: across(size(list))
      logical :: most(size(list))
      integer :: i, known(size(list))

      known = [(count(drawing%frame(list(i))%known), i=1, size(list))]
      most = known == maxval(known)
      across = [(minval(sides_of(drawing, drawing%frame(list(i)))), i=1, size(list))]
      best = list(findloc(most .and. across >= clear_width*maxval(across, mask=most), .true., dim=1))
   end function clearest

   !> Finds the sides (2) of the box that the known moving links cover at a position, in lengths; 0 if none is known.
   pure function sides_of(drawing, snapshot) result(sides)
      type(drawing_t), intent(in) :: drawing   !< of the set
      type(snapshot_t), intent(in) :: snapshot   !< the position
      real(wp) :: sides(2), low(2), high(2)
      integer :: i

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do i = 1, size(drawing%mechanism%links)
         if (drawing%mechanism%links(i)%ground .or. .not. snapshot%known(i)) cycle
         associate (p => moved(drawing%outlines(i)%corner, snapshot%place(:, i)))
            low = min(low, minval(p, dim=2))
            high = max(high, maxval(p, dim=2))
         end associate
      end do
      sides = 0.0_wp
      if (all(high >= low)) sides = high - low
   end function sides_of

   !> Chooses the frames (any number) that are drawn faint: evenly spaced, without those that are almost equal to the
   !> frame in full or to one another.
   function faint_frames(drawing, own, best) result(list)
      type(drawing_t), intent(in) :: drawing   !< of the set
      integer, intent(in) :: own(:)          !< (1 or more) numbers of the frames to choose from
      integer, intent(in) :: best            !< number of the frame in full
      integer, allocatable :: list(:)
      integer :: i, j, k, n

      allocate (list(0))
      n = max(min_faint, min(max_faint, faint_links/max(1, &
         count(.not. (drawing%mechanism%links%ground .or. drawing%mechanism%links%hidden)))))
      do i = 0, n
         k = own(1 + i*(size(own) - 1)/n)
         if (distance(drawing, k, best) < same_position_part) cycle
         if (any([(distance(drawing, k, list(j)) < same_position_part, j=1, size(list))])) cycle
         list = [list, k]
      end do
   end function faint_frames

   !> Finds the largest distance of a corner between two frames, in parts of the mechanism; 1 if a link is known in one
   !> of them only.
   real(wp) function distance(drawing, i, j)
      type(drawing_t), intent(in) :: drawing   !< of the set
      integer, intent(in) :: i, j            !< numbers of the frames
      real(wp) :: extent
      integer :: k

      distance = 1.0_wp
      if (any(drawing%frame(i)%known .neqv. drawing%frame(j)%known)) return
      distance = 0.0_wp
      extent = maxval(sides_of(drawing, drawing%frame(i)))
      do k = 1, size(drawing%mechanism%links)
         if (drawing%mechanism%links(k)%ground .or. .not. drawing%frame(i)%known(k)) cycle
         associate (p => moved(drawing%outlines(k)%corner, drawing%frame(i)%place(:, k)), &
            q => moved(drawing%outlines(k)%corner, drawing%frame(j)%place(:, k)))
            if (size(p) > 0) distance = max(distance, maxval(abs(p - q)))
         end associate
      end do
      if (distance > 0.0_wp) distance = distance/max(extent, distance)
   end function distance

   !> Gives the velocity (2) of a point at a position, in the deck's units, from velocity and rate of its link; 0 if
   !> these are not known.
   pure function point_velocity(m, snapshot, i) result(v)
      type(mechanism_t), intent(in) :: m
      type(snapshot_t), intent(in) :: snapshot   !< of a drawing with arrows
      integer, intent(in) :: i               !< the number of the point
      real(wp) :: v(2)

      associate (link => m%points(i)%link)
         v = snapshot%velocity(:, link) &
            + snapshot%rate(link)*quarter_turn(point_place(m, snapshot, i) - snapshot%place(:2, link))
      end associate
   end function point_velocity
end module picture
