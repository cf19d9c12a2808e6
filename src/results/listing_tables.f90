!> The tables of the listing: the line over those of an instant, heads of columns with powers of ten and units, rows.
module listing_tables
   use kinds, only: wp
   use drives, only: drive_motion
   use mechanism, only: settings_t
   use columns, only: columns_of_rows, forms, kinds_of_rows, is_ratio, cell_of, cell_number, cell_spare
   use points, only: row_t
   use text_output, only: output_t, put
   use number_format, only: write_fixed, numeral_length
   use masked_numbers, only: nothing_known, unknown_digit
   use table, only: format_t, write_cell, write_number, number_text
   use listing_layout
   use phrases, only: phrase, text_by, text_unknown, text_unclosed
   implicit none
   private
   public :: listing_state_t, no_table, lines_a_head, write_times, write_heads, write_row, time_text, drive_text, &
      law_error, mask_words

   !> Between two times, or the values of a drive at these.
   character(4), parameter :: between = ' .. '
   !> Heads stand again after so many lines.
   integer, parameter :: lines_a_head = 60

   !> The next row has no heads yet.
   integer, parameter :: no_table = -1

   !> The state of the listing above the next row: the heads that hold for it, and how far above they are.
   type :: listing_state_t
      integer :: kind = no_table           !< the kind of the table of these heads: table_turning, request_link, ...
      integer :: part = 0                  !< the part of the last of these heads
      integer :: lines = 0                 !< lines since these heads
      logical :: masked = .false.          !< some digit of the instant is a question mark
      logical :: surplus = .false.         !< a surplus drive has been reported
      integer :: explained = 0                  !< the last instant whose reason for no values is printed
      integer :: first = -1, last = -1     !< later instants without values, which have no line yet; -1: none
      real(wp), allocatable :: limits(:)   !< (parts) the limit of motion before the last instant; huge: none
   end type listing_state_t

