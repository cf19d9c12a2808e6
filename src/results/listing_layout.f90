!> The layout of the tables of a set: digits, powers of ten, units, heads of columns.
!>
!> Digits: the deck's characteristic length and rate have seven digits. Positions, velocities and accelerations have the
!> decimals for this, and a power of ten if necessary. One mechanism in millimetres and in kilometres prints the same
!> digits.
module listing_layout
   use kinds, only: wp, label_length
   use plane_vectors, only: degree
   use mechanism, only: drive_t, settings_t, request_t
   use columns, only: row_column_t, columns_of_rows, forms, kinds_of_rows, table_of_links, table_turning, last_table, &
      last_dimension, quantities, of_drives => drives, is_ratio, usual_size, cell_none, last_cell, of_length, &
      of_angle, cell_words
   use independent, only: set_t
   use set_members, only: requests_of, row_form, row_subject, ratio_drive, drive_of, drive_title, sizes_of
   use drives, only: growing_sizes
   use names, only: more
   use scales, only: latest_time, is_length
   use number_format, only: numeral_length
   use text_output, only: output_t, put
   use table, only: format_t, choose_digits, power_text, unit_of, digits_after_first, order_margin
   use phrases
   implicit none
   private
   public :: layout_t, head_drive_t, new_layout, digits_t
   public :: row_title, line_length, name_length, table_row_length, end_of_column, column_name, column_unit, &
      column_format, column_word, line_starts,       angle_unit, choose_time_digits, write_folded

   !> The largest number of characters of a line.
   integer, parameter :: line_length = 120
   !> Characters before a row's numbers, and of a whole row.
   integer, parameter :: name_length = 9, table_row_length = name_length + 9*numeral_length
   !> If a table has rows of two forms, the columns of the second form stand so many places after the first ones.
   integer, parameter :: second_form_shift = 4
   !> If there are more drives, only so many stand at the head of an instant.
   integer, parameter :: max_drives = 6

   !> The digits of one independent mechanism.
   type :: digits_t
      type(format_t) :: format(last_dimension, 0:2)   !< (of_length, ...; derivative)
      !> By the kind of a table: the lines over its rows, joined by new_line('a').
      character(4*(table_row_length + 1)) :: heads(table_turning:last_table)
      integer :: head_length(table_turning:last_table) = 0
   end type digits_t

   !> A drive at the head of an instant.
   type :: head_drive_t
      character(:), allocatable :: before, after   !< the text before and after its value
      type(drive_t) :: law                 !< function of time
      type(format_t) :: format             !< of its value
      real(wp) :: size_of(0:1) = 0.0_wp    !< of the terms of its value, (0) + (1) |t|: their size
   end type head_drive_t

   !> The digits of the set, and of each of its independent mechanisms.
   type, extends(digits_t) :: layout_t
      type(digits_t), allocatable :: own(:)   !< (parts)
      type(format_t) :: time                  !< of the instants
      integer :: more_decimals = 0         !< of the effect of tolerances, in addition to the decimals of the number
      logical :: polish = .false.          !< the listing is in Polish
      integer :: links_table = table_turning   !< the kind of the tables of links
      integer :: shift(size(forms)) = 0    !< places that the columns of a form of rows are further on
      logical :: has(size(forms)) = .false.   !< the set has rows of this form
      character(label_length) :: unit(last_dimension) = ''   !< of lengths and angles; of the quantity of a ratio
      character(label_length + 4) :: per(last_dimension, 0:2) = ''   !< the divisor of the unit of a derivative
      logical :: per_below = .false.       !< the divisor is in a line below the unit, which is long
      character(numeral_length) :: words(cell_none:last_cell)   !< in the place of a number
      !> Of the line over the tables: ' INSTANT ' before the number of the instant, ' S' after its time.
      character(:), allocatable :: before_instant, after_time
      type(head_drive_t), allocatable :: drives(:)                !< the drives in that line
      character(:), allocatable :: more_drives                    !< ' AND 3 MORE', or ''
   end type layout_t

