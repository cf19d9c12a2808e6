!> The page of a picture: where each set is drawn, and what stands around the mechanism: title, flagged instants, scale.
module picture_page
   use kinds, only: wp
   use planar, only: point_of
   use numerals, only: full, whole, fixed, max_decimals
   use drawing, only: drawing_t, snapshot_t, point_place
   use canvas, only: canvas_t
   use picture_parts, only: guide_ends
   use svg, only: put_group, put_line, put_words, without_zeros
   use text_output, only: output_t, put
   use listing, only: words_of_mark
   use phrases
   implicit none
   private
   public :: picture_head, place_canvas, put_set_head, put_flags, put_scale, flag_lines, fitted

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
   !> The length of the scale bar, at most.
   real(wp), parameter :: max_bar = 150.0_wp

contains

   !> The first line of a file that holds a picture.
   subroutine picture_head(o)
      type(output_t), intent(inout) :: o

      call put(o, '<?xml version="1.0" encoding="US-ASCII"?>')
   end subroutine picture_head

   !> Places the canvas `c` on the page, from the pixel `top` on, and what it shows on the canvas. The scale has three
   !> digits, the height is even and the shift whole: rounding errors of the results do not move the picture, and none
   !> of these is near a tie for what is symmetric or has few digits.
   subroutine place_canvas(c, top)
      type(canvas_t), intent(inout) :: c
      integer, intent(in) :: top
      real(wp) :: low(2), high(2), size_of_it(2), room
      integer :: height

      call find_extent(c, low, high)
      size_of_it = high - low
      room = real(width, wp) - 2.0_wp*margin
      c%scale = 1.0_wp
      if (any(size_of_it > 0.0_wp)) c%scale = rounded_down(1.0_wp/max(size_of_it(1)/room, size_of_it(2)/max_height))
      height = 2*ceiling(0.5_wp*max(min_height, c%scale*size_of_it(2)) + margin - tie)
      c%top = top
      c%bottom = top + above + height + below + line_height*flag_lines(c%d)
      c%shift = anint([0.5_wp*real(width, wp) - c%scale*(low(1) + 0.5_wp*size_of_it(1)), &
         real(top + above, wp) + 0.5_wp*real(height, wp) + c%scale*(low(2) + 0.5_wp*size_of_it(2))])
      c%low = [4.0_wp, real(top + above, wp)]
      c%high = [real(width - 4, wp), real(top + above + height, wp)]
   end subroutine place_canvas

   !> The corners `low` and `high` (2) of what the picture shows.
   subroutine find_extent(c, low, high)
      type(canvas_t), intent(in) :: c
      real(wp), intent(out) :: low(2), high(2)
      logical, dimension(size(c%m%points)) :: moves, is_joined
      integer :: i, k

      moves = .not. c%m%links(c%m%points%link)%ground
      ! Of the ground what pairs use, but not what guides are counted from: it need not lie on them.
      is_joined = .false.
      is_joined([c%m%pairs%point_i, c%m%pairs%point_j]) = .true.
      is_joined(c%d%guides%pivot) = .false.
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      associate (d => c%d)
         call widen_by_points(d, d%now, is_joined .and. .not. moves, low, high)
         if (c%best > 0) then
            call widen_by_points(d, d%frame(c%best), moves, low, high)
            call widen_by_guides(d, d%frame(c%best), low, high)
         end if
         do i = 1, size(c%faint)
            call widen_by_points(d, d%frame(c%faint(i)), moves, low, high)
         end do
         do i = 1, size(d%flags)
            call widen_by_points(d, d%flags(i)%last, moves, low, high)
         end do
         do i = 1, size(d%curves)
            do k = 1, size(d%curves(i)%known)
               if (d%curves(i)%known(k) >= 0) call widen(d%curves(i)%place(:, k), low, high)
            end do
         end do
         if (.not. all(low <= high)) then
            low = 0.0_wp
            high = 0.0_wp
         end if
         if (c%best > 0) call widen_by_centrodes(d, d%frame(c%best), low, high)
      end associate
   end subroutine find_extent

   !> Widens the box from `low` to `high` (2) by the points that are `wanted` and known at `s`.
   subroutine widen_by_points(d, s, wanted, low, high)
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      logical, intent(in) :: wanted(:)
      real(wp), intent(inout) :: low(2), high(2)
      integer :: i

      do i = 1, size(wanted)
         if (wanted(i) .and. s%known(d%m%points(i)%link)) call widen(point_place(d%m, s, i), low, high)
      end do
   end subroutine widen_by_points

   !> The same by the guides as they are drawn at `s`.
   subroutine widen_by_guides(d, s, low, high)
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      real(wp), intent(inout) :: low(2), high(2)
      real(wp) :: ends(2, 2)
      integer :: i

      do i = 1, size(d%guides)
         associate (g => d%guides(i))
            if (.not. s%known(g%carrier) .or. g%high < g%low) cycle
            ends = guide_ends(g, s)
            call widen(ends(:, 1), low, high)
            call widen(ends(:, 2), low, high)
            if (.not. d%m%links(g%carrier)%ground) call widen(point_of(s%place(:, g%carrier), g%foot), low, high)
         end associate
      end do
   end subroutine widen_by_guides

   !> Widens the box from `low` to `high` (2) by the instant centres at `s` and by what there is of their centrodes in
   !> the box that is wider by `centrode_room` on all sides: they may run to infinity.
   subroutine widen_by_centrodes(d, s, low, high)
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      real(wp), intent(inout) :: low(2), high(2)
      real(wp) :: wide_low(2), wide_high(2), room
      integer :: i, k, side

      room = centrode_room*maxval(high - low)
      wide_low = low - room
      wide_high = high + room
      do i = 1, size(d%centrodes)
         associate (c => d%centrodes(i))
            if (s%has_centre(i)) call widen_inside(s%centre(:, i))
            do side = 1, 2
               do k = 1, size(c%side)
                  if (c%side(k) /= 0 .and. s%known(c%link(side))) &
                     call widen_inside(point_of(s%place(:, c%link(side)), c%place(:, k, side)))
               end do
            end do
         end associate
      end do

   contains

      !> Widens the box by the place `p`, if that is in the wider one.
      subroutine widen_inside(p)
         real(wp), intent(in) :: p(2)

         if (all(p >= wide_low) .and. all(p <= wide_high)) call widen(p, low, high)
      end subroutine widen_inside
   end subroutine widen_by_centrodes

   !> Widens the box from `low` to `high` (2) by the place `p` (2).
   pure subroutine widen(p, low, high)
      real(wp), intent(in) :: p(2)
      real(wp), intent(inout) :: low(2), high(2)

      low = min(low, p)
      high = max(high, p)
   end subroutine widen

   !> `x` > 0 with three digits, not larger than it was but for `tie`.
   pure real(wp) function rounded_down(x)
      real(wp), intent(in) :: x
      integer :: e

      e = 2 - floor(log10(x))
      if (e >= 0) rounded_down = aint(x*(1.0_wp + tie)*10.0_wp**e)/10.0_wp**e
      if (e < 0) rounded_down = aint(x*(1.0_wp + tie)/10.0_wp**(-e))*10.0_wp**(-e)
   end function rounded_down

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
