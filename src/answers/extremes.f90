!> Card EXTREMES: the least and the greatest value of each coordinate, velocity and acceleration of a row, as far as
!> `extreme_search` has come; the times of the forward and the return stroke of a cyclic motion.
module extremes
   use kinds, only: wp
   use planar, only: pi, without_turns
   use mechanism, only: mechanism_t, request_t, request_link, request_pair, pair_prismatic, term_harmonic
   use motion, only: motion_t
   use scales, only: characteristic_length, characteristic_rate
   use drives, only: joints_of
   use points, only: is_fixed, coordinates_of
   use digits_in_doubt, only: safe_growth
   use independent, only: set_t, request_of
   use nodes, only: node_t, one_sided_t, order_along
   use zero_search, only: sample_t, noise_part
   implicit none
   private
   public :: extremes_t, extreme_t, track_t, gap_t, value_at_t, least, greatest, outward, extreme_words, rows_asked, &
      new_extremes, offer, offer_limits, note_velocity, note_end, note_interval, is_cyclic, is_covered, is_angle, &
      column_of, varies, strokes_t, strokes_of, ratio_decimals, closes_to, alike

   !> Values that differ by less, in characteristic lengths or rad and rates, are alike, since errors
   !> that no table shows may be as large: the earlier one counts.
   real(wp), parameter :: alike = 10.0_wp*safe_growth*epsilon(1.0_wp)
   !> Derivatives that no estimate of errors is made for may be off by so much, in these units: with 1/p for the inverse
   !> of a block's Jacobian, roundings grow by 1/p^2 < `safe_growth` in velocities and by 1/p^3 in accelerations.
   real(wp), parameter :: unseen(0:2) = alike*[1.0_wp, 1.0_wp, sqrt(safe_growth)]
   !> An error is an estimate: only a variation that is so many times as large is known to be one. A table shows no
   !> digit of a smaller one, for its last digit is worth a hundred errors.
   real(wp), parameter :: above_errors = 10.0_wp
   !> A value with a larger error has no digits in a table.
   real(wp), parameter :: badly_known = 1.0e-3_wp
   !> A motion is cyclic if its end differs from its beginning by less, in the same units: a turn of 6.2831853 rad is
   !> one. Times of reversals repeat within this part of the run.
   real(wp), parameter :: closes_to = max(1.0e-6_wp, 1000.0_wp*epsilon(1.0_wp))
   !> So many parts at least has a turn of a drive, and a period of a harmonic law.
   integer, parameter :: parts_of_turn = 12
   !> Digits after the point of a ratio of times.
   integer, parameter :: ratio_decimals = 6
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
      real(wp), allocatable :: joints(:)               !< times at which a law is not smooth, in the run's order
      real(wp) :: longest = huge(1.0_wp)               !< part of a step that is searched as a whole
      type(motion_t), allocatable :: start              !< the motion at the first instant
      !> How far links end from where they began: lengths, angles, velocities, in characteristic ones.
      real(wp) :: closure(3) = huge(1.0_wp)
      logical :: at_change = .false.                   !< the last instant is at a change point
      real(wp) :: t = 0.0_wp                           !< the last instant
      logical :: is_known = .false., is_lost = .false. !< all of the motion is known there; of some row nothing
      !> The last node up to which this piece is searched, the next one, and one more while both parts are searched; so
      !> many are `filled`.
      type(node_t) :: nodes(3)
      integer :: filled = 0
      integer :: halvings = 0                          !< of parts of this step
   end type track_t

   !> An interval of time.
   type :: gap_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp
   end type gap_t

   !> The coordinate `column` of the asked row number `asked` at the time `t`.
   type :: value_at_t
      integer :: asked = 0, column = 0
      real(wp) :: t = 0.0_wp, value = 0.0_wp
   end type value_at_t

   !> Places (1:n and room).
   type :: place_list_t
      type(value_at_t), allocatable :: list(:)
      integer :: n = 0
   end type place_list_t

   !> How a coordinate has moved: the first sign of its velocity and the latest, 0 for none; where it was `slowest`
   !> since that, at this `speed`, and where it was before the first.
   type :: reversals_t
      integer :: first_sign = 0, last_sign = 0
      type(value_at_t) :: start, slowest
      real(wp) :: speed = huge(1.0_wp)
   end type reversals_t

   !> The strokes of a coordinate: it reverses at the places of one period; two of them are the ends of both strokes,
   !> which take the `times` from the least value to the greatest and back. None: the motion is not cyclic.
   type :: strokes_t
      type(extreme_t) :: length                        !< greatest minus least value, if both exist and differ
      integer :: in_run = 0                            !< reversals in the whole run
      type(value_at_t), allocatable :: reversals(:)
      real(wp) :: times(2) = 0.0_wp
      real(wp) :: ratio = 0.0_wp, error = 0.0_wp       !< the longer time over the shorter, and what is unknown of it
   end type strokes_t

   type :: extremes_t
      integer, allocatable :: asked(:)                 !< the requests of the set for extremes, but those of the ground
      integer, allocatable :: part(:)                  !< (asked) their independent mechanisms
      integer, allocatable :: columns(:)               !< (asked) of their rows
      logical, allocatable :: is_angle(:, :)           !< (3, asked) a column holds angles
      real(wp), allocatable :: dwell(:, :)             !< (3, asked) its dwells within this distance; 0: not asked for
      real(wp), allocatable :: size_of(:, :, :)        !< (3, 0:2, asked) characteristic value of each number
      type(extreme_t), allocatable :: found(:, :, :, :) !< (least:greatest, 3, 0:2, asked)
      type(reversals_t), allocatable :: course(:, :)      !< (3, asked)
      type(place_list_t) :: reversals                      !< of all coordinates
      type(track_t), allocatable :: tracks(:)          !< (independent mechanisms)
      type(gap_t), allocatable :: gaps(:)              !< (any number) in which not all is known, in the run's order
      type(gap_t), allocatable :: open(:)              !< (any number) in which extremes may be missed
      type(place_list_t) :: places                         !< nodes and extremes of what may dwell
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
      real(wp) :: length, rate, fastest
      integer :: i, c, k, q, n

      x%asked = rows_asked(s)
      n = size(x%asked)
      x%part = s%rows(x%asked)%part
      x%run = s%t1 - s%t0
      x%way = sign(1.0_wp, x%run)
      x%step = abs(x%run)/real(s%steps, wp)
      allocate (x%is_angle(3, n), x%dwell(3, n), x%size_of(3, 0:2, n), x%found(least:greatest, 3, 0:2, n))
      allocate (x%gaps(0), x%open(0), x%tracks(s%count), x%columns(n), x%course(3, n))
      allocate (x%places%list(8), x%reversals%list(8))
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
            fastest = 0.0_wp
            if (size(track%rows) == 0) cycle
            do i = 1, size(own%drives)
               track%joints = [track%joints, joints_of(own%drives(i))]
               if (allocated(own%drives(i)%terms)) fastest = max(fastest, maxval(abs(own%drives(i)%terms%r(2)), &
                  mask=own%drives(i)%terms%kind == term_harmonic))
            end do
            track%joints = track%joints(order_along(track%joints, x%way))
            length = characteristic_length(own)
            rate = characteristic_rate(own, length)
            track%longest = 2.0_wp*pi/(parts_of_turn*max(rate, fastest))
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
      if (k == 0 .and. x%dwell(c, q) > 0.0_wp) call add_place(x%places, value_at_t(q, c, sample%t, sample%f(0)))
   end subroutine offer

   !> Adds `place` to `p`.
   pure subroutine add_place(p, place)
      type(place_list_t), intent(inout) :: p
      type(value_at_t), intent(in) :: place

      if (p%n == size(p%list)) p%list = [p%list, p%list]
      p%n = p%n + 1
      p%list(p%n) = place
   end subroutine add_place

   !> So may the one-sided `limits` of the numbers of `row` at the time `t`, unless they are badly known.
   pure subroutine offer_limits(x, row, t, limits)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: row
      real(wp), intent(in) :: t
      type(one_sided_t), intent(in) :: limits
      real(wp) :: gain
      integer :: which, c, k

      do k = 0, 2
         do c = 1, x%columns(row)
            do which = least, greatest
               associate (e => x%found(which, c, k, row), value => limits%value(c, k, row), &
                          error => limits%error(c, k, row), has_bound => limits%has_bound(c, k, row))
                  gain = (value - e%value)*outward(which)
                  if (.not. e%has_bound) cycle
                  if (error > badly_known*max(x%size_of(c, k, row), abs(value)) .and. has_bound) cycle
                  if (has_bound) then
                     if (e%exists .and. gain <= alike*x%size_of(c, k, row) + e%error + error) cycle
                  else
                     if ((value > 0.0_wp) .neqv. which == greatest) cycle
                  end if
                  e = extreme_t(exists=.true., has_bound=has_bound, is_located=.true., t=t, value=value, error=error)
               end associate
            end do
         end do
      end do
   end subroutine offer_limits

   !> Takes the velocity of column `c` of row `q` in the next `sample` along the run: where its sign has changed the
   !> coordinate has reversed, at its slowest place between.
   pure subroutine note_velocity(x, q, c, sample)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: q, c
      type(sample_t), intent(in) :: sample
      real(wp) :: speed
      integer :: this

      speed = abs(sample%f(1))
      if (speed <= noise_part*x%size_of(c, 1, q)) speed = 0.0_wp
      associate (course => x%course(c, q), place => value_at_t(q, c, sample%t, sample%f(0)))
         if (speed < course%speed) then
            course%slowest = place
            course%speed = speed
         end if
         if (speed <= 0.0_wp) return
         this = merge(1, -1, sample%f(1) > 0.0_wp)
         if (course%first_sign == 0) then
            course%first_sign = this
            course%start = course%slowest
         end if
         if (course%last_sign == -this) call add_place(x%reversals, course%slowest)
         course%last_sign = this
         course%slowest = place
         course%speed = speed
      end associate
   end subroutine note_velocity

   !> Takes the motion `last` of mechanism `c`, `m`, at the end of the run.
   subroutine note_end(x, m, c, last)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: c
      type(motion_t), intent(in) :: last
      real(wp) :: d(3, size(m%links)), length

      length = characteristic_length(m)
      associate (track => x%tracks(c))
         if (min(track%start%known, last%known) < 0) return
         d = last%position - track%start%position
         d(3, :) = without_turns(d(3, :))
         track%closure = [maxval(abs(d(:2, :)))/length, maxval(abs(d(3, :))), 0.0_wp]
         ! At a change point velocities are not unique.
         if (min(track%start%known, last%known) < 1) return
         d = last%velocity - track%start%velocity
         d(:2, :) = d(:2, :)/length
         track%closure(3) = maxval(abs(d))/characteristic_rate(m, length)
      end associate
   end subroutine note_end

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

   !> After the last instant: all links of the mechanism of row `q` are where they were at the first, but for whole
   !> turns, and as fast.
   pure logical function is_cyclic(x, q)
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q

      is_cyclic = is_covered(x) .and. all(x%tracks(x%part(q))%closure <= closes_to)
   end function is_cyclic

   !> Derivative `k` of column `c` of row `q` has a least and a greatest value that differ by more than rounding can
   !> make, or one of them is not known.
   pure logical function varies(x, q, c, k)
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q, c, k

      associate (e => x%found(:, c, k, q))
         varies = .not. all(e%exists .and. e%has_bound) .or. e(greatest)%value - e(least)%value &
            > unseen(k)*x%size_of(c, k, q) + above_errors*sum(e%error)
      end associate
   end function varies

   !> The strokes of column `c` of row `q` after the last instant, in the shortest part of a cyclic run after which its
   !> reversals repeat.
   pure type(strokes_t) function strokes_of(x, q, c) result(strokes)
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q, c
      type(value_at_t), allocatable :: all_of(:)
      real(wp), allocatable :: change(:)
      real(wp) :: period, phase
      integer :: n, in_period

      associate (e => x%found(:, c, 0, q))
         strokes%length = extreme_t(value=e(greatest)%value - e(least)%value, error=sum(e%error), &
            exists=all(e%exists .and. e%has_bound) .and. varies(x, q, c, 0))
      end associate
      associate (list => x%reversals%list(:x%reversals%n))
         all_of = pack(list, list%asked == q .and. list%column == c)
      end associate
      associate (course => x%course(c, q))
         if (course%first_sign /= course%last_sign) all_of = [course%start, all_of]
      end associate
      n = size(all_of)
      strokes%in_run = n
      strokes%reversals = all_of(:0)
      if (n == 0 .or. .not. is_cyclic(x, q)) return
      do in_period = 2, n, 2
         if (mod(n, in_period) /= 0) cycle
         period = x%run*in_period/n
         change = all_of(in_period + 1:)%value - all_of(:n - in_period)%value
         if (x%is_angle(c, q)) change = without_turns(change)
         if (all(abs(change) <= closes_to*x%size_of(c, 0, q)) .and. all(abs(all_of(in_period + 1:)%t &
            - all_of(:n - in_period)%t - period) <= closes_to*abs(x%run))) exit
      end do
      if (in_period > n) return
      strokes%reversals = all_of(:in_period)
      if (in_period > 2) return
      associate (e => x%found(:, c, 0, q))
         phase = modulo((e(greatest)%t - e(least)%t)/period, 1.0_wp)
         strokes%times = abs(period)*[phase, 1.0_wp - phase]
         if (minval(strokes%times) <= 0.0_wp) return
         strokes%ratio = maxval(strokes%times)/minval(strokes%times)
         strokes%error = sum(e%t_error)*abs(period)/minval(strokes%times)**2
      end associate
   end function strokes_of
end module extremes
