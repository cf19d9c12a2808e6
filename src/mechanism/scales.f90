!> The characteristic length and rate of a mechanism, only from its deck. With these the tolerances of the solver and
!> the digits of the listing do not depend on whether the deck is in millimetres or in kilometres.
module scales
   use kinds, only: wp
   use plane_vectors, only: point_of
   use drives, only: drive_rate
   use mechanism, only: settings_t, mechanism_t, drive_t, has_guide, drive_x, drive_y, drive_slide, plane_origin, &
      used_points
   implicit none
   private
   public :: characteristic_length, solver_length, characteristic_rate, power_of_two, is_length, latest_time

contains

   !> Finds the characteristic length of a mechanism, in the deck's unit; 1 if the deck has no length. The origin of the
   !> deck does not matter. The result is the largest of these lengths:
   !>
   !> - the extent of a link between its points (all ground links are one);
   !> - the offset of a prismatic pair;
   !> - the value at t = 0 of a drive of a length.
   pure real(wp) function characteristic_length(m) result(length)
      type(mechanism_t), intent(in) :: m

      length = largest_length(m, spread(.true., 1, size(m%points)))
      if (.not. is_usable(length)) length = 1.0_wp
   end function characteristic_length

   !> Finds the characteristic length of a mechanism for its equations, in the deck's unit. Points that no pair and no
   !> drive uses count only if there is no other length.
   pure real(wp) function solver_length(m) result(length)
      type(mechanism_t), intent(in) :: m

      length = largest_length(m, used_points(m))
      if (.not. is_usable(length)) length = characteristic_length(m)
   end function solver_length

   !> Tells whether a length or rate is positive and finite.
   pure logical function is_usable(value)
      real(wp), intent(in) :: value          !< length or rate, in any unit

      is_usable = value > 0.0_wp .and. value <= huge(value)
   end function is_usable

   !> Finds the largest length of a mechanism, in the deck's unit; 0 if there is none: the largest extent of a link
   !> along x or y, offset of a guide, or first value of a drive of a length.
   pure real(wp) function largest_length(m, counts) result(length)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: counts(:)       !< (points) the extent of its link includes the point
      real(wp), allocatable :: low(:, :), high(:, :)
      real(wp) :: position(2), origin(2), start
      integer :: i, k

      origin = plane_origin(m)
      allocate (low(2, 0:size(m%links)), source=huge(1.0_wp))
      allocate (high(2, 0:size(m%links)), source=-huge(1.0_wp))
      do i = 1, size(m%points)
         if (.not. counts(i)) cycle
         k = m%points(i)%link
         position = m%points(i)%offset
         if (m%links(k)%ground) then
            position = point_of(m%links(k)%position - [origin, 0.0_wp], position)
            k = 0
         else
            ! The origin of the link counts too: the card estimates its position within the mechanism.
            low(:, k) = min(low(:, k), 0.0_wp)
            high(:, k) = max(high(:, k), 0.0_wp)
         end if
         low(:, k) = min(low(:, k), position)
         high(:, k) = max(high(:, k), position)
      end do

      length = max(0.0_wp, maxval(high - low, mask=high >= low))
      do i = 1, size(m%pairs)
         if (has_guide(m%pairs(i)%kind)) length = max(length, abs(m%pairs(i)%offset))
      end do
      do i = 1, size(m%drives)
         if (.not. is_length(m%drives(i))) cycle
         start = m%drives(i)%polynomial(1)
         if (m%drives(i)%kind == drive_x) start = start - origin(1)
         if (m%drives(i)%kind == drive_y) start = start - origin(2)
         length = max(length, abs(start))
      end do
   end function largest_length

   !> Estimates the largest rate of the drives at the instants, in rad per unit of time; rates of length are divided by
   !> the characteristic length. The result is 1 if nothing moves or the rate has no bound. An estimate is enough: it
   !> only selects printed digits.
   pure real(wp) function characteristic_rate(m, length) result(rate)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length         !< characteristic length, in the deck's unit
      integer :: i

      rate = 0.0_wp
      do i = 1, size(m%drives)
         rate = max(rate, drive_rate(m%drives(i), latest_time(m))/merge(length, 1.0_wp, is_length(m%drives(i))))
      end do
      if (.not. is_usable(rate)) rate = 1.0_wp
   end function characteristic_rate

   !> Finds the largest |t| of all instants of a set, in the deck's unit of time; 0 without instants.
   pure real(wp) function latest_time(settings) result(t)
      class(settings_t), intent(in) :: settings   !< of a set or of a part of it

      t = max(abs(settings%t0), abs(settings%t1), maxval([0.0_wp, abs(settings%at)]))
   end function latest_time

   !> Finds the largest power of two that is not above a value, in its unit: division by a power of two is exact.
   pure real(wp) function power_of_two(value) result(p)
      real(wp), intent(in) :: value          !< above 0, in any unit

      p = scale(1.0_wp, exponent(value) - 1)
   end function power_of_two

   !> Tells whether the coordinate of a drive is a length, not an angle.
   elemental logical function is_length(drive)
      type(drive_t), intent(in) :: drive     !< of any kind

      is_length = any(drive%kind == [drive_x, drive_y, drive_slide])
   end function is_length
end module scales
