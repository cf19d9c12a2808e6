!> The motion that is followed, and its continuation to another instant, in as many substeps as that takes: an
!> assembly is never changed in silence. And its limits on either side: an instant beyond one is not reached by
!> continuity, whatever is asked for in between, and need not be searched for again.
!>
!> The branch of an instant is what has been verified on the step to it. SAME: on every substep the prediction was off
!> by less than a tenth of the distance within which there is one root only (Newton and Kantorovich), and the
!> determinants of all blocks have kept their signs. CROSSED: as SAME, but for change points that were passed, each
!> within a short substep, and listed.
module following
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion, diagnostic_t, diagnostic_dead_end
   use drive_deviation, only: drive_deviation_t, new_drive_excursion, limit_substep, examine
   use drive_path, only: drive_at
   use convergence, only: convergence_t, is_solved, max_kantorovich_ratio
   use block_engine, only: block_engine_t, engine_state_t, accept, followed_state
   use block_state, only: state_t
   use link_motion, only: move_links
   use cylinders, only: cylinder_t, cylinder_motion, stays_within
   use initial_assembly, only: solve_instant
   use branch_switching, only: pass, branch_requests_t, new_branch_requests
   implicit none
   private
   public :: following_t, step_record_t, begin_following, continue_to, go_on_from, go_back, follow_from, &
      place_t, note_place, return_to, passed_of
   public :: step_blocked, step_creeps, step_there, step_stands, step_rests
   public :: limit_t, limit_before, largest_correction, lengths_followed
   public :: branch_t, certificate_counts_t, branch_none, branch_first, branch_same, branch_crossed

   !> The largest correction, in the characteristic length and in radians, of a predicted position that still counts as
   !> the continuation of the motion; where the prediction is off by more, the step is divided.
   real(wp), parameter :: largest_correction = 0.1_wp
   !> A substep smaller than this part of the longest one, or of what is left to go, cannot be made: the motion is
   !> blocked there. So many substeps at most are tried.
   real(wp), parameter :: min_substep = max(1.0e-10_wp, 4.0_wp*epsilon(1.0_wp))
   integer, parameter :: max_substeps = 200000
   !> Near a limit a slow iteration creeps, and each substep without a position costs all of its iterations: so many of
   !> small substeps end the continuation too.
   integer, parameter :: max_failures = 300
   real(wp), parameter :: small_substep = 1.0e-3_wp
   !> A substep that ends so near a change point that there are no velocities is made longer, to end beyond it, at most
   !> so many times: shorter ones would come up to that place and never across.
   integer, parameter :: max_longer = 8

   !> Lengths change by so many times as much as drives leave their chords, at most.
   real(wp), parameter :: off_chord = 2.0_wp

   integer, parameter :: branch_none = 0      !< nothing is verified
   integer, parameter :: branch_first = 1     !< chosen by the deck's estimated position
   integer, parameter :: branch_same = 2      !< that of the motion that is followed
   integer, parameter :: branch_crossed = 3   !< the same, through change points

   !> How a step ends. From step_there on it has come to the instant asked for.
   enum, bind(c)
      enumerator :: step_failed = 0   !< no position is found
      enumerator :: step_blocked      !< no substep can be made from where it has come
      enumerator :: step_creeps       !< the largest number of substeps is made
      enumerator :: step_there        !< it has a position
      enumerator :: step_stands       !< there, on a change point; the motion is still followed from before that
      enumerator :: step_rests        !< there, on the singular position of the instant before
   end enum

   !> What is certified of one step.
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
      type(engine_state_t) :: engine             !< the engine's part
      type(branch_requests_t) :: branch_requests !< and how change points were passed
      type(convergence_t) :: convergence         !< of the position solved for last
   end type place_t

   !> The engine, and how far it has come.
   type :: following_t
      type(block_engine_t), allocatable :: engine !< solves single instants
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
      type(diagnostic_t), allocatable :: passed(:), dead_end(:)   !< change points; not allocated: none
   end type step_record_t

   !> A limit on one side: instants from `t` on lie beyond it; what there is to say of it. A motion has two, the earlier
   !> and the later one.
   type :: limit_t
      logical :: known = .false.                 !< there is one
      real(wp) :: t = 0.0_wp                     !< time
      type(diagnostic_t), allocatable :: diagnostics(:)
   end type limit_t

