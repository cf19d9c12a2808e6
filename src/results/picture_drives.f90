!> The drives of a picture: an arrow for each, in the sense of its motion, an arc for an angle. Sizes are in pixels.
module picture_drives
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_revolute, drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use planar, only: degree, direction, quarter_turn
   use drives, only: drive_motion, new_law
   use names, only: drive_name
   use drawing, only: point_place
   use canvas, only: canvas_t, to_pixels, add_line, cover_of, tie
   use outline, only: corners_at
   use shapes, only: half_block
   use svg, only: put_group, put_end, put_line
   use text_output, only: output_t
   implicit none
   private
   public :: put_drives

   !> Radius of an arc, length of an arrow, its distance from the place along it and aside, its tip.
   real(wp), parameter :: arc_radius = 24.0_wp, arrow_length = 36.0_wp, arrow_start = 14.0_wp, &
      arrow_aside = half_block(2) + 10.0_wp, tip_length = 9.0_wp, tip_half = 4.5_wp
   integer, parameter :: arc_pieces = 12
   !> The angle of an arc without and with its tip, and where it may begin, from the side of the link in its own sense
   !> (degrees).
   real(wp), parameter :: arc_angle = 110.0_wp, tip_angle = 22.0_wp, &
      arc_starts(*) = [25.0_wp, 200.0_wp, 45.0_wp, 180.0_wp, 65.0_wp, 160.0_wp, 85.0_wp, 140.0_wp, 105.0_wp, 120.0_wp]
   !> The weight of an arrow for names, and what one farther from its place counts, in pixels of overlap.
   real(wp), parameter :: arrow_weight = 3.0_wp, away = 20.0_wp

