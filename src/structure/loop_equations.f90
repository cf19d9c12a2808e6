!> The equations that the tree leaves over, and those of the drives: each gives a component of a vector loop, its
!> projection on a direction that turns with an orientation, an angle or a slide. A revolute pair requires both
!> components to be zero, a prismatic pair that the projection on the guide's normal is h. A drive X or Y gives one
!> component of its point, a drive SLIDE the projection along the guide.
!>
!> Equations are integers; `equation_numbers_t` holds the numbers that the cards make of them.
module loop_equations
   use kinds, only: wp
   use plane_vectors, only: wrap_angle, direction
   use disjoint_sets, only: sorted_t, sorted
   use mechanism, only: mechanism_t, pair_links, has_guide, drive_angle, drive_x, drive_y, drive_relangle, &
      drive_slide, plane_origin
   use spanning_tree, only: spanning_tree_t, axes_t, guide, other_link
   use vector_loops, only: search_t, find_path, vector_loops_t, &
      add_vector_loop, loop_sums_t, assign_sums, vanishes
   use matching, only: incidence_t
   implicit none
   private
   public :: equation_t, equations_t, new_equations, equation_numbers_t, new_equation_numbers, &
      assign_equation_numbers, &
      incidence, find_unknowns
   public :: equation_x, equation_y, equation_projection, equation_angle, equation_slide

   integer, parameter :: equation_x = 1           !< x of a vector loop
   integer, parameter :: equation_y = 2           !< y of a vector loop
   integer, parameter :: equation_projection = 3  !< projection of a vector loop on a direction that turns with a link
   integer, parameter :: equation_angle = 4       !< angle of an orientation, or of one less another
   integer, parameter :: equation_slide = 5       !< a slide of the tree


   !> An equation: the coordinate that `kind` names = a constant + value of the drive.
   type :: equation_t
      integer :: kind = equation_angle            !< equation_x, ...
      integer :: vector_loop = 0                  !< x, y and projection: the number of the loop; 0: none
      integer :: drive = 0                        !< the number of its drive; 0: a pair's equation
      integer :: pair = 0                         !< the number of its pair; 0: a drive's equation
      !> Projection: the orientation with which the direction turns; angle: the orientation; slide: the slide's number.
      integer :: orientation = 0
      integer :: less = 0                         !< angle: the orientation whose angle is subtracted; 0: none
   end type equation_t

   !> The equations of a mechanism.
   type :: equations_t
      integer :: count = 0                        !< how many there are
      type(equation_t), allocatable :: list(:)    !< (count), with room after them
      type(vector_loops_t) :: vector_loops        !< of the equations of kinds x, y and projection
      logical, allocatable :: has_vector(:)       !< (body vectors) it does not vanish
      logical, allocatable :: counts(:, :)        !< (2, slides) it is in x of its loop, or in the projection; in y
   end type equations_t

   !> The numbers of equations, lengths in units of `length`, angles in rad.
   type :: equation_numbers_t
      real(wp) :: length = 1.0_wp                 !< their unit of length, in the deck's unit
      type(axes_t) :: axes                        !< in the deck's unit of length
      type(loop_sums_t) :: sums                   !< body vectors and slides of their loops
      real(wp), allocatable :: direction(:, :)    !< (2, equations) projection: unit vector, in its orientation's axes
      real(wp), allocatable :: constant(:)        !< (equations)
   end type equation_numbers_t

