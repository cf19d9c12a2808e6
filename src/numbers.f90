!> Level 2. The strict grammar of numbers. A READ statement alone takes `1 2` as 12, a lone `-` as 0, `NaN`,
!> and 1e400 as infinity; here a text is scanned first and every flaw has a name and a place.
!>
!>     real  = [sign] digits-and-one-point [E|D [sign] digits]     with a point or an exponent, or both
!>     whole = [sign] digits
!>
!> An exponent D makes the number that of double precision in every kind of reals, as in Fortran: 0.1D0 is the double
!> nearest to 0.1, and programs in real64 and real128 that read it read the same number.
module numbers
   use, intrinsic :: iso_fortran_env, only: int64, dp => real64
   use kinds, only: wp
   use letters, only: capitals
   implicit none
   private
   public :: read_real, read_whole
   public :: flaw_none, flaw_other, flaw_letter_o, flaw_letter_l, flaw_blank, flaw_comma, flaw_sign
   public :: flaw_nan, flaw_inf, flaw_overflow, flaw_underflow, flaw_no_point, flaw_point, flaw_no_digits
   public :: flaw_exponent, flaw_count

   integer, parameter :: flaw_none = 0
   integer, parameter :: flaw_other = 1       !< a character that no number has
   integer, parameter :: flaw_letter_o = 2    !< letter O for zero
   integer, parameter :: flaw_letter_l = 3    !< letter l or I for one
   integer, parameter :: flaw_blank = 4       !< a blank inside
   integer, parameter :: flaw_comma = 5       !< decimal comma
   integer, parameter :: flaw_sign = 6        !< 1.5-3: a sign where only E may introduce an exponent
   integer, parameter :: flaw_nan = 7
   integer, parameter :: flaw_inf = 8
   integer, parameter :: flaw_overflow = 9
   integer, parameter :: flaw_underflow = 10  !< not zero as written, but it would become zero
   integer, parameter :: flaw_no_point = 11   !< a real with neither point nor exponent
   integer, parameter :: flaw_point = 12      !< a whole number with a point or an exponent
   integer, parameter :: flaw_no_digits = 13  !< a lone sign or point
   integer, parameter :: flaw_exponent = 14   !< E without digits after it
   integer, parameter :: flaw_count = 14

   !> Significant digits kept: more than a card has columns.
   integer, parameter :: digits_kept = 80
   !> Up to here digits (in int64) and powers of ten are exact in `wp`, so one rounding gives the nearest
   !> real: 15 and 22 for 53 bits, 5**22 < 2**53.
   integer, parameter :: exact_digits = min(precision(1.0_wp), 18)
   integer, parameter :: exact_power = int(digits(1.0_wp)*(log10(2.0)/log10(5.0)))
   !> A literal above largest x 10**308 rounds to infinity, one below smallest x 10**-324 to zero:
   !> 2**1024 - 2**970 and 2**-1075, first digits. No literal of fewer digits can equal them. For other kinds
   !> than double, the whole powers of ten in their range.
   logical, parameter :: is_double = digits(1.0_wp) == 53
   integer, parameter :: largest_exponent = merge(308, range(1.0_wp), is_double)
   integer, parameter :: smallest_exponent = merge(-324, -range(1.0_wp), is_double)
   character(*), parameter :: largest = &
      merge('17976931348623158079372897140530341507993413271003', repeat('9', 50), is_double)
   character(*), parameter :: smallest = &
      merge('24703282292062327208828439643411068618252990130716', repeat('0', 50), is_double)
   !> Exponents are cut here: far past the range whatever the digits are.
   integer, parameter :: exponent_cap = 100000

   !> A scanned literal: value = 0.digits x 10**magnitude, and where the scan stands.
   type :: literal_t
      logical :: negative = .false., point = .false., exponent = .false.
      logical :: any_digit = .false.
      integer :: kept = 0, magnitude = 0, place = 1
      character(digits_kept) :: digits = ''
   end type literal_t

