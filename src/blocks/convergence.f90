!> How an iteration for a position ended: the record that all methods give back; and the closure error by which the
!> equations of a redundant block contradict one another, in position and in its derivatives.
module convergence
   use kinds, only: wp
   use blocks, only: blocks_t, geometry_t
   implicit none
   private
   public :: solve_report_t, nothing_gathered, ended_converged, ended_stalled, ended_singular, ended_limit, &
      ended_diverged, ended_inconsistent, ended_unsought, ended_elsewhere, closure_error_t, ending, is_solved, gather, &
      record_closure_error, contradict

   !> The largest change of a predicted position over the distance of the next root, by the Jacobian and its Lipschitz
   !> constant, that still counts as the continuation of a motion: near a change point another branch passes close by,
   !> with the sign of the determinant that this one had before.
   real(wp), parameter, public :: max_kantorovich_ratio = 0.1_wp
   !> Residuals above this part of the largest value are more than rounding of angles and of their sines.
   real(wp), parameter, public :: rounding_level = 12.0_wp*epsilon(1.0_wp)
   !> Closure errors that differ by less than this part are equal.
   real(wp), parameter :: equal_opening_part = 1.0e-4_wp
   !> Positions may contradict one another by this, in characteristic lengths and radians, as data of 11 digits do.
   real(wp), parameter, public :: inconsistent_level = max(1.0e-10_wp, 64.0_wp*epsilon(1.0_wp))
   !> Rates may contradict one another by this part of them, which a condition makes larger.
   real(wp), parameter :: open_rate_part = max(1.0e-8_wp, 4096.0_wp*epsilon(1.0_wp))
   !> Within a closing tolerance rates may contradict one another by more: by so many times that tolerance.
   real(wp), parameter :: rates_per_closing = 100.0_wp
   !> They never do by more than this part: equations that differ so much in their rates hold the mechanism.
   real(wp), parameter :: held_rate_part = 0.1_wp
   !> The body vectors of a loop may be so short, compared with the known part, that rounding opens the loop by more: by
   !> so many roundings of the known part.
   real(wp), parameter :: loop_roundings = 64.0_wp, rate_roundings = 4096.0_wp

   integer, parameter :: ended_converged = 1   !< residual and step within the tolerance
   integer, parameter :: ended_stalled = 2     !< residual at rounding level, steps shrink no more: solved
   integer, parameter :: ended_singular = 3    !< the matrix has no inverse
   integer, parameter :: ended_limit = 4       !< too many iterations
   integer, parameter :: ended_diverged = 5    !< the values left all bounds
   integer, parameter :: ended_inconsistent = 6        !< too many equations, and they contradict one another
   integer, parameter :: ended_unsought = 7    !< known beforehand to be out of reach: no iteration
   integer, parameter :: ended_elsewhere = 8   !< at another assembly; open%pair: the cylinder below 0

   !> By how much an equation is not satisfied.
   type :: closure_error_t
      real(wp) :: value = 0.0_wp               !< in the unit of length or rad
      logical :: is_angle = .false.
      real(wp) :: unit = 1.0_wp                !< the loop's unit of length, in the one of the mechanism
      real(wp) :: level = 1.0_wp               !< its rows are rounded so many times as coarsely as usual, 1 at least
      integer :: pair = 0, drive = 0           !< whose equation it is; 0: none
   end type closure_error_t

   !> How a position was solved for.
   type :: solve_report_t
      integer :: ended = ended_limit           !< ended_converged, ...
      integer :: iterations = 0                !< in all
      real(wp) :: residual = 0.0_wp            !< largest, over the size of the coordinates
      real(wp) :: step = 0.0_wp                !< largest change of the last iteration, likewise
      integer :: determinant = 0               !< its sign
      real(wp) :: min_pivot = 0.0_wp           !< METHOD DENSE: of its factors, over the largest
      real(wp) :: change = 0.0_wp              !< the largest change of a value from the initial guess
      real(wp) :: kantorovich_ratio = 0.0_wp   !< that change over the distance within which the root is the only one
      real(wp) :: amplification = 0.0_wp              !< of that ratio with the excursion of the drives
      logical :: is_certain = .false.          !< a prediction so right in a substep so short leaves no other branch
      logical :: determinant_signs_kept = .true.          !< the determinants have those of the motion that is followed
      logical :: singular = .false.            !< a position was found, and its Jacobian has no inverse
      type(closure_error_t) :: open            !< the equation that is open the most
      logical :: rates_inconsistent = .false.          !< they agree in position, but not in its derivatives
   end type solve_report_t

   !> A record in which nothing is gathered yet.
   type(solve_report_t), parameter :: nothing_gathered = solve_report_t(ended=ended_converged, determinant=1)

