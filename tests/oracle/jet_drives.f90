!> Tests. The motions of the drives in real128, and how large the numbers were that they were added up from: one part in
!> 2**53 of that is what double precision can be held to.
module jet_drives
   use quad_jet, only: qp, jet_t, time_jet, sin, operator(+), operator(*)
   use mechanism, only: drive_t, term_t, term_harmonic, term_power, term_table
   implicit none
   private
   public :: drive_jet, drive_sizes

contains

   !> Value, rate and second rate of the drive `d` at `t`.
   function drive_jet(d, t) result(f)
      type(drive_t), intent(in) :: d
      real(qp), intent(in) :: t
      type(jet_t) :: f
      real(qp) :: c(3)
      integer :: i

      c = d%polynomial
      f = jet_t(c(1) + c(2)*t + 0.5_qp*c(3)*t**2, c(2) + c(3)*t, c(3))
      do i = 1, size(d%terms)
         f = f + term_jet(d%terms(i), t)
      end do
   end function drive_jet

   function term_jet(term, t) result(f)
      type(term_t), intent(in) :: term
      real(qp), intent(in) :: t
      type(jet_t) :: f
      real(qp) :: r(3)

      r = term%r
      select case (term%kind)
      case (term_harmonic)
         f = r(1)*sin(r(2)*time_jet(t) + r(3))
      case (term_power)
         f = jet_t(r(1)*raised(t, r(2), 0), r(1)*raised(t, r(2), 1), r(1)*raised(t, r(2), 2))
      case (term_table)
         f = spline_jet(term, t)
      end select
   end function term_jet

   !> Derivative number `k` of t**p.
   pure real(qp) function raised(t, p, k)
      real(qp), intent(in) :: t, p
      integer, intent(in) :: k
      real(qp) :: factor
      integer :: i

      factor = 1.0_qp
      do i = 0, k - 1
         factor = factor*(p - i)
      end do
      raised = 0.0_qp
      if (.not. abs(factor) > 0.0_qp) return
      if (.not. abs(p - anint(p)) > 0.0_qp .and. abs(p) < 1.0e6_qp) then
         raised = factor*t**(nint(p) - k)
      else if (abs(t) > 0.0_qp) then
         raised = factor*t**(p - k)
      end if
   end function raised

   !> The natural cubic spline by its second derivatives at the knots (de Boor, ch. IV), eliminated row by row.
   function spline_jet(term, t) result(f)
      type(term_t), intent(in) :: term
      real(qp), intent(in) :: t
      type(jet_t) :: f
      real(qp), allocatable :: x(:), y(:)
      real(qp) :: m(size(term%knots)), h, u, w
      integer :: i

      x = term%knots
      y = term%values
      m = curvatures(x, y)
      i = max(1, min(count(x <= t), size(x) - 1))
      h = x(i + 1) - x(i)
      u = (t - x(i))/h
      w = 1.0_qp - u
      f%v = w*y(i) + u*y(i + 1) + ((w**3 - w)*m(i) + (u**3 - u)*m(i + 1))*h**2/6.0_qp
      f%d = (y(i + 1) - y(i))/h + ((1.0_qp - 3.0_qp*w**2)*m(i) + (3.0_qp*u**2 - 1.0_qp)*m(i + 1))*h/6.0_qp
      f%dd = w*m(i) + u*m(i + 1)
   end function spline_jet

   pure function curvatures(x, y) result(m)
      real(qp), intent(in) :: x(:), y(:)
      real(qp) :: m(size(x)), pivot(size(x)), right(size(x)), h(size(x) - 1), factor
      integer :: i, n

      n = size(x)
      h = x(2:) - x(:n - 1)
      m = 0.0_qp
      do i = 2, n - 1
         pivot(i) = 2.0_qp*(h(i - 1) + h(i))
         right(i) = 6.0_qp*((y(i + 1) - y(i))/h(i) - (y(i) - y(i - 1))/h(i - 1))
         if (i == 2) cycle
         factor = h(i - 1)/pivot(i - 1)
         pivot(i) = pivot(i) - factor*h(i - 1)
         right(i) = right(i) - factor*right(i - 1)
      end do
      do i = n - 1, 2, -1
         m(i) = (right(i) - h(i)*m(i + 1))/pivot(i)
      end do
   end function curvatures

   !> Sizes (0:2) of the numbers in value, rate and second rate of the drive `d` at `t`.
   function drive_sizes(d, t) result(s)
      type(drive_t), intent(in) :: d
      real(qp), intent(in) :: t
      real(qp) :: s(0:2), c(3)
      integer :: i

      c = abs(d%polynomial)
      s = [c(1) + c(2)*abs(t) + c(3)*t**2, c(2) + c(3)*abs(t), c(3)]
      do i = 1, size(d%terms)
         s = s + term_sizes(d%terms(i), t)
      end do
   end function drive_sizes

   !> The argument of a sine is known to one part in 2**53 of itself; a power's factors are as many as its exponent; a
   !> table's slopes and curvatures are differences divided by its steps.
   function term_sizes(term, t) result(s)
      type(term_t), intent(in) :: term
      real(qp), intent(in) :: t
      real(qp) :: s(0:2), r(3), steepest, widest
      type(jet_t) :: f

      s = 0.0_qp
      r = abs(term%r)
      select case (term%kind)
      case (term_harmonic)
         s = r(1)*[1.0_qp, r(2), r(2)**2]*(1.0_qp + r(2)*abs(t) + r(3))
      case (term_power)
         f = term_jet(term, t)
         s = abs([f%v, f%d, f%dd])*(1.0_qp + r(2))
      case (term_table)
         associate (x => term%knots, y => term%values, n => size(term%knots))
            steepest = maxval(2.0_qp*maxval(abs(real(y, qp)))/(real(x(2:), qp) - x(:n - 1)))
            widest = maxval(real(x(2:), qp) - x(:n - 1))
            s(2) = 6.0_qp*steepest/minval(real(x(2:), qp) - x(:n - 1))
            s(1) = steepest + s(2)*widest
            s(0) = maxval(abs(real(y, qp))) + s(1)*widest
         end associate
      end select
   end function term_sizes
end module jet_drives
