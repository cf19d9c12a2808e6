!> The report of a solution for a position, which all methods give back: how the iteration ended, and the closure error
!> by which the equations of a redundant block contradict one another, in position and in its derivatives.
module convergence
   use kinds, only: wp
   use blocks, only: blocks_t, geometry_t
   implicit none
   private
   public :: solve_report_t, nothing_gathered, ended_converged, ended_stalled, ended_singular, ended_limit, &
      ended_diverged, ended_inconsistent, ended_unsought, ended_elsewhere, closure_error_t, ending, is_solved, gather, &
      record_closure_error, contradict

   !> The largest change of a predicted position over the distance of the next root, by the Jacobian and its Lipschitz
   !> constant, that still counts as the continuation of a motion. Near a change point another branch passes close by,
   !> where the determinant has the sign that it had on this branch before: a tenth keeps well away from it.
   real(wp), parameter, public :: max_kantorovich_ratio = 0.1_wp
   !> Residuals above this part of the largest value are more than rounding of angles and of their sines.
   real(wp), parameter, public :: rounding_level = 12.0_wp*epsilon(1.0_wp)
   !> Closure errors that differ by less than this part are equal: rounding shall not choose the pair that is named.
   real(wp), parameter :: equal_closure_part = 1.0e-4_wp
   !> Redundant equations may have this closure error, in units of their loops and radians, as data of 11 digits do.
   real(wp), parameter, public :: inconsistent_level = max(1.0e-10_wp, 64.0_wp*epsilon(1.0_wp))
   !> Their rates may have residuals of this part of the largest rate: the closure error, times a condition of 100.
   real(wp), parameter :: rate_residual_part = max(1.0e-8_wp, 4096.0_wp*epsilon(1.0_wp))
   !> With a closing tolerance the residuals of rates may be this many times the tolerance: the condition again.
   real(wp), parameter :: rates_per_closing = 100.0_wp
   !> With a closing tolerance they are never more than this part: equations whose rates differ so much stop the links.
   real(wp), parameter :: max_rate_residual_part = 0.1_wp
   !> If the body vectors of a loop are much shorter than its given part, closure errors and residuals of rates may be
   !> this many roundings of the given part.
   real(wp), parameter :: loop_roundings = 64.0_wp, rate_roundings = 4096.0_wp

   ! How an iteration ended.
   integer, parameter :: ended_converged = 1   !< residual and step within the tolerance
   integer, parameter :: ended_stalled = 2     !< residual at rounding level, steps shrink no more: solved
   integer, parameter :: ended_singular = 3    !< the matrix has no inverse
   integer, parameter :: ended_limit = 4       !< too many iterations
   integer, parameter :: ended_diverged = 5    !< a value has exceeded all bounds
   integer, parameter :: ended_inconsistent = 6        !< redundant equations contradict one another
   integer, parameter :: ended_unsought = 7    !< there is no position within reach: no iteration was made
   integer, parameter :: ended_elsewhere = 8   !< at another assembly; open%pair: the cylinder with a length below 0

   !> The residual of an equation, or of the two equations of a revolute pair.
   type :: closure_error_t
      real(wp) :: value = 0.0_wp               !< in the unit of the loop, or rad
      logical :: is_angle = .false.            !< in rad, not a length
      real(wp) :: unit = 1.0_wp                !< the loop's unit of length, in the one of the mechanism
      real(wp) :: level = 1.0_wp               !< its rows are rounded so many times as coarsely as usual, 1 at least
      integer :: pair = 0, drive = 0           !< number of the pair or drive that has the equation; 0: none
   end type closure_error_t

   !> The report of a solution for a position. Values and residuals are in rad or units of their loops; METHOD DENSE and
   !> METHOD MATRIX divide residual and step by the size of the coordinates.
   type :: solve_report_t
      integer :: ended = ended_limit           !< ended_converged, ...
      integer :: iterations = 0                !< the largest number of a block
      real(wp) :: residual = 0.0_wp            !< the largest of the last iteration
      real(wp) :: step = 0.0_wp                !< the largest correction of the last iteration
      integer :: determinant = 0               !< sign of the product of the determinants; 0: exactly 0, or no position
      real(wp) :: min_pivot = 0.0_wp           !< METHOD DENSE: the least pivot over the largest
      real(wp) :: change = 0.0_wp              !< the largest change of a value from the initial guess
      real(wp) :: kantorovich_ratio = 0.0_wp   !< largest ratio of a change to the distance in which the root is single
      real(wp) :: amplification = 0.0_wp              !< by which the ratio grows with the excursion of the drives
      logical :: is_certain = .false.          !< so exact a prediction in so short a substep leaves no other branch
      logical :: determinant_signs_kept = .true.          !< they are the signs of the motion that is followed
      logical :: singular = .false.            !< a position was found, and its Jacobian has no inverse
      type(closure_error_t) :: open            !< the equation with the largest closure error
      logical :: rates_inconsistent = .false.          !< redundant equations agree in position, but not in their rates
   end type solve_report_t

   !> The report of no blocks, to which reports of blocks are added.
   type(solve_report_t), parameter :: nothing_gathered = solve_report_t(ended=ended_converged, determinant=1)

