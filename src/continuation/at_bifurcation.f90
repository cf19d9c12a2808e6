!> The way back from a dead point or change point, for which there are two branches, and the passage through a change
!> point at which the drive stops or turns.
module at_bifurcation
   use kinds, only: wp
   use drive_excursion, only: drive_excursion_t
   use drives, only: drive_motion, bounds_t, bounds_of, is_at_rest, halve, middle_of
   use mechanism, only: drive_t
   use motion, only: diagnostic_t, diagnostic_dead_end
   use convergence, only: is_solved
   use block_engine, only: block_engine_t
   use first_instant, only: solve_instant
   use block_branches, only: take_other_branch, decide
   use block_diagnostics, only: change_diagnostics, diagnostic_at_change, links_of
   use following, only: following_t, step_record_t, place_t, continue_to, go_on_from, go_back, note_place, return_to, &
      passed_of
   implicit none
   private
   public :: leave, go_by_value, time_beside

   !> How far back from a singular position the motion begins by the value of a drive, in radians and in the unit of
   !> length: far enough for rates, near enough for the same branch.
   real(wp), parameter :: short_step = (100.0_wp*epsilon(1.0_wp))**0.125_wp
   !> A drive stops or turns where its rate is below this part of its largest; its values on the way are those at so
   !> many equal steps of time.
   real(wp), parameter :: almost_at_rest = 0.1_wp
   integer, parameter :: value_steps = 64
   !> After an instant at a singular position the motion takes the other branch where a drive has gone so far, in the
   !> units of the blocks: the branches are still close there, and no longer singular.
   real(wp), parameter :: leaving = 1.0e-5_wp

