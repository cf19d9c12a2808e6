!> The canvas of a set: its part of a page, from the mechanism's places to pixels; what is drawn already, and where a
!> name is clear of it; and what stands around the mechanism: title, flagged instants, scale.
module canvas
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use plane_vectors, only: direction, rotated, in_degrees
   use drives, only: drive_motion
   use names, only: drive_name
   use scales, only: is_length
   use number_format, only: full, whole
   use drawing, only: drawing_t, snapshot_t, moved
   use shapes, only: element_t, shapes_of
   use svg, only: page_t, width, tie, put_words, put_circle, put_line, put_group, put_end, attribute, fitted
   use text_output, only: output_t
   use listing, only: words_of_mark
   use listing_layout, only: angle_unit
   use phrases
   implicit none
   private
   public :: canvas_t, label_t, make_canvas, to_pixels, put_shape, note_shape, put_outlines, place_name, put_label
   public :: caption, put_foot, put_bar, add_lines, add_box, cover_of

   !> What a set is drawn on. A place p of the drawing is at shift + scale (x, -y) in pixels.
   type :: canvas_t
      type(output_t), pointer :: o => null()      !< where it is written
      type(drawing_t), pointer :: d => null()     !< what is recorded of the set
      type(mechanism_t), pointer :: m => null()   !< the set
      type(snapshot_t) :: s                  !< the position that is drawn in full
      real(wp) :: scale = 1.0_wp             !< pixels in a unit of length
      real(wp) :: shift(2) = 0.0_wp
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp   !< the mechanism and its names stay between these
      real(wp), allocatable :: ink(:, :)     !< what is drawn in each cell of these: pixels of lines by their weight
   end type canvas_t

   !> A name, and what it names.
   type :: label_t
      character(:), allocatable :: name, attributes   !< of its text
      integer :: link = 0                    !< with which it moves; 0: none
      real(wp) :: of(2) = 0.0_wp             !< what it names (pixels),
      real(wp) :: clear = 0.0_wp             !< it stays so far from others (pixels)
      real(wp) :: start(2) = 0.0_wp, near(2) = 0.0_wp   !< the start of its line, and what of it is nearest to that
   end type label_t

   !> Room around what is drawn, for names and supports; largest and least height of what is drawn.
   real(wp), parameter :: margin = 62.0_wp, max_height = 520.0_wp, min_height = 60.0_wp
   !> Room above for the title and below for times, scale and flagged instants; height of a line of words.
   integer, parameter :: above = 34, below = 61
   integer, parameter, public :: line_height = 17
   !> A picture is wider for a centrode that goes beyond the mechanism by at most this part of its larger side.
   real(wp), parameter :: centrode_room = 0.4_wp
   !> The length of the scale bar, at most.
   real(wp), parameter :: max_bar = 150.0_wp
   !> The letters of a caption, at most: on its right is the scale.
   integer, parameter :: max_caption = 78

   !> Size of the letters of a name: mean width and height of capitals, in pixels.
   real(wp), parameter :: letter_width = 8.7_wp, letter_height = 9.0_wp
   !> The distances of a name from its place, in pixels, and what a pixel of distance counts against a pixel of overlap.
   real(wp), parameter :: distances(*) = [9.0_wp, 11.0_wp, 14.0_wp, 21.0_wp, 30.0_wp, 42.0_wp]
   real(wp), parameter :: distance_weight = 0.25_wp
   !> A name has a thin line to its place if it is farther from it, in pixels, than it stays clear of others, and this.
   real(wp), parameter :: max_alone = 8.0_wp
   !> Pixels of the side of a cell, and pieces of a line at most: what is longer leaves the picture.
   real(wp), parameter :: cell = 2.0_wp
   integer, parameter :: max_pieces = 2000
   !> What a name over a name counts in each cell, and one that leaves the picture, in pixels of overlap with a line.
   real(wp), parameter :: over_name = 10.0_wp, outside = 500.0_wp
   !> Lines that are closer than this, in pixels, are hard to tell apart.
   real(wp), parameter :: near = 4.0_wp

