!> The assembly of a block from a distant estimate: the sum of squares of its residuals is reduced step by step
!> (Levenberg 1944, Marquardt 1963). Newton's method by itself would jump to another branch. The residual that is left
!> in the end is the block's closure error.
module levenberg_marquardt
   use kinds, only: wp
   use block_matrix, only: matrix_layout_t, work_length, solve_first
   use convergence, only: solve_report_t, record_closure_error
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: find_known_parts, assemble_dense
   use block_rank, only: residual_of
   implicit none
   private
   public :: levenberg_marquardt_solve, find_closure_error

   !> No unknown goes further than this in one iteration: half a radian, half the unit of its loop.
   real(wp), parameter :: longest_step = 0.5_wp
   !> A larger residual is not reduced: steps of that length do not make it small. Its square is well below overflow.
   real(wp), parameter :: largest_reducible = min(1.0e30_wp, sqrt(sqrt(huge(1.0_wp))))
   !> The damping, a factor of |d|^2 in the sum that a step d minimizes. It falls to a fifth after a step that reduces
   !> the sum of squares, and rises five times otherwise. With the least the step is Newton's; with the largest no step
   !> reduces the sum.
   real(wp), parameter :: first_damping = 1.0e-2_wp, min_damping = 1.0e-12_wp, max_damping = 1.0e8_wp
   !> With a smaller residual no other start is tried.
   real(wp), parameter :: good_residual = max(1.0e-6_wp, 64.0_wp*epsilon(1.0_wp))
   !> A smaller residual has nothing to correct.
   real(wp), parameter :: least_residual = max(1.0e-15_wp, 4.0_wp*epsilon(1.0_wp))
   !> Shorter steps are rounding, in rad or units of the loop.
   real(wp), parameter :: min_step = max(1.0e-12_wp, 32.0_wp*epsilon(1.0_wp))
   integer, parameter :: max_damped_steps = 200   !< steps of at most 0.5 that lead 100 rad have missed the minimum
   !> Starts at most: the values given, then others around them, as long as each ends in a local minimum.
   integer, parameter :: starts = 6
   !> Multiples of this, less their whole part, fill an interval evenly.
   real(wp), parameter :: golden = 0.61803398874989485_wp
   !> The matrices are dense: blocks of more unknowns are left as they are.
   integer, parameter :: max_damped_unknowns = 600
   !> In blocks of more unknowns no closure error of a single pair is found with all other pairs closed: one number is
   !> not worth minutes.
   integer, parameter :: max_single_unknowns = 150
   !> Weights of the equations that shall close, first the one, then the other: their residual falls with the square.
   real(wp), parameter :: stiff(2) = [30.0_wp, 1.0e3_wp]

