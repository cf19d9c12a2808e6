!> How extremes are found, instant by instant.
!>
!> The instants, and the joints of the drives' laws, are nodes. Between two of them a coordinate has an extreme where
!> its velocity is zero, a velocity where its acceleration is, and an acceleration where its five-point difference is.
!> Each zero lies between two times at which that derivative has opposite signs, and is found there by motions at times
!> between the instants. An acceleration is searched where the middle of three nodes is the largest or the least; if it
!> has another sign there, its two zeros are searched for, and likewise those of the velocity. So none is missed
!> of an acceleration that has at most one extreme in any two consecutive steps.
!>
!> A step is divided where not all of the motion exists: at change points and at a limit of the motion, and it has such
!> an end at an instant without all of its motion. Each piece has nodes up to beside that place, and the one-sided
!> limits there may be extremes.
module extreme_search
   use kinds, only: wp
   use mechanism, only: mechanism_t, instant
   use motion, only: motion_t, singular_change
   use diagnostics, only: diagnostic_change, diagnostic_limit
   use points, only: coordinates_of
   use set_analysis, only: set_analysis_t
   use nodes, only: node_t, node_at, times_between, limits_of, places, places_beside
   use zero_search, only: sample_t, column_t, find_zero, differ_in_sign
   use extremes, only: extremes_t, offer, offer_limits, count_turn, note_gap, alike, &
      noise_part, step_of
   implicit none
   private
   public :: note_instant

   !> The step of the five-point difference, whose error goes with its fourth power, in steps of TIME; and how much
   !> longer it may be in short steps, in rad or lengths.
   real(wp), parameter :: difference_part = 1.0_wp/256.0_wp, difference_angle = 1.0e-3_wp, max_part = 1.0_wp/8.0_wp

   !> An end of a piece of a step: whether not all of the motion exists there, and whether it is a change point.
   type :: end_t
      real(wp) :: t = 0.0_wp
      logical :: is_open = .false., is_change = .false.
   end type end_t

