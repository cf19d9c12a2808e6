!> Tests. Matrices in real128: the solution of linear equations, the spectral radius.
module quad_matrices
   use quad_jet, only: qp
   implicit none
   private
   public :: spectral_radius, solve_quad

contains

   !> Gelfand's limit |G^N|^(1/N) with N = 2^16, which a factor of a thousand in |G^N| moves by 1e-4.
   pure real(qp) function spectral_radius(g) result(rho)
      real(qp), intent(in) :: g(:, :)
      real(qp) :: power(size(g, 1), size(g, 1)), logarithm, length
      integer :: k
      integer, parameter :: squarings = 16
      !> Below it the square of a matrix of length 1 is rounding: the powers end in zero.
      real(qp), parameter :: nothing = 1.0e-30_qp

      power = g
      logarithm = 0.0_qp
      rho = 0.0_qp
      do k = 0, squarings
         if (k > 0) power = matmul(power, power)
         length = maxval(sum(abs(power), dim=2))
         if (length <= nothing) return
         power = power/length
         logarithm = 2.0_qp*logarithm + log(length)
      end do
      rho = exp(logarithm/2.0_qp**squarings)
   end function spectral_radius

   !> Replaces `b` (n, any number) by a^-1 b: Gauss, with the largest pivot of the column. `singular`: a pivot is
   !> rounding.
   pure subroutine solve_quad(a, b, singular)
      real(qp), intent(inout) :: a(:, :), b(:, :)
      logical, intent(out) :: singular
      real(qp), parameter :: rounding = 1.0e-24_qp
      real(qp) :: row_a(size(a, 2)), row_b(size(b, 2)), most
      integer :: i, k, n

      n = size(a, 1)
      most = maxval(abs(a))
      singular = .true.
      do k = 1, n
         i = k - 1 + maxloc(abs(a(k:, k)), dim=1)
         if (abs(a(i, k)) <= rounding*most) return
         row_a = a(i, :)
         a(i, :) = a(k, :)
         a(k, :) = row_a/row_a(k)
         row_b = b(i, :)
         b(i, :) = b(k, :)
         b(k, :) = row_b/row_a(k)
         do i = 1, n
            if (i == k .or. abs(a(i, k)) <= 0.0_qp) cycle
            b(i, :) = b(i, :) - a(i, k)*b(k, :)
            a(i, k:) = a(i, k:) - a(i, k)*a(k, k:)
         end do
      end do
      singular = .false.
   end subroutine solve_quad
end module quad_matrices
