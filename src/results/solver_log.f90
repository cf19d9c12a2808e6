!> The solver's log (--log): how each position was found. It depends on the solver's path, which
!> the listing never does. Its numbers have one digit before the point and an exponent, as the formats ES write them,
!> without formats made at run time: correctly rounded, the same bytes.
module solver_log
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_words
   use convergence, only: convergence_t, ending
   use branch_certificate, only: branch_t, branch_word
   use text_output, only: output_t, put
   use decimal_digits, only: leading_digits
   use numerals, only: whole, put_digits, put_whole
   use known_digits, only: nothing_known
   implicit none
   private
   public :: log_head, log_instant, put_scientific, put_integer

contains

   !> The set's method and the columns; with `errors`, those of the errors' estimates as well.
   subroutine log_head(o, m, errors)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: errors

      call put(o, ' SET '//whole(m%set_number)//'   METHOD '//trim(method_words(m%method)))
      call put(o, trim('    STEP                        T     ENDED  ITER   RESIDUAL CORRECTION       RATE' &
         //'  RECIPROCAL CONDITION  SIGN OF DET   BRANCH  SUBSTEPS  KANTOROVICH'// &
         merge('  ERROR OF X  ERROR OF V  ERROR OF A', repeat(' ', 36), errors)))
   end subroutine log_head

   !> One line: instant number, time, how the iteration ended, its count, last residual and step (over the size of
   !> the coordinates), mean ratio of successive residuals, reciprocal condition and sign of the determinant; the
   !> branch `b`, and what was verified of it; where `errors` (0:2) are given, the largest of positions, velocities
   !> and accelerations, in the characteristic length and rate.
   subroutine log_instant(o, step, t, c, b, errors)
      type(output_t), intent(inout) :: o
      integer, intent(in) :: step
      real(wp), intent(in) :: t
      type(convergence_t), intent(in) :: c
      type(branch_t), intent(in) :: b
      real(wp), intent(in), optional :: errors(0:2)
      character(200) :: line
      integer :: k, last

      call put_integer(step, line(:8))
      call put_scientific(t, 16, 3, line(9:33))
      line(34:43) = ' '//adjustr(ending(c))
      call put_integer(c%iterations, line(44:49))
      call put_scientific(c%residual, 3, 2, line(50:60))
      call put_scientific(c%step, 3, 2, line(61:71))
      call put_scientific(c%rate, 3, 2, line(72:82))
      call put_scientific(c%reciprocal_condition, 3, 2, line(83:104))
      call put_integer(c%determinant, line(105:117))
      line(118:126) = '  '//adjustr(branch_word(b))
      call put_integer(b%substeps, line(127:136))
      call put_scientific(b%kantorovich_ratio, 3, 2, line(137:149))
      last = 149
      if (present(errors)) then
         do k = 0, 2
            if (errors(k) < nothing_known) then
               call put_scientific(errors(k), 2, 3, line(last + 1:last + 12))
            else
               line(last + 1:last + 12) = '        NONE'
            end if
            last = last + 12
         end do
      end if
      call put(o, line(:last))
   end subroutine log_instant

   !> `x` with so many `decimals` (1 to 16), right-adjusted in `text`; its exponent has 2 digits, as by ESw.d, or 3, as
   !> by ESw.dE3 (`exponent_digits`).
   pure subroutine put_scientific(x, decimals, exponent_digits, text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, exponent_digits
      character(*), intent(out) :: text
      integer(int64) :: n, first
      integer :: e, point, sign_of
      logical :: sure

      n = 0
      e = 0
      sure = abs(x) <= 0.0_wp
      if (.not. sure) call leading_digits(abs(x), decimals + 1, n, e, sure)
      point = len(text) - exponent_digits - 2 - decimals
      sign_of = point - 2
      if (.not. sure .or. abs(e) >= 10**exponent_digits .or. sign_of < 1) then
         call put_by_format(x, decimals, exponent_digits, text)
         return
      end if
      text = ''
      call put_digits(n, text(point + 1:point + decimals), first)
      text(point:point) = '.'
      call put_digits(first, text(point - 1:point - 1))
      if (sign(1.0_wp, x) < 0.0_wp) text(sign_of:sign_of) = '-'
      text(point + decimals + 1:point + decimals + 2) = merge('E-', 'E+', e < 0)
      call put_digits(int(abs(e), int64), text(point + decimals + 3:))
   end subroutine put_scientific

   !> The same by a format: what has no certain digits, no room, or is no number.
   pure subroutine put_by_format(x, decimals, exponent_digits, text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, exponent_digits
      character(*), intent(out) :: text
      character(24) :: form

      if (exponent_digits == 2) then
         write (form, '(a,i0,a,i0,a)') '(es', len(text), '.', decimals, ')'
      else
         write (form, '(a,i0,a,i0,a,i0,a)') '(es', len(text), '.', decimals, 'e', exponent_digits, ')'
      end if
      write (text, form) x
   end subroutine put_by_format

   !> The whole number `i`, right-adjusted in `text`; stars where it has no room.
   pure subroutine put_integer(i, text)
      integer, intent(in) :: i
      character(*), intent(out) :: text
      character(12) :: field
      integer :: first

      call put_whole(abs(int(i, int64)), field, first)
      if (i < 0) first = first - 1
      if (i < 0) field(first:first) = '-'
      text = repeat('*', len(text))
      if (len(field) - first < len(text)) text = repeat(' ', len(text) - (len(field) - first + 1))//field(first:)
   end subroutine put_integer
end module solver_log
