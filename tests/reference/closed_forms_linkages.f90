!> Tests. Closed forms of the linkages with revolute pairs only. The lengths are those of the decks in input/,
!> written out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_linkages
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, pi_q, degree_q, constant_jet, time_jet, operator(+), operator(-), operator(*), &
      operator(/), sqrt, sin, cos
   use rise_laws, only: rise_jet, rise_words
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, place_on, polar, direction, third_corner, &
      four_bar_links
   implicit none
   private
   public :: four_bar, crank_rockers, drawing, drawn_link, rise_dwell, drag_link, peaucellier, five_bar, pantograph, &
      book_four_bar

   !> Crank, coupler, rocker and base of the crank-rocker.
   real(qp), parameter :: sizes(4) = [1.0_qp, 3.5_qp, 3.0_qp, 4.0_qp]

contains

   !> Crank-rocker 1, 3.5, 3 on the base 4: set 1 open, set 2 crossed.
   pure function four_bar(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: time

      time = time_jet(t)
      if (set == 1) then
         links = four_bar_links(30.0_qp*degree_q*time, sizes, 1.0_qp)
      else
         links = four_bar_links(0.5_qp + time + 0.25_qp*sin(2.0_qp*time + 0.5_qp), sizes, -1.0_qp)
      end if
   end function four_bar

   !> The four-bar of a book by its lengths 30, 70, 65 and 90, open; the axes of each link lie along its bar.
   pure function book_four_bar(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = four_bar_links((30.0_qp + 60.0_qp*time_jet(t))*degree_q, [30.0_qp, 70.0_qp, 65.0_qp, 90.0_qp], 1.0_qp)
   end function book_four_bar

   !> The variant number `n` of the open crank-rocker: three cranks, each with its coupler, and two rockers for each.
   pure function crank_rockers(n, t) result(links)
      integer, intent(in) :: n
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      associate (k => (n - 1)/2)
         links = four_bar_links(30.0_qp*degree_q*time_jet(t), [0.5_qp*(k + 1), 3.5_qp - 0.25_qp*k, &
            merge(2.75_qp, 3.0_qp, modulo(n, 2) == 1), 4.0_qp], 1.0_qp)
      end associate
   end function crank_rockers

   !> Four-bar linkage A0 A B B0 as it is drawn, with B to the right of A B0; the axes of the links lie in those of the
   !> drawing. In set 2 the origin of the rocker's axes is drawn at B0.
   pure function drawing(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: a0(2) = [0.5_qp, 0.0_qp], a(2) = [0.0_qp, 1.0_qp], b(2) = [3.0_qp, 2.75_qp], &
         b0(2) = [4.0_qp, 0.0_qp], origin(2) = 0.0_qp
      type(body_t) :: crank
      type(place_t) :: pin, end_of_crank, elbow

      pin = fixed_place(b0(1), b0(2))
      crank = body('CRANK', fixed_place(a0(1), a0(2)), -30.0_qp*degree_q*time_jet(t))
      end_of_crank = place_on(crank, a(1) - a0(1), a(2) - a0(2))
      elbow = third_corner(end_of_crank, pin, constant_jet(sum((b - a)**2)), constant_jet(sum((b - b0)**2)), 1.0_qp)
      links = [body('BASE', fixed_place(0.0_qp, 0.0_qp), constant_jet(0.0_qp)), &
               drawn_link('CRANK', fixed_place(a0(1), a0(2)), end_of_crank, a0, a, origin), &
               drawn_link('COUPLER', end_of_crank, elbow, a, b, origin), &
               drawn_link('ROCKER', pin, elbow, b0, b, merge(origin, b0, set == 1))]
   end function drawing

   !> The link `name` with the points `p` and `q`, which are drawn at `p_drawn` and `q_drawn`, as the origin of its axes
   !> is drawn at `origin`; the axes are parallel to those of the drawing.
   pure type(body_t) function drawn_link(name, p, q, p_drawn, q_drawn, origin) result(link)
      character(*), intent(in) :: name
      type(place_t), intent(in) :: p, q
      real(qp), intent(in) :: p_drawn(2), q_drawn(2), origin(2)
      real(qp) :: drawn_direction

      drawn_direction = atan2(q_drawn(2) - p_drawn(2), q_drawn(1) - p_drawn(1))
      link = body(name, p, direction(p, q) - drawn_direction)
      link = body(name, place_on(link, origin(1) - p_drawn(1), origin(2) - p_drawn(2)), link%phi)
   end function drawn_link

   !> The crank-rocker, open: by each law of a rise the crank goes from 30 to 91.64 deg and back; in set 5 it turns at 1500 turns
   !> a minute, t in milliseconds, less a rise of 96 deg.
   pure function rise_dwell(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi

      if (set == 5) then
         phi = 1500.0_qp*360.0_qp/60000.0_qp*time_jet(t) - rise_jet('3-4-5', 10.0_qp, 20.0_qp, 96.0_qp, t)
      else
         phi = 30.0_qp + rise_jet(trim(rise_words(set)), 0.3_qp, 1.2_qp, 61.64_qp, t) &
            - rise_jet(trim(rise_words(set)), 2.1_qp, 0.6_qp, 61.64_qp, t)
      end if
      links = four_bar_links(phi*degree_q, sizes, 1.0_qp)
   end function rise_dwell

   !> Double crank: base 1 at (1, 0.5) turned by 30 deg, crank 2, coupler sqrt(6) with its axes in its middle,
   !> follower 2.5. The coupler's half length is the double that the deck's continuation card holds.
   pure function drag_link(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: half = real(real(sqrt(1.5_qp), wp), qp)
      type(jet_t) :: phi, time
      type(place_t) :: a0, b0, a, b, middle
      type(body_t) :: base

      time = time_jet(t)
      phi = 0.5_qp*time*time*sqrt(time)
      if (set == 1) phi = (90.0_qp + 24.0_qp*time)*degree_q
      base = body('BASE', fixed_place(1.0_qp, 0.5_qp), constant_jet(30.0_qp*degree_q))
      a0 = place_on(base, 0.0_qp, 0.0_qp)
      b0 = place_on(base, 1.0_qp, 0.0_qp)
      a = polar(a0, 2.0_qp, phi)
      b = third_corner(a, b0, constant_jet((2.0_qp*half)**2), constant_jet(2.5_qp**2), 1.0_qp)
      middle = place_t(0.5_qp*(a%x + b%x), 0.5_qp*(a%y + b%y))
      links = [base, body('CRANK', a0, phi), body('COUPLER', middle, direction(a, b)), &
               body('FOLLOWER', b0, direction(b0, b))]
   end function drag_link

   !> Peaucellier's cell, long arms 3, rhombus 1.5, pole O = (0, 0); C runs on the circle of radius 1 about (1, 0),
   !> which passes through O. P is the inverse of C: OC OP = k = 3^2 - 1.5^2, so P = k C/|C|^2. With
   !> C = (1 + cos phi, sin phi), |C|^2 = 2 (1 + cos phi): x_P = k/2 and y_P = (k/2) sin phi/(1 + cos phi).
   pure function peaucellier(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(8)
      real(qp), parameter :: body_vector = 3.0_qp, bar = 1.5_qp, k = body_vector**2 - bar**2
      type(jet_t) :: phi, arm2, bar2
      type(place_t) :: o, m, a, b, c, p

      phi = (-60.0_qp + 10.0_qp*time_jet(t))*degree_q
      o = fixed_place(0.0_qp, 0.0_qp)
      m = fixed_place(1.0_qp, 0.0_qp)
      c = polar(m, 1.0_qp, phi)
      p = place_t(constant_jet(0.5_qp*k), 0.5_qp*k*sin(phi)/(1.0_qp + cos(phi)))
      arm2 = constant_jet(body_vector**2)
      bar2 = constant_jet(bar**2)
      a = third_corner(o, p, arm2, bar2, 1.0_qp)
      b = third_corner(o, p, arm2, bar2, -1.0_qp)
      links = [body('BASE', o, constant_jet(0.0_qp)), body('CRANK', m, phi), &
               body('ARM-A', o, direction(o, a)), body('ARM-B', o, direction(o, b)), &
               body('BAR-AC', a, direction(a, c)), body('BAR-BC', b, direction(b, c)), &
               body('BAR-AP', a, direction(a, p)), body('BAR-BP', b, direction(b, p))]
   end function peaucellier

   !> Five-bar: cranks 1 at (0, 0) and (3, 0), couplers 3 and 3 that meet above. The left crank turns at 20 deg
   !> a second; the right one is given against the left: 60 deg + 20 deg a second, so it turns twice as fast.
   pure function five_bar(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(5)
      type(jet_t) :: left, right, square
      type(place_t) :: a0, e0, a, e, c

      left = 20.0_qp*degree_q*time_jet(t)
      right = left + (60.0_qp + 20.0_qp*time_jet(t))*degree_q
      a0 = fixed_place(0.0_qp, 0.0_qp)
      e0 = fixed_place(3.0_qp, 0.0_qp)
      a = polar(a0, 1.0_qp, left)
      e = polar(e0, 1.0_qp, right)
      square = constant_jet(3.0_qp**2)
      c = third_corner(a, e, square, square, 1.0_qp)
      links = [body('BASE', a0, constant_jet(0.0_qp)), body('LEFT', a0, left), body('RIGHT', e0, right), &
               body('ROD-L', a, direction(a, c)), body('ROD-R', e, direction(e, c))]
   end function five_bar

   !> Pantograph 3:1 with its pole at (0, 0): arms 3 and 3, rods 1 and 2, a parallelogram A B C D.
   !> D, whose x and y are driven, is a corner of the isosceles triangle O A D with OA = AD = 1; the arm B T is
   !> parallel to A D and the rod C D to the arm O B; so T = 3 D.
   pure function pantograph(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(5)
      type(jet_t) :: time, one, phi_arm, phi_rod
      type(place_t) :: o, a, b, c, d

      time = time_jet(t)
      if (set == 1) then
         d = place_t(1.2_qp + 0.3_qp*sin(time), 0.4_qp + 0.25_qp*sin(2.0_qp*time + 0.5_qp))
      else
         d = place_t(1.0_qp + 0.25_qp*time, 0.75_qp - 0.5_qp*time + 0.1_qp*time*time)
      end if
      o = fixed_place(0.0_qp, 0.0_qp)
      one = constant_jet(1.0_qp)
      a = third_corner(o, d, one, one, 1.0_qp)
      phi_arm = direction(o, a)
      phi_rod = direction(a, d)
      b = polar(o, 3.0_qp, phi_arm)
      c = polar(b, 1.0_qp, phi_rod)
      links = [body('BASE', o, constant_jet(0.0_qp)), body('ARM-OB', o, phi_arm), body('ARM-BT', b, phi_rod), &
               body('ROD-AD', a, phi_rod), body('ROD-CD', c, phi_arm + pi_q)]
   end function pantograph
end module closed_forms_linkages
