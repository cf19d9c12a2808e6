!> Four threads follow the motion of one deck with one structure and one geometry; state, history, guess and workspace
!> are their own. Prints the numbers that differ from those of a single thread in any bit, and how many were compared:
!> threads DECK. Compiled with OpenMP by tests/system/library.sh.
program threads
   use, intrinsic :: iso_fortran_env, only: int64
   !$ use omp_lib, only: omp_get_num_threads
   use kinds, only: wp
   use failures, only: failure_t
   use deck, only: read_deck
   use mechanism, only: mechanism_t, instant
   use blocks, only: blocks_t, geometry_t
   use block_state, only: state_t, new_state, set_drive_values
   use block_solver, only: workspace_t, new_workspace, solve_blocks
   use convergence, only: solve_report_t, is_solved
   use drive_path, only: drive_path_t
   use continuation, only: continuation_t, begin_continuation
   use initial_assembly, only: solve_first
   use initial_estimate, only: guess_t
   use predictor, only: history_t, new_history, predict, accept
   implicit none
   integer, parameter :: instants = 200, count = 4
   type(mechanism_t), allocatable :: sets(:)
   type(failure_t), allocatable :: failure
   character(:), allocatable :: report
   character(200) :: file
   type(continuation_t) :: shared
   real(wp), allocatable :: alone(:, :), found(:, :, :)
   integer :: i, running

   call get_command_argument(1, file)
   call read_deck(trim(file), sets, report, failure)
   if (.not. allocated(sets)) error stop 'no deck'
   call begin_continuation(shared, sets(1))
   allocate (alone(3*shared%blocks%unknowns, instants), source=0.0_wp)
   allocate (found(3*shared%blocks%unknowns, instants, count), source=0.0_wp)
   call follow(shared%blocks, shared%geometry, shared%path, shared%guess, alone)

   running = 1
   !$omp parallel do num_threads(count) schedule(static, 1)
   do i = 1, count
      !$ if (i == 1) running = omp_get_num_threads()
      call follow(shared%blocks, shared%geometry, shared%path, shared%guess, found(:, :, i))
   end do
   !$omp end parallel do
   print '(i0, a, i0, a, i0, a)', running, ' threads, ', sum([(differing(found(:, :, i)), i=1, count)]), ' of ', &
      size(found), ' numbers differ'

contains

   !> Counts the numbers that differ from those of a single thread in any bit.
   pure integer function differing(numbers)
      real(wp), intent(in) :: numbers(:, :)      !< (3*unknowns, instants)

      differing = count_of(transfer(numbers, [0_int64]) /= transfer(alone, [0_int64]))
   end function differing

   !> Counts what is true.
   pure integer function count_of(list)
      logical, intent(in) :: list(:)

      count_of = sum(merge(1, 0, list))
   end function count_of

   !> Follows the motion through the `instants`, a thousandth of the run apart.
   subroutine follow(b, x, path, guess_of_deck, numbers)
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      type(drive_path_t), intent(in) :: path
      type(guess_t), intent(in) :: guess_of_deck
      real(wp), intent(out) :: numbers(:, :)     !< (3*unknowns, instants) values, rates, accelerations
      type(guess_t) :: guess
      type(state_t) :: s
      type(history_t) :: history
      type(workspace_t) :: w
      type(solve_report_t) :: convergence
      real(wp) :: t, change
      integer :: k

      guess = guess_of_deck
      s = new_state(b, size(sets(1)%drives))
      history = new_history(b, sets(1)%predictor)
      w = new_workspace(b)
      do k = 1, instants
         t = sets(1)%t0 + 0.001_wp*real(k - 1, wp)*(sets(1)%t1 - sets(1)%t0)
         call set_drive_values(path, t, s)
         if (k == 1) then
            call solve_first(b, x, guess, w, s, convergence)
         else
            call predict(history, t, s%u, change)
            call solve_blocks(b, x, b%moving, w, s, convergence)
         end if
         if (.not. is_solved(convergence)) error stop 'no position'
         call accept(b, x, s, history)
         numbers(:, k) = [s%u(1:)%value, s%u(1:)%rate, s%u(1:)%acceleration]
      end do
   end subroutine follow
end program threads
