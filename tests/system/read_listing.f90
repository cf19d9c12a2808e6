!> Tests. `read_listing LISTING CSV [LEAST]`: every number of the listing is the value in the CSV of the same run, rounded to
!> the digits that are printed; both have the rows that the PRINT cards ask for, in their order, and `LEAST` numbers or
!> more. It prints how many numbers there are, and how many of them are masked or do not exist; or the first thing that
!> is wrong, with status 1.
program read_listing
   use, intrinsic :: iso_fortran_env, only: real128
   use csv_cells, only: cells, cell_length, split, whole_text
   use echoed_deck, only: kind_of_row
   use echoed_deck, only: due_t
   use listing_reader, only: row_text_t, set_text_t, next_set
   use printed_numbers, only: printed_t, read_printed, agrees
   implicit none
   character(*), parameter :: csv_head = 'set,step,t,kind,name,x,y,phi,vx,vy,vphi,ax,ay,aphi,mark'
   character(500) :: path, line
   type(set_text_t) :: set
   integer :: listing, csv, status, numbers, masked, absent, least
   logical :: found

   call get_command_argument(1, path)
   open (newunit=listing, file=path, status='old', action='read')
   call get_command_argument(2, path)
   open (newunit=csv, file=path, status='old', action='read')
   least = 1
   call get_command_argument(3, path)
   if (path /= '') read (path, *) least
   read (csv, '(a)') line
   if (line /= csv_head) call give_up('THE CSV HAS OTHER COLUMNS')
   numbers = 0
   masked = 0
   absent = 0
   do
      call next_set(listing, set, found)
      if (.not. found) exit
      if (allocated(set%wrong)) call give_up(set%wrong)
      call compare_set(set)
   end do
   call next_row(line, status)
   if (status == 0) call give_up('THE LISTING HAS NO ROW FOR '//trim(line))
   if (numbers + absent < least) call give_up('FEWER NUMBERS THAN THERE MUST BE')
   print '(i0,a,i0,a,i0,a)', numbers, ' numbers, ', masked, ' masked, ', absent, ' absent'

contains

   !> The rows of a set against what its deck asks for and against the next rows of the CSV.
   subroutine compare_set(set)
      type(set_text_t), intent(in) :: set
      character(5), parameter :: spreads(0:2) = [character(5) :: '', 'WORST', 'RSS']
      logical :: was_absent(size(set%deck%requests))
      integer :: step, i, k, n

      was_absent = .false.
      if (set%instants < 1) call give_up('THE LISTING OF A SET HAS NO END')
      k = 0
      do step = 0, set%instants - 1
         do i = 1, size(set%deck%requests)
            associate (due => set%deck%requests(i))
               if (mod(step, due%every) /= 0 .and. step /= set%instants - 1) cycle
               do n = 0, merge(2, 0, set%deck%tolerances)
                  if (.not. is_row_of(set, k + 1, step, due, spreads(n))) then
                     ! Beyond a limit the listing has a row without values at the first instant only.
                     if (was_absent(i) .and. has_no_value(step, due, spreads(n))) cycle
                  end if
                  k = k + 1
                  if (k > set%row_count) call give_up('THE LISTING HAS TOO FEW ROWS')
                  if (.not. is_row_of(set, k, step, due, spreads(n))) &
                     call give_up('ANOTHER ROW THAN ASKED FOR: '//shown(set%rows(k)))
                  call compare_row(set%number, set%rows(k))
                  if (n == 0) was_absent(i) = all(set%rows(k)%word == '' .or. set%rows(k)%word == 'NONE' &
                     .or. set%rows(k)%word == 'BRAK')
               end do
               if (set%deck%tolerances) call pass_sensitivities
            end associate
         end do
      end do
      if (k /= set%row_count) call give_up('MORE ROWS THAN ASKED FOR: '//shown(set%rows(k + 1)))
   end subroutine compare_set

   !> Whether row `k` of the listing is that of the request `due` at the instant `step`.
   logical function is_row_of(set, k, step, due, spread)
      type(set_text_t), intent(in) :: set
      integer, intent(in) :: k, step
      type(due_t), intent(in) :: due
      character(*), intent(in) :: spread

      is_row_of = .false.
      if (k > set%row_count) return
      associate (row => set%rows(k))
         is_row_of = row%step == step .and. row%kind == due%kind .and. row%name == due%name .and. row%spread == spread
      end associate
   end function is_row_of

   !> Passes over the next row of the CSV, which must be that of the request `due` at the instant `step`, if it has no
   !> value; otherwise it is read again.
   logical function has_no_value(step, due, spread)
      integer, intent(in) :: step
      type(due_t), intent(in) :: due
      character(*), intent(in) :: spread
      character(cell_length) :: cell(cells)
      integer :: status

      call next_row(line, status)
      has_no_value = .false.
      if (status /= 0) return
      call split(line, cell, status)
      has_no_value = cell(2) == whole_text(step) .and. cell(4) == trim(kind_of_row(due%kind))//' '//spread &
         .and. cell(5) == due%name .and. all(cell(6:14) == '') .and. (cell(15) /= '' .or. spread /= '')
      if (.not. has_no_value) backspace (csv)
   end function has_no_value

   !> The rows of the CSV that the listing does not have: one for each number with a tolerance, one at least.
   subroutine pass_sensitivities
      integer :: status, passed

      passed = -1
      do
         read (csv, '(a)', iostat=status) line
         passed = passed + 1
         if (status /= 0) exit
         if (index(line, ' PER ') == 0) then
            backspace (csv)
            exit
         end if
      end do
      if (passed == 0) call give_up('THE CSV HAS NO SENSITIVITIES')
   end subroutine pass_sensitivities

   !> The next line of the CSV, but those of POLE and CURVE cards.
   subroutine next_row(line, status)
      character(*), intent(out) :: line
      integer, intent(out) :: status
      character(8), parameter :: centres(*) = [character(8) :: 'POLE', 'POLE-I', 'POLE-J', 'CURVE', 'CENTRE', 'RADIUS']
      character(cell_length) :: cell(cells)

      do
         read (csv, '(a)', iostat=status) line
         if (status /= 0) return
         call split(line, cell, status)
         if (all(cell(4) /= centres)) exit
      end do
      status = 0
   end subroutine next_row

   !> One row against the next one of the CSV.
   subroutine compare_row(number, row)
      integer, intent(in) :: number
      type(row_text_t), intent(in) :: row
      character(cell_length) :: cell(cells)
      integer :: i, status

      call next_row(line, status)
      if (status /= 0) call give_up('THE CSV HAS NO ROW FOR '//shown(row))
      call split(line, cell, status)
      if (cell(1) /= whole_text(number) .or. cell(2) /= whole_text(row%step) .or. cell(4) /= trim(kind_of_row(row%kind)) &
         //' '//row%spread .or. cell(5) /= row%name) call give_up('THE CSV HAS ANOTHER ROW: '//trim(line)//', NOT '//shown(row))
      call compare_number(row%time, cell(3), row%time_power, row)
      do i = 1, 9
         if (row%word(i) == '') then
            if (cell(5 + i) /= '') call give_up('NOT PRINTED: '//trim(cell(5 + i))//' OF '//shown(row))
            cycle
         end if
         call count_number(read_printed(trim(row%word(i))))
         call compare_number(row%word(i), cell(5 + i), row%power(i), row)
      end do
      if (row%spread /= '') return
      if (cell(15) == 'UNKNOWN') then
         if (.not. any(has_no_digit(row%word))) call give_up('A NUMBER IS KNOWN: '//trim(line))
      else if (any(cell(15) == [character(6) :: '', 'STROKE']) .eqv. any(row%word == 'NONE' .or. row%word == 'BRAK' &
         .or. row%word == 'COINCIDE' .or. row%word == 'POKRYCIE')) then
         call give_up('THE MARK DOES NOT FIT: '//trim(line))
      end if
   end subroutine compare_row

   !> All digits of the printed `word` are masked.
   elemental logical function has_no_digit(word)
      character(*), intent(in) :: word

      has_no_digit = index(word, '?') > 0 .and. scan(word, '0123456789') == 0
   end function has_no_digit

   !> The printed `word` against the `cell` of the CSV.
   subroutine compare_number(word, cell, power, row)
      character(*), intent(in) :: word, cell
      integer, intent(in) :: power
      type(row_text_t), intent(in) :: row
      type(printed_t) :: p
      real(real128) :: x
      integer :: status

      p = read_printed(trim(word))
      if (cell == '') then
         if (.not. (p%none .or. has_no_digit(word))) call give_up('PRINTED BUT NOT IN THE CSV: '//trim(word)//' OF '//shown(row))
         return
      end if
      read (cell, *, iostat=status) x
      if (status /= 0) call give_up('NO NUMBER IN THE CSV: '//trim(cell))
      if (.not. agrees(p, power, x)) &
         call give_up(trim(word)//' IS NOT '//trim(cell)//' OVER 10**'//whole_text(power)//': '//shown(row))
   end subroutine compare_number

   subroutine count_number(p)
      type(printed_t), intent(in) :: p

      if (p%none) then
         absent = absent + 1
      else
         numbers = numbers + 1
      end if
      if (p%masked > 0) masked = masked + 1
   end subroutine count_number

   pure function shown(row) result(text)
      type(row_text_t), intent(in) :: row
      character(:), allocatable :: text

      text = trim(kind_of_row(row%kind))//' '//trim(row%name)//' AT INSTANT '//whole_text(row%step)
   end function shown

   !> Ends the program with what is wrong.
   subroutine give_up(text)
      character(*), intent(in) :: text

      print '(a)', text
      stop 1, quiet=.true.
   end subroutine give_up
end program read_listing
