!> The analysis of one mechanism, instant by instant: the motion found, and the remarks about it.
!>
!> The motion is followed by blocks, whatever the method: the blocks give the limits, the certificate and the remarks.
!> METHOD DENSE and METHOD MATRIX solve for the motion at each instant at which the blocks have found a motion.
!>
!> After an instant the analysis is in one of five phases. The motion may stand on a singular position (`singular`).
!>
!> | phase     | the last instant               | `continue_to_instant` goes to the next instant by                 |
!> |-----------|--------------------------------|-------------------------------------------------------------------|
!> | not_begun | none had a position            | begin                                                             |
!> | at_start  | none had a motion              | begin; rest, if it stands and no drive moves                      |
!> | on_motion | had a position                 | follow; if it stands leave_position, or rest if no drive moves    |
!> | lost      | was not reached                | follow                                                            |
!> | beyond    | lay beyond a limit             | as from the phase before                                          |
!>
!> | from         | the instant          | `advance` | to        | remarks                                           |
!> |--------------|----------------------|-----------|-----------|---------------------------------------------------|
!> | not_begun    | has a motion         | arrive    | on_motion | redundant equations, other assemblies, estimate   |
!> | not_begun    | has only a position  | arrive    | at_start  | redundant equations, links that can move          |
!> | not_begun    | has no position      | stop_at   | not_begun | closure error                                     |
!> | at_start     | has a motion         | arrive    | on_motion | the motion begins                                 |
!> | at_start     | has only a position  | arrive    | at_start  |                                                   |
!> | at_start     | has no position      | stop_at   | at_start  | closure error                                     |
!> | the others   | has a position       | arrive    | on_motion | change points: passed, here, or returned from     |
!> | on_motion    | is not reached       | stop_at   | lost      | closure error, or the end of the motion           |
!> | lost, beyond | is not reached       | stop_at   | lost      | closure error                                     |
!> | on_motion    | is beyond a limit    | skip_instant | beyond | the end of the motion                          |
!> | lost, beyond | is beyond a limit    | skip_instant | beyond | that it is beyond                              |
module analysis
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, with_all_links
   use structure, only: structure_t, make_structure
   use drive_path, only: moving_drives, time_beside
   use motion, only: motion_t, add_diagnostics, forget_links, known_of, flag_none, flag_not_converged, flag_singular, &
      flag_overflow, flag_inconsistent, singular_unclear, singular_change, diagnostic_t, diagnostic_inconsistent, &
      diagnostic_limit, diagnostic_beyond, diagnostic_long, diagnostic_close, diagnostic_begins, diagnostic_method, &
      diagnostic_dead_end, diagnostic_stroke
   use convergence, only: solve_report_t, is_solved, ended_inconsistent, ended_unsought, ended_elsewhere
   use block_motion, only: assign_geometry, get_ratios, get_driven_links
   use link_motion, only: move_links
   use dense_method, only: dense_t, make_dense, solve_all_links
   use block_diagnostics, only: near_limit_part, start_diagnostics, limit_diagnostic, get_link_flags, change_diagnostics
   use change_point_passage, only: leave, follow, go_by_value, solve_regular_blocks
   use strokes, only: find_length_limit, flag_strokes
   use continuation, only: continuation_t, step_record_t, step_blocked, step_creeps, step_there, step_stands, &
      step_rests, follow_structure, begin_motion, measure_closure_error, continue_to, accept_substep, revert, &
      continuation_state_t, restore, passed_of, limit_t, limit_before, branch_t, &
      certificate_counts_t, branch_none, branch_first, branch_same, branch_crossed
   implicit none
   private
   public :: analysis_t, make_analysis, analyze_structure, reuse_analysis, advance, evaluate_at, restore_instant, &
      redundancy_error

   !> A limit that the motion creeps up to is no further than this part of the way that it has come.
   real(wp), parameter :: creeping_part = 1.0e-3_wp
   !> From a singular first position the motion begins after a drive has gone so far, in rad or units of its block: the
   !> branches are still close there, and the position is no longer singular.
   real(wp), parameter :: start_offset = 1.0e-3_wp

   !> The phases, as in the module's head.
   enum, bind(c)
      enumerator :: not_begun, at_start, on_motion, lost, beyond
   end enum

   !> The motion that is followed, and the findings at the instants so far.
   type, extends(continuation_t) :: analysis_t
      integer :: phase = not_begun                         !< not_begun, ...
      !> (blocks) The Jacobian of the block has no inverse there; allocated if the motion stands on a singular position.
      logical, allocatable :: singular(:)
      real(wp) :: last = 0.0_wp                            !< time of the last instant, but for those beyond a limit
      type(branch_t) :: branch                             !< of the last instant
      type(certificate_counts_t) :: certificate_counts     !< of all instants
      type(limit_t) :: limits(2)                           !< of the motion that is followed, the earlier and the later
      type(dense_t), allocatable :: dense                  !< METHOD DENSE and MATRIX: solves for the motion
      logical :: has_missed = .false.                      !< at the last instant it did not find the blocks' position
      real(wp) :: max_closure_error = 0.0_wp               !< largest of redundant equations, units of loops or rad
      !> The motion followed is at a time that is no instant (`evaluate_at`); the state of the continuation and the
      !> iterations at the last instant.
      logical :: is_left = .false.
      type(continuation_state_t) :: left
      integer :: left_iterations = 0
   end type analysis_t

