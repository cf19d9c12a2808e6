!> Tests. The tables of `make bench` for whole decks: reading, memory, and the command from start to end.
module bench_whole
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use motion, only: motion_t, new_motion
   use failures, only: failure_t
   use deck, only: read_deck
   use analysis, only: analysis_t, make_analysis, advance
   use study, only: seconds
   use bench_tools, only: spread_t, spread_of, memory_peak, plain_reading, figure
   use bench_scenes, only: scene_t, new_scene, instant_of
   implicit none
   private
   public :: reading_head, reading_row, process_table

   integer, parameter :: repeats = 15

contains

   subroutine reading_head()
      print '(a)', '', ' LARGE DECKS, EACH IN A PROCESS OF ITS OWN', &
         ' PLAIN: seconds to read the file and count its lines; READ: to read the deck, ANALYSE: to make it ready', &
         ' RATIO: READ + ANALYSE over PLAIN; STEP: seconds a step; MEMORY: the most held, after 10 steps, 10**6 bytes', '', &
         ' DECK                       LINKS   10**6 B     PLAIN      READ   ANALYSE     RATIO      STEP    MEMORY'
   end subroutine reading_head

   !> One deck: the first reading is the one whose memory counts, the middle of three the one whose time counts.
   subroutine reading_row(path)
      character(*), intent(in) :: path
      type(mechanism_t), allocatable :: sets(:)
      real(wp) :: plain(3), read(3), ready(3), step, memory
      type(spread_t) :: r(4)
      integer(int64) :: bytes
      integer :: i

      memory = 0.0_wp
      do i = 1, 3
         plain(i) = plain_reading(path)
         call read_and_step(path, sets, read(i), ready(i), step)
         if (i == 1) memory = memory_peak()
      end do
      inquire (file=path, size=bytes)
      r = [spread_of(plain), spread_of(read), spread_of(ready), spread_of((read + ready)/plain)]
      print '(1x, a20, i12, f10.1, 3f10.3, f10.1, f10.4, f10.0)', path(index(path, '/', &
         back=.true.) + 1:)//repeat(' ', 20), &
         size(sets(1)%links), bytes*1.0e-6_wp, r(:3)%median, r(4)%median, step, memory
   end subroutine reading_row

   !> Reads a deck and does ten steps; seconds.
   subroutine read_and_step(path, sets, read, ready, step)
      character(*), intent(in) :: path
      type(mechanism_t), allocatable, intent(out) :: sets(:)
      real(wp), intent(out) :: read, ready, step
      type(failure_t), allocatable :: failure
      character(:), allocatable :: report
      type(analysis_t) :: a
      type(motion_t) :: q
      integer :: k

      read = seconds()
      call read_deck(path, sets, report, failure)
      if (allocated(failure)) error stop 'A DECK OF THE BENCH IS REFUSED'
      ready = seconds()
      read = ready - read
      call make_analysis(a, sets(1))
      step = seconds()
      ready = step - ready
      q = new_motion(size(sets(1)%links))
      do k = 1, 10
         call advance(a, 1.0e-3_wp*k, q)
      end do
      step = 0.1_wp*(seconds() - step)
   end subroutine read_and_step

   !> The command `kinmat` on the deck s1 of 3600 steps, from start to end, and on s2, the same with the first and the
   !> last step printed; what the solving alone takes in here.
   subroutine process_table(decks, kinmat)
      character(*), intent(in) :: decks, kinmat
      character(20), parameter :: names(5) = [character(20) :: 'start-up (--version)', 'solving alone', &
         'printing two steps', 'listing', 'listing and csv']
      real(wp) :: time(size(names), repeats)
      type(spread_t) :: own, start, solving
      type(scene_t) :: s
      integer :: i, k

      s = new_scene(decks//'/s1.deck', 'four_bar', 1)
      do k = 1, repeats
         time(1, k) = time_of('exec '//kinmat//' --version > /dev/null')
         time(2, k) = time_turn(s)
         time(3, k) = time_of('exec '//kinmat//' '//decks//'/s2.deck > /dev/null')
         time(4, k) = time_of('exec '//kinmat//' '//decks//'/s1.deck > /dev/null')
         time(5, k) = time_of('exec '//kinmat//' --csv /dev/null '//decks//'/s1.deck > /dev/null')
      end do
      print '(a)', '', ' THE WHOLE PROCESS: THE FOUR-BAR, 3600 STEPS, RESULTS TO /dev/null', &
         ' MS: the middle of 15 repeats; RATIO: to the start-up, and to the solving alone, in the same repeat', '', &
         ' PART                      MS   LEAST    MOST  START-UP   SOLVING'
      do i = 1, size(names)
         own = spread_of(1000.0_wp*time(i, :))
         start = spread_of(time(i, :)/time(1, :))
         solving = spread_of(time(i, :)/time(2, :))
         print '(1x, a20, 3a8, 2(2x, a8))', names(i), figure(own%median), figure(own%least), figure(own%most), &
            figure(start%median), figure(solving%median)
      end do
   end subroutine process_table

   !> Seconds that a command takes.
   real(wp) function time_of(command) result(time)
      character(*), intent(in) :: command
      integer :: status

      time = seconds()
      call execute_command_line(command, exitstat=status)
      time = seconds() - time
      if (status /= 0) error stop 'A COMMAND OF THE BENCH FAILED'
   end function time_of

   !> Seconds to solve the instants of a deck, its first among them.
   real(wp) function time_turn(s) result(time)
      type(scene_t), intent(in) :: s
      type(analysis_t) :: a
      type(motion_t) :: q
      integer :: k

      q = new_motion(size(s%m%links))
      time = seconds()
      call make_analysis(a, s%m)
      do k = 0, s%steps
         call advance(a, instant_of(s, k), q)
      end do
      time = seconds() - time
   end function time_turn
end module bench_whole
