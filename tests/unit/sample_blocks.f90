!> Tests. Equations and blocks with all lengths in one unit that is given.
module sample_blocks
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use spanning_tree, only: spanning_tree_t, new_tree
   use loop_equations, only: equations_t, new_equations, equation_numbers_t, new_equation_numbers
   use blocks, only: blocks_t, geometry_t
   use block_structure, only: new_blocks
   use block_numbers, only: fill_numbers, lipschitz_of
   implicit none
   private
   public :: plain_blocks

contains

   !> The equations `e` of `m` with their numbers `x`, lengths in units of `length`.
   subroutine make_equations(m, length, e, x)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length
      type(equations_t), intent(out) :: e
      type(equation_numbers_t), intent(out) :: x
      type(spanning_tree_t) :: t

      t = new_tree(m)
      e = new_equations(m, t)
      x = new_equation_numbers(m, t, length, e)
   end subroutine make_equations

   !> The blocks `b` of `m` and their geometry `x`, lengths in units of `length`.
   subroutine plain_blocks(m, length, b, x)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length
      type(blocks_t), intent(out) :: b
      type(geometry_t), intent(out) :: x
      type(equations_t) :: e
      integer :: i

      x%span = length
      call make_equations(m, length, e, x%equations)
      b = new_blocks(new_tree(m), e)
      if (.not. b%solvable) return
      call fill_numbers(b, x)
      x%blocks%coarse = 1.0_wp
      do i = 1, size(b%list)
         x%blocks(i)%lipschitz = lipschitz_of(b, x, b%list(i))
      end do
   end subroutine plain_blocks
end module sample_blocks
