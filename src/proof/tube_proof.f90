!> Proof of the motion between two positions: that over the whole interval of time each block has exactly one solution
!> in a tube about a curve, and a regular Jacobian in all of the tube.
!>
!> The curve of an unknown is the cubic with its values and rates at both ends. With F(t) what the equations are on it:
!>
!>    |F| <= max |F_end| + h/4 max |F'_end| + h^4/384 max |F''''|      (error of Hermite's interpolation)
!>
!> F and F' at the ends are of the size of rounding, F'''' is bounded by lengths and the derivatives of the cubics, and
!> what earlier blocks leave open comes to it. A is the inverse of the Jacobian in the middle. Exactly one solution for
!> each time in a ball about the curve, with a regular Jacobian: so these are one continuous path. Tubes of adjoining
!> intervals have balls about the same centre where they meet, so one holds the other, and their paths are one.
module tube_proof
   use kinds, only: wp
   use law_bounds, only: bounds_t, bounds_of
   use blocks, only: blocks_t
   use block_state, only: set_direction, find_known_parts
   use block_equations, only: assemble_dense
   use block_engine, only: block_engine_t
   use proof_data, only: rounding
   use row_bounds, only: turn, bound_rows
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

   !> Proves the motion of the blocks `list`, in solving order, between the positions `from` and `to`; p%state is then
   !> in the middle of the curve.
   subroutine prove_tube(p, e, list, from, to, tube)
      type(prover_t), intent(inout) :: p
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: list(:)
      type(placed_t), intent(in) :: from, to
      type(tube_t), intent(inout) :: tube
      integer :: k, u

      tube%radius = 0.0_wp
      tube%is_proved = .true.
      do k = 1, size(list)
         do u = e%blocks%list(list(k))%first, e%blocks%list(list(k))%last
            call set_curve(p, e%blocks, e%blocks%unknown(u), from, to, tube)
         end do
      end do
      call bound_drives(p, e, from, to)
      do k = 1, size(list)
         if (e%blocks%list(list(k))%direct) then
            call prove_direct(p, e%blocks, list(k), from, to, tube)
         else
            call prove_block(p, e%blocks, list(k), from, to, tube)
         end if
         if (.not. tube%is_proved) return
      end do
   end subroutine prove_tube

   !> Of the cubic with the values and rates `x0` and `x1` (0:1) at both ends of an interval of the length `h`: control
   !> points, which bound a polynomial, of its first and second derivatives by the part of the interval. `inexact`: what
   !> rounding leaves open of the first ones.
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

   !> The middle of the cubic of unknown `u` in p%state, and bounds of its derivatives by the part of the interval.
   subroutine set_curve(p, b, u, from, to, tube)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: u
      type(placed_t), intent(in) :: from, to
      type(tube_t), intent(inout) :: tube
      real(wp) :: first(3), second(2), inexact, own(0:4)

      call find_control_points(to%t - from%t, from%x(:1, u), to%x(:1, u), first, second, inexact)
      p%state%u(u)%value = 0.5_wp*(from%x(0, u) + to%x(0, u)) + 0.125_wp*(first(1) - first(3))
      call set_direction(b, u, p%state)
      own(0) = max(abs(from%x(0, u)), abs(to%x(0, u))) + max(abs(first(1)), abs(first(3)))
      own(1) = max(abs(first(1)), abs(first(2)), abs(first(3))) + inexact
      own(2) = max(abs(second(1)), abs(second(2))) + 2.0_wp*inexact
      own(3) = abs(second(2) - second(1)) + 4.0_wp*inexact
      own(4) = 0.0_wp
      p%jets%own(:, u) = own
      p%jets%own_error(:, u) = 0.0_wp
      tube%off(u) = (0.5_wp*own(1) + inexact)*room
      if (u > b%orientations) return
      p%jets%turn(:, u) = turn(own)
      p%jets%turn_error(:, u) = 0.0_wp
   end subroutine set_curve

   !> How far the laws of the drives can be from the cubics with their values and rates at both ends: by the range of
   !> their second derivatives.
   subroutine bound_drives(p, e, from, to)
      type(prover_t), intent(inout) :: p
      type(block_engine_t), intent(in) :: e
      type(placed_t), intent(in) :: from, to
      type(bounds_t) :: law
      real(wp) :: h, first(3), second(2), inexact, late
      integer :: i

      h = to%t - from%t
      late = of_time*max(abs(from%t), abs(to%t))
      do i = 1, size(e%laws)
         law = bounds_of(e%laws(i), min(from%t, to%t) - late, max(from%t, to%t) + late)
         call find_control_points(h, from%drive(:1, i), to%drive(:1, i), first, second, inexact)
         inexact = inexact + 4.0_wp*max(from%drive_error(0, i), to%drive_error(0, i)) &
            + 2.0_wp*(abs(h)*max(from%drive_error(1, i), to%drive_error(1, i)) &
            + 2.0_wp*late*max(abs(from%drive(1, i)), abs(to%drive(1, i)))) + 0.125_wp*h**2*p%table_error(2, i)
         p%jets%drive_error(0, i) = (0.125_wp*max(0.0_wp, law%high(2)*e%unit_of(i)*h**2 - minval(second), &
            maxval(second) - law%low(2)*e%unit_of(i)*h**2) + inexact)*room
      end do
   end subroutine bound_drives

   !> The direct block `i`: its unknown is another one and a drive, and so are their cubics.
   subroutine prove_direct(p, b, i, from, to, tube)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(placed_t), intent(in) :: from, to
      type(tube_t), intent(inout) :: tube

      associate (row => b%list(i)%first_row, u => b%unknown(b%list(i)%first))
         tube%radius(u) = (ends_open(from, to, row) + tube%radius(b%rows(row)%other) &
            + p%jets%drive_error(0, b%rows(row)%drive))*room
         call open_curve(p, b, u, tube)
      end associate
   end subroutine prove_direct

   !> What Hermite's interpolation makes of what row `row` leaves open at both ends.
   pure real(wp) function ends_open(from, to, row)
      type(placed_t), intent(in) :: from, to
      integer, intent(in) :: row

      ends_open = max(from%open(0, row), to%open(0, row)) &
         + 0.25_wp*abs(to%t - from%t)*max(from%open(1, row), to%open(1, row))
   end function ends_open

   !> Unknown `u` is known up to the radius of its tube.
   pure subroutine open_curve(p, b, u, tube)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: u
      type(tube_t), intent(inout) :: tube

      p%jets%own_error(0, u) = tube%radius(u)
      tube%off(u) = (tube%off(u) + tube%radius(u))*room
      if (u <= b%orientations) p%jets%turn_error(0, u) = tube%radius(u)
   end subroutine open_curve

   !> Block `i`, whose earlier blocks are proved.
   subroutine prove_block(p, b, i, from, to, tube)
      type(prover_t), intent(inout) :: p
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(placed_t), intent(in) :: from, to
      type(tube_t), intent(inout) :: tube
      real(wp) :: radius, gap
      integer :: k

      associate (block => b%list(i), w => p%work(i))
         call bound_rows(p%data, b, i, p%jets, 4, w%size_of, w%open, w%error)
         w%g(:) = (w%size_of + w%open)/384.0_wp
         call bound_rows(p%data, b, i, p%jets, 0, w%size_of, w%open, w%error)
         do k = 1, size(w%g)
            w%g(k) = (w%g(k) + w%error(k) + ends_open(from, to, block%first_row + k - 1))*room
         end do
         call find_known_parts(b, i, p%state)
         call assemble_dense(b, i, p%state, w%a, w%r)
         call contract_block(p, b, i, tube%off, radius, gap)
         tube%is_proved = radius >= 0.0_wp
         if (.not. tube%is_proved) then
            tube%block = i
            return
         end if
         do k = block%first, block%last
            tube%radius(b%unknown(k)) = radius
            call open_curve(p, b, b%unknown(k), tube)
         end do
      end associate
   end subroutine prove_block
end module tube_proof
