!> Tests. Decks made by chance, each from the number of its seed, run through the program's own job;
!> `tests/fuzz/fuzz.sh` calls it.
!>
!>    fuzz FIRST LAST DIRECTORY DECK...     seeds FIRST to LAST, a line for each that fails, then a line of sums
!>    fuzz --deck SEED FILE DECK...         writes the deck of a seed
!>    fuzz --drawn SEED FILE                writes a drawing of a seed, unchanged
!>
!> DIRECTORY/seed holds the seed that is being run and the sums before it, for a run that does not come back.
program fuzz
   use arguments, only: argument, number
   use, intrinsic :: iso_fortran_env, only: output_unit
   use, intrinsic :: iso_c_binding, only: c_int, c_funptr, c_null_funptr
   use, intrinsic :: ieee_arithmetic, only: ieee_set_halting_mode, ieee_set_flag, ieee_usual, ieee_all
   use kinds, only: wp
   use failures, only: failure_t
   use mechanism, only: mechanism_t, instant_count
   use command_line, only: options_t, out_listing, out_csv, out_log, out_summary, out_svg, out_animation, &
      out_circuits, out_table
   use deck, only: read_deck
   use job, only: run_job
   use study, only: run_study
   use deck_text, only: deck_text_t, read_sets, write_deck, find_cards
   use deck_damage, only: deck_of_seed
   use dice, only: new_dice
   use drawn_decks, only: drawn_deck
   use csv_closure, only: verdict_t, check_csv
   use listing_check, only: check_listing, check_protocol
   implicit none

   !> Seconds that one deck may take, of a clock on the wall: the slowest known take 15 on a busy machine.
   integer(c_int), parameter :: patience = 60
   integer(c_int), parameter :: signal_alarm = 14
   !> Every so many-th deck has all outputs: these, the first of which is of one set, and in these files.
   integer, parameter :: others_every = 25
   integer, parameter :: other_outputs(*) = [out_table, out_summary, out_svg, out_animation, out_circuits]
   character(9), parameter :: others(*) = [character(9) :: 'table.csv', 'summary', 'svg', 'film.svg', 'circuits']

   !> Every so many-th deck is studied (--study) if its links at all instants are no more.
   integer, parameter :: studied_every = 20, max_studied = 2000

   interface
      !> After so many seconds the process is ended by the system; 0 takes it back.
      integer(c_int) function alarm(seconds) bind(c)
         import :: c_int
         integer(c_int), value :: seconds
      end function alarm
      !> signal(2): what the process does at the signal `number`; a null pointer: what the system does, which ends it.
      type(c_funptr) function signal(number, action) bind(c)
         import :: c_int, c_funptr
         integer(c_int), value :: number
         type(c_funptr), value :: action
      end function signal
   end interface

   !> What has been run: decks, exit statuses, instants and closures seen, largest residuals.
   type :: sums_t
      integer :: passed = 0, failed = 0, ended(0:3) = 0, instants = 0, closures = 0, ill = 0
      real(wp) :: worst(0:2) = 0.0_wp
   end type sums_t

   type(deck_text_t), allocatable :: sets(:)
   type(c_funptr) :: before
   integer :: i

   call set_traps(.false.)
   ! Who calls this program may have made it ignore the alarm.
   before = signal(signal_alarm, c_null_funptr)
   allocate (sets(0))
   do i = 4, command_argument_count()
      call read_sets(argument(i), sets)
   end do
   if (argument(1) == '--deck') then
      call write_deck(deck_of_seed(sets, number(2)), argument(3))
   else if (argument(1) == '--drawn') then
      call write_deck(drawn_deck(new_dice(number(2))), argument(3))
   else
      call run_seeds(number(1), number(2), argument(3))
   end if
   ! The sanitizer takes what the main program holds at its end for lost.
   deallocate (sets)
   ! A flag that is up when the traps come back would end the program.
   call ieee_set_flag(ieee_all, .false.)

