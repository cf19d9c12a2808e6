!> From the balls of the unknowns to the balls of links, along the tree of `link_motion`, with the text of
!> link_motion.inc.
#define NUMBER type(ball_t)
#define ZERO ball_t(0.0_wp, 0.0_wp)
#define TWO ball_t(2.0_wp, 0.0_wp)
module link_bounds
   use kinds, only: wp
   use motion, only: motion_t
   use blocks, only: geometry_t, link_step_t
   use balls, only: ball_t, distance, operator(+), operator(-), operator(*)
   use ball_equations, only: vector_t, unknown_t, link_numbers_t, ball_numbers_t, ball_state_t, add_rotating
   implicit none
   private
   public :: bound_links

contains

   !> Bounds the exact places and angles of all links and their derivatives; those of the ground and of links that are
   !> not needed are 0.
   pure subroutine bound_links(x, numbers, balls, q, links, largest)
      type(geometry_t), intent(in) :: x
      type(ball_numbers_t), intent(in) :: numbers
      type(ball_state_t), intent(in) :: balls   !< hold the exact unknowns
      type(motion_t), intent(in) :: q        !< as computed
      type(ball_t), intent(out) :: links(3, 0:2, size(q%position, 2))   !< x and y from the origin of `q`, angle (rad)
      real(wp), intent(out) :: largest(2, 0:2)   !< largest error of the lengths and angles (rad) of `q`
      type(vector_t) :: place(0:2)
      real(wp) :: error(3, 0:2)
      integer :: i

      links = ZERO
      largest = 0.0_wp
      do i = 1, x%chain%wanted
         associate (h => x%chain%links(i), own => x%chain%links(i)%link, f => balls%u(x%chain%links(i)%orientation))
            call find_place(h, numbers%links(i), balls%u, place)
            links(1, :, own) = place%x
            links(2, :, own) = place%y
            if (h%parent > 0) links(:2, :, own) = links(:2, :, own) + links(:2, :, h%parent)
            links(3, :, own) = [f%value + numbers%links(i)%angle_offset, f%rate, f%acceleration]
            error(:, 0) = distance(links(:, 0, own), q%position(:, own))
            error(:, 1) = distance(links(:, 1, own), q%velocity(:, own))
            error(:, 2) = distance(links(:, 2, own), q%acceleration(:, own))
            largest(1, :) = max(largest(1, :), error(1, :), error(2, :))
            largest(2, :) = max(largest(2, :), error(3, :))
         end associate
      end do
   end subroutine bound_links

#include "link_motion.inc"
end module link_bounds
