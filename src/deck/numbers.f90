!> The strict grammar of numbers. A READ statement accepts `1 2` as 12, a single `-` as 0, `NaN`, and 1e400 as infinity.
!> Here a text is scanned first, and every error has its code and the position of its character.
!>
!>     real  = [sign] digits-and-one-point [E|D [sign] digits]     with a point or an exponent, or both
!>     whole = [sign] digits
!>
!> As in Fortran, a number with the exponent D is of double precision in every kind of reals: 0.1D0 is the double
!> nearest to 0.1, so that programs in real64 and real128 read equal numbers.
module numbers
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp, exact_power
   use input_errors
   implicit none
   private
   public :: read_real, read_whole

   !> Larger exponents become this exponent: far beyond the range of reals with 80 digits before the point.
   integer, parameter :: exponent_cap = 100000

contains

   !> Reads a real number from a text by the strict grammar: a number with the exponent D as a double.
   pure subroutine read_real(text, value, error, place)
      character(*), intent(in) :: text       !< no blanks around it, not empty, at most 80 characters
      real(wp), intent(out) :: value         !< the number; 0 if there is an error
      type(error_code_t), intent(out) :: error   !< number_...; its number is 0 if there is none
      integer, intent(out) :: place          !< number of the first wrong character; in all other cases 1
      integer :: first, n, power, point, letter, exponent
      real(wp) :: whole
      real(dp) :: double
      logical :: is_double

      ! Digits with a point: `n` of them from the first that is not 0 on, the number `whole`, times 10**power.
      value = 0.0_wp
      whole = 0.0_wp
      first = merge(2, 1, scan(text(1:1), '+-') == 1)
      n = 0
      point = 0
      do place = first, len(text)
         if (text(place:place) >= '0' .and. text(place:place) <= '9') then
            if (n > 0 .or. text(place:place) > '0') n = n + 1
            if (n <= precision(whole)) whole = 10.0_wp*whole + (iachar(text(place:place)) - iachar('0'))
         else if (text(place:place) == '.' .and. point == 0) then
            point = place
         else
            exit
         end if
      end do
      letter = place
      power = 0
      if (point > 0) power = point + 1 - place

      ! The exponent.
      if (place == first + merge(1, 0, point > 0)) then
         error = number_other
      else if (scan(text(letter:), 'EeDd') == 1) then
         first = place + 1
         if (scan(text(first:), '+-') == 1) first = first + 1
         exponent = 0
         do place = first, len(text)
            if (text(place:place) < '0' .or. text(place:place) > '9') exit
            exponent = min(10*exponent + iachar(text(place:place)) - iachar('0'), exponent_cap)
         end do
         if (place == first) error = number_other
         power = power + merge(-exponent, exponent, text(first - 1:first - 1) == '-')
      else if (point == 0 .and. place > len(text)) then
         error = number_no_point
         place = 1
         return
      end if

      if (place <= len(text)) error = number_other
      place = min(place, len(text))
      if (error%number > 0) return

      place = 1
      if (n == 0) return
      ! Beyond the range of reals a conversion may trap.
      if (n - 1 + power > range(value)) error = number_overflow
      if (n - 1 + power < -range(value)) error = number_underflow
      if (error%number > 0) return
      is_double = scan(text(letter:), 'Dd') == 1 .and. abs(n + power) < range(double)
      if (n <= precision(whole) .and. abs(power) <= exact_power .and. .not. is_double) then
         ! The digits and the power are exact, and there is one rounding: a tenth of the time of a READ statement.
         if (power < 0) value = whole/10.0_wp**(-power)
         if (power >= 0) value = whole*10.0_wp**power
         if (text(1:1) == '-') value = -value
      else if (is_double) then
         read (text, '(f80.0)') double
         value = real(double, wp)
      else
         read (text, '(f80.0)') value
      end if
   end subroutine read_real

   !> Reads a whole number from a text by the strict grammar.
   pure subroutine read_whole(text, value, error, place)
      character(*), intent(in) :: text       !< no blanks around it, not empty, at most 80 characters
      integer, intent(out) :: value          !< 0 if there is an error
      type(error_code_t), intent(out) :: error   !< number_...; its number is 0 if there is none
      integer, intent(out) :: place          !< number of the first wrong character; in all other cases 1
      integer :: first, wrong, status

      value = 0
      place = 1
      first = merge(2, 1, scan(text(1:1), '+-') == 1)
      wrong = verify(text(first:), '0123456789') + first - 1
      if (first > len(text)) then
         error = number_other
      else if (wrong >= first) then
         place = wrong
         error = number_other
         if (scan(text(wrong:wrong), '.') == 1 .or. (wrong > first .and. scan(text(wrong:wrong), 'EeDd') == 1)) &
            error = number_fraction
      else
         read (text, '(i80)', iostat=status) value
         if (status /= 0) error = number_overflow
         if (status /= 0) value = 0
      end if
   end subroutine read_whole
end module numbers
