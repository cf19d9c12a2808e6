!> Tests. Matrices in real128: the solution of linear equations, the spectral radius.
module quad_matrices
   use quad_jet, only: qp
   use quad_lapack, only: getrf, getrs
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

   !> Replaces `b` (n, any number) by a^-1 b; `a` becomes its factors. `singular`: a pivot is rounding, and `b` is as it
   !> was.
   pure subroutine solve_quad(a, b, singular)
      real(qp), intent(inout) :: a(:, :), b(:, :)
      logical, intent(out) :: singular
      real(qp), parameter :: rounding = 1.0e-24_qp
      real(qp) :: most
      integer :: pivots(size(a, 1)), n, k, info

      n = size(a, 1)
      most = maxval(abs(a))
      call getrf(n, n, a, n, pivots, info)
      singular = any([(abs(a(k, k)), k=1, n)] <= rounding*most)
      if (.not. singular) call getrs('N', n, size(b, 2), a, n, pivots, b, n, info)
   end subroutine solve_quad
end module quad_matrices
