!> The assembly that belongs to a deck's initial estimate, where the blocks one by one leave a choice. A block
!> takes its nearest position; but two may be about as near, and only what is built on it shows which one is meant:
!> its child links lie as the deck says, or do not close at all. So the others are tried as well, and the
!> rest assembled again.
!>
!> All blocks are asked, also those that no table needs: what is printed chooses no assembly.
module assembly_choice
   use kinds, only: wp
   use convergence, only: convergence_t, is_solved
   use motion, only: motion_t, new_motion
   use planar, only: without_turns
   use block_state, only: unknown_t, set_values
   use block_solver, only: solve_block
   use blocks, only: largest_known
   use first_position, only: solve_first_block, farthest
   use link_motion, only: move_links
   use block_engine, only: block_engine_t, positions_t, solve_blocks, solve_each, begin_record
   implicit none
   private
   public :: solve_first

   !> All that is assembled so far.
   type :: candidate_t
      type(unknown_t), allocatable :: u(:)              !< (0:unknowns)
      logical, allocatable :: solved(:)                 !< (blocks)
      type(positions_t), allocatable :: others(:)       !< (blocks) what else was found
      real(wp), allocatable :: place(:, :)              !< (3, links) x, y in the deck's unit, phi
   end type candidate_t

   !> Links that differ by more than this, in radians or characteristic lengths, lie differently.
   real(wp), parameter :: apart = max(1.0e-6_wp, sqrt(epsilon(1.0_wp)))
   !> Places count as off by no more than this part of the characteristic length: a deck may give angles alone.
   real(wp), parameter :: far_place = 0.25_wp
   !> Sums of squares that differ by less than this are about alike.
   real(wp), parameter :: nearly = 1.25_wp
   !> A smaller ratio is an improvement by more than rounding.
   real(wp), parameter :: less = 0.999_wp
   !> The largest numbers of blocks assembled for the choice, and of other positions tried of one block.
   integer, parameter :: max_solves = 3000, max_others = 4

