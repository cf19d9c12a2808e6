!> The equations of a block as a bilinear system in isotropic coordinates (Wampler, J. Mech. Des. 121 (1999) 387-391):
!> a direction phi is the pair w = exp(i phi), w' = exp(-i phi) with w w' = 1, a slide s along it the pair z = s w,
!> z' = s w' with z w' = z' w. A vector loop is then linear in (w, z), its conjugate linear in (w', z'): both are
!> eliminated. The rest is linear in each of the two groups: the products above, projections (a loop times a
!> direction), and single components (a loop and its conjugate).
module block_bilinear
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use plane_vectors, only: length_of
   use blocks, only: blocks_t, geometry_t, loop_projection, loop_angles
   use block_state, only: state_t, given
   use block_equations, only: find_known_parts
   use bilinear, only: bilinear_t, find_null_space
   implicit none
   private
   public :: block_form_t, make_form

   !> The system of a block, of which each group has p unknowns. The n unknowns of the block follow from its solutions.
   type :: block_form_t
      !> (n) -1 of an angle; of a slide the column of the angle of its guide, 0 if an earlier block has this angle.
      integer, allocatable :: turns(:)
      !> (0:n, 0:p) 1, directions w and slides z of the block from the unknowns of the first group.
      complex(dp), allocatable :: basis(:, :)
      logical :: is_lacking = .false.                 !< fewer equations than unknowns, at the values of earlier blocks
      logical :: is_impossible = .false.              !< its linear equations contradict one another
      type(bilinear_t) :: system                      !< not set if lacking or impossible
      complex(wp), allocatable :: more(:, :, :)       !< (0:p, 0:p, any number) the equations beyond 2p
   end type block_form_t

   complex(wp), parameter :: i_unit = (0.0_wp, 1.0_wp)   !< the imaginary unit, a quarter turn
   !> Coefficients below this part of the largest are rounding of the elimination.
   real(wp), parameter :: zero_coefficient = 4096.0_wp*epsilon(1.0_wp)
   !> Redundant equations agree if they differ by less than this part of their terms. The numbers of the deck have 11
   !> digits, and the elimination may lose two. Newton's method then decides with the exact equations.
   real(wp), parameter :: redundant_part = max(1.0e-8_wp, sqrt(epsilon(1.0_wp)))
   !> With a closing tolerance redundant equations agree if they differ by less than this many times the tolerance: the
   !> elimination may lose one digit.
   real(wp), parameter :: redundant_per_closing = 10.0_wp

   !> An equation Re(l conj(factor w)) = value, with w a direction.
   type :: projection_t
      complex(wp), allocatable :: l(:)                !< (n + 1) a linear form, its constant first, unit of the loop
      real(wp) :: size_of = 0.0_wp                    !< the sum of the sizes of its terms, in the unit of the loop
      complex(wp) :: factor = 1.0_wp                  !< of size 1
      integer :: at = 0                               !< the column of w in the block; 0: w = 1
      real(wp) :: value = 0.0_wp                      !< of the projection, in the unit of the loop
   end type projection_t

   !> The equations of a system before the elimination.
   type :: bilinear_builder_t
      integer :: linear = 0, bilinear = 0             !< how many there are of each kind so far
      complex(wp), allocatable :: a(:, :)             !< (0:n, linear): sum over k of a_k x_k = 0
      complex(wp), allocatable :: c(:, :, :)          !< (0:n, 0:n, bilinear): sum over j and k of x_j c_jk y_k = 0
      real(wp), allocatable :: size_of(:)             !< (bilinear) the sum of the sizes of the terms of each
      type(projection_t), allocatable :: projections(:)   !< those to be added
   end type bilinear_builder_t

