!> Card RANGE: the interval of each drive in which the assembly of the first instant exists, the other drives held. The
!> motion is followed both ways, by the drive's value instead of time, until it ends. The motion of a drive of an angle
!> also ends after whole turns at which every link has its first position.
module ranges
   use kinds, only: wp
   use system_calls, only: signal_received
   use plane_vectors, only: pi
   use mechanism, only: mechanism_t, request_t, method_newton, plane_origin
   use motion, only: motion_t, new_motion, diagnostic_t, diagnostic_limit, diagnostic_change, diagnostic_close
   use separations, only: motions_apart, closes
   use drives, only: drive_motion
   use drive_path, only: lead
   use scales, only: is_length, characteristic_length
   use cylinders, only: cylinders_of
   use analysis, only: analysis_t, make_analysis, advance
   implicit none
   private
   public :: range_t, find_range, held_at, estimate_side, lower_end, upper_end

   !> Steps along the drive, in rad or characteristic lengths.
   real(wp), parameter :: step_of_angle = pi/36.0_wp, step_of_length = 0.05_wp
   !> A drive is followed so far each way, in turns or characteristic lengths.
   integer, parameter :: max_turns = 12
   real(wp), parameter :: max_lengths = 100.0_wp
   !> The shortest step, in rad or characteristic lengths, with which an end is searched for if no limit is known.
   !> Rounding leaves an error of about the root of a rounding there, and a try that fails takes as long as a long run.
   real(wp), parameter :: nearest_try = max(1.0e-7_wp, 64.0_wp*sqrt(epsilon(1.0_wp)))
   !> The ends of a range.
   integer, parameter :: lower_end = 1, upper_end = 2

   !> The range of a drive. An end without a limit is the last value to which the drive was followed.
   type :: range_t
      integer :: part = 1                   !< number of its independent mechanism
      integer :: drive = 0                  !< number of the drive in that mechanism
      logical :: is_all = .false.           !< the drive turns fully, and the motion closes
      integer :: turns = 0                  !< turns after which the motion closes
      logical :: is_of_branch = .false.     !< the first instant has no position: of a branch by card CIRCUITS
      integer :: change_points = 0          !< passed on the smooth branch, both ways
      logical :: has_limit(2) = .false.     !< (low:high)
      type(diagnostic_t) :: limit(2)        !< (low:high) of the kind diagnostic_limit: links, the drive's value
   end type range_t

