!> The layout of the tables of a set: digits, powers of ten, units, heads of columns.
!>
!> Digits: positions, velocities and accelerations are printed with the decimals, and where need be the power
!> of ten, that give seven digits to the deck's characteristic length and rate; so one mechanism in
!> millimetres and in kilometres prints the same digits.
module listing_layout
   use kinds, only: wp, label_length
   use planar, only: degree
   use mechanism, only: settings_t, mechanism_t, request_t, request_link, request_point, request_pair, request_pole, &
      request_curve, pair_prismatic
   use points, only: centre_numbers
   use independent, only: set_t, request_of
   use drives, only: law_t, new_law, pole_value, growing_sizes
   use names, only: drive_name, more
   use scales, only: characteristic_length, characteristic_rate, relative_tolerance, latest_time, is_length, &
      shortest_step
   use numerals, only: whole, numeral_length, max_decimals
   use text_output, only: output_t, put
   use phrases
   implicit none
   private
   public :: layout_t, head_drive_t, new_layout, digits_t, digits_for, column_powers, head_lines
   public :: line_length, name_length, names_length, row_length, links_turning, dimension_of, angle_unit, power_text, &
      unit_of, choose_digits, choose_time_digits, column_text, put_folded, right

   integer, parameter :: digits_after_first = 6
   !> An order that is a whole number but for rounding counts as one.
   real(wp), parameter :: margin = max(1.0e-9_wp, 32.0_wp*epsilon(1.0_wp))
   !> Characters of a line at most.
   integer, parameter :: line_length = 120
   !> Characters before a row's numbers, and of a whole row.
   integer, parameter :: name_length = 9, row_length = name_length + 9*numeral_length
   !> The kind of tables of links of which only the angle is listed, besides request_link, request_point, request_pair.
   integer, parameter :: links_turning = 0
   !> Whether x, y, phi are lengths (1) or angles (2). The slide of a pair counts as x, its angle as phi.
   integer, parameter :: dimension_of(3) = [1, 1, 2]
   !> In which of nine columns a table has x, y, phi and their derivatives (3, 0:2); 0: not at all.
   integer, parameter :: link_columns(3, 0:2) = reshape([1, 2, 3, 4, 5, 6, 7, 8, 9], [3, 3]), &
      point_columns(3, 0:2) = reshape([1, 2, 0, 4, 5, 0, 7, 8, 0], [3, 3]), &
      angle_columns(3, 0:2) = reshape([0, 0, 3, 0, 0, 6, 0, 0, 9], [3, 3])
   !> The columns of the value, velocity and acceleration of the first kind of pairs in a table, and of the second.
   integer, parameter :: pair_columns(0:2, 2) = reshape([1, 2, 4, 5, 6, 8], [3, 2])
   !> Characters of the name of a column at most: those of PRZYSPIESZENIE, which begins over the column before.
   integer, parameter :: name_room = 14
   !> Of more drives only the first stand at the head of an instant.
   integer, parameter :: max_drives = 6

   !> Decimals and powers of ten: (length or angle, derivative).
   type :: digits_t
      integer :: decimals(2, 0:2) = digits_after_first   !< digits after the point
      integer :: power(2, 0:2) = 0                       !< printed is the value over 10**power
   end type digits_t

   !> A drive at the head of an instant: what stands before and behind its value, and its form.
   type :: head_drive_t
      character(:), allocatable :: before, behind
      type(law_t) :: law
      character(:), allocatable :: infinite   !< the words for its value at the pole of its law, where that has one
      real(wp) :: unit = 1.0_wp            !< length or radians in the unit in which it is printed
      real(wp) :: size_of(0:1) = 0.0_wp    !< of what is added up to its value, (0) + (1) |t|: see `growing_sizes`
      integer :: decimals = digits_after_first, power = 0   !< as in `digits_t`
   end type head_drive_t

   !> The digits of the set, and of each of its independent mechanisms.
   type, extends(digits_t) :: layout_t
      type(digits_t), allocatable :: own(:)   !< (0:parts) 0: of the ground
      logical :: mixed = .false.              !< their powers of ten differ
      integer :: time_decimals = digits_after_first   !< of the instants, as above
      integer :: time_power = 0
      integer :: more_decimals = 0         !< of what tolerances do to a number, beside those of the number
      real(wp) :: angle = 1.0_wp           !< radians in the unit in which angles are printed
      integer :: links_table = request_link   !< the kind of the tables of links
      !> Of x, y, phi and their derivatives, or of the numbers of a pole or curve, by the kind of a table.
      integer :: column(3, 0:2, links_turning:request_curve) = 0
      ! By the kind of a table:
      character(row_length) :: names(links_turning:request_curve)      !< of the columns
      character(row_length) :: units(2, links_turning:request_curve)   !< under them; the second line only where long
      character(4*(row_length + 1)) :: heads(links_turning:request_curve)   !< all lines, where the parts' are the same
      integer :: head_length(links_turning:request_curve) = 0
      character(numeral_length) :: none    !< in the place of a number that does not exist
      character(:), allocatable :: before_instant, behind_time    !< of the line over the tables: ' INSTANT ', ' S'
      type(head_drive_t), allocatable :: drives(:)                !< that stand in it
      character(:), allocatable :: more_drives                    !< ' AND 3 MORE', or ''
   end type layout_t

