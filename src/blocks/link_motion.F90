!> The motion of the links from the motion of the unknowns, along the tree. The origin of a link is the origin of its
!> parent plus the vector of link_motion.inc, which is compiled for reals here.
#define NUMBER real(wp)
#define ZERO 0.0_wp
#define TWO 2.0_wp
module link_motion
   use assertions, only: asserts, assert
   use kinds, only: wp
   use number_types, only: vector_t, unknown_t, link_numbers_t
   use mechanism, only: mechanism_t, has_guide
   use motion, only: motion_t, flag_none, flag_not_converged, flag_singular
   use blocks, only: blocks_t, geometry_t, link_order_t, link_step_t
   use block_equations, only: add_rotating
   use block_state, only: state_t
   use spanning_tree, only: axes_t, guide, point_offset, spanning_tree_t
   implicit none
   private
   public :: new_chain, assign_chain, move_links, flag_links, missing_nothing, missing_rates, missing_all

   !> The missing part of an unknown, the worst last: nothing; rate and acceleration; its value as well.
   integer, parameter :: missing_nothing = 0, missing_rates = 1, missing_all = 2

contains

   !> Makes the chain of the links of a mechanism, in the deck's unit of length: wanted links and all from which these
   !> hang come first.
   function new_chain(m, b, x, wanted) result(c)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b        !< of `m`, solvable
      type(geometry_t), intent(in) :: x      !< of `m`
      logical, intent(in) :: wanted(:)       !< (links) the motion of the link is needed
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

   !> Gives a chain of links the numbers of a mechanism.
   subroutine assign_chain(m, b, x, chain)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b        !< solvable
      type(geometry_t), intent(in) :: x      !< with the units and axes by the numbers of `m`
      type(link_order_t), intent(inout) :: chain   !< its order stays; all its numbers are set
      integer :: i

      do i = 1, size(chain%links)
         associate (h => chain%links(i), link => chain%links(i)%link, t => b%tree, a => x%equations%axes)
            h%orientation = t%orientation(link)
            h%numbers%angle_offset = a%angle_offset(link)
            if (t%parent(link) == 0) then
               h%root = t%orientations + t%slides + 2*t%root(link) - 1
               h%numbers%root_unit = vector_of(x%equations%length*x%unit(h%root:h%root + 1))
               cycle
            end if

            associate (slide => t%slide(t%parent_joint(link)))
               if (slide > 0) h%slide = t%orientations + slide
            end associate
            call assign_link_numbers(m, t, x, h)
            h%has_body_vector = any(abs([h%numbers%body_vector%x, h%numbers%body_vector%y]) > 0.0_wp)
            h%parent_orientation = t%orientation(t%parent(link))
            if (.not. m%links(t%parent(link))%ground) h%parent = t%parent(link)
         end associate
      end do
      do i = 1, size(chain%ground)
         chain%ground_position(:, i) = m%links(chain%ground(i))%position - [x%equations%axes%origin, 0.0_wp]
      end do
      chain%origin = x%equations%axes%origin
   end subroutine assign_chain

   !> Finds position, velocity and acceleration of the first n links of a chain, and the positions of ground links.
   pure subroutine move_links(chain, n, s, q, finite)
      type(link_order_t), intent(in) :: chain   !< of the mechanism
      integer, intent(in) :: n               !< how many links: chain%wanted, or all
      type(state_t), intent(in) :: s         !< with the motion of their unknowns
      type(motion_t), intent(inout) :: q     !< (links) in the deck's units; x and y from the chain's origin
      logical, intent(out) :: finite         !< no number is out of range, nor is the sum of all

      if (asserts) call assert(n <= size(chain%links), 'move_links: as many links as there are')
      q%origin = chain%origin
      call move_chain(n, chain%links, size(chain%ground), chain%ground, chain%ground_position, s%u, q%position, &
         q%velocity, q%acceleration, finite)
   end subroutine move_links

   !> Finds positions of ground links and the motion of moving links. Reason for plain arrays: each step does it, and
   !> descriptors cost time.
   pure subroutine move_chain(n, links, grounds, ground, ground_positions, unknowns, positions, velocities, &
      accelerations, finite)
      integer, intent(in) :: n                              !< how many links are moved
      type(link_step_t), intent(in) :: links(n)            !< (moved links) parents before their children
      integer, intent(in) :: grounds                        !< how many ground links there are
      integer, intent(in) :: ground(*)                      !< (ground links) their numbers
      real(wp), intent(in) :: ground_positions(3, *)        !< (3, ground links) x, y, phi, in the deck's unit and rad
      type(unknown_t), intent(in) :: unknowns(0:*)          !< (0:unknowns)   !< with the motion
      real(wp), intent(inout) :: positions(3, *)            !< (3, links) x, y, phi, in the deck's unit and rad
      real(wp), intent(inout) :: velocities(3, *)           !< (3, links) by time
      real(wp), intent(inout) :: accelerations(3, *)        !< (3, links) by time squared
      logical, intent(out) :: finite                        !< no number is out of range, nor is the sum of all
      type(vector_t) :: origin(0:2)
      real(wp) :: check
      integer :: i

      do i = 1, grounds
         positions(:, ground(i)) = ground_positions(:, i)
      end do
      check = 0.0_wp
      do i = 1, n
         call find_link_vector(links(i), links(i)%numbers, unknowns, origin)
         associate (h => links(i), f => unknowns(links(i)%orientation), k => links(i)%link)
            if (h%parent > 0) then
               origin(0) = vector_t(origin(0)%x + positions(1, h%parent), origin(0)%y + positions(2, h%parent))
               origin(1) = vector_t(origin(1)%x + velocities(1, h%parent), origin(1)%y + velocities(2, h%parent))
               origin(2) = vector_t(origin(2)%x + accelerations(1, h%parent), origin(2)%y + accelerations(2, h%parent))
            end if

            positions(:, k) = [origin(0)%x, origin(0)%y, f%value + h%numbers%angle_offset]
            velocities(:, k) = [origin(1)%x, origin(1)%y, f%rate]
            accelerations(:, k) = [origin(2)%x, origin(2)%y, f%acceleration]
            check = check + ((origin(0)%x + origin(0)%y) + (origin(1)%x + origin(1)%y) &
               + ((origin(2)%x + origin(2)%y) + f%acceleration))
         end associate
      end do
      finite = abs(check) <= huge(check)
   end subroutine move_chain

   !> Finds how much of the motion of each link is known, and the flag that tells why no more, from the unknowns by
   !> which the link and its parents move. Links that are not wanted count as known.
   subroutine flag_links(chain, missing, found)
      type(link_order_t), intent(in) :: chain   !< of the mechanism
      integer, intent(in) :: missing(0:)     !< (0:unknowns) missing_nothing, ...
      type(motion_t), intent(inout) :: found   !< of all links; link_known and link_flag are set
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

   !> Gives a link the numbers of its position on its parent: offset, body vector and slide vector.
   pure subroutine assign_link_numbers(m, tree, x, link)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`
      type(geometry_t), intent(in) :: x      !< with the units and axes by the numbers of `m`
      type(link_step_t), intent(inout) :: link   !< with a parent
      real(wp) :: sign_of, offset(2)

      associate (joint => tree%parent_joint(link%link), parent => tree%parent(link%link), axes => x%equations%axes)
         associate (pair => m%pairs(joint))
            sign_of = merge(1.0_wp, -1.0_wp, m%points(pair%point_j)%link == link%link)
            offset = point_offset(m, axes, merge(pair%point_i, pair%point_j, sign_of > 0.0_wp))
            link%numbers%body_vector = &
               vector_of(-point_offset(m, axes, merge(pair%point_j, pair%point_i, sign_of > 0.0_wp)))
            if (m%links(parent)%ground) offset = offset + (m%links(parent)%position(:2) - axes%origin)
            if (has_guide(pair%kind)) then
               offset = offset - sign_of*guide(m, axes, joint, across=.true.)*pair%offset
               link%numbers%slide_vector = vector_of(x%equations%length*x%unit(link%slide)*sign_of &
                  *guide(m, axes, joint, across=.false.))
            end if
            link%numbers%offset = vector_of(offset)
         end associate
      end associate
   end subroutine assign_link_numbers

   !> Makes a vector of its two components.
   pure type(vector_t) function vector_of(numbers)
      real(wp), intent(in) :: numbers(2)     !< x and y, in any unit

      vector_of = vector_t(numbers(1), numbers(2))
   end function vector_of

#include "link_motion.inc"
end module link_motion
