!> Tests. The loop equations once more, in real128 and complex numbers, straight from their polygons, on any motion of
!> the unknowns, with derivatives by time as differences; and the equations of each block.
module quad_blocks
   use quad_jet, only: qp
   use matching, only: incidence_t, match, find_blocks
   use loop_equations, only: equations_t, equation_numbers_t, incidence, equation_x, equation_y, equation_projection, &
      equation_angle
   use blocks, only: blocks_t
   implicit none
   private
   public :: equation_value, equation_motion, members

contains

   !> Of each row of the blocks `b` its number in `e`.
   function members(e, b) result(member)
      type(equations_t), intent(in) :: e
      type(blocks_t), intent(in) :: b
      integer, allocatable :: member(:), unknown_of(:), equation_of(:), first(:)
      type(incidence_t) :: g

      g = incidence(e, b%orientations, b%unknowns)
      call match(g, unknown_of, equation_of)
      call find_blocks(g, equation_of, first, member)
   end function members

   !> What equation `i` says with the numbers `x`, less its constant, at the values `u` (0:unknowns).
   complex(qp) function equation_value(e, x, orientations, i, u) result(value)
      type(equations_t), intent(in) :: e
      type(equation_numbers_t), intent(in) :: x
      integer, intent(in) :: orientations, i
      real(qp), intent(in) :: u(0:)

      associate (q => e%list(i))
         select case (q%kind)
         case (equation_x)
            value = real(vector_loop(e, x, orientations, q%vector_loop, u), qp)
         case (equation_y)
            value = aimag(vector_loop(e, x, orientations, q%vector_loop, u))
         case (equation_projection)
            value = real(vector_loop(e, x, orientations, q%vector_loop, u) &
               *conjg(cmplx(x%direction(1, i), x%direction(2, i), qp)*turn(u(q%orientation))), qp)
         case (equation_angle)
            value = u(q%orientation) - u(q%less)
         case default
            value = u(orientations + q%orientation)
         end select
         value = value - x%constant(i)
      end associate
   end function equation_value

   !> Value, first and second derivative of equation `i` with the numbers `x` on the way `u` (0:unknowns, 0:2): value, rate, second rate.
   !> Step 1e-8: h^2 and eps/h^2 are below 1e-16.
   function equation_motion(e, x, orientations, i, u) result(motion)
      type(equations_t), intent(in) :: e
      type(equation_numbers_t), intent(in) :: x
      integer, intent(in) :: orientations, i
      real(qp), intent(in) :: u(0:, 0:)
      real(qp) :: motion(0:2), f(-1:1)
      real(qp), parameter :: h = 1.0e-8_qp
      integer :: k

      do k = -1, 1
         f(k) = real(equation_value(e, x, orientations, i, u(:, 0) + k*h*u(:, 1) + (k*h)**2/2.0_qp*u(:, 2)), qp)
      end do
      motion = [f(0), (f(1) - f(-1))/(2.0_qp*h), (f(1) - 2.0_qp*f(0) + f(-1))/h**2]
   end function equation_motion

   complex(qp) function vector_loop(e, x, orientations, i, u) result(g)
      type(equations_t), intent(in) :: e
      type(equation_numbers_t), intent(in) :: x
      integer, intent(in) :: orientations, i
      real(qp), intent(in) :: u(0:)
      integer :: k

      g = 0.0_qp
      associate (p => e%vector_loops)
         do k = p%first_vector(i), p%first_vector(i + 1) - 1
            if (.not. e%has_vector(k)) cycle
            associate (d => x%sums%body_vector(:, k))
               g = g + cmplx(d(1), d(2), qp)*turn(u(p%vector_orientation(k)))
            end associate
         end do
         do k = p%first_slide(i), p%first_slide(i + 1) - 1
            associate (d => x%sums%slide_body_vector(:, k))
               g = g + u(orientations + p%slide_number(k))*cmplx(d(1), d(2), qp)*turn(u(p%slide_orientation(k)))
            end associate
         end do
      end associate
   end function vector_loop

   complex(qp) function turn(phi)
      real(qp), intent(in) :: phi

      turn = cmplx(cos(phi), sin(phi), qp)
   end function turn
end module quad_blocks
