!> Numbers of which not all digits are known: a question mark in the place of each that is not.
module known_digits
   use kinds, only: wp
   use numerals, only: put_fixed, numeral_length
   implicit none
   private
   public :: put_known, unknown_digit, nothing_known

   character(1), parameter :: unknown_digit = '?'
   !> The error of what is not known at all; a unit of length or angle makes it no infinity.
   real(wp), parameter :: nothing_known = sqrt(huge(1.0_wp))
   !> The last digit that is shown is worth so many errors: else another program, as right as this one, would
   !> round it to another digit.
   real(wp), parameter :: errors_a_digit = 100.0_wp

contains

   !> `x` as `put_fixed` prints it, of which `error` is unknown: rounded to its last digit that is known, those
   !> behind it masked.
   pure subroutine put_known(x, error, decimals, power, text)
      real(wp), intent(in) :: x, error
      integer, intent(in) :: decimals, power
      character(numeral_length), intent(out) :: text
      integer :: last

      call put_fixed(x, decimals, power, text)
      if (error*errors_a_digit <= 10.0_wp**(power - decimals)) return
      if (error > 1.0e-6_wp*nothing_known) then
         text = repeat(' ', numeral_length - 1)//unknown_digit
         return
      end if
      last = ceiling(log10(error*errors_a_digit))
      call put_fixed(rounded(x, last), decimals, power, text)
      call mask(text, last - power)
      ! All that there was room for is known.
      if (index(text, unknown_digit) == 0) call put_fixed(x, decimals, power, text)
   end subroutine put_known

   !> `x` rounded to a multiple of 10**`last`.
   pure real(wp) function rounded(x, last)
      real(wp), intent(in) :: x
      integer, intent(in) :: last
      character(80) :: line
      character(12) :: form
      integer :: digits

      rounded = 0.0_wp
      if (abs(x) < 0.5_wp*10.0_wp**last) return
      rounded = sign(10.0_wp**last, x)
      digits = floor(log10(abs(x))) - last + 1
      if (digits <= 0) return
      write (form, '(a,i0,a)') '(es80.', min(digits - 1, 60), 'e4)'
      write (line, form) x
      read (line, *) rounded
   end function rounded

   !> Masks the digits of `text` that are worth less than 10**`last`.
   pure subroutine mask(text, last)
      character(numeral_length), intent(inout) :: text
      integer, intent(in) :: last
      integer :: i, point, ending, worth

      ending = scan(text, 'E')
      worth = 0
      if (ending > 0) read (text(ending + 1:), *) worth
      if (ending == 0) ending = numeral_length + 1
      point = index(text, '.')
      if (point == 0) point = ending
      do i = 1, ending - 1
         if (verify(text(i:i), '0123456789') > 0) cycle
         if (worth + merge(point - i - 1, point - i, i < point) < last) text(i:i) = unknown_digit
      end do
   end subroutine mask
end module known_digits
