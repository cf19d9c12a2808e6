!> Card EXTREMES: the least and the greatest value of each coordinate, velocity and acceleration of a row, over the
!> instants of TIME and between them; and the times of the forward and the return stroke of a cyclic motion.
!>
!> The instants, and the joints of the drives' laws, are nodes. Between two of them a coordinate has an extreme where
!> its velocity is zero, a velocity where its acceleration is, and an acceleration where its five-point difference is.
!> Each zero lies between two times at which that derivative has opposite signs, and is found there by motions at times
!> between the instants. An acceleration is searched where the middle of three nodes is the largest or the least; if it
!> has another sign there, its two zeros are searched for, and likewise those of the velocity. So none is missed
!> of an acceleration that has at most one extreme in any two consecutive steps.
module extremes
   use kinds, only: wp
   use constants, only: without_turns
   use mechanism, only: mechanism_t, request_t, request_link, request_pair, pair_prismatic, instant
   use scales, only: characteristic_length, characteristic_rate, is_length
   use drives, only: new_law, drive_motion, joints_of
   use points, only: is_fixed, coordinates_of
   use set_analysis, only: set_analysis_t
   use nodes, only: node_t, node_of_instant, node_at, times_between
   use zero_search, only: sample_t, column_t, find_zero, differ_in_sign
   implicit none
   private
   public :: extremes_t, extreme_t, least, greatest, new_extremes, note_instant, stroke_times, is_cyclic, &
      is_angle

   !> Values that differ by less, in characteristic lengths or rad and rates, are alike: the earlier one counts. A
   !> derivative below the second is a zero that rounding has moved.
   real(wp), parameter :: alike = 1.0e4_wp*epsilon(1.0_wp), is_zero = 64.0_wp*epsilon(1.0_wp)
   !> A motion is cyclic if its end differs from its beginning by less, in the same units.
   real(wp), parameter :: closes_to = max(1.0e-9_wp, 1.0e5_wp*epsilon(1.0_wp))
   !> The step of the five-point difference, whose error goes with its fourth power, in steps of TIME.
   real(wp), parameter :: difference_part = 1.0_wp/256.0_wp
   !> The first index of the extremes.
   integer, parameter :: least = 1, greatest = 2

   !> In the deck's units and rad.
   type :: extreme_t
      logical :: exists = .false.
      logical :: is_located = .false.                  !< at a zero of a derivative, not at a node
      real(wp) :: t = 0.0_wp, value = 0.0_wp
   end type extreme_t

   type :: extremes_t
      integer, allocatable :: asked(:)                 !< the requests of the set for extremes, but those of the ground
      real(wp), allocatable :: size_of(:, :, :)        !< (3, 0:2, asked) characteristic value of each number
      real(wp), allocatable :: joints(:)               !< times inside the run at which a law is not smooth
      type(extreme_t), allocatable :: found(:, :, :, :) !< (least:greatest, 3, 0:2, asked)
      integer, allocatable :: turns(:, :)              !< (3, asked) changes of sign of the velocity
      integer, allocatable :: first_sign(:, :), last_sign(:, :) !< (3, asked) of the velocity: the first, the latest
      type(node_t) :: first                            !< node of the run
      type(node_t), allocatable :: last(:)             !< the last two nodes, latest first
      integer :: unsolved = 0                          !< instants at which not all is known
      logical :: was_whole = .false.                   !< all was known at the last instant
   end type extremes_t

