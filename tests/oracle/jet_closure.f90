!> Tests. The closure equations with their first and second derivatives by time, in real128, for a motion that is given;
!> and what rounding in double precision may leave of them.
module jet_closure
   use quad_jet, only: qp, jet_t, sin, cos, operator(+), operator(-), operator(*)
   use mechanism, only: mechanism_t, pair_revolute, pair_prismatic, drive_angle, drive_x, drive_relangle, drive_slide
   use scales, only: characteristic_length
   use jet_drives, only: drive_jet, drive_sizes
   implicit none
   private
   public :: body_jet_t, closure_jets, place_jet, slide_jet, sizes_t, sizes_of, row_sizes

   real(qp), parameter :: many_roundings = 16.0_qp

   type :: body_jet_t
      type(jet_t) :: x, y, phi
   end type body_jet_t

   !> Sizes of the numbers that positions, velocities and accelerations are added up from: of lengths and of angles.
   type :: sizes_t
      real(qp) :: length(0:2) = 0.0_qp, angle(0:2) = 0.0_qp
   end type sizes_t

contains

   !> Residuals, two of every pair and one of every drive, of the motion `b` (links) at the time `t`.
   function closure_jets(m, b, t) result(r)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      real(qp), intent(in) :: t
      type(jet_t) :: r(2*size(m%pairs) + size(m%drives)), p(2), q(2), theta
      integer :: k

      do k = 1, size(m%pairs)
         associate (pair => m%pairs(k))
            associate (i => m%points(pair%point_i)%link, j => m%points(pair%point_j)%link)
               p = place_jet(m, b, pair%point_i)
               q = place_jet(m, b, pair%point_j)
               if (pair%kind == pair_revolute) then
                  r(2*k - 1) = p(1) - q(1)
                  r(2*k) = p(2) - q(2)
               else
                  theta = b(i)%phi + real(pair%alpha, qp)
                  r(2*k - 1) = cos(theta)*(p(2) - q(2)) - sin(theta)*(p(1) - q(1)) - real(pair%offset, qp)
                  r(2*k) = b(j)%phi - b(i)%phi - real(pair%beta, qp)
               end if
            end associate
         end associate
      end do
      do k = 1, size(m%drives)
         r(2*size(m%pairs) + k) = driven_jet(m, b, k) - drive_jet(m%drives(k), t)
      end do
   end function closure_jets

   function driven_jet(m, b, k) result(s)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      integer, intent(in) :: k
      type(jet_t) :: s, p(2)

      associate (subject => m%drives(k)%subject)
         select case (m%drives(k)%kind)
         case (drive_angle)
            s = b(subject)%phi
         case (drive_relangle)
            s = b(m%drives(k)%second)%phi - b(subject)%phi
         case (drive_slide)
            s = slide_jet(m, b, subject)
         case default
            p = place_jet(m, b, subject)
            s = p(merge(1, 2, m%drives(k)%kind == drive_x))
         end select
      end associate
   end function driven_jet

   !> The slide of prismatic pair `k`: (Q - P) . (cos theta, sin theta).
   function slide_jet(m, b, k) result(s)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      integer, intent(in) :: k
      type(jet_t) :: s, p(2), q(2), theta

      p = place_jet(m, b, m%pairs(k)%point_i)
      q = place_jet(m, b, m%pairs(k)%point_j)
      theta = b(m%points(m%pairs(k)%point_i)%link)%phi + real(m%pairs(k)%alpha, qp)
      s = (q(1) - p(1))*cos(theta) + (q(2) - p(2))*sin(theta)
   end function slide_jet

   !> Place (2) of point number `k`.
   function place_jet(m, b, k) result(p)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      integer, intent(in) :: k
      type(jet_t) :: p(2), c, s
      real(qp) :: u(2)

      u = m%points(k)%offset
      associate (link => b(m%points(k)%link))
         c = cos(link%phi)
         s = sin(link%phi)
         p(1) = link%x + u(1)*c - u(2)*s
         p(2) = link%y + u(1)*s + u(2)*c
      end associate
   end function place_jet

   !> Sizes of the motion `b` of mechanism `m`. An angle is known to one part in 2**53 of itself, a direction no
   !> better, so
   !> that arms count times 1 + |phi|; a velocity turns with every angular velocity, an acceleration likewise. One
   !> linear
   !> solve gives lengths and angles: what rounding leaves in one, over the longest arm, it may leave in the other. The
   !> characteristic length counts as an arm: all coordinates may be zero, and lengths are computed in units of it.
   function sizes_of(m, b) result(s)
      type(mechanism_t), intent(in) :: m
      type(body_jet_t), intent(in) :: b(:)
      type(sizes_t) :: s
      real(qp) :: turn, body_vector
      integer :: i

      s%angle = [1.0_qp + maxval(abs(b%phi%v)), maxval(abs(b%phi%d)), maxval(abs(b%phi%dd))]
      turn = s%angle(0)
      body_vector = characteristic_length(m)
      do i = 1, size(m%points)
         body_vector = max(body_vector, maxval(abs(real(m%points(i)%offset, qp))))
      end do
      do i = 1, size(m%pairs)
         if (m%pairs(i)%kind == pair_prismatic) body_vector = max(body_vector, abs(real(m%pairs(i)%offset, qp)))
         if (m%pairs(i)%kind == pair_prismatic) turn = max(turn, 1.0_qp + abs(real(m%pairs(i)%alpha, qp)))
      end do
      s%length(0) = max(maxval(abs(b%x%v)), maxval(abs(b%y%v))) + body_vector*turn
      s%length(1) = max(maxval(abs(b%x%d)), maxval(abs(b%y%d)))*turn + s%length(0)*s%angle(1)
      s%length(2) = max(maxval(abs(b%x%dd)), maxval(abs(b%y%dd)))*turn + s%length(1)*s%angle(1) &
         + s%length(0)*(s%angle(2) + s%angle(1)**2)
      if (body_vector > 0.0_qp) s%angle = s%angle + s%length/body_vector
   end function sizes_of

   !> Sizes (0:2, equations) of the numbers in each equation and its derivatives.
   function row_sizes(m, s, t) result(rows)
      type(mechanism_t), intent(in) :: m
      type(sizes_t), intent(in) :: s
      real(qp), intent(in) :: t
      real(qp) :: rows(0:2, 2*size(m%pairs) + size(m%drives))
      integer :: k

      do k = 1, size(m%pairs)
         rows(:, 2*k - 1) = s%length
         ! Arms of many turns: 64 roundings of a length are one of the angle in its direction.
         rows(0, 2*k - 1) = s%length(0)*max(1.0_qp, s%angle(0)/many_roundings)
         rows(:, 2*k) = rows(:, 2*k - 1)
         if (m%pairs(k)%kind /= pair_prismatic) cycle
         rows(:, 2*k) = s%angle
         rows(0, 2*k) = max(rows(0, 2*k), abs(real(m%pairs(k)%beta, qp)))
      end do
      do k = 1, size(m%drives)
         associate (row => rows(:, 2*size(m%pairs) + k))
            row = s%length
            if (any(m%drives(k)%kind == [drive_angle, drive_relangle])) row = s%angle
            row = row + drive_sizes(m%drives(k), t)
         end associate
      end do
   end function row_sizes
end module jet_closure
