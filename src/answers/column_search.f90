!> Searches for extremes of each column of each row between two nodes.
!>
!> Between two times a coordinate has an extreme where its velocity is zero, a velocity where its acceleration is, and
!> an acceleration where the derivative of the polynomial through five of its values is. Each zero lies between two
!> times at which that derivative has opposite signs, and is found there by motions at times between the instants.
!>
!> A part between two nodes is halved until all accelerations are simple there: the cubic with their values and
!> derivatives at the ends gives the value in the middle, and has one extreme at most. So none is missed of an
!> acceleration that has at most one extreme in each of these parts; where halving ends sooner, that is noted.
module column_search
   use kinds, only: wp
   use digits_in_doubt, only: safe_growth
   use known_digits, only: nothing_known
   use points, only: find_row
   use set_analysis, only: set_analysis_t, rows_at
   use nodes, only: node_t, sample_t, sample_of, rows_asked_t, beside_joint
   use zero_search, only: column_t, find_zero, find_turn, look_at_column, differ_in_sign, noise_part
   use extremes, only: extremes_t, coordinate_t, offer_sample, note_velocity, note_interval, alike
   implicit none
   private
   public :: find_node, add_node, search_passed, search_waiting, jerk_at_first, misses_by, overlooked

   !> The step of the stencil at a zero, in steps of TIME; how much longer it may be in short steps, in rad or lengths;
   !> and the longest that it may be, as a part of the interval. Where it proves too long, `find_zero` shortens it.
   real(wp), parameter :: difference_part = 1.0_wp/256.0_wp, difference_angle = 1.0e-3_wp, max_part = 1.0_wp/8.0_wp
   !> The third derivative, at the first of three places a half apart, of the polynomial of degree 8 that has values,
   !> rates and accelerations at them (Hermite), in this order, and of that of degree 5 by rates and accelerations; the
   !> errors of the second, in those of a rate over the length or of an acceleration.
   real(wp), parameter :: by_all(3, 0:2) = reshape([-1188.0_wp, 1536.0_wp, -348.0_wp, -288.0_wp, -192.0_wp, 60.0_wp, &
      -27.0_wp, 48.0_wp, -3.0_wp], [3, 3]), &
      by_rates(3, 2) = reshape([-46.0_wp, 32.0_wp, 14.0_wp, -12.0_wp, -16.0_wp, -2.0_wp], [3, 2])
   real(wp), parameter :: errors_by_rates = sum(abs(by_rates))
   !> By how much the cubic may miss the value in the middle, as a part of the variation; and how much steeper a
   !> monotonic cubic may be at its ends than on average (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 1980).
   real(wp), parameter :: misses_by = 1.0_wp/8.0_wp, steeper_by = 3.0_wp
   !> Smaller features of an acceleration, in characteristic ones, are passed over: no table shows them.
   real(wp), parameter :: overlooked = sqrt(epsilon(1.0_wp))
   !> Shorter parts, in steps of TIME, are not halved, nor more than so many in one step: a pole of the motion takes 40.
   real(wp), parameter :: shortest_part = 2.0_wp**(-20)
   !> Nor is one that is shorter than this part of the time.
   real(wp), parameter :: time_part = 1024.0_wp*epsilon(1.0_wp)
   integer, parameter :: max_halvings = 120
   !> Lengths that differ by this part are one.
   real(wp), parameter :: alike_part = 1.0e-9_wp
   !> Part of an interval that no table shows.
   real(wp), parameter :: beside_end = 1.0e-6_wp

