!> Proof of a step: of the motion between two instants, in as many parts as that takes. A part that is not proved is
!> divided in its middle, where the blocks are solved once more.
module step_proof
   use kinds, only: wp
   use drives, only: drive_motion
   use block_engine, only: block_engine_t
   use block_solver, only: workspace_t, make_workspace, solve_block
   use convergence, only: convergence_t, is_solved
   use position_proof, only: prover_t, placed_t, new_placed, take_state, prove_block
   use tube_proof, only: tube_t, new_tube, prove_tube
   implicit none
   private
   public :: step_prover_t, step_proof_t, make_step_prover, prove_step

   !> So many tubes are tried of a step at most, none shorter than this part of it.
   integer, parameter :: max_tries = 1024
   real(wp), parameter :: min_part = 1.0e-6_wp
   !> And fewer of wide blocks, whose inverses take about so many products: some seconds.
   real(wp), parameter :: max_products = 1.0e9_wp

   !> What it needs beside the prover of positions. Never copied: see workspace_t.
   type :: step_prover_t
      type(workspace_t) :: work
      type(tube_t) :: tube
   end type step_prover_t

   !> What is proved of a step.
   type :: step_proof_t
      logical :: is_proved = .false.
      integer :: parts = 0                        !< proved
      integer :: tries = 0                        !< tubes tried
      real(wp) :: radius = 0.0_wp                 !< the largest of its tubes, in radians and block units
      integer :: block = 0                        !< that is not proved
      real(wp) :: t = 0.0_wp                      !< the middle of the part that is not
      logical :: is_broken_off = .false.          !< blocks are too wide for more tries
   end type step_proof_t

contains

   !> Ready for the steps of the engine `e`.
   subroutine make_step_prover(s, e)
      type(step_prover_t), intent(out) :: s
      type(block_engine_t), intent(in) :: e

      call make_workspace(s%work, e%blocks)
      s%tube = new_tube(e%blocks)
   end subroutine make_step_prover

   !> Proves the motion of the blocks `list` between the proved positions `from` and `to`.
   subroutine prove_step(p, s, e, list, from, to, proof)
      type(prover_t), intent(inout) :: p
      type(step_prover_t), intent(inout) :: s
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: list(:)
      type(placed_t), intent(in) :: from, to
      type(step_proof_t), intent(out) :: proof

      proof%is_proved = .true.
      call prove_part(p, s, e, list, from, to, min_part*abs(to%t - from%t), proof)
   end subroutine prove_step

   !> The same of a part of a step, none less than `shortest`.
   recursive subroutine prove_part(p, s, e, list, from, to, shortest, proof)
      type(prover_t), intent(inout) :: p
      type(step_prover_t), intent(inout) :: s
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: list(:)
      type(placed_t), intent(in) :: from, to
      real(wp), intent(in) :: shortest
      type(step_proof_t), intent(inout) :: proof
      type(placed_t), allocatable :: middle
      logical :: is_found

      proof%tries = proof%tries + 1
      call prove_tube(p, e, list, from, to, s%tube)
      if (s%tube%is_proved) then
         proof%parts = proof%parts + 1
         proof%radius = max(proof%radius, maxval(s%tube%radius))
         return
      end if
      proof%block = s%tube%block
      proof%t = 0.5_wp*(from%t + to%t)
      proof%is_broken_off = proof%tries >= max_products/sum(real(e%blocks%list(list)%shape%n, wp)**3)
      proof%is_proved = abs(to%t - from%t) > shortest .and. proof%tries < max_tries .and. .not. proof%is_broken_off
      if (.not. proof%is_proved) return
      allocate (middle)
      middle = new_placed(e%blocks, size(e%laws))
      call solve_middle(p, s, e, list, proof%t, middle, is_found)
      proof%is_proved = is_found
      if (proof%is_proved) call prove_part(p, s, e, list, from, middle, shortest, proof)
      if (proof%is_proved) call prove_part(p, s, e, list, middle, to, shortest, proof)
   end subroutine prove_part

   !> The position `middle` at `t`, from where p%state is; `is_found`: it is proved.
   subroutine solve_middle(p, s, e, list, t, middle, is_found)
      type(prover_t), intent(inout) :: p
      type(step_prover_t), intent(inout) :: s
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: list(:)
      real(wp), intent(in) :: t
      type(placed_t), intent(inout) :: middle
      logical, intent(out) :: is_found
      type(convergence_t) :: c
      integer :: i, k

      do i = 1, size(e%laws)
         p%state%drive_value(0:2, i) = drive_motion(e%laws(i), t)*e%unit_of(i)
      end do
      is_found = .false.
      do k = 1, size(list)
         c = convergence_t()
         call solve_block(e%blocks, list(k), e%tolerance, s%work, p%state, c)
         if (.not. is_solved(c) .or. c%singular .or. c%rates_open) return
      end do
      call take_state(p, e, t, middle)
      do k = 1, size(list)
         call prove_block(p, e%blocks, list(k), 0, middle)
         if (.not. middle%is_proved(list(k))) return
      end do
      is_found = .true.
   end subroutine solve_middle
end module step_proof
