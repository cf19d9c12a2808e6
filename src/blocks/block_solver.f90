!> The blocks of a list, one by one: positions by Newton's method, rates from the factors of the last Jacobian.
!>
!> A residual at the rounding level has nothing to correct: DGESV gives the velocities at once. A larger residual gives
!> a correction d first. If d is at the rounding level, its factors give the velocities: one assembly and one
!> factorization a step are the rule. A Jacobian d away leaves errors of order d in the rates: no larger d is accepted.
!> After a larger, but small d the factors of two unknowns serve again, with the difference of the Jacobians corrected.
!>
!> Redundant equations are solved by least squares (Gauss and Newton), all of them: the equation that could be spared
!> changes along the motion. The residual that is left, by which they contradict one another, is the closure error.
module block_solver
   use assertions, only: asserts, assert
   use kinds, only: wp
   use block_matrix, only: matrix_layout_t, solve_first, solve_again, pivot_range, inverse_norm, spread_by_inverse, &
      entries_of, work_length, nearby_t, solve_nearby, stay_near, sparse_factors_t, release
   use number_types, only: vector_t, unknown_t, row_numbers_t, loop_numbers_t, loop_state_t
   use convergence, only: solve_report_t, nothing_gathered, ended_converged, ended_stalled, ended_singular, &
      ended_limit, ended_diverged, ended_inconsistent, is_solved, record_closure_error, inconsistent_level, &
      rounding_level, contradict
   use plane_vectors, only: length_of
   use blocks, only: blocks_t, geometry_t, block_t, block_numbers_t, equation_row_t, block_loop_t, body_vector_t, &
      slide_t, known_to, loop_projection
   use block_state, only: state_t, jacobian_t, set_direction
   use singular_position, only: refine_singular_position
   use block_equations, only: find_direct, find_known, assemble, velocity_rows, acceleration_rows, add_drives
   implicit none
   private
   public :: workspace_t, new_workspace, solve_blocks, solve_block, solve_explicit
   public :: closed_level, step_tolerance, suspicious_pivot

   !> Residuals below this part of the largest value are its rounding and have nothing to correct.
   real(wp), parameter :: closed_level = 2.0_wp*epsilon(1.0_wp)
   !> Corrections below this part of their values are rounding: of some terms, times |J^-1|.
   real(wp), parameter :: step_tolerance = 32.0_wp*epsilon(1.0_wp)
   !> rad: a smaller change of direction is applied without a new sine and cosine: its square is lost in rounding.
   real(wp), parameter :: small_turn = 1.0e-9_wp*sqrt(epsilon(1.0_wp)*2.0_wp**52)
   !> If the least pivot is below this part of the largest, the inverse is estimated.
   real(wp), parameter :: suspicious_pivot = 1.0e-3_wp
   !> Kantorovich ratio from which the inverse is estimated. The ratio takes 1/(least pivot) for |J^-1|: with more than
   !> two unknowns that is too small, by 4 with 9 of them, by 2000 with 49 (lattices); ratios matter from 0.1 on.
   real(wp), parameter :: small_kantorovich_ratio = 1.0e-6_wp
   !> Excursion of the drives times L |J^-1|^2 below which they do not matter; over n^4, for the 1/(least pivot) above.
   real(wp), parameter :: small_amplification = 0.1_wp
   !> Velocities that rounding of the position makes uncertain by more than this part are not printed.
   real(wp), parameter :: largest_velocity_error = 0.05_wp
   !> rad or units of a loop: the values diverge. Larger angles have few digits after the point.
   real(wp), parameter, public :: angle_limit = min(1.0e8_wp, 0.01_wp/epsilon(1.0_wp))
   integer, parameter :: iteration_limit = 60     !< most take 1 to 10; far from a root they may wander without end
   !> Smaller pivots count as this: 1 over this, squared, is within the range of reals.
   real(wp), parameter :: min_inverse = epsilon(1.0_wp)**2

   !> Room for the largest block, in rows and n unknowns. Nothing in it outlives the solution of a block.
   type :: scratch_t
      real(wp), allocatable :: start(:)           !< (n) the values before the iteration, rad or unit of the loop
      real(wp), allocatable :: residuals(:)         !< (rows) the residuals of a block with too many equations
      real(wp), allocatable :: work(:)            !< of LAPACK: `work_length`
      integer, allocatable :: pivots(:), iwork(:) !< (rows) of LAPACK
      type(nearby_t) :: near                      !< the Jacobian, if `a` holds the factors of a nearby one
      type(sparse_factors_t) :: sparse            !< of a sparse Jacobian, instead of `a`
   end type scratch_t
   !> The workspace of the solver: the scratch, the matrix and its right-hand sides.
   type, extends(scratch_t) :: workspace_t
      real(wp), allocatable :: a(:)               !< the Jacobian of a block, then its factors, or those of a nearby one
      real(wp), allocatable :: r(:)               !< (2 rows) two right-hand sides, the first one residuals at first
   end type workspace_t

