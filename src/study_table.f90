!> Level 21. The lines of --study: a way, its time, its errors; the cheapest ways.
module study_table
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use mechanism, only: method_newton, method_dense, own_predictor
   use text_output, only: output_t, put
   use numerals, only: whole
   use timing, only: median
   use trial_forms, only: trial_t
   use true_errors, only: errors_t
   use study_plan, only: way_t, kind_single, kind_double
   implicit none
   private
   public :: row_t, put_section, put_row, put_cheapest, error_text

   !> A way and what came of it.
   type :: row_t
      type(way_t) :: way
      real(dp), allocatable :: time(:)           !< seconds a step; none: not timed
      real(dp) :: iterations = 0.0_dp
      type(errors_t) :: errors
   end type row_t

   real(dp), parameter :: micro = 1.0e6_dp

contains

   subroutine put_section(o, title)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: title

      call put(o, '')
      call put(o, ' '//title)
      call put(o, '')
      call put(o, ' METHOD       ORDER TOLERANCE STEPS    TIME   LEAST    MOST  RATIO  ITER' &
         //'        POSITION        VELOCITY    ACCELERATION')
      call put(o, repeat(' ', 36)//'US/STEP'//repeat(' ', 29)//repeat('     MAX     RMS', 3))
   end subroutine put_section

   !> METHOD, ORDER, TOLERANCE of a way, in 28 columns.
   pure function way_text(w) result(text)
      type(way_t), intent(in) :: w
      character(28) :: text
      character(12) :: method

      if (w%trial%method == method_newton) then
         method = 'BLOCKS'
      else if (w%trial%method == method_dense) then
         method = 'DENSE'
      else
         method = 'MATRIX'
         if (w%trial%keeps) method = 'MATRIX FIXED'
      end if
      if (w%kind /= kind_double) method = trim(method)//merge(' SP', ' QP', w%kind == kind_single)
      write (text, '(a12, i6, es10.0)') method, w%trial%predictor, w%trial%tolerance
      if (w%trial%predictor == own_predictor) text(13:18) = '   OWN'
      if (.not. w%trial%tolerance > 0.0_dp) text(19:28) = '  ROUNDING'
   end function way_text

   !> One row; `standard` (repeats): seconds a step of the default; `finest` (0:2): the smallest error that the truth
   !> can tell.
   subroutine put_row(o, r, standard, finest)
      type(output_t), intent(inout) :: o
      type(row_t), intent(in) :: r
      real(dp), intent(in) :: standard(:), finest(0:2)
      character(120) :: line
      integer :: k

      write (line, '(1x, a28, i6)') way_text(r%way), r%way%trial%last
      if (size(r%time) > 0) then
         line(36:) = time_text(median(r%time))//time_text(minval(r%time))//time_text(maxval(r%time)) &
            //ratio_text(ratio_of(r%time, standard))
      else
         line(36:) = repeat('       -', 3)//'      -'
      end if
      write (line(67:72), '(f6.1)') min(r%iterations, 9999.0_dp)
      if (r%errors%compared > 0) then
         do k = 0, 2
            line(73 + 16*k:) = error_text(r%errors%most(k), finest(k))//error_text(r%errors%rms(k), finest(k))
         end do
      else if (r%errors%unsolved + r%errors%rateless == 0) then
         line(67:) = repeat(' ', 8)//'REFUSES NUMBERS OF THE DECK'
      else
         line(73:) = '  DID NOT CONVERGE AT ANY INSTANT'
         if (r%errors%rateless > 0) line(73:) = '  NO VELOCITIES AT ANY INSTANT'
      end if
      call put(o, trim(line))
      call put_failures(o, r%errors)
   end subroutine put_row

   !> Where a way has failed, and how.
   subroutine put_failures(o, e)
      type(output_t), intent(inout) :: o
      type(errors_t), intent(in) :: e
      character(:), allocatable :: of_all

      of_all = ' OF '//whole(e%compared + e%unsolved + e%rateless)//' INSTANTS'
      if (e%compared > 0 .and. e%unsolved > 0) call put(o, '    DID NOT CONVERGE AT '//whole(e%unsolved)//of_all)
      if (e%compared > 0 .and. e%rateless > 0) call put(o, '    NO VELOCITIES AT '//whole(e%rateless)//of_all)
      if (e%elsewhere > 0) call put(o, &
         '    CONVERGED TO ANOTHER POSITION, WHICH CLOSES AS WELL, AT '//whole(e%elsewhere)//of_all)
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
      integer :: i, k, best

      call put(o, '')
      call put(o, ' CHEAPEST WAY TO AN ERROR OF 1E-2 ... 1E-14, '//whole(last)//' STEPS: the largest of position,')
      call put(o, ' velocity and acceleration at any step, of any link, is below')
      call put(o, '')
      call put(o, '    ERROR  METHOD      ORDER TOLERANCE      US/STEP  RATIO     ITS ERROR')
      do i = 1, size(levels)
         best = 0
         do k = 1, size(rows)
            if (rows(k)%way%trial%last /= last .or. size(rows(k)%time) == 0) cycle
            if (rows(k)%errors%unsolved + rows(k)%errors%rateless > 0 .or. rows(k)%errors%compared == 0) cycle
            if (.not. maxval(rows(k)%errors%most) < levels(i)) cycle
            if (best == 0) then
               best = k
            else if (ratio_of(rows(k)%time, standard) < ratio_of(rows(best)%time, standard)) then
               best = k
            end if
         end do
         write (line, '(es9.0)') levels(i)
         if (best == 0) line(12:) = 'NONE OF THE WAYS ABOVE'
         if (best > 0) write (line(12:), '(a28, 5x, a8, a7, 4x, es10.1)') way_text(rows(best)%way), &
            time_text(median(rows(best)%time)), ratio_text(ratio_of(rows(best)%time, standard)), &
            maxval(rows(best)%errors%most)
         call put(o, trim(line))
      end do
   end subroutine put_cheapest
end module study_table
