!> Level 7. The blocks of a mechanism in solving order, made ready for fast evaluation: for each block the polygons it
!> closes, split into what is known when its turn comes and what it seeks.
!>
!> Unknowns: 1 to `frames` the angles of the frames, then the slides. A block is an Assur group with the drives
!> that move it, or one drive alone. Contract: a block needs unknowns of earlier blocks only; every unknown belongs to
!> exactly one block.
module blocks
   use kinds, only: wp
   use links_tree, only: tree_t
   use matching, only: incidence_t, match, find_blocks
   use band_order, only: order_block, band_of
   use polygons, only: polygons_t
   use loop_equations, only: equations_t, equation_t, incidence, equation_x, equation_y, equation_projection, &
      equation_angle, equation_slide
   implicit none
   private
   public :: blocks_t, block_t, instance_t, new_blocks
   public :: instance_components, instance_projection, instance_angles

   integer, parameter :: instance_components = 1  !< x and y of a polygon, or one of them
   integer, parameter :: instance_projection = 2  !< the projection of a polygon
   integer, parameter :: instance_angles = 3      !< no polygon: two angles that one block seeks together

   !> Unknowns, rows of equations and instances of a block; the unknown of row r is matched with it.
   type :: block_t
      integer :: first = 1, last = 0
      integer :: first_instance = 1, last_instance = 0
      integer :: below = -1, above = -1           !< diagonals of the band beside the main one; -1: dense
      logical :: direct = .false.                 !< one equation that is linear with coefficient 1
      real(wp) :: bend = 0.0_wp                   !< bounds the change of its Jacobian over that of its unknowns
   end type block_t

   !> Row of an equation: = constant + value of the drive; direct: unknown = other + sign_of (constant + value).
   type :: row_t
      integer :: drive = 0, other = 0
      real(wp) :: constant = 0.0_wp, sign_of = 1.0_wp
   end type row_t

   !> A polygon as one block sees it: rows (0: none), the known arms first, then those of the block's own frames.
   type :: instance_t
      integer :: kind = instance_components
      integer :: row_x = 0, row_y = 0
      integer :: first_arm = 1, first_own = 1, last_arm = 0, first_slide = 1, last_slide = 0
      integer :: frame = 0, frame_column = 0      !< projection: turns with it; angles: the first
      integer :: less = 0, less_column = 0        !< angles: the one subtracted
      real(wp) :: direction(2) = 0.0_wp           !< projection: in its frame's axes
      real(wp) :: ground(2) = 0.0_wp              !< the polygon's fixed part
   end type instance_t

   type :: arm_t
      integer :: frame = 0, column = 0
      real(wp) :: x = 0.0_wp, y = 0.0_wp
   end type arm_t

   !> Columns are 0 for what is known.
   type :: slide_t
      integer :: frame = 0, frame_column = 0, unknown = 0, column = 0
      real(wp) :: arm(2) = 0.0_wp
   end type slide_t

   type :: blocks_t
      integer :: frames = 0, unknowns = 0
      logical :: solvable = .false.               !< as many equations as unknowns, and each has its own
      integer, allocatable :: unmatched(:)        !< equations that found no unknown
      integer, allocatable :: free(:)             !< unknowns that found no equation
      type(block_t), allocatable :: list(:)
      integer, allocatable :: unknown(:)          !< by row
      integer, allocatable :: block_of(:)         !< (unknowns)
      type(row_t), allocatable :: rows(:)
      type(instance_t), allocatable :: instances(:)
      type(arm_t), allocatable :: arms(:)
      type(slide_t), allocatable :: slides(:)
   end type blocks_t

   !> What has been filled, and the columns of the block being filled; 0: not its own.
   type :: filling_t
      integer :: instances = 0, arms = 0, slides = 0
      integer, allocatable :: column(:), latest(:)
   end type filling_t

