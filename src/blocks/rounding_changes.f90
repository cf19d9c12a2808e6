!> What roundings change, to first order, in the vector loops of blocks and in what else moves along the tree, in all
!> directions of `card_roundings` at once: derivatives by time of order 0, 1 and 2, with what is known already of the
!> changes of the unknowns.
module rounding_changes
   use kinds, only: wp
   use planar, only: rotated, quarter_turn, add_rotating, turning, scaled
   use blocks, only: blocks_t
   use block_state, only: state_t, unknown_t
   use block_solver, only: workspace_t
   use rounding_parts, only: rounding_parts_t, part_t
   use drives, only: law_t
   use card_roundings, only: directions, rounding, number_pair, parts_of_number, own_in_tables
   implicit none
   private
   public :: rounding_response_t, change_loop, change_projection, change_parts, change_vector, change_product, &
      change_slide, closure_motion, max_part

   integer, parameter :: binomial(0:2, 0:2) = reshape([1, 1, 1, 0, 1, 2, 0, 0, 1], [3, 3])
   !> A block's unknowns may change by this part of their distance from the next root of its equations: beyond, the
   !> first order does not hold.
   real(wp), parameter :: max_part = 0.05_wp

   !> `state` is that at which the response is asked for, `own` the part of the calculation's own roundings that counts.
   type :: rounding_response_t
      real(wp) :: own = own_in_tables
      type(state_t) :: state
      type(workspace_t) :: work
      type(rounding_parts_t) :: parts
      integer, allocatable :: pair_of(:)         !< (unknowns) prismatic pair of a slide; 0: none
      type(law_t), allocatable :: tables(:, :)   !< see `law_tables`
      real(wp), allocatable :: drive(:, :, :)    !< (directions, 0:2, 0:drives) as `state` has them
      real(wp), allocatable :: u(:, :, :)        !< (directions, 0:2, 0:unknowns)
      integer, allocatable :: missing(:)         !< (0:unknowns) missing_all: not found, or not of first order
      real(wp), allocatable :: v(:, :), size_of(:)   !< (directions, rows), (rows) room for the widest block
   end type rounding_response_t

