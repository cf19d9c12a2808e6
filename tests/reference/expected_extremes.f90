!> Tests. The table of extremes as the listing must print it, from closed forms in real128: each number on a fine grid
!> of times, then by golden section around the grid's largest and least values. Only dead centres use a derivative, the
!> velocity.
module expected_extremes
   use mechanism, only: request_link, request_point, request_ratio
   use quad_jet, only: qp, degree_q, wrap_angle
   use closed_forms_dyads, only: body_t
   use expected_scales, only: listed_t, length_by_hand, rate_by_hand
   use expected_numbers, only: number_by_hand, field_length
   use expected_rows, only: expected_row_t, column_word, drive_word
   use expected_ratios, only: row_at
   use expected_links, only: move_links_to
   use expected_tables, only: put_heads, put_ratio_heads, with_unit, drive_value, instant_text
   use text_output, only: output_t, put
   implicit none
   private
   public :: put_extremes_by_hand

   !> Cells of the grid in a step of TIME. Values that differ by the second, relatively, are one: the earlier counts.
   integer, parameter :: refined = 8
   real(qp), parameter :: alike = 1.0e-12_qp, closes_to = 1.0e-6_qp, constant = 1.0e-15_qp
   real(qp), parameter :: golden = 0.61803398874989484820458683436563811772_qp

   !> How close to a change point the program's search comes, in steps of TIME.
   real(qp), parameter :: beside_change = 1.0_qp/256.0_qp

   !> The rows asked for at the times of a grid.
   type :: grid_t
      integer, allocatable :: asked(:)                 !< requests
      real(qp), allocatable :: t(:)                    !< (0:cells)
      real(qp), allocatable :: phi(:, :)               !< (links, 0:cells) angles
      !> How far all links end from where they began: lengths, angles, velocities, in characteristic ones.
      real(qp) :: closure(3) = 0.0_qp
      logical :: reverses = .false.                    !< some column does, twice or more
      type(expected_row_t), allocatable :: row(:, :)       !< (asked, 0:cells)
   end type grid_t

   type :: extreme_t
      real(qp) :: t = 0.0_qp, value = 0.0_qp
   end type extreme_t

