!> The tables of the listing: the line over those of an instant, heads of columns with powers of ten and units, rows.
module listing_tables
   use kinds, only: wp
   use mechanism, only: request_pair, request_pole, request_curve
   use drives, only: drive_motion
   use points, only: row_t, has_number
   use instant_centres, only: centre_finite, centre_infinite
   use text_output, only: output_t, put
   use numerals, only: whole, put_fixed, numeral_length
   use known_digits, only: put_known, unknown_digit, nothing_known
   use listing_layout
   use phrases, only: phrase, say_at_rest, say_infinite
   implicit none
   private
   public :: listing_state_t, no_table, put_instant, put_times, put_heads, put_row, time_text, &
      drive_text, known_text

   character(4), parameter :: between = ' .. '
   !> Heads stand again after so many lines.
   integer, parameter :: lines_a_head = 60

   !> No heads hold for the next row.
   integer, parameter :: no_table = -1

   !> What a reader of the listing sees above the next row: the heads that hold for it, and how far above they are.
   type :: listing_state_t
      integer :: kind = no_table           !< of the rows below the heads: request_link, ..., or links_turning
      integer :: part = 0                  !< of the last of them
      integer :: lines = 0                 !< since the heads
      logical :: masked = .false.          !< some digit of the instant is a question mark
      integer :: told = 0                  !< the last instant that told why it has no values
      integer :: first = -1, last = -1     !< instants after it without values, which have no line yet; -1: none
      real(wp), allocatable :: limits(:)   !< (parts) the limit of motion before the last instant; huge: none
   end type listing_state_t