contains

   !> Makes `f` ready for the first instant of `m`; its `engine` is taken over.
   subroutine begin_following(f, m, engine)
      type(following_t), intent(out) :: f
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), allocatable, intent(inout) :: engine
      logical :: depends

      call move_alloc(engine, f%engine)
      f%branch_requests = new_branch_requests(m)
      ! Some unknown is searched for from its value before.
      depends = .true.
      if (allocated(f%engine%history%predicted)) depends = size(f%engine%history%predicted) > 0
      f%drives = new_drive_excursion(m, depends)
   end subroutine begin_following

   !> Follows the motion to `t`, or finds the first; `step`: how that went.
   subroutine continue_to(f, t, step)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(out) :: step
      real(wp) :: substep, here, longest, allowed, shortest
      integer :: failures, longer
      logical :: accepted, grows, is_last

      substep = t - f%t
      longest = abs(substep)
      shortest = min_substep*longest
      failures = 0
      longer = 0
      do while (step%tries < max_substeps)
         step%tries = step%tries + 1
         is_last = .not. f%follows
         if (f%follows) then
            substep = sign(min(abs(substep), abs(t - f%t)), substep)
            call limit_substep(f%drives, f%engine%path, f%t, substep, allowed, f%engine%state%excursion)
            if (abs(allowed) < abs(substep)) longest = max(abs(allowed), shortest)
            substep = allowed
            is_last = abs(substep) >= abs(t - f%t)
         end if
         here = merge(t, f%t + substep, is_last)
         call attempt(f, here, step, accepted)
         if (is_last .and. accepted) then
            step%ending = step_there
            return
         end if
         if (step%tries == 1) call note_place(f, f%place)
         grows = accepted .and. (longer < max_longer .or. .not. f%convergence%singular)
         accepted = accepted .and. .not. f%convergence%singular
         if (accepted) call go_on_from(f, here)
         if (.not. f%follows) return
         if (.not. is_solved(f%convergence) .and. abs(substep) <= small_substep*longest) failures = failures + 1
         longer = merge(merge(0, longer + 1, accepted), max_longer, grows)
         substep = merge(1.5_wp, 0.5_wp, grows)*substep
         if (abs(substep) <= min_substep*min(longest, abs(t - f%t))) step%ending = step_blocked
         if (step%ending == step_blocked .or. failures > max_failures) return
      end do
      step%ending = step_creeps
   end subroutine continue_to

   !> Solves for the motion at `t`; `accepted`: it is the continuation of the one that is followed, or the first.
   subroutine attempt(f, t, step, accepted)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(inout) :: step
      logical, intent(out) :: accepted

      call solve_instant(f%engine, t, f%follows, f%convergence)
      f%iterations = f%iterations + f%convergence%iterations
      accepted = is_solved(f%convergence)
      if (.not. f%follows) return
      accepted = accepted .and. f%convergence%change <= largest_correction
      ! Beside a change point the inverse grows as substeps shrink, and what drives add by leaving their chords never
      ! becomes small: no substep would come across.
      if (accepted .and. f%engine%state%excursion > 0.0_wp .and. .not. f%convergence%is_certain) &
         call add_excursion(f, t)
      accepted = accepted .and. f%convergence%kantorovich_ratio <= max_kantorovich_ratio
      ! Before a change point is passed: at the length 0 links may be in line.
      if (accepted .and. size(f%engine%cylinders) > 0) call keep_lengths(f, t, accepted)
      if (accepted .and. .not. (f%convergence%keeps_signs .or. f%convergence%singular)) &
         call pass_change_points(f, t, step)
      accepted = accepted .and. f%convergence%keeps_signs
      if (.not. accepted) return
      step%branch%substeps = step%branch%substeps + 1
      step%branch%kantorovich_ratio = max(step%branch%kantorovich_ratio, f%convergence%kantorovich_ratio)
   end subroutine attempt

   !> Finds the lengths (0:2, cylinders) at the motion that is followed, with their derivatives.
   function lengths_followed(f) result(lengths)
      type(following_t), intent(in) :: f
      real(wp) :: lengths(0:2, size(f%engine%cylinders))
      type(state_t) :: s

      call followed_state(f%engine, s)
      lengths = lengths_of(f, s)
   end function lengths_followed

   !> Finds the lengths (0:2, cylinders) in the state `s`.
   function lengths_of(f, s) result(lengths)
      type(following_t), intent(in) :: f
      type(state_t), intent(in) :: s
      real(wp) :: lengths(0:2, size(f%engine%cylinders))
      type(motion_t) :: q
      logical :: finite
      integer :: k

      associate (e => f%engine)
         q = new_motion(size(e%estimate, 2))
         call move_links(e%geometry%chain, s, e%geometry%equations%length, q, finite, .true.)
         do k = 1, size(e%cylinders)
            associate (i => e%cylinders(k)%i, j => e%cylinders(k)%j)
               lengths(:, k) = cylinder_motion(e%cylinders(k), &
                  reshape([q%position(:, i), q%velocity(:, i), q%acceleration(:, i)], [3, 3]), &
                  reshape([q%position(:, j), q%velocity(:, j), q%acceleration(:, j)], [3, 3]))
            end associate
         end do
      end associate
   end function lengths_of

   !> Finds whether the substep to `t` keeps all cylinders within the bounds of their lengths, also between its ends:
   !> otherwise it is not `accepted`. A drive that leaves its chord could take a length out of them and back.
   subroutine keep_lengths(f, t, accepted)
      type(following_t), intent(in) :: f
      real(wp), intent(in) :: t              !< time
      logical, intent(inout) :: accepted
      real(wp), dimension(0:2, size(f%engine%cylinders)) :: first, last
      real(wp) :: away
      integer :: k

      first = lengths_followed(f)
      last = lengths_of(f, f%engine%state)
      if (f%convergence%singular) last(1:, :) = 0.0_wp
      away = off_chord*f%engine%state%excursion*f%engine%geometry%equations%length
      do k = 1, size(f%engine%cylinders)
         associate (bounds => f%engine%cylinders(k)%bounds)
            accepted = stays_within(bounds, first(:1, k), last(:1, k), t - f%t)
            if (accepted .and. away > 0.0_wp) accepted = min(first(0, k), last(0, k)) - away > bounds(1) &
               .and. max(first(0, k), last(0, k)) + away < bounds(2)
            if (.not. accepted) return
         end associate
      end do
   end subroutine keep_lengths

   !> Adds to the Kantorovich ratio of the motion found last at `t` what the drives add by leaving their chords, or by
   !> not going as they did: a position predicted from their rates is then near another branch, perhaps. A bound at
   !> hardly any cost is enough mostly.
   subroutine add_excursion(f, t)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      real(wp) :: ratio, change, away, off, h, first(3), last(3)
      integer :: i

      associate (c => f%convergence, path => f%engine%path)
         ratio = c%kantorovich_ratio + c%growth*f%engine%state%excursion
         if (ratio > max_kantorovich_ratio) then
            call examine(f%drives, path, f%t, t, change, away)
            h = t - f%t
            do i = 1, size(f%drives%unit)
               first = drive_at(path, i, f%t)
               last = drive_at(path, i, t)
               off = last(1) - first(1) - h*(first(2) + 0.5_wp*h*first(3))
               if (abs(off) > 0.5_wp*abs(last(1) - first(1))) away = max(away, f%drives%unit(i)*abs(off))
            end do
            ratio = c%kantorovich_ratio + c%growth*away
         end if
         c%kantorovich_ratio = ratio
      end associate
   end subroutine add_excursion

   !> A determinant has changed its sign before `t`. At change points beyond which the motion goes on that is none.
   !> Apart, since a plain substep has no room to make for the list.
   subroutine pass_change_points(f, t, step)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable :: list(:)
      type(branch_requests_t) :: before

      before = f%branch_requests
      call pass(f%engine, t, f%branch_requests, f%convergence, list)
      if (f%convergence%keeps_signs .and. f%convergence%kantorovich_ratio <= max_kantorovich_ratio) then
         if (.not. allocated(step%passed)) allocate (step%passed(0))
         step%passed = [step%passed, list]
      else
         if (size(list) > 0 .and. .not. f%convergence%keeps_signs) &
            step%dead_end = pack(list, list%kind == diagnostic_dead_end)
         f%convergence%keeps_signs = .false.
         ! Close to a dead point it may only look like a change point: no card is used up there.
         f%branch_requests = before
      end if
   end subroutine pass_change_points

   !> How many change points were passed in the `step`.
   pure integer function passed_of(step) result(passed)
      type(step_record_t), intent(in) :: step

      passed = 0
      if (allocated(step%passed)) passed = size(step%passed)
   end function passed_of

   !> The motion found last, at `t`, is now the one that is followed.
   subroutine go_on_from(f, t)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t

      call accept(f%engine)
      f%t = t
      f%follows = .true.
   end subroutine go_on_from

   !> The motion at the place where the `step` began is again the one that is followed: what comes after an instant
   !> without a motion is as if that had not been asked for. From close to a dead point no step back would be small
   !> enough.
   subroutine go_back(f, step)
      type(following_t), intent(inout) :: f
      type(step_record_t), intent(in) :: step

      if (step%tries < 2) return
      call follow_from(f, f%place)
      f%branch_requests = f%place%branch_requests
   end subroutine go_back

   !> Follows the motion at the place `p` again; the motion found last stays.
   subroutine follow_from(f, p)
      type(following_t), intent(inout) :: f
      type(place_t), intent(in) :: p

      f%t = p%t
      f%engine%followed_t = p%engine%followed_t
   end subroutine follow_from

   !> Notes in `p` where the motion is followed.
   subroutine note_place(f, p)
      type(following_t), intent(in) :: f
      type(place_t), intent(inout) :: p

      p%t = f%t
      p%engine = f%engine%engine_state_t
      p%branch_requests = f%branch_requests
      p%convergence = f%convergence
   end subroutine note_place

   !> Follows the motion again from the place `p`, to which a later step can go back.
   subroutine return_to(f, p)
      type(following_t), intent(inout) :: f
      type(place_t), intent(in) :: p

      f%t = p%t
      f%engine%engine_state_t = p%engine
      f%branch_requests = p%branch_requests
      f%convergence = p%convergence
      call note_place(f, f%place)
   end subroutine return_to

   !> The limit beyond which the instant `t` lies, as a number of a side; 0: none that is known.
   pure integer function limit_before(limits, t) result(k)
      type(limit_t), intent(in) :: limits(2)
      real(wp), intent(in) :: t

      k = 0
      if (limits(1)%known .and. t <= limits(1)%t) k = 1
      if (limits(2)%known .and. t >= limits(2)%t) k = 2
   end function limit_before
end module following
