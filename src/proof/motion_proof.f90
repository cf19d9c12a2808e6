!> What card PROVE proves of a mechanism, instant by instant: the position, with bounds of all that is computed there,
!> and the step to it from the last instant that was proved.
module motion_proof
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t
   use engine, only: engine_t
   use block_method, only: block_method_t
   use position_proof, only: prover_t, placed_t, make_prover, new_placed, prove_position, &
      max_unknowns
   use step_proof, only: step_prover_t, step_proof_t, make_step_prover, prove_step
   use link_bounds, only: link_bounds_t, new_link_bounds, bound_links
   implicit none
   private
   public :: motion_prover_t, motion_proof_t, prove_motion, holds

   !> What the proofs of a mechanism need and keep. Never copied: see step_prover_t.
   type :: motion_prover_t
      logical :: is_ready = .false.
      logical :: has_begun = .false.              !< a position is proved
      type(prover_t) :: prover
      type(step_prover_t) :: step_prover
      type(link_bounds_t) :: links
      type(placed_t) :: at(2)                     !< the last position that was proved, and the one at hand
      integer :: now = 1                          !< which of them is at hand
   end type motion_prover_t

   !> What is proved of an instant.
   type :: motion_proof_t
      logical :: taken = .false.                  !< a PROVE card asks for it
      logical :: is_proved = .false.              !< its position is
      logical :: has_step = .false.               !< a step leads to it from a position that was proved
      type(step_proof_t) :: step
      real(wp) :: gap = 0.0_wp                    !< of redundant equations at the instant, at most, in block units
      !> (3, 0:2, links) bounds of their errors, in the deck's units and rad, where they are asked for
      real(wp), allocatable :: links(:, :, :)
      integer, allocatable :: failed(:)           !< the links of the block that is not proved
      integer :: too_many = 0                     !< its unknowns, if they are too many
   end type motion_proof_t

contains

   !> Proves the motion `q` of `m` that the engine `e` has found, and the step to it. `bounded`: with bounds of all that
   !> is computed; otherwise of positions alone, as the step needs them.
   subroutine prove_motion(p, m, e, q, bounded, found)
      type(motion_prover_t), intent(inout) :: p
      type(mechanism_t), intent(in) :: m
      class(engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      logical, intent(in) :: bounded
      type(motion_proof_t), intent(inout) :: found
      integer :: k

      found%taken = .true.
      found%is_proved = .false.
      found%has_step = .false.
      found%step = step_proof_t()
      select type (e)
      class is (block_method_t)
         if (.not. p%is_ready) then
            call make_prover(p%prover, m, e%block_engine_t)
            call make_step_prover(p%step_prover, e%block_engine_t)
            p%links = new_link_bounds(m, e%block_engine_t)
            p%at(1) = new_placed(e%blocks, size(m%drives))
            p%at(2) = p%at(1)
            p%is_ready = .true.
            allocate (found%links(3, 0:2, size(m%links)))
         end if
         if (allocated(found%failed)) deallocate (found%failed)
         if (q%known < 2) return
         call prove_position(p%prover, e%block_engine_t, q%t, e%needed, p%at(p%now), found%is_proved, &
            merge(2, 0, bounded))
         if (found%is_proved) then
            if (bounded) call bound_links(p%links, e%block_engine_t, p%prover%jets, found%links)
            found%gap = maxval(p%at(p%now)%gap(e%needed))
            found%has_step = p%has_begun
            if (found%has_step) &
               call prove_step(p%prover, p%step_prover, e%block_engine_t, e%needed, p%at(3 - p%now), p%at(p%now), &
               found%step)
            p%now = 3 - p%now
            p%has_begun = .true.
            if (.not. found%has_step .or. found%step%is_proved) return
            k = found%step%block
         else
            k = e%needed(findloc(p%at(p%now)%is_proved(e%needed), .false., dim=1))
         end if
         if (k == 0) return
         found%failed = links_of_block(e, k)
         if (e%blocks%list(k)%shape%n > max_unknowns .or. found%step%is_broken_off) &
            found%too_many = e%blocks%list(k)%shape%n
      end select
   end subroutine prove_motion

   !> All is proved that is asked for.
   pure elemental logical function holds(proof)
      type(motion_proof_t), intent(in) :: proof

      holds = .not. proof%taken .or. (proof%is_proved .and. (proof%step%is_proved .or. .not. proof%has_step))
   end function holds

   !> The links whose angles block `k` gives.
   pure function links_of_block(e, k) result(links)
      class(block_method_t), intent(in) :: e
      integer, intent(in) :: k
      integer, allocatable :: links(:)
      logical :: of_block(size(e%orientation_of))
      integer :: i

      do i = 1, size(of_block)
         of_block(i) = .false.
         if (e%orientation_of(i) > 0) of_block(i) = e%blocks%block_of(e%orientation_of(i)) == k
      end do
      links = pack([(i, i=1, size(of_block))], of_block)
   end function links_of_block
end module motion_proof
