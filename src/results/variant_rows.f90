!> The summary of a set with VARY cards: a row for each variant, with its values and the answers about its motion.
module variant_rows
   use kinds, only: wp, label_length
   use plane_vectors, only: in_degrees
   use mechanism, only: request_t, drive_t
   use columns, only: columns_of_rows, cell_count, cell_number, cell_unbounded, cell_none, cell_word, of_angle
   use scales, only: is_length
   use table, only: format_t, cell_t, choose_digits
   use motion, only: flag_none
   use drives, only: drive_motion
   use independent, only: set_t, request_of, first_drive
   use set_members, only: drive_of, drive_number, drive_title, name_of_drive
   use deck_variants, only: variation_t, varied_t, values_of_variant
   use listing_layout, only: layout_t, angle_unit, column_name, column_unit, column_format, row_title
   use csv, only: marks, table_t, table_column_t, new_table, drive_columns, dotted
   use extremes, only: coordinate_t, strokes_t, least, greatest, outward, strokes_of
   use extremes_table, only: extreme_words, ratio_format
   use ranges, only: lower_end, upper_end
   use answers, only: answers_t
   use counts, only: counts_t
   use number_format, only: whole
   use phrases
   implicit none
   private
   public :: summary_t, summary_column_t, variant_row_t, new_summary, new_row, fill_row

   !> The relative error of a stroke by roundings of two coordinates and their difference.
   real(wp), parameter :: stroke_rounding = 4.0_wp*epsilon(1.0_wp)

   !> A column: its name in a file, and its form in the listing.
   type :: summary_column_t
      character(80) :: name = ''                    !< in a file
      logical :: printed = .false.                  !< the column is in the listing too
      character(6*label_length) :: above = '', below = ''   !< the lines over the column
      character(3*label_length) :: unit = ''        !< name of the unit; '': none
      type(format_t) :: format = format_t(decimals=0)   !< of all values
      logical :: by_size = .false.                  !< instead, each value has the digits for its own size
   end type summary_column_t

   !> The columns of the summary of a set.
   type :: summary_t
      type(summary_column_t), allocatable :: columns(:)   !< in the order of the file
      integer :: numbers = 0                        !< that vary: columns 2 to numbers + 1
      type(table_t) :: extremes                     !< the columns of EXTREMES cards
   end type summary_t

   !> The row of a variant, with the counts of its instants.
   type, extends(counts_t) :: variant_row_t
      integer :: number = 0                         !< of the variant
      type(cell_t), allocatable :: cells(:)         !< (columns)
      character(:), allocatable :: rejected         !< the error for which it is not computed; '' for none
   end type variant_row_t

