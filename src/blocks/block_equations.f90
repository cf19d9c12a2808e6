!> The equations of one block at a state: residual and Jacobian; and the right-hand sides for velocities and
!> accelerations, what the first and second derivatives of the equations with respect to time hold beside the unknowns
!> of that order.
module block_equations
   use kinds, only: wp
   use planar, only: rotated, quarter_turn, cross
   use block_matrix, only: entries_of
   use blocks, only: blocks_t, block_loop_t, body_vector_t, loop_projection, loop_angles
   use block_state, only: state_t, unknown_t, slide_vector
   implicit none
   private
   public :: assemble_block, assemble_dense, right_hand_side, largest_rates, rounded_sizes, &
      second_order_bounds

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
            if (g%kind == loop_angles) then
               ! Both may be the same angle.
               r(g%row_x) = s%u(g%orientation)%value - s%u(g%less)%value
               if (g%orientation_at > 0) a(g%orientation_at) = a(g%orientation_at) + 1.0_wp
               if (g%less_at > 0) a(g%less_at) = a(g%less_at) - 1.0_wp
               cycle
            end if
            call find_closure_error(b, m, s)
            if (g%kind == loop_projection) then
               call projection_row(b, g, m, s, a, r)
            else
               call component_rows(g, b%body_vectors, s%own, s%loop(m)%closure_error, a, r)
               if (g%last_slide < g%first_slide) cycle
               if (g%row_x > 0) call slide_entries(b, g, 1, [1.0_wp, 0.0_wp], s, a)
               if (g%row_y > 0) call slide_entries(b, g, 2, [0.0_wp, 1.0_wp], s, a)
            end if
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

   !> The closure error of loop `m`, and the body vectors that the block's own angles rotate.
   pure subroutine find_closure_error(b, m, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(state_t), intent(inout) :: s
      integer :: k
      real(wp) :: x, y

      x = s%loop(m)%known(1, 0)
      y = s%loop(m)%known(2, 0)
      call turn_vectors(b%loops(m)%first_own, b%loops(m)%last_vector, b%body_vectors, s%u, s%own, x, y)
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         s%guide(:, k) = slide_vector(b, k, s)
         x = x + s%u(b%slides(k)%unknown)%value*s%guide(1, k)
         y = y + s%u(b%slides(k)%unknown)%value*s%guide(2, k)
      end do
      s%loop(m)%closure_error(1) = x
      s%loop(m)%closure_error(2) = y
   end subroutine find_closure_error

   !> Body vectors number `first` to `last`, rotated by their angles among `u`, go to `own`; x and y grow by their sum.
   !> On plain arrays, which cost no descriptors: this is the innermost loop of a step.
   pure subroutine turn_vectors(first, last, vectors, u, own, x, y)
      integer, intent(in) :: first, last
      type(body_vector_t), intent(in) :: vectors(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(inout) :: own(2, *), x, y
      integer :: k

      do k = first, last
         associate (f => u(vectors(k)%orientation), d => vectors(k))
            own(1, k) = f%c*d%x - f%s*d%y
            own(2, k) = f%s*d%x + f%c*d%y
            x = x + own(1, k)
            y = y + own(2, k)
         end associate
      end do
   end subroutine turn_vectors

   !> Rows of the x and y components of loop `g`, but for its slides.
   pure subroutine component_rows(g, vectors, own, closure_error, a, r)
      type(block_loop_t), intent(in) :: g
      type(body_vector_t), intent(in) :: vectors(*)
      real(wp), intent(in) :: own(2, *), closure_error(2)
      real(wp), intent(inout) :: a(*), r(*)
      integer :: k

      if (g%row_x > 0) r(g%row_x) = closure_error(1)
      if (g%row_y > 0) r(g%row_y) = closure_error(2)
      do k = g%first_own, g%last_vector
         if (g%row_x > 0) a(vectors(k)%at(1)) = -own(2, k)
         if (g%row_y > 0) a(vectors(k)%at(2)) = own(1, k)
      end do
   end subroutine component_rows

   !> Row of the projection of loop `m`, which is `g`.
   pure subroutine projection_row(b, g, m, s, a, r)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: m
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(*)
      integer :: k
      real(wp) :: f(2)

      f = rotated(g%direction, [s%u(g%orientation)%c, s%u(g%orientation)%s])
      s%loop(m)%f = f
      r(g%row_x) = s%loop(m)%closure_error(1)*f(1) + s%loop(m)%closure_error(2)*f(2)
      do k = g%first_own, g%last_vector
         a(b%body_vectors(k)%at(1)) = cross(s%own(:, k), f)
      end do
      if (g%last_slide >= g%first_slide) call slide_entries(b, g, 1, f, s, a)
      if (g%orientation_at > 0) a(g%orientation_at) = a(g%orientation_at) + cross(f, s%loop(m)%closure_error)
   end subroutine projection_row

   !> What the slides of loop `g` add to its row `row` (1: row_x, 2: row_y), which projects on `f`.
   pure subroutine slide_entries(b, g, row, f, s, a)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: row
      real(wp), intent(in) :: f(2)
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: a(*)
      integer :: k

      do k = g%first_slide, g%last_slide
         associate (at => b%slides(k)%at(row), orientation_at => b%slides(k)%orientation_at(row), e => s%guide(:, k))
            if (at > 0) a(at) = a(at) + dot_product(e, f)
            if (orientation_at > 0) a(orientation_at) = a(orientation_at) - s%u(b%slides(k)%unknown)%value*cross(f, e)
         end associate
      end do
   end subroutine slide_entries

   !> Right-hand side `v` (rows) for the velocities (`order` 1) or, once these are known, the accelerations (2) of
   !> block `i`: the drives' derivatives less what is given. An equation of two angles, one of them of an earlier block,
   !> would be a direct block: to such an equation nothing is given. Closure errors, directions and rotated body vectors
   !> are those of the last `assemble_block`.
   pure subroutine right_hand_side(b, i, order, s, v)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(state_t), intent(in) :: s
      real(wp), intent(out) :: v(*)
      real(wp) :: given(2)
      integer :: k, m

      do k = b%list(i)%first_row, b%list(i)%last_row
         v(k - b%list(i)%first_row + 1) = s%drive_value(order, b%rows(k)%drive)
      end do
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            if (g%kind == loop_angles) cycle
            given = given_part(b, g, m, order, s)
            if (g%kind == loop_projection) then
               v(g%row_x) = v(g%row_x) - projected_part(b, g, m, order, s, given)
            else
               if (g%row_x > 0) v(g%row_x) = v(g%row_x) - given(1)
               if (g%row_y > 0) v(g%row_y) = v(g%row_y) - given(2)
            end if
         end associate
      end do
   end subroutine right_hand_side

   !> The largest rate and acceleration of anything that goes into the equations of block `i`: angles, slides, drives,
   !> known or not.
   pure function largest_rates(b, i, s) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp) :: largest(2)
      integer :: k, m

      largest = 0.0_wp
      do k = b%list(i)%first_row, b%list(i)%last_row
         largest = max(largest, abs(s%drive_value(1:2, b%rows(k)%drive)))
      end do
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         call take(b%loops(m)%orientation)
         call take(b%loops(m)%less)
         do k = b%loops(m)%first_vector, b%loops(m)%last_vector
            call take(b%body_vectors(k)%orientation)
         end do
         do k = b%loops(m)%first_slide, b%loops(m)%last_slide
            call take(b%slides(k)%orientation)
            call take(b%slides(k)%unknown)
         end do
      end do

   contains

      !> Unknown number `u` of all blocks.
      pure subroutine take(u)
         integer, intent(in) :: u

         largest = max(largest, abs([s%u(u)%rate, s%u(u)%acceleration]))
      end subroutine take
   end function largest_rates

   !> The part of g' (order 1) or g'' (order 2) of loop `m` that holds no unknown of that order.
   pure function given_part(b, block_loop, m, order, s) result(g)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: block_loop
      integer, intent(in) :: m, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2)
      integer :: k

      g = s%loop(m)%known(:, order)
      if (order == 2) call subtract_inward(block_loop%first_own, block_loop%last_vector, b%body_vectors, s%u, s%own, g)
      do k = block_loop%first_slide, block_loop%last_slide
         g = g + slide_part(b, k, order, s)
      end do
   end function given_part

   !> Subtracts from `g` what the turned vectors `own`, number `first` to `last`, have of acceleration towards their
   !> beginnings.
   pure subroutine subtract_inward(first, last, vectors, u, own, g)
      integer, intent(in) :: first, last
      type(body_vector_t), intent(in) :: vectors(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(in) :: own(2, *)
      real(wp), intent(inout) :: g(2)
      real(wp) :: square
      integer :: k

      do k = first, last
         square = u(vectors(k)%orientation)%rate**2
         g(1) = g(1) - square*own(1, k)
         g(2) = g(2) - square*own(2, k)
      end do
   end subroutine subtract_inward

   !> The same of slide number `k`: (s e)' = s' e + s w e',  (s e)'' = s'' e + 2 s' w e' + s (w' e' - w^2 e).
   pure function slide_part(b, k, order, s) result(g)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: k, order
      type(state_t), intent(in) :: s
      real(wp) :: g(2), e(2), e_t(2)

      associate (slide => b%slides(k), u => s%u(b%slides(k)%unknown), f => s%u(b%slides(k)%orientation))
         e = s%guide(:, k)
         e_t = quarter_turn(e)
         g = 0.0_wp
         if (order == 1) then
            if (slide%column == 0) g = g + u%rate*e
            if (slide%orientation_column == 0) g = g + u%value*f%rate*e_t
         else
            g = 2.0_wp*u%rate*f%rate*e_t - u%value*f%rate**2*e
            if (slide%column == 0) g = g + u%acceleration*e
            if (slide%orientation_column == 0) g = g + u%value*f%acceleration*e_t
         end if
      end associate
   end function slide_part

   !> The part of (g . f)' or (g . f)'' of loop `m` that holds no unknown of that order, from that of g' or g'', `g`.
   pure real(wp) function projected_part(b, block_loop, m, order, s, g) result(v)
      type(blocks_t), intent(in) :: b
      type(block_loop_t), intent(in) :: block_loop
      integer, intent(in) :: m, order
      type(state_t), intent(in) :: s
      real(wp), intent(in) :: g(2)

      associate (c => s%u(block_loop%orientation), closure_error => s%loop(m)%closure_error, f => s%loop(m)%f)
         v = g(1)*f(1) + g(2)*f(2)
         if (block_loop%orientation == 0) return
         if (order == 1) then
            if (block_loop%orientation_column == 0) v = v + c%rate*cross(f, closure_error)
         else
            v = v + 2.0_wp*c%rate*cross(f, closure_error_rate(b, block_loop, m, s)) &
               - c%rate**2*dot_product(closure_error, f)
            if (block_loop%orientation_column == 0) v = v + c%acceleration*cross(f, closure_error)
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

      g = s%loop(m)%known(:, 1)
      do k = block_loop%first_own, block_loop%last_vector
         g = g + s%u(b%body_vectors(k)%orientation)%rate*quarter_turn(s%own(:, k))
      end do
      do k = block_loop%first_slide, block_loop%last_slide
         e = s%guide(:, k)
         associate (u => s%u(b%slides(k)%unknown))
            g = g + u%rate*e + u%value*s%u(b%slides(k)%orientation)%rate*quarter_turn(e)
         end associate
      end do
   end function closure_error_rate

   !> (rows) The size of the numbers that each row of block `i` rounds, in the unit of its loop.
   pure function rounded_sizes(b, i, s) result(sizes)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp) :: sizes(b%list(i)%shape%rows), size_of
      integer :: m, k

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            size_of = max(g%coarse, abs(s%u(g%orientation)%value), abs(s%u(g%less)%value))
            do k = g%first_own, g%last_vector
               size_of = max(size_of, abs(s%u(b%body_vectors(k)%orientation)%value))
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k))
                  size_of = max(size_of, abs(s%u(slide%unknown)%value)*norm2(slide%body_vector), &
                     abs(s%u(slide%orientation)%value))
               end associate
            end do
            if (g%row_x > 0) sizes(g%row_x) = size_of
            if (g%row_y > 0) sizes(g%row_y) = size_of
         end associate
      end do
   end function rounded_sizes

   !> (rows) Bounds of d . r'' d for changes `d` (n, none negative) of the unknowns of block `i` from the state: twice
   !> what the rows r hold beyond their linear part. A projection that turns with an angle of the block turns its loop.
   pure function second_order_bounds(b, i, s, d) result(bounds)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp), intent(in) :: d(:)
      real(wp) :: bounds(b%list(i)%shape%rows), change(0:size(d)), first, second
      integer :: m, k

      change = [0.0_wp, d]
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            first = 0.0_wp
            second = 0.0_wp
            do k = g%first_own, g%last_vector
               associate (length => hypot(b%body_vectors(k)%x, b%body_vectors(k)%y), &
                  turn => change(b%body_vectors(k)%column))
                  first = first + length*turn
                  second = second + length*turn**2
               end associate
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k), turn => change(b%slides(k)%orientation_column), &
                  length => abs(s%u(b%slides(k)%unknown)%value))
                  first = first + norm2(slide%body_vector)*(change(slide%column) + length*turn)
                  second = second + norm2(slide%body_vector)*turn*(2.0_wp*change(slide%column) + length*turn)
               end associate
            end do
            if (g%kind == loop_projection) then
               associate (turn => change(g%orientation_column))
                  second = second + turn*(2.0_wp*first + norm2(s%loop(m)%closure_error)*turn)
               end associate
            end if
            if (g%row_x > 0) bounds(g%row_x) = second
            if (g%row_y > 0) bounds(g%row_y) = second
         end associate
      end do
   end function second_order_bounds
end module block_equations
