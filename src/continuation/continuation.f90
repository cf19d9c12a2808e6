!> The motion that is followed, and its continuation to another instant in substeps: an assembly is never changed in
!> silence. The limits of the motion on either side are kept: by continuity no instant beyond a limit is reached,
!> whatever instants come between, and the limit need not be searched for again.
!>
!> The branch of an instant is verified on the step to it. SAME: on every substep the prediction was off by less than a
!> tenth of the distance within which there is one root only (Newton and Kantorovich), and the determinants of all
!> blocks have kept their signs. CROSSED: SAME but for change points that were passed, each within a short substep, and
!> listed.
module continuation
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use structure, only: structure_t, make_structure
   use motion, only: motion_t, new_motion, diagnostic_t, diagnostic_dead_end
   use drive_deviation, only: drive_deviation_t, new_drive_excursion, limit_substep, examine
   use drive_path, only: drive_path_t, drive_at
   use convergence, only: solve_report_t, nothing_gathered, is_solved, ended_singular, &
      ended_inconsistent, max_kantorovich_ratio
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t, new_state, set_drive_values
   use block_solver, only: workspace_t, new_workspace, solve_blocks
   use block_motion, only: select_solved_blocks, assign_path
   use initial_estimate, only: guess_t, assign_guess
   use predictor, only: history_t, new_history, predict, compare, accept, recall, largest_predicted_change
   use link_motion, only: move_links
   use cylinders, only: cylinders_of, cylinder_motion, stays_within
   use initial_assembly, only: solve_first
   use branch_switching, only: pass, is_smooth_passage, branch_requests_t, new_branch_requests
   implicit none
   private
   public :: continuation_t, step_record_t, begin_continuation, follow_structure, begin_motion, solve_at, &
      measure_closure_error, continue_to, accept_substep, revert, follow_from, continuation_state_t, &
      restore, passed_of
   public :: step_failed, step_blocked, step_creeps, step_there, step_stands, step_rests
   public :: limit_t, limit_before, largest_correction, lengths_followed
   public :: branch_t, certificate_counts_t, branch_none, branch_first, branch_same, branch_crossed

   !> The largest correction, in units of the loops and rad, of a predicted position that still counts as the
   !> continuation of the motion; if the prediction is off by more, the step is divided.
   real(wp), parameter :: largest_correction = 0.1_wp
   !> A substep smaller than this part of the longest one, or of the way that is left, cannot be made: the motion is
   !> blocked there.
   real(wp), parameter :: min_substep_part = max(1.0e-10_wp, 4.0_wp*epsilon(1.0_wp))
   integer, parameter :: max_substeps = 200000   !< of one step: a drive may turn 30000 times between two instants
   !> So many small substeps without a position end the continuation: near a limit each of them costs all iterations.
   integer, parameter :: max_failures = 300
   !> A substep below this part of the longest one is small.
   real(wp), parameter :: small_substep_part = 1.0e-3_wp
   !> A substep that ends so near a change point that there are no velocities is made longer, to end beyond it, at most
   !> so many times: shorter substeps would come up to the change point and never across.
   integer, parameter :: max_longer = 8

   !> The length of a cylinder changes at most by this factor times the excursion of the drives off their chords.
   real(wp), parameter :: length_by_chord = 2.0_wp

   ! The certificates of a position.
   integer, parameter :: branch_none = 0      !< nothing is verified
   integer, parameter :: branch_first = 1     !< chosen by the deck's estimated position
   integer, parameter :: branch_same = 2      !< the branch of the motion that is followed
   integer, parameter :: branch_crossed = 3   !< the branch of the motion that is followed, through change points

   !> How a step ends. From step_there on it has come to its instant.
   enum, bind(c)
      enumerator :: step_failed = 0   !< no position is found
      enumerator :: step_blocked      !< no further substep can be made
      enumerator :: step_creeps       !< the largest number of substeps has been made
      enumerator :: step_there        !< at the instant, which has a position
      enumerator :: step_stands       !< at the instant, on a change point; the motion before is still followed
      enumerator :: step_rests        !< at the instant, on the singular position of the instant before
   end enum

   !> The certificate of one step.
   type :: branch_t
      integer :: kind = branch_none              !< branch_first, ...
      integer :: substeps = 0                    !< substeps made on the step
      real(wp) :: kantorovich_ratio = 0.0_wp     !< largest ratio of a correction to the distance of the next root
   end type branch_t

   !> Sums over the instants of a set, for the listing's line CONTINUATION.
   type :: certificate_counts_t
      integer :: followed = 0    !< instants with a certificate
      integer :: passed = 0      !< change points that were passed
      integer :: uncertain = 0   !< instants with a position but without a certificate, but for the first instant
   end type certificate_counts_t

   !> A state of the motion that is followed: all data on which its continuation depends.
   type :: continuation_state_t
      real(wp) :: t = 0.0_wp                     !< parameter of the path: the time, but on a leg
      type(history_t) :: history                 !< the motions that are followed
      type(state_t) :: state                     !< the motion found last
      type(branch_requests_t) :: branch_requests !< BRANCH cards, and change points passed
      type(solve_report_t) :: convergence        !< of the position solved for last
   end type continuation_state_t

   !> A mechanism for the solver, and the state of its motion.
   type, extends(continuation_state_t) :: continuation_t
      type(blocks_t), allocatable :: blocks      !< its structure, constant
      type(geometry_t), allocatable :: geometry  !< by the numbers of its cards
      type(drive_path_t) :: path                 !< of its drives
      type(guess_t), allocatable :: guess        !< the initial guess, near which its first position is searched for
      type(workspace_t), allocatable :: work     !< scratch of the solver
      integer :: iterations = 0                  !< of all positions so far
      logical :: follows = .false.               !< a regular motion is followed, found at `t`
      type(continuation_state_t) :: place        !< the state in which the last divided step began
      type(drive_deviation_t) :: drives          !< bounds of the drives between the instants
   end type continuation_t

   !> A step of the continuation, from one instant to another.
   type :: step_record_t
      integer :: ending = step_failed            !< step_failed, ...
      integer :: tries = 0                       !< substeps tried; 0: a new record
      type(branch_t) :: branch                   !< the certificate of the substeps made
      type(diagnostic_t), allocatable :: passed(:)     !< change points passed; not allocated: none
      type(diagnostic_t), allocatable :: dead_end(:)   !< change points at which it ends; not allocated: none
   end type step_record_t

   !> A limit on one side: instants from `t` on lie beyond it. A motion has two, the earlier and the later one.
   type :: limit_t
      logical :: known = .false.                 !< there is a limit
      real(wp) :: t = 0.0_wp                     !< its time, in the deck's unit
      type(diagnostic_t), allocatable :: diagnostics(:)   !< the reason
   end type limit_t

