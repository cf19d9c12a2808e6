!> Tests. Closed forms of linkages with revolute pairs and more than four links: chains of dyads, and those with a
!> symmetry. The lengths are those of the decks in input/, written out again by hand so that a deck read wrongly shows
!> up as a difference.
module closed_forms_linkages
   use kinds, only: wp
   use quad_jet
   use closed_forms_dyads
   implicit none
   private
   public :: linkages

   !> Crank, coupler, rocker and base of the crank-rocker.
   real(qp), parameter :: sizes(4) = [1.0_qp, 3.5_qp, 3.0_qp, 4.0_qp]

contains

   !> The links of the deck `name` at `time`, in its set number `set`; none for another deck.
   pure function linkages(name, set, time) result(links)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('peaucellier'); links = peaucellier((-60.0_qp + 10.0_qp*time)*degree_q)
      case ('hart'); links = hart((-100.0_qp + 20.0_qp*time)*degree_q)
      case ('five_bar')
         ! The right crank is given against the left: 60 deg + 20 deg a second, so it turns twice as fast.
         links = five_bar(20.0_qp*degree_q*time, 20.0_qp*degree_q*time + (60.0_qp + 20.0_qp*time)*degree_q)
      case ('pantograph')
         if (set == 1) links = pantograph(place_t(1.2_qp + 0.3_qp*sin(time), &
            0.4_qp + 0.25_qp*sin(2.0_qp*time + 0.5_qp)))
         if (set == 2) links = pantograph(place_t(1.0_qp + 0.25_qp*time, 0.75_qp - 0.5_qp*time + 0.1_qp*time*time))
      case ('two_loops'); links = two_loops(time)
      case ('watt'); links = watt(40.0_qp*degree_q*time)
      case ('watt_output'); links = watt_output((100.0_qp + 6.0_qp*sin(60.0_qp*degree_q*time))*degree_q)
      case ('stephenson'); links = stephenson(0.8_qp*time + 0.2_qp*sin(1.6_qp*time))
      case ('stephenson_output'); links = stephenson_output(2.55_qp + 0.3_qp*sin(1.2_qp*time))
      case ('klann'); links = klann((180.0_qp + 30.0_qp*time)*degree_q)
      case ('grounds'); links = grounds((10.0_qp + 60.0_qp*time)*degree_q)
      case ('andrews')
         ! As the deck's card holds the start in set 2: a double.
         if (set == 1) links = andrews(30.0_qp*degree_q*time)
         if (set == 2) links = andrews(real(real(-0.0617138900142764496358948458001_qp, wp), qp) + 0.5_qp*time &
            + 0.125_qp*time*time)
      case ('jansen'); links = jansen(30.0_qp*degree_q*time)
      case default; allocate (links(0))
      end select
   end function linkages

   !> Peaucellier's cell, long arms 3, rhombus 1.5, pole O = (0, 0); C runs on the circle of radius 1 about (1, 0),
   !> which passes through O. P is the inverse of C: OC OP = k = 3^2 - 1.5^2, so P = k C/|C|^2. With
   !> C = (1 + cos phi, sin phi), |C|^2 = 2 (1 + cos phi): x_P = k/2 and y_P = (k/2) sin phi/(1 + cos phi).
   pure function peaucellier(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(8)
      real(qp), parameter :: arm = 3.0_qp, bar = 1.5_qp, k = arm**2 - bar**2
      type(place_t) :: m, a, b, c, p

      m = fixed_place(1.0_qp, 0.0_qp)
      c = polar(m, 1.0_qp, phi)
      p = place_t(constant_jet(0.5_qp*k), 0.5_qp*k*sin(phi)/(1.0_qp + cos(phi)))
      a = corner(origin, arm, p, bar, 1.0_qp)
      b = corner(origin, arm, p, bar, -1.0_qp)
      links = [base, body('CRANK', m, phi), body('ARM-A', origin, direction(origin, a)), &
               body('ARM-B', origin, direction(origin, b)), body('BAR-AC', a, direction(a, c)), &
               body('BAR-BC', b, direction(b, c)), body('BAR-AP', a, direction(a, p)), &
               body('BAR-BP', b, direction(b, p))]
   end function peaucellier

   !> Hart's inversor: antiparallelogram A B C D, AB = CD = 4, BC = DA = 2, pivoted in the middle O of AB; the middle P
   !> of AD is led by the crank on the circle of radius 1.25 about (1.25, 0), through O. OP = BD/2 and OQ = AC/2 lie on
   !> one line, on both sides of O, and OP OQ = (4^2 - 2^2)/4 = 3; so the middle Q of BC runs on x = -3/2.5.
   pure function hart(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(6)
      type(place_t) :: m, a, b, c, d, p

      m = fixed_place(1.25_qp, 0.0_qp)
      p = polar(m, 1.25_qp, phi)
      a = corner(origin, 2.0_qp, p, 1.0_qp, 1.0_qp)
      b = place_t(-a%x, -a%y)
      d = place_t(2.0_qp*p%x - a%x, 2.0_qp*p%y - a%y)
      c = swapped(a, b, d)
      links = [base, body('CRANK', m, phi), body('BAR-AB', origin, direction(a, b)), &
               body('BAR-BC', b, direction(b, c)), body('BAR-CD', c, direction(c, d)), &
               body('BAR-DA', a, direction(a, d))]
   end function hart

   !> Five-bar: cranks 1 at (0, 0) and (3, 0) at the angles `left` and `right`, couplers 3 and 3 that meet above.
   pure function five_bar(left, right) result(links)
      type(jet_t), intent(in) :: left, right
      type(body_t) :: links(5)
      type(place_t) :: e0, a, e, c

      e0 = fixed_place(3.0_qp, 0.0_qp)
      a = polar(origin, 1.0_qp, left)
      e = polar(e0, 1.0_qp, right)
      c = corner(a, 3.0_qp, e, 3.0_qp, 1.0_qp)
      links = [base, body('LEFT', origin, left), body('RIGHT', e0, right), body('ROD-L', a, direction(a, c)), &
               body('ROD-R', e, direction(e, c))]
   end function five_bar

   !> Pantograph 3:1 with its pole at (0, 0): arms 3 and 3, rods 1 and 2, a parallelogram A B C D.
   !> D, whose x and y are driven, is a corner of the isosceles triangle O A D with OA = AD = 1; the arm B T is
   !> parallel to A D and the rod C D to the arm O B; so T = 3 D.
   pure function pantograph(d) result(links)
      type(place_t), intent(in) :: d
      type(body_t) :: links(5)
      type(jet_t) :: phi_arm, phi_rod
      type(place_t) :: a, b, c

      a = corner(origin, 1.0_qp, d, 1.0_qp, 1.0_qp)
      phi_arm = direction(origin, a)
      phi_rod = direction(a, d)
      b = polar(origin, 3.0_qp, phi_arm)
      c = polar(b, 1.0_qp, phi_rod)
      links = [base, body('ARM-OB', origin, phi_arm), body('ARM-BT', b, phi_rod), body('ROD-AD', a, phi_rod), &
               body('ROD-CD', c, phi_arm + pi_q)]
   end function pantograph

   !> Two mechanisms on one base, each with its own drive: the crank-rocker, and at (1, -4) a crank 1.5 with a rod 4 to
   !> a piston on the line through (1, -4) at -30 deg.
   pure function two_loops(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(7), slider(4)

      slider = slider_crank(-0.25_qp + 0.75_qp*time + 0.1_qp*sin(2.0_qp*time), [1.5_qp, 4.0_qp], origin, &
         constant_jet(-30.0_qp*degree_q))
      slider%x = slider%x + 1.0_qp
      slider%y = slider%y - 4.0_qp
      links = [four_bar_links(0.5_qp + time, sizes, 1.0_qp), slider(2:)]
      links(2)%name = 'CRANK-1'
      links(5)%name = 'CRANK-2'
   end function two_loops

   !> Watt's second six-bar: the crank-rocker, whose rocker's second arm ends in C = (1.2, -1.6) of its axes; rod CD =
   !> 4, output D0 D = 3 about (9, 0).
   pure function watt(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(6)

      links(:4) = four_bar_links(phi, sizes, 1.0_qp)
      links(5:) = rod_and_output(place_on(links(4), 1.2_qp, -1.6_qp), fixed_place(9.0_qp, 0.0_qp))
   end function watt

   !> A rod 4 from `c` and an output 3 about `d0`, whose joint lies to the left of the way from `c` to `d0`.
   pure function rod_and_output(c, d0) result(links)
      type(place_t), intent(in) :: c, d0
      type(body_t) :: links(2)
      type(place_t) :: d

      d = corner(c, 4.0_qp, d0, 3.0_qp, 1.0_qp)
      links = [body('ROD', c, direction(c, d)), body('OUTPUT', d0, direction(d0, d))]
   end function rod_and_output

   !> Watt's six-bar driven from its other side: the output swings by 6 deg about 100 deg. The rocker's second arm is
   !> 2 long; C lies to the right of the way from D to B0, the crank's pin to the left of that from A0 to B.
   pure function watt_output(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(6), rocker
      type(place_t) :: b0, d0, a, b, c, d

      b0 = fixed_place(4.0_qp, 0.0_qp)
      d0 = fixed_place(9.0_qp, 0.0_qp)
      d = polar(d0, 3.0_qp, phi)
      c = corner(d, 4.0_qp, b0, 2.0_qp, -1.0_qp)
      rocker = body('ROCKER', b0, direction(b0, c) + atan2(1.6_qp, 1.2_qp))
      b = place_on(rocker, 3.0_qp, 0.0_qp)
      a = corner(origin, 1.0_qp, b, 3.5_qp, 1.0_qp)
      links = [base, body('CRANK', origin, direction(origin, a)), body('COUPLER', a, direction(a, b)), rocker, &
               body('ROD', c, direction(c, d)), body('OUTPUT', d0, phi)]
   end function watt_output

   !> Stephenson's third six-bar: crank-rocker 1, 2.5, 2.5 on A0 B0 = 3; the point C = (1.25, 1.5) of the coupler moves
   !> the dyad CD = 4, D0 D = 3 about (5, 3).
   pure function stephenson(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(6)

      links(:4) = four_bar_links(phi, [1.0_qp, 2.5_qp, 2.5_qp, 3.0_qp], 1.0_qp)
      links(5:) = rod_and_output(place_on(links(3), 1.25_qp, 1.5_qp), fixed_place(5.0_qp, 3.0_qp))
   end function stephenson

   !> Stephenson's six-bar driven from its other side, the output at the angle `wanted`. Four links are then found
   !> at once, without a formula; but the output is known for each angle of the crank and grows with it from 1.5 to 4
   !> rad: that function is inverted, by halves and then by Newton's method, and its derivatives with it.
   pure function stephenson_output(wanted) result(links)
      type(jet_t), intent(in) :: wanted
      type(body_t) :: links(6)
      type(jet_t) :: phi
      real(qp) :: low, high
      integer :: k

      low = 1.5_qp
      high = 4.0_qp
      phi = time_jet(0.5_qp*(low + high))
      do k = 1, 30
         links = stephenson(phi)
         if (k <= 20) then
            if (links(6)%phi%v < wanted%v) low = phi%v
            if (links(6)%phi%v >= wanted%v) high = phi%v
            phi%v = 0.5_qp*(low + high)
         else
            phi%v = phi%v - (links(6)%phi%v - wanted%v)/links(6)%phi%d
         end if
      end do
      associate (out => links(6)%phi)
         phi%d = wanted%d/out%d
         phi%dd = (wanted%dd - out%dd*phi%d**2)/out%d
      end associate
      links = stephenson(phi)
   end function stephenson_output

   !> Klann's leg, the joints of US patent 6,260,862: crank 0.268 about (1.599, 0.750), lower rocker 0.3206 about
   !> (1.009, 0.574), upper rocker 0.5177 about (1.366, 1.366); the rod from the crank's pin over the elbow at 0.59 to
   !> the knee; the leg from the knee to the hip, 0.8966, and to the foot. Elbow and hip: to the right of the way from
   !> the pin to the lower rocker's axle, to the left of the way from the knee to the upper rocker's.
   pure function klann(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(6), rod
      type(place_t) :: shaft, lower, upper, pin, elbow, knee, hip

      shaft = fixed_place(1.599_qp, 0.75_qp)
      lower = fixed_place(1.009_qp, 0.574_qp)
      upper = fixed_place(1.366_qp, 1.366_qp)
      pin = polar(shaft, 0.268_qp, phi)
      elbow = corner(pin, 0.59_qp, lower, 0.3206_qp, -1.0_qp)
      rod = body('ROD', pin, direction(pin, elbow))
      knee = place_on(rod, 1.0990_qp, -0.1164_qp)
      hip = corner(knee, 0.8966_qp, upper, 0.5177_qp, 1.0_qp)
      links = [base, body('CRANK', shaft, phi), rod, body('LOWER', lower, direction(lower, elbow)), &
               body('UPPER', upper, direction(upper, hip)), body('LEG', knee, direction(knee, hip))]
   end function klann

   !> Three ground links: FLOOR at the origin with the crank's axle (0.5, 0.25); POST at (4, 1) turned by 90 deg with
   !> the rocker's axle at 0.5 along it; WALL at (9, 0) turned by 60 deg with the guide through its point (1, 0.25), at
   !> 30 deg to its axes: upright. Crank 1, coupler 4, rocker 3 and 4.5 to its tip, rod 10 down to the ram, which stands
   !> at 45 deg to the wall.
   pure function grounds(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(8), low, post, wall
      type(jet_t) :: rocker
      type(place_t) :: a0, b0, guide, a, b, tip, ram

      low = body('FLOOR', origin, flat)
      post = body('POST', fixed_place(4.0_qp, 1.0_qp), constant_jet(90.0_qp*degree_q))
      wall = body('WALL', fixed_place(9.0_qp, 0.0_qp), constant_jet(60.0_qp*degree_q))
      a0 = place_on(low, 0.5_qp, 0.25_qp)
      b0 = place_on(post, 0.5_qp, 0.0_qp)
      guide = place_on(wall, 1.0_qp, 0.25_qp)
      a = polar(a0, 1.0_qp, phi)
      b = corner(a, 4.0_qp, b0, 3.0_qp, 1.0_qp)
      rocker = direction(b0, b)
      tip = polar(b0, 4.5_qp, rocker)
      ram = on_line(tip, 10.0_qp, guide, wall%phi + 30.0_qp*degree_q, -1.0_qp)
      links = [low, post, wall, body('CRANK', a0, phi), body('COUPLER', a, direction(a, b)), &
               body('ROCKER', b0, rocker), body('ROD', tip, direction(tip, ram)), &
               body('RAM', ram, wall%phi + 45.0_qp*degree_q)]
   end function grounds

   !> Andrews' squeezing mechanism (Schiehlen 1990; IVP Test Set, Mazzia and Magherini 2008), in millimetres. K1 is the
   !> crank OF, K2 the rod FE, K3 the body at B; from E the rods K4 and K6 run to the bodies K5 and K7 at A. E lies to
   !> the left of the way from F to B, G to the right and H to the left of the way from E to A.
   !> The angles of K1, K3, K4, K5 and K7 are the Test Set's beta, gamma, phi + delta, delta and epsilon.
   pure function andrews(beta) result(links)
      type(jet_t), intent(in) :: beta
      type(body_t) :: links(8)
      real(qp), parameter :: right = 0.5_qp*pi_q
      type(place_t) :: a, b, e, f, g, h

      a = fixed_place(-69.34_qp, -2.27_qp)
      b = fixed_place(-36.35_qp, 32.73_qp)
      f = polar(origin, 7.0_qp, beta)
      e = corner(f, 28.0_qp, b, 35.0_qp, 1.0_qp)
      g = corner(e, 20.0_qp, a, 40.0_qp, -1.0_qp)
      h = corner(e, 20.0_qp, a, 40.0_qp, 1.0_qp)
      links = [base, body('K1', origin, beta), body('K2', f, direction(f, e)), body('K3', b, direction(b, e) + right), &
               body('K4', e, direction(e, g) - right), body('K5', a, direction(a, g)), body('K6', e, direction(e, h)), &
               body('K7', a, direction(a, h) + right)]
   end function andrews

   !> Theo Jansen's leg with the numbers he published: a 38, b 41.5, c 39.3, d 40.1, e 55.8, f 39.4, g 36.7, h 65.7,
   !> i 49, j 50, k 61.9, l 7.8, m 15. Crank m about (0, 0), pivot B at (-a, -l); seen along the way from the crank's
   !> pin P to B the triangle's corner X is to the right and C to the left; the ankle V is to the right of the way
   !> from W to C. W follows from the triangle's sides; the deck's cards hold it as doubles.
   pure function jansen(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(8), upper
      real(qp), parameter :: along = (41.5_qp**2 + 40.1_qp**2 - 55.8_qp**2)/(2.0_qp*41.5_qp)
      real(qp), parameter :: xi = real(real(along, wp), qp), eta = real(real(sqrt(40.1_qp**2 - along**2), wp), qp)
      type(place_t) :: b, p, x, c, w, v

      b = fixed_place(-38.0_qp, -7.8_qp)
      p = polar(origin, 15.0_qp, phi)
      x = corner(p, 50.0_qp, b, 41.5_qp, -1.0_qp)
      c = corner(p, 61.9_qp, b, 39.3_qp, 1.0_qp)
      upper = body('UPPER', b, direction(b, x))
      w = place_on(upper, xi, eta)
      v = corner(w, 39.4_qp, c, 36.7_qp, -1.0_qp)
      links = [base, body('CRANK', origin, phi), body('ROD-J', p, direction(p, x)), upper, &
               body('ROD-K', p, direction(p, c)), body('ROD-C', b, direction(b, c)), &
               body('ROD-F', w, direction(w, v)), body('FOOT', c, direction(c, v))]
   end function jansen
end module closed_forms_linkages
