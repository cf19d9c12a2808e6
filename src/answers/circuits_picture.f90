!> The picture of circuits as SVG: for each set and drive a diagram of each number over the drive, each circuit in its
!> own colour; dots are dead points, rings change points, numbers assemblies of the first instant.
module circuits_picture
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_pair
   use names, only: drive_name, subject_name
   use numerals, only: whole
   use set_analysis, only: set_analysis_t
   use listing_layout, only: angle_unit
   use circuit_branches, only: circuits_t
   use circuit_chart, only: chart_t, axis_t, make_charts
   use shapes, only: color_of
   use picture_page, only: width, fitted
   use svg, only: attribute, svg_head, put_end, put_group, put_line, put_circle, put_words, put_window
   use text_output, only: output_t
   use phrases
   implicit none
   private
   public :: circuit_page_t, add_to_page, put_circuit_page

   !> The diagrams of one drive.
   type :: diagrams_t
      character(:), allocatable :: title, drive, drive_unit, circuit   !< words
      character(40), allocatable :: names(:)       !< (charts) of the numbers
      type(chart_t), allocatable :: charts(:)
   end type diagrams_t

   !> All diagrams of a page.
   type :: circuit_page_t
      type(diagrams_t), allocatable :: list(:)
   end type circuit_page_t

   !> The diagram: room on its left, right, above and below it, and its height, in pixels.
   real(wp), parameter :: left = 84.0_wp, right = 24.0_wp, above = 26.0_wp, below = 42.0_wp, height = 300.0_wp
   !> Height of the title of a drive with its legend.
   real(wp), parameter :: head = 56.0_wp
   real(wp), parameter :: dot = 3.5_wp, ring = 6.0_wp, tick = 5.0_wp
   !> Steps between ticks, in any power of ten or in degrees; at most so many.
   real(wp), parameter :: steps(*) = [1.0_wp, 2.0_wp, 5.0_wp, 10.0_wp]
   real(wp), parameter :: degree_steps(*) = [1.0_wp, 2.0_wp, 5.0_wp, 10.0_wp, 15.0_wp, 30.0_wp, 45.0_wp, 60.0_wp, &
      90.0_wp]
   integer, parameter :: most_ticks = 9

