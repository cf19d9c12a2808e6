!> The table of COLUMN cards: a line for each instant, with its time, the values of the drives and the numbers that the
!> cards name. Columns without room in a line are in a second table, and so on. The lines are kept until the run ends.
module column_table
   use kinds, only: wp
   use columns, only: row_column_t, columns_of_rows, column_at, cell_of, of_length, of_angle
   use drives, only: drive_motion
   use mechanism, only: request_t, settings_t
   use independent, only: set_t
   use set_members, only: requests_of, row_form, drive_title
   use set_motion, only: set_motion_t, is_flagged
   use rows, only: finished_row_t
   use listing_layout, only: layout_t, line_length, line_starts, column_name, column_unit, column_format, row_title
   use listing_tables, only: law_error, mask_words
   use table, only: format_t, write_cell, write_number, power_text, right
   use text_output, only: output_t, open_held, move_text, put
   use number_format, only: numeral_length
   use phrases
   implicit none
   private
   public :: column_table_t, new_column_table, add_table_line, write_columns

   !> The mark after the time of a flagged instant.
   character(1), parameter :: flag = '*'
   !> Lines of heads: two names, the power of ten, the unit.
   integer, parameter :: head_lines = 4, line_of_power = 3

   !> A column: the time, a drive, or a number of a row.
   type :: listed_column_t
      integer :: drive = 0                   !< number of the drive among those of the layout; 0: none
      integer :: request = 0                 !< number of the row among the requests of the set; 0: none
      type(row_column_t) :: number           !< of the row
      type(format_t) :: format               !< of its numbers
      character(line_length) :: heads(head_lines) = ''   !< '': an empty line
      integer :: width = numeral_length      !< characters
   end type listed_column_t

   !> The tables of a set.
   type :: column_table_t
      logical :: is_only = .false.           !< nothing else is printed at the instants: their remarks are in `remarks`
      type(listed_column_t), allocatable :: columns(:)   !< the time first; not allocated: no COLUMN cards
      !> (tables + 1) The first column of each after the time; at last the number of columns and one more.
      integer, allocatable :: starts(:)
      type(output_t), allocatable :: lines(:)   !< (tables) the lines so far
      type(output_t) :: remarks              !< about the instants so far
      logical :: masked = .false.            !< some digit is a question mark
      logical :: flagged = .false.           !< some instant has a flag
   end type column_table_t

