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

   !> Makes the `canvas` of the `drawing` at the end of the `page`, and begins it with the title. It shows the
   !> position `snapshot` in full, and has room for the links at the frames `others`.
   !>
   !> The scale has eight binary digits, the height is even and the shift whole: rounding errors of the results do not
   !> move the picture, and none of these is near a tie for what is symmetric or has few digits.
   subroutine make_canvas(page, drawing, snapshot, others, canvas)
      type(page_t), intent(inout), target :: page
      type(drawing_t), intent(in), target :: drawing
      type(snapshot_t), intent(in) :: snapshot
      integer, intent(in) :: others(:)
      type(canvas_t), intent(out) :: canvas
      type(element_t), allocatable :: list(:)
      real(wp) :: low(2), high(2), from(2), to(2)    ! what is drawn; the centrodes within the latter
      real(wp) :: room
      integer :: height, top, i, k

      canvas%o => page%body
      canvas%d => drawing
      canvas%m => drawing%m
      canvas%s = snapshot

      ! What is drawn: all shapes at the position in full, those of moving links at the others, paths; and centrodes
      ! that stay near. One that runs far away would take the room of all else.
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      list = shapes_of(drawing, 1.0_wp)
      do i = 1, size(list)
         if (list(i)%element == 'centrode') cycle
         call widen(places_of(list(i), snapshot))
         if (list(i)%link == 0) cycle
         if (drawing%m%links(list(i)%link)%ground) cycle
         do k = 1, size(others)
            call widen(places_of(list(i), drawing%frame(others(k))))
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
         associate (p => places_of(list(i), snapshot))
            if (all(minval(p, dim=2) >= from) .and. all(maxval(p, dim=2) <= to)) call widen(p)
         end associate
      end do

      associate (extent => high - low)
         room = real(width, wp) - 2.0_wp*margin
         if (any(extent > 0.0_wp)) then
            canvas%scale = 1.0_wp/max(extent(1)/room, extent(2)/max_height)
            canvas%scale = canvas%scale*(1.0_wp + tie)
            canvas%scale = scale(aint(256.0_wp*fraction(canvas%scale)), exponent(canvas%scale) - 8)
         end if
         height = 2*ceiling(0.5_wp*max(min_height, canvas%scale*extent(2)) + margin - tie)
         top = page%height
         page%height = top + above + height + below
         canvas%shift = anint([0.5_wp*real(width, wp) - canvas%scale*(low(1) + 0.5_wp*extent(1)), &
            real(top + above, wp) + 0.5_wp*real(height, wp) + canvas%scale*(low(2) + 0.5_wp*extent(2))])
      end associate
      canvas%low = [4.0_wp, real(top + above, wp)]
      canvas%high = [real(width - 4, wp), real(top + above + height, wp)]
      allocate (canvas%ink(int((canvas%high(1) - canvas%low(1))/cell) + 1, &
         int((canvas%high(2) - canvas%low(2))/cell) + 1), source=0.0_wp)

      call put_group(canvas%o, 'class="set" data-set="'//whole(canvas%m%set_number)//'" data-scale="' &
         //full(canvas%scale) &
         //'" data-x="'//fitted(canvas%shift(1))//'" data-y="'//fitted(canvas%shift(2)) &
         //'" data-origin="'//full(drawing%origin(1))//' '//full(drawing%origin(2))//'" data-t="'//full(snapshot%t) &
            //'"', trim(canvas%m%title))
      call put_words(canvas%o, real([14, top + 24], wp), 'start', 'class="title"', &
         trim(whole(canvas%m%set_number)//'.  '//canvas%m%title))

   contains

      !> Widens what is drawn by the places `p` (2, :).
      subroutine widen(p)
         real(wp), intent(in) :: p(:, :)

         low = min(low, minval(p, dim=2))
         high = max(high, maxval(p, dim=2))
      end subroutine widen
   end subroutine make_canvas

   !> The places (2, :) of `shape` at the position `snapshot`; none where its link has no position there.
   pure function places_of(shape, snapshot) result(p)
      type(element_t), intent(in) :: shape
      type(snapshot_t), intent(in) :: snapshot
      real(wp), allocatable :: p(:, :)

      p = shape%p
      if (shape%link == 0) return
      p = moved(p, snapshot%place(:, shape%link))
      if (.not. snapshot%known(shape%link)) p = p(:, :0)
   end function places_of

   !> The pixel (2) of the place `p` (2), which is counted from the drawing's origin.
   pure function to_pixels(canvas, p) result(q)
      type(canvas_t), intent(in) :: canvas
      real(wp), intent(in) :: p(2)
      real(wp) :: q(2)

      q = canvas%shift + canvas%scale*[p(1), -p(2)]
   end function to_pixels

   !> The pixels (2, :) of `shape` at the position `snapshot`; none where its link is not known there.
   pure function pixels_of(canvas, shape, snapshot) result(q)
      type(canvas_t), intent(in) :: canvas
      type(element_t), intent(in) :: shape
      type(snapshot_t), intent(in) :: snapshot
      real(wp), allocatable :: q(:, :)
      real(wp) :: e(2)
      integer :: k

      e = [1.0_wp, 0.0_wp]
      if (shape%link > 0) e = direction(snapshot%place(3, shape%link))
      q = places_of(shape, snapshot)
      do k = 1, size(q, 2)
         q(:, k) = to_pixels(canvas, q(:, k)) + rotated(shape%add(:, k), e)*[1.0_wp, -1.0_wp]
      end do
   end function pixels_of

   !> Draws `shape` at the position that the canvas shows, unless its link is not known there.
   subroutine put_shape(canvas, shape)
      type(canvas_t), intent(inout) :: canvas
      type(element_t), intent(in) :: shape
      real(wp), allocatable :: q(:, :)

      q = pixels_of(canvas, shape, canvas%s)
      if (size(q) == 0) return
      select case (shape%element)
      case ('circle')
         call put_circle(canvas%o, q(:, 1), shape%radius, shape%attributes)
      case ('polygon')
         call put_line(canvas%o, 'polygon', q, shape%attributes)
      case default
         call put_line(canvas%o, 'polyline', q, shape%attributes)
      end select
   end subroutine put_shape

   !> Notes what names should keep clear of: `shape` at the position that the canvas shows.
   subroutine note_shape(canvas, shape)
      type(canvas_t), intent(inout) :: canvas
      type(element_t), intent(in) :: shape
      real(wp), allocatable :: q(:, :)

      q = pixels_of(canvas, shape, canvas%s)
      if (size(q) == 0) return
      if (shape%weight < 0.0_wp) then
         call add_box(canvas, minval(q, dim=2) - shape%radius, maxval(q, dim=2) + shape%radius)
      else if (shape%weight > 0.0_wp) then
         if (shape%element == 'polygon') q = reshape([q, q(:, 1)], [2, size(q, 2) + 1])
         call add_lines(canvas, q, shape%weight)
      end if
   end subroutine note_shape

   !> Draws the outlines of the moving ones of the shapes `list` as thin lines at the position `snapshot`.
   subroutine put_outlines(canvas, list, snapshot)
      type(canvas_t), intent(inout) :: canvas
      type(element_t), intent(in) :: list(:)
      type(snapshot_t), intent(in) :: snapshot
      real(wp), allocatable :: q(:, :)
      integer :: i

      do i = 1, size(list)
         if (.not. list(i)%is_faint .or. canvas%m%links(max(1, list(i)%link))%ground) cycle
         q = pixels_of(canvas, list(i), snapshot)
         if (size(q) > 0) call put_line(canvas%o, list(i)%element, q, 'class="thin"')
      end do
   end subroutine put_outlines

   !> The time `t` in words, with the values of the drives, as far as there is room.
   function caption(canvas, t) result(words)
      type(canvas_t), intent(in) :: canvas
      real(wp), intent(in) :: t
      character(:), allocatable :: words, next
      real(wp) :: f(0:2)
      integer :: i

      words = 'T = '//fitted(t)//' '//trim(canvas%m%time_unit)
      do i = 1, size(canvas%m%drives)
         associate (drive => canvas%m%drives(i))
            f = drive_motion(drive, t)
            if (is_length(drive)) then
               next = fitted(f(0))//' '//trim(canvas%m%length_unit)
            else
               next = fitted(merge(in_degrees(f(0)), f(0), canvas%m%degrees))//' '//trim(angle_unit(canvas%m))
            end if
            next = ', '//trim(drive_name(canvas%m, drive))//' = '//next
         end associate
         if (len(words) + len(next) > max_caption) exit
         words = words//next
      end do
   end function caption

   !> Ends the picture: below it when and why the first flagged instant is flagged, and how many are; and at the foot on
   !> the right the scale bar.
   subroutine put_foot(canvas)
      type(canvas_t), intent(in) :: canvas
      character(:), allocatable :: words

      if (canvas%d%flagged > 0) then
         associate (s => canvas%d%flag)
            words = 'T = '//fitted(s%t)//': '//words_of_mark(s%mark, s%singularity, canvas%m%polish)
         end associate
         if (canvas%d%flagged > 1) words = words//'; '//phrase(say_flagged_in_all, canvas%m%polish)//' ' &
            //whole(canvas%d%flagged)
         call put_words(canvas%o, [14.0_wp, canvas%high(2) + 45.0_wp], 'start', 'class="flag"', words)
      end if
      call put_bar(canvas, canvas%high(2) + 16.0_wp, canvas%scale, trim(canvas%m%length_unit), 'class="scale"')
      call put_end(canvas%o, 'g')
   end subroutine put_foot

   !> Draws a scale bar on the right at the height `level` (pixels): 1, 2 or 5 times a power of ten of the `unit`, of
   !> which one has so many pixels (`scale`).
   subroutine put_bar(canvas, level, scale, unit, attributes)
      type(canvas_t), intent(in) :: canvas
      real(wp), intent(in) :: level, scale
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
      call put_line(canvas%o, 'polyline', reshape([from, level - 4.0_wp, from, level + 4.0_wp, from, level, x, level, &
         x, level - 4.0_wp, &
         x, level + 4.0_wp], [2, 6]), attributes)
      call put_words(canvas%o, [from - 8.0_wp, level + 4.0_wp], 'end', 'class="time"', fitted(length)//' '//unit)
   end subroutine put_bar

   !> Notes the lines through the pixels `points` (2, :), which names should not cross, the less the more they weigh.
   pure subroutine add_lines(canvas, points, weight)
      type(canvas_t), intent(inout) :: canvas
      real(wp), intent(in) :: points(:, :), weight
      real(wp) :: length, at(2)
      integer :: pieces, i, j, k(2)

      do j = 2, size(points, 2)
         length = norm2(points(:, j) - points(:, j - 1))
         pieces = ceiling(min(length/cell, real(max_pieces, wp)))
         do i = 1, pieces
            at = points(:, j - 1) + (real(i, wp) - 0.5_wp)/real(pieces, wp)*(points(:, j) - points(:, j - 1))
            if (any(at < canvas%low) .or. any(at > canvas%high)) cycle
            k = cell_of(canvas, at)
            canvas%ink(k(1), k(2)) = canvas%ink(k(1), k(2)) + weight*length/real(pieces, wp)
         end do
      end do
   end subroutine add_lines

   !> Notes a box from its upper left corner `p` to its lower right one `corner` (2), in pixels, that names should not
   !> cover.
   pure subroutine add_box(canvas, p, corner)
      type(canvas_t), intent(inout) :: canvas
      real(wp), intent(in) :: p(2), corner(2)

      associate (from => cell_of(canvas, p), to => cell_of(canvas, corner))
         canvas%ink(from(1):to(1), from(2):to(2)) = canvas%ink(from(1):to(1), from(2):to(2)) + over_name
      end associate
   end subroutine add_box

   !> The numbers (2) of the cell at the pixel `p` (2), or of the cell of the window nearest to it. Rounding errors of
   !> whole pixels, at which lines often lie, do not choose.
   pure function cell_of(canvas, p) result(k)
      type(canvas_t), intent(in) :: canvas
      real(wp), intent(in) :: p(2)
      integer :: k(2)

      k = 1 + int((min(max(p, canvas%low), canvas%high) - canvas%low + tie)/cell)
   end function cell_of

   !> Finds the place of the `name` of what is at one of the pixels `p` (2, :), where it covers the least of what is
   !> drawn, or is nearer to it than `clear` (pixels): of places on eight sides at several distances. It is noted as
   !> drawn.
   subroutine place_name(canvas, p, clear, name, label)
      type(canvas_t), intent(inout) :: canvas
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
                  cost = cover(canvas, low - clear, high + clear) + distance_weight*distances(d)
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
         call add_box(canvas, start - [0.0_wp, 2.0_wp*half(2)], start + [2.0_wp*half(1), 0.0_wp])
      end associate
   end subroutine place_name

   !> Writes the name of a `label`, with a thin line to what it names if it is far from it.
   subroutine put_label(canvas, label)
      type(canvas_t), intent(in) :: canvas
      type(label_t), intent(in) :: label

      if (norm2(label%near - label%of) > label%clear + max_alone) &
         call put_line(canvas%o, 'polyline', reshape([label%of, label%near], [2, 2]), 'class="leader"')
      call put_words(canvas%o, label%start, 'start', label%attributes, label%name)
   end subroutine put_label

   !> How much of what is drawn the line through the places `p` (2, :) would cover or come near.
   pure real(wp) function cover_of(canvas, p)
      type(canvas_t), intent(in) :: canvas
      real(wp), intent(in) :: p(:, :)
      integer :: i

      cover_of = 0.0_wp
      do i = 1, size(p, 2)
         cover_of = cover_of + cover(canvas, p(:, i) - near, p(:, i) + near)
      end do
   end function cover_of

   !> How much of what is drawn the box from `low` to `high` (2) covers, in pixels of lines.
   pure real(wp) function cover(canvas, low, high)
      type(canvas_t), intent(in) :: canvas
      real(wp), intent(in) :: low(2), high(2)

      associate (from => cell_of(canvas, low), to => cell_of(canvas, high))
         cover = sum(canvas%ink(from(1):to(1), from(2):to(2)))
      end associate
      if (any(low < canvas%low) .or. any(high > canvas%high)) cover = cover + outside
   end function cover
end module canvas
