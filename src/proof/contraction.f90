!> Newton and Kantorovich's argument with an approximate inverse A of a Jacobian: x - A F(x) maps the ball of radius r
!> about c into itself and contracts it, if
!>
!>    |A| |F(c)| + z1 r + z2 r^2/2 <= r,   z1 >= |1 - A J(c)|,   z2 >= |A| (growth of J)      (maximum norm)
!>
!> So F has exactly one zero in the ball, J is regular in all of it, and z1 + z2 r < 1. (Ortega and Rheinboldt, ch. 12;
!> the form with bounds from data is that of Day, Lessard and Mischaikow's radii polynomials.)
!>
!> All bounds are sums of products of numbers that are not negative, rounded to nearest and then enlarged by more than
!> their roundings can amount to (Rump, Acta Numerica 2010): no rounding mode is switched.
module contraction
   use kinds, only: wp
   use linear_solver, only: factors_t, new_factors, factor, solve
   use proof_data, only: rounding
   implicit none
   private
   public :: contraction_t, contract, radius_of, applied, max_radius

   !> No ball is larger: slides grow no more in it. In radians and units of the block.
   real(wp), parameter :: max_radius = 0.25_wp
   !> A map that contracts less is not used: 1 less its rate is a divisor.
   real(wp), parameter :: max_rate = 0.999_wp

   !> Of one block; |A| enlarged by the room for roundings.
   type :: contraction_t
      integer :: n = 0
      logical :: exists = .false.                 !< there is an inverse
      real(wp), allocatable :: inverse(:, :)      !< (n, n) |A|
      real(wp), allocatable :: off(:)             !< (n) row sums of |1 - A J| at the centre
      real(wp) :: z1 = 0.0_wp, z2 = 0.0_wp        !< see above
   end type contraction_t

contains

   !> The contraction by the inverse of `jacobian` (n, n), whose rows can be off by `change` (n) and grow by
   !> `growth` (n).
   subroutine contract(jacobian, change, growth, c)
      real(wp), intent(in) :: jacobian(:, :), change(:), growth(:)
      type(contraction_t), intent(inout) :: c
      real(wp) :: a(size(change), size(change)), sums(size(change)), room
      integer :: i, k

      c%n = size(change)
      call invert(jacobian, a, c%exists)
      if (.not. c%exists) return
      room = 1.0_wp + (64 + 4*c%n)*rounding
      do i = 1, c%n
         sums(i) = sum(abs(jacobian(i, :)))
      end do
      if (allocated(c%inverse)) then
         if (size(c%off) /= c%n) deallocate (c%inverse, c%off)
      end if
      if (.not. allocated(c%inverse)) allocate (c%inverse(c%n, c%n), c%off(c%n))
      do i = 1, c%n
         c%off(i) = 0.0_wp
         do k = 1, c%n
            c%off(i) = c%off(i) + abs(dot_product(a(i, :), jacobian(:, k)) - merge(1.0_wp, 0.0_wp, i == k))
         end do
         c%off(i) = (c%off(i) + (c%n + 2)*rounding*(1.0_wp + dot_product(abs(a(i, :)), sums)))*room
      end do
      c%inverse = abs(a)*room
      c%off = (c%off + applied(c, change))*room
      c%z1 = maxval(c%off)
      c%z2 = 0.0_wp
      if (c%n > 0) c%z2 = maxval(applied(c, growth))
      c%exists = c%z1 < 1.0_wp
   end subroutine contract

   !> |A| `v`, rounded up.
   pure function applied(c, v) result(x)
      type(contraction_t), intent(in) :: c
      real(wp), intent(in) :: v(:)
      real(wp) :: x(c%n)
      integer :: k

      x = 0.0_wp
      do k = 1, c%n
         x = x + c%inverse(:, k)*v(k)
      end do
      x = x*(1.0_wp + (16 + c%n)*rounding)
      ! For products that underflow; what is at rest is so exactly.
      if (any(v > 0.0_wp)) x = x + tiny(1.0_wp)
   end function applied

   !> The radius of the least ball about the centre, where |A| |F| <= `eta`, that is mapped into itself; -1: none.
   pure real(wp) function radius_of(c, eta) result(r)
      type(contraction_t), intent(in) :: c
      real(wp), intent(in) :: eta
      real(wp) :: root

      r = -1.0_wp
      if (.not. c%exists) return
      root = (1.0_wp - c%z1)**2 - 2.0_wp*c%z2*eta
      if (.not. root > 0.0_wp) return
      r = 2.0_wp*eta/(1.0_wp - c%z1 + sqrt(root))*(1.0_wp + 1.0e-3_wp)
      if (.not. ((eta + r*(c%z1 + 0.5_wp*c%z2*r))*(1.0_wp + 32.0_wp*rounding) <= r .and. &
         c%z1 + c%z2*r <= max_rate .and. r <= max_radius)) r = -1.0_wp
   end function radius_of

   !> `a` becomes about the inverse of `jacobian`; `exists`: it has one.
   subroutine invert(jacobian, a, exists)
      real(wp), intent(in) :: jacobian(:, :)
      real(wp), intent(out) :: a(:, :)
      logical, intent(out) :: exists
      type(factors_t) :: f
      real(wp) :: determinant
      integer :: k, info

      exists = .true.
      select case (size(jacobian, 1))
      case (0)
      case (1)
         exists = abs(jacobian(1, 1)) > 0.0_wp
         if (exists) a = 1.0_wp/jacobian
      case (2)
         determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
         exists = abs(determinant) > 0.0_wp
         if (exists) a = reshape([jacobian(2, 2), -jacobian(2, 1), -jacobian(1, 2), jacobian(1, 1)], [2, 2])/determinant
      case default
         f = new_factors(size(jacobian, 1))
         f%a = jacobian
         call factor(f, info)
         exists = info == 0
         if (.not. exists) return
         a = 0.0_wp
         do k = 1, f%n
            a(k, k) = 1.0_wp
            call solve(f, a(:, k))
         end do
      end select
      if (exists) exists = all(abs(a) <= huge(1.0_wp))
   end subroutine invert
end module contraction