contains

   !> Tells whether a position was found.
   pure logical function is_solved(convergence)
      type(solve_report_t), intent(in) :: convergence   !< of the iteration

      is_solved = convergence%ended == ended_converged .or. convergence%ended == ended_stalled
   end function is_solved

   !> Adds the report of a block to the report of all: the largest iterations, residual, step and closure error, the
   !> product of the determinants, the last ending that is not ended_converged. A block at another assembly names its
   !> cylinder. Changes and ratios are not added.
   pure subroutine gather(one, convergence)
      type(solve_report_t), intent(in) :: one                !< of the block
      type(solve_report_t), intent(inout) :: convergence     !< of all blocks so far

      if (one%ended /= ended_converged) convergence%ended = one%ended
      convergence%iterations = max(convergence%iterations, one%iterations)
      convergence%residual = max(convergence%residual, one%residual)
      convergence%step = max(convergence%step, one%step)
      convergence%determinant = convergence%determinant*one%determinant
      if (one%open%value > convergence%open%value .or. one%ended == ended_elsewhere) convergence%open = one%open
      convergence%singular = convergence%singular .or. one%singular
      convergence%rates_inconsistent = convergence%rates_inconsistent .or. one%rates_inconsistent
   end subroutine gather

   !> Gives the word, printed in the log, for the way in which an iteration ended.
   pure function ending(convergence) result(word)
      type(solve_report_t), intent(in) :: convergence   !< of the iteration
      character(9) :: word
      !> (ended_converged:ended_elsewhere) The words.
      character(9), parameter :: words(8) = [character(9) :: 'CONVERGED', 'ROUNDING', 'SINGULAR', 'LIMIT', 'DIVERGED', &
         'OPEN', 'UNSOUGHT', 'ELSEWHERE']

      word = words(convergence%ended)
   end function ending

   !> Finds the pair or drive of a block with the largest closure error; of a revolute pair this is the distance of its
   !> points. If closure errors are equal, the last pair of the deck counts, or the last drive: rounding shall not
   !> choose. Errors are compared over their rounding levels.
   pure subroutine record_closure_error(b, x, i, residuals, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                              !< the number of the block, with one loop at least
      real(wp), intent(in) :: residuals(*)                  !< (rows of the block) unit of the loop or rad
      type(solve_report_t), intent(inout) :: convergence     !< convergence%open is set
      real(wp), dimension(b%list(i)%first_loop:b%list(i)%last_loop) :: error, level
      real(wp) :: largest
      integer :: m

      error = 0.0_wp
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            if (g%row_x > 0) error(m) = abs(residuals(g%row_x))
            if (g%row_y > 0) error(m) = hypot(error(m), residuals(g%row_y))
            level(m) = max(1.0_wp, x%loops(m)%coarse*(loop_roundings*epsilon(1.0_wp)/inconsistent_level))
         end associate
      end do

      largest = maxval(error/level)
      convergence%open%value = 0.0_wp
      convergence%open%pair = 0
      convergence%open%drive = 0
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (row => b%rows(b%list(i)%first_row + max(b%loops(m)%row_x, b%loops(m)%row_y) - 1))
            if (error(m)/level(m) < (1.0_wp - equal_closure_part)*largest) cycle
            if (row%pair < convergence%open%pair .or. (row%pair == 0 .and. row%drive < convergence%open%drive)) cycle
            convergence%open = closure_error_t(error(m), row%angular, x%loops(m)%unit, level(m), row%pair, row%drive)
         end associate
      end do
   end subroutine record_closure_error

   !> Tells whether redundant equations contradict one another in their rates or accelerations.
   pure logical function contradict(open, size_of, coarse, closing)
      real(wp), intent(in) :: open(:)        !< (redundant equations) residuals of their rates or accelerations
      real(wp), intent(in) :: size_of        !< the largest rate or acceleration in the equations, in their unit
      real(wp), intent(in) :: coarse         !< size of the block's given part over its own body vectors, 1 at least
      real(wp), intent(in) :: closing        !< closing tolerance (unit of the loop, rad)

      contradict = norm2(open) > max(rate_residual_part, rate_roundings*epsilon(1.0_wp)*coarse, &
         min(rates_per_closing*min(closing, 1.0_wp), max_rate_residual_part))*size_of
   end function contradict
end module convergence
