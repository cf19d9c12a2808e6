!> Proof of a position at one instant: that near the computed values of the unknowns of a block there is exactly one
!> solution of its exact equations, with a bound of its distance from these values; then of rates and accelerations.
!> Blocks are proved in solving order: errors of earlier blocks count in later blocks.
!>
!> With F(x*) = 0, A about the inverse of the Jacobian J, and |1 - A J| <= k in a ball about x that holds x*,
!> |x - x*| <= |A| |F(x)|/(1 - k). The exact rates v* solve J(x*) v* = b(x*): |v - v*| <= |A| |J(x*) v - b(x*)|/(1 - k);
!> accelerations have the corresponding bound. F, J and b are the equations in balls: of the numbers, of the motion of
!> earlier blocks, and of x.
!>
!> The ball is found by Newton and Kantorovich's argument: x - A F(x) maps the ball of radius r about c into itself and
!> contracts it, if
!>
!>    |A| |F(c)| + z1 r + z2 r^2/2 <= r,   z1 >= |1 - A J(c)|,   z1 + z2 s >= |1 - A J| in the ball of radius s <= r
!>
!> Then F has exactly one zero in the ball, J is regular in all of it, and z1 + z2 r < 1. (Ortega and Rheinboldt, ch.
!> 12; the form with bounds from data has Day, Lessard and Mischaikow's radii polynomials.)
!>
!> If equations are redundant, A is an inverse by least squares: as many sums of equations as there are unknowns are
!> proved, and the closure errors of all equations are bounded.
module position_proof
   use kinds, only: wp
   use drives, only: bounds_t, bounds_of
   use blocks, only: blocks_t, own_unknowns
   use block_matrix, only: matrix_layout_t, entries_of, solve_first, solve_again, work_length
   use block_state, only: state_t
   use drive_path, only: drive_path_t
   use balls, only: ball_t, rounding, room, top, distance, operator(+), operator(-), operator(*)
   use ball_equations, only: ball_numbers_t, ball_state_t, unknown_t, new_ball_state, set_ball, set_radius, &
      assemble_balls, ball_accelerations, find_direct
   use ball_numbers, only: number_error
   implicit none
   private
   public :: proved_position_t, block_work_t, new_placed, prove_position, contract, find_ball, subtract_product

   !> A block of more unknowns is not proved: its inverse takes n^3 products for each part of a step, and a step may
   !> have a thousand parts.
   integer, parameter, public :: max_proved_unknowns = 100
   !> Up to so many balls are tried. Each is larger by the change of the Jacobian in the ball before.
   integer, parameter :: max_balls = 8
   !> A map with a larger rate of contraction is not used: 1 less the rate is a divisor.
   real(wp), parameter :: max_rate = 0.999_wp
   !> Balls are larger than necessary by this factor: roundings of the inequality do not matter then.
   real(wp), parameter :: enlargement = 1.01_wp

   !> The numbers of the proof of a block.
   type :: block_work_t
      integer, allocatable :: row(:), column(:)   !< (entries) rows and columns of the entries of its Jacobian J
      type(ball_t), allocatable :: j(:)           !< (entries) the Jacobian
      type(ball_t), allocatable :: r(:), v(:)     !< (rows) residuals, right-hand side for the derivatives
      real(wp), allocatable :: inverse(:, :)      !< (n, rows) |A|, A about the inverse of J
      !> (n) Row sums of |1 - A J|: of the midpoints, at the centre of the ball, and in all of it.
      real(wp), allocatable, dimension(:) :: of_midpoints, at_centre, off
      real(wp), allocatable :: open(:)            !< (rows) bounds of |F| at the centre, unit of the loop or rad
      real(wp), allocatable :: x(:)               !< (n) |A| times these bounds, rad or unit of the block
   end type block_work_t

   !> A computed position and its proof, in the units of the blocks: the exact unknowns and drives lie in balls about
   !> the computed ones.
   type, extends(ball_state_t) :: proved_position_t
      real(wp) :: t = 0.0_wp                      !< time, in the deck's unit
      real(wp), allocatable :: open(:, :)         !< (0:1, rows) bounds of |F| and |dF/dt| at the computed unknowns
      real(wp) :: closure_error = 0.0_wp          !< bound of redundant equations, unit of the loop or rad
   end type proved_position_t

contains

   !> Makes an empty position of a structure, for `prove_position`.
   pure function new_placed(b, drives) result(q)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives          !< how many drives there are
      type(proved_position_t) :: q

      q%ball_state_t = new_ball_state(b, drives)
      allocate (q%open(0:1, size(b%rows)), source=0.0_wp)
   end function new_placed

   !> Proves the position of the needed blocks at the time and values of a state, in solving order. The proof ends at
   !> the first block that is not proved.
   subroutine prove_position(numbers, b, path, s, order, proved, failed)
      type(ball_numbers_t), intent(in) :: numbers   !< the geometry in balls
      type(blocks_t), intent(in) :: b
      type(drive_path_t), intent(in) :: path   !< of the drives
      type(state_t), intent(in) :: s         !< the computed motion, with time and drives
      integer, intent(in) :: order           !< 0: position; 2: velocities and accelerations as well
      type(proved_position_t), intent(inout) :: proved   !< the proof, as far as it goes
      integer, intent(out) :: failed         !< number of the block that is not proved; 0: all are proved
      type(bounds_t) :: law
      logical :: is_proved
      integer :: i, k

      proved%t = s%t
      proved%closure_error = 0.0_wp
      ! No equation depends on unknowns of later blocks, but some hold them with factors that cancel: any value serves.
      proved%u(:) = unknown_t()
      do i = 1, size(path%laws)
         law = bounds_of(path%laws(i), s%t - number_error*abs(s%t), s%t + number_error*abs(s%t), .true.)
         associate (value => s%drive_value(:, i), unit => path%unit(i))
            proved%drive(:, i)%mid = value
            proved%drive(:, i)%radius = (max(law%high*unit - value, value - law%low*unit) + &
               4.0_wp*rounding*abs(value))*room
         end associate
      end do

      do k = 1, size(b%needed)
         failed = b%needed(k)
         call prove_block(numbers, b, failed, s, order, proved, is_proved)
         if (.not. is_proved) return
      end do
      failed = 0
   end subroutine prove_position

   !> Proves the values of the unknowns of a block in a state, and their derivatives if these are wanted.
   subroutine prove_block(numbers, b, i, s, order, proved, is_proved)
      type(ball_numbers_t), intent(in) :: numbers   !< the geometry in balls
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i               !< number of the block
      integer, intent(in) :: order           !< 0: values; 2: derivatives as well
      type(state_t), intent(in) :: s         !< the computed motion
      type(proved_position_t), intent(inout) :: proved   !< with drives and earlier blocks; then also with this block
      logical, intent(out) :: is_proved      !< values, and derivatives if wanted, are proved
      type(block_work_t) :: w
      type(unknown_t) :: exact
      real(wp) :: radius, largest
      integer :: k

      associate (block => b%list(i), own => own_unknowns(b, i))
         do k = 1, size(own)
            call set_ball(b, own(k), ball_t(s%u(own(k))%value, 0.0_wp), proved%ball_state_t)
            proved%u(own(k))%rate = ball_t(s%u(own(k))%rate, 0.0_wp)
            proved%u(own(k))%acceleration = ball_t(s%u(own(k))%acceleration, 0.0_wp)
         end do

         is_proved = block%explicit
         if (block%explicit) then
            associate (row => b%rows(block%first_row), explicit => proved%u(own(1)))
               call find_direct(row, numbers%rows(block%first_row), proved%drive, proved%u(row%other), exact)
               call set_radius(b, own(1), distance(exact%value, explicit%value%mid), proved%ball_state_t)
               explicit%rate%radius = distance(exact%rate, explicit%rate%mid)
               explicit%acceleration%radius = distance(exact%acceleration, explicit%acceleration%mid)
               proved%open(0, block%first_row) = explicit%value%radius
               proved%open(1, block%first_row) = explicit%rate%radius
            end associate
            return
         end if

         call contract(b, numbers, i, proved%ball_state_t, w, is_proved)
         if (.not. is_proved) return
         w%open(:) = top(w%r)
         call subtract_product(1, proved%u, own, w)
         proved%open(0, block%first_row:block%last_row) = w%open
         proved%open(1, block%first_row:block%last_row) = top(w%v)

         call find_ball(b, numbers, i, proved%ball_state_t, w, -1.0_wp, radius)
         is_proved = radius >= 0.0_wp
         if (.not. is_proved) return
         if (size(w%r) > size(own)) proved%closure_error = max(proved%closure_error, maxval(top(w%r)))
         do k = 1, size(own)
            call set_radius(b, own(k), min(radius, (w%x(k) + 0.5_wp*(w%at_centre(k) + w%off(k))*radius)*room), &
               proved%ball_state_t)
         end do

         do k = 1, order
            if (k == 2) call ball_accelerations(b, i, proved%ball_state_t, w%v)
            call subtract_product(k, proved%u, own, w)
            call apply(size(w%r), size(own), w%inverse, top(w%v), w%x)
            largest = maxval(w%x)/(1.0_wp - maxval(w%off))*room
            w%x(:) = (w%x + w%off*largest)*room
            if (k == 1) proved%u(own)%rate%radius = w%x
            if (k == 2) proved%u(own)%acceleration%radius = w%x
            is_proved = is_proved .and. all(w%x <= huge(1.0_wp))
         end do
      end associate
   end subroutine prove_block

   !> Computes equations, Jacobian J and an approximate inverse A of a block at the centre of a ball, and bounds |1 - A
   !> J| there. It prepares `find_ball`.
   subroutine contract(b, numbers, i, balls, work, exists)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: numbers   !< the geometry in balls
      integer, intent(in) :: i               !< number of the block, which is not explicit
      type(ball_state_t), intent(inout) :: balls   !< the state; unknowns of the block are at the centre of the ball
      type(block_work_t), intent(out) :: work   !< all but `open`, `off` and `x`
      logical, intent(out) :: exists         !< there is an inverse, and the block has not too many unknowns
      real(wp), allocatable :: midpoints(:, :)    ! of the Jacobian
      integer :: k

      associate (shape => b%list(i)%shape)
         exists = shape%n <= max_proved_unknowns
         if (.not. exists) return
         associate (rows => shape%rows, n => shape%n, entries => entries_of(shape))
            allocate (work%row(entries), work%column(entries), work%j(entries), work%r(rows), work%v(rows), &
               work%open(rows), work%inverse(n, rows), work%of_midpoints(n), work%at_centre(n), work%off(n), work%x(n))
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
      if (exists) call bound_contraction(work, work%at_centre)
   end subroutine contract

   !> Bounds the row sums of |1 - A J| for the last assembled Jacobian J of a block.
   pure subroutine bound_contraction(work, off)
      type(block_work_t), intent(in) :: work   !< with J, A, and the row sums of the midpoints
      real(wp), intent(out) :: off(:)        !< (n) the bounds, without a unit
      real(wp) :: wide(size(work%r))
      integer :: k

      wide = 0.0_wp
      do k = 1, size(work%j)
         wide(work%row(k)) = wide(work%row(k)) + work%j(k)%radius
      end do
      call apply(size(wide), size(off), work%inverse, wide, off)
      off = (work%of_midpoints + off)*(1.0_wp + (16 + size(work%x))*rounding)
   end subroutine bound_contraction

   !> Finds a ball about the unknowns of a block in which it has exactly one solution, by the argument of the module's
   !> head. The unknowns of the state, and the equations in `work`, become those in this ball or a larger one.
   subroutine find_ball(b, numbers, i, balls, work, others, radius)
      type(blocks_t), intent(in) :: b
      type(ball_numbers_t), intent(in) :: numbers   !< the geometry in balls
      integer, intent(in) :: i               !< number of the block
      type(ball_state_t), intent(inout) :: balls   !< the state at which `contract` was called
      type(block_work_t), intent(inout) :: work   !< by `contract`, with bounds of the equations in work%open
      !> 0 or more: bound of the errors of earlier blocks, whose effect on the equations is the right-hand side for the
      !> velocities; below 0: the balls of the state hold these errors.
      real(wp), intent(in) :: others         !< rad or unit of the block
      real(wp), intent(out) :: radius        !< rad or unit of the block; -1: no ball is proved
      real(wp) :: eta, z1, z2, rate, centre(size(work%x))
      integer :: tries, k

      radius = -1.0_wp
      call apply(size(work%r), size(work%x), work%inverse, work%open, work%x)
      ! A NaN lies in no ball.
      if (.not. (all(work%x <= 1.0_wp) .and. all(work%at_centre <= max_rate))) return
      eta = max(0.0_wp, maxval(work%x))
      eta = eta + max(0.0_wp, others)
      z1 = max(0.0_wp, maxval(work%at_centre))
      z2 = 0.0_wp
      do k = 1, size(work%x)
         centre(k) = balls%u(b%unknown(b%list(i)%first + k - 1))%value%radius
      end do

      do tries = 1, max_balls
         radius = radius_of(z1, z2, eta)
         if (radius < 0.0_wp) return
         do k = 1, size(work%x)
            call set_radius(b, b%unknown(b%list(i)%first + k - 1), (centre(k) + radius)*room, balls)
         end do
         call assemble_balls(b, numbers, i, balls, work%j, work%r, work%v)
         call bound_contraction(work, work%off)
         if (.not. all(work%off <= max_rate)) exit

         rate = max(0.0_wp, maxval(work%off))
         if (others >= 0.0_wp) then
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

   !> Subtracts the Jacobian times the rates or accelerations of a block from its right-hand side, work%v.
   pure subroutine subtract_product(order, unknowns, own, work)
      integer, intent(in) :: order           !< 1: rates; 2: accelerations
      integer, intent(in) :: own(:)          !< (n) numbers of the unknowns of the block
      type(unknown_t), intent(in) :: unknowns(0:)   !< (0:unknowns) with rates and accelerations
      type(block_work_t), intent(inout) :: work   !< with the Jacobian; v is changed
      type(ball_t) :: x
      integer :: k

      do k = 1, size(work%j)
         if (order == 1) x = unknowns(own(work%column(k)))%rate
         if (order == 2) x = unknowns(own(work%column(k)))%acceleration
         work%v(work%row(k)) = work%v(work%row(k)) - work%j(k)*x
      end do
   end subroutine subtract_product

   !> Computes |A|, with room for roundings, for an approximate inverse A of a Jacobian J, and bounds |1 - A J|. If
   !> equations are redundant, A is an inverse by least squares.
   subroutine bound_inverse(rows, n, jacobian, a, off, exists)
      integer, intent(in) :: rows            !< number of equations
      integer, intent(in) :: n               !< number of unknowns
      real(wp), intent(in) :: jacobian(rows, n)   !< midpoints of J
      real(wp), intent(out) :: a(n, rows)    !< |A|
      real(wp), intent(out) :: off(n)        !< bounds of the row sums of |1 - A J|
      logical, intent(out) :: exists         !< there is an inverse; otherwise the other results are not set
      real(wp), allocatable :: factors(:, :), work(:)
      real(wp) :: x(max(n, rows)), enlarged
      integer :: pivots(n), k, i, info

      associate (dense => matrix_layout_t(rows, n))
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

      ! The factor covers the rounding of all terms, and products that underflow.
      enlarged = 1.0_wp + (64 + 4*rows)*rounding
      do i = 1, rows
         a(:, i) = abs(a(:, i))*enlarged
         off = off + a(:, i)*((rows + 2)*rounding*sum(abs(jacobian(i, :))))
      end do
      off = off*enlarged**2
   end subroutine bound_inverse

   !> Multiplies |A| by a vector of bounds, and rounds up.
   pure subroutine apply(rows, n, a, vector, product)
      integer, intent(in) :: rows            !< number of equations
      integer, intent(in) :: n               !< number of unknowns
      real(wp), intent(in) :: a(n, rows)     !< |A|
      real(wp), intent(in) :: vector(rows)   !< at least 0, in the units of the equations
      real(wp), intent(out) :: product(n)    !< in the units of the unknowns
      integer :: k

      product = 0.0_wp
      do k = 1, rows
         product = product + a(:, k)*vector(k)
      end do
      ! The last term is for products that underflow; a vector of zeros is exact.
      if (any(vector > 0.0_wp)) product = product*(1.0_wp + (16 + rows)*rounding) + tiny(1.0_wp)
   end subroutine apply

   !> Gives the radius of a ball that the map x - A F(x) maps into itself, by the inequality of the module's head, in
   !> rad or the unit of the block; -1 if there is none.
   pure real(wp) function radius_of(z1, z2, eta) result(r)
      real(wp), intent(in) :: z1             !< bound of |1 - A J| at the centre
      real(wp), intent(in) :: z2             !< the change of this bound over the radius, 1/rad or 1/unit of the block
      real(wp), intent(in) :: eta            !< bound of |A| |F| at the centre, rad or unit of the block
      real(wp) :: root

      r = -1.0_wp
      root = (1.0_wp - z1)**2 - 2.0_wp*z2*eta
      if (root > 0.0_wp .and. z1 <= max_rate) r = 2.0_wp*eta/(1.0_wp - z1 + sqrt(root))*enlargement
   end function radius_of
end module position_proof
