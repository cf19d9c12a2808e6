!> How extremes are found, instant by instant. The instants, and the joints of the drives' laws, are nodes, between
!> which `column_search` searches.
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
   use extremes, only: extremes_t, offer_limits, note_gap, step_of
   use column_search, only: add_node
   implicit none
   private
   public :: note_instant

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
end module extreme_search
