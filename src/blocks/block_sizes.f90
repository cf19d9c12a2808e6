!> How large the numbers are that go into the equations of a block, and what these hold beyond their linear part.
module block_sizes
   use kinds, only: wp
   use planar, only: length_of
   use blocks, only: blocks_t, loop_projection
   use block_state, only: state_t
   implicit none
   private
   public :: largest_rates, rounded_sizes, second_order_bounds

contains

   !> Finds the largest rate and acceleration of anything that goes into the equations of block `i`: angles, slides,
   !> drives, known or not.
   pure function largest_rates(b, i, s) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp) :: largest(2)
      integer, allocatable :: u(:)
      integer :: k, m

      largest = 0.0_wp
      do k = b%list(i)%first_row, b%list(i)%last_row
         largest = max(largest, abs(s%drive_value(1:2, b%rows(k)%drive)))
      end do
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            u = [g%orientation, g%less, b%body_vectors(g%first_vector:g%last_vector)%orientation, &
               b%slides(g%first_slide:g%last_slide)%orientation, b%slides(g%first_slide:g%last_slide)%unknown]
         end associate
         largest = max(largest, [maxval(abs(s%u(u)%rate)), maxval(abs(s%u(u)%acceleration))])
      end do
   end function largest_rates

   !> (rows) The size of the numbers that each row of block `i` rounds, in the unit of its loop.
   pure function rounded_sizes(b, i, s) result(sizes)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp) :: sizes(b%list(i)%shape%rows), size_of
      integer :: m, k

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            size_of = max(b%numbers%loops(m)%coarse, abs(s%u(g%orientation)%value), abs(s%u(g%less)%value))
            do k = g%first_own, g%last_vector
               size_of = max(size_of, abs(s%u(b%body_vectors(k)%orientation)%value))
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k))
                  size_of = max(size_of, abs(s%u(slide%unknown)%value)*length_of(b%numbers%e(k)), &
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
               associate (length => hypot(b%numbers%d(k)%x, b%numbers%d(k)%y), &
                  turn => change(b%body_vectors(k)%column))
                  first = first + length*turn
                  second = second + length*turn**2
               end associate
            end do
            do k = g%first_slide, g%last_slide
               associate (slide => b%slides(k), turn => change(b%slides(k)%orientation_column), &
                  length => abs(s%u(b%slides(k)%unknown)%value))
                  first = first + length_of(b%numbers%e(k))*(change(slide%column) + length*turn)
                  second = second + length_of(b%numbers%e(k))*turn*(2.0_wp*change(slide%column) + length*turn)
               end associate
            end do
            if (g%kind == loop_projection) then
               associate (turn => change(g%orientation_column))
                  second = second + turn*(2.0_wp*first + length_of(s%loop(m)%closure_error)*turn)
               end associate
            end if
            if (g%row_x > 0) bounds(g%row_x) = second
            if (g%row_y > 0) bounds(g%row_y) = second
         end associate
      end do
   end function second_order_bounds
end module block_sizes
