!> The right-hand sides of one block for velocities and accelerations: what its equations, derived once and
!> twice by time, hold beside the unknowns of that order.
module block_sides
   use kinds, only: wp
   use blocks, only: blocks_t, instance_t, instance_components, instance_projection
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
         v(k - b%list(i)%first_row + 1) = s%target(order, b%rows(k)%drive)
      end do
      do m = b%list(i)%first_instance, b%list(i)%last_instance
         associate (instance => b%instances(m))
            select case (instance%kind)
            case (instance_components)
               g = given_part(b, instance, m, order, s)
               if (instance%row_x > 0) v(instance%row_x) = v(instance%row_x) - g(1)
               if (instance%row_y > 0) v(instance%row_y) = v(instance%row_y) - g(2)
            case (instance_projection)
               v(instance%row_x) = v(instance%row_x) - projected_part(b, instance, m, order, s)
            case default
               call subtract_angles(instance, order, s, v)
            end select
         end associate
      end do
   end subroutine rate_side

   !> Angles of earlier blocks in an equation of two angles.
   pure subroutine subtract_angles(g, order, s, v)
      type(instance_t), intent(in) :: g
      integer, intent(in) :: order
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: v(*)

      if (g%frame_column == 0) &
         v(g%row_x) = v(g%row_x) - merge(s%u(g%frame)%rate, s%u(g%frame)%rate2, order == 1)
      if (g%less_column == 0) &
         v(g%row_x) = v(g%row_x) + merge(s%u(g%less)%rate, s%u(g%less)%rate2, order == 1)
   end subroutine subtract_angles

   !> The part of g' (order 1) or g'' (order 2) of instance `m` that holds no unknown of that order.
   pure function given_part(b, instance, m, order, s) result(g)
      type(blocks_t), intent(in) :: b
      type(instance_t), intent(in) :: instance
      integer, intent(in) :: m, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2), square
      integer :: k

      g = s%part(m)%known(:, order)
      if (order == 2) then
         do k = instance%first_own, instance%last_arm
            square = s%u(b%arms(k)%frame)%rate**2
            g(1) = g(1) - square*s%own(1, k)
            g(2) = g(2) - square*s%own(2, k)
         end do
      end if
      do k = instance%first_slide, instance%last_slide
         g = g + slide_part(b, k, order, s)
      end do
   end function given_part

   !> The same of slide number `k`: (s e)' = s' e + s w e',  (s e)'' = s'' e + 2 s' w e' + s (w' e' - w^2 e).
   pure function slide_part(b, k, order, s) result(g)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: k, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2), e(2), turn(2)

      associate (slide => b%slides(k), u => s%u(b%slides(k)%unknown), f => s%u(b%slides(k)%frame))
         e = slide_vector(b, k, s)
         turn = [-e(2), e(1)]
         g = 0.0_wp
         if (order == 1) then
            if (slide%column == 0) g = g + u%rate*e
            if (slide%frame_column == 0) g = g + u%value*f%rate*turn
         else
            g = 2.0_wp*u%rate*f%rate*turn - u%value*f%rate**2*e
            if (slide%column == 0) g = g + u%rate2*e
            if (slide%frame_column == 0) g = g + u%value*f%rate2*turn
         end if
      end associate
   end function slide_part

   !> The part of (g . f)' or (g . f)'' of instance `m` that holds no unknown of that order.
   pure real(wp) function projected_part(b, instance, m, order, s) result(v)
      type(blocks_t), intent(in) :: b
      type(instance_t), intent(in) :: instance
      integer, intent(in) :: m, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2)

      associate (c => s%u(instance%frame), gap => s%part(m)%gap, f => s%part(m)%f)
         g = given_part(b, instance, m, order, s)
         v = g(1)*f(1) + g(2)*f(2)
         if (instance%frame == 0) return
         if (order == 1) then
            if (instance%frame_column == 0) v = v + c%rate*across(gap, f)
         else
            v = v + 2.0_wp*c%rate*across(gap_rate(b, instance, m, s), f) - c%rate**2*dot_product(gap, f)
            if (instance%frame_column == 0) v = v + c%rate2*across(gap, f)
         end if
      end associate
   end function projected_part

   !> g' with the velocities of the block itself.
   pure function gap_rate(b, instance, m, s) result(g)
      type(blocks_t), intent(in) :: b
      type(instance_t), intent(in) :: instance
      integer, intent(in) :: m
      type(state_t), intent(in) :: s
      real(wp) :: g(2), e(2)
      integer :: k

      g = s%part(m)%known(:, 1)
      do k = instance%first_own, instance%last_arm
         g = g + s%u(b%arms(k)%frame)%rate*[-s%own(2, k), s%own(1, k)]
      end do
      do k = instance%first_slide, instance%last_slide
         e = slide_vector(b, k, s)
         associate (u => s%u(b%slides(k)%unknown))
            g = g + u%rate*e + u%value*s%u(b%slides(k)%frame)%rate*[-e(2), e(1)]
         end associate
      end do
   end function gap_rate
end module block_sides
