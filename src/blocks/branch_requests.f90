!> Which branch is taken at which change point: smoothly on, but where a BRANCH card asks for the other one.
!> A change point passed once is passed on the same branch again, in either direction: the motion is a function of time.
module branch_requests
   use kinds, only: wp
   use mechanism, only: mechanism_t, branch_request_t
   implicit none
   private
   public :: branch_requests_t, new_branch_requests, decide

   !> The listing gives the time of a change point to six digits; so may a card.
   real(wp), parameter :: digits_of_time = 1.0e-5_wp

   !> A change point of a block at `t`, known to `width`.
   type :: branch_switch_t
      integer :: block = 0                        !< its number
      real(wp) :: t = 0.0_wp, width = 0.0_wp      !< times, in the deck's unit
      logical :: other = .false.                  !< the other branch was taken
   end type branch_switch_t

   !> BRANCH cards, and how change points were passed.
   type :: branch_requests_t
      type(branch_request_t), allocatable :: cards(:)   !< in the deck's order
      logical, allocatable :: used(:)             !< (cards)
      type(branch_switch_t), allocatable :: branch_switches(:)
      real(wp), allocatable :: stood_until        !< until then the motion stood on a singular position, the last time
   end type branch_requests_t

contains

   !> The BRANCH cards of `m`, none of them used yet.
   pure function new_branch_requests(m) result(c)
      type(mechanism_t), intent(in) :: m
      type(branch_requests_t) :: c

      allocate (c%branch_switches(0))
      if (allocated(m%branch_requests)) then
         c%cards = m%branch_requests
      else
         allocate (c%cards(0))
      end if
      allocate (c%used(size(c%cards)), source=.false.)
   end function new_branch_requests

   !> Whether `block`, which moves the `links`, takes the `other` branch at its change point between the times `before`
   !> and `t`, about at `at`. One on which the motion stood is at the time at which that ended. Of the cards not used
   !> yet that name one of the links, or none, that counts whose time was passed first on the way there.
   pure subroutine decide(c, block, links, before, t, at, other)
      type(branch_requests_t), intent(inout) :: c
      integer, intent(in) :: block
      logical, intent(in) :: links(:)
      real(wp), intent(in) :: before, t, at
      logical, intent(out) :: other
      real(wp) :: way, here
      integer :: i, best

      do i = 1, size(c%branch_switches)
         associate (p => c%branch_switches(i))
            other = p%other
            if (p%block == block .and. abs(p%t - at) <= p%width + abs(t - before)) return
         end associate
      end do
      way = sign(1.0_wp, t - before)
      here = at
      if (allocated(c%stood_until)) here = way*max(way*at, way*c%stood_until)
      best = 0
      do i = 1, size(c%cards)
         associate (card => c%cards(i))
            if (c%used(i)) cycle
            if (card%link > 0) then
               if (.not. links(card%link)) cycle
            end if
            if (way*(card%t - here) > abs(t - before) + digits_of_time*max(abs(card%t), abs(here))) cycle
            if (best > 0) then
               if (way*(card%t - c%cards(best)%t) >= 0.0_wp) cycle
            end if
            best = i
         end associate
      end do
      other = best > 0
      if (other) c%used(best) = .true.
      c%branch_switches = [c%branch_switches, branch_switch_t(block, at, abs(t - before), other)]
   end subroutine decide
end module branch_requests
