!> Level 8. The position of a block at the first instant, from the deck's rough one: Newton's method where that
!> stays near; where it leaps or fails, the block is first brought near its closure. A good start is never made
!> worse: what Newton's method alone has found stands where nothing nearer is found.
module first_position
   use kinds, only: wp
   use convergence, only: convergence_t, is_solved
   use blocks, only: blocks_t
   use block_state, only: state_t, set_values
   use block_solver, only: workspace_t, solve_block
   use block_assembly, only: approach
   implicit none
   private
   public :: solve_first_block, has_second_position

   !> A change of more than this, in radians or characteristic lengths, is a leap.
   real(wp), parameter :: leap = 0.5_wp
   !> So far other starts are away from the rough position.
   real(wp), parameter :: aside = 0.8_wp
   !> A position that is this many times as far counts as about as near.
   real(wp), parameter :: nearly = 1.25_wp
   !> Up to so many unknowns other starts are tried.
   integer, parameter :: most_unknowns = 4

contains

   !> Solves block `i` as `solve_block` does, from near or far.
   subroutine solve_first_block(b, i, tolerance, w, s, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: tolerance
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(convergence_t), intent(inout) :: c
      type(convergence_t) :: nearest
      real(wp) :: change
      real(wp), allocatable :: start(:), newton(:)
      logical :: reached

      start = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
      change = 0.0_wp
      call solve_block(b, i, tolerance, w, s, c, change)
      if (b%list(i)%direct .or. (is_solved(c) .and. change <= leap)) return
      if (is_solved(c)) newton = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
      call set_values(b, i, start, s)
      nearest = c
      call approach(b, i, s, nearest, reached)
      call solve_block(b, i, tolerance, w, s, c, change)
      if (is_solved(c)) return
      if (allocated(newton)) then
         call set_values(b, i, newton, s)
         call solve_block(b, i, tolerance, w, s, c, change)
      else if (.not. reached) then
         c%gap = nearest%gap
         c%gap_is_angle = nearest%gap_is_angle
         c%open_pair = nearest%open_pair
         c%open_drive = nearest%open_drive
      end if
   end subroutine solve_first_block

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
      if (size(start) == 0 .or. size(start) > most_unknowns .or. b%list(i)%direct) return
      found = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
      if (maxval(abs(found - start)) < 0.1_wp) return
      other = s
      do k = 1, 2*size(start)
         x = start
         x((k + 1)/2) = x((k + 1)/2) + merge(aside, -aside, mod(k, 2) == 1)
         call set_values(b, i, x, other)
         change = 0.0_wp
         call solve_block(b, i, tolerance, w, other, c, change)
         if (.not. is_solved(c)) cycle
         x = other%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
         has = maxval(abs(x - found)) > 1.0e-3_wp .and. norm2(x - start) < nearly*norm2(found - start)
         if (has) return
      end do
   end function has_second_position
end module first_position
