!> Vector loops along short paths over the pairs: each is a sum of body vectors that turn with their orientations,
!> and of slides,
!>
!>    P - Q = d_0 + sum_k R(phi_k) d_k + sum_m s_m R(phi_k(m)) e_m.
!>
!> Body vectors of one orientation in one loop are added up, so each orientation stands in it once. Lengths are
!> in units of `length`.
module vector_loops
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_prismatic
   use links_tree, only: tree_t, point_in_drawing, guide
   use tree_paths, only: search_t
   implicit none
   private
   public :: vector_loops_t, new_vector_loops, add_vector_loop

   !> A loop in the making: sums by orientation, and the orientations and slides that occur.
   type :: builder_t
      real(wp), allocatable :: sum(:, :)             !< (2, 0:orientations)
      real(wp), allocatable :: largest(:)            !< (0:orientations) largest component that was added
      logical, allocatable :: met(:)                 !< (0:orientations)
      integer, allocatable :: orientations(:), slide_orientation(:), slide(:)
      real(wp), allocatable :: slide_body_vector(:, :)
      integer :: body_vectors = 0, slides = 0
      integer, allocatable :: terms(:, :)            !< of all loops so far, as below, with room behind
      integer :: term_count = 0
   end type builder_t

   !> Body vectors of loop p are first_vector(p), ..., first_vector(p + 1) - 1; slides likewise. Orientation 0 is the
   !> ground's. Directions are in the axes of the orientation.
   type :: vector_loops_t
      integer :: count = 0
      integer, allocatable :: first_vector(:), vector_orientation(:)
      real(wp), allocatable :: body_vector(:, :)     !< (2, body vectors) d
      integer, allocatable :: first_slide(:), slide_orientation(:), slide_number(:)
      real(wp), allocatable :: slide_body_vector(:, :)   !< (2, slides) e with its sign
      type(builder_t) :: making                      !< the next one
      !> Loop p is the sum of the terms making%terms(:, first_term(p):first_term(p + 1) - 1), each a point (its number,
      !> 0), from its link's origin, or a prismatic pair's P - Q (0, its number), with their signs.
      integer, allocatable :: first_term(:)
   end type vector_loops_t

