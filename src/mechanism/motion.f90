!> The motion of every link at one instant: the solvers fill it and the writers print it. In addition to its numbers it
!> has diagnostics as data: results/ has their words.
module motion
   use kinds, only: wp
   implicit none
   private :: wp

   !> The kinds of diagnostics, and the components that each uses.
   enum, bind(c)
      enumerator :: diagnostic_inconsistent = 1 !< an equation of `pair` or `drive` has the closure error `value`
      !> At `t`, where `drive` is `value`, the motion of `links` has its limit, or the cylinder `pair` its length 0;
      !> `other`: the end of its stroke.
      enumerator :: diagnostic_limit
      enumerator :: diagnostic_far_estimate     !< the estimated angle of links(1) was off by `value`
      enumerator :: diagnostic_second           !< another assembly of `links` is about as near
      enumerator :: diagnostic_incomplete       !< a nearer assembly of `links` may exist
      enumerator :: diagnostic_redundant        !< `equations` equations of `pair` or `drive` are redundant
      enumerator :: diagnostic_mobile           !< `links` can move although no drive does
      enumerator :: diagnostic_change           !< at `t` two branches cross; `other`: `links` took the other one
      enumerator :: diagnostic_long             !< the step from `t` would need too many substeps
      enumerator :: diagnostic_unused           !< no change point was passed after `t`, as a BRANCH card asks
      enumerator :: diagnostic_dead_end         !< the other branch of `links` at `t` was not found
      enumerator :: diagnostic_method           !< another method finds a position
      enumerator :: diagnostic_close            !< at `t` the motion is blocked, and no limit is told
      enumerator :: diagnostic_beyond           !< the instant lies beyond the limit of motion at `t`, told before
      enumerator :: diagnostic_begins           !< a motion begins, and positions before do not say in which assembly
      enumerator :: diagnostic_surplus          !< a drive is too many, one of those with the numbers `links`
      enumerator :: diagnostic_turned           !< up to `t` LINE number `measure` has turned by `value` in one step
      enumerator :: diagnostic_stroke           !< the cylinder `pair` has the length `value`, out of its stroke
      enumerator :: diagnostic_singular         !< the position of `links` is singular: a part of its mark's sentence
   end enum

   !> Links that a diagnostic can name.
   integer, parameter :: max_links = 6

   !> One diagnostic. Lengths are in the deck's unit, angles in radians; 0 stands for no pair, drive or link.
   type :: diagnostic_t
      integer :: kind = 0                      !< diagnostic_inconsistent, ...
      integer :: part = 1                      !< the independent mechanism, in whose numbers it is
      integer :: pair = 0, drive = 0           !< numbers of a pair and a drive
      integer :: measure = 0                   !< the number of a measure
      integer :: links(max_links) = 0          !< the numbers of links
      integer :: more = 0                      !< links for which there is no room
      integer :: equations = 1                 !< diagnostic_redundant: number of equations
      logical :: in_line = .false.             !< diagnostic_limit, diagnostic_singular: the two links are in line
      logical :: other = .false.     !< diagnostic_change: on the other branch; diagnostic_method: at another assembly
      logical :: here = .false.                !< diagnostic_change: the instant is the change point
      logical :: returns = .false.   !< diagnostic_change, diagnostic_dead_end: back from a singular instant at `t`
      logical :: is_angle = .false.            !< `value` is an angle, not a length
      real(wp) :: value = 0.0_wp               !< closure error, angle or drive's value (length or rad)
      real(wp) :: t = 0.0_wp                   !< time, in the deck's unit
   end type diagnostic_t

   !> Why an instant, or a link, is flagged.
   enum, bind(c)
      enumerator :: flag_none = 0
      enumerator :: flag_not_converged  !< no position was found
      enumerator :: flag_singular       !< position found, Jacobian singular: no unique velocities
      enumerator :: flag_overflow       !< a result is beyond the range of the real kind
      enumerator :: flag_inconsistent   !< redundant equations contradict one another
      enumerator :: flag_stroke         !< all is known, and a cylinder is out of its stroke
   end enum

   !> The kinds of positions with a singular Jacobian, the worst last.
   enum, bind(c)
      enumerator :: singular_unclear = 0 !< neither of those below, or they cannot be told apart
      enumerator :: singular_change      !< a change point: velocities exist and are not unique
      enumerator :: singular_dead        !< a dead point: no finite velocities exist
   end enum

   !> The value of a measure that continues, at the last instant at which it has one.
   type :: turned_t
      real(wp) :: angle = 0.0_wp                         !< rad
      logical :: is_known = .false.                      !< there was such an instant
      logical :: is_latest = .false.                     !< it was the last one
   end type turned_t

   !> The motion at the same position in which one drive alone has a rate, of 1, and none has an acceleration.
   type :: unit_motion_t
      real(wp), allocatable :: velocity(:, :), acceleration(:, :)   !< (3, links) as of `motion_t`
      logical, allocatable :: is_known(:)                !< (links)
   end type unit_motion_t

   !> Lengths and times are in the deck's units, angles in radians.
   type :: motion_t
      real(wp) :: t = 0.0_wp                             !< the instant
      integer :: flag = flag_none                        !< why it is flagged
      integer :: singularity = singular_unclear          !< of flag_singular: one of singular_...
      type(diagnostic_t) :: singular_links               !< and its links, where they are known
      integer :: known = -1  !< what exists: -1 nothing, 0 positions, 1 velocities too, 2 accelerations too
      type(diagnostic_t), allocatable :: diagnostics(:)  !< none: not allocated
      logical :: rests = .false.   !< the position is singular, and all drives rest: nothing moves, to any rounding
      real(wp) :: origin(2) = 0.0_wp                     !< the place from which x and y of `position` are counted
      !> (3, links): x, y, phi, and their first and second derivatives with respect to time.
      real(wp), allocatable :: position(:, :), velocity(:, :), acceleration(:, :)
      !> (links) `known` and `mark` of each link, if they differ: those of the whole are then the worst. Not allocated:
      !> all links as the whole.
      integer, allocatable :: link_known(:), link_flag(:)
      !> (measures) From these values those that continue go on; not allocated: none does, or no instant is taken yet.
      type(turned_t), allocatable :: turned(:)
      !> (drives) Those by which ratios are asked for are allocated. Not allocated: none is known.
      type(unit_motion_t), allocatable :: by(:)
   end type motion_t

