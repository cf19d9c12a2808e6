!> Vector polygons along short ways over the pairs: each is a sum of arms that turn with their frames,
!> and of slides,
!>
!>    P - Q = d_0 + sum_k R(phi_k) d_k + sum_m s_m R(phi_k(m)) e_m.
!>
!> Arms of one frame in one polygon are added up, so each frame stands in it once. Lengths in units of `length`.
module polygons
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_prismatic
   use links_tree, only: tree_t
   use tree_paths, only: search_t
   use tree_places, only: point_in_frame, guide
   implicit none
   private
   public :: polygons_t, new_polygons, add_polygon

   !> A polygon in the making: sums by frame, and the frames and slides that occur.
   type :: builder_t
      real(wp), allocatable :: sum(:, :)             !< (2, 0:frames)
      real(wp), allocatable :: largest(:)            !< (0:frames) largest component that was added
      logical, allocatable :: met(:)                 !< (0:frames)
      integer, allocatable :: frames(:), slide_frame(:), slide(:)
      real(wp), allocatable :: slide_arm(:, :)
      integer :: arms = 0, slides = 0
   end type builder_t

   !> Arms of polygon p are first_arm(p), ..., first_arm(p + 1) - 1; slides likewise. Frame 0 is the ground.
   type :: polygons_t
      integer :: count = 0
      integer, allocatable :: first_arm(:), arm_frame(:)
      real(wp), allocatable :: arm(:, :)             !< (2, arms) d in the frame's axes
      integer, allocatable :: first_slide(:), slide_frame(:), slide_number(:)
      real(wp), allocatable :: slide_arm(:, :)       !< (2, slides) e in the frame's axes, with its sign
      type(builder_t) :: making                      !< the next one
   end type polygons_t

