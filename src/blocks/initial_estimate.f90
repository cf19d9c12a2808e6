!> The initial estimate of the angles: those of the deck, or better ones that follow from the positions of its links. A
!> deck may give x and y of its links with care and no angles, or wrong ones: then the pairs show how the links lie.
!>
!> With fixed x and y of the links, the sum of the squared closure errors of the pairs is, as a function of the angle u
!> of one orientation class, but for a constant, the form
!>    c cos u + s sin u + p cos 2u + q sin 2u
!> Five values give its coefficients. It is minimized over one class after another, until no angle changes. A pair
!> counts only if the position of its point on the other link is known: that link's origin, or a point of a link whose
!> angle is known already. Two links that meet far from both origins keep the angles of the deck: they may lie on either
!> side.
module initial_estimate
   use kinds, only: wp
   use disjoint_sets, only: sorted_t, sorted, members
   use plane_vectors, only: direction, pi, wrap_angle
   use bilinear, only: kept_start_t
   use pair_geometry, only: way_of, closure_error_of, slide_of
   use mechanism, only: mechanism_t, has_guide
   use spanning_tree, only: spanning_tree_t, axes_t
   use blocks, only: blocks_t, geometry_t
   implicit none
   private
   public :: guess_t, first_choice_t, assign_guess

   !> Angles from positions are taken only if their closure errors are below this part of the characteristic length.
   real(wp), parameter :: closed_part = 0.1_wp
   !> Their closure error must be below this part of the closure error of the deck's angles. Local minima of the form
   !> within the square of this part of its coefficients above the least are equally good.
   real(wp), parameter :: better_part = 0.2_wp
   !> rad: an angle must differ by more than this: smaller errors of a deck do not lead to another assembly.
   real(wp), parameter :: differing_angle = 1.0_wp
   !> A link whose angle is so wrong has a closure error of about its size: of this part of the size at least.
   real(wp), parameter :: open_part = 0.25_wp
   !> A deck with closure errors below this part of the characteristic length needs no other angles. The search ends if
   !> no angle changes by more than this, in rad.
   real(wp), parameter :: good_part = 1.0e-3_wp
   !> A form with coefficients below this part of the squared characteristic length gives no angle: it is rounding of
   !> the deck's digits.
   real(wp), parameter :: min_form_part = 1.0e-6_wp
   !> A point nearer to the origin of its link than this part of the characteristic length is where the origin is,
   !> whatever the angle.
   real(wp), parameter :: short_offset_part = 1.0e-3_wp
   !> Values of the form that differ by less than this part of its coefficients are equal: rounding shall not choose.
   real(wp), parameter :: equal_form_part = 1.0e-9_wp
   !> Sweeps over all classes at most; steps of a turn (10 degrees) in which the minima of the form are sought.
   integer, parameter :: max_sweeps = 20, samples = 36

   !> How the position of a block at the first instant was chosen.
   type :: first_choice_t
      logical :: is_close = .false.              !< another position is about as near to the guess
      logical :: is_incomplete = .false.         !< a nearer position may not have been found
   end type first_choice_t

   !> The initial guess, near which the first position is searched for.
   type :: guess_t
      real(wp), allocatable :: values(:)         !< (0:unknowns) from the deck's positions, rad or unit of the loop
      real(wp), allocatable :: links(:, :)       !< (3, links) x, y from the chain's origin, phi (rad), all of the deck
      type(first_choice_t), allocatable :: choice(:)   !< (blocks)
      type(kept_start_t), allocatable :: starts(:)   !< (blocks) the systems with which paths to all positions begin
   end type guess_t

