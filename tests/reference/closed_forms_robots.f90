!> Tests. Closed forms of machines with several drives or many links. The lengths are those of the decks in input/,
!> written out again by hand so that a deck read wrongly shows up as a difference.
module closed_forms_robots
   use quad_jet
   use closed_forms_dyads
   implicit none
   private
   public :: robots

   !> Planar parallel robot 3-RRR: joints of the base and of the platform; cranks and rods 3.
   real(qp), parameter :: feet(2, 3) = reshape([0.0_qp, 0.0_qp, 10.0_qp, 0.0_qp, 5.0_qp, 8.5_qp], [2, 3])
   real(qp), parameter :: plate(2, 3) = reshape([-1.0_qp, -0.6_qp, 1.0_qp, -0.6_qp, 0.0_qp, 1.2_qp], [2, 3])
   character(1), parameter :: digit(3) = ['1', '2', '3']

contains

   !> The links of the deck `name` at `time`; none for another deck.
   pure function robots(name, time) result(links)
      character(*), intent(in) :: name
      type(jet_t), intent(in) :: time
      type(body_t), allocatable :: links(:)

      select case (name)
      case ('three_rrr'); links = three_rrr(time)
      case ('three_rrr_cranks')
         links = three_rrr_cranks([1.0_qp + 0.1_qp*sin(time), 3.1_qp + 0.15_qp*sin(1.5_qp*time), &
            -0.02_qp*time - 0.8_qp])
      case ('excavator'); links = excavator(time)
      case ('xy_table'); links = xy_table(time)
      case ('scissor'); links = scissor(1.8_qp - 0.35_qp*time + 0.03_qp*time*time)
      case default; allocate (links(0))
      end select
   end function robots

   !> x, y and the angle of the platform are driven; every elbow lies to the left of the way from the base to the
   !> platform.
   pure function three_rrr(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(8), platform
      type(place_t) :: foot, elbow, joint
      integer :: k

      platform = body('PLATFORM', place_t(5.0_qp + 0.8_qp*sin(time), 3.0_qp + 0.6_qp*sin(2.0_qp*time + 0.5_qp)), &
         0.1_qp + 0.25_qp*sin(1.5_qp*time))
      links(1:2) = [base, platform]
      do k = 1, 3
         foot = fixed_place(feet(1, k), feet(2, k))
         joint = place_on(platform, plate(1, k), plate(2, k))
         elbow = corner(foot, 3.0_qp, joint, 3.0_qp, 1.0_qp)
         links(2*k + 1) = body('CRANK-'//digit(k), foot, direction(foot, elbow))
         links(2*k + 2) = body('ROD-'//digit(k), elbow, direction(elbow, joint))
      end do
   end function three_rrr

   !> The robot led by its cranks at the angles `crank`. Where its platform is then has no formula (a polynomial of
   !> degree six): the three equations |P - E|^2 = 9 by Newton's method in real128.
   pure function three_rrr_cranks(crank) result(links)
      type(jet_t), intent(in) :: crank(3)
      type(body_t) :: links(8), platform
      type(place_t) :: foot, elbow(3)
      integer :: k

      do k = 1, 3
         elbow(k) = polar(fixed_place(feet(1, k), feet(2, k)), 3.0_qp, crank(k))
      end do
      platform = body('PLATFORM', fixed_place(5.0_qp, 3.0_qp), constant_jet(0.1_qp))
      ! Digits double five times; a derivative follows when what it is the derivative of is there.
      do k = 1, 12
         call improve(elbow, platform)
      end do
      links(1:2) = [base, platform]
      do k = 1, 3
         foot = fixed_place(feet(1, k), feet(2, k))
         links(2*k + 1) = body('CRANK-'//digit(k), foot, crank(k))
         links(2*k + 2) = body('ROD-'//digit(k), elbow(k), direction(elbow(k), place_on(platform, plate(1, k), &
            plate(2, k))))
      end do
   end function three_rrr_cranks

   !> One step of Newton's method: the platform's joints at the distance 3 from `elbow`. The gradient of
   !> |d|^2/2 by x, y and the angle is d and d x arm; Cramer's rule.
   pure subroutine improve(elbow, platform)
      type(place_t), intent(in) :: elbow(3)
      type(body_t), intent(inout) :: platform
      type(jet_t) :: r(3), x(3)
      type(place_t) :: p
      real(qp) :: a(3, 3), d(2)
      integer :: k

      do k = 1, 3
         p = place_on(platform, plate(1, k), plate(2, k))
         d = [p%x%v - elbow(k)%x%v, p%y%v - elbow(k)%y%v]
         a(k, :) = [d, d(2)*(p%x%v - platform%x%v) - d(1)*(p%y%v - platform%y%v)]
         r(k) = 0.5_qp*((p%x - elbow(k)%x)*(p%x - elbow(k)%x) + (p%y - elbow(k)%y)*(p%y - elbow(k)%y) - 9.0_qp)
      end do
      do k = 1, 3
         associate (i => mod(k, 3) + 1, j => mod(k + 1, 3) + 1)
            x(k) = (cofactor(2, 3, i, j)*r(1) + cofactor(3, 1, i, j)*r(2) + cofactor(1, 2, i, j)*r(3)) &
               /(cofactor(2, 3, 2, 3)*a(1, 1) + cofactor(3, 1, 2, 3)*a(2, 1) + cofactor(1, 2, 2, 3)*a(3, 1))
         end associate
      end do
      platform%x = platform%x - x(1)
      platform%y = platform%y - x(2)
      platform%phi = platform%phi - x(3)

   contains

      pure real(qp) function cofactor(row, next_row, column, next_column)
         integer, intent(in) :: row, next_row, column, next_column

         cofactor = a(row, column)*a(next_row, next_column) - a(row, next_column)*a(next_row, column)
      end function cofactor
   end subroutine improve

   !> Excavator arm: boom, stick and bucket, each moved by a cylinder whose slide is given. Every triangle has two
   !> sides on a link (or on the base) and the cylinder as its third; the last one moves the rocker, and a tie the
   !> bucket.
   pure function excavator(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(12), boom, stick
      type(jet_t) :: slide(3)
      type(place_t) :: f1, e1, f2, e2, s, f3, e3, r, b, tip

      slide = [2.4_qp + 0.25_qp*sin(0.5_qp*time), 2.5_qp + 0.4_qp*sin(0.75_qp*time + 0.25_qp), &
               2.2_qp + 0.05_qp*time]
      f1 = fixed_place(0.5_qp, -0.4_qp)
      e1 = third_corner(origin, f1, constant_jet(2.5_qp**2 + 0.6_qp**2), slide(1)*slide(1), 1.0_qp)
      boom = body('BOOM', origin, direction(origin, e1) - angle(2.5_qp, 0.6_qp))
      s = place_on(boom, 5.5_qp, 0.0_qp)
      f2 = place_on(boom, 3.0_qp, 0.9_qp)
      e2 = third_corner(f2, s, slide(2)*slide(2), constant_jet(0.8_qp**2 + 0.3_qp**2), 1.0_qp)
      stick = body('STICK', s, direction(s, e2) - angle(-0.8_qp, 0.3_qp))
      f3 = place_on(stick, 0.2_qp, 0.5_qp)
      r = place_on(stick, 2.4_qp, 0.1_qp)
      e3 = third_corner(f3, r, slide(3)*slide(3), constant_jet(0.55_qp**2), 1.0_qp)
      tip = place_on(stick, 2.8_qp, 0.0_qp)
      b = corner(e3, 0.6_qp, tip, 0.5_qp, 1.0_qp)
      links = [base, boom, stick, body('BUCKET', tip, direction(tip, b) - angle(0.4_qp, 0.3_qp)), &
               body('BARREL-1', f1, direction(f1, e1)), body('PISTON-1', e1, direction(f1, e1)), &
               body('BARREL-2', f2, direction(f2, e2)), body('PISTON-2', e2, direction(f2, e2)), &
               body('BARREL-3', f3, direction(f3, e3)), body('PISTON-3', e3, direction(f3, e3)), &
               body('ROCKER', r, direction(r, e3)), body('TIE', e3, direction(e3, b))]
   end function excavator

   pure real(qp) function angle(xi, eta)
      real(qp), intent(in) :: xi, eta

      angle = atan2(eta, xi)
   end function angle

   !> X-Y table with a turning plate: base at (1, 2) turned by 20 deg; the saddle's guide along the base's axis, missing
   !> its origin by 0.5; the table's guide at 75 deg to the saddle, missing it by -0.25, the table turned by 15 deg
   !> against the saddle; the plate about (0.2, 0.1) of the table. From (P - Q) . n = h: Q = P + s e - h n.
   pure function xy_table(time) result(links)
      type(jet_t), intent(in) :: time
      type(body_t) :: links(4), turned_base, saddle, table
      type(jet_t) :: x, y

      x = 0.5_qp + 0.4_qp*sin(60.0_qp*degree_q*time)
      y = 0.3_qp*time - 0.05_qp*time*time
      turned_base = body('BASE', fixed_place(1.0_qp, 2.0_qp), constant_jet(20.0_qp*degree_q))
      saddle = body('SADDLE', slid(turned_base, 0.0_qp, x, 0.5_qp), turned_base%phi)
      table = body('TABLE', slid(saddle, 75.0_qp*degree_q, y, -0.25_qp), saddle%phi + 15.0_qp*degree_q)
      links = [turned_base, saddle, table, &
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
   pure function scissor(x) result(links)
      type(jet_t), intent(in) :: x
      type(body_t) :: links(10)
      type(jet_t) :: h
      integer :: k

      h = sqrt(2.0_qp**2 - x*x)
      links(1:2) = [base, body('FOOT', place_t(x, flat), flat)]
      do k = 1, 3
         links(2*k + 1) = body('BAR-A'//digit(k), place_t(flat, (k - 1.0_qp)*h), atan2(h, x))
         links(2*k + 2) = body('BAR-B'//digit(k), place_t(x, (k - 1.0_qp)*h), atan2(h, -x))
      end do
      links(9:10) = [body('PLATFORM', place_t(flat, 3.0_qp*h), flat), body('SHOE', place_t(x, 3.0_qp*h), flat)]
   end function scissor
end module closed_forms_robots