contains

   subroutine run_seeds(first, last, directory)
      integer, intent(in) :: first, last
      character(*), intent(in) :: directory
      character(:), allocatable :: wrong
      type(verdict_t) :: v
      type(sums_t) :: s
      integer :: seed, status, unit

      open (newunit=unit, file=directory//'/seed', access='stream', form='formatted', status='replace')
      do seed = first, last
         rewind (unit)
         write (unit, '(i0)') seed
         call write_sums(unit, s)
         flush (unit)
         call run_seed(seed, directory, status, wrong, v)
         if (status >= 0 .and. status <= 3) s%ended(status) = s%ended(status) + 1
         s%instants = s%instants + v%instants
         s%closures = s%closures + v%closures
         s%ill = s%ill + v%ill
         if (wrong == '') then
            s%passed = s%passed + 1
            s%worst = max(s%worst, real(v%worst, wp))
         else
            s%failed = s%failed + 1
            write (output_unit, '(a,i0,2a)') 'FAILED: SEED ', seed, ': ', wrong
         end if
         flush (output_unit)
      end do
      close (unit, status='delete')
      call write_sums(output_unit, s)
      flush (output_unit)
   end subroutine run_seeds

   subroutine write_sums(unit, s)
      integer, intent(in) :: unit
      type(sums_t), intent(in) :: s

      write (unit, '(a,9(1x,i0),3f9.4)') 'SUMS', s%passed, s%failed, s%ended, s%instants, s%closures, s%ill, s%worst
   end subroutine write_sums

   !> Runs one deck and judges it; `wrong`: what is wrong, '' for nothing.
   subroutine run_seed(seed, directory, status, wrong, v)
      integer, intent(in) :: seed
      character(*), intent(in) :: directory
      integer, intent(out) :: status
      character(:), allocatable, intent(out) :: wrong
      type(verdict_t), intent(out) :: v
      type(options_t) :: options
      type(deck_text_t) :: d
      character(:), allocatable :: message
      integer :: flagged, k
      integer(c_int) :: left

      options = options_in(directory)
      d = deck_of_seed(sets, seed)
      call write_deck(d, options%deck)
      if (mod(seed, others_every) == 0) call ask_for_others(options, d, directory)
      left = alarm(patience)
      call set_traps(.true.)
      call run_job(options, status, message)
      call set_traps(.false.)
      wrong = ''
      select case (status)
      case (0, 2)
         call judge(options, v, wrong, flagged)
         if (wrong == '' .and. (flagged > 0 .neqv. status == 2) .and. size(find_cards(d, ['VARY    '])) == 0) &
            wrong = 'STATUS AND MARKS'
         if (wrong == '' .and. message /= '') wrong = 'WORDS ON STANDARD ERROR: '//message
         do k = 1, size(others)
            if (wrong == '' .and. allocated(options%files(other_outputs(k))%text)) &
               call check_protocol(options%files(other_outputs(k))%text, other_outputs(k) == out_table, wrong)
         end do
         if (wrong == '' .and. mod(seed, studied_every) == 0) call study_deck(options%deck, directory//'/study', wrong)
      case (1)
         if (index(message, ' *** E') == 0 .and. index(message, ' IS NOT A DECK: LINE ') == 0) &
            wrong = 'REFUSED WITHOUT A WORD: '//message
      case default
         wrong = 'STATUS IS NOT 0, 1 OR 2: '//message
      end select
      left = alarm(0_c_int)
   end subroutine run_seed

   !> Where a deck and its results are.
   function options_in(directory) result(options)
      character(*), intent(in) :: directory
      type(options_t) :: options

      options%deck = directory//'/deck'
      options%files(out_listing)%text = directory//'/listing'
      options%files(out_csv)%text = directory//'/csv'
      options%files(out_log)%text = directory//'/log'
      options%show = ''
   end function options_in

   !> The other outputs, as far as the deck `d` has what they need.
   subroutine ask_for_others(options, d, directory)
      type(options_t), intent(inout) :: options
      type(deck_text_t), intent(in) :: d
      character(*), intent(in) :: directory
      logical :: varies
      integer :: k

      varies = size(find_cards(d, ['VARY    '])) > 0
      do k = 1, size(others)
         if (other_outputs(k) == out_circuits .and. size(find_cards(d, ['CIRCUITS'])) == 0) cycle
         if (other_outputs(k) == out_table .and. varies) cycle
         options%files(other_outputs(k))%text = directory//'/'//trim(others(k))
      end do
   end subroutine ask_for_others

   !> With the traps of the debug build, or again without them.
   subroutine set_traps(are_on)
      logical, intent(in) :: are_on

      if (are_on) call ieee_set_flag(ieee_all, .false.)
      call ieee_set_halting_mode(ieee_usual, are_on)
   end subroutine set_traps

   !> The study of a short deck, with the same traps; kinmat-quad is not there.
   subroutine study_deck(path, output, wrong)
      character(*), intent(in) :: path, output
      character(:), allocatable, intent(out) :: wrong
      type(mechanism_t), allocatable :: read_sets(:)
      type(failure_t), allocatable :: failure
      character(:), allocatable :: report
      integer :: status, k

      wrong = ''
      call read_deck(path, read_sets, report, failure)
      if (sum([(instant_count(read_sets(k))*size(read_sets(k)%links), k=1, size(read_sets))]) > max_studied) return
      call set_traps(.true.)
      call run_study(path, output, .false., status, report)
      call set_traps(.false.)
      if (status /= 0 .or. report /= '') wrong = 'STUDY: '//report
      if (wrong == '') call check_protocol(output, .false., wrong)
   end subroutine study_deck

   subroutine judge(options, v, wrong, flagged)
      type(options_t), intent(in) :: options
      type(verdict_t), intent(out) :: v
      character(:), allocatable, intent(out) :: wrong
      integer, intent(out) :: flagged
      type(mechanism_t), allocatable :: read_sets(:)
      type(failure_t), allocatable :: failure
      character(:), allocatable :: report

      call read_deck(options%deck, read_sets, report, failure)
      call check_listing(options%files(out_listing)%text, size(read_sets), wrong, flagged)
      if (wrong == '') call check_protocol(options%files(out_log)%text, .false., wrong)
      ! The rows of variants belong to decks with other numbers.
      if (wrong /= '' .or. any(read_sets%variants > 0)) return
      call check_csv(options%files(out_csv)%text, read_sets, v)
      if (allocated(v%text)) wrong = v%text
   end subroutine judge
end program fuzz
