!> Tests. The program of `make bench`, one table a call; tests/bench/bench.sh makes the decks and calls it.
!>
!>    bench steps                        time a step of four mechanisms, also in coarse steps
!>    bench sines COUNT                  errors of the lanes' sines, no clock; exit status 1 if any is large
!>    bench lanes DECKS                  time a step of a variant in lanes
!>    bench chains DECKS                 time a step of the chains in the directory DECKS
!>    bench scene NAME [N DECKS]         a line for another program: the time of a step of input/NAME.deck, or of a
!> chain,
!>                                       by the closed form and by the blocks, in ns; characteristic length and rate
!>    bench results DECKS STEPS DECK...  results compared, no clock; exit status 1 if any differ
program bench
   use bench_results, only: judge_all
   use bench_tables, only: steps_table, coarse_table, chains_table, scene_line
   use bench_lanes, only: lanes_table, judge_sines
   implicit none
   character(200), allocatable :: arguments(:)
   integer :: i, steps, count

   allocate (arguments(max(4, command_argument_count())))
   do i = 1, size(arguments)
      call get_command_argument(i, arguments(i))
   end do
   select case (arguments(1))
   case ('steps')
      call steps_table()
      call coarse_table()
   case ('sines')
      read (arguments(2), *) count
      call judge_sines(count)
   case ('lanes')
      call lanes_table(trim(arguments(2)))
   case ('chains')
      call chains_table(trim(arguments(2)))
   case ('scene')
      call scene_line(trim(arguments(2)), trim(arguments(3)), trim(arguments(4)))
   case ('results')
      read (arguments(3), *) steps
      call judge_all(arguments(4:), trim(arguments(2)), steps)
   case default
      error stop 'BENCH: WHICH TABLE?'
   end select
end program bench
