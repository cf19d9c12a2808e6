!> The analysis of one set of computations, instant by instant: what is found, what is not, and what there is
!> to say of it.
module analysis
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, forget_links, known_of, mark_none, mark_not_converged, mark_singular, mark_overflow, &
      mark_open
   use remarks, only: remark_t, remark_open, remark_far, remark_long
   use continuity, only: branch_t, tally_t, count_in, branch_none, branch_first, branch_same, branch_crossed
   use whole_turns, only: without_turns
   use choices, only: unused
   use way_ends, only: way_ends_t, note_end, lies_beyond, told_of_end
   use convergence, only: convergence_t, ended_open, ended_unsought
   use block_engine, only: seek_blocks
   use block_remarks, only: first_remarks, limit_remark
   use engine, only: tell, tell_links, tell_certain, is_certified
   use standing, only: stand_on
   use following, only: following_t, way_t, make_following, go_to, is_too_far, has_too_many_parts, go_on_from, go_back
   implicit none
   private
   public :: analysis_t, make_analysis, advance, redundancy_gap, closing_remarks

   !> A rough angle that is off by more is worth a word: the assembly may not be the one that was meant.
   real(wp), parameter :: far_angle = 1.0_wp
   !> The motion that is followed, and what is known of the instants so far.
   type, extends(following_t) :: analysis_t
      type(branch_t) :: branch                   !< of the last instant
      type(tally_t) :: tally                     !< of all instants
      type(way_ends_t) :: ends                   !< of the motion that is followed
      logical :: has_begun = .false.             !< a position was found
      logical :: is_lost = .false.               !< the last one kept does not lead on
      real(wp) :: largest_gap = 0.0_wp           !< of redundant equations, relative
      real(wp), allocatable :: rough_angle(:)    !< (links) of the deck
   end type analysis_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns.
   subroutine make_analysis(a, m)
      type(analysis_t), intent(out) :: a
      type(mechanism_t), intent(in) :: m

      call make_following(a%following_t, m)
      a%rough_angle = m%links%position(3)
   end subroutine make_analysis

   !> Solves instant `t`; `found` is its motion in the deck's units, with what could not be found marked; of links that
   !> no request needs it is not told.
   subroutine advance(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(way_t) :: w

      if (allocated(found%remarks)) deallocate (found%remarks)
      found%t = t
      if (lies_beyond(a%ends, t) .or. is_too_far(a%following_t, t)) then
         call pass_over(a, t, found)
         return
      end if
      call go_to(a%following_t, t, w)
      if (allocated(w%passed)) call add_remarks(w%passed, found)
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
      type(way_t), intent(inout) :: w
      type(motion_t), intent(inout) :: found
      type(remark_t), allocatable :: list(:)

      call tell_motion(a, found)
      if (a%convergence%singular) then
         call stand_on(a%following_t, found%t, w, list, w%stands)
         if (w%stands) call tell_motion(a, found)
         call add_remarks(list, found)
      end if
      call judge_branch(a, w)
      if (.not. a%has_begun .or. (.not. a%follows .and. found%known == 2)) call remark_on_start(a, found)
   end subroutine arrive

   !> No motion was found at `t`, at the end of the way `w`.
   subroutine stay(a, t, w, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(way_t), intent(in) :: w
      type(motion_t), intent(inout) :: found
      logical :: open

      a%branch = branch_t()
      open = a%convergence%ended == ended_open
      if (w%tries > 1 .and. open) call measure_gap(a, t)
      open = a%convergence%ended == ended_open
      call cut(found, -1, merge(mark_open, mark_not_converged, open))
      ! Of equations that contradict one another a drive is one: not even its own link has a place then.
      if (.not. open) call tell_certain(a%engine, t, found)
      if (open) a%largest_gap = max(a%largest_gap, a%convergence%gap)
      call remark_on_end(a, t, w, found)
   end subroutine stay

   !> `t` is not reached by continuity, and is not sought. Why not is told with the first of such instants.
   subroutine pass_over(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      type(remark_t), allocatable :: list(:)

      call cut(found, -1, mark_not_converged)
      call tell_certain(a%engine, t, found)
      a%convergence = convergence_t(ended=ended_unsought)
      a%branch = branch_t()
      if (.not. a%is_lost) then
         list = [remark_t(kind=remark_long, t=a%t)]
         if (lies_beyond(a%ends, t)) list = told_of_end(a%ends, t)
         call add_remarks(list, found)
      end if
      a%is_lost = .true.
   end subroutine pass_over

   !> What is verified of the instant found at the end of the way `w`.
   subroutine judge_branch(a, w)
      type(analysis_t), intent(inout) :: a
      type(way_t), intent(in) :: w
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
      call count_in(a%tally, a%branch, passed)
   end subroutine judge_branch

   !> The gap at `t` itself, not where the last part of a step has ended: from the motion that is followed or, where
   !> that is too far, from the deck's position.
   subroutine measure_gap(a, t)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(convergence_t) :: before
      real(wp) :: correction
      logical :: same

      before = a%convergence
      call seek_blocks(a%engine%blocks, t, .true., a%convergence, correction, same)
      if (a%convergence%ended == ended_open) return
      call seek_blocks(a%engine%blocks, t, .false., a%convergence, correction, same)
      if (a%convergence%ended == ended_open) return
      a%convergence = before
      a%convergence%gap = 0.0_wp
   end subroutine measure_gap

   !> What there is to say of the first motion that was found.
   subroutine remark_on_start(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      real(wp) :: off(size(a%rough_angle))
      integer :: link

      a%has_begun = .true.
      if (.not. allocated(a%engine%blocks)) return
      call add_remarks(first_remarks(a%engine%blocks, a%convergence%singular), found)
      off = without_turns(found%position(3, :) - a%rough_angle)
      link = maxloc(abs(off), mask=a%engine%blocks%is_found, dim=1)
      if (link == 0) return
      if (abs(off(link)) > far_angle) call add_remarks( &
         [remark_t(kind=remark_far, links=[link, 0, 0, 0, 0, 0], is_angle=.true., value=off(link))], found)
   end subroutine remark_on_start

   !> Why there is no motion at `t`: what stays open, or where the way `w` has ended; that is said once.
   subroutine remark_on_end(a, t, w, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(way_t), intent(in) :: w
      type(motion_t), intent(inout) :: found
      type(remark_t), allocatable :: list(:)
      real(wp) :: unit

      allocate (list(0))
      if (allocated(a%engine%blocks)) then
         if (a%convergence%gap > 0.0_wp .and. (a%convergence%ended == ended_open .or. .not. a%follows)) then
            unit = merge(1.0_wp, a%engine%blocks%length*a%convergence%gap_unit, a%convergence%gap_is_angle)
            call add_remarks([remark_t(kind=remark_open, pair=a%convergence%open_pair, drive=a%convergence%open_drive, &
               is_angle=a%convergence%gap_is_angle, value=a%convergence%gap*unit)], found)
         else if (w%blocked) then
            list = limit_remark(a%engine%blocks, t)
         end if
      end if
      if (allocated(w%dead_end)) then
         if (size(w%dead_end) > 0) list = w%dead_end
      end if
      if (has_too_many_parts(w)) list = [remark_t(kind=remark_long, t=a%place%t)]
      if (size(list) > 0 .and. .not. a%is_lost) call add_remarks(list, found)
      if (a%follows .and. a%convergence%ended /= ended_open) call note_end(a%ends, a%place%t, a%t, t, w%blocked, list)
   end subroutine remark_on_end

   subroutine add_remarks(list, found)
      type(remark_t), intent(in) :: list(:)
      type(motion_t), intent(inout) :: found

      if (size(list) == 0) return
      if (.not. allocated(found%remarks)) allocate (found%remarks(0))
      found%remarks = [found%remarks, list]
   end subroutine add_remarks

   !> The motion found last, and what is known of it.
   subroutine tell_motion(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      logical :: finite

      call tell(a%engine, found, finite)
      a%largest_gap = max(a%largest_gap, a%convergence%gap)
      call cut(found, 2, mark_none)
      if (a%convergence%singular) call cut(found, 0, mark_singular)
      if (a%convergence%rates_open) call cut(found, 0, mark_open)
      ! Where rates contradict one another no link has any.
      if (found%mark == mark_singular) call tell_links(a%engine, found)
      if (.not. finite) call look_for_overflow(found)
   end subroutine tell_motion

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
   pure real(wp) function redundancy_gap(a)
      type(analysis_t), intent(in) :: a

      redundancy_gap = -1.0_wp
      if (.not. allocated(a%engine%blocks)) return
      if (a%engine%blocks%blocks%redundant > 0) redundancy_gap = a%largest_gap
   end function redundancy_gap

   !> What there is to say after the last instant: of BRANCH cards for which there was no change point.
   pure function closing_remarks(a) result(list)
      type(analysis_t), intent(in) :: a
      type(remark_t), allocatable :: list(:)

      list = unused(a%choices)
   end function closing_remarks

   !> Only derivatives up to number `known` exist, and `mark` says why.
   pure subroutine cut(q, known, mark)
      type(motion_t), intent(inout) :: q
      integer, intent(in) :: known, mark

      call forget_links(q)
      q%known = known
      q%mark = mark
   end subroutine cut
end module analysis
