!> The path of the drives: value, rate and acceleration of each drive at a parameter of the motion. The parameter is the
!> time, except on a leg. On a leg one drive, the leader, moves with a constant rate from one value to another, and the
!> other drives are fixed. The parameter of a leg runs between the times at which the leader has the values of its ends.
!> Reason: a position depends only on the values of the drives, and a motion that comes to rest in time can go on by
!> value.
module drive_path
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: drive_t
   use drives, only: drive_motion, bounds_t, bounds_of, is_at_rest, halve, middle_of
   implicit none
   private
   public :: drive_path_t, drive_at, drive_bounds, value_at, moving_drives, slow_drive, next_turn, time_beside, &
      time_at_part, lead

   !> A drive is about to stop or to turn back if its rate is below this part of its largest rate nearby.
   real(wp), parameter :: almost_at_rest = 0.1_wp
   !> Equal steps of time in which a drive is searched for a change of direction: two turns within one are not seen.
   integer, parameter :: value_steps = 64
   !> Pivots at the ends of a substep give the position of a change point within this part of the substep.
   real(wp), parameter :: part_uncertainty = 1.0e-3_wp

   !> The laws of all drives and, on a leg, their linear motion.
   type :: drive_path_t
      type(drive_t), allocatable :: laws(:)       !< (drives) with their laws, functions of time
      real(wp), allocatable :: unit(:)            !< (drives) a value times this factor is in the solver's unit
      !> (2, drives) On a leg the values at the parameter p are leg(1, :) + leg(2, :) p; otherwise not allocated.
      real(wp), allocatable :: leg(:, :)
      real(wp) :: span(2) = 0.0_wp                !< times of the beginning and the end of the leg
   end type drive_path_t

