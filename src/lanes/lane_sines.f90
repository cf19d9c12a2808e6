!> Sine and cosine of as many angles as there are lanes, all at once: the processor's vectors hold one number of each
!> lane.
!>
!> The angle less a multiple n of pi/2 is known to twice the digits of a double. n pi/2 is subtracted in three parts, of
!> which the first two have 33 digits: their products with n are exact (Cody and Waite, Software Manual for the
!> Elementary Functions, 1980). The polynomials on [-pi/4, pi/4] are those of fdlibm (Sun Microsystems, 1993). The error
!> is below 0.8 of the last digit; a test measures it.
module lane_sines
   use kinds, only: wp
   implicit none
   private
   public :: lane_count, sines, max_angle

   !> Lanes. With half as many, the work that is done once for all lanes takes a tenth of a step more.
   integer, parameter :: lane_count = 16
   !> rad: n has at most 20 digits for an angle up to this one.
   real(wp), parameter :: max_angle = 1.0e6_wp
   !> Whole numbers of the size of a real, whose first bit, at `sign_at`, is its sign.
   integer, parameter :: sign_at = storage_size(1.0_wp) - 1, bits = (sign_at + 1)/8
   !> Added to a real, it makes the last bits those of the nearest whole number; subtracted again, it leaves that
   !> number.
   real(wp), parameter :: whole = 1.5_wp/epsilon(1.0_wp)
   !> pi/2 in three parts, and 2/pi.
   real(wp), parameter :: parts(3) = [1.57079632673412561417E+00_wp, 6.07710050630396597660E-11_wp, &
      2.02226624879595063154E-21_wp], two_over_pi = 6.36619772367581382433E-01_wp
   !> Coefficients of the sine: of r**3, r**5, ..., r**13.
   real(wp), parameter :: s(6) = [-1.66666666666666324348E-01_wp, 8.33333333332248946124E-03_wp, &
      -1.98412698298579493134E-04_wp, 2.75573137070700676789E-06_wp, -2.50507602534068634195E-08_wp, &
      1.58969099521155010221E-10_wp]
   !> Coefficients of the cosine: of r**4, r**6, ..., r**14.
   real(wp), parameter :: c(6) = [4.16666666666666019037E-02_wp, -1.38888888888741095749E-03_wp, &
      2.48015872894767294178E-05_wp, -2.75573143513906633035E-07_wp, 2.08757232129817482790E-09_wp, &
      -1.13596475577881948265E-11_wp]

contains

   !> Finds cosine and sine of angles. Other kinds of reals than double take those of the run-time library.
   pure subroutine sines(angles, cosine_of, sine_of)
      real(wp), intent(in) :: angles(lane_count)      !< rad, at most `max_angle`
      real(wp), intent(out) :: cosine_of(lane_count)  !< of each angle
      real(wp), intent(out) :: sine_of(lane_count)    !< of each angle
      real(wp) :: n, t, u, r, rest, z, half, sine, cosine
      integer(bits) :: quadrant, of_sine, of_cosine, exchanged
      integer :: l

      if (digits(1.0_wp) /= 53) then
         cosine_of = cos(angles)
         sine_of = sin(angles)
         return
      end if
      do l = 1, lane_count
         n = angles(l)*two_over_pi + whole
         quadrant = transfer(n, quadrant)
         n = n - whole
         t = angles(l) - n*parts(1)
         u = n*parts(2)

         r = t - u
         ! The part of r that rounding has left out.
         z = r - t
         rest = (t - (r - z)) - (u + z) - n*parts(3)
         t = r
         r = t + rest
         rest = (t - r) + rest
         z = r*r

         sine = r + (z*r*(s(1) + z*(s(2) + z*(s(3) + z*(s(4) + z*(s(5) + z*s(6)))))) + rest*(1.0_wp - 0.5_wp*z))
         half = 0.5_wp*z
         u = 1.0_wp - half
         cosine = u + (((1.0_wp - u) - half) &
            + (z*(z*(c(1) + z*(c(2) + z*(c(3) + z*(c(4) + z*(c(5) + z*c(6))))))) - r*rest))

         of_sine = transfer(sine, of_sine)
         of_cosine = transfer(cosine, of_cosine)
         exchanged = iand(ieor(of_sine, of_cosine), -iand(quadrant, 1_bits))
         sine_of(l) = transfer(ieor(ieor(of_sine, exchanged), ishft(iand(quadrant, 2_bits), sign_at - 1)), z)
         cosine_of(l) = transfer(ieor(ieor(of_cosine, exchanged), ishft(iand(quadrant + 1_bits, 2_bits), &
            sign_at - 1)), z)
      end do
   end subroutine sines
end module lane_sines
