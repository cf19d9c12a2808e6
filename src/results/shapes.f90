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
   public :: element_t, shapes_of, color_of, link_color, pole_name, half_block, joint_radius

   !> One shape. Its places are `p` in the unit of length and further `add` in pixels, both in the axes of `link`.
   type :: element_t
      character(:), allocatable :: element      !< of SVG; 'centrode': a polyline that may run to infinity
      character(:), allocatable :: attributes
      integer :: link = 0                       !< 0: the fixed plane
      logical :: is_below = .false.             !< it is drawn before all links
      logical :: is_faint = .false.             !< a faint position shows its outline
      real(wp), allocatable :: p(:, :), add(:, :)   !< (2, places) of a circle its centre
      real(wp) :: radius = 0.0_wp               !< of a circle; of a box how far it goes beyond its places
      !> Names should not cross its lines, the less the more they weigh; below 0: not cover its box.
      real(wp) :: weight = 0.0_wp
   end type element_t

   !> Links take these in turn; what belongs to the ground has its own.
   character(7), parameter :: colors(*) = ['#3b6ea5', '#d98324', '#4c8c4a', '#8058a5', '#2f9aa0', '#96692f', &
      '#b0528a', '#7d8c1f', '#5a6b7b', '#e07a8b', '#1f3f7a', '#c2a83e']
   character(*), parameter :: ground_color = '#222', ground_block = '#dddddd'
   real(wp), parameter :: joint_radius = 4.5_wp, point_radius = 2.5_wp
   !> Half the length and width of a block. A guide goes on by so much beyond the places of its block, so that a block's
   !> length of it is seen at both ends; beyond the places of a pin in a slot by less.
   real(wp), parameter :: half_block(2) = [12.0_wp, 7.0_wp], beyond = 3.0_wp*half_block(1), beyond_pin = 15.0_wp
   !> A barrel is half as wide as a support is wide, and has this part of the least length of its cylinder; the rod has
   !> this part. So both end before the other pin.
   real(wp), parameter :: half_barrel = 10.0_wp, of_barrel = 0.85_wp, of_piston = 0.97_wp
   !> A support: its point, its two feet, and the ends of its hatched line. A hatch lies so far below its line.
   real(wp), parameter :: support(2, 3) = reshape([0.0_wp, 0.0_wp, -10.0_wp, -16.0_wp, 10.0_wp, -16.0_wp], [2, 3]), &
      base(2, 2) = reshape([-14.0_wp, -16.0_wp, 14.0_wp, -16.0_wp], [2, 2]), below = 3.0_wp
   !> Names keep clear of boxes; lines weigh so much for them.
   real(wp), parameter :: box = -1.0_wp, bar_weight = 1.5_wp, line_weight = 1.0_wp, curve_weight = 0.4_wp
   !> A line within so many characteristic lengths is one place for the eye. A place so many of them away is no number
   !> for a viewer.
   real(wp), parameter :: one_place = 1.0e-5_wp, far = 1.0e3_wp

