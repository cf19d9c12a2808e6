!> Tests. The links of any group from those before it: Newton's method with residuals in real128 and the inverse of the
!> Jacobian in real64, for positions, velocities and accelerations at once, as jets.
module group_newton
   use, intrinsic :: iso_fortran_env, only: real64
   use quad_jet, only: qp, jet_t, constant_jet, operator(+), operator(-), operator(*), sin, cos
   use mechanism, only: drive_angle, drive_relangle, drive_x, drive_slide
   use schemes, only: scheme_t, group_t, pair_t, drive_t, body_t, angle_unit, is_angle, drive_unit, link_at, place, &
      set_trigonometry
   use drive_laws, only: law_jet
   implicit none
   private
   public :: outcome_t, solve_group, residuals, driven

   !> What an iteration was like; lengths in units of the group's.
   type :: outcome_t
      logical :: converged = .false.
      real(real64) :: first = 0.0_real64       !< the largest number of the first correction
      real(real64) :: inverse = 0.0_real64     !< norm of the Jacobian's inverse
      integer :: sign = 0                      !< of its determinant
   end type outcome_t

   integer, parameter :: max_iterations = 30

contains

   !> Closes group `g` at the time `t` from `b` on, to the part `tolerance` of its numbers.
   subroutine solve_group(s, g, t, tolerance, b, o)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      real(qp), intent(in) :: t, tolerance
      type(body_t), intent(inout) :: b(:)
      type(outcome_t), intent(out) :: o
      type(jet_t), allocatable :: r(:)
      real(real64), allocatable :: inverse(:, :), step(:, :)
      real(real64) :: size_of(3), off(3)
      integer :: iteration, n, k, l

      n = 3*(g%links(2) - g%links(1) + 1)
      allocate (step(n, 3))
      do iteration = 1, max_iterations
         call set_trigonometry(b(g%links(1):g%links(2)))
         r = residuals(s, g, t, b)
         if (size(r) /= n) return
         if (iteration <= 3) then
            inverse = jacobian(s, g, b)
            call invert(inverse, o%sign)
            if (o%sign == 0) return
            o%inverse = maxval(sum(abs(inverse), 2))
         end if
         step(:, 1) = matmul(inverse, real(r%v, real64))
         step(:, 2) = matmul(inverse, real(r%d, real64))
         step(:, 3) = matmul(inverse, real(r%dd, real64))
         size_of = tiny(1.0_real64)
         do k = 1, n/3
            l = g%links(1) + k - 1
            b(l)%x = less(b(l)%x, g%scale, step(3*k - 2, :))
            b(l)%y = less(b(l)%y, g%scale, step(3*k - 1, :))
            b(l)%phi = less(b(l)%phi, 1.0_qp, step(3*k, :))
            size_of(2) = max(size_of(2), speed_of(b(l)%x%d, b(l)%y%d, b(l)%phi%d, g%scale))
            size_of(3) = max(size_of(3), speed_of(b(l)%x%dd, b(l)%y%dd, b(l)%phi%dd, g%scale))
         end do
         off = maxval(abs(step), 1)
         if (iteration == 1) o%first = off(1)
         size_of(1) = 1.0_real64
         size_of(3) = max(size_of(3), size_of(2)**2)
         if (.not. off(1) < 1.0e3_real64) return
         o%converged = all(off <= tolerance*size_of)
         if (o%converged) exit
      end do
      call set_trigonometry(b(g%links(1):g%links(2)))
   end subroutine solve_group

   pure real(real64) function speed_of(x, y, phi, scale)
      real(qp), intent(in) :: x, y, phi, scale

      speed_of = real(max(abs(x)/scale, abs(y)/scale, abs(phi)), real64)
   end function speed_of

   pure type(jet_t) function less(a, scale, step)
      type(jet_t), intent(in) :: a
      real(qp), intent(in) :: scale
      real(real64), intent(in) :: step(3)

      less = jet_t(a%v - scale*step(1), a%d - scale*step(2), a%dd - scale*step(3))
   end function less

   !> What the equations of group `g` leave at the time `t`, as jets, lengths in units of the group's: two of each pair,
   !> one of each drive.
   function residuals(s, g, t, b) result(r)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      real(qp), intent(in) :: t
      type(body_t), intent(in) :: b(:)
      type(jet_t), allocatable :: r(:)
      integer :: pairs, k

      pairs = g%pairs(2) - g%pairs(1) + 1
      allocate (r(2*pairs + g%drives(2) - g%drives(1) + 1))
      do k = 1, pairs
         r(2*k - 1:2*k) = pair_residuals(s, s%pairs(g%pairs(1) + k - 1), b, g%scale)
      end do
      do k = g%drives(1), g%drives(2)
         associate (drive => s%drives(k), row => r(2*pairs + k - g%drives(1) + 1))
            row = driven(s, drive, b) - law_jet(drive%law, t, drive_unit(s, drive), angle_unit(s))
            if (.not. is_angle(drive)) row = (1.0_qp/g%scale)*row
         end associate
      end do
   end function residuals

   function pair_residuals(s, pair, b, scale) result(r)
      type(scheme_t), intent(in) :: s
      type(pair_t), intent(in) :: pair
      type(body_t), intent(in) :: b(:)
      real(qp), intent(in) :: scale
      type(jet_t) :: r(2), d(2), theta
      integer :: i, j

      i = link_at(s, pair%point_i)
      j = link_at(s, pair%point_j)
      d = place(b(i), s%points(pair%point_i)%offset) - place(b(j), s%points(pair%point_j)%offset)
      if (pair%prismatic) then
         theta = b(i)%phi + pair%alpha*angle_unit(s)
         r(1) = (1.0_qp/scale)*(d(2)*cos(theta) - d(1)*sin(theta) - pair%h)
         r(2) = b(j)%phi - b(i)%phi - pair%beta*angle_unit(s)
      else
         r = (1.0_qp/scale)*d
      end if
   end function pair_residuals

   !> What `drive` moves: an angle in radians or a length.
   type(jet_t) function driven(s, drive, b) result(x)
      type(scheme_t), intent(in) :: s
      type(drive_t), intent(in) :: drive
      type(body_t), intent(in) :: b(:)
      type(jet_t) :: p(2), theta

      select case (drive%kind)
      case (drive_angle)
         x = b(drive%subject)%phi
      case (drive_relangle)
         x = b(drive%second)%phi - b(drive%subject)%phi
      case (drive_slide)
         associate (pair => s%pairs(drive%subject))
            p = place(b(link_at(s, pair%point_j)), s%points(pair%point_j)%offset) &
               - place(b(link_at(s, pair%point_i)), s%points(pair%point_i)%offset)
            theta = b(link_at(s, pair%point_i))%phi + pair%alpha*angle_unit(s)
            x = p(1)*cos(theta) + p(2)*sin(theta)
         end associate
      case default
         p = place(b(link_at(s, drive%subject)), s%points(drive%subject)%offset)
         x = p(merge(1, 2, drive%kind == drive_x))
      end select
   end function driven

   !> Derivatives of the residuals by x/scale, y/scale and phi of the group's links: what they do at unit rates.
   function jacobian(s, g, b) result(a)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      real(real64), allocatable :: a(:, :)
      type(body_t) :: moving(size(b))
      type(jet_t) :: r(2)
      integer :: pairs, k, l, c, column

      moving%x = constant_jet(b%x%v)
      moving%y = constant_jet(b%y%v)
      moving%phi = constant_jet(b%phi%v)
      moving%c = constant_jet(b%c%v)
      moving%s = constant_jet(b%s%v)
      pairs = g%pairs(2) - g%pairs(1) + 1
      allocate (a(2*pairs + g%drives(2) - g%drives(1) + 1, 3*(g%links(2) - g%links(1) + 1)), source=0.0_real64)
      do column = 1, size(a, 2)
         l = g%links(1) + (column - 1)/3
         c = 1 + modulo(column - 1, 3)
         associate (body => moving(l))
            body%x%d = merge(g%scale, 0.0_qp, c == 1)
            body%y%d = merge(g%scale, 0.0_qp, c == 2)
            body%phi%d = merge(1.0_qp, 0.0_qp, c == 3)
            body%c%d = -body%s%v*body%phi%d
            body%s%d = body%c%v*body%phi%d
         end associate
         do k = 1, pairs
            associate (pair => s%pairs(g%pairs(1) + k - 1))
               if (all([link_at(s, pair%point_i), link_at(s, pair%point_j)] /= l)) cycle
               r = pair_residuals(s, pair, moving, g%scale)
               a(2*k - 1:2*k, column) = real(r%d, real64)
            end associate
         end do
         do k = g%drives(1), g%drives(2)
            r(1) = driven(s, s%drives(k), moving)
            if (.not. is_angle(s%drives(k))) r(1) = (1.0_qp/g%scale)*r(1)
            a(2*pairs + k - g%drives(1) + 1, column) = real(r(1)%d, real64)
         end do
         if (c == 3) then
            moving(l)%phi%d = 0.0_qp
            moving(l)%c%d = 0.0_qp
            moving(l)%s%d = 0.0_qp
         end if
      end do
   end function jacobian

   !> `a` becomes its inverse, by Gauss and Jordan with exchanges of rows; `sign`: that of its determinant, 0 where it
   !> has none.
   pure subroutine invert(a, sign)
      real(real64), intent(inout) :: a(:, :)
      integer, intent(out) :: sign
      integer :: n, k, i, swap(size(a, 1))
      real(real64) :: pivot, factor
      real(real64) :: row(size(a, 1))

      n = size(a, 1)
      sign = 1
      do k = 1, n
         i = k - 1 + maxloc(abs(a(k:, k)), 1)
         swap(k) = i
         if (i /= k) then
            row = a(k, :)
            a(k, :) = a(i, :)
            a(i, :) = row
            sign = -sign
         end if
         pivot = a(k, k)
         if (.not. abs(pivot) > 1.0e-13_real64) then
            sign = 0
            return
         end if
         if (pivot < 0.0_real64) sign = -sign
         a(k, k) = 1.0_real64
         a(k, :) = a(k, :)/pivot
         do i = 1, n
            if (i == k) cycle
            factor = a(i, k)
            a(i, k) = 0.0_real64
            if (abs(factor) > 0.0_real64) a(i, :) = a(i, :) - factor*a(k, :)
         end do
      end do
      do k = n, 1, -1
         if (swap(k) == k) cycle
         row = a(:, k)
         a(:, k) = a(:, swap(k))
         a(:, swap(k)) = row
      end do
   end subroutine invert
end module group_newton
