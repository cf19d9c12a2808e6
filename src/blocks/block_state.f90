!> The motion of all unknowns at one instant, and what earlier blocks give to the polygons of one block.
!>
!> With u_k = R(phi_k) d_k and u_k' its quarter turn, a polygon g = g_0 + sum_k u_k + sum_m s_m R e_m has
!>    dg/dphi_k = u_k',  dg/ds_m = R e_m
!>    g'  = sum phi_k' u_k' + ...
!>    g'' = sum phi_k'' u_k' - phi_k'^2 u_k + ...
!> and a projection on f = R(phi_c) f_0 adds phi_c' g . f' and its derivative, as in `prismatic_pair`.
module block_state
   use kinds, only: wp
   use blocks, only: blocks_t
   implicit none
   private
   public :: unknown_t, state_t, new_state, set_direction, turn_direction, set_values, known_parts, slide_vector, &
      turned, across

   !> An unknown of the equations, an angle or a slide, with its derivatives by time.
   type :: unknown_t
      real(wp) :: value = 0.0_wp, rate = 0.0_wp, acceleration = 0.0_wp
      real(wp) :: c = 1.0_wp, s = 0.0_wp   !< of an angle: cosine and sine of the value
   end type unknown_t

   !> A polygon: its known part with derivatives (2, 0:2), and all of it.
   type :: part_t
      real(wp) :: known(2, 0:2) = 0.0_wp
      real(wp) :: closure_error(2) = 0.0_wp
      real(wp) :: f(2) = 0.0_wp                      !< the direction on which it is projected, if it is
   end type part_t

   type :: state_t
      type(unknown_t), allocatable :: u(:)           !< (0:unknowns); 0 is the ground's frame
      type(part_t), allocatable :: part(:)           !< (instances)
      real(wp), allocatable :: own(:, :)             !< (2, arms) u of the block's own frames
      real(wp), allocatable :: drive_value(:, :)          !< (0:2, 0:drives) what the drives ask for
      real(wp) :: excursion = 0.0_wp                 !< how far they are off the straight way to that, at most
   end type state_t

contains

   !> Room for the state of `b`; `drives`: their number.
   pure function new_state(b, drives) result(s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives
      type(state_t) :: s

      allocate (s%u(0:b%unknowns), s%part(size(b%loops)))
      allocate (s%own(2, size(b%body_vectors)), s%drive_value(0:2, 0:drives), source=0.0_wp)
   end function new_state

   !> Cosine and sine of unknown `u`, if it is an angle.
   pure subroutine set_direction(b, u, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: u
      type(state_t), intent(inout) :: s

      if (u > b%orientations) return
      s%u(u)%c = cos(s%u(u)%value)
      s%u(u)%s = sin(s%u(u)%value)
   end subroutine set_direction

   !> Gives the unknowns of block `i` the values `x`.
   pure subroutine set_values(b, i, x, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:)
      type(state_t), intent(inout) :: s
      integer :: k

      do k = 1, size(x)
         s%u(b%unknown(b%list(i)%first + k - 1))%value = x(k)
         call set_direction(b, b%unknown(b%list(i)%first + k - 1), s)
      end do
   end subroutine set_values

   !> New cosine and sine after a change `d` so small that its square is below rounding.
   pure subroutine turn_direction(b, u, d, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: u
      real(wp), intent(in) :: d
      type(state_t), intent(inout) :: s
      real(wp) :: c

      if (u > b%orientations) return
      c = s%u(u)%c
      s%u(u)%c = c - d*s%u(u)%s
      s%u(u)%s = s%u(u)%s + d*c
   end subroutine turn_direction

   !> What earlier blocks give to the polygons of block `i`: value, velocity, acceleration.
   pure subroutine known_parts(b, i, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      integer :: m, k
      real(wp) :: x, y, square

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => s%part(m)%known)
            g(:, 0) = b%loops(m)%ground
            g(:, 1) = 0.0_wp
            g(:, 2) = 0.0_wp
            do k = b%loops(m)%first_vector, b%loops(m)%first_own - 1
               associate (f => s%u(b%body_vectors(k)%orientation), d => b%body_vectors(k))
                  x = f%c*d%x - f%s*d%y
                  y = f%s*d%x + f%c*d%y
                  square = f%rate*f%rate
                  g(1, 0) = g(1, 0) + x
                  g(2, 0) = g(2, 0) + y
                  g(1, 1) = g(1, 1) - f%rate*y
                  g(2, 1) = g(2, 1) + f%rate*x
                  g(1, 2) = g(1, 2) - f%acceleration*y - square*x
                  g(2, 2) = g(2, 2) + f%acceleration*x - square*y
               end associate
            end do
         end associate
      end do
   end subroutine known_parts

   !> R(frame) e of slide number `k`.
   pure function slide_vector(b, k, s) result(e)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: k
      type(state_t), intent(in) :: s
      real(wp) :: e(2)

      e = turned(s, b%slides(k)%orientation, b%slides(k)%body_vector)
   end function slide_vector

   !> `v` turned by the angle of `orientation`.
   pure function turned(s, orientation, v) result(w)
      type(state_t), intent(in) :: s
      integer, intent(in) :: orientation
      real(wp), intent(in) :: v(2)
      real(wp) :: w(2)

      associate (f => s%u(orientation))
         w = [f%c*v(1) - f%s*v(2), f%s*v(1) + f%c*v(2)]
      end associate
   end function turned

   !> g . f', with f' the quarter turn of f.
   pure real(wp) function across(g, f)
      real(wp), intent(in) :: g(2), f(2)

      across = g(2)*f(1) - g(1)*f(2)
   end function across
end module block_state
