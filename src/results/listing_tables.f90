!> The tables of the listing: digits, powers of ten, units, heads of columns, rows.
!>
!> Digits: positions, velocities and accelerations are printed with the decimals, and where need be the power
!> of ten, that give seven digits to the deck's characteristic length and rate; so one mechanism in
!> millimetres and in kilometres prints the same digits.
module listing_tables
   use kinds, only: wp
   use constants, only: degree
   use mechanism, only: mechanism_t, request_t, request_link, request_point, request_pair
   use independent, only: parts_t, find_parts
   use scales, only: characteristic_length, characteristic_rate
   use motion, only: motion_t
   use points, only: row_t, row_of
   use error_estimate, only: error_estimate_t, row_estimate
   use text_output, only: output_t, put
   use numerals, only: put_fixed, whole, numeral_length
   use known_digits, only: put_known, unknown_digit
   use phrases
   implicit none
   private
   public :: layout_t, new_layout, name_length, row_length, table_t, put_requested, put_units

   integer, parameter :: digits_after_first = 6
   !> Characters before a row's numbers, and of a whole row.
   integer, parameter :: name_length = 9, row_length = name_length + 9*numeral_length

   !> Decimals and powers of ten: (length or angle, derivative).
   type :: digits_t
      integer :: decimals(2, 0:2) = digits_after_first   !< digits after the point
      integer :: power(2, 0:2) = 0                       !< printed is the value over 10**power
   end type digits_t

   !> The digits of the set, and of each of its independent mechanisms where they are not all the same.
   type, extends(digits_t) :: layout_t
      type(digits_t), allocatable :: own(:)   !< (parts)
      integer, allocatable :: part(:)         !< (requests) 0: of the ground
      logical :: mixed = .false.              !< their powers of ten differ: each table has its own in its heads
      integer :: time_decimals = digits_after_first   !< of the instants, as above
      integer :: time_power = 0
      real(wp) :: angle = 1.0_wp           !< radians in the unit in which angles are printed
      character(row_length) :: heads(3)    !< by the kind of a request
      character(numeral_length) :: none    !< in the place of a number that does not exist
      character(:), allocatable :: instant !< before the number of an instant
   end type layout_t

   !> The table at hand: the kind of its rows, 0 where there is none yet; the powers of ten of its columns; `masked`: a
   !> digit of the instant is.
   type :: table_t
      integer :: kind = 0                  !< of its rows: request_link, ...; 0: no table yet
      integer :: power(9) = 0              !< (columns) of ten in its heads
      logical :: masked = .false.          !< some digit is a question mark
   end type table_t

