!> The proofs of card PROVE, instant by instant: of the position, with bounds of the motion of links, and of the step to
!> it from the last instant that was proved.
!>
!> The proof of a step is a proof of the motion between two instants, in parts. A part that is not proved is divided in
!> its middle, at which the blocks are solved once more.
module motion_proof
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t
   use drive_path, only: drive_path_t
   use blocks, only: blocks_t, geometry_t
   use convergence, only: solve_report_t, is_solved
   use block_state, only: state_t, set_drive_values
   use block_solver, only: workspace_t, new_workspace, solve_blocks
   use balls, only: ball_t
   use ball_equations, only: ball_numbers_t, new_ball_state
   use ball_numbers, only: new_ball_numbers
   use position_proof, only: proved_position_t, new_placed, prove_position, max_proved_unknowns
   use tube_proof, only: tube_t, prove_tube
   use link_bounds, only: bound_links
   implicit none
   private
   public :: motion_prover_t, motion_proof_t, prove_motion, holds, step_proof_t, prove_step

   !> Up to so many tubes are tried in a step. It bounds the time of a step that cannot be proved.
   integer, parameter :: max_tubes = 1024
   !> A part shorter than this part of the step is not divided: twenty halvings have not helped.
   real(wp), parameter :: min_part_of_step = 1.0e-6_wp

   !> The proof of a step.
   type :: step_proof_t
      logical :: is_proved = .false.              !< all its parts are proved
      integer :: parts = 0                        !< how many parts were proved
      integer :: tries = 0                        !< how many tubes were tried
      real(wp) :: radius = 0.0_wp                 !< the largest radius of its tubes, in rad and units of the blocks
      integer :: block = 0                        !< the block without proof in the last tube that failed; 0: none
   end type step_proof_t

   !> The data that all proofs of a mechanism share.
   type :: motion_prover_t
      logical :: has_begun = .false.              !< a position is proved
      type(ball_numbers_t) :: numbers             !< the geometry in balls
      type(proved_position_t) :: at(2)            !< the last position that was proved, and the one to be proved next
      integer :: now = 1                          !< index of the one to be proved next
   end type motion_prover_t

   !> The proof of an instant.
   type :: motion_proof_t
      logical :: taken = .false.                  !< a PROVE card requests it
      logical :: is_proved = .false.              !< its position is proved
      logical :: has_step = .false.               !< a step leads to it from a position that was proved
      type(step_proof_t) :: step                  !< if `has_step`
      real(wp) :: closure_error = 0.0_wp          !< bound of redundant equations, unit of the loop or rad
      !> (3, 0:2, links) x, y, phi and their derivatives, if bounds are requested, in the deck's units and rad.
      type(ball_t), allocatable :: links(:, :, :)
      real(wp) :: largest(2, 0:2) = 0.0_wp        !< largest errors of lengths and angles, and of their derivatives
      integer, allocatable :: failed(:)           !< numbers of the links of the block that is not proved
      integer :: too_many = 0                     !< how many unknowns that block has, if they are too many
   end type motion_proof_t

