!> The table of extremes at the end of a set, with the columns of the other tables. Below the name of a link, point or
!> pair are:
!> - its least and greatest values, each with its time and the value of the first drive of its mechanism;
!> - the stroke;
!> - in a cyclic motion the times of the forward and the return stroke with their ratio, or all dead centres;
!> - the dwells.
!> A number that does not vary is blank; a link, point or pair without a number that varies is left out.
module extremes_table
   use kinds, only: wp
   use mechanism, only: request_t
   use separations, only: closes
   use columns, only: columns_of_rows, forms, table_of, table_of_links, cell_none, cell_unbounded, of_angle
   use table, only: format_t, number_text
   use independent, only: set_t, first_drive
   use set_members, only: requests_of, row_subject, drive_title
   use names, only: more
   use listing_layout, only: layout_t, line_length, table_row_length, angle_unit, column_name, end_of_column
   use listing_tables, only: listing_state_t, write_times, write_heads, time_text, drive_text, mask_words
   use text_output, only: output_t, put
   use number_format, only: numeral_length, rounded
   use masked_numbers, only: unknown_digit
   use extremes, only: extremes_t, coordinate_t, uncovered_interval_t, strokes_t, least, greatest, strokes_of, &
      is_cyclic, is_covered, varies
   use dwells, only: dwell_t
   use phrases
   implicit none
   private
   public :: write_extremes, extreme_words, ratio_format

   !> Digits of the distance between the first and the last position.
   integer, parameter :: closure_digits = 3
   !> If there are more gaps, only so many are listed.
   integer, parameter :: max_gaps = 4
   character(3), parameter :: extreme_words(least:greatest) = ['MIN', 'MAX']
   !> The form of a ratio of times.
   type(format_t), parameter :: ratio_format = format_t(decimals=6)