contains

   !> The blocks of the equations `e` on the tree `t`.
   function new_blocks(t, e) result(b)
      type(tree_t), intent(in) :: t
      type(equations_t), intent(in) :: e
      type(blocks_t) :: b
      type(incidence_t) :: g
      integer, allocatable :: unknown_of(:), equation_of(:), first(:), member(:)
      integer :: i

      b%frames = t%frames
      b%unknowns = t%frames + t%slides + 2*t%roots
      g = incidence(e, b%frames, b%unknowns)
      call match(g, unknown_of, equation_of)
      b%unmatched = pack([(i, i=1, e%count)], unknown_of == 0)
      b%free = pack([(i, i=1, b%unknowns)], equation_of == 0)
      b%solvable = size(b%unmatched) == 0 .and. size(b%free) == 0
      if (.not. b%solvable) return
      call find_blocks(g, equation_of, first, member)
      allocate (b%list(size(first) - 1), b%block_of(b%unknowns))
      do i = 1, size(b%list)
         associate (block => b%list(i))
            block%first = first(i)
            block%last = first(i + 1) - 1
            call order_block(g, equation_of, member(block%first:block%last))
            call band_of(g, equation_of, member(block%first:block%last), block%below, block%above)
            b%block_of(unknown_of(member(block%first:block%last))) = i
         end associate
      end do
      b%unknown = unknown_of(member)
      call fill_rows(e, member, b)
      call fill_instances(e, member, b)
   end function new_blocks

   !> Drives, constants, and which blocks need no iteration.
   subroutine fill_rows(e, member, b)
      type(equations_t), intent(in) :: e
      integer, intent(in) :: member(:)
      type(blocks_t), intent(inout) :: b
      integer :: i, k

      allocate (b%rows(size(member)))
      do i = 1, size(b%list)
         do k = b%list(i)%first, b%list(i)%last
            associate (equation => e%list(member(k)), row => b%rows(k))
               row%drive = equation%drive
               row%constant = equation%constant
               b%list(i)%direct = any(equation%kind == [equation_angle, equation_slide]) &
                  .and. b%list(i)%first == b%list(i)%last
               if (equation%kind /= equation_angle) cycle
               ! phi_frame - phi_less = constant + value, solved for whichever of the two is sought.
               row%other = equation%less
               if (b%unknown(k) /= equation%less) cycle
               row%other = equation%frame
               row%sign_of = -1.0_wp
            end associate
         end do
      end do
   end subroutine fill_rows

   !> The instances of all blocks that iterate.
   subroutine fill_instances(e, member, b)
      type(equations_t), intent(in) :: e
      integer, intent(in) :: member(:)
      type(blocks_t), intent(inout) :: b
      type(filling_t) :: f
      integer :: i, k

      call reserve(e, b, f)
      do i = 1, size(b%list)
         associate (block => b%list(i))
            block%first_instance = f%instances + 1
            if (.not. block%direct) then
               do k = block%first, block%last
                  f%column(b%unknown(k)) = k - block%first + 1
               end do
               do k = block%first, block%last
                  call add_row(e, e%list(member(k)), k - block%first + 1, block%first_instance, b, f)
               end do
               f%column(b%unknown(block%first:block%last)) = 0
            end if
            block%last_instance = f%instances
            block%bend = bend_of(b, block)
         end associate
      end do
   end subroutine fill_instances

   !> Row `row`, in an instance of its own unless x and y of one polygon share it.
   subroutine add_row(e, equation, row, first_instance, b, f)
      type(equations_t), intent(in) :: e
      type(equation_t), intent(in) :: equation
      integer, intent(in) :: row, first_instance
      type(blocks_t), intent(inout) :: b
      type(filling_t), intent(inout) :: f

      if (any(equation%kind == [equation_x, equation_y])) then
         if (f%latest(equation%polygon) < first_instance) then
            call add_instance(e%polygons, equation%polygon, instance_components, b, f)
            f%latest(equation%polygon) = f%instances
         end if
         associate (instance => b%instances(f%latest(equation%polygon)))
            if (equation%kind == equation_x) instance%row_x = row
            if (equation%kind == equation_y) instance%row_y = row
         end associate
         return
      end if
      call add_instance(e%polygons, equation%polygon, &
         merge(instance_projection, instance_angles, equation%kind == equation_projection), b, f)
      associate (instance => b%instances(f%instances))
         instance%row_x = row
         instance%frame = equation%frame
         instance%frame_column = f%column(equation%frame)
         instance%direction = equation%direction
         instance%less = equation%less
         instance%less_column = f%column(equation%less)
      end associate
   end subroutine add_row

   !> A new instance of polygon `i`, 0 for none, as the block with the columns of `f` sees it.
   subroutine add_instance(p, i, kind, b, f)
      type(polygons_t), intent(in) :: p
      integer, intent(in) :: i, kind
      type(blocks_t), intent(inout) :: b
      type(filling_t), intent(inout) :: f
      integer :: k

      f%instances = f%instances + 1
      associate (instance => b%instances(f%instances))
         instance%kind = kind
         instance%first_arm = f%arms + 1
         if (i > 0) call add_arms(p, i, .false., b, f)
         instance%first_own = f%arms + 1
         if (i > 0) call add_arms(p, i, .true., b, f)
         instance%last_arm = f%arms
         instance%first_slide = f%slides + 1
         if (i > 0) then
            do k = p%first_arm(i), p%first_arm(i + 1) - 1
               if (p%arm_frame(k) == 0) instance%ground = instance%ground + p%arm(:, k)
            end do
            do k = p%first_slide(i), p%first_slide(i + 1) - 1
               f%slides = f%slides + 1
               b%slides(f%slides) = slide_t(p%slide_frame(k), f%column(p%slide_frame(k)), &
                  b%frames + p%slide_number(k), f%column(b%frames + p%slide_number(k)), p%slide_arm(:, k))
            end do
         end if
         instance%last_slide = f%slides
      end associate
   end subroutine add_instance

   !> Arms of polygon `i`: those of the block's `own` frames, or the known ones.
   subroutine add_arms(p, i, own, b, f)
      type(polygons_t), intent(in) :: p
      integer, intent(in) :: i
      logical, intent(in) :: own
      type(blocks_t), intent(inout) :: b
      type(filling_t), intent(inout) :: f
      integer :: k

      do k = p%first_arm(i), p%first_arm(i + 1) - 1
         if (p%arm_frame(k) == 0 .or. (f%column(p%arm_frame(k)) > 0 .neqv. own)) cycle
         f%arms = f%arms + 1
         b%arms(f%arms) = arm_t(p%arm_frame(k), f%column(p%arm_frame(k)), p%arm(1, k), p%arm(2, k))
      end do
   end subroutine add_arms

   !> A bound of |J(x) - J(z)|/|x - z| in the maximum norm: for a row, the sum of its second derivatives. Slides count
   !> with the length 1; a projection turns once more with its own frame.
   pure real(wp) function bend_of(b, block) result(bend)
      type(blocks_t), intent(in) :: b
      type(block_t), intent(in) :: block
      real(wp) :: row
      integer :: m

      bend = 0.0_wp
      do m = block%first_instance, block%last_instance
         associate (g => b%instances(m))
            row = sum(hypot(b%arms(g%first_own:g%last_arm)%x, b%arms(g%first_own:g%last_arm)%y)) &
               + 2.0_wp*real(g%last_slide - g%first_slide + 1, wp)
            if (g%frame_column > 0 .and. g%kind == instance_projection) row = 3.0_wp*row + norm2(g%ground) &
               + sum(hypot(b%arms(g%first_arm:g%first_own - 1)%x, b%arms(g%first_arm:g%first_own - 1)%y))
            bend = max(bend, row)
         end associate
      end do
   end function bend_of

   !> Room for all instances: a polygon whose two components lie in different blocks has two.
   subroutine reserve(e, b, f)
      type(equations_t), intent(in) :: e
      type(blocks_t), intent(inout) :: b
      type(filling_t), intent(inout) :: f
      integer :: arms, slides, i

      arms = 0
      slides = 0
      do i = 1, e%count
         associate (p => e%polygons, k => e%list(i)%polygon)
            if (k == 0) cycle
            arms = arms + p%first_arm(k + 1) - p%first_arm(k)
            slides = slides + p%first_slide(k + 1) - p%first_slide(k)
         end associate
      end do
      allocate (b%instances(e%count), b%arms(arms), b%slides(slides))
      allocate (f%column(0:b%unknowns), f%latest(0:e%polygons%count), source=0)
   end subroutine reserve
end module blocks
