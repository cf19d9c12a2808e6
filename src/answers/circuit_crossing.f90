!> Another circuit through a change point: there the equations' Jacobian with the tangent t as one more row has a left
!> null vector w and a right one k, and directions x = a t + b k of curves satisfy w . F_qq[x, x] = 0, of second degree
!> in a/b; t is one of them.
module circuit_crossing
   use kinds, only: wp
   use linear_solver, only: solve, solve_transposed
   use pose, only: add_to_links
   use curve_equations, only: curve_t, move_to, factor_with, second_derivative
   use circuit_curve, only: curve_point_t, find_point
   use circuit_trace, only: change_point_t
   implicit none
   private
   public :: other_circuit

   !> So far from the change point the other circuit is looked for, in rad and lengths; there it is off its tangent by
   !> less than this part of the distance.
   real(wp), parameter :: aside = 1.0e-3_wp, straight = 0.1_wp
   !> A coefficient is zero below this part of the others: the null vectors are known to the root of the rounding.
   real(wp), parameter :: zero = epsilon(1.0_wp)**0.25_wp

contains

   !> The point `p` of the other circuit through `change` of the curve `c`; `before`: the point of the circuit before
   !> it. `ok`: there is one.
   subroutine other_circuit(c, before, change, p, ok)
      type(curve_t), intent(inout) :: c
      type(curve_point_t), intent(in) :: before
      type(change_point_t), intent(in) :: change
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok
      real(wp), dimension(c%closure%n) :: w, k, x, f_t, f_k, f_sum
      real(wp) :: mixed, along_k, q(3, size(change%q, 2))

      call null_vectors(c, before, w, k, ok)
      if (.not. ok) return
      associate (t => change%tangent)
         call second_derivative(c, change%q, t, f_t)
         call second_derivative(c, change%q, k, f_k)
         call second_derivative(c, change%q, t + k, f_sum)
         mixed = 0.5_wp*dot_product(w, f_sum - f_t - f_k)
         along_k = dot_product(w, f_k)
         ok = abs(mixed) > zero*max(norm2(f_t), norm2(f_k), norm2(f_sum))
         if (.not. ok) return
         x = k - along_k/(2.0_wp*mixed)*t
      end associate
      x = x/norm2(x)
      q = change%q
      call add_to_links(c%closure, aside*x, q)
      call find_point(c, q, x, p, ok)
      if (ok) ok = maxval(abs(p%q - q)) <= straight*aside
   end subroutine other_circuit

   !> The null vectors `w`, left, and `k`, right, of the equations' Jacobian with the tangent as its last row, which is
   !> nearly singular at `before`: two steps of inverse iteration.
   subroutine null_vectors(c, before, w, k, ok)
      type(curve_t), intent(inout) :: c
      type(curve_point_t), intent(in) :: before
      real(wp), intent(out) :: w(:), k(:)
      logical, intent(out) :: ok
      real(wp) :: left(size(w), 1)
      integer :: info, i

      call move_to(c, before%q, before%tangent)
      call factor_with(c, before%tangent, info)
      ok = info == 0
      if (.not. ok) return
      k = [(1.0_wp/real(i, wp), i=1, size(k))]
      left(:, 1) = k
      do i = 1, 2
         call solve(c%factors, k)
         k = k/norm2(k)
         call solve_transposed(c%factors, left)
         left = left/norm2(left)
      end do
      w = left(:, 1)
   end subroutine null_vectors
end module circuit_crossing
