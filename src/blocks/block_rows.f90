!> The equations of one block at a state: residual and Jacobian.
module block_rows
   use kinds, only: wp
   use block_matrix, only: entries_of
   use blocks, only: blocks_t, block_loop_t, loop_components, loop_projection
   use block_state, only: state_t, slide_vector, turned, across
   implicit none
   private
   public :: assemble_block, assemble_dense

contains

   !> Jacobian `a`, stored as the block's shape says, and residual `r` (rows) of block `i` at the state.
   pure subroutine assemble_block(b, i, s, a, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(*)
      integer :: m, k, row

      a(:entries_of(b%list(i)%shape)) = 0.0_wp
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            select case (g%kind)
            case (loop_components)
               call close_vector_loop(b, m, s)
               call component_rows(b, g, m, s, a, r)
            case (loop_projection)
               call close_vector_loop(b, m, s)
               call projection_row(b, g, m, s, a, r)
            case default
               ! Both may be the angle of one frame.
               r(g%row_x) = s%u(g%orientation)%value - s%u(g%less)%value
               if (g%orientation_at > 0) a(g%orientation_at) = a(g%orientation_at) + 1.0_wp
               if (g%less_at > 0) a(g%less_at) = a(g%less_at) - 1.0_wp
            end select
         end associate
      end do
      do k = b%list(i)%first_row, b%list(i)%last_row
         row = k - b%list(i)%first_row + 1
         r(row) = r(row) - b%rows(k)%constant - s%drive_value(0, b%rows(k)%drive)
      end do
   end subroutine assemble_block

   !> The same with all of the Jacobian, zeros as well: `a` (rows, n).
   pure subroutine assemble_dense(b, i, s, a, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(b%list(i)%shape%rows, *), r(*)
      real(wp), allocatable :: entries(:)
      integer :: c, k

      associate (shape => b%list(i)%shape)
         if (shape%pattern == 0) then
            call assemble_block(b, i, s, a, r)
            return
         end if
         allocate (entries(shape%entries))
         call assemble_block(b, i, s, entries, r)
         a(:, :shape%n) = 0.0_wp
         associate (p => b%patterns(shape%pattern))
            do c = 1, shape%n
               do k = p%first(c) + 1, p%first(c + 1)
                  a(p%row(k) + 1, c) = entries(k)
               end do
            end do
         end associate
      end associate
   end subroutine assemble_dense

   !> The gap of polygon instance `m`, and the arms of the block's own frames.
   pure subroutine close_vector_loop(b, m, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(state_t), intent(inout) :: s
      integer :: k
      real(wp) :: x, y

      x = s%part(m)%known(1, 0)
      y = s%part(m)%known(2, 0)
      do k = b%loops(m)%first_own, b%loops(m)%last_vector
         associate (f => s%u(b%body_vectors(k)%orientation), d => b%body_vectors(k), u => s%own(:, k))
            u(1) = f%c*d%x - f%s*d%y
            u(2) = f%s*d%x + f%c*d%y
            x = x + u(1)
            y = y + u(2)
         end associate
      end do
      s%part(m)%closure_error(1) = x
      s%part(m)%closure_error(2) = y
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         s%part(m)%closure_error = s%part(m)%closure_error + s%u(b%slides(k)%unknown)%value*slide_vector(b, k, s)
      end do
   end subroutine close_vector_loop

   !> Rows of the x and y components of polygon instance `m`, which is `g`.
   pure subroutine component_rows(b, g, m, s, a, r)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: m
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: a(*), r(*)
      integer :: k

      if (g%row_x > 0) then
         r(g%row_x) = s%part(m)%closure_error(1)
         do k = g%first_own, g%last_vector
            a(b%body_vectors(k)%at(1)) = -s%own(2, k)
         end do
      end if
      if (g%row_y > 0) then
         r(g%row_y) = s%part(m)%closure_error(2)
         do k = g%first_own, g%last_vector
            a(b%body_vectors(k)%at(2)) = s%own(1, k)
         end do
      end if
      if (g%last_slide < g%first_slide) return
      if (g%row_x > 0) call slide_entries(b, g, 1, [1.0_wp, 0.0_wp], s, a)
      if (g%row_y > 0) call slide_entries(b, g, 2, [0.0_wp, 1.0_wp], s, a)
   end subroutine component_rows

   !> Row of the projection of polygon instance `m`, which is `g`.
   pure subroutine projection_row(b, g, m, s, a, r)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: m
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(*)
      integer :: k
      real(wp) :: f(2)

      f = turned(s, g%orientation, g%direction)
      s%part(m)%f = f
      r(g%row_x) = s%part(m)%closure_error(1)*f(1) + s%part(m)%closure_error(2)*f(2)
      do k = g%first_own, g%last_vector
         a(b%body_vectors(k)%at(1)) = s%own(1, k)*f(2) - s%own(2, k)*f(1)
      end do
      if (g%last_slide >= g%first_slide) call slide_entries(b, g, 1, f, s, a)
      if (g%orientation_at > 0) a(g%orientation_at) = a(g%orientation_at) + across(s%part(m)%closure_error, f)
   end subroutine projection_row

   !> What the slides of instance `g` add to its row `row` (1: row_x, 2: row_y), which projects on `f`.
   pure subroutine slide_entries(b, g, row, f, s, a)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: row
      real(wp), intent(in) :: f(2)
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: a(*)
      integer :: k
      real(wp) :: e(2)

      do k = g%first_slide, g%last_slide
         e = slide_vector(b, k, s)
         associate (at => b%slides(k)%at(row), orientation_at => b%slides(k)%orientation_at(row))
            if (at > 0) a(at) = a(at) + dot_product(e, f)
            if (orientation_at > 0) a(orientation_at) = a(orientation_at) - s%u(b%slides(k)%unknown)%value*across(e, f)
         end associate
      end do
   end subroutine slide_entries
end module block_rows
