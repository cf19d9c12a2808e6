!> The position of a block where its Jacobian has no inverse. Its equations determine that to the root of the rounding
!> only: along the direction k in which they say nothing to the first order, Newton's method ends anywhere within 1E-7,
!> and digits would be printed that are wrong. But where the Jacobian itself has no inverse is known in full: with w and
!> k on the left and the right of its least singular value s, and to the second order along k
!>    w . r(x + a k) = w . r + a s + a^2 q/2,   q = w . r''[k, k],
!> that is at a = -s/q. If the equations are satisfied there, as far as rounding can tell, that is the position;
!> otherwise it is one of the two roots beside it.
module singular_place
   use kinds, only: wp
   use blocks, only: blocks_t
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: right_hand_side
   use block_sizes, only: find_driven
   use block_rank, only: values_t, decomposed, residual_of, curvature_of, difference, gauss_newton_step
   implicit none
   private
   public :: settle

   !> Of larger blocks it is not asked where they are singular, nor how: twenty decompositions take a second for these.
   integer, parameter, public :: max_rows = 300

   !> The largest distance of the place, over the root of the second derivative.
   real(wp), parameter :: furthest = 64.0_wp*sqrt(epsilon(1.0_wp))
   !> What the equations may leave open, of the largest value, of a sum of lengths, which counts as so many, or of what
   !> drives and earlier blocks have rounded: less is nothing but rounding, more would be no position.
   real(wp), parameter :: closed = 1.5_wp*epsilon(1.0_wp), near = 12.0_wp*epsilon(1.0_wp), sum_size = 3.0_wp
   !> Part of the Lipschitz constant below which the second derivative counts as zero, as it is but for the rounding of
   !> the difference along a motion with the drives held.
   real(wp), parameter :: least_curvature = 512.0_wp*epsilon(1.0_wp)/difference**2

contains

   !> Moves block `i` from the singular position of `s`, where it has just been solved, to the place where its Jacobian
   !> has no inverse, or to the root of its equations beside that.
   subroutine settle(b, i, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      type(values_t) :: v
      real(wp) :: x(b%list(i)%shape%n), y(b%list(i)%shape%n), r(b%list(i)%shape%rows), q, left_open, level, speed, angle

      if (b%list(i)%shape%rows > max_rows .or. size(x) == 0) return
      x = values_of(b, i, s)
      v = decomposed(b, i, s)
      level = max(sum_size, maxval(abs(x)), b%numbers%blocks(i)%coarse)
      ! A rounding of an angle that drives and earlier blocks give counts along w: at a dead point in full, at a change
      ! point, which such an angle leaves as it is to the first order, not at all.
      call find_driven(b, i, s, speed, angle)
      if (speed > 0.0_wp) then
         call right_hand_side(b, i, 1, s, r)
         level = max(level, angle*abs(dot_product(v%left(:, v%n), r))/speed)
      end if
      q = curvature_of(b, i, x, v%left(:, v%n), v%right(v%n, :), s)
      if (v%rank < v%n - 1 .or. abs(q) <= least_curvature*b%numbers%blocks(i)%lipschitz) return
      associate (left => v%left(:, v%n), k => v%right(v%n, :))
         call go_to(x - (v%s(v%n)/q)*k)
         left_open = dot_product(left, residual_of(b, i, y, s))
         if (abs(left_open) > closed*level .and. left_open*q < 0.0_wp) &
            call go_to(y + sign(sqrt(-2.0_wp*left_open/q), dot_product(x - y, k))*k)
      end associate
      if (maxval(abs(y - x)) > furthest/sqrt(min(1.0_wp, abs(q))) .or. &
         maxval(abs(residual_of(b, i, y, s))) > near*level) call set_values(b, i, x, s)

   contains

      !> The values are `place`, but for what the equations determine otherwise: then `y`.
      subroutine go_to(place)
         real(wp), intent(in) :: place(:)
         real(wp) :: before

         call set_values(b, i, place, s)
         call gauss_newton_step(b, i, s, before)
         y = values_of(b, i, s)
      end subroutine go_to
   end subroutine settle
end module singular_place
