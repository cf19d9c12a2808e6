!> What roundings change, to first order, in the rows of links, points and pairs: in all directions of
!> `card_roundings` at once, as they change the motion of the links.
module row_changes
   use kinds, only: wp
   use planar, only: direction, turning
   use mechanism, only: mechanism_t, request_t, pair_prismatic, request_link, request_point
   use motion, only: motion_t
   use points, only: point_motion
   use card_roundings, only: directions
   use rounding_changes, only: change_vector, change_product, no_change
   implicit none
   private
   public :: change_row

contains

   !> The changes `x` (directions, 3, 0:2) of the row of the link, point or pair that `request` asks for, in the motion
   !> `q` of `m`, whose links change by `links` (directions, 3, 0:2, links).
   pure subroutine change_row(m, q, request, links, x)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      real(wp), intent(in) :: links(directions, 3, 0:2, *)
      real(wp), intent(out) :: x(directions, 3, 0:2)

      associate (i => request%subject)
         if (request%kind == request_link) then
            x = links(:, :, :, i)
            return
         end if
         x = 0.0_wp
         if (request%kind == request_point) then
            x(:, :2, :) = change_of_point(m, q, i, links)
         else
            x(:, 1, :) = change_of_pair(m, q, i, links)
         end if
      end associate
   end subroutine change_row

   !> The same (directions, 2, 0:2) of point number `i`.
   pure function change_of_point(m, q, i, links) result(x)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp), intent(in) :: links(directions, 3, 0:2, *)
      real(wp) :: x(directions, 2, 0:2)

      associate (k => m%points(i)%link)
         x = links(:, :2, :, k)
         call change_vector(m%points(i)%offset, no_change, direction(q%position(3, k)), q%velocity(3, k), &
            q%acceleration(3, k), links(:, 3, :, k), x)
      end associate
   end function change_of_point

   !> The same (directions, 0:2) of pair number `i`: phi_j - phi_i, or (Q - P) . e of a prismatic pair.
   pure function change_of_pair(m, q, i, links) result(x)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp), intent(in) :: links(directions, 3, 0:2, *)
      real(wp) :: x(directions, 0:2), f(directions, 0:2)
      real(wp), dimension(directions, 2, 0:2) :: dp, de
      real(wp), dimension(2, 0:2) :: p, e
      integer :: order

      associate (pair => m%pairs(i), k => m%points(m%pairs(i)%point_i)%link)
         f = links(:, 3, :, k)
         if (pair%kind /= pair_prismatic) then
            x = links(:, 3, :, m%points(pair%point_j)%link) - f
            return
         end if
         p = point_motion(m, q, pair%point_j) - point_motion(m, q, pair%point_i)
         dp = change_of_point(m, q, pair%point_j, links) - change_of_point(m, q, pair%point_i, links)
         e = turning(direction(q%position(3, k) + pair%alpha), [0.0_wp, q%velocity(3, k), q%acceleration(3, k)])
         de = 0.0_wp
         call change_vector([1.0_wp, 0.0_wp], no_change, e(:, 0), q%velocity(3, k), q%acceleration(3, k), f, de)
         do order = 0, 2
            x(:, order) = change_product(order, p, e, dp, de)
         end do
      end associate
   end function change_of_pair
end module row_changes
