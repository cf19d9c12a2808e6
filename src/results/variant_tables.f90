!> The rows of variants as text: lines of the listing, and of a file with all digits (--summary).
module variant_tables
   use kinds, only: wp
   use mechanism, only: settings_t
   use independent, only: set_t
   use motion, only: flag_none
   use listing, only: words_of_flag
   use listing_layout, only: layout_t, line_length, line_starts, write_folded
   use table, only: cell_text, add_cell, add_name, power_text, unit_of, right
   use listing, only: write_diagnostics
   use listing_tables, only: mask_words
   use text_output, only: output_t, put, add
   use number_format, only: whole
   use variant_rows
   use phrases
   implicit none
   private
   public :: summary_head, summary_row, write_variant, write_variant_heads, write_variant_row, write_variants_end

   !> Characters of the number of a variant, and the least number of characters of a column.
   integer, parameter :: variant_number_length = 10, least_width = 12
   !> Characters of an exponent.
   integer, parameter :: exponent_length = 4

contains

   !> Writes the names of the columns of a summary to a file.
   subroutine summary_head(o, summary)
      type(output_t), intent(inout) :: o
      type(summary_t), intent(in) :: summary   !< of the set
      integer :: i

      call add(o, 'set')
      do i = 1, size(summary%columns)
         call add(o, ',')
         call add_name(o, trim(summary%columns(i)%name))
      end do
      call put(o, '')
   end subroutine summary_head

   !> Writes the row of a variant to a file with all digits; a cell without a value is empty.
   subroutine summary_row(o, summary, settings, row)
      type(output_t), intent(inout) :: o
      type(summary_t), intent(in) :: summary   !< of the set
      class(settings_t), intent(in) :: settings   !< of the set
      type(variant_row_t), intent(in) :: row   !< of the variant, filled
      integer :: i

      call add(o, whole(settings%set_number))
      do i = 1, size(summary%columns)
         call add(o, ',')
         call add_cell(o, row%cells(i), settings%degrees .and. summary%columns(i)%format%is_angle)
      end do
      call put(o, '')
   end subroutine summary_row

   !> Writes the lines over the tables of one variant: its number and its values.
   subroutine write_variant(o, l, summary, settings, row)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l        !< of the set
      type(summary_t), intent(in) :: summary   !< of the set
      class(settings_t), intent(in) :: settings   !< of the set
      type(variant_row_t), intent(in) :: row   !< of the variant
      character(:), allocatable :: line, item
      integer :: i

      call put(o, '')
      line = ' '//phrase(text_variant, settings%polish)//' '//whole(row%number)
      do i = 2, summary%numbers + 1
         associate (c => summary%columns(i))
            item = '   '//trim(c%above)//' '//trim(c%below)//' = ' &
               //trim(cell_text(c%format, c%by_size, row%cells(i), l%words)//' '//unit_of(c%format%power, trim(c%unit)))
         end associate
         if (len(line) + len(item) > line_length) then
            call put(o, line)
            line = ' '
         end if
         line = line//item
      end do
      call put(o, line)
   end subroutine write_variant

   !> Writes the heads of the table: for each of its lines of columns the names, powers of ten and units.
   subroutine write_variant_heads(o, summary)
      type(output_t), intent(inout) :: o
      type(summary_t), intent(in) :: summary   !< of the set
      integer, allocatable :: starts(:)
      integer :: n, k, i
      character(:), allocatable :: line
      ! Two heads, the power of ten, the unit.
      character(len(summary%columns%above)) :: heads(4)

      call put(o, '')
      starts = line_starts(variant_number_length, [(width(summary%columns(i)), i=1, size(summary%columns))])
      do n = 1, size(starts) - 1
         do k = 1, size(heads)
            line = ''
            do i = 1, starts(n + 1) - 1
               associate (c => summary%columns(i))
                  if (.not. c%printed .or. (i > 1 .and. i < starts(n))) cycle
                  heads = [character(len(heads)) :: c%above, c%below, '', c%unit]
                  if (c%format%power /= 0) heads(3) = power_text(c%format%power)
                  line = line//right(trim(heads(k)), merge(variant_number_length, width(c), i == 1))
               end associate
            end do
            if (len_trim(line) > 0) call put(o, trim(line))
         end do
      end do
   end subroutine write_variant_heads

   !> Writes the lines of the row of a variant, and below them the reason if the row is not complete.
   subroutine write_variant_row(o, l, summary, set, row)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l        !< of the set
      type(summary_t), intent(in) :: summary   !< of the set
      class(set_t), intent(in) :: set        !< of the deck
      type(variant_row_t), intent(in) :: row   !< of the variant, filled
      integer, allocatable :: starts(:)
      integer :: n, i
      character(:), allocatable :: line

      starts = line_starts(variant_number_length, [(width(summary%columns(i)), i=1, size(summary%columns))])
      do n = 1, size(starts) - 1
         line = right(whole(row%number), variant_number_length)
         do i = starts(n), starts(n + 1) - 1
            associate (c => summary%columns(i))
               if (c%printed) line = line//right(cell_text(c%format, c%by_size, row%cells(i), l%words), width(c))
            end associate
         end do
         call put(o, line)
      end do
      if (row%rejected /= '') call write_folded(o, ' *** ', row%rejected)
      if (row%limit%kind /= 0) then
         call write_diagnostics(o, set, [row%limit])
      else if (row%flag /= flag_none) then
         call put(o, ' *** '//words_of_flag(row%flag, row%singularity, set%polish))
      end if
   end subroutine write_variant_row

   !> Writes the last line of a set of variants. With a closing tolerance the line before explains `?` in the rows.
   subroutine write_variants_end(o, settings)
      type(output_t), intent(inout) :: o
      class(settings_t), intent(in) :: settings   !< of the set

      if (settings%closing > 0.0_wp) call put(o, mask_words(settings))
      call put(o, '')
      call put(o, ' '//phrase(text_end, settings%polish)//' '//whole(settings%set_number)//':  ' &
         //phrase(text_variants, settings%polish)//' '//whole(settings%variants))
      call put(o, '')
   end subroutine write_variants_end

   !> Counts the characters of a column in the listing; 0 if the column is only in the file.
   pure integer function width(column)
      type(summary_column_t), intent(in) :: column   !< of the summary

      width = 0
      if (.not. column%printed) return
      width = max(least_width, len_trim(column%above) + 2, len_trim(column%below) + 2, len_trim(column%unit) + 2)
      if (column%by_size) width = max(width, least_width + exponent_length)
   end function width
end module variant_tables
