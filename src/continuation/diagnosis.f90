!> Diagnosis by blocks. METHOD DENSE and METHOD MATRIX have the equations as one system, and cannot tell of an instant
!> without a position whether the mechanism has come to a limit or the method has failed. The blocks can: they solve
!> from the same position, and what they say of the mechanism does not depend on how an iteration goes.
module diagnosis
   use kinds, only: wp
   use mechanism, only: mechanism_t, place_links, wanted_links
   use motion, only: motion_t, new_motion, mark_not_converged, mark_singular, diagnostic_t, diagnostic_inconsistent, &
      diagnostic_limit, diagnostic_beyond, diagnostic_close, diagnostic_far_estimate, diagnostic_second, &
      diagnostic_mobile, diagnostic_idle, diagnostic_repeated, diagnostic_method
   use convergence, only: ended_elsewhere
   use structure, only: structure_t
   use dense_start, only: by_blocks
   use dense_engine, only: dense_engine_t
   use analysis, only: analysis_t, make_analysis, advance
   implicit none
   private
   public :: opinion_t, ask_blocks

   !> Angles that differ by less, in radians, are those of one assembly.
   real(wp), parameter :: alike = 1.0e-3_wp

   !> What the analysis had come to at the instant before: limits are said once, and what there is of the first motion.
   type :: opinion_t
      logical :: is_lost = .false.      !< no position was found
      logical :: has_begun = .false.    !< a position was found before
      real(wp), allocatable :: limit    !< of the motion, which was told of an instant before; from there on it is lost
   end type opinion_t

contains

   !> Adds to the diagnostics of `found`, which `a` has found last of `m` by METHOD DENSE or MATRIX: how far the
   !> estimate was off; the limit of the motion, which equation is not satisfied, what can still move; or that METHOD
   !> NEWTON finds a position; and what a singular position is. `o`: what has been said before.
   subroutine ask_blocks(m, a, o, found)
      type(mechanism_t), intent(in) :: m
      type(analysis_t), intent(in) :: a
      type(opinion_t), intent(inout) :: o
      type(motion_t), intent(inout) :: found
      real(wp), allocatable :: last(:, :)
      type(structure_t) :: structure
      logical :: is_said

      select type (e => a%engine)
      class is (dense_engine_t)
         if (a%follows) then
            last = e%followed_position()
         else
            structure = e%structure
         end if
      class default
         return
      end select
      ! A pole of a law is told by any method.
      is_said = a%follows .and. o%is_lost
      if (allocated(found%diagnostics)) is_said = is_said .or. any(found%diagnostics%is_pole)
      if (found%mark == mark_not_converged) then
         if (.not. is_said) then
            call say_why(m, a, o%is_lost, structure, found, last)
            call note_limit(o, found)
         else if (allocated(o%limit)) then
            found%diagnostics = [diagnostic_t(kind=diagnostic_beyond, t=o%limit)]
         end if
      else if (found%mark == mark_singular) then
         call judge_singularity(m, .not. o%has_begun, found)
      else if (.not. o%has_begun) then
         call say_how_far(m, found)
      end if
      if (.not. a%is_lost .and. allocated(o%limit)) deallocate (o%limit)
      o%is_lost = a%is_lost
      o%has_begun = a%has_begun
   end subroutine ask_blocks

   !> Keeps the limit of the motion that `found` tells, if it tells one.
   pure subroutine note_limit(o, found)
      type(opinion_t), intent(inout) :: o
      type(motion_t), intent(in) :: found
      integer :: i

      if (.not. allocated(found%diagnostics)) return
      do i = 1, size(found%diagnostics)
         if (found%diagnostics(i)%kind == diagnostic_limit) o%limit = found%diagnostics(i)%t
      end do
   end subroutine note_limit

   !> Why there is no position, from the position `last` (3, links) that is followed or, without one, from the estimate,
   !> by blocks of the `structure`; `is_known`: the instant before had none either.
   subroutine say_why(m, a, is_known, structure, found, last)
      type(mechanism_t), intent(in) :: m
      type(analysis_t), intent(in) :: a
      logical, intent(in) :: is_known
      type(structure_t), intent(inout) :: structure
      type(motion_t), intent(inout) :: found
      real(wp), intent(in), optional :: last(:, :)
      type(analysis_t) :: b
      type(motion_t) :: q

      q = new_motion(size(m%links))
      if (present(last)) then
         call make_analysis(b, placed(m, last))
         call advance(b, a%t, q)
         if (q%known < 2) return
      else
         call make_analysis(b, by_blocks(m), structure)
      end if
      call advance(b, found%t, q)
      call pass_on(q, [diagnostic_inconsistent, diagnostic_limit, diagnostic_close], found)
      if (q%known < 0 .or. is_known) return
      call pass_on(q, [diagnostic_mobile, diagnostic_idle, diagnostic_repeated], found)
      if (allocated(found%diagnostics)) then
         if (size(found%diagnostics) > 0) return
      end if
      found%diagnostics = [diagnostic_t(kind=diagnostic_method, other=a%convergence%ended == ended_elsewhere)]
   end subroutine say_why

   !> How far the estimate was from the first motion, and whether it means another as well.
   subroutine say_how_far(m, found)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(inout) :: found
      type(mechanism_t) :: d
      type(analysis_t) :: b
      type(motion_t) :: q

      d = by_blocks(m)
      d%requests = m%requests
      q = new_motion(size(m%links))
      call make_analysis(b, d)
      call advance(b, found%t, q)
      if (q%known < 0) return
      if (any(abs(q%position(3, :) - found%position(3, :)) > alike .and. wanted_links(d))) return
      call pass_on(q, [diagnostic_far_estimate, diagnostic_second], found)
   end subroutine say_how_far

   !> Whether the singular position is a change point or a dead point; of the first motion (`is_first`) also what can
   !> move there.
   subroutine judge_singularity(m, is_first, found)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: is_first
      type(motion_t), intent(inout) :: found
      type(analysis_t) :: b
      type(motion_t) :: q

      q = new_motion(size(m%links))
      call make_analysis(b, placed(m, found%position))
      call advance(b, found%t, q)
      found%singularity = q%singularity
      found%singular_links = q%singular_links
      if (is_first) call pass_on(q, [diagnostic_mobile, diagnostic_idle, diagnostic_repeated], found)
   end subroutine judge_singularity

   !> `m` for the blocks, its estimate the `position` (3, links) in the deck's unit from the origin of the plane.
   pure function placed(m, position) result(d)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: position(:, :)
      type(mechanism_t) :: d

      d = by_blocks(m)
      call place_links(d, position)
   end function placed

   !> Adds the diagnostics of `q` that are of one of the `kinds` to those of `found`.
   subroutine pass_on(q, kinds, found)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: kinds(:)
      type(motion_t), intent(inout) :: found
      integer :: i

      if (.not. allocated(q%diagnostics)) return
      if (.not. allocated(found%diagnostics)) allocate (found%diagnostics(0))
      do i = 1, size(q%diagnostics)
         if (any(kinds == q%diagnostics(i)%kind)) found%diagnostics = [found%diagnostics, q%diagnostics(i)]
      end do
   end subroutine pass_on
end module diagnosis
