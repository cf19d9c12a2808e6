!> What roundings change, to first order, in the vector loops of blocks and in what else moves along the tree, in all
!> directions of `card_roundings` at once: derivatives by time of order 0, 1 and 2, with what is known already of the
!> changes of the unknowns.
!>
!> In axes that turn with the rate w and the acceleration w', what changes by h, h' and h'' changes in axes at rest by
!>
!>    h,   h' + w J h,   h'' + 2 w J h' + w' J h - w^2 h,      J the quarter turn.
module rounding_changes
   use kinds, only: wp
   use planar, only: xy, rotated, quarter_turn, add_rotating, turning, scaled
   use blocks, only: blocks_t, loop_projection, loop_angles
   use block_state, only: state_t, unknown_t
   use block_solver, only: workspace_t
   use rounding_parts, only: rounding_parts_t, part_t
   use drives, only: law_t
   use card_roundings, only: directions, rounding, number_pair, parts_of_number, own_in_tables
   implicit none
   private
   public :: rounding_response_t, change_loop, add_found_angles, change_parts, change_vector, change_product, &
      change_slide, closure_motion, max_part, no_change

   integer, parameter :: binomial(0:2, 0:2) = reshape([1, 1, 1, 0, 1, 2, 0, 0, 1], [3, 3])
   !> Of the numbers of a vector.
   real(wp), parameter :: no_change(directions, 2) = 0.0_wp
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
      !> Room for the widest block: (directions, rows), (rows), (directions, 2, 0:2, loops), (0:2, loops).
      real(wp), allocatable :: v(:, :), row_size(:), g(:, :, :, :), loop_size(:, :)
   end type rounding_response_t

