!> Level 10. One block: its position by Newton's method, its velocities and accelerations from the factors of the same
!> Jacobian.
!>
!> A residual at the rounding level has nothing to correct, and DGESV then gives the velocities at once; a
!> larger one gives a correction first, and where that is at the rounding level the velocities follow from its
!> factors. So one assembly and one factorization a step are the rule, from a start that is right already. A
!> Jacobian one correction d away leaves errors of order d in the rates: no larger d is accepted.
module block_solver
   use kinds, only: wp
   use linear_solver, only: entries_of, solve_first, solve_again, pivot_range, inverse_norm
   use convergence, only: convergence_t, ended_converged, ended_stalled, ended_singular, ended_limit, &
      ended_diverged
   use blocks, only: blocks_t
   use block_state, only: state_t, set_direction, turn_direction, known_parts
   use block_rows, only: block_system
   use block_sides, only: rate_side
   implicit none
   private
   public :: workspace_t, new_workspace, solve_block

   !> Residuals relative to the largest value. Below the first there is nothing to correct; above the second,
   !> rounding of angles and of their sines alone explains no residual.
   real(wp), parameter :: closed_level = 2.0_wp*epsilon(1.0_wp)
   real(wp), parameter :: rounding_level = 12.0_wp*epsilon(1.0_wp)
   real(wp), parameter :: step_tolerance = 32.0_wp*epsilon(1.0_wp)
   !> A change of direction below this is applied without a new sine and cosine: its square is lost in rounding.
   real(wp), parameter :: small_turn = 1.0e-9_wp
   !> A pivot this much smaller than the largest is worth an estimate of the inverse.
   real(wp), parameter :: suspicious_pivot = 1.0e-3_wp
   !> Relative error of the velocities, by what rounding leaves open in the position, from which on they are not told.
   real(wp), parameter :: largest_error = 0.05_wp
   !> An angle beyond this has fewer digits after the point than the listing prints.
   real(wp), parameter :: angle_limit = 1.0e8_wp
   integer, parameter :: iteration_limit = 60

   !> Room for the widest block.
   type :: workspace_t
      real(wp), allocatable :: a(:), r(:), start(:), work(:)
      integer, allocatable :: pivots(:), iwork(:)
   end type workspace_t

