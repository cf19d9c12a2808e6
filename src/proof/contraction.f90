!> Newton and Kantorovich's argument with an approximate inverse A of a Jacobian: x - A F(x) maps the ball of radius r
!> about c into itself and contracts it, if
!>
!>    |A| |F(c)| + z1 r + z2 r^2/2 <= r,   z1 >= |1 - A J(c)|,   z1 + z2 s >= |1 - A J| in the ball of radius s <= r
!>
!> So F has exactly one zero in the ball, J is regular in all of it, and z1 + z2 r < 1. (Ortega and Rheinboldt, ch. 12;
!> the form with bounds from data is that of Day, Lessard and Mischaikow's radii polynomials.)
module contraction
   use kinds, only: wp
   use balls, only: rounding
   implicit none
   private
   public :: bound_inverse, apply, radius_of

   !> A map that contracts less is not used: 1 less its rate is a divisor.
   real(wp), parameter, public :: max_rate = 0.999_wp
   !> Balls are a little larger than need be.
   real(wp), parameter :: larger = 1.01_wp

contains

   !> `a` (n, rows): |A| of about the inverse A of `jacobian` (rows, n), with room for roundings; `off` (n): the row
   !> sums of |1 - A J|. Of equations that are too many those count that have the largest pivots; the columns of the
   !> others are 0. `exists`: there is an inverse.
   subroutine bound_inverse(rows, n, jacobian, a, off, exists)
      integer, intent(in) :: rows, n
      real(wp), intent(in) :: jacobian(rows, n)
      real(wp), intent(out) :: a(n, rows), off(n)
      logical, intent(out) :: exists
      real(wp) :: left(n + rows, rows)            ! Each column an equation: the Jacobian, and what has been added up.
      real(wp) :: x(n), room
      integer :: equation(n), k, i
      logical :: taken(rows)

      ! Gauss and Jordan's elimination.
      exists = .true.
      left(:n, :) = transpose(jacobian)
      left(n + 1:, :) = 0.0_wp
      do i = 1, rows
         left(n + i, i) = 1.0_wp
      end do
      taken = .false.
      do k = 1, n
         equation(k) = maxloc(abs(left(k, :)), dim=1, mask=.not. taken)
         associate (own => equation(k))
            taken(own) = .true.
            exists = abs(left(k, own)) > 0.0_wp
            if (.not. exists) return
            left(k + 1:, own) = left(k + 1:, own)/left(k, own)
            do i = 1, rows
               if (i == own .or. .not. abs(left(k, i)) > 0.0_wp) cycle
               left(k + 1:, i) = left(k + 1:, i) - left(k, i)*left(k + 1:, own)
            end do
         end associate
      end do
      do k = 1, n
         a(k, :) = left(n + 1:, equation(k))
      end do

      off = (n + 2)*rounding
      do k = 1, n
         x = 0.0_wp
         x(k) = -1.0_wp
         do i = 1, rows
            if (abs(jacobian(i, k)) > 0.0_wp) x = x + a(:, i)*jacobian(i, k)
         end do
         off = off + abs(x)
      end do

      ! What rounding leaves open of all terms; room, too, for products that underflow.
      room = 1.0_wp + (64 + 4*rows)*rounding
      do i = 1, rows
         a(:, i) = abs(a(:, i))*room
         off = off + a(:, i)*((rows + 2)*rounding*sum(abs(jacobian(i, :))))
      end do
      off = off*room**2
   end subroutine bound_inverse

   !> `x` (n): |A| `v` (rows), rounded up.
   pure subroutine apply(rows, n, a, v, x)
      integer, intent(in) :: rows, n
      real(wp), intent(in) :: a(n, rows), v(rows)
      real(wp), intent(out) :: x(n)
      integer :: k

      x = 0.0_wp
      do k = 1, rows
         x = x + a(:, k)*v(k)
      end do
      ! For products that underflow; what is at rest is so exactly.
      if (any(v > 0.0_wp)) x = x*(1.0_wp + (16 + rows)*rounding) + tiny(1.0_wp)
   end subroutine apply

   !> The radius of a ball about the centre, where |A| |F| <= `eta`, that is mapped into itself with these `z1` and
   !> `z2`; -1: none.
   pure real(wp) function radius_of(z1, z2, eta) result(r)
      real(wp), intent(in) :: z1, z2, eta
      real(wp) :: root

      r = -1.0_wp
      root = (1.0_wp - z1)**2 - 2.0_wp*z2*eta
      if (root > 0.0_wp .and. z1 <= max_rate) r = 2.0_wp*eta/(1.0_wp - z1 + sqrt(root))*larger
   end function radius_of
end module contraction
