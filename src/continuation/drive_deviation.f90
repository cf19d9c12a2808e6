!> Bounds of the values of all drives between two instants: how far they go from the first value, and how far they leave
!> the chord from the first to the second value. A substep of the continuation relies on these bounds.
!>
!> A position at the end of a substep is the continuation of the one before if the drives follow their chords. If one
!> drive moves, it may go to and fro between its two values, since the mechanism then comes back through the same
!> positions; beyond the two values it may go at most as far as the position is certain to exist. Of several drives none
!> may leave its own chord by more: round a cusp there is another assembly at the same values.
module drive_deviation
   use kinds, only: wp
   use mechanism, only: mechanism_t, find_instants
   use scales, only: solver_length, is_length
   use predictor, only: largest_predicted_change
   use drives, only: bounds_t, bounds_of
   use drive_path, only: drive_path_t, drive_at, drive_bounds
   implicit none
   private
   public :: drive_deviation_t, new_drive_excursion, limit_substep, judge_step, examine

   !> The largest excursion off the chord, in rad or characteristic lengths. The Jacobian of a position mostly allows
   !> less; this limit bounds the effect on links far down a chain.
   real(wp), parameter :: max_deviation = 0.03_wp
   !> The least factor by which a substep is made shorter at once: the bounds of a shorter substep are closer.
   real(wp), parameter :: min_factor = 1.0e-3_wp
   !> The change of a shortened substep over the largest that is allowed: it shall not be a rounding too long.
   real(wp), parameter :: a_little_less = 0.98_wp

   !> Bounds of the drives of a mechanism. Times are in the deck's unit.
   type :: drive_deviation_t
      !> (drives) Factor of the values: 1 over the characteristic length, or 1 for an angle. Of size 0 if no position
      !> depends on positions before.
      real(wp), allocatable :: unit(:)
      real(wp) :: first = 0.0_wp, last = 0.0_wp   !< times of the earliest and the latest instant
      real(wp) :: longest = 0.0_wp                !< substep in which no drive can change by `largest_predicted_change`
      real(wp) :: curve = huge(1.0_wp)            !< largest second derivative of a drive's value times `unit`
   end type drive_deviation_t