contains

   !> Adds the diagrams of the circuits `found` of the set `m`, which `s` analyses, to `page`.
   subroutine add_to_page(page, m, s, found)
      type(circuit_page_t), intent(inout) :: page
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(circuits_t), intent(in) :: found(:)
      type(diagrams_t), allocatable :: more(:)
      integer :: i, k, n

      if (.not. allocated(page%list)) allocate (page%list(0))
      do i = 1, size(found)
         n = size(page%list) + 1
         allocate (more(n))
         more(:n - 1) = page%list
         associate (d => more(n))
            d%title = trim(whole(m%set_number)//'.  '//m%title)
            d%circuit = phrase(say_circuit, m%polish)
            d%drive = trim(drive_name(m, m%drives(found(i)%drive)))
            allocate (d%charts(0))
            if (size(found(i)%list) > 0) call make_charts(s, found(i)%part, found(i), d%charts)
            d%drive_unit = unit_of(m, found(i)%curve%is_angle)
            allocate (d%names(size(d%charts)))
            do k = 1, size(d%charts)
               d%names(k) = name_of(s%now%own(found(i)%part), d%charts(k))
            end do
         end associate
         call move_alloc(more, page%list)
      end do
   end subroutine add_to_page

   !> The unit of an angle or a length.
   pure function unit_of(m, is_angle) result(text)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: is_angle
      character(:), allocatable :: text

      text = trim(merge(angle_unit(m), m%length_unit, is_angle))
   end function unit_of

   !> The name of the number of `chart`, with its unit: PHI ROCKER, DEG
   pure function name_of(m, chart) result(text)
      type(mechanism_t), intent(in) :: m
      type(chart_t), intent(in) :: chart
      character(:), allocatable :: text
      character(3), parameter :: columns(3) = ['X  ', 'Y  ', 'PHI']

      text = ''
      if (chart%request%kind /= request_pair) text = trim(columns(chart%column))//' '
      if (chart%column == 3 .and. m%polish) text = 'FI '
      text = text//trim(subject_name(m, chart%request%kind, chart%request%subject))//', ' &
         //unit_of(m, chart%axes(2)%is_angle)
   end function name_of

   !> Writes the page.
   subroutine put_circuit_page(o, page)
      type(output_t), intent(inout) :: o
      type(circuit_page_t), intent(inout) :: page
      real(wp) :: top
      integer :: i, k

      if (.not. allocated(page%list)) allocate (page%list(0))
      top = 0.0_wp
      do i = 1, size(page%list)
         top = top + head + size(page%list(i)%charts)*(above + height + below)
      end do
      call svg_head(o, width, max(1, nint(top)))
      top = 0.0_wp
      do i = 1, size(page%list)
         associate (d => page%list(i))
            call put_words(o, [14.0_wp, top + 24.0_wp], 'start', 'class="title"', d%title)
            call put_legend(o, d, top + 44.0_wp)
            top = top + head
            do k = 1, size(d%charts)
               call put_chart(o, d, k, top)
               top = top + above + height + below
            end do
         end associate
      end do
      call put_end(o, 'svg')
   end subroutine put_circuit_page

   !> Names of the circuits in their colours, in a line at the pixel `y`, as far as there is room.
   subroutine put_legend(o, d, y)
      type(output_t), intent(inout) :: o
      type(diagrams_t), intent(in) :: d
      real(wp), intent(in) :: y
      real(wp), parameter :: room = 70.0_wp
      integer :: i

      if (size(d%charts) == 0) return
      do i = 1, min(size(d%charts(1)%traces), int((real(width, wp) - 20.0_wp)/room))
         call put_words(o, [14.0_wp + room*real(i - 1, wp), y], 'start', 'style="fill:'//color_of(i)//'"', &
            d%circuit//' '//whole(i))
      end do
   end subroutine put_legend

   !> Diagram number `k` of `d`, from the pixel `top` on.
   subroutine put_chart(o, d, k, top)
      type(output_t), intent(inout) :: o
      type(diagrams_t), intent(in) :: d
      integer, intent(in) :: k
      real(wp), intent(in) :: top
      real(wp) :: corner(2), extent(2)
      integer :: i

      corner = [left, top + above]
      extent = [real(width, wp) - left - right, height]
      associate (chart => d%charts(k))
         call put_group(o, 'class="circuits" '//attribute('data-drive', d%drive), trim(d%names(k)))
         call put_axis(o, chart%axes(1), 1, corner, extent)
         call put_axis(o, chart%axes(2), 2, corner, extent)
         call put_words(o, corner + [0.0_wp, -8.0_wp], 'start', 'class="time"', trim(d%names(k)))
         call put_words(o, corner + extent + [0.0_wp, 34.0_wp], 'end', 'class="time"', d%drive//', '//d%drive_unit)
         call put_window(o, corner, extent)
         do i = 1, size(chart%traces)
            call put_group(o, 'class="circuit" data-circuit="'//whole(i)//'" style="stroke:'//color_of(i)//'"', &
               d%circuit//' '//whole(i))
            call put_trace(o, chart, i, extent)
            call put_end(o, 'g')
         end do
         call put_end(o, 'svg')
         call put_line(o, 'polygon', reshape([corner, corner(1) + extent(1), corner(2), corner + extent, corner(1), &
            corner(2) + extent(2)], [2, 4]), 'style="stroke:#222;stroke-width:1"')
         call put_end(o, 'g')
      end associate
   end subroutine put_chart

   !> Circuit number `i` of `chart` in a window of `extent` (2) pixels: as many times, whole turns apart, as it enters
   !> it.
   subroutine put_trace(o, chart, i, extent)
      type(output_t), intent(inout) :: o
      type(chart_t), intent(in) :: chart
      integer, intent(in) :: i
      real(wp), intent(in) :: extent(2)
      integer :: low(2), high(2), x, y, k

      associate (t => chart%traces(i))
         low = 0
         high = 0
         do k = 1, 2
            if (chart%axes(k)%turn <= 0.0_wp) cycle
            low(k) = floor((minval(t%p(k, :)) - chart%axes(k)%low)/chart%axes(k)%turn)
            high(k) = floor((maxval(t%p(k, :)) - chart%axes(k)%low)/chart%axes(k)%turn)
         end do
         do x = low(1), high(1)
            do y = low(2), high(2)
               call put_line(o, 'polyline', pixels_of(t%p, [x, y]), 'class="curve" style="stroke:'//color_of(i)//'"')
            end do
         end do
         do k = 1, size(t%dead, 2)
            call put_circle(o, inside(t%dead(:, k)), dot, 'class="dead" style="stroke:none;fill:'//color_of(i)//'"')
         end do
         do k = 1, size(t%changes, 2)
            call put_circle(o, inside(t%changes(:, k)), ring, 'class="change" style="fill:none;stroke:' &
               //color_of(i)//'"')
         end do
         do k = 1, size(t%numbers)
            call put_words(o, inside(t%assemblies(:, k)) + [0.0_wp, 4.0_wp], 'middle', 'class="assembly" style="fill:' &
               //color_of(i)//'"', whole(t%numbers(k)))
         end do
      end associate

   contains

      !> The pixels of the places `p` (2, :), less so many `turns`.
      pure function pixels_of(p, turns) result(q)
         real(wp), intent(in) :: p(:, :)
         integer, intent(in) :: turns(2)
         real(wp) :: q(2, size(p, 2))
         integer :: k

         do k = 1, 2
            associate (axis => chart%axes(k))
               q(k, :) = (p(k, :) - turns(k)*axis%turn - axis%low)/(axis%high - axis%low)
            end associate
         end do
         q(1, :) = q(1, :)*extent(1)
         q(2, :) = (1.0_wp - q(2, :))*extent(2)
      end function pixels_of

      !> The pixel of the place `p` without whole turns.
      pure function inside(p) result(q)
         real(wp), intent(in) :: p(2)
         real(wp) :: q(2), one(2, 1)
         integer :: turns(2), k

         turns = 0
         do k = 1, 2
            associate (axis => chart%axes(k))
               if (axis%turn > 0.0_wp) turns(k) = floor((p(k) - axis%low)/axis%turn)
            end associate
         end do
         one = pixels_of(reshape(p, [2, 1]), turns)
         q = one(:, 1)
      end function inside
   end subroutine put_trace

   !> Ticks and numbers of `axis` on side `k`, 1 below, 2 on the left, of the diagram at `corner` of `extent`.
   subroutine put_axis(o, axis, k, corner, extent)
      type(output_t), intent(inout) :: o
      type(axis_t), intent(in) :: axis
      integer, intent(in) :: k
      real(wp), intent(in) :: corner(2), extent(2)
      ! From the side to the end of a tick, and to its number.
      real(wp), parameter :: to_end(2, 2) = reshape([0.0_wp, tick, -tick, 0.0_wp], [2, 2])
      real(wp), parameter :: to_number(2, 2) = reshape([0.0_wp, tick + 13.0_wp, -tick - 4.0_wp, 4.0_wp], [2, 2])
      character(6), parameter :: anchors(2) = ['middle', 'end   ']
      real(wp) :: step, x, p(2)
      integer(int64) :: i

      step = step_of(axis)
      do i = ceiling(axis%low/step - 1.0e-6_wp, int64), floor(axis%high/step + 1.0e-6_wp, int64)
         x = (real(i, wp)*step - axis%low)/(axis%high - axis%low)
         p = corner + extent*merge([x, 1.0_wp], [0.0_wp, 1.0_wp - x], k == 1)
         call put_line(o, 'polyline', reshape([p, p + to_end(:, k)], [2, 2]), 'style="stroke:#222;stroke-width:1"')
         call put_words(o, p + to_number(:, k), trim(anchors(k)), 'class="between"', fitted(real(i, wp)*step))
      end do
   end subroutine put_axis

   !> The step between ticks of `axis`.
   pure real(wp) function step_of(axis) result(step)
      type(axis_t), intent(in) :: axis
      real(wp) :: range, power
      integer :: k

      range = axis%high - axis%low
      if (axis%is_angle .and. range > 8.0_wp) then
         do k = 1, size(degree_steps)
            step = degree_steps(k)
            if (range <= step*most_ticks) return
         end do
      end if
      power = 10.0_wp**floor(log10(max(range, sqrt(tiny(range)))/most_ticks))
      do k = 1, size(steps)
         step = steps(k)*power
         if (range <= step*most_ticks) return
      end do
   end function step_of
end module circuits_picture
