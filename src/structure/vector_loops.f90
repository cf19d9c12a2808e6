!> Vector loops along short paths over the pairs: each is a sum of body vectors that turn with their orientations,
!> and of slides,
!>
!>    P - Q = d_0 + sum_k R(phi_k) d_k + sum_m s_m R(phi_k(m)) e_m.
!>
!> Body vectors of one orientation in one loop are added up, so each orientation stands in it once.
!>
!> A loop is integers: which points and prismatic pairs it is the sum of. The numbers of the cards make `loop_sums_t` of
!> its body vectors.
!>
!> The paths lead over the pairs taken so far: those of the tree, and each revolute pair after it has closed its loop. A
!> loop by the shortest such path holds its own pair and earlier ones only: all loops are independent. It holds few
!> links: the blocks stay small, and the work is proportional to the links.
module vector_loops
   use kinds, only: wp
   use mechanism, only: mechanism_t, has_guide
   use spanning_tree, only: spanning_tree_t, axes_t, point_offset, guide, other_link
   implicit none
   private
   public :: vector_loops_t, add_vector_loop, loop_sums_t, assign_sums, vanishes
   public :: search_t, find_path

   !> The memory of searches. A link is a node; all ground links are node 0. A search goes from both ends: node n has
   !> the index 2 n for end 1 and 2 n + 1 for end 2.
   type :: search_t
      logical, allocatable :: open(:)       !< (pairs) paths can lead over it
      integer, allocatable :: pairs(:)      !< (length) numbers of the pairs of the last path, with room after them
      integer :: length = 0                 !< how many pairs the path found last has
      integer, allocatable :: via(:)        !< (0:2 links + 1) the pair by which a node was reached; 0: it is the end
      integer, allocatable :: seen(:)       !< (0:2 links + 1) the number of the search that reached the node last
      integer, allocatable :: queue(:, :)   !< (0:links, 2) the nodes reached from each end, in turn
      integer :: number = 0                 !< of the last search, from 1
   end type search_t

   !> Body vectors of loop p are first_vector(p), ..., first_vector(p + 1) - 1; slides and terms likewise. Loop 0 has
   !> none. Orientation 0 is the ground's. All lists have room for more.
   type :: vector_loops_t
      integer :: count = 0                               !< how many loops there are
      integer :: vectors = 0, slides = 0, term_count = 0 !< how many there are, those of an unfinished loop included
      integer, allocatable :: first_vector(:), first_slide(:), first_term(:)   !< (0:loops + 1)
      integer, allocatable :: vector_orientation(:)      !< (body vectors) the orientation that rotates it
      integer, allocatable :: slide_orientation(:), slide_number(:)   !< (slides) turns its guide; number in tree
      integer, allocatable :: slide_pair(:)              !< (slides) its pair, with its sign in the loop; 0: a root's
      !> (2, terms) The summands of the loops: a point (its number, 0) as a vector from its link's origin, or the vector
      !> P - Q of a prismatic pair (0, its number), with their signs.
      integer, allocatable :: terms(:, :)
      integer, allocatable :: term_vector(:)             !< (terms) the body vector to which each is added
      !> (0:orientations) the body vector of the unfinished loop that the orientation rotates; 0: none
      integer, allocatable :: vector_of(:)
   end type vector_loops_t

   !> Body vectors and slides of all loops, in the axes of their orientations, lengths in the unit of the equations.
   type :: loop_sums_t
      real(wp), allocatable :: body_vector(:, :)         !< (2, body vectors) d
      real(wp), allocatable :: largest(:)                !< (body vectors) the largest component that was added to it
      real(wp), allocatable :: slide_body_vector(:, :)   !< (2, slides) the unit vector e with its sign
   end type loop_sums_t

