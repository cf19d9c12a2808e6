!> Card EXTREMES: the least and the greatest value of each coordinate, velocity and acceleration of a row, as far as
!> `extreme_search` has come; the times of the forward and the return stroke of a cyclic motion.
module extremes
   use kinds, only: wp
   use planar, only: without_turns
   use mechanism, only: mechanism_t, request_t, request_link, request_pair, pair_prismatic
   use scales, only: characteristic_length, characteristic_rate, is_length
   use drives, only: new_law, drive_motion, joints_of
   use points, only: is_fixed, coordinates_of
   use digits_in_doubt, only: safe_growth
   use independent, only: set_t, request_of
   use nodes, only: node_t, one_sided_t
   use zero_search, only: sample_t, noise_part
   implicit none
   private
   public :: extremes_t, extreme_t, track_t, gap_t, place_t, least, greatest, outward, extreme_words, rows_asked, &
      new_extremes, offer, offer_limits, count_turn, note_interval, stroke_times, is_cyclic, is_covered, is_angle, &
      column_of, alike

   !> Values that differ by less, in characteristic lengths or rad and rates, are alike, since errors
   !> that no table shows may be as large: the earlier one counts.
   real(wp), parameter :: alike = 10.0_wp*safe_growth*epsilon(1.0_wp)
   !> A value with a larger error has no digits in a table.
   real(wp), parameter :: badly_known = 1.0e-3_wp
   !> A motion is cyclic if its end differs from its beginning by less, in the same units.
   real(wp), parameter :: closes_to = max(1.0e-9_wp, 1000.0_wp*epsilon(1.0_wp))
   !> The first index of the extremes.
   integer, parameter :: least = 1, greatest = 2
   character(3), parameter :: extreme_words(least:greatest) = ['MIN', 'MAX']
   !> The direction in which values are more extreme.
   real(wp), parameter :: outward(least:greatest) = [-1.0_wp, 1.0_wp]

   !> In the deck's units and rad.
   type :: extreme_t
      logical :: exists = .false.
      logical :: has_bound = .true.                    !< false: the number grows without bound before the time `t`
      logical :: is_located = .false.                  !< at a zero of a derivative, not at a node
      real(wp) :: t = 0.0_wp, value = 0.0_wp
      real(wp) :: t_error = 0.0_wp, error = 0.0_wp     !< what rounding leaves open of both
   end type extreme_t

   !> The way that the rows of one independent mechanism have come.
   type :: track_t
      integer, allocatable :: rows(:)                  !< those asked for
      real(wp), allocatable :: joints(:)               !< times at which a law is not smooth
      logical :: drives_close = .false.                !< its drives are at the end of the run as at its beginning
      logical :: at_change = .false.                   !< the last instant is at a change point
      type(node_t) :: first, instant                   !< nodes of the first instant and of the last one
      type(node_t), allocatable :: last                !< the last node with all of the motion, of this piece
      integer :: halvings = 0                          !< of parts of this step
   end type track_t

   !> An interval of time.
   type :: gap_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp
   end type gap_t

   !> The coordinate `column` of the asked row number `asked` at the time `t`.
   type :: place_t
      integer :: asked = 0, column = 0
      real(wp) :: t = 0.0_wp, value = 0.0_wp
   end type place_t

   type :: extremes_t
      integer, allocatable :: asked(:)                 !< the requests of the set for extremes, but those of the ground
      integer, allocatable :: part(:)                  !< (asked) their independent mechanisms
      integer, allocatable :: columns(:)               !< (asked) of their rows
      logical, allocatable :: is_angle(:, :)           !< (3, asked) a column holds angles
      real(wp), allocatable :: dwell(:, :)             !< (3, asked) its dwells within this distance; 0: not asked for
      real(wp), allocatable :: size_of(:, :, :)        !< (3, 0:2, asked) characteristic value of each number
      type(extreme_t), allocatable :: found(:, :, :, :) !< (least:greatest, 3, 0:2, asked)
      integer, allocatable :: turns(:, :)              !< (3, asked) changes of sign of the velocity
      integer, allocatable :: first_sign(:, :), last_sign(:, :) !< (3, asked) of the velocity: the first, the latest
      type(track_t), allocatable :: tracks(:)          !< (independent mechanisms)
      type(gap_t), allocatable :: gaps(:)              !< (any number) in which not all is known, in the run's order
      type(gap_t), allocatable :: open(:)              !< (any number) in which extremes may be missed
      type(place_t), allocatable :: places(:)          !< (1:place and room) nodes and extremes of what may dwell
      integer :: place = 0
      real(wp) :: run = 0.0_wp                         !< the time of the run, below 0 backwards
      real(wp) :: way = 1.0_wp                         !< its sign
      real(wp) :: step = 0.0_wp                        !< a step of the TIME card
   end type extremes_t