contains

   !> Makes a workspace with room for every block.
   pure function new_workspace(b) result(w)
      type(blocks_t), intent(in) :: b
      type(workspace_t) :: w
      integer :: entries, rows, length

      entries = max(0, maxval(entries_of(b%list%shape)))
      rows = max(0, maxval(b%list%shape%rows))
      length = max(0, maxval(work_length(b%list%shape)))
      allocate (w%a(entries), w%r(2*rows), w%start(rows), w%residuals(rows), w%work(length), source=0.0_wp)
      allocate (w%pivots(rows), w%iwork(rows), source=0)
   end function new_workspace

   !> Solves the blocks of a list in turn, up to the first without a position, which has its last iterate. A block whose
   !> Jacobian has no inverse keeps its rates, and its position is refined.
   subroutine solve_blocks(b, x, list, w, s, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in), contiguous :: list(:)           !< (any number) numbers of blocks, in solving order
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s                    !< with the drives; its values are the initial guess
      type(solve_report_t), intent(out) :: convergence      !< of all blocks solved
      real(wp) :: ratio
      integer :: k

      if (asserts) call assert(all(list >= 1 .and. list <= size(b%list)), 'solve_blocks: numbers of blocks')
      convergence = nothing_gathered
      k = 0
      do while (k < size(list) .and. is_solved(convergence))
         call solve_next(b, x, list, .true., w, s, k, ratio, convergence)
         if (is_solved(convergence) .and. s%is_singular(list(k))) call refine_singular_position(b, x, list(k), s)
      end do
   end subroutine solve_blocks

   !> Solves a block for the rates and accelerations of its unknowns and, if it moves, first for their values. If its
   !> Jacobian has no inverse, convergence%singular is true, and rates and accelerations stay.
   subroutine solve_block(b, x, i, moves, w, s, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                             !< the number of the block
      logical, intent(in) :: moves                         !< its values are solved for; otherwise they are a position
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s                    !< with the drives; its values are the initial guess
      type(solve_report_t), intent(out) :: convergence      !< of the block
      real(wp) :: ratio
      integer :: k

      convergence = nothing_gathered
      k = 0
      call solve_next(b, x, [i], moves, w, s, k, ratio, convergence)
      convergence%kantorovich_ratio = ratio
   end subroutine solve_block

   !> Solves the next blocks of a list, up to the first without a position or without unique rates.
   subroutine solve_next(b, x, list, moves, w, s, k, ratio, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in), contiguous :: list(:)           !< (any number) numbers of blocks, in solving order
      logical, intent(in) :: moves                         !< their values are solved for
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      integer, intent(inout) :: k                          !< the index in the list of the block solved last
      real(wp), intent(out) :: ratio                       !< the Kantorovich ratio of the block solved last
      type(solve_report_t), intent(inout) :: convergence    !< of all blocks so far

      call solve_list(b, x, size(list), list, moves, b%list, x%blocks, b%unknown, b%loops, x%loops, b%body_vectors, &
         x%d, b%slides, x%e, b%rows, x%rows, s%drive_value, s%excursion, s%u, s%own, s%guide, s%loop, s%jacobian, &
         s%is_singular, w%a, w%r, w%scratch_t, k, ratio, convergence)
   end subroutine solve_next

   !> Finds value, rate and acceleration of the unknown of an explicit block, without iteration.
   pure subroutine solve_explicit(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                             !< the number of the block
      type(state_t), intent(inout) :: s                    !< with the drives

      associate (row => b%rows(b%list(i)%first_row), u => b%unknown(b%list(i)%first))
         call find_direct(row, x%rows(b%list(i)%first_row), s%drive_value, s%u(row%other), s%u(u))
         call set_direction(b, u, s)
      end associate
   end subroutine solve_explicit

   !> Solves the next blocks of a list, up to the first without a position or without unique rates. Reason for plain
   !> arrays: their descriptors are read once for all blocks.
   subroutine solve_list(b, x, n, list, moves, blocks, numbers, unknown, loops, loop_numbers, vectors, unrotated, &
      slides, unrotated_guide, equations, constants, values, excursion, unknowns, own, guide, now, jacobian, &
      is_singular, a, right_sides, scratch, k, ratio, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: n                             !< the length of the list
      integer, intent(in) :: list(n)                       !< numbers of blocks, in solving order
      logical, intent(in) :: moves                         !< their values are solved for

      type(block_t), intent(in) :: blocks(*)               !< (blocks)
      type(block_numbers_t), intent(in) :: numbers(*)      !< (blocks)   !< of the block
      integer, intent(in) :: unknown(*)                    !< (unknowns) their numbers, block by block
      type(block_loop_t), intent(in) :: loops(*)           !< (loops)
      type(loop_numbers_t), intent(in) :: loop_numbers(*)  !< (loops)
      type(body_vector_t), intent(in) :: vectors(*)        !< (body vectors)
      type(vector_t), intent(in) :: unrotated(*)           !< (body vectors) in their axes, unit of the loop
      type(slide_t), intent(in) :: slides(*)               !< (slides)
      type(vector_t), intent(in) :: unrotated_guide(*)     !< (slides) directions, in their axes
      type(equation_row_t), intent(in) :: equations(*)     !< (rows)
      type(row_numbers_t), intent(in) :: constants(*)      !< (rows)
      real(wp), intent(in) :: values(0:2, 0:*)             !< (0:2, 0:drives) value, rate, acceleration of each drive
      real(wp), intent(in) :: excursion                    !< of the drives off chords (rad, characteristic lengths)
      type(unknown_t), intent(inout) :: unknowns(0:*)      !< (0:unknowns)   !< with the motion

      ! Scratch of the equations, then findings.
      type(vector_t), intent(inout) :: own(*)              !< (body vectors) rotated by angles of their block
      type(vector_t), intent(inout) :: guide(*)            !< (slides) directions, rotated
      type(loop_state_t), intent(inout) :: now(*)          !< (loops)
      type(jacobian_t), intent(inout) :: jacobian(*)       !< (blocks)
      logical, intent(inout) :: is_singular(*)             !< (blocks) without unique rates
      real(wp), intent(inout) :: a(*)                      !< room for the largest Jacobian
      real(wp), intent(inout) :: right_sides(*)            !< room for two right-hand sides
      type(scratch_t), intent(inout) :: scratch   !< of the solver
      integer, intent(inout) :: k                          !< the index in the list of the block solved last
      real(wp), intent(out) :: ratio                       !< the Kantorovich ratio of the block solved last
      type(solve_report_t), intent(inout) :: convergence    !< of all blocks so far
      integer :: i

      ratio = 0.0_wp
      do while (k < n)
         k = k + 1
         i = list(k)
         associate (block => blocks(i))
            if (block%explicit) then
               associate (row => equations(block%first_row), f => unknowns(unknown(block%first)))
                  call find_direct(row, constants(block%first_row), values, unknowns(row%other), f)
                  if (unknown(block%first) <= b%orientations) then
                     f%c = cos(f%value)
                     f%s = sin(f%value)
                  end if
               end associate
               cycle
            end if

            call solve_arrays(b, x, i, block, numbers(i), moves, unknown(block%first), loops, loop_numbers, vectors, &
               unrotated, slides, unrotated_guide, equations, constants, values, excursion, unknowns, own, guide, now, &
               a, right_sides, scratch, jacobian(i), is_singular(i), ratio, convergence)
            if (block%shape%pattern > 0) call release(scratch%sparse)
         end associate
         if (is_singular(i) .or. .not. is_solved(convergence)) return
         convergence%kantorovich_ratio = max(convergence%kantorovich_ratio, ratio)
      end do
   end subroutine solve_list

   !> Solves a block that is not explicit by Newton's method. Without a position its unknowns have the last iterate.
   subroutine solve_arrays(b, x, i, block, numbers, moves, unknown, loops, loop_numbers, vectors, unrotated, slides, &
      unrotated_guide, equations, constants, values, excursion, unknowns, own, guide, now, a, right_sides, scratch, &
      jacobian, is_singular, ratio, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                             !< the number of the block
      type(block_t), intent(in) :: block   !< its structure
      type(block_numbers_t), intent(in) :: numbers   !< of the block
      logical, intent(in) :: moves                         !< its values are solved for; otherwise they are a position

      integer, intent(in) :: unknown(*)                    !< (n) numbers of its unknowns
      type(block_loop_t), intent(in) :: loops(*)           !< (loops of all blocks)
      type(loop_numbers_t), intent(in) :: loop_numbers(*)  !< (loops of all blocks)
      type(body_vector_t), intent(in) :: vectors(*)        !< (body vectors of all blocks)
      type(vector_t), intent(in) :: unrotated(*)           !< (body vectors) in their axes, unit of the loop
      type(slide_t), intent(in) :: slides(*)               !< (slides of all blocks)
      type(vector_t), intent(in) :: unrotated_guide(*)     !< (slides) directions, in their axes
      type(equation_row_t), intent(in) :: equations(*)     !< (rows of all blocks)
      type(row_numbers_t), intent(in) :: constants(*)      !< (rows of all blocks)
      real(wp), intent(in) :: values(0:2, 0:*)             !< (0:2, 0:drives) value, rate, acceleration of each drive
      real(wp), intent(in) :: excursion                    !< of the drives off chords (rad, characteristic lengths)
      type(unknown_t), intent(inout) :: unknowns(0:*)      !< (0:unknowns)   !< with the motion

      ! Scratch of the equations, then findings.
      type(vector_t), intent(inout) :: own(*)              !< (body vectors) rotated by angles of the block
      type(vector_t), intent(inout) :: guide(*)            !< (slides) directions, rotated
      type(loop_state_t), intent(inout) :: now(*)          !< (loops of all blocks)
      real(wp), intent(inout) :: a(*)                      !< room for the Jacobian; then its factors
      real(wp), intent(inout) :: right_sides(block%shape%rows, 2)   !< residuals, then accelerations; velocities
      type(scratch_t), intent(inout) :: scratch   !< of the solver
      type(jacobian_t), intent(inout) :: jacobian          !< stays without a position or an inverse, but for the sign
      logical, intent(inout) :: is_singular                !< it has no unique rates; stays if there is no position
      real(wp), intent(out) :: ratio                       !< Kantorovich ratio; 0 if nothing was corrected
      type(solve_report_t), intent(inout) :: convergence    !< of all blocks so far
      real(wp) :: before, size_of, own_size, cosine, residual, step, change, least, bound
      integer :: rows, n, info, ended, iteration, iterations, side, sign_of, k
      logical :: is_closed, is_right, singular

      rows = block%shape%rows
      n = block%shape%n
      size_of = 1.0_wp
      if (moves) then
         do k = 1, n
            associate (f => unknowns(unknown(k)))
               scratch%start(k) = f%value
               size_of = max(size_of, abs(f%value))
               if (unknown(k) <= b%orientations) then
                  f%c = cos(f%value)
                  f%s = sin(f%value)
               end if
            end associate
         end do
      end if

      call find_known(block%first_loop, block%last_loop, loops, loop_numbers, vectors, unrotated, unknowns, now)
      before = huge(before)
      scratch%near%distance = 0.0_wp
      ended = ended_limit
      singular = .false.
      change = 0.0_wp
      ratio = 0.0_wp
      sign_of = 0
      residual = 0.0_wp
      step = 0.0_wp
      iterations = 0

      do iteration = 1, iteration_limit
         if (.not. size_of <= angle_limit) then
            ended = ended_diverged
            exit
         end if
         iterations = iteration
         call assemble(block, numbers%has_right_sides, loops, loop_numbers, vectors, unrotated, slides, &
            unrotated_guide, equations, constants, values, unknowns, own, guide, &
            now, a, right_sides, right_sides(1, 2))

         if (scratch%near%distance > 0.0_wp) then
            scratch%near%a = a(:4)
            a(:4) = scratch%near%factors
         end if
         residual = largest_size(rows, right_sides)
         if (rows > n) scratch%residuals(:rows) = right_sides(:, 1)
         is_closed = residual <= closed_level*max(size_of, numbers%coarse) .or. .not. moves
         side = merge(2, 1, is_closed)

         info = 0
         if (scratch%near%distance > 0.0_wp) then
            call solve_nearby(scratch%near, right_sides(1, side))
         else
            call solve_first(block%shape, a, scratch%pivots, scratch%work, &
               right_sides(1, side), info, b%patterns, scratch%sparse)
         end if
         if (is_closed) then
            step = 0.0_wp
            ended = ended_converged
            singular = info > 0
            exit
         end if
         if (info > 0) then
            singular = residual <= max(rounding_level*max(size_of, numbers%coarse), x%tolerance)
            ended = merge(ended_stalled, ended_singular, singular)
            exit
         end if

         step = largest_size(n, right_sides)
         ! Only rounding is left to correct, and the position stays; of equations that contradict one another the
         ! residual is left. A step so small that no longer falls is rounding, whatever sums have left the rounding.
         if (step > 0.5_wp*before .and. (step <= small_turn .or. &
            residual <= rounding_level*max(size_of, numbers%coarse))) then
            ended = ended_stalled
         else
            ! The iteration has converged if each correction is at the rounding level of its own value, or within the
            ! tolerance: a long slide does not excuse the correction of an angle.
            size_of = 1.0_wp
            is_right = .true.
            do k = 1, n
               associate (f => unknowns(unknown(k)), turn => right_sides(k, 1))
                  f%value = f%value - turn
                  own_size = max(1.0_wp, abs(f%value))
                  size_of = max(size_of, own_size)
                  is_right = is_right .and. &
                     abs(turn) <= max(step_tolerance*max(own_size, numbers%coarse), x%tolerance)
                  if (unknown(k) > b%orientations) cycle

                  if (step > small_turn) then
                     f%c = cos(f%value)
                     f%s = sin(f%value)
                  else
                     cosine = f%c
                     f%c = cosine + turn*f%s
                     f%s = f%s - turn*cosine
                  end if
               end associate
            end do
            if (is_right) ended = ended_converged
         end if

         before = step
         if (ended == ended_limit) then
            call stay_near(block%shape, a, scratch%pivots, numbers%lipschitz*step, scratch%near)
            cycle
         end if

         do k = block%first_loop, block%last_loop
            call velocity_rows(loops(k), slides, unknowns, guide, now(k), right_sides(1, 2))
         end do
         if (numbers%has_right_sides) call add_drives(block%first_row, block%last_row, &
            equations, 1, values, right_sides(1, 2))
         call solve_next_side(block%shape, a, scratch%pivots, scratch%work, &
            scratch%near, scratch%sparse, right_sides(1, 2))
         exit
      end do

      if ((iterations > 1 .or. step > 0.0_wp) .and. ended /= ended_diverged) then
         do k = 1, n
            change = max(change, abs(unknowns(unknown(k))%value - scratch%start(k)))
         end do
      end if
      if (rows > n .and. moves) then
         if (iterations > 0) call record_closure_error(b, x, i, scratch%residuals, convergence)
         if (any(ended == [ended_converged, ended_stalled]) .and. &
            convergence%open%value > max(inconsistent_level*convergence%open%level, x%closing)) &
            ended = ended_inconsistent
      end if

      if (ended /= ended_converged) convergence%ended = ended
      convergence%iterations = max(convergence%iterations, iterations)
      convergence%residual = max(convergence%residual, residual)
      convergence%step = max(convergence%step, step)
      convergence%change = max(convergence%change, change)

      if (.not. any(ended == [ended_converged, ended_stalled])) then
         convergence%determinant = 0
         return
      end if
      if (moves .and. .not. singular) call certify_root()
      is_singular = singular
      jacobian%sign_of = sign_of
      convergence%determinant = convergence%determinant*sign_of
      convergence%singular = convergence%singular .or. singular
      if (singular) return
      if (moves) jacobian = jacobian_t(sign_of, least, bound)

      do k = 1, n
         unknowns(unknown(k))%rate = right_sides(k, 2)
      end do
      do k = block%first_loop, block%last_loop
         call acceleration_rows(loops(k), vectors, slides, unknowns, own, guide, now(k), right_sides)
      end do
      if (numbers%has_right_sides) call add_drives(block%first_row, block%last_row, equations, 2, values, right_sides)
      call solve_next_side(block%shape, a, scratch%pivots, scratch%work, scratch%near, scratch%sparse, right_sides)
      do k = 1, n
         unknowns(unknown(k))%acceleration = right_sides(k, 1)
      end do
      if (rows > n) convergence%rates_inconsistent = contradict_rates(b, i, values, unknowns, &
         right_sides, numbers%coarse, x%closing)

   contains

      !> Finds `sign_of`, `ratio`, `least`, `bound`, and in `singular` whether rounding leaves the velocities
      !> undetermined. Let B be |J^-1|, h the residual that rounding leaves, L the Lipschitz constant. The position is
      !> known to B h, the Jacobian to L B h, the velocities to B (L B h). Newton and Kantorovich: there is only one
      !> root if B L change is below 1/2.
      subroutine certify_root()
         real(wp) :: largest, inverse
         logical :: suspicious

         call pivot_range(block%shape, a, scratch%pivots, least, largest, sign_of, scratch%sparse)
         if (block%shape%pattern > 0) then
            ! No pivot of a large block tells how near the Jacobian is to having no inverse.
            inverse = inverse_norm(block%shape, a, scratch%pivots, scratch%work, scratch%iwork, scratch%sparse)
            least = 1.0_wp/inverse
         end if
         bound = 0.0_wp
         if (n == 0) least = 1.0_wp
         if (n == 0) return
         if (n == 1) largest = numbers%lipschitz
         ! All pivots may be small, if links are much shorter than the mechanism.
         suspicious = least < suspicious_pivot*max(largest, 1.0_wp)
         if (n > 2) then
            bound = 1.0_wp/max(least, min_inverse)
            ratio = change*numbers%lipschitz*bound
            if (.not. suspicious .and. ratio <= small_kantorovich_ratio .and. &
               excursion*numbers%lipschitz*bound**2*real(n, wp)**4 <= small_amplification) return
         end if

         if (block%shape%pattern == 0) inverse = inverse_norm(block%shape, a, scratch%pivots, scratch%work, &
            scratch%iwork, scratch%sparse)
         bound = min(inverse, 1.0_wp/min_inverse)
         ratio = change*numbers%lipschitz*inverse
         if (.not. suspicious) return
         size_of = max(numbers%coarse, maxval(abs(unknowns(unknown(:n))%value)))
         singular = inverse*inverse*numbers%lipschitz*rounding_level*size_of >= largest_velocity_error
         if (singular) singular = is_beyond_linear(b, x, i, n, unknowns, now, a, &
            scratch%pivots, scratch%work, scratch%sparse)
      end subroutine certify_root
   end subroutine solve_arrays

   !> Solves linear equations for another right-hand side from the factors.
   subroutine solve_next_side(shape, a, pivots, work, near, sparse, right_side)
      type(matrix_layout_t), intent(in) :: shape   !< the layout of the matrix
      real(wp), intent(in) :: a(*)                         !< the factors
      integer, intent(in) :: pivots(*)                     !< (n) of the factors
      real(wp), intent(inout) :: work(*)                   !< scratch
      type(nearby_t), intent(in) :: near                   !< the Jacobian, if the factors are those of a nearby one
      type(sparse_factors_t), intent(inout) :: sparse      !< of a sparse Jacobian
      real(wp), intent(inout) :: right_side(*)             !< (rows) then its first n are the solution

      if (near%distance > 0.0_wp) then
         call solve_nearby(near, right_side)
      else
         call solve_again(shape, a, pivots, work, right_side, sparse)
      end if
   end subroutine solve_next_side

   !> Gives the largest |number|, 0 of none. NaN if the last number is NaN; after another NaN only later numbers count.
   pure real(wp) function largest_size(n, numbers) result(largest)
      integer, intent(in) :: n                             !< how many numbers there are
      real(wp), intent(in) :: numbers(*)                   !< (n)
      integer :: k

      largest = 0.0_wp
      do k = 1, n
         if (.not. abs(numbers(k)) <= largest) largest = abs(numbers(k))
      end do
   end function largest_size

   !> Tells whether rounding leaves velocities undetermined, for blocks of rows and unknowns of very different sizes.
   !> The part of the rows beyond their linear part moves an unknown by too large a part of its uncertainty |J^-1| h.
   logical function is_beyond_linear(b, x, i, n, unknowns, now, a, pivots, work, sparse) result(is)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                             !< the number of the block
      integer, intent(in) :: n                             !< its unknowns
      type(unknown_t), intent(in) :: unknowns(0:b%unknowns)   !< with the position
      type(loop_state_t), intent(in) :: now(*)             !< (loops) at the position
      real(wp), intent(in) :: a(*)                         !< the factors of its Jacobian
      integer, intent(in) :: pivots(*)                     !< (n) of the factors
      real(wp), intent(inout) :: work(*)                   !< scratch
      type(sparse_factors_t), intent(inout) :: sparse      !< of a sparse Jacobian
      real(wp) :: off(n), more(n)

      associate (shape => b%list(i)%shape)
         call spread_by_inverse(shape, a, pivots, work, rounding_level*rounded_sizes(b, x, i, unknowns), off, sparse)
         call spread_by_inverse(shape, a, pivots, work, second_order_bounds(b, x, i, unknowns, now, off), more, sparse)
      end associate
      is = .not. all(more < largest_velocity_error*off)
   end function is_beyond_linear

   !> Tells whether the redundant equations of a block contradict its rates or accelerations. Their residuals are
   !> compared with the largest rate and acceleration of the angles, slides and drives in its equations.
   pure logical function contradict_rates(b, i, values, unknowns, left_over, coarse, closing) result(do)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i                             !< the number of the block
      real(wp), intent(in) :: values(0:2, 0:*)             !< (0:2, 0:drives) value, rate, acceleration of each drive
      type(unknown_t), intent(in) :: unknowns(0:b%unknowns)   !< with the motion
      real(wp), intent(in) :: left_over(b%list(i)%shape%rows, 2)   !< accelerations and rates, then their residuals
      real(wp), intent(in) :: coarse                       !< given part over own body vectors, 1 at least
      real(wp), intent(in) :: closing                      !< the closing tolerance (unit of the loop, rad)
      real(wp) :: largest(2)
      integer :: k

      largest = 0.0_wp
      do k = b%list(i)%first_row, b%list(i)%last_row
         largest = max(largest, abs(values(1:2, b%rows(k)%drive)))
      end do
      associate (terms => unknowns(known_to(b, i)), n => b%list(i)%shape%n)
         largest = max(largest, [maxval(abs(terms%rate)), maxval(abs(terms%acceleration))])
         do = contradict(left_over(n + 1:, 2), largest(1), coarse, closing) &
            .or. contradict(left_over(n + 1:, 1), max(largest(2), largest(1)**2), coarse, closing)
      end associate
   end function contradict_rates

   !> Gives the size (rows) of the largest number that each row of a block rounds, in the unit of its loop or rad.
   pure function rounded_sizes(b, x, i, unknowns) result(sizes)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                             !< the number of the block
      type(unknown_t), intent(in) :: unknowns(0:b%unknowns)   !< with the motion
      real(wp) :: sizes(b%list(i)%shape%rows), size_of
      integer :: m, k

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            size_of = max(x%loops(m)%coarse, abs(unknowns(g%orientation)%value), abs(unknowns(g%less)%value))
            do k = g%first_own, g%last_vector
               size_of = max(size_of, abs(unknowns(b%body_vectors(k)%orientation)%value))
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k))
                  size_of = max(size_of, abs(unknowns(slide%unknown)%value)*length_of(x%e(k)), &
                     abs(unknowns(slide%orientation)%value))
               end associate
            end do
            if (g%row_x > 0) sizes(g%row_x) = size_of
            if (g%row_y > 0) sizes(g%row_y) = size_of
         end associate
      end do
   end function rounded_sizes

   !> Bounds d . r'' d (rows), in the unit of the loop, for changes d of the unknowns of a block: twice the part of the
   !> rows r beyond their linear part. The direction of a projection may turn with an angle of the block.
   pure function second_order_bounds(b, x, i, unknowns, now, changes) result(bounds)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                             !< the number of the block
      type(unknown_t), intent(in) :: unknowns(0:b%unknowns)   !< at which the changes begin
      type(loop_state_t), intent(in) :: now(*)             !< (loops) at these unknowns
      real(wp), intent(in) :: changes(:)                   !< (n) none negative, in rad and the unit of the loop
      real(wp) :: bounds(b%list(i)%shape%rows), change(0:size(changes)), first, second
      integer :: m, k

      change = [0.0_wp, changes]
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            first = 0.0_wp
            second = 0.0_wp
            do k = g%first_own, g%last_vector
               associate (length => hypot(x%d(k)%x, x%d(k)%y), turn => change(b%body_vectors(k)%column))
                  first = first + length*turn
                  second = second + length*turn**2
               end associate
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k), turn => change(b%slides(k)%orientation_column), &
                  length => abs(unknowns(b%slides(k)%unknown)%value))
                  first = first + length_of(x%e(k))*(change(slide%column) + length*turn)
                  second = second + length_of(x%e(k))*turn*(2.0_wp*change(slide%column) + length*turn)
               end associate
            end do

            if (g%kind == loop_projection) then
               associate (turn => change(g%orientation_column))
                  second = second + turn*(2.0_wp*first + length_of(now(m)%closure_error)*turn)
               end associate
            end if
            if (g%row_x > 0) bounds(g%row_x) = second
            if (g%row_y > 0) bounds(g%row_y) = second
         end associate
      end do
   end function second_order_bounds
end module block_solver
