!> Tests. Closed forms of linkages of bars with a symmetry, which give them without a square root or with one. The
!> lengths are those of the decks in input/, written out again by hand so that a deck read wrongly shows up as a
!> difference.
module closed_forms_bars
   use quad_jet, only: qp, jet_t, degree_q, constant_jet, time_jet, &
      operator(+), operator(-), operator(*), operator(/), sin
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, polar, direction, corner, mirrored, on_line, &
      four_bar_links, bars
   implicit none
   private
   public :: chebyshev, kite, antiparallelogram, hart, two_loops
   public :: kite_links, antiparallelogram_links, swapped

contains

   !> Chebyshev's lambda: crank 1 about (0, 0), rocker 2.5 about (2, 0), coupler 2.5 to the rocker and as far again to
   !> the point that runs along a straight line.
   pure function chebyshev(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = four_bar_links(30.0_qp*degree_q*time_jet(t), [1.0_qp, 2.5_qp, 2.5_qp, 2.0_qp], 1.0_qp)
   end function chebyshev

   !> Kite from 20 deg on; change points at 0 and 180 deg.
   pure function kite(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = kite_links((20.0_qp + 10.0_qp*time_jet(t))*degree_q)
   end function kite

   !> Crank and coupler 1, base and rocker 3: B is the mirror image of A0 in the line from A to B0.
   pure function kite_links(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)
      type(place_t) :: a0, b0, a

      a0 = fixed_place(0.0_qp, 0.0_qp)
      b0 = fixed_place(3.0_qp, 0.0_qp)
      a = polar(a0, 1.0_qp, phi)
      links = bars(phi, a, mirrored(a0, a, b0), b0)
   end function kite_links

   !> Antiparallelogram from 15 deg on; change points at 0 and 180 deg.
   pure function antiparallelogram(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = antiparallelogram_links((15.0_qp + 12.5_qp*time_jet(t))*degree_q)
   end function antiparallelogram

   !> Crank and rocker 2, base and coupler 4.
   pure function antiparallelogram_links(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)
      type(place_t) :: a0, b0, a

      a0 = fixed_place(0.0_qp, 0.0_qp)
      b0 = fixed_place(4.0_qp, 0.0_qp)
      a = polar(a0, 2.0_qp, phi)
      links = bars(phi, a, swapped(a0, a, b0), b0)
   end function antiparallelogram_links

   !> The fourth corner of an antiparallelogram: the symmetry that changes `a` and `b` for one another changes `p` for
   !> it. A mirror whose normal runs from a to b, through their middle; no square root.
   pure type(place_t) function swapped(p, a, b) result(q)
      type(place_t), intent(in) :: p, a, b
      type(jet_t) :: dx, dy, along

      dx = b%x - a%x
      dy = b%y - a%y
      along = ((2.0_qp*p%x - a%x - b%x)*dx + (2.0_qp*p%y - a%y - b%y)*dy)/(dx*dx + dy*dy)
      q = place_t(p%x - along*dx, p%y - along*dy)
   end function swapped

   !> Hart's inversor: antiparallelogram A B C D, AB = CD = 4, BC = DA = 2, pivoted in the middle O of AB; the middle P
   !> of AD is led by the crank on the circle of radius 1.25 about (1.25, 0), through O. OP = BD/2 and OQ = AC/2 lie on
   !> one line, on both sides of O, and OP OQ = (4^2 - 2^2)/4 = 3; so the middle Q of BC runs on x = -3/2.5.
   pure function hart(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6)
      type(jet_t) :: phi
      type(place_t) :: o, m, a, b, c, d, p

      phi = (-100.0_qp + 20.0_qp*time_jet(t))*degree_q
      o = fixed_place(0.0_qp, 0.0_qp)
      m = fixed_place(1.25_qp, 0.0_qp)
      p = polar(m, 1.25_qp, phi)
      a = corner(o, 2.0_qp, p, 1.0_qp, 1.0_qp)
      b = place_t(2.0_qp*o%x - a%x, 2.0_qp*o%y - a%y)
      d = place_t(2.0_qp*p%x - a%x, 2.0_qp*p%y - a%y)
      c = swapped(a, b, d)
      links = [body('BASE', o, constant_jet(0.0_qp)), body('CRANK', m, phi), body('BAR-AB', o, direction(a, b)), &
               body('BAR-BC', b, direction(b, c)), body('BAR-CD', c, direction(c, d)), &
               body('BAR-DA', a, direction(a, d))]
   end function hart

   !> Two mechanisms on one base, each with its own drive: the crank-rocker 1, 3.5, 3 on A0 B0 = 4, and at (1, -4) a
   !> crank 1.5 with a rod 4 to a piston on the line through (1, -4) at -30 deg.
   pure function two_loops(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(7)
      type(jet_t) :: psi, slope, time
      type(place_t) :: o, pin, piston

      time = time_jet(t)
      psi = -0.25_qp + 0.75_qp*time + 0.1_qp*sin(2.0_qp*time)
      slope = constant_jet(-30.0_qp*degree_q)
      o = fixed_place(1.0_qp, -4.0_qp)
      pin = polar(o, 1.5_qp, psi)
      piston = on_line(pin, 4.0_qp, o, slope, 1.0_qp)
      links = [four_bar_links(0.5_qp + time, [1.0_qp, 3.5_qp, 3.0_qp, 4.0_qp], 1.0_qp), &
               body('CRANK-2', o, psi), body('ROD', pin, direction(pin, piston)), body('PISTON', piston, slope)]
      links(2)%name = 'CRANK-1'
   end function two_loops
end module closed_forms_bars
