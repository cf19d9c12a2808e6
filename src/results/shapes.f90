!> The shapes of a set: paths, supports, guides, centrodes, links, blocks, joints and other points, each in the axes of
!> the link with which it moves. Picture and animation draw this one list. The symbols' sizes are in pixels.
module shapes
   use kinds, only: wp
   use mechanism, only: mechanism_t, has_guide
   use plane_vectors, only: direction, quarter_turn, rotated
   use scales, only: characteristic_length
   use drawing, only: drawing_t, guide_t, point_place
   use svg, only: attribute
   implicit none
   private
   public :: element_t, shapes_of, color_of, link_color, pole_name, half_block

   !> One shape. Each place is the sum of `places` in the unit of length and `pixels`, both in the axes of `link`.
   type :: element_t
      character(:), allocatable :: element      !< of SVG; 'centrode': a polyline that may run to infinity
      character(:), allocatable :: attributes   !< of SVG
      integer :: link = 0                       !< the link with which it moves; 0: the fixed plane
      logical :: is_below = .false.             !< the shape is drawn before all links
      logical :: is_faint = .false.             !< a faint position shows its outline
      real(wp), allocatable :: places(:, :), pixels(:, :)   !< (2, places) of a circle its centre
      real(wp) :: radius = 0.0_wp               !< pixels: of a circle; of a box how far it goes beyond its places
      !> The larger, the less a name may cross its lines; below 0: no name may cover its box.
      real(wp) :: weight = 0.0_wp
   end type element_t

   !> Links take these in turn.
   character(7), parameter :: colors(*) = ['#3b6ea5', '#d98324', '#4c8c4a', '#8058a5', '#2f9aa0', '#96692f', &
      '#b0528a', '#7d8c1f', '#5a6b7b', '#e07a8b', '#1f3f7a', '#c2a83e']
   !> Lines of the ground, and the surface of its blocks.
   character(*), parameter :: ground_color = '#222', ground_block = '#dddddd'
   !> Pixels of the circles of joints, and of the dots of other points.
   real(wp), parameter :: joint_radius = 4.5_wp, point_radius = 2.5_wp
   !> Half the length and width of a block, in pixels.
   real(wp), parameter :: half_block(2) = [12.0_wp, 7.0_wp]
   !> A guide goes on by so many pixels beyond the places of its block. Reason: a block's length of it is seen at both
   !> ends.
   real(wp), parameter :: guide_beyond = 3.0_wp*half_block(1)
   !> A slot goes on by so many pixels beyond the places of its pin.
   real(wp), parameter :: slot_beyond = 15.0_wp
   !> Half the width of a barrel, in pixels: it is as wide as a support.
   real(wp), parameter :: half_barrel = 10.0_wp
   !> Barrel and rod have these parts of the least length of their cylinder. Reason: both end before the other pin.
   real(wp), parameter :: barrel_part = 0.85_wp, piston_part = 0.97_wp
   !> The point of a support and its two feet, in pixels from its joint.
   real(wp), parameter :: support_corners(2, 3) = reshape([0.0_wp, 0.0_wp, -10.0_wp, -16.0_wp, 10.0_wp, -16.0_wp], &
      [2, 3])
   !> The ends of the hatched line of a support, in pixels from its joint.
   real(wp), parameter :: hatch_ends(2, 2) = reshape([-14.0_wp, -16.0_wp, 14.0_wp, -16.0_wp], [2, 2])
   !> A hatch lies so many pixels below its line.
   real(wp), parameter :: hatch_depth = 3.0_wp
   !> The weights of shapes: names keep clear of boxes, and cross bars less than lines and curves.
   real(wp), parameter :: box_weight = -1.0_wp, bar_weight = 1.5_wp, line_weight = 1.0_wp, curve_weight = 0.4_wp
   !> A line within so many characteristic lengths is one place for the eye.
   real(wp), parameter :: least_visible_length = 1.0e-5_wp
   !> A guide whose direction has a smaller cosine is vertical.
   real(wp), parameter :: vertical_cosine = 1.0e-5_wp
   !> A place so many characteristic lengths away is no number for a viewer.
   real(wp), parameter :: farthest_place = 1.0e3_wp

