!> The position of a block at the first instant, from the deck's rough one: Newton's method where that
!> stays near; where it leaps or fails, the block is first brought near its closure. A good start is never made
!> worse: what Newton's method alone has found stands where nothing nearer is found.
module first_position
   use kinds, only: wp
   use convergence, only: convergence_t, is_solved, take_closure_error
   use constants, only: without_turns
   use blocks, only: blocks_t, loop_angles
   use block_state, only: state_t, set_values
   use block_solver, only: workspace_t, solve_block
   use levenberg_marquardt, only: levenberg_marquardt_solve, levenberg_marquardt_held
   use position_path, only: follow_path, cross_fold
   implicit none
   private
   public :: solve_first_block, turn_starts, has_second_position, farthest

   !> A change of more than this, in radians or characteristic lengths, is a leap.
   real(wp), parameter :: branch_jump = 0.5_wp
   !> A residual of this size is near enough for Newton's method; below the other there is nothing to correct.
   real(wp), parameter :: near = max(1.0e-6_wp, 64.0_wp*epsilon(1.0_wp))
   real(wp), parameter :: closed = max(1.0e-15_wp, 4.0_wp*epsilon(1.0_wp))
   !> So far other starts are away from the rough position.
   real(wp), parameter :: aside = 0.8_wp
   !> A position that is this many times as far counts as about as near.
   real(wp), parameter :: nearly = 1.25_wp
   !> A position is not meant that is more than so many times as far as the nearest, and further than twice the errors
   !> of an estimate that is good to 3 degrees and 3 per cent; unless the estimate is better than `fine`, or no other
   !> position closes what is built on it.
   real(wp), parameter :: plausible = 3.0_wp, reach = 0.1_wp, fine = 1.0e-4_wp
   !> Positions that differ by less are the same one.
   real(wp), parameter :: alike = max(1.0e-8_wp, sqrt(epsilon(1.0_wp)))
   integer, parameter :: max_rounds = 4
   !> Up to so many unknowns other starts are tried.
   integer, parameter :: max_unknowns = 4

