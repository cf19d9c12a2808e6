!> Tests. A scheme that grows by the dice: links, pairs and drives, whose numbers are taken from an assembly that is
!> there first.
module scheme_builder
   use kinds, only: wp
   use quad_jet, only: qp, jet_t, pi_q, constant_jet
   use dice, only: dice_t, throw, chance, between, disorder
   use mechanism, only: drive_relangle
   use schemes, only: scheme_t, link_t, point_t, pair_t, group_t, body_t, form_any, form_parallelogram, &
      angle_unit, link_at, place, set_trigonometry, double
   use dyad_forms, only: solve_dyad, choose_side
   use group_newton, only: outcome_t, solve_group
   implicit none
   private
   public :: builder_t, new_builder, add_link, add_links, add_point, join, number, square, begin_group, end_group
   public :: anywhere, place_on_base, pick_base, world, shuffle

   type :: builder_t
      type(dice_t) :: dice
      type(scheme_t) :: s
      type(body_t), allocatable :: b(:)        !< the assembly
      type(group_t) :: group                   !< the group that is being made
      real(qp) :: scale = 1.0_qp               !< a length of the mechanism
      real(qp) :: centre(2) = 0.0_qp, size = 1.0_qp !< where the group's joints are: so far from a place, times 3
      real(wp) :: special = 0.0_wp             !< share of right angles and whole coordinates
      real(wp) :: shared = 0.0_wp              !< share of joints that lie on others
      real(qp) :: t = 0.0_qp                   !< the first instant
      real(qp) :: from = 0.0_qp, to = 0.0_qp   !< the range of all instants
      integer :: part = 1                      !< the independent mechanism that is being made,
      integer :: first_link = 1                !< and its first link
      real(qp) :: inverse = 1.0_qp             !< the largest norm of an inverse Jacobian in the assembly
   end type builder_t

   !> A dyad is kept where its margin is above this, another group where the norm of the inverse is below that.
   real(qp), parameter :: least_margin = 0.04_qp, largest_inverse = 60.0_qp, largest_wide_inverse = 1000.0_qp
   integer, parameter :: wide = 12

