!> A diagram as SVG: curves with marks over two axes with ticks. An angle that goes on for more than a turn is drawn
!> without whole turns.
module chart
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use numerals, only: whole
   use shapes, only: color_of
   use picture_page, only: width, fitted
   use svg, only: put_end, put_group, put_line, put_circle, put_words, put_window
   use text_output, only: output_t
   implicit none
   private
   public :: chart_t, graph_t, axis_t, new_axis, put_chart, chart_height

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

   !> Writes the chart `c` from the pixel `top` on. Its group has the `attributes`; `word`: what each curve shows,
   !> before its number.
   subroutine put_chart(o, c, top, attributes, word)
      type(output_t), intent(inout) :: o
      type(chart_t), intent(in) :: c
      real(wp), intent(in) :: top
      character(*), intent(in) :: attributes, word
      real(wp) :: corner(2), extent(2)
      integer :: i

      corner = [left, top + above]
      extent = [real(width, wp) - left - right, height]
      call put_group(o, attributes, c%axes(2)%name)
      call put_ticks(c%axes(1), 1)
      call put_ticks(c%axes(2), 2)
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

      !> Writes ticks and numbers of `axis` on side `k`, 1 below, 2 on the left,.
      subroutine put_ticks(axis, k)
         type(axis_t), intent(in) :: axis
         integer, intent(in) :: k
         ! From the side to the end of a tick, and to its number.
         real(wp), parameter :: to_end(2, 2) = reshape([0.0_wp, tick, -tick, 0.0_wp], [2, 2])
         real(wp), parameter :: to_number(2, 2) = reshape([0.0_wp, tick + 13.0_wp, -tick - 4.0_wp, 4.0_wp], [2, 2])
         character(6), parameter :: anchors(2) = ['middle', 'end   ']
         real(wp) :: range, power, step, x, p(2)
         integer(int64) :: i

         range = axis%high - axis%low
         power = 10.0_wp**floor(log10(max(range, sqrt(tiny(range)))/most_ticks))
         i = findloc(range <= steps*power*most_ticks, .true., dim=1)
         step = steps(merge(i, size(steps, kind=int64), i > 0))*power
         if (axis%is_angle .and. range > 8.0_wp) then
            i = findloc(range <= degree_steps*most_ticks, .true., dim=1)
            if (i > 0) step = degree_steps(i)
         end if
         do i = ceiling(axis%low/step - 1.0e-6_wp, int64), floor(axis%high/step + 1.0e-6_wp, int64)
            x = (real(i, wp)*step - axis%low)/(axis%high - axis%low)
            p = corner + extent*merge([x, 1.0_wp], [0.0_wp, 1.0_wp - x], k == 1)
            call put_line(o, 'polyline', reshape([p, p + to_end(:, k)], [2, 2]), 'style="stroke:#222;stroke-width:1"')
            call put_words(o, p + to_number(:, k), trim(anchors(k)), 'class="between"', fitted(real(i, wp)*step))
         end do
      end subroutine put_ticks
   end subroutine put_chart
end module chart