contains

   !> Makes the columns of the summary of a set.
   function new_summary(set, l, variation) result(s)
      class(set_t), intent(in) :: set        !< of the deck
      type(layout_t), intent(in) :: l        !< of the set
      type(variation_t), intent(in) :: variation   !< the variants of the set
      type(summary_t) :: s
      character(:), allocatable :: drives(:), name
      integer :: i

      s%numbers = size(variation%numbers)
      drives = drive_columns(set)

      allocate (s%columns(0))
      call add_column(summary_column_t('variant', .true., phrase(text_variant, set%polish)))
      do i = 1, size(variation%numbers)
         call add_column(number_column(variation%numbers(:i)))
      end do

      call add_column(summary_column_t('solved', .true., phrase(text_instants, set%polish), &
         phrase(text_are_solved, set%polish)))
      call add_column(summary_column_t('flagged', .true., phrase(text_instants, set%polish), &
         phrase(text_flagged, set%polish)))
      call add_column(summary_column_t('flag.t', .true., phrase(text_first_flag, set%polish), &
         phrase(text_at_time, set%polish), set%time_unit, format=l%time))
      call add_drive(min(1, size(set%drives)), 'flag', '', '')
      call add_column(summary_column_t('flag.mark'))
      call add_column(summary_column_t('limit.t'))
      call add_column(summary_column_t('limit.drive'))
      call add_column(summary_column_t('limit.value'))

      do i = 1, merge(size(set%drives), 0, set%ranges)
         name = drive_title(set, i)
         call add_drive(i, 'range.min', name, phrase(text_one_range, set%polish)//' MIN')
         call add_drive(i, 'range.max', name, phrase(text_one_range, set%polish)//' MAX')
         call add_column(summary_column_t('range.turns.'//trim(drives(i)), .true., name, &
            phrase(text_whole_turns, set%polish)))
      end do
      if (set%assemblies) call add_column(summary_column_t('assemblies', .true., phrase(text_assemblies, set%polish)))
      if (set%proves) call add_column(summary_column_t('unproved', .true., phrase(text_instants, set%polish), &
         phrase(text_not_proved, set%polish)))
      call add_extremes()

   contains

      !> Adds a column to the summary.
      subroutine add_column(column)
         type(summary_column_t), intent(in) :: column   !< the column

         s%columns = [s%columns, column]
      end subroutine add_column

      !> Adds the column of the values of a drive.
      subroutine add_drive(number, start, above, below)
         integer, intent(in) :: number       !< number of the drive in the set; 0: none, the column is empty
         character(*), intent(in) :: start   !< the beginning of the name of the column
         character(*), intent(in) :: above, below   !< the lines over the column; blank: it is only in the file
         type(summary_column_t) :: c
         type(drive_t) :: drive

         c%name = start//'.drive'
         if (number > 0) then
            c%name = start//'.'//drives(number)
            drive = drive_of(set, number)
            c%format%is_angle = .not. is_length(drive)
            c%printed = above /= ''
            c%above = above
            c%below = below
            c%unit = merge(angle_unit(set), set%length_unit, c%format%is_angle)
            if (c%format%is_angle) c%format%unit = l%format(of_angle, 0)%unit
            if (number <= size(l%drives)) c%format = l%drives(number)%format
         end if
         call add_column(c)
      end subroutine add_drive

      !> Adds the columns of EXTREMES cards.
      subroutine add_extremes()
         type(summary_column_t) :: c
         type(request_t) :: request
         integer :: i, which
         character(3), parameter :: endings(least:greatest) = ['min', 'max']
         character(:), allocatable :: word

         s%extremes = new_table(set, .true.)
         do i = 1, size(s%extremes%columns)
            associate (column => s%extremes%columns(i))
               request = request_of(set, column%request)
               word = column_name(l, column%row_column_t)
               c = summary_column_t(printed=.true., unit=column_unit(l, column%row_column_t), &
                  above=row_title(set, column%request), &
                  format=column_format(l, set, column%request, column))

               do which = least, greatest
                  c%name = trim(column%name)//'.'//endings(which)
                  c%below = word//' '//extreme_words(which)
                  call add_column(c)
                  call add_column(summary_column_t(trim(c%name)//'.t'))
                  call add_drive(first_drive(set, column%request), trim(c%name), '', '')
               end do
               if (column%order > 0 .or. request%drive > 0) cycle
               c%name = trim(column%name)//'.stroke'
               c%below = word//' '//phrase(text_stroke, set%polish)
               c%by_size = .true.
               c%format%power = 0
               call add_column(c)
               call add_column(summary_column_t(trim(column%name)//'.ratio', .true., c%above, &
                  word//' '//phrase(text_ratio, set%polish), format=ratio_format))
            end associate
         end do
      end subroutine add_extremes
   end function new_summary

   !> Makes the column of a varied number. If earlier numbers have its name, their count follows the name.
   function number_column(numbers) result(c)
      type(varied_t), intent(in) :: numbers(:)   !< (1 or more) the last one gets the column
      type(summary_column_t) :: c
      real(wp) :: largest
      integer :: same_named

      associate (one => numbers(size(numbers)))
         c = summary_column_t(dotted(trim(one%owner)//' '//one%word), .true., one%owner, one%word, one%unit)
         same_named = count(numbers%owner == one%owner .and. numbers%word == one%word)
         if (same_named > 1) c%name = trim(c%name)//'.'//whole(same_named)
         largest = max(abs(one%first), abs(one%last))
         if (allocated(one%list)) largest = maxval(abs(one%list))
         call choose_digits(log10(max(largest, tiny(1.0_wp))), 0, c%format)
         if (.not. largest > 0.0_wp) c%format%power = 0
      end associate
   end function number_column

   !> Makes the row of a variant, with the values of its varied numbers only.
   function new_row(summary, variation, n) result(r)
      type(summary_t), intent(in) :: summary   !< of the set
      type(variation_t), intent(in) :: variation   !< the variants of the set
      integer, intent(in) :: n               !< number of the variant, from 1
      type(variant_row_t) :: r
      real(wp) :: values(summary%numbers)
      integer :: i

      r = variant_row_t(number=n, rejected='')
      allocate (r%cells(size(summary%columns)))
      r%cells(1) = cell_t(cell_count, real(n, wp))
      values = values_of_variant(variation, n)
      do i = 1, size(values)
         r%cells(i + 1) = cell_t(cell_number, values(i))
      end do
   end function new_row

   !> Fills the cells of the row of a variant, after its last instant. A variant that is rejected has the code of its
   !> error in the place of the flag, and no answers.
   subroutine fill_row(summary, set, asked, row)
      type(summary_t), intent(in) :: summary   !< of the set
      class(set_t), intent(in) :: set        !< the variant; the set of the deck if the variant is rejected
      type(answers_t), intent(in) :: asked   !< the answers to the cards of the variant
      type(variant_row_t), intent(inout) :: row   !< with its counts and values; gets the other cells
      type(strokes_t) :: strokes
      integer :: n, i, k, which, order

      n = summary%numbers + 1
      call next(cell_t(cell_count, real(row%solved, wp)))
      call next(cell_t(cell_count, real(row%flagged, wp)))
      if (row%flag /= flag_none) then
         call next(cell_t(cell_number, row%t))
         call next(drive_cell(set, min(1, size(set%drives)), row%t))
         call next(cell_t(cell_word, word=marks(row%flag)))
      else
         n = n + 3
         if (row%rejected /= '') row%cells(n) = cell_t(cell_word, word=row%rejected(:4))
      end if

      if (row%limit%kind /= 0) then
         row%cells(n + 1) = cell_t(cell_number, row%limit%t)
         if (row%limit%drive > 0) then
            row%cells(n + 2) = cell_t(cell_word, &
               word=name_of_drive(set, row%limit%part, row%limit%drive))
            row%cells(n + 3) = cell_t(cell_number, row%limit%value)
            if (row%limit%is_angle .and. set%degrees) row%cells(n + 3)%value = in_degrees(row%limit%value)
         end if
      end if
      n = n + 3
      if (row%rejected /= '') return

      if (set%ranges) then
         ! Three for each drive: the limits, and the turns after which the motion closes.
         do i = 1, size(asked%ranges)
            associate (one => asked%ranges(i), d => n + 3*(drive_number(set, asked%ranges(i)%part, &
                       asked%ranges(i)%drive) - 1))
               do which = lower_end, upper_end
                  if (one%has_limit(which)) row%cells(d + which) = cell_t(cell_number, one%limit(which)%value)
               end do
               row%cells(d + 3) = cell_t(cell_count, real(merge(one%turns, 0, one%is_all), wp))
            end associate
         end do
         n = n + 3*size(set%drives)
      end if
      if (set%assemblies) call next(cell_t(merge(cell_none, cell_count, asked%assemblies < 0), &
         real(asked%assemblies, wp)))
      if (set%proves) call next(cell_t(cell_count, real(row%unproved, wp)))

      do i = 1, size(summary%extremes%columns)
         associate (c => summary%extremes%columns(i), part => set%rows(summary%extremes%columns(i)%request)%part)
            call find_number(asked%extremes%tracks(part)%coordinates, c, k, order)
            associate (one => asked%extremes%tracks(part)%coordinates(k))
               do which = least, greatest
                  associate (e => one%found(which, order))
                     if (e%exists .and. one%sought(order)) then
                        row%cells(n + 1) = cell_t(cell_number, e%value, e%error)
                        if (.not. e%has_bound) row%cells(n + 1) = cell_t(cell_unbounded, outward(which))
                        row%cells(n + 2) = cell_t(cell_number, e%t)
                        row%cells(n + 3) = drive_cell(set, first_drive(set, c%request), e%t)
                     end if
                  end associate
                  n = n + 3
               end do
               if (order > 0) cycle
               strokes = strokes_of(asked%extremes, one)
               ! A stroke may be small: then the rounding of the difference counts.
               if (strokes%length%exists) row%cells(n + 1) = cell_t(cell_number, strokes%length%value, &
                  strokes%length%error + stroke_rounding*maxval(abs(one%found(:, 0)%value)))
            end associate
            if (strokes%ratio > 0.0_wp) row%cells(n + 2) = cell_t(cell_number, strokes%ratio, strokes%error)
            n = n + 2
         end associate
      end do

   contains

      !> Fills the next cell of the row.
      subroutine next(cell)
         type(cell_t), intent(in) :: cell    !< the contents

         n = n + 1
         row%cells(n) = cell
      end subroutine next
   end subroutine fill_row

   !> Finds the coordinate and the derivative of a column of extremes, which some coordinate has.
   pure subroutine find_number(coordinates, column, k, order)
      type(coordinate_t), intent(in) :: coordinates(:)   !< (any number) of the mechanism of the column
      type(table_column_t), intent(in) :: column   !< of the summary
      integer, intent(out) :: k              !< the number of the coordinate
      integer, intent(out) :: order          !< 0 to 2: which derivative of the coordinate

      do k = 1, size(coordinates)
         if (coordinates(k)%request /= column%request) cycle
         do order = 0, 2
            if (coordinates(k)%columns(order) == 0) cycle
            if (all(columns_of_rows(coordinates(k)%columns(order))%at == column%at)) return
         end do
      end do
   end subroutine find_number

   !> Makes the cell of the value of a drive at a time; an empty one without a drive.
   type(cell_t) function drive_cell(set, number, t) result(cell)
      class(set_t), intent(in) :: set        !< of the drive
      integer, intent(in) :: number          !< number of the drive in the set; 0: none
      real(wp), intent(in) :: t              !< time, in the deck's unit
      type(drive_t) :: drive
      real(wp) :: f(3)

      if (number == 0) return
      drive = drive_of(set, number)
      f = drive_motion(drive, t)
      cell = cell_t(cell_number, f(1))
   end function drive_cell
end module variant_rows
