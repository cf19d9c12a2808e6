!> The analysis of a set, each of its independent mechanisms by itself: its own steps and substeps, its own limits,
!> change points and flags. The worst of them is reported for the set.
module set_analysis
   use assertions, only: asserts, assert
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, instant, instant_count, measure_line
   use scales, only: characteristic_length
   use plane_vectors, only: pi
   use structure, only: structure_report_t, find_structure
   use continuation, only: certificate_counts_t, branch_none, branch_first
   use error_estimate, only: error_estimate_t, estimator_t, make_estimator, estimate_errors, estimate_of
   use significance_check, only: max_amplification, find_amplification
   use link_motion, only: move_links
   use motion_proof, only: motion_prover_t, prove_motion
   use sensitivities, only: find_sensitivities
   use set_motion, only: set_motion_t, new_set_motion, find_row_in_set
   use motion, only: add_diagnostics, diagnostic_t, new_diagnostic, diagnostic_surplus, diagnostic_turned, &
      diagnostic_unused, motion_t, new_motion, turned_t, flag_inconsistent
   use block_rank, only: surplus_drives
   use columns, only: kinds_of_rows
   use points, only: row_t, find_row, keep_turns
   use assemblies, only: assemblies_t, find_nearest
   use analysis, only: analysis_t, analyze_structure, reuse_analysis, advance, evaluate_at, restore_instant, &
      redundancy_error
   use convergence, only: inconsistent_level
   implicit none
   private
   public :: set_analysis_t, make_set_analysis, analyze_set, begin_analysis, foresee_closure, reuse_set_analysis, &
      advance_set, accept_state, rows_at, sample_set, prove_set, set_certificates, set_closing_diagnostics
   public :: errors_unasked, errors_in_doubt, errors_always

   !> The angles from which measures go on between the instants of TIME, if extremes are searched for.
   type :: path_t
      real(wp), allocatable :: turned(:, :)                 !< (measures, 0:steps) rad; huge: not known
   end type path_t

   !> A LINE that turns by more than this (rad) from one instant to the next may have turned the other way: 120
   !> degrees, but for rounding.
   real(wp), parameter :: largest_turn = 2.0_wp*pi/3.0_wp + 1.0e-9_wp

   !> Whether errors of rows are estimated: not, if a digit of a table is in doubt, always.
   enum, bind(c)
      enumerator :: errors_unasked, errors_in_doubt, errors_always
   end enum

   !> The analyses of the parts of a set, and what goes with each.
   type :: set_analysis_t
      type(set_motion_t) :: now                             !< the motion found last, and how far it is known
      type(analysis_t), allocatable :: list(:)              !< (parts)
      ! Of classes: the compiler then calls one procedure that frees them, instead of its code wherever a set is freed.
      class(estimator_t), allocatable :: estimators(:)      !< (parts) of the errors of rows
      class(motion_prover_t), allocatable :: provers(:)     !< (parts) of the steps, for card PROVE
      type(assemblies_t), allocatable :: assemblies(:)      !< (parts) at the first instant, if they are asked for
      type(certificate_counts_t) :: worst                   !< of all instants, if the set has several parts
      logical, allocatable :: reported_drives(:)            !< (parts) surplus drives have been searched for
      logical :: is_in_lane = .false.                       !< a lane has found `now`; the analyses have not
      real(wp) :: amplification = 0.0_wp                    !< then: factor by which roundings grow; no digit is lost
      type(path_t), allocatable :: paths(:)                 !< (parts) of measures that go on and have extremes
      logical :: has_turns = .false.                        !< some measure goes on from instant to instant
      integer :: taken = 0                                  !< instants so far, if some measure does
      logical :: reported_turn = .false.                    !< a LINE that turns far in a step has been reported
   end type set_analysis_t

