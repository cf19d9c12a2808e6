!> The initial estimate of the angles: those of the deck, or better ones that follow from its places. A deck may give
!> x and y of its links with care and no angles, or wrong ones: then the places of the pairs show how the links lie.
!>
!> For fixed places the sum of the squared closure errors of the pairs is, as a function of the angle u of one
!> orientation class, but for a constant,
!>    c cos u + s sin u + p cos 2u + q sin 2u
!> Five values give it. It is minimized over one class after another, until no angle changes. Only those pairs count
!> whose point on the other link has a known place: its origin, or a point of a link whose angle is known already.
!> Two links that meet far from both origins keep the angles of the deck: they may lie on either side.
module initial_estimate
   use kinds, only: wp
   use grouping, only: sorted_t, sorted
   use planar, only: direction, quarter_turn, point_of, pi, without_turns
   use mechanism, only: mechanism_t, pair_revolute
   use links_tree, only: tree_t, axes_t
   implicit none
   private
   public :: estimated_values, estimated_directions

   !> Angles from the places are taken where their largest closure error is below `closed_part` of the characteristic
   !> length and below `better_part` of that of the deck's angles, and where an angle differs by more than `far_angle`
   !> (rad). A link that lies so differently is open at its pairs by about its size: by `open_part` of that at least.
   real(wp), parameter :: closed_part = 0.1_wp, better_part = 0.2_wp, far_angle = 1.0_wp, open_part = 0.25_wp
   !> A deck with closure errors below this part of the length needs no other angles.
   real(wp), parameter :: good_part = 1.0e-3_wp
   !> Body vectors this short, squared, give no direction.
   real(wp), parameter :: min_form_part = 1.0e-6_wp
   !> A point so near to the origin of its link has its place.
   real(wp), parameter :: short_part = 1.0e-3_wp
   !> Values of the form that differ by less than this part of its coefficients are alike.
   real(wp), parameter :: alike = 1.0e-9_wp
   integer, parameter :: max_sweeps = 20, samples = 36

