!> By how much the equations of a redundant block contradict one another, in position and in its derivatives.
module closure_errors
   use kinds, only: wp
   use convergence, only: convergence_t, closure_error_t
   use blocks, only: blocks_t
   implicit none
   private
   public :: note_closure_error, is_inconsistent, contradict

   !> Closure errors that differ by less than this part are alike.
   real(wp), parameter :: alike = 1.0e-4_wp
   !> Positions may contradict one another by this, in characteristic lengths and radians, as data of 11 digits do.
   real(wp), parameter :: inconsistent_level = max(1.0e-10_wp, 64.0_wp*epsilon(1.0_wp))
   !> Rates may by this part of them, which a condition makes larger.
   real(wp), parameter :: open_rates = max(1.0e-8_wp, 4096.0_wp*epsilon(1.0_wp))
   !> Beside what is known the body vectors of a loop may be so short that rounding opens it by more: by so many
   !> roundings of what is known.
   real(wp), parameter :: roundings = 64.0_wp, rate_roundings = 4096.0_wp

contains

   !> The pair or drive that is open the most by the residuals `r`: a revolute pair by the distance of its points. Of
   !> those that are open alike the last pair of the deck, or the last drive: rounding shall not choose.
   pure subroutine note_closure_error(b, i, r, c)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: r(*)
      type(convergence_t), intent(inout) :: c
      real(wp) :: largest
      integer :: m

      largest = 0.0_wp
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         largest = max(largest, opening(b, m, r)/level_of(b, m))
      end do
      c%open%value = 0.0_wp
      c%open%pair = 0
      c%open%drive = 0
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (row => b%rows(b%list(i)%first_row + max(b%loops(m)%row_x, b%loops(m)%row_y) - 1))
            if (opening(b, m, r)/level_of(b, m) < (1.0_wp - alike)*largest) cycle
            if (row%pair < c%open%pair .or. (row%pair == 0 .and. row%drive < c%open%drive)) cycle
            c%open = closure_error_t(opening(b, m, r), row%angular, b%loops(m)%unit, level_of(b, m), row%pair, &
               row%drive)
         end associate
      end do
   end subroutine note_closure_error

   !> The closure error of `c` is more than rounding.
   pure logical function is_inconsistent(c)
      type(convergence_t), intent(in) :: c

      is_inconsistent = c%open%value > inconsistent_level*c%open%level
   end function is_inconsistent

   !> How many times as large as usual the closure error of loop `m` may be.
   pure real(wp) function level_of(b, m)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m

      level_of = max(1.0_wp, b%loops(m)%coarse*(roundings*epsilon(1.0_wp)/inconsistent_level))
   end function level_of

   !> By how much loop `m` is open.
   pure real(wp) function opening(b, m, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      real(wp), intent(in) :: r(*)

      associate (g => b%loops(m))
         opening = 0.0_wp
         if (g%row_x > 0) opening = abs(r(g%row_x))
         if (g%row_y > 0) opening = hypot(opening, r(g%row_y))
      end associate
   end function opening

   !> Equations that leave `open` of their rates contradict one another; `size_of`: numbers of this size have gone into
   !> them; `coarse`: of the block.
   pure logical function contradict(open, size_of, coarse)
      real(wp), intent(in) :: open(:), size_of, coarse

      contradict = norm2(open) > max(open_rates, rate_roundings*epsilon(1.0_wp)*coarse)*size_of
   end function contradict
end module closure_errors
