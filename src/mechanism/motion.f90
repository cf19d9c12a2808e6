!> The motion of every link at one instant: what the solvers fill and the writers print.
module motion
   use kinds, only: wp
   use diagnostics, only: diagnostic_t
   implicit none
   private
   public :: motion_t, new_motion, known_of, mark_of, forget_links
   public :: mark_none, mark_not_converged, mark_singular, mark_overflow, mark_inconsistent

   integer, parameter :: mark_none = 0
   integer, parameter :: mark_not_converged = 1  !< no position was found
   integer, parameter :: mark_singular = 2       !< position found, Jacobian singular: no velocities
   integer, parameter :: mark_overflow = 3       !< a result beyond the range of the real kind
   integer, parameter :: mark_inconsistent = 4           !< equations that are too many contradict one another

   type :: motion_t
      real(wp) :: t = 0.0_wp
      integer :: mark = mark_none
      !> How much of it exists: -1 nothing, 0 positions, 1 velocities too, 2 accelerations too.
      integer :: known = -1
      type(diagnostic_t), allocatable :: diagnostics(:)     !< what else there is to say; none: not allocated
      real(wp) :: origin(2) = 0.0_wp                !< what x and y of `position` are counted from
      !> (3, links): x, y, phi and their first and second derivatives by time.
      real(wp), allocatable :: position(:, :), velocity(:, :), acceleration(:, :)
      !> (links) `known` and `mark` of each link, where they are not alike: those of the whole are then the worst of
      !> them. Not allocated: as the whole.
      integer, allocatable :: link_known(:), link_mark(:)
   end type motion_t

contains

   !> A motion of `n` links at rest at the origin.
   pure function new_motion(n) result(m)
      integer, intent(in) :: n
      type(motion_t) :: m

      allocate (m%position(3, n), m%velocity(3, n), m%acceleration(3, n), source=0.0_wp)
   end function new_motion

   !> How much of the motion of `link` exists, as `known` has it.
   pure integer function known_of(m, link)
      type(motion_t), intent(in) :: m
      integer, intent(in) :: link

      known_of = m%known
      if (allocated(m%link_known)) known_of = m%link_known(link)
   end function known_of

   !> Why no more of it exists; mark_none where all of it does.
   pure integer function mark_of(m, link)
      type(motion_t), intent(in) :: m
      integer, intent(in) :: link

      mark_of = m%mark
      if (allocated(m%link_mark)) mark_of = m%link_mark(link)
   end function mark_of

   !> From now on all links are known alike.
   pure subroutine forget_links(m)
      type(motion_t), intent(inout) :: m

      if (allocated(m%link_known)) deallocate (m%link_known)
      if (allocated(m%link_mark)) deallocate (m%link_mark)
   end subroutine forget_links
end module motion
