!> Tests. The rows of the tables from the places of the links, as jets in real128: a link's own, those of its points,
!> of pairs the angle or the slide, and measures; and the names of rows, also of ratios.
module expected_rows
   use mechanism, only: mechanism_t, drive_t, request_t, request_link, request_point, request_pair, request_measure, &
      request_ratio, drive_angle, drive_x, drive_y, drive_relangle, drive_slide, pair_prismatic, &
      measure_distance, measure_line, measure_angle, measure_xi, measure_sum
   use quad_jet, only: qp, jet_t, constant_jet, wrap_angle, operator(+), operator(-), operator(*), sqrt
   use closed_forms_dyads, only: body_t, place_t, body, place_on, seen_from, direction, distance_squared
   implicit none
   private
   public :: expected_row_t, row_by_hand, has_form, pair_slots, listed_name, column_word, drive_word

   !> Where the value, velocity and acceleration of slides stand, or those of angles where there are no slides; and
   !> where those of angles stand beside slides.
   integer, parameter :: pair_slots(0:2, 2) = reshape([1, 2, 4, 5, 6, 8], [3, 2])

   !> Closer points coincide: places of the decks are known better.
   real(qp), parameter :: same_place = 1.0e-20_qp

   !> A row of the kind `kind` of a request; `column`: which of x, y, phi its values stand under, a slide under x and
   !> the angle of a pair under phi; `links`: those that it depends on.
   type :: expected_row_t
      integer :: kind = request_link
      character(8) :: name = ''
      character(:), allocatable :: by        !< the drive of a ratio, as `drive_word`
      integer :: columns = 3, column(3) = [1, 2, 3]
      integer :: dimension(3) = [1, 1, 2]    !< of the columns: a length (1), an angle (2), or a ratio
      integer :: orders = 2                  !< the derivatives that there are; of a ratio one, by the drive
      integer :: slot(3, 0:2) = reshape([1, 2, 3, 4, 5, 6, 7, 8, 9], [3, 3])   !< of nine, from left to right
      integer, allocatable :: links(:)
      logical :: coincides = .false.         !< two points of a measure are at one place
      real(qp) :: value(3, 0:2) = 0.0_qp
   end type expected_row_t

