!> The solver's log (--log): how each position was found. The log depends on the solver's path; the listing never does.
module solver_log
   use kinds, only: wp
   use mechanism, only: mechanism_t, method_words
   use convergence, only: solve_report_t, ending
   use continuation, only: branch_t, branch_none, branch_crossed
   use text_output, only: output_t, put
   use number_format, only: whole
   implicit none
   private
   public :: log_head, log_instant

contains

   !> Writes the set's method and the names of the columns.
   subroutine log_head(o, m)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m     !< the set

      call put(o, ' SET '//whole(m%set_number)//'   METHOD '//trim(method_words(m%method)))
      call put(o, '    STEP                        T     ENDED  ITER   RESIDUAL CORRECTION  SIGN OF DET' &
         //'   BRANCH  SUBSTEPS  KANTOROVICH')
   end subroutine log_head

   !> Writes the line of an instant of one independent mechanism: number and time; how the iteration ended, its count,
   !> last residual and step (over the size of the coordinates); the sign of the determinant; the branch and its
   !> certificate.
   subroutine log_instant(o, step, t, convergence, branch)
      type(output_t), intent(inout) :: o
      integer, intent(in) :: step            !< number of the instant, from 0
      real(wp), intent(in) :: t              !< time, in the deck's unit
      type(solve_report_t), intent(in) :: convergence   !< of the instant
      type(branch_t), intent(in) :: branch   !< of the instant
      character(7), parameter :: branch_words(branch_none:branch_crossed) = ['NONE   ', 'FIRST  ', 'SAME   ', 'CROSSED']
      character(116) :: line

      write (line, '(i8, es25.16e3, 1x, a9, i6, 2es11.3, i13, a9, i10, es13.3)') step, t, &
         adjustr(ending(convergence)), convergence%iterations, convergence%residual, convergence%step, &
         convergence%determinant, adjustr(branch_words(branch%kind)), branch%substeps, branch%kantorovich_ratio
      call put(o, line)
   end subroutine log_instant
end module solver_log
