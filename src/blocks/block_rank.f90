!> The rank of a block's Jacobian J by its singular values (DGESVD), if equations are redundant or if J has no inverse:
!> redundant equations, and unknowns that can still move. If y J = 0, the equations with a part in y depend on one
!> another.
module block_rank
   use kinds, only: wp
   use lapack, only: geqrf, getrf, gesvd, ormqr
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: assemble_dense
   implicit none
   private
   public :: svd_t, decomposed, redundant_rows, surplus_drives, moving_unknowns, try_to_move, jacobian_of, &
      relative_sign, residual_of, curvature_of, gauss_newton_step

   !> Singular values below this part of the largest count as zero: the root of the rounding, since a position at which
   !> a singular value vanishes is itself known to no more.
   real(wp), parameter :: zero_singular_value = max(1.0e-7_wp, 4.0_wp*sqrt(epsilon(1.0_wp)))
   !> A block with a degree of freedom left is moved by this, in rad and units of the loop, to find whether it can move:
   !> far above rounding, small compared with the links.
   real(wp), parameter :: test_move = 1.0e-3_wp
   !> The step of second differences, in rad and units of the loop: their rounding is then as large as the terms that
   !> they neglect.
   real(wp), parameter, public :: difference_step = sqrt(sqrt(epsilon(1.0_wp)))
   !> A residual below this, in rad or units of the loop, leaves nothing to correct.
   real(wp), parameter :: corrected_residual = max(1.0e-14_wp, 32.0_wp*epsilon(1.0_wp))
   !> A residual below this is the residual of a position.
   real(wp), parameter :: position_residual = max(1.0e-12_wp, 100.0_wp*corrected_residual)
   !> Blocks of more rows are not decomposed: the time goes with the cube of the rows.
   integer, parameter :: max_decomposed_rows = 1500

   !> The singular value decomposition of a block's Jacobian: J = left diag(s) right.
   type :: svd_t
      integer :: rows = 0, n = 0                  !< equations, unknowns
      integer :: rank = 0                         !< how many singular values are not zero
      !> (min(rows, n)) Singular values, falling; (rows, rows) left vectors in columns; (n, n) right vectors in rows.
      real(wp), allocatable :: s(:), left(:, :), right(:, :)
      real(wp), allocatable :: r(:)               !< (rows) the block's residual, rad or units of the loops
   end type svd_t

   !> Two columns of two Jacobians are near one another if the cosine between them is larger (45 degrees), and two
   !> ranges if the product of the cosines is larger.
   real(wp), parameter :: min_cosine = 0.7_wp

