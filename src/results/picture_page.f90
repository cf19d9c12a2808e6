!> The page of a picture: where each set is drawn, and what stands around the mechanism: title, flagged instants, scale.
module picture_page
   use kinds, only: wp
   use planar, only: point_of
   use numerals, only: full, whole, fixed, max_decimals
   use drawing, only: drawing_t, snapshot_t, point_place, joint_point, corners_at
   use shapes, only: element_t, shapes_of, link_color
   use canvas, only: canvas_t, to_pixels, add_line
   use svg, only: put_group, put_end, put_line, put_circle, put_words, without_zeros
   use listing, only: words_of_mark
   use phrases
   implicit none
   private
   public :: place_canvas, paths_of, put_outlines, put_flagged, put_ring, put_set_head, put_flags, &
      put_scale, flag_lines, fitted

   integer, parameter, public :: width = 800
   !> Room around what is drawn, for names and supports; largest and least height of what is drawn.
   real(wp), parameter :: margin = 62.0_wp, max_height = 520.0_wp, min_height = 60.0_wp
   !> Room above for the title and below for times and scale; height of a line of words.
   integer, parameter :: above = 34, below = 44
   integer, parameter, public :: line_height = 17
   !> What rounds to the lower number although it is above it, a rounding error being the reason.
   real(wp), parameter :: tie = 1.0e-6_wp
   !> By this part of its larger side a mechanism's picture is wider on each side, at most, for centrodes.
   real(wp), parameter :: centrode_room = 0.4_wp
   !> Places of a path that differ by no more than this part of its extent are one.
   real(wp), parameter :: same_place = 1.0e-6_wp
   !> The rings of an instant centre and of a joint at a flagged position.
   real(wp), parameter, public :: centre_radius = 4.0_wp
   real(wp), parameter :: ring_radius = 8.0_wp
   !> The length of the scale bar, at most.
   real(wp), parameter :: max_bar = 150.0_wp

