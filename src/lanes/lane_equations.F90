!> The equations of one block in all lanes: the text of equations.inc, compiled for one number a lane.
#define NUMBER real(wp), dimension(lane_count)
#define LIST(list) list(lane_count, *)
#define AT(list,k) list(:, k)
#define DRIVES(values) values(lane_count, 0:2, 0:*)
#define DRIVE_AT(values,order,k) values(:, order, k)
#define ZERO 0.0_wp
#define ONE 1.0_wp
#define TWO 2.0_wp
module lane_equations
   use kinds, only: wp
   use blocks, only: block_t, equation_row_t, block_loop_t, body_vector_t, slide_t, loop_projection, loop_angles
   use lane_sines, only: lane_count, sines
   use lane_state, only: lanes_t, vector_t, unknown_t, row_numbers_t, loop_numbers_t, loop_state_t
   implicit none
   private
   public :: set_lane_direction, find_lane_direct, find_lane_known, assemble_lanes, lane_accelerations

contains

   !> Finds cosine and sine of an unknown, if it is an angle; a slide has none.
   pure subroutine set_lane_direction(lanes, i)
      type(lanes_t), intent(inout) :: lanes   !< with the value of the unknown
      integer, intent(in) :: i               !< the number of the unknown

      if (i <= lanes%blocks%orientations) call sines(lanes%u(i)%value, lanes%u(i)%c, lanes%u(i)%s)
   end subroutine set_lane_direction

   !> Solves an explicit block: the only unknown of the equation of a drive.
   pure subroutine find_lane_direct(lanes, i)
      type(lanes_t), intent(inout) :: lanes   !< with the values of the drives; get the unknown's
      integer, intent(in) :: i               !< the number of the block

      associate (b => lanes%blocks, first_row => lanes%blocks%list(i)%first_row)
         associate (u => b%unknown(b%list(i)%first))
            call find_direct(b%rows(first_row), lanes%rows(first_row), lanes%drive, &
               lanes%u(b%rows(first_row)%other), lanes%u(u))
            call set_lane_direction(lanes, u)
         end associate
      end associate
   end subroutine find_lane_direct

   !> Finds the sums of the vectors that earlier blocks give to the loops of a block: place, velocity, acceleration.
   pure subroutine find_lane_known(lanes, i)
      type(lanes_t), intent(inout) :: lanes   !< with the motion of earlier blocks
      integer, intent(in) :: i               !< the number of the block

      associate (b => lanes%blocks, block => lanes%blocks%list(i))
         call find_known(block%first_loop, block%last_loop, b%loops, lanes%numbers, &
            b%body_vectors, lanes%d, lanes%u, lanes%loop)
      end associate
   end subroutine find_lane_known

   !> Assembles the equations of a block: its Jacobian, its residuals and its right-hand sides for the velocities.
   pure subroutine assemble_lanes(lanes, i, n, a, residuals, right_side)
      type(lanes_t), intent(inout) :: lanes   !< with values and directions of the unknowns
      integer, intent(in) :: i                        !< the number of the block
      integer, intent(in) :: n                        !< unknowns of the block, as many as its rows
      real(wp), intent(inout) :: a(lane_count, n*n)        !< the Jacobian, by columns
      real(wp), intent(inout) :: residuals(lane_count, n)  !< (lanes, rows) in rad or the unit of the loop
      real(wp), intent(inout) :: right_side(lane_count, n) !< (lanes, rows) the residuals' unit per unit of time

      associate (b => lanes%blocks)
         call assemble(b%list(i), lanes%block(i)%has_right_sides, b%loops, lanes%numbers, b%body_vectors, lanes%d, &
            b%slides, lanes%e, b%rows, lanes%rows, lanes%drive, lanes%u, lanes%own, lanes%guide, lanes%loop, a, &
            residuals, right_side)
      end associate
   end subroutine assemble_lanes

   !> Finds the right-hand sides for the accelerations of a block from its velocities. The rotated vectors are those of
   !> the last `assemble_lanes`.
   pure subroutine lane_accelerations(lanes, i, n, right_side)
      type(lanes_t), intent(in) :: lanes     !< with the rates of the unknowns
      integer, intent(in) :: i                        !< the number of the block
      integer, intent(in) :: n                        !< unknowns of the block, as many as its rows
      real(wp), intent(inout) :: right_side(lane_count, n) !< (lanes, rows) rad or unit of the loop, per time squared
      integer :: m

      associate (b => lanes%blocks)
         do m = b%list(i)%first_loop, b%list(i)%last_loop
            call acceleration_rows(b%loops(m), b%body_vectors, b%slides, lanes%u, lanes%own, lanes%guide, &
               lanes%loop(m), right_side)
         end do
         if (lanes%block(i)%has_right_sides) &
            call add_drives(b%list(i)%first_row, b%list(i)%last_row, b%rows, 2, lanes%drive, right_side)
      end associate
   end subroutine lane_accelerations

#include "equations.inc"
end module lane_equations
