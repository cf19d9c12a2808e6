!> The motion of every link at one instant: solvers fill it, and writers print it. In addition to numbers it has
!> diagnostics as data, whose words are in results/.
module motion
   use kinds, only: wp
   implicit none
   private :: wp

   !> The kinds of diagnostics, each with the components of `diagnostic_t` that it uses.
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
      enumerator :: diagnostic_close            !< at `t` the motion is blocked, and no limit is reported
      enumerator :: diagnostic_beyond           !< the instant lies beyond the limit of motion at `t`, reported before
      enumerator :: diagnostic_begins           !< a motion begins, and positions before do not say in which assembly
      enumerator :: diagnostic_surplus          !< one of the drives with the numbers `links` is too many
      enumerator :: diagnostic_turned           !< up to `t` LINE number `measure` has turned by `value` in one step
      enumerator :: diagnostic_stroke           !< the cylinder `pair` has the length `value`, outside its stroke
      enumerator :: diagnostic_singular         !< the position of `links` is singular: its flag's sentence names them
   end enum

   !> Links that a diagnostic can name: nobody reads more. All others are only counted.
   integer, parameter :: max_links = 6

   !> One diagnostic. Lengths are in the deck's unit, angles in radians; 0 stands for no pair, drive or link.
   type :: diagnostic_t
      integer :: kind = 0                      !< diagnostic_inconsistent, ...
      integer :: part = 1                      !< the independent mechanism whose numbers it uses
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

   !> The reasons why an instant, or a link, is flagged.
   enum, bind(c)
      enumerator :: flag_none = 0
      enumerator :: flag_not_converged  !< no position was found
      enumerator :: flag_singular       !< position found, Jacobian singular: no unique velocities
      enumerator :: flag_overflow       !< a result is beyond the range of the real kind
      enumerator :: flag_inconsistent   !< redundant equations contradict one another
      enumerator :: flag_stroke         !< all is known, and a cylinder is outside its stroke
   end enum

   !> The kinds of positions with a singular Jacobian, the worst last.
   enum, bind(c)
      enumerator :: singular_unclear = 0 !< neither a change point nor a dead point, or undecided
      enumerator :: singular_change      !< a change point: velocities exist and are not unique
      enumerator :: singular_dead        !< a dead point: no finite velocities exist
   end enum

   !> The value of a measure that continues, at the last instant at which the measure has a value.
   type :: turned_t
      real(wp) :: angle = 0.0_wp                         !< rad
      logical :: is_known = .false.                      !< the measure had a value at some instant
      logical :: is_latest = .false.                     !< the measure had a value at the last instant
   end type turned_t

   !> The motion at a position in which only one drive has a rate, 1, and no drive has an acceleration.
   type :: unit_motion_t
      real(wp), allocatable :: velocity(:, :), acceleration(:, :)   !< (3, links) as of `motion_t`
      logical, allocatable :: is_known(:)                !< (links) the motion of the link exists
   end type unit_motion_t

   !> The motion of all links at an instant. Lengths and times are in the deck's units, angles in rad.
   type :: motion_t
      real(wp) :: t = 0.0_wp                             !< the instant
      integer :: flag = flag_none                        !< why the instant is flagged
      integer :: singularity = singular_unclear          !< of flag_singular: one of singular_...
      type(diagnostic_t) :: singular_links               !< of flag_singular: the links, if they are known
      integer :: known = -1  !< -1: nothing exists, 0: positions, 1: velocities too, 2: accelerations too
      type(diagnostic_t), allocatable :: diagnostics(:)  !< none: not allocated
      logical :: rests = .false.   !< the position is singular, and all drives rest: nothing moves, to any rounding
      real(wp) :: origin(2) = 0.0_wp                     !< x, y from which `position` is counted (length)
      !> (3, links): x, y, phi, and their first and second derivatives with respect to time.
      real(wp), allocatable :: position(:, :), velocity(:, :), acceleration(:, :)
      !> (links) `known` and `flag` of each link, if links differ: `known` and `flag` of the motion are then the worst
      !> of all. Not allocated: no link differs from the motion.
      integer, allocatable :: link_known(:), link_flag(:)
      !> (measures) The values from which measures that continue go on; not allocated: no measure continues, or there
      !> was no instant yet.
      type(turned_t), allocatable :: turned(:)
      !> (drives) The motions by drives for which ratios are requested; not allocated: none is known.
      type(unit_motion_t), allocatable :: by(:)
   end type motion_t

contains

   !> Makes a motion with nothing known, and all links at rest at the origin.
   pure function new_motion(n) result(m)
      integer, intent(in) :: n               !< number of links
      type(motion_t) :: m

      allocate (m%position(3, n), m%velocity(3, n), m%acceleration(3, n), source=0.0_wp)
   end function new_motion

   !> Gives how much of the motion of a link exists: -1 nothing, 0 its position, 1 its velocity too, 2 its acceleration
   !> too.
   pure integer function known_of(q, link)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: link            !< number of the link

      known_of = q%known
      if (allocated(q%link_known)) known_of = q%link_known(link)
   end function known_of

   !> Gives all links the `known` and the `flag` of the motion.
   pure subroutine forget_links(q)
      type(motion_t), intent(inout) :: q

      if (allocated(q%link_known)) deallocate (q%link_known)
      if (allocated(q%link_flag)) deallocate (q%link_flag)
   end subroutine forget_links

   !> Makes a diagnostic about links. Links for which the diagnostic has no room are only counted.
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

   !> Adds diagnostics to a motion. Its list stays unallocated if there are none.
   pure subroutine add_diagnostics(list, found)
      type(diagnostic_t), intent(in) :: list(:)            !< (any number) the diagnostics to be added
      type(motion_t), intent(inout) :: found !< the motion

      if (size(list) == 0) return
      if (.not. allocated(found%diagnostics)) allocate (found%diagnostics(0))
      found%diagnostics = [found%diagnostics, list]
   end subroutine add_diagnostics
end module motion
