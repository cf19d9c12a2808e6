!> The way back from a dead point or change point, for which there are two branches, and the passage through a change
!> point at which the drive stops or turns.
module change_point_passage
   use kinds, only: wp
   use drive_path, only: drive_at, value_at, slow_drive, next_turn, time_beside, lead
   use motion, only: diagnostic_t, diagnostic_dead_end
   use convergence, only: is_solved
   use predictor, only: begin_at
   use block_state, only: set_drive_values
   use block_solver, only: solve_blocks
   use branch_switching, only: switch_branch, decide
   use block_diagnostics, only: change_diagnostics, diagnostic_at_change, links_of
   use continuation, only: continuation_t, step_record_t, step_failed, step_there, step_stands, continuation_state_t, &
      solve_at, continue_to, accept_substep, revert, follow_from, restore, passed_of
   implicit none
   private
   public :: leave, follow, go_by_value, solve_regular_blocks

   !> So far back from a singular position the motion begins by the value of a drive, in radians and in the unit of
   !> length: far enough for rates, near enough for the same branch.
   real(wp), parameter :: short_step = (100.0_wp*epsilon(1.0_wp))**0.125_wp
   !> After an instant at a singular position the motion takes the other branch when a drive has gone so far, in the
   !> units of the blocks: the branches are still close there, and no longer singular.
   real(wp), parameter :: drive_change_after_rest = 1.0e-5_wp