contains

   !> Places the canvas `c` on the page, from the pixel `top` on, and what it shows on the canvas. The scale has three
   !> digits, the height is even and the shift whole: rounding errors of the results do not move the picture, and none
   !> of these is near a tie for what is symmetric or has few digits.
   subroutine place_canvas(c, top)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: top
      real(wp) :: low(2), high(2), size_of_it(2), room, power
      real(wp) :: from(2), to(2)               ! nothing is drawn beyond these
      integer :: height, e

      call find_extent()
      size_of_it = high - low
      room = real(width, wp) - 2.0_wp*margin
      c%scale = 1.0_wp
      if (any(size_of_it > 0.0_wp)) then
         c%scale = 1.0_wp/max(size_of_it(1)/room, size_of_it(2)/max_height)
         e = 2 - floor(log10(c%scale))
         power = 10.0_wp**abs(e)
         c%scale = c%scale*(1.0_wp + tie)
         if (e >= 0) c%scale = aint(c%scale*power)/power
         if (e < 0) c%scale = aint(c%scale/power)*power
      end if
      height = 2*ceiling(0.5_wp*max(min_height, c%scale*size_of_it(2)) + margin - tie)
      c%top = top
      c%bottom = top + above + height + below + line_height*flag_lines(c%d)
      c%shift = anint([0.5_wp*real(width, wp) - c%scale*(low(1) + 0.5_wp*size_of_it(1)), &
         real(top + above, wp) + 0.5_wp*real(height, wp) + c%scale*(low(2) + 0.5_wp*size_of_it(2))])
      c%low = [4.0_wp, real(top + above, wp)]
      c%high = [real(width - 4, wp), real(top + above + height, wp)]

   contains

      !> The corners `low` and `high` (2) of what is drawn: all shapes at the position in full, links at the others,
      !> paths, and centrodes, which may run to infinity, as far as the picture is wider by `centrode_room` on all sides
      !> at most.
      subroutine find_extent()
         type(element_t), allocatable :: all_shapes(:)
         integer :: i, k

         low = huge(1.0_wp)
         high = -huge(1.0_wp)
         from = -huge(1.0_wp)
         to = huge(1.0_wp)
         all_shapes = shapes_of(c%d, spread(.true., 1, size(c%m%links)), 1.0_wp)
         do i = 1, size(all_shapes)
            associate (shape => all_shapes(i))
               if (shape%element == 'cut') cycle
               call widen_by_shape(shape, c%s)
               if (shape%is_below) cycle
               do k = 1, size(c%faint)
                  call widen_by_shape(shape, c%d%frame(c%faint(k)))
               end do
               do k = 1, size(c%d%flags)
                  call widen_by_shape(shape, c%d%flags(k)%last)
               end do
            end associate
         end do
         do i = 1, size(c%paths)
            do k = 1, c%d%films
               if (c%d%frame(k)%known(c%m%points(c%paths(i))%link)) &
                  call widen(point_place(c%m, c%d%frame(k), c%paths(i)))
            end do
         end do
         if (.not. all(low <= high)) then
            low = 0.0_wp
            high = 0.0_wp
         end if

         from = low - centrode_room*maxval(high - low)
         to = high + centrode_room*maxval(high - low)
         do i = 1, size(c%d%poles)
            if (c%s%has_centre(i)) call widen(c%s%centre(:, i))
         end do
         do i = 1, size(all_shapes)
            if (all_shapes(i)%element == 'cut') call widen_by_shape(all_shapes(i), c%s)
         end do
      end subroutine find_extent

      !> Widens the box by the places of `shape` at the position `s`, if they are known there.
      subroutine widen_by_shape(shape, s)
         type(element_t), intent(in) :: shape
         type(snapshot_t), intent(in) :: s
         real(wp) :: position(3)
         integer :: k

         position = 0.0_wp
         if (shape%link > 0) then
            if (.not. s%known(shape%link)) return
            position = s%place(:, shape%link)
         end if
         do k = 1, size(shape%p, 2)
            call widen(point_of(position, shape%p(:, k)))
         end do
      end subroutine widen_by_shape

      !> Widens the box by the place `p` (2).
      subroutine widen(p)
         real(wp), intent(in) :: p(2)

         if (any(p < from) .or. any(p > to)) return
         low = min(low, p)
         high = max(high, p)
      end subroutine widen
   end subroutine place_canvas

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

   !> Draws the moving links as thin lines at the position `s`; names keep clear of them if `counts`.
   subroutine put_outlines(c, s, counts)
      type(canvas_t), intent(inout) :: c
      type(snapshot_t), intent(in) :: s
      logical, intent(in) :: counts
      real(wp), allocatable :: p(:, :)
      integer :: i, k, n

      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground .or. .not. s%known(i)) cycle
         p = corners_at(c%d%outlines(i), s%place(:, i))
         n = size(p, 2)
         if (n < 2) cycle
         do k = 1, n
            p(:, k) = to_pixels(c, p(:, k))
         end do
         call put_line(c%o, trim(merge('polygon ', 'polyline', n > 2)), p, 'class="thin"')
         if (.not. counts) cycle
         do k = 1, n
            call add_line(c, p(:, k), p(:, 1 + modulo(k, n)), 1.0_wp)
         end do
      end do
   end subroutine put_outlines

   !> Draws the flagged position `s`: thin lines, and rings about the joints, which show where the lines are covered.
   subroutine put_flagged(c, s)
      type(canvas_t), intent(inout) :: c
      type(snapshot_t), intent(in) :: s
      integer :: i

      call put_group(c%o, 'class="flagged"', '')
      call put_outlines(c, s, .true.)
      do i = 1, size(c%m%pairs)
         associate (point => joint_point(c%d, s%known, i))
            if (point > 0) call put_circle(c%o, to_pixels(c, point_place(c%m, s, point)), ring_radius, 'class="ring"')
         end associate
      end do
      call put_end(c%o, 'g')
   end subroutine put_flagged

   !> Draws the ring of the instant centre of pole number `i` at the pixel `p` (2).
   subroutine put_ring(c, i, p)
      type(canvas_t), intent(in) :: c
      integer, intent(in) :: i
      real(wp), intent(in) :: p(2)

      call put_circle(c%o, p, centre_radius, 'class="centre" style="stroke:' &
         //link_color(c%m, c%m%requests(c%d%poles(i))%subject)//'"')
      call put_circle(c%o, p, 1.0_wp, 'class="point"')
   end subroutine put_ring

   !> Begins the group of a set, with its title. `t`: the instant that is drawn.
   subroutine put_set_head(c, t)
      type(canvas_t), intent(in) :: c
      real(wp), intent(in) :: t

      call put_group(c%o, 'class="set" data-set="'//whole(c%m%set_number)//'" data-scale="'//full(c%scale) &
         //'" data-x="'//fitted(c%shift(1))//'" data-y="'//fitted(c%shift(2)) &
         //'" data-origin="'//full(c%d%origin(1))//' '//full(c%d%origin(2))//'" data-t="'//full(t)//'"', &
         trim(c%m%title))
      call put_words(c%o, real([14, c%top + 24], wp), 'start', 'class="title"', &
         trim(whole(c%m%set_number)//'.  '//c%m%title))
   end subroutine put_set_head

   !> The lines of words about flagged instants: one for each that is drawn, and one where there are more.
   pure integer function flag_lines(d)
      type(drawing_t), intent(in) :: d

      flag_lines = size(d%flags)
      if (d%flagged > size(d%flags)) flag_lines = flag_lines + 1
   end function flag_lines

   !> Below the picture: when and why instants are flagged, and what is drawn of them.
   subroutine put_flags(c)
      type(canvas_t), intent(in) :: c
      character(:), allocatable :: words
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
   end subroutine put_flags

   !> The scale bar, at the foot on the right: 1, 2 or 5 times a power of ten units of length.
   subroutine put_scale(c)
      type(canvas_t), intent(in) :: c
      real(wp) :: length, y, x
      integer :: e

      e = floor(log10(max_bar/c%scale))
      length = 10.0_wp**e
      if (5.0_wp*length*c%scale <= max_bar) then
         length = 5.0_wp*length
      else if (2.0_wp*length*c%scale <= max_bar) then
         length = 2.0_wp*length
      end if
      x = real(width - 24, wp)
      y = c%high(2) + 16.0_wp
      associate (from => x - length*c%scale)
         call put_line(c%o, 'polyline', reshape([from, y - 4.0_wp, from, y + 4.0_wp, from, y, x, y, x, y - 4.0_wp, &
            x, y + 4.0_wp], [2, 6]), 'class="scale"')
         call put_words(c%o, [from - 8.0_wp, y + 4.0_wp], 'end', 'class="time"', &
            fitted(length)//' '//trim(c%m%length_unit))
      end associate
   end subroutine put_scale

   !> `x` with six digits, without zeros at their end. A negative number keeps the zero before its point.
   pure function fitted(x) result(text)
      real(wp), intent(in) :: x
      character(:), allocatable :: text
      integer :: e

      e = 0
      if (abs(x) > 0.0_wp) e = floor(log10(abs(x)))
      if (abs(x) > 0.0_wp .and. (e < -4 .or. e > 5)) then
         text = without_zeros(fixed(x, 5, e))//'E'//whole(e)
      else
         text = without_zeros(fixed(x, min(5 - e, max_decimals - merge(1, 0, x < 0.0_wp)), 0))
      end if
   end function fitted
end module picture_page
