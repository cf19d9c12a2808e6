!> The known motion of a drive: value, rate and second rate at t, always from t itself,
!> never accumulated from step to step.
!>
!>    f(t) = value + rate t + acceleration t**2/2 + the sum of the terms added
module drives
   use kinds, only: wp
   use mechanism, only: drive_t, term_harmonic, term_power, term_table
   use spline, only: spline_t, new_spline, spline_value
   implicit none
   private
   public :: law_t, new_law, drive_motion, monomial

   !> A drive made ready for evaluation.
   type :: law_t
      type(drive_t) :: drive
      type(spline_t), allocatable :: splines(:)   !< of the terms that are tables
   end type law_t

contains

   !> The law of `drive`, its splines solved.
   function new_law(drive) result(law)
      type(drive_t), intent(in) :: drive
      type(law_t) :: law
      integer :: i

      law%drive = drive
      if (.not. allocated(law%drive%terms)) allocate (law%drive%terms(0))
      allocate (law%splines(size(law%drive%terms)))
      do i = 1, size(law%splines)
         associate (term => law%drive%terms(i))
            if (term%kind == term_table) law%splines(i) = new_spline(term%knots, term%values)
         end associate
      end do
   end function new_law

   !> Value, rate and second rate at `t`, in the drive's unit (length or rad) and time unit.
   pure function drive_motion(law, t) result(f)
      type(law_t), intent(in) :: law
      real(wp), intent(in) :: t
      real(wp) :: f(3)
      integer :: i

      associate (c => law%drive%polynomial)
         f = [c(1) + t*(c(2) + t*c(3)/2.0_wp), c(2) + t*c(3), c(3)]
      end associate
      do i = 1, size(law%splines)
         select case (law%drive%terms(i)%kind)
         case (term_harmonic)
            f = f + harmonic(law%drive%terms(i)%r, t)
         case (term_power)
            f = f + power(law%drive%terms(i)%r, t)
         case (term_table)
            f = f + spline_value(law%splines(i), t)
         end select
      end do
   end function drive_motion

   !> r1 sin(r2 t + r3) and its derivatives.
   pure function harmonic(r, t) result(f)
      real(wp), intent(in) :: r(3), t
      real(wp) :: f(3), argument

      argument = r(2)*t + r(3)
      f = r(1)*[sin(argument), r(2)*cos(argument), -r(2)**2*sin(argument)]
   end function harmonic

   !> r1 t**r2 and its derivatives; the deck has refused what does not exist.
   pure function power(r, t) result(f)
      real(wp), intent(in) :: r(3), t
      real(wp) :: f(3)

      f(1) = monomial(r(1), r(2), t)
      f(2) = monomial(r(1)*r(2), r(2) - 1.0_wp, t)
      f(3) = monomial(r(1)*r(2)*(r(2) - 1.0_wp), r(2) - 2.0_wp, t)
   end function power

   !> c t**p; a whole p is raised as a whole number, so that t may be zero or negative.
   pure real(wp) function monomial(c, p, t)
      real(wp), intent(in) :: c, p, t
      real(wp), parameter :: largest_whole = 1.0e6_wp

      if (abs(c) <= 0.0_wp) then
         monomial = 0.0_wp
      else if (abs(p) < largest_whole .and. abs(p - anint(p)) <= 0.0_wp) then
         monomial = c*t**nint(p)
      else
         monomial = c*t**p
      end if
   end function monomial
end module drives