contains

   !> Makes the analysis of a mechanism ready for its first instant.
   subroutine make_analysis(analysis, m)
      type(analysis_t), intent(out) :: analysis   !< of the mechanism
      type(mechanism_t), intent(in) :: m                   !< with as many equations as unknowns
      type(structure_t) :: structure

      call make_structure(m, structure)
      call analyze_structure(analysis, m, structure)
   end subroutine make_analysis

   !> Makes the analysis of a mechanism whose structure is known ready for its first instant.
   subroutine analyze_structure(analysis, m, structure)
      type(analysis_t), intent(out) :: analysis   !< of the mechanism
      type(mechanism_t), intent(in) :: m                   !< with as many equations as unknowns
      type(structure_t), intent(inout) :: structure        !< of `m`; blocks and geometry are moved away

      if (m%method == method_newton) then
         call follow_structure(analysis%continuation_t, m, structure)
      else
         call follow_structure(analysis%continuation_t, for_blocks(m), structure)
         allocate (analysis%dense)
         call make_dense(analysis%dense, m)
      end if
   end subroutine analyze_structure

   !> Makes an analysis by METHOD NEWTON ready for the first instant of a variant of equal structure. If the structure
   !> does not fit, the analysis is of no use.
   subroutine reuse_analysis(analysis, m, is_done)
      type(analysis_t), intent(inout) :: analysis          !< of another variant; then of `m`
      type(mechanism_t), intent(in) :: m                   !< the variant
      logical, intent(out) :: is_done                      !< the structure fits
      type(continuation_t) :: kept

      call move_memory(analysis%continuation_t, kept)
      analysis = analysis_t()
      call move_memory(kept, analysis%continuation_t)
      is_done = analysis%blocks%solvable
      if (is_done) call assign_geometry(m, analysis%blocks, analysis%geometry, analysis%path, is_done)
      if (is_done) call begin_motion(analysis%continuation_t, m)
   end subroutine reuse_analysis

   !> Solves for an instant, from the last instant on. Links that no request needs may be left out.
   subroutine advance(analysis, t, found)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< the time of the instant, in the deck's unit
      type(motion_t), intent(inout) :: found               !< (links) in the deck's units; flagged if it is not found
      type(step_record_t) :: step
      type(diagnostic_t), allocatable :: list(:)
      integer :: iterations

      if (asserts) call assert(abs(t) <= huge(t), 'advance: a time')
      call restore_instant(analysis)
      iterations = analysis%iterations
      if (allocated(found%diagnostics)) deallocate (found%diagnostics)
      if (allocated(found%by)) deallocate (found%by)
      found%t = t
      if (limit_before(analysis%limits, t) > 0) then
         call skip_instant(analysis, t, found)
         return
      end if

      call continue_to_instant(analysis, t, step, list)
      if (step%ending >= step_there) then
         call arrive(analysis, step, list, found)
         if (size(analysis%geometry%cylinders) > 0) call flag_strokes(analysis%geometry%cylinders, found)
      else
         call stop_at(analysis, t, step, found)
      end if
      analysis%certificate_counts%passed = analysis%certificate_counts%passed + passed_of(step)
      if (allocated(analysis%dense)) analysis%iterations = iterations &
         + merge(analysis%convergence%iterations, 0, step%ending >= step_there)
      analysis%last = t
   end subroutine advance

   !> Continues the motion to an instant, by the way that belongs to the phase (module's head).
   subroutine continue_to_instant(analysis, t, step, list)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< the time of the instant, in the deck's unit
      type(step_record_t), intent(inout) :: step           !< a new record; then how the step ended
      !> Not allocated; then the change points on which the motion stands at `t`, or from which it has returned.
      type(diagnostic_t), allocatable, intent(inout) :: list(:)

      if (allocated(analysis%singular)) then
         if (.not. any(moving_drives(analysis%path, analysis%last, t))) then
            call rest(analysis, t, step)
            return
         end if
      end if
      if (.not. analysis%follows) then
         call begin(analysis, t, step, list)
      else if (allocated(analysis%singular)) then
         call leave_position(analysis, t, step, list)
      else
         call follow(analysis%continuation_t, t, step, list)
      end if
   end subroutine continue_to_instant

   !> Finds the first motion. From a singular first position more than one motion begins. This motion begins close to
   !> that position, in the nearest assembly: at an instant further away another assembly may be nearest.
   subroutine begin(analysis, t, step, list)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< the time of the instant, in the deck's unit
      type(step_record_t), intent(inout) :: step           !< a new record; then how the step ended
      type(diagnostic_t), allocatable, intent(inout) :: list(:)   !< then the change points on which the motion stands
      type(step_record_t) :: to_start
      real(wp) :: near

      if (allocated(analysis%singular)) then
         near = time_beside(analysis%path, analysis%last, t, start_offset)
         call continue_to(analysis%continuation_t, near, to_start)
         if (to_start%ending >= step_there .and. &
            .not. (analysis%convergence%singular .or. analysis%convergence%rates_inconsistent)) &
            call accept_substep(analysis%continuation_t, near)
      end if
      call follow(analysis%continuation_t, t, step, list)
   end subroutine begin

   !> Follows the motion from a singular position on which it stands. Back in time it is the motion before, unless a
   !> BRANCH card requests the other branch.
   subroutine leave_position(analysis, t, step, list)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< time to which the motion goes, in the deck's unit
      type(step_record_t), intent(inout) :: step           !< a new record; then how the step ended
      !> Then the change points on which the motion stands, or from which it has returned.
      type(diagnostic_t), allocatable, intent(inout) :: list(:)
      type(diagnostic_t), allocatable :: returns(:)

      if ((analysis%t - analysis%last)*(t - analysis%last) < 0.0_wp) then
         call leave(analysis%continuation_t, analysis%last, t, pack(analysis%blocks%moving, &
            analysis%singular(analysis%blocks%moving)), returns)
         step%dead_end = pack(returns, returns%kind == diagnostic_dead_end)
         if (size(step%dead_end) > 0) then
            step%ending = step_blocked
            return
         end if
      end if
      call follow(analysis%continuation_t, t, step, list)
      if (allocated(returns) .and. step%ending >= step_there .and. .not. (allocated(list) .or. passed_of(step) > 0 &
         .or. analysis%convergence%singular)) call move_alloc(returns, list)
   end subroutine leave_position

   !> Stays on a singular position, since no drive moves. Blocks without velocities keep their position; velocities and
   !> accelerations of the other blocks are solved for.
   subroutine rest(analysis, t, step)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< time until which no drive moves, in the deck's unit
      type(step_record_t), intent(inout) :: step           !< its ending becomes step_rests

      if (analysis%is_left) call restore(analysis%continuation_t, analysis%left)
      call solve_regular_blocks(analysis%continuation_t, t)
      step%ending = step_rests
   end subroutine rest

   !> Finds the motion at a time that is no instant of the deck, by continuity from the last instant, or from a time
   !> that was evaluated before: of many times in a row each costs a short step. The analysis stays at this time until
   !> `restore_instant`.
   subroutine evaluate_at(analysis, t, found, is_found)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< the time, in the deck's unit
      type(motion_t), intent(inout) :: found               !< (links) in the deck's units; of no use if not found
      logical, intent(out) :: is_found                     !< it has position, velocities and accelerations
      type(step_record_t) :: step
      type(diagnostic_t), allocatable :: list(:)

      is_found = .false.
      if (.not. analysis%follows .or. limit_before(analysis%limits, t) > 0) return
      if (.not. analysis%is_left) then
         analysis%left = analysis%continuation_state_t
         analysis%left_iterations = analysis%iterations
         analysis%is_left = .true.
      end if
      call continue_to_instant(analysis, t, step, list)
      if (step%ending >= step_there .and. (step%ending == step_rests &
         .or. .not. (analysis%convergence%singular .or. analysis%convergence%rates_inconsistent))) then
         found%t = t
         call accept_motion(analysis, found)
         is_found = found%known == 2 .and. is_solved(analysis%convergence)
      end if
      if (.not. is_found) then
         call revert(analysis%continuation_t, step)
      else if (step%tries > 1) then
         call accept_substep(analysis%continuation_t, t)
      end if
   end subroutine evaluate_at

   !> Puts the analysis back at the last instant, if `evaluate_at` has left it.
   subroutine restore_instant(analysis)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism

      if (.not. analysis%is_left) return
      call restore(analysis%continuation_t, analysis%left)
      analysis%iterations = analysis%left_iterations
      analysis%is_left = .false.
   end subroutine restore_instant

   !> Gives the motion at the end of a step, with certificate and remarks. A regular motion is followed from there on;
   !> from a singular position the motion before stays the one that is followed.
   subroutine arrive(analysis, step, list, found)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      type(step_record_t), intent(inout) :: step           !< that has come to the instant
      type(diagnostic_t), allocatable, intent(inout) :: list(:)   !< its change points; not allocated: none
      type(motion_t), intent(inout) :: found               !< at the time found%t; (links) in the deck's units
      integer :: was
      logical :: had_missed, crosses, goes_on

      was = min(analysis%phase, on_motion)
      had_missed = analysis%has_missed
      if (analysis%convergence%singular .and. step%ending == step_there) then
         call go_by_value(analysis%continuation_t, found%t, step, list)
         if (analysis%convergence%singular .and. analysis%follows .and. .not. allocated(list)) then
            list = change_diagnostics(analysis%blocks, analysis%geometry, analysis%state, found%t)
            if (size(list) > 0) step%ending = step_stands
         end if
      end if

      call accept_motion(analysis, found)
      if (step%ending == step_stands .and. found%flag == flag_singular) found%singularity = singular_change
      analysis%max_closure_error = max(analysis%max_closure_error, analysis%convergence%open%value)
      crosses = passed_of(step) > 0
      if (crosses) call add_diagnostics(step%passed, found)
      if (allocated(list)) then
         call add_diagnostics(list, found)
         crosses = crosses .or. any(list%other)
      end if

      if (analysis%has_missed) then
         call mark_known(found, -1, flag_not_converged)
         call get_driven_links(analysis%blocks, analysis%geometry, analysis%path, found%t, analysis%work, &
            analysis%state, found)
         analysis%branch = branch_t()
         ! Of missed instants in a row only the first has the remark.
         if (.not. had_missed) call add_diagnostics([diagnostic_t(kind=diagnostic_method, &
            other=analysis%convergence%ended == ended_elsewhere)], found)
      else
         call certify(analysis, was, step, crosses)
         if (was /= on_motion) call add_first_diagnostics(analysis, was, found)
      end if

      goes_on = found%known == 2 .and. .not. found%rests
      if (allocated(analysis%dense)) goes_on = .not. any(analysis%state%is_singular(analysis%blocks%needed))
      if (allocated(analysis%singular)) deallocate (analysis%singular)
      if (goes_on) then
         call accept_substep(analysis%continuation_t, found%t)
      else
         call revert(analysis%continuation_t, step)
         if (any(analysis%state%is_singular(analysis%blocks%needed))) analysis%singular = analysis%state%is_singular
      end if
      if (analysis%follows) then
         analysis%phase = on_motion
      else if (.not. analysis%has_missed) then
         analysis%phase = at_start
      end if
   end subroutine arrive

   !> Records the certificate of the position at the end of a step, and counts it.
   subroutine certify(analysis, was, step, crosses)
      type(analysis_t), intent(inout) :: analysis          !< branch and certificate_counts are set
      integer, intent(in) :: was                           !< the phase before: not_begun, at_start or on_motion
      type(step_record_t), intent(in) :: step              !< that has come to the instant
      logical, intent(in) :: crosses                       !< the motion passed change points on the step

      if (step%ending == step_rests) then
         analysis%branch = branch_t(kind=min(analysis%branch%kind, branch_same))
      else
         analysis%branch = step%branch
         analysis%branch%kind = merge(branch_crossed, branch_same, crosses)
         if (analysis%convergence%singular .and. step%ending == step_there) analysis%branch%kind = branch_none
      end if
      if (was /= on_motion) analysis%branch%kind = branch_first
      associate (counts => analysis%certificate_counts)
         if (analysis%branch%kind == branch_none) counts%uncertain = counts%uncertain + 1
         if (analysis%branch%kind >= branch_same) counts%followed = counts%followed + 1
      end associate
   end subroutine certify

   !> Adds the remarks about the first position, or about the first motion after positions without a motion. A motion
   !> that is already followed began near a singular position and gets no remark about the deck's estimate.
   subroutine add_first_diagnostics(analysis, was, found)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      integer, intent(in) :: was                           !< the phase before: not_begun or at_start
      type(motion_t), intent(inout) :: found               !< remarks are added

      if (was == at_start) then
         if (found%known < 2) return
         call add_diagnostics([diagnostic_t(kind=diagnostic_begins)], found)
      end if
      if (.not. analysis%follows) call add_diagnostics(start_diagnostics(analysis%blocks, analysis%geometry, &
         analysis%guess, analysis%state, found, analysis%convergence%singular), found)
   end subroutine add_first_diagnostics

   !> Ends a step that has found no motion at an instant. One remark names the equation that is not satisfied, or the
   !> end of the motion. The motion is followed again from the instant before. A limit is recorded unless equations
   !> contradict one another: at `near_limit_part` of the step beyond the last motion if no substep could be made from
   !> there, otherwise at the instant itself.
   subroutine stop_at(analysis, t, step, found)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< time of the instant, in the deck's unit
      type(step_record_t), intent(in) :: step              !< that has not come to the instant
      type(motion_t), intent(inout) :: found               !< (links) flagged; only links that drives move are known
      type(diagnostic_t), allocatable :: list(:)
      real(wp) :: ahead
      logical :: inconsistent

      if (allocated(step%passed)) call add_diagnostics(step%passed, found)
      analysis%branch = branch_t()
      inconsistent = analysis%convergence%ended == ended_inconsistent
      if (inconsistent) then
         ! An equation of a drive may be one that is not satisfied: even links that only drives move have no position.
         call mark_known(found, -1, flag_inconsistent)
         ! The closure error is measured at the instant itself, not at the end of the last substep.
         if (step%tries > 1) call measure_closure_error(analysis%continuation_t, t)
         analysis%max_closure_error = max(analysis%max_closure_error, analysis%convergence%open%value)
      else
         call mark_known(found, -1, flag_not_converged)
         call get_driven_links(analysis%blocks, analysis%geometry, analysis%path, t, &
            analysis%work, analysis%state, found)
      end if

      allocate (list(0))
      if (analysis%convergence%open%value > 0.0_wp .and. (inconsistent .or. .not. analysis%follows)) then
         associate (worst => analysis%convergence%open)
            call add_diagnostics([diagnostic_t(kind=diagnostic_inconsistent, pair=worst%pair, drive=worst%drive, &
               is_angle=worst%is_angle, value=worst%value &
               *merge(1.0_wp, analysis%geometry%equations%length*worst%unit, worst%is_angle))], found)
         end associate
      else
         ahead = t
         ! Up to the infinity of a slide more substeps lie than are tried.
         if (step%ending == step_creeps) ahead = analysis%t + sign(min(abs(t - analysis%t), &
            creeping_part*abs(analysis%t - analysis%place%t)), t - analysis%t)

         list = limit_diagnostic(analysis%blocks, analysis%geometry, analysis%path, analysis%history, analysis%state, &
            ahead, step%ending == step_creeps)
         if (.not. analysis%follows .and. analysis%convergence%ended == ended_elsewhere .and. &
            analysis%convergence%open%pair > 0) &
            list = [diagnostic_t(kind=diagnostic_stroke, pair=analysis%convergence%open%pair)]
         if (analysis%follows .and. size(analysis%geometry%cylinders) > 0) &
            call find_length_limit(analysis%continuation_t, t, list)
         if (size(list) == 0 .and. analysis%follows .and. step%ending == step_blocked) &
            list = [diagnostic_t(kind=diagnostic_close, t=analysis%t)]
      end if
      if (step%ending == step_creeps) then
         if (size(list) == 0) list = [diagnostic_t(kind=diagnostic_long, t=analysis%place%t)]
      else if (allocated(step%dead_end)) then
         if (size(step%dead_end) > 0) list = step%dead_end
      end if
      if (analysis%phase <= on_motion) call add_diagnostics(list, found)

      if (analysis%follows .and. .not. inconsistent .and. abs(t - analysis%place%t) > 0.0_wp) &
         analysis%limits(merge(2, 1, t > analysis%place%t)) = limit_t(.true., &
         merge(analysis%t + near_limit_part*(t - analysis%place%t), t, step%ending == step_blocked), list)
      call revert(analysis%continuation_t, step)
      if (analysis%follows) analysis%phase = lost
      if (allocated(analysis%singular)) deallocate (analysis%singular)
   end subroutine stop_at

   !> Leaves out an instant beyond a limit: no position is solved for. The first of such instants gets the remark about
   !> the limit, each later one the remark that it lies beyond.
   subroutine skip_instant(analysis, t, found)
      type(analysis_t), intent(inout) :: analysis   !< of the mechanism
      real(wp), intent(in) :: t                            !< the time of the instant, in the deck's unit
      type(motion_t), intent(inout) :: found               !< (links) flagged; only links that drives move are known
      integer :: side

      call mark_known(found, -1, flag_not_converged)
      call get_driven_links(analysis%blocks, analysis%geometry, analysis%path, t, analysis%work, analysis%state, found)
      analysis%convergence = solve_report_t(ended=ended_unsought)
      analysis%branch = branch_t()
      side = limit_before(analysis%limits, t)
      associate (told => analysis%limits(side)%diagnostics)
         if (analysis%phase <= on_motion) then
            call add_diagnostics(told, found)
         else if (any(told%kind == diagnostic_limit)) then
            call add_diagnostics([diagnostic_t(kind=diagnostic_beyond, &
               t=told(findloc(told%kind, diagnostic_limit, dim=1))%t)], found)
         end if
      end associate
      analysis%phase = beyond
   end subroutine skip_instant

   !> Gives the motion of the links at found%t by the method, from the motion that the blocks have found, and flags the
   !> parts that do not exist. If all drives rest, a motion that has come to a singular position rests there. This does
   !> not hold for a first position, since undriven links may move.
   subroutine accept_motion(analysis, found)
      type(analysis_t), intent(inout) :: analysis          !< with the blocks' motion
      type(motion_t), intent(inout) :: found               !< (links) in the deck's units
      integer :: link, last
      logical :: finite

      if (allocated(analysis%dense)) then
         call solve_all_links(analysis%dense, analysis%blocks, analysis%geometry, analysis%path, &
            analysis%guess%values, analysis%history, analysis%state, found, analysis%convergence)
         analysis%has_missed = .not. is_solved(analysis%convergence)
         finite = .false.
      else
         call move_links(analysis%geometry%chain, analysis%geometry%chain%wanted, analysis%state, found, finite)
      end if
      if (size(analysis%blocks%ratios) > 0) call get_ratios(analysis%blocks, analysis%geometry, analysis%path, &
         analysis%state%is_singular, analysis%state, analysis%work, found)

      call mark_known(found, 2, flag_none)
      found%rests = analysis%convergence%singular .and. analysis%follows
      if (found%rests) found%rests = .not. any(moving_drives(analysis%path, found%t, found%t))
      if (found%rests) then
         found%velocity = 0.0_wp
         found%acceleration = 0.0_wp
      else
         if (analysis%convergence%singular) call mark_known(found, 0, flag_singular)
         if (analysis%convergence%rates_inconsistent) call mark_known(found, 0, flag_inconsistent)
         ! If rates contradict one another, no link has velocities.
         if (found%flag == flag_singular) call get_link_flags(analysis%blocks, analysis%geometry, analysis%state, &
            allocated(analysis%dense), found)
      end if
      if (finite) return

      ! Numbers out of the range of the real kind count as unknown.
      do link = 1, size(found%position, 2)
         last = known_of(found, link)
         if (last == 2 .and. .not. all(abs(found%acceleration(:, link)) <= huge(1.0_wp))) last = 1
         if (last >= 1 .and. .not. all(abs(found%velocity(:, link)) <= huge(1.0_wp))) last = 0
         if (.not. all(abs(found%position(:, link)) <= huge(1.0_wp))) last = -1
         if (last >= known_of(found, link)) cycle

         if (.not. allocated(found%link_known)) then
            allocate (found%link_known(size(found%position, 2)), source=found%known)
            allocate (found%link_flag(size(found%position, 2)), source=found%flag)
         end if
         found%link_known(link) = last
         found%link_flag(link) = flag_overflow
         if (last < found%known) found%flag = flag_overflow
         found%known = min(found%known, last)
      end do
   end subroutine accept_motion

   !> Marks a motion as known up to a derivative, equally for all links.
   pure subroutine mark_known(found, known, flag)
      type(motion_t), intent(inout) :: found               !< known and flag are set; flags of links are removed
      integer, intent(in) :: known                         !< the last derivative that is known; -1: no position
      integer, intent(in) :: flag                          !< why no more is known: flag_none, flag_singular, ...

      call forget_links(found)
      if (found%flag /= flag_none) then
         found%singularity = singular_unclear
         found%singular_links = diagnostic_t()
      end if
      found%known = known
      found%flag = flag
   end subroutine mark_known

   !> Gives the largest closure error of redundant equations so far, in units of their loops or rad; -1 without
   !> redundant equations.
   pure real(wp) function redundancy_error(analysis)
      type(analysis_t), intent(in) :: analysis   !< of the mechanism

      redundancy_error = -1.0_wp
      if (analysis%blocks%redundant > 0) redundancy_error = analysis%max_closure_error
   end function redundancy_error

   !> Makes the mechanism that the blocks solve for METHOD DENSE and METHOD MATRIX: METHOD NEWTON for all its links, to
   !> the limit of rounding.
   pure function for_blocks(m) result(own)
      type(mechanism_t), intent(in) :: m
      type(mechanism_t) :: own

      own = with_all_links(m)
      own%method = method_newton
      own%tolerance = 0.0_wp
   end function for_blocks

   !> Moves structure, geometry, guess and workspace from one continuation to another.
   subroutine move_memory(old, new)
      type(continuation_t), intent(inout) :: old, new      !< from which, and to which, they are moved

      call move_alloc(old%blocks, new%blocks)
      call move_alloc(old%geometry, new%geometry)
      call move_alloc(old%guess, new%guess)
      call move_alloc(old%work, new%work)
   end subroutine move_memory
end module analysis