contains

   !> Finds the `node` of the coordinates in the `list`, those of the rows that are `asked` for, at the last instant of
   !> `s` or a time `t` between the instants. `always`: their errors too where no digit of a table is in doubt. Without
   !> it that of the motion which `s` has now, whose digits are safe: the engine need not have found it.
   subroutine find_node(s, asked, list, t, node, always)
      type(set_analysis_t), intent(inout) :: s
      type(rows_asked_t), intent(inout) :: asked
      type(coordinate_t), intent(in) :: list(:)
      real(wp), intent(in) :: t
      type(node_t), intent(inout) :: node
      logical, intent(in), optional :: always
      logical :: has_errors
      integer :: i

      if (.not. allocated(node%f)) then
         allocate (node%known(size(list)), node%f(0:2, size(list)))
         allocate (node%error(0:2, size(list)), source=0.0_wp)
      end if
      node%t = t
      has_errors = .false.
      associate (rows => asked%rows, error => asked%error, c => s%now%rows(asked%requests(1))%part)
         if (present(always)) then
            call rows_at(s, c, asked%requests, t, rows, always, error, node%growth)
            has_errors = always .or. node%growth >= safe_growth
         else
            do i = 1, size(rows)
               associate (own => s%now%parts(c), number => s%now%rows(asked%requests(i))%number)
                  call find_row(own, s%now%motions(c), own%requests(number), rows(i))
               end associate
            end do
         end if
         do i = 1, size(list)
            node%f(:, i) = rows(list(i)%row)%value(list(i)%column, :)
            node%known(i) = rows(list(i)%row)%known
         end do
         if (has_errors .or. node%has_errors) then
            do i = 1, size(list)
               node%error(:, i) = error(list(i)%column, :, list(i)%row)
            end do
         end if
      end associate
      node%has_errors = has_errors
      node%is_known = all(node%known == 2)
      if (has_errors) node%is_known = node%is_known .and. all(node%error < nothing_known)
   end subroutine find_node

   !> Takes the node of mechanism `c` that comes next, and searches between it and the last one of which all is known.
   !> Two parts of one length, from an instant with an even number on, are searched together, if accelerations are
   !> simple there: the node between them is the one in the middle, and no motion is looked for. They are passed over,
   !> if nothing has turned there.
   subroutine add_node(x, s, c)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c

      associate (track => x%tracks(c), nodes => x%tracks(c)%nodes, place => x%tracks(c)%place)
         if (.not. nodes(place(6))%is_known) then
            call search_waiting(x, s, c)
            call take_node(x, c, nodes(place(6)), .true.)
            ! Nothing is searched across it.
            track%filled = 0
            return
         end if
         track%filled = track%filled + 1
         place([track%filled, 6]) = place([6, track%filled])
         if (track%filled == 1) call take_node(x, c, nodes(place(1)), .true.)
         if (track%filled == 2 .and. .not. nodes(place(1))%begins_pair) call search_waiting(x, s, c)
         if (track%filled < 3) return

         track%has_passed = .not. track%has_turned
         if (track%has_turned) call search_pair(x, s, c, nodes(place(1)), nodes(place(2)), nodes(place(3)))
         track%has_turned = .false.
         place(:5) = place([3, 4, 5, 1, 2])
         track%filled = 1
      end associate
   end subroutine add_node

   !> Extremes of mechanism `c` may be in its last steps, as `turned_in` says: parts that were passed over there are
   !> searched, and the next ones will be.
   subroutine search_passed(x, s, c)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c

      associate (track => x%tracks(c), nodes => x%tracks(c)%nodes, place => x%tracks(c)%place)
         track%has_turned = .true.
         if (.not. track%has_passed) return
         track%has_passed = .false.
         if (track%turned_in > track%filled) then
            call take_node(x, c, nodes(place(4)), .true.)
            call search_pair(x, s, c, nodes(place(4)), nodes(place(5)), nodes(place(1)))
         else
            call take_node(x, c, nodes(place(1)), .true.)
         end if
      end associate
   end subroutine search_passed

   !> Searches between the last node of mechanism `c` and the one that waits, if there is one; that is the last then.
   subroutine search_waiting(x, s, c)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c

      associate (track => x%tracks(c), place => x%tracks(c)%place)
         if (track%filled < 2) return
         call search_part(x, s, c, track%nodes(place(1)), track%nodes(place(2)))
         call take_node(x, c, track%nodes(place(2)), .true.)
         place([1, 2]) = place([2, 1])
         track%filled = 1
      end associate
   end subroutine search_waiting

   !> Searches the two parts from the node `a` of mechanism `c` to the `middle` and to `b`: together, if they have one
   !> length and accelerations are simple there.
   subroutine search_pair(x, s, c, a, middle, b)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(node_t), intent(in) :: a, middle, b
      real(wp) :: length
      logical :: is_searched

      length = abs(b%t - a%t)
      is_searched = length <= x%tracks(c)%longest .and. 0.5_wp*length > shortest_of(x, c, a%t, b%t) &
         .and. abs(b%t - 2.0_wp*middle%t + a%t) <= alike_part*length
      if (is_searched) call search_three(x, s, c, a, middle, b, .false., is_searched)
      if (.not. is_searched) then
         call search_part(x, s, c, a, middle)
         call take_node(x, c, middle, .true.)
         call search_part(x, s, c, middle, b)
      end if
      call take_node(x, c, b, .true.)
   end subroutine search_pair

   !> Searches between the nodes `a` and `b` of mechanism `c`, the ends of a part with the node `middle`, if its
   !> accelerations and their derivatives at the ends are those of simple curves, or `anyway`.
   subroutine search_three(x, s, c, a, middle, b, anyway, simple)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(node_t), intent(in) :: a, middle, b
      logical, intent(in) :: anyway
      logical, intent(out) :: simple
      real(wp) :: jerk(2, size(x%tracks(c)%coordinates)), f(3, 0:2), noise(0:2), open, h, growth
      integer :: i, k

      h = b%t - a%t
      growth = max(noise_part, epsilon(1.0_wp)*max(a%growth, middle%growth, b%growth))
      simple = .true.
      do i = 1, size(x%tracks(c)%coordinates)
         associate (size_of => x%tracks(c)%coordinates(i)%size_of)
            ! What rounding may leave open, at most.
            noise = max(a%error(:, i), middle%error(:, i), b%error(:, i), growth*size_of)
            do k = 0, 2
               f(:, k) = [a%f(k, i), middle%f(k, i), b%f(k, i)]
            end do
            f(:, 1) = f(:, 1)*h
            f(:, 2) = f(:, 2)*h**2
            open = max(noise(0), noise_part*maxval(abs(f(:, 0))))
            jerk(1, i) = jerk_at_first(f, open)/h**3
            ! From the last to the first the rates have the other sign, and so has their second derivative.
            f = f(3:1:-1, :)
            f(:, 1) = -f(:, 1)
            jerk(2, i) = -jerk_at_first(f, open)/h**3
            ! What rounding may leave open of the change of an acceleration, by its derivative at an end.
            open = overlooked*size_of(2) + errors_by_rates*(noise(1)/abs(h) + noise(2))
            simple = simple .and. is_simple([a%f(2, i), middle%f(2, i), b%f(2, i)], jerk(:, i)*h, open)
         end associate
      end do
      if (.not. (simple .or. anyway)) return
      call take_node(x, c, middle, .false.)
      call search_columns(x, s, c, a, middle, b, jerk)
   end subroutine search_three

   !> A part of mechanism `c` from the time `a` to `b` that is no longer is not searched.
   pure real(wp) function shortest_of(x, c, a, b) result(shortest)
      type(extremes_t), intent(in) :: x
      integer, intent(in) :: c
      real(wp), intent(in) :: a, b

      shortest = max(shortest_part*x%step, time_part*max(abs(a), abs(b)))
      if (size(x%tracks(c)%joints) > 0) shortest = max(shortest, 2.0_wp*beside_joint(x%run, a))
   end function shortest_of

   !> The values of `node` of mechanism `c` may be extremes; its velocities are the `next` along the run.
   subroutine take_node(x, c, node, next)
      type(extremes_t), intent(inout) :: x
      integer, intent(in) :: c
      type(node_t), intent(in) :: node
      logical, intent(in) :: next
      type(sample_t) :: sample
      integer :: i, k

      do i = 1, size(node%known)
         sample = sample_of(node, i)
         do k = 0, sample%known
            call offer_sample(x%tracks(c)%coordinates(i), k, sample, .false., x%step)
         end do
         if (next .and. sample%known == 2) call note_velocity(x%tracks(c)%coordinates(i), sample)
      end do
   end subroutine take_node

   !> Searches between the nodes `a` and `b` of mechanism `c`, in halves where accelerations are not simple.
   recursive subroutine search_part(x, s, c, a, b)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(node_t), intent(in) :: a, b
      type(node_t) :: middle
      real(wp) :: shortest
      logical :: simple, is_last

      associate (track => x%tracks(c), length => abs(b%t - a%t))
         shortest = shortest_of(x, c, a%t, b%t)
         if (length <= shortest) then
            ! Beside a joint there is nothing to be missed.
            if (length > 0.5_wp*x%step) call note_interval(x%open, x%way, a%t, b%t, shortest)
            return
         end if
         call find_node(s, track%asked, track%coordinates, a%t + 0.5_wp*(b%t - a%t), middle, .false.)
         if (.not. middle%is_known) then
            call note_interval(x%open, x%way, a%t, b%t, shortest)
            return
         end if
         is_last = track%halvings >= max_halvings .or. length <= 2.0_wp*shortest
         call search_three(x, s, c, a, middle, b, is_last, simple)
         if (simple) return
         if (is_last) then
            call note_interval(x%open, x%way, a%t, b%t, shortest)
         else
            track%halvings = track%halvings + 1
            call search_part(x, s, c, a, middle)
            call take_node(x, c, middle, .false.)
            call search_part(x, s, c, middle, b)
         end if
      end associate
   end subroutine search_part

   !> Searches for extremes of all columns of mechanism `c` between the nodes `a` and `b`, with the node `middle`. Their
   !> accelerations have the derivatives `jerk` (2, coordinates) at the ends.
   subroutine search_columns(x, s, c, a, middle, b, jerk)
      type(extremes_t), intent(inout) :: x
      type(set_analysis_t), intent(inout) :: s
      integer, intent(in) :: c
      type(node_t), intent(in) :: a, middle, b
      real(wp), intent(in) :: jerk(:, :)
      type(sample_t) :: points(3)
      type(sample_t), allocatable :: path(:), found(:)
      type(column_t) :: column
      integer :: i, k
      logical :: turns

      do i = 1, size(x%tracks(c)%coordinates)
         associate (one => x%tracks(c)%coordinates(i))
            points = [sample_of(a, i), sample_of(middle, i), sample_of(b, i)]
            ! A velocity, an acceleration or its derivative at both ends has different signs.
            turns = differ_in_sign(jerk(1, i), jerk(2, i)) .or. any([(differ_in_sign(minval(points%f(k)), &
               maxval(points%f(k))), k=1, 2)])
            if (turns) then
               column = column_t(one%request, one%column, min(max_part*abs(b%t - a%t), &
                  max(difference_part*x%step, difference_angle*one%size_of(0)/one%size_of(1))))
               do k = 0, 2
                  column%noise(k) = max(noise_part*one%size_of(k), maxval(points%error(k)))
               end do
               column%flat = 2.0_wp*max(alike*one%size_of(2), column%noise(2))
               call search_column(s, column, points, jerk(:, i), path, found)
               do k = 1, size(found)
                  call offer_sample(one, found(k)%order, found(k), .true., x%step)
               end do
            else
               path = points
            end if
            do k = 1, size(path)
               call note_velocity(one, path(k))
            end do
         end associate
      end do
   end subroutine search_columns

   !> Finds extremes of column `c` between the first and the last of three `points`: an extreme of the acceleration,
   !> if its derivatives `jerk` at both ends have different signs; of the velocity, one on either side of that at
   !> most; of the coordinate, one on either side of each of these. `path`: all points that are known then.
   subroutine search_column(s, c, points, jerk, path, found)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      type(sample_t), intent(in) :: points(3)
      real(wp), intent(in) :: jerk(2)
      type(sample_t), allocatable, intent(out) :: path(:)
      type(sample_t), allocatable, intent(out) :: found(:)
      type(sample_t) :: turn, zero
      real(wp) :: length, open
      integer :: order, i, n, last

      allocate (found(0))
      path = points
      length = abs(points(3)%t - points(1)%t)
      open = errors_by_rates*(c%noise(1)/length + c%noise(2))/length
      if (differ_in_sign(jerk(1), jerk(2)) .and. minval(abs(jerk)) > open) &
         call find_turn(s, c, points, jerk, turn)
      if (turn%known < 2) call turn_by_ends(s, c, points, jerk, open, turn)
      if (turn%known == 2) then
         turn%error = max(turn%error, points(1)%error, points(3)%error)
         turn%order = 2
         found = [turn]
         call insert(turn, path)
      end if
      do order = 2, 1, -1
         n = size(found)
         last = 0
         do i = 1, size(path)
            ! Of a derivative that is no more than rounding no sign is known.
            if (abs(path(i)%f(order)) <= c%noise(order)) cycle
            if (last > 0) then
               if (differ_in_sign(path(last)%f(order), path(i)%f(order))) then
                  call find_zero(s, c, order, 0.0_wp, path(last), path(i), zero)
                  zero%order = order - 1
                  if (zero%known == 2) found = [found, zero]
               end if
            end if
            last = i
         end do
         do i = n + 1, size(found)
            call insert(found(i), path)
         end do
      end do
   end subroutine search_column

   !> An extreme `turn` of the acceleration between the first and the last of three `points` of column `c`, by its
   !> derivatives `jerk` at both ends alone, of which rounding leaves so much `open` that one may be zero: where the
   !> line between them is zero. Where accelerations are alike, none is told.
   subroutine turn_by_ends(s, c, points, jerk, open, turn)
      type(set_analysis_t), intent(inout) :: s
      type(column_t), intent(in) :: c
      type(sample_t), intent(in) :: points(3)
      real(wp), intent(in) :: jerk(2), open
      type(sample_t), intent(out) :: turn
      real(wp) :: change, part, length

      change = abs(jerk(2) - jerk(1))
      ! What is so near an end is as good as there.
      if (.not. differ_in_sign(jerk(1), jerk(2)) .or. open <= beside_end*change) return
      if (maxval(points%f(2)) - minval(points%f(2)) <= c%flat) return
      part = jerk(1)/(jerk(1) - jerk(2))
      length = points(3)%t - points(1)%t
      call look_at_column(s, c, points(1)%t + part*length, turn, .false.)
      turn%t_error = abs(length)*min(2.0_wp, open/change)
      ! No parabola through values at equal distances gets above them by more than an eighth of their second difference.
      ! These are bounds, and masks allow for a hundred errors: a tenth of a bound is enough.
      turn%error(2) = turn%error(2) + 0.1_wp*min(0.5_wp*open*turn%t_error, &
         0.25_wp*abs(points(1)%f(2) - 2.0_wp*points(2)%f(2) + points(3)%f(2)) + c%noise(2))
   end subroutine turn_by_ends

   !> Adds `point`, which is between the ends of the `path`, in its order.
   pure subroutine insert(point, path)
      type(sample_t), intent(in) :: point
      type(sample_t), allocatable, intent(inout) :: path(:)
      integer :: n

      n = count((path%t - point%t)*(path(size(path))%t - path(1)%t) < 0.0_wp)
      path = [path(:n), point, path(n + 1:)]
   end subroutine insert

   !> The third derivative at the first of three places of an interval of the length 1, its ends and its middle, by
   !> values, rates and accelerations `f` (3, 0:2) at them: from all, which has an error of 2E-6 of the ninth
   !> derivative, but where rounding explains the difference from rates and accelerations alone, with an error of 7E-4
   !> of the seventh. So much is `open` of values.
   pure real(wp) function jerk_at_first(f, open) result(jerk)
      real(wp), intent(in) :: f(3, 0:2), open
      real(wp) :: by_values

      by_values = sum(by_all*f)
      jerk = sum(by_rates*f(:, 1:))
      if (abs(by_values - jerk) > sum(abs(by_all(:, 0)))*open) jerk = by_values
   end function jerk_at_first

   !> The cubic with the values `f`(1) and `f`(3) and the derivatives `d` at the ends of an interval of the length 1 has
   !> about the value `f`(2) in the middle, and one extreme inside at most; what is less than `open` counts for nothing.
   pure logical function is_simple(f, d, open)
      real(wp), intent(in) :: f(3), d(2), open

      is_simple = abs(f(2) - 0.5_wp*(f(1) + f(3)) - 0.125_wp*(d(1) - d(2))) <= misses_by*(maxval(f) - minval(f)) + open
      if (differ_in_sign(d(1), d(2)) .or. maxval(abs(d)) <= open) return
      is_simple = is_simple .and. maxval(d*sign(1.0_wp, f(3) - f(1))) > 0.0_wp &
         .and. maxval(abs(d)) <= steeper_by*abs(f(3) - f(1)) + open
   end function is_simple
end module column_search
