!> How many instants of a run are solved, flagged and not proved, and why the first is flagged.
module counts
   use kinds, only: wp
   use motion, only: flag_none, diagnostic_t, diagnostic_limit
   use set_motion, only: is_flagged
   use set_analysis, only: set_analysis_t
   implicit none
   private
   public :: counts_t, record_flag

   !> The counts of a run, and its first flag.
   type :: counts_t
      integer :: solved = 0, flagged = 0            !< instants
      integer :: unproved = 0                       !< instants that are not proved, with their steps, if a card asks
      integer :: flag = flag_none, singularity = 0  !< of the first flagged instant: flag_..., singular_...
      real(wp) :: t = 0.0_wp                        !< time of the first flagged instant
      type(diagnostic_t) :: limit                   !< the first limit of the motion; its kind is 0: none
   end type counts_t

contains

   !> Counts the instant to which a set has advanced, solved or flagged, and keeps why the first one is flagged.
   subroutine record_flag(counts, set)
      type(counts_t), intent(inout) :: counts   !< of the run so far
      type(set_analysis_t), intent(in) :: set   !< at the instant
      integer :: c, i

      if (.not. is_flagged(set%now)) then
         counts%solved = counts%solved + 1
         return
      end if
      counts%flagged = counts%flagged + 1
      do c = 1, set%now%count
         associate (q => set%now%motions(c))
            if (counts%flag == flag_none .and. q%flag /= flag_none) then
               counts%flag = q%flag
               counts%singularity = q%singularity
               counts%t = q%t
            end if
            if (counts%limit%kind /= 0 .or. .not. allocated(q%diagnostics)) cycle
            i = findloc(q%diagnostics%kind, diagnostic_limit, dim=1)
            if (i == 0) cycle
            counts%limit = q%diagnostics(i)
         end associate
      end do
   end subroutine record_flag
end module counts
