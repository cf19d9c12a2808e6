!> Tests. The tables of one instant as the listing must print them, from closed forms in real128: the line over them
!> with the drives, heads with powers of ten and units, rows, what does not exist, masks. Nothing of the program's
!> tables is used.
module expected_tables
   use mechanism, only: drive_t, instant_count, instant, request_pair, request_measure, request_pole, &
      request_ratio, drive_angle, drive_relangle
   use quad_jet, only: qp, jet_t, degree_q
   use jet_drives, only: drive_jet
   use closed_forms_dyads, only: body_t
   use expected_scales, only: listed_t
   use expected_numbers, only: number_by_hand, power_text, field_length
   use expected_rows, only: expected_row_t, has_form, pair_slots, column_word, drive_word, listed_name
   use expected_ratios, only: row_at, unit_of
   use expected_tolerances, only: spread_lines
   use expected_centres, only: put_centre_heads_by_hand, put_centre_by_hand
   use text_output, only: output_t, put
   implicit none
   private
   public :: above_t, put_tables, put_heads, put_ratio_heads, with_unit, drive_value, instant_text

   integer, parameter :: name_length = 9, line_length = name_length + 9*field_length
   !> In English and in Polish.
   character(10), parameter :: instant_words(2) = [character(10) :: ' INSTANT ', ' CHWILA ']
   character(4), parameter :: none_words(2) = [character(4) :: 'NONE', 'BRAK']
   character(8), parameter :: coincide_words(2) = [character(8) :: 'COINCIDE', 'POKRYCIE']
   character(40), parameter :: unknown_words(2) = [character(40) :: 'DIGITS LOST TO ROUNDING', &
      'CYFRY UTRACONE PRZEZ ZAOKRAGLENIE']
   character(40), parameter :: singular_words(2, 2) = reshape([character(40) :: 'CHANGE POINT', &
      'VELOCITIES NOT UNIQUE', 'PUNKT ZMIANY', 'PREDKOSCI NIEJEDNOZNACZNE'], [2, 2])
   character(6), parameter :: link_words(2, 2) = reshape([character(6) :: 'LINK', 'LINKS', 'OGNIWO', 'OGNIWA'], [2, 2])
   character(14), parameter :: line_words(2) = [character(14) :: 'COLLINEAR', 'WSPOLLINIOWE']
   !> Two links with a smaller sine of the angle between them are in line: an instant is a change point but for the
   !> rounding of a double, and angles are off by its root at most.
   real(qp), parameter :: parallel = 1.0e-6_qp
   !> Smaller ratios with smaller derivatives are 0: in the decks of input/ both are 0 at no instant by chance.
   real(qp), parameter :: at_rest = 1.0e-25_qp
   !> The heads over links, points, pairs, measures, and links of which only the angle is listed; their words end where
   !> the numbers do.
   character(line_length), parameter :: heads(5, 2) = reshape([character(line_length) :: &
      ' LINK               X           Y         PHI          VX          VY        VPHI' &
      //'          AX          AY        APHI', &
      ' POINT              X           Y                      VX          VY                      AX          AY', &
      ' PAIR           SLIDE    VELOCITY            ACCELERATION       ANGLE    VELOCITY            ACCELERATION', &
      ' MEASURE       LENGTH    VELOCITY            ACCELERATION       ANGLE    VELOCITY            ACCELERATION', &
      ' LINK                                     PHI                                VPHI' &
      //'                                APHI', &
      ' OGNIWO             X           Y          FI          VX          VY         VFI' &
      //'          AX          AY         AFI', &
      ' PUNKT              X           Y                      VX          VY                      AX          AY', &
      ' PARA         PRZESUW    PREDKOSC          PRZYSPIESZENIE         KAT    PREDKOSC          PRZYSPIESZENIE', &
      ' WIELKOSC     DLUGOSC    PREDKOSC          PRZYSPIESZENIE         KAT    PREDKOSC          PRZYSPIESZENIE', &
      ' OGNIWO                                    FI                                 VFI' &
      //'                                 AFI'], [5, 2])
   !> Their columns, three a derivative: of lengths (1) or angles (2), or none.
   integer, parameter :: columns(3, 5) = reshape([1, 1, 2, 1, 1, 0, 1, 0, 2, 1, 0, 2, 0, 0, 2], [3, 5])
   integer, parameter :: of_angles_alone = 5
   !> The heads over pairs are those of slides, then those of angles; these begin here.
   integer, parameter :: before_angles = name_length + 4*field_length
   !> More drives do not stand over the tables, and no line is longer.
   integer, parameter :: most_drives = 6, widest = 120
   !> Heads stand once for all rows of a kind below them, for ratios of a dimension, but again after remarks and after
   !> so many lines.
   integer, parameter :: heads_every = 60

   !> The kind of rows to which the last heads belong, 0 where there are none, and the lines since.
   type :: above_t
      integer :: kind = 0, lines = 0
   end type above_t

contains

   !> Instant number `step` of `m`, whose links are at `b`, in the order of the deck; `resting`
   !> (links): they have no velocity of their own, for at a change point those numbered `crossing` have two; `error` (3,
   !> 0:2, requests), of size 0 where all digits are known. `remarks`: some follow. `above`: what the instant before has
   !> left.
   subroutine put_tables(o, m, step, b, resting, crossing, error, remarks, above)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      integer, intent(in) :: step
      type(body_t), intent(in) :: b(:)
      logical, intent(in) :: resting(:)
      integer, intent(in) :: crossing(:)
      real(qp), intent(in) :: error(:, 0:, :)
      logical, intent(in) :: remarks
      type(above_t), intent(inout) :: above
      type(expected_row_t) :: row
      character(line_length) :: line
      character(120) :: spreads(2)
      integer :: i, k, kind
      logical :: masked, begun

      begun = .false.
      masked = .false.
      do i = 1, size(m%requests)
         if (.not. m%requests(i)%listed) then
            if (m%requests(i)%every == 0) cycle
            if (mod(step, m%requests(i)%every) /= 0 .and. step /= instant_count(m%mechanism_t) - 1) cycle
         end if
         if (.not. begun) call put_time(o, m, step, above)
         begun = .true.
         kind = m%requests(i)%kind
         if (kind < request_pole) then
            row = row_at(m, real(instant(m%mechanism_t, step), qp), b, m%requests(i))
            if (row%kind == request_ratio) kind = request_ratio + row%dimension(1)
            ! A drive that does not move the quantity has no row.
            if (row%kind == request_ratio .and. all(abs(row%value(1, :1)) < at_rest)) cycle
         end if
         if (kind /= above%kind) then
            above = above_t(kind)
            if (kind >= request_ratio) then
               call put_ratio_heads(o, m, row)
            else if (kind >= request_pole) then
               call put_centre_heads_by_hand(o, m, m%requests(i))
            else if (kind == 1 .and. all(m%requests%angle_alone .or. m%requests%kind /= 1)) then
               call put_heads(o, m, of_angles_alone)
            else
               call put_heads(o, m, kind)
            end if
         end if
         above%lines = above%lines + 1
         if (m%requests(i)%kind >= request_pole) then
            call put_centre_by_hand(o, m, b, m%requests(i), resting)
            cycle
         end if
         if (size(error) > 0) then
            line = row_line(m, row, merge(0, 2, any(resting(row%links))), error(:, :, i))
         else
            line = row_line(m, row, merge(0, 2, any(resting(row%links))), 0.0_qp*row%value)
         end if
         if (m%requests(i)%angle_alone) then
            do k = 0, 2
               line(name_length + 3*field_length*k + 1:name_length + field_length*(3*k + 2)) = ''
            end do
         end if
         masked = masked .or. index(line, '?') > 0
         call put(o, trim(line))
         if (allocated(m%tolerances)) then
            spreads = spread_lines(m, i, real(instant(m%mechanism_t, step), qp))
            call put(o, trim(spreads(1)))
            call put(o, trim(spreads(2)))
            above%lines = above%lines + 2
         end if
      end do
      if (.not. begun .and. any(resting)) call put_time(o, m, step, above)
      if (masked .or. remarks .or. any(resting)) above%kind = 0
      if (any(resting)) call put(o, ' *** '//crossing_words(m, b, crossing))
      if (masked) call put(o, ' --- ?: '//trim(unknown_words(m%language)))
   end subroutine put_tables

   !> What there is to say of a change point: its links, and whether two of them are in line.
   function crossing_words(m, b, crossing) result(text)
      type(listed_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: crossing(:)
      character(:), allocatable :: text
      integer :: i

      text = trim(singular_words(1, m%language))//', '//trim(link_words(min(2, size(crossing)), m%language))
      do i = 1, size(crossing)
         if (i > 1) text = text//','
         text = text//' '//trim(m%links(crossing(i))%name)
      end do
      if (size(crossing) == 2) then
         if (abs(sin(b(crossing(2))%phi%v - b(crossing(1))%phi%v)) < parallel) &
            text = text//' '//trim(line_words(m%language))
      end if
      text = text//': '//trim(singular_words(2, m%language))
   end function crossing_words

   !> The heads over rows of one `kind`: names, powers of ten, units. What a unit is divided by has a line of its own
   !> where the longest unit has no room in its column, a blank before it.
   subroutine put_heads(o, m, kind)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      integer, intent(in) :: kind
      character(line_length) :: line(3), names
      character(:), allocatable :: unit
      integer :: c, k, at, bar
      logical :: has_room, has_slots

      has_room = max(3, len_trim(m%length_unit)) + len('/'//trim(m%time_unit)//'**2') <= field_length - 1
      names = heads(kind, m%language)
      has_slots = any(kind == [request_pair, request_measure])
      if (has_slots) then
         if (.not. has_form(m, kind, .true.)) names = names(:name_length)//names(before_angles + 1:)
         if (.not. has_form(m, kind, .false.)) names(before_angles + 1:) = ''
      end if
      line = ''
      do k = 0, 2
         do c = 1, 3
            if (columns(c, kind) == 0) cycle
            at = 3*k + c
            if (has_slots) then
               if (.not. has_form(m, kind, c == 1)) cycle
               at = pair_slots(k, merge(2, 1, c == 3 .and. has_form(m, kind, .true.)))
            end if
            call put_end(power_text(m%scales%power(columns(c, kind), k)), at, line(1))
            unit = unit_of(m, columns(c, kind), k)
            bar = index(unit//'/', '/')
            if (has_room) bar = len(unit) + 1
            call put_end(unit(:bar - 1), at, line(2))
            call put_end(unit(bar:), at, line(3))
         end do
      end do
      call put(o, trim(names))
      do k = 1, 3
         if (line(k) /= '') call put(o, trim(line(k)))
      end do
   end subroutine put_heads

   !> The heads over ratios of the dimension of `row`.
   subroutine put_ratio_heads(o, m, row)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(expected_row_t), intent(in) :: row
      character(line_length) :: line(3)
      integer :: k

      line = ''
      line(1) = merge(' PRZELOZENIE', ' RATIO      ', m%polish)
      associate (d => row%dimension(1))
         do k = 0, 1
            call put_end(column_word(row, 1, k, m%polish), row%slot(1, k), line(1))
            call put_end(power_text(m%scales%power(d, k)), row%slot(1, k), line(2))
            call put_end(unit_of(m, d, k), row%slot(1, k), line(3))
         end do
      end associate
      do k = 1, 3
         if (line(k) /= '') call put(o, trim(line(k)))
      end do
   end subroutine put_ratio_heads

   !> Puts `word` where column number `column` of `line` ends.
   subroutine put_end(word, column, line)
      character(*), intent(in) :: word
      integer, intent(in) :: column
      character(*), intent(inout) :: line
      integer :: last

      last = name_length + field_length*column
      line(last - len_trim(word) + 1:last) = word
   end subroutine put_end

   !> The lines over the tables: the instant, and where its drives are.
   subroutine put_time(o, m, step, above)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      integer, intent(in) :: step
      type(above_t), intent(inout) :: above
      character(:), allocatable :: line, word
      character(12) :: number, left_out
      integer :: i, first

      if (above%lines >= heads_every) above%kind = 0
      write (number, '(i0)') step
      call put(o, '')
      line = trim(instant_words(m%language))//' '//trim(number)
      first = len(line)
      line = line//'   T = '//with_unit(real(instant(m%mechanism_t, step), qp), m%scales%time_decimals, &
         m%scales%time_power, m%time_unit)
      do i = 1, min(most_drives, size(m%drives))
         word = '   '//drive_word(m, m%drives(i))//' = ' &
            //drive_value(m, m%drives(i), real(instant(m%mechanism_t, step), qp))
         write (left_out, '(i0)') size(m%drives) - i
         if (i == most_drives .and. size(m%drives) > i) word = word//' '//trim(merge('AND', 'I  ', .not. m%polish)) &
            //' '//trim(left_out)//' '//merge('MORE', 'INNE', .not. m%polish)
         if (len(line//word) > widest) then
            call put(o, line)
            line = repeat(' ', first)
            above%lines = above%lines + 1
         end if
         line = line//word
      end do
      call put(o, line)
      above%lines = above%lines + 2
   end subroutine put_time

   !> A time without its unit.
   function instant_text(m, t) result(text)
      type(listed_t), intent(in) :: m
      real(qp), intent(in) :: t
      character(:), allocatable :: text

      text = trim(adjustl(number_by_hand(t, 0.0_qp, m%scales%time_decimals, m%scales%time_power)))
   end function instant_text

   !> A number over the power of ten that stands before its unit.
   function with_unit(x, decimals, power, unit) result(text)
      real(qp), intent(in) :: x
      integer, intent(in) :: decimals, power
      character(*), intent(in) :: unit
      character(:), allocatable :: text

      text = trim(adjustl(number_by_hand(x, 0.0_qp, decimals, power)))
      if (power /= 0) text = text//' '//trim(power_text(power))
      text = text//' '//trim(unit)
   end function with_unit

   !> Where the drive `d` is at `t`, with as many digits as places and angles have in the tables.
   function drive_value(m, d, t) result(text)
      type(listed_t), intent(in) :: m
      type(drive_t), intent(in) :: d
      real(qp), intent(in) :: t
      character(:), allocatable :: text
      type(jet_t) :: f

      f = drive_jet(d, t)
      associate (what => merge(2, 1, any(d%kind == [drive_angle, drive_relangle])))
         if (what == 2 .and. m%degrees) f%v = f%v/degree_q
         text = with_unit(f%v, m%scales%decimals(what, 0), m%scales%power(what, 0), unit_of(m, what, 0))
      end associate
   end function drive_value

   !> The line of `row`, of which derivatives up to `known` exist.
   function row_line(m, row, known, error) result(line)
      type(listed_t), intent(in) :: m
      type(expected_row_t), intent(in) :: row
      integer, intent(in) :: known
      real(qp), intent(in) :: error(3, 0:2)
      character(line_length) :: line
      real(qp) :: unit
      integer :: c, k, first, what

      line = ' '//listed_name(row, m%polish)
      do k = 0, row%orders
         do c = 1, row%columns
            first = name_length + field_length*(row%slot(c, k) - 1) + 1
            what = row%dimension(c)
            unit = 1.0_qp
            if (m%degrees .and. what == 2) unit = degree_q
            line(first:first + field_length - 1) = repeat(' ', field_length - len(none_words))//none_words(m%language)
            if (k <= known) line(first:first + field_length - 1) = number_by_hand(row%value(c, k)/unit, &
               error(c, k)/unit, m%scales%decimals(what, k), m%scales%power(what, k))
            ! A length has its value, and no rates.
            if (row%coincides .and. k <= known .and. (k > 0 .or. what == 2)) &
               line(first:first + field_length - 1) = repeat(' ', &
               field_length - len(coincide_words))//coincide_words(m%language)
         end do
      end do
   end function row_line
end module expected_tables
