!> The moving links of an animation: each is a group that is moved and turned through the frames of a drawing (SMIL).
!> The browser interpolates between two frames, place and angle evenly.
module moving_links
   use kinds, only: wp
   use constants, only: in_degrees, without_turns
   use mechanism, only: mechanism_t
   use grouping, only: sorted_t, sorted
   use planar, only: point_of
   use drawing, only: drawing_t, snapshot_t
   use canvas, only: canvas_t, to_pixels
   use picture_parts, only: put_body, put_guide, put_block, put_joint, put_dot, dots_of
   use picture_page, only: fitted
   use svg, only: put_group, put_group_end, put_values, pixels, attribute
   use text_output, only: output_t
   implicit none
   private
   public :: course_t, put_moving, put_moving_links

   !> How the frames follow one another.
   type :: course_t
      integer, allocatable :: frame(:)       !< (keys) at equal steps of time
      real(wp) :: seconds = 0.0_wp           !< from the first to the last
      logical :: smooth = .true.             !< there are positions between them
   end type course_t

   !> What is seen of a link where it has no position; it stays where it was.
   real(wp), parameter :: pale = 0.2_wp

   !> What moves with each link. It is found once for all links: time is proportional to them.
   !> Of what belongs to link i there are the numbers member(first(i):first(i + 1) - 1).
   type :: cargo_t
      type(sorted_t) :: joints               !< pairs
      type(sorted_t) :: rods, blocks         !< guides
      type(sorted_t) :: dots                 !< points
      integer, allocatable :: joint_at(:)    !< (pairs) the point of the link with which the joint moves
      type(snapshot_t) :: rest               !< all links in their own axes
   end type cargo_t

