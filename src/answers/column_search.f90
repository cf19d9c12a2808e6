!> Searches for extremes of each column of each row between two nodes.
!>
!> Between two times a coordinate has an extreme at a zero of its velocity, a velocity at a zero of its acceleration,
!> and an acceleration at a zero of the derivative of the polynomial through five of its values. Each zero lies between
!> two times at which that derivative has opposite signs, and is found there by motions at times between the instants.
!>
!> A part between two nodes is halved until all accelerations are simple there: the cubic with their values and
!> derivatives at the ends gives the value in the middle, and has one extreme at most. If an acceleration has at most
!> one extreme in each of these parts, none is missed. If halving ends sooner, the interval is kept as open.
module column_search
   use kinds, only: wp
   use masked_numbers, only: nothing_known
   use points, only: row_t, known_at
   use instant_centres, only: points_coincide
   use set_analysis, only: set_analysis_t, rows_at, errors_unasked, errors_in_doubt
   use nodes, only: node_t, sample_t, joint_margin, extreme_t
   use zero_search, only: column_t, on_curve, find_zero, find_acceleration_extreme, differ_in_sign, noise_part
   use extremes, only: extremes_t, track_t, coordinate_t, add_interval, equal_part, offer, value_at_t, badly_known, &
      greatest, least, outward
   implicit none
   private
   public :: find_node, find_next, add_node, search_waiting

   !> The step of the stencil at a zero, in steps of TIME. If it is too long, `find_acceleration_extreme` shortens it.
   real(wp), parameter :: stencil_step = 1.0_wp/256.0_wp
   !> In short steps of TIME the stencil may be longer: until a link moves by this, in rad or lengths.
   real(wp), parameter :: stencil_motion = 5.0e-4_wp
   !> The longest step of the stencil, as a part of the interval.
   real(wp), parameter :: max_stencil_part = 1.0_wp/4.0_wp
   !> The sum of the sizes of the factors by which `find_jerk` takes rates and accelerations.
   real(wp), parameter :: errors_by_rates = 122.0_wp
   !> The cubic may miss the value in the middle by this part of the variation.
   real(wp), parameter :: misses_by = 1.0_wp/8.0_wp
   !> A monotonic cubic may be steeper at its ends than on average by this factor (Fritsch and Carlson, SIAM J. Numer.
   !> Anal. 17, 1980).
   real(wp), parameter :: steeper_by = 3.0_wp
   !> Smaller changes of an acceleration, in characteristic ones, are passed over: no table shows them.
   real(wp), parameter :: overlooked = sqrt(epsilon(1.0_wp))
   !> A shorter part is not halved, in steps of TIME;
   real(wp), parameter :: shortest_part = 2.0_wp**(-20)
   !> nor one that is shorter than this part of the time.
   real(wp), parameter :: shortest_time_part = 1024.0_wp*epsilon(1.0_wp)
   !> The largest number of halvings in a step (a pole of the motion needs 40).
   integer, parameter :: max_halvings = 120
   !> Two parts of time whose lengths differ by less than this part of them are equally long.
   real(wp), parameter :: equal_length_part = 1.0e-9_wp

