!> Systems of one, two or three linear equations, one in each lane, by Gauss's elimination with the greatest pivot of
!> each column: the operations of the reference DGESV, in its order. Rows are exchanged by choosing between numbers, so
!> that all lanes do the same. A pivot of zero becomes one of rounding, which no certificate takes.
module lane_elimination
   use kinds, only: wp
   use lane_sines, only: width
   implicit none
   private
   public :: max_order, factor, substitute, pivots_of, inverse_norm

   !> The largest number of equations.
   integer, parameter :: max_order = 3
   !> What stands for a pivot of zero.
   real(wp), parameter :: no_pivot = epsilon(1.0_wp)

contains

   !> Factors of `a` (lanes, n*n by columns), in its place. `exchanged` (lanes, 3): 1 where the first row was exchanged
   !> with the second, the first with the third, the second with the third; otherwise 0.
   pure subroutine factor(n, a, exchanged)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(width, n*n)
      real(wp), intent(out) :: exchanged(width, 3)

      select case (n)
      case (1)
         exchanged = 0.0_wp
         call fill_zeros(a(:, 1))
      case (2)
         call factor_two(a, exchanged)
      case (3)
         call factor_three(a, exchanged)
      end select
   end subroutine factor

   !> Makes every zero of the `pivot` a rounding.
   pure subroutine fill_zeros(pivot)
      real(wp), intent(inout) :: pivot(width)

      pivot = merge(pivot, no_pivot, abs(pivot) > 0.0_wp)
   end subroutine fill_zeros

   !> The same of two equations.
   pure subroutine factor_two(a, exchanged)
      real(wp), intent(inout) :: a(width, 4)
      real(wp), intent(out) :: exchanged(width, 3)
      real(wp) :: p1, p2, q1, q2
      integer :: l

      do l = 1, width
         p1 = merge(a(l, 2), a(l, 1), abs(a(l, 2)) > abs(a(l, 1)))
         p2 = merge(a(l, 4), a(l, 3), abs(a(l, 2)) > abs(a(l, 1)))
         q1 = merge(a(l, 1), a(l, 2), abs(a(l, 2)) > abs(a(l, 1)))
         q2 = merge(a(l, 3), a(l, 4), abs(a(l, 2)) > abs(a(l, 1)))
         exchanged(l, 1) = merge(1.0_wp, 0.0_wp, abs(a(l, 2)) > abs(a(l, 1)))
         p1 = merge(p1, no_pivot, abs(p1) > 0.0_wp)
         q1 = q1*(1.0_wp/p1)
         a(l, 1) = p1
         a(l, 2) = q1
         a(l, 3) = p2
         a(l, 4) = q2 - q1*p2
      end do
      call fill_zeros(a(:, 4))
   end subroutine factor_two

   !> The same of three.
   pure subroutine factor_three(a, exchanged)
      real(wp), intent(inout) :: a(width, 9)
      real(wp), intent(out) :: exchanged(width, 3)
      real(wp) :: reciprocal
      integer :: l, c

      do l = 1, width
         exchanged(l, 1) = merge(1.0_wp, 0.0_wp, abs(a(l, 2)) > abs(a(l, 1)) .and. abs(a(l, 2)) >= abs(a(l, 3)))
         exchanged(l, 2) = merge(1.0_wp, 0.0_wp, abs(a(l, 3)) > abs(a(l, 1)) .and. abs(a(l, 3)) > abs(a(l, 2)))
      end do
      do c = 1, 7, 3
         call exchange(exchanged(:, 1), a(:, c), a(:, c + 1))
         call exchange(exchanged(:, 2), a(:, c), a(:, c + 2))
      end do
      call fill_zeros(a(:, 1))
      do l = 1, width
         reciprocal = 1.0_wp/a(l, 1)
         a(l, 2) = a(l, 2)*reciprocal
         a(l, 3) = a(l, 3)*reciprocal
         a(l, 5) = a(l, 5) - a(l, 2)*a(l, 4)
         a(l, 6) = a(l, 6) - a(l, 3)*a(l, 4)
         a(l, 8) = a(l, 8) - a(l, 2)*a(l, 7)
         a(l, 9) = a(l, 9) - a(l, 3)*a(l, 7)
         exchanged(l, 3) = merge(1.0_wp, 0.0_wp, abs(a(l, 6)) > abs(a(l, 5)))
      end do
      do c = 2, 8, 3
         call exchange(exchanged(:, 3), a(:, c), a(:, c + 1))
      end do
      call fill_zeros(a(:, 5))
      do l = 1, width
         a(l, 6) = a(l, 6)*(1.0_wp/a(l, 5))
         a(l, 9) = a(l, 9) - a(l, 6)*a(l, 8)
      end do
      call fill_zeros(a(:, 9))
   end subroutine factor_three

   !> Exchanges `x` and `y` in those lanes where `exchanged` is 1.
   pure subroutine exchange(exchanged, x, y)
      real(wp), intent(in) :: exchanged(width)
      real(wp), intent(inout) :: x(width), y(width)
      real(wp) :: z
      integer :: l

      do l = 1, width
         z = merge(y(l), x(l), exchanged(l) > 0.5_wp)
         y(l) = merge(x(l), y(l), exchanged(l) > 0.5_wp)
         x(l) = z
      end do
   end subroutine exchange

   !> Solves the equations with the factors `a` for the right-hand sides `b` (lanes, n), in their place.
   pure subroutine substitute(n, a, exchanged, b)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(width, n*n), exchanged(width, 3)
      real(wp), intent(inout) :: b(width, n)
      integer :: l

      select case (n)
      case (1)
         do l = 1, width
            b(l, 1) = b(l, 1)/a(l, 1)
         end do
      case (2)
         call exchange(exchanged(:, 1), b(:, 1), b(:, 2))
         do l = 1, width
            b(l, 2) = (b(l, 2) - b(l, 1)*a(l, 2))/a(l, 4)
            b(l, 1) = (b(l, 1) - b(l, 2)*a(l, 3))/a(l, 1)
         end do
      case (3)
         call exchange(exchanged(:, 1), b(:, 1), b(:, 2))
         call exchange(exchanged(:, 2), b(:, 1), b(:, 3))
         call exchange(exchanged(:, 3), b(:, 2), b(:, 3))
         do l = 1, width
            b(l, 2) = b(l, 2) - b(l, 1)*a(l, 2)
            b(l, 3) = ((b(l, 3) - b(l, 1)*a(l, 3)) - b(l, 2)*a(l, 6))/a(l, 9)
            b(l, 2) = (b(l, 2) - b(l, 3)*a(l, 8))/a(l, 5)
            b(l, 1) = ((b(l, 1) - b(l, 3)*a(l, 7)) - b(l, 2)*a(l, 4))/a(l, 1)
         end do
      end select
   end subroutine substitute

   !> From the factors: the smallest and the largest pivot, and the sign of the determinant.
   pure subroutine pivots_of(n, a, exchanged, least, largest, sign_of)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(width, n*n), exchanged(width, 3)
      real(wp), intent(out) :: least(width), largest(width), sign_of(width)
      integer :: l, i

      least = abs(a(:, 1))
      largest = abs(a(:, 1))
      sign_of = sign(1.0_wp, a(:, 1))
      do i = 2, n
         do l = 1, width
            least(l) = min(least(l), abs(a(l, i + (i - 1)*n)))
            largest(l) = max(largest(l), abs(a(l, i + (i - 1)*n)))
            sign_of(l) = sign_of(l)*sign(1.0_wp, a(l, i + (i - 1)*n))
         end do
      end do
      do i = 1, merge(3, n - 1, n == 3)
         do l = 1, width
            sign_of(l) = sign_of(l)*(1.0_wp - 2.0_wp*exchanged(l, i))
         end do
      end do
   end subroutine pivots_of

   !> |A^-1| in the maximum norm, from the factors: the largest sum of sizes in a row of the inverse.
   pure subroutine inverse_norm(n, a, exchanged, norm)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(width, n*n), exchanged(width, 3)
      real(wp), intent(out) :: norm(width)
      real(wp) :: column(width, 3), rows(width, 3)
      integer :: l, c

      if (n == 1) then
         norm = 1.0_wp/abs(a(:, 1))
      else if (n == 2) then
         do l = 1, width
            norm(l) = max(abs(a(l, 4) + a(l, 3)*a(l, 2)) + abs(a(l, 3)), abs(a(l, 1)*a(l, 2)) + abs(a(l, 1))) &
               /abs(a(l, 1)*a(l, 4))
         end do
      else
         rows = 0.0_wp
         do c = 1, 3
            column = 0.0_wp
            column(:, c) = 1.0_wp
            call substitute(3, a, exchanged, column)
            rows = rows + abs(column)
         end do
         norm = max(rows(:, 1), rows(:, 2), rows(:, 3))
      end if
   end subroutine inverse_norm
end module lane_elimination