contains

   !> All moving links of `m`.
   subroutine put_moving_links(o, c, m, d, course)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(in) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(course_t), intent(in) :: course
      type(cargo_t) :: cargo
      integer :: order(size(m%links)), i

      order = order_of(d)
      call find_cargo(m, d, order, cargo)
      do i = 1, size(order)
         call put_link(o, c, m, d, course, cargo, order(i))
      end do
   end subroutine put_moving_links

   !> The links in the order in which they are drawn: polygons, bars and rods, what is a single point, such as a block.
   function order_of(d) result(order)
      type(drawing_t), intent(in) :: d
      integer :: order(size(d%outlines)), corners(size(d%outlines)), i, k, n

      corners = [(min(3, size(d%outlines(i)%corner, 2)), i=1, size(corners))]
      do i = 1, size(d%guides)
         corners(d%guides(i)%carrier) = max(2, corners(d%guides(i)%carrier))
      end do
      n = 0
      do k = 3, 0, -1
         do i = 1, size(order)
            if (corners(i) /= k) cycle
            n = n + 1
            order(n) = i
         end do
      end do
   end function order_of

   !> What moves with each link of `m`, which are drawn in `order`: a joint moves with the later one of its links.
   subroutine find_cargo(m, d, order, cargo)
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: order(:)
      type(cargo_t), intent(out) :: cargo
      integer :: rank(size(m%links)), owner(size(m%points)), i

      rank(order) = [(i, i=1, size(order))]
      where (m%links%ground) rank = 0
      cargo%joint_at = m%pairs%point_i
      do i = 1, size(m%pairs)
         if (rank(m%points(m%pairs(i)%point_j)%link) > rank(m%points(m%pairs(i)%point_i)%link)) &
            cargo%joint_at(i) = m%pairs(i)%point_j
      end do
      cargo%joints = sorted(m%points(cargo%joint_at)%link, size(m%links))
      cargo%rods = sorted(d%guides%carrier, size(m%links))
      cargo%blocks = sorted(d%guides%block, size(m%links))
      owner = 0
      owner(dots_of(m)) = m%points(dots_of(m))%link
      cargo%dots = sorted(owner, size(m%links))
      allocate (cargo%rest%place(3, size(m%links)), source=0.0_wp)
      allocate (cargo%rest%known(size(m%links)), source=.true.)
   end subroutine find_cargo

   !> The moving `link` with what it carries. It turns about a corner of its own: its origin may be far away.
   subroutine put_link(o, c, m, d, course, cargo, link)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(in) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(course_t), intent(in) :: course
      type(cargo_t), intent(in) :: cargo
      integer, intent(in) :: link
      real(wp) :: place(2, size(course%frame)), angle(1, size(course%frame)), position(3), turned
      integer :: k, last

      if (m%links(link)%ground .or. size(d%outlines(link)%corner, 2) == 0) return
      last = findloc([(d%frame(k)%known(link), k=1, d%frames)], .true., dim=1)
      if (last == 0) return
      turned = 0.0_wp
      do k = 1, size(course%frame)
         if (d%frame(course%frame(k))%known(link)) last = course%frame(k)
         position = d%frame(last)%place(:, link)
         place(:, k) = to_pixels(c, point_of(position, d%outlines(link)%corner(:, 1)))
         turned = turned + without_turns(position(3) - turned)
         angle(1, k) = turned
      end do
      angle = -in_degrees(angle)
      call put_group(o, 'class="link" '//attribute('data-link', trim(m%links(link)%name))//' transform="translate(' &
         //pixels(place(1, 1))//' '//pixels(place(2, 1))//')"', trim(m%links(link)%name))
      call put_moving(o, course, 'animateTransform attributeName="transform" type="translate"', place, course%smooth)
      call put_opacity(o, d, course, link)
      call put_group(o, 'transform="rotate('//pixels(angle(1, 1))//')"', '')
      call put_moving(o, course, 'animateTransform attributeName="transform" type="rotate"', angle, course%smooth)
      call put_carried(o, c, m, d, cargo, link)
      call put_group_end(o)
      call put_group_end(o)
   end subroutine put_link

   !> The `link` in its own axes, in pixels from its first corner: guides, body, blocks, joints and other points.
   subroutine put_carried(o, c, m, d, cargo, link)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(in) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(cargo_t), intent(in) :: cargo
      integer, intent(in) :: link
      type(canvas_t) :: own
      integer :: i, k

      own%scale = c%scale
      own%shift = -c%scale*d%outlines(link)%corner(:, 1)*[1.0_wp, -1.0_wp]
      do i = cargo%rods%first(link), cargo%rods%first(link + 1) - 1
         call put_guide(o, own, m, d%guides(cargo%rods%member(i)), cargo%rest)
      end do
      call put_body(o, own, m, d, cargo%rest, link)
      do i = cargo%blocks%first(link), cargo%blocks%first(link + 1) - 1
         call put_block(o, own, m, d%guides(cargo%blocks%member(i)), cargo%rest)
      end do
      do i = cargo%joints%first(link), cargo%joints%first(link + 1) - 1
         k = cargo%joints%member(i)
         call put_joint(o, own, m, cargo%rest, k, cargo%joint_at(k))
      end do
      do i = cargo%dots%first(link), cargo%dots%first(link + 1) - 1
         call put_dot(o, own, m, cargo%rest, cargo%dots%member(i))
      end do
   end subroutine put_carried

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

   !> Makes `link` pale where it has no position.
   subroutine put_opacity(o, d, course, link)
      type(output_t), intent(inout) :: o
      type(drawing_t), intent(in) :: d
      type(course_t), intent(in) :: course
      integer, intent(in) :: link
      real(wp) :: opacity(1, size(course%frame))
      integer :: k

      do k = 1, size(course%frame)
         opacity(1, k) = merge(1.0_wp, pale, d%frame(course%frame(k))%known(link))
      end do
      if (any(opacity < 1.0_wp)) call put_moving(o, course, 'animate attributeName="opacity"', opacity, .false.)
   end subroutine put_opacity
end module moving_links
