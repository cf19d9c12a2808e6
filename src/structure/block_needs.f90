!> Which blocks have to be solved: those whose unknowns move a link that a table names, those that they build
!> on, and no other; and of these again and again only what a drive moves.
module block_needs
   use links_tree, only: tree_t
   use blocks, only: blocks_t
   implicit none
   private
   public :: needed_blocks, moving_blocks, blocks_below, largest_known

contains

   !> The blocks, in solving order, that the links `wanted` (links) need; equations that are too many are always
   !> looked at.
   function needed_blocks(b, t, wanted) result(list)
      type(blocks_t), intent(in) :: b
      type(tree_t), intent(in) :: t
      logical, intent(in) :: wanted(:)
      integer, allocatable :: list(:)
      logical :: need(0:b%unknowns), needed(size(b%list))
      integer :: i

      need = .false.
      call need_links(b, t, wanted, need)
      do i = size(b%list), 1, -1
         needed(i) = any(need(b%unknown(b%list(i)%first:b%list(i)%last))) &
            .or. b%list(i)%shape%rows > b%list(i)%shape%n
         if (needed(i)) call need_known(b, i, need)
      end do
      list = pack([(i, i=1, size(b%list))], needed)
   end function needed_blocks

   !> Block `i` and those that it builds on, in solving order.
   function blocks_below(b, i) result(list)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      integer, allocatable :: list(:)
      logical :: need(0:b%unknowns), below(i)
      integer :: k

      need = .false.
      do k = i, 1, -1
         below(k) = k == i .or. any(need(b%unknown(b%list(k)%first:b%list(k)%last)))
         if (below(k)) call need_known(b, k, need)
      end do
      list = pack([(k, k=1, i)], below)
   end function blocks_below

   !> Angles and slides of the wanted links and of those between them and the ground.
   subroutine need_links(b, t, wanted, need)
      type(blocks_t), intent(in) :: b
      type(tree_t), intent(in) :: t
      logical, intent(in) :: wanted(:)
      logical, intent(inout) :: need(0:)
      logical :: chain(size(wanted))
      integer :: i, link

      chain = wanted
      do i = size(t%order), 1, -1
         link = t%order(i)
         if (.not. chain(link)) cycle
         need(t%orientation(link)) = .true.
         if (t%parent(link) > 0) then
            chain(t%parent(link)) = .true.
            if (t%slide(t%parent_joint(link)) > 0) need(b%orientations + t%slide(t%parent_joint(link))) = .true.
         else if (t%root(link) > 0) then
            need(b%orientations + t%slides + 2*t%root(link) - 1:b%orientations + t%slides + 2*t%root(link)) = .true.
         end if
      end do
   end subroutine need_links

   !> What block `i` needs of the others.
   pure subroutine need_known(b, i, need)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      logical, intent(inout) :: need(0:)
      integer :: m

      need(b%rows(b%list(i)%first_row:b%list(i)%last_row)%other) = .true.
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            need(b%body_vectors(g%first_vector:g%last_vector)%orientation) = .true.
            need(b%slides(g%first_slide:g%last_slide)%orientation) = .true.
            need(b%slides(g%first_slide:g%last_slide)%unknown) = .true.
            need(g%orientation) = .true.
            need(g%less) = .true.
         end associate
      end do
   end subroutine need_known

   !> (size(list)) Those of the blocks `list` that a drive moves, itself or through what they build on.
   pure function moving_blocks(b, list) result(moving)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: list(:)
      logical :: moving(size(list))
      integer :: moves(0:b%unknowns), k

      moves = 0
      do k = 1, size(list)
         associate (block => b%list(list(k)))
            moving(k) = any(b%rows(block%first_row:block%last_row)%drive > 0) .or. largest_known(b, list(k), moves) > 0
            moves(b%unknown(block%first:block%last)) = merge(1, 0, moving(k))
         end associate
      end do
   end function moving_blocks

   !> The largest `mark` (0:unknowns) of what block `i` builds on; 0 at least. Marks of its own unknowns are 0.
   pure integer function largest_known(b, i, mark) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, mark(0:)
      integer :: m

      largest = max(0, maxval(mark(b%rows(b%list(i)%first_row:b%list(i)%last_row)%other)))
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            largest = max(largest, mark(g%orientation), mark(g%less), &
               maxval(mark(b%body_vectors(g%first_vector:g%last_vector)%orientation)), &
               maxval(mark(b%slides(g%first_slide:g%last_slide)%orientation)), &
               maxval(mark(b%slides(g%first_slide:g%last_slide)%unknown)))
         end associate
      end do
   end function largest_known
end module block_needs
