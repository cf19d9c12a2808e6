!> Tests. A number as it stands in a listing, and whether it is a given value rounded to the digits that are printed.
module printed_numbers
   use, intrinsic :: iso_fortran_env, only: int64, real128
   implicit none
   private
   public :: printed_t, read_printed, agrees

   !> Of a number whose last digits are masked the rest is rounded as any other; its error is below a hundredth of the last
   !> digit that is shown.
   real(real128), parameter :: half = 0.5_real128, half_masked = 0.51_real128
   !> The value itself has 17 digits: half of the last of these, in parts of the value.
   real(real128), parameter :: value_rounding = 1.0e-16_real128

   !> What a number says: `value` in units of its heads' power of ten; the last digit that is shown is worth `unit`.
   type :: printed_t
      logical :: valid = .false.  !< it has the form of a number
      logical :: none = .false.   !< the word for a number that does not exist
      integer :: masked = 0       !< digits that are question marks
      logical :: open = .false.   !< no digit is shown
      real(real128) :: value = 0.0_real128, unit = 0.0_real128
   end type printed_t

contains

   !> The number that `word` is, without blanks: digits with a point, the last ones perhaps masked, perhaps an exponent.
   pure type(printed_t) function read_printed(word) result(p)
      character(*), intent(in) :: word
      integer :: first, last, e, exponent, status

      p%none = any(word == [character(8) :: 'NONE', 'BRAK', 'COINCIDE', 'POKRYCIE'])
      p%valid = p%none
      if (p%none) return
      first = merge(2, 1, word(1:1) == '-')
      e = index(word, 'E')
      last = merge(e - 1, len(word), e > 0)
      exponent = 0
      if (e > 0) then
         if (verify(word(e + 1:), '0123456789+-') > 0) return
         read (word(e + 1:), *, iostat=status) exponent
         if (status /= 0) return
      end if
      call read_digits(word(first:last), exponent, p)
      if (first == 2) p%value = -p%value
      ! A zero has no sign.
      if (first == 2 .and. .not. p%open .and. abs(p%value) <= 0.0_real128) p%valid = .false.
   end function read_printed

   !> The same of digits and their point, times 10**`exponent`.
   pure subroutine read_digits(text, exponent, p)
      character(*), intent(in) :: text
      integer, intent(in) :: exponent
      type(printed_t), intent(inout) :: p
      integer(int64) :: n
      integer :: i, decimals, digits

      n = 0
      digits = 0
      decimals = -1
      do i = 1, len(text)
         select case (text(i:i))
         case ('.')
            if (decimals >= 0) return
            decimals = 0
            cycle
         case ('?')
            p%masked = p%masked + 1
            n = 10*n
         case ('0':'9')
            ! What is masked comes last.
            if (p%masked > 0) return
            n = 10*n + iachar(text(i:i)) - iachar('0')
         case default
            return
         end select
         digits = digits + 1
         if (decimals >= 0) decimals = decimals + 1
      end do
      p%valid = digits > 0 .and. digits < 18 .and. (decimals >= 0 .or. p%masked > 0)
      p%open = p%masked == digits
      p%value = real(n, real128)*10.0_real128**(exponent - max(decimals, 0))
      p%unit = 10.0_real128**(exponent - max(decimals, 0) + p%masked)
   end subroutine read_digits

   !> Whether `p` under a head of 10**`power` is the value `x`, rounded to the digits of `p` that are shown.
   pure logical function agrees(p, power, x)
      type(printed_t), intent(in) :: p
      integer, intent(in) :: power
      real(real128), intent(in) :: x
      real(real128) :: scaled

      scaled = x/10.0_real128**power
      agrees = p%valid .and. .not. p%none
      if (agrees .and. .not. p%open) agrees = abs(scaled - p%value) &
         <= merge(half_masked, half, p%masked > 0)*p%unit + value_rounding*abs(scaled)
   end function agrees
end module printed_numbers
