!> Level 5. Where equations are too many: by how much they contradict one another.
module block_gaps
   use kinds, only: wp
   use convergence, only: convergence_t
   use blocks, only: blocks_t
   implicit none
   private
   public :: note_gap, contradict, open_level

   !> Positions may contradict one another by this, in characteristic lengths and radians, as data of 11 digits do.
   real(wp), parameter :: open_level = 1.0e-10_wp
   !> Rates may by this part of them, which a condition makes larger.
   real(wp), parameter :: open_rates = 1.0e-8_wp

contains

   !> The equation that is open the most by the residuals `r`.
   pure subroutine note_gap(b, i, r, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: r(*)
      type(convergence_t), intent(inout) :: c
      integer :: k, worst

      worst = 1
      do k = 2, b%list(i)%shape%rows
         if (abs(r(k)) > abs(r(worst))) worst = k
      end do
      associate (row => b%rows(b%list(i)%first_row + worst - 1))
         c%gap = abs(r(worst))
         c%gap_is_angle = row%angular
         c%open_pair = row%pair
         c%open_drive = row%drive
      end associate
   end subroutine note_gap

   !> The equations of the least squares `x` contradict one another: their first `n` are the solution, the others what
   !> remains open (DGEQRF); `size_of`: numbers of this size have gone into them.
   pure logical function contradict(x, n, size_of)
      real(wp), intent(in) :: x(:), size_of
      integer, intent(in) :: n

      contradict = norm2(x(n + 1:)) > open_rates*max(norm2(x(:n)), size_of)
   end function contradict
end module block_gaps
