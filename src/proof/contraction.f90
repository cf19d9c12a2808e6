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
      real(wp), allocatable, private :: v(:), x(:)   !< (n) room for sums
   end type contraction_t

contains

   !> The contraction by the inverse of `jacobian` (n, n), whose rows can be off by `change` (n) and grow by
   !> `growth` (n).
   subroutine contract(n, jacobian, change, growth, c)
      integer, intent(in) :: n
      real(wp), intent(in) :: jacobian(n, n), change(n), growth(n)
      type(contraction_t), intent(inout) :: c

      if (.not. allocated(c%inverse)) allocate (c%inverse(n, n), c%off(n), c%v(n), c%x(n))
      call invert(n, jacobian, c%inverse, c%exists)
      if (.not. c%exists) return
      call find_off(n, jacobian, change, c%inverse, c%v, c%x, c%off)
      call apply(c, growth, c%x)
      c%z1 = 0.0_wp
      c%z2 = 0.0_wp
      if (n > 0) c%z1 = maxval(c%off)
      if (n > 0) c%z2 = maxval(c%x)
      c%exists = all(c%off < 1.0_wp) .and. all(c%x <= huge(1.0_wp))
   end subroutine contract

   !> `off` (n): the row sums of |1 - A J|, where rows of the Jacobian J (n, n) can be off by `change` (n). `a` (n, n):
   !> A, afterwards |A| with the room for roundings. `v`, `x`: room.
   pure subroutine find_off(n, jacobian, change, a, v, x, off)
      integer, intent(in) :: n
      real(wp), intent(in) :: jacobian(n, n), change(n)
      real(wp), intent(inout) :: a(n, n)
      real(wp), intent(out) :: v(n), x(n), off(n)
      real(wp) :: room
      integer :: i, k

      v = 0.0_wp
      off = 0.0_wp
      do k = 1, n
         x = 0.0_wp
         x(k) = -1.0_wp
         do i = 1, n
            if (abs(jacobian(i, k)) <= 0.0_wp) cycle
            x = x + a(:, i)*jacobian(i, k)
            v(i) = v(i) + abs(jacobian(i, k))
         end do
         off = off + abs(x)
      end do
      room = 1.0_wp + (64 + 4*n)*rounding
      a = abs(a)*room
      ! What rounding leaves open of n + 1 terms.
      v = change + (n + 2)*rounding*v
      call multiply(n, a, v, x)
      off = (off + (n + 2)*rounding + x)*room
   end subroutine find_off

   !> `x` (n): |A| `v` (n), rounded up.
   pure subroutine apply(c, v, x)
      type(contraction_t), intent(in) :: c
      real(wp), intent(in) :: v(*)
      real(wp), intent(out) :: x(*)

      call multiply(size(c%off), c%inverse, v, x)
   end subroutine apply

   !> The same of the matrix `a` (n, n).
   pure subroutine multiply(n, a, v, x)
      integer, intent(in) :: n
      real(wp), intent(in) :: a(n, n), v(n)
      real(wp), intent(out) :: x(n)
      integer :: k
      logical :: moves

      x = 0.0_wp
      moves = .false.
      do k = 1, n
         x = x + a(:, k)*v(k)
         moves = moves .or. v(k) > 0.0_wp
      end do
      x = x*(1.0_wp + (16 + n)*rounding)
      ! For products that underflow; what is at rest is so exactly.
      if (moves) x = x + tiny(1.0_wp)
   end subroutine multiply

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
      do k = 1, n
         exists = exists .and. all(abs(a(:, k)) <= huge(1.0_wp))
      end do
   end subroutine invert
end module contraction
