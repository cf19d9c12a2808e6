!> From the motion of the unknowns to that of the links, along the tree. A link's origin is
!>
!>    origin = parent's origin + R_p r + s R_p e - R d,
!>
!> r and e in the parent's axes of orientation, d in the link's own; velocity and acceleration follow.
module link_motion
   use kinds, only: wp
   use planar, only: rotated, quarter_turn, add_rotating
   use mechanism, only: mechanism_t
   use motion, only: motion_t, mark_none, mark_not_converged, mark_singular
   use links_tree, only: tree_t, axes_t, link_offset_t, place_on_tree
   use block_state, only: unknown_t, state_t
   implicit none
   private
   public :: chain_t, chain_link_t, new_chain, put_chain, move_links, mark_links, missing_nothing, missing_rates, &
      missing_all

   !> A moving link. Numbers are 0 for the ground, for no pair, no slide and no root.
   type :: chain_link_t
      integer :: link = 0, parent = 0
      integer :: orientation = 0, parent_orientation = 0 !< the unknowns that rotate them
      integer :: slide = 0                              !< its unknown
      integer :: root = 0                               !< the unknown that is its x; y is the next
      real(wp) :: root_unit(2) = 1.0_wp                 !< of x and y of a root, in the unit of the blocks
      logical :: has_body_vector = .false.              !< its origin is not the point that joins it to the parent
      logical :: is_plain = .false.                     !< no body vector, no slide, no root
      real(wp) :: angle_offset = 0.0_wp                 !< of the link from its orientation, in rad
      type(link_offset_t) :: place                            !< r, d and e, in the deck's unit of length
   end type chain_link_t

   !> The links to be moved and those that stay: the wanted ones first, parents before their children.
   type :: chain_t
      type(chain_link_t), allocatable :: links(:)
      integer, allocatable :: ground(:)                 !< numbers of the ground links
      integer :: wanted = 0, wanted_ground = 0          !< so many of them are wanted, or parents of wanted ones
      real(wp), allocatable :: ground_position(:, :)    !< (3, ground links)
      real(wp) :: origin(2) = 0.0_wp                    !< what places are counted from, in the deck's unit
   end type chain_t

   !> What is missing of an unknown, the worst last: nothing, its derivatives, its value as well.
   integer, parameter :: missing_nothing = 0, missing_rates = 1, missing_all = 2