contains

   !> Returns the shapes of the `drawing` at so many pixels a unit of length (`scale`), in the order in which they are
   !> drawn; joints on that of their links which is drawn later.
   function shapes_of(drawing, scale) result(list)
      type(drawing_t), intent(in) :: drawing
      real(wp), intent(in) :: scale
      type(element_t), allocatable :: list(:)
      character(:), allocatable :: stroke
      real(wp) :: place(2, 3), u(2), v(2)
      logical :: is_dot(size(drawing%m%points))
      integer :: ends(2), used, i, k

      used = 0
      allocate (list(4*size(drawing%m%pairs) + 2*size(drawing%m%links) + size(drawing%m%points)))
      do i = 1, size(drawing%curves)
         call add_path(drawing%curves(i))
      end do
      ! A support under each joint of the ground.
      do i = 1, size(drawing%m%pairs)
         if (has_guide(drawing%m%pairs(i)%kind)) cycle
         ends = [drawing%m%pairs(i)%point_i, drawing%m%pairs(i)%point_j]
         k = findloc(drawing%m%links(drawing%m%points(ends)%link)%ground, .true., dim=1)
         if (k == 0) cycle
         place = spread(point_place(drawing%m, drawing%now, ends(k)), 2, 3)
         call add(0, 'polygon', 'class="support"', place, support, box)
         call add(0, 'polyline', 'class="hatch"', place(:, :2), base - spread([0.0_wp, below], 2, 2), box, below)
         call add(0, 'polyline', 'class="support"', place(:, :2), base)
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
      do i = 1, size(drawing%m%links)
         if (drawing%m%links(i)%ground) cycle
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
            if (drawing%m%links(g%block)%hidden .or. g%is_cylinder) cycle
            u = half_block(1)*direction(g%block_angle)
            v = half_block(2)*quarter_turn(direction(g%block_angle))
            call add(g%block, 'polygon', 'class="block" style="fill:' &
               //merge(ground_block, color_of(g%block), drawing%m%links(g%block)%ground)//'"', &
               spread(drawing%m%points(g%point)%offset, 2, 4), reshape([v - u, u + v, u - v, -u - v], [2, 4]), box, &
               is_faint=.true.)
         end associate
      end do
      do i = 1, size(drawing%m%pairs)
         ends = [drawing%m%pairs(i)%point_i, drawing%m%pairs(i)%point_j]
         associate (links => drawing%m%links(drawing%m%points(ends)%link))
            k = ends(maxloc(merge(0, merge(1, 1 + drawing%m%points(ends)%link, links%ground), links%hidden), dim=1))
         end associate
         if (.not. has_guide(drawing%m%pairs(i)%kind)) call add(drawing%m%points(k)%link, 'circle', &
            'class="joint" '//attribute('data-pair', trim(drawing%m%pairs(i)%name)), &
               spread(drawing%m%points(k)%offset, 2, 1), &
            weight=box, radius=joint_radius)
      end do
      is_dot = .not. drawing%m%links(drawing%m%points%link)%ground
      is_dot([drawing%m%pairs%point_i, drawing%m%pairs%point_j]) = .false.
      do i = 1, size(is_dot)
         if (is_dot(i)) call add(drawing%m%points(i)%link, 'circle', &
            'class="point" '//attribute('data-point', trim(drawing%m%points(i)%name)), &
               spread(drawing%m%points(i)%offset, 2, 1), &
            weight=box, radius=point_radius)
      end do
      list = list(:used)

   contains

      !> Adds an `element` of SVG that moves with `link`.
      subroutine add(link, element, attributes, p, pixels, weight, radius, is_faint)
         integer, intent(in) :: link
         character(*), intent(in) :: element, attributes
         real(wp), intent(in) :: p(:, :)
         real(wp), intent(in), optional :: pixels(:, :), weight, radius
         logical, intent(in), optional :: is_faint

         used = used + 1
         if (used > size(list)) list = [list, list]
         list(used) = element_t(element=element, attributes=attributes, link=link, p=p, add=0.0_wp*p)
         if (present(pixels)) list(used)%add = pixels
         if (present(weight)) list(used)%weight = weight
         if (present(radius)) list(used)%radius = radius
         if (present(is_faint)) list(used)%is_faint = is_faint
      end subroutine add

      !> Adds the pieces of a line through the places `p` (2, :), which go from each place that `goes_on` to the next;
      !> none where they stay at one place, as does the pole of two links that a joint holds together.
      subroutine add_pieces(link, element, attributes, p, goes_on)
         integer, intent(in) :: link
         character(*), intent(in) :: element, attributes
         real(wp), intent(in) :: p(:, :)
         logical, intent(in) :: goes_on(:)
         integer :: first, last

         if (.not. any(goes_on)) return
         associate (on => spread(goes_on .or. eoshift(goes_on, -1), 1, 2))
            if (all(maxval(p, 2, on) - minval(p, 2, on) < one_place*characteristic_length(drawing%m))) return
         end associate
         first = 1
         do last = 1, size(goes_on)
            if (goes_on(last)) cycle
            if (last > first) call add(link, element, attributes, p(:, first:last), weight=curve_weight)
            first = last + 1
         end do
      end subroutine add_pieces

      !> Adds the path of point number `i` through the frames, in pieces where its place is not known.
      subroutine add_path(i)
         integer, intent(in) :: i
         real(wp) :: p(2, drawing%films)
         logical :: known(drawing%films)
         integer :: k

         do k = 1, drawing%films
            known(k) = drawing%frame(k)%known(drawing%m%points(i)%link)
            p(:, k) = point_place(drawing%m, drawing%frame(k), i)
         end do
         call add_pieces(0, 'polyline', 'class="curve" '//attribute('data-path', trim(drawing%m%points(i)%name)) &
            //' style="stroke:'//color_of(drawing%m%points(i)%link)//'"', p, known .and. eoshift(known, 1))
      end subroutine add_path

      !> Adds the `guide`: a line over the range of the slide. The ground's has a hatch. That of a moving link is a
      !> rod that begins where the perpendicular from its pivot meets it, if that can be seen.
      subroutine add_guide(guide)
         type(guide_t), intent(in) :: guide
         real(wp), allocatable :: p(:, :), pixels(:, :)
         real(wp) :: e(2), beside(2), further

         e = direction(guide%angle)
         further = merge(beyond_pin, beyond, drawing%m%links(guide%block)%hidden)
         if (drawing%m%links(guide%carrier)%ground) then
            p = reshape([guide%foot + guide%low*e, guide%foot + guide%high*e], [2, 2])
            pixels = reshape([-further*e, further*e], [2, 2])
            ! A vertical one has it on the right, whatever rounding makes of its cosine.
            beside = -sign(below, cos(drawing%now%place(3, guide%carrier) + guide%angle) + one_place)*quarter_turn(e)
            call add(guide%carrier, 'polyline', 'class="hatch"', p, pixels + spread(beside, 2, 2), line_weight)
            call add(guide%carrier, 'polyline', 'class="guide"', p, pixels, line_weight)
         else
            beside = drawing%m%points(guide%pivot)%offset - guide%foot
            p = reshape([guide%foot + min(guide%low, 0.0_wp)*e, guide%foot + max(guide%high, 0.0_wp)*e], [2, 2])
            pixels = reshape([min(scale*max(guide%low, 0.0_wp) - further, 0.0_wp)*e, &
               max(scale*min(guide%high, 0.0_wp) + further, 0.0_wp)*e], [2, 2])
            if (scale*norm2(beside) > 1.0_wp) then
               p = reshape([p(:, 1), guide%foot, guide%foot + beside, guide%foot, p(:, 2)], [2, 5])
               pixels = reshape([pixels(:, 1), 0.0_wp*[beside, beside, beside], pixels(:, 2)], [2, 5])
            end if
            call add(guide%carrier, 'polyline', 'class="rod" style="stroke:'//color_of(guide%carrier)//'"', p, pixels, &
               line_weight, is_faint=.true.)
            call add(guide%carrier, 'polyline', 'class="slot"', p, pixels)
         end if
      end subroutine add_guide

      !> Adds the cylinder of the `guide`: a rod from Q, and over it a barrel from P.
      subroutine add_cylinder(guide)
         type(guide_t), intent(in) :: guide
         real(wp) :: e(2), aside(2), least

         least = max(guide%low, 0.0_wp)
         e = direction(guide%block_angle)
         associate (q => drawing%m%points(guide%point)%offset)
            call add(guide%block, 'polyline', 'class="piston" style="stroke:'//link_color(drawing%m, guide%block) &
               //'"', &
               reshape([q, q - of_piston*least*e], [2, 2]), weight=line_weight, is_faint=.true.)
         end associate
         e = direction(guide%angle)
         aside = half_barrel*quarter_turn(e)
         associate (p => drawing%m%points(guide%pivot)%offset)
            call add(guide%carrier, 'polygon', 'class="barrel" style="stroke:'//link_color(drawing%m, guide%carrier) &
               //'"', &
               reshape([p, p, p + of_barrel*least*e, p + of_barrel*least*e], [2, 4]), &
               reshape([aside, -aside, -aside, aside], [2, 4]), weight=line_weight, is_faint=.true.)
         end associate
      end subroutine add_cylinder

      !> Adds the centrode of pole number `i` in its link number `side`, 1 or 2, as it lies in that link: the two touch
      !> at the instant centre. It may run to infinity, and the picture shows its part of it. Where the sense of the
      !> relative turn changes, the centre has passed through infinity. A place that is `far` is not drawn.
      subroutine add_centrode(i, side)
         integer, intent(in) :: i, side
         character(:), allocatable :: attributes
         real(wp) :: p(2, drawing%films)
         real(wp) :: turn(drawing%films)                        ! the rate of the second link from the first
         logical :: goes_on(drawing%films)                      ! the next place is on the same piece
         integer :: links(2), k

         associate (pole => drawing%m%requests(drawing%poles(i)))
            links = [pole%second, pole%subject]
         end associate
         do k = 1, drawing%films
            associate (now => drawing%frame(k), place => drawing%frame(k)%place(:, links(side)))
               p(:, k) = rotated(now%centre(:, i) - place(:2), direction(-place(3)))
               turn(k) = now%rate(links(2)) - now%rate(links(1))
               goes_on(k) = now%has_centre(i)
            end associate
         end do
         goes_on = goes_on .and. all(abs(p) < far*characteristic_length(drawing%m), dim=1)
         goes_on = goes_on .and. eoshift(goes_on, 1) .and. ((turn > 0.0_wp) .eqv. (eoshift(turn, 1) > 0.0_wp))
         attributes = 'class="centrode" '//attribute('data-centrode', pole_name(drawing%m, drawing%poles(i)))//' '// &
            attribute('data-link', trim(drawing%m%links(links(side))%name))//' style="stroke:' &
            //link_color(drawing%m, links(side))//'"'
         call add_pieces(links(side), 'centrode', attributes, p, goes_on)
      end subroutine add_centrode
   end function shapes_of

   !> The color of link number `i`.
   pure function color_of(i) result(color)
      integer, intent(in) :: i
      character(len(colors)) :: color

      color = colors(1 + modulo(i - 1, size(colors)))
   end function color_of

   !> The color of what belongs to link number `i`, which may be of the ground.
   pure function link_color(m, i) result(color)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      character(:), allocatable :: color

      color = ground_color
      if (.not. m%links(i)%ground) color = color_of(i)
   end function link_color

   !> The names of both links of the pole that is request number `i`.
   pure function pole_name(m, i) result(name)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      character(:), allocatable :: name

      name = trim(m%links(m%requests(i)%second)%name)//'-'//trim(m%links(m%requests(i)%subject)%name)
   end function pole_name
end module shapes
