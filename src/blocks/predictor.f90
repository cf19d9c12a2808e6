!> The prediction of the next position from the motions before: the start of Newton's method.
!>
!> From one instant:  x + h (v + h a/2), error h^3 x'''/6.
!> From three at equal steps h, latest first: the integral over the next step of the quintic that has their velocities
!> and accelerations (Hermite),
!>    x_0 + h (-949 v_0 + 608 v_1 + 581 v_2)/240 + h^2 (637 a_0 + 1080 a_1 + 173 a_2)/240,  error 0.0112 h^7 x^(7).
!> Rejected: a polynomial through earlier positions as well. It gains an order, but brings their rounding back
!> many times over, and a start that is wrong by rounding alone costs a second factorization.
!>
!> For comparison (--study) the order can be given: x_0 alone, with its velocity, with its acceleration as well, and
!> with the third derivative as the difference of two accelerations.
module predictor
   use kinds, only: wp
   use mechanism, only: own_predictor
   use block_state, only: unknown_t
   implicit none
   private
   public :: history_t, new_history, remember, predict, is_even, largest_change, order_weights

   !> The largest predicted change, in radians and in the unit of length, that one step may have: beyond it a
   !> prediction that agrees with a position may do so by chance.
   real(wp), parameter :: largest_change = 1.0_wp
   real(wp), parameter :: weight(0:2) = [-949.0_wp, 608.0_wp, 581.0_wp]/240.0_wp
   real(wp), parameter :: weight2(0:2) = [637.0_wp, 1080.0_wp, 173.0_wp]/240.0_wp
   !> Steps that differ by less, relatively, count as equal: instants are rounded too.
   real(wp), parameter :: equal_step = max(1.0e-6_wp, 4096.0_wp*epsilon(1.0_wp))

   !> The last three motions; column place(0) is the latest.
   type :: history_t
      integer, allocatable :: predicted(:)                 !< the unknowns that iterations solve for
      integer :: order = own_predictor                  !< 0 to 3, or as above
      integer :: filled = 0                             !< motions that are there, 0 to 3
      integer :: place(0:2) = [0, 1, 2]                 !< columns, latest first
      real(wp) :: t(0:2) = 0.0_wp                       !< (columns) their times
      real(wp), allocatable :: value(:)                 !< (0:unknowns) of the latest
      real(wp), allocatable :: rate(:, :), acceleration(:, :)  !< (0:unknowns, 0:2)
   end type history_t

contains

   !> Room for `n` unknowns, of which those in the list `predicted` are predicted.
   pure function new_history(n, predicted) result(h)
      integer, intent(in) :: n, predicted(:)
      type(history_t) :: h

      h%predicted = predicted
      allocate (h%value(0:n), h%rate(0:n, 0:2), h%acceleration(0:n, 0:2), source=0.0_wp)
   end function new_history

   !> Makes the motion `u` (0:unknowns) at `t` the latest.
   pure subroutine remember(h, t, u)
      type(history_t), intent(inout) :: h
      real(wp), intent(in) :: t
      type(unknown_t), intent(in) :: u(0:)
      integer :: i, k, latest

      latest = h%place(2)
      h%place = [latest, h%place(0), h%place(1)]
      h%t(latest) = t
      do k = 1, size(h%predicted)
         i = h%predicted(k)
         h%value(i) = u(i)%value
         h%rate(i, latest) = u(i)%rate
         h%acceleration(i, latest) = u(i)%acceleration
      end do
      h%filled = min(h%filled + 1, 3)
   end subroutine remember

   !> Sets the values of `u` (0:unknowns) to those expected at `t`; at least one motion is remembered. `change`: the
   !> largest difference from the latest.
   pure subroutine predict(h, t, u, change)
      type(history_t), intent(in) :: h
      real(wp), intent(in) :: t
      type(unknown_t), intent(inout) :: u(0:)
      real(wp), intent(out) :: change
      real(wp) :: step, d, w(3)
      integer :: i, k
      logical :: even

      change = 0.0_wp
      associate (p => h%place(0), q => h%place(1), r => h%place(2), v => h%rate, a => h%acceleration)
         step = t - h%t(p)
         even = is_even(h, step)
         if (h%order /= own_predictor) w = order_weights(h%order, step, merge(h%t(p) - h%t(q), 0.0_wp, h%filled > 1))
         do k = 1, size(h%predicted)
            i = h%predicted(k)
            if (h%order /= own_predictor) then
               d = w(1)*v(i, p) + w(2)*a(i, p) + w(3)*(a(i, p) - a(i, q))
            else if (even) then
               d = step*(weight(0)*v(i, p) + weight(1)*v(i, q) + weight(2)*v(i, r) &
                  + step*(weight2(0)*a(i, p) + weight2(1)*a(i, q) + weight2(2)*a(i, r)))
            else
               d = step*(v(i, p) + 0.5_wp*step*a(i, p))
            end if
            u(i)%value = h%value(i) + d
            change = max(change, abs(d))
         end do
      end associate
   end subroutine predict

   !> Weights (3) of the velocity, the acceleration and the last change of the acceleration in a start of the given
   !> `order`, 0 to 3, `step` after the latest motion; `before`: the step that led to it, 0.0 where there was none.
   pure function order_weights(order, step, before) result(w)
      integer, intent(in) :: order
      real(wp), intent(in) :: step, before
      real(wp) :: w(3)

      w = 0.0_wp
      if (order >= 1) w(1) = step
      if (order >= 2) w(2) = 0.5_wp*step**2
      if (order >= 3 .and. abs(before) > 0.0_wp) w(3) = step**3/(6.0_wp*before)
   end function order_weights

   !> Three motions are remembered, and the next comes after the same step; no other order is asked for.
   pure logical function is_even(h, step)
      type(history_t), intent(in) :: h
      real(wp), intent(in) :: step

      is_even = h%filled == 3 .and. h%order == own_predictor
      if (.not. is_even) return
      associate (t => h%t, p => h%place)
         is_even = abs(t(p(0)) - t(p(1)) - step) <= equal_step*abs(step) &
            .and. abs(t(p(1)) - t(p(2)) - step) <= equal_step*abs(step)
      end associate
   end function is_even
end module predictor
