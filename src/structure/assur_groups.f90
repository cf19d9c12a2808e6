!> The incidence of the closure equations with all coordinates of all moving links, and the Assur groups that follow:
!> the least sets of links that can be found one after another, with the drives that move them. Each coordinate is
!> matched with a closure equation; a link waits for all links whose coordinates are in the equations of its
!> coordinates, and links that wait for one another are a group.
!>
!> Unknowns: x, y, phi of moving link k are 3 k' - 2, 3 k' - 1, 3 k', k' its number among the moving links.
!>
!> Order: a group after those it builds on, within one depth by the deck's links. So groups and order are the
!> mechanism's own, whatever the matching and however it is solved.
!>
!> Rejected: groups read off the blocks that are solved. The tree has removed coordinates from these: a piston that a
!> drive moves along its guide is joined to its rod there, and would be in one group with rod and crank.
module assur_groups
   use kinds, only: wp
   use disjoint_sets, only: sorted_t, sorted, members
   use mechanism, only: mechanism_t, has_guide, drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use matching, only: incidence_t, match, overdetermined, find_blocks
   implicit none
   private
   public :: closure_incidence_t, new_closure, group_t, groups_of

   !> The closure equations: two of each pair, in the order of the pairs, and then one of each drive.
   type :: closure_incidence_t
      type(incidence_t) :: incidence                 !< which coordinate is in which equation
      integer, allocatable :: link_of(:)             !< (unknowns) the number of the link whose coordinate it is
   end type closure_incidence_t

   !> A component of a unit vector below this is zero: sine and cosine of a sum of two angles are rounded by so much.
   real(wp), parameter :: zero_component = 8.0_wp*epsilon(1.0_wp)
   !> (2, axes) Unit vectors along x and along y.
   real(wp), parameter :: axis_directions(2, 2) = reshape([1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp], [2, 2])

   !> An Assur group, or a drive's link.
   type :: group_t
      integer, allocatable :: links(:)    !< numbers of its links, increasing
      logical :: driven = .false.         !< a drive is part of it
   end type group_t

