!> The layout of the tables of a set: digits, powers of ten, units, heads of columns.
!>
!> Digits: positions, velocities and accelerations are printed with the decimals, and where need be the power
!> of ten, that give seven digits to the deck's characteristic length and rate; so one mechanism in
!> millimetres and in kilometres prints the same digits.
module listing_layout
   use kinds, only: wp, label_length
   use planar, only: degree
   use mechanism, only: drive_t, settings_t, request_t, request_link, request_point, request_pair, request_pole, &
      request_curve, pair_prismatic
   use points, only: centre_numbers
   use independent, only: set_t, request_of
   use drives, only: growing_sizes
   use names, only: drive_name, more
   use scales, only: characteristic_length, characteristic_rate, latest_time, is_length, shortest_step
   use numerals, only: whole, numeral_length, max_decimals
   use text_output, only: output_t, put
   use phrases
   implicit none
   private
   public :: layout_t, head_drive_t, new_layout, digits_t
   public :: line_length, name_length, names_length, row_length, links_turning, dimension_of, angle_unit, power_text, &
      unit_of, choose_digits, choose_time_digits, put_folded, right

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
      !> By the kind of a table: the lines over its rows, joined by new_line('a').
      character(4*(row_length + 1)) :: heads(links_turning:request_curve)
      integer :: head_length(links_turning:request_curve) = 0
   end type digits_t

   !> A drive at the head of an instant: what stands before and behind its value, and its form.
   type :: head_drive_t
      character(:), allocatable :: before, behind
      type(drive_t) :: law
      real(wp) :: unit = 1.0_wp            !< length or radians in the unit in which it is printed
      real(wp) :: size_of(0:1) = 0.0_wp    !< of what is added up to its value, (0) + (1) |t|: see `growing_sizes`
      integer :: decimals = digits_after_first, power = 0   !< as in `digits_t`
   end type head_drive_t

   !> The digits of the set, and of each of its independent mechanisms.
   type, extends(digits_t) :: layout_t
      type(digits_t), allocatable :: own(:)   !< (parts)
      integer :: time_decimals = digits_after_first   !< of the instants, as above
      integer :: time_power = 0
      integer :: more_decimals = 0         !< of what tolerances do to a number, beside those of the number
      real(wp) :: angle = 1.0_wp           !< radians in the unit in which angles are printed
      integer :: links_table = request_link   !< the kind of the tables of links
      ! By the kind of a table: which of nine columns x, y, phi and their derivatives have, or the numbers of a pole or
      ! curve; 0: none. What the rows are of. Of each column its name, its unit, and where units are long what they are
      ! divided by.
      integer :: column(3, 0:2, links_turning:request_curve) = 0
      character(name_length) :: word(links_turning:request_curve)
      character(name_room) :: name(9, links_turning:request_curve) = ''
      character(2*label_length + 4), dimension(9, links_turning:request_curve) :: unit = '', per = ''
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
      type(request_t), allocatable :: requests(:)
      real(wp) :: sizes(3, 0:1)
      logical :: slides, turns
      integer :: i, k, n

      if (s%degrees) l%angle = degree
      ! What a tolerance changes has four digits.
      if (s%largest_tolerance > 0.0_wp) &
         l%more_decimals = max(0, 3 - digits_after_first - floor(log10(s%largest_tolerance)))
      call choose_own_digits()
      call choose_time_digits(s, l%time_decimals, l%time_power)
      requests = [(request_of(s, i), i=1, size(s%rows))]
      if (any(requests%angle_alone) .and. .not. any(requests%kind == request_link .and. requests%every > 0 .and. &
         .not. requests%angle_alone)) l%links_table = links_turning
      slides = .false.
      turns = .false.
      do i = 1, size(requests)
         if (requests(i)%kind /= request_pair) cycle
         associate (is_slide => s%parts(s%rows(i)%part)%pairs(requests(i)%subject)%kind == pair_prismatic)
            slides = slides .or. is_slide
            turns = turns .or. .not. is_slide
         end associate
      end do
      do k = links_turning, request_curve
         call choose_columns(k)
         do i = 1, s%count
            call take_heads(l%own(i), k)
         end do
      end do
      l%none = phrase(say_none, s%polish)
      l%none = adjustr(l%none)
      l%before_instant = ' '//phrase(say_instant, s%polish)//' '
      l%behind_time = ' '//unit_of(l%time_power, trim(s%time_unit))
      allocate (l%drives(min(size(s%drives), max_drives)))
      do k = 1, size(l%drives)
         associate (m => s%parts(s%drives(k)%part), own => s%parts(s%drives(k)%part)%drives(s%drives(k)%number), &
            d => l%own(s%drives(k)%part), drive => l%drives(k))
            n = merge(1, 2, is_length(own))
            drive%before = '   '//trim(drive_name(m, own))//' = '
            drive%behind = ' '//unit_of(d%power(n, 0), trim(merge(angle_unit(m), m%length_unit, n == 2)))
            drive%law = own
            sizes = growing_sizes(drive%law, latest_time(m))
            drive%size_of = sizes(1, :)
            if (n == 2) drive%unit = l%angle
            drive%decimals = d%decimals(n, 0)
            drive%power = d%power(n, 0)
         end associate
      end do
      l%more_drives = more(size(s%drives) - size(l%drives), s%polish)

   contains

      !> Each part of the set has its own digits. Where none has more than one decimal more than another, all have those
      !> of the largest.
      subroutine choose_own_digits()
         type(digits_t) :: largest
         real(wp) :: length, rate
         integer :: c, k
         logical :: mixed

         allocate (l%own(s%count))
         do c = 1, s%count
            length = characteristic_length(s%parts(c))
            rate = characteristic_rate(s%parts(c), length)
            associate (d => l%own(c))
               do k = 0, 2
                  call choose_digits(log10(length) + k*log10(rate), d%decimals(1, k), d%power(1, k), l%more_decimals)
                  call choose_digits(k*log10(rate) + log10(merge(1.0_wp/l%angle, 1.0_wp, k > 0)), &
                     d%decimals(2, k), d%power(2, k), l%more_decimals)
               end do
            end associate
         end do
         l%digits_t = l%own(1)
         largest = l%own(1)
         mixed = .false.
         do c = 2, s%count
            mixed = mixed .or. any(l%own(c)%power /= l%own(1)%power)
            l%decimals = min(l%decimals, l%own(c)%decimals)
            largest%decimals = max(largest%decimals, l%own(c)%decimals)
         end do
         if (.not. mixed .and. all(largest%decimals - l%decimals <= 1)) l%own = l%digits_t
      end subroutine choose_own_digits

      !> The columns of rows of one `kind`: slides and angles of pairs only if such pairs are asked for.
      subroutine choose_columns(kind)
         integer, intent(in) :: kind
         character(1), parameter :: prefix(0:2) = [' ', 'V', 'A'], place(2) = ['X', 'Y']
         type(phrase_t), parameter :: kind_words(links_turning:request_curve) = &
            [say_link, say_link, say_point, say_pair, say_pole, say_curve], &
            slide_words(0:2) = [say_slide, say_velocity, say_acceleration], &
            angle_words(0:2) = [say_angle, say_velocity, say_acceleration]
         character(name_room) :: names(6)
         character(:), allocatable :: word
         integer :: c, k

         l%word(kind) = phrase(kind_words(kind), s%polish)
         select case (kind)
         case (request_pair)
            do k = 0, 2
               if (slides) call add_column(1, k, pair_columns(k, 1), phrase(slide_words(k), s%polish), kind)
               if (turns) &
                  call add_column(3, k, pair_columns(k, merge(2, 1, slides)), phrase(angle_words(k), s%polish), kind)
            end do
         case (request_pole, request_curve)
            word = phrase(say_xi, s%polish)
            names = [character(name_room) :: 'X', 'Y', word//'-I', 'ETA-I', word//'-J', 'ETA-J']
            word = phrase(say_centre, s%polish)
            if (kind == request_curve) names = [character(name_room) :: 'X', 'Y', phrase(say_tangent, s%polish), &
               phrase(say_radius, s%polish), 'X-'//word, 'Y-'//word]
            do k = 1, size(names)
               call add_column(centre_numbers(1, k, kind), centre_numbers(2, k, kind), k, trim(names(k)), kind)
            end do
            ! A pole has its direction behind its numbers.
            if (kind == request_pole) call add_column(3, 0, size(names) + 1, phrase(say_direction, s%polish), kind)
         case default
            do k = 0, 2
               do c = merge(3, 1, kind == links_turning), merge(2, 3, kind == request_point)
                  word = phrase(say_phi, s%polish)
                  if (c < 3) word = place(c)
                  call add_column(c, k, 3*k + c, trim(prefix(k))//word, kind)
               end do
            end do
         end select
      end subroutine choose_columns

      !> Gives the number (c, k) of the tables of one `kind` the `column` with this `name`. Where a unit is too long for
      !> its column, all that they are divided by stands in a second line.
      subroutine add_column(c, k, column, name, kind)
         integer, intent(in) :: c, k, column, kind
         character(*), intent(in) :: name
         character(label_length) :: unit(3)
         character(label_length + 4) :: per(0:2)

         unit = [character(label_length) :: s%length_unit, s%length_unit, angle_unit(s)]
         per = [character(label_length + 4) :: '', '/'//s%time_unit, '/'//trim(s%time_unit)//'**2']
         l%column(c, k, kind) = column
         l%name(column, kind) = name
         l%unit(column, kind) = unit(c)
         l%per(column, kind) = per(order_of(kind, k))
         if (maxval(len_trim(unit)) + len_trim(per(2)) >= numeral_length) return
         l%unit(column, kind) = trim(unit(c))//l%per(column, kind)
         l%per(column, kind) = ''
      end subroutine add_column

      !> The lines over rows of one `kind` with the digits `d`: names, powers of ten where there are any, units.
      subroutine take_heads(d, kind)
         type(digits_t), intent(inout) :: d
         integer, intent(in) :: kind
         character(row_length) :: names
         character(:), allocatable :: text
         character(numeral_length) :: powers(9)
         integer :: c, k

         powers = ''
         do k = 0, 2
            do c = 1, 3
               associate (column => l%column(c, k, kind), power => d%power(dimension_of(c), order_of(kind, k)))
                  if (column > 0 .and. power /= 0) powers(column) = power_text(power)
               end associate
            end do
         end do
         names = in_columns(l%name(:, kind), kind)
         names(:names_length(kind)) = ' '//l%word(kind)
         text = trim(names)
         if (any(powers /= '')) text = text//new_line('a')//trim(in_columns(powers, kind))
         text = text//new_line('a')//trim(in_columns(l%unit(:, kind), kind))
         if (any(l%per(:, kind) /= '')) text = text//new_line('a')//trim(in_columns(l%per(:, kind), kind))
         d%heads(kind) = text
         d%head_length(kind) = len(text)
      end subroutine take_heads
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

   !> The words `text` behind `mark` in one line or, where names are many and long, in several, which end before three
   !> blanks or, where there are none, after a colon in the second half, or before a blank. Lines after the first begin
   !> with `next`, or with `mark` as well.
   subroutine put_folded(o, mark, text, next)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: mark, text
      character(*), intent(in), optional :: next
      character(:), allocatable :: head, rest
      integer :: room, last

      head = mark
      rest = text
      do
         room = line_length - len(head)
         last = len(rest)
         if (last > room) then
            last = index(rest(:room + 1), '   ', back=.true.) - 1
            if (last <= 0) then
               last = index(rest(:room + 1), ': ', back=.true.)
               if (last < room/2) last = index(rest(:room + 1), ' ', back=.true.) - 1
            end if
         end if
         call put(o, head//rest(:last))
         if (last == len(rest)) return
         rest = trim(adjustl(rest(last + 1:)))
         if (present(next)) head = next
      end do
   end subroutine put_folded

   !> `text` at the end of `n` characters, or of more if it is longer.
   pure function right(text, n) result(field)
      character(*), intent(in) :: text
      integer, intent(in) :: n
      character(max(n, len(text))) :: field

      field = repeat(' ', len(field) - len(text))//text
   end function right
end module listing_layout
