!> Level 6. The equations of one block at a state: residual and Jacobian.
module block_rows
   use kinds, only: wp
   use block_matrix, only: shape_t, entries_of
   use blocks, only: blocks_t, instance_t, instance_components, instance_projection
   use block_state, only: state_t, slide_vector, turned, across
   implicit none
   private
   public :: block_system, assemble_block

contains

   !> Jacobian `a` and residual `r` (rows) of the block at the state.
   subroutine assemble_block(b, i, shape, s, a, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(shape_t), intent(in) :: shape
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(*)

      a(:entries_of(shape)) = 0.0_wp
      if (shape%below < 0) then
         call block_system(b, i, -shape%rows, shape%rows, s, a, r)
      else
         ! DGBSV: entry (row, column) in row below + above + 1 + row - column of 2 below + above + 1.
         call block_system(b, i, -shape%below, 2*shape%below + shape%above, s, a, r)
      end if
   end subroutine assemble_block

   !> Residual `r` (n) and Jacobian of block `i`; entry (row, column) of the Jacobian is a(place + row +
   !> column*stride), all of them zero before.
   pure subroutine block_system(b, i, place, stride, s, a, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, place, stride
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*)
      real(wp), intent(out) :: r(*)
      integer :: m, k, row

      do m = b%list(i)%first_instance, b%list(i)%last_instance
         associate (g => b%instances(m))
            select case (g%kind)
            case (instance_components)
               call close_polygon(b, m, s)
               call component_rows(b, g, m, place, stride, s, a, r)
            case (instance_projection)
               call close_polygon(b, m, s)
               call projection_row(b, g, m, place, stride, s, a, r)
            case default
               r(g%row_x) = s%u(g%frame)%value - s%u(g%less)%value
               call angle_entries(g, place, stride, a)
            end select
         end associate
      end do
      do k = b%list(i)%first_row, b%list(i)%last_row
         row = k - b%list(i)%first_row + 1
         r(row) = r(row) - b%rows(k)%constant - s%target(0, b%rows(k)%drive)
      end do
   end subroutine block_system

   !> The row of two angles, which may be those of one frame.
   pure subroutine angle_entries(g, place, stride, a)
      type(instance_t), intent(in) :: g
      integer, intent(in) :: place, stride
      real(wp), intent(inout) :: a(*)
      integer :: at

      at = place + g%row_x + g%frame_column*stride
      if (g%frame_column > 0) a(at) = a(at) + 1.0_wp
      at = place + g%row_x + g%less_column*stride
      if (g%less_column > 0) a(at) = a(at) - 1.0_wp
   end subroutine angle_entries

   !> The gap of polygon instance `m`, and the arms of the block's own frames.
   pure subroutine close_polygon(b, m, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(state_t), intent(inout) :: s
      integer :: k
      real(wp) :: x, y

      x = s%part(m)%known(1, 0)
      y = s%part(m)%known(2, 0)
      do k = b%instances(m)%first_own, b%instances(m)%last_arm
         associate (f => s%u(b%arms(k)%frame), d => b%arms(k), u => s%own(:, k))
            u(1) = f%c*d%x - f%s*d%y
            u(2) = f%s*d%x + f%c*d%y
            x = x + u(1)
            y = y + u(2)
         end associate
      end do
      s%part(m)%gap(1) = x
      s%part(m)%gap(2) = y
      do k = b%instances(m)%first_slide, b%instances(m)%last_slide
         s%part(m)%gap = s%part(m)%gap + s%u(b%slides(k)%unknown)%value*slide_vector(b, k, s)
      end do
   end subroutine close_polygon

   !> Rows of the x and y components of polygon instance `m`, which is `g`.
   pure subroutine component_rows(b, g, m, place, stride, s, a, r)
      type(blocks_t), intent(in) :: b
      type(instance_t), intent(in) :: g
      integer, intent(in) :: m, place, stride
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: a(*), r(*)
      integer :: k

      if (g%row_x > 0) then
         r(g%row_x) = s%part(m)%gap(1)
         do k = g%first_own, g%last_arm
            a(place + g%row_x + b%arms(k)%column*stride) = -s%own(2, k)
         end do
      end if
      if (g%row_y > 0) then
         r(g%row_y) = s%part(m)%gap(2)
         do k = g%first_own, g%last_arm
            a(place + g%row_y + b%arms(k)%column*stride) = s%own(1, k)
         end do
      end if
      if (g%last_slide < g%first_slide) return
      if (g%row_x > 0) call slide_entries(b, g, [1.0_wp, 0.0_wp], place + g%row_x, stride, s, a)
      if (g%row_y > 0) call slide_entries(b, g, [0.0_wp, 1.0_wp], place + g%row_y, stride, s, a)
   end subroutine component_rows

   !> Row of the projection of polygon instance `m`, which is `g`.
   pure subroutine projection_row(b, g, m, place, stride, s, a, r)
      type(blocks_t), intent(in) :: b
      type(instance_t), intent(in) :: g
      integer, intent(in) :: m, place, stride
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(*)
      integer :: k, at
      real(wp) :: f(2)

      f = turned(s, g%frame, g%direction)
      s%part(m)%f = f
      r(g%row_x) = s%part(m)%gap(1)*f(1) + s%part(m)%gap(2)*f(2)
      at = place + g%row_x
      do k = g%first_own, g%last_arm
         a(at + b%arms(k)%column*stride) = s%own(1, k)*f(2) - s%own(2, k)*f(1)
      end do
      if (g%last_slide >= g%first_slide) call slide_entries(b, g, f, at, stride, s, a)
      if (g%frame_column == 0) return
      at = at + g%frame_column*stride
      a(at) = a(at) + across(s%part(m)%gap, f)
   end subroutine projection_row

   !> What the slides of instance `g` add to a row that projects it on `f`.
   pure subroutine slide_entries(b, g, f, at, stride, s, a)
      type(blocks_t), intent(in) :: b
      type(instance_t), intent(in) :: g
      real(wp), intent(in) :: f(2)
      integer, intent(in) :: at, stride
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: a(*)
      integer :: k, c
      real(wp) :: e(2)

      do k = g%first_slide, g%last_slide
         e = slide_vector(b, k, s)
         c = at + b%slides(k)%column*stride
         if (b%slides(k)%column > 0) a(c) = a(c) + dot_product(e, f)
         c = at + b%slides(k)%frame_column*stride
         if (b%slides(k)%frame_column > 0) a(c) = a(c) - s%u(b%slides(k)%unknown)%value*across(e, f)
      end do
   end subroutine slide_entries
end module block_rows
