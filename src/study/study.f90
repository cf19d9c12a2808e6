!> Speed against error (--study): methods, tolerances and predictors tried on a deck, each with the time of a step and
!> the error of the printed rows. With --time, the time alone.
module study
   use, intrinsic :: iso_c_binding, only: c_int, c_null_char
   use, intrinsic :: iso_fortran_env, only: dp => real64, qp => real128, int64
   use kinds, only: wp, wp_name
   use failures, only: failure_t, status_solved, status_flagged
   use mechanism, only: mechanism_t, request_t, method_newton, method_dense, method_matrix, method_words, &
      own_predictor, instant_count, instant
   use independent, only: request_of
   use structure, only: structure_report_t, find_structure, check_structure
   use deck, only: read_deck
   use points, only: is_due
   use columns, only: cell_of, cell_number, of_angle, last_dimension, usual_size
   use rows, only: finished_row_t, find_rows
   use scales, only: characteristic_length, characteristic_rate
   use masked_numbers, only: nothing_known
   use set_motion, only: set_motion_t, new_set_motion, is_flagged
   use csv, only: table_t, new_table
   use set_analysis, only: set_analysis_t, make_set_analysis, advance_set, sample_set
   use text_output, only: output_t, open_output, check_apart, put, flush_output, close_output, abandon_output, &
      replaced
   use number_format, only: whole
   use processes, only: memfd_create
   use system_calls, only: close_descriptor
   implicit none
   private
   public :: run_study, seconds, median

   !> Measurements of a time, of which the median, the least and the greatest are printed.
   integer, parameter :: repeats = 9

   !> One benchmark: a way to solve a set, and its results.
   type :: benchmark_t
      integer :: method = method_newton          !< method_newton, method_dense or method_matrix
      real(dp) :: tolerance = 0.0_dp             !< 0: the limit of rounding
      integer :: predictor = own_predictor       !< order of the predictor, or the method's own
      integer :: missed = 0                      !< instants without a whole motion
      real(dp) :: iterations = 0.0_dp            !< iterations of a step, those of substeps included
      real(dp) :: seconds = 0.0_dp               !< of the whole motion
      real(dp) :: time(repeats) = 0.0_dp         !< of a step without the first instant, microseconds
      !> Of positions, velocities, accelerations, in parts of the largest; below 0: no number was compared.
      real(dp) :: error(0:2) = 0.0_dp
   end type benchmark_t

   !> The numbers with which the rows of a set are compared.
   type :: reference_t
      logical :: is_from_quad = .false.          !< kinmat-quad's table; otherwise the estimates of errors
      integer :: compared = 0                    !< instants
      logical, allocatable :: due(:)             !< (1 + instants) rows are printed there
      type(table_t) :: table                     !< the columns that are compared
      real(qp), allocatable :: value(:, :)       !< (columns, 0:compared - 1) angles as the deck has them
   end type reference_t

   !> One measurement takes at least so many seconds: many ticks of the clock.
   real(dp), parameter :: min_seconds = 0.0005_dp
   !> One measurement takes at most so many seconds, unless it has too few steps then.
   real(dp), parameter :: max_seconds = 0.01_dp
   !> Steps of a measurement at least, if the motion has so many.
   integer, parameter :: min_steps = 4
   !> A benchmark ends early if it misses instants and has taken so many seconds: its time is not printed.
   real(dp), parameter :: max_seconds_missed = 2.0_dp
   !> A study solves this number of links at instants in each benchmark.
   integer, parameter :: max_solved = 1000000
   !> A study compares this number of numbers.
   integer, parameter :: max_compared = 1000000
   !> Methods that solve all equations at once are tried up to this number of equations: their time grows with its cube.
   integer, parameter :: max_equations = 130
   !> The tolerances that are tried; 0: the limit of rounding.
   real(dp), parameter :: tolerances(*) = [1.0e-2_dp, 1.0e-4_dp, 1.0e-6_dp, 1.0e-8_dp, 1.0e-10_dp, 1.0e-12_dp, 0.0_dp]
   !> Microseconds in a second.
   real(dp), parameter :: micro = 1.0e6_dp
   !> Degrees in a radian.
   real(qp), parameter :: radian = 57.29577951308232087679815481410517033_qp

   !> Seconds that the reference of a set may take. Rows that it has written until then are compared.
   integer, parameter :: max_wait = 60
   !> Cards that do not change a row of a link, point or pair, or that a study replaces.
   character(*), parameter :: left_out = 'METHOD|VARY|TOLER|EXTREMES|RANGE|CIRCUITS|ASSEMBLY|PROVE'

