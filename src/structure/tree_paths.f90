!> Short paths between links over the pairs taken so far: those of the tree, and each revolute pair once it has
!> closed its loop. A loop that takes the shortest such path holds its own pair and earlier ones only, so all loops are
!> independent; and it holds few links, so the blocks stay small and the work proportional to the links.
module tree_paths
   use mechanism, only: mechanism_t, pair_revolute
   use links_tree, only: tree_t, other_link
   implicit none
   private
   public :: search_t, new_search, find_path, find_path_down, close_pair

   !> What a search needs; links are nodes, all ground links one, node 0.
   type :: search_t
      logical, allocatable :: open(:)       !< (pairs) can be gone through
      integer, allocatable :: pairs(:)      !< (length) the path found last
      integer :: length = 0
      integer, allocatable :: via(:)        !< (0:links, of either end, flat) pair by which a node was reached
      integer, allocatable :: seen(:)       !< number of the search that reached it
      integer, allocatable :: queue(:, :)   !< (0:links, 2)
      integer :: number = 0
   end type search_t

contains

   !> Before any loop is closed.
   function new_search(m, t) result(s)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(search_t) :: s
      integer :: i

      allocate (s%open(size(m%pairs)), source=.false.)
      do i = 1, size(m%links)
         if (t%parent_joint(i) > 0) s%open(t%parent_joint(i)) = .true.
      end do
      allocate (s%via(0:2*size(m%links) + 1), s%seen(0:2*size(m%links) + 1), source=0)
      allocate (s%queue(0:size(m%links), 2), s%pairs(size(m%links) + 1))
   end function new_search

   !> From now on paths lead through revolute pair `k`.
   subroutine close_pair(m, k, s)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      type(search_t), intent(inout) :: s

      s%open(k) = m%pairs(k)%kind == pair_revolute
   end subroutine close_pair

   !> `s%pairs`: the pairs down the tree from `link` to a ground link or a root.
   subroutine find_path_down(t, link, s)
      type(tree_t), intent(in) :: t
      integer, intent(in) :: link
      type(search_t), intent(inout) :: s
      integer :: i

      s%length = 0
      i = link
      do while (t%parent(i) > 0)
         s%length = s%length + 1
         s%pairs(s%length) = t%parent_joint(i)
         i = t%parent(i)
      end do
   end subroutine find_path_down

   !> `s%pairs`: the pairs on a short path from link `i` to link `j`, which are joined. Breadth first from both ends in
   !> turn; the ground ends a path and is never searched level by level, since all links may be joined to it.
   subroutine find_path(m, t, i, j, s)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      integer, intent(in) :: i, j
      type(search_t), intent(inout) :: s
      integer :: first(2), last(2), side, meeting

      s%number = s%number + 1
      s%length = 0
      if (node(m, i) == node(m, j)) return
      first = 0
      last = -1
      meeting = -1
      call reach(1, node(m, i), 0)
      call reach(2, node(m, j), 0)
      do while (meeting < 0)
         do side = 1, 2
            if (meeting < 0) call go_on(side)
         end do
      end do
      call collect(m, i, j, meeting, s)

   contains

      !> One level more from an end.
      subroutine go_on(side)
         integer, intent(in) :: side
         integer :: n, level_end, k, p, link

         level_end = last(side)
         do n = first(side), level_end
            link = s%queue(n, side)
            do k = t%near%first(link), t%near%first(link + 1) - 1
               p = t%near%member(k)
               if (s%open(p)) call reach(side, node(m, other_link(m, p, link)), p)
               if (meeting >= 0) return
            end do
         end do
         first(side) = level_end + 1
      end subroutine go_on

      !> The search from end `side` comes to node `n` through `pair`.
      subroutine reach(side, n, pair)
         integer, intent(in) :: side, n, pair

         if (s%seen(2*n + side - 1) == s%number) return
         s%seen(2*n + side - 1) = s%number
         s%via(2*n + side - 1) = pair
         if (s%seen(2*n + 2 - side) == s%number) meeting = n
         if (n == 0) return
         last(side) = last(side) + 1
         s%queue(last(side), side) = n
      end subroutine reach
   end subroutine find_path

   !> The node of `link`: 0 for every ground link.
   pure integer function node(m, link)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link

      node = merge(0, link, m%links(link)%ground)
   end function node

   !> The pairs from link `i` to node `meeting` and on to link `j`, from those by which the nodes were reached.
   subroutine collect(m, i, j, meeting, s)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, j, meeting
      type(search_t), intent(inout) :: s

      call go_back(1, node(m, i))
      s%pairs(:s%length) = s%pairs(s%length:1:-1)
      call go_back(2, node(m, j))

   contains

      !> Appends the pairs from the meeting node back to the node `goal`, where the search from `side` began.
      subroutine go_back(side, goal)
         integer, intent(in) :: side, goal
         integer :: n, k

         n = meeting
         do while (n /= goal)
            k = s%via(2*n + side - 1)
            s%length = s%length + 1
            s%pairs(s%length) = k
            ! The node at the other end.
            n = node(m, m%points(m%pairs(k)%point_i)%link) + node(m, m%points(m%pairs(k)%point_j)%link) - n
         end do
      end subroutine go_back
   end subroutine collect
end module tree_paths
