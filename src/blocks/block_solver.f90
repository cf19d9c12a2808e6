!> One block: its position by Newton's method, its velocities and accelerations from the factors of the same
!> Jacobian.
!>
!> A residual at the rounding level has nothing to correct, and DGESV then gives the velocities at once; a larger
!> one gives a correction first, and where that is at the rounding level the velocities follow from its factors.
!> So one assembly and one factorization a step are the rule, from a start that is right already. A Jacobian one
!> correction d away leaves errors of order d in the rates: no larger d is accepted. After a larger, but small one the
!> factors serve again for two unknowns, with the difference of the Jacobians mended: a coarse step needs no second
!> DGESV.
!>
!> Where equations are too many, all of them are solved, in the sense of least squares (Gauss and Newton): which of
!> them could be spared changes along the motion. By how much they contradict one another is the closure error.
module block_solver
   use kinds, only: wp
   use block_matrix, only: shape_t, solve_first, solve_again, pivot_range, inverse_norm, spread_by_inverse, &
      entries_of, work_length, nearby_t, solve_nearby, stay_near
   use convergence, only: convergence_t, ended_converged, ended_stalled, ended_singular, ended_limit, ended_diverged, &
      ended_inconsistent, is_solved, note_closure_error, inconsistent_level, contradict
   use planar, only: length_of
   use blocks, only: blocks_t, block_t, block_numbers_t, known_to, loop_projection
   use block_state, only: state_t, set_direction
   use block_equations, only: find_known_parts, assemble_with_velocities, right_hand_side
   implicit none
   private
   public :: workspace_t, new_workspace, solve_block, solve_direct, solve_equations, solve_rates, second_order_bounds
   public :: closed_level, step_tolerance, suspicious_pivot

   !> Residuals relative to the largest value. Below the first there is nothing to correct; above the second,
   !> rounding of angles and of their sines alone explains no residual.
   real(wp), parameter :: closed_level = 2.0_wp*epsilon(1.0_wp)
   real(wp), parameter, public :: rounding_level = 12.0_wp*epsilon(1.0_wp)
   real(wp), parameter :: step_tolerance = 32.0_wp*epsilon(1.0_wp)
   !> A change of direction below this is applied without a new sine and cosine: its square is lost in rounding.
   real(wp), parameter :: small_turn = 1.0e-9_wp*sqrt(epsilon(1.0_wp)*2.0_wp**52)
   !> A pivot this much smaller than the largest is worth an estimate of the inverse.
   real(wp), parameter :: suspicious_pivot = 1.0e-3_wp
   !> Kantorovich ratio from which the inverse is estimated. The ratio takes 1/(least pivot) for |J^-1|: with more than
   !> two unknowns that is too small, by 4 with 9 of them, by 2000 with 49 (lattices); ratios matter from 0.1 on.
   !> What the drives' excursions add goes with its square, and with 0.1 over the fourth power of their number.
   real(wp), parameter :: small_kantorovich_ratio = 1.0e-6_wp, small_growth = 0.1_wp
   !> Relative error of the velocities, by what rounding leaves open in the position, that is too large to print them.
   real(wp), parameter :: largest_error = 0.05_wp
   !> Angles beyond have few digits after the point.
   real(wp), parameter, public :: angle_limit = min(1.0e8_wp, 0.01_wp/epsilon(1.0_wp))
   integer, parameter :: iteration_limit = 60
   !> 1 over this squared is within the range of reals.
   real(wp), parameter :: min_inverse = epsilon(1.0_wp)**2

   !> The Jacobian of a block, then its factors, or those of one beside it; two right-hand sides, one after the other,
   !> and first values; room for the widest block. Nothing in it outlives the solution of a block.
   type :: workspace_t
      real(wp), allocatable :: a(:), r(:), start(:), work(:)
      integer, allocatable :: pivots(:), iwork(:)
      type(nearby_t) :: near                      !< the Jacobian, where `a` holds the factors of one beside it
   end type workspace_t

