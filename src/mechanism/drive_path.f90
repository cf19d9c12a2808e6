!> The path of the drives: value, rate and acceleration of each at a parameter of the motion. The parameter is the time.
!> On a leg it stands for the value of one drive, the leader, which goes evenly from one value to another; the other
!> drives are held. A position is a function of the values alone: a motion that comes to a standstill in time can go on
!> by value. The parameter of a leg runs through the times between which the leader has the values of its ends.
module drive_path
   use kinds, only: wp
   use mechanism, only: drive_t
   use drives, only: drive_motion, bounds_t, bounds_of, is_at_rest, halve, middle_of
   implicit none
   private
   public :: drive_path_t, drive_at, drive_bounds, value_at, moving_drives, slow_drive, next_turn, time_beside, &
      time_at_part, lead

   !> A drive stops or turns where its rate is below this part of its largest; its values on the way are those at so
   !> many equal steps of time.
   real(wp), parameter :: almost_at_rest = 0.1_wp
   integer, parameter :: value_steps = 64
   !> The pivots at the ends of a substep tell where between them the change point is, but for this part.
   real(wp), parameter :: not_told = 1.0e-3_wp

   type :: drive_path_t
      type(drive_t), allocatable :: laws(:)       !< (drives) functions of time
      real(wp), allocatable :: unit(:)            !< (drives) factor of their values in the solver's equations
      !> (2, drives) On a leg the values at the parameter p are leg(1, :) + leg(2, :) p; otherwise not allocated.
      real(wp), allocatable :: leg(:, :)
      real(wp) :: span(2) = 0.0_wp                !< times of the ends of the leg
   end type drive_path_t

