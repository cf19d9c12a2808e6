!> The path from a block's initial estimate to the assembly that belongs to it, for where Newton's method
!> alone might jump: Newton homotopy r(x) = (1 - p) r(x0), p from 0 to 1, with a tangent predictor and Newton's
!> corrector (Allgower and Georg, Numerical Continuation Methods, 1990). A step is made shorter until the corrector
!> contracts well: the path then stays on its own sheet. Where the path turns back (a fold) it ends.
!>
!> And the other position across a fold: near a singular Jacobian positions come in pairs.
module position_path
   use kinds, only: wp
   use blocks, only: blocks_t
   use klu, only: klu_t
   use block_matrix, only: solve_again
   use block_state, only: state_t, set_values, values_of
   use block_equations, only: find_known_parts, assemble_block
   use block_solver, only: workspace_t, solve_jacobian
   use levenberg_marquardt, only: golden_numbers
   implicit none
   private
   public :: follow_path, cross_fold

   !> No step of the predictor moves an unknown further, in radians or characteristic lengths.
   real(wp), parameter :: max_step = 0.2_wp
   !> A corrector belongs to the predicted point where it is this part of the predictor's step, and each correction this
   !> part of the one before (Deuflhard's estimate of the Kantorovich ratio: below 1/2 there is one root only).
   real(wp), parameter :: max_part = 0.25_wp, max_contraction = 0.25_wp
   !> Corrections below this leave the next step nothing to mend.
   real(wp), parameter :: close = max(1.0e-5_wp, sqrt(epsilon(1.0_wp)))
   !> A shorter step than this is a fold.
   real(wp), parameter :: min_share = 1.0e-3_wp
   integer, parameter :: max_steps = 200, max_corrections = 4
   !> The second difference is taken over this; a pair of positions further apart is none.
   real(wp), parameter :: small = 0.02_wp, max_apart = 2.0_wp

contains

   !> Follows the path of block `i` from the values of `s` to its end, close to a position, or to a fold. `w`: room,
   !> its factors are lost.
   subroutine follow_path(b, i, w, s)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      type(klu_t), allocatable :: sparse
      real(wp), dimension(b%list(i)%shape%rows) :: first, tangent
      real(wp), dimension(b%list(i)%shape%n) :: x
      real(wp) :: p, share, length
      integer :: step, info
      logical :: is_close

      call find_known_parts(b, i, s)
      x = values_of(b, i, s)
      call assemble_block(b, i, s, w%a, first)
      p = 0.0_wp
      share = 1.0_wp
      do step = 1, max_steps
         tangent = first
         call solve_jacobian(b, b%list(i)%shape, w, sparse, tangent, info)
         length = maxval(abs(tangent(:size(x))))
         if (info > 0 .or. .not. length <= huge(length)) return
         share = min(share, 1.0_wp - p, max_step/max(length, epsilon(length)))
         do
            call set_values(b, i, x - share*tangent(:size(x)), s)
            call correct(b, i, first*(1.0_wp - p - share), share*length, w, s, is_close)
            if (is_close) exit
            share = 0.5_wp*share
            if (share < min_share .and. share*length < min_share) return
         end do
         p = p + share
         x = values_of(b, i, s)
         if (p >= 1.0_wp - epsilon(p)) return
         share = 2.0_wp*share
         call assemble_block(b, i, s, w%a, tangent)
      end do
   end subroutine follow_path

   !> Corrects the values of `s` to where the residual is `aim`; `step`: the length of the predictor's step.
   subroutine correct(b, i, aim, step, w, s, is_close)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      real(wp), intent(in) :: aim(:), step
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      logical, intent(out) :: is_close
      type(klu_t), allocatable :: sparse
      real(wp) :: d(size(aim)), before, now
      integer :: k, info

      is_close = .false.
      before = step*max_part/max_contraction
      do k = 1, max_corrections
         call assemble_block(b, i, s, w%a, d)
         d = d - aim
         call solve_jacobian(b, b%list(i)%shape, w, sparse, d, info)
         if (info > 0) return
         associate (n => b%list(i)%shape%n)
            now = maxval(abs(d(:n)))
            if (.not. now <= max(max_contraction*before, 0.1_wp*close)) return
            call set_values(b, i, values_of(b, i, s) - d(:n), s)
         end associate
         is_close = now <= close
         if (is_close) return
         before = now
      end do
   end subroutine correct

   !> From a position of block `i` in the values of `s` to where the other one of a pair should be. With the direction v
   !> in which the Jacobian does least, J^-1 r(x + a v) is a v + a^2/2 J^-1 r'' v v: zero again at some a. `found`: it
   !> is near enough. `number`: of the right-hand side from which v is taken.
   subroutine cross_fold(b, i, number, w, s, found)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i, number
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s
      logical, intent(out) :: found
      type(klu_t), allocatable :: sparse
      real(wp), dimension(b%list(i)%shape%rows) :: v, r, second, room
      real(wp) :: x(b%list(i)%shape%n), a
      integer :: info

      found = .false.
      associate (shape => b%list(i)%shape)
         x = values_of(b, i, s)
         call find_known_parts(b, i, s)
         v = golden_numbers(number, shape%rows)
         ! Residuals first: the factors must be those of the position itself.
         call set_values(b, i, x, s)
         call assemble_block(b, i, s, w%a, r)
         call solve_jacobian(b, shape, w, sparse, v, info)
         if (info > 0) return
         v(:shape%n) = v(:shape%n)/norm2(v(:shape%n))
         call set_values(b, i, x + small*v(:shape%n), s)
         second = residual_of(b, i, s)
         call set_values(b, i, x - small*v(:shape%n), s)
         room = residual_of(b, i, s)
         second = (second - 2.0_wp*r + room)/small**2
         call solve_again(shape, w%a, w%pivots, w%work, second, sparse)
         a = dot_product(second(:shape%n), v(:shape%n))
         found = abs(a)*max_apart > 2.0_wp
         if (found) x = x - 2.0_wp/a*v(:shape%n)
         call set_values(b, i, x, s)
      end associate
   end subroutine cross_fold

   !> (rows) The residual of block `i`, whose factors stay.
   function residual_of(b, i, s) result(r)
      type(blocks_t), intent(in) :: b
      integer, intent(in) :: i
      type(state_t), intent(inout) :: s
      real(wp) :: r(b%list(i)%shape%rows)
      real(wp), allocatable :: a(:)

      allocate (a(max(b%list(i)%shape%entries, b%list(i)%shape%rows*b%list(i)%shape%n)))
      call assemble_block(b, i, s, a, r)
   end function residual_of
end module position_path
