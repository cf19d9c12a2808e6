!> The cells of tables. In the listing a number has the digits of its column, and digits that rounding leaves open are
!> masked; in files it has all digits.
module table
   use kinds, only: wp, label_length
   use plane_vectors, only: in_degrees
   use columns, only: cell_none, cell_number, cell_count, cell_unbounded, cell_word, cell_spare
   use number_format, only: numeral_length, full_length, max_decimals, write_fixed, write_full, whole
   use masked_numbers, only: write_known, nothing_known, unknown_digit
   use text_output, only: output_t, add, replaced
   implicit none
   private
   public :: format_t, cell_t, choose_digits, write_cell, write_number, number_text, cell_text, power_text, unit_of, &
      add_name, add_number, add_cell, right, digits_after_first, order_margin

   !> Digits after the first one.
   integer, parameter :: digits_after_first = 6

   !> How the numbers of a column are printed.
   type :: format_t
      integer :: decimals = digits_after_first   !< digits after the point
      integer :: power = 0                   !< printed is the value over 10**power
      logical :: is_angle = .false.          !< the value is in rad
      real(wp) :: unit = 1.0_wp              !< of an angle: radians in the unit in which it is printed
   end type format_t

   !> A cell, with its contents as in `columns`.
   type :: cell_t
      integer :: kind = cell_none            !< cell_none, ...
      real(wp) :: value = 0.0_wp             !< of a number or a count
      real(wp) :: error = 0.0_wp             !< the rounding error of the value
      character(3*label_length + 2) :: word = ''   !< of cell_word
   end type cell_t

   !> The order of a number is raised by this margin, so that rounding does not put 1000 below 10**3.
   real(wp), parameter :: order_margin = max(1.0e-9_wp, 32.0_wp*epsilon(1.0_wp))
   !> An empty cell of the listing between columns of words and numbers.
   character(1), parameter :: no_cell = '-'
   !> A number without a bound in a file: below, above.
   character(*), parameter :: unbounded_words(2) = ['-inf', ' inf']

