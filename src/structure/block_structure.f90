!> The structure by which the engine of one independent mechanism solves it: the tree of its links, and its blocks.
module block_structure
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use scales, only: solver_length, power_of_two
   use links_tree, only: tree_t, new_tree, renew_tree
   use matching, only: incidence_t
   use loop_equations, only: equations_t, new_equations
   use blocks, only: blocks_t
   use block_partition, only: new_blocks, renew_blocks, find_units
   implicit none
   private
   public :: structure_t, new_structure, renew_structure

   !> Made once, and handed to the engine, which takes the blocks over.
   type :: structure_t
      real(wp) :: span = 1.0_wp                 !< the characteristic length, in the deck's unit
      real(wp) :: length = 1.0_wp               !< the unit of lengths in the blocks: the power of two next to `span`
      type(tree_t) :: tree
      type(blocks_t), allocatable :: blocks
      logical :: is_renewed = .false.           !< the blocks are those of a variant before, with new numbers
   end type structure_t

contains

   !> The structure of the independent mechanism `m`. Time and memory proportional to its links, pairs and drives.
   function new_structure(m) result(s)
      type(mechanism_t), intent(in) :: m
      type(structure_t) :: s

      call renew_structure(m, s)
   end function new_structure

   !> The same. Where `s` has blocks already, they are those of a variant of `m`: they stay, and get other numbers, as
   !> long as each equation has the unknowns that it had.
   subroutine renew_structure(m, s)
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout) :: s
      type(equations_t) :: e

      s%span = solver_length(m)
      s%length = power_of_two(s%span)
      s%is_renewed = allocated(s%blocks)
      if (s%is_renewed) call renew_tree(m, s%tree)
      if (.not. s%is_renewed) s%tree = new_tree(m)
      e = new_equations(m, s%tree, s%length)
      if (s%is_renewed) call renew_blocks(e, s%blocks, s%is_renewed)
      if (.not. s%is_renewed) then
         if (.not. allocated(s%blocks)) allocate (s%blocks)
         s%blocks = new_blocks(s%tree, e)
         if (m%variants == 0) s%blocks%incidence = incidence_t()
      end if
      if (s%blocks%solvable) call find_units(s%blocks)
   end subroutine renew_structure
end module block_structure