contains

   !> Leaves the singular position of the last instant, at the time `last`, at which the `blocks` stand, towards `t`. If
   !> there are BRANCH cards and the motion goes back from there, it is then followed from shortly after on the branch
   !> that they select. `list`: a diagnostic for each block, for a motion that goes back; diagnostic_dead_end: the
   !> branch of a card is not found.
   subroutine leave(f, last, t, blocks, list)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: last, t
      integer, intent(in) :: blocks(:)
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      type(place_t) :: before
      type(step_record_t) :: step
      type(diagnostic_t), allocatable :: at_end(:)
      real(wp) :: beside
      logical :: found
      integer :: k

      allocate (list(size(blocks)))
      do k = 1, size(blocks)
         list(k) = diagnostic_at_change(f%engine, blocks(k), last)
         list(k)%returns = .true.
      end do
      if (size(f%branch_requests%cards) == 0) return

      beside = time_beside(f%engine, last, t, leaving)
      f%branch_requests%stood_until = beside
      call note_place(f, before)
      call continue_to(f, beside, step)
      if (.not. step%arrived) call go_by_value(f, beside, step, at_end)
      if (.not. step%arrived .or. passed_of(step) > 0 .or. f%convergence%singular) then
         call return_to(f, before)
         return
      end if
      call go_on_from(f, beside)
      do k = 1, size(blocks)
         call decide(f%branch_requests, blocks(k), links_of(f%engine, blocks(k)), last, beside, last, list(k)%other)
         if (.not. list(k)%other) cycle
         call take_other_branch(f%engine, blocks(k), f%convergence, found)
         if (found) then
            call go_on_from(f, beside)
         else
            list(k)%kind = diagnostic_dead_end
            f%place = before
            return
         end if
      end do
   end subroutine leave

   !> The `step` of the continuation to `t` has failed, or has ended at a position without velocities, since the one
   !> drive that moves stops or turns about there: followed by time, the motion comes ever closer to a singular position
   !> and never across. So it is followed by the drive's value instead, from turn to turn: the position is a function of
   !> that. Then `step`%arrived; where `t` itself is at a singular position, `list` is that of
   !> `change_diagnostics`, and at a change point `step`%stands. Otherwise `list` is not allocated.
   subroutine go_by_value(f, t, step, list)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      type(place_t) :: before, reached
      type(drive_excursion_t) :: drives
      type(diagnostic_t), allocatable :: passed(:)
      type(bounds_t) :: b
      real(wp) :: now(3), near
      integer :: drive
      logical :: moves(size(f%engine%laws)), arrived, stands

      if (.not. f%follows) return
      ! The only drive that moves, if it is almost at rest there.
      moves = .not. is_at_rest(f%engine%laws, merge(f%place%t, f%t, step%tries > 1), t)
      if (count(moves) /= 1) return
      drive = findloc(moves, .true., dim=1)
      near = merge(t, f%t, step%arrived)
      now = drive_motion(f%engine%laws(drive), near)
      b = bounds_of(f%engine%laws(drive), min(f%drives%first, near), max(f%drives%last, near))
      if (abs(now(2)) > almost_at_rest*max(-b%low(1), b%high(1)) .or. any(b%high >= huge(1.0_wp))) return

      call note_place(f, reached)
      call go_back(f, step)
      call note_place(f, before)
      drives = f%drives
      f%engine%timed = f%engine%laws
      ! The bounds that it knows are those of the deck's laws.
      f%drives%first = huge(1.0_wp)
      f%drives%last = -huge(1.0_wp)
      call go_from_turn_to_turn(f, drive, t, passed, list, arrived, stands)
      f%drives = drives
      call move_alloc(f%engine%timed, f%engine%laws)
      if (arrived .and. .not. stands) call take_up(f, t, arrived)
      step%arrived = arrived .or. step%arrived
      ! As the step has ended: that tells where the limit is, and which.
      if (.not. arrived) call return_to(f, reached)
      f%place = before
      if (.not. arrived) return
      step%passed = passed
      if (.not. stands) return
      step%stands = size(list) > 0
      f%t = before%t
      f%engine%followed_t = before%engine%followed_t
   end subroutine go_by_value

   !> Follows the motion to the value of `drive` at `t`, the other drives held, from one place at which it turns to the
   !> next. It begins a little way back, since rates are uncertain close to a change point. `passed`: change points on
   !> the way; `arrived`: it came there; `stands`: at a singular position, and `list` says which.
   subroutine go_from_turn_to_turn(f, drive, t, passed, list, arrived, stands)
      type(following_t), intent(inout) :: f
      integer, intent(in) :: drive
      real(wp), intent(in) :: t
      type(diagnostic_t), allocatable, intent(out) :: passed(:)
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      logical, intent(out) :: arrived, stands
      type(step_record_t) :: one
      type(place_t) :: first
      real(wp) :: turn, next
      integer :: i

      do i = 1, size(f%engine%laws)
         f%engine%laws(i) = straight_law(f%engine%timed(i), value_at(f%engine%timed(i), f%t), 0.0_wp)
      end do
      call note_place(f, first)
      allocate (passed(0))
      turn = f%t
      next = next_turn(f%engine%timed(drive), turn, t)
      associate (law => f%engine%timed(drive))
         call go_to(next, value_at(law, turn) - sign(short_step/f%drives%unit(drive), &
            value_at(law, next) - value_at(law, turn)))
      end associate
      if (.not. arrived .or. stands .or. size(passed) > 0) call return_to(f, first)
      passed = [diagnostic_t ::]
      turn = first%t
      do while (abs(t - turn) > 0.0_wp)
         next = next_turn(f%engine%timed(drive), turn, t)
         call go_to(next, value_at(f%engine%timed(drive), next))
         if (.not. arrived) return
         turn = next
         if (stands .and. abs(t - turn) > 0.0_wp) call go_back(f, one)
      end do
      if (stands) list = change_diagnostics(f%engine, t)
      arrived = .true.

   contains

      !> Follows the motion to this `value` of the drive, in as much time as from `turn` to the time `to`.
      subroutine go_to(to, value)
         real(wp), intent(in) :: to, value
         real(wp) :: before, rate

         before = value_at(f%engine%laws(drive), f%t)
         rate = (value - before)/(to - turn)
         f%engine%laws(drive) = straight_law(f%engine%timed(drive), before - rate*turn, rate)
         f%drives%laws = f%engine%laws
         f%engine%timed_span = [turn, to]
         call take_up(f, turn, arrived)
         stands = .false.
         if (.not. arrived) return
         call continue_to(f, to, one)
         arrived = one%arrived
         if (allocated(one%passed)) passed = [passed, one%passed]
         stands = arrived .and. f%convergence%singular
         if (arrived .and. .not. stands) call go_on_from(f, to)
      end subroutine go_to
   end subroutine go_from_turn_to_turn

   !> The time on the way from `last` to `t` at which some drive of the `engine` has gone `distance` from its value at
   !> `last`, in the units of the blocks; `t` if none does. Bounds of the rate are too coarse for that.
   pure real(wp) function time_beside(engine, last, t, distance) result(beside)
      type(block_engine_t), intent(in) :: engine
      real(wp), intent(in) :: last, t, distance
      real(wp) :: high
      integer :: i, k

      beside = last
      high = t
      do i = 1, digits(1.0_wp)
         call halve(all([(abs(value_at(engine%laws(k), middle_of(beside, high)) - value_at(engine%laws(k), last)) &
            *engine%unit_of(k), k=1, size(engine%laws))] <= distance), beside, high)
      end do
      if (abs(t - high) <= 0.0_wp) beside = t
   end function time_beside

   !> The value of `law` at the time `t`.
   pure real(wp) function value_at(law, t)
      type(drive_t), intent(in) :: law
      real(wp), intent(in) :: t
      real(wp) :: f(3)

      f = drive_motion(law, t)
      value_at = f(1)
   end function value_at

   !> The first time after `from`, up to `t`, at which `law` turns back, or rests before it does; otherwise `t`.
   pure real(wp) function next_turn(law, from, t) result(turn)
      type(drive_t), intent(in) :: law
      real(wp), intent(in) :: from, t
      real(wp) :: f(3), low, way
      integer :: i

      f = drive_motion(law, from)
      way = f(2)
      turn = from
      do i = 1, value_steps
         low = turn
         turn = from + (t - from)*i/value_steps
         f = drive_motion(law, turn)
         if (abs(way) <= 0.0_wp) way = f(2)
         if (f(2)*way < 0.0_wp) exit
      end do
      turn = merge(turn, t, i <= value_steps)
      if (i > value_steps) return
      do i = 1, digits(1.0_wp)
         f = drive_motion(law, middle_of(low, turn))
         call halve(f(2)*way > 0.0_wp, low, turn)
      end do
   end function next_turn

   !> The motion that is followed becomes that at the time `t`, where the drives have the same values. `passed`: so it
   !> does.
   subroutine take_up(f, t, passed)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      logical, intent(out) :: passed

      f%engine%history%t(0) = t
      f%engine%history%filled = 1
      f%t = t
      call solve_instant(f%engine, t, .true., f%convergence)
      passed = f%convergence%keeps_signs .and. is_solved(f%convergence) .and. .not. f%convergence%singular
      ! The rates remembered are those of another law.
      f%engine%history%filled = 0
      if (passed) call go_on_from(f, t)
   end subroutine take_up

   !> The law `value` + `rate` t of the same drive.
   function straight_law(law, value, rate) result(straight)
      type(drive_t), intent(in) :: law
      real(wp), intent(in) :: value, rate
      type(drive_t) :: straight

      straight = law
      straight%polynomial = [value, rate, 0.0_wp]
      if (allocated(straight%terms)) deallocate (straight%terms)
   end function straight_law
end module at_bifurcation
