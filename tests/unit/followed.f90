!> Tests. Analyses that are asked for one instant after another.
module followed
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use analysis, only: analysis_t, make_analysis, advance
   implicit none
   private
   public :: follow

contains

   !> Makes the analysis `a` of `m` and asks it for the `instants`; `q`: the motion at the last of them.
   subroutine follow(m, instants, a, q)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: instants(:)
      type(analysis_t), intent(out) :: a
      type(motion_t), intent(out) :: q
      integer :: k

      call make_analysis(a, m)
      q = new_motion(size(m%links))
      do k = 1, size(instants)
         call advance(a, instants(k), q)
      end do
   end subroutine follow
end module followed
