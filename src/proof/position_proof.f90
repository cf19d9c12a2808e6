!> Proof of a position at one instant: that near the values found for the unknowns of a block there is exactly one
!> solution of its exact equations, and how far from these values it is at most; the same for rates and accelerations.
!> Blocks are proved in solving order: what earlier ones leave open counts in later ones.
!>
!> With F(x*) = 0 and |1 - A J| <= k in a ball about x that holds x*, |x - x*| <= |A| |F(x)|/(1 - k). The rates v solve
!> J(x*) v* = b(x*), so |v - v*| <= |A| |J(x*) v - b(x*)|/(1 - k); accelerations likewise. F, J and b are what the
!> equations are in balls: of the numbers, of what earlier blocks give, and of x.
!>
!> The ball is found by Newton and Kantorovich's argument: x - A F(x) maps the ball of radius r about c into itself and
!> contracts it, if
!>
!>    |A| |F(c)| + z1 r + z2 r^2/2 <= r,   z1 >= |1 - A J(c)|,   z1 + z2 s >= |1 - A J| in the ball of radius s <= r
!>
!> So F has exactly one zero in the ball, J is regular in all of it, and z1 + z2 r < 1. (Ortega and Rheinboldt, ch. 12;
!> the form with bounds from data is that of Day, Lessard and Mischaikow's radii polynomials.)
!>
!> Where equations are too many, A is an inverse by least squares: as many sums of equations as there are unknowns are
!> proved, and of all equations it is bounded by how much they stay open.
module position_proof
   use kinds, only: wp
   use drives, only: bounds_t, bounds_of
   use blocks, only: blocks_t, own_unknowns
   use block_matrix, only: shape_t, entries_of, solve_first, solve_again, work_length
   use block_state, only: state_t
   use drive_path, only: drive_path_t
   use balls, only: ball_t, rounding, room, top, distance, operator(+), operator(-), operator(*)
   use ball_equations, only: ball_numbers_t, ball_state_t, unknown_t, new_ball_state, set_ball, set_radius, &
      assemble_balls, ball_accelerations, find_direct
   implicit none
   private
   public :: placed_t, block_work_t, new_placed, prove_position, contract, find_ball, subtract_product

   !> Times, too, are numbers of the deck.
   real(wp), parameter, public :: of_time = 4.0_wp*rounding
   !> A block of more unknowns is not proved: its inverse takes n^3 products for each part of a step, of which there may
   !> be a thousand.
   integer, parameter, public :: max_unknowns = 100
   !> So many balls are tried at most. Each is larger by what the one before has shown of the change of the Jacobian.
   integer, parameter :: max_tries = 8

   !> A map that contracts less is not used: 1 less its rate is a divisor.
   real(wp), parameter :: max_rate = 0.999_wp
   !> Balls are a little larger than need be.
   real(wp), parameter :: larger = 1.01_wp

   !> What the proof of a block computes.
   type :: block_work_t
      integer, allocatable :: row(:), column(:)   !< (entries) of its Jacobian
      type(ball_t), allocatable :: j(:)           !< (entries) the Jacobian
      type(ball_t), allocatable :: r(:), v(:)     !< (rows) residual, right-hand side for the derivatives
      real(wp), allocatable :: inverse(:, :)      !< (n, rows) |A|
      !> (n) Row sums of |1 - A J|: of the midpoints, at the centre of the ball, and in all of it.
      real(wp), allocatable, dimension(:) :: of_midpoints, at_centre, off
      real(wp), allocatable :: open(:)            !< (rows) bounds of the equations at the centre
      real(wp), allocatable :: x(:)               !< (n) |A| times these
   end type block_work_t

   !> A position that was found, and what is proved of it, in the units of the blocks: the exact unknowns and drives lie
   !> in balls about those that were found.
   type, extends(ball_state_t) :: placed_t
      real(wp) :: t = 0.0_wp                      !< time
      real(wp), allocatable :: open(:, :)         !< (0:1, rows) |F| and |dF/dt| at the midpoints of all unknowns
      real(wp) :: gap = 0.0_wp                    !< by how much redundant equations stay open at most
   end type placed_t

contains

   !> Room for a position of the blocks `b` with so many `drives`.
   pure function new_placed(b, drives) result(q)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives
      type(placed_t) :: q

      q%ball_state_t = new_ball_state(b, drives)
      allocate (q%open(0:1, size(b%rows)), source=0.0_wp)
   end function new_placed

   !> Proves the position `s` of those of the blocks `b` that are needed, at its time and values, for the `numbers`;
   !> with `order` 2 instead of 0 velocities and accelerations as well. Result: `placed`, and `failed`, the
   !> number of the first block that is not proved, where the proof ends; or 0.
   subroutine prove_position(numbers, b, path, s, order, placed, failed)
      type(ball_numbers_t), intent(in) :: numbers
      type(blocks_t), intent(in) :: b
      type(drive_path_t), intent(in) :: path
      type(state_t), intent(in) :: s
      integer, intent(in) :: order
      type(placed_t), intent(inout) :: placed
      integer, intent(out) :: failed
      type(bounds_t) :: law
      logical :: is_proved
      integer :: i, k

      placed%t = s%t
      placed%gap = 0.0_wp
      ! Nothing depends on unknowns of later blocks, but some cancel: they are exact, whatever their values.
      placed%u(:) = unknown_t()
      do i = 1, size(path%laws)
         law = bounds_of(path%laws(i), s%t - of_time*abs(s%t), s%t + of_time*abs(s%t), one_instant=.true.)
         associate (value => s%drive_value(:, i), unit => path%unit(i))
            placed%drive(:, i)%mid = value
            placed%drive(:, i)%radius = (max(law%high*unit - value, value - law%low*unit) + &
               4.0_wp*rounding*abs(value))*room
         end associate
      end do

      do k = 1, size(b%needed)
         failed = b%needed(k)
         call prove_block(numbers, b, failed, s, order, placed, is_proved)
         if (.not. is_proved) return
      end do
      failed = 0
   end subroutine prove_position

   !> Proves block `i` at the values of `s`, with earlier blocks as in `placed`: the values of its unknowns and, with
   !> `order` 2 instead of 0, their derivatives. Result: what `placed` has of this block.
   subroutine prove_block(numbers, b, i, s, order, placed, is_proved)
      type(ball_numbers_t), intent(in) :: numbers
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(state_t), intent(in) :: s
      type(placed_t), intent(inout) :: placed
      logical, intent(out) :: is_proved
      type(block_work_t) :: w
      type(unknown_t) :: exact
      real(wp) :: radius, largest
      integer :: k

      associate (block => b%list(i), own => own_unknowns(b, i))
         do k = 1, size(own)
            call set_ball(b, own(k), ball_t(s%u(own(k))%value, 0.0_wp), placed%ball_state_t)
            placed%u(own(k))%rate = ball_t(s%u(own(k))%rate, 0.0_wp)
            placed%u(own(k))%acceleration = ball_t(s%u(own(k))%acceleration, 0.0_wp)
         end do
         is_proved = block%direct
         if (block%direct) then
            associate (row => b%rows(block%first_row), direct => placed%u(own(1)))
               call find_direct(row, numbers%rows(block%first_row), placed%drive, placed%u(row%other), exact)
               call set_radius(b, own(1), distance(exact%value, direct%value%mid), placed%ball_state_t)
               direct%rate%radius = distance(exact%rate, direct%rate%mid)
               direct%acceleration%radius = distance(exact%acceleration, direct%acceleration%mid)
               placed%open(0, block%first_row) = direct%value%radius
               placed%open(1, block%first_row) = direct%rate%radius
            end associate
            return
         end if

         call contract(b, numbers, i, placed%ball_state_t, w, is_proved)
         if (.not. is_proved) return
         w%open(:) = top(w%r)
         call subtract_product(1, placed%u, own, w)
         placed%open(0, block%first_row:block%last_row) = w%open
         placed%open(1, block%first_row:block%last_row) = top(w%v)
         call find_ball(b, numbers, i, placed%ball_state_t, w, radius)
         is_proved = radius >= 0.0_wp
         if (.not. is_proved) return
         if (size(w%r) > size(own)) placed%gap = max(placed%gap, maxval(top(w%r)))
         do k = 1, size(own)
            call set_radius(b, own(k), min(radius, (w%x(k) + 0.5_wp*(w%at_centre(k) + w%off(k))*radius)*room), &
               placed%ball_state_t)
         end do

         do k = 1, order
            if (k == 2) call ball_accelerations(b, i, placed%ball_state_t, w%v)
            call subtract_product(k, placed%u, own, w)
            call apply(size(w%r), size(own), w%inverse, top(w%v), w%x)
            largest = maxval(w%x)/(1.0_wp - maxval(w%off))*room
            w%x(:) = (w%x + w%off*largest)*room
            if (k == 1) placed%u(own)%rate%radius = w%x
            if (k == 2) placed%u(own)%acceleration%radius = w%x
            is_proved = is_proved .and. all(w%x <= huge(1.0_wp))
         end do
      end associate
   end subroutine prove_block

   !> Equations and Jacobian of block `i`, with the `numbers`, at the state `balls`, whose own unknowns are at the
   !> centre of a ball, and about its inverse: all in `work`. `exists`: there is an inverse, and the block is not too
   !> wide.
   subroutine contract(b, numbers, i, balls, work, exists)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: numbers
      integer, intent(in) :: i
      type(ball_state_t), intent(inout) :: balls
      type(block_work_t), intent(out) :: work
      logical, intent(out) :: exists
      real(wp), allocatable :: midpoints(:, :)    ! of the Jacobian
      integer :: k

      associate (shape => b%list(i)%shape)
         exists = shape%n <= max_unknowns
         if (.not. exists) return
         associate (rows => shape%rows, n => shape%n, entries => entries_of(shape))
            allocate (work%row(entries), work%column(entries), work%j(entries), work%r(rows), work%v(rows), &
               work%open(rows), &
               work%inverse(n, rows), work%of_midpoints(n), work%at_centre(n), work%off(n), work%x(n))
            allocate (midpoints(rows, n), source=0.0_wp)
            if (shape%pattern == 0) then
               work%row(:) = [(1 + modulo(k - 1, rows), k=1, entries)]
               work%column(:) = [(1 + (k - 1)/rows, k=1, entries)]
            else
               associate (pattern => b%patterns(shape%pattern))
                  work%row(:) = pattern%row + 1
                  do k = 1, n
                     work%column(pattern%first(k) + 1:pattern%first(k + 1)) = k
                  end do
               end associate
            end if
         end associate
      end associate

      call assemble_balls(b, numbers, i, balls, work%j, work%r, work%v)
      do k = 1, size(work%j)
         midpoints(work%row(k), work%column(k)) = work%j(k)%mid
      end do
      call bound_inverse(size(work%r), size(work%x), midpoints, work%inverse, work%of_midpoints, exists)
      if (exists) call find_off(work, work%at_centre)
   end subroutine contract

   !> `off` (n): the row sums of |1 - A J| of the Jacobian J at hand.
   pure subroutine find_off(work, off)
      type(block_work_t), intent(in) :: work
      real(wp), intent(out) :: off(:)
      real(wp) :: wide(size(work%r))
      integer :: k

      wide = 0.0_wp
      do k = 1, size(work%j)
         wide(work%row(k)) = wide(work%row(k)) + work%j(k)%radius
      end do
      call apply(size(wide), size(off), work%inverse, wide, off)
      off = (work%of_midpoints + off)*(1.0_wp + (16 + size(work%x))*rounding)
   end subroutine find_off

   !> Finds the `radius` of a ball in which block `i`, with the `numbers`, has exactly one solution: about the own
   !> unknowns of the state `balls`, where it was contracted and its equations are no larger than w%open. -1: none is
   !> proved. These unknowns, and the equations in `work`, are then those in a ball that is no smaller. `others`:
   !> earlier blocks are off by so much at most; w%v is then how much they change the equations.
   subroutine find_ball(b, numbers, i, balls, work, radius, others)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: numbers
      integer, intent(in) :: i
      type(ball_state_t), intent(inout) :: balls
      type(block_work_t), intent(inout) :: work
      real(wp), intent(out) :: radius
      real(wp), intent(in), optional :: others
      real(wp) :: eta, z1, z2, rate, centre(size(work%x))
      integer :: tries, k

      radius = -1.0_wp
      call apply(size(work%r), size(work%x), work%inverse, work%open, work%x)
      ! What is not a number lies in no ball.
      if (.not. (all(work%x <= 1.0_wp) .and. all(work%at_centre <= max_rate))) return
      eta = max(0.0_wp, maxval(work%x))
      if (present(others)) eta = eta + others
      z1 = max(0.0_wp, maxval(work%at_centre))
      z2 = 0.0_wp
      do k = 1, size(work%x)
         centre(k) = balls%u(b%unknown(b%list(i)%first + k - 1))%value%radius
      end do
      do tries = 1, max_tries
         radius = radius_of(z1, z2, eta)
         if (radius < 0.0_wp) return
         do k = 1, size(work%x)
            call set_radius(b, b%unknown(b%list(i)%first + k - 1), (centre(k) + radius)*room, balls)
         end do
         call assemble_balls(b, numbers, i, balls, work%j, work%r, work%v)
         call find_off(work, work%off)
         if (.not. all(work%off <= max_rate)) exit
         rate = max(0.0_wp, maxval(work%off))
         if (present(others)) then
            call apply(size(work%r), size(work%x), work%inverse, (work%open + top(work%v))*room, work%x)
            if (.not. all(work%x <= 1.0_wp)) exit
            eta = max(0.0_wp, maxval(work%x))
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

   !> Subtracts from w%v the Jacobian times derivative number `order` (1 or 2) of the block's `own` unknowns among
   !> `unknowns`.
   pure subroutine subtract_product(order, unknowns, own, work)
      integer, intent(in) :: order, own(:)
      type(unknown_t), intent(in) :: unknowns(0:)
      type(block_work_t), intent(inout) :: work
      type(ball_t) :: x
      integer :: k

      do k = 1, size(work%j)
         if (order == 1) x = unknowns(own(work%column(k)))%rate
         if (order == 2) x = unknowns(own(work%column(k)))%acceleration
         work%v(work%row(k)) = work%v(work%row(k)) - work%j(k)*x
      end do
   end subroutine subtract_product

   !> `a` (n, rows): |A| of about the inverse A of `jacobian` (rows, n), with room for roundings; `off` (n): the row
   !> sums of |1 - A J|. Of equations that are too many A is the inverse by least squares. `exists`: there is one.
   subroutine bound_inverse(rows, n, jacobian, a, off, exists)
      integer, intent(in) :: rows, n
      real(wp), intent(in) :: jacobian(rows, n)
      real(wp), intent(out) :: a(n, rows), off(n)
      logical, intent(out) :: exists
      real(wp), allocatable :: factors(:, :), work(:)
      real(wp) :: x(max(n, rows)), room
      integer :: pivots(n), k, i, info

      associate (dense => shape_t(rows, n))
         factors = jacobian
         allocate (work(work_length(dense)))
         do i = 1, rows
            x = 0.0_wp
            x(i) = 1.0_wp
            if (i == 1) then
               call solve_first(dense, factors, pivots, work, x, info)
               exists = info == 0
               if (.not. exists) return
            else
               call solve_again(dense, factors, pivots, work, x)
            end if
            a(:, i) = x(:n)
         end do
      end associate

      off = (n + 2)*rounding
      do k = 1, n
         x = 0.0_wp
         x(k) = -1.0_wp
         do i = 1, rows
            if (abs(jacobian(i, k)) > 0.0_wp) x(:n) = x(:n) + a(:, i)*jacobian(i, k)
         end do
         off = off + abs(x(:n))
      end do

      ! What rounding leaves open of all terms; room, too, for products that underflow.
      room = 1.0_wp + (64 + 4*rows)*rounding
      do i = 1, rows
         a(:, i) = abs(a(:, i))*room
         off = off + a(:, i)*((rows + 2)*rounding*sum(abs(jacobian(i, :))))
      end do
      off = off*room**2
   end subroutine bound_inverse

   !> `product` (n): |A| `vector` (rows), rounded up.
   pure subroutine apply(rows, n, a, vector, product)
      integer, intent(in) :: rows, n
      real(wp), intent(in) :: a(n, rows), vector(rows)
      real(wp), intent(out) :: product(n)
      integer :: k

      product = 0.0_wp
      do k = 1, rows
         product = product + a(:, k)*vector(k)
      end do
      ! For products that underflow; what is at rest is so exactly.
      if (any(vector > 0.0_wp)) product = product*(1.0_wp + (16 + rows)*rounding) + tiny(1.0_wp)
   end subroutine apply

   !> The radius of a ball about the centre, where |A| |F| <= `eta`, that is mapped into itself with these `z1` and
   !> `z2`; -1: none.
   pure real(wp) function radius_of(z1, z2, eta) result(r)
      real(wp), intent(in) :: z1, z2, eta
      real(wp) :: root

      r = -1.0_wp
      root = (1.0_wp - z1)**2 - 2.0_wp*z2*eta
      if (root > 0.0_wp .and. z1 <= max_rate) r = 2.0_wp*eta/(1.0_wp - z1 + sqrt(root))*larger
   end function radius_of
end module position_proof
