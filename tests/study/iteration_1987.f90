!> Tests. The iteration of 1987 on a scene, with four choices of the angles' references: its rate near the solution, as
!> measured and by the theory; and runs from far away.
!>
!> The print's own choice is iterated here in real128, from (16) and (20) written once more; the others are the
!> program's own procedures, in its own precision. Errors are those against the closed form in real128.
module iteration_1987
   use kinds, only: wp
   use linear_solver, only: factors_t, new_factors, factor, solve
   use configuration, only: set_configuration, choose_references, add_to_links
   use closure_equations, only: residual, jacobian
   use quad_jet, only: qp, degree_q, wrap_angle
   use jet_closure, only: closure
   use quad_frozen, only: references_t, printed_references, nearest_references, dyad_references, &
      frozen_matrix, theory
   use quad_matrices, only: solve_quad
   use scenes_1987, only: scene_t, exact
   implicit none
   private
   public :: by_print, by_start, by_step, by_tangent, by_dyad, variant_names, rate_by_theory, rate_measured, &
      order_measured
   public :: run_t, iterate_from, went_right, went_wrong, went_nowhere

   integer, parameter :: by_print = 1   !< 0 for every angle, the slot row as (16) has it: the print
   integer, parameter :: by_start = 2      !< each row's nearest zero at the crank angle 0, for the whole run
   integer, parameter :: by_step = 3   !< each row's nearest zero, anew at each step: METHOD MATRIX
   integer, parameter :: by_tangent = 4   !< the zero of the row's tangent, anew at each iterate: Newton

   integer, parameter :: by_dyad = 5    !< the four-bars: one for each link with G nilpotent at the start of the step

   character(8), parameter :: variant_names(5) = [character(8) :: 'printed', 'once', 'nearest', 'Newton', 'dyad']

   integer, parameter :: went_right = 1    !< to the closed form's position
   integer, parameter :: went_wrong = 2    !< to another root of the closure
   integer, parameter :: went_nowhere = 3

   !> How an iteration went.
   type :: run_t
      integer :: ended = went_nowhere
      integer :: counts(3) = 0      !< iterations until the error is below each of `digits`
      integer :: steps = 0
      real(wp) :: errors(0:20) = 0.0_wp   !< before the first and after each of the first 20 iterations
   end type run_t

   !> The last is the limit of rounding in the program's precision, with room for a condition of 100.
   real(wp), parameter :: digits(3) = [1.0e-6_wp, 1.0e-10_wp, 1.0e-13_wp]

