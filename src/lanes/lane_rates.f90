!> The right-hand sides for the accelerations of one block in all lanes; see `lane_equations`.
module lane_rates
   use kinds, only: wp
   use blocks, only: loop_components, loop_projection
   use lane_sines, only: width
   use lane_state, only: lanes_t
   use lane_vectors, only: copy, add_along, add_across, add_cross
   implicit none
   private
   public :: lane_accelerations

contains

   !> Right-hand side `v` (lanes, n) for the accelerations of block `i`, once the velocities are known, with the vectors
   !> of the last `assemble_lanes`: once for each `find_lane_known`, to whose sums it adds.
   pure subroutine lane_accelerations(l, i, n, v)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n
      real(wp), intent(out) :: v(width, 0:n)
      integer :: m

      do m = l%blocks%list(i)%first_loop, l%blocks%list(i)%last_loop
         associate (g => l%blocks%loops(m), loop => l%loop(m))
            if (g%kind == loop_components) then
               call add_given(l, m)
               call subtract(l%drive(1, 2, loop%drive(1)), loop%known(1, 1, 2), v(1, g%row_x))
               call subtract(l%drive(1, 2, loop%drive(2)), loop%known(1, 2, 2), v(1, g%row_y))
            else if (g%kind == loop_projection) then
               call add_given(l, m)
               call subtract_dot(l%drive(1, 2, loop%drive(1)), loop%known(1, 1, 2), loop%f, v(1, g%row_x))
               if (g%orientation > 0) call subtract_turning(l, m, v(1, g%row_x))
            else
               v(:, g%row_x) = l%drive(:, 2, loop%drive(1))
            end if
         end associate
      end do
   end subroutine lane_accelerations

   !> Adds to the second derivative of what is known in loop `m` all that holds no unknown second derivative.
   pure subroutine add_given(l, m)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: m
      integer :: k

      do k = l%blocks%loops(m)%first_own, l%blocks%loops(m)%last_vector
         call add_central(l%vector(k)%turned, l%u(l%blocks%body_vectors(k)%orientation)%now(1, 2), &
            l%loop(m)%known(1, 1, 2))
      end do
      do k = l%blocks%loops(m)%first_slide, l%blocks%loops(m)%last_slide
         associate (slide => l%blocks%slides(k), e => l%slide(k)%turned, s => l%u(l%blocks%slides(k)%unknown)%now, &
                    w => l%u(l%blocks%slides(k)%orientation)%now, given => l%loop(m)%known(:, :, 2))
            call add_along(e, -s(:, 1)*w(:, 2)**2, given)
            call add_across(e, 2.0_wp*s(:, 2)*w(:, 2), given)
            if (slide%column == 0) call add_along(e, s(:, 3), given)
            if (slide%orientation_column == 0) call add_across(e, s(:, 1)*w(:, 3), given)
         end associate
      end do
   end subroutine add_given

   !> Subtracts from `v` what the rotation of the direction on which loop `m` is projected adds to its second
   !> derivative, beside unknown ones.
   pure subroutine subtract_turning(l, m, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: m
      real(wp), intent(inout) :: v(width)
      real(wp) :: rate(width, 2)
      integer :: k

      associate (g => l%blocks%loops(m), loop => l%loop(m))
         if (g%orientation_column == 0) call add_cross(-l%u(g%orientation)%now(:, 3), loop%f, loop%open, v)
         call copy(loop%known(1, 1, 1), rate)
         do k = g%first_own, g%last_vector
            call add_across(l%vector(k)%turned, l%u(l%blocks%body_vectors(k)%orientation)%now(1, 2), rate)
         end do
         do k = g%first_slide, g%last_slide
            associate (s => l%u(l%blocks%slides(k)%unknown)%now, w => l%u(l%blocks%slides(k)%orientation)%now)
               call add_along(l%slide(k)%turned, s(1, 2), rate)
               call add_across(l%slide(k)%turned, s(:, 1)*w(:, 2), rate)
            end associate
         end do
         call subtract_coriolis(l%u(g%orientation)%now(1, 2), loop%f, loop%open, rate, v)
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

   !> y = x - e.
   pure subroutine subtract(x, e, y)
      real(wp), intent(in) :: x(width), e(width)
      real(wp), intent(inout) :: y(width)

      y = x - e
   end subroutine subtract

   !> y = x - e f.
   pure subroutine subtract_dot(x, e, f, y)
      real(wp), intent(in) :: x(width), e(width, 2), f(width, 2)
      real(wp), intent(inout) :: y(width)

      y = x - (e(:, 1)*f(:, 1) + e(:, 2)*f(:, 2))
   end subroutine subtract_dot
end module lane_rates
