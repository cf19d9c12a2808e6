!> Speed against error (--study): methods, tolerances and predictors tried on a deck, each with the time of a step and
!> the error of the printed rows. The time alone (--time).
module study
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128, int64
   use kinds, only: wp, wp_name
   use failures, only: failure_t, status_solved, status_flagged
   use mechanism, only: mechanism_t, request_t, request_pair, method_newton, method_dense, method_matrix, &
      method_words, own_predictor, instant_count, instant
   use independent, only: request_of
   use structure, only: findings_t, check_structure
   use deck, only: read_deck
   use points, only: row_t, has_number, is_due
   use scales, only: characteristic_length, characteristic_rate
   use known_digits, only: nothing_known
   use set_motion, only: is_flagged, find_row_in_set, error_in_set
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set
   use text_output, only: output_t, open_output, check_apart, put, flush_output, close_output, abandon_output, &
      has_failed
   use numerals, only: whole
   use processes, only: memfd_create
   use system_calls, only: close_descriptor
   use progress, only: progress_t, start_progress, show_progress, end_progress
   implicit none
   private
   public :: run_study, seconds, median

   !> Measurements of a time.
   integer, parameter :: repeats = 9
   !> One way to solve a set, and what came of it.
   type :: trial_t
      integer :: method = method_newton
      real(dp) :: tolerance = 0.0_dp             !< 0: the limit of rounding
      integer :: predictor = own_predictor       !< its order, or the method's own
      integer :: missed = 0                      !< instants without a whole motion
      real(dp) :: iterations = 0.0_dp            !< a step, those of substeps included
      real(dp) :: seconds = 0.0_dp               !< of the whole motion
      real(dp) :: time(repeats) = 0.0_dp         !< of a step without the first instant, microseconds
      real(dp) :: error(0:2) = 0.0_dp            !< of positions, velocities, accelerations, in parts of the largest
   end type trial_t

   !> What the rows of a set are compared with.
   type :: truth_t
      logical :: is_reference = .false.          !< kinmat-quad's rows; otherwise the estimates of errors
      integer :: compared = 0                    !< instants
      real(qp), allocatable :: value(:, :, :)    !< (3, 0:2, rows of all instants)
   end type truth_t

   !> One measurement takes at least so many seconds: many ticks of the clock; and at most, as far as few steps let it.
   real(dp), parameter :: min_seconds = 0.0005_dp, max_seconds = 0.01_dp
   integer, parameter :: min_steps = 4
   !> A trial ends early if it misses instants and has taken so many seconds.
   real(dp), parameter :: long = 2.0_dp
   !> A study solves this number of links at instants in each trial, and compares this number of rows.
   integer, parameter :: max_solved = 1000000, max_rows = 100000
   !> Methods that solve all equations at once are tried up to this number of equations.
   integer, parameter :: max_equations = 130
   real(dp), parameter :: tolerances(*) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-6_dp, 1.0e-8_dp, 1.0e-10_dp, 1.0e-12_dp, 0.0_dp]
   real(dp), parameter :: micro = 1.0e6_dp
   real(qp), parameter :: radian = 57.29577951308232087679815481410517033_qp

   !> Stands for a number that the reference does not have.
   real(qp), parameter :: no_number = real(huge(1.0_dp), qp)
   !> A row has nine numbers of at most 44 characters, and less than a hundred others.
   integer, parameter :: row_length = 1024
   !> Seconds that the reference may take. What it has written until then is compared.
   integer, parameter :: patience = 60
   !> Cards that do not change a row of a link, point or pair, or that a study replaces.
   character(*), parameter :: left_out = 'METHOD|VARY|TOLER|EXTREMES|RANGE|CIRCUITS|ASSEMBLY|PROVE'

