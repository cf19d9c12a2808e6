!> Tests. Closed forms of the six-bar linkages: a four-bar and a dyad hung on it. The lengths are those of the decks in
!> input/, written out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_sixbars
   use quad_jet, only: qp, jet_t, degree_q, constant_jet, time_jet, &
      operator(+), operator(-), operator(*), sin
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, place_on, polar, direction, corner, on_line, &
      four_bar_links
   implicit none
   private
   public :: watt, watt_output, stephenson, stephenson_output, klann, grounds

contains

   !> Watt's second six-bar: crank-rocker 1, 3.5, 3 on A0 B0 = 4; the rocker's second arm ends in C = (1.2, -1.6) of its
   !> axes; rod CD = 4, output D0 D = 3 about (9, 0).
   pure function watt(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6)
      type(place_t) :: d0, c, d

      links(:4) = four_bar_links(40.0_qp*degree_q*time_jet(t), [1.0_qp, 3.5_qp, 3.0_qp, 4.0_qp], 1.0_qp)
      d0 = fixed_place(9.0_qp, 0.0_qp)
      c = place_on(links(4), 1.2_qp, -1.6_qp)
      d = corner(c, 4.0_qp, d0, 3.0_qp, 1.0_qp)
      links(5:) = [body('ROD', c, direction(c, d)), body('OUTPUT', d0, direction(d0, d))]
   end function watt

   !> The same six-bar driven from its other side: the output swings by 6 deg about 100 deg. The rocker's second arm is
   !> 2 long; C lies to the right of the way from D to B0, the crank's pin to the left of that from A0 to B.
   pure function watt_output(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6), rocker
      type(jet_t) :: phi
      type(place_t) :: a0, b0, d0, a, b, c, d

      phi = (100.0_qp + 6.0_qp*sin(60.0_qp*degree_q*time_jet(t)))*degree_q
      a0 = fixed_place(0.0_qp, 0.0_qp)
      b0 = fixed_place(4.0_qp, 0.0_qp)
      d0 = fixed_place(9.0_qp, 0.0_qp)
      d = polar(d0, 3.0_qp, phi)
      c = corner(d, 4.0_qp, b0, 2.0_qp, -1.0_qp)
      rocker = body('ROCKER', b0, direction(b0, c) + atan2(1.6_qp, 1.2_qp))
      b = place_on(rocker, 3.0_qp, 0.0_qp)
      a = corner(a0, 1.0_qp, b, 3.5_qp, 1.0_qp)
      links = [body('BASE', a0, constant_jet(0.0_qp)), body('CRANK', a0, direction(a0, a)), &
               body('COUPLER', a, direction(a, b)), rocker, body('ROD', c, direction(c, d)), body('OUTPUT', d0, phi)]
   end function watt_output

   !> Stephenson's third six-bar: crank-rocker 1, 2.5, 2.5 on A0 B0 = 3; the point C = (1.25, 1.5) of the coupler moves
   !> the dyad CD = 4, D0 D = 3 about (5, 3). The crank turns with a wobble: 0.8 t + 0.2 sin(1.6 t).
   pure function stephenson(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6)
      type(jet_t) :: time

      time = time_jet(t)
      links = stephenson_at(0.8_qp*time + 0.2_qp*sin(1.6_qp*time))
   end function stephenson

   !> The same six-bar driven from its other side: the output moves as 2.55 + 0.3 sin(1.2 t). Four links are then found
   !> at once, without a formula; but the output is known for each angle of the crank and grows with it from 1.5 to 4
   !> rad: that function is inverted, by halves and then by Newton's method, and its derivatives with it.
   pure function stephenson_output(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6)
      type(jet_t) :: wanted, phi
      real(qp) :: low, high
      integer :: k

      wanted = 2.55_qp + 0.3_qp*sin(1.2_qp*time_jet(t))
      low = 1.5_qp
      high = 4.0_qp
      phi = time_jet(0.5_qp*(low + high))
      do k = 1, 30
         links = stephenson_at(phi)
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
      links = stephenson_at(phi)
   end function stephenson_output

   !> Its links with the crank at `phi`.
   pure function stephenson_at(phi) result(links)
      type(jet_t), intent(in) :: phi
      type(body_t) :: links(6)
      type(place_t) :: d0, c, d

      links(:4) = four_bar_links(phi, [1.0_qp, 2.5_qp, 2.5_qp, 3.0_qp], 1.0_qp)
      d0 = fixed_place(5.0_qp, 3.0_qp)
      c = place_on(links(3), 1.25_qp, 1.5_qp)
      d = corner(c, 4.0_qp, d0, 3.0_qp, 1.0_qp)
      links(5:) = [body('ROD', c, direction(c, d)), body('OUTPUT', d0, direction(d0, d))]
   end function stephenson_at

   !> Klann's leg, the joints of US patent 6,260,862: crank 0.268 about (1.599, 0.750), lower rocker 0.3206 about
   !> (1.009, 0.574), upper rocker 0.5177 about (1.366, 1.366); the rod from the crank's pin over the elbow at 0.59 to
   !> the knee; the leg from the knee to the hip, 0.8966, and to the foot. Elbow and hip: to the right of the way from
   !> the pin to the lower rocker's axle, to the left of the way from the knee to the upper rocker's.
   pure function klann(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(6), rod
      type(jet_t) :: phi
      type(place_t) :: shaft, lower, upper, pin, elbow, knee, hip

      phi = (180.0_qp + 30.0_qp*time_jet(t))*degree_q
      shaft = fixed_place(1.599_qp, 0.75_qp)
      lower = fixed_place(1.009_qp, 0.574_qp)
      upper = fixed_place(1.366_qp, 1.366_qp)
      pin = polar(shaft, 0.268_qp, phi)
      elbow = corner(pin, 0.59_qp, lower, 0.3206_qp, -1.0_qp)
      rod = body('ROD', pin, direction(pin, elbow))
      knee = place_on(rod, 1.0990_qp, -0.1164_qp)
      hip = corner(knee, 0.8966_qp, upper, 0.5177_qp, 1.0_qp)
      links = [body('BASE', fixed_place(0.0_qp, 0.0_qp), constant_jet(0.0_qp)), body('CRANK', shaft, phi), rod, &
               body('LOWER', lower, direction(lower, elbow)), body('UPPER', upper, direction(upper, hip)), &
               body('LEG', knee, direction(knee, hip))]
   end function klann

   !> Three ground links: FLOOR at the origin with the crank's axle (0.5, 0.25); POST at (4, 1) turned by 90 deg with
   !> the rocker's axle at 0.5 along it; WALL at (9, 0) turned by 60 deg with the guide through its point (1, 0.25), at
   !> 30 deg to its axes: upright. Crank 1, coupler 4, rocker 3 and 4.5 to its tip, rod 10 down to the ram, which stands
   !> at 45 deg to the wall.
   pure function grounds(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(8), low, post, wall
      type(jet_t) :: phi, rocker
      type(place_t) :: a0, b0, guide, a, b, tip, ram

      phi = (10.0_qp + 60.0_qp*time_jet(t))*degree_q
      low = body('FLOOR', fixed_place(0.0_qp, 0.0_qp), constant_jet(0.0_qp))
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
end module closed_forms_sixbars
