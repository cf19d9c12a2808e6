!> The motion that is followed, and the way from it to another instant, in as many parts as that takes: an
!> assembly is never changed in silence.
module following
   use kinds, only: wp
   use structure, only: structure_t
   use mechanism, only: mechanism_t
   use diagnostics, only: diagnostic_t, diagnostic_dead_end
   use branch_certificate, only: branch_t
   use drive_excursion, only: drive_excursion_t, new_drive_excursion, substep_allowed, likely_excursion, excursion, &
      steps_at_least
   use convergence, only: convergence_t, is_solved
   use branch_requests, only: branch_requests_t, new_branch_requests
   use change_points, only: crosses, pass
   use engine, only: engine_t, engine_checkpoint_t, make_engine, solve, accept, checkpoint, restore
   implicit none
   private
   public :: following_t, step_record_t, make_following, continue_to, is_too_far, has_too_many_substeps, go_on_from, &
      go_back
   public :: place_t, note_place, return_to

   !> The largest correction, in the characteristic length and in radians, of a predicted position that is still taken
   !> for the continuation of the motion; where the prediction is off by more, the step is divided.
   real(wp), parameter :: largest_correction = 0.1_wp
   !> The same over the distance of the next root, as the Jacobian and its bend tell it: near a change point
   !> another branch passes close by, with the sign of the determinant that this one had before.
   real(wp), parameter :: max_kantorovich_ratio = 0.1_wp
   !> A part of a step smaller than this, of the longest or of what is left to go, is the end of the way; and so are
   !> that many parts.
   real(wp), parameter :: min_substep = max(1.0e-10_wp, 4.0_wp*epsilon(1.0_wp))
   integer, parameter :: max_substeps = 200000
   !> Near a limit a slow iteration creeps, and each part that fails costs all of its iterations: so many failures
   !> of parts that are small already end the way too.
   integer, parameter :: max_failures = 300
   real(wp), parameter :: small_substep = 1.0e-3_wp

   !> A place of the motion that is followed: all that its further way depends on.
   type :: place_t
      real(wp) :: t = 0.0_wp
      type(engine_checkpoint_t) :: engine
   end type place_t

   !> The engine, and how far it has come.
   type :: following_t
      type(engine_t) :: engine
      type(branch_requests_t) :: branch_requests                 !< BRANCH cards, and change points passed
      type(convergence_t) :: convergence         !< of the last position sought
      integer :: iterations = 0                  !< of all positions sought so far
      logical :: follows = .false.               !< a regular motion is kept, found at `t`
      real(wp) :: t = 0.0_wp
      type(place_t) :: place                     !< where the step that was divided last began
      type(drive_excursion_t) :: drives               !< their way through time
   end type following_t

   !> The way to an instant: whether it came there or to a place where no part of it could be made, how many parts were
   !> tried, what was verified of those kept, the change points on it.
   type :: step_record_t
      logical :: arrived = .false., blocked = .false.
      logical :: stands = .false.                !< on a change point, from short before which it is followed
      integer :: tries = 0
      type(branch_t) :: branch
      type(diagnostic_t), allocatable :: passed(:), dead_end(:)   !< not allocated: none
   end type step_record_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns. `structure`: see
   !> `make_block_engine`.
   subroutine make_following(f, m, structure)
      type(following_t), intent(out) :: f
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout), optional :: structure

      call make_engine(f%engine, m, structure)
      f%branch_requests = new_branch_requests(m)
      f%drives = new_drive_excursion(m, depends_on_before(f%engine))
   end subroutine make_following

   !> There is an unknown that is sought from where it was before.
   pure logical function depends_on_before(e) result(depends)
      type(engine_t), intent(in) :: e

      depends = .true.
      if (.not. allocated(e%blocks)) return
      if (allocated(e%blocks%history%sought)) depends = size(e%blocks%history%sought) > 0
   end function depends_on_before

   !> Follows the motion to `t`, or seeks the first.
   subroutine continue_to(f, t, w)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(out) :: w
      real(wp) :: substep, here, longest, allowed, shortest
      integer :: failures
      logical :: accepted

      substep = t - f%t
      longest = abs(substep)
      shortest = min_substep*longest
      failures = 0
      do while (w%tries < max_substeps)
         w%tries = w%tries + 1
         w%arrived = .not. f%follows
         if (f%follows) then
            substep = sign(min(abs(substep), abs(t - f%t)), substep)
            allowed = substep_allowed(f%drives, f%t, substep)
            if (abs(allowed) < abs(substep)) longest = max(abs(allowed), shortest)
            substep = allowed
            w%arrived = abs(substep) >= abs(t - f%t)
         end if
         here = merge(t, f%t + substep, w%arrived)
         call attempt(f, here, w, accepted)
         w%arrived = w%arrived .and. accepted
         if (w%arrived) exit
         if (w%tries == 1) call note_place(f, f%place)
         accepted = accepted .and. .not. f%convergence%singular
         if (accepted) call go_on_from(f, here)
         if (.not. f%follows) exit
         if (.not. accepted .and. abs(substep) <= small_substep*longest) failures = failures + 1
         substep = merge(1.5_wp, 0.5_wp, accepted)*substep
         w%blocked = abs(substep) <= min_substep*min(longest, abs(t - f%t))
         if (w%blocked .or. failures > max_failures) exit
      end do
   end subroutine continue_to

   !> Seeks the motion at `t`; `accepted`: it is the continuation of the one that is followed, or the first.
   subroutine attempt(f, t, w, accepted)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t
      type(step_record_t), intent(inout) :: w
      logical, intent(out) :: accepted
      real(wp) :: correction, away
      logical :: same
      type(diagnostic_t), allocatable :: list(:)

      away = 0.0_wp
      if (f%follows) then
         away = likely_excursion(f%drives, f%t, t)
         if (allocated(f%engine%blocks)) f%engine%blocks%state%excursion = away
      end if
      call solve(f%engine, t, f%follows, f%convergence, correction, same)
      f%iterations = f%iterations + f%convergence%iterations
      accepted = is_solved(f%convergence)
      if (.not. f%follows) return
      accepted = accepted .and. correction <= largest_correction
      if (accepted .and. away > 0.0_wp) call add_excursion(f, t, away)
      accepted = accepted .and. f%convergence%kantorovich_ratio <= max_kantorovich_ratio
      if (accepted .and. .not. same .and. .not. f%convergence%singular .and. allocated(f%engine%blocks)) then
         same = crosses(f%engine%blocks, correction)
         if (same) then
            call pass(f%engine%blocks, t, f%branch_requests, f%convergence, list, same)
            if (.not. same) then
               w%dead_end = pack(list, list%kind == diagnostic_dead_end)
            else if (allocated(w%passed)) then
               w%passed = [w%passed, list]
            else
               call move_alloc(list, w%passed)
            end if
         end if
      end if
      accepted = accepted .and. same .and. f%convergence%kantorovich_ratio <= max_kantorovich_ratio
      if (.not. accepted) return
      w%branch%parts = w%branch%parts + 1
      w%branch%kantorovich_ratio = max(w%branch%kantorovich_ratio, f%convergence%kantorovich_ratio)
   end subroutine attempt

   !> Adds to the doubt of the motion found last at `t` what the drives leave open that on the way there are `away` at
   !> most from the straight way. A bound at hardly any cost is enough mostly.
   subroutine add_excursion(f, t, away)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t, away
      real(wp) :: kantorovich_ratio

      associate (c => f%convergence)
         kantorovich_ratio = c%kantorovich_ratio + c%growth*away
         if (kantorovich_ratio > max_kantorovich_ratio) kantorovich_ratio = c%kantorovich_ratio &
            + c%growth*excursion(f%drives, f%t, t)
         c%kantorovich_ratio = kantorovich_ratio
      end associate
   end subroutine add_excursion

   !> The way to `t` would have more parts than are tried.
   pure logical function is_too_far(f, t)
      type(following_t), intent(in) :: f
      real(wp), intent(in) :: t

      is_too_far = f%follows .and. abs(t - f%t) > f%drives%longest
      if (is_too_far) is_too_far = steps_at_least(f%drives, f%t, t) > real(max_substeps, wp)
   end function is_too_far

   !> All parts that are tried were not enough for `w`.
   pure logical function has_too_many_substeps(w)
      type(step_record_t), intent(in) :: w

      has_too_many_substeps = w%tries == max_substeps .and. .not. w%arrived
   end function has_too_many_substeps

   !> The motion found last, at `t`, is now the one that is followed.
   subroutine go_on_from(f, t)
      type(following_t), intent(inout) :: f
      real(wp), intent(in) :: t

      call accept(f%engine)
      f%t = t
      f%follows = .true.
   end subroutine go_on_from

   !> The motion at the place where the way `w` began is again the one that is followed: what comes after an instant
   !> without a motion is as if that had not been asked for. From close to a dead point no step back would be small
   !> enough.
   subroutine go_back(f, w)
      type(following_t), intent(inout) :: f
      type(step_record_t), intent(in) :: w

      if (w%tries < 2) return
      f%t = f%place%t
      call restore(f%engine, f%place%engine, keeps_found=.true.)
   end subroutine go_back

   !> Notes in `p` where the motion is followed.
   subroutine note_place(f, p)
      type(following_t), intent(in) :: f
      type(place_t), intent(inout) :: p

      p%t = f%t
      call checkpoint(f%engine, p%engine)
   end subroutine note_place

   !> Follows the motion again from the place `p`, which a way may start from and come back to.
   subroutine return_to(f, p)
      type(following_t), intent(inout) :: f
      type(place_t), intent(in) :: p

      f%t = p%t
      f%place = p
      call restore(f%engine, p%engine, keeps_found=.false.)
   end subroutine return_to
end module following
