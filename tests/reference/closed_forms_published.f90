!> Tests. Closed forms of mechanisms of which other programs have printed results (tests/validation). In the drawing of
!> each deck the axes of all links are parallel. Points are written out again by hand, seen from the reference points of
!> their links.
module closed_forms_published
   use quad_jet
   use closed_forms_dyads
   implicit none
   private
   public :: published

   !> The ground of these decks.
   type(body_t), parameter :: frame = body_t(flat, flat, flat, 'FRAME')

contains

   !> The links of the deck `name` at `time`, in its set number `set`; none for another deck.
   pure function published(name, set, time) result(links)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('ten_plates'); links = ten_plates(time)
      case ('teaching_four_bar')
         ! The deck gives the speed of the crank as a double.
         links = teaching_four_bar(1.0796606752837_qp*time)
      case ('watt_i')
         ! Ten turns a minute, in the second set back.
         links = watt_i(merge(1.0471975511966_qp, -1.0471975511966_qp, set == 1)*time)
      case default; allocate (links(0))
      end select
   end function published

   !> Ten plates. The cylinders A-D (C4, C3) and B-H (C6, C5), whose lengths are driven, have the directions 1.249...
   !> and 1.325... in their links' axes. D lies to the right of A E, H to that of B G; then come two dyads, where I lies
   !> to the right of F J, N to the left of K L.
   pure function ten_plates(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(11), c1, c2, c7, c8
      real(qp), parameter :: along_ad = 1.2490457723983_qp, along_bh = 1.325817663668_qp
      type(jet_t) :: ad, bh
      type(place_t) :: b, e, d, g, h, f, j, i, k, l, n

      ad = 0.58245553203368_qp + 0.08_qp*sin(3.1415926535898_qp*time + 0.7853981633974_qp)
      bh = 0.78462112512353_qp + 0.1_qp*sin(0.7853981633974_qp*time - 1.0471975511966_qp)
      b = fixed_place(0.3_qp, 0.0_qp)
      e = fixed_place(-0.1_qp, 0.7_qp)
      d = third_corner(origin, e, ad*ad, squared(0.3_qp, -0.1_qp), -1.0_qp)
      c1 = link_at('C1', e, -0.1_qp, -0.15_qp, turned(e, d, 0.3_qp, -0.1_qp))
      g = place_on(c1, 0.0_qp, 0.35_qp)
      h = third_corner(b, g, bh*bh, squared(0.5_qp, -0.4_qp), -1.0_qp)
      c2 = link_at('C2', g, -0.4_qp, 0.45_qp, turned(g, h, 0.5_qp, -0.4_qp))
      f = place_on(c1, -0.2_qp, -0.05_qp)
      j = place_on(c2, 0.3_qp, -0.45_qp)
      i = third_corner(f, j, squared(0.7_qp, -0.9_qp), squared(0.2_qp, 0.4_qp), -1.0_qp)
      c7 = link_at('C7', f, -0.6_qp, 0.7_qp, turned(f, i, 0.7_qp, -0.9_qp))
      c8 = link_at('C8', j, 0.05_qp, 0.05_qp, turned(i, j, 0.2_qp, 0.4_qp))
      k = place_on(c8, 0.15_qp, 0.35_qp)
      l = place_on(c7, 0.6_qp, -0.6_qp)
      n = third_corner(k, l, squared(0.5_qp, -0.6_qp), squared(0.3_qp, 0.5_qp), 1.0_qp)
      links = [frame, c1, c2, &
               link_at('C3', d, 0.05_qp, 0.15_qp, direction(origin, d) - along_ad), &
               link_at('C4', origin, -0.05_qp, -0.15_qp, direction(origin, d) - along_ad), &
               link_at('C5', h, 0.05_qp, 0.2_qp, direction(b, h) - along_bh), &
               link_at('C6', b, -0.05_qp, -0.2_qp, direction(b, h) - along_bh), c7, c8, &
               link_at('C9', k, -0.25_qp, 0.3_qp, turned(k, n, 0.5_qp, -0.6_qp)), &
               link_at('C10', l, -0.2_qp, -0.25_qp, turned(l, n, 0.3_qp, 0.5_qp))]
   end function ten_plates

   !> Teaching four-bar: crank 1.52 about (0, 0) at the angle `phi`, the rocker about (4.572, 0); C lies to the left of
   !> B D.
   pure function teaching_four_bar(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4), crank
      type(place_t) :: b, c, d

      d = fixed_place(4.572_qp, 0.0_qp)
      crank = body('ABH', origin, phi)
      b = place_on(crank, 1.52_qp, 0.0_qp)
      c = third_corner(b, d, squared(2.71_qp, 3.029_qp), squared(-0.342_qp, 3.029_qp), 1.0_qp)
      links = [frame, crank, body('BCFG', b, turned(b, c, 2.71_qp, 3.029_qp)), &
               body('CDEI', d, turned(d, c, -0.342_qp, 3.029_qp))]
   end function teaching_four_bar

   !> Watt's first six-bar: crank AB about (-3.74, -2.41) at the angle `phi`, CFG about (7.32, -3.51); C lies to the
   !> left of B G, E to that of D F.
   pure function watt_i(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(6), crank, bcd, cfg
      type(place_t) :: b, c, d, e, f, g

      g = fixed_place(7.32_qp, -3.51_qp)
      crank = body('AB', fixed_place(-3.74_qp, -2.41_qp), phi)
      b = place_on(crank, 1.02_qp, 3.32_qp)
      c = third_corner(b, g, squared(4.3_qp, -0.48_qp), squared(-5.74_qp, 3.94_qp), 1.0_qp)
      bcd = body('BCD', b, turned(b, c, 4.3_qp, -0.48_qp))
      cfg = body('CFG', g, turned(g, c, -5.74_qp, 3.94_qp))
      d = place_on(bcd, 2.48_qp, 3.1_qp)
      f = place_on(cfg, 0.82_qp, 6.86_qp)
      e = third_corner(d, f, squared(5.32_qp, 1.3_qp), squared(3.06_qp, -1.96_qp), 1.0_qp)
      links = [frame, crank, bcd, &
               body('DE', d, turned(d, e, 5.32_qp, 1.3_qp)), body('EF', e, turned(e, f, 3.06_qp, -1.96_qp)), cfg]
   end function watt_i

   !> The angle by which a link is turned whose points `p` and `q` are (x, y) apart in its own axes.
   pure type(jet_t) function turned(p, q, x, y)
      type(place_t), intent(in) :: p, q
      real(qp), intent(in) :: x, y

      turned = direction(p, q) - atan2(y, x)
   end function turned

   !> The link `name` with its axes at `phi` and its point (xi, eta) at `p`.
   pure type(body_t) function link_at(name, p, xi, eta, phi)
      character(*), intent(in) :: name
      type(place_t), intent(in) :: p
      real(qp), intent(in) :: xi, eta
      type(jet_t), intent(in) :: phi

      link_at = body(name, place_on(body(name, p, phi), -xi, -eta), phi)
   end function link_at

   !> The square of the length of (x, y), which stays the same.
   pure type(jet_t) function squared(x, y)
      real(qp), intent(in) :: x, y

      squared = constant_jet(x**2 + y**2)
   end function squared
end module closed_forms_published
