!> The text of a study: its head, the table of its trials with times and errors, and the
!> cheapest of them.
module study_table
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use mechanism, only: mechanism_t, instant_count, method_newton, method_dense, own_predictor
   use text_output, only: output_t, put
   use numerals, only: whole
   use trials, only: median, trial_t, kind_single, kind_double, kind_quad
   use true_errors, only: errors_t, truth_t
   use study_plan, only: plan_t, section_kinds
   implicit none
   private
   public :: row_t, new_rows, put_head, put_refusal, put_rows, error_text

   !> A trial and what came of it.
   type :: row_t
      type(trial_t) :: trial
      real(dp), allocatable :: time(:)           !< seconds a step; (0) where it is not timed
      real(dp) :: iterations = 0.0_dp
      type(errors_t) :: errors
   end type row_t

   real(dp), parameter :: micro = 1.0e6_dp
   !> What the truth can tell at best, and how far below an error its own must be.
   real(dp), parameter :: best = 1.0e-30_dp, margin = 10.0_dp
   character(*), parameter :: legend(*) = [character(110) :: '', &
      ' Errors: of all links at all steps compared, the largest and the root of the mean square, against the truth', &
      ' at the same instants; in the characteristic length and rate or, where the largest value is more, relative', &
      ' to it. The truth reads the deck''s decimals with 34 digits: that others round them is a part of their', &
      ' errors. MEDIAN, MIN, MAX: time of a step with velocities and accelerations of all links, the first instant', &
      ' left out, of 9 measurements. RATIO: to BLOCKS with its OWN predictor, to the limit of ROUNDING: the default.', &
      ' ITER: iterations a step. ORDER of the predictor: 0 the position before, 1 with its velocity, 2 with its', &
      ' acceleration, 3 with the change of it; OWN: 2 or, BLOCKS, from three instants. SP, QP: the numbers that', &
      ' kinmat-single and kinmat-quad write. MATRIX: reference angles chosen at each step; FIXED: at the first.', &
      ' <: below what the truth can tell.']

