!> The solver's log (--log): how each position was found. It depends on the solver's path, which
!> the listing never does.
module solver_log
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_words
   use convergence, only: convergence_t, ending
   use branch_certificate, only: branch_t, branch_word
   use text_output, only: output_t, put
   use numerals, only: whole
   use scientific_numerals, only: put_scientific, put_integer
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
      call put(o, trim('    STEP                        T     ENDED  ITER   RESIDUAL       STEP       RATE' &
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
end module solver_log
