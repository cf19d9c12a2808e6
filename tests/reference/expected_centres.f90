!> Tests. The rows of the cards POLE and CURVE as the listing must print them, from the places of the links as jets in
!> real128: the instant centre is the place that has one velocity in both links; the path of a point is written down in
!> the axes of the link from which it is seen, and differentiated there. Nothing of the program's centres is used.
module expected_centres
   use mechanism, only: request_t, request_pole
   use quad_jet, only: qp, pi_q, degree_q
   use closed_forms_dyads, only: body_t, place_t, fixed_place, place_on, seen_from
   use expected_scales, only: listed_t
   use expected_numbers, only: number_by_hand, power_text, field_length
   use text_output, only: output_t, put
   implicit none
   private
   public :: put_centre_heads_by_hand, put_centre_by_hand

   integer, parameter :: line_length = 18 + 7*field_length
   !> What is smaller than this is 0 in all of these decks, whose lengths and rates are of the order of 1 to 1E6: it is
   !> a rounding error of their numbers.
   real(qp), parameter :: nothing = 1.0e-9_qp
   !> In English and in Polish, of poles and of curves.
   character(line_length), parameter :: heads(2, 2) = reshape([character(line_length) :: &
      ' POLE                        X           Y        XI-I       ETA-I        XI-J       ETA-J   DIRECTION', &
      ' CURVE                       X           Y     TANGENT      RADIUS    X-CENTRE    Y-CENTRE', &
      ' BIEGUN                      X           Y       KSI-I       ETA-I       KSI-J       ETA-J    KIERUNEK', &
      ' TOR                         X           Y     STYCZNA     PROMIEN    X-SRODKA    Y-SRODKA'], [2, 2])
   !> Which of their columns are angles.
   logical, parameter :: is_angle(7, 2) = reshape([.false., .false., .false., .false., .false., .false., .true., &
      .false., .false., .true., .false., .false., .false., .false.], [7, 2])
   character(field_length), parameter :: none_words(2) = [character(field_length) :: 'NONE', 'BRAK'], &
      infinite_words(2) = [character(field_length) :: 'INFINITE', 'NIESKONCZ.'], &
      rest_words(2) = [character(field_length) :: 'AT REST', 'W SPOCZYNKU']

