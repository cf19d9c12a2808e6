!> The tables of the listing: heads, rows, and the units of their columns.
module listing_tables
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_t, request_point, request_pair
   use motion, only: motion_t
   use points, only: row_t, row_of
   use error_estimate, only: error_estimate_t, row_estimate
   use text_output, only: output_t, put
   use numerals, only: put_fixed, whole, numeral_length
   use known_digits, only: put_known, unknown_digit
   use layout, only: layout_t, digits_t, digits_of, column_powers, name_length, row_length
   use phrases, only: phrase, say_phi
   implicit none
   private
   public :: table_t, put_requested, put_units

   !> The table at hand: the kind of its rows, 0 where there is none yet; the powers of ten of its columns; `masked`: a
   !> digit of the instant is.
   type :: table_t
      integer :: kind = 0
      integer :: power(9) = 0
      logical :: masked = .false.
   end type table_t

contains

   !> The row that `request`, number `i` of the set, asks for of the motion `q` of `m`, under heads of its own where it
   !> is another table's.
   subroutine put_requested(o, l, i, m, q, request, table, kantorovich_ratio)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      integer, intent(in) :: i
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(table_t), intent(inout) :: table
      type(error_estimate_t), intent(in), optional :: kantorovich_ratio
      logical :: is_known

      is_known = .true.
      if (present(kantorovich_ratio)) is_known = .not. (kantorovich_ratio%taken .and. kantorovich_ratio%in_doubt)
      associate (d => digits_of(l, i), row => row_of(m, q, request))
         call put_heads(o, l, d, row, table)
         if (is_known) then
            call put_row(o, l, d, row)
         else
            call put_row(o, l, d, row, row_estimate(m, kantorovich_ratio, request), table%masked)
         end if
      end associate
   end subroutine put_requested

   !> The heads of the table that `row` is in; where each table has its own powers of ten, a line of them.
   subroutine put_heads(o, l, d, row, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      type(row_t), intent(in) :: row
      type(table_t), intent(inout) :: table
      character(row_length) :: line
      integer :: power(9), k

      power = 0
      if (l%mixed) power = column_powers(d, row%kind, row%angular)
      if (row%kind == table%kind .and. all(power == table%power)) return
      table%kind = row%kind
      table%power = power
      call put_trimmed(o, l%heads(row%kind))
      if (all(power == 0)) return
      line = ''
      do k = 1, size(power)
         if (power(k) /= 0) line(name_length + 1 + numeral_length*(k - 1):name_length + numeral_length*k) = &
            repeat(' ', numeral_length - len('10**'//whole(power(k))))//'10**'//whole(power(k))
      end do
      call put_trimmed(o, line)
   end subroutine put_heads

   !> One row with the digits `d`: what is not known is a word, what the row does not have is blank. `error` (3, 0:2),
   !> where it is given, is unknown of the numbers; `masked`: a digit is.
   subroutine put_row(o, l, d, row, error, masked)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
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
                  call put_known(row%value(c, k)/size_of(unit), error(c, k)/size_of(unit), d%decimals(unit, k), &
                     d%power(unit, k), field)
               else
                  call put_fixed(row%value(c, k)/size_of(unit), d%decimals(unit, k), d%power(unit, k), field)
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

   !> The unit of each column, with its power of ten where there is one.
   subroutine put_units(o, l, m)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      character(:), allocatable :: turn
      character(:), allocatable :: per
      integer :: k, power(2, 0:2)
      character(2), parameter :: prefix(0:2) = ['  ', 'V ', 'A ']

      power = l%power
      ! Each table has its own.
      if (l%mixed) power = 0
      turn = trim(merge('DEG', 'RAD', m%degrees))
      call put(o, ' T '//unit_of(l%time_power, trim(m%time_unit)))
      do k = 0, 2
         per = ''
         if (k == 1) per = '/'//trim(m%time_unit)
         if (k == 2) per = '/'//trim(m%time_unit)//'**2'
         call put(o, ' '//trim(prefix(k))//'X, '//trim(prefix(k))//'Y ' &
            //unit_of(power(1, k), trim(m%length_unit)//per) &
            //'   '//trim(prefix(k))//phrase(say_phi, m%polish)//' '//unit_of(power(2, k), turn//per))
      end do
   end subroutine put_units

   pure function unit_of(power, unit) result(text)
      integer, intent(in) :: power
      character(*), intent(in) :: unit
      character(:), allocatable :: text

      text = '['//unit//']'
      if (power /= 0) text = '[10**'//whole(power)//' '//unit//']'
   end function unit_of
end module listing_tables
