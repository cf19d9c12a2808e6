!> The picture of circuits as SVG: for each set and drive a diagram of each number that PRINT asks for and that varies,
!> over the drive, each circuit in its own colour; dots are dead points, rings change points, numbers assemblies of the
!> first instant. An angle that goes on for more than a turn is drawn without whole turns.
module circuits_picture
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp, label_length
   use planar, only: pi, degree, without_turns
   use mechanism, only: mechanism_t, request_t, request_link, request_point, request_pair, drive_angle
   use motion, only: motion_t, new_motion
   use names, only: drive_name, subject_name
   use numerals, only: whole
   use points, only: row_t, row_of, coordinates_of
   use set_analysis, only: set_analysis_t
   use listing_layout, only: angle_unit
   use extremes, only: is_angle
   use circuit_curve, only: deck_position, drive_value
   use circuit_trace, only: end_closed
   use circuits, only: circuits_t
   use shapes, only: color_of
   use picture_page, only: width, fitted
   use svg, only: attribute, svg_head, put_end, put_group, put_line, put_circle, put_words, put_window
   use text_output, only: output_t
   use phrases
   implicit none
   private
   public :: diagrams_t, chart_t, add_to_page, put_circuit_page

   !> An axis, in the unit in which its numbers are printed.
   type :: axis_t
      character(:), allocatable :: name         !< with its unit
      real(wp) :: low = 0.0_wp, high = 1.0_wp
      real(wp) :: turn = 0.0_wp                 !< of an angle that is drawn without whole turns: a turn; otherwise 0
      logical :: is_angle = .false.
   end type axis_t

   !> A curve and marks on it, the numbers of both axes.
   type :: graph_t
      real(wp), allocatable :: p(:, :)          !< (2, points)
      real(wp), allocatable :: mark(:, :)       !< (2, marks)
      integer, allocatable :: kind(:)           !< (marks) a number above 0; mark_dot or mark_ring
   end type graph_t
   integer, parameter, public :: mark_dot = 0, mark_ring = -1

   type :: chart_t
      type(axis_t) :: axes(2)
      type(graph_t), allocatable :: curves(:)
   end type chart_t

   !> The diagrams of one drive, and their words.
   type :: diagrams_t
      character(:), allocatable :: title, drive, circuit
      type(chart_t), allocatable :: charts(:)
   end type diagrams_t

   !> A number varies if it does so by more than this, in rad or in lengths of the curve.
   real(wp), parameter :: varies = 1.0e-6_wp
   !> Height of the title of a drive with its legend, and width of a name in the legend, in pixels.
   real(wp), parameter :: head = 56.0_wp, room = 70.0_wp
   !> Room on the left of the diagram, on its right, above and below it, and its height, in pixels.
   real(wp), parameter :: left = 84.0_wp, right = 24.0_wp, above = 26.0_wp, below = 42.0_wp, height = 300.0_wp, &
      chart_height = above + height + below
   real(wp), parameter :: dot = 3.5_wp, ring = 6.0_wp, tick = 5.0_wp
   !> An axis goes on by this part of its values, or of the largest of them where all are the same.
   real(wp), parameter :: margin = 0.04_wp, least_margin = 4096.0_wp*epsilon(1.0_wp)
   !> Steps between ticks, in any power of ten or in degrees; at most so many.
   real(wp), parameter :: steps(*) = [1.0_wp, 2.0_wp, 5.0_wp, 10.0_wp]
   real(wp), parameter :: degree_steps(*) = [1.0_wp, 2.0_wp, 5.0_wp, 10.0_wp, 15.0_wp, 30.0_wp, 45.0_wp, 60.0_wp, &
      90.0_wp]
   integer, parameter :: most_ticks = 9

