!> Level 11. The printed listing, in the form of the paper's Rys. 5: title, data, structure, then the tables.
!> It takes finished data and depends on nothing else: two correct programs print the same bytes.
module listing
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_point, request_pair
   use motion, only: motion_t, mark_none, mark_not_converged, mark_singular, mark_overflow, &
      mark_open
   use structure, only: findings_t
   use continuity, only: tally_t
   use remarks, only: remark_t
   use listing_structure, only: put_structure
   use listing_remarks, only: put_remarks, put_gap
   use points, only: row_t, row_of, is_due
   use text_output, only: output_t, put
   use numerals, only: fixed, put_fixed, whole, numeral_length
   use known_digits, only: put_known, unknown_digit
   use scatter, only: scatter_t, row_scatter
   use layout, only: layout_t, new_layout, name_length, row_length
   use phrases, only: phrase, say_program, say_set, say_title, say_data, say_results, say_phi, &
      say_end, say_solved, say_marked, say_no_position, say_no_rates, say_overflow, say_contradiction, &
      say_unknown, say_branch, say_followed, say_passed, say_uncertain
   implicit none
   private
   public :: layout_t, new_layout, listing_head, listing_instant, listing_end

contains

   !> Title, data and structure of one set.
   subroutine listing_head(o, l, m, findings)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: findings
      integer :: i

      associate (pl => m%polish)
         call put(o, ' KINMAT   '//phrase(say_program, pl))
         call put(o, '')
         call put(o, trim(' '//phrase(say_set, pl)//' '//whole(m%set_number) &
            //'   '//phrase(say_title, pl)//'   '//m%title))
         call put(o, '')
         call put(o, ' '//phrase(say_data, pl))
         do i = 1, size(m%echo)
            call put(o, ' '//trim(m%echo(i)))
         end do
         call put(o, '')
         call put_structure(o, m, findings)
         call put(o, '')
         call put(o, ' '//phrase(say_results, pl))
         call put_units(o, l, m)
      end associate
   end subroutine listing_head

   !> The unit of each column, with its power of ten where there is one.
   subroutine put_units(o, l, m)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      character(:), allocatable :: turn
      character(:), allocatable :: per
      integer :: k
      character(2), parameter :: prefix(0:2) = ['  ', 'V ', 'A ']

      turn = trim(merge('DEG', 'RAD', m%degrees))
      call put(o, ' T '//unit_of(l%time_power, trim(m%time_unit)))
      do k = 0, 2
         per = ''
         if (k == 1) per = '/'//trim(m%time_unit)
         if (k == 2) per = '/'//trim(m%time_unit)//'**2'
         call put(o, ' '//trim(prefix(k))//'X, '//trim(prefix(k))//'Y ' &
            //unit_of(l%power(1, k), trim(m%length_unit)//per) &
            //'   '//trim(prefix(k))//phrase(say_phi, m%polish)//' '//unit_of(l%power(2, k), turn//per))
      end do
   end subroutine put_units

   pure function unit_of(power, unit) result(text)
      integer, intent(in) :: power
      character(*), intent(in) :: unit
      character(:), allocatable :: text

      text = '['//unit//']'
      if (power /= 0) text = '[10**'//whole(power)//' '//unit//']'
   end function unit_of

   !> The tables of instant number `step` (0, 1, ...), as far as the deck asks for them there; digits that `doubt`
   !> leaves open are masked.
   subroutine listing_instant(o, l, m, q, step, doubt)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: step
      type(scatter_t), intent(in), optional :: doubt
      integer :: i, last_kind
      logical :: is_known, masked

      last_kind = 0
      masked = .false.
      is_known = .true.
      if (present(doubt)) is_known = .not. (doubt%taken .and. doubt%in_doubt)
      do i = 1, size(m%requests)
         if (.not. is_due(m, m%requests(i), step)) cycle
         if (last_kind == 0) call put_instant(o, l, q, step)
         if (m%requests(i)%kind /= last_kind) call put_trimmed(o, l%heads(m%requests(i)%kind))
         last_kind = m%requests(i)%kind
         if (is_known) then
            call put_row(o, l, row_of(m, q, m%requests(i)))
         else
            call put_row(o, l, row_of(m, q, m%requests(i)), &
               row_scatter(m, doubt, m%requests(i)), masked)
         end if
      end do
      if (last_kind == 0 .and. q%mark /= mark_none) call put_instant(o, l, q, step)
      if (q%mark /= mark_none) call put(o, ' *** '//mark_text(q%mark, m%polish))
      if (masked) call put(o, ' --- '//unknown_digit//': '//phrase(say_unknown, m%polish))
      if (allocated(q%remarks)) call put_remarks(o, m, q%remarks)
   end subroutine listing_instant

   subroutine put_instant(o, l, q, step)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(motion_t), intent(in) :: q
      integer, intent(in) :: step
      character(numeral_length) :: time

      time = adjustl(fixed(q%t, l%time_decimals, l%time_power))
      call put(o, '')
      call put(o, l%instant//whole(step)//'   T = '//trim(time))
   end subroutine put_instant

   !> One row: what is not known is a word, what the row does not have is blank. `error` (3, 0:2), where it is given, is
   !> unknown of the numbers; `masked`: a digit is.
   subroutine put_row(o, l, row, error, masked)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(row_t), intent(in) :: row
      real(wp), intent(in), optional :: error(3, 0:2)
      logical, intent(inout), optional :: masked
      character(row_length) :: line
      real(wp) :: size_of(2)
      integer :: k, c, last, used, unit

      size_of = [1.0_wp, l%angle]
      last = columns_of(row%kind)
      line(:name_length) = ' '//row%name
      used = name_length
      do k = 0, 2
         do c = 1, last
            unit = merge(2, 1, c == 3 .or. row%angular)
            associate (field => line(used + 1:used + numeral_length))
               if (k > row%known) then
                  field = l%none
               else if (present(error)) then
                  call put_known(row%value(c, k)/size_of(unit), error(c, k)/size_of(unit), l%decimals(unit, k), &
                     l%power(unit, k), field)
               else
                  call put_fixed(row%value(c, k)/size_of(unit), l%decimals(unit, k), l%power(unit, k), field)
               end if
            end associate
            used = used + numeral_length
         end do
         if (k == 2 .or. last == 3) cycle
         line(used + 1:used + (3 - last)*numeral_length) = ''
         used = used + (3 - last)*numeral_length
      end do
      if (present(masked)) masked = masked .or. index(line(name_length + 1:used), unknown_digit) > 0
      call put(o, line(:used))
   end subroutine put_row

   !> A line without the blanks at its end, and without a copy.
   subroutine put_trimmed(o, line)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: line

      call put(o, line(:len_trim(line)))
   end subroutine put_trimmed

   !> Columns of one derivative: x, y, phi of a link; x, y of a point; the value of a pair.
   pure integer function columns_of(kind)
      integer, intent(in) :: kind

      columns_of = 3
      if (kind == request_point) columns_of = 2
      if (kind == request_pair) columns_of = 1
   end function columns_of

   pure function mark_text(mark, pl) result(text)
      integer, intent(in) :: mark
      logical, intent(in) :: pl
      character(:), allocatable :: text

      select case (mark)
      case (mark_not_converged)
         text = phrase(say_no_position, pl)
      case (mark_singular)
         text = phrase(say_no_rates, pl)
      case (mark_overflow)
         text = phrase(say_overflow, pl)
      case (mark_open)
         text = phrase(say_contradiction, pl)
      case default
         text = ''
      end select
   end function mark_text

   !> The last lines of a set: what is known of the branches on which its instants were found, then how many were solved
   !> and how many are marked; before them, where equations are redundant, by how much they differ (`gap`, in parts
   !> of the characteristic length; negative where none are); and other `remarks`.
   subroutine listing_end(o, m, solved, marked, tally, gap, remarks)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: solved, marked
      type(tally_t), intent(in) :: tally
      real(wp), intent(in), optional :: gap
      type(remark_t), intent(in), optional :: remarks(:)

      call put(o, '')
      if (present(gap)) then
         if (gap >= 0.0_wp) call put_gap(o, m, gap)
      end if
      if (present(remarks)) call put_remarks(o, m, remarks)
      call put(o, ' '//phrase(say_branch, m%polish)//':  '//phrase(say_followed, m%polish)//' '//whole(tally%followed) &
         //', '//phrase(say_passed, m%polish)//' '//whole(tally%passed) &
         //', '//phrase(say_uncertain, m%polish)//' '//whole(tally%uncertain))
      call put(o, ' '//phrase(say_end, m%polish)//' '//whole(m%set_number) &
         //':  '//phrase(say_solved, m%polish)//' '//whole(solved) &
         //', '//phrase(say_marked, m%polish)//' '//whole(marked))
      call put(o, '')
   end subroutine listing_end
end module listing
