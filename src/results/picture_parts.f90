!> The parts of a picture: links, guides, blocks, joints, ground, curves, at the position that the canvas shows where no
!> other is given. What is drawn in full is noted on the canvas, so that names keep clear of it. The symbols' sizes are
!> in pixels.
module picture_parts
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_revolute
   use planar, only: direction, quarter_turn, point_of
   use drawing, only: snapshot_t, curve_t, guide_t, point_place
   use outline, only: outline_t, corners_at
   use canvas, only: canvas_t, to_pixels, add_line, add_box
   use svg, only: put_group, put_end, put_circle, put_line, put_curve, attribute
   use text_output, only: output_t
   implicit none
   private
   public :: put_body, put_outlines, put_flagged, put_guide, put_ground, put_block, put_joint, put_dot, put_path
   public :: dots_of, guide_ends, color_of, corner_pixels, direction_in_picture, joint_point, half_block

   !> Links take these in turn.
   character(7), parameter :: colors(*) = ['#3b6ea5', '#d98324', '#4c8c4a', '#8058a5', '#2f9aa0', '#96692f', '#b0528a']
   real(wp), parameter :: joint_radius = 4.5_wp, point_radius = 2.5_wp, ring_radius = 8.0_wp
   !> Half the length and width of a block. A guide goes on by so much beyond the places of its block: the ground's, and
   !> that of a moving link.
   real(wp), parameter :: half_block(2) = [12.0_wp, 7.0_wp], beyond = 22.0_wp, rod_beyond = 15.0_wp
   !> Half the width and the height of a support; distance and length of the lines of a hatch.
   real(wp), parameter :: half_support = 10.0_wp, support_height = 16.0_wp, hatch_step = 7.0_wp, hatch_length = 6.0_wp
   !> A piece of a curve is a cubic only where its control points are no farther from its ends than this part of the
   !> distance of its ends: up to about half a turn of a circle. Farther ones would draw loops that are not there.
   real(wp), parameter :: max_control = 0.6_wp
   !> The weight of a curve against that of a bar, for names.
   real(wp), parameter :: curve_weight = 0.4_wp