contains

   !> Adds the diagrams of the circuits `found` of the set `m`, which `s` analyses, to `page`: a chart for each number
   !> that PRINT asks for and that varies, not driven.
   subroutine add_to_page(page, m, s, found)
      type(diagrams_t), allocatable, intent(inout) :: page(:)
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(circuits_t), intent(in) :: found(:)
      type(diagrams_t) :: d
      type(chart_t) :: one
      integer :: i, k, column
      logical :: does_vary

      if (.not. allocated(page)) allocate (page(0))
      do i = 1, size(found)
         associate (own => s%now%parts(found(i)%part), drive => s%now%parts(found(i)%part)%drives(found(i)%drive))
            d%title = trim(whole(m%set_number)//'.  '//m%title)
            d%circuit = phrase(say_circuit, m%polish)
            d%drive = trim(drive_name(own, drive))
            d%charts = [chart_t ::]
            do k = 1, merge(size(own%requests), 0, size(found(i)%list) > 0)
               associate (r => own%requests(k))
                  if (r%every == 0 .or. all(r%kind /= [request_link, request_point, request_pair])) cycle
                  does_vary = .false.
                  do column = coordinates_of(r%kind), 1, -1
                     ! Of a link that turns its angle alone.
                     if (does_vary .and. r%kind == request_link) exit
                     call make_chart(s, own, found(i), r, column, d%drive, one, does_vary)
                     if (column == 3 .and. r%kind == request_link .and. drive%kind == drive_angle &
                        .and. drive%subject == r%subject) cycle
                     if (does_vary) d%charts = [d%charts, one]
                  end do
               end associate
            end do
         end associate
         page = [page, d]
      end do
   end subroutine add_to_page

   !> Makes the chart `c` of `column` of the row of `request` along the circuits `found` of `m`, over the drive with the
   !> name `drive`; `does_vary`: it is not constant.
   subroutine make_chart(s, m, found, request, column, drive, c, does_vary)
      type(set_analysis_t), intent(in) :: s
      type(mechanism_t), intent(in) :: m
      type(circuits_t), intent(in) :: found
      type(request_t), intent(in) :: request
      integer, intent(in) :: column
      character(*), intent(in) :: drive
      type(chart_t), intent(out) :: c
      logical, intent(out) :: does_vary
      character(3), parameter :: columns(3) = ['X  ', 'Y  ', 'PHI']
      character(:), allocatable :: name
      character(label_length) :: units(2)
      logical :: angular(2)
      real(wp) :: low(2), high(2), unit(2), turn(2)
      type(motion_t) :: q
      integer :: i

      q = new_motion(size(m%links))
      q%known = 0
      q%origin = s%now%motions(found%part)%origin
      angular = [found%curve%is_angle, is_angle(m, request, column)]
      unit = merge(degree, 1.0_wp, angular .and. m%degrees)
      turn = merge(2.0_wp*pi/unit, 0.0_wp, angular)
      allocate (c%curves(size(found%list)))
      low = huge(low)
      high = -huge(high)
      do i = 1, size(found%list)
         call take_circuit(c%curves(i))
         low = min(low, minval(c%curves(i)%p, dim=2))
         high = max(high, maxval(c%curves(i)%p, dim=2))
      end do
      does_vary = unit(2)*(high(2) - low(2)) > varies*merge(1.0_wp, found%curve%closure%length, angular(2))
      units = merge(angle_unit(m), m%length_unit, angular)
      name = trim(subject_name(m, request%kind, request%subject))//', '//trim(units(2))
      if (request%kind /= request_pair) &
         name = trim(merge('FI ', columns(column), column == 3 .and. m%polish))//' '//name
      c%axes(1) = new_axis(drive//', '//trim(units(1)), low(1), high(1), &
         drive_value(found%curve, found%curve%first)/unit(1) - 0.5_wp*turn(1), turn(1))
      c%axes(2) = new_axis(name, low(2), high(2), -0.5_wp*turn(2), turn(2))

   contains

      !> Takes the circuit at hand, number `i`: its points, dead points, change points and assemblies. An angle begins
      !> within half a turn of 0.
      subroutine take_circuit(curve)
         type(graph_t), intent(inout) :: curve
         real(wp) :: first(2)
         integer, allocatable :: dead(:), own(:)
         integer :: k, n

         associate (circuit => found%list(i), assemblies => found%assemblies)
            n = size(circuit%points)
            allocate (curve%p(2, n))
            do k = 1, n
               curve%p(:, k) = place(circuit%points(k)%value(0), circuit%points(k)%q)
            end do
            first = 0.0_wp
            if (angular(2)) first(2) = curve%p(2, 1) - without_turns(curve%p(2, 1)*unit(2))/unit(2)
            curve%p = curve%p - spread(first, 2, n)

            ! The last point of a closed circuit is the first.
            if (circuit%ends(1) == end_closed) n = n - 1
            dead = pack([(k, k=1, n)], circuit%points(:n)%is_dead)
            own = pack([(k, k=1, size(assemblies))], found%branches(assemblies%branch)%circuit == i)
            curve%kind = [spread(mark_dot, 1, size(dead)), spread(mark_ring, 1, size(circuit%changes)), &
               assemblies(own)%number]
            allocate (curve%mark(2, size(curve%kind)))
            n = size(dead)
            curve%mark(:, :n) = curve%p(:, dead)
            do k = 1, size(circuit%changes)
               curve%mark(:, n + k) = place(circuit%changes(k)%value, circuit%changes(k)%q) - first
            end do
            n = n + size(circuit%changes)
            do k = 1, size(own)
               curve%mark(:, n + k) = place(0.0_wp, assemblies(own(k))%q) - first
               curve%mark(1, n + k) = assemblies(own(k))%value/unit(1)
            end do
         end associate
      end subroutine take_circuit

      !> The drive's value and the number at `value` and `position` on the circuit at hand, in their units.
      function place(value, position) result(p)
         real(wp), intent(in) :: value, position(:, :)
         real(wp) :: p(2)
         type(row_t) :: row

         q%position = deck_position(found%curve, position)
         row = row_of(m, q, request)
         p = [drive_value(found%curve, value + found%list(i)%shift), row%value(column, 0)]/unit
      end function place
   end subroutine make_chart

   !> Returns the axis `name` from `low` to `high`, or of an angle that goes on for more than a `turn`, for a turn from
   !> `start` on. `turn`: 0 if it is no angle.
   pure function new_axis(name, low, high, start, turn) result(axis)
      character(*), intent(in) :: name
      real(wp), intent(in) :: low, high, start, turn
      type(axis_t) :: axis
      real(wp) :: beyond

      beyond = max(margin*(high - low), least_margin*max(abs(low), abs(high), 1.0_wp))
      axis%name = name
      axis%is_angle = turn > 0.0_wp
      axis%low = low - beyond
      axis%high = high + beyond
      if (.not. axis%is_angle .or. high - low < turn*(1.0_wp - 1.0e-6_wp)) return
      axis%turn = turn
      axis%low = start
      axis%high = start + turn
   end function new_axis

   !> Writes the page: of each drive its title, the names of the circuits in their colours as far as there is room, and
   !> the diagrams.
   subroutine put_circuit_page(o, page)
      type(output_t), intent(inout) :: o
      type(diagrams_t), allocatable, intent(inout) :: page(:)
      real(wp) :: top
      integer :: i, k

      if (.not. allocated(page)) allocate (page(0))
      top = 0.0_wp
      do i = 1, size(page)
         top = top + head + size(page(i)%charts)*chart_height
      end do
      call svg_head(o, width, max(1, nint(top)))
      top = 0.0_wp
      do i = 1, size(page)
         associate (d => page(i))
            call put_words(o, [14.0_wp, top + 24.0_wp], 'start', 'class="title"', d%title)
            if (size(d%charts) > 0) then
               do k = 1, min(size(d%charts(1)%curves), int((real(width, wp) - 20.0_wp)/room))
                  call put_words(o, [14.0_wp + room*real(k - 1, wp), top + 44.0_wp], 'start', &
                     'style="fill:'//color_of(k)//'"', d%circuit//' '//whole(k))
               end do
            end if
            top = top + head
            do k = 1, size(d%charts)
               call put_chart(o, d%charts(k), top, 'class="circuits" '//attribute('data-drive', d%drive), d%circuit)
               top = top + chart_height
            end do
         end associate
      end do
      call put_end(o, 'svg')
   end subroutine put_circuit_page
   !> Writes the chart `c` from the pixel `top` on. Its group has the `attributes`; `word`: what each curve shows,
   !> before its number.
   subroutine put_chart(o, c, top, attributes, word)
      type(output_t), intent(inout) :: o
      type(chart_t), intent(in) :: c
      real(wp), intent(in) :: top
      character(*), intent(in) :: attributes, word
      ! From a side to the end of a tick, and to its number.
      real(wp), parameter :: to_end(2, 2) = reshape([0.0_wp, tick, -tick, 0.0_wp], [2, 2])
      real(wp), parameter :: to_number(2, 2) = reshape([0.0_wp, tick + 13.0_wp, -tick - 4.0_wp, 4.0_wp], [2, 2])
      character(6), parameter :: anchors(2) = ['middle', 'end   ']
      real(wp) :: corner(2), extent(2), range, power, step, x, p(2)
      integer(int64) :: at
      integer :: i, k

      corner = [left, top + above]
      extent = [real(width, wp) - left - right, height]
      call put_group(o, attributes, c%axes(2)%name)
      ! Ticks and numbers, below and on the left.
      do k = 1, 2
         associate (axis => c%axes(k))
            range = axis%high - axis%low
            power = 10.0_wp**floor(log10(max(range, sqrt(tiny(range)))/most_ticks))
            i = findloc(range <= steps*power*most_ticks, .true., dim=1)
            step = steps(merge(i, size(steps), i > 0))*power
            if (axis%is_angle .and. range > 8.0_wp) then
               i = findloc(range <= degree_steps*most_ticks, .true., dim=1)
               if (i > 0) step = degree_steps(i)
            end if
            do at = ceiling(axis%low/step - 1.0e-6_wp, int64), floor(axis%high/step + 1.0e-6_wp, int64)
               x = (real(at, wp)*step - axis%low)/(axis%high - axis%low)
               p = corner + extent*merge([x, 1.0_wp], [0.0_wp, 1.0_wp - x], k == 1)
               call put_line(o, 'polyline', reshape([p, p + to_end(:, k)], [2, 2]), &
                  'style="stroke:#222;stroke-width:1"')
               call put_words(o, p + to_number(:, k), trim(anchors(k)), 'class="between"', fitted(real(at, wp)*step))
            end do
         end associate
      end do
      call put_words(o, corner + [0.0_wp, -8.0_wp], 'start', 'class="time"', c%axes(2)%name)
      call put_words(o, corner + extent + [0.0_wp, 34.0_wp], 'end', 'class="time"', c%axes(1)%name)
      call put_window(o, corner, extent)
      do i = 1, size(c%curves)
         call put_group(o, 'class="circuit" data-circuit="'//whole(i)//'" style="stroke:'//color_of(i)//'"', &
            word//' '//whole(i))
         call put_curve(c%curves(i), color_of(i))
         call put_end(o, 'g')
      end do
      call put_end(o, 'svg')
      call put_line(o, 'polygon', reshape([corner, corner(1) + extent(1), corner(2), corner + extent, corner(1), &
         corner(2) + extent(2)], [2, 4]), 'style="stroke:#222;stroke-width:1"')
      call put_end(o, 'g')

   contains

      !> Writes `curve` in the window: as many times, whole turns apart, as it enters the window.
      subroutine put_curve(curve, color)
         type(graph_t), intent(in) :: curve
         character(*), intent(in) :: color
         real(wp) :: q(2)
         integer :: low(2), high(2), x, y, k

         low = turns_of(minval(curve%p, dim=2))
         high = turns_of(maxval(curve%p, dim=2))
         do x = low(1), high(1)
            do y = low(2), high(2)
               call put_line(o, 'polyline', reshape([(pixel(curve%p(:, k), [x, y]), k=1, size(curve%p, 2))], &
                  shape(curve%p)), 'class="curve" style="stroke:'//color//'"')
            end do
         end do
         do k = 1, size(curve%kind)
            q = pixel(curve%mark(:, k), turns_of(curve%mark(:, k)))
            select case (curve%kind(k))
            case (mark_dot)
               call put_circle(o, q, dot, 'class="dead" style="stroke:none;fill:'//color//'"')
            case (mark_ring)
               call put_circle(o, q, ring, 'class="change" style="fill:none;stroke:'//color//'"')
            case default
               call put_words(o, q + [0.0_wp, 4.0_wp], 'middle', 'class="assembly" style="fill:'//color//'"', &
                  whole(curve%kind(k)))
            end select
         end do
      end subroutine put_curve

      !> By how many turns the place `p` (2) is off the window.
      pure function turns_of(p) result(turns)
         real(wp), intent(in) :: p(2)
         integer :: turns(2)

         turns = 0
         where (c%axes%turn > 0.0_wp) turns = floor((p - c%axes%low)/c%axes%turn)
      end function turns_of

      !> The pixel (2) of the place `p` (2), less so many `turns`.
      pure function pixel(p, turns) result(q)
         real(wp), intent(in) :: p(2)
         integer, intent(in) :: turns(2)
         real(wp) :: q(2)

         q = (p - turns*c%axes%turn - c%axes%low)/(c%axes%high - c%axes%low)
         q = [q(1), 1.0_wp - q(2)]*extent
      end function pixel
   end subroutine put_chart
end module circuits_picture
