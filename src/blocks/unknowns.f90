!> An unknown of the equations, an angle or a slide, with its derivatives by time.
module unknowns
   use kinds, only: wp
   implicit none
   private
   public :: unknown_t

   type :: unknown_t
      real(wp) :: value = 0.0_wp, rate = 0.0_wp, acceleration = 0.0_wp
      real(wp) :: c = 1.0_wp, s = 0.0_wp   !< of an angle: cosine and sine of the value
   end type unknown_t
end module unknowns
