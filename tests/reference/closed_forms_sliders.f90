!> Tests. Closed forms of the mechanisms with sliding pairs. The lengths are those of the decks in input/,
!> written out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_sliders
   use kinds, only: wp
   use quad_jet
   use closed_forms_dyads
   implicit none
   private
   public :: sliders, pushed_slider

contains

   !> The links of the deck `name` at `time`, in its set number `set`; none for another deck.
   pure function sliders(name, set, time) result(links)
      character(*), intent(in) :: name
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('crank_slider')
         ! The slide line at the height 0.5.
         links = slider_crank(merge(60.0_qp*degree_q*time, 0.25_qp + 0.5_qp*time + 0.02_qp*time*time*time, set == 1), &
            [1.0_qp, 3.0_qp], fixed_place(0.0_qp, 0.5_qp), flat)
      case ('crank_inline')
         ! An upright engine, whose piston has upright axes.
         links = slider_crank((90.0_qp + 18.0_qp*time)*degree_q, [43.0_qp, 150.0_qp], origin, &
            constant_jet(90.0_qp*degree_q))
         links(4)%phi = flat
      case ('near_equal_rod')
         ! Driven by the crank through both dead points.
         links = slider_crank(15.0_qp*degree_q*time, [1.0_qp, 1.001_qp], origin, flat)
      case ('yoke', 'jarzmowy', 'yoke_mirrored')
         ! The paper's yoke mechanism: r = 1, l1 = 4, l2 = 2, a = 2, b = 5, the ram to the right or (mirrored) to the
         ! left.
         links = slotted_lever(merge(30.0_qp*degree_q*time, 0.1_qp*time*time, set == 1), 2.0_qp, 1.0_qp, 4.0_qp, &
            2.0_qp, &
            5.0_qp, merge(-1.0_qp, 1.0_qp, name == 'yoke_mirrored'))
      case ('whitworth')
         ! Whitworth's quick return: the arm's tail is behind the pivot.
         links = slotted_lever((90.0_qp + 36.0_qp*time)*degree_q, -1.0_qp, 2.0_qp, -1.5_qp, 5.0_qp, 0.0_qp, 1.0_qp)
         links(4)%name = 'ARM'
      case ('crank_shaper')
         ! The block in the slot has no name.
         links = slotted_lever((90.0_qp + 36.0_qp*time)*degree_q, 2.0_qp, 0.75_qp, 4.0_qp, 2.0_qp, 4.5_qp, 1.0_qp)
         links(3:4)%name = ['   ', 'ARM']
      case ('scotch_yoke'); links = scotch_yoke(set, time)
      case ('trammel', 'cardan'); links = trammel(set, time)
      case ('scott_russell', 'scott_russell_at', 'scott_russell_branch')
         links = scott_russell((30.0_qp + 12.0_qp*time)*degree_q)
         ! From 90 deg on the end B stays in the centre, and the bar lies on the crank.
         if (name == 'scott_russell_branch' .and. time%v >= 5.0_qp) then
            links(3)%phi = links(2)%phi + 180.0_qp*degree_q
            links(4) = body('SHOE', origin, flat)
         end if
      case ('dead_point_6'); links = dead_point(6, time)
      case ('dead_point_9'); links = dead_point(9, time)
      case ('dead_point_12'); links = dead_point(12, time)
      case ('drawn_slider'); links = drawn_slider(set, time)
      case ('drawn_cylinder'); links = drawn_cylinder(time)
      case ('cylinder'); links = cylinder(time)
      case ('inverted_slider'); links = inverted_slider(time)
      case ('oldham'); links = oldham(time)
      case ('geneva'); links = geneva(time)
      case ('geneva_slot')
         links = geneva(time)
         links(4)%name = ''
      case ('points_meet')
         ! Two blocks on crossed guides through O; the first meets O at t = 1.
         links = [base, body('BLOCK', place_t(time - 1.0_qp, flat), flat), &
                  body('CROSS', place_t(flat, -1.0_qp + 0.5_qp*time + 0.25_qp*time*time), flat)]
      case default; allocate (links(0))
      end select
   end function sliders

   !> A crank at `phi` about (0, `height`) of the length `crank`, its pin in a block on a lever about (0, 0), which
   !> points to it; a `rod` from the point at `tip` of the lever to a ram on the line y = `ram_height`, to the right
   !> (`side` = 1.0) or to the left (-1.0).
   pure function slotted_lever(phi, height, crank, tip, rod, ram_height, side) result(links)
      type(jet_t), intent(in) :: phi
      real(qp), intent(in) :: height, crank, tip, rod, ram_height, side
      type(body_t) :: links(6)
      type(jet_t) :: lever
      type(place_t) :: centre, pin, end_of_lever, ram

      centre = fixed_place(0.0_qp, height)
      pin = polar(centre, crank, phi)
      lever = direction(origin, pin)
      end_of_lever = polar(origin, tip, lever)
      ram = on_line(end_of_lever, rod, fixed_place(0.0_qp, ram_height), flat, side)
      links = [base, body('CRANK', centre, phi), body('BLOCK', pin, lever), body('LEVER', origin, lever), &
               body('ROD', end_of_lever, direction(end_of_lever, ram)), body('RAM', ram, flat)]
   end function slotted_lever

   !> Scotch yoke of radius 40: x = 40 cos phi. Set 1 gives phi, set 2 x itself, with the crank above.
   pure function scotch_yoke(set, time) result(links)
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: r = 40.0_qp
      type(jet_t) :: phi, x
      type(place_t) :: pin

      if (set == 1) then
         phi = (45.0_qp + 15.0_qp*time)*degree_q
      else
         x = 30.0_qp*sin(1.5_qp*time)
         phi = atan2(sqrt(r**2 - x*x), x)
      end if
      pin = polar(origin, r, phi)
      links = [base, body('CRANK', origin, phi), body('BLOCK', pin, flat), body('YOKE', place_t(pin%x, flat), flat)]
   end function scotch_yoke

   !> Elliptic trammel: the bar's points A (xi = 0) and B (xi = 3) run on the x and the y axis: x_A = -3 cos phi,
   !> y_B = 3 sin phi. Set 1 gives phi, set 2 x_A, with B above.
   pure function trammel(set, time) result(links)
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: length = 3.0_qp
      type(jet_t) :: phi, x
      type(place_t) :: a, b

      if (set == 1) then
         phi = (30.0_qp + 45.0_qp*time)*degree_q
      else
         x = -2.5_qp + 1.5_qp*time - 0.125_qp*time*time
         phi = atan2(sqrt(length**2 - x*x), -x)
      end if
      a = place_t(-length*cos(phi), flat)
      b = place_t(flat, length*sin(phi))
      links = [base, body('BAR', a, phi), body('SHOE-A', a, flat), body('SHOE-B', b, flat)]
   end function trammel

   !> Scott-Russell with crank 1.5 and bar 3: its middle on the crank's pin, its end B on the x axis at 3 cos phi, its
   !> end C on the y axis at 3 sin phi. At 90 deg B is in the centre.
   pure function scott_russell(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(4)

      links = [base, body('CRANK', origin, phi), body('BAR', polar(origin, 1.5_qp, phi), -phi), &
               body('SHOE', place_t(3.0_qp*cos(phi), flat), flat)]
   end function scott_russell

   !> Crank 1 and rod 3, driven by the piston: x = 4 - g (1 + t), the crank above, g = 2.3/10^power. The triangle's
   !> height over x by Heron, where 4 - x is not a difference: h = sqrt((4 + x)(4 - x)(x + 2)(x - 2))/(2 x).
   pure function dead_point(power, time) result(links)
      integer, intent(in) :: power
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      type(jet_t) :: gap, x
      type(place_t) :: pin, piston

      gap = 2.3_qp/10.0_qp**power*(1.0_qp + time)
      x = 4.0_qp - gap
      piston = place_t(x, flat)
      pin = place_t((x*x - 8.0_qp)/(2.0_qp*x), sqrt((4.0_qp + x)*gap*(x + 2.0_qp)*(x - 2.0_qp))/(2.0_qp*x))
      links = [base, body('CRANK', origin, direction(origin, pin)), body('ROD', pin, direction(pin, piston)), &
               body('PISTON', piston, flat)]
   end function dead_point

   !> The mechanism of `dead_point` with any `numbers` in its deck: the crank's pin and the rod's eye in their links'
   !> axes (1 to 4), the direction of the guide (5), the piston's value, rate and acceleration at t = 0 (6 to 8), the
   !> instant (9).
   pure function pushed_slider(numbers) result(links)
      real(qp), intent(in) :: numbers(9)
      type(body_t) :: links(4)
      type(jet_t) :: reach, x, across, time
      type(place_t) :: pin, eye
      real(qp) :: crank(2), rod(2), c(3), slope(2), both, less

      crank = numbers(1:2)
      rod = numbers(3:4)
      slope = [cos(numbers(5)), sin(numbers(5))]
      c = numbers(6:8)
      time = time_jet(numbers(9))
      both = norm2(crank) + norm2(rod)
      less = norm2(rod) - norm2(crank)
      reach = (c(1) + time*(c(2) + time*(c(3)/2.0_qp)))/slope(1)
      eye = place_t(slope(1)*reach, slope(2)*reach)
      x = (reach*reach - both*less)/(2.0_qp*reach)
      across = sqrt((both + reach)*(both - reach)*(reach + less)*(reach - less))/(2.0_qp*reach)
      pin = place_t(slope(1)*x - slope(2)*across, slope(2)*x + slope(1)*across)
      links = [base, body('CRANK', origin, direction(origin, pin) - atan2(crank(2), crank(1))), &
               body('ROD', pin, direction(pin, eye) - atan2(rod(2), rod(1))), body('PISTON', eye, flat)]
   end function pushed_slider

   !> Slider-crank drawn with its crank at (0.6, 0.8) from (0, 0) and the slider at (3, 0.5). In set 1 the slider stays
   !> on y = 0.5, in set 2 it swings by 0.2 along a line that falls by 15 deg, its axes at 30 deg. The axes of crank and
   !> rod lie in those of the drawing.
   pure function drawn_slider(set, time) result(links)
      integer, intent(in) :: set
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: a(2) = [0.6_qp, 0.8_qp], b(2) = [3.0_qp, 0.5_qp], drawn(2) = 0.0_qp, &
         fall = -15.0_qp*degree_q
      type(place_t) :: pin, slider
      type(jet_t) :: way, turned

      turned = flat
      if (set == 1) then
         pin = place_on(body('CRANK', origin, 30.0_qp*degree_q*time), a(1), a(2))
         slider = on_line(pin, sqrt(sum((b - a)**2)), fixed_place(0.0_qp, b(2)), flat, 1.0_qp)
      else
         way = 0.2_qp*sin(30.0_qp*degree_q*time)
         turned = constant_jet(30.0_qp*degree_q)
         slider = place_t(b(1) + way*cos(fall), b(2) + way*sin(fall))
         pin = third_corner(origin, slider, constant_jet(sum(a**2)), constant_jet(sum((b - a)**2)), 1.0_qp)
      end if
      links = [base, drawn_link('CRANK', origin, pin, drawn, a, drawn), drawn_link('ROD', pin, slider, a, b, drawn), &
               body('SLIDER', slider, turned)]
   end function drawn_slider

   !> Boom about (0, 0) with the eye of its cylinder drawn at (1.5, 1); the cylinder stands on (2, -1) and grows by 0.5
   !> in a unit of time from the length drawn. All axes lie in those of the drawing.
   pure function drawn_cylinder(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: b(2) = [1.5_qp, 1.0_qp], b0(2) = [2.0_qp, -1.0_qp], drawn(2) = 0.0_qp
      type(place_t) :: foot, eye
      type(jet_t) :: length

      length = sqrt(sum((b - b0)**2)) + 0.5_qp*time
      foot = fixed_place(b0(1), b0(2))
      eye = third_corner(origin, foot, constant_jet(sum(b**2)), length*length, 1.0_qp)
      links = [base, drawn_link('BOOM', origin, eye, drawn, b, drawn), drawn_link('BARREL', foot, eye, b0, b, drawn), &
               drawn_link('ROD', eye, foot, b, b0, drawn)]
   end function drawn_cylinder

   !> A boom about (0, 0) lifted by a cylinder from (1, -1) to the boom's eye (2, 0.25). The cylinder's line misses
   !> its foot by h = 0.125: eye = foot + s e - h n, so the eye is at the distance sqrt(s^2 + h^2) from the foot, in
   !> the direction of the barrel less atan2(h, s). The piston's axes are turned by 180 deg against the barrel's.
   pure function cylinder(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: h = 0.125_qp, eye_x = 2.0_qp, eye_y = 0.25_qp
      type(jet_t) :: s, boom, barrel
      type(place_t) :: foot, eye

      s = 1.5_qp + 0.0625_qp*time + natural_spline_3(2.0_qp, [0.0_qp, 0.5_qp, 0.2_qp], time)
      foot = fixed_place(1.0_qp, -1.0_qp)
      eye = third_corner(origin, foot, constant_jet(eye_x**2 + eye_y**2), s*s + h**2, 1.0_qp)
      boom = direction(origin, eye) - atan2(eye_y, eye_x)
      barrel = direction(foot, eye) + atan2(constant_jet(h), s)
      links = [base, body('BOOM', origin, boom), body('BARREL', foot, barrel), body('PISTON', eye, barrel + pi_q)]
   end function cylinder

   !> Inverted slider: crank 1 about (0, 0), lever about F = (2.5, -0.5). The guide stands at 20 deg to the lever and
   !> misses F by h = 0.5: pin = F + s e - h n, so s^2 = |pin - F|^2 - h^2 and the guide's direction is that from F to
   !> the pin plus atan2(h, s). The block is turned by 30 deg against the lever.
   pure function inverted_slider(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: h = 0.5_qp
      type(jet_t) :: phi, lever, s
      type(place_t) :: f, pin

      phi = (15.0_qp + 30.0_qp*time + 3.0_qp*time*time)*degree_q
      f = fixed_place(2.5_qp, -0.5_qp)
      pin = polar(origin, 1.0_qp, phi)
      s = sqrt(distance_squared(f, pin) - h**2)
      lever = direction(f, pin) + atan2(constant_jet(h), s) - 20.0_qp*degree_q
      links = [base, body('CRANK', origin, phi), body('LEVER', f, lever), body('BLOCK', pin, lever + 30.0_qp*degree_q)]
   end function inverted_slider

   !> Oldham's coupling, shafts at (0, 0) and (e, 0), e = 3. The cross slides in disc 1 along phi and in disc 2 along
   !> phi + 90 deg, so its centre is on both lines: at e cos phi (cos phi, sin phi), on a circle, twice in a turn.
   pure function oldham(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      real(qp), parameter :: e = 3.0_qp
      type(jet_t) :: phi

      phi = (10.0_qp + 20.0_qp*time + 2.5_qp*time*time)*degree_q
      links = [base, body('DISC-1', origin, phi), body('DISC-2', fixed_place(e, 0.0_qp), phi + 90.0_qp*degree_q), &
               body('CROSS', place_t(e*cos(phi)*cos(phi), e*cos(phi)*sin(phi)), phi)]
   end function oldham

   !> Geneva wheel with four slots while the pin is in one: the axles of crank and wheel are 1 apart, the pin is at
   !> r = sqrt(1/2), rounded as on the card, from that of the crank, and comes into the slot at -45 deg. The slot passes
   !> through the wheel's axle.
   pure function geneva(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4)
      type(jet_t) :: phi, slot
      type(place_t) :: wheel, pin

      phi = (-45.0_qp + 90.0_qp*time)*degree_q
      wheel = fixed_place(1.0_qp, 0.0_qp)
      pin = polar(origin, real(0.70710678118654757_wp, qp), phi)
      ! The slot's axis is turned by half a turn against the way from the axle to the pin.
      slot = direction(pin, wheel)
      links = [base, body('CRANK', origin, phi), body('WHEEL', wheel, slot), body('BLOCK', pin, slot)]
   end function geneva
end module closed_forms_sliders