contains

   !> Values (0:unknowns) of angles and slides, lengths in units of `length`. `span`: the characteristic length of `m`
   !> for its equations.
   function estimated_values(m, t, a, length, unknowns, span) result(value)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(axes_t), intent(in) :: a
      real(wp), intent(in) :: length
      integer, intent(in) :: unknowns
      real(wp), intent(in) :: span
      real(wp) :: value(0:unknowns)
      real(wp) :: phi(size(m%links)), angles(2)
      integer :: i, u

      value = 0.0_wp
      phi = estimated_directions(m, t, a, span)
      do i = size(m%links), 1, -1
         if (t%orientation(i) > 0) value(t%orientation(i)) = phi(i) - a%angle_offset(i)
         if (t%root(i) == 0 .or. t%parent(i) > 0) cycle
         u = t%orientations + t%slides + 2*t%root(i) - 1
         value(u:u + 1) = (m%links(i)%position(:2) - a%origin)/length
      end do
      do i = 1, size(m%pairs)
         if (t%slide(i) == 0) cycle
         angles = phi(m%points([m%pairs(i)%point_i, m%pairs(i)%point_j])%link)
         value(t%orientations + t%slide(i)) = dot_product(closure_error_of(m, i, angles), &
            direction(angles(1) + m%pairs(i)%alpha))/length
      end do
   end function estimated_values

   !> (2) From the first point of pair `k` to the other, their links at the deck's places and the `angles` (2).
   pure function closure_error_of(m, k, angles) result(closure_error)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k
      real(wp), intent(in) :: angles(2)
      real(wp) :: closure_error(2)

      associate (i => m%points(m%pairs(k)%point_i), j => m%points(m%pairs(k)%point_j))
         closure_error = point_of([m%links(j%link)%position(:2), angles(2)], j%offset) &
            - point_of([m%links(i%link)%position(:2), angles(1)], i%offset)
      end associate
   end function closure_error_of

   !> (links) The estimated angles: those of the deck, or better ones that follow from the places. `span`: as above.
   function estimated_directions(m, t, a, span) result(phi)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      type(axes_t), intent(in) :: a
      real(wp), intent(in) :: span
      real(wp) :: phi(size(m%links))
      real(wp), dimension(0:t%orientations) :: u, v, w
      real(wp) :: before, after
      logical, allocatable :: placed(:)         ! (points) their places are known
      type(sorted_t) :: classes
      integer :: i, sweep

      phi = m%links%position(3)
      u = 0.0_wp
      do i = size(m%links), 1, -1
         if (t%orientation(i) > 0) u(t%orientation(i)) = phi(i) - a%angle_offset(i)
      end do
      allocate (placed(size(m%points)))
      placed = m%links(m%points%link)%ground .or. hypot(m%points%offset(1), m%points%offset(2)) <= short_part*span
      if (largest_opening(u, spread(.true., 1, size(m%points))) <= good_part*span) return
      v = u
      classes = sorted(t%orientation, t%orientations)
      do sweep = 1, max_sweeps
         w = v
         call minimize_closure_errors(v)
         if (maxval(abs(without_turns(v - w))) <= good_part) exit
      end do
      v = u + without_turns(v - u)
      if (maxval(abs(v - u)) <= far_angle) return
      ! Of what is open, only what small changes of other angles do not close contradicts an angle; what they open does
      ! not.
      w = merge(u, v, abs(v - u) > far_angle)
      before = min(largest_opening(u, placed), largest_opening(w, placed))
      after = largest_opening(v, placed)
      if (after > min(closed_part*span, better_part*before)) return
      if (.not. (is_contradicted(u, abs(v - u) > far_angle) .and. is_contradicted(w, abs(v - u) > far_angle))) return
      do i = 1, size(m%links)
         if (t%orientation(i) > 0) phi(i) = phi(i) + (v(t%orientation(i)) - u(t%orientation(i)))
      end do

   contains

      !> Gives each of the orientation `classes` in `u` (0:classes) the angle of the least closure errors, unless the
      !> form is small at all angles. Then the places of its points are known as well.
      subroutine minimize_closure_errors(u)
         real(wp), intent(inout) :: u(0:)
         real(wp) :: e(4), before, angle, sum_of
         integer :: i, j, k, orientation

         do orientation = 1, t%orientations
            before = u(orientation)
            e = 0.0_wp
            do j = 0, 4
               angle = 0.4_wp*pi*real(j, wp)
               u(orientation) = angle
               sum_of = 0.0_wp
               do i = classes%first(orientation), classes%first(orientation + 1) - 1
                  associate (link => classes%member(i))
                     do k = t%near%first(link), t%near%first(link + 1) - 1
                        if (is_reported(t%near%member(k), orientation)) &
                           sum_of = sum_of + opening_of(u, t%near%member(k))**2
                     end do
                  end associate
               end do
               e = e + 0.4_wp*sum_of*[direction(angle), direction(2.0_wp*angle)]
            end do
            u(orientation) = before
            if (maxval(abs(e)) <= min_form_part*span**2) cycle
            u(orientation) = least(e, before)
            where (t%orientation(m%points%link) == orientation) placed = .true.
         end do
      end subroutine minimize_closure_errors

      !> The other side of pair `k` of `orientation`, if it is of another class, has its place.
      pure logical function is_reported(k, orientation)
         integer, intent(in) :: k, orientation

         associate (i => m%pairs(k)%point_i, j => m%pairs(k)%point_j)
            is_reported = (placed(i) .or. t%orientation(m%points(i)%link) == orientation) &
               .and. (placed(j) .or. t%orientation(m%points(j)%link) == orientation)
         end associate
      end function is_reported

      !> A link of the classes `changed` (0:classes) has a pair, both sides of which have their places, that is open by
      !> more than a part of that link's size, from the places of the deck and the angles `u`. Its size is the longest
      !> vector to such a pair: how far a pair beside its origin is open says nothing of its angle.
      pure logical function is_contradicted(u, changed) result(is)
         real(wp), intent(in) :: u(0:)
         logical, intent(in) :: changed(0:)
         real(wp) :: size_of, open, arm
         integer :: link, k

         is = .false.
         do link = 1, size(m%links)
            if (.not. changed(t%orientation(link))) cycle
            size_of = 0.0_wp
            open = 0.0_wp
            do k = t%near%first(link), t%near%first(link + 1) - 1
               associate (pair => t%near%member(k), i => m%pairs(t%near%member(k))%point_i, &
                          j => m%pairs(t%near%member(k))%point_j)
                  if (.not. (placed(i) .and. placed(j))) cycle
                  arm = norm2(m%points(merge(i, j, m%points(i)%link == link))%offset)
                  if (m%pairs(pair)%kind /= pair_revolute) &
                     arm = arm + norm2(closure_error_of(m, pair, angles_of(u, pair)))
                  size_of = max(size_of, arm)
                  open = max(open, opening_of(u, pair))
               end associate
            end do
            is = is .or. open > open_part*size_of
         end do
      end function is_contradicted

      !> The largest distance, from the places of the deck and the angles `u`, by which a pair is open of which both
      !> sides are `placed` (points).
      pure real(wp) function largest_opening(u, placed) result(largest)
         real(wp), intent(in) :: u(0:)
         logical, intent(in) :: placed(:)
         integer :: k

         largest = 0.0_wp
         do k = 1, size(m%pairs)
            if (placed(m%pairs(k)%point_i) .and. placed(m%pairs(k)%point_j)) largest = max(largest, opening_of(u, k))
         end do
      end function largest_opening

      !> The distance by which pair `k` is open.
      pure real(wp) function opening_of(u, k) result(opening)
         real(wp), intent(in) :: u(0:)
         integer, intent(in) :: k
         real(wp) :: angles(2), closure_error(2)

         angles = angles_of(u, k)
         closure_error = closure_error_of(m, k, angles)
         opening = norm2(closure_error)
         if (m%pairs(k)%kind /= pair_revolute) opening = abs(m%pairs(k)%offset &
            + dot_product(closure_error, quarter_turn(direction(angles(1) + m%pairs(k)%alpha))))
      end function opening_of

      !> (2) The angles of the links of pair `k`.
      pure function angles_of(u, k) result(angles)
         real(wp), intent(in) :: u(0:)
         integer, intent(in) :: k
         real(wp) :: angles(2)
         integer :: links(2)

         links = m%points([m%pairs(k)%point_i, m%pairs(k)%point_j])%link
         angles = a%angle_offset(links) + u(t%orientation(links))
      end function angles_of
   end function estimated_directions

   !> The angle at which the form `e` is least, `start` where it is about as small.
   pure real(wp) function least(e, start) result(u)
      real(wp), intent(in) :: e(4), start
      real(wp) :: v, slope, lipschitz
      integer :: i

      if (maxval(abs(e(3:))) <= alike*sum(abs(e))) then
         u = atan2(-e(2), -e(1))
         return
      end if
      u = start
      do i = 1, samples
         ! The nearer of two that are alike: rounding shall not choose.
         v = start + merge(pi, -pi, modulo(i, 2) == 0)*real((i + 1)/2, wp)/real(samples/2, wp)
         if (form(e, v) < form(e, u) - alike*sum(abs(e))) u = v
      end do
      do i = 1, 3
         slope = form([e(2), -e(1), 2.0_wp*e(4), -2.0_wp*e(3)], u)
         lipschitz = -form([e(1), e(2), 4.0_wp*e(3), 4.0_wp*e(4)], u)
         if (lipschitz > abs(slope)) u = u - slope/lipschitz
      end do
   end function least

   !> The trigonometric form with coefficients `e` at the angle `u`.
   pure real(wp) function form(e, u)
      real(wp), intent(in) :: e(4), u

      form = dot_product(e, [direction(u), direction(2.0_wp*u)])
   end function form
end module initial_estimate