contains

   !> Makes the motion of links at rest at the origin.
   pure function new_motion(n) result(m)
      integer, intent(in) :: n               !< number of links
      type(motion_t) :: m

      allocate (m%position(3, n), m%velocity(3, n), m%acceleration(3, n), source=0.0_wp)
   end function new_motion

   !> Gives how much of the motion of a link exists, in the values of `known`.
   pure integer function known_of(q, link)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: link            !< number of the link

      known_of = q%known
      if (allocated(q%link_known)) known_of = q%link_known(link)
   end function known_of

   !> Gives all links the `known` and `mark` of the whole.
   pure subroutine forget_links(q)
      type(motion_t), intent(inout) :: q

      if (allocated(q%link_known)) deallocate (q%link_known)
      if (allocated(q%link_flag)) deallocate (q%link_flag)
   end subroutine forget_links

   !> Makes a diagnostic about links. Links for which it has no room are only counted.
   pure function new_diagnostic(kind, chosen) result(r)
      integer, intent(in) :: kind            !< diagnostic_inconsistent, ...
      logical, intent(in) :: chosen(:)       !< (links) the diagnostic is about this link
      type(diagnostic_t) :: r
      integer :: i, n

      r%kind = kind
      n = 0
      do i = 1, size(chosen)
         if (.not. chosen(i)) cycle
         n = n + 1
         if (n <= max_links) r%links(n) = i
      end do
      r%more = max(0, n - max_links)
   end function new_diagnostic

   !> Adds diagnostics to those of a motion, which are not allocated if there are none.
   pure subroutine add_diagnostics(list, found)
      type(diagnostic_t), intent(in) :: list(:)            !< (any number) those to be added
      type(motion_t), intent(inout) :: found

      if (size(list) == 0) return
      if (.not. allocated(found%diagnostics)) allocate (found%diagnostics(0))
      found%diagnostics = [found%diagnostics, list]
   end subroutine add_diagnostics
end module motion
