!> Tests. Equations and blocks with all lengths in one unit that is given.
module sample_blocks
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use links_tree, only: tree_t, new_tree, put_axes
   use loop_equations, only: equations_t, new_equations, equation_numbers_t, new_equation_numbers
   use blocks, only: blocks_t, numbers_t
   use block_structure, only: new_blocks
   use block_numbers, only: fill_numbers, lipschitz_of
   implicit none
   private
   public :: plain_blocks, make_equations, tree_blocks

contains

   !> The tree of `m` and the axes of its links, as blocks without equations; lengths in units of `length`.
   function tree_blocks(m, length) result(b)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length
      type(blocks_t) :: b

      b%tree = new_tree(m)
      b%unknowns = b%tree%orientations + b%tree%slides + 2*maxval(b%tree%root)
      allocate (b%numbers)
      b%numbers%equations%length = length
      allocate (b%numbers%unit(0:b%unknowns), source=1.0_wp)
      associate (a => b%numbers%equations%axes)
         allocate (a%angle_offset(size(m%links)), a%turn(2, size(m%links)))
         call put_axes(m, b%tree, a)
      end associate
   end function tree_blocks

   !> The equations `e` of `m` with their numbers `x`, lengths in units of `length`.
   subroutine make_equations(m, length, e, x)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length
      type(equations_t), intent(out) :: e
      type(equation_numbers_t), intent(out) :: x
      type(tree_t) :: t

      t = new_tree(m)
      e = new_equations(m, t)
      x = new_equation_numbers(m, t, length, e)
   end subroutine make_equations

   !> The blocks of `m`, lengths in units of `length`.
   function plain_blocks(m, length) result(b)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: length
      type(blocks_t) :: b
      type(equations_t) :: e
      type(numbers_t) :: x
      integer :: i

      x%span = length
      call make_equations(m, length, e, x%equations)
      b = new_blocks(new_tree(m), e)
      b%numbers = x
      if (.not. b%solvable) return
      call fill_numbers(b, x)
      x%blocks%coarse = 1.0_wp
      do i = 1, size(b%list)
         x%blocks(i)%lipschitz = lipschitz_of(b, x, b%list(i))
      end do
      b%numbers = x
   end function plain_blocks
end module sample_blocks
