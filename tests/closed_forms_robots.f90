!> Tests. Closed forms of machines with several drives or many links. The lengths are those of the decks in input/,
!> written out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_robots
   use quad_jet, only: qp, jet_t, degree_q, constant_jet, time_jet, &
      operator(+), operator(-), operator(*), sqrt, sin, cos, atan2
   use closed_forms_dyads, only: place_t, body_t, fixed_place, body, place_on, polar, direction, third_corner, corner
   implicit none
   private
   public :: three_rrr, excavator, xy_table, scissor

contains

   !> Planar parallel robot 3-RRR: base joints (0, 0), (10, 0), (5, 8.5); platform joints (-1, -0.6), (1, -0.6),
   !> (0, 1.2); cranks and rods 3. x, y and the angle of the platform are driven; every elbow lies to the left of the
   !> way from the base to the platform.
   pure function three_rrr(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(8), platform
      real(qp), parameter :: base(2, 3) = reshape([0.0_qp, 0.0_qp, 10.0_qp, 0.0_qp, 5.0_qp, 8.5_qp], [2, 3])
      real(qp), parameter :: plate(2, 3) = reshape([-1.0_qp, -0.6_qp, 1.0_qp, -0.6_qp, 0.0_qp, 1.2_qp], [2, 3])
      character(1), parameter :: digit(3) = ['1', '2', '3']
      type(jet_t) :: time
      type(place_t) :: foot, elbow, joint
      integer :: k

      time = time_jet(t)
      platform = body('PLATFORM', place_t(5.0_qp + 0.8_qp*sin(time), 3.0_qp + 0.6_qp*sin(2.0_qp*time + 0.5_qp)), &
         0.1_qp + 0.25_qp*sin(1.5_qp*time))
      links(1:2) = [body('BASE', fixed_place(0.0_qp, 0.0_qp), constant_jet(0.0_qp)), platform]
      do k = 1, 3
         foot = fixed_place(base(1, k), base(2, k))
         joint = place_on(platform, plate(1, k), plate(2, k))
         elbow = corner(foot, 3.0_qp, joint, 3.0_qp, 1.0_qp)
         links(2*k + 1) = body('CRANK-'//digit(k), foot, direction(foot, elbow))
         links(2*k + 2) = body('ROD-'//digit(k), elbow, direction(elbow, joint))
      end do
   end function three_rrr

   !> Excavator arm: boom, stick and bucket, each moved by a cylinder whose slide is given. Every triangle has two
   !> sides on a link (or on the base) and the cylinder as its third; the last one moves the rocker, and a tie the bucket.
   pure function excavator(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(12), base, boom, stick
      type(jet_t) :: time, slide(3)
      type(place_t) :: o, f1, e1, f2, e2, s, f3, e3, r, j, b, tip

      time = time_jet(t)
      slide = [2.4_qp + 0.25_qp*sin(0.5_qp*time), 2.5_qp + 0.4_qp*sin(0.75_qp*time + 0.25_qp), &
               2.2_qp + 0.05_qp*time]
      base = body('BASE', fixed_place(0.0_qp, 0.0_qp), constant_jet(0.0_qp))
      o = place_on(base, 0.0_qp, 0.0_qp)
      f1 = place_on(base, 0.5_qp, -0.4_qp)
      e1 = third_corner(o, f1, constant_jet(2.5_qp**2 + 0.6_qp**2), slide(1)*slide(1), 1.0_qp)
      boom = body('BOOM', o, direction(o, e1) - angle(2.5_qp, 0.6_qp))
      s = place_on(boom, 5.5_qp, 0.0_qp)
      f2 = place_on(boom, 3.0_qp, 0.9_qp)
      e2 = third_corner(f2, s, slide(2)*slide(2), constant_jet(0.8_qp**2 + 0.3_qp**2), 1.0_qp)
      stick = body('STICK', s, direction(s, e2) - angle(-0.8_qp, 0.3_qp))
      f3 = place_on(stick, 0.2_qp, 0.5_qp)
      r = place_on(stick, 2.4_qp, 0.1_qp)
      e3 = third_corner(f3, r, slide(3)*slide(3), constant_jet(0.55_qp**2), 1.0_qp)
      j = e3
      tip = place_on(stick, 2.8_qp, 0.0_qp)
      b = corner(j, 0.6_qp, tip, 0.5_qp, 1.0_qp)
      links = [base, boom, stick, body('BUCKET', tip, direction(tip, b) - angle(0.4_qp, 0.3_qp)), &
               body('BARREL-1', f1, direction(f1, e1)), body('PISTON-1', e1, direction(f1, e1)), &
               body('BARREL-2', f2, direction(f2, e2)), body('PISTON-2', e2, direction(f2, e2)), &
               body('BARREL-3', f3, direction(f3, e3)), body('PISTON-3', e3, direction(f3, e3)), &
               body('ROCKER', r, direction(r, j)), body('TIE', j, direction(j, b))]
   end function excavator

   pure real(qp) function angle(xi, eta)
      real(qp), intent(in) :: xi, eta

      angle = atan2(eta, xi)
   end function angle

   !> X-Y table with a turning plate: base at (1, 2) turned by 20 deg; the saddle's guide along the base's axis, missing
   !> its origin by 0.5; the table's guide at 75 deg to the saddle, missing it by -0.25, the table turned by 15 deg
   !> against the saddle; the plate about (0.2, 0.1) of the table. From (P - Q) . n = h: Q = P + s e - h n.
   pure function xy_table(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(4), base, saddle, table
      type(jet_t) :: time, x, y

      time = time_jet(t)
      x = 0.5_qp + 0.4_qp*sin(60.0_qp*degree_q*time)
      y = 0.3_qp*time - 0.05_qp*time*time
      base = body('BASE', fixed_place(1.0_qp, 2.0_qp), constant_jet(20.0_qp*degree_q))
      saddle = body('SADDLE', slid(base, 0.0_qp, x, 0.5_qp), base%phi)
      table = body('TABLE', slid(saddle, 75.0_qp*degree_q, y, -0.25_qp), saddle%phi + 15.0_qp*degree_q)
      links = [base, saddle, table, &
               body('PLATE', place_on(table, 0.2_qp, 0.1_qp), table%phi + (10.0_qp + 40.0_qp*time)*degree_q)]
   end function xy_table

   !> The point Q of a prismatic pair whose P is the origin of `b`, guide at `alpha` to its axes, offset `h`.
   pure type(place_t) function slid(b, alpha, slide, h) result(q)
      type(body_t), intent(in) :: b
      real(qp), intent(in) :: alpha, h
      type(jet_t), intent(in) :: slide
      type(body_t) :: guide

      guide = body('', place_t(b%x, b%y), b%phi + alpha)
      q = place_on(guide, 0.0_qp, -h)
      q = place_t(q%x + slide*cos(guide%phi), q%y + slide*sin(guide%phi))
   end function slid


   !> Scissor lift of three stages with bars of length 2: foot at the distance x, so each stage rises by
   !> h = sqrt(2^2 - x^2). Bar A of stage k runs from (0, (k - 1) h) to (x, k h), bar B from (x, (k - 1) h) to (0, k h).
   pure function scissor(t) result(links)
      real(qp), intent(in) :: t
      type(body_t) :: links(10)
      character(1), parameter :: digit(3) = ['1', '2', '3']
      type(jet_t) :: x, h, flat, zero
      integer :: k

      x = 1.8_qp - 0.35_qp*time_jet(t) + 0.03_qp*time_jet(t)*time_jet(t)
      h = sqrt(2.0_qp**2 - x*x)
      flat = constant_jet(0.0_qp)
      zero = flat
      links(1:2) = [body('BASE', place_t(zero, zero), flat), body('FOOT', place_t(x, zero), flat)]
      do k = 1, 3
         links(2*k + 1) = body('BAR-A'//digit(k), place_t(zero, (k - 1.0_qp)*h), atan2(h, x))
         links(2*k + 2) = body('BAR-B'//digit(k), place_t(x, (k - 1.0_qp)*h), atan2(h, -x))
      end do
      links(9:10) = [body('PLATFORM', place_t(zero, 3.0_qp*h), flat), body('SHOE', place_t(x, 3.0_qp*h), flat)]
   end function scissor
end module closed_forms_robots