contains

   !> The rows of `s` whose extremes are asked for, but those of the ground, which does not move.
   pure function rows_asked(s) result(asked)
      class(set_t), intent(in) :: s
      integer, allocatable :: asked(:)
      logical :: is_asked(size(s%rows))
      integer :: i

      do i = 1, size(s%rows)
         associate (own => s%parts(s%rows(i)%part), k => s%rows(i)%number)
            is_asked(i) = own%requests(k)%extremes .and. .not. is_fixed(own, own%requests(k))
         end associate
      end do
      asked = pack([(i, i=1, size(is_asked))], is_asked)
   end function rows_asked

   !> Ready for the first instant of the set `s`.
   subroutine new_extremes(s, x)
      class(set_t), intent(in) :: s
      type(extremes_t), intent(out) :: x
      type(request_t) :: request
      real(wp) :: length, rate
      integer :: i, c, k, q, n

      x%asked = rows_asked(s)
      n = size(x%asked)
      x%part = s%rows(x%asked)%part
      x%run = s%t1 - s%t0
      x%way = sign(1.0_wp, x%run)
      x%step = abs(x%run)/real(s%steps, wp)
      allocate (x%is_angle(3, n), x%dwell(3, n), x%size_of(3, 0:2, n), x%found(least:greatest, 3, 0:2, n))
      allocate (x%gaps(0), x%open(0), x%places(8), x%tracks(s%count), x%columns(n))
      allocate (x%turns(3, n), x%first_sign(3, n), x%last_sign(3, n), source=0)
      do q = 1, n
         request = request_of(s, x%asked(q))
         x%columns(q) = coordinates_of(request%kind)
         x%is_angle(:, q) = [(is_angle(s%parts(x%part(q)), request, c), c=1, 3)]
         x%dwell(:, q) = merge(request%dwell(2), request%dwell(1), x%is_angle(:, q))
      end do
      do c = 1, size(x%tracks)
         associate (track => x%tracks(c), own => s%parts(c))
            track%rows = pack([(q, q=1, n)], x%part == c)
            allocate (track%joints(0))
            if (size(track%rows) == 0) cycle
            do i = 1, size(own%drives)
               track%joints = [track%joints, joints_of(own%drives(i))]
            end do
            track%drives_close = drives_close(own)
            length = characteristic_length(own)
            rate = characteristic_rate(own, length)
            do k = 0, 2
               x%size_of(:, k, track%rows) = merge(1.0_wp, length, x%is_angle(:, track%rows))*rate**k
            end do
         end associate
      end do
   end subroutine new_extremes

   !> Column `c` of `request` holds angles.
   pure logical function is_angle(m, request, c)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      integer, intent(in) :: c

      is_angle = request%kind == request_link .and. c == 3
      if (request%kind == request_pair) is_angle = m%pairs(request%subject)%kind /= pair_prismatic
   end function is_angle

   !> The column of the tables that has coordinate `c` of the row of `request`: of a pair one of two, by whether it
   !> `is_angle`.
   pure integer function column_of(request, is_angle, c) result(column)
      type(request_t), intent(in) :: request
      logical, intent(in) :: is_angle
      integer, intent(in) :: c

      column = c
      if (request%kind == request_pair) column = merge(3, 1, is_angle)
   end function column_of

   !> Number `k` of `sample`, column `c` of row `q`, may be the least or the greatest; a place is kept, if its dwells
   !> are asked for. A value `at_zero` of the next derivative has its time from that, and replaces a node's beside it.
   pure subroutine offer(x, q, c, k, sample, at_zero)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: q, c, k
      type(sample_t), intent(in) :: sample
      logical, intent(in) :: at_zero
      real(wp) :: gain, open
      integer :: which
      logical :: better

      do which = least, greatest
         associate (e => x%found(which, c, k, q))
            if (.not. e%has_bound) cycle
            gain = (sample%f(k) - e%value)*outward(which)
            open = alike*x%size_of(c, k, q) + e%error + sample%error(k)
            better = .not. e%exists .or. gain > open
            if (at_zero .and. .not. (better .or. e%is_located)) better = gain >= -open &
               .and. abs(sample%t - e%t) <= x%step
            ! Of a value of which almost nothing is known, the least that it can be counts.
            if (e%error > badly_known*x%size_of(c, k, q) .and. abs(sample%t - e%t) > e%t_error) &
               better = better .or. gain + e%error > sample%error(k)
            ! A one-sided limit is known less well than the number itself.
            better = better .or. (abs(sample%t - e%t) <= 0.0_wp .and. sample%error(k) < e%error)
            if (better) e = extreme_t(exists=.true., is_located=at_zero, t=sample%t, &
               value=sample%f(k), t_error=sample%t_error, error=sample%error(k))
         end associate
      end do
      if (k == 0) call keep_place(x, q, c, sample)
   end subroutine offer

   !> Keeps column `c` of row `q` in `sample`, if its dwells are asked for.
   pure subroutine keep_place(x, q, c, sample)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: q, c
      type(sample_t), intent(in) :: sample

      if (x%dwell(c, q) <= 0.0_wp) return
      if (x%place == size(x%places)) x%places = [x%places, x%places]
      x%place = x%place + 1
      x%places(x%place) = place_t(q, c, sample%t, sample%f(0))
   end subroutine keep_place

   !> So may the one-sided `limits` of the numbers of `row` at the time `t`, unless they are badly known.
   pure subroutine offer_limits(x, row, t, limits)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: row
      real(wp), intent(in) :: t
      type(one_sided_t), intent(in) :: limits
      real(wp) :: gain
      integer :: which, c, k
      logical :: comes_back

      do k = 0, 2
         do c = 1, x%columns(row)
            ! Before the pole of a law what is faster and faster and stays within bounds goes to and fro.
            comes_back = limits%at_pole .and. k > 0 .and. limits%has_bound(c, 0, row)
            do which = least, greatest
               associate (e => x%found(which, c, k, row), value => limits%value(c, k, row), &
                          error => limits%error(c, k, row), has_bound => limits%has_bound(c, k, row))
                  gain = (value - e%value)*outward(which)
                  if (.not. e%has_bound) cycle
                  if (error > badly_known*max(x%size_of(c, k, row), abs(value)) .and. has_bound) cycle
                  if (has_bound) then
                     if (e%exists .and. gain <= alike*x%size_of(c, k, row) + e%error + error) cycle
                  else
                     if (.not. comes_back .and. ((value > 0.0_wp) .neqv. which == greatest)) cycle
                  end if
                  e = extreme_t(exists=.true., has_bound=has_bound, is_located=.true., t=t, value=value, error=error)
               end associate
            end do
         end do
      end do
   end subroutine offer_limits

   !> Counts a change of sign of the velocity `v` of column `c` of row `q`.
   pure subroutine count_turn(x, q, c, v)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: q, c
      real(wp), intent(in) :: v
      integer :: this

      if (abs(v) <= noise_part*x%size_of(c, 1, q)) return
      this = merge(1, -1, v > 0.0_wp)
      if (x%first_sign(c, q) == 0) x%first_sign(c, q) = this
      if (x%last_sign(c, q) == -this) x%turns(c, q) = x%turns(c, q) + 1
      x%last_sign(c, q) = this
   end subroutine count_turn

   !> Adds to the `list` the interval of time `from` .. `to`, in a run of the direction `way`; intervals that are not
   !> more than `apart_by` apart are one.
   pure subroutine note_interval(list, way, from, to, apart_by)
      type(gap_t), allocatable, intent(inout) :: list(:)
      real(wp), intent(in) :: way, from, to, apart_by
      type(gap_t), allocatable :: joined(:)
      logical :: apart(size(list)), before(size(list))
      real(wp) :: low, high
      integer :: n

      before = (list%to - from)*way < -apart_by
      apart = before .or. (to - list%from)*way < -apart_by
      low = min(way*from, minval(way*list%from, mask=.not. apart))
      high = max(way*to, maxval(way*list%to, mask=.not. apart))
      n = count(before)
      allocate (joined(count(apart) + 1))
      joined(:n) = list(:n)
      joined(n + 1) = gap_t(way*low, way*high)
      joined(n + 2:) = list(size(list) - size(joined) + n + 2:)
      call move_alloc(joined, list)
   end subroutine note_interval

   !> All of the motion is known, but for single instants.
   pure logical function is_covered(x)
      type(extremes_t), intent(in) :: x

      is_covered = .not. any(abs(x%gaps%to - x%gaps%from) > 0.0_wp)
   end function is_covered

   !> Times from the least to the greatest value of column `c` of row `q` and back, positive, after the last instant:
   !> of a cyclic motion that turns twice, whose run is one period. Otherwise 0.
   pure function stroke_times(x, q, c) result(times)
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q, c
      real(wp) :: times(2), phase

      times = 0.0_wp
      if (x%turns(c, q) + merge(1, 0, x%first_sign(c, q) /= x%last_sign(c, q)) /= 2) return
      if (.not. is_cyclic(x, q)) return
      phase = modulo((x%found(greatest, c, 0, q)%t - x%found(least, c, 0, q)%t)/x%run, 1.0_wp)
      times = abs(x%run)*[phase, 1.0_wp - phase]
   end function stroke_times

   !> After the last instant: the drives of the mechanism of row `q`, and the row's positions and velocities, are as at
   !> the first, but for whole turns.
   pure logical function is_cyclic(x, q)
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q
      real(wp) :: d(0:1)
      integer :: known, c

      is_cyclic = is_covered(x) .and. x%tracks(x%part(q))%drives_close
      if (.not. is_cyclic) return
      associate (first => x%tracks(x%part(q))%first, last => x%tracks(x%part(q))%instant)
         known = min(first%known(q), last%known(q))
         is_cyclic = known >= 0
         do c = 1, x%columns(q)
            d = last%value(c, :1, q) - first%value(c, :1, q)
            if (x%is_angle(c, q)) d(0) = without_turns(d(0))
            ! At a change point velocities are not unique.
            if (known < 1) d(1) = 0.0_wp
            is_cyclic = is_cyclic .and. all(abs(d) <= closes_to*x%size_of(c, :1, q))
         end do
      end associate
   end function is_cyclic

   !> The drives of `m` are at the end of the run as at its beginning, with their accelerations, but for whole turns.
   logical function drives_close(m)
      type(mechanism_t), intent(in) :: m
      real(wp) :: d(3), length, rate
      integer :: i

      length = characteristic_length(m)
      rate = characteristic_rate(m, length)
      drives_close = .true.
      do i = 1, size(m%drives)
         d = drive_motion(new_law(m%drives(i)), m%t1) - drive_motion(new_law(m%drives(i)), m%t0)
         if (is_length(m%drives(i))) then
            d = d/length
         else
            d(1) = without_turns(d(1))
         end if
         drives_close = drives_close .and. all(abs(d) <= closes_to*[1.0_wp, rate, rate**2])
      end do
   end function drives_close
end module extremes
