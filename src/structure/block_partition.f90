!> The blocks of a mechanism: matching and strongly connected components on which unknown is in which
!> equation, the part with too many equations first. Then each vector loop in its own lengths: its rows, and the slides
!> that its block solves for, in units of its largest body vector. A residual, closure error or correction is then small
!> or large for that loop and not for the largest link of the mechanism. Units are powers of two: no digit changes.
!>
!> What a block knows may be much larger than its own body vectors. Its rounding cannot be corrected: `coarse` says how
!> much larger it is, and levels of rounding are that much higher.
module block_partition
   use kinds, only: wp
   use links_tree, only: tree_t
   use block_matrix, only: shape_t
   use matching, only: is_same_incidence, match, find_blocks, overdetermined
   use loop_equations, only: equations_t, incidence, equation_angle, equation_slide
   use blocks, only: blocks_t, block_t, block_loop_t, body_vector_t, loop_angles, loop_projection
   use block_loops, only: fill_block_loops, find_places, lipschitz_of, put_numbers
   use scales, only: power_of_two
   implicit none
   private
   public :: new_blocks, renew_blocks, find_units

   real(wp), parameter :: much_smaller = 0.0625_wp

contains

   !> The blocks of the equations `e` on the tree `t`.
   function new_blocks(t, e) result(b)
      type(tree_t), intent(in) :: t
      type(equations_t), intent(in) :: e
      type(blocks_t) :: b
      integer, allocatable :: unknown_of(:), equation_of(:), first(:), member(:)
      logical :: over(e%count), is_same
      integer :: i

      b%orientations = t%orientations
      b%unknowns = t%orientations + t%slides + 2*t%roots
      b%incidence = incidence(e, b%orientations, b%unknowns)
      call match(b%incidence, unknown_of, equation_of)
      b%free = pack([(i, i=1, b%unknowns)], equation_of == 0)
      b%solvable = size(b%free) == 0
      b%redundant = count(unknown_of == 0)
      if (.not. b%solvable) return
      over = overdetermined(b%incidence, unknown_of, equation_of)
      call find_blocks(b%incidence, equation_of, first, member, over)
      allocate (b%list(size(first) - 1))
      do i = 1, size(b%list)
         associate (block => b%list(i))
            block%first = first(i)
            block%last = first(i + 1) - 1
            block%shape%n = block%last - block%first + 1
            block%shape%rows = block%shape%n
         end associate
      end do
      b%list%first_row = b%list%first
      b%list%last_row = b%list%last
      b%unknown = unknown_of(member)
      if (b%redundant > 0) call put_first(over)
      allocate (b%block_of(b%unknowns))
      do i = 1, size(b%list)
         b%block_of(b%unknown(b%list(i)%first:b%list(i)%last)) = i
      end do
      call fill_rows()
      call fill_block_loops(e, member, b)
      call move_alloc(member, b%equation)
      b%first_term = e%vector_loops%first_term(1:e%vector_loops%count + 1)
      b%terms = e%vector_loops%terms(:, :e%vector_loops%term_count)
      allocate (b%unit(0:b%unknowns), source=1.0_wp)
      call find_places(b)
      call put_numbers(e, b, is_same)
      do i = 1, size(b%list)
         b%list(i)%lipschitz = lipschitz_of(b, b%list(i))
      end do

   contains

      !> Puts the block of the equations that are `over` before the others: it needs nothing of them.
      subroutine put_first(over)
         logical, intent(in) :: over(:)
         type(block_t) :: block
         integer, allocatable :: rows(:)
         integer :: i

         rows = pack([(i, i=1, size(over))], over)
         block%last_row = size(rows)
         block%last = count(unknown_of(rows) > 0)
         block%shape = shape_t(rows=block%last_row, n=block%last)
         b%list%first = b%list%first + block%last
         b%list%last = b%list%last + block%last
         b%list%first_row = b%list%first_row + block%last_row
         b%list%last_row = b%list%last_row + block%last_row
         b%list = [block, b%list]
         b%unknown = [pack(unknown_of(rows), unknown_of(rows) > 0), b%unknown]
         member = [rows, member]
      end subroutine put_first

      !> Drives, and which blocks need no iteration.
      subroutine fill_rows()
         integer :: i, k

         allocate (b%rows(size(member)))
         do i = 1, size(b%list)
            do k = b%list(i)%first_row, b%list(i)%last_row
               associate (equation => e%list(member(k)), row => b%rows(k))
                  row%drive = equation%drive
                  row%pair = equation%pair
                  row%angular = equation%kind == equation_angle
                  b%list(i)%direct = any(equation%kind == [equation_angle, equation_slide]) &
                     .and. b%list(i)%shape%rows == 1 .and. b%list(i)%shape%n == 1
                  if (.not. (b%list(i)%direct .and. row%angular)) cycle
                  ! phi_orientation - phi_less = constant + value, solved for the one that is unknown.
                  row%other = equation%less
                  if (b%unknown(b%list(i)%first) /= equation%less) cycle
                  row%other = equation%orientation
                  row%sign_of = -1.0_wp
               end associate
            end do
         end do
      end subroutine fill_rows
   end function new_blocks

   !> Gives `b`, the blocks of equations that differ from `e` in numbers alone, those of `e`, in one unit of length.
   !> `is_done`: each equation has the same unknowns and each loop the same body vectors; otherwise `b` is of no use.
   subroutine renew_blocks(e, b, is_done)
      type(equations_t), intent(in) :: e
      type(blocks_t), intent(inout) :: b
      logical, intent(out) :: is_done

      is_done = b%solvable
      if (is_done) is_done = is_same_incidence(incidence(e, b%orientations, b%unknowns), b%incidence)
      if (is_done) call put_numbers(e, b, is_done)
   end subroutine renew_blocks

   !> Divides the rows of all blocks of `b`, filled in one unit of length, by units of their own, and its slides.
   pure subroutine find_units(b)
      type(blocks_t), intent(inout) :: b
      integer :: i, m

      do i = 1, size(b%list)
         associate (first => b%list(i)%first_loop, last => b%list(i)%last_loop)
            do m = first, last
               call measure(b, m)
            end do
            call make_alike(b%loops(first:last))
            call measure_slides(b, i)
            do m = first, last
               call divide(b, b%list(i)%first_row, m)
            end do
            b%list(i)%lipschitz = lipschitz_of(b, b%list(i))
            b%list(i)%coarse = max(1.0_wp, maxval(b%loops(first:last)%coarse))
         end associate
      end do
   end subroutine find_units

   !> Unit of loop `m`: its largest own body vector. A slide is as long as what is known lets it be, and a projection
   !> that turns with an orientation of the block turns the whole loop.
   pure subroutine measure(b, m)
      type(blocks_t), intent(inout) :: b
      integer, intent(in) :: m
      real(wp) :: own, known
      integer :: k

      associate (g => b%loops(m))
         if (g%kind == loop_angles) return
         known = max(maxval(abs(g%ground)), largest(b%body_vectors(g%first_vector:g%first_own - 1)))
         own = largest(b%body_vectors(g%first_own:g%last_vector))
         do k = g%first_slide, g%last_slide
            if (b%slides(k)%column == 0) known = max(known, b%unit(b%slides(k)%unknown))
         end do
         if (own <= 0.0_wp .or. any(b%slides(g%first_slide:g%last_slide)%column > 0) .or. &
            (g%kind == loop_projection .and. g%orientation_column > 0)) own = max(own, known)
         if (own > 0.0_wp) g%unit = power_of_two(own)
         g%coarse = known
      end associate
   end subroutine measure

   !> The largest component of `vectors`; 0 of none.
   pure real(wp) function largest(vectors)
      type(body_vector_t), intent(in) :: vectors(:)

      largest = max(0.0_wp, maxval(abs(vectors%x)), maxval(abs(vectors%y)))
   end function largest

   !> Loops `g` of one block that are not much smaller than the largest get its unit: the weights of their rows are then
   !> the same where equations are too many. What is known is from now on in the loop's unit.
   pure subroutine make_alike(g)
      type(block_loop_t), intent(inout) :: g(:)
      real(wp) :: largest
      integer :: m

      largest = maxval(g%unit, mask=g%kind /= loop_angles)
      do m = 1, size(g)
         if (g(m)%kind == loop_angles) cycle
         if (g(m)%unit >= much_smaller*largest) g(m)%unit = largest
         g(m)%coarse = max(1.0_wp, g(m)%coarse/g(m)%unit)
      end do
   end subroutine make_alike

   !> Units of the slides that block `i` solves for: that of the largest loop in which each stands.
   pure subroutine measure_slides(b, i)
      type(blocks_t), intent(inout) :: b
      integer, intent(in) :: i
      integer :: m, k
      logical :: met(0:merge(b%unknowns, 0, size(b%slides) > 0))

      met = .false.
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            do k = g%first_slide, g%last_slide
               if (b%slides(k)%column == 0) cycle
               associate (u => b%slides(k)%unknown)
                  if (met(u)) then
                     b%unit(u) = max(b%unit(u), g%unit)
                  else
                     b%unit(u) = g%unit
                  end if
                  met(u) = .true.
               end associate
            end do
         end associate
      end do
   end subroutine measure_slides

   !> Divides the rows of loop `m`, of the block whose rows begin at `first_row`, by its unit.
   pure subroutine divide(b, first_row, m)
      type(blocks_t), intent(inout) :: b
      integer, intent(in) :: first_row, m
      integer :: k, side

      associate (g => b%loops(m))
         ! A slide by itself.
         if (g%kind == loop_angles) g%unit = b%unit(g%orientation)
         do side = 1, 2
            k = merge(g%row_x, g%row_y, side == 1)
            if (k == 0) cycle
            associate (row => b%rows(first_row + k - 1))
               row%unit = g%unit
               row%constant = row%constant/g%unit
            end associate
         end do
         if (g%kind == loop_angles) return
         g%ground = g%ground/g%unit
         b%body_vectors(g%first_vector:g%last_vector)%x = b%body_vectors(g%first_vector:g%last_vector)%x/g%unit
         b%body_vectors(g%first_vector:g%last_vector)%y = b%body_vectors(g%first_vector:g%last_vector)%y/g%unit
         do k = g%first_slide, g%last_slide
            b%slides(k)%body_vector = b%slides(k)%body_vector*(b%unit(b%slides(k)%unknown)/g%unit)
         end do
      end associate
   end subroutine divide
end module block_partition
