!> The equations that the tree leaves over, and those of the drives: each gives a component of a vector loop, its
!> projection on a direction that turns with an orientation, an angle or a slide. A revolute pair asks both components
!> to be zero, a prismatic pair that the projection on the guide's normal is h; a drive X or Y gives one component of
!> its point, a drive SLIDE the projection along the guide.
module loop_equations
   use kinds, only: wp
   use planar, only: without_turns
   use grouping, only: sorted_t, sorted
   use mechanism, only: mechanism_t, pair_links, pair_revolute, drive_angle, drive_x, drive_y, drive_relangle, &
      drive_slide
   use links_tree, only: tree_t, guide
   use vector_loops, only: search_t, new_search, find_path, find_path_down, close_pair, vector_loops_t, &
      new_vector_loops, add_vector_loop
   use matching, only: incidence_t
   implicit none
   private
   public :: equation_t, equations_t, new_equations, incidence
   public :: equation_x, equation_y, equation_projection, equation_angle, equation_slide

   integer, parameter :: equation_x = 1           !< x of a vector loop
   integer, parameter :: equation_y = 2           !< y of a vector loop
   integer, parameter :: equation_projection = 3  !< projection of a vector loop on a direction that turns with a link
   integer, parameter :: equation_angle = 4       !< angle of an orientation, or of one less another
   integer, parameter :: equation_slide = 5       !< a slide

   !> What `kind` says = `constant` + value of the drive.
   type :: equation_t
      integer :: kind = equation_angle
      integer :: vector_loop = 0
      integer :: drive = 0                        !< 0: a pair's equation
      integer :: pair = 0                         !< 0: a drive's equation
      integer :: orientation = 0                  !< projection and angle; slide: the slide's number
      integer :: less = 0                         !< angle: the orientation whose angle is subtracted; 0: none
      real(wp) :: direction(2) = 0.0_wp           !< projection: in the axes of the orientation
      real(wp) :: constant = 0.0_wp
   end type equation_t

   type :: equations_t
      integer :: count = 0
      type(equation_t), allocatable :: list(:)    !< (count), with room behind
      type(vector_loops_t) :: vector_loops
   end type equations_t

contains

   !> The equations of `m` on its tree `t`, lengths in units of `length`.
   function new_equations(m, t, length) result(e)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
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
         call close_pair(m, pairs(i), s)
      end do
      do i = 1, size(t%surplus)
         call add(equation_t(equation_angle, pair=t%surplus(i), constant=misfit(t%surplus(i))))
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
            call add_vector_loop(m, t, length, p%point_i, p%point_j, s, e%vector_loops)
            if (p%kind == pair_revolute) then
               call add(equation_t(equation_x, vector_loop=n, pair=k))
               call add(equation_t(equation_y, vector_loop=n, pair=k))
            else
               call add(equation_t(equation_projection, vector_loop=n, pair=k, &
                  orientation=t%orientation(m%points(p%point_i)%link), direction=guide(m, t, k, across=.true.), &
                  constant=p%offset/length))
            end if
         end associate
      end subroutine add_pair

      !> The equation of drive `k`.
      subroutine add_drive(k)
         integer, intent(in) :: k
         integer :: axis

         associate (i => m%drives(k)%subject, j => m%drives(k)%second, n => e%vector_loops%count)
            select case (m%drives(k)%kind)
            case (drive_angle)
               call add(equation_t(equation_angle, drive=k, orientation=t%orientation(i), constant=-t%angle_offset(i)))
            case (drive_relangle)
               call add(equation_t(equation_angle, drive=k, orientation=t%orientation(j), less=t%orientation(i), &
                  constant=t%angle_offset(i) - t%angle_offset(j)))
            case (drive_x, drive_y)
               call find_path_down(t, m%points(i)%link, s)
               call add_vector_loop(m, t, length, i, 0, s, e%vector_loops)
               axis = merge(1, 2, m%drives(k)%kind == drive_x)
               call add(equation_t(merge(equation_x, equation_y, axis == 1), vector_loop=n, drive=k, &
                  constant=-t%origin(axis)/length))
            case (drive_slide)
               if (t%slide(i) > 0) then
                  call add(equation_t(equation_slide, drive=k, orientation=t%slide(i)))
                  return
               end if
               associate (p => m%pairs(i)%point_i, q => m%pairs(i)%point_j)
                  call find_path(m, t, m%points(p)%link, m%points(q)%link, s)
                  call add_vector_loop(m, t, length, p, q, s, e%vector_loops)
                  call add(equation_t(equation_projection, vector_loop=n, drive=k, &
                     orientation=t%orientation(m%points(p)%link), direction=-guide(m, t, i, across=.false.)))
               end associate
            end select
         end associate
      end subroutine add_drive

      !> By how much prismatic pair `k` differs from the angle that other prismatic pairs give its links; whole turns
      !> are no difference.
      pure real(wp) function misfit(k)
         integer, intent(in) :: k

         associate (pair => m%pairs(k))
            misfit = without_turns(pair%beta + t%angle_offset(m%points(pair%point_i)%link) &
               - t%angle_offset(m%points(pair%point_j)%link))
         end associate
      end function misfit

      !> Appends `equation` to `e`.
      subroutine add(equation)
         type(equation_t), intent(in) :: equation

         e%count = e%count + 1
         e%list(e%count) = equation
      end subroutine add
   end function new_equations

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

         associate (p => e%vector_loops)
            do k = p%first_vector(q%vector_loop), p%first_vector(q%vector_loop + 1) - 1
               call note(p%vector_orientation(k))
            end do
            do k = p%first_slide(q%vector_loop), p%first_slide(q%vector_loop + 1) - 1
               call note(p%slide_orientation(k))
               if (has_slide(q, p%slide_orientation(k), p%slide_body_vector(:, k))) call note(orientations &
                  + p%slide_number(k))
            end do
            ! What turns with the direction of the projection has a constant part in it.
            if (q%kind /= equation_projection) return
            if (any(p%vector_orientation(p%first_vector(q%vector_loop):p%first_vector(q%vector_loop + 1) - 1) &
               /= q%orientation) .or. &
               any(p%slide_orientation(p%first_slide(q%vector_loop):p%first_slide(q%vector_loop + 1) - 1) &
               /= q%orientation)) then
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

   !> A slide at right angles to what is asked for, in whatever position, is no part of the equation.
   pure logical function has_slide(q, orientation, body_vector)
      type(equation_t), intent(in) :: q
      integer, intent(in) :: orientation
      real(wp), intent(in) :: body_vector(2)
      real(wp) :: asked(2)

      has_slide = .true.
      asked = q%direction
      if (q%kind == equation_x) asked = [1.0_wp, 0.0_wp]
      if (q%kind == equation_y) asked = [0.0_wp, 1.0_wp]
      if (orientation == q%orientation) has_slide = abs(dot_product(asked, body_vector)) > 8.0_wp*epsilon(1.0_wp)
   end function has_slide
end module loop_equations
