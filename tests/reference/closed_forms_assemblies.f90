!> Tests. All assemblies of the decks with cards ASSEMBLY and CIRCUITS: a platform on three legs by its polynomial of
!> degree six (Gosselin and Sefrioui 1991; Merlet, Parallel Robots), a four-bar by the law of cosines. Roots are
!> bracketed by those of the derivatives, so none is missed.
module closed_forms_assemblies
   use quad_jet, only: qp, constant_jet
   use closed_forms_dyads, only: place_t, body_t, base, fixed_place, body, direction
   implicit none
   private
   public :: platform_assemblies, platform, crank_limit

   !> Joints of the base and of the platform, and the legs between them.
   real(qp), parameter :: feet(2, 3) = reshape([0.0_qp, 0.0_qp, 15.91_qp, 0.0_qp, 0.0_qp, 10.0_qp], [2, 3])
   real(qp), parameter :: plate(2, 3) = reshape([0.0_qp, 0.0_qp, 17.04_qp, 0.0_qp, &
      13.2363732394_qp, 16.0967084668_qp], [2, 3])
   real(qp), parameter :: leg(3) = [14.98_qp, 15.38_qp, 12.0_qp]

contains

   !> All positions (3, any number) of the platform, x, y, phi. Its joints 2 and 3 are at their distances from the base
   !> if P x + Q y + S = 0, which give x = X/D, y = Y/D; joint 1 if X^2 + Y^2 = leg^2 D^2. With t = tan(phi/2) all are
   !> polynomials, and that equation is 1 + t^2 times one of degree six.
   pure function platform_assemblies() result(position)
      real(qp), allocatable :: position(:, :)
      real(qp) :: p(0:2, 2), q(0:2, 2), s(0:2, 2), x(0:4), y(0:4), d(0:4), f(0:8), sextic(0:6)
      real(qp), allocatable :: roots(:)
      integer :: k

      do k = 1, 2
         associate (a => feet(:, k + 1), b => plate(:, k + 1))
            p(:, k) = 2.0_qp*half_angle(b(1), -b(2), -a(1))
            q(:, k) = 2.0_qp*half_angle(b(2), b(1), -a(2))
            s(:, k) = half_angle(-2.0_qp*dot_product(a, b), 2.0_qp*(a(1)*b(2) - a(2)*b(1)), &
               sum(a**2) + sum(b**2) + leg(1)**2 - leg(k + 1)**2)
         end associate
      end do
      d = product_of(p(:, 1), q(:, 2)) - product_of(p(:, 2), q(:, 1))
      x = product_of(s(:, 2), q(:, 1)) - product_of(s(:, 1), q(:, 2))
      y = product_of(p(:, 2), s(:, 1)) - product_of(p(:, 1), s(:, 2))
      f = product_of(x, x) + product_of(y, y) - leg(1)**2*product_of(d, d)
      do k = 8, 2, -1
         f(k - 2) = f(k - 2) - f(k)
      end do
      sextic = f(2:)
      if (maxval(abs(f(:1))) > 1.0e-24_qp*maxval(abs(f))) error stop 'NO FACTOR 1 + T^2'
      roots = real_roots(sextic)
      allocate (position(3, size(roots)))
      do k = 1, size(roots)
         position(:, k) = refined([value_of(x, roots(k))/value_of(d, roots(k)), &
            value_of(y, roots(k))/value_of(d, roots(k)), 2.0_qp*atan(roots(k))])
      end do
   end function platform_assemblies

   !> The position `at` after a step of Newton's method on the lengths of the legs: the coefficients of the polynomial
   !> have lost two digits.
   pure function refined(at) result(position)
      real(qp), intent(in) :: at(3)
      real(qp) :: position(3), joint(2), turned(2), rows(3, 3), gap(3), one(3, 3)
      integer :: k

      do k = 1, 3
         turned = [plate(1, k)*cos(at(3)) - plate(2, k)*sin(at(3)), plate(1, k)*sin(at(3)) + plate(2, k)*cos(at(3))]
         joint = at(:2) + turned - feet(:, k)
         rows(k, :) = [joint, joint(2)*turned(1) - joint(1)*turned(2)]
         gap(k) = 0.5_qp*(leg(k)**2 - sum(joint**2))
      end do
      do k = 1, 3
         one = rows
         one(:, k) = gap
         position(k) = at(k) + determinant(one)/determinant(rows)
      end do
   end function refined

   pure real(qp) function determinant(a)
      real(qp), intent(in) :: a(3, 3)

      determinant = a(1, 1)*(a(2, 2)*a(3, 3) - a(2, 3)*a(3, 2)) - a(1, 2)*(a(2, 1)*a(3, 3) - a(2, 3)*a(3, 1)) &
         + a(1, 3)*(a(2, 1)*a(3, 2) - a(2, 2)*a(3, 1))
   end function determinant

   !> (1 + t^2)(a cos phi + b sin phi + c), t = tan(phi/2).
   pure function half_angle(a, b, c) result(p)
      real(qp), intent(in) :: a, b, c
      real(qp) :: p(0:2)

      p = [a + c, 2.0_qp*b, c - a]
   end function half_angle

   !> The product of two polynomials, the constant coefficient first.
   pure function product_of(a, b) result(c)
      real(qp), intent(in) :: a(0:), b(0:)
      real(qp) :: c(0:ubound(a, 1) + ubound(b, 1))
      integer :: k

      c = 0.0_qp
      do k = 0, ubound(a, 1)
         c(k:k + ubound(b, 1)) = c(k:k + ubound(b, 1)) + a(k)*b
      end do
   end function product_of

   !> The polynomial `a` at `t`.
   pure real(qp) function value_of(a, t) result(value)
      real(qp), intent(in) :: a(0:), t
      integer :: k

      value = 0.0_qp
      do k = ubound(a, 1), 0, -1
         value = value*t + a(k)
      end do
   end function value_of

   !> All real roots of the polynomial `a`, each single: between two roots of its derivative there is one at most.
   pure recursive function real_roots(a) result(roots)
      real(qp), intent(in) :: a(0:)
      real(qp), allocatable :: roots(:), ends(:)
      real(qp) :: low, high, middle, bound
      integer :: n, k

      n = ubound(a, 1)
      allocate (roots(0))
      if (n == 0) return
      bound = 1.0_qp + maxval(abs(a(:n - 1)))/abs(a(n))
      ends = [-bound, real_roots([(k*a(k), k=1, n)]), bound]
      do k = 1, size(ends) - 1
         low = ends(k)
         high = ends(k + 1)
         if (value_of(a, low)*value_of(a, high) > 0.0_qp) cycle
         do
            middle = 0.5_qp*(low + high)
            if (middle <= low .or. middle >= high) exit
            if (value_of(a, low)*value_of(a, middle) <= 0.0_qp) high = middle
            if (high > middle) low = middle
         end do
         roots = [roots, middle]
      end do
   end function real_roots

   !> The links with the platform at `position`, at rest.
   pure function platform(position) result(links)
      real(qp), intent(in) :: position(3)
      type(body_t) :: links(5)
      type(place_t) :: joint, foot
      integer :: k
      character(5), parameter :: names(3) = ['LEG-1', 'LEG-2', 'LEG-3']

      links(1) = base
      links(2) = body('PLATFORM', fixed_place(position(1), position(2)), constant_jet(position(3)))
      do k = 1, 3
         joint = fixed_place(position(1) + plate(1, k)*cos(position(3)) - plate(2, k)*sin(position(3)), &
            position(2) + plate(1, k)*sin(position(3)) + plate(2, k)*cos(position(3)))
         foot = fixed_place(feet(1, k), feet(2, k))
         links(k + 2) = body(names(k), foot, direction(foot, joint))
      end do
   end function platform

   !> The crank of the triple rocker goes no further where coupler and rocker are in line, 4.5 long.
   pure real(qp) function crank_limit()
      crank_limit = acos((2.0_qp**2 + 4.0_qp**2 - 4.5_qp**2)/(2.0_qp*2.0_qp*4.0_qp))
   end function crank_limit
end module closed_forms_assemblies