contains

   !> Prints the study of a deck, or the time of a step of each of its sets. Errors: the status of the failure, with its
   !> message.
   subroutine run_study(path, output, only_times, status, message)
      character(*), intent(in) :: path       !< the file of the deck; with `only_times` '' is standard input
      character(*), intent(in) :: output     !< the file that is written; '' is standard output
      logical, intent(in) :: only_times      !< only the time of a step of each set
      integer, intent(out) :: status         !< exit status, of `failures`
      character(:), allocatable, intent(out) :: message   !< lines for standard error; '' for none
      type(mechanism_t), allocatable :: sets(:)
      type(structure_report_t), allocatable :: structure_report(:)
      type(failure_t), allocatable :: failure
      type(output_t) :: o
      integer :: i

      status = status_solved
      message = ''
      call read_deck(path, sets, message, failure)
      if (.not. allocated(failure)) call check_structure(sets, structure_report, failure)
      if (.not. allocated(failure)) call open_output(o, output, failure)
      if (.not. allocated(failure)) call check_apart([o], path, failure)

      if (allocated(failure)) then
         call abandon_output(o)
      else
         if (only_times) call put(o, '  SET     STEPS ITERATIONS   MEDIAN US/STEP            MIN            MAX')
         do i = 1, size(sets)
            if (only_times) then
               call write_times(sets(i))
            else
               call study_set(o, path, sets(i), size(sets), structure_report(i)%redundant > 0)
            end if
            call flush_output(o)
            if (o%error /= 0) exit
         end do
         call close_output(o, failure)
      end if

      if (.not. allocated(failure)) return
      status = failure%status
      if (len(message) == 0) message = ' *** '//failure%text

   contains

      !> Prints iterations and time of a step of a set, as the deck has it. If a position is not found, the status
      !> becomes status_flagged, and no time is printed.
      subroutine write_times(m)
         type(mechanism_t), intent(in) :: m
         type(benchmark_t) :: t
         type(reference_t) :: nothing
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
            t%time = [(step_time(m, last, t%seconds), k=1, repeats)]
            write (line(27:), '(3f15.4)') median(t%time), minval(t%time), maxval(t%time)
         end if
         call put(o, trim(line))
      end subroutine write_times
   end subroutine run_study

   !> Prints the study of a set: a row for each benchmark. A set of one instant gets a line that says so.
   subroutine study_set(o, path, m, sets, redundant)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: path       !< the file of the deck
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: sets            !< how many sets the deck has
      logical, intent(in) :: redundant       !< the set has redundant equations
      integer, parameter :: methods(*) = [method_newton, method_dense, method_matrix]
      type(benchmark_t), allocatable :: benchmarks(:)
      type(mechanism_t), allocatable :: tried(:)
      type(reference_t) :: reference
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
      benchmarks = [((benchmark_t(method=methods(i), tolerance=tolerances(k)), k=1, size(tolerances)), &
         i=1, merge(size(methods), 1, .not. redundant .and. equations <= max_equations)), &
         (benchmark_t(predictor=k), k=0, 3)]
      allocate (tried(size(benchmarks)))
      call read_reference(m, last, path, sets, reference)
      do i = 1, size(benchmarks)
         ! The mechanism as the benchmark solves it: of the deck's requests only its rows.
         tried(i) = m
         tried(i)%method = benchmarks(i)%method
         tried(i)%tolerance = real(benchmarks(i)%tolerance, wp)
         tried(i)%predictor = benchmarks(i)%predictor
         tried(i)%assemblies = .false.
         call solve(tried(i), last, benchmarks(i), reference)
      end do
      ! All benchmarks take turns, so that other work of the machine meets all of them.
      do k = 1, repeats
         do i = 1, size(benchmarks)
            if (benchmarks(i)%missed == 0) benchmarks(i)%time(k) = step_time(tried(i), last, benchmarks(i)%seconds)
         end do
      end do

      call put(o, ' '//whole(last)//' OF '//whole(instant_count(m) - 1)//' STEPS, ' &
         //whole(count(.not. m%links%hidden))//' LINKS, '//wp_name)
      associate (instants => whole(count(reference%due(:reference%compared)))//' OF '//whole(last + 1)//' INSTANTS')
         if (reference%is_from_quad) then
            call put(o, ' ERRORS: AGAINST kinmat-quad (REAL128), AT '//instants)
         else
            call put(o, ' ERRORS: THE ESTIMATES OF --errors, AT '//instants &
               //'; kinmat-quad HAS NO ROWS OF THIS SET (make kinds)')
         end if
      end associate

      if (redundant) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: EQUATIONS ARE REDUNDANT')
      else if (equations > max_equations) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: '//whole(equations)//' EQUATIONS')
      end if
      call put(o, '')
      call put(o, repeat(' ', 31)//'TIME OF A STEP, MICROSECONDS'//repeat(' ', 19)//'LARGEST ERROR / LARGEST VALUE')
      call put(o, ' METHOD  PREDICTOR  TOLERANCE    MEDIAN       MIN       MAX   RATIO   ITER   POSITION' &
         //'   VELOCITY   ACCELER.')

      standard = findloc(benchmarks%tolerance, 0.0_dp, dim=1)
      do i = 1, size(benchmarks)
         call write_benchmark(o, benchmarks(i), median(benchmarks(standard)%time))
      end do
   end subroutine study_set

   !> Prints the row of a benchmark: times and iterations, or how many instants are missed; errors, or UNKNOWN.
   subroutine write_benchmark(o, benchmark, unit)
      type(output_t), intent(inout) :: o
      type(benchmark_t), intent(in) :: benchmark     !< solved and measured
      real(dp), intent(in) :: unit           !< microseconds of a step by default; 0: the default misses a position
      character(120) :: line
      integer :: d

      line = ' '//method_words(benchmark%method)
      line(10:) = 'OWN'
      if (benchmark%predictor /= own_predictor) line(10:) = 'ORDER '//whole(benchmark%predictor)
      line(21:) = 'ROUNDING'
      if (benchmark%tolerance > 0.0_dp) write (line(21:29), '(es9.1)') benchmark%tolerance
      if (benchmark%missed > 0) then
         line(32:) = 'NOT SOLVED AT '//whole(benchmark%missed)//' INSTANTS OR MORE'
      else
         write (line(30:), '(3f10.3)') median(benchmark%time), minval(benchmark%time), maxval(benchmark%time)
         if (unit > 0.0_dp) write (line(60:), '(f8.2)') median(benchmark%time)/unit
         write (line(68:), '(f7.2)') benchmark%iterations
      end if

      do d = 0, merge(2, -1, benchmark%missed == 0)
         if (benchmark%error(d) >= 0.0_dp .and. benchmark%error(d) < 1.0e-3_dp*nothing_known) then
            write (line(75 + 11*d:), '(es11.1)') benchmark%error(d)
         else
            line(75 + 11*d:) = '    UNKNOWN'
         end if
      end do
      call put(o, trim(line))
   end subroutine write_benchmark

   !> Solves a set as a benchmark has it, and finds missed instants, iterations and seconds. If the reference has
   !> numbers, the errors of the benchmark are found as well.
   subroutine solve(m, last, benchmark, reference)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last            !< the number of the last instant, counted from 0
      type(benchmark_t), intent(inout) :: benchmark   !< gets the results
      type(reference_t), intent(in) :: reference     !< of the set; a new one compares nothing
      type(set_analysis_t) :: a
      real(dp) :: begun, largest(last_dimension, 0:2), difference(last_dimension, 0:2)
      integer :: k, i, at_first

      ! Errors of numbers that are zero but for rounding, as the acceleration of a link that turns evenly, are in parts
      ! of a characteristic size.
      associate (length => characteristic_length(m), rate => characteristic_rate(m, characteristic_length(m)))
         largest = reshape([((real(usual_size(i, k, length, rate, m%degrees), dp), i=1, last_dimension), k=0, 2)], &
            [last_dimension, 3])
      end associate

      difference = -1.0_dp
      benchmark%seconds = 0.0_dp
      call make_set_analysis(m, a)
      do k = 0, last
         begun = seconds()
         call advance_set(a, instant(m, k))
         benchmark%seconds = benchmark%seconds + (seconds() - begun)
         if (k == 0) at_first = maxval(a%list%iterations)
         if (is_flagged(a%now)) benchmark%missed = benchmark%missed + 1
         if (k < reference%compared) call compare()
         if (benchmark%missed > 0 .and. benchmark%seconds > max_seconds_missed) exit
      end do
      benchmark%iterations = real(maxval(a%list%iterations) - at_first, dp)/max(1, min(k, last))
      do k = 0, 2
         benchmark%error(k) = maxval(difference(:, k)/largest(:, k))
      end do

   contains

      !> Records the largest values of the rows of instant `k`, of each dimension, and their largest differences from
      !> the reference.
      subroutine compare()
         type(finished_row_t), allocatable :: rows(:)
         real(qp) :: off
         integer :: i, kind

         if (.not. reference%due(1 + k)) return
         if (.not. reference%is_from_quad) call sample_set(a, .true.)
         call find_rows(a%now, a%assemblies, k, .true., rows)
         do i = 1, size(reference%table%columns)
            associate (c => reference%table%columns(i), row => rows(reference%table%columns(i)%request))
               if (cell_of(c%row_column_t, row%known, row%state) /= cell_number) cycle
               if (reference%is_from_quad) then
                  off = abs(row%value(c%at(1), c%at(2)) &
                     - reference%value(i, k)/merge(radian, 1.0_qp, c%dimension == of_angle .and. m%degrees))
                  ! The reference has no number there.
                  if (.not. off <= huge(1.0_dp)) cycle
               else
                  off = row%error(c%at(1), c%at(2))
               end if
               kind = c%dimension
               difference(kind, c%order) = max(difference(kind, c%order), real(off, dp))
               largest(kind, c%order) = max(largest(kind, c%order), real(abs(row%value(c%at(1), c%at(2))), dp))
            end associate
         end do
      end subroutine compare
   end subroutine solve

   !> Reads the table of kinmat-quad for the rows of links, points and pairs of a set, as far as the table goes. Without
   !> such a table the program's own estimates of errors stand for the reference.
   subroutine read_reference(m, last, path, sets, reference)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last            !< the number of the last instant, counted from 0
      integer, intent(in) :: sets            !< how many sets the deck has
      character(*), intent(in) :: path       !< the file of the deck
      type(reference_t), intent(out) :: reference    !< gets columns, instants and, of a table, values
      type(structure_report_t) :: structure_report
      type(set_motion_t) :: s
      type(request_t), allocatable :: requests(:)
      real(qp) :: before(1 + size(m%drives))     ! the time, and values of drives
      integer :: i, k, unit, status

      structure_report = find_structure(m)
      call new_set_motion(m, s, structure_report)
      requests = [(request_of(s, i), i=1, size(s%rows))]
      reference%due = [(any([(is_due(s, requests(i), k), i=1, size(requests))]), k=0, last)]
      reference%table = new_table(s, .false.)
      reference%compared = min(last + 1, max(1, max_compared/max(1, size(reference%table%columns))))
      call open_reference(path, whole(m%set_number)//'/'//whole(sets), unit)
      if (unit == 0) return
      allocate (reference%value(size(reference%table%columns), 0:reference%compared - 1))
      read (unit, '()', iostat=status)
      do k = 0, reference%compared - 1
         read (unit, *, iostat=status) before, reference%value(:, k)
         if (status /= 0) exit
         reference%is_from_quad = .true.
      end do
      if (reference%is_from_quad) reference%compared = k
      close (unit)
   end subroutine read_reference

   !> Measures the microseconds of a step, with position, velocity and acceleration, without the first instant.
   real(dp) function step_time(m, last, whole_time) result(time)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: last            !< the number of the last instant, counted from 0, 1 or more
      real(dp), intent(in) :: whole_time     !< seconds that all steps take, about
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

   !> Reads the clock, in seconds from some instant.
   real(dp) function seconds()
      integer(int64) :: ticks, per_second

      call system_clock(ticks, per_second)
      seconds = real(ticks, dp)/real(per_second, dp)
   end function seconds

   !> Gives the median of a sample; of an even number of values the mean of both in the middle.
   pure real(dp) function median(values)
      real(dp), intent(in) :: values(:)      !< (1 or more) in any order
      integer :: twice(size(values)), i               ! twice the number of values that are no larger

      twice = [(2*count(values <= values(i)), i=1, size(values))]
      median = 0.5_dp*(minval(values, mask=twice >= size(values)) + minval(values, mask=twice > size(values)))
   end function median

   !> Lets kinmat-quad solve one set of a deck, and opens its table. There is no table without a kinmat-quad in the
   !> directory of this program or in PATH, or if that computes in another kind of reals.
   subroutine open_reference(path, set, unit)
      character(*), intent(in) :: path       !< the file of the deck
      character(*), intent(in) :: set        !< K/N: set K of N sets
      integer, intent(out) :: unit           !< unit of the table, which the caller closes; 0: there is none
      character(:), allocatable :: rows
      character(4096) :: this
      integer(c_int) :: descriptor
      integer :: status
      logical :: closed

      unit = 0
      ! A file without a name, in memory, which the programs that are called have open, too.
      descriptor = memfd_create('rows'//c_null_char, 0_c_int)
      if (descriptor < 0) return
      rows = '/dev/fd/'//whole(descriptor)
      call get_command_argument(0, this)
      this = this(:index(this, '/', back=.true.))//'kinmat-quad'
      call execute_command_line('exec 2>/dev/null; p='//shell_word(trim(this))//'; [ -x "$p" ] || p=kinmat-quad; ' &
         //'case $("$p" --version) in *REAL128) ;; *) exit 1;; esac; ' &
         //'awk ''!/^[*]/ { kept = toupper($0) !~ /^('//left_out//')/ } kept'' '//shell_word(path) &
         //' | timeout '//whole(max_wait)//' "$p" --no-listing --table '//rows//' --sets '//set, exitstat=status)
      if (status /= 1) open (newunit=unit, file=rows, action='read', iostat=status)
      if (status /= 0) unit = 0
      closed = close_descriptor(descriptor)
   end subroutine open_reference

   !> Gives a text as one word of a shell's command.
   pure function shell_word(text) result(word)
      character(*), intent(in) :: text       !< any characters
      character(:), allocatable :: word

      word = ''''//replaced(text, '''', ['''\'''''])//''''
   end function shell_word
end module study
