!> The equations of one block in balls, and the geometry and the state of which they are made: the text of equations.inc
!> and of number_types.inc, compiled for balls.
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
   use blocks, only: blocks_t, block_t, equation_row_t, block_loop_t, body_vector_t, slide_t, loop_projection, &
      loop_angles
   use balls, only: ball_t, rounding, up, operator(+), operator(-), operator(*)
   implicit none
   private
   public :: vector_t, unknown_t, link_numbers_t, ball_numbers_t, ball_state_t, new_ball_state, set_ball
   public :: set_radius, set_direction, assemble_balls, ball_accelerations, find_direct, add_rotating

#include "number_types.inc"

   !> The geometry in balls; units are those of `geometry_t`.
   type :: ball_numbers_t
      type(row_numbers_t), allocatable :: rows(:)      !< (rows)
      type(loop_numbers_t), allocatable :: loops(:)    !< (loops)
      type(link_numbers_t), allocatable :: links(:)    !< (wanted links) in the order of the chain
      type(vector_t), allocatable :: d(:), e(:)        !< (body vectors), (slides) in the axes of their orientations
   end type ball_numbers_t

   !> The state in balls; units are those of `state_t`.
   type :: ball_state_t
      type(unknown_t), allocatable :: u(:)             !< (0:unknowns)
      type(loop_state_t), allocatable :: loop(:)       !< (loops)
      type(vector_t), allocatable :: own(:), guide(:)  !< (body vectors), (slides) rotated
      type(ball_t), allocatable :: drive(:, :)         !< (0:2, 0:drives) value, rate, acceleration of each drive
   end type ball_state_t

contains

   !> Makes a state in balls: all unknowns and drives are 0 and rest.
   pure function new_ball_state(b, drives) result(s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives          !< how many drives there are
      type(ball_state_t) :: s

      allocate (s%u(0:b%unknowns), s%loop(size(b%loops)), s%own(size(b%body_vectors)), s%guide(size(b%slides)))
      allocate (s%drive(0:2, 0:drives), source=ball_t(0.0_wp, 0.0_wp))
   end function new_ball_state

   !> Gives an unknown a value in a ball, and cosine and sine if it is an angle. Rates stay.
   pure subroutine set_ball(b, unknown, value, balls)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: unknown         !< the number of the unknown
      type(ball_t), intent(in) :: value      !< rad or unit of the block
      type(ball_state_t), intent(inout) :: balls   !< the state

      balls%u(unknown)%value = value
      if (unknown <= b%orientations) call set_direction(balls%u(unknown))
   end subroutine set_ball

   !> Gives the value of an unknown a radius about its midpoint, and cosine and sine the radii that follow.
   pure subroutine set_radius(b, unknown, radius, balls)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: unknown         !< the number of the unknown
      real(wp), intent(in) :: radius         !< rad or unit of the block
      type(ball_state_t), intent(inout) :: balls   !< the state

      balls%u(unknown)%value%radius = radius
      if (unknown <= b%orientations) call widen(balls%u(unknown))
   end subroutine set_radius

   !> Computes cosine and sine of an angle in balls. Results of the library are taken to be right within two units in
   !> the last place.
   pure subroutine set_direction(unknown)
      type(unknown_t), intent(inout) :: unknown   !< an angle with its value

      unknown%c%mid = cos(unknown%value%mid)
      unknown%s%mid = sin(unknown%value%mid)
      call widen(unknown)
   end subroutine set_direction

   !> Computes the radii of cosine and sine of an angle from its midpoint m and radius r:
   !> |cos(m + r) - cos m| <= |sin m| r + |cos m| r^2/2, and likewise for the sine.
   pure subroutine widen(unknown)
      type(unknown_t), intent(inout) :: unknown   !< an angle with the midpoints of cosine and sine
      real(wp) :: half, c, s

      associate (r => unknown%value%radius)
         half = 0.5_wp*r**2
         c = abs(unknown%c%mid)
         s = abs(unknown%s%mid)
         unknown%c%radius = (s*r + c*half + 2.0_wp*rounding*(c + r + half))*up
         unknown%s%radius = (c*r + s*half + 2.0_wp*rounding*(s + r + half))*up
      end associate
   end subroutine widen

   !> Assembles Jacobian, residuals and the right-hand side for the velocities of a block at a state, with the motion of
   !> earlier blocks.
   pure subroutine assemble_balls(b, numbers, i, balls, jacobian, residuals, right_side)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: numbers   !< of the mechanism
      integer, intent(in) :: i               !< number of the block
      type(ball_state_t), intent(inout) :: balls   !< the state; given parts and rotated vectors of the block are set
      type(ball_t), intent(inout) :: jacobian(*)   !< (entries) stored by the shape of the block
      type(ball_t), intent(inout) :: residuals(*), right_side(*)   !< (rows) unit of the loop or rad; by time

      associate (block => b%list(i))
         call find_known(block%first_loop, block%last_loop, b%loops, numbers%loops, b%body_vectors, numbers%d, &
            balls%u, balls%loop)
         call assemble(block, .true., b%loops, numbers%loops, b%body_vectors, numbers%d, b%slides, numbers%e, b%rows, &
            numbers%rows, balls%drive, balls%u, balls%own, balls%guide, balls%loop, jacobian, residuals, right_side)
      end associate
   end subroutine assemble_balls

   !> Computes the right-hand side for the accelerations of a block from its velocities.
   pure subroutine ball_accelerations(b, i, balls, right_side)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i               !< number of the block
      type(ball_state_t), intent(in) :: balls   !< the state, with the rotated vectors of the last `assemble_balls`
      type(ball_t), intent(inout) :: right_side(*)   !< (rows) unit of the loop or rad, by time squared
      integer :: m

      associate (block => b%list(i))
         do m = block%first_loop, block%last_loop
            call acceleration_rows(b%loops(m), b%body_vectors, b%slides, balls%u, balls%own, balls%guide, &
               balls%loop(m), right_side)
         end do
         call add_drives(block%first_row, block%last_row, b%rows, 2, balls%drive, right_side)
      end associate
   end subroutine ball_accelerations

#include "equations.inc"
end module ball_equations