contains

   !> The layout of the tables of `m`, from its deck alone. `parts`, `own`: as from `find_parts`, which finds them where
   !> they are not given.
   function new_layout(m, parts, own) result(l)
      type(mechanism_t), intent(in) :: m
      type(parts_t), intent(in), optional :: parts
      type(mechanism_t), intent(in), optional :: own(:)
      type(layout_t) :: l
      type(parts_t) :: new_parts
      type(mechanism_t), allocatable :: new_own(:)
      real(wp) :: time
      integer :: k

      if (m%degrees) l%angle = degree
      l%digits_t = digits_for(m, l%angle)
      if (present(parts)) then
         call take_parts(l, parts, own)
      else
         call find_parts(m, new_parts, new_own)
         call take_parts(l, new_parts, new_own)
      end if
      time = max(abs(m%t0), abs(m%t1), maxval([0.0_wp, abs(m%at)]))
      if (time > 0.0_wp) call choose_digits(log10(time), l%time_decimals, l%time_power)
      do k = 1, size(l%heads)
         l%heads(k) = column_heads(k, m%polish)
      end do
      l%none = phrase(say_none, m%polish)
      l%none = adjustr(l%none)
      l%instant = ' '//phrase(say_instant, m%polish)//' '
   end function new_layout

   !> The digits of one mechanism; `angle`: radians in the unit in which angles are printed.
   pure type(digits_t) function digits_for(m, angle) result(d)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: angle
      real(wp) :: length, rate
      integer :: k

      length = characteristic_length(m)
      rate = characteristic_rate(m, length)
      do k = 0, 2
         call choose_digits(log10(length) + k*log10(rate), d%decimals(1, k), d%power(1, k))
         call choose_digits(k*log10(rate) + log10(merge(1.0_wp/angle, 1.0_wp, k > 0)), &
            d%decimals(2, k), d%power(2, k))
      end do
   end function digits_for

   !> Each of several mechanisms `m` (parts) has its own digits. Where none has more than one decimal more than another,
   !> all have those of the largest.
   pure subroutine take_parts(l, parts, m)
      type(layout_t), intent(inout) :: l
      type(parts_t), intent(in) :: parts
      type(mechanism_t), intent(in) :: m(:)
      type(digits_t) :: own(parts%count), largest
      integer :: c

      if (parts%count == 1) return
      do c = 1, size(own)
         own(c) = digits_for(m(c), l%angle)
      end do
      l%digits_t = own(1)
      largest = own(1)
      do c = 2, size(own)
         l%mixed = l%mixed .or. any(own(c)%power /= own(1)%power)
         l%decimals = min(l%decimals, own(c)%decimals)
         largest%decimals = max(largest%decimals, own(c)%decimals)
      end do
      if (.not. l%mixed .and. all(largest%decimals - l%decimals <= 1)) return
      l%own = own
      l%part = parts%part
   end subroutine take_parts

   !> The digits of request number `i`.
   pure type(digits_t) function digits_of(l, i) result(d)
      type(layout_t), intent(in) :: l
      integer, intent(in) :: i

      d = l%digits_t
      if (.not. allocated(l%own)) return
      if (l%part(i) > 0) d = l%own(l%part(i))
   end function digits_of

   !> The powers of ten of the columns of a row of the given `kind` (9): what it does not have is 0.
   pure function column_powers(d, kind, angular) result(power)
      type(digits_t), intent(in) :: d
      integer, intent(in) :: kind
      logical, intent(in) :: angular
      integer :: power(9)

      power = 0
      power(1::3) = d%power(merge(2, 1, angular), :)
      if (kind == request_pair) return
      power(2::3) = d%power(1, :)
      if (kind == request_link) power(3::3) = d%power(2, :)
   end function column_powers

   !> Decimals and power of ten for values of order 10**`order`: seven digits, no power as long as they fit.
   pure subroutine choose_digits(order, decimals, power)
      real(wp), intent(in) :: order
      integer, intent(out) :: decimals, power
      integer :: k
      ! An order that is a whole number but for rounding counts as one.
      real(wp), parameter :: margin = max(1.0e-9_wp, 32.0_wp*epsilon(1.0_wp))

      k = floor(order + margin)
      power = 0
      if (k < -2 .or. k > 4) power = 3*floor(real(k, wp)/3.0_wp + margin)
      decimals = digits_after_first - (k - power)
   end subroutine choose_digits

   !> The heads over rows of one kind, right-adjusted over their numbers.
   pure function column_heads(kind, polish) result(line)
      integer, intent(in) :: kind
      logical, intent(in) :: polish
      character(row_length) :: line
      character(numeral_length) :: words(9)
      integer :: k
      character(1), parameter :: prefix(0:2) = [' ', 'V', 'A']
      type(phrase_t), parameter :: kind_words(3) = [say_link, say_point, say_pair]

      words = ''
      select case (kind)
      case (request_link, request_point)
         do k = 0, 2
            words(3*k + 1) = trim(prefix(k))//'X'
            words(3*k + 2) = trim(prefix(k))//'Y'
            if (kind == request_link) words(3*k + 3) = trim(prefix(k))//phrase(say_phi, polish)
         end do
      case (request_pair)
         words(1::3) = [character(numeral_length) :: &
            phrase(say_value, polish), phrase(say_rate, polish), phrase(say_acceleration, polish)]
      end select
      line = ' '//phrase(kind_words(kind), polish)
      do k = 1, size(words)
         line(name_length + 1 + numeral_length*(k - 1):name_length + numeral_length*k) = adjustr(words(k))
      end do
   end function column_heads

   !> The row that `request`, number `i` of the set, asks for of the motion `q` of `m`, under heads of its own where it
   !> is another table's. `errors`: how far the motion is known.
   subroutine put_requested(o, l, i, m, q, request, errors, table)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      integer, intent(in) :: i
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(error_estimate_t), intent(in) :: errors
      type(table_t), intent(inout) :: table

      associate (d => digits_of(l, i), row => row_of(m, q, request))
         call put_heads(o, l, d, row, table)
         if (errors%taken .and. errors%in_doubt) then
            call put_row(o, l, d, row, row_estimate(m, errors, request), table%masked)
         else
            call put_row(o, l, d, row)
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
   !> where it is given, is unknown of the numbers; `masked`: a digit of some row is masked.
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

   !> A unit in brackets, with a power of ten if there is one.
   pure function unit_of(power, unit) result(text)
      integer, intent(in) :: power
      character(*), intent(in) :: unit
      character(:), allocatable :: text

      text = '['//unit//']'
      if (power /= 0) text = '[10**'//whole(power)//' '//unit//']'
   end function unit_of
end module listing_tables
