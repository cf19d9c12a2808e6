!> Tests. Closed forms of linkages that move although the count of freedoms (13) says that they cannot: some of their
!> equations follow from the others. The lengths are those of the decks, written out again by hand.
module closed_forms_overconstrained
   use quad_jet
   use closed_forms_dyads
   implicit none
   private
   public :: overconstrained

contains

   !> The links of the deck `name` at `time`; none for another deck.
   pure function overconstrained(name, time) result(links)
      character(*), intent(in) :: name
      type(jet_t), intent(in) :: time
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('parallel_cranks'); links = parallel_cranks((10.0_qp + 30.0_qp*time)*degree_q)
      case ('double_parallelogram'); links = double_parallelogram((30.0_qp + 8.0_qp*time)*degree_q)
      case ('two_guides')
         ! The carriage is on the line y = 0.5; its second shoe runs in a guide parallel to it.
         links = slider_crank(0.5_qp + 0.75_qp*time, [1.0_qp, 3.0_qp], fixed_place(0.0_qp, 0.5_qp), flat)
         links(4)%name = 'CARRIAGE'
      case ('cognates'); links = cognates((20.0_qp + 24.0_qp*time)*degree_q)
      case ('dixon'); links = dixon((-135.0_qp + 14.0_qp*sin(40.0_qp*degree_q*time))*degree_q)
      case default; allocate (links(0))
      end select
   end function overconstrained

   !> Three cranks 1.5 at (0, 0), (4, 0) and (2, 1) carry one coupler, which only shifts.
   pure function parallel_cranks(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(5)

      links = [base, body('CRANK-1', origin, phi), body('CRANK-2', fixed_place(4.0_qp, 0.0_qp), phi), &
               body('CRANK-3', fixed_place(2.0_qp, 1.0_qp), phi), body('COUPLER', polar(origin, 1.5_qp, phi), flat)]
   end function parallel_cranks

   !> Two cranks 4 at (0, 0) and (3, 0), two couplers 3: one between the cranks' middles, one between their tips.
   pure function double_parallelogram(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(5)

      links = [base, body('CRANK-A', origin, phi), body('CRANK-B', fixed_place(3.0_qp, 0.0_qp), phi), &
               body('LOWER', polar(origin, 2.0_qp, phi), flat), body('UPPER', polar(origin, 4.0_qp, phi), flat)]
   end function double_parallelogram

   !> Roberts: the three four-bars that lead one point P along one curve, joined in P. In complex numbers, with
   !> lambda = (P - A)/(B - A) = (3 + 4i)/6: C0 = A0 + lambda (B0 - A0); A1 = A0 + P - A, C1 = A1 + lambda (A - A0);
   !> B1 = B0 + P - B, C2 = B1 + (1 - lambda)(B - B0); then C0C1 = lambda (B - B0), C0C2 = (1 - lambda)(A - A0).
   !> Crank A0A 1.2, coupler AB 3, rocker B0B 2.4, base A0B0 3.
   pure function cognates(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(10), coupler, left, right
      type(place_t) :: b0, c0, a, b, p, a1, b1

      b0 = fixed_place(3.0_qp, 0.0_qp)
      c0 = fixed_place(1.5_qp, 2.0_qp)
      a = polar(origin, 1.2_qp, phi)
      b = corner(a, 3.0_qp, b0, 2.4_qp, 1.0_qp)
      coupler = body('COUPLER', a, direction(a, b))
      p = place_on(coupler, 1.5_qp, 2.0_qp)
      a1 = place_t(p%x - a%x, p%y - a%y)
      b1 = place_t(b0%x + p%x - b%x, b0%y + p%y - b%y)
      left = body('COUP-L', a1, direction(a1, p))
      right = body('COUP-R', b1, direction(b1, p))
      links = [base, body('CRANK', origin, phi), coupler, &
               body('ROCKER', b0, direction(b0, b)), body('CRANK-L', origin, direction(origin, a1)), left, &
               body('ROCKER-L', c0, direction(c0, place_on(left, 0.6_qp, 0.8_qp))), &
               body('CRANK-R', b0, direction(b0, b1)), right, &
               body('ROCKER-R', c0, direction(c0, place_on(right, 1.2_qp, -1.6_qp)))]
   end function cognates

   !> Dixon's first: K(3,3), nine bars between A1, A2, A3 on one line and B1, B2, B3 on a second one at right angles to
   !> it. With A(i) = (x(i), 0), B(j) = (0, y(j)): x(i)^2 + y(j)^2 = l(i,j)^2, so all x^2 may grow by what all y^2 lose.
   !> l = 64 41 29 / 68 47 37 / 88 73 67: x(i)^2 = s + (0, 528, 3648), y(j)^2 = (4096, 1681, 841) - s.
   !> The bar A1B1 is the base, A1 = (0, 0), B1 = (64, 0); the angle of A1B2 gives D = B1B2 = y(2) - y(1), and
   !> y(2)^2 - y(1)^2 = -2415 the rest.
   pure function dixon(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(9)
      type(jet_t) :: d, s, x(3), y(3)
      type(place_t) :: a(3), b(3)
      integer :: i, j

      d = sqrt(64.0_qp**2 + 41.0_qp**2 - 2.0_qp*64.0_qp*41.0_qp*cos(phi))
      y(1) = -0.5_qp*(2415.0_qp/d + d)
      s = 4096.0_qp - y(1)*y(1)
      y(2) = 0.5_qp*(d - 2415.0_qp/d)
      y(3) = sqrt(841.0_qp - s)
      x = [sqrt(s), -sqrt(528.0_qp + s), sqrt(3648.0_qp + s)]
      do i = 1, 3
         a(i) = seen_from_base(x(i), flat, x(1), y(1))
         b(i) = seen_from_base(flat, y(i), x(1), y(1))
      end do
      links(1) = base
      do i = 1, 3
         do j = 1, 3
            if (i + j == 2) cycle
            links(3*i + j - 3) = body('BAR-'//achar(48 + i)//achar(48 + j), a(i), direction(a(i), b(j)))
         end do
      end do
   end function dixon

   !> The point (x, y) of the two lines' axes in those of the bar from A1 = (x1, 0) to B1 = (0, y1), 64 long.
   pure type(place_t) function seen_from_base(x, y, x1, y1) result(p)
      type(jet_t), intent(in) :: x, y, x1, y1

      p%x = (y*y1 - (x - x1)*x1)/64.0_qp
      p%y = -1.0_qp*(y*x1 + (x - x1)*y1)/64.0_qp
   end function seen_from_base
end module closed_forms_overconstrained