contains

   !> Gives value, rate and acceleration (3) of a drive at a parameter, in the drive's unit (length or rad) and the
   !> deck's unit of time.
   pure function drive_at(path, i, parameter) result(f)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      integer, intent(in) :: i               !< number of the drive
      real(wp), intent(in) :: parameter      !< of the path, in the deck's unit of time
      real(wp) :: f(3)

      if (asserts) call assert(i >= 1 .and. i <= size(path%laws), 'drive_at: number of a drive')
      if (allocated(path%leg)) then
         f = [path%leg(1, i) + parameter*path%leg(2, i), path%leg(2, i), 0.0_wp]
      else
         f = drive_motion(path%laws(i), parameter)
      end if
   end function drive_at

   !> Gives the values (drives) of all drives at a parameter, in the drives' units (length or rad).
   pure function values_at(path, parameter) result(values)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      real(wp), intent(in) :: parameter      !< of the path, in the deck's unit of time
      real(wp) :: values(size(path%laws)), f(3)
      integer :: i

      do i = 1, size(values)
         f = drive_at(path, i, parameter)
         values(i) = f(1)
      end do
   end function values_at

   !> Finds true bounds of value, rate and acceleration of a drive between two parameters, in the drive's unit (length
   !> or rad) and the deck's unit of time.
   pure type(bounds_t) function drive_bounds(path, i, p1, p2) result(b)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      integer, intent(in) :: i               !< number of the drive
      real(wp), intent(in) :: p1, p2         !< parameters of the path in either order, in the deck's unit of time

      if (allocated(path%leg)) then
         b = bounds_of(drive_t(polynomial=[path%leg(:, i), 0.0_wp]), p1, p2, .false.)
      else
         b = bounds_of(path%laws(i), p1, p2, .false.)
      end if
   end function drive_bounds

   !> Gives the value (length or rad) of a drive at a time by its law, whether the path is on a leg or not.
   pure real(wp) function value_at(path, i, t)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      integer, intent(in) :: i               !< number of the drive
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3)

      f = drive_motion(path%laws(i), t)
      value_at = f(1)
   end function value_at

   !> Tells of each drive (drives) whether the drive moves between two parameters: on a leg only the leader does, and
   !> off a leg each drive that is not at rest by the bounds of its rate.
   pure function moving_drives(path, p1, p2) result(moves)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      real(wp), intent(in) :: p1, p2         !< parameters of the path in either order, in the deck's unit of time
      logical :: moves(size(path%laws))

      if (allocated(path%leg)) then
         moves = abs(path%leg(2, :)) > 0.0_wp
      else
         moves = .not. is_at_rest(path%laws, p1, p2)
      end if
   end function moving_drives

   !> Finds the number of the only drive that moves in an interval, if this drive is almost at rest at a time: its rate
   !> is small compared with its largest rate in a wider interval. Otherwise, on a leg, and if its rate has no bound: 0.
   pure integer function slow_drive(path, t1, t2, near, span) result(drive)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      real(wp), intent(in) :: t1, t2         !< times: the ends of the interval, in either order
      real(wp), intent(in) :: near           !< the time at which the drive may be almost at rest
      real(wp), intent(in) :: span(2)        !< times: the ends of the wider interval, increasing
      type(bounds_t) :: b
      real(wp) :: f(3)
      logical :: moves(size(path%laws))

      drive = 0
      moves = moving_drives(path, t1, t2)
      if (allocated(path%leg) .or. count(moves) /= 1) return
      drive = findloc(moves, .true., dim=1)
      f = drive_motion(path%laws(drive), near)
      b = bounds_of(path%laws(drive), min(span(1), near), max(span(2), near), .false.)
      if (abs(f(2)) > almost_at_rest*max(-b%low(1), b%high(1)) .or. any(b%high >= huge(1.0_wp))) drive = 0
   end function slow_drive

   !> Begins a leg of a path. The leader starts from its value at a parameter of the path, with a constant rate. The
   !> other drives keep their values at this parameter.
   subroutine lead(path, leader, parameter, rate, span)
      type(drive_path_t), intent(inout) :: path   !< the laws and, if the path is on one, the leg
      integer, intent(in) :: leader          !< number of the drive
      real(wp), intent(in) :: parameter      !< of the path so far, in the deck's unit of time
      real(wp), intent(in) :: rate           !< of the leader, length or rad per unit of time
      real(wp), intent(in) :: span(2)        !< times of the beginning and the end of the leg
      real(wp) :: leg(2, size(path%laws))

      leg(1, :) = values_at(path, parameter)
      leg(2, :) = 0.0_wp
      leg(:, leader) = [leg(1, leader) - rate*span(1), rate]
      path%leg = leg
      path%span = span
   end subroutine lead

   !> Finds the first time at which a drive turns back, or comes to rest before it turns back, by its law. If there is
   !> no such time, the result is `t`. The time is found by steps and bisection.
   pure real(wp) function next_turn(path, i, from, t) result(turn)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      integer, intent(in) :: i               !< number of the drive
      real(wp), intent(in) :: from, t        !< times: the turn is sought after `from`, up to `t`
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

   !> Finds the parameter of a path at which some drive has moved a distance from its value at `last`; `t` if no drive
   !> moves so far. The parameter is found by bisection, because bounds of the rate are too wide for it.
   pure real(wp) function time_beside(path, last, t, distance) result(beside)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      real(wp), intent(in) :: last, t        !< parameters of the path, unit of time: sought between them
      real(wp), intent(in) :: distance       !< above 0, in the solver's units
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

   !> Finds the time at which the drive with the longest way between two parameters has covered a part of this way, by
   !> its law. If the drive slows down near this time and then speeds up, its value does not give the time exactly: the
   !> result is then the time at which it is slowest, or at which it turns back between the parameters.
   pure real(wp) function time_at_part(path, p1, p2, part) result(at)
      type(drive_path_t), intent(in) :: path !< the laws and, if the path is on one, the leg
      real(wp), intent(in) :: p1, p2         !< parameters of the path, in the deck's unit of time
      real(wp), intent(in) :: part           !< part of the way, from 0 to 1
      real(wp), dimension(size(path%laws)) :: start, way
      real(wp) :: span(2), low, high, first(3), last(3)
      integer :: i, k

      start = values_at(path, p1)
      way = values_at(path, p2) - start
      i = maxloc(abs(path%unit*way), dim=1)
      span = [p1, p2]
      if (allocated(path%leg)) span = path%span

      at = time_of(part)
      first = drive_at(path, i, p1)
      last = drive_at(path, i, p2)
      low = merge(p1, time_of(part - part_uncertainty), first(2)*last(2) < 0.0_wp)
      high = merge(p2, time_of(part + part_uncertainty), first(2)*last(2) < 0.0_wp)
      if (.not. slows_down(low) .or. slows_down(high)) return
      do k = 1, digits(1.0_wp)
         call halve(slows_down(middle_of(low, high)), low, high)
      end do
      at = high

   contains

      !> Finds the time at which drive `i` has covered a part of its way, by bisection of its law over `span`.
      pure real(wp) function time_of(part) result(t)
         real(wp), intent(in) :: part        !< part of the way, from about 0 to 1
         real(wp) :: before
         integer :: k

         before = span(1)
         t = span(2)
         do k = 1, digits(1.0_wp)
            call halve((value_at(path, i, middle_of(before, t)) - (start(i) + part*way(i)))*way(i) < 0.0_wp, before, t)
         end do
      end function time_of

      !> Tells whether the speed of drive `i` falls at a time, in the direction of the motion through `span`.
      pure logical function slows_down(t)
         real(wp), intent(in) :: t           !< time
         real(wp) :: f(3)

         f = drive_motion(path%laws(i), t)
         slows_down = f(2)*f(3)*(span(2) - span(1)) < 0.0_wp
      end function slows_down
   end function time_at_part
end module drive_path
