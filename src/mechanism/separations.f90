!> The differences of two positions or of two motions of a mechanism, and whether a motion closes.
module separations
   use kinds, only: wp
   use plane_vectors, only: wrap_angle
   use mechanism, only: mechanism_t
   use motion, only: motion_t
   use scales, only: characteristic_length, characteristic_rate
   implicit none
   private
   public :: separation, motions_apart, closes, closes_to

   !> A motion closes if its end differs from its beginning by at most this, in characteristic lengths, rad and
   !> characteristic rates. A drive of 6.2831853 rad then makes a whole turn.
   real(wp), parameter :: closes_to = max(1.0e-6_wp, 1000.0_wp*epsilon(1.0_wp))

contains

   !> Finds the largest differences (2) of two positions of all links: of x and y, in `length`, and of angles (rad)
   !> without whole turns.
   pure function separation(first, second, length) result(apart)
      real(wp), intent(in) :: first(:, :), second(:, :)   !< (3, links): x and y (length), phi (rad)
      real(wp), intent(in) :: length         !< the unit of the first result, in the deck's unit
      real(wp) :: apart(2)

      apart = [maxval(abs(first(:2, :) - second(:2, :)))/length, maxval(abs(wrap_angle(first(3, :) - second(3, :))))]
   end function separation

   !> Finds the largest differences (3) of two motions: of x and y in characteristic lengths, of angles in rad without
   !> whole turns, and of velocities in characteristic lengths and rates. All are huge if a position is not known.
   !> Velocities that are not unique count as equal.
   pure function motions_apart(m, first, last) result(apart)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: first, last   !< of `m`, both of all links
      real(wp) :: apart(3), d(3, size(m%links)), length

      apart = huge(1.0_wp)
      if (min(first%known, last%known) < 0) return
      length = characteristic_length(m)
      apart = [separation(last%position, first%position, length), 0.0_wp]
      ! At a change point velocities are not unique.
      if (min(first%known, last%known) < 1) return
      d = last%velocity - first%velocity
      d(:2, :) = d(:2, :)/length
      apart(3) = maxval(abs(d))/characteristic_rate(m, length)
   end function motions_apart

   !> Tells whether a motion closes, from the differences of its end and its beginning.
   pure logical function closes(apart)
      real(wp), intent(in) :: apart(:)       !< (1 to 3) of x and y, angles, velocities, as in `motions_apart`

      closes = all(apart <= closes_to)
   end function closes
end module separations
