!> METHOD DENSE and METHOD MATRIX: one instant by all closure equations at once, with x, y, phi of every link as
!> unknowns. This is the form of the paper, by Newton's method or by the iteration of 1987. Positions, velocities and
!> accelerations are solutions of the full systems (16), (21) and (22). The blocks give the initial guess, and check
!> whether the iteration ends at their position; no number of the blocks is printed.
!>
!> An iteration that fails, or ends at another position, begins again eight times nearer, as the prediction of half a
!> step would. If the Jacobian has no inverse, links that only drives move have the rates of the drives.
module dense_method
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_matrix, own_predictor
   use motion, only: motion_t, new_motion
   use linear_solver, only: factors_t, new_factors, solve_factored => solve
   use block_matrix, only: matrix_layout_t, pivot_range
   use convergence, only: solve_report_t, is_solved, ended_elsewhere
   use drive_path, only: drive_path_t
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t
   use predictor, only: history_t, order_weights, recall
   use link_motion, only: move_links
   use configuration, only: system_t, configuration_t, new_system, new_configuration, add_to_links
   use closure_equations, only: find_drive_values, remainder
   use position_iteration, only: solve_position
   implicit none
   private
   public :: dense_t, make_dense, solve_all_links

   !> A change over the distance of the next root: below this part no other root is as near (Newton and Kantorovich).
   real(wp), parameter :: certain_part = 0.5_wp
   !> The position of a singular Jacobian is known to the root of eps; a root this near, in rad or characteristic
   !> lengths, is that position.
   real(wp), parameter :: same_singular_position = min(1.0e4_wp*sqrt(epsilon(1.0_wp)), 1.0e-2_wp)
   !> Initial guesses that are tried, each nearer to the blocks' position than the one before by the factor below.
   integer, parameter :: max_starts = 4
   !> The error of a prediction goes with the cube of the step: that of half a step is 8 times smaller.
   real(wp), parameter :: nearer_each_start = 8.0_wp
   !> The predictor of the paper: the position before, with its velocities and accelerations.
   integer, parameter :: order_of_paper = 2

   !> The closure equations of a mechanism and their solver, lengths in the system's unit.
   type :: dense_t
      type(system_t) :: system                    !< the equations
      integer :: method = 0                       !< method_dense or method_matrix
      integer :: order = order_of_paper           !< of the predictor, 0 to 2
      real(wp) :: tolerance = 0.0_wp              !< relative; 0: the limit of rounding
      real(wp), allocatable :: drive_values(:, :) !< (3, drives) value, rate, acceleration
      type(configuration_t) :: configuration      !< the last iterate
      type(factors_t) :: factors                  !< of the last matrix
   end type dense_t