contains

   !> The lines over the rows of what `request` asks for.
   subroutine put_centre_heads_by_hand(o, m, request)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(request_t), intent(in) :: request
      character(field_length) :: power(7), unit(7)
      integer :: kind, columns

      kind = merge(1, 2, request%kind == request_pole)
      columns = merge(7, 6, kind == 1)
      unit = m%length_unit
      where (is_angle(:, kind)) unit = merge('DEG', 'RAD', m%degrees)
      power = power_text(m%scales%power(1, 0))
      where (is_angle(:, kind)) power = ''
      call put(o, trim(heads(kind, m%language)))
      if (any(power /= '')) call put(o, trim(line_of('', '', power(:columns))))
      call put(o, trim(line_of('', '', unit(:columns))))
   end subroutine put_centre_heads_by_hand

   !> The row of `request`, of the links `b` in the order of the deck; `resting` (links): they have no velocity.
   subroutine put_centre_by_hand(o, m, b, request, resting)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      type(request_t), intent(in) :: request
      logical, intent(in) :: resting(:)
      character(8) :: second

      if (request%kind == request_pole) then
         call put(o, trim(line_of(m%links(request%second)%name, m%links(request%subject)%name, &
            pole_fields(m, b(request%second), b(request%subject), &
            resting(request%second) .or. resting(request%subject)))))
      else
         second = ''
         if (request%second > 0) second = m%links(request%second)%name
         call put(o, trim(line_of(m%points(request%subject)%name, second, curve_fields(m, b, request, resting))))
      end if
   end subroutine put_centre_by_hand

   !> A line with two names and `fields`, each to the right of its column.
   function line_of(first, second, fields) result(line)
      character(*), intent(in) :: first, second
      character(field_length), intent(in) :: fields(:)
      character(line_length) :: line
      integer :: i

      line = ' '//first
      line(10:18) = ' '//second
      do i = 1, size(fields)
         line(19 + field_length*(i - 1):18 + field_length*i) = adjustr(fields(i))
      end do
   end function line_of

   !> The numbers of a pole. The plane of a link has the velocity c + w (-y, x) at (x, y), c = v - w (-y_o, x_o).
   function pole_fields(m, i, j, resting) result(fields)
      type(listed_t), intent(in) :: m
      type(body_t), intent(in) :: i, j
      logical, intent(in) :: resting
      character(field_length) :: fields(7)
      real(qp) :: c(2), w, p(2), u(2)

      c = plane(j) - plane(i)
      w = j%phi%d - i%phi%d
      ! The relative velocity at the origin of link J.
      u = c + w*[-j%y%v, j%x%v]
      if (resting) then
         fields = none_words(m%language)
      else if (abs(w) > nothing) then
         p = [-c(2), c(1)]/w
         fields(1:2) = lengths(m, p)
         fields(3:4) = lengths(m, in_axes(i, p))
         fields(5:6) = lengths(m, in_axes(j, p))
         fields(7) = ''
      else if (norm2(u) > nothing) then
         fields(:6) = infinite_words(m%language)
         fields(7) = angle(m, line_direction(-u(2), u(1)))
      else
         fields = rest_words(m%language)
      end if
   end function pole_fields

   !> The velocity at the origin of the fixed plane, carried by the link `b`.
   function plane(b) result(c)
      type(body_t), intent(in) :: b
      real(qp) :: c(2)

      c = [b%x%d + b%phi%d*b%y%v, b%y%d - b%phi%d*b%x%v]
   end function plane

   !> The place `p` of the fixed plane in the axes of the link `b`.
   function in_axes(b, p) result(q)
      type(body_t), intent(in) :: b
      real(qp), intent(in) :: p(2)
      real(qp) :: q(2)
      type(place_t) :: seen

      seen = seen_from(b, fixed_place(p(1), p(2)))
      q = [seen%x%v, seen%y%v]
   end function in_axes

   !> The numbers of a curve.
   function curve_fields(m, b, request, resting) result(fields)
      type(listed_t), intent(in) :: m
      type(body_t), intent(in) :: b(:)
      type(request_t), intent(in) :: request
      logical, intent(in) :: resting(:)
      character(field_length) :: fields(6)
      type(place_t) :: p
      real(qp) :: speed, turning
      logical :: no_velocity

      associate (point => m%points(request%subject))
         p = place_on(b(point%link), real(point%offset(1), qp), real(point%offset(2), qp))
         no_velocity = resting(point%link)
      end associate
      if (request%second > 0) then
         no_velocity = no_velocity .or. resting(request%second)
         p = seen_from(b(request%second), p)
      end if
      speed = hypot(p%x%d, p%y%d)
      turning = p%x%d*p%y%dd - p%y%d*p%x%dd
      fields(1:2) = lengths(m, [p%x%v, p%y%v])
      if (no_velocity) then
         fields(3:) = none_words(m%language)
      else if (speed > nothing) then
         fields(3) = angle(m, arrow_direction(p%x%d, p%y%d))
         fields(4:) = infinite_words(m%language)
         if (abs(turning) > nothing*speed) fields(4:) = lengths(m, [speed**3/abs(turning), &
            p%x%v - p%y%d*speed**2/turning, p%y%v + p%x%d*speed**2/turning])
      else
         fields(3:) = rest_words(m%language)
         if (hypot(p%x%dd, p%y%dd) > nothing) fields(3) = angle(m, arrow_direction(p%x%dd, p%y%dd))
      end if
   end function curve_fields

   !> The direction (x, y), above -180 deg and up to 180 deg, of rounded numbers.
   real(qp) function arrow_direction(x, y) result(phi)
      real(qp), intent(in) :: x, y

      phi = atan2(y, x)
      if (phi < nothing - pi_q) phi = phi + 2.0_qp*pi_q
   end function arrow_direction

   !> The direction of the line along (x, y), above -90 deg and up to 90 deg.
   real(qp) function line_direction(x, y) result(phi)
      real(qp), intent(in) :: x, y

      phi = 0.5_qp*pi_q
      if (abs(x) > nothing*abs(y)) phi = atan(y/x)
   end function line_direction

   function lengths(m, x) result(fields)
      type(listed_t), intent(in) :: m
      real(qp), intent(in) :: x(:)
      character(field_length) :: fields(size(x))
      integer :: i

      do i = 1, size(x)
         fields(i) = number_by_hand(x(i), 0.0_qp, m%scales%decimals(1, 0), m%scales%power(1, 0))
      end do
   end function lengths

   function angle(m, x) result(field)
      type(listed_t), intent(in) :: m
      real(qp), intent(in) :: x
      character(field_length) :: field

      field = number_by_hand(merge(x/degree_q, x, m%degrees), 0.0_qp, m%scales%decimals(2, 0), m%scales%power(2, 0))
   end function angle
end module expected_centres
