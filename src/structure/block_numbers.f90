!> The numbers that the cards of a mechanism make of its blocks. A variant, or a mechanism with one changed number, has
!> equal blocks with other numbers: `evaluate_geometry` fills these straight from the mechanism.
!>
!> Each vector loop is in its own lengths: its rows, and the slides that its block solves for, in units of its largest
!> body vector. A residual, closure error or correction is then small or large for that loop and not for the largest
!> link of the mechanism. Units are powers of two: no digit changes.
!>
!> The part of a loop that earlier blocks give may be much larger than the body vectors of the block. The rounding of
!> the given part cannot be corrected: `coarse` is the ratio of the two, and levels of rounding are higher by it.
module block_numbers
   use kinds, only: wp
   use plane_vectors, only: vector_t, length_of
   use mechanism, only: mechanism_t
   use scales, only: solver_length, power_of_two
   use vector_loops, only: vanishes
   use loop_equations, only: assign_equation_numbers, find_unknowns
   use blocks, only: blocks_t, block_t, block_loop_t, geometry_t, loop_numbers_t, loop_angles, loop_components, &
      loop_projection
   implicit none
   private
   public :: evaluate_geometry, fill_numbers, find_units, lipschitz_of

   !> A loop below this part of the largest loop of its block has a unit of its own. With a unit sixteen times too large
   !> a loop loses little more than one digit.
   real(wp), parameter :: much_smaller = 0.0625_wp
   !> The least unit of a loop with slides and no own body vector, in the unit of the mechanism: if only slides balance
   !> one another, they may be long although the given part is short.
   real(wp), parameter :: least_slide_unit = 0.0625_wp

