!> The equations of a block as a bilinear system in isotropic coordinates (Wampler, J. Mech. Des. 121 (1999) 387-391):
!> a direction phi is the pair w = exp(i phi), w' = exp(-i phi) with w w' = 1, a slide s along it the pair z = s w,
!> z' = s w' with z w' = z' w. A vector loop is then linear in (w, z), its conjugate linear in (w', z'): both are
!> eliminated. What is left is linear in each of the two groups: the products above, projections (a loop times a
!> direction), and single components (a loop and its conjugate).
module block_bilinear
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use plane_vectors, only: length_of
   use blocks, only: blocks_t, geometry_t, loop_projection, loop_angles
   use block_state, only: state_t, given
   use block_equations, only: find_known_parts
   use bilinear, only: bilinear_t, path_end_t, find_null_space
   implicit none
   private
   public :: block_form_t, make_form, real_values

   !> The system of a block, from whose solutions its unknowns follow.
   type :: block_form_t
      integer, allocatable :: turns(:)                !< (n) of a slide its direction, 0: a known one; of a direction -1
      complex(dp), allocatable :: basis(:, :)         !< (0:n, 0:p) of directions and slides from the system's unknowns
      logical :: is_lacking = .false.                 !< fewer equations than unknowns, where earlier blocks are now
      logical :: is_impossible = .false.              !< its linear equations contradict one another
      type(bilinear_t) :: system
      complex(wp), allocatable :: more(:, :, :)       !< (0:p, 0:p, any number) equations that are too many
   end type block_form_t

   complex(wp), parameter :: i_unit = (0.0_wp, 1.0_wp)
   !> Coefficients below this part of the largest are rounding.
   real(wp), parameter :: zero_level = 4096.0_wp*epsilon(1.0_wp)
   !> Of equations that are too many those that differ by less agree: the numbers of the deck have 11 digits, of which
   !> the elimination may lose two. Newton's method then decides with the exact equations.
   real(wp), parameter :: surplus_level = max(1.0e-8_wp, sqrt(epsilon(1.0_wp)))
   !> Within a closing tolerance they differ by so many times that.
   real(wp), parameter :: lost_by_elimination = 10.0_wp

   !> Re(l conj(factor w)) = value, w direction number `at` of the group; 0: 1.
   type :: projection_t
      complex(wp), allocatable :: l(:)                !< (n + 1) a linear form, its constant part first
      real(wp) :: size_of = 0.0_wp                    !< the sum of the sizes of its terms, in the unit of the loop
      complex(wp) :: factor = 1.0_wp
      integer :: at = 0
      real(wp) :: value = 0.0_wp
   end type projection_t

   !> Equations in the making.
   type :: draft_t
      integer :: linear = 0, bilinear = 0
      complex(wp), allocatable :: a(:, :)             !< (0:n, linear): sum over k of a_k x_k = 0
      complex(wp), allocatable :: c(:, :, :)          !< (0:n, 0:n, bilinear)
      real(wp), allocatable :: size_of(:)             !< (bilinear) of the terms of each: see projection_t
      type(projection_t), allocatable :: projections(:)
   end type draft_t

