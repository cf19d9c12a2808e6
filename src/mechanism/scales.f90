!> The characteristic length and rate of a mechanism, from its deck alone: what makes the solver's tolerances
!> and the listing's digits the same in millimetres and in kilometres.
module scales
   use kinds, only: wp
   use mechanism, only: mechanism_t, drive_t, term_t, pair_prismatic, drive_x, drive_y, drive_slide, term_harmonic, &
      term_power, term_table, plane_origin
   implicit none
   private
   public :: characteristic_length, solver_length, characteristic_rate, power_of_two, is_length

contains

   !> The largest extent of a link between its points (ground links taken as one), prismatic offset, or range of a drive
   !> of length; 1 where the deck holds no length at all. In the deck's unit; places do not count, only distances.
   pure real(wp) function characteristic_length(m) result(length)
      type(mechanism_t), intent(in) :: m

      length = largest_length(m, spread(.true., 1, size(m%points)))
      if (.not. is_usable(length)) length = 1.0_wp
   end function characteristic_length

   !> The same for what is solved: points that are in no pair and that no drive moves do not count, unless there is no
   !> other length.
   pure real(wp) function solver_length(m) result(length)
      type(mechanism_t), intent(in) :: m
      logical :: counts(size(m%points))
      integer :: i

      counts = .false.
      counts(m%pairs%point_i) = .true.
      counts(m%pairs%point_j) = .true.
      do i = 1, size(m%drives)
         if (any(m%drives(i)%kind == [drive_x, drive_y])) counts(m%drives(i)%subject) = .true.
      end do
      length = largest_length(m, counts)
      if (.not. is_usable(length)) length = characteristic_length(m)
   end function solver_length

   pure logical function is_usable(length)
      real(wp), intent(in) :: length

      is_usable = length > 0.0_wp .and. length <= huge(length)
   end function is_usable

   !> The largest length of `m`, of its points those that `counts` (points); 0 where there is none.
   pure real(wp) function largest_length(m, counts) result(length)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: counts(:)
      real(wp), allocatable :: low(:, :), high(:, :)
      real(wp) :: place(2), origin(2), start
      integer :: i, k

      origin = plane_origin(m)
      allocate (low(2, 0:size(m%links)), source=huge(1.0_wp))
      allocate (high(2, 0:size(m%links)), source=-huge(1.0_wp))
      do i = 1, size(m%points)
         if (.not. counts(i)) cycle
         k = m%points(i)%link
         place = m%points(i)%offset
         if (m%links(k)%ground) then
            place = ground_place(m%links(k)%position - [origin, 0.0_wp], place)
            k = 0
         else
            ! The link's own origin counts too: its rough place is where the mechanism is.
            low(:, k) = min(low(:, k), 0.0_wp)
            high(:, k) = max(high(:, k), 0.0_wp)
         end if
         low(:, k) = min(low(:, k), place)
         high(:, k) = max(high(:, k), place)
      end do
      length = max(0.0_wp, maxval(high - low, mask=high >= low))
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_prismatic) length = max(length, abs(m%pairs(i)%offset))
      end do
      do i = 1, size(m%drives)
         if (.not. is_length(m%drives(i))) cycle
         start = m%drives(i)%polynomial(1)
         if (m%drives(i)%kind == drive_x) start = start - origin(1)
         if (m%drives(i)%kind == drive_y) start = start - origin(2)
         length = max(length, abs(start))
      end do
   end function largest_length

   !> The largest rate, or 1 where nothing moves or no bound exists: it chooses digits, nothing else.
   pure real(wp) function characteristic_rate(m, length) result(rate)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length

      rate = largest_rate(m, length)
      if (.not. (rate > 0.0_wp .and. rate <= huge(rate))) rate = 1.0_wp
   end function characteristic_rate

   !> The largest rate of any drive in the time asked for, in rad per time unit; rates of length are divided by the
   !> characteristic `length`. An estimate: `law_bounds` has true bounds.
   pure real(wp) function largest_rate(m, length) result(rate)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length
      real(wp) :: t, one
      integer :: i

      t = max(abs(m%t0), abs(m%t1))
      if (size(m%at) > 0) t = max(t, maxval(abs(m%at)))
      rate = 0.0_wp
      do i = 1, size(m%drives)
         one = drive_rate(m%drives(i), t)
         if (is_length(m%drives(i))) one = one/length
         rate = max(rate, one)
      end do
   end function largest_rate

   !> The power of two next below `x`: dividing by it is exact.
   pure real(wp) function power_of_two(x) result(p)
      real(wp), intent(in) :: x

      p = scale(1.0_wp, exponent(x) - 1)
   end function power_of_two

   pure function ground_place(position, offset) result(place)
      real(wp), intent(in) :: position(3), offset(2)
      real(wp) :: place(2)

      place = position(:2) + [offset(1)*cos(position(3)) - offset(2)*sin(position(3)), &
         offset(1)*sin(position(3)) + offset(2)*cos(position(3))]
   end function ground_place

   pure logical function is_length(drive)
      type(drive_t), intent(in) :: drive

      is_length = any(drive%kind == [drive_x, drive_y, drive_slide])
   end function is_length

   !> The largest |rate| of one drive for |time| <= t.
   pure real(wp) function drive_rate(drive, t) result(rate)
      type(drive_t), intent(in) :: drive
      real(wp), intent(in) :: t
      integer :: i

      rate = abs(drive%polynomial(2)) + abs(drive%polynomial(3))*t
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         rate = rate + term_rate(drive%terms(i), t)
      end do
   end function drive_rate

   pure real(wp) function term_rate(term, t) result(rate)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: t

      rate = 0.0_wp
      select case (term%kind)
      case (term_harmonic)
         rate = abs(term%r(1)*term%r(2))
      case (term_power)
         if (t > 0.0_wp) rate = abs(term%r(1)*term%r(2))*t**(term%r(2) - 1.0_wp)
      case (term_table)
         associate (x => term%knots, y => term%values, n => size(term%knots))
            rate = maxval(abs((y(2:) - y(:n - 1))/(x(2:) - x(:n - 1))))
         end associate
      end select
   end function term_rate
end module scales
