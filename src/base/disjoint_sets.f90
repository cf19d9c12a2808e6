!> Numbers 1, 2, ... in groups: sorted by the group of each, or joined by pairs. Time and memory are in proportion to
!> the counts of numbers, groups and pairs.
module disjoint_sets
   implicit none
   private
   public :: sorted_t, sorted, sorted_numbers, members, once, joined

   !> Numbers sorted by group. The numbers of group k are member(first(k)), ..., member(first(k + 1) - 1), increasing;
   !> `first` (groups + 1) ends with the number of all members + 1.
   type :: sorted_t
      integer, allocatable :: first(:), member(:)
   end type sorted_t

contains

   !> Sorts the numbers 1, 2, ... by their groups (counting sort). The result leaves out the numbers of group 0.
   pure function sorted(group, groups) result(s)
      integer, intent(in) :: group(:)        !< (numbers) the group of each: 0 to `groups`
      integer, intent(in) :: groups          !< how many groups there are
      type(sorted_t) :: s
      integer :: next(0:groups), i

      next = 0
      do i = 1, size(group)
         next(group(i)) = next(group(i)) + 1
      end do

      allocate (s%first(groups + 1), s%member(sum(next(1:))), source=1)
      do i = 1, groups
         s%first(i + 1) = s%first(i) + next(i)
      end do

      next(1:) = s%first(:groups)
      do i = 1, size(group)
         if (group(i) == 0) cycle
         s%member(next(group(i))) = i
         next(group(i)) = next(group(i)) + 1
      end do
   end function sorted

   !> Sorts a list of numbers by group. A number may be in several groups, and several times in one group. The numbers
   !> of a group do not decrease.
   pure function sorted_numbers(number, group, groups) result(s)
      integer, intent(in) :: number(:)       !< (entries) a number above 0
      integer, intent(in) :: group(:)        !< (entries) the group that has it: 1 to `groups`; 0: the entry is left out
      integer, intent(in) :: groups          !< how many groups there are
      type(sorted_t) :: s, by_number

      by_number = sorted(number, maxval([0, number]))
      s = sorted(group(by_number%member), groups)
      s%member = number(by_number%member(s%member))
   end function sorted_numbers

   !> Gives the numbers (any number) of one group, in the order of `lists`.
   pure function members(lists, k) result(list)
      type(sorted_t), intent(in) :: lists    !< numbers by group, as `sorted` gives them
      integer, intent(in) :: k   !< the group, counted from 1
      integer, allocatable :: list(:)

      list = lists%member(lists%first(k):lists%first(k + 1) - 1)
   end function members

   !> Gives the first number of each run of equal numbers, in the order of the list.
   pure function once(list) result(short)
      integer, intent(in) :: list(:)         !< (any length) numbers in any order
      integer, allocatable :: short(:)
      integer :: i

      short = pack(list, [(i == 1 .or. list(max(i - 1, 1)) /= list(i), i=1, size(list))])
   end function once

   !> Joins numbers 1, 2, ... by pairs (union-find), and gives the group (numbers) of each. Groups are numbered from 1
   !> in the order of their least members. A number that does not count is in group 0 and joins nothing.
   pure function joined(counts, first, second) result(group)
      logical, intent(in) :: counts(:)       !< (numbers) the number counts: it has a group
      integer, intent(in) :: first(:)        !< (pairs) one number of each pair
      integer, intent(in) :: second(:)       !< (pairs) the other number of each pair
      integer :: group(size(counts)), parent(size(counts)), i, k, root_a, root_b

      parent = [(i, i=1, size(counts))]
      do k = 1, size(first)
         if (.not. (counts(first(k)) .and. counts(second(k)))) cycle
         call find_root(parent, first(k), root_a)
         call find_root(parent, second(k), root_b)
         parent(max(root_a, root_b)) = min(root_a, root_b)
      end do

      group = 0
      k = 0
      do i = 1, size(counts)
         if (.not. counts(i)) cycle
         if (parent(i) == i) then
            k = k + 1
            group(i) = k
         else
            ! The parent is a smaller number: its group is known.
            group(i) = group(parent(i))
         end if
      end do
   end function joined

   !> Finds the root of the tree that has a number, and shortens the path to the root by half for later calls.
   pure subroutine find_root(parent, i, root)
      integer, intent(inout) :: parent(:)    !< (numbers) the next number on the way to the root; of a root, itself
      integer, intent(in) :: i               !< the number
      integer, intent(out) :: root           !< the root of its tree

      root = i
      do while (parent(root) /= root)
         parent(root) = parent(parent(root))
         root = parent(root)
      end do
   end subroutine find_root
end module disjoint_sets
