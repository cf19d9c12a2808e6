!> The run of one motion: solve an instant, print an instant; nothing else is kept for later.
module motion_run
   use mechanism, only: instant
   use structure, only: structure_report_t
   use command_line, only: out_listing
   use system_calls, only: signal_received
   use outputs, only: is_over
   use job_chunks, only: write_in_turn
   use writers, only: writers_t, printing_t, begin_printing, is_next, print_instant, end_tables, print_end, break_off
   use answers, only: answers_t, new_answers, update_answers
   use dwells, only: find_dwells
   use counts, only: counts_t, record_flag
   use phrases, only: text_broken_off
   use motion_proof, only: holds
   use set_motion, only: has_words
   use set_analysis, only: set_analysis_t, begin_analysis, foresee_closure, advance_set, prove_set
   implicit none
   private
   public :: run_motion

contains

   !> Solves and prints the motion of a set, instant by instant. If a signal or a failed output breaks off the run, the
   !> last line of the listing tells so, and the answers are not complete.
   subroutine run_motion(set, structure_report, full, writers, counts, asked)
      type(set_analysis_t), intent(inout) :: set   !< `now` is divided; ends at the last instant
      type(structure_report_t), intent(inout) :: structure_report   !< of the set, which loses it
      logical, intent(in) :: full            !< the listing has tables
      type(writers_t), intent(inout) :: writers   !< get the text of the motion
      class(counts_t), intent(inout) :: counts   !< of a new run; gets its counts
      type(answers_t), intent(out) :: asked  !< the answers to the cards of the set
      type(printing_t) :: p
      logical :: due, flags, prints
      integer :: k

      call begin_analysis(set, structure_report)
      call foresee_closure(set)
      call begin_printing(p, writers, set, full)
      if (writers%asked(out_listing) .or. set%now%variants > 0) call new_answers(set, p%lists, asked)

      do k = 0, p%last
         call advance_set(set, instant(set%now, k))
         due = is_next(p, k)
         if (set%now%proves) then
            call prove_set(set, due)
            if (.not. all(holds(set%now%proofs))) counts%unproved = counts%unproved + 1
         end if
         flags = has_words(set%now)
         if (flags) call record_flag(counts, set)
         if (.not. flags) counts%solved = counts%solved + 1

         prints = due .or. p%each .or. flags
         if (prints) then
            call print_instant(p, writers, set, k, due)
            call write_in_turn(writers)
         end if
         if (asked%takes_instants) call update_answers(asked, set, p%rows, k, due)
         ! An output fails only where something is written.
         if (.not. prints .and. signal_received() == 0) cycle
         if (.not. is_over(writers)) cycle
         call end_tables(p, writers, set)
         if (set%now%variants == 0) call break_off(writers, set%now, text_broken_off, k)
         return
      end do

      call end_tables(p, writers, set)
      if (p%lists .and. asked%wants_extremes) call find_dwells(asked%extremes, set, asked%dwells)
      call print_end(p, writers, set, counts, asked)
   end subroutine run_motion
end module motion_run
