!> The decimal digits of numbers, correctly rounded.
!>
!> x 10**k is a sum p + e of two reals: 10**k is held as high + low, p = x high as rounded, and the rounding error of p
!> follows from both factors split into halves whose products are exact (Dekker 1971, Veltkamp's splitting).
!>
!> For 0 <= k <= 22 there is no low part: p + e is exact, and so is the decision, halves included. For any other k the
!> error is below 2**-104 p: 2**-106 p for low as rounded, as much for x low, 2**-105 p for its sum with e. What so
!> small an error could change, and any other kind of real, is left to a format, which prints the same digits.
module decimal_digits
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   implicit none
   private
   public :: nearest_whole, decide_whole, first_digits, leading_digits, significant, tens

   !> Digits that tell any two reals apart: 17 for 53 bits.
   integer, parameter :: significant = 2 + int(digits(1.0_wp)*log10(2.0))
   integer :: k  !< index of the constructors below, never set: gfortran 12 rejects its declaration inside
   integer(int64), parameter :: tens(0:18) = [(10_int64**k, k = 0, 18)]

   !> A kind that holds high + low; `wp` where there is none. `able`: p + e can be formed.
   integer, parameter :: long = max(selected_real_kind(2*precision(1.0_wp)), wp)
   logical, parameter :: able = digits(1.0_wp) == 53 .and. digits(1.0_long) >= 106

   !> The powers of ten 10**-reach to 10**reach: none overflows and no low part is denormal.
   integer, parameter :: reach = merge(250, 15, range(1.0_wp) > 300)
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

contains

   !> The whole number nearest to `x` 10**`k`, x >= 0, the even one of two equally near; at least 10**12 if it has more
   !> than 12 digits.
   pure integer(int64) function nearest_whole(x, k) result(n)
      real(wp), intent(in) :: x
      integer, intent(in) :: k
      logical :: sure

      call decide_whole(x, k, n, sure)
      if (.not. sure) n = nearest_by_format(x, k)
   end function nearest_whole

   !> `n` is the whole number nearest to `x` 10**`k`, the even one of two equally near; x >= 0. `sure`: that is certain,
   !> and n is at most 2E17. Source: Dekker, Numer. Math. 18 (1971) 224.
   pure subroutine decide_whole(x, k, n, sure)
      real(wp), intent(in) :: x
      integer, intent(in) :: k
      integer(int64), intent(out) :: n
      logical, intent(out) :: sure
      real(wp) :: p, e

      n = 0
      sure = .false.
      if (.not. able .or. abs(k) > reach) return
      ! Written so that NaN returns too.
      if (.not. x < 2.0e17_wp*high(-k)) return
      p = x*high(k)
      if (p < plain) then
         ! In which half the fraction is has no rule, and is no question. Where the sum rounds, that is not sure.
         n = int(p + 0.5_wp, int64)
         sure = 0.5_wp - abs(p - real(n, wp)) > plain_margin*p
         if (sure) return
      end if
      ! Here p > 1/4: no denormal number in what follows.
      e = error_of(p, x, k)
      call round_sum(p, e, merge(0.0_wp, sum_margin*p, k >= 0 .and. k <= last_exact), n, sure)
   end subroutine decide_whole

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

   !> The first `count` digits `n` of the finite number `x` >= 0 and their exponent: x = n 10**(e - count + 1), rounded,
   !> 10**(count - 1) <= n < 10**count; both are 0 for x = 0.
   pure subroutine first_digits(x, count, n, e)
      real(wp), intent(in) :: x
      integer, intent(in) :: count
      integer(int64), intent(out) :: n
      integer, intent(out) :: e
      logical :: sure

      call leading_digits(x, count, n, e, sure)
      if (.not. sure) call digits_by_format(x, count, n, e)
   end subroutine first_digits

   !> The same of `x` > 0; `sure`: they are certain.
   pure subroutine leading_digits(x, count, n, e, sure)
      real(wp), intent(in) :: x
      integer, intent(in) :: count
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
      call decide_whole(x, count - 1 - e, n, sure)
      if (n < tens(count)) return
      n = tens(count - 1)
      e = e + 1
   end subroutine leading_digits

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
      call digits_by_format(x, places, n, carried)
      n = n*tens(carried - e)
   end function nearest_by_format

   !> `first_digits` by a format.
   pure subroutine digits_by_format(x, count, n, e)
      real(wp), intent(in) :: x
      integer, intent(in) :: count
      integer(int64), intent(out) :: n
      integer, intent(out) :: e
      character(80) :: line

      line = scientific(x, count - 1)
      e = exponent_of(line)
      line = line(1:1)//line(3:index(line, 'E') - 1)
      read (line, '(i18)') n
   end subroutine digits_by_format

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
end module decimal_digits
