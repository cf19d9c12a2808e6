!> Whole runs of small decks inside the unit tests: the cards, and what the run prints.
module deck_runs
   use kinds, only: wp
   use command_line, only: options_t, out_listing, out_csv, out_log
   use job, only: run_job
   use deck_samples, only: row, sample
   use written, only: taken
   implicit none
   private
   public :: run_t, run_cards, lines_of, remarks, csv_cell, csv_number, taken, crank_with, slider, pushed_slider

   character(*), parameter :: deck_file = 'unit_test_run.tmp', listing_file = 'unit_test_run_listing.tmp', &
      csv_file = 'unit_test_run_csv.tmp', log_file = 'unit_test_run_log.tmp', other_file = 'unit_test_run_other.tmp'
   character(1), parameter :: nl = achar(10)
   character(*), parameter :: columns = 'set,step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark,ex,ey,ephi,evx,evy,evphi,'// &
      'eax,eay,eaphi,'

   !> What a run leaves: exit status, message for standard error, listing, CSV and log.
   type :: run_t
      integer :: status = -1
      character(:), allocatable :: message, listing, csv, log
   end type run_t

contains

   !> Runs the deck of these cards; `errors`: with estimates of the errors; `text`: its output file number `other`.
   subroutine run_cards(cards, r, errors, other, text)
      character(*), intent(in) :: cards(:)
      type(run_t), intent(out) :: r
      logical, intent(in), optional :: errors
      integer, intent(in), optional :: other
      character(:), allocatable, intent(out), optional :: text
      type(options_t) :: options
      integer :: unit, i

      open (newunit=unit, file=deck_file, status='replace')
      do i = 1, size(cards)
         write (unit, '(a)') trim(cards(i))
      end do
      close (unit)
      options%deck = deck_file
      options%files(out_listing)%text = listing_file
      options%files(out_csv)%text = csv_file
      options%files(out_log)%text = log_file
      options%show = ''
      if (present(errors)) options%errors = errors
      if (present(other)) options%files(other)%text = other_file
      call run_job(options, r%status, r%message)
      r%listing = taken(listing_file)
      r%csv = taken(csv_file)
      r%log = taken(log_file)
      if (present(text)) text = taken(other_file)
      open (newunit=unit, file=deck_file)
      close (unit, status='delete')
   end subroutine run_cards

   !> The lines of the listing of `cards`, from its structure on, from the first one that begins with `first` to the one
   !> before that which begins with `last`.
   function lines_of(cards, first, last) result(text)
      character(*), intent(in) :: cards(:), first, last
      character(:), allocatable :: text
      type(run_t) :: r

      call run_cards(cards, r)
      text = r%listing(index(r%listing, nl//' STRU'):)
      text = text(index(text, nl//first) + 1:)
      text = text(:index(text, nl//last))
   end function lines_of

   !> The lines of the listing that begin with three stars or three dashes, each with its end; not the one that tells what
   !> `?` is, nor that drives rest, as many do on purpose.
   function remarks(r) result(text)
      type(run_t), intent(in) :: r
      character(:), allocatable :: text
      integer :: first, last

      text = ''
      first = 1
      do while (first <= len(r%listing))
         last = first + index(r%listing(first:), nl) - 1
         if ((r%listing(first:min(first + 4, last)) == ' *** ' .or. r%listing(first:min(first + 4, last)) == ' --- ') &
            .and. index(r%listing(first:last), ' --- ?:') /= 1 .and. &
            index(r%listing(first:last), ' NOT MOVE WITHIN') == 0) text = text//r%listing(first:last)
         first = last + 1
      end do
   end function remarks

   !> The cell of `column` in the row of instant `step` and of `name`, if `kind` is given in that of this kind; '?'
   !> without such a row.
   function csv_cell(r, step, name, column, kind) result(cell)
      type(run_t), intent(in) :: r
      integer, intent(in) :: step
      character(*), intent(in) :: name, column
      character(*), intent(in), optional :: kind
      character(:), allocatable :: cell
      character(12) :: number
      integer :: first, last, k, i
      logical :: found

      cell = '?'
      write (number, '(i0)') step
      k = count([(columns(i:i) == ',', i=1, index(','//columns, ','//column//',') - 1)])
      first = 1
      do while (first <= len(r%csv))
         last = first + index(r%csv(first:), nl) - 1
         associate (line => r%csv(first:last - 1))
            found = cell_of(line, 1) == trim(number) .and. cell_of(line, 4) == name
            if (present(kind)) found = found .and. cell_of(line, 3) == kind
            if (found) cell = cell_of(line, k)
         end associate
         first = last + 1
      end do
   end function csv_cell

   !> The same as a number; huge where it is empty.
   real(wp) function csv_number(r, step, name, column, kind) result(value)
      type(run_t), intent(in) :: r
      integer, intent(in) :: step
      character(*), intent(in) :: name, column
      character(*), intent(in), optional :: kind
      character(:), allocatable :: cell
      integer :: status

      cell = csv_cell(r, step, name, column, kind)
      value = huge(value)
      if (len(cell) > 0) read (cell, *, iostat=status) value
      if (len(cell) > 0 .and. status /= 0) value = huge(value)
   end function csv_number

   !> Cell number `k` of a line, from 0 on.
   function cell_of(line, k) result(cell)
      character(*), intent(in) :: line
      integer, intent(in) :: k
      character(:), allocatable :: cell
      integer :: i, comma

      cell = line
      do i = 1, k
         comma = index(cell, ',')
         if (comma == 0) comma = len(cell)
         cell = cell(comma + 1:)
      end do
      comma = index(cell, ',')
      if (comma > 0) cell = cell(:comma - 1)
   end function cell_of

   !> The crank of the sample, pinned to the base at its origin, with `more` cards, and END.
   pure function crank_with(more) result(cards)
      character(80), intent(in) :: more(:)
      character(80) :: cards(6 + size(more)), all_cards(8)

      all_cards = sample()
      cards = [all_cards(:5), more, all_cards(8:)]
   end function crank_with

   !> The central crank-slider, crank 1 and rod 3, in RAD: its estimated angles; without drive, TIME and END.
   pure function slider(crank, rod) result(cards)
      character(*), intent(in) :: crank, rod
      character(80) :: cards(16)

      cards = [row('UNITS', 'M', 'RAD', 'S'), row('GROUND', 'BASE'), &
         row('LINK', 'CRANK', r1='0.0', r2='0.0', r3=crank), row('LINK', 'ROD', r1='0.9', r2='0.4', r3=rod), &
         row('LINK', 'PISTON', r1='3.5', r2='0.0', r3='0.0'), row('POINT', 'O', 'BASE'), &
         row('POINT', 'GUIDE', 'BASE'), row('POINT', 'C0', 'CRANK'), row('POINT', 'C1', 'CRANK', r1='1.0'), &
         row('POINT', 'R0', 'ROD'), row('POINT', 'R1', 'ROD', r1='3.0'), row('POINT', 'S', 'PISTON'), &
         row('REVOLUTE', 'O', 'C0', 'PO'), row('REVOLUTE', 'C1', 'R0', 'PC'), row('REVOLUTE', 'R1', 'S', 'PR'), &
         row('PRISM', 'GUIDE', 'S', 'PS')]
   end function slider

   !> The same, moved by its piston: x = `x` + `rate` t, by METHOD `method`, at `steps` + 1 instants from 0 to `t1`.
   pure function pushed_slider(crank, rod, x, rate, steps, t1, method) result(cards)
      character(*), intent(in) :: crank, rod, x, rate, steps, t1, method
      character(80) :: cards(21)

      cards = [slider(crank, rod), row('DRIVE', 'X', 'S', r1=x, r2=rate), row('TIME', steps, r1='0.0', r2=t1), &
         row('PRINT', 'LINKS'), row('METHOD', method), row('END')]
   end function pushed_slider
end module deck_runs