contains

   !> Bounds the drives of a mechanism between its earliest and its latest instant. Without instants only the factors of
   !> the values are set.
   function new_drive_excursion(m, depends) result(p)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: depends         !< positions depend on positions before: some unknown is iterated
      type(drive_deviation_t) :: p
      type(bounds_t) :: b
      real(wp) :: largest(2)
      integer :: i

      allocate (p%unit(merge(size(m%drives), 0, depends)), source=1.0_wp)
      associate (lengths => is_length(m%drives(:size(p%unit))))
         if (any(lengths)) p%unit = merge(1.0_wp/solver_length(m), 1.0_wp, lengths)
      end associate
      call find_instants(m, p%first, p%last)
      if (p%first > p%last) return

      ! First and second derivatives, in radians or characteristic lengths; huge: no bound.
      largest = 0.0_wp
      do i = 1, size(p%unit)
         b = bounds_of(m%drives(i), p%first, p%last, .false.)
         where (b%high(1:) >= huge(1.0_wp) .or. b%low(1:) <= -huge(1.0_wp))
            largest = huge(1.0_wp)
         elsewhere
            largest = max(largest, p%unit(i)*max(-b%low(1:), b%high(1:)))
         end where
      end do
      p%longest = huge(1.0_wp)
      if (largest(1) > largest_predicted_change/huge(1.0_wp)) p%longest = largest_predicted_change/largest(1)
      p%curve = largest(2)
   end function new_drive_excursion

   !> Shortens a substep until no drive changes by more than `largest_predicted_change` nor leaves its chord by more
   !> than `max_deviation`.
   pure subroutine limit_substep(deviation, path, t, substep, allowed, away)
      type(drive_deviation_t), intent(in) :: deviation   !< bounds of the drives
      type(drive_path_t), intent(in) :: path   !< of the drives
      real(wp), intent(in) :: t              !< the parameter of the path from which the substep goes
      real(wp), intent(in) :: substep        !< the wanted substep, in the unit of the parameter
      real(wp), intent(out) :: allowed       !< the allowed substep; too short to change `t`: none is allowed
      real(wp), intent(out) :: away          !< bound of the drives' excursion in it, rad or characteristic lengths
      real(wp) :: change
      logical :: inside, is_plain

      allowed = substep
      inside = is_within(deviation, path, t, t + substep)
      call judge_step(deviation, substep, away, is_plain)
      if (is_plain .and. inside) return
      do while (abs((t + allowed) - t) > 0.0_wp)
         call examine(deviation, path, t, t + allowed, change, away)
         inside = is_within(deviation, path, t, t + allowed)
         if (change > largest_predicted_change .and. .not. (inside .and. abs(allowed) <= deviation%longest)) then
            allowed = allowed*max(min_factor, a_little_less*largest_predicted_change/change)
            if (inside) allowed = sign(max(abs(allowed), deviation%longest), substep)
         else if (away > max_deviation) then
            allowed = 0.5_wp*allowed
         else
            exit
         end if
      end do
      if (inside .and. deviation%curve < huge(1.0_wp)) away = 0.125_wp*allowed**2*deviation%curve
   end subroutine limit_substep

   !> Finds whether the drives allow all steps of a given length between the instants.
   pure subroutine judge_step(deviation, step, away, is_plain)
      type(drive_deviation_t), intent(in) :: deviation   !< bounds of the drives
      real(wp), intent(in) :: step           !< the length of the step, in the deck's unit of time
      real(wp), intent(out) :: away          !< bound of the drives' excursion in it; 0 if there is no bound
      logical, intent(out) :: is_plain       !< the drives allow such steps

      away = 0.0_wp
      is_plain = abs(step) <= deviation%longest .and. deviation%curve < huge(1.0_wp)
      if (.not. is_plain) return
      away = 0.125_wp*step**2*deviation%curve
      is_plain = away <= max_deviation
   end subroutine judge_step

   !> Bounds the change of the drives between two parameters of their path, and their excursion off the chords, by the
   !> rules of the module's head. A chord of length h is off its curve by h^2/8 times the second derivative at most. If
   !> a drive has no bound, both results are huge.
   pure subroutine examine(deviation, path, t1, t2, change, away)
      type(drive_deviation_t), intent(in) :: deviation   !< bounds of the drives
      type(drive_path_t), intent(in) :: path   !< of the drives
      real(wp), intent(in) :: t1, t2         !< the parameters, in either order, in the deck's unit of time
      real(wp), intent(out) :: change        !< largest change from the value at `t1`, in rad or characteristic lengths
      real(wp), intent(out) :: away          !< largest excursion, in rad or characteristic lengths
      type(bounds_t) :: b
      real(wp) :: f1(3), f2(3), h, rate, bow, off, beyond, off_one, off_all
      integer :: i, moving

      change = 0.0_wp
      off_one = 0.0_wp
      off_all = 0.0_wp
      moving = 0
      h = abs(t2 - t1)
      do i = 1, size(deviation%unit)
         b = drive_bounds(path, i, t1, t2)
         if (any(b%high >= huge(1.0_wp) .or. b%low <= -huge(1.0_wp))) then
            change = huge(1.0_wp)
            away = huge(1.0_wp)
            return
         end if

         f1 = drive_at(path, i, t1)
         f2 = drive_at(path, i, t2)
         rate = max(-b%low(1), b%high(1))
         if (rate > 0.0_wp) moving = moving + 1
         change = max(change, deviation%unit(i)*min(rate*h, max(b%high(0) - f1(1), f1(1) - b%low(0))))
         bow = 0.125_wp*h**2*max(-b%low(2), b%high(2))
         off = min(bow, max(b%high(0) - min(f1(1), f2(1)), max(f1(1), f2(1)) - b%low(0)))
         beyond = max(b%high(0) - max(f1(1), f2(1)), min(f1(1), f2(1)) - b%low(0), 0.0_wp)
         if (b%low(1) >= 0.0_wp .or. b%high(1) <= 0.0_wp) beyond = 0.0_wp
         off_one = max(off_one, deviation%unit(i)*min(bow, beyond))
         off_all = max(off_all, deviation%unit(i)*off)
      end do
      away = merge(off_all, off_one, moving > 1)
   end subroutine examine

   !> Tells whether two parameters are times, and lie between the earliest and the latest instant.
   pure logical function is_within(deviation, path, t1, t2)
      type(drive_deviation_t), intent(in) :: deviation   !< bounds of the drives
      type(drive_path_t), intent(in) :: path   !< of the drives
      real(wp), intent(in) :: t1, t2         !< the parameters, in either order, in the deck's unit of time

      is_within = min(t1, t2) >= deviation%first .and. max(t1, t2) <= deviation%last .and. .not. allocated(path%leg)
   end function is_within
end module drive_deviation
