!> The rank of a block's Jacobian by its singular values (DGESVD), where equations are too many or where it has no
!> inverse: redundant equations, unknowns that can still move, and drives that hold nothing.
!>
!> With y J = 0 the equations in y depend on one another. Where y holds one drive alone, the pairs already fix its
!> value: it moves nothing, it is idle. Where y holds several, the last of them adds nothing to the others.
module block_rank
   use kinds, only: wp
   use lapack, only: geqrf, getrf, gesvd, ormqr
   use blocks, only: blocks_t
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: find_known_parts, assemble_dense, right_hand_side
   implicit none
   private
   public :: values_t, decomposed, redundant_rows, moving_unknowns, jacobian_of, relative_sign, residual_of, &
      curvature_of, gauss_newton_step, judge_drives

   !> Singular values below this part of the largest count as zero: the root of the rounding, since a position at which
   !> they vanish is itself known to no more.
   real(wp), parameter :: zero_level = max(1.0e-7_wp, 4.0_wp*sqrt(epsilon(1.0_wp)))
   !> A mechanism with a degree of freedom left is moved by this to see whether it follows.
   real(wp), parameter :: trial = 1.0e-3_wp
   !> The step of second differences, whose roundings and whose neglected terms are then alike.
   real(wp), parameter, public :: difference = sqrt(sqrt(epsilon(1.0_wp)))
   !> A residual below the first leaves nothing to correct; below the second it is that of a position.
   real(wp), parameter :: closed = max(1.0e-14_wp, 32.0_wp*epsilon(1.0_wp)), near = max(1.0e-12_wp, 100.0_wp*closed)
   !> The decompositions take the cube of these numbers of operations: of a block, and of blocks with all they need.
   integer, parameter :: max_rows = 1500, max_unknowns = 600

   !> A singular value decomposition: left (rows, rows), right (n, n), singular values in falling order.
   type :: values_t
      integer :: rows = 0, n = 0, rank = 0        !< equations, unknowns, singular values that are not small
      real(wp), allocatable :: s(:), left(:, :), right(:, :)
      real(wp), allocatable :: r(:)               !< (rows) the block's residual
   end type values_t

   !> The cosine between columns of two Jacobians, and the product of those between their ranges, that are not too far.
   real(wp), parameter :: min_cosine = 0.7_wp

