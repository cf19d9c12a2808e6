!> Where the motion that is followed comes to its end, on either side of where it is: an instant beyond is not
!> reached by continuity, whatever is asked for in between, and need not be sought again.
module way_ends
   use kinds, only: wp
   use remarks, only: remark_t
   implicit none
   private
   public :: way_ends_t, note_end, lies_beyond, told_of_end

   !> What lies further than this part of a way behind the place where the way was found blocked lies beyond its end.
   real(wp), parameter :: near_part = max(1.0e-6_wp, 64.0_wp*epsilon(1.0_wp))

   !> One side: instants from `t` on are beyond the end; what there is to say of it.
   type :: way_end_t
      logical :: known = .false.
      real(wp) :: t = 0.0_wp
      type(remark_t), allocatable :: remarks(:)
   end type way_end_t

   type :: way_ends_t
      type(way_end_t) :: earlier, later
   end type way_ends_t

contains

   !> The way from `place` to `t` has ended at `reached`. `blocked`: no part of it could be made there; otherwise it
   !> is only known that `t` was not reached. `remarks`: what there is to say of it.
   pure subroutine note_end(ends, place, reached, t, blocked, remarks)
      type(way_ends_t), intent(inout) :: ends
      real(wp), intent(in) :: place, reached, t
      logical, intent(in) :: blocked
      type(remark_t), intent(in) :: remarks(:)
      type(way_end_t) :: this

      if (abs(t - place) <= 0.0_wp) return
      this%known = .true.
      this%t = t
      if (blocked) this%t = reached + near_part*(t - place)
      this%remarks = remarks
      if (t > place) then
         ends%later = this
      else
         ends%earlier = this
      end if
   end subroutine note_end

   !> The instant `t` lies beyond an end that is known.
   pure logical function lies_beyond(ends, t)
      type(way_ends_t), intent(in) :: ends
      real(wp), intent(in) :: t

      lies_beyond = (ends%later%known .and. t >= ends%later%t) .or. (ends%earlier%known .and. t <= ends%earlier%t)
   end function lies_beyond

   !> What there is to say of the end before `t`, which lies beyond it.
   pure function told_of_end(ends, t) result(list)
      type(way_ends_t), intent(in) :: ends
      real(wp), intent(in) :: t
      type(remark_t), allocatable :: list(:)

      if (ends%later%known .and. t >= ends%later%t) then
         list = ends%later%remarks
      else
         list = ends%earlier%remarks
      end if
   end function told_of_end
end module way_ends
