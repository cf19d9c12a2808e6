!> Where the motion that is followed comes to its end, on either side of where it is: an instant beyond is not
!> reached by continuity, whatever is asked for in between, and need not be sought again.
module limits
   use kinds, only: wp
   use diagnostics, only: diagnostic_t
   implicit none
   private
   public :: limits_t, note_limit, lies_beyond, diagnostics_of_limit

   !> What lies further than this part of a way behind the place where the way was found blocked lies beyond its end.
   real(wp), parameter :: near_part = max(1.0e-6_wp, 64.0_wp*epsilon(1.0_wp))

   !> One side: instants from `t` on are beyond the end; what there is to say of it.
   type :: limit_t
      logical :: known = .false.
      real(wp) :: t = 0.0_wp
      type(diagnostic_t), allocatable :: diagnostics(:)
   end type limit_t

   type :: limits_t
      type(limit_t) :: earlier, later
   end type limits_t

contains

   !> The way from `place` to `t` has ended at `reached`. `blocked`: no part of it could be made there; otherwise it
   !> is only known that `t` was not reached. `diagnostics`: what there is to say of it.
   pure subroutine note_limit(ends, place, reached, t, blocked, diagnostics)
      type(limits_t), intent(inout) :: ends
      real(wp), intent(in) :: place, reached, t
      logical, intent(in) :: blocked
      type(diagnostic_t), intent(in) :: diagnostics(:)
      type(limit_t) :: this

      if (abs(t - place) <= 0.0_wp) return
      this%known = .true.
      this%t = t
      if (blocked) this%t = reached + near_part*(t - place)
      this%diagnostics = diagnostics
      if (t > place) then
         ends%later = this
      else
         ends%earlier = this
      end if
   end subroutine note_limit

   !> The instant `t` lies beyond an end that is known.
   pure logical function lies_beyond(ends, t)
      type(limits_t), intent(in) :: ends
      real(wp), intent(in) :: t

      lies_beyond = (ends%later%known .and. t >= ends%later%t) .or. (ends%earlier%known .and. t <= ends%earlier%t)
   end function lies_beyond

   !> What there is to say of the end before `t`, which lies beyond it.
   pure function diagnostics_of_limit(ends, t) result(list)
      type(limits_t), intent(in) :: ends
      real(wp), intent(in) :: t
      type(diagnostic_t), allocatable :: list(:)

      if (ends%later%known .and. t >= ends%later%t) then
         list = ends%later%diagnostics
      else
         list = ends%earlier%diagnostics
      end if
   end function diagnostics_of_limit
end module limits
