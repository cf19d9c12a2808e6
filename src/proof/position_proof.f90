!> Proof of a position at one instant: that near the values found for the unknowns of a block there is exactly one
!> solution of its exact equations, and how far from these values it is at most; the same for rates and accelerations.
!> Blocks are proved in solving order: what earlier ones leave open counts in later ones.
!>
!> With F(x*) = 0 and |1 - A J| <= k in a ball about x that holds x*, |x - x*| <= |A| |F(x)|/(1 - k). The rates v solve
!> J(x*) v* = b(x*), so |v - v*| <= |A| |J(x*) v - b(x*)|/(1 - k); accelerations likewise. F, J and b are what the
!> equations are in balls: of the numbers, of what earlier blocks give, and of x.
!>
!> Where equations are too many, as many independent ones as there are unknowns are proved, and of the others it is
!> bounded by how much they stay open.
module position_proof
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use drives, only: bounds_t, bounds_of
   use blocks, only: blocks_t
   use block_matrix, only: entries_of
   use block_state, only: state_t, new_state
   use block_engine, only: block_engine_t
   use balls, only: ball_t, rounding, room, top, distance, operator(+), operator(-), operator(*)
   use ball_equations, only: ball_numbers_t, ball_state_t, unknown_t, new_ball_state, set_ball, set_radius, &
      assemble_balls, ball_accelerations
   use ball_numbers, only: new_ball_numbers, table_errors
   use contraction, only: bound_inverse, apply, radius_of, max_rate
   implicit none
   private
   public :: prover_t, placed_t, make_prover, new_placed, take_state, prove_position, prove_block, contract, &
      find_ball, subtract_product

   !> Times, too, are numbers of the deck.
   real(wp), parameter, public :: of_time = 4.0_wp*rounding
   !> A block of more unknowns is not proved: all n^2 entries of its inverse take a tenth of a second for each part of a
   !> step, of which there may be a thousand.
   integer, parameter, public :: max_unknowns = 500
   !> So many balls are tried at most. Each is larger by what the one before has shown of the change of the Jacobian.
   integer, parameter :: max_tries = 8

   !> What the proof of a block computes; nothing is allocated of a direct block, or one that is too wide.
   type :: block_work_t
      integer, allocatable :: row(:), column(:)   !< (entries) of its Jacobian
      type(ball_t), allocatable :: j(:)           !< (entries) the Jacobian
      type(ball_t), allocatable :: r(:), v(:)     !< (rows) residual, right-hand side for the derivatives
      real(wp), allocatable :: a(:, :)            !< (rows, n) midpoints of the Jacobian
      real(wp), allocatable :: inverse(:, :)      !< (n, rows) |A|
      !> (n) Row sums of |1 - A J|: of the midpoints, at the centre of the ball, and in all of it.
      real(wp), allocatable, dimension(:) :: of_midpoints, at_centre, off
      real(wp), allocatable :: open(:)            !< (rows) bounds of the equations at the centre
      real(wp), allocatable :: x(:)               !< (n) |A| times these
   end type block_work_t

   !> What the proofs of a mechanism need.
   type :: prover_t
      type(ball_numbers_t) :: numbers
      type(state_t) :: state                      !< the values of the proof at hand
      type(ball_state_t) :: balls                 !< the exact ones lie in them
      type(ball_state_t) :: curve                 !< the curves of a step, see `tube_proof`
      type(block_work_t), allocatable :: work(:)  !< (blocks)
      real(wp), allocatable :: table_error(:, :)  !< (0:2, drives) of the splines of their tables, in block units
   end type prover_t

   !> A position, and what is proved of it, in the units of the blocks.
   type :: placed_t
      real(wp) :: t = 0.0_wp                      !< time
      real(wp), allocatable :: x(:, :)            !< (0:2, 0:unknowns) values, rates, accelerations
      real(wp), allocatable :: error(:, :)        !< (0:2, 0:unknowns) the exact ones differ by no more
      real(wp), allocatable :: drive(:, :)        !< (0:2, 0:drives) the drives' values, rates and accelerations
      real(wp), allocatable :: drive_error(:, :)  !< (0:2, 0:drives) those of their exact laws differ by no more
      real(wp), allocatable :: open(:, :)         !< (0:1, rows) |F| and |dF/dt| at these values of all unknowns
      real(wp), allocatable :: gap(:)             !< (blocks) by how much redundant equations stay open at most
      logical, allocatable :: is_proved(:)        !< (blocks)
   end type placed_t

