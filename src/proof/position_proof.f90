!> Proof of a position at one instant: that near the values found for the unknowns of a block there is exactly one
!> solution of its exact equations, and how far from these values it is at most; the same for rates and accelerations.
!> Blocks are proved in solving order: what earlier ones leave open counts in later ones.
!>
!> With F(x*) = 0 and |1 - A J| <= k in a ball about x that holds x*, |x - x*| <= |A| |F(x)|/(1 - k). The rates v solve
!> J(x*) v* = b(x*), so |v - v*| <= |A| |J(x*) v - b(x*)|/(1 - k); accelerations likewise. J(x*) v - b(x*) is what is
!> computed at x, with a bound of how it changes from x to x*.
!>
!> Where equations are too many, as many independent ones as there are unknowns are proved, and of the others it is
!> bounded by how much they stay open.
module position_proof
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use law_bounds, only: bounds_t, bounds_of
   use blocks, only: blocks_t
   use block_state, only: state_t, new_state, set_direction, find_known_parts
   use block_equations, only: assemble_dense, right_hand_side
   use block_engine, only: block_engine_t
   use proof_data, only: proof_data_t, new_proof_data, table_errors, rounding
   use row_bounds, only: jets_t, new_jets, turn, turn_errors, bound_rows, bound_jacobian, bound_growth
   use contraction, only: contraction_t, contract, radius_of, applied, max_radius
   implicit none
   private
   public :: prover_t, placed_t, make_prover, new_placed, take_state, prove_position, prove_block, contract_block

   !> Times, too, are numbers of the deck.
   real(wp), parameter, public :: of_time = 4.0_wp*rounding
   !> Enlarges a sum of a few numbers by more than its roundings.
   real(wp), parameter, public :: room = 1.0_wp + 32.0_wp*rounding

   !> What the proofs of a mechanism need.
   type :: prover_t
      type(proof_data_t) :: data
      type(state_t) :: state                      !< the values of the proof at hand
      type(jets_t) :: jets                        !< their bounds
      type(contraction_t) :: contraction          !< of the block proved last
      integer, allocatable :: rows(:)             !< (unknowns) the independent equations of block 1, if it has too many
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

      p%data = new_proof_data(m, e%blocks, e%length)
      p%state = new_state(e%blocks, size(m%drives))
      p%jets = new_jets(e%blocks%unknowns, size(m%drives))
      allocate (p%table_error(0:2, size(m%drives)))
      do i = 1, size(m%drives)
         p%table_error(:, i) = table_errors(e%laws(i))*e%unit_of(i)
      end do
   end subroutine make_prover

   !> Room for a position of the blocks `b` with so many `drives`.
   pure function new_placed(b, drives) result(q)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives
      type(placed_t) :: q

      allocate (q%x(0:2, 0:b%unknowns), q%error(0:2, 0:b%unknowns), q%drive(0:2, 0:drives), &
         q%drive_error(0:2, 0:drives), q%open(0:1, size(b%rows)), q%gap(size(b%list)), &
         source=0.0_wp)
      allocate (q%is_proved(size(b%list)), source=.false.)
   end function new_placed

   !> Proves position, velocity and acceleration of the blocks `list`, in solving order, at the time `t` and the values
   !> that the engine `e` has found. `is_proved`: of all of them; the first that is not ends the proof.
   subroutine prove_position(p, e, t, list, q, is_proved)
      type(prover_t), intent(inout) :: p
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: t
      integer, intent(in) :: list(:)
      type(placed_t), intent(inout) :: q
      logical, intent(out) :: is_proved
      integer :: k

      ! As sections: assignments to the whole would ask for shapes first.
      p%state%u(:) = e%state%u(:)
      p%state%drive_value(:, :) = e%state%drive_value(:, :)
      call take_state(p, e, t, q)
      is_proved = .true.
      do k = 1, size(list)
         call prove_block(p, e%blocks, list(k), 2, q)
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
      do u = 0, e%blocks%unknowns
         ! The solver may have turned a direction by a small angle; here its rounding counts.
         call set_direction(e%blocks, u, p%state)
         q%x(:, u) = [p%state%u(u)%value, p%state%u(u)%rate, p%state%u(u)%acceleration]
      end do
      do i = 1, size(e%laws)
         q%drive(:, i) = p%state%drive_value(:, i)
         law = bounds_of(e%laws(i), t - of_time*abs(t), t + of_time*abs(t), one_instant=.true.)
         p%jets%drive(:, i) = abs(q%drive(:, i))
         p%jets%drive_error(:, i) = (max(law%high*e%unit_of(i) - q%drive(:, i), q%drive(:, i) - law%low*e%unit_of(i)) &
            + 4.0_wp*rounding*abs(q%drive(:, i)) + p%table_error(:, i))*room
         q%drive_error(:, i) = p%jets%drive_error(:, i)
      end do
   end subroutine take_state

   !> Proves block `i` at the values of p%state, whose earlier blocks `q` has proved: the values of its unknowns and,
   !> up to `order` (0 to 2), their derivatives. Result: what `q` has of this block.
   subroutine prove_block(p, b, i, order, q)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(placed_t), intent(inout) :: q
      real(wp) :: a(b%list(i)%shape%rows, b%list(i)%shape%n), r(b%list(i)%shape%rows, 0:2), g(b%list(i)%shape%rows), &
         size_of(b%list(i)%shape%rows), open(b%list(i)%shape%rows), error(b%list(i)%shape%rows)
      integer :: k

      associate (block => b%list(i), own => b%unknown(b%list(i)%first:b%list(i)%last))
         q%error(:, own) = 0.0_wp
         q%is_proved(i) = .true.
         q%gap(i) = 0.0_wp
         if (block%direct) then
            call prove_direct(p, b, i, q)
            call bound_unknowns(b, own, q, p)
            return
         end if
         call bound_unknowns(b, own, q, p)
         call find_residuals(p, b, i, a, r)
         do k = 0, order
            call bound_rows(p%data, b, i, p%jets, k, size_of, open, error)
            g = (abs(r(:, k)) + open)*room
            if (k < 2) q%open(k, block%first_row:block%last_row) = g
            g = (g + error)*room
            if (k == 0) then
               call prove_values(p, b, i, a, g, q)
               if (.not. q%is_proved(i)) return
            else
               q%error(k, own) = derivative_errors(p, b, i, g, q%error(0, own))
            end if
            call bound_unknowns(b, own, q, p)
         end do
      end associate
   end subroutine prove_block

   !> Proves the direct block `i`: its unknown is another one and a drive.
   subroutine prove_direct(p, b, i, q)
      type(prover_t), intent(in) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(placed_t), intent(inout) :: q
      real(wp) :: x(0:2), given(0:2), known(0:2), size_of(0:2), r(0:2)

      associate (row => b%rows(b%list(i)%first_row), u => b%unknown(b%list(i)%first))
         x = [p%state%u(u)%value, p%state%u(u)%rate, p%state%u(u)%acceleration]
         known = [p%state%u(row%other)%value, p%state%u(row%other)%rate, p%state%u(row%other)%acceleration]
         given = p%state%drive_value(:, row%drive)
         given(0) = given(0) + row%constant
         size_of = abs(x) + abs(known) + p%jets%drive(:, row%drive) + abs(row%constant)*[1.0_wp, 0.0_wp, 0.0_wp]
         r = abs(x - known - row%sign_of*given) + 4.0_wp*rounding*size_of
         r(0) = r(0) + p%data%constant_weight(b%list(i)%first_row)
         q%open(:, b%list(i)%first_row) = r(:1)*room
         q%error(:, u) = (r + p%jets%drive_error(:, row%drive) + q%error(:, row%other))*room
      end associate
   end subroutine prove_direct

   !> The bounds of the motion of the unknowns `list`, as far as it is known.
   pure subroutine bound_unknowns(b, list, q, p)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)
      type(placed_t), intent(in) :: q
      type(prover_t), intent(inout) :: p
      integer :: k

      do k = 1, size(list)
         associate (u => list(k), j => p%jets)
            j%own(:, u) = 0.0_wp
            j%own_error(:, u) = 0.0_wp
            j%own(:2, u) = abs([p%state%u(u)%value, p%state%u(u)%rate, p%state%u(u)%acceleration])
            j%own_error(:2, u) = q%error(:, u)
            if (u > b%orientations) cycle
            j%turn(:, u) = turn(j%own(:, u))
            j%turn_error(:, u) = turn_errors(j%own(:, u), j%own_error(:, u))
         end associate
      end do
   end subroutine bound_unknowns

   !> Jacobian `a` (rows, n) of block `i` and what its equations and their first and second derivatives leave, `r`
   !> (rows, 0:2), at the values of p%state.
   subroutine find_residuals(p, b, i, a, r)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(out) :: a(:, :), r(:, 0:)
      real(wp) :: given(size(r, 1))

      call find_known_parts(b, i, p%state)
      call assemble_dense(b, i, p%state, a, r(:, 0))
      associate (own => p%state%u(b%unknown(b%list(i)%first:b%list(i)%last)))
         call right_hand_side(b, i, 1, p%state, given)
         r(:, 1) = matmul(a, own%rate) - given
         call right_hand_side(b, i, 2, p%state, given)
         r(:, 2) = matmul(a, own%acceleration) - given
      end associate
   end subroutine find_residuals

   !> Proves the values of block `i` with the Jacobian `a` (rows, n), where its equations are no larger than `g` (rows).
   subroutine prove_values(p, b, i, a, g, q)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: a(:, :), g(:)
      type(placed_t), intent(inout) :: q
      real(wp) :: x(size(a, 2)), radius

      associate (c => p%contraction, own => b%unknown(b%list(i)%first:b%list(i)%last))
         call contract_block(p, b, i, a, g, q%error(0, :), x, radius, q%gap(i))
         q%is_proved(i) = radius >= 0.0_wp
         if (.not. q%is_proved(i)) return
         q%error(0, own) = min(radius, (x + (c%off + c%z2*radius)*radius)*room)
      end associate
   end subroutine prove_values

   !> The contraction of block `i`, whose Jacobian is `a` (rows, n) at the place at hand and may be off as where
   !> unknowns are `off` (0:unknowns) from there; its equations are no larger than `g` (rows). `x` (n): |A| `g`;
   !> `radius`: of the ball that holds exactly one solution, -1 where none is proved; `gap`: by how much
   !> redundant equations stay open in
   !> that ball at most.
   subroutine contract_block(p, b, i, a, g, off, x, radius, gap)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: a(:, :), g(:), off(0:)
      real(wp), intent(out) :: x(:), radius, gap
      real(wp) :: change(size(g)), growth(size(g)), slide(0:b%unknowns)

      associate (c => p%contraction, own => b%unknown(b%list(i)%first:b%list(i)%last), n => size(a, 2))
         slide = p%jets%own(0, :) + p%jets%own_error(0, :)
         slide(own) = slide(own) + max_radius
         change = bound_jacobian(p%data, b, i, off, slide)
         growth = bound_growth(p%data, b, i, slide)
         gap = 0.0_wp
         if (size(g) > n) then
            call choose_rows(a, p%rows)
            call contract(a(p%rows, :), change(p%rows), growth(p%rows), c)
            if (c%exists) x = applied(c, g(p%rows))
         else
            call contract(a, change, growth, c)
            if (c%exists) x = applied(c, g)
         end if
         radius = -1.0_wp
         if (c%exists) radius = radius_of(c, max(0.0_wp, maxval(x)))
         if (size(g) > n) gap = maxval((g + (sum(abs(a), dim=2) + change + growth*radius)*radius)*room)
      end associate
   end subroutine contract_block

   !> Bounds (n) of the errors of the derivatives of one order of block `i`, whose equations leave `g` (rows); `values`
   !> (n): those of its values.
   pure function derivative_errors(p, b, i, g, values) result(error)
      type(prover_t), intent(in) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: g(:), values(:)
      real(wp) :: error(size(values)), x(size(values)), largest

      if (size(error) == 0) return
      associate (c => p%contraction)
         if (b%list(i)%shape%rows > size(error)) then
            x = applied(c, g(p%rows))
         else
            x = applied(c, g)
         end if
         largest = maxval(x)/(1.0_wp - c%z1 - c%z2*maxval(values))*room
         error = (x + (c%off + c%z2*maxval(values))*largest)*room
      end associate
   end function derivative_errors

   !> `rows` (n): of the equations with the Jacobian `a` (any number, n) those that Gauss' elimination takes, with the
   !> largest pivots, in their order.
   subroutine choose_rows(a, rows)
      real(wp), intent(in) :: a(:, :)
      integer, allocatable, intent(out) :: rows(:)
      real(wp) :: left(size(a, 1), size(a, 2))
      logical :: taken(size(a, 1))
      integer :: k, i, pivot

      left = a
      taken = .false.
      do k = 1, size(a, 2)
         pivot = maxloc(abs(left(:, k)), dim=1, mask=.not. taken)
         taken(pivot) = .true.
         if (.not. abs(left(pivot, k)) > 0.0_wp) cycle
         do i = 1, size(a, 1)
            if (.not. taken(i)) left(i, k:) = left(i, k:) - left(i, k)/left(pivot, k)*left(pivot, k:)
         end do
      end do
      rows = pack([(i, i=1, size(a, 1))], taken)
   end subroutine choose_rows
end module position_proof
