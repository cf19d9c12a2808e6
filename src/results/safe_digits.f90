!> Whether all digits of the tables are safe from roundings at an instant: by bounds, where an estimate of the errors
!> would take several times as long as a step. What is said to be safe no estimate would mask.
module safe_digits
   use kinds, only: wp
   use planar, only: degree
   use mechanism, only: mechanism_t, request_t, pair_prismatic, request_link, request_point, request_pair, request_pole
   use motion, only: motion_t
   use points, only: row_t, row_of, is_fixed, point_motion
   use sum_errors, only: fixed_error, round_sums
   use known_digits, only: errors_a_digit
   use listing_layout, only: digits_t, digits_for
   use scales, only: characteristic_length
   use block_engine, only: block_engine_t
   use card_roundings, only: caution
   use rounding_changes, only: rounding_response_t
   use rounding_bounds, only: rounding_bounds_t, make_rounding_bounds, bound_roundings, bound_of_turning, &
      bound_of_product, room
   implicit none
   private
   public :: safe_digits_t, make_safe_digits, are_digits_safe

   integer, parameter :: length = 1, angle = 2, slide = 3

   !> What the tables of a mechanism show, and the bounds of what they round.
   type :: safe_digits_t
      logical :: may_be = .false.             !< the question has an answer for what the tables show
      !> (length or angle, derivative) That hides no digit, and over caution.
      real(wp) :: hidden(2, 0:2) = 0.0_wp, error(2, 0:2) = 0.0_wp
      real(wp) :: span = 1.0_wp               !< the characteristic length
      real(wp) :: fixed(2) = 0.0_wp           !< the largest place and angle of the ground's rows
      real(wp) :: reach = 0.0_wp              !< the largest distance of a point from its link's origin
      integer, allocatable :: links(:)        !< whose places are shown, of theirs or of a point's
      logical, allocatable :: shows_angle(:)  !< (links)
      real(wp), allocatable :: reaches(:)     !< (links) of the points that are shown
      integer, allocatable :: turned_by(:)    !< (links) their orientations
      integer, allocatable :: joints(:, :)    !< (2, any number) the same of both links of revolute pairs that are shown
      integer, allocatable :: slides(:)       !< prismatic pairs that are shown
      type(rounding_bounds_t) :: bounds
   end type safe_digits_t