contains

   !> No polygon yet, and room for those of `m` on its tree `t`.
   function new_polygons(m, t) result(p)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(polygons_t) :: p
      integer :: most

      most = size(m%pairs) + size(m%drives) + 1
      allocate (p%first_arm(most), p%first_slide(most), source=1)
      allocate (p%arm_frame(most), p%arm(2, most), p%slide_frame(most), p%slide_number(most), p%slide_arm(2, most))
      associate (b => p%making)
         allocate (b%sum(2, 0:t%frames), b%largest(0:t%frames), b%frames(t%frames + 1))
         allocate (b%met(0:t%frames), source=.false.)
         allocate (b%slide_frame(8), b%slide(8), b%slide_arm(2, 8))
      end associate
   end function new_polygons

   !> Adds to `polygons` the one from point `q` to point `p` by the way that `s` found last from p's link to q's;
   !> `q` = 0 is the origin of all places, and the way then leads to the ground or to a root.
   subroutine add_polygon(m, t, length, p, q, s, polygons)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: p, q
      type(search_t), intent(in) :: s
      type(polygons_t), intent(inout) :: polygons
      real(wp) :: v(2)
      integer :: link, i

      link = m%points(p)%link
      v = point_in_frame(m, t, length, p)
      do i = 1, s%length
         call cross(m, t, length, s%pairs(i), link, v, polygons%making)
      end do
      if (q > 0) then
         ! Not their difference: what is left of arms that cancel is told by the largest that was added.
         call add_arm(polygons%making, t%frame(link), -point_in_frame(m, t, length, q))
      else if (t%root(link) > 0) then
         call add_slide(polygons%making, 0, t%slides + 2*t%root(link) - 1, [1.0_wp, 0.0_wp])
         call add_slide(polygons%making, 0, t%slides + 2*t%root(link), [0.0_wp, 1.0_wp])
      end if
      call add_arm(polygons%making, t%frame(link), v)
      call store(polygons%making, polygons)
   end subroutine add_polygon

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
         call add_arm(b, t%frame(link), v)
         call add_arm(b, t%frame(link), -point_in_frame(m, t, length, exit_point))
         if (k%kind == pair_prismatic) then
            ! P - Q = h n - s e, all in the frame that the two links share.
            call add_slide(b, t%frame(link), t%slide(pair), merge(-1.0_wp, 1.0_wp, forward)*guide(m, t, pair, .false.))
            call add_arm(b, t%frame(link), merge(1.0_wp, -1.0_wp, forward)*k%offset/length*guide(m, t, pair, .true.))
         end if
         link = m%points(entry_point)%link
         v = point_in_frame(m, t, length, entry_point)
      end associate
   end subroutine cross

   !> Point `i` is on `link`, or both belong to the ground.
   pure logical function is_on(m, i, link)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, link

      is_on = m%points(i)%link == link .or. (m%links(m%points(i)%link)%ground .and. m%links(link)%ground)
   end function is_on

   subroutine add_arm(b, frame, d)
      type(builder_t), intent(inout) :: b
      integer, intent(in) :: frame
      real(wp), intent(in) :: d(2)

      if (.not. b%met(frame)) then
         b%met(frame) = .true.
         b%sum(:, frame) = 0.0_wp
         b%largest(frame) = 0.0_wp
         b%arms = b%arms + 1
         b%frames(b%arms) = frame
      end if
      b%sum(:, frame) = b%sum(:, frame) + d
      b%largest(frame) = max(b%largest(frame), maxval(abs(d)))
   end subroutine add_arm

   subroutine add_slide(b, frame, slide, e)
      type(builder_t), intent(inout) :: b
      integer, intent(in) :: frame, slide
      real(wp), intent(in) :: e(2)

      b%slides = b%slides + 1
      if (b%slides > size(b%slide)) then
         b%slide = [b%slide, b%slide]
         b%slide_frame = [b%slide_frame, b%slide_frame]
         b%slide_arm = reshape([b%slide_arm, b%slide_arm], [2, size(b%slide)])
      end if
      b%slide_frame(b%slides) = frame
      b%slide(b%slides) = slide
      b%slide_arm(:, b%slides) = e
   end subroutine add_slide

   !> Appends the polygon in the making to `p` and empties it; arms of no length are dropped.
   subroutine store(b, p)
      type(builder_t), intent(inout) :: b
      type(polygons_t), intent(inout) :: p
      integer :: i, arms, slides

      arms = p%first_arm(p%count + 1) - 1
      slides = p%first_slide(p%count + 1) - 1
      call extend(p, arms + b%arms, slides + b%slides)
      do i = 1, b%arms
         b%met(b%frames(i)) = .false.
         ! What is left of arms that cancel is rounding, and would tie a frame to equations that do not hold it.
         if (all(abs(b%sum(:, b%frames(i))) <= 8.0_wp*epsilon(1.0_wp)*b%largest(b%frames(i)))) cycle
         arms = arms + 1
         p%arm_frame(arms) = b%frames(i)
         p%arm(:, arms) = b%sum(:, b%frames(i))
      end do
      do i = 1, b%slides
         slides = slides + 1
         p%slide_frame(slides) = b%slide_frame(i)
         p%slide_number(slides) = b%slide(i)
         p%slide_arm(:, slides) = b%slide_arm(:, i)
      end do
      b%arms = 0
      b%slides = 0
      p%count = p%count + 1
      p%first_arm(p%count + 1) = arms + 1
      p%first_slide(p%count + 1) = slides + 1
   end subroutine store

   !> Room for so many arms and slides, doubled where it runs out.
   subroutine extend(p, arms, slides)
      type(polygons_t), intent(inout) :: p
      integer, intent(in) :: arms, slides

      do while (arms > size(p%arm_frame))
         p%arm_frame = [p%arm_frame, p%arm_frame]
         p%arm = reshape([p%arm, p%arm], [2, size(p%arm_frame)])
      end do
      do while (slides > size(p%slide_frame))
         p%slide_frame = [p%slide_frame, p%slide_frame]
         p%slide_number = [p%slide_number, p%slide_number]
         p%slide_arm = reshape([p%slide_arm, p%slide_arm], [2, size(p%slide_frame)])
      end do
   end subroutine extend

end module polygons
