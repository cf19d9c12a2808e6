!> A solver of one mechanism, as the continuation sees it: `block_method` (METHOD NEWTON) or `dense_engine` (METHOD
!> DENSE and METHOD MATRIX). An engine holds factors of KLU and is never copied; what it can go back to is in a
!> checkpoint.
module engine
   use kinds, only: wp
   use drives, only: law_t
   use motion, only: motion_t
   use convergence, only: convergence_t
   implicit none
   private
   public :: engine_t, engine_checkpoint_t

   !> All that the next step depends on: the motions that are followed, signs and pivots of their Jacobians, and the
   !> motion found last. No workspace.
   type, abstract :: engine_checkpoint_t
   end type engine_checkpoint_t

   type, abstract :: engine_t
      real(wp) :: length = 1.0_wp              !< the unit of its lengths, a power of two in the deck's unit
      type(law_t), allocatable :: laws(:)      !< (drives) of METHOD NEWTON
      real(wp) :: excursion = 0.0_wp           !< of the drives off their chords on the next substep, rad or that unit
      integer :: redundant = 0                 !< equations that could be spared
      logical :: is_certified = .true.         !< positions it follows carry the certificate of `branch_certificate`
      logical :: depends_on_history = .true.   !< some unknown is searched for from its value before
   contains
      procedure(solve_interface), deferred :: solve
      procedure(accept_interface), deferred :: accept
      procedure(motion_interface), deferred :: get_motion
      procedure(flags_interface), deferred :: get_link_flags
      procedure(driven_interface), deferred :: get_driven_links
      procedure(checkpoint_interface), deferred :: checkpoint
      procedure(restore_interface), deferred :: restore
      procedure :: measure_closure_error
   end type engine_t

   abstract interface
      !> Solves for the motion at `t`, from the one accepted last (`follows`) or from the deck's estimate. `c`: how it
      !> ended, with the largest change (rad, `length`) of a predicted value.
      subroutine solve_interface(e, t, follows, c)
         import :: engine_t, wp, convergence_t
         class(engine_t), intent(inout) :: e
         real(wp), intent(in) :: t
         logical, intent(in) :: follows
         type(convergence_t), intent(out) :: c
      end subroutine solve_interface

      !> The motion found last becomes the one that is followed.
      subroutine accept_interface(e)
         import :: engine_t
         class(engine_t), intent(inout) :: e
      end subroutine accept_interface

      !> The motion found last, in the deck's units; `finite`: all of it is known to be in range.
      subroutine motion_interface(e, found, finite)
         import :: engine_t, motion_t
         class(engine_t), intent(in) :: e
         type(motion_t), intent(inout) :: found
         logical, intent(out) :: finite
      end subroutine motion_interface

      !> Which links have velocities in the motion `found` last, where not all have; METHOD NEWTON: and what the
      !> singular position is.
      subroutine flags_interface(e, found)
         import :: engine_t, motion_t
         class(engine_t), intent(inout) :: e
         type(motion_t), intent(inout) :: found
      end subroutine flags_interface

      !> What is certain at `t`, where no position was found: the links that drives alone move.
      subroutine driven_interface(e, t, found)
         import :: engine_t, wp, motion_t
         class(engine_t), intent(inout) :: e
         real(wp), intent(in) :: t
         type(motion_t), intent(inout) :: found
      end subroutine driven_interface

      !> Notes in `c` the motion that is followed and that found last.
      subroutine checkpoint_interface(e, c)
         import :: engine_t, engine_checkpoint_t
         class(engine_t), intent(in) :: e
         class(engine_checkpoint_t), allocatable, intent(inout) :: c
      end subroutine checkpoint_interface

      !> Goes back to the checkpoint `c`, as if nothing had been solved since; `keeps_found`: the motion found last
      !> stays as it is.
      subroutine restore_interface(e, c, keeps_found)
         import :: engine_t, engine_checkpoint_t
         class(engine_t), intent(inout) :: e
         class(engine_checkpoint_t), intent(in) :: c
         logical, intent(in) :: keeps_found
      end subroutine restore_interface
   end interface

contains

   !> The closure error at `t` itself, where a substep has ended with contradictory equations before it: `c` says how
   !> the search for a position there ended.
   subroutine measure_closure_error(e, t, c)
      class(engine_t), intent(inout) :: e
      real(wp), intent(in) :: t
      type(convergence_t), intent(inout) :: c

      call e%solve(t, .true., c)
   end subroutine measure_closure_error
end module engine