contains

   !> The row that `request` asks for, of the links `b` in the order of the deck.
   function row_by_hand(m, b, request) result(row)
      class(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      type(request_t), intent(in) :: request
      type(expected_row_t) :: row
      type(place_t) :: p

      row%kind = request%kind
      associate (i => request%subject)
         select case (request%kind)
         case (request_link)
            row%name = m%links(i)%name
            row%links = [i]
            call take([b(i)%x, b(i)%y, b(i)%phi], row)
         case (request_point)
            row%name = m%points(i)%name
            row%links = [m%points(i)%link]
            p = point(m, b, i)
            call take([p%x, p%y], row)
         case (request_measure)
            row%name = m%measures(i)%name
            row%links = [integer ::]
            row%slot(1, :) = pair_slots(:, 1)
            if (m%measures(i)%is_angle) then
               row%column(1) = 3
               if (has_form(m, request_measure, .true.)) row%slot(1, :) = pair_slots(:, 2)
            end if
            call take([measure_value(m, b, i, row)], row)
         case default
            row%name = m%pairs(i)%name
            row%links = m%points([m%pairs(i)%point_i, m%pairs(i)%point_j])%link
            row%slot(1, :) = pair_slots(:, 1)
            if (m%pairs(i)%kind /= pair_prismatic) then
               row%column(1) = 3
               if (has_form(m, request_pair, .true.)) row%slot(1, :) = pair_slots(:, 2)
            end if
            call take([pair_value(m, b, i)], row)
         end select
      end associate
      row%dimension(:row%columns) = merge(2, 1, row%column(:row%columns) == 3)
   end function row_by_hand

   !> The name of `row`, of a ratio with that of its drive.
   function listed_name(row, polish) result(text)
      type(expected_row_t), intent(in) :: row
      logical, intent(in) :: polish
      character(:), allocatable :: text

      text = trim(row%name)
      if (row%kind == request_ratio) text = text//' '//trim(merge('WZGLEDEM', 'BY      ', polish))//' '//row%by
   end function listed_name

   !> The kind of the drive `d` and the names of what it drives.
   function drive_word(m, d) result(text)
      class(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: d
      character(:), allocatable :: text

      select case (d%kind)
      case (drive_angle)
         text = 'ANGLE '//trim(m%links(d%subject)%name)
      case (drive_x)
         text = 'X '//trim(m%points(d%subject)%name)
      case (drive_y)
         text = 'Y '//trim(m%points(d%subject)%name)
      case (drive_relangle)
         text = 'RELANGLE '//trim(m%links(d%subject)%name)//' '//trim(m%links(d%second)%name)
      case (drive_slide)
         text = 'SLIDE '//trim(m%pairs(d%subject)%name)
      end select
   end function drive_word

   !> The name of column `c` of a row: of its derivative number `k`, which only a ratio has here, or of its value.
   function column_word(row, c, k, polish) result(word)
      type(expected_row_t), intent(in) :: row
      integer, intent(in) :: c, k
      logical, intent(in) :: polish
      character(:), allocatable :: word
      character(7), parameter :: names(3, 6) = reshape([character(7) :: 'X', 'Y', 'PHI', 'X', 'Y', 'FI', &
         'SLIDE', '', 'ANGLE', 'PRZESUW', '', 'KAT', 'LENGTH', '', 'ANGLE', 'DLUGOSC', '', 'KAT'], [3, 6])
      character(10), parameter :: of_ratios(0:1, 2) = reshape([character(10) :: 'VALUE', 'DERIVATIVE', &
         'WARTOSC', 'POCHODNA'], [2, 2])
      integer :: language

      language = merge(2, 1, polish)
      if (row%kind == request_ratio) then
         word = trim(of_ratios(k, language))
         return
      end if
      if (row%kind == request_pair) language = language + 2
      if (row%kind == request_measure) language = language + 4
      word = trim(names(row%column(c), language))
   end function column_word

   !> Pairs or measures (`kind`) that are lengths (`of_length`) or angles are asked for.
   pure logical function has_form(m, kind, of_length)
      class(mechanism_t), intent(in) :: m
      integer, intent(in) :: kind
      logical, intent(in) :: of_length
      integer :: i

      has_form = .false.
      do i = 1, size(m%requests)
         if (m%requests(i)%kind /= kind .or. m%requests(i)%drive > 0) cycle
         associate (subject => m%requests(i)%subject)
            if (kind == request_pair) then
               has_form = has_form .or. ((m%pairs(subject)%kind == pair_prismatic) .eqv. of_length)
            else
               has_form = has_form .or. (m%measures(subject)%is_angle .neqv. of_length)
            end if
         end associate
      end do
   end function has_form

   subroutine take(value, row)
      type(jet_t), intent(in) :: value(:)
      type(expected_row_t), intent(inout) :: row

      row%columns = size(value)
      row%value(:size(value), 0) = value%v
      row%value(:size(value), 1) = value%d
      row%value(:size(value), 2) = value%dd
   end subroutine take

   !> Point number `i` of the plane.
   type(place_t) function point(m, b, i)
      class(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: i

      point = place_on(b(m%points(i)%link), real(m%points(i)%offset(1), qp), real(m%points(i)%offset(2), qp))
   end function point

   !> Measure number `i`, whose links are added to those of the row. A direction is above -pi and up to pi: no deck
   !> turns one beyond.
   recursive type(jet_t) function measure_value(m, b, i, row) result(value)
      class(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: i
      type(expected_row_t), intent(inout) :: row
      type(place_t) :: p, q
      type(jet_t) :: one(2)
      integer :: k

      value = constant_jet(0.0_qp)
      associate (measure => m%measures(i), subjects => m%measures(i)%subjects)
         select case (measure%kind)
         case (measure_distance, measure_line)
            p = point(m, b, subjects(1)%number)
            q = point(m, b, subjects(2)%number)
            row%links = [row%links, m%points(subjects%number)%link]
            row%coincides = row%coincides .or. hypot(q%x%v - p%x%v, q%y%v - p%y%v) < same_place
            if (row%coincides) return
            if (measure%kind == measure_distance) value = sqrt(distance_squared(p, q))
            if (measure%kind == measure_line) value = direction(p, q)
         case (measure_angle)
            do k = 1, 2
               if (subjects(k)%kind == request_measure) then
                  one(k) = measure_value(m, b, subjects(k)%number, row)
               else
                  one(k) = b(subjects(k)%number)%phi
                  row%links = [row%links, subjects(k)%number]
               end if
            end do
            value = one(2) - one(1)
            if (any(subjects%kind == request_measure)) value%v = wrap_angle(value%v)
         case (measure_sum)
            value = constant_jet(real(measure%constant, qp))
            do k = 1, size(subjects)
               if (subjects(k)%kind == request_pair) one(1) = pair_value(m, b, subjects(k)%number)
               if (subjects(k)%kind == request_measure) one(1) = measure_value(m, b, subjects(k)%number, row)
               value = value + real(subjects(k)%factor, qp)*one(1)
            end do
         case default
            p = seen_from(b(subjects(2)%number), point(m, b, subjects(1)%number))
            row%links = [row%links, m%points(subjects(1)%number)%link, subjects(2)%number]
            value = p%y
            if (measure%kind == measure_xi) value = p%x
         end select
      end associate
   end function measure_value

   !> The angle of pair number `i`, or how far its second point is along its guide.
   type(jet_t) function pair_value(m, b, i) result(value)
      class(mechanism_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      integer, intent(in) :: i
      type(body_t) :: guide
      type(place_t) :: q

      associate (pair => m%pairs(i))
         associate (first => b(m%points(pair%point_i)%link), second => b(m%points(pair%point_j)%link))
            value = second%phi - first%phi
            if (pair%kind /= pair_prismatic) return
            guide = body('', point(m, b, pair%point_i), first%phi + real(pair%alpha, qp))
            q = seen_from(guide, point(m, b, pair%point_j))
            value = q%x
         end associate
      end associate
   end function pair_value
end module expected_rows