contains

   !> Room for every block of `b`.
   pure function new_workspace(b) result(w)
      type(blocks_t), intent(in) :: b
      type(workspace_t) :: w
      integer :: entries, rows, length

      entries = max(0, maxval(entries_of(b%list%shape)))
      rows = max(0, maxval(b%list%shape%rows))
      length = max(0, maxval(work_length(b%list%shape)))
      allocate (w%a(entries), w%r(2*rows), w%start(rows), w%work(length), source=0.0_wp)
      allocate (w%pivots(rows), w%iwork(rows), source=0)
   end function new_workspace

   !> Solves block `i` for value, rate and acceleration of its unknowns, the values starting from those of `s`.
   !> `c`: how it ended.
   subroutine solve_block(b, i, tolerance, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c

      if (b%list(i)%direct) then
         call solve_direct(b, i, s)
         c%ended = ended_converged
      else
         call solve_equations(b, i, b%list(i), b%numbers%blocks(i), tolerance, w, s, c)
      end if
   end subroutine solve_block

   !> A drive's own unknown: nothing to iterate.
   pure subroutine solve_direct(b, i, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      integer :: d

      associate (u => s%u(b%unknown(b%list(i)%first)), row => b%rows(b%list(i)%first_row), &
                 numbers => b%numbers%rows(b%list(i)%first_row))
         associate (other => s%u(row%other))
            d = row%drive
            u%value = other%value + row%sign_of*(numbers%constant + s%drive_value(0, d))
            u%rate = other%rate + row%sign_of*s%drive_value(1, d)
            u%acceleration = other%acceleration + row%sign_of*s%drive_value(2, d)
         end associate
      end associate
      call set_direction(b, b%unknown(b%list(i)%first), s)
   end subroutine solve_direct

   !> Solves `block`, number `i`, with its `numbers`, which is not direct, by Newton's method. Where it ends with a
   !> position, `w` holds the velocities, in the second half of `r`, and the factors of the Jacobian there or of one
   !> beside it. Where that Jacobian has no inverse, c%singular says so.
   subroutine solve_equations(b, i, block, numbers, tolerance, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(block_t), intent(in) :: block
      type(block_numbers_t), intent(in) :: numbers
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      real(wp) :: before, size_of, rates(2)
      integer :: info, iteration, second, side, k
      logical :: is_closed, is_right

      second = block%shape%rows + 1
      size_of = 1.0_wp
      do k = block%first, block%last
         associate (f => s%u(b%unknown(k)))
            w%start(k - block%first + 1) = f%value
            size_of = max(size_of, abs(f%value))
         end associate
         call set_direction(b, b%unknown(k), s)
      end do
      call find_known_parts(b, i, s)
      before = huge(before)
      w%near%distance = 0.0_wp
      c = convergence_t(ended=ended_limit)
      do iteration = 1, iteration_limit
         if (.not. size_of <= angle_limit) then
            c%ended = ended_diverged
            return
         end if
         c%iterations = iteration
         call assemble_with_velocities(b, i, s, w%a, w%r, w%r(second))
         if (w%near%distance > 0.0_wp) then
            w%near%a = w%a(:4)
            w%a(:4) = w%near%factors
         end if
         c%residual = largest_size(block%shape%rows, w%r)
         if (block%shape%rows > block%shape%n) call note_closure_error(b, i, w%r, c)
         is_closed = c%residual <= closed_level*max(size_of, numbers%coarse)
         side = merge(second, 1, is_closed)
         info = 0
         if (w%near%distance > 0.0_wp) then
            call solve_nearby(w%near, w%r(side))
         else
            call solve_first(block%shape, w%a, w%pivots, w%work, w%r(side), info, b%patterns)
         end if
         if (is_closed) then
            c%step = 0.0_wp
            c%ended = ended_converged
            c%singular = info > 0
            exit
         end if
         if (info > 0) then
            c%singular = c%residual <= max(rounding_level*max(size_of, numbers%coarse), tolerance)
            c%ended = merge(ended_stalled, ended_singular, c%singular)
            exit
         end if
         c%step = largest_size(block%shape%n, w%r)
         ! Rounding is all that is left to correct, and the position stays; among equations that contradict one another
         ! it is their gap. A step so small that no longer falls is rounding, whatever sums have left it.
         if (c%step > 0.5_wp*before .and. (c%step <= small_turn .or. &
            c%residual <= rounding_level*max(size_of, numbers%coarse))) then
            c%ended = ended_stalled
         else
            call move(b, block, numbers, w%r, s, c%step, tolerance, size_of, is_right)
            if (is_right) c%ended = ended_converged
         end if
         before = c%step
         if (c%ended == ended_limit) then
            call stay_near(block%shape, w%a, w%pivots, numbers%lipschitz*c%step, w%near)
            cycle
         end if
         call right_hand_side(b, i, 1, s, w%r(second))
         call solve_next_side(block%shape, w, w%r(second))
         exit
      end do
      if (c%iterations > 1 .or. c%step > 0.0_wp) then
         do k = 1, block%shape%n
            c%change = max(c%change, abs(s%u(b%unknown(block%first + k - 1))%value - w%start(k)))
         end do
      end if
      if (.not. is_solved(c)) return

      ! Velocities and accelerations, unless equations contradict one another or the Jacobian is near to having no
      ! inverse.
      if (block%shape%rows > block%shape%n .and. c%open%value > max(inconsistent_level*c%open%level, &
         b%numbers%closing)) then
         c%ended = ended_inconsistent
         return
      end if
      if (.not. c%singular) call judge(b, i, block, numbers, w, s, c)
      if (c%singular) return
      do k = 1, block%shape%n
         s%u(b%unknown(block%first + k - 1))%rate = w%r(block%shape%rows + k)
      end do
      call right_hand_side(b, i, 2, s, w%r)
      call solve_next_side(block%shape, w, w%r)
      do k = 1, block%shape%n
         s%u(b%unknown(block%first + k - 1))%acceleration = w%r(k)
      end do
      if (block%shape%rows == block%shape%n) return
      associate (rows => block%shape%rows, n => block%shape%n)
         rates = largest_rates(b, i, s)
         c%rates_open = contradict(w%r(rows + n + 1:2*rows), rates(1), numbers%coarse, b%numbers%closing) &
            .or. contradict(w%r(n + 1:rows), max(rates(2), rates(1)**2), numbers%coarse, b%numbers%closing)
      end associate
   end subroutine solve_equations

   !> Solves block `i` for the rates and accelerations of its unknowns alone, at the position of `s`, with the rates of
   !> drives and of known unknowns in `s`.
   subroutine solve_rates(b, i, w, s, has_rates)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      logical, intent(out) :: has_rates      !< they are unique, and redundant equations do not contradict them
      real(wp) :: rates(2)
      integer :: info, k

      has_rates = .true.
      if (b%list(i)%direct) then
         call solve_direct(b, i, s)
         return
      end if
      associate (block => b%list(i), shape => b%list(i)%shape, rows => b%list(i)%shape%rows, n => b%list(i)%shape%n)
         w%near%distance = 0.0_wp
         call find_known_parts(b, i, s)
         call assemble_with_velocities(b, i, s, w%a, w%r, w%r(rows + 1))
         call solve_first(shape, w%a, w%pivots, w%work, w%r(rows + 1), info, b%patterns)
         has_rates = info == 0
         if (.not. has_rates) return
         do k = 1, n
            s%u(b%unknown(block%first + k - 1))%rate = w%r(rows + k)
         end do
         call right_hand_side(b, i, 2, s, w%r)
         call solve_next_side(shape, w, w%r)
         do k = 1, n
            s%u(b%unknown(block%first + k - 1))%acceleration = w%r(k)
         end do
         if (rows == n) return
         rates = largest_rates(b, i, s)
         has_rates = .not. (contradict(w%r(rows + n + 1:2*rows), rates(1), b%numbers%blocks(i)%coarse, &
            b%numbers%closing) .or. contradict(w%r(n + 1:rows), max(rates(2), rates(1)**2), &
            b%numbers%blocks(i)%coarse, b%numbers%closing))
      end associate
   end subroutine solve_rates

   !> Solves for another right-hand side `v` (rows), from the factors.
   subroutine solve_next_side(shape, w, v)
      type(shape_t), intent(in) :: shape
      type(workspace_t), intent(inout) :: w
      real(wp), intent(inout) :: v(*)

      if (w%near%distance > 0.0_wp) then
         call solve_nearby(w%near, v)
      else
         call solve_again(shape, w%a, w%pivots, w%work, v)
      end if
   end subroutine solve_next_side

   !> Applies the correction `d`, whose largest is `step`; `size_of`: the largest value, 1 at least. `is_right`: each
   !> was at the rounding level of its own value, or within the `tolerance`: beside a long slide an angle is not.
   subroutine move(b, block, numbers, d, s, step, tolerance, size_of, is_right)
      type(blocks_t), intent(in) :: b
      type(block_t), intent(in) :: block
      type(block_numbers_t), intent(in) :: numbers
      real(wp), intent(in) :: d(*)
      type(state_t), intent(inout) :: s
      real(wp), intent(in) :: step, tolerance
      real(wp), intent(out) :: size_of
      logical, intent(out) :: is_right
      real(wp) :: own, c
      integer :: k

      size_of = 1.0_wp
      is_right = .true.
      do k = 1, block%shape%n
         associate (u => b%unknown(block%first + k - 1))
            s%u(u)%value = s%u(u)%value - d(k)
            own = max(1.0_wp, abs(s%u(u)%value))
            size_of = max(size_of, own)
            is_right = is_right .and. abs(d(k)) <= max(step_tolerance*max(own, numbers%coarse), tolerance)
            if (step > small_turn) then
               call set_direction(b, u, s)
            else if (u <= b%orientations) then
               c = s%u(u)%c
               s%u(u)%c = c + d(k)*s%u(u)%s
               s%u(u)%s = s%u(u)%s - d(k)*c
            end if
         end associate
      end do
   end subroutine move

   !> The largest of the sizes of `n` numbers `x`; no number where the last of them is none.
   pure real(wp) function largest_size(n, x) result(largest)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(*)
      integer :: k

      largest = 0.0_wp
      do k = 1, n
         if (.not. abs(x(k)) <= largest) largest = abs(x(k))
      end do
   end function largest_size

   !> Sign of the determinant, how certain it is that the root is the one that was predicted, and whether rounding
   !> leaves the velocities open: with B = |J^-1| and the residual known to h, the position is known to B h, the
   !> Jacobian to B h times its Lipschitz constant L, the velocities to B times that. Newton and Kantorovich: one root
   !> only where B L change is below 1/2.
   subroutine judge(b, i, block, numbers, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(block_t), intent(in) :: block
      type(block_numbers_t), intent(in) :: numbers
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(in) :: s
      type(convergence_t), intent(inout) :: c
      real(wp) :: least, largest, inverse, size_of
      integer :: k, n
      logical :: suspicious

      n = block%shape%n
      call pivot_range(block%shape, w%a, w%pivots, least, largest, c%determinant)
      if (block%shape%pattern > 0) then
         ! Of a wide block no pivot tells how near the Jacobian is to having no inverse.
         inverse = inverse_norm(block%shape, w%a, w%pivots, w%work, w%iwork)
         least = 1.0_wp/inverse
      end if
      c%min_pivot = 1.0_wp
      if (n == 0) return
      c%min_pivot = least
      if (n == 1) largest = numbers%lipschitz
      ! All pivots may be small, where links are much shorter than the mechanism.
      suspicious = least < suspicious_pivot*max(largest, 1.0_wp)
      if (n > 2) then
         c%inverse = 1.0_wp/max(least, min_inverse)
         c%kantorovich_ratio = c%change*numbers%lipschitz*c%inverse
         if (.not. suspicious .and. c%kantorovich_ratio <= small_kantorovich_ratio .and. &
            s%excursion*numbers%lipschitz*c%inverse**2*real(n, wp)**4 <= small_growth) return
      end if
      if (block%shape%pattern == 0) inverse = inverse_norm(block%shape, w%a, w%pivots, w%work, w%iwork)
      c%inverse = min(inverse, 1.0_wp/min_inverse)
      c%kantorovich_ratio = c%change*numbers%lipschitz*inverse
      if (.not. suspicious) return
      size_of = numbers%coarse
      do k = block%first, block%last
         size_of = max(size_of, abs(s%u(b%unknown(k))%value))
      end do
      c%singular = inverse*inverse*numbers%lipschitz*rounding_level*size_of >= largest_error
      if (c%singular) c%singular = is_beyond_linear(b, i, n, w, s)
   end subroutine judge

   !> Tells the same with all rows and unknowns in sizes of their own, for blocks of very different ones: what the
   !> rows hold beyond their linear part moves an unknown by a part of its uncertainty |J^-1| h that is too large.
   logical function is_beyond_linear(b, i, n, w, s) result(is)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, n
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(in) :: s
      real(wp) :: off(n), more(n)

      associate (shape => b%list(i)%shape)
         call spread_by_inverse(shape, w%a, w%pivots, w%work, rounding_level*rounded_sizes(b, i, s), off)
         call spread_by_inverse(shape, w%a, w%pivots, w%work, second_order_bounds(b, i, s, off), more)
      end associate
      is = .not. all(more < largest_error*off)
   end function is_beyond_linear

   !> Finds the largest rate and acceleration of anything that goes into the equations of block `i`: angles, slides,
   !> drives, known or not.
   pure function largest_rates(b, i, s) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp) :: largest(2)
      integer :: k

      largest = 0.0_wp
      do k = b%list(i)%first_row, b%list(i)%last_row
         largest = max(largest, abs(s%drive_value(1:2, b%rows(k)%drive)))
      end do
      associate (u => s%u(known_to(b, i)))
         largest = max(largest, [maxval(abs(u%rate)), maxval(abs(u%acceleration))])
      end associate
   end function largest_rates

   !> (rows) The size of the numbers that each row of block `i` rounds, in the unit of its loop.
   pure function rounded_sizes(b, i, s) result(sizes)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp) :: sizes(b%list(i)%shape%rows), size_of
      integer :: m, k

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            size_of = max(b%numbers%loops(m)%coarse, abs(s%u(g%orientation)%value), abs(s%u(g%less)%value))
            do k = g%first_own, g%last_vector
               size_of = max(size_of, abs(s%u(b%body_vectors(k)%orientation)%value))
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k))
                  size_of = max(size_of, abs(s%u(slide%unknown)%value)*length_of(b%numbers%e(k)), &
                     abs(s%u(slide%orientation)%value))
               end associate
            end do
            if (g%row_x > 0) sizes(g%row_x) = size_of
            if (g%row_y > 0) sizes(g%row_y) = size_of
         end associate
      end do
   end function rounded_sizes

   !> (rows) Bounds of d . r'' d for changes `d` (n, none negative) of the unknowns of block `i` from the state: twice
   !> what the rows r hold beyond their linear part. A projection that turns with an angle of the block turns its loop.
   pure function second_order_bounds(b, i, s, d) result(bounds)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp), intent(in) :: d(:)
      real(wp) :: bounds(b%list(i)%shape%rows), change(0:size(d)), first, second
      integer :: m, k

      change = [0.0_wp, d]
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            first = 0.0_wp
            second = 0.0_wp
            do k = g%first_own, g%last_vector
               associate (length => hypot(b%numbers%d(k)%x, b%numbers%d(k)%y), &
                  turn => change(b%body_vectors(k)%column))
                  first = first + length*turn
                  second = second + length*turn**2
               end associate
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k), turn => change(b%slides(k)%orientation_column), &
                  length => abs(s%u(b%slides(k)%unknown)%value))
                  first = first + length_of(b%numbers%e(k))*(change(slide%column) + length*turn)
                  second = second + length_of(b%numbers%e(k))*turn*(2.0_wp*change(slide%column) + length*turn)
               end associate
            end do
            if (g%kind == loop_projection) then
               associate (turn => change(g%orientation_column))
                  second = second + turn*(2.0_wp*first + length_of(s%loop(m)%closure_error)*turn)
               end associate
            end if
            if (g%row_x > 0) bounds(g%row_x) = second
            if (g%row_y > 0) bounds(g%row_y) = second
         end associate
      end do
   end function second_order_bounds
end module block_solver
