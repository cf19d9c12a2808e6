!> Which links are known, and why the others are not, where not every block has all of its motion: a link is
!> known as far as all the blocks are that it builds on.
module link_knowledge
   use kinds, only: wp
   use motion, only: motion_t, mark_none, mark_not_converged, mark_singular
   use block_needs, only: largest_known
   use block_solver, only: solve_block
   use block_engine, only: block_engine_t, set_drive_values
   use convergence, only: convergence_t
   use link_motion, only: chain_t, move_links
   implicit none
   private
   public :: know_links, get_driven_motion

   !> What is missing, the worst last: nothing, what is derived by time, the position.
   integer, parameter :: nothing = 0, singular_rates = 1, all_of_it = 2

contains

   !> Tells of each link of `found`, the motion that `e` has found, how much of it exists.
   subroutine know_links(e, found)
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(inout) :: found
      integer :: missing(0:e%blocks%unknowns), own, k

      missing = nothing
      do k = 1, size(e%needed)
         own = merge(singular_rates, nothing, e%is_singular(e%needed(k)))
         call note_block(e, e%needed(k), own, missing)
      end do
      call fill_links(e, missing, found)
   end subroutine know_links

   !> Where no position was found at `t`, that of the links which drives alone move from the ground on, whatever the
   !> others do: at `t` they are where their drives have them. `found` has its mark already.
   subroutine get_driven_motion(e, t, found)
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      integer :: missing(0:e%blocks%unknowns), k
      type(convergence_t) :: c
      type(chain_t) :: part
      real(wp) :: correction
      logical :: finite

      if (.not. e%blocks%solvable) return
      call set_drive_values(e, t)
      missing = nothing
      correction = 0.0_wp
      do k = 1, size(e%needed)
         associate (i => e%needed(k))
            call note_block(e, i, merge(nothing, all_of_it, e%blocks%list(i)%direct), missing)
            if (.not. e%blocks%list(i)%direct) cycle
            if (missing(e%blocks%unknown(e%blocks%list(i)%first)) == nothing) &
               call solve_block(e%blocks, i, e%tolerance, e%work, e%state, c, correction)
         end associate
      end do
      call fill_links(e, missing, found)
      ! What the state has of the others need not be a number.
      part = e%chain
      part%hung = pack(e%chain%hung, found%link_known(e%chain%hung%link) == 2)
      call move_links(part, e%state, e%length, found, finite)
   end subroutine get_driven_motion

   !> Of the unknowns of block `i` so much is missing as its `own` equations leave out, or what it builds on.
   subroutine note_block(e, i, own, missing)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i, own
      integer, intent(inout) :: missing(0:)

      associate (block => e%blocks%list(i))
         missing(e%blocks%unknown(block%first:block%last)) = max(own, largest_known(e%blocks, i, missing))
      end associate
   end subroutine note_block

   !> From the unknowns to the links: a link hangs on another, by an angle and perhaps a slide.
   subroutine fill_links(e, missing, found)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: missing(0:)
      type(motion_t), intent(inout) :: found
      integer :: of_link(0:size(e%orientation_of)), k

      of_link = nothing
      do k = 1, size(e%chain%hung)
         associate (h => e%chain%hung(k))
            of_link(h%link) = max(missing(h%orientation), missing(h%slide), of_link(h%parent))
            if (h%root > 0) of_link(h%link) = max(of_link(h%link), missing(h%root), missing(h%root + 1))
         end associate
      end do
      allocate (found%link_known(size(e%orientation_of)), found%link_mark(size(e%orientation_of)))
      do k = 1, size(e%orientation_of)
         select case (of_link(k))
         case (nothing)
            found%link_known(k) = 2
            found%link_mark(k) = mark_none
         case (all_of_it)
            found%link_known(k) = -1
            found%link_mark(k) = mark_not_converged
         case default
            found%link_known(k) = 0
            found%link_mark(k) = mark_singular
         end select
      end do
   end subroutine fill_links
end module link_knowledge