contains

   !> Makes the analysis of a set, ready for its first instant. If all assemblies are asked for, the analysis begins in
   !> the nearest one.
   subroutine make_set_analysis(m, set)
      type(mechanism_t), intent(in) :: m     !< the set; its equations are as many as its unknowns
      type(set_analysis_t), intent(out) :: set   !< ready for its first instant
      type(structure_report_t) :: structure_report

      structure_report = find_structure(m)
      call analyze_set(m, structure_report, set)
   end subroutine make_set_analysis

   !> Makes the analysis of a set whose structure is known, ready for its first instant.
   subroutine analyze_set(m, structure_report, set)
      type(mechanism_t), intent(in) :: m     !< the set
      type(structure_report_t), intent(inout) :: structure_report   !< of the set, which loses it
      type(set_analysis_t), intent(out) :: set   !< ready for its first instant

      call new_set_motion(m, set%now, structure_report)
      call begin_analysis(set, structure_report)
   end subroutine analyze_set

   !> Begins the analysis of a set that is divided into its mechanisms.
   subroutine begin_analysis(set, structure_report)
      type(set_analysis_t), intent(inout) :: set   !< `now` is divided; gets the rest
      type(structure_report_t), intent(inout) :: structure_report   !< of the set, which loses it
      integer :: c

      associate (n => set%now%count)
         allocate (set%list(n))
         allocate (set%reported_drives(n), source=.false.)
         allocate (estimator_t :: set%estimators(n))
         allocate (motion_prover_t :: set%provers(n))
      end associate

      if (set%now%assemblies) allocate (set%assemblies(set%now%count))
      do c = 1, set%now%count
         if (set%now%assemblies) call find_nearest(set%now%parts(c), instant(set%now, 0), set%assemblies(c))
         call analyze_structure(set%list(c), set%now%parts(c), structure_report%structures(c))
         call make_estimator(set%estimators(c), set%now%parts(c))
      end do
      call begin_paths(set)
   end subroutine begin_analysis

   !> Finds the largest closure error of all instants of a set before its run, by a run of its own. Without a closing
   !> tolerance, or if equations agree without it, the error is 0. Reason: no number of the run is known better than
   !> the closure error.
   subroutine foresee_closure(set)
      type(set_analysis_t), intent(inout) :: set   !< before its first instant; its estimators get the error
      type(analysis_t) :: first_run
      type(motion_t) :: q
      integer :: c, k

      do c = 1, set%now%count
         if (.not. (set%now%closing > 0.0_wp .and. set%list(c)%blocks%redundant > 0)) cycle
         first_run = set%list(c)
         q = new_motion(size(set%now%parts(c)%links))
         do k = 0, instant_count(set%now) - 1
            call advance(first_run, instant(set%now, k), q)
         end do
         ! The error of an instant without a position is larger than the tolerance.
         if (redundancy_error(first_run) > inconsistent_level) &
            set%estimators(c)%closure = min(redundancy_error(first_run), set%now%closing)
      end do
   end subroutine foresee_closure

   !> Begins the paths of the set: no instant is taken yet.
   subroutine begin_paths(set)
      type(set_analysis_t), intent(inout) :: set   !< divided
      integer :: c

      set%has_turns = .false.
      set%taken = 0
      set%reported_turn = .false.
      if (allocated(set%paths)) deallocate (set%paths)
      allocate (set%paths(set%now%count))
      do c = 1, set%now%count
         associate (own => set%now%parts(c))
            if (.not. allocated(own%measures)) cycle
            set%has_turns = set%has_turns .or. any(own%measures%continues)
            if (any(own%measures%continues) .and. any(own%requests%extremes)) &
               allocate (set%paths(c)%turned(size(own%measures), 0:max(0, set%now%steps)))
         end associate
      end do
   end subroutine begin_paths

   !> Makes the analysis of the previous variant ready for the first instant of a variant. Structure and memory of the
   !> analysis stay.
   subroutine reuse_set_analysis(m, set, is_done)
      type(mechanism_t), intent(in) :: m     !< the variant
      type(set_analysis_t), intent(inout) :: set   !< of the previous variant; new if there is none
      logical, intent(out) :: is_done        !< the structure is equal; otherwise `set` is of no use

      is_done = allocated(set%list) .and. m%method == method_newton
      if (is_done) is_done = size(set%list) == 1
      if (.not. is_done) return
      associate (own => set%now%parts(1))
         ! These keep numbers of the mechanism.
         is_done = .not. (any(kinds_of_rows(own%requests%kind)%is_centre) .or. allocated(own%tolerances) &
            .or. own%assemblies)
         if (.not. is_done) return

         own%settings_t = m%settings_t
         set%now%settings_t = m%settings_t
         own%links(:) = m%links
         own%points(:) = m%points
         own%pairs(:) = m%pairs
         own%drives(:) = m%drives
         if (allocated(own%measures)) then
            own%measures = m%measures
            own%measures%length = characteristic_length(own)
         end if
         call reuse_analysis(set%list(1), own, is_done)
         if (.not. is_done) return
         set%now%motions(1) = new_motion(size(own%links))
         call make_estimator(set%estimators(1), own)
      end associate
      set%reported_drives = .false.
      set%is_in_lane = .false.
      set%now%has_begun = .false.
      call begin_paths(set)
   end subroutine reuse_set_analysis

   !> Solves an instant of a set. Parts without a motion are flagged in `now`.
   subroutine advance_set(set, t)
      type(set_analysis_t), intent(inout) :: set   !< at the instant before, or at its beginning
      real(wp), intent(in) :: t              !< time
      integer :: c

      set%is_in_lane = .false.
      do c = 1, size(set%list)
         call advance(set%list(c), t, set%now%motions(c))
         if (set%now%motions(c)%flag == flag_inconsistent) call report_redundant_drives(set, c)
      end do
      call keep_instant(set)
   end subroutine advance_set

   !> Takes an instant of a set of one mechanism, with the motion that a lane has put into the state of its analysis. If
   !> the instant is not taken, the analysis must find its motion.
   subroutine accept_state(set, t, is_taken)
      type(set_analysis_t), intent(inout) :: set   !< `now` gets the motion
      real(wp), intent(in) :: t              !< time
      logical, intent(out) :: is_taken       !< all numbers are in range, and no digit is in doubt
      logical :: is_finite, may_lose_digits

      associate (a => set%list(1), q => set%now%motions(1))
         q%t = t
         if (allocated(q%diagnostics)) deallocate (q%diagnostics)
         call move_links(a%geometry%chain, a%geometry%chain%wanted, a%state, q, is_finite)
         call find_amplification(set%estimators(1)%sizes, set%now%parts(1), a%blocks, a%geometry, a%state, q, &
            set%amplification, may_lose_digits)
      end associate
      is_taken = is_finite .and. .not. may_lose_digits
      set%is_in_lane = .true.
      if (is_taken) call keep_instant(set)
   end subroutine accept_state

   !> Keeps the numbers of an instant that later instants need, after the analyses or a lane have found the motion. A
   !> row has no other place for numbers that it keeps from instant to instant. An instant that a lane hands back is
   !> kept when the analysis has found it. Times between two instants are not kept, nor instants of a lane if no row is
   !> asked for.
   subroutine keep_instant(set)
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      integer :: c

      if (set%has_turns) then
         do c = 1, size(set%list)
            call keep_measures(set, c)
         end do
         set%taken = set%taken + 1
      end if
      if (.not. set%now%has_begun) set%now%first = set%now%motions(:size(set%now%first))
      set%now%has_begun = .true.
      if (size(set%list) == 1) return
      call count_worst_motion(set)
      do c = 1, size(set%list)
         set%now%motions(c)%singular_links%part = c
         if (allocated(set%now%motions(c)%diagnostics)) set%now%motions(c)%diagnostics%part = c
      end do
   end subroutine keep_instant

   !> Keeps the angles of measures that go on from instant to instant. Reports the first LINE that turns far, once.
   subroutine keep_measures(set, part)
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      integer, intent(in) :: part               !< the number of the independent mechanism
      type(turned_t), allocatable :: before(:)
      integer :: i

      associate (own => set%now%parts(part), q => set%now%motions(part))
         if (allocated(q%turned)) before = q%turned
         call keep_turns(own, q)
         if (.not. allocated(q%turned)) return
         if (allocated(set%paths(part)%turned) .and. set%taken <= set%now%steps) &
            set%paths(part)%turned(:, set%taken) = merge(q%turned%angle, huge(1.0_wp), q%turned%is_known)
         if (.not. allocated(before) .or. set%reported_turn) return
         do i = 1, size(before)
            if (own%measures(i)%kind /= measure_line) cycle
            if (.not. (before(i)%is_latest .and. q%turned(i)%is_latest)) cycle
            if (abs(q%turned(i)%angle - before(i)%angle) <= largest_turn) cycle
            call add_diagnostics([diagnostic_t(diagnostic_turned, part, measure=i, t=q%t, is_angle=.true., &
               value=abs(q%turned(i)%angle - before(i)%angle))], q)
            set%reported_turn = .true.
            return
         end do
      end associate
   end subroutine keep_measures

   !> Counts the certificate of an instant of several mechanisms: the part with the worst one decides. An instant
   !> without a position of each part is not counted.
   subroutine count_worst_motion(set)
      type(set_analysis_t), intent(inout) :: set   !< at the instant

      associate (counts => set%worst, kinds => set%list%branch%kind)
         counts%passed = sum(set%list%certificate_counts%passed)
         if (any(set%now%motions%known < 0)) return
         if (any(kinds == branch_none)) then
            counts%uncertain = counts%uncertain + 1
         else if (all(kinds /= branch_first)) then
            counts%followed = counts%followed + 1
         end if
      end associate
   end subroutine count_worst_motion

   !> Reports the drives of which one may be too many, at the first instant at which redundant equations are
   !> inconsistent; nothing if there are none.
   subroutine report_redundant_drives(set, part)
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      integer, intent(in) :: part               !< the number of the independent mechanism
      logical :: are(size(set%now%parts(part)%drives))

      if (set%reported_drives(part)) return
      set%reported_drives(part) = .true.
      are = surplus_drives(set%list(part)%blocks, set%list(part)%geometry, size(are), set%list(part)%state)
      if (.not. any(are)) return
      associate (q => set%now%motions(part))
         if (.not. allocated(q%diagnostics)) allocate (q%diagnostics(0))
         q%diagnostics = [q%diagnostics, new_diagnostic(diagnostic_surplus, are)]
      end associate
   end subroutine report_redundant_drives

   !> Finds the rows of requests of a set at its last instant, or at a time between the instants. The motion of the last
   !> instant stays in `now`.
   subroutine rows_at(set, list, t, effort, rows, error, amplification)
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      integer, intent(in) :: list(:)         !< the requests, all of one independent mechanism
      real(wp), intent(in) :: t              !< the time, at most that of the last instant
      integer, intent(in) :: effort          !< whether errors are estimated: errors_unasked, ...
      type(row_t), intent(inout) :: rows(size(list))   !< `known` of each is -1 without a motion
      real(wp), intent(out) :: error(3, 0:2, size(list))   !< in the deck's units and rad; 0 if nothing is estimated
      real(wp), intent(out) :: amplification   !< the factor by which roundings grow; 0 if nothing is estimated
      type(motion_t) :: q
      logical :: is_found
      integer :: i

      if (asserts) then
         call assert(size(list) > 0, 'rows_at: at least one request')
         call assert(all(list >= 1 .and. list <= size(set%now%rows)), 'rows_at: requests of the set')
         call assert(all(set%now%rows(list)%part == set%now%rows(list(1))%part), 'rows_at: of one mechanism')
      end if
      error = 0.0_wp
      amplification = 0.0_wp

      associate (c => set%now%rows(list(1))%part)
         if (abs(t - set%now%motions(c)%t) > 0.0_wp) then
            q = new_motion(size(set%now%parts(c)%links))
            if (allocated(set%now%motions(c)%turned)) q%turned = turned_near(c)
            call evaluate_at(set%list(c), t, q, is_found)
            rows%known = -1
            if (.not. is_found) return
            if (allocated(q%turned)) call keep_turns(set%now%parts(c), q)
            call find_rows_of(c, q)
         else if (set%is_in_lane) then
            do i = 1, size(list)
               call find_row_in_set(set%now, list(i), rows(i))
            end do
            amplification = set%amplification
         else
            call restore_instant(set%list(c))
            call find_rows_of(c, set%now%motions(c))
         end if
      end associate

   contains

      !> Gives the angles of measures at the instant of TIME before `t`, from which they go on.
      function turned_near(part) result(turned)
         integer, intent(in) :: part            !< the number of the independent mechanism
         type(turned_t), allocatable :: turned(:)   !< (measures)
         integer :: k

         turned = set%now%motions(part)%turned
         if (.not. allocated(set%paths(part)%turned)) return
         k = floor((t - set%now%t0)/(set%now%t1 - set%now%t0)*set%now%steps)
         k = max(0, min(k, set%taken - 1, set%now%steps))
         turned%angle = set%paths(part)%turned(:, k)
         turned%is_known = turned%angle < huge(1.0_wp)
      end function turned_near

      !> Finds the rows of a motion of an independent mechanism, and their errors.
      subroutine find_rows_of(part, q)
         integer, intent(in) :: part            !< the number of the independent mechanism
         type(motion_t), intent(in) :: q     !< the motion, of which the analysis has the state
         type(error_estimate_t) :: estimate
         integer :: i

         associate (own => set%now%parts(part), a => set%list(part))
            do i = 1, size(list)
               call find_row(own, q, own%requests(set%now%rows(list(i))%number), rows(i))
            end do
            if (effort == errors_unasked) return
            call estimate_errors(set%estimators(part), own, a%blocks, a%geometry, a%state, q, &
               effort == errors_always, .false., estimate)
            amplification = merge(max_amplification, estimate%amplification, estimate%may_lose_digits)
            if (.not. estimate%taken) return
            do i = 1, size(list)
               error(:, :, i) = estimate_of(rows(i), own, estimate, set%now%rows(list(i))%number)
            end do
         end associate
      end subroutine find_rows_of
   end subroutine rows_at

   !> Estimates the errors of the motion found last, and finds its sensitivities to numbers with tolerances.
   subroutine sample_set(set, always)
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      logical, intent(in) :: always          !< errors are estimated even if no digit of a table is in doubt
      integer :: c

      do c = 1, size(set%list)
         associate (a => set%list(c), own => set%now%parts(c), q => set%now%motions(c))
            call estimate_errors(set%estimators(c), own, a%blocks, a%geometry, a%state, q, always, always, &
               set%now%errors(c))
            if (allocated(own%tolerances)) &
               call find_sensitivities(set%estimators(c), own, a%blocks, a%geometry, a%state, q, set%now%errors(c), &
                  set%now%sensitivities(c))
         end associate
      end do
   end subroutine sample_set

   !> Proves the motion found last, and the step to it. Call it before the rows of any other time are found: the proof
   !> needs the state of the last instant.
   subroutine prove_set(set, bounded)
      type(set_analysis_t), intent(inout) :: set   !< at the instant; `now` gets the proofs
      logical, intent(in) :: bounded         !< bounds of all numbers are found as well
      integer :: c

      do c = 1, size(set%list)
         associate (a => set%list(c))
            call prove_motion(set%provers(c), set%now%parts(c), a%blocks, a%geometry, a%path, a%state, &
               set%now%motions(c), bounded, set%now%proofs(c))
         end associate
      end do
   end subroutine prove_set

   !> Gives the counts of certificates of all instants of the set.
   pure type(certificate_counts_t) function set_certificates(set)
      type(set_analysis_t), intent(in) :: set   !< after its last instant

      set_certificates = set%worst
      if (size(set%list) == 1) set_certificates = set%list(1)%certificate_counts
   end function set_certificates

   !> Gives the diagnostics (any number) after the last instant: BRANCH cards after whose instants no change point was
   !> passed, in their order.
   pure function set_closing_diagnostics(set) result(list)
      type(set_analysis_t), intent(in) :: set   !< after its last instant
      type(diagnostic_t), allocatable :: list(:)
      logical, allocatable :: used(:)
      integer :: c, k, n

      n = 0
      do c = 1, set%now%count
         n = max(n, maxval([0, set%list(c)%branch_requests%cards%card]))
      end do
      allocate (list(n), used(n))
      used = .false.
      do c = 1, set%now%count
         associate (cards => set%list(c)%branch_requests%cards)
            used(cards%card) = used(cards%card) .or. set%list(c)%branch_requests%used
            do k = 1, size(cards)
               list(cards(k)%card) = diagnostic_t(kind=diagnostic_unused, part=c, t=cards(k)%t)
               list(cards(k)%card)%links(1) = cards(k)%link
            end do
         end associate
      end do
      list = pack(list, .not. used)
   end function set_closing_diagnostics
end module set_analysis