contains

   !> The color of link number `i`.
   pure function color_of(i) result(color)
      integer, intent(in) :: i
      character(len(colors)) :: color

      color = colors(1 + modulo(i - 1, size(colors)))
   end function color_of

   !> Link number `i`, which moves, in full: a bar, or a polygon.
   subroutine put_body(c, i)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: i
      real(wp) :: p(2, size(c%d%outlines(i)%corner, 2))

      if (c%m%links(i)%ground .or. .not. c%s%known(i) .or. size(p, 2) < 2) return
      p = corner_pixels(c, c%d%outlines(i), c%s%place(:, i))
      call put_group(c%o, 'style="stroke:'//color_of(i)//'"', trim(c%m%links(i)%name))
      if (size(p, 2) == 2) then
         call put_line(c%o, 'polyline', p, 'class="bar" style="stroke:'//color_of(i)//'"')
         call put_line(c%o, 'polyline', p, 'class="core"')
         call add_line(c, p(:, 1), p(:, 2), 1.5_wp)
      else
         call put_line(c%o, 'polygon', p, 'class="body" style="stroke:'//color_of(i)//';fill:'//color_of(i)//'"')
         call add_outline(c, p)
      end if
      call put_end(c%o, 'g')
   end subroutine put_body

   !> Notes the sides of the polygon `p` (2, :).
   subroutine add_outline(c, p)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: p(:, :)
      integer :: k

      do k = 1, size(p, 2)
         call add_line(c, p(:, k), p(:, 1 + modulo(k, size(p, 2))), 1.0_wp)
      end do
   end subroutine add_outline

   !> The moving links as thin lines at the position `s`.
   subroutine put_outlines(c, s)
      type(canvas_t), intent(in) :: c
      type(snapshot_t), intent(in) :: s
      integer :: i

      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground .or. .not. s%known(i)) cycle
         associate (p => corner_pixels(c, c%d%outlines(i), s%place(:, i)))
            if (size(p, 2) == 2) call put_line(c%o, 'polyline', p, 'class="thin"')
            if (size(p, 2) > 2) call put_line(c%o, 'polygon', p, 'class="thin"')
         end associate
      end do
   end subroutine put_outlines

   !> The flagged position `s`: thin lines, and rings about the joints, which show where the lines are covered.
   subroutine put_flagged(c, s)
      type(canvas_t), intent(inout) :: c
      type(snapshot_t), intent(in) :: s
      integer :: i

      call put_group(c%o, 'class="flagged"', '')
      call put_outlines(c, s)
      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground .or. .not. s%known(i)) cycle
         call add_outline(c, corner_pixels(c, c%d%outlines(i), s%place(:, i)))
      end do
      do i = 1, size(c%m%pairs)
         associate (point => joint_point(c%m, s%known, i))
            if (point > 0) call put_circle(c%o, to_pixels(c, point_place(c%m, s, point)), ring_radius, 'class="ring"')
         end associate
      end do
      call put_end(c%o, 'g')
   end subroutine put_flagged

   !> The corners (2, :) of the outline `h` of a link at `position` (x, y, phi), in pixels.
   pure function corner_pixels(c, h, position) result(p)
      type(canvas_t), intent(in) :: c
      type(outline_t), intent(in) :: h
      real(wp), intent(in) :: position(3)
      real(wp) :: p(2, size(h%corner, 2))
      integer :: k

      p = corners_at(h, position)
      do k = 1, size(p, 2)
         p(:, k) = to_pixels(c, p(:, k))
      end do
   end function corner_pixels

   !> The guide `g`: a line over the range of the slide. The ground's has a hatch. That of a moving
   !> link is a rod that begins where the perpendicular from its pivot meets it.
   subroutine put_guide(c, g)
      type(canvas_t), intent(inout) :: c
      type(guide_t), intent(in) :: g
      real(wp) :: e(2), pivot(2), foot(2), ends(2, 2), from, to
      real(wp), allocatable :: p(:, :)

      if (.not. c%s%known(g%carrier) .or. g%high < g%low) return
      e = direction_in_picture(c%s%place(3, g%carrier) + g%angle)
      pivot = to_pixels(c, point_place(c%m, c%s, g%pivot))
      foot = to_pixels(c, point_of(c%s%place(:, g%carrier), g%foot))
      from = c%scale*g%low
      to = c%scale*g%high
      call put_group(c%o, 'class="guide"', trim(c%m%pairs(g%pair)%name))
      if (c%m%links(g%carrier)%ground) then
         ends = reshape([foot + (from - beyond)*e, foot + (to + beyond)*e], [2, 2])
         call put_hatch(c%o, ends(:, 1), ends(:, 2), sign(1.0_wp, e(1))*quarter_turn(e))
         call put_line(c%o, 'polyline', ends, 'class="guide"')
      else
         ends = reshape([foot + min(from - rod_beyond, 0.0_wp)*e, foot + max(to + rod_beyond, 0.0_wp)*e], [2, 2])
         p = ends
         if (norm2(pivot - foot) > 1.0_wp) then
            p = reshape([ends(:, 1), foot, pivot, foot, ends(:, 2)], [2, 5])
            call add_line(c, pivot, foot, 1.0_wp)
         end if
         call put_line(c%o, 'polyline', p, 'class="rod" style="stroke:'//color_of(g%carrier)//'"')
         call put_line(c%o, 'polyline', p, 'class="slot"')
      end if
      call put_end(c%o, 'g')
      call add_line(c, ends(:, 1), ends(:, 2), 1.0_wp)
   end subroutine put_guide

   !> The ends (2, 2) of the range of the slide on the guide `g` at the position `s`.
   pure function guide_ends(g, s) result(ends)
      type(guide_t), intent(in) :: g
      type(snapshot_t), intent(in) :: s
      real(wp) :: ends(2, 2)

      associate (e => direction(g%angle))
         ends(:, 1) = point_of(s%place(:, g%carrier), g%foot + g%low*e)
         ends(:, 2) = point_of(s%place(:, g%carrier), g%foot + g%high*e)
      end associate
   end function guide_ends

   !> The unit vector (2) at `angle` (rad) in the picture, where y is down.
   pure function direction_in_picture(angle) result(e)
      real(wp), intent(in) :: angle
      real(wp) :: e(2)

      e = direction(angle)
      e(2) = -e(2)
   end function direction_in_picture

   !> The hatch of the ground along the line from `p` to `q` (2), on the side of the unit vector `side` (2).
   subroutine put_hatch(o, p, q, side)
      type(output_t), intent(inout) :: o
      real(wp), intent(in) :: p(2), q(2), side(2)
      real(wp) :: e(2), start(2), length
      integer :: k, n

      length = norm2(q - p)
      ! What is far out of the picture may have no length left.
      if (length <= 0.0_wp) return
      n = max(1, int(min(200.0_wp, length/hatch_step)))
      e = (q - p)/length
      do k = 1, n
         start = p + real(k, wp)*(q - p)/real(n, wp)
         call put_line(o, 'polyline', reshape([start, start + hatch_length*(side - e)], [2, 2]), 'class="hatch"')
      end do
   end subroutine put_hatch

   !> A support under each point of the ground that a revolute pair joins.
   subroutine put_ground(c)
      type(canvas_t), intent(inout) :: c
      real(wp) :: p(2), base(2, 2)
      integer :: i, point

      do i = 1, size(c%m%pairs)
         if (c%m%pairs(i)%kind /= pair_revolute) cycle
         point = c%m%pairs(i)%point_i
         if (.not. c%m%links(c%m%points(point)%link)%ground) point = c%m%pairs(i)%point_j
         if (.not. c%m%links(c%m%points(point)%link)%ground) cycle
         p = to_pixels(c, point_place(c%m, c%d%now, point))
         base = reshape([p + [-half_support, support_height], p + [half_support, support_height]], [2, 2])
         call put_group(c%o, 'class="ground"', trim(c%m%links(c%m%points(point)%link)%name))
         call put_line(c%o, 'polygon', reshape([p, base], [2, 3]), 'class="support"')
         base(1, :) = base(1, :) + [-4.0_wp, 4.0_wp]
         call put_hatch(c%o, base(:, 1), base(:, 2), [0.0_wp, 1.0_wp])
         call put_line(c%o, 'polyline', base, 'class="support"')
         call put_end(c%o, 'g')
         call add_box(c, p - [half_support, 0.0_wp], p + [half_support, support_height + hatch_length])
      end do
   end subroutine put_ground

   !> The block on the guide `g`.
   subroutine put_block(c, g)
      type(canvas_t), intent(inout) :: c
      type(guide_t), intent(in) :: g
      real(wp) :: p(2), u(2), v(2)
      character(7) :: color

      if (.not. c%s%known(g%block)) return
      p = to_pixels(c, point_place(c%m, c%s, g%point))
      u = half_block(1)*direction_in_picture(c%s%place(3, g%block) + g%block_angle)
      v = half_block(2)*quarter_turn(u)/half_block(1)
      color = color_of(g%block)
      if (c%m%links(g%block)%ground) color = '#dddddd'
      call put_group(c%o, 'class="slider"', trim(c%m%pairs(g%pair)%name))
      call put_line(c%o, 'polygon', reshape([p - u - v, p + u - v, p + u + v, p - u + v], [2, 4]), &
         'class="block" style="fill:'//color//'"')
      call put_end(c%o, 'g')
      call add_box(c, p - abs(u) - abs(v), p + abs(u) + abs(v))
   end subroutine put_block

   !> The joint of pair number `i`, if that is a revolute pair, at its `point`; 0 for none.
   subroutine put_joint(c, i, point)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: i, point
      real(wp) :: p(2)

      if (c%m%pairs(i)%kind /= pair_revolute .or. point == 0) return
      p = to_pixels(c, point_place(c%m, c%s, point))
      call put_circle(c%o, p, joint_radius, 'class="joint" '//attribute('data-pair', trim(c%m%pairs(i)%name)))
      call add_box(c, p - joint_radius, p + joint_radius)
   end subroutine put_joint

   !> The point at which pair number `i` is drawn: of the links that are `known` (links) that of a moving one, of two
   !> moving ones the later in the deck; 0 for none.
   pure integer function joint_point(m, known, i) result(point)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: known(:)
      integer, intent(in) :: i
      integer :: ends(2), links(2), rank(2)

      ends = [m%pairs(i)%point_i, m%pairs(i)%point_j]
      links = m%points(ends)%link
      rank = merge(merge(0, links, m%links(links)%ground), -1, known(links))
      point = 0
      if (any(rank >= 0)) point = ends(maxloc(rank, dim=1))
   end function joint_point

   !> The numbers of the points of moving links that no pair joins: they are dots.
   pure function dots_of(m) result(list)
      type(mechanism_t), intent(in) :: m
      integer, allocatable :: list(:)
      logical :: is_dot(size(m%points))
      integer :: i

      is_dot = .not. m%links(m%points%link)%ground
      is_dot([m%pairs%point_i, m%pairs%point_j]) = .false.
      list = pack([(i, i=1, size(is_dot))], is_dot)
   end function dots_of

   !> Point number `i` as a dot.
   subroutine put_dot(c, i)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: i
      real(wp) :: p(2)

      if (.not. c%s%known(c%m%points(i)%link)) return
      p = to_pixels(c, point_place(c%m, c%s, i))
      call put_circle(c%o, p, point_radius, 'class="point" '//attribute('data-point', trim(c%m%points(i)%name)))
      call add_box(c, p - point_radius, p + point_radius)
   end subroutine put_dot

   !> The path `curve` of a point, in pieces where it is not known.
   subroutine put_path(c, curve)
      type(canvas_t), intent(inout) :: c
      type(curve_t), intent(in) :: curve
      character(:), allocatable :: name
      integer :: first, last, n

      n = size(curve%known)
      name = trim(c%m%points(curve%point)%name)
      call put_group(c%o, attribute('data-path', name), name)
      first = 1
      do last = 1, n
         if (last < n .and. all(curve%known(last:min(last + 1, n)) >= 0)) cycle
         if (last > first) call put_piece(c, curve, first, last)
         first = last + 1
      end do
      call put_end(c%o, 'g')
   end subroutine put_path

   !> The places `first` to `last` of the path: cubics with the velocities at their ends.
   subroutine put_piece(c, curve, first, last)
      type(canvas_t), intent(inout) :: c
      type(curve_t), intent(in) :: curve
      integer, intent(in) :: first, last
      real(wp) :: p(2, first:last), from(2, first:last - 1), to(2, first:last - 1), third, far
      logical :: straight(first:last - 1)
      integer :: k

      do k = first, last
         p(:, k) = to_pixels(c, curve%place(:, k))
      end do
      do k = first, last - 1
         third = (curve%t(k + 1) - curve%t(k))/3.0_wp
         from(:, k) = to_pixels(c, curve%place(:, k) + third*curve%velocity(:, k))
         to(:, k) = to_pixels(c, curve%place(:, k + 1) - third*curve%velocity(:, k + 1))
         far = max_control*norm2(p(:, k + 1) - p(:, k))
         straight(k) = any(curve%known(k:k + 1) < 1) .or. .not. (norm2(from(:, k) - p(:, k)) <= far .and. &
            norm2(to(:, k) - p(:, k + 1)) <= far)
         call add_line(c, p(:, k), p(:, k + 1), curve_weight)
      end do
      call put_curve(c%o, p, from, to, straight, &
         'class="curve" style="stroke:'//color_of(c%m%points(curve%point)%link)//'"')
   end subroutine put_piece
end module picture_parts
