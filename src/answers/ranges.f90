!> Card RANGE: the interval of each drive in which the assembly of the first instant lives, the other drives held. The
!> motion is followed both ways, by the drive's value instead of time, until it ends or, where a drive of an angle has
!> made whole turns, every link is where it was.
module ranges
   use kinds, only: wp
   use system_calls, only: signal_received
   use plane_vectors, only: pi
   use mechanism, only: mechanism_t, request_t, request_link, method_newton, plane_origin
   use motion, only: motion_t, new_motion, diagnostic_t, diagnostic_limit, diagnostic_change, diagnostic_close
   use separations, only: motions_apart, closes
   use drives, only: drive_motion
   use drive_path, only: lead
   use scales, only: is_length, characteristic_length
   use cylinders, only: cylinders_of
   use analysis, only: analysis_t, make_analysis, advance
   implicit none
   private
   public :: range_t, find_range, held_at, estimate_side, low, high

   !> Instants along the drive, in rad or characteristic lengths, and how far it is followed each way.
   real(wp), parameter :: step_of_angle = pi/36.0_wp, step_of_length = 0.05_wp
   integer, parameter :: max_turns = 12
   real(wp), parameter :: max_lengths = 100.0_wp
   !> How close its end is looked for where no limit is known. Reason: rounding leaves about the root of a rounding open
   !> there, and a try that fails takes as long as a long run.
   real(wp), parameter :: closest = max(1.0e-7_wp, 64.0_wp*sqrt(epsilon(1.0_wp)))
   !> The ends of a range.
   integer, parameter :: low = 1, high = 2

   !> The range of a drive. An end without a limit is the last value to which the drive was followed.
   type :: range_t
      integer :: part = 1, drive = 0        !< the number of its independent mechanism, and its own there
      logical :: is_all = .false.           !< it turns fully, and the motion closes
      integer :: turns = 0                  !< after so many turns
      logical :: is_of_branch = .false.     !< the first instant has no position: of a branch that CIRCUITS knows
      integer :: change_points = 0          !< passed on the smooth branch, both ways
      logical :: has_limit(2) = .false.     !< (low:high)
      type(diagnostic_t) :: limit(2)        !< (low:high) of the kind diagnostic_limit: links, the drive's value
   end type range_t

contains

   !> The range of drive number `drive` of `m`, one independent mechanism at the motion `start` of its first instant.
   subroutine find_range(m, start, drive, range)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: start
      integer, intent(in) :: drive
      type(range_t), intent(out) :: range
      type(mechanism_t) :: d
      real(wp) :: unit
      integer :: side

      range%drive = drive
      d = held_at(m, start%t)
      call estimate_side(d, start%position)
      unit = 1.0_wp
      if (is_length(m%drives(drive))) unit = characteristic_length(m)
      do side = low, high
         call follow(d, merge(-unit, unit, side == low), side, range)
         if (range%is_all) return
      end do
   end subroutine find_range

   !> `m` with all drives at rest at their values of the time `t`, by METHOD NEWTON, with all links asked for.
   function held_at(m, t) result(held)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: t
      type(mechanism_t) :: held
      real(wp) :: f(3)
      integer :: i

      held = m
      held%method = method_newton
      held%tolerance = 0.0_wp
      held%requests = [(request_t(request_link, i), i=1, size(m%links))]
      if (allocated(held%branch_requests)) deallocate (held%branch_requests)
      do i = 1, size(m%drives)
         f = drive_motion(m%drives(i), t)
         held%drives(i)%polynomial = [f(1), 0.0_wp, 0.0_wp]
         if (allocated(held%drives(i)%terms)) deallocate (held%drives(i)%terms)
      end do
   end function held_at

   !> The links of `m` are expected at this `position` (3, links), in the deck's unit and from its origin.
   subroutine estimate_side(m, position)
      type(mechanism_t), intent(inout) :: m
      real(wp), intent(in) :: position(:, :)
      integer :: i

      do i = 1, size(m%links)
         if (.not. m%links(i)%ground) m%links(i)%position = position(:, i) + [plane_origin(m), 0.0_wp]
      end do
   end subroutine estimate_side

   !> Follows the motion of `turned`, in which all drives rest, by the value of its drive to its end on one `side`: at
   !> the parameter t the drive has gone `rate` times t.
   subroutine follow(turned, rate, side, range)
      type(mechanism_t), intent(in) :: turned
      real(wp), intent(in) :: rate
      integer, intent(in) :: side
      type(range_t), intent(inout) :: range
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
      ! A position without velocities, as at a change point, is passed by more than one motion: the next one counts.
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
            part = closest
            grows = .true.
            do while (last_of(now, diagnostic_limit) == 0 .and. part >= closest .and. signal_received() == 0)
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
         ! The drive has one rate: what is in its place is as fast.
         range%is_all = closes(apart(:2))
         range%turns = (k - begin)/steps_a_turn
         if (range%is_all) return
      end do
      range%limit(side)%value = value + rate*t
   end subroutine follow

   !> The number of the last diagnostic of `q` of this `kind`; 0: there is none.
   pure integer function last_of(q, kind) result(i)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: kind

      i = 0
      if (allocated(q%diagnostics)) i = findloc(q%diagnostics%kind, kind, dim=1, back=.true.)
   end function last_of
end module ranges
