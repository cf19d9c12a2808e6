!> The links at the dead points of circuits: those that card RANGE finds there, from the middle of each branch.
module circuit_limits
   use kinds, only: wp
   use planar, only: without_turns
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use drives, only: new_law, drive_motion
   use circuit_curve, only: curve_t, drive_value, deck_position
   use circuit_branches, only: circuits_t, branch_t
   use ranges, only: range_t, find_range, low, high
   implicit none
   private
   public :: name_limits, held_at

   !> A limit found by both methods is one up to this difference, in rad and lengths.
   real(wp), parameter :: agrees = max(1.0e-6_wp, 1.0e3_wp*epsilon(1.0_wp))

contains

   !> Names the links at the dead points of `m`. Drives that are held have their values of the time `t`.
   subroutine name_limits(m, t, found)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t
      type(circuits_t), intent(inout) :: found
      type(mechanism_t) :: held
      type(motion_t) :: middle
      type(range_t) :: r
      integer :: b, side

      held = held_at(m, t)
      middle = new_motion(size(m%links))
      do b = 1, size(found%branches)
         if (all(found%branches(b)%dead == 0) .or. found%list(found%branches(b)%circuit)%rests) cycle
         if (all(found%dead(pack(found%branches(b)%dead, found%branches(b)%dead > 0))%limit%links(1) > 0)) cycle
         call set_middle(found, found%branches(b), held, middle)
         call find_range(held, middle, found%drive, r)
         do side = low, high
            if (found%branches(b)%dead(side) == 0 .or. .not. r%has_limit(side)) cycle
            associate (dead => found%dead(found%branches(b)%dead(side))%limit)
               if (dead%links(1) > 0 .or. abs(off_by(found%curve, r%limit(side)%value - dead%value)) > agrees) cycle
               r%limit(side)%value = dead%value
               dead = r%limit(side)
            end associate
         end do
      end do
   end subroutine name_limits

   !> `m` with all drives at rest at their values of the time `t`.
   function held_at(m, t) result(held)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t
      type(mechanism_t) :: held
      real(wp) :: f(3)
      integer :: i

      held = m
      do i = 1, size(m%drives)
         f = drive_motion(new_law(m%drives(i)), t)
         held%drives(i)%polynomial = [f(1), 0.0_wp, 0.0_wp]
         if (allocated(held%drives(i)%terms)) deallocate (held%drives(i)%terms)
      end do
   end function held_at

   !> Puts `middle` where the drive moves the fastest on branch `b`, with the drive of `held` there.
   subroutine set_middle(found, b, held, middle)
      type(circuits_t), intent(in) :: found
      type(branch_t), intent(in) :: b
      type(mechanism_t), intent(inout) :: held
      type(motion_t), intent(inout) :: middle
      integer :: k

      associate (points => found%list(b%circuit)%points)
         k = b%first - 1 + maxloc(abs(points(b%first:b%last)%value(1)), dim=1)
         middle%position = deck_position(found%curve, points(k)%q)
         held%drives(found%drive)%polynomial(1) = drive_value(found%curve, points(k)%value(0))
      end associate
   end subroutine set_middle

   !> A difference `x` of the drive's values in rad, without whole turns, or in lengths of the curve.
   pure real(wp) function off_by(c, x)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: x

      off_by = x/c%closure%length
      if (c%is_angle) off_by = without_turns(x)
   end function off_by
end module circuit_limits
