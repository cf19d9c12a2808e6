!> The equations of one block at a state: residual and Jacobian; and the right-hand sides for velocities and
!> accelerations, the parts of the first and second derivatives of the equations with respect to time that are known
!> before. Their text is equations.inc, here compiled for reals.
!>
!> With u_k = R(phi_k) d_k and u_k' its quarter turn, a loop has the closure error
!>    g = g_0 + sum_k u_k + sum_m s_m R e_m,      dg/dphi_k = u_k',  dg/ds_m = R e_m
!>    g'  = sum phi_k' u_k' + ...
!>    g'' = sum phi_k'' u_k' - phi_k'^2 u_k + ...
!> and a projection on f = R(phi_c) f_0 adds phi_c' g . f' and its derivative, as in `closure_equations`.
#define NUMBER real(wp)
#define LIST(list) list(*)
#define AT(list,k) list(k)
#define DRIVES(values) values(0:2, 0:*)
#define DRIVE_AT(values,order,k) values(order, k)
#define ZERO 0.0_wp
#define ONE 1.0_wp
#define TWO 2.0_wp
module block_equations
   use kinds, only: wp
   use number_types, only: vector_t, unknown_t, row_numbers_t, loop_numbers_t, loop_state_t
   use blocks, only: blocks_t, geometry_t, block_t, equation_row_t, block_loop_t, body_vector_t, slide_t, &
      loop_projection, loop_angles
   use block_state, only: state_t
   implicit none
   private
   public :: find_direct, find_known, assemble, velocity_rows, acceleration_rows, add_drives, add_rotating
   public :: find_known_parts, assemble_dense, right_hand_side

contains

   !> Finds the part of the loops of a block that earlier blocks give, with velocity and acceleration.
   pure subroutine find_known_parts(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< with the motion of earlier blocks; `known` of the loops is set

      call find_known(b%list(i)%first_loop, b%list(i)%last_loop, b%loops, x%loops, b%body_vectors, x%d, s%u, s%loop)
   end subroutine find_known_parts

   !> Assembles the dense Jacobian of a block at a state, and its residuals.
   pure subroutine assemble_dense(b, x, i, s, a, residuals)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block, which is not explicit
      type(state_t), intent(inout) :: s      !< with values and given parts; rotated vectors of the block are set
      real(wp), intent(inout) :: a(b%list(i)%shape%rows, *)   !< (rows, n) the Jacobian, zeros included
      real(wp), intent(inout) :: residuals(*)   !< (rows) unit of the loop or rad
      real(wp) :: v(b%list(i)%shape%rows)
      real(wp), allocatable :: entries(:)
      integer :: c, k

      v = 0.0_wp
      associate (block => b%list(i), shape => b%list(i)%shape, right_sides => x%blocks(i)%has_right_sides)
         if (shape%pattern == 0) then
            call assemble(block, right_sides, b%loops, x%loops, b%body_vectors, x%d, b%slides, x%e, b%rows, x%rows, &
               s%drive_value, s%u, s%own, s%guide, s%loop, a, residuals, v)
            return
         end if
         allocate (entries(shape%entries))
         call assemble(block, right_sides, b%loops, x%loops, b%body_vectors, x%d, b%slides, x%e, b%rows, x%rows, &
            s%drive_value, s%u, s%own, s%guide, s%loop, entries, residuals, v)
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

   !> Finds the right-hand side for the velocities of a block or, if these are set, for its accelerations: the
   !> derivatives of the drives minus the parts of the derivatives of the equations that are known before.
   pure subroutine right_hand_side(b, x, i, order, s, right_side)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      integer, intent(in) :: order           !< 1: velocities, 2: accelerations
      type(state_t), intent(in) :: s         !< with the rotated vectors of the last assembly of the block
      real(wp), intent(inout) :: right_side(*)   !< (rows) unit of the loop or rad, by time or its square
      integer :: m

      associate (block => b%list(i))
         do m = block%first_loop, block%last_loop
            if (order == 1) call velocity_rows(b%loops(m), b%slides, s%u, s%guide, s%loop(m), right_side)
            if (order == 2) &
               call acceleration_rows(b%loops(m), b%body_vectors, b%slides, s%u, s%own, s%guide, s%loop(m), right_side)
         end do
         if (x%blocks(i)%has_right_sides) &
            call add_drives(block%first_row, block%last_row, b%rows, order, s%drive_value, right_side)
      end associate
   end subroutine right_hand_side

#include "equations.inc"
end module block_equations
