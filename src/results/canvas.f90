!> The plane of a picture: from the mechanism's places to pixels, what is drawn already, and where a name is clear of
!> it.
module canvas
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use planar, only: direction, rotated
   use drawing, only: drawing_t, snapshot_t, point_place, point_velocity
   use shapes, only: element_t, color_of, box
   use svg, only: put_words, put_circle, put_line, put_hatch, hatch_length, put_curve, put_group, &
      put_end, attribute
   use text_output, only: output_t
   implicit none
   private
   public :: canvas_t, make_canvas, to_pixels, put_shape, put_path, add_line, put_name, cover_of

   !> What a set is drawn on. A place p of the drawing is at shift + scale (x, -y) in pixels.
   type :: canvas_t
      type(output_t), pointer :: o => null()      !< where it is written
      type(drawing_t), pointer :: d => null()     !< what is recorded of the set
      type(mechanism_t), pointer :: m => null()   !< the set
      type(snapshot_t) :: s                  !< the position that is drawn in full
      integer, allocatable :: faint(:)       !< the numbers of frames that are faint
      integer, allocatable :: paths(:)       !< the numbers of points whose paths are drawn
      integer :: top = 0, bottom = 0         !< pixels where it begins, and above which it ends
      real(wp) :: scale = 1.0_wp             !< pixels in a unit of length
      real(wp) :: shift(2) = 0.0_wp
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp   !< names stay between these
      integer :: lines = 0
      !> (5, lines or more) x, y of both ends, weight; below 0 a box, of its upper left and its lower right corner
      real(wp), allocatable :: line(:, :)
   end type canvas_t

   !> Size of the letters of a name: mean width and height of capitals, in pixels.
   real(wp), parameter :: letter_width = 8.7_wp, letter_height = 9.0_wp
   !> The distances of a name from its place, in pixels, and what a pixel of distance counts against a pixel of overlap.
   real(wp), parameter :: distances(*) = [9.0_wp, 14.0_wp, 21.0_wp, 30.0_wp, 42.0_wp]
   real(wp), parameter :: distance_weight = 0.25_wp
   !> What a name over a name counts, and one that leaves the picture, in pixels of overlap with a line.
   real(wp), parameter :: over_name = 60.0_wp, outside = 500.0_wp
   !> Two places whose covers differ by no more, in pixels, cover the same: rounding errors do not choose, the first is
   !> taken.
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

   !> Makes the canvas `c` for the drawing `d`, at its last known position, to be written to `o`.
   subroutine make_canvas(o, d, c)
      type(output_t), intent(inout), target :: o
      type(drawing_t), intent(in), target :: d
      type(canvas_t), intent(out) :: c

      c%o => o
      c%d => d
      c%m => d%m
      c%s = d%now
      allocate (c%faint(0), c%paths(0))
   end subroutine make_canvas

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
      real(wp) :: q(2, size(shape%p, 2)), line(2, size(shape%p, 2) + 1), position(3), e(2), from, to
      integer :: k, n, used

      position = 0.0_wp
      if (shape%link > 0) then
         if (.not. c%s%known(shape%link)) return
         position = c%s%place(:, shape%link)
      end if
      n = size(q, 2)
      e = direction(position(3))
      do k = 1, n
         q(:, k) = to_pixels(c, position(:2) + rotated(shape%p(:, k), e)) &
            + rotated(shape%add(:, k), e)*[1.0_wp, -1.0_wp]
      end do

      select case (shape%element)
      case ('circle')
         call put_circle(c%o, q(:, 1), shape%radius, shape%attributes)
      case ('hatch')
         call put_hatch(c%o, q(:, 1), q(:, 2), shape%attributes)
         q(2, 2) = q(2, 2) + hatch_length
      case ('cut')
         ! As far as it is in the picture.
         used = 0
         do k = 1, n - 1
            call find_inside(q(:, k), q(:, k + 1), c%low, c%high, from, to)
            if (to > from) then
               if (used == 0) line(:, 1) = q(:, k) + from*(q(:, k + 1) - q(:, k))
               used = max(used, 1) + 1
               line(:, used) = q(:, k) + to*(q(:, k + 1) - q(:, k))
               call add_line(c, line(:, used - 1), line(:, used), shape%weight)
            end if
            if (used > 0 .and. (to < 1.0_wp .or. k == n - 1)) then
               call put_line(c%o, 'polyline', line(:, :used), shape%attributes, shape%title)
               used = 0
            end if
         end do
         return
      case default
         call put_line(c%o, shape%element, q, shape%attributes, shape%title)
      end select
      if (shape%weight < 0.0_wp) then
         call add_line(c, minval(q, dim=2) - shape%radius, maxval(q, dim=2) + shape%radius, box)
      else if (shape%weight > 0.0_wp) then
         do k = 1, merge(n, n - 1, shape%element == 'polygon')
            call add_line(c, q(:, k), q(:, 1 + modulo(k, n)), shape%weight)
         end do
      end if
   end subroutine put_shape

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
            do k = from + 1, to
               call add_line(c, p(:, k - 1), p(:, k), path_weight)
            end do
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
