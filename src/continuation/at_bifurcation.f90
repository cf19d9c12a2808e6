!> An instant exactly at a change point: its position is known in full, its velocities are not unique, since each of
!> the two branches has its own. And the passage through a change point at which the drive stops or turns.
module at_bifurcation
   use kinds, only: wp
   use drive_excursion, only: drive_excursion_t, largest_derivative
   use drives, only: law_t, new_law, drive_motion, bounds_t, bounds_of
   use mechanism, only: drive_t
   use motion, only: diagnostic_t
   use branch_requests, only: branch_requests_t
   use convergence, only: convergence_t, is_solved
   use block_method, only: solve_instant, max_rate
   use block_branches, only: extrapolate
   use following, only: following_t, step_record_t, place_t, continue_to, go_on_from, go_back, note_place, return_to
   implicit none
   private
   public :: stand_on, pass_standstill

   !> The steps before the change point, in radians and in the unit of length: the extrapolation leaves 0.0112 of
   !> their seventh power, and of the rounding ten times its part by a step.
   real(wp), parameter :: short_step = (100.0_wp*epsilon(1.0_wp))**0.125_wp
   !> A drive stops or turns where its rate is below this part of its largest; its values on the way are those at so
   !> many equal steps of time.
   real(wp), parameter :: almost_at_rest = 0.1_wp
   integer, parameter :: value_steps = 64

