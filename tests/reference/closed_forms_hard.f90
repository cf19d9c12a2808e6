!> Tests. Closed forms at positions that are hard to compute: change points, dead points, lengths far below the places,
!> many turns. The lengths are those of the decks, written out again by hand.
module closed_forms_hard
   use quad_jet, only: qp, jet_t, degree_q, constant_jet, time_jet, operator(+), &
      operator(-), operator(*), operator(/), sqrt, cos
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, polar, direction, on_line, four_bar_links
   implicit none
   private
   public :: parallelogram, parallelogram_links, scott_russell, near_equal_rod, dead_point, pushed_slider, far_small, &
      many_turns

contains

   !> Cranks 2, base and coupler 4, from 20 deg on through 180 and 360 deg: the coupler only shifts.
   pure function parallelogram(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = parallelogram_links((20.0_qp + 10.0_qp*time_jet(t))*degree_q)
   end function parallelogram

   pure function parallelogram_links(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)
      type(jet_t) :: flat
      type(place_t) :: a0

      flat = constant_jet(0.0_qp)
      a0 = fixed_place(0.0_qp, 0.0_qp)
      links = [body('BASE', a0, flat), body('CRANK', a0, phi), body('COUPLER', polar(a0, 2.0_qp, phi), flat), &
               body('ROCKER', fixed_place(4.0_qp, 0.0_qp), phi)]
   end function parallelogram_links

   !> Scott-Russell with crank 1.5 and bar 3: its middle on the crank's pin, its end B on the x axis at 3 cos phi, its
   !> end C on the y axis at 3 sin phi. At 90 deg B is in the centre.
   pure function scott_russell(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi, flat
      type(place_t) :: o

      phi = (30.0_qp + 12.0_qp*time_jet(t))*degree_q
      flat = constant_jet(0.0_qp)
      o = fixed_place(0.0_qp, 0.0_qp)
      links = [body('BASE', o, flat), body('CRANK', o, phi), body('BAR', polar(o, 1.5_qp, phi), -phi), &
               body('SHOE', place_t(3.0_qp*cos(phi), flat), flat)]
   end function scott_russell

   !> In-line crank-slider with crank 1 and rod 1.001, driven by the crank through both dead points.
   pure function near_equal_rod(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi, flat
      type(place_t) :: o, pin, piston

      phi = 15.0_qp*degree_q*time_jet(t)
      flat = constant_jet(0.0_qp)
      o = fixed_place(0.0_qp, 0.0_qp)
      pin = polar(o, 1.0_qp, phi)
      piston = on_line(pin, 1.001_qp, o, flat, 1.0_qp)
      links = [body('BASE', o, flat), body('CRANK', o, phi), body('ROD', pin, direction(pin, piston)), &
               body('PISTON', piston, flat)]
   end function near_equal_rod

   !> Crank 1 and rod 3, driven by the piston: x = 4 - g (1 + t), the crank above, g = 2.3/10^power. The triangle's
   !> height over x by Heron, where 4 - x is not a difference: h = sqrt((4 + x)(4 - x)(x + 2)(x - 2))/(2 x).
   pure function dead_point(power, t) result(links)
      integer, intent(in) :: power
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: gap, x, flat
      type(place_t) :: o, pin, piston

      flat = constant_jet(0.0_qp)
      o = fixed_place(0.0_qp, 0.0_qp)
      gap = 2.3_qp/10.0_qp**power*(1.0_qp + time_jet(t))
      x = 4.0_qp - gap
      piston = place_t(x, flat)
      pin = place_t((x*x - 8.0_qp)/(2.0_qp*x), &
         sqrt((4.0_qp + x)*gap*(x + 2.0_qp)*(x - 2.0_qp))/(2.0_qp*x))
      links = [body('BASE', o, flat), body('CRANK', o, direction(o, pin)), &
               body('ROD', pin, direction(pin, piston)), body('PISTON', piston, flat)]
   end function dead_point

   !> The same mechanism with any `numbers` in its deck: the crank's pin and the rod's eye in their links' axes (1 to
   !> 4), the direction of the guide (5), the piston's value, rate and acceleration at t = 0 (6 to 8), the instant (9).
   pure function pushed_slider(numbers) result(links)
      real(qp), intent(in) :: numbers(9)
      type(body_t) :: links(4)
      type(jet_t) :: reach, x, across, flat
      type(place_t) :: o, pin, eye
      real(qp) :: crank(2), rod(2), c(3), slope(2), both, less, t

      crank = numbers(1:2)
      rod = numbers(3:4)
      slope = [cos(numbers(5)), sin(numbers(5))]
      c = numbers(6:8)
      t = numbers(9)
      both = norm2(crank) + norm2(rod)
      less = norm2(rod) - norm2(crank)
      flat = constant_jet(0.0_qp)
      o = fixed_place(0.0_qp, 0.0_qp)
      reach = (c(1) + time_jet(t)*(c(2) + time_jet(t)*(c(3)/2.0_qp)))/slope(1)
      eye = place_t(slope(1)*reach, slope(2)*reach)
      x = (reach*reach - both*less)/(2.0_qp*reach)
      across = sqrt((both + reach)*(both - reach)*(reach + less)*(reach - less))/(2.0_qp*reach)
      pin = place_t(slope(1)*x - slope(2)*across, slope(2)*x + slope(1)*across)
      links = [body('BASE', o, flat), body('CRANK', o, direction(o, pin) - atan2(crank(2), crank(1))), &
               body('ROD', pin, direction(pin, eye) - atan2(rod(2), rod(1))), body('PISTON', eye, flat)]
   end function pushed_slider

   !> Crank-rocker of 1, 3.5, 3 and 4 millionths on a base at (1200, 1600), where it is put after all is known.
   pure function far_small(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = four_bar_links((10.0_qp + 30.0_qp*time_jet(t))*degree_q, [1.0_qp, 3.5_qp, 3.0_qp, 4.0_qp]*1.0e-6_qp, 1.0_qp)
      links%x = links%x + 1200.0_qp
      links%y = links%y + 1600.0_qp
   end function far_small

   !> Crank-rocker 1, 3.5, 3 on 4 after 159154 turns: phi = 10^6 + t/2 rad.
   pure function many_turns(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)

      links = four_bar_links(1.0e6_qp + 0.5_qp*time_jet(t), [1.0_qp, 3.5_qp, 3.0_qp, 4.0_qp], 1.0_qp)
   end function many_turns
end module closed_forms_hard