contains

   !> No loop yet, and room for those of `m` on its tree `t`.
   function new_vector_loops(m, t) result(p)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(vector_loops_t) :: p
      integer :: most

      most = size(m%pairs) + size(m%drives) + 1
      allocate (p%first_vector(most), p%first_slide(most), p%first_term(most), source=1)
      allocate (p%vector_orientation(most), p%body_vector(2, most), p%slide_orientation(most), p%slide_number(most), &
         p%slide_body_vector(2, most))
      associate (b => p%making)
         allocate (b%sum(2, 0:t%orientations), b%largest(0:t%orientations), b%orientations(t%orientations + 1))
         allocate (b%met(0:t%orientations), source=.false.)
         allocate (b%slide_orientation(8), b%slide(8), b%slide_body_vector(2, 8))
         allocate (b%terms(2, 4*most))
      end associate
   end function new_vector_loops

   !> Adds to `vector_loops` the one from point `q` to point `p` by the path that `s` found last from p's link to
   !> q's; `q` = 0 is the origin of all places, and the path then leads to the ground or to a root.
   subroutine add_vector_loop(m, t, length, p, q, s, vector_loops)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: p, q
      type(search_t), intent(in) :: s
      type(vector_loops_t), intent(inout) :: vector_loops
      real(wp) :: v(2)
      integer :: link, i

      link = m%points(p)%link
      v = point_in_drawing(m, t, length, p)
      call note_term(vector_loops%making, [p, 0])
      do i = 1, s%length
         call cross(m, t, length, s%pairs(i), link, v, vector_loops%making)
      end do
      if (q > 0) then
         ! Not their difference: the largest that was added tells which sums are rounding alone.
         call add_body_vector(vector_loops%making, t%orientation(link), -point_in_drawing(m, t, length, q))
         call note_term(vector_loops%making, [-q, 0])
      else if (t%root(link) > 0) then
         call add_slide(vector_loops%making, 0, t%slides + 2*t%root(link) - 1, [1.0_wp, 0.0_wp])
         call add_slide(vector_loops%making, 0, t%slides + 2*t%root(link), [0.0_wp, 1.0_wp])
      end if
      call add_body_vector(vector_loops%making, t%orientation(link), v)
      call store(vector_loops%making, vector_loops)
   end subroutine add_vector_loop

   !> Goes from place `v` of `link` through `pair` to the link at its other end, which becomes `link`. Ground
   !> links are one: the pair may be another one's than that of the ground link reached.
   subroutine cross(m, t, length, pair, link, v, b)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: pair
      integer, intent(inout) :: link
      real(wp), intent(inout) :: v(2)
      type(builder_t), intent(inout) :: b
      integer :: exit_point, entry_point
      logical :: forward

      associate (k => m%pairs(pair))
         forward = is_on(m, k%point_i, link)
         exit_point = merge(k%point_i, k%point_j, forward)
         entry_point = merge(k%point_j, k%point_i, forward)
         call add_body_vector(b, t%orientation(link), v)
         call add_body_vector(b, t%orientation(link), -point_in_drawing(m, t, length, exit_point))
         call note_term(b, [-exit_point, 0])
         call note_term(b, [entry_point, 0])
         if (k%kind == pair_prismatic) then
            ! P - Q = h n - s e, all in the orientation that the two links share.
            call note_term(b, [0, merge(pair, -pair, forward)])
            call add_slide(b, t%orientation(link), t%slide(pair), merge(-1.0_wp, 1.0_wp, forward)*guide(m, t, pair, &
               .false.))
            call add_body_vector(b, t%orientation(link), merge(1.0_wp, -1.0_wp, forward)*k%offset/length*guide(m, t, &
               pair, .true.))
         end if
         link = m%points(entry_point)%link
         v = point_in_drawing(m, t, length, entry_point)
      end associate
   end subroutine cross

   !> Notes a term of the loop in the making.
   subroutine note_term(b, term)
      type(builder_t), intent(inout) :: b
      integer, intent(in) :: term(2)

      b%term_count = b%term_count + 1
      if (b%term_count > size(b%terms, 2)) b%terms = reshape([b%terms, b%terms], [2, 2*size(b%terms, 2)])
      b%terms(:, b%term_count) = term
   end subroutine note_term

   !> Point `i` is on `link`, or both belong to the ground.
   pure logical function is_on(m, i, link)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, link

      is_on = m%points(i)%link == link .or. (m%links(m%points(i)%link)%ground .and. m%links(link)%ground)
   end function is_on

   !> Adds the body vector `d` of an orientation to the loop in the making.
   subroutine add_body_vector(b, orientation, d)
      type(builder_t), intent(inout) :: b
      integer, intent(in) :: orientation
      real(wp), intent(in) :: d(2)

      if (.not. b%met(orientation)) then
         b%met(orientation) = .true.
         b%sum(:, orientation) = 0.0_wp
         b%largest(orientation) = 0.0_wp
         b%body_vectors = b%body_vectors + 1
         b%orientations(b%body_vectors) = orientation
      end if
      b%sum(:, orientation) = b%sum(:, orientation) + d
      b%largest(orientation) = max(b%largest(orientation), maxval(abs(d)))
   end subroutine add_body_vector

   !> Adds slide number `slide` in the direction `e` to the loop in the making.
   subroutine add_slide(b, orientation, slide, e)
      type(builder_t), intent(inout) :: b
      integer, intent(in) :: orientation, slide
      real(wp), intent(in) :: e(2)

      b%slides = b%slides + 1
      if (b%slides > size(b%slide)) then
         b%slide = [b%slide, b%slide]
         b%slide_orientation = [b%slide_orientation, b%slide_orientation]
         b%slide_body_vector = reshape([b%slide_body_vector, b%slide_body_vector], [2, size(b%slide)])
      end if
      b%slide_orientation(b%slides) = orientation
      b%slide(b%slides) = slide
      b%slide_body_vector(:, b%slides) = e
   end subroutine add_slide

   !> Appends the loop in the making to `p` and empties it; body vectors of no length are dropped.
   subroutine store(b, p)
      type(builder_t), intent(inout) :: b
      type(vector_loops_t), intent(inout) :: p
      integer :: i, body_vectors, slides

      body_vectors = p%first_vector(p%count + 1) - 1
      slides = p%first_slide(p%count + 1) - 1
      call extend(p, body_vectors + b%body_vectors, slides + b%slides)
      do i = 1, b%body_vectors
         b%met(b%orientations(i)) = .false.
         ! What is left of vectors that cancel is rounding: it would put an angle into equations that do not hold it.
         if (all(abs(b%sum(:, b%orientations(i))) <= 8.0_wp*epsilon(1.0_wp)*b%largest(b%orientations(i)))) cycle
         body_vectors = body_vectors + 1
         p%vector_orientation(body_vectors) = b%orientations(i)
         p%body_vector(:, body_vectors) = b%sum(:, b%orientations(i))
      end do
      do i = 1, b%slides
         slides = slides + 1
         p%slide_orientation(slides) = b%slide_orientation(i)
         p%slide_number(slides) = b%slide(i)
         p%slide_body_vector(:, slides) = b%slide_body_vector(:, i)
      end do
      b%body_vectors = 0
      b%slides = 0
      p%count = p%count + 1
      p%first_vector(p%count + 1) = body_vectors + 1
      p%first_slide(p%count + 1) = slides + 1
      p%first_term(p%count + 1) = b%term_count + 1
   end subroutine store

   !> Room for so many body vectors and slides, doubled where it runs out.
   subroutine extend(p, body_vectors, slides)
      type(vector_loops_t), intent(inout) :: p
      integer, intent(in) :: body_vectors, slides

      do while (body_vectors > size(p%vector_orientation))
         p%vector_orientation = [p%vector_orientation, p%vector_orientation]
         p%body_vector = reshape([p%body_vector, p%body_vector], [2, size(p%vector_orientation)])
      end do
      do while (slides > size(p%slide_orientation))
         p%slide_orientation = [p%slide_orientation, p%slide_orientation]
         p%slide_number = [p%slide_number, p%slide_number]
         p%slide_body_vector = reshape([p%slide_body_vector, p%slide_body_vector], [2, size(p%slide_orientation)])
      end do
   end subroutine extend

end module vector_loops