contains

   !> Makes the canvas `c` of the drawing `d` at the end of the `page`, and begins it with the title. It shows the
   !> position `s` in full, and has room for the links at the frames `others`.
   !>
   !> The scale has eight binary digits, the height is even and the shift whole: rounding errors of the results do not
   !> move the picture, and none of these is near a tie for what is symmetric or has few digits.
   subroutine make_canvas(page, d, s, others, c)
      type(page_t), intent(inout), target :: page
      type(drawing_t), intent(in), target :: d
      type(snapshot_t), intent(in) :: s
      integer, intent(in) :: others(:)
      type(canvas_t), intent(out) :: c
      type(element_t), allocatable :: list(:)
      real(wp) :: low(2), high(2), from(2), to(2)    ! what is drawn; the centrodes within the latter
      real(wp) :: room
      integer :: height, top, i, k

      c%o => page%body
      c%d => d
      c%m => d%m
      c%s = s

      ! What is drawn: all shapes at the position in full, those of moving links at the others, paths; and centrodes
      ! that stay near. One that runs far away would take the room of all else.
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      list = shapes_of(d, 1.0_wp)
      do i = 1, size(list)
         if (list(i)%element == 'centrode') cycle
         call widen(places_of(list(i), s))
         if (list(i)%link == 0) cycle
         if (d%m%links(list(i)%link)%ground) cycle
         do k = 1, size(others)
            call widen(places_of(list(i), d%frame(others(k))))
         end do
      end do
      if (.not. all(low <= high)) then
         low = 0.0_wp
         high = 0.0_wp
      end if
      room = centrode_room*maxval(high - low)
      from = low - room
      to = high + room
      do i = 1, size(list)
         if (list(i)%element /= 'centrode') cycle
         associate (p => places_of(list(i), s))
            if (all(minval(p, dim=2) >= from) .and. all(maxval(p, dim=2) <= to)) call widen(p)
         end associate
      end do

      associate (extent => high - low)
         room = real(width, wp) - 2.0_wp*margin
         if (any(extent > 0.0_wp)) then
            c%scale = 1.0_wp/max(extent(1)/room, extent(2)/max_height)
            c%scale = c%scale*(1.0_wp + tie)
            c%scale = scale(aint(256.0_wp*fraction(c%scale)), exponent(c%scale) - 8)
         end if
         height = 2*ceiling(0.5_wp*max(min_height, c%scale*extent(2)) + margin - tie)
         top = page%height
         page%height = top + above + height + below
         c%shift = anint([0.5_wp*real(width, wp) - c%scale*(low(1) + 0.5_wp*extent(1)), &
            real(top + above, wp) + 0.5_wp*real(height, wp) + c%scale*(low(2) + 0.5_wp*extent(2))])
      end associate
      c%low = [4.0_wp, real(top + above, wp)]
      c%high = [real(width - 4, wp), real(top + above + height, wp)]
      allocate (c%ink(int((c%high(1) - c%low(1))/cell) + 1, int((c%high(2) - c%low(2))/cell) + 1), source=0.0_wp)

      call put_group(c%o, 'class="set" data-set="'//whole(c%m%set_number)//'" data-scale="'//full(c%scale) &
         //'" data-x="'//fitted(c%shift(1))//'" data-y="'//fitted(c%shift(2)) &
         //'" data-origin="'//full(d%origin(1))//' '//full(d%origin(2))//'" data-t="'//full(s%t)//'"', trim(c%m%title))
      call put_words(c%o, real([14, top + 24], wp), 'start', 'class="title"', &
         trim(whole(c%m%set_number)//'.  '//c%m%title))

   contains

      !> Widens what is drawn by the places `p` (2, :).
      subroutine widen(p)
         real(wp), intent(in) :: p(:, :)

         low = min(low, minval(p, dim=2))
         high = max(high, maxval(p, dim=2))
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

   !> The pixel (2) of the place `p` (2), which is counted from the drawing's origin.
   pure function to_pixels(c, p) result(q)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: p(2)
      real(wp) :: q(2)

      q = c%shift + c%scale*[p(1), -p(2)]
   end function to_pixels

   !> The pixels (2, :) of `shape` at the position `s`; none where its link is not known there.
   pure function pixels_of(c, shape, s) result(q)
      type(canvas_t), intent(in) :: c
      type(element_t), intent(in) :: shape
      type(snapshot_t), intent(in) :: s
      real(wp), allocatable :: q(:, :)
      real(wp) :: e(2)
      integer :: k

      e = [1.0_wp, 0.0_wp]
      if (shape%link > 0) e = direction(s%place(3, shape%link))
      q = places_of(shape, s)
      do k = 1, size(q, 2)
         q(:, k) = to_pixels(c, q(:, k)) + rotated(shape%add(:, k), e)*[1.0_wp, -1.0_wp]
      end do
   end function pixels_of

   !> Draws `shape` at the position that the canvas shows, unless its link is not known there.
   subroutine put_shape(c, shape)
      type(canvas_t), intent(inout) :: c
      type(element_t), intent(in) :: shape
      real(wp), allocatable :: q(:, :)

      q = pixels_of(c, shape, c%s)
      if (size(q) == 0) return
      select case (shape%element)
      case ('circle')
         call put_circle(c%o, q(:, 1), shape%radius, shape%attributes)
      case ('polygon')
         call put_line(c%o, 'polygon', q, shape%attributes)
      case default
         call put_line(c%o, 'polyline', q, shape%attributes)
      end select
   end subroutine put_shape

   !> Notes what names should keep clear of: `shape` at the position that the canvas shows.
   subroutine note_shape(c, shape)
      type(canvas_t), intent(inout) :: c
      type(element_t), intent(in) :: shape
      real(wp), allocatable :: q(:, :)

      q = pixels_of(c, shape, c%s)
      if (size(q) == 0) return
      if (shape%weight < 0.0_wp) then
         call add_box(c, minval(q, dim=2) - shape%radius, maxval(q, dim=2) + shape%radius)
      else if (shape%weight > 0.0_wp) then
         if (shape%element == 'polygon') q = reshape([q, q(:, 1)], [2, size(q, 2) + 1])
         call add_lines(c, q, shape%weight)
      end if
   end subroutine note_shape

   !> Draws the outlines of the moving ones of the shapes `list` as thin lines at the position `s`.
   subroutine put_outlines(c, list, s)
      type(canvas_t), intent(inout) :: c
      type(element_t), intent(in) :: list(:)
      type(snapshot_t), intent(in) :: s
      real(wp), allocatable :: q(:, :)
      integer :: i

      do i = 1, size(list)
         if (.not. list(i)%is_faint .or. c%m%links(max(1, list(i)%link))%ground) cycle
         q = pixels_of(c, list(i), s)
         if (size(q) > 0) call put_line(c%o, list(i)%element, q, 'class="thin"')
      end do
   end subroutine put_outlines

   !> The time `t` in words, with the values of the drives, as far as there is room.
   function caption(c, t) result(words)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: t
      character(:), allocatable :: words, next
      real(wp) :: f(0:2)
      integer :: i

      words = 'T = '//fitted(t)//' '//trim(c%m%time_unit)
      do i = 1, size(c%m%drives)
         associate (drive => c%m%drives(i))
            f = drive_motion(drive, t)
            if (is_length(drive)) then
               next = fitted(f(0))//' '//trim(c%m%length_unit)
            else
               next = fitted(merge(in_degrees(f(0)), f(0), c%m%degrees))//' '//trim(angle_unit(c%m))
            end if
            next = ', '//trim(drive_name(c%m, drive))//' = '//next
         end associate
         if (len(words) + len(next) > max_caption) exit
         words = words//next
      end do
   end function caption

   !> Ends the picture: below it when and why the first flagged instant is flagged, and how many are; and at the foot on
   !> the right the scale bar.
   subroutine put_foot(c)
      type(canvas_t), intent(in) :: c
      character(:), allocatable :: words

      if (c%d%flagged > 0) then
         associate (s => c%d%flag)
            words = 'T = '//fitted(s%t)//': '//words_of_mark(s%mark, s%singularity, c%m%polish)
         end associate
         if (c%d%flagged > 1) words = words//'; '//phrase(say_flagged_in_all, c%m%polish)//' '//whole(c%d%flagged)
         call put_words(c%o, [14.0_wp, c%high(2) + 45.0_wp], 'start', 'class="flag"', words)
      end if
      call put_bar(c, c%high(2) + 16.0_wp, c%scale, trim(c%m%length_unit), 'class="scale"')
      call put_end(c%o, 'g')
   end subroutine put_foot

   !> Draws a scale bar on the right at the height `y` (pixels): 1, 2 or 5 times a power of ten of the `unit`, of which
   !> one has so many pixels (`scale`).
   subroutine put_bar(c, y, scale, unit, attributes)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: y, scale
      character(*), intent(in) :: unit, attributes
      real(wp) :: length, from, x

      length = 10.0_wp**floor(log10(max_bar/scale))
      if (5.0_wp*length*scale <= max_bar) then
         length = 5.0_wp*length
      else if (2.0_wp*length*scale <= max_bar) then
         length = 2.0_wp*length
      end if
      x = real(width - 24, wp)
      from = x - length*scale
      call put_line(c%o, 'polyline', reshape([from, y - 4.0_wp, from, y + 4.0_wp, from, y, x, y, x, y - 4.0_wp, &
         x, y + 4.0_wp], [2, 6]), attributes)
      call put_words(c%o, [from - 8.0_wp, y + 4.0_wp], 'end', 'class="time"', fitted(length)//' '//unit)
   end subroutine put_bar

   !> Notes the lines through the pixels `q` (2, :), which names should not cross, the less the more they weigh.
   pure subroutine add_lines(c, q, weight)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), weight
      real(wp) :: length, at(2)
      integer :: pieces, i, j, k(2)

      do j = 2, size(q, 2)
         length = norm2(q(:, j) - q(:, j - 1))
         pieces = ceiling(min(length/cell, real(max_pieces, wp)))
         do i = 1, pieces
            at = q(:, j - 1) + (real(i, wp) - 0.5_wp)/real(pieces, wp)*(q(:, j) - q(:, j - 1))
            if (any(at < c%low) .or. any(at > c%high)) cycle
            k = cell_of(c, at)
            c%ink(k(1), k(2)) = c%ink(k(1), k(2)) + weight*length/real(pieces, wp)
         end do
      end do
   end subroutine add_lines

   !> Notes a box from its upper left corner `p` to its lower right one `q` (2), in pixels, that names should not cover.
   pure subroutine add_box(c, p, q)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: p(2), q(2)

      associate (from => cell_of(c, p), to => cell_of(c, q))
         c%ink(from(1):to(1), from(2):to(2)) = c%ink(from(1):to(1), from(2):to(2)) + over_name
      end associate
   end subroutine add_box

   !> The numbers (2) of the cell at the pixel `p` (2), or of the cell of the window nearest to it. Rounding errors of
   !> whole pixels, at which lines often lie, do not choose.
   pure function cell_of(c, p) result(k)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: p(2)
      integer :: k(2)

      k = 1 + int((min(max(p, c%low), c%high) - c%low + tie)/cell)
   end function cell_of

   !> Finds the place of the `name` of what is at one of the pixels `p` (2, :), where it covers the least of what is
   !> drawn, or is nearer to it than `clear` (pixels): of places on eight sides at several distances. It is noted as
   !> drawn.
   subroutine place_name(c, p, clear, name, label)
      type(canvas_t), intent(inout) :: c
      real(wp), intent(in) :: p(:, :), clear
      character(*), intent(in) :: name
      type(label_t), intent(inout) :: label
      real(wp) :: low(2), high(2), half(2), distance, cost, least
      integer :: i, d, x, y

      half = 0.5_wp*[letter_width*real(len(name), wp), letter_height]
      least = huge(least)
      label%name = name
      label%clear = clear
      label%of = p(:, 1)
      label%start = p(:, 1)
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
                  label%start = [low(1), high(2)]
                  label%of = p(:, i)
                  label%near = min(max(p(:, i), low), high)
               end do
            end do
         end do
      end do
      associate (start => label%start)
         call add_box(c, start - [0.0_wp, 2.0_wp*half(2)], start + [2.0_wp*half(1), 0.0_wp])
      end associate
   end subroutine place_name

   !> Writes the name of a `label`, with a thin line to what it names if it is far from it.
   subroutine put_label(c, label)
      type(canvas_t), intent(in) :: c
      type(label_t), intent(in) :: label

      if (norm2(label%near - label%of) > label%clear + max_alone) &
         call put_line(c%o, 'polyline', reshape([label%of, label%near], [2, 2]), 'class="leader"')
      call put_words(c%o, label%start, 'start', label%attributes, label%name)
   end subroutine put_label

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

      associate (from => cell_of(c, low), to => cell_of(c, high))
         cover = sum(c%ink(from(1):to(1), from(2):to(2)))
      end associate
      if (any(low < c%low) .or. any(high > c%high)) cover = cover + outside
   end function cover
end module canvas
