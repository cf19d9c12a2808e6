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
   public :: jets_t, new_jets, turn, turn_errors, note_turn_error, product_error, bound_rows, bound_changes, &
      bound_loops, bound_jacobian

   integer, parameter, public :: highest = 4     !< derivative by time
   !> What of rows is bounded: what rounding and the deck's numbers leave open, that and the size, or changes by errors.
   integer, parameter, public :: of_rounding = 1, of_all = 2, of_errors = 3
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
      integer :: k

      b = 0.0_wp
      do k = 0, 2
         call note_turn_error(k, f, e, b)
      end do
   end function turn_errors

   !> Bounds `b` of the errors of its derivatives 0 to 2, where those of phi, no larger than `f`, are off by `e`: that
   !> of derivative `order`, after those of lower ones, and of the next one what comes of these alone.
   pure subroutine note_turn_error(order, f, e, b)
      integer, intent(in) :: order
      real(wp), intent(in) :: f(0:highest), e(0:highest)
      real(wp), intent(inout) :: b(0:highest)

      select case (order)
      case (0)
         b(0) = e(0)
         b(1) = f(1)*e(0)
      case (1)
         b(1) = e(1) + (f(1) + e(1))*e(0)
         b(2) = f(2)*e(0) + (2.0_wp*f(1) + e(1))*e(1) + (f(1) + e(1))**2*e(0)
      case default
         b(2) = b(2) + e(2)*(1.0_wp + e(0))
      end select
   end subroutine note_turn_error

   !> `open` (rows): what rounding and the deck's numbers leave open of derivative `order` (0 to 2) of the rows of block
   !> `i`.
   pure subroutine bound_rows(d, b, i, j, order, open)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(jets_t), intent(in) :: j
      real(wp), intent(out) :: open(*)
      integer :: k, row

      call bound_loops(of_rounding, d, b, i, j, order, open)
      do k = b%list(i)%first_row, b%list(i)%last_row
         row = k - b%list(i)%first_row + 1
         if (order == 0) open(row) = open(row) + d%constant_weight(k) + 4.0_wp*rounding*abs(b%numbers%rows(k)%constant)
         if (b%rows(k)%drive > 0) open(row) = open(row) + 8.0_wp*rounding*j%drive(order, b%rows(k)%drive)
      end do
   end subroutine bound_rows

   !> `error` (rows): by how much errors of the motion change derivative `order` (0 to 2) of the rows of block `i`.
   pure subroutine bound_changes(d, b, i, j, order, error)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, order
      type(jets_t), intent(in) :: j
      real(wp), intent(out) :: error(*)
      integer :: k, row

      call bound_loops(of_errors, d, b, i, j, order, error)
      do k = b%list(i)%first_row, b%list(i)%last_row
         row = k - b%list(i)%first_row + 1
         if (b%rows(k)%drive > 0) error(row) = error(row) + j%drive_error(order, b%rows(k)%drive)
      end do
   end subroutine bound_changes

   !> `bound` (rows) of derivative `order` of the rows of block `i`, as `what` says, without drives and constants.
   pure subroutine bound_loops(what, d, b, i, j, order, bound)
      integer, intent(in) :: what, i, order
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      type(jets_t), intent(in) :: j
      real(wp), intent(out) :: bound(*)
      real(wp) :: x
      integer :: m

      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            x = 0.0_wp
            select case (g%kind)
            case (loop_components)
               if (what == of_all) x = loop_size(d, b, m, j, order)
               if (what == of_errors) x = loop_change(d, b, m, j, order)
               if (what /= of_errors) x = x + loop_open(d, b, m, j, order)
            case (loop_projection)
               if (what == of_all) x = projection_size(d, b, m, j, order)
               if (what == of_errors) x = projection_change(d, b, m, j, order)
               if (what /= of_errors) x = x + projection_open(d, b, m, j, order)
            case default
               if (what == of_errors) x = j%own_error(order, g%orientation) + j%own_error(order, g%less)
               if (what == of_all) x = j%own(order, g%orientation) + j%own(order, g%less)
               if (what /= of_errors) x = x + 8.0_wp*rounding*(j%own(order, g%orientation) + j%own(order, g%less))
            end select
            if (g%row_x > 0) bound(g%row_x) = x
            if (g%row_y > 0) bound(g%row_y) = x
         end associate
      end do
   end subroutine bound_loops

   !> A bound of derivative `order` of the vector that closes loop `m`.
   pure real(wp) function loop_size(d, b, m, j, order)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j

      loop_size = loop_sum(b, m, j, order, d%length, d%slide_length)
      if (order == 0) loop_size = loop_size + d%ground_length(m)
   end function loop_size

   !> What rounding and the deck's numbers leave open of it.
   pure real(wp) function loop_open(d, b, m, j, order)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j

      loop_open = loop_sum(b, m, j, order, d%weight, d%slide_weight)
      if (order == 0) loop_open = loop_open + d%ground_weight(m)
   end function loop_open

   !> The sum over the vectors and slides of loop `m` of derivative `order`, each times its number of `vectors` and
   !> `slides`.
   pure real(wp) function loop_sum(b, m, j, order, vectors, slides)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j
      real(wp), intent(in) :: vectors(*), slides(*)
      integer :: k

      loop_sum = 0.0_wp
      do k = b%loops(m)%first_vector, b%loops(m)%last_vector
         loop_sum = loop_sum + vectors(k)*j%turn(order, b%body_vectors(k)%orientation)
      end do
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         associate (o => b%slides(k)%orientation, u => b%slides(k)%unknown)
            loop_sum = loop_sum + slides(k)*sum(binomial(:order, order)*j%own(:order, u)*j%turn(order:0:-1, o))
         end associate
      end do
   end function loop_sum

   !> By how much errors of the motion change it.
   pure real(wp) function loop_change(d, b, m, j, order) result(error)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j
      real(wp) :: size_of
      integer :: k

      error = 0.0_wp
      do k = b%loops(m)%first_vector, b%loops(m)%last_vector
         error = error + d%length(k)*j%turn_error(order, b%body_vectors(k)%orientation)
      end do
      do k = b%loops(m)%first_slide, b%loops(m)%last_slide
         associate (o => b%slides(k)%orientation, u => b%slides(k)%unknown)
            size_of = 0.0_wp
            call product_error(order, j%own(:, u), j%own_error(:, u), j%turn(:, o), j%turn_error(:, o), &
               d%slide_length(k), 0.0_wp, size_of, error)
         end associate
      end do
   end function loop_change

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

   !> A bound of derivative `order` of the projection of loop `m`.
   pure real(wp) function projection_size(d, b, m, j, order) result(size_of)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j
      integer :: a

      size_of = 0.0_wp
      do a = 0, order
         size_of = size_of + binomial(a, order)*j%turn(order - a, b%loops(m)%orientation)*d%direction_length(m) &
            *loop_size(d, b, m, j, a)
      end do
   end function projection_size

   !> What rounding and the deck's numbers leave open of it.
   pure real(wp) function projection_open(d, b, m, j, order) result(open)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j
      integer :: a

      open = 0.0_wp
      do a = 0, order
         open = open + binomial(a, order)*j%turn(order - a, b%loops(m)%orientation) &
            *(d%direction_length(m)*loop_open(d, b, m, j, a) + d%direction_weight(m)*loop_size(d, b, m, j, a))
      end do
   end function projection_open

   !> By how much errors of the motion change it.
   pure real(wp) function projection_change(d, b, m, j, order) result(error)
      type(proof_data_t), intent(in) :: d
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: m, order
      type(jets_t), intent(in) :: j
      integer :: a

      error = 0.0_wp
      do a = 0, order
         associate (f => j%turn(order - a, b%loops(m)%orientation), &
            e => j%turn_error(order - a, b%loops(m)%orientation))
            error = error + binomial(a, order)*d%direction_length(m)*(loop_size(d, b, m, j, a)*e &
               + loop_change(d, b, m, j, a)*(f + e))
         end associate
      end do
   end function projection_change

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
