!> The tables of the listing for the cards POLE and CURVE: instant centres in the fixed plane and in the axes of both
!> links, and tangent, radius and centre of curvature of the path of a point.
module listing_centres
   use kinds, only: wp
   use mechanism, only: settings_t, request_pole, request_curve
   use points, only: row_t, has_number, centre_numbers
   use instant_centres, only: centre_finite, centre_infinite
   use listing_layout, only: layout_t, digits_t, dimension_of, angle_unit, power_text
   use text_output, only: output_t, put
   use numerals, only: numeral_length
   use known_digits, only: put_known, unknown_digit, nothing_known
   use phrases
   implicit none
   private
   public :: put_centre, put_centre_heads

   !> Room for two names, each with a blank before it; the numbers of a pole have its direction behind them.
   integer, parameter :: names_length = 18, max_numbers = size(centre_numbers, 2) + 1, &
      line_length = names_length + max_numbers*numeral_length

contains

   !> The heads over rows of the given `kind` with the digits `d`: names, a power of ten if there is one, units.
   subroutine put_centre_heads(o, d, m, kind)
      type(output_t), intent(inout) :: o
      type(digits_t), intent(in) :: d
      class(settings_t), intent(in) :: m
      integer, intent(in) :: kind
      character(line_length) :: names, powers, units
      character(numeral_length) :: words(max_numbers)
      integer, allocatable :: numbers(:, :)
      integer :: i

      numbers = numbers_of(kind)
      words = words_of(kind, m%polish)
      names = ' '//phrase(merge(say_pole, say_curve, kind == request_pole), m%polish)
      powers = ''
      units = ''
      do i = 1, size(numbers, 2)
         call put_end(words(i), i, names)
         if (dimension_of(numbers(1, i)) == 2) then
            call put_end(angle_unit(m), i, units)
         else
            call put_end(m%length_unit, i, units)
            if (d%power(1, 0) /= 0) call put_end(power_text(d%power(1, 0)), i, powers)
         end if
      end do
      call put(o, trim(names))
      if (powers /= '') call put(o, trim(powers))
      call put(o, trim(units))
   end subroutine put_centre_heads

   !> The numbers (2, :) of a row of the given `kind`, as in `centre_numbers`.
   pure function numbers_of(kind) result(numbers)
      integer, intent(in) :: kind
      integer, allocatable :: numbers(:, :)

      numbers = centre_numbers(:, :, kind)
      if (kind == request_pole) numbers = reshape([numbers, 3, 0], [2, max_numbers])
   end function numbers_of

   !> The names of its columns.
   pure function words_of(kind, polish) result(words)
      integer, intent(in) :: kind
      logical, intent(in) :: polish
      character(numeral_length) :: words(max_numbers), xi

      if (kind == request_pole) then
         xi = phrase(say_xi, polish)
         words = [character(numeral_length) :: 'X', 'Y', trim(xi)//'-I', 'ETA-I', trim(xi)//'-J', 'ETA-J', &
            phrase(say_direction, polish)]
      else
         words = [character(numeral_length) :: 'X', 'Y', phrase(say_tangent, polish), phrase(say_radius, polish), &
            'X-'//phrase(say_centre, polish), 'Y-'//phrase(say_centre, polish), '']
      end if
   end function words_of

   !> Puts `word` where the `i`-th number of `line` ends.
   pure subroutine put_end(word, i, line)
      character(*), intent(in) :: word
      integer, intent(in) :: i
      character(*), intent(inout) :: line
      integer :: last

      last = names_length + i*numeral_length
      line(last - len_trim(word) + 1:last) = word
   end subroutine put_end

   !> The `row` of a pole or curve, of which `error` (3, 0:2) is unknown, with the digits `d`. `masked` becomes true
   !> where a digit is not known.
   subroutine put_centre(o, l, d, polish, row, error, masked)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      logical, intent(in) :: polish
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: error(3, 0:2)
      logical, intent(inout) :: masked
      character(line_length) :: line
      integer, allocatable :: numbers(:, :)
      integer :: i

      numbers = numbers_of(row%kind)
      associate (first => index(row%name, ' '))
         line = ' '//row%name(:first)
         line(names_length/2 + 1:) = ' '//row%name(first + 1:)
      end associate
      do i = 1, size(numbers, 2)
         line(names_length + (i - 1)*numeral_length + 1:names_length + i*numeral_length) = &
            cell_of(l, d, row, error, numbers(1, i), numbers(2, i), polish)
      end do
      masked = masked .or. index(line(names_length + 1:), unknown_digit) > 0
      call put(o, trim(line))
   end subroutine put_centre

   !> Number (c, k) of `row`, of which `error` (3, 0:2) is unknown, or the word in its place. A pole has a direction
   !> where it is at infinity, and where it may be there: then nothing is known of its place.
   pure function cell_of(l, d, row, error, c, k, polish) result(cell)
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      type(row_t), intent(in) :: row
      real(wp), intent(in) :: error(3, 0:2)
      integer, intent(in) :: c, k
      logical, intent(in) :: polish
      character(numeral_length) :: cell
      real(wp) :: unit
      logical :: is_direction

      unit = merge(l%angle, 1.0_wp, c == 3)
      is_direction = row%kind == request_pole .and. c == 3
      if (row%known < needed(row%kind, c, k)) then
         cell = l%none
      else if (is_direction .and. row%state == centre_finite .and. error(1, 0) < nothing_known) then
         cell = ''
      else if (error(c, k) >= nothing_known) then
         cell = repeat(' ', numeral_length - 1)//unknown_digit
      else if (has_number(row, c, k) .or. (is_direction .and. row%state == centre_finite)) then
         associate (what => dimension_of(c))
            call put_known(row%value(c, k)/unit, error(c, k)/unit, d%decimals(what, 0), d%power(what, 0), cell)
         end associate
      else
         cell = phrase(say_at_rest, polish)
         if (row%state == centre_infinite) cell = phrase(say_infinite, polish)
         cell = adjustr(cell)
      end if
   end function cell_of

   !> How much of a motion, in the values of `known`, number (c, k) of a row of the given `kind` needs.
   pure integer function needed(kind, c, k)
      integer, intent(in) :: kind, c, k

      needed = 1
      if (kind == request_curve) needed = merge(merge(1, 0, c == 3), 2, k == 0)
   end function needed
end module listing_centres