contains

   !> Finds the range of a drive of a mechanism; the other drives keep their values.
   subroutine find_range(m, start, drive, range)
      type(mechanism_t), intent(in) :: m     !< one independent mechanism
      type(motion_t), intent(in) :: start    !< at its first instant, with a position
      integer, intent(in) :: drive           !< number of the drive
      type(range_t), intent(out) :: range    !< gets both ends; if the drive turns fully, only the lower one
      type(mechanism_t) :: d
      real(wp) :: unit
      integer :: side

      range%drive = drive
      d = held_at(m, start%t)
      call estimate_side(d, start%position)
      unit = 1.0_wp
      if (is_length(m%drives(drive))) unit = characteristic_length(m)
      do side = lower_end, upper_end
         call follow(d, merge(-unit, unit, side == lower_end), side, range)
         if (range%is_all) return
      end do
   end subroutine find_range

   !> Makes a mechanism with all drives at rest at their values of a time, by METHOD NEWTON, with all links asked for.
   function held_at(m, t) result(held)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t              !< time
      type(mechanism_t) :: held
      real(wp) :: f(3)
      integer :: i

      held = m
      held%method = method_newton
      held%tolerance = 0.0_wp
      held%requests = [(request_t(subject=i), i=1, size(m%links))]
      if (allocated(held%branch_requests)) deallocate (held%branch_requests)
      do i = 1, size(m%drives)
         f = drive_motion(m%drives(i), t)
         held%drives(i)%polynomial = [f(1), 0.0_wp, 0.0_wp]
         if (allocated(held%drives(i)%terms)) deallocate (held%drives(i)%terms)
      end do
   end function held_at

   !> Gives the moving links of a mechanism an estimated position.
   subroutine estimate_side(m, position)
      type(mechanism_t), intent(inout) :: m
      real(wp), intent(in) :: position(:, :)   !< (3, links) x, y in the deck's unit from the origin of `m`, phi in rad
      integer :: i

      do i = 1, size(m%links)
         if (.not. m%links(i)%ground) m%links(i)%position = position(:, i) + [plane_origin(m), 0.0_wp]
      end do
   end subroutine estimate_side

   !> Follows the motion of a mechanism by the value of a drive to its end on one side. At the parameter t the drive has
   !> moved by t times its rate. If the first position is not found, the end is the drive's first value.
   subroutine follow(turned, rate, side, range)
      type(mechanism_t), intent(in) :: turned   !< all drives rest
      real(wp), intent(in) :: rate           !< of the drive by the parameter, in rad or the deck's length
      integer, intent(in) :: side            !< lower_end or upper_end
      type(range_t), intent(inout) :: range   !< of a known drive; gets the end on that side, and `is_all`
      type(analysis_t) :: a
      type(motion_t) :: first, now
      real(wp) :: value, t, step, part, apart(3)
      integer :: i, k, steps_a_turn, begin
      logical :: is_angle, grows

      is_angle = .not. is_length(turned%drives(range%drive))
      step = merge(step_of_angle, step_of_length, is_angle)
      steps_a_turn = nint(2.0_wp*pi/step_of_angle)
      first = new_motion(size(turned%links))
      now = first
      call make_analysis(a, turned)
      a%geometry%cylinders = cylinders_of(turned, .true.)

      value = turned%drives(range%drive)%polynomial(1)
      call lead(a%path, range%drive, 0.0_wp, rate, [0.0_wp, 1.0_wp])
      call advance(a, 0.0_wp, first)
      range%limit(side) = diagnostic_t(kind=diagnostic_limit, drive=range%drive, is_angle=is_angle, value=value)
      if (first%known < 0) return

      ! Through a position without velocities, as at a change point, there is more than one motion: the next one counts.
      begin = merge(0, -1, first%known == 2)
      do k = 1, nint(merge(2.0_wp*pi*max_turns, max_lengths, is_angle)/step)
         if (signal_received() > 0) return
         t = step*k
         call advance(a, t, now)
         if (allocated(now%diagnostics)) range%change_points = range%change_points &
            + count(now%diagnostics%kind == diagnostic_change .and. .not. now%diagnostics%here)
         if (now%known < 0) then
            ! Close to a change point rounding leaves no limit: from the time to which the motion was followed it goes
            ! on by longer steps, then by shorter ones.
            t = a%t
            i = last_of(now, diagnostic_close)
            if (i > 0) t = now%diagnostics(i)%t
            part = nearest_try
            grows = .true.
            do while (last_of(now, diagnostic_limit) == 0 .and. part >= nearest_try .and. signal_received() == 0)
               call advance(a, t + part, now)
               grows = grows .and. now%known >= 0 .and. part < step
               if (now%known >= 0) t = t + part
               part = merge(2.0_wp, 0.5_wp, grows)*part
            end do
            range%has_limit(side) = .true.
            range%limit(side)%value = value + rate*t
            i = last_of(now, diagnostic_limit)
            if (i > 0) range%limit(side) = now%diagnostics(i)
            return
         end if

         if (.not. is_angle .or. now%known < 2) cycle
         if (begin < 0) then
            begin = k
            first = now
            cycle
         end if
         if (mod(k - begin, steps_a_turn) /= 0) cycle
         apart = motions_apart(turned, first, now)
         ! The drive has one rate: at its first position the mechanism has its first velocity.
         range%is_all = closes(apart(:2))
         range%turns = (k - begin)/steps_a_turn
         if (range%is_all) return
      end do
      range%limit(side)%value = value + rate*t
   end subroutine follow

   !> Finds the number of the last diagnostic of a kind; 0 if there is none.
   pure integer function last_of(q, kind) result(i)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: kind            !< diagnostic_limit, ...

      i = 0
      if (allocated(q%diagnostics)) i = findloc(q%diagnostics%kind, kind, dim=1, back=.true.)
   end function last_of
end module ranges