contains

   !> The line over the tables of instant number `step`, at `t` in the deck's unit: the time and the values of the
   !> drives. Heads that are far above do not hold any more.
   subroutine put_instant(o, l, t, step, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      real(wp), intent(in) :: t
      integer, intent(in) :: step
      type(listing_state_t), intent(inout) :: table

      if (table%lines >= lines_a_head) table%kind = no_table
      call put_times(o, l, l%before_instant//whole(step), [t], table)
   end subroutine put_instant

   !> A blank line, and one with `start`, the `times` (1 or 2, in the deck's unit) and the values of the drives then,
   !> which go on in the next line where they are many. Written into lines of their own, since text that grows would
   !> cost as much as a table.
   subroutine put_times(o, l, start, times, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      character(*), intent(in) :: start
      real(wp), intent(in) :: times(:)
      type(listing_state_t), intent(inout) :: table
      character(line_length) :: line, part
      real(wp) :: f(3)
      integer :: i, k, used, length

      call put(o, '')
      used = 0
      call append(start, line, used)
      call append('   T = ', line, used)
      do k = 1, size(times)
         if (k > 1) call append(between, line, used)
         call append_number(times(k), 0.0_wp, l%time_decimals, l%time_power, line, used, table%masked)
      end do
      call append(l%behind_time, line, used)
      do i = 1, size(l%drives)
         length = 0
         call append(l%drives(i)%before, part, length)
         do k = 1, size(times)
            if (k > 1) call append(between, part, length)
            associate (d => l%drives(i))
               f = drive_motion(d%law, times(k))
               call append_number(f(1)/d%unit, law_error(d, times(k))/d%unit, d%decimals, d%power, part, length, &
                  table%masked)
            end associate
         end do
         call append(l%drives(i)%behind, part, length)
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
   end subroutine put_times

   !> Writes `text` behind the first `used` characters of `line`, and counts it among them.
   pure subroutine append(text, line, used)
      character(*), intent(in) :: text
      character(*), intent(inout) :: line
      integer, intent(inout) :: used

      line(used + 1:used + len(text)) = text
      used = used + len(text)
   end subroutine append

   !> Appends the number `x`, of which `error` is unknown, without blanks.
   pure subroutine append_number(x, error, decimals, power, line, used, masked)
      real(wp), intent(in) :: x, error
      integer, intent(in) :: decimals, power
      character(*), intent(inout) :: line
      integer, intent(inout) :: used
      logical, intent(inout) :: masked
      character(numeral_length) :: number

      call put_known(x, error, decimals, power, number, masked)
      call append(number(verify(number, ' '):), line, used)
   end subroutine append_number

   !> Bounds what roundings of its numbers and of the time `t` leave open of the value of the drive `d`, in radians
   !> or in the unit of length.
   pure real(wp) function law_error(d, t) result(error)
      type(head_drive_t), intent(in) :: d
      real(wp), intent(in) :: t

      error = epsilon(1.0_wp)*(d%size_of(0) + d%size_of(1)*abs(t))
   end function law_error

   !> A time with the digits of the set, without blanks; `error`, where it is given, is unknown of it.
   pure function time_text(l, t, error) result(text)
      type(layout_t), intent(in) :: l
      real(wp), intent(in) :: t
      real(wp), intent(in), optional :: error
      character(:), allocatable :: text
      real(wp) :: unknown

      unknown = 0.0_wp
      if (present(error)) unknown = error
      text = known_text(t, l%time_decimals, l%time_power, unknown)
   end function time_text

   !> The value of the drive `d` at the time `t`, without blanks; `error` of the time.
   pure function drive_text(d, t, error) result(text)
      type(head_drive_t), intent(in) :: d
      real(wp), intent(in) :: t, error
      character(:), allocatable :: text
      real(wp) :: f(3), unknown

      f = drive_motion(d%law, t)/d%unit
      unknown = nothing_known
      ! No time is as long as the square root, whose square is in the range of reals.
      if (error < sqrt(nothing_known)) &
         unknown = law_error(d, t)/d%unit + abs(f(2))*error + 0.5_wp*abs(f(3))*error**2
      text = known_text(f(1), d%decimals, d%power, unknown)
   end function drive_text

   !> A number without blanks, of which `error` is unknown.
   pure function known_text(x, decimals, power, error) result(text)
      real(wp), intent(in) :: x, error
      integer, intent(in) :: decimals, power
      character(:), allocatable :: text
      character(numeral_length) :: field

      call put_known(x, error, decimals, power, field)
      text = trim(adjustl(field))
   end function known_text

   !> The heads over rows of this `kind` and `part`, unless they stand there: names, powers of ten where there are any,
   !> units.
   subroutine put_heads(o, l, part, kind, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      integer, intent(in) :: part, kind
      type(listing_state_t), intent(inout) :: table
      logical :: stand

      stand = kind == table%kind
      if (stand .and. part /= table%part) stand = l%own(part)%heads(kind) == l%own(table%part)%heads(kind)
      table%kind = kind
      table%part = part
      if (stand) return
      call put(o, l%own(part)%heads(kind)(:l%own(part)%head_length(kind)))
      table%lines = 0
   end subroutine put_heads

   !> One row with the digits `d`: what is not known is a word, what the row does not have is blank: of a link whose
   !> `angle_alone` is listed its place. `error` (3, 0:2) is unknown of the numbers.
   subroutine put_row(o, l, d, polish, row, angle_alone, error, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      logical, intent(in) :: polish, angle_alone
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: error(3, 0:2)
      type(listing_state_t), intent(inout) :: table
      character(row_length) :: line
      real(wp) :: x, off
      integer :: k, c, i, first, last, end_of, unit, column(3, 0:2)

      column = l%column(:, :, merge(links_turning, row%kind, angle_alone))
      ! A pair has a slide or an angle, and its value is the first.
      if (row%kind == request_pair) column(merge(1, 3, row%angular), :) = 0
      line = ' '//row%name
      first = names_length(row%kind)
      end_of = first
      if (row%kind >= request_pole) then
         i = index(row%name, ' ')
         line(i + 1:) = ''
         line(name_length + 1:) = ' '//row%name(i + 1:)
      end if
      do k = 0, 2
         do c = 1, 3
            if (column(c, k) == 0) cycle
            last = first + numeral_length*column(c, k)
            end_of = max(end_of, last)
            associate (field => line(last - numeral_length + 1:last))
               if (row%kind >= request_pole) then
                  field = number_of_centre()
                  table%masked = table%masked .or. index(field, unknown_digit) > 0
                  cycle
               end if
               unit = dimension_of(c)
               i = merge(1, c, row%kind == request_pair)
               if (k > row%known) then
                  field = l%none
                  cycle
               end if
               x = row%value(i, k)
               off = error(i, k)
               ! A division takes long, by 1 too.
               if (unit == 2) then
                  x = x/l%angle
                  off = off/l%angle
               end if
               if (off > 0.0_wp) then
                  call put_known(x, off, d%decimals(unit, k), d%power(unit, k), field, table%masked)
               else
                  call put_fixed(x, d%decimals(unit, k), d%power(unit, k), field)
               end if
            end associate
         end do
      end do
      ! Without the copy of the line that `trim` would make.
      call put(o, line(:len_trim(line(:end_of))))
      table%lines = table%lines + 1

   contains

      !> Number (c, k) of the row of a pole or curve, or the word in its place. A pole has a direction where it is at
      !> infinity, and where it may be there: then nothing is known of its place.
      pure function number_of_centre() result(cell)
         character(numeral_length) :: cell
         real(wp) :: unit
         logical :: is_direction
         integer :: needed

         unit = merge(l%angle, 1.0_wp, c == 3)
         is_direction = row%kind == request_pole .and. c == 3
         ! How much of a motion the number needs, in the values of `known`.
         needed = 1
         if (row%kind == request_curve) needed = merge(merge(1, 0, c == 3), 2, k == 0)
         if (row%known < needed) then
            cell = l%none
         else if (is_direction .and. row%state == centre_finite .and. error(1, 0) < nothing_known) then
            cell = ''
         else if (error(c, k) >= nothing_known) then
            cell = repeat(' ', numeral_length - 1)//unknown_digit
         else if (has_number(row, c, k) .or. (is_direction .and. row%state == centre_finite)) then
            associate (what => dimension_of(c))
               call put_known(row%value(c, k)/unit, error(c, k)/unit, d%decimals(what, 0), d%power(what, 0), cell)
            end associate
         else
            cell = phrase(say_at_rest, polish)
            if (row%state == centre_infinite) cell = phrase(say_infinite, polish)
            cell = adjustr(cell)
         end if
      end function number_of_centre
   end subroutine put_row
end module listing_tables
