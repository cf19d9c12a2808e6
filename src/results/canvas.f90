!> The canvas of a set: its part of a page, from the mechanism's places to pixels; the places that are covered already,
!> and those that are clear for a name; title, flagged instants and scale around the mechanism.
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
   use svg, only: page_t, page_width, tie, draw_words, draw_circle, draw_line, open_group, close_group, fitted
   use text_output, only: output_t
   use listing, only: words_of_flag
   use listing_layout, only: angle_unit
   use phrases
   implicit none
   private
   public :: canvas_t, label_t, make_canvas, to_pixels, draw_shape, record_shape, draw_outlines, place_name, draw_label
   public :: caption, draw_foot, draw_bar, add_lines, add_box, cover_of

   !> The part of a page on which a set is drawn. A place (x, y) of the drawing is at shift + scale (x, -y) in pixels.
   type :: canvas_t
      type(output_t), pointer :: output => null()         !< the page to which it is written
      type(drawing_t), pointer :: drawing => null()       !< the record of the set
      type(mechanism_t), pointer :: mechanism => null()   !< the set
      type(snapshot_t) :: snapshot           !< the position that is drawn in full
      real(wp) :: scale = 1.0_wp             !< pixels in a unit of length
      real(wp) :: shift(2) = 0.0_wp          !< the pixel of the drawing's origin
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp   !< pixels: the mechanism and its names stay between these
      real(wp), allocatable :: ink(:, :)     !< (columns, rows) of cells: pixels of lines in each, times their weight
   end type canvas_t

   !> A name with its place.
   type :: label_t
      character(:), allocatable :: name, attributes   !< the text, and its attributes as SVG
      integer :: link = 0                    !< the link with which it moves; 0: none
      real(wp) :: of(2) = 0.0_wp             !< the pixel of the point or link that it names
      real(wp) :: clear = 0.0_wp             !< pixels: the name stays so far from all other things
      real(wp) :: start(2) = 0.0_wp          !< the pixel at which its foot line begins
      real(wp) :: near(2) = 0.0_wp           !< the pixel of its text that is nearest to `of`
   end type label_t

   !> Pixels around the mechanism, for names and supports.
   real(wp), parameter :: side_margin = 62.0_wp
   !> Pixels: the largest and the least height of the mechanism.
   real(wp), parameter :: max_height = 520.0_wp, min_height = 60.0_wp
   !> Pixels above the mechanism for the title, and below it for times, scale and flagged instants.
   integer, parameter :: title_height = 34, foot_height = 61
   !> Pixels of the height of a line of words.
   integer, parameter, public :: line_height = 17
   !> A picture is wider for a centrode that goes beyond the mechanism by at most this part of its larger side.
   real(wp), parameter :: centrode_room = 0.4_wp
   !> Pixels of the scale bar, at most.
   real(wp), parameter :: max_bar = 150.0_wp
   !> The largest number of letters of a caption: the scale is on its right.
   integer, parameter :: max_caption = 78

   !> Size of the letters of a name: mean width and height of capitals, in pixels.
   real(wp), parameter :: letter_width = 8.7_wp, letter_height = 9.0_wp
   !> The distances at which a name may stand from its place, in pixels.
   real(wp), parameter :: name_distances(*) = [9.0_wp, 11.0_wp, 14.0_wp, 21.0_wp, 30.0_wp, 42.0_wp]
   !> A pixel of distance costs as much as so many pixels of overlap.
   real(wp), parameter :: distance_weight = 0.25_wp
   !> A name has a thin line to its place if it is farther from it, in pixels, than it stays clear of others, and this.
   real(wp), parameter :: longest_without_line = 8.0_wp
   !> Pixels of the side of a cell.
   real(wp), parameter :: cell_side = 2.0_wp
   !> The largest number of pieces of a line: a longer line leaves the picture.
   integer, parameter :: max_pieces = 2000
   !> A name over a name costs in each cell so many pixels of overlap with a line.
   real(wp), parameter :: name_weight = 10.0_wp
   !> A name that leaves the picture costs so many pixels of overlap with a line.
   real(wp), parameter :: outside_weight = 500.0_wp
   !> Lines that are closer than this, in pixels, are hard to distinguish.
   real(wp), parameter :: least_gap = 4.0_wp

