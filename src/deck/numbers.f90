!> The strict grammar of numbers. A READ statement alone accepts `1 2` as 12, a lone `-` as 0, `NaN`, and 1e400 as
!> infinity. Here a text is scanned first, and every error has its code and its place.
!>
!>     real  = [sign] digits-and-one-point [E|D [sign] digits]     with a point or an exponent, or both
!>     whole = [sign] digits
!>
!> As in Fortran, a number with the exponent D is of double precision in every kind of reals: 0.1D0 is the double
!> nearest to 0.1, so that programs in real64 and real128 read the same number.
module numbers
   use, intrinsic :: iso_fortran_env, only: int64, dp => real64
   use kinds, only: wp
   use failures, only: capitals
   use input_errors, only: error_code_t, number_other, number_letter_o, number_letter_l, number_blank, number_comma, &
      number_sign, number_nan, number_inf, number_overflow, number_underflow, number_no_point, number_point, &
      number_no_digits, number_exponent
   implicit none
   private
   public :: read_real, read_whole

   !> Numbers of digits (in int64) and powers of ten up to which both are exact in `wp`, so that one rounding gives the
   !> nearest real: 15 and 22 for 53 bits, since 5**22 < 2**53.
   integer, parameter :: exact_digits = min(precision(1.0_wp), 18)
   integer, parameter :: exact_power = int(digits(1.0_wp)*(log10(2.0)/log10(5.0)))
   !> A number above largest x 10**308 rounds to infinity, one below smallest x 10**-324 to zero: these are the first
   !> digits of 2**1024 - 2**970 and of 2**-1075, which no number with fewer digits equals. For kinds other than double,
   !> the bounds are the whole powers of ten in their range.
   logical, parameter :: is_double = digits(1.0_wp) == 53
   integer, parameter :: largest_exponent = merge(308, range(1.0_wp), is_double)
   integer, parameter :: smallest_exponent = merge(-324, -range(1.0_wp), is_double)
   character(*), parameter :: largest = &
      merge('17976931348623158079372897140530341507993413271003', repeat('9', 50), is_double)
   character(*), parameter :: smallest = &
      merge('24703282292062327208828439643411068618252990130716', repeat('0', 50), is_double)
   !> Larger exponents are set to this one: far beyond the range, whatever the digits are.
   integer, parameter :: exponent_cap = 100000

