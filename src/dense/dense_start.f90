!> The start of METHOD DENSE and METHOD MATRIX at the first instant: the deck's estimate as the blocks take it, and the
!> assembly that the blocks find from there. So all methods mean the same assembly, and the same turns of its angles.
module dense_start
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_link, method_newton
   use motion, only: motion_t, new_motion
   use structure, only: structure_t
   use convergence, only: convergence_t, is_solved
   use block_state, only: set_values
   use block_solver, only: solve_direct
   use block_engine, only: block_engine_t, make_block_engine
   use assembly_choice, only: solve_first
   implicit none
   private
   public :: by_blocks, find_start

contains

   !> `m` with all its links, to be solved by blocks.
   pure function by_blocks(m) result(d)
      type(mechanism_t), intent(in) :: m
      type(mechanism_t) :: d
      integer :: i

      d = m
      d%method = method_newton
      d%tolerance = 0.0_wp
      d%requests = [(request_t(request_link, i, 1), i=1, size(m%links))]
   end function by_blocks

   !> Two positions (3, links) of `m`, which is to be solved by blocks and has the `structure`, at `t`, x and y in the
   !> deck's unit from the plane's origin: the `estimate`, with driven links at their drives' values, angles without
   !> needless turns, and child links at the joints of their parents; and the `assembly` found from it, where there is
   !> one (`is_found`). Where the structure has no solution `estimate` stays as it is.
   subroutine find_start(m, structure, t, estimate, assembly, is_found)
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(in) :: structure
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: estimate(:, :)
      real(wp), intent(out) :: assembly(:, :)
      logical, intent(out) :: is_found
      type(block_engine_t) :: e
      type(structure_t) :: own
      type(convergence_t) :: c
      type(motion_t) :: q
      logical :: unused

      q = new_motion(size(m%links))
      own = structure
      call make_block_engine(e, m, own)
      call solve_first(e, t, c)
      is_found = e%blocks%solvable .and. is_solved(c)
      assembly = estimate
      if (.not. e%blocks%solvable) return
      if (is_found) then
         call e%get_motion(q, unused)
         assembly = q%position
      end if
      call return_to_estimate(e)
      call e%get_motion(q, unused)
      estimate = q%position
   end subroutine find_start

   !> Unknowns that take an iteration get their estimates again; those that drives alone give keep their values.
   subroutine return_to_estimate(e)
      type(block_engine_t), intent(inout) :: e
      integer :: k

      do k = 1, size(e%needed)
         associate (i => e%needed(k))
            associate (unknowns => e%blocks%unknown(e%blocks%list(i)%first:e%blocks%list(i)%last))
               call set_values(e%blocks, i, e%estimated(unknowns), e%state)
            end associate
            if (e%blocks%list(i)%direct) call solve_direct(e%blocks, i, e%state)
         end associate
      end do
   end subroutine return_to_estimate
end module dense_start
