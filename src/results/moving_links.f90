!> The moving links of an animation: each is a group that is moved and turned through the frames of a drawing (SMIL).
!> The browser interpolates between two frames, place and angle evenly. Centrodes move with their links, and a ring at
!> each instant centre.
module moving_links
   use kinds, only: wp
   use grouping, only: sorted_t, sorted, sorted_numbers
   use planar, only: in_degrees, without_turns, point_of
   use drawing, only: drawing_t
   use canvas, only: canvas_t, make_canvas, to_pixels
   use picture_parts, only: put_body, put_guide, put_block, put_joint, put_dot, dots_of
   use picture_centrodes, only: put_centrodes, put_ring, pair_name
   use picture_page, only: fitted, width
   use svg, only: put_group, put_end, put_values, pixels, attribute, translation
   use text_output, only: output_t
   implicit none
   private
   public :: course_t, put_moving, put_moving_links, put_moving_centres

   !> How the frames follow one another.
   type :: course_t
      integer, allocatable :: frame(:)       !< (keys) at equal steps of time
      real(wp) :: seconds = 0.0_wp           !< from the first to the last
      logical :: smooth = .true.             !< there are positions between them
   end type course_t

   !> What of a group is animated.
   character(*), parameter :: turn = 'animateTransform attributeName="transform" type="rotate"', &
      opacity = 'animate attributeName="opacity"'
   character(*), parameter, public :: shift = 'animateTransform attributeName="transform" type="translate"'
   !> What is seen of a link where it has no position; it stays where it was.
   real(wp), parameter :: pale = 0.2_wp

   !> What moves with each link. It is found once for all links: time is proportional to them.
   !> Of what belongs to link i there are the numbers member(first(i):first(i + 1) - 1).
   type :: cargo_t
      type(sorted_t) :: joints               !< pairs
      type(sorted_t) :: rods, blocks         !< guides
      type(sorted_t) :: dots                 !< points
      integer, allocatable :: joint_at(:)    !< (pairs) the point of the link with which the joint moves
      type(canvas_t) :: own                  !< for each link in turn, in its own axes
   end type cargo_t

