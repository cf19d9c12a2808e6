!> How the motion changes, to first order, with the numbers of a mechanism: the linear response of all unknowns and
!> links to given directions, which are changes of the numbers on cards. Of position, velocity and acceleration,
!>
!>    F_q dq = -F_p dp,
!>    F_q dq' = -(F_q q' + F_t)_q dq - (F_q q' + F_t)_p dp,   and once more for dq''.
!>
!> Each equation of a block is differentiated exactly, with what earlier blocks and lower orders have found; what is
!> left is solved by the factors of the block's Jacobian, all directions by the same ones.
module linear_response
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_prismatic
   use number_changes, only: change_t
   use links_tree, only: new_tree, axes_t, axes_of
   use loop_equations, only: new_equations
   use blocks, only: row_t, largest_known
   use block_matrix, only: solve_again
   use block_solver, only: solve_block
   use block_engine, only: block_engine_t, slide_units
   use convergence, only: convergence_t, is_solved
   use link_motion, only: missing_nothing, missing_all
   use equation_changes, only: response_t, varied_t, pair_residual, drive_residual, arm_of, gap_of, angle_change, &
      root_unknown
   implicit none
   private
   public :: make_response, respond

   !> Redundant equations contradict one another by more than this part of what a change adds to them: rounding is less,
   !> and no mechanism has equations that differ by so little.
   real(wp), parameter :: contradiction = 1.0e-6_wp*sqrt(epsilon(1.0_wp)*2.0_wp**52)
   !> A sum of fewer roundings of a change is zero.
   real(wp), parameter :: roundings = 4096.0_wp*epsilon(1.0_wp)

contains

   !> Ready for the responses of `m` to `changes`.
   subroutine make_response(r, m, changes)
      type(response_t), intent(out) :: r
      type(mechanism_t), intent(in) :: m
      type(change_t), intent(in) :: changes(:)
      integer :: i

      r%m = m
      r%tree = new_tree(m)
      r%axes = axes_of(m, r%tree)
      r%equations = new_equations(m, r%tree)
      allocate (r%loop_of_pair(0:size(m%pairs)), r%loop_of_drive(0:size(m%drives)), source=0)
      do i = 1, r%equations%count
         associate (q => r%equations%list(i))
            if (q%vector_loop == 0) cycle
            if (q%pair > 0) r%loop_of_pair(q%pair) = q%vector_loop
            if (q%drive > 0) r%loop_of_drive(q%drive) = q%vector_loop
         end associate
      end do
      r%changes = changes
      allocate (r%angle(size(m%links), size(changes)))
      do i = 1, size(changes)
         r%angle(:, i) = angle_changes(m, changes(i))
      end do
      associate (unknowns => r%tree%orientations + r%tree%slides + 2*r%tree%roots)
         allocate (r%unit(0:unknowns), r%now(0:2, 0:unknowns), r%u(0:2, 0:unknowns, size(changes)), source=0.0_wp)
         allocate (r%missing(0:unknowns), source=missing_nothing)
      end associate
      allocate (r%links(3, 0:2, size(m%links), size(changes)), source=0.0_wp)
      allocate (r%jams(size(changes)), source=.false.)
   end subroutine make_response

   !> By how much the `change` of `m` turns each link (links) from its orientation. The angles of the tree are sums of
   !> angles of the deck: those of the changes add up in the same way.
   function angle_changes(m, change) result(angle)
      type(mechanism_t), intent(in) :: m
      type(change_t), intent(in) :: change
      real(wp) :: angle(size(m%links))
      type(mechanism_t) :: only_changes
      type(axes_t) :: axes

      angle = 0.0_wp
      if (all(abs(change%ground(3, :)) <= 0.0_wp) .and. all(abs(change%pair(3, :)) <= 0.0_wp)) return
      only_changes = m
      only_changes%links%position(3) = change%ground(3, :)
      only_changes%pairs%beta = change%pair(3, :)
      axes = axes_of(only_changes, new_tree(only_changes))
      angle = axes%angle_offset
   end function angle_changes

   !> Finds the responses at the position and the time of the engine `e`, which it solves for once more.
   !> `drives` (0:2, drives, directions): the changes of the drives' values, rates and accelerations. `only_driven`: no
   !> more is known than what drives alone move.
   subroutine respond(r, e, drives, only_driven)
      type(response_t), intent(inout) :: r
      type(block_engine_t), intent(inout) :: e
      real(wp), intent(in) :: drives(0:, :, :)
      logical, intent(in) :: only_driven
      type(convergence_t) :: c
      integer :: pass, k
      logical :: is_found

      r%u = 0.0_wp
      r%jams = .false.
      ! A function's result would bring its own lower bound.
      r%unit(:) = slide_units(e)
      call take_values([(k, k=0, e%blocks%unknowns)])
      ! A change may bring in an angle that a block does not hold: all of them are found first.
      do pass = 1, 2
         r%missing(1:) = missing_all
         do k = 1, size(e%needed)
            associate (i => e%needed(k), block => e%blocks%list(e%needed(k)))
               if (only_driven .and. .not. block%direct) cycle
               ! Marks of its own unknowns are zero in what follows.
               r%missing(e%blocks%unknown(block%first:block%last)) = missing_nothing
               is_found = largest_known(e%blocks, i, r%missing) == missing_nothing
               if (is_found) then
                  c = convergence_t()
                  call solve_block(e%blocks, i, 0.0_wp, e%work, e%state, c)
                  call take_values(e%blocks%unknown(block%first:block%last))
                  is_found = is_solved(c) .and. .not. (c%singular .or. c%rates_open)
               end if
               if (is_found .and. pass == 2) call respond_block(i)
               if (.not. is_found) r%missing(e%blocks%unknown(block%first:block%last)) = missing_all
            end associate
         end do
      end do
      call move_links()

   contains

      !> The values, rates and accelerations of the `unknowns` in the engine `e`, in the deck's unit.
      subroutine take_values(unknowns)
         integer, intent(in) :: unknowns(:)
         integer :: k

         do k = 1, size(unknowns)
            associate (u => e%state%u(unknowns(k)))
               r%now(:, unknowns(k)) = r%unit(unknowns(k))*[u%value, u%rate, u%acceleration]
            end associate
         end do
      end subroutine take_values

      !> The responses of block `i`, by the factors that the solver has left. `is_found`: redundant equations allow all
      !> changes.
      subroutine respond_block(i)
         integer, intent(in) :: i
         real(wp) :: v(max(1, e%blocks%list(i)%shape%rows)), limit
         integer :: order, d, k

         associate (block => e%blocks%list(i), shape => e%blocks%list(i)%shape)
            do order = 0, 2
               do d = 1, size(r%changes)
                  call find_residual(r, e, drives(:, :, d), i, d, order, v)
                  v = -v
                  limit = max(contradiction*maxval(abs(v)), roundings*size_of(r%changes(d), drives(0, :, d), e))
                  if (.not. block%direct) call solve_again(shape, e%work%a, e%work%sparse(shape%pattern), &
                     e%work%pivots, e%work%work, v)
                  if (order == 0 .and. any(abs(v(shape%n + 1:shape%rows)) > limit)) r%jams(d) = .true.
                  do k = 1, shape%n
                     associate (u => e%blocks%unknown(block%first + k - 1))
                        r%u(order, u, d) = v(k)*r%unit(u)
                     end associate
                  end do
               end do
            end do
            is_found = shape%rows == shape%n .or. .not. any(r%jams)
         end associate
      end subroutine respond_block

      !> The largest of the numbers of `change` and of the `drives` (drives), in the units of `e`.
      pure real(wp) function size_of(change, drives, e)
         type(change_t), intent(in) :: change
         real(wp), intent(in) :: drives(:)
         type(block_engine_t), intent(in) :: e

         size_of = max(maxval(abs(change%ground(:2, :)))/e%length, maxval(abs(change%ground(3, :))), &
            maxval(abs(change%point))/e%length, maxval(abs(change%pair(2, :)))/e%length, &
            maxval(abs(change%pair(1::2, :))), maxval(abs(drives)/merge(1.0_wp, e%length, e%is_angle)))
      end function size_of

      !> The changes of the links, along the tree: P - Q of a revolute pair is 0, of a prismatic pair h n - s e.
      subroutine move_links()
         integer :: d, i, link

         do d = 1, size(r%changes)
            do i = 1, size(r%tree%order)
               link = r%tree%order(i)
               r%links(3, :, link, d) = angle_change(r, link, d)
               if (r%m%links(link)%ground) then
                  r%links(:, :, link, d) = 0.0_wp
                  r%links(:, 0, link, d) = r%changes(d)%ground(:, link)
               else if (r%tree%parent(link) == 0) then
                  associate (u => root_unknown(r, r%tree%root(link)))
                     r%links(:2, :, link, d) = transpose(r%u(:, u:u + 1, d))
                  end associate
               else
                  r%links(:2, :, link, d) = place_change(link, d)
               end if
            end do
         end do
      end subroutine move_links

      !> The change (2, 0:2) of the origin of `link`, from that of its parent.
      function place_change(link, d) result(dx)
         integer, intent(in) :: link, d
         real(wp) :: dx(2, 0:2)
         type(varied_t) :: other, own, gap
         logical :: is_i
         integer :: point

         associate (pair => r%m%pairs(r%tree%parent_joint(link)))
            is_i = r%m%points(pair%point_i)%link == link
            point = merge(pair%point_j, pair%point_i, is_i)
            other = arm_of(r, point, d)
            own = arm_of(r, merge(pair%point_i, pair%point_j, is_i), d)
            dx = other%dx - own%dx
            associate (base => r%m%points(point)%link)
               if (.not. r%m%links(base)%ground) dx = dx + r%links(:2, :, base, d)
            end associate
            if (pair%kind /= pair_prismatic) return
            gap = gap_of(r, r%tree%parent_joint(link), d)
            dx = dx + merge(1.0_wp, -1.0_wp, is_i)*gap%dx
         end associate
      end function place_change
   end subroutine respond

   !> `v` (rows): derivative number `order` of the change of the equations of block `i` in direction `d`, as far as it
   !> is known, in the units of the block; of a direct one, that of its unknown. `drives` (0:2, drives).
   subroutine find_residual(r, e, drives, i, d, order, v)
      type(response_t), intent(in) :: r
      type(block_engine_t), intent(in) :: e
      real(wp), intent(in) :: drives(0:, :)
      integer, intent(in) :: i, d, order
      real(wp), intent(out) :: v(:)
      integer :: k

      v = 0.0_wp
      associate (block => e%blocks%list(i))
         if (block%direct) then
            associate (row => e%blocks%rows(block%first_row))
               v(1) = row%sign_of*residual(row, 1)/r%unit(e%blocks%unknown(block%first))
            end associate
            return
         end if
         do k = block%first_loop, block%last_loop
            associate (g => e%blocks%loops(k))
               if (g%row_x > 0) v(g%row_x) = scaled_residual(block%first_row + g%row_x - 1, 1)
               if (g%row_y > 0) v(g%row_y) = scaled_residual(block%first_row + g%row_y - 1, 2)
            end associate
         end do
      end associate

   contains

      !> The residual of row number `k` in its unit.
      real(wp) function scaled_residual(k, axis) result(x)
         integer, intent(in) :: k, axis

         associate (row => e%blocks%rows(k), unit => e%blocks%numbers%rows(k)%unit)
            x = residual(row, axis)
            if (.not. row%angular) x = x/(e%length*unit)
         end associate
      end function scaled_residual

      !> That of `row`, component `axis` of its loop where it is one, in the deck's unit.
      real(wp) function residual(row, axis) result(x)
         type(row_t), intent(in) :: row
         integer, intent(in) :: axis
         real(wp) :: change(0:2)

         if (row%pair > 0) then
            change = pair_residual(r, row, axis, d)
         else
            change = drive_residual(r, row%drive, d) - drives(:, row%drive)
         end if
         x = change(order)
      end function residual
   end subroutine find_residual
end module linear_response