contains

   !> Makes the layout of the tables of a set.
   function new_layout(set) result(l)
      class(set_t), intent(in) :: set          !< only its deck counts
      type(layout_t) :: l
      type(request_t), allocatable :: requests(:)

      requests = requests_of(set)
      l%polish = set%polish
      l%words = cell_words%english
      if (set%polish) l%words = cell_words%polish
      l%words = adjustr(l%words)
      ! The effect of a tolerance has four digits.
      if (set%largest_tolerance > 0.0_wp) &
         l%more_decimals = max(0, 3 - digits_after_first - floor(log10(set%largest_tolerance)))
      call choose_own_digits(l, set, requests)
      call lay_out_tables()
      call write_instant()

   contains

      !> Chooses the table of links and the columns of tables with rows of two forms; then writes the lines over rows.
      subroutine lay_out_tables()
         integer :: i, k

         l%links_table = table_of_links(requests, requests%every > 0 .and. .not. requests%angle_alone)
         l%has([(row_form(set, i), i=1, size(requests))]) = .true.
         do k = table_turning, last_table
            associate (of_table => kinds_of_rows(k)%forms)
               if (of_table(2) == 0 .and. .not. is_ratio(of_table(1))) then
                  l%has(of_table(1)) = .true.
               else if (of_table(2) > 0 .and. l%has(of_table(1))) then
                  l%shift(of_table(2)) = second_form_shift
               end if
            end associate
         end do

         l%unit(:of_angle) = [character(label_length) :: set%length_unit, angle_unit(set)]
         do i = of_length, of_angle
            l%per(i, :) = [character(label_length + 4) :: '', '/'//set%time_unit, '/'//trim(set%time_unit)//'**2']
         end do
         l%per_below = maxval(len_trim(l%unit)) + len_trim(l%per(of_length, 2)) >= numeral_length
         ! The unit of a ratio is the unit of the quantity over the unit of the drive.
         do i = of_angle + 1, last_dimension
            l%unit(i) = l%unit(quantities(i))
            associate (by => l%unit(of_drives(i)))
               l%per(i, :1) = [character(label_length + 4) :: '/'//by, '/'//trim(by)//'**2']
            end associate
         end do
         do k = table_turning, last_table
            if (is_ratio(kinds_of_rows(k)%forms(1)) .and. .not. l%has(kinds_of_rows(k)%forms(1))) cycle
            do i = 1, set%count
               call write_table_heads(l, l%own(i), k)
            end do
         end do
      end subroutine lay_out_tables

      !> Writes the texts of the line over the tables of an instant: time and drives.
      subroutine write_instant()
         type(drive_t) :: law
         real(wp) :: sizes(3, 0:1)
         integer :: k, dimension

         call choose_time_digits(set, l%time)
         l%before_instant = ' '//phrase(text_instant, set%polish)//' '
         l%after_time = ' '//unit_of(l%time%power, trim(set%time_unit))
         allocate (l%drives(min(size(set%drives), max_drives)))
         do k = 1, size(l%drives)
            law = drive_of(set, k)
            associate (d => l%own(set%drives(k)%part), drive => l%drives(k))
               dimension = merge(of_length, of_angle, is_length(law))
               drive%law = law
               drive%format = d%format(dimension, 0)
               drive%before = '   '//drive_title(set, k)//' = '
               drive%after = ' '//unit_of(drive%format%power, trim(l%unit(dimension)))
               sizes = growing_sizes(law, latest_time(set))
               drive%size_of = sizes(1, :)
            end associate
         end do
         l%more_drives = more(size(set%drives) - size(l%drives), set%polish)
      end subroutine write_instant
   end function new_layout

   !> Chooses the digits of each part of the set. If the decimals of parts differ by at most one, all have those of
   !> the largest part.
   subroutine choose_own_digits(l, set, requests)
      type(layout_t), intent(inout) :: l     !< gets `own` and the components of `digits_t`
      class(set_t), intent(in) :: set        !< divided
      type(request_t), intent(in) :: requests(:)   !< (rows of the set)
      type(format_t) :: largest(of_length:of_angle, 0:2)
      real(wp) :: sizes(2), angle   ! the characteristic length and rate
      integer :: c, k, i
      logical :: mixed

      angle = merge(degree, 1.0_wp, set%degrees)
      allocate (l%own(set%count))
      do c = 1, set%count
         sizes = sizes_of(set, c)
         associate (f => l%own(c)%format)
            do k = 0, 2
               f(:, k) = [format_t(), format_t(is_angle=.true., unit=angle)]
               call choose_digits(log10(sizes(1)) + k*log10(sizes(2)), l%more_decimals, f(of_length, k))
               call choose_digits(k*log10(sizes(2)) + log10(merge(1.0_wp/angle, 1.0_wp, k > 0)), l%more_decimals, &
                  f(of_angle, k))
            end do

            if (.not. any(requests%drive > 0 .and. set%rows%part == c)) cycle
            do i = of_angle + 1, last_dimension
               do k = 0, 1
                  call choose_digits(log10(usual_size(i, k, sizes(1), sizes(2), set%degrees)), 0, f(i, k))
               end do
            end do
         end associate
      end do

      l%digits_t = l%own(1)
      largest = l%own(1)%format(:of_angle, :)
      mixed = .false.
      do c = 2, set%count
         associate (all_of => l%format(:of_angle, :), own => l%own(c)%format(:of_angle, :))
            mixed = mixed .or. any(own%power /= l%own(1)%format(:of_angle, :)%power)
            all_of%decimals = min(all_of%decimals, own%decimals)
            largest%decimals = max(largest%decimals, own%decimals)
         end associate
      end do
      if (mixed .or. any(largest%decimals - l%format(:of_angle, :)%decimals > 1)) return
      do c = 1, set%count
         l%own(c)%format(:of_angle, :) = l%format(:of_angle, :)
      end do
   end subroutine choose_own_digits

   !> Names a row: its link, point, pair or measure, of a ratio with its drive: MU BY ANGLE CRANK.
   function row_title(set, i) result(name)
      class(set_t), intent(in) :: set        !< of the row
      integer, intent(in) :: i               !< number of the row in the set
      character(:), allocatable :: name
      integer :: drive

      name = trim(row_subject(set, i))
      drive = ratio_drive(set, i)
      if (drive > 0) name = name//' '//phrase(text_by, set%polish)//' '//drive_title(set, drive)
   end function row_title

   !> Gives the digits of a column of a row.
   pure type(format_t) function column_format(l, set, i, column)
      type(layout_t), intent(in) :: l        !< of the set
      class(set_t), intent(in) :: set        !< of the row
      integer, intent(in) :: i               !< number of the row in the set
      class(row_column_t), intent(in) :: column   !< of the row

      column_format = l%own(set%rows(i)%part)%format(column%dimension, column%order)
   end function column_format

   !> Writes the lines over rows in tables of one kind: names, powers of ten if there are any, units.
   subroutine write_table_heads(l, digits, kind)
      type(layout_t), intent(in) :: l        !< of the set
      type(digits_t), intent(inout) :: digits     !< of a part: its formats; gets the lines
      integer, intent(in) :: kind            !< of the table: table_turning, request_link, ...
      character(table_row_length) :: lines(4)
      integer :: i, j, n

      lines = ''
      lines(1) = ' '//column_word(kinds_of_rows(kind)%english, kinds_of_rows(kind)%polish, l%polish)
      do i = 1, 2
         n = kinds_of_rows(kind)%forms(i)
         if (n == 0) exit
         if (.not. l%has(n)) cycle

         do j = forms(n)%first, forms(n)%last
            associate (c => columns_of_rows(j), last => end_of_column(l, n, j))
               if (c%place == 0) cycle
               associate (power => digits%format(c%dimension, c%order)%power)
                  call write_word(lines(1), column_name(l, c), last)
                  if (power /= 0) call write_word(lines(2), power_text(power), last)
                  if (l%per_below) then
                     call write_word(lines(3), trim(l%unit(c%dimension)), last)
                     call write_word(lines(4), trim(l%per(c%dimension, c%order)), last)
                  else
                     call write_word(lines(3), column_unit(l, c), last)
                  end if
               end associate
            end associate
         end do
      end do

      digits%heads(kind) = lines(1)
      n = len_trim(lines(1))
      do i = 2, size(lines)
         ! The line of units is always there.
         if (lines(i) == '' .and. i /= 3) cycle
         digits%heads(kind)(n + 1:) = new_line('a')//lines(i)
         n = n + 1 + len_trim(lines(i))
      end do
      digits%head_length(kind) = n

   contains

      !> Writes a word to a line, over the characters that are there.
      pure subroutine write_word(line, word, last)
         character(*), intent(inout) :: line   !< with room for the word
         character(*), intent(in) :: word    !< without blanks
         integer, intent(in) :: last         !< the character of the line at which the word ends

         line(last - len(word) + 1:last) = word
      end subroutine write_word
   end subroutine write_table_heads

   !> Finds the last character of a column in a line of the listing.
   pure integer function end_of_column(l, form, j)
      type(layout_t), intent(in) :: l        !< of the set
      integer, intent(in) :: form            !< of the rows: row_link, ...
      integer, intent(in) :: j               !< the column, in `columns_of_rows`

      end_of_column = kinds_of_rows(forms(form)%kind)%names*name_length &
         + numeral_length*(columns_of_rows(j)%place + l%shift(form))
   end function end_of_column

   !> Gives the head of a column.
   pure function column_name(l, column) result(name)
      type(layout_t), intent(in) :: l        !< of the set
      type(row_column_t), intent(in) :: column        !< the column of a row
      character(:), allocatable :: name

      name = column_word(column%english, column%polish, l%polish)
   end function column_name

   !> Gives the unit of a column, without its power of ten.
   pure function column_unit(l, column) result(unit)
      type(layout_t), intent(in) :: l        !< of the set
      type(row_column_t), intent(in) :: column        !< the column of a row
      character(:), allocatable :: unit

      unit = trim(l%unit(column%dimension))//trim(l%per(column%dimension, column%order))
   end function column_unit

   !> Chooses between two words by the language of the listing.
   pure function column_word(english, polish, is_polish) result(word)
      character(*), intent(in) :: english, polish   !< the words
      logical, intent(in) :: is_polish       !< the listing is in Polish
      character(:), allocatable :: word

      word = trim(english)
      if (is_polish) word = trim(polish)
   end function column_word

   !> Chooses the digits of times: as many as other numbers have, and as many as show two digits of the shortest step,
   !> or one, if there is room for them. If all times are 0, the format is the default. Reason: two instants must not
   !> show the same time.
   pure subroutine choose_time_digits(settings, format)
      class(settings_t), intent(in) :: settings     !< of the set: the instants
      type(format_t), intent(out) :: format       !< of the times of the set
      integer :: before, room, needed

      associate (time => latest_time(settings))
         if (.not. time > 0.0_wp) return
         call choose_digits(log10(time), 0, format)
         before = max(1, 1 + digits_after_first - format%decimals)
         ! In addition there are the point and a blank; a time below zero has a sign.
         room = numeral_length - 2 - before - merge(1, 0, min(settings%t0, settings%t1, minval(settings%at)) < 0.0_wp)
         needed = format%power + 1 + ceiling(-log10(shortest_step(settings)) - order_margin)
         if (needed <= room + 1) format%decimals = max(format%decimals, min(room, needed))
      end associate
   end subroutine choose_time_digits

   !> Gives the deck's unit of angles.
   pure character(label_length) function angle_unit(settings)
      class(settings_t), intent(in) :: settings     !< of the deck

      angle_unit = merge('DEG', 'RAD', settings%degrees)
   end function angle_unit

   !> Finds the first column of each line of a table that is wider than a line (lines + 1): each line begins with column
   !> 1. The last element is the number of columns plus one.
   pure function line_starts(before, widths) result(starts)
      integer, intent(in) :: before          !< characters of a line before its other columns
      integer, intent(in) :: widths(:)       !< (columns) characters; 0: the column is not in the table
      integer, allocatable :: starts(:)
      integer :: used, i

      allocate (starts(0))
      used = line_length
      do i = 2, size(widths)
         used = used + widths(i)
         if (used <= line_length .or. widths(i) == 0) cycle
         starts = [starts, i]
         used = before + widths(i)
      end do
      starts = [starts, size(widths) + 1]
   end function line_starts

   !> Writes a sentence in one line, or in several if the sentence is long. A line ends before three blanks; without
   !> these, after a colon in its second half; without such a colon, before a blank.
   subroutine write_folded(o, mark, text, next)
      type(output_t), intent(inout) :: o     !< gets the lines
      character(*), intent(in) :: mark       !< the beginning of the first line
      character(*), intent(in) :: text       !< the sentence
      character(*), intent(in), optional :: next   !< the beginning of further lines; without it they begin with `mark`
      character(:), allocatable :: head, rest
      integer :: room, last

      head = mark
      rest = text
      do
         room = line_length - len(head)
         last = len(rest)
         if (last > room) then
            last = index(rest(:room + 1), '   ', back=.true.) - 1
            if (last <= 0) then
               last = index(rest(:room + 1), ': ', back=.true.)
               if (last < room/2) last = index(rest(:room + 1), ' ', back=.true.) - 1
            end if
         end if
         call put(o, head//rest(:last))
         if (last == len(rest)) return
         rest = trim(adjustl(rest(last + 1:)))
         if (present(next)) head = next
      end do
   end subroutine write_folded

   !> Finds the shortest step from an instant to the next one in the deck's order, in the deck's unit of time. Steps of
   !> length 0 do not count. Without a step it is the largest number.
   pure real(wp) function shortest_step(settings) result(step)
      class(settings_t), intent(in) :: settings   !< of the set: the instants
      real(wp), allocatable :: times(:), steps(:)

      times = settings%at
      if (settings%steps >= 0) times = [settings%t1, settings%at]
      steps = abs(times(2:) - times(:size(times) - 1))
      if (settings%steps > 0) steps = [steps, abs(settings%t1 - settings%t0)/real(settings%steps, wp)]
      step = minval(steps, mask=steps > 0.0_wp)
   end function shortest_step
end module listing_layout