contains

   !> Takes instant number `k` of `m`, to which `s` has advanced. Only the instants of TIME count.
   subroutine note_instant(x, m, s, k)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: k
      type(node_t) :: now
      integer :: c

      if (k > m%steps) return
      do c = 1, size(x%tracks)
         associate (track => x%tracks(c))
            if (size(track%rows) == 0) cycle
            now = node_at(x%asked, s, c, s%now%motions(c)%t, .false.)
            if (k == 0) then
               track%first = now
            else
               call search_step(x, m, s, c, k, now)
            end if
            call add_node(x, m, s, c, now)
            track%instant = now
            track%at_change = s%now%motions(c)%singularity == singular_change
            if (any(now%known(track%rows) < 2)) call note_gap(x, now%t, now%t)
         end associate
      end do
   end subroutine note_instant

   !> Searches between the last instant of mechanism `c` and instant number `k`, `now`.
   subroutine search_step(x, m, s, c, k, now)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c, k
      type(node_t), intent(in) :: now
      real(wp), allocatable :: ends(:)
      real(wp) :: from
      logical :: is_open, is_change, is_limit, to_open, to_change
      integer :: i

      associate (track => x%tracks(c), t1 => x%tracks(c)%instant%t)
         call find_ends(s%now%motions(c), t1, x%way, ends, is_limit)
         if (s%now%motions(c)%known >= 0) ends = [ends, now%t]
         if (any(track%instant%known(track%rows) < 0)) ends = [real(wp) ::]
         from = t1
         is_open = any(track%instant%known(track%rows) < 2)
         is_change = track%at_change
         do i = 1, size(ends)
            to_open = i < size(ends) .or. is_limit .or. any(now%known(track%rows) < 2)
            to_change = i < size(ends) .or. (s%now%motions(c)%singularity == singular_change .and. .not. is_limit)
            call search_piece(x, m, s, c, times_between(track%joints, m, k), end_t(from, is_open, is_change), &
               end_t(ends(i), to_open, to_change))
            is_open = .true.
            is_change = .true.
            from = ends(i)
            if (i < size(ends)) track%last = [node_t ::]
         end do
         if (abs(now%t - from) > 0.0_wp) call note_gap(x, from, now%t)
      end associate
   end subroutine search_step

   !> The times after `from` at which the motion `q` says that a change point was passed, or its limit was reached: that
   !> is the last.
   pure subroutine find_ends(q, from, way, ends, is_limit)
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: from, way
      real(wp), allocatable, intent(out) :: ends(:)
      logical, intent(out) :: is_limit
      real(wp) :: last
      integer :: i

      allocate (ends(0))
      is_limit = .false.
      if (.not. allocated(q%diagnostics)) return
      last = from
      do i = 1, size(q%diagnostics)
         associate (d => q%diagnostics(i))
            if (d%kind /= diagnostic_limit .and. .not. (d%kind == diagnostic_change .and. .not. d%here)) cycle
            if ((d%t - last)*way <= 0.0_wp .or. (q%t - d%t)*way <= 0.0_wp) cycle
            ends = [ends, d%t]
            last = d%t
            is_limit = d%kind == diagnostic_limit
         end associate
      end do
   end subroutine find_ends

   !> Searches between the ends `from` and `to`, with nodes at those of the `times` that are between.
   subroutine search_piece(x, m, s, c, times, from, to)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      real(wp), intent(in) :: times(:)
      type(end_t), intent(in) :: from, to
      real(wp) :: low, high, beside(places)
      integer :: i

      low = from%t
      high = to%t
      if (from%is_open) then
         beside = places_beside(from%t, to%t, step_of(m), from%is_change)
         low = beside(places)
         call take_limits(x, m, s, c, from, beside)
         call look_at(x, m, s, c, beside(1), .true.)
         call look_at(x, m, s, c, low, .true.)
      end if
      beside = places_beside(to%t, from%t, step_of(m), to%is_change)
      if (to%is_open) high = beside(places)
      do i = 1, size(times)
         if ((times(i) - low)*x%way > 0.0_wp .and. (high - times(i))*x%way > 0.0_wp) &
            call look_at(x, m, s, c, times(i), .false.)
      end do
      if (.not. to%is_open) return
      call take_limits(x, m, s, c, to, beside)
      call look_at(x, m, s, c, high, .true.)
      call look_at(x, m, s, c, beside(1), .true.)
   end subroutine search_piece

   !> The one-sided limits at the end `at` of a piece, by the motion at the times `beside`, may be extremes.
   subroutine take_limits(x, m, s, c, at, beside)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(end_t), intent(in) :: at
      real(wp), intent(in) :: beside(places)
      type(node_t) :: near(places)
      integer :: i

      do i = 1, places
         near(i) = node_at(x%asked, s, c, beside(i), .true.)
         if (any(near(i)%known(x%tracks(c)%rows) < 2)) return
      end do
      do i = 1, size(x%tracks(c)%rows)
         associate (q => x%tracks(c)%rows(i))
            call offer_limits(x, q, coordinates_of(m%requests(x%asked(q))%kind), at%t, limits_of(near, &
               at%is_change, x%size_of))
         end associate
      end do
   end subroutine take_limits

   !> Takes a node at the time `t`; `always`: see `node_at`.
   subroutine look_at(x, m, s, c, t, always)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      real(wp), intent(in) :: t
      logical, intent(in) :: always
      type(node_t) :: node

      node = node_at(x%asked, s, c, t, always)
      if (any(node%known(x%tracks(c)%rows) < 2)) then
         call note_gap(x, t, t)
      else
         call add_node(x, m, s, c, node)
      end if
   end subroutine look_at

   !> Takes `node` of mechanism `c`, and searches between it and the last two.
   subroutine add_node(x, m, s, c, node)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(node_t), intent(in) :: node
      integer :: i, j, k

      associate (track => x%tracks(c))
         do i = 1, size(track%rows)
            associate (q => track%rows(i))
               do j = 1, coordinates_of(m%requests(x%asked(q))%kind)
                  do k = 0, node%known(q)
                     call offer(x, m, q, j, k, sample_of(node, q, j), .false.)
                  end do
                  if (node%known(q) < 2) cycle
                  call count_turn(x, q, j, node%value(j, 1, q))
                  call search_column(x, m, s, q, j, [node_t :: node, track%last])
               end do
            end associate
         end do
         track%last = [node_t :: node, track%last(:min(size(track%last), 1))]
      end associate
   end subroutine add_node

   !> Searches for extremes of column `j` of row `q` between the first of the `nodes`, latest first, and the others.
   subroutine search_column(x, m, s, q, j, nodes)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q, j
      type(node_t), intent(in) :: nodes(:)
      type(sample_t) :: now, before, earlier
      type(column_t) :: column

      if (size(nodes) < 2) return
      before = sample_of(nodes(2), q, j)
      if (.not. before%exists) return
      now = sample_of(nodes(1), q, j)
      column = column_t(x%asked(q), j, noise=[max(noise_part*x%size_of(j, :, q), now%error, before%error), 0.0_wp])
      call search_velocity(x, m, s, q, column, before, now)
      if (size(nodes) < 3) return
      earlier = sample_of(nodes(3), q, j)
      if (earlier%exists) call search_acceleration(x, m, s, q, column, earlier, before, now)
   end subroutine search_column

   !> Column `c` of row `q` of `node`.
   pure type(sample_t) function sample_of(node, q, c) result(sample)
      type(node_t), intent(in) :: node
      integer, intent(in) :: q, c

      sample = sample_t(node%t, node%value(c, :, q), node%error(c, :, q), node%known(q) == 2)
   end function sample_of

   !> Extremes of the coordinate between `a` and `b`, whose accelerations have one sign.
   subroutine search_coordinate(x, m, s, q, column, a, b)
      type(extremes_t), intent(inout) :: x
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: q
      type(column_t), intent(in) :: column
      type(sample_t), intent(in) :: a, b
      type(sample_t) :: zero

      if (.not. changes_sign(column, 1, a, b)) return
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

      if (changes_sign(column, 2, a, b)) call find_zero(s, column, 2, 0.0_wp, a, b, zero)
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

      associate (up => b%f(2) - a%f(2), down => b%f(2) - d%f(2), &
                 open => alike*x%size_of(column%column, 2, q) + max(a%error(2), b%error(2), d%error(2)))
         ! Beside an extreme halfway between two instants both have the same value.
         if (max(abs(up), abs(down)) <= open) return
         if (differ_in_sign(up, down) .and. min(abs(up), abs(down)) > open) return
      end associate
      c = column
      c%step = difference_step(x, step_of(m), q, c%column, min(abs(b%t - a%t), abs(d%t - b%t)))
      if (c%step <= 0.0_wp) return
      c%noise(3) = c%noise(2)/c%step
      from = sample_t(t=a%t + 2.0_wp*x%way*c%step, error=max(a%error, b%error, d%error))
      to = sample_t(t=d%t - 2.0_wp*x%way*c%step)
      call find_zero(s, c, 3, 0.0_wp, from, to, zero)
      if (.not. zero%exists) return
      call offer(x, m, q, c%column, 2, zero, .true.)
      from = merge(b, a, (zero%t - b%t)*x%way > 0.0_wp)
      to = merge(d, b, (zero%t - b%t)*x%way > 0.0_wp)
      if (.not. (changes_sign(c, 2, from, zero) .and. changes_sign(c, 2, zero, to))) return
      call search_velocity(x, m, s, q, c, from, zero)
      call search_velocity(x, m, s, q, c, zero, to)
   end subroutine search_acceleration

   !> The step of the difference for column `c` of row `q`, nodes being `apart` and instants a `step` of TIME.
   pure real(wp) function difference_step(x, step, q, c, apart)
      type(extremes_t), intent(in) :: x
      real(wp), intent(in) :: step, apart
      integer, intent(in) :: q, c

      difference_step = max(difference_part*step, difference_angle*x%size_of(c, 0, q)/x%size_of(c, 1, q))
      difference_step = min(difference_step, max_part*apart)
   end function difference_step

   !> Derivative number `k` (1, 2) of the column `c` changes its sign between `a` and `b`, by more than rounding.
   pure logical function changes_sign(c, k, a, b)
      type(column_t), intent(in) :: c
      integer, intent(in) :: k
      type(sample_t), intent(in) :: a, b

      changes_sign = differ_in_sign(a%f(k), b%f(k)) .and. min(abs(a%f(k)), abs(b%f(k))) > c%noise(k)
   end function changes_sign

end module extreme_search
