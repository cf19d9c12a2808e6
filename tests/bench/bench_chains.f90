!> Tests. Closed forms of the chains that tests/make_deck writes, links in the order of its decks, the ground first:
!> once for speed, link after link (the limit that `make bench` counts in), and once exactly, by what is known of the
!> whole chain, in real128.
module bench_chains
   use kinds, only: wp
   use quad_jet
   use closed_forms_dyads, only: place_t, body_t, flat, origin, base, fixed_place, body, polar
   use fast_forms, only: spot_t, two_rods, put_link
   implicit none
   private
   public :: size_t, link_order_t, new_chain, move_chain, exact_chain

   !> A chain of make_deck.
   type :: size_t
      character(7) :: kind
      integer :: n
   end type size_t

   !> The number in the deck's title and, of a lattice, where its legs stand and its rods begin.
   type :: link_order_t
      character(7) :: kind = ''
      integer :: n = 0
      integer :: legs = 0
      real(wp), allocatable :: place(:, :)   !< (3, legs and rods) x, y less the leg's own, angle
   end type link_order_t

contains

   !> The chain `kind` with the number `n`.
   function new_chain(kind, n) result(c)
      character(*), intent(in) :: kind
      integer, intent(in) :: n
      type(link_order_t) :: c

      c%kind = kind
      c%n = n
      if (kind == 'lattice') call place_lattice(c)
   end function new_chain

   !> The motion (3, links) at `t`, link after link.
   pure subroutine move_chain(c, t, q, v, a)
      type(link_order_t), intent(in) :: c
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: q(:, :), v(:, :), a(:, :)

      q(:, 1) = 0.0_wp
      v(:, 1) = 0.0_wp
      a(:, 1) = 0.0_wp
      select case (c%kind)
      case ('windows')
         call move_windows(c%n, 1.0_wp + t, q, v, a)
      case ('scissor')
         call move_scissor(c%n, 0.4_wp + t, q, v, a)
      case ('arm')
         call move_arm(c%n, t, q, v, a)
      case ('lattice')
         call move_lattice(c, 1.0_wp + t, q, v, a)
      end select
   end subroutine move_chain

   !> Window after window as a four-bar of any lengths: the coupler and the next rod are a dyad. Nothing is made of
   !> all rods being parallel.
   pure subroutine move_windows(n, phi, q, v, a)
      integer, intent(in) :: n
      real(wp), intent(in) :: phi
      real(wp), intent(inout) :: q(:, :), v(:, :), a(:, :)
      type(spot_t) :: tip, next
      real(wp) :: coupler(3), rod(3)
      integer :: i

      tip = spot_t(cos(phi), sin(phi), -sin(phi), cos(phi), -cos(phi), -sin(phi))
      call put_link(spot_t(), [phi, 1.0_wp, 0.0_wp], q(:, 2), v(:, 2), a(:, 2))
      do i = 1, n
         associate (pivot => spot_t(real(i, wp)), j => 2*i + 1)
            call two_rods(tip, pivot, 1.0_wp, 1.0_wp, 1.0_wp, next, coupler, rod)
            call put_link(tip, coupler, q(:, j), v(:, j), a(:, j))
            call put_link(pivot, rod, q(:, j + 1), v(:, j + 1), a(:, j + 1))
         end associate
         tip = next
      end do
   end subroutine move_windows

   !> Stage after stage as a dyad between the two ends of the stage below; the lowest one is a crank-slider.
   pure subroutine move_scissor(n, phi, q, v, a)
      integer, intent(in) :: n
      real(wp), intent(in) :: phi
      real(wp), intent(inout) :: q(:, :), v(:, :), a(:, :)
      type(spot_t) :: left, right, middle
      real(wp) :: one(3), two(3), run
      integer :: i, j

      left = spot_t()
      middle = spot_t(cos(phi), sin(phi), -sin(phi), cos(phi), -cos(phi), -sin(phi))
      one = [phi, 1.0_wp, 0.0_wp]
      run = sqrt(1.0_wp - middle%y**2)
      two(1) = atan2(middle%y, -run)
      two(2) = -middle%vy/run
      two(3) = -(middle%ay + two(2)**2*middle%y)/run
      right = spot_t(middle%x + run, 0.0_wp, middle%vx + two(2)*middle%y, 0.0_wp, &
                     middle%ax + two(3)*middle%y - two(2)**2*run, 0.0_wp)
      call put_link(right, [0.0_wp, 0.0_wp, 0.0_wp], q(:, 2), v(:, 2), a(:, 2))
      do i = 1, n/2
         j = 2*i + 1
         if (i > 1) call two_rods(left, right, 1.0_wp, 1.0_wp, 1.0_wp, middle, one, two)
         call put_link(left, one, q(:, j), v(:, j), a(:, j))
         call put_link(right, two, q(:, j + 1), v(:, j + 1), a(:, j + 1))
         call cross(left, right, middle)
      end do
   end subroutine move_scissor

   !> From the feet of a stage to those of the next: each rod runs as far again beyond the middle, to the other side.
   pure subroutine cross(left, right, middle)
      type(spot_t), intent(inout) :: left, right
      type(spot_t), intent(in) :: middle
      type(spot_t) :: m, p, q

      m = middle
      p = spot_t(2*m%x - right%x, 2*m%y - right%y, 2*m%vx - right%vx, 2*m%vy - right%vy, 2*m%ax - right%ax, &
         2*m%ay - right%ay)
      q = spot_t(2*m%x - left%x, 2*m%y - left%y, 2*m%vx - left%vx, 2*m%vy - left%vy, 2*m%ax - left%ax, 2*m%ay - left%ay)
      left = p
      right = q
   end subroutine cross

   !> Link after link: a sine and a cosine each.
   pure subroutine move_arm(n, t, q, v, a)
      integer, intent(in) :: n
      real(wp), intent(in) :: t
      real(wp), intent(inout) :: q(:, :), v(:, :), a(:, :)
      type(spot_t) :: p
      real(wp) :: phi, w, c, s
      integer :: i

      p = spot_t()
      do i = 1, n
         w = 0.001_wp*i
         phi = (0.002_wp + 0.001_wp*t)*i
         call put_link(p, [phi, w, 0.0_wp], q(:, i + 1), v(:, i + 1), a(:, i + 1))
         c = cos(phi)
         s = sin(phi)
         p = spot_t(p%x + c, p%y + s, p%vx - w*s, p%vy + w*c, p%ax - w*w*c, p%ay - w*w*s)
      end do
   end subroutine move_arm

   !> The net moves without turning: no closed form is known of a general net, so this one is as cheap as any can be.
   pure subroutine move_lattice(c, phi, q, v, a)
      type(link_order_t), intent(in) :: c
      real(wp), intent(in) :: phi
      real(wp), intent(inout) :: q(:, :), v(:, :), a(:, :)
      real(wp) :: x, y
      integer :: i

      x = cos(phi)
      y = sin(phi)
      do i = 1, c%legs
         q(:, i + 1) = [c%place(1, i), c%place(2, i), phi]
         v(:, i + 1) = [0.0_wp, 0.0_wp, 1.0_wp]
         a(:, i + 1) = 0.0_wp
      end do
      do i = c%legs + 1, size(c%place, 2)
         q(:, i + 1) = [c%place(1, i) + x, c%place(2, i) + y, c%place(3, i)]
         v(:, i + 1) = [-y, x, 0.0_wp]
         a(:, i + 1) = [-x, -y, 0.0_wp]
      end do
   end subroutine move_lattice

   !> The deck's net: u, w of joint (i, j) beyond the foot of its leg.
   subroutine place_lattice(c)
      type(link_order_t), intent(inout) :: c
      real(wp), allocatable :: rods(:, :)
      integer :: i, j, n, count

      n = c%n
      allocate (c%place(3, 0), rods(3, 2*n*(n - 1)))
      count = 0
      do i = 1, n
         do j = 1, n
            if (has_leg(i, j, n)) c%place = reshape([c%place, joint(i, j), 0.0_wp], [3, size(c%place, 2) + 1])
            if (i < n) call add_rod(joint(i, j), joint(i + 1, j))
            if (j < n) call add_rod(joint(i, j), joint(i, j + 1))
         end do
      end do
      c%legs = size(c%place, 2)
      c%place = reshape([c%place, rods], [3, c%legs + count])

   contains

      subroutine add_rod(from, to)
         real(wp), intent(in) :: from(2), to(2)

         count = count + 1
         rods(:, count) = [from, atan2(to(2) - from(2), to(1) - from(1))]
      end subroutine add_rod
   end subroutine place_lattice

   pure function joint(i, j) result(p)
      integer, intent(in) :: i, j
      real(wp) :: p(2)

      p = [i + (mod(7*i + 3*j, 5) - 2)/16.0_wp, j + (mod(4*i + 9*j + i*j, 7) - 3)/16.0_wp]
   end function joint

   pure logical function has_leg(i, j, n)
      integer, intent(in) :: i, j, n

      has_leg = 2*i == n + 1 .and. 2*j == n + 1
      if (i == 1 .or. i == n .or. j == 1 .or. j == n) has_leg = has_leg .or. mod(i + j, 2) == 0
   end function has_leg

   !> The links at `t` by what make_deck says of the whole chain, in real128.
   function exact_chain(c, t) result(links)
      type(link_order_t), intent(in) :: c
      real(qp), intent(in) :: t
      type(body_t), allocatable :: links(:)
      type(jet_t) :: phi
      integer :: i

      allocate (links(1))
      links(1) = base
      select case (c%kind)
      case ('windows')
         ! Rods, and couplers that stay level.
         phi = 1.0_qp + time_jet(t)
         do i = 0, c%n
            associate (foot => fixed_place(real(i, qp), 0.0_qp))
               links = [links, body('', foot, phi)]
               if (i < c%n) links = [links, body('', polar(foot, 1.0_qp, phi), flat)]
            end associate
         end do
      case ('scissor')
         ! The feet of stage i = 0, 1, ... are 2 i sin phi above the ground, the right ones 2 cos phi from the left
         ! ones.
         phi = 0.4_qp + time_jet(t)
         links = [links, body('', place_t(2.0_qp*cos(phi), flat), flat)]
         do i = 0, c%n/2 - 1
            links = [links, body('', place_t(flat, 2.0_qp*i*sin(phi)), phi), &
                     body('', place_t(2.0_qp*cos(phi), 2.0_qp*i*sin(phi)), pi_q - phi)]
         end do
      case ('arm')
         call add_arm()
      case ('lattice')
         ! Legs, and rods that do not turn.
         phi = 1.0_qp + time_jet(t)
         do i = 1, size(c%place, 2)
            associate (place => real(c%place(:, i), qp))
               if (i <= c%legs) links = [links, body('', fixed_place(place(1), place(2)), phi)]
               if (i > c%legs) links = [links, body('', polar(fixed_place(place(1), place(2)), 1.0_qp, phi), &
                  constant_jet(place(3)))]
            end associate
         end do
      end select

   contains

      !> Link after link; the deck holds the doubles next to 0.002 and 0.001.
      subroutine add_arm()
         type(place_t) :: tip

         tip = origin
         do i = 1, c%n
            phi = real(i, qp)*(real(0.002_wp, qp) + real(0.001_wp, qp)*time_jet(t))
            links = [links, body('', tip, phi)]
            tip = polar(tip, 1.0_qp, phi)
         end do
      end subroutine add_arm
   end function exact_chain
end module bench_chains
