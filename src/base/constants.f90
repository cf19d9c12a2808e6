!> Mathematical constants, angles in degrees and without whole turns, and rotation in the plane.
module constants
   use kinds, only: wp
   implicit none
   private
   public :: pi, degree, in_degrees, without_turns

   real(wp), parameter :: pi = 3.14159265358979323846264338327950288419716939937510_wp
   !> One degree in radians.
   real(wp), parameter :: degree = pi/180.0_wp
   !> The largest power of 10 without a rounding error: its power of 5 fits in the digits of `wp`.
   integer, parameter :: exact_power = int(digits(1.0_wp)*(log10(2.0)/log10(5.0)))

contains

   !> `angle` (rad, or rad per unit of time to any power) in degrees. Degrees of a deck with at most precision(1.0_wp)
   !> digits come back as they were: several numbers of degrees have the same nearest radians, and the one with the
   !> fewest digits is meant. Any other comes back within one rounding.
   pure elemental real(wp) function in_degrees(angle) result(d)
      real(wp), intent(in) :: angle
      real(wp) :: power, rounded
      integer :: decimals

      d = angle/degree
      if (.not. (abs(d) > 0.0_wp .and. abs(d) <= huge(d))) return
      decimals = precision(d) - 1 - floor(log10(abs(d)))
      if (decimals < 0 .or. decimals > exact_power) return
      power = 10.0_wp**decimals
      rounded = anint(d*power)/power
      if (abs(rounded*degree - angle) <= 0.0_wp) d = rounded
   end function in_degrees

   !> `angle` (rad) less whole turns, between -pi and pi: the same direction. An angle in this range stays as it is.
   pure elemental real(wp) function without_turns(angle) result(rest)
      real(wp), intent(in) :: angle
      real(wp), parameter :: turn = 2.0_wp*pi

      rest = angle - turn*anint(angle/turn)
   end function without_turns
end module constants
