!> Vector loops along short paths over the pairs: each is a sum of body vectors that turn with their orientations,
!> and of slides,
!>
!>    P - Q = d_0 + sum_k R(phi_k) d_k + sum_m s_m R(phi_k(m)) e_m.
!>
!> Body vectors of one orientation in one loop are added up, so each orientation stands in it once. Lengths are
!> in units of `length`.
!>
!> The paths lead over the pairs taken so far: those of the tree, and each revolute pair once it has closed its loop. A
!> loop that takes the shortest such path holds its own pair and earlier ones only, so all loops are independent; and it
!> holds few links, so the blocks stay small and the work proportional to the links.
module vector_loops
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_prismatic, pair_revolute
   use links_tree, only: tree_t, offset_in_drawing, ground_place, guide, other_link
   implicit none
   private
   public :: vector_loops_t, new_vector_loops, add_vector_loop, search_t, new_search, find_path, find_path_down, &
      close_pair

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

   !> Body vectors of loop p are first_vector(p), ..., first_vector(p + 1) - 1; slides and terms likewise. Loop 0 has
   !> none. Orientation 0 is the ground's. Directions are in the axes of the orientation. All lists have room behind.
   type :: vector_loops_t
      integer :: count = 0
      integer :: vectors = 0, slides = 0, term_count = 0 !< so far, with those of the loop in the making
      integer, allocatable :: first_vector(:), first_slide(:), first_term(:)   !< (0:loops + 1)
      integer, allocatable :: vector_orientation(:)
      real(wp), allocatable :: body_vector(:, :)         !< (2, body vectors) d
      integer, allocatable :: slide_orientation(:), slide_number(:)
      real(wp), allocatable :: slide_body_vector(:, :)   !< (2, slides) e with its sign
      !> (2, terms) What the loop is the sum of: each a point (its number, 0), from its link's origin, or a prismatic
      !> pair's P - Q (0, its number), with their signs.
      integer, allocatable :: terms(:, :)
      !> (0:orientations) Of the loop in the making: the body vector of each orientation, 0 for none, and the largest
      !> component that was added to it.
      integer, allocatable :: vector_of(:)
      real(wp), allocatable :: largest(:)
      !> Of the loop in the making: the places of ground links, which are summed apart from their points. Between points
      !> of one link they cancel, wherever that stands, and leave no rounding of their size.
      real(wp) :: places(2) = 0.0_wp
   end type vector_loops_t

