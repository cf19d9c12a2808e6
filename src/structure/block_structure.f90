!> The structure by which one independent mechanism is solved: its blocks, by matching equations with unknowns and by
!> strongly connected components, the part with too many equations first. The vector loops of each block are split into
!> the part that earlier blocks give and the part that the block solves for. Each entry of the block's Jacobian has its
!> address: in a dense matrix by columns, or in the order of a sparse matrix's pattern, which is made here.
module block_structure
   use mechanism, only: mechanism_t
   use scales, only: solver_length, power_of_two
   use klu, only: pattern_t, order_columns
   use block_matrix, only: matrix_layout_t, is_sparse_better, entries_of
   use spanning_tree, only: spanning_tree_t, new_tree
   use matching, only: incidence_t, match, find_blocks, overdetermined, underdetermined
   use loop_equations, only: equations_t, equation_t, new_equations, new_equation_numbers, &
      incidence, equation_x, equation_y, equation_projection, equation_angle, equation_slide
   use blocks, only: blocks_t, geometry_t, block_t, body_vector_t, slide_t, loop_components, loop_projection, &
      loop_angles
   use block_numbers, only: fill_numbers, find_units
   implicit none
   private
   public :: structure_t, make_structure, new_blocks

   !> The structure of an independent mechanism and its first geometry. The solver of the mechanism takes both over.
   type :: structure_t
      type(blocks_t), allocatable :: blocks          !< without blocks if not solvable
      type(geometry_t), allocatable :: geometry      !< of the numbers on the cards; not solvable: of the equations only
   end type structure_t

