!> Level 4. The printed listing, in the form of the paper's Rys. 5: title, data, structure, then the tables. It takes
!> finished data and depends on nothing else: two correct programs print the same bytes.
!>
!> Digits: positions, velocities and accelerations are printed with the decimals, and where need be the power of ten,
!> that give seven digits to the deck's characteristic length and rate; so one mechanism in millimetres and
!> in kilometres prints the same digits.
module listing
   use kinds, only: wp
   use constants, only: degree
   use mechanism, only: mechanism_t, request_link, request_point, request_pair
   use motion, only: motion_t, mark_none, mark_not_converged, mark_singular, mark_overflow
   use structure, only: findings_t
   use scales, only: characteristic_length, characteristic_rate
   use points, only: row_t, row_of, is_due
   use text_output, only: output_t, put
   use numerals, only: fixed, whole, full, numeral_length
   use phrases, only: phrase, say_program, say_set, say_title, say_data, say_structure, say_links, say_ground, &
      say_revolute, say_prismatic, say_coordinates, say_equations, say_freedoms, say_drives, say_results, &
      say_instant, say_link, say_point, say_pair, say_phi, say_value, say_rate, say_rate2, say_none, say_end, &
      say_solved, say_marked, say_no_position, say_no_rates, say_overflow, say_in_units
   implicit none
   private
   public :: layout_t, new_layout, listing_head, listing_instant, listing_end

   integer, parameter :: digits_after_first = 6
   integer, parameter :: kind_words(3) = [say_link, say_point, say_pair]

   !> Decimals and powers of ten: (length or angle, derivative).
   type :: layout_t
      integer :: decimals(2, 0:2) = digits_after_first
      integer :: power(2, 0:2) = 0
      integer :: time_decimals = digits_after_first
      integer :: time_power = 0
      real(wp) :: angle = 1.0_wp           !< radians in the unit in which angles are printed
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
   end function new_layout

   !> Decimals and power of ten for values of order 10**`order`: seven digits, no power as long as they fit.
   pure subroutine choose_digits(order, decimals, power)
      real(wp), intent(in) :: order
      integer, intent(out) :: decimals, power
      integer :: k
      ! An order that is a whole number but for rounding counts as one.
      real(wp), parameter :: margin = 1.0e-9_wp

      k = floor(order + margin)
      power = 0
      if (k < -2 .or. k > 4) power = 3*floor(real(k, wp)/3.0_wp + margin)
      decimals = digits_after_first - (k - power)
   end subroutine choose_digits

   !> Title, data and structure of one set.
   subroutine listing_head(o, l, m, findings)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(findings_t), intent(in) :: findings
      integer :: i

      associate (pl => m%polish)
         call put(o, ' KINMAT   '//phrase(say_program, pl))
         call put(o, '')
         call put(o, trim(' '//phrase(say_set, pl)//' '//whole(m%set_number) &
            //'   '//phrase(say_title, pl)//'   '//m%title))
         call put(o, '')
         call put(o, ' '//phrase(say_data, pl))
         do i = 1, size(m%echo)
            call put(o, ' '//trim(m%echo(i)))
         end do
         call put(o, '')
         call put_structure(o, pl, findings)
         call put(o, '')
         call put(o, ' '//phrase(say_results, pl))
         call put_units(o, l, m)
      end associate
   end subroutine listing_head

   subroutine put_structure(o, pl, f)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: pl
      type(findings_t), intent(in) :: f

      call put(o, ' '//phrase(say_structure, pl))
      call put(o, ' '//phrase(say_links, pl)//' '//whole(f%links)//', '//phrase(say_ground, pl)//' '//whole(f%ground) &
         //';  '//phrase(say_revolute, pl)//' '//whole(f%revolute) &
         //';  '//phrase(say_prismatic, pl)//' '//whole(f%prismatic))
      call put(o, ' '//phrase(say_coordinates, pl)//' W = '//whole(f%coordinates)//';  '//phrase(say_equations, pl) &
         //' R = '//whole(f%equations)//';  '//phrase(say_freedoms, pl)//' S = '//whole(f%freedoms) &
         //';  '//phrase(say_drives, pl)//' '//whole(f%drives))
   end subroutine put_structure

   !> The unit of each column, with its power of ten where there is one.
   subroutine put_units(o, l, m)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      character(:), allocatable :: turn
      character(:), allocatable :: per
      integer :: k
      character(2), parameter :: prefix(0:2) = ['  ', 'V ', 'A ']

      turn = trim(merge('DEG', 'RAD', m%degrees))
      call put(o, ' T '//unit_of(l%time_power, trim(m%time_unit)))
      do k = 0, 2
         per = ''
         if (k == 1) per = '/'//trim(m%time_unit)
         if (k == 2) per = '/'//trim(m%time_unit)//'**2'
         call put(o, ' '//trim(prefix(k))//'X, '//trim(prefix(k))//'Y ' &
            //unit_of(l%power(1, k), trim(m%length_unit)//per) &
            //'   '//trim(prefix(k))//phrase(say_phi, m%polish)//' '//unit_of(l%power(2, k), turn//per))
      end do
   end subroutine put_units

   pure function unit_of(power, unit) result(text)
      integer, intent(in) :: power
      character(*), intent(in) :: unit
      character(:), allocatable :: text

      text = '['//unit//']'
      if (power /= 0) text = '[10**'//whole(power)//' '//unit//']'
   end function unit_of

   !> The tables of instant number `step` (0, 1, ...), as far as the deck asks for them there.
   subroutine listing_instant(o, l, m, q, step)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: step
      integer :: i, last_kind

      last_kind = 0
      do i = 1, size(m%requests)
         if (.not. is_due(m, m%requests(i), step)) cycle
         if (last_kind == 0) call put_instant(o, l, m, q, step)
         if (m%requests(i)%kind /= last_kind) call put_column_heads(o, m%polish, m%requests(i)%kind)
         last_kind = m%requests(i)%kind
         call put_row(o, l, m%polish, q, row_of(m, q, m%requests(i)))
      end do
      if (last_kind == 0 .and. q%mark /= mark_none) call put_instant(o, l, m, q, step)
      if (q%mark /= mark_none) call put(o, ' *** '//mark_text(q%mark, m%polish))
   end subroutine listing_instant

   subroutine put_instant(o, l, m, q, step)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: step

      call put(o, '')
      call put(o, ' '//phrase(say_instant, m%polish)//' '//whole(step)//'   T = ' &
         //trim(adjustl(fixed(q%t, l%time_decimals, l%time_power))))
   end subroutine put_instant

   subroutine put_column_heads(o, pl, kind)
      type(output_t), intent(inout) :: o
      logical, intent(in) :: pl
      integer, intent(in) :: kind
      character(numeral_length) :: words(9)
      integer :: k
      character(1), parameter :: prefix(0:2) = [' ', 'V', 'A']

      words = ''
      select case (kind)
      case (request_link, request_point)
         do k = 0, 2
            words(3*k + 1) = trim(prefix(k))//'X'
            words(3*k + 2) = trim(prefix(k))//'Y'
            if (kind == request_link) words(3*k + 3) = trim(prefix(k))//phrase(say_phi, pl)
         end do
      case (request_pair)
         words(1) = phrase(say_value, pl)
         words(4) = phrase(say_rate, pl)
         words(7) = phrase(say_rate2, pl)
      end select
      call put(o, ' '//heads(phrase(kind_words(kind), pl), words))
   end subroutine put_column_heads

   !> A line of column heads over right-adjusted numbers.
   pure function heads(first, words) result(line)
      character(*), intent(in) :: first
      character(numeral_length), intent(in) :: words(:)
      character(:), allocatable :: line
      integer :: i

      line = first//repeat(' ', max(0, 8 - len(first)))
      do i = 1, size(words)
         line = line//adjustr(words(i))
      end do
      line = trim(line)
   end function heads

   !> One row: what is not known is a word, what the row does not have is blank.
   subroutine put_row(o, l, pl, q, row)
      type(output_t), intent(inout) :: o
      type(layout_t), intent(in) :: l
      logical, intent(in) :: pl
      type(motion_t), intent(in) :: q
      type(row_t), intent(in) :: row
      character(9 + 9*numeral_length) :: line
      integer :: k, c, first

      line = ' '//row%name
      do k = 0, 2
         do c = 1, columns_of(row%kind)
            first = 10 + numeral_length*(3*k + c - 1)
            associate (field => line(first:first + numeral_length - 1))
               if (k > q%known) then
                  field = adjustr(repeat(' ', numeral_length - len(phrase(say_none, pl)))//phrase(say_none, pl))
               else if (c == 3 .or. row%angular) then
                  field = fixed(row%value(c, k)/l%angle, l%decimals(2, k), l%power(2, k))
               else
                  field = fixed(row%value(c, k), l%decimals(1, k), l%power(1, k))
               end if
            end associate
         end do
      end do
      call put(o, trim(line))
   end subroutine put_row

   !> Columns of one derivative: x, y, phi of a link; x, y of a point; the value of a pair.
   pure integer function columns_of(kind)
      integer, intent(in) :: kind

      columns_of = 3
      if (kind == request_point) columns_of = 2
      if (kind == request_pair) columns_of = 1
   end function columns_of

   pure function mark_text(mark, pl) result(text)
      integer, intent(in) :: mark
      logical, intent(in) :: pl
      character(:), allocatable :: text

      select case (mark)
      case (mark_not_converged)
         text = phrase(say_no_position, pl)
      case (mark_singular)
         text = phrase(say_no_rates, pl)
      case (mark_overflow)
         text = phrase(say_overflow, pl)
      case default
         text = ''
      end select
   end function mark_text

   !> The last line of a set: how many instants were solved and how many are marked.
   subroutine listing_end(o, m, solved, marked)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: solved, marked

      call put(o, '')
      call put(o, ' '//phrase(say_end, m%polish)//' '//whole(m%set_number)//':  '//phrase(say_solved, m%polish)//' ' &
         //whole(solved)//', '//phrase(say_marked, m%polish)//' '//whole(marked))
      call put(o, '')
   end subroutine listing_end
end module listing