contains

   !> Value, rate and acceleration (3) of drive number `i` at the `parameter`, in the drive's unit (length or rad) and
   !> that of the parameter.
   pure function drive_at(path, i, parameter) result(f)
      type(drive_path_t), intent(in) :: path
      integer, intent(in) :: i
      real(wp), intent(in) :: parameter
      real(wp) :: f(3)

      if (allocated(path%leg)) then
         f = [path%leg(1, i) + parameter*path%leg(2, i), path%leg(2, i), 0.0_wp]
      else
         f = drive_motion(path%laws(i), parameter)
      end if
   end function drive_at

   !> The values (drives) at the `parameter`, in the drives' units (length or rad).
   pure function values_at(path, parameter) result(values)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: parameter
      real(wp) :: values(size(path%laws)), f(3)
      integer :: i

      do i = 1, size(values)
         f = drive_at(path, i, parameter)
         values(i) = f(1)
      end do
   end function values_at

   !> The bounds of drive number `i` between the parameters `p1` and `p2`, in either order.
   pure type(bounds_t) function drive_bounds(path, i, p1, p2) result(b)
      type(drive_path_t), intent(in) :: path
      integer, intent(in) :: i
      real(wp), intent(in) :: p1, p2

      if (allocated(path%leg)) then
         b = bounds_of(drive_t(polynomial=[path%leg(:, i), 0.0_wp]), p1, p2)
      else
         b = bounds_of(path%laws(i), p1, p2)
      end if
   end function drive_bounds

   !> The value (length or rad) that drive number `i` has at the time `t`, on a leg or not.
   pure real(wp) function value_at(path, i, t)
      type(drive_path_t), intent(in) :: path
      integer, intent(in) :: i
      real(wp), intent(in) :: t
      real(wp) :: f(3)

      f = drive_motion(path%laws(i), t)
      value_at = f(1)
   end function value_at

   !> (drives) Those that move between the parameters `p1` and `p2`, see `is_at_rest`.
   pure function moving_drives(path, p1, p2) result(moves)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: p1, p2
      logical :: moves(size(path%laws))

      if (allocated(path%leg)) then
         moves = abs(path%leg(2, :)) > 0.0_wp
      else
         moves = .not. is_at_rest(path%laws, p1, p2)
      end if
   end function moving_drives

   !> The number of the only drive that moves between the times `t1` and `t2`, if it is almost at rest at the time
   !> `near` by its rates in the times of `span`; otherwise 0.
   pure integer function slow_drive(path, t1, t2, near, span) result(drive)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: t1, t2, near, span(2)
      type(bounds_t) :: b
      real(wp) :: f(3)
      logical :: moves(size(path%laws))

      drive = 0
      moves = moving_drives(path, t1, t2)
      if (allocated(path%leg) .or. count(moves) /= 1) return
      drive = findloc(moves, .true., dim=1)
      f = drive_motion(path%laws(drive), near)
      b = bounds_of(path%laws(drive), min(span(1), near), max(span(2), near))
      if (abs(f(2)) > almost_at_rest*max(-b%low(1), b%high(1)) .or. any(b%high >= huge(1.0_wp))) drive = 0
   end function slow_drive

   !> Begins a leg over the times of `span`, on which drive number `leader` has this `rate` (of its value, by the time)
   !> from its value at the `parameter` on; the others keep their values there.
   subroutine lead(path, leader, parameter, rate, span)
      type(drive_path_t), intent(inout) :: path
      integer, intent(in) :: leader
      real(wp), intent(in) :: parameter, rate, span(2)
      real(wp) :: leg(2, size(path%laws))

      leg(1, :) = values_at(path, parameter)
      leg(2, :) = 0.0_wp
      leg(:, leader) = [leg(1, leader) - rate*span(1), rate]
      path%leg = leg
      path%span = span
   end subroutine lead

   !> The first time after `from`, up to `t`, at which drive number `i` turns back, or rests before it does; else `t`.
   pure real(wp) function next_turn(path, i, from, t) result(turn)
      type(drive_path_t), intent(in) :: path
      integer, intent(in) :: i
      real(wp), intent(in) :: from, t
      real(wp) :: f(3), low, way
      integer :: k

      f = drive_motion(path%laws(i), from)
      way = f(2)
      turn = from
      do k = 1, value_steps
         low = turn
         turn = from + (t - from)*k/value_steps
         f = drive_motion(path%laws(i), turn)
         if (abs(way) <= 0.0_wp) way = f(2)
         if (f(2)*way < 0.0_wp) exit
      end do
      if (k > value_steps) turn = t
      if (k > value_steps) return
      do k = 1, digits(1.0_wp)
         f = drive_motion(path%laws(i), middle_of(low, turn))
         call halve(f(2)*way > 0.0_wp, low, turn)
      end do
   end function next_turn

   !> The time on the way from `last` to `t` at which some drive has gone `distance` from its value at `last`, in the
   !> solver's units; `t` if none does. Bounds of the rate are too coarse for that.
   pure real(wp) function time_beside(path, last, t, distance) result(beside)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: last, t, distance
      real(wp) :: high
      integer :: k

      beside = last
      high = t
      do k = 1, digits(1.0_wp)
         call halve(all(abs(values_at(path, middle_of(beside, high)) - values_at(path, last))*path%unit <= distance), &
            beside, high)
      end do
      if (abs(t - high) <= 0.0_wp) beside = t
   end function time_beside

   !> The time at which the fastest drive has made this `part` of its way between the parameters `p1` and `p2`, by its
   !> law. If it is so slow there that its value does not give the time, it is the one until which it slows down.
   pure real(wp) function time_at_part(path, p1, p2, part) result(at)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: p1, p2, part
      real(wp), dimension(size(path%laws)) :: start, way
      real(wp) :: span(2), low, high
      integer :: i, k

      start = values_at(path, p1)
      way = values_at(path, p2) - start
      i = maxloc(abs(path%unit*way), dim=1)
      span = [p1, p2]
      if (allocated(path%leg)) span = path%span
      at = time_of(part)
      low = time_of(part - not_told)
      high = time_of(part + not_told)
      if (.not. slows_down(low) .or. slows_down(high)) return
      do k = 1, digits(1.0_wp)
         call halve(slows_down(middle_of(low, high)), low, high)
      end do
      at = high

   contains

      !> The time at which the drive has made this `part` of its way.
      pure real(wp) function time_of(part) result(t)
         real(wp), intent(in) :: part
         real(wp) :: before
         integer :: k

         before = span(1)
         t = span(2)
         do k = 1, digits(1.0_wp)
            call halve((value_at(path, i, middle_of(before, t)) - (start(i) + part*way(i)))*way(i) < 0.0_wp, before, t)
         end do
      end function time_of

      !> Whether the speed of the drive falls at the time `t`.
      pure logical function slows_down(t)
         real(wp), intent(in) :: t
         real(wp) :: f(3)

         f = drive_motion(path%laws(i), t)
         slows_down = f(2)*f(3)*(span(2) - span(1)) < 0.0_wp
      end function slows_down
   end function time_at_part
end module drive_path
