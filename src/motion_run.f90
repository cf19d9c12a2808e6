!> The run of one motion: solve an instant, print an instant; nothing else is kept for later.
module motion_run
   use mechanism, only: instant
   use structure, only: structure_report_t
   use command_line, only: out_listing
   use outputs, only: is_over
   use shares, only: write_in_turn
   use writers, only: writers_t, printing_t, begin_printing, is_next, print_instant, end_tables, print_end, break_off
   use answers, only: answers_t, new_answers, take_instant, finish_answers
   use answer_tables, only: put_answers
   use counts, only: counts_t, note_flag
   use phrases, only: say_broken_off
   use motion_proof, only: holds
   use set_motion, only: has_words
   use set_analysis, only: set_analysis_t, begin_analysis, foresee_closure, advance_set, prove_set
   implicit none
   private
   public :: run_motion

contains

   !> Solves and prints the set a%now, instant by instant.
   subroutine run_motion(a, findings, full, o, counts, asked)
      type(set_analysis_t), intent(inout) :: a
      type(structure_report_t), intent(inout) :: findings
      logical, intent(in) :: full            !< with tables
      type(writers_t), intent(inout) :: o
      class(counts_t), intent(inout) :: counts   !< instants solved and flagged, and the first of those
      type(answers_t), intent(out) :: asked  !< the answers to its cards
      type(printing_t) :: p
      logical :: due
      integer :: k

      call begin_analysis(a, findings)
      call foresee_closure(a)
      call begin_printing(p, o, a, full)
      if (o%asked(out_listing) .or. a%now%variants > 0) call new_answers(a, p%lists, asked)

      do k = 0, p%last
         call advance_set(a, instant(a%now, k))
         due = is_next(p, k)
         if (a%now%proves) then
            call prove_set(a, due)
            if (.not. all(holds(a%now%proofs))) counts%unproved = counts%unproved + 1
         end if
         call note_flag(counts, a)

         if (due .or. p%each .or. has_words(a%now)) call print_instant(p, o, a, k, due)
         call write_in_turn(o)
         call take_instant(asked, a, p%rows, k, due)
         if (.not. is_over(o)) cycle
         call end_tables(p, o, a)
         if (a%now%variants == 0) call break_off(o, a%now, say_broken_off, k)
         return
      end do

      call end_tables(p, o, a)
      if (p%lists) then
         call finish_answers(asked, a)
         call put_answers(o%files(out_listing), o%layout, asked, a)
      end if
      call print_end(p, o, a, counts)
   end subroutine run_motion
end module motion_run