contains

   !> Lists the redundant rows of a block, counted in b%rows: of rows that depend on one another the last ones of the
   !> deck, pairs before drives. They are the pivots of Gauss's elimination of the left null vectors, whose rows are
   !> taken in this order. The list is empty if the block is too large for a decomposition.
   pure function redundant_rows(b, x, i, s) result(list)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s         !< with a position
      integer, allocatable :: list(:)        !< numbers of rows
      type(svd_t) :: v
      integer, allocatable :: order(:)
      integer :: k, n, c, at

      allocate (list(0), order(0))
      if (b%list(i)%shape%rows > max_decomposed_rows) return
      v = decomposed(b, x, i, s)
      associate (rows => b%rows(b%list(i)%first_row:b%list(i)%last_row))
         do n = max(maxval(rows%pair), 0), 1, -1
            order = [order, pack([(k, k=1, size(rows))], rows%pair == n)]
         end do
         do n = max(maxval(rows%drive), 0), 1, -1
            order = [order, pack([(k, k=1, size(rows))], rows%pair == 0 .and. rows%drive == n)]
         end do
      end associate

      associate (y => v%left)
         c = v%rank + 1
         do k = 1, size(order)
            if (c > v%rows) exit
            at = c - 1 + maxloc(abs(y(order(k), c:)), dim=1)
            if (abs(y(order(k), at)) <= zero_singular_value) cycle
            list = [list, b%list(i)%first_row + order(k) - 1]
            y(:, [c, at]) = y(:, [at, c])
            do n = c + 1, v%rows
               y(:, n) = y(:, n) - y(:, c)*(y(order(k), n)/y(order(k), c))
            end do
            c = c + 1
         end do
      end associate
   end function redundant_rows

   !> Tells which drives could be removed to leave one redundant equation fewer (drives), if the redundant equations of
   !> the first block contradict one another. Such a drive has a part in a vector y with y J = 0, J the Jacobian of the
   !> first block. There is none without redundant equations, or if the block is too large for a decomposition.
   pure function surplus_drives(b, x, drives, s) result(are)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: drives          !< how many drives there are
      type(state_t), intent(in) :: s         !< with the position that fits best
      !> A smaller part of a drive, of 1 at most, comes from lengths that do not quite fit.
      real(wp), parameter :: least_part = 1.0e-3_wp
      logical :: are(drives)
      type(svd_t) :: v
      integer :: k

      are = .false.
      if (b%redundant == 0 .or. b%list(1)%shape%rows > max_decomposed_rows) return
      v = decomposed(b, x, 1, s)
      do k = 1, v%rows
         associate (row => b%rows(b%list(1)%first_row + k - 1))
            if (row%pair == 0 .and. row%drive > 0) are(row%drive) = norm2(v%left(k, v%rank + 1:)) > least_part
         end associate
      end do
   end function surplus_drives

   !> Tells which unknowns of a block can move (unknowns of the block) while all blocks on which it builds stand still.
   pure function moving_unknowns(b, x, i, s) result(moves)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s         !< with a singular position
      logical :: moves(b%list(i)%last - b%list(i)%first + 1)
      type(state_t) :: moved_state

      moved_state = s
      call try_to_move(b, x, i, moved_state, moves)
   end function moving_unknowns

   !> Finds which unknowns of a block can move while all blocks on which it builds stand still. The block is moved a
   !> little along the direction of its least singular value, and its equations are solved again: at a dead point they
   !> lead back to the position before, and no unknown can move. Too large blocks count as fixed.
   pure subroutine try_to_move(b, x, i, s, moves)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< with a singular position; then the state to which the equations lead
      logical, intent(out) :: moves(b%list(i)%last - b%list(i)%first + 1)   !< (unknowns of the block) it can move
      type(svd_t) :: v
      real(wp) :: start(size(moves)), direction(size(moves)), residual
      integer :: k

      moves = .false.
      if (b%list(i)%shape%rows > max_decomposed_rows .or. size(moves) == 0) return
      v = decomposed(b, x, i, s)
      if (v%rank == v%n) return
      start = values_of(b, i, s)
      direction = v%right(v%n, :)
      call set_values(b, i, start + test_move*direction, s)
      do k = 1, 20
         call gauss_newton_step(b, x, i, s, residual)
         if (residual <= corrected_residual) exit
      end do
      direction = values_of(b, i, s) - start
      if (residual <= position_residual .and. norm2(direction) > 0.5_wp*test_move) &
         moves = abs(direction) > 0.01_wp*maxval(abs(direction))
   end subroutine try_to_move

   !> Gives the Jacobian (rows*n) of a block at a state, column by column.
   pure function jacobian_of(b, x, i, s) result(a)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s
      real(wp) :: a(b%list(i)%shape%rows*b%list(i)%shape%n), r(b%list(i)%shape%rows)
      type(state_t) :: there

      there = s
      call assemble_dense(b, x, i, there, a, r)
   end function jacobian_of

   !> Tells on which side of its change points a block with more rows than unknowns is: 1 on the side of an earlier
   !> Jacobian, -1 on the other side. This is the sign of det(J_before^T J_now). It is -1 also if columns or ranges of
   !> the two Jacobians have turned so far that the turn could have changed the sign. With both factored as Q R,
   !> |det(Q_before^T Q_now)| is the product of the cosines between the ranges.
   pure integer function relative_sign(b, x, i, before, s) result(side)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      real(wp), intent(in) :: before(:)      !< (rows*n) the earlier Jacobian, column by column
      type(state_t), intent(in) :: s         !< with the present position
      real(wp), dimension(b%list(i)%shape%rows, b%list(i)%shape%n) :: old, new, both
      real(wp) :: reflections(size(old, 2)), work(64*size(old, 2) + 1), cosines
      integer :: pivots(size(old, 2)), info, k

      old = reshape(before, shape(old))
      new = reshape(jacobian_of(b, x, i, s), shape(new))
      side = -1
      if (any(sum(new*old, dim=1) < min_cosine*norm2(new, dim=1)*norm2(old, dim=1))) return
      both = new
      associate (rows => size(old, 1), n => size(old, 2))
         call geqrf(rows, n, new, rows, reflections, work, size(work), info)
         call geqrf(rows, n, old, rows, reflections, work, size(work), info)
         call ormqr('L', 'T', rows, n, n, old, rows, reflections, both, rows, work, size(work), info)
         call getrf(n, n, both, rows, pivots, info)
      end associate
      side = 1
      cosines = 1.0_wp
      do k = 1, size(pivots)
         if ((old(k, k) < 0.0_wp .neqv. both(k, k) < 0.0_wp) .neqv. (pivots(k) /= k)) side = -side
         cosines = cosines*abs(both(k, k)/new(k, k))
      end do
      if (.not. cosines >= min_cosine) side = -1
   end function relative_sign

   !> Finds the residual (rows) of the equations of a block at given values of its unknowns, in rad or the units of the
   !> loops.
   pure function residual_of(b, x, i, values, s) result(r)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      real(wp), intent(in) :: values(:)      !< (n) rad or unit of the loop
      type(state_t), intent(in) :: s         !< with drives, values of earlier blocks, and given parts of the loops
      real(wp) :: r(b%list(i)%shape%rows), a(b%list(i)%shape%rows*b%list(i)%shape%n)
      type(state_t) :: there

      there = s
      call set_values(b, i, values, there)
      call assemble_dense(b, x, i, there, a, r)
   end function residual_of

   !> Finds the second derivative w . r''[k, k] of the equations r of a block along k, by a second difference.
   pure real(wp) function curvature_of(b, x, i, values, left, right, s) result(curvature)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      real(wp), intent(in) :: values(:)      !< (n) rad or unit of the loop
      real(wp), intent(in) :: left(:)        !< (rows) w, a unit vector
      real(wp), intent(in) :: right(:)       !< (n) k, a unit vector
      type(state_t), intent(in) :: s         !< with drives, values of earlier blocks, and given parts of the loops
      real(wp) :: ahead, back, here

      ahead = dot_product(left, residual_of(b, x, i, values + difference_step*right, s))
      back = dot_product(left, residual_of(b, x, i, values - difference_step*right, s))
      here = dot_product(left, residual_of(b, x, i, values, s))
      curvature = (ahead - here + (back - here))/difference_step**2
   end function curvature_of

   !> Makes one step of least length towards a position of a block (Gauss and Newton). It has no part along directions
   !> whose singular value is zero.
   pure subroutine gauss_newton_step(b, x, i, s, residual)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< the values of the block are changed
      real(wp), intent(out) :: residual      !< the largest before the step, in rad or units of the loop
      type(svd_t) :: v
      real(wp), allocatable :: values(:)
      integer :: k

      v = decomposed(b, x, i, s)
      residual = maxval(abs(v%r))
      values = values_of(b, i, s)
      do k = 1, v%rank
         values = values - v%right(k, :)*(dot_product(v%left(:, k), v%r)/v%s(k))
      end do
      call set_values(b, i, values, s)
   end subroutine gauss_newton_step

   !> Decomposes the Jacobian of a block at a state by its singular values. The residual belongs to the result.
   pure function decomposed(b, x, i, s) result(v)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s
      type(svd_t) :: v
      type(state_t) :: there
      real(wp), allocatable :: a(:)
      real(wp) :: work(8*(b%list(i)%shape%rows + b%list(i)%shape%n) + 64)
      integer :: k, info

      v%rows = b%list(i)%shape%rows
      v%n = b%list(i)%shape%n
      allocate (a(v%rows*v%n), v%r(v%rows), source=0.0_wp)
      if (v%n == 0) then
         allocate (v%left(v%rows, v%rows), v%right(0, 0), v%s(0), source=0.0_wp)
         do k = 1, v%rows
            v%left(k, k) = 1.0_wp
         end do
         return
      end if
      there = s
      call assemble_dense(b, x, i, there, a, v%r)
      allocate (v%s(min(v%rows, v%n)), v%left(v%rows, v%rows), v%right(v%n, v%n), source=0.0_wp)
      call gesvd('A', 'A', v%rows, v%n, a, v%rows, v%s, v%left, v%rows, v%right, v%n, work, size(work), info)
      ! A block of one unknown has only its own body vectors to be compared with.
      v%rank = count(v%s > zero_singular_value*max(v%s(1), x%blocks(i)%lipschitz, tiny(1.0_wp)))
   end function decomposed
end module block_rank
