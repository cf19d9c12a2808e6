!> Tests. Drives of a scheme that grows by the dice: any kind, any law, with the value of the assembly at the first
!> instant.
module scheme_drives
   use kinds, only: wp
   use quad_jet, only: qp, pi_q, jet_t
   use dice, only: throw, chance
   use schemes, only: drive_t, angle_unit, drive_unit, double
   use mechanism, only: term_harmonic, term_power, term_table, term_cycloid
   use drive_laws, only: law_t, law_jet
   use group_newton, only: driven
   use scheme_builder, only: builder_t, number, add_point, anywhere
   implicit none
   private
   public :: add_drive, add_point_drive, set_steady

contains

   !> A drive of `kind` that goes about so far as `amplitude`, in radians or lengths.
   subroutine add_drive(d, kind, subject, second, amplitude)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: kind, subject, second
      real(qp), intent(in) :: amplitude
      type(drive_t) :: drive
      type(jet_t) :: f, now
      real(qp) :: unit

      drive%kind = kind
      drive%subject = subject
      drive%second = second
      unit = drive_unit(d%s, drive)
      call make_law(d, drive%law, amplitude/unit)
      now = driven(d%s, drive, d%b)
      f = law_jet(drive%law, d%t, unit, angle_unit(d%s))
      drive%law%polynomial(1) = double((now%v - f%v)/unit)
      d%s%drives = [d%s%drives, drive]
   end subroutine add_drive

   !> X or Y of a new point of `link`.
   subroutine add_point_drive(d, kind, link, amplitude)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: kind, link
      real(qp), intent(in) :: amplitude

      call add_drive(d, kind, add_point(d, link, anywhere(d)), 0, amplitude)
   end subroutine add_point_drive

   !> A polynomial, mostly with a term, that makes a way of about `amplitude` between the first and the last instant.
   subroutine make_law(d, law, amplitude)
      type(builder_t), intent(inout) :: d
      type(law_t), intent(out) :: law
      real(qp), intent(in) :: amplitude
      real(qp) :: span

      span = d%to - d%from
      law%polynomial(2) = double(number(d, -1.0_qp, 1.0_qp)*amplitude/span)
      if (chance(d%dice, 0.3_wp)) law%polynomial(3) = double(number(d, -1.0_qp, 1.0_qp)*amplitude/span**2)
      select case (throw(d%dice, 8))
      case (1:2)
         law%form = term_harmonic
         law%r(1) = double(number(d, -0.5_qp, 0.5_qp)*amplitude)
         law%r(2) = double(2.0_qp*pi_q/angle_unit(d%s)*number(d, 0.1_qp, 3.0_qp)/span)
         law%r(3) = double(number(d, -pi_q, pi_q)/angle_unit(d%s))
      case (3)
         call make_power(d, law, amplitude)
      case (4)
         call make_table(d, law, amplitude)
      case (5)
         call make_rise(d, law, amplitude)
      case default
         if (chance(d%dice, 0.3_wp)) law%polynomial(3) = 0.0_qp
      end select
   end subroutine make_law

   !> Whole powers anywhere, others and negative ones where time does not come near zero.
   subroutine make_power(d, law, amplitude)
      type(builder_t), intent(inout) :: d
      type(law_t), intent(inout) :: law
      real(qp), intent(in) :: amplitude

      law%form = term_power
      law%r(2) = throw(d%dice, 4)
      if (d%from > 0.2_qp*(d%to - d%from)) then
         select case (throw(d%dice, 3))
         case (1)
            law%r(2) = -throw(d%dice, 3)
         case (2)
            law%r(2) = double(number(d, -1.0_qp, 4.0_qp))
         end select
      end if
      law%r(1) = double(number(d, -1.0_qp, 1.0_qp)*amplitude/max(abs(d%from), abs(d%to))**law%r(2))
      if (law%r(2) < 0.0_qp) law%r(1) = double(law%r(1)*(d%from/d%to)**(-law%r(2)))
   end subroutine make_power

   !> Rows from before the first instant to behind the last.
   subroutine make_table(d, law, amplitude)
      type(builder_t), intent(inout) :: d
      type(law_t), intent(inout) :: law
      real(qp), intent(in) :: amplitude
      integer :: n, k

      law%form = term_table
      n = throw(d%dice, 6) + 1
      allocate (law%time(n), law%value(n))
      associate (span => d%to - d%from)
         do k = 1, n
            law%time(k) = double(d%from - 0.1_qp*span + 1.2_qp*span*(k - 1)/(n - 1))
            law%value(k) = double(number(d, -0.5_qp, 0.5_qp)*amplitude)
            if (k > 1 .and. k < n) law%time(k) = double(law%time(k) + 0.3_qp*span/(n - 1)*number(d, -1.0_qp, 1.0_qp))
         end do
      end associate
   end subroutine make_table

   !> A rise somewhere among the instants, at times from the first on or up to the last.
   subroutine make_rise(d, law, amplitude)
      type(builder_t), intent(inout) :: d
      type(law_t), intent(inout) :: law
      real(qp), intent(in) :: amplitude

      law%form = term_cycloid + throw(d%dice, 4) - 1
      associate (span => d%to - d%from)
         law%r(1) = double(d%from + number(d, -0.2_qp, 0.7_qp)*span)
         if (chance(d%dice, 0.3_wp)) law%r(1) = double(d%from)
         law%r(2) = double(number(d, 0.1_qp, 1.0_qp)*span)
         if (chance(d%dice, 0.3_wp)) law%r(2) = double(d%to - law%r(1))
         law%r(3) = double(number(d, -1.0_qp, 1.0_qp)*amplitude)
      end associate
   end subroutine make_rise

   !> The last drive goes on with one rate, by `way` from the first instant to the last.
   subroutine set_steady(d, way)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: way
      type(law_t) :: law
      type(jet_t) :: now
      real(qp) :: unit

      associate (drive => d%s%drives(size(d%s%drives)))
         unit = drive_unit(d%s, drive)
         law%polynomial(2) = double(way/unit/(d%to - d%from))
         now = driven(d%s, drive, d%b)
         law%polynomial(1) = double(now%v/unit - law%polynomial(2)*d%t)
         drive%law = law
      end associate
   end subroutine set_steady
end module scheme_drives
