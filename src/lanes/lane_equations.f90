!> The equations of one block in all lanes: `block_equations` and what `block_state` knows, with one number a lane
!> where those have one. The formulas stand there.
module lane_equations
   use kinds, only: wp
   use blocks, only: loop_components, loop_projection
   use lane_sines, only: width, sines
   use lane_state, only: lanes_t
   use lane_vectors, only: one, copy, put_across, add_dot, add_cross
   implicit none
   private
   public :: set_lane_direction, find_lane_known, assemble_lanes

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

   !> Jacobian `a` (lanes, n*n by columns) and residual `r` (lanes, n) of block `i`, and the right-hand side `v`
   !> (lanes, n) for the velocities. The columns 0 of all take what no equation asks for, so that nothing need be asked.
   pure subroutine assemble_lanes(l, i, n, a, r, v)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n
      real(wp), intent(out) :: a(width, 0:n*n), r(width, 0:n), v(width, 0:n)
      integer :: m

      a = 0.0_wp
      v(:, 0) = 0.0_wp
      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         if (l%blocks%loops(m)%kind == loop_components) then
            call find_open(l, m)
            call component_rows(l, m, n, a, r, v)
         else if (l%blocks%loops(m)%kind == loop_projection) then
            call find_open(l, m)
            call projection_row(l, m, n, a, r, v)
         else
            call angle_row(l, m, n, a, r, v)
         end if
      end do
   end subroutine assemble_lanes

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

   !> Row of loop `m` of two angles.
   pure subroutine angle_row(l, m, n, a, r, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m, n
      real(wp), intent(inout) :: a(width, 0:n*n), r(width, 0:n), v(width, 0:n)

      associate (g => l%blocks%loops(m), drive => l%loop(m)%drive(1))
         r(:, g%row_x) = l%u(g%orientation)%now(:, 1) - l%u(g%less)%now(:, 1) - l%loop(m)%constant(:, 1) &
            - l%drive(:, 0, drive)
         v(:, g%row_x) = l%drive(:, 1, drive)
         a(:, g%orientation_at) = a(:, g%orientation_at) + 1.0_wp
         a(:, g%less_at) = a(:, g%less_at) - 1.0_wp
      end associate
   end subroutine angle_row

   !> Rows of the x and y components of loop `m`.
   pure subroutine component_rows(l, m, n, a, r, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m, n
      real(wp), intent(inout) :: a(width, 0:n*n), r(width, 0:n), v(width, 0:n)
      integer :: k

      associate (g => l%blocks%loops(m), loop => l%loop(m))
         call take_component(loop%open(1, 1), loop%known(1, 1, 1), loop%constant(1, 1), l%drive(1, 0, loop%drive(1)), &
            r(1, g%row_x), v(1, g%row_x))
         call take_component(loop%open(1, 2), loop%known(1, 2, 1), loop%constant(1, 2), l%drive(1, 0, loop%drive(2)), &
            r(1, g%row_y), v(1, g%row_y))
         do k = g%first_own, g%last_vector
            associate (at => l%blocks%body_vectors(k)%at)
               call put_across(l%vector(k)%turned, a(1, at(1)), a(1, at(2)))
            end associate
         end do
         do k = g%first_slide, g%last_slide
            call add_slide_entries(l, k, 1, x_axis, n, a, v(1, g%row_x))
            call add_slide_entries(l, k, 2, y_axis, n, a, v(1, g%row_y))
         end do
      end associate
   end subroutine component_rows

   !> Residual `r` and right-hand side `v` of one component.
   pure subroutine take_component(open, rate, constant, drive, r, v)
      real(wp), intent(in) :: open(width), rate(width), constant(width), drive(width, 0:1)
      real(wp), intent(inout) :: r(width), v(width)
      integer :: l

      do l = 1, width
         r(l) = open(l) - constant(l) - drive(l, 0)
         v(l) = drive(l, 1) - rate(l)
      end do
   end subroutine take_component

   !> Slide `k` in the row of the component along `f`, the first or second (`side`) of its loop: its entries, or, where
   !> it or its angle is known, what that gives to the right-hand side `v`.
   pure subroutine add_slide_entries(l, k, side, f, n, a, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: k, side, n
      real(wp), intent(in) :: f(width, 2)
      real(wp), intent(inout) :: a(width, 0:n*n), v(width)

      associate (slide => l%blocks%slides(k), e => l%slide(k)%turned, s => l%u(l%blocks%slides(k)%unknown)%now, &
                 w => l%u(l%blocks%slides(k)%orientation)%now)
         if (slide%at(side) > 0) call add_dot(one, e, f, a(1, slide%at(side)))
         if (slide%column == 0) call add_dot(-s(:, 2), e, f, v)
         if (slide%orientation_at(side) > 0) call add_cross(s, e, f, a(1, slide%orientation_at(side)))
         if (slide%orientation_column == 0) call add_cross(-s(:, 1)*w(:, 2), e, f, v)
      end associate
   end subroutine add_slide_entries

   !> Row of the projection of loop `m`.
   pure subroutine projection_row(l, m, n, a, r, v)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: m, n
      real(wp), intent(inout) :: a(width, 0:n*n), r(width, 0:n), v(width, 0:n)
      integer :: k

      associate (g => l%blocks%loops(m), loop => l%loop(m))
         call project(loop%direction, l%u(g%orientation)%now, loop%open, loop%known(1, 1, 1), loop%constant, &
            l%drive(1, 0, loop%drive(1)), loop%f, r(1, g%row_x), v(1, g%row_x))
         do k = g%first_own, g%last_vector
            call add_cross(one, l%vector(k)%turned, loop%f, a(1, l%blocks%body_vectors(k)%at(1)))
         end do
         do k = g%first_slide, g%last_slide
            call add_slide_entries(l, k, 1, loop%f, n, a, v(1, g%row_x))
         end do
         if (g%orientation_at > 0) then
            call add_cross(one, loop%f, loop%open, a(1, g%orientation_at))
         else if (g%orientation > 0) then
            call add_cross(-l%u(g%orientation)%now(:, 2), loop%f, loop%open, v(1, g%row_x))
         end if
      end associate
   end subroutine projection_row

   !> `f`: the direction `d`, rotated by the unknown `u`. Residual `r` and right-hand side `v`: what is `open` along it,
   !> and its `rate`.
   pure subroutine project(d, u, open, rate, constant, drive, f, r, v)
      real(wp), intent(in) :: d(width, 2), u(width, 5), open(width, 2), rate(width, 2), constant(width), &
         drive(width, 0:1)
      real(wp), intent(inout) :: f(width, 2), r(width), v(width)
      real(wp) :: x, y
      integer :: l

      do l = 1, width
         x = d(l, 1)*u(l, 4) - d(l, 2)*u(l, 5)
         y = d(l, 1)*u(l, 5) + d(l, 2)*u(l, 4)
         f(l, 1) = x
         f(l, 2) = y
         r(l) = open(l, 1)*x + open(l, 2)*y - constant(l) - drive(l, 0)
         v(l) = drive(l, 1) - (rate(l, 1)*x + rate(l, 2)*y)
      end do
   end subroutine project
end module lane_equations
