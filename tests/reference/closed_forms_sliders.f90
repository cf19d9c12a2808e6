!> Tests. Closed forms of the mechanisms with sliding pairs. The lengths are those of the decks in input/,
!> written out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_sliders
   use quad_jet, only: qp, jet_t, pi_q, degree_q, constant_jet, time_jet, &
      operator(+), operator(-), operator(*), operator(/), sqrt, sin, cos, atan2
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, place_on, polar, direction, third_corner, &
      natural_spline_3
   use closed_forms_linkages, only: drawn_link
   implicit none
   private
   public :: yoke, crank_slider, drawn_slider, drawn_cylinder, scotch_yoke, whitworth, crank_shaper, cylinder, trammel

contains

   !> The far end of a rod from `p` to the line y = height, to the right (side = 1.0) or to the left (-1.0).
   pure type(place_t) function on_level(p, length, height, side) result(q)
      type(place_t), intent(in) :: p
      real(qp), intent(in) :: length, height, side
      type(jet_t) :: rise

      rise = height - p%y
      q = place_t(p%x + side*sqrt(length**2 - rise*rise), constant_jet(height))
   end function on_level

   !> The paper's yoke mechanism: r = 1, l1 = 4, l2 = 2, a = 2, b = 5. The lever points from (0, 0) to the crank's
   !> pin; the rod runs from the lever's tip to the ram on y = b, to the right or (mirrored) to the left.
   pure function yoke(set, t, side) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t, side
      type(body_t) :: links(6)
      type(jet_t) :: phi, lever, flat, time
      type(place_t) :: o, centre, pin, tip, ram

      time = time_jet(t)
      phi = 0.1_qp*time*time
      if (set == 1) phi = 30.0_qp*degree_q*time
      o = fixed_place(0.0_qp, 0.0_qp)
      centre = fixed_place(0.0_qp, 2.0_qp)
      flat = constant_jet(0.0_qp)
      pin = polar(centre, 1.0_qp, phi)
      lever = direction(o, pin)
      tip = polar(o, 4.0_qp, lever)
      ram = on_level(tip, 2.0_qp, 5.0_qp, side)
      links = [body('BASE', o, flat), body('CRANK', centre, phi), body('BLOCK', pin, lever), &
               body('LEVER', o, lever), body('ROD', tip, direction(tip, ram)), body('RAM', ram, flat)]
   end function yoke

   !> Crank 1, rod 3, the slide line at the height 0.5.
   pure function crank_slider(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      type(jet_t) :: phi, flat, time
      type(place_t) :: o, pin, piston

      time = time_jet(t)
      phi = 0.25_qp + 0.5_qp*time + 0.02_qp*time*time*time
      if (set == 1) phi = 60.0_qp*degree_q*time
      o = fixed_place(0.0_qp, 0.0_qp)
      flat = constant_jet(0.0_qp)
      pin = polar(o, 1.0_qp, phi)
      piston = on_level(pin, 3.0_qp, 0.5_qp, 1.0_qp)
      links = [body('BASE', o, flat), body('CRANK', o, phi), body('ROD', pin, direction(pin, piston)), &
               body('PISTON', piston, flat)]
   end function crank_slider

   !> Slider-crank drawn with its crank at (0.6, 0.8) from (0, 0) and the slider at (3, 0.5). In set 1 the slider stays on
   !> y = 0.5, in set 2 it swings by 0.2 along a line that falls by 15 deg, its axes at 30 deg. The axes of crank and rod
   !> lie in those of the drawing.
   pure function drawn_slider(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: a(2) = [0.6_qp, 0.8_qp], b(2) = [3.0_qp, 0.5_qp], origin(2) = 0.0_qp, &
         fall = -15.0_qp*degree_q
      type(place_t) :: o, pin, slider
      type(jet_t) :: way, turned

      o = fixed_place(0.0_qp, 0.0_qp)
      turned = constant_jet(0.0_qp)
      if (set == 1) then
         pin = place_on(body('CRANK', o, 30.0_qp*degree_q*time_jet(t)), a(1), a(2))
         slider = on_level(pin, sqrt(sum((b - a)**2)), b(2), 1.0_qp)
      else
         way = 0.2_qp*sin(30.0_qp*degree_q*time_jet(t))
         turned = constant_jet(30.0_qp*degree_q)
         slider = place_t(b(1) + way*cos(fall), b(2) + way*sin(fall))
         pin = third_corner(o, slider, constant_jet(sum(a**2)), constant_jet(sum((b - a)**2)), 1.0_qp)
      end if
      links = [body('BASE', o, constant_jet(0.0_qp)), drawn_link('CRANK', o, pin, origin, a, origin), &
               drawn_link('ROD', pin, slider, a, b, origin), body('SLIDER', slider, turned)]
   end function drawn_slider

   !> Boom about (0, 0) with the eye of its cylinder drawn at (1.5, 1); the cylinder stands on (2, -1) and grows by 0.5 in
   !> a unit of time from the length drawn. All axes lie in those of the drawing.
   pure function drawn_cylinder(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: b(2) = [1.5_qp, 1.0_qp], b0(2) = [2.0_qp, -1.0_qp], origin(2) = 0.0_qp
      type(place_t) :: o, foot, eye
      type(jet_t) :: length

      length = sqrt(sum((b - b0)**2)) + 0.5_qp*time_jet(t)
      o = fixed_place(0.0_qp, 0.0_qp)
      foot = fixed_place(b0(1), b0(2))
      eye = third_corner(o, foot, constant_jet(sum(b**2)), length*length, 1.0_qp)
      links = [body('BASE', o, constant_jet(0.0_qp)), drawn_link('BOOM', o, eye, origin, b, origin), &
               drawn_link('BARREL', foot, eye, b0, b, origin), drawn_link('ROD', eye, foot, b, b0, origin)]
   end function drawn_cylinder

   !> Scotch yoke of radius 40: x = 40 cos phi. Set 1 gives phi, set 2 x itself, with the crank above.
   pure function scotch_yoke(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: r = 40.0_qp
      type(jet_t) :: phi, flat, x, time
      type(place_t) :: o, pin

      time = time_jet(t)
      if (set == 1) then
         phi = (45.0_qp + 15.0_qp*time)*degree_q
      else
         x = 30.0_qp*sin(1.5_qp*time)
         phi = atan2(sqrt(r**2 - x*x), x)
      end if
      o = fixed_place(0.0_qp, 0.0_qp)
      flat = constant_jet(0.0_qp)
      pin = polar(o, r, phi)
      links = [body('BASE', o, flat), body('CRANK', o, phi), body('BLOCK', pin, flat), &
               body('YOKE', place_t(pin%x, flat), flat)]
   end function scotch_yoke

   !> Whitworth's quick return: crank 2 about (0, -1), slotted arm about (0, 0), its tail 1.5 behind the pivot,
   !> rod 5 to the ram on y = 0.
   pure function whitworth(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6)
      type(jet_t) :: phi, body_vector, flat
      type(place_t) :: o, centre, pin, tail, ram

      phi = (90.0_qp + 36.0_qp*time_jet(t))*degree_q
      o = fixed_place(0.0_qp, 0.0_qp)
      centre = fixed_place(0.0_qp, -1.0_qp)
      flat = constant_jet(0.0_qp)
      pin = polar(centre, 2.0_qp, phi)
      body_vector = direction(o, pin)
      tail = polar(o, -1.5_qp, body_vector)
      ram = on_level(tail, 5.0_qp, 0.0_qp, 1.0_qp)
      links = [body('BASE', o, flat), body('CRANK', centre, phi), body('BLOCK', pin, body_vector), body('ARM', o, &
         body_vector), &
               body('ROD', tail, direction(tail, ram)), body('RAM', ram, flat)]
   end function whitworth

   !> Crank shaper: crank 0.75 about (0, 2), its pin in the slot of an arm about (0, 0), whose end at 4 drives by a rod of 2
   !> the ram on y = 4.5. The block in the slot has no name.
   pure function crank_shaper(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6)
      type(jet_t) :: phi, arm, flat
      type(place_t) :: o, centre, pin, tip, ram

      phi = (90.0_qp + 36.0_qp*time_jet(t))*degree_q
      flat = constant_jet(0.0_qp)
      o = fixed_place(0.0_qp, 0.0_qp)
      centre = fixed_place(0.0_qp, 2.0_qp)
      pin = polar(centre, 0.75_qp, phi)
      arm = direction(o, pin)
      tip = polar(o, 4.0_qp, arm)
      ram = on_level(tip, 2.0_qp, 4.5_qp, 1.0_qp)
      links = [body('BASE', o, flat), body('CRANK', centre, phi), body('ARM', o, arm), &
               body('ROD', tip, direction(tip, ram)), body('RAM', ram, flat), body('', pin, arm)]
   end function crank_shaper

   !> A boom about (0, 0) lifted by a cylinder from (1, -1) to the boom's eye (2, 0.25). The cylinder's line misses
   !> its foot by h = 0.125: eye = foot + s e - h n, so the eye is at the distance sqrt(s^2 + h^2) from the foot, in
   !> the direction of the barrel less atan2(h, s). The piston's axes are turned by 180 deg against the barrel's.
   pure function cylinder(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: h = 0.125_qp, eye_x = 2.0_qp, eye_y = 0.25_qp
      type(jet_t) :: s, boom, barrel, time, no_angle
      type(place_t) :: o, foot, eye

      time = time_jet(t)
      s = 1.5_qp + 0.0625_qp*time + natural_spline_3(2.0_qp, [0.0_qp, 0.5_qp, 0.2_qp], time)
      o = fixed_place(0.0_qp, 0.0_qp)
      foot = fixed_place(1.0_qp, -1.0_qp)
      no_angle = constant_jet(0.0_qp)
      eye = third_corner(o, foot, constant_jet(eye_x**2 + eye_y**2), s*s + h**2, 1.0_qp)
      boom = direction(o, eye) - atan2(eye_y, eye_x)
      barrel = direction(foot, eye) + atan2(constant_jet(h), s)
      links = [body('BASE', o, no_angle), body('BOOM', o, boom), body('BARREL', foot, barrel), &
               body('PISTON', eye, barrel + pi_q)]
   end function cylinder

   !> Elliptic trammel: the bar's points A (xi = 0) and B (xi = 3) run on the x and the y axis: x_A = -3 cos phi,
   !> y_B = 3 sin phi. Set 1 gives phi, set 2 x_A, with B above.
   pure function trammel(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t) :: links(4)
      real(qp), parameter :: length = 3.0_qp
      type(jet_t) :: phi, x, time, flat
      type(place_t) :: o, a, b

      time = time_jet(t)
      flat = constant_jet(0.0_qp)
      if (set == 1) then
         phi = (30.0_qp + 45.0_qp*time)*degree_q
      else
         x = -2.5_qp + 1.5_qp*time - 0.125_qp*time*time
         phi = atan2(sqrt(length**2 - x*x), -x)
      end if
      o = fixed_place(0.0_qp, 0.0_qp)
      a = place_t(-length*cos(phi), flat)
      b = place_t(flat, length*sin(phi))
      links = [body('BASE', o, flat), body('BAR', a, phi), body('SHOE-A', a, flat), body('SHOE-B', b, flat)]
   end function trammel
end module closed_forms_sliders
