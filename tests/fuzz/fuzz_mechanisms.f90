!> Tests. Mechanisms by the dice whose motion is known in real128, each from the number of its seed, through the
!> program's own job; `tests/fuzz/fuzz_mechanisms.sh` calls it.
!>
!>    fuzz_mechanisms FIRST LAST DIRECTORY     seeds FIRST to LAST, a line for each that fails, then a line of sums
!>    fuzz_mechanisms --deck SEED FILE         writes the deck of a seed
!>    fuzz_mechanisms --surplus SEED FILE MORE a small mechanism of a seed, and to MORE the same with equations too many
!>
!> DIRECTORY/seed holds the seed that is being run; DIRECTORY/SEED.deck is kept of each that fails.
program fuzz_mechanisms
   use arguments, only: argument, number
   use csv_cells, only: whole_text
   use, intrinsic :: iso_fortran_env, only: output_unit
   use command_line, only: options_t, out_listing, out_csv
   use job, only: run_job
   use phrases, only: phrase, text_too_long
   use quad_jet, only: qp
   use schemes, only: scheme_t, write_scheme
   use random_schemes, only: random_scheme, class_of, surplus_scheme, add_measures
   use scheme_results, only: verdict_t, judge
   implicit none

   type :: sums_t
      integer :: passed(3) = 0, failed = 0, instants = 0, numbers = 0, lost = 0, unknown = 0, flagged = 0, above = 0
      real(qp) :: worst(0:2) = 0.0_qp
   end type sums_t

   if (argument(1) == '--deck') then
      call write_deck(schemes_of(number(2)), argument(3))
   else if (argument(1) == '--surplus') then
      call write_deck(surplus_of(number(2), .false.), argument(3))
      call write_deck(surplus_of(number(2), .true.), argument(4))
   else
      call run_seeds(number(1), number(2), argument(3))
   end if

contains

   !> Every tenth chain of dyads has two sets, and some of the others.
   function schemes_of(seed) result(s)
      integer, intent(in) :: seed
      type(scheme_t), allocatable :: s(:)

      s = [random_scheme(seed, 1)]
      if (modulo(seed, 10) == 7 .or. modulo(seed, 30) == 11 .or. modulo(seed, 60) == 40) s = [s, random_scheme(seed, 2)]
      call add_measures(s(1), seed)
   end function schemes_of

   function surplus_of(seed, has_surplus) result(s)
      integer, intent(in) :: seed
      logical, intent(in) :: has_surplus
      type(scheme_t), allocatable :: s(:)

      allocate (s(1))
      s(1) = surplus_scheme(seed, has_surplus)
   end function surplus_of

   subroutine write_deck(s, path)
      type(scheme_t), intent(in) :: s(:)
      character(*), intent(in) :: path
      integer :: unit, k

      open (newunit=unit, file=path, status='replace', action='write')
      do k = 1, size(s)
         call write_scheme(s(k), unit)
      end do
      close (unit)
   end subroutine write_deck

   subroutine run_seeds(first, last, directory)
      integer, intent(in) :: first, last
      character(*), intent(in) :: directory
      type(sums_t) :: sums
      type(verdict_t) :: v
      integer :: seed, unit

      open (newunit=unit, file=directory//'/seed', access='stream', form='formatted', status='replace')
      do seed = first, last
         rewind (unit)
         write (unit, '(i0)') seed
         call write_sums(unit, sums)
         flush (unit)
         call run_seed(seed, directory, v)
         sums%instants = sums%instants + v%instants
         sums%numbers = sums%numbers + v%numbers
         sums%lost = sums%lost + v%lost
         sums%unknown = sums%unknown + v%unknown
         sums%flagged = sums%flagged + v%flagged
         sums%above = sums%above + v%above
         if (allocated(v%text)) then
            sums%failed = sums%failed + 1
            write (output_unit, '(a,i0,2a)') 'FAILED: SEED ', seed, ': ', v%text
            flush (output_unit)
            call write_deck(schemes_of(seed), directory//'/'//whole_text(seed)//'.deck')
         else
            sums%worst = max(sums%worst, v%worst)
            sums%passed(class_of(seed)) = sums%passed(class_of(seed)) + 1
         end if
      end do
      close (unit, status='delete')
      call write_sums(output_unit, sums)
   end subroutine run_seeds

   subroutine write_sums(unit, s)
      integer, intent(in) :: unit
      type(sums_t), intent(in) :: s

      write (unit, '(a,9(1x,i0),3f9.4,1x,i0)') 'SUMS', s%passed, s%failed, s%instants, s%numbers, s%lost, s%unknown, &
         s%flagged, s%worst, s%above
   end subroutine write_sums

   !> Runs one deck and judges its results.
   subroutine run_seed(seed, directory, v)
      integer, intent(in) :: seed
      character(*), intent(in) :: directory
      type(verdict_t), intent(out) :: v
      type(options_t) :: options
      type(scheme_t), allocatable :: s(:)
      character(:), allocatable :: message
      integer :: status

      s = schemes_of(seed)
      options%deck = directory//'/deck'
      options%files(out_listing)%text = directory//'/listing'
      options%files(out_csv)%text = directory//'/csv'
      options%show = ''
      options%errors = .true.
      call write_deck(s, options%deck)
      call run_job(options, status, message)
      if (status == 0 .or. status == 2) then
         call judge(s, options%files(out_csv)%text, has_line(directory//'/listing', phrase(text_too_long, .false.)), v)
         if (status == 0 .and. v%lost + v%flagged > 0 .and. .not. allocated(v%text)) v%text = 'STATUS 0 WITH FLAGS'
      else
         v%text = 'STATUS '//whole_text(status)//': '//message
      end if
   end subroutine run_seed

   !> A line of the file `path` holds `text`.
   logical function has_line(path, text)
      character(*), intent(in) :: path, text
      character(200) :: line
      integer :: unit, status

      has_line = .false.
      open (newunit=unit, file=path, status='old', action='read', iostat=status)
      do while (status == 0 .and. .not. has_line)
         read (unit, '(a)', iostat=status) line
         if (status == 0) has_line = index(line, text) > 0
      end do
      close (unit)
   end function has_line
end program fuzz_mechanisms
