!> A block assembled from a distant estimate: the sum of squares of its residuals is reduced step by step (Levenberg
!> 1944, Marquardt 1963), where Newton's method alone would jump to another branch. What is left in the end is the
!> block's closure error.
module levenberg_marquardt
   use kinds, only: wp
   use block_matrix, only: shape_t, work_length, solve_first
   use convergence, only: convergence_t, note_closure_error
   use blocks, only: blocks_t
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: find_known_parts, assemble_dense
   use block_rank, only: residual_of
   implicit none
   private
   public :: levenberg_marquardt_solve

   !> No unknown goes further than this in one iteration: half a radian, half the characteristic length.
   real(wp), parameter :: longest_step = 0.5_wp
   !> No steps of that length make a residual small that is beyond this; its square is well below overflow.
   real(wp), parameter :: bound = min(1.0e30_wp, sqrt(sqrt(huge(1.0_wp))))
   real(wp), parameter :: first_damping = 1.0e-2_wp, min_damping = 1.0e-12_wp, max_damping = 1.0e8_wp
   !> Shorter ones are rounding.
   real(wp), parameter :: min_step = max(1.0e-12_wp, 32.0_wp*epsilon(1.0_wp))
   integer, parameter :: max_iterations = 200
   !> Starts: the initial estimate, then others around it, where that ends in a local minimum.
   integer, parameter :: max_starts = 12
   !> Multiples of it, less their whole part, fill an interval evenly.
   real(wp), parameter :: golden = 0.61803398874989485_wp
   !> The matrices are dense: larger blocks are left as they are.
   integer, parameter :: max_unknowns = 600
   !> Wider blocks are not asked for what is open alone: that is one number, and not worth minutes.
   integer, parameter :: max_alone = 150
   !> Equations that shall close count so many times as much as others: what is left of them goes with the square.
   real(wp), parameter :: stiff(2) = [30.0_wp, 1.0e3_wp]

contains

   !> Brings block `i` from the values of `s` to where its residual is at most `near`; where that cannot be, to where
   !> it is smallest, and `c` has the pair or drive that is open the most there, and its closure error as `open_alone`
   !> finds it. `reached`: the residual is at most `near`.
   subroutine levenberg_marquardt_solve(b, i, near, s, c, reached)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: near
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      logical, intent(out) :: reached
      real(wp), dimension(b%list(i)%shape%n) :: start, best
      real(wp) :: weights(b%list(i)%shape%rows), least, found
      integer :: k

      reached = .false.
      if (size(start) == 0 .or. size(start) > max_unknowns) return
      start = values_of(b, i, s)
      call find_known_parts(b, i, s)
      best = start
      weights = 1.0_wp
      least = huge(least)
      do k = 0, max_starts - 1
         call set_values(b, i, around(start, k), s)
         call descend(b, i, near, weights, s, found)
         if (found < least) then
            least = found
            best = values_of(b, i, s)
         end if
         if (least <= near) exit
      end do
      call note_closure_error(b, i, residual_of(b, i, best, s), c)
      reached = least <= near
      ! Redundant equations share what is lacking.
      if (.not. reached .and. size(weights) <= size(best)) call open_alone(b, i, near, best, s, c)
   end subroutine levenberg_marquardt_solve

   !> Puts into `c` by how much its pair or drive is open at least while all others of block `i` are closed; 0: no such
   !> position is found. The values of `s` are `best` (n), before and after.
   subroutine open_alone(b, i, near, best, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: near, best(:)
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      type(convergence_t) :: one
      logical :: own(0:b%list(i)%shape%rows)
      real(wp) :: r(b%list(i)%shape%rows), found
      integer :: k, m

      c%open%value = 0.0_wp
      if (size(best) > max_alone) return
      own = .false.
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m), row => b%rows(b%list(i)%first_row + max(b%loops(m)%row_x, b%loops(m)%row_y) - 1))
            if (row%pair == c%open%pair .and. row%drive == c%open%drive .and. (row%angular .eqv. c%open%is_angle)) &
               own([g%row_x, g%row_y]) = .true.
         end associate
      end do
      do k = 0, max_starts - 1, 2
         call set_values(b, i, around(best, k), s)
         do m = 1, size(stiff)
            call descend(b, i, near, merge(1.0_wp, stiff(m), own(1:)), s, found)
         end do
         r = residual_of(b, i, values_of(b, i, s), s)
         call note_closure_error(b, i, r, one)
         if (any(.not. own(1:) .and. .not. stiff(2)*abs(r) <= one%open%value)) cycle
         if (c%open%value <= 0.0_wp .or. one%open%value < c%open%value) c%open = one%open
      end do
      call set_values(b, i, best, s)
   end subroutine open_alone

   !> Start number `k` around `x`: off by nothing at first, then by more and more, up to half a turn.
   pure function around(x, k) result(y)
      real(wp), intent(in) :: x(:)
      integer, intent(in) :: k
      real(wp) :: y(size(x))
      integer :: m

      y = [(2.0_wp*modulo(golden*real(k*size(x) + m, wp), 1.0_wp) - 1.0_wp, m=1, size(x))]
      y = x + 3.0_wp*real(k, wp)/real(max_starts, wp)*y
   end function around

   !> Reduces the sum of squares of the residuals, each times one of the `weights` (rows), from the values of `s`;
   !> `found`: the largest of these products at the end.
   subroutine descend(b, i, near, weights, s, found)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: near, weights(:)
      type(state_t), intent(inout) :: s
      real(wp), intent(out) :: found
      type(shape_t) :: damped                     ! the Jacobian with a row more for each unknown
      real(wp) :: x(b%list(i)%shape%n), r(size(weights)), jacobian(size(weights), size(x)), d(size(r) + size(x)), &
         a(size(d), size(x)), damping, square, step
      real(wp), allocatable :: work(:)
      integer :: pivots(size(x)), iteration, k, info

      damped = shape_t(rows=size(d), n=size(x))
      allocate (work(work_length(damped)))
      damping = first_damping
      call assemble_dense(b, i, s, jacobian, r)
      do iteration = 1, max_iterations
         found = maxval(weights*abs(r))
         if (found <= near .or. damping > max_damping .or. .not. found <= bound) exit
         square = sum((weights*r)**2)
         x = values_of(b, i, s)

         ! Least squares of J d = r and sqrt(damping) d = 0 together, cut to the longest step.
         a = 0.0_wp
         do k = 1, size(x)
            a(:size(r), k) = weights*jacobian(:, k)
            a(size(r) + k, k) = sqrt(damping)
         end do
         d(:size(r)) = weights*r
         d(size(r) + 1:) = 0.0_wp
         call solve_first(damped, a, pivots, work, d, info)
         step = maxval(abs(d(:size(x))))
         if (step > longest_step) d(:size(x)) = d(:size(x))*(longest_step/step)

         call set_values(b, i, x - d(:size(x)), s)
         call assemble_dense(b, i, s, jacobian, r)
         if (sum((weights*r)**2) < square) then
            damping = max(0.2_wp*damping, min_damping)
            if (step <= min_step) exit
         else
            damping = 5.0_wp*damping
            call set_values(b, i, x, s)
            call assemble_dense(b, i, s, jacobian, r)
         end if
      end do
      found = maxval(weights*abs(r))
   end subroutine descend
end module levenberg_marquardt