contains

   !> Solves block `i` as `solve_block` does, from near or far: the position that is the nearest to the initial
   !> estimate. `others` (unknowns, any number): what else was found, nearest first; not allocated where the position is
   !> certain to be the nearest.
   subroutine solve_first_block(b, i, tolerance, w, s, c, others)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      real(wp), allocatable, intent(out), optional :: others(:, :)
      real(wp) :: change
      real(wp), allocatable :: start(:), found(:, :)

      start = values_of(b, i, s)
      change = 0.0_wp
      call solve_block(b, i, tolerance, w, s, c, change)
      if (b%list(i)%direct .or. is_certain(c)) return
      allocate (found(size(start), 0))
      call note_position(b, i, start, s, c, found)
      call set_values(b, i, start, s)
      call follow_path(b, i, w, s)
      call solve_from_here(b, i, tolerance, start, w, s, found)
      call set_values(b, i, start, s)
      call levenberg_marquardt_held(b, i, near, s)
      call solve_from_here(b, i, tolerance, start, w, s, found)
      call look_aside(b, i, tolerance, start, w, s, found)
      call set_values(b, i, start, s)
      if (is_branch_jump(start, found)) then
         call come_near(b, i, tolerance, w, s, c)
         call note_position(b, i, start, s, c, found)
      end if
      call look_across(b, i, tolerance, start, w, s, found)
      if (size(found, 2) == 0) return
      call set_values(b, i, found(:, 1), s)
      call solve_block(b, i, tolerance, w, s, c, change)
      if (present(others)) others = found(:, 2:)
   end subroutine solve_first_block

   !> No other position can be meant: of two, 2/(|J^-1| bend) at least is between them.
   pure logical function is_certain(c)
      type(convergence_t), intent(in) :: c

      is_certain = is_solved(c) .and. c%change <= branch_jump .and. c%kantorovich_ratio*(c%change &
         + farthest(c%change)) <= 2.0_wp*c%change
   end function is_certain

   !> How far off a position may be that is meant, where the nearest is so far off.
   pure real(wp) function farthest(nearest)
      real(wp), intent(in) :: nearest

      farthest = plausible*nearest
      if (nearest > fine) farthest = max(farthest, reach)
   end function farthest

   !> Nothing was `found` within reach of `start`.
   pure logical function is_branch_jump(start, found)
      real(wp), intent(in) :: start(:), found(:, :)

      is_branch_jump = .true.
      if (size(found, 2) > 0) is_branch_jump = maxval(abs(found(:, 1) - start)) > branch_jump
   end function is_branch_jump

   !> Solves block `i` from the values of `s`, and notes what was found.
   subroutine solve_from_here(b, i, tolerance, start, w, s, found)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance, start(:)
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      real(wp), allocatable, intent(inout) :: found(:, :)
      type(convergence_t) :: c
      real(wp) :: change

      change = 0.0_wp
      call solve_block(b, i, tolerance, w, s, c, change)
      call note_position(b, i, start, s, c, found)
   end subroutine solve_from_here

   !> The other position of each pair that was found, until there is no nearer one.
   subroutine look_across(b, i, tolerance, start, w, s, found)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance, start(:)
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      real(wp), allocatable, intent(inout) :: found(:, :)
      real(wp), allocatable :: from(:)
      logical :: is_there
      integer :: round, number

      do round = 1, max_rounds
         if (size(found, 2) == 0) return
         from = found(:, 1)
         do number = 1, 2
            call set_values(b, i, from, s)
            call cross_fold(b, i, number, w, s, is_there)
            if (.not. is_there) cycle
            call solve_from_here(b, i, tolerance, start, w, s, found)
         end do
         if (maxval(abs(found(:, 1) - from)) <= 0.0_wp) return
      end do
   end subroutine look_across

   !> Puts a position in its place among those `found`, nearest to `start` first, unless it is there already.
   pure subroutine note_position(b, i, start, s, c, found)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: start(:)
      type(state_t), intent(in) :: s
      type(convergence_t), intent(in) :: c
      real(wp), allocatable, intent(inout) :: found(:, :)
      real(wp) :: x(size(start))
      integer :: k

      if (.not. is_solved(c)) return
      x = values_of(b, i, s)
      call turn_back(b, i, start, x)
      do k = 1, size(found, 2)
         if (maxval(abs(found(:, k) - x)) <= alike*max(1.0_wp, maxval(abs(x)))) return
      end do
      do k = 1, size(found, 2)
         if (norm2(x - start) < 0.999_wp*norm2(found(:, k) - start)) exit
      end do
      found = reshape([found(:, :k - 1), x, found(:, k:)], [size(x), size(found, 2) + 1])
   end subroutine note_position

   !> Takes whole turns off the rough values of angles that the blocks `list` seek, where a drive with one of the values
   !> `drive_value` (0:drives) asks for them: they close nothing, and would be a way to go.
   pure subroutine turn_starts(b, list, drive_value, estimated)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)
      real(wp), intent(in) :: drive_value(0:)
      real(wp), intent(inout) :: estimated(0:)
      real(wp) :: off
      integer :: k, m

      do k = 1, size(list)
         associate (block => b%list(list(k)))
            if (block%direct) cycle
            do m = block%first_loop, block%last_loop
               if (b%loops(m)%kind /= loop_angles .or. b%loops(m)%orientation > b%orientations) cycle
               associate (g => b%loops(m), row => b%rows(block%first_row + b%loops(m)%row_x - 1))
                  off = estimated(g%orientation) - estimated(g%less) - row%constant - drive_value(row%drive)
                  if (g%orientation_column > 0) estimated(g%orientation) = estimated(g%orientation) - (off &
                     - without_turns(off))
               end associate
            end do
         end associate
      end do
   end subroutine turn_starts

   !> Solves block `i` from where it is nearly closed, or tells how far it stays open.
   subroutine come_near(b, i, tolerance, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      type(convergence_t) :: nearest
      real(wp), allocatable :: brought(:)
      real(wp) :: change
      logical :: reached

      change = 0.0_wp
      nearest = c
      call levenberg_marquardt_solve(b, i, near, s, nearest, reached)
      brought = values_of(b, i, s)
      call solve_block(b, i, tolerance, w, s, c, change)
      if (is_solved(c)) return
      if (reached) then
         ! Close to a limit, and perhaps beyond it.
         call set_values(b, i, brought, s)
         call levenberg_marquardt_solve(b, i, closed, s, nearest, reached)
         call solve_block(b, i, tolerance, w, s, c, change)
         if (is_solved(c) .or. reached) return
      end if
      call take_closure_error(nearest, c)
   end subroutine come_near

   !> Takes the whole turns off the angles of `x` by which they have passed `start`, where no equation counts them.
   pure subroutine turn_back(b, i, start, x)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: start(:)
      real(wp), intent(inout) :: x(:)

      associate (block => b%list(i))
         if (any(b%loops(block%first_loop:block%last_loop)%kind == loop_angles)) return
         where (b%unknown(block%first:block%last) <= b%orientations) x = start + without_turns(x - start)
      end associate
   end subroutine turn_back

   !> From a far start Newton's method and the descent may both pass the position that is the nearest: others are looked
   !> for around the start.
   subroutine look_aside(b, i, tolerance, start, w, s, found)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance, start(:)
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      real(wp), allocatable, intent(inout) :: found(:, :)
      integer :: k

      if (size(start) > max_unknowns) return
      do k = 1, 2*size(start)
         call set_values(b, i, beside(start, k), s)
         call solve_from_here(b, i, tolerance, start, w, s, found)
      end do
   end subroutine look_aside

   !> Start number `k` around `start`.
   pure function beside(start, k) result(x)
      real(wp), intent(in) :: start(:)
      integer, intent(in) :: k
      real(wp) :: x(size(start))

      x = start
      x((k + 1)/2) = x((k + 1)/2) + merge(aside, -aside, mod(k, 2) == 1)
   end function beside

   pure function values_of(b, i, s) result(x)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp), allocatable :: x(:)

      x = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
   end function values_of

   !> Block `i`, solved in `s`, has another position that is hardly further from the rough one `start`.
   logical function has_second_position(b, i, tolerance, start, w, s) result(has)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance, start(:)
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(in) :: s
      type(state_t) :: other
      type(convergence_t) :: c
      real(wp) :: x(size(start)), found(size(start)), change
      integer :: k

      has = .false.
      if (size(start) == 0 .or. size(start) > max_unknowns .or. b%list(i)%direct) return
      found = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
      if (maxval(abs(found - start)) < 0.1_wp) return
      other = s
      do k = 1, 2*size(start)
         call set_values(b, i, beside(start, k), other)
         change = 0.0_wp
         call solve_block(b, i, tolerance, w, other, c, change)
         if (.not. is_solved(c)) cycle
         x = other%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
         has = maxval(abs(x - found)) > 1.0e-3_wp .and. norm2(x - start) < nearly*norm2(found - start)
         if (has) return
      end do
   end function has_second_position
end module first_position
