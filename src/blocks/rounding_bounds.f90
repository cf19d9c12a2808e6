!> Bounds of what roundings change in a motion, by absolute values: no direction of `rounding_response` changes a
!> number by more, where of the calculation's own roundings the part counts that does in tables. Along the solving order
!> as there,
!>
!>    |dq| <= |J^-1| |F_p dp|,   |dq'| <= |J^-1| (|(F_q q' + F_t)_q dq| + |(F_q q' + F_t)_p dp|),
!>
!> and once more for dq'', sums of vectors by their lengths: each procedure takes one by one the terms of the one of the
!> response that it names. Along a chain and through wide blocks bounds grow as the numbers do not: they can say that
!> digits are safe, not how many are lost.
module rounding_bounds
   use kinds, only: wp
   use planar, only: length_of
   use motion, only: motion_t
   use blocks, only: blocks_t, block_t, row_t, loop_projection, loop_angles
   use block_state, only: state_t, unknown_t
   use block_engine, only: block_engine_t
   use link_motion, only: chain_link_t
   use rounding_changes, only: rounding_response_t, closure_motion, max_part
   use bound_weights, only: find_weights
   use rounding_parts, only: part_t, arm_t, rounding_parts_t, own_part
   use card_roundings, only: largest_part, drive_bounds
   implicit none
   private
   public :: rounding_bounds_t, make_rounding_bounds, bound_roundings, bound_of_turning, bound_of_product

   !> Bounds are larger by this than they are calculated to be, for what is rounded there, and for a change of a drive
   !> by the time that is not quite its rate.
   real(wp), parameter, public :: room = 1.01_wp
   !> What the rounding of an angle on a card changes of it, over its size.
   real(wp), parameter :: angle_part = largest_part*epsilon(1.0_wp)

   type :: rounding_bounds_t
      real(wp), allocatable :: weights(:), inverse(:), change(:), known(:)   !< room for the widest block
      real(wp), allocatable :: drive(:, :)       !< (0:2, 0:drives) as the state has them
      real(wp), allocatable :: u(:, :)           !< (0:2, 0:unknowns) of values, rates and accelerations
      real(wp), allocatable :: place(:, :)       !< (0:2, 0:links) of the length of a place's change, in the deck's unit
   end type rounding_bounds_t

contains

   !> Room for the bounds of any motion of a mechanism with so many `links`, which `e` solves.
   subroutine make_rounding_bounds(b, links, e)
      type(rounding_bounds_t), intent(out) :: b
      integer, intent(in) :: links
      type(block_engine_t), intent(in) :: e
      integer :: i, n

      n = 1
      do i = 1, size(e%blocks%list)
         if (can_be_bound(e%blocks%list(i))) n = max(n, e%blocks%list(i)%shape%n)
      end do
      allocate (b%weights(n**2), b%inverse(n**2), b%change(n), b%known(3*n))
      allocate (b%drive(0:2, 0:size(e%laws)), b%u(0:2, 0:e%blocks%unknowns), b%place(0:2, 0:links), source=0.0_wp)
   end subroutine make_rounding_bounds

   !> The inverse of the Jacobian of `block` takes less time than an estimate would.
   pure logical function can_be_bound(block)
      type(block_t), intent(in) :: block

      can_be_bound = block%shape%pattern == 0 .and. block%shape%rows == block%shape%n
   end function can_be_bound

   !> The bounds `b` at the motion `q`, which `e` has found; `r%state` is there. `is_bound`: there are some. Otherwise a
   !> block is wide, singular or has too many rows, or the first order may not hold.
   subroutine bound_roundings(b, r, e, q, is_bound)
      type(rounding_bounds_t), intent(inout) :: b
      type(rounding_response_t), intent(inout) :: r
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      logical, intent(out) :: is_bound
      integer :: k

      is_bound = .false.
      do k = 1, size(e%needed)
         if (e%is_singular(e%needed(k)) .or. .not. can_be_bound(e%blocks%list(e%needed(k)))) return
      end do
      do k = 1, size(e%laws)
         b%drive(:, k) = drive_bounds(e%laws(k), k, q%t, r%tables)*e%unit_of(k)
      end do
      do k = 1, size(e%needed)
         associate (i => e%needed(k), block => e%blocks%list(e%needed(k)))
            if (block%direct) then
               call bound_direct(b, e%blocks, i, r%state%u)
            else if (block%shape%n > 0) then
               call find_weights(r, e, i, block%shape%n, r%parts%first_own(block%first_loop), b%inverse, b%weights, &
                  is_bound)
               if (is_bound) call bound_block(b, r%parts, r%state, e%blocks, block, &
                  e%blocks%numbers%blocks(i)%lipschitz, block%shape%n, e%found(i)%inverse, b%weights, b%change, &
                  b%known, is_bound)
               if (.not. is_bound) return
            end if
         end associate
      end do
      call bound_places(size(e%chain%links), e%chain%links, r%parts%arms, r%state%u, b%u, e%length, q%position, &
         q%velocity, q%acceleration, b%place)
      is_bound = .true.
   end subroutine bound_roundings

   !> Of the unknown of the direct block `i`: see `respond_direct`.
   pure subroutine bound_direct(b, blocks, i, u)
      type(rounding_bounds_t), intent(inout) :: b
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: i
      type(unknown_t), intent(in) :: u(0:)
      integer :: k

      k = blocks%unknown(blocks%list(i)%first)
      associate (row => blocks%rows(blocks%list(i)%first_row), &
                 constant => blocks%numbers%rows(blocks%list(i)%first_row)%constant)
         b%u(0, k) = b%u(0, row%other) + b%drive(0, row%drive) + own_part*abs(u(k)%value) + angle_part*abs(constant)
         b%u(1, k) = b%u(1, row%other) + b%drive(1, row%drive) + own_part*abs(u(k)%rate)
         b%u(2, k) = b%u(2, row%other) + b%drive(2, row%drive) + own_part*abs(u(k)%acceleration)
      end associate
   end subroutine bound_direct

   !> Of the `n` unknowns of `block`: see `respond_block`. By the `weights` (n, loops) of its loops; `known` (0:2,
   !> loops) is room. `is_bound`: changes are small enough, by the `inverse` of the Jacobian (maximum norm).
   pure subroutine bound_block(b, p, s, blocks, block, lipschitz, n, inverse, weights, change, known, is_bound)
      type(rounding_bounds_t), intent(inout) :: b
      type(rounding_parts_t), intent(in) :: p
      type(state_t), intent(in) :: s
      type(blocks_t), intent(in) :: blocks
      type(block_t), intent(in) :: block
      integer, intent(in) :: n
      real(wp), intent(in) :: lipschitz, inverse, weights(n, *)
      real(wp), intent(inout) :: change(n), known(0:2, *)
      logical, intent(out) :: is_bound
      real(wp) :: vector(0:2)
      integer :: order, k, j, u

      do k = 1, n
         b%u(:, blocks%unknown(block%first + k - 1)) = 0.0_wp
      end do
      is_bound = .true.
      do order = 0, 2
         do k = block%first_loop, block%last_loop
            j = k - block%first_loop + 1
            ! What is known already of the block's own unknowns turns its own vectors; all else is as it was.
            if (order == 0 .or. .not. p%is_plain(k)) call bound_loop(b, p, s, blocks, block%first_row, k, known(:, j))
            vector = known(:, j)
            if (order > 0 .and. p%is_plain(k)) call add_own_vectors(p%first_own(k), p%first(k + 1) - 1, p%parts, s%u, &
               b%u, vector)
            do u = 1, n
               if (j == 1) change(u) = vector(order)*weights(u, j)
               if (j > 1) change(u) = change(u) + vector(order)*weights(u, j)
            end do
         end do
         do k = 1, n
            b%u(order, blocks%unknown(block%first + k - 1)) = change(k)
            if (order == 0) is_bound = is_bound .and. change(k)*(lipschitz*inverse) <= max_part
         end do
      end do
   end subroutine bound_block

   !> Of what is known of loop number `k`, or of its projection, and of the drives and constants of its rows, of the
   !> block whose rows begin at `first_row`: derivatives (0:2), see `find_residuals`.
   pure subroutine bound_loop(b, p, s, blocks, first_row, k, bound)
      type(rounding_bounds_t), intent(in) :: b
      type(rounding_parts_t), intent(in) :: p
      type(state_t), intent(in) :: s
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: first_row, k
      real(wp), intent(out) :: bound(0:2)
      integer :: i

      associate (loop => blocks%loops(k))
         if (loop%kind == loop_angles) then
            bound = b%u(:, loop%less) + b%u(:, loop%orientation)
         else
            bound = 0.0_wp
            call add_parts(p%first(k), p%first(k + 1) - 1, p%parts, s%u, b%u, bound)
            do i = loop%first_slide, loop%last_slide
               associate (d => blocks%slides(i))
                  bound = bound + length_of(blocks%numbers%e(i))*bound_of_slide(s%u(d%orientation), s%u(d%unknown), &
                     b%u(:, d%orientation), b%u(:, d%unknown))
               end associate
            end do
            if (loop%kind == loop_projection) call project(b, s, blocks, k, bound)
         end if
         if (loop%row_x > 0) call add_row(blocks, first_row + loop%row_x - 1, b%drive, bound)
         if (loop%row_y > 0) call add_row(blocks, first_row + loop%row_y - 1, b%drive, bound)
      end associate
   end subroutine bound_loop

   !> Adds to `bound` (0:2) that of the constant of row number `row` and of its drive.
   pure subroutine add_row(b, row, drive, bound)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: row
      real(wp), intent(in) :: drive(0:2, 0:*)
      real(wp), intent(inout) :: bound(0:2)

      bound(0) = bound(0) + angle_part*abs(b%numbers%rows(row)%constant)
      if (b%rows(row)%drive > 0) bound = bound + drive(:, b%rows(row)%drive)
   end subroutine add_row

   !> From the `bound` of the change of loop number `k` that of its projection, the product of the closure error and a
   !> direction that turns, and is off as the angle of a pair: see `change_projection`.
   pure subroutine project(b, s, blocks, k, bound)
      type(rounding_bounds_t), intent(in) :: b
      type(state_t), intent(in) :: s
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: k
      real(wp), intent(inout) :: bound(0:2)
      real(wp) :: g(2, 0:2), turn(0:2)

      associate (loop => blocks%loops(k), f => s%u(blocks%loops(k)%orientation))
         g = closure_motion(blocks, k, s)
         turn = b%u(:, loop%orientation) + [angle_part, 0.0_wp, 0.0_wp]
         bound = length_of(blocks%numbers%loops(k)%direction)*bound_of_product( &
            [norm2(g(:, 0)), norm2(g(:, 1)), norm2(g(:, 2))], bound, &
            [1.0_wp, abs(f%rate), abs(f%acceleration) + f%rate**2], bound_of_turning(f%rate, f%acceleration, turn))
      end associate
   end subroutine project

   !> Derivatives (0:2) of the change of the product of two vectors, which are as large as `x` and `y` and change by
   !> `dx` and `dy` (0:2) at most.
   pure function bound_of_product(x, dx, y, dy) result(bound)
      real(wp), intent(in), dimension(0:2) :: x, dx, y, dy
      real(wp) :: bound(0:2)

      bound(0) = x(0)*dy(0) + dx(0)*y(0)
      bound(1) = x(0)*dy(1) + x(1)*dy(0) + dx(0)*y(1) + dx(1)*y(0)
      bound(2) = x(0)*dy(2) + 2.0_wp*x(1)*dy(1) + x(2)*dy(0) + dx(0)*y(2) + 2.0_wp*dx(1)*y(1) + dx(2)*y(0)
   end function bound_of_product

   !> Adds to `bound` (0:2) that of the vectors and cards of `parts` number `first` to `last`, which turn with
   !> orientations among `s` that change by `u`: see `change_vector` and `change_cards`. On plain arrays, which cost no
   !> descriptors.
   pure subroutine add_parts(first, last, parts, s, u, bound)
      integer, intent(in) :: first, last
      type(part_t), intent(in) :: parts(*)
      type(unknown_t), intent(in) :: s(0:*)
      real(wp), intent(in) :: u(0:2, 0:*)
      real(wp), intent(inout) :: bound(0:2)
      real(wp) :: x, v, a, w, e
      integer :: i, k

      x = bound(0)
      v = bound(1)
      a = bound(2)
      do i = first, last
         k = parts(i)%orientation
         w = abs(s(k)%rate)
         e = abs(s(k)%acceleration) + w*w
         x = x + (parts(i)%length*u(0, k) + parts(i)%off)
         v = v + (parts(i)%length*(u(1, k) + w*u(0, k)) + parts(i)%off*w)
         a = a + (parts(i)%length*(u(2, k) + 2.0_wp*w*u(1, k) + e*u(0, k)) + parts(i)%off*e)
      end do
      bound = [x, v, a]
   end subroutine add_parts

   !> The rate and acceleration of the vectors alone, once more, by the changes `u` of their orientations that are
   !> found.
   pure subroutine add_own_vectors(first, last, parts, s, u, bound)
      integer, intent(in) :: first, last
      type(part_t), intent(in) :: parts(*)
      type(unknown_t), intent(in) :: s(0:*)
      real(wp), intent(in) :: u(0:2, 0:*)
      real(wp), intent(inout) :: bound(0:2)
      real(wp) :: w
      integer :: i, k

      do i = first, last
         k = parts(i)%orientation
         w = abs(s(k)%rate)
         bound(1) = bound(1) + parts(i)%length*w*u(0, k)
         bound(2) = bound(2) + parts(i)%length*(2.0_wp*w*u(1, k) + (abs(s(k)%acceleration) + w*w)*u(0, k))
      end do
   end subroutine add_own_vectors

   !> Derivatives (0:2) of the change of a vector of length 1 that turns with `rate` and `acceleration`, its angle
   !> changing by `df` (0:2).
   pure function bound_of_turning(rate, acceleration, df) result(bound)
      real(wp), intent(in) :: rate, acceleration, df(0:2)
      real(wp) :: bound(0:2), w

      w = abs(rate)
      bound(0) = df(0)
      bound(1) = df(1) + w*df(0)
      bound(2) = df(2) + 2.0_wp*w*df(1) + (abs(acceleration) + w*w)*df(0)
   end function bound_of_turning

   !> Derivatives (0:2) of the change of the slide `s` along a vector of length 1 that turns with the angle `f`, where
   !> these change by `ds` and `df` (0:2), and the direction as the angle of its pair; and what is rounded there: see
   !> `change_slide`.
   pure function bound_of_slide(f, s, df, ds) result(bound)
      type(unknown_t), intent(in) :: f, s
      real(wp), intent(in) :: df(0:2), ds(0:2)
      real(wp) :: bound(0:2), f0, v, w, a, x

      f0 = df(0) + angle_part + own_part
      x = abs(s%value)
      v = abs(s%rate)
      w = abs(f%rate)
      a = abs(f%acceleration) + w**2
      bound(0) = ds(0) + x*f0
      bound(1) = ds(1) + w*ds(0) + (v + x*w)*f0 + x*df(1)
      bound(2) = ds(2) + 2.0_wp*w*ds(1) + a*ds(0) + (abs(s%acceleration) + 2.0_wp*v*w + x*a)*f0 &
         + 2.0_wp*(v + x*w)*df(1) + x*df(2)
   end function bound_of_slide

   !> Of the places of the `n` links of a chain, with their `arms`, whose unknowns are `s` and change by `u`: see
   !> `move_link`. `length`: the unit of roots; `p`, `v`, `a`: positions, velocities and accelerations of all links. On
   !> plain arrays.
   pure subroutine bound_places(n, links, arms, s, u, length, p, v, a, place)
      integer, intent(in) :: n
      type(chain_link_t), intent(in) :: links(n)
      type(arm_t), intent(in) :: arms(n)
      type(unknown_t), intent(in) :: s(0:*)
      real(wp), intent(in) :: u(0:2, 0:*), length, p(3, *), v(3, *), a(3, *)
      real(wp), intent(inout) :: place(0:2, 0:*)
      real(wp) :: x(0:2)
      integer :: i

      do i = 1, n
         associate (h => links(i), arm => arms(i), k => links(i)%link)
            x(0) = place(0, h%parent) + own_part*max(abs(p(1, k)), abs(p(2, k)))
            x(1) = place(1, h%parent) + own_part*max(abs(v(1, k)), abs(v(2, k)))
            x(2) = place(2, h%parent) + own_part*max(abs(a(1, k)), abs(a(2, k)))
            if (h%root > 0) then
               x = x + length*(h%root_unit(1)*u(:, h%root) + h%root_unit(2)*u(:, h%root + 1))
            else
               call add_parts(1, arm%count, arm%parts, s, u, x)
               if (h%slide > 0) x = x + arm%slide*bound_of_slide(s(h%parent_orientation), s(h%slide), &
                  u(:, h%parent_orientation), u(:, h%slide))
            end if
            place(:, k) = x
         end associate
      end do
   end subroutine bound_places
end module rounding_bounds
