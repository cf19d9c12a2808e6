!> The analysis of a set, each of its independent mechanisms by itself: its own steps and substeps, its own limits,
!> change points and flags. Of the set the worst of them is reported.
module set_analysis
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_newton, is_centre, instant, instant_count, request_measure, &
      measure_line
   use scales, only: characteristic_length
   use plane_vectors, only: pi
   use structure, only: structure_report_t
   use following, only: certificate_counts_t, branch_none, branch_first
   use error_estimate, only: error_estimate_t, estimator_t, make_estimator, estimate_errors, estimate_of
   use significance_check, only: max_amplification, find_amplification
   use link_motion, only: move_links
   use motion_proof, only: motion_prover_t, prove_motion
   use sensitivities, only: find_sensitivities
   use set_motion, only: set_motion_t, new_set_motion, find_row_in_set
   use motion, only: diagnostic_t, new_diagnostic, diagnostic_surplus, diagnostic_unused, diagnostic_turned, motion_t, &
      new_motion, turned_t, flag_inconsistent
   use block_rank, only: surplus_drives
   use separations, only: motions_apart
   use points, only: row_t, find_row, keep_turns
   use assemblies, only: assemblies_t, find_nearest
   use analysis, only: analysis_t, make_analysis, renew_analysis, advance, look_at, come_back, redundancy_error
   use convergence, only: inconsistent_level
   implicit none
   private
   public :: set_analysis_t, make_set_analysis, begin_analysis, foresee_closure, renew_set_analysis, advance_set, &
      accept_state, &
      rows_at, apart_from_first, sample_set, prove_set, set_bounds, set_certificates, &
      set_closing_diagnostics

   !> The angles from which measures go on between the instants of TIME, where extremes are searched for.
   type :: path_t
      real(wp), allocatable :: turned(:, :)                 !< (measures, 0:steps) rad; huge: not known
   end type path_t

   !> A LINE that turns by more than 120 degrees from one instant to the next, but for rounding, may have turned the
   !> other way (rad).
   real(wp), parameter :: largest_turn = 2.0_wp*pi/3.0_wp + 1.0e-9_wp

   type :: set_analysis_t
      type(set_motion_t) :: now                             !< the motion found last, and how far it is known
      type(analysis_t), allocatable :: list(:)              !< (parts)
      ! Of classes, so that the compiler calls what frees one, and does not write it out wherever a set is freed.
      class(estimator_t), allocatable :: estimators(:)      !< (parts)
      class(motion_prover_t), allocatable :: provers(:)     !< (parts)
      type(assemblies_t), allocatable :: assemblies(:)      !< (parts) at the first instant, where they are asked for
      type(certificate_counts_t) :: worst                   !< of all instants, if the set has several parts
      logical, allocatable :: told_drives(:)                !< (parts) surplus drives have been looked for
      logical :: is_in_lane = .false.                       !< a lane has found `now`; the engine is not there
      real(wp) :: growth = 0.0_wp                           !< then: by which roundings grow, whose digits are safe
      type(path_t), allocatable :: paths(:)                 !< (parts)
      logical :: has_turns = .false.                        !< some measure goes on from instant to instant
      integer :: taken = 0                                  !< instants so far, if so
      logical :: told_turn = .false.                        !< it is told that a LINE turns far from instant to instant
   end type set_analysis_t

