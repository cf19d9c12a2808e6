!> From the balls of the unknowns to the balls of links, along the tree of `link_motion`.
module link_bounds
   use kinds, only: wp
   use plane_vectors, only: real_vector_t => vector_t
   use mechanism, only: mechanism_t
   use motion, only: motion_t
   use blocks, only: geometry_t
   use balls, only: ball_t, distance, operator(+), operator(*)
   use ball_equations, only: vector_t, unknown_t, ball_state_t, add_rotating
   use ball_numbers, only: angle_error, length_in_link, around, number_error, vector_error
   implicit none
   private
   public :: bound_links

   type(ball_t), parameter :: zero = ball_t(0.0_wp, 0.0_wp)

contains

   !> Bounds the exact places and angles of all links and their derivatives; those of the ground and of links that are
   !> not needed are 0.
   pure subroutine bound_links(m, x, balls, q, links, largest)
      type(mechanism_t), intent(in) :: m
      type(geometry_t), intent(in) :: x
      type(ball_state_t), intent(in) :: balls   !< hold the exact unknowns
      type(motion_t), intent(in) :: q        !< as computed
      type(ball_t), intent(out) :: links(3, 0:2, size(m%links))   !< x and y from the origin of `q`, angle (rad)
      real(wp), intent(out) :: largest(2, 0:2)   !< largest error of the lengths and angles (rad) of `q`
      type(vector_t) :: here(0:2)
      real(wp) :: error(3, 0:2), slide(2), of_angle, of_direction, of_vectors
      integer :: i

      of_angle = angle_error(m)
      of_direction = number_error + 2.0_wp*vector_error + of_angle
      of_vectors = of_direction*(maxval([0.0_wp, length_in_link(m, [(i, i=1, size(m%points))])]) &
         + maxval([0.0_wp, abs(m%pairs%offset)]))
      links = zero
      largest = 0.0_wp

      do i = 1, x%chain%wanted
         associate (chain => x%chain%links, length => x%chain%length)
            associate (h => chain(i), own => chain(i)%link, place => chain(i)%place, &
               p => balls%u(chain(i)%parent_orientation), f => balls%u(chain(i)%orientation))
               here = vector_t()

               if (h%root > 0) then
                  call add_sliding(vector_t(ball_t(length*h%root_unit(1), 0.0_wp), zero), balls%u(0), balls%u(h%root), &
                     here)
                  call add_sliding(vector_t(zero, ball_t(length*h%root_unit(2), 0.0_wp)), balls%u(0), &
                     balls%u(h%root + 1), here)
               else
                  if (h%parent > 0) here%x = links(1, :, h%parent)
                  if (h%parent > 0) here%y = links(2, :, h%parent)
                  call add_rotating(around(real_vector_t(place%reach(1), place%reach(2)), of_vectors), p, here)
                  call add_rotating(around(real_vector_t(-place%body_vector(1), -place%body_vector(2)), of_vectors), &
                     f, here)
                  slide = place%slide_body_vector*length
                  if (h%slide > 0) call add_sliding(around(real_vector_t(slide(1), slide(2)), &
                     of_direction*norm2(slide)), p, balls%u(h%slide), here)
               end if

               links(1, :, own) = here%x
               links(2, :, own) = here%y
               links(3, :, own) = [f%value + ball_t(h%angle_offset, of_angle), f%rate, f%acceleration]
               error(:, 0) = distance(links(:, 0, own), q%position(:, own))
               error(:, 1) = distance(links(:, 1, own), q%velocity(:, own))
               error(:, 2) = distance(links(:, 2, own), q%acceleration(:, own))
               largest(1, :) = max(largest(1, :), error(1, :), error(2, :))
               largest(2, :) = max(largest(2, :), error(3, :))
            end associate
         end associate
      end do
   end subroutine bound_links

   !> Adds a sliding vector to a place, with its derivatives: a direction that an angle rotates, times a slide.
   pure subroutine add_sliding(direction, angle, slide, place)
      type(vector_t), intent(in) :: direction   !< at the angle 0, of the length of a slide of 1
      type(unknown_t), intent(in) :: angle, slide   !< rad, unit of the block
      type(vector_t), intent(inout) :: place(0:2)   !< and its derivatives
      type(vector_t) :: e(0:2)

      e = vector_t()
      call add_rotating(direction, angle, e)
      place%x = place%x + product_of([slide%value, slide%rate, slide%acceleration], e%x)
      place%y = place%y + product_of([slide%value, slide%rate, slide%acceleration], e%y)
   end subroutine add_sliding

   !> Gives the product (0:2) of two functions of the time, with its derivatives.
   pure function product_of(first, second) result(c)
      type(ball_t), intent(in) :: first(0:2), second(0:2)   !< the functions and their derivatives
      type(ball_t) :: c(0:2)

      c(0) = first(0)*second(0)
      c(1) = first(1)*second(0) + first(0)*second(1)
      c(2) = first(2)*second(0) + ball_t(2.0_wp, 0.0_wp)*(first(1)*second(1)) + first(0)*second(2)
   end function product_of
end module link_bounds
