!> Drives that hold nothing where links can still move: which of them, by the left null vectors of the
!> Jacobian.
!>
!> With y J = 0 the equations in y depend on one another. Where y holds one drive alone, the pairs already fix what it
!> asks for: it moves nothing. Where it holds several, the last of them adds nothing to the others.
module drive_rank
   use kinds, only: wp
   use lapack, only: gesvd
   use blocks, only: blocks_t
   use block_state, only: state_t, known_parts
   use block_rows, only: assemble_dense
   use right_hand_sides, only: rate_side
   use block_rank, only: zero_level
   implicit none
   private
   public :: judge_drives

   !> The decomposition takes the cube of this many operations.
   integer, parameter :: max_unknowns = 600

contains

   !> Which drives (drives) with an equation in the blocks `list`, in solving order and with all they build on, hold
   !> nothing at the position of `s`: `idle`, or nothing but what other drives hold already: `repeated`.
   subroutine judge_drives(b, list, s, idle, repeated)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)
      type(state_t), intent(in) :: s
      logical, intent(out) :: idle(:), repeated(:)
      real(wp), allocatable :: y(:, :)
      integer :: d, k, pivot(size(idle))

      idle = .false.
      repeated = .false.
      pivot = 0
      if (sum(b%list(list)%last - b%list(list)%first + 1) > max_unknowns) return
      y = null_drives(b, list, s, size(idle))
      do d = size(idle), 1, -1
         k = count(pivot > 0)
         if (k == size(y, 2)) exit
         if (maxval(abs(y(d, k + 1:))) <= zero_level) cycle
         pivot(d) = k + 1
         call take_out(y, d, k + 1)
      end do
      do d = 1, size(idle)
         if (pivot(d) == 0) cycle
         repeated(d) = count(abs(y(:, pivot(d))) > zero_level) > 1
         idle(d) = .not. repeated(d)
      end do
   end subroutine judge_drives

   !> The left null vectors as columns (drives, vectors), of which only the drives are told.
   function null_drives(b, list, s, drives) result(y)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:), drives
      type(state_t), intent(in) :: s
      real(wp), allocatable :: y(:, :)
      real(wp), allocatable :: a(:, :), values(:), left(:, :), right(:, :), work(:)
      integer, allocatable :: drive_of(:)
      integer :: rows, n, rank, info, k

      call fill(b, list, s, a, drive_of)
      rows = size(a, 1)
      n = size(a, 2)
      allocate (values(min(rows, n)), left(rows, rows), right(n, n), work(8*(rows + n) + 64))
      call gesvd('A', 'A', rows, n, a, rows, values, left, rows, right, n, work, size(work), info)
      rank = count(values > zero_level*max(values(1), tiny(1.0_wp)))
      allocate (y(drives, rows - rank), source=0.0_wp)
      do k = 1, rows
         if (drive_of(k) > 0) y(drive_of(k), :) = left(k, rank + 1:)
      end do
   end function null_drives

   !> The Jacobian `a` (rows, unknowns) of all blocks of `list` together, and whose rows these are (0: a pair's).
   subroutine fill(b, list, s, a, drive_of)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)
      type(state_t), intent(in) :: s
      real(wp), allocatable, intent(out) :: a(:, :)
      integer, allocatable, intent(out) :: drive_of(:)
      type(state_t) :: unit
      integer :: column(0:b%unknowns), n, k, u

      unit = s
      unit%u%rate = 0.0_wp
      unit%drive_value = 0.0_wp
      n = 0
      column = 0
      allocate (drive_of(0))
      do k = 1, size(list)
         associate (block => b%list(list(k)))
            column(b%unknown(block%first:block%last)) = [(n + u, u=1, block%last - block%first + 1)]
            n = n + block%last - block%first + 1
            drive_of = [drive_of, b%rows(block%first_row:block%last_row)%drive]
         end associate
      end do
      allocate (a(size(drive_of), n), source=0.0_wp)
      call fill_own(b, list, column, unit, a)
      do u = 1, b%unknowns
         if (column(u) == 0) cycle
         unit%u(u)%rate = 1.0_wp
         call fill_given(b, list, column(u), unit, a)
         unit%u(u)%rate = 0.0_wp
      end do
   end subroutine fill

   !> What each block of `list` has of its own unknowns and, where it is direct, of the other.
   subroutine fill_own(b, list, column, s, a)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:), column(0:)
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(:, :)
      real(wp), allocatable :: own(:), r(:)
      integer :: k, row

      row = 0
      do k = 1, size(list)
         associate (block => b%list(list(k)))
            associate (rows => block%last_row - block%first_row + 1, n => block%last - block%first + 1)
               if (block%direct) then
                  a(row + 1, column(b%unknown(block%first))) = 1.0_wp
                  associate (other => column(b%rows(block%first_row)%other))
                     if (other > 0) a(row + 1, other) = -1.0_wp
                  end associate
               else
                  allocate (own(rows*n), r(rows))
                  call known_parts(b, list(k), s)
                  call assemble_dense(b, list(k), s, own, r)
                  a(row + 1:row + rows, column(b%unknown(block%first:block%last))) = reshape(own, [rows, n])
                  deallocate (own, r)
               end if
               row = row + rows
            end associate
         end associate
      end do
   end subroutine fill_own

   !> Column `c`, where it belongs to an earlier block: the unknown that alone has a rate in `s`, and that is 1.
   subroutine fill_given(b, list, c, s, a)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:), c
      type(state_t), intent(inout) :: s
      real(wp), intent(inout) :: a(:, :)
      real(wp) :: side(size(a, 1))
      integer :: k, row, n

      row = 0
      n = 0
      do k = 1, size(list)
         associate (block => b%list(list(k)))
            associate (rows => block%last_row - block%first_row + 1)
               if (c <= n .and. .not. block%direct) then
                  call known_parts(b, list(k), s)
                  call rate_side(b, list(k), 1, s, side)
                  a(row + 1:row + rows, c) = -side(:rows)
               end if
               row = row + rows
               n = n + block%last - block%first + 1
            end associate
         end associate
      end do
   end subroutine fill_given

   !> Makes entry `d` of column `c` of `y` 1, that of all others 0; the columns from `c` on may change places.
   pure subroutine take_out(y, d, c)
      real(wp), intent(inout) :: y(:, :)
      integer, intent(in) :: d, c
      integer :: at, k

      at = c - 1 + maxloc(abs(y(d, c:)), dim=1)
      y(:, [c, at]) = y(:, [at, c])
      y(:, c) = y(:, c)/y(d, c)
      do k = 1, size(y, 2)
         if (k /= c) y(:, k) = y(:, k) - y(:, c)*y(d, k)
      end do
   end subroutine take_out
end module drive_rank
