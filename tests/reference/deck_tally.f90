!> Tests. What the programs that run over decks or seeds have in common: the name of a deck and its sets, and a count of
!> what was right.
module deck_tally
   use failures, only: failure_t
   use mechanism, only: mechanism_t
   use deck, only: read_deck
   use arguments, only: number
   use csv_cells, only: whole_text
   implicit none
   private
   public :: certificate_counts_t, count_one, conclude, count_seeds, deck_name, sets_of

   type :: certificate_counts_t
      integer :: passed = 0, failed = 0
   end type certificate_counts_t

contains

   subroutine count_one(tally, good, what)
      type(certificate_counts_t), intent(inout) :: tally
      logical, intent(in) :: good
      character(*), intent(in) :: what

      if (good) then
         tally%passed = tally%passed + 1
      else
         tally%failed = tally%failed + 1
         print '(2a)', 'FAILED: ', what
      end if
   end subroutine count_one

   !> Prints the last line; the program ends with status 1 where something was wrong.
   subroutine conclude(tally)
      type(certificate_counts_t), intent(in) :: tally

      print '(i0,a,i0,a)', tally%passed, ' passed, ', tally%failed, ' failed'
      if (tally%failed > 0) stop 1, quiet=.true.
   end subroutine conclude

   !> Counts the seeds that agree, and ends the program. The words of the command are their number (`otherwise` if there
   !> is none) and the first of them.
   subroutine count_seeds(agrees, otherwise)
      interface
         logical function agrees(seed)
            integer, intent(in) :: seed
         end function agrees
      end interface
      integer, intent(in) :: otherwise
      type(certificate_counts_t) :: tally
      integer :: seed, first

      first = number(2, 1)
      do seed = first, first + number(1, otherwise) - 1
         call count_one(tally, agrees(seed), 'seed '//whole_text(seed))
      end do
      call conclude(tally)
   end subroutine count_seeds

   !> The file's name without its folders and what follows a dot.
   pure function deck_name(path) result(name)
      character(*), intent(in) :: path
      character(:), allocatable :: name

      name = path(scan(path, '/', back=.true.) + 1:)
      name = name(:scan(name//'.', '.') - 1)
   end function deck_name

   !> The sets of a deck without a fault.
   function sets_of(path) result(sets)
      character(*), intent(in) :: path
      type(mechanism_t), allocatable :: sets(:)
      character(:), allocatable :: report
      type(failure_t), allocatable :: failure

      call read_deck(path, sets, report, failure)
      if (allocated(failure)) error stop 'A DECK IS NOT READ'
   end function sets_of
end module deck_tally
