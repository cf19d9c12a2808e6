!> The equations of one block in balls, and the numbers and the state of which they are made: the text of equations.inc
!> and of number_types.inc.
#define NUMBER type(ball_t)
#define IS(value) = ball_t(value, 0.0_wp)
#define LIST(list) list(*)
#define AT(list,k) list(k)
#define DRIVES(values) values(0:2, 0:*)
#define DRIVE_AT(values,order,k) values(order, k)
#define ZERO ball_t(0.0_wp, 0.0_wp)
#define ONE ball_t(1.0_wp, 0.0_wp)
#define TWO ball_t(2.0_wp, 0.0_wp)
module ball_equations
   use kinds, only: wp
   use block_matrix, only: entries_of
   use blocks, only: blocks_t, block_t, equation_row_t, block_loop_t, body_vector_t, slide_t, loop_projection, &
      loop_angles
   use balls, only: ball_t, rounding, up, operator(+), operator(-), operator(*)
   implicit none
   private
   public :: vector_t, unknown_t, ball_numbers_t, ball_state_t, new_ball_state, set_ball, set_radius, set_direction
   public :: assemble_balls, ball_accelerations, find_direct, add_rotating

#include "number_types.inc"

   !> As in `geometry_t`.
   type :: ball_numbers_t
      type(row_numbers_t), allocatable :: rows(:)
      type(loop_numbers_t), allocatable :: loops(:)
      type(vector_t), allocatable :: d(:), e(:)
   end type ball_numbers_t

   !> As in `state_t`.
   type :: ball_state_t
      type(unknown_t), allocatable :: u(:)             !< (0:unknowns)
      type(loop_state_t), allocatable :: loop(:)
      type(vector_t), allocatable :: own(:), guide(:)
      type(ball_t), allocatable :: drive(:, :)         !< (0:2, 0:drives)
   end type ball_state_t

contains

   !> Room for the state of `b` with this number of `drives`, all at rest.
   pure function new_ball_state(b, drives) result(s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives
      type(ball_state_t) :: s

      allocate (s%u(0:b%unknowns), s%loop(size(b%loops)), s%own(size(b%body_vectors)), s%guide(size(b%slides)))
      allocate (s%drive(0:2, 0:drives), source=ball_t(0.0_wp, 0.0_wp))
   end function new_ball_state

   !> Gives unknown `u` of `s`, the blocks' `b`, the `value`.
   pure subroutine set_ball(b, u, value, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: u
      type(ball_t), intent(in) :: value
      type(ball_state_t), intent(inout) :: s

      s%u(u)%value = value
      if (u <= b%orientations) call set_direction(s%u(u))
   end subroutine set_ball

   !> Gives it the `radius`, about the same midpoint.
   pure subroutine set_radius(b, u, radius, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: u
      real(wp), intent(in) :: radius
      type(ball_state_t), intent(inout) :: s

      s%u(u)%value%radius = radius
      if (u <= b%orientations) call widen(s%u(u))
   end subroutine set_radius

   !> Cosine and sine of the angle `u`, those of the library taken to be right within two units in the last place.
   pure subroutine set_direction(u)
      type(unknown_t), intent(inout) :: u

      u%c%mid = cos(u%value%mid)
      u%s%mid = sin(u%value%mid)
      call widen(u)
   end subroutine set_direction

   !> Their radii by that of the angle, |cos(m + r) - cos m| <= |sin m| r + |cos m| r^2/2.
   pure subroutine widen(u)
      type(unknown_t), intent(inout) :: u
      real(wp) :: half, c, s

      associate (r => u%value%radius)
         half = 0.5_wp*r**2
         c = abs(u%c%mid)
         s = abs(u%s%mid)
         u%c%radius = (s*r + c*half + 2.0_wp*rounding*(c + r + half))*up
         u%s%radius = (c*r + s*half + 2.0_wp*rounding*(s + r + half))*up
      end associate
   end subroutine widen

   !> Jacobian `a`, stored as the shape of the block says, residual `r` (rows) of block `i` at the state, and the
   !> right-hand side `v` (rows) for the velocities there, with what earlier blocks give.
   pure subroutine assemble_balls(b, x, i, s, a, r, v)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: x
      integer, intent(in) :: i
      type(ball_state_t), intent(inout) :: s
      type(ball_t), intent(inout) :: a(*), r(*), v(*)

      associate (block => b%list(i))
         call find_known(block%first_loop, block%last_loop, b%loops, x%loops, b%body_vectors, x%d, s%u, s%loop)
         call assemble(block, .true., b%loops, x%loops, b%body_vectors, x%d, b%slides, x%e, b%rows, x%rows, s%drive, &
            s%u, s%own, s%guide, s%loop, a, r, v)
      end associate
   end subroutine assemble_balls

   !> The right-hand side `v` (rows) for the accelerations of block `i`, with the vectors of the last `assemble_balls`.
   pure subroutine ball_accelerations(b, i, s, v)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(ball_state_t), intent(in) :: s
      type(ball_t), intent(inout) :: v(*)
      integer :: m

      associate (block => b%list(i))
         do m = block%first_loop, block%last_loop
            call acceleration_rows(b%loops(m), b%body_vectors, b%slides, s%u, s%own, s%guide, s%loop(m), v)
         end do
         call add_drives(block%first_row, block%last_row, b%rows, 2, s%drive, v)
      end associate
   end subroutine ball_accelerations

#include "equations.inc"
end module ball_equations
