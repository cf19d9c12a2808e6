!> Tests. Closed forms of the two mechanisms with seven moving links: chains of dyads. The lengths are those of the
!> decks in input/, written out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_legs
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, pi_q, degree_q, constant_jet, time_jet, &
      operator(+), operator(-), operator(*)
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, place_on, polar, direction, corner
   implicit none
   private
   public :: andrews, jansen

contains

   !> Andrews' squeezing mechanism (Schiehlen 1990; IVP Test Set, Mazzia and Magherini 2008), in millimetres. K1 is the
   !> crank OF, K2 the rod FE, K3 the body at B; from E the rods K4 and K6 run to the bodies K5 and K7 at A. E lies to
   !> the left of the way from F to B, G to the right and H to the left of the way from E to A.
   !> The angles of K1, K3, K4, K5 and K7 are the Test Set's beta, gamma, phi + delta, delta and epsilon.
   pure function andrews(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(8)
      real(qp), parameter :: right = 0.5_qp*pi_q
      ! As the deck's card holds it: a double.
      real(qp), parameter :: start = real(real(-0.0617138900142764496358948458001_qp, wp), qp)
      type(jet_t) :: beta, time
      type(place_t) :: o, a, b, e, f, g, h

      time = time_jet(t)
      beta = 30.0_qp*degree_q*time
      if (set == 2) beta = start + 0.5_qp*time + 0.125_qp*time*time
      o = fixed_place(0.0_qp, 0.0_qp)
      a = fixed_place(-69.34_qp, -2.27_qp)
      b = fixed_place(-36.35_qp, 32.73_qp)
      f = polar(o, 7.0_qp, beta)
      e = corner(f, 28.0_qp, b, 35.0_qp, 1.0_qp)
      g = corner(e, 20.0_qp, a, 40.0_qp, -1.0_qp)
      h = corner(e, 20.0_qp, a, 40.0_qp, 1.0_qp)
      links = [body('BASE', o, constant_jet(0.0_qp)), body('K1', o, beta), body('K2', f, direction(f, e)), &
               body('K3', b, direction(b, e) + right), body('K4', e, direction(e, g) - right), &
               body('K5', a, direction(a, g)), body('K6', e, direction(e, h)), &
               body('K7', a, direction(a, h) + right)]
   end function andrews

   !> Theo Jansen's leg with the numbers he published: a 38, b 41.5, c 39.3, d 40.1, e 55.8, f 39.4, g 36.7, h 65.7,
   !> i 49, j 50, k 61.9, l 7.8, m 15. Crank m about (0, 0), pivot B at (-a, -l); seen along the way from the crank's
   !> pin P to B the triangle's corner X is to the right and C to the left; the ankle V is to the right of the way
   !> from W to C. W follows from the triangle's sides; the deck's cards hold it as doubles.
   pure function jansen(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(8), upper
      real(qp), parameter :: along = (41.5_qp**2 + 40.1_qp**2 - 55.8_qp**2)/(2.0_qp*41.5_qp)
      real(qp), parameter :: xi = real(real(along, wp), qp), eta = real(real(sqrt(40.1_qp**2 - along**2), wp), qp)
      type(jet_t) :: phi
      type(place_t) :: o, b, p, x, c, w, v

      phi = 30.0_qp*degree_q*time_jet(t)
      o = fixed_place(0.0_qp, 0.0_qp)
      b = fixed_place(-38.0_qp, -7.8_qp)
      p = polar(o, 15.0_qp, phi)
      x = corner(p, 50.0_qp, b, 41.5_qp, -1.0_qp)
      c = corner(p, 61.9_qp, b, 39.3_qp, 1.0_qp)
      upper = body('UPPER', b, direction(b, x))
      w = place_on(upper, xi, eta)
      v = corner(w, 39.4_qp, c, 36.7_qp, -1.0_qp)
      links = [body('BASE', o, constant_jet(0.0_qp)), body('CRANK', o, phi), body('ROD-J', p, direction(p, x)), &
               upper, body('ROD-K', p, direction(p, c)), &
               body('ROD-C', b, direction(b, c)), body('ROD-F', w, direction(w, v)), &
               body('FOOT', c, direction(c, v))]
   end function jansen
end module closed_forms_legs
