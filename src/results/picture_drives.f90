!> The drives of a picture: an arrow for each, in the sense of its motion, an arc for an angle. Sizes are in pixels.
module picture_drives
   use kinds, only: wp
   use constants, only: degree
   use mechanism, only: mechanism_t, drive_t, pair_revolute, drive_angle, drive_x, drive_y, drive_relangle, &
      drive_slide
   use planar, only: direction, quarter_turn
   use drives, only: drive_motion, new_law
   use names, only: drive_name
   use drawing, only: drawing_t, snapshot_t, point_place
   use canvas, only: canvas_t, to_pixels, add_line
   use picture_parts, only: corner_pixels, guide_direction, half_block
   use svg, only: put_group, put_group_end, put_polyline, put_polygon
   use text_output, only: output_t
   implicit none
   private
   public :: put_drives, joint_with

   !> Radius of an arc, length of an arrow, its distance from the place, its tip.
   real(wp), parameter :: arc_radius = 24.0_wp, arrow_length = 36.0_wp, arrow_start = 12.0_wp, tip_length = 9.0_wp, &
      tip_half = 4.5_wp
   integer, parameter :: arc_pieces = 12

contains

   !> An arrow for each drive, in the sense in which it moves at the position `s`.
   subroutine put_drives(o, c, m, d, s)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      real(wp) :: sense
      integer :: i

      do i = 1, size(m%drives)
         sense = sense_of(m%drives(i), s%t)
         call put_group(o, 'class="drives"', trim(drive_name(m, m%drives(i))))
         select case (m%drives(i)%kind)
         case (drive_angle)
            if (s%known(m%drives(i)%subject)) call put_arc(o, c, m, s, 0, m%drives(i)%subject, sense)
         case (drive_relangle)
            if (s%known(m%drives(i)%subject) .and. s%known(m%drives(i)%second)) &
               call put_arc(o, c, m, s, m%drives(i)%subject, m%drives(i)%second, sense)
         case (drive_x, drive_y)
            if (s%known(m%points(m%drives(i)%subject)%link)) call put_arrow(o, c, &
               to_pixels(c, point_place(m, s, m%drives(i)%subject)), &
               sense*merge([1.0_wp, 0.0_wp], [0.0_wp, -1.0_wp], m%drives(i)%kind == drive_x), [0.0_wp, 0.0_wp])
         case (drive_slide)
            call put_slide(o, c, m, d, s, m%drives(i)%subject, sense)
         end select
         call put_group_end(o)
      end do
   end subroutine put_drives

   !> The arrow of a SLIDE drive of pair number `pair`, beside its block.
   subroutine put_slide(o, c, m, d, s, pair, sense)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      integer, intent(in) :: pair
      real(wp), intent(in) :: sense
      real(wp) :: e(2)
      integer :: k

      do k = 1, size(d%guides)
         associate (g => d%guides(k))
            if (g%pair /= pair .or. .not. (s%known(g%carrier) .and. s%known(g%block))) cycle
            e = guide_direction(g, s)
            call put_arrow(o, c, to_pixels(c, point_place(m, s, g%point)), sense*real(g%sense, wp)*e, &
               -1.0_wp*sign(half_block(2) + 6.0_wp, e(1))*quarter_turn(e))
         end associate
      end do
   end subroutine put_slide

   !> 1 or -1: the sense of the rate of `drive` at `t`, at rest that of its acceleration.
   real(wp) function sense_of(drive, t)
      type(drive_t), intent(in) :: drive
      real(wp), intent(in) :: t
      real(wp) :: f(0:2)

      f = drive_motion(new_law(drive), t)
      sense_of = sign(1.0_wp, f(2))
      if (abs(f(1)) > 0.0_wp) sense_of = sign(1.0_wp, f(1))
   end function sense_of

   !> An arc about a joint of `link` with an arrow: about its joint with `base`, 0 for the ground, otherwise about its
   !> first joint.
   subroutine put_arc(o, c, m, s, base, link, sense)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(snapshot_t), intent(in) :: s
      integer, intent(in) :: base, link
      real(wp), intent(in) :: sense
      real(wp) :: center(2), start, p(2, 0:arc_pieces), e(2), outline
      real(wp), allocatable :: corners(:, :)
      integer :: k, point

      point = joint_with(m, base, link)
      center = to_pixels(c, s%place(:2, link))
      if (point > 0) center = to_pixels(c, point_place(m, s, point))
      ! From the side of the link, 25 degrees on: the arc is beside the bar.
      corners = corner_pixels(c, m, s, link)
      start = s%place(3, link)
      if (size(corners, 2) > 1) then
         e = sum(corners, dim=2)/real(size(corners, 2), wp) - center
         if (norm2(e) > 1.0_wp) start = atan2(-e(2), e(1))
      end if
      do k = 0, arc_pieces
         outline = start + sense*degree*(25.0_wp + 110.0_wp*real(k, wp)/real(arc_pieces, wp))
         e = direction(outline)
         p(:, k) = center + arc_radius*[e(1), -e(2)]
         if (k > 0) call add_line(c, p(:, k - 1), p(:, k), 1.0_wp)
      end do
      call put_polyline(o, p, 'class="drive"')
      e = sense*[-sin(outline), -cos(outline)]
      call put_tip(o, p(:, arc_pieces), e)
   end subroutine put_arc

   !> The point of `link` in its revolute pair with the link `base`, with any ground link where `base` is 0, or in its
   !> first revolute pair; 0 if it has none.
   pure integer function joint_with(m, base, link) result(point)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: base, link
      integer :: i, own, other

      point = 0
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind /= pair_revolute) cycle
         own = m%pairs(i)%point_i
         other = m%pairs(i)%point_j
         if (m%points(own)%link /= link) then
            own = m%pairs(i)%point_j
            other = m%pairs(i)%point_i
         end if
         if (m%points(own)%link /= link) cycle
         if (point == 0) point = own
         if (m%points(other)%link /= base .and. .not. (base == 0 .and. m%links(m%points(other)%link)%ground)) cycle
         point = own
         return
      end do
   end function joint_with

   !> A straight arrow in the direction `e` (2) beside the pixel `p` (2), moved by `aside` (2).
   subroutine put_arrow(o, c, p, e, aside)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: p(2), e(2), aside(2)
      real(wp) :: ends(2, 2), start

      start = merge(arrow_start, -0.5_wp*arrow_length, norm2(aside) < 1.0_wp)
      ends(:, 1) = p + aside + start*e
      ends(:, 2) = ends(:, 1) + arrow_length*e
      call put_polyline(o, ends, 'class="drive"')
      call put_tip(o, ends(:, 2), e)
      call add_line(c, ends(:, 1), ends(:, 2), 1.0_wp)
   end subroutine put_arrow

   !> The tip of an arrow that ends at the pixel `p` (2) in the direction `e` (2).
   subroutine put_tip(o, p, e)
      type(output_t), intent(inout) :: o
      real(wp), intent(in) :: p(2), e(2)

      call put_polygon(o, reshape([p + tip_length*e, p + tip_half*quarter_turn(e), p - tip_half*quarter_turn(e)], &
         [2, 3]), 'class="tip"')
   end subroutine put_tip
end module picture_drives