contains

   !> Makes the tables of a set ready for its first instant. A set without COLUMN cards has none.
   subroutine new_column_table(l, set, table)
      type(layout_t), intent(in) :: l
      class(set_t), intent(in) :: set        !< of the tables
      type(column_table_t), intent(out) :: table   !< without an instant, and without COLUMN cards empty
      type(request_t), allocatable :: requests(:)
      integer :: i

      if (.not. allocated(set%columns)) return
      requests = requests_of(set)
      table%is_only = all(requests%every == 0)
      allocate (table%columns(1 + size(l%drives) + size(set%columns)))
      call write_heads(table%columns(1), '', 'T', l%time, trim(set%time_unit))
      do i = 1, size(l%drives)
         table%columns(1 + i)%drive = i
         call set_drive_column(table%columns(1 + i))
      end do
      do i = 1, size(set%columns)
         call set_number_column(i, table%columns(1 + size(l%drives) + i))
      end do

      ! A table ends if a line has no room for the next column. After the time there is the flag.
      table%starts = line_starts(table%columns(1)%width + len(flag), table%columns%width)
      allocate (table%lines(size(table%starts) - 1))
      do i = 1, size(table%lines)
         call open_held(table%lines(i))
      end do
      call open_held(table%remarks)

   contains

      !> Makes the column of a drive: its kind over the name of the driven link, point or pair.
      subroutine set_drive_column(column)
         type(listed_column_t), intent(inout) :: column   !< has the number of the drive
         character(:), allocatable :: name
         integer :: border

         associate (drive => l%drives(column%drive))
            name = drive_title(set, column%drive)
            border = index(name, ' ')
            call write_heads(column, name(:border - 1), name(border + 1:), drive%format, &
               trim(l%unit(merge(of_angle, of_length, drive%format%is_angle))))
         end associate
      end subroutine set_drive_column

      !> Makes the column of a COLUMN card: the name of its row over the name of its number.
      subroutine set_number_column(i, column)
         integer, intent(in) :: i            !< number of the card among the COLUMN cards
         type(listed_column_t), intent(inout) :: column   !< gets its request, number and heads

         column%request = set%columns(i)%request
         column%number = columns_of_rows(column_at(row_form(set, column%request), set%columns(i)%at(1), &
            set%columns(i)%at(2)))
         call write_heads(column, row_title(set, column%request), column_name(l, column%number), &
            column_format(l, set, column%request, column%number), column_unit(l, column%number))
      end subroutine set_number_column

      !> Gives a column its heads and the width that they need.
      subroutine write_heads(column, above, below, format, unit)
         type(listed_column_t), intent(inout) :: column   !< gets heads, format and width
         character(*), intent(in) :: above, below   !< the upper and the lower name
         type(format_t), intent(in) :: format   !< of the numbers
         character(*), intent(in) :: unit    !< name of the unit

         column%heads = [character(line_length) :: above, below, '', unit]
         if (format%power /= 0) column%heads(line_of_power) = power_text(format%power)
         column%format = format
         column%width = max(numeral_length, 2 + maxval(len_trim(column%heads)))
      end subroutine write_heads
   end subroutine new_column_table

   !> Adds the rows of an instant: a line for each table.
   subroutine add_table_line(table, l, motions, rows)
      type(column_table_t), intent(inout) :: table   !< of the set; gets the lines
      type(layout_t), intent(in) :: l
      type(set_motion_t), intent(in) :: motions   !< at the instant
      type(finished_row_t), intent(in) :: rows(:)   !< (requests of the set) at the instant
      character(line_length) :: line
      character(numeral_length) :: field, time
      real(wp) :: f(3)
      integer :: n, i, last, cell

      call write_number(table%columns(1)%format, 0, motions%motions(1)%t, 0.0_wp, time, table%masked)
      table%flagged = table%flagged .or. is_flagged(motions)
      do n = 1, size(table%lines)
         line = right(time, table%columns(1)%width)
         last = table%columns(1)%width + len(flag)
         if (is_flagged(motions)) line(last:last) = flag

         do i = table%starts(n), table%starts(n + 1) - 1
            associate (c => table%columns(i))
               if (c%drive > 0) then
                  f = drive_motion(l%drives(c%drive)%law, motions%motions(1)%t)
                  call write_number(c%format, 0, f(1), law_error(l%drives(c%drive), motions%motions(1)%t), field, &
                     table%masked)
               else
                  associate (row => rows(c%request), at => c%number%at)
                     cell = cell_of(c%number, row%known, row%state)
                     call write_cell(c%format, 0, cell, row%value(at(1), at(2)), row%doubt(at(1), at(2)), l%words, &
                        field, table%masked)
                  end associate
               end if
               last = last + c%width
               line(last - numeral_length + 1:last) = field
            end associate
         end do
         call put(table%lines(n), line(:len_trim(line)))
      end do
   end subroutine add_table_line

   !> Writes the tables, and below them the remarks; nothing without COLUMN cards.
   subroutine write_columns(o, table, settings)
      type(output_t), intent(inout) :: o
      type(column_table_t), intent(inout) :: table   !< of the set; loses its lines
      class(settings_t), intent(in) :: settings   !< of the set
      character(:), allocatable :: line
      integer :: n, k, i

      if (.not. allocated(table%columns)) return
      do n = 1, size(table%lines)
         call put(o, '')
         do k = 1, head_lines
            line = right(trim(table%columns(1)%heads(k)), table%columns(1)%width)//repeat(' ', len(flag))
            do i = table%starts(n), table%starts(n + 1) - 1
               line = line//right(trim(table%columns(i)%heads(k)), table%columns(i)%width)
            end do
            if (line /= '') call put(o, trim(line))
         end do
         call move_text(table%lines(n), o)
      end do
      if (table%flagged .and. .not. table%is_only) &
         call put(o, ' --- '//flag//': '//phrase(text_flag_above, settings%polish))
      if (table%masked) call put(o, mask_words(settings))
      call move_text(table%remarks, o)
   end subroutine write_columns
end module column_table
