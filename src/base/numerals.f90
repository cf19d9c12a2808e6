!> Numbers as text: never asterisks, and in tables never a negative zero.
!>
!> What `decimal_digits` cannot decide is left to the formats of the run-time library, which print the same
!> digits.
module numerals
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use decimal_digits, only: nearest_whole, leading_digits, put_whole, put_with_point, put_digits, &
      put_leading, significant
   implicit none
   private
   public :: fixed, put_fixed, whole, full, put_full, numeral_length, full_length

   !> Characters of a number in the tables, one blank before it included.
   integer, parameter :: numeral_length = 12
   !> Digits of an exponent, and characters of a number with all its digits, its sign and that of its exponent
   !> included.
   integer, parameter :: exponent_digits = merge(4, 3, range(1.0_wp) >= 1000)
   integer, parameter :: full_length = significant + 4 + exponent_digits

   !> A zero in full.
   character(*), parameter :: full_zero = &
      '0.'//repeat('0', significant - 1)//'E+'//repeat('0', exponent_digits)

   integer(int64), parameter :: tens(0:10) = 10_int64**[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10]

contains

   !> `x` 10**-power, correctly rounded to at most `decimals` >= 0 decimals, right-adjusted; as many decimals
   !> as there is room for, an exponent where even the whole part has none.
   pure function fixed(x, decimals, power) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, power
      character(numeral_length) :: text

      call put_fixed(x, decimals, power, text)
   end function fixed

   !> The same in its place: a table holds very many.
   pure subroutine put_fixed(x, decimals, power, text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, power
      character(numeral_length), intent(out) :: text
      integer(int64) :: n
      integer :: d, room, first
      logical :: negative, sure

      negative = sign(1.0_wp, x) < 0.0_wp
      ! For digits: a blank and the point go off, and the sign.
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

   !> The whole number nearest to `x` 10**`k`, x >= 0, by formats, which round the decimal value of x; the
   !> largest of all where it has more than 12 digits. (The scale factor kP would do this at once, but under
   !> gfortran's library it prints wrong digits from -21P down, and in a narrow field with some hundreds of P
   !> that library writes beyond its own buffer.)
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
      ! Without a place x is below 1/10; with none left over, below 1, and a half goes to 0, which is even.
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

   pure integer function exponent_of(line)
      character(*), intent(in) :: line

      read (line(index(line, 'E') + 1:), '(i5)') exponent_of
   end function exponent_of

   !> `x` 10**-power with as many digits as there is room for beside an exponent, right-adjusted.
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
         ! The power changes the exponent only, so no digit is lost by it.
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

   !> The same in its place, left-adjusted, and its length: a table holds very many.
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

   pure function full_by_format(x) result(text)
      real(wp), intent(in) :: x
      character(full_length) :: text
      character(20) :: form

      write (form, '(a,i0,a,i0,a,i0,a)') '(es', full_length, '.', significant - 1, 'e', exponent_digits, ')'
      write (text, form) x
      text = adjustl(text)
   end function full_by_format
end module numerals