contains

   !> Ready for proofs about `m`, with the blocks, laws and units of its engine `e`.
   subroutine make_prover(p, m, e)
      type(prover_t), intent(out) :: p
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer :: i

      p%numbers = new_ball_numbers(m, e%blocks, e%length)
      p%state = new_state(e%blocks, size(m%drives))
      p%balls = new_ball_state(e%blocks, size(m%drives))
      p%curve = p%balls
      allocate (p%table_error(0:2, size(m%drives)))
      do i = 1, size(m%drives)
         p%table_error(:, i) = table_errors(e%laws(i))*e%unit_of(i)
      end do
      allocate (p%work(size(e%blocks%list)))
      do i = 1, size(e%blocks%list)
         if (.not. e%blocks%list(i)%direct .and. e%blocks%list(i)%shape%n <= max_unknowns) &
            call make_work(e%blocks, i, p%work(i))
      end do
   end subroutine make_prover

   !> Room for the proof of block `i`, and where the entries of its Jacobian stand.
   subroutine make_work(b, i, w)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(block_work_t), intent(out) :: w
      integer :: k

      associate (shape => b%list(i)%shape)
         associate (rows => shape%rows, n => shape%n, entries => entries_of(shape))
            allocate (w%row(entries), w%column(entries), w%j(entries), w%r(rows), w%v(rows), w%open(rows), &
               w%a(rows, n), w%inverse(n, rows), w%of_midpoints(n), w%at_centre(n), w%off(n), w%x(n))
            w%a = 0.0_wp
            if (shape%pattern == 0) then
               w%row(:) = [(1 + modulo(k - 1, rows), k=1, entries)]
               w%column(:) = [(1 + (k - 1)/rows, k=1, entries)]
            else
               w%row(:) = b%patterns(shape%pattern)%row + 1
               do k = 1, n
                  w%column(b%patterns(shape%pattern)%first(k) + 1:b%patterns(shape%pattern)%first(k + 1)) = k
               end do
            end if
         end associate
      end associate
   end subroutine make_work

   !> Room for a position of the blocks `b` with so many `drives`.
   pure function new_placed(b, drives) result(q)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives
      type(placed_t) :: q

      allocate (q%x(0:2, 0:b%unknowns), q%error(0:2, 0:b%unknowns), q%drive(0:2, 0:drives), &
         q%drive_error(0:2, 0:drives), q%open(0:1, size(b%rows)), q%gap(size(b%list)), source=0.0_wp)
      allocate (q%is_proved(size(b%list)), source=.false.)
   end function new_placed

   !> Proves position, velocity and acceleration of the blocks `list`, in solving order, at the time `t` and the values
   !> that the engine `e` has found. `is_proved`: of all of them; the first that is not ends the proof. `order`: up to
   !> this derivative alone, 0 or 2.
   subroutine prove_position(p, e, t, list, q, is_proved, order)
      type(prover_t), intent(inout) :: p
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: t
      integer, intent(in) :: list(:)
      type(placed_t), intent(inout) :: q
      logical, intent(out) :: is_proved
      integer, intent(in), optional :: order
      integer :: k, highest

      highest = 2
      if (present(order)) highest = order
      ! As sections: assignments to the whole would ask for shapes first.
      p%state%u(:) = e%state%u(:)
      p%state%drive_value(:, :) = e%state%drive_value(:, :)
      call take_state(p, e, t, q)
      is_proved = .true.
      do k = 1, size(list)
         call prove_block(p, e%blocks, list(k), highest, q)
         is_proved = q%is_proved(list(k))
         if (.not. is_proved) return
      end do
   end subroutine prove_position

   !> Takes the values of p%state as the position `q` at the time `t`, nothing of it proved; bounds of the drives by
   !> their laws.
   subroutine take_state(p, e, t, q)
      type(prover_t), intent(inout) :: p
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: t
      type(placed_t), intent(inout) :: q
      type(bounds_t) :: law
      integer :: u, i

      q%t = t
      q%is_proved = .false.
      ! Nothing depends on unknowns of later blocks, but some cancel: they are exact, whatever their values.
      p%balls%u(:) = unknown_t()
      do u = 0, e%blocks%unknowns
         q%x(:, u) = [p%state%u(u)%value, p%state%u(u)%rate, p%state%u(u)%acceleration]
      end do
      do i = 1, size(e%laws)
         q%drive(:, i) = p%state%drive_value(:, i)
         law = bounds_of(e%laws(i), t - of_time*abs(t), t + of_time*abs(t), one_instant=.true.)
         q%drive_error(:, i) = (max(law%high*e%unit_of(i) - q%drive(:, i), q%drive(:, i) - law%low*e%unit_of(i)) &
            + 4.0_wp*rounding*abs(q%drive(:, i)) + p%table_error(:, i))*room
         p%balls%drive(:, i)%mid = q%drive(:, i)
         p%balls%drive(:, i)%radius = q%drive_error(:, i)
      end do
   end subroutine take_state

   !> Proves block `i` at the values of `q`, whose earlier blocks are proved: the values of its unknowns and, with
   !> `order` 2 instead of 0, their derivatives. Result: what `q` has of this block, `open` whatever the order; and the
   !> balls of p%balls.
   subroutine prove_block(p, b, i, order, q)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(placed_t), intent(inout) :: q
      real(wp) :: radius
      integer :: k

      associate (block => b%list(i), w => p%work(i), own => b%unknown(b%list(i)%first:b%list(i)%last))
         q%gap(i) = 0.0_wp
         q%error(:, own) = 0.0_wp
         q%is_proved(i) = block%direct .or. allocated(w%a)
         if (.not. q%is_proved(i)) return
         do k = 1, size(own)
            call set_ball(b, own(k), ball_t(q%x(0, own(k)), 0.0_wp), p%balls)
            p%balls%u(own(k))%rate = ball_t(q%x(1, own(k)), 0.0_wp)
            p%balls%u(own(k))%acceleration = ball_t(q%x(2, own(k)), 0.0_wp)
         end do
         if (block%direct) then
            call prove_direct(own(1), block%first_row)
            return
         end if

         call contract(b, p%numbers, i, p%balls, w, q%is_proved(i))
         if (.not. q%is_proved(i)) return
         w%open(:) = top(w%r)
         call subtract_product(1, p%balls%u(:), own, w)
         q%open(0, block%first_row:block%last_row) = w%open
         q%open(1, block%first_row:block%last_row) = top(w%v)
         call find_ball(b, p%numbers, i, p%balls, w, radius)
         q%is_proved(i) = radius >= 0.0_wp
         if (.not. q%is_proved(i)) return
         if (size(w%r) > size(own)) q%gap(i) = maxval(top(w%r))
         do k = 1, size(own)
            q%error(0, own(k)) = min(radius, (w%x(k) + 0.5_wp*(w%at_centre(k) + w%off(k))*radius)*room)
            call set_radius(b, own(k), q%error(0, own(k)), p%balls)
         end do

         if (order == 0) return
         call bound_derivatives(1, own, w)
         p%balls%u(own)%rate%radius = q%error(1, own)
         call ball_accelerations(b, i, p%balls, w%v)
         call bound_derivatives(2, own, w)
         p%balls%u(own)%acceleration%radius = q%error(2, own)
         q%is_proved(i) = all(q%error(:, own) <= huge(1.0_wp))
      end associate

   contains

      !> Unknown `u` of a direct block with the row `row` is another one and a drive.
      subroutine prove_direct(u, row)
         integer, intent(in) :: u, row
         type(ball_t) :: x(0:2)

         associate (other => p%balls%u(b%rows(row)%other), drive => b%rows(row)%drive, &
            sign_of => ball_t(real(b%rows(row)%sign_of, wp), 0.0_wp))
            x = sign_of*p%balls%drive(:, drive)
            x(0) = other%value + (sign_of*p%numbers%rows(row)%constant + x(0))
            x(1) = other%rate + x(1)
            x(2) = other%acceleration + x(2)
         end associate
         q%error(:, u) = distance(x, q%x(:, u))
         q%open(:, row) = q%error(:1, u)
         call set_radius(b, u, q%error(0, u), p%balls)
         p%balls%u(u)%rate%radius = q%error(1, u)
         p%balls%u(u)%acceleration%radius = q%error(2, u)
      end subroutine prove_direct

      !> Bounds of the errors of the derivatives of one `order` of the unknowns `own` of block `i`, whose right-hand
      !> side is w%v.
      subroutine bound_derivatives(order, own, w)
         integer, intent(in) :: order, own(:)
         type(block_work_t), intent(inout) :: w
         real(wp) :: largest
         integer :: k

         call subtract_product(order, p%balls%u(:), own, w)
         w%open(:) = top(w%v)
         call apply(size(w%r), size(own), w%inverse, w%open, w%x)
         largest = maxval(w%x)/(1.0_wp - maxval(w%off))*room
         do k = 1, size(own)
            q%error(order, own(k)) = (w%x(k) + w%off(k)*largest)*room
         end do
      end subroutine bound_derivatives
   end subroutine prove_block

   !> Equations and Jacobian of block `i`, with the numbers `x`, at the state `s`, whose own unknowns are at the centre
   !> of a ball, and about its inverse: all in `w`. `exists`: there is an inverse.
   subroutine contract(b, x, i, s, w, exists)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: x
      integer, intent(in) :: i
      type(ball_state_t), intent(inout) :: s
      type(block_work_t), intent(inout) :: w
      logical, intent(out) :: exists
      integer :: k

      call assemble_balls(b, x, i, s, w%j, w%r, w%v)
      do k = 1, size(w%j)
         w%a(w%row(k), w%column(k)) = w%j(k)%mid
      end do
      call bound_inverse(size(w%r), size(w%x), w%a, w%inverse, w%of_midpoints, exists)
      if (exists) call find_off(w, w%at_centre)
   end subroutine contract

   !> `off` (n): the row sums of |1 - A J| of the Jacobian J at hand.
   pure subroutine find_off(w, off)
      type(block_work_t), intent(in) :: w
      real(wp), intent(out) :: off(:)
      real(wp) :: wide(size(w%r))
      integer :: k

      wide = 0.0_wp
      do k = 1, size(w%j)
         wide(w%row(k)) = wide(w%row(k)) + w%j(k)%radius
      end do
      call apply(size(wide), size(off), w%inverse, wide, off)
      off = (w%of_midpoints + off)*(1.0_wp + (16 + size(w%x))*rounding)
   end subroutine find_off

   !> Finds the `radius` of a ball in which block `i`, with the numbers `x`, has exactly one solution: about the own
   !> unknowns of the state `s`, where it was contracted and its equations are no larger than w%open. -1: none is
   !> proved. These unknowns, and the equations in `w`, are then those in a ball that is no smaller. `others`: earlier
   !> blocks are off by so much at most; w%v is then how much they change the equations.
   subroutine find_ball(b, x, i, s, w, radius, others)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: x
      integer, intent(in) :: i
      type(ball_state_t), intent(inout) :: s
      type(block_work_t), intent(inout) :: w
      real(wp), intent(out) :: radius
      real(wp), intent(in), optional :: others
      real(wp) :: eta, z1, z2, rate, centre(size(w%x))
      integer :: tries, k

      radius = -1.0_wp
      call apply(size(w%r), size(w%x), w%inverse, w%open, w%x)
      ! What is not a number lies in no ball.
      if (.not. (all(w%x <= 1.0_wp) .and. all(w%at_centre <= max_rate))) return
      eta = max(0.0_wp, maxval(w%x))
      if (present(others)) eta = eta + others
      z1 = max(0.0_wp, maxval(w%at_centre))
      z2 = 0.0_wp
      do k = 1, size(w%x)
         centre(k) = s%u(b%unknown(b%list(i)%first + k - 1))%value%radius
      end do
      do tries = 1, max_tries
         radius = radius_of(z1, z2, eta)
         if (radius < 0.0_wp) return
         do k = 1, size(w%x)
            call set_radius(b, b%unknown(b%list(i)%first + k - 1), (centre(k) + radius)*room, s)
         end do
         call assemble_balls(b, x, i, s, w%j, w%r, w%v)
         call find_off(w, w%off)
         if (.not. all(w%off <= max_rate)) exit
         rate = max(0.0_wp, maxval(w%off))
         if (present(others)) then
            call apply(size(w%r), size(w%x), w%inverse, (w%open + top(w%v))*room, w%x)
            if (.not. all(w%x <= 1.0_wp)) exit
            eta = max(0.0_wp, maxval(w%x))
         end if
         ! Radii grow as polynomials without a negative coefficient: halfway the rate is no more than the mean.
         if ((eta + 0.5_wp*(z1 + rate)*radius)*room <= radius) then
            radius = min(radius, radius_of(rate, 0.0_wp, eta))
            return
         end if
         z2 = max(0.0_wp, rate - z1)/radius
      end do
      radius = -1.0_wp
   end subroutine find_ball

   !> Subtracts from w%v the Jacobian times derivative number `order` (1 or 2) of the block's `own` unknowns among `u`.
   pure subroutine subtract_product(order, u, own, w)
      integer, intent(in) :: order, own(:)
      type(unknown_t), intent(in) :: u(0:)
      type(block_work_t), intent(inout) :: w
      type(ball_t) :: x
      integer :: k

      do k = 1, size(w%j)
         if (order == 1) x = u(own(w%column(k)))%rate
         if (order == 2) x = u(own(w%column(k)))%acceleration
         w%v(w%row(k)) = w%v(w%row(k)) - w%j(k)*x
      end do
   end subroutine subtract_product
end module position_proof
