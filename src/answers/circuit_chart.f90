!> What the picture of circuits shows: for each number that PRINT asks for and that varies, its values along all
!> circuits, over the drive.
module circuit_chart
   use kinds, only: wp
   use planar, only: pi, degree, without_turns
   use mechanism, only: mechanism_t, request_t, request_link, request_point, request_pair, drive_angle
   use motion, only: motion_t, new_motion
   use points, only: row_t, row_of, coordinates_of
   use set_analysis, only: set_analysis_t
   use extremes, only: is_angle
   use curve_equations, only: deck_position, drive_value
   use circuit_trace, only: end_closed
   use circuit_branches, only: circuits_t
   implicit none
   private
   public :: chart_t, trace_t, axis_t, make_charts

   !> A number varies if it does so by more than this, in rad or in lengths of the curve.
   real(wp), parameter :: varies = 1.0e-6_wp
   real(wp), parameter :: turn = 2.0_wp*pi
   !> An axis goes on by this part of its values, or of the largest of them where all are the same.
   real(wp), parameter :: margin = 0.04_wp, least_margin = 4096.0_wp*epsilon(1.0_wp)

   !> An axis, in the unit in which numbers are printed.
   type :: axis_t
      real(wp) :: low = 0.0_wp, high = 1.0_wp
      real(wp) :: turn = 0.0_wp                 !< of an angle that is drawn without whole turns: a turn; otherwise 0
      logical :: is_angle = .false.
   end type axis_t

   !> One circuit.
   type :: trace_t
      real(wp), allocatable :: p(:, :)          !< (2, points) the drive's value and the number
      real(wp), allocatable :: dead(:, :)       !< (2, dead points) the same
      real(wp), allocatable :: changes(:, :)    !< (2, change points)
      real(wp), allocatable :: assemblies(:, :) !< (2, assemblies)
      integer, allocatable :: numbers(:)        !< (assemblies) their numbers
   end type trace_t

   type :: chart_t
      type(request_t) :: request                !< the number: of which row of the mechanism,
      integer :: column = 0                     !< and its place in it
      type(axis_t) :: axes(2)                   !< of the drive and of the number
      type(trace_t), allocatable :: traces(:)   !< (circuits)
   end type chart_t