contains

   !> The table; `flagged` (0:steps): instants of TIME without all of their motion, which goes on
   !> smoothly through them.
   subroutine put_extremes_by_hand(o, m, flagged)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      logical, intent(in) :: flagged(0:)
      type(grid_t) :: g
      integer :: q, kind

      g = grid_of(m)
      call put(o, '')
      call put_times(o, m, g)
      kind = 0
      do q = 1, size(g%asked)
         if (.not. any_varies(g, q)) cycle
         associate (request => m%requests(g%asked(q)))
            if (request%drive > 0) then
               if (kind /= request_ratio + g%row(q, 0)%dimension(1)) &
                  call put_ratio_heads(o, m, g%row(q, 0))
               kind = request_ratio + g%row(q, 0)%dimension(1)
            else
               if (request%kind /= kind) call put_heads(o, m, request%kind)
               kind = request%kind
            end if
            call put_subject(o, m, g, q)
         end associate
      end do
      if (g%reverses .and. .not. any(flagged) .and. any(g%closure > closes_to)) call put_closure(o, m, g)
      if (.not. any(flagged)) return
      call put_gaps(o, m, g, flagged, beside_change, merge(' --- EKSTREMA MOGA BYC POMINIETE W T =', &
         ' --- EXTREMES MAY BE MISSED WITHIN T =', m%polish))
      call put_gaps(o, m, g, flagged, 0.0_qp, merge(' --- NIE PRZESZUKANO (BRAK RUCHU): T =       ', &
         ' --- NOT SEARCHED (MOTION NOT AVAILABLE): T =', m%polish))
   end subroutine put_extremes_by_hand

   !> Why there are no time ratios.
   subroutine put_closure(o, m, g)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      character(120) :: line
      character(70) :: head
      character(22) :: lengths

      head = merge('BRAK STOSUNKU CZASOW, RUCH NIE JEST OKRESEM: JEGO KONCE ROZNIA SIE O', &
         'NO TIME RATIO, THE RUN IS NOT A PERIOD: ITS ENDS DIFFER BY          ', m%polish)
      lengths = merge('DLUGOSCI CHARAKT.     ', 'CHARACTERISTIC LENGTHS', m%polish)
      if (all(g%closure(:2) <= closes_to)) then
         line = trim(merge('PREDKOSCI       ', 'THEIR VELOCITIES', m%polish))
      else
         line = three_digits(g%closure(1))//' '//trim(lengths)//', '//three_digits(g%closure(2) &
            /merge(degree_q, 1.0_qp, m%degrees))//' '//merge('DEG', 'RAD', m%degrees)
      end if
      call put(o, ' --- '//trim(head)//' '//trim(line))
   end subroutine put_closure

   !> `x` with three digits, in fixed point from 0.001 to 1000.
   function three_digits(x) result(text)
      real(qp), intent(in) :: x
      character(:), allocatable :: text
      character(20) :: field, form
      integer :: order

      write (field, '(es20.2)') x
      read (field(index(field, 'E') + 1:), *) order
      if (order >= -3 .and. order < 3) then
         write (form, '(a, i0, a)') '(f20.', 2 - order, ')'
         write (field, form) x
      end if
      text = trim(adjustl(field))
   end function three_digits

   !> A line with the times of the `flagged` instants behind its `head`, or with the interval of twice the `part` of a
   !> step about each, inside the run.
   subroutine put_gaps(o, m, g, flagged, part, head)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      logical, intent(in) :: flagged(0:)
      real(qp), intent(in) :: part
      character(*), intent(in) :: head
      character(:), allocatable :: line
      real(qp) :: beside
      integer :: i

      line = trim(head)
      beside = part*refined*(g%t(1) - g%t(0))
      do i = 0, m%steps
         if (.not. flagged(i)) cycle
         if (line(len(line):) /= '=') line = line//','
         line = line//' '//instant_text(m, g%t(i*refined) - merge(beside, 0.0_qp, i > 0))
         if (part > 0.0_qp) line = line//' .. '//instant_text(m, g%t(i*refined) + merge(beside, 0.0_qp, i < m%steps))
      end do
      call put(o, line//' '//trim(m%time_unit))
   end subroutine put_gaps

   !> The line over the table: the run, and the drives at both of its ends.
   subroutine put_times(o, m, g)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      character(:), allocatable :: line, word, from
      integer :: i

      line = trim(merge(' EKSTREMA', ' EXTREMES', m%polish))//'   T = '//instant_text(m, g%t(0))//' .. ' &
         //with_unit(g%t(ubound(g%t, 1)), m%scales%time_decimals, m%scales%time_power, m%time_unit)
      do i = 1, size(m%drives)
         from = drive_value(m, m%drives(i), g%t(0))
         word = '   '//drive_word(m, m%drives(i))//' = '//from(:index(from, ' ') - 1)//' .. ' &
            //drive_value(m, m%drives(i), g%t(ubound(g%t, 1)))
         if (len(line//word) > 120) then
            call put(o, line)
            line = repeat(' ', 9)
         end if
         line = line//word
      end do
      call put(o, line)
   end subroutine put_times

   !> The rows of all requests for extremes of moving links.
   function grid_of(m) result(g)
      type(listed_t), intent(in) :: m
      type(grid_t) :: g
      type(body_t) :: links(size(m%links)), first(size(m%links))
      character(:), allocatable :: fault
      real(qp) :: length
      integer :: i, k, q, n

      n = refined*m%steps
      g%asked = pack([(i, i=1, size(m%requests))], m%requests%extremes .and. [(moves(m, i), i=1, size(m%requests))])
      allocate (g%t(0:n), g%phi(size(m%links), 0:n), g%row(size(g%asked), 0:n))
      links%phi%v = real(m%links%position(3), qp)
      do k = 0, n
         g%t(k) = real(m%t0, qp) + (real(m%t1, qp) - real(m%t0, qp))*k/n
         call move_links_to(m%name, m, g%t(k), links, fault)
         g%phi(:, k) = links%phi%v
         do q = 1, size(g%asked)
            g%row(q, k) = row_at(m, g%t(k), links, m%requests(g%asked(q)))
         end do
         if (k == 0) first = links
      end do
      length = length_by_hand(m)
      g%closure(1) = max(maxval(abs(links%x%v - first%x%v)), maxval(abs(links%y%v - first%y%v)))/length
      g%closure(2) = maxval(abs(wrap_angle(links%phi%v - first%phi%v)))
      g%closure(3) = max(maxval(abs(links%x%d - first%x%d))/length, maxval(abs(links%y%d - first%y%d))/length, &
         maxval(abs(links%phi%d - first%phi%d)))/rate_by_hand(m, length)
   end function grid_of

   !> Number (c, k) of row `q` is not the same at all times, but for the rounding of real128.
   logical function varies(g, q, c, k)
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c, k

      associate (f => g%row(q, :)%value(c, k))
         varies = maxval(f) - minval(f) > constant*(1.0_qp + maxval(abs(f)))
      end associate
   end function varies

   !> Some number of row `q` varies.
   logical function any_varies(g, q)
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q
      integer :: c, k

      any_varies = any([((varies(g, q, c, k), c=1, g%row(q, 0)%columns), k=0, 2)])
   end function any_varies

   !> The subject of request `i` does not belong to the ground.
   logical function moves(m, i)
      type(listed_t), intent(in) :: m
      integer, intent(in) :: i

      moves = .true.
      if (m%requests(i)%kind == request_link) moves = .not. m%links(m%requests(i)%subject)%ground
      if (m%requests(i)%kind == request_point) moves = .not. m%links(m%points(m%requests(i)%subject)%link)%ground
   end function moves

   !> Number (c, k) of row `q` at the time `t` beside grid point `i`.
   real(qp) function value_at(m, g, q, c, k, t, i) result(value)
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c, k, i
      real(qp), intent(in) :: t
      type(body_t) :: links(size(m%links))
      type(expected_row_t) :: row
      character(:), allocatable :: fault

      links%phi%v = g%phi(:, i)
      call move_links_to(m%name, m, t, links, fault)
      row = row_at(m, t, links, m%requests(g%asked(q)))
      value = row%value(c, k)
   end function value_at

   !> The greatest of number (c, k) of row `q` (`way` 1), or the least (-1).
   function extreme(m, g, q, c, k, way) result(best)
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c, k, way
      type(extreme_t) :: best, one
      real(qp) :: f(0:ubound(g%t, 1)), range
      logical :: first
      integer :: i

      f = way*g%row(q, :)%value(c, k)
      range = maxval(f) - minval(f)
      first = .true.
      if (.not. varies(g, q, c, k)) f = 0.0_qp
      do i = 0, ubound(f, 1)
         ! A grid point so far below the largest has none beside it: an extreme is flat.
         if (f(i) < maxval(f) - 0.1_qp*range .and. .not. first) cycle
         one = extreme_t(g%t(i), g%row(q, i)%value(c, k))
         if (range > 0.0_qp .and. any(abs(f) > 0.0_qp)) one = refined_extreme(m, g, q, c, k, way, i, f)
         if (first .or. way*(one%value - best%value) > alike*(1.0_qp + maxval(abs(f)))) best = one
         first = .false.
      end do
   end function extreme

   !> The same beside grid point `i`, where it is no less than its neighbours; otherwise the point itself.
   function refined_extreme(m, g, q, c, k, way, i, f) result(e)
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c, k, way, i
      real(qp), intent(in) :: f(0:)
      type(extreme_t) :: e
      real(qp) :: a, b, t1, t2, f1, f2
      integer :: left, right

      e = extreme_t(g%t(i), way*f(i))
      left = max(0, i - 1)
      right = min(ubound(f, 1), i + 1)
      if (max(f(left), f(right)) > f(i)) return
      a = g%t(left)
      b = g%t(right)
      t1 = b - golden*(b - a)
      t2 = a + golden*(b - a)
      f1 = way*value_at(m, g, q, c, k, t1, i)
      f2 = way*value_at(m, g, q, c, k, t2, i)
      do while (abs(b - a) > 1.0e-11_qp*abs(g%t(ubound(f, 1)) - g%t(0)))
         if (f1 >= f2) then
            b = t2
            t2 = t1
            f2 = f1
            t1 = b - golden*(b - a)
            f1 = way*value_at(m, g, q, c, k, t1, i)
         else
            a = t1
            t1 = t2
            f1 = f2
            t2 = a + golden*(b - a)
            f2 = way*value_at(m, g, q, c, k, t2, i)
         end if
      end do
      if (max(f1, f2) > f(i)) e = extreme_t(0.5_qp*(a + b), way*max(f1, f2))
   end function refined_extreme

   !> The lines of row `q`.
   subroutine put_subject(o, m, g, q)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(grid_t), intent(inout) :: g
      integer, intent(in) :: q
      type(extreme_t) :: e(-1:1, 3, 0:2)
      type(extreme_t), allocatable :: dead(:)
      character(field_length) :: fields(3, 0:2, 3), strokes(3, 0:2)
      character(3), parameter :: words(-1:1) = ['MIN', '   ', 'MAX']
      real(qp) :: period
      integer :: way, c, k, what, i
      character(:), allocatable :: drive, unit

      associate (row => g%row(q, 0), drive_of => m%drives(1))
         drive = drive_word(m, drive_of)
         unit = drive_value(m, drive_of, g%t(0))
         call put(o, ' '//row%name(:8)//merge('   NAPED ', '   DRIVE ', m%polish)//drive//','//unit(index(unit, ' '):))
         do way = -1, 1, 2
            fields = ''
            do k = 0, 2
               do c = 1, row%columns
                  if (.not. varies(g, q, c, k)) cycle
                  e(way, c, k) = extreme(m, g, q, c, k, way)
                  fields(c, k, 1) = number_of(m, row, c, k, e(way, c, k)%value)
                  fields(c, k, 2) = number_by_hand(e(way, c, k)%t, 0.0_qp, m%scales%time_decimals, m%scales%time_power)
                  fields(c, k, 3) = in_field(drive_value(m, drive_of, e(way, c, k)%t))
               end do
            end do
            call put_line(o, row, words(way), fields(:, :, 1))
            call put_line(o, row, trim(merge('W T ', 'AT T', m%polish)), fields(:, :, 2))
            call put_line(o, row, trim(merge('NAPED   ', 'AT DRIVE', m%polish)), fields(:, :, 3))
         end do
         ! Of ratios there are no strokes.
         if (row%kind == request_ratio) return
         strokes = ''
         do c = 1, row%columns
            if (varies(g, q, c, 0)) strokes(c, 0) = number_of(m, row, c, 0, e(1, c, 0)%value - e(-1, c, 0)%value)
         end do
         call put_line(o, row, trim(merge('SKOK  ', 'STROKE', m%polish)), strokes)
         do c = 1, row%columns
            if (.not. varies(g, q, c, 0)) cycle
            call find_dead_centres(m, g, q, c, dead, period)
            g%reverses = g%reverses .or. size(dead) >= 2
            if (any(g%closure > closes_to)) cycle
            if (size(dead) == 2) call put_stroke_times(o, m, g, q, c, e(1, c, 0)%t - e(-1, c, 0)%t, period)
            if (size(dead) <= 2) cycle
            do i = 1, size(dead)
               unit = drive_value(m, drive_of, dead(i)%t)
               call put(o, ' '//trim(merge('PUNKT ZWROTNY', 'DEAD CENTRE  ', m%polish))//'  ' &
                  //column_word(row, c, 0, m%polish)//'  ' &
                  //trim(adjustl(number_of(m, row, c, 0, dead(i)%value)))//'   T = ' &
                  //instant_text(m, dead(i)%t)//'   '//drive//' = '//unit(:index(unit, ' ') - 1))
            end do
         end do
         do c = 1, row%columns
            what = row%dimension(c)
            if (m%requests(g%asked(q))%dwell(what) <= 0.0 .or. .not. varies(g, q, c, 0)) cycle
            if (e(1, c, 0)%value - e(-1, c, 0)%value <= m%requests(g%asked(q))%dwell(what)) cycle
            do way = -1, 1, 2
               call put_dwells(o, m, g, q, c, way, e(way, c, 0), drive)
            end do
         end do
      end associate
   end subroutine put_subject

   !> The line of the times of both strokes of column `c` of row `q`, from the time of its least value to `later` after
   !> it, in a `period`.
   subroutine put_stroke_times(o, m, g, q, c, later, period)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c
      real(qp), intent(in) :: later, period
      real(qp) :: times(2)
      character(15), parameter :: words(3, 2) = reshape([character(15) :: 'TIME MIN TO MAX', 'TIME MAX TO MIN', &
         'TIME RATIO', 'CZAS MIN DO MAX', 'CZAS MAX DO MIN', 'STOSUNEK CZASOW'], [3, 2])
      integer :: k
      character(:), allocatable :: line

      times(1) = abs(period)*modulo(later/period, 1.0_qp)
      times(2) = abs(period) - times(1)
      line = '  '//column_word(g%row(q, 0), c, 0, m%polish)
      do k = 1, 2
         line = line//'   '//trim(words(k, m%language))//' ' &
            //with_unit(times(k), m%scales%time_decimals, m%scales%time_power, m%time_unit)
      end do
      call put(o, line//'   '//trim(words(3, m%language))//' ' &
         //trim(adjustl(number_by_hand(maxval(times)/minval(times), 0.0_qp, 6, 0))))
   end subroutine put_stroke_times

   !> Number (c, k) of `row`, in the unit of its column.
   function number_of(m, row, c, k, value) result(text)
      type(listed_t), intent(in) :: m
      type(expected_row_t), intent(in) :: row
      integer, intent(in) :: c, k
      real(qp), intent(in) :: value
      character(field_length) :: text

      associate (what => row%dimension(c))
         text = number_by_hand(value/merge(degree_q, 1.0_qp, what == 2 .and. m%degrees), 0.0_qp, &
            m%scales%decimals(what, k), &
            m%scales%power(what, k))
      end associate
   end function number_of

   !> The number of `text`, without its unit, at the end of a field.
   function in_field(text) result(field)
      character(*), intent(in) :: text
      character(field_length) :: field

      field = text(:index(text, ' ') - 1)
      field = adjustr(field)
   end function in_field

   !> A line of `fields` (3, 0:2) in the columns of `row`.
   subroutine put_line(o, row, label, fields)
      type(output_t), intent(inout) :: o
      type(expected_row_t), intent(in) :: row
      character(*), intent(in) :: label
      character(field_length), intent(in) :: fields(3, 0:2)
      character(9 + 9*field_length) :: line
      integer :: c, k, first

      line = '  '//label
      if (len(label) > 7) line = ' '//label
      do k = 0, 2
         do c = 1, row%columns
            first = 9 + field_length*(row%slot(c, k) - 1)
            line(first + 1:first + field_length) = fields(c, k)
         end do
      end do
      call put(o, trim(line))
   end subroutine put_line

   !> The `dead` centres of column `c` of row `q`, where its velocity changes its sign, by bisection: those of the
   !> shortest part of the run, the `period`, after which all of them repeat.
   subroutine find_dead_centres(m, g, q, c, dead, period)
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c
      type(extreme_t), allocatable, intent(out) :: dead(:)
      real(qp), intent(out) :: period
      real(qp) :: v(0:ubound(g%t, 1)), change
      integer :: i, n, last, first, few
      logical :: repeats

      n = ubound(g%t, 1)
      v = g%row(q, :)%value(c, 1)
      where (abs(v) <= 1.0e-20_qp*maxval(abs(v))) v = 0.0_qp
      allocate (dead(0))
      first = findloc(abs(v) > 0.0_qp, .true., dim=1) - 1
      last = first
      do i = first + 1, n
         if (.not. abs(v(i)) > 0.0_qp) cycle
         if (v(i)*v(last) < 0.0_qp) dead = [dead, dead_centre(last, i)]
         last = i
      end do
      if (v(first)*v(last) < 0.0_qp) dead = [extreme_t(g%t(0), g%row(q, 0)%value(c, 0)), dead]
      do few = 2, size(dead), 2
         period = (g%t(n) - g%t(0))*few/size(dead)
         repeats = mod(size(dead), few) == 0
         do i = few + 1, size(dead)
            change = dead(i)%value - dead(i - few)%value
            if (g%row(q, 0)%dimension(c) == 2) change = wrap_angle(change)
            repeats = repeats .and. abs(change) < closes_to .and. abs(dead(i)%t - dead(i - few)%t - period) &
               < closes_to*abs(g%t(n) - g%t(0))
         end do
         if (.not. repeats) cycle
         dead = dead(:few)
         return
      end do

   contains

      !> That between grid points `low` and `high`; where the column rests between them, the first of these.
      type(extreme_t) function dead_centre(low, high) result(e)
         integer, intent(in) :: low, high
         real(qp) :: a, b
         integer :: step

         e = extreme_t(g%t(low + 1), g%row(q, low + 1)%value(c, 0))
         if (high > low + 1) return
         a = g%t(low)
         b = g%t(high)
         do step = 1, 100
            e%t = 0.5_qp*(a + b)
            if (value_at(m, g, q, c, 1, e%t, low)*v(low) > 0.0_qp) then
               a = e%t
            else
               b = e%t
            end if
         end do
         e%value = value_at(m, g, q, c, 0, e%t, low)
      end function dead_centre
   end subroutine find_dead_centres

   !> The lines of the dwells within a distance of the extreme `e`: each time that the column comes inside.
   subroutine put_dwells(o, m, g, q, c, way, e, drive)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c, way
      type(extreme_t), intent(in) :: e
      character(*), intent(in) :: drive
      type(extreme_t), allocatable :: dead(:), path(:), ordered(:)
      logical, allocatable :: inside(:)
      real(qp) :: distance, level, period
      integer :: i, n

      n = ubound(g%t, 1)
      distance = real(m%requests(g%asked(q))%dwell(g%row(q, 0)%dimension(c)), qp)
      level = e%value - way*distance
      call find_dead_centres(m, g, q, c, dead, period)
      path = [(extreme_t(g%t(i), g%row(q, i)%value(c, 0)), i=0, n), dead, e]
      ordered = path(:0)
      do while (size(path) > 0)
         i = minloc((path%t - g%t(0))*sign(1.0_qp, g%t(n) - g%t(0)), dim=1)
         ordered = [ordered, path(i)]
         path = [path(:i - 1), path(i + 1:)]
      end do
      inside = way*(ordered%value - level) >= 0.0_qp
      do i = 1, size(ordered)
         if (.not. inside(i)) cycle
         if (i > 1) then
            if (inside(i - 1)) cycle
         else if (inside(size(ordered)) .and. goes_round(g, q, c)) then
            cycle
         end if
         call put_dwell(leaves(m, g, q, c, way, ordered(i)%t, level, -1), &
            leaves(m, g, q, c, way, ordered(i)%t, level, 1))
      end do

   contains

      !> The line of the dwell between two times.
      subroutine put_dwell(from, to)
         real(qp), intent(in) :: from, to
         character(:), allocatable :: first
         character(field_length) :: text

         text = number_of(m, g%row(q, 0), c, 0, distance)
         first = drive_value(m, m%drives(1), from)
         call put(o, ' '//trim(merge('POSTOJ', 'DWELL ', m%polish))//'  '//column_word(g%row(q, 0), c, 0, m%polish) &
            //'  '//merge('MAX', 'MIN', way > 0)//' +- '//trim(adjustl(text))//'   T = ' &
            //instant_text(m, from)//' .. '//instant_text(m, to)//'   '//drive//' = ' &
            //first(:index(first, ' ') - 1)//' .. '//trim(adjustl(in_field(drive_value(m, m%drives(1), to)))))
      end subroutine put_dwell
   end subroutine put_dwells

   !> After the last instant column `c` of row `q` goes on as from the first.
   logical function goes_round(g, q, c)
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c

      goes_round = all(g%closure <= closes_to) &
         .and. abs(g%row(q, ubound(g%t, 1))%value(c, 0) - g%row(q, 0)%value(c, 0)) <= closes_to
   end function goes_round

   !> When column `c` of row `q` passes the `level`, from the time `start` along the run (`side` 1) or against it: by
   !> bisection. In a cycle the run has no end.
   real(qp) function leaves(m, g, q, c, way, start, level, side) result(t)
      type(listed_t), intent(in) :: m
      type(grid_t), intent(in) :: g
      integer, intent(in) :: q, c, way, side
      real(qp), intent(in) :: start, level
      real(qp) :: inside, outside
      integer :: i, n

      n = ubound(g%t, 1)
      i = merge(count((g%t - start)*(g%t(n) - g%t(0)) <= 0.0_qp), &
         count((g%t - start)*(g%t(n) - g%t(0)) < 0.0_qp) - 1, side > 0)
      inside = start
      do
         if (i < 0 .or. i > n) then
            t = inside
            if (.not. goes_round(g, q, c)) return
            i = merge(0, n, side > 0)
         end if
         outside = g%t(i)
         if (way*(g%row(q, i)%value(c, 0) - level) < 0.0_qp) exit
         inside = outside
         i = i + side
      end do
      do while (abs(outside - inside) > 1.0e-15_qp*abs(g%t(n) - g%t(0)))
         t = 0.5_qp*(inside + outside)
         if (way*(value_at(m, g, q, c, 0, t, i) - level) < 0.0_qp) then
            outside = t
         else
            inside = t
         end if
      end do
      t = inside
   end function leaves
end module expected_extremes
