!> Tests. The five dyads and the parallelogram in closed form: two links l1 and l2 on known links e and f, by pairs
!> e-l1, l1-l2 and l2-f. Plane trigonometry with jets in real128.
module dyad_forms
   use quad_jet, only: qp, jet_t, pi_q, constant_jet, operator(+), operator(-), operator(*), operator(/), sqrt, sin, &
      cos, &
      atan2
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
      integer :: l

      l = g%links(1)
      two = b(l:l + 1)
      select case (g%form)
      case (form_rrr)
         call solve_rrr(s, g, b, two, margin)
      case (form_rrp)
         call solve_rrp(s, g, b, two, margin)
      case (form_rpr)
         call solve_rpr(s, g, b, two, margin)
      case (form_prp)
         call solve_prp(s, g, b, two, margin)
      case (form_rpp)
         call solve_rpp(s, g, b, two, margin)
      end select
      if (margin%v > 0.0_qp) b(l:l + 1) = two
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

   subroutine solve_rrr(s, g, b, two, margin)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      type(body_t), intent(inout) :: two(2)
      type(jet_t), intent(out) :: margin
      type(jet_t) :: p(2), q(2), c(2), square, u, v, excess
      real(qp) :: a1(2), c1(2), c2(2), b2(2), r, t
      integer :: l

      l = g%links(1)
      associate (k => g%pairs(1))
         p = base_place(s, b, s%pairs(k), l)
         q = base_place(s, b, s%pairs(k + 2), l + 1)
         a1 = own(s, s%pairs(k), l)
         c1 = own(s, s%pairs(k + 1), l)
         c2 = own(s, s%pairs(k + 1), l + 1)
         b2 = own(s, s%pairs(k + 2), l + 1)
      end associate
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

   subroutine solve_rrp(s, g, b, two, margin)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      type(body_t), intent(inout) :: two(2)
      type(jet_t), intent(out) :: margin
      type(jet_t) :: p(2), c(2), across, along
      type(line_t) :: line
      real(qp) :: a1(2), c1(2), c2(2), r
      integer :: l

      l = g%links(1)
      associate (k => g%pairs(1))
         p = base_place(s, b, s%pairs(k), l)
         a1 = own(s, s%pairs(k), l)
         c1 = own(s, s%pairs(k + 1), l)
         c2 = own(s, s%pairs(k + 1), l + 1)
         line = guide_line(s, s%pairs(k + 2), b(other_link(s, s%pairs(k + 2), l + 1)), l + 1, c2, two(2)%phi%v)
      end associate
      r = norm2(c1 - a1)
      across = p(2)*line%c - p(1)*line%s - line%w
      margin = 1.0_qp - across*across/r**2
      if (.not. margin%v > 0.0_qp) return
      along = p(1)*line%c + p(2)*line%s + g%side*sqrt(r**2 - across*across)
      c = [along*line%c - line%w*line%s, along*line%s + line%w*line%c]
      call point_rod(two(1), p, a1, c, c1)
      call put(two(2), line%phi, c, c2)
   end subroutine solve_rrp

   subroutine solve_rpr(s, g, b, two, margin)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      type(body_t), intent(inout) :: two(2)
      type(jet_t), intent(out) :: margin
      type(jet_t) :: p(2), q(2), square, theta, turned(2)
      real(qp) :: a1(2), b2(2), angle(2), from_a, from_b, distance
      integer :: l, i

      l = g%links(1)
      associate (k => g%pairs(1), guide => s%pairs(g%pairs(1) + 1))
         p = base_place(s, b, s%pairs(k), l)
         q = base_place(s, b, s%pairs(k + 2), l + 1)
         a1 = own(s, s%pairs(k), l)
         b2 = own(s, s%pairs(k + 2), l + 1)
         ! The guide along x: the angles of both links, and the heights of their points of the guide over A and B.
         i = s%points(guide%point_i)%link - l + 1
         angle(i) = -guide%alpha*angle_unit(s)
         angle(3 - i) = angle(i) + guide%beta*angle_unit(s)
         from_a = height(own(s, guide, l) - a1, angle(1))
         from_b = height(own(s, guide, l + 1) - b2, angle(2))
         distance = from_a - from_b + merge(-guide%h, guide%h, i == 1)
      end associate
      square = (q(1) - p(1))*(q(1) - p(1)) + (q(2) - p(2))*(q(2) - p(2))
      margin = (square - distance**2)/g%scale**2
      if (.not. margin%v > 0.0_qp) return
      theta = atan2(q(2) - p(2), q(1) - p(1)) - atan2(constant_jet(distance), g%side*sqrt(square - distance**2))
      turned(1) = theta + angle(1)
      turned(1) = turned(1) + 2.0_qp*pi_q*anint((two(1)%phi%v - turned(1)%v)/(2.0_qp*pi_q))
      turned(2) = turned(1) + (angle(2) - angle(1))
      call put(two(1), turned(1), p, a1)
      call put(two(2), turned(2), q, b2)
   end subroutine solve_rpr

   subroutine solve_prp(s, g, b, two, margin)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      type(body_t), intent(inout) :: two(2)
      type(jet_t), intent(out) :: margin
      type(jet_t) :: c(2)
      type(line_t) :: line(2)
      real(qp) :: own_joint(2, 2)
      integer :: l, k, pair

      l = g%links(1)
      do k = 1, 2
         pair = g%pairs(1) + merge(0, 2, k == 1)
         own_joint(:, k) = own(s, s%pairs(g%pairs(1) + 1), l + k - 1)
         line(k) = guide_line(s, s%pairs(pair), b(other_link(s, s%pairs(pair), l + k - 1)), l + k - 1, own_joint(:, &
            k), &
            two(k)%phi%v)
      end do
      call cross(line, c, margin)
      if (.not. margin%v > 0.0_qp) return
      do k = 1, 2
         call put(two(k), line(k)%phi, c, own_joint(:, k))
      end do
   end subroutine solve_prp

   subroutine solve_rpp(s, g, b, two, margin)
      type(scheme_t), intent(in) :: s
      type(group_t), intent(in) :: g
      type(body_t), intent(in) :: b(:)
      type(body_t), intent(inout) :: two(2)
      type(jet_t), intent(out) :: margin
      type(jet_t) :: c(2), phi
      type(line_t) :: line(2)
      integer :: l

      l = g%links(1)
      associate (k => g%pairs(1), guide => s%pairs(g%pairs(1) + 1))
         line(1) = guide_line(s, s%pairs(k + 2), b(other_link(s, s%pairs(k + 2), l + 1)), l + 1, [0.0_qp, 0.0_qp], &
            two(2)%phi%v)
         phi = line(1)%phi + merge(-1.0_qp, 1.0_qp, s%points(guide%point_i)%link == l)*guide%beta*angle_unit(s)
         phi = phi + 2.0_qp*pi_q*anint((two(1)%phi%v - phi%v)/(2.0_qp*pi_q))
         call put(two(1), phi, base_place(s, b, s%pairs(k), l), own(s, s%pairs(k), l))
         line(2) = guide_line(s, guide, two(1), l + 1, [0.0_qp, 0.0_qp], two(2)%phi%v)
      end associate
      call cross(line, c, margin)
      if (margin%v > 0.0_qp) call put(two(2), line(1)%phi, c, [0.0_qp, 0.0_qp])
   end subroutine solve_rpp

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
            call point_rod(b(l + k), p, own(s, s%pairs(pair + 1), l + k), place(b(l + 1), own(s, s%pairs(pair), &
               l + 1)), &
               own(s, s%pairs(pair), l + k))
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
      line%phi = line%phi + 2.0_qp*pi_q*anint((near - line%phi%v)/(2.0_qp*pi_q))
      line%c = cos(theta)
      line%s = sin(theta)
      turned%phi = line%phi
      call set_trigonometry(turned)
      ! (P - Q) . n = h, of which the slider has P or Q.
      arm = (offset(1)*turned%s + offset(2)*turned%c)*line%c - (offset(1)*turned%c - offset(2)*turned%s)*line%s
      line%w = fixed(2)*line%c - fixed(1)*line%s + merge(pair%h, -pair%h, on_slider) + arm
   end function guide_line

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
      call put(b, phi + 2.0_qp*pi_q*anint((b%phi%v - phi%v)/(2.0_qp*pi_q)), p, u)
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
