!> Tests. Closed forms written by hand for speed: position, velocity and acceleration of all links in one sweep, the
!> limit that `make bench` counts in. The links are in the order of the decks, the ground first. Their correctness
!> is not taken from here: the closed forms in real128 have printed expected/.
module fast_forms
   use kinds, only: wp
   implicit none
   private
   public :: form, fast_four_bar, fast_yoke, fast_andrews, fast_jansen
   public :: spot_t, two_rods, put_link

   abstract interface
      !> The motion of the `n` links where the drive is at `phi` and turns at the constant `rate`:
      !> q, v, a (3, n) are x, y, phi and their derivatives.
      pure subroutine form(phi, rate, n, q, v, a)
         import :: wp
         real(wp), intent(in) :: phi, rate
         integer, intent(in) :: n
         real(wp), intent(inout) :: q(3, n), v(3, n), a(3, n)
      end subroutine form
   end interface

   !> A point with its velocity and acceleration.
   type :: spot_t
      real(wp) :: x = 0.0_wp, y = 0.0_wp, vx = 0.0_wp, vy = 0.0_wp, ax = 0.0_wp, ay = 0.0_wp
   end type spot_t

contains

   !> Crank 1, coupler 3.5, rocker 3 on the base 4, open. With d from the crank's tip A to the pivot B0 of the rocker,
   !> e1 = AB = u d + v (d turned by 90 deg), e2 = B0B = e1 - d; the rates follow from vA + w1 x e1 = w2 x e2.
   pure subroutine fast_four_bar(phi, rate, n, q, v, a)
      real(wp), intent(in) :: phi, rate
      integer, intent(in) :: n
      real(wp), intent(inout) :: q(3, n), v(3, n), a(3, n)
      real(wp) :: c, s, dx, over, u, h, e1x, e1y, e2x, e2y, k, w1, w2, gx, gy, acceleration

      c = cos(phi)
      s = sin(phi)
      acceleration = rate*rate
      dx = 4.0_wp - c
      over = 1.0_wp/(17.0_wp - 8.0_wp*c)
      u = 0.5_wp + 1.625_wp*over
      h = sqrt(12.25_wp*over - u*u)
      e1x = u*dx + h*s
      e1y = h*dx - u*s
      e2x = e1x - dx
      e2y = e1y + s
      k = 1.0_wp/(e1x*e2y - e1y*e2x)
      w1 = rate*(s*e2x - c*e2y)*k
      w2 = rate*(s*e1x - c*e1y)*k
      gx = acceleration*c + w1*w1*e1x - w2*w2*e2x
      gy = acceleration*s + w1*w1*e1y - w2*w2*e2y
      q(:, 1) = 0.0_wp
      v(:, 1) = 0.0_wp
      a(:, 1) = 0.0_wp
      q(:, 2) = [0.0_wp, 0.0_wp, phi]
      v(:, 2) = [0.0_wp, 0.0_wp, rate]
      a(:, 2) = 0.0_wp
      q(:, 3) = [c, s, atan2(e1y, e1x)]
      v(:, 3) = [-rate*s, rate*c, w1]
      a(:, 3) = [-acceleration*c, -acceleration*s, (gx*e2x + gy*e2y)*k]
      q(:, 4) = [4.0_wp, 0.0_wp, atan2(e2y, e2x)]
      v(:, 4) = [0.0_wp, 0.0_wp, w2]
      a(:, 4) = [0.0_wp, 0.0_wp, (gx*e1x + gy*e1y)*k]
   end subroutine fast_four_bar

   !> The yoke: r = 1, l1 = 4, l2 = 2, a = 2, b = 5. The lever's angle has tan = (2 + sin phi)/cos phi, so its rate is
   !> (1 + 2 sin phi)/(5 + 4 sin phi), and that one's derivative by phi 6 cos phi/(5 + 4 sin phi)^2.
   pure subroutine fast_yoke(phi, rate, n, q, v, a)
      real(wp), intent(in) :: phi, rate
      integer, intent(in) :: n
      real(wp), intent(inout) :: q(3, n), v(3, n), a(3, n)
      real(wp) :: c, s, over, factor, lever, w, e, tx, ty, tvx, tvy, tax, tay, rise, run, wr, er, acceleration

      c = cos(phi)
      s = sin(phi)
      acceleration = rate*rate
      over = 1.0_wp/(5.0_wp + 4.0_wp*s)
      factor = 4.0_wp*sqrt(over)
      lever = atan2(2.0_wp + s, c)
      w = rate*(1.0_wp + 2.0_wp*s)*over
      e = acceleration*6.0_wp*c*over*over
      tx = factor*c
      ty = factor*(2.0_wp + s)
      tvx = -w*ty
      tvy = w*tx
      tax = -e*ty - w*w*tx
      tay = e*tx - w*w*ty
      rise = 5.0_wp - ty
      run = sqrt(4.0_wp - rise*rise)
      over = 1.0_wp/run
      wr = -tvy*over
      er = (wr*wr*rise - tay)*over
      q(:, 1) = 0.0_wp
      v(:, 1) = 0.0_wp
      a(:, 1) = 0.0_wp
      q(:, 2) = [0.0_wp, 2.0_wp, phi]
      v(:, 2) = [0.0_wp, 0.0_wp, rate]
      a(:, 2) = 0.0_wp
      q(:, 3) = [c, 2.0_wp + s, lever]
      v(:, 3) = [-rate*s, rate*c, w]
      a(:, 3) = [-acceleration*c, -acceleration*s, e]
      q(:, 4) = [0.0_wp, 0.0_wp, lever]
      v(:, 4) = [0.0_wp, 0.0_wp, w]
      a(:, 4) = [0.0_wp, 0.0_wp, e]
      q(:, 5) = [tx, ty, atan2(rise, run)]
      v(:, 5) = [tvx, tvy, wr]
      a(:, 5) = [tax, tay, er]
      q(:, 6) = [tx + run, 5.0_wp, 0.0_wp]
      v(:, 6) = [tvx - wr*rise, 0.0_wp, 0.0_wp]
      a(:, 6) = [tax - er*rise - wr*wr*run, 0.0_wp, 0.0_wp]
   end subroutine fast_yoke

   !> Andrews' squeezing mechanism in millimetres, links K1 to K7; see closed_forms_linkages.
   pure subroutine fast_andrews(phi, rate, n, q, v, a)
      real(wp), intent(in) :: phi, rate
      integer, intent(in) :: n
      real(wp), intent(inout) :: q(3, n), v(3, n), a(3, n)
      real(wp), parameter :: right = 1.5707963267948966_wp
      type(spot_t), parameter :: a0 = spot_t(-69.34_wp, -2.27_wp), b0 = spot_t(-36.35_wp, 32.73_wp)
      type(spot_t) :: o, f, e, g, h
      real(wp) :: k2(3), k3(3), k4(3), k5(3), k6(3), k7(3)

      o = spot_t()
      f = crank_end(7.0_wp, phi, rate)
      call two_rods(f, b0, 28.0_wp, 35.0_wp, 1.0_wp, e, k2, k3)
      call two_rods(e, a0, 20.0_wp, 40.0_wp, -1.0_wp, g, k4, k5)
      call two_rods(e, a0, 20.0_wp, 40.0_wp, 1.0_wp, h, k6, k7)
      k3(1) = k3(1) + right
      k4(1) = k4(1) - right
      k7(1) = k7(1) + right
      call put_link(o, [0.0_wp, 0.0_wp, 0.0_wp], q(:, 1), v(:, 1), a(:, 1))
      call put_link(o, [phi, rate, 0.0_wp], q(:, 2), v(:, 2), a(:, 2))
      call put_link(f, k2, q(:, 3), v(:, 3), a(:, 3))
      call put_link(b0, k3, q(:, 4), v(:, 4), a(:, 4))
      call put_link(e, k4, q(:, 5), v(:, 5), a(:, 5))
      call put_link(a0, k5, q(:, 6), v(:, 6), a(:, 6))
      call put_link(e, k6, q(:, 7), v(:, 7), a(:, 7))
      call put_link(a0, k7, q(:, 8), v(:, 8), a(:, 8))
   end subroutine fast_andrews

   !> Jansen's leg; see closed_forms_linkages.
   pure subroutine fast_jansen(phi, rate, n, q, v, a)
      real(wp), intent(in) :: phi, rate
      integer, intent(in) :: n
      real(wp), intent(inout) :: q(3, n), v(3, n), a(3, n)
      type(spot_t), parameter :: b0 = spot_t(-38.0_wp, -7.8_wp)
      ! The third corner W of the triangle b, d, e: along b and across it.
      real(wp), parameter :: along = (41.5_wp**2 + 40.1_wp**2 - 55.8_wp**2)/(2.0_wp*41.5_wp)
      real(wp), parameter :: across = sqrt(40.1_wp**2 - along**2)
      type(spot_t) :: o, p, x, c, w, u
      real(wp) :: rod_j(3), upper(3), rod_k(3), rod_c(3), rod_f(3), foot(3)

      o = spot_t()
      p = crank_end(15.0_wp, phi, rate)
      call two_rods(p, b0, 50.0_wp, 41.5_wp, -1.0_wp, x, rod_j, upper)
      call two_rods(p, b0, 61.9_wp, 39.3_wp, 1.0_wp, c, rod_k, rod_c)
      call turn_about(b0, upper, along, across, w)
      call two_rods(w, c, 39.4_wp, 36.7_wp, -1.0_wp, u, rod_f, foot)
      call put_link(o, [0.0_wp, 0.0_wp, 0.0_wp], q(:, 1), v(:, 1), a(:, 1))
      call put_link(o, [phi, rate, 0.0_wp], q(:, 2), v(:, 2), a(:, 2))
      call put_link(p, rod_j, q(:, 3), v(:, 3), a(:, 3))
      call put_link(b0, upper, q(:, 4), v(:, 4), a(:, 4))
      call put_link(p, rod_k, q(:, 5), v(:, 5), a(:, 5))
      call put_link(b0, rod_c, q(:, 6), v(:, 6), a(:, 6))
      call put_link(w, rod_f, q(:, 7), v(:, 7), a(:, 7))
      call put_link(c, foot, q(:, 8), v(:, 8), a(:, 8))
   end subroutine fast_jansen

   !> The tip of a crank of length `r` about (0, 0).
   pure type(spot_t) function crank_end(r, phi, rate) result(p)
      real(wp), intent(in) :: r, phi, rate

      p%x = r*cos(phi)
      p%y = r*sin(phi)
      p%vx = -rate*p%y
      p%vy = rate*p%x
      p%ax = -rate*rate*p%x
      p%ay = -rate*rate*p%y
   end function crank_end

   !> The point (xi, eta) of a link with its origin at `p` at rest; `turn`: angle, rate, second rate.
   pure subroutine turn_about(p, turn, xi, eta, c)
      type(spot_t), intent(in) :: p
      real(wp), intent(in) :: turn(3), xi, eta
      type(spot_t), intent(out) :: c
      real(wp) :: x, y

      x = xi*cos(turn(1)) - eta*sin(turn(1))
      y = xi*sin(turn(1)) + eta*cos(turn(1))
      c = spot_t(p%x + x, p%y + y, -turn(2)*y, turn(2)*x, -turn(3)*y - turn(2)**2*x, turn(3)*x - turn(2)**2*y)
   end subroutine turn_about

   !> Rods of lengths `r1` from `p` and `r2` from `s` that meet in `c`, to the left (side = 1.0) or right (-1.0) of the
   !> way from p to s; `one`, `two`: their angles (p to c, s to c), rates and second rates.
   pure subroutine two_rods(p, s, r1, r2, side, c, one, two)
      type(spot_t), intent(in) :: p, s
      real(wp), intent(in) :: r1, r2, side
      type(spot_t), intent(out) :: c
      real(wp), intent(out) :: one(3), two(3)
      real(wp) :: dx, dy, over, u, h, e1x, e1y, e2x, e2y, k, gx, gy

      dx = s%x - p%x
      dy = s%y - p%y
      over = 1.0_wp/(dx*dx + dy*dy)
      u = 0.5_wp + 0.5_wp*(r1*r1 - r2*r2)*over
      h = side*sqrt(r1*r1*over - u*u)
      e1x = u*dx - h*dy
      e1y = u*dy + h*dx
      e2x = e1x - dx
      e2y = e1y - dy
      k = 1.0_wp/(e1x*e2y - e1y*e2x)
      gx = s%vx - p%vx
      gy = s%vy - p%vy
      one(1) = atan2(e1y, e1x)
      two(1) = atan2(e2y, e2x)
      one(2) = (gx*e2x + gy*e2y)*k
      two(2) = (gx*e1x + gy*e1y)*k
      gx = s%ax - p%ax + one(2)**2*e1x - two(2)**2*e2x
      gy = s%ay - p%ay + one(2)**2*e1y - two(2)**2*e2y
      one(3) = (gx*e2x + gy*e2y)*k
      two(3) = (gx*e1x + gy*e1y)*k
      c = spot_t(p%x + e1x, p%y + e1y, p%vx - one(2)*e1y, p%vy + one(2)*e1x, &
                 p%ax - one(3)*e1y - one(2)**2*e1x, p%ay + one(3)*e1x - one(2)**2*e1y)
   end subroutine two_rods

   !> A link with its origin at `p`; `turn`: angle, rate, second rate.
   pure subroutine put_link(p, turn, q, v, a)
      type(spot_t), intent(in) :: p
      real(wp), intent(in) :: turn(3)
      real(wp), intent(inout) :: q(3), v(3), a(3)

      q = [p%x, p%y, turn(1)]
      v = [p%vx, p%vy, turn(2)]
      a = [p%ax, p%ay, turn(3)]
   end subroutine put_link
end module fast_forms
