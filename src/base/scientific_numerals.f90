!> Numbers with one digit before the point and an exponent, as the formats ES write them, without formats made at run
!> time: correctly rounded, the same bytes.
module scientific_numerals
   use, intrinsic :: iso_fortran_env, only: int64
   use kinds, only: wp
   use numerals, only: leading_digits, nearest_whole, put_digits, put_whole
   implicit none
   private
   public :: put_scientific, put_integer

contains

   !> `x` with so many `decimals` (1 to 16), right-adjusted in `text`; its exponent has 2 digits, as by ESw.d, or 3, as
   !> by ESw.dE3 (`exponent_digits`).
   pure subroutine put_scientific(x, decimals, exponent_digits, text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, exponent_digits
      character(*), intent(out) :: text
      integer(int64) :: n
      integer :: e, point, sign_of
      logical :: sure

      n = 0
      e = 0
      sure = abs(x) <= 0.0_wp
      if (.not. sure) then
         call leading_digits(abs(x), n, e, sure)
         if (sure) call nearest_whole(abs(x), decimals - e, n, sure)
         if (n == 10_int64**(decimals + 1)) then
            n = n/10
            e = e + 1
         end if
      end if
      point = len(text) - exponent_digits - 2 - decimals
      sign_of = point - 2
      if (.not. sure .or. abs(e) >= 10**exponent_digits .or. sign_of < 1) then
         call put_by_format(x, decimals, exponent_digits, text)
         return
      end if
      text = ''
      call put_digits(mod(n, 10_int64**decimals), text(point + 1:point + decimals))
      text(point:point) = '.'
      call put_digits(n/10_int64**decimals, text(point - 1:point - 1))
      if (sign(1.0_wp, x) < 0.0_wp) text(sign_of:sign_of) = '-'
      text(point + decimals + 1:point + decimals + 2) = merge('E-', 'E+', e < 0)
      call put_digits(int(abs(e), int64), text(point + decimals + 3:))
   end subroutine put_scientific

   !> The same by a format: what has no certain digits, no room, or is no number.
   pure subroutine put_by_format(x, decimals, exponent_digits, text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, exponent_digits
      character(*), intent(out) :: text
      character(24) :: form

      if (exponent_digits == 2) then
         write (form, '(a,i0,a,i0,a)') '(es', len(text), '.', decimals, ')'
      else
         write (form, '(a,i0,a,i0,a,i0,a)') '(es', len(text), '.', decimals, 'e', exponent_digits, ')'
      end if
      write (text, form) x
   end subroutine put_by_format

   !> The whole number `i`, right-adjusted in `text`; stars where it has no room.
   pure subroutine put_integer(i, text)
      integer, intent(in) :: i
      character(*), intent(out) :: text
      character(12) :: field
      integer :: first

      call put_whole(abs(int(i, int64)), field, first)
      if (i < 0) first = first - 1
      if (i < 0) field(first:first) = '-'
      text = repeat('*', len(text))
      if (len(field) - first < len(text)) text = repeat(' ', len(text) - (len(field) - first + 1))//field(first:)
   end subroutine put_integer
end module scientific_numerals