contains

   !> Nothing yet, by these `dice`.
   function new_builder(dice) result(d)
      type(dice_t), intent(in) :: dice
      type(builder_t) :: d

      d%dice = dice
      allocate (d%s%links(0), d%s%points(0), d%s%pairs(0), d%s%drives(0), d%s%groups(0), d%s%at(0), d%b(0))
   end function new_builder

   !> A number in the range from `low` to `high`.
   real(qp) function number(d, low, high)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: low, high

      number = between(d%dice, real(low, wp), real(high, wp))
   end function number

   !> A way up to `reach` along either axis.
   function square(d, reach) result(p)
      type(builder_t), intent(inout) :: d
      real(qp), intent(in) :: reach
      real(qp) :: p(2)

      p(1) = number(d, -reach, reach)
      p(2) = number(d, -reach, reach)
   end function square

   !> A place of the group's region.
   function anywhere(d) result(p)
      type(builder_t), intent(inout) :: d
      real(qp) :: p(2)

      p = square(d, 3.0_qp)
      if (chance(d%dice, d%special)) p = anint(p)
      p = d%centre + d%size*p
   end function anywhere

   real(qp) function some_angle(d) result(angle)
      type(builder_t), intent(inout) :: d

      angle = number(d, -pi_q, pi_q)
      if (chance(d%dice, d%special)) angle = pi_q/2.0_qp*anint(angle/(pi_q/2.0_qp))
   end function some_angle

   !> The number that the deck has for the angle `x` in radians, in the deck's unit.
   elemental real(qp) function to_deck(x, unit)
      real(qp), intent(in) :: x, unit

      to_deck = double(x/unit)
   end function to_deck

   !> A link anywhere, as the deck's numbers give it.
   integer function add_link(d, is_ground) result(l)
      type(builder_t), intent(inout) :: d
      logical, intent(in) :: is_ground
      type(link_t) :: link
      type(body_t) :: b

      link%ground = is_ground
      link%at(:2) = double(anywhere(d))
      link%at(3) = to_deck(some_angle(d), angle_unit(d%s))*angle_unit(d%s)
      link%estimate = link%at
      link%centre = d%centre
      link%reach = 3.0_qp*d%size
      d%s%links = [d%s%links, link]
      b%x = constant_jet(link%at(1))
      b%y = constant_jet(link%at(2))
      b%phi = constant_jet(link%at(3))
      call set_trigonometry(b)
      d%b = [d%b, b]
      l = size(d%s%links)
   end function add_link

   !> The number of the first of `n` new links.
   integer function add_links(d, n, is_ground) result(first)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: n
      logical, intent(in) :: is_ground
      integer :: k

      do k = 1, n
         first = add_link(d, is_ground) - n + 1
      end do
   end function add_links

   !> A point of `link` at the place `where` of the assembly.
   integer function add_point(d, link, where) result(p)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: link
      real(qp), intent(in) :: where(2)
      real(qp) :: u(2)

      associate (b => d%b(link))
         u = where - [b%x%v, b%y%v]
         u = double([u(1)*b%c%v + u(2)*b%s%v, u(2)*b%c%v - u(1)*b%s%v])
      end associate
      d%s%points = [d%s%points, point_t(link, u)]
      p = size(d%s%points)
   end function add_point

   !> The place of a point in the assembly.
   function world(d, point) result(p)
      type(builder_t), intent(in) :: d
      integer, intent(in) :: point
      real(qp) :: p(2)
      type(jet_t) :: q(2)

      q = place(d%b(link_at(d%s, point)), d%s%points(point)%offset)
      p = q%v
   end function world

   !> A pair of links `i` and `j` at `where`, in this order or the other; some, instead, at an old joint or at the
   !> origin of one of the two.
   subroutine join(d, i, j, is_prismatic, where)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: i, j
      logical, intent(in) :: is_prismatic
      real(qp), intent(in) :: where(2)
      type(pair_t) :: pair
      integer :: link(2)
      real(qp) :: e(2), one(2), other(2), theta

      link = merge([i, j], [j, i], chance(d%dice, 0.5_wp))
      one = where
      if (d%shared > 0.0_wp) call share_place(d, link, one)
      pair%prismatic = is_prismatic
      pair%point_i = add_point(d, link(1), one)
      other = one
      if (is_prismatic) then
         pair%alpha = to_deck(some_angle(d), angle_unit(d%s))
         theta = d%b(link(1))%phi%v + pair%alpha*angle_unit(d%s)
         e = [cos(theta), sin(theta)]
         other = one + d%size*number(d, -2.0_qp, 2.0_qp)*e
         if (.not. chance(d%dice, d%special)) other = other + d%size*number(d, -1.0_qp, 1.0_qp)*[-e(2), e(1)]
      end if
      pair%point_j = add_point(d, link(2), other)
      if (is_prismatic) then
         other = world(d, pair%point_i) - world(d, pair%point_j)
         pair%h = double(other(2)*e(1) - other(1)*e(2))
         if (abs(pair%h) < 1.0e-14_qp*d%size) pair%h = 0.0_qp
         pair%beta = to_deck(d%b(link(2))%phi%v - d%b(link(1))%phi%v, angle_unit(d%s))
      end if
      d%s%pairs = [d%s%pairs, pair]
   end subroutine join

   !> Now and then `where` becomes the place of an old joint, or of the origin, of one of two links.
   subroutine share_place(d, link, where)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: link(2)
      real(qp), intent(inout) :: where(2)
      integer :: k

      if (.not. chance(d%dice, d%shared)) return
      if (size(d%s%points) > 0 .and. chance(d%dice, 0.4_wp)) then
         k = throw(d%dice, size(d%s%points))
         if (any(link_at(d%s, k) == link)) where = world(d, k)
      else
         associate (b => d%b(link(throw(d%dice, 2))))
            where = [b%x%v, b%y%v]
         end associate
      end if
   end subroutine share_place

   !> A link that a group may hang on: the ground, or one of the mechanism that is being made.
   integer function pick_base(d) result(l)
      type(builder_t), intent(inout) :: d
      integer :: k

      do k = 1, 100
         l = d%first_link - 1 + throw(d%dice, d%group%links(1) - d%first_link)
         if (.not. d%s%links(l)%ground) return
         if (chance(d%dice, 0.4_wp)) return
      end do
   end function pick_base

   !> A place for a joint on link `l`.
   function place_on_base(d, l) result(p)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: l
      real(qp) :: p(2)

      if (d%s%links(l)%reach < d%size) then
         p = d%s%links(l)%centre + d%s%links(l)%reach*square(d, 1.0_qp)
      else
         p = anywhere(d)
      end if
   end function place_on_base

   !> Links, points and pairs in any order on the cards.
   subroutine shuffle(d)
      type(builder_t), intent(inout) :: d

      d%s%link_order = disorder(d%dice, size(d%s%links))
      d%s%point_order = disorder(d%dice, size(d%s%points))
      d%s%pair_order = disorder(d%dice, size(d%s%pairs))
   end subroutine shuffle

   subroutine begin_group(d, form)
      type(builder_t), intent(inout) :: d
      integer, intent(in) :: form
      type(group_t) :: new

      new%form = form
      new%links(1) = size(d%s%links) + 1
      new%pairs(1) = size(d%s%pairs) + 1
      new%drives(1) = size(d%s%drives) + 1
      new%part = d%part
      new%scale = d%size
      d%group = new
   end subroutine begin_group

   !> The group is complete; `kept`: it is not near a singularity.
   subroutine end_group(d, kept)
      type(builder_t), intent(inout) :: d
      logical, intent(out) :: kept
      type(outcome_t) :: o
      type(jet_t) :: margin

      associate (g => d%group)
         g%links(2) = size(d%s%links)
         g%pairs(2) = size(d%s%pairs)
         g%drives(2) = size(d%s%drives)
         call find_bases(d)
         if (g%form == form_any) then
            call solve_group(d%s, g, d%t, max(1.0e-20_qp, 256*epsilon(1.0_qp)), d%b, o)
            kept = o%converged .and. o%inverse < merge(largest_wide_inverse, largest_inverse, &
               g%links(2) - g%links(1) + 1 >= wide)
            if (kept) d%inverse = max(d%inverse, real(o%inverse, qp))
         else if (g%form == form_parallelogram) then
            kept = .true.
         else
            call choose_side(d%s, g, d%b)
            call solve_dyad(d%s, g, d%b, margin)
            kept = margin%v > least_margin
         end if
         if (.not. kept) return
         d%s%links(g%links(1):g%links(2))%group = size(d%s%groups) + 1
         d%s%groups = [d%s%groups, g]
      end associate
   end subroutine end_group

   !> The links outside the group that its pairs and drives name.
   subroutine find_bases(d)
      type(builder_t), intent(inout) :: d
      integer :: k

      associate (g => d%group)
         allocate (g%bases(0))
         do k = g%pairs(1), g%pairs(2)
            call add_base(g, link_at(d%s, d%s%pairs(k)%point_i))
            call add_base(g, link_at(d%s, d%s%pairs(k)%point_j))
         end do
         do k = g%drives(1), g%drives(2)
            if (d%s%drives(k)%kind /= drive_relangle) cycle
            call add_base(g, d%s%drives(k)%subject)
            call add_base(g, d%s%drives(k)%second)
         end do
      end associate
   end subroutine find_bases

   subroutine add_base(g, link)
      type(group_t), intent(inout) :: g
      integer, intent(in) :: link

      if (link >= g%links(1) .and. link <= g%links(2)) return
      if (any(g%bases == link)) return
      g%bases = [g%bases, link]
   end subroutine add_base
end module scheme_builder
