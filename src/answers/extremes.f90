!> Card EXTREMES: the least and the greatest value of each coordinate, velocity and acceleration of a row, up to the
!> time that `extreme_search` has reached; the times of the forward and the return stroke of a cyclic motion.
module extremes
   use kinds, only: wp
   use plane_vectors, only: pi, in_degrees, wrap_angle
   use mechanism, only: request_t, drive_t
   use scales, only: is_length
   use separations, only: closes, closes_to
   use drives, only: joints_of, largest_frequency
   use instant_centres, only: points_coincide
   use points, only: row_t, column_of_ratio
   use columns, only: columns_of_rows, forms, kinds_of_rows, column_at, is_ratio, usual_size, of_angle
   use significance_check, only: max_amplification
   use independent, only: set_t, request_of
   use set_members, only: row_form, ratio_drive, moving_extremes, drive_of, sizes_of
   use nodes, only: node_t, extreme_t, order_along
   use zero_search, only: noise_part
   implicit none
   private
   public :: extremes_t, coordinate_t, track_t, piece_end_t, uncovered_interval_t, value_at_t, least, greatest, &
      outward, new_extremes, offer, add_interval, is_cyclic, is_covered, varies, strokes_t, strokes_of, badly_known, &
      equal_part

   !> Values closer than this, in characteristic lengths or rad and rates, count as equal, and the earlier one is
   !> printed: errors below a table's last digit may be as large.
   real(wp), parameter :: equal_part = 10.0_wp*max_amplification*epsilon(1.0_wp)
   !> Derivatives without an estimate of errors may be off by so much, in these units: with 1/p for the inverse of a
   !> block's Jacobian, roundings grow by 1/p^2 < `max_amplification` in velocities and by 1/p^3 in accelerations.
   real(wp), parameter :: unseen_part(0:2) = equal_part*[1.0_wp, 1.0_wp, sqrt(max_amplification)]
   !> A variation counts if it exceeds this many estimated errors; a smaller one has no digit in a table.
   real(wp), parameter :: above_errors = 10.0_wp
   !> A value with a larger error, in characteristic values, has no digits in a table.
   real(wp), parameter :: badly_known = 1.0e-3_wp
   !> A turn of a drive, and a period of a harmonic law, has at least so many parts.
   integer, parameter :: parts_of_turn = 12
   !> The first index of the extremes.
   integer, parameter :: least = 1, greatest = 2
   !> The direction in which values are more extreme.
   real(wp), parameter :: outward(least:greatest) = [-1.0_wp, 1.0_wp]

   !> A coordinate at a time: the time in the deck's unit, the coordinate in the deck's unit or rad.
   type :: value_at_t
      real(wp) :: t = 0.0_wp, value = 0.0_wp
   end type value_at_t

   !> A coordinate of a row whose extremes are asked for, in the deck's unit or rad, with its rate and acceleration.
   type :: coordinate_t
      integer :: request = 0, column = 0               !< number in the set, and column (1 to 3) in the row of this
      integer :: form = 0                              !< of the row
      integer :: columns(0:2) = 0                      !< of its derivatives, in `columns_of_rows`; 0: in no row
      integer :: part = 0, row = 0                     !< number of its mechanism, and of its row in `track_t`
      logical :: is_angle = .false.                    !< otherwise a length or a ratio
      logical :: can_coincide = .false.                !< it may be known less well if two points are near
      logical :: sought(0:2) = .true.                  !< the extremes that are asked for, by derivative
      real(wp) :: dwell = 0.0_wp                       !< distance from an extreme in which it dwells; 0: not asked for
      real(wp) :: size_of(0:2) = 0.0_wp                !< characteristic value, rate and acceleration
      real(wp) :: drive_rate = 0.0_wp                  !< of a ratio: rate of the drive at t = 0, in the deck's units
      type(extreme_t) :: found(least:greatest, 0:2)    !< the extremes so far, by derivative
      real(wp) :: last(3) = 0.0_wp                     !< latest rate, acceleration and jerk with a clear sign
      type(value_at_t), allocatable :: places(:)       !< (any number) nodes and extremes, if it may dwell
      !> Its way: the first sign of its velocity and the latest, 0 for none; its place at the lowest `speed` since the
      !> latest sign, the place before the first sign, and the places at which it has reversed.
      integer :: first_sign = 0, last_sign = 0
      type(value_at_t) :: start, slowest
      real(wp) :: speed = huge(1.0_wp)
      type(value_at_t), allocatable :: reversals(:)
   end type coordinate_t

   !> An end of a piece of a step.
   type :: piece_end_t
      real(wp) :: t = 0.0_wp                           !< time
      !> `is_open`: some of the motion does not exist there. `is_change`: it is a change point, otherwise a limit.
      logical :: is_open = .false., is_change = .false.
   end type piece_end_t

   !> The coordinates of one independent mechanism along the run.
   type :: track_t
      integer, allocatable :: requests(:)              !< (rows) numbers in the set of those that are asked for
      type(row_t), allocatable :: rows(:)              !< room for their rows
      real(wp), allocatable :: error(:, :, :)          !< (3, 0:2, rows) room for the errors of the rows
      type(coordinate_t), allocatable :: coordinates(:)   !< (any number) the columns that are searched
      real(wp), allocatable :: joints(:)               !< times at which a law is not smooth, in the run's order
      real(wp) :: longest = huge(1.0_wp)               !< part of a step that is searched as a whole
      !> The largest difference of the last motion from the first: lengths, angles, velocities, in characteristic ones.
      real(wp) :: closure(3) = huge(1.0_wp)
      type(piece_end_t) :: last                        !< the last instant
      logical :: is_lost = .false.                     !< of some row nothing is known there
      !> The first node is the last one up to which this piece is searched; so many are `filled`, and the next one is
      !> put after these.
      type(node_t) :: nodes(3)
      integer :: filled = 0                            !< nodes
      logical :: turns = .false.                       !< a number may have an extreme between the three nodes
      integer :: halvings = 0                          !< of parts of this step
   end type track_t

   !> An interval of time.
   type :: uncovered_interval_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp           !< times, in the run's order
   end type uncovered_interval_t

   !> The strokes of a coordinate: it reverses at the places of one period. Two reversals are the ends of both strokes,
   !> which take the `times` from the least value to the greatest and back. No reversals: the motion is not cyclic.
   type :: strokes_t
      type(extreme_t) :: length                        !< greatest minus least value, if both exist and differ
      integer :: in_run = 0                            !< reversals in the whole run
      type(value_at_t), allocatable :: reversals(:)    !< (any number) of one period
      real(wp) :: times(2) = 0.0_wp                    !< of the two strokes; 0: not known
      real(wp) :: ratio = 0.0_wp, error = 0.0_wp       !< the longer time over the shorter, and its error
   end type strokes_t

   !> The search for extremes of a set.
   type :: extremes_t
      integer, allocatable :: asked(:)                 !< the requests of the set for extremes, but those of the ground
      type(track_t), allocatable :: tracks(:)          !< (independent mechanisms)
      type(uncovered_interval_t), allocatable :: gaps(:)   !< (any number) in which not all is known, in the run's order
      type(uncovered_interval_t), allocatable :: open(:)   !< (any number) in which extremes may be missed
      real(wp) :: run = 0.0_wp                         !< the time of the run, below 0 backwards
      real(wp) :: way = 1.0_wp                         !< the sign of `run`
      real(wp) :: step = 0.0_wp                        !< a step of the TIME card
   end type extremes_t