contains

   !> Makes the closure equations of a mechanism, with its method, tolerance and predictor, ready for its first instant.
   subroutine make_dense(dense, m)
      type(dense_t), intent(out) :: dense   !< of the mechanism
      type(mechanism_t), intent(in) :: m          !< with as many equations as unknowns

      dense%system = new_system(m)
      dense%method = m%method
      if (m%predictor /= own_predictor) dense%order = min(m%predictor, order_of_paper)
      dense%tolerance = m%tolerance
      dense%configuration = new_configuration(dense%system, m)
      dense%factors = new_factors(dense%system%n)
      allocate (dense%drive_values(3, size(m%drives)))
   end subroutine make_dense

   !> Solves for the motion of all links at a time at which the blocks have found a motion. If no initial guess leads to
   !> the position of the blocks, `found` has only the blocks' motion of the links that requests need.
   subroutine solve_all_links(dense, b, x, path, estimated, history, s, found, convergence)
      type(dense_t), intent(inout) :: dense   !< of the mechanism
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      real(wp), intent(in) :: estimated(0:)       !< (0:unknowns) the initial guess of the deck, rad or unit of the loop
      type(history_t), intent(in) :: history      !< the motions before; empty: the guess of the deck is the first
      type(state_t), intent(in) :: s              !< the motion that the blocks have found
      type(motion_t), intent(inout) :: found      !< (links) at the time found%t, in the deck's units
      !> Of the iteration that found the position, or of the first one if all failed; iterations are those of all. If it
      !> is singular, the velocities are those of the blocks.
      type(solve_report_t), intent(out) :: convergence
      type(solve_report_t) :: first
      real(wp), dimension(3, size(found%position, 2)) :: there, start
      type(motion_t) :: before
      type(state_t) :: latest
      real(wp) :: w(3), v(dense%system%n), least, largest
      logical :: finite
      integer :: k, iterations

      iterations = 0
      call find_drive_values(dense%system, path, found%t, dense%drive_values)
      call move_links(x%chain, x%chain%wanted, s, found, finite)
      there = found%position
      there(:2, :) = there(:2, :)/dense%system%length

      ! The first guess is the latest position of the blocks, predicted with its velocities and accelerations; before
      ! the first motion the deck's estimate.
      latest = s
      call recall(b, x, path, history, estimated, latest)
      before = new_motion(size(there, 2))
      call move_links(x%chain, size(x%chain%links), latest, before, finite)
      w = 0.0_wp
      if (history%filled > 0) w = order_weights(dense%order, found%t - history%t(0), 0.0_wp)
      start = before%position + w(1)*before%velocity + w(2)*before%acceleration
      start(:2, :) = start(:2, :)/dense%system%length

      do k = 1, max_starts
         dense%configuration%q = start
         call solve_position(dense%system, dense%drive_values(1, :), dense%tolerance, dense%method == method_matrix, &
            dense%configuration, dense%factors, convergence)
         if (is_solved(convergence) .and. .not. convergence%singular) then
            call pivot_range(matrix_layout_t(dense%system%n, dense%system%n), dense%factors%a, dense%factors%pivots, &
               least, largest, convergence%determinant)
            convergence%min_pivot = least/max(largest, least)
         end if

         iterations = iterations + convergence%iterations
         if (is_solved(convergence)) then
            if (.not. is_found_by_blocks(dense, b, x, s, there)) convergence%ended = ended_elsewhere
         end if
         if (is_solved(convergence)) exit
         if (k == 1) first = convergence
         start = there + (start - there)/nearer_each_start
      end do
      if (.not. is_solved(convergence)) convergence = first
      convergence%iterations = iterations
      if (.not. is_solved(convergence)) return

      convergence%singular = convergence%singular .or. any(s%is_singular(b%needed))
      found%position = dense%configuration%q
      if (.not. convergence%singular) then
         ! J v = f' (21), with the dependence of A' on the unknown velocities moved to the left, and
         ! J a = f'' - gamma(q, v) (22), gamma the acceleration remainder; f' and f'' are zero in the rows of pairs.
         associate (all => dense%system, first_drive => dense%system%n - size(dense%drive_values, 2) + 1)
            v = 0.0_wp
            v(first_drive:) = dense%drive_values(2, :)
            call solve_factored(dense%factors, v)
            found%velocity = 0.0_wp
            call add_to_links(all, v, found%velocity)

            call remainder(all, dense%configuration, found%velocity, v)
            v = -v
            v(first_drive:) = v(first_drive:) + dense%drive_values(3, :)
            call solve_factored(dense%factors, v)
            found%acceleration = 0.0_wp
            call add_to_links(all, v, found%acceleration)
         end associate
         found%velocity(:2, :) = dense%system%length*found%velocity(:2, :)
         found%acceleration(:2, :) = dense%system%length*found%acceleration(:2, :)
      end if
      found%position(:2, :) = dense%system%length*found%position(:2, :)
   end subroutine solve_all_links

   !> Tells whether the position of the dense method is the position that the blocks have found: no other root is as
   !> near to the blocks' position (Newton and Kantorovich).
   pure logical function is_found_by_blocks(dense, b, x, s, there) result(is)
      type(dense_t), intent(in) :: dense          !< with the position in its configuration
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s              !< the motion that the blocks have found
      real(wp), intent(in) :: there(:, :)         !< (3, links) x, y, phi of the blocks' position, system's unit and rad
      real(wp) :: off(3, size(there, 2)), largest
      integer :: k

      off = abs(dense%configuration%q - there)
      off(:2, :) = off(:2, :)*(dense%system%length/x%span)
      largest = maxval(off)
      is = .true.
      do k = 1, size(b%needed)
         associate (i => b%needed(k))
            if (s%is_singular(i)) then
               is = is .and. largest <= same_singular_position
            else
               is = is .and. largest*x%blocks(i)%lipschitz*s%jacobian(i)%inverse <= certain_part
            end if
         end associate
      end do
   end function is_found_by_blocks
end module dense_method
