!> METHOD NEWTON: the engine that solves block by block. Beside what every engine does it knows its blocks: change
!> points, limits, what there is to say of the start, and how roundings grow.
module block_method
   use kinds, only: wp
   use constants, only: without_turns
   use mechanism, only: mechanism_t
   use structure, only: structure_t
   use motion, only: motion_t
   use diagnostics, only: diagnostic_t, diagnostic_far_estimate
   use convergence, only: convergence_t, is_solved, ended_inconsistent
   use engine, only: engine_t, engine_checkpoint_t
   use block_engine, only: block_engine_t, make_block_engine, solve_blocks, accept_blocks, get_blocks_motion, &
      know_links, get_driven_motion, block_checkpoint_t, checkpoint_blocks, restore_blocks
   use assembly_choice, only: solve_first
   use block_diagnostics, only: first_diagnostics, limit_diagnostic
   use branch_requests, only: branch_requests_t
   use block_branches, only: pass, extrapolate, is_short_and_right
   implicit none
   private
   public :: block_method_t, make_block_method

   !> An estimated angle that is off by more, in radians, is worth a diagnostic: the assembly may not be the one that
   !> was meant.
   real(wp), parameter :: far_angle = 1.0_wp

   type, extends(engine_t) :: block_method_t
      private
      ! Allocatable, since gfortran 12 frees only one of several components of one type below a class.
      type(block_engine_t), allocatable :: blocks
   contains
      procedure :: solve
      procedure :: accept
      procedure :: get_motion
      procedure :: get_link_flags
      procedure :: get_driven_links
      procedure :: checkpoint
      procedure :: restore
      procedure :: measure_closure_error
      procedure :: diagnose_start
      procedure :: diagnose_limit
      procedure :: pass_change_points
      procedure :: extrapolate_to
      procedure :: max_rate
      procedure :: roundings_grow
      procedure :: copy_values
   end type block_method_t

   !> Values, history, signs and pivots of the blocks.
   type, extends(engine_checkpoint_t) :: place_t
      type(block_checkpoint_t) :: blocks
   end type place_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns. `structure`: see
   !> `make_block_engine`.
   subroutine make_block_method(e, m, structure)
      type(block_method_t), intent(out) :: e
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout), optional :: structure

      allocate (e%blocks)
      call make_block_engine(e%blocks, m, structure)
      e%length = e%blocks%length
      e%redundant = e%blocks%blocks%redundant
      if (allocated(e%blocks%history%sought)) e%depends_on_history = size(e%blocks%history%sought) > 0
   end subroutine make_block_method

   !> See `engine`.
   subroutine solve(e, t, follows, c, correction, same)
      class(block_method_t), intent(inout) :: e
      real(wp), intent(in) :: t
      logical, intent(in) :: follows
      type(convergence_t), intent(out) :: c
      real(wp), intent(out) :: correction
      logical, intent(out) :: same

      e%blocks%state%excursion = e%excursion
      if (follows) then
         call solve_blocks(e%blocks, t, follows, c, correction, same)
         if (e%excursion > 0.0_wp .and. is_solved(c)) c%is_certain = is_short_and_right(e%blocks, correction)
      else
         call solve_first(e%blocks, t, c, correction, same)
      end if
   end subroutine solve

   !> See `engine`.
   subroutine accept(e)
      class(block_method_t), intent(inout) :: e

      call accept_blocks(e%blocks)
   end subroutine accept

   !> See `engine`.
   subroutine get_motion(e, found, finite)
      class(block_method_t), intent(in) :: e
      type(motion_t), intent(inout) :: found
      logical, intent(out) :: finite

      call get_blocks_motion(e%blocks, found, finite)
   end subroutine get_motion

   !> See `engine`.
   subroutine get_link_flags(e, found)
      class(block_method_t), intent(inout) :: e
      type(motion_t), intent(inout) :: found

      call know_links(e%blocks, found)
   end subroutine get_link_flags

   !> See `engine`.
   subroutine get_driven_links(e, t, found)
      class(block_method_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found

      call get_driven_motion(e%blocks, t, found)
   end subroutine get_driven_links

   !> See `engine`.
   subroutine checkpoint(e, c)
      class(block_method_t), intent(in) :: e
      class(engine_checkpoint_t), allocatable, intent(inout) :: c

      if (.not. allocated(c)) allocate (place_t :: c)
      select type (c)
      type is (place_t)
         call checkpoint_blocks(e%blocks, c%blocks)
      end select
   end subroutine checkpoint

   !> See `engine`.
   subroutine restore(e, c, keeps_found)
      class(block_method_t), intent(inout) :: e
      class(engine_checkpoint_t), intent(in) :: c
      logical, intent(in) :: keeps_found

      select type (c)
      type is (place_t)
         call restore_blocks(e%blocks, c%blocks, keeps_found)
      end select
   end subroutine restore

   !> The closure error at `t` itself, from the motion that is followed or, where that is too far, from the deck's
   !> estimate; where neither search ends there, `c` stays but for its closure error, which is 0.
   subroutine measure_closure_error(e, t, c)
      class(block_method_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(inout) :: c
      type(convergence_t) :: before
      real(wp) :: correction
      logical :: same

      before = c
      call solve_blocks(e%blocks, t, .true., c, correction, same)
      if (c%ended == ended_inconsistent) return
      call solve_blocks(e%blocks, t, .false., c, correction, same)
      if (c%ended == ended_inconsistent) return
      c = before
      c%closure_error = 0.0_wp
   end subroutine measure_closure_error

   !> What there is to say of the first motion `found`: redundant equations, close assemblies, what can still move where
   !> the Jacobian is `singular`; and the angle that was estimated the worst.
   subroutine diagnose_start(e, found, singular, list)
      class(block_method_t), intent(inout) :: e
      type(motion_t), intent(in) :: found
      logical, intent(in) :: singular
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      real(wp) :: off(size(found%position, 2))
      integer :: link

      list = first_diagnostics(e%blocks, singular)
      off = without_turns(found%position(3, :) - e%blocks%estimate(3, :))
      link = maxloc(abs(off), mask=e%blocks%is_found, dim=1)
      if (link == 0) return
      if (abs(off(link)) > far_angle) list = [list, diagnostic_t(kind=diagnostic_far_estimate, &
         links=[link, 0, 0, 0, 0, 0], is_angle=.true., value=off(link))]
   end subroutine diagnose_start

   !> The limit of the motion that is followed, if it has one before `t`.
   subroutine diagnose_limit(e, t, list)
      class(block_method_t), intent(in) :: e
      real(wp), intent(in) :: t
      type(diagnostic_t), allocatable, intent(out) :: list(:)

      list = limit_diagnostic(e%blocks, t)
   end subroutine diagnose_limit

   !> Passes the change points between the motion that is followed and that found last at `t`: see `block_branches`.
   subroutine pass_change_points(e, t, correction, requests, c, list, passed)
      class(block_method_t), intent(inout) :: e
      real(wp), intent(in) :: t, correction
      type(branch_requests_t), intent(inout) :: requests
      type(convergence_t), intent(inout) :: c
      type(diagnostic_t), allocatable, intent(out) :: list(:)
      logical, intent(out) :: passed

      call pass(e%blocks, t, correction, requests, c, list, passed)
   end subroutine pass_change_points

   !> The position at `t` from three motions at equal steps before it; `list`: a diagnostic for each block that has its
   !> change point there, none where that is not so.
   subroutine extrapolate_to(e, t, list)
      class(block_method_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(diagnostic_t), allocatable, intent(out) :: list(:)

      call extrapolate(e%blocks, t, list)
   end subroutine extrapolate_to

   !> The largest rate of an unknown of the motion that is followed.
   pure real(wp) function max_rate(e)
      class(block_method_t), intent(in) :: e

      associate (h => e%blocks%history)
         max_rate = max(0.0_wp, maxval(abs(h%rate(h%sought, h%place(0)))))
      end associate
   end function max_rate

   !> A rounding grows by more than `limit` in a block whose numbers are `size_of` times the characteristic ones.
   pure logical function roundings_grow(e, size_of, limit)
      class(block_method_t), intent(in) :: e
      real(wp), intent(in) :: size_of, limit
      integer :: k

      roundings_grow = .false.
      do k = 1, size(e%blocks%needed)
         associate (i => e%blocks%needed(k))
            if (.not. e%blocks%blocks%list(i)%direct) roundings_grow = roundings_grow .or. &
               e%blocks%blocks%list(i)%lipschitz*max(1.0_wp, size_of) > limit*min(1.0_wp, e%blocks%found%pivot(i))**2
         end associate
      end do
   end function roundings_grow

   !> The values found last become those of `other`, whose unit of lengths may be another power of two.
   pure subroutine copy_values(e, other)
      class(block_method_t), intent(in) :: e
      type(block_engine_t), intent(inout) :: other

      other%state%u%value = e%blocks%state%u%value*(slide_units(e%blocks)/slide_units(other))
   end subroutine copy_values

   !> (0:unknowns) The unit of each slide in the deck's; 1 of an angle.
   pure function slide_units(e) result(unit)
      type(block_engine_t), intent(in) :: e
      real(wp) :: unit(0:e%blocks%unknowns)

      unit = e%blocks%unit
      unit(e%blocks%orientations + 1:) = unit(e%blocks%orientations + 1:)*e%length
   end function slide_units
end module block_method
