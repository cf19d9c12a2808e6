!> The position of a block at the first instant, from the deck's estimate: Newton's method where that stays near;
!> where it jumps to another branch or fails, the block is first brought near its closure. A good estimate is never
!> made worse: what Newton's method alone has found stands where nothing nearer is found.
module first_position
   use kinds, only: wp
   use convergence, only: convergence_t, is_solved
   use planar, only: without_turns
   use blocks, only: blocks_t, loop_angles
   use block_state, only: state_t, set_values, values_of
   use block_solver, only: workspace_t, solve_block
   use levenberg_marquardt, only: levenberg_marquardt_solve, levenberg_marquardt_held
   use position_path, only: follow_path, cross_fold
   implicit none
   private
   public :: solve_first_block, remove_turns, has_second_position, farthest

   !> A change of more than this, in radians or characteristic lengths, is a jump to another branch.
   real(wp), parameter :: branch_jump = 0.5_wp
   !> A residual of this size is near enough for Newton's method; below the other there is nothing to correct.
   real(wp), parameter :: near = max(1.0e-6_wp, 64.0_wp*epsilon(1.0_wp))
   real(wp), parameter :: closed = max(1.0e-15_wp, 4.0_wp*epsilon(1.0_wp))
   !> Other starts differ from the estimate by this, in one unknown.
   real(wp), parameter :: aside = 0.8_wp
   !> A position that is this many times as far counts as about as near, unless the estimate is as good as `close`.
   real(wp), parameter :: nearly = 1.25_wp, close = 0.1_wp
   !> A position is not meant that is more than so many times as far as the nearest, and further than twice the errors
   !> of an estimate that is good to 3 degrees and 3 per cent; unless the estimate is better than `fine`, or no other
   !> position closes what is built on it.
   real(wp), parameter :: plausible = 3.0_wp, reach = 0.1_wp, fine = 1.0e-4_wp
   !> Positions that differ by less are the same one; those that `has_second_position` compares differ by more.
   real(wp), parameter :: alike = max(1.0e-8_wp, sqrt(epsilon(1.0_wp))), distinct = 1.0e-3_wp
   integer, parameter :: max_rounds = 4
   !> Up to so many unknowns other starts are tried.
   integer, parameter :: max_unknowns = 4

