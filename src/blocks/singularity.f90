!> What a singular position is. With w a left null vector of the Jacobian J of a block and k a right one, J x' = b has
!> solutions x' = p + l k only where w . b = 0. Elsewhere there is none: the drives cannot go on at a finite velocity
!> (dead point, toggle position). Of the solutions those are velocities of a motion for which J x'' = b2(x') has
!> solutions too: w . b2(p + l k) = 0, of second degree in l. Two real roots are two branches that cross (change point);
!> no root is a position without neighbours.
module singularity
   use kinds, only: wp
   use motion, only: singular_unclear, singular_change, singular_dead
   use blocks, only: blocks_t, largest_known
   use block_state, only: state_t
   use block_equations, only: find_known_parts, right_hand_side
   use block_sizes, only: find_driven
   use block_rank, only: values_t, decomposed, moving_unknowns
   use singular_place, only: max_rows
   use block_engine, only: block_engine_t
   implicit none
   private
   public :: judge_blocks, block_singularity

   !> A part of b along w, over the speeds that enter it, up to which the equations agree; likewise the coefficients
   !> above and their discriminant, up to which they are zero. A singular position is known to the root of the rounding,
   !> and so is w; at a dead point that part is of order 1: the mean of the exponents.
   real(wp), parameter :: agreement = epsilon(1.0_wp)**0.25_wp

contains

   !> (blocks) Judges the position that `e` has found last for each block: one of singular_...; -1 if the block is not
   !> singular, or builds on a singular one and so has no right-hand side of its own.
   function judge_blocks(e) result(found)
      type(block_engine_t), intent(in) :: e
      integer :: found(size(e%blocks%list))
      integer :: missing(0:e%blocks%unknowns), before, k

      found = -1
      missing = 0
      do k = 1, size(e%needed)
         associate (i => e%needed(k), b => e%blocks%list(e%needed(k)))
            before = largest_known(e%blocks, i, missing)
            if (before == 0 .and. e%is_singular(i)) found(i) = block_singularity(e%blocks, i, e%state)
            missing(e%blocks%unknown(b%first:b%last)) = max(before, merge(1, 0, e%is_singular(i)))
         end associate
      end do
   end function judge_blocks

   !> Tells which singular position `s` is for block `i`. Unclear if all that moves the block is at rest, or if the
   !> judgement is equal at a place nearby to which its links can move: a drive moves nothing, or adds nothing.
   integer function block_singularity(b, i, s) result(found)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(in) :: s
      type(state_t) :: aside
      real(wp) :: speed, angle
      logical :: agrees, crosses, agrees_aside

      found = singular_unclear
      if (b%list(i)%shape%rows > max_rows) return
      aside = s
      call find_driven(b, i, s, speed, angle)
      if (speed <= 0.0_wp) return
      call judge(b, i, speed, aside, agrees, crosses)
      if (agrees .and. .not. crosses) return
      if (any(moving_unknowns(b, i, s, aside))) then
         call judge(b, i, speed, aside, agrees_aside, crosses)
         if (agrees_aside .eqv. agrees) return
      end if
      found = merge(singular_change, singular_dead, agrees)
   end function block_singularity

   !> `agrees`: the equations of block `i` for the velocities have solutions at `s`, whose Jacobian has no inverse;
   !> `crosses`: two of them are those of branches. Of several null vectors that is not asked: they are taken to cross.
   !> `speed`: see `find_driven`. The rates of the block in `s` are overwritten.
   subroutine judge(b, i, speed, s, agrees, crosses)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: speed
      type(state_t), intent(inout) :: s
      logical, intent(out) :: agrees, crosses
      type(values_t) :: v
      real(wp) :: r(b%list(i)%shape%rows), p(b%list(i)%shape%n), q(-1:1), c(0:2), unit
      integer :: j

      call find_known_parts(b, i, s)
      v = decomposed(b, i, s)
      call right_hand_side(b, i, 1, s, r)
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
         s%u(b%unknown(b%list(i)%first:b%list(i)%last))%rate = p + j*unit*v%right(v%n, :)
         call right_hand_side(b, i, 2, s, r)
         q(j) = dot_product(v%left(:, v%n), r)/unit**2
      end do
      ! Two real roots, one of which may be infinite; none where all coefficients are zero beside the Lipschitz
      ! constant, as they are where a drive adds nothing to the others.
      c = [q(0), 0.5_wp*(q(1) - q(-1)), 0.5_wp*(q(1) + q(-1)) - q(0)]
      crosses = maxval(abs(c)) > agreement*b%numbers%blocks(i)%lipschitz .and. &
         c(1)**2 - 4.0_wp*c(0)*c(2) > agreement*maxval(abs(c))**2
   end subroutine judge
end module singularity
