!> The engine of a set: blocks (METHOD NEWTON) or all equations at once (METHOD DENSE and MATRIX), asked in
!> the same way.
module engine
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, method_dense
   use structure, only: structure_t
   use motion, only: motion_t, mark_none
   use convergence, only: convergence_t
   use block_engine, only: block_engine_t, make_block_engine, solve_blocks, accept_blocks, get_blocks_motion, &
      block_checkpoint_t, checkpoint_blocks, restore_blocks, know_links, get_driven_motion
   use assembly_choice, only: solve_first
   use dense_engine, only: dense_t, new_dense, solve_dense, accept_dense, get_dense_motion, &
      dense_checkpoint_t, checkpoint_dense, restore_dense
   implicit none
   private
   public :: engine_t, engine_checkpoint_t, make_engine, solve, accept, checkpoint, restore, get_motion_of, &
      get_link_flags, &
      get_certain_links, is_certified

   !> One of the two.
   type :: engine_t
      type(block_engine_t), allocatable :: blocks
      type(dense_t), allocatable :: dense
   end type engine_t

   !> Values, history, signs and pivots of the engine: what its further way depends on. An engine itself is never
   !> copied, since its workspace holds handles of KLU.
   type :: engine_checkpoint_t
      type(block_checkpoint_t) :: blocks
      type(dense_checkpoint_t) :: dense
   end type engine_checkpoint_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns. `structure`: see
   !> `make_block_engine`.
   subroutine make_engine(e, m, structure)
      type(engine_t), intent(out) :: e
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout), optional :: structure

      if (m%method == method_newton) then
         allocate (e%blocks)
         call make_block_engine(e%blocks, m, structure)
      else
         e%dense = new_dense(m)
      end if
   end subroutine make_engine

   !> Seeks the motion at `t`, from the last one kept (`follows`) or from the deck's. `c`: how it ended,
   !> `correction`: the largest change of a predicted value, `same`: the determinants have kept their signs.
   subroutine solve(e, t, follows, c, correction, same)
      type(engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: follows
      type(convergence_t), intent(out) :: c
      real(wp), intent(out) :: correction
      logical, intent(out) :: same

      if (allocated(e%blocks) .and. follows) then
         call solve_blocks(e%blocks, t, follows, c, correction, same)
      else if (allocated(e%blocks)) then
         call solve_first(e%blocks, t, c, correction, same)
      else
         call solve_dense(e%dense, t, follows, c, correction, same)
      end if
   end subroutine solve

   !> Makes the motion found last the one that is followed.
   subroutine accept(e)
      type(engine_t), intent(inout) :: e

      if (allocated(e%blocks)) then
         call accept_blocks(e%blocks)
      else
         call accept_dense(e%dense)
      end if
   end subroutine accept

   !> Notes in `c` the motion that is followed and that found last.
   pure subroutine checkpoint(e, c)
      type(engine_t), intent(in) :: e
      type(engine_checkpoint_t), intent(inout) :: c

      if (allocated(e%blocks)) then
         call checkpoint_blocks(e%blocks, c%blocks)
      else
         call checkpoint_dense(e%dense, c%dense)
      end if
   end subroutine checkpoint

   !> Follows again what was followed at the checkpoint `c`, as if nothing had been sought since; `keeps_found`: the
   !> motion found last stays what it is, to be told.
   pure subroutine restore(e, c, keeps_found)
      type(engine_t), intent(inout) :: e
      type(engine_checkpoint_t), intent(in) :: c
      logical, intent(in) :: keeps_found

      if (allocated(e%blocks)) then
         call restore_blocks(e%blocks, c%blocks, keeps_found)
      else
         call restore_dense(e%dense, c%dense, keeps_found)
      end if
   end subroutine restore

   !> The motion found last, in the deck's units; `finite`: all of it is known to be in range.
   subroutine get_motion_of(e, found, finite)
      type(engine_t), intent(inout) :: e
      type(motion_t), intent(inout) :: found
      logical, intent(out) :: finite

      if (allocated(e%blocks)) then
         call get_blocks_motion(e%blocks, found, finite)
      else
         call get_dense_motion(e%dense, found)
         finite = .false.
      end if
   end subroutine get_motion_of

   !> Positions that are followed carry the certificate of `branch_certificate`. METHOD MATRIX has the same guard but
   !> counts
   !> none: its iteration arrives at some instants of a motion and not at others.
   pure logical function is_certified(e)
      type(engine_t), intent(in) :: e

      is_certified = allocated(e%blocks)
      if (allocated(e%dense)) is_certified = e%dense%method == method_dense
   end function is_certified

   !> Of which links the motion found last is known in full although it is not as a whole. METHOD DENSE and METHOD
   !> MATRIX have one Jacobian for all links: without its inverse they know the links that drives alone move.
   subroutine get_link_flags(e, found)
      type(engine_t), intent(in) :: e
      type(motion_t), intent(inout) :: found
      type(block_engine_t) :: blocks
      type(motion_t) :: driven
      integer :: link

      if (allocated(e%blocks)) then
         call know_links(e%blocks, found)
         return
      end if
      call make_block_engine(blocks, e%dense%blocks)
      driven = found
      call get_driven_motion(blocks, found%t, driven)
      if (.not. allocated(driven%link_known)) return
      found%link_known = merge(2, 0, driven%link_known == 2)
      found%link_mark = merge(mark_none, found%mark, driven%link_known == 2)
      do link = 1, size(driven%link_known)
         if (driven%link_known(link) < 2) cycle
         found%velocity(:, link) = driven%velocity(:, link)
         found%acceleration(:, link) = driven%acceleration(:, link)
      end do
   end subroutine get_link_flags

   !> What is certain at `t`, where no position was found: the links that drives alone move.
   subroutine get_certain_links(e, t, found)
      type(engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(block_engine_t) :: blocks

      if (allocated(e%blocks)) then
         call get_driven_motion(e%blocks, t, found)
      else
         call make_block_engine(blocks, e%dense%blocks)
         call get_driven_motion(blocks, t, found)
      end if
   end subroutine get_certain_links
end module engine
