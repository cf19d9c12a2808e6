!> Tests. The motions of the drives in real128; how large the numbers were that they were added up from (one part in
!> 2**53 of that is what double precision can be held to); and how much each number of a law counts.
module jet_drives
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, time_jet, sin, operator(+), operator(*)
   use rise_laws, only: rise_jet, fine_joint_part
   use mechanism, only: mechanism_t, drive_t, term_t, term_harmonic, term_power, term_table, term_cycloid, &
      term_parabola, term_kinds
   implicit none
   private
   public :: drive_jet, drive_jets, term_jet, drive_sizes, drive_changes

   !> As `fine_joint_part`, or as much as a coarser kind of real needs.
   real(qp), parameter :: joint_part = max(fine_joint_part, 2048.0_qp*epsilon(1.0_wp))

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
      if (.not. allocated(d%terms)) return
      do i = 1, size(d%terms)
         f = f + term_of(d%terms(i), t)
      end do
   end function drive_jet

   !> The laws of all drives of `m` at `t`.
   function drive_jets(m, t) result(f)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: t
      type(jet_t) :: f(size(m%drives))
      integer :: k

      do k = 1, size(f)
         f(k) = drive_jet(m%drives(k), t)
      end do
   end function drive_jets

   !> A term with the numbers of the deck as the program has them.
   type(jet_t) function term_of(term, t) result(f)
      type(term_t), intent(in) :: term
      real(qp), intent(in) :: t
      real(qp), allocatable :: x(:), y(:)

      allocate (x(0), y(0))
      if (term%kind == term_table) then
         x = term%table%x
         y = term%table%y
      end if
      f = term_jet(term%kind, real(term%r, qp), x, y, t)
   end function term_of

   !> The term `kind` with the numbers `r`, or with the table `y` over `x`.
   type(jet_t) function term_jet(kind, r, x, y, t) result(f)
      integer, intent(in) :: kind
      real(qp), intent(in) :: r(3), x(:), y(:), t

      select case (kind)
      case (term_harmonic)
         f = r(1)*sin(r(2)*time_jet(t) + r(3))
      case (term_power)
         f = jet_t(r(1)*raised(t, r(2), 0), r(1)*raised(t, r(2), 1), r(1)*raised(t, r(2), 2))
      case (term_table)
         f = spline_jet(x, y, t)
      case (term_cycloid:term_parabola)
         f = rise_jet(trim(term_kinds(kind)%word), r(1), r(2), r(3), t, joint_part)
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
   type(jet_t) function spline_jet(x, y, t) result(f)
      real(qp), intent(in) :: x(:), y(:), t
      real(qp) :: m(size(x)), h, u, w
      integer :: i

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
      if (.not. allocated(d%terms)) return
      do i = 1, size(d%terms)
         s = s + term_sizes(d%terms(i), t)
      end do
   end function drive_sizes

   !> The argument of a sine is known to one part in 2**53 of itself; a power's factors are as many as its exponent; a
   !> table's slopes and curvatures are differences divided by its steps; a rise's derivatives grow by 2 pi at most.
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
         f = term_of(term, t)
         s = abs([f%v, f%d, f%dd])*(1.0_qp + r(2))
      case (term_table)
         associate (x => term%table%x, y => term%table%y, n => size(term%table%x))
            steepest = maxval(2.0_qp*maxval(abs(real(y, qp)))/(real(x(2:), qp) - x(:n - 1)))
            widest = maxval(real(x(2:), qp) - x(:n - 1))
            s(2) = 6.0_qp*steepest/minval(real(x(2:), qp) - x(:n - 1))
            s(1) = steepest + s(2)*widest
            s(0) = maxval(abs(real(y, qp))) + s(1)*widest
         end associate
      case (term_cycloid:term_parabola)
         s = r(3)*[2.0_qp, 8.0_qp/r(2), 64.0_qp/r(2)**2]
      end select
   end function term_sizes

   !> By how much (changes) the law of a drive changes at `t` with each of its numbers, times that number. The exponent
   !> of a power counts as exact.
   function drive_changes(drive, t) result(c)
      type(drive_t), intent(in) :: drive
      real(qp), intent(in) :: t
      type(jet_t), allocatable :: c(:)
      type(drive_t) :: one
      integer :: i, k

      allocate (c(0))
      do k = 1, 3
         one = alone(drive, 0)
         one%polynomial(k) = drive%polynomial(k)
         if (abs(drive%polynomial(k)) > 0.0_wp) c = [c, drive_jet(one, t)]
      end do
      if (.not. allocated(drive%terms)) return
      do i = 1, size(drive%terms)
         c = [c, term_changes(alone(drive, i), t)]
      end do
   end function drive_changes

   !> The same of a drive that has one term alone.
   function term_changes(drive, t) result(c)
      type(drive_t), intent(in) :: drive
      real(qp), intent(in) :: t
      type(jet_t), allocatable :: c(:)
      type(drive_t) :: one
      integer :: k

      one = drive
      associate (term => one%terms(1))
         if (term%kind == term_table) then
            allocate (c(size(term%table%y)))
            do k = 1, size(c)
               term%table%y = 0.0_wp
               term%table%y(k) = drive%terms(1)%table%y(k)
               c(k) = drive_jet(one, t)
            end do
            return
         end if
         c = [drive_jet(one, t)]
         if (any(term%kind == [(k, k=term_cycloid, term_parabola)])) c = [c, rise_shift(term, c(1), t)]
         if (term%kind /= term_harmonic) return
         ! The derivative of a sine is the sine a quarter turn on.
         term%r(3) = term%r(3) + acos(0.0_wp)
         associate (r => drive%terms(1)%r)
            c = [c, real(r(3), qp)*drive_jet(one, t), real(r(2), qp)*time_jet(t)*drive_jet(one, t)]
         end associate
      end associate
   end function term_changes

   !> The same with the times of the rise `term`, whose motion at `t` is `f`: later by t, it is as its derivatives say; no
   !> third derivative is above 60 lifts over the cube of the duration, that of the 3-4-5 polynomial.
   type(jet_t) function rise_shift(term, f, t) result(c)
      type(term_t), intent(in) :: term
      type(jet_t), intent(in) :: f
      real(qp), intent(in) :: t
      real(qp) :: r(3), time

      r = abs(real(term%r, qp))
      time = max(abs(t), r(1), r(2))
      c%dd = time*60.0_qp*r(3)/r(2)**3
      ! At a joint the rate and its derivative are zero: what a rounding changes is the next term of the series.
      c%d = time*(abs(f%dd) + real(epsilon(1.0_wp), qp)*c%dd)
      c%v = time*abs(f%d)
   end function rise_shift

   !> `drive` without its polynomial and with term `i` alone, 0: none.
   function alone(drive, i) result(one)
      type(drive_t), intent(in) :: drive
      integer, intent(in) :: i
      type(drive_t) :: one

      one = drive
      one%polynomial = 0.0_wp
      if (allocated(one%terms)) deallocate (one%terms)
      if (i > 0) one%terms = drive%terms(i:i)
   end function alone
end module jet_drives