contains

   !> Makes the initial guess of a mechanism from the positions on its cards.
   subroutine assign_guess(m, b, x, guess)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b        !< of `m`
      type(geometry_t), intent(in) :: x      !< of `m`, with its chain
      type(guess_t), intent(inout) :: guess  !< empty, or of a mechanism of equal structure: its starts stay
      integer :: i

      if (.not. allocated(guess%values)) allocate (guess%values(0:b%unknowns), guess%links(3, size(m%links)), &
         guess%choice(size(b%list)), guess%starts(size(b%list)))
      guess%choice = first_choice_t()
      do i = 1, size(m%links)
         guess%links(:, i) = m%links(i)%position - [x%chain%origin, 0.0_wp]
      end do
      ! Assigned to a section, which keeps the lower bound 0.
      guess%values(:) = estimated_values(m, b, x)
   end subroutine assign_guess

   !> Estimates the values (0:unknowns) of angles, slides, and x and y of roots, in rad and the units of their loops.
   function estimated_values(m, b, x) result(value)
      type(mechanism_t), intent(in) :: m
      type(blocks_t), intent(in) :: b
      type(geometry_t), intent(in) :: x
      real(wp) :: value(0:b%unknowns)
      real(wp) :: phi(size(m%links))
      integer :: i, u

      value = 0.0_wp
      associate (t => b%tree, a => x%equations%axes, length => x%equations%length)
         phi = estimated_directions(m, t, a, x%span)
         do i = size(m%links), 1, -1
            if (t%orientation(i) > 0) value(t%orientation(i)) = phi(i) - a%angle_offset(i)
            if (t%root(i) == 0 .or. t%parent(i) > 0) cycle
            u = t%orientations + t%slides + 2*t%root(i) - 1
            value(u:u + 1) = (m%links(i)%position(:2) - a%origin)/length
         end do
         do i = 1, size(m%pairs)
            associate (pair => m%pairs(i))
               if (t%slide(i) > 0) value(t%orientations + t%slide(i)) = slide_of(m, pair, &
                  turned(m, m%points(pair%point_i)%link, phi), turned(m, m%points(pair%point_j)%link, phi))/length
            end associate
         end do
      end associate
      value = value/x%unit
   end function estimated_values

   !> Gives the position (3) of a link: x and y of the deck (deck's unit), and its angle of a list (rad).
   pure function turned(m, i, phi) result(position)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i               !< the number of the link
      real(wp), intent(in) :: phi(:)         !< (links) rad
      real(wp) :: position(3)

      position = [m%links(i)%position(:2), phi(i)]
   end function turned

   !> Gives the size of the closure error of a pair with x and y of the deck and given angles, in the deck's unit.
   pure real(wp) function closure_distance(m, k, phi) result(closure_error)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: k               !< the number of the pair
      real(wp), intent(in) :: phi(:)         !< (links) rad

      associate (pair => m%pairs(k))
         closure_error = abs(closure_error_of(m, pair, turned(m, m%points(pair%point_i)%link, phi), &
            turned(m, m%points(pair%point_j)%link, phi)))
      end associate
   end function closure_distance

   !> Estimates the angles (links) in rad: those of the deck or, if these contradict x and y of the links, better ones.
   function estimated_directions(m, tree, axes, span) result(phi)
      type(mechanism_t), intent(in) :: m
      type(spanning_tree_t), intent(in) :: tree   !< of `m`
      type(axes_t), intent(in) :: axes       !< of `m`
      real(wp), intent(in) :: span           !< characteristic length, in the deck's unit
      real(wp), dimension(size(m%links)) :: phi, u, v, w
      real(wp) :: before, after
      logical :: has_position(size(m%points))      ! points with known positions
      logical :: is_far(size(m%links))       ! links whose angles change by more than `differing_angle`
      type(sorted_t) :: classes
      integer, allocatable :: list(:)
      integer :: i, sweep

      ! Links of one class have one angle, by the first link of the class.
      phi = m%links%position(3)
      classes = sorted(tree%orientation, tree%orientations)
      u = phi
      do i = 1, tree%orientations
         list = members(classes, i)
         u(list) = axes%angle_offset(list) + (phi(list(1)) - axes%angle_offset(list(1)))
      end do
      has_position = .true.
      if (largest_closure_error(u) <= good_part*span) return
      has_position = m%links(m%points%link)%ground .or. &
         hypot(m%points%offset(1), m%points%offset(2)) <= short_offset_part*span

      v = u
      do sweep = 1, max_sweeps
         w = v
         call minimize_closure_errors()
         if (maxval(abs(wrap_angle(v - w))) <= good_part) exit
      end do
      v = u + wrap_angle(v - u)
      is_far = abs(v - u) > differing_angle
      if (.not. any(is_far)) return

      ! Small changes of the other angles make some closure errors small and others large: only a pair with a closure
      ! error both before and after these changes contradicts an angle.
      w = merge(u, v, is_far)
      before = min(largest_closure_error(u), largest_closure_error(w))
      after = largest_closure_error(v)
      if (after > min(closed_part*span, better_part*before)) return
      if (is_contradicted(u) .and. is_contradicted(w)) phi = phi + (v - u)

   contains

      !> Gives each class in `v` the angle of the least closure errors; then the positions of its points are known, too.
      !> A class whose form is small at all angles keeps its angle of `w`.
      subroutine minimize_closure_errors()
         real(wp) :: e(4), angle, sum_of
         integer :: i, j, k, class, pair, points(2)

         do class = 1, tree%orientations
            list = members(classes, class)
            e = 0.0_wp
            do j = 0, 4
               angle = 0.4_wp*pi*real(j, wp)
               v(list) = axes%angle_offset(list) + angle
               sum_of = 0.0_wp
               do i = 1, size(list)
                  do k = tree%near%first(list(i)), tree%near%first(list(i) + 1) - 1
                     pair = tree%near%member(k)
                     points = [m%pairs(pair)%point_i, m%pairs(pair)%point_j]
                     if (all(has_position(points) .or. tree%orientation(m%points(points)%link) == class)) &
                        sum_of = sum_of + closure_distance(m, pair, v)**2
                  end do
               end do
               e = e + 0.4_wp*sum_of*[direction(angle), direction(2.0_wp*angle)]
            end do

            angle = w(list(1)) - axes%angle_offset(list(1))
            if (maxval(abs(e)) > min_form_part*span**2) then
               angle = minimizing_angle(e, angle)
               where (tree%orientation(m%points%link) == class) has_position = .true.
            end if
            v(list) = axes%angle_offset(list) + angle
         end do
      end subroutine minimize_closure_errors

      !> Tells whether closure errors contradict the angle of a link in `is_far`: a pair of the link with known
      !> positions on both sides has a closure error above `open_part` of the link's size. The size is the longest
      !> vector to such a pair: the closure error of a pair near the link's origin does not depend on its angle.
      pure logical function is_contradicted(angles) result(is)
         real(wp), intent(in) :: angles(:)   !< (links) rad
         real(wp) :: size_of, closure_error, distance
         integer :: link, k

         is = .false.
         do link = 1, size(m%links)
            if (.not. is_far(link)) cycle
            size_of = 0.0_wp
            closure_error = 0.0_wp
            do k = tree%near%first(link), tree%near%first(link + 1) - 1
               associate (pair => tree%near%member(k), i => m%pairs(tree%near%member(k))%point_i, &
                          j => m%pairs(tree%near%member(k))%point_j)
                  if (.not. (has_position(i) .and. has_position(j))) cycle
                  distance = norm2(m%points(merge(i, j, m%points(i)%link == link))%offset)
                  if (has_guide(m%pairs(pair)%kind)) distance = distance + norm2(way_of(m, m%pairs(pair), &
                     turned(m, m%points(i)%link, angles), turned(m, m%points(j)%link, angles)))
                  size_of = max(size_of, distance)
                  closure_error = max(closure_error, closure_distance(m, pair, angles))
               end associate
            end do
            is = is .or. closure_error > open_part*size_of
         end do
      end function is_contradicted

      !> Gives the largest closure error of the pairs with known positions on both sides, in the deck's unit; 0 without
      !> such a pair.
      pure real(wp) function largest_closure_error(angles) result(largest)
         real(wp), intent(in) :: angles(:)   !< (links) rad
         integer :: k

         largest = 0.0_wp
         do k = 1, size(m%pairs)
            if (has_position(m%pairs(k)%point_i) .and. has_position(m%pairs(k)%point_j)) &
               largest = max(largest, closure_distance(m, k, angles))
         end do
      end function largest_closure_error
   end function estimated_directions

   !> Finds the angle, in rad, at which the form is least. Of minima that are about equally low, as the two sides of a
   !> guide, the nearest to `start` counts.
   pure real(wp) function minimizing_angle(coefficients, start) result(u)
      real(wp), intent(in) :: coefficients(4)   !< c, s, p, q of the module's head, squared lengths
      real(wp), intent(in) :: start             !< rad: the angle from which the search begins
      real(wp), parameter :: step = 2.0_wp*pi/real(samples, wp)   !< rad: between the angles at which minima are sought
      real(wp) :: lowest, slope, lipschitz
      integer :: i

      if (maxval(abs(coefficients(3:))) <= equal_form_part*sum(abs(coefficients))) then
         u = atan2(-coefficients(2), -coefficients(1))
         return
      end if
      lowest = minval([(form(coefficients, start + step*real(i, wp)), i=1, samples)])
      do i = 1, samples + 1
         u = start + merge(step, -step, modulo(i, 2) == 0)*real(i/2, wp)
         if (form(coefficients, u) > lowest + better_part**2*sum(abs(coefficients))) cycle
         ! Rounding shall not choose.
         if (form(coefficients, u) <= min(form(coefficients, u - step), form(coefficients, u + step)) &
            + equal_form_part*sum(abs(coefficients))) exit
      end do
      do i = 1, 3
         slope = form([coefficients(2), -coefficients(1), 2.0_wp*coefficients(4), -2.0_wp*coefficients(3)], u)
         lipschitz = -form([coefficients(1), coefficients(2), 4.0_wp*coefficients(3), 4.0_wp*coefficients(4)], u)
         if (lipschitz > abs(slope)) u = u - slope/lipschitz
      end do
   end function minimizing_angle

   !> Evaluates the form of the module's head at an angle.
   pure real(wp) function form(coefficients, angle)
      real(wp), intent(in) :: coefficients(4)   !< c, s, p, q of the module's head, in any unit
      real(wp), intent(in) :: angle             !< rad

      form = dot_product(coefficients, [direction(angle), direction(2.0_wp*angle)])
   end function form
end module initial_estimate
