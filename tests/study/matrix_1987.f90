!> Tests. The method of 1987, measured.
!>
!>    matrix_1987 tables    rates, basins, iterations, the decks
!>    matrix_1987 times     the cost of a step, as ratios
!>    matrix_1987 picture   the numbers of docs/matrix_1987.png
!>    matrix_1987 short     rates against the theory, judged; the last line is `N passed, N failed`
program matrix_1987
   use rates_1987, only: rates_table, constants_table, picture_numbers, judge_rates
   use test_counter, only: test_counter_t, conclude
   use runs_1987, only: basins_table, counts_table, decks_table, times_table
   implicit none
   character(16) :: part
   type(test_counter_t) :: counter

   call get_command_argument(1, part)
   select case (part)
   case ('tables')
      call rates_table()
      call constants_table()
      call basins_table()
      call counts_table()
      call decks_table()
   case ('times')
      call times_table()
   case ('picture')
      call picture_numbers()
   case ('short')
      call judge_rates(counter)
      call conclude(counter)
   case default
      error stop 'MATRIX_1987: WHICH PART?'
   end select
end program matrix_1987
