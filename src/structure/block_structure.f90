!> The structure by which the engine of one independent mechanism solves it: its blocks.
module block_structure
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use scales, only: solver_length, power_of_two
   use links_tree, only: tree_t, new_tree
   use loop_equations, only: equations_t, new_equations, equation_numbers_t, new_equation_numbers
   use blocks, only: blocks_t
   use block_numbers, only: add_numbers
   use block_partition, only: new_blocks
   implicit none
   private
   public :: structure_t, make_structure

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
end module block_structure