contains

   !> Brings a block to the values with the least sum of the squares of its residuals to which `starts` starts lead. A
   !> block of more than `max_damped_unknowns` unknowns stays.
   subroutine levenberg_marquardt_solve(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< with the first start and the motion of earlier blocks; then the result
      real(wp), dimension(b%list(i)%shape%n) :: start, best
      real(wp) :: least, square
      integer :: k

      if (size(start) == 0 .or. size(start) > max_damped_unknowns) return
      call find_known_parts(b, x, i, s)
      start = values_of(b, i, s)
      best = start
      least = huge(least)
      do k = 0, starts - 1
         call set_values(b, i, around(start, k), s)
         call descend(b, x, i, spread(1.0_wp, 1, b%list(i)%shape%rows), s)
         square = sum(residual_of(b, x, i, values_of(b, i, s), s)**2)
         if (square < least) best = values_of(b, i, s)
         least = min(least, square)
         if (least <= good_residual**2) exit
      end do
      call set_values(b, i, best, s)
   end subroutine levenberg_marquardt_solve

   !> Finds the pair or drive of a block with the largest closure error at the least sum of squares, and its closure
   !> error if all other equations are closed; 0 if no such position is found. With redundant equations, which share the
   !> closure error, it is the closure error at the least sum. A too large block is left without one.
   subroutine find_closure_error(b, x, i, s, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< with the values of the least sum; then with any values
      type(solve_report_t), intent(inout) :: convergence   !< convergence%open is set; of a too large block it stays
      type(solve_report_t) :: one
      logical :: own(0:b%list(i)%shape%rows)
      real(wp) :: best(b%list(i)%shape%n), r(b%list(i)%shape%rows)
      integer :: k, m

      if (size(best) == 0 .or. size(best) > max_damped_unknowns) return
      best = values_of(b, i, s)
      call record_closure_error(b, x, i, residual_of(b, x, i, best, s), convergence)
      if (size(r) > size(best)) return

      convergence%open%value = 0.0_wp
      if (size(best) > max_single_unknowns) return

      own = .false.
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m), row => b%rows(b%list(i)%first_row + max(b%loops(m)%row_x, b%loops(m)%row_y) - 1))
            if (row%pair == convergence%open%pair .and. row%drive == convergence%open%drive .and. &
               (row%angular .eqv. convergence%open%is_angle)) own([g%row_x, g%row_y]) = .true.
         end associate
      end do
      do k = 0, starts - 1
         call set_values(b, i, around(best, k), s)
         do m = 1, size(stiff)
            call descend(b, x, i, merge(1.0_wp, stiff(m), own(1:)), s)
         end do
         r = residual_of(b, x, i, values_of(b, i, s), s)
         call record_closure_error(b, x, i, r, one)
         if (any(.not. own(1:) .and. .not. stiff(2)*abs(r) <= one%open%value)) cycle
         if (convergence%open%value <= 0.0_wp .or. one%open%value < convergence%open%value) convergence%open = one%open
      end do
   end subroutine find_closure_error

   !> Gives a start (n) around given values, in their units. Start k is off by up to k/2 in each value: start 0 by
   !> nothing, the last by almost half a turn.
   pure function around(values, k) result(y)
      real(wp), intent(in) :: values(:)      !< (n) rad or unit of the loop
      integer, intent(in) :: k               !< number of the start, from 0
      real(wp) :: y(size(values))
      integer :: m

      y = [(2.0_wp*modulo(golden*real(2*k*size(values) + m, wp), 1.0_wp) - 1.0_wp, m=1, size(values))]
      y = values + 3.0_wp*real(k, wp)/real(starts, wp)*y
   end function around

   !> Reduces the sum of the squares of weighted residuals of a block, down to a local minimum.
   subroutine descend(b, x, i, weights, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      real(wp), intent(in) :: weights(:)     !< (rows) factors of the residuals
      type(state_t), intent(inout) :: s      !< with the values from which it begins; then those of the least sum
      type(matrix_layout_t) :: damped                     ! the Jacobian with a row more for each unknown
      real(wp) :: values(b%list(i)%shape%n), r(size(weights)), jacobian(size(weights), size(values)), &
         d(size(r) + size(values)), a(size(d), size(values)), damping, square, step, largest
      real(wp), allocatable :: work(:)
      integer :: pivots(size(values)), iteration, k, info

      damped = matrix_layout_t(rows=size(d), n=size(values))
      allocate (work(work_length(damped)))
      damping = first_damping
      call assemble_dense(b, x, i, s, jacobian, r)
      do iteration = 1, max_damped_steps
         largest = maxval(weights*abs(r))
         if (largest <= least_residual .or. damping > max_damping .or. .not. largest <= largest_reducible) exit
         square = sum((weights*r)**2)
         values = values_of(b, i, s)

         ! Least squares of J d = r and sqrt(damping) d = 0 together, cut to the longest step.
         a = 0.0_wp
         do k = 1, size(values)
            a(:size(r), k) = weights*jacobian(:, k)
            a(size(r) + k, k) = sqrt(damping)
         end do
         d(:size(r)) = weights*r
         d(size(r) + 1:) = 0.0_wp
         call solve_first(damped, a, pivots, work, d, info)
         step = maxval(abs(d(:size(values))))
         if (step > longest_step) d(:size(values)) = d(:size(values))*(longest_step/step)

         call set_values(b, i, values - d(:size(values)), s)
         call assemble_dense(b, x, i, s, jacobian, r)
         if (sum((weights*r)**2) < square) then
            damping = max(0.2_wp*damping, min_damping)
            if (step <= min_step) exit
         else
            damping = 5.0_wp*damping
            call set_values(b, i, values, s)
            call assemble_dense(b, x, i, s, jacobian, r)
         end if
      end do
   end subroutine descend
end module levenberg_marquardt
