!> Proof of the motion between two positions: that over the whole interval of time each block has exactly one solution
!> in a tube about a curve, and a regular Jacobian in all of the tube.
!>
!> The curve of an unknown is the cubic with its values and rates at both ends. The equations on the curve, F(t), have
!> the bound
!>
!>    |F| <= max |F_end| + h/4 max |F'_end| + h^2/16 |F'' - c|
!>
!> for any constant c: c is the middle of a ball that holds F'' (Peano's kernel of Hermite's interpolation, whose
!> integral is at most 1/16). F and F' at the ends are of the size of rounding; F'' = J x'' - b by the equations of the
!> accelerations, in balls that hold the cubics and their derivatives. The change of F with the errors of earlier blocks
!> is the right-hand side of the velocities, if these are balls about 0 with the radii of the tubes.
!>
!> For each time there is exactly one solution in a ball about the curve, with a regular Jacobian: all these solutions
!> are one continuous path. At the time at which tubes of adjoining intervals meet, their balls have one centre. One of
!> the balls holds the other, and therefore their paths are one.
module tube_proof
   use kinds, only: wp
   use drives, only: bounds_t, bounds_of
   use blocks, only: blocks_t
   use drive_path, only: drive_path_t
   use balls, only: ball_t, rounding, room
   use ball_equations, only: ball_numbers_t, ball_state_t, unknown_t, set_ball, set_radius, ball_accelerations
   use position_proof, only: proved_position_t, block_work_t, contract, find_ball, subtract_product
   use ball_numbers, only: number_error
   implicit none
   private
   public :: tube_t, prove_tube

   !> The tube, in the units of the blocks.
   type :: tube_t
      integer :: block = 0                        !< number of the first block that is not proved; 0: all are proved
      real(wp), allocatable :: radius(:)          !< (0:unknowns) of the balls about the curve, rad or unit of the block
      type(ball_state_t) :: curve                 !< holds the curves and, of blocks that are proved, their tubes
      !> `curve` with other rates, which are balls about 0: of unknowns with radius(:), of drives with bounds of the
      !> distance of their laws from their cubics.
      type(ball_state_t) :: balls
   end type tube_t

