!> The motion of the links in balls from the unknowns in balls, along the tree, with the text of link_motion.inc.
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

   !> Bounds the exact motion of all links, and the errors of the computed motion. Of ground links, and of links that
   !> are not wanted, the balls are 0.
   pure subroutine bound_links(x, numbers, balls, q, links, largest)
      type(geometry_t), intent(in) :: x      !< with its chain
      type(ball_numbers_t), intent(in) :: numbers   !< the geometry in balls
      type(ball_state_t), intent(in) :: balls   !< hold the exact unknowns
      type(motion_t), intent(in) :: q        !< the computed motion
      !> (3, 0:2, links) x, y (from the origin of `q`, deck's unit), phi (rad), and their derivatives by time.
      type(ball_t), intent(out) :: links(3, 0:2, size(q%position, 2))
      real(wp), intent(out) :: largest(2, 0:2)   !< largest errors of lengths and angles (rad), and of derivatives
      type(vector_t) :: vector(0:2)
      real(wp) :: error(3, 0:2)
      integer :: i

      links = ZERO
      largest = 0.0_wp
      do i = 1, x%chain%wanted
         associate (h => x%chain%links(i), own => x%chain%links(i)%link, f => balls%u(x%chain%links(i)%orientation))
            call find_link_vector(h, numbers%links(i), balls%u, vector)
            links(1, :, own) = vector%x
            links(2, :, own) = vector%y
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