contains

   !> Writes the extremes and the dwells of a set after its last instant.
   subroutine write_extremes(o, l, set, extremes, dwells)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      class(set_t), intent(in) :: set        !< of the extremes
      type(extremes_t), intent(in) :: extremes   !< after the last instant
      type(dwell_t), intent(in) :: dwells(:)   !< (any number)
      type(listing_state_t) :: table
      type(coordinate_t), allocatable :: own(:)      ! the coordinates of a row
      integer :: q, c, k, part, drive, links_table
      type(request_t) :: requests(size(set%rows))
      logical :: moves, goes_on(size(extremes%tracks))
      character(:), allocatable :: driven, line

      call write_times(o, l, ' '//phrase(text_extremes, set%polish), [set%t0, set%t1], table)
      moves = .false.
      goes_on = .false.
      requests = requests_of(set)
      links_table = table_of_links(requests(extremes%asked), &
         [(any(requests(extremes%asked(q))%sought(:2, :)), q=1, size(extremes%asked))])

      do q = 1, size(extremes%asked)
         part = set%rows(extremes%asked(q))%part
         own = pack(extremes%tracks(part)%coordinates, extremes%tracks(part)%coordinates%request == extremes%asked(q))
         if (.not. any([((varies(own(c), k), c=1, size(own)), k=0, 2)])) cycle
         moves = .true.
         call write_heads(o, l, part, table_of(forms(own(1)%form)%kind, own(1)%form, links_table), table)
         ! A drive that is not in the line over the table has no name in it.
         drive = first_drive(set, extremes%asked(q))
         if (drive > size(l%drives)) drive = 0
         if (drive > 0) driven = drive_title(set, drive)
         call write_subject(row_subject(set, extremes%asked(q)))
         do k = 1, size(dwells)
            associate (w => dwells(k))
               if (w%request /= extremes%asked(q)) cycle
               c = findloc(own%column, w%column, dim=1)
               call write_at(phrase(text_dwell, set%polish)//'  '//name_of(own(c))//'  '//extreme_words(w%which) &
                  //' +- '//text_of(own(c), 0, w%distance, 0.0_wp), [w%from, w%to], w%error)
            end associate
         end do
      end do

      ! Numbers that are not sought may move.
      if (.not. moves .and. all([(all(requests(extremes%asked(q))%sought), q=1, size(extremes%asked))])) &
         call put(o, ' '//phrase(text_at_rest, set%polish))
      if (table%masked) call put(o, mask_words(set))
      call write_gaps(extremes%open, text_may_be_missed)
      call write_gaps(extremes%gaps, text_not_covered)
      do k = 1, size(extremes%tracks)
         ! Why there are no time ratios.
         associate (closure => extremes%tracks(k)%closure)
            if (.not. (goes_on(k) .and. all(closure < huge(1.0_wp)))) cycle
            line = ' --- '//phrase(text_no_period, set%polish)
            if (closes(closure(:2))) then
               line = line//' '//phrase(text_in_velocity, set%polish)
            else
               line = line//' '//rounded(closure(1), closure_digits, 1.0e-3_wp, 1.0e3_wp)//' ' &
                  //phrase(text_lengths_apart, set%polish)//', ' &
                  //rounded(closure(2)/l%format(of_angle, 0)%unit, closure_digits, 1.0e-3_wp, 1.0e3_wp)//' ' &
                  //trim(angle_unit(set))
            end if
            call put(o, line)
         end associate
      end do

   contains

      !> Writes the rows of the link, point, pair, measure or ratio of `own`.
      subroutine write_subject(name)
         character(*), intent(in) :: name    !< of the row
         character(numeral_length), dimension(size(own), 0:2) :: value, time, place
         type(strokes_t) :: strokes(size(own))
         character(:), allocatable :: line
         real(wp) :: error
         integer :: which, c, k, i

         if (drive > 0) then
            call put(o, ' '//name//'   '//phrase(text_drive, set%polish)//' '//driven//','//l%drives(drive)%after)
         else
            call put(o, ' '//trim(name))
         end if

         do which = least, greatest
            value = ''
            time = ''
            place = ''
            do k = 0, 2
               do c = 1, size(own)
                  if (.not. varies(own(c), k)) cycle
                  associate (e => own(c)%found(which, k))
                     if (.not. e%exists) then
                        value(c, k) = l%words(cell_none)
                        cycle
                     end if
                     value(c, k) = l%words(cell_unbounded)
                     if (e%has_bound) value(c, k) = text_of(own(c), k, e%value, e%error)
                     time(c, k) = time_text(l, e%t, e%t_error)
                     if (drive > 0) place(c, k) = drive_text(l%drives(drive), e%t, e%t_error)
                  end associate
               end do
            end do

            call write_fields(extreme_words(which), value)
            call write_fields(phrase(text_at_time, set%polish), time)
            if (drive > 0) call write_fields(phrase(text_at_drive, set%polish), place)
         end do

         ! The stroke of each coordinate that varies. If the motion is cyclic, a line for each with the times of both
         ! strokes and their ratio follows, or a line for each dead centre if there are more than two.
         value = ''
         do c = 1, size(own)
            strokes(c) = strokes_of(extremes, own(c))
            associate (length => strokes(c)%length)
               if (length%exists) value(c, 0) = text_of(own(c), 0, length%value, length%error)
            end associate
         end do
         if (any(value /= '')) call write_fields(phrase(text_stroke, set%polish), value)
         do c = 1, size(own)
            if (value(c, 0) == '') cycle
            if (strokes(c)%ratio > 0.0_wp) then
               ! PHI   TIME MIN TO MAX 6.25682 S   TIME MAX TO MIN 5.74318 S   TIME RATIO 1.089437
               error = sum(own(c)%found(:, 0)%t_error)
               line = '  '//name_of(own(c))//'   '//phrase(text_forward, set%polish)//' ' &
                  //time_text(l, strokes(c)%times(1), error)//l%after_time &
                  //'   '//phrase(text_return, set%polish)//' ' &
                  //time_text(l, strokes(c)%times(2), error)//l%after_time &
                  //'   '//phrase(text_ratio, set%polish)//' ' &
                  //number_text(ratio_format, strokes(c)%ratio, strokes(c)%error)
               table%masked = table%masked .or. index(line, unknown_digit) > 0
               call put(o, line)
            end if
            if (strokes(c)%in_run >= 2 .and. is_covered(extremes) .and. .not. is_cyclic(extremes, part)) &
               goes_on(part) = .true.
            associate (dead => strokes(c)%reversals)
               do i = 1, merge(size(dead), 0, size(dead) > 2)
                  call write_at(phrase(text_dead_centre, set%polish)//'  '//name_of(own(c))//'  ' &
                     //text_of(own(c), 0, dead(i)%value, 0.0_wp), [dead(i)%t], [0.0_wp])
               end do
            end associate
         end do
      end subroutine write_subject

      !> Writes a line with one or two times and the values of the drive at these times.
      subroutine write_at(head, t, error)
         character(*), intent(in) :: head    !< the beginning of the line
         real(wp), intent(in) :: t(:)        !< (1 or 2) times
         real(wp), intent(in) :: error(:)    !< (1 or 2) errors of the times
         character(:), allocatable :: line, at_drive
         integer :: i

         line = ' '//head//'   T = '
         at_drive = ''
         if (drive > 0) at_drive = '   '//driven//' = '
         do i = 1, size(t)
            if (i > 1) line = line//' .. '
            line = line//time_text(l, t(i), error(i))
            if (drive == 0) cycle
            if (i > 1) at_drive = at_drive//' .. '
            at_drive = at_drive//drive_text(l%drives(drive), t(i), error(i))
         end do
         line = line//at_drive
         table%masked = table%masked .or. index(line, unknown_digit) > 0
         call put(o, line)
      end subroutine write_at

      !> Writes a line about intervals, as many as the line has room for; nothing if there are none.
      subroutine write_gaps(list, words)
         type(uncovered_interval_t), intent(in) :: list(:)   !< (any number)
         type(phrase_t), intent(in) :: words   !< the beginning of the line
         character(:), allocatable :: text, line, next
         integer :: i

         line = ''
         text = ' --- '//phrase(words, set%polish)
         do i = 1, min(size(list), max_gaps)
            if (i > 1) text = text//','
            text = text//' '//time_text(l, list(i)%from)
            if (abs(list(i)%to - list(i)%from) > 0.0_wp) text = text//' .. '//time_text(l, list(i)%to)
            next = text//l%after_time//more(size(list) - i, set%polish)
            if (i > 1 .and. len(next) > line_length) exit
            line = next
         end do
         if (len(line) > 0) call put(o, line)
      end subroutine write_gaps

      !> Gives the name of a coordinate.
      pure function name_of(coordinate) result(name)
         type(coordinate_t), intent(in) :: coordinate   !< not of a ratio
         character(:), allocatable :: name

         name = column_name(l, columns_of_rows(coordinate%columns(0)))
      end function name_of

      !> Writes a row of the table: a field for each number of `own`.
      subroutine write_fields(label, fields)
         character(*), intent(in) :: label   !< the beginning of the row
         character(numeral_length), intent(in) :: fields(:, 0:)   !< (coordinates of the row, 0:2); '': blank
         character(table_row_length) :: line
         integer :: c, k, last

         line = '  '//label
         if (len(label) > 7) line = ' '//label
         do k = 0, 2
            do c = 1, size(own)
               if (own(c)%columns(k) == 0) cycle
               last = end_of_column(l, own(c)%form, own(c)%columns(k))
               line(last - numeral_length + 1:last) = adjustr(fields(c, k))
            end do
         end do
         table%masked = table%masked .or. index(line, unknown_digit) > 0
         call put(o, line(:len_trim(line)))
      end subroutine write_fields

      !> Gives a value of a coordinate with the digits of the table.
      pure function text_of(coordinate, k, value, error) result(text)
         type(coordinate_t), intent(in) :: coordinate   !< of the set
         integer, intent(in) :: k            !< which derivative, 0 to 2
         real(wp), intent(in) :: value       !< in the deck's units and rad
         real(wp), intent(in) :: error       !< error of the value
         character(:), allocatable :: text

         associate (column => columns_of_rows(coordinate%columns(k)))
            text = number_text(l%own(part)%format(column%dimension, column%order), value, error)
         end associate
      end function text_of
   end subroutine write_extremes
end module extremes_table
