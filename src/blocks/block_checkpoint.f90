!> A place of the motion that the blocks follow, to come back to.
module block_checkpoint
   use kinds, only: wp
   use predictor, only: history_t
   use block_state, only: state_t
   use block_engine, only: block_engine_t
   implicit none
   private
   public :: block_checkpoint_t, checkpoint_blocks, restore_blocks

   !> All that depends on the way so far: the motions that are followed, with the signs and pivots of their
   !> Jacobians, and the motion found last. No workspace.
   type :: block_checkpoint_t
      type(history_t) :: history
      integer, allocatable :: sign_of(:), sign_now(:)
      real(wp), allocatable :: pivot_of(:), pivot_now(:), inverse_of(:), inverse_now(:), side(:)
      logical, allocatable :: crossed(:)
      type(state_t) :: state
      real(wp) :: t = 0.0_wp, change = 0.0_wp
   end type block_checkpoint_t

contains

   !> Notes in `c` all that depends on the way so far.
   pure subroutine checkpoint_blocks(e, c)
      type(block_engine_t), intent(in) :: e
      type(block_checkpoint_t), intent(inout) :: c

      c%history = e%history
      c%sign_of = e%sign_of
      c%pivot_of = e%pivot_of
      c%inverse_of = e%inverse_of
      if (allocated(e%side)) c%side = e%side
      c%state = e%state
      c%sign_now = e%sign_now
      c%pivot_now = e%pivot_now
      c%inverse_now = e%inverse_now
      c%crossed = e%crossed
      c%t = e%t
      c%change = e%change
   end subroutine checkpoint_blocks

   !> Makes the motion that was followed at the checkpoint `c` the one that is followed, and what was found last there
   !> what was found last; `keeps_found`: that stays as it is now.
   pure subroutine restore_blocks(e, c, keeps_found)
      type(block_engine_t), intent(inout) :: e
      type(block_checkpoint_t), intent(in) :: c
      logical, intent(in) :: keeps_found

      e%history = c%history
      e%sign_of = c%sign_of
      e%pivot_of = c%pivot_of
      e%inverse_of = c%inverse_of
      if (allocated(c%side)) e%side = c%side
      if (keeps_found) return
      e%state = c%state
      e%sign_now = c%sign_now
      e%pivot_now = c%pivot_now
      e%inverse_now = c%inverse_now
      e%crossed = c%crossed
      e%t = c%t
      e%change = c%change
   end subroutine restore_blocks
end module block_checkpoint
