!> The vector loops of each block, split into what it knows and what it solves for, and where each entry of the block's
!> Jacobian stands: in a dense matrix by columns, or in the order of a sparse one's pattern, which is made here.
module block_loops
   use klu, only: pattern_t, order_columns
   use block_matrix, only: shape_t, is_sparse_better
   use vector_loops, only: vector_loops_t
   use loop_equations, only: equations_t, equation_t, equation_x, equation_y, equation_projection, equation_slide
   use blocks, only: blocks_t, block_t, block_loop_t, body_vector_t, slide_t, loop_components, loop_projection, &
      loop_angles
   implicit none
   private
   public :: fill_block_loops, find_places

   !> What has been filled, and the columns of the block being filled; 0: not its own.
   type :: filling_t
      integer :: loops = 0, body_vectors = 0, slides = 0   !< how many of each have been filled
      integer, allocatable :: column(:)                    !< (0:unknowns) of the block
      integer, allocatable :: latest(:)                    !< (vector loops) the block loop made of each last
   end type filling_t

   !> Entries come row by row: of each column the row noted latest and where its last entry stands.
   type :: places_t
      integer :: rows = 0                         !< of a dense matrix; 0: sparse
      integer, allocatable :: latest(:), last(:)
      type(pattern_t) :: pattern
   end type places_t

contains

   !> The loops of all blocks that iterate. `member`: the equations of `e` by
   !> block.
   subroutine fill_block_loops(e, member, b)
      type(equations_t), intent(in) :: e
      integer, intent(in) :: member(:)
      type(blocks_t), intent(inout) :: b
      type(filling_t) :: f
      integer :: body_vectors, slides, i, k

      ! Room for all loops: a vector loop whose two components lie in different blocks is in both.
      body_vectors = 0
      slides = 0
      do i = 1, e%count
         associate (p => e%vector_loops, k => e%list(i)%vector_loop)
            body_vectors = body_vectors + p%first_vector(k + 1) - p%first_vector(k)
            slides = slides + p%first_slide(k + 1) - p%first_slide(k)
         end associate
      end do
      allocate (b%loops(e%count), b%body_vectors(body_vectors), b%slides(slides))
      allocate (f%column(0:b%unknowns), f%latest(0:e%vector_loops%count), source=0)

      do i = 1, size(b%list)
         associate (block => b%list(i))
            block%first_loop = f%loops + 1
            if (.not. block%direct) then
               do k = block%first, block%last
                  f%column(b%unknown(k)) = k - block%first + 1
               end do
               do k = block%first_row, block%last_row
                  call add_row(e%list(member(k)), k - block%first_row + 1, block%first_loop)
               end do
               f%column(b%unknown(block%first:block%last)) = 0
            end if
            block%last_loop = f%loops
         end associate
      end do
      b%loops = b%loops(:f%loops)
      b%body_vectors = b%body_vectors(:f%body_vectors)
      b%slides = b%slides(:f%slides)

   contains

      !> Row `row`, in a loop of its own unless x and y of one vector loop share it.
      subroutine add_row(equation, row, first_loop)
         type(equation_t), intent(in) :: equation
         integer, intent(in) :: row, first_loop

         if (any(equation%kind == [equation_x, equation_y])) then
            if (f%latest(equation%vector_loop) < first_loop) then
               call add_block_loop(e%vector_loops, equation%vector_loop, loop_components)
               f%latest(equation%vector_loop) = f%loops
            end if
            associate (block_loop => b%loops(f%latest(equation%vector_loop)))
               if (equation%kind == equation_x) block_loop%row_x = row
               if (equation%kind == equation_y) block_loop%row_y = row
            end associate
            return
         end if
         call add_block_loop(e%vector_loops, equation%vector_loop, merge(loop_projection, loop_angles, &
            equation%kind == equation_projection))
         associate (block_loop => b%loops(f%loops))
            block_loop%row_x = row
            block_loop%orientation = equation%orientation
            if (equation%kind == equation_slide) block_loop%orientation = b%orientations + equation%orientation
            block_loop%orientation_column = f%column(block_loop%orientation)
            block_loop%less = equation%less
            block_loop%less_column = f%column(equation%less)
         end associate
      end subroutine add_row

      !> Vector loop `i`, 0 for one without vectors, as the block with the columns of `f` has it.
      subroutine add_block_loop(p, i, kind)
         type(vector_loops_t), intent(in) :: p
         integer, intent(in) :: i, kind
         integer :: k

         f%loops = f%loops + 1
         associate (block_loop => b%loops(f%loops))
            block_loop%kind = kind
            block_loop%vector_loop = i
            block_loop%first_vector = f%body_vectors + 1
            call add_body_vectors(p, i, .false.)
            block_loop%first_own = f%body_vectors + 1
            call add_body_vectors(p, i, .true.)
            block_loop%last_vector = f%body_vectors
            block_loop%first_slide = f%slides + 1
            do k = p%first_slide(i), p%first_slide(i + 1) - 1
               f%slides = f%slides + 1
               b%slides(f%slides) = slide_t(orientation=p%slide_orientation(k), &
                  orientation_column=f%column(p%slide_orientation(k)), &
                  unknown=b%orientations + p%slide_number(k), column=f%column(b%orientations + p%slide_number(k)), &
                  source=k)
            end do
            block_loop%last_slide = f%slides
         end associate
      end subroutine add_block_loop

      !> Body vectors of vector loop `i`: those of the block's `own` orientations, or the known ones.
      subroutine add_body_vectors(p, i, own)
         type(vector_loops_t), intent(in) :: p
         integer, intent(in) :: i
         logical, intent(in) :: own
         integer :: k

         do k = p%first_vector(i), p%first_vector(i + 1) - 1
            if (.not. e%has_vector(k) .or. p%vector_orientation(k) == 0) cycle
            if (f%column(p%vector_orientation(k)) > 0 .neqv. own) cycle
            f%body_vectors = f%body_vectors + 1
            b%body_vectors(f%body_vectors) = body_vector_t(orientation=p%vector_orientation(k), &
               column=f%column(p%vector_orientation(k)), source=k)
         end do
      end subroutine add_body_vectors
   end subroutine fill_block_loops

   !> The places of all entries of `b`, and the patterns of the blocks whose Jacobian is best sparse.
   subroutine find_places(b)
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
               call order_columns(p%pattern)
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

   !> A square Jacobian of so many rows may be better sparse, if it has few entries.
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

   !> The places of all entries of `block`, row by row.
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

   !> The entries of body vectors and slides of loop `g` in row `row`, which is its row_x (`side` 1) or row_y (2).
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
end module block_loops
