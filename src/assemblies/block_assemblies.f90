!> All real positions of one block, for given positions of earlier blocks. If its bilinear system has one unknown in
!> each group, the positions are found in closed form, otherwise as the ends of paths. Newton's method of the block
!> corrects each.
module block_assemblies
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use plane_vectors, only: pi, wrap_angle
   use convergence, only: solve_report_t, is_solved, ended_inconsistent
   use blocks, only: blocks_t, geometry_t, own_unknowns
   use block_state, only: state_t, set_values, values_of, add_turns
   use block_solver, only: workspace_t, solve_block
   use block_rank, only: gauss_newton_step, moving_unknowns
   use bilinear, only: path_start_t, path_end_t, ends_t, solve_quadratic, coarser_rounding
   use homotopy, only: follow_paths
   use block_bilinear, only: block_form_t, make_form
   implicit none
   private
   public :: block_positions_t, find_positions, max_group

   !> Unknowns of a group at most: C(12, 6) = 924 paths. Each further unknown takes almost four times as many.
   integer, parameter :: max_group = 6
   !> The two groups of a real solution are conjugate within this part: paths end with half of all digits at least.
   real(dp), parameter :: conjugate_tolerance = 8.0_dp*sqrt(coarser_rounding)
   !> Newton's method moves a real solution by no more (rad, unit of the loop).
   real(dp), parameter :: max_newton_move = sqrt(conjugate_tolerance)
   !> The two limits for singular solutions, of which rounding leaves fewer digits.
   real(dp), parameter :: singular_conjugate_tolerance = sqrt(conjugate_tolerance)
   real(dp), parameter :: max_singular_move = 10.0_dp*singular_conjugate_tolerance
   !> Positions that differ by less are one (rad, unit of the loop): regular ones, then singular ones.
   real(dp), parameter :: same_solution_tolerance = conjugate_tolerance
   real(dp), parameter :: same_singular_tolerance = max_singular_move
   !> Steps of Gauss and Newton towards a singular solution: near a double root each step halves the error.
   integer, parameter :: singular_steps = 6
   !> Redundant equations hold to this part of their terms: lengths have 11 digits, a double root half of all digits.
   real(dp), parameter :: redundant_tolerance = max(1.0e-6_dp, 16.0_dp*sqrt(coarser_rounding))
   !> With a closing tolerance the paths end at solutions of some of the equations. Newton's method moves these by up to
   !> this many times the tolerance.
   real(dp), parameter :: moves_per_closing = 100.0_dp
   !> Newton's method starts from multiples of 1/grid, 1.5E-8: ends of paths are known better.
   real(wp), parameter :: grid = 2.0_wp**26

   !> Positions of one block: those of the last search, and the counts and findings of all searches.
   !> paths = finite + infinite + failed + partial.
   type :: block_positions_t
      real(wp), allocatable :: x(:, :)          !< (unknowns of the block, positions) rad or unit of the loop
      integer, allocatable :: sign_of(:)        !< (positions) of the determinant; 0: singular
      logical, allocatable :: rates_inconsistent(:) !< (positions) redundant equations agree there, but not their rates
      integer :: paths = 0, finite = 0, infinite = 0, failed = 0   !< all; those with such ends
      integer :: partial = 0                    !< paths whose ends do not solve the redundant equations
      integer :: real = 0                       !< how many positions were found
      logical :: is_large = .false.             !< a group has too many unknowns: no search was made
      logical :: is_open = .false.              !< in some position redundant equations contradict one another's rates
      logical :: moves = .false.                !< some positions form a curve: the block can move with fixed drives
   end type block_positions_t

