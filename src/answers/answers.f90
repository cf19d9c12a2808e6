!> What a set asks of its motion beyond tables at instants: the cards EXTREMES, RANGE, ASSEMBLY, CIRCUITS, TOLER
!> and PROVE. A set that asks for nothing costs nothing.
module answers
   use kinds, only: wp
   use set_analysis, only: set_analysis_t
   use rows, only: finished_row_t
   use extremes, only: extremes_t, new_extremes
   use extreme_search, only: note_instant
   use dwells, only: dwell_t, find_dwells
   use tolerance_contributions, only: shares_t, note_tolerances
   use ranges, only: range_t
   use circuits, only: circuits_t
   use set_circuits, only: find_ranges, find_all_circuits
   use proofs, only: proofs_t, note_proof
   implicit none
   private
   public :: answers_t, new_answers, take_instant, finish_answers

   type :: answers_t
      logical :: extremes_asked = .false.
      logical :: shares_asked = .false.
      type(extremes_t) :: extremes
      type(dwell_t), allocatable :: dwells(:)       !< after the last instant
      type(shares_t) :: shares
      type(proofs_t) :: proofs
      type(range_t), allocatable :: ranges(:)       !< (drives that have one)
      integer :: assemblies = -1                    !< of all parts, where they are asked for and all are known
      type(circuits_t), allocatable :: circuits(:)  !< (drives that are set free) likewise; not allocated: not asked
   end type answers_t

contains

   !> Ready for the first instant of the set that `s` analyses. `lists`: its tables are written, which alone have the
   !> shares of tolerances.
   subroutine new_answers(s, lists, a)
      type(set_analysis_t), intent(in) :: s
      logical, intent(in) :: lists           !< the tables of the set are written
      type(answers_t), intent(out) :: a
      integer :: c

      a%extremes_asked = any([(any(s%now%parts(c)%requests%extremes), c=1, s%now%count)])
      a%shares_asked = lists .and. s%now%largest_tolerance > 0.0_wp
      if (s%now%assemblies) then
         if (all(s%assemblies%is_known)) a%assemblies = sum([(size(s%assemblies(c)%list), c=1, size(s%assemblies))])
      end if
      allocate (a%ranges(0))
      if (a%extremes_asked) call new_extremes(s%now, a%extremes)
   end subroutine new_answers

   !> Takes instant number `k`, to which `s` has advanced, and what is asked for between it and those before. `due`: it
   !> is printed.
   subroutine take_instant(a, s, rows, k, due)
      type(answers_t), intent(inout) :: a
      type(set_analysis_t), intent(inout) :: s
      type(finished_row_t), intent(in) :: rows(:)
      integer, intent(in) :: k               !< the number of the instant, from 0
      logical, intent(in) :: due             !< it is printed

      if (s%now%proves) call note_proof(a%proofs, s, k, due)
      if (s%now%ranges .and. k == 0) call find_ranges(s, a%ranges)
      if (s%now%circuits .and. s%now%variants == 0 .and. k == 0) call find_all_circuits(s, a%circuits)
      if (a%shares_asked .and. due) call note_tolerances(a%shares, s%now, rows)
      if (a%extremes_asked) call note_instant(a%extremes, s, k)
   end subroutine take_instant

   !> Finds after the last instant what the whole run answers.
   subroutine finish_answers(a, s)
      type(answers_t), intent(inout) :: a
      type(set_analysis_t), intent(inout) :: s   !< after its last instant

      if (a%extremes_asked) call find_dwells(a%extremes, s, a%dwells)
   end subroutine finish_answers
end module answers
