!> compare_digits [N [SEED]]: N numbers (200000) as `fixed` and `full` print them, each against the formats of the
!> run-time library. A number passes if both texts are the same, blanks included; the first that do not are told. The
!> same N and SEED (1) give the same numbers.
program compare_digits
   use, intrinsic :: iso_fortran_env, only: int64, real128
   use kinds, only: wp
   use number_format, only: fixed, full, numeral_length
   implicit none

   integer(int64) :: count, i, state, failed
   integer, parameter :: told_at_most = 20
   real(wp) :: x
   integer :: decimals, power
   character(numeral_length) :: short, short_expected
   character(40) :: long, long_expected

   count = argument(1, 200000_int64)
   ! A generator of this kind must not begin with 0.
   state = 88172645463325252_int64 + argument(2, 1_int64)
   failed = 0
   do i = 1, count
      call choose(i, x, decimals, power)
      short = fixed(x, decimals, power)
      short_expected = fixed_expected(x, decimals, power)
      long = full(x)
      write (long_expected, '(es24.16e3)') x
      long_expected = adjustl(long_expected)
      if (short == short_expected .and. long == long_expected) cycle
      failed = failed + 1
      if (failed > told_at_most) cycle
      write (*, '(es27.17e4,a,i0,a,i0)') x, '  decimals ', decimals, '  power ', power
      write (*, '(4a)') '   expected:', short_expected, '   ', trim(long_expected)
      write (*, '(4a)') '   found:   ', short, '   ', trim(long)
   end do
   write (*, '(i0,a,i0,a)') count - failed, ' passed, ', failed, ' failed'
   if (failed > 0) stop 1, quiet=.true.

