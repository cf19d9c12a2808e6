!> Where each entry of a block's Jacobian stands, worked out once: in a dense matrix by columns, or in the
!> order of a sparse one's pattern, which is made here.
module block_places
   use klu, only: pattern_t
   use block_matrix, only: shape_t, is_sparse_better
   use blocks, only: blocks_t, block_t, block_loop_t
   implicit none
   private
   public :: find_places

   !> Entries come row by row: of each column the row noted latest and where its last entry stands.
   type :: places_t
      integer :: rows = 0                         !< of a dense matrix; 0: sparse
      integer, allocatable :: latest(:), last(:)
      type(pattern_t) :: pattern
   end type places_t

contains

   !> The places of all entries of `b`, and the patterns of the blocks whose Jacobian is best sparse.
   pure subroutine find_places(b)
      type(blocks_t), intent(inout) :: b
      type(places_t) :: p
      integer :: i, patterns

      allocate (b%patterns(count(may_be_sparse(b%list%shape))))
      patterns = 0
      do i = 1, size(b%list)
         if (b%list(i)%direct) cycle
         if (may_be_sparse(b%list(i)%shape)) then
            call find_pattern(b, b%list(i), p)
            if (is_sparse_better(b%list(i)%shape%n, size(p%pattern%row))) then
               patterns = patterns + 1
               b%patterns(patterns) = p%pattern
               b%list(i)%shape%pattern = patterns
               b%list(i)%shape%entries = size(p%pattern%row)
               cycle
            end if
         end if
         p%rows = b%list(i)%shape%rows
         call place_entries(b, b%list(i), p)
      end do
      b%patterns = b%patterns(:patterns)
   end subroutine find_places

   elemental logical function may_be_sparse(shape)
      type(shape_t), intent(in) :: shape

      may_be_sparse = shape%rows == shape%n .and. is_sparse_better(shape%n, 0)
   end function may_be_sparse

   !> The pattern of a block, and its places therein: columns are counted first, then filled.
   pure subroutine find_pattern(b, block, p)
      type(blocks_t), intent(inout) :: b
      type(block_t), intent(in) :: block
      type(places_t), intent(out) :: p
      integer :: c

      associate (n => block%shape%n)
         allocate (p%latest(n), p%last(n), source=0)
         call place_entries(b, block, p)
         allocate (p%pattern%first(n + 1), source=0)
         do c = 1, n
            p%pattern%first(c + 1) = p%pattern%first(c) + p%last(c)
         end do
         allocate (p%pattern%row(p%pattern%first(n + 1)))
         p%latest = 0
         p%last = p%pattern%first(:n)
         call place_entries(b, block, p)
      end associate
   end subroutine find_pattern

   pure subroutine place_entries(b, block, p)
      type(blocks_t), intent(inout) :: b
      type(block_t), intent(in) :: block
      type(places_t), intent(inout) :: p
      integer :: m

      do m = block%first_loop, block%last_loop
         call place_row(b, b%loops(m), 1, b%loops(m)%row_x, p)
         call place_row(b, b%loops(m), 2, b%loops(m)%row_y, p)
         associate (g => b%loops(m))
            call place(p, g%row_x, g%orientation_column, g%orientation_at)
            call place(p, g%row_x, g%less_column, g%less_at)
         end associate
      end do
   end subroutine place_entries

   !> The entries of arms and slides of instance `g` in row number `row`, which is its row_x (`side` 1) or row_y (2).
   pure subroutine place_row(b, g, side, row, p)
      type(blocks_t), intent(inout) :: b
      type(block_loop_t), intent(in) :: g
      integer, intent(in) :: side, row
      type(places_t), intent(inout) :: p
      integer :: k

      if (row == 0) return
      do k = g%first_own, g%last_vector
         call place(p, row, b%body_vectors(k)%column, b%body_vectors(k)%at(side))
      end do
      do k = g%first_slide, g%last_slide
         call place(p, row, b%slides(k)%column, b%slides(k)%at(side))
         call place(p, row, b%slides(k)%orientation_column, b%slides(k)%orientation_at(side))
      end do
   end subroutine place_row

   !> The place `at` of entry (row, column), 0 where there is no column.
   pure subroutine place(p, row, column, at)
      type(places_t), intent(inout) :: p
      integer, intent(in) :: row, column
      integer, intent(out) :: at

      at = 0
      if (column == 0) return
      if (p%rows > 0) then
         at = row + (column - 1)*p%rows
         return
      end if
      if (p%latest(column) /= row) then
         p%latest(column) = row
         p%last(column) = p%last(column) + 1
         if (allocated(p%pattern%row)) p%pattern%row(p%last(column)) = row - 1
      end if
      at = p%last(column)
   end subroutine place
end module block_places
