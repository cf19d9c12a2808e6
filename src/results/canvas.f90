!> The canvas of a set: its part of a page, from the mechanism's places to pixels; what is drawn already, and where a
!> name is clear of it; and what stands around the mechanism: title, flagged instants, scale.
module canvas
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use planar, only: direction, rotated
   use numerals, only: full, whole
   use drawing, only: drawing_t, snapshot_t, point_place, point_velocity, joint_point, moved
   use shapes, only: element_t, shapes_of, color_of, link_color, box
   use svg, only: page_t, width, put_words, put_circle, put_line, put_hatch, hatch_length, put_curve, put_group, &
      put_end, attribute, fitted
   use text_output, only: output_t
   use listing, only: words_of_mark
   use phrases
   implicit none
   private
   public :: canvas_t, make_canvas, flag_lines, to_pixels, put_shape, put_outlines, put_traces, put_ring, put_name
   public :: put_foot, add_line, add_lines, cover_of

   !> What a set is drawn on. A place p of the drawing is at shift + scale (x, -y) in pixels.
   type :: canvas_t
      type(output_t), pointer :: o => null()      !< where it is written
      type(drawing_t), pointer :: d => null()     !< what is recorded of the set
      type(mechanism_t), pointer :: m => null()   !< the set
      type(snapshot_t) :: s                  !< the position that is drawn in full
      integer, allocatable :: paths(:)       !< the numbers of points whose paths are drawn
      integer :: bottom = 0                  !< the pixel above which it ends
      real(wp) :: scale = 1.0_wp             !< pixels in a unit of length
      real(wp) :: shift(2) = 0.0_wp
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp   !< the mechanism and its names stay between these
      integer :: lines = 0
      !> (5, lines or more) x, y of both ends, weight; below 0 a box, of its upper left and its lower right corner
      real(wp), allocatable :: line(:, :)
   end type canvas_t

   !> Room around what is drawn, for names and supports; largest and least height of what is drawn.
   real(wp), parameter :: margin = 62.0_wp, max_height = 520.0_wp, min_height = 60.0_wp
   !> Room above for the title and below for times and scale; height of a line of words.
   integer, parameter :: above = 34, below = 44
   integer, parameter, public :: line_height = 17
   !> By this part of its larger side a mechanism's picture is wider on each side, at most, for centrodes.
   real(wp), parameter :: centrode_room = 0.4_wp
   !> Places of a path that differ by no more than this part of its extent are one.
   real(wp), parameter :: same_place = 1.0e-6_wp
   !> The rings of an instant centre and of a joint at a flagged position.
   real(wp), parameter, public :: centre_radius = 4.0_wp
   real(wp), parameter :: ring_radius = 8.0_wp
   !> The length of the scale bar, at most.
   real(wp), parameter :: max_bar = 150.0_wp

   !> Size of the letters of a name: mean width and height of capitals, in pixels.
   real(wp), parameter :: letter_width = 8.7_wp, letter_height = 9.0_wp
   !> The distances of a name from its place, in pixels, and what a pixel of distance counts against a pixel of overlap.
   real(wp), parameter :: distances(*) = [9.0_wp, 14.0_wp, 21.0_wp, 30.0_wp, 42.0_wp]
   real(wp), parameter :: distance_weight = 0.25_wp
   !> What a name over a name counts, and one that leaves the picture, in pixels of overlap with a line.
   real(wp), parameter :: over_name = 60.0_wp, outside = 500.0_wp
   !> Pixels, and overlaps of this many of them, that differ by no more are the same: rounding errors do not choose.
   real(wp), parameter, public :: tie = 1.0e-6_wp
   !> Lines that are closer than this, in pixels, are hard to tell apart.
   real(wp), parameter :: near = 4.0_wp
   !> The control points of a cubic of a path are no farther from its ends than this part of the distance of its ends,
   !> as in half a turn of a circle. Farther ones would draw loops that are not there.
   real(wp), parameter :: max_control = 0.6_wp
   !> A cubic may be so far from a place of its path, in pixels.
   real(wp), parameter :: off_path = 0.05_wp
   !> The weight of a path against that of a bar, for names.
   real(wp), parameter :: path_weight = 0.4_wp

