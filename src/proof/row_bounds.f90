!> Bounds of the equations of a block and of their derivatives by time, from bounds of the motion of its unknowns: how
!> large what is added up can be, what its rounding leaves open, and by how much errors of the motion change it.
!>
!> A vector R(phi) d and its derivatives are no longer than |d| times those of the unit vector e^(i phi); products
!> follow by Leibniz' rule. So lengths alone are added, no sine or cosine of an interval.
module row_bounds
   use kinds, only: wp
   use blocks, only: blocks_t, slide_t, loop_components, loop_projection
   use proof_data, only: proof_data_t, rounding
   use contraction, only: max_radius
   implicit none
   private
   public :: jets_t, new_jets, turn, turn_errors, product_error, bound_rows, bound_jacobian

   integer, parameter, public :: highest = 4     !< derivative by time
   real(wp), parameter :: binomial(0:4, 0:4) = reshape(real([ &
      1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 2, 1, 0, 0, 1, 3, 3, 1, 0, 1, 4, 6, 4, 1], wp), [5, 5])

   !> Bounds of derivatives 0 to 4 of each unknown, (0:4, 0:unknowns), and of the unit vector that it turns.
   type :: jets_t
      real(wp), allocatable :: own(:, :), own_error(:, :)      !< of the unknown, and of its error
      real(wp), allocatable :: turn(:, :), turn_error(:, :)    !< of the unit vector, and of its error
      real(wp), allocatable :: drive(:, :), drive_error(:, :)  !< (0:2, 0:drives) of the drives
   end type jets_t

