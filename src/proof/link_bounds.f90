!> From the balls of the unknowns to those of links, points and pairs, along the tree as `link_motion` has it.
module link_bounds
   use kinds, only: wp
   use planar, only: real_vector_t => vector_t
   use mechanism, only: mechanism_t, request_t, request_link, request_point, pair_prismatic, plane_origin
   use motion, only: motion_t
   use points, only: row_t, row_of
   use links_tree, only: tree_t
   use block_engine, only: block_engine_t
   use balls, only: ball_t, rounding, room, distance, operator(+), operator(-), operator(*)
   use ball_equations, only: vector_t, unknown_t, ball_state_t, set_direction, add_rotating
   use ball_numbers, only: angle_errors, around, of_number, of_vector
   implicit none
   private
   public :: link_vectors_t, link_vectors, bound_links, row_bound, largest_bounds

   type(ball_t), parameter :: zero = ball_t(0.0_wp, 0.0_wp)

   !> The vectors of a link of the engine's chain, in the deck's unit.
   type :: link_vectors_t
      type(vector_t) :: reach, back, slide        !< `back`: from the point that joins it to its parent to its origin
      type(ball_t) :: angle                       !< of the link from its orientation, rad
   end type link_vectors_t

contains

   !> (chain) Those of the engine `e` of `m`.
   function link_vectors(m, e) result(l)
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(link_vectors_t) :: l(e%chain%wanted)
      real(wp) :: angle(0:e%blocks%tree%orientations), terms(2), slide(2)
      integer :: i

      angle = angle_errors(m, e%blocks%tree)
      do i = 1, size(l)
         associate (h => e%chain%links(i), place => e%chain%links(i)%place)
            terms = term_lengths(m, e%blocks%tree, h%link)*(of_number + 2.0_wp*of_vector &
               + angle([h%parent_orientation, h%orientation]))
            slide = place%slide_body_vector*e%length
            l(i)%reach = around(real_vector_t(place%reach(1), place%reach(2)), terms(1))
            l(i)%back = around(real_vector_t(-place%body_vector(1), -place%body_vector(2)), terms(2))
            l(i)%slide = around(real_vector_t(slide(1), slide(2)), &
               (of_number + 2.0_wp*of_vector + angle(h%parent_orientation))*norm2(slide))
            l(i)%angle = ball_t(h%angle_offset, angle(h%orientation))
         end associate
      end do
   end function link_vectors

   !> The lengths (2) that are added up to the reach and to the body vector of `link`.
   pure function term_lengths(m, t, link) result(terms)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      integer, intent(in) :: link
      real(wp) :: terms(2)
      integer :: parent

      terms = 0.0_wp
      parent = t%parent(link)
      if (parent == 0) return
      associate (pair => m%pairs(t%parent_joint(link)))
         associate (own_is_j => m%points(pair%point_j)%link == link)
            terms(1) = norm2(m%points(merge(pair%point_i, pair%point_j, own_is_j))%offset)
            terms(2) = norm2(m%points(merge(pair%point_j, pair%point_i, own_is_j))%offset)
         end associate
         if (pair%kind == pair_prismatic) terms(1) = terms(1) + abs(pair%offset)
      end associate
      if (m%links(parent)%ground) terms(1) = terms(1) + norm2(m%links(parent)%position(:2)) + norm2(plane_origin(m))
   end function term_lengths

   !> `error` (3, 0:2, links): the exact place and angle of each link, with the vectors `l`, and their derivatives
   !> differ by no more from those of the motion `q` that the engine `e` has found; the exact unknowns lie in `s`. 0 of
   !> links that nothing asks for, and of ground links, of which nothing is computed.
   pure subroutine bound_links(l, e, s, q, error)
      type(link_vectors_t), intent(in) :: l(:)
      type(block_engine_t), intent(in) :: e
      type(ball_state_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      real(wp), intent(out) :: error(3, 0:2, size(e%orientation_of))
      type(vector_t) :: place(0:2, size(error, 3)), here(0:2)
      integer :: i

      error = 0.0_wp
      do i = 1, size(l)
         associate (h => e%chain%links(i), own => e%chain%links(i)%link, &
            p => s%u(e%chain%links(i)%parent_orientation), f => s%u(e%chain%links(i)%orientation))
            here = vector_t()
            if (h%root > 0) then
               call add_sliding(vector_t(ball_t(e%length*h%root_unit(1), 0.0_wp), zero), s%u(0), s%u(h%root), here)
               call add_sliding(vector_t(zero, ball_t(e%length*h%root_unit(2), 0.0_wp)), s%u(0), s%u(h%root + 1), here)
            else
               if (h%parent > 0) here = place(:, h%parent)
               call add_rotating(l(i)%reach, p, here)
               call add_rotating(l(i)%back, f, here)
               if (h%slide > 0) call add_sliding(l(i)%slide, p, s%u(h%slide), here)
            end if
            place(:, own) = here
            error(:, 0, own) = distance([here(0)%x, here(0)%y, f%value + l(i)%angle], q%position(:, own))
            error(:, 1, own) = distance([here(1)%x, here(1)%y, f%rate], q%velocity(:, own))
            error(:, 2, own) = distance([here(2)%x, here(2)%y, f%acceleration], q%acceleration(:, own))
         end associate
      end do
   end subroutine bound_links

   !> Adds to `place` (0:2) the vector `d`, which `f` rotates, times `u`, with its derivatives.
   pure subroutine add_sliding(d, f, u, place)
      type(vector_t), intent(in) :: d
      type(unknown_t), intent(in) :: f, u
      type(vector_t), intent(inout) :: place(0:2)
      type(vector_t) :: e(0:2)

      e = vector_t()
      call add_rotating(d, f, e)
      place%x = place%x + product_of([u%value, u%rate, u%acceleration], e%x)
      place%y = place%y + product_of([u%value, u%rate, u%acceleration], e%y)
   end subroutine add_sliding

   !> (0:2) The product of `a` and `b`, with its derivatives.
   pure function product_of(a, b) result(c)
      type(ball_t), intent(in) :: a(0:2), b(0:2)
      type(ball_t) :: c(0:2)

      c(0) = a(0)*b(0)
      c(1) = a(1)*b(0) + a(0)*b(1)
      c(2) = a(2)*b(0) + ball_t(2.0_wp, 0.0_wp)*(a(1)*b(1)) + a(0)*b(2)
   end function product_of

   !> The same (3, 0:2) of the row of the motion `q` of `m` that `request` asks for, a link, point or pair; `links`
   !> (3, 0:2, links): those of all links.
   pure function row_bound(m, q, links, request) result(error)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      type(request_t), intent(in) :: request
      real(wp) :: error(3, 0:2)
      type(row_t) :: row
      type(ball_t) :: number(3, 0:2)
      type(vector_t) :: origin

      row = row_of(m, q, request)
      origin = around(real_vector_t(q%origin(1), q%origin(2)), 2.0_wp*of_number*norm2(plane_origin(m)))
      number = zero
      associate (i => request%subject)
         select case (request%kind)
         case (request_link)
            if (m%links(i)%ground) return
            number = link_balls(m, q, links, i)
         case (request_point)
            number(:2, :) = point_balls(m, q, links, i)
         case default
            number(1, :) = pair_balls(m, q, links, i)
         end select
         if (any(request%kind == [request_link, request_point])) number(:2, 0) = number(:2, 0) + [origin%x, origin%y]
      end associate
      ! Degrees, and the digits of a row.
      error = distance(number, row%value)*(1.0_wp + 4.0_wp*rounding)*room
   end function row_bound

   !> (0:2) The largest of those of `links` (3, 0:2, links), in parts of the characteristic `length` and `rate`.
   pure function largest_bounds(links, length, rate) result(largest)
      real(wp), intent(in) :: links(:, 0:, :), length, rate
      real(wp) :: largest(0:2)
      integer :: i, k

      largest = 0.0_wp
      do i = 1, size(links, 3)
         do k = 0, 2
            largest(k) = max(largest(k), max(links(1, k, i), links(2, k, i))/length, links(3, k, i))
         end do
      end do
      largest = largest/rate**[0, 1, 2]
   end function largest_bounds

   !> (3, 0:2) Place from the motion's origin and angle of link `i`, with their derivatives.
   pure function link_balls(m, q, links, i) result(x)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      integer, intent(in) :: i
      type(ball_t) :: x(3, 0:2)

      if (m%links(i)%ground) then
         x = zero
         associate (position => m%links(i)%position, origin => plane_origin(m))
            x(:, 0)%mid = position - [origin, 0.0_wp]
            x(:2, 0)%radius = 2.0_wp*of_number*(norm2(position(:2)) + norm2(origin))
            x(3, 0)%radius = of_number*abs(position(3))
         end associate
      else
         x(:, 0)%mid = q%position(:, i)
         x(:, 1)%mid = q%velocity(:, i)
         x(:, 2)%mid = q%acceleration(:, i)
         x%radius = links(:, :, i)
      end if
   end function link_balls

   !> (2, 0:2) The same of point `i`.
   pure function point_balls(m, q, links, i) result(x)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      integer, intent(in) :: i
      type(ball_t) :: x(2, 0:2), link(3, 0:2)
      type(vector_t) :: p(0:2)

      associate (offset => m%points(i)%offset)
         link = link_balls(m, q, links, m%points(i)%link)
         p%x = link(1, :)
         p%y = link(2, :)
         call add_rotating(around(real_vector_t(offset(1), offset(2)), of_number*norm2(offset)), &
            angle_of(link(3, :)), p)
         x(1, :) = p%x
         x(2, :) = p%y
      end associate
   end function point_balls

   !> The angle with these derivatives (0:2).
   pure type(unknown_t) function angle_of(x) result(f)
      type(ball_t), intent(in) :: x(0:2)

      f%value = x(0)
      f%rate = x(1)
      f%acceleration = x(2)
      call set_direction(f)
   end function angle_of

   !> (0:2) Those of pair `k`: its relative angle, or its slide.
   pure function pair_balls(m, q, links, k) result(x)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: links(:, 0:, :)
      integer, intent(in) :: k
      type(ball_t) :: x(0:2), own(3, 0:2), other(3, 0:2), between(2, 0:2)
      type(vector_t) :: guide(0:2)

      associate (pair => m%pairs(k))
         own = link_balls(m, q, links, m%points(pair%point_i)%link)
         if (pair%kind == pair_prismatic) then
            own(3, 0) = own(3, 0) + ball_t(pair%alpha, of_number*abs(pair%alpha))
            guide = vector_t()
            call add_rotating(vector_t(ball_t(1.0_wp, 0.0_wp), zero), angle_of(own(3, :)), guide)
            between = point_balls(m, q, links, pair%point_j) - point_balls(m, q, links, pair%point_i)
            x = product_of(between(1, :), guide%x) + product_of(between(2, :), guide%y)
         else
            other = link_balls(m, q, links, m%points(pair%point_j)%link)
            x = other(3, :) - own(3, :)
         end if
      end associate
   end function pair_balls
end module link_bounds