contains

   !> The rows of block `i`, counted in b%rows, that could be spared at the position of `s`: of those that depend on one
   !> another the last ones of the deck. Pairs go before drives.
   function redundant_rows(b, i, s) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      integer, allocatable :: list(:)
      type(values_t) :: v
      integer, allocatable :: order(:), pivot(:)
      integer :: k, n

      allocate (list(0), order(0))
      if (b%list(i)%shape%rows > max_rows) return
      v = decomposed(b, i, s)
      associate (rows => b%rows(b%list(i)%first_row:b%list(i)%last_row))
         do n = max(maxval(rows%pair), 0), 1, -1
            order = [order, pack([(k, k=1, size(rows))], rows%pair == n)]
         end do
         do n = max(maxval(rows%drive), 0), 1, -1
            order = [order, pack([(k, k=1, size(rows))], rows%pair == 0 .and. rows%drive == n)]
         end do
      end associate
      associate (null => v%left(:, v%rank + 1:))
         call find_pivots(order, null, pivot)
      end associate
      list = pack(b%list(i)%first_row + order - 1, pivot(order) > 0)
   end function redundant_rows

   !> Gauss's elimination of the columns of `y` (rows, any number), the rows taken in the `order`: `pivot` (rows) is the
   !> column that has a row as its pivot, with 1 where all others have 0; 0 of rows that are no pivot.
   subroutine find_pivots(order, y, pivot)
      integer, intent(in) :: order(:)
      real(wp), intent(inout) :: y(:, :)
      integer, allocatable, intent(out) :: pivot(:)
      integer :: c, i, k, at

      allocate (pivot(size(y, 1)), source=0)
      c = 1
      do i = 1, size(order)
         if (c > size(y, 2)) return
         associate (row => order(i))
            at = c - 1 + maxloc(abs(y(row, c:)), dim=1)
            if (abs(y(row, at)) <= zero_level) cycle
            pivot(row) = c
            y(:, [c, at]) = y(:, [at, c])
            y(:, c) = y(:, c)/y(row, c)
            do k = 1, size(y, 2)
               if (k /= c) y(:, k) = y(:, k) - y(:, c)*y(row, k)
            end do
         end associate
         c = c + 1
      end do
   end subroutine find_pivots

   !> (unknowns of block `i`) Those that can move although everything the block builds on stands still. The block is
   !> moved a little along a direction that the Jacobian leaves open, and its equations are solved again: at a dead
   !> point they lead back to where it was, and none can move. `moved`: the state they lead to.
   function moving_unknowns(b, i, s, moved) result(moves)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      type(state_t), intent(inout), optional :: moved
      logical :: moves(b%list(i)%last - b%list(i)%first + 1)
      type(state_t) :: trial_state
      type(values_t) :: v
      real(wp) :: start(size(moves)), direction(size(moves)), residual
      integer :: k

      moves = .false.
      if (b%list(i)%shape%rows > max_rows .or. size(moves) == 0) return
      trial_state = s
      v = decomposed(b, i, trial_state)
      if (v%rank == v%n) return
      start = values_of(b, i, s)
      direction = v%right(v%n, :)
      call set_values(b, i, start + trial*direction, trial_state)
      do k = 1, 20
         call gauss_newton_step(b, i, trial_state, residual)
         if (residual <= closed) exit
      end do
      direction = values_of(b, i, trial_state) - start
      if (residual <= near .and. norm2(direction) > 0.5_wp*trial) &
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

   !> 1 if block `i`, with more rows than unknowns, is on the same side of its change points as the Jacobian `before`
   !> (rows*n), -1 if not: the sign of the determinant of that, transposed, times the present one. It is -1 also where
   !> columns or ranges of the two have turned so far that this alone could have changed the sign. With both Jacobians
   !> factored as Q R, |det(Q_before^T Q_now)| is the product of the cosines between the ranges.
   integer function relative_sign(b, i, before, s) result(side)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: before(:)
      type(state_t), intent(inout) :: s
      real(wp), dimension(b%list(i)%shape%rows, b%list(i)%shape%n) :: old, new, both
      real(wp) :: reflections(size(old, 2)), work(64*size(old, 2) + 1), cosines
      integer :: pivots(size(old, 2)), info, k

      old = reshape(before, shape(old))
      new = reshape(jacobian_of(b, i, s), shape(new))
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

   !> w . r''[k, k] of the equations r of block `i` at the values `x` (n), which `s` has from then on, by a second
   !> difference; w = `left` (rows), k = `right` (n).
   real(wp) function curvature_of(b, i, x, left, right, s) result(curvature)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: x(:), left(:), right(:)
      type(state_t), intent(inout) :: s
      real(wp) :: ahead, behind, here

      ahead = dot_product(left, residual_of(b, i, x + difference*right, s))
      behind = dot_product(left, residual_of(b, i, x - difference*right, s))
      here = dot_product(left, residual_of(b, i, x, s))
      curvature = (ahead - here + (behind - here))/difference**2
   end function curvature_of

   !> One step of least length towards the equations of block `i` (Gauss and Newton), none along a direction that the
   !> Jacobian leaves open; `residual`: the largest before it.
   subroutine gauss_newton_step(b, i, s, residual)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp), intent(out) :: residual
      type(values_t) :: v
      real(wp), allocatable :: x(:)
      integer :: k

      v = decomposed(b, i, s)
      residual = maxval(abs(v%r))
      x = values_of(b, i, s)
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
      real(wp), allocatable :: a(:)
      integer :: k

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
      call assemble_dense(b, i, s, a, v%r)
      ! A block of one unknown has nothing but its own body vectors to be compared with.
      call decompose(a, b%numbers%blocks(i)%lipschitz, v)
   end function decomposed

   !> Singular values and vectors of `a` (v%rows*v%n), of which those count as zero that are small beside the largest
   !> and beside `scale`.
   subroutine decompose(a, scale, v)
      real(wp), intent(inout) :: a(*)
      real(wp), intent(in) :: scale
      type(values_t), intent(inout) :: v
      real(wp) :: work(8*(v%rows + v%n) + 64)
      integer :: info

      allocate (v%s(min(v%rows, v%n)), v%left(v%rows, v%rows), v%right(v%n, v%n), source=0.0_wp)
      call gesvd('A', 'A', v%rows, v%n, a, v%rows, v%s, v%left, v%rows, v%right, v%n, work, size(work), info)
      v%rank = count(v%s > zero_level*max(v%s(1), scale, tiny(1.0_wp)))
   end subroutine decompose

   !> Which drives (drives) with an equation in the blocks `list`, in solving order and with all they build on, hold
   !> nothing at the position of `s`: `idle`, or nothing but what other drives hold already: `repeated`.
   subroutine judge_drives(b, list, s, idle, repeated)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)
      type(state_t), intent(in) :: s
      logical, intent(out) :: idle(:), repeated(:)
      real(wp), allocatable :: a(:, :), y(:, :)
      integer, allocatable :: drive_of(:), pivot(:)
      type(values_t) :: v
      integer :: d, k

      idle = .false.
      repeated = .false.
      if (sum(b%list(list)%last - b%list(list)%first + 1) > max_unknowns) return
      call fill(a, drive_of)
      v%rows = size(a, 1)
      v%n = size(a, 2)
      call decompose(a, 0.0_wp, v)
      ! The components of drives in the left null vectors, as columns (drives, vectors).
      allocate (y(size(idle), v%rows - v%rank), source=0.0_wp)
      do k = 1, v%rows
         if (drive_of(k) > 0) y(drive_of(k), :) = v%left(k, v%rank + 1:)
      end do
      call find_pivots([(d, d=size(idle), 1, -1)], y, pivot)
      do d = 1, size(idle)
         if (pivot(d) == 0) cycle
         repeated(d) = count(abs(y(:, pivot(d))) > zero_level) > 1
         idle(d) = .not. repeated(d)
      end do

   contains

      !> The Jacobian `a` (rows, unknowns) of all blocks of `list` together, and whose rows these are (0: a pair's). The
      !> coefficients of an unknown of an earlier block are what its rate 1 alone leaves to the rates of a block.
      subroutine fill(a, drive_of)
         real(wp), allocatable, intent(out) :: a(:, :)
         integer, allocatable, intent(out) :: drive_of(:)
         type(state_t) :: unit
         real(wp), allocatable :: own(:), r(:)
         integer, allocatable :: unknowns(:)
         integer :: column(0:b%unknowns), row, n, k, c

         unit = s
         unit%u%rate = 0.0_wp
         unit%drive_value = 0.0_wp
         allocate (unknowns(0), drive_of(0))
         do k = 1, size(list)
            associate (block => b%list(list(k)))
               unknowns = [unknowns, b%unknown(block%first:block%last)]
               drive_of = [drive_of, b%rows(block%first_row:block%last_row)%drive]
            end associate
         end do
         column = 0
         column(unknowns) = [(c, c=1, size(unknowns))]
         allocate (a(size(drive_of), size(unknowns)), source=0.0_wp)
         row = 0
         n = 0
         do k = 1, size(list)
            associate (block => b%list(list(k)), rows => b%list(list(k))%last_row - b%list(list(k))%first_row + 1, &
               width => b%list(list(k))%last - b%list(list(k))%first + 1)
               if (block%direct) then
                  a(row + 1, n + 1) = 1.0_wp
                  c = column(b%rows(block%first_row)%other)
                  if (c > 0) a(row + 1, c) = -1.0_wp
               else
                  allocate (own(rows*width), r(rows))
                  call find_known_parts(b, list(k), unit)
                  call assemble_dense(b, list(k), unit, own, r)
                  a(row + 1:row + rows, n + 1:n + width) = reshape(own, [rows, width])
                  do c = 1, n
                     unit%u(unknowns(c))%rate = 1.0_wp
                     call find_known_parts(b, list(k), unit)
                     call right_hand_side(b, list(k), 1, unit, r)
                     a(row + 1:row + rows, c) = -r
                     unit%u(unknowns(c))%rate = 0.0_wp
                  end do
                  deallocate (own, r)
               end if
               row = row + rows
               n = n + width
            end associate
         end do
      end subroutine fill
   end subroutine judge_drives
end module block_rank
