!> Where equations are too many: by how much they contradict one another.
module block_gaps
   use kinds, only: wp
   use convergence, only: convergence_t
   use blocks, only: blocks_t
   implicit none
   private
   public :: note_gap, is_open, contradict

   !> Gaps that differ by less than this part are alike.
   real(wp), parameter :: alike = 1.0e-4_wp
   !> Positions may contradict one another by this, in characteristic lengths and radians, as data of 11 digits do.
   real(wp), parameter :: open_level = max(1.0e-10_wp, 64.0_wp*epsilon(1.0_wp))
   !> Rates may by this part of them, which a condition makes larger.
   real(wp), parameter :: open_rates = max(1.0e-8_wp, 4096.0_wp*epsilon(1.0_wp))
   !> Beside what is known the arms of a polygon may be so short that rounding opens it by more: by so many roundings of
   !> what is known.
   real(wp), parameter :: roundings = 64.0_wp, rate_roundings = 4096.0_wp

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
         largest = max(largest, opening(b, m, r)/level_of(b, m))
      end do
      c%gap = 0.0_wp
      c%open_pair = 0
      c%open_drive = 0
      do m = b%list(i)%first_instance, b%list(i)%last_instance
         associate (row => b%rows(b%list(i)%first_row + max(b%instances(m)%row_x, b%instances(m)%row_y) - 1))
            if (opening(b, m, r)/level_of(b, m) < (1.0_wp - alike)*largest) cycle
            if (row%pair < c%open_pair .or. (row%pair == 0 .and. row%drive < c%open_drive)) cycle
            c%gap = opening(b, m, r)
            c%gap_level = level_of(b, m)
            c%gap_unit = b%instances(m)%unit
            c%gap_is_angle = row%angular
            c%open_pair = row%pair
            c%open_drive = row%drive
         end associate
      end do
   end subroutine note_gap

   !> The gap of `c` is more than rounding.
   pure logical function is_open(c)
      type(convergence_t), intent(in) :: c

      is_open = c%gap > open_level*c%gap_level
   end function is_open

   !> How many times as large as usual a gap of instance `m` may be.
   pure real(wp) function level_of(b, m)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m

      level_of = max(1.0_wp, b%instances(m)%coarse*(roundings*epsilon(1.0_wp)/open_level))
   end function level_of

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
   !> remains open (DGEQRF); `size_of`: numbers of this size have gone into them; `coarse`: of the block.
   pure logical function contradict(x, n, size_of, coarse)
      real(wp), intent(in) :: x(:), size_of, coarse
      integer, intent(in) :: n

      contradict = norm2(x(n + 1:)) > max(open_rates, rate_roundings*epsilon(1.0_wp)*coarse) &
         *max(norm2(x(:n)), size_of)
   end function contradict
end module block_gaps