contains

   !> Adds the loop from point `point_j` to point `point_i` by the path of a search. The path begins at the link of
   !> `point_i`. Without a `point_j` the path leads to the ground or to a root. A term is a point as a vector from the
   !> origin of its link, never the difference of two points: the largest term of a sum then tells whether the sum is
   !> rounding only.
   subroutine add_vector_loop(m, tree, point_i, point_j, search, loops)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`
      integer, intent(in) :: point_i         !< the number of the point at which the loop ends
      integer, intent(in) :: point_j         !< the number of the point at which it begins; 0: the origin of positions
      type(search_t), intent(in) :: search   !< with the pairs of the path
      type(vector_loops_t), intent(inout) :: loops   !< one more is added
      integer :: link, i, exit_point, entry_point, sign_of

      link = m%points(point_i)%link
      call add_term([point_i, 0], tree%orientation(link))
      do i = 1, search%length
         associate (k => m%pairs(search%pairs(i)))
            ! From `link` through the pair to the link at its other end. All ground links are one node: the pair may
            ! begin at another ground link than the one that the path has reached.
            sign_of = merge(1, -1, node(m, m%points(k%point_i)%link) == node(m, link))
            exit_point = merge(k%point_i, k%point_j, sign_of > 0)
            entry_point = merge(k%point_j, k%point_i, sign_of > 0)

            call add_term([-exit_point, 0], tree%orientation(m%points(exit_point)%link))
            if (has_guide(k%kind)) then
               ! P - Q = h n - s e, all in the orientation that the two links share.
               call add_slide(tree%orientation(link), tree%slide(search%pairs(i)), -sign_of*search%pairs(i))
               call add_term([0, sign_of*search%pairs(i)], tree%orientation(link))
            end if
            link = m%points(entry_point)%link
            call add_term([entry_point, 0], tree%orientation(link))
         end associate
      end do
      if (point_j > 0) then
         call add_term([-point_j, 0], tree%orientation(m%points(point_j)%link))
      else if (tree%root(link) > 0) then
         call add_slide(0, tree%slides + 2*tree%root(link) - 1, 0)
         call add_slide(0, tree%slides + 2*tree%root(link), 0)
      end if

      loops%vector_of(loops%vector_orientation(loops%first_vector(loops%count + 1):loops%vectors)) = 0
      loops%count = loops%count + 1
      loops%first_vector(loops%count + 1) = loops%vectors + 1
      loops%first_slide(loops%count + 1) = loops%slides + 1
      loops%first_term(loops%count + 1) = loops%term_count + 1

   contains

      !> Adds a term to the unfinished loop, as a part of the body vector of its orientation.
      subroutine add_term(term, orientation)
         integer, intent(in) :: term(2)      !< as in `terms`: a point and 0, or 0 and a pair, with their signs
         integer, intent(in) :: orientation  !< the number of the orientation with which it turns; 0: the ground

         if (loops%vector_of(orientation) == 0) then
            loops%vectors = loops%vectors + 1
            if (loops%vectors > size(loops%vector_orientation)) &
               loops%vector_orientation = [loops%vector_orientation, loops%vector_orientation]
            loops%vector_of(orientation) = loops%vectors
            loops%vector_orientation(loops%vectors) = orientation
         end if
         loops%term_count = loops%term_count + 1
         if (loops%term_count > size(loops%term_vector)) then
            loops%term_vector = [loops%term_vector, loops%term_vector]
            loops%terms = reshape([loops%terms, loops%terms], [2, size(loops%term_vector)])
         end if
         loops%terms(:, loops%term_count) = term
         loops%term_vector(loops%term_count) = loops%vector_of(orientation)
      end subroutine add_term

      !> Adds a slide to the unfinished loop.
      subroutine add_slide(orientation, slide, pair)
         integer, intent(in) :: orientation  !< the number of the orientation with which its guide turns; 0: the ground
         integer, intent(in) :: slide        !< the number of the slide in the tree; x and y of roots follow the slides
         integer, intent(in) :: pair         !< the number of its pair, with its sign; 0: x or y of a root

         loops%slides = loops%slides + 1
         if (loops%slides > size(loops%slide_number)) then
            loops%slide_orientation = [loops%slide_orientation, loops%slide_orientation]
            loops%slide_number = [loops%slide_number, loops%slide_number]
            loops%slide_pair = [loops%slide_pair, loops%slide_pair]
         end if
         loops%slide_orientation(loops%slides) = orientation
         loops%slide_number(loops%slides) = slide
         loops%slide_pair(loops%slides) = pair
      end subroutine add_slide
   end subroutine add_vector_loop

   !> Sums up body vectors and slides of all loops from the numbers of a mechanism.
   pure subroutine assign_sums(m, tree, axes, length, loops, sums)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`, or of a mechanism of equal structure
      type(axes_t), intent(in) :: axes       !< of `m`
      real(wp), intent(in) :: length         !< unit of length of the sums, in the deck's unit
      type(vector_loops_t), intent(in) :: loops   !< on this tree
      type(loop_sums_t), intent(inout) :: sums   !< its lists are allocated; all are set
      real(wp) :: positions(2), position(2), summand(2), sign_of
      integer :: i, k

      sums%body_vector = 0.0_wp
      sums%largest = 0.0_wp
      do i = 1, loops%count
         ! The positions of ground links are summed apart from their points. Between two points of one ground link
         ! they cancel, however large they are, and leave no rounding of their size.
         positions = 0.0_wp
         do k = loops%first_term(i), loops%first_term(i + 1) - 1
            associate (v => loops%term_vector(k), point => abs(loops%terms(1, k)), pair => abs(loops%terms(2, k)))
               sign_of = real(sign(1, sum(loops%terms(:, k))), wp)

               position = 0.0_wp
               if (point == 0) then
                  summand = sign_of*m%pairs(pair)%offset*guide(m, axes, pair, across=.true.)
               else
                  summand = sign_of*point_offset(m, axes, point)
                  associate (link => m%links(m%points(point)%link))
                     if (link%ground) position = link%position(:2) - axes%origin
                  end associate
                  positions = positions + sign_of*position
               end if
               sums%body_vector(:, v) = sums%body_vector(:, v) + summand
               sums%largest(v) = max(sums%largest(v), maxval(abs(summand)), maxval(abs(position)))
            end associate
         end do

         do k = loops%first_vector(i), loops%first_vector(i + 1) - 1
            if (loops%vector_orientation(k) == 0) sums%body_vector(:, k) = sums%body_vector(:, k) + positions
         end do
      end do

      sums%body_vector = sums%body_vector/length
      sums%largest = sums%largest/length
      do k = 1, loops%slides
         if (loops%slide_pair(k) == 0) then
            sums%slide_body_vector(:, k) = merge([1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], &
               mod(loops%slide_number(k) - tree%slides, 2) == 1)
         else
            sums%slide_body_vector(:, k) = sign(1, loops%slide_pair(k))*guide(m, axes, abs(loops%slide_pair(k)), &
               across=.false.)
         end if
      end do
   end subroutine assign_sums

   !> Tells whether a body vector is rounding only: its terms cancel. Reason: rounding would put an angle into equations
   !> that do not hold this angle. Sum and terms may be rounded by 8 units of the largest term.
   pure logical function vanishes(sums, k)
      type(loop_sums_t), intent(in) :: sums   !< of the loops
      integer, intent(in) :: k   !< the number of the body vector

      vanishes = all(abs(sums%body_vector(:, k)) <= 8.0_wp*epsilon(1.0_wp)*sums%largest(k))
   end function vanishes

   !> Finds the pairs on a short path between two links that open pairs join: search%pairs(:search%length), none if both
   !> links are one node. The search is breadth first from both ends in turn. It does not go on from the ground, since
   !> all links may be joined to the ground.
   subroutine find_path(m, tree, i, j, search)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`
      integer, intent(in) :: i               !< the number of the link at which the path begins
      integer, intent(in) :: j               !< the number of the link at which it ends
      type(search_t), intent(inout) :: search   !< with the open pairs
      integer :: first(2), last(2), side, meeting

      search%number = search%number + 1
      search%length = 0
      if (node(m, i) == node(m, j)) return
      first = 0
      last = -1
      meeting = -1
      call visit(1, node(m, i), 0)
      call visit(2, node(m, j), 0)
      do while (meeting < 0)
         do side = 1, 2
            if (meeting < 0) call search_level(side)
         end do
      end do

      call collect(1, node(m, i))
      search%pairs(:search%length) = search%pairs(search%length:1:-1)
      call collect(2, node(m, j))

   contains

      !> Searches one level more from an end, up to the node at which the two searches meet.
      subroutine search_level(side)
         integer, intent(in) :: side         !< 1: from link `i`; 2: from link `j`
         integer :: n, level_end, k, p, link

         level_end = last(side)
         do n = first(side), level_end
            link = search%queue(n, side)
            do k = tree%near%first(link), tree%near%first(link + 1) - 1
               p = tree%near%member(k)
               if (search%open(p)) call visit(side, node(m, other_link(m, p, link)), p)
               if (meeting >= 0) return
            end do
         end do
         first(side) = level_end + 1
      end subroutine search_level

      !> Records that the search has come to a node; if the search from the other end has been there, both have met.
      subroutine visit(side, n, pair)
         integer, intent(in) :: side         !< the end from which it comes: 1 or 2
         integer, intent(in) :: n            !< the number of the node
         integer, intent(in) :: pair         !< the number of the pair by which it was reached; 0: the end itself

         if (search%seen(2*n + side - 1) == search%number) return
         search%seen(2*n + side - 1) = search%number
         search%via(2*n + side - 1) = pair
         if (search%seen(2*n + 2 - side) == search%number) meeting = n
         if (n == 0) return
         last(side) = last(side) + 1
         search%queue(last(side), side) = n
      end subroutine visit

      !> Appends to the path the pairs from the meeting node back to the node at which a search began.
      subroutine collect(side, goal)
         integer, intent(in) :: side         !< the end at which it began: 1 or 2
         integer, intent(in) :: goal         !< the number of that node
         integer :: n

         n = meeting
         do while (n /= goal)
            search%length = search%length + 1
            search%pairs(search%length) = search%via(2*n + side - 1)
            ! The node at the other end.
            associate (pair => m%pairs(search%pairs(search%length)))
               n = node(m, m%points(pair%point_i)%link) + node(m, m%points(pair%point_j)%link) - n
            end associate
         end do
      end subroutine collect
   end subroutine find_path

   !> Gives the number of a link's node: the link's own number, 0 for every ground link.
   pure integer function node(m, link)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: link   !< its number

      node = merge(0, link, m%links(link)%ground)
   end function node
end module vector_loops
