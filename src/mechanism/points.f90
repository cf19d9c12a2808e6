!> The rows of the tables: the motion of links, of any point of any link, and of pairs.
module points
   use kinds, only: wp, label_length
   use mechanism, only: mechanism_t, request_t, pair_t, pair_prismatic, request_link, request_point, request_pair, &
      instant_count
   use planar, only: direction, rotated, quarter_turn, point_of
   use motion, only: motion_t, known_of, mark_of, mark_none
   implicit none
   private
   public :: row_t, row_of, coordinates_of, is_due, strides, any_due, is_fixed, point_motion, pair_motion

   !> One row of a table, in the deck's units of length and time and in radians.
   type :: row_t
      integer :: kind = request_link        !< request_link, request_point or request_pair
      character(label_length) :: name = ''  !< of the link, point or pair
      logical :: angular = .false.          !< a pair whose value is an angle
      integer :: known = 2                  !< how much of it exists, as in `motion_t`
      integer :: mark = mark_none           !< why the rest does not
      real(wp) :: value(3, 0:2) = 0.0_wp    !< x, y, phi (a pair: its value first) and their derivatives
   end type row_t

contains

   !> Whether `request` is printed at instant number `k` (0, 1, ...): every `every`-th, the first and the last, if any.
   pure logical function is_due(m, request, k)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      integer, intent(in) :: k

      is_due = request%every > 0
      if (is_due) is_due = mod(k, request%every) == 0 .or. k == instant_count(m) - 1
   end function is_due

   !> The different values of `every` among the requests of `m`.
   pure function strides(m) result(list)
      type(mechanism_t), intent(in) :: m
      integer, allocatable :: list(:)
      integer :: i

      allocate (list(0))
      do i = 1, size(m%requests)
         if (all([list, 0] /= m%requests(i)%every)) list = [list, m%requests(i)%every]
      end do
   end function strides

   !> Whether any request is printed at instant number `k` (0, 1, ...). `list`: the `strides` of the requests.
   pure logical function any_due(m, list, k)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: list(:), k

      any_due = any(mod(k, list) == 0) .or. (k == instant_count(m) - 1 .and. size(list) > 0)
   end function any_due

   !> The row of `request`, as far as the motion `q` is known. What belongs to the ground is known at every instant.
   pure function row_of(m, q, request) result(row)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(request_t), intent(in) :: request
      type(row_t) :: row

      row%kind = request%kind
      associate (i => request%subject)
         select case (request%kind)
         case (request_link)
            row%name = m%links(i)%name
            call note_known(m, q, i, row)
            if (m%links(i)%ground) then
               row%value(:, 0) = m%links(i)%position
               return
            end if
            row%value(:, 0) = q%position(:, i) + [q%origin, 0.0_wp]
            row%value(:, 1) = q%velocity(:, i)
            row%value(:, 2) = q%acceleration(:, i)
         case (request_point)
            row%name = m%points(i)%name
            call note_known(m, q, m%points(i)%link, row)
            if (m%links(m%points(i)%link)%ground) then
               row%value(:2, 0) = point_of(m%links(m%points(i)%link)%position, m%points(i)%offset)
               return
            end if
            row%value(:2, :) = point_motion(m, q, i)
            row%value(:2, 0) = row%value(:2, 0) + q%origin
         case (request_pair)
            row%name = m%pairs(i)%name
            row%angular = m%pairs(i)%kind /= pair_prismatic
            call note_known(m, q, m%points(m%pairs(i)%point_i)%link, row)
            call note_known(m, q, m%points(m%pairs(i)%point_j)%link, row)
            row%value(1, :) = pair_motion(m, q, m%pairs(i))
         end select
      end associate
   end function row_of

   !> How many columns a derivative of a row of the given `kind` has.
   elemental integer function coordinates_of(kind)
      integer, intent(in) :: kind

      coordinates_of = 1
      if (kind == request_link) coordinates_of = 3
      if (kind == request_point) coordinates_of = 2
   end function coordinates_of

   !> Whether the subject of `request` belongs to the ground.
   pure logical function is_fixed(m, request)
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request

      select case (request%kind)
      case (request_link)
         is_fixed = m%links(request%subject)%ground
      case (request_point)
         is_fixed = m%links(m%points(request%subject)%link)%ground
      case default
         is_fixed = .false.
      end select
   end function is_fixed

   !> Reduces what is known of `row` to what is known of `link`.
   pure subroutine note_known(m, q, link, row)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: link
      type(row_t), intent(inout) :: row

      if (m%links(link)%ground) return
      if (known_of(q, link) >= row%known) return
      row%known = known_of(q, link)
      row%mark = mark_of(q, link)
   end subroutine note_known

   !> Place from the motion's origin, velocity and acceleration (2, 0:2) of point number `i`, at u from its link's
   !> origin o:  p = o + u,  p' = o' + phi' u_t,  p'' = o'' + phi'' u_t - phi'^2 u,  u_t = (-u_y, u_x).
   pure function point_motion(m, q, i) result(p)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp) :: p(2, 0:2), u(2), u_t(2)

      associate (k => m%points(i)%link)
         u = rotated(m%points(i)%offset, direction(q%position(3, k)))
         u_t = quarter_turn(u)
         p(:, 0) = q%position(:2, k) + u
         p(:, 1) = q%velocity(:2, k) + q%velocity(3, k)*u_t
         p(:, 2) = q%acceleration(:2, k) + q%acceleration(3, k)*u_t - q%velocity(3, k)**2*u
      end associate
   end function point_motion

   !> Value and derivatives (0:2) of `pair`: the slide x_w = (Q - P) . e of a prismatic pair, eq. (3) and (4), or the
   !> relative angle phi_j - phi_i of a revolute pair.
   pure function pair_motion(m, q, pair) result(s)
      type(mechanism_t), intent(in) :: m
      type(motion_t), intent(in) :: q
      type(pair_t), intent(in) :: pair
      real(wp) :: s(0:2), d(2, 0:2), e(2), n(2)

      associate (i => m%points(pair%point_i)%link, j => m%points(pair%point_j)%link)
         if (pair%kind /= pair_prismatic) then
            s = [q%position(3, j) - q%position(3, i), q%velocity(3, j) - q%velocity(3, i), &
               q%acceleration(3, j) - q%acceleration(3, i)]
            return
         end if
         d = point_motion(m, q, pair%point_j) - point_motion(m, q, pair%point_i)
         e = direction(q%position(3, i) + pair%alpha)
         n = quarter_turn(e)
         associate (rate => q%velocity(3, i), alpha => q%acceleration(3, i))
            s(0) = dot_product(d(:, 0), e)
            s(1) = dot_product(d(:, 1), e) + rate*dot_product(d(:, 0), n)
            s(2) = dot_product(d(:, 2), e) + alpha*dot_product(d(:, 0), n) &
               + 2.0_wp*rate*dot_product(d(:, 1), n) - rate**2*s(0)
         end associate
      end associate
   end function pair_motion
end module points