contains

   !> Ready for the first instant of `m`; `s`: its analysis, for the independent mechanisms of `m`.
   subroutine new_extremes(m, s, x)
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(extremes_t), intent(out) :: x
      integer :: i, q, n

      x%asked = pack([(i, i=1, size(m%requests))], m%requests%extremes .and. .not. [(is_fixed(m, m%requests(i)), i=1, &
         size(m%requests))])
      n = size(x%asked)
      allocate (x%size_of(3, 0:2, n), x%found(least:greatest, 3, 0:2, n), x%last(0), x%joints(0))
      allocate (x%turns(3, n), x%first_sign(3, n), x%last_sign(3, n), source=0)
      do q = 1, n
         associate (own => s%now%own(s%now%parts%part(x%asked(q))))
            x%size_of(:, :, q) = sizes_of(own, m, m%requests(x%asked(q)))
         end associate
      end do
      do i = 1, size(m%drives)
         x%joints = [x%joints, joints_of(m%drives(i))]
      end do
   end subroutine new_extremes

   !> The characteristic values (3, 0:2) of the columns of `request` of the set `m`, which is in the mechanism `own`.
   pure function sizes_of(own, m, request) result(size_of)
      type(mechanism_t), intent(in) :: own, m
      type(request_t), intent(in) :: request
      real(wp) :: size_of(3, 0:2), length, rate
      integer :: c, k

      length = characteristic_length(own)
      rate = characteristic_rate(own, length)
      do k = 0, 2
         do c = 1, 3
            size_of(c, k) = merge(1.0_wp, length, is_angle(m, request, c))*rate**k
         end do
      end do
   end function sizes_of

   !> Column `c` of `request` holds angles.
   pure logical function is_angle(m, request, c)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      integer, intent(in) :: c

      is_angle = request%kind == request_link .and. c == 3
      if (request%kind == request_pair) is_angle = m%pairs(request%subject)%kind /= pair_prismatic
   end function is_angle

   !> Takes instant number `k` of `m`, to which `s` has advanced. Only the instants of TIME count.
   subroutine note_instant(x, m, s, k)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: k
      type(node_t) :: now
      real(wp), allocatable :: times(:)
      integer :: i

      if (k > m%steps) return
      now = node_of_instant(x%asked, s)
      if (any(now%known < 2)) x%unsolved = x%unsolved + 1
      if (k > 0 .and. all(now%known == 2) .and. x%was_whole) then
         times = times_between(x%joints, m, k)
         do i = 1, size(times)
            call add_node(x, m, s, node_at(x%asked, s, times(i)))
         end do
      end if
      call add_node(x, m, s, now)
      x%was_whole = all(now%known == 2)
   end subroutine note_instant

   !> Takes `node`, and searches between it and the last two.
   subroutine add_node(x, m, s, node)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      type(node_t), intent(in) :: node
      type(sample_t) :: now, before, earlier
      type(column_t) :: column
      integer :: q, c, k

      if (size(x%last) == 0) x%first = node
      do q = 1, size(x%asked)
         do c = 1, coordinates_of(m%requests(x%asked(q))%kind)
            do k = 0, node%known(q)
               call offer(x, m, q, c, k, sample_of(node, q, c), .false.)
            end do
            if (node%known(q) < 2) cycle
            call count_turn(x, q, c, node%value(c, 1, q))
            column = column_t(x%asked(q), c)
            now = sample_of(node, q, c)
            if (size(x%last) < 1) cycle
            before = sample_of(x%last(1), q, c)
            if (.not. before%exists) cycle
            call search_velocity(x, m, s, q, column, before, now)
            if (size(x%last) < 2) cycle
            earlier = sample_of(x%last(2), q, c)
            if (earlier%exists) call search_acceleration(x, m, s, q, column, earlier, before, now)
         end do
      end do
      x%last = [node, x%last(:min(size(x%last), 1))]
   end subroutine add_node

   !> Column `c` of row `q` of `node`.
   pure type(sample_t) function sample_of(node, q, c) result(sample)
      type(node_t), intent(in) :: node
      integer, intent(in) :: q, c

      sample = sample_t(node%t, node%value(c, :, q), node%known(q) == 2)
   end function sample_of

   !> Counts a change of sign of the velocity `v`.
   pure subroutine count_turn(x, q, c, v)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: q, c
      real(wp), intent(in) :: v
      integer :: this

      if (abs(v) <= is_zero*x%size_of(c, 1, q)) return
      this = merge(1, -1, v > 0.0_wp)
      if (x%first_sign(c, q) == 0) x%first_sign(c, q) = this
      if (x%last_sign(c, q) == -this) x%turns(c, q) = x%turns(c, q) + 1
      x%last_sign(c, q) = this
   end subroutine count_turn

   !> Number `k` of `sample` may be the least or the greatest. A value `at_zero` of the next derivative has its time
   !> from that, and replaces a node's beside it.
   pure subroutine offer(x, m, q, c, k, sample, at_zero)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: q, c, k
      type(sample_t), intent(in) :: sample
      logical, intent(in) :: at_zero
      real(wp) :: gain
      integer :: which
      logical :: better

      do which = least, greatest
         associate (e => x%found(which, c, k, q))
            gain = (sample%f(k) - e%value)*merge(-1.0_wp, 1.0_wp, which == least)
            better = .not. e%exists .or. gain > alike*x%size_of(c, k, q)
            if (at_zero .and. .not. (better .or. e%is_located)) better = gain >= -alike*x%size_of(c, k, q) &
               .and. abs(sample%t - e%t) <= step_of(m)
            if (better) e = extreme_t(.true., at_zero, sample%t, sample%f(k))
         end associate
      end do
   end subroutine offer

   !> A step of the TIME card.
   pure real(wp) function step_of(m)
      type(mechanism_t), intent(in) :: m

      step_of = abs(m%t1 - m%t0)/real(m%steps, wp)
   end function step_of

   !> Extremes of the coordinate between `a` and `b`, whose accelerations have one sign.
   subroutine search_coordinate(x, m, s, q, column, a, b)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b
      type(sample_t) :: zero

      if (.not. changes_sign(x, q, column%column, 1, a, b)) return
      call find_zero(s, column, 1, 0.0_wp, a, b, zero)
      if (zero%exists) call offer(x, m, q, column%column, 0, zero, .true.)
   end subroutine search_coordinate

   !> Extremes of the velocity between `a` and `b`, and of the coordinate on either side of them.
   subroutine search_velocity(x, m, s, q, column, a, b)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b
      type(sample_t) :: zero

      if (changes_sign(x, q, column%column, 2, a, b)) call find_zero(s, column, 2, 0.0_wp, a, b, zero)
      if (zero%exists) then
         call offer(x, m, q, column%column, 1, zero, .true.)
         call search_coordinate(x, m, s, q, column, a, zero)
         call search_coordinate(x, m, s, q, column, zero, b)
      else
         call search_coordinate(x, m, s, q, column, a, b)
      end if
   end subroutine search_velocity

   !> An extreme of the acceleration between `a` and `d`, if it is the largest or least at `b`; where it has another
   !> sign there, the extremes of the velocity on either side of it.
   subroutine search_acceleration(x, m, s, q, column, a, b, d)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b, d
      type(column_t) :: c
      type(sample_t) :: zero, from, to
      real(wp) :: way

      associate (up => (b%f(2) - a%f(2))/x%size_of(column%column, 2, q), &
                 down => (b%f(2) - d%f(2))/x%size_of(column%column, 2, q))
         ! Beside an extreme halfway between two instants both have the same value.
         if (max(abs(up), abs(down)) <= alike) return
         if (differ_in_sign(up, down) .and. min(abs(up), abs(down)) > alike) return
      end associate
      c = column
      way = sign(1.0_wp, d%t - a%t)
      c%step = difference_part*min(step_of(m), 32.0_wp*abs(b%t - a%t), 32.0_wp*abs(d%t - b%t))
      from = sample_t(t=a%t + 2.0_wp*way*c%step)
      to = sample_t(t=d%t - 2.0_wp*way*c%step)
      call find_zero(s, c, 3, 0.0_wp, from, to, zero)
      if (.not. zero%exists) return
      call offer(x, m, q, c%column, 2, zero, .true.)
      from = merge(b, a, (zero%t - b%t)*way > 0.0_wp)
      to = merge(d, b, (zero%t - b%t)*way > 0.0_wp)
      if (.not. (changes_sign(x, q, c%column, 2, from, zero) .and. changes_sign(x, q, c%column, 2, zero, to))) return
      call search_velocity(x, m, s, q, c, from, zero)
      call search_velocity(x, m, s, q, c, zero, to)
   end subroutine search_acceleration

   !> Derivative number `k` (1, 2) changes its sign between `a` and `b`, by more than rounding.
   pure logical function changes_sign(x, q, c, k, a, b)
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q, c, k
      type(sample_t), intent(in) :: a, b

      changes_sign = differ_in_sign(a%f(k), b%f(k)) &
         .and. min(abs(a%f(k)), abs(b%f(k))) > is_zero*x%size_of(c, k, q)
   end function changes_sign

   !> Times from the least to the greatest value of column `c` of row `q` and back, positive, after the last instant:
   !> of a cyclic motion that turns twice, whose run is one period. Otherwise 0.
   function stroke_times(x, m, own, q, c) result(times)
      type(extremes_t), intent(in) :: x
      type(mechanism_t), intent(in) :: m, own
      integer, intent(in) :: q, c
      real(wp) :: times(2), period, phase

      times = 0.0_wp
      if (x%turns(c, q) + merge(1, 0, x%first_sign(c, q) /= x%last_sign(c, q)) /= 2) return
      if (.not. is_cyclic(x, m, own, q)) return
      period = m%t1 - m%t0
      phase = modulo((x%found(greatest, c, 0, q)%t - x%found(least, c, 0, q)%t)/period, 1.0_wp)
      times = abs(period)*[phase, 1.0_wp - phase]
   end function stroke_times

   !> After the last instant: row `q`, which is in the mechanism `own` of the set `m`, and its drives are as at the
   !> first.
   logical function is_cyclic(x, m, own, q)
      type(extremes_t), intent(in) :: x
      type(mechanism_t), intent(in) :: m, own
      integer, intent(in) :: q

      is_cyclic = x%unsolved == 0 .and. size(x%last) > 0
      if (is_cyclic) is_cyclic = closes(x, m, q) .and. drives_close(own)
   end function is_cyclic

   !> The positions and velocities of row `q` at the end of the run are those at its beginning, but for whole turns.
   pure logical function closes(x, m, q)
      type(extremes_t), intent(in) :: x
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: q
      real(wp) :: d(0:1)
      integer :: c

      closes = .true.
      do c = 1, coordinates_of(m%requests(x%asked(q))%kind)
         d = x%last(1)%value(c, :1, q) - x%first%value(c, :1, q)
         if (is_angle(m, m%requests(x%asked(q)), c)) d(0) = without_turns(d(0))
         closes = closes .and. all(abs(d) <= closes_to*x%size_of(c, :1, q))
      end do
   end function closes

   !> So are all drives of `m`, with their accelerations.
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
