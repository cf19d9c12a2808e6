!> The way back from a dead point or change point, on one of two branches, and the passage through a change point at
!> which the drive stops or turns.
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

   !> The distance from a singular position, back from it, at which a motion by the value of a drive begins, in radians
   !> and characteristic lengths: far enough for exact rates, near enough for the same branch.
   real(wp), parameter :: short_step = (100.0_wp*epsilon(1.0_wp))**0.125_wp
   !> After an instant at a singular position the motion takes the other branch when a drive has gone so far, in rad or
   !> units of its block: the branches are still close there, and no longer singular.
   real(wp), parameter :: drive_change_after_rest = 1.0e-5_wp

contains

   !> Leaves the singular position of the last instant, for a motion that goes back from there. If there are BRANCH
   !> cards, the motion is then followed on the branch that they select, from shortly after that instant. If it cannot
   !> be followed to there, it stays where it was.
   subroutine leave(continuation, last, t, blocks, list)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      real(wp), intent(in) :: last               !< time of the last instant, in the deck's unit
      real(wp), intent(in) :: t                  !< time to which the motion goes, in the deck's unit
      integer, intent(in) :: blocks(:)           !< numbers of the blocks that are singular there
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

   !> Follows the motion to a time: by time or, if that fails, by the value of a drive.
   subroutine follow(continuation, t, step, list)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      real(wp), intent(in) :: t                  !< the time, in the deck's unit
      type(step_record_t), intent(inout) :: step !< a new record; then how the step ended
      !> Its change points, allocated if the step by value ends at a singular position.
      type(diagnostic_t), allocatable, intent(inout) :: list(:)

      call continue_to(continuation, t, step)
      if (step%ending < step_there) call go_by_value(continuation, t, step, list)
   end subroutine follow

   !> Follows the motion by the value of the one drive that moves, from turn to turn, after a step by time that has
   !> failed or ended at a position without velocities. Reason: the drive stops or turns near there, and by time the
   !> motion comes ever closer to the singular position and never across. If the step by value fails too, or several
   !> drives move, all stays.
   subroutine go_by_value(continuation, t, step, list)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      real(wp), intent(in) :: t                  !< time to which the motion goes, in the deck's unit
      type(step_record_t), intent(inout) :: step !< of the step by time; then step_there, or step_stands
      type(diagnostic_t), allocatable, intent(out) :: list(:)   !< change points at `t`; not allocated: none
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
      ! The state in which the step by time has ended tells which limit there is, and where.
      if (by_value%ending < step_there) call restore(continuation, reached)
      continuation%place = before
      if (by_value%ending < step_there) return
      step%ending = step_there
      step%passed = by_value%passed
      if (by_value%ending == step_there) return
      list = change_diagnostics(continuation%blocks, continuation%geometry, continuation%state, t)
      call solve_regular_blocks(continuation, t)
      ! A dead point at which the drive turns is a change point by time, though not by value.
      if (size(list) == 0) list = change_diagnostics(continuation%blocks, continuation%geometry, continuation%state, t)
      if (size(list) > 0) step%ending = step_stands
      call follow_from(continuation, before)
   end subroutine go_by_value

   !> Follows the motion to the value of a drive at `t`, with fixed other drives, from one value at which the drive
   !> turns to the next. It begins a little way back, since rates are uncertain near a change point.
   subroutine go_from_turn_to_turn(continuation, drive, t, step)
      type(continuation_t), intent(inout) :: continuation   !< then on a leg of its path
      integer, intent(in) :: drive               !< the number of the drive
      real(wp), intent(in) :: t                  !< time to which the motion goes, in the deck's unit
      type(step_record_t), intent(out) :: step   !< how it ended; step_stands: `t` is at a singular position
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

      !> Follows the motion to a value of the drive, at a constant rate, and records the step in `one`.
      subroutine go_to(to, value)
         real(wp), intent(in) :: to              !< time at which the drive has this value; the leg begins at `turn`
         real(wp), intent(in) :: value           !< of the drive, rad or deck's unit of length
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

   !> Puts the motion that is followed at another parameter of its path, where the drives have the values of the last
   !> position, and solves for its rates by this parameter.
   subroutine resume_motion(continuation, parameter, step)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      real(wp), intent(in) :: parameter          !< of the path, in the deck's unit of time
      type(step_record_t), intent(inout) :: step !< step_there: the motion goes on; step_failed: it does not

      call begin_at(continuation%history, parameter)
      continuation%t = parameter
      call solve_at(continuation, parameter)
      step%ending = merge(step_there, step_failed, continuation%convergence%determinant_signs_kept &
         .and. is_solved(continuation%convergence) .and. .not. continuation%convergence%singular)
      if (step%ending == step_there) call accept_substep(continuation, parameter)
   end subroutine resume_motion

   !> Solves for position, velocities and accelerations of the blocks that are regular at a singular position. Singular
   !> blocks keep their positions.
   subroutine solve_regular_blocks(continuation, t)
      type(continuation_t), intent(inout) :: continuation   !< with a state at the singular position
      real(wp), intent(in) :: t                  !< parameter of the path there, in the deck's unit of time

      call set_drive_values(continuation%path, t, continuation%state)
      associate (moving => continuation%blocks%moving)
         call solve_blocks(continuation%blocks, continuation%geometry, &
            pack(moving, .not. continuation%state%is_singular(moving)), continuation%work, continuation%state, &
            continuation%convergence)
      end associate
      continuation%convergence%singular = .true.
   end subroutine solve_regular_blocks
end module change_point_passage
