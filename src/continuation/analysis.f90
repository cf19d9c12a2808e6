!> The analysis of one set of computations, instant by instant: what is found, what is not, and what there is
!> to say of it.
module analysis
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use structure, only: structure_t
   use motion, only: motion_t, forget_links, known_of, mark_none, mark_not_converged, mark_singular, mark_overflow, &
      mark_inconsistent
   use diagnostics, only: diagnostic_t, diagnostic_inconsistent, diagnostic_far_estimate, diagnostic_long
   use branch_certificate, only: branch_t, certificate_counts_t, count_in, branch_none, branch_first, branch_same, &
      branch_crossed
   use constants, only: without_turns
   use branch_requests, only: unused
   use limits, only: limits_t, note_limit, lies_beyond, diagnostics_of_limit
   use convergence, only: convergence_t, ended_inconsistent, ended_unsought
   use block_engine, only: solve_blocks
   use block_diagnostics, only: first_diagnostics, limit_diagnostic
   use engine, only: get_motion_of, get_link_flags, get_certain_links, is_certified
   use at_bifurcation, only: stand_on
   use following, only: following_t, step_record_t, make_following, continue_to, is_too_far, has_too_many_substeps, &
      go_on_from, go_back
   implicit none
   private
   public :: analysis_t, make_analysis, advance, redundancy_error, closing_diagnostics

   !> A rough angle that is off by more is worth a word: the assembly may not be the one that was meant.
   real(wp), parameter :: far_angle = 1.0_wp
   !> The motion that is followed, and what is known of the instants so far.
   type, extends(following_t) :: analysis_t
      type(branch_t) :: branch                   !< of the last instant
      type(certificate_counts_t) :: certificate_counts                     !< of all instants
      type(limits_t) :: ends                   !< of the motion that is followed
      logical :: has_begun = .false.             !< a position was found
      logical :: is_lost = .false.               !< the last one kept does not lead on
      real(wp) :: max_closure_error = 0.0_wp           !< of redundant equations, relative
      real(wp), allocatable :: estimated_angle(:)    !< (links) of the deck
   end type analysis_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns. `structure`: see
   !> `make_block_engine`.
   subroutine make_analysis(a, m, structure)
      type(analysis_t), intent(out) :: a
      type(mechanism_t), intent(in) :: m
      type(structure_t), intent(inout), optional :: structure

      call make_following(a%following_t, m, structure)
      a%estimated_angle = m%links%position(3)
   end subroutine make_analysis

   !> Solves instant `t`; `found` is its motion in the deck's units, with what could not be found marked; of links that
   !> no request needs it is not told.
   subroutine advance(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(step_record_t) :: w

      if (allocated(found%diagnostics)) deallocate (found%diagnostics)
      found%t = t
      if (lies_beyond(a%ends, t) .or. is_too_far(a%following_t, t)) then
         call pass_over(a, t, found)
         return
      end if
      call continue_to(a%following_t, t, w)
      if (allocated(w%passed)) call add_diagnostics(w%passed, found)
      if (w%arrived) then
         call arrive(a, w, found)
      else
         call stay(a, t, w, found)
      end if
      if (found%known == 2) then
         call go_on_from(a%following_t, t)
      else if (.not. w%stands) then
         call go_back(a%following_t, w)
      end if
      a%is_lost = .not. w%arrived
   end subroutine advance

   !> The motion found at the end of the way `w`.
   subroutine arrive(a, w, found)
      type(analysis_t), intent(inout) :: a
      type(step_record_t), intent(inout) :: w
      type(motion_t), intent(inout) :: found
      type(diagnostic_t), allocatable :: list(:)

      call get_motion(a, found)
      if (a%convergence%singular) then
         call stand_on(a%following_t, found%t, w, list, w%stands)
         if (w%stands) call get_motion(a, found)
         call add_diagnostics(list, found)
      end if
      call judge_branch(a, w)
      if (.not. a%has_begun .or. (.not. a%follows .and. found%known == 2)) call diagnose_start(a, found)
   end subroutine arrive

   !> No motion was found at `t`, at the end of the way `w`.
   subroutine stay(a, t, w, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(step_record_t), intent(in) :: w
      type(motion_t), intent(inout) :: found
      logical :: inconsistent

      a%branch = branch_t()
      inconsistent = a%convergence%ended == ended_inconsistent
      if (w%tries > 1 .and. inconsistent) call measure_closure_error(a, t)
      inconsistent = a%convergence%ended == ended_inconsistent
      call cut(found, -1, merge(mark_inconsistent, mark_not_converged, inconsistent))
      ! Of equations that contradict one another a drive is one: not even its own link has a place then.
      if (.not. inconsistent) call get_certain_links(a%engine, t, found)
      if (inconsistent) a%max_closure_error = max(a%max_closure_error, a%convergence%closure_error)
      call diagnose_end(a, t, w, found)
   end subroutine stay

   !> `t` is not reached by continuity, and is not sought. Why not is told with the first of such instants.
   subroutine pass_over(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(diagnostic_t), allocatable :: list(:)

      call cut(found, -1, mark_not_converged)
      call get_certain_links(a%engine, t, found)
      a%convergence = convergence_t(ended=ended_unsought)
      a%branch = branch_t()
      if (.not. a%is_lost) then
         list = [diagnostic_t(kind=diagnostic_long, t=a%t)]
         if (lies_beyond(a%ends, t)) list = diagnostics_of_limit(a%ends, t)
         call add_diagnostics(list, found)
      end if
      a%is_lost = .true.
   end subroutine pass_over

   !> What is verified of the instant found at the end of the way `w`.
   subroutine judge_branch(a, w)
      type(analysis_t), intent(inout) :: a
      type(step_record_t), intent(in) :: w
      integer :: passed

      passed = 0
      if (allocated(w%passed)) passed = size(w%passed)
      a%branch = w%branch
      if (.not. a%follows) then
         a%branch%kind = branch_first
      else if ((a%convergence%singular .and. .not. w%stands) .or. .not. is_certified(a%engine)) then
         a%branch%kind = branch_none
      else
         a%branch%kind = merge(branch_crossed, branch_same, passed > 0)
      end if
      call count_in(a%certificate_counts, a%branch, passed)
   end subroutine judge_branch

   !> The gap at `t` itself, not where the last part of a step has ended: from the motion that is followed or, where
   !> that is too far, from the deck's position.
   subroutine measure_closure_error(a, t)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(convergence_t) :: before
      real(wp) :: correction
      logical :: same

      before = a%convergence
      call solve_blocks(a%engine%blocks, t, .true., a%convergence, correction, same)
      if (a%convergence%ended == ended_inconsistent) return
      call solve_blocks(a%engine%blocks, t, .false., a%convergence, correction, same)
      if (a%convergence%ended == ended_inconsistent) return
      a%convergence = before
      a%convergence%closure_error = 0.0_wp
   end subroutine measure_closure_error

   !> What there is to say of the first motion that was found.
   subroutine diagnose_start(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      real(wp) :: off(size(a%estimated_angle))
      integer :: link

      a%has_begun = .true.
      if (.not. allocated(a%engine%blocks)) return
      call add_diagnostics(first_diagnostics(a%engine%blocks, a%convergence%singular), found)
      off = without_turns(found%position(3, :) - a%estimated_angle)
      link = maxloc(abs(off), mask=a%engine%blocks%is_found, dim=1)
      if (link == 0) return
      if (abs(off(link)) > far_angle) call add_diagnostics( &
         [diagnostic_t(kind=diagnostic_far_estimate, links=[link, 0, 0, 0, 0, 0], is_angle=.true., value=off(link))], &
         found)
   end subroutine diagnose_start

   !> Why there is no motion at `t`: what stays open, or where the way `w` has ended; that is said once.
   subroutine diagnose_end(a, t, w, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(step_record_t), intent(in) :: w
      type(motion_t), intent(inout) :: found
      type(diagnostic_t), allocatable :: list(:)
      real(wp) :: unit

      allocate (list(0))
      if (allocated(a%engine%blocks)) then
         if (a%convergence%closure_error > 0.0_wp .and. (a%convergence%ended == ended_inconsistent &
            .or. .not. a%follows)) then
            unit = merge(1.0_wp, a%engine%blocks%length*a%convergence%closure_error_unit, &
               a%convergence%closure_error_is_angle)
            call add_diagnostics([diagnostic_t(kind=diagnostic_inconsistent, pair=a%convergence%inconsistent_pair, &
               drive=a%convergence%inconsistent_drive, &
               is_angle=a%convergence%closure_error_is_angle, value=a%convergence%closure_error*unit)], found)
         else if (w%blocked) then
            list = limit_diagnostic(a%engine%blocks, t)
         end if
      end if
      if (allocated(w%dead_end)) then
         if (size(w%dead_end) > 0) list = w%dead_end
      end if
      if (has_too_many_substeps(w)) list = [diagnostic_t(kind=diagnostic_long, t=a%place%t)]
      if (size(list) > 0 .and. .not. a%is_lost) call add_diagnostics(list, found)
      if (a%follows .and. a%convergence%ended /= ended_inconsistent) call note_limit(a%ends, a%place%t, a%t, t, &
         w%blocked, list)
   end subroutine diagnose_end

   subroutine add_diagnostics(list, found)
      type(diagnostic_t), intent(in) :: list(:)
      type(motion_t), intent(inout) :: found

      if (size(list) == 0) return
      if (.not. allocated(found%diagnostics)) allocate (found%diagnostics(0))
      found%diagnostics = [found%diagnostics, list]
   end subroutine add_diagnostics

   !> The motion found last, and what is known of it.
   subroutine get_motion(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      logical :: finite

      call get_motion_of(a%engine, found, finite)
      a%max_closure_error = max(a%max_closure_error, a%convergence%closure_error)
      call cut(found, 2, mark_none)
      if (a%convergence%singular) call cut(found, 0, mark_singular)
      if (a%convergence%rates_open) call cut(found, 0, mark_inconsistent)
      ! Where rates contradict one another no link has any.
      if (found%mark == mark_singular) call get_link_flags(a%engine, found)
      if (.not. finite) call look_for_overflow(found)
   end subroutine get_motion

   !> What is out of the range of the real kind is not known.
   pure subroutine look_for_overflow(found)
      type(motion_t), intent(inout) :: found
      integer :: link, last

      do link = 1, size(found%position, 2)
         last = known_of(found, link)
         if (last == 2 .and. .not. all(abs(found%acceleration(:, link)) <= huge(1.0_wp))) last = 1
         if (last >= 1 .and. .not. all(abs(found%velocity(:, link)) <= huge(1.0_wp))) last = 0
         if (.not. all(abs(found%position(:, link)) <= huge(1.0_wp))) last = -1
         if (last < known_of(found, link)) call cut_link(found, link, last)
      end do
   end subroutine look_for_overflow

   !> Of `link` only derivatives up to number `known` are in range.
   pure subroutine cut_link(q, link, known)
      type(motion_t), intent(inout) :: q
      integer, intent(in) :: link, known

      if (.not. allocated(q%link_known)) then
         allocate (q%link_known(size(q%position, 2)), source=q%known)
         allocate (q%link_mark(size(q%position, 2)), source=q%mark)
      end if
      q%link_known(link) = known
      q%link_mark(link) = mark_overflow
      if (known >= q%known) return
      q%known = known
      q%mark = mark_overflow
   end subroutine cut_link

   !> By how much redundant equations have differed at most, in parts of the characteristic length; -1 where none are.
   pure real(wp) function redundancy_error(a)
      type(analysis_t), intent(in) :: a

      redundancy_error = -1.0_wp
      if (.not. allocated(a%engine%blocks)) return
      if (a%engine%blocks%blocks%redundant > 0) redundancy_error = a%max_closure_error
   end function redundancy_error

   !> What there is to say after the last instant: of BRANCH cards for which there was no change point.
   pure function closing_diagnostics(a) result(list)
      type(analysis_t), intent(in) :: a
      type(diagnostic_t), allocatable :: list(:)

      list = unused(a%branch_requests)
   end function closing_diagnostics

   !> Only derivatives up to number `known` exist, and `mark` says why.
   pure subroutine cut(q, known, mark)
      type(motion_t), intent(inout) :: q
      integer, intent(in) :: known, mark

      call forget_links(q)
      q%known = known
      q%mark = mark
   end subroutine cut
end module analysis
