!> The answers to cards in the listing, after its last instant.
module answer_tables
   use set_analysis, only: set_analysis_t
   use answers, only: answers_t
   use listing_layout, only: layout_t
   use extremes_table, only: put_extremes
   use ranges_table, only: put_ranges
   use assembly_table, only: put_assemblies
   use circuits_table, only: put_circuits
   use contributions_table, only: put_shares
   use proof_table, only: put_proofs
   use text_output, only: output_t
   implicit none
   private
   public :: put_answers

contains

   !> Writes the answers after the last instant.
   subroutine put_answers(o, l, answers, set)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(answers_t), intent(in) :: answers
      type(set_analysis_t), intent(in) :: set

      if (answers%extremes_asked) call put_extremes(o, l, set%now, answers%extremes, answers%dwells)
      if (set%now%ranges) call put_ranges(o, set%now, answers%ranges)
      if (set%now%assemblies) call put_assemblies(o, l, set)
      if (allocated(answers%circuits)) call put_circuits(o, set%now, answers%circuits)
      if (answers%shares_asked) call put_shares(o, l, answers%shares, set%now)
      if (set%now%proves) call put_proofs(o, l, answers%proofs, set%now)
   end subroutine put_answers
end module answer_tables