contains

   !> Leaves the singular position of the last instant, for a motion that goes back from there. If there are BRANCH
   !> cards, it is then followed on the branch that they select, from shortly after that instant.
   subroutine leave(continuation, last, t, blocks, list)
      type(continuation_t), intent(inout) :: continuation
      real(wp), intent(in) :: last               !< time of the last instant
      real(wp), intent(in) :: t                  !< time to which the motion goes
      integer, intent(in) :: blocks(:)           !< numbers of the blocks that stand there
      type(diagnostic_t), allocatable, intent(out) :: list(:)   !< (blocks); diagnostic_dead_end: no branch is found
      type(continuation_state_t) :: before
      type(step_record_t) :: step
      type(diagnostic_t), allocatable :: at_end(:)
      real(wp) :: beside
      logical :: found
      integer :: k

      list = [(diagnostic_at_change(continuation%blocks, continuation%geometry, blocks(k), last), k=1, size(blocks))]
      list%returns = .true.
      if (size(continuation%branch_requests%cards) == 0) return

      beside = time_beside(continuation%path, last, t, drive_change_after_rest)
      continuation%branch_requests%stood_until = beside
      before = continuation%continuation_state_t
      call follow(continuation, beside, step, at_end)
      if (step%ending < step_there .or. passed_of(step) > 0 .or. continuation%convergence%singular) then
         call restore(continuation, before)
         return
      end if
      call accept_substep(continuation, beside)
      do k = 1, size(blocks)
         call decide(continuation%branch_requests, blocks(k), &
            links_of(continuation%blocks, continuation%geometry, blocks(k)), last, beside, last, list(k)%other)
         if (.not. list(k)%other) cycle
         call switch_branch(continuation%blocks, continuation%geometry, continuation%history, continuation%work, &
            continuation%state, blocks(k), continuation%convergence, found)
         if (.not. found) then
            list(k)%kind = diagnostic_dead_end
            continuation%place = before
            return
         end if
         call accept_substep(continuation, beside)
      end do
   end subroutine leave

   !> Follows the motion, by time or by the value of a drive.
   subroutine follow(continuation, t, step, list)
      type(continuation_t), intent(inout) :: continuation
      real(wp), intent(in) :: t                  !< time to which it goes
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable, intent(inout) :: list(:)   !< allocated if it ends at a singular position

      call continue_to(continuation, t, step)
      if (step%ending < step_there) call go_by_value(continuation, t, step, list)
   end subroutine follow

   !> Follows the motion by the value of the one drive that moves, from turn to turn, if the step by time has failed or
   !> has ended at a position without velocities. Reason: the drive stops or turns about there. By time the motion comes
   !> ever closer to a singular position and never across.
   subroutine go_by_value(continuation, t, step, list)
      type(continuation_t), intent(inout) :: continuation
      real(wp), intent(in) :: t                  !< time to which the motion goes
      type(step_record_t), intent(inout) :: step !< of the continuation to `t`; it arrives, or stands on a change point
      type(diagnostic_t), allocatable, intent(out) :: list(:)   !< allocated if `t` is at a singular position
      type(continuation_state_t) :: before, reached
      type(step_record_t) :: by_value
      integer :: drive

      if (.not. continuation%follows) return
      drive = slow_drive(continuation%path, merge(continuation%place%t, continuation%t, step%tries > 1), t, &
         merge(t, continuation%t, step%ending >= step_there), [continuation%drives%first, continuation%drives%last])
      if (drive == 0) return

      reached = continuation%continuation_state_t
      call revert(continuation, step)
      before = continuation%continuation_state_t
      call go_from_turn_to_turn(continuation, drive, t, by_value)
      deallocate (continuation%path%leg)
      if (by_value%ending == step_there) call resume_motion(continuation, t, by_value)
      ! As the step has ended: that tells where the limit is, and which.
      if (by_value%ending < step_there) call restore(continuation, reached)
      continuation%place = before
      if (by_value%ending < step_there) return
      step%ending = step_there
      step%passed = by_value%passed
      if (by_value%ending == step_there) return
      list = change_diagnostics(continuation%blocks, continuation%geometry, continuation%state, t)
      call solve_regular_blocks(continuation, t)
      ! By time a dead point at which the drive turns is one.
      if (size(list) == 0) list = change_diagnostics(continuation%blocks, continuation%geometry, continuation%state, t)
      if (size(list) > 0) step%ending = step_stands
      call follow_from(continuation, before)
   end subroutine go_by_value

   !> Follows the motion to the value of a drive at `t`, the other drives held, from one place at which the drive turns
   !> to the next. It begins a little way back, since rates are uncertain near a change point.
   subroutine go_from_turn_to_turn(continuation, drive, t, step)
      type(continuation_t), intent(inout) :: continuation
      integer, intent(in) :: drive               !< its number
      real(wp), intent(in) :: t                  !< time to which the motion goes
      type(step_record_t), intent(out) :: step   !< step_stands: `t` is at a singular position
      type(step_record_t) :: one
      type(continuation_state_t) :: first
      real(wp) :: turn, next

      first = continuation%continuation_state_t
      turn = continuation%t
      next = next_turn(continuation%path, drive, turn, t)
      associate (value => value_at(continuation%path, drive, turn))
         call go_to(next, value - sign(short_step/continuation%drives%unit(drive), value_at(continuation%path, drive, &
            next) - value))
      end associate
      if (one%ending /= step_there .or. passed_of(one) > 0) call restore(continuation, first)
      allocate (step%passed(0))
      do while (abs(t - turn) > 0.0_wp)
         next = next_turn(continuation%path, drive, turn, t)
         call go_to(next, value_at(continuation%path, drive, next))
         step%ending = one%ending
         if (one%ending < step_there) return
         if (allocated(one%passed)) step%passed = [step%passed, one%passed]
         turn = next
         if (one%ending == step_stands .and. abs(t - turn) > 0.0_wp) call revert(continuation, one)
      end do

   contains

      !> Follows the motion to a value of the drive, at a constant rate: the step `one`.
      subroutine go_to(to, value)
         real(wp), intent(in) :: to              !< time at which it has this value; it begins at the time `turn`
         real(wp), intent(in) :: value           !< rad or unit of length
         real(wp) :: now(3)

         now = drive_at(continuation%path, drive, continuation%t)
         call lead(continuation%path, drive, continuation%t, (value - now(1))/(to - turn), [turn, to])
         one = step_record_t()
         call resume_motion(continuation, turn, one)
         if (one%ending == step_there) call continue_to(continuation, to, one)
         if (one%ending == step_there .and. continuation%convergence%singular) one%ending = step_stands
         if (one%ending == step_there) call accept_substep(continuation, to)
      end subroutine go_to
   end subroutine go_from_turn_to_turn

   !> Makes the motion that is followed go on at another parameter of the path. The drives have the same values there.
   subroutine resume_motion(continuation, parameter, step)
      type(continuation_t), intent(inout) :: continuation
      real(wp), intent(in) :: parameter          !< of the path: time or a drive's value
      type(step_record_t), intent(inout) :: step !< step_there: the motion goes on; step_failed: not

      call begin_at(continuation%history, parameter)
      continuation%t = parameter
      call solve_at(continuation, parameter)
      step%ending = merge(step_there, step_failed, continuation%convergence%determinant_signs_kept &
         .and. is_solved(continuation%convergence) .and. .not. continuation%convergence%singular)
      if (step%ending == step_there) call accept_substep(continuation, parameter)
   end subroutine resume_motion

   !> Finds velocities and accelerations of the blocks that are regular at a singular position. The others keep their
   !> positions.
   subroutine solve_regular_blocks(continuation, t)
      type(continuation_t), intent(inout) :: continuation   !< its state stands there
      real(wp), intent(in) :: t                  !< time

      call set_drive_values(continuation%path, t, continuation%state)
      associate (moving => continuation%blocks%moving)
         call solve_blocks(continuation%blocks, continuation%geometry, &
            pack(moving, .not. continuation%state%is_singular(moving)), continuation%work, continuation%state, &
            continuation%convergence)
      end associate
      continuation%convergence%singular = .true.
   end subroutine solve_regular_blocks
end module change_point_passage