contains

   !> No loop yet, and room for those of `m` on its tree `t`.
   function new_vector_loops(m, t) result(p)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(vector_loops_t) :: p
      integer :: most

      most = size(m%pairs) + size(m%drives) + 1
      allocate (p%first_vector(0:most), p%first_slide(0:most), p%first_term(0:most), source=1)
      allocate (p%vector_orientation(most), p%body_vector(2, most), p%slide_orientation(most), p%slide_number(most), &
         p%slide_body_vector(2, most), p%terms(2, 4*most))
      allocate (p%vector_of(0:t%orientations), source=0)
      allocate (p%largest(0:t%orientations))
   end function new_vector_loops

   !> Adds to `loops` the one from point `q` to point `p` by the path that `s` found last from p's link to q's; `q` = 0
   !> is the origin of all places, and the path then leads to the ground or to a root.
   subroutine add_vector_loop(m, t, length, p, q, s, loops)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: p, q
      type(search_t), intent(in) :: s
      type(vector_loops_t), intent(inout) :: loops
      integer :: link, i

      link = m%points(p)%link
      call add_point(m, t, length, p, 1.0_wp, loops)
      do i = 1, s%length
         call cross(m, t, length, s%pairs(i), link, loops)
      end do
      if (q > 0) then
         call add_point(m, t, length, q, -1.0_wp, loops)
      else if (t%root(link) > 0) then
         call add_slide(loops, 0, t%slides + 2*t%root(link) - 1, [1.0_wp, 0.0_wp])
         call add_slide(loops, 0, t%slides + 2*t%root(link), [0.0_wp, 1.0_wp])
      end if
      call close_loop(loops)
   end subroutine add_vector_loop

   !> Goes from a place of `link` through `pair` to the link at its other end, which becomes `link`. Ground
   !> links are one: the pair may be another one's than that of the ground link reached.
   subroutine cross(m, t, length, pair, link, loops)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: pair
      integer, intent(inout) :: link
      type(vector_loops_t), intent(inout) :: loops
      integer :: exit_point, entry_point
      real(wp) :: sign_of
      logical :: forward

      associate (k => m%pairs(pair))
         forward = is_on(m, k%point_i, link)
         exit_point = merge(k%point_i, k%point_j, forward)
         entry_point = merge(k%point_j, k%point_i, forward)
         call add_point(m, t, length, exit_point, -1.0_wp, loops)
         if (k%kind == pair_prismatic) then
            ! P - Q = h n - s e, all in the orientation that the two links share.
            sign_of = merge(1.0_wp, -1.0_wp, forward)
            call add_term(loops, [0, merge(pair, -pair, forward)])
            call add_slide(loops, t%orientation(link), t%slide(pair), -sign_of*guide(m, t, pair, across=.false.))
            call add_body_vector(loops, t%orientation(link), sign_of*k%offset/length*guide(m, t, pair, across=.true.))
         end if
         link = m%points(entry_point)%link
         call add_point(m, t, length, entry_point, 1.0_wp, loops)
      end associate
   end subroutine cross

   !> Point `i` is on `link`, or both belong to the ground.
   pure logical function is_on(m, i, link)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, link

      is_on = m%points(i)%link == link .or. (m%links(m%points(i)%link)%ground .and. m%links(link)%ground)
   end function is_on

   !> Adds point number `i`, from its link's origin, with a sign to the loop in the making. Never the difference of two
   !> points: the largest that was added tells which sums are rounding alone.
   subroutine add_point(m, t, length, i, sign_of, p)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length, sign_of
      integer, intent(in) :: i
      type(vector_loops_t), intent(inout) :: p
      real(wp) :: place(2)

      call add_term(p, [merge(i, -i, sign_of > 0.0_wp), 0])
      associate (link => m%points(i)%link)
         call add_body_vector(p, t%orientation(link), sign_of*offset_in_drawing(m, t, length, i))
         if (.not. m%links(link)%ground) return
         place = ground_place(m, t, length, link)
      end associate
      p%places = p%places + sign_of*place
      p%largest(0) = max(p%largest(0), maxval(abs(place)))
   end subroutine add_point

   !> Adds a term to the loop in the making.
   subroutine add_term(p, term)
      type(vector_loops_t), intent(inout) :: p
      integer, intent(in) :: term(2)

      p%term_count = p%term_count + 1
      if (p%term_count > size(p%terms, 2)) p%terms = reshape([p%terms, p%terms], [2, 2*size(p%terms, 2)])
      p%terms(:, p%term_count) = term
   end subroutine add_term

   !> Adds the body vector `d` of an orientation to the loop in the making.
   subroutine add_body_vector(p, orientation, d)
      type(vector_loops_t), intent(inout) :: p
      integer, intent(in) :: orientation
      real(wp), intent(in) :: d(2)

      if (p%vector_of(orientation) == 0) then
         p%vectors = p%vectors + 1
         if (p%vectors > size(p%vector_orientation)) then
            p%vector_orientation = [p%vector_orientation, p%vector_orientation]
            p%body_vector = reshape([p%body_vector, p%body_vector], [2, size(p%vector_orientation)])
         end if
         p%vector_of(orientation) = p%vectors
         p%vector_orientation(p%vectors) = orientation
         p%body_vector(:, p%vectors) = 0.0_wp
         p%largest(orientation) = 0.0_wp
      end if
      associate (sum_of => p%body_vector(:, p%vector_of(orientation)))
         sum_of = sum_of + d
      end associate
      p%largest(orientation) = max(p%largest(orientation), maxval(abs(d)))
   end subroutine add_body_vector

   !> Adds slide number `slide` in the direction `e` to the loop in the making.
   subroutine add_slide(p, orientation, slide, e)
      type(vector_loops_t), intent(inout) :: p
      integer, intent(in) :: orientation, slide
      real(wp), intent(in) :: e(2)

      p%slides = p%slides + 1
      if (p%slides > size(p%slide_number)) then
         p%slide_orientation = [p%slide_orientation, p%slide_orientation]
         p%slide_number = [p%slide_number, p%slide_number]
         p%slide_body_vector = reshape([p%slide_body_vector, p%slide_body_vector], [2, size(p%slide_number)])
      end if
      p%slide_orientation(p%slides) = orientation
      p%slide_number(p%slides) = slide
      p%slide_body_vector(:, p%slides) = e
   end subroutine add_slide

   !> Ends the loop in the making. What is left of body vectors that cancel is rounding: it would put an angle into
   !> equations that do not hold it, and is dropped.
   subroutine close_loop(p)
      type(vector_loops_t), intent(inout) :: p
      integer :: kept, k

      kept = p%first_vector(p%count + 1) - 1
      if (p%vector_of(0) > 0) p%body_vector(:, p%vector_of(0)) = p%body_vector(:, p%vector_of(0)) + p%places
      p%places = 0.0_wp
      do k = kept + 1, p%vectors
         associate (orientation => p%vector_orientation(k))
            p%vector_of(orientation) = 0
            if (all(abs(p%body_vector(:, k)) <= 8.0_wp*epsilon(1.0_wp)*p%largest(orientation))) cycle
         end associate
         kept = kept + 1
         p%vector_orientation(kept) = p%vector_orientation(k)
         p%body_vector(:, kept) = p%body_vector(:, k)
      end do
      p%vectors = kept
      p%count = p%count + 1
      p%first_vector(p%count + 1) = p%vectors + 1
      p%first_slide(p%count + 1) = p%slides + 1
      p%first_term(p%count + 1) = p%term_count + 1
   end subroutine close_loop

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
end module vector_loops