contains

   !> All moving links.
   subroutine put_moving_links(c, course)
      type(canvas_t), intent(in) :: c
      type(course_t), intent(in) :: course
      type(cargo_t) :: cargo
      integer :: order(size(c%m%links)), i

      order = order_of(c%d)
      call find_cargo(c, order, cargo)
      do i = 1, size(order)
         call put_link(c, course, cargo, order(i))
      end do
   end subroutine put_moving_links

   !> The links in the order in which they are drawn: polygons, bars and rods, what is a single point, such as a block.
   function order_of(d) result(order)
      type(drawing_t), intent(in) :: d
      integer, allocatable :: order(:)
      type(sorted_t) :: by_corners
      integer :: corners(size(d%outlines)), i

      corners = [(min(3, size(d%outlines(i)%corner, 2)), i=1, size(corners))]
      do i = 1, size(d%guides)
         corners(d%guides(i)%carrier) = max(2, corners(d%guides(i)%carrier))
      end do
      by_corners = sorted(4 - corners, 4)
      order = by_corners%member
   end function order_of

   !> What moves with each of the links, which are drawn in `order`: a joint moves with the later one of its links.
   subroutine find_cargo(c, order, cargo)
      type(canvas_t), intent(in) :: c
      integer, intent(in) :: order(:)
      type(cargo_t), intent(out) :: cargo
      integer, allocatable :: dots(:)
      integer :: rank(size(c%m%links)), i

      rank(order) = [(i, i=1, size(order))]
      where (c%m%links%ground) rank = 0
      cargo%joint_at = c%m%pairs%point_i
      do i = 1, size(c%m%pairs)
         if (rank(c%m%points(c%m%pairs(i)%point_j)%link) > rank(c%m%points(c%m%pairs(i)%point_i)%link)) &
            cargo%joint_at(i) = c%m%pairs(i)%point_j
      end do
      cargo%joints = sorted(c%m%points(cargo%joint_at)%link, size(c%m%links))
      cargo%rods = sorted(c%d%guides%carrier, size(c%m%links))
      cargo%blocks = sorted(c%d%guides%block, size(c%m%links))
      dots = dots_of(c%m)
      cargo%dots = sorted_numbers(dots, c%m%points(dots)%link, size(c%m%links))
      call make_canvas(c%o, c%d, cargo%own)
      cargo%own%scale = c%scale
      cargo%own%s%place = 0.0_wp
      cargo%own%s%known = .true.
   end subroutine find_cargo

   !> The moving `link` with what it carries. It turns about a corner of its own: its origin may be far away.
   subroutine put_link(c, course, cargo, link)
      type(canvas_t), intent(in) :: c
      type(course_t), intent(in) :: course
      type(cargo_t), intent(inout) :: cargo
      integer, intent(in) :: link
      real(wp) :: place(2, size(course%frame)), angle(1, size(course%frame)), position(3), turned
      integer :: k, last

      if (c%m%links(link)%ground .or. size(c%d%outlines(link)%corner, 2) == 0) return
      last = findloc([(c%d%frame(k)%known(link), k=1, c%d%frames)], .true., dim=1)
      if (last == 0) return
      turned = 0.0_wp
      do k = 1, size(course%frame)
         if (c%d%frame(course%frame(k))%known(link)) last = course%frame(k)
         position = c%d%frame(last)%place(:, link)
         place(:, k) = to_pixels(c, point_of(position, c%d%outlines(link)%corner(:, 1)))
         turned = turned + without_turns(position(3) - turned)
         angle(1, k) = turned
      end do
      angle = -in_degrees(angle)
      call put_group(c%o, 'class="link" '//attribute('data-link', trim(c%m%links(link)%name))//' ' &
         //translation(place(:, 1)), trim(c%m%links(link)%name))
      call put_moving(c%o, course, shift, place, course%smooth)
      call put_opacity(c%o, course, [(c%d%frame(course%frame(k))%known(link), k=1, size(course%frame))], pale)
      call put_group(c%o, 'transform="rotate('//pixels(angle(1, 1))//')"', '')
      call put_moving(c%o, course, turn, angle, course%smooth)
      call put_carried(cargo, link)
      call put_end(c%o, 'g')
      call put_end(c%o, 'g')
   end subroutine put_link

   !> The `link` in its own axes, in pixels from its first corner: guides, body, blocks, joints and other points.
   subroutine put_carried(cargo, link)
      type(cargo_t), intent(inout) :: cargo
      integer, intent(in) :: link
      integer :: i, k

      associate (c => cargo%own)
         c%shift = -c%scale*c%d%outlines(link)%corner(:, 1)*[1.0_wp, -1.0_wp]
         c%low = -real(width, wp)
         c%high = real(width, wp)
         ! No name stands on it.
         c%lines = 0
         c%boxes = 0
         do i = cargo%rods%first(link), cargo%rods%first(link + 1) - 1
            call put_guide(c, c%d%guides(cargo%rods%member(i)))
         end do
         call put_centrodes(c, link)
         call put_body(c, link)
         do i = cargo%blocks%first(link), cargo%blocks%first(link + 1) - 1
            call put_block(c, c%d%guides(cargo%blocks%member(i)))
         end do
         do i = cargo%joints%first(link), cargo%joints%first(link + 1) - 1
            k = cargo%joints%member(i)
            call put_joint(c, k, cargo%joint_at(k))
         end do
         do i = cargo%dots%first(link), cargo%dots%first(link + 1) - 1
            call put_dot(c, cargo%dots%member(i))
         end do
      end associate
   end subroutine put_carried

   !> A ring at each instant centre, none where this is at infinity or leaves the picture.
   subroutine put_moving_centres(c, course)
      type(canvas_t), intent(in) :: c
      type(course_t), intent(in) :: course
      real(wp) :: place(2, 0:size(course%frame))
      logical :: is_there(size(course%frame))
      character(:), allocatable :: name
      integer :: i, k

      do i = 1, size(c%d%centrodes)
         place(:, 0) = c%low
         do k = 1, size(course%frame)
            associate (s => c%d%frame(course%frame(k)))
               place(:, k) = to_pixels(c, s%centre(:, i))
               is_there(k) = s%has_centre(i) .and. all(place(:, k) >= c%low .and. place(:, k) <= c%high)
            end associate
            if (.not. is_there(k)) place(:, k) = place(:, k - 1)
         end do
         if (.not. any(is_there)) cycle
         name = pair_name(c%m, c%d%centrodes(i))
         call put_group(c%o, attribute('data-pole', name)//' '//translation(place(:, 1)), name)
         call put_moving(c%o, course, shift, place(:, 1:), course%smooth)
         call put_opacity(c%o, course, is_there, 0.0_wp)
         call put_ring(c, i, [0.0_wp, 0.0_wp])
         call put_end(c%o, 'g')
      end do
   end subroutine put_moving_centres

   !> An animated attribute: `values` (:, keys) in turn, with what is between them if `smooth`.
   subroutine put_moving(o, course, element, values, smooth)
      type(output_t), intent(inout) :: o
      type(course_t), intent(in) :: course
      character(*), intent(in) :: element
      real(wp), intent(in) :: values(:, :)
      logical, intent(in) :: smooth
      character(:), allocatable :: mode

      if (size(values, 2) < 2) return
      mode = 'linear'
      if (.not. smooth) mode = 'discrete'
      call put_values(o, element//' calcMode="'//mode//'" dur="'//fitted(course%seconds) &
         //'s" repeatCount="indefinite"', values)
   end subroutine put_moving

   !> Shows a group by this opacity `elsewhere` than at the keys where it `is_there` (keys).
   subroutine put_opacity(o, course, is_there, elsewhere)
      type(output_t), intent(inout) :: o
      type(course_t), intent(in) :: course
      logical, intent(in) :: is_there(:)
      real(wp), intent(in) :: elsewhere

      if (.not. all(is_there)) call put_moving(o, course, opacity, &
         reshape(merge(1.0_wp, elsewhere, is_there), [1, size(is_there)]), .false.)
   end subroutine put_opacity
end module moving_links
