!> Natural cubic splines, twice continuously differentiable. With h_i = x_(i+1) - x_i, d_i = (y_(i+1) - y_i)/h_i and M_i
!> the second derivative at knot i (M = 0 at both ends):
!>    h_(i-1) M_(i-1) + 2 (h_(i-1) + h_i) M_i + h_i M_(i+1) = 6 (d_i - d_(i-1))
!> (de Boor, A Practical Guide to Splines, ch. IV). Two knots give the straight line.
module splines
   use kinds, only: wp
   use lapack, only: ptsv
   implicit none
   private
   public :: spline_t, new_spline, piece_at, piece_value

   !> A natural cubic spline.
   type :: spline_t
      real(wp), allocatable :: x(:), y(:), m(:)   !< (knots) times, increasing; values; second derivatives
   end type spline_t

contains

   !> Computes the natural cubic spline through points; two points give the straight line.
   function new_spline(times, values) result(s)
      real(wp), intent(in) :: times(:)       !< (knots, 2 or more) times, strictly increasing
      real(wp), intent(in) :: values(:)      !< (knots) values at these times, length or rad
      type(spline_t) :: s
      real(wp) :: h(size(times) - 1), slope(size(times) - 1), diagonal(size(times) - 2), off(size(times) - 2)
      integer :: n, info

      n = size(times)
      h = times(2:) - times(:n - 1)
      slope = (values(2:) - values(:n - 1))/h
      s%x = times
      s%y = values
      allocate (s%m(n), source=0.0_wp)
      if (n < 3) return
      diagonal = 2.0_wp*(h(:n - 2) + h(2:))
      off(:n - 3) = h(2:n - 2)
      s%m(2:n - 1) = 6.0_wp*(slope(2:) - slope(:n - 2))
      call ptsv(n - 2, 1, diagonal, off, s%m(2:n - 1), n - 2, info)
   end function new_spline

   !> Computes the value and the first and second derivative (3) of a piece of a spline at a time, in the unit of its
   !> values and the deck's unit of time. The cubic of the piece continues beyond the knots of the piece.
   pure function piece_value(spline, i, t) result(f)
      type(spline_t), intent(in) :: spline   !< as `new_spline` makes it
      integer, intent(in) :: i               !< number of the piece: between the knots i and i + 1
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3)
      real(wp) :: h, u, w, slope, bend

      h = spline%x(i + 1) - spline%x(i)
      u = t - spline%x(i)
      w = spline%x(i + 1) - t
      slope = (spline%y(i + 1) - spline%y(i))/h
      bend = (spline%m(i + 1) - spline%m(i))/h
      ! Counted from the nearer knot, at which the value is exactly the value of the table. Near the knot, in a piece
      ! that is much longer than its neighbour, no cubes of the long distance cancel.
      if (u < w) then
         slope = slope - h*(2.0_wp*spline%m(i) + spline%m(i + 1))/6.0_wp
         f = [spline%y(i) + u*(slope + u*(spline%m(i)/2.0_wp + u*bend/6.0_wp)), slope + u*(spline%m(i) + &
            u*bend/2.0_wp), &
            spline%m(i) + u*bend]
      else
         slope = slope + h*(spline%m(i) + 2.0_wp*spline%m(i + 1))/6.0_wp
         f = [spline%y(i + 1) - w*(slope - w*(spline%m(i + 1)/2.0_wp - w*bend/6.0_wp)), &
            slope - w*(spline%m(i + 1) - w*bend/2.0_wp), &
            spline%m(i + 1) - w*bend]
      end if
   end function piece_value

   !> Finds the piece i of a spline with x(i) <= t <= x(i + 1), by bisection; the first or the last piece if the time is
   !> beyond the table.
   pure integer function piece_at(spline, t) result(low)
      type(spline_t), intent(in) :: spline   !< as `new_spline` makes it
      real(wp), intent(in) :: t              !< time
      integer :: high, middle

      low = 1
      high = size(spline%x)
      do while (high - low > 1)
         middle = (low + high)/2
         if (spline%x(middle) <= t) then
            low = middle
         else
            high = middle
         end if
      end do
   end function piece_at
end module splines
