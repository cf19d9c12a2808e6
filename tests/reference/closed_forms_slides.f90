!> Tests. Closed forms of further mechanisms with sliding pairs. The lengths are those of the decks in input/, written
!> out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_slides
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, degree_q, constant_jet, time_jet, &
      operator(+), operator(-), operator(*), sqrt, sin, cos, atan2
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, polar, direction, distance_squared, on_line
   implicit none
   private
   public :: crank_inline, inverted_slider, oldham, geneva, points_meet

contains

   !> Upright engine: crank 43, rod 150, the cylinder's axis through the crank's axle.
   pure function crank_inline(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi, flat
      type(place_t) :: o, pin, piston

      phi = (90.0_qp + 18.0_qp*time_jet(t))*degree_q
      o = fixed_place(0.0_qp, 0.0_qp)
      flat = constant_jet(0.0_qp)
      pin = polar(o, 43.0_qp, phi)
      piston = on_line(pin, 150.0_qp, o, flat + 90.0_qp*degree_q, 1.0_qp)
      links = [body('BASE', o, flat), body('CRANK', o, phi), body('ROD', pin, direction(pin, piston)), &
               body('PISTON', piston, flat)]
   end function crank_inline

   !> Inverted slider: crank 1 about (0, 0), lever about F = (2.5, -0.5). The guide stands at 20 deg to the lever and
   !> misses F by h = 0.5: pin = F + s e - h n, so s^2 = |pin - F|^2 - h^2 and the guide's direction is that from F to
   !> the pin plus atan2(h, s). The block is turned by 30 deg against the lever.
   pure function inverted_slider(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: h = 0.5_qp
      type(jet_t) :: phi, lever, s
      type(place_t) :: o, f, pin

      phi = (15.0_qp + 30.0_qp*time_jet(t) + 3.0_qp*time_jet(t)*time_jet(t))*degree_q
      o = fixed_place(0.0_qp, 0.0_qp)
      f = fixed_place(2.5_qp, -0.5_qp)
      pin = polar(o, 1.0_qp, phi)
      s = sqrt(distance_squared(f, pin) - h**2)
      lever = direction(f, pin) + atan2(constant_jet(h), s) - 20.0_qp*degree_q
      links = [body('BASE', o, constant_jet(0.0_qp)), body('CRANK', o, phi), body('LEVER', f, lever), &
               body('BLOCK', pin, lever + 30.0_qp*degree_q)]
   end function inverted_slider

   !> Oldham's coupling, shafts at (0, 0) and (e, 0), e = 3. The cross slides in disc 1 along phi and in disc 2 along
   !> phi + 90 deg, so its centre is on both lines: at e cos phi (cos phi, sin phi), on a circle, twice in a turn.
   pure function oldham(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: e = 3.0_qp
      type(jet_t) :: phi
      type(place_t) :: o

      phi = (10.0_qp + 20.0_qp*time_jet(t) + 2.5_qp*time_jet(t)*time_jet(t))*degree_q
      o = fixed_place(0.0_qp, 0.0_qp)
      links = [body('BASE', o, constant_jet(0.0_qp)), body('DISC-1', o, phi), &
               body('DISC-2', fixed_place(e, 0.0_qp), phi + 90.0_qp*degree_q), &
               body('CROSS', place_t(e*cos(phi)*cos(phi), e*cos(phi)*sin(phi)), phi)]
   end function oldham

   !> Geneva wheel with four slots while the pin is in one: the axles of crank and wheel are 1 apart, the pin is at
   !> r = sqrt(1/2), rounded as on the card, from that of the crank, and comes into the slot at -45 deg. The slot passes
   !> through the wheel's axle.
   pure function geneva(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi, slot
      type(place_t) :: crank, wheel, pin

      phi = (-45.0_qp + 90.0_qp*time_jet(t))*degree_q
      crank = fixed_place(0.0_qp, 0.0_qp)
      wheel = fixed_place(1.0_qp, 0.0_qp)
      pin = polar(crank, real(0.70710678118654757_wp, qp), phi)
      ! The slot's axis is turned by half a turn against the way from the axle to the pin.
      slot = direction(pin, wheel)
      links = [body('BASE', crank, constant_jet(0.0_qp)), body('CRANK', crank, phi), body('WHEEL', wheel, slot), &
               body('BLOCK', pin, slot)]
   end function geneva

   !> Two blocks on crossed guides through O, at x = t - 1 and y = -1 + t/2 + t**2/4: the first meets O at t = 1.
   pure function points_meet(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(3)
      type(jet_t) :: x, y, zero

      zero = constant_jet(0.0_qp)
      x = time_jet(t) - 1.0_qp
      y = -1.0_qp + 0.5_qp*time_jet(t) + 0.25_qp*time_jet(t)*time_jet(t)
      links = [body('BASE', place_t(zero, zero), zero), body('BLOCK', place_t(x, zero), zero), &
               body('CROSS', place_t(zero, y), zero)]
   end function points_meet
end module closed_forms_slides
