!> The way back from a dead point or change point, for which there are two branches, and the passage through a change
!> point at which the drive stops or turns.
module change_point_passage
   use kinds, only: wp
   use drive_path, only: drive_at, value_at, slow_drive, next_turn, time_beside, lead
   use motion, only: diagnostic_t, diagnostic_dead_end
   use convergence, only: is_solved
   use predictor, only: begin_at
   use branch_switching, only: switch_branch, decide
   use block_diagnostics, only: change_diagnostics, diagnostic_at_change, links_of
   use following, only: following_t, step_record_t, step_there, step_stands, place_t, solve_at, continue_to, &
      accept_substep, revert, follow_from, record_checkpoint, restore, passed_of
   implicit none
   private
   public :: leave, go_by_value

   !> So far back from a singular position the motion begins by the value of a drive, in radians and in the unit of
   !> length: far enough for rates, near enough for the same branch.
   real(wp), parameter :: short_step = (100.0_wp*epsilon(1.0_wp))**0.125_wp
   !> After an instant at a singular position the motion takes the other branch when a drive has gone so far, in the
   !> units of the blocks: the branches are still close there, and no longer singular.
   real(wp), parameter :: drive_change_after_rest = 1.0e-5_wp

contains

   !> Leaves the singular position of the last instant, for a motion that goes back from there. If there are BRANCH
   !> cards, it is then followed on the branch that they select, from shortly after that instant.
   subroutine leave(following, last, t, blocks, list)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: last               !< time of the last instant
      real(wp), intent(in) :: t                  !< time to which the motion goes
      integer, intent(in) :: blocks(:)           !< numbers of the blocks that stand there
      type(diagnostic_t), allocatable, intent(out) :: list(:)   !< (blocks); diagnostic_dead_end: no branch is found
      type(place_t) :: before
      type(step_record_t) :: step
      type(diagnostic_t), allocatable :: at_end(:)
      real(wp) :: beside
      logical :: found
      integer :: k

      allocate (list(size(blocks)))
      do k = 1, size(blocks)
         list(k) = diagnostic_at_change(following%blocks, following%geometry, blocks(k), last)
         list(k)%returns = .true.
      end do
      if (size(following%branch_requests%cards) == 0) return

      beside = time_beside(following%path, last, t, drive_change_after_rest)
      following%branch_requests%stood_until = beside
      call record_checkpoint(following, before)
      call continue_to(following, beside, step)
      if (step%ending < step_there) call go_by_value(following, beside, step, at_end)
      if (step%ending < step_there .or. passed_of(step) > 0 .or. following%convergence%singular) then
         call restore(following, before)
         return
      end if
      call accept_substep(following, beside)
      do k = 1, size(blocks)
         call decide(following%branch_requests, blocks(k), links_of(following%blocks, following%geometry, blocks(k)), &
            last, beside, last, list(k)%other)
         if (.not. list(k)%other) cycle
         call switch_branch(following%blocks, following%geometry, following%history, following%work, following%state, &
            blocks(k), following%convergence, found)
         if (found) then
            call accept_substep(following, beside)
         else
            list(k)%kind = diagnostic_dead_end
            following%place = before
            return
         end if
      end do
   end subroutine leave

   !> Follows the motion by the value of the one drive that moves, from turn to turn, if the step by time has failed or
   !> has ended at a position without velocities. Reason: the drive stops or turns about there. By time the motion comes
   !> ever closer to a singular position and never across.
   subroutine go_by_value(following, t, step, list)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: t                  !< time to which the motion goes
      type(step_record_t), intent(inout) :: step !< of the continuation to `t`; it arrives, or stands on a change point
      type(diagnostic_t), allocatable, intent(out) :: list(:)   !< allocated if `t` is at a singular position
      type(place_t) :: before, reached
      type(diagnostic_t), allocatable :: passed(:)
      integer :: drive
      logical :: arrived, stands

      if (.not. following%follows) return
      drive = slow_drive(following%path, merge(following%place%t, following%t, step%tries > 1), t, &
         merge(t, following%t, step%ending >= step_there), [following%drives%first, following%drives%last])
      if (drive == 0) return

      call record_checkpoint(following, reached)
      call revert(following, step)
      call record_checkpoint(following, before)
      call go_from_turn_to_turn(following, drive, t, passed, arrived, stands)
      deallocate (following%path%leg)
      if (arrived .and. .not. stands) call resume_motion(following, t, arrived)
      following%place = before
      if (.not. arrived) then
         ! As the step has ended: that tells where the limit is, and which.
         call restore(following, reached)
         following%place = before
         return
      end if
      step%ending = step_there
      step%passed = passed
      if (.not. stands) return
      list = change_diagnostics(following%blocks, following%geometry, following%state, t)
      if (size(list) > 0) step%ending = step_stands
      call follow_from(following, before)
   end subroutine go_by_value

   !> Follows the motion to the value of a drive at `t`, the other drives held, from one place at which the drive turns
   !> to the next. It begins a little way back, since rates are uncertain near a change point.
   subroutine go_from_turn_to_turn(following, drive, t, passed, arrived, stands)
      type(following_t), intent(inout) :: following
      integer, intent(in) :: drive               !< its number
      real(wp), intent(in) :: t                  !< time to which the motion goes
      type(diagnostic_t), allocatable, intent(out) :: passed(:)   !< change points on the way
      logical, intent(out) :: arrived            !< it has come to `t`,
      logical, intent(out) :: stands             !< and `t` is at a singular position
      type(step_record_t) :: one
      type(place_t) :: first
      real(wp) :: turn, next

      call record_checkpoint(following, first)
      turn = following%t
      next = next_turn(following%path, drive, turn, t)
      associate (value => value_at(following%path, drive, turn))
         call go_to(next, value - sign(short_step/following%drives%unit(drive), value_at(following%path, drive, &
            next) - value))
      end associate
      if (.not. arrived .or. stands .or. passed_of(one) > 0) call restore(following, first)
      allocate (passed(0))
      do while (abs(t - turn) > 0.0_wp)
         next = next_turn(following%path, drive, turn, t)
         call go_to(next, value_at(following%path, drive, next))
         if (.not. arrived) return
         if (allocated(one%passed)) passed = [passed, one%passed]
         turn = next
         if (stands .and. abs(t - turn) > 0.0_wp) call revert(following, one)
      end do

   contains

      !> Follows the motion to a value of the drive, at a constant rate.
      subroutine go_to(to, value)
         real(wp), intent(in) :: to              !< time at which it has this value; it begins at the time `turn`
         real(wp), intent(in) :: value           !< rad or unit of length
         real(wp) :: now(3)

         now = drive_at(following%path, drive, following%t)
         call lead(following%path, drive, following%t, (value - now(1))/(to - turn), [turn, to])
         call resume_motion(following, turn, arrived)
         stands = .false.
         if (.not. arrived) return
         call continue_to(following, to, one)
         arrived = one%ending >= step_there
         stands = arrived .and. following%convergence%singular
         if (arrived .and. .not. stands) call accept_substep(following, to)
      end subroutine go_to
   end subroutine go_from_turn_to_turn

   !> Makes the motion that is followed go on at another parameter of the path. The drives have the same values there.
   subroutine resume_motion(following, parameter, passed)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: parameter          !< of the path: time or a drive's value
      logical, intent(out) :: passed             !< it does

      call begin_at(following%history, parameter)
      following%t = parameter
      call solve_at(following, parameter)
      passed = following%convergence%keeps_signs .and. is_solved(following%convergence) &
         .and. .not. following%convergence%singular
      if (passed) call accept_substep(following, parameter)
   end subroutine resume_motion
end module change_point_passage
