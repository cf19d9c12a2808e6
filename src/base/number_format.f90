!> Numbers as text, correctly rounded: never asterisks, and in tables never a negative zero.
!>
!> A table needs very many numbers: their digits come from here, not from the formats of the run-time library.
!>
!> x 10**k is a sum p + e of two reals: 10**k is stored as high + low, p = x high as rounded, and the rounding error of
!> p follows from both factors split into halves whose products are exact (Dekker 1971, Veltkamp's splitting).
!>
!> For 0 <= k <= 22 there is no low part: p + e is exact, and the decision is exact, halves included. For any other k
!> the error is below 2**-104 p: 2**-106 p for low as rounded, as much for x low, 2**-105 p for its sum with e.
!> Decisions that so small an error could change, and other kinds of reals, are left to a format, which prints equal
!> digits.
module number_format
   use, intrinsic :: iso_fortran_env, only: int64
   use assertions, only: asserts, assert
   use kinds, only: wp
   implicit none
   private
   public :: fixed, write_fixed, whole, rounded, full, write_full, numeral_length, full_length
   public :: write_whole, write_with_point, write_minus, write_exponent, max_decimals
   public :: nearest_whole, tens

   !> Digits that tell any two reals apart: 17 for 53 bits.
   integer, parameter :: significant = 2 + int(digits(1.0_wp)*log10(2.0))
   integer :: k  !< index of the constructors below, never set: gfortran 12 rejects its declaration inside
   !> Powers of ten: all that fit in 64 bits.
   integer(int64), parameter :: tens(0:18) = [(10_int64**k, k = 0, 18)]

   !> A kind that holds high + low, or `wp` if there is none. `able`: p + e can be formed, with halves of 53 bits.
   integer, parameter :: long = max(selected_real_kind(2*precision(1.0_wp)), wp)
   logical, parameter :: able = digits(1.0_wp) == 53 .and. digits(1.0_long) >= 106

   !> The largest exponent of a power of ten in these tables: no power overflows, and no low part is denormal.
   integer, parameter :: largest_power = merge(250, 15, range(1.0_wp) > 300)
   real(long), parameter :: powers(-largest_power:largest_power) = [(10.0_long**k, k = -largest_power, largest_power)]
   real(wp), parameter :: high(-largest_power:largest_power) = real(powers, wp)
   real(wp), parameter :: low(-largest_power:largest_power) = real(powers - real(high, long), wp)
   !> The last power without a low part: 5**22 < 2**53.
   integer, parameter :: last_exact = 22
   !> 16 times the relative error of p + e.
   real(wp), parameter :: sum_margin = 2.0_wp**(-100)
   !> Below this bound p alone decides in most cases: the difference of p and a whole number is exact.
   real(wp), parameter :: plain = 2.0_wp**45
   !> The relative error of p and half as much again: p has two roundings of 2**-53, of `high` and of the product.
   real(wp), parameter :: plain_margin = 3.0_wp*2.0_wp**(-53)
   !> From here on neighbouring reals p differ by 1/2 or more, and e may be larger than 1/2.
   real(wp), parameter :: half_spacing = 2.0_wp**51

   !> Veltkamp's factor for 53 bits, and the halves of `high`.
   real(wp), parameter :: splitter = 2.0_wp**27 + 1.0_wp
   real(wp), parameter :: high_head(-largest_power:largest_power) = splitter*high - (splitter*high - high)
   real(wp), parameter :: high_tail(-largest_power:largest_power) = high - high_head

   !> Characters of a number in the tables, with one blank before it.
   integer, parameter :: numeral_length = 12
   !> Decimals of a number in the tables at most: a blank, a digit and the point stand before them.
   integer, parameter :: max_decimals = numeral_length - 3
   !> Digits of an exponent, and characters of a number in full: its sign, point, E and the exponent's sign are four.
   integer, parameter :: exponent_digits = merge(4, 3, range(1.0_wp) >= 1000)
   integer, parameter :: full_length = significant + 4 + exponent_digits

   !> Characters of an exponent in a table: its sign and at most four digits.
   integer, parameter :: table_exponent_length = 5

   !> Zero as `full` writes it.
   character(*), parameter :: full_zero = '0.'//repeat('0', significant - 1)//'E+'//repeat('0', exponent_digits)

   !> The pairs of digits 00 to 99.
   character(*), parameter :: pairs = &
      '00010203040506070809101112131415161718192021222324252627282930313233343536373839'// &
      '40414243444546474849505152535455565758596061626364656667686970717273747576777879'// &
      '8081828384858687888990919293949596979899'

contains

   !> Gives value 10**-power as text, correctly rounded and right-adjusted, with as many decimals as there is room for.
   !> The text has an exponent if the whole part is too long. A negative number has no zero before the point if nine
   !> decimals leave no room for the zero: -.012345678. Infinity and NaN are words.
   pure function fixed(value, decimals, power) result(text)
      real(wp), intent(in) :: value          !< the number, in any unit
      integer, intent(in) :: decimals        !< decimals at most, 0 or more
      integer, intent(in) :: power           !< of ten, by which the number is divided
      character(numeral_length) :: text

      call write_fixed(value, decimals, power, text)
   end function fixed

   !> Writes value 10**-power into a text, as `fixed` gives it. For the many numbers of a table this is faster.
   pure subroutine write_fixed(value, decimals, power, text)
      real(wp), intent(in) :: value          !< the number, in any unit
      integer, intent(in) :: decimals        !< decimals at most, 0 or more
      integer, intent(in) :: power           !< of ten, by which the number is divided
      character(numeral_length), intent(out) :: text   !< right-adjusted
      integer(int64) :: n
      integer :: d, room, first
      logical :: negative

      if (asserts) call assert(decimals >= 0, 'write_fixed: decimals')
      negative = sign(1.0_wp, value) < 0.0_wp
      ! Room for digits: without a blank, the point and the sign.
      room = numeral_length - 2 - merge(1, 0, negative)
      do d = min(decimals, max_decimals), 0, -1
         n = nearest_whole(abs(value), d - power)
         if (n >= tens(room)) cycle
         text = ''
         call write_with_point(n, d, text, first)
         if (negative .and. n > 0) call write_minus(d, first, text)
         return
      end do
      text = with_exponent(value, power)
   end subroutine write_fixed

   !> Writes the minus sign of a number before the number, or over the zero before its point if there is no room.
   pure subroutine write_minus(decimals, first, text)
      integer, intent(in) :: decimals        !< decimals of the number
      integer, intent(in) :: first           !< the character at which the number begins
      character(numeral_length), intent(inout) :: text   !< the number without its sign, right-adjusted
      integer :: column

      column = first - 1
      if (decimals == max_decimals) column = first
      text(column:column) = '-'
   end subroutine write_minus

   !> Gives value 10**-power as text with an exponent and as many digits as there is room for, right-adjusted. Infinity
   !> and NaN are words.
   pure function with_exponent(value, power) result(text)
      real(wp), intent(in) :: value          !< the number, in any unit; it may be infinite or NaN
      integer, intent(in) :: power           !< of ten, by which the number is divided
      character(numeral_length) :: text
      character(table_exponent_length) :: shown
      integer(int64) :: n
      integer :: d, e, first, last

      if (.not. abs(value) <= huge(value)) then
         write (text, '(f12.0)') value
         return
      end if
      do d = numeral_length - 8, 0, -1
         call first_digits(abs(value), d + 1, n, e)
         ! The power changes the exponent only: no digit is lost.
         call write_exponent(e - power, shown)
         last = numeral_length - 1 - len_trim(shown)
         if (d + merge(3, 2, value < 0.0_wp) < last) exit
      end do
      text(last + 1:) = 'E'//shown
      text(:last) = ''
      call write_with_point(n, d, text(:last), first)
      if (value < 0.0_wp) text(first - 1:first - 1) = '-'
   end function with_exponent

   !> Writes an exponent of ten with its sign and three digits, or four from 1000 on.
   pure subroutine write_exponent(exponent, text)
      integer, intent(in) :: exponent        !< between -9999 and 9999
      character(table_exponent_length), intent(out) :: text   !< left-adjusted

      text = merge('-', '+', exponent < 0)
      call write_digits(int(abs(exponent), int64), text(2:merge(4, table_exponent_length, abs(exponent) < 1000)))
   end subroutine write_exponent

   !> Gives a number as text in a few digits, rounded and without blanks: in fixed point if its size is 0 or within
   !> bounds, otherwise with an exponent.
   pure function rounded(value, digits, from, to) result(text)
      real(wp), intent(in) :: value          !< the number, in any unit
      real(wp), intent(in) :: from           !< the smallest size in fixed point, in the unit of `value`
      real(wp), intent(in) :: to             !< the size from which on there is an exponent, in the unit of `value`
      integer, intent(in) :: digits          !< how many digits, 1 or more
      character(:), allocatable :: text
      character(40) :: field
      character(12) :: form
      integer(int64) :: n
      integer :: order

      ! Rounding may make the number the next power of ten.
      call first_digits(abs(value), digits, n, order)
      if (abs(value) > 0.0_wp .and. (abs(value) < from .or. abs(value) >= to)) then
         write (form, '("(es30.", i0, a, ")")') digits - 1, trim(merge('e3', '  ', abs(order) > 99))
      else
         write (form, '("(f30.", i0, ")")') max(0, digits - 1 - order)
      end if
      write (field, form) value
      text = trim(adjustl(field))
   end function rounded

   !> Gives a whole number as text without blanks.
   pure function whole(i) result(text)
      integer, intent(in) :: i   !< any sign
      character(:), allocatable :: text
      character(12) :: field
      integer :: first

      call write_whole(abs(int(i, int64)), field, first)
      if (i < 0) then
         first = first - 1
         field(first:first) = '-'
      end if
      text = field(first:)
   end function whole

   !> Gives a number as text with as many digits as reading it back unchanged needs, with the sign of a zero.
   pure function full(value) result(text)
      real(wp), intent(in) :: value   !< any number; it may be infinite or NaN
      character(:), allocatable :: text
      character(full_length) :: field
      integer :: length

      call write_full(value, field, length)
      text = field(:length)
   end function full

   !> Writes a number with as many digits as reading it back unchanged needs. This is faster than `full`.
   pure subroutine write_full(value, text, length)
      real(wp), intent(in) :: value          !< any number; it may be infinite or NaN
      character(full_length), intent(out) :: text   !< left-adjusted
      integer, intent(out) :: length         !< characters of the number
      integer(int64) :: n, upper, first
      integer :: e
      logical :: sure
      character(20) :: form

      length = full_length - 1
      if (sign(1.0_wp, value) < 0.0_wp) length = full_length
      text(1:1) = '-'
      text(full_length:) = ''
      associate (number => text(length - full_length + 2:length))
         if (abs(value) <= 0.0_wp) then
            number = full_zero
            return
         end if

         call leading_digits(abs(value), significant, n, e, sure)
         if (sure) then
            ! Two halves, so that no pair of digits in one waits for the other: that is faster.
            upper = n/tens(8)
            call write_digits(upper, number(3:10), first)
            call write_digits(n - tens(8)*upper, number(11:18))
            number(1:1) = achar(48 + int(first))
            number(2:2) = '.'
            number(significant + 2:significant + 3) = merge('E-', 'E+', e < 0)
            call write_digits(int(abs(e), int64), number(significant + 4:))
            return
         end if
      end associate
      ! For some numbers only a format decides the digits.
      write (form, '(a,i0,a,i0,a,i0,a)') '(es', full_length, '.', significant - 1, 'e', exponent_digits, ')'
      write (text, form) value
      text = adjustl(text)
      length = len_trim(text)
   end subroutine write_full

   !> Writes the last digits of a whole number into a text, as many as the text has characters.
   pure subroutine write_digits(n, text, before)
      integer(int64), intent(in) :: n        !< 0 or more
      character(*), intent(inout) :: text    !< becomes digits only, with leading zeros
      integer(int64), intent(out), optional :: before   !< the rest of `n`: its digits before those written
      integer(int64) :: rest, next
      integer :: i, pair

      rest = n
      do i = len(text) - 1, 1, -2
         next = rest/100
         pair = 2*int(rest - 100*next)
         text(i:i + 1) = pairs(pair + 1:pair + 2)
         rest = next
      end do
      if (mod(len(text), 2) == 1) then
         next = rest/10
         text(1:1) = achar(48 + int(rest - 10*next))
         rest = next
      end if
      if (present(before)) before = rest
   end subroutine write_digits

   !> Writes all digits of a whole number at the end of a text. The characters before them stay.
   pure subroutine write_whole(n, text, first)
      integer(int64), intent(in) :: n        !< 0 or more
      character(*), intent(inout) :: text    !< as long as the digits at least
      integer, intent(out) :: first          !< the character at which the digits begin
      integer(int64) :: rest, next

      rest = n
      do first = len(text), 2, -1
         next = rest/10
         text(first:first) = achar(48 + int(rest - 10*next))
         rest = next
         if (rest == 0) return
      end do
      text(first:first) = achar(48 + int(rest))
   end subroutine write_whole

   !> Writes n 10**-decimals at the end of a text, with at least one digit before the point. The characters before the
   !> number stay.
   pure subroutine write_with_point(n, decimals, text, first)
      integer(int64), intent(in) :: n        !< 0 or more
      integer, intent(in) :: decimals        !< how many, 0 to 10
      character(*), intent(inout) :: text    !< as long as the number at least
      integer, intent(out) :: first          !< the character at which the number begins
      integer :: point
      integer(int64) :: rest

      point = len(text) - decimals
      call write_digits(n, text(point + 1:), rest)
      text(point:point) = '.'
      call write_whole(rest, text(:point - 1), first)
   end subroutine write_with_point

   !> Gives the whole number nearest to value 10**k, the even one of two equally near. If the number has more than 12
   !> digits, the result is 10**12 at least.
   pure integer(int64) function nearest_whole(value, k) result(n)
      real(wp), intent(in) :: value          !< a number, 0 or more
      integer, intent(in) :: k               !< exponent of ten, of any sign
      logical :: sure

      call decide_whole(value, k, n, sure)
      if (.not. sure) n = nearest_by_format(value, k)
   end function nearest_whole

   !> Finds the whole number nearest to value 10**k, the even one of two equally near, and tells whether the decision is
   !> certain. Source: Dekker, Numer. Math. 18 (1971) 224.
   pure subroutine decide_whole(value, k, n, sure)
      real(wp), intent(in) :: value          !< a number, 0 or more, or NaN
      integer, intent(in) :: k               !< exponent of ten, of any sign
      integer(int64), intent(out) :: n       !< the whole number, if `sure`; otherwise of no use
      logical, intent(out) :: sure           !< the decision is certain, and `n` is 2E17 at most
      real(wp) :: p, e, multiple, x_head, x_tail, rest, beyond, side
      integer :: carry

      n = 0
      sure = .false.
      if (.not. able .or. abs(k) > largest_power) return
      ! Written so that NaN returns too.
      if (.not. value < 2.0e17_wp*high(-k)) return
      p = value*high(k)
      if (p < plain) then
         ! The fraction of p is compared with 1/2. If the sum rounds, or the fraction is near 1/2, this is not sure.
         n = int(p + 0.5_wp, int64)
         sure = 0.5_wp - abs(p - real(n, wp)) > plain_margin*p
         if (sure) return
      end if
      ! Here p > 1/4, so that no number below is denormal. The error e = value 10**k - p, by halves of both factors:
      multiple = splitter*value
      x_head = multiple - (multiple - value)
      x_tail = value - x_head
      e = x_tail*high_tail(k) - (((p - x_head*high_head(k)) - x_tail*high_head(k)) - x_head*high_tail(k))
      e = e + value*low(k)

      n = int(p, int64)
      if (p - real(n, wp) > 0.5_wp) n = n + 1
      rest = p - real(n, wp)
      if (p >= half_spacing) then
         carry = int(e)
         n = n + carry
         e = e - real(carry, wp)
      end if
      ! Beyond 1/2 the next whole number is nearer. All differences are exact but for the last sum, whose sign is right.
      ! For an exact power p + e is exact, and the decision is certain.
      side = sign(1.0_wp, rest + e)
      beyond = (side*rest - 0.5_wp) + side*e
      sure = abs(beyond) > sum_margin*p .or. (k >= 0 .and. k <= last_exact)
      if (beyond > 0.0_wp .or. (.not. beyond < 0.0_wp .and. mod(n, 2_int64) == 1)) n = n + int(side)
   end subroutine decide_whole

   !> Finds the first digits of a number and its exponent: value = n 10**(exponent - count + 1), rounded.
   pure subroutine first_digits(value, count, n, exponent)
      real(wp), intent(in) :: value          !< a finite number, 0 or more
      integer, intent(in) :: count           !< how many digits, 1 to 18
      integer(int64), intent(out) :: n       !< 10**(count - 1) <= n < 10**count; 0 for 0
      integer, intent(out) :: exponent       !< of ten, of the first digit; 0 for 0
      logical :: sure

      call leading_digits(value, count, n, exponent, sure)
      if (.not. sure) call digits_by_format(value, count, n, exponent)
   end subroutine first_digits

   !> Finds the first digits of a number and its exponent by two reals, and tells whether these digits are certain. The
   !> value is n 10**(power - count + 1), rounded.
   pure subroutine leading_digits(value, count, n, power, sure)
      real(wp), intent(in) :: value          !< a number, 0 or more, or NaN
      integer, intent(in) :: count           !< how many digits, 1 to `significant`
      integer(int64), intent(out) :: n       !< 10**(count - 1) <= n < 10**count, if `sure`
      integer, intent(out) :: power          !< exponent of ten of the first digit, if `sure`
      logical, intent(out) :: sure           !< the digits are certain; never for 0

      n = 0
      power = 0
      sure = .false.
      if (.not. able) return
      if (.not. (value > high(significant - largest_power) .and. value < high(largest_power - 1))) return
      ! The exponent of the power of two below value times log10(2), rounded down, is power or power - 1. For 2**-2000
      ! to 2**2000 the ratio 315653/2**20 gives the same whole numbers as log10(2).
      power = shifta(315653*(exponent(value) - 1), 20)
      if (value - high(power + 1) >= low(power + 1)) power = power + 1
      call decide_whole(value, count - 1 - power, n, sure)
      if (n < tens(count)) return
      n = tens(count - 1)
      power = power + 1
   end subroutine leading_digits

   !> Gives the whole number nearest to value 10**k by formats, which round the decimal value. Beyond 12 digits, for
   !> infinity and for NaN the result is huge(n). Rejected: the scale factor kP. The library of gfortran prints wrong
   !> digits from -21P down. In a narrow field with some hundreds of P the library writes beyond its own buffer.
   pure function nearest_by_format(value, k) result(n)
      real(wp), intent(in) :: value          !< a number, 0 or more, or NaN
      integer, intent(in) :: k               !< exponent of ten, of any sign
      integer(int64) :: n
      character(80) :: line
      integer :: e, carried, places
      !> Digits of the largest number in a table; decimals of a format, enough to tell a half from its neighbours.
      integer, parameter :: max_places = 12, format_decimals = 60
      !> The text of an exact half.
      character(*), parameter :: five = '5.'//repeat('0', format_decimals)

      n = 0
      if (value <= 0.0_wp) return
      line = scientific(value, format_decimals)
      n = huge(n)
      if (index(line, 'E') == 0) return
      read (line(index(line, 'E') + 1:), '(i5)') e
      places = e + k + 1
      if (places > max_places) return
      n = 0
      ! places < 0: value 10**k < 1/10. places = 0: value 10**k < 1, and a half goes to 0, which is even.
      if (places == 0 .and. line(:len(five)) > five) n = 1
      if (places <= 0) return
      call digits_by_format(value, places, n, carried)
      n = n*tens(carried - e)
   end function nearest_by_format

   !> Finds the first digits of a number and its exponent by a format: value = n 10**(exponent - count + 1), rounded.
   pure subroutine digits_by_format(value, count, n, exponent)
      real(wp), intent(in) :: value          !< a finite number, 0 or more
      integer, intent(in) :: count           !< how many digits, 1 to 18
      integer(int64), intent(out) :: n       !< 10**(count - 1) <= n < 10**count; 0 for 0
      integer, intent(out) :: exponent       !< of ten, of the first digit; 0 for 0
      character(80) :: line

      line = scientific(value, count - 1)
      read (line(index(line, 'E') + 1:), '(i5)') exponent
      line = line(1:1)//line(3:index(line, 'E') - 1)
      read (line, '(i18)') n
   end subroutine digits_by_format

   !> Gives a number as text with one digit before the point and an exponent, left-adjusted. Infinity and NaN are words.
   pure function scientific(value, decimals) result(line)
      real(wp), intent(in) :: value   !< any number; it may be infinite or NaN
      integer, intent(in) :: decimals   !< digits after the point, 0 or more
      character(80) :: line
      character(12) :: form

      write (form, '(a,i0,a)') '(es80.', decimals, 'e4)'
      write (line, form) value
      line = adjustl(line)
   end function scientific
end module number_format
