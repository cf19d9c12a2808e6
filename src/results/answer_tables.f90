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
   subroutine put_answers(o, l, a, s)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(answers_t), intent(in) :: a
      type(set_analysis_t), intent(in) :: s

      if (a%extremes_asked) call put_extremes(o, l, s%now, a%extremes, a%dwells)
      if (s%now%ranges) call put_ranges(o, s%now, a%ranges)
      if (s%now%assemblies) call put_assemblies(o, l, s)
      if (allocated(a%circuits)) call put_circuits(o, s%now, a%circuits)
      if (a%shares_asked) call put_shares(o, l, a%shares, s%now)
      if (s%now%proves) call put_proofs(o, l, a%proofs, s%now)
   end subroutine put_answers
end module answer_tables