contains

   !> Makes the canvas `c` of the drawing `d` at the end of the `page`, and begins it with the title. It shows the
   !> position `s` in full, and has room for the links at the frames `others`.
   !>
   !> The scale has three digits, the height is even and the shift whole: rounding errors of the results do not move the
   !> picture, and none of these is near a tie for what is symmetric or has few digits.
   subroutine make_canvas(page, d, s, others, c)
      type(page_t), intent(inout), target :: page
      type(drawing_t), intent(in), target :: d
      type(snapshot_t), intent(in) :: s
      integer, intent(in) :: others(:)
      type(canvas_t), intent(out) :: c
      type(element_t), allocatable :: list(:)
      real(wp) :: low(2), high(2), from(2), to(2)    ! what is drawn; it must not go beyond the latter
      real(wp) :: room, power
      integer :: height, top, e, i, k

      c%o => page%body
      c%d => d
      c%m => d%m
      c%s = s
      c%paths = paths_of(d)

      ! What is drawn: all shapes at the position in full, links at the others, paths; and centrodes, which may run to
      ! infinity, as far as the picture is wider by `centrode_room` on all sides at most.
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      from = -huge(1.0_wp)
      to = huge(1.0_wp)
      list = shapes_of(d, spread(.true., 1, size(d%m%links)), 1.0_wp)
      do i = 1, size(list)
         if (list(i)%element == 'centrode') cycle
         call widen(places_of(list(i), s))
         if (list(i)%is_below) cycle
         do k = 1, size(others)
            call widen(places_of(list(i), d%frame(others(k))))
         end do
         do k = 1, size(d%flags)
            call widen(places_of(list(i), d%flags(k)%last))
         end do
      end do
      do i = 1, size(c%paths)
         do k = 1, d%films
            if (d%frame(k)%known(d%m%points(c%paths(i))%link)) &
               call widen(reshape(point_place(d%m, d%frame(k), c%paths(i)), [2, 1]))
         end do
      end do
      if (.not. all(low <= high)) then
         low = 0.0_wp
         high = 0.0_wp
      end if
      room = centrode_room*maxval(high - low)
      from = low - room
      to = high + room
      do k = 1, size(d%poles)
         if (s%has_centre(k)) call widen(s%centre(:, k:k))
      end do
      do i = 1, size(list)
         if (list(i)%element == 'centrode') call widen(places_of(list(i), s))
      end do

      associate (extent => high - low)
         room = real(width, wp) - 2.0_wp*margin
         if (any(extent > 0.0_wp)) then
            c%scale = 1.0_wp/max(extent(1)/room, extent(2)/max_height)
            e = 2 - floor(log10(c%scale))
            power = 10.0_wp**abs(e)
            c%scale = c%scale*(1.0_wp + tie)
            if (e >= 0) c%scale = aint(c%scale*power)/power
            if (e < 0) c%scale = aint(c%scale/power)*power
         end if
         height = 2*ceiling(0.5_wp*max(min_height, c%scale*extent(2)) + margin - tie)
         top = page%height
         c%bottom = top + above + height + below + line_height*flag_lines(d)
         page%height = c%bottom
         c%shift = anint([0.5_wp*real(width, wp) - c%scale*(low(1) + 0.5_wp*extent(1)), &
            real(top + above, wp) + 0.5_wp*real(height, wp) + c%scale*(low(2) + 0.5_wp*extent(2))])
      end associate
      c%low = [4.0_wp, real(top + above, wp)]
      c%high = [real(width - 4, wp), real(top + above + height, wp)]

      call put_group(c%o, 'class="set" data-set="'//whole(c%m%set_number)//'" data-scale="'//full(c%scale) &
         //'" data-x="'//fitted(c%shift(1))//'" data-y="'//fitted(c%shift(2)) &
         //'" data-origin="'//full(d%origin(1))//' '//full(d%origin(2))//'" data-t="'//full(s%t)//'"', trim(c%m%title))
      call put_words(c%o, real([14, top + 24], wp), 'start', 'class="title"', &
         trim(whole(c%m%set_number)//'.  '//c%m%title))

   contains

      !> Widens what is drawn by the places `p` (2, :).
      subroutine widen(p)
         real(wp), intent(in) :: p(:, :)
         integer :: j

         do j = 1, size(p, 2)
            if (any(p(:, j) < from) .or. any(p(:, j) > to)) cycle
            low = min(low, p(:, j))
            high = max(high, p(:, j))
         end do
      end subroutine widen
   end subroutine make_canvas

   !> The places (2, :) of `shape` at the position `s`; none where its link has no position there.
   pure function places_of(shape, s) result(p)
      type(element_t), intent(in) :: shape
      type(snapshot_t), intent(in) :: s
      real(wp), allocatable :: p(:, :)

      p = shape%p
      if (shape%link == 0) return
      p = moved(p, s%place(:, shape%link))
      if (.not. s%known(shape%link)) p = p(:, :0)
   end function places_of

   !> The points whose paths are drawn: those that move; of several with the same path the first.
   pure function paths_of(d) result(list)
      type(drawing_t), intent(in) :: d
      integer, allocatable :: list(:)
      real(wp) :: p(2, d%films, size(d%curves)), extent
      integer :: i, j, k, first

      allocate (list(0))
      p = 0.0_wp
      do i = 1, size(d%curves)
         associate (known => [(d%frame(k)%known(d%m%points(d%curves(i))%link), k=1, d%films)])
            first = findloc(known, .true., dim=1)
            if (first == 0) cycle
            do k = 1, d%films
               p(:, k, i) = point_place(d%m, d%frame(merge(k, first, known(k))), d%curves(i))
            end do
         end associate
         extent = maxval(abs(p(:, :, i)))
         if (all(abs(p(:, :, i) - spread(p(:, first, i), 2, d%films)) <= same_place*extent)) cycle
         if (any([(all(abs(p(:, :, j) - p(:, :, i)) <= same_place*extent), j=1, i - 1)])) cycle
         list = [list, d%curves(i)]
      end do
   end function paths_of

   !> The pixel (2) of the place `p` (2), which is counted from the drawing's origin.
   pure function to_pixels(c, p) result(q)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: p(2)
      real(wp) :: q(2)

      q = c%shift + c%scale*[p(1), -p(2)]
   end function to_pixels

   !> Draws `shape` at the position that the canvas shows, unless its link is not known there, and notes what names
   !> should keep clear of.
   subroutine put_shape(c, shape)
      type(canvas_t), intent(inout) :: c
      type(element_t), intent(in) :: shape
      real(wp), allocatable :: q(:, :)
      real(wp) :: e(2)
      integer :: k

      e = [1.0_wp, 0.0_wp]
      if (shape%link > 0) e = direction(c%s%place(3, shape%link))
      q = places_of(shape, c%s)
      if (size(q) == 0) return
      do k = 1, size(q, 2)
         q(:, k) = to_pixels(c, q(:, k)) + rotated(shape%add(:, k), e)*[1.0_wp, -1.0_wp]
      end do

      select case (shape%element)
      case ('circle')
         call put_circle(c%o, q(:, 1), shape%radius, shape%attributes)
      case ('hatch')
         call put_hatch(c%o, q(:, 1), q(:, 2), shape%attributes)
         q(2, 2) = q(2, 2) + hatch_length
      case ('polygon')
         call put_line(c%o, 'polygon', q, shape%attributes, shape%title)
         if (shape%weight > 0.0_wp) q = reshape([q, q(:, 1)], [2, size(q, 2) + 1])
      case default
         call put_line(c%o, 'polyline', q, shape%attributes, shape%title)
      end select
      if (shape%weight < 0.0_wp) then
         call add_line(c, minval(q, dim=2) - shape%radius, maxval(q, dim=2) + shape%radius, box)
      else if (shape%weight > 0.0_wp) then
         call add_lines(c, q, shape%weight)
      end if
   end subroutine put_shape

   !> Draws the moving links as thin lines at the position `s`; names keep clear of them if `counts`.
   subroutine put_outlines(c, s, counts)
      type(canvas_t), intent(inout) :: c
      type(snapshot_t), intent(in) :: s
      logical, intent(in) :: counts
      real(wp), allocatable :: q(:, :)
      integer :: i, k, n

      do i = 1, size(c%m%links)
         n = size(c%d%outlines(i)%corner, 2)
         if (c%m%links(i)%ground .or. .not. s%known(i) .or. n < 2) cycle
         q = moved(c%d%outlines(i)%corner, s%place(:, i))
         do k = 1, n
            q(:, k) = to_pixels(c, q(:, k))
         end do
         call put_line(c%o, trim(merge('polygon ', 'polyline', n > 2)), q, 'class="thin"')
         if (counts) call add_lines(c, reshape([q, q(:, 1)], [2, n + 1]), 1.0_wp)
      end do
   end subroutine put_outlines

   !> Draws the paths of points, and the flagged positions: thin lines, and rings about the joints, which show where the
   !> lines are covered.
   subroutine put_traces(c)
      type(canvas_t), intent(inout) :: c
      integer :: i, k, point

      do i = 1, size(c%paths)
         call put_path(c, c%paths(i))
      end do
      do k = 1, size(c%d%flags)
         associate (s => c%d%flags(k)%last)
            call put_group(c%o, 'class="flagged"', '')
            call put_outlines(c, s, .true.)
            do i = 1, size(c%m%pairs)
               point = joint_point(c%d, s%known, i)
               if (point > 0) &
                  call put_circle(c%o, to_pixels(c, point_place(c%m, s, point)), ring_radius, 'class="ring"')
            end do
            call put_end(c%o, 'g')
         end associate
      end do
   end subroutine put_traces

   !> Draws the path of point number `i` through the frames, in pieces where its place is not known. Each piece is made
   !> of cubics with the velocities at their ends, over as many frames as come near enough.
   subroutine put_path(c, i)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: i
      character(:), allocatable :: name
      real(wp) :: p(2, c%d%films), v(2, c%d%films), t(c%d%films)   ! pixels, and pixels in a unit of time
      real(wp) :: q(2, 3*c%d%films)                                ! ends and control points of cubics
      logical :: known(c%d%films + 1)
      integer :: from, to, k, n

      name = trim(c%m%points(i)%name)
      known = [(c%d%frame(k)%known(c%m%points(i)%link), k=1, c%d%films), .false.]
      do k = 1, c%d%films
         t(k) = c%d%frame(k)%t
         p(:, k) = to_pixels(c, point_place(c%m, c%d%frame(k), i))
         v(:, k) = c%scale*point_velocity(c%m, c%d%frame(k), i)*[1.0_wp, -1.0_wp]
      end do

      call put_group(c%o, attribute('data-path', name), name)
      n = 0
      from = 1
      do while (from <= c%d%films)
         if (n == 0) q(:, 1) = p(:, from)
         if (known(from) .and. known(from + 1)) then
            to = from + 1
            do while (known(to + 1))
               if (.not. comes_near(from, to + 1)) exit
               to = to + 1
            end do
            q(:, n + 1:n + 4) = cubic(from, to)
            n = n + 3
            call add_lines(c, p(:, from:to), path_weight)
            from = to
         else
            if (n > 0) call put_curve(c%o, q(:, :n + 1), &
               'class="curve" style="stroke:'//color_of(c%m%points(i)%link)//'"')
            n = 0
            from = from + 1
         end if
      end do
      call put_end(c%o, 'g')

   contains

      !> The ends and control points (2, 4) of the cubic from frame `k` to frame `l`.
      pure function cubic(k, l) result(b)
         integer, intent(in) :: k, l
         real(wp) :: b(2, 4), arms(2, 2), chord
         integer :: j

         arms = (t(l) - t(k))/3.0_wp*v(:, [k, l])
         chord = norm2(p(:, l) - p(:, k))
         do j = 1, 2
            arms(:, j) = min(1.0_wp, max_control*chord/max(tiny(1.0_wp), norm2(arms(:, j))))*arms(:, j)
         end do
         b = reshape([p(:, k), p(:, k) + arms(:, 1), p(:, l) - arms(:, 2), p(:, l)], [2, 4])
      end function cubic

      !> Whether the cubic from frame `k` to frame `l` is near the places between them, at their times.
      pure logical function comes_near(k, l)
         integer, intent(in) :: k, l
         real(wp) :: b(2, 4), u
         integer :: j

         b = cubic(k, l)
         comes_near = .true.
         do j = k + 1, l - 1
            u = (t(j) - t(k))/(t(l) - t(k))
            comes_near = comes_near .and. norm2((1.0_wp - u)**3*b(:, 1) + 3.0_wp*u*(1.0_wp - u)**2*b(:, 2) &
               + 3.0_wp*u**2*(1.0_wp - u)*b(:, 3) + u**3*b(:, 4) - p(:, j)) <= off_path
         end do
      end function comes_near
   end subroutine put_path

   !> Draws the ring of the instant centre of pole number `i` at the pixel `p` (2).
   subroutine put_ring(c, i, p)
      type(canvas_t), intent(in) :: c
      integer, intent(in) :: i
      real(wp), intent(in) :: p(2)

      call put_circle(c%o, p, centre_radius, 'class="centre" style="stroke:' &
         //link_color(c%m, c%m%requests(c%d%poles(i))%subject)//'"')
      call put_circle(c%o, p, 1.0_wp, 'class="point"')
   end subroutine put_ring

   !> The lines of words about flagged instants: one for each that is drawn, and one where there are more.
   pure integer function flag_lines(d)
      type(drawing_t), intent(in) :: d

      flag_lines = size(d%flags)
      if (d%flagged > size(d%flags)) flag_lines = flag_lines + 1
   end function flag_lines

   !> Ends the picture: below it when and why instants are flagged, and what is drawn of them; and at the foot on the
   !> right the scale bar, 1, 2 or 5 times a power of ten units of length.
   subroutine put_foot(c)
      type(canvas_t), intent(in) :: c
      character(:), allocatable :: words
      real(wp) :: length, from, x, y
      integer :: i

      do i = 1, flag_lines(c%d)
         if (i > size(c%d%flags)) then
            words = phrase(say_flagged_in_all, c%m%polish)//' '//whole(c%d%flagged)
         else
            associate (flag => c%d%flags(i))
               words = 'T = '//fitted(flag%t)//': '//words_of_mark(flag%mark, flag%singularity, c%m%polish)
               if (flag%earlier .and. any(flag%last%known)) &
                  words = words//'; '//phrase(say_last_position, c%m%polish)//' '//fitted(flag%last%t)
            end associate
         end if
         call put_words(c%o, real([14, c%bottom - 16 - line_height*(flag_lines(c%d) - i)], wp), 'start', &
            'class="flag"', words)
      end do

      length = 10.0_wp**floor(log10(max_bar/c%scale))
      if (5.0_wp*length*c%scale <= max_bar) then
         length = 5.0_wp*length
      else if (2.0_wp*length*c%scale <= max_bar) then
         length = 2.0_wp*length
      end if
      x = real(width - 24, wp)
      y = c%high(2) + 16.0_wp
      from = x - length*c%scale
      call put_line(c%o, 'polyline', reshape([from, y - 4.0_wp, from, y + 4.0_wp, from, y, x, y, x, y - 4.0_wp, &
         x, y + 4.0_wp], [2, 6]), 'class="scale"')
      call put_words(c%o, [from - 8.0_wp, y + 4.0_wp], 'end', 'class="time"', &
         fitted(length)//' '//trim(c%m%length_unit))
      call put_end(c%o, 'g')
   end subroutine put_foot

   !> Notes what names should keep clear of: a line from `p` to `q` (2), in pixels, that they should not cross; a
   !> lighter one has less `weight`. A weight below 0: a box with the corners `p` and `q` that they should not cover.
   pure subroutine add_line(c, p, q, weight)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: p(2), q(2), weight
      real(wp), allocatable :: longer(:, :)

      if (.not. allocated(c%line)) allocate (c%line(5, 64))
      if (c%lines == size(c%line, 2)) then
         allocate (longer(5, 2*c%lines))
         longer(:, :c%lines) = c%line
         call move_alloc(longer, c%line)
      end if
      c%lines = c%lines + 1
      c%line(:, c%lines) = [p, q, weight]
   end subroutine add_line

   !> Notes the lines through the pixels `q` (2, :).
   pure subroutine add_lines(c, q, weight)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), weight
      integer :: k

      do k = 2, size(q, 2)
         call add_line(c, q(:, k - 1), q(:, k), weight)
      end do
   end subroutine add_lines

   !> Writes the `name` of what is at one of the pixels `p` (2, :), where it covers the least of what is drawn, or is
   !> nearer to it than `clear` (pixels): of places to eight sides at several distances. It is noted as drawn.
   subroutine put_name(c, p, clear, attributes, name)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: p(:, :), clear
      character(*), intent(in) :: attributes, name
      real(wp) :: start(2)
      real(wp) :: low(2), high(2), half(2), distance, cost, least
      integer :: i, d, x, y

      half = 0.5_wp*[letter_width*real(len(name), wp), letter_height]
      least = huge(least)
      start = p(:, 1)
      do d = 1, size(distances)
         do i = 1, size(p, 2)
            do y = 1, -1, -1
               do x = 1, -1, -1
                  if (x == 0 .and. y == 0) cycle
                  distance = distances(d)*merge(0.75_wp, 1.0_wp, x*y /= 0)
                  low = p(:, i) + [real(x, wp), -real(y, wp)]*(half + distance) - half
                  high = low + 2.0_wp*half
                  cost = cover(c, low - clear, high + clear) + distance_weight*distances(d)
                  if (cost >= least - tie) cycle
                  least = cost
                  start = [low(1), high(2)]
               end do
            end do
         end do
      end do
      call put_words(c%o, start, 'start', attributes, name)
      call add_line(c, [start(1), start(2) - 2.0_wp*half(2)], [start(1) + 2.0_wp*half(1), start(2)], box)
   end subroutine put_name

   !> How much of what is drawn the line through the places `p` (2, :) would cover or come near.
   pure real(wp) function cover_of(c, p)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: p(:, :)
      integer :: i

      cover_of = 0.0_wp
      do i = 1, size(p, 2)
         cover_of = cover_of + cover(c, p(:, i) - near, p(:, i) + near)
      end do
   end function cover_of

   !> How much of what is drawn the box from `low` to `high` (2) covers, in pixels of lines.
   pure real(wp) function cover(c, low, high)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: low(2), high(2)
      real(wp) :: from, to
      integer :: i

      cover = 0.0_wp
      if (any(low < c%low) .or. any(high > c%high)) cover = outside
      do i = 1, c%lines
         associate (p => c%line(:2, i), q => c%line(3:4, i))
            ! Most lines are far away, and this is asked very often.
            if (any(max(p, q) < low) .or. any(min(p, q) > high)) cycle
            if (c%line(5, i) < 0.0_wp) then
               if (all(p < high) .and. all(q > low)) cover = cover + over_name
               cycle
            end if
            call find_inside(p, q, low, high, from, to)
            if (to > from) cover = cover + c%line(5, i)*((to - from)*norm2(q - p))
         end associate
      end do
   end function cover

   !> Which part of the line from `p` to `q` (2) is inside the box from `low` to `high` (2): that between the parts
   !> `from` and `to` of its length; none where `to` is not above `from`. After Liang and Barsky.
   pure subroutine find_inside(p, q, low, high, from, to)
      real(wp), intent(in) :: p(2), q(2), low(2), high(2)
      real(wp), intent(out) :: from, to
      real(wp) :: a, b
      integer :: k

      from = 0.0_wp
      to = 1.0_wp
      do k = 1, 2
         if (abs(q(k) - p(k)) < tiny(1.0_wp)/epsilon(1.0_wp)) then
            if (p(k) < low(k) .or. p(k) > high(k)) to = -1.0_wp
            cycle
         end if
         a = (low(k) - p(k))/(q(k) - p(k))
         b = (high(k) - p(k))/(q(k) - p(k))
         from = max(from, min(a, b))
         to = min(to, max(a, b))
      end do
   end subroutine find_inside
end module canvas