contains

   !> The layout of the tables of the set `s`, from its deck alone.
   function new_layout(s) result(l)
      class(set_t), intent(in) :: s
      type(layout_t) :: l
      type(request_t) :: request
      logical :: slides, turns, whole_links, angles
      integer :: i, k

      if (s%degrees) l%angle = degree
      ! What a tolerance changes has four digits.
      if (s%largest_tolerance > 0.0_wp) &
         l%more_decimals = max(0, 3 - digits_after_first - floor(log10(s%largest_tolerance)))
      call choose_own_digits(l, s)
      call choose_time_digits(s, l%time_decimals, l%time_power)
      slides = .false.
      turns = .false.
      whole_links = .false.
      angles = .false.
      do i = 1, size(s%rows)
         request = request_of(s, i)
         angles = angles .or. request%angle_alone
         select case (request%kind)
         case (request_link)
            whole_links = whole_links .or. (request%every > 0 .and. .not. request%angle_alone)
         case (request_pair)
            associate (is_slide => s%parts(s%rows(i)%part)%pairs(request%subject)%kind == pair_prismatic)
               slides = slides .or. is_slide
               turns = turns .or. .not. is_slide
            end associate
         end select
      end do
      if (angles .and. .not. whole_links) l%links_table = links_turning
      l%column(:, :, links_turning) = angle_columns
      l%column(:, :, request_link) = link_columns
      l%column(:, :, request_point) = point_columns
      ! Slides and angles of pairs have columns only if such pairs are asked for.
      if (slides) l%column(1, :, request_pair) = pair_columns(:, 1)
      if (turns) l%column(3, :, request_pair) = pair_columns(:, merge(2, 1, slides))
      do k = request_pole, request_curve
         do i = 1, size(centre_numbers, 2)
            l%column(centre_numbers(1, i, k), centre_numbers(2, i, k), k) = i
         end do
      end do
      ! A pole has its direction behind its numbers.
      l%column(3, 0, request_pole) = size(centre_numbers, 2) + 1
      do k = links_turning, request_curve
         l%names(k) = column_names(l, k, s%polish)
         l%units(:, k) = unit_lines(l, s, k)
         l%heads(k) = head_lines(l, l%digits_t, k)
         l%head_length(k) = len_trim(l%heads(k))
      end do
      l%none = phrase(say_none, s%polish)
      l%none = adjustr(l%none)
      l%before_instant = ' '//phrase(say_instant, s%polish)//' '
      l%behind_time = ' '//unit_of(l%time_power, trim(s%time_unit))
      allocate (l%drives(min(size(s%drives), max_drives)))
      do k = 1, size(l%drives)
         associate (part => s%drives(k)%part)
            call take_drive(l, l%own(part), s%parts(part), s%drives(k)%number, l%drives(k))
         end associate
      end do
      l%more_drives = more(size(s%drives) - size(l%drives), s%polish)
   end function new_layout

   !> The digits of the times of `m`: as many as other numbers have, and as many as show two digits of its shortest
   !> step, or one, if there is room for them. So instants that are not the same have other times.
   pure subroutine choose_time_digits(m, decimals, power)
      class(settings_t), intent(in) :: m
      integer, intent(out) :: decimals, power
      integer :: before, room, needed

      decimals = digits_after_first
      power = 0

      associate (time => latest_time(m))
         if (.not. time > 0.0_wp) return
         call choose_digits(log10(time), decimals, power)
         before = max(1, 1 + digits_after_first - decimals)
         ! Beside the point, and a blank before it; those before zero have a sign.
         room = numeral_length - 2 - before - merge(1, 0, min(m%t0, m%t1, minval(m%at)) < 0.0_wp)
         needed = power + 1 + ceiling(-log10(shortest_step(m)) - margin)
         if (needed <= room + 1) decimals = max(decimals, min(room, needed))
      end associate
   end subroutine choose_time_digits

   !> Drive number `k` of `m`, with the digits `d`, ready for the head of an instant.
   subroutine take_drive(l, d, m, k, drive)
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      type(head_drive_t), intent(out) :: drive
      real(wp) :: sizes(3, 0:1)
      integer :: what

      what = merge(1, 2, is_length(m%drives(k)))
      drive%before = '   '//trim(drive_name(m, m%drives(k)))//' = '
      drive%behind = ' '//unit_of(d%power(what, 0), trim(merge(angle_unit(m), m%length_unit, what == 2)))
      drive%law = new_law(m%drives(k))
      if (abs(pole_value(m%drives(k), m%t0)) > 0.0_wp) drive%infinite = phrase(say_infinite, m%polish)
      sizes = growing_sizes(drive%law, latest_time(m))
      drive%size_of = sizes(1, :)
      if (what == 2) drive%unit = l%angle
      drive%decimals = d%decimals(what, 0)
      drive%power = d%power(what, 0)
   end subroutine take_drive

   !> The digits of one mechanism; `angle`: radians in the unit in which angles are printed; `more`: decimals that some
   !> rows have in addition.
   pure type(digits_t) function digits_for(m, angle, more) result(d)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: angle
      integer, intent(in), optional :: more
      real(wp) :: length, rate
      integer :: k

      length = characteristic_length(m)
      rate = characteristic_rate(m, length)
      do k = 0, 2
         call choose_digits(log10(length) + k*log10(rate), d%decimals(1, k), d%power(1, k), more)
         call choose_digits(k*log10(rate) + log10(merge(1.0_wp/angle, 1.0_wp, k > 0)), &
            d%decimals(2, k), d%power(2, k), more)
      end do
   end function digits_for

   !> Each part of `s` has its own digits. Where none has more than one decimal more than another, all have those of the
   !> largest.
   pure subroutine choose_own_digits(l, s)
      type(layout_t), intent(inout) :: l
      class(set_t), intent(in) :: s
      type(digits_t) :: largest
      integer :: c

      allocate (l%own(0:s%count))
      do c = 1, s%count
         l%own(c) = digits_for(s%parts(c), l%angle, l%more_decimals)
      end do
      l%digits_t = l%own(1)
      largest = l%own(1)
      do c = 2, s%count
         l%mixed = l%mixed .or. any(l%own(c)%power /= l%own(1)%power)
         l%decimals = min(l%decimals, l%own(c)%decimals)
         largest%decimals = max(largest%decimals, l%own(c)%decimals)
      end do
      l%own(0) = l%digits_t
      if (.not. l%mixed .and. all(largest%decimals - l%decimals <= 1)) l%own = l%own(0)
   end subroutine choose_own_digits

   !> The powers of ten of the columns of rows of the given `kind` (9): what they do not have is 0.
   pure function column_powers(l, d, kind) result(power)
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      integer, intent(in) :: kind
      integer :: power(9), c, k

      power = 0
      do k = 0, 2
         do c = 1, 3
            if (l%column(c, k, kind) > 0) power(l%column(c, k, kind)) = d%power(dimension_of(c), order_of(kind, k))
         end do
      end do
   end function column_powers

   !> Decimals and power of ten for values of order 10**`order`: seven digits. No power where all of them, and `more`
   !> decimals, have room without one: from 0.001 to 9999999.
   pure subroutine choose_digits(order, decimals, power, more)
      real(wp), intent(in) :: order
      integer, intent(out) :: decimals, power
      integer, intent(in), optional :: more
      integer :: k, most

      k = floor(order + margin)
      power = 0
      most = max_decimals
      if (present(more)) most = most - more
      if (digits_after_first - k > most .or. digits_after_first - k < 0) &
         power = 3*floor(real(k, wp)/3.0_wp + margin)
      decimals = digits_after_first - (k - power)
   end subroutine choose_digits

   !> The lines over rows of the given `kind` with the digits `d`, joined by new_line('a'): names, powers of ten where
   !> there are any, units.
   pure function head_lines(l, d, kind) result(text)
      type(layout_t), intent(in) :: l
      type(digits_t), intent(in) :: d
      integer, intent(in) :: kind
      character(:), allocatable :: text
      character(numeral_length) :: words(9)
      integer :: power(9), k

      text = trim(l%names(kind))
      power = column_powers(l, d, kind)
      words = ''
      do k = 1, size(power)
         if (power(k) /= 0) words(k) = power_text(power(k))
      end do
      if (any(power /= 0)) text = text//new_line('a')//trim(in_columns(words, kind))
      text = text//new_line('a')//trim(l%units(1, kind))
      if (l%units(2, kind) /= '') text = text//new_line('a')//trim(l%units(2, kind))
   end function head_lines

   !> The names of the columns over rows of one kind.
   pure function column_names(l, kind, polish) result(line)
      type(layout_t), intent(in) :: l
      integer, intent(in) :: kind
      logical, intent(in) :: polish
      character(row_length) :: line
      character(name_room) :: words(9), word
      integer :: c, k
      character(1), parameter :: prefix(0:2) = [' ', 'V', 'A'], place(3) = ['X', 'Y', ' ']
      type(phrase_t), parameter :: kind_words(links_turning:request_curve) = &
         [say_link, say_link, say_point, say_pair, say_pole, say_curve], &
         pair_words(0:2) = [phrase_t(), say_velocity, say_acceleration]

      words = ''
      if (kind == request_pole) then
         word = phrase(say_xi, polish)
         words(:7) = [character(name_room) :: 'X', 'Y', trim(word)//'-I', 'ETA-I', trim(word)//'-J', 'ETA-J', &
            phrase(say_direction, polish)]
      else if (kind == request_curve) then
         words(:6) = [character(name_room) :: 'X', 'Y', phrase(say_tangent, polish), phrase(say_radius, polish), &
            'X-'//phrase(say_centre, polish), 'Y-'//phrase(say_centre, polish)]
      end if
      do k = 0, 2
         do c = 1, 3
            if (l%column(c, k, kind) == 0 .or. kind > request_pair) cycle
            if (kind == request_pair) then
               word = phrase(pair_words(k), polish)
               if (k == 0) word = phrase(merge(say_slide, say_angle, c == 1), polish)
            else if (c == 3) then
               word = trim(prefix(k))//phrase(say_phi, polish)
            else
               word = trim(prefix(k))//place(c)
            end if
            words(l%column(c, k, kind)) = word
         end do
      end do
      line = in_columns(words, kind)
      line(:names_length(kind)) = ' '//phrase(kind_words(kind), polish)
   end function column_names

   !> The units of the columns over rows of the given `kind`; where one is too long for its column, all that they are
   !> divided by stands in a second line.
   pure function unit_lines(l, m, kind) result(lines)
      type(layout_t), intent(in) :: l
      class(settings_t), intent(in) :: m
      integer, intent(in) :: kind
      character(row_length) :: lines(2)
      character(label_length) :: unit(3)
      character(label_length + 4) :: per(0:2)
      character(2*label_length + 4), dimension(9) :: first, second
      integer :: c, k

      unit = [character(label_length) :: m%length_unit, m%length_unit, angle_unit(m)]
      per = [character(label_length + 4) :: '', '/'//m%time_unit, '/'//trim(m%time_unit)//'**2']
      first = ''
      second = ''
      do k = 0, 2
         do c = 1, 3
            if (l%column(c, k, kind) == 0) cycle
            first(l%column(c, k, kind)) = unit(c)
            associate (of_rate => per(order_of(kind, k)))
               if (maxval(len_trim(unit)) + len_trim(per(2)) < numeral_length) then
                  first(l%column(c, k, kind)) = trim(unit(c))//of_rate
               else
                  second(l%column(c, k, kind)) = of_rate
               end if
            end associate
         end do
      end do
      lines(1) = in_columns(first, kind)
      lines(2) = in_columns(second, kind)
   end function unit_lines

   !> The order of the derivative in whose unit number (c, `k`) of a row of the given `kind` is: numbers of poles and
   !> curves are places.
   pure integer function order_of(kind, k)
      integer, intent(in) :: kind, k

      order_of = merge(0, k, kind >= request_pole)
   end function order_of

   !> Characters before the numbers of a row of the given `kind`; two names before those of a pole or curve.
   pure integer function names_length(kind)
      integer, intent(in) :: kind

      names_length = merge(2, 1, kind >= request_pole)*name_length
   end function names_length

   !> `words` (9), each ending where the numbers of its column end in rows of the given `kind`.
   pure function in_columns(words, kind) result(line)
      character(*), intent(in) :: words(9)
      integer, intent(in) :: kind
      character(row_length) :: line
      integer :: k

      line = ''
      do k = 1, merge(7, 9, kind >= request_pole)
         associate (last => names_length(kind) + numeral_length*k, word => words(k)(:len_trim(words(k))))
            line(last - len(word) + 1:last) = word
         end associate
      end do
   end function in_columns

   !> The word that ends over `column` of the head `line` of a table.
   pure function column_text(line, column) result(text)
      character(*), intent(in) :: line
      integer, intent(in) :: column
      character(:), allocatable :: text

      associate (before => line(:name_length + numeral_length*column))
         text = before(index(before, ' ', back=.true.) + 1:)
      end associate
   end function column_text

   !> The deck's unit of angles.
   pure character(label_length) function angle_unit(m)
      class(settings_t), intent(in) :: m

      angle_unit = merge('DEG', 'RAD', m%degrees)
   end function angle_unit

   !> A power of ten as numbers have it: 1.E-12.
   pure function power_text(power) result(text)
      integer, intent(in) :: power
      character(:), allocatable :: text

      text = whole(abs(power))
      text = '1.E'//merge('-', '+', power < 0)//repeat('0', max(0, 2 - len(text)))//text
   end function power_text

   !> A unit with its power of ten, if there is one.
   pure function unit_of(power, unit) result(text)
      integer, intent(in) :: power
      character(*), intent(in) :: unit
      character(:), allocatable :: text

      text = unit
      if (power /= 0) text = power_text(power)//' '//unit
   end function unit_of

   !> The words `text` behind `mark` in one line or, where names are many and long, in several. Lines after the first
   !> begin with `next`, or with `mark` as well.
   recursive subroutine put_folded(o, mark, text, next)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: mark, text
      character(*), intent(in), optional :: next
      integer :: last

      last = length_of_part(text, line_length - len(mark))
      call put(o, mark//text(:last))
      if (last == len(text)) return
      if (present(next)) call put_folded(o, next, trim(adjustl(text(last + 1:))))
      if (.not. present(next)) call put_folded(o, mark, trim(adjustl(text(last + 1:))))
   end subroutine put_folded

   !> So many characters of `text` that there is `room` for: all, those before three blanks or, where there are none,
   !> to a colon in the second half, or before a blank.
   pure integer function length_of_part(text, room) result(length)
      character(*), intent(in) :: text
      integer, intent(in) :: room

      length = len(text)
      if (length <= room) return
      length = index(text(:room + 1), '   ', back=.true.) - 1
      if (length > 0) return
      length = index(text(:room + 1), ': ', back=.true.)
      if (length < room/2) length = index(text(:room + 1), ' ', back=.true.) - 1
   end function length_of_part

   !> `text` at the end of `n` characters, or of more if it is longer.
   pure function right(text, n) result(field)
      character(*), intent(in) :: text
      integer, intent(in) :: n
      character(max(n, len(text))) :: field

      field = repeat(' ', len(field) - len(text))//text
   end function right
end module listing_layout