contains

   !> Tells whether a position was found.
   pure logical function is_solved(convergence)
      type(solve_report_t), intent(in) :: convergence

      is_solved = convergence%ended == ended_converged .or. convergence%ended == ended_stalled
   end function is_solved

   !> Adds a record to the record of the whole: the largest of each count, the worst of each ending.
   pure subroutine gather(one, convergence)
      type(solve_report_t), intent(in) :: one                !< of a block
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

   !> Gives the word for how an iteration ended.
   pure function ending(convergence) result(word)
      type(solve_report_t), intent(in) :: convergence
      character(9) :: word
      character(9), parameter :: words(8) = [character(9) :: 'CONVERGED', 'ROUNDING', 'SINGULAR', 'LIMIT', 'DIVERGED', &
         'OPEN', 'UNSOUGHT', 'ELSEWHERE']

      word = words(convergence%ended)
   end function ending

   !> Finds the pair or drive that is open the most, a revolute pair by the distance of its points. If closure errors
   !> are equal, it is the last pair of the deck, or the last drive: rounding shall not choose.
   pure subroutine record_closure_error(b, x, i, residuals, convergence)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      integer, intent(in) :: i                              !< the number of the block
      real(wp), intent(in) :: residuals(*)                  !< (rows of the block) unit of the loop or rad
      type(solve_report_t), intent(inout) :: convergence     !< convergence%open is set
      real(wp), dimension(b%list(i)%first_loop:b%list(i)%last_loop) :: opening, level
      real(wp) :: largest
      integer :: m

      opening = 0.0_wp
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (g => b%loops(m))
            if (g%row_x > 0) opening(m) = abs(residuals(g%row_x))
            if (g%row_y > 0) opening(m) = hypot(opening(m), residuals(g%row_y))
            level(m) = max(1.0_wp, x%loops(m)%coarse*(loop_roundings*epsilon(1.0_wp)/inconsistent_level))
         end associate
      end do

      largest = maxval(opening/level)
      convergence%open%value = 0.0_wp
      convergence%open%pair = 0
      convergence%open%drive = 0
      do m = b%list(i)%first_loop, b%list(i)%last_loop
         associate (row => b%rows(b%list(i)%first_row + max(b%loops(m)%row_x, b%loops(m)%row_y) - 1))
            if (opening(m)/level(m) < (1.0_wp - equal_opening_part)*largest) cycle
            if (row%pair < convergence%open%pair .or. (row%pair == 0 .and. row%drive < convergence%open%drive)) cycle
            convergence%open = closure_error_t(opening(m), row%angular, x%loops(m)%unit, level(m), row%pair, row%drive)
         end associate
      end do
   end subroutine record_closure_error

   !> Tells whether equations contradict one another in their rates.
   pure logical function contradict(open, size_of, coarse, closing)
      real(wp), intent(in) :: open(:)        !< (redundant equations) residuals of their rates
      real(wp), intent(in) :: size_of        !< numbers of this size have gone into them, in their unit
      real(wp), intent(in) :: coarse         !< how much larger the known part of the block is than its own, 1 at least
      real(wp), intent(in) :: closing        !< closing tolerance (unit of the loop, rad)

      contradict = norm2(open) > max(open_rate_part, rate_roundings*epsilon(1.0_wp)*coarse, &
         min(rates_per_closing*min(closing, 1.0_wp), held_rate_part))*size_of
   end function contradict
end module convergence
