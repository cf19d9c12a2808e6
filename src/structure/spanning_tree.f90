!> The spanning tree of a mechanism, which makes its unknowns few, and the points and guides in its axes. Links that
!> prismatic pairs join turn together: they share one orientation and one unknown angle. A link that a revolute pair
!> joins to its parent needs no x and y of its own. The pairs left over close the loops.
!>
!> The tree grows from the ground, revolute pairs first: a prismatic pair that closes a loop costs one equation and
!> no unknown, a prismatic pair in the tree costs a slide. The tree is integers only; its axes are `axes_t`.
module spanning_tree
   use kinds, only: wp
   use plane_vectors, only: direction, rotated, quarter_turn
   use disjoint_sets, only: sorted_t, sorted
   use mechanism, only: mechanism_t, has_guide, pair_links
   implicit none
   private
   public :: spanning_tree_t, new_tree, axes_t, other_link, point_offset, guide

   !> Links and pairs have the numbers of the mechanism.
   type :: spanning_tree_t
      integer :: orientations = 0           !< how many angles are unknown; orientation 0 is the ground's
      integer :: slides = 0                 !< how many prismatic pairs are in the tree
      integer :: roots = 0                  !< how many parts of the mechanism no pair joins to the ground
      integer, allocatable :: orientation(:)     !< (links) the number of its orientation
      integer, allocatable :: by_angle(:)        !< (links) their numbers: `angle_pair` leads to an earlier link
      integer, allocatable :: angle_pair(:)      !< (links) the prismatic pair that gives its angle; 0: none
      integer, allocatable :: parent_joint(:)    !< (links) the pair to the parent; 0: ground or root
      integer, allocatable :: parent(:)      !< (links) the next link towards the ground; 0: ground or root
      integer, allocatable :: depth(:)      !< (links) pairs between it and the ground or the root of its part
      integer, allocatable :: root(:)       !< (links) the number of its part; 0: pairs join it to the ground
      integer, allocatable :: order(:)      !< (links) from the ground outwards: parents come first
      integer, allocatable :: slide(:)      !< (pairs) number of its slide; 0: none
      type(sorted_t) :: near               !< the pairs of each link
      integer, allocatable :: surplus(:)    !< prismatic pairs whose angle other prismatic pairs already fix
   end type spanning_tree_t

   !> The axes of a mechanism's links by the numbers of its cards.
   type :: axes_t
      real(wp) :: origin(2) = 0.0_wp             !< from which positions are counted, in the deck's unit of length
      real(wp), allocatable :: angle_offset(:)   !< (links) phi of the link less the angle of its orientation, rad
      real(wp), allocatable :: turn(:, :)        !< (2, links) the unit vector at this angle
   end type axes_t

