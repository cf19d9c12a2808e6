!> The equations of one block at a state: residual and Jacobian; and the right-hand sides for velocities and
!> accelerations, what the first and second derivatives of the equations with respect to time hold beside the unknowns
!> of that order.
module block_equations
   use kinds, only: wp
   use planar, only: vector_t, rotated, quarter_turn, cross
   use block_matrix, only: entries_of
   use blocks, only: blocks_t, row_t, block_loop_t, body_vector_t, slide_t, row_numbers_t, loop_projection, &
      loop_angles
   use block_state, only: state_t, unknown_t, loop_state_t, slide_velocity, slide_acceleration
   implicit none
   private
   public :: assemble_block, assemble_with_velocities, assemble_dense, right_hand_side

contains

   !> Jacobian `a`, stored as the block's shape says, and residual `r` (rows) of block `i` at the state.
   pure subroutine assemble_block(b, i, s, a, r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(*)
      real(wp) :: v(b%list(i)%shape%rows)

      ! The row of a drive's own unknown is in no loop.
      v = 0.0_wp
      call assemble_with_velocities(b, i, s, a, r, v)
   end subroutine assemble_block

   !> The same with the right-hand side `v` (rows) for the velocities there.
   pure subroutine assemble_with_velocities(b, i, s, a, r, v)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(*), r(*), v(*)
      integer :: m

      associate (block => b%list(i))
         call set_to_zero(entries_of(block%shape), a)
         do m = block%first_loop, block%last_loop
            associate (g => b%loops(m))
               if (g%kind == loop_angles) then
                  ! Both may be the same angle.
                  r(g%row_x) = s%u(g%orientation)%value - s%u(g%less)%value
                  if (g%orientation_at > 0) a(g%orientation_at) = a(g%orientation_at) + 1.0_wp
                  if (g%less_at > 0) a(g%less_at) = a(g%less_at) - 1.0_wp
               else
                  call find_closure_error(g, b%body_vectors, b%numbers%d, b%slides, b%numbers%e, s%u, s%own, s%guide, &
                     s%loop(m)%known, s%loop(m)%closure_error)
                  call position_rows(g, b%numbers%loops(m)%direction, b%body_vectors, b%slides, s%u, s%own, s%guide, &
                     s%loop(m), a, r)
               end if
               call velocity_rows(g, b%slides, s%u, s%guide, s%loop(m), v)
            end associate
         end do
         if (b%numbers%blocks(i)%has_right_sides) &
            call take_right_sides(block%first_row, block%last_row, b%rows, b%numbers%rows, s%drive_value, r, v)
      end associate
   end subroutine assemble_with_velocities

   !> Makes the `n` numbers of `a` zero: of few, where a call would take longer than they do, one by one.
   pure subroutine set_to_zero(n, a)
      integer, intent(in) :: n
      real(wp), intent(inout) :: a(*)

      select case (n)
      case (1)
         a(1) = 0.0_wp
      case (4)
         a(:4) = 0.0_wp
      case default
         a(:n) = 0.0_wp
      end select
   end subroutine set_to_zero

   !> Subtracts from `r` what the equations number `first` to `last` are equal to, their constants and the `values` of
   !> drives, and adds the rates of these to `v`.
   pure subroutine take_right_sides(first, last, rows, numbers, values, r, v)
      integer, intent(in) :: first, last
      type(row_t), intent(in) :: rows(*)
      type(row_numbers_t), intent(in) :: numbers(*)
      real(wp), intent(in) :: values(0:2, 0:*)
      real(wp), intent(inout) :: r(*), v(*)
      integer :: k

      do k = first, last
         r(k - first + 1) = r(k - first + 1) - numbers(k)%constant - values(0, rows(k)%drive)
         v(k - first + 1) = v(k - first + 1) + values(1, rows(k)%drive)
      end do
   end subroutine take_right_sides

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

   !> The `closure_error` of loop `g`, of which `known` is known, and the vectors that the block's own angles among `u`
   !> rotate: `own` and, of slides, `guide`; in their axes they are `d` and `e`. On plain arrays, which cost no
   !> descriptors, as all that a step does often.
   pure subroutine find_closure_error(g, vectors, d, slides, e, u, own, guide, known, closure_error)
      type(block_loop_t), intent(in) :: g
      type(body_vector_t), intent(in) :: vectors(*)
      type(slide_t), intent(in) :: slides(*)
      type(vector_t), intent(in) :: d(*), e(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(inout) :: own(2, *), guide(2, *)
      real(wp), intent(in) :: known(2, 0:2)
      real(wp), intent(out) :: closure_error(2)
      integer :: k
      real(wp) :: x, y

      x = known(1, 0)
      y = known(2, 0)
      call turn_vectors(g%first_own, g%last_vector, vectors, d, u, own, x, y)
      do k = g%first_slide, g%last_slide
         associate (f => u(slides(k)%orientation), s => u(slides(k)%unknown)%value)
            guide(1, k) = e(k)%x*f%c - e(k)%y*f%s
            guide(2, k) = e(k)%x*f%s + e(k)%y*f%c
            x = x + s*guide(1, k)
            y = y + s*guide(2, k)
         end associate
      end do
      closure_error(1) = x
      closure_error(2) = y
   end subroutine find_closure_error

   !> Body vectors number `first` to `last`, rotated by their angles among `u`, go to `own`; x and y grow by their sum.
   pure subroutine turn_vectors(first, last, vectors, d_of, u, own, x, y)
      integer, intent(in) :: first, last
      type(body_vector_t), intent(in) :: vectors(*)
      type(vector_t), intent(in) :: d_of(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(inout) :: own(2, *), x, y
      integer :: k

      do k = first, last
         associate (f => u(vectors(k)%orientation), d => d_of(k))
            own(1, k) = f%c*d%x - f%s*d%y
            own(2, k) = f%s*d%x + f%c*d%y
            x = x + own(1, k)
            y = y + own(2, k)
         end associate
      end do
   end subroutine turn_vectors

   !> Jacobian and residual in the rows of loop `g`, whose state is `now`; a projection is on `direction`.
   pure subroutine position_rows(g, direction, vectors, slides, u, own, guide, now, a, r)
      type(block_loop_t), intent(in) :: g
      type(vector_t), intent(in) :: direction
      type(body_vector_t), intent(in) :: vectors(*)
      type(slide_t), intent(in) :: slides(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(in) :: own(2, *), guide(2, *)
      type(loop_state_t), intent(inout) :: now
      real(wp), intent(inout) :: a(*), r(*)

      if (g%kind == loop_projection) then
         now%f = rotated([direction%x, direction%y], [u(g%orientation)%c, u(g%orientation)%s])
         call projection_row(g, vectors, own, now%closure_error, now%f, a, r)
         if (g%last_slide >= g%first_slide) call slide_entries(g, 1, now%f, slides, u, guide, a)
         if (g%orientation_at > 0) a(g%orientation_at) = a(g%orientation_at) + cross(now%f, now%closure_error)
      else
         call component_rows(g, vectors, own, now%closure_error, a, r)
         if (g%last_slide < g%first_slide) return
         if (g%row_x > 0) call slide_entries(g, 1, [1.0_wp, 0.0_wp], slides, u, guide, a)
         if (g%row_y > 0) call slide_entries(g, 2, [0.0_wp, 1.0_wp], slides, u, guide, a)
      end if
   end subroutine position_rows

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

   !> Row of the projection of loop `g` on `f`, but for its slides and for the turn of `f`.
   pure subroutine projection_row(g, vectors, own, closure_error, f, a, r)
      type(block_loop_t), intent(in) :: g
      type(body_vector_t), intent(in) :: vectors(*)
      real(wp), intent(in) :: own(2, *), closure_error(2), f(2)
      real(wp), intent(inout) :: a(*), r(*)
      integer :: k

      r(g%row_x) = closure_error(1)*f(1) + closure_error(2)*f(2)
      do k = g%first_own, g%last_vector
         a(vectors(k)%at(1)) = cross(own(:, k), f)
      end do
   end subroutine projection_row

   !> What the slides of loop `g` add to its row `row` (1: row_x, 2: row_y), which projects on `f`.
   pure subroutine slide_entries(g, row, f, slides, u, guide, a)
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: row
      real(wp), intent(in) :: f(2)
      type(slide_t), intent(in) :: slides(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(in) :: guide(2, *)
      real(wp), intent(inout) :: a(*)
      integer :: k

      do k = g%first_slide, g%last_slide
         associate (at => slides(k)%at(row), orientation_at => slides(k)%orientation_at(row), e => guide(:, k))
            if (at > 0) a(at) = a(at) + dot_product(e, f)
            if (orientation_at > 0) a(orientation_at) = a(orientation_at) - u(slides(k)%unknown)%value*cross(f, e)
         end associate
      end do
   end subroutine slide_entries

   !> Right-hand side `v` (rows) for the velocities (`order` 1) or, once these are known, the accelerations (2) of
   !> block `i`: the drives' derivatives less what is given. An equation of two angles, one of them of an earlier block,
   !> would be a direct block: to such an equation nothing is given, and its loop has no known part. Closure errors,
   !> directions and rotated body vectors are those of the last `assemble_block`.
   pure subroutine right_hand_side(b, i, order, s, v)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(state_t), intent(in) :: s
      real(wp), intent(inout) :: v(*)
      integer :: m

      associate (block => b%list(i))
         if (order == 1) then
            do m = block%first_loop, block%last_loop
               call velocity_rows(b%loops(m), b%slides, s%u, s%guide, s%loop(m), v)
            end do
         else
            call acceleration_rows(block%first_loop, block%last_loop, b%loops, b%body_vectors, b%slides, s%u, s%own, &
               s%guide, s%loop, v)
         end if
         if (b%numbers%blocks(i)%has_right_sides) &
            call add_drives(block%first_row, block%last_row, b%rows, order, s%drive_value, v)
      end associate
   end subroutine right_hand_side

   !> Adds derivative number `order` of the drives' `values` to `v`, for the equations number `first` to `last`.
   pure subroutine add_drives(first, last, rows, order, values, v)
      integer, intent(in) :: first, last, order
      type(row_t), intent(in) :: rows(*)
      real(wp), intent(in) :: values(0:2, 0:*)
      real(wp), intent(inout) :: v(*)
      integer :: k

      do k = first, last
         v(k - first + 1) = v(k - first + 1) + values(order, rows(k)%drive)
      end do
   end subroutine add_drives

   !> In the rows of loop `g`, whose state is `now`: 0 less the part of g', or of (g . f)', without unknown velocities.
   pure subroutine velocity_rows(g, slides, u, guide, now, v)
      type(block_loop_t), intent(in) :: g
      type(slide_t), intent(in) :: slides(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(in) :: guide(2, *)
      type(loop_state_t), intent(in) :: now
      real(wp), intent(inout) :: v(*)
      real(wp) :: given(2), along
      integer :: k

      given(1) = now%known(1, 1)
      given(2) = now%known(2, 1)
      do k = g%first_slide, g%last_slide
         given = given + slide_velocity(slides(k), u, guide(:, k))
      end do
      if (g%kind == loop_projection) then
         along = given(1)*now%f(1) + given(2)*now%f(2)
         if (g%orientation > 0 .and. g%orientation_column == 0) &
            along = along + u(g%orientation)%rate*cross(now%f, now%closure_error)
         v(g%row_x) = 0.0_wp - along
      else
         if (g%row_x > 0) v(g%row_x) = 0.0_wp - given(1)
         if (g%row_y > 0) v(g%row_y) = 0.0_wp - given(2)
      end if
   end subroutine velocity_rows

   !> The same of g'' or (g . f)'', with the velocities and without unknown accelerations, for all loops from number
   !> `first` to `last`, whose states are `states`.
   pure subroutine acceleration_rows(first, last, loops, vectors, slides, u, own, guide, states, v)
      integer, intent(in) :: first, last
      type(block_loop_t), intent(in) :: loops(*)
      type(body_vector_t), intent(in) :: vectors(*)
      type(slide_t), intent(in) :: slides(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(in) :: own(2, *), guide(2, *)
      type(loop_state_t), intent(in) :: states(*)
      real(wp), intent(inout) :: v(*)
      real(wp) :: given(2), along
      integer :: m, k

      do m = first, last
         associate (g => loops(m), now => states(m))
            given(1) = now%known(1, 2)
            given(2) = now%known(2, 2)
            call subtract_inward(g%first_own, g%last_vector, vectors, u, own, given)
            do k = g%first_slide, g%last_slide
               given = given + slide_acceleration(slides(k), u, guide(:, k))
            end do
            if (g%kind == loop_projection) then
               along = given(1)*now%f(1) + given(2)*now%f(2)
               if (g%orientation > 0) then
                  associate (c => u(g%orientation), closure_error => now%closure_error, f => now%f)
                     given = closure_error_rate(g, vectors, slides, u, own, guide, now)
                     along = along + 2.0_wp*c%rate*cross(f, given) - c%rate**2*dot_product(closure_error, f)
                     if (g%orientation_column == 0) along = along + c%acceleration*cross(f, closure_error)
                  end associate
               end if
               v(g%row_x) = 0.0_wp - along
            else
               if (g%row_x > 0) v(g%row_x) = 0.0_wp - given(1)
               if (g%row_y > 0) v(g%row_y) = 0.0_wp - given(2)
            end if
         end associate
      end do
   end subroutine acceleration_rows

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

   !> g' with the velocities of the block itself.
   pure function closure_error_rate(loop, vectors, slides, u, own, guide, now) result(g)
      type(block_loop_t), intent(in) :: loop
      type(body_vector_t), intent(in) :: vectors(*)
      type(slide_t), intent(in) :: slides(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(in) :: own(2, *), guide(2, *)
      type(loop_state_t), intent(in) :: now
      real(wp) :: g(2), e(2)
      integer :: k

      g = now%known(:, 1)
      do k = loop%first_own, loop%last_vector
         g = g + u(vectors(k)%orientation)%rate*quarter_turn(own(:, k))
      end do
      do k = loop%first_slide, loop%last_slide
         e = guide(:, k)
         associate (s => u(slides(k)%unknown))
            g = g + s%rate*e + s%value*u(slides(k)%orientation)%rate*quarter_turn(e)
         end associate
      end do
   end function closure_error_rate
end module block_equations
