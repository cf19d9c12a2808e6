!> An instant exactly at a change point: its position is known in full, its velocities are not unique, since each of
!> the two branches has its own.
module at_bifurcation
   use kinds, only: wp
   use drive_excursion, only: largest_rate
   use diagnostics, only: diagnostic_t
   use branch_requests, only: branch_requests_t
   use convergence, only: convergence_t
   use engine, only: engine_t
   use block_method, only: block_method_t
   use block_branches, only: extrapolate
   use following, only: following_t, step_record_t, place_t, continue_to, go_on_from, go_back, note_place, return_to
   implicit none
   private
   public :: stand_on

   !> The steps before the change point, in radians and in the unit of length: the extrapolation leaves 0.0112 of
   !> their seventh power, and of the rounding ten times its part by a step.
   real(wp), parameter :: short_step = (100.0_wp*epsilon(1.0_wp))**0.125_wp

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
      if (.not. f%follows .or. max_rate(f%engine) < 0.0_wp) return
      call go_back(f, step)
      call note_place(f, before)
      branch_requests = f%branch_requests
      found = f%convergence
      call come_near(f, t, stands)
      select type (e => f%engine)
      class is (block_method_t)
         if (stands) call extrapolate(e%block_engine_t, t, list)
      end select
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
      fastest = max(max_rate(f%engine), min(largest_rate(f%drives, f%t, t), sqrt(huge(1.0_wp))))
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

   !> The largest rate of an unknown of the motion that `e` follows; -1.0 of an engine that knows no change points.
   pure real(wp) function max_rate(e)
      class(engine_t), intent(in) :: e

      max_rate = -1.0_wp
      select type (e)
      class is (block_method_t)
         max_rate = e%max_rate()
      end select
   end function max_rate
end module at_bifurcation
