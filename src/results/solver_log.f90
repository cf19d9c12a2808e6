!> The solver's log (--log): how each position was found. It depends on the solver's path, which
!> the listing never does.
module solver_log
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_words
   use convergence, only: convergence_t, ending
   use branch_certificate, only: branch_t, branch_none, branch_crossed
   use text_output, only: output_t, put
   use numerals, only: whole
   use known_digits, only: nothing_known
   implicit none
   private
   public :: log_head, log_instant

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
      character(7), parameter :: branch_words(branch_none:branch_crossed) = ['NONE   ', 'FIRST  ', 'SAME   ', 'CROSSED']
      character(200) :: line
      integer :: k, last

      write (line, '(i8, es25.16e3, 1x, a9, i6, 3es11.3, es22.3, i13, a9, i10, es13.3)') step, t, adjustr(ending(c)), &
         c%iterations, c%residual, c%step, c%rate, c%reciprocal_condition, c%determinant, &
         adjustr(branch_words(b%kind)), b%substeps, b%kantorovich_ratio
      last = 149
      if (present(errors)) then
         do k = 0, 2
            line(last + 1:last + 12) = '        NONE'
            if (errors(k) < nothing_known) write (line(last + 1:last + 12), '(es12.2e3)') errors(k)
            last = last + 12
         end do
      end if
      call put(o, line(:last))
   end subroutine log_instant
end module solver_log
