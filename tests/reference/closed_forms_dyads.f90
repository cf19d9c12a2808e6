!> Tests. The words in which the closed forms are written: points, links and dyads, as jets in real128. Every formula is
!> plane trigonometry; none of the program's equations or solvers is used.
module closed_forms_dyads
   use quad_jet, only: qp, jet_t, constant_jet, operator(+), operator(-), operator(*), operator(/), sqrt, sin, cos, &
      atan2
   implicit none
   private
   public :: place_t, body_t, flat, origin, base, fixed_place, body, motion_of, place_on, seen_from, polar, direction, &
      distance_squared, third_corner, corner, mirrored, swapped, on_line, four_bar_links, bars, slider_crank, &
      drawn_link, &
      natural_spline_3

   !> A point of the plane.
   type :: place_t
      type(jet_t) :: x, y
   end type place_t

   !> A link by its name in the deck: the origin of its axes and their angle (radians).
   type :: body_t
      type(jet_t) :: x, y, phi
      character(8) :: name = ''
   end type body_t

   !> What stays 0, the origin of the plane's axes, and the ground that is drawn there.
   type(jet_t), parameter :: flat = jet_t(0.0_qp, 0.0_qp, 0.0_qp)
   type(place_t), parameter :: origin = place_t(flat, flat)
   type(body_t), parameter :: base = body_t(flat, flat, flat, 'BASE')

