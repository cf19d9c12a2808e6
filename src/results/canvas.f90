!> The plane of a picture: from the mechanism's places to pixels, what is drawn already, and where a name is clear of
!> it.
module canvas
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use drawing, only: drawing_t, snapshot_t
   use svg, only: put_words
   use text_output, only: output_t
   implicit none
   private
   public :: canvas_t, make_canvas, to_pixels, add_line, add_box, put_name, cover_of, find_inside

   !> Size of the letters of a name: mean width and height of capitals, in pixels.
   real(wp), parameter, public :: letter_width = 8.7_wp, letter_height = 9.0_wp

   !> What a set is drawn on. A place p of the drawing is at shift + scale (x, -y) in pixels.
   type :: canvas_t
      type(output_t), pointer :: o => null()      !< where it is written
      type(drawing_t), pointer :: d => null()     !< what is recorded of the set
      type(mechanism_t), pointer :: m => null()   !< the set
      type(snapshot_t) :: s                  !< the position that is drawn in full
      integer :: best = 0                    !< the frame that is drawn in full; 0 for none
      integer, allocatable :: faint(:)       !< frames that are faint
      integer :: top = 0, bottom = 0         !< pixels where it begins, and above which it ends
      real(wp) :: scale = 1.0_wp             !< pixels in a unit of length
      real(wp) :: shift(2) = 0.0_wp
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp   !< names stay between these
      integer :: lines = 0, boxes = 0
      real(wp), allocatable :: line(:, :)    !< (5, lines or more) x, y of both ends, weight
      real(wp), allocatable :: box(:, :)     !< (4, boxes or more) x, y of the upper left and the lower right corner
   end type canvas_t

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

contains

   !> The canvas `c` for the drawing `d`, which has its last known position, to be written to `o`.
   subroutine make_canvas(o, d, c)
      type(output_t), intent(inout), target :: o
      type(drawing_t), intent(in), target :: d
      type(canvas_t), intent(out) :: c

      c%o => o
      c%d => d
      c%m => d%m
      c%s = d%now
   end subroutine make_canvas

   !> The pixel (2) of the place `p` (2), which is counted from the drawing's origin.
   pure function to_pixels(c, p) result(q)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: p(2)
      real(wp) :: q(2)

      q = c%shift + c%scale*[p(1), -p(2)]
   end function to_pixels

   !> Notes a line from `p` to `q` (2), in pixels, that names should not cross; a lighter one has less `weight`.
   pure subroutine add_line(c, p, q, weight)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: p(2), q(2), weight

      call append(c%line, c%lines, [p, q, weight])
   end subroutine add_line

   !> Notes a box with the corners `low` and `high` (2), in pixels, that names should not cover.
   pure subroutine add_box(c, low, high)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: low(2), high(2)

      call append(c%box, c%boxes, [low, high])
   end subroutine add_box

   !> Appends a column to the first `used` columns of `list`.
   pure subroutine append(list, used, column)
      real(wp), allocatable, intent(inout) :: list(:, :)
      integer, intent(inout) :: used
      real(wp), intent(in) :: column(:)
      real(wp), allocatable :: longer(:, :)

      if (.not. allocated(list)) allocate (list(size(column), 64))
      if (used == size(list, 2)) then
         allocate (longer(size(column), 2*used))
         longer(:, :used) = list
         call move_alloc(longer, list)
      end if
      used = used + 1
      list(:, used) = column
   end subroutine append

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
      call add_box(c, [start(1), start(2) - 2.0_wp*half(2)], [start(1) + 2.0_wp*half(1), start(2)])
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
      do i = 1, c%boxes
         if (all(c%box(:2, i) < high) .and. all(c%box(3:, i) > low)) cover = cover + over_name
      end do
      do i = 1, c%lines
         associate (p => c%line(:2, i), q => c%line(3:4, i))
            ! Most lines are far away, and this is asked very often.
            if (any(max(p, q) < low) .or. any(min(p, q) > high)) cycle
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
