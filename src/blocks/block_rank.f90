!> What the rank of a block's Jacobian tells where its equations are too many, or where it has no
!> inverse, by the singular values (DGESVD).
module block_rank
   use kinds, only: wp
   use lapack, only: gesvd, getrf
   use blocks, only: blocks_t
   use block_state, only: state_t, set_values
   use block_rows, only: assemble_dense
   implicit none
   private
   public :: redundant_rows, moving_unknowns, jacobian_of, relative_side, min_direction, residual_of, &
      gauss_newton_step, &
      zero_level

   !> Singular values below this part of the largest count as zero: the root of the rounding, since a position at which
   !> they vanish is itself known to no more.
   real(wp), parameter :: zero_level = max(1.0e-7_wp, 4.0_wp*sqrt(epsilon(1.0_wp)))
   !> So far a mechanism with a freedom left is moved to see whether it follows.
   real(wp), parameter :: trial = 1.0e-3_wp
   !> Residuals that have nothing to correct, and those that are a position's.
   real(wp), parameter :: closed = max(1.0e-14_wp, 32.0_wp*epsilon(1.0_wp)), near = max(1.0e-12_wp, 100.0_wp*closed)
   !> The decomposition takes the cube of this many operations.
   integer, parameter :: max_rows = 1500

   type :: values_t
      integer :: rows = 0, n = 0, rank = 0
      real(wp), allocatable :: s(:), left(:, :), right(:, :)
      real(wp), allocatable :: r(:)               !< the residual there
   end type values_t