contains

   !> Room for `unknowns` and `drives`, at rest and exact.
   pure function new_jets(unknowns, drives) result(j)
      integer, intent(in) :: unknowns, drives
      type(jets_t) :: j

      allocate (j%own(0:highest, 0:unknowns), j%own_error(0:highest, 0:unknowns), j%turn(0:highest, 0:unknowns), &
         j%turn_error(0:highest, 0:unknowns), j%drive(0:2, 0:drives), j%drive_error(0:2, 0:drives), source=0.0_wp)
      j%turn(0, :) = 1.0_wp
   end function new_jets

   !> Bounds of the derivatives of e^(i phi), from those `f` of phi.
   pure function turn(f) result(b)
      real(wp), intent(in) :: f(0:highest)
      real(wp) :: b(0:highest)

      b(0) = 1.0_wp
      b(1) = f(1)
      b(2) = f(1)**2 + f(2)
      b(3) = f(1)**3 + 3.0_wp*f(1)*f(2) + f(3)
      b(4) = f(1)**4 + 6.0_wp*f(1)**2*f(2) + 3.0_wp*f(2)**2 + 4.0_wp*f(1)*f(3) + f(4)
   end function turn

   !> Bounds of the errors of its derivatives 0 to 2, where those of phi, no larger than `f`, are off by `e`.
   pure function turn_errors(f, e) result(b)
      real(wp), intent(in) :: f(0:highest), e(0:highest)
      real(wp) :: b(0:highest)

      b = 0.0_wp
      b(0) = e(0)
      b(1) = e(1) + (f(1) + e(1))*e(0)
      b(2) = e(2) + (f(2) + e(2))*e(0) + (2.0_wp*f(1) + e(1))*e(1) + (f(1) + e(1))**2*e(0)
   end function turn_errors

   !> Of derivative `order` of the rows of block `i`: `size_of` bounds the sum of the lengths of all terms, `open` what
   !> rounding and the deck's numbers leave open of it, `error` what errors of the motion change in it; each (rows).
   pure subroutine bound_rows(d, b, i, j, order, size_of, open, error)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(jets_t), intent(in) :: j
      real(wp), intent(out) :: size_of(*), open(*), error(*)
      real(wp) :: x(3)
      integer :: m, k, row

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            select case (g%kind)
            case (loop_components)
               call bound_loop(d, b, m, j, order, x)
            case (loop_projection)
               call bound_projection(d, b, m, j, order, x)
            case default
               x(1) = j%own(order, g%orientation) + j%own(order, g%less)
               x(2) = 4.0_wp*rounding*x(1)
               x(3) = j%own_error(order, g%orientation) + j%own_error(order, g%less)
            end select
            if (g%row_x > 0) call put(x, size_of(g%row_x), open(g%row_x), error(g%row_x))
            if (g%row_y > 0) call put(x, size_of(g%row_y), open(g%row_y), error(g%row_y))
         end associate
      end do
      if (order > 2) return
      do k = b%list(i)%first_row, b%list(i)%last_row
         row = k - b%list(i)%first_row + 1
         if (order == 0) size_of(row) = size_of(row) + abs(b%rows(k)%constant)
         if (order == 0) open(row) = open(row) + d%constant_weight(k)
         size_of(row) = size_of(row) + j%drive(order, b%rows(k)%drive)
         open(row) = open(row) + 4.0_wp*rounding*(size_of(row) + j%drive(order, b%rows(k)%drive))
         error(row) = error(row) + j%drive_error(order, b%rows(k)%drive)
      end do
   end subroutine bound_rows

   !> Puts the three bounds `x` where they belong.
   pure subroutine put(x, size_of, open, error)
      real(wp), intent(in) :: x(3)
      real(wp), intent(out) :: size_of, open, error

      size_of = x(1)
      open = x(2)
      error = x(3)
   end subroutine put

   !> The same, `x` (3), of the vector that closes loop `m`.
   pure subroutine bound_loop(d, b, m, j, order, x)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j
      real(wp), intent(out) :: x(3)
      real(wp) :: open
      integer :: k

      x = 0.0_wp
      if (order == 0) x(1) = d%ground_length(m)
      if (order == 0) x(2) = d%ground_weight(m)
      do k = b%loops(m)%first_vector, b%loops(m)%last_vector
         associate (o => b%body_vectors(k)%orientation)
            x(1) = x(1) + d%length(k)*j%turn(order, o)
            x(2) = x(2) + d%weight(k)*j%turn(order, o)
            x(3) = x(3) + d%length(k)*j%turn_error(order, o)
         end associate
      end do
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         associate (o => b%slides(k)%orientation, u => b%slides(k)%unknown)
            open = 0.0_wp
            call product_error(order, j%own(:, u), j%own_error(:, u), j%turn(:, o), j%turn_error(:, o), &
               d%slide_length(k), 0.0_wp, x(1), x(3))
            call product_error(order, j%own(:, u), j%own_error(:, u), j%turn(:, o), j%turn_error(:, o), &
               d%slide_weight(k), 0.0_wp, x(2), open)
         end associate
      end do
   end subroutine bound_loop

   !> Adds to `size_of` and `error` those of derivative `order` of a product: a vector of the `length` along a unit
   !> vector that turns, by derivatives no larger than `f` and with errors up to `fe`, times a number with `s` and `se`
   !> (0:highest). `weight`: what rounding leaves open of the product, as a part of its unit.
   pure subroutine product_error(order, s, se, f, fe, length, weight, size_of, error)
      integer, intent(in) :: order
      real(wp), dimension(0:highest), intent(in) :: s, se, f, fe
      real(wp), intent(in) :: length, weight
      real(wp), intent(inout) :: size_of, error
      real(wp) :: p, e
      integer :: a

      p = 0.0_wp
      e = 0.0_wp
      do a = 0, order
         p = p + binomial(a, order)*s(a)*f(order - a)
         e = e + binomial(a, order)*(s(a)*fe(order - a) + se(a)*(f(order - a) + fe(order - a)))
      end do
      size_of = size_of + length*p
      error = error + length*e + weight*p
   end subroutine product_error

   !> The same, `x` (3), of the projection of loop `m`.
   pure subroutine bound_projection(d, b, m, j, order, x)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j
      real(wp), intent(out) :: x(3)
      real(wp) :: y(3)
      integer :: a

      x = 0.0_wp
      do a = 0, order
         call bound_loop(d, b, m, j, a, y)
         associate (length => binomial(a, order)*d%direction_length(m), &
            f => j%turn(order - a, b%loops(m)%orientation), e => j%turn_error(order - a, b%loops(m)%orientation))
            x(1) = x(1) + length*y(1)*f
            x(2) = x(2) + (length*y(2) + binomial(a, order)*d%direction_weight(m)*y(1))*f
            x(3) = x(3) + length*(y(1)*e + y(3)*(f + e))
         end associate
      end do
   end subroutine bound_projection

   !> Of the Jacobian of block `i`, for each row (rows): `change`, by how much it can differ (the sum of its entries'
   !> differences) from that computed where unknowns are off by `off` (0:unknowns); and `growth`, a bound of
   !> |J(x) - J(z)|/|x - z|, maximum norm, the sum of its second derivatives. Unknowns are within `j` or, those of the
   !> block, within `max_radius` of it.
   pure subroutine bound_jacobian(d, b, i, j, off, change, growth)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(jets_t), intent(in) :: j
      real(wp), intent(in) :: off(0:)
      real(wp), intent(out) :: change(*), growth(*)
      real(wp) :: x(2)
      integer :: m

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            x = 0.0_wp
            if (g%kind == loop_components .or. g%kind == loop_projection) &
               call bound_entries(d, b, m, j, off, x(1), x(2))
            if (g%row_x > 0) change(g%row_x) = x(1)
            if (g%row_x > 0) growth(g%row_x) = x(2)
            if (g%row_y > 0) change(g%row_y) = x(1)
            if (g%row_y > 0) growth(g%row_y) = x(2)
         end associate
      end do
   end subroutine bound_jacobian

   !> The same of a row of loop `m`.
   pure subroutine bound_entries(d, b, m, j, off, change, growth)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(jets_t), intent(in) :: j
      real(wp), intent(in) :: off(0:)
      real(wp), intent(out) :: change, growth
      real(wp) :: first, turn, guide, length
      integer :: k

      associate (g => b%loops(m))
         ! A projection turns once more.
         turn = 0.0_wp
         if (g%kind == loop_projection) turn = off(g%orientation)
         change = 0.0_wp
         ! The sum of first derivatives; second ones of a turning vector are as long.
         first = 0.0_wp
         do k = g%first_own, g%last_vector
            change = change + d%length(k)*(off(b%body_vectors(k)%orientation) + turn) + 2.0_wp*d%weight(k)
            first = first + (d%length(k) + d%weight(k))
         end do
         growth = first
         do k = g%first_slide, g%last_slide
            associate (s => b%slides(k), whole => d%slide_length(k) + d%slide_weight(k))
               length = slide_length(j, s)
               guide = d%slide_length(k)*(off(s%orientation) + turn) + 2.0_wp*d%slide_weight(k)
               if (s%column > 0) then
                  change = change + guide
                  first = first + whole
               end if
               if (s%orientation_column > 0) then
                  change = change + (length + off(s%unknown))*guide + d%slide_length(k)*off(s%unknown)
                  first = first + whole*length
                  growth = growth + whole*length
                  if (s%column > 0) growth = growth + 2.0_wp*whole
               end if
            end associate
         end do
         if (g%kind == loop_projection) call project(d, b, m, j, off, first, change, growth)
      end associate
   end subroutine bound_entries

   !> What a projection makes of the bounds of the entries of loop `m`; `first`: their sum.
   pure subroutine project(d, b, m, j, off, first, change, growth)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m
      type(jets_t), intent(in) :: j
      real(wp), intent(in) :: off(0:), first
      real(wp), intent(inout) :: change, growth
      real(wp) :: whole, whole_change, length
      integer :: k

      associate (g => b%loops(m), direction => d%direction_length(m) + d%direction_weight(m))
         change = change*direction + d%direction_weight(m)*first
         if (g%orientation_column > 0) then
            ! The entry of the angle that turns the direction is the whole loop, projected.
            whole = d%ground_length(m) + d%ground_weight(m)
            whole_change = d%ground_weight(m)
            do k = g%first_vector, g%last_vector
               whole = whole + d%length(k) + d%weight(k)
               whole_change = whole_change + d%length(k)*off(b%body_vectors(k)%orientation) + d%weight(k)
            end do
            do k = g%first_slide, g%last_slide
               associate (s => b%slides(k))
                  length = slide_length(j, s) + off(s%unknown)
                  whole = whole + (d%slide_length(k) + d%slide_weight(k))*length
                  whole_change = whole_change + d%slide_length(k)*(off(s%unknown) + length*off(s%orientation)) &
                     + d%slide_weight(k)*length
               end associate
            end do
            change = change + direction*(whole_change + whole*off(g%orientation)) + d%direction_weight(m)*whole
            ! Twice the first derivatives, and the loop itself.
            growth = growth + 2.0_wp*first + whole
         end if
         growth = growth*direction
      end associate
   end subroutine project

   !> A bound of the slide `s`.
   pure real(wp) function slide_length(j, s) result(length)
      type(jets_t), intent(in) :: j
      type(slide_t), intent(in) :: s

      length = j%own(0, s%unknown) + j%own_error(0, s%unknown)
      if (s%column > 0) length = length + max_radius
   end function slide_length
end module row_bounds
