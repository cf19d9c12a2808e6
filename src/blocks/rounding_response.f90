!> What roundings do to a motion, to first order: all directions of `card_roundings` at once, block by block along the
!> solving order, by the factors of each block's Jacobian at the motion itself,
!>
!>    F_q dq = -F_p dp,
!>    F_q dq' = -(F_q q' + F_t)_q dq - (F_q q' + F_t)_p dp,   and once more for dq''.
!>
!> Numbers on cards are off in the same way wherever they stand. Beside that each sum of the calculation, of a position,
!> velocity or acceleration, is off by the part of a rounding of what it adds up that counts.
!>
!> Not by the exact equations of `linear_response`, one direction at a time: body vectors in `directions` lanes cost as
!> much as half a step. Not by bounds of absolute values from block to block: they grow along a chain as its numbers do
!> not, and are only asked first (`rounding_bounds`).
module rounding_response
   use kinds, only: wp
   use planar, only: rotated
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use blocks, only: row_t, largest_known
   use block_matrix, only: solve_first, solve_again, solve_many
   use block_state, only: new_state
   use block_solver, only: make_workspace, solve_block
   use convergence, only: convergence_t, is_solved
   use block_equations, only: find_known_parts, assemble_block, right_hand_side
   use block_engine, only: block_engine_t
   use link_motion, only: chain_link_t, mark_links, missing_nothing, missing_all
   use drives, only: drive_motion
   use rounding_parts, only: arm_t, gather_rounding_parts, is_plain_dyad, dyad_jacobian
   use rounding_changes, only: rounding_response_t, change_parts, change_slide, max_part
   use rounding_residuals, only: find_residuals, change_of_constant
   use card_roundings, only: directions, roundings, add_own, parts_of_any, law_tables, drive_changes, &
      own_in_tables
   implicit none
   private
   public :: rounding_response_t, make_rounding_response, respond_to_roundings

   !> From its own position an iteration would end at once, and show nothing of the residual that is left there.
   real(wp), parameter :: nudge = 0.0625_wp*sqrt(epsilon(1.0_wp))

contains

   !> Ready for the roundings of `m`, which `e` solves.
   subroutine make_rounding_response(r, m, e)
      type(rounding_response_t), intent(out) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      real(wp) :: angle(size(m%links))
      integer :: i, rows, loops

      r%state = new_state(e%blocks, size(m%drives))
      call make_workspace(r%work, e%blocks)
      angle = m%links%position(3)
      allocate (r%pair_of(e%blocks%unknowns), source=0)
      do i = 1, size(e%whole%links)
         associate (h => e%whole%links(i))
            angle(h%link) = h%angle_offset
            if (h%slide > 0) r%pair_of(h%slide) = h%pair
         end associate
      end do
      call gather_rounding_parts(r%parts, m, e, angle)
      call law_tables(m, r%tables)
      allocate (r%drive(directions, 0:2, 0:size(m%drives)), r%u(directions, 0:2, 0:e%blocks%unknowns), source=0.0_wp)
      allocate (r%missing(0:e%blocks%unknowns), source=missing_nothing)
      rows = max(1, maxval(e%blocks%list%shape%rows))
      loops = max(1, maxval(e%blocks%list%last_loop - e%blocks%list%first_loop + 1))
      allocate (r%v(directions, rows), r%row_size(rows), r%g(directions, 2, 0:2, loops), r%loop_size(0:2, loops), &
         source=0.0_wp)
   end subroutine make_rounding_response

   !> The changes `links` (directions, 3, 0:2, links) of the motion `q` of `m` at `r%state`, which `e` has solved for
   !> or, `again`, at the state to which its blocks are solved from there, to the limit of rounding. `only_driven`: no
   !> more is known than what drives alone move. `lost` (links): nothing is known of their changes, which stay.
   subroutine respond_to_roundings(r, m, e, q, only_driven, again, links, lost)
      type(rounding_response_t), intent(inout) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      logical, intent(in) :: only_driven, again
      real(wp), contiguous, intent(inout) :: links(:, :, 0:, :)
      logical, intent(out) :: lost(:)
      type(motion_t) :: marked
      integer :: k
      logical :: is_found, is_singular, some_missing
      real(wp) :: inverse

      some_missing = .false.
      do k = 1, size(e%laws)
         call set_sum(r%drive(:, :, 0), e%unit_of(k), drive_changes(e%laws(k), k, q%t, r%own, r%tables), &
            r%drive(:, :, k))
         if (again) r%state%drive_value(0:2, k) = drive_motion(e%laws(k), q%t)*e%unit_of(k)
      end do
      r%missing = missing_nothing
      do k = 1, size(e%needed)
         associate (i => e%needed(k), block => e%blocks%list(e%needed(k)))
            is_found = block%direct .or. .not. only_driven
            if (some_missing) is_found = is_found .and. largest_known(e%blocks, i, r%missing) == missing_nothing
            inverse = e%found(i)%inverse
            is_singular = e%is_singular(i)
            ! A singular position stays: beside it the Jacobian has an inverse.
            if (again .and. .not. is_singular) r%state%u(e%blocks%unknown(block%first:block%last))%value &
               = r%state%u(e%blocks%unknown(block%first:block%last))%value + nudge
            if (is_found .and. again) call solve_block_again(i)
            if (is_found .and. block%direct) then
               call respond_direct(r, e%blocks%rows(block%first_row), &
                  e%blocks%numbers%rows(block%first_row)%constant, e%blocks%unknown(block%first))
            else if (is_found .and. block%shape%n > 0) then
               call respond_block(r, m, e, i, again, is_singular, inverse, is_found)
            end if
            if (.not. is_found) r%missing(e%blocks%unknown(block%first:block%last)) = missing_all
            some_missing = some_missing .or. .not. is_found
         end associate
      end do
      lost = .false.
      if (some_missing) then
         marked = new_motion(size(m%links))
         call mark_links(e%chain, r%missing, marked)
         lost = marked%link_known < 2
      end if
      do k = 1, size(e%chain%ground)
         links(:, :, :, e%chain%ground(k)) = 0.0_wp
      end do
      do k = 1, size(e%chain%links)
         associate (h => e%chain%links(k), i => e%chain%links(k)%link)
            if (.not. lost(i)) call move_link(r, h, r%parts%arms(k), e%length, q%position(:, i), q%velocity(:, i), &
               q%acceleration(:, i), links)
         end associate
      end do

   contains

      !> Solves block `i` from where `r%state` is. `inverse`: of its Jacobian, in the maximum norm; `is_singular`: it
      !> has none.
      subroutine solve_block_again(i)
         integer, intent(in) :: i
         type(convergence_t) :: c

         call solve_block(e%blocks, i, 0.0_wp, r%work, r%state, c)
         inverse = c%inverse
         is_singular = c%singular
         is_found = is_solved(c) .and. .not. c%rates_open
      end subroutine solve_block_again
   end subroutine respond_to_roundings

   !> The response of unknown number `u` of a direct block with this `row` and `constant`:
   !> u = other + sign_of (constant + value).
   pure subroutine respond_direct(r, row, constant, u)
      type(rounding_response_t), intent(inout) :: r
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: constant
      integer, intent(in) :: u
      real(wp) :: change(directions)

      call set_sum(r%u(:, :, row%other), real(row%sign_of, wp), r%drive(:, :, row%drive), r%u(:, :, u))
      if (abs(constant) > 0.0_wp) then
         change = change_of_constant(row, constant)
         r%u(:, 0, u) = r%u(:, 0, u) + row%sign_of*change
      end if
      call add_own(r%own*r%state%u(u)%value, u, r%u(:, 0, u))
      call add_own(r%own*r%state%u(u)%rate, u + 1, r%u(:, 1, u))
      call add_own(r%own*r%state%u(u)%acceleration, u + 2, r%u(:, 2, u))
   end subroutine respond_direct

   !> `z` = `x` + `times` `y`, of changes (directions, 0:2).
   pure subroutine set_sum(x, times, y, z)
      real(wp), intent(in) :: x(3*directions), times, y(3*directions)
      real(wp), intent(inout) :: z(3*directions)

      z = x + times*y
   end subroutine set_sum

   !> The response of block `i`, whose Jacobian has the `inverse` (maximum norm). `is_found`: the changes are small
   !> enough. Where the Jacobian `is_singular`, a position changes with the root of what the equations change by,
   !> which are about as curved as their units are long, no two unknowns alike: what is the difference of two changes
   !> as well. Rates have no response there. `again`: two equations are solved by their factors as well.
   subroutine respond_block(r, m, e, i, again, is_singular, inverse, is_found)
      type(rounding_response_t), intent(inout) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i
      logical, intent(in) :: again, is_singular
      real(wp), intent(in) :: inverse
      logical, intent(out) :: is_found
      real(wp), allocatable :: jacobian(:, :)
      integer :: order, k, info
      logical :: is_dyad

      associate (block => e%blocks%list(i), shape => e%blocks%list(i)%shape, w => r%work)
         is_found = .true.
         do k = block%first, block%last
            r%u(:, :, e%blocks%unknown(k)) = 0.0_wp
         end do
         is_dyad = shape%n == 2 .and. shape%rows == 2 .and. .not. (again .or. is_singular)
         if (is_dyad .and. is_plain_dyad(r%parts, e%blocks, block)) then
            associate (own => e%blocks%loops(block%first_loop)%first_own)
               call dyad_jacobian(e%blocks%body_vectors(own), e%blocks%numbers%d(own), r%state%u, w%a)
            end associate
         else
            call find_known_parts(e%blocks, i, r%state)
            call assemble_block(e%blocks, i, r%state, w%a, w%r)
         end if
         info = 0
         if (shape%rows > shape%n) jacobian = reshape(w%a(:shape%rows*shape%n), [shape%rows, shape%n])
         if (is_dyad) then
            if (abs(w%a(1)*w%a(4) - w%a(2)*w%a(3)) <= 0.0_wp) info = 1
         else if (.not. is_singular) then
            call solve_first(shape, w%a, w%sparse(shape%pattern), w%pivots, w%work, w%r, info)
         end if
         if (allocated(jacobian) .and. .not. is_singular .and. info == 0) call refine_rates(r, e, i, jacobian)
         do order = 0, merge(0, 2, is_singular .or. info > 0)
            call find_residuals(r, m, e%blocks, block, order)
            if (is_singular .or. info > 0) then
               call take_roots(shape%n, shape%rows, e%blocks%unknown(block%first:block%last), r%v)
            else if (is_dyad) then
               call solve_two(w%a, r%v)
            else
               call solve_many(shape, w%a, w%sparse(shape%pattern), w%pivots, w%work, directions, r%v)
            end if
            if (order == 0 .and. .not. (is_singular .or. info > 0)) &
               is_found = largest_of(directions*shape%n, r%v)*e%blocks%numbers%blocks(i)%lipschitz*inverse &
                  <= max_part*roundings
            do k = 1, shape%n
               call copy(r%v(:, k), r%u(:, order, e%blocks%unknown(block%first + k - 1)))
            end do
         end do
      end associate
   end subroutine respond_block

   !> The largest size of the `n` numbers of `x`.
   pure real(wp) function largest_of(n, x) result(largest)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n)
      integer :: k

      largest = 0.0_wp
      do k = 1, n
         largest = max(largest, abs(x(k)))
      end do
   end function largest_of

   !> `y` = `x` (directions).
   pure subroutine copy(x, y)
      real(wp), intent(in) :: x(directions)
      real(wp), intent(inout) :: y(directions)

      y = x
   end subroutine copy

   !> The changes `v` (directions, rows) of the `rows` of equations become those of the `n` unknowns with the numbers
   !> `unknown`.
   pure subroutine take_roots(n, rows, unknown, v)
      integer, intent(in) :: n, rows, unknown(n)
      real(wp), intent(inout) :: v(directions, *)
      real(wp) :: root
      integer :: k

      root = roundings*sqrt(largest_of(directions*rows, v)/roundings)
      do k = 1, n
         v(:, k) = root*parts_of_any(unknown(k))
      end do
   end subroutine take_roots

   !> The rates of block `i` again, by iterative refinement with the factors of its `jacobian`. Orthogonal factors
   !> leave errors by the largest of all rows; one pass leaves those of each row (Higham, Accuracy and Stability of
   !> Numerical Algorithms, 2002, ch. 20).
   subroutine refine_rates(r, e, i, jacobian)
      type(rounding_response_t), intent(inout) :: r
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i
      real(wp), intent(in) :: jacobian(:, :)
      integer :: order, k

      associate (block => e%blocks%list(i), shape => e%blocks%list(i)%shape, w => r%work)
         do order = 1, 2
            call right_hand_side(e%blocks, i, order, r%state, w%r)
            do k = 1, shape%n
               associate (u => r%state%u(e%blocks%unknown(block%first + k - 1)))
                  w%r(:shape%rows) = w%r(:shape%rows) - merge(u%rate, u%acceleration, order == 1)*jacobian(:, k)
               end associate
            end do
            call solve_again(shape, w%a, w%sparse(shape%pattern), w%pivots, w%work, w%r)
            do k = 1, shape%n
               associate (u => r%state%u(e%blocks%unknown(block%first + k - 1)))
                  if (order == 1) u%rate = u%rate + w%r(k)
                  if (order == 2) u%acceleration = u%acceleration + w%r(k)
               end associate
            end do
         end do
      end associate
   end subroutine refine_rates

   !> Solves the two equations whose matrix is `a` (4, by columns) for the right-hand sides `v` (directions, 2): by
   !> its inverse, in a part of the time that factors take. Errors need no more than their first digits.
   pure subroutine solve_two(a, v)
      real(wp), intent(in) :: a(4)
      real(wp), intent(inout) :: v(directions, 2)
      real(wp) :: b(4), first
      integer :: k

      b = a/(a(1)*a(4) - a(2)*a(3))
      do k = 1, directions
         first = b(4)*v(k, 1) - b(3)*v(k, 2)
         v(k, 2) = b(1)*v(k, 2) - b(2)*v(k, 1)
         v(k, 1) = first
      end do
   end subroutine solve_two

   !> The changes of the link of `h`, which hangs on its parent by `arm`, in `links` (directions, 3, 0:2, links), those
   !> of its parent known; `p`, `v` and `a` (3): its place and the derivatives. `length`: the unit of the blocks.
   pure subroutine move_link(r, h, arm, length, p, v, a, links)
      type(rounding_response_t), intent(in) :: r
      type(chain_link_t), intent(in) :: h
      type(arm_t), intent(in) :: arm
      real(wp), intent(in) :: length, p(3), v(3), a(3)
      real(wp), intent(inout) :: links(directions, 3, 0:2, *)
      real(wp) :: g(directions, 2, 0:2), size_of(0:2)
      integer :: c, k

      g = 0.0_wp
      size_of = 0.0_wp
      if (h%parent > 0) g = links(:, :2, :, h%parent)
      if (h%root > 0) then
         do c = 1, 2
            g(:, c, :) = length*h%root_unit(c)*r%u(:, :, h%root + c - 1)
         end do
      else
         call change_parts(1, arm%count, arm%parts, r%state%u, r%u, g, size_of)
         if (h%slide > 0) call change_slide(length*h%place%slide_body_vector, r%pair_of(h%slide), &
            r%state%u(h%parent_orientation), r%state%u(h%slide), r%u(:, :, h%parent_orientation), r%u(:, :, h%slide), &
            g, size_of)
      end if
      ! In tables a row is off by more than a rounding of its numbers, whatever these are off by.
      if (r%own > own_in_tables) then
         do c = 1, 2
            call add_own(r%own*p(c), 6*h%link + c, g(:, c, 0))
            call add_own(r%own*v(c), 6*h%link + 2 + c, g(:, c, 1))
            call add_own(r%own*a(c), 6*h%link + 4 + c, g(:, c, 2))
         end do
      end if
      do k = 0, 2
         links(:, :2, k, h%link) = g(:, :, k)
         links(:, 3, k, h%link) = r%u(:, k, h%orientation)
      end do
   end subroutine move_link
end module rounding_response