contains

   !> Prepares the search for extremes of a set, before its first instant: its coordinates and the joints of its laws.
   subroutine new_extremes(set, extremes)
      class(set_t), intent(in) :: set        !< with a TIME card
      type(extremes_t), intent(out) :: extremes   !< without an instant
      type(drive_t) :: drive
      real(wp) :: sizes(2), fastest
      type(request_t) :: request
      integer :: i, c, n, q

      extremes%asked = moving_extremes(set)
      extremes%run = set%t1 - set%t0
      extremes%way = sign(1.0_wp, extremes%run)
      extremes%step = abs(extremes%run)/real(set%steps, wp)
      allocate (extremes%gaps(0), extremes%open(0), extremes%tracks(set%count))

      do c = 1, size(extremes%tracks)
         associate (track => extremes%tracks(c))
            track%requests = pack(extremes%asked, set%rows(extremes%asked)%part == c)
            sizes = sizes_of(set, c)
            n = size(track%requests)
            allocate (track%rows(n), track%error(3, 0:2, n))
            allocate (track%coordinates(3*n))
            n = 0
            do q = 1, size(track%requests)
               request = request_of(set, track%requests(q))
               do i = 1, forms(row_form(set, track%requests(q)))%coordinates
                  if (.not. any(request%sought(i, :))) cycle
                  n = n + 1
                  track%coordinates(n)%part = c
                  track%coordinates(n)%row = q
                  call set_coordinate(track%coordinates(n), set, track%requests(q), i, sizes)
               end do
            end do
            track%coordinates = track%coordinates(:n)

            allocate (track%joints(0))
            fastest = 0.0_wp
            do i = 1, merge(size(set%drives), 0, n > 0)
               if (set%drives(i)%part /= c) cycle
               drive = drive_of(set, i)
               track%joints = [track%joints, joints_of(drive)]
               fastest = max(fastest, largest_frequency(drive))
            end do
            track%joints = track%joints(order_along(track%joints, extremes%way))
            track%longest = 2.0_wp*pi/(parts_of_turn*max(sizes(2), fastest))
         end associate
      end do
   end subroutine new_extremes

   !> Makes a coordinate of a row ready for the search. A search takes a ratio as the velocity of a coordinate of which
   !> nothing is known, and the rate of the ratio as the acceleration. The derivative by the drive has its extremes
   !> where the rate has them only if the rate of the drive is constant; otherwise they are not sought.
   subroutine set_coordinate(coordinate, set, request, column, sizes)
      type(coordinate_t), intent(inout) :: coordinate   !< with its part and row; gets the rest
      class(set_t), intent(in) :: set        !< divided
      integer, intent(in) :: request         !< number of the request in the set
      integer, intent(in) :: column          !< of the row, 1 to 3
      real(wp), intent(in) :: sizes(2)       !< characteristic length and rate of the mechanism
      type(request_t) :: asked
      type(drive_t) :: drive
      integer :: k

      asked = request_of(set, request)
      coordinate%request = request
      coordinate%column = column
      coordinate%form = row_form(set, request)
      coordinate%columns = [(column_at(coordinate%form, column, k), k=0, 2)]
      coordinate%sought = asked%sought(column, :)
      coordinate%is_angle = columns_of_rows(coordinate%columns(0))%dimension == of_angle
      coordinate%can_coincide = .not. columns_of_rows(column_at(kinds_of_rows(asked%kind)%forms(1), 1, 1)) &
         %there(points_coincide)
      if (coordinate%sought(0)) coordinate%dwell = asked%dwell(merge(2, 1, coordinate%is_angle))
      coordinate%size_of = merge(1.0_wp, sizes(1), coordinate%is_angle)*sizes(2)**[(k, k=0, 2)]
      allocate (coordinate%places(0), coordinate%reversals(0))
      if (.not. is_ratio(coordinate%form)) return

      drive = drive_of(set, ratio_drive(set, request))
      coordinate%drive_rate = drive%polynomial(2)
      if (set%degrees .and. .not. is_length(drive)) coordinate%drive_rate = in_degrees(coordinate%drive_rate)
      if (abs(drive%polynomial(3)) > 0.0_wp .or. .not. abs(drive%polynomial(2)) > 0.0_wp) coordinate%sought(1) = .false.
      coordinate%sought(1) = coordinate%sought(1) .and. .not. allocated(drive%terms)
      coordinate%column = column_of_ratio
      coordinate%columns = [0, coordinate%columns(:1)]
      coordinate%sought = [.false., coordinate%sought(:1)]
      ! No digit of the unknown coordinate counts.
      coordinate%size_of(0) = sqrt(huge(1.0_wp))
      coordinate%size_of(1) = usual_size(columns_of_rows(coordinate%columns(1))%dimension, 0, sizes(1), sizes(2), &
         set%degrees)
      coordinate%size_of(2) = coordinate%size_of(1)*sizes(2)
   end subroutine set_coordinate

   !> Takes a value as the least or the greatest of a coordinate, if the value is more extreme than those so far. A
   !> located value replaces the value of a node less than a step away. A node replaces another node less than a step
   !> away if its value is more extreme by more than rounding, though equal otherwise: their distance is then the error
   !> of the time.
   pure subroutine offer(coordinate, k, extreme, step)
      type(coordinate_t), intent(inout) :: coordinate   !< gets the extreme
      integer, intent(in) :: k               !< which derivative of the coordinate, 0 to 2
      type(extreme_t), intent(in) :: extreme   !< of the number, at a node, at a zero or as a limit
      real(wp), intent(in) :: step           !< of TIME
      real(wp) :: gain, open
      integer :: which
      logical :: better, near

      do which = least, greatest
         associate (best => coordinate%found(which, k))
            if (.not. best%has_bound) cycle
            gain = (extreme%value - best%value)*outward(which)
            open = equal_part*coordinate%size_of(k) + best%error + extreme%error
            better = .not. best%exists .or. gain > open
            near = gain > noise_part*max(coordinate%size_of(k), abs(extreme%value)) + best%error + extreme%error &
               .and. abs(extreme%t - best%t) < step .and. .not. (better .or. best%is_located .or. extreme%is_located)
            better = better .or. near
            if (extreme%is_located .and. .not. (better .or. best%is_located)) &
               better = gain >= -open .and. abs(extreme%t - best%t) < step
            ! Of a value that is badly known the least possible value counts.
            if (best%error > badly_known*coordinate%size_of(k) .and. abs(extreme%t - best%t) > best%t_error) &
               better = better .or. gain + best%error > extreme%error
            ! A one-sided limit is known less well than the number itself.
            better = better .or. (.not. extreme%is_located .and. abs(extreme%t - best%t) <= 0.0_wp &
               .and. extreme%error < best%error)
            ! An equal value that is much better known replaces a value that may be known less well.
            better = better .or. (coordinate%can_coincide .and. abs(gain) <= open &
               .and. extreme%error < badly_known*best%error)
            if (.not. extreme%has_bound) better = extreme%value*outward(which) > 0.0_wp
            if (.not. better) cycle
            open = merge(abs(extreme%t - best%t), 0.0_wp, near)
            best = extreme
            best%t_error = max(best%t_error, open)
         end associate
      end do
   end subroutine offer

   !> Adds an interval of time to a list. Intervals that are near one another become one.
   pure subroutine add_interval(list, way, from, to, apart_by)
      type(uncovered_interval_t), allocatable, intent(inout) :: list(:)   !< in the run's order; gets the interval
      real(wp), intent(in) :: way            !< the direction of the run: 1 or -1
      real(wp), intent(in) :: from, to       !< the ends of the interval, times in the run's order
      real(wp), intent(in) :: apart_by       !< time: intervals that are not farther apart are one
      type(uncovered_interval_t), allocatable :: joined(:)
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
      joined(n + 1) = uncovered_interval_t(way*low, way*high)
      joined(n + 2:) = list(size(list) - size(joined) + n + 2:)
      call move_alloc(joined, list)
   end subroutine add_interval

   !> Tells whether all of the motion is known, but for single instants.
   pure logical function is_covered(extremes)
      type(extremes_t), intent(in) :: extremes   !< of the run so far

      is_covered = .not. any(abs(extremes%gaps%to - extremes%gaps%from) > 0.0_wp)
   end function is_covered

   !> Tells whether the last instant repeats the first: all links of a mechanism have their first position, but for
   !> whole turns, and their first velocity.
   pure logical function is_cyclic(extremes, part)
      type(extremes_t), intent(in) :: extremes   !< after the last instant
      integer, intent(in) :: part            !< number of the mechanism

      is_cyclic = is_covered(extremes) .and. closes(extremes%tracks(part)%closure)
   end function is_cyclic

   !> Tells whether a number of a coordinate varies, if it is asked for: its least and its greatest value differ by more
   !> than rounding, or one of them is not known.
   pure logical function varies(coordinate, k)
      type(coordinate_t), intent(in) :: coordinate   !< after the last instant
      integer, intent(in) :: k               !< which derivative of the coordinate, 0 to 2

      associate (e => coordinate%found(:, k))
         varies = coordinate%sought(k) .and. (.not. all(e%exists .and. e%has_bound) &
            .or. e(greatest)%value - e(least)%value > unseen_part(k)*coordinate%size_of(k) + above_errors*sum(e%error))
      end associate
   end function varies

   !> Finds the strokes of a coordinate after the last instant: the shortest part of a cyclic run after which its
   !> reversals repeat is its period. If the motion is not cyclic, there are no reversals and no times.
   pure type(strokes_t) function strokes_of(extremes, coordinate) result(strokes)
      type(extremes_t), intent(in) :: extremes   !< of the set
      type(coordinate_t), intent(in) :: coordinate   !< one of the set
      type(value_at_t), allocatable :: all_of(:)
      real(wp), allocatable :: change(:)
      real(wp) :: period, phase
      integer :: n, in_period

      associate (e => coordinate%found(:, 0))
         strokes%length = extreme_t(value=e(greatest)%value - e(least)%value, error=sum(e%error), &
            exists=all(e%exists .and. e%has_bound) .and. varies(coordinate, 0))
         all_of = coordinate%reversals
         if (coordinate%first_sign /= coordinate%last_sign) all_of = [coordinate%start, all_of]
         n = size(all_of)
         strokes%in_run = n
         strokes%reversals = all_of(:0)
         if (n == 0 .or. .not. is_cyclic(extremes, coordinate%part)) return

         do in_period = 2, n, 2
            if (mod(n, in_period) /= 0) cycle
            period = extremes%run*in_period/n
            change = all_of(in_period + 1:)%value - all_of(:n - in_period)%value
            if (coordinate%is_angle) change = wrap_angle(change)
            if (all(abs(change) <= closes_to*coordinate%size_of(0)) .and. all(abs(all_of(in_period + 1:)%t &
               - all_of(:n - in_period)%t - period) <= closes_to*abs(extremes%run))) exit
         end do

         if (in_period > n) return
         strokes%reversals = all_of(:in_period)
         if (in_period > 2) return
         phase = modulo((e(greatest)%t - e(least)%t)/period, 1.0_wp)
         strokes%times = abs(period)*[phase, 1.0_wp - phase]
         if (minval(strokes%times) <= 0.0_wp) return
         strokes%ratio = maxval(strokes%times)/minval(strokes%times)
         strokes%error = sum(e%t_error)*abs(period)/minval(strokes%times)**2
      end associate
   end function strokes_of
end module extremes
