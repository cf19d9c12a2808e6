!> The blocks of a mechanism: matching and strongly connected components on which unknown is in which equation, the part
!> with too many equations first.
module block_partition
   use links_tree, only: tree_t
   use block_matrix, only: shape_t
   use matching, only: incidence_t, match, find_blocks, overdetermined
   use loop_equations, only: equations_t, incidence, equation_angle, equation_slide
   use blocks, only: blocks_t, block_t
   use block_loops, only: fill_block_loops, find_places
   implicit none
   private
   public :: new_blocks

contains

   !> The blocks of the equations `e` on the tree `t`, without numbers.
   function new_blocks(t, e) result(b)
      type(tree_t), intent(in) :: t
      type(equations_t), intent(in) :: e
      type(blocks_t) :: b
      type(incidence_t) :: g
      integer, allocatable :: unknown_of(:), equation_of(:), first(:), member(:)
      logical :: over(e%count)
      integer :: i

      b%tree = t
      b%orientations = t%orientations
      b%unknowns = t%orientations + t%slides + 2*t%roots
      g = incidence(e, b%orientations, b%unknowns)
      call match(g, unknown_of, equation_of)
      b%free = pack([(i, i=1, b%unknowns)], equation_of == 0)
      b%solvable = size(b%free) == 0
      b%redundant = count(unknown_of == 0)
      if (.not. b%solvable) return
      over = overdetermined(g, unknown_of, equation_of)
      call find_blocks(g, equation_of, first, member, over)
      allocate (b%list(size(first) - 1))
      do i = 1, size(b%list)
         associate (block => b%list(i))
            block%first = first(i)
            block%last = first(i + 1) - 1
            block%shape%n = block%last - block%first + 1
            block%shape%rows = block%shape%n
         end associate
      end do
      b%list%first_row = b%list%first
      b%list%last_row = b%list%last
      b%unknown = unknown_of(member)
      if (b%redundant > 0) call put_first(over)
      allocate (b%block_of(b%unknowns))
      do i = 1, size(b%list)
         b%block_of(b%unknown(b%list(i)%first:b%list(i)%last)) = i
      end do
      call fill_rows()
      call fill_block_loops(e, member, b)
      call move_alloc(member, b%equation)
      b%equations = e
      call find_places(b)

   contains

      !> Puts the block of the equations that are `over` before the others: it needs nothing of them.
      subroutine put_first(over)
         logical, intent(in) :: over(:)
         type(block_t) :: block
         integer, allocatable :: rows(:)
         integer :: i

         rows = pack([(i, i=1, size(over))], over)
         block%last_row = size(rows)
         block%last = count(unknown_of(rows) > 0)
         block%shape = shape_t(rows=block%last_row, n=block%last)
         b%list%first = b%list%first + block%last
         b%list%last = b%list%last + block%last
         b%list%first_row = b%list%first_row + block%last_row
         b%list%last_row = b%list%last_row + block%last_row
         b%list = [block, b%list]
         b%unknown = [pack(unknown_of(rows), unknown_of(rows) > 0), b%unknown]
         member = [rows, member]
      end subroutine put_first

      !> Drives, and which blocks need no iteration.
      subroutine fill_rows()
         integer :: i, k

         allocate (b%rows(size(member)))
         do i = 1, size(b%list)
            do k = b%list(i)%first_row, b%list(i)%last_row
               associate (equation => e%list(member(k)), row => b%rows(k))
                  row%drive = equation%drive
                  row%pair = equation%pair
                  row%angular = equation%kind == equation_angle
                  b%list(i)%direct = any(equation%kind == [equation_angle, equation_slide]) &
                     .and. b%list(i)%shape%rows == 1 .and. b%list(i)%shape%n == 1
                  if (.not. (b%list(i)%direct .and. row%angular)) cycle
                  ! phi_orientation - phi_less = constant + value, solved for the one that is unknown.
                  row%other = equation%less
                  if (b%unknown(b%list(i)%first) /= equation%less) cycle
                  row%other = equation%orientation
                  row%sign_of = -1
               end associate
            end do
         end do
      end subroutine fill_rows
   end function new_blocks
end module block_partition