contains

   !> The rows of block `i`, counted in b%rows, that could be spared at the position of `s`: of those that depend on one
   !> another the last ones of the deck. Pairs go before drives.
   function redundant_rows(b, i, s) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      integer, allocatable :: list(:)
      type(values_t) :: v
      real(wp), allocatable :: null(:, :)
      integer, allocatable :: order(:)
      integer :: k, c, at

      allocate (list(0))
      if (b%list(i)%shape%rows > max_rows) return
      v = decomposed(b, i, s)
      null = v%left(:, v%rank + 1:)
      order = row_order(b, i)
      do k = 1, size(order)
         if (size(list) == size(null, 2)) exit
         c = size(list) + 1
         at = c - 1 + maxloc(abs(null(order(k), c:)), dim=1)
         if (abs(null(order(k), at)) <= zero_level) cycle
         null(:, [c, at]) = null(:, [at, c])
         call clear_row(null, order(k), c)
         list = [list, b%list(i)%first_row + order(k) - 1]
      end do
   end function redundant_rows

   !> Rows from the last pair of the deck to the first, then the drives likewise.
   pure function row_order(b, i) result(order)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      integer, allocatable :: order(:)
      integer :: k, n

      associate (rows => b%rows(b%list(i)%first_row:b%list(i)%last_row))
         allocate (order(0))
         do n = max(maxval(rows%pair), 0), 1, -1
            order = [order, pack([(k, k=1, size(rows))], rows%pair == n)]
         end do
         do n = max(maxval(rows%drive), 0), 1, -1
            order = [order, pack([(k, k=1, size(rows))], rows%pair == 0 .and. rows%drive == n)]
         end do
      end associate
   end function row_order

   !> Makes entry `row` of all columns after `c` zero, by column `c`.
   pure subroutine clear_row(a, row, c)
      real(wp), intent(inout) :: a(:, :)
      integer, intent(in) :: row, c
      integer :: k

      do k = c + 1, size(a, 2)
         a(:, k) = a(:, k) - a(:, c)*(a(row, k)/a(row, c))
      end do
   end subroutine clear_row

   !> (unknowns of block `i`) Those that move although everything the block builds on stands still: it is moved a
   !> little along a direction that the Jacobian leaves open, and comes back to its equations elsewhere. Where it
   !> comes back to where it was, at a dead point, none. `moved`: the state there.
   function moving_unknowns(b, i, s, moved) result(moves)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      type(state_t), intent(inout), optional :: moved
      logical :: moves(b%list(i)%last - b%list(i)%first + 1)
      type(state_t) :: trial_state
      type(values_t) :: v
      real(wp) :: start(size(moves)), direction(size(moves)), far
      integer :: k

      moves = .false.
      if (b%list(i)%shape%rows > max_rows .or. size(moves) == 0) return
      trial_state = s
      v = decomposed(b, i, trial_state)
      if (v%rank == v%n) return
      start = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
      direction = v%right(v%n, :)
      call set_values(b, i, start + trial*direction, trial_state)
      do k = 1, 20
         call gauss_newton_step(b, i, trial_state, far)
         if (far <= closed) exit
      end do
      direction = trial_state%u(b%unknown(b%list(i)%first:b%list(i)%last))%value - start
      if (far <= near .and. norm2(direction) > 0.5_wp*trial) &
         moves = abs(direction) > 0.01_wp*maxval(abs(direction))
      if (present(moved)) moved = trial_state
   end function moving_unknowns

   !> (rows*n) The Jacobian of block `i`, column by column.
   function jacobian_of(b, i, s) result(a)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp) :: a(b%list(i)%shape%rows*b%list(i)%shape%n), r(b%list(i)%shape%rows)

      call assemble_dense(b, i, s, a, r)
   end function jacobian_of

   !> Whether block `i` with more rows than unknowns is on the side of its change points on which the Jacobian `before`
   !> (rows*n) was: sign of the determinant of the product of that, transposed, and the present one. With as many rows
   !> as unknowns it would be the product of the two signs.
   integer function relative_side(b, i, before, s) result(side)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: before(:)
      type(state_t), intent(inout) :: s
      real(wp) :: product(b%list(i)%shape%n, b%list(i)%shape%n)
      integer :: pivots(b%list(i)%shape%n), info, k

      associate (rows => b%list(i)%shape%rows, n => b%list(i)%shape%n)
         product = matmul(transpose(reshape(before, [rows, n])), reshape(jacobian_of(b, i, s), [rows, n]))
         side = 1
         if (n == 0) return
         call getrf(n, n, product, n, pivots, info)
         do k = 1, n
            if ((product(k, k) < 0.0_wp) .neqv. (pivots(k) /= k)) side = -side
         end do
      end associate
   end function relative_side

   !> The least singular value of the Jacobian of block `i` with its vectors `left` (rows) and `right` (n).
   subroutine min_direction(b, i, s, least, left, right)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp), intent(out) :: least, left(:), right(:)
      type(values_t) :: v

      v = decomposed(b, i, s)
      least = v%s(v%n)
      left = v%left(:, v%n)
      right = v%right(v%n, :)
   end subroutine min_direction

   !> (rows) What the equations of block `i` leave with the values `x` (n), which `s` has from then on.
   function residual_of(b, i, x, s) result(r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:)
      type(state_t), intent(inout) :: s
      real(wp) :: r(b%list(i)%shape%rows), a(b%list(i)%shape%rows*b%list(i)%shape%n)

      call set_values(b, i, x, s)
      call assemble_dense(b, i, s, a, r)
   end function residual_of

   !> One step of least length towards the equations of block `i` (Gauss and Newton), none along a direction that the
   !> Jacobian leaves open; `far`: the largest residual before it.
   subroutine gauss_newton_step(b, i, s, far)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp), intent(out) :: far
      type(values_t) :: v
      real(wp), allocatable :: x(:)
      integer :: k

      v = decomposed(b, i, s)
      far = maxval(abs(v%r))
      x = s%u(b%unknown(b%list(i)%first:b%list(i)%last))%value
      do k = 1, v%rank
         x = x - v%right(k, :)*(dot_product(v%left(:, k), v%r)/v%s(k))
      end do
      call set_values(b, i, x, s)
   end subroutine gauss_newton_step

   !> The singular values of the Jacobian of block `i`.
   function decomposed(b, i, s) result(v)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      type(values_t) :: v
      real(wp), allocatable :: a(:), work(:)
      integer :: info

      v%rows = b%list(i)%shape%rows
      v%n = b%list(i)%shape%n
      allocate (a(v%rows*v%n), v%r(v%rows), work(8*(v%rows + v%n) + 64), v%s(min(v%rows, v%n)), source=0.0_wp)
      allocate (v%left(v%rows, v%rows), v%right(v%n, v%n), source=0.0_wp)
      if (v%n == 0) then
         do info = 1, v%rows
            v%left(info, info) = 1.0_wp
         end do
         return
      end if
      call assemble_dense(b, i, s, a, v%r)
      call gesvd('A', 'A', v%rows, v%n, a, v%rows, v%s, v%left, v%rows, v%right, v%n, work, size(work), info)
      ! A block of one unknown has nothing but its own arms to be compared with.
      v%rank = count(v%s > zero_level*max(v%s(1), b%list(i)%lipschitz, tiny(1.0_wp)))
   end function decomposed
end module block_rank
