!> The equations of one block in all lanes: `block_equations` and what `block_state` knows, with one number a lane
!> where those have one. The formulas stand there.
module lane_equations
   use kinds, only: wp
   use blocks, only: loop_components, loop_projection
   use lane_sines, only: width, sines
   use lane_state, only: lanes_t
   implicit none
   private
   public :: set_lane_direction, find_lane_known, assemble_lanes, lane_right_hand_side

   real(wp), parameter :: one(width) = 1.0_wp
   real(wp), parameter :: x_axis(width, 2) = spread([1.0_wp, 0.0_wp], 1, width)
   real(wp), parameter :: y_axis(width, 2) = spread([0.0_wp, 1.0_wp], 1, width)

contains

   !> Cosine and sine of unknown `i`, if it is an angle.
   pure subroutine set_lane_direction(l, i)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i

      if (i <= l%blocks%orientations) &
         call sines(l%u(i)%now(1, 1), l%u(i)%now(1, 4), l%u(i)%now(1, 5))
   end subroutine set_lane_direction

   !> What earlier blocks give to the loops of block `i`: place, velocity, acceleration.
   pure subroutine find_lane_known(l, i)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i
      integer :: m, k

      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         call begin_known(l%loop(m)%ground, l%loop(m)%known)
         do k = l%blocks%loops(m)%first_vector, l%blocks%loops(m)%first_own - 1
            call add_known(l%vector(k)%d, l%u(l%blocks%body_vectors(k)%orientation)%now, l%loop(m)%known)
         end do
      end do
   end subroutine find_lane_known

   !> The sums `known` begin with `ground`, which does not move.
   pure subroutine begin_known(ground, known)
      real(wp), intent(in) :: ground(width, 2)
      real(wp), intent(out) :: known(width, 2, 0:2)

      known(:, :, 0) = ground
      known(:, :, 1:) = 0.0_wp
   end subroutine begin_known

   !> Adds the body vector `d`, which the unknown `u` rotates.
   pure subroutine add_known(d, u, known)
      real(wp), intent(in) :: d(width, 2), u(width, 5)
      real(wp), intent(inout) :: known(width, 2, 0:2)
      real(wp) :: x, y, square
      integer :: l

      do l = 1, width
         x = u(l, 4)*d(l, 1) - u(l, 5)*d(l, 2)
         y = u(l, 5)*d(l, 1) + u(l, 4)*d(l, 2)
         square = u(l, 2)*u(l, 2)
         known(l, 1, 0) = known(l, 1, 0) + x
         known(l, 2, 0) = known(l, 2, 0) + y
         known(l, 1, 1) = known(l, 1, 1) - u(l, 2)*y
         known(l, 2, 1) = known(l, 2, 1) + u(l, 2)*x
         known(l, 1, 2) = known(l, 1, 2) - u(l, 3)*y - square*x
         known(l, 2, 2) = known(l, 2, 2) + u(l, 3)*x - square*y
      end do
   end subroutine add_known

   !> Jacobian `a` (lanes, n*n by columns) and residual `r` (lanes, n) of block `i`. The columns 0 of both, as that of
   !> right-hand sides, take what no equation asks for, so that nothing need be asked.
   pure subroutine assemble_lanes(l, i, n, a, r)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n
      real(wp), intent(out) :: a(width, 0:n*n), r(width, 0:n)
      integer :: m, k

      a = 0.0_wp
      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         associate (g => l%blocks%loops(m))
            if (g%kind == loop_components) then
               call find_open(l, m)
               call component_rows(l, m, n, a, r)
            else if (g%kind == loop_projection) then
               call find_open(l, m)
               call projection_row(l, m, n, a, r)
            else
               r(:, g%row_x) = l%u(g%orientation)%now(:, 1) - l%u(g%less)%now(:, 1)
               a(:, g%orientation_at) = a(:, g%orientation_at) + 1.0_wp
               a(:, g%less_at) = a(:, g%less_at) - 1.0_wp
            end if
         end associate
      end do
      do k = l%blocks%list(i)%first_row, l%blocks%list(i)%last_row
         call subtract_value(l%constant(1, k), l%drive(1, 0, l%blocks%rows(k)%drive), &
            r(1, k - l%blocks%list(i)%first_row + 1))
      end do
   end subroutine assemble_lanes

   !> Subtracts from `r` the value that its equation asks for.
   pure subroutine subtract_value(constant, drive, r)
      real(wp), intent(in) :: constant(width), drive(width)
      real(wp), intent(inout) :: r(width)

      r = r - constant - drive
   end subroutine subtract_value

   !> The closure error of loop `m`, and the vectors that the block's own angles rotate.
   pure subroutine find_open(l, m)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: m
      integer :: k

      call copy(l%loop(m)%known, l%loop(m)%open)
      do k = l%blocks%loops(m)%first_own, l%blocks%loops(m)%last_vector
         call add_turned(l%vector(k)%d, l%u(l%blocks%body_vectors(k)%orientation)%now, l%vector(k)%turned, &
            l%loop(m)%open)
      end do
      do k = l%blocks%loops(m)%first_slide, l%blocks%loops(m)%last_slide
         call add_slide(l%slide(k)%d, l%u(l%blocks%slides(k)%orientation)%now, l%u(l%blocks%slides(k)%unknown)%now, &
            l%slide(k)%turned, l%loop(m)%open)
      end do
   end subroutine find_open

   !> x and y of `from` go `to`.
   pure subroutine copy(from, to)
      real(wp), intent(in) :: from(width, 2)
      real(wp), intent(out) :: to(width, 2)

      to = from
   end subroutine copy

   !> `turned`: the vector `d`, rotated by the unknown `u`; it is added to `open`.
   pure subroutine add_turned(d, u, turned, open)
      real(wp), intent(in) :: d(width, 2), u(width, 5)
      real(wp), intent(inout) :: turned(width, 2), open(width, 2)
      real(wp) :: x, y
      integer :: l

      do l = 1, width
         x = u(l, 4)*d(l, 1) - u(l, 5)*d(l, 2)
         y = u(l, 5)*d(l, 1) + u(l, 4)*d(l, 2)
         turned(l, 1) = x
         turned(l, 2) = y
         open(l, 1) = open(l, 1) + x
         open(l, 2) = open(l, 2) + y
      end do
   end subroutine add_turned

   !> The same, but added is the slide `s` along it.
   pure subroutine add_slide(d, u, s, turned, open)
      real(wp), intent(in) :: d(width, 2), u(width, 5), s(width)
      real(wp), intent(inout) :: turned(width, 2), open(width, 2)
      real(wp) :: x, y
      integer :: l

      do l = 1, width
         x = u(l, 4)*d(l, 1) - u(l, 5)*d(l, 2)
         y = u(l, 5)*d(l, 1) + u(l, 4)*d(l, 2)
         turned(l, 1) = x
         turned(l, 2) = y
         open(l, 1) = open(l, 1) + s(l)*x
         open(l, 2) = open(l, 2) + s(l)*y
      end do
   end subroutine add_slide

   !> Rows of the x and y components of loop `m`.
   pure subroutine component_rows(l, m, n, a, r)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m, n
      real(wp), intent(inout) :: a(width, 0:n*n), r(width, 0:n)
      integer :: k

      associate (g => l%blocks%loops(m))
         call put(l%loop(m)%open, r(1, g%row_x), r(1, g%row_y))
         do k = g%first_own, g%last_vector
            call put_across(l%vector(k)%turned, a(1, l%blocks%body_vectors(k)%at(1)), a(1, l%blocks%body_vectors(k)%at(2)))
         end do
         do k = g%first_slide, g%last_slide
            call add_slide_entries(l, k, 1, x_axis, n, a)
            call add_slide_entries(l, k, 2, y_axis, n, a)
         end do
      end associate
   end subroutine component_rows

   !> Entries of slide `k` in the row of the component along `f`, the first or second (`side`) of its loop.
   pure subroutine add_slide_entries(l, k, side, f, n, a)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: k, side, n
      real(wp), intent(in) :: f(width, 2)
      real(wp), intent(inout) :: a(width, 0:n*n)

      associate (slide => l%blocks%slides(k))
         if (slide%at(side) > 0) call add_dot(l%slide(k)%turned, f, a(1, slide%at(side)))
         if (slide%orientation_at(side) > 0) &
            call add_cross(l%u(slide%unknown)%now, l%slide(k)%turned, f, a(1, slide%orientation_at(side)))
      end associate
   end subroutine add_slide_entries

   !> Row of the projection of loop `m`.
   pure subroutine projection_row(l, m, n, a, r)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: m, n
      real(wp), intent(inout) :: a(width, 0:n*n), r(width, 0:n)
      integer :: k

      associate (g => l%blocks%loops(m))
         call project(l%loop(m)%direction, l%u(g%orientation)%now, l%loop(m)%open, l%loop(m)%f, r(1, g%row_x))
         do k = g%first_own, g%last_vector
            call add_cross(one, l%vector(k)%turned, l%loop(m)%f, a(1, l%blocks%body_vectors(k)%at(1)))
         end do
         do k = g%first_slide, g%last_slide
            call add_slide_entries(l, k, 1, l%loop(m)%f, n, a)
         end do
         if (g%orientation_at > 0) call add_cross(one, l%loop(m)%f, l%loop(m)%open, a(1, g%orientation_at))
      end associate
   end subroutine projection_row

   !> `f`: the direction `d`, rotated by the unknown `u`; `r`: what is `open` along it.
   pure subroutine project(d, u, open, f, r)
      real(wp), intent(in) :: d(width, 2), u(width, 5), open(width, 2)
      real(wp), intent(inout) :: f(width, 2), r(width)
      real(wp) :: x, y
      integer :: l

      do l = 1, width
         x = d(l, 1)*u(l, 4) - d(l, 2)*u(l, 5)
         y = d(l, 1)*u(l, 5) + d(l, 2)*u(l, 4)
         f(l, 1) = x
         f(l, 2) = y
         r(l) = open(l, 1)*x + open(l, 2)*y
      end do
   end subroutine project

   !> Right-hand side `v` (lanes, n) for the velocities (`order` 1) or, once these are known, the accelerations (2) of
   !> block `i`, with the vectors of the last `assemble_lanes`: once for each `find_lane_known`, to whose sums it adds.
   pure subroutine lane_right_hand_side(l, i, n, order, v)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n, order
      real(wp), intent(out) :: v(width, 0:n)
      integer :: k, m

      v = 0.0_wp
      do k = l%blocks%list(i)%first_row, l%blocks%list(i)%last_row
         if (l%blocks%rows(k)%drive > 0) &
            v(:, k - l%blocks%list(i)%first_row + 1) = l%drive(:, order, l%blocks%rows(k)%drive)
      end do
      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         associate (g => l%blocks%loops(m))
            if (g%kind == loop_components) then
               call add_given(l, m, order)
               call subtract(l%loop(m)%known(1, 1, order), v(1, g%row_x), v(1, g%row_y))
            else if (g%kind == loop_projection) then
               call add_given(l, m, order)
               call subtract_dot(l%loop(m)%known(1, 1, order), l%loop(m)%f, v(1, g%row_x))
               if (g%orientation > 0) call subtract_turning(l, m, order, v(1, g%row_x))
            end if
         end associate
      end do
   end subroutine lane_right_hand_side

   !> Adds to the derivative number `order` of what is known in loop `m` all that holds no unknown of that order.
   pure subroutine add_given(l, m, order)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: m, order
      integer :: k

      do k = l%blocks%loops(m)%first_own, merge(l%blocks%loops(m)%last_vector, 0, order == 2)
         call add_central(l%vector(k)%turned, l%u(l%blocks%body_vectors(k)%orientation)%now(1, 2), &
            l%loop(m)%known(1, 1, 2))
      end do
      do k = l%blocks%loops(m)%first_slide, l%blocks%loops(m)%last_slide
         associate (slide => l%blocks%slides(k), e => l%slide(k)%turned, s => l%u(l%blocks%slides(k)%unknown)%now, &
                    w => l%u(l%blocks%slides(k)%orientation)%now, g => l%loop(m)%known(:, :, order))
            if (order == 2) call add_along(e, -s(:, 1)*w(:, 2)**2, g)
            if (order == 2) call add_across(e, 2.0_wp*s(:, 2)*w(:, 2), g)
            if (slide%column == 0) call add_along(e, s(:, order + 1), g)
            if (slide%orientation_column == 0) call add_across(e, s(:, 1)*w(:, order + 1), g)
         end associate
      end do
   end subroutine add_given

   !> Subtracts from `v` what the rotation of the direction on which loop `m` is projected adds to its derivative number
   !> `order`, beside unknowns of that order.
   pure subroutine subtract_turning(l, m, order, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m, order
      real(wp), intent(inout) :: v(width)
      real(wp) :: rate(width, 2)
      integer :: k

      associate (g => l%blocks%loops(m))
         if (g%orientation_column == 0) &
            call add_cross(-l%u(g%orientation)%now(:, order + 1), l%loop(m)%f, l%loop(m)%open, v)
         if (order == 1) return
         call copy(l%loop(m)%known(1, 1, 1), rate)
         do k = g%first_own, g%last_vector
            call add_across(l%vector(k)%turned, l%u(l%blocks%body_vectors(k)%orientation)%now(1, 2), rate)
         end do
         do k = g%first_slide, g%last_slide
            associate (slide => l%blocks%slides(k), s => l%u(l%blocks%slides(k)%unknown)%now, &
                       w => l%u(l%blocks%slides(k)%orientation)%now)
               if (slide%column > 0) call add_along(l%slide(k)%turned, s(:, 2), rate)
               if (slide%orientation_column > 0) call add_across(l%slide(k)%turned, s(:, 1)*w(:, 2), rate)
            end associate
         end do
         call subtract_coriolis(l%u(g%orientation)%now(1, 2), l%loop(m)%f, l%loop(m)%open, rate, v)
      end associate
   end subroutine subtract_turning

   !> Subtracts from `v` the second derivative of f e, without those of `f`, which rotates at the rate `w`, and of `e`,
   !> which changes at `rate`.
   pure subroutine subtract_coriolis(w, f, e, rate, v)
      real(wp), intent(in) :: w(width), f(width, 2), e(width, 2), rate(width, 2)
      real(wp), intent(inout) :: v(width)
      integer :: l

      do l = 1, width
         v(l) = v(l) - 2.0_wp*w(l)*(f(l, 1)*rate(l, 2) - f(l, 2)*rate(l, 1)) &
            + w(l)**2*(e(l, 1)*f(l, 1) + e(l, 2)*f(l, 2))
      end do
   end subroutine subtract_coriolis

   !> Adds to `g` the acceleration towards its origin of the vector `e`, which rotates at the rate `w`.
   pure subroutine add_central(e, w, g)
      real(wp), intent(in) :: e(width, 2), w(width)
      real(wp), intent(inout) :: g(width, 2)
      integer :: l

      do l = 1, width
         g(l, 1) = g(l, 1) - w(l)**2*e(l, 1)
         g(l, 2) = g(l, 2) - w(l)**2*e(l, 2)
      end do
   end subroutine add_central

   !> x and y of `e`.
   pure subroutine put(e, x, y)
      real(wp), intent(in) :: e(width, 2)
      real(wp), intent(inout) :: x(width), y(width)
      integer :: l

      do l = 1, width
         x(l) = e(l, 1)
         y(l) = e(l, 2)
      end do
   end subroutine put

   !> x and y of the quarter turn of `e`.
   pure subroutine put_across(e, x, y)
      real(wp), intent(in) :: e(width, 2)
      real(wp), intent(inout) :: x(width), y(width)
      integer :: l

      do l = 1, width
         x(l) = -e(l, 2)
         y(l) = e(l, 1)
      end do
   end subroutine put_across

   !> Subtracts `e` from x and y.
   pure subroutine subtract(e, x, y)
      real(wp), intent(in) :: e(width, 2)
      real(wp), intent(inout) :: x(width), y(width)
      integer :: l

      do l = 1, width
         x(l) = x(l) - e(l, 1)
         y(l) = y(l) - e(l, 2)
      end do
   end subroutine subtract

   !> Adds `x` e to `g`.
   pure subroutine add_along(e, x, g)
      real(wp), intent(in) :: e(width, 2), x(width)
      real(wp), intent(inout) :: g(width, 2)

      g(:, 1) = g(:, 1) + x*e(:, 1)
      g(:, 2) = g(:, 2) + x*e(:, 2)
   end subroutine add_along

   !> Adds `x` times the quarter turn of `e` to `g`.
   pure subroutine add_across(e, x, g)
      real(wp), intent(in) :: e(width, 2), x(width)
      real(wp), intent(inout) :: g(width, 2)

      g(:, 1) = g(:, 1) - x*e(:, 2)
      g(:, 2) = g(:, 2) + x*e(:, 1)
   end subroutine add_across

   !> Adds the scalar product of `e` and `f` to `x`.
   pure subroutine add_dot(e, f, x)
      real(wp), intent(in) :: e(width, 2), f(width, 2)
      real(wp), intent(inout) :: x(width)

      x = x + (e(:, 1)*f(:, 1) + e(:, 2)*f(:, 2))
   end subroutine add_dot

   !> Adds `s` times the cross product of `e` and `f` to `x`.
   pure subroutine add_cross(s, e, f, x)
      real(wp), intent(in) :: s(width), e(width, 2), f(width, 2)
      real(wp), intent(inout) :: x(width)

      x = x + s*(e(:, 1)*f(:, 2) - e(:, 2)*f(:, 1))
   end subroutine add_cross

   !> Subtracts the scalar product of `e` and `f` from `x`.
   pure subroutine subtract_dot(e, f, x)
      real(wp), intent(in) :: e(width, 2), f(width, 2)
      real(wp), intent(inout) :: x(width)

      x = x - (e(:, 1)*f(:, 1) + e(:, 2)*f(:, 2))
   end subroutine subtract_dot
end module lane_equations
