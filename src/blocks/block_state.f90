!> The motion of all unknowns at one instant, and what earlier blocks give to the vector loops of a block.
!>
!> With u_k = R(phi_k) d_k and u_k' its quarter turn, a loop has the closure error
!>    g = g_0 + sum_k u_k + sum_m s_m R e_m,      dg/dphi_k = u_k',  dg/ds_m = R e_m
!>    g'  = sum phi_k' u_k' + ...
!>    g'' = sum phi_k'' u_k' - phi_k'^2 u_k + ...
!> and a projection on f = R(phi_c) f_0 adds phi_c' g . f' and its derivative, as in `prismatic_pair`.
module block_state
   use kinds, only: wp
   use planar, only: add_rotating
   use blocks, only: blocks_t, block_loop_t, body_vector_t
   implicit none
   private
   public :: unknown_t, loop_state_t, state_t, new_state, set_direction, rotate_direction, set_values, set_rates, &
      set_accelerations, values_of, largest_drive_rate, find_known_parts

   !> An unknown, an angle in radians or a slide in its block's unit of length, with its derivatives by time.
   type :: unknown_t
      real(wp) :: value = 0.0_wp, rate = 0.0_wp, acceleration = 0.0_wp
      real(wp) :: c = 1.0_wp, s = 0.0_wp             !< of an angle: cosine and sine of the value
   end type unknown_t

   !> A vector loop in its block, lengths in the loop's unit.
   type :: loop_state_t
      real(wp) :: known(2, 0:2) = 0.0_wp             !< the part that earlier blocks give, and its derivatives
      real(wp) :: closure_error(2) = 0.0_wp          !< x and y
      real(wp) :: f(2) = 0.0_wp                      !< the direction on which it is projected, if it is
   end type loop_state_t

   !> Values alone: no factors, no scratch.
   type :: state_t
      type(unknown_t), allocatable :: u(:)           !< (0:unknowns); 0 is the ground's angle
      type(loop_state_t), allocatable :: loop(:)     !< (loops)
      real(wp), allocatable :: own(:, :)             !< (2, body vectors) R d, where the block's own angles rotate it
      real(wp), allocatable :: guide(:, :)           !< (2, slides) R e, their directions
      real(wp), allocatable :: drive_value(:, :)     !< (0:2, 0:drives) value, rate and acceleration of each drive
      real(wp) :: excursion = 0.0_wp                 !< of the drives from their straight lines in a substep, at most
   end type state_t

contains

   !> Room for the state of `b` with this number of `drives`.
   pure function new_state(b, drives) result(s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives
      type(state_t) :: s

      allocate (s%u(0:b%unknowns), s%loop(size(b%loops)))
      allocate (s%own(2, size(b%body_vectors)), s%guide(2, size(b%slides)), source=0.0_wp)
      allocate (s%drive_value(0:2, 0:drives), source=0.0_wp)
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

   !> Cosine and sine of unknown `u` after a change `d` (rad) so small that its square is below rounding.
   pure subroutine rotate_direction(b, u, d, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: u
      real(wp), intent(in) :: d
      type(state_t), intent(inout) :: s
      real(wp) :: c

      if (u > b%orientations) return
      c = s%u(u)%c
      s%u(u)%c = c - d*s%u(u)%s
      s%u(u)%s = s%u(u)%s + d*c
   end subroutine rotate_direction

   !> Gives the unknowns of block `i` the values `x` (n).
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

   !> Gives the unknowns with the numbers `unknown`(first:last) among `u` the rates `v`.
   pure subroutine set_rates(first, last, unknown, v, u)
      integer, intent(in) :: first, last, unknown(*)
      real(wp), intent(in) :: v(*)
      type(unknown_t), intent(inout) :: u(0:*)
      integer :: k

      do k = first, last
         u(unknown(k))%rate = v(k - first + 1)
      end do
   end subroutine set_rates

   !> The same of accelerations.
   pure subroutine set_accelerations(first, last, unknown, a, u)
      integer, intent(in) :: first, last, unknown(*)
      real(wp), intent(in) :: a(*)
      type(unknown_t), intent(inout) :: u(0:*)
      integer :: k

      do k = first, last
         u(unknown(k))%acceleration = a(k - first + 1)
      end do
   end subroutine set_accelerations

   !> (n) The values of the unknowns of block `i`.
   pure function values_of(b, i, s) result(x)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      real(wp) :: x(b%list(i)%last - b%list(i)%first + 1)

      x = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
   end function values_of

   !> The largest rate of a drive, in radians or its block's unit of length by time; 0 without drives.
   pure real(wp) function largest_drive_rate(s) result(rate)
      type(state_t), intent(in) :: s

      rate = maxval(abs(s%drive_value(1, :)))
   end function largest_drive_rate

   !> What earlier blocks give to the loops of block `i`: place, velocity, acceleration.
   pure subroutine find_known_parts(b, i, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      integer :: m

      associate (block => b%list(i))
         do m = block%first_loop, block%last_loop
            call find_known_part(b%loops(m), b%body_vectors, s%u, s%loop(m)%known)
         end do
      end associate
   end subroutine find_known_parts

   !> The same of loop `g`; on plain arrays, which cost no descriptors.
   pure subroutine find_known_part(g, vectors, u, known)
      type(block_loop_t), intent(in) :: g
      type(body_vector_t), intent(in) :: vectors(*)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(out) :: known(2, 0:2)
      real(wp) :: x(2), x_t(2), x_tt(2)
      integer :: k

      x = g%ground
      x_t = 0.0_wp
      x_tt = 0.0_wp
      do k = g%first_vector, g%first_own - 1
         associate (f => u(vectors(k)%orientation), d => vectors(k))
            call add_rotating(f%c*d%x - f%s*d%y, f%s*d%x + f%c*d%y, f%rate, f%acceleration, x, x_t, x_tt)
         end associate
      end do
      known(:, 0) = x
      known(:, 1) = x_t
      known(:, 2) = x_tt
   end subroutine find_known_part
end module block_state
