!> The matrix of a block of two unknowns beside one that is factored: so near that its equations are solved by the
!> factors there are.
module nearby_matrix
   use kinds, only: wp
   use block_matrix, only: shape_t, inverse_norm_of_two
   implicit none
   private
   public :: nearby_t, stay_near, solve_nearby

   !> It, the factors of the other, and how far they are apart.
   type :: nearby_t
      real(wp) :: a(4) = 0.0_wp                  !< the matrix, by columns
      real(wp) :: factors(4) = 0.0_wp            !< of the other, while the matrix is assembled
      real(wp) :: inverse(4) = 0.0_wp            !< of the other
      real(wp) :: distance = 0.0_wp              !< |A0^-1 (A - A0)| at most, A0 being factored; 0: `a` is not in use
      integer :: passes = 0                      !< of refinement, until what is left is lost
   end type nearby_t

   !> A matrix that differs from the factored one by more than this part is factored itself: mending the difference
   !> takes as long.
   real(wp), parameter :: max_distance = 1.0e-4_wp
   !> A relative error below this is lost in that of a factorization.
   real(wp), parameter :: lost = 0.125_wp*epsilon(1.0_wp)

contains

   !> The matrix of shape `s` whose factors are in `a` changes by `change` at most, or once more: `near` can be it,
   !> unless it is better factored itself.
   pure subroutine stay_near(s, a, pivots, change, near)
      type(shape_t), intent(in) :: s
      real(wp), intent(in) :: a(*), change
      integer, intent(in) :: pivots(*)
      type(nearby_t), intent(inout) :: near
      real(wp) :: error

      if (s%n /= 2 .or. s%rows /= 2) return
      near%factors = a(:4)
      near%inverse = [a(4) + a(2)*a(3), -a(1)*a(2), -a(3), a(1)]/(a(1)*a(4))
      if (pivots(1) == 2) near%inverse = near%inverse([3, 4, 1, 2])
      near%distance = near%distance + change*inverse_norm_of_two(a)
      if (.not. near%distance <= max_distance) near%distance = 0.0_wp
      near%passes = 0
      error = near%distance
      do while (error > lost)
         near%passes = near%passes + 1
         error = error*near%distance
      end do
   end subroutine stay_near

   !> Solves `near` x = `b` (2) with the inverse of the matrix beside it, by iterative refinement (Higham, Accuracy and
   !> Stability of Numerical Algorithms, 2002, ch. 12): each pass takes the error down by the distance of the two, to
   !> what a factorization of its own would leave.
   pure subroutine solve_nearby(near, b)
      type(nearby_t), intent(in) :: near
      real(wp), intent(inout) :: b(2)
      real(wp) :: x(2)
      integer :: k

      x = times(near%inverse, b)
      do k = 1, near%passes
         x = x + times(near%inverse, b - times(near%a, x))
      end do
      b = x
   end subroutine solve_nearby

   !> `a` (4, by columns) times `x`.
   pure function times(a, x) result(y)
      real(wp), intent(in) :: a(4), x(2)
      real(wp) :: y(2)

      y(1) = a(1)*x(1) + a(3)*x(2)
      y(2) = a(2)*x(1) + a(4)*x(2)
   end function times
end module nearby_matrix