contains

   !> The head of the study of `m` as `p` plans it.
   subroutine put_head(o, m, p, truth)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(plan_t), intent(in) :: p
      type(truth_t), intent(in) :: truth
      integer :: i, known

      known = count(truth%motion%known == 2)
      call put(o, ' '//whole(p%last)//' STEPS, '//whole(size(m%links))//' LINKS; THE TRUTH: kinmat-quad (REAL128), ' &
         //whole(known)//' OF '//whole(size(truth%motion%known))//' INSTANTS COMPARED')
      if (p%last < p%steps .or. (p%steps == 0 .and. p%last < instant_count(m) - 1)) call put(o, &
         ' SHORTENED: THE FIRST '//whole(p%last)//' STEPS OF '//whole(max(p%steps, instant_count(m) - 1)))
      if (p%steps > 0 .and. size(m%at) > 0) call put(o, ' THE INSTANTS OF AT CARDS ARE LEFT OUT')
      if (p%redundant) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: EQUATIONS ARE REDUNDANT')
      else if (.not. p%has_dense) then
         call put(o, ' METHODS DENSE AND MATRIX ARE NOT TRIED: '//whole(p%equations)//' UNKNOWNS AT ONCE')
      end if
      if (known == 0) call put(o, ' NOT STUDIED: NO MOTION IS FOUND IN REAL128')
      do i = 1, merge(size(legend), 0, known > 0)
         call put(o, trim(legend(i)))
      end do
   end subroutine put_head

   !> Why the set of `p` is passed over.
   subroutine put_refusal(o, p)
      type(output_t), intent(inout) :: o
      type(plan_t), intent(in) :: p

      if (p%last == 0) then
         call put(o, ' NOT STUDIED: THE DECK ASKS FOR ONE INSTANT, AND NO STEP LEADS TO IT')
      else
         call put(o, ' NOT STUDIED: A BLOCK OF '//whole(p%widest) &
            //' UNKNOWNS IS TOO WIDE FOR kinmat-quad, WHICH KNOWS THE TRUTH')
      end if
   end subroutine put_refusal

   !> Rows of the `trials`, of which nothing is known yet.
   pure function new_rows(trials) result(rows)
      type(trial_t), intent(in) :: trials(:)
      ! Allocated, since gfortran 12 gives an automatic result no default values.
      type(row_t), allocatable :: rows(:)
      integer :: i

      allocate (rows(size(trials)))
      do i = 1, size(trials)
         rows(i)%trial = trials(i)
         allocate (rows(i)%time(0))
      end do
   end function new_rows

   !> The table, section by section, and the cheapest trials.
   subroutine put_rows(o, p, rows)
      type(output_t), intent(inout) :: o
      type(plan_t), intent(in) :: p
      type(row_t), intent(in) :: rows(:)
      character(*), parameter :: titles(4) = [character(20) :: 'TOLERANCE', 'NUMBER OF STEPS', 'PREDICTOR', 'PRECISION']
      real(dp) :: finest(0:2)
      integer :: i, section, default

      ! By what trials in real128, to the limit of rounding, differ from the truth its own error is known.
      finest = best
      do i = 1, size(rows)
         if (rows(i)%trial%kind == kind_quad .and. .not. rows(i)%trial%tolerance > 0.0_dp) &
            finest = max(finest, margin*rows(i)%errors%largest)
      end do
      ! The first row in double precision of the last section is the default.
      default = findloc(rows%trial%section == section_kinds .and. rows%trial%kind == kind_double, .true., 1)
      associate (standard => rows(default)%time)
         do section = 1, size(titles)
            if (.not. any(rows%trial%section == section)) cycle
            call put(o, '')
            call put(o, ' '//whole(section)//'  '//trim(titles(section)))
            call put(o, '')
            call put(o, ' METHOD       ORDER TOLERANCE STEPS  MEDIAN     MIN     MAX  RATIO  ITER' &
               //'        POSITION        VELOCITY    ACCELERATION')
            call put(o, repeat(' ', 36)//'US/STEP'//repeat(' ', 29)//repeat('     MAX     RMS', 3))
            do i = 1, size(rows)
               if (rows(i)%trial%section == section) call put_row(o, rows(i), standard, finest)
            end do
         end do
         call put_cheapest(o, rows, p%last, standard)
         if (p%finer > 1) call put_cheapest(o, rows, p%last*p%finer, standard)
      end associate
   end subroutine put_rows

   !> METHOD, ORDER, TOLERANCE of a trial, in 28 columns.
   pure function trial_text(t) result(text)
      type(trial_t), intent(in) :: t
      character(28) :: text
      character(12) :: method

      if (t%method == method_newton) then
         method = 'BLOCKS'
      else if (t%method == method_dense) then
         method = 'DENSE'
      else
         method = 'MATRIX'
         if (t%keeps) method = 'MATRIX FIXED'
      end if
      if (t%kind /= kind_double) method = trim(method)//merge(' SP', ' QP', t%kind == kind_single)
      write (text, '(a12, i6, es10.0)') method, t%predictor, t%tolerance
      if (t%predictor == own_predictor) text(13:18) = '   OWN'
      if (.not. t%tolerance > 0.0_dp) text(19:28) = '  ROUNDING'
   end function trial_text

   !> One row; `standard` (repeats): seconds a step of the default; `finest` (0:2): the smallest error that the truth
   !> can tell.
   subroutine put_row(o, r, standard, finest)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: r
      real(dp), intent(in) :: standard(:), finest(0:2)
      character(120) :: line
      integer :: k

      write (line, '(1x, a28, i6)') trial_text(r%trial), r%trial%last
      if (size(r%time) > 0) then
         line(36:) = time_text(median(r%time))//time_text(minval(r%time))//time_text(maxval(r%time)) &
            //ratio_text(ratio_of(r%time, standard))
      else
         line(36:) = repeat('       -', 3)//'      -'
      end if
      write (line(67:72), '(f6.1)') min(r%iterations, 9999.0_dp)
      if (r%errors%compared > 0) then
         do k = 0, 2
            line(73 + 16*k:) = error_text(r%errors%largest(k), finest(k))//error_text(r%errors%rms(k), finest(k))
         end do
      else if (r%errors%unsolved + r%errors%no_velocity == 0) then
         line(67:) = repeat(' ', 8)//'REFUSES NUMBERS OF THE DECK'
      else
         line(73:) = '  DID NOT CONVERGE AT ANY INSTANT'
         if (r%errors%no_velocity > 0) line(73:) = '  NO VELOCITIES AT ANY INSTANT'
      end if
      call put(o, trim(line))
      call put_failures(o, r%errors)
   end subroutine put_row

   !> Where a trial has failed, and how.
   subroutine put_failures(o, e)
      type(output_t), intent(inout) :: o
      type(errors_t), intent(in) :: e
      character(:), allocatable :: of_all

      of_all = ' OF '//whole(e%compared + e%unsolved + e%no_velocity)//' INSTANTS'
      if (e%compared > 0 .and. e%unsolved > 0) call put(o, '    DID NOT CONVERGE AT '//whole(e%unsolved)//of_all)
      if (e%compared > 0 .and. e%no_velocity > 0) call put(o, '    NO VELOCITIES AT '//whole(e%no_velocity)//of_all)
      if (e%other_assembly > 0) call put(o, &
         '    CONVERGED TO ANOTHER POSITION, WHICH CLOSES AS WELL, AT '//whole(e%other_assembly)//of_all)
   end subroutine put_failures

   !> Measurements that alternate are compared one by one: what disturbs the machine disturbs both.
   pure real(dp) function ratio_of(time, standard) result(ratio)
      real(dp), intent(in) :: time(:), standard(:)

      if (size(time) == size(standard)) then
         ratio = median(time/standard)
      else
         ratio = median(time)/max(median(standard), tiny(1.0_dp))
      end if
   end function ratio_of

   !> Seconds as microseconds.
   pure function time_text(seconds) result(text)
      real(dp), intent(in) :: seconds
      character(8) :: text

      if (seconds*micro < 99.995_dp) then
         write (text, '(f8.2)') seconds*micro
      else if (seconds*micro < 99999.95_dp) then
         write (text, '(f8.1)') seconds*micro
      else
         write (text, '(es8.1)') seconds*micro
      end if
   end function time_text

   !> A ratio of times, in 7 columns.
   pure function ratio_text(ratio) result(text)
      real(dp), intent(in) :: ratio
      character(7) :: text

      if (ratio < 99.995_dp) then
         write (text, '(f7.2)') ratio
      else
         write (text, '(f7.0)') min(ratio, 99999.0_dp)
         text = ' '//text(:6)
      end if
   end function ratio_text

   !> An error, or that it is below what the truth can tell.
   pure function error_text(error, finest) result(text)
      real(dp), intent(in) :: error, finest
      character(8) :: text

      if (error > finest) then
         write (text, '(es8.1)') error
      else
         write (text, '(es7.0)') finest
         text = ' <'//adjustl(text(:7))
         text = adjustr(text)
      end if
   end function error_text

   !> For each level of error the cheapest of the `rows` of `last` steps.
   subroutine put_cheapest(o, rows, last, standard)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: rows(:)
      integer, intent(in) :: last
      real(dp), intent(in) :: standard(:)
      real(dp), parameter :: levels(7) = 10.0_dp**[-2, -4, -6, -8, -10, -12, -14]
      character(120) :: line
      real(dp) :: cost(size(rows)), error(size(rows))
      integer :: i, k

      error = huge(1.0_dp)
      cost = huge(1.0_dp)
      do k = 1, size(rows)
         associate (e => rows(k)%errors)
            if (rows(k)%trial%last /= last .or. size(rows(k)%time) == 0) cycle
            if (e%unsolved + e%no_velocity > 0 .or. e%compared == 0) cycle
            error(k) = maxval(e%largest)
            cost(k) = ratio_of(rows(k)%time, standard)
         end associate
      end do
      call put(o, '')
      call put(o, ' CHEAPEST TRIAL WITH AN ERROR OF 1E-2 ... 1E-14, '//whole(last)//' STEPS: the largest of position,')
      call put(o, ' velocity and acceleration at any step, of any link, is below')
      call put(o, '')
      call put(o, '    ERROR  METHOD      ORDER TOLERANCE      US/STEP  RATIO     ITS ERROR')
      do i = 1, size(levels)
         write (line, '(es9.0)') levels(i)
         k = minloc(cost, 1, error < levels(i))
         line(12:) = 'NONE OF THE TRIALS ABOVE'
         if (k > 0) write (line(12:), '(a28, 5x, a8, a7, 4x, es10.1)') trial_text(rows(k)%trial), &
            time_text(median(rows(k)%time)), ratio_text(cost(k)), error(k)
         call put(o, trim(line))
      end do
   end subroutine put_cheapest
end module study_table
