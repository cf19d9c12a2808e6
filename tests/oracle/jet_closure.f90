!> Tests. The closure equations once more, in real128, with their first and second derivatives by time for a motion that
!> is given. Two of every pair, (7), (8) or (9), (10), in the program's order, then one of every drive. All numbers of
!> the deck are real128, so that each can be changed by less than a double can tell.
module jet_closure
   use quad_jet, only: qp, jet_t, constant_jet, sin, cos, operator(+), operator(-), operator(*)
   use closed_forms_dyads, only: body_jet_t => body_t
   use mechanism, only: mechanism_t, pair_revolute, drive_angle, drive_x, drive_relangle, drive_slide
   implicit none
   private
   public :: body_jet_t, numbers_of, set_grounds, closure_jets, place_jet, slide_jet
   public :: closure, closure_slopes, at_rest

contains

   !> The numbers of the deck that place anything: three of a link (those of moving ones are estimates and count as
   !> zero), two of a point, three of a pair, one after another.
   function numbers_of(m) result(d)
      type(mechanism_t), intent(in) :: m
      real(qp), allocatable :: d(:)
      integer :: i, n

      allocate (d(3*size(m%links) + 2*size(m%points) + 3*size(m%pairs)), source=0.0_qp)
      do i = 1, size(m%links)
         if (m%links(i)%ground) d(3*i - 2:3*i) = m%links(i)%position
      end do
      n = 3*size(m%links)
      do i = 1, size(m%points)
         d(n + 2*i - 1:n + 2*i) = m%points(i)%offset
      end do
      n = n + 2*size(m%points)
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_revolute) cycle
         d(n + 3*i - 2:n + 3*i) = [m%pairs(i)%alpha, m%pairs(i)%offset, m%pairs(i)%beta]
      end do
   end function numbers_of

   !> Puts the ground links where the numbers `d` say.
   subroutine set_grounds(m, d, b)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(inout) :: b(:)
      integer :: i

      do i = 1, size(b)
         if (m%links(i)%ground) b(i) = body_jet_t(constant_jet(d(3*i - 2)), constant_jet(d(3*i - 1)), &
            constant_jet(d(3*i)))
      end do
   end subroutine set_grounds

   !> Residuals for the deck's numbers `d` and the motion `b` (links), the drives asking for `f`.
   function closure_jets(m, d, b, f) result(r)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      type(jet_t), intent(in) :: f(:)
      type(jet_t) :: r(2*size(m%pairs) + size(m%drives)), place(2, size(m%points)), e(2), apart(2)
      integer :: k, n

      do k = 1, size(m%points)
         place(:, k) = place_jet(m, d, b, k)
      end do
      n = 3*size(m%links) + 2*size(m%points)
      do k = 1, size(m%pairs)
         associate (p => m%pairs(k)%point_i, q => m%pairs(k)%point_j)
            apart = place(:, p) - place(:, q)
            if (m%pairs(k)%kind == pair_revolute) then
               r(2*k - 1:2*k) = apart
            else
               e = guide(m, d, b, k)
               r(2*k - 1) = e(1)*apart(2) - e(2)*apart(1) - d(n + 3*k - 1)
               r(2*k) = b(m%points(q)%link)%phi - b(m%points(p)%link)%phi - d(n + 3*k)
            end if
         end associate
      end do
      do k = 1, size(m%drives)
         r(2*size(m%pairs) + k) = driven(m, d, b, place, k) - f(k)
      end do
   end function closure_jets

   !> The coordinate that drive `k` moves.
   type(jet_t) function driven(m, d, b, place, k) result(s)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      type(jet_t), intent(in) :: place(:, :)
      integer, intent(in) :: k

      associate (subject => m%drives(k)%subject)
         select case (m%drives(k)%kind)
         case (drive_angle)
            s = b(subject)%phi
         case (drive_relangle)
            s = b(m%drives(k)%second)%phi - b(subject)%phi
         case (drive_slide)
            s = slide_jet(m, d, b, subject)
         case default
            s = place(merge(1, 2, m%drives(k)%kind == drive_x), subject)
         end select
      end associate
   end function driven

   !> The slide of prismatic pair `k`: (Q - P) . (cos theta, sin theta).
   type(jet_t) function slide_jet(m, d, b, k) result(s)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      integer, intent(in) :: k
      type(jet_t) :: apart(2), e(2)

      apart = place_jet(m, d, b, m%pairs(k)%point_j) - place_jet(m, d, b, m%pairs(k)%point_i)
      e = guide(m, d, b, k)
      s = e(1)*apart(1) + e(2)*apart(2)
   end function slide_jet

   !> The direction of the guide of prismatic pair `k`.
   function guide(m, d, b, k) result(e)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      integer, intent(in) :: k
      type(jet_t) :: e(2), theta

      theta = b(m%points(m%pairs(k)%point_i)%link)%phi + d(3*size(m%links) + 2*size(m%points) + 3*k - 2)
      e(1) = cos(theta)
      e(2) = sin(theta)
   end function guide

   !> Place (2) of point number `k`.
   function place_jet(m, d, b, k) result(p)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      integer, intent(in) :: k
      type(jet_t) :: p(2), c, s

      associate (link => b(m%points(k)%link), u => d(3*size(m%links) + 2*k - 1), w => d(3*size(m%links) + 2*k))
         c = cos(link%phi)
         s = sin(link%phi)
         p(1) = link%x + u*c - w*s
         p(2) = link%y + u*s + w*c
      end associate
   end function place_jet

   !> Residuals of all equations at the positions `q` (3, links) with the drives at `f` (drives).
   function closure(m, q, f) result(r)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: q(:, :), f(:)
      real(qp) :: r(2*size(m%pairs) + size(m%drives))
      type(jet_t) :: jets(size(r))

      jets = closure_jets(m, numbers_of(m), at_rest(q), constant_jet(f))
      r = jets%v
   end function closure

   !> Derivatives (equations, unknowns) of the residuals by x, y, phi of every moving link, in order, where the links
   !> are at `b`: column by column from unit velocities.
   function closure_slopes(m, d, b) result(slopes)
      type(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: d(:)
      type(body_jet_t), intent(in) :: b(:)
      real(qp) :: slopes(2*size(m%pairs) + size(m%drives), 3*count(.not. m%links%ground))
      type(body_jet_t) :: still(size(b)), moving(size(b))
      type(jet_t) :: r(size(slopes, 1)), held(size(m%drives))
      integer :: link, i, column

      still = at_rest(reshape([b%x%v, b%y%v, b%phi%v], [3, size(b)], order=[2, 1]))
      column = 0
      do link = 1, size(b)
         if (m%links(link)%ground) cycle
         do i = 1, 3
            moving = still
            if (i == 1) moving(link)%x%d = 1.0_qp
            if (i == 2) moving(link)%y%d = 1.0_qp
            if (i == 3) moving(link)%phi%d = 1.0_qp
            r = closure_jets(m, d, moving, held)
            column = column + 1
            slopes(:, column) = r%d
         end do
      end do
   end function closure_slopes

   !> The links at the positions `q` (3, links), at rest.
   pure function at_rest(q) result(b)
      real(qp), intent(in) :: q(:, :)
      type(body_jet_t) :: b(size(q, 2))

      b%x = constant_jet(q(1, :))
      b%y = constant_jet(q(2, :))
      b%phi = constant_jet(q(3, :))
   end function at_rest
end module jet_closure