contains

   !> Prints the study of the deck in the file `path` to `output`, '' for standard output; with `only_times` the time of
   !> a step of each set. Then the deck may be '', standard input. `quiet`: without progress on a terminal. `message`:
   !> lines for standard error, '' for none.
   subroutine run_study(path, output, only_times, quiet, status, message)
      character(*), intent(in) :: path, output
      logical, intent(in) :: only_times, quiet
      integer, intent(out) :: status
      character(:), allocatable, intent(out) :: message
      type(mechanism_t), allocatable :: sets(:)
      type(findings_t), allocatable :: findings(:)
      type(failure_t), allocatable :: failure
      type(output_t) :: o
      type(progress_t) :: progress
      integer :: reference, i       ! the unit of rows in real128; 0: there are none

      status = status_solved
      message = ''
      call start_progress(progress, .not. quiet, .false.)
      call read_deck(path, sets, message, failure)
      if (.not. allocated(failure)) call check_structure(sets, findings, failure)
      if (.not. allocated(failure)) call open_output(o, output, failure)
      if (.not. allocated(failure)) call check_apart([o], path, failure)
      if (allocated(failure)) then
         call abandon_output(o)
      else
         if (only_times) call put(o, '  SET     STEPS ITERATIONS   MEDIAN US/STEP            MIN            MAX')
         reference = 0
         if (.not. only_times) call open_reference(path, reference)
         do i = 1, size(sets)
            if (only_times) then
               call put_times(sets(i))
            else
               call study_set(sets(i), findings(i)%redundant > 0)
            end if
            call end_progress(progress)
            call flush_output(o)
            if (has_failed(o)) exit
         end do
         if (reference /= 0) close (reference)
         call close_output(o, failure)
      end if
      if (.not. allocated(failure)) return
      status = failure%status
      if (len(message) == 0) message = ' *** '//failure%text

   contains

      !> Prints iterations and time of a step of `m`, as the deck asks for it. `status`: status_flagged if a position is
      !> not found.
      subroutine put_times(m)
         type(mechanism_t), intent(in) :: m
         type(trial_t) :: t
         type(truth_t) :: nothing
         character(80) :: line
         integer :: k, last

         last = instant_count(m) - 1
         call solve(m, last, t, nothing)
         write (line, '(i5, i10, f11.2)') m%set_number, last, t%iterations
         if (t%missed > 0) then
            line(27:) = '   NOT TIMED: A POSITION IS NOT FOUND'
            status = status_flagged
         else if (last == 0) then
            line(27:) = '   NOT TIMED: ONE INSTANT'
         else
            do k = 1, repeats
               call show_progress(progress, 'MEASUREMENT', k, repeats)
               t%time(k) = step_time(m, last, t%seconds)
            end do
            write (line(27:), '(3f15.4)') median(t%time), minval(t%time), maxval(t%time)
         end if
         call put(o, trim(line))
      end subroutine put_times

      !> Prints the study of `m`. `redundant`: it has too many equations.
      subroutine study_set(m, redundant)
         type(mechanism_t), intent(in) :: m
         logical, intent(in) :: redundant
         integer, parameter :: methods(*) = [method_newton, method_dense, method_matrix]
         type(trial_t), allocatable :: trials(:)
         type(mechanism_t), allocatable :: tried(:)
         type(truth_t) :: truth
         integer :: i, k, last, standard, equations

         if (m%set_number > 1) call put(o, '')
         call put(o, ' SPEED AGAINST ERROR   SET '//whole(m%set_number)//'   '//trim(m%title))
         last = min(instant_count(m) - 1, max(8, max_solved/size(m%links)))
         if (last == 0) then
            call put(o, ' NOT STUDIED: ONE INSTANT')
            return
         end if
         ! Each method with each tolerance, then the predictors of METHOD NEWTON. The first one without a tolerance is
         ! the default.
         equations = 3*count(.not. m%links%ground)
         trials = [((trial_t(method=methods(i), tolerance=tolerances(k)), k=1, size(tolerances)), &
            i=1, merge(size(methods), 1, .not. redundant .and. equations <= max_equations)), &
            (trial_t(predictor=k), k=0, 3)]
         allocate (tried(size(trials)))
         call read_truth(m, last, reference, truth)
         do i = 1, size(trials)
            call show_progress(progress, 'TRIAL', i, size(trials))
            ! The mechanism as the trial solves it, with no question of the deck but its rows.
            tried(i) = m
            tried(i)%method = trials(i)%method
            tried(i)%tolerance = real(trials(i)%tolerance, wp)
            tried(i)%predictor = trials(i)%predictor
            tried(i)%assemblies = .false.
            call solve(tried(i), last, trials(i), truth)
         end do
         ! All trials take turns, so that what else the machine does meets all of them.
         do k = 1, repeats
            call show_progress(progress, 'MEASUREMENT', k, repeats)
            do i = 1, size(trials)
               if (trials(i)%missed == 0) trials(i)%time(k) = step_time(tried(i), last, trials(i)%seconds)
            end do
         end do

         call put(o, ' '//whole(last)//' OF '//whole(instant_count(m) - 1)//' STEPS, '//whole(size(m%links)) &
            //' LINKS, '//wp_name)
         if (truth%is_reference) then
            call put(o, ' ERRORS: AGAINST kinmat-quad (REAL128), AT '//whole(truth%compared)//' OF '//whole(last + 1) &
               //' INSTANTS')
         else
            call put(o, ' ERRORS: THE ESTIMATES OF --errors, AT '//whole(truth%compared)//' OF '//whole(last + 1) &
               //' INSTANTS; kinmat-quad HAS NO ROWS OF THIS SET (make kinds)')
         end if
         if (redundant) then
            call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: EQUATIONS ARE REDUNDANT')
         else if (equations > max_equations) then
            call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: '//whole(equations)//' EQUATIONS')
         end if
         call put(o, '')
         call put(o, repeat(' ', 31)//'TIME OF A STEP, MICROSECONDS'//repeat(' ', 19)//'LARGEST ERROR / LARGEST VALUE')
         call put(o, ' METHOD  PREDICTOR  TOLERANCE    MEDIAN       MIN       MAX   RATIO   ITER   POSITION' &
            //'   VELOCITY   ACCELER.')
         standard = findloc(trials%tolerance, 0.0_dp, dim=1)
         do i = 1, size(trials)
            call put_trial(trials(i), median(trials(standard)%time))
         end do
      end subroutine study_set

      !> Prints the row of trial `t`. `unit`: microseconds of the default, 0 if that does not find every position.
      subroutine put_trial(t, unit)
         type(trial_t), intent(in) :: t
         real(dp), intent(in) :: unit
         character(120) :: line
         integer :: d

         line = ' '//method_words(t%method)
         line(10:) = 'OWN'
         if (t%predictor /= own_predictor) line(10:) = 'ORDER '//whole(t%predictor)
         line(21:) = 'ROUNDING'
         if (t%tolerance > 0.0_dp) write (line(21:29), '(es9.1)') t%tolerance
         if (t%missed > 0) then
            line(32:) = 'NOT SOLVED AT '//whole(t%missed)//' INSTANTS OR MORE'
         else
            write (line(30:), '(3f10.3)') median(t%time), minval(t%time), maxval(t%time)
            if (unit > 0.0_dp) write (line(60:), '(f8.2)') median(t%time)/unit
            write (line(68:), '(f7.2)') t%iterations
         end if
         do d = 0, merge(2, -1, t%missed == 0)
            if (t%error(d) < 1.0e-3_dp*nothing_known) then
               write (line(75 + 11*d:), '(es11.1)') t%error(d)
            else
               line(75 + 11*d:) = '    UNKNOWN'
            end if
         end do
         call put(o, trim(line))
      end subroutine put_trial
   end subroutine run_study

   !> Solves `m` at instants 0 to `last`. Fills missed instants, iterations, seconds and errors of `t`; errors only if
   !> something is compared with the `truth`.
   subroutine solve(m, last, t, truth)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last
      type(trial_t), intent(inout) :: t
      type(truth_t), intent(in) :: truth
      type(set_analysis_t) :: a
      real(dp) :: begun, largest(2, 0:2), difference(2, 0:2)
      integer :: k, at_first, row

      ! Of what is zero but for rounding, as the acceleration of a link that turns evenly, the unit is characteristic.
      associate (length => characteristic_length(m))
         largest = reshape([(real([length, 1.0_wp]*characteristic_rate(m, length)**k, dp), k=0, 2)], [2, 3])
      end associate
      difference = 0.0_dp
      row = 0
      t%seconds = 0.0_dp
      call make_set_analysis(m, a)
      do k = 0, last
         begun = seconds()
         call advance_set(a, instant(m, k))
         t%seconds = t%seconds + (seconds() - begun)
         if (k == 0) at_first = maxval(a%list%iterations)
         if (is_flagged(a%now)) t%missed = t%missed + 1
         if (k < truth%compared) call compare()
         if (t%missed > 0 .and. t%seconds > long) exit
      end do
      t%iterations = real(maxval(a%list%iterations) - at_first, dp)/max(1, min(k, last))
      do k = 0, 2
         t%error(k) = maxval(difference(:, k)/largest(:, k))
      end do

   contains

      !> Notes the largest values of the rows of this instant and their largest differences from the truth: of lengths
      !> and of angles.
      subroutine compare()
         type(row_t) :: r
         real(dp) :: off(3, 0:2)
         integer :: i, c, d, kind

         if (.not. truth%is_reference) call sample_set(a, .true., .false.)
         do i = 1, size(a%now%rows)
            if (.not. is_compared(a, i, k)) cycle
            row = row + 1
            call find_row_in_set(a%now, i, r)
            if (truth%is_reference) off = real(abs(real(r%value, qp) - truth%value(:, :, row)), dp)
            if (.not. truth%is_reference) off = real(error_in_set(a%now, i), dp)
            do d = 0, 2
               do c = 1, 3
                  if (.not. has_number(r, c, d)) cycle
                  if (truth%is_reference .and. off(c, d) >= 0.5_dp*no_number) cycle
                  kind = merge(2, 1, c == 3 .or. r%angular)
                  difference(kind, d) = max(difference(kind, d), off(c, d))
                  largest(kind, d) = max(largest(kind, d), real(abs(r%value(c, d)), dp))
               end do
            end do
         end do
      end subroutine compare
   end subroutine solve

   !> Whether row number `i` of the set in `a` is compared at instant number `k`: links, points and pairs are.
   logical function is_compared(a, i, k)
      type(set_analysis_t), intent(in) :: a
      integer, intent(in) :: i, k
      type(request_t) :: request

      request = request_of(a%now, i)
      is_compared = request%kind <= request_pair .and. is_due(a%now, request, k)
   end function is_compared

   !> Reads what the rows of `m` at instants 0 to `last` are compared with: the rows of the unit `reference` as far as
   !> they go. Without a reference, or if it has no row of this set, the program's own estimates of errors stand for
   !> them.
   subroutine read_truth(m, last, reference, truth)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last, reference
      type(truth_t), intent(out) :: truth
      type(set_analysis_t) :: a
      type(row_t) :: r
      logical :: is_there
      integer :: i, k, count

      call make_set_analysis(m, a)
      if (reference /= 0) allocate (truth%value(3, 0:2, max_rows))
      count = 0
      instants: do k = 0, merge(last, -1, reference /= 0)
         if (count + size(a%now%rows) > max_rows) exit
         do i = 1, size(a%now%rows)
            if (.not. is_compared(a, i, k)) cycle
            count = count + 1
            call find_row_in_set(a%now, i, r)
            call read_reference(reference, [m%set_number, k], r%name, truth%value(:, :, count), is_there)
            if (.not. is_there) exit instants
            if (.not. m%degrees) cycle
            associate (value => truth%value(merge(1, 3, r%angular):, :, count))
               where (value < no_number) value = value/radian
            end associate
         end do
         truth%compared = k + 1
      end do instants
      truth%is_reference = truth%compared > 0
      if (.not. truth%is_reference) truth%compared = min(last + 1, max(1, max_rows/max(1, size(a%now%rows))))
   end subroutine read_truth

   !> Returns microseconds of a step of `m`, position, velocity and acceleration at instants 1 to `last`, without the
   !> first instant. `whole_time`: seconds that all steps take, about.
   real(dp) function step_time(m, last, whole_time) result(time)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last
      real(dp), intent(in) :: whole_time
      type(set_analysis_t) :: a
      real(dp) :: begun
      real(wp) :: instants(0:last)
      integer :: i, k, passes, steps

      instants = [(instant(m, k), k=0, last)]
      steps = last
      if (whole_time > max_seconds) steps = min(last, max(min_steps, int(last*max_seconds/whole_time)))
      passes = max(1, min(1000, ceiling(min_seconds/max(whole_time, 1.0e-6_dp))))
      time = 0.0_dp
      do i = 1, passes
         call make_set_analysis(m, a)
         call advance_set(a, instants(0))
         begun = seconds()
         do k = 1, steps
            call advance_set(a, instants(k))
         end do
         time = time + (seconds() - begun)
      end do
      time = micro*time/(real(passes, dp)*steps)
   end function step_time

   !> Returns the clock (s), from some instant.
   real(dp) function seconds()
      integer(int64) :: ticks, per_second

      call system_clock(ticks, per_second)
      seconds = real(ticks, dp)/real(per_second, dp)
   end function seconds

   !> Returns the median of the sample `x`, which has one value at least.
   pure real(dp) function median(x)
      real(dp), intent(in) :: x(:)
      integer :: twice(size(x)), i               ! twice the number of values that are no larger

      twice = [(2*count(x <= x(i)), i=1, size(x))]
      median = 0.5_dp*(minval(x, mask=twice >= size(x)) + minval(x, mask=twice > size(x)))
   end function median

   !> Lets kinmat-quad solve the deck in the file `path`: its CSV is open at `unit`. That is 0 if it stands neither
   !> beside this program nor in PATH, or if it computes in another kind of reals.
   subroutine open_reference(path, unit)
      character(*), intent(in) :: path
      integer, intent(out) :: unit
      character(:), allocatable :: rows, this
      integer(c_int) :: descriptor
      integer :: status, length
      logical :: closed

      unit = 0
      ! A file without a name, in memory, which the programs that are called have open, too.
      descriptor = memfd_create('rows'//c_null_char, 0_c_int)
      if (descriptor < 0) return
      rows = '/dev/fd/'//whole(descriptor)
      call get_command_argument(0, length=length)
      allocate (character(length) :: this)
      if (length > 0) call get_command_argument(0, this)
      this = this(:index(this, '/', back=.true.))//'kinmat-quad'
      call execute_command_line('exec 2>/dev/null; p='//shell_word(this)//'; [ -x "$p" ] || p=kinmat-quad; ' &
         //'case $("$p" --version) in *REAL128) ;; *) exit 1;; esac; ' &
         //'awk ''!/^[*]/ { kept = toupper($0) !~ /^('//left_out//')/ } kept'' '//shell_word(path) &
         //' | timeout '//whole(patience)//' "$p" --no-listing --csv '//rows, exitstat=status)
      if (status /= 1) open (newunit=unit, file=rows, action='read', iostat=status)
      if (status /= 0) unit = 0
      closed = close_descriptor(descriptor)
   end subroutine open_reference

   !> Reads from `unit` the next row of a link, point or pair from set and instant number `place` (2) on. `value`
   !> (3, 0:2): its numbers, angles as the deck has them; `no_number` for one that is missing. `is_there`: there is one,
   !> it is of that set and instant, and has this `name`.
   subroutine read_reference(unit, place, name, value, is_there)
      integer, intent(in) :: unit, place(2)
      character(*), intent(in) :: name
      real(qp), intent(out) :: value(3, 0:2)
      logical, intent(out) :: is_there
      character(row_length) :: row
      character(len(name)) :: words(3)        ! the beginning of the time, the kind of row, and its name
      integer :: here(2), status, comma, i

      value = no_number
      is_there = .false.
      do
         read (unit, '(a)', iostat=status) row
         if (status /= 0) return
         read (row, *, iostat=status) here, words
         if (status /= 0 .or. here(1) < place(1) .or. (here(1) == place(1) .and. here(2) < place(2))) cycle
         if (any(words(2) == ['LINK ', 'POINT', 'PAIR '])) exit
      end do
      is_there = all(here == place) .and. words(3) == name
      ! The nine numbers stand before the mark, which is the last cell. An empty cell leaves its number as it is.
      comma = len_trim(row) + 1
      do i = 1, 10
         comma = index(row(:comma - 1), ',', back=.true.)
      end do
      read (row(comma + 1:), *, iostat=status) value
      if (status /= 0) value = no_number
   end subroutine read_reference

   !> `text` as one word of a shell's command.
   pure function shell_word(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = ''''
      do i = 1, len(text)
         word = word//text(i:i)
         if (text(i:i) == '''') word = word//'\'''''
      end do
      word = word//''''
   end function shell_word
end module study
