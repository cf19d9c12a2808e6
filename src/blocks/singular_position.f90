!> The position of a block whose Jacobian has no inverse. Its equations determine the position only to the root of the
!> rounding: along the direction k in which they say nothing to the first order, Newton's method ends anywhere within
!> 1E-7, and digits would be printed that are wrong. But the place at which the Jacobian itself has no inverse is known
!> in full. With w and k on the left and the right of its least singular value s, and to the second order along k
!>    w . r(x + a k) = w . r + a s + a^2 q/2,   q = w . r''[k, k],
!> it is at a = -s/q. If the equations are satisfied there, as far as rounding can tell, that place is the position;
!> otherwise the position is one of the two roots near it.
!>
!> The kind of a singular position: with w a left null vector of the Jacobian J of a block and k a right one, J x' = b
!> has solutions x' = p + l k only if w . b = 0. Otherwise there is none: the drives cannot go on at a finite velocity
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

   !> Larger blocks are not examined: twenty decompositions take a second for these.
   integer, parameter :: max_examined_rows = 300

   !> This over the root of the second derivative, 1 at most, is the largest distance of the place, in rad and units of
   !> the loop.
   real(wp), parameter :: furthest_place = 64.0_wp*sqrt(epsilon(1.0_wp))
   !> A residual below this part of the level is rounding. The level is the largest of: the values, a sum of lengths,
   !> and the rounding of drives and earlier blocks.
   real(wp), parameter :: rounding_residual = 1.5_wp*epsilon(1.0_wp)
   !> A sum of lengths counts as so many, in units of the loop.
   real(wp), parameter :: sum_size = 3.0_wp
   !> Part of the Lipschitz constant below which the second derivative counts as zero: along a motion with the drives
   !> held it is the rounding of the difference.
   real(wp), parameter :: least_curvature = 512.0_wp*epsilon(1.0_wp)/difference_step**2

   !> A drive whose speed takes it no further than this before it turns, in rad or lengths, is at rest.
   real(wp), parameter :: standstill = 64.0_wp*epsilon(1.0_wp)

   !> Up to this part of b along w, over the speeds that enter it, the equations agree. Up to this part the coefficients
   !> above and their discriminant are zero. A singular position is known to the root of the rounding, and so is w; at a
   !> dead point that part is of order 1: the mean of the exponents.
   real(wp), parameter :: agreement_part = epsilon(1.0_wp)**0.25_wp

contains

   !> Moves a block from a singular position to the place at which its Jacobian has no inverse, or to the root of its
   !> equations near this place. If neither is a position, the block stays.
   subroutine refine_singular_position(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(inout) :: s      !< with the singular position, just solved
      type(svd_t) :: v
      real(wp) :: first(b%list(i)%shape%n), y(b%list(i)%shape%n), r(b%list(i)%shape%rows), q, projected_residual, level
      real(wp) :: driving(2)
      real(wp) :: jacobian(size(r)*size(first))

      if (b%list(i)%shape%rows > max_examined_rows .or. size(first) == 0) return
      first = values_of(b, i, s)
      v = decomposed(b, x, i, s)
      level = max(sum_size, maxval(abs(first)), x%blocks(i)%coarse)
      ! A rounding of an angle that drives and earlier blocks give counts along w: at a dead point in full. At a change
      ! point it does not count, since such an angle leaves that as it is to the first order.
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
      if (maxval(abs(y - first)) > furthest_place/sqrt(min(1.0_wp, abs(q))) .or. &
         maxval(abs(residual_of(b, x, i, y, s))) > rounding_level*level) call set_values(b, i, first, s)

   contains

      !> Puts the block at a place, and corrects it as far as the equations determine it: then `y`.
      subroutine go_to(place)
         real(wp), intent(in) :: place(:)    !< (n) rad or unit of the loop
         real(wp) :: before

         call set_values(b, i, place, s)
         call gauss_newton_step(b, x, i, s, before)
         y = values_of(b, i, s)
      end subroutine go_to
   end subroutine refine_singular_position

   !> Gives the largest rate and acceleration (rad, lengths) of the drives that move a block, itself or through blocks
   !> below it. The rate is 0 if they rest, or if only rounding tells them from the turning point of a motion with their
   !> accelerations.
   function driving_motion(b, i, s) result(largest)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s
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

   !> Tells which singular position a block has. The kind is unclear if all that moves the block is at rest. It is also
   !> unclear if the links can move to a place nearby with an equal judgement: a drive moves nothing, or adds nothing.
   integer function block_singularity(b, x, i, s) result(found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      type(state_t), intent(in) :: s         !< with its singular position
      type(state_t) :: aside
      real(wp) :: driving(2), speed
      logical :: agrees, crosses, agrees_aside, moves(b%list(i)%last - b%list(i)%first + 1)

      found = singular_unclear
      if (b%list(i)%shape%rows > max_examined_rows) return
      driving = driving_motion(b, i, s)
      speed = merge(driving(1), sqrt(driving(2)), driving(1) > 0.0_wp)
      if (speed <= 0.0_wp) return
      aside = s
      call classify_singularity(b, x, i, speed, aside, agrees, crosses)
      if (agrees .and. .not. crosses) return
      aside = s
      call try_to_move(b, x, i, aside, moves)
      if (any(moves)) then
         call classify_singularity(b, x, i, speed, aside, agrees_aside, crosses)
         if (agrees_aside .eqv. agrees) return
      end if
      found = merge(singular_change, singular_dead, agrees)
   end function block_singularity

   !> Judges the velocities of a block whose Jacobian has no inverse. With several null vectors it is not examined
   !> whether branches cross: they are taken to.
   subroutine classify_singularity(b, x, i, speed, s, agrees, crosses)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i               !< the number of the block
      real(wp), intent(in) :: speed          !< the largest rate of its drives, or the root of their acceleration
      type(state_t), intent(inout) :: s      !< with its position; its rates are overwritten
      logical, intent(out) :: agrees         !< its equations for the velocities have solutions
      logical, intent(out) :: crosses        !< two of them are velocities of branches
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

      ! The coefficients of w . b2(p + l k) in the module's head, l in units of the velocities p or of `speed`.
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
