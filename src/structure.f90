!> Level 8. What can be said of a mechanism before anything is solved: its counts, and its Assur groups.
!>
!> (12)  r = 2 (n1 + n2) + 3 n3
!> (13)  s = 3 n - r        (the print subtracts 2 n1 + n2 only)
module structure
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_revolute, pair_prismatic, wanted_links
   use matching, only: match
   use closure_incidence, only: closure_t, new_closure
   use assur_groups, only: group_t, groups_of
   use links_tree, only: tree_t, new_tree
   use loop_equations, only: new_equations
   use blocks, only: blocks_t, new_blocks
   implicit none
   private
   public :: findings_t, group_t, count_freedoms, find_structure

   type :: findings_t
      integer :: links = 0        !< n, ground links with them
      integer :: ground = 0       !< n3
      integer :: revolute = 0     !< n1
      integer :: prismatic = 0    !< n2
      integer :: coordinates = 0  !< w = 3 n
      integer :: equations = 0    !< r
      integer :: freedoms = 0     !< s
      integer :: drives = 0
      logical :: solvable = .false.             !< every unknown has an equation of its own
      type(group_t), allocatable :: groups(:)   !< in solving order; none where it is not
   end type findings_t

contains

   !> Counts (12) and (13) of mechanism `m`.
   pure function count_freedoms(m) result(f)
      type(mechanism_t), intent(in) :: m
      type(findings_t) :: f

      f%links = size(m%links)
      f%ground = count(m%links%ground)
      f%revolute = count(m%pairs%kind == pair_revolute)
      f%prismatic = count(m%pairs%kind == pair_prismatic)
      f%coordinates = 3*f%links
      f%equations = 2*(f%revolute + f%prismatic) + 3*f%ground
      f%freedoms = f%coordinates - f%equations
      f%drives = size(m%drives)
      allocate (f%groups(0))
   end function count_freedoms

   !> The counts of `m` and its groups.
   function find_structure(m) result(f)
      type(mechanism_t), intent(in) :: m
      type(findings_t) :: f
      type(closure_t) :: c
      type(tree_t) :: t
      type(blocks_t) :: b
      integer, allocatable :: unknown_of(:), equation_of(:)

      f = count_freedoms(m)
      c = new_closure(m)
      call match(c%incidence, unknown_of, equation_of)
      f%solvable = all(unknown_of > 0) .and. all(equation_of > 0)
      t = new_tree(m)
      b = new_blocks(t, new_equations(m, t, 1.0_wp))
      f%solvable = f%solvable .and. b%solvable
      if (f%solvable) f%groups = groups_of(m, c, unknown_of, equation_of, wanted_links(m))
   end function find_structure
end module structure
