!> Scalars and vectors of the plane with their first two derivatives with respect to time, (0:2) and (2, 0:2), and how
!> these change, to first order, with what they depend on.
module jets
   use kinds, only: wp
   use planar, only: quarter_turn
   implicit none
   private
   public :: turning, turning_change, scaled, dotted, turned

contains

   !> The vector `w` (2), which turns with the angle `f` (0:2):  w,  f' w_t,  f'' w_t - f'^2 w,  w_t its quarter turn.
   pure function turning(w, f) result(x)
      real(wp), intent(in) :: w(2), f(0:2)
      real(wp) :: x(2, 0:2)

      x(:, 0) = w
      x(:, 1) = f(1)*quarter_turn(w)
      x(:, 2) = f(2)*quarter_turn(w) - f(1)**2*w
   end function turning

   !> Its change where its angle changes by `df` (0:2), and it by `dw` (2) beside that.
   pure function turning_change(w, dw, f, df) result(dx)
      real(wp), intent(in) :: w(2), dw(2), f(0:2), df(0:2)
      real(wp) :: dx(2, 0:2), d(2)

      d = dw + df(0)*quarter_turn(w)
      dx = turning(d, f)
      dx(:, 1) = dx(:, 1) + df(1)*quarter_turn(w)
      dx(:, 2) = dx(:, 2) + df(2)*quarter_turn(w) - 2.0_wp*f(1)*df(1)*w
   end function turning_change

   !> The product s x.
   pure function scaled(s, x) result(y)
      real(wp), intent(in) :: s(0:2), x(2, 0:2)
      real(wp) :: y(2, 0:2)

      y(:, 0) = s(0)*x(:, 0)
      y(:, 1) = s(1)*x(:, 0) + s(0)*x(:, 1)
      y(:, 2) = s(2)*x(:, 0) + 2.0_wp*s(1)*x(:, 1) + s(0)*x(:, 2)
   end function scaled

   !> The product x . y.
   pure function dotted(x, y) result(s)
      real(wp), intent(in) :: x(2, 0:2), y(2, 0:2)
      real(wp) :: s(0:2)

      s(0) = dot_product(x(:, 0), y(:, 0))
      s(1) = dot_product(x(:, 1), y(:, 0)) + dot_product(x(:, 0), y(:, 1))
      s(2) = dot_product(x(:, 2), y(:, 0)) + 2.0_wp*dot_product(x(:, 1), y(:, 1)) + dot_product(x(:, 0), y(:, 2))
   end function dotted

   !> The quarter turn of `x`.
   pure function turned(x) result(y)
      real(wp), intent(in) :: x(2, 0:2)
      real(wp) :: y(2, 0:2)

      y(1, :) = -x(2, :)
      y(2, :) = x(1, :)
   end function turned
end module jets
