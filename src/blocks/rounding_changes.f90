!> What roundings change, to first order, in the vector loops of blocks and in what else moves along the tree, in all
!> directions of `card_roundings` at once: derivatives by time of order 0, 1 and 2, with what is known already of the
!> changes of the unknowns.
module rounding_changes
   use kinds, only: wp
   use planar, only: rotated, quarter_turn, add_rotating, turning, scaled
   use mechanism, only: mechanism_t
   use blocks, only: blocks_t, block_loop_t
   use block_state, only: state_t
   use block_solver, only: workspace_t
   use block_engine, only: block_engine_t
   use drives, only: law_t
   use card_roundings, only: directions, card_directions, rounding, number_pair, parts_of_number
   implicit none
   private
   public :: rounding_response_t, change_loop, change_projection, change_vector, change_product, change_slide, &
      change_card, closure_motion, max_part

   integer, parameter :: binomial(0:2, 0:2) = reshape([1, 1, 1, 0, 1, 2, 0, 0, 1], [3, 3])
   !> A block's unknowns may change by this part of their distance from the next root of its equations: beyond, the
   !> first order does not hold.
   real(wp), parameter :: max_part = 0.05_wp

   !> `state` is that at which the response is asked for.
   type :: rounding_response_t
      type(state_t) :: state
      type(workspace_t) :: work
      real(wp), allocatable :: sizes(:)          !< (points + pairs) of their numbers, in the deck's unit
      real(wp), allocatable :: cards(:, :, :)    !< (card_directions, 2, points + pairs) roundings, in the same unit
      integer, allocatable :: turned_by(:)       !< (points + pairs) their orientations; -1: exact, a zero
      integer, allocatable :: pair_of(:)         !< (unknowns) prismatic pair of a slide; 0: none
      type(law_t), allocatable :: tables(:, :)   !< see `law_tables`
      real(wp), allocatable :: drive(:, :, :)    !< (directions, 0:2, 0:drives) as `state` has them
      real(wp), allocatable :: u(:, :, :)        !< (directions, 0:2, 0:unknowns)
      integer, allocatable :: missing(:)         !< (0:unknowns) missing_all: not found, or not of first order
   end type rounding_response_t