contains

   !> Ready for the tables of `m`, which `e` solves. Poles and curves, and what tolerances do, are left to the estimate.
   subroutine make_safe_digits(s, m, e)
      type(safe_digits_t), intent(out) :: s
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(digits_t) :: d
      integer :: k, i

      s%may_be = .not. allocated(m%tolerances) .and. .not. any(m%requests%kind >= request_pole)
      if (.not. s%may_be) return
      d = digits_for(m, merge(degree, 1.0_wp, m%degrees))
      do k = 0, 2
         s%hidden(:, k) = 10.0_wp**(d%power(:, k) - d%decimals(:, k))/errors_a_digit
      end do
      if (m%degrees) s%hidden(angle, :) = s%hidden(angle, :)*degree
      s%error = s%hidden/(caution*room)
      s%span = characteristic_length(m)
      do i = 1, size(m%points)
         s%reach = max(s%reach, norm2(m%points(i)%offset))
      end do
      call find_shown(s, m)
      s%turned_by = e%orientation_of(s%links)
      s%joints = reshape(e%orientation_of(reshape(s%joints, [size(s%joints)])), shape(s%joints))
      if (s%may_be) call make_rounding_bounds(s%bounds, size(m%links), e)
   end subroutine make_safe_digits

   !> What the requests of `m` show; of `joints` the links.
   subroutine find_shown(s, m)
      type(safe_digits_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      real(wp) :: reach(size(m%links))
      logical :: shows(size(m%links)), shows_angle(size(m%links)), shows_pair(size(m%pairs))
      integer :: i, k

      shows = .false.
      shows_angle = .false.
      shows_pair = .false.
      reach = 0.0_wp
      do i = 1, size(m%requests)
         k = m%requests(i)%subject
         if (is_fixed(m, m%requests(i))) then
            call look_at_fixed(s, m, m%requests(i))
            cycle
         end if
         select case (m%requests(i)%kind)
         case (request_link)
            shows(k) = .true.
            shows_angle(k) = .true.
         case (request_point)
            associate (link => m%points(k)%link)
               shows(link) = .true.
               reach(link) = max(reach(link), norm2(m%points(k)%offset))
            end associate
         case default
            shows_pair(k) = .true.
         end select
      end do
      s%links = pack([(i, i=1, size(m%links))], shows)
      s%shows_angle = shows_angle(s%links)
      s%reaches = reach(s%links)
      s%slides = pack([(i, i=1, size(m%pairs))], shows_pair .and. m%pairs%kind == pair_prismatic)
      shows_pair = shows_pair .and. m%pairs%kind /= pair_prismatic
      allocate (s%joints(2, count(shows_pair)))
      s%joints(1, :) = m%points(pack(m%pairs%point_i, shows_pair))%link
      s%joints(2, :) = m%points(pack(m%pairs%point_j, shows_pair))%link
   end subroutine find_shown

   !> The row of the ground that `request` asks for, which is the same at all instants.
   subroutine look_at_fixed(s, m, request)
      type(safe_digits_t), intent(inout) :: s
      type(mechanism_t), intent(in) :: m
      type(request_t), intent(in) :: request
      type(row_t) :: row
      real(wp) :: error(3)

      row = row_of(m, motion_t(), request)
      error = fixed_error(m, request)
      if (request%kind == request_pair) then
         s%fixed = max(s%fixed, abs(row%value(1, 0)))
         s%may_be = s%may_be .and. error(1) <= minval(s%hidden(:, 0))
      else
         s%fixed = max(s%fixed, [maxval(abs(row%value(:2, 0))), abs(row%value(3, 0))])
         s%may_be = s%may_be .and. all(error <= s%hidden([length, length, angle], 0))
      end if
   end subroutine look_at_fixed

   !> All digits of the tables of `m` are safe in its motion `q`, which `e` has found; `r%state` is there. `numbers`:
   !> see `find_growth`.
   logical function are_digits_safe(s, r, m, e, q, numbers) result(safe)
      type(safe_digits_t), intent(inout) :: s
      type(rounding_response_t), intent(inout) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: numbers(2, 0:2)
      real(wp) :: left(3, 0:2)
      integer :: i

      safe = .false.
      if (.not. (s%may_be .and. q%known == 2)) return
      call bound_roundings(s%bounds, r, e, q, safe)
      if (.not. safe) return
      ! What the sums of rows leave for the response.
      left = s%error([length, angle, length], :) - bounds_of_sums(s, q, numbers)/(caution*room)
      safe = are_links_safe(size(s%links), s%links, s%turned_by, s%reaches, s%shows_angle, s%bounds%place, s%bounds%u, &
         q%velocity, q%acceleration, left)
      if (safe) safe = are_joints_safe(size(s%joints, 2), s%joints, s%bounds%u, left(angle, :))
      if (.not. safe) return
      do i = 1, size(s%slides)
         safe = safe .and. all(bound_of_slide(s%bounds, m, e, q, s%slides(i)) <= left(slide, :))
      end do
   end function are_digits_safe

   !> So are those of `n` links and of their points, which are in `reach` of their origins: `list` and `turned_by` (n)
   !> are the numbers of the links and of their orientations, `place` and `u` the bounds of these, `v` and `a` the
   !> velocities and accelerations of all links; `left` (length, angle or slide; 0:2). On plain arrays, which cost no
   !> descriptors.
   pure logical function are_links_safe(n, list, turned_by, reach, shows_angle, place, u, v, a, left) result(safe)
      integer, intent(in) :: n, list(n), turned_by(n)
      real(wp), intent(in) :: reach(n), place(0:2, 0:*), u(0:2, 0:*), v(3, *), a(3, *), left(3, 0:2)
      logical, intent(in) :: shows_angle(n)
      real(wp) :: turns(0:2)
      integer :: i, k, f

      safe = .true.
      do i = 1, n
         k = list(i)
         f = turned_by(i)
         turns = bound_of_turning(v(3, k), a(3, k), u(:, f))
         safe = place(0, k) + reach(i)*turns(0) <= left(length, 0) .and. &
            place(1, k) + reach(i)*turns(1) <= left(length, 1) .and. &
            place(2, k) + reach(i)*turns(2) <= left(length, 2)
         if (shows_angle(i)) safe = safe .and. u(0, f) <= left(angle, 0) .and. u(1, f) <= left(angle, 1) &
            .and. u(2, f) <= left(angle, 2)
         if (.not. safe) return
      end do
   end function are_links_safe

   !> So are those of the angles between the `n` pairs of orientations `joints` (2, n), which change by `u`.
   pure logical function are_joints_safe(n, joints, u, left) result(safe)
      integer, intent(in) :: n, joints(2, n)
      real(wp), intent(in) :: u(0:2, 0:*), left(0:2)
      integer :: i, f, g

      safe = .true.
      do i = 1, n
         f = joints(1, i)
         g = joints(2, i)
         safe = safe .and. u(0, f) + u(0, g) <= left(0) .and. u(1, f) + u(1, g) <= left(1) &
            .and. u(2, f) + u(2, g) <= left(2)
      end do
   end function are_joints_safe

   !> Bounds (0:2) of what changes in the slide of pair number `i`: see `change_of_pair`.
   pure function bound_of_slide(b, m, e, q, i) result(bound)
      type(rounding_bounds_t), intent(in) :: b
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(motion_t), intent(in) :: q
      integer, intent(in) :: i
      real(wp) :: bound(0:2), p(2, 0:2), dp(0:2), dx(0:2)

      associate (pair => m%pairs(i), k => m%points(m%pairs(i)%point_i)%link)
         p = point_motion(m, q, pair%point_j) - point_motion(m, q, pair%point_i)
         dp = bound_of_point(pair%point_i) + bound_of_point(pair%point_j)
         dx = bound_of_turning(q%velocity(3, k), q%acceleration(3, k), b%u(:, e%orientation_of(k)))
         bound = bound_of_product([norm2(p(:, 0)), norm2(p(:, 1)), norm2(p(:, 2))], dp, &
            [1.0_wp, abs(q%velocity(3, k)), abs(q%acceleration(3, k)) + q%velocity(3, k)**2], dx)
      end associate

   contains

      !> The same of point number `n`.
      pure function bound_of_point(n) result(dp)
         integer, intent(in) :: n
         real(wp) :: dp(0:2)

         associate (link => m%points(n)%link)
            dp = b%place(:, link) + norm2(m%points(n)%offset)*bound_of_turning(q%velocity(3, link), &
               q%acceleration(3, link), b%u(:, e%orientation_of(link)))
         end associate
      end function bound_of_point
   end function bound_of_slide

   !> Bounds (length, angle or slide; 0:2) of `errors_of_sums` in the motion `q`, from its largest `numbers`.
   pure function bounds_of_sums(s, q, numbers) result(x)
      type(safe_digits_t), intent(in) :: s
      type(motion_t), intent(in) :: q
      real(wp), intent(in) :: numbers(2, 0:2)
      real(wp) :: x(3, 0:2), apart(0:2), w, a

      x(:2, :) = numbers
      x(slide, :) = 0.0_wp
      w = x(angle, 1)
      a = x(angle, 2) + w**2
      ! Of points beside their links.
      x(length, 0) = x(length, 0) + s%reach
      x(length, 1) = x(length, 1) + s%reach*w
      x(length, 2) = x(length, 2) + s%reach*a
      ! Two points are apart by no more than twice the root of two of that.
      apart = 3.0_wp*x(length, :)
      x(length, 0) = max(x(length, 0) + maxval(abs(q%origin)), s%fixed(length))
      x(angle, 0) = max(x(angle, 0), s%fixed(angle), 1.0_wp)
      if (size(s%joints) + size(s%slides) > 0) then
         x(length, 0) = max(x(length, 0), apart(0))
         x(length, 1) = max(x(length, 1), apart(1) + w*apart(0))
         x(length, 2) = max(x(length, 2), apart(2) + 2.0_wp*w*apart(1) + a*apart(0))
         x(angle, :) = 2.0_wp*x(angle, :)
      end if
      call round_sums(s%span, x)
   end function bounds_of_sums
end module safe_digits