contains

   !> Room for every block of `b`.
   pure function new_workspace(b) result(w)
      type(blocks_t), intent(in) :: b
      type(workspace_t) :: w
      integer :: i, n, entries, widest

      entries = 0
      widest = 0
      do i = 1, size(b%list)
         n = b%list(i)%last - b%list(i)%first + 1
         widest = max(widest, n)
         entries = max(entries, entries_of(n, b%list(i)%below, b%list(i)%above))
      end do
      allocate (w%a(entries), w%r(2*widest), w%start(widest), w%work(4*widest), source=0.0_wp)
      allocate (w%pivots(widest), w%iwork(widest), source=0)
   end function new_workspace

   !> Solves block `i` for value, rate and second rate of its unknowns, the values starting from those of `s`.
   !> `c`: how it ended; `correction`: the largest change of a value, where it is larger than before.
   subroutine solve_block(b, i, tolerance, w, s, c, correction)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      real(wp), intent(inout) :: correction

      if (b%list(i)%direct) then
         call solve_direct(b, b%list(i)%first, s)
         c%ended = ended_converged
         return
      end if
      call seek(b, i, b%list(i)%last - b%list(i)%first + 1, tolerance, w%a, w%r, w%start, w%pivots, s, c, correction)
      if (c%ended == ended_converged .or. c%ended == ended_stalled) &
         call finish(b, i, b%list(i)%last - b%list(i)%first + 1, w, s, c)
   end subroutine solve_block

   !> A drive's own unknown: nothing to iterate.
   pure subroutine solve_direct(b, k, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: k
      type(state_t), intent(inout) :: s

      associate (u => s%u(b%unknown(k)), other => s%u(b%rows(k)%other), row => b%rows(k), d => b%rows(k)%drive)
         u%value = other%value + row%sign_of*(row%constant + s%target(0, d))
         u%rate = other%rate + row%sign_of*s%target(1, d)
         u%rate2 = other%rate2 + row%sign_of*s%target(2, d)
      end associate
      call set_direction(b, b%unknown(k), s)
   end subroutine solve_direct

   !> Newton's method; where it ends with a position, `r`(:, 2) holds the velocities and `a` the factors. Where the
   !> Jacobian there has no inverse, c%singular says so.
   subroutine seek(b, i, n, tolerance, a, r, start, pivots, s, c, correction)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      real(wp), intent(in) :: tolerance
      real(wp), intent(inout) :: a(*), r(n, 2), start(n)
      integer, intent(inout) :: pivots(*)
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      real(wp), intent(inout) :: correction
      real(wp) :: before, size_of
      integer :: info, iteration

      call begin(b, i, n, s, start, size_of)
      before = huge(before)
      c%singular = .false.
      c%ended = ended_limit
      do iteration = 1, iteration_limit
         if (.not. size_of <= angle_limit) then
            c%ended = ended_diverged
            return
         end if
         c%iterations = iteration
         call assemble(b, i, n, s, a, r)
         c%residual = maxval(abs(r(:, 1)))
         if (c%residual <= closed_level*size_of) then
            c%step = 0.0_wp
            c%ended = ended_converged
            call rate_side(b, i, 1, s, r(:, 2))
            call solve_first(n, b%list(i)%below, b%list(i)%above, a, pivots, r(:, 2), info)
            c%singular = info > 0
            exit
         end if
         call solve_first(n, b%list(i)%below, b%list(i)%above, a, pivots, r, info)
         if (info > 0) then
            c%singular = c%residual <= max(rounding_level*size_of, tolerance)
            c%ended = merge(ended_stalled, ended_singular, c%singular)
            exit
         end if
         c%step = maxval(abs(r(:, 1)))
         if (c%residual <= rounding_level*size_of .and. c%step > 0.5_wp*before) then
            ! Rounding is all that is left to correct: the position stays.
            c%ended = ended_stalled
         else
            call move(b, i, n, r, s, c%step, size_of)
            if (c%step <= max(step_tolerance*size_of, tolerance)) c%ended = ended_converged
         end if
         before = c%step
         if (c%ended == ended_limit) cycle
         call rate_side(b, i, 1, s, r(:, 2))
         call solve_again(n, b%list(i)%below, b%list(i)%above, a, pivots, r(:, 2))
         exit
      end do
      correction = max(correction, largest_change(b, i, n, s, start))
   end subroutine seek

   !> Directions and known parts where the search begins, and what it begins from.
   subroutine begin(b, i, n, s, start, size_of)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      type(state_t), intent(inout) :: s
      real(wp), intent(out) :: start(n), size_of
      integer :: k

      size_of = 1.0_wp
      do k = 1, n
         associate (u => b%unknown(b%list(i)%first + k - 1))
            start(k) = s%u(u)%value
            size_of = max(size_of, abs(start(k)))
            call set_direction(b, u, s)
         end associate
      end do
      call known_parts(b, i, s)
   end subroutine begin

   !> Jacobian and residual of the block at the state.
   subroutine assemble(b, i, n, s, a, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(n, 2)

      a(:entries_of(n, b%list(i)%below, b%list(i)%above)) = 0.0_wp
      associate (below => b%list(i)%below, above => b%list(i)%above)
         if (below < 0) then
            call block_system(b, i, -n, n, s, a, r)
         else
            ! DGBSV: entry (row, column) in row below + above + 1 + row - column of 2 below + above + 1.
            call block_system(b, i, -below, 2*below + above, s, a, r)
         end if
      end associate
   end subroutine assemble

   !> Applies the correction r(:, 1), whose largest is `step`; `size_of`: the largest value, 1 at least.
   subroutine move(b, i, n, r, s, step, size_of)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      real(wp), intent(in) :: r(n, 2)
      type(state_t), intent(inout) :: s
      real(wp), intent(in) :: step
      real(wp), intent(out) :: size_of
      integer :: k

      size_of = 1.0_wp
      do k = 1, n
         associate (u => b%unknown(b%list(i)%first + k - 1))
            s%u(u)%value = s%u(u)%value - r(k, 1)
            size_of = max(size_of, abs(s%u(u)%value))
            if (step <= small_turn) then
               call turn_direction(b, u, -r(k, 1), s)
            else
               call set_direction(b, u, s)
            end if
         end associate
      end do
   end subroutine move

   pure real(wp) function largest_change(b, i, n, s, start) result(change)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      type(state_t), intent(in) :: s
      real(wp), intent(in) :: start(n)
      integer :: k

      change = 0.0_wp
      do k = 1, n
         change = max(change, abs(s%u(b%unknown(b%list(i)%first + k - 1))%value - start(k)))
      end do
   end function largest_change

   !> Velocities and accelerations, unless the Jacobian is near to having no inverse.
   subroutine finish(b, i, n, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      integer :: k

      if (.not. c%singular) call judge(b, i, n, w, s, c)
      if (c%singular) return
      do k = 1, n
         s%u(b%unknown(b%list(i)%first + k - 1))%rate = w%r(n + k)
      end do
      call rate_side(b, i, 2, s, w%r)
      call solve_again(n, b%list(i)%below, b%list(i)%above, w%a, w%pivots, w%r)
      do k = 1, n
         s%u(b%unknown(b%list(i)%first + k - 1))%rate2 = w%r(k)
      end do
   end subroutine finish

   !> Sign of the determinant, and whether rounding leaves the velocities open: with B = |J^-1| and the residual
   !> known to h, the position is known to B h, the Jacobian to B h times its bend, the velocities to B times
   !> that.
   subroutine judge(b, i, n, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(in) :: s
      type(convergence_t), intent(inout) :: c
      real(wp) :: least, largest, inverse, size_of
      integer :: k

      call pivot_range(n, b%list(i)%below, b%list(i)%above, w%a, w%pivots, least, largest, c%determinant)
      inverse = 1.0_wp/least
      if (n == 2 .or. (n > 2 .and. least < suspicious_pivot*largest)) &
         inverse = inverse_norm(n, b%list(i)%below, b%list(i)%above, w%a, w%pivots, w%work, w%iwork)
      c%reciprocal_condition = min(1.0_wp, 1.0_wp/(inverse*merge(1.0_wp, largest, n == 1)))
      size_of = 1.0_wp
      do k = b%list(i)%first, b%list(i)%last
         size_of = max(size_of, abs(s%u(b%unknown(k))%value))
      end do
      c%singular = inverse*inverse*b%list(i)%bend*rounding_level*size_of >= largest_error
   end subroutine judge
end module block_solver
