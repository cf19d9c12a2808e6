!> Proof of the motion between two positions: that over the whole interval of time each block has exactly one solution
!> in a tube about a curve, and a regular Jacobian in all of the tube.
!>
!> The curve of an unknown is the cubic with its values and rates at both ends. With F(t) what the equations are on it:
!>
!>    |F| <= max |F_end| + h/4 max |F'_end| + h^4/384 max |F''''|      (error of Hermite's interpolation)
!>
!> F and F' at the ends are of the size of rounding, F'''' is bounded by lengths and the derivatives of the cubics, and
!> what earlier blocks leave open comes to it. Exactly one solution for each time in a ball about the curve, with a
!> regular Jacobian: so these are one continuous path. Tubes of adjoining intervals have balls about the same centre
!> where they meet, so one holds the other, and their paths are one.
!>
!> First each half of the interval is tried with the inverse A of its own end, from the proof of the position there, by
!> the norms of both: nothing is computed on the curve. If that is not enough, A is the inverse of the Jacobian in the
!> middle.
module tube_proof
   use kinds, only: wp
   use drives, only: bounds_t, bounds_of
   use blocks, only: blocks_t, block_t
   use block_state, only: set_direction
   use block_equations, only: find_known_parts, assemble_dense
   use block_engine, only: block_engine_t
   use proof_data, only: rounding
   use row_bounds, only: turn, bound_loops, bound_changes, bound_jacobian, of_all, highest
   use contraction, only: radius_of
   use position_proof, only: prover_t, placed_t, contract_block, room, of_time
   implicit none
   private
   public :: tube_t, new_tube, prove_tube

   !> The tube, in the units of the blocks.
   type :: tube_t
      logical :: is_proved = .false.
      integer :: block = 0                        !< that is not
      real(wp), allocatable :: radius(:)          !< (0:unknowns)
      real(wp), allocatable :: off(:)             !< (0:unknowns) the farthest place of the curve from its middle
   end type tube_t

