!> The motion of every link at one instant: what the solvers fill and the writers print.
module motion
   use kinds, only: wp
   use diagnostics, only: diagnostic_t
   implicit none
   private
   public :: motion_t, new_motion, known_of, mark_of, forget_links
   public :: mark_none, mark_not_converged, mark_singular, mark_overflow, mark_inconsistent
   public :: singular_unclear, singular_change, singular_dead

   !> Why an instant, or a link, is flagged.
   enum, bind(c)
      enumerator :: mark_none = 0
      enumerator :: mark_not_converged  !< no position was found
      enumerator :: mark_singular       !< position found, Jacobian singular: no unique velocities
      enumerator :: mark_overflow       !< a result is beyond the range of the real kind
      enumerator :: mark_inconsistent   !< redundant equations contradict one another
   end enum

   !> What a position with a singular Jacobian is, the worst last.
   enum, bind(c)
      enumerator :: singular_unclear = 0 !< neither of those below, or they cannot be told apart
      enumerator :: singular_change      !< a change point: velocities exist and are not unique
      enumerator :: singular_dead        !< a dead point: no finite velocities exist
   end enum

   !> Lengths and times are in the deck's units, angles in radians.
   type :: motion_t
      real(wp) :: t = 0.0_wp                             !< the instant
      integer :: mark = mark_none                        !< why it is flagged
      integer :: singularity = singular_unclear          !< of mark_singular: one of singular_...
      type(diagnostic_t) :: singular_links               !< and its links, where they are known
      integer :: known = -1  !< what exists: -1 nothing, 0 positions, 1 velocities too, 2 accelerations too
      type(diagnostic_t), allocatable :: diagnostics(:)  !< none: not allocated
      real(wp) :: origin(2) = 0.0_wp                     !< the place from which x and y of `position` are counted
      !> (3, links): x, y, phi, and their first and second derivatives with respect to time.
      real(wp), allocatable :: position(:, :), velocity(:, :), acceleration(:, :)
      !> (links) `known` and `mark` of each link, if they differ: those of the whole are then the worst. Not allocated:
      !> all links as the whole.
      integer, allocatable :: link_known(:), link_mark(:)
   end type motion_t

contains

   !> The motion of `n` links at rest at the origin.
   pure function new_motion(n) result(m)
      integer, intent(in) :: n
      type(motion_t) :: m

      allocate (m%position(3, n), m%velocity(3, n), m%acceleration(3, n), source=0.0_wp)
   end function new_motion

   !> How much of the motion of `link` exists, in the values of `known`.
   pure integer function known_of(m, link)
      type(motion_t), intent(in) :: m
      integer, intent(in) :: link

      known_of = m%known
      if (allocated(m%link_known)) known_of = m%link_known(link)
   end function known_of

   !> Why the rest of it does not exist; mark_none where all of it exists.
   pure integer function mark_of(m, link)
      type(motion_t), intent(in) :: m
      integer, intent(in) :: link

      mark_of = m%mark
      if (allocated(m%link_mark)) mark_of = m%link_mark(link)
   end function mark_of

   !> Gives all links the `known` and `mark` of the whole.
   pure subroutine forget_links(m)
      type(motion_t), intent(inout) :: m

      if (allocated(m%link_known)) deallocate (m%link_known)
      if (allocated(m%link_mark)) deallocate (m%link_mark)
   end subroutine forget_links
end module motion
