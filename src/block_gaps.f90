!> Level 5. Where equations are too many: by how much they contradict one another.
module block_gaps
   use kinds, only: wp
   use convergence, only: convergence_t
   use blocks, only: blocks_t
   implicit none
   private
   public :: note_gap, contradict, open_level

   !> Gaps that differ by less than this part are alike.
   real(wp), parameter :: alike = 1.0e-4_wp
   !> Positions may contradict one another by this, in characteristic lengths and radians, as data of 11 digits do.
   real(wp), parameter :: open_level = max(1.0e-10_wp, 64.0_wp*epsilon(1.0_wp))
   !> Rates may by this part of them, which a condition makes larger.
   real(wp), parameter :: open_rates = max(1.0e-8_wp, 4096.0_wp*epsilon(1.0_wp))

contains

   !> The pair or drive that is open the most by the residuals `r`: a revolute pair by the distance of its points. Of
   !> those that are open alike the last pair of the deck, or the last drive: rounding shall not choose.
   pure subroutine note_gap(b, i, r, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: r(*)
      type(convergence_t), intent(inout) :: c
      real(wp) :: largest
      integer :: m

      largest = 0.0_wp
      do m = b%list(i)%first_instance, b%list(i)%last_instance
         largest = max(largest, opening(b, m, r))
      end do
      c%gap = 0.0_wp
      c%open_pair = 0
      c%open_drive = 0
      do m = b%list(i)%first_instance, b%list(i)%last_instance
         associate (row => b%rows(b%list(i)%first_row + max(b%instances(m)%row_x, b%instances(m)%row_y) - 1))
            if (opening(b, m, r) < (1.0_wp - alike)*largest) cycle
            if (row%pair < c%open_pair .or. (row%pair == 0 .and. row%drive < c%open_drive)) cycle
            c%gap = opening(b, m, r)
            c%gap_is_angle = row%angular
            c%open_pair = row%pair
            c%open_drive = row%drive
         end associate
      end do
   end subroutine note_gap

   !> By how much instance `m` is open.
   pure real(wp) function opening(b, m, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      real(wp), intent(in) :: r(*)

      associate (g => b%instances(m))
         opening = 0.0_wp
         if (g%row_x > 0) opening = abs(r(g%row_x))
         if (g%row_y > 0) opening = hypot(opening, r(g%row_y))
      end associate
   end function opening

   !> The equations of the least squares `x` contradict one another: their first `n` are the solution, the others what
   !> remains open (DGEQRF); `size_of`: numbers of this size have gone into them.
   pure logical function contradict(x, n, size_of)
      real(wp), intent(in) :: x(:), size_of
      integer, intent(in) :: n

      contradict = norm2(x(n + 1:)) > open_rates*max(norm2(x(:n)), size_of)
   end function contradict
end module block_gaps