contains

   !> The changes `g` (directions, 2, 0:2) of loop number `k` of `blocks` or, in its first component, of its projection
   !> on a direction that is off as the angle of `guide` is, as far as they are known; `size_of` (0:2): what is added up
   !> there, signs left aside.
   pure subroutine change_loop(r, blocks, k, guide, g, size_of)
      type(rounding_response_t), intent(in) :: r
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: k, guide
      real(wp), intent(out) :: g(directions, 2, 0:2), size_of(0:2)
      integer :: i

      g = 0.0_wp
      size_of = 0.0_wp
      associate (loop => blocks%loops(k))
         if (loop%kind == loop_angles) then
            g(:, 1, :) = r%u(:, :, loop%orientation) - r%u(:, :, loop%less)
            return
         end if
         call change_parts(r%parts%first(k), r%parts%first(k + 1) - 1, r%parts%parts, r%state%u, r%u, g, size_of)
         do i = loop%first_slide, loop%last_slide
            associate (d => blocks%slides(i))
               call change_slide(xy(blocks%numbers%e(i)), r%pair_of(d%unknown), r%state%u(d%orientation), &
                  r%state%u(d%unknown), &
                  r%u(:, :, d%orientation), r%u(:, :, d%unknown), g, size_of)
            end associate
         end do
         if (loop%kind == loop_projection) call project(r, blocks, k, guide, g, size_of)
      end associate
   end subroutine change_loop

   !> Adds to `g` (directions, 2, 0:2) and to `size_of` (0:2) what `parts` number `first` to `last` change by, which
   !> turn with orientations among `s` that change by `u`. On plain arrays, which cost no descriptors.
   pure subroutine change_parts(first, last, parts, s, u, g, size_of)
      integer, intent(in) :: first, last
      type(part_t), intent(in) :: parts(*)
      type(unknown_t), intent(in) :: s(0:*)
      real(wp), intent(in) :: u(directions, 0:2, 0:*)
      real(wp), intent(inout) :: g(directions, 2, 0:2), size_of(0:2)
      integer :: i

      do i = first, last
         associate (p => parts(i), f => s(parts(i)%orientation))
            size_of(0) = size_of(0) + p%size_of
            if (p%orientation == 0) then
               g(:, :, 0) = g(:, :, 0) + p%change
            else
               size_of(1) = size_of(1) + p%size_of*abs(f%rate)
               size_of(2) = size_of(2) + p%size_of*(abs(f%acceleration) + f%rate**2)
               call change_vector(p%vector, p%change, [f%c, f%s], f%rate, f%acceleration, u(1, 0, p%orientation), g)
            end if
         end associate
      end do
   end subroutine change_parts

   !> Adds to `g` (directions, 2, 0:2) the change of the vector `d` (2) in axes whose x axis is `e` (2) and that turn
   !> with `rate` and `acceleration`, where it changes by `change` (directions, 2) and the angle by `f` (directions,
   !> 0:2).
   pure subroutine change_vector(d, change, e, rate, acceleration, f, g)
      real(wp), intent(in) :: d(2), change(directions, 2), e(2), rate, acceleration, f(directions, 0:2)
      real(wp), intent(inout) :: g(directions, 2, 0:2)
      real(wp) :: x(2), square, x_0, y_0, x_1, y_1
      integer :: k

      x = rotated(d, e)
      square = rate**2
      do k = 1, directions
         x_0 = e(1)*change(k, 1) - e(2)*change(k, 2) - x(2)*f(k, 0)
         y_0 = e(2)*change(k, 1) + e(1)*change(k, 2) + x(1)*f(k, 0)
         x_1 = -x(2)*f(k, 1)
         y_1 = x(1)*f(k, 1)
         g(k, 1, 0) = g(k, 1, 0) + x_0
         g(k, 2, 0) = g(k, 2, 0) + y_0
         g(k, 1, 1) = g(k, 1, 1) + x_1 - rate*y_0
         g(k, 2, 1) = g(k, 2, 1) + y_1 + rate*x_0
         g(k, 1, 2) = g(k, 1, 2) - x(2)*f(k, 2) - 2.0_wp*rate*y_1 - acceleration*y_0 - square*x_0
         g(k, 2, 2) = g(k, 2, 2) + x(1)*f(k, 2) + 2.0_wp*rate*x_1 + acceleration*x_0 - square*y_0
      end do
   end subroutine change_vector

   !> Adds to derivatives `order` + 1 and higher of `g` (directions, 2, 0:2) what derivative number `order` of the
   !> angles changes there that turn `parts` number `first` to `last`.
   pure subroutine add_found_angles(order, first, last, parts, s, u, g)
      integer, intent(in) :: order, first, last
      type(part_t), intent(in) :: parts(*)
      type(unknown_t), intent(in) :: s(0:*)
      real(wp), intent(in) :: u(directions, 0:2, 0:*)
      real(wp), intent(inout) :: g(directions, 2, 0:2)
      real(wp) :: x(2), v(2), a(2)
      integer :: i, k

      do i = first, last
         associate (f => s(parts(i)%orientation), df => u(:, order, parts(i)%orientation))
            x = rotated(parts(i)%vector, [f%c, f%s])
            v = -(order + 1)*f%rate*x
            a = -f%acceleration*x - f%rate**2*quarter_turn(x)
            do k = 1, directions
               g(k, 1, order + 1) = g(k, 1, order + 1) + v(1)*df(k)
               g(k, 2, order + 1) = g(k, 2, order + 1) + v(2)*df(k)
            end do
            if (order > 0) cycle
            do k = 1, directions
               g(k, 1, 2) = g(k, 1, 2) + a(1)*df(k)
               g(k, 2, 2) = g(k, 2, 2) + a(2)*df(k)
            end do
         end associate
      end do
   end subroutine add_found_angles

   !> The same of slide `s` times the vector `d` (2) in the axes that turn as `f` does, whose direction is off as the
   !> angle of `pair` is, if it has one: angle and slide change by `df` and `ds` (directions, 0:2). To `size_of` (0:2),
   !> its size.
   pure subroutine change_slide(d, pair, f, s, df, ds, g, size_of)
      integer, intent(in) :: pair
      real(wp), intent(in) :: d(2), df(directions, 0:2), ds(directions, 0:2)
      type(unknown_t), intent(in) :: f, s
      real(wp), intent(inout) :: g(directions, 2, 0:2), size_of(0:2)
      real(wp) :: e(2), f0(directions), square
      real(wp), dimension(directions, 0:2) :: across, x, y
      integer :: k

      e = rotated(d, [f%c, f%s])
      square = f%rate**2
      f0 = df(:, 0)
      if (pair > 0) f0 = f0 + rounding*parts_of_number(number_pair, pair, 2)
      ! In axes that turn: along the guide `ds`, and across.
      across(:, 0) = s%value*f0
      across(:, 1) = s%rate*f0 + s%value*df(:, 1)
      across(:, 2) = s%acceleration*f0 + 2.0_wp*s%rate*df(:, 1) + s%value*df(:, 2)
      x = ds
      y = across
      x(:, 1) = x(:, 1) - f%rate*across(:, 0)
      y(:, 1) = y(:, 1) + f%rate*ds(:, 0)
      x(:, 2) = x(:, 2) - 2.0_wp*f%rate*across(:, 1) - f%acceleration*across(:, 0) - square*ds(:, 0)
      y(:, 2) = y(:, 2) + 2.0_wp*f%rate*ds(:, 1) + f%acceleration*ds(:, 0) - square*across(:, 0)
      do k = 0, 2
         g(:, 1, k) = g(:, 1, k) + x(:, k)*e(1) - y(:, k)*e(2)
         g(:, 2, k) = g(:, 2, k) + x(:, k)*e(2) + y(:, k)*e(1)
      end do
      size_of = size_of + norm2(e)*[abs(s%value), abs(s%rate) + abs(s%value*f%rate), abs(s%acceleration) &
         + 2.0_wp*abs(s%rate*f%rate) + abs(s%value)*(abs(f%acceleration) + square)]
   end subroutine change_slide

   !> Replaces the first component of the changes `g` of loop number `k`, and what is added up there, `size_of`, by
   !> those of its projection g . f, where f turns with an orientation and is off as the angle of the pair `guide` is.
   pure subroutine project(r, blocks, k, guide, g, size_of)
      type(rounding_response_t), intent(in) :: r
      type(blocks_t), intent(in) :: blocks
      integer, intent(in) :: k, guide
      real(wp), intent(inout) :: g(directions, 2, 0:2), size_of(0:2)
      real(wp) :: df(directions, 2, 0:2), angle(directions, 0:2), closure(2, 0:2), f(2, 0:2), lengths(0:2)
      integer :: order

      associate (loop => blocks%loops(k), c => r%state%u(blocks%loops(k)%orientation))
         closure = closure_motion(blocks, k, r%state)
         f = turning(rotated(xy(blocks%numbers%loops(k)%direction), [c%c, c%s]), [c%value, c%rate, c%acceleration])
         angle = r%u(:, :, loop%orientation)
         angle(:, 0) = angle(:, 0) + rounding*parts_of_number(number_pair, guide, 2)
         df = 0.0_wp
         call change_vector(xy(blocks%numbers%loops(k)%direction), no_change, [c%c, c%s], c%rate, c%acceleration, &
            angle, df)
      end associate
      lengths = [norm2(f(:, 0)), norm2(f(:, 1)), norm2(f(:, 2))]
      do order = 2, 0, -1
         g(:, 1, order) = change_product(order, closure, f, g, df)
         size_of(order) = sum(binomial(order, :order)*size_of(:order)*lengths(order:0:-1))
      end do
   end subroutine project

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

   !> The closure error (2, 0:2) of loop number `m` with its derivatives.
   pure function closure_motion(b, m, s) result(g)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(state_t), intent(in) :: s
      real(wp) :: g(2, 0:2), e(2)
      integer :: k

      do k = 0, 2
         g(:, k) = xy(s%loop(m)%known(k))
      end do
      do k = b%loops(m)%first_own, b%loops(m)%last_vector
         associate (f => s%u(b%body_vectors(k)%orientation))
            call add_rotating(s%own(k)%x, s%own(k)%y, f%rate, f%acceleration, g(:, 0), g(:, 1), g(:, 2))
         end associate
      end do
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         associate (f => s%u(b%slides(k)%orientation), u => s%u(b%slides(k)%unknown))
            e = xy(s%guide(k))
            g = g + scaled([u%value, u%rate, u%acceleration], turning(e, [f%value, f%rate, f%acceleration]))
         end associate
      end do
   end function closure_motion
end module rounding_changes
