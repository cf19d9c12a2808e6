!> The equations of one block in all lanes: the text of equations.inc, compiled for one number a lane.
#define NUMBER real(wp), dimension(width)
#define LIST(list) list(width, *)
#define AT(list,k) list(:, k)
#define DRIVES(values) values(width, 0:2, 0:*)
#define DRIVE_AT(values,order,k) values(:, order, k)
#define ZERO 0.0_wp
#define ONE 1.0_wp
#define TWO 2.0_wp
module lane_equations
   use kinds, only: wp
   use block_matrix, only: entries_of
   use blocks, only: block_t, equation_row_t, block_loop_t, body_vector_t, slide_t, loop_projection, loop_angles
   use lane_sines, only: width, sines
   use lane_state, only: lanes_t, vector_t, unknown_t, row_numbers_t, loop_numbers_t, loop_state_t
   implicit none
   private
   public :: set_lane_direction, find_lane_direct, find_lane_known, assemble_lanes, lane_accelerations

contains

   !> Cosine and sine of unknown `i`, if it is an angle.
   pure subroutine set_lane_direction(l, i)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i

      if (i <= l%blocks%orientations) call sines(l%u(i)%value, l%u(i)%c, l%u(i)%s)
   end subroutine set_lane_direction

   !> Solves block `i`, a drive's own unknown.
   pure subroutine find_lane_direct(l, i)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i

      associate (b => l%blocks, first_row => l%blocks%list(i)%first_row)
         associate (u => b%unknown(b%list(i)%first))
            call find_direct(b%rows(first_row), l%rows(first_row), l%drive, l%u(b%rows(first_row)%other), l%u(u))
            call set_lane_direction(l, u)
         end associate
      end associate
   end subroutine find_lane_direct

   !> Finds what earlier blocks give to the loops of block `i`: place, velocity, acceleration.
   pure subroutine find_lane_known(l, i)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i

      associate (b => l%blocks, block => l%blocks%list(i))
         call find_known(block%first_loop, block%last_loop, b%loops, l%numbers, b%body_vectors, l%d, l%u, l%loop)
      end associate
   end subroutine find_lane_known

   !> Jacobian `a` (lanes, n*n by columns) and residual `r` (lanes, n) of block `i`, and the right-hand side `v`
   !> (lanes, n) for the velocities.
   pure subroutine assemble_lanes(l, i, n, a, r, v)
      type(lanes_t), intent(inout) :: l
      integer, intent(in) :: i, n
      real(wp), intent(inout) :: a(width, n*n), r(width, n), v(width, n)

      associate (b => l%blocks)
         call assemble(b%list(i), l%block(i)%has_right_sides, b%loops, l%numbers, b%body_vectors, l%d, b%slides, l%e, &
            b%rows, l%rows, l%drive, l%u, l%own, l%guide, l%loop, a, r, v)
      end associate
   end subroutine assemble_lanes

   !> Right-hand side `v` (lanes, n) for the accelerations of block `i`, once the velocities are known, with the vectors
   !> of the last `assemble_lanes`.
   pure subroutine lane_accelerations(l, i, n, v)
      type(lanes_t), intent(in) :: l
      integer, intent(in) :: i, n
      real(wp), intent(inout) :: v(width, n)
      integer :: m

      associate (b => l%blocks)
         do m = b%list(i)%first_loop, b%list(i)%last_loop
            call acceleration_rows(b%loops(m), b%body_vectors, b%slides, l%u, l%own, l%guide, l%loop(m), v)
         end do
         if (l%block(i)%has_right_sides) &
            call add_drives(b%list(i)%first_row, b%list(i)%last_row, b%rows, 2, l%drive, v)
      end associate
   end subroutine lane_accelerations

#include "equations.inc"
end module lane_equations