contains

   !> Gives the shapes (any number) of a drawing in the order in which they are drawn. A joint belongs to the one of its
   !> links that is drawn later.
   function shapes_of(drawing, scale) result(list)
      type(drawing_t), intent(in) :: drawing   !< of the set, after its last instant
      real(wp), intent(in) :: scale          !< pixels in a unit of length
      type(element_t), allocatable :: list(:)
      character(:), allocatable :: stroke
      real(wp) :: place(2, 3), u(2), v(2)
      logical :: is_dot(size(drawing%mechanism%points))
      integer :: ends(2), used, i, k

      used = 0
      allocate (list(4*size(drawing%mechanism%pairs) + 2*size(drawing%mechanism%links) &
         + size(drawing%mechanism%points)))
      do i = 1, size(drawing%curves)
         call add_path(drawing%curves(i))
      end do
      ! A support under each joint of the ground.
      do i = 1, size(drawing%mechanism%pairs)
         if (has_guide(drawing%mechanism%pairs(i)%kind)) cycle
         ends = [drawing%mechanism%pairs(i)%point_i, drawing%mechanism%pairs(i)%point_j]
         k = findloc(drawing%mechanism%links(drawing%mechanism%points(ends)%link)%ground, .true., dim=1)
         if (k == 0) cycle
         place = spread(point_place(drawing%mechanism, drawing%now, ends(k)), 2, 3)
         call add(0, 'polygon', 'class="support"', place, support_corners, box_weight)
         call add(0, 'polyline', 'class="hatch"', place(:, :2), hatch_ends - spread([0.0_wp, hatch_depth], 2, 2), &
            box_weight, hatch_depth)
         call add(0, 'polyline', 'class="support"', place(:, :2), hatch_ends)
      end do

      do i = 1, size(drawing%guides)
         associate (guide => drawing%guides(i))
            if (guide%high >= guide%low .and. .not. guide%is_cylinder) call add_guide(guide)
         end associate
      end do
      do i = 1, size(drawing%poles)
         do k = 1, 2
            if (drawing%has_centrodes) call add_centrode(i, k)
         end do
      end do
      list(:used)%is_below = .true.

      ! Links that move, bars and polygons; blocks; joints; points that no pair joins.
      do i = 1, size(drawing%mechanism%links)
         if (drawing%mechanism%links(i)%ground) cycle
         stroke = 'style="stroke:'//color_of(i)
         associate (p => drawing%outlines(i)%corner)
            if (size(p, 2) == 2) then
               call add(i, 'polyline', 'class="bar" '//stroke//'"', p, weight=bar_weight, is_faint=.true.)
               call add(i, 'polyline', 'class="core"', p)
            else if (size(p, 2) > 2) then
               call add(i, 'polygon', 'class="body" '//stroke//';fill:'//color_of(i)//'"', p, weight=line_weight, &
                  is_faint=.true.)
            end if
         end associate
      end do

      do i = 1, size(drawing%guides)
         associate (g => drawing%guides(i))
            if (g%is_cylinder .and. g%high >= g%low) call add_cylinder(g)
            if (drawing%mechanism%links(g%block)%hidden .or. g%is_cylinder) cycle
            u = half_block(1)*direction(g%block_angle)
            v = half_block(2)*quarter_turn(direction(g%block_angle))
            call add(g%block, 'polygon', 'class="block" style="fill:' &
               //merge(ground_block, color_of(g%block), drawing%mechanism%links(g%block)%ground)//'"', &
               spread(drawing%mechanism%points(g%point)%offset, 2, 4), reshape([v - u, u + v, u - v, -u - v], [2, 4]), &
               box_weight, is_faint=.true.)
         end associate
      end do

      do i = 1, size(drawing%mechanism%pairs)
         ends = [drawing%mechanism%pairs(i)%point_i, drawing%mechanism%pairs(i)%point_j]
         associate (links => drawing%mechanism%links(drawing%mechanism%points(ends)%link))
            k = ends(maxloc(merge(0, merge(1, 1 + drawing%mechanism%points(ends)%link, links%ground), links%hidden), &
               dim=1))
         end associate
         if (.not. has_guide(drawing%mechanism%pairs(i)%kind)) call add(drawing%mechanism%points(k)%link, 'circle', &
            'class="joint" '//attribute('data-pair', trim(drawing%mechanism%pairs(i)%name)), &
            spread(drawing%mechanism%points(k)%offset, 2, 1), weight=box_weight, radius=joint_radius)
      end do

      is_dot = .not. drawing%mechanism%links(drawing%mechanism%points%link)%ground
      is_dot([drawing%mechanism%pairs%point_i, drawing%mechanism%pairs%point_j]) = .false.
      do i = 1, size(is_dot)
         if (is_dot(i)) call add(drawing%mechanism%points(i)%link, 'circle', &
            'class="point" '//attribute('data-point', trim(drawing%mechanism%points(i)%name)), &
            spread(drawing%mechanism%points(i)%offset, 2, 1), weight=box_weight, radius=point_radius)
      end do
      list = list(:used)

   contains

      !> Adds a shape, which moves with a link.
      subroutine add(link, element, attributes, p, pixels, weight, radius, is_faint)
         integer, intent(in) :: link         !< the number of the link; 0: the fixed plane
         character(*), intent(in) :: element   !< 'circle', 'polyline', 'polygon' of SVG, or 'centrode'
         character(*), intent(in) :: attributes   !< of SVG
         real(wp), intent(in) :: p(:, :)     !< (2, places) in lengths, in the axes of the link
         real(wp), intent(in), optional :: pixels(:, :)   !< (2, places) in addition to `p`; without it 0
         real(wp), intent(in), optional :: weight   !< for names, as in `element_t`; without it 0
         real(wp), intent(in), optional :: radius   !< pixels, as in `element_t`; without it 0
         logical, intent(in), optional :: is_faint   !< a faint position shows its outline; without it not

         used = used + 1
         if (used > size(list)) list = [list, list]
         list(used) = element_t(element=element, attributes=attributes, link=link, places=p, pixels=0.0_wp*p)
         if (present(pixels)) list(used)%pixels = pixels
         if (present(weight)) list(used)%weight = weight
         if (present(radius)) list(used)%radius = radius
         if (present(is_faint)) list(used)%is_faint = is_faint
      end subroutine add

      !> Adds the pieces of a line through places; none if all are one place for the eye, as the pole of two links that
      !> a joint holds together.
      subroutine add_pieces(link, element, attributes, p, goes_on)
         integer, intent(in) :: link         !< the number of the link with which the line moves; 0: the fixed plane
         character(*), intent(in) :: element   !< 'polyline' or 'centrode'
         character(*), intent(in) :: attributes   !< of SVG
         real(wp), intent(in) :: p(:, :)     !< (2, places) in lengths, in the axes of the link
         logical, intent(in) :: goes_on(:)   !< (places) a piece goes from the place to the next one
         integer :: first, last

         if (.not. any(goes_on)) return
         associate (on => spread(goes_on .or. eoshift(goes_on, -1), 1, 2))
            if (all(maxval(p, 2, on) - minval(p, 2, on) < &
               least_visible_length*characteristic_length(drawing%mechanism))) return
         end associate
         first = 1
         do last = 1, size(goes_on)
            if (goes_on(last)) cycle
            if (last > first) call add(link, element, attributes, p(:, first:last), weight=curve_weight)
            first = last + 1
         end do
      end subroutine add_pieces

      !> Adds the path of a point through the frames of TIME, in pieces if its place is not known in some.
      subroutine add_path(i)
         integer, intent(in) :: i            !< the number of the point
         real(wp) :: p(2, drawing%films)
         logical :: known(drawing%films)
         integer :: k

         do k = 1, drawing%films
            known(k) = drawing%frame(k)%known(drawing%mechanism%points(i)%link)
            p(:, k) = point_place(drawing%mechanism, drawing%frame(k), i)
         end do
         call add_pieces(0, 'polyline', &
            'class="curve" '//attribute('data-path', trim(drawing%mechanism%points(i)%name)) &
            //' style="stroke:'//color_of(drawing%mechanism%points(i)%link)//'"', p, known .and. eoshift(known, 1))
      end subroutine add_path

      !> Adds a guide: a line over the range of the slide. A guide of the ground has a hatch. A guide of a moving link
      !> is a rod; it begins where the perpendicular from its pivot meets it, if the perpendicular can be seen.
      subroutine add_guide(guide)
         type(guide_t), intent(in) :: guide  !< not of a cylinder, with a range
         real(wp), allocatable :: p(:, :), pixels(:, :)
         real(wp) :: e(2), aside(2), further

         e = direction(guide%angle)
         further = merge(slot_beyond, guide_beyond, drawing%mechanism%links(guide%block)%hidden)
         if (drawing%mechanism%links(guide%carrier)%ground) then
            p = reshape([guide%foot + guide%low*e, guide%foot + guide%high*e], [2, 2])
            pixels = reshape([-further*e, further*e], [2, 2])
            ! A vertical guide has its hatch on the right, whatever rounding makes of its cosine.
            aside = -sign(hatch_depth, cos(drawing%now%place(3, guide%carrier) + guide%angle) + vertical_cosine) &
               *quarter_turn(e)
            call add(guide%carrier, 'polyline', 'class="hatch"', p, pixels + spread(aside, 2, 2), line_weight)
            call add(guide%carrier, 'polyline', 'class="guide"', p, pixels, line_weight)
         else
            aside = drawing%mechanism%points(guide%pivot)%offset - guide%foot
            p = reshape([guide%foot + min(guide%low, 0.0_wp)*e, guide%foot + max(guide%high, 0.0_wp)*e], [2, 2])
            pixels = reshape([min(scale*max(guide%low, 0.0_wp) - further, 0.0_wp)*e, &
               max(scale*min(guide%high, 0.0_wp) + further, 0.0_wp)*e], [2, 2])
            if (scale*norm2(aside) > 1.0_wp) then
               p = reshape([p(:, 1), guide%foot, guide%foot + aside, guide%foot, p(:, 2)], [2, 5])
               pixels = reshape([pixels(:, 1), 0.0_wp*[aside, aside, aside], pixels(:, 2)], [2, 5])
            end if
            call add(guide%carrier, 'polyline', 'class="rod" style="stroke:'//color_of(guide%carrier)//'"', p, pixels, &
               line_weight, is_faint=.true.)
            call add(guide%carrier, 'polyline', 'class="slot"', p, pixels)
         end if
      end subroutine add_guide

      !> Adds the cylinder of a guide: a rod from Q, and over it a barrel from P.
      subroutine add_cylinder(guide)
         type(guide_t), intent(in) :: guide  !< of a cylinder, with a range
         real(wp) :: e(2), aside(2), least

         least = max(guide%low, 0.0_wp)
         e = direction(guide%block_angle)
         associate (q => drawing%mechanism%points(guide%point)%offset)
            call add(guide%block, 'polyline', &
               'class="piston" style="stroke:'//link_color(drawing%mechanism, guide%block)//'"', &
               reshape([q, q - piston_part*least*e], [2, 2]), weight=line_weight, is_faint=.true.)
         end associate
         e = direction(guide%angle)
         aside = half_barrel*quarter_turn(e)
         associate (p => drawing%mechanism%points(guide%pivot)%offset)
            call add(guide%carrier, 'polygon', &
               'class="barrel" style="stroke:'//link_color(drawing%mechanism, guide%carrier)//'"', &
               reshape([p, p, p + barrel_part*least*e, p + barrel_part*least*e], [2, 4]), &
               reshape([aside, -aside, -aside, aside], [2, 4]), weight=line_weight, is_faint=.true.)
         end associate
      end subroutine add_cylinder

      !> Adds the centrode of a pole in one of its links, in the axes of that link: both centrodes touch at the instant
      !> centre. The centrode may run to infinity; the window of the picture cuts it. If the sense of the relative turn
      !> changes, the centre has passed through infinity. A place farther away than `farthest_place` is not drawn.
      subroutine add_centrode(i, side)
         integer, intent(in) :: i            !< the number of the pole among those of the drawing
         integer, intent(in) :: side         !< which of its links, 1 or 2
         character(:), allocatable :: attributes
         real(wp) :: p(2, drawing%films)
         real(wp) :: turn(drawing%films)                        ! the rate of the second link less that of the first
         logical :: goes_on(drawing%films)                      ! the next place is on the same piece
         integer :: links(2), k

         associate (pole => drawing%mechanism%requests(drawing%poles(i)))
            links = [pole%second, pole%subject]
         end associate
         do k = 1, drawing%films
            associate (now => drawing%frame(k), place => drawing%frame(k)%place(:, links(side)))
               p(:, k) = rotated(now%centre(:, i) - place(:2), direction(-place(3)))
               turn(k) = now%rate(links(2)) - now%rate(links(1))
               goes_on(k) = now%has_centre(i)
            end associate
         end do
         goes_on = goes_on .and. all(abs(p) < farthest_place*characteristic_length(drawing%mechanism), dim=1)
         goes_on = goes_on .and. eoshift(goes_on, 1) .and. ((turn > 0.0_wp) .eqv. (eoshift(turn, 1) > 0.0_wp))
         attributes = 'class="centrode" '//attribute('data-centrode', pole_name(drawing%mechanism, drawing%poles(i))) &
            //' '//attribute('data-link', trim(drawing%mechanism%links(links(side))%name))//' style="stroke:' &
            //link_color(drawing%mechanism, links(side))//'"'
         call add_pieces(links(side), 'centrode', attributes, p, goes_on)
      end subroutine add_centrode
   end function shapes_of

   !> Gives the color of a moving link, or of a circuit.
   pure function color_of(i) result(color)
      integer, intent(in) :: i               !< number of the link or circuit, from 1
      character(len(colors)) :: color

      color = colors(1 + modulo(i - 1, size(colors)))
   end function color_of

   !> Gives the color of all that belongs to a link, which may be of the ground.
   pure function link_color(m, i) result(color)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< the number of the link
      character(:), allocatable :: color

      color = ground_color
      if (.not. m%links(i)%ground) color = color_of(i)
   end function link_color

   !> Gives the name of a pole: the names of both its links, with a dash.
   pure function pole_name(m, i) result(name)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< number of the pole among the requests
      character(:), allocatable :: name

      name = trim(m%links(m%requests(i)%second)%name)//'-'//trim(m%links(m%requests(i)%subject)%name)
   end function pole_name
end module shapes
