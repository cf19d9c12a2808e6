!> The motion of the links from the motion of the unknowns, along the tree. A link's origin is
!>
!>    origin = parent's origin + R_p r + s R_p e - R d,
!>
!> r and e in the parent's axes of orientation, d in the link's own; velocity and acceleration follow.
module link_motion
   use assertions, only: asserts, assert
   use kinds, only: wp
   use plane_vectors, only: rotated, quarter_turn, add_rotating
   use mechanism, only: mechanism_t, has_guide
   use motion, only: motion_t, flag_none, flag_not_converged, flag_singular
   use blocks, only: blocks_t, geometry_t, link_order_t, link_step_t
   use block_state, only: unknown_t, state_t
   use spanning_tree, only: axes_t, guide, link_offset_t, point_offset, spanning_tree_t
   implicit none
   private
   public :: new_chain, assign_chain, move_links, flag_links, missing_nothing, missing_rates, missing_all

   !> The worst last: nothing is missing of an unknown, its derivatives are, its value is as well.
   integer, parameter :: missing_nothing = 0, missing_rates = 1, missing_all = 2

contains

   !> Makes the chain of the links of a mechanism, in the deck's unit of length: first the wanted ones and their
   !> parents.
   function new_chain(m, b, x, wanted) result(c)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      logical, intent(in) :: wanted(:)       !< (links) the motion of the link is asked for
      type(link_order_t) :: c
      logical :: needed(size(wanted))
      integer, allocatable :: links(:)
      integer :: i

      needed = wanted
      associate (order => b%tree%order, parent => b%tree%parent)
         do i = size(order), 1, -1
            if (needed(order(i)) .and. parent(order(i)) > 0) needed(parent(order(i))) = .true.
         end do
         links = pack(order, .not. m%links(order)%ground)
      end associate
      c%wanted = count(needed(links))
      links = [pack(links, needed(links)), pack(links, .not. needed(links))]
      c%ground = pack([(i, i=1, size(wanted))], m%links%ground)
      allocate (c%links(size(links)), c%ground_position(3, size(c%ground)))
      c%links%link = links
      call assign_chain(m, b, x, c)
   end function new_chain

   !> Gives a chain the numbers of a mechanism.
   subroutine assign_chain(m, b, x, chain)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(link_order_t), intent(inout) :: chain   !< as `new_chain` makes it
      integer :: i

      do i = 1, size(chain%links)
         associate (h => chain%links(i), link => chain%links(i)%link, t => b%tree, a => x%equations%axes)
            h%orientation = t%orientation(link)
            h%angle_offset = a%angle_offset(link)
            if (t%parent(link) == 0) then
               h%root = t%orientations + t%slides + 2*t%root(link) - 1
               h%root_unit = x%unit(h%root:h%root + 1)
               cycle
            end if

            h%place = place_on_tree(m, t, a, link)
            h%has_body_vector = any(abs(h%place%body_vector) > 0.0_wp)
            h%parent_orientation = t%orientation(t%parent(link))
            if (h%place%slide > 0) then
               h%slide = t%orientations + h%place%slide
               h%place%slide_body_vector = x%unit(h%slide)*h%place%slide_body_vector
            end if
            if (.not. m%links(t%parent(link))%ground) h%parent = t%parent(link)
         end associate
      end do
      do i = 1, size(chain%ground)
         chain%ground_position(:, i) = m%links(chain%ground(i))%position - [x%equations%axes%origin, 0.0_wp]
      end do
      chain%origin = x%equations%axes%origin
      chain%length = x%equations%length
   end subroutine assign_chain

   !> Finds the motion of the first links of a chain.
   pure subroutine move_links(chain, n, s, q, finite)
      type(link_order_t), intent(in) :: chain
      integer, intent(in) :: n               !< how many links: chain%wanted, or all
      type(state_t), intent(in) :: s
      type(motion_t), intent(inout) :: q     !< of all links, in the deck's units; x and y from the chain's origin
      logical, intent(out) :: finite         !< no number is out of range, and no sum of them

      if (asserts) call assert(n <= size(chain%links), 'move_links: as many links as there are')
      q%origin = chain%origin
      call move_chain(n, chain%links, size(chain%ground), chain%ground, chain%ground_position, s%u, chain%length, &
         q%position, q%velocity, q%acceleration, finite)
   end subroutine move_links

   !> Finds the motion of ground links and moving links on plain arrays, which cost no descriptors.
   pure subroutine move_chain(n, links, grounds, ground, ground_positions, unknowns, length, positions, velocities, &
      accelerations, finite)
      integer, intent(in) :: n                              !< how many links are moved
      type(link_step_t), intent(in) :: links(n)            !< parents before their children
      integer, intent(in) :: grounds                        !< how many ground links there are
      integer, intent(in) :: ground(*)                      !< (ground links) their numbers
      real(wp), intent(in) :: ground_positions(3, *)        !< (3, ground links) x, y, phi, in the deck's unit and rad
      type(unknown_t), intent(in) :: unknowns(0:*)          !< (0:unknowns)
      real(wp), intent(in) :: length                        !< the unit of slides in the deck's
      real(wp), intent(inout) :: positions(3, *)            !< (3, links) x, y, phi, in the deck's unit and rad
      real(wp), intent(inout) :: velocities(3, *)           !< (3, links) by time
      real(wp), intent(inout) :: accelerations(3, *)        !< (3, links) by time squared
      logical, intent(out) :: finite                        !< no number is out of range
      real(wp), dimension(2) :: x, x_t, x_tt, e, e_t
      real(wp) :: check
      integer :: i, k

      do i = 1, grounds
         positions(:, ground(i)) = ground_positions(:, i)
      end do
      check = 0.0_wp
      do i = 1, n
         associate (h => links(i), f => unknowns(links(i)%orientation))
            associate (parent => unknowns(h%parent_orientation), r => h%place%reach, d => h%place%body_vector)
               if (h%parent_orientation == 0) then
                  x = r
                  x_t = 0.0_wp
                  x_tt = 0.0_wp
               else
                  x = rotated(r, [parent%c, parent%s])
                  x_t = parent%rate*quarter_turn(x)
                  x_tt = parent%acceleration*quarter_turn(x) - parent%rate**2*x
               end if

               if (h%has_body_vector) call add_rotating(-(f%c*d(1) - f%s*d(2)), -(f%s*d(1) + f%c*d(2)), f%rate, &
                  f%acceleration, x, x_t, x_tt)
               if (h%slide > 0) then
                  ! s R e with its derivatives.
                  e = length*rotated(h%place%slide_body_vector, [parent%c, parent%s])
                  e_t = quarter_turn(e)
                  associate (slide => unknowns(h%slide))
                     x = x + slide%value*e
                     x_t = x_t + slide%rate*e + slide%value*parent%rate*e_t
                     x_tt = x_tt + slide%acceleration*e + 2.0_wp*slide%rate*parent%rate*e_t &
                        + slide%value*(parent%acceleration*e_t - parent%rate**2*e)
                  end associate
               end if
            end associate

            ! A link that no pair joins to the ground has unknowns of its own for x and y.
            if (h%root > 0) then
               x = length*h%root_unit*unknowns(h%root:h%root + 1)%value
               x_t = length*h%root_unit*unknowns(h%root:h%root + 1)%rate
               x_tt = length*h%root_unit*unknowns(h%root:h%root + 1)%acceleration
            end if
            if (h%parent > 0) then
               x = x + positions(:2, h%parent)
               x_t = x_t + velocities(:2, h%parent)
               x_tt = x_tt + accelerations(:2, h%parent)
            end if

            k = h%link
            positions(:, k) = [x, f%value + h%angle_offset]
            velocities(:, k) = [x_t, f%rate]
            accelerations(:, k) = [x_tt, f%acceleration]
            check = check + ((x(1) + x(2)) + (x_t(1) + x_t(2)) + ((x_tt(1) + x_tt(2)) + f%acceleration))
         end associate
      end do
      finite = abs(check) <= huge(check)
   end subroutine move_chain

   !> Finds how much of each link of a motion is known, and why no more, from the unknowns by which it and its parents
   !> move. Links that are not wanted count as known.
   subroutine flag_links(chain, missing, found)
      type(link_order_t), intent(in) :: chain
      integer, intent(in) :: missing(0:)     !< (0:unknowns) missing_nothing, ...
      type(motion_t), intent(inout) :: found
      integer :: of_link(0:size(found%position, 2)), k

      of_link = missing_nothing
      do k = 1, chain%wanted
         associate (h => chain%links(k))
            of_link(h%link) = max(missing(h%orientation), missing(h%slide), of_link(h%parent))
            if (h%root > 0) of_link(h%link) = max(of_link(h%link), missing(h%root), missing(h%root + 1))
         end associate
      end do
      associate (links => of_link(1:))
         found%link_known = merge(2, merge(0, -1, links == missing_rates), links == missing_nothing)
         found%link_flag = merge(flag_none, merge(flag_singular, flag_not_converged, links == missing_rates), &
            links == missing_nothing)
      end associate
   end subroutine flag_links

   !> Finds where a link is, seen from its parent, in the deck's unit of length.
   pure function place_on_tree(m, tree, axes, link) result(p)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree
      type(axes_t), intent(in) :: axes
      integer, intent(in) :: link   !< its number; it has a parent
      type(link_offset_t) :: p
      real(wp) :: sign_of

      associate (pair => m%pairs(tree%parent_joint(link)), parent => tree%parent(link))
         sign_of = merge(1.0_wp, -1.0_wp, m%points(pair%point_j)%link == link)
         p%reach = point_offset(m, axes, merge(pair%point_i, pair%point_j, sign_of > 0.0_wp))
         p%body_vector = point_offset(m, axes, merge(pair%point_j, pair%point_i, sign_of > 0.0_wp))
         if (m%links(parent)%ground) p%reach = p%reach + (m%links(parent)%position(:2) - axes%origin)
         if (.not. has_guide(pair%kind)) return
         p%slide = tree%slide(tree%parent_joint(link))
         p%slide_body_vector = sign_of*guide(m, axes, tree%parent_joint(link), across=.false.)
         p%reach = p%reach - sign_of*guide(m, axes, tree%parent_joint(link), across=.true.)*pair%offset
      end associate
   end function place_on_tree
end module link_motion