contains

   !> Reads the real `value` from `text` (no blanks around it, not empty, at most 80 characters). If it is none, `error`
   !> is a number_... error, `value` is 0 and `place` is the number of the first wrong character of `text`.
   pure subroutine read_real(text, value, error, place)
      character(*), intent(in) :: text
      real(wp), intent(out) :: value
      type(error_code_t), intent(out) :: error
      integer, intent(out) :: place
      character(len(text)) :: digits
      integer :: n, magnitude, zeros

      value = 0.0_wp
      call split_real(text, digits, n, magnitude, place, error)
      place = min(place, len(text))
      if (error%number > 0) return
      place = 1
      if (scan(text, '.EeDd') == 0) error = number_no_point
      zeros = verify(digits(:n), '0') - 1
      if (error%number > 0 .or. zeros < 0) return
      call check_range(digits(zeros + 1:n), magnitude - zeros, error)
      if (error%number > 0) return
      value = absolute_value(text, digits(zeros + 1:n), magnitude - n)
      if (text(1:1) == '-') value = -value
   end subroutine read_real

   !> Reads the whole number `value` from `text`; the other arguments are those of `read_real`.
   pure subroutine read_whole(text, value, error, place)
      character(*), intent(in) :: text
      integer, intent(out) :: value
      type(error_code_t), intent(out) :: error
      integer, intent(out) :: place
      integer(int64) :: sum
      integer :: i, first

      value = 0
      place = 1
      sum = 0_int64
      first = merge(2, 1, scan(text(1:1), '+-') == 1)
      if (first > len(text)) error = number_no_digits
      do i = first, len(text)
         if (verify(text(i:i), '0123456789') == 1) error = error_at(text, i)
         if (scan(text(i:i), '.') == 1 .or. (i > first .and. scan(text(i:i), 'EeDd') == 1)) error = number_point
         place = i
         if (error%number > 0) return
         sum = min(10_int64*sum + digit(text(i:i)), 10_int64*huge(value))
      end do
      place = 1
      if (sum > huge(value)) error = number_overflow
      if (error%number == 0) value = int(merge(-sum, sum, text(1:1) == '-'))
   end subroutine read_whole

   !> Splits `text` = 0.digits x 10**magnitude, with `n` digits. `place`: the character at which the grammar stops,
   !> which is len(text) + 1 if there is no error.
   pure subroutine split_real(text, digits, n, magnitude, place, error)
      character(*), intent(in) :: text
      character(*), intent(out) :: digits
      integer, intent(out) :: n, magnitude, place
      type(error_code_t), intent(out) :: error
      integer :: first, power, i

      first = merge(2, 1, scan(text(1:1), '+-') == 1)
      magnitude = digits_from(text, first)
      place = first + magnitude
      digits = text(first:place - 1)
      n = magnitude
      if (scan(text(place:), '.') == 1) then
         n = magnitude + digits_from(text, place + 1)
         digits(magnitude + 1:) = text(place + 1:)
         place = first + n + 1
      end if
      if (n == 0) then
         error = number_no_digits
      else if (scan(text(place:), 'EeDd') == 1) then
         first = place + 1
         if (scan(text(first:), '+-') == 1) first = first + 1
         place = first + digits_from(text, first)
         if (place == first) error = number_exponent
         power = 0
         do i = first, place - 1
            power = min(10*power + digit(text(i:i)), exponent_cap)
         end do
         magnitude = magnitude + merge(-power, power, text(first - 1:first - 1) == '-')
      end if
      if (place <= len(text)) error = error_at(text, place)
   end subroutine split_real

   !> The number of successive digits in `text` from its character `first` on.
   pure integer function digits_from(text, first) result(n)
      character(*), intent(in) :: text
      integer, intent(in) :: first

      do n = 0, len(text) - first
         if (text(first + n:first + n) < '0' .or. text(first + n:first + n) > '9') return
      end do
   end function digits_from

   !> The error at the character `text(i:i)`, at which the grammar stopped.
   pure function error_at(text, i) result(error)
      character(*), intent(in) :: text
      integer, intent(in) :: i
      type(error_code_t) :: error
      character(3) :: word

      word = capitals(text(i:min(i + 2, len(text))))
      error = number_other
      select case (text(i:i))
      case (' ')
         error = number_blank
      case (',')
         error = number_comma
      case ('O', 'o')
         error = number_letter_o
      case ('l', 'I')
         error = number_letter_l
      case ('+', '-')
         if (i > 1) error = merge(number_sign, number_other, scan(text(i - 1:i - 1), '0123456789.') == 1)
      end select
      if (word == 'NAN') error = number_nan
      if (word == 'INF') error = number_inf
   end function error_at

   !> Sets `error` if 0.digits x 10**magnitude, with a first digit that is not 0, would round to infinity or zero. The
   !> digits decide, because a conversion out of range may trap.
   pure subroutine check_range(digits, magnitude, error)
      character(*), intent(in) :: digits
      integer, intent(in) :: magnitude
      type(error_code_t), intent(out) :: error
      character(len(largest)) :: first
      integer :: power

      first = digits//repeat('0', len(first))
      power = magnitude - 1
      if (power > largest_exponent .or. (power == largest_exponent .and. first > largest)) error = number_overflow
      if (power < smallest_exponent .or. (power == smallest_exponent .and. first < smallest)) error = number_underflow
   end subroutine check_range

   !> The absolute value of `text` = digits x 10**power.
   pure real(wp) function absolute_value(text, digits, power) result(value)
      character(*), intent(in) :: text, digits
      integer, intent(in) :: power
      integer(int64) :: mantissa
      integer :: i
      real(dp) :: double

      if (scan(text, 'Dd') > 0 .and. abs(len(digits) + power) < range(double)) then
         read (text, '(f80.0)') double
         value = abs(real(double, wp))
      else if (len(digits) <= exact_digits .and. abs(power) <= exact_power) then
         mantissa = 0_int64
         do i = 1, len(digits)
            mantissa = 10_int64*mantissa + digit(digits(i:i))
         end do
         value = real(mantissa, wp)
         if (power > 0) value = value*10.0_wp**power
         if (power < 0) value = value/10.0_wp**(-power)
      else
         read (text, '(f80.0)') value
         value = abs(value)
      end if
   end function absolute_value

   !> The value of the digit `c`.
   pure integer function digit(c)
      character(1), intent(in) :: c

      digit = iachar(c) - iachar('0')
   end function digit
end module numbers
