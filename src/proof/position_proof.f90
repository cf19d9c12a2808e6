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
   use drives, only: bounds_t, bounds_of
   use blocks, only: blocks_t
   use block_state, only: state_t, new_state, set_direction
   use block_equations, only: find_known_parts, assemble_dense, right_hand_side
   use block_engine, only: block_engine_t
   use proof_data, only: proof_data_t, new_proof_data, table_errors, rounding
   use row_bounds, only: jets_t, new_jets, note_turn_error, bound_rows, bound_changes, bound_jacobian
   use contraction, only: contraction_t, contract, radius_of, apply
   implicit none
   private
   public :: prover_t, placed_t, make_prover, new_placed, take_state, prove_position, prove_block, contract_block

   !> Times, too, are numbers of the deck.
   real(wp), parameter, public :: of_time = 4.0_wp*rounding
   !> Enlarges a sum of a few numbers by more than its roundings.
   real(wp), parameter, public :: room = 1.0_wp + 32.0_wp*rounding
   !> A block of more unknowns is not proved: all n^2 entries of its inverse take a tenth of a second for each part of a
   !> step, of which there may be a thousand.
   integer, parameter, public :: max_unknowns = 500

   !> What the proof of a block computes; nothing is allocated of a direct block, or one that is too wide.
   type :: block_work_t
      real(wp), allocatable :: a(:, :)            !< (rows, n) Jacobian
      real(wp), allocatable :: r(:, :)            !< (rows, 0:2) what its equations and their derivatives leave
      !> (rows) bounds of the equations, and see `bound_rows`, `bound_changes`, `bound_jacobian`
      real(wp), allocatable, dimension(:) :: g, open, error, change, growth
      real(wp), allocatable :: x(:)               !< (n) |A| g
      real(wp) :: within = 0.0_wp                 !< the largest bound of the errors of its values
      type(contraction_t) :: contraction
   end type block_work_t

   !> What the proofs of a mechanism need.
   type :: prover_t
      type(proof_data_t) :: data
      type(state_t) :: state                      !< the values of the proof at hand
      type(jets_t) :: jets                        !< their bounds
      type(block_work_t), allocatable :: work(:)  !< (blocks)
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
      real(wp), allocatable :: norm(:), z1(:)     !< (blocks) the largest row sum of |A|, and z1, of their contractions
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
      allocate (p%work(size(e%blocks%list)))
      do i = 1, size(e%blocks%list)
         associate (w => p%work(i), n => e%blocks%list(i)%shape%n, rows => e%blocks%list(i)%shape%rows)
            if (e%blocks%list(i)%direct .or. n > max_unknowns) cycle
            allocate (w%a(rows, n), w%r(rows, 0:2), w%g(rows), w%open(rows), w%error(rows), &
               w%change(rows), w%growth(rows), w%x(n))
         end associate
      end do
   end subroutine make_prover

   !> Room for a position of the blocks `b` with so many `drives`.
   pure function new_placed(b, drives) result(q)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: drives
      type(placed_t) :: q

      allocate (q%x(0:2, 0:b%unknowns), q%error(0:2, 0:b%unknowns), q%drive(0:2, 0:drives), &
         q%drive_error(0:2, 0:drives), q%open(0:1, size(b%rows)), q%gap(size(b%list)), q%norm(size(b%list)), &
         q%z1(size(b%list)), source=0.0_wp)
      allocate (q%is_proved(size(b%list)), source=.false.)
   end function new_placed

   !> Proves position, velocity and acceleration of the blocks `list`, in solving order, at the time `t` and the values
   !> that the engine `e` has found. `is_proved`: of all of them; the first that is not ends the proof. `order`: up to
   !> this derivative alone, 0 to 2.
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
   !> up to `order` (0 to 2), their derivatives. Result: what `q` has of this block, `open` whatever the order.
   subroutine prove_block(p, b, i, order, q)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(placed_t), intent(inout) :: q
      integer :: k

      associate (block => b%list(i), w => p%work(i))
         do k = block%first, block%last
            call bound_values(p%state, b%unknown(k), p%jets)
            q%error(:, b%unknown(k)) = 0.0_wp
         end do
         q%gap(i) = 0.0_wp
         q%is_proved(i) = block%direct .or. allocated(w%a)
         if (block%direct) call prove_direct()
         if (block%direct .or. .not. q%is_proved(i)) return
         call find_residuals(max(1, order), p%state, w%a, w%r)
         do k = 0, max(1, order)
            call bound_rows(p%data, b, i, p%jets, k, w%open)
            w%g(:) = (abs(w%r(:, k)) + w%open)*room
            if (k < 2) q%open(k, block%first_row:block%last_row) = w%g
            if (k > order) exit
            call bound_changes(p%data, b, i, p%jets, k, w%error)
            w%g(:) = (w%g + w%error)*room
            if (k == 0) call prove_values()
            if (k > 0) call bound_derivatives(k)
            if (.not. q%is_proved(i)) return
         end do
      end associate

   contains

      !> Bounds of the motion of unknown `u` as it is in `s`, without errors.
      pure subroutine bound_values(s, u, j)
         type(state_t), intent(in) :: s
         integer, intent(in) :: u
         type(jets_t), intent(inout) :: j

         j%own(0, u) = abs(s%u(u)%value)
         j%own(1, u) = abs(s%u(u)%rate)
         j%own(2, u) = abs(s%u(u)%acceleration)
         j%own_error(:2, u) = 0.0_wp
         if (u > b%orientations) return
         ! See `turn`.
         j%turn(1, u) = j%own(1, u)
         j%turn(2, u) = j%own(1, u)**2 + j%own(2, u)
         j%turn_error(:2, u) = 0.0_wp
      end subroutine bound_values

      !> Derivative `order` of unknown `u` is off by no more than `error`.
      subroutine note_error(u, order, error, j)
         integer, intent(in) :: u, order
         real(wp), intent(in) :: error
         type(jets_t), intent(inout) :: j

         q%error(order, u) = error
         j%own_error(order, u) = error
         if (u <= b%orientations) call note_turn_error(order, j%own(:, u), j%own_error(:, u), j%turn_error(:, u))
      end subroutine note_error

      !> Proves the direct block `i`: its unknown is another one and a drive.
      subroutine prove_direct()
         real(wp) :: x(0:2), given(0:2), known(0:2), size_of(0:2), r(0:2)
         integer :: k

         associate (row => b%rows(b%list(i)%first_row), constant => b%numbers%rows(b%list(i)%first_row)%constant, &
                    u => b%unknown(b%list(i)%first))
            x = [p%state%u(u)%value, p%state%u(u)%rate, p%state%u(u)%acceleration]
            known = [p%state%u(row%other)%value, p%state%u(row%other)%rate, p%state%u(row%other)%acceleration]
            given = p%state%drive_value(:, row%drive)
            given(0) = given(0) + constant
            size_of = abs(x) + abs(known) + p%jets%drive(:, row%drive) + abs(constant)*[1.0_wp, 0.0_wp, 0.0_wp]
            r = abs(x - known - row%sign_of*given) + 4.0_wp*rounding*size_of
            r(0) = r(0) + p%data%constant_weight(b%list(i)%first_row)
            q%open(:, b%list(i)%first_row) = r(:1)*room
            r = (r + p%jets%drive_error(:, row%drive) + q%error(:, row%other))*room
            do k = 0, 2
               call note_error(u, k, r(k), p%jets)
            end do
         end associate
      end subroutine prove_direct

      !> Jacobian `a` (rows, n) of block `i` and what its equations and their derivatives up to `order` (1 or 2) leave,
      !> `r` (rows, 0:2), at the state `s`.
      subroutine find_residuals(order, s, a, r)
         integer, intent(in) :: order
         type(state_t), intent(inout) :: s
         real(wp), intent(out) :: a(b%list(i)%shape%rows, *), r(b%list(i)%shape%rows, 0:2)
         integer :: k

         call find_known_parts(b, i, s)
         call assemble_dense(b, i, s, a, r)
         call right_hand_side(b, i, 1, s, r(:, 1))
         if (order > 1) call right_hand_side(b, i, 2, s, r(:, 2))
         do k = 1, b%list(i)%shape%n
            associate (u => s%u(b%unknown(b%list(i)%first + k - 1)))
               r(:, 1) = r(:, 1) - a(:, k)*u%rate
               if (order > 1) r(:, 2) = r(:, 2) - a(:, k)*u%acceleration
            end associate
         end do
      end subroutine find_residuals

      !> Proves the values of block `i`, whose equations are no larger than its bounds g.
      subroutine prove_values()
         real(wp) :: radius, error
         integer :: k

         call contract_block(p, b, i, p%jets%own_error(0, :), radius, q%gap(i))
         q%is_proved(i) = radius >= 0.0_wp
         if (.not. q%is_proved(i)) return
         associate (w => p%work(i), c => p%work(i)%contraction, own => b%unknown(b%list(i)%first:b%list(i)%last))
            q%norm(i) = c%norm
            q%z1(i) = c%z1
            w%within = 0.0_wp
            do k = 1, size(w%x)
               error = min(radius, (w%x(k) + (c%off(k) + c%z2*radius)*radius)*room)
               w%within = max(w%within, error)
               call note_error(own(k), 0, error, p%jets)
            end do
         end associate
      end subroutine prove_values

      !> Bounds of the errors of the derivatives of one `order` of block `i`, whose equations leave its bounds g.
      subroutine bound_derivatives(order)
         integer, intent(in) :: order
         real(wp) :: largest
         integer :: k

         associate (w => p%work(i), c => p%work(i)%contraction, own => b%unknown(b%list(i)%first:b%list(i)%last))
            call apply_to_bounds(p%rows, w)
            q%is_proved(i) = all(w%x <= huge(1.0_wp))
            largest = max(0.0_wp, maxval(w%x))/(1.0_wp - c%z1 - c%z2*w%within)*room
            do k = 1, size(w%x)
               call note_error(own(k), order, (w%x(k) + (c%off(k) + c%z2*w%within)*largest)*room, p%jets)
            end do
         end associate
      end subroutine bound_derivatives
   end subroutine prove_block

   !> The contraction of block `i`, whose Jacobian was computed at the place at hand and may be off as where unknowns
   !> are `off` (0:unknowns) from there; its equations are no larger than its bounds g. `radius`: of the ball that holds
   !> exactly one solution, -1 where none is proved; `gap`: by how much redundant equations stay open in it at most.
   subroutine contract_block(p, b, i, off, radius, gap)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: off(0:)
      real(wp), intent(out) :: radius, gap

      associate (w => p%work(i), c => p%work(i)%contraction, n => size(p%work(i)%x))
         call bound_jacobian(p%data, b, i, p%jets, off, w%change, w%growth)
         if (size(w%g) > n) then
            call choose_rows(w%a, p%rows)
            call contract(n, w%a(p%rows, :), w%change(p%rows), w%growth(p%rows), c)
         else
            call contract(n, w%a, w%change, w%growth, c)
         end if
         gap = 0.0_wp
         radius = -1.0_wp
         if (.not. c%exists) return
         call apply_to_bounds(p%rows, w)
         ! What is not a number lies in no ball.
         if (all(w%x <= 1.0_wp)) radius = radius_of(c%z1, c%z2, max(0.0_wp, maxval(w%x)))
         if (size(w%g) > n) gap = maxval((w%g + (sum(abs(w%a), dim=2) + w%change + w%growth*radius)*radius)*room)
      end associate
   end subroutine contract_block

   !> `w%x` becomes |A| g, of the equations that are taken: all or `rows` (n).
   pure subroutine apply_to_bounds(rows, w)
      integer, allocatable, intent(in) :: rows(:)
      type(block_work_t), intent(inout) :: w

      if (size(w%g) > size(w%x)) then
         call apply(w%contraction, w%g(rows), w%x)
      else
         call apply(w%contraction, w%g, w%x)
      end if
   end subroutine apply_to_bounds

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
