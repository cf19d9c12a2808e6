!> The natural C2 cubic spline through the rows of a table.
!>
!> With h_i = x_(i+1) - x_i and M_i the second derivative at knot i (M = 0 at both ends):
!>    h_(i-1) M_(i-1) + 2 (h_(i-1) + h_i) M_i + h_i M_(i+1) = 6 (d_i - d_(i-1)),  d_i = (y_(i+1) - y_i)/h_i
!> (de Boor, A Practical Guide to Splines, ch. IV). Two rows give the straight line.
module spline
   use kinds, only: wp
   use linear_solver, only: solve_tridiagonal
   implicit none
   private
   public :: spline_t, new_spline, spline_value, piece_at, piece_value

   type :: spline_t
      real(wp), allocatable :: x(:), y(:), m(:)   !< knots (increasing), values, second derivatives
   end type spline_t

contains

   !> The spline through the points (x, y); x strictly increasing, at least two.
   function new_spline(x, y) result(s)
      real(wp), intent(in) :: x(:), y(:)
      type(spline_t) :: s
      real(wp) :: h(size(x) - 1), slope(size(x) - 1), diagonal(size(x) - 2), off(size(x) - 2)
      integer :: n, info

      n = size(x)
      h = x(2:) - x(:n - 1)
      slope = (y(2:) - y(:n - 1))/h
      s%x = x
      s%y = y
      allocate (s%m(n), source=0.0_wp)
      if (n < 3) return
      diagonal = 2.0_wp*(h(:n - 2) + h(2:))
      off(:n - 3) = h(2:n - 2)
      s%m(2:n - 1) = 6.0_wp*(slope(2:) - slope(:n - 2))
      call solve_tridiagonal(diagonal, off, s%m(2:n - 1), info)
   end function new_spline

   !> Value, first and second derivative at `t` within the table.
   pure function spline_value(s, t) result(f)
      type(spline_t), intent(in) :: s
      real(wp), intent(in) :: t
      real(wp) :: f(3)

      f = piece_value(s, piece_at(s, t), t)
   end function spline_value

   !> The same of the cubic between the knots `i` and `i` + 1.
   pure function piece_value(s, i, t) result(f)
      type(spline_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp), intent(in) :: t
      real(wp) :: f(3)
      real(wp) :: h, u, w

      h = s%x(i + 1) - s%x(i)
      u = t - s%x(i)
      w = s%x(i + 1) - t
      ! Two-point form: both ends enter alike, so that each knot returns its own value.
      f(1) = (s%m(i)*w**3 + s%m(i + 1)*u**3)/(6.0_wp*h) &
         + (s%y(i)/h - s%m(i)*h/6.0_wp)*w + (s%y(i + 1)/h - s%m(i + 1)*h/6.0_wp)*u
      f(2) = (s%m(i + 1)*u**2 - s%m(i)*w**2)/(2.0_wp*h) &
         + (s%y(i + 1) - s%y(i))/h - (s%m(i + 1) - s%m(i))*h/6.0_wp
      f(3) = (s%m(i)*w + s%m(i + 1)*u)/h
   end function piece_value

   !> The i with x(i) <= t <= x(i + 1), by bisection; the first or the last where `t` lies beyond the table.
   pure integer function piece_at(s, t) result(low)
      type(spline_t), intent(in) :: s
      real(wp), intent(in) :: t
      integer :: high, middle

      low = 1
      high = size(s%x)
      do while (high - low > 1)
         middle = (low + high)/2
         if (s%x(middle) <= t) then
            low = middle
         else
            high = middle
         end if
      end do
   end function piece_at
end module spline
