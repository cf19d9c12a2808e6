!> The structure by which the engine of one independent mechanism solves it: its blocks, that is matching and strongly
!> connected components on which unknown is in which equation, the part with too many equations first.
module block_structure
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use scales, only: solver_length, power_of_two
   use links_tree, only: tree_t, new_tree
   use matching, only: incidence_t, match, find_blocks, overdetermined
   use loop_equations, only: equations_t, new_equations, equation_numbers_t, new_equation_numbers, incidence, &
      equation_angle, equation_slide
   use blocks, only: blocks_t
   use block_loops, only: fill_block_loops, find_places
   use block_numbers, only: add_numbers
   implicit none
   private
   public :: structure_t, make_structure, new_blocks

   !> Made once, and handed to the engine, which takes the blocks over.
   type :: structure_t
      type(blocks_t), allocatable :: blocks
   end type structure_t

contains

   !> Makes the structure `s` of the independent mechanism `m`, in place. Time and memory are proportional to its links,
   !> pairs and drives.
   subroutine make_structure(m, s)
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(out) :: s
      type(tree_t) :: t
      type(equations_t) :: e
      type(equation_numbers_t) :: numbers
      real(wp) :: span

      span = solver_length(m)
      t = new_tree(m)
      e = new_equations(m, t)
      numbers = new_equation_numbers(m, t, power_of_two(span), e)
      allocate (s%blocks)
      s%blocks = new_blocks(t, e)
      call add_numbers(span, numbers, s%blocks)
   end subroutine make_structure

   !> The blocks of the equations `e` on the tree `t`, without numbers.
   function new_blocks(t, e) result(b)
      type(tree_t), intent(in) :: t
      type(equations_t), intent(in) :: e
      type(blocks_t) :: b
      type(incidence_t) :: g
      integer, allocatable :: unknown_of(:), equation_of(:), first(:), member(:), rows(:)
      logical :: over(e%count)
      integer :: i, k

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
      ! The block of the equations that are too many comes first: it needs nothing of the others.
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

      ! Drives, and which blocks need no iteration.
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

      call fill_block_loops(e, member, b)
      call move_alloc(member, b%equation)
      b%equations = e
      call find_places(b)
   end function new_blocks
end module block_structure
