!> The picture of circuits as SVG. Each set and drive has a diagram of each number that PRINT asks for and that varies,
!> over the drive. Each circuit has its own colour; dots are dead points, rings change points. An angle that goes on
!> for more than a turn is drawn without whole turns.
module circuits_picture
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp, label_length
   use plane_vectors, only: pi, degree, wrap_angle
   use mechanism, only: mechanism_t, request_t, drive_t, drive_angle
   use number_format, only: whole
   use points, only: row_t
   use columns, only: columns_of_rows, column_at, forms, of_angle
   use instant_centres, only: points_coincide
   use independent, only: request_of
   use set_members, only: requests_of, row_form, row_subject, drive_of, drive_number, name_of_drive
   use set_motion, only: set_motion_t, find_row_of_position
   use listing_layout, only: angle_unit, column_word
   use circuit_curve, only: deck_position, drive_value
   use circuit_trace, only: end_closed
   use circuits, only: circuits_t
   use shapes, only: color_of
   use svg, only: page_t, page_width, attribute, close_group, open_group, draw_line, draw_circle, draw_words, &
      draw_window, fitted
   use phrases
   implicit none
   private
   public :: draw_circuits

   !> A circuit in a chart.
   type :: chart_curve_t
      real(wp), allocatable :: places(:, :)     !< (2, points) in the units in which numbers are printed
   end type chart_curve_t

   !> A chart of a number over a drive, in pixels and in the units of its axes.
   type :: circuit_plot_t
      type(chart_curve_t), allocatable :: curves(:)   !< (circuits)
      real(wp) :: low(2) = huge(1.0_wp), high(2) = -huge(1.0_wp)   !< the ends of the axes, in their units
      real(wp) :: turn(2) = 0.0_wp              !< a whole turn, after which an axis ends, in its unit; 0: no end
      real(wp) :: corner(2) = 0.0_wp, extent(2) = 0.0_wp   !< pixels of the window: its corner above, and its size
   end type circuit_plot_t

   !> A number varies if its values differ by more than this, in rad or in lengths of the curve.
   real(wp), parameter :: least_variation = 1.0e-6_wp
   !> Height of the title of a drive with its legend, and width of a name in the legend, in pixels.
   integer, parameter :: legend_height = 56
   real(wp), parameter :: legend_width = 70.0_wp
   !> Pixels on the left of a diagram, on its right, above it and below it.
   real(wp), parameter :: left_room = 84.0_wp, right_room = 24.0_wp, top_room = 26.0_wp, bottom_room = 42.0_wp
   !> Pixels of the height of a diagram.
   real(wp), parameter :: diagram_height = 300.0_wp
   integer, parameter :: chart_height = nint(top_room + diagram_height + bottom_room)
   !> Pixels of dead points, change points and ticks.
   real(wp), parameter :: dot_radius = 3.5_wp, ring_radius = 6.0_wp, tick_length = 5.0_wp
   !> An axis goes on by this part of the range of its values, and at least by this part of the largest value.
   real(wp), parameter :: axis_margin = 0.04_wp, least_axis_margin = 4096.0_wp*epsilon(1.0_wp)
   !> Steps between ticks, in any power of ten; on an axis of a turn in degrees the step is the second.
   real(wp), parameter :: tick_steps(*) = [1.0_wp, 2.0_wp, 5.0_wp, 10.0_wp], turn_step = 45.0_wp
   !> An axis has about so many ticks at most.
   integer, parameter :: most_ticks = 9
   !> The column of the angle of a link.
   integer, parameter :: angle_column = 3
   !> The middle of the angles of a curve lies within half a turn of this (rad): a whole turn goes from 0 up.
   real(wp), parameter :: middle_angle = 10.0_wp*degree
   !> Two curves are equal if they are nowhere farther apart than this (pixels), at about so many points.
   real(wp), parameter :: same_line_distance = 1.0_wp
   integer, parameter :: seen_points = 60
   !> Equal curves are drawn in dashes of this length (pixels), in turn.
   real(wp), parameter :: dash_length = 9.0_wp
   character(*), parameter :: thin = 'style="stroke:#222;stroke-width:1"'

