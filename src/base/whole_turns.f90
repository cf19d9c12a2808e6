!> Angles that differ by whole turns are the same direction.
module whole_turns
   use kinds, only: wp
   use constants, only: pi
   implicit none
   private
   public :: without_turns

   real(wp), parameter :: turn = 2.0_wp*pi

contains

   !> `angle` less the whole turns that leave it between -pi and pi; one that is there already stays as it is.
   pure elemental real(wp) function without_turns(angle) result(rest)
      real(wp), intent(in) :: angle

      rest = angle - turn*anint(angle/turn)
   end function without_turns
end module whole_turns
