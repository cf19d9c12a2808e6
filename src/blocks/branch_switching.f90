!> Branches of a block's motion that cross at a change point: how a change point is recognized, and the other branch
!> beyond it.
!>
!> Just beyond a change point, at the position x on the branch that goes on smoothly, the Jacobian J has one small
!> singular value s, with the left vector w and the right vector k. To second order along k
!>    w . r(x + a k) = a s + a^2 q/2,   q = w . r''[k, k],
!> so that the other branch is at a = -2 s/q. There the determinant has the sign that it had before the change point.
!>
!> The motion goes smoothly on, unless a BRANCH card asks for the other branch. A change point passed once is passed
!> on the same branch again, in either direction: the motion is a function of time.
module branch_switching
   use kinds, only: wp
   use mechanism, only: mechanism_t, branch_request_t
   use motion, only: diagnostic_t, new_diagnostic, diagnostic_change, diagnostic_dead_end
   use convergence, only: solve_report_t, is_solved
   use drive_path, only: drive_path_t, time_at_part
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t, set_values, values_of, largest_drive_rate
   use block_rank, only: svd_t, decomposed, curvature_of
   use block_solver, only: workspace_t, solve_blocks
   use predictor, only: history_t, compare
   use block_diagnostics, only: links_of
   implicit none
   private
   public :: pass, switch_branch, is_smooth_passage, branch_requests_t, new_branch_requests, decide

   !> A determinant that changes its sign over a substep this short, in rad or units of the loop, may indicate a change
   !> point.
   real(wp), parameter :: short_substep = max(1.0e-4_wp, 0.75_wp*sqrt(sqrt(epsilon(1.0_wp))))
   !> It does if the prediction was right to this part of the substep. Circuits that pass each other at the distance d
   !> are distinguished from crossing ones if d^2 is above prediction_part*short_substep**2, 1E-14.
   real(wp), parameter :: prediction_part = max(1.0e-6_wp, 0.7_wp*epsilon(1.0_wp)**0.375_wp)
   !> A prediction that is off by more than this part of the substep is wrong, whatever rounding may explain.
   real(wp), parameter :: wrong_prediction_part = 1.0e-2_wp
   !> A substep may be longer if the pivots at its ends are together less than this part of the Lipschitz constant. If a
   !> crank in line with a base is almost as long, the coupler is so fast that short substeps would all end in the zone
   !> in which rounding leaves no velocities. Three widths of that zone are enough. With more of them, circuits that do
   !> not meet, of lengths that are off by 1E-13, would be taken for crossing ones.
   real(wp), parameter :: short_pivots = 0.02_wp*short_substep
   !> Rounding of a prediction near a change point is at most this times lipschitz*change/pivot**2.
   real(wp), parameter :: prediction_rounding = 500.0_wp*epsilon(1.0_wp)
   !> The largest distance at which the other branch is searched for, in rad and units of the loop: the second order
   !> holds no further.
   real(wp), parameter :: furthest_branch = 0.05_wp
   !> The largest closure error of redundant equations on the other branch, as a part of |q| a^2.
   real(wp), parameter :: max_closure_part = 0.01_wp

   !> A card may be this part of its time late or early: the listing gives the time of a change point to six digits.
   real(wp), parameter :: card_time_part = 1.0e-5_wp

   !> A change point of a block that was passed.
   type :: branch_switch_t
      integer :: block = 0                        !< the number of the block
      real(wp) :: t = 0.0_wp                      !< its time, in the deck's unit
      real(wp) :: width = 0.0_wp                  !< the uncertainty of its time
      logical :: other = .false.                  !< the other branch was taken
   end type branch_switch_t

   !> BRANCH cards, and how change points were passed.
   type :: branch_requests_t
      type(branch_request_t), allocatable :: cards(:)   !< in the deck's order
      logical, allocatable :: used(:)             !< (cards) it has been obeyed
      type(branch_switch_t), allocatable :: branch_switches(:)   !< the change points that were passed, in turn
      real(wp), allocatable :: stood_until        !< time to which the motion last stood on a singular position
   end type branch_requests_t