contains

   !> `g` (directions, 2): derivative number `order` of the changes of loop number `k` of `blocks`, as far as they are
   !> known; `size_of`: what is added up there, signs left aside.
   pure subroutine change_loop(r, blocks, k, order, g, size_of)
      type(rounding_response_t), intent(in) :: r
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: k, order
      real(wp), intent(out) :: g(directions, 2), size_of
      integer :: i

      g = 0.0_wp
      size_of = 0.0_wp
      call change_parts(order, r%parts%first(k), r%parts%first(k + 1) - 1, r%parts%parts, r%state%u, r%u, g, size_of)
      do i = blocks%loops(k)%first_slide, blocks%loops(k)%last_slide
         associate (d => blocks%slides(i))
            call change_slide(order, d%body_vector, r%pair_of(d%unknown), r%state%u(d%orientation), &
               r%state%u(d%unknown), r%u(:, :, d%orientation), r%u(:, :, d%unknown), g, size_of)
         end associate
      end do
   end subroutine change_loop

   !> Adds to `g` (directions, 2) and to `size_of` what `parts` number `first` to `last` change by, which turn with
   !> orientations among `s` that change by `u`. On plain arrays, which cost no descriptors.
   pure subroutine change_parts(order, first, last, parts, s, u, g, size_of)
      integer, intent(in) :: order, first, last
      type(part_t), intent(in) :: parts(*)
      type(unknown_t), intent(in) :: s(0:*)
      real(wp), intent(in) :: u(directions, 0:2, 0:*)
      real(wp), intent(inout) :: g(directions, 2), size_of
      integer :: i

      do i = first, last
         associate (p => parts(i), f => s(parts(i)%orientation))
            ! What turns with the ground does not.
            if (p%orientation == 0 .and. order > 0) cycle
            if (p%orientation > 0 .and. p%length > 0.0_wp) &
               call change_vector(order, rotated(p%vector, [f%c, f%s]), f%rate, f%acceleration, u(1, 0, p%orientation), g)
            if (p%off > 0.0_wp) call change_cards(order, p, f, g, size_of)
         end associate
      end do
   end subroutine change_parts

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

   !> The same of what roundings of the cards change of `part`, which turns as `f` does; to `size_of`, the sizes of these.
   pure subroutine change_cards(order, part, f, g, size_of)
      integer, intent(in) :: order
      type(part_t), intent(in) :: part
      type(unknown_t), intent(in) :: f
      real(wp), intent(inout) :: g(directions, 2), size_of
      real(wp) :: c(2), times
      integer :: k

      select case (order)
      case (0)
         c = [f%c, f%s]
         times = 1.0_wp
      case (1)
         c = f%rate*[-f%s, f%c]
         times = abs(f%rate)
      case default
         c = f%acceleration*[-f%s, f%c] - f%rate**2*[f%c, f%s]
         times = abs(f%acceleration) + f%rate**2
      end select
      do k = 1, directions
         g(k, 1) = g(k, 1) + c(1)*part%change(k, 1) - c(2)*part%change(k, 2)
         g(k, 2) = g(k, 2) + c(2)*part%change(k, 1) + c(1)*part%change(k, 2)
      end do
      size_of = size_of + times*part%size_of
   end subroutine change_cards

   !> The same of slide `s` times the vector `d` (2) in the axes that turn as `f` does, whose direction is off as the
   !> angle of `pair` is, if it has one: angle and slide change by `df` and `ds` (directions, 0:2). To `size_of`, its
   !> size.
   pure subroutine change_slide(order, d, pair, f, s, df, ds, g, size_of)
      integer, intent(in) :: order, pair
      real(wp), intent(in) :: d(2), df(directions, 0:2), ds(directions, 0:2)
      type(unknown_t), intent(in) :: f, s
      real(wp), intent(inout) :: g(directions, 2), size_of
      real(wp) :: e(2), e_t(2), f0(directions), along(directions), across(directions)

      e = rotated(d, [f%c, f%s])
      e_t = quarter_turn(e)
      f0 = df(:, 0)
      if (pair > 0) f0 = f0 + rounding*parts_of_number(number_pair, pair, 2)
      select case (order)
      case (0)
         along = ds(:, 0)
         across = s%value*f0
         size_of = size_of + norm2(e)*abs(s%value)
      case (1)
         along = ds(:, 1) - (s%value*f%rate)*f0
         across = s%rate*f0 + f%rate*ds(:, 0) + s%value*df(:, 1)
         size_of = size_of + norm2(e)*(abs(s%rate) + abs(s%value*f%rate))
      case default
         along = ds(:, 2) - (2.0_wp*s%rate*f%rate + s%value*f%acceleration)*f0 - f%rate**2*ds(:, 0) &
            - (2.0_wp*s%value*f%rate)*df(:, 1)
         across = (s%acceleration - s%value*f%rate**2)*f0 + 2.0_wp*f%rate*ds(:, 1) + 2.0_wp*s%rate*df(:, 1) &
            + f%acceleration*ds(:, 0) + s%value*df(:, 2)
         size_of = size_of + norm2(e)*(abs(s%acceleration) + 2.0_wp*abs(s%rate*f%rate) &
            + abs(s%value)*(abs(f%acceleration) + f%rate**2))
      end select
      g(:, 1) = g(:, 1) + along*e(1) + across*e_t(1)
      g(:, 2) = g(:, 2) + along*e(2) + across*e_t(2)
   end subroutine change_slide

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

   !> `v` (directions): derivative number `order` of the change of the projection of loop number `k` of `blocks`, as far
   !> as it is known: of g . f, where f turns with an orientation and is off as the angle of `pair` is. `size_of`: what is
   !> added up there, signs left aside.
   pure subroutine change_projection(r, blocks, k, pair, order, v, size_of)
      type(rounding_response_t), intent(in) :: r
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: k, pair, order
      real(wp), intent(out) :: v(directions), size_of
      real(wp), dimension(directions, 2, 0:2) :: dg, df
      real(wp) :: angle(directions, 0:2), g(2, 0:2), f(2, 0:2), part
      integer :: j

      associate (loop => blocks%loops(k), c => r%state%u(blocks%loops(k)%orientation))
         g = closure_motion(blocks, k, r%state)
         f = turning(rotated(loop%direction, [c%c, c%s]), [c%value, c%rate, c%acceleration])
         angle = r%u(:, :, loop%orientation)
         angle(:, 0) = angle(:, 0) + rounding*parts_of_number(number_pair, pair, 2)
         df = 0.0_wp
         size_of = 0.0_wp
         do j = 0, order
            call change_vector(j, f(:, 0), c%rate, c%acceleration, angle, df(:, :, j))
            call change_loop(r, blocks, k, j, dg(:, :, j), part)
            size_of = size_of + binomial(order, j)*part*norm2(f(:, order - j))
         end do
         v = change_product(order, g, f, dg, df)
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
