!> The position of a block whose Jacobian has no inverse. Its equations determine the position only to the root of the
!> rounding: along the direction k, on which they do not depend to the first order, Newton's method ends anywhere
!> within 1E-7, and wrong digits would be printed. But the point at which the Jacobian has no inverse is known in full.
!> With w and k the left and the right vector of its least singular value s, and to the second order along k
!>    w . r(x + a k) = w . r + a s + a^2 q/2,   q = w . r''[k, k],
!> this point is at a = -s/q. If the equations are satisfied there to rounding, the point is the position; otherwise the
!> position is one of the two roots near the point.
!>
!> The kind of a singular position: with w a left null vector of the Jacobian J of a block and k a right one, J x' = b
!> has solutions x' = p + l k only if w . b = 0. Otherwise it has none: the drives cannot go on at a finite velocity
!> (dead point, toggle position). A solution is the velocity of a motion only if J x'' = b2(x') has solutions too:
!> w . b2(p + l k) = 0, of second degree in l. Two real roots are two branches that cross (change point); no root is a
!> position without neighbours. A drive that turns on a dead point has b = 0 and an acceleration: two branches cross.
module singular_position
   use kinds, only: wp
   use motion, only: singular_unclear, singular_change, singular_dead
   use blocks, only: blocks_t, geometry_t, blocks_below, own_unknowns
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: find_known_parts, assemble_dense, right_hand_side
   use block_rank, only: svd_t, decomposed, residual_of, curvature_of, difference_step, gauss_newton_step, try_to_move
   use convergence, only: rounding_level
   implicit none
   private
   public :: refine_singular_position, block_singularity

   !> Larger blocks are not examined: twenty decompositions of so many rows take a second.
   integer, parameter :: max_examined_rows = 300

   !> The refined position is no further away than this over the root of q (of 1, if q is larger), in rad and units of
   !> the loop: Newton's method ends within the root of the rounding.
   real(wp), parameter :: max_shift = 64.0_wp*sqrt(epsilon(1.0_wp))
   !> A residual below this part of the level is rounding. The level is the largest of the values, `sum_size`, and the
   !> rounding of drives and earlier blocks.
   real(wp), parameter :: rounding_residual = 1.5_wp*epsilon(1.0_wp)
   !> The size of a sum of lengths that is rounded, in units of the loop.
   real(wp), parameter :: sum_size = 3.0_wp
   !> Part of the Lipschitz constant below which q counts as zero: along a motion with fixed drives q is the rounding of
   !> the second difference.
   real(wp), parameter :: least_curvature = 512.0_wp*epsilon(1.0_wp)/difference_step**2

   !> A drive whose speed takes it no further than this before it turns, in rad or units of its loop, is at rest: the
   !> speed is rounding.
   real(wp), parameter :: standstill = 64.0_wp*epsilon(1.0_wp)

   !> If w . b is up to this part of the speeds in b, the equations have solutions. Coefficients of the quadratic in l,
   !> and its discriminant, are zero up to this part. The position is singular to the root of the rounding, and w is as
   !> uncertain; at a dead point w . b is of order 1. The part is the mean of the two exponents.
   real(wp), parameter :: agreement_part = epsilon(1.0_wp)**0.25_wp

contains

   !> Moves a block from a singular position to the point at which its Jacobian has no inverse, or to the root of its
   !> equations near this point (formulas in the module's head). The block stays if neither is a position within
   !> rounding, or if it has more rows than `max_examined_rows`.
   subroutine refine_singular_position(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< with the singular position, just solved; the values of the block change
      type(svd_t) :: v
      real(wp) :: first(b%list(i)%shape%n), y(b%list(i)%shape%n), r(b%list(i)%shape%rows), q, projected_residual, level
      real(wp) :: driving(2)
      real(wp) :: jacobian(size(r)*size(first))

      if (b%list(i)%shape%rows > max_examined_rows .or. size(first) == 0) return
      first = values_of(b, i, s)
      v = decomposed(b, x, i, s)
      level = max(sum_size, maxval(abs(first)), x%blocks(i)%coarse)
      ! The rounding of angles that drives and earlier blocks give counts by its part along w: at a dead point in full,
      ! at a change point not at all.
      driving = driving_motion(b, i, s)
      if (driving(1) > 0.0_wp) then
         call assemble_dense(b, x, i, s, jacobian, r)
         call right_hand_side(b, x, i, 1, s, r)
         level = max(level, maxval(abs(s%u%value))*abs(dot_product(v%left(:, v%n), r))/driving(1))
      end if

      q = curvature_of(b, x, i, first, v%left(:, v%n), v%right(v%n, :), s)
      if (v%rank < v%n - 1 .or. abs(q) <= least_curvature*x%blocks(i)%lipschitz) return
      associate (left => v%left(:, v%n), k => v%right(v%n, :))
         call go_to(first - (v%s(v%n)/q)*k)
         projected_residual = dot_product(left, residual_of(b, x, i, y, s))
         if (abs(projected_residual) > rounding_residual*level .and. projected_residual*q < 0.0_wp) &
            call go_to(y + sign(sqrt(-2.0_wp*projected_residual/q), dot_product(first - y, k))*k)
      end associate
      if (maxval(abs(y - first)) > max_shift/sqrt(min(1.0_wp, abs(q))) .or. &
         maxval(abs(residual_of(b, x, i, y, s))) > rounding_level*level) call set_values(b, i, first, s)

   contains

      !> Gives the block values and corrects them by one Gauss-Newton step, to `y`.
      subroutine go_to(values)
         real(wp), intent(in) :: values(:)    !< (n) the values, rad or unit of the loop
         real(wp) :: before

         call set_values(b, i, values, s)
         call gauss_newton_step(b, x, i, s, before)
         y = values_of(b, i, s)
      end subroutine go_to
   end subroutine refine_singular_position

   !> Gives the largest |rate| and |acceleration| (2) of the drives that move a block, directly or through blocks on
   !> which it builds, in rad or units of the loop by time and its square. The rate of a drive counts as 0 if the drive
   !> is within `standstill` of the point at which it turns.
   function driving_motion(b, i, s) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s         !< with the drives
      real(wp) :: largest(2)
      integer, allocatable :: below(:)
      integer :: k, row

      largest = 0.0_wp
      below = blocks_below(b, i)
      do k = 1, size(below)
         do row = b%list(below(k))%first_row, b%list(below(k))%last_row
            associate (drive => s%drive_value(:, b%rows(row)%drive))
               ! The drive goes no further than rate**2/(2 acceleration) before it turns.
               if (drive(2)**2 > standstill*abs(drive(3))) largest(1) = max(largest(1), abs(drive(2)))
               largest(2) = max(largest(2), abs(drive(3)))
            end associate
         end do
      end do
   end function driving_motion

   !> Finds the kind of a singular position of a block: singular_dead (velocities do not exist), singular_change (two
   !> branches cross), or singular_unclear:
   !>
   !> - the drives of the block rest;
   !> - velocities exist, but no two branches cross;
   !> - the block can move to a singular position nearby at which velocities exist, or do not exist, as here: the drives
   !>   move nothing, or add nothing to one another;
   !> - the block has more rows than `max_examined_rows`.
   integer function block_singularity(b, x, i, s) result(found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s         !< with its singular position
      type(state_t) :: nearby
      real(wp) :: driving(2), speed
      logical :: agrees, crosses, agrees_nearby, moves(b%list(i)%last - b%list(i)%first + 1)

      found = singular_unclear
      if (b%list(i)%shape%rows > max_examined_rows) return
      driving = driving_motion(b, i, s)
      speed = merge(driving(1), sqrt(driving(2)), driving(1) > 0.0_wp)
      if (speed <= 0.0_wp) return
      nearby = s
      call classify_singularity(b, x, i, speed, nearby, agrees, crosses)
      if (agrees .and. .not. crosses) return
      nearby = s
      call try_to_move(b, x, i, nearby, moves)
      if (any(moves)) then
         call classify_singularity(b, x, i, speed, nearby, agrees_nearby, crosses)
         if (agrees_nearby .eqv. agrees) return
      end if
      found = merge(singular_change, singular_dead, agrees)
   end function block_singularity

   !> Finds whether the velocities of a block whose Jacobian has no inverse exist, and whether two branches cross, by
   !> the module's head. With several null vectors, or redundant equations, branches count as crossing if velocities
   !> exist.
   subroutine classify_singularity(b, x, i, speed, s, agrees, crosses)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      real(wp), intent(in) :: speed          !< the largest rate of its drives, or the root of their acceleration
      type(state_t), intent(inout) :: s      !< with its position; the rates of the block are overwritten
      logical, intent(out) :: agrees         !< its equations for the velocities have solutions
      logical, intent(out) :: crosses        !< two of the solutions are velocities of branches
      type(svd_t) :: v
      real(wp) :: r(b%list(i)%shape%rows), p(b%list(i)%shape%n), q(-1:1), c(0:2), unit
      real(wp) :: jacobian(size(r)*size(p))
      integer :: j

      call find_known_parts(b, x, i, s)
      v = decomposed(b, x, i, s)
      call assemble_dense(b, x, i, s, jacobian, r)
      call right_hand_side(b, x, i, 1, s, r)
      ! A position that rounding makes singular may have its least singular value above the zero level.
      agrees = norm2(matmul(r, v%left(:, min(v%rank, v%n - 1) + 1:))) <= agreement_part*speed
      crosses = agrees
      if (.not. (agrees .and. v%rows == v%n .and. v%rank >= v%n - 1)) return

      ! The coefficients of w . b2(p + l k), l in units of |p| or of `speed`, whichever is larger.
      p = 0.0_wp
      do j = 1, v%n - 1
         p = p + v%right(j, :)*(dot_product(v%left(:, j), r)/v%s(j))
      end do
      unit = max(speed, norm2(p))
      do j = -1, 1
         s%u(own_unknowns(b, i))%rate = p + j*unit*v%right(v%n, :)
         call right_hand_side(b, x, i, 2, s, r)
         q(j) = dot_product(v%left(:, v%n), r)/unit**2
      end do
      ! Two real roots, one of which may be infinite. There is none if all coefficients are zero compared with the
      ! Lipschitz constant: a drive adds nothing to the others.
      c = [q(0), 0.5_wp*(q(1) - q(-1)), 0.5_wp*(q(1) + q(-1)) - q(0)]
      crosses = maxval(abs(c)) > agreement_part*x%blocks(i)%lipschitz .and. &
         c(1)**2 - 4.0_wp*c(0)*c(2) > agreement_part*maxval(abs(c))**2
   end subroutine classify_singularity
end module singular_position