contains

   !> Fills the geometry of blocks from the numbers of a mechanism; tolerance, chain and cylinders stay. If the numbers
   !> do not fit, `x` leaves out the unknowns and body vectors that `b` leaves out. If `b` is not solvable, they do not
   !> fit, and only span, closing and equations are set.
   subroutine evaluate_geometry(m, b, x, fits)
      type(mechanism_t), intent(in) :: m     !< with the links, points, pairs and drives of which `b` was made
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(inout) :: x   !< a geometry of `b`
      logical, intent(out) :: fits           !< equations and loops have the unknowns and body vectors of `b`
      logical, allocatable :: has_vector(:), counts(:, :)

      x%span = solver_length(m)
      x%closing = m%closing
      call assign_equation_numbers(m, b%tree, power_of_two(x%span), b%equations, x%equations)
      fits = b%solvable
      if (.not. fits) return

      has_vector = b%equations%has_vector
      counts = b%equations%counts
      call find_unknowns(b%equations, x%equations, has_vector, counts)
      fits = all(has_vector .eqv. b%equations%has_vector) .and. all(counts .eqv. b%equations%counts)
      call fill_numbers(b, x)
      call find_units(b, x)
   end subroutine evaluate_geometry

   !> Fills units, rows, loops, body vectors and slides of a geometry from the numbers of its equations, all in their
   !> unit of length, and allocates these lists if needed.
   pure subroutine fill_numbers(b, x)
      type(blocks_t), intent(in) :: b        !< solvable
      type(geometry_t), intent(inout) :: x   !< with the numbers of the equations
      integer :: i, m, k

      if (.not. allocated(x%unit)) allocate (x%blocks(size(b%list)), x%rows(size(b%rows)), x%loops(size(b%loops)), &
         x%d(size(b%body_vectors)), x%e(size(b%slides)), x%unit(0:b%unknowns))
      x%unit = 1.0_wp
      x%rows%unit = 1.0_wp
      x%rows%constant = x%equations%constant(b%equation)

      associate (sums => x%equations%sums, p => b%equations%vector_loops)
         x%d%x = sums%body_vector(1, b%body_vectors%source)
         x%d%y = sums%body_vector(2, b%body_vectors%source)
         x%e%x = sums%slide_body_vector(1, b%slides%source)
         x%e%y = sums%slide_body_vector(2, b%slides%source)

         do i = 1, size(b%list)
            associate (first => b%list(i)%first_row, last => b%list(i)%last_row)
               x%blocks(i)%has_right_sides = any(b%rows(first:last)%drive > 0 &
                  .or. abs(x%rows(first:last)%constant) > 0.0_wp)
            end associate
            do m = b%list(i)%first_loop, b%list(i)%last_loop
               associate (g => b%loops(m), equation => b%equation(b%list(i)%first_row + max(1, b%loops(m)%row_x) - 1))
                  x%loops(m) = loop_numbers_t()
                  if (g%kind /= loop_components) x%loops(m)%direction = vector_t(x%equations%direction(1, equation), &
                     x%equations%direction(2, equation))
                  do k = p%first_vector(g%vector_loop), p%first_vector(g%vector_loop + 1) - 1
                     if (p%vector_orientation(k) /= 0) cycle
                     if (vanishes(sums, k)) cycle
                     x%loops(m)%ground = vector_t(0.0_wp + sums%body_vector(1, k), 0.0_wp + sums%body_vector(2, k))
                  end do
               end associate
            end do
         end do
      end associate
   end subroutine fill_numbers

   !> Finds the units of all loops and slides, and divides the numbers of loops, rows and slides by these units.
   subroutine find_units(b, x)
      type(blocks_t), intent(in) :: b        !< solvable
      type(geometry_t), intent(inout) :: x   !< by `fill_numbers`, in one unit of length; then each loop in its own
      logical :: met(0:merge(b%unknowns, 0, size(b%slides) > 0))
      real(wp) :: longest
      integer :: i, m, k

      met = .false.
      do i = 1, size(b%list)
         associate (first => b%list(i)%first_loop, last => b%list(i)%last_loop)
            do m = first, last
               call find_unit(b%loops(m), x%loops(m))
            end do

            ! Loops that are not much smaller than the largest loop get its unit: their rows then have equal weights if
            ! equations are too many. `coarse` was the size of the given part; from here on it is in the loop's unit.
            associate (g => x%loops(first:last), has_lengths => b%loops(first:last)%kind /= loop_angles)
               longest = maxval(g%unit, mask=has_lengths)
               where (has_lengths .and. g%unit >= much_smaller*longest) g%unit = longest
               where (has_lengths) g%coarse = max(1.0_wp, g%coarse/g%unit)
            end associate

            ! A slide that the block solves for gets the unit of the largest loop that holds the slide.
            do m = first, last
               do k = b%loops(m)%first_slide, b%loops(m)%last_slide
                  if (b%slides(k)%column == 0) cycle
                  associate (u => b%slides(k)%unknown, unit => x%loops(m)%unit)
                     x%unit(u) = merge(max(x%unit(u), unit), unit, met(u))
                     met(u) = .true.
                  end associate
               end do
            end do
            do m = first, last
               call divide(b%list(i)%first_row, b%loops(m), x%loops(m))
            end do
            x%blocks(i)%lipschitz = lipschitz_of(b, x, b%list(i))
            x%blocks(i)%coarse = max(1.0_wp, maxval(x%loops(first:last)%coarse))
         end associate
      end do

   contains

      !> Finds the unit of a loop, the largest power of two not above its largest own body vector. Sets loop%coarse to
      !> the size of its given part, in the unit of the equations. The given part counts for the unit in two more cases:
      !> slides of the block are as long as the given part lets them be; an angle of the block turns the direction of a
      !> projection. If only slides balance one another, the unit is not below `least_slide_unit`.
      subroutine find_unit(cards, loop)
         type(block_loop_t), intent(in) :: cards       !< the loop's structure
         type(loop_numbers_t), intent(inout) :: loop   !< its numbers: unit and coarse are set; loop_angles: both stay
         real(wp) :: own, given
         logical :: slides
         integer :: k

         if (cards%kind == loop_angles) return
         given = max(largest([loop%ground]), largest(x%d(cards%first_vector:cards%first_own - 1)))
         own = largest(x%d(cards%first_own:cards%last_vector))
         do k = cards%first_slide, cards%last_slide
            if (b%slides(k)%column == 0) given = max(given, x%unit(b%slides(k)%unknown))
         end do
         slides = any(b%slides(cards%first_slide:cards%last_slide)%column > 0)
         if (slides .and. own <= 0.0_wp .and. given > 0.0_wp) own = least_slide_unit
         if (own <= 0.0_wp .or. slides .or. (cards%kind == loop_projection .and. cards%orientation_column > 0)) &
            own = max(own, given)
         if (own > 0.0_wp) loop%unit = power_of_two(own)
         loop%coarse = given
      end subroutine find_unit

      !> Gives the size of the largest component of vectors; 0 without vectors.
      pure real(wp) function largest(vectors)
         type(vector_t), intent(in) :: vectors(:)   !< (any number) in one unit

         largest = max(0.0_wp, maxval(abs(vectors%x)), maxval(abs(vectors%y)))
      end function largest

      !> Divides the rows, the vectors and the slides of a loop by its unit.
      subroutine divide(first_row, loop, own)
         integer, intent(in) :: first_row    !< the first row of its block, among all rows
         type(block_loop_t), intent(in) :: loop        !< the loop's structure
         type(loop_numbers_t), intent(inout) :: own    !< its numbers, in the unit of the equations; then in own%unit
         integer :: k, side

         ! The equation of one slide has the unit of that slide.
         if (loop%kind == loop_angles) own%unit = x%unit(loop%orientation)
         do side = 1, 2
            k = merge(loop%row_x, loop%row_y, side == 1)
            if (k == 0) cycle
            associate (row => x%rows(first_row + k - 1))
               row%unit = own%unit
               row%constant = row%constant/own%unit
            end associate
         end do

         if (loop%kind == loop_angles) return
         own%ground = vector_t(own%ground%x/own%unit, own%ground%y/own%unit)
         do k = loop%first_vector, loop%last_vector
            x%d(k) = vector_t(x%d(k)%x/own%unit, x%d(k)%y/own%unit)
         end do
         do k = loop%first_slide, loop%last_slide
            associate (ratio => x%unit(b%slides(k)%unknown)/own%unit)
               x%e(k) = vector_t(x%e(k)%x*ratio, x%e(k)%y*ratio)
            end associate
         end do
      end subroutine divide
   end subroutine find_units

   !> Bounds |J(y) - J(z)|/|y - z| of the Jacobian J of a block in the maximum norm, by the sum of the second
   !> derivatives in each row. A slide counts as one unit long; a projection has the derivatives by its own orientation
   !> as well.
   pure real(wp) function lipschitz_of(b, x, block) result(lipschitz)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x      !< its loops in their own units
      type(block_t), intent(in) :: block     !< a block of `b`
      real(wp) :: row
      integer :: m

      lipschitz = 0.0_wp
      do m = block%first_loop, block%last_loop
         associate (g => b%loops(m))
            row = sum_of_lengths(x%d(g%first_own:g%last_vector)) &
               + 2.0_wp*sum_of_lengths(x%e(g%first_slide:g%last_slide))
            if (g%orientation_column > 0 .and. g%kind == loop_projection) row = 3.0_wp*row &
               + length_of(x%loops(m)%ground) + sum_of_lengths(x%d(g%first_vector:g%first_own - 1))
            lipschitz = max(lipschitz, row)
         end associate
      end do
   end function lipschitz_of

   !> Adds up the lengths of vectors; 0 without vectors.
   pure real(wp) function sum_of_lengths(vectors)
      type(vector_t), intent(in) :: vectors(:)   !< (any number) in one unit

      sum_of_lengths = sum(hypot(vectors%x, vectors%y))
   end function sum_of_lengths
end module block_numbers
