!> Change points, where two branches of a block's motion cross: how they are known, and how they are passed.
!>
!> Just beyond a change point, at the position x on the branch that goes on smoothly, the Jacobian J has one small
!> singular value s, with w and k on its left and right: to second order along k
!>    w . r(x + a k) = a s + a^2 q/2,   q = w . r''[k, k],
!> so that the other branch is at a = -2 s/q, and there the determinant has the sign that it had before.
module change_points
   use kinds, only: wp
   use diagnostics, only: diagnostic_t, new_diagnostic, diagnostic_change, diagnostic_dead_end
   use convergence, only: convergence_t, is_solved
   use block_state, only: set_values
   use block_rank, only: min_direction, residual_of
   use block_engine, only: block_engine_t, solve_again
   use block_diagnostics, only: links_of
   use branch_requests, only: branch_requests_t, are_there, decide
   implicit none
   private
   public :: crosses, pass

   !> Over a step this short, in radians and lengths, a determinant that changes its sign although the prediction
   !> was right to so small a part of the step tells a change point. Circuits that pass each other at the distance
   !> d are told from one that crosses another where d^2 is above the product of the two, 1E-14.
   real(wp), parameter :: short_step = max(1.0e-4_wp, 0.75_wp*sqrt(sqrt(epsilon(1.0_wp))))
   real(wp), parameter :: right_part = max(1.0e-6_wp, 0.7_wp*epsilon(1.0_wp)**0.375_wp), max_wrong = 1.0e-2_wp
   real(wp), parameter :: rounding = 500.0_wp*epsilon(1.0_wp)
   !> The step of the second difference, and the largest distance at which the other branch is looked for.
   real(wp), parameter :: trial = max(1.0e-4_wp, sqrt(sqrt(epsilon(1.0_wp)))), furthest = 0.05_wp
   !> Equations that are too many are satisfied there, not only to the second order in the distance.
   real(wp), parameter :: small_substep = 0.01_wp

contains

   !> The motion found last lies beyond change points, on the branch that goes on smoothly; `correction`: of its
   !> prediction, which rounding has made wrong by bend/pivot^2, as it does the rates so close to it.
   pure logical function crosses(e, correction)
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: correction
      real(wp) :: allowed
      integer :: i

      crosses = e%change <= short_step
      do i = 1, size(e%crossed)
         if (.not. (e%crossed(i) .and. crosses)) cycle
         allowed = right_part + rounding*e%blocks%list(i)%lipschitz/e%pivot_of(i)**2
         crosses = correction <= min(allowed, max_wrong)*e%change
      end do
   end function crosses

   !> Passes the change points before `t`, each as `decisions` has it; `list`: a remark for each. `passed`: the
   !> motion found last, with its record `c`, is that which goes on; otherwise the list tells why there is none.
   subroutine pass(e, t, decisions, c, list, passed)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(branch_requests_t), intent(inout) :: decisions
      type(convergence_t), intent(inout) :: c
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      logical, intent(out) :: passed
      type(diagnostic_t) :: r
      logical :: other, crossed(size(e%crossed))
      integer :: k

      allocate (list(0))
      passed = .true.
      crossed = e%crossed
      do k = 1, size(e%moving)
         associate (i => e%moving(k), before => e%history%t(e%history%place(0)))
            if (.not. crossed(i)) cycle
            r = place_of(e, i, t)
            if (are_there(decisions)) then
               call decide(decisions, i, links_of(e, i), before, t, r%t, other)
               if (other) call take_other(e, i, c, passed)
               r%other = other
            end if
            if (.not. passed) r%kind = diagnostic_dead_end
         end associate
         list = [list, r]
         if (.not. passed) return
      end do
   end subroutine pass

   !> Where block `i` has passed a change point on the way to `t`: the least pivot goes through zero in proportion.
   type(diagnostic_t) function place_of(e, i, t) result(r)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i
      real(wp), intent(in) :: t

      r = new_diagnostic(diagnostic_change, links_of(e, i))
      associate (before => e%history%t(e%history%place(0)), a => e%pivot_of(i), b => e%pivot_now(i))
         r%t = before + (t - before)*(a/(a + b))
      end associate
   end function place_of

   !> Puts block `i` on its other branch, and what builds on it after it. The motion before is no guide to what comes.
   subroutine take_other(e, i, c, found)
      type(block_engine_t), intent(inout) :: e
      integer, intent(in) :: i
      type(convergence_t), intent(inout) :: c
      logical, intent(out) :: found
      real(wp) :: direction(e%blocks%list(i)%shape%n), left(e%blocks%list(i)%shape%rows), x(e%blocks%list(i)%shape%n)
      real(wp) :: least, lipschitz, away, correction
      logical :: same, crossed(size(e%crossed))

      crossed = e%crossed
      x = e%state%u(e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))%value
      call min_direction(e%blocks, i, e%state, least, left, direction)
      lipschitz = second_difference()
      found = abs(lipschitz)*furthest > 2.0_wp*least
      if (.not. found) return
      away = -2.0_wp*least/lipschitz
      call set_values(e%blocks, i, x + away*direction, e%state)
      call solve_again(e, c, correction, same)
      crossed(i) = .false.
      same = .not. any(e%crossed .and. .not. crossed)
      found = is_solved(c) .and. same .and. .not. c%singular .and. correction <= 0.5_wp*abs(away) &
         .and. c%closure_error <= small_substep*abs(lipschitz)*away**2
      e%history%filled = 0

   contains

      !> w . r''[k, k]
      real(wp) function second_difference() result(second)
         real(wp), dimension(e%blocks%list(i)%shape%rows) :: ahead, here, behind

         here = residual_of(e%blocks, i, x, e%state)
         ahead = residual_of(e%blocks, i, x + trial*direction, e%state)
         behind = residual_of(e%blocks, i, x - trial*direction, e%state)
         second = dot_product(left, ahead - here + (behind - here))/trial**2
      end function second_difference
   end subroutine take_other
end module change_points
