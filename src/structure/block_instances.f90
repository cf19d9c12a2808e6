!> The polygons of each block, split into what it knows and what it seeks.
module block_instances
   use kinds, only: wp
   use polygons, only: polygons_t
   use loop_equations, only: equations_t, equation_t, equation_x, equation_y, equation_projection, &
      equation_slide
   use blocks, only: blocks_t, block_t, arm_t, slide_t, instance_components, instance_projection, instance_angles
   implicit none
   private
   public :: fill_instances, bend_of

   !> What has been filled, and the columns of the block being filled; 0: not its own.
   type :: filling_t
      integer :: instances = 0, arms = 0, slides = 0
      integer, allocatable :: column(:), latest(:)
   end type filling_t

contains

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
               do k = block%first_row, block%last_row
                  call add_row(e, e%list(member(k)), k - block%first_row + 1, block%first_instance, b, f)
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
         if (equation%kind == equation_slide) instance%frame = b%frames + equation%frame
         instance%frame_column = f%column(instance%frame)
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
               b%slides(f%slides) = slide_t(frame=p%slide_frame(k), frame_column=f%column(p%slide_frame(k)), &
                  unknown=b%frames + p%slide_number(k), column=f%column(b%frames + p%slide_number(k)), &
                  arm=p%slide_arm(:, k))
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
         b%arms(f%arms) = arm_t(frame=p%arm_frame(k), column=f%column(p%arm_frame(k)), x=p%arm(1, k), y=p%arm(2, k))
      end do
   end subroutine add_arms

   !> A bound of |J(x) - J(z)|/|x - z| in the maximum norm: for a row, the sum of its second derivatives. Slides count
   !> with the length of their unit; a projection turns once more with its own frame.
   pure real(wp) function bend_of(b, block) result(bend)
      type(blocks_t), intent(in) :: b
      type(block_t), intent(in) :: block
      real(wp) :: row
      integer :: m

      bend = 0.0_wp
      do m = block%first_instance, block%last_instance
         associate (g => b%instances(m))
            row = sum(hypot(b%arms(g%first_own:g%last_arm)%x, b%arms(g%first_own:g%last_arm)%y)) &
               + 2.0_wp*sum(hypot(b%slides(g%first_slide:g%last_slide)%arm(1), &
               b%slides(g%first_slide:g%last_slide)%arm(2)))
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
end module block_instances
