!> The motion that is followed, and its continuation to another instant, in as many substeps as that takes: an
!> assembly is never changed in silence. And its limits on either side: no continuity reaches an instant beyond one,
!> whatever is asked for in between, and it need not be searched for again.
!>
!> The branch of an instant is verified on the step to it. SAME: on every substep the prediction was off by less than a
!> tenth of the distance within which there is one root only (Newton and Kantorovich), and the determinants of all
!> blocks have kept their signs. CROSSED: as SAME, but for change points that were passed, each within a short substep,
!> and listed.
module following
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use structure, only: structure_t, make_structure
   use motion, only: motion_t, new_motion, diagnostic_t, diagnostic_dead_end
   use drive_deviation, only: drive_deviation_t, new_drive_excursion, limit_substep, examine
   use drive_path, only: drive_path_t, drive_at
   use convergence, only: convergence_t, nothing_gathered, is_solved, ended_singular, &
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
   use branch_switching, only: pass, is_short_and_right, branch_requests_t, new_branch_requests
   implicit none
   private
   public :: following_t, step_record_t, begin_following, follow_structure, begin_motion, solve_at, &
      measure_closure_error, continue_to, accept_substep, revert, follow_from, place_t, record_checkpoint, restore, &
      passed_of
   public :: step_failed, step_blocked, step_creeps, step_there, step_stands, step_rests
   public :: limit_t, limit_before, largest_correction, lengths_followed
   public :: branch_t, certificate_counts_t, branch_none, branch_first, branch_same, branch_crossed

   !> The largest correction, in characteristic lengths and rad, of a predicted position that still counts as the
   !> continuation of the motion; if the prediction is off by more, the step is divided.
   real(wp), parameter :: largest_correction = 0.1_wp
   !> A substep smaller than this part of the longest one, or of the way that is left, cannot be made: the motion is
   !> blocked there.
   real(wp), parameter :: min_substep_part = max(1.0e-10_wp, 4.0_wp*epsilon(1.0_wp))
   integer, parameter :: max_substeps = 200000
   !> Near a limit a slow iteration creeps, and each substep without a position costs all of its iterations: so many
   !> small substeps end the continuation too.
   integer, parameter :: max_failures = 300
   !> A substep below this part of the longest one is small.
   real(wp), parameter :: small_substep_part = 1.0e-3_wp
   !> A substep that ends so near a change point that there are no velocities is made longer, to end beyond it, at most
   !> so many times: shorter ones would come up to that place and never across.
   integer, parameter :: max_longer = 8

   !> Lengths change by so many times as much as drives leave their chords, at most.
   real(wp), parameter :: length_by_chord = 2.0_wp

   integer, parameter :: branch_none = 0      !< nothing is verified
   integer, parameter :: branch_first = 1     !< chosen by the deck's estimated position
   integer, parameter :: branch_same = 2      !< the branch of the motion that is followed
   integer, parameter :: branch_crossed = 3   !< this branch, through change points

   !> How a step ends. From step_there on it has come to the instant asked for.
   enum, bind(c)
      enumerator :: step_failed = 0   !< no position is found
      enumerator :: step_blocked      !< no substep can be made from where it has come
      enumerator :: step_creeps       !< the largest number of substeps is made
      enumerator :: step_there        !< it has a position
      enumerator :: step_stands       !< there, on a change point; the motion is still followed from before that
      enumerator :: step_rests        !< there, on the singular position of the instant before
   end enum

   !> The certificate of one step.
   type :: branch_t
      integer :: kind = branch_none              !< branch_first, ...
      integer :: substeps = 0                    !< made on the step
      real(wp) :: kantorovich_ratio = 0.0_wp     !< their largest correction over the distance of the next root
   end type branch_t

   !> Sums over the instants of a set, for the listing's line CONTINUATION.
   type :: certificate_counts_t
      integer :: followed = 0    !< instants with a certificate
      integer :: passed = 0      !< change points
      integer :: uncertain = 0   !< instants with a position but without a certificate, the first apart
   end type certificate_counts_t

   !> A place of the motion that is followed: all that its continuation depends on.
   type :: place_t
      real(wp) :: t = 0.0_wp                     !< time
      type(history_t) :: history                 !< the motions that are followed
      type(state_t) :: state                     !< the motion found last
      type(branch_requests_t) :: branch_requests !< and how change points were passed
      type(convergence_t) :: convergence         !< of the position solved for last
   end type place_t

   !> A mechanism as the solver has it, and how far its motion has come.
   type :: following_t
      type(blocks_t), allocatable :: blocks      !< its structure, constant
      type(geometry_t), allocatable :: geometry
      type(drive_path_t) :: path                 !< of its drives
      type(guess_t), allocatable :: guess        !< where its first position is searched for
      type(state_t) :: state                     !< the motion found last
      type(workspace_t), allocatable :: work
      type(history_t) :: history                 !< the motions that are followed
      type(branch_requests_t) :: branch_requests !< BRANCH cards, and change points passed
      type(convergence_t) :: convergence         !< of the position solved for last
      integer :: iterations = 0                  !< of all positions so far
      logical :: follows = .false.               !< a regular motion is followed, found at `t`
      real(wp) :: t = 0.0_wp                     !< time
      type(place_t) :: place                     !< where the step that was divided last began
      type(drive_deviation_t) :: drives          !< how far the drives leave their chords
   end type following_t

   !> A step of the continuation, from one instant to another.
   type :: step_record_t
      integer :: ending = step_failed            !< step_failed, ...
      integer :: tries = 0                       !< substeps tried
      type(branch_t) :: branch                   !< what was verified of the substeps made
      type(diagnostic_t), allocatable :: passed(:)     !< change points passed; not allocated: none
      type(diagnostic_t), allocatable :: dead_end(:)   !< change points at which it ends; not allocated: none
   end type step_record_t

   !> A limit on one side: instants from `t` on lie beyond it. A motion has two, the earlier and the later one.
   type :: limit_t
      logical :: known = .false.                 !< there is one
      real(wp) :: t = 0.0_wp                     !< time
      type(diagnostic_t), allocatable :: diagnostics(:)   !< the reason
   end type limit_t