contains

   !> Solves for the first motion at `t`, as `solve_blocks` does without one that is followed.
   subroutine solve_first(e, t, c)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(out) :: c

      call solve_blocks(e, t, .false., c)
      if (.not. e%blocks%solvable) return
      if (.not. any(has_others(e%others(e%needed)))) return
      call choose(e)
      c = convergence_t()
      call begin_record(c)
      call solve_each(e, e%needed, .false., c)
   end subroutine solve_first

   !> The block has other positions than the one chosen.
   impure elemental logical function has_others(o)
      type(positions_t), intent(in) :: o

      has_others = .false.
      if (allocated(o%x)) has_others = size(o%x, 2) > 0
   end function has_others

   !> Puts the best assembly into the values of the engine; notes blocks with another that is about as near.
   subroutine choose(e)
      type(block_engine_t), intent(inout) :: e
      type(candidate_t) :: best
      integer :: i, solves
      logical :: again

      best%u = e%state%u
      best%u%value = e%estimated
      allocate (best%solved(size(e%blocks%list)), source=.false.)
      allocate (best%others(size(e%blocks%list)))
      solves = 0
      call assemble_from(0, best)
      solves = 0
      e%is_close = .false.
      ! Once more where a block has no position yet: a later block may have to change its own first.
      do
         again = .false.
         do i = 1, size(best%solved)
            if (has_others(best%others(i))) call try_others()
         end do
         if (solves >= max_solves .or. all(best%solved) .or. .not. again) exit
      end do
      e%state%u = best%u

   contains

      !> Tries the other positions of block `i`, and makes the best assembly `best`; `again`: more blocks are assembled.
      subroutine try_others()
         type(candidate_t) :: other
         real(wp), allocatable :: x(:, :)
         real(wp) :: nearest, cost(2)
         integer :: k

         x = best%others(i)%x
         nearest = off(best%u)
         do k = 1, min(size(x, 2), max_others)
            if (solves >= max_solves) return
            if (all(best%solved) .and. maxval(abs(x(:, k) - estimate_of(i))) > farthest(nearest)) exit
            other = best
            e%state%u = best%u
            call set_values(e%blocks, i, x(:, k), e%state)
            other%u = e%state%u
            call assemble_from(i, other)
            if (count(other%solved) < count(best%solved)) cycle
            cost = costs(best, other)
            if (count(other%solved) > count(best%solved)) then
               again = .true.
               best = other
               e%is_close(i) = .false.
            else if (cost(2) < less*cost(1)) then
               best = other
               e%is_close(i) = cost(1) < nearly*cost(2)
            else
               e%is_close(i) = e%is_close(i) .or. cost(2) < nearly*cost(1)
            end if
         end do
      end subroutine try_others

      !> Assembles block `first` from where it is and those that build on it from the deck's estimate; 0: all.
      subroutine assemble_from(first, t)
         integer, intent(in) :: first
         type(candidate_t), intent(inout) :: t
         type(motion_t) :: found
         integer, dimension(0:e%blocks%unknowns) :: open, changed
         integer :: i
         logical :: finite

         e%state%u = t%u
         open = 0
         changed = 0
         if (first == 0) changed(0) = 1
         do i = 1, size(t%solved)
            associate (own => e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))
               if (i == first .or. first == 0 .or. largest_known(e%blocks, i, changed) > 0) then
                  changed(own) = 1
                  t%solved(i) = largest_known(e%blocks, i, open) == 0
                  if (i /= first) call set_values(e%blocks, i, e%estimated(own), e%state)
                  if (t%solved(i)) call assemble_one(i, i == first, t)
                  solves = solves + 1
               end if
               if (.not. t%solved(i)) open(own) = 1
            end associate
         end do
         t%u = e%state%u
         found = new_motion(size(e%estimate, 2))
         call move_links(e%whole, e%state, e%length, found, finite)
         t%place = found%position
      end subroutine assemble_from

      !> Assembles block `i`, from a position (`is_near`) or from the deck's estimate, and goes back to it in vain.
      subroutine assemble_one(i, is_near, t)
         integer, intent(in) :: i
         logical, intent(in) :: is_near
         type(candidate_t), intent(inout) :: t
         type(convergence_t) :: c

         if (is_near) then
            call solve_block(e%blocks, i, e%tolerance, e%work, e%state, c)
         else
            call solve_first_block(e%blocks, i, e%tolerance, e%work, e%state, c, t%others(i)%x)
         end if
         t%solved(i) = is_solved(c)
         if (.not. t%solved(i)) call set_values(e%blocks, i, estimate_of(i), e%state)
      end subroutine assemble_one

      !> How far two assemblies are from the deck's estimate, by the links that lie differently: the sums of squares.
      function costs(a, b) result(cost)
         type(candidate_t), intent(in) :: a, b
         real(wp) :: cost(2)
         integer :: i

         cost = 0.0_wp
         do i = 1, size(a%place, 2)
            if (max(maxval(abs(a%place(:2, i) - b%place(:2, i)))/e%span, &
               abs(without_turns(a%place(3, i) - b%place(3, i)))) <= apart) cycle
            cost = cost + [link_cost(i, a), link_cost(i, b)]
         end do
      end function costs

      !> Squared distance of link `i` of trial `t` from the estimate, in spans and radians; far places count as
      !> `far_place`.
      pure real(wp) function link_cost(i, t) result(cost)
         integer, intent(in) :: i
         type(candidate_t), intent(in) :: t

         associate (f => e%orientation_of(i))
            cost = min(sum((t%place(:2, i)/e%span - e%estimate(:2, i)/e%span)**2), far_place**2) &
               + without_turns(t%u(f)%value - e%estimated(f))**2
         end associate
      end function link_cost

      !> How far the values of block `i` are from the estimate.
      pure real(wp) function off(u)
         type(unknown_t), intent(in) :: u(0:)

         off = maxval(abs(u(e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))%value - estimate_of(i)))
      end function off

      !> The estimated values (n) of the unknowns of block `i`.
      pure function estimate_of(i) result(x)
         integer, intent(in) :: i
         real(wp) :: x(e%blocks%list(i)%shape%n)

         x = e%estimated(e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))
      end function estimate_of
   end subroutine choose
end module assembly_choice
