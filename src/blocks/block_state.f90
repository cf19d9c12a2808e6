!> The motion of all unknowns at one instant, and what earlier blocks give to the vector loops of a block.
!>
!> With u_k = R(phi_k) d_k and u_k' its quarter turn, a loop has the closure error
!>    g = g_0 + sum_k u_k + sum_m s_m R e_m,      dg/dphi_k = u_k',  dg/ds_m = R e_m
!>    g'  = sum phi_k' u_k' + ...
!>    g'' = sum phi_k'' u_k' - phi_k'^2 u_k + ...
!> and a projection on f = R(phi_c) f_0 adds phi_c' g . f' and its derivative, as in `prismatic_pair`.
module block_state
   use kinds, only: wp
   use planar, only: vector_t, add_rotating, quarter_turn
   use blocks, only: blocks_t, block_loop_t, body_vector_t, slide_t, loop_numbers_t
   implicit none
   private
   public :: unknown_t, loop_state_t, state_t, new_state, set_direction, find_direction, rotate_direction, set_values, &
      set_rates, set_accelerations, values_of, largest_drive_rate, find_known_parts, slide_velocity, slide_acceleration

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

      if (u <= b%orientations) call find_direction(s%u(u))
   end subroutine set_direction

   !> Cosine and sine of the angle `f`.
   pure subroutine find_direction(f)
      type(unknown_t), intent(inout) :: f

      f%c = cos(f%value)
      f%s = sin(f%value)
   end subroutine find_direction

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

      associate (block => b%list(i))
         call find_known(block%first_loop, block%last_loop, b%loops, b%numbers%loops, b%body_vectors, b%numbers%d, &
            s%u, s%loop)
      end associate
   end subroutine find_known_parts

   !> The same of the loops number `first` to `last` with the `numbers` and the body vectors `d_of`; on plain arrays,
   !> which cost no descriptors.
   pure subroutine find_known(first, last, loops, numbers, vectors, d_of, u, now)
      integer, intent(in) :: first, last
      type(block_loop_t), intent(in) :: loops(*)
      type(loop_numbers_t), intent(in) :: numbers(*)
      type(body_vector_t), intent(in) :: vectors(*)
      type(vector_t), intent(in) :: d_of(*)
      type(unknown_t), intent(in) :: u(0:*)
      type(loop_state_t), intent(inout) :: now(*)
      real(wp) :: x(2), x_t(2), x_tt(2)
      integer :: m, k

      do m = first, last
         x(1) = numbers(m)%ground%x
         x(2) = numbers(m)%ground%y
         x_t = 0.0_wp
         x_tt = 0.0_wp
         do k = loops(m)%first_vector, loops(m)%first_own - 1
            associate (f => u(vectors(k)%orientation), d => d_of(k))
               call add_rotating(f%c*d%x - f%s*d%y, f%s*d%x + f%c*d%y, f%rate, f%acceleration, x, x_t, x_tt)
            end associate
         end do
         now(m)%known(:, 0) = x
         now(m)%known(:, 1) = x_t
         now(m)%known(:, 2) = x_tt
      end do
   end subroutine find_known

   !> The part of the `slide` along the guide `e` in g':  (s e)' = s' e + s w e'.
   pure function slide_velocity(slide, unknowns, e) result(g)
      type(slide_t), intent(in) :: slide
      type(unknown_t), intent(in) :: unknowns(0:*)
      real(wp), intent(in) :: e(2)
      real(wp) :: g(2)

      associate (u => unknowns(slide%unknown), f => unknowns(slide%orientation))
         g = 0.0_wp
         if (slide%column == 0) g = g + u%rate*e
         if (slide%orientation_column == 0) g = g + u%value*f%rate*quarter_turn(e)
      end associate
   end function slide_velocity

   !> The same in g'':  (s e)'' = s'' e + 2 s' w e' + s (w' e' - w^2 e).
   pure function slide_acceleration(slide, unknowns, e) result(g)
      type(slide_t), intent(in) :: slide
      type(unknown_t), intent(in) :: unknowns(0:*)
      real(wp), intent(in) :: e(2)
      real(wp) :: g(2), e_t(2)

      associate (u => unknowns(slide%unknown), f => unknowns(slide%orientation))
         e_t = quarter_turn(e)
         g = 2.0_wp*u%rate*f%rate*e_t - u%value*f%rate**2*e
         if (slide%column == 0) g = g + u%acceleration*e
         if (slide%orientation_column == 0) g = g + u%value*f%acceleration*e_t
      end associate
   end function slide_acceleration
end module block_state