contains

   !> The `charts` of the circuits `found` of independent mechanism number `c` of the set that `s` analyses.
   subroutine make_charts(s, c, found, charts)
      type(set_analysis_t), intent(in) :: s
      integer, intent(in) :: c
      type(circuits_t), intent(in) :: found
      type(chart_t), allocatable, intent(out) :: charts(:)
      type(chart_t) :: one
      integer :: i, column, drive
      logical :: done

      allocate (charts(0))
      drive = findloc(s%now%parts%list(c)%drives, found%drive, dim=1)
      associate (m => s%now%own(c))
         do i = 1, size(m%requests)
            if (m%requests(i)%every == 0) cycle
            if (all(m%requests(i)%kind /= [request_link, request_point, request_pair])) cycle
            done = .false.
            do column = coordinates_of(m%requests(i)%kind), 1, -1
               ! Of a link that turns its angle alone.
               if (done .and. m%requests(i)%kind == request_link) exit
               call make_chart(s, c, found, m%requests(i), column, one, done)
               if (done .and. .not. is_drive(m, drive, m%requests(i), column)) charts = [charts, one]
            end do
         end do
      end associate
   end subroutine make_charts

   !> Whether `column` of the row of `request` is what drive number `drive` drives.
   pure logical function is_drive(m, drive, request, column)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: drive, column
      type(request_t), intent(in) :: request

      is_drive = m%drives(drive)%kind == drive_angle .and. request%kind == request_link .and. column == 3
      if (is_drive) is_drive = m%drives(drive)%subject == request%subject
   end function is_drive

   !> The `chart` of `column` of the row of `request`; `done`: it varies.
   subroutine make_chart(s, c, found, request, column, chart, done)
      type(set_analysis_t), intent(in) :: s
      integer, intent(in) :: c, column
      type(circuits_t), intent(in) :: found
      type(request_t), intent(in) :: request
      type(chart_t), intent(out) :: chart
      logical, intent(out) :: done
      type(motion_t) :: q
      real(wp) :: low(2), high(2), unit(2)
      integer :: i

      q = new_motion(size(s%now%own(c)%links))
      q%known = 0
      q%origin = s%now%motions(c)%origin
      chart%request = request
      chart%column = column
      chart%axes%is_angle = [found%curve%is_angle, is_angle(s%now%own(c), request, column)]
      allocate (chart%traces(size(found%list)))
      low = huge(low)
      high = -huge(high)
      do i = 1, size(found%list)
         call take_circuit(i, chart%traces(i))
         low = min(low, minval(chart%traces(i)%p, dim=2))
         high = max(high, maxval(chart%traces(i)%p, dim=2))
      end do
      done = high(2) - low(2) > varies*merge(1.0_wp, found%curve%closure%length, chart%axes(2)%is_angle)
      unit = merge(degree, 1.0_wp, chart%axes%is_angle .and. s%now%own(c)%degrees)
      call set_axis(chart%axes(1), low(1), high(1), drive_value(found%curve, found%curve%first) - pi, unit(1))
      call set_axis(chart%axes(2), low(2), high(2), -pi, unit(2))
      do i = 1, size(found%list)
         call in_units(chart%traces(i)%p)
         call in_units(chart%traces(i)%dead)
         call in_units(chart%traces(i)%changes)
         call in_units(chart%traces(i)%assemblies)
      end do

   contains

      !> Circuit number `i`, before units; an angle begins within half a turn of 0.
      subroutine take_circuit(i, t)
         integer, intent(in) :: i
         type(trace_t), intent(inout) :: t
         real(wp) :: first
         integer :: k, n

         associate (circuit => found%list(i))
            n = size(circuit%points)
            allocate (t%p(2, n), t%changes(2, size(circuit%changes)))
            do k = 1, n
               t%p(:, k) = place(circuit%points(k)%value(0), circuit%points(k)%q, i)
            end do
            first = 0.0_wp
            if (chart%axes(2)%is_angle) first = t%p(2, 1) - without_turns(t%p(2, 1))
            t%p(2, :) = t%p(2, :) - first
            ! The last point of a closed circuit is the first.
            if (circuit%ends(1) == end_closed) n = n - 1
            t%dead = t%p(:, pack([(k, k=1, n)], circuit%points(:n)%is_dead))
            do k = 1, size(circuit%changes)
               t%changes(:, k) = place(circuit%changes(k)%value, circuit%changes(k)%q, i) - [0.0_wp, first]
            end do
         end associate
         call take_assemblies(i, first, t)
      end subroutine take_circuit

      !> The drive's value and the number at `value` and `position` on circuit number `i`.
      function place(value, position, i) result(p)
         real(wp), intent(in) :: value, position(:, :)
         integer, intent(in) :: i
         real(wp) :: p(2)
         type(row_t) :: row

         q%position = deck_position(found%curve, position)
         row = row_of(s%now%own(c), q, request)
         p = [drive_value(found%curve, value + found%list(i)%shift), row%value(column, 0)]
      end function place

      !> The assemblies of circuit number `i`.
      subroutine take_assemblies(i, first, t)
         integer, intent(in) :: i
         real(wp), intent(in) :: first
         type(trace_t), intent(inout) :: t
         integer, allocatable :: own(:)
         integer :: k

         own = pack([(k, k=1, size(found%assemblies))], found%branches(found%assemblies%branch)%circuit == i)
         t%numbers = found%assemblies(own)%number
         allocate (t%assemblies(2, size(own)))
         do k = 1, size(own)
            t%assemblies(:, k) = place(0.0_wp, found%assemblies(own(k))%q, i) - [0.0_wp, first]
            t%assemblies(1, k) = found%assemblies(own(k))%value
         end do
      end subroutine take_assemblies

      !> Divides both numbers of `p` (2, :) by their units.
      pure subroutine in_units(p)
         real(wp), intent(inout) :: p(:, :)

         p(1, :) = p(1, :)/unit(1)
         p(2, :) = p(2, :)/unit(2)
      end subroutine in_units
   end subroutine make_chart

   !> Lets `axis` go from `low` to `high`; of an angle that goes on for more than a turn, for a turn from `start` on.
   pure subroutine set_axis(axis, low, high, start, unit)
      type(axis_t), intent(inout) :: axis
      real(wp), intent(in) :: low, high, start, unit
      real(wp) :: beyond

      beyond = max(margin*(high - low), least_margin*max(abs(low), abs(high), unit))
      axis%low = (low - beyond)/unit
      axis%high = (high + beyond)/unit
      if (.not. axis%is_angle .or. high - low < turn - varies) return
      axis%turn = turn/unit
      axis%low = start/unit
      axis%high = axis%low + axis%turn
   end subroutine set_axis
end module circuit_chart