contains

   !> Argument number `i` of the command, or what stands for it.
   integer(int64) function argument(i, absent)
      integer, intent(in) :: i
      integer(int64), intent(in) :: absent
      character(20) :: text

      argument = absent
      call get_command_argument(i, text)
      if (text /= '') read (text, *) argument
   end function argument

   !> Number `i` of the sequence, of one of twelve kinds, either sign.
   subroutine choose(i, x, decimals, power)
      integer(int64), intent(in) :: i
      real(wp), intent(out) :: x
      integer, intent(out) :: decimals, power

      decimals = below(10)
      power = 0
      select case (int(mod(i, 12_int64)))
      case (0)
         ! Any number, in any column.
         x = any_number()
         power = below(801) - 400
      case (1, 2)
         ! Any number, in a column where some of its digits are seen.
         x = any_number()
         power = order_of(x) - below(16) + 5
      case (3, 4)
         ! What tables hold.
         x = unit()*10.0_wp**(below(9) - 3)
         if (below(4) == 0) power = 3*(below(7) - 3)
      case (5)
         ! The nearest numbers to a half of the last digit, and their neighbours.
         power = below(41) - 20
         x = half(power)
      case (6)
         power = 3*(below(203) - 101)
         x = half(power)
      case (7)
         ! Exact halves: (2 k + 1)/2**(d + 1) is (2 k + 1) 5**d/2 of the last digit.
         x = scale(2.0_wp*below(2**30) + 1.0_wp, -decimals - 1)
      case (8)
         ! Exact halves above the point, as long as 5 10**(power - 1) times an odd number has 53 bits.
         power = 1 + below(12)
         decimals = 0
         x = (2.0_wp*below(2000) + 1.0_wp)*5.0_wp*10.0_wp**(power - 1)
      case (9)
         ! Whole numbers of any size.
         x = aint(scale(unit(), below(64)))
      case (10)
         ! A power of ten, a number that rounds up to it, and their neighbours.
         power = 3*(below(203) - 101)
         x = real(10.0_real128**min(power + below(12) - 3, range(x)), wp)
         if (below(2) == 0) x = x*(1.0_wp - 10.0_wp**(-below(12) - 5))
         x = neighbour(x, below(5) - 2)
      case default
         ! Few digits, as they stand in decks; the smallest and the largest numbers.
         x = real(below(100000), wp)/10.0_wp**below(8)
         if (below(8) == 0) x = neighbour(0.0_wp, below(1000))
         if (below(8) == 0) x = neighbour(tiny(x), below(7) - 3)
         if (below(8) == 0) x = neighbour(huge(x), -below(3))
         if (below(4) == 0) power = order_of(x) - below(5)
      end select
      x = min(x, huge(x))
      if (below(2) == 0) x = -x
   end subroutine choose

   !> A number next to (m + 1/2) 10**(power - decimals).
   real(wp) function half(power)
      integer, intent(in) :: power

      half = real((below(10**(1 + below(9))) + 0.5_real128)*10.0_real128**(power - decimals), wp)
      half = neighbour(half, below(5) - 2)
   end function half

   !> Any finite number: 53 random bits and a random exponent.
   real(wp) function any_number()
      any_number = scale(0.5_wp + 0.5_wp*unit(), minexponent(1.0_wp) - digits(1.0_wp) + 1 &
         + below(maxexponent(1.0_wp) - minexponent(1.0_wp) + digits(1.0_wp)))
   end function any_number

   !> The exponent of the power of ten near `x`.
   integer function order_of(x)
      real(wp), intent(in) :: x

      order_of = 0
      if (x > 0.0_wp) order_of = floor(log10(x))
   end function order_of

   !> `x`, `n` numbers further.
   real(wp) function neighbour(x, n)
      real(wp), intent(in) :: x
      integer, intent(in) :: n
      integer :: k

      neighbour = x
      do k = 1, abs(n)
         neighbour = nearest(neighbour, sign(1.0_wp, real(n, wp)))
      end do
   end function neighbour

   !> 0 to `n` - 1.
   integer function below(n)
      integer, intent(in) :: n

      call step()
      below = int(mod(ishft(state, -1), int(n, int64)))
   end function below

   !> 0 to 1, a multiple of 2**-53.
   real(wp) function unit()
      call step()
      unit = scale(real(ishft(state, -11), wp), -53)
   end function unit

   !> Marsaglia's shifts 13, 7, 17 (Xorshift RNGs, 2003).
   subroutine step()
      state = ieor(state, ishft(state, 13))
      state = ieor(state, ishft(state, -7))
      state = ieor(state, ishft(state, 17))
   end subroutine step

   !> What `fixed` must print, by formats alone.
   function fixed_expected(x, decimals, power) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: decimals, power
      character(numeral_length) :: text
      character(60) :: line
      integer :: d

      line = repeat('9', len(line))
      if (order_of(abs(x)) - power <= numeral_length) then
         do d = decimals, 0, -1
            if (abs(power) <= 18) line = scaled(x, d, power)
            if (abs(power) > 18) line = multiplied(x, d, power)
            ! A sign takes the place of the zero before nine decimals; a zero has none.
            if (d == numeral_length - 3 .and. line(:3) == '-0.') line = merge('-'//line(3:), line(2:), &
               scan(line, '123456789') > 0)
            if (len_trim(line) < numeral_length) exit
         end do
      end if
      if (len_trim(line) >= numeral_length) line = exponent_expected(x, power)
      if (line(1:1) == '-' .and. scan(line, '123456789') == 0) line = line(2:)
      text = adjustr(line(:numeral_length))
   end function fixed_expected

   !> The scale factor kP multiplies the decimal value. For large k gfortran's library prints wrong digits or writes
   !> beyond its buffer.
   function scaled(x, d, power) result(line)
      real(wp), intent(in) :: x
      integer, intent(in) :: d, power
      character(60) :: line
      character(20) :: form

      write (form, '(a,i0,a,i0,a)') '(', -power, 'pf60.', d, ')'
      write (line, form) x
      line = adjustl(line)
   end function scaled

   !> Instead, x 10**(d - power) in real128 is printed as a whole number. A number of 53 bits times a power of ten is a
   !> half of ten digits or is off by more than 2**-(53 + 34 + 10) of it; and a half is found exactly, since |d - power|
   !> is then below 48, 10**48 has 112 bits, and the product or quotient is rounded once.
   function multiplied(x, d, power) result(line)
      real(wp), intent(in) :: x
      integer, intent(in) :: d, power
      character(60) :: line
      real(real128) :: y
      integer :: shown

      if (d >= power) y = abs(real(x, real128))*10.0_real128**(d - power)
      if (d < power) y = abs(real(x, real128))/10.0_real128**(power - d)
      write (line, '(f60.0)') y
      line = adjustl(line)
      shown = len_trim(line) - 1
      line = repeat('0', max(0, d + 1 - shown))//line(:shown)
      shown = len_trim(line)
      line = line(:shown - d)//'.'//line(shown - d + 1:)
      if (x < 0.0_wp) line = '-'//line(:len(line) - 1)
   end function multiplied

   !> Four, three or two decimals, whichever fill eleven places with sign and exponent.
   function exponent_expected(x, power) result(text)
      real(wp), intent(in) :: x
      integer, intent(in) :: power
      character(11) :: text
      character(24) :: mantissa, tail
      integer :: d, e, mark

      do d = 4, 2, -1
         write (mantissa, '(es24.'//achar(48 + d)//'e3)') x
         mark = scan(mantissa, 'E')
         read (mantissa(mark + 1:), *) e
         write (tail, '(a,i0.3)') merge('E-', 'E+', e < power), abs(e - power)
         mantissa = adjustl(mantissa(:mark - 1))
         if (len_trim(mantissa) + len_trim(tail) <= len(text)) exit
      end do
      text = trim(mantissa)//tail
   end function exponent_expected
end program compare_digits
