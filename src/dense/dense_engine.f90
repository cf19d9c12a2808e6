!> METHOD DENSE and METHOD MATRIX: all closure equations as one block, x, y, phi of every link its unknowns: the form of
!> the paper, by Newton or by the iteration of 1987. The blocks are compared with it.
!>
!> The first position is one near the estimate, or in the assembly that the blocks find from it: an iteration that goes
!> further ends where rounding lets it. Newton's method then begins again from there; that of 1987, which is repelled
!> from some assemblies, has found nothing.
module dense_engine
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_dense, method_matrix, own_predictor
   use motion, only: motion_t, new_motion, mark_none
   use structure, only: structure_t, new_structure
   use linear_solver, only: factors_t, new_factors, reciprocal_condition, determinant_sign, solve_factored => solve
   use convergence, only: convergence_t, is_solved, ended_elsewhere
   use predictor, only: largest_change, order_weights
   use engine, only: engine_t, engine_checkpoint_t
   use block_engine, only: block_engine_t, make_block_engine
   use pose, only: system_t, pose_t, new_system, new_pose, add_to_links
   use closure_equations, only: find_drive_values, remainder
   use position_iteration, only: solve_newton, solve_matrix, rounding_level
   use root_distance, only: coordinates_t, new_coordinates, distance, kantorovich, kantorovich_bound
   use dense_start, only: by_blocks, find_start
   use planar, only: without_turns
   implicit none
   private
   public :: dense_engine_t, make_dense_engine, solve_velocity, solve_acceleration

   !> The position is known to eps/rcond, and so the Jacobian; below the root of eps no digit of a velocity is certain,
   !> unless small links beside large ones are all that makes the condition bad.
   real(wp), parameter :: min_condition = 4.0_wp*sqrt(epsilon(1.0_wp))
   !> Relative error of the velocities, by what rounding leaves open in the position, that is too large to print them.
   real(wp), parameter :: largest_error = 0.05_wp
   !> A change over the distance of the next root, at least: below it the root is the only one as near, and near enough.
   real(wp), parameter :: certain = 0.5_wp
   !> A bound of the Kantorovich ratio that is below this needs no closer look: ratios matter from 0.1 on.
   real(wp), parameter :: small_kantorovich_ratio = 1.0e-3_wp
   !> A change of more than this, in radians and in the unit of length, may be a jump to another branch, as with blocks.
   real(wp), parameter :: branch_jump = 0.5_wp
   !> An iteration that goes further than this wanders, and where it ends is up to rounding.
   real(wp), parameter :: reach = largest_change
   !> Where the Jacobian has no inverse a position is known to the root of eps; a root this near is that position.
   real(wp), parameter :: same_place = min(1.0e4_wp*sqrt(epsilon(1.0_wp)), 1.0e-2_wp)

   !> All that the next step depends on: the motions that are followed, and that found last, with the signs of their
   !> determinants.
   type, extends(engine_checkpoint_t) :: place_t
      type(motion_t) :: now                      !< the motion found last
      type(motion_t) :: last                     !< the one that is followed
      type(motion_t) :: before                   !< the one before, where the order is 3
      integer :: determinant_now = 0, determinant = 0   !< signs at `now` and `last`
   end type place_t

   !> Lengths in the system's unit.
   type, extends(engine_t) :: dense_engine_t
      private
      type(system_t) :: system
      type(mechanism_t) :: by_blocks             !< to be solved by blocks, at the first instant
      type(structure_t), public :: structure     !< of that: it is built once, and each block engine takes a copy
      type(block_engine_t), allocatable :: blocks !< of that, for the links that drives alone move; made when needed
      type(coordinates_t) :: coordinates         !< whose changes the Kantorovich ratio bounds
      type(pose_t) :: pose                       !< workspace of the position that is searched for
      real(wp), allocatable :: estimated(:, :)   !< (3, links) the deck's positions
      real(wp), allocatable :: start(:, :)       !< (3, links) where the last search began
      type(factors_t) :: factors
      type(place_t), allocatable :: at           !< gfortran does not free the parts of one that is not allocatable
      real(wp), allocatable :: drive_values(:, :) !< (3, drives) value, rate, acceleration
      logical :: has_missed = .false.            !< the assembly meant at an earlier instant was not found
      integer :: method = 0                      !< method_dense or method_matrix
      integer :: order = own_predictor           !< of the predictor, 0 to 3
      real(wp) :: tolerance = 0.0_wp             !< relative; 0: the limit of rounding
   contains
      procedure :: solve
      procedure :: accept
      procedure :: get_motion
      procedure :: get_link_flags
      procedure :: get_driven_links
      procedure :: checkpoint
      procedure :: restore
      procedure :: followed_position
   end type dense_engine_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns. METHOD MATRIX follows under the
   !> same guard but has no certificate: its iteration arrives at some instants of a motion and not at others.
   subroutine make_dense_engine(e, m)
      type(dense_engine_t), intent(out) :: e
      type(mechanism_t), intent(in) :: m

      e%system = new_system(m)
      e%length = e%system%length
      e%is_certified = m%method == method_dense
      e%pose = new_pose(e%system, m)
      e%by_blocks = by_blocks(m)
      e%structure = new_structure(e%by_blocks)
      e%coordinates = new_coordinates(e%system)
      e%estimated = e%pose%q
      e%start = e%estimated
      e%factors = new_factors(e%system%n)
      allocate (e%at)
      e%at%now = new_motion(size(m%links))
      e%at%last = e%at%now
      e%at%before = e%at%now
      allocate (e%drive_values(3, size(m%drives)))
      e%method = m%method
      e%order = m%predictor
      e%tolerance = m%tolerance
   end subroutine make_dense_engine

   !> See `engine`.
   subroutine solve(e, t, follows, c)
      class(dense_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: follows
      type(convergence_t), intent(out) :: c
      logical :: is_near

      e%at%now%t = t
      call find_drive_values(e%system, t, e%drive_values)
      if (follows) then
         e%start = continued(e, t)
         is_near = maxval(abs(e%start - e%at%last%position)) <= largest_change
         if (is_near) call search(e, e%start, c)
         c%keeps_signs = is_near
      else
         call search_first(e, t, c)
      end if
      c%change = maxval(abs(e%pose%q - e%start))
      if (.not. (c%keeps_signs .and. is_solved(c))) return
      call solve_rates(e, c)
      if (follows .and. .not. c%singular) c%keeps_signs = e%at%determinant_now == e%at%determinant
   end subroutine solve

   !> The position by the method's iteration from `start` (3, links), and how far it is from there.
   subroutine search(e, start, c)
      class(dense_engine_t), intent(inout) :: e
      real(wp), intent(in) :: start(:, :)
      type(convergence_t), intent(out) :: c

      e%pose%q = start
      if (e%method == method_matrix) then
         call solve_matrix(e%system, e%drive_values(1, :), e%tolerance, e%pose, e%factors, c, reach)
      else
         call solve_newton(e%system, e%drive_values(1, :), e%tolerance, e%pose, e%factors, c, reach)
      end if
      if (.not. is_solved(c)) return
      c%change = distance(e%system, e%coordinates, e%pose%q, start)
      call judge(e, c)
   end subroutine search

   !> Condition and sign of the Jacobian at the position found, and how certain it is that the root is the one that was
   !> predicted.
   subroutine judge(e, c)
      class(dense_engine_t), intent(inout) :: e
      type(convergence_t), intent(inout) :: c
      real(wp) :: k, gain

      if (c%singular) return
      call reciprocal_condition(e%factors, c%reciprocal_condition)
      c%determinant = determinant_sign(e%factors)
      if (c%reciprocal_condition <= min_condition) then
         call kantorovich(e%system, e%coordinates, e%factors, e%pose, k, gain)
         c%singular = .not. k*gain*rounding_level*max(1.0_wp, maxval(abs(e%pose%q))) < largest_error
         if (c%singular) return
      end if
      c%kantorovich_ratio = kantorovich_bound(e%system, e%coordinates, e%pose, c%change, &
         c%reciprocal_condition*e%factors%norm)
      if (c%kantorovich_ratio <= small_kantorovich_ratio) return
      call kantorovich(e%system, e%coordinates, e%factors, e%pose, k)
      c%kantorovich_ratio = c%change*k
   end subroutine judge

   !> The first position, from the deck's estimate.
   subroutine search_first(e, t, c)
      class(dense_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(out) :: c
      real(wp) :: meant(3, size(e%estimated, 2)), unit(3, size(e%estimated, 2))
      logical :: is_known

      unit = spread([e%system%length, e%system%length, 1.0_wp], 2, size(unit, 2))
      e%start = e%estimated*unit
      call find_start(e%by_blocks, e%structure, t, e%start, meant, is_known)
      e%start = e%start/unit
      call search(e, e%start, c)
      if (is_solved(c) .and. .not. c%singular .and. c%kantorovich_ratio <= certain) return
      if (is_known .and. .not. e%has_missed) then
         meant = meant/unit
         if (e%method /= method_matrix) call search(e, meant, c)
         if (is_solved(c)) call compare(e, meant, c)
         e%has_missed = .not. is_solved(c)
      else if (is_solved(c) .and. (c%change > branch_jump .or. e%has_missed)) then
         c%ended = ended_elsewhere
      end if
   end subroutine search_first

   !> Is the position found the assembly `meant` (3, links)? If so it gets its turns.
   subroutine compare(e, meant, c)
      class(dense_engine_t), intent(inout) :: e
      real(wp), intent(in) :: meant(:, :)
      type(convergence_t), intent(inout) :: c
      real(wp) :: apart, k

      e%pose%q(3, :) = meant(3, :) + without_turns(e%pose%q(3, :) - meant(3, :))
      apart = distance(e%system, e%coordinates, e%pose%q, meant)
      if (c%singular) then
         if (apart > same_place) c%ended = ended_elsewhere
      else
         call kantorovich(e%system, e%coordinates, e%factors, e%pose, k)
         if (apart*k > certain) c%ended = ended_elsewhere
      end if
   end subroutine compare

   !> Velocities and accelerations at the position found, where the Jacobian has an inverse.
   subroutine solve_rates(e, c)
      class(dense_engine_t), intent(inout) :: e
      type(convergence_t), intent(inout) :: c

      e%at%now%position = e%pose%q
      if (c%singular) return
      e%at%determinant_now = c%determinant
      associate (now => e%at%now)
         call solve_velocity(e%system, e%factors, e%drive_values(2, :), now%velocity)
         call solve_acceleration(e%system, e%factors, e%pose, e%drive_values(3, :), now%velocity, now%acceleration)
      end associate
   end subroutine solve_rates

   !> Velocities `v` (3, links) from the drives' rates `rate` (drives), by the factors `f` of the Jacobian:
   !> J v = f' (21), with the dependence of A' on the unknown velocities moved to the left; f' is zero in pairs' rows.
   subroutine solve_velocity(s, f, rate, v)
      type(system_t), intent(in) :: s
      type(factors_t), intent(in) :: f
      real(wp), intent(in) :: rate(:)
      real(wp), intent(out) :: v(:, :)
      real(wp) :: b(s%n)

      b = 0.0_wp
      b(s%n - size(rate) + 1:) = rate
      call solve_factored(f, b)
      v = 0.0_wp
      call add_to_links(s, b, v)
   end subroutine solve_velocity

   !> Accelerations `a` (3, links) from those of the drives, `acceleration` (drives), and the velocities `v` (3, links):
   !> J a = f'' - gamma(q, v) (22), gamma the acceleration remainder.
   subroutine solve_acceleration(s, f, p, acceleration, v, a)
      type(system_t), intent(in) :: s
      type(factors_t), intent(in) :: f
      type(pose_t), intent(in) :: p
      real(wp), intent(in) :: acceleration(:), v(:, :)
      real(wp), intent(out) :: a(:, :)
      real(wp) :: b(s%n)

      call remainder(s, p, v, b)
      b = -b
      associate (last => b(s%n - size(acceleration) + 1:))
         last = last + acceleration
      end associate
      call solve_factored(f, b)
      a = 0.0_wp
      call add_to_links(s, b, a)
   end subroutine solve_acceleration

   !> See `engine`.
   subroutine accept(e)
      class(dense_engine_t), intent(inout) :: e

      if (e%order == 3 .and. e%at%determinant /= 0) then
         e%at%before = e%at%last
         e%at%before%known = 2
      end if
      e%at%last = e%at%now
      e%at%determinant = e%at%determinant_now
   end subroutine accept

   !> See `engine`.
   subroutine checkpoint(e, c)
      class(dense_engine_t), intent(in) :: e
      class(engine_checkpoint_t), allocatable, intent(inout) :: c

      if (.not. allocated(c)) allocate (place_t :: c)
      select type (c)
      type is (place_t)
         c = e%at
      end select
   end subroutine checkpoint

   !> See `engine`.
   subroutine restore(e, c, keeps_found)
      class(dense_engine_t), intent(inout) :: e
      class(engine_checkpoint_t), intent(in) :: c
      logical, intent(in) :: keeps_found
      type(motion_t) :: now
      integer :: sign_now

      now = e%at%now
      sign_now = e%at%determinant_now
      select type (c)
      type is (place_t)
         e%at = c
      end select
      if (.not. keeps_found) return
      e%at%now = now
      e%at%determinant_now = sign_now
   end subroutine restore

   !> See `engine`; the range of the results is not looked at.
   subroutine get_motion(e, found, finite)
      class(dense_engine_t), intent(in) :: e
      type(motion_t), intent(inout) :: found
      logical, intent(out) :: finite

      finite = .false.
      found%origin = e%system%origin
      found%position = e%at%now%position
      found%velocity = e%at%now%velocity
      found%acceleration = e%at%now%acceleration
      found%position(:2, :) = e%system%length*found%position(:2, :)
      found%velocity(:2, :) = e%system%length*found%velocity(:2, :)
      found%acceleration(:2, :) = e%system%length*found%acceleration(:2, :)
   end subroutine get_motion

   !> The position (3, links) that is followed, in the deck's unit from the origin of the plane.
   pure function followed_position(e) result(q)
      class(dense_engine_t), intent(in) :: e
      real(wp) :: q(3, size(e%at%last%position, 2))

      q = e%at%last%position*spread([e%system%length, e%system%length, 1.0_wp], 2, size(q, 2))
   end function followed_position

   !> See `engine`. There is one Jacobian for all links: without its inverse the links are known that drives alone move.
   subroutine get_link_flags(e, found)
      class(dense_engine_t), intent(inout) :: e
      type(motion_t), intent(inout) :: found
      type(motion_t) :: driven
      integer :: link

      driven = found
      call e%get_driven_links(found%t, driven)
      if (.not. allocated(driven%link_known)) return
      found%link_known = merge(2, 0, driven%link_known == 2)
      found%link_mark = merge(mark_none, found%mark, driven%link_known == 2)
      do link = 1, size(driven%link_known)
         if (driven%link_known(link) < 2) cycle
         found%velocity(:, link) = driven%velocity(:, link)
         found%acceleration(:, link) = driven%acceleration(:, link)
      end do
   end subroutine get_link_flags

   !> See `engine`.
   subroutine get_driven_links(e, t, found)
      class(dense_engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(structure_t) :: own

      if (.not. allocated(e%blocks)) then
         allocate (e%blocks)
         own = e%structure
         call make_block_engine(e%blocks, e%by_blocks, own)
      end if
      call e%blocks%get_driven_links(t, found)
   end subroutine get_driven_links

   !> The start at `t` (3, links): the state before, corrected through its velocity and acceleration, or by the order
   !> that is asked for.
   pure function continued(e, t) result(q)
      class(dense_engine_t), intent(in) :: e
      real(wp), intent(in) :: t
      real(wp) :: q(3, size(e%at%last%position, 2)), w(3)

      associate (last => e%at%last, before => e%at%before)
         if (e%order == own_predictor) then
            q = last%position + (t - last%t)*(last%velocity + 0.5_wp*(t - last%t)*last%acceleration)
         else
            w = order_weights(e%order, t - last%t, merge(last%t - before%t, 0.0_wp, before%known == 2))
            q = last%position + w(1)*last%velocity + w(2)*last%acceleration &
               + w(3)*(last%acceleration - before%acceleration)
         end if
      end associate
   end function continued
end module dense_engine
