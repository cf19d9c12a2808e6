!> The projections of a prismatic pair in a pose: on the guide's normal for eq. (9), along it for the slide.
module sliding
   use kinds, only: wp
   use pose, only: system_t, pose_t, turned
   use frozen_form, only: secants
   use revolute_pair, only: revolute_residual
   use prismatic_pair, only: tangent_gradient, frozen_gradient, projection_jacobian, projection_remainder
   implicit none
   private
   public :: closure_error, normal, along, projection_row, moving_projection

contains

   !> Point a less point b.
   pure function closure_error(s, p, a, b) result(d)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: a, b
      real(wp) :: d(2)

      d = revolute_residual(p%q(:2, s%link_of(a)), p%body_vector(:, a), p%q(:2, s%link_of(b)), p%body_vector(:, b))
   end function closure_error

   !> Normal n of the guide of pair `k`.
   pure function normal(s, p, k) result(n)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp) :: n(2), e(2)

      e = turned(s%guide(:, k), p%direction(:, s%link_of(s%pairs(k)%point_i)))
      n = [-e(2), e(1)]
   end function normal

   !> Minus the direction e of the guide of pair `k`: the slide is the projection of P - Q on it.
   pure function along(s, p, k) result(f)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp) :: f(2)

      f = -turned(s%guide(:, k), p%direction(:, s%link_of(s%pairs(k)%point_i)))
   end function along

   !> Row (6) of the projection of prismatic pair `k` on `f` (2), which points at the angle `psi`.
   pure function projection_row(s, p, k, f, psi, zeros) result(row)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      integer, intent(in) :: k
      real(wp), intent(in) :: f(2), psi, zeros(2)
      real(wp) :: row(6), g(3), d(2)

      d = closure_error(s, p, s%pairs(k)%point_i, s%pairs(k)%point_j)
      if (p%frozen) then
         g = frozen_gradient(d, f, secants(psi, zeros))
      else
         g = tangent_gradient(d, f)
      end if
      row = projection_jacobian(g, p%slope(:, s%pairs(k)%point_i), p%slope(:, s%pairs(k)%point_j))
   end function projection_row

   !> Acceleration remainder of the projection of prismatic pair `k` on `f` (2).
   pure real(wp) function moving_projection(s, p, v, k, f) result(gamma)
      type(system_t), intent(in) :: s
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: v(:, :), f(2)
      integer, intent(in) :: k
      real(wp) :: velocity(2)

      associate (a => s%pairs(k)%point_i, b => s%pairs(k)%point_j)
         associate (i => s%link_of(a), j => s%link_of(b))
            velocity = v(:2, i) - v(:2, j) &
               + v(3, i)*[-p%body_vector(2, a), p%body_vector(1, a)] - v(3, j)*[-p%body_vector(2, b), p%body_vector(1, &
               b)]
            gamma = projection_remainder(closure_error(s, p, a, b), f, velocity, &
               p%body_vector(:, a), v(3, i), p%body_vector(:, b), v(3, j))
         end associate
      end associate
   end function moving_projection
end module sliding