contains

   !> Ready for the first instant of `m`, whose equations are as many as its unknowns. `findings`: those of its
   !> structure, which give up what the engines need; without them it is found anew. Where all assemblies are asked
   !> for, it begins in the nearest.
   subroutine make_set_analysis(m, s, findings)
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(out) :: s
      type(structure_report_t), intent(inout), optional :: findings

      call new_set_motion(m, s%now, findings)
      call begin_analysis(s, findings)
   end subroutine make_set_analysis

   !> Begins the analysis of the set s%now, which is divided.
   subroutine begin_analysis(s, findings)
      type(set_analysis_t), intent(inout) :: s
      type(structure_report_t), intent(inout), optional :: findings
      integer :: c

      associate (n => s%now%count)
         allocate (s%list(n))
         allocate (s%told_drives(n), source=.false.)
         allocate (estimator_t :: s%estimators(n))
         allocate (motion_prover_t :: s%provers(n))
      end associate
      if (s%now%assemblies) allocate (s%assemblies(s%now%count))
      do c = 1, s%now%count
         if (s%now%assemblies) call find_nearest(s%now%parts(c), instant(s%now, 0), s%assemblies(c))
         if (present(findings)) then
            call make_analysis(s%list(c), s%now%parts(c), findings%structures(c))
         else
            call make_analysis(s%list(c), s%now%parts(c))
         end if
         call make_estimator(s%estimators(c), s%now%parts(c))
      end do
      call begin_paths(s)
   end subroutine begin_analysis

   !> Finds the largest closure error of all instants of `s`, which has none yet, by a run of their own: no number of
   !> the run is known better. Without a closing tolerance, and where equations agree without one, it is 0.
   subroutine foresee_closure(s)
      type(set_analysis_t), intent(inout) :: s
      type(analysis_t) :: trial
      type(motion_t) :: q
      integer :: c, k

      do c = 1, s%now%count
         if (.not. (s%now%closing > 0.0_wp .and. s%list(c)%blocks%redundant > 0)) cycle
         trial = s%list(c)
         q = new_motion(size(s%now%parts(c)%links))
         do k = 0, instant_count(s%now) - 1
            call advance(trial, instant(s%now, k), q)
         end do
         ! That of an instant without a position is larger than the tolerance.
         if (redundancy_error(trial) > inconsistent_level) &
            s%estimators(c)%closure = min(redundancy_error(trial), s%now%closing)
      end do
   end subroutine foresee_closure

   !> Begins the paths of the set: no instant is taken yet.
   subroutine begin_paths(s)
      type(set_analysis_t), intent(inout) :: s
      integer :: c

      s%has_turns = .false.
      s%taken = 0
      s%told_turn = .false.
      if (allocated(s%paths)) deallocate (s%paths)
      allocate (s%paths(s%now%count))
      do c = 1, s%now%count
         associate (own => s%now%parts(c))
            if (.not. allocated(own%measures)) cycle
            s%has_turns = s%has_turns .or. any(own%measures%continues)
            if (any(own%measures%continues) .and. &
                any(own%requests%extremes .and. own%requests%kind == request_measure)) &
               allocate (s%paths(c)%turned(size(own%measures), 0:max(0, s%now%steps)))
         end associate
      end do
   end subroutine begin_paths

   !> Makes `s`, the analysis of a variant of `m` if there is one, ready for the first instant of `m`, as
   !> `make_set_analysis` makes it, with the structure and the memory that it has. `is_done`: these fit, and all of
   !> `findings` is the same; otherwise `s` is of no use.
   subroutine renew_set_analysis(m, s, is_done)
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(inout) :: s
      logical, intent(out) :: is_done        !< the structure is the same; otherwise `s` is of no use

      is_done = allocated(s%list) .and. m%method == method_newton
      if (is_done) is_done = size(s%list) == 1
      if (.not. is_done) return
      associate (own => s%now%parts(1))
         ! These keep numbers of the mechanism.
         is_done = .not. (any(is_centre(own%requests%kind)) .or. allocated(own%tolerances) .or. own%assemblies)
         if (.not. is_done) return
         own%settings_t = m%settings_t
         s%now%settings_t = m%settings_t
         own%links(:) = m%links
         own%points(:) = m%points
         own%pairs(:) = m%pairs
         own%drives(:) = m%drives
         if (allocated(own%measures)) then
            own%measures = m%measures
            own%measures%length = characteristic_length(own)
         end if
         call renew_analysis(s%list(1), own, is_done)
         if (.not. is_done) return
         s%now%motions(1) = new_motion(size(own%links))
         call make_estimator(s%estimators(1), own)
      end associate
      s%told_drives = .false.
      s%is_in_lane = .false.
      s%now%has_begun = .false.
      call begin_paths(s)
   end subroutine renew_set_analysis

   !> Solves instant `t` of the set.
   subroutine advance_set(s, t)
      type(set_analysis_t), intent(inout) :: s
      real(wp), intent(in) :: t              !< time
      integer :: c

      s%is_in_lane = .false.
      do c = 1, size(s%list)
         call advance(s%list(c), t, s%now%motions(c))
         if (s%now%motions(c)%mark == flag_inconsistent) call tell_surplus_drives(s, c)
      end do
      call keep_instant(s)
   end subroutine advance_set

   !> Takes the instant `t` of a set of one mechanism, with the motion that a lane has put into the engine's state.
   subroutine accept_state(s, t, is_taken)
      type(set_analysis_t), intent(inout) :: s
      real(wp), intent(in) :: t              !< time
      logical, intent(out) :: is_taken       !< its numbers are in range, and none of their digits is in doubt
      logical :: is_finite, in_doubt

      associate (a => s%list(1), q => s%now%motions(1))
         q%t = t
         if (allocated(q%diagnostics)) deallocate (q%diagnostics)
         call move_links(a%geometry%chain, a%geometry%chain%wanted, a%state, q, is_finite)
         call find_amplification(s%estimators(1)%sizes, s%now%parts(1), a%blocks, a%geometry, a%state, q, s%growth, &
            in_doubt)
      end associate
      is_taken = is_finite .and. .not. in_doubt
      s%is_in_lane = .true.
      if (is_taken) call keep_instant(s)
   end subroutine accept_state

   !> Keeps what later instants need of the instant at which all motions of the set are, whether its engines or a lane
   !> have found them. A row has no second place for what it keeps from instant to instant. An instant that a lane hands
   !> back comes again from the engine. Times between two instants do not come, nor do a lane's if no row is asked for.
   subroutine keep_instant(s)
      type(set_analysis_t), intent(inout) :: s
      integer :: c

      if (s%has_turns) then
         do c = 1, size(s%list)
            call keep_measures(s, c)
         end do
         s%taken = s%taken + 1
      end if
      if (.not. s%now%has_begun) s%now%first = s%now%motions(:size(s%now%first))
      s%now%has_begun = .true.
      if (size(s%list) > 1) call count_worst_motion(s)
   end subroutine keep_instant

   !> Keeps the angles of measures that go on from instant to instant. Tells once, at the first instant, that a LINE
   !> turns far.
   subroutine keep_measures(s, c)
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c               !< the number of the independent mechanism
      type(turned_t), allocatable :: before(:)
      integer :: i

      associate (own => s%now%parts(c), q => s%now%motions(c))
         if (allocated(q%turned)) before = q%turned
         call keep_turns(own, q)
         if (.not. allocated(q%turned)) return
         if (allocated(s%paths(c)%turned) .and. s%taken <= s%now%steps) &
            s%paths(c)%turned(:, s%taken) = merge(q%turned%angle, huge(1.0_wp), q%turned%is_known)
         if (.not. allocated(before) .or. s%told_turn) return
         do i = 1, size(before)
            if (own%measures(i)%kind /= measure_line) cycle
            if (.not. (before(i)%is_latest .and. q%turned(i)%is_latest)) cycle
            if (abs(q%turned(i)%angle - before(i)%angle) <= largest_turn) cycle
            if (.not. allocated(q%diagnostics)) allocate (q%diagnostics(0))
            q%diagnostics = [q%diagnostics, diagnostic_t(diagnostic_turned, c, measure=i, t=q%t, is_angle=.true., &
               value=abs(q%turned(i)%angle - before(i)%angle))]
            s%told_turn = .true.
            return
         end do
      end associate
   end subroutine keep_measures

   !> Counts the certificate of an instant of several mechanisms: it is that of its worst motion.
   subroutine count_worst_motion(s)
      type(set_analysis_t), intent(inout) :: s

      associate (counts => s%worst, kinds => s%list%branch%kind)
         counts%passed = sum(s%list%certificate_counts%passed)
         if (any(s%now%motions%known < 0)) return
         if (any(kinds == branch_none)) then
            counts%uncertain = counts%uncertain + 1
         else if (all(kinds /= branch_first)) then
            counts%followed = counts%followed + 1
         end if
      end associate
   end subroutine count_worst_motion

   !> Adds to the motion of independent mechanism number `c`, the first whose redundant equations are inconsistent, the
   !> drives of which one may be too many; nothing if there are none.
   subroutine tell_surplus_drives(s, c)
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c               !< its number
      logical :: are(size(s%now%parts(c)%drives))

      if (s%told_drives(c)) return
      s%told_drives(c) = .true.
      are = surplus_drives(s%list(c)%blocks, s%list(c)%geometry, size(are), s%list(c)%state)
      if (.not. any(are)) return
      associate (q => s%now%motions(c))
         if (.not. allocated(q%diagnostics)) allocate (q%diagnostics(0))
         q%diagnostics = [q%diagnostics, new_diagnostic(diagnostic_surplus, are)]
      end associate
   end subroutine tell_surplus_drives

   !> Finds the rows of requests of the set at its last instant, or at a time between the instants. Nothing else
   !> changes. Without `always` nothing is estimated: errors and growth are 0.
   subroutine rows_at(s, list, t, rows, always, error, growth)
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: list(:)         !< the requests, all of one independent mechanism
      real(wp), intent(in) :: t              !< the time, at most that of the last instant
      type(row_t), intent(inout) :: rows(size(list))   !< their `known` is -1 without a motion
      logical, intent(in), optional :: always   !< errors are estimated also where no digit of a table is in doubt
      real(wp), intent(out), optional :: error(3, 0:2, size(list))   !< in the deck's units and rad
      real(wp), intent(out), optional :: growth   !< the factor by which roundings grow
      integer :: i

      if (present(error)) error = 0.0_wp
      if (present(growth)) growth = 0.0_wp
      if (s%is_in_lane .and. .not. abs(t - s%now%motions(1)%t) > 0.0_wp) then
         do i = 1, size(list)
            call find_row_in_set(s%now, list(i), rows(i))
         end do
         if (present(growth)) growth = s%growth
      else
         call find_by_engine()
      end if

   contains

      !> Finds the rows with the engine at the motion of the time.
      subroutine find_by_engine()
         type(motion_t) :: q
         logical :: is_found

         associate (c => s%now%rows(list(1))%part)
            if (abs(t - s%now%motions(c)%t) > 0.0_wp) then
               q = new_motion(size(s%now%parts(c)%links))
               if (allocated(s%now%motions(c)%turned)) q%turned = turned_near(c)
               call look_at(s%list(c), t, q, is_found)
               rows%known = -1
               if (.not. is_found) return
               if (allocated(q%turned)) call keep_turns(s%now%parts(c), q)
               call take(c, q)
            else
               call come_back(s%list(c))
               call take(c, s%now%motions(c))
            end if
         end associate
      end subroutine find_by_engine

      !> Gives the angles of measures at the instant of TIME before `t`.
      function turned_near(c) result(turned)
         integer, intent(in) :: c            !< the number of the independent mechanism
         type(turned_t), allocatable :: turned(:)   !< (measures)
         integer :: k

         turned = s%now%motions(c)%turned
         if (.not. allocated(s%paths(c)%turned)) return
         k = floor((t - s%now%t0)/(s%now%t1 - s%now%t0)*s%now%steps)
         k = max(0, min(k, s%taken - 1, s%now%steps))
         turned%angle = s%paths(c)%turned(:, k)
         turned%is_known = turned%angle < huge(1.0_wp)
      end function turned_near

      !> Takes the rows of the motion `q` of independent mechanism number `c`, and its errors.
      subroutine take(c, q)
         integer, intent(in) :: c            !< its number
         type(motion_t), intent(in) :: q
         type(error_estimate_t) :: estimate
         integer :: i

         associate (own => s%now%parts(c), a => s%list(c))
            do i = 1, size(list)
               call find_row(own, q, own%requests(s%now%rows(list(i))%number), rows(i))
            end do
            if (.not. present(always)) return
            call estimate_errors(s%estimators(c), own, a%blocks, a%geometry, a%state, q, always, .false., estimate)
            if (present(growth)) growth = merge(max_amplification, estimate%growth, estimate%in_doubt)
            if (.not. estimate%taken) return
            do i = 1, size(list)
               error(:, :, i) = estimate_of(rows(i), own, estimate, s%now%rows(list(i))%number)
            end do
         end associate
      end subroutine take
   end subroutine rows_at

   !> Finds how far the last motion of independent mechanism `c` is from its first: see `motions_apart`.
   pure function apart_from_first(s, c) result(apart)
      type(set_analysis_t), intent(in) :: s
      integer, intent(in) :: c               !< its number
      real(wp) :: apart(3)

      apart = motions_apart(s%now%parts(c), s%now%first(c), s%now%motions(c))
   end function apart_from_first

   !> How far the motion found last is known, and its sensitivities to the numbers with tolerances, where there are any.
   !> `always`: also where no digit of a table is in doubt.
   subroutine sample_set(s, always)
      type(set_analysis_t), intent(inout) :: s
      logical, intent(in) :: always          !< also if no digit of a table is in doubt
      integer :: c

      do c = 1, size(s%list)
         associate (a => s%list(c), own => s%now%parts(c), q => s%now%motions(c))
            call estimate_errors(s%estimators(c), own, a%blocks, a%geometry, a%state, q, always, always, &
               s%now%errors(c))
            if (allocated(own%tolerances)) &
               call find_sensitivities(s%estimators(c), own, a%blocks, a%geometry, a%state, q, s%now%errors(c), &
               s%now%sensitivities(c))
         end associate
      end do
   end subroutine sample_set

   !> Gives the counts of certificates of all instants of the set.
   pure type(certificate_counts_t) function set_certificates(s)
      type(set_analysis_t), intent(in) :: s

      set_certificates = s%worst
      if (size(s%list) == 1) set_certificates = s%list(1)%certificate_counts
   end function set_certificates

   !> Proves the motion found last, and the step to it; before any other motion is looked at.
   subroutine prove_set(s, bounded)
      type(set_analysis_t), intent(inout) :: s
      logical, intent(in) :: bounded         !< bounds of all numbers are found as well
      integer :: c

      do c = 1, size(s%list)
         associate (a => s%list(c))
            call prove_motion(s%provers(c), s%now%parts(c), a%blocks, a%geometry, a%path, a%state, s%now%motions(c), &
               bounded, s%now%proofs(c))
         end associate
      end do
   end subroutine prove_set

   !> The largest bounds (0:2) of the errors of any link that are proved, in the characteristic length and rate of its
   !> mechanism.
   pure function set_bounds(s) result(largest)
      type(set_analysis_t), intent(in) :: s
      real(wp) :: largest(0:2)
      integer :: c

      largest = 0.0_wp
      do c = 1, size(s%list)
         if (.not. s%now%proofs(c)%is_proved) cycle
         associate (found => s%now%proofs(c)%largest, sizes => s%estimators(c)%sizes)
            largest = max(largest, max(found(1, :)/sizes%length, found(2, :))/sizes%rate**[0, 1, 2])
         end associate
      end do
   end function set_bounds

   !> Tells what there is to say after the last instant: of BRANCH cards after whose instants no change point was
   !> passed, in their order.
   pure function set_closing_diagnostics(s) result(list)
      type(set_analysis_t), intent(in) :: s
      type(diagnostic_t), allocatable :: list(:)
      logical, allocatable :: used(:)
      integer :: c, k, n

      n = 0
      do c = 1, s%now%count
         n = max(n, maxval([0, s%list(c)%branch_requests%cards%card]))
      end do
      allocate (list(n), used(n))
      used = .false.
      do c = 1, s%now%count
         associate (cards => s%list(c)%branch_requests%cards)
            used(cards%card) = used(cards%card) .or. s%list(c)%branch_requests%used
            do k = 1, size(cards)
               list(cards(k)%card) = diagnostic_t(kind=diagnostic_unused, part=c, t=cards(k)%t)
               list(cards(k)%card)%links(1) = cards(k)%link
            end do
         end associate
      end do
      list = pack(list, .not. used)
   end function set_closing_diagnostics
end module set_analysis