contains

   !> The form of block `i` of `b`, for the values that `s` has of earlier blocks and drives.
   subroutine make_form(b, x, i, s, form)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      type(block_form_t), intent(out) :: form
      type(draft_t) :: d
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
         call reduce(form, d, merge(max(surplus_level, lost_by_elimination*x%closing), zero_level, rows > n))
      end associate
   end subroutine make_form

   !> Adds what `loop` of block `i` asks of two angles, w = exp(i phi) w_less, or of a slide, z = s w.
   pure subroutine add_angles(b, x, i, loop, s, form, draft)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i, loop
      type(state_t), intent(in) :: s
      type(block_form_t), intent(in) :: form
      type(draft_t), intent(inout) :: draft
      complex(wp) :: ratio
      integer :: less

      associate (g => b%loops(loop))
         if (g%orientation_column == g%less_column) return
         draft%linear = draft%linear + 1
         if (g%orientation <= b%orientations) then
            less = g%less_column
            ratio = exp(i_unit*given(b, x, i, g%row_x, s))*direction_factor(less, g%less, s)
            draft%a(g%orientation_column, draft%linear) = direction_factor(g%orientation_column, g%orientation, s)
         else
            less = form%turns(g%orientation_column)
            ratio = given(b, x, i, g%row_x, s) + s%u(g%less)%value
            draft%a(g%orientation_column, draft%linear) = 1.0_wp
         end if
         draft%a(less, draft%linear) = draft%a(less, draft%linear) - ratio
      end associate
   end subroutine add_angles

   !> Adds the equations of `loop` of block `i`, of `n` unknowns: each a projection of the loop.
   subroutine add_loop(b, x, i, loop, s, n, draft)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i, loop, n
      type(state_t), intent(in) :: s
      type(draft_t), intent(inout) :: draft
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

      !> Adds the projection for row number `row` of the block.
      subroutine add(row)
         integer, intent(in) :: row

         one%value = given(b, x, i, row, s)
         draft%projections = [draft%projections, one]
      end subroutine add
   end subroutine add_loop

   !> The factor of `unknown`, in `column` of its block: 1 for a direction of the block, otherwise the known
   !> direction.
   pure complex(wp) function direction_factor(column, unknown, s) result(factor)
      integer, intent(in) :: column, unknown
      type(state_t), intent(in) :: s

      factor = 1.0_wp
      if (column == 0) factor = cmplx(s%u(unknown)%c, s%u(unknown)%s, wp)
   end function direction_factor

   !> Finds the linear form `line` (0:n) of `loop` in 1 and the n unknowns of a group. `size_of`: the sum of the sizes
   !> of its terms that are known or of known length, in the loop's unit; rounding of the loop is measured by it.
   pure subroutine find_form(b, x, loop, s, line, size_of)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: loop
      type(state_t), intent(in) :: s
      complex(wp), intent(out) :: line(0:)
      real(wp), intent(out) :: size_of
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
               factor = direction_factor(e%orientation_column, e%orientation, s) &
                  *cmplx(x%e(k)%x, x%e(k)%y, wp)
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

   !> Two projections of one loop, in whatever unit, on different directions that turn together are one linear equation:
   !> the components of a closed loop, or a slide that is driven and its guide. The others are bilinear.
   subroutine add_projections(draft)
      type(draft_t), intent(inout) :: draft
      logical :: is_done(size(draft%projections))
      real(wp) :: turn, ratio
      integer :: j, k, m

      is_done = .false.
      do j = 1, size(is_done)
         associate (one => draft%projections(j))
            do k = j + 1, size(is_done)
               associate (other => draft%projections(k))
                  turn = aimag(conjg(one%factor)*other%factor)
                  if (is_done(j) .or. is_done(k) .or. one%at /= other%at .or. abs(turn) <= sqrt(zero_level)) cycle
                  if (maxval(abs(one%l)) <= 0.0_wp .or. maxval(abs(other%l)) <= 0.0_wp) cycle
                  m = maxloc(abs(one%l), 1)
                  ratio = real(other%l(m)/one%l(m))
                  if (maxval(abs(other%l - ratio*one%l)) > zero_level*maxval(abs(other%l))) cycle
                  ! The loop is r w, where Re(r conj(one%factor)) and Re(r conj(other%factor)) are the values of both.
                  draft%linear = draft%linear + 1
                  draft%a(:, draft%linear) = one%l
                  draft%a(one%at, draft%linear) = draft%a(one%at, draft%linear) &
                     - i_unit*(other%value/ratio*one%factor - one%value*other%factor)/turn
                  is_done([j, k]) = .true.
               end associate
            end do
            if (is_done(j)) cycle
            draft%bilinear = draft%bilinear + 1
            associate (c => draft%c(:, :, draft%bilinear), at => one%at + 1)
               ! associate loses the lower bound: element 1 is that of 1.
               c(:, at) = c(:, at) + 0.5_wp*one%l*conjg(one%factor)
               c(at, :) = c(at, :) + 0.5_wp*conjg(one%l)*one%factor
               c(1, 1) = c(1, 1) - one%value
            end associate
            draft%size_of(draft%bilinear) = one%size_of + abs(one%value)
         end associate
      end do
   end subroutine add_projections

   !> Adds w w' = 1 and z w' = z' w, and puts 1 for w w' in the other equations.
   subroutine add_pairs(form, draft)
      type(block_form_t), intent(in) :: form
      type(draft_t), intent(inout) :: draft
      integer :: k, j

      do k = 1, size(form%turns)
         if (form%turns(k) < 0) then
            do j = 1, draft%bilinear
               draft%c(0, 0, j) = draft%c(0, 0, j) + draft%c(k, k, j)
               draft%c(k, k, j) = 0.0_wp
            end do
         end if
      end do
      do k = 1, size(form%turns)
         draft%bilinear = draft%bilinear + 1
         if (form%turns(k) < 0) then
            draft%c(k, k, draft%bilinear) = 1.0_wp
            draft%c(0, 0, draft%bilinear) = -1.0_wp
         else
            draft%c(k, form%turns(k), draft%bilinear) = 1.0_wp
            draft%c(form%turns(k), k, draft%bilinear) = -1.0_wp
         end if
      end do
   end subroutine add_pairs

   !> Eliminates the linear equations. Equations that follow from others to `level` are left out; of more independent
   !> ones than unknowns combinations are taken.
   subroutine reduce(form, draft, level)
      type(block_form_t), intent(inout) :: form
      type(draft_t), intent(in) :: draft
      real(wp), intent(in) :: level          !< part of the terms, 0 to 1
      complex(wp), allocatable :: basis(:, :), c(:, :, :), independent(:, :), left(:)
      real(wp) :: size_of
      integer :: p, j, k, count_of

      call find_null_space(transpose(draft%a(:, :draft%linear)), level, basis)
      p = size(basis, 2) - 1
      allocate (form%basis(0:size(form%turns), 0:p))
      form%basis(:, :) = cmplx(basis, kind=dp)
      allocate (c(0:p, 0:p, draft%bilinear), independent((p + 1)**2, 0))
      count_of = 0
      do j = 1, draft%bilinear
         associate (one => c(:, :, count_of + 1))
            one = matmul(transpose(basis), matmul(draft%c(:, :, j), conjg(basis)))
            ! What is left may be rounding alone: it is compared with the terms, and with what they are multiplied by.
            size_of = max(draft%size_of(j), maxval(abs(draft%c(:, :, j))))*maxval([0.0_wp, abs(basis)])**2
            if (maxval([0.0_wp, abs(one)]) <= level*size_of) cycle
            one = one/maxval(abs(one))
            ! Of angles that differ by what is given one equation is left twice. The part `left` of a combination of
            ! those before is rounding; `independent` are orthogonal combinations of them, of length 1.
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

   !> (n) The unknowns of the block at the solution `ending`. `is_real`: x and y are conjugate, as far as rounding can
   !> tell.
   subroutine real_values(form, ending, level, values, is_real)
      type(block_form_t), intent(in) :: form
      type(path_end_t), intent(in) :: ending
      real(dp), intent(in) :: level
      real(wp), intent(out) :: values(:)
      logical, intent(out) :: is_real
      complex(dp) :: w(0:size(form%turns)), v(0:size(form%turns))
      integer :: k

      w = matmul(form%basis, ending%x)
      v = matmul(conjg(form%basis), ending%y)
      w = w/w(0)
      v = conjg(v/v(0))
      is_real = maxval(abs(w - v)) <= level*maxval(abs(w))
      w = 0.5_dp*(w + v)
      do k = 1, size(values)
         if (form%turns(k) < 0) then
            values(k) = real(atan2(aimag(w(k)), real(w(k))), wp)
         else
            values(k) = real(w(k)*conjg(w(form%turns(k))), wp)
         end if
      end do
   end subroutine real_values
end module block_bilinear
