!> The rows of the tables: the motion of links, points and pairs; measures; instant centres and centres of curvature;
!> ratios.
module points
   use assertions, only: asserts, assert
   use kinds, only: wp, label_length
   use mechanism, only: settings_t, mechanism_t, request_t, has_guide, request_link, request_point, &
      request_pair, request_measure, request_pole, request_curve, request_ratio, instant_count, &
      request_links, subject_links, measure_distance, measure_line, measure_angle, measure_xi, measure_eta, measure_sum
   use names, only: subject_name, drive_name
   use drives, only: drive_motion
   use scales, only: is_length
   use columns, only: columns_of_rows, forms, kinds_of_rows, form_of, of_length
   use instant_centres, only: centre_t, pole_of, curve_of, seen_from, centre_finite, points_coincide
   use pair_geometry, only: pair_motion
   use plane_vectors, only: pi, full_turn, degree, direction, rotated, point_of, add_rotating, cross
   use motion, only: motion_t, turned_t, known_of, flag_none, flag_singular, flag_stroke
   implicit none
   private
   public :: row_t, column_of_ratio, find_row, known_at, amplification_in_rows, difference, is_due, is_printed, &
      keep_turns

   !> One row of a table, in the deck's units of length and time and in rad. Its `value` has x, y, phi of a link, x, y
   !> of a point, or the coordinate of a pair or measure, with derivatives by time; of a pole or curve the numbers of
   !> `centre_t`.
   type, extends(centre_t) :: row_t
      integer :: kind = request_link        !< request_link, ..., request_ratio
      !> Of the link, point, pair or measure; of both links, or point and link; of a ratio the quantity BY the drive.
      character(4*label_length + 6) :: name = ''
      integer :: form = 0                   !< its columns: row_link, ...
      integer :: known = 2                  !< how much of it exists, as in `motion_t`
      integer :: flag = flag_none           !< why the rest does not exist: flag_none, ...
   end type row_t

   !> Two points that are closer, in characteristic lengths, coincide: their distance may be only rounding of their
   !> positions.
   real(wp), parameter :: coincidence_limit = 4.0_wp*epsilon(1.0_wp)
   !> If two directions of a line differ by half a turn within this angle (rad), they do not show which way the line has
   !> turned: rounding must not decide.
   real(wp), parameter :: half_turn_margin = 1.0e-9_wp

   !> The coordinate in the row of a ratio that has the ratio and its rate by time, for searches along the time.
   integer, parameter :: column_of_ratio = 2

   !> A row without numbers, never changed. Reason for a variable: gfortran builds a constant, or intent(out), number by
   !> number, and a copy waits for each.
   type(row_t), protected :: new_row = row_t()

