!> Level 2. Numbers as text: never asterisks, never a negative zero.
module numerals
   use kinds, only: wp
   implicit none
   private
   public :: fixed, whole, full, numeral_length

   !> Characters of a number in the tables, one blank before it included.
   integer, parameter :: numeral_length = 12

contains

   !> `x` 10**-power, correctly rounded to at most `decimals` decimals, right-adjusted; as many decimals as there is
   !> room for, an exponent where even the whole part has none.
   function fixed(x, decimals, power) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, power
      character(numeral_length) :: text
      character(400) :: long
      character(24) :: form
      integer :: d

      do d = decimals, 0, -1
         ! The scale factor kP multiplies the decimal value, so no digit is lost by it.
         write (form, '(a,i0,a,i0,a)') '(', -power, 'pf400.', d, ')'
         write (long, form) x
         long = adjustl(long)
         if (len_trim(long) < numeral_length) exit
      end do
      if (len_trim(long) >= numeral_length) long = with_exponent(x, power)
      if (verify(trim(long), '-0.') == 0 .and. long(1:1) == '-') long = long(2:)
      text = adjustr(long(:numeral_length))
   end function fixed

   !> `x` 10**-power with as many digits as there is room for beside an exponent.
   function with_exponent(x, power) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: power
      character(numeral_length - 1) :: text
      integer :: e

      write (text, merge('(es11.4e3)', '(es11.3e3)', x >= 0.0_wp)) x
      ! The power changes the exponent only, so no digit is lost by it.
      read (text(8:11), '(i4)') e
      write (text(8:11), '(sp,i4.3)') e - power
   end function with_exponent

   !> A whole number without blanks.
   pure function whole(i) result(text)
      integer, intent(in) :: i
      character(:), allocatable :: text
      character(12) :: field

      write (field, '(i0)') i
      text = trim(field)
   end function whole

   !> `x` with 17 significant digits, so that it reads back as the same number.
   pure function full(x) result(text)
      real(wp), intent(in) :: x
      character(:), allocatable :: text
      character(40) :: field

      write (field, '(es25.16e3)') x
      text = trim(adjustl(field))
   end function full
end module numerals
