!> An engine used again, for a variant of its mechanism with the same structure: what comes from the structure stays,
!> and so does the memory of what does not. Its blocks get their new numbers between `give_blocks` and
!> `renew_block_engine`.
module engine_renewal
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use structure, only: structure_t
   use convergence, only: convergence_t
   use predictor, only: forget
   use block_state, only: unknown_t, loop_state_t
   use block_engine, only: block_engine_t, put_mechanism
   implicit none
   private
   public :: give_blocks, can_be_renewed, renew_block_engine

contains

   !> `e` can serve another variant. Not where a block has factors of KLU: the pivots of one variant would be those of
   !> the next.
   pure logical function can_be_renewed(e)
      type(block_engine_t), intent(in) :: e

      can_be_renewed = .false.
      if (allocated(e%blocks)) can_be_renewed = e%blocks%solvable
      if (can_be_renewed) can_be_renewed = all(e%blocks%list%shape%pattern == 0)
   end function can_be_renewed

   !> Gives the blocks of `e` back to `structure`; from now on it can only be renewed.
   subroutine give_blocks(e, structure)
      type(block_engine_t), intent(inout) :: e
      type(structure_t), intent(inout) :: structure

      call move_alloc(e%blocks, structure%blocks)
   end subroutine give_blocks

   !> Ready for the first instant of `m`, as `make_block_engine` makes it; `structure`: that of `m`, with the blocks
   !> that `e` has given and that were renewed.
   subroutine renew_block_engine(e, m, structure)
      type(block_engine_t), intent(inout) :: e
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout) :: structure

      e%span = structure%span
      e%length = structure%length
      e%excursion = 0.0_wp
      call move_alloc(structure%blocks, e%blocks)
      call forget_motions(e)
      call put_mechanism(e, m, structure%tree)
   end subroutine renew_block_engine

   !> As if `e` had solved nothing yet; its workspace is scratch.
   subroutine forget_motions(e)
      type(block_engine_t), intent(inout) :: e
      integer :: i

      call forget(e%history)
      e%state%u = unknown_t()
      e%state%loop = loop_state_t()
      e%state%own = 0.0_wp
      e%state%guide = 0.0_wp
      e%state%drive_value = 0.0_wp
      e%state%excursion = 0.0_wp
      e%t = 0.0_wp
      e%change = 0.0_wp
      e%one = convergence_t()
      do i = 1, size(e%others)
         if (allocated(e%others(i)%x)) deallocate (e%others(i)%x)
      end do
      if (allocated(e%jacobian)) deallocate (e%jacobian)
      e%found%sign_of = 1
      e%found%pivot = 1.0_wp
      e%found%inverse = 0.0_wp
      e%followed(:) = e%found
      e%crossed = .false.
      e%is_close = .false.
      e%is_singular = .false.
   end subroutine forget_motions
end module engine_renewal
