!> Tests. Numbers of real128 as a table must print them, in fields of twelve columns: with so many decimals, fewer where
!> there is no room, with an exponent where that is not enough; digits that are not known are question marks.
module expected_numbers
   use, intrinsic :: iso_fortran_env, only: int64
   use quad_jet, only: qp
   implicit none
   private
   public :: number_by_hand, power_text, field_length

   integer, parameter :: field_length = 12
   !> Of a number below 1 a field has room for a blank, a zero or a sign, the point, and these.
   integer, parameter :: most_decimals = 9
   !> A shown digit is worth a hundred errors or more.
   real(qp), parameter :: errors_a_digit = 100.0_qp

contains

   !> `x` over 10**`power`; `error` (none: 0) is unknown of it.
   function number_by_hand(x, error, decimals, power) result(text)
      real(qp), intent(in) :: x, error
      integer, intent(in) :: decimals, power
      character(field_length) :: text
      real(qp) :: scaled
      integer :: last

      scaled = x/10.0_qp**power
      ! The place of the last digit that is shown: 0 is that of the ones.
      last = -decimals
      if (error > 0.0_qp) last = max(last, ceiling(log10(errors_a_digit*error/10.0_qp**power)))
      text = ''
      if (last > -decimals) text = masked(scaled, last, decimals)
      if (text == '') text = plain(scaled, decimals)
   end function number_by_hand

   !> The power of ten over a column; '' for 1.
   function power_text(power) result(text)
      integer, intent(in) :: power
      character(field_length) :: text

      text = ''
      if (power /= 0) write (text, '("1.E", sp, i0.2)') power
   end function power_text

   !> Room for digits and a sign: the field begins with a blank and has a point.
   integer function room(x)
      real(qp), intent(in) :: x

      room = field_length - 2
      if (x < 0.0_qp) room = room - 1
   end function room

   !> All digits of `x`, as many decimals as there is room for.
   function plain(x, decimals) result(text)
      real(qp), intent(in) :: x
      integer, intent(in) :: decimals
      character(field_length) :: text
      character(60) :: line
      integer :: d

      do d = min(decimals, most_decimals), 0, -1
         if (anint(abs(x)*10.0_qp**d) >= 10.0_qp**room(x)) cycle
         text = with_point(nint(abs(x)*10.0_qp**d, int64), d, x < 0.0_qp)
         return
      end do
      ! 1.2345E+010
      write (line, '(es60.'//achar(iachar('0') + room(x) - 6)//'e3)') x
      text = line(len(line) - field_length + 1:)
   end function plain

   !> The digits of `x` down to the place `last`, those behind it masked; blank where there is no room for a mask.
   function masked(x, last, decimals) result(text)
      real(qp), intent(in) :: x
      integer, intent(in) :: last, decimals
      character(field_length) :: text
      real(qp) :: known
      integer :: d

      text = ''
      ! The number in units of its last known digit.
      known = anint(abs(x)/10.0_qp**last)
      do d = min(decimals, most_decimals), max(0, 1 - last), -1
         if (known*10.0_qp**(last + d) >= 10.0_qp**room(x)) cycle
         text = with_point(nint(known*10.0_qp**(last + d), int64), d, x < 0.0_qp)
         call mask_last(text, last + d)
         return
      end do
      if (last > 0) text = masked_exponent(known, last, x < 0.0_qp)
   end function masked

   !> `known` 10**`last` with an exponent.
   function masked_exponent(known, last, negative) result(text)
      real(qp), intent(in) :: known
      integer, intent(in) :: last
      logical, intent(in) :: negative
      character(field_length) :: text
      character(60) :: digits, exponent
      integer :: n, behind

      text = ''
      write (digits, '(i0)') nint(known, int64)
      n = len_trim(digits)
      write (exponent, '("E",sp,i4.3)') last + n - 1
      behind = field_length - 1 - len('1.E+010') - merge(1, 0, negative)
      if (behind < n) return
      digits(n + 1:) = repeat('?', len(digits) - n)
      text = digits(1:1)//'.'//digits(2:behind + 1)//exponent
      if (negative) text = '-'//text(:field_length - 1)
      text = adjustr(text)
   end function masked_exponent

   !> The digits of `n` with a point before the last `d`; a zero has no sign. The sign takes the place of a zero before
   !> the point if there is no other.
   function with_point(n, d, negative) result(text)
      integer(int64), intent(in) :: n
      integer, intent(in) :: d
      logical, intent(in) :: negative
      character(field_length) :: text
      character(30) :: digits
      integer :: i

      write (digits, '(i30)') n
      do i = 30 - d, 30
         if (digits(i:i) == ' ') digits(i:i) = '0'
      end do
      digits = digits(2:30 - d)//'.'//digits(31 - d:)
      if (negative .and. n > 0) then
         i = verify(digits, ' ')
         if (d == most_decimals) digits(i:i) = '-'
         if (d < most_decimals) digits(i - 1:i - 1) = '-'
      end if
      text = digits(len(digits) - field_length + 1:)
   end function with_point

   !> Question marks for the last `count` digits of `text`, or all.
   subroutine mask_last(text, count)
      character(*), intent(inout) :: text
      integer, intent(in) :: count
      integer :: i, left

      left = count
      do i = len(text), 1, -1
         if (left == 0) exit
         if (verify(text(i:i), '0123456789') > 0) cycle
         text(i:i) = '?'
         left = left - 1
      end do
   end subroutine mask_last
end module expected_numbers