contains

   !> Finds which coordinate is in which closure equation of a mechanism: (7) to (10) of its pairs, and one of each
   !> drive. Time and memory are proportional to links, pairs and drives.
   function new_closure(m) result(c)
      type(mechanism_t), intent(in) :: m
      type(closure_incidence_t) :: c
      logical, parameter :: angle(3) = [.false., .false., .true.]   !< of x, y, phi: phi only
      integer :: moving(size(m%links)), n, i, k, axis    ! (links) number among the moving links, 0 for ground links
      integer, allocatable :: links(:)

      links = pack([(i, i=1, size(m%links))], .not. m%links%ground)
      moving = 0
      moving(links) = [(i, i=1, size(links))]
      c%link_of = [((links(i), k=1, 3), i=1, size(links))]
      c%incidence%unknowns = size(c%link_of)

      associate (equations => 2*size(m%pairs) + size(m%drives))
         allocate (c%incidence%first(equations + 1), c%incidence%unknown(6*equations))
         c%incidence%equations = equations
      end associate
      c%incidence%first(1) = 1
      n = 0
      k = 0

      do i = 1, size(m%pairs)
         associate (p => m%pairs(i)%point_i, q => m%pairs(i)%point_j)
            if (.not. has_guide(m%pairs(i)%kind)) then
               do axis = 1, 2
                  call add_component(p, axis_directions(:, axis))
                  call add_component(q, axis_directions(:, axis))
                  call complete_equation()
               end do
            else
               call enter(m%points(p)%link, angle)
               call enter(m%points(q)%link, angle)
               call complete_equation()
               call add_projection(i, across=.true.)
               call complete_equation()
            end if
         end associate
      end do

      do i = 1, size(m%drives)
         associate (subject => m%drives(i)%subject)
            select case (m%drives(i)%kind)
            case (drive_angle)
               call enter(subject, angle)
            case (drive_relangle)
               call enter(subject, angle)
               call enter(m%drives(i)%second, angle)
            case (drive_x)
               call add_component(subject, axis_directions(:, 1))
            case (drive_y)
               call add_component(subject, axis_directions(:, 2))
            case (drive_slide)
               call add_projection(subject, across=.false.)
            end select
         end associate
         call complete_equation()
      end do

   contains

      !> Enters coordinates of a link into the unfinished equation. Coordinates of the ground are no unknowns.
      subroutine enter(link, in)
         integer, intent(in) :: link         !< its number among all links
         logical, intent(in) :: in(3)        !< which of x, y, phi are in the equation
         integer :: k

         if (moving(link) == 0) return
         do k = 1, 3
            if (in(k)) n = n + 1
            if (in(k)) c%incidence%unknown(n) = 3*moving(link) - 3 + k
         end do
      end subroutine enter

      !> Adds the coordinates in the component of a point along a fixed direction to the unfinished equation.
      subroutine add_component(point, direction)
         integer, intent(in) :: point        !< the number of the point
         real(wp), intent(in) :: direction(2)   !< a unit vector; x is not in the equation if its x is 0, likewise y

         call enter(m%points(point)%link, [abs(direction) > zero_component, any(abs(m%points(point)%offset) > 0.0_wp)])
      end subroutine add_component

      !> Adds the coordinates in the projection of P - Q of a prismatic pair to the unfinished equation.
      subroutine add_projection(i, across)
         integer, intent(in) :: i            !< the number of the pair
         logical, intent(in) :: across       !< on the normal of its guide; otherwise along the guide
         real(wp) :: angle

         associate (p => m%pairs(i)%point_i, q => m%pairs(i)%point_j)
            if (m%links(m%points(p)%link)%ground) then
               angle = m%links(m%points(p)%link)%position(3) + m%pairs(i)%alpha
               if (across) call add_component(q, [-sin(angle), cos(angle)])
               if (.not. across) call add_component(q, [cos(angle), sin(angle)])
            else
               call enter(m%points(p)%link, spread(.true., 1, 3))
               call add_component(q, [1.0_wp, 1.0_wp])
            end if
         end associate
      end subroutine add_projection

      !> Completes the unfinished equation.
      subroutine complete_equation()

         k = k + 1
         c%incidence%first(k + 1) = n + 1
      end subroutine complete_equation
   end function new_closure

   !> Finds the Assur groups of a mechanism in solving order. The links of the part with too many equations are one
   !> group. Without moving links there is no group.
   function groups_of(m, closure) result(groups)
      type(mechanism_t), intent(in) :: m
      type(closure_incidence_t), intent(in) :: closure   !< of `m`; some matching gives each unknown an equation
      type(group_t), allocatable :: groups(:)
      logical :: over(closure%incidence%equations)
      type(incidence_t) :: waits
      type(sorted_t) :: by_group
      integer, allocatable :: unknown_of(:), equation_of(:), first(:), member(:), of_link(:), order(:)
      integer :: i, e

      call match(closure%incidence, unknown_of, equation_of)
      over = overdetermined(closure%incidence, unknown_of, equation_of)
      waits = waiting(m, closure, equation_of, over)
      call find_blocks(waits, [(i, i=1, size(m%links))], [(.false., i=1, size(m%links))], first, member)
      of_link = member
      do i = 1, size(first) - 1
         of_link(member(first(i):first(i + 1) - 1)) = i
      end do

      order = group_numbers()
      allocate (groups(maxval([0, order])))
      by_group = sorted(order(of_link), size(groups))
      do i = 1, size(groups)
         groups(i)%links = members(by_group, i)
      end do

      do e = 2*size(m%pairs) + 1, size(unknown_of)
         if (closure%incidence%first(e) == closure%incidence%first(e + 1)) cycle
         i = closure%link_of(merge(closure%incidence%unknown(closure%incidence%first(e)), unknown_of(e), over(e)))
         groups(order(of_link(i)))%driven = .true.
      end do

   contains

      !> Numbers the groups: for each set of links that wait for one another (sets in the order of `first`) the number
      !> of its group, 0 for ground links. Groups are ordered by depth, then by their first link in the deck.
      function group_numbers() result(order)
         integer, allocatable :: order(:)
         type(sorted_t) :: by_depth
         integer :: depth(size(first) - 1), i, k, n

         depth = 0
         do i = 1, size(depth)
            if (m%links(member(first(i)))%ground) cycle
            do k = first(i), first(i + 1) - 1
               do n = waits%first(member(k)), waits%first(member(k) + 1) - 1
                  if (of_link(waits%unknown(n)) /= i) depth(i) = max(depth(i), depth(of_link(waits%unknown(n))))
               end do
            end do
            depth(i) = depth(i) + 1
         end do

         by_depth = sorted(depth(of_link), size(depth))
         allocate (order(size(depth)), source=0)
         n = 0
         do i = 1, size(by_depth%member)
            associate (component => of_link(by_depth%member(i)))
               if (order(component) == 0) n = n + 1
               if (order(component) == 0) order(component) = n
            end associate
         end do
      end function group_numbers
   end function groups_of

   !> Finds the links for which each link waits, as the unknowns of its equation; a ground link waits for itself only.
   !> The links of the part with too many equations wait for one another in a ring.
   function waiting(m, closure, equation_of, over) result(w)
      type(mechanism_t), intent(in) :: m
      type(closure_incidence_t), intent(in) :: closure   !< of `m`
      integer, intent(in) :: equation_of(:)  !< (unknowns) the equation that is matched with each, never 0
      logical, intent(in) :: over(:)         !< (equations) it is in the part with too many equations
      type(incidence_t) :: w
      logical :: tied(size(m%links))
      integer :: u, i, k, link, before, n

      tied = .false.
      tied(pack(closure%link_of, over(equation_of))) = .true.
      w%equations = size(m%links)
      w%unknowns = size(m%links)
      allocate (w%first(size(m%links) + 1), w%unknown(3*size(m%links) + size(closure%incidence%unknown)))
      n = 0
      u = 0
      before = findloc(tied, .true., dim=1, back=.true.)

      do link = 1, size(m%links)
         w%first(link) = n + 1
         call wait_for(link)
         if (.not. m%links(link)%ground) then
            do i = 1, 3
               u = u + 1
               do k = closure%incidence%first(equation_of(u)), closure%incidence%first(equation_of(u) + 1) - 1
                  call wait_for(closure%link_of(closure%incidence%unknown(k)))
               end do
            end do
         end if
         if (.not. tied(link)) cycle
         call wait_for(before)
         before = link
      end do
      w%first(size(m%links) + 1) = n + 1

   contains

      !> Makes link `link` wait for another link, or for itself.
      subroutine wait_for(other)
         integer, intent(in) :: other        !< the number of that link

         n = n + 1
         w%unknown(n) = other
      end subroutine wait_for
   end function waiting
end module assur_groups