contains

   !> Proves the motion of the needed blocks between two positions by one tube. The proof ends at the first block that
   !> is not proved.
   subroutine prove_tube(numbers, b, path, from, to, tube)
      type(ball_numbers_t), intent(in) :: numbers   !< the geometry in balls
      type(blocks_t), intent(in) :: b
      type(drive_path_t), intent(in) :: path   !< of the drives
      type(proved_position_t), intent(in) :: from, to   !< proved positions at different times
      type(tube_t), intent(inout) :: tube   !< of the structure; then with radii, or tube%block
      logical :: unbounded(0:size(path%laws))
      type(ball_t) :: c(0:2)
      real(wp) :: h, radius
      integer :: k, j

      h = to%t - from%t
      tube%radius = 0.0_wp
      ! No equation depends on unknowns of later blocks, but some hold them with factors that cancel: any value serves.
      tube%curve%u(:) = unknown_t()
      tube%balls%u(:) = unknown_t()
      call bound_drives()

      do k = 1, size(b%needed)
         tube%block = b%needed(k)
         associate (block => b%list(tube%block), &
            own => b%unknown(b%list(tube%block)%first:b%list(tube%block)%last))
            if (any(unbounded(b%rows(block%first_row:block%last_row)%drive))) return
            do j = 1, size(own)
               associate (u => own(j))
                  c = cubic(h, [from%u(u)%value%mid, from%u(u)%rate%mid], [to%u(u)%value%mid, to%u(u)%rate%mid])
                  call set_ball(b, u, c(0), tube%curve)
                  tube%curve%u(u)%rate = c(1)
                  tube%curve%u(u)%acceleration = c(2)
                  tube%balls%u(u) = tube%curve%u(u)
               end associate
            end do

            if (block%explicit) then
               ! The unknown is the sum of another unknown and a drive, and its cubic is the sum of their cubics.
               associate (row => b%rows(block%first_row))
                  radius = (end_residual(block%first_row) + tube%radius(row%other) &
                     + tube%balls%drive(1, row%drive)%radius)*room
               end associate
            else
               call prove_block(tube%block, own, radius)
            end if
            if (radius < 0.0_wp) return

            tube%radius(own) = radius
            do j = 1, size(own)
               associate (u => own(j))
                  call set_radius(b, u, (tube%curve%u(u)%value%radius + radius)*room, tube%curve)
                  tube%balls%u(u) = tube%curve%u(u)
                  tube%balls%u(u)%rate = ball_t(0.0_wp, radius)
               end associate
            end do
         end associate
      end do
      tube%block = 0

   contains

      !> Bounds the distance of the laws of the drives from their cubics, by the range of their second derivatives, as
      !> rates of the drives in tube%balls. Laws without a bound are `unbounded`.
      subroutine bound_drives()
         type(bounds_t) :: law
         type(ball_t) :: c(0:2)
         real(wp) :: late, earliest, change
         integer :: i

         late = number_error*max(abs(from%t), abs(to%t))
         ! No rounding moves a time across 0, where some powers begin.
         earliest = min(from%t, to%t)
         earliest = merge(max(0.0_wp, earliest - late), earliest - late, earliest >= 0.0_wp)
         unbounded(0) = .false.
         do i = 1, size(path%laws)
            law = bounds_of(path%laws(i), earliest, max(from%t, to%t) + late, .false.)
            unbounded(i) = max(abs(law%low(2)), abs(law%high(2))) >= huge(1.0_wp)
            if (unbounded(i)) cycle
            c = cubic(h, from%drive(:1, i)%mid, to%drive(:1, i)%mid)
            change = c(2)%radius + max(0.0_wp, law%high(2)*path%unit(i) - c(2)%mid, &
               c(2)%mid - law%low(2)*path%unit(i))
            tube%balls%drive(1, i) = ball_t(0.0_wp, (0.125_wp*h**2*change &
               + 4.0_wp*max(from%drive(0, i)%radius, to%drive(0, i)%radius) &
               + 2.0_wp*abs(h)*max(from%drive(1, i)%radius, to%drive(1, i)%radius) &
               + 4.0_wp*late*max(abs(from%drive(1, i)%mid), abs(to%drive(1, i)%mid)))*room)
         end do
      end subroutine bound_drives

      !> Bounds the part of |F| that comes from the residuals at both ends, by Hermite's interpolation (module's head),
      !> in the unit of the loop or rad.
      pure real(wp) function end_residual(row)
         integer, intent(in) :: row          !< number of the row of the equation

         end_residual = (max(from%open(0, row), to%open(0, row)) &
            + 0.25_wp*abs(h)*max(from%open(1, row), to%open(1, row)))*room
      end function end_residual

      !> Finds the radius of the tube of a block whose earlier blocks are proved.
      subroutine prove_block(i, own, radius)
         integer, intent(in) :: i            !< number of the block
         integer, intent(in) :: own(:)       !< (n) numbers of its unknowns
         real(wp), intent(out) :: radius     !< rad or unit of the block; -1: no tube is proved
         type(block_work_t) :: w
         logical :: exists
         integer :: k

         radius = -1.0_wp
         call contract(b, numbers, i, tube%curve, w, exists)
         if (.not. exists) return
         call ball_accelerations(b, i, tube%curve, w%v)
         call subtract_product(2, tube%curve%u, own, w)
         do k = 1, size(w%open)
            w%open(k) = (h**2/16.0_wp*w%v(k)%radius + end_residual(b%list(i)%first_row + k - 1))*room
         end do
         call find_ball(b, numbers, i, tube%balls, w, maxval(tube%radius), radius)
      end subroutine prove_block
   end subroutine prove_tube

   !> Gives balls (0:2) that hold a cubic in an interval of time, and its first and second derivatives. They hold the
   !> control points of the polynomials (Bernstein), which bound these.
   pure function cubic(length, x0, x1) result(c)
      real(wp), intent(in) :: length         !< the length of the interval, not 0; below 0: back in time
      real(wp), intent(in) :: x0(0:1), x1(0:1)   !< value and rate of the cubic at its beginning and at its end
      type(ball_t) :: c(0:2)
      real(wp) :: first(3), second(2), inexact

      first = [length*x0(1), 3.0_wp*(x1(0) - x0(0)) - length*x0(1) - length*x1(1), length*x1(1)]
      second = 2.0_wp*[first(2) - first(1), first(3) - first(2)]
      inexact = 32.0_wp*rounding*(abs(x0(0)) + abs(x1(0)) + abs(first(1)) + abs(first(3)))
      c(0) = hull([x0(0), x0(0) + first(1)/3.0_wp, x1(0) - first(3)/3.0_wp, x1(0)], inexact, 1.0_wp)
      c(1) = hull(first, inexact, length)
      c(2) = hull(second, 2.0_wp*inexact, length**2)
   end function cubic

   !> Gives a ball that holds several numbers, each divided by one divisor.
   pure type(ball_t) function hull(numbers, inexact, divisor)
      real(wp), intent(in) :: numbers(:)     !< (1 or more) in one unit
      real(wp), intent(in) :: inexact        !< bound of their errors, in this unit
      real(wp), intent(in) :: divisor        !< not 0, in any unit

      hull = ball_t(0.5_wp*(minval(numbers) + maxval(numbers))/divisor, (0.5_wp*(maxval(numbers) - minval(numbers)) + &
         inexact)/abs(divisor)*room)
   end function hull
end module tube_proof
