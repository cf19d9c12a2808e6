!> Which coordinate stands in which closure equation, all coordinates of all moving links taken: what there is
!> to say of a mechanism's structure does not hang on how it will be solved.
!>
!> Unknowns: x, y, phi of moving link k are 3 k' - 2, 3 k' - 1, 3 k', k' its number among the moving links.
module closure_incidence
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_revolute, drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use matching, only: incidence_t
   implicit none
   private
   public :: closure_t, new_closure

   !> Equation e belongs to pair(e) or, where that is 0, to drive(e).
   type :: closure_t
      type(incidence_t) :: incidence
      integer, allocatable :: link_of(:)             !< (unknowns)
      integer, allocatable :: pair(:), drive(:)      !< (equations)
   end type closure_t

   real(wp), parameter :: rounding = 8.0_wp*epsilon(1.0_wp)
   real(wp), parameter :: along(2, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])

contains

   !> The incidence of `m`: time and memory proportional to links, pairs and drives.
   function new_closure(m) result(c)
      type(mechanism_t), intent(in) :: m
      type(closure_t) :: c
      integer :: moving(size(m%links)), n, i, k

      call number_links(m, moving, c)
      associate (equations => 2*size(m%pairs) + size(m%drives))
         allocate (c%incidence%first(equations + 1), c%incidence%unknown(6*equations))
         allocate (c%pair(equations), c%drive(equations), source=0)
         c%incidence%equations = equations
      end associate
      c%incidence%first(1) = 1
      n = 0
      k = 0
      do i = 1, size(m%pairs)
         associate (p => m%pairs(i)%point_i, q => m%pairs(i)%point_j)
            if (m%pairs(i)%kind == pair_revolute) then
               call note_component(p, along(:, 1))
               call note_component(q, along(:, 1))
               call close_equation(i, 0)
               call note_component(p, along(:, 2))
               call note_component(q, along(:, 2))
            else
               call note_angle(m%points(p)%link)
               call note_angle(m%points(q)%link)
               call close_equation(i, 0)
               call note_projection(i, across=.true.)
            end if
            call close_equation(i, 0)
         end associate
      end do
      do i = 1, size(m%drives)
         associate (subject => m%drives(i)%subject)
            select case (m%drives(i)%kind)
            case (drive_angle)
               call note_angle(subject)
            case (drive_relangle)
               call note_angle(subject)
               call note_angle(m%drives(i)%second)
            case (drive_x)
               call note_component(subject, along(:, 1))
            case (drive_y)
               call note_component(subject, along(:, 2))
            case (drive_slide)
               call note_projection(subject, across=.false.)
            end select
         end associate
         call close_equation(0, i)
      end do

   contains

      subroutine note(link, coordinate)
         integer, intent(in) :: link, coordinate

         if (moving(link) == 0) return
         n = n + 1
         c%incidence%unknown(n) = 3*moving(link) - 3 + coordinate
      end subroutine note

      subroutine note_angle(link)
         integer, intent(in) :: link

         call note(link, 3)
      end subroutine note_angle

      !> The component of point `p` along the fixed direction `e`.
      subroutine note_component(p, e)
         integer, intent(in) :: p
         real(wp), intent(in) :: e(2)

         if (abs(e(1)) > rounding) call note(m%points(p)%link, 1)
         if (abs(e(2)) > rounding) call note(m%points(p)%link, 2)
         if (any(abs(m%points(p)%offset) > 0.0_wp)) call note(m%points(p)%link, 3)
      end subroutine note_component

      !> The projection of prismatic pair `i` across its guide or along it.
      subroutine note_projection(i, across)
         integer, intent(in) :: i
         logical, intent(in) :: across
         real(wp) :: angle

         associate (p => m%pairs(i)%point_i, q => m%pairs(i)%point_j)
            if (m%links(m%points(p)%link)%ground) then
               angle = m%links(m%points(p)%link)%position(3) + m%pairs(i)%alpha
               if (across) call note_component(q, [-sin(angle), cos(angle)])
               if (.not. across) call note_component(q, [cos(angle), sin(angle)])
            else
               call note(m%points(p)%link, 1)
               call note(m%points(p)%link, 2)
               call note(m%points(p)%link, 3)
               call note_component(q, [1.0_wp, 1.0_wp])
            end if
         end associate
      end subroutine note_projection

      subroutine close_equation(pair, drive)
         integer, intent(in) :: pair, drive

         k = k + 1
         c%pair(k) = pair
         c%drive(k) = drive
         c%incidence%first(k + 1) = n + 1
      end subroutine close_equation
   end function new_closure

   !> `moving` (links): number among the moving links, 0 for ground links.
   subroutine number_links(m, moving, c)
      type(mechanism_t), intent(in) :: m
      integer, intent(out) :: moving(:)
      type(closure_t), intent(inout) :: c
      integer :: i, n

      n = 0
      moving = 0
      allocate (c%link_of(3*count(.not. m%links%ground)))
      do i = 1, size(m%links)
         if (m%links(i)%ground) cycle
         n = n + 1
         moving(i) = n
         c%link_of(3*n - 2:3*n) = i
      end do
      c%incidence%unknowns = 3*n
   end subroutine number_links
end module closure_incidence