contains

   !> The motion at `t`, to which the `step` has led, on the branch that is followed, if `t` is a change point of that
   !> (`stands`); it is followed from shortly before. `list`: a diagnostic for each block that has its change point
   !> there.
   subroutine stand_on(f, t, step, list, stands)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(in) :: step
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      logical, intent(out) :: stands
      type(place_t) :: before
      type(branch_requests_t) :: branch_requests
      type(convergence_t) :: found

      allocate (list(0))
      stands = .false.
      if (.not. f%follows) return
      call go_back(f, step)
      call note_place(f, before)
      branch_requests = f%branch_requests
      found = f%convergence
      call come_near(f, t, stands)
      if (stands) call extrapolate(f%engine, t, list)
      stands = size(list) > 0
      f%convergence = found
      if (stands) return
      call return_to(f, before)
      f%branch_requests = branch_requests
   end subroutine stand_on

   !> Follows the motion to three places at equal steps before `t`.
   subroutine come_near(f, t, arrived)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      logical, intent(out) :: arrived
      type(step_record_t) :: step
      real(wp) :: h, fastest
      integer :: k

      h = abs(t - f%t)/3.0_wp
      fastest = max(max_rate(f%engine), min(largest_derivative(f%drives, 1, f%t, t), sqrt(huge(1.0_wp))))
      if (h*fastest > short_step) h = short_step/fastest
      h = sign(h, t - f%t)
      arrived = abs(h) > 0.0_wp
      do k = 3, 1, -1
         if (.not. arrived) return
         call continue_to(f, t - k*h, step)
         arrived = step%arrived .and. .not. f%convergence%singular
         if (arrived) call go_on_from(f, t - k*h)
      end do
   end subroutine come_near

   !> The `step` of the continuation to `t` has failed, or has ended at a position without velocities, since the one
   !> drive that moves stops or turns about there: followed by time, the motion comes ever closer to a change point and
   !> never across. So it is followed by the drive's value instead, at the values of equal steps of time: the position
   !> is a function of that, on a branch that goes through the change point. Then `step`%arrived; where `t` itself is at
   !> the change point, `step`%stands, and `list` says so as that of `stand_on`.
   subroutine pass_standstill(f, t, step, list)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      type(place_t) :: before, reached
      type(branch_requests_t) :: branch_requests
      type(convergence_t) :: found
      type(drive_excursion_t) :: drives
      type(law_t), allocatable :: laws(:)
      real(wp) :: near
      integer :: drive
      logical :: passed, stands

      allocate (list(0))
      if (.not. f%follows) return
      near = merge(t, f%t, step%arrived)
      laws = f%engine%laws
      drive = stopping_drive(laws, f%drives%first, f%drives%last, merge(f%place%t, f%t, step%tries > 1), near, t)
      if (drive == 0) return
      near = standstill(laws(drive), near, t)
      call note_place(f, reached)
      call go_back(f, step)
      call note_place(f, before)
      branch_requests = f%branch_requests
      found = f%convergence
      drives = f%drives
      call follow_by_value(f, laws, drive, near, t, step, list, passed, stands)
      f%drives = drives
      f%engine%laws = laws
      if (passed .and. .not. stands) call take_up(f, t, passed)
      step%stands = passed .and. stands
      step%arrived = passed .or. step%arrived
      if (passed .and. .not. stands) return
      f%t = merge(before%t, reached%t, passed)
      if (passed) then
         f%engine%followed_t = before%engine%followed_t
         return
      end if
      ! As the step has ended: that tells where the limit is, and which.
      f%engine%engine_state_t = reached%engine
      f%place = before
      deallocate (list)
      allocate (list(0))
      f%branch_requests = branch_requests
      f%convergence = found
   end subroutine pass_standstill

   !> The only drive whose value changes between the times `from` and `t`, if it is almost at rest at the time `near`;
   !> 0: none. `first`, `last`: all instants.
   pure integer function stopping_drive(laws, first, last, from, near, t) result(drive)
      type(law_t), intent(in) :: laws(:)
      real(wp), intent(in) :: first, last, from, near, t
      real(wp) :: f(3), rate
      integer :: i

      drive = 0
      do i = 1, size(laws)
         if (largest_rate_of(laws(i), from, t) <= 0.0_wp) cycle
         f = drive_motion(laws(i), near)
         rate = largest_rate_of(laws(i), min(first, near), max(last, near))
         if (drive > 0 .or. abs(f(2)) > almost_at_rest*rate .or. rate >= huge(1.0_wp)) then
            drive = 0
            return
         end if
         drive = i
      end do
   end function stopping_drive

   !> The first time from `near` to `t` at which `law` stands still or turns; `near` where there is none.
   pure real(wp) function standstill(law, near, t) result(high)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: near, t
      real(wp) :: f(3), low, middle, way
      integer :: i

      high = near
      f = drive_motion(law, near)
      way = f(2)
      do i = 1, value_steps
         low = high
         high = near + (t - near)*i/value_steps
         f = drive_motion(law, high)
         if (f(2)*way <= 0.0_wp) exit
      end do
      if (f(2)*way > 0.0_wp .or. abs(way) <= 0.0_wp) high = near
      if (abs(high - near) <= 0.0_wp) return
      do i = 1, digits(1.0_wp)
         middle = low + 0.5_wp*(high - low)
         f = drive_motion(law, middle)
         if (f(2)*way <= 0.0_wp) then
            high = middle
         else
            low = middle
         end if
      end do
   end function standstill

   !> Follows the motion to the value of `drive` at `t`, the other drives held; times are counted as if it passed the
   !> value that it has at `near` then, at its mean rate. `passed`: it came there; `stands`: at the change point itself.
   subroutine follow_by_value(f, laws, drive, near, t, step, list, passed, stands)
      type(following_t), intent(inout) :: f
      type(law_t), intent(in) :: laws(:)
      integer, intent(in) :: drive
      real(wp), intent(in) :: near, t
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable, intent(inout) :: list(:)
      logical, intent(out) :: passed, stands
      type(law_t) :: held(size(laws))
      type(step_record_t) :: one
      real(wp) :: value(3), at_near(3), rate, from, v, at
      integer :: i
      logical :: turned

      if (.not. allocated(step%passed)) allocate (step%passed(0))
      from = f%t
      at_near = drive_motion(laws(drive), near)
      rate = largest_rate_of(laws(drive), from, t)
      do i = 1, size(laws)
         value = drive_motion(laws(i), from)
         if (i == drive) v = near + (value(1) - at_near(1))/rate
         held(i) = straight_law(laws(i), value(1), 0.0_wp)
      end do
      held(drive) = straight_law(laws(drive), at_near(1) - rate*near, rate)
      f%engine%laws = held
      f%drives%laws = held
      ! The bounds that it knows are those of the deck's laws.
      f%drives%first = huge(1.0_wp)
      f%drives%last = -huge(1.0_wp)
      call take_up(f, v, passed)
      stands = .false.
      turned = .false.
      do i = 1, value_steps
         at = from + (t - from)*i/value_steps
         ! A limit short of the value at which the drive turns is passed by none of the others.
         if (.not. turned .and. (at - near)*(near - from) > 0.0_wp) then
            turned = .true.
            call go_to(near, .false.)
         end if
         call go_to(at, i == value_steps)
         if (.not. passed) return
      end do
      if (.not. stands) return
      call stand_on(f, v, one, list, passed)
      list%t = t

   contains

      !> Follows the motion to the value that the drive has `at` this time, the `last` or not.
      subroutine go_to(at, last)
         real(wp), intent(in) :: at
         logical, intent(in) :: last

         if (.not. passed) return
         value = drive_motion(laws(drive), at)
         v = near + (value(1) - at_near(1))/rate
         stands = .false.
         if (abs(v - f%t) <= 0.0_wp) return
         call continue_to(f, v, one)
         passed = one%arrived
         stands = passed .and. f%convergence%singular
         if (allocated(one%passed)) step%passed = [step%passed, one%passed]
         if (stands .and. .not. last) then
            call go_back(f, one)
         else if (passed .and. .not. stands) then
            call go_on_from(f, v)
         end if
      end subroutine go_to
   end subroutine follow_by_value

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
      if (passed) call go_on_from(f, t)
   end subroutine take_up

   !> The law `value` + `rate` t of the same drive.
   function straight_law(law, value, rate) result(straight)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: value, rate
      type(law_t) :: straight
      type(drive_t) :: drive

      drive = law%drive
      drive%polynomial = [value, rate, 0.0_wp]
      if (allocated(drive%terms)) deallocate (drive%terms)
      straight = new_law(drive)
   end function straight_law

   !> Bounds the rate of `law` between the times `from` and `to`.
   pure real(wp) function largest_rate_of(law, from, to) result(rate)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: from, to
      type(bounds_t) :: b

      b = bounds_of(law, from, to)
      rate = max(-b%low(1), b%high(1))
   end function largest_rate_of
end module at_bifurcation