contains

   !> Makes the equations of a mechanism on its tree: those of the pairs that close loops, then those of prismatic pairs
   !> that fix an angle again, then those of the drives. Without numbers: `has_vector` and `counts` are not allocated.
   function new_equations(m, tree) result(e)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`
      type(equations_t) :: e
      type(search_t) :: s
      type(sorted_t) :: closing
      integer :: depth(size(m%pairs)), most, i, k

      allocate (e%list(2*size(m%pairs) + size(m%drives) + size(tree%surplus)))
      most = size(m%pairs) + size(m%drives) + 1
      associate (p => e%vector_loops)
         allocate (p%first_vector(0:most), p%first_slide(0:most), p%first_term(0:most), source=1)
         allocate (p%vector_orientation(most), p%slide_orientation(most), p%slide_number(most), p%slide_pair(most), &
            p%terms(2, 4*most), p%term_vector(4*most))
         allocate (p%vector_of(0:tree%orientations), source=0)
      end associate
      allocate (s%open(size(m%pairs)), source=.false.)
      s%open(pack(tree%parent_joint, tree%parent_joint > 0)) = .true.
      allocate (s%via(0:2*size(m%links) + 1), s%seen(0:2*size(m%links) + 1), source=0)
      allocate (s%queue(0:size(m%links), 2), s%pairs(size(m%links) + 1))

      ! The pairs that are not in the tree, those near the ground first: each closes a loop.
      do k = 1, size(m%pairs)
         associate (links => pair_links(m, m%pairs(k)))
            depth(k) = merge(0, 1 + sum(tree%depth(links)), any(tree%parent_joint(links) == k))
         end associate
      end do
      closing = sorted(depth, 1 + 2*maxval(tree%depth))

      do i = 1, size(closing%member)
         k = closing%member(i)
         associate (p => m%pairs(k), n => e%vector_loops%count)
            call find_path(m, tree, m%points(p%point_i)%link, m%points(p%point_j)%link, s)
            call add_vector_loop(m, tree, p%point_i, p%point_j, s, e%vector_loops)
            if (.not. has_guide(p%kind)) then
               call add(equation_t(equation_x, vector_loop=n, pair=k))
               call add(equation_t(equation_y, vector_loop=n, pair=k))
               ! From now on paths can lead through this pair.
               s%open(k) = .true.
            else
               call add(equation_t(equation_projection, vector_loop=n, pair=k, &
                  orientation=tree%orientation(m%points(p%point_i)%link)))
            end if
         end associate
      end do

      do i = 1, size(tree%surplus)
         call add(equation_t(equation_angle, pair=tree%surplus(i)))
      end do
      do i = 1, size(m%drives)
         call add_drive(i)
      end do

   contains

      !> Adds the equation of a drive, and the vector loop that it needs.
      subroutine add_drive(k)
         integer, intent(in) :: k            !< the number of the drive
         integer :: link

         associate (i => m%drives(k)%subject, j => m%drives(k)%second, n => e%vector_loops%count)
            select case (m%drives(k)%kind)
            case (drive_angle)
               call add(equation_t(equation_angle, drive=k, orientation=tree%orientation(i)))
            case (drive_relangle)
               call add(equation_t(equation_angle, drive=k, orientation=tree%orientation(j), less=tree%orientation(i)))
            case (drive_x, drive_y)
               ! Down the tree to a ground link or a root.
               s%length = 0
               link = m%points(i)%link
               do while (tree%parent(link) > 0)
                  s%length = s%length + 1
                  s%pairs(s%length) = tree%parent_joint(link)
                  link = tree%parent(link)
               end do
               call add_vector_loop(m, tree, i, 0, s, e%vector_loops)
               call add(equation_t(merge(equation_x, equation_y, m%drives(k)%kind == drive_x), vector_loop=n, drive=k))

            case (drive_slide)
               if (tree%slide(i) > 0) then
                  call add(equation_t(equation_slide, drive=k, orientation=tree%slide(i)))
                  return
               end if
               associate (p => m%pairs(i)%point_i, q => m%pairs(i)%point_j)
                  call find_path(m, tree, m%points(p)%link, m%points(q)%link, s)
                  call add_vector_loop(m, tree, p, q, s, e%vector_loops)
                  call add(equation_t(equation_projection, vector_loop=n, drive=k, &
                     orientation=tree%orientation(m%points(p)%link)))
               end associate
            end select
         end associate
      end subroutine add_drive

      !> Appends an equation to the list.
      subroutine add(equation)
         type(equation_t), intent(in) :: equation   !< to be appended

         e%count = e%count + 1
         e%list(e%count) = equation
      end subroutine add
   end function new_equations

   !> Makes the numbers of equations from the numbers of a mechanism.
   function new_equation_numbers(m, tree, length, equations) result(x)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`
      real(wp), intent(in) :: length         !< unit of length of the equations, in the deck's unit
      type(equations_t), intent(inout) :: equations   !< by `new_equations`; `has_vector` and `counts` are found
      type(equation_numbers_t) :: x

      associate (p => equations%vector_loops)
         allocate (x%axes%angle_offset(size(m%links)), x%axes%turn(2, size(m%links)))
         allocate (x%sums%body_vector(2, p%vectors), x%sums%largest(p%vectors), x%sums%slide_body_vector(2, p%slides))
         allocate (x%direction(2, equations%count), x%constant(equations%count), source=0.0_wp)
         call assign_equation_numbers(m, tree, length, equations, x)
         allocate (equations%has_vector(p%vectors), equations%counts(2, p%slides))
      end associate
      call find_unknowns(equations, x, equations%has_vector, equations%counts)
   end function new_equation_numbers

   !> Fills the numbers of equations from the numbers of a mechanism.
   subroutine assign_equation_numbers(m, tree, length, equations, numbers)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`, or of a mechanism of equal structure
      real(wp), intent(in) :: length         !< unit of length of the equations, in the deck's unit
      type(equations_t), intent(in) :: equations   !< on this tree
      type(equation_numbers_t), intent(inout) :: numbers   !< its lists are allocated
      integer :: i

      numbers%length = length
      call assign_axes(m, tree, numbers%axes)
      call assign_sums(m, tree, numbers%axes, length, equations%vector_loops, numbers%sums)
      do i = 1, equations%count
         associate (q => equations%list(i), angle => numbers%axes%angle_offset, across => equations%list(i)%kind == &
            equation_projection)

            if (q%pair > 0) then
               associate (pair => m%pairs(q%pair))
                  ! The angle by which beta of the pair differs from the angle between its links that other prismatic
                  ! pairs give, without whole turns.
                  if (across) numbers%direction(:, i) = guide(m, numbers%axes, q%pair, across=.true.)
                  if (across) numbers%constant(i) = pair%offset/length
                  if (q%kind == equation_angle) numbers%constant(i) = wrap_angle(pair%beta &
                     + angle(m%points(pair%point_i)%link) - angle(m%points(pair%point_j)%link))
               end associate

            else
               associate (drive => m%drives(q%drive))
                  select case (drive%kind)
                  case (drive_angle)
                     numbers%constant(i) = -angle(drive%subject)
                  case (drive_relangle)
                     numbers%constant(i) = angle(drive%subject) - angle(drive%second)
                  case (drive_x)
                     numbers%constant(i) = -numbers%axes%origin(1)/length
                  case (drive_y)
                     numbers%constant(i) = -numbers%axes%origin(2)/length
                  case default
                     if (across) numbers%direction(:, i) = -guide(m, numbers%axes, drive%subject, across=.false.)
                  end select
               end associate
            end if
         end associate
      end do
   end subroutine assign_equation_numbers

   !> Finds which body vectors and slides are in equations with given numbers. A slide is not in an equation if in every
   !> position it is at right angles to the direction of the equation: their cosine is within 8 units of rounding.
   pure subroutine find_unknowns(equations, numbers, has_vector, counts)
      type(equations_t), intent(in) :: equations   !< of a mechanism
      type(equation_numbers_t), intent(in) :: numbers   !< of the equations
      logical, intent(out) :: has_vector(:)  !< (body vectors) as in `equations_t`
      logical, intent(out) :: counts(:, :)   !< (2, slides) as in `equations_t`
      real(wp) :: axis(2)
      integer :: i, k

      has_vector = .true.
      counts = .false.
      do i = 1, equations%count
         associate (q => equations%list(i), p => equations%vector_loops)
            do k = p%first_vector(q%vector_loop), p%first_vector(q%vector_loop + 1) - 1
               ! A fixed vector brings no unknown, unless the direction of a projection turns.
               if (p%vector_orientation(k) > 0 .or. (q%kind == equation_projection .and. q%orientation > 0)) &
                  has_vector(k) = .not. vanishes(numbers%sums, k)
            end do
            axis = numbers%direction(:, i)
            if (q%kind == equation_x) axis = [1.0_wp, 0.0_wp]
            if (q%kind == equation_y) axis = [0.0_wp, 1.0_wp]
            do k = p%first_slide(q%vector_loop), p%first_slide(q%vector_loop + 1) - 1
               counts(side_of(q), k) = p%slide_orientation(k) /= q%orientation &
                  .or. abs(dot_product(axis, numbers%sums%slide_body_vector(:, k))) > 8.0_wp*epsilon(1.0_wp)
            end do
         end associate
      end do
   end subroutine find_unknowns

   !> Gives the row of `counts` that belongs to an equation: 2 for the y of a loop, otherwise 1.
   pure integer function side_of(equation)
      type(equation_t), intent(in) :: equation   !< of kind x, y or projection

      side_of = merge(2, 1, equation%kind == equation_y)
   end function side_of

   !> Lists the unknowns of each equation.
   function incidence(equations, orientations, unknowns) result(g)
      type(equations_t), intent(in) :: equations   !< with `has_vector` and `counts`
      integer, intent(in) :: orientations    !< how many angles are unknown: unknowns 1 to `orientations`
      integer, intent(in) :: unknowns        !< how many unknowns there are: angles, then slides
      type(incidence_t) :: g
      integer :: seen(0:unknowns), constant, n, i, k
      logical :: turns

      g%equations = equations%count
      g%unknowns = unknowns
      allocate (g%first(equations%count + 1), g%unknown(4*equations%count + 64))
      g%first(1) = 1
      seen = 0
      n = 0
      do i = 1, equations%count
         associate (q => equations%list(i), p => equations%vector_loops)
            select case (q%kind)
            case (equation_angle)
               ! The angles of two links that turn together cancel.
               if (q%orientation /= q%less) then
                  call add_unknown(q%orientation)
                  call add_unknown(q%less)
               end if
            case (equation_slide)
               call add_unknown(orientations + q%orientation)

            case default
               associate (v => p%first_vector(q%vector_loop), w => p%first_vector(q%vector_loop + 1) - 1, &
                  s => p%first_slide(q%vector_loop), t => p%first_slide(q%vector_loop + 1) - 1)
                  turns = any(equations%has_vector(v:w) .and. p%vector_orientation(v:w) /= q%orientation) &
                     .or. any(p%slide_orientation(s:t) /= q%orientation)
                  ! A vector that turns with the direction of the projection has a constant projection.
                  constant = merge(q%orientation, 0, q%kind == equation_projection .and. .not. turns)

                  do k = v, w
                     if (equations%has_vector(k) .and. p%vector_orientation(k) /= &
                        constant) call add_unknown(p%vector_orientation(k))
                  end do
                  do k = s, t
                     if (p%slide_orientation(k) /= constant) call add_unknown(p%slide_orientation(k))
                     if (equations%counts(side_of(q), k)) call add_unknown(orientations + p%slide_number(k))
                  end do
                  if (q%kind == equation_projection .and. turns) call add_unknown(q%orientation)
               end associate
            end select
         end associate
         g%first(i + 1) = n + 1
      end do

   contains

      !> Adds an unknown to equation `i`, once. The angle of the ground's orientation is no unknown.
      subroutine add_unknown(unknown)
         integer, intent(in) :: unknown      !< its number; 0: the ground

         if (unknown == 0) return
         if (seen(unknown) == i) return
         seen(unknown) = i
         n = n + 1
         if (n > size(g%unknown)) g%unknown = [g%unknown, g%unknown]
         g%unknown(n) = unknown
      end subroutine add_unknown
   end function incidence

   !> Fills the axes of links from the numbers of a mechanism.
   pure subroutine assign_axes(m, tree, axes)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`, or of a mechanism of equal structure
      type(axes_t), intent(inout) :: axes    !< its lists are allocated
      integer :: i, k, link

      axes%origin = plane_origin(m)
      do i = 1, size(tree%by_angle)
         link = tree%by_angle(i)
         k = tree%angle_pair(link)
         axes%angle_offset(link) = 0.0_wp
         if (m%links(link)%ground) axes%angle_offset(link) = m%links(link)%position(3)
         if (k > 0) axes%angle_offset(link) = axes%angle_offset(other_link(m, k, link)) &
            + merge(-m%pairs(k)%beta, m%pairs(k)%beta, m%points(m%pairs(k)%point_i)%link == link)
         axes%turn(:, link) = direction(axes%angle_offset(link))
      end do
   end subroutine assign_axes
end module loop_equations
