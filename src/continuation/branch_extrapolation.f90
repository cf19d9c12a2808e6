!> The position at a change point itself. Its equations leave it open to the root of the rounding, 1E-8;
!> the branch that is followed goes through it smoothly, so that three motions before it give it in full.
module branch_extrapolation
   use kinds, only: wp
   use convergence, only: convergence_t, is_solved
   use predictor, only: predict, is_even
   use block_state, only: set_values
   use block_rank, only: gauss_newton_step
   use block_solver, only: solve_block
   use block_engine, only: block_engine_t, set_drive_values
   implicit none
   private
   public :: extrapolate

   !> The position found from the equations, and that extrapolated, are the same where they differ by less.
   real(wp), parameter :: same_place = 64.0_wp*sqrt(epsilon(1.0_wp))

contains

   !> The position at `t`, of the blocks that are `singular` there extrapolated from three motions at equal steps
   !> before it. `smooth`: there are such blocks, and where they are found from their equations is the same.
   subroutine extrapolate(e, t, singular, smooth)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(out) :: singular(:), smooth
      type(convergence_t) :: c
      real(wp), allocatable :: x(:)
      real(wp) :: change, far
      integer :: k

      singular = .false.
      smooth = is_even(e%history, t - e%history%t(e%history%place(0)))
      if (.not. smooth) return
      call set_drive_values(e, t)
      call predict(e%history, t, e%state%u, change)
      do k = 1, size(e%moving)
         associate (i => e%moving(k), u => e%blocks%unknown)
            x = e%state%u(u(e%blocks%list(i)%first:e%blocks%list(i)%last))%value
            call solve_block(e%blocks, i, e%tolerance, e%work, e%state, c, change)
            smooth = smooth .and. is_solved(c)
            if (.not. smooth) return
            if (e%blocks%list(i)%direct) cycle
            e%is_singular(i) = c%singular
            if (.not. c%singular) cycle
            singular(i) = .true.
            associate (found => e%state%u(u(e%blocks%list(i)%first:e%blocks%list(i)%last)))
               smooth = maxval(abs(found%value - x)) <= same_place
               ! Off the direction that the equations leave open they are exact.
               call set_values(e%blocks, i, x, e%state)
               call gauss_newton_step(e%blocks, i, e%state, far)
               smooth = smooth .and. maxval(abs(found%value - x)) <= same_place
            end associate
         end associate
      end do
      smooth = smooth .and. any(singular)
   end subroutine extrapolate
end module branch_extrapolation
