!> Level 9. The blocks as engineers know them: Assur groups, told by their links. A link belongs to the first block
!> after which all of its position is known. Order: a group after those it builds on, within one depth by the
!> deck's links; so the order is the mechanism's, whatever the blocks' own was.
module assur_groups
   use mechanism, only: mechanism_t
   use links_tree, only: tree_t
   use blocks, only: blocks_t
   use block_needs, only: wanted_links, needed_blocks, largest_known
   implicit none
   private
   public :: group_t, groups_of

   type :: group_t
      integer, allocatable :: links(:)
      logical :: driven = .false.         !< a drive is part of it
      logical :: needed = .true.          !< some table names one of its links, or a later group's
   end type group_t

contains

   !> The groups of `m` from its solvable blocks `b` on the tree `t`.
   function groups_of(m, t, b) result(groups)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(blocks_t), intent(in) :: b
      type(group_t), allocatable :: groups(:)
      integer :: block_of(size(m%links)), owner(size(b%list)), number(size(b%list)), i
      logical :: driven(size(b%list)), needed(size(b%list))

      call find_blocks_of_links(m, t, b, block_of, owner)
      call number_groups(b, block_of, number)
      allocate (groups(maxval([0, number])))
      driven = .false.
      needed = .false.
      needed(needed_blocks(b, t, wanted_links(m))) = .true.
      do i = 1, size(groups)
         groups(i)%needed = .false.
      end do
      do i = 1, size(b%list)
         if (owner(i) == 0) cycle
         associate (g => groups(number(owner(i))))
            g%driven = g%driven .or. any(b%rows(b%list(i)%first:b%list(i)%last)%drive > 0)
            g%needed = g%needed .or. needed(i)
         end associate
      end do
      call share_out_links(block_of, number, groups)
   end function groups_of

   !> `block_of` (links): the last block on the way from the ground to the link, 0 for ground links. `owner`
   !> (blocks): the block of the first link that uses it.
   subroutine find_blocks_of_links(m, t, b, block_of, owner)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(blocks_t), intent(in) :: b
      integer, intent(out) :: block_of(:), owner(:)
      integer :: uses(4), n, i, link

      block_of = 0
      owner = 0
      do i = 1, size(t%order)
         link = t%order(i)
         if (m%links(link)%ground) cycle
         n = 0
         if (t%frame(link) > 0) call use_unknown(t%frame(link))
         if (t%above(link) > 0) then
            block_of(link) = block_of(t%above(link))
            if (t%slide(t%hung_by(link)) > 0) call use_unknown(b%frames + t%slide(t%hung_by(link)))
         else
            call use_unknown(b%frames + t%slides + 2*t%root(link) - 1)
            call use_unknown(b%frames + t%slides + 2*t%root(link))
         end if
         block_of(link) = maxval([block_of(link), uses(:n)])
         where (owner(uses(:n)) == 0 .or. owner(uses(:n)) > block_of(link)) owner(uses(:n)) = block_of(link)
      end do

   contains

      subroutine use_unknown(u)
         integer, intent(in) :: u

         n = n + 1
         uses(n) = b%block_of(u)
      end subroutine use_unknown
   end subroutine find_blocks_of_links

   !> `number` (blocks): of the group that a block with links is, 0 for others.
   subroutine number_groups(b, block_of, number)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: block_of(:)
      integer, intent(out) :: number(:)
      logical :: has_links(0:size(number))
      integer :: depth(size(number)), depth_of(0:b%unknowns), first(size(number) + 2), i

      has_links = .false.
      has_links(block_of) = .true.
      depth_of = 0
      first = 0
      do i = 1, size(number)
         depth(i) = largest_known(b, i, depth_of) + merge(1, 0, has_links(i))
         depth_of(b%unknown(b%list(i)%first:b%list(i)%last)) = depth(i)
         if (has_links(i)) first(depth(i) + 2) = first(depth(i) + 2) + 1
      end do
      do i = 2, size(first)
         first(i) = first(i) + first(i - 1)
      end do
      number = 0
      do i = 1, size(block_of)
         if (block_of(i) == 0) cycle
         if (number(block_of(i)) > 0) cycle
         first(depth(block_of(i)) + 1) = first(depth(block_of(i)) + 1) + 1
         number(block_of(i)) = first(depth(block_of(i)) + 1)
      end do
   end subroutine number_groups

   subroutine share_out_links(block_of, number, groups)
      integer, intent(in) :: block_of(:), number(:)
      type(group_t), intent(inout) :: groups(:)
      integer :: members(size(groups)), i

      members = 0
      do i = 1, size(block_of)
         if (block_of(i) > 0) members(number(block_of(i))) = members(number(block_of(i))) + 1
      end do
      do i = 1, size(groups)
         allocate (groups(i)%links(members(i)))
      end do
      members = 0
      do i = 1, size(block_of)
         if (block_of(i) == 0) cycle
         associate (g => number(block_of(i)))
            members(g) = members(g) + 1
            groups(g)%links(members(g)) = i
         end associate
      end do
   end subroutine share_out_links
end module assur_groups