contains

   !> The point (x, y) of the ground.
   pure type(place_t) function fixed_place(x, y) result(p)
      real(qp), intent(in) :: x, y

      p = place_t(constant_jet(x), constant_jet(y))
   end function fixed_place

   !> The link `name` with the origin of its axes at `p` and its axes at `phi`.
   pure type(body_t) function body(name, p, phi) result(b)
      character(*), intent(in) :: name
      type(place_t), intent(in) :: p
      type(jet_t), intent(in) :: phi

      b = body_t(p%x, p%y, phi, name)
   end function body

   !> x, y, phi of a link and their derivatives (3, 0:2).
   pure function motion_of(b) result(motion)
      type(body_t), intent(in) :: b
      real(qp) :: motion(3, 0:2)

      motion(:, 0) = [b%x%v, b%y%v, b%phi%v]
      motion(:, 1) = [b%x%d, b%y%d, b%phi%d]
      motion(:, 2) = [b%x%dd, b%y%dd, b%phi%dd]
   end function motion_of

   !> The point (xi, eta) of a link.
   pure type(place_t) function place_on(b, xi, eta) result(p)
      type(body_t), intent(in) :: b
      real(qp), intent(in) :: xi, eta

      p%x = b%x + xi*cos(b%phi) - eta*sin(b%phi)
      p%y = b%y + xi*sin(b%phi) + eta*cos(b%phi)
   end function place_on

   !> The point `p` of the plane in the axes of a link.
   pure type(place_t) function seen_from(b, p) result(q)
      type(body_t), intent(in) :: b
      type(place_t), intent(in) :: p

      q%x = (p%x - b%x)*cos(b%phi) + (p%y - b%y)*sin(b%phi)
      q%y = (p%y - b%y)*cos(b%phi) - (p%x - b%x)*sin(b%phi)
   end function seen_from

   !> The point at the distance `length` from `p` in the direction `phi`.
   pure type(place_t) function polar(p, length, phi) result(q)
      type(place_t), intent(in) :: p
      real(qp), intent(in) :: length
      type(jet_t), intent(in) :: phi

      q = place_t(p%x + length*cos(phi), p%y + length*sin(phi))
   end function polar

   !> The direction from `p` to `q`, in (-pi, pi].
   pure type(jet_t) function direction(p, q) result(phi)
      type(place_t), intent(in) :: p, q

      phi = atan2(q%y - p%y, q%x - p%x)
   end function direction

   !> The corner C of the triangle A B C with the squares of AC and BC given; `side` is +1.0 when C lies to
   !> the left of the way from A to B, -1.0 to the right. From |C - A|^2 and |C - B|^2 with C = A + u AB + v n:
   !> u = (AB^2 + AC^2 - BC^2)/(2 AB^2), v^2 = AC^2/AB^2 - u^2, n = AB turned by a right angle.
   pure type(place_t) function third_corner(a, b, ac_squared, bc_squared, side) result(c)
      type(place_t), intent(in) :: a, b
      type(jet_t), intent(in) :: ac_squared, bc_squared
      real(qp), intent(in) :: side
      type(jet_t) :: dx, dy, square, u, v

      dx = b%x - a%x
      dy = b%y - a%y
      square = dx*dx + dy*dy
      u = (square + ac_squared - bc_squared)/(2.0_qp*square)
      v = side*sqrt(ac_squared/square - u*u)
      c = place_t(a%x + u*dx - v*dy, a%y + u*dy + v*dx)
   end function third_corner

   !> Where a rod of length `r` from `p` and one of length `s` from `q` meet; `side` as in third_corner.
   pure type(place_t) function corner(p, r, q, s, side)
      type(place_t), intent(in) :: p, q
      real(qp), intent(in) :: r, s, side

      corner = third_corner(p, q, constant_jet(r**2), constant_jet(s**2), side)
   end function corner

   pure type(jet_t) function distance_squared(p, q) result(square)
      type(place_t), intent(in) :: p, q

      square = (q%x - p%x)*(q%x - p%x) + (q%y - p%y)*(q%y - p%y)
   end function distance_squared

   !> The mirror image of `p` in the line from `a` to `b`: p less twice its distance from the line. It has no square
   !> root, so it passes where the triangle a b p is flat.
   pure type(place_t) function mirrored(p, a, b) result(q)
      type(place_t), intent(in) :: p, a, b
      type(jet_t) :: dx, dy, across

      dx = b%x - a%x
      dy = b%y - a%y
      across = 2.0_qp*(dx*(p%y - a%y) - dy*(p%x - a%x))/(dx*dx + dy*dy)
      q = place_t(p%x + across*dy, p%y - across*dx)
   end function mirrored

   !> The fourth corner of an antiparallelogram: the symmetry that changes `a` and `b` for one another changes `p` for
   !> it. A mirror whose normal runs from a to b, through their middle; no square root.
   pure type(place_t) function swapped(p, a, b) result(q)
      type(place_t), intent(in) :: p, a, b
      type(jet_t) :: dx, dy, along

      dx = b%x - a%x
      dy = b%y - a%y
      along = ((2.0_qp*p%x - a%x - b%x)*dx + (2.0_qp*p%y - a%y - b%y)*dy)/(dx*dx + dy*dy)
      q = place_t(p%x - along*dx, p%y - along*dy)
   end function swapped

   !> The far end of a rod of `length` from `p` to the line through `o` in the direction `phi`: `side` +1.0 for the end
   !> farther on in that direction, -1.0 for the other.
   pure type(place_t) function on_line(p, length, o, phi, side) result(q)
      type(place_t), intent(in) :: p, o
      real(qp), intent(in) :: length, side
      type(jet_t), intent(in) :: phi
      type(place_t) :: seen
      type(jet_t) :: along

      seen = seen_from(body('', o, phi), p)
      along = seen%x + side*sqrt(length**2 - seen%y*seen%y)
      q = place_t(o%x + along*cos(phi), o%y + along*sin(phi))
   end function on_line

   !> A four-bar on a base along the x axis with its crank at `phi`: `lengths` of crank, coupler, rocker and base;
   !> `side` as in third_corner, seen from the crank's pin to the foot of the rocker.
   pure function four_bar_links(phi, lengths, side) result(links)
      type(jet_t), intent(in) :: phi
      real(qp), intent(in) :: lengths(4), side
      type(body_t) :: links(4)
      type(place_t) :: a, b0

      a = polar(origin, lengths(1), phi)
      b0 = fixed_place(lengths(4), 0.0_qp)
      links = bars(phi, a, corner(a, lengths(2), b0, lengths(3), side), b0)
   end function four_bar_links

   !> The links of a four-bar with the joints (0, 0), `a`, `b` and `b0`, the crank at `phi`.
   pure function bars(phi, a, b, b0) result(links)
      type(jet_t), intent(in) :: phi
      type(place_t), intent(in) :: a, b, b0
      type(body_t) :: links(4)

      links = [base, body('CRANK', origin, phi), body('COUPLER', a, direction(a, b)), &
               body('ROCKER', b0, direction(b0, b))]
   end function bars

   !> A crank about (0, 0) at `phi`, a rod and a piston on the line through `o` in the direction `slope`, along which
   !> its axes lie; `lengths` of crank and rod. The piston is at the far end of the rod.
   pure function slider_crank(phi, lengths, o, slope) result(links)
      type(jet_t), intent(in) :: phi, slope
      real(qp), intent(in) :: lengths(2)
      type(place_t), intent(in) :: o
      type(body_t) :: links(4)
      type(place_t) :: pin, piston

      pin = polar(origin, lengths(1), phi)
      piston = on_line(pin, lengths(2), o, slope, 1.0_qp)
      links = [base, body('CRANK', origin, phi), body('ROD', pin, direction(pin, piston)), &
               body('PISTON', piston, slope)]
   end function slider_crank

   !> The link `name` with the points `p` and `q`, which are drawn at `p_drawn` and `q_drawn`, as the origin of its axes
   !> is drawn at `at`; the axes are parallel to those of the drawing.
   pure type(body_t) function drawn_link(name, p, q, p_drawn, q_drawn, at) result(link)
      character(*), intent(in) :: name
      type(place_t), intent(in) :: p, q
      real(qp), intent(in) :: p_drawn(2), q_drawn(2), at(2)
      real(qp) :: drawn_direction

      drawn_direction = atan2(q_drawn(2) - p_drawn(2), q_drawn(1) - p_drawn(1))
      link = body(name, p, direction(p, q) - drawn_direction)
      link = body(name, place_on(link, at(1) - p_drawn(1), at(2) - p_drawn(2)), link%phi)
   end function drawn_link

   !> The natural cubic spline through (0, y0), (h, y1), (2h, y2). Its second derivative is 0 at the ends and
   !> m = 3 (y0 - 2 y1 + y2)/(2 h^2) in the middle, from the one equation (h/6)(0 + 4m + 0) = (y0 - 2 y1 + y2)/h.
   pure type(jet_t) function natural_spline_3(h, y, t) result(s)
      real(qp), intent(in) :: h, y(0:2)
      type(jet_t), intent(in) :: t
      real(qp) :: m
      type(jet_t) :: u

      m = 1.5_qp*(y(0) - 2.0_qp*y(1) + y(2))/h**2
      if (t%v <= h) then
         u = t
         s = y(0) + (y(1) - y(0))/h*u + m/(6.0_qp*h)*(u*u*u - h**2*u)
      else
         u = 2.0_qp*h - t
         s = y(2) + (y(1) - y(2))/h*u + m/(6.0_qp*h)*(u*u*u - h**2*u)
      end if
   end function natural_spline_3
end module closed_forms_dyads
