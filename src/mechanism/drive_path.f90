!> The path of the drives: value, rate and acceleration of each at a parameter of the motion. The parameter is the time.
!> On a leg the parameter stands for the value of one drive, the leader, which goes evenly from one value to another;
!> the other drives are held. A position depends only on the values of the drives: a motion that comes to rest in time
!> can go on by value. The parameter of a leg runs through the times between which the leader has the values of its
!> ends.
module drive_path
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: drive_t
   use drives, only: drive_motion, bounds_t, bounds_of, is_at_rest, halve, middle_of
   implicit none
   private
   public :: drive_path_t, drive_at, drive_bounds, value_at, moving_drives, slow_drive, next_turn, time_beside, &
      time_at_part, lead

   !> A drive is about to stop or to turn back if its rate is below this part of its largest rate.
   real(wp), parameter :: almost_at_rest = 0.1_wp
   !> Equal steps of time on the way of a drive, at whose ends it is looked whether the drive has turned back.
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

   !> Gives value, rate and acceleration (3) of a drive at a parameter, in the drive's unit (length or rad) and the unit
   !> of the parameter.
   pure function drive_at(path, i, parameter) result(f)
      type(drive_path_t), intent(in) :: path
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
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: parameter      !< of the path, in the deck's unit of time
      real(wp) :: values(size(path%laws)), f(3)
      integer :: i

      do i = 1, size(values)
         f = drive_at(path, i, parameter)
         values(i) = f(1)
      end do
   end function values_at

   !> Finds the bounds of value, rate and acceleration of a drive between two parameters.
   pure type(bounds_t) function drive_bounds(path, i, p1, p2) result(b)
      type(drive_path_t), intent(in) :: path
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
      type(drive_path_t), intent(in) :: path
      integer, intent(in) :: i               !< number of the drive
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3)

      f = drive_motion(path%laws(i), t)
      value_at = f(1)
   end function value_at

   !> Tells of each drive (drives) whether it moves between two parameters, by `is_at_rest`.
   pure function moving_drives(path, p1, p2) result(moves)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: p1, p2         !< parameters of the path in either order, in the deck's unit of time
      logical :: moves(size(path%laws))

      if (allocated(path%leg)) then
         moves = abs(path%leg(2, :)) > 0.0_wp
      else
         moves = .not. is_at_rest(path%laws, p1, p2)
      end if
   end function moving_drives

   !> Finds the number of the only drive that moves in an interval, if that drive is almost at rest at a time; otherwise
   !> 0. Its rate is compared with its largest rate in a wider interval.
   pure integer function slow_drive(path, t1, t2, near, span) result(drive)
      type(drive_path_t), intent(in) :: path
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

   !> Begins a leg. The leader starts at its value at a parameter of the path, with a constant rate. The other drives
   !> keep their values there.
   subroutine lead(path, leader, parameter, rate, span)
      type(drive_path_t), intent(inout) :: path
      integer, intent(in) :: leader          !< number of the drive
      real(wp), intent(in) :: parameter      !< of the path before, in the deck's unit of time
      real(wp), intent(in) :: rate           !< of the leader, length or rad by the unit of time
      real(wp), intent(in) :: span(2)        !< times of the beginning and the end of the leg
      real(wp) :: leg(2, size(path%laws))

      leg(1, :) = values_at(path, parameter)
      leg(2, :) = 0.0_wp
      leg(:, leader) = [leg(1, leader) - rate*span(1), rate]
      path%leg = leg
      path%span = span
   end subroutine lead

   !> Finds the first time at which a drive turns back, or comes to rest before it turns back; without one, `t`.
   pure real(wp) function next_turn(path, i, from, t) result(turn)
      type(drive_path_t), intent(in) :: path
      integer, intent(in) :: i               !< number of the drive
      real(wp), intent(in) :: from, t        !< times between which it is sought: after `from`, up to `t`
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

   !> Finds the time at which some drive has gone a distance from its value at `last`; `t` if no drive does. Bounds of
   !> the rate are too coarse to find it.
   pure real(wp) function time_beside(path, last, t, distance) result(beside)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: last, t        !< parameters of the path between which it is sought
      real(wp), intent(in) :: distance       !< in the solver's units
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

   !> Finds the time at which the fastest drive has made a part of its way between two parameters, by its law. If the
   !> drive is so slow there that its value does not give the time, or turns back on the way, at its dead point, it is
   !> the time until which the drive slows down.
   pure real(wp) function time_at_part(path, p1, p2, part) result(at)
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: p1, p2         !< parameters of the path, in the deck's unit of time
      real(wp), intent(in) :: part           !< of the way, from 0 to 1
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
      low = merge(p1, time_of(part - not_told), first(2)*last(2) < 0.0_wp)
      high = merge(p2, time_of(part + not_told), first(2)*last(2) < 0.0_wp)
      if (.not. slows_down(low) .or. slows_down(high)) return
      do k = 1, digits(1.0_wp)
         call halve(slows_down(middle_of(low, high)), low, high)
      end do
      at = high

   contains

      !> Finds the time at which the drive has made a part of its way.
      pure real(wp) function time_of(part) result(t)
         real(wp), intent(in) :: part        !< of the way, from about 0 to 1
         real(wp) :: before
         integer :: k

         before = span(1)
         t = span(2)
         do k = 1, digits(1.0_wp)
            call halve((value_at(path, i, middle_of(before, t)) - (start(i) + part*way(i)))*way(i) < 0.0_wp, before, t)
         end do
      end function time_of

      !> Tells whether the speed of the drive falls at a time.
      pure logical function slows_down(t)
         real(wp), intent(in) :: t           !< time
         real(wp) :: f(3)

         f = drive_motion(path%laws(i), t)
         slows_down = f(2)*f(3)*(span(2) - span(1)) < 0.0_wp
      end function slows_down
   end function time_at_part
end module drive_path