contains

   !> Makes the structure of an independent mechanism, and the geometry by the numbers on its cards. Tolerance, chain
   !> and cylinders of the geometry are not set. Time and memory are proportional to its links, pairs and drives.
   subroutine make_structure(m, structure)
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(out) :: structure   !< of `m`
      type(spanning_tree_t) :: t
      type(equations_t) :: e

      allocate (structure%blocks, structure%geometry)
      associate (x => structure%geometry)
         x%span = solver_length(m)
         x%closing = m%closing
         t = new_tree(m)
         e = new_equations(m, t)
         x%equations = new_equation_numbers(m, t, power_of_two(x%span), e)
         structure%blocks = new_blocks(t, e)
         if (.not. structure%blocks%solvable) return
         call fill_numbers(structure%blocks, x)
         call find_units(structure%blocks, x)
      end associate
   end subroutine make_structure

   !> Divides equations into blocks, without numbers. If an unknown has no equation, b%solvable is false, there are no
   !> blocks, and b%loose lists the unknowns that may be free.
   function new_blocks(tree, equations) result(b)
      type(spanning_tree_t), intent(in) :: tree   !< of the mechanism
      type(equations_t), intent(in) :: equations   !< on this tree, with `has_vector` and `counts`
      type(blocks_t) :: b
      type(incidence_t) :: g
      integer, allocatable :: unknown_of(:), equation_of(:), first(:), member(:), rows(:)
      logical :: over(equations%count)
      integer :: i, k

      b%tree = tree
      b%orientations = tree%orientations
      b%unknowns = tree%orientations + tree%slides + 2*tree%roots
      g = incidence(equations, b%orientations, b%unknowns)
      call match(g, unknown_of, equation_of)
      b%free = count(equation_of == 0)
      b%solvable = b%free == 0
      b%redundant = count(unknown_of == 0)
      if (.not. b%solvable) then
         b%loose = pack([(i, i=1, b%unknowns)], underdetermined(g, unknown_of, equation_of))
         return
      end if

      over = overdetermined(g, unknown_of, equation_of)
      call find_blocks(g, equation_of, over, first, member)
      ! The part with too many equations is the first block: it needs no unknown of another block.
      if (b%redundant > 0) then
         rows = pack([(i, i=1, size(over))], over)
         member = [rows, member]
         first = [1, first + size(rows)]
      end if

      allocate (b%list(size(first) - 1))
      b%list%first_row = first(:size(b%list))
      b%list%last_row = first(2:) - 1
      b%list%first = b%list%first_row - b%redundant
      b%list%last = b%list%last_row - b%redundant
      if (b%redundant > 0) b%list(1)%first = 1
      b%list%shape%rows = b%list%last_row - b%list%first_row + 1
      b%list%shape%n = b%list%last - b%list%first + 1
      b%unknown = pack(unknown_of(member), unknown_of(member) > 0)
      allocate (b%block_of(b%unknowns))
      do i = 1, size(b%list)
         b%block_of(b%unknown(b%list(i)%first:b%list(i)%last)) = i
      end do

      ! The right-hand sides, and which blocks need no iteration.
      allocate (b%rows(size(member)))
      do i = 1, size(b%list)
         do k = b%list(i)%first_row, b%list(i)%last_row
            associate (equation => equations%list(member(k)), row => b%rows(k))
               row%drive = equation%drive
               row%pair = equation%pair
               row%angular = equation%kind == equation_angle
               b%list(i)%explicit = any(equation%kind == [equation_angle, equation_slide]) &
                  .and. b%list(i)%shape%rows == 1 .and. b%list(i)%shape%n == 1
               if (.not. (b%list(i)%explicit .and. row%angular)) cycle
               ! phi_orientation - phi_less = constant + value, solved for the angle of the block.
               row%other = equation%less
               if (b%unknown(b%list(i)%first) /= equation%less) cycle
               row%other = equation%orientation
               row%sign_of = -1
            end associate
         end do
      end do

      call fill_block_loops(equations, member, b)
      call move_alloc(member, b%equation)
      b%equations = equations
      call find_addresses(b)
   end function new_blocks

   !> Fills loops, body vectors and slides of all blocks that are not explicit, but for the addresses of their entries.
   subroutine fill_block_loops(equations, member, b)
      type(equations_t), intent(in) :: equations   !< with `has_vector` and `counts`
      integer, intent(in) :: member(:)       !< (rows) the number of each row's equation, by block
      type(blocks_t), intent(inout) :: b     !< with its blocks, unknowns and rows
      integer :: column(0:b%unknowns)                 ! of the block that is being filled; 0: another block's unknown
      integer :: latest(0:equations%vector_loops%count)       ! the last block loop made of each vector loop
      integer :: loops, body_vectors, slides          ! how many of each have been filled
      integer :: i, k

      ! Room for all loops: a vector loop whose two components are in different blocks is in both blocks.
      allocate (b%loops(equations%count), b%body_vectors(2*equations%vector_loops%vectors), &
         b%slides(2*equations%vector_loops%slides))

      column = 0
      latest = 0
      loops = 0
      body_vectors = 0
      slides = 0

      do i = 1, size(b%list)
         associate (block => b%list(i))
            block%first_loop = loops + 1
            if (.not. block%explicit) then
               do k = block%first, block%last
                  column(b%unknown(k)) = k - block%first + 1
               end do
               do k = block%first_row, block%last_row
                  call add_row(equations%list(member(k)), k - block%first_row + 1, block%first_loop)
               end do
               column(b%unknown(block%first:block%last)) = 0
            end if
            block%last_loop = loops
         end associate
      end do

      b%loops = b%loops(:loops)
      b%body_vectors = b%body_vectors(:body_vectors)
      b%slides = b%slides(:slides)

   contains

      !> Adds the row of an equation to the block that is being filled, in a loop of its own unless the other component
      !> of its vector loop already has a loop in the block.
      subroutine add_row(equation, row, first_loop)
         type(equation_t), intent(in) :: equation   !< of the row
         integer, intent(in) :: row          !< the number of the row in the block
         integer, intent(in) :: first_loop   !< the first loop of the block, among all loops

         if (any(equation%kind == [equation_x, equation_y])) then
            if (latest(equation%vector_loop) < first_loop) then
               call add_block_loop(equation%vector_loop, loop_components)
               latest(equation%vector_loop) = loops
            end if
            associate (block_loop => b%loops(latest(equation%vector_loop)))
               if (equation%kind == equation_x) block_loop%row_x = row
               if (equation%kind == equation_y) block_loop%row_y = row
            end associate
            return
         end if

         call add_block_loop(equation%vector_loop, merge(loop_projection, loop_angles, &
            equation%kind == equation_projection))
         associate (block_loop => b%loops(loops))
            block_loop%row_x = row
            block_loop%orientation = equation%orientation
            if (equation%kind == equation_slide) block_loop%orientation = b%orientations + equation%orientation
            block_loop%orientation_column = column(block_loop%orientation)
            block_loop%less = equation%less
            block_loop%less_column = column(equation%less)
         end associate
      end subroutine add_row

      !> Adds a vector loop as the block that is being filled has it: first the body vectors that angles of earlier
      !> blocks rotate, then those that angles of the block rotate.
      subroutine add_block_loop(i, kind)
         integer, intent(in) :: i            !< the number of the vector loop; 0: one without vectors
         integer, intent(in) :: kind         !< loop_components, loop_projection or loop_angles
         integer :: k, side

         loops = loops + 1
         associate (block_loop => b%loops(loops), p => equations%vector_loops)
            block_loop%kind = kind
            block_loop%vector_loop = i
            block_loop%first_vector = body_vectors + 1
            do side = 0, 1
               if (side == 1) block_loop%first_own = body_vectors + 1
               do k = p%first_vector(i), p%first_vector(i + 1) - 1
                  if (.not. equations%has_vector(k) .or. p%vector_orientation(k) == 0) cycle
                  if (min(column(p%vector_orientation(k)), 1) /= side) cycle
                  body_vectors = body_vectors + 1
                  b%body_vectors(body_vectors) = body_vector_t(orientation=p%vector_orientation(k), &
                     column=column(p%vector_orientation(k)), source=k)
               end do
            end do
            block_loop%last_vector = body_vectors

            block_loop%first_slide = slides + 1
            do k = p%first_slide(i), p%first_slide(i + 1) - 1
               slides = slides + 1
               b%slides(slides) = slide_t(orientation=p%slide_orientation(k), &
                  orientation_column=column(p%slide_orientation(k)), &
                  unknown=b%orientations + p%slide_number(k), column=column(b%orientations + p%slide_number(k)), &
                  source=k)
            end do
            block_loop%last_slide = slides
         end associate
      end subroutine add_block_loop
   end subroutine fill_block_loops

   !> Finds the addresses of all entries in the Jacobians, and the patterns of the blocks whose Jacobian is best sparse.
   !> Counts how many entries of each Jacobian are cleared before it is assembled.
   subroutine find_addresses(b)
      type(blocks_t), intent(inout) :: b     !< with its loops, body vectors and slides
      type(pattern_t) :: pattern
      ! (columns) Entries come row by row: the last row that has an entry, and the address of that entry.
      integer, allocatable :: latest(:), last(:)
      integer :: i, c, patterns, rows                 ! rows: of a dense matrix; 0: the matrix is sparse

      allocate (b%patterns(count(may_be_sparse(b%list%shape))))
      patterns = 0
      do i = 1, size(b%list)
         if (b%list(i)%explicit) cycle
         associate (shape => b%list(i)%shape)
            if (may_be_sparse(shape)) then
               ! The entries of the columns are counted first, then filled in.
               rows = 0
               pattern = pattern_t()
               latest = spread(0, 1, shape%n)
               last = latest
               call address_entries(b%list(i))
               pattern%first = [0, last]
               do c = 1, shape%n
                  pattern%first(c + 1) = pattern%first(c) + last(c)
               end do

               allocate (pattern%row(pattern%first(shape%n + 1)))
               latest = 0
               last = pattern%first(:shape%n)
               call address_entries(b%list(i))
               if (is_sparse_better(shape%n, size(pattern%row))) then
                  call order_columns(pattern)
                  patterns = patterns + 1
                  b%patterns(patterns) = pattern
                  shape%pattern = patterns
                  shape%entries = size(pattern%row)
                  cycle
               end if
            end if
            rows = shape%rows
            call address_entries(b%list(i))
         end associate
      end do

      b%patterns = b%patterns(:patterns)
      do i = 1, size(b%list)
         associate (block => b%list(i), entries => entries_of(b%list(i)%shape), &
            own => b%loops(b%list(i)%first_loop:b%list(i)%last_loop))
            block%cleared = merge(0, entries, entries == sum((own%last_vector - own%first_own + 1) &
               *(merge(1, 0, own%row_x > 0) + merge(1, 0, own%row_y > 0))))
         end associate
      end do

   contains

      !> Finds the addresses of all entries in the Jacobian of a block, row by row.
      subroutine address_entries(block)
         type(block_t), intent(in) :: block   !< not explicit, with its loops
         integer :: m, k, side, row

         do m = block%first_loop, block%last_loop
            associate (g => b%loops(m))
               do side = 1, 2
                  row = merge(g%row_x, g%row_y, side == 1)
                  if (row == 0) cycle
                  do k = g%first_own, g%last_vector
                     call find_address(row, b%body_vectors(k)%column, b%body_vectors(k)%at(side))
                  end do
                  do k = g%first_slide, g%last_slide
                     call find_address(row, b%slides(k)%column, b%slides(k)%at(side))
                     call find_address(row, b%slides(k)%orientation_column, b%slides(k)%orientation_at(side))
                  end do
               end do
               call find_address(g%row_x, g%orientation_column, g%orientation_at)
               call find_address(g%row_x, g%less_column, g%less_at)
            end associate
         end do
      end subroutine address_entries

      !> Finds the address of an entry in the Jacobian of a block, and completes the pattern if that is being filled.
      !> Entries must come row by row; several may have one address.
      subroutine find_address(row, column, at)
         integer, intent(in) :: row          !< the number of its row in the block
         integer, intent(in) :: column       !< the number of its column; 0: an earlier block has the unknown
         integer, intent(out) :: at          !< the address among the entries, from 1; 0: there is no column

         at = 0
         if (column == 0) return
         if (rows > 0) then
            at = row + (column - 1)*rows
            return
         end if
         if (latest(column) /= row) then
            latest(column) = row
            last(column) = last(column) + 1
            if (allocated(pattern%row)) pattern%row(last(column)) = row - 1
         end if
         at = last(column)
      end subroutine find_address
   end subroutine find_addresses

   !> Tells whether a Jacobian is square and has so many rows that it would be best sparse with few entries.
   elemental logical function may_be_sparse(shape)
      type(matrix_layout_t), intent(in) :: shape   !< the layout of the matrix

      may_be_sparse = shape%rows == shape%n .and. is_sparse_better(shape%n, 0)
   end function may_be_sparse
end module block_structure
