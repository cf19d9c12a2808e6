!> The table of extremes at the end of a set, with the columns of the other tables: below the name of a link, point or
!> pair its least and greatest values, each with its time and the value of the first drive of its mechanism, the
!> stroke, and in a cyclic motion the times of the forward and the return stroke with their ratio; then the dwells.
module extremes_table
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_pair, driven_kinds
   use names, only: subject_name
   use points, only: coordinates_of
   use set_analysis, only: set_analysis_t
   use listing_layout, only: layout_t, digits_t, digits_of, has_column, dimension_of, name_length, row_length
   use listing_tables, only: table_t, put_times, put_heads, time_text, drive_text
   use text_output, only: output_t, put
   use numerals, only: fixed, whole, numeral_length
   use extremes, only: extremes_t, least, greatest, stroke_times, is_angle
   use dwells, only: dwell_t
   use phrases
   implicit none
   private
   public :: put_extremes

   !> Digits after the point of a ratio of times.
   integer, parameter :: ratio_decimals = 6
   character(3), parameter :: extreme_words(least:greatest) = ['MIN', 'MAX']

contains

   !> The extremes `x` and `dwells` of the set `m`, which `s` has analysed.
   subroutine put_extremes(o, l, m, s, x, dwells)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(extremes_t), intent(in) :: x
      type(dwell_t), intent(in) :: dwells(:)
      type(table_t) :: table
      integer :: q, k

      call put_times(o, l, ' '//phrase(say_extremes, m%polish), [m%t0, m%t1])
      do q = 1, size(x%asked)
         associate (i => x%asked(q))
            call put_heads(o, l, digits_of(l, i), m%requests(i)%kind, table)
            call put_subject(o, l, digits_of(l, i), m, s, x, q)
            do k = 1, size(dwells)
               if (dwells(k)%asked == q) call put_dwell(o, l, digits_of(l, i), m, first_drive(l, s, i), i, dwells(k))
            end do
         end associate
      end do
      if (x%unsolved > 0) call put(o, ' --- '//phrase(say_unsolved, m%polish)//' '//whole(x%unsolved))
   end subroutine put_extremes

   !> The rows of asked row `q`.
   subroutine put_subject(o, l, d, m, s, x, q)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q
      character(numeral_length), dimension(3, 0:2) :: value, time, drive
      integer :: which, c, k, first

      first = first_drive(l, s, x%asked(q))
      associate (request => m%requests(x%asked(q)))
         call put(o, ' '//trim(subject_name(m, request%kind, request%subject)))
         do which = least, greatest
            value = ''
            time = ''
            drive = ''
            do k = 0, 2
               do c = 1, coordinates_of(request%kind)
                  associate (e => x%found(which, c, k, q))
                     value(c, k) = l%none
                     if (.not. e%exists) cycle
                     value(c, k) = number_text(l, d, e%value, is_angle(m, request, c), k)
                     time(c, k) = fixed(e%t, l%time_decimals, l%time_power)
                     if (first > 0) drive(c, k) = adjusted(drive_text(l%drives(first), e%t))
                  end associate
               end do
            end do
            call put_fields(m, request%kind, request%subject, extreme_words(which), value, o)
            call put_fields(m, request%kind, request%subject, 'T', time, o)
            if (first > 0) call put_fields(m, request%kind, request%subject, trim(subject_name(m, &
               driven_kinds(m%drives(first)%kind), m%drives(first)%subject)), drive, o)
         end do
      end associate
      call put_strokes(o, l, d, m, s, x, q)
   end subroutine put_subject

   !> The stroke of each coordinate, and where the motion is cyclic the times of both strokes and their ratio, the
   !> longer over the shorter.
   subroutine put_strokes(o, l, d, m, s, x, q)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      type(mechanism_t), intent(in) :: m
      type(set_analysis_t), intent(in) :: s
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: q
      character(numeral_length), dimension(3, 0:2) :: stroke, forward, return, ratio
      real(wp) :: times(2)
      integer :: c

      stroke = ''
      forward = ''
      return = ''
      ratio = ''
      associate (request => m%requests(x%asked(q)))
         do c = 1, coordinates_of(request%kind)
            associate (e => x%found(:, c, 0, q))
               if (.not. all(e%exists)) cycle
               stroke(c, 0) = number_text(l, d, e(greatest)%value - e(least)%value, is_angle(m, request, c), 0)
            end associate
            times = stroke_times(x, m, s%now%own(s%now%parts%part(x%asked(q))), q, c)
            if (any(times <= 0.0_wp)) cycle
            forward(c, 0) = fixed(times(1), l%time_decimals, l%time_power)
            return(c, 0) = fixed(times(2), l%time_decimals, l%time_power)
            ratio(c, 0) = fixed(maxval(times)/minval(times), ratio_decimals, 0)
         end do
         call put_fields(m, request%kind, request%subject, phrase(say_stroke, m%polish), stroke, o)
         if (all(forward == '')) return
         call put_fields(m, request%kind, request%subject, 'MIN-MAX', forward, o)
         call put_fields(m, request%kind, request%subject, 'MAX-MIN', return, o)
         call put_fields(m, request%kind, request%subject, phrase(say_ratio, m%polish), ratio, o)
      end associate
   end subroutine put_strokes

   !> A line for a dwell: of which coordinate, within what distance of what, from when to when.
   subroutine put_dwell(o, l, d, m, drive, i, dwell)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: drive, i
      type(dwell_t), intent(in) :: dwell
      character(:), allocatable :: line
      logical :: angular

      angular = is_angle(m, m%requests(i), dwell%column)
      line = ' '//phrase(say_dwell, m%polish)//'  '//column_name(m, i, dwell%column)//'  ' &
         //extreme_words(dwell%which)//' +- ' &
         //trim(adjustl(number_text(l, d, dwell%distance, angular, 0)))//'   T = '//time_text(l, dwell%from)//' .. ' &
         //time_text(l, dwell%to)
      if (drive > 0) line = line//'   '//trim(subject_name(m, driven_kinds(m%drives(drive)%kind), &
         m%drives(drive)%subject))//' = '//drive_text(l%drives(drive), dwell%from)//' .. ' &
         //drive_text(l%drives(drive), dwell%to)
      call put(o, line)
   end subroutine put_dwell

   !> The name of column `c` of request `i`.
   pure function column_name(m, i, c) result(name)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, c
      character(:), allocatable :: name

      if (m%requests(i)%kind == request_pair) then
         name = phrase(say_slide, m%polish)
         if (is_angle(m, m%requests(i), c)) name = phrase(say_angle, m%polish)
      else
         name = 'X'
         if (c == 2) name = 'Y'
         if (c == 3) name = phrase(say_phi, m%polish)
      end if
   end function column_name

   !> A row of `fields` (3, 0:2), those of a subject of the given kind, with a label before it.
   subroutine put_fields(m, kind, subject, label, fields, o)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: kind, subject
      character(*), intent(in) :: label
      character(numeral_length), intent(in) :: fields(3, 0:2)
      type(output_t), intent(inout) :: o
      character(row_length) :: line
      integer :: c, k, i

      line = '  '//label
      if (len(label) > 7) line = ' '//label
      do k = 0, 2
         do c = 1, 3
            if (.not. has_column(c, kind)) cycle
            i = c
            if (kind == request_pair) i = merge(1, 2, (c == 3) .eqv. is_angle(m, request_t(kind, subject), 1))
            associate (first => name_length + numeral_length*(3*k + c - 1))
               line(first + 1:first + numeral_length) = fields(i, k)
            end associate
         end do
      end do
      call put(o, line(:len_trim(line)))
   end subroutine put_fields

   !> A length or angle, or its derivative number `k`, with the digits of the table.
   pure function number_text(l, d, value, angular, k) result(text)
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      real(wp), intent(in) :: value
      logical, intent(in) :: angular
      integer, intent(in) :: k
      character(numeral_length) :: text

      text = fixed(value/merge(l%angle, 1.0_wp, angular), d%decimals(merge(2, 1, angular), k), &
         d%power(merge(2, 1, angular), k))
   end function number_text

   !> `text` at the end of a field.
   pure function adjusted(text) result(field)
      character(*), intent(in) :: text
      character(numeral_length) :: field

      field = text
      field = adjustr(field)
   end function adjusted

   !> The first drive of the mechanism that request `i` asks about; 0: none, or it does not stand over the table.
   pure integer function first_drive(l, s, i)
      type(layout_t), intent(in) :: l
      type(set_analysis_t), intent(in) :: s
      integer, intent(in) :: i

      first_drive = 0
      associate (part => s%now%parts%list(s%now%parts%part(i)))
         if (size(part%drives) > 0) first_drive = part%drives(1)
         if (first_drive > size(l%drives)) first_drive = 0
      end associate
   end function first_drive
end module extremes_table