contains

   !> Room for a tube of the blocks `b`.
   pure function new_tube(b) result(tube)
      type(blocks_t), intent(in) :: b
      type(tube_t) :: tube

      allocate (tube%radius(0:b%unknowns), tube%off(0:b%unknowns), source=0.0_wp)
   end function new_tube

   !> Proves the motion of the blocks `list`, in solving order, between the positions `from` and `to`. If that fails,
   !> p%state is then in the middle of the curve.
   subroutine prove_tube(p, e, list, from, to, tube)
      type(prover_t), intent(inout) :: p
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: list(:)
      type(placed_t), intent(in) :: from, to
      type(tube_t), intent(inout) :: tube
      logical :: is_set, unbounded(0:size(e%laws))
      integer :: k, u

      tube%radius = 0.0_wp
      tube%is_proved = .true.
      is_set = .false.
      do k = 1, size(list)
         do u = e%blocks%list(list(k))%first, e%blocks%list(list(k))%last
            call set_curve(e%blocks, e%blocks%unknown(u))
         end do
      end do
      call bound_drives()
      do k = 1, size(list)
         if (is_unbounded(e%blocks%list(list(k)))) then
            tube%is_proved = .false.
            tube%block = list(k)
            if (.not. is_set) call set_middle(e%blocks)
         else if (e%blocks%list(list(k))%direct) then
            call prove_direct(e%blocks, list(k))
         else
            call prove_by_ends(e%blocks, list(k))
            if (tube%is_proved) cycle
            if (.not. is_set) call set_middle(e%blocks)
            is_set = .true.
            call prove_by_middle(e%blocks, list(k))
         end if
         if (.not. tube%is_proved) return
      end do

   contains

      !> Of the cubic with the values and rates `x0` and `x1` (0:1) at both ends of an interval of the length `h`:
      !> control points, which bound a polynomial, of its first and second derivatives by the part of the interval.
      !> `inexact`: what rounding leaves open of the first ones.
      pure subroutine find_control_points(h, x0, x1, first, second, inexact)
         real(wp), intent(in) :: h, x0(0:1), x1(0:1)
         real(wp), intent(out) :: first(3), second(2), inexact

         first(1) = h*x0(1)
         first(3) = h*x1(1)
         first(2) = 3.0_wp*(x1(0) - x0(0)) - first(1) - first(3)
         second(1) = 2.0_wp*(first(2) - first(1))
         second(2) = 2.0_wp*(first(3) - first(2))
         inexact = 32.0_wp*rounding*(abs(x0(0)) + abs(x1(0)) + abs(first(1)) + abs(first(3)))
      end subroutine find_control_points

      !> The middle of the cubics of the unknowns of the blocks `list` in p%state.
      subroutine set_middle(b)
         type(blocks_t), intent(in) :: b
         integer :: k, i

         do k = 1, size(list)
            do i = b%list(list(k))%first, b%list(list(k))%last
               associate (u => b%unknown(i))
                  p%state%u(u)%value = 0.5_wp*(from%x(0, u) + to%x(0, u)) &
                     + 0.125_wp*(to%t - from%t)*(from%x(1, u) - to%x(1, u))
                  call set_direction(b, u, p%state)
               end associate
            end do
         end do
      end subroutine set_middle

      !> Bounds of the derivatives of the cubic of unknown `u` by the part of the interval.
      subroutine set_curve(b, u)
         type(blocks_t), intent(in) :: b
         integer, intent(in) :: u
         real(wp) :: first(3), second(2), inexact, own(0:4)

         call find_control_points(to%t - from%t, from%x(:1, u), to%x(:1, u), first, second, inexact)
         own(0) = max(abs(from%x(0, u)), abs(to%x(0, u))) + max(abs(first(1)), abs(first(3)))
         own(1) = max(abs(first(1)), abs(first(2)), abs(first(3))) + inexact
         own(2) = max(abs(second(1)), abs(second(2))) + 2.0_wp*inexact
         own(3) = abs(second(2) - second(1)) + 4.0_wp*inexact
         own(4) = 0.0_wp
         p%jets%own(:, u) = own
         p%jets%own_error(0, u) = 0.0_wp
         tube%off(u) = (0.5_wp*own(1) + inexact)*room
         if (u > b%orientations) return
         p%jets%turn(:, u) = turn(own)
         p%jets%turn_error(0, u) = 0.0_wp
      end subroutine set_curve

      !> How far the laws of the drives can be from the cubics with their values and rates at both ends: by the range of
      !> their second derivatives, unless these are `unbounded`.
      subroutine bound_drives()
         type(bounds_t) :: law
         real(wp) :: h, first(3), second(2), inexact, late, earliest
         integer :: i

         h = to%t - from%t
         late = of_time*max(abs(from%t), abs(to%t))
         ! No rounding moves a time across 0, where some powers begin.
         earliest = min(from%t, to%t)
         earliest = merge(max(0.0_wp, earliest - late), earliest - late, earliest >= 0.0_wp)
         unbounded(0) = .false.
         do i = 1, size(e%laws)
            law = bounds_of(e%laws(i), earliest, max(from%t, to%t) + late)
            unbounded(i) = max(abs(law%low(2)), abs(law%high(2))) >= huge(1.0_wp)
            if (unbounded(i)) cycle
            call find_control_points(h, from%drive(:1, i), to%drive(:1, i), first, second, inexact)
            inexact = inexact + 4.0_wp*max(from%drive_error(0, i), to%drive_error(0, i)) &
               + 2.0_wp*(abs(h)*max(from%drive_error(1, i), to%drive_error(1, i)) &
               + 2.0_wp*late*max(abs(from%drive(1, i)), abs(to%drive(1, i)))) + 0.125_wp*h**2*p%table_error(2, i)
            p%jets%drive_error(0, i) = (0.125_wp*max(0.0_wp, law%high(2)*e%unit_of(i)*h**2 - minval(second), &
               maxval(second) - law%low(2)*e%unit_of(i)*h**2) + inexact)*room
         end do
      end subroutine bound_drives

      !> An equation of `block` has a drive whose second derivative has no bounds.
      pure logical function is_unbounded(block)
         type(block_t), intent(in) :: block

         is_unbounded = any(unbounded(e%blocks%rows(block%first_row:block%last_row)%drive))
      end function is_unbounded

      !> The direct block `i`: its unknown is another one and a drive, and so are their cubics.
      subroutine prove_direct(b, i)
         type(blocks_t), intent(in) :: b
         integer, intent(in) :: i

         associate (row => b%list(i)%first_row, u => b%unknown(b%list(i)%first))
            tube%radius(u) = (ends_open(row) + tube%radius(b%rows(row)%other) &
               + p%jets%drive_error(0, b%rows(row)%drive))*room
            call open_curve(b, u)
         end associate
      end subroutine prove_direct

      !> What Hermite's interpolation makes of what row `row` leaves open at both ends.
      pure real(wp) function ends_open(row)
         integer, intent(in) :: row

         ends_open = max(from%open(0, row), to%open(0, row)) &
            + 0.25_wp*abs(to%t - from%t)*max(from%open(1, row), to%open(1, row))
      end function ends_open

      !> Unknown `u` is known up to the radius of its tube.
      subroutine open_curve(b, u)
         type(blocks_t), intent(in) :: b
         integer, intent(in) :: u

         p%jets%own_error(0, u) = tube%radius(u)
         tube%off(u) = (tube%off(u) + tube%radius(u))*room
         if (u <= b%orientations) p%jets%turn_error(0, u) = tube%radius(u)
      end subroutine open_curve

      !> Block `i`, whose earlier blocks are proved, by what was proved at the ends; work%g are bounds of its equations
      !> on the curve.
      subroutine prove_by_ends(b, i)
         type(blocks_t), intent(in) :: b
         integer, intent(in) :: i
         real(wp) :: g, change, growth
         integer :: k

         associate (block => b%list(i), w => p%work(i), norm => max(from%norm(i), to%norm(i))*room)
            call bound_loops(of_all, p%data, b, i, p%jets, highest, w%g)
            call bound_changes(p%data, b, i, p%jets, 0, w%error)
            do k = 1, size(w%g)
               w%g(k) = (w%g(k)/384.0_wp + w%error(k) + ends_open(block%first_row + k - 1))*room
            end do
            call bound_jacobian(p%data, b, i, p%jets, tube%off, w%change, w%growth)
            ! Which equations are taken of too many may differ from end to end. What is not a number proves nothing.
            tube%is_proved = size(w%g) == size(w%x)
            g = 0.0_wp
            change = 0.0_wp
            growth = 0.0_wp
            do k = 1, size(w%g)
               tube%is_proved = tube%is_proved .and. w%g(k) + w%change(k) + w%growth(k) <= huge(1.0_wp)
               g = max(g, w%g(k))
               change = max(change, w%change(k))
               growth = max(growth, w%growth(k))
            end do
            if (tube%is_proved) call note_radius(b, i, radius_of((max(from%z1(i), to%z1(i)) + norm*change)*room, &
               norm*growth*room, norm*g*room))
         end associate
      end subroutine prove_by_ends

      !> The same by the Jacobian in the middle of the curve, where p%state is; work%g is as above.
      subroutine prove_by_middle(b, i)
         type(blocks_t), intent(in) :: b
         integer, intent(in) :: i
         real(wp) :: radius, gap

         associate (w => p%work(i))
            call find_known_parts(b, i, p%state)
            call assemble_dense(b, i, p%state, w%a, w%r)
            call contract_block(p, b, i, tube%off, radius, gap)
            call note_radius(b, i, radius)
         end associate
      end subroutine prove_by_middle

      !> The tube of block `i` has the `radius`; below 0 it is not proved.
      subroutine note_radius(b, i, radius)
         type(blocks_t), intent(in) :: b
         integer, intent(in) :: i
         real(wp), intent(in) :: radius
         integer :: k

         tube%is_proved = radius >= 0.0_wp
         tube%block = i
         if (.not. tube%is_proved) return
         do k = b%list(i)%first, b%list(i)%last
            tube%radius(b%unknown(k)) = radius
            call open_curve(b, b%unknown(k))
         end do
      end subroutine note_radius
   end subroutine prove_tube
end module tube_proof
