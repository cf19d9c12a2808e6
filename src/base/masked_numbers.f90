!> Numbers with unknown digits, as text: a question mark stands for each unknown digit.
module masked_numbers
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use number_format, only: nearest_whole, tens, write_fixed, write_with_point, write_minus, write_whole, &
      write_exponent, &
      numeral_length, max_decimals
   implicit none
   private
   public :: write_known, unknown_digit, nothing_known, errors_a_digit

   !> Stands for a digit that is not known.
   character(1), parameter :: unknown_digit = '?'
   !> The error of a number without a known digit: finite even after the division by a unit of length or angle.
   real(wp), parameter :: nothing_known = sqrt(huge(1.0_wp))
   !> One unit of the last digit that is shown is at least so many errors: with fewer, another program with errors of
   !> this size would often print another last digit.
   real(wp), parameter :: errors_a_digit = 100.0_wp

contains

   !> Writes a number with a limited number of known digits: rounded to the last known digit, with later digits masked.
   !> If all digits are known, the text is the text of `write_fixed`; if none is, one question mark.
   pure subroutine write_known(value, error, decimals, power, text, masked)
      real(wp), intent(in) :: value          !< the number, in any unit
      real(wp), intent(in) :: error          !< its estimated error, in the unit of `value`; 0: all digits are known
      integer, intent(in) :: decimals        !< decimals at most, 0 or more
      integer, intent(in) :: power           !< `value` 10**-`power` is written
      character(numeral_length), intent(out) :: text   !< right-adjusted
      logical, intent(inout), optional :: masked   !< becomes true if a digit is masked; otherwise unchanged
      integer(int64) :: n
      logical :: is_known
      integer :: last

      ! Most errors are 0, and a power takes much time.
      is_known = error <= 0.0_wp
      if (.not. is_known) is_known = error*errors_a_digit <= 10.0_wp**(power - decimals)
      if (is_known) then
         call write_fixed(value, decimals, power, text)
         return
      else if (.not. error <= 1.0e-6_wp*nothing_known) then
         ! No digit is known: `nothing_known` divided by a unit up to a million, or NaN.
         text = repeat(' ', numeral_length - 1)//unknown_digit
      else
         ! The known digits of the value are n 10**last. A value of half a digit or more becomes one digit, not zero.
         last = ceiling(log10(error*errors_a_digit))
         n = nearest_whole(abs(value), -last)
         if (n == 0 .and. abs(value) >= 0.5_wp*10.0_wp**last) n = 1
         text = masked_text(n, last - power, decimals, value < 0.0_wp .and. n > 0)
         if (text == '') then
            ! All digits for which there is room are known.
            call write_fixed(value, decimals, power, text)
            return
         end if
      end if
      if (present(masked)) masked = .true.
   end subroutine write_known

   !> Gives n 10**last as text, right-adjusted; digits worth less than 10**last are masked. The text has an exponent if
   !> the number is too long for fixed point, and is blank if there is no room for a masked digit.
   pure function masked_text(n, last, decimals, negative) result(text)
      integer(int64), intent(in) :: n        !< the known digits, as a whole number, 0 or more
      integer, intent(in) :: last            !< the power of ten of the last known digit
      integer, intent(in) :: decimals        !< decimals at most, 0 or more
      logical, intent(in) :: negative        !< the number has a minus sign
      character(numeral_length) :: text
      character(20) :: digits
      character(80) :: line
      character(5) :: shown
      integer :: room, d, unknown, first, known_digits, i

      room = numeral_length - 2 - merge(1, 0, negative)
      do d = min(decimals, max_decimals), max(0, 1 - last), -1
         unknown = last + d
         if (n >= tens(max(0, room - unknown)) .and. n > 0) cycle
         text = ''
         call write_with_point(n*tens(min(unknown, merge(room, 0, n > 0))), d, text, first)
         do i = numeral_length, first, -1
            if (unknown == 0) exit
            if (text(i:i) == '.') cycle
            text(i:i) = unknown_digit
            unknown = unknown - 1
         end do
         if (negative) call write_minus(d, first, text)
         return
      end do
      text = ''
      if (last <= 0) return

      ! With an exponent, in the form that a number with known digits has; here n > 0.
      call write_whole(n, digits, first)
      known_digits = len(digits) - first + 1
      call write_exponent(last + known_digits - 1, shown)
      digits = digits(first:known_digits + first - 1)//repeat(unknown_digit, len(digits) - known_digits)
      do d = numeral_length - 8, known_digits, -1
         line = merge('-', ' ', negative)//digits(1:1)//'.'//digits(2:d + 1)//'E'//shown
         line = adjustl(line)
         if (len_trim(line) < numeral_length) text = adjustr(line(:numeral_length))
         if (text /= '') return
      end do
   end function masked_text
end module masked_numbers