contains

   !> The chain of the links of `m`, in the deck's unit of length; first those `wanted` (links), and their parents.
   !> `unit` (0:unknowns): of each unknown in the unit of the slides.
   function new_chain(m, t, a, wanted, unit) result(c)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(axes_t), intent(in) :: a
      logical, intent(in) :: wanted(:)
      real(wp), intent(in) :: unit(0:)
      type(chain_t) :: c
      logical :: needed(size(wanted))
      integer, allocatable :: links(:)
      integer :: i

      needed = wanted
      do i = size(t%order), 1, -1
         if (needed(t%order(i)) .and. t%parent(t%order(i)) > 0) needed(t%parent(t%order(i))) = .true.
      end do
      associate (moves => .not. m%links(t%order)%ground, numbers => [(i, i=1, size(wanted))])
         links = [pack(t%order, moves .and. needed(t%order)), pack(t%order, moves .and. .not. needed(t%order))]
         c%wanted = count(moves .and. needed(t%order))
         c%ground = [pack(numbers, m%links%ground .and. wanted), pack(numbers, m%links%ground .and. .not. wanted)]
         c%wanted_ground = count(m%links%ground .and. wanted)
      end associate
      allocate (c%links(size(links)), c%ground_position(3, size(c%ground)))
      c%links%link = links
      call put_chain(m, t, a, unit, c)
   end function new_chain

   !> Gives the chain `c` the numbers of `m`, whose tree is `t` with the axes `a`; the other arguments as above.
   subroutine put_chain(m, t, a, unit, c)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(axes_t), intent(in) :: a
      real(wp), intent(in) :: unit(0:)
      type(chain_t), intent(inout) :: c
      integer :: i

      do i = 1, size(c%links)
         associate (h => c%links(i), link => c%links(i)%link)
            h%orientation = t%orientation(link)
            h%angle_offset = a%angle_offset(link)
            if (t%parent(link) == 0) then
               h%root = t%orientations + t%slides + 2*t%root(link) - 1
               h%root_unit = unit(h%root:h%root + 1)
               cycle
            end if
            h%place = place_on_tree(m, t, a, link)
            h%has_body_vector = any(abs(h%place%body_vector) > 0.0_wp)
            h%parent_orientation = t%orientation(t%parent(link))
            if (h%place%slide > 0) then
               h%slide = t%orientations + h%place%slide
               h%place%slide_body_vector = unit(h%slide)*h%place%slide_body_vector
            end if
            if (.not. m%links(t%parent(link))%ground) h%parent = t%parent(link)
            h%is_plain = h%slide == 0 .and. .not. h%has_body_vector
         end associate
      end do
      do i = 1, size(c%ground)
         c%ground_position(:, i) = m%links(c%ground(i))%position - [a%origin, 0.0_wp]
      end do
      c%origin = a%origin
   end subroutine put_chain

   !> Puts the motion of the chain's wanted links, or of `all_links`, at state `s` into `q`; `length`: the
   !> unit of the slides in the deck's unit. `finite`: no number is out of range; false may be said of sums alone.
   pure subroutine move_links(c, s, length, q, finite, all_links)
      type(chain_t), intent(in) :: c
      type(state_t), intent(in) :: s
      real(wp), intent(in) :: length
      type(motion_t), intent(inout) :: q
      logical, intent(out) :: finite
      logical, intent(in), optional :: all_links
      integer :: links, ground, i, k

      links = c%wanted
      ground = c%wanted_ground
      if (present(all_links)) then
         if (all_links) links = size(c%links)
         if (all_links) ground = size(c%ground)
      end if
      q%origin = c%origin
      ! One by one, since a column at once would be a call of its own.
      do i = 1, ground
         k = c%ground(i)
         q%position(1, k) = c%ground_position(1, i)
         q%position(2, k) = c%ground_position(2, i)
         q%position(3, k) = c%ground_position(3, i)
      end do
      call move_chain(links, c%links, s%u, length, q%position, q%velocity, q%acceleration, finite)
   end subroutine move_links

   !> Puts the motion of the `n` moving `links` into that of all links, on plain arrays, which cost no descriptors.
   pure subroutine move_chain(n, links, u, length, p, v, a, finite)
      integer, intent(in) :: n
      type(chain_link_t), intent(in) :: links(n)
      type(unknown_t), intent(in) :: u(0:*)
      real(wp), intent(in) :: length
      real(wp), intent(inout) :: p(3, *), v(3, *), a(3, *)
      logical, intent(out) :: finite
      real(wp) :: x(2), x_t(2), x_tt(2), check
      integer :: i, k

      check = 0.0_wp
      do i = 1, n
         associate (h => links(i), f => u(links(i)%orientation))
            call follow_parent(h%place%reach, h%parent_orientation, u(h%parent_orientation), x, x_t, x_tt)
            if (.not. h%is_plain) then
               associate (d => h%place%body_vector)
                  if (h%has_body_vector) call add_rotating(-(f%c*d(1) - f%s*d(2)), -(f%s*d(1) + f%c*d(2)), f%rate, &
                     f%acceleration, x, x_t, x_tt)
               end associate
               if (h%slide > 0) call add_slide(h%place%slide_body_vector, u(h%parent_orientation), u(h%slide), length, &
                  x, x_t, x_tt)
               ! A link that no pair joins to the ground has unknowns of its own for x and y.
               if (h%root > 0) then
                  x = length*h%root_unit*u(h%root:h%root + 1)%value
                  x_t = length*h%root_unit*u(h%root:h%root + 1)%rate
                  x_tt = length*h%root_unit*u(h%root:h%root + 1)%acceleration
               end if
            end if
            if (h%parent > 0) then
               x = x + p(:2, h%parent)
               x_t = x_t + v(:2, h%parent)
               x_tt = x_tt + a(:2, h%parent)
            end if
            k = h%link
            p(:, k) = [x, f%value + h%angle_offset]
            v(:, k) = [x_t, f%rate]
            a(:, k) = [x_tt, f%acceleration]
            check = check + ((x(1) + x(2)) + (x_t(1) + x_t(2)) + ((x_tt(1) + x_tt(2)) + f%acceleration))
         end associate
      end do
      finite = abs(check) <= huge(check)
   end subroutine move_chain

   !> From the parent's origin the vector `d` in its axes, which unknown number `orientation`, `f`, rotates.
   pure subroutine follow_parent(d, orientation, f, p, v, a)
      real(wp), intent(in) :: d(2)
      integer, intent(in) :: orientation
      type(unknown_t), intent(in) :: f
      real(wp), intent(inout) :: p(2), v(2), a(2)
      real(wp) :: x, y, square

      if (orientation == 0) then
         p(1) = d(1)
         p(2) = d(2)
         v(1) = 0.0_wp
         v(2) = 0.0_wp
         a(1) = 0.0_wp
         a(2) = 0.0_wp
         return
      end if
      x = f%c*d(1) - f%s*d(2)
      y = f%s*d(1) + f%c*d(2)
      square = f%rate*f%rate
      p(1) = x
      p(2) = y
      v(1) = -f%rate*y
      v(2) = f%rate*x
      a(1) = -f%acceleration*y - square*x
      a(2) = f%acceleration*x - square*y
   end subroutine follow_parent

   !> Adds s R e with its derivatives, of slide `u` along `d` = e in the axes that `f` rotates.
   pure subroutine add_slide(d, f, u, length, p, v, a)
      real(wp), intent(in) :: d(2)
      type(unknown_t), intent(in) :: f, u
      real(wp), intent(in) :: length
      real(wp), intent(inout) :: p(2), v(2), a(2)
      real(wp) :: e(2), e_t(2)

      e = length*rotated(d, [f%c, f%s])
      e_t = quarter_turn(e)
      p = p + u%value*e
      v = v + u%rate*e + u%value*f%rate*e_t
      a = a + u%acceleration*e + 2.0_wp*u%rate*f%rate*e_t + u%value*(f%acceleration*e_t - f%rate**2*e)
   end subroutine add_slide

   !> Says of each link of `found` how much of it is known and why no more, from what is `missing` (0:unknowns) of the
   !> unknowns by which it and its parents move; links that are not wanted count as known.
   subroutine mark_links(c, missing, found)
      type(chain_t), intent(in) :: c
      integer, intent(in) :: missing(0:)
      type(motion_t), intent(inout) :: found
      integer :: of_link(0:size(found%position, 2)), k

      of_link = missing_nothing
      do k = 1, c%wanted
         associate (h => c%links(k))
            of_link(h%link) = max(missing(h%orientation), missing(h%slide), of_link(h%parent))
            if (h%root > 0) of_link(h%link) = max(of_link(h%link), missing(h%root), missing(h%root + 1))
         end associate
      end do
      associate (links => of_link(1:))
         found%link_known = merge(2, merge(0, -1, links == missing_rates), links == missing_nothing)
         found%link_mark = merge(mark_none, merge(mark_singular, mark_not_converged, links == missing_rates), &
            links == missing_nothing)
      end associate
   end subroutine mark_links
end module link_motion