contains

   !> Makes the tree of a mechanism; time and memory are proportional to links and pairs.
   function new_tree(m) result(t)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t) :: t
      integer :: last, k       ! last: the links that are in the tree so far

      t%near = sorted([(pair_links(m, m%pairs(k)), k=1, size(m%pairs))], size(m%links))
      t%near%member = (t%near%member + 1)/2
      call find_orientations(m, t)
      call grow()

   contains

      !> Joins every link to the tree, breadth first. A prismatic pair is taken only if no revolute pair leads from the
      !> tree to another link.
      subroutine grow()
         integer :: revolute_next, prismatic_next, link
         logical :: attached

         allocate (t%parent_joint(size(m%links)), t%parent(size(m%links)), t%root(size(m%links)), source=0)
         allocate (t%depth(size(m%links)), source=-1)
         allocate (t%order(size(m%links)), t%slide(size(m%pairs)), source=0)

         last = 0
         do link = 1, size(m%links)
            if (m%links(link)%ground) call attach(link, 0, 0)
         end do
         revolute_next = 1
         prismatic_next = 1
         link = 1

         do
            if (revolute_next <= last) then
               call attach_neighbours(.false., t%order(revolute_next), attached)
               revolute_next = revolute_next + 1
            else if (prismatic_next <= last) then
               call attach_neighbours(.true., t%order(prismatic_next), attached)
               if (.not. attached) prismatic_next = prismatic_next + 1
            else
               do while (link <= size(m%links))
                  if (t%depth(link) < 0) exit
                  link = link + 1
               end do
               if (link > size(m%links)) exit
               t%roots = t%roots + 1
               t%root(link) = t%roots
               call attach(link, 0, 0)
            end if
         end do
      end subroutine grow

      !> Joins neighbours of a link that are not yet in the tree: all at its revolute pairs, or one at a prismatic pair.
      subroutine attach_neighbours(sliding, link, attached)
         logical, intent(in) :: sliding      !< one at a prismatic pair; otherwise all at revolute pairs
         integer, intent(in) :: link         !< its number; it is in the tree
         logical, intent(out) :: attached    !< some neighbour was joined
         integer :: i, k

         attached = .false.
         do i = t%near%first(link), t%near%first(link + 1) - 1
            k = t%near%member(i)
            if (has_guide(m%pairs(k)%kind) .neqv. sliding) cycle
            if (t%depth(other_link(m, k, link)) >= 0) cycle
            call attach(other_link(m, k, link), link, k)
            attached = .true.
            if (.not. sliding) cycle
            t%slides = t%slides + 1
            t%slide(k) = t%slides
            return
         end do
      end subroutine attach_neighbours

      !> Joins a link to the tree as its next one.
      subroutine attach(link, parent, pair)
         integer, intent(in) :: link         !< its number
         integer, intent(in) :: parent       !< the number of its parent; 0: ground or root
         integer, intent(in) :: pair         !< the number of the pair between them; 0: ground or root

         last = last + 1
         t%order(last) = link
         t%parent(link) = parent
         t%parent_joint(link) = pair
         t%depth(link) = 0
         if (parent == 0) return
         t%depth(link) = t%depth(parent) + 1
         t%root(link) = t%root(parent)
      end subroutine attach
   end function new_tree

   !> Finds the orientations of links by a walk over prismatic pairs only, first from the ground links, then from every
   !> link not yet met.
   subroutine find_orientations(m, tree)
      type(mechanism_t), intent(in) :: m
      !> With the pairs of each link; orientation, by_angle, angle_pair and surplus are set.
      type(spanning_tree_t), intent(inout) :: tree
      integer :: first, next, last, link, far, i, k   ! last: the links that the walk has come to so far
      logical :: used(size(m%pairs))

      tree%orientation = merge(0, -1, m%links%ground)
      allocate (tree%by_angle(size(m%links)), tree%angle_pair(size(m%links)), source=0)
      allocate (tree%surplus(0))
      used = .false.
      last = count(m%links%ground)
      tree%by_angle(:last) = pack([(i, i=1, size(m%links))], m%links%ground)

      next = 1
      do first = 0, size(m%links)
         if (first > 0) then
            if (tree%orientation(first) >= 0) cycle
            tree%orientations = tree%orientations + 1
            tree%orientation(first) = tree%orientations
            last = last + 1
            tree%by_angle(last) = first
         end if

         do while (next <= last)
            link = tree%by_angle(next)
            next = next + 1
            do i = tree%near%first(link), tree%near%first(link + 1) - 1
               k = tree%near%member(i)
               if (.not. has_guide(m%pairs(k)%kind) .or. used(k)) cycle
               used(k) = .true.
               far = other_link(m, k, link)
               if (tree%orientation(far) >= 0) then
                  tree%surplus = [tree%surplus, k]
                  cycle
               end if
               tree%orientation(far) = tree%orientation(link)
               tree%angle_pair(far) = k
               last = last + 1
               tree%by_angle(last) = far
            end do
         end do
      end do
   end subroutine find_orientations

   !> Gives the number of the link at the other end of a pair.
   pure integer function other_link(m, k, link) result(other)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k               !< the number of the pair
      integer, intent(in) :: link            !< the number of one of its links

      other = sum(pair_links(m, m%pairs(k))) - link
   end function other_link

   !> Gives the unit vector (2) along the guide of a prismatic pair, or along the normal, in the axes of the orientation
   !> of its links.
   pure function guide(m, axes, k, across) result(e)
      type(mechanism_t), intent(in) :: m
      type(axes_t), intent(in) :: axes   !< of `m`
      integer, intent(in) :: k   !< the number of the pair
      logical, intent(in) :: across   !< along the normal; otherwise along the guide
      real(wp) :: e(2), angle

      angle = axes%angle_offset(m%points(m%pairs(k)%point_i)%link) + m%pairs(k)%alpha
      e = direction(angle)
      if (across) e = quarter_turn(e)
   end function guide

   !> Gives the vector (2) from the origin of a link to a point of it, in the axes of the link's orientation, in the
   !> deck's unit of length.
   pure function point_offset(m, axes, i) result(v)
      type(mechanism_t), intent(in) :: m
      type(axes_t), intent(in) :: axes   !< of `m`
      integer, intent(in) :: i   !< the number of the point
      real(wp) :: v(2)

      v = rotated(m%points(i)%offset, axes%turn(:, m%points(i)%link))
   end function point_offset
end module spanning_tree