contains

   !> Makes the bilinear system of a block, for given values of earlier blocks and drives.
   subroutine make_form(b, x, i, s, form)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< with values of earlier blocks and drives; given parts of loops are set
      type(block_form_t), intent(out) :: form   !< is_lacking, is_impossible: without a system
      type(bilinear_builder_t) :: d
      integer :: m

      call find_known_parts(b, x, i, s)
      associate (block => b%list(i), rows => b%list(i)%shape%rows, n => b%list(i)%shape%n)
         form%turns = merge(-1, 0, b%unknown(block%first:block%last) <= b%orientations)
         do m = b%loops(block%first_loop)%first_slide, b%loops(block%last_loop)%last_slide
            if (b%slides(m)%column > 0) form%turns(b%slides(m)%column) = b%slides(m)%orientation_column
         end do

         allocate (d%projections(0))
         allocate (d%a(0:n, rows), d%c(0:n, 0:n, rows + n), source=(0.0_wp, 0.0_wp))
         allocate (d%size_of(rows + n), source=1.0_wp)
         do m = block%first_loop, block%last_loop
            if (b%loops(m)%kind == loop_angles) then
               call add_angles(b, x, i, m, s, form, d)
            else
               call add_loop(b, x, i, m, s, n, d)
            end if
         end do
         call add_projections(d)
         call add_pairs(form, d)
         call reduce(form, d, merge(max(redundant_part, redundant_per_closing*x%closing), zero_coefficient, rows > n))
      end associate
   end subroutine make_form

   !> Adds the linear equation of a loop of angles, w = exp(i phi) w_less, or of a slide, z = s w. Column 0 is the angle
   !> of the ground: with an angle of an earlier block the equation would be a block of its own. If both angles are in
   !> one column, there is no equation.
   pure subroutine add_angles(b, x, i, loop, s, form, builder)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      integer, intent(in) :: loop            !< the number of the loop, of kind loop_angles
      type(state_t), intent(in) :: s         !< with the drives and earlier blocks
      type(block_form_t), intent(in) :: form   !< with `turns`
      type(bilinear_builder_t), intent(inout) :: builder   !< with the equations so far
      complex(wp) :: ratio
      integer :: less

      associate (g => b%loops(loop))
         if (g%orientation_column == g%less_column) return
         builder%linear = builder%linear + 1
         less = g%less_column
         ratio = given(b, x, i, g%row_x, s)
         if (g%orientation <= b%orientations) then
            ratio = exp(i_unit*ratio)
         else
            less = form%turns(g%orientation_column)
         end if
         builder%a(g%orientation_column, builder%linear) = 1.0_wp
         builder%a(less, builder%linear) = builder%a(less, builder%linear) - ratio
      end associate
   end subroutine add_angles

   !> Adds the equations of a vector loop to the projections: x, y, or the projection on a direction.
   subroutine add_loop(b, x, i, loop, s, n, builder)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      integer, intent(in) :: loop            !< the number of the loop
      integer, intent(in) :: n               !< how many unknowns the block has
      type(state_t), intent(in) :: s         !< with the drives, earlier blocks, and given parts of loops
      type(bilinear_builder_t), intent(inout) :: builder   !< with the equations so far
      type(projection_t) :: one

      allocate (one%l(n + 1))
      call find_form(b, x, loop, s, one%l, one%size_of)
      associate (g => b%loops(loop))
         if (g%kind == loop_projection) then
            one%at = g%orientation_column
            one%factor = direction_factor(one%at, g%orientation, s) &
               *cmplx(x%loops(loop)%direction%x, x%loops(loop)%direction%y, wp)
         end if
         if (g%row_x > 0) call add(g%row_x)
         one%factor = i_unit
         if (g%row_y > 0) call add(g%row_y)
      end associate

   contains

      !> Adds the projection `one` with the value of a row.
      subroutine add(row)
         integer, intent(in) :: row          !< the number of the row in the block

         one%value = given(b, x, i, row, s)
         builder%projections = [builder%projections, one]
      end subroutine add
   end subroutine add_loop

   !> Gives the factor that a direction has in a linear form: 1 for an unknown direction of the block, otherwise the
   !> direction w itself, of size 1.
   pure complex(wp) function direction_factor(column, unknown, s) result(factor)
      integer, intent(in) :: column          !< of the angle in the block; 0: an earlier block has it
      integer, intent(in) :: unknown         !< the number of the angle
      type(state_t), intent(in) :: s         !< with earlier blocks

      factor = 1.0_wp
      if (column == 0) factor = cmplx(s%u(unknown)%c, s%u(unknown)%s, wp)
   end function direction_factor

   !> Finds the closure error of a loop as a linear form in 1 and the unknowns of a group, and the size of its terms.
   pure subroutine find_form(b, x, loop, s, line, size_of)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: loop            !< the number of the loop
      type(state_t), intent(in) :: s         !< with earlier blocks, and the loop's given part
      complex(wp), intent(out) :: line(0:)   !< (0:n) coefficients, in the unit of the loop
      real(wp), intent(out) :: size_of       !< the sum of |terms|, an unknown slide as 1, in the unit of the loop
      complex(wp) :: factor
      real(wp) :: slide
      integer :: k

      associate (g => b%loops(loop))
         line = 0.0_wp
         line(0) = cmplx(s%loop(loop)%known(0)%x, s%loop(loop)%known(0)%y, wp)
         size_of = length_of(x%loops(loop)%ground)
         do k = g%first_vector, g%last_vector
            size_of = size_of + length_of(x%d(k))
            if (k < g%first_own) cycle
            associate (d => b%body_vectors(k))
               line(d%column) = line(d%column) + direction_factor(d%column, d%orientation, s) &
                  *cmplx(x%d(k)%x, x%d(k)%y, wp)
            end associate
         end do

         do k = g%first_slide, g%last_slide
            associate (e => b%slides(k))
               factor = direction_factor(e%orientation_column, e%orientation, s)*cmplx(x%e(k)%x, x%e(k)%y, wp)
               slide = 1.0_wp
               if (e%column > 0) then
                  line(e%column) = line(e%column) + factor
               else
                  slide = s%u(e%unknown)%value
                  line(e%orientation_column) = line(e%orientation_column) + factor*slide
               end if
            end associate
            size_of = size_of + length_of(x%e(k))*abs(slide)
         end do
      end associate
   end subroutine find_form

   !> Adds the projections as equations. Two projections of one loop, in any units, on different directions that turn
   !> together are one linear equation: the components of a closed loop, or a driven slide and its guide. Any other
   !> projection is a bilinear equation.
   subroutine add_projections(builder)
      type(bilinear_builder_t), intent(inout) :: builder   !< with projections; equations are added
      logical :: is_done(size(builder%projections))
      real(wp) :: turn, ratio
      integer :: j, k, m

      is_done = .false.
      do j = 1, size(is_done)
         associate (one => builder%projections(j))
            do k = j + 1, size(is_done)
               associate (other => builder%projections(k))
                  turn = aimag(conjg(one%factor)*other%factor)
                  if (is_done(j) .or. is_done(k) .or. one%at /= other%at .or. abs(turn) <= sqrt(zero_coefficient)) cycle
                  if (maxval(abs(one%l)) <= 0.0_wp .or. maxval(abs(other%l)) <= 0.0_wp) cycle
                  m = maxloc(abs(one%l), 1)
                  ratio = real(other%l(m)/one%l(m))
                  if (maxval(abs(other%l - ratio*one%l)) > zero_coefficient*maxval(abs(other%l))) cycle

                  ! The loop is r w, where Re(r conj(one%factor)) and Re(r conj(other%factor)) are the values of both.
                  builder%linear = builder%linear + 1
                  builder%a(:, builder%linear) = one%l
                  builder%a(one%at, builder%linear) = builder%a(one%at, builder%linear) &
                     - i_unit*(other%value/ratio*one%factor - one%value*other%factor)/turn
                  is_done([j, k]) = .true.
               end associate
            end do

            if (is_done(j)) cycle
            builder%bilinear = builder%bilinear + 1
            associate (c => builder%c(:, :, builder%bilinear), at => one%at + 1)
               ! `c` counts from 1: element 1 is the coefficient of 1.
               c(:, at) = c(:, at) + 0.5_wp*one%l*conjg(one%factor)
               c(at, :) = c(at, :) + 0.5_wp*conjg(one%l)*one%factor
               c(1, 1) = c(1, 1) - one%value
            end associate
            builder%size_of(builder%bilinear) = one%size_of + abs(one%value)
         end associate
      end do
   end subroutine add_projections

   !> Adds the bilinear equations w w' = 1 of directions and z w' = z' w of slides, and puts 1 for w w' in the other
   !> equations.
   subroutine add_pairs(form, builder)
      type(block_form_t), intent(in) :: form   !< with `turns`
      type(bilinear_builder_t), intent(inout) :: builder   !< with all other equations
      integer :: k, j

      do k = 1, size(form%turns)
         if (form%turns(k) < 0) then
            do j = 1, builder%bilinear
               builder%c(0, 0, j) = builder%c(0, 0, j) + builder%c(k, k, j)
               builder%c(k, k, j) = 0.0_wp
            end do
         end if
      end do
      do k = 1, size(form%turns)
         builder%bilinear = builder%bilinear + 1
         if (form%turns(k) < 0) then
            builder%c(k, k, builder%bilinear) = 1.0_wp
            builder%c(0, 0, builder%bilinear) = -1.0_wp
         else
            builder%c(k, form%turns(k), builder%bilinear) = 1.0_wp
            builder%c(form%turns(k), k, builder%bilinear) = -1.0_wp
         end if
      end do
   end subroutine add_pairs

   !> Makes the system by eliminating the linear equations. Equations that follow from others are left out. Of more than
   !> 2p independent equations, the system has 2p combinations, and form%more the rest.
   subroutine reduce(form, builder, level)
      type(block_form_t), intent(inout) :: form   !< basis, system and findings are set
      type(bilinear_builder_t), intent(in) :: builder   !< with all equations
      real(wp), intent(in) :: level          !< an equation follows from others if its rest is below this part of it
      complex(wp), allocatable :: basis(:, :), c(:, :, :), independent(:, :), left(:)
      real(wp) :: size_of
      integer :: p, j, k, count_of

      call find_null_space(transpose(builder%a(:, :builder%linear)), level, basis)
      p = size(basis, 2) - 1
      allocate (form%basis(0:size(form%turns), 0:p))
      form%basis(:, :) = cmplx(basis, kind=dp)
      allocate (c(0:p, 0:p, builder%bilinear), independent((p + 1)**2, 0))
      count_of = 0
      do j = 1, builder%bilinear
         associate (one => c(:, :, count_of + 1))
            one = matmul(transpose(basis), matmul(builder%c(:, :, j), conjg(basis)))
            ! The rest `one` of an equation may be only rounding: it is compared with the terms and their factors.
            size_of = max(builder%size_of(j), maxval(abs(builder%c(:, :, j))))*maxval([0.0_wp, abs(basis)])**2
            if (maxval([0.0_wp, abs(one)]) <= level*size_of) cycle
            one = one/maxval(abs(one))

            ! Two angles with a given difference leave one equation twice. `independent` are orthogonal combinations, of
            ! length 1, of the equations before; `left` is the part of the equation that is orthogonal to them.
            left = reshape(one, [(p + 1)**2])
            do k = 1, size(independent, 2)
               left = left - dot_product(independent(:, k), left)*independent(:, k)
            end do
            if (.not. norm2(abs(left)) > level*norm2(abs(one))) cycle
            independent = reshape([independent, left/norm2(abs(left))], [size(left), size(independent, 2) + 1])
         end associate
         count_of = count_of + 1
      end do

      form%system%p = p
      form%is_impossible = maxval([0.0_wp, abs(basis(1, :))]) <= 0.0_wp
      form%is_lacking = count_of < 2*p
      if (form%is_impossible .or. form%is_lacking) return

      allocate (form%system%c(0:p, 0:p, 2*p), form%system%plane(0:p))
      form%system%plane(:) = form%basis(0, :)
      form%more = c(:, :, 2*p + 1:count_of)
      do j = 1, 2*p
         do k = 2*p + 1, count_of
            c(:, :, j) = c(:, :, j) + cos(real(j*k, wp))*c(:, :, k)
         end do
         form%system%c(:, :, j) = cmplx(c(:, :, j)/maxval(abs(c(:, :, j))), kind=dp)
      end do
   end subroutine reduce
end module block_bilinear
