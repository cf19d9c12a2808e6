!> The right-hand sides of one block for velocities and accelerations: what its equations, derived once and
!> twice by time, hold beside the unknowns of that order.
module right_hand_sides
   use kinds, only: wp
   use blocks, only: blocks_t, block_loop_t, loop_components, loop_projection
   use block_state, only: state_t, slide_vector, across
   implicit none
   private
   public :: rate_side

contains

   !> Right-hand side `v` (n) for the velocities (`order` 1) or, once these are known, the accelerations (2) of
   !> block `i`: the drives' rates less what is given. Gaps, directions and own arms are those of the last
   !> `assemble_block`.
   pure subroutine rate_side(b, i, order, s, v)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(state_t), intent(in) :: s
      real(wp), intent(out) :: v(*)
      real(wp) :: g(2)
      integer :: k, m

      do k = b%list(i)%first_row, b%list(i)%last_row
         v(k - b%list(i)%first_row + 1) = s%drive_value(order, b%rows(k)%drive)
      end do
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (block_loop => b%loops(m))
            select case (block_loop%kind)
            case (loop_components)
               g = given_part(b, block_loop, m, order, s)
               if (block_loop%row_x > 0) v(block_loop%row_x) = v(block_loop%row_x) - g(1)
               if (block_loop%row_y > 0) v(block_loop%row_y) = v(block_loop%row_y) - g(2)
            case (loop_projection)
               v(block_loop%row_x) = v(block_loop%row_x) - projected_part(b, block_loop, m, order, s)
            case default
               call subtract_angles(block_loop, order, s, v)
            end select
         end associate
      end do
   end subroutine rate_side

   !> Angles of earlier blocks in an equation of two angles.
   pure subroutine subtract_angles(g, order, s, v)
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: order
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: v(*)

      if (g%orientation_column == 0) &
         v(g%row_x) = v(g%row_x) - merge(s%u(g%orientation)%rate, s%u(g%orientation)%acceleration, order == 1)
      if (g%less_column == 0) &
         v(g%row_x) = v(g%row_x) + merge(s%u(g%less)%rate, s%u(g%less)%acceleration, order == 1)
   end subroutine subtract_angles

   !> The part of g' (order 1) or g'' (order 2) of instance `m` that holds no unknown of that order.
   pure function given_part(b, block_loop, m, order, s) result(g)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: block_loop
      integer, intent(in) :: m, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2), square
      integer :: k

      g = s%part(m)%known(:, order)
      if (order == 2) then
         do k = block_loop%first_own, block_loop%last_vector
            square = s%u(b%body_vectors(k)%orientation)%rate**2
            g(1) = g(1) - square*s%own(1, k)
            g(2) = g(2) - square*s%own(2, k)
         end do
      end if
      do k = block_loop%first_slide, block_loop%last_slide
         g = g + slide_part(b, k, order, s)
      end do
   end function given_part

   !> The same of slide number `k`: (s e)' = s' e + s w e',  (s e)'' = s'' e + 2 s' w e' + s (w' e' - w^2 e).
   pure function slide_part(b, k, order, s) result(g)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: k, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2), e(2), angle_offset(2)

      associate (slide => b%slides(k), u => s%u(b%slides(k)%unknown), f => s%u(b%slides(k)%orientation))
         e = slide_vector(b, k, s)
         angle_offset = [-e(2), e(1)]
         g = 0.0_wp
         if (order == 1) then
            if (slide%column == 0) g = g + u%rate*e
            if (slide%orientation_column == 0) g = g + u%value*f%rate*angle_offset
         else
            g = 2.0_wp*u%rate*f%rate*angle_offset - u%value*f%rate**2*e
            if (slide%column == 0) g = g + u%acceleration*e
            if (slide%orientation_column == 0) g = g + u%value*f%acceleration*angle_offset
         end if
      end associate
   end function slide_part

   !> The part of (g . f)' or (g . f)'' of instance `m` that holds no unknown of that order.
   pure real(wp) function projected_part(b, block_loop, m, order, s) result(v)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: block_loop
      integer, intent(in) :: m, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2)

      associate (c => s%u(block_loop%orientation), closure_error => s%part(m)%closure_error, f => s%part(m)%f)
         g = given_part(b, block_loop, m, order, s)
         v = g(1)*f(1) + g(2)*f(2)
         if (block_loop%orientation == 0) return
         if (order == 1) then
            if (block_loop%orientation_column == 0) v = v + c%rate*across(closure_error, f)
         else
            v = v + 2.0_wp*c%rate*across(closure_error_rate(b, block_loop, m, s), &
               f) - c%rate**2*dot_product(closure_error, f)
            if (block_loop%orientation_column == 0) v = v + c%acceleration*across(closure_error, f)
         end if
      end associate
   end function projected_part

   !> g' with the velocities of the block itself.
   pure function closure_error_rate(b, block_loop, m, s) result(g)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: block_loop
      integer, intent(in) :: m
      type(state_t), intent(in) :: s
      real(wp) :: g(2), e(2)
      integer :: k

      g = s%part(m)%known(:, 1)
      do k = block_loop%first_own, block_loop%last_vector
         g = g + s%u(b%body_vectors(k)%orientation)%rate*[-s%own(2, k), s%own(1, k)]
      end do
      do k = block_loop%first_slide, block_loop%last_slide
         e = slide_vector(b, k, s)
         associate (u => s%u(b%slides(k)%unknown))
            g = g + u%rate*e + u%value*s%u(b%slides(k)%orientation)%rate*[-e(2), e(1)]
         end associate
      end do
   end function closure_error_rate
end module right_hand_sides
