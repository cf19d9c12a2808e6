!> Level 2. Mathematical constants.
module constants
   use kinds, only: wp
   implicit none
   private
   public :: pi, degree

   real(wp), parameter :: pi = 3.14159265358979323846264338327950288419716939937510_wp
   !> One degree in radians.
   real(wp), parameter :: degree = pi/180.0_wp
end module constants
