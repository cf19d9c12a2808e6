!> Tests. The five dyads and the parallelogram in closed form: two links l1 and l2 on known links e and f, by pairs
!> e-l1, l1-l2 and l2-f. Plane trigonometry with jets in real128.
module dyad_forms
   use quad_jet, only: qp, jet_t, pi_q, constant_jet, operator(+), operator(-), operator(*), operator(/), sqrt, &
      sin, cos, atan2
   use schemes, only: scheme_t, group_t, pair_t, body_t, form_rrr, form_rrp, form_rpr, form_prp, form_rpp, angle_unit, &
      point_on, place, set_trigonometry
   implicit none
   private
   public :: solve_dyad, choose_side, place_parallelogram

   !> The line n . (x, y) = w on which a point of a slide runs, n = (-sin theta, cos theta).
   type :: line_t
      type(jet_t) :: c, s, w                   !< cosine and sine of theta
      type(jet_t) :: phi                       !< of the link that slides
   end type line_t

contains

   !> Places the two links of group `g` in `b`. `margin`: the square of the sine, or of the like, that vanishes where
   !> the dyad is singular; not above zero: it cannot be closed, and `b` is as it was.
   subroutine solve_dyad(s, g, b, margin)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(inout) :: b(:)
      type(jet_t), intent(out) :: margin
      type(body_t) :: two(2)
      type(pair_t) :: first, middle, last
      type(jet_t) :: p(2), q(2), c(2)              !< joints: on link e, on link f, between l1 and l2
      real(qp) :: a1(2), c1(2), c2(2), b2(2)       !< xi and eta: of p and c on l1, of c and q on l2
      integer :: l

      l = g%links(1)
      two = b(l:l + 1)
      first = s%pairs(g%pairs(1))
      middle = s%pairs(g%pairs(1) + 1)
      last = s%pairs(g%pairs(1) + 2)
      p = base_place(s, b, first, l)
      q = base_place(s, b, last, l + 1)
      a1 = own(s, first, l)
      c1 = own(s, middle, l)
      c2 = own(s, middle, l + 1)
      b2 = own(s, last, l + 1)
      select case (g%form)
      case (form_rrr)
         call solve_rrr()
      case (form_rrp)
         call solve_rrp()
      case (form_rpr)
         call solve_rpr()
      case (form_prp)
         call solve_prp()
      case (form_rpp)
         call solve_rpp()
      end select
      if (margin%v > 0.0_qp) b(l:l + 1) = two

   contains

      subroutine solve_rrr()
         type(jet_t) :: square, u, v, excess
         real(qp) :: r, t

         r = norm2(c1 - a1)
         t = norm2(b2 - c2)
         ! The square of the sine of the angle between the two rods.
         square = (q(1) - p(1))*(q(1) - p(1)) + (q(2) - p(2))*(q(2) - p(2))
         excess = (r**2 + t**2 - square)/(2.0_qp*r*t)
         margin = 1.0_qp - excess*excess
         if (.not. margin%v > 0.0_qp) return
         ! The corner at r from p and t from q.
         u = (square + (r**2 - t**2))/(2.0_qp*square)
         v = g%side*sqrt(r**2/square - u*u)
         c = [p(1) + (u*(q(1) - p(1)) - v*(q(2) - p(2))), p(2) + (u*(q(2) - p(2)) + v*(q(1) - p(1)))]
         call point_rod(two(1), p, a1, c, c1)
         call point_rod(two(2), c, c2, q, b2)
      end subroutine solve_rrr

      subroutine solve_rrp()
         type(line_t) :: line
         type(jet_t) :: across, along
         real(qp) :: r

         line = guide_line(s, last, b(other_link(s, last, l + 1)), l + 1, c2, two(2)%phi%v)
         r = norm2(c1 - a1)
         across = p(2)*line%c - p(1)*line%s - line%w
         margin = 1.0_qp - across*across/r**2
         if (.not. margin%v > 0.0_qp) return
         along = p(1)*line%c + p(2)*line%s + g%side*sqrt(r**2 - across*across)
         c = [along*line%c - line%w*line%s, along*line%s + line%w*line%c]
         call point_rod(two(1), p, a1, c, c1)
         call put(two(2), line%phi, c, c2)
      end subroutine solve_rrp

      subroutine solve_rpr()
         type(jet_t) :: square, theta, turned(2)
         real(qp) :: angle(2), distance
         integer :: i

         ! The guide along x: the angles of both links, and the heights of their points of the guide over A and B.
         i = s%points(middle%point_i)%link - l + 1
         angle(i) = -middle%alpha*angle_unit(s)
         angle(3 - i) = angle(i) + middle%beta*angle_unit(s)
         distance = height(c1 - a1, angle(1)) - height(c2 - b2, angle(2)) + merge(-middle%h, middle%h, i == 1)
         square = (q(1) - p(1))*(q(1) - p(1)) + (q(2) - p(2))*(q(2) - p(2))
         margin = (square - distance**2)/g%scale**2
         if (.not. margin%v > 0.0_qp) return
         theta = atan2(q(2) - p(2), q(1) - p(1)) - atan2(constant_jet(distance), g%side*sqrt(square - distance**2))
         turned(1) = without_turns(theta + angle(1), two(1)%phi%v)
         turned(2) = turned(1) + (angle(2) - angle(1))
         call put(two(1), turned(1), p, a1)
         call put(two(2), turned(2), q, b2)
      end subroutine solve_rpr

      subroutine solve_prp()
         type(line_t) :: line(2)

         line(1) = guide_line(s, first, b(other_link(s, first, l)), l, c1, two(1)%phi%v)
         line(2) = guide_line(s, last, b(other_link(s, last, l + 1)), l + 1, c2, two(2)%phi%v)
         call cross(line, c, margin)
         if (.not. margin%v > 0.0_qp) return
         call put(two(1), line(1)%phi, c, c1)
         call put(two(2), line(2)%phi, c, c2)
      end subroutine solve_prp

      subroutine solve_rpp()
         type(line_t) :: line(2)
         real(qp), parameter :: origin(2) = 0.0_qp
         type(jet_t) :: phi

         line(1) = guide_line(s, last, b(other_link(s, last, l + 1)), l + 1, origin, two(2)%phi%v)
         phi = line(1)%phi + merge(-1.0_qp, 1.0_qp, s%points(middle%point_i)%link == l)*middle%beta*angle_unit(s)
         call put(two(1), without_turns(phi, two(1)%phi%v), p, a1)
         line(2) = guide_line(s, middle, two(1), l + 1, origin, two(2)%phi%v)
         call cross(line, c, margin)
         if (margin%v > 0.0_qp) call put(two(2), line(1)%phi, c, origin)
      end subroutine solve_rpp
   end subroutine solve_dyad

   !> The sign of the assembly in `s%links%at`, with all bodies of `b` there.
   subroutine choose_side(s, g, b)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(inout) :: g
      type(body_t), intent(in) :: b(:)
      type(body_t) :: trial(size(b))
      type(jet_t) :: margin
      real(qp) :: off(2)
      integer :: k, l

      l = g%links(1)
      do k = 1, 2
         g%side = merge(1.0_qp, -1.0_qp, k == 1)
         trial = b
         call solve_dyad(s, g, trial, margin)
         off(k) = maxval(abs([trial(l:l + 1)%x%v - b(l:l + 1)%x%v, trial(l:l + 1)%y%v - b(l:l + 1)%y%v]))/g%scale &
            + sum(abs(sin(0.5_qp*(trial(l:l + 1)%phi%v - b(l:l + 1)%phi%v))))
      end do
      g%side = merge(1.0_qp, -1.0_qp, off(1) < off(2))
   end subroutine choose_side

   !> A parallelogram with bars 1 and 2 and coupler, which stays parallel to its base, or the antiparallelogram: the
   !> coupler's far joint is mirrored in the line from bar 1's joint to bar 2's pivot. More bars go along with bar 1.
   subroutine place_parallelogram(s, g, b, phi, crossed, sine)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(inout) :: b(:)
      type(jet_t), intent(in) :: phi           !< of bar 1
      logical, intent(in) :: crossed           !< the antiparallelogram
      type(jet_t), intent(out) :: sine         !< of the angle between bar 1 and its base line
      type(jet_t) :: p(2), q(2), a(2), c(2), d(2), across
      real(qp) :: along(2)
      integer :: l, k, pair

      ! Pairs: base-bar 1, bar 1-coupler, coupler-bar 2, bar 2-base, and two for each further bar, coupler first.
      l = g%links(1)
      associate (first => g%pairs(1))
         p = base_place(s, b, s%pairs(first), l)
         q = base_place(s, b, s%pairs(first + 3), l + 2)
         call put(b(l), phi, p, own(s, s%pairs(first), l))
         a = place(b(l), own(s, s%pairs(first + 1), l))
         d = [a(1) + (q(1) - p(1)), a(2) + (q(2) - p(2))]
         sine = ((a(2) - p(2))*(q(1) - p(1)) - (a(1) - p(1))*(q(2) - p(2)))/(norm2(own(s, s%pairs(first), l) &
            - own(s, s%pairs(first + 1), l))*sqrt((q(1) - p(1))*(q(1) - p(1)) + (q(2) - p(2))*(q(2) - p(2))))
         if (crossed) then
            c = [q(1) - a(1), q(2) - a(2)]
            across = 2.0_qp*(c(1)*(d(2) - a(2)) - c(2)*(d(1) - a(1)))/(c(1)*c(1) + c(2)*c(2))
            d = [d(1) + across*c(2), d(2) - across*c(1)]
         end if
         along = own(s, s%pairs(first + 2), l + 1)
         call point_rod(b(l + 1), a, own(s, s%pairs(first + 1), l + 1), d, along)
         call point_rod(b(l + 2), q, own(s, s%pairs(first + 3), l + 2), d, own(s, s%pairs(first + 2), l + 2))
         do k = 3, g%links(2) - l
            pair = first + 2*k - 2
            p = base_place(s, b, s%pairs(pair + 1), l + k)
            call point_rod(b(l + k), p, own(s, s%pairs(pair + 1), l + k), &
               place(b(l + 1), own(s, s%pairs(pair), l + 1)), own(s, s%pairs(pair), l + k))
         end do
      end associate
   end subroutine place_parallelogram

   !> The link of `pair` that is not `link`.
   pure integer function other_link(s, pair, link)
      type(scheme_t), intent(in) :: s
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: link

      other_link = s%points(pair%point_i)%link
      if (other_link == link) other_link = s%points(pair%point_j)%link
   end function other_link

   !> The place of the joint of `pair` on the known link that it joins to `link`.
   pure function base_place(s, b, pair, link) result(p)
      type(scheme_t), intent(in) :: s
      type(body_t), intent(in) :: b(:)
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: link
      type(jet_t) :: p(2)
      integer :: base

      base = other_link(s, pair, link)
      p = place(b(base), s%points(point_on(s, pair, base))%offset)
   end function base_place

   !> xi and eta of the point of `pair` on `link`.
   pure function own(s, pair, link) result(offset)
      type(scheme_t), intent(in) :: s
      type(pair_t), intent(in) :: pair
      integer, intent(in) :: link
      real(qp) :: offset(2)

      offset = s%points(point_on(s, pair, link))%offset
   end function own

   !> The second coordinate of `u` turned by `angle`.
   pure real(qp) function height(u, angle)
      real(qp), intent(in) :: u(2), angle

      height = u(1)*sin(angle) + u(2)*cos(angle)
   end function height

   !> The line of the point `u` of the link `slider`, which the prismatic `pair` joins to the known body `known`;
   !> `near`: its angle is counted in turns from here.
   function guide_line(s, pair, known, slider, u, near) result(line)
      type(scheme_t), intent(in) :: s
      type(pair_t), intent(in) :: pair
      type(body_t), intent(in) :: known
      integer, intent(in) :: slider
      real(qp), intent(in) :: u(2), near
      type(line_t) :: line
      type(jet_t) :: theta, fixed(2), arm
      type(body_t) :: turned
      real(qp) :: offset(2)
      logical :: on_slider

      on_slider = s%points(pair%point_i)%link == slider
      offset = u - own(s, pair, slider)
      if (on_slider) then
         line%phi = known%phi - pair%beta*angle_unit(s)
         theta = line%phi + pair%alpha*angle_unit(s)
         fixed = place(known, s%points(pair%point_j)%offset)
      else
         line%phi = known%phi + pair%beta*angle_unit(s)
         theta = known%phi + pair%alpha*angle_unit(s)
         fixed = place(known, s%points(pair%point_i)%offset)
      end if
      line%phi = without_turns(line%phi, near)
      line%c = cos(theta)
      line%s = sin(theta)
      turned%phi = line%phi
      call set_trigonometry(turned)
      ! (P - Q) . n = h, of which the slider has P or Q.
      arm = (offset(1)*turned%s + offset(2)*turned%c)*line%c - (offset(1)*turned%c - offset(2)*turned%s)*line%s
      line%w = fixed(2)*line%c - fixed(1)*line%s + merge(pair%h, -pair%h, on_slider) + arm
   end function guide_line

   !> `phi` less or more whole turns, so that it is next to `near`.
   pure type(jet_t) function without_turns(phi, near)
      type(jet_t), intent(in) :: phi
      real(qp), intent(in) :: near

      without_turns = phi + 2.0_qp*pi_q*anint((near - phi%v)/(2.0_qp*pi_q))
   end function without_turns

   !> Where two lines cross; `margin`: the square of the sine of their angle.
   subroutine cross(line, c, margin)
      type(line_t), intent(in) :: line(2)
      type(jet_t), intent(out) :: c(2), margin
      type(jet_t) :: sine

      sine = line(1)%c*line(2)%s - line(1)%s*line(2)%c
      margin = sine*sine
      if (.not. margin%v > 0.0_qp) return
      c(1) = (line(1)%w*line(2)%c - line(2)%w*line(1)%c)/sine
      c(2) = (line(1)%w*line(2)%s - line(2)%w*line(1)%s)/sine
   end subroutine cross

   !> The link whose points `u` and `v` lie at `p` and `q`, by turns as it was.
   subroutine point_rod(b, p, u, q, v)
      type(body_t), intent(inout) :: b
      type(jet_t), intent(in) :: p(2), q(2)
      real(qp), intent(in) :: u(2), v(2)
      type(jet_t) :: phi

      phi = atan2(q(2) - p(2), q(1) - p(1)) - atan2(v(2) - u(2), v(1) - u(1))
      call put(b, without_turns(phi, b%phi%v), p, u)
   end subroutine point_rod

   !> The link at the angle `phi` whose point `u` lies at `p`.
   subroutine put(b, phi, p, u)
      type(body_t), intent(inout) :: b
      type(jet_t), intent(in) :: phi, p(2)
      real(qp), intent(in) :: u(2)

      b%phi = phi
      call set_trigonometry(b)
      b%x = p(1) - (u(1)*b%c - u(2)*b%s)
      b%y = p(2) - (u(1)*b%s + u(2)*b%c)
   end subroutine put
end module dyad_forms