contains

   !> Makes a mechanism ready for its first instant.
   subroutine begin_following(following, m)
      type(following_t), intent(out) :: following
      type(mechanism_t), intent(in) :: m
      type(structure_t) :: structure

      call make_structure(m, structure)
      call follow_structure(following, m, structure)
   end subroutine begin_following

   !> Makes a mechanism whose structure is known ready for its first instant.
   subroutine follow_structure(following, m, structure)
      type(following_t), intent(out) :: following
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout) :: structure   !< of the mechanism: its blocks and its geometry are taken over

      call move_alloc(structure%blocks, following%blocks)
      call move_alloc(structure%geometry, following%geometry)
      call select_solved_blocks(m, following%blocks, following%geometry)
      if (following%blocks%solvable) then
         following%work = new_workspace(following%blocks)
         allocate (following%guess)
         call assign_path(m, following%blocks, following%geometry, following%path)
      end if
      call begin_motion(following, m)
   end subroutine follow_structure

   !> Puts a mechanism into the state in which nothing is solved yet.
   subroutine begin_motion(following, m)
      type(following_t), intent(inout) :: following   !< with the structure and the geometry of the mechanism
      type(mechanism_t), intent(in) :: m
      logical :: depends

      following%geometry%cylinders = cylinders_of(m, .false.)
      depends = .true.
      if (following%blocks%solvable) then
         call assign_guess(m, following%blocks, following%geometry, following%guess)
         following%state = new_state(following%blocks, size(m%drives))
         following%history = new_history(following%blocks, m%predictor)
         ! Some unknown is searched for from its value before.
         depends = size(following%history%predicted) > 0
      end if
      following%branch_requests = new_branch_requests(m)
      following%drives = new_drive_excursion(m, depends)
   end subroutine begin_motion

   !> Solves for a motion, from the one that is followed or, if none is, nearest to the initial guess.
   subroutine solve_at(following, t)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: t              !< parameter of the path: the time, mostly

      associate (b => following%blocks, x => following%geometry, s => following%state, c => following%convergence)
         if (.not. b%solvable) then
            c = convergence_t(ended=ended_singular)
            return
         end if
         call set_drive_values(following%path, t, s)
         if (.not. following%follows) then
            call solve_first(b, x, following%guess, following%work, s, c)
            return
         end if

         call predict(following%history, t, s%u, s%change)
         if (s%change > largest_predicted_change) then
            c = nothing_gathered
            c%keeps_signs = .false.
            s%crossed = .false.
            return
         end if
         call solve_blocks(b, x, b%moving, following%work, s, c)
         if (.not. is_solved(c)) return
         call compare(b, x, b%moving, following%history, s, c)
         if (s%excursion > 0.0_wp) c%is_certain = is_short_and_right(b, x, following%history, s, c%change)
      end associate
   end subroutine solve_at

   !> Finds the closure error at an instant, from the motion that is followed or, if that is too far, from the initial
   !> guess. If neither search ends there, the record stays but for its closure error, which is 0.
   subroutine measure_closure_error(following, t)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: t              !< time of the instant
      type(convergence_t) :: before

      before = following%convergence
      call solve_at(following, t)
      if (following%convergence%ended == ended_inconsistent) return
      call solve_first(following%blocks, following%geometry, following%guess, following%work, following%state, &
         following%convergence)
      if (following%convergence%ended == ended_inconsistent) return
      following%convergence = before
      following%convergence%open%value = 0.0_wp
   end subroutine measure_closure_error

   !> Follows the motion in substeps, or finds the first. If no substep can be made, the record says how the step ended.
   subroutine continue_to(following, t, step)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: t              !< parameter of the path to which it goes
      type(step_record_t), intent(out) :: step
      real(wp) :: substep, here, longest, allowed, shortest
      integer :: failures, longer
      logical :: accepted, grows, is_last

      substep = t - following%t
      longest = abs(substep)
      shortest = min_substep_part*longest
      failures = 0
      longer = 0
      do while (step%tries < max_substeps)
         step%tries = step%tries + 1
         is_last = .not. following%follows
         if (following%follows) then
            substep = sign(min(abs(substep), abs(t - following%t)), substep)
            call limit_substep(following%drives, following%path, following%t, substep, allowed, &
               following%state%excursion)
            if (abs(allowed) < abs(substep)) longest = max(abs(allowed), shortest)
            substep = allowed
            is_last = abs(substep) >= abs(t - following%t)
         end if

         here = merge(t, following%t + substep, is_last)
         call try_substep(following, here, step, accepted)
         if (is_last .and. accepted) then
            step%ending = step_there
            return
         end if
         if (step%tries == 1) call record_checkpoint(following, following%place)
         grows = accepted .and. (longer < max_longer .or. .not. following%convergence%singular)
         accepted = accepted .and. .not. following%convergence%singular
         if (accepted) call accept_substep(following, here)

         if (.not. following%follows) return
         if (.not. is_solved(following%convergence) .and. abs(substep) <= small_substep_part*longest) &
            failures = failures + 1
         longer = merge(merge(0, longer + 1, accepted), max_longer, grows)
         substep = merge(1.5_wp, 0.5_wp, grows)*substep
         if (abs(substep) <= min_substep_part*min(longest, abs(t - following%t))) step%ending = step_blocked
         if (step%ending == step_blocked .or. failures > max_failures) return
      end do
      step%ending = step_creeps
   end subroutine continue_to

   !> Solves for a motion, and tells whether it is accepted as the continuation of the one that is followed.
   subroutine try_substep(following, t, step, accepted)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: t              !< parameter of the path
      type(step_record_t), intent(inout) :: step
      logical, intent(out) :: accepted       !< it is the continuation, or the first motion

      call solve_at(following, t)
      following%iterations = following%iterations + following%convergence%iterations
      accepted = is_solved(following%convergence)
      if (.not. following%follows) return
      accepted = accepted .and. following%convergence%change <= largest_correction
      ! Near a change point the inverse grows as substeps shrink, and the part that drives add by leaving their chords
      ! never becomes small: no substep would come across.
      if (accepted .and. following%state%excursion > 0.0_wp .and. .not. following%convergence%is_certain) &
         call add_excursion(following, t)
      accepted = accepted .and. following%convergence%kantorovich_ratio <= max_kantorovich_ratio
      ! Before a change point is passed: at the length 0 links may be in line.
      if (accepted .and. size(following%geometry%cylinders) > 0) call keep_lengths(following, t, accepted)
      if (accepted .and. .not. (following%convergence%keeps_signs .or. following%convergence%singular)) &
         call pass_change_points(following, step)
      accepted = accepted .and. following%convergence%keeps_signs

      if (.not. accepted) return
      step%branch%substeps = step%branch%substeps + 1
      step%branch%kantorovich_ratio = max(step%branch%kantorovich_ratio, following%convergence%kantorovich_ratio)
   end subroutine try_substep

   !> Finds the lengths (0:2, cylinders) of the motion that is followed, with their derivatives, in the deck's units.
   function lengths_followed(following) result(lengths)
      type(following_t), intent(in) :: following
      real(wp) :: lengths(0:2, size(following%geometry%cylinders))
      type(state_t) :: s

      s = following%state
      call recall(following%blocks, following%geometry, following%path, following%history, following%guess%values, s)
      lengths = lengths_of(following%geometry, s)
   end function lengths_followed

   !> Finds the lengths (0:2, cylinders) of a state, with their derivatives, in the deck's units.
   function lengths_of(x, s) result(lengths)
      type(geometry_t), intent(in) :: x
      type(state_t), intent(in) :: s
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

   !> Tells whether a substep keeps all cylinders within the bounds of their lengths, also between its ends: a drive
   !> that leaves its chord could take a length out of them and back.
   subroutine keep_lengths(following, t, accepted)
      type(following_t), intent(in) :: following
      real(wp), intent(in) :: t              !< parameter of the path at the end of the substep
      logical, intent(inout) :: accepted     !< it keeps them
      real(wp), dimension(0:2, size(following%geometry%cylinders)) :: first, last
      real(wp) :: away
      integer :: k

      first = lengths_followed(following)
      last = lengths_of(following%geometry, following%state)
      if (following%convergence%singular) last(1:, :) = 0.0_wp
      away = length_by_chord*following%state%excursion*following%geometry%equations%length
      do k = 1, size(following%geometry%cylinders)
         associate (bounds => following%geometry%cylinders(k)%bounds)
            accepted = stays_within(bounds, first(:1, k), last(:1, k), t - following%t)
            if (accepted .and. away > 0.0_wp) accepted = min(first(0, k), last(0, k)) - away > bounds(1) &
               .and. max(first(0, k), last(0, k)) + away < bounds(2)
            if (.not. accepted) return
         end associate
      end do
   end subroutine keep_lengths

   !> Adds to the Kantorovich ratio of the motion found last the part of drives that leave their chords, or do not go as
   !> they did: a position predicted from their rates may then be near another branch. A bound at hardly any cost is
   !> enough mostly.
   subroutine add_excursion(following, t)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: t              !< parameter of the path of that motion
      real(wp) :: ratio, change, away, off, h, first(3), last(3)
      integer :: i

      associate (c => following%convergence, path => following%path)
         ratio = c%kantorovich_ratio + c%amplification*following%state%excursion
         if (ratio > max_kantorovich_ratio) then
            call examine(following%drives, path, following%t, t, change, away)
            h = t - following%t
            do i = 1, size(following%drives%unit)
               first = drive_at(path, i, following%t)
               last = drive_at(path, i, t)
               off = last(1) - first(1) - h*(first(2) + 0.5_wp*h*first(3))
               if (abs(off) > 0.5_wp*abs(last(1) - first(1))) away = max(away, following%drives%unit(i)*abs(off))
            end do
            ratio = c%kantorovich_ratio + c%amplification*away
         end if
         c%kantorovich_ratio = ratio
      end associate
   end subroutine add_excursion

   !> Passes change points in a substep in which a determinant has changed its sign. Beyond them the motion goes on as
   !> if the sign were kept. In a procedure of its own, since a plain substep has no room to make for the list.
   subroutine pass_change_points(following, step)
      type(following_t), intent(inout) :: following
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable :: list(:)
      type(branch_requests_t) :: before
      integer :: filled

      before = following%branch_requests
      filled = following%history%filled
      call pass(following%blocks, following%geometry, following%path, following%history, following%work, &
         following%state, following%branch_requests, following%convergence, list)
      if (following%convergence%keeps_signs .and. following%convergence%kantorovich_ratio <= max_kantorovich_ratio) then
         if (.not. allocated(step%passed)) allocate (step%passed(0))
         step%passed = [step%passed, list]
      else
         if (size(list) > 0 .and. .not. following%convergence%keeps_signs) &
            step%dead_end = pack(list, list%kind == diagnostic_dead_end)
         following%convergence%keeps_signs = .false.
         ! Close to a dead point it may only look like a change point: no card is used up, and no motion forgotten.
         following%branch_requests = before
         following%history%filled = filled
      end if
   end subroutine pass_change_points

   !> Counts the change points that were passed in a step.
   pure integer function passed_of(step) result(passed)
      type(step_record_t), intent(in) :: step

      passed = 0
      if (allocated(step%passed)) passed = size(step%passed)
   end function passed_of

   !> Makes the motion found last the one that is followed.
   subroutine accept_substep(following, t)
      type(following_t), intent(inout) :: following
      real(wp), intent(in) :: t              !< parameter of the path of that motion

      call accept(following%blocks, following%geometry, following%state, following%history)
      following%t = t
      following%follows = .true.
   end subroutine accept_substep

   !> Follows the motion again from the place at which a step began: instants after one without a motion are as if that
   !> had not been asked for. From close to a dead point no step back would be small enough.
   subroutine revert(following, step)
      type(following_t), intent(inout) :: following
      type(step_record_t), intent(in) :: step

      if (step%tries < 2) return
      call follow_from(following, following%place)
      following%branch_requests = following%place%branch_requests
   end subroutine revert

   !> Follows the motion at a place again; the motion found last stays.
   subroutine follow_from(following, place)
      type(following_t), intent(inout) :: following
      type(place_t), intent(in) :: place

      following%t = place%t
      following%history = place%history
   end subroutine follow_from

   !> Records the place at which the motion is followed.
   subroutine record_checkpoint(following, place)
      type(following_t), intent(in) :: following
      type(place_t), intent(inout) :: place

      place%t = following%t
      place%history = following%history
      place%state = following%state
      place%branch_requests = following%branch_requests
      place%convergence = following%convergence
   end subroutine record_checkpoint

   !> Follows the motion again from a place, to which a later step can go back.
   subroutine restore(following, place)
      type(following_t), intent(inout) :: following
      type(place_t), intent(in) :: place

      following%t = place%t
      following%history = place%history
      following%state = place%state
      following%branch_requests = place%branch_requests
      following%convergence = place%convergence
      call record_checkpoint(following, following%place)
   end subroutine restore

   !> Gives the side of the limit beyond which an instant lies, 1 or 2; 0: beyond none that is known.
   pure integer function limit_before(limits, t) result(k)
      type(limit_t), intent(in) :: limits(2)   !< the earlier and the later one
      real(wp), intent(in) :: t              !< time of the instant

      k = 0
      if (limits(1)%known .and. t <= limits(1)%t) k = 1
      if (limits(2)%known .and. t >= limits(2)%t) k = 2
   end function limit_before
end module following
