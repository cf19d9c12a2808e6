!> The equations that the tree leaves over, and those of the drives: each gives a component of a vector loop, its
!> projection on a direction that turns with an orientation, an angle or a slide. A revolute pair asks both components
!> to be zero, a prismatic pair that the projection on the guide's normal is h; a drive X or Y gives one component of
!> its point, a drive SLIDE the projection along the guide.
!>
!> Equations are integers; `equation_numbers_t` holds what the numbers of the cards make of them.
module loop_equations
   use kinds, only: wp
   use planar, only: without_turns
   use grouping, only: sorted_t, sorted
   use mechanism, only: mechanism_t, pair_t, pair_links, pair_revolute, drive_angle, drive_x, drive_y, drive_relangle, &
      drive_slide
   use links_tree, only: tree_t, axes_t, put_axes, guide
   use vector_loops, only: search_t, new_search, find_path, find_path_down, vector_loops_t, &
      new_vector_loops, add_vector_loop, loop_sums_t, put_sums, vanishes
   use matching, only: incidence_t
   implicit none
   private
   public :: equation_t, equations_t, new_equations, equation_numbers_t, new_equation_numbers, put_equation_numbers, &
      incidence, fit_equations, are_alike
   public :: equation_x, equation_y, equation_projection, equation_angle, equation_slide

   integer, parameter :: equation_x = 1           !< x of a vector loop
   integer, parameter :: equation_y = 2           !< y of a vector loop
   integer, parameter :: equation_projection = 3  !< projection of a vector loop on a direction that turns with a link
   integer, parameter :: equation_angle = 4       !< angle of an orientation, or of one less another
   integer, parameter :: equation_slide = 5       !< a slide

   !> What `kind` says = a constant + value of the drive.
   type :: equation_t
      integer :: kind = equation_angle
      integer :: vector_loop = 0
      integer :: drive = 0                        !< 0: a pair's equation
      integer :: pair = 0                         !< 0: a drive's equation
      integer :: orientation = 0                  !< projection and angle; slide: the slide's number
      integer :: less = 0                         !< angle: the orientation whose angle is subtracted; 0: none
   end type equation_t

   type :: equations_t
      integer :: count = 0
      type(equation_t), allocatable :: list(:)    !< (count), with room behind
      type(vector_loops_t) :: vector_loops
      logical, allocatable :: has_vector(:)       !< (body vectors) it does not vanish
      logical, allocatable :: counts(:, :)        !< (2, slides) in x of its loop, or in the projection; in y
   end type equations_t

   !> The numbers of equations, lengths in units of `length`.
   type :: equation_numbers_t
      real(wp) :: length = 1.0_wp
      type(axes_t) :: axes
      type(loop_sums_t) :: sums
      real(wp), allocatable :: direction(:, :)    !< (2, equations) projection: in the axes of the orientation
      real(wp), allocatable :: constant(:)        !< (equations)
   end type equation_numbers_t

