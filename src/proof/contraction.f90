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
   use linear_solver, only: factors_t, new_factors, factor, solve_transposed
   use proof_data, only: rounding
   implicit none
   private
   public :: contraction_t, contract, radius_of, apply, max_radius

   !> No ball is larger: slides grow no more in it. In radians and units of the block.
   real(wp), parameter :: max_radius = 0.25_wp
   !> A map that contracts less is not used: 1 less its rate is a divisor.
   real(wp), parameter :: max_rate = 0.999_wp

   !> Of one block; |A| enlarged by the room for roundings.
   type :: contraction_t
      logical :: exists = .false.                 !< there is an inverse
      real(wp), allocatable :: inverse(:, :)      !< (n, n) |A|
      real(wp), allocatable :: off(:)             !< (n) row sums of |1 - A J| at the centre
      real(wp) :: z1 = 0.0_wp, z2 = 0.0_wp        !< see above
      real(wp) :: norm = 0.0_wp                   !< the largest row sum of |A|
      real(wp), allocatable, private :: v(:), x(:), y(:)   !< (n) room for sums
   end type contraction_t

contains

   !> The contraction by the inverse of `jacobian` (n, n), whose rows can be off by `change` (n) and grow by
   !> `growth` (n).
   subroutine contract(n, jacobian, change, growth, c)
      integer, intent(in) :: n
      real(wp), intent(in) :: jacobian(n, n), change(n), growth(n)
      type(contraction_t), intent(inout) :: c
      integer :: k

      if (.not. allocated(c%inverse)) allocate (c%inverse(n, n), c%off(n), c%v(n), c%x(n), c%y(n))
      c%z1 = 0.0_wp
      c%z2 = 0.0_wp
      c%norm = 0.0_wp
      c%exists = .true.
      if (n == 0) return
      call invert(n, jacobian, c%inverse, c%exists)
      if (.not. c%exists) return
      if (n == 2) then
         call find_off_of_two(jacobian, change, growth, c%inverse, c%y, c%off)
      else
         call find_off(n, jacobian, change, growth, c%inverse, c%v, c%x, c%y, c%off)
      end if
      c%z1 = maxval(c%off)
      c%z2 = maxval(c%y)
      c%x(:) = c%inverse(:, 1)
      do k = 2, n
         c%x(:) = c%x + c%inverse(:, k)
      end do
      c%norm = maxval(c%x)*(1.0_wp + (16 + n)*rounding)
      c%exists = all(c%off < 1.0_wp) .and. all(c%y <= huge(1.0_wp))
   end subroutine contract

   !> `off` (n): the row sums of |1 - A J|, where rows of the Jacobian J (n, n) can be off by `change` (n); `grown` (n):
   !> |A| `growth` (n). `a` (n, n): A, afterwards |A| with the room for roundings. `v`, `x`: room.
   pure subroutine find_off(n, jacobian, change, growth, a, v, x, grown, off)
      integer, intent(in) :: n
      real(wp), intent(in) :: jacobian(n, n), change(n), growth(n)
      real(wp), intent(inout) :: a(n, n)
      real(wp), intent(out) :: v(n), x(n), grown(n), off(n)
      real(wp) :: room
      integer :: i, k

      do k = 1, n
         x = a(:, 1)*jacobian(1, k)
         x(k) = x(k) - 1.0_wp
         do i = 2, n
            if (abs(jacobian(i, k)) > 0.0_wp) x = x + a(:, i)*jacobian(i, k)
         end do
         if (k == 1) then
            off = abs(x)
            v = abs(jacobian(:, 1))
         else
            off = off + abs(x)
            v = v + abs(jacobian(:, k))
         end if
      end do
      room = 1.0_wp + (64 + 4*n)*rounding
      do k = 1, n
         a(:, k) = abs(a(:, k))*room
         ! What rounding leaves open of n + 1 terms.
         v(k) = change(k) + (n + 2)*rounding*v(k)
      end do
      x = a(:, 1)*v(1)
      grown = a(:, 1)*growth(1)
      do k = 2, n
         x = x + a(:, k)*v(k)
         grown = grown + a(:, k)*growth(k)
      end do
      ! Room, too, for products that underflow.
      off = (off + (n + 2)*rounding + x)*(room*room)
      grown = grown*room + tiny(1.0_wp)
   end subroutine find_off

   !> The same of two unknowns, as most blocks have.
   pure subroutine find_off_of_two(jacobian, change, growth, a, grown, off)
      real(wp), intent(in) :: jacobian(2, 2), change(2), growth(2)
      real(wp), intent(inout) :: a(2, 2)
      real(wp), intent(out) :: grown(2), off(2)
      real(wp), parameter :: room = 1.0_wp + 72.0_wp*rounding
      real(wp) :: b(2), v(2)

      b(1) = abs(a(1, 1)*jacobian(1, 1) + a(1, 2)*jacobian(2, 1) - 1.0_wp) &
         + abs(a(1, 1)*jacobian(1, 2) + a(1, 2)*jacobian(2, 2))
      b(2) = abs(a(2, 1)*jacobian(1, 1) + a(2, 2)*jacobian(2, 1)) &
         + abs(a(2, 1)*jacobian(1, 2) + a(2, 2)*jacobian(2, 2) - 1.0_wp)
      v(1) = change(1) + 4.0_wp*rounding*(abs(jacobian(1, 1)) + abs(jacobian(1, 2)))
      v(2) = change(2) + 4.0_wp*rounding*(abs(jacobian(2, 1)) + abs(jacobian(2, 2)))
      a = abs(a)*room
      off(1) = (b(1) + 4.0_wp*rounding + a(1, 1)*v(1) + a(1, 2)*v(2))*room**2
      off(2) = (b(2) + 4.0_wp*rounding + a(2, 1)*v(1) + a(2, 2)*v(2))*room**2
      grown(1) = (a(1, 1)*growth(1) + a(1, 2)*growth(2))*room + tiny(1.0_wp)
      grown(2) = (a(2, 1)*growth(1) + a(2, 2)*growth(2))*room + tiny(1.0_wp)
   end subroutine find_off_of_two

   !> `x` (n): |A| `v` (n), rounded up.
   pure subroutine apply(c, v, x)
      type(contraction_t), intent(in) :: c
      real(wp), intent(in) :: v(size(c%off))
      real(wp), intent(out) :: x(size(c%off))
      integer :: k

      if (size(x) == 0) return
      x = c%inverse(:, 1)*v(1)
      do k = 2, size(x)
         x = x + c%inverse(:, k)*v(k)
      end do
      x = x*(1.0_wp + (16 + size(x))*rounding)
      ! For products that underflow; what is at rest is so exactly.
      if (any(v > 0.0_wp)) x = x + tiny(1.0_wp)
   end subroutine apply

   !> The radius of the least ball about the centre, where |A| |F| <= `eta`, that is mapped into itself with these `z1`
   !> and `z2`; -1: none.
   pure real(wp) function radius_of(z1, z2, eta) result(r)
      real(wp), intent(in) :: z1, z2, eta
      real(wp) :: root

      r = -1.0_wp
      root = (1.0_wp - z1)**2 - 2.0_wp*z2*eta
      if (.not. (root > 0.0_wp .and. z1 < 1.0_wp)) return
      r = 2.0_wp*eta/(1.0_wp - z1 + sqrt(root))*(1.0_wp + 1.0e-3_wp)
      if (.not. ((eta + r*(z1 + 0.5_wp*z2*r))*(1.0_wp + 32.0_wp*rounding) <= r .and. &
         z1 + z2*r <= max_rate .and. r <= max_radius)) r = -1.0_wp
   end function radius_of

   !> `a` becomes about the inverse of `jacobian`, both (n, n); `exists`: it has one.
   subroutine invert(n, jacobian, a, exists)
      integer, intent(in) :: n
      real(wp), intent(in) :: jacobian(n, n)
      real(wp), intent(out) :: a(n, n)
      logical, intent(out) :: exists
      type(factors_t) :: f
      real(wp) :: determinant
      integer :: k, info

      exists = .true.
      select case (n)
      case (0)
      case (1)
         exists = abs(jacobian(1, 1)) > 0.0_wp
         if (exists) a(1, 1) = 1.0_wp/jacobian(1, 1)
      case (2)
         determinant = jacobian(1, 1)*jacobian(2, 2) - jacobian(1, 2)*jacobian(2, 1)
         exists = abs(determinant) > 0.0_wp
         if (.not. exists) return
         a(:, 1) = [jacobian(2, 2), -jacobian(2, 1)]/determinant
         a(:, 2) = [-jacobian(1, 2), jacobian(1, 1)]/determinant
      case default
         f = new_factors(n)
         f%a = jacobian
         call factor(f, info)
         exists = info == 0
         if (.not. exists) return
         a = 0.0_wp
         do k = 1, n
            a(k, k) = 1.0_wp
         end do
         call solve_transposed(f, a)
         a = transpose(a)
      end select
   end subroutine invert
end module contraction
