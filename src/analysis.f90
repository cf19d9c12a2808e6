!> Level 13. The analysis of one set of computations, instant by instant. The motion is followed from the last one
!> found, in as many parts as that takes: an assembly is never changed in silence.
module analysis
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton
   use motion, only: motion_t, mark_none, mark_not_converged, mark_singular, mark_overflow, mark_open
   use remarks, only: remark_t, remark_open, remark_far
   use scales, only: characteristic_length, largest_rate
   use convergence, only: convergence_t, is_solved, ended_open
   use predictor, only: largest_change
   use block_engine, only: block_engine_t, new_block_engine, seek_blocks, keep_blocks, tell_blocks, &
      mark_blocks, return_blocks
   use block_remarks, only: first_remarks, limit_remark, crosses, change_remark
   use dense_engine, only: dense_t, new_dense, seek_dense, keep_dense, tell_dense, mark_dense, return_dense
   implicit none
   private
   public :: analysis_t, new_analysis, advance, redundancy_gap

   !> The largest correction, in the characteristic length and in radians, of a predicted position that is still taken
   !> for the continuation of the motion; where the prediction is off by more, the step is divided.
   real(wp), parameter :: largest_correction = 0.1_wp
   !> The same over the distance of the next root, as the Jacobian and its bend tell it: near a change point
   !> another branch passes close by, with the sign of the determinant that this one had before.
   real(wp), parameter :: largest_doubt = 0.1_wp
   !> A rough angle that is off by more is worth a word: the assembly may not be the one that was meant.
   real(wp), parameter :: far_angle = 1.0_wp
   !> A part of a step smaller than this, of the longest or of what is left to go, is the end of the way; and so are
   !> that many parts.
   real(wp), parameter :: smallest_part = max(1.0e-10_wp, 4.0_wp*epsilon(1.0_wp))
   integer, parameter :: most_parts = 200000
   !> Near a limit a slow iteration creeps, and each part that fails costs all of its iterations: so many failures
   !> of parts that are small already end the way too.
   integer, parameter :: most_failures = 300
   real(wp), parameter :: small_part = 1.0e-3_wp

   !> One of the two engines, and how far it has come.
   type :: analysis_t
      type(block_engine_t), allocatable :: blocks
      type(dense_t), allocatable :: dense
      type(convergence_t) :: convergence         !< of the last position sought
      logical :: follows = .false.               !< a regular motion is kept, found at `t`
      real(wp) :: t = 0.0_wp
      real(wp) :: place = 0.0_wp                 !< where the step that was divided last began
      logical :: has_begun = .false.             !< a position was found
      logical :: is_lost = .false.               !< the last one kept does not lead on
      real(wp) :: largest_gap = 0.0_wp           !< of redundant equations, relative
      real(wp), allocatable :: rough_angle(:)    !< (links) of the deck
      real(wp) :: longest_part = huge(1.0_wp)    !< of a step: no drive moves by more than `largest_change` in it
   end type analysis_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns.
   function new_analysis(m) result(a)
      type(mechanism_t), intent(in) :: m
      type(analysis_t) :: a
      real(wp) :: rate

      if (m%method == method_newton) then
         a%blocks = new_block_engine(m)
      else
         a%dense = new_dense(m)
      end if
      a%rough_angle = m%links%position(3)
      rate = largest_rate(m, characteristic_length(m))
      if (rate > 0.0_wp) a%longest_part = largest_change/rate
   end function new_analysis

   !> Solves instant `t`; `found` is its motion in the deck's units, with what could not be found marked; of links that
   !> no request needs it is not told.
   subroutine advance(a, t, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(motion_t), intent(inout) :: found
      real(wp) :: part, here, longest
      integer :: parts, failures
      logical :: accepted, arrived, blocked

      blocked = .false.
      if (allocated(found%remarks)) deallocate (found%remarks)
      part = t - a%t
      longest = min(a%longest_part, abs(part))
      failures = 0
      do parts = 1, most_parts
         part = sign(min(abs(part), a%longest_part), part)
         arrived = .not. a%follows .or. abs(part) >= abs(t - a%t)
         here = merge(t, a%t + part, arrived)
         call attempt(a, here, accepted, found)
         arrived = arrived .and. accepted
         if (arrived) exit
         if (parts == 1) call mark_place(a)
         accepted = accepted .and. .not. a%convergence%singular
         if (accepted) call keep(a, here)
         if (.not. a%follows) exit
         if (.not. accepted .and. abs(part) <= small_part*longest) failures = failures + 1
         part = merge(1.5_wp, 0.5_wp, accepted)*part
         blocked = abs(part) <= smallest_part*min(longest, abs(t - a%t))
         if (blocked .or. failures > most_failures) exit
      end do
      found%t = t
      if (arrived) then
         call tell(a, found)
         if (.not. a%has_begun .or. (.not. a%follows .and. found%known == 2)) call remark_on_start(a, found)
      else
         if (parts > 1 .and. a%convergence%ended == ended_open) call measure_gap(a, t)
         call cut(found, -1, merge(mark_open, mark_not_converged, a%convergence%ended == ended_open))
         if (a%convergence%ended == ended_open) a%largest_gap = max(a%largest_gap, a%convergence%gap)
         call remark_on_end(a, t, blocked, found)
      end if
      if (found%known == 2) then
         call keep(a, t)
      else if (parts > 1) then
         call return_to_place(a)
      end if
      a%is_lost = .not. arrived
   end subroutine advance

   !> The gap at `t` itself, not where the last part of a step has ended: from the motion that is followed or, where
   !> that is too far, from the deck's position.
   subroutine measure_gap(a, t)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      type(convergence_t) :: before
      real(wp) :: correction
      logical :: same

      before = a%convergence
      call seek_blocks(a%blocks, t, .true., a%convergence, correction, same)
      if (a%convergence%ended == ended_open) return
      call seek_blocks(a%blocks, t, .false., a%convergence, correction, same)
      if (a%convergence%ended == ended_open) return
      a%convergence = before
      a%convergence%gap = 0.0_wp
   end subroutine measure_gap

   !> What there is to say of the first motion that was found.
   subroutine remark_on_start(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      type(remark_t), allocatable :: list(:)
      integer :: link, i

      a%has_begun = .true.
      if (.not. allocated(a%blocks)) return
      list = first_remarks(a%blocks, a%convergence%singular)
      do i = 1, size(list)
         call add_remark(list(i), found)
      end do
      link = maxloc(abs(found%position(3, :) - a%rough_angle), mask=a%blocks%is_found, dim=1)
      if (link == 0) return
      if (abs(found%position(3, link) - a%rough_angle(link)) > far_angle) call add_remark( &
         remark_t(kind=remark_far, links=[link, 0, 0, 0, 0, 0], is_angle=.true., &
         value=found%position(3, link) - a%rough_angle(link)), found)
   end subroutine remark_on_start

   !> Why there is no motion at `t`: what stays open, or where the way is `blocked`; that is said once.
   subroutine remark_on_end(a, t, blocked, found)
      type(analysis_t), intent(in) :: a
      real(wp), intent(in) :: t
      logical, intent(in) :: blocked
      type(motion_t), intent(inout) :: found
      type(remark_t), allocatable :: list(:)
      real(wp) :: unit

      if (.not. allocated(a%blocks)) return
      if (a%convergence%gap > 0.0_wp .and. (a%convergence%ended == ended_open .or. .not. a%follows)) then
         unit = merge(1.0_wp, a%blocks%length, a%convergence%gap_is_angle)
         call add_remark(remark_t(kind=remark_open, pair=a%convergence%open_pair, drive=a%convergence%open_drive, &
            is_angle=a%convergence%gap_is_angle, value=a%convergence%gap*unit), found)
      else if (blocked .and. .not. a%is_lost) then
         list = limit_remark(a%blocks, t)
         if (size(list) > 0) call add_remark(list(1), found)
      end if
   end subroutine remark_on_end

   !> Seeks the motion at `t`; `accepted`: it is the continuation of the one that is followed, or the first. A
   !> change point on the way is a remark of `found`.
   subroutine attempt(a, t, accepted, found)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t
      logical, intent(out) :: accepted
      type(motion_t), intent(inout) :: found
      real(wp) :: correction
      logical :: same

      if (allocated(a%blocks)) then
         call seek_blocks(a%blocks, t, a%follows, a%convergence, correction, same)
      else
         call seek_dense(a%dense, t, a%follows, a%convergence, correction, same)
      end if
      accepted = is_solved(a%convergence)
      if (.not. a%follows) return
      if (accepted .and. .not. same .and. .not. a%convergence%singular .and. allocated(a%blocks)) then
         same = crosses(a%blocks, correction)
         if (same) call add_remark(change_remark(a%blocks, t), found)
      end if
      accepted = accepted .and. same .and. correction <= largest_correction .and. a%convergence%doubt <= largest_doubt
   end subroutine attempt

   subroutine add_remark(r, found)
      type(remark_t), intent(in) :: r
      type(motion_t), intent(inout) :: found

      if (.not. allocated(found%remarks)) allocate (found%remarks(0))
      found%remarks = [found%remarks, r]
   end subroutine add_remark

   !> Notes the motion that is followed, before a step is divided.
   subroutine mark_place(a)
      type(analysis_t), intent(inout) :: a

      a%place = a%t
      if (allocated(a%blocks)) then
         call mark_blocks(a%blocks)
      else
         call mark_dense(a%dense)
      end if
   end subroutine mark_place

   !> Follows it again: what comes after an instant without a motion is as if that had not been asked for. From
   !> close to a dead point no step back would be small enough.
   subroutine return_to_place(a)
      type(analysis_t), intent(inout) :: a

      a%t = a%place
      if (allocated(a%blocks)) then
         call return_blocks(a%blocks)
      else
         call return_dense(a%dense)
      end if
   end subroutine return_to_place

   !> Makes the motion found last, at `t`, the one that is followed.
   subroutine keep(a, t)
      type(analysis_t), intent(inout) :: a
      real(wp), intent(in) :: t

      if (allocated(a%blocks)) then
         call keep_blocks(a%blocks)
      else
         call keep_dense(a%dense)
      end if
      a%t = t
      a%follows = .true.
   end subroutine keep

   !> The motion found last, and what is known of it.
   subroutine tell(a, found)
      type(analysis_t), intent(inout) :: a
      type(motion_t), intent(inout) :: found
      logical :: finite

      if (allocated(a%blocks)) then
         call tell_blocks(a%blocks, found, finite)
      else
         call tell_dense(a%dense, found)
         finite = .false.
      end if
      a%largest_gap = max(a%largest_gap, a%convergence%gap)
      call cut(found, 2, mark_none)
      if (a%convergence%singular) call cut(found, 0, mark_singular)
      if (a%convergence%rates_open) call cut(found, 0, mark_open)
      if (.not. finite) call look_for_overflow(found)
   end subroutine tell

   !> What is out of the range of the real kind is not known.
   pure subroutine look_for_overflow(found)
      type(motion_t), intent(inout) :: found

      if (found%known == 2 .and. .not. all(abs(found%acceleration) <= huge(1.0_wp))) call cut(found, 1, mark_overflow)
      if (found%known >= 1 .and. .not. all(abs(found%velocity) <= huge(1.0_wp))) call cut(found, 0, mark_overflow)
      if (.not. all(abs(found%position) <= huge(1.0_wp))) call cut(found, -1, mark_overflow)
   end subroutine look_for_overflow

   !> By how much redundant equations have differed at most, in parts of the characteristic length; -1 where none are.
   pure real(wp) function redundancy_gap(a)
      type(analysis_t), intent(in) :: a

      redundancy_gap = -1.0_wp
      if (.not. allocated(a%blocks)) return
      if (a%blocks%blocks%redundant > 0) redundancy_gap = a%largest_gap
   end function redundancy_gap

   !> Only derivatives up to number `known` exist, and `mark` says why.
   pure subroutine cut(q, known, mark)
      type(motion_t), intent(inout) :: q
      integer, intent(in) :: known, mark

      q%known = known
      q%mark = mark
   end subroutine cut
end module analysis
