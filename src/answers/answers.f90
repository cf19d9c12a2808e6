!> Answers about the whole motion of a set, in addition to tables at instants: the cards EXTREMES, RANGE, ASSEMBLY,
!> CIRCUITS, TOLER and PROVE. A set without these cards costs nothing.
module answers
   use kinds, only: wp
   use mechanism, only: request_t
   use set_members, only: requests_of
   use set_analysis, only: set_analysis_t
   use rows, only: finished_row_t
   use extremes, only: extremes_t, new_extremes
   use extreme_search, only: record_instant
   use dwells, only: dwell_t
   use tolerance_contributions, only: contributions_t, record_sensitivities
   use ranges, only: range_t
   use circuits, only: circuits_t
   use set_circuits, only: find_ranges, find_all_circuits
   use proofs, only: proofs_t, record_proof
   implicit none
   private
   public :: answers_t, new_answers, update_answers

   !> The answers of a set, and which of them are asked for.
   type :: answers_t
      logical :: takes_instants = .false.           !< some answer is made of the instants
      logical :: wants_extremes = .false.           !< card EXTREMES
      logical :: wants_contributions = .false.      !< card TOLER, with tables in the listing
      type(extremes_t) :: extremes
      type(dwell_t), allocatable :: dwells(:)       !< (any number) after the last instant
      type(contributions_t) :: shares               !< of tolerances
      type(proofs_t) :: proofs                      !< card PROVE
      type(range_t), allocatable :: ranges(:)       !< (any number) card RANGE: by drives, or by branches
      integer :: assemblies = -1                    !< of all parts, if they are asked for and all are known; or -1
      type(circuits_t), allocatable :: circuits(:)  !< (drives that are set free); not allocated: not asked for
   end type answers_t

contains

   !> Prepares the answers of a set, before its first instant.
   subroutine new_answers(set, lists, answers)
      type(set_analysis_t), intent(in) :: set   !< before its first instant
      logical, intent(in) :: lists           !< tables are written: only these have shares of tolerances
      type(answers_t), intent(out) :: answers   !< without an instant
      type(request_t), allocatable :: requests(:)
      integer :: c

      requests = requests_of(set%now)
      answers%wants_extremes = any(requests%extremes)
      answers%wants_contributions = lists .and. set%now%largest_tolerance > 0.0_wp
      answers%takes_instants = answers%wants_extremes .or. answers%wants_contributions .or. set%now%proves .or. &
         set%now%ranges .or. set%now%circuits
      if (set%now%assemblies) then
         if (all(set%assemblies%is_known)) answers%assemblies = sum([(size(set%assemblies(c)%list), c=1, &
            size(set%assemblies))])
      end if
      allocate (answers%ranges(0))
      if (answers%wants_extremes) call new_extremes(set%now, answers%extremes)
   end subroutine new_answers

   !> Takes an instant, to which the set has advanced, and searches between it and the instant before.
   subroutine update_answers(answers, set, rows, k, due)
      type(answers_t), intent(inout) :: answers   !< by `new_answers`
      type(set_analysis_t), intent(inout) :: set   !< at the instant
      type(finished_row_t), intent(in) :: rows(:)   !< (requests of the set) at the instant
      integer, intent(in) :: k               !< the number of the instant, from 0
      logical, intent(in) :: due             !< the instant is printed

      if (set%now%proves) call record_proof(answers%proofs, set, k, due)
      if (set%now%ranges .and. k == 0) call find_ranges(set, answers%ranges)
      if (set%now%circuits .and. set%now%variants == 0 .and. k == 0) call find_all_circuits(set, answers%circuits)
      if (answers%wants_contributions .and. due) call record_sensitivities(answers%shares, set%now, rows)
      if (answers%wants_extremes) call record_instant(answers%extremes, set, k)
   end subroutine update_answers
end module answers