contains

   !> Proves a motion and the step to it. If a proof fails, `found` has the links of the first block that is not proved.
   !> Of an incomplete motion nothing is proved.
   subroutine prove_motion(prover, m, b, x, path, s, q, bounded, found)
      type(motion_prover_t), intent(inout) :: prover   !< with the last position that was proved
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      type(state_t), intent(in) :: s         !< the motion of the unknowns
      type(motion_t), intent(in) :: q        !< the motion of all links
      logical, intent(in) :: bounded         !< with bounds of the motion of links; otherwise positions, for the step
      type(motion_proof_t), intent(inout) :: found   !< the proof
      integer, allocatable :: block_of(:)         ! 0 for the ground's angle, then the block of each unknown
      integer :: failed, i

      if (asserts) call assert(size(q%position, 2) == size(m%links), 'prove_motion: a motion of all links')
      found%taken = .true.
      found%is_proved = .false.
      found%has_step = .false.
      found%step = step_proof_t()
      if (.not. allocated(found%links)) then
         prover%numbers = new_ball_numbers(m, b, x)
         prover%at(1) = new_placed(b, size(m%drives))
         prover%at(2) = prover%at(1)
         allocate (found%links(3, 0:2, size(m%links)))
      end if
      if (allocated(found%failed)) deallocate (found%failed)
      if (q%known < 2) return

      associate (here => prover%at(prover%now), before => prover%at(3 - prover%now))
         call prove_position(prover%numbers, b, path, s, merge(2, 0, bounded), here, failed)
         found%is_proved = failed == 0
         if (found%is_proved) then
            if (bounded) call bound_links(x, prover%numbers, here%ball_state_t, q, found%links, found%largest)
            found%closure_error = here%closure_error
            found%has_step = prover%has_begun
            if (found%has_step) call prove_step(prover%numbers, b, x, path, s, before, here, found%step)
            failed = found%step%block
         end if
      end associate
      if (found%is_proved) prover%now = 3 - prover%now
      prover%has_begun = prover%has_begun .or. found%is_proved
      if (holds(found)) return

      block_of = [0, b%block_of]
      found%failed = pack([(i, i=1, size(m%links))], block_of(1 + b%tree%orientation) == failed)
      if (b%list(failed)%shape%n > max_proved_unknowns) found%too_many = b%list(failed)%shape%n
   end subroutine prove_motion

   !> Tells whether position and step of an instant are proved, or no PROVE card requests a proof.
   pure elemental logical function holds(proof)
      type(motion_proof_t), intent(in) :: proof   !< of the instant

      holds = .not. proof%taken .or. (proof%is_proved .and. (proof%step%is_proved .or. .not. proof%has_step))
   end function holds

   !> Proves the motion of the needed blocks between two proved positions. The proof ends at the first part that can be
   !> neither proved nor divided.
   subroutine prove_step(numbers, b, x, path, s, from, to, proof)
      type(ball_numbers_t), intent(in) :: numbers   !< the geometry in balls
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      type(state_t), intent(in) :: s         !< the computed motion at `to`
      type(proved_position_t), intent(in) :: from, to   !< the proved positions
      type(step_proof_t), intent(out) :: proof   !< of the step
      type(tube_t) :: tube
      type(state_t), allocatable :: other               ! few steps need it
      type(workspace_t) :: w

      tube = new_tube(b, size(path%laws))
      proof%is_proved = .true.
      call prove_part(from, to, min_part_of_step*abs(to%t - from%t))

   contains

      !> Proves a part of a step by one tube or, if there is none, by its two halves. The result is in `proof`.
      recursive subroutine prove_part(from, to, shortest)
         type(proved_position_t), intent(in) :: from, to   !< proved positions at its ends
         real(wp), intent(in) :: shortest    !< a shorter part is not divided, in the deck's unit of time
         type(proved_position_t), allocatable :: middle
         type(solve_report_t) :: c
         integer :: failed

         proof%tries = proof%tries + 1
         call prove_tube(numbers, b, path, from, to, tube)
         if (tube%block == 0) then
            proof%parts = proof%parts + 1
            proof%radius = max(proof%radius, maxval(tube%radius))
            return
         end if
         proof%block = tube%block
         proof%is_proved = .false.
         if (abs(to%t - from%t) <= shortest .or. proof%tries >= max_tubes) return

         if (.not. allocated(other)) then
            other = s
            w = new_workspace(b)
         end if
         call set_drive_values(path, 0.5_wp*(from%t + to%t), other)
         other%u%value = 0.5_wp*(from%u%value%mid + to%u%value%mid) &
            + 0.125_wp*(to%t - from%t)*(from%u%rate%mid - to%u%rate%mid)
         call solve_blocks(b, x, b%needed, w, other, c)
         if (.not. is_solved(c) .or. c%singular .or. c%rates_inconsistent) return

         allocate (middle)
         middle = new_placed(b, size(path%laws))
         call prove_position(numbers, b, path, other, 0, middle, failed)
         proof%is_proved = failed == 0
         if (proof%is_proved) call prove_part(from, middle, shortest)
         if (proof%is_proved) call prove_part(middle, to, shortest)
      end subroutine prove_part
   end subroutine prove_step

   !> Makes an empty tube of a structure, for `prove_tube`.
   pure function new_tube(b, drives) result(tube)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives          !< how many drives there are
      type(tube_t) :: tube

      allocate (tube%radius(0:b%unknowns), source=0.0_wp)
      tube%curve = new_ball_state(b, drives)
      tube%balls = tube%curve
   end function new_tube
end module motion_proof