contains

   !> The real that `text` (no blanks around it, not empty, at most 80 characters) stands for.
   !> On a flaw `value` is 0 and `place` is the character of `text` that is wrong.
   pure subroutine read_real(text, value, flaw, place)
      character(*), intent(in) :: text
      real(wp), intent(out) :: value
      integer, intent(out) :: flaw, place
      type(literal_t) :: literal

      value = 0.0_wp
      call scan_mantissa(text, literal, flaw)
      if (flaw == flaw_none) call scan_exponent(text, literal, flaw)
      place = min(literal%place, len(text))
      if (flaw /= flaw_none) return
      place = 1
      if (.not. (literal%point .or. literal%exponent)) then
         flaw = flaw_no_point
         return
      end if
      call check_range(literal, flaw)
      if (flaw == flaw_none) call convert(text, literal, value)
   end subroutine read_real

   !> The whole number that `text` stands for; as `read_real` otherwise.
   pure subroutine read_whole(text, value, flaw, place)
      character(*), intent(in) :: text
      integer, intent(out) :: value
      integer, intent(out) :: flaw, place
      integer(int64) :: sum
      integer :: i, first

      value = 0
      place = 1
      sum = 0_int64
      flaw = flaw_no_digits
      first = merge(2, 1, scan(text(1:1), '+-') == 1)
      do i = first, len(text)
         flaw = flaw_none
         if (.not. is_digit(text(i:i))) flaw = flaw_at(text, i)
         if (scan(text(i:i), '.') == 1 .or. (i > first .and. scan(text(i:i), 'EeDd') == 1)) flaw = flaw_point
         place = i
         if (flaw /= flaw_none) return
         sum = min(10_int64*sum + digit(text(i:i)), 10_int64*huge(value))
      end do
      place = 1
      if (flaw /= flaw_none) return
      if (sum > huge(value)) flaw = flaw_overflow
      if (flaw == flaw_none) value = int(merge(-sum, sum, text(1:1) == '-'))
   end subroutine read_whole

   pure subroutine scan_mantissa(text, literal, flaw)
      character(*), intent(in) :: text
      type(literal_t), intent(inout) :: literal
      integer, intent(out) :: flaw
      integer :: i

      literal%negative = text(1:1) == '-'
      i = merge(2, 1, scan(text(1:1), '+-') == 1)
      do i = i, len(text)
         if (is_digit(text(i:i))) then
            call keep_digit(literal, text(i:i))
         else if (text(i:i) == '.' .and. .not. literal%point) then
            literal%point = .true.
         else
            exit
         end if
      end do
      literal%place = i
      flaw = flaw_none
      if (literal%any_digit) return
      flaw = flaw_no_digits
      if (i <= len(text)) flaw = flaw_at(text, i)
   end subroutine scan_mantissa

   !> Leading zeros are not kept, but those behind the point count in the magnitude.
   pure subroutine keep_digit(literal, c)
      type(literal_t), intent(inout) :: literal
      character(1), intent(in) :: c

      literal%any_digit = .true.
      if (literal%kept > 0 .or. c /= '0') then
         if (literal%kept < digits_kept) then
            literal%kept = literal%kept + 1
            literal%digits(literal%kept:literal%kept) = c
         end if
         if (.not. literal%point) literal%magnitude = literal%magnitude + 1
      else if (literal%point) then
         literal%magnitude = literal%magnitude - 1
      end if
   end subroutine keep_digit

   pure subroutine scan_exponent(text, literal, flaw)
      character(*), intent(in) :: text
      type(literal_t), intent(inout) :: literal
      integer, intent(out) :: flaw
      integer :: first, i, power

      flaw = flaw_none
      i = literal%place
      if (i > len(text)) return
      if (scan(text(i:i), 'EeDd') == 1) then
         literal%exponent = .true.
         first = i + 1
         if (first <= len(text)) first = first + merge(1, 0, scan(text(first:first), '+-') == 1)
         power = 0
         do i = first, len(text)
            if (.not. is_digit(text(i:i))) exit
            power = min(10*power + digit(text(i:i)), exponent_cap)
         end do
         if (text(first - 1:first - 1) == '-') power = -power
         literal%magnitude = literal%magnitude + power
         if (i == first .and. i > len(text)) flaw = flaw_exponent
      end if
      literal%place = i
      if (i <= len(text)) flaw = flaw_at(text, i)
   end subroutine scan_exponent

   !> What is wrong with the character `text(i:i)`, at which the grammar stopped.
   pure integer function flaw_at(text, i) result(flaw)
      character(*), intent(in) :: text
      integer, intent(in) :: i
      character(3) :: word

      word = capitals(text(i:min(i + 2, len(text))))
      flaw = flaw_other
      select case (text(i:i))
      case (' ')
         flaw = flaw_blank
      case (',')
         flaw = flaw_comma
      case ('O', 'o')
         flaw = flaw_letter_o
      case ('l', 'I')
         flaw = flaw_letter_l
      case ('+', '-')
         if (i > 1) flaw = merge(flaw_sign, flaw_other, scan(text(i - 1:i - 1), '0123456789.') == 1)
      end select
      if (word == 'NAN') flaw = flaw_nan
      if (word == 'INF') flaw = flaw_inf
   end function flaw_at

   !> Decided on the digits, because a conversion out of range may trap.
   pure subroutine check_range(literal, flaw)
      type(literal_t), intent(in) :: literal
      integer, intent(out) :: flaw
      character(len(largest)) :: digits
      integer :: power

      flaw = flaw_none
      if (literal%kept == 0) return
      digits = literal%digits(1:literal%kept)//repeat('0', len(digits))
      power = literal%magnitude - 1
      if (power > largest_exponent) flaw = flaw_overflow
      if (power == largest_exponent .and. digits > largest) flaw = flaw_overflow
      if (power < smallest_exponent) flaw = flaw_underflow
      if (power == smallest_exponent .and. digits < smallest) flaw = flaw_underflow
   end subroutine check_range

   pure subroutine convert(text, literal, value)
      character(*), intent(in) :: text
      type(literal_t), intent(in) :: literal
      real(wp), intent(out) :: value
      integer(int64) :: mantissa
      integer :: i, power
      real(dp) :: double

      power = literal%magnitude - literal%kept
      if (literal%kept == 0) then
         value = 0.0_wp
      else if (scan(text, 'Dd') > 0 .and. abs(literal%magnitude) < range(double)) then
         read (text, '(f80.0)') double
         value = real(double, wp)
      else if (literal%kept <= exact_digits .and. abs(power) <= exact_power) then
         mantissa = 0_int64
         do i = 1, literal%kept
            mantissa = 10_int64*mantissa + digit(literal%digits(i:i))
         end do
         value = real(mantissa, wp)
         if (power > 0) value = value*10.0_wp**power
         if (power < 0) value = value/10.0_wp**(-power)
         if (literal%negative) value = -value
      else
         read (text, '(f80.0)') value
      end if
   end subroutine convert

   pure logical function is_digit(c)
      character(1), intent(in) :: c

      is_digit = c >= '0' .and. c <= '9'
   end function is_digit

   pure integer function digit(c)
      character(1), intent(in) :: c

      digit = iachar(c) - iachar('0')
   end function digit
end module numbers
