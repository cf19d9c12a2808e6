!> An instant that lies exactly on a change point: its position is told in full, its velocities do not
!> exist, since each of the two branches has its own.
module at_bifurcation
   use kinds, only: wp
   use drive_excursion, only: largest_rate
   use diagnostics, only: diagnostic_t, new_diagnostic, diagnostic_change
   use branch_extrapolation, only: extrapolate
   use block_diagnostics, only: links_of
   use branch_requests, only: branch_requests_t
   use convergence, only: convergence_t
   use following, only: following_t, step_record_t, place_t, continue_to, go_on_from, go_back, note_place, return_to
   implicit none
   private
   public :: stand_on

   !> The steps before the change point, in radians and in the unit of length: the extrapolation leaves 0.0112 of
   !> their seventh power, and of the rounding ten times its part by a step.
   real(wp), parameter :: step = (100.0_wp*epsilon(1.0_wp))**0.125_wp

contains

   !> The motion at `t`, to which the way `w` has led, as the branch that is followed has it, if `t` is a change
   !> point of that (`stands`); it is followed from short before. `list`: a remark for each block that has its change
   !> point there.
   subroutine stand_on(f, t, w, list, stands)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(in) :: w
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      logical, intent(out) :: stands
      type(place_t) :: before
      type(branch_requests_t) :: branch_requests
      type(convergence_t) :: found
      logical, allocatable :: singular(:)
      integer :: i

      allocate (list(0))
      stands = .false.
      if (.not. (f%follows .and. allocated(f%engine%blocks))) return
      call go_back(f, w)
      call note_place(f, before)
      branch_requests = f%branch_requests
      found = f%convergence
      call come_near(f, t, stands)
      if (stands) then
         allocate (singular(size(f%engine%blocks%blocks%list)))
         call extrapolate(f%engine%blocks, t, singular, stands)
      end if
      f%convergence = found
      if (.not. stands) then
         call return_to(f, before)
         f%branch_requests = branch_requests
         return
      end if
      do i = 1, size(singular)
         if (.not. singular(i)) cycle
         list = [list, new_diagnostic(diagnostic_change, links_of(f%engine%blocks, i))]
         list(size(list))%t = t
         list(size(list))%here = .true.
      end do
   end subroutine stand_on

   !> Follows the motion to three places at equal steps before `t`.
   subroutine come_near(f, t, arrived)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      logical, intent(out) :: arrived
      type(step_record_t) :: w
      real(wp) :: h, fastest
      integer :: k

      associate (history => f%engine%blocks%history)
         fastest = maxval(abs(history%rate(history%sought, history%place(0))))
      end associate
      h = abs(t - f%t)/3.0_wp
      fastest = max(fastest, min(largest_rate(f%drives, f%t, t), sqrt(huge(1.0_wp))))
      if (h*fastest > step) h = step/fastest
      h = sign(h, t - f%t)
      arrived = abs(h) > 0.0_wp
      do k = 3, 1, -1
         if (.not. arrived) return
         call continue_to(f, t - k*h, w)
         arrived = w%arrived .and. .not. f%convergence%singular
         if (arrived) call go_on_from(f, t - k*h)
      end do
   end subroutine come_near
end module at_bifurcation