contains

   !> Makes the continuation of a mechanism ready for its first instant.
   subroutine begin_continuation(continuation, m)
      type(continuation_t), intent(out) :: continuation   !< of the mechanism
      type(mechanism_t), intent(in) :: m
      type(structure_t) :: structure

      call make_structure(m, structure)
      call follow_structure(continuation, m, structure)
   end subroutine begin_continuation

   !> Makes the continuation of a mechanism whose structure is known ready for its first instant.
   subroutine follow_structure(continuation, m, structure)
      type(continuation_t), intent(out) :: continuation   !< of the mechanism
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout) :: structure   !< of `m`; its blocks and its geometry are moved away

      call move_alloc(structure%blocks, continuation%blocks)
      call move_alloc(structure%geometry, continuation%geometry)
      call select_solved_blocks(m, continuation%blocks, continuation%geometry)
      if (continuation%blocks%solvable) then
         continuation%work = new_workspace(continuation%blocks)
         allocate (continuation%guess)
         call assign_path(m, continuation%blocks, continuation%geometry, continuation%path)
      end if
      call begin_motion(continuation, m)
   end subroutine follow_structure

   !> Puts a continuation into the state before the first instant: guess, empty history, BRANCH cards, bounds of drives.
   subroutine begin_motion(continuation, m)
      type(continuation_t), intent(inout) :: continuation   !< with structure, geometry and path of `m`
      type(mechanism_t), intent(in) :: m
      logical :: depends

      continuation%geometry%cylinders = cylinders_of(m, .false.)
      depends = .true.
      if (continuation%blocks%solvable) then
         call assign_guess(m, continuation%blocks, continuation%geometry, continuation%guess)
         continuation%state = new_state(continuation%blocks, size(m%drives))
         continuation%history = new_history(continuation%blocks, m%predictor)
         ! Some unknown is iterated, from its value before.
         depends = size(continuation%history%predicted) > 0
      end if
      continuation%branch_requests = new_branch_requests(m)
      continuation%drives = new_drive_excursion(m, depends)
   end subroutine begin_motion

   !> Solves for a motion, by continuation of the motion that is followed or, without one, nearest to the initial guess.
   !> If the prediction changes by more than `largest_predicted_change`, nothing is solved, and the determinants do not
   !> count as kept.
   subroutine solve_at(continuation, t)
      type(continuation_t), intent(inout) :: continuation   !< state and convergence are set
      real(wp), intent(in) :: t              !< parameter of the path, in the deck's unit of time

      associate (b => continuation%blocks, x => continuation%geometry, s => continuation%state, &
         c => continuation%convergence)
         if (.not. b%solvable) then
            c = solve_report_t(ended=ended_singular)
            return
         end if
         call set_drive_values(continuation%path, t, s)
         if (.not. continuation%follows) then
            call solve_first(b, x, continuation%guess, continuation%work, s, c)
            return
         end if

         call predict(continuation%history, t, s%u, s%change)
         if (s%change > largest_predicted_change) then
            c = nothing_gathered
            c%determinant_signs_kept = .false.
            s%crossed = .false.
            return
         end if
         call solve_blocks(b, x, b%moving, continuation%work, s, c)
         if (.not. is_solved(c)) return
         call compare(b, x, b%moving, continuation%history, s, c)
         if (s%excursion > 0.0_wp) c%is_certain = is_smooth_passage(b, x, continuation%history, s, c%change)
      end associate
   end subroutine solve_at

   !> Finds the closure error of redundant equations at an instant at which they contradict one another: from the motion
   !> that is followed or, if that is too far, from the initial guess. If neither finds it, the report stays but for its
   !> closure error, which is 0.
   subroutine measure_closure_error(continuation, t)
      type(continuation_t), intent(inout) :: continuation   !< state and convergence are set
      real(wp), intent(in) :: t              !< time of the instant, in the deck's unit
      type(solve_report_t) :: before

      before = continuation%convergence
      call solve_at(continuation, t)
      if (continuation%convergence%ended == ended_inconsistent) return
      call solve_first(continuation%blocks, continuation%geometry, continuation%guess, continuation%work, &
         continuation%state, continuation%convergence)
      if (continuation%convergence%ended == ended_inconsistent) return
      continuation%convergence = before
      continuation%convergence%open%value = 0.0_wp
   end subroutine measure_closure_error

   !> Follows the motion to a parameter of its path in substeps, or finds the first motion there. All substeps but the
   !> last are accepted; if the parameter is not reached, the motion stays where the last of them has come.
   subroutine continue_to(continuation, t, step)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      real(wp), intent(in) :: t              !< the parameter, in the deck's unit of time
      type(step_record_t), intent(inout) :: step   !< a new record; then how the step ended
      real(wp) :: substep, here, longest, allowed, shortest
      integer :: failures, longer
      logical :: accepted, grows, is_last

      if (asserts) call assert(step%tries == 0, 'continue_to: a new record')
      substep = t - continuation%t
      longest = abs(substep)
      shortest = min_substep_part*longest
      failures = 0
      longer = 0

      do while (step%tries < max_substeps)
         step%tries = step%tries + 1
         is_last = .not. continuation%follows
         if (continuation%follows) then
            substep = sign(min(abs(substep), abs(t - continuation%t)), substep)
            call limit_substep(continuation%drives, continuation%path, continuation%t, substep, allowed, &
               continuation%state%excursion)
            if (abs(allowed) < abs(substep)) longest = max(abs(allowed), shortest)
            substep = allowed
            is_last = abs(substep) >= abs(t - continuation%t)
         end if

         here = merge(t, continuation%t + substep, is_last)
         call try_substep(continuation, here, step, accepted)
         if (is_last .and. accepted) then
            step%ending = step_there
            return
         end if

         if (step%tries == 1) continuation%place = continuation%continuation_state_t
         grows = accepted .and. (longer < max_longer .or. .not. continuation%convergence%singular)
         accepted = accepted .and. .not. continuation%convergence%singular
         if (accepted) call accept_substep(continuation, here)

         if (.not. continuation%follows) return
         if (.not. is_solved(continuation%convergence) .and. abs(substep) <= small_substep_part*longest) &
            failures = failures + 1
         longer = merge(merge(0, longer + 1, accepted), max_longer, grows)
         substep = merge(1.5_wp, 0.5_wp, grows)*substep
         if (abs(substep) <= min_substep_part*min(longest, abs(t - continuation%t))) step%ending = step_blocked
         if (step%ending == step_blocked .or. failures > max_failures) return
      end do
      step%ending = step_creeps
   end subroutine continue_to

   !> Solves for a motion, and finds whether it is the continuation of the motion that is followed: its correction and
   !> its Kantorovich ratio are small, cylinders keep their bounds, and determinants keep their signs but for change
   !> points.
   subroutine try_substep(continuation, t, step, accepted)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      real(wp), intent(in) :: t              !< parameter of the path, in the deck's unit of time
      type(step_record_t), intent(inout) :: step   !< certificate and change points are added
      logical, intent(out) :: accepted       !< the motion is the continuation, or the first motion

      call solve_at(continuation, t)
      continuation%iterations = continuation%iterations + continuation%convergence%iterations
      accepted = is_solved(continuation%convergence)
      if (.not. continuation%follows) return
      accepted = accepted .and. continuation%convergence%change <= largest_correction
      ! The part of the ratio that drives add by leaving their chords does not count if the prediction is certain.
      ! Near a change point the inverse grows as substeps shrink, and that part never becomes small: no substep would
      ! come across.
      if (accepted .and. continuation%state%excursion > 0.0_wp .and. .not. continuation%convergence%is_certain) &
         call add_excursion(continuation, t)
      accepted = accepted .and. continuation%convergence%kantorovich_ratio <= max_kantorovich_ratio
      ! Lengths before change points: at the length 0 of a cylinder links may be in line.
      if (accepted .and. size(continuation%geometry%cylinders) > 0) call check_lengths(continuation, t, accepted)
      if (accepted .and. .not. continuation%convergence%determinant_signs_kept .and. &
         .not. continuation%convergence%singular) call pass_change_points(continuation, step)
      accepted = accepted .and. continuation%convergence%determinant_signs_kept

      if (.not. accepted) return
      step%branch%substeps = step%branch%substeps + 1
      step%branch%kantorovich_ratio = max(step%branch%kantorovich_ratio, continuation%convergence%kantorovich_ratio)
   end subroutine try_substep

   !> Finds the lengths (0:2, cylinders) of cylinders in the last accepted motion, with their derivatives, in the deck's
   !> units.
   function lengths_followed(continuation) result(lengths)
      type(continuation_t), intent(in) :: continuation   !< of the mechanism
      real(wp) :: lengths(0:2, size(continuation%geometry%cylinders))
      type(state_t) :: s

      s = continuation%state
      call recall(continuation%blocks, continuation%geometry, continuation%path, continuation%history, &
         continuation%guess%values, s)
      lengths = lengths_of(continuation%geometry, s)
   end function lengths_followed

   !> Finds the lengths (0:2, cylinders) of cylinders in a state, with their derivatives, in the deck's units.
   function lengths_of(x, s) result(lengths)
      type(geometry_t), intent(in) :: x      !< with the cylinders
      type(state_t), intent(in) :: s         !< with the motion of all unknowns
      real(wp) :: lengths(0:2, size(x%cylinders))
      type(motion_t) :: q
      logical :: finite
      integer :: k

      q = new_motion(size(x%equations%axes%angle_offset))
      call move_links(x%chain, size(x%chain%links), s, q, finite)
      do k = 1, size(x%cylinders)
         associate (i => x%cylinders(k)%i, j => x%cylinders(k)%j)
            lengths(:, k) = cylinder_motion(x%cylinders(k), &
               reshape([q%position(:, i), q%velocity(:, i), q%acceleration(:, i)], [3, 3]), &
               reshape([q%position(:, j), q%velocity(:, j), q%acceleration(:, j)], [3, 3]))
         end associate
      end do
   end function lengths_of

   !> Finds whether a substep keeps all cylinders within the bounds of their lengths, also between its ends: a drive
   !> that leaves its chord could take a length out of its bounds and back.
   subroutine check_lengths(continuation, t, accepted)
      type(continuation_t), intent(in) :: continuation   !< its state is at the end of the substep
      real(wp), intent(in) :: t              !< parameter of the path at the end of the substep, deck's unit of time
      logical, intent(inout) :: accepted     !< the substep keeps them; without cylinders it stays
      real(wp), dimension(0:2, size(continuation%geometry%cylinders)) :: first, last
      real(wp) :: away
      integer :: k

      first = lengths_followed(continuation)
      last = lengths_of(continuation%geometry, continuation%state)
      if (continuation%convergence%singular) last(1:, :) = 0.0_wp
      away = length_by_chord*continuation%state%excursion*continuation%geometry%equations%length
      do k = 1, size(continuation%geometry%cylinders)
         associate (bounds => continuation%geometry%cylinders(k)%bounds)
            accepted = stays_within(bounds, first(:1, k), last(:1, k), t - continuation%t)
            if (accepted .and. away > 0.0_wp) accepted = min(first(0, k), last(0, k)) - away > bounds(1) &
               .and. max(first(0, k), last(0, k)) + away < bounds(2)
            if (.not. accepted) return
         end associate
      end do
   end subroutine check_lengths

   !> Adds to the Kantorovich ratio of the motion found last the part of drives that leave their chords, or whose change
   !> their last rates do not predict: the predicted position may then be near another branch. Mostly the bound of the
   !> state is enough; otherwise the drives are examined on the substep.
   subroutine add_excursion(continuation, t)
      type(continuation_t), intent(inout) :: continuation   !< convergence%kantorovich_ratio is raised
      real(wp), intent(in) :: t              !< parameter of the path of that motion, in the deck's unit of time
      real(wp) :: ratio, change, away, off, h, first(3), last(3)
      integer :: i

      associate (c => continuation%convergence, path => continuation%path)
         ratio = c%kantorovich_ratio + c%amplification*continuation%state%excursion
         if (ratio > max_kantorovich_ratio) then
            call examine(continuation%drives, path, continuation%t, t, change, away)
            h = t - continuation%t
            do i = 1, size(continuation%drives%unit)
               first = drive_at(path, i, continuation%t)
               last = drive_at(path, i, t)
               off = last(1) - first(1) - h*(first(2) + 0.5_wp*h*first(3))
               if (abs(off) > 0.5_wp*abs(last(1) - first(1))) away = max(away, continuation%drives%unit(i)*abs(off))
            end do
            ratio = c%kantorovich_ratio + c%amplification*away
         end if
         c%kantorovich_ratio = ratio
      end associate
   end subroutine add_excursion

   !> Passes change points in a substep in which a determinant has changed its sign. If all are passed, the determinants
   !> count as kept; otherwise BRANCH cards and history stay. Reason for a procedure of its own: most substeps need no
   !> memory for the list.
   subroutine pass_change_points(continuation, step)
      type(continuation_t), intent(inout) :: continuation   !< with the motion found last
      type(step_record_t), intent(inout) :: step   !< change points that were passed are added, or dead ends are set
      type(diagnostic_t), allocatable :: list(:)
      type(branch_requests_t) :: before
      integer :: filled

      before = continuation%branch_requests
      filled = continuation%history%filled
      call pass(continuation%blocks, continuation%geometry, continuation%path, continuation%history, &
         continuation%work, continuation%state, continuation%branch_requests, continuation%convergence, list)
      if (continuation%convergence%determinant_signs_kept .and. continuation%convergence%kantorovich_ratio <= &
         max_kantorovich_ratio) then
         if (.not. allocated(step%passed)) allocate (step%passed(0))
         step%passed = [step%passed, list]
      else
         if (size(list) > 0 .and. .not. continuation%convergence%determinant_signs_kept) &
            step%dead_end = pack(list, list%kind == diagnostic_dead_end)
         continuation%convergence%determinant_signs_kept = .false.
         ! A dead point may look like a change point: no card is used up, and no motion forgotten.
         continuation%branch_requests = before
         continuation%history%filled = filled
      end if
   end subroutine pass_change_points

   !> Counts the change points that were passed in a step.
   pure integer function passed_of(step) result(passed)
      type(step_record_t), intent(in) :: step   !< made or failed

      passed = 0
      if (allocated(step%passed)) passed = size(step%passed)
   end function passed_of

   !> Makes the motion found last the motion that is followed.
   subroutine accept_substep(continuation, t)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      real(wp), intent(in) :: t              !< parameter of the path of that motion, in the deck's unit of time

      call accept(continuation%blocks, continuation%geometry, continuation%state, continuation%history)
      continuation%t = t
      continuation%follows = .true.
   end subroutine accept_substep

   !> Puts a continuation back to the state in which a step of two substeps or more began; the state found last stays.
   !> Reason: an instant without a motion shall not change later instants, and from close to a dead point no step back
   !> would be small enough.
   subroutine revert(continuation, step)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      type(step_record_t), intent(in) :: step   !< the step that is taken back

      if (step%tries < 2) return
      call follow_from(continuation, continuation%place)
      continuation%branch_requests = continuation%place%branch_requests
   end subroutine revert

   !> Follows the motion from an earlier state again; the motion found last stays.
   subroutine follow_from(continuation, place)
      type(continuation_t), intent(inout) :: continuation   !< t and history are set
      type(continuation_state_t), intent(in) :: place   !< the earlier state

      continuation%t = place%t
      continuation%history = place%history
   end subroutine follow_from

   !> Puts a continuation back into an earlier state, motion found last included. A later step can revert to this state.
   subroutine restore(continuation, place)
      type(continuation_t), intent(inout) :: continuation   !< of the mechanism
      type(continuation_state_t), intent(in) :: place   !< the earlier state

      continuation%continuation_state_t = place
      continuation%place = place
   end subroutine restore

   !> Gives the number of the known limit beyond which an instant lies, 1 or 2; 0: there is none.
   pure integer function limit_before(limits, t) result(k)
      type(limit_t), intent(in) :: limits(2)   !< the earlier limit and the later one
      real(wp), intent(in) :: t              !< time of the instant, in the deck's unit

      k = 0
      if (limits(1)%known .and. t <= limits(1)%t) k = 1
      if (limits(2)%known .and. t >= limits(2)%t) k = 2
   end function limit_before
end module continuation
