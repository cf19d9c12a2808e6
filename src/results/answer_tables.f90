!> The answers to cards in the listing, after its last instant.
module answer_tables
   use set_analysis, only: set_analysis_t
   use answers, only: answers_t
   use listing_layout, only: layout_t
   use extremes_table, only: write_extremes
   use ranges_table, only: write_ranges
   use assembly_table, only: write_assemblies
   use circuits_table, only: write_circuits
   use contributions_table, only: write_shares
   use proof_table, only: write_proofs
   use text_output, only: output_t
   implicit none
   private
   public :: write_answers

contains

   !> Writes the answers after the last instant.
   subroutine write_answers(o, l, answers, set)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(answers_t), intent(in) :: answers
      type(set_analysis_t), intent(in) :: set

      if (answers%wants_extremes) call write_extremes(o, l, set%now, answers%extremes, answers%dwells)
      if (set%now%ranges) call write_ranges(o, set%now, answers%ranges)
      if (set%now%assemblies) call write_assemblies(o, l, set)
      if (allocated(answers%circuits)) call write_circuits(o, set%now, answers%circuits)
      if (answers%wants_contributions) call write_shares(o, l, answers%shares, set%now)
      if (set%now%proves) call write_proofs(o, l, answers%proofs, set%now)
   end subroutine write_answers
end module answer_tables
