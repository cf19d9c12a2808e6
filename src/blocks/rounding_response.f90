!> What roundings do to a motion, to first order: all directions of `card_roundings` at once, block by block along the
!> solving order, by the factors of each block's Jacobian at the motion itself,
!>
!>    F_q dq = -F_p dp,
!>    F_q dq' = -(F_q q' + F_t)_q dq - (F_q q' + F_t)_p dp,   and once more for dq''.
!>
!> Numbers on cards are off in the same way wherever they stand. Beside that each sum of the calculation, of a position,
!> velocity or acceleration, is off by a rounding of what it adds up.
!>
!> Not by the exact equations of `linear_response`, one direction at a time: body vectors in `directions` lanes cost as
!> much as half a step. Not by bounds of absolute values from block to block: they grow along a chain as its numbers do
!> not, and are only asked first (`rounding_bounds`).
module rounding_response
   use kinds, only: wp
   use planar, only: rotated
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use blocks, only: row_t, loop_components, loop_projection, largest_known
   use block_matrix, only: solve_first, solve_again, solve_many
   use block_state, only: new_state, find_known_parts
   use block_solver, only: make_workspace, solve_block
   use convergence, only: convergence_t, is_solved
   use block_equations, only: assemble_block, right_hand_side
   use block_engine, only: block_engine_t
   use link_motion, only: chain_link_t, mark_links, missing_nothing, missing_all
   use drives, only: drive_motion
   use rounding_changes, only: rounding_response_t, change_loop, change_projection, change_vector, change_slide, &
      change_card, max_part
   use card_roundings, only: directions, rounding, roundings, number_pair, number_drive, parts_of_number, &
      add_own, parts_of_any, card_sizes, card_changes, law_tables, drive_changes
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
      class(block_engine_t), intent(in) :: e
      real(wp) :: angle(size(m%links))
      integer :: i

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
      r%sizes = card_sizes(m, angle)
      r%cards = card_changes(m, r%sizes)
      r%turned_by = e%orientation_of(m%points([(i, i=1, size(m%points)), m%pairs%point_i])%link)
      do i = 1, size(r%sizes)
         if (.not. (r%sizes(i) > 0.0_wp .or. any(abs(r%cards(:, :, i)) > 0.0_wp))) r%turned_by(i) = -1
      end do
      call law_tables(m, r%tables)
      allocate (r%drive(directions, 0:2, 0:size(m%drives)), r%u(directions, 0:2, 0:e%blocks%unknowns), source=0.0_wp)
      allocate (r%missing(0:e%blocks%unknowns), source=missing_nothing)
   end subroutine make_rounding_response

   !> The changes `links` (directions, 3, 0:2, links) of the motion `q` of `m` at `r%state`, which `e` has solved for
   !> or, `again`, at the state to which its blocks are solved from there, to the limit of rounding. `only_driven`: no
   !> more is known than what drives alone move. `lost` (links): nothing is known of their changes.
   subroutine respond_to_roundings(r, m, e, q, only_driven, again, links, lost)
      type(rounding_response_t), intent(inout) :: r
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      logical, intent(in) :: only_driven, again
      real(wp), contiguous, intent(out) :: links(:, :, 0:, :)
      logical, intent(out) :: lost(:)
      type(motion_t) :: marked
      integer :: k
      logical :: is_found, is_singular, some_missing
      real(wp) :: inverse

      some_missing = .false.
      do k = 1, size(e%laws)
         r%drive(:, :, k) = drive_changes(e%laws(k), k, q%t, r%tables)*e%unit_of(k)
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
               call respond_direct(i)
            else if (is_found) then
               call respond_block(i)
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
      call move_links()

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

      !> The response of the direct block `i`: unknown = other + sign_of (constant + value).
      subroutine respond_direct(i)
         integer, intent(in) :: i

         associate (row => e%blocks%rows(e%blocks%list(i)%first_row), u => e%blocks%unknown(e%blocks%list(i)%first))
            r%u(:, :, u) = r%u(:, :, row%other) + row%sign_of*r%drive(:, :, row%drive)
            if (abs(row%constant) > 0.0_wp) r%u(:, 0, u) = r%u(:, 0, u) + row%sign_of*change_of_constant(row)
            call add_own(r%state%u(u)%value, u, r%u(:, 0, u))
            call add_own(r%state%u(u)%rate, u + 1, r%u(:, 1, u))
            call add_own(r%state%u(u)%acceleration, u + 2, r%u(:, 2, u))
         end associate
      end subroutine respond_direct

      !> By how much the constant of `row` is off (directions): a sum of angles of the deck, or the offset of a guide.
      pure function change_of_constant(row) result(change)
         type(row_t), intent(in) :: row
         real(wp) :: change(directions)

         change = rounding*abs(row%constant)*parts_of_number(merge(number_drive, number_pair, row%drive > 0), &
            max(row%drive, row%pair), 0)
      end function change_of_constant

      !> The response of block `i`, whose Jacobian has the `inverse` (maximum norm). `is_found`: the changes are small
      !> enough. Where the Jacobian `is_singular`, a position changes with the root of what the equations change by,
      !> which are about as curved as their units are long, no two unknowns alike: what is the difference of two changes
      !> as well. Rates have no response there.
      subroutine respond_block(i)
         integer, intent(in) :: i
         real(wp) :: v(directions, max(1, e%blocks%list(i)%shape%rows)), root
         real(wp), allocatable :: jacobian(:, :)
         integer :: order, k, info
         logical :: is_dyad

         associate (block => e%blocks%list(i), shape => e%blocks%list(i)%shape, w => r%work)
            is_found = .true.
            if (shape%n == 0) return
            do k = block%first, block%last
               r%u(:, :, e%blocks%unknown(k)) = 0.0_wp
            end do
            call find_known_parts(e%blocks, i, r%state)
            call assemble_block(e%blocks, i, r%state, w%a, w%r)
            info = 0
            if (shape%rows > shape%n) jacobian = reshape(w%a(:shape%rows*shape%n), [shape%rows, shape%n])
            is_dyad = shape%n == 2 .and. shape%rows == 2 .and. .not. (again .or. is_singular)
            if (is_dyad) then
               if (abs(w%a(1)*w%a(4) - w%a(2)*w%a(3)) <= 0.0_wp) info = 1
            else if (.not. is_singular) then
               call solve_first(shape, w%a, w%sparse(shape%pattern), w%pivots, w%work, w%r, info)
            end if
            if (allocated(jacobian) .and. .not. is_singular .and. info == 0) call refine_rates(e, i, jacobian)
            do order = 0, merge(0, 2, is_singular .or. info > 0)
               call find_residuals(e, i, order, v)
               if (is_singular .or. info > 0) then
                  root = roundings*sqrt(maxval(abs(v))/roundings)
                  do k = 1, shape%n
                     v(:, k) = root*parts_of_any(e%blocks%unknown(block%first + k - 1))
                  end do
               else
                  if (is_dyad) then
                     call solve_two(w%a, v)
                  else
                     call solve_many(shape, w%a, w%sparse(shape%pattern), w%pivots, w%work, directions, v)
                  end if
                  if (order == 0) is_found = maxval(abs(v(:, :shape%n)))*block%lipschitz*inverse <= max_part*roundings
               end if
               do k = 1, shape%n
                  r%u(:, order, e%blocks%unknown(block%first + k - 1)) = v(:, k)
               end do
            end do
         end associate
      end subroutine respond_block

      !> The rates of block `i` again, by iterative refinement with the factors of its `jacobian`. Orthogonal factors
      !> leave errors by the largest of all rows; one pass leaves those of each row (Higham, Accuracy and Stability of
      !> Numerical Algorithms, 2002, ch. 20).
      subroutine refine_rates(e, i, jacobian)
         class(block_engine_t), intent(in) :: e
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

      !> `v` (directions, rows): derivative number `order` of the changes of the equations of block `i`, with the other
      !> sign, as far as they are known.
      subroutine find_residuals(e, i, order, v)
         class(block_engine_t), intent(in) :: e
         integer, intent(in) :: i, order
         real(wp), contiguous, intent(out) :: v(:, :)
         real(wp) :: g(directions, 2), sizes(size(v, 2)), size_of
         integer :: k, row

         sizes = 0.0_wp
         associate (b => e%blocks, block => e%blocks%list(i))
            do k = block%first_loop, block%last_loop
               associate (loop => e%blocks%loops(k))
                  select case (loop%kind)
                  case (loop_components)
                     call change_loop(r, m, e, loop, order, g, size_of)
                     if (loop%row_x > 0) v(:, loop%row_x) = -g(:, 1)
                     if (loop%row_y > 0) v(:, loop%row_y) = -g(:, 2)
                     if (loop%row_x > 0) sizes(loop%row_x) = size_of
                     if (loop%row_y > 0) sizes(loop%row_y) = size_of
                  case (loop_projection)
                     associate (row => b%rows(block%first_row + loop%row_x - 1))
                        call change_projection(r, m, e, k, guide_of(row%pair, row%drive), order, v(:, loop%row_x), &
                           sizes(loop%row_x))
                     end associate
                  case default
                     v(:, loop%row_x) = r%u(:, order, loop%less) - r%u(:, order, loop%orientation)
                  end select
               end associate
            end do
            ! Orthogonal factors mix all rows.
            if (block%shape%rows > block%shape%n) sizes = maxval(sizes)
            do k = block%first_row, block%last_row
               row = k - block%first_row + 1
               v(:, row) = v(:, row) + r%drive(:, order, b%rows(k)%drive)
               call add_own(sizes(row), 3*k + order, v(:, row))
               if (order == 0 .and. abs(b%rows(k)%constant) > 0.0_wp) &
                  v(:, row) = v(:, row) + change_of_constant(b%rows(k))
            end do
         end associate
      end subroutine find_residuals

      !> The prismatic pair on whose guide `pair`, or if that is 0 the slide of `drive`, is measured.
      pure integer function guide_of(pair, drive)
         integer, intent(in) :: pair, drive

         guide_of = pair
         if (pair == 0) guide_of = m%drives(drive)%subject
      end function guide_of

      !> The changes `links` (directions, 3, 0:2, links) of the motion `q` of the links that are not `lost`, along the
      !> tree.
      subroutine move_links()
         integer :: i, k

         do i = 1, size(e%chain%ground)
            links(:, :, :, e%chain%ground(i)) = 0.0_wp
         end do
         do i = 1, size(e%chain%links)
            associate (h => e%chain%links(i))
               if (lost(h%link)) cycle
               call move_link(r, m, e, h, q, links)
               do k = 0, 2
                  links(:, 3, k, h%link) = r%u(:, k, h%orientation)
               end do
            end associate
         end do
      end subroutine move_links
   end subroutine respond_to_roundings

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

   !> The changes of the place of the link of `h` in `links`, those of its parent known.
   subroutine move_link(r, m, e, h, q, links)
      type(rounding_response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      type(chain_link_t), intent(in) :: h
      type(motion_t), intent(in) :: q
      real(wp), contiguous, intent(inout) :: links(:, :, 0:, :)
      real(wp) :: g(directions, 2), size_of
      integer :: order, own, c

      do order = 0, 2
         g = 0.0_wp
         size_of = 0.0_wp
         if (h%parent > 0) g = links(:, :2, order, h%parent)
         if (h%root > 0) then
            do c = 1, 2
               g(:, c) = e%length*h%root_unit(c)*r%u(:, order, h%root + c - 1)
            end do
         else
            own = merge(m%pairs(h%pair)%point_i, m%pairs(h%pair)%point_j, &
               m%points(m%pairs(h%pair)%point_i)%link == h%link)
            call add_arm(h%place%reach, h%parent_orientation)
            call change_card(r, m, order, m%pairs(h%pair)%point_i + m%pairs(h%pair)%point_j - own, 0, 1.0_wp, g, &
               size_of)
            call add_arm(-h%place%body_vector, h%orientation)
            call change_card(r, m, order, -own, 0, 1.0_wp, g, size_of)
            if (h%slide > 0) then
               call change_slide(r, order, e%length*h%place%slide_body_vector, h%parent_orientation, h%slide, g, &
                  size_of)
               call change_card(r, m, order, 0, merge(1, -1, own == m%pairs(h%pair)%point_i)*h%pair, 1.0_wp, g, &
                  size_of)
            end if
         end if
         do c = 1, 2
            links(:, c, order, h%link) = g(:, c)
            call add_own(place(c), 6*h%link + 2*order + c, links(:, c, order, h%link))
         end do
      end do

   contains

      !> Adds what the angle of `orientation` changes of the vector `d` (2) in its axes.
      subroutine add_arm(d, orientation)
         real(wp), intent(in) :: d(2)
         integer, intent(in) :: orientation

         if (.not. sum(abs(d)) > 0.0_wp) return
         associate (f => r%state%u(orientation))
            call change_vector(order, rotated(d, [f%c, f%s]), f%rate, f%acceleration, r%u(:, :, orientation), g)
         end associate
      end subroutine add_arm

      !> Coordinate `c` of the place of the link, or its derivative.
      real(wp) function place(c)
         integer, intent(in) :: c

         select case (order)
         case (0)
            place = q%position(c, h%link)
         case (1)
            place = q%velocity(c, h%link)
         case default
            place = q%acceleration(c, h%link)
         end select
      end function place
   end subroutine move_link
end module rounding_response