contains

   !> Lists the BRANCH cards of a mechanism, none of them used yet.
   pure function new_branch_requests(m) result(c)
      type(mechanism_t), intent(in) :: m
      type(branch_requests_t) :: c

      allocate (c%branch_switches(0), c%cards(0))
      if (allocated(m%branch_requests)) c%cards = m%branch_requests
      allocate (c%used(size(c%cards)), source=.false.)
   end function new_branch_requests

   !> Decides whether a block takes the other branch at its change point between two times, and records the decision. A
   !> change point passed before is decided as before. A change point on which the motion stood has the time at which
   !> the motion left it. Of the cards not used yet that name one of the links, or no link, the card counts whose time
   !> was passed first.
   pure subroutine decide(requests, block, links, before, t, at, other)
      type(branch_requests_t), intent(inout) :: requests   !< the card may become used; a change point is added
      integer, intent(in) :: block                !< the number of the block
      logical, intent(in) :: links(:)             !< (links) the block moves it
      real(wp), intent(in) :: before, t           !< the two times in the order of the motion, in the deck's unit
      real(wp), intent(in) :: at                  !< approximate time of the change point, in the deck's unit
      logical, intent(out) :: other               !< the block takes the other branch
      real(wp) :: way, here
      integer :: i, best

      do i = 1, size(requests%branch_switches)
         associate (p => requests%branch_switches(i))
            other = p%other
            if (p%block == block .and. abs(p%t - at) <= p%width + abs(t - before)) return
         end associate
      end do

      way = sign(1.0_wp, t - before)
      here = at
      if (allocated(requests%stood_until)) here = way*max(way*at, way*requests%stood_until)
      best = 0
      do i = 1, size(requests%cards)
         associate (card => requests%cards(i))
            if (requests%used(i) .or. (card%link > 0 .and. .not. links(max(card%link, 1)))) cycle
            if (way*(card%t - here) > abs(t - before) + card_time_part*max(abs(card%t), abs(here))) cycle
            if (best > 0) then
               if (way*(card%t - requests%cards(best)%t) >= 0.0_wp) cycle
            end if
            best = i
         end associate
      end do

      other = best > 0
      if (other) requests%used(best) = .true.
      requests%branch_switches = [requests%branch_switches, branch_switch_t(block, at, abs(t - before), other)]
   end subroutine decide

   !> Passes the change points between the latest motion of the history and the state, each as the BRANCH cards request.
   !> If convergence%determinant_signs_kept, the state is the continuation of the motion. Otherwise there is none, and
   !> the last diagnostic of the list names the branch that was not found; the list is empty if a determinant has
   !> changed its sign without a change point.
   subroutine pass(b, x, path, history, w, s, requests, convergence, list)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path   !< of the drives
      type(history_t), intent(inout) :: history              !< empty after a switch to another branch
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s                      !< the motion found last; then on the branch requested
      type(branch_requests_t), intent(inout) :: requests   !< BRANCH cards, and change points passed
      type(solve_report_t), intent(inout) :: convergence      !< of that motion
      type(diagnostic_t), allocatable, intent(out) :: list(:)   !< one for each change point
      type(diagnostic_t) :: r
      logical :: crossed(size(b%list)), passed
      integer :: k

      allocate (list(0))
      crossed = s%crossed
      ! Without a block that has crossed, a prediction leapt too far and was not solved: there is nothing to pass.
      passed = any(crossed) .and. is_smooth_passage(b, x, history, s, convergence%change)
      do k = 1, size(b%moving)
         if (.not. passed) exit
         associate (i => b%moving(k), before => history%t(0), t => s%t)
            if (.not. crossed(i)) cycle
            r = new_diagnostic(diagnostic_change, links_of(b, x, i))

            ! The least pivot goes through zero in proportion to the values of the drives.
            r%t = time_at_part(path, before, t, &
               history%jacobian(i)%pivot/(history%jacobian(i)%pivot + s%jacobian(i)%pivot))
            if (size(requests%cards) > 0) then
               call decide(requests, i, links_of(b, x, i), before, t, r%t, r%other)
               if (r%other) call switch_branch(b, x, history, w, s, i, convergence, passed)
            end if
            if (.not. passed) r%kind = diagnostic_dead_end
            list = [list, r]
         end associate
      end do
      convergence%determinant_signs_kept = passed
   end subroutine pass

   !> Tells whether the motion found last is on the branch that goes on smoothly, also beyond change points. It is if
   !> the substep was short, and its prediction right to a small part of the substep. Near a change point rounding makes
   !> the prediction wrong in proportion to lipschitz/pivot^2, as it does the rates, and to the larger of the predicted
   !> change and the change of the drives. In a longer substep the part is smaller as the inverse square of its length:
   !> circuits at an equal distance are then distinguished.
   pure logical function is_smooth_passage(b, x, history, s, correction) result(is)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(history_t), intent(in) :: history                 !< with one motion at least
      type(state_t), intent(in) :: s                         !< the motion found last, with the blocks that have crossed
      real(wp), intent(in) :: correction                     !< of its prediction, in rad or units of the loop
      real(wp), dimension(size(b%moving)) :: lipschitz, rounded
      real(wp) :: allowed, driven
      logical, dimension(size(b%moving)) :: crosses, is_short

      crosses = s%crossed(b%moving)
      lipschitz = x%blocks(b%moving)%lipschitz
      is_short = s%change <= short_substep &
         .or. history%jacobian(b%moving)%pivot + s%jacobian(b%moving)%pivot <= short_pivots*lipschitz
      is = merge(all(is_short .or. .not. crosses), any(is_short), any(crosses))
      if (.not. is) return
      driven = abs(s%t - history%t(0))*largest_drive_rate(s)
      rounded = prediction_rounding*lipschitz/history%jacobian(b%moving)%pivot**2*max(s%change, driven)
      allowed = prediction_part*(short_substep/max(short_substep, s%change))**2*s%change &
         + merge(minval(rounded, mask=crosses), maxval(rounded), any(crosses))
      is = correction <= min(allowed, wrong_prediction_part*s%change)
   end function is_smooth_passage

   !> Puts a block on its other branch, close to a change point or dead point, and then the blocks that build on it. On
   !> the other branch the determinant has the other sign. The motions before do not predict this branch.
   subroutine switch_branch(b, x, history, w, s, i, convergence, found)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(history_t), intent(inout) :: history              !< emptied, unless the branch is too far
      type(workspace_t), intent(inout) :: w
      type(state_t), intent(inout) :: s                      !< the motion found last; then on the branch, if found
      integer, intent(in) :: i                               !< the number of the block
      type(solve_report_t), intent(inout) :: convergence      !< of the solution there; stays if the branch is too far
      logical, intent(out) :: found                          !< the state is on the other branch
      type(svd_t) :: v
      real(wp), dimension(b%list(i)%shape%n) :: direction, here
      real(wp) :: curvature, away, correction
      logical :: same, crossed(size(b%list))

      crossed = s%crossed
      here = values_of(b, i, s)
      v = decomposed(b, x, i, s)
      direction = v%right(v%n, :)
      curvature = curvature_of(b, x, i, here, v%left(:, v%n), direction, s)
      found = abs(curvature)*furthest_branch > 2.0_wp*v%s(v%n)
      if (.not. found) return
      away = -2.0_wp*v%s(v%n)/curvature
      call set_values(b, i, here + away*direction, s)
      call solve_blocks(b, x, b%moving, w, s, convergence)
      if (is_solved(convergence)) call compare(b, x, b%moving, history, s, convergence)
      ! Only the correction of this block counts: blocks that build on it move by any multiple of the correction.
      correction = maxval(abs(values_of(b, i, s) - (here + away*direction)))
      crossed(i) = .not. crossed(i)
      same = .not. any(s%crossed .and. .not. crossed)
      found = is_solved(convergence) .and. same .and. .not. convergence%singular .and. correction <= 0.5_wp*abs(away) &
         .and. convergence%open%value <= max_closure_part*abs(curvature)*away**2
      history%filled = 0
   end subroutine switch_branch
end module branch_switching
