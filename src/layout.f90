!> Level 4. How the tables of a listing look: digits, powers of ten, units of angle, heads of columns.
!>
!> Digits: positions, velocities and accelerations are printed with the decimals, and where need be the power
!> of ten, that give seven digits to the deck's characteristic length and rate; so one mechanism in
!> millimetres and in kilometres prints the same digits.
module layout
   use kinds, only: wp
   use constants, only: degree
   use mechanism, only: mechanism_t, request_link, request_point, request_pair
   use scales, only: characteristic_length, characteristic_rate
   use numerals, only: numeral_length
   use phrases, only: phrase, say_link, say_point, say_pair, say_phi, say_value, say_rate, say_rate2, &
      say_none, say_instant
   implicit none
   private
   public :: layout_t, new_layout, name_length, row_length

   integer, parameter :: digits_after_first = 6
   !> Characters before a row's numbers, and of a whole row.
   integer, parameter :: name_length = 9, row_length = name_length + 9*numeral_length

   type :: layout_t
      !> Decimals and powers of ten: (length or angle, derivative).
      integer :: decimals(2, 0:2) = digits_after_first
      integer :: power(2, 0:2) = 0
      integer :: time_decimals = digits_after_first
      integer :: time_power = 0
      real(wp) :: angle = 1.0_wp           !< radians in the unit in which angles are printed
      character(row_length) :: heads(3)    !< by the kind of a request
      character(numeral_length) :: none    !< in the place of a number that does not exist
      character(:), allocatable :: instant !< before the number of an instant
   end type layout_t

contains

   !> The layout of the tables of `m`, from its deck alone.
   pure function new_layout(m) result(l)
      type(mechanism_t), intent(in) :: m
      type(layout_t) :: l
      real(wp) :: length, rate, time
      integer :: k

      length = characteristic_length(m)
      rate = characteristic_rate(m, length)
      if (m%degrees) l%angle = degree
      do k = 0, 2
         call choose_digits(log10(length) + k*log10(rate), l%decimals(1, k), l%power(1, k))
         call choose_digits(k*log10(rate) + log10(merge(1.0_wp/l%angle, 1.0_wp, k > 0)), &
            l%decimals(2, k), l%power(2, k))
      end do
      time = max(abs(m%t0), abs(m%t1), maxval([0.0_wp, abs(m%at)]))
      if (time > 0.0_wp) call choose_digits(log10(time), l%time_decimals, l%time_power)
      do k = 1, size(l%heads)
         l%heads(k) = column_heads(k, m%polish)
      end do
      l%none = phrase(say_none, m%polish)
      l%none = adjustr(l%none)
      l%instant = ' '//phrase(say_instant, m%polish)//' '
   end function new_layout

   !> Decimals and power of ten for values of order 10**`order`: seven digits, no power as long as they fit.
   pure subroutine choose_digits(order, decimals, power)
      real(wp), intent(in) :: order
      integer, intent(out) :: decimals, power
      integer :: k
      ! An order that is a whole number but for rounding counts as one.
      real(wp), parameter :: margin = max(1.0e-9_wp, 32.0_wp*epsilon(1.0_wp))

      k = floor(order + margin)
      power = 0
      if (k < -2 .or. k > 4) power = 3*floor(real(k, wp)/3.0_wp + margin)
      decimals = digits_after_first - (k - power)
   end subroutine choose_digits

   !> The heads over rows of one kind, right-adjusted over their numbers.
   pure function column_heads(kind, polish) result(line)
      integer, intent(in) :: kind
      logical, intent(in) :: polish
      character(row_length) :: line
      character(numeral_length) :: words(9)
      integer :: k
      character(1), parameter :: prefix(0:2) = [' ', 'V', 'A']
      integer, parameter :: kind_words(3) = [say_link, say_point, say_pair]

      words = ''
      select case (kind)
      case (request_link, request_point)
         do k = 0, 2
            words(3*k + 1) = trim(prefix(k))//'X'
            words(3*k + 2) = trim(prefix(k))//'Y'
            if (kind == request_link) words(3*k + 3) = trim(prefix(k))//phrase(say_phi, polish)
         end do
      case (request_pair)
         words(1::3) = [character(numeral_length) :: &
            phrase(say_value, polish), phrase(say_rate, polish), phrase(say_rate2, polish)]
      end select
      line = ' '//phrase(kind_words(kind), polish)
      do k = 1, size(words)
         line(name_length + 1 + numeral_length*(k - 1):name_length + numeral_length*k) = adjustr(words(k))
      end do
   end function column_heads
end module layout