contains

   !> The equations of `m` on its tree `t`.
   function new_equations(m, t) result(e)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(equations_t) :: e
      type(search_t) :: s
      integer, allocatable :: pairs(:)
      integer :: i

      allocate (e%list(2*size(m%pairs) + size(m%drives) + size(t%surplus)))
      e%vector_loops = new_vector_loops(m, t)
      s = new_search(m, t)
      pairs = closing_pairs()
      do i = 1, size(pairs)
         call add_pair(pairs(i))
         ! From now on paths lead through it.
         s%open(pairs(i)) = m%pairs(pairs(i))%kind == pair_revolute
      end do
      do i = 1, size(t%surplus)
         call add(equation_t(equation_angle, pair=t%surplus(i)))
      end do
      do i = 1, size(m%drives)
         call add_drive(i)
      end do

   contains

      !> The pairs that are not in the tree, those near the ground first.
      function closing_pairs() result(pairs)
         integer, allocatable :: pairs(:)
         type(sorted_t) :: s
         integer :: depth(size(m%pairs)), links(2), k

         do k = 1, size(m%pairs)
            links = pair_links(m, m%pairs(k))
            ! Those of the tree are left out.
            depth(k) = merge(0, 1 + sum(t%depth(links)), any(t%parent_joint(links) == k))
         end do
         s = sorted(depth, 1 + 2*maxval(t%depth))
         pairs = s%member
      end function closing_pairs

      !> The equations of pair `k`, which closes a loop.
      subroutine add_pair(k)
         integer, intent(in) :: k

         associate (p => m%pairs(k), n => e%vector_loops%count)
            call find_path(m, t, m%points(p%point_i)%link, m%points(p%point_j)%link, s)
            call add_vector_loop(m, t, p%point_i, p%point_j, s, e%vector_loops)
            if (p%kind == pair_revolute) then
               call add(equation_t(equation_x, vector_loop=n, pair=k))
               call add(equation_t(equation_y, vector_loop=n, pair=k))
            else
               call add(equation_t(equation_projection, vector_loop=n, pair=k, &
                  orientation=t%orientation(m%points(p%point_i)%link)))
            end if
         end associate
      end subroutine add_pair

      !> The equation of drive `k`.
      subroutine add_drive(k)
         integer, intent(in) :: k
         associate (i => m%drives(k)%subject, j => m%drives(k)%second, n => e%vector_loops%count)
            select case (m%drives(k)%kind)
            case (drive_angle)
               call add(equation_t(equation_angle, drive=k, orientation=t%orientation(i)))
            case (drive_relangle)
               call add(equation_t(equation_angle, drive=k, orientation=t%orientation(j), less=t%orientation(i)))
            case (drive_x, drive_y)
               call find_path_down(t, m%points(i)%link, s)
               call add_vector_loop(m, t, i, 0, s, e%vector_loops)
               call add(equation_t(merge(equation_x, equation_y, m%drives(k)%kind == drive_x), vector_loop=n, drive=k))
            case (drive_slide)
               if (t%slide(i) > 0) then
                  call add(equation_t(equation_slide, drive=k, orientation=t%slide(i)))
                  return
               end if
               associate (p => m%pairs(i)%point_i, q => m%pairs(i)%point_j)
                  call find_path(m, t, m%points(p)%link, m%points(q)%link, s)
                  call add_vector_loop(m, t, p, q, s, e%vector_loops)
                  call add(equation_t(equation_projection, vector_loop=n, drive=k, &
                     orientation=t%orientation(m%points(p)%link)))
               end associate
            end select
         end associate
      end subroutine add_drive

      !> Appends `equation` to `e`.
      subroutine add(equation)
         type(equation_t), intent(in) :: equation

         e%count = e%count + 1
         e%list(e%count) = equation
      end subroutine add
   end function new_equations

   !> The numbers of `m` in its equations `e`, which are told what of their vectors vanishes.
   function new_equation_numbers(m, t, length, e) result(x)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      type(equations_t), intent(inout) :: e
      type(equation_numbers_t) :: x
      integer :: i, k

      associate (p => e%vector_loops)
         allocate (x%axes%angle_offset(size(m%links)), x%axes%turn(2, size(m%links)))
         allocate (x%sums%body_vector(2, p%vectors), x%sums%largest(p%vectors), x%sums%slide_body_vector(2, p%slides))
         allocate (x%direction(2, e%count), x%constant(e%count), source=0.0_wp)
         call put_equation_numbers(m, t, length, e, x)
         e%has_vector = [(.not. vanishes(x%sums, k), k=1, p%vectors)]
         allocate (e%counts(2, p%slides), source=.false.)
      end associate
      do k = 1, e%count
         associate (q => e%list(k), p => e%vector_loops)
            do i = p%first_slide(q%vector_loop), p%first_slide(q%vector_loop + 1) - 1
               e%counts(side_of(q), i) = has_slide(q, x, k, p%slide_orientation(i), i)
            end do
         end associate
      end do
   end function new_equation_numbers

   !> Gives the numbers `x` of the equations `e` those of `m`, whose tree is `t`.
   subroutine put_equation_numbers(m, t, length, e, x)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      type(equations_t), intent(in) :: e
      type(equation_numbers_t), intent(inout) :: x
      integer :: i

      x%length = length
      call put_axes(m, t, x%axes)
      call put_sums(m, t, x%axes, length, e%vector_loops, x%sums)
      do i = 1, e%count
         if (e%list(i)%pair > 0) call put_pair(m%pairs(e%list(i)%pair), e%list(i), i)
         if (e%list(i)%drive > 0) call put_drive(e%list(i), i)
      end do

   contains

      !> The numbers of equation `q`, number `k`, of the `pair`. An angle is that by which the pair differs from the
      !> angle that other prismatic pairs give its links; whole turns are no difference.
      subroutine put_pair(pair, q, k)
         type(pair_t), intent(in) :: pair
         type(equation_t), intent(in) :: q
         integer, intent(in) :: k

         if (q%kind == equation_projection) then
            x%direction(:, k) = guide(m, x%axes, q%pair, across=.true.)
            x%constant(k) = pair%offset/length
         else if (q%kind == equation_angle) then
            x%constant(k) = without_turns(pair%beta + x%axes%angle_offset(m%points(pair%point_i)%link) &
               - x%axes%angle_offset(m%points(pair%point_j)%link))
         end if
      end subroutine put_pair

      !> The numbers of equation `q`, number `k`, of a drive.
      subroutine put_drive(q, k)
         type(equation_t), intent(in) :: q
         integer, intent(in) :: k

         associate (i => m%drives(q%drive)%subject, j => m%drives(q%drive)%second, angle => x%axes%angle_offset)
            select case (m%drives(q%drive)%kind)
            case (drive_angle)
               x%constant(k) = -angle(i)
            case (drive_relangle)
               x%constant(k) = angle(i) - angle(j)
            case (drive_x)
               x%constant(k) = -x%axes%origin(1)/length
            case (drive_y)
               x%constant(k) = -x%axes%origin(2)/length
            case default
               if (q%kind == equation_projection) x%direction(:, k) = -guide(m, x%axes, i, across=.false.)
            end select
         end associate
      end subroutine put_drive
   end subroutine put_equation_numbers

   !> Whether each of the equations `e` has the unknowns, and each loop the body vectors, with the numbers `x` that it
   !> has with those of which `e` was made.
   pure logical function fit_equations(e, x) result(fits)
      type(equations_t), intent(in) :: e
      type(equation_numbers_t), intent(in) :: x
      integer :: i, k

      fits = .true.
      associate (p => e%vector_loops)
         do i = 1, e%count
            associate (q => e%list(i))
               do k = p%first_vector(q%vector_loop), p%first_vector(q%vector_loop + 1) - 1
                  ! What is fixed makes no unknown; but what turns with a projection.
                  if (p%vector_orientation(k) == 0 .and. .not. (q%kind == equation_projection &
                     .and. q%orientation > 0)) cycle
                  fits = fits .and. (vanishes(x%sums, k) .neqv. e%has_vector(k))
               end do
               do k = p%first_slide(q%vector_loop), p%first_slide(q%vector_loop + 1) - 1
                  fits = fits .and. (has_slide(q, x, i, p%slide_orientation(k), k) .eqv. e%counts(side_of(q), k))
               end do
            end associate
         end do
      end associate
   end function fit_equations

   !> Whether `a` and `b` have the same unknowns in the same equations, in the same order: then blocks that are made of
   !> them differ in their numbers alone.
   pure logical function are_alike(a, b)
      type(equations_t), intent(in) :: a, b
      integer :: i

      associate (p => a%vector_loops, q => b%vector_loops)
         are_alike = all([a%count, p%count, p%vectors, p%slides] == [b%count, q%count, q%vectors, q%slides])
         if (.not. are_alike) return
         are_alike = all(p%first_vector(:p%count + 1) == q%first_vector(:q%count + 1)) &
            .and. all(p%first_slide(:p%count + 1) == q%first_slide(:q%count + 1)) &
            .and. all(p%vector_orientation(:p%vectors) == q%vector_orientation(:q%vectors)) &
            .and. all(p%slide_orientation(:p%slides) == q%slide_orientation(:q%slides)) &
            .and. all(p%slide_number(:p%slides) == q%slide_number(:q%slides)) &
            .and. all(a%has_vector .eqv. b%has_vector) .and. all(a%counts .eqv. b%counts)
      end associate
      do i = 1, a%count
         associate (p => a%list(i), q => b%list(i))
            are_alike = are_alike .and. all([p%kind, p%vector_loop, p%drive, p%orientation, p%less] &
               == [q%kind, q%vector_loop, q%drive, q%orientation, q%less])
         end associate
      end do
   end function are_alike

   !> 2 of the y of a loop, otherwise 1.
   pure integer function side_of(q)
      type(equation_t), intent(in) :: q

      side_of = merge(2, 1, q%kind == equation_y)
   end function side_of

   !> Which unknown is in which equation: 1 to `orientations` angles, then slides.
   function incidence(e, orientations, unknowns) result(g)
      type(equations_t), intent(in) :: e
      integer, intent(in) :: orientations, unknowns
      type(incidence_t) :: g
      integer :: seen(0:unknowns), n, i

      g%equations = e%count
      g%unknowns = unknowns
      allocate (g%first(e%count + 1), g%unknown(4*e%count + 64))
      g%first(1) = 1
      seen = 0
      n = 0
      do i = 1, e%count
         associate (q => e%list(i))
            select case (q%kind)
            case (equation_angle)
               ! Two links that turn together: their angles cancel.
               if (q%orientation /= q%less) then
                  call note(q%orientation)
                  call note(q%less)
               end if
            case (equation_slide)
               call note(orientations + q%orientation)
            case default
               call note_vector_loop(q)
            end select
         end associate
         g%first(i + 1) = n + 1
      end do

   contains

      !> Notes the unknowns of the vector loop of equation `q`.
      subroutine note_vector_loop(q)
         type(equation_t), intent(in) :: q
         integer :: k
         logical :: turns

         associate (p => e%vector_loops)
            turns = .false.
            do k = p%first_vector(q%vector_loop), p%first_vector(q%vector_loop + 1) - 1
               if (.not. e%has_vector(k)) cycle
               call note(p%vector_orientation(k))
               turns = turns .or. p%vector_orientation(k) /= q%orientation
            end do
            do k = p%first_slide(q%vector_loop), p%first_slide(q%vector_loop + 1) - 1
               call note(p%slide_orientation(k))
               if (e%counts(side_of(q), k)) call note(orientations + p%slide_number(k))
               turns = turns .or. p%slide_orientation(k) /= q%orientation
            end do
            ! What turns with the direction of the projection has a constant part in it.
            if (q%kind /= equation_projection) return
            if (turns) then
               call note(q%orientation)
            else if (seen(q%orientation) == i) then
               call forget(q%orientation)
            end if
         end associate
      end subroutine note_vector_loop

      !> Takes back unknown `u` of the equation at hand.
      subroutine forget(u)
         integer, intent(in) :: u
         integer :: kept

         kept = g%first(i) - 1 + count(g%unknown(g%first(i):n) /= u)
         g%unknown(g%first(i):kept) = pack(g%unknown(g%first(i):n), g%unknown(g%first(i):n) /= u)
         n = kept
      end subroutine forget

      !> Notes unknown `u`, once; the ground's orientation is none.
      subroutine note(u)
         integer, intent(in) :: u

         if (u == 0) return
         if (seen(u) == i) return
         seen(u) = i
         n = n + 1
         if (n > size(g%unknown)) g%unknown = [g%unknown, g%unknown]
         g%unknown(n) = u
      end subroutine note
   end function incidence

   !> Whether slide number `i`, along a guide of `orientation`, is in equation `q`, number `k`: not if it is at right
   !> angles to what is asked for, in whatever position.
   pure logical function has_slide(q, x, k, orientation, i)
      type(equation_t), intent(in) :: q
      type(equation_numbers_t), intent(in) :: x
      integer, intent(in) :: k, orientation, i
      real(wp) :: asked(2)

      has_slide = .true.
      if (orientation /= q%orientation) return
      asked = x%direction(:, k)
      if (q%kind == equation_x) asked = [1.0_wp, 0.0_wp]
      if (q%kind == equation_y) asked = [0.0_wp, 1.0_wp]
      has_slide = abs(dot_product(asked, x%sums%slide_body_vector(:, i))) > 8.0_wp*epsilon(1.0_wp)
   end function has_slide
end module loop_equations
