!> The position of a block where its Jacobian has no inverse. Its equations determine that to the root of the rounding
!> only: along the direction k in which they say nothing to the first order, Newton's method ends anywhere within 1E-7,
!> and digits would be printed that are wrong. But where the Jacobian itself has no inverse is known in full: with w and
!> k on the left and the right of its least singular value s, and to the second order along k
!>    w . r(x + a k) = w . r + a s + a^2 q/2,   q = w . r''[k, k],
!> that is at a = -s/q. If the equations are satisfied there, as far as rounding can tell, that is the position;
!> otherwise it is one of the two roots beside it.
!>
!> What a singular position is: with w a left null vector of the Jacobian J of a block and k a right one, J x' = b has
!> solutions x' = p + l k only where w . b = 0. Elsewhere there is none: the drives cannot go on at a finite velocity
!> (dead point, toggle position). Of the solutions those are velocities of a motion for which J x'' = b2(x') has
!> solutions too: w . b2(p + l k) = 0, of second degree in l. Two real roots are two branches that cross (change point);
!> no root is a position without neighbours.
module singular_position
   use kinds, only: wp
   use motion, only: singular_unclear, singular_change, singular_dead
   use blocks, only: blocks_t, geometry_t, blocks_below, own_unknowns
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: find_known_parts, assemble_dense, right_hand_side
   use block_rank, only: svd_t, decomposed, residual_of, curvature_of, difference, gauss_newton_step, &
      try_to_move
   implicit none
   private
   public :: settle, driving_speed, block_singularity

   !> Of larger blocks it is not asked where they are singular, nor how: twenty decompositions take a second for these.
   integer, parameter :: max_rows = 300

   !> The largest distance of the place, over the root of the second derivative.
   real(wp), parameter :: furthest = 64.0_wp*sqrt(epsilon(1.0_wp))
   !> What the equations may leave open, of the largest value, of a sum of lengths, which counts as so many, or of what
   !> drives and earlier blocks have rounded: less is nothing but rounding, more would be no position.
   real(wp), parameter :: closed = 1.5_wp*epsilon(1.0_wp), near = 12.0_wp*epsilon(1.0_wp), sum_size = 3.0_wp
   !> Part of the Lipschitz constant below which the second derivative counts as zero, as it is but for the rounding of
   !> the difference along a motion with the drives held.
   real(wp), parameter :: least_curvature = 512.0_wp*epsilon(1.0_wp)/difference**2

   !> A drive whose speed takes it no further than this before it turns, in rad or lengths, is at rest.
   real(wp), parameter :: standstill = 64.0_wp*epsilon(1.0_wp)

   !> A part of b along w, over the speeds that enter it, up to which the equations agree; likewise the coefficients
   !> above and their discriminant, up to which they are zero. A singular position is known to the root of the rounding,
   !> and so is w; at a dead point that part is of order 1: the mean of the exponents.
   real(wp), parameter :: agreement = epsilon(1.0_wp)**0.25_wp

contains

   !> Moves block `i` from the singular position of `s`, where it has just been solved, to the place where its Jacobian
   !> has no inverse, or to the root of its equations beside that.
   subroutine settle(b, x, i, s)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      type(svd_t) :: v
      real(wp) :: first(b%list(i)%shape%n), y(b%list(i)%shape%n), r(b%list(i)%shape%rows), q, left_open, level, speed
      real(wp) :: jacobian(size(r)*size(first))

      if (b%list(i)%shape%rows > max_rows .or. size(first) == 0) return
      first = values_of(b, i, s)
      v = decomposed(b, x, i, s)
      level = max(sum_size, maxval(abs(first)), x%blocks(i)%coarse)
      ! A rounding of an angle that drives and earlier blocks give counts along w: at a dead point in full, at a change
      ! point, which such an angle leaves as it is to the first order, not at all.
      speed = driving_speed(b, i, s)
      if (speed > 0.0_wp) then
         call assemble_dense(b, x, i, s, jacobian, r)
         call right_hand_side(b, x, i, 1, s, r)
         level = max(level, maxval(abs(s%u%value))*abs(dot_product(v%left(:, v%n), r))/speed)
      end if
      q = curvature_of(b, x, i, first, v%left(:, v%n), v%right(v%n, :), s)
      if (v%rank < v%n - 1 .or. abs(q) <= least_curvature*x%blocks(i)%lipschitz) return
      associate (left => v%left(:, v%n), k => v%right(v%n, :))
         call go_to(first - (v%s(v%n)/q)*k)
         left_open = dot_product(left, residual_of(b, x, i, y, s))
         if (abs(left_open) > closed*level .and. left_open*q < 0.0_wp) &
            call go_to(y + sign(sqrt(-2.0_wp*left_open/q), dot_product(first - y, k))*k)
      end associate
      if (maxval(abs(y - first)) > furthest/sqrt(min(1.0_wp, abs(q))) .or. &
         maxval(abs(residual_of(b, x, i, y, s))) > near*level) call set_values(b, i, first, s)

   contains

      !> The values are `place`, but for what the equations determine otherwise: then `y`.
      subroutine go_to(place)
         real(wp), intent(in) :: place(:)
         real(wp) :: before

         call set_values(b, i, place, s)
         call gauss_newton_step(b, x, i, s, before)
         y = values_of(b, i, s)
      end subroutine go_to
   end subroutine settle

   !> The largest rate (rad, lengths) of the drives that move block `i`, itself or through what it builds on; 0 where
   !> they rest, or where rounding alone tells them from the turning point of a motion with their accelerations.
   real(wp) function driving_speed(b, i, s) result(speed)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      integer, allocatable :: below(:)
      integer :: k, row

      speed = 0.0_wp
      below = blocks_below(b, i)
      do k = 1, size(below)
         do row = b%list(below(k))%first_row, b%list(below(k))%last_row
            associate (drive => s%drive_value(:, b%rows(row)%drive))
               ! It goes no further than rate**2/(2 acceleration) before it turns.
               if (drive(2)**2 > standstill*abs(drive(3))) speed = max(speed, abs(drive(2)))
            end associate
         end do
      end do
   end function driving_speed

   !> Tells which singular position `s` is for block `i`. Unclear if all that moves the block is at rest, or if the
   !> judgement is equal at a place nearby to which its links can move: a drive moves nothing, or adds nothing.
   integer function block_singularity(b, x, i, s) result(found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      type(state_t) :: aside
      real(wp) :: speed
      logical :: agrees, crosses, agrees_aside, moves(b%list(i)%last - b%list(i)%first + 1)

      found = singular_unclear
      if (b%list(i)%shape%rows > max_rows) return
      speed = driving_speed(b, i, s)
      if (speed <= 0.0_wp) return
      aside = s
      call judge(b, x, i, speed, aside, agrees, crosses)
      if (agrees .and. .not. crosses) return
      aside = s
      call try_to_move(b, x, i, aside, moves)
      if (any(moves)) then
         call judge(b, x, i, speed, aside, agrees_aside, crosses)
         if (agrees_aside .eqv. agrees) return
      end if
      found = merge(singular_change, singular_dead, agrees)
   end function block_singularity

   !> `agrees`: the equations of block `i` for the velocities have solutions at `s`, whose Jacobian has no inverse;
   !> `crosses`: two of them are those of branches. Of several null vectors that is not asked: they are taken to cross.
   !> `speed`: see `driving_speed`. The rates of the block in `s` are overwritten.
   subroutine judge(b, x, i, speed, s, agrees, crosses)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i
      real(wp), intent(in) :: speed
      type(state_t), intent(inout) :: s
      logical, intent(out) :: agrees, crosses
      type(svd_t) :: v
      real(wp) :: r(b%list(i)%shape%rows), p(b%list(i)%shape%n), q(-1:1), c(0:2), unit
      real(wp) :: jacobian(size(r)*size(p))
      integer :: j

      call find_known_parts(b, x, i, s)
      v = decomposed(b, x, i, s)
      call assemble_dense(b, x, i, s, jacobian, r)
      call right_hand_side(b, x, i, 1, s, r)
      ! A position that rounding makes singular may have its least singular value above the zero level.
      agrees = norm2(matmul(r, v%left(:, min(v%rank, v%n - 1) + 1:))) <= agreement*speed
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
      ! Two real roots, one of which may be infinite; none where all coefficients are zero beside the Lipschitz
      ! constant, as they are where a drive adds nothing to the others.
      c = [q(0), 0.5_wp*(q(1) - q(-1)), 0.5_wp*(q(1) + q(-1)) - q(0)]
      crosses = maxval(abs(c)) > agreement*x%blocks(i)%lipschitz .and. &
         c(1)**2 - 4.0_wp*c(0)*c(2) > agreement*maxval(abs(c))**2
   end subroutine judge
end module singular_position
