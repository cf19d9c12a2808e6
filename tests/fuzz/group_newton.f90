!> Tests. The links of any group from those before it: Newton's method with residuals in real128 and the inverse of the
!> Jacobian in real64, for positions, velocities and accelerations at once, as jets.
module group_newton
   use, intrinsic :: iso_fortran_env, only: real64
   use quad_jet, only: qp, jet_t, operator(+), operator(-), operator(*), sin, cos
   use schemes, only: scheme_t, group_t, pair_t, body_t, drive_angle, drive_relangle, drive_x, drive_y, drive_slide, &
      angle_unit, drive_unit, link_at, place, set_trigonometry
   use drive_laws, only: law_jet
   implicit none
   private
   public :: outcome_t, solve_group, residuals

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
         r(2*pairs + k - g%drives(1) + 1) = drive_residual(s, k, t, b, g%scale)
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

   function drive_residual(s, k, t, b, scale) result(r)
      type(scheme_t), intent(in) :: s
      integer, intent(in) :: k
      real(qp), intent(in) :: t, scale
      type(body_t), intent(in) :: b(:)
      type(jet_t) :: r, f, p(2), d(2), theta

      associate (drive => s%drives(k))
         f = law_jet(drive%law, t, drive_unit(s, drive), angle_unit(s))
         select case (drive%kind)
         case (drive_angle)
            r = b(drive%subject)%phi - f
         case (drive_relangle)
            r = b(drive%second)%phi - b(drive%subject)%phi - f
         case (drive_x, drive_y)
            p = place(b(link_at(s, drive%subject)), s%points(drive%subject)%offset)
            if (drive%kind == drive_x) then
               r = (1.0_qp/scale)*(p(1) - f)
            else
               r = (1.0_qp/scale)*(p(2) - f)
            end if
         case (drive_slide)
            associate (pair => s%pairs(drive%subject))
               d = place(b(link_at(s, pair%point_j)), s%points(pair%point_j)%offset) &
                  - place(b(link_at(s, pair%point_i)), s%points(pair%point_i)%offset)
               theta = b(link_at(s, pair%point_i))%phi + pair%alpha*angle_unit(s)
               r = (1.0_qp/scale)*(d(1)*cos(theta) + d(2)*sin(theta) - f)
            end associate
         end select
      end associate
   end function drive_residual

   !> Derivatives of the residuals by x/scale, y/scale and phi of the group's links.
   function jacobian(s, g, b) result(a)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      real(real64), allocatable :: a(:, :)
      integer :: n, k, row

      n = 3*(g%links(2) - g%links(1) + 1)
      allocate (a(n, n), source=0.0_real64)
      do k = g%pairs(1), g%pairs(2)
         row = 2*(k - g%pairs(1)) + 1
         if (s%pairs(k)%prismatic) then
            call slide_row(s, g, b, s%pairs(k), .false., a(row, :))
            call add(a(row + 1, :), g, link_at(s, s%pairs(k)%point_j), 3, 1.0_real64)
            call add(a(row + 1, :), g, link_at(s, s%pairs(k)%point_i), 3, -1.0_real64)
         else
            call place_row(s, g, b, s%pairs(k)%point_i, 1.0_real64, [1.0_real64, 0.0_real64], a(row, :))
            call place_row(s, g, b, s%pairs(k)%point_j, -1.0_real64, [1.0_real64, 0.0_real64], a(row, :))
            call place_row(s, g, b, s%pairs(k)%point_i, 1.0_real64, [0.0_real64, 1.0_real64], a(row + 1, :))
            call place_row(s, g, b, s%pairs(k)%point_j, -1.0_real64, [0.0_real64, 1.0_real64], a(row + 1, :))
         end if
      end do
      do k = g%drives(1), g%drives(2)
         row = 2*(g%pairs(2) - g%pairs(1) + 1) + k - g%drives(1) + 1
         associate (drive => s%drives(k))
            select case (drive%kind)
            case (drive_angle)
               call add(a(row, :), g, drive%subject, 3, 1.0_real64)
            case (drive_relangle)
               call add(a(row, :), g, drive%second, 3, 1.0_real64)
               call add(a(row, :), g, drive%subject, 3, -1.0_real64)
            case (drive_x)
               call place_row(s, g, b, drive%subject, 1.0_real64, [1.0_real64, 0.0_real64], a(row, :))
            case (drive_y)
               call place_row(s, g, b, drive%subject, 1.0_real64, [0.0_real64, 1.0_real64], a(row, :))
            case (drive_slide)
               call slide_row(s, g, b, s%pairs(drive%subject), .true., a(row, :))
            end select
         end associate
      end do
   end function jacobian

   !> Adds to `row` the derivative by coordinate `c` of `link`, where that is one of the group.
   pure subroutine add(row, g, link, c, value)
      real(real64), intent(inout) :: row(:)
      type(group_t), intent(in) :: g
      integer, intent(in) :: link, c
      real(real64), intent(in) :: value

      if (link < g%links(1) .or. link > g%links(2)) return
      associate (k => 3*(link - g%links(1)) + c)
         row(k) = row(k) + value
      end associate
   end subroutine add

   !> `factor` times the derivative of the place of `point` in the direction `e`.
   pure subroutine place_row(s, g, b, point, factor, e, row)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: point
      real(real64), intent(in) :: factor, e(2)
      real(real64), intent(inout) :: row(:)
      real(real64) :: u(2)

      associate (link => s%points(point)%link)
         u = arm(s, b, point)/real(g%scale, real64)
         call add(row, g, link, 1, factor*e(1))
         call add(row, g, link, 2, factor*e(2))
         call add(row, g, link, 3, factor*(e(2)*u(1) - e(1)*u(2)))
      end associate
   end subroutine place_row

   !> From the origin of its link to `point`.
   pure function arm(s, b, point) result(u)
      type(scheme_t), intent(in) :: s
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: point
      real(real64) :: u(2)

      associate (o => s%points(point)%offset, c => b(s%points(point)%link)%c%v, s_ => b(s%points(point)%link)%s%v)
         u = real([o(1)*c - o(2)*s_, o(1)*s_ + o(2)*c], real64)
      end associate
   end function arm

   !> Of (P - Q) . n, or of the slide (Q - P) . e.
   pure subroutine slide_row(s, g, b, pair, is_slide, row)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      type(pair_t), intent(in) :: pair
      logical, intent(in) :: is_slide
      real(real64), intent(inout) :: row(:)
      real(real64) :: e(2), n(2), d(2), theta
      type(jet_t) :: p(2), q(2)
      integer :: i

      i = s%points(pair%point_i)%link
      theta = real(b(i)%phi%v + pair%alpha*angle_unit(s), real64)
      e = [cos(theta), sin(theta)]
      n = [-e(2), e(1)]
      p = place(b(i), s%points(pair%point_i)%offset)
      q = place(b(s%points(pair%point_j)%link), s%points(pair%point_j)%offset)
      d = real([p(1)%v - q(1)%v, p(2)%v - q(2)%v]/g%scale, real64)
      if (is_slide) then
         call place_row(s, g, b, pair%point_i, -1.0_real64, e, row)
         call place_row(s, g, b, pair%point_j, 1.0_real64, e, row)
         call add(row, g, i, 3, -dot_product(d, n))
      else
         call place_row(s, g, b, pair%point_i, 1.0_real64, n, row)
         call place_row(s, g, b, pair%point_j, -1.0_real64, n, row)
         call add(row, g, i, 3, -dot_product(d, e))
      end if
   end subroutine slide_row

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