contains

   !> Finds the node of a mechanism at the last instant or at a time between the instants. If the motion is not known
   !> there, node%is_known is false.
   subroutine find_node(set, track, t, effort, node)
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      type(track_t), intent(inout) :: track   !< of the mechanism; its rows and errors are overwritten
      real(wp), intent(in) :: t              !< time
      integer, intent(in) :: effort          !< whether errors are estimated: errors_in_doubt, ...
      type(node_t), intent(inout) :: node    !< gets the node
      real(wp) :: amplification
      integer :: i

      if (.not. allocated(node%samples)) allocate (node%samples(size(track%coordinates)))
      node%t = t
      node%is_known = .true.
      associate (rows => track%rows, error => track%error)
         call rows_at(set, track%requests, t, effort, rows, error, amplification)
         node%is_lost = any(rows%known < 0)
         do i = 1, size(track%coordinates)
            associate (sample => node%samples(i), k => track%coordinates(i)%column, row => track%coordinates(i)%row)
               sample%t = t
               sample%f = rows(row)%value(k, :)
               sample%known = rows(row)%known
               sample%meets = rows(row)%state == points_coincide
               sample%amplification = amplification
               sample%error = error(k, :, row)
               node%is_known = node%is_known .and. sample%known == 2
               ! If points of a measure coincide the node is known, and a length has its value.
               sample%known = known_at(rows(row))
               if (.not. sample%meets) node%is_known = node%is_known .and. all(sample%error < nothing_known)
            end associate
         end do
      end associate
   end subroutine find_node

   !> Finds the next node of a mechanism, and whether a number turns between the last three nodes. The node is put after
   !> those that are filled; `add_node` takes it.
   subroutine find_next(extremes, set, part, t, effort)
      type(extremes_t), intent(inout) :: extremes   !< gets the node and `turns`
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      integer, intent(in) :: part            !< number of the mechanism
      real(wp), intent(in) :: t              !< time of the node
      integer, intent(in) :: effort          !< whether errors are estimated: errors_in_doubt, ...

      associate (track => extremes%tracks(part))
         call find_node(set, track, t, effort, track%nodes(track%filled + 1))
         if (track%filled == 2) call check_for_extreme(track)
      end associate
   end subroutine find_next

   !> Finds whether a number may have an extreme between the first and the third node of a mechanism: a rate, an
   !> acceleration or a jerk changes its sign there or since its last clear sign, or an acceleration is not simple.
   subroutine check_for_extreme(track)
      type(track_t), intent(inout) :: track   !< with three nodes; gets `turns`
      real(wp) :: jerk(2), noise(3), f(3), low, high
      integer :: i, k
      logical :: pair, simple, meets(3)

      associate (a => track%nodes(1), middle => track%nodes(2), b => track%nodes(3))
         pair = is_pair(track, a, middle, b)
         track%turns = .not. (b%is_known .and. pair)
         if (.not. b%is_known) return
         do i = 1, size(track%coordinates)
            associate (one => track%coordinates(i))
               meets = [a%samples(i)%meets, middle%samples(i)%meets, b%samples(i)%meets]
               ! If points of a measure coincide at all nodes there is nothing to find.
               track%turns = track%turns .or. (any(meets) .and. .not. all(meets))
               if (any(meets)) cycle
               call find_jerk(a%samples(i), middle%samples(i), b%samples(i), one%size_of, jerk, noise, simple)
               track%turns = track%turns .or. .not. simple
               do k = 1, 2
                  f = [a%samples(i)%f(k), middle%samples(i)%f(k), b%samples(i)%f(k)]
                  low = min(f(1), f(2), f(3))
                  high = max(f(1), f(2), f(3))
                  ! Mostly all have the sign of the last one.
                  if (min(low, one%last(k)) > noise(k) .or. max(high, one%last(k)) < -noise(k)) cycle
                  call compare(f, noise(k), one%last(k))
               end do
               ! If accelerations are about equal, a small jerk is rounding.
               if (high - low > 2.0_wp*max(equal_part*one%size_of(2), noise(2))) noise(3) = 0.0_wp
               if (pair) call compare(jerk, noise(3), one%last(3))
            end associate
         end do
      end associate

   contains

      !> Compares values with the last one that has a clear sign. If a sign changes, the number turns.
      subroutine compare(values, noise, last)
         real(wp), intent(in) :: values(:)   !< (any number) along the run, in the deck's unit or rad
         real(wp), intent(in) :: noise       !< values up to it have no clear sign
         real(wp), intent(inout) :: last     !< the last value with a clear sign, and now the last of `values`
         integer :: n

         do n = 1, size(values)
            if (abs(values(n)) <= noise) cycle
            track%turns = track%turns .or. differ_in_sign(last, values(n))
            last = values(n)
         end do
      end subroutine compare
   end subroutine check_for_extreme

   !> Tells whether the parts between three nodes are equally long, and are searched together.
   pure logical function is_pair(track, before, middle, after)
      type(track_t), intent(in) :: track     !< of the mechanism
      type(node_t), intent(in) :: before, middle, after   !< in the run's order

      associate (length => abs(after%t - before%t))
         is_pair = length <= track%longest .and. abs(after%t - 2.0_wp*middle%t + before%t) <= equal_length_part*length
      end associate
   end function is_pair

   !> Takes the next node of a mechanism, which `find_next` has found, and searches between it and the last one of which
   !> all is known. Two parts of one length are searched together: the node between them is in the middle, and no other
   !> motion is needed. Parts in which nothing turns are not searched.
   subroutine add_node(extremes, set, part)
      type(extremes_t), intent(inout) :: extremes   !< gets the extremes
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      integer, intent(in) :: part            !< number of the mechanism
      integer :: n

      associate (track => extremes%tracks(part), nodes => extremes%tracks(part)%nodes)
         n = track%filled + 1
         if (.not. nodes(n)%is_known) then
            call search_waiting(extremes, set, part)
            call record_node(extremes, part, nodes(n), .true.)
            ! Nothing is searched across it.
            track%filled = 0
            return
         end if
         track%filled = n
         if (n == 1) call record_node(extremes, part, nodes(1), .true.)
         if (n < 3) return

         if (track%turns) then
            call record_node(extremes, part, nodes(1), .true.)
            if (is_pair(track, nodes(1), nodes(2), nodes(3))) then
               call search_part(extremes, set, part, nodes(1), nodes(2), nodes(3))
            else
               call search_part(extremes, set, part, nodes(1), node_t(), nodes(2))
               call record_node(extremes, part, nodes(2), .true.)
               call search_part(extremes, set, part, nodes(2), node_t(), nodes(3))
            end if
            call record_node(extremes, part, nodes(3), .true.)
         end if

         ! Without an allocation, since this is done at every instant.
         nodes(1)%t = nodes(3)%t
         nodes(1)%is_known = nodes(3)%is_known
         nodes(1)%samples(:) = nodes(3)%samples
         track%filled = 1
      end associate
   end subroutine add_node

   !> Searches between the last two nodes of a mechanism, if there are two. Call it when the last node ends a piece.
   subroutine search_waiting(extremes, set, part)
      type(extremes_t), intent(inout) :: extremes   !< gets the extremes
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      integer, intent(in) :: part            !< number of the mechanism

      associate (track => extremes%tracks(part), nodes => extremes%tracks(part)%nodes)
         if (track%filled == 0) return
         call record_node(extremes, part, nodes(1), .true.)
         if (track%filled == 1) return
         call search_part(extremes, set, part, nodes(1), node_t(), nodes(2))
         call record_node(extremes, part, nodes(2), .true.)
         nodes(1) = nodes(2)
         track%filled = 1
      end associate
   end subroutine search_waiting

   !> Finds the third derivatives at both ends of a part: those of the polynomial of degree 8 with the values, rates and
   !> accelerations of three samples (Hermite).
   pure subroutine find_jerk(before, middle, after, size_of, jerk, noise, simple)
      type(sample_t), intent(in) :: before, middle, after   !< at the ends and in the middle of the part
      real(wp), intent(in) :: size_of(0:2)   !< characteristic value, rate and acceleration
      real(wp), intent(out) :: jerk(2)       !< at both ends, in the deck's units or rad
      real(wp), intent(out) :: noise(3)      !< bounds of the rounding errors of rate, acceleration and jerk
      !> The cubic with the accelerations and jerks at the ends has about the acceleration in the middle.
      logical, intent(out) :: simple         !< and at most one extreme inside
      real(wp), dimension(0:2) :: errors, odd, even
      real(wp) :: seventh, eighth, mean, change, open, h, most, step

      h = after%t - before%t
      errors = error_bounds(before, middle, after, size_of)
      noise(:2) = errors(1:)
      noise(3) = errors_by_rates*(noise(1)/abs(h) + noise(2))/abs(h)
      call find_differences(before, middle, after, errors(0), odd, even, seventh, eighth)

      ! The mean of both jerks and half their change, in accelerations; less than `open` counts for nothing.
      mean = (40.0_wp*odd(2) - 64.0_wp*odd(1) + 448.0_wp*seventh)/(h*h)
      change = (56.0_wp*even(2) - 120.0_wp*even(1) + 512.0_wp*eighth)/(h*h)
      jerk = [mean - change, mean + change]/h
      open = overlooked*size_of(2) + noise(3)*abs(h)
      step = after%f(2) - before%f(2)
      simple = abs(middle%f(2) - 0.5_wp*(before%f(2) + after%f(2)) + 0.25_wp*change) <= misses_by &
         *(max(before%f(2), middle%f(2), after%f(2)) - min(before%f(2), middle%f(2), after%f(2))) + open
      most = abs(mean) + abs(change)
      if (abs(change) > abs(mean) .or. most <= open) return
      simple = simple .and. mean*sign(1.0_wp, step) > 0.0_wp .and. most <= steeper_by*abs(step) + open
   end subroutine find_jerk

   !> Finds the coefficients (0:8) of the polynomial with the numbers of three samples, in the time from the middle over
   !> half of the part. Its jerk has an error of 2E-6 of the ninth derivative times the sixth power of the part. If
   !> rounding explains the difference from the polynomial of rates and accelerations, the error is 7E-4 of the seventh
   !> derivative times the fourth power.
   pure function curve_through(before, middle, after, size_of) result(curve)
      type(sample_t), intent(in) :: before, middle, after   !< at the ends and in the middle of the part
      real(wp), intent(in) :: size_of(0:2)   !< characteristic value, rate and acceleration
      real(wp) :: curve(0:8)
      real(wp), dimension(0:2) :: errors, odd, even
      real(wp) :: half

      half = 0.5_wp*(after%t - before%t)
      errors = error_bounds(before, middle, after, size_of)
      call find_differences(before, middle, after, errors(0), odd, even, curve(7), curve(8))
      curve(:2) = middle%f*[1.0_wp, half, 0.5_wp*half**2]
      curve(5) = (odd(2) - 2.0_wp*odd(1) - 28.0_wp*curve(7))/10.0_wp
      curve(3) = (odd(1) - 5.0_wp*curve(5) - 7.0_wp*curve(7))/3.0_wp
      curve(6) = (even(2) - 3.0_wp*even(1) - 32.0_wp*curve(8))/12.0_wp
      curve(4) = (even(1) - 6.0_wp*curve(6) - 8.0_wp*curve(8))/4.0_wp
   end function curve_through

   !> Bounds the errors (0:2) of values, rates and accelerations of three samples: by estimates, by the size of
   !> numbers, and by a rounding of the time.
   pure function error_bounds(before, middle, after, size_of) result(bounds)
      type(sample_t), intent(in) :: before, middle, after   !< at the ends and in the middle of a part
      real(wp), intent(in) :: size_of(0:2)   !< characteristic value, rate and acceleration
      real(wp) :: bounds(0:2), largest(0:2)

      largest = max(abs(before%f), abs(middle%f), abs(after%f))
      bounds = max(noise_part, epsilon(1.0_wp)*max(before%amplification, middle%amplification, &
         after%amplification))*max(size_of, largest)
      bounds(:1) = bounds(:1) + epsilon(1.0_wp)*max(abs(before%t), abs(after%t))*largest(1:)
      bounds = max(before%error, middle%error, after%error, bounds)
   end function error_bounds

   !> Finds how the numbers at the ends of a part differ from the square at its middle, and the coefficients of degree 7
   !> and 8. Half of the part is the unit of time. A coefficient that rounding explains is 0.
   pure subroutine find_differences(before, middle, after, open, odd, even, seventh, eighth)
      type(sample_t), intent(in) :: before, middle, after   !< at the ends and in the middle of the part
      real(wp), intent(in) :: open           !< bound of the errors of values, in their unit
      real(wp), intent(out) :: odd(0:2), even(0:2)   !< the odd and the even part, in the unit of the value
      real(wp), intent(out) :: seventh, eighth   !< coefficients of degree 7 and 8, in the unit of the value
      real(wp), dimension(0:2) :: first, half, last
      real(wp) :: h

      h = 0.5_wp*(after%t - before%t)
      first = [before%f(0), h*before%f(1), h*h*before%f(2)]
      half = [middle%f(0), h*middle%f(1), h*h*middle%f(2)]
      last = [after%f(0), h*after%f(1), h*h*after%f(2)]
      odd = [0.5_wp*(last(0) - first(0)) - half(1), 0.5_wp*(last(1) + first(1)) - half(1), 0.5_wp*(last(2) - first(2))]
      even = [0.5_wp*(last(0) + first(0)) - half(0) - 0.5_wp*half(2), 0.5_wp*(last(1) - first(1)) - half(2), &
         0.5_wp*(last(2) + first(2)) - half(2)]

      seventh = odd(2) - 7.0_wp*odd(1) + 15.0_wp*odd(0)
      if (abs(seventh) <= 15.0_wp*open) seventh = 0.0_wp
      seventh = seventh/8.0_wp
      eighth = even(2) - 9.0_wp*even(1) + 24.0_wp*even(0)
      if (abs(eighth) <= 48.0_wp*open) eighth = 0.0_wp
      eighth = eighth/8.0_wp
   end subroutine find_differences

   !> Offers the values of a node of a mechanism as extremes.
   subroutine record_node(extremes, part, node, next)
      type(extremes_t), intent(inout) :: extremes   !< gets the extremes
      integer, intent(in) :: part            !< number of the mechanism
      type(node_t), intent(in) :: node       !< offers those samples that are known
      logical, intent(in) :: next            !< the velocities of the node are the next ones along the run
      integer :: i, k

      do i = 1, size(node%samples)
         associate (one => extremes%tracks(part)%coordinates(i), sample => node%samples(i))
            do k = 0, sample%known
               call offer_sample(one, k, sample, .false., extremes%step)
            end do
            ! A length that is 0, since its points coincide, turns there.
            if (next .and. (sample%known == 2 .or. (sample%meets .and. sample%known == 0))) &
               call record_velocity(one, sample)
         end associate
      end do
   end subroutine record_node

   !> Searches between two nodes of a mechanism, in halves if accelerations are not simple. If halving ends sooner, the
   !> interval is open.
   recursive subroutine search_part(extremes, set, part, before, between, after)
      type(extremes_t), intent(inout) :: extremes   !< gets the extremes, and the intervals that are open
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      integer, intent(in) :: part            !< number of the mechanism
      type(node_t), intent(in) :: before, after   !< the two nodes, of which all is known
      type(node_t), intent(in) :: between    !< a node in the middle; without samples: there is none yet
      type(node_t) :: middle
      real(wp) :: shortest, jerk(2), noise(3, size(extremes%tracks(part)%coordinates))
      logical, dimension(size(extremes%tracks(part)%coordinates)) :: simple, has_kink
      logical :: is_last, meets(3)
      integer :: i

      has_kink = .false.
      associate (track => extremes%tracks(part), length => abs(after%t - before%t))
         shortest = max(shortest_part*extremes%step, shortest_time_part*max(abs(before%t), abs(after%t)))
         if (size(track%joints) > 0) shortest = max(shortest, 2.0_wp*joint_margin(extremes%run, before%t))
         if (length <= shortest) then
            ! Near a joint there is nothing to be missed but the joint itself.
            if (length > 0.5_wp*extremes%step) &
               call add_interval(extremes%open, extremes%way, before%t, after%t, shortest)
            if (allocated(between%samples)) call record_node(extremes, part, between, .true.)
            return
         end if

         if (allocated(between%samples)) then
            middle = between
         else
            call find_node(set, track, before%t + 0.5_wp*(after%t - before%t), errors_in_doubt, middle)
         end if
         if (.not. middle%is_known) then
            call add_interval(extremes%open, extremes%way, before%t, after%t, shortest)
            return
         end if
         do i = 1, size(simple)
            ! If points of a measure coincide at one of the three nodes, the measure is searched up to that node.
            meets = [before%samples(i)%meets, middle%samples(i)%meets, after%samples(i)%meets]
            simple(i) = all(meets)
            if (.not. any(meets)) call find_jerk(before%samples(i), middle%samples(i), after%samples(i), &
               track%coordinates(i)%size_of, jerk, noise(:, i), simple(i))
         end do

         is_last = track%halvings >= max_halvings .or. length <= 2.0_wp*shortest
         if (all(simple) .or. is_last) then
            do i = 1, size(simple)
               if (.not. simple(i) .and. length <= 2.0_wp*shortest) &
                  has_kink(i) = jumps(set, track%coordinates(i), before%samples(i), middle%samples(i), after%samples(i))
            end do
            if (.not. all(simple .or. has_kink)) &
               call add_interval(extremes%open, extremes%way, before%t, after%t, shortest)
            call record_node(extremes, part, middle, .false.)
            call search_columns(extremes, set, part, before, middle, after, noise(3, :), has_kink)
         else
            track%halvings = track%halvings + 1
            call search_part(extremes, set, part, before, node_t(), middle)
            call record_node(extremes, part, middle, .false.)
            call search_part(extremes, set, part, middle, node_t(), after)
         end if
      end associate
   end subroutine search_part

   !> Tells whether points of a measure coincide in a short part: the rate of a length jumps there, or a direction.
   !> Halving finds the time. The parts next to this one are searched.
   logical function jumps(set, one, before, middle, after)
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      type(coordinate_t), intent(in) :: one   !< of the measure
      type(sample_t), intent(in) :: before, middle, after   !< at the ends and in the middle of the part
      type(row_t) :: row(1)
      real(wp) :: t, ends(2), error(3, 0:2, 1), amplification
      integer :: k

      jumps = before%meets .or. middle%meets .or. after%meets
      if (jumps) return
      k = merge(0, 1, one%is_angle)
      ends = [before%t, after%t]
      do
         t = ends(1) + 0.5_wp*(ends(2) - ends(1))
         call rows_at(set, [one%request], t, errors_unasked, row, error, amplification)
         if (row(1)%known < 2) return
         jumps = row(1)%weight <= equal_part
         if (jumps .or. abs(ends(2) - ends(1)) <= 4.0_wp*spacing(maxval(abs(ends)))) return
         associate (f => row(1)%value(one%column, k))
            ends(merge(1, 2, abs(f - before%f(k)) < abs(f - after%f(k)))) = t
         end associate
      end do
   end function jumps

   !> Searches for extremes of all columns of a mechanism between two nodes.
   subroutine search_columns(extremes, set, part, before, middle, after, noise, has_kink)
      type(extremes_t), intent(inout) :: extremes   !< gets the extremes
      type(set_analysis_t), intent(inout) :: set   !< at its last instant
      integer, intent(in) :: part            !< number of the mechanism
      type(node_t), intent(in) :: before, middle, after   !< the two nodes, and one between
      real(wp), intent(in) :: noise(:)       !< (coordinates) bounds of the rounding errors of third derivatives
      logical, intent(in) :: has_kink(:)     !< (coordinates) only a length is searched, which turns where it is 0
      type(sample_t), allocatable :: path(:), old_path(:)
      type(sample_t) :: found
      type(column_t) :: column
      real(wp) :: smooth(2), jerk(2)
      integer :: i, k, n, order, last

      ! The motion is smooth from the last joint before to the next one, or to the ends of the run so far.
      associate (joints => extremes%tracks(part)%joints, margin => extremes%way*joint_margin(extremes%run, before%t))
         smooth = [set%now%t0, set%now%motions(part)%t]
         n = count((joints - before%t)*extremes%way <= 0.0_wp)
         if (n > 0) smooth(1) = joints(n) + margin
         n = count((joints - after%t)*extremes%way < 0.0_wp)
         if (n < size(joints)) smooth(2) = extremes%way*min(extremes%way*smooth(2), &
            extremes%way*(joints(n + 1) - margin))
      end associate

      do i = 1, size(extremes%tracks(part)%coordinates)
         if (any([before%samples(i)%meets, middle%samples(i)%meets, after%samples(i)%meets])) cycle
         if (has_kink(i) .and. extremes%tracks(part)%coordinates(i)%is_angle) cycle
         associate (one => extremes%tracks(part)%coordinates(i))
            path = [before%samples(i), middle%samples(i), after%samples(i)]
            column = column_t(one%request, one%column, min(max_stencil_part*abs(after%t - before%t), &
               max(stencil_step*extremes%step, stencil_motion*one%size_of(1)/one%size_of(2))), smooth, &
               middle=middle%t, half=0.5_wp*(after%t - before%t), &
               curve=curve_through(path(1), path(2), path(3), one%size_of))
            do k = 0, 2
               column%noise(k) = max(noise_part*one%size_of(k), maxval(path%error(k)))
               column%inside(:, k) = never_better(one, k)
            end do

            ! The acceleration may have one extreme. The velocity has at most one on either side of that; the coordinate
            ! has at most one on either side of each of these. If accelerations are about equal and rounding explains
            ! the change of their derivative, they have none.
            jerk = [on_curve(column, 3, before%t), on_curve(column, 3, after%t)]
            if (differ_in_sign(jerk(1), jerk(2)) .and. .not. has_kink(i) .and. (abs(jerk(2) - jerk(1)) > noise(i) &
               .or. maxval(path%f(2)) - minval(path%f(2)) &
               > 2.0_wp*max(equal_part*one%size_of(2), column%noise(2)))) then
               call find_acceleration_extreme(set, column, path(1), path(3), found)
               found%error = max(found%error, path(1)%error, path(3)%error)
               call accept_extreme(2)
            end if

            do order = merge(1, 2, has_kink(i)), 1, -1
               old_path = path
               last = 0
               do k = 1, size(old_path)
                  ! A derivative that is no more than rounding has no known sign.
                  if (abs(old_path(k)%f(order)) <= column%noise(order)) cycle
                  if (last > 0) then
                     if (differ_in_sign(old_path(last)%f(order), old_path(k)%f(order))) then
                        call find_zero(set, column, order, 0.0_wp, old_path(last), old_path(k), found)
                        call accept_extreme(order - 1)
                     end if
                  end if
                  last = k
               end do
            end do
            do k = 1, size(path)
               call record_velocity(one, path(k))
            end do
         end associate
      end do

   contains

      !> Offers the extreme that was found, and puts it in its place on the path.
      subroutine accept_extreme(k)
         integer, intent(in) :: k            !< which derivative of the coordinate, 0 to 2
         integer :: n

         if (found%known < 2) return
         call offer_sample(extremes%tracks(part)%coordinates(i), k, found, .true., extremes%step)
         n = count((path%t - found%t)*(after%t - before%t) < 0.0_wp)
         path = [path(:n), found, path(n + 1:)]
      end subroutine accept_extreme
   end subroutine search_columns

   !> Offers a number of a sample as an extreme of a coordinate. The place is kept if dwells of the coordinate are asked
   !> for.
   pure subroutine offer_sample(coordinate, k, sample, at_zero, step)
      type(coordinate_t), intent(inout) :: coordinate   !< gets the extreme
      integer, intent(in) :: k               !< which derivative of the coordinate, 0 to 2
      type(sample_t), intent(in) :: sample   !< of the coordinate, known up to the derivative
      logical, intent(in) :: at_zero         !< the sample is at a zero of the next derivative
      real(wp), intent(in) :: step           !< of TIME

      call offer(coordinate, k, extreme_t(.true., .true., at_zero, sample%t, sample%f(k), sample%t_error, &
         sample%error(k)), step)
      if (k == 0 .and. coordinate%dwell > 0.0_wp) &
         coordinate%places = [coordinate%places, value_at_t(sample%t, sample%f(0))]
   end subroutine offer_sample

   !> Finds the values (2) between which a number of a coordinate is no new extreme for `offer`. If every value may be
   !> one, or dwells need its place, the first is above the second.
   pure function never_better(coordinate, k) result(inside)
      type(coordinate_t), intent(in) :: coordinate   !< with the extremes so far
      integer, intent(in) :: k               !< which derivative of the coordinate, 0 to 2
      real(wp) :: inside(least:greatest)

      associate (e => coordinate%found(:, k))
         inside = e%value + outward*merge(equal_part*coordinate%size_of(k) + e%error, &
            -badly_known*coordinate%size_of(k), e%is_located)
         if ((k == 0 .and. coordinate%dwell > 0.0_wp) .or. .not. all(e%exists .and. e%has_bound &
            .and. e%error <= badly_known*coordinate%size_of(k))) inside = -huge(inside)*outward
      end associate
   end function never_better

   !> Takes the velocity of a coordinate at the next place along the run. If its sign has changed, the coordinate has
   !> reversed at its slowest place between.
   pure subroutine record_velocity(coordinate, sample)
      type(coordinate_t), intent(inout) :: coordinate   !< gets the velocity
      type(sample_t), intent(in) :: sample   !< at that place
      real(wp) :: speed
      integer :: this

      speed = abs(sample%f(1))
      if (speed <= noise_part*coordinate%size_of(1)) speed = 0.0_wp
      if (speed < coordinate%speed) then
         coordinate%slowest = value_at_t(sample%t, sample%f(0))
         coordinate%speed = speed
      end if
      if (speed <= 0.0_wp) return

      this = merge(1, -1, sample%f(1) > 0.0_wp)
      if (coordinate%first_sign == 0) then
         coordinate%first_sign = this
         coordinate%start = coordinate%slowest
      end if
      if (coordinate%last_sign == -this) coordinate%reversals = [coordinate%reversals, coordinate%slowest]
      coordinate%last_sign = this
      coordinate%slowest = value_at_t(sample%t, sample%f(0))
      coordinate%speed = speed
   end subroutine record_velocity
end module column_search
