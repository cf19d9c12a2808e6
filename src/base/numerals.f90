!> Numbers as text, correctly rounded: never asterisks, and in tables never a negative zero.
!>
!> A table needs very many numbers, so they are formed here and not by the formats of the run-time library. x 10**k is
!> a sum p + e of two reals: 10**k is held as high + low, p = x high as rounded, and the rounding error of p follows
!> from both factors split into halves whose products are exact (Dekker 1971, Veltkamp's splitting).
!>
!> For 0 <= k <= 22 there is no low part: p + e is exact, and so is the decision, halves included. For any other k the
!> error is below 2**-104 p: 2**-106 p for low as rounded, as much for x low, 2**-105 p for its sum with e. What so
!> small an error could change, and any other kind of real, is left to a format, which prints the same digits.
module numerals
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   implicit none
   private
   public :: fixed, put_fixed, whole, full, put_full, numeral_length, full_length, significant
   public :: nearest_whole, nearest_by_format, leading_digits, put_whole, put_with_point, put_digits, put_leading

   !> Digits that tell any two reals apart: 17 for 53 bits.
   integer, parameter :: significant = 2 + int(digits(1.0_wp)*log10(2.0))
   !> Characters of a number in the tables, one blank before it included.
   integer, parameter :: numeral_length = 12
   !> Digits of an exponent, and characters of a number in full, with its sign and that of its exponent.
   integer, parameter :: exponent_digits = merge(4, 3, range(1.0_wp) >= 1000)
   integer, parameter :: full_length = significant + 4 + exponent_digits

   !> Zero as `full` writes it.
   character(*), parameter :: full_zero = '0.'//repeat('0', significant - 1)//'E+'//repeat('0', exponent_digits)
   integer(int64), parameter :: tens(0:10) = 10_int64**[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]
   integer(int64), parameter :: least = 10_int64**(min(significant, 17) - 1)

   !> A kind that holds high + low; `wp` where there is none. `able`: p + e can be formed.
   integer, parameter :: long = max(selected_real_kind(2*precision(1.0_wp)), wp)
   logical, parameter :: able = digits(1.0_wp) == 53 .and. digits(1.0_long) >= 106

   !> The powers of ten 10**-reach to 10**reach: none overflows and no low part is denormal.
   integer, parameter :: reach = merge(250, 15, range(1.0_wp) > 300)
   integer :: k  !< index of the constructor below, never set: gfortran 12 rejects its declaration inside
   real(long), parameter :: powers(-reach:reach) = [(10.0_long**k, k = -reach, reach)]
   real(wp), parameter :: high(-reach:reach) = real(powers, wp)
   real(wp), parameter :: low(-reach:reach) = real(powers - real(high, long), wp)
   !> The last power without a low part: 5**22 < 2**53.
   integer, parameter :: last_exact = 22
   !> 16 times the relative error of p + e.
   real(wp), parameter :: sum_margin = 2.0_wp**(-100)
   !> Below `plain`, p alone decides in most cases: its fraction is exact, and p has two relative rounding errors of
   !> 2**-53, those of high and of the product. The margin is half as much again.
   real(wp), parameter :: plain = 2.0_wp**45, plain_margin = 3.0_wp*2.0_wp**(-53)
   !> From here on neighbouring reals p differ by 1/2 or more, and e may be larger than 1/2.
   real(wp), parameter :: coarse = 2.0_wp**51

   !> Veltkamp's factor for 53 bits, and the halves of `high`.
   real(wp), parameter :: splitter = 2.0_wp**27 + 1.0_wp
   real(wp), parameter :: head(-reach:reach) = splitter*high - (splitter*high - high)
   real(wp), parameter :: tail(-reach:reach) = high - head

   !> The pairs of digits 00 to 99.
   character(*), parameter :: pairs = &
      '00010203040506070809101112131415161718192021222324252627282930313233343536373839'// &
      '40414243444546474849505152535455565758596061626364656667686970717273747576777879'// &
      '8081828384858687888990919293949596979899'

contains

   !> `x` 10**-power, correctly rounded to at most `decimals` >= 0 decimals, right-adjusted: as many decimals as there
   !> is room for, and an exponent where even the whole part has no room.
   pure function fixed(x, decimals, power) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, power
      character(numeral_length) :: text

      call put_fixed(x, decimals, power, text)
   end function fixed

   !> `fixed`, written to `text`: faster for the many numbers of a table.
   pure subroutine put_fixed(x, decimals, power, text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, power
      character(numeral_length), intent(out) :: text
      integer(int64) :: n
      integer :: d, room, first
      logical :: negative, sure

      negative = sign(1.0_wp, x) < 0.0_wp
      ! Room for digits: without a blank, the point and the sign.
      room = numeral_length - 2 - merge(1, 0, negative)
      do d = min(decimals, room - 1), 0, -1
         call nearest_whole(abs(x), d - power, n, sure)
         if (.not. sure) n = nearest_by_format(abs(x), d - power)
         if (n >= tens(room)) cycle
         text = ''
         call put_with_point(n, d, text, first)
         if (negative .and. n > 0) text(first - 1:first - 1) = '-'
         return
      end do
      text = with_exponent(x, power)
   end subroutine put_fixed

   !> The whole number nearest to `x` 10**`k`, x >= 0, by formats, which round the decimal value of x; huge(n) if it has
   !> more than 12 digits. Rejected: the scale factor kP. The library of gfortran prints wrong digits from -21P down,
   !> and in a narrow field with some hundreds of P it writes beyond its own buffer.
   pure function nearest_by_format(x, k) result(n)
      real(wp), intent(in) :: x
      integer, intent(in) :: k
      integer(int64) :: n
      character(80) :: line
      integer :: e, carried, places
      integer, parameter :: max_places = 12, many = 60
      character(*), parameter :: five = '5.'//repeat('0', many)

      n = 0
      if (x <= 0.0_wp) return
      line = scientific(x, many)
      n = huge(n)
      if (index(line, 'E') == 0) return
      e = exponent_of(line)
      places = e + k + 1
      if (places > max_places) return
      n = 0
      ! places < 0: x 10**k < 1/10. places = 0: x 10**k < 1, and a half goes to 0, which is even.
      if (places == 0 .and. line(:len(five)) > five) n = 1
      if (places <= 0) return
      line = scientific(x, places - 1)
      carried = exponent_of(line) - e
      line(2:) = line(3:min(index(line, 'E'), len(line)) - 1)
      read (line, '(i12)') n
      n = n*tens(carried)
   end function nearest_by_format

   !> `x` with one digit before the point and `decimals` after it, and an exponent, left-adjusted.
   pure function scientific(x, decimals) result(line)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals
      character(80) :: line
      character(12) :: form

      write (form, '(a,i0,a)') '(es80.', decimals, 'e4)'
      write (line, form) x
      line = adjustl(line)
   end function scientific

   !> The exponent of the number that `scientific` wrote to `line`.
   pure integer function exponent_of(line)
      character(*), intent(in) :: line

      read (line(index(line, 'E') + 1:), '(i5)') exponent_of
   end function exponent_of

   !> `x` 10**-power with an exponent and as many digits as there is room for, right-adjusted.
   pure function with_exponent(x, power) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: power
      character(numeral_length) :: text
      character(80) :: line
      character(6) :: shown
      integer :: d

      do d = numeral_length - 8, 0, -1
         line = scientific(x, d)
         if (index(line, 'E') == 0) exit
         ! The power changes the exponent only: no digit is lost.
         write (shown, '(sp,i6.3)') exponent_of(line) - power
         line(index(line, 'E') + 1:) = adjustl(shown)
         if (len_trim(line) < numeral_length) exit
      end do
      text = adjustr(line(:numeral_length))
   end function with_exponent

   !> A whole number without blanks.
   pure function whole(i) result(text)
      integer, intent(in) :: i
      character(:), allocatable :: text
      character(12) :: field
      integer :: first

      call put_whole(abs(int(i, int64)), field, first)
      if (i < 0) then
         first = first - 1
         field(first:first) = '-'
      end if
      text = field(first:)
   end function whole

   !> `x` with so many significant digits that it reads back as the same number, the sign of a zero included.
   pure function full(x) result(text)
      real(wp), intent(in) :: x
      character(:), allocatable :: text
      character(full_length) :: field
      integer :: length

      call put_full(x, field, length)
      text = field(:length)
   end function full

   !> `full`, written left-adjusted to `text`, and its `length`.
   pure subroutine put_full(x, text, length)
      real(wp), intent(in) :: x
      character(full_length), intent(out) :: text
      integer, intent(out) :: length
      integer(int64) :: n
      integer :: e
      logical :: sure

      length = full_length - 1
      if (sign(1.0_wp, x) < 0.0_wp) length = full_length
      text(1:1) = '-'
      text(full_length:) = ''
      associate (number => text(length - full_length + 2:length))
         if (abs(x) <= 0.0_wp) then
            number = full_zero
            return
         end if
         call leading_digits(abs(x), n, e, sure)
         if (sure) then
            call put_leading(n, number(:significant + 1))
            number(significant + 2:significant + 3) = merge('E-', 'E+', e < 0)
            call put_digits(int(abs(e), int64), number(significant + 4:))
            return
         end if
      end associate
      text = full_by_format(x)
      length = len_trim(text)
   end subroutine put_full

   !> `full` by a format, for numbers that `leading_digits` does not decide.
   pure function full_by_format(x) result(text)
      real(wp), intent(in) :: x
      character(full_length) :: text
      character(20) :: form

      write (form, '(a,i0,a,i0,a,i0,a)') '(es', full_length, '.', significant - 1, 'e', exponent_digits, ')'
      write (text, form) x
      text = adjustl(text)
   end function full_by_format

   !> `n` is the whole number nearest to `x` 10**`k`, the even one of two equally near; x >= 0. `sure`: that is certain,
   !> and n is at most 2E17. Source: Dekker, Numer. Math. 18 (1971) 224.
   pure subroutine nearest_whole(x, k, n, sure)
      real(wp), intent(in) :: x
      integer, intent(in) :: k
      integer(int64), intent(out) :: n
      logical, intent(out) :: sure
      real(wp) :: p, e, rest

      n = 0
      sure = .false.
      if (.not. able .or. abs(k) > reach) return
      ! Written so that NaN returns too.
      if (.not. x < 2.0e17_wp*high(-k)) return
      p = x*high(k)
      if (p < plain) then
         n = int(p, int64)
         rest = p - real(n, wp)
         sure = abs(rest - 0.5_wp) > plain_margin*p
         if (rest > 0.5_wp) n = n + 1
         if (sure) return
      end if
      ! Here p > 1/4: no denormal number in what follows.
      e = error_of(p, x, k)
      call round_sum(p, e, merge(0.0_wp, sum_margin*p, k >= 0 .and. k <= last_exact), n, sure)
   end subroutine nearest_whole

   !> The rounding error `x` 10**`k` - `p` of the product p.
   pure real(wp) function error_of(p, x, k) result(e)
      real(wp), intent(in) :: p, x
      integer, intent(in) :: k
      real(wp) :: x_head, x_tail, multiple

      multiple = splitter*x
      x_head = multiple - (multiple - x)
      x_tail = x - x_head
      e = x_tail*tail(k) - (((p - x_head*head(k)) - x_tail*head(k)) - x_head*tail(k))
      e = e + x*low(k)
   end function error_of

   !> `n` is the whole number nearest to `p` + `e`, p > 1/4. `sure`: the sum is not within `margin` of a half. A margin
   !> of 0 means that the sum is exact, and then `n` is always sure.
   pure subroutine round_sum(p, e, margin, n, sure)
      real(wp), intent(in) :: p, e, margin
      integer(int64), intent(out) :: n
      logical, intent(out) :: sure
      real(wp) :: rest, small, beyond, side
      integer :: carry

      n = int(p, int64)
      if (p - real(n, wp) > 0.5_wp) n = n + 1
      rest = p - real(n, wp)
      small = e
      if (p >= coarse) then
         carry = int(e)
         n = n + carry
         small = e - real(carry, wp)
      end if
      ! All differences are exact but for the last sum, whose sign is right.
      side = sign(1.0_wp, rest + small)
      beyond = (side*rest - 0.5_wp) + side*small
      sure = abs(beyond) > margin .or. .not. margin > 0.0_wp
      if (beyond > 0.0_wp .or. (.not. beyond < 0.0_wp .and. mod(n, 2_int64) == 1)) n = n + int(side)
   end subroutine round_sum

   !> The 17 digits `n` and the exponent `e` of `x` > 0: x = n 10**(e - 16), 10**16 <= n < 10**17. `sure`: they are
   !> certain.
   pure subroutine leading_digits(x, n, e, sure)
      real(wp), intent(in) :: x
      integer(int64), intent(out) :: n
      integer, intent(out) :: e
      logical, intent(out) :: sure

      n = 0
      e = 0
      sure = .false.
      if (.not. able) return
      if (.not. (x > high(significant - reach) .and. x < high(reach - 1))) return
      ! The exponent of the power of two below x times log10(2), rounded down, is e or e - 1. For 2**-2000 to 2**2000
      ! the ratio 315653/2**20 gives the same whole numbers as log10(2).
      e = shifta(315653*(exponent(x) - 1), 20)
      if (x - high(e + 1) >= low(e + 1)) e = e + 1
      call nearest_whole(x, significant - 1 - e, n, sure)
      sure = sure .and. n >= least .and. n < 10*least
   end subroutine leading_digits

   !> Writes the last digits of `n` >= 0, as many as `text` is long.
   pure subroutine put_digits(n, text)
      integer(int64), intent(in) :: n
      character(*), intent(inout) :: text
      integer(int64) :: rest, next
      integer :: i, pair

      rest = n
      do i = len(text) - 1, 1, -2
         next = rest/100
         pair = 2*int(rest - 100*next)
         text(i:i + 1) = pairs(pair + 1:pair + 2)
         rest = next
      end do
      if (mod(len(text), 2) == 1) text(1:1) = achar(48 + int(rest - 10*(rest/10)))
   end subroutine put_digits

   !> Writes all digits of `n` >= 0 at the end of `text`, from its character `first` on.
   pure subroutine put_whole(n, text, first)
      integer(int64), intent(in) :: n
      character(*), intent(inout) :: text
      integer, intent(out) :: first
      integer(int64) :: rest, next

      rest = n
      do first = len(text), 2, -1
         next = rest/10
         text(first:first) = achar(48 + int(rest - 10*next))
         rest = next
         if (rest == 0) return
      end do
      text(first:first) = achar(48 + int(rest))
   end subroutine put_whole

   !> Writes `n` 10**-d with `d` decimals, 0 to 10, and at least one digit before the point, at the end of `text`, from
   !> its character `first` on.
   pure subroutine put_with_point(n, d, text, first)
      integer(int64), intent(in) :: n
      integer, intent(in) :: d
      character(*), intent(inout) :: text
      integer, intent(out) :: first
      integer :: point

      point = len(text) - d
      call put_digits(n, text(point + 1:))
      text(point:point) = '.'
      call put_whole(n/tens(d), text(:point - 1), first)
   end subroutine put_with_point

   !> Writes the 17 digits of `n`, a point after the first.
   pure subroutine put_leading(n, text)
      integer(int64), intent(in) :: n
      character(18), intent(inout) :: text
      integer(int64), parameter :: eight = 10_int64**8
      integer(int64) :: upper, first

      upper = n/eight
      first = upper/eight
      text(1:1) = achar(48 + int(first))
      text(2:2) = '.'
      call put_eight(int(upper - eight*first), text(3:10))
      call put_eight(int(n - eight*upper), text(11:18))
   end subroutine put_leading

   !> Writes the eight digits of `n` < 10**8. No pair of digits needs the result of another: that is faster.
   pure subroutine put_eight(n, text)
      integer, intent(in) :: n
      character(8), intent(inout) :: text
      integer :: upper, lower, first, third

      upper = n/10000
      lower = n - 10000*upper
      first = upper/100
      third = lower/100
      text(1:2) = pairs(2*first + 1:2*first + 2)
      text(3:4) = pairs(2*(upper - 100*first) + 1:2*(upper - 100*first) + 2)
      text(5:6) = pairs(2*third + 1:2*third + 2)
      text(7:8) = pairs(2*(lower - 100*third) + 1:2*(lower - 100*third) + 2)
   end subroutine put_eight
end module numerals