contains

   !> Writes a blank line, and a line with times and the values of the drives then; if they are many they go on in
   !> further lines. The lines have a fixed length: text that grows would cost as much as a table.
   subroutine write_times(o, l, start, times, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l        !< of the set
      character(*), intent(in) :: start      !< the beginning of the line
      real(wp), intent(in) :: times(:)       !< (1 or 2) in the deck's unit
      type(listing_state_t), intent(inout) :: table   !< gets `lines` and `masked`
      character(line_length) :: line, part
      real(wp) :: f(3)
      integer :: i, k, used, length

      call put(o, '')
      used = 0
      call append(start, line, used)
      call append('   T = ', line, used)
      do k = 1, size(times)
         if (k > 1) call append(between, line, used)
         call append_number(l%time, times(k), 0.0_wp, line, used, table%masked)
      end do
      call append(l%after_time, line, used)

      do i = 1, size(l%drives)
         length = 0
         call append(l%drives(i)%before, part, length)
         do k = 1, size(times)
            if (k > 1) call append(between, part, length)
            associate (d => l%drives(i))
               f = drive_motion(d%law, times(k))
               call append_number(d%format, f(1), law_error(d, times(k)), part, length, table%masked)
            end associate
         end do
         call append(l%drives(i)%after, part, length)
         if (i == size(l%drives)) call append(l%more_drives, part, length)

         if (used + length > line_length) then
            call put(o, line(:used))
            table%lines = table%lines + 1
            used = len(start)
            line(:used) = ''
         end if
         call append(part(:length), line, used)
      end do

      call put(o, line(:used))
      table%lines = table%lines + 2
   end subroutine write_times

   !> Appends a text to a line.
   pure subroutine append(text, line, used)
      character(*), intent(in) :: text       !< with its blanks
      character(*), intent(inout) :: line    !< with room for the text
      integer, intent(inout) :: used         !< the characters of the line that are written

      line(used + 1:used + len(text)) = text
      used = used + len(text)
   end subroutine append

   !> Appends a number without blanks to a line.
   pure subroutine append_number(format, value, error, line, used, masked)
      type(format_t), intent(in) :: format   !< of the number
      real(wp), intent(in) :: value              !< the number, in the deck's units and rad
      real(wp), intent(in) :: error          !< the rounding error of `value`
      character(*), intent(inout) :: line    !< with room for the number
      integer, intent(inout) :: used         !< the characters of the line that are written
      logical, intent(inout) :: masked       !< becomes true if a digit is masked
      character(numeral_length) :: number

      call write_number(format, 0, value, error, number, masked)
      call append(number(verify(number, ' '):), line, used)
   end subroutine append_number

   !> Bounds the error of the value of a drive by roundings of its numbers and of the time, in rad or lengths.
   pure real(wp) function law_error(drive, t) result(error)
      type(head_drive_t), intent(in) :: drive   !< of the head of an instant
      real(wp), intent(in) :: t              !< the time, in the deck's unit

      error = epsilon(1.0_wp)*(drive%size_of(0) + drive%size_of(1)*abs(t))
   end function law_error

   !> Gives a time with the digits of the set, without blanks.
   pure function time_text(l, t, error) result(text)
      type(layout_t), intent(in) :: l        !< of the set
      real(wp), intent(in) :: t              !< time, in the deck's unit
      real(wp), intent(in), optional :: error   !< error of the time; without it 0
      character(:), allocatable :: text
      real(wp) :: unknown

      unknown = 0.0_wp
      if (present(error)) unknown = error
      text = number_text(l%time, t, unknown)
   end function time_text

   !> Gives the value of a drive at a time, without blanks; question marks if the error of the time is unknown.
   pure function drive_text(drive, t, error) result(text)
      type(head_drive_t), intent(in) :: drive   !< of the head of an instant
      real(wp), intent(in) :: t              !< the time, in the deck's unit
      real(wp), intent(in) :: error          !< the error of the time
      character(:), allocatable :: text
      real(wp) :: f(3), unknown

      f = drive_motion(drive%law, t)
      unknown = nothing_known
      ! No time is as long as the square root, whose square is in the range of reals.
      if (error < sqrt(nothing_known)) &
         unknown = law_error(drive, t) + abs(f(2))*error + 0.5_wp*abs(f(3))*error**2
      text = number_text(drive%format, f(1), unknown)
   end function drive_text

   !> Writes the heads over rows, unless they stand there: names, powers of ten if there are any, units.
   subroutine write_heads(o, l, part, kind, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l        !< of the set
      integer, intent(in) :: part            !< the independent mechanism of the rows
      integer, intent(in) :: kind            !< of the table of the rows: table_turning, request_link, ...
      type(listing_state_t), intent(inout) :: table   !< as the rows before have left it; gets these heads
      logical :: stand

      stand = kind == table%kind
      if (stand .and. part /= table%part) stand = l%own(part)%heads(kind) == l%own(table%part)%heads(kind)
      table%kind = kind
      table%part = part
      if (stand) return
      call put(o, l%own(part)%heads(kind)(:l%own(part)%head_length(kind)))
      table%lines = 0
   end subroutine write_heads

   !> Writes a row. A number that is not known is a word; a column that the row does not have is blank.
   subroutine write_row(o, l, digits, row, form, error, more, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l        !< of the set
      type(digits_t), intent(in) :: digits   !< of the part of the row
      class(row_t), intent(in) :: row        !< the row
      integer, intent(in) :: form            !< of the row in the listing: row_link, ...
      integer, intent(in) :: more            !< decimals in addition to those of `digits`
      real(wp), intent(in) :: error(3, 0:2)  !< the rounding error of the row's value
      type(listing_state_t), intent(inout) :: table   !< with the heads of the row; gets `lines` and `masked`
      character(table_row_length) :: line
      real(wp) :: value
      integer :: j, cell, start, last, end_of

      ! One name, or two in columns of their own.
      line(1:1) = ' '
      line(2:) = row%name
      end_of = kinds_of_rows(row%kind)%names*name_length
      if (is_ratio(form)) then
         j = index(row%name, ' ')
         line(j + 1:) = ' '//phrase(text_by, l%polish)//row%name(index(row%name, ' BY ') + 3:)
      else if (end_of > name_length) then
         j = index(row%name, ' ')
         line(j + 1:) = ''
         line(name_length + 1:) = ' '//row%name(j + 1:)
      end if

      ! Found once for all columns, since it takes as long as a number.
      start = end_of + numeral_length*l%shift(form)
      do j = forms(form)%first, forms(form)%last
         associate (c => columns_of_rows(j), x => row%value(columns_of_rows(j)%at(1), columns_of_rows(j)%at(2)), &
            off => error(columns_of_rows(j)%at(1), columns_of_rows(j)%at(2)))
            if (c%place == 0) cycle
            cell = cell_of(c, row%known, row%state)
            if (cell == cell_spare .and. error(1, 0) >= nothing_known) cell = cell_number
            last = start + numeral_length*c%place
            end_of = max(end_of, last)
            associate (f => digits%format(c%dimension, c%order), field => line(last - numeral_length + 1:last))
               if (cell == cell_number .and. .not. off > 0.0_wp) then
                  ! Nearly all cells: as `write_cell`, without the call.
                  value = x
                  if (f%is_angle) value = value/f%unit
                  call write_fixed(value, f%decimals + more, f%power, field)
               else
                  call write_cell(f, more, cell, x, off, l%words, field, table%masked)
               end if
            end associate
         end associate
      end do

      ! Without the copy of the line that `trim` would make.
      call put(o, line(:len_trim(line(:end_of))))
      table%lines = table%lines + 1
   end subroutine write_row

   !> Gives the line that explains the mark of an unknown digit.
   function mask_words(settings) result(line)
      class(settings_t), intent(in) :: settings   !< of the set: language and closing tolerance
      character(:), allocatable :: line

      line = ' --- '//unknown_digit//': '//phrase(text_unknown, settings%polish)
      if (settings%closing > 0.0_wp) line = ' --- '//unknown_digit//': '//phrase(text_unclosed, settings%polish)
   end function mask_words
end module listing_tables
