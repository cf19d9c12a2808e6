!> The analysis of one mechanism, instant by instant: what is found, what is not, and what there is to say of it.
!>
!> The motion is followed by blocks, whatever the method: they give the limits, the certificate and the remarks. METHOD
!> DENSE and METHOD MATRIX solve for the motion at each instant where the blocks have found one.
module analysis
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton
   use structure, only: structure_t
   use drives, only: is_at_rest
   use motion, only: motion_t, forget_links, known_of, mark_none, mark_not_converged, mark_singular, mark_overflow, &
      mark_inconsistent, singular_unclear, diagnostic_t, diagnostic_inconsistent, diagnostic_limit, &
      diagnostic_beyond, diagnostic_long, diagnostic_close, diagnostic_begins, diagnostic_method, diagnostic_dead_end
   use convergence, only: convergence_t, nothing_gathered, is_solved, ended_inconsistent, ended_unsought, &
      ended_elsewhere
   use block_engine, only: block_engine_t, make_block_engine, renew_block_engine, get_blocks_motion => get_motion, &
      get_ratios, get_driven_links, set_drive_values, solve_each
   use first_instant, only: measure_closure_error
   use dense_method, only: dense_t, make_dense, for_blocks, solve_all_links
   use block_diagnostics, only: near_part, start_diagnostics, limit_diagnostic, get_link_flags, change_diagnostics
   use at_bifurcation, only: go_by_value, leave, time_beside
   use following, only: following_t, step_record_t, begin_following, continue_to, go_on_from, &
      go_back, place_t, note_place, return_to, passed_of, limit_t, limit_before, branch_t, certificate_counts_t, &
      branch_none, branch_first, branch_same, branch_crossed
   implicit none
   private
   public :: analysis_t, make_analysis, renew_analysis, advance, look_at, come_back, redundancy_error

   !> A limit that the motion creeps up to is no further than this part of the way that it has come.
   real(wp), parameter :: almost_there = 1.0e-3_wp
   !> Beside a first position that is singular the motion begins where a drive has gone so far, in the units of the
   !> blocks.
   real(wp), parameter :: beside_start = 1.0e-3_wp

   !> The motion that is followed, and what is known of the instants so far.
   type, extends(following_t) :: analysis_t
      type(branch_t) :: branch                             !< of the last instant
      type(certificate_counts_t) :: certificate_counts     !< of all instants
      type(limit_t) :: limits(2)                           !< of the motion that is followed
      logical :: has_begun = .false.                       !< a position was found
      logical :: begins = .false.                          !< at the last instant none was followed yet
      logical :: is_lost = .false.                         !< at the last instant none was
      logical :: stands = .false.                          !< the last instant has a singular position
      logical, allocatable :: singular(:)                  !< (blocks) if so, those that are singular there
      real(wp) :: last = 0.0_wp                            !< time of the last instant
      type(dense_t), allocatable :: dense                  !< METHOD DENSE and MATRIX: what solves for the motion
      logical :: has_missed = .false.                      !< at the last instant it did not find the blocks' position
      real(wp) :: max_closure_error = 0.0_wp               !< of redundant equations, in characteristic lengths or rad
      !> The motion followed is at a time that is no instant (`look_at`); its place and iterations at the last instant.
      logical :: is_left = .false.
      type(place_t) :: left
      integer :: left_iterations = 0
   end type analysis_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns. `structure`: see
   !> `make_block_engine`.
   subroutine make_analysis(a, m, structure)
      type(analysis_t), intent(out) :: a
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout), optional :: structure
      type(block_engine_t), allocatable :: engine

      allocate (engine)
      if (m%method == method_newton) then
         call make_block_engine(engine, m, structure)
      else
         call make_block_engine(engine, for_blocks(m), structure)
         allocate (a%dense)
         call make_dense(a%dense, m)
      end if
      call begin_following(a%following_t, m, engine)
   end subroutine make_analysis

   !> Makes `a`, the analysis of a variant of `m` by METHOD NEWTON, ready for the first instant of `m` with the engine
   !> that it has. `is_done`: that fits; otherwise `a` is of no use.
   subroutine renew_analysis(a, m, is_done)
      type(analysis_t), intent(inout) :: a
      type(mechanism_t), intent(in) :: m
      logical, intent(out) :: is_done
      type(block_engine_t), allocatable :: engine

      call move_alloc(a%engine, engine)
      call renew_block_engine(engine, m, is_done)
      if (.not. is_done) return
      a = analysis_t()
      call begin_following(a%following_t, m, engine)
   end subroutine renew_analysis

   !> Solves for the instant `t`; `found` is its motion in the deck's units, with what could not be found flagged. Links
   !> that no request needs may be left out.
   subroutine advance(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(step_record_t) :: step
      type(diagnostic_t), allocatable :: list(:)
      integer :: iterations
      logical :: goes_on

      call come_back(a)
      iterations = a%iterations
      if (allocated(found%diagnostics)) deallocate (found%diagnostics)
      if (allocated(found%by)) deallocate (found%by)
      found%t = t
      if (limit_before(a%limits, t) > 0) then
         call pass_over(a, t, found)
         return
      end if
      call reach(a, t, step, list)
      if (step%arrived) then
         call arrive(a, step, list, found)
      else
         if (allocated(step%passed)) call add_diagnostics(step%passed, found)
         call give_up(a, t, step, found)
      end if
      a%certificate_counts%passed = a%certificate_counts%passed + passed_of(step)
      goes_on = found%known == 2 .and. .not. found%rests
      if (allocated(a%dense)) then
         if (step%arrived) goes_on = .not. any(a%engine%is_singular(a%engine%needed))
         a%iterations = iterations
         if (step%arrived) a%iterations = iterations + a%convergence%iterations
      end if
      if (goes_on) then
         call go_on_from(a%following_t, t)
      else
         call go_back(a%following_t, step)
      end if
      a%is_lost = .not. step%arrived
      a%stands = step%arrived .and. .not. goes_on
      if (a%stands) then
         a%singular = a%engine%is_singular
         a%stands = any(a%singular(a%engine%needed))
      end if
      a%last = t
   end subroutine advance

   !> Continues the motion to `t`; `step`: how that went, `list`: what there is to say of it if it stands on a change
   !> point, or returns from a singular position. If no drive moves between the last instant and `t`, a singular
   !> position is that of the last instant.
   subroutine reach(a, t, step, list)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable, intent(inout) :: list(:)
      type(diagnostic_t), allocatable :: returns(:)
      real(wp) :: beside

      step%rests = a%stands
      if (step%rests) step%rests = all(is_at_rest(a%engine%laws, a%last, t))
      if (step%rests) then
         if (a%is_left) call return_to(a%following_t, a%left)
         ! Blocks without velocities keep their position; the others find their velocities and accelerations.
         associate (e => a%engine)
            e%t = t
            call set_drive_values(e, t)
            a%convergence = nothing_gathered
            call solve_each(e, pack(e%moving, .not. e%is_singular(e%moving)), .true., a%convergence)
         end associate
         a%convergence%singular = .true.
         step%arrived = .true.
         step%stands = .true.
         return
      end if

      a%begins = .not. a%follows
      if (a%begins .and. a%stands) then
         ! From a first position that is singular, more than one motion begins. The one to `t` begins in the assembly
         ! that is the nearest close to that position: at `t` another one may be, if the step is wide.
         beside = time_beside(a%engine, a%last, t, beside_start)
         call continue_to(a%following_t, beside, step)
         if (step%arrived .and. .not. (a%convergence%singular .or. a%convergence%rates_open)) &
            call go_on_from(a%following_t, beside)
      end if
      ! Back in time the motion is what it was.
      if (a%stands .and. .not. a%begins .and. (a%t - a%last)*(t - a%last) < 0.0_wp) then
         call leave(a%following_t, a%last, t, &
            pack(a%engine%moving, a%singular(a%engine%moving)), returns)
         step%dead_end = pack(returns, returns%kind == diagnostic_dead_end)
         step%blocked = size(step%dead_end) > 0
         if (step%blocked) return
      end if
      call continue_to(a%following_t, t, step)
      if (.not. step%arrived) call go_by_value(a%following_t, t, step, list)
      if (allocated(returns) .and. step%arrived .and. .not. (allocated(list) .or. passed_of(step) > 0 &
         .or. a%convergence%singular)) call move_alloc(returns, list)
   end subroutine reach

   !> The motion `found` at a time `t` that is no instant of the deck, by continuity from the last one, or from a time
   !> looked at before: of many times in a row each costs a short step. Nothing else changes; the engine stays at `t`
   !> until `come_back`. `is_found`: it has a position, velocities and accelerations.
   subroutine look_at(a, t, found, is_found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      logical, intent(out) :: is_found
      type(step_record_t) :: step
      type(diagnostic_t), allocatable :: list(:)

      is_found = .false.
      if (.not. a%follows .or. limit_before(a%limits, t) > 0) return
      if (.not. a%is_left) then
         call note_place(a%following_t, a%left)
         a%left_iterations = a%iterations
         a%is_left = .true.
      end if
      call reach(a, t, step, list)
      if (step%arrived .and. (step%rests .or. .not. (a%convergence%singular .or. a%convergence%rates_open))) then
         found%t = t
         call take_motion(a, found)
         is_found = found%known == 2 .and. is_solved(a%convergence)
      end if
      if (.not. is_found) then
         call go_back(a%following_t, step)
      else if (step%tries > 1) then
         call go_on_from(a%following_t, t)
      end if
   end subroutine look_at

   !> Follows the motion from the last instant again, if it was left.
   subroutine come_back(a)
      type(analysis_t), intent(inout) :: a

      if (.not. a%is_left) return
      call return_to(a%following_t, a%left)
      a%iterations = a%left_iterations
      a%is_left = .false.
   end subroutine come_back

   !> The motion found at the end of `step`, what is verified of it, and what there is to say of it; `list`: if it
   !> stands on a change point. Where the blocks have found a position and the method has not, that is said once of
   !> instants in a row. A motion that began beside a singular position is no longer near the deck's estimate.
   subroutine arrive(a, step, list, found)
      type(analysis_t), intent(inout) :: a
      type(step_record_t), intent(inout) :: step
      type(diagnostic_t), allocatable, intent(inout) :: list(:)
      type(motion_t), intent(inout) :: found
      logical :: had_missed, crosses

      had_missed = a%has_missed
      if (a%convergence%singular .and. .not. step%stands) then
         call go_by_value(a%following_t, found%t, step, list)
         if (a%convergence%singular .and. a%follows .and. .not. allocated(list)) then
            list = change_diagnostics(a%engine, found%t)
            step%stands = size(list) > 0
         end if
      end if
      call take_motion(a, found)
      a%max_closure_error = max(a%max_closure_error, a%convergence%open%value)
      crosses = passed_of(step) > 0
      if (allocated(step%passed)) call add_diagnostics(step%passed, found)
      if (allocated(list)) then
         call add_diagnostics(list, found)
         crosses = crosses .or. any(list%other)
      end if

      if (a%has_missed) then
         call cut(found, -1, mark_not_converged)
         call get_driven_links(a%engine, found%t, found)
         a%branch = branch_t()
         if (.not. had_missed) call add_diagnostics([diagnostic_t(kind=diagnostic_method, &
            other=a%convergence%ended == ended_elsewhere)], found)
         return
      end if

      if (step%rests) then
         a%branch = branch_t(kind=min(a%branch%kind, branch_same))
      else
         a%branch = step%branch
         a%branch%kind = merge(branch_crossed, branch_same, crosses)
         if (a%convergence%singular .and. .not. step%stands) a%branch%kind = branch_none
      end if
      if (a%begins) a%branch%kind = branch_first
      associate (counts => a%certificate_counts)
         if (a%branch%kind == branch_none) counts%uncertain = counts%uncertain + 1
         if (a%branch%kind >= branch_same) counts%followed = counts%followed + 1
      end associate

      if (a%has_begun .and. .not. (a%begins .and. found%known == 2)) return
      if (a%has_begun) call add_diagnostics([diagnostic_t(kind=diagnostic_begins)], found)
      a%has_begun = .true.
      if (.not. a%follows) call add_diagnostics(start_diagnostics(a%engine, found, a%convergence%singular), found)
   end subroutine arrive

   !> No motion was found at `t`, at the end of `step`: which equation is not satisfied, or where the step has ended;
   !> that is said once. The instant lies beyond a limit if no substep could be made and it is further behind that place
   !> than `near_part` of the step, or if it is only known that it was not reached.
   subroutine give_up(a, t, step, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(step_record_t), intent(in) :: step
      type(motion_t), intent(inout) :: found
      type(diagnostic_t), allocatable :: list(:)
      real(wp) :: ahead
      logical :: inconsistent

      a%branch = branch_t()
      inconsistent = a%convergence%ended == ended_inconsistent
      if (inconsistent) then
         ! Of equations that contradict one another a drive is one: not even the links that it moves have a position.
         call cut(found, -1, mark_inconsistent)
         ! Not where the last substep has ended, but at the instant itself.
         if (step%tries > 1) call measure_closure_error(a%engine, t, a%convergence)
         a%max_closure_error = max(a%max_closure_error, a%convergence%open%value)
      else
         call cut(found, -1, mark_not_converged)
         call get_driven_links(a%engine, t, found)
      end if

      allocate (list(0))
      if (a%convergence%open%value > 0.0_wp .and. (inconsistent .or. .not. a%follows)) then
         associate (open => a%convergence%open)
            call add_diagnostics([diagnostic_t(kind=diagnostic_inconsistent, pair=open%pair, drive=open%drive, &
               is_angle=open%is_angle, value=open%value*merge(1.0_wp, a%engine%length*open%unit, open%is_angle))], &
               found)
         end associate
      else
         ahead = t
         ! To where a slide is infinite there are more substeps than are tried.
         if (step%gave_up) &
            ahead = a%t + sign(min(abs(t - a%t), almost_there*abs(a%t - a%place%t)), t - a%t)
         list = limit_diagnostic(a%engine, ahead, step%gave_up)
         if (size(list) == 0 .and. a%follows .and. step%blocked) list = [diagnostic_t(kind=diagnostic_close, t=a%t)]
      end if
      if (step%gave_up) then
         if (size(list) == 0) list = [diagnostic_t(kind=diagnostic_long, t=a%place%t)]
      else if (allocated(step%dead_end)) then
         if (size(step%dead_end) > 0) list = step%dead_end
      end if
      if (.not. a%is_lost) call add_diagnostics(list, found)
      if (.not. a%follows .or. inconsistent .or. abs(t - a%place%t) <= 0.0_wp) return
      associate (limit => a%limits(merge(2, 1, t > a%place%t)))
         limit%known = .true.
         limit%t = merge(a%t + near_part*(t - a%place%t), t, step%blocked)
         limit%diagnostics = list
      end associate
   end subroutine give_up

   !> `t` is not reached by continuity, and nothing is solved for. The first of such instants gets the reason.
   subroutine pass_over(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      integer :: side

      call cut(found, -1, mark_not_converged)
      call get_driven_links(a%engine, t, found)
      a%convergence = convergence_t(ended=ended_unsought)
      a%branch = branch_t()
      side = limit_before(a%limits, t)
      associate (told => a%limits(side)%diagnostics)
         if (.not. a%is_lost) then
            call add_diagnostics(told, found)
         else if (any(told%kind == diagnostic_limit)) then
            call add_diagnostics([diagnostic_t(kind=diagnostic_beyond, &
               t=told(findloc(told%kind, diagnostic_limit, dim=1))%t)], found)
         end if
      end associate
      a%is_lost = .true.
   end subroutine pass_over

   !> Adds the diagnostics `list` to those of `found`; those are not allocated where there are none.
   subroutine add_diagnostics(list, found)
      type(diagnostic_t), intent(in) :: list(:)
      type(motion_t), intent(inout) :: found

      if (size(list) == 0) return
      if (.not. allocated(found%diagnostics)) allocate (found%diagnostics(0))
      found%diagnostics = [found%diagnostics, list]
   end subroutine add_diagnostics

   !> Takes the motion at found%t, where the blocks have found one, by the method, and flags what does not exist. If all
   !> drives rest, a motion that has come to a singular position rests there, too. A first position says less: undriven
   !> links may move.
   subroutine take_motion(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      integer :: link, last
      logical :: finite

      if (allocated(a%dense)) then
         call solve_all_links(a%dense, a%engine, found, a%convergence)
         a%has_missed = .not. is_solved(a%convergence)
         finite = .false.
      else
         call get_blocks_motion(a%engine, found, finite)
      end if
      if (size(a%engine%ratios) > 0) call get_ratios(a%engine, a%engine%is_singular, found)

      call cut(found, 2, mark_none)
      found%rests = a%convergence%singular .and. a%follows
      if (found%rests) found%rests = all(is_at_rest(a%engine%laws, found%t, found%t))
      if (found%rests) then
         found%velocity = 0.0_wp
         found%acceleration = 0.0_wp
      else
         if (a%convergence%singular) call cut(found, 0, mark_singular)
         if (a%convergence%rates_open) call cut(found, 0, mark_inconsistent)
         ! Where rates contradict one another no link has any.
         if (found%mark == mark_singular) call get_link_flags(a%engine, found, allocated(a%dense))
      end if
      if (finite) return
      ! What is out of the range of the real kind is not known.
      do link = 1, size(found%position, 2)
         last = known_of(found, link)
         if (last == 2 .and. .not. all(abs(found%acceleration(:, link)) <= huge(1.0_wp))) last = 1
         if (last >= 1 .and. .not. all(abs(found%velocity(:, link)) <= huge(1.0_wp))) last = 0
         if (.not. all(abs(found%position(:, link)) <= huge(1.0_wp))) last = -1
         if (last >= known_of(found, link)) cycle
         if (.not. allocated(found%link_known)) then
            allocate (found%link_known(size(found%position, 2)), source=found%known)
            allocate (found%link_mark(size(found%position, 2)), source=found%mark)
         end if
         found%link_known(link) = last
         found%link_mark(link) = mark_overflow
         if (last < found%known) found%mark = mark_overflow
         found%known = min(found%known, last)
      end do
   end subroutine take_motion

   !> Keeps only derivatives up to number `known` of all links; `mark` says why.
   pure subroutine cut(found, known, mark)
      type(motion_t), intent(inout) :: found
      integer, intent(in) :: known, mark

      call forget_links(found)
      if (found%mark /= mark_none) then
         found%singularity = singular_unclear
         found%singular_links = diagnostic_t()
      end if
      found%known = known
      found%mark = mark
   end subroutine cut

   !> By how much redundant equations have differed at most, in characteristic lengths or rad; -1 where there are none.
   pure real(wp) function redundancy_error(a)
      type(analysis_t), intent(in) :: a

      redundancy_error = -1.0_wp
      if (a%engine%blocks%redundant > 0) redundancy_error = a%max_closure_error
   end function redundancy_error
end module analysis
