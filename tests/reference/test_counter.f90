!> Tests. What the programs that run over decks or seeds have in common: the name of a deck and its sets, and a count of
!> what was right.
module test_counter
   use failures, only: failure_t
   use mechanism, only: mechanism_t
   use deck, only: read_deck
   use arguments, only: number
   use csv_cells, only: whole_text
   implicit none
   private
   public :: test_counter_t, count_one, conclude, count_seeds, deck_name, sets_of

   type :: test_counter_t
      integer :: passed = 0, failed = 0
   end type test_counter_t

contains

   subroutine count_one(counter, good, what)
      type(test_counter_t), intent(inout) :: counter
      logical, intent(in) :: good
      character(*), intent(in) :: what

      if (good) then
         counter%passed = counter%passed + 1
      else
         counter%failed = counter%failed + 1
         print '(2a)', 'FAILED: ', what
      end if
   end subroutine count_one

   !> Prints the last line; the program ends with status 1 where something was wrong.
   subroutine conclude(counter)
      type(test_counter_t), intent(in) :: counter

      print '(i0,a,i0,a)', counter%passed, ' passed, ', counter%failed, ' failed'
      if (counter%failed > 0) stop 1, quiet=.true.
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
      type(test_counter_t) :: counter
      integer :: seed, first

      first = number(2, 1)
      do seed = first, first + number(1, otherwise) - 1
         call count_one(counter, agrees(seed), 'seed '//whole_text(seed))
      end do
      call conclude(counter)
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
end module test_counter