contains

   !> Finds all real positions of a block for given values of earlier blocks and drives. If the block is too large or
   !> lacks equations at these values, no position is found, and found%is_large or found%moves is true.
   subroutine find_positions(b, x, i, w, s, largest_group, start, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s      !< with the values of earlier blocks and drives; the block's own change
      integer, intent(in) :: largest_group   !< unknowns of a group at most, up to `max_group`
      !> The system with which paths begin, left by a search before; not allocated or of another p: random forms.
      type(path_start_t), allocatable, intent(inout) :: start
      type(block_positions_t), intent(inout) :: found   !< of the searches before; then also of this one
      type(solve_report_t) :: c
      type(block_form_t) :: f
      type(ends_t) :: ends
      real(dp) :: level
      logical :: moves
      integer :: j, k

      found%x = reshape([real(wp) ::], [b%list(i)%shape%n, 0])
      found%sign_of = [integer ::]
      found%rates_inconsistent = [logical ::]
      if (b%list(i)%explicit) then
         call solve_block(b, x, i, .true., w, s, c)
         found%x = reshape(values_of(b, i, s), [1, 1])
         found%sign_of = [1]
         found%rates_inconsistent = [.false.]
         return
      end if

      call make_form(b, x, i, s, f)
      found%is_large = found%is_large .or. f%system%p > largest_group
      found%moves = found%moves .or. f%is_lacking
      if (f%is_lacking .or. f%is_impossible .or. f%system%p > largest_group) return

      moves = .false.
      level = max(redundant_tolerance, sqrt(real(x%closing, dp)))
      if (f%system%p == 0) then
         ends = ends_t(paths=1, list=[path_end_t([(1.0_dp, 0.0_dp)], [(1.0_dp, 0.0_dp)])])
      else if (f%system%p == 1) then
         call solve_quadratic(f%system, ends, moves)
      else
         call follow_paths(f%system, start, ends)
      end if

      found%moves = found%moves .or. moves
      found%paths = found%paths + ends%paths
      found%infinite = found%infinite + ends%infinite
      found%failed = found%failed + ends%failed
      do k = 1, size(ends%list)
         associate (e => ends%list(k))
            if (all([(abs(sum(e%x*matmul(f%more(:, :, j), e%y))) <= level*maxval(abs(e%x))*maxval(abs(e%y)), &
               j=1, size(f%more, 3))])) then
               call add_position(e)
            else
               found%partial = found%partial + 1
            end if
         end associate
      end do
      found%finite = found%paths - (found%infinite + found%failed + found%partial)
      found%real = found%real + size(found%sign_of)
      found%is_open = found%is_open .or. any(found%rates_inconsistent)

   contains

      !> Adds the position of the block at a solution, if it is real and new; otherwise adds to the counts.
      subroutine add_position(ending)
         type(path_end_t), intent(in) :: ending   !< the solution
         type(solve_report_t) :: c
         real(wp) :: values(size(f%turns)), residual
         logical :: is_real
         integer :: k

         call real_values(f, ending, &
            merge(singular_conjugate_tolerance, conjugate_tolerance, ending%is_singular), values, is_real)
         ! A path that ends on a curve of solutions ends at any of its points, real or not.
         if (.not. is_real) found%moves = found%moves .or. ending%is_singular
         if (.not. is_real) return
         ! Reason for rounding: the digits of a position shall not show from which start its path came.
         values = anint(grid*values)/grid

         ! An angle of half a turn becomes positive, whatever sign rounding has left.
         where (f%turns < 0 .and. values <= anint(-grid*pi)/grid) values = -values
         call set_values(b, i, values, s)
         call add_turns(b, x, i, s)
         values = values_of(b, i, s)
         ! Near a singular solution Newton's method by itself may go astray.
         do k = 1, merge(singular_steps, 0, ending%is_singular)
            call gauss_newton_step(b, x, i, s, residual)
         end do

         call solve_block(b, x, i, .true., w, s, c)
         if (c%ended == ended_inconsistent) then
            found%partial = found%partial + 1
            return
         end if
         if (.not. is_solved(c) .or. largest_difference(values_of(b, i, s), values) > &
            merge(max_singular_move, max_newton_move, ending%is_singular) + moves_per_closing*x%closing) then
            found%failed = found%failed + 1
            return
         end if

         values = values_of(b, i, s)
         do k = 1, size(found%x, 2)
            if (largest_difference(values, found%x(:, k)) <= merge(same_singular_tolerance, same_solution_tolerance, &
               ending%is_singular .or. c%singular)) return
         end do
         found%x = reshape([found%x, values], [size(values), size(found%x, 2) + 1])
         found%sign_of = [found%sign_of, merge(0, c%determinant, c%singular)]
         found%rates_inconsistent = [found%rates_inconsistent, c%rates_inconsistent]
         if (c%singular) found%moves = found%moves .or. any(moving_unknowns(b, x, i, s))
      end subroutine add_position

      !> Gives the largest difference of two positions of the block, in rad or the unit of the loop; angles without
      !> whole turns.
      pure real(wp) function largest_difference(first, second)
         real(wp), intent(in) :: first(:), second(:)   !< (unknowns of the block) rad or unit of the loop

         largest_difference = maxval(merge(abs(wrap_angle(first - second)), abs(first - second), &
            own_unknowns(b, i) <= b%orientations))
      end function largest_difference
   end subroutine find_positions

   !> Finds the unknowns of a block at a solution of its system, and tells whether they are real. If they are not, the
   !> values are those of the mean of the solution and its conjugate.
   subroutine real_values(form, ending, level, values, is_real)
      type(block_form_t), intent(in) :: form   !< of the block
      type(path_end_t), intent(in) :: ending   !< the solution
      real(dp), intent(in) :: level          !< part of the largest unknown by which the groups may fail to be conjugate
      real(wp), intent(out) :: values(:)     !< (n) rad or unit of the loop
      logical, intent(out) :: is_real        !< the two groups are conjugate
      complex(dp) :: w(0:size(form%turns)), v(0:size(form%turns))
      integer :: k

      w = matmul(form%basis, ending%x)
      v = matmul(conjg(form%basis), ending%y)
      w = w/w(0)
      v = conjg(v/v(0))
      is_real = maxval(abs(w - v)) <= level*maxval(abs(w))
      w = 0.5_dp*(w + v)
      do k = 1, size(values)
         if (form%turns(k) < 0) then
            values(k) = real(atan2(aimag(w(k)), real(w(k))), wp)
         else
            values(k) = real(w(k)*conjg(w(form%turns(k))), wp)
         end if
      end do
   end subroutine real_values
end module block_assemblies