contains

   !> Solves block `i` as `solve_block` does, from any estimate in the values of `s`: the position that is nearest to
   !> it. `others` (unknowns, any number): what else was found, nearest first; not allocated where the position is
   !> certain to be the nearest.
   subroutine solve_first_block(b, i, tolerance, w, s, c, others)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      real(wp), allocatable, intent(out), optional :: others(:, :)
      real(wp) :: start(b%list(i)%last - b%list(i)%first + 1)
      real(wp), allocatable :: found(:, :)              ! (n, any number), nearest to the start first
      logical :: is_near

      start = values_of(b, i, s)
      call solve_block(b, i, tolerance, w, s, c)
      if (b%list(i)%direct .or. is_certain(c)) return
      allocate (found(size(start), 0))
      call note_position(c)
      call set_values(b, i, start, s)
      call follow_path(b, i, w, s)
      call solve_from_here()
      call set_values(b, i, start, s)
      call levenberg_marquardt_held(b, i, near, s)
      call solve_from_here()
      call look_aside()
      call set_values(b, i, start, s)
      is_near = size(found, 2) > 0
      if (is_near) is_near = maxval(abs(found(:, 1) - start)) <= branch_jump
      if (.not. is_near) then
         call come_near(b, i, tolerance, w, s, c)
         call note_position(c)
      end if
      call look_across()
      if (size(found, 2) == 0) return
      call set_values(b, i, found(:, 1), s)
      call solve_block(b, i, tolerance, w, s, c)
      if (present(others)) others = found(:, 2:)

   contains

      !> Solves the block from the values of `s`, and notes what was found.
      subroutine solve_from_here()
         type(convergence_t) :: c

         call solve_block(b, i, tolerance, w, s, c)
         call note_position(c)
      end subroutine solve_from_here

      !> Newton's method and the descent may both pass the position that is nearest to a distant start: others are
      !> looked for from around it.
      subroutine look_aside()
         integer :: k

         if (size(start) > max_unknowns) return
         do k = 1, 2*size(start)
            call set_values(b, i, beside(start, k), s)
            call solve_from_here()
         end do
      end subroutine look_aside

      !> Near a fold positions come in pairs: the other one of each that was found, until there is no nearer one.
      subroutine look_across()
         real(wp) :: from(size(start))
         logical :: is_there
         integer :: round, number

         do round = 1, max_rounds
            if (size(found, 2) == 0) return
            from = found(:, 1)
            do number = 1, 2
               call set_values(b, i, from, s)
               call cross_fold(b, i, number, w, s, is_there)
               if (is_there) call solve_from_here()
            end do
            if (maxval(abs(found(:, 1) - from)) <= 0.0_wp) return
         end do
      end subroutine look_across

      !> Puts the position of `s`, if `c` says that it is one, in its place among those found, unless it is there
      !> already; without the whole turns by which its angles have passed the start, where no equation counts them.
      subroutine note_position(c)
         type(convergence_t), intent(in) :: c
         real(wp) :: x(size(start))
         integer :: k, first

         if (.not. is_solved(c)) return
         x = values_of(b, i, s)
         associate (block => b%list(i))
            if (all(b%loops(block%first_loop:block%last_loop)%kind /= loop_angles)) then
               where (b%unknown(block%first:block%last) <= b%orientations) x = start + without_turns(x - start)
            end if
         end associate
         do k = 1, size(found, 2)
            if (maxval(abs(found(:, k) - x)) <= alike*max(1.0_wp, maxval(abs(x)))) return
         end do
         do k = 1, size(found, 2)
            if (norm2(x - start) < 0.999_wp*norm2(found(:, k) - start)) exit
            ! Of two mirror images, as at a dead point, that with the greater first angle: rounding shall not choose.
            if (norm2((x - start) + (found(:, k) - start)) > distinct*norm2(x - start)) cycle
            first = findloc(abs(x - start) > distinct*norm2(x - start), .true., dim=1)
            if (x(first) > found(first, k)) exit
         end do
         found = reshape([found(:, :k - 1), x, found(:, k:)], [size(x), size(found, 2) + 1])
      end subroutine note_position
   end subroutine solve_first_block

   !> No other position can be meant: two of them are at least 2/(|J^-1| Lipschitz constant) apart.
   pure logical function is_certain(c)
      type(convergence_t), intent(in) :: c

      is_certain = is_solved(c) .and. c%change <= branch_jump .and. &
         c%kantorovich_ratio*(c%change + farthest(c%change)) <= 2.0_wp*c%change
   end function is_certain

   !> How far from the estimate a position may be that is meant, where the `nearest` is so far from it.
   pure real(wp) function farthest(nearest)
      real(wp), intent(in) :: nearest

      farthest = plausible*nearest
      if (nearest > fine) farthest = max(farthest, reach)
   end function farthest

   !> Takes whole turns off the `estimated` angles (0:unknowns) of the blocks `list`, where a drive with a value of
   !> `drive_value` (0:drives) fixes them: they close nothing, and would have to be travelled.
   pure subroutine remove_turns(b, list, drive_value, estimated)
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
               associate (g => b%loops(m))
                  if (g%kind /= loop_angles .or. g%orientation > b%orientations .or. g%orientation_column == 0) cycle
                  associate (row => block%first_row + g%row_x - 1)
                     off = estimated(g%orientation) - estimated(g%less) - b%numbers%rows(row)%constant &
                        - drive_value(b%rows(row)%drive)
                  end associate
                  estimated(g%orientation) = estimated(g%orientation) - (off - without_turns(off))
               end associate
            end do
         end associate
      end do
   end subroutine remove_turns

   !> Solves block `i` from where it is nearly closed, or gives in `c` the closure error that remains.
   subroutine come_near(b, i, tolerance, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      type(convergence_t) :: nearest
      real(wp), allocatable :: nearly_closed(:)
      logical :: reached

      nearest = c
      call levenberg_marquardt_solve(b, i, near, s, nearest, reached)
      nearly_closed = values_of(b, i, s)
      call solve_block(b, i, tolerance, w, s, c)
      if (is_solved(c)) return
      if (reached) then
         ! Close to a limit, and perhaps beyond it.
         call set_values(b, i, nearly_closed, s)
         call levenberg_marquardt_solve(b, i, closed, s, nearest, reached)
         call solve_block(b, i, tolerance, w, s, c)
         if (is_solved(c) .or. reached) return
      end if
      c%open = nearest%open
   end subroutine come_near

   !> Start number `k` around `start`.
   pure function beside(start, k) result(x)
      real(wp), intent(in) :: start(:)
      integer, intent(in) :: k
      real(wp) :: x(size(start))

      x = start
      x((k + 1)/2) = x((k + 1)/2) + merge(aside, -aside, mod(k, 2) == 1)
   end function beside

   !> Block `i`, solved in `s`, has another position that is hardly further from the estimate `start`.
   logical function has_second_position(b, i, tolerance, start, w, s) result(has)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance, start(:)
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(in) :: s
      type(state_t) :: other
      type(convergence_t) :: c
      real(wp) :: x(size(start)), found(size(start))
      integer :: k

      has = .false.
      if (size(start) == 0 .or. size(start) > max_unknowns .or. b%list(i)%direct) return
      found = values_of(b, i, s)
      if (maxval(abs(found - start)) < close) return
      other = s
      do k = 1, 2*size(start)
         call set_values(b, i, beside(start, k), other)
         call solve_block(b, i, tolerance, w, other, c)
         if (.not. is_solved(c)) cycle
         x = values_of(b, i, other)
         has = maxval(abs(x - found)) > distinct .and. norm2(x - start) < nearly*norm2(found - start)
         if (has) return
      end do
   end function has_second_position
end module first_position