contains

   !> Draws the diagrams of the circuits of a set at the end of a page: a chart for each number that PRINT asks for and
   !> that varies, unless it is driven. Above them are the names of the circuits in their colours, as far as there is
   !> room. Measures and ratios have no charts.
   subroutine draw_circuits(page, m, set, found)
      type(page_t), intent(inout) :: page    !< gets the diagrams
      type(mechanism_t), intent(in) :: m     !< the set
      type(set_motion_t), intent(in) :: set   !< at its first instant
      type(circuits_t), intent(in) :: found(:)   !< (drives)
      type(request_t), allocatable :: requests(:)
      logical :: does_vary
      integer :: i, k, column

      requests = requests_of(set)
      do i = 1, size(found)
         associate (top => real(page%height, wp))
            call draw_words(page%body, [14.0_wp, top + 24.0_wp], 'start', 'class="title"', &
               trim(whole(m%set_number)//'.  '//m%title))
            do k = 1, min(size(found(i)%list), int((real(page_width, wp) - 20.0_wp)/legend_width))
               call draw_words(page%body, [14.0_wp + legend_width*real(k - 1, wp), top + 44.0_wp], 'start', &
                  'style="fill:'//color_of(k)//'"', phrase(text_circuit, m%polish)//' '//whole(k))
            end do
         end associate
         page%height = page%height + legend_height

         do k = 1, merge(size(requests), 0, size(found(i)%list) > 0)
            if (set%rows(k)%part /= found(i)%part .or. requests(k)%every == 0) cycle
            associate (form => forms(row_form(set, k)))
               if (.not. all(columns_of_rows(form%first:form%last)%there(points_coincide))) cycle
               ! A link that turns has a chart of its angle only.
               does_vary = .false.
               if (form%coordinates == angle_column) call draw_chart(page, set, k, angle_column, found(i), does_vary)
               if (does_vary) cycle
               do column = 1, min(form%coordinates, angle_column - 1)
                  call draw_chart(page, set, k, column, found(i), does_vary)
               end do
            end associate
         end do
      end do
   end subroutine draw_circuits

   !> Draws the chart of a number along the circuits of a drive, unless it does not vary or is the drive itself.
   subroutine draw_chart(page, set, i, column, found, does_vary)
      type(page_t), intent(inout) :: page    !< gets the chart
      type(set_motion_t), intent(in) :: set   !< at its first instant
      integer, intent(in) :: i               !< number of the row in the set
      integer, intent(in) :: column          !< of the row, 1 to 3
      type(circuits_t), intent(in) :: found   !< of the drive
      logical, intent(out) :: does_vary      !< the number varies
      character(:), allocatable :: name, drive_words
      character(label_length) :: units(2)
      logical :: angular(2)
      real(wp), dimension(2) :: unit, start
      real(wp) :: beyond
      type(circuit_plot_t) :: chart
      type(request_t) :: request
      type(drive_t) :: drive
      integer :: k, n

      n = column_at(row_form(set, i), column, 0)
      angular = [found%curve%is_angle, columns_of_rows(n)%dimension == of_angle]
      unit = merge(degree, 1.0_wp, angular .and. set%degrees)
      call find_curves(set, i, column, found, unit, angular(2), chart)
      does_vary = unit(2)*(chart%high(2) - chart%low(2)) > &
         least_variation*merge(1.0_wp, found%curve%closure%length, angular(2))
      drive = drive_of(set, drive_number(set, found%part, found%drive))
      request = request_of(set, i)
      if (.not. does_vary .or. (column == angle_column .and. drive%kind == drive_angle .and. &
         drive%subject == request%subject)) return

      ! The axes: names, and values from `low` to `high`. An angle that goes on for more than a turn is drawn for one.
      drive_words = name_of_drive(set, found%part, found%drive)
      units = merge(angle_unit(set), set%length_unit, angular)
      name = trim(row_subject(set, i))//', '//trim(units(2))
      if (forms(row_form(set, i))%coordinates > 1) &
         name = column_word(columns_of_rows(n)%english, columns_of_rows(n)%polish, set%polish)//' '//name
      chart%turn = merge(2.0_wp*pi/unit, 0.0_wp, angular)
      start = [drive_value(found%curve, found%curve%first)/unit(1), 0.0_wp] - 0.5_wp*chart%turn
      do k = 1, 2
         associate (low => chart%low(k), high => chart%high(k), turn => chart%turn(k))
            beyond = max(axis_margin*(high - low), least_axis_margin*max(abs(low), abs(high), 1.0_wp))
            if (high - low < turn*(1.0_wp - 1.0e-6_wp)) turn = 0.0_wp
            low = merge(start(k), low - beyond, turn > 0.0_wp)
            high = merge(start(k) + turn, high + beyond, turn > 0.0_wp)
         end associate
      end do

      chart%corner = [left_room, real(page%height, wp) + top_room]
      chart%extent = [real(page_width, wp) - left_room - right_room, diagram_height]
      page%height = page%height + chart_height
      call open_group(page%body, 'class="circuits" '//attribute('data-drive', drive_words), name)
      call draw_ticks(page, chart)
      call draw_words(page%body, chart%corner + [0.0_wp, -8.0_wp], 'start', 'class="time"', name)
      call draw_words(page%body, chart%corner + chart%extent + [0.0_wp, 34.0_wp], 'end', 'class="time"', &
         drive_words//', '//trim(units(1)))
      call draw_window(page%body, chart%corner, chart%corner + chart%extent)
      call draw_curves(page, chart, found, set%polish)
      call close_group(page%body, 'svg')
      associate (corner => chart%corner, extent => chart%extent)
         call draw_line(page%body, 'polygon', reshape([corner, corner(1) + extent(1), corner(2), corner + extent, &
            corner(1), corner(2) + extent(2)], [2, 4]), thin)
      end associate
      call close_group(page%body, 'g')
   end subroutine draw_chart

   !> Finds the curves of a number over the drive, one for each circuit, and the ranges of their values.
   subroutine find_curves(set, i, column, found, unit, is_angle, chart)
      type(set_motion_t), intent(in) :: set   !< at its first instant
      integer, intent(in) :: i               !< number of the row in the set
      integer, intent(in) :: column          !< of the row, 1 to 3
      type(circuits_t), intent(in) :: found   !< of the drive
      real(wp), intent(in) :: unit(2)        !< units of both axes, drive and number, in the deck's units and rad
      logical, intent(in) :: is_angle        !< the number is an angle
      type(circuit_plot_t), intent(inout) :: chart   !< gets its curves, and their ranges for its axes
      type(row_t) :: row
      integer :: c, k

      allocate (chart%curves(size(found%list)))
      do c = 1, size(chart%curves)
         associate (points => found%list(c)%points, curve => chart%curves(c))
            allocate (curve%places(2, size(points)))
            do k = 1, size(points)
               call find_row_of_position(set, i, deck_position(found%curve, points(k)%q), row)
               curve%places(:, k) = [drive_value(found%curve, points(k)%value(0) + found%list(c)%shift), &
                  row%value(column, 0)]/unit
            end do

            if (is_angle) then
               associate (middle => 0.5_wp*(minval(curve%places(2, :)) + maxval(curve%places(2, :)))*unit(2))
                  curve%places(2, :) = curve%places(2, :) &
                     + (wrap_angle(middle - middle_angle) - (middle - middle_angle))/unit(2)
               end associate
            end if
            chart%low = min(chart%low, minval(curve%places, dim=2))
            chart%high = max(chart%high, maxval(curve%places, dim=2))
         end associate
      end do
   end subroutine find_curves

   !> Draws the ticks and numbers of both axes, below and on the left.
   subroutine draw_ticks(page, chart)
      type(page_t), intent(inout) :: page    !< gets the ticks
      type(circuit_plot_t), intent(in) :: chart   !< with its axes
      ! From a side to the end of a tick, and to its number.
      real(wp), parameter :: to_tick_end(2, 2) = reshape([0.0_wp, tick_length, -tick_length, 0.0_wp], [2, 2])
      real(wp), parameter :: to_number(2, 2) = reshape([0.0_wp, tick_length + 13.0_wp, &
         -tick_length - 4.0_wp, 4.0_wp], [2, 2])
      character(6), parameter :: anchors(2) = ['middle', 'end   ']
      real(wp) :: range, power, step, x, at(2)
      integer(int64) :: number
      integer :: k

      do k = 1, 2
         range = chart%high(k) - chart%low(k)
         power = 10.0_wp**floor(log10(max(range, sqrt(tiny(range)))/most_ticks))
         step = power*minval(tick_steps, mask=range <= tick_steps*power*most_ticks .or. tick_steps >= 10.0_wp)
         if (chart%turn(k) > turn_step) step = turn_step
         do number = ceiling(chart%low(k)/step - 1.0e-6_wp, int64), floor(chart%high(k)/step + 1.0e-6_wp, int64)
            x = (real(number, wp)*step - chart%low(k))/range
            at = chart%corner + chart%extent*merge([x, 1.0_wp], [0.0_wp, 1.0_wp - x], k == 1)
            call draw_line(page%body, 'polyline', reshape([at, at + to_tick_end(:, k)], [2, 2]), thin)
            call draw_words(page%body, at + to_number(:, k), trim(anchors(k)), 'class="between"', &
               fitted(real(number, wp)*step))
         end do
      end do
   end subroutine draw_ticks

   !> Draws each curve as many times, whole turns apart, as it enters the window; then its dead points and change
   !> points. Equal curves are drawn in dashes of several colours. The last point of a closed circuit is the first.
   subroutine draw_curves(page, chart, found, polish)
      type(page_t), intent(inout) :: page    !< gets the curves
      type(circuit_plot_t), intent(in) :: chart   !< with its axes and curves
      type(circuits_t), intent(in) :: found   !< of the drive
      logical, intent(in) :: polish          !< in Polish
      character(:), allocatable :: style
      character(7) :: color
      integer :: from(2), to(2), first(size(chart%curves)), equal, i, j, k, n

      first = [(first_equal(i), i=1, size(chart%curves))]
      do i = 1, size(chart%curves)
         color = color_of(i)
         style = 'class="curve" style="stroke:'//color//'"'
         equal = count(first == first(i))
         if (equal > 1) style = style//' stroke-dasharray="' &
            //fitted(dash_length)//' '//fitted(dash_length*(equal - 1)) &
            //'" stroke-dashoffset="'//fitted(-dash_length*count(first(:i - 1) == first(i)))//'"'

         associate (circuit => found%list(i), p => chart%curves(i)%places)
            call open_group(page%body, 'class="circuit" data-circuit="'//whole(i)//'" style="stroke:'//color//'"', &
               phrase(text_circuit, polish)//' '//whole(i))
            from = turns_off(minval(p, dim=2))
            to = turns_off(maxval(p, dim=2))
            n = size(p, 2)
            do k = from(1), to(1)
               do j = from(2), to(2)
                  call draw_line(page%body, 'polyline', pixels_of(p - spread([k, j]*chart%turn, 2, n)), style)
               end do
            end do

            if (circuit%ends(1) == end_closed) n = n - 1
            do k = 1, n
               if (circuit%points(k)%is_dead) call draw_circle(page%body, in_window(p(:, k)), dot_radius, &
                  'class="dead" style="stroke:none;fill:'//color//'"')
               if (circuit%points(k)%is_change) call draw_circle(page%body, in_window(p(:, k)), ring_radius, &
                  'class="change" style="fill:none;stroke:'//color//'"')
            end do
         end associate
         call close_group(page%body, 'g')
      end do

   contains

      !> Finds the number of the first curve to which a curve is equal in the window, but for whole turns: the curve
      !> itself if there is no other.
      pure integer function first_equal(i)
         integer, intent(in) :: i               !< number of the curve

         do first_equal = 1, i - 1
            associate (p => pixels_of(chart%curves(i)%places), &
                       line => pixels_of(chart%curves(first_equal)%places))
               if (lies_on(p, line) .and. lies_on(line, p)) exit
            end associate
         end do
      end function first_equal

      !> Tells whether points of one line are on another line, but for whole turns and `same_line_distance`.
      pure logical function lies_on(p, line)
         real(wp), intent(in) :: p(:, :)        !< (2, points) pixels of the first line
         real(wp), intent(in) :: line(:, :)     !< (2, points) pixels of the second line
         real(wp) :: a(2), u(2), v(2), least
         integer :: point, side, k, j

         lies_on = .false.

         associate (period => chart%extent/(chart%high - chart%low)*chart%turn, &
                    turns => merge(1, 0, chart%turn > 0.0_wp))
            do point = 1, size(p, 2), 1 + size(p, 2)/seen_points
               least = huge(least)
               do k = -turns(1), turns(1)
                  do j = -turns(2), turns(2)
                     a = p(:, point) + [k, j]*period
                     do side = 1, size(line, 2) - 1
                        u = a - line(:, side)
                        v = line(:, side + 1) - line(:, side)
                        least = min(least, norm2(u - v*min(max(dot_product(u, v) &
                           /max(dot_product(v, v), tiny(1.0_wp)), 0.0_wp), 1.0_wp)))
                     end do
                  end do
               end do
               if (least > same_line_distance) return
            end do
         end associate
         lies_on = .true.
      end function lies_on

      !> Finds by how many turns (2) a place is off the window.
      pure function turns_off(p) result(turns)
         real(wp), intent(in) :: p(2)           !< in the units of the axes
         integer :: turns(2)

         turns = 0
         where (chart%turn > 0.0_wp) turns = floor((p - chart%low)/chart%turn)
      end function turns_off

      !> Gives the pixels (2, places) of places.
      pure function pixels_of(p) result(pixels)
         real(wp), intent(in) :: p(:, :)        !< (2, places) in the units of the axes
         real(wp) :: pixels(2, size(p, 2))

         associate (corner => chart%corner, extent => chart%extent, low => chart%low, high => chart%high)
            pixels(1, :) = corner(1) + extent(1)*(p(1, :) - low(1))/(high(1) - low(1))
            pixels(2, :) = corner(2) + extent(2)*(high(2) - p(2, :))/(high(2) - low(2))
         end associate
      end function pixels_of

      !> Gives the pixel (2) of a place, less the turns by which it is off the window.
      pure function in_window(p) result(pixel)
         real(wp), intent(in) :: p(2)           !< in the units of the axes
         real(wp) :: pixel(2)

         pixel = reshape(pixels_of(reshape(p - turns_off(p)*chart%turn, [2, 1])), [2])
      end function in_window
   end subroutine draw_curves
end module circuits_picture
