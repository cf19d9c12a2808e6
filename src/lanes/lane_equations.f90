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

contains

   !> Cosine and sine of unknown `i`, if it is an angle.
   pure subroutine set_lane_direction(l, i)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i

      if (i <= l%blocks%orientations) call sines(l%u(:, 1, i), l%u(:, 4, i), l%u(:, 5, i))
   end subroutine set_lane_direction

   !> What earlier blocks give to the loops of block `i`: place, velocity, acceleration.
   pure subroutine find_lane_known(l, i)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i
      integer :: m, k

      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         call begin_known(l%ground(1, 1, m), l%known(1, 1, 0, m))
         do k = l%blocks%loops(m)%first_vector, l%blocks%loops(m)%first_own - 1
            call add_known(l%vector(1, 1, k), l%u(1, 1, l%blocks%body_vectors(k)%orientation), l%known(1, 1, 0, m))
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

   !> Jacobian `a` (lanes, n*n by columns) and residual `r` (lanes, n) of block `i`.
   pure subroutine assemble_lanes(l, i, n, a, r)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n
      real(wp), intent(out) :: a(width, n*n), r(width, n)
      integer :: m, k

      a = 0.0_wp
      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         associate (g => l%blocks%loops(m))
            if (g%kind == loop_components .or. g%kind == loop_projection) then
               call find_open(l, m)
               if (g%kind == loop_components) call component_rows(l, m, n, a, r)
               if (g%kind == loop_projection) call projection_row(l, m, n, a, r)
            else
               r(:, g%row_x) = l%u(:, 1, g%orientation) - l%u(:, 1, g%less)
               if (g%orientation_at > 0) a(:, g%orientation_at) = a(:, g%orientation_at) + 1.0_wp
               if (g%less_at > 0) a(:, g%less_at) = a(:, g%less_at) - 1.0_wp
            end if
         end associate
      end do
      do k = l%blocks%list(i)%first_row, l%blocks%list(i)%last_row
         associate (row => k - l%blocks%list(i)%first_row + 1)
            r(:, row) = r(:, row) - l%constant(:, k) - l%drive(:, 0, l%blocks%rows(k)%drive)
         end associate
      end do
   end subroutine assemble_lanes

   !> The closure error of loop `m`, and the vectors that the block's own angles rotate.
   pure subroutine find_open(l, m)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: m
      integer :: k

      l%open(:, :, m) = l%known(:, :, 0, m)
      do k = l%blocks%loops(m)%first_own, l%blocks%loops(m)%last_vector
         call add_own(l%vector(1, 1, k), l%u(1, 1, l%blocks%body_vectors(k)%orientation), l%own(1, 1, k), &
            l%open(1, 1, m))
      end do
      do k = l%blocks%loops(m)%first_slide, l%blocks%loops(m)%last_slide
         call add_slide(l%along(1, 1, k), l%u(1, 1, l%blocks%slides(k)%orientation), &
            l%u(1, 1, l%blocks%slides(k)%unknown), l%guide(1, 1, k), l%open(1, 1, m))
      end do
   end subroutine find_open

   !> `own`: the vector `d`, rotated by the unknown `u`; it is added to `open`.
   pure subroutine add_own(d, u, own, open)
      real(wp), intent(in) :: d(width, 2), u(width, 5)
      real(wp), intent(inout) :: own(width, 2), open(width, 2)
      integer :: l

      do l = 1, width
         own(l, 1) = u(l, 4)*d(l, 1) - u(l, 5)*d(l, 2)
         own(l, 2) = u(l, 5)*d(l, 1) + u(l, 4)*d(l, 2)
         open(l, 1) = open(l, 1) + own(l, 1)
         open(l, 2) = open(l, 2) + own(l, 2)
      end do
   end subroutine add_own

   !> `guide`: the direction `d`, rotated by the unknown `u`; the slide `s` along it is added to `open`.
   pure subroutine add_slide(d, u, s, guide, open)
      real(wp), intent(in) :: d(width, 2), u(width, 5), s(width, 5)
      real(wp), intent(inout) :: guide(width, 2), open(width, 2)
      integer :: l

      do l = 1, width
         guide(l, 1) = u(l, 4)*d(l, 1) - u(l, 5)*d(l, 2)
         guide(l, 2) = u(l, 5)*d(l, 1) + u(l, 4)*d(l, 2)
         open(l, 1) = open(l, 1) + s(l, 1)*guide(l, 1)
         open(l, 2) = open(l, 2) + s(l, 1)*guide(l, 2)
      end do
   end subroutine add_slide

   !> Rows of the x and y components of loop `m`.
   pure subroutine component_rows(l, m, n, a, r)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m, n
      real(wp), intent(inout) :: a(width, n*n), r(width, n)
      integer :: k

      associate (g => l%blocks%loops(m))
         if (g%row_x > 0) r(:, g%row_x) = l%open(:, 1, m)
         if (g%row_y > 0) r(:, g%row_y) = l%open(:, 2, m)
         do k = g%first_own, g%last_vector
            if (g%row_x > 0) a(:, l%blocks%body_vectors(k)%at(1)) = -l%own(:, 2, k)
            if (g%row_y > 0) a(:, l%blocks%body_vectors(k)%at(2)) = l%own(:, 1, k)
         end do
         do k = g%first_slide, g%last_slide
            associate (slide => l%blocks%slides(k), s => l%u(:, 1, l%blocks%slides(k)%unknown))
               if (g%row_x > 0 .and. slide%at(1) > 0) a(:, slide%at(1)) = a(:, slide%at(1)) + l%guide(:, 1, k)
               if (g%row_y > 0 .and. slide%at(2) > 0) a(:, slide%at(2)) = a(:, slide%at(2)) + l%guide(:, 2, k)
               if (g%row_x > 0 .and. slide%orientation_at(1) > 0) &
                  a(:, slide%orientation_at(1)) = a(:, slide%orientation_at(1)) - s*l%guide(:, 2, k)
               if (g%row_y > 0 .and. slide%orientation_at(2) > 0) &
                  a(:, slide%orientation_at(2)) = a(:, slide%orientation_at(2)) + s*l%guide(:, 1, k)
            end associate
         end do
      end associate
   end subroutine component_rows

   !> Row of the projection of loop `m`.
   pure subroutine projection_row(l, m, n, a, r)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: m, n
      real(wp), intent(inout) :: a(width, n*n), r(width, n)
      integer :: k

      associate (g => l%blocks%loops(m), c => l%u(:, 4, l%blocks%loops(m)%orientation), &
                 s => l%u(:, 5, l%blocks%loops(m)%orientation))
         l%f(:, 1, m) = l%direction(:, 1, m)*c - l%direction(:, 2, m)*s
         l%f(:, 2, m) = l%direction(:, 1, m)*s + l%direction(:, 2, m)*c
         r(:, g%row_x) = l%open(:, 1, m)*l%f(:, 1, m) + l%open(:, 2, m)*l%f(:, 2, m)
         do k = g%first_own, g%last_vector
            a(:, l%blocks%body_vectors(k)%at(1)) = l%own(:, 1, k)*l%f(:, 2, m) - l%own(:, 2, k)*l%f(:, 1, m)
         end do
         do k = g%first_slide, g%last_slide
            associate (slide => l%blocks%slides(k))
               if (slide%at(1) > 0) a(:, slide%at(1)) = a(:, slide%at(1)) + (l%guide(:, 1, k)*l%f(:, 1, m) &
                  + l%guide(:, 2, k)*l%f(:, 2, m))
               if (slide%orientation_at(1) > 0) a(:, slide%orientation_at(1)) = a(:, slide%orientation_at(1)) &
                  - l%u(:, 1, slide%unknown)*(l%f(:, 1, m)*l%guide(:, 2, k) - l%f(:, 2, m)*l%guide(:, 1, k))
            end associate
         end do
         if (g%orientation_at > 0) a(:, g%orientation_at) = a(:, g%orientation_at) &
            + (l%f(:, 1, m)*l%open(:, 2, m) - l%f(:, 2, m)*l%open(:, 1, m))
      end associate
   end subroutine projection_row

   !> Right-hand side `v` (lanes, n) for the velocities (`order` 1) or, once these are known, the accelerations (2) of
   !> block `i`, with the vectors of the last `assemble_lanes`.
   pure subroutine lane_right_hand_side(l, i, n, order, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: i, n, order
      real(wp), intent(out) :: v(width, n)
      real(wp) :: g(width, 2)
      integer :: k, m

      do k = l%blocks%list(i)%first_row, l%blocks%list(i)%last_row
         v(:, k - l%blocks%list(i)%first_row + 1) = l%drive(:, order, l%blocks%rows(k)%drive)
      end do
      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         associate (p => l%blocks%loops(m))
            if (p%kind == loop_components) then
               call find_given(l, m, order, g)
               if (p%row_x > 0) v(:, p%row_x) = v(:, p%row_x) - g(:, 1)
               if (p%row_y > 0) v(:, p%row_y) = v(:, p%row_y) - g(:, 2)
            else if (p%kind == loop_projection) then
               call find_given(l, m, order, g)
               v(:, p%row_x) = v(:, p%row_x) - (g(:, 1)*l%f(:, 1, m) + g(:, 2)*l%f(:, 2, m))
               if (p%orientation > 0) call subtract_turning(l, m, order, v(:, p%row_x))
            end if
         end associate
      end do
   end subroutine lane_right_hand_side

   !> The part `g` of the derivative number `order` of loop `m` that holds no unknown of that order.
   pure subroutine find_given(l, m, order, g)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m, order
      real(wp), intent(out) :: g(width, 2)
      integer :: k

      g = l%known(:, :, order, m)
      if (order == 2) then
         do k = l%blocks%loops(m)%first_own, l%blocks%loops(m)%last_vector
            associate (rate => l%u(:, 2, l%blocks%body_vectors(k)%orientation))
               g(:, 1) = g(:, 1) - rate**2*l%own(:, 1, k)
               g(:, 2) = g(:, 2) - rate**2*l%own(:, 2, k)
            end associate
         end do
      end if
      do k = l%blocks%loops(m)%first_slide, l%blocks%loops(m)%last_slide
         associate (s => l%u(:, :, l%blocks%slides(k)%unknown), w => l%u(:, :, l%blocks%slides(k)%orientation), &
                    slide => l%blocks%slides(k))
            if (order == 2) call add_along(l%guide(:, :, k), -s(:, 1)*w(:, 2)**2, g)
            if (order == 2) call add_across(l%guide(:, :, k), 2.0_wp*s(:, 2)*w(:, 2), g)
            if (slide%column == 0) call add_along(l%guide(:, :, k), s(:, order + 1), g)
            if (slide%orientation_column == 0) call add_across(l%guide(:, :, k), s(:, 1)*w(:, order + 1), g)
         end associate
      end do
   end subroutine find_given

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

   !> Subtracts from `v` what the rotation of the direction on which loop `m` is projected adds to its derivative number
   !> `order`, beside unknowns of that order.
   pure subroutine subtract_turning(l, m, order, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m, order
      real(wp), intent(inout) :: v(width)
      real(wp) :: g(width, 2)
      integer :: k

      associate (w => l%u(:, :, l%blocks%loops(m)%orientation), f => l%f(:, :, m), open => l%open(:, :, m))
         if (l%blocks%loops(m)%orientation_column == 0) &
            v = v - w(:, order + 1)*(f(:, 1)*open(:, 2) - f(:, 2)*open(:, 1))
         if (order == 1) return
         g = l%known(:, :, 1, m)
         do k = l%blocks%loops(m)%first_own, l%blocks%loops(m)%last_vector
            call add_across(l%own(:, :, k), l%u(:, 2, l%blocks%body_vectors(k)%orientation), g)
         end do
         do k = l%blocks%loops(m)%first_slide, l%blocks%loops(m)%last_slide
            call add_along(l%guide(:, :, k), l%u(:, 2, l%blocks%slides(k)%unknown), g)
            call add_across(l%guide(:, :, k), l%u(:, 1, l%blocks%slides(k)%unknown) &
               *l%u(:, 2, l%blocks%slides(k)%orientation), g)
         end do
         v = v - 2.0_wp*w(:, 2)*(f(:, 1)*g(:, 2) - f(:, 2)*g(:, 1)) &
            + w(:, 2)**2*(open(:, 1)*f(:, 1) + open(:, 2)*f(:, 2))
      end associate
   end subroutine subtract_turning
end module lane_equations
