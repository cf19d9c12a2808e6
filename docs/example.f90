!> The modules of KINMAT in a program of one's own: the largest and the smallest angle of the rocker of a four-bar.
program example
   use kinds, only: wp
   use failures, only: failure_t
   use mechanism, only: mechanism_t, instant, instant_count
   use motion, only: motion_t, new_motion
   use deck, only: read_deck
   use analysis, only: analysis_t, make_analysis, advance
   implicit none
   type(mechanism_t), allocatable :: sets(:)
   type(failure_t), allocatable :: failure
   type(analysis_t) :: a
   type(motion_t) :: q
   character(:), allocatable :: report
   real(wp) :: least, largest
   integer :: rocker, k

   call read_deck('input/four_bar.deck', sets, report, failure)
   if (allocated(failure)) error stop 'the deck is rejected'
   rocker = findloc(sets(1)%links%name, 'ROCKER', dim=1)
   call make_analysis(a, sets(1))
   q = new_motion(size(sets(1)%links))
   least = huge(least)
   largest = -huge(largest)
   do k = 0, instant_count(sets(1)) - 1
      call advance(a, instant(sets(1), k), q)
      least = min(least, q%position(3, rocker))
      largest = max(largest, q%position(3, rocker))
   end do
   print '(a, f9.6, a, f9.6, a)', 'The rocker swings from ', least, ' to ', largest, ' rad.'
end program example
