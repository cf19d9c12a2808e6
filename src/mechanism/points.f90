!> The rows of the tables: the motion of links, of any point of any link, and of pairs; instant centres, and centres of
!> curvature.
module points
   use kinds, only: wp, label_length
   use mechanism, only: settings_t, mechanism_t, request_t, pair_t, has_guide, request_link, request_point, &
      request_pair, request_pole, request_curve, is_centre, instant_count, request_links
   use names, only: subject_name
   use columns, only: form_of
   use instant_centres, only: centre_t, pole_of, curve_of, seen_from
   use planar, only: pi, direction, rotated, point_of, add_rotating
   use motion, only: motion_t, known_of, mark_none
   implicit none
   private
   public :: row_t, find_row, difference, is_due, is_listed, is_fixed

   !> One row of a table, in the deck's units of length and time and in radians. Its `value`: x, y, phi (a pair: its
   !> value first) and their derivatives; of a pole or curve as in `centre_t`.
   type, extends(centre_t) :: row_t
      integer :: kind = request_link        !< request_link, ..., request_curve
      character(2*label_length + 1) :: name = ''   !< of the link, point or pair; of both links, or point and link
      integer :: form = 0                   !< which columns it has
      integer :: known = 2                  !< how much of it exists, as in `motion_t`
      integer :: mark = mark_none           !< why the rest does not
   end type row_t

   !> A variable: a constant, or intent(out), the compiler makes number by number, and waits for each as it copies them.
   type(row_t), protected :: new_row = row_t()

contains

   !> Whether `request` has a row in the CSV at instant number `k` (0, 1, ...): where it is printed, and where a COLUMN
   !> card names it.
   pure logical function is_due(m, request, k)
      class(settings_t), intent(in) :: m
      type(request_t), intent(in) :: request
      integer, intent(in) :: k

      is_due = request%in_columns .or. is_printed(m, request, k)
   end function is_due

   !> Whether `request` is printed at instant number `k` (0, 1, ...): every `every`-th, the first and the last, if any.
   pure logical function is_printed(m, request, k)
      class(settings_t), intent(in) :: m
      type(request_t), intent(in) :: request
      integer, intent(in) :: k

      is_printed = request%every > 0
      if (is_printed) is_printed = mod(k, request%every) == 0 .or. k == instant_count(m) - 1
   end function is_printed

   !> Whether the listing has a row of `request` at instant number `k`: as it is printed, or without a card for it.
   pure logical function is_listed(m, request, k)
      class(settings_t), intent(in) :: m
      type(request_t), intent(in) :: request
      integer, intent(in) :: k

      is_listed = request%listed .or. is_printed(m, request, k)
   end function is_listed

   !> Finds the `row` of `request`, as far as the motion `q` is known. What belongs to the ground is known at every
   !> instant. A subroutine: of the many rows of a table none is copied.
   pure subroutine find_row(m, q, request, row)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(row_t), intent(inout) :: row
      real(wp) :: p(2, 0:2)
      integer :: links(3), k

      row = new_row
      row%kind = request%kind
      row%form = form_of(m, request)
      ! What is known of a row is what is known of its links.
      links = request_links(m, request)
      do k = 1, size(links)
         if (m%links(links(k))%ground .or. known_of(q, links(k)) >= row%known) cycle
         row%known = known_of(q, links(k))
         row%mark = q%mark
         if (allocated(q%link_mark)) row%mark = q%link_mark(links(k))
      end do

      associate (i => request%subject)
         if (.not. is_centre(request%kind)) row%name = subject_name(m, request%kind, i)
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
            row%value(1, :) = pair_motion(m, q, m%pairs(i))
            return
         case (request_pole)
            row%name = trim(m%links(request%second)%name)//' '//m%links(i)%name
            if (row%known < 1) return
            row%centre_t = pole_of(link_motion(q, request%second), link_motion(q, i), request%length, request%rate)
         case (request_curve)
            row%name = m%points(i)%name
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

   !> Position, velocity and acceleration (3, 0:2) of link number `i`.
   pure function link_motion(q, i) result(x)
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp) :: x(3, 0:2)

      x(:, 0) = q%position(:, i)
      x(:, 1) = q%velocity(:, i)
      x(:, 2) = q%acceleration(:, i)
   end function link_motion

   !> By how much the numbers of `one` differ from those of `row`, to first order (3, 0:2): a place at p = n/w, with the
   !> weight w, changes by (n' - p w')/w where n and w become n' and w'. Directions of lines count without half turns.
   pure function difference(one, row) result(d)
      type(row_t), intent(in) :: one, row
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

   !> Whether the subject of `request` belongs to the ground.
   pure logical function is_fixed(m, request)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request

      is_fixed = all(m%links(request_links(m, request))%ground)
   end function is_fixed

   !> Place from the motion's origin, velocity and acceleration (2, 0:2) of point number `i`, at u from its link's
   !> origin o:  p = o + u,  p' = o' + phi' u_t,  p'' = o'' + phi'' u_t - phi'^2 u,  u_t = (-u_y, u_x).
   pure function point_motion(m, q, i) result(p)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp) :: p(2, 0:2), x(3, 0:2), u(2)

      x = link_motion(q, m%points(i)%link)
      u = rotated(m%points(i)%offset, direction(x(3, 0)))
      p = x(:2, :)
      call add_rotating(u(1), u(2), x(3, 1), x(3, 2), p(:, 0), p(:, 1), p(:, 2))
   end function point_motion

   !> Value and derivatives (0:2) of `pair`: the slide x_w = (Q - P) . e of a prismatic pair, eq. (3) and (4), or the
   !> relative angle phi_j - phi_i of a revolute pair.
   pure function pair_motion(m, q, pair) result(s)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(pair_t), intent(in) :: pair
      real(wp) :: s(0:2), x(3, 0:2), y(3, 0:2), r(2, 0:2)

      x = link_motion(q, m%points(pair%point_i)%link)
      if (.not. has_guide(pair%kind)) then
         y = link_motion(q, m%points(pair%point_j)%link)
         s = y(3, :) - x(3, :)
         return
      end if
      ! Along the guide as seen from link i, in which P is at rest.
      r = seen_from(x, point_motion(m, q, pair%point_j))
      r(:, 0) = r(:, 0) - m%points(pair%point_i)%offset
      s = matmul(direction(pair%alpha), r)
   end function pair_motion
end module points
