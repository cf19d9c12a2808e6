!> Level 22. Speed against error (--study): every way of solving a deck is timed and compared with the truth, the
!> motion by the same program in real128.
module study
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use failures, only: failure_t, fail, status_solved, status_refused
   use mechanism, only: mechanism_t
   use structure, only: findings_t
   use deck, only: read_deck
   use job, only: check_structure
   use text_output, only: output_t, open_output, put, close_output
   use numerals, only: whole
   use trial_forms, only: trial_t, outcome_t
   use trials, only: try, measure, can_be_timed
   use kin, only: ask_kin
   use true_errors, only: truth_t, new_truth, errors_of
   use study_plan, only: plan_t, way_t, new_plan, plan_ways, truth_trial, default_trial, kind_single, kind_double, &
      kind_quad, section_tolerance, section_kinds
   use study_head, only: put_head, put_refusal
   use study_table, only: row_t, put_section, put_row, put_cheapest
   use study_estimates, only: put_estimates
   implicit none
   private
   public :: run_study

   integer, parameter :: digits_double = 53, digits_quad = 113, digits_single = 24
   !> What the truth can tell at best, and how far below an error its own must be.
   real(dp), parameter :: best = 1.0e-30_dp, margin = 10.0_dp

contains

   !> The study of the deck in the file `path`, to `output`, '' for standard output. `message`: lines for standard
   !> error, '' for none.
   subroutine run_study(path, output, status, message)
      character(*), intent(in) :: path, output
      integer, intent(out) :: status
      character(:), allocatable, intent(out) :: message
      type(mechanism_t), allocatable :: sets(:)
      type(findings_t), allocatable :: findings(:)
      type(failure_t), allocatable :: failure
      type(output_t) :: o
      integer :: i

      status = status_solved
      message = ''
      if (digits(1.0_wp) /= digits_double) then
         call fail(failure, status_refused, '--study IS FOR kinmat IN REAL64, WHICH ASKS THIS PROGRAM FOR ITS PART')
      else
         call read_deck(path, sets, message, failure)
      end if
      if (.not. allocated(failure)) call check_structure(sets, findings, failure)
      if (.not. allocated(failure)) call open_output(o, output, failure)
      if (.not. allocated(failure)) then
         do i = 1, size(sets)
            call study_set(o, path, sets(i), i, findings(i)%redundant > 0, failure)
            if (allocated(failure)) exit
         end do
         if (.not. allocated(failure)) call close_output(o, failure)
      end if
      if (.not. allocated(failure)) return
      status = failure%status
      if (len(message) == 0) message = ' *** '//failure%text
   end subroutine run_study

   subroutine study_set(o, path, m, set, redundant, failure)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: path
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: set
      logical, intent(in) :: redundant
      type(failure_t), allocatable, intent(out) :: failure
      type(plan_t) :: p
      type(way_t), allocatable :: ways(:)
      type(row_t), allocatable :: rows(:)
      type(truth_t) :: truth
      real(dp) :: finest(0:2)

      p = new_plan(m, set, redundant)
      if (set > 1) call put(o, '')
      call put(o, ' SPEED AGAINST ERROR   SET '//whole(set)//'   '//trim(m%title))
      if (.not. p%possible .or. p%last == 0) then
         call put_refusal(o, p)
         return
      end if
      ways = plan_ways(p)
      allocate (rows(size(ways)))
      rows%way = ways
      call ask_quad(path, m, p, truth, rows, failure)
      if (.not. allocated(failure)) call ask_single(path, m, truth, rows, failure)
      if (allocated(failure)) return
      call put_head(o, m, p, truth)
      if (.not. any(truth%motion%known == 2)) return
      call try_all(m, truth, rows)
      finest = max(best, margin*truth_doubt(rows))
      call put_rows(o, p, rows, finest)
      call put_estimates(o, m, p, truth)
   end subroutine study_set

   !> The truth, and the rows in real128.
   subroutine ask_quad(path, m, p, truth, rows, failure)
      character(*), intent(in) :: path
      type(mechanism_t), intent(in) :: m
      type(plan_t), intent(in) :: p
      type(truth_t), intent(out) :: truth
      type(row_t), intent(inout) :: rows(:)
      type(failure_t), allocatable, intent(out) :: failure
      type(trial_t), allocatable :: list(:)
      type(outcome_t), allocatable :: outcomes(:)
      integer :: i

      list = [truth_trial(p), pack(rows%way%trial, rows%way%kind == kind_quad)]
      call ask_kin('kinmat-quad', digits_quad, path, list, [(size(m%links), i=1, size(list))], outcomes, failure)
      if (allocated(failure)) return
      truth = new_truth(m, list(1), outcomes(1))
      call take_outcomes(m, truth, kind_quad, outcomes(2:), rows)
   end subroutine ask_quad

   !> The rows in single precision; a deck of which it cannot read the numbers is none for it.
   subroutine ask_single(path, m, truth, rows, failure)
      character(*), intent(in) :: path
      type(mechanism_t), intent(in) :: m
      type(truth_t), intent(in) :: truth
      type(row_t), intent(inout) :: rows(:)
      type(failure_t), allocatable, intent(out) :: failure
      type(trial_t), allocatable :: list(:)
      type(outcome_t), allocatable :: outcomes(:)
      integer :: i

      list = pack(rows%way%trial, rows%way%kind == kind_single)
      call ask_kin('kinmat-single', digits_single, path, list, [(size(m%links), i=1, size(list))], outcomes, failure)
      if (.not. allocated(failure)) then
         call take_outcomes(m, truth, kind_single, outcomes, rows)
      else if (failure%status == status_refused) then
         deallocate (failure)
         do i = 1, size(rows)
            if (rows(i)%way%kind == kind_single) allocate (rows(i)%time(0))
         end do
      end if
   end subroutine ask_single

   !> Fills the rows of one kind, in their order.
   subroutine take_outcomes(m, truth, kind, outcomes, rows)
      type(mechanism_t), intent(in) :: m
      type(truth_t), intent(in) :: truth
      integer, intent(in) :: kind
      type(outcome_t), intent(in) :: outcomes(:)
      type(row_t), intent(inout) :: rows(:)
      integer :: i, k

      k = 0
      do i = 1, size(rows)
         if (rows(i)%way%kind /= kind) cycle
         k = k + 1
         rows(i)%errors = errors_of(truth, m, rows(i)%way%trial, outcomes(k))
         rows(i)%iterations = outcomes(k)%iterations
         rows(i)%time = outcomes(k)%time
      end do
   end subroutine take_outcomes

   !> The rows in double precision. What is measured is measured in turn, repeat by repeat.
   subroutine try_all(m, truth, rows)
      type(mechanism_t), intent(in) :: m
      type(truth_t), intent(in) :: truth
      type(row_t), intent(inout) :: rows(:)
      type(outcome_t) :: one
      real(dp) :: whole_time(size(rows))
      integer :: i, k

      do i = 1, size(rows)
         if (rows(i)%way%kind /= kind_double) cycle
         associate (t => rows(i)%way%trial)
            call try(m, t, one, whole_time(i))
            rows(i)%errors = errors_of(truth, m, t, one)
            rows(i)%iterations = one%iterations
            allocate (rows(i)%time(merge(t%repeats, 0, can_be_timed(t, one))))
         end associate
      end do
      do k = 1, maxval(rows%way%trial%repeats)
         do i = 1, size(rows)
            if (rows(i)%way%kind /= kind_double) cycle
            if (k <= size(rows(i)%time)) rows(i)%time(k) = measure(m, rows(i)%way%trial, whole_time(i))
         end do
      end do
   end subroutine try_all

   !> What two marches in real128 differ by (0:2), to the limit of rounding.
   pure function truth_doubt(rows) result(doubt)
      type(row_t), intent(in) :: rows(:)
      real(dp) :: doubt(0:2)
      integer :: i

      doubt = 0.0_dp
      do i = 1, size(rows)
         if (rows(i)%way%kind /= kind_quad .or. rows(i)%way%trial%tolerance > 0.0_dp) cycle
         if (rows(i)%errors%compared > 0) doubt = max(doubt, rows(i)%errors%most)
      end do
   end function truth_doubt

   subroutine put_rows(o, p, rows, finest)
      type(output_t), intent(inout) :: o
      type(plan_t), intent(in) :: p
      type(row_t), intent(in) :: rows(:)
      real(dp), intent(in) :: finest(0:2)
      character(*), parameter :: titles(4) = [character(20) :: '1  TOLERANCE', '2  NUMBER OF STEPS', &
         '3  START OF A STEP', '4  PRECISION']
      type(trial_t) :: t
      real(dp), allocatable :: standard(:)
      integer :: i, section

      t = default_trial(p)
      allocate (standard(0))
      do i = size(rows), 1, -1
         associate (w => rows(i)%way)
            if (w%section == section_kinds .and. w%kind == kind_double .and. w%trial%method == t%method) &
               standard = rows(i)%time
         end associate
      end do
      do section = section_tolerance, section_kinds
         if (.not. any(rows%way%section == section)) cycle
         call put_section(o, trim(titles(section)))
         do i = 1, size(rows)
            if (rows(i)%way%section == section) call put_row(o, rows(i), standard, finest)
         end do
      end do
      call put_cheapest(o, rows, p%last, standard)
      if (p%finer > 1) call put_cheapest(o, rows, p%last*p%finer, standard)
   end subroutine put_rows
end module study