contains

   !> Writes a cell of the listing: a number, or a word in its place.
   pure subroutine write_cell(format, more, cell, value, error, words, field, masked)
      type(format_t), intent(in) :: format   !< of the column
      integer, intent(in) :: more            !< decimals in addition to those of `format`
      integer, intent(in) :: cell            !< contents of the cell: cell_none, ...
      real(wp), intent(in) :: value          !< in the deck's units and rad
      real(wp), intent(in) :: error          !< the rounding error of `value`
      character(numeral_length), intent(in) :: words(cell_none:)   !< of the set, for cells without a number
      character(numeral_length), intent(out) :: field   !< the cell
      logical, intent(inout) :: masked       !< becomes true if a digit or a word is masked

      if (cell == cell_number) then
         call write_number(format, more, value, error, field, masked)
         return
      end if
      field = words(cell)
      ! Without a known digit the word is not known either.
      if (cell > cell_spare .and. error >= nothing_known) then
         field = repeat(' ', numeral_length - 1)//unknown_digit
         masked = .true.
      end if
   end subroutine write_cell

   !> Writes a number of the listing.
   pure subroutine write_number(format, more, value, error, field, masked)
      type(format_t), intent(in) :: format   !< of the column
      integer, intent(in) :: more            !< decimals in addition to those of `format`
      real(wp), intent(in) :: value          !< in the deck's units and rad
      real(wp), intent(in) :: error          !< the rounding error of `value`
      character(numeral_length), intent(out) :: field   !< the cell
      logical, intent(inout) :: masked       !< becomes true if a digit is masked
      real(wp) :: printed, off

      printed = value
      off = error
      ! A division takes long, by 1 too.
      if (format%is_angle) then
         printed = printed/format%unit
         off = off/format%unit
      end if
      if (off > 0.0_wp) then
         call write_known(printed, off, format%decimals + more, format%power, field, masked)
      else
         call write_fixed(printed, format%decimals + more, format%power, field)
      end if
   end subroutine write_number

   !> Gives a number of the listing without blanks.
   pure function number_text(format, value, error) result(text)
      type(format_t), intent(in) :: format   !< of the column
      real(wp), intent(in) :: value          !< in the deck's units and rad
      real(wp), intent(in) :: error          !< the rounding error of `value`
      character(:), allocatable :: text
      character(numeral_length) :: field
      logical :: masked

      call write_number(format, 0, value, error, field, masked)
      text = field(verify(field, ' '):)
   end function number_text

   !> Gives a cell of the listing without blanks.
   pure function cell_text(format, by_size, cell, words) result(text)
      type(format_t), intent(in) :: format   !< of the column
      logical, intent(in) :: by_size         !< each number has the digits and the power of ten for its own size
      type(cell_t), intent(in) :: cell       !< of a row of variants
      character(numeral_length), intent(in) :: words(cell_none:)   !< of the set, for cells without a number
      character(:), allocatable :: text
      character(:), allocatable :: exponent
      type(format_t) :: own

      select case (cell%kind)
      case (cell_none)
         text = no_cell
      case (cell_count)
         text = whole(nint(cell%value))
      case (cell_word)
         text = trim(cell%word)
      case (cell_number)
         own = format
         if (by_size) call choose_digits(log10(max(abs(cell%value)/format%unit, tiny(1.0_wp))), 0, own)
         text = number_text(own, cell%value, cell%error)
         if (by_size .and. own%power /= 0) then
            exponent = power_text(own%power)
            text = text//exponent(3:)
         end if
      case default
         text = trim(adjustl(words(cell%kind)))
      end select
   end function cell_text

   !> Chooses decimals and power of ten that show seven digits of a number. There is no power of ten if the number and
   !> further decimals have room without one: from 0.001 to 9999999.
   pure subroutine choose_digits(order, more, format)
      real(wp), intent(in) :: order          !< log10 of the number
      integer, intent(in) :: more            !< further decimals for which there must be room
      type(format_t), intent(inout) :: format   !< gets `decimals` and `power`
      integer :: k

      k = floor(order + order_margin)
      format%power = 0
      if (digits_after_first - k > max_decimals - more .or. digits_after_first - k < 0) &
         format%power = 3*floor(real(k, wp)/3.0_wp + order_margin)
      format%decimals = digits_after_first - (k - format%power)
   end subroutine choose_digits

   !> Appends a cell of a file: a number with all digits, a count, a word, or nothing.
   subroutine add_cell(o, cell, degrees)
      type(output_t), intent(inout) :: o     !< the file
      type(cell_t), intent(in) :: cell       !< the cell
      logical, intent(in) :: degrees         !< the number is an angle, and the file has angles in degrees

      select case (cell%kind)
      case (cell_number)
         call add_number(o, cell%value, degrees)
      case (cell_count)
         call add(o, whole(nint(cell%value)))
      case (cell_unbounded)
         call add(o, trim(adjustl(unbounded_words(merge(1, 2, cell%value < 0.0_wp)))))
      case (cell_word)
         call add_name(o, trim(cell%word))
      end select
   end subroutine add_cell

   !> Appends a number with all digits.
   subroutine add_number(o, value, degrees)
      type(output_t), intent(inout) :: o     !< the file
      real(wp), intent(in) :: value          !< in the deck's units and rad
      logical, intent(in) :: degrees         !< the number is an angle, and the file has angles in degrees
      character(full_length) :: text
      integer :: length

      if (degrees) then
         call write_full(in_degrees(value), text, length)
      else
         call write_full(value, text, length)
      end if
      call add(o, text(:length))
   end subroutine add_number

   !> Appends a name as a cell of a file, in quotes if it holds a comma or a quote.
   subroutine add_name(o, name)
      type(output_t), intent(inout) :: o     !< the file
      character(*), intent(in) :: name       !< without trailing blanks

      if (scan(name, ',"') == 0) then
         call add(o, name)
      else
         call add(o, '"'//replaced(name, '"', ['""'])//'"')
      end if
   end subroutine add_name

   !> Gives a power of ten in the form of numbers: 1.E-12.
   pure function power_text(power) result(text)
      integer, intent(in) :: power           !< the exponent
      character(:), allocatable :: text

      text = whole(abs(power))
      text = '1.E'//merge('-', '+', power < 0)//repeat('0', max(0, 2 - len(text)))//text
   end function power_text

   !> Gives a unit with its power of ten, if there is one.
   pure function unit_of(power, unit) result(text)
      integer, intent(in) :: power           !< the exponent; 0: none
      character(*), intent(in) :: unit       !< name of the unit
      character(:), allocatable :: text

      text = unit
      if (power /= 0) text = power_text(power)//' '//unit
   end function unit_of

   !> Gives a text at the right end of a field.
   pure function right(text, n) result(field)
      character(*), intent(in) :: text       !< the field is as long if the text is longer than `n`
      integer, intent(in) :: n               !< characters of the field
      character(max(n, len(text))) :: field

      field = repeat(' ', len(field) - len(text))//text
   end function right
end module table