contains

   !> The spectral radius of G at the crank angle `angle` (deg); -1.0 where A is singular.
   real(wp) function rate_by_theory(s, variant, angle) result(rho)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: variant, angle
      type(references_t) :: z
      integer :: there

      select case (variant)
      case (by_print)
         z = printed_references(s%m)
      case (by_dyad)
         z = dyad_references(s%m, exact(s, angle), 3, 4)
      case default
         there = merge(0, angle, variant == by_start)
         z = nearest_references(s%m, exact(s, there))
      end select
      rho = real(theory(s%m, exact(s, angle), z), wp)
   end function rate_by_theory

   !> The factor by which one iteration multiplies the error near the solution: the geometric mean over `steps`
   !> iterations, the error brought back to 1e-6 after each. -1.0 where A is singular.
   real(wp) function rate_measured(s, variant, angle, steps) result(rate)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant, angle, steps
      real(qp) :: q(3, size(s%turn, 2)), error(3, size(s%turn, 2))
      real(wp) :: logarithm, length
      logical :: regular
      integer :: k
      integer, parameter :: settling = 20
      real(qp), parameter :: near = 1.0e-6_qp

      q = exact(s, angle)
      call begin(s, variant, q)
      error = direction(s)
      logarithm = 0.0_wp
      do k = 1, settling + steps
         q = exact(s, angle) + near*error
         call one_step(s, variant, angle, q, regular)
         rate = -1.0_wp
         if (.not. regular) return
         error = (q - exact(s, angle))/near
         length = real(maxval(abs(error)), wp)
         rate = 0.0_wp
         if (.not. length > 0.0_wp) return
         if (k > settling) logarithm = logarithm + log(length)
         error = error/length
      end do
      rate = exp(logarithm/steps)
   end function rate_measured

   !> The exponent p of |new error| ~ |error|^p, from errors of 2e-3 and 1e-3.
   real(wp) function order_measured(s, variant, angle) result(order)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant, angle
      real(qp) :: q(3, size(s%turn, 2))
      real(wp) :: left(2)
      logical :: regular
      integer :: k

      call begin(s, variant, exact(s, angle))
      do k = 1, 2
         q = exact(s, angle) + k*1.0e-3_qp*direction(s)
         call one_step(s, variant, angle, q, regular)
         left(k) = real(maxval(abs(q - exact(s, angle))), wp)
      end do
      order = log(left(2)/left(1))/log(2.0_wp)
   end function order_measured

   !> A direction without any symmetry, of length 1; ground links stay.
   pure function direction(s) result(d)
      type(scene_t), intent(in) :: s
      real(qp) :: d(3, size(s%turn, 2))
      integer :: i, k

      do i = 1, size(d, 2)
         d(:, i) = [(cos(real(1 + 7*k + 5*i*i, qp)), k=1, 3)]
         if (s%m%links(i)%ground) d(:, i) = 0.0_qp
      end do
      d = d/maxval(abs(d))
   end function direction

   !> Iterates from `start` (3, links) to the crank angle `angle` (deg), at most `limit` times.
   type(run_t) function iterate_from(s, variant, start, angle, limit) result(run)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant, angle, limit
      real(qp), intent(in) :: start(:, :)
      real(qp) :: q(3, size(start, 2)), before(3, size(start, 2))
      real(wp) :: error
      logical :: regular
      integer :: k

      q = start
      run%errors(0) = error_of(s, q, angle)
      call begin(s, variant, q)
      do k = 1, limit
         before = q
         call one_step(s, variant, angle, q, regular)
         if (.not. (regular .and. all(abs(q) <= 1.0e8_qp))) return
         error = error_of(s, q, angle)
         run%steps = k
         if (k <= 20) run%errors(k) = error
         where (run%counts == 0 .and. error <= digits) run%counts = k
         if (run%counts(3) > 0) run%ended = went_right
         if (run%counts(3) > 0) return
         if (maxval(abs(q - before)) > digits(3)) cycle
         ! The closure tells a root from the false attractor h = 0.
         if (maxval(abs(closure(s%m, q, [angle*degree_q]))) <= digits(3)) run%ended = went_wrong
         if (error <= digits(1)) run%ended = went_right
         return
      end do
   end function iterate_from

   !> The largest difference between `q` and the closed form, angles to a whole turn.
   pure real(wp) function error_of(s, q, angle) result(error)
      type(scene_t), intent(in) :: s
      real(qp), intent(in) :: q(:, :)
      integer, intent(in) :: angle
      real(qp) :: d(3, size(q, 2))

      d = q - exact(s, angle)
      d(3, :) = wrap_angle(d(3, :))
      error = real(maxval(abs(d)), wp)
   end function error_of

   !> Chooses the references at the position `q` from which an iteration starts.
   subroutine begin(s, variant, q)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant
      real(qp), intent(in) :: q(:, :)

      if (variant == by_print) s%references = printed_references(s%m)
      if (variant == by_dyad) s%references = dyad_references(s%m, q, 3, 4)
      s%configuration = s%once
      s%configuration%frozen = variant /= by_tangent
      s%configuration%q = real(q, wp)
      call set_configuration(s%system, s%configuration)
      if (variant == by_step) call choose_references(s%system, s%configuration)
   end subroutine begin

   !> One step (20) from `q`. `regular`: its matrix has an inverse.
   subroutine one_step(s, variant, angle, q, regular)
      type(scene_t), intent(inout) :: s
      integer, intent(in) :: variant, angle
      real(qp), intent(inout) :: q(:, :)
      logical, intent(out) :: regular
      type(factors_t) :: f
      real(wp) :: r(s%system%n)
      integer :: info

      if (variant == by_print .or. variant == by_dyad) then
         call step_as_printed(s, angle, q, regular)
         return
      end if
      s%configuration%q = real(q, wp)
      call set_configuration(s%system, s%configuration)
      f = new_factors(s%system%n)
      call residual(s%system, s%configuration, [real(angle*degree_q, wp)], r)
      call jacobian(s%system, s%configuration, f%a)
      call factor(f, info)
      regular = info == 0
      if (.not. regular) return
      call solve(f, r)
      regular = all(abs(r) <= 1.0e9_wp)
      if (.not. regular) return
      call add_to_links(s%system, -r, s%configuration%q)
      q = real(s%configuration%q, qp)
   end subroutine one_step

   subroutine step_as_printed(s, angle, q, regular)
      type(scene_t), intent(in) :: s
      integer, intent(in) :: angle
      real(qp), intent(inout) :: q(:, :)
      logical, intent(out) :: regular
      real(qp), allocatable :: a(:, :), r(:, :)
      logical :: singular
      integer :: i

      a = frozen_matrix(s%m, q, s%references)
      r = reshape(closure(s%m, q, [angle*degree_q]), [s%system%n, 1])
      call solve_quad(a, r, singular)
      regular = .not. singular
      if (singular) return
      do i = 1, size(q, 2)
         associate (c => s%system%column(i))
            if (c > 0) q(:, i) = q(:, i) - r(c:c + 2, 1)
         end associate
      end do
   end subroutine step_as_printed
end module iteration_1987
