!> What the continuation and the error estimate take of the block engine.
module block_method
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use motion, only: motion_t
   use drives, only: law_t, bounds_t, bounds_of, joints_of
   use block_engine, only: block_engine_t, mark_singular_links
   use singularity, only: judge_position
   use block_diagnostics, only: singular_links
   implicit none
   private
   public :: is_at_rest, get_link_flags, max_rate, growth_of_roundings, growth_of_angles

   !> With smaller pivots everything is in doubt.
   real(wp), parameter :: smallest_pivot = epsilon(1.0_wp)**2
   !> A digit of a rate is worth so many of an angle, at least.
   real(wp), parameter :: rate_digits = 6.0_wp
   !> What a block knows may be so many times as large as its own vectors before its roundings count for more.
   real(wp), parameter :: usual_coarse = 16.0_wp
   !> A time may be off a joint of a law by this part of the joints' times.
   real(wp), parameter :: joint_part = 4096.0_wp*max(epsilon(1.0_wp), real(epsilon(1.0_dp), wp))

contains

   !> The drive of `law` does not move between the times `t1` and `t2`, by the bounds of its rate; or, if they are
   !> equal, from that time on. A time about at a joint counts as after the first joint and before the last.
   elemental logical function is_at_rest(law, t1, t2)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: t1, t2
      type(bounds_t) :: b
      real(wp) :: width, from

      ! A law without joints rests always or never.
      width = joint_part*maxval(abs([t1, t2, joints_of(law%drive)]))
      if (.not. width > 0.0_wp) width = 1.0_wp
      from = min(t1, t2) + width
      b = bounds_of(law, from, max(max(t1, t2) - width, from + width))
      is_at_rest = b%low(1) >= 0.0_wp .and. b%high(1) <= 0.0_wp
   end function is_at_rest

   !> Tells which links have velocities in the motion `found` last, where not all have, and what the singular position
   !> is. `all_at_once`: all equations are solved at once, and have one Jacobian.
   subroutine get_link_flags(e, found, all_at_once)
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(inout) :: found
      logical, intent(in) :: all_at_once
      integer :: i

      call mark_singular_links(e, found, all_at_once)
      call judge_position(e, found%singularity, i)
      if (i > 0) found%singular_links = singular_links(e, i)
   end subroutine get_link_flags

   !> The largest rate of an unknown of the motion that is followed.
   pure real(wp) function max_rate(e)
      type(block_engine_t), intent(in) :: e

      associate (h => e%history)
         max_rate = max(0.0_wp, maxval(abs(h%past(h%predicted)%rate(0))))
      end associate
   end function max_rate

   !> By how much a rounding grows at most in a block, whose numbers are the characteristic ones. Where a block knows
   !> much larger vectors than its own, their roundings count.
   pure real(wp) function growth_of_roundings(e) result(growth)
      type(block_engine_t), intent(in) :: e
      real(wp) :: inverse
      integer :: k

      growth = 0.0_wp
      do k = 1, size(e%needed)
         associate (block => e%blocks%numbers%blocks(e%needed(k)))
            if (e%blocks%list(e%needed(k))%direct) cycle
            inverse = 1.0_wp/pivot_of(e, e%needed(k))
            growth = max(growth, block%lipschitz*inverse**2)
            if (block%coarse > usual_coarse) &
               growth = max(growth, block%coarse*inverse*max(1.0_wp, block%lipschitz*inverse))
         end associate
      end do
   end function growth_of_roundings

   !> The same of an angle's rounding, in positions or, over `rate_digits`, in accelerations: with 1/p for the inverse
   !> of the Jacobian and L for its Lipschitz constant 1/p, L/p^2 and L^2/p^3.
   pure real(wp) function growth_of_angles(e) result(growth)
      type(block_engine_t), intent(in) :: e
      real(wp) :: inverse
      integer :: k

      growth = 1.0_wp
      do k = 1, size(e%needed)
         associate (block => e%blocks%numbers%blocks(e%needed(k)))
            if (e%blocks%list(e%needed(k))%direct) cycle
            inverse = 1.0_wp/pivot_of(e, e%needed(k))
            growth = max(growth, block%coarse*inverse*max(1.0_wp, (block%lipschitz*inverse)**2/rate_digits))
         end associate
      end do
   end function growth_of_angles

   !> The least pivot of block `i`, 1 at most; roundings do not grow by less.
   pure real(wp) function pivot_of(e, i) result(pivot)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i

      pivot = max(min(1.0_wp, e%found(i)%pivot), smallest_pivot)
   end function pivot_of
end module block_method