contains

   !> Tells whether a request has a row in the CSV at an instant: by its interval, or at all instants by a COLUMN card.
   pure logical function is_due(settings, request, k)
      class(settings_t), intent(in) :: settings   !< of the set
      type(request_t), intent(in) :: request !< of the set
      integer, intent(in) :: k               !< number of the instant, from 0

      is_due = request%in_columns .or. is_printed(settings, request, k)
   end function is_due

   !> Tells whether a request is printed at an instant: at every `every`-th instant, at the first and at the last. A
   !> request with `every` = 0 is never printed.
   pure logical function is_printed(settings, request, k)
      class(settings_t), intent(in) :: settings   !< of the set
      type(request_t), intent(in) :: request !< of the set
      integer, intent(in) :: k               !< number of the instant, from 0

      is_printed = request%every > 0
      if (is_printed) is_printed = mod(k, request%every) == 0 .or. k == instant_count(settings) - 1
   end function is_printed

   !> Finds the row of a request, as far as the motion is known. Numbers that are not known, or do not exist, are of no
   !> use: `known` and `state` of the row tell. Links and points of the ground are known at every instant. Reason for a
   !> subroutine: none of the many rows of a table is copied.
   pure subroutine find_row(m, q, request, row)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request !< of `m`
      type(row_t), intent(inout) :: row      !< becomes the row of the request
      real(wp) :: p(2, 0:2)

      if (asserts) call assert(size(q%position, 2) == size(m%links), 'find_row: a motion of all links')
      if (request%drive > 0) then
         call find_ratio(m, q, request, row)
         return
      end if
      row = new_row
      row%kind = request%kind
      row%form = form_of(m, request)
      ! Mostly all is known of all links. Only measures need an allocated list of links.
      if (q%known < 2 .or. q%flag == flag_stroke .or. allocated(q%link_known)) then
         if (request%kind == request_measure) then
            call find_known(m, q, request_links(m, request), row%known, row%flag)
         else
            call find_known(m, q, subject_links(m, request%kind, request%subject, request%second), row%known, row%flag)
         end if
      end if

      associate (i => request%subject)
         row%name = subject_name(m, kinds_of_rows(request%kind)%subject, i)
         select case (request%kind)
         case (request_link)
            if (m%links(i)%ground) then
               row%value(:, 0) = m%links(i)%position
               return
            end if
            row%value = link_motion(q, i)
         case (request_point)
            if (m%links(m%points(i)%link)%ground) then
               row%value(:2, 0) = point_of(m%links(m%points(i)%link)%position, m%points(i)%offset)
               return
            end if
            row%value(:2, :) = point_motion(m, q, i)

         case (request_pair)
            row%value(1, :) = motion_of_pair(m, q, i)
            return
         case (request_measure)
            if (row%known >= 0) call find_measure(m, q, i, row%value(1, :), row%state, row%weight)
            return

         case (request_pole)
            row%name = trim(m%links(request%second)%name)//' '//row%name
            if (row%known < 1) return
            row%centre_t = pole_of(link_motion(q, request%second), link_motion(q, i), request%length, request%rate)
         case (request_curve)
            if (request%second > 0) row%name = trim(row%name)//' '//m%links(request%second)%name
            ! In the axes of the link from which it is seen, or in the fixed plane.
            p = point_motion(m, q, i)
            if (request%second > 0) p = seen_from(link_motion(q, request%second), p)
            if (row%known < 2) p(:, max(0, row%known + 1):) = 0.0_wp
            row%centre_t = curve_of(p, request%length, request%rate)
            if (request%second > 0) return
            row%value(:2, 1) = row%value(:2, 1) + q%origin
         end select
         row%value(:2, 0) = row%value(:2, 0) + q%origin
      end associate
   end subroutine find_row

   !> Finds the row of a ratio: the velocity and the acceleration of a pair or measure, in the deck's units, in the
   !> motion in which only the drive moves, with the rate 1.
   !>
   !> - value(1, 0) is the ratio, value(1, 1) its derivative by the value of the drive;
   !> - value(column_of_ratio, 1:) is the ratio and its rate by time, for searches along the time.
   !>
   !> If the motion by the drive is not known, nothing of the row exists: `known` is -1.
   pure subroutine find_ratio(m, q, request, row)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request !< of `m`
      type(row_t), intent(inout) :: row      !< becomes the row of the request
      type(motion_t) :: unit
      integer, allocatable :: links(:)
      real(wp) :: s(0:2), f(3), in_angles, in_drive

      row = new_row
      row%kind = request_ratio
      row%form = form_of(m, request)
      row%name = trim(subject_name(m, request%kind, request%subject))//' BY '//drive_name(m, m%drives(request%drive))
      links = request_links(m, request)
      call find_known(m, q, links, row%known, row%flag)
      if (row%known < 0) return

      row%known = -1
      row%flag = flag_singular
      if (.not. allocated(q%by)) return
      associate (by => q%by(request%drive))
         if (.not. allocated(by%velocity)) return
         if (.not. all(by%is_known(links) .or. m%links(links)%ground)) return
         allocate (unit%position, unit%velocity, unit%acceleration, mold=q%position)
         unit%position(:, links) = q%position(:, links)
         unit%velocity(:, links) = by%velocity(:, links)
         unit%acceleration(:, links) = by%acceleration(:, links)
      end associate

      row%known = 2
      row%flag = flag_none
      if (request%kind == request_pair) then
         s = motion_of_pair(m, unit, request%subject)
      else
         call find_measure(m, unit, request%subject, s, row%state, row%weight)
      end if

      in_angles = merge(degree, 1.0_wp, m%degrees)
      f = drive_motion(m%drives(request%drive), q%t)
      in_drive = merge(1.0_wp, in_angles, is_length(m%drives(request%drive)))
      if (columns_of_rows(forms(form_of(m, request_t(request%kind, request%subject)))%first)%dimension == of_length) &
         in_angles = 1.0_wp
      row%value(1, 0) = s(1)*(in_drive/in_angles)
      row%value(1, 1) = s(2)*(in_drive/in_angles)*in_drive
      row%value(column_of_ratio, 1:) = [row%value(1, 0), row%value(1, 1)*(f(2)/in_drive)]
   end subroutine find_ratio

   !> Finds how much of a row is known: as much as of its least known link.
   pure subroutine find_known(m, q, links, known, flag)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: links(:)        !< (any number) their numbers
      integer, intent(inout) :: known        !< as in `motion_t`; at first, as if no link lacked anything
      integer, intent(inout) :: flag         !< why the rest is not known: flag_none, ...
      integer :: k

      if (q%flag == flag_stroke) flag = q%flag
      do k = 1, size(links)
         if (m%links(links(k))%ground .or. known_of(q, links(k)) >= known) cycle
         known = known_of(q, links(k))
         flag = q%flag
         if (allocated(q%link_flag)) flag = q%link_flag(links(k))
      end do
   end subroutine find_known

   !> Finds how much of a row exists: -1 nothing, 0 its value, 1 its rate too, 2 its acceleration too. If points
   !> coincide, only the value of a length exists.
   pure integer function known_at(row)
      type(row_t), intent(in) :: row         !< as `find_row` leaves it

      known_at = row%known
      if (row%state /= points_coincide) return
      known_at = merge(0, -1, row%known >= 0 .and. columns_of_rows(forms(row%form)%first)%there(points_coincide))
   end function known_at

   !> Gives the position, velocity and acceleration (3, 0:2) of a link: x, y from the motion's origin (length), phi
   !> (rad), and their derivatives by time.
   pure function link_motion(q, i) result(x)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i               !< number of the link
      real(wp) :: x(3, 0:2)

      x(:, 0) = q%position(:, i)
      x(:, 1) = q%velocity(:, i)
      x(:, 2) = q%acceleration(:, i)
   end function link_motion

   !> Finds by how much (3, 0:2) the numbers of a changed row differ from the numbers of a row, to first order, in the
   !> units of the row. A coordinate p = n/w of a centre, with its weight w, changes by (n' - p w')/w if n and w become
   !> n' and w'. Directions of lines are compared without half turns.
   pure function difference(one, row) result(d)
      type(row_t), intent(in) :: one         !< the changed row
      type(row_t), intent(in) :: row         !< the row itself
      real(wp) :: d(3, 0:2)

      d = abs(one%value - row%value)
      if (row%kind == request_pole) then
         d(:2, :) = d(:2, :)*abs(one%weight/row%weight)
         d(3, :) = abs(d(3, :) - pi*anint(d(3, :)/pi))
      else if (row%kind == request_curve) then
         d(:, 1:) = d(:, 1:)*abs(one%weight/row%weight)
         d(3, 0) = abs(d(3, 0) - pi*anint(d(3, 0)/pi))
      end if
   end function difference

   !> Gives the position from the motion's origin, the velocity and the acceleration x, y (2, 0:2) of a point, in the
   !> deck's units. With the vector u from its link's origin o to the point:
   !>   p = o + u,  p' = o' + phi' u_t,  p'' = o'' + phi'' u_t - phi'^2 u,  u_t = (-u_y, u_x).
   pure function point_motion(m, q, i) result(p)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i               !< number of the point
      real(wp) :: p(2, 0:2), x(3, 0:2), u(2)

      x = link_motion(q, m%points(i)%link)
      u = rotated(m%points(i)%offset, direction(x(3, 0)))
      p = x(:2, :)
      call add_rotating(u(1), u(2), x(3, 1), x(3, 2), p(:, 0), p(:, 1), p(:, 2))
   end function point_motion

   !> Finds the value of a measure and its first two derivatives by time. With d from point P to point Q, s its length,
   !> w its angular velocity, and x x y = x1 y2 - x2 y1:
   !>   s = |d|,    s' = d.d'/s,       s'' = ((d x d')/s)**2/s + d.d''/s   (Rejected: d'.d' - s'**2, which cancels),
   !>   w = d x d'/s**2,               w' = d x d''/s**2 - 2 (d.d') w/s**2.
   !> Between points of one link d is at rest in the link's axes, and a constant length has no rates, not even by
   !> rounding. If two of its points coincide, values that do not exist are 0. A measure that continues takes that one
   !> of all values of its angle that is nearest to its value in `turned`.
   pure recursive subroutine find_measure(m, q, i, values, state, closest)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i               !< number of the measure
      real(wp), intent(out) :: values(0:2)   !< length or rad, and derivatives; 0: does not exist
      integer, intent(inout) :: state        !< becomes points_coincide if two of its points coincide
      real(wp), intent(inout) :: closest     !< least distance of two points so far, characteristic lengths
      real(wp) :: d(2, 0:2), x(3, 0:2), one(0:2), distance
      logical :: is_rigid
      integer :: k

      values = 0.0_wp
      associate (measure => m%measures(i), subjects => m%measures(i)%subjects)
         select case (measure%kind)
         case (measure_distance, measure_line)
            is_rigid = m%points(subjects(1)%number)%link == m%points(subjects(2)%number)%link
            if (is_rigid) then
               d(:, 0) = m%points(subjects(2)%number)%offset - m%points(subjects(1)%number)%offset
               d(:, 1:) = 0.0_wp
            else
               d = point_motion(m, q, subjects(2)%number) - point_motion(m, q, subjects(1)%number)
            end if
            distance = norm2(d(:, 0))
            closest = min(closest, distance/measure%length)
            if (distance <= coincidence_limit*measure%length) then
               state = points_coincide
               return
            end if

            values(1) = cross(d(:, 0), d(:, 1))/distance
            if (measure%kind == measure_distance) then
               values = [distance, dot_product(d(:, 0), d(:, 1))/distance, &
                  values(1)*(values(1)/distance) + dot_product(d(:, 0), d(:, 2))/distance]
            else
               values(0) = atan2(d(2, 0), d(1, 0))
               values(1) = values(1)/distance
               values(2) = (cross(d(:, 0), d(:, 2))/distance - 2.0_wp*(dot_product(d(:, 0), d(:, &
                  1))/distance)*values(1))/distance
               if (is_rigid) then
                  x = link_motion(q, m%points(subjects(1)%number)%link)
                  values = values + x(3, :)
               end if
            end if

         case (measure_xi, measure_eta)
            if (m%points(subjects(1)%number)%link == subjects(2)%number) then
               d(:, 0) = m%points(subjects(1)%number)%offset
               d(:, 1:) = 0.0_wp
            else
               d = seen_from(link_motion(q, subjects(2)%number), point_motion(m, q, subjects(1)%number))
            end if
            values = d(merge(1, 2, measure%kind == measure_xi), :)

         case default
            do k = 1, size(subjects)
               select case (subjects(k)%kind)
               case (request_link)
                  x = link_motion(q, subjects(k)%number)
                  one = x(3, :)
               case (request_pair)
                  one = motion_of_pair(m, q, subjects(k)%number)
               case default
                  call find_measure(m, q, subjects(k)%number, one, state, closest)
               end select
               if (measure%kind == measure_sum) values = values + subjects(k)%factor*one
               if (measure%kind == measure_angle) values = one - values
            end do
            values(0) = values(0) + measure%constant
         end select
         if (.not. measure%continues .or. state == points_coincide) return
      end associate

      values(0) = between_half_turns(values(0))
      if (.not. allocated(q%turned)) return
      if (.not. q%turned(i)%is_known) return
      associate (turns => (q%turned(i)%angle - values(0))/full_turn)
         if (abs(abs(turns - anint(turns)) - 0.5_wp)*full_turn > half_turn_margin) values(0) = values(0) + &
            full_turn*anint(turns)
      end associate
   end subroutine find_measure

   !> Finds the largest factor by which relative roundings of the motion grow in the measures, poles and curves of a
   !> mechanism, all in units of the characteristic length and rate. The factor is huge for a centre at infinity or at
   !> rest.
   pure real(wp) function amplification_in_rows(m, q, rate) result(amplification)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q        !< all of it is known
      real(wp), intent(in) :: rate           !< characteristic rate, 1 over the unit of time
      type(row_t) :: row
      integer :: i

      amplification = 0.0_wp
      do i = 1, size(m%requests)
         associate (request => m%requests(i), v => row%value(3, 1), a => row%value(3, 2))
            if (request%kind == request_measure) amplification = max(amplification, &
               amplification_in_measure(m, q, request%subject, rate))
            if (.not. kinds_of_rows(request%kind)%is_centre) cycle
            call find_row(m, q, request, row)
            if (row%state /= centre_finite) then
               amplification = huge(1.0_wp)
            else if (request%kind == request_pole) then
               amplification = max(amplification, (1.0_wp + norm2(row%value(:2, 2))/request%length)*request%rate &
                  /abs(row%weight))
            else
               amplification = max(amplification, (1.0_wp + row%value(1, 2)/request%length)*(3.0_wp/v + (v + a) &
                  /abs(row%weight)))
            end if
         end associate
      end do
   end function amplification_in_rows

   !> Finds the factor by which relative roundings of the motion grow in a measure, in units of the characteristic
   !> length and rate. With v = |d'|/s and a = |d''|/s in characteristic rates, and d from point P to point Q, the
   !> factor is 1 + v + v**2 + a for s = |d|, and 1/s times as much for the direction; 0 if points coincide.
   pure recursive real(wp) function amplification_in_measure(m, q, i, rate) result(amplification)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q        !< all of it is known
      integer, intent(in) :: i               !< number of the measure
      real(wp), intent(in) :: rate           !< characteristic rate, 1 over the unit of time
      real(wp) :: d(2, 0:2), distance, v
      integer :: k

      amplification = 0.0_wp
      associate (measure => m%measures(i), subjects => m%measures(i)%subjects)
         if (any(measure%kind == [measure_distance, measure_line])) then
            d = point_motion(m, q, subjects(2)%number) - point_motion(m, q, subjects(1)%number)
            distance = norm2(d(:, 0))
            if (distance <= coincidence_limit*measure%length) return
            v = norm2(d(:, 1))/(distance*rate)
            amplification = 1.0_wp + v + v**2 + norm2(d(:, 2))/(distance*rate**2)
            if (measure%kind == measure_line) amplification = amplification*measure%length/distance
         else
            do k = 1, size(subjects)
               if (subjects(k)%kind == request_measure) amplification = max(amplification, &
                  abs(subjects(k)%factor)*amplification_in_measure(m, q, subjects(k)%number, rate))
            end do
         end if
      end associate
   end function amplification_in_measure

   !> Stores the values of the measures that continue in a motion. The next instant goes on from these values.
   pure subroutine keep_turns(m, q)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(inout) :: q     !< at an instant; its `turned` gets the values (rad)
      type(row_t) :: row
      integer :: i

      if (.not. allocated(m%measures)) return
      if (.not. any(m%measures%continues)) return
      if (.not. allocated(q%turned)) allocate (q%turned(size(m%measures)))
      do i = 1, size(m%measures)
         if (.not. m%measures(i)%continues) cycle
         call find_row(m, q, request_t(request_measure, i), row)
         associate (turned => q%turned(i))
            turned%is_latest = row%known >= 0 .and. row%state /= points_coincide
            if (turned%is_latest) turned = turned_t(row%value(1, 0), .true., .true.)
         end associate
      end do
   end subroutine keep_turns

   !> Gives a direction (rad) without whole turns, above -pi and up to pi. A direction that is -pi but for rounding
   !> becomes pi.
   pure real(wp) function between_half_turns(angle) result(x)
      real(wp), intent(in) :: angle          !< rad

      x = angle - full_turn*anint(angle/full_turn)
      if (x <= half_turn_margin - pi) x = x + full_turn
   end function between_half_turns

   !> Gives the coordinate of a pair with its first two derivatives by time (0:2): slide (length) or angle (rad).
   pure function motion_of_pair(m, q, i) result(s)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i               !< number of the pair
      real(wp) :: s(0:2), point(2, 0:2)

      associate (pair => m%pairs(i))
         ! Only a slide needs the point, and its sine and cosine.
         point = 0.0_wp
         if (has_guide(pair%kind)) point = point_motion(m, q, pair%point_j)
         s = pair_motion(m, pair, link_motion(q, m%points(pair%point_i)%link), &
            link_motion(q, m%points(pair%point_j)%link), point)
      end associate
   end function motion_of_pair
end module points
