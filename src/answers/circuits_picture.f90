!> The picture of circuits as SVG: for each set and drive a diagram of each number that PRINT asks for and that varies,
!> over the drive, each circuit in its own colour; dots are dead points, rings change points, numbers assemblies of the
!> first instant.
module circuits_picture
   use kinds, only: wp
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
   use chart, only: chart_t, graph_t, new_axis, put_chart, chart_height, mark_dot, mark_ring
   use shapes, only: color_of
   use picture_page, only: width
   use svg, only: attribute, svg_head, put_end, put_words
   use text_output, only: output_t
   use phrases
   implicit none
   private
   public :: diagrams_t, add_to_page, put_circuit_page

   !> The diagrams of one drive, and their words.
   type :: diagrams_t
      character(:), allocatable :: title, drive, circuit
      type(chart_t), allocatable :: charts(:)
   end type diagrams_t

   !> A number varies if it does so by more than this, in rad or in lengths of the curve.
   real(wp), parameter :: varies = 1.0e-6_wp
   !> Height of the title of a drive with its legend, and width of a name in the legend, in pixels.
   real(wp), parameter :: head = 56.0_wp, room = 70.0_wp

contains

   !> Adds the diagrams of the circuits `found` of the set `m`, which `s` analyses, to `page`.
   subroutine add_to_page(page, m, s, found)
      type(diagrams_t), allocatable, intent(inout) :: page(:)
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(circuits_t), intent(in) :: found(:)
      type(diagrams_t), allocatable :: more(:)
      integer :: i, n

      n = 0
      if (allocated(page)) n = size(page)
      allocate (more(n + size(found)))
      if (n > 0) more(:n) = page
      do i = 1, size(found)
         associate (d => more(n + i), own => s%now%parts(found(i)%part))
            d%title = trim(whole(m%set_number)//'.  '//m%title)
            d%circuit = phrase(say_circuit, m%polish)
            d%drive = trim(drive_name(own, own%drives(found(i)%drive)))
            allocate (d%charts(0))
            if (size(found(i)%list) > 0) call add_charts(s, found(i), d)
         end associate
      end do
      call move_alloc(more, page)
   end subroutine add_to_page

   !> Adds a chart to `d` for each number of the circuits `found` that PRINT asks for and that varies, not driven.
   subroutine add_charts(s, found, d)
      type(set_analysis_t), intent(in) :: s
      type(circuits_t), intent(in) :: found
      type(diagrams_t), intent(inout) :: d
      type(chart_t) :: one
      integer :: i, column
      logical :: does_vary

      associate (m => s%now%parts(found%part))
         do i = 1, size(m%requests)
            associate (r => m%requests(i))
               if (r%every == 0 .or. all(r%kind /= [request_link, request_point, request_pair])) cycle
               does_vary = .false.
               do column = coordinates_of(r%kind), 1, -1
                  ! Of a link that turns its angle alone.
                  if (does_vary .and. r%kind == request_link) exit
                  call make_chart(s, m, found, r, column, d%drive, one, does_vary)
                  if (column == 3 .and. r%kind == request_link .and. m%drives(found%drive)%kind == drive_angle &
                     .and. m%drives(found%drive)%subject == r%subject) cycle
                  if (does_vary) d%charts = [d%charts, one]
               end do
            end associate
         end do
      end associate
   end subroutine add_charts

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
      name = trim(subject_name(m, request%kind, request%subject))//', '//unit_of(angular(2))
      if (request%kind /= request_pair) &
         name = trim(merge('FI ', columns(column), column == 3 .and. m%polish))//' '//name
      c%axes(1) = new_axis(drive//', '//unit_of(angular(1)), low(1), high(1), &
         drive_value(found%curve, found%curve%first)/unit(1) - 0.5_wp*turn(1), turn(1))
      c%axes(2) = new_axis(name, low(2), high(2), -0.5_wp*turn(2), turn(2))

   contains

      !> The unit of an angle or a length.
      pure function unit_of(is_angle) result(text)
         logical, intent(in) :: is_angle
         character(:), allocatable :: text

         text = trim(merge(angle_unit(m), m%length_unit, is_angle))
      end function unit_of

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
end module circuits_picture