contains

   !> Makes the canvas of a drawing at the end of a page, and begins it with the title.
   !>
   !> The scale has eight binary digits, the height is even and the shift whole: rounding errors of the results do not
   !> move the picture. None of these numbers is near a tie if the mechanism is symmetric or has few digits.
   subroutine make_canvas(page, drawing, snapshot, others, canvas)
      type(page_t), intent(inout), target :: page   !< gets the canvas
      type(drawing_t), intent(in), target :: drawing   !< the record of the set
      type(snapshot_t), intent(in) :: snapshot   !< the position that is shown in full
      integer, intent(in) :: others(:)       !< numbers of the frames for whose links there is room, too
      type(canvas_t), intent(out) :: canvas   !< of the set; nothing is recorded yet
      type(element_t), allocatable :: list(:)
      real(wp) :: low(2), high(2), from(2), to(2)    ! the extent; and the limits for centrodes
      real(wp) :: room
      integer :: height, top, i, k

      canvas%output => page%body
      canvas%drawing => drawing
      canvas%mechanism => drawing%mechanism
      canvas%snapshot = snapshot

      ! The extent is that of all shapes at the position in full, moving links at the others, and paths. Centrodes
      ! count if they stay near. One that runs far away would take the room of all else.
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      list = shapes_of(drawing, 1.0_wp)
      do i = 1, size(list)
         if (list(i)%element == 'centrode') cycle
         call widen(places_of(list(i), snapshot))
         if (list(i)%link == 0) cycle
         if (drawing%mechanism%links(list(i)%link)%ground) cycle
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
         room = real(page_width, wp) - 2.0_wp*side_margin
         if (any(extent > 0.0_wp)) then
            canvas%scale = 1.0_wp/max(extent(1)/room, extent(2)/max_height)
            canvas%scale = canvas%scale*(1.0_wp + tie)
            canvas%scale = scale(aint(256.0_wp*fraction(canvas%scale)), exponent(canvas%scale) - 8)
         end if

         height = 2*ceiling(0.5_wp*max(min_height, canvas%scale*extent(2)) + side_margin - tie)
         top = page%height
         page%height = top + title_height + height + foot_height
         canvas%shift = anint([0.5_wp*real(page_width, wp) - canvas%scale*(low(1) + 0.5_wp*extent(1)), &
            real(top + title_height, wp) + 0.5_wp*real(height, wp) + canvas%scale*(low(2) + 0.5_wp*extent(2))])
      end associate
      canvas%low = [4.0_wp, real(top + title_height, wp)]
      canvas%high = [real(page_width - 4, wp), real(top + title_height + height, wp)]
      allocate (canvas%ink(int((canvas%high(1) - canvas%low(1))/cell_side) + 1, &
         int((canvas%high(2) - canvas%low(2))/cell_side) + 1), source=0.0_wp)

      call open_group(canvas%output, 'class="set" data-set="'//whole(canvas%mechanism%set_number)//'" data-scale="' &
         //full(canvas%scale) &
         //'" data-x="'//fitted(canvas%shift(1))//'" data-y="'//fitted(canvas%shift(2)) &
         //'" data-origin="'//full(drawing%origin(1))//' '//full(drawing%origin(2)) &
         //'" data-t="'//full(snapshot%t)//'"', trim(canvas%mechanism%title))
      call draw_words(canvas%output, real([14, top + 24], wp), 'start', 'class="title"', &
         trim(whole(canvas%mechanism%set_number)//'.  '//canvas%mechanism%title))

   contains

      !> Widens the extent of the mechanism by places.
      subroutine widen(p)
         real(wp), intent(in) :: p(:, :)     !< (2, places) in lengths

         low = min(low, minval(p, dim=2))
         high = max(high, maxval(p, dim=2))
      end subroutine widen
   end subroutine make_canvas

   !> Gives the places (2, places) of a shape at a position; none if its link has no position there.
   pure function places_of(shape, snapshot) result(p)
      type(element_t), intent(in) :: shape   !< of a set
      type(snapshot_t), intent(in) :: snapshot   !< the position
      real(wp), allocatable :: p(:, :)

      p = shape%places
      if (shape%link == 0) return
      p = moved(p, snapshot%place(:, shape%link))
      if (.not. snapshot%known(shape%link)) p = p(:, :0)
   end function places_of

   !> Gives the pixel (2) of a place.
   pure function to_pixels(canvas, p) result(pixel)
      type(canvas_t), intent(in) :: canvas   !< of the set
      real(wp), intent(in) :: p(2)           !< lengths, from the drawing's origin
      real(wp) :: pixel(2)

      pixel = canvas%shift + canvas%scale*[p(1), -p(2)]
   end function to_pixels

   !> Gives the pixels (2, places) of a shape at a position; none if its link is not known there.
   pure function pixels_of(canvas, shape, snapshot) result(pixels)
      type(canvas_t), intent(in) :: canvas   !< of the set
      type(element_t), intent(in) :: shape   !< of a set
      type(snapshot_t), intent(in) :: snapshot   !< the position
      real(wp), allocatable :: pixels(:, :)
      real(wp) :: e(2)
      integer :: k

      e = [1.0_wp, 0.0_wp]
      if (shape%link > 0) e = direction(snapshot%place(3, shape%link))
      pixels = places_of(shape, snapshot)
      do k = 1, size(pixels, 2)
         pixels(:, k) = to_pixels(canvas, pixels(:, k)) + rotated(shape%pixels(:, k), e)*[1.0_wp, -1.0_wp]
      end do
   end function pixels_of

   !> Draws a shape at the position that the canvas shows, unless its link is not known there.
   subroutine draw_shape(canvas, shape)
      type(canvas_t), intent(inout) :: canvas   !< of the set
      type(element_t), intent(in) :: shape   !< the shape
      real(wp), allocatable :: pixels(:, :)

      pixels = pixels_of(canvas, shape, canvas%snapshot)
      if (size(pixels) == 0) return
      select case (shape%element)
      case ('circle')
         call draw_circle(canvas%output, pixels(:, 1), shape%radius, shape%attributes)
      case ('polygon')
         call draw_line(canvas%output, 'polygon', pixels, shape%attributes)
      case default
         call draw_line(canvas%output, 'polyline', pixels, shape%attributes)
      end select
   end subroutine draw_shape

   !> Records a shape at the position that the canvas shows, so that names keep clear of the shape.
   subroutine record_shape(canvas, shape)
      type(canvas_t), intent(inout) :: canvas   !< gets the shape
      type(element_t), intent(in) :: shape   !< the shape
      real(wp), allocatable :: pixels(:, :)

      pixels = pixels_of(canvas, shape, canvas%snapshot)
      if (size(pixels) == 0) return
      if (shape%weight < 0.0_wp) then
         call add_box(canvas, minval(pixels, dim=2) - shape%radius, maxval(pixels, dim=2) + shape%radius)
      else if (shape%weight > 0.0_wp) then
         if (shape%element == 'polygon') pixels = reshape([pixels, pixels(:, 1)], [2, size(pixels, 2) + 1])
         call add_lines(canvas, pixels, shape%weight)
      end if
   end subroutine record_shape

   !> Draws the outlines of moving shapes as thin lines at another position than the one in full.
   subroutine draw_outlines(canvas, list, snapshot)
      type(canvas_t), intent(inout) :: canvas   !< of the set
      type(element_t), intent(in) :: list(:)   !< all shapes; only the moving ones are drawn
      type(snapshot_t), intent(in) :: snapshot   !< the position
      real(wp), allocatable :: pixels(:, :)
      integer :: i

      do i = 1, size(list)
         if (.not. list(i)%is_faint .or. canvas%mechanism%links(max(1, list(i)%link))%ground) cycle
         pixels = pixels_of(canvas, list(i), snapshot)
         if (size(pixels) > 0) call draw_line(canvas%output, list(i)%element, pixels, 'class="thin"')
      end do
   end subroutine draw_outlines

   !> Gives a time in words, with the values of the drives, as many as `max_caption` letters have room for.
   function caption(canvas, t) result(words)
      type(canvas_t), intent(in) :: canvas   !< of the set
      real(wp), intent(in) :: t              !< the time, in the deck's unit
      character(:), allocatable :: words, next
      real(wp) :: f(0:2)
      integer :: i

      words = 'T = '//fitted(t)//' '//trim(canvas%mechanism%time_unit)
      do i = 1, size(canvas%mechanism%drives)
         associate (drive => canvas%mechanism%drives(i))
            f = drive_motion(drive, t)
            if (is_length(drive)) then
               next = fitted(f(0))//' '//trim(canvas%mechanism%length_unit)
            else
               next = fitted(merge(in_degrees(f(0)), f(0), canvas%mechanism%degrees))//' ' &
                  //trim(angle_unit(canvas%mechanism))
            end if
            next = ', '//trim(drive_name(canvas%mechanism, drive))//' = '//next
         end associate
         if (len(words) + len(next) > max_caption) exit
         words = words//next
      end do
   end function caption

   !> Ends the picture. Below it are the time of the first flagged instant, why it is flagged, and how many are. The
   !> scale bar is at the foot on the right.
   subroutine draw_foot(canvas)
      type(canvas_t), intent(in) :: canvas   !< of the set
      character(:), allocatable :: words

      if (canvas%drawing%flagged > 0) then
         associate (s => canvas%drawing%flag)
            words = 'T = '//fitted(s%t)//': '//words_of_flag(s%mark, s%singularity, canvas%mechanism%polish)
         end associate
         if (canvas%drawing%flagged > 1) words = words//'; ' &
            //phrase(text_flagged_in_all, canvas%mechanism%polish)//' '//whole(canvas%drawing%flagged)
         call draw_words(canvas%output, [14.0_wp, canvas%high(2) + 45.0_wp], 'start', 'class="flag"', words)
      end if
      call draw_bar(canvas, canvas%high(2) + 16.0_wp, canvas%scale, trim(canvas%mechanism%length_unit), 'class="scale"')
      call close_group(canvas%output, 'g')
   end subroutine draw_foot

   !> Draws a scale bar on the right. Its length is 1, 2 or 5 times a power of ten of the unit, at most `max_bar`.
   subroutine draw_bar(canvas, level, scale, unit, attributes)
      type(canvas_t), intent(in) :: canvas   !< of the picture
      real(wp), intent(in) :: level          !< pixels, down from the top of the page
      real(wp), intent(in) :: scale          !< pixels in one unit
      character(*), intent(in) :: unit       !< the name of the unit
      character(*), intent(in) :: attributes   !< of the line, as SVG
      real(wp) :: length, from, x

      length = 10.0_wp**floor(log10(max_bar/scale))
      if (5.0_wp*length*scale <= max_bar) then
         length = 5.0_wp*length
      else if (2.0_wp*length*scale <= max_bar) then
         length = 2.0_wp*length
      end if
      x = real(page_width - 24, wp)
      from = x - length*scale
      call draw_line(canvas%output, 'polyline', reshape([from, level - 4.0_wp, from, level + 4.0_wp, from, level, &
         x, level, x, level - 4.0_wp, x, level + 4.0_wp], [2, 6]), attributes)
      call draw_words(canvas%output, [from - 8.0_wp, level + 4.0_wp], 'end', 'class="time"', fitted(length)//' '//unit)
   end subroutine draw_bar

   !> Records the lines through points, which names should not cross.
   pure subroutine add_lines(canvas, points, weight)
      type(canvas_t), intent(inout) :: canvas   !< gets the lines
      real(wp), intent(in) :: points(:, :)   !< (2, points) pixels
      real(wp), intent(in) :: weight         !< the larger, the less a name may cross them
      real(wp) :: length, at(2)
      integer :: pieces, i, j, k(2)

      do j = 2, size(points, 2)
         length = norm2(points(:, j) - points(:, j - 1))
         pieces = ceiling(min(length/cell_side, real(max_pieces, wp)))
         do i = 1, pieces
            at = points(:, j - 1) + (real(i, wp) - 0.5_wp)/real(pieces, wp)*(points(:, j) - points(:, j - 1))
            if (any(at < canvas%low) .or. any(at > canvas%high)) cycle
            k = cell_of(canvas, at)
            canvas%ink(k(1), k(2)) = canvas%ink(k(1), k(2)) + weight*length/real(pieces, wp)
         end do
      end do
   end subroutine add_lines

   !> Records a box that names should not cover.
   pure subroutine add_box(canvas, p, corner)
      type(canvas_t), intent(inout) :: canvas   !< gets the box
      real(wp), intent(in) :: p(2)           !< pixel of the upper left corner of the box
      real(wp), intent(in) :: corner(2)      !< pixel of the lower right corner of the box

      associate (from => cell_of(canvas, p), to => cell_of(canvas, corner))
         canvas%ink(from(1):to(1), from(2):to(2)) = canvas%ink(from(1):to(1), from(2):to(2)) + name_weight
      end associate
   end subroutine add_box

   !> Finds the column and the row (2) of the cell at a pixel; outside the window those of the nearest cell. A pixel on
   !> the border of two cells belongs to one of them whatever its rounding: lines often lie at whole pixels.
   pure function cell_of(canvas, p) result(k)
      type(canvas_t), intent(in) :: canvas   !< with its cells
      real(wp), intent(in) :: p(2)           !< pixel
      integer :: k(2)

      k = 1 + int((min(max(p, canvas%low), canvas%high) - canvas%low + tie)/cell_side)
   end function cell_of

   !> Finds the place of a name at which the name covers least of all that is drawn. The places are on eight sides at
   !> several distances. The name is recorded as drawn.
   subroutine place_name(canvas, p, clear, name, label)
      type(canvas_t), intent(inout) :: canvas   !< with all lines and names so far; gets the name
      real(wp), intent(in) :: p(:, :)        !< (2, places) pixels: the name stands near one of these
      real(wp), intent(in) :: clear          !< pixels: the name should stay so far from other things
      character(*), intent(in) :: name       !< without blanks at its end
      type(label_t), intent(inout) :: label  !< gets all but its link and its attributes
      real(wp) :: low(2), high(2), half(2), distance, cost, least
      integer :: i, d, x, y

      half = 0.5_wp*[letter_width*real(len(name), wp), letter_height]
      least = huge(least)
      label%name = name
      label%clear = clear
      label%of = p(:, 1)
      label%start = p(:, 1)

      do d = 1, size(name_distances)
         do i = 1, size(p, 2)
            do y = 1, -1, -1
               do x = 1, -1, -1
                  if (x == 0 .and. y == 0) cycle
                  distance = name_distances(d)*merge(0.75_wp, 1.0_wp, x*y /= 0)
                  low = p(:, i) + [real(x, wp), -real(y, wp)]*(half + distance) - half
                  high = low + 2.0_wp*half
                  cost = cover(canvas, low - clear, high + clear) + distance_weight*name_distances(d)
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

   !> Writes the name of a label, with a thin line to the point or link if the name is far from it.
   subroutine draw_label(canvas, label)
      type(canvas_t), intent(in) :: canvas   !< of the set
      type(label_t), intent(in) :: label     !< with its place

      if (norm2(label%near - label%of) > label%clear + longest_without_line) &
         call draw_line(canvas%output, 'polyline', reshape([label%of, label%near], [2, 2]), 'class="leader"')
      call draw_words(canvas%output, label%start, 'start', label%attributes, label%name)
   end subroutine draw_label

   !> Measures how much of all that is drawn a line would cover or come near, in pixels of lines.
   pure real(wp) function cover_of(canvas, p)
      type(canvas_t), intent(in) :: canvas   !< with all that is drawn
      real(wp), intent(in) :: p(:, :)        !< (2, places) pixels of the line
      integer :: i

      cover_of = 0.0_wp
      do i = 1, size(p, 2)
         cover_of = cover_of + cover(canvas, p(:, i) - least_gap, p(:, i) + least_gap)
      end do
   end function cover_of

   !> Measures how much of all that is drawn a box covers, in pixels of lines. A box that leaves the window costs more.
   pure real(wp) function cover(canvas, low, high)
      type(canvas_t), intent(in) :: canvas   !< with all that is drawn
      real(wp), intent(in) :: low(2), high(2)   !< pixels of the upper left and the lower right corner of the box

      associate (from => cell_of(canvas, low), to => cell_of(canvas, high))
         cover = sum(canvas%ink(from(1):to(1), from(2):to(2)))
      end associate
      if (any(low < canvas%low) .or. any(high > canvas%high)) cover = cover + outside_weight
   end function cover
end module canvas
