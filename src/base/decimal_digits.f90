!> Decimal digits of binary numbers, correctly rounded, without the formats of the run-time library.
!>
!> x 10**k is formed as a sum p + e of two numbers: 10**k is held as high + low, p = x high as rounded, and
!> the rounding error of p comes from both factors split into halves whose products are exact (Dekker 1971,
!> Veltkamp's splitting).
!>
!> For 0 <= k <= 22 there is no low part: p + e is exact, and so is the decision, halves included. For any
!> other k the error is below 2**-104 p: 2**-106 p for low as rounded, as much for x low, 2**-105 p for its
!> sum with e. What so small an error could change is not decided here; then, as for any other kind of real,
!> the caller uses a format.
module decimal_digits
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   implicit none
   private
   public :: nearest_whole, leading_digits, put_whole, put_with_point, put_digits, put_leading, significant

   !> Digits that tell any two reals apart: 17 for 53 bits.
   integer, parameter :: significant = 2 + int(digits(1.0_wp)*log10(2.0))
   integer(int64), parameter :: least = 10_int64**(min(significant, 17) - 1)

   !> A kind that holds high + low; `wp` where there is none.
   integer, parameter :: long = max(selected_real_kind(2*precision(1.0_wp)), wp)
   logical, parameter :: able = digits(1.0_wp) == 53 .and. digits(1.0_long) >= 106

   !> Powers of ten at hand: -reach to reach, so that nothing overflows and no low part is denormal.
   integer, parameter :: reach = merge(250, 15, range(1.0_wp) > 300)
   integer :: k  !< of the constructor below, and never set; gfortran 12 does not take its declaration inside
   real(long), parameter :: powers(-reach:reach) = [(10.0_long**k, k = -reach, reach)]
   real(wp), parameter :: high(-reach:reach) = real(powers, wp)
   real(wp), parameter :: low(-reach:reach) = real(powers - real(high, long), wp)
   !> The last power without a low part: 5**22 < 2**53.
   integer, parameter :: last_exact = 22
   !> Over p: 16 times the error of p + e.
   real(wp), parameter :: doubt = 2.0_wp**(-100)
   !> Below `plain`, p alone mostly decides: its fraction is exact, and p is off by two roundings of 2**-53,
   !> those of high and of the product; half as much again is allowed for.
   real(wp), parameter :: plain = 2.0_wp**45, plain_kantorovich_ratio = 3.0_wp*2.0_wp**(-53)
   !> From here on the distance between two numbers p is 1/2, and e may be more than that.
   real(wp), parameter :: coarse = 2.0_wp**51

   !> Veltkamp's factor for 53 bits, and the halves of `high`.
   real(wp), parameter :: splitter = 2.0_wp**27 + 1.0_wp
   real(wp), parameter :: head(-reach:reach) = splitter*high - (splitter*high - high)
   real(wp), parameter :: tail(-reach:reach) = high - head

   !> 00 to 99.
   character(*), parameter :: pairs = &
      '00010203040506070809101112131415161718192021222324252627282930313233343536373839'// &
      '40414243444546474849505152535455565758596061626364656667686970717273747576777879'// &
      '8081828384858687888990919293949596979899'

contains

   !> The whole number `n` nearest to `x` 10**`k`, the even one of two; x >= 0. `sure`: it is decided and at
   !> most 2E17.
   pure subroutine nearest_whole(x, k, n, sure)
      real(wp), intent(in) :: x
      integer, intent(in) :: k
      integer(int64), intent(out) :: n
      logical, intent(out) :: sure
      real(wp) :: p, e, rest

      n = 0
      sure = .false.
      if (.not. able .or. abs(k) > reach) return
      ! What is not a number is not below anything either.
      if (.not. x < 2.0e17_wp*high(-k)) return
      p = x*high(k)
      if (p < plain) then
         n = int(p, int64)
         rest = p - real(n, wp)
         sure = abs(rest - 0.5_wp) > plain_kantorovich_ratio*p
         if (rest > 0.5_wp) n = n + 1
         if (sure) return
      end if
      ! Here p > 1/4: no denormal number in what follows.
      e = error_of(p, x, k)
      call round_sum(p, e, merge(0.0_wp, doubt*p, k >= 0 .and. k <= last_exact), n, sure)
   end subroutine nearest_whole

   !> `x` 10**`k` less its rounded product `p`.
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

   !> The whole number nearest to `p` + `e`, 1/4 < p, unless that is within `margin` of a half; a margin of 0
   !> says that the sum is exact.
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

   !> The 17 digits `n` and the exponent `e` of `x` > 0: x is n 10**(e - 16), 10**16 <= n < 10**17.
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
      ! The exponent of the power of two below x times log10(2), rounded down: for 2**-2000 to 2**2000 this
      ! ratio gives the same whole numbers as log10(2). It is e or e - 1.
      e = shifta(315653*(exponent(x) - 1), 20)
      if (x - high(e + 1) >= low(e + 1)) e = e + 1
      call nearest_whole(x, significant - 1 - e, n, sure)
      sure = sure .and. n >= least .and. n < 10*least
   end subroutine leading_digits

   !> The last digits of `n` >= 0, as many as `text` is long.
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

   !> All digits of `n` >= 0 at the end of `text`, from place `first`.
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

   !> `n` 10**-d with `d` >= 0 decimals, and a digit at least before the point, at the end of `text`, from
   !> place `first`.
   pure subroutine put_with_point(n, d, text, first)
      integer(int64), intent(in) :: n
      integer, intent(in) :: d
      character(*), intent(inout) :: text
      integer, intent(out) :: first
      integer(int64) :: rest, next
      integer :: point, i, pair

      point = len(text) - d
      rest = n
      do i = len(text) - 1, point + 1, -2
         next = rest/100
         pair = 2*int(rest - 100*next)
         text(i:i + 1) = pairs(pair + 1:pair + 2)
         rest = next
      end do
      if (mod(d, 2) == 1) then
         next = rest/10
         text(point + 1:point + 1) = achar(48 + int(rest - 10*next))
         rest = next
      end if
      text(point:point) = '.'
      call put_whole(rest, text(:point - 1), first)
   end subroutine put_with_point

   !> The 17 digits `n`, a point after the first.
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

   !> The eight digits of `n` < 10**8, in pairs that do not wait for each other.
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
end module decimal_digits