contains

   !> Draws an arrow for each drive, in the sense in which it moves at the position that the canvas shows; at rest, in
   !> that of its acceleration.
   subroutine put_drives(c)
      type(canvas_t), intent(inout) :: c
      real(wp) :: f(0:2), sense
      integer :: i, k

      do i = 1, size(c%m%drives)
         associate (drive => c%m%drives(i), known => c%s%known)
            f = drive_motion(new_law(drive), c%s%t)
            sense = sign(1.0_wp, f(2))
            if (abs(f(1)) > 0.0_wp) sense = sign(1.0_wp, f(1))
            call put_group(c%o, 'class="drives"', trim(drive_name(c%m, drive)))
            select case (drive%kind)
            case (drive_angle)
               if (known(drive%subject)) call put_arc(c, 0, drive%subject, sense)
            case (drive_relangle)
               if (known(drive%subject) .and. known(drive%second)) call put_arc(c, drive%subject, drive%second, sense)
            case (drive_x, drive_y)
               if (known(c%m%points(drive%subject)%link)) call put_arrow(c, drive%subject, &
                  sense*merge([1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], drive%kind == drive_x), .true.)
            case (drive_slide)
               k = findloc(c%d%guides%pair, drive%subject, dim=1)
               associate (g => c%d%guides(k))
                  if (known(g%carrier) .and. known(g%block)) call put_arrow(c, g%point, &
                     sense*real(g%sense, wp)*direction(c%s%place(3, g%carrier) + g%angle), .false.)
               end associate
            end select
            call put_end(c%o, 'g')
         end associate
      end do
   end subroutine put_drives

   !> Draws an arc about a joint of `link` with an arrow: about its joint with `base`, 0 for the ground, otherwise about
   !> its first joint. Of places where it may begin, that is taken where it covers least.
   subroutine put_arc(c, base, link, sense)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: base, link
      real(wp), intent(in) :: sense
      real(wp) :: center(2), start, best(2, 0:arc_pieces), e(2), cover, least
      integer :: k, point

      point = joint_with(c%m, base, link)
      center = c%s%place(:2, link)
      if (point > 0) center = point_place(c%m, c%s, point)
      start = c%s%place(3, link)
      associate (corners => corners_at(c%d%outlines(link), c%s%place(:, link)))
         if (size(corners, 2) > 1) then
            e = sum(corners, dim=2)/real(size(corners, 2), wp) - center
            if (c%scale*norm2(e) > 1.0_wp) start = atan2(e(2), e(1))
         end if
      end associate
      center = to_pixels(c, center)
      least = huge(least)
      do k = 1, size(arc_starts)
         cover = cover_of(c, arc(center, start + sense*degree*arc_starts(k), sense*degree*(arc_angle + tip_angle)))
         if (cover >= least - tie) cycle
         least = cover
         best = arc(center, start + sense*degree*arc_starts(k), sense*degree*arc_angle)
      end do
      do k = 1, arc_pieces
         call add_line(c, best(:, k - 1), best(:, k), arrow_weight)
      end do
      e = (best(:, arc_pieces) - center)/arc_radius
      call put_line_with_tip(c%o, best, -sense*quarter_turn(e))
   end subroutine put_arc

   !> The pixels (2, 0:arc_pieces) of an arc about the pixel `center` (2), from `start` over `angle` (rad).
   pure function arc(center, start, angle) result(p)
      real(wp), intent(in) :: center(2), start, angle
      real(wp) :: p(2, 0:arc_pieces)
      integer :: k

      do k = 0, arc_pieces
         p(:, k) = center + arc_radius*direction(start + angle*real(k, wp)/real(arc_pieces, wp))*[1.0_wp, -1.0_wp]
      end do
   end function arc

   !> The point of `link` in its revolute pair with the link `base`, with any ground link where `base` is 0, or in its
   !> first revolute pair; 0 if it has none.
   pure integer function joint_with(m, base, link) result(point)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: base, link
      integer :: i, k, ends(2)

      point = 0
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind /= pair_revolute) cycle
         ends = [m%pairs(i)%point_i, m%pairs(i)%point_j]
         k = findloc(m%points(ends)%link, link, dim=1)
         if (k == 0) cycle
         if (point == 0) point = ends(k)
         associate (other => m%points(ends(3 - k))%link)
            if (other /= base .and. .not. (base == 0 .and. m%links(other)%ground)) cycle
         end associate
         point = ends(k)
         return
      end do
   end function joint_with

   !> Draws a straight arrow in the `sense` (2), a unit vector of the plane, beside `point` or, if it may be `ahead` of
   !> it, there: where it covers least.
   subroutine put_arrow(c, point, sense, ahead)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: point
      real(wp), intent(in) :: sense(2)
      logical, intent(in) :: ahead
      real(wp) :: p(2), e(2), ends(2, 2), best(2, 2), cover, least
      integer :: side, k

      p = to_pixels(c, point_place(c%m, c%s, point))
      e = sense*[1.0_wp, -1.0_wp]
      least = huge(least)
      do side = merge(0, 1, ahead), 4
         ends(:, 1) = p + arrow_start*e
         if (side > 0) ends(:, 1) = p - 0.5_wp*arrow_length*e + real((side + 1)/2, wp) &
            *merge(arrow_aside, -arrow_aside, (mod(side, 2) == 1) .eqv. (e(1) < 0.0_wp))*quarter_turn(e)
         ends(:, 2) = ends(:, 1) + arrow_length*e
         cover = cover_of(c, reshape([(ends(:, 1) + real(k, wp)/6.0_wp*(ends(:, 2) + tip_length*e - ends(:, 1)), &
            k=0, 6)], [2, 7])) + away*real((side + 1)/2, wp)
         if (cover >= least - tie) cycle
         least = cover
         best = ends
      end do
      call put_line_with_tip(c%o, best, e)
      call add_line(c, best(:, 1), best(:, 2) + tip_length*e, arrow_weight)
   end subroutine put_arrow

   !> Draws a line through the pixels `p` (2, :) with the tip of an arrow in the direction `e` (2) at its end.
   subroutine put_line_with_tip(o, p, e)
      type(output_t), intent(inout) :: o
      real(wp), intent(in) :: p(:, :), e(2)

      call put_line(o, 'polyline', p, 'class="drive"')
      associate (last => p(:, size(p, 2)), aside => tip_half*quarter_turn(e))
         call put_line(o, 'polygon', reshape([last + tip_length*e, last + aside, last - aside], [2, 3]), 'class="tip"')
      end associate
   end subroutine put_line_with_tip
end module picture_drives
