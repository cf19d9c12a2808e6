!> How an iteration for a position ended: the record that all methods give back.
module convergence
   use kinds, only: wp
   implicit none
   private
   public :: convergence_t, ended_converged, ended_stalled, ended_singular, ended_limit, ended_diverged, &
      ended_inconsistent, ended_unsought, ended_elsewhere
   public :: closure_error_t, ending, is_solved, gather

   integer, parameter :: ended_converged = 1   !< residual and step within the tolerance
   integer, parameter :: ended_stalled = 2     !< residual at rounding level, steps shrink no more: solved
   integer, parameter :: ended_singular = 3    !< the matrix has no inverse
   integer, parameter :: ended_limit = 4       !< too many iterations
   integer, parameter :: ended_diverged = 5    !< the residual left all bounds
   integer, parameter :: ended_inconsistent = 6        !< too many equations, and they contradict one another
   integer, parameter :: ended_unsought = 7    !< known beforehand to be out of reach: no iteration
   integer, parameter :: ended_elsewhere = 8   !< at another assembly than the estimated one

   !> By how much an equation is not satisfied.
   type :: closure_error_t
      real(wp) :: value = 0.0_wp               !< in the unit of length or rad
      logical :: is_angle = .false.
      real(wp) :: unit = 1.0_wp                !< that unit of length, in the one of the mechanism
      real(wp) :: level = 1.0_wp               !< how many times as coarse as usual its rows are rounded, 1 at least
      integer :: pair = 0, drive = 0           !< whose equation it is; 0: none
   end type closure_error_t

   !> How a position was solved for.
   type :: convergence_t
      integer :: ended = ended_limit           !< ended_converged, ...
      integer :: iterations = 0                !< in all
      real(wp) :: residual = 0.0_wp            !< largest, over the size of the coordinates
      real(wp) :: step = 0.0_wp                !< largest change of the last iteration, likewise
      real(wp) :: rate = 0.0_wp                !< mean ratio of successive residuals
      real(wp) :: reciprocal_condition = 0.0_wp !< of the Jacobian at the position found
      integer :: determinant = 0               !< its sign
      real(wp) :: min_pivot = 0.0_wp         !< of its factors
      real(wp) :: change = 0.0_wp              !< the largest of a value, from where the search began
      real(wp) :: kantorovich_ratio = 0.0_wp !< that change over the distance within which the root is the only one
      real(wp) :: inverse = 0.0_wp             !< |J^-1| there
      real(wp) :: growth = 0.0_wp              !< of that ratio with the excursion of the drives
      logical :: is_certain = .false.          !< a prediction so right in a substep so short leaves no other branch
      logical :: singular = .false.            !< position found where the Jacobian has no inverse
      type(closure_error_t) :: open            !< the equation that is open the most
      logical :: rates_open = .false.          !< they agree in position, but not in its derivatives
   end type convergence_t

contains

   !> A position was found.
   pure logical function is_solved(c)
      type(convergence_t), intent(in) :: c

      is_solved = c%ended == ended_converged .or. c%ended == ended_stalled
   end function is_solved

   !> The record of the whole: the largest of each count, the worst of each ending.
   pure subroutine gather(one, c)
      type(convergence_t), intent(in) :: one
      type(convergence_t), intent(inout) :: c

      if (one%ended /= ended_converged) c%ended = one%ended
      c%iterations = max(c%iterations, one%iterations)
      c%residual = max(c%residual, one%residual)
      c%step = max(c%step, one%step)
      c%reciprocal_condition = min(c%reciprocal_condition, one%reciprocal_condition)
      c%determinant = c%determinant*one%determinant
      if (one%open%value > c%open%value) c%open = one%open
      c%singular = c%singular .or. one%singular
      c%rates_open = c%rates_open .or. one%rates_open
   end subroutine gather

   !> The word for how it ended.
   pure function ending(c) result(word)
      type(convergence_t), intent(in) :: c
      character(9) :: word
      character(9), parameter :: words(8) = [character(9) :: 'CONVERGED', 'ROUNDING', 'SINGULAR', 'LIMIT', 'DIVERGED', &
         'OPEN', 'UNSOUGHT', 'ELSEWHERE']

      word = words(c%ended)
   end function ending
end module convergence