contains

   !> `g` (directions, 2): derivative number `order` of the changes of `loop`, as far as they are known; `size_of`: what
   !> is added up there, signs left aside.
   subroutine change_loop(r, m, e, loop, order, g, size_of)
      type(rounding_response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      type(block_loop_t), intent(in) :: loop
      integer, intent(in) :: order
      real(wp), intent(out) :: g(directions, 2), size_of
      integer :: k

      g = 0.0_wp
      size_of = 0.0_wp
      do k = loop%first_vector, loop%last_vector
         associate (d => e%blocks%body_vectors(k), f => r%state%u(e%blocks%body_vectors(k)%orientation))
            call change_vector(order, rotated([d%x, d%y], [f%c, f%s]), f%rate, f%acceleration, &
               r%u(:, :, d%orientation), g)
         end associate
      end do
      do k = loop%first_slide, loop%last_slide
         associate (d => e%blocks%slides(k))
            call change_slide(r, order, d%body_vector, d%orientation, d%unknown, g, size_of)
         end associate
      end do
      if (loop%vector_loop == 0) return
      do k = e%blocks%first_term(loop%vector_loop), e%blocks%first_term(loop%vector_loop + 1) - 1
         associate (term => e%blocks%terms(:, k))
            call change_card(r, m, order, term(1), term(2), 1.0_wp/(e%length*loop%unit), g, size_of)
         end associate
      end do
   end subroutine change_loop

   !> Adds to `g` (directions, 2) derivative number `order` of the change of the vector `x` (2), which turns with `rate`
   !> and `acceleration`, where its angle changes by `f` (directions, 0:2): of x, w x_t and w' x_t - w^2 x.
   pure subroutine change_vector(order, x, rate, acceleration, f, g)
      integer, intent(in) :: order
      real(wp), intent(in) :: x(2), rate, acceleration, f(directions, 0:2)
      real(wp), intent(inout) :: g(directions, 2)
      real(wp) :: a(2)

      select case (order)
      case (0)
         g(:, 1) = g(:, 1) - x(2)*f(:, 0)
         g(:, 2) = g(:, 2) + x(1)*f(:, 0)
      case (1)
         g(:, 1) = g(:, 1) - x(2)*f(:, 1) - (rate*x(1))*f(:, 0)
         g(:, 2) = g(:, 2) + x(1)*f(:, 1) - (rate*x(2))*f(:, 0)
      case default
         a = -acceleration*x - rate**2*quarter_turn(x)
         g(:, 1) = g(:, 1) - x(2)*f(:, 2) + a(1)*f(:, 0) - (2.0_wp*rate*x(1))*f(:, 1)
         g(:, 2) = g(:, 2) + x(1)*f(:, 2) + a(2)*f(:, 0) - (2.0_wp*rate*x(2))*f(:, 1)
      end select
   end subroutine change_vector

   !> The same of slide `u` times the vector `d` (2) in the axes of `orientation`, whose direction is off as the angle
   !> of its pair is; to `size_of`, its size.
   pure subroutine change_slide(r, order, d, orientation, u, g, size_of)
      type(rounding_response_t), intent(in) :: r
      integer, intent(in) :: order, orientation, u
      real(wp), intent(in) :: d(2)
      real(wp), intent(inout) :: g(directions, 2), size_of
      real(wp) :: e(2), e_t(2), f0(directions), along(directions), across(directions)

      associate (f => r%state%u(orientation), s => r%state%u(u), df => r%u(:, :, orientation), ds => r%u(:, :, u))
         e = rotated(d, [f%c, f%s])
         e_t = quarter_turn(e)
         f0 = df(:, 1)
         if (r%pair_of(u) > 0) f0 = f0 + rounding*parts_of_number(number_pair, r%pair_of(u), 2)
         select case (order)
         case (0)
            along = ds(:, 1)
            across = s%value*f0
            size_of = size_of + norm2(e)*abs(s%value)
         case (1)
            along = ds(:, 2) - (s%value*f%rate)*f0
            across = s%rate*f0 + f%rate*ds(:, 1) + s%value*df(:, 2)
            size_of = size_of + norm2(e)*(abs(s%rate) + abs(s%value*f%rate))
         case default
            along = ds(:, 3) - (2.0_wp*s%rate*f%rate + s%value*f%acceleration)*f0 - f%rate**2*ds(:, 1) &
               - (2.0_wp*s%value*f%rate)*df(:, 2)
            across = (s%acceleration - s%value*f%rate**2)*f0 + 2.0_wp*f%rate*ds(:, 2) + 2.0_wp*s%rate*df(:, 2) &
               + f%acceleration*ds(:, 1) + s%value*df(:, 3)
            size_of = size_of + norm2(e)*(abs(s%acceleration) + 2.0_wp*abs(s%rate*f%rate) &
               + abs(s%value)*(abs(f%acceleration) + f%rate**2))
         end select
      end associate
      g(:, 1) = g(:, 1) + along*e(1) + across*e_t(1)
      g(:, 2) = g(:, 2) + along*e(2) + across*e_t(2)
   end subroutine change_slide

   !> The same of the numbers of point number |`point`| or, if that is 0, of the offset of pair number |`pair`|, with
   !> their sign; `scale`: 1 over the unit of `g` in that of the deck.
   pure subroutine change_card(r, m, order, point, pair, scale, g, size_of)
      type(rounding_response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: order, point, pair
      real(wp), intent(in) :: scale
      real(wp), intent(inout) :: g(directions, 2), size_of
      real(wp) :: c(2), part
      integer :: card, k

      card = abs(point)
      if (card == 0) card = size(m%points) + abs(pair)
      if (r%turned_by(card) < 0) return
      associate (f => r%state%u(r%turned_by(card)))
         select case (order)
         case (0)
            c = [f%c, f%s]
            part = 1.0_wp
         case (1)
            c = f%rate*[-f%s, f%c]
            part = abs(f%rate)
         case default
            c = f%acceleration*[-f%s, f%c] - f%rate**2*[f%c, f%s]
            part = abs(f%acceleration) + f%rate**2
         end select
      end associate
      c = c*sign(scale, real(point + pair, wp))
      do k = 1, card_directions
         g(k, 1) = g(k, 1) + c(1)*r%cards(k, 1, card) - c(2)*r%cards(k, 2, card)
         g(k, 2) = g(k, 2) + c(2)*r%cards(k, 1, card) + c(1)*r%cards(k, 2, card)
      end do
      size_of = size_of + part*scale*r%sizes(card)
   end subroutine change_card

   !> Derivative number `order` of the change (directions) of the product x . y of two vectors (2, 0:2), which change by
   !> `dx` and `dy` (directions, 2, 0:2).
   pure function change_product(order, x, y, dx, dy) result(change)
      integer, intent(in) :: order
      real(wp), intent(in) :: x(2, 0:2), y(2, 0:2), dx(directions, 2, 0:2), dy(directions, 2, 0:2)
      real(wp) :: change(directions)
      integer :: j

      change = 0.0_wp
      do j = 0, order
         change = change + binomial(order, j)*(dx(:, 1, j)*y(1, order - j) + dx(:, 2, j)*y(2, order - j) &
            + x(1, j)*dy(:, 1, order - j) + x(2, j)*dy(:, 2, order - j))
      end do
   end function change_product

   !> `v` (directions): derivative number `order` of the change of the projection of loop number `k`, with the other
   !> sign, as far as it is known: of g . f, where f turns with an orientation and is off as the angle of `pair` is.
   !> `size_of`: what is added up there, signs left aside.
   subroutine change_projection(r, m, e, k, pair, order, v, size_of)
      type(rounding_response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      class(block_engine_t), intent(in) :: e
      integer, intent(in) :: k, pair, order
      real(wp), intent(out) :: v(directions), size_of
      real(wp), dimension(directions, 2, 0:2) :: dg, df
      real(wp) :: angle(directions, 0:2), g(2, 0:2), f(2, 0:2), part
      integer :: j

      associate (loop => e%blocks%loops(k), c => r%state%u(e%blocks%loops(k)%orientation))
         g = closure_motion(e%blocks, k, r%state)
         f = turning(rotated(loop%direction, [c%c, c%s]), [c%value, c%rate, c%acceleration])
         angle = r%u(:, :, loop%orientation)
         angle(:, 0) = angle(:, 0) + rounding*parts_of_number(number_pair, pair, 2)
         df = 0.0_wp
         size_of = 0.0_wp
         do j = 0, order
            call change_vector(j, f(:, 0), c%rate, c%acceleration, angle, df(:, :, j))
            call change_loop(r, m, e, loop, j, dg(:, :, j), part)
            size_of = size_of + binomial(order, j)*part*norm2(f(:, order - j))
         end do
         v = -change_product(order, g, f, dg, df)
      end associate
   end subroutine change_projection

   !> The closure error (2, 0:2) of loop number `m` with its derivatives.
   pure function closure_motion(b, m, s) result(g)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(state_t), intent(in) :: s
      real(wp) :: g(2, 0:2), e(2)
      integer :: k

      g = s%loop(m)%known
      do k = b%loops(m)%first_own, b%loops(m)%last_vector
         associate (f => s%u(b%body_vectors(k)%orientation))
            call add_rotating(s%own(1, k), s%own(2, k), f%rate, f%acceleration, g(:, 0), g(:, 1), g(:, 2))
         end associate
      end do
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         associate (f => s%u(b%slides(k)%orientation), u => s%u(b%slides(k)%unknown))
            e = s%guide(:, k)
            g = g + scaled([u%value, u%rate, u%acceleration], turning(e, [f%value, f%rate, f%acceleration]))
         end associate
      end do
   end function closure_motion
end module rounding_changes
