!> Sums and products of vectors in the plane, one in each lane: (lanes, 2) are x and y.
module lane_vectors
   use kinds, only: wp
   use lane_sines, only: width
   implicit none
   private
   public :: one, copy, put_across, add_along, add_across, add_dot, add_cross

   real(wp), parameter :: one(width) = 1.0_wp

contains

   !> x and y of `from` go `to`.
   pure subroutine copy(from, to)
      real(wp), intent(in) :: from(width, 2)
      real(wp), intent(inout) :: to(width, 2)
      integer :: l

      do l = 1, width
         to(l, 1) = from(l, 1)
         to(l, 2) = from(l, 2)
      end do
   end subroutine copy

   !> x and y of the quarter turn of `e`.
   pure subroutine put_across(e, x, y)
      real(wp), intent(in) :: e(width, 2)
      real(wp), intent(inout) :: x(width), y(width)
      integer :: l

      do l = 1, width
         x(l) = -e(l, 2)
         y(l) = e(l, 1)
      end do
   end subroutine put_across

   !> Adds `x` e to `g`.
   pure subroutine add_along(e, x, g)
      real(wp), intent(in) :: e(width, 2), x(width)
      real(wp), intent(inout) :: g(width, 2)

      g(:, 1) = g(:, 1) + x*e(:, 1)
      g(:, 2) = g(:, 2) + x*e(:, 2)
   end subroutine add_along

   !> Adds `x` times the quarter turn of `e` to `g`.
   pure subroutine add_across(e, x, g)
      real(wp), intent(in) :: e(width, 2), x(width)
      real(wp), intent(inout) :: g(width, 2)

      g(:, 1) = g(:, 1) - x*e(:, 2)
      g(:, 2) = g(:, 2) + x*e(:, 1)
   end subroutine add_across

   !> Adds `s` times the scalar product of `e` and `f` to `x`.
   pure subroutine add_dot(s, e, f, x)
      real(wp), intent(in) :: s(width), e(width, 2), f(width, 2)
      real(wp), intent(inout) :: x(width)

      x = x + s*(e(:, 1)*f(:, 1) + e(:, 2)*f(:, 2))
   end subroutine add_dot

   !> Adds `s` times the cross product of `e` and `f` to `x`.
   pure subroutine add_cross(s, e, f, x)
      real(wp), intent(in) :: s(width), e(width, 2), f(width, 2)
      real(wp), intent(inout) :: x(width)

      x = x + s*(e(:, 1)*f(:, 2) - e(:, 2)*f(:, 1))
   end subroutine add_cross
end module lane_vectors
