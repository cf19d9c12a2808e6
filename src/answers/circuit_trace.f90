!> One circuit: the curve of positions, followed by its length from one of them, both ways if it does not close.
!> At a dead point the drive's derivative by the length changes its sign. At a change point no step is certified: the
!> curve passes it in the direction of the tangent.
module circuit_trace
   use kinds, only: wp
   use system_calls, only: signal_received
   use circuit_curve, only: curve_t, curve_point_t, of_value, of_slope, of_bend, of_size, of_cylinder, step_along, &
      step_between, lies_between, offset_from, reversed
   use drives, only: halve, middle_of
   use configuration, only: add_to_links
   implicit none
   private
   public :: circuit_t, trace, least_step, end_closed, end_far, end_shut

   !> A certified step below this (rad and lengths of the curve) means a change point: rounding does not distinguish
   !> other positions that are nearer.
   real(wp), parameter :: least_step = epsilon(1.0_wp)**0.375_wp
   !> The value of the drive at which a cylinder reaches the length 0 is extrapolated: by the parabola through its
   !> values at one, two and three of these lengths, in characteristic lengths. Its error is below their cube.
   real(wp), parameter :: short_cylinder = 1.0e-4_wp
   !> Across a change point certified steps become longer or shorter by less than this factor, and the tangent turns by
   !> less than this (rad).
   real(wp), parameter :: max_step_ratio = 3.0_wp, max_tangent_turn = 0.1_wp
   !> The largest number of points of one circuit, each way.
   integer, parameter :: max_points = 50000
   !> Rounding makes the tangent uncertain by some roundings over the square of the certified step, and with it the
   !> sense in which the drive moves.
   real(wp), parameter :: unsure_slope = 16.0_wp*epsilon(1.0_wp)

   !> How a circuit ends: it closes, a slide goes to infinity, it can be followed no further, or a cylinder has the
   !> length 0.
   enum, bind(c)
      enumerator :: end_closed = 1, end_far, end_lost, end_shut
   end enum

   !> A circuit: its points in the order of the curve, and how it ends.
   type :: circuit_t
      type(curve_point_t), allocatable :: points(:)     !< along it; of a closed one the last is the first
      integer :: ends(2) = end_lost                     !< how it ends at the first and at the last point
      logical :: rests = .false.                        !< the drive does not move on it
      real(wp) :: shift = 0.0_wp                        !< whole turns (rad) to be added to the drive's values
   end type circuit_t

contains

   !> Follows the circuit of a curve through a point. A circuit that closes begins, and ends, at its first dead point,
   !> if there is one.
   subroutine trace(curve, start, circuit)
      type(curve_t), intent(inout) :: curve   !< gets another configuration
      type(curve_point_t), intent(in) :: start   !< a regular point of the curve
      type(circuit_t), intent(out) :: circuit   !< with at least one point
      type(circuit_t) :: back
      type(curve_point_t), allocatable :: points(:)
      integer :: n, i

      call follow(curve, start, circuit)
      if (circuit%ends(2) == end_closed) then
         circuit%ends(1) = end_closed
         ! Only its neighbours show whether the start is a dead point.
         n = size(circuit%points)
         circuit%points([1, n])%is_dead = sense(circuit%points)*sense(circuit%points(n:1:-1)) < 0
         i = findloc(circuit%points%is_dead, .true., dim=1)
         if (i > 1) then
            ! The points before that one come a round later.
            points = [circuit%points(i:), circuit%points(2:i)]
            associate (first => circuit%points(1), last => circuit%points(n))
               do i = n - i + 2, n
                  points(i)%q = points(i)%q + (last%q - first%q)
                  points(i)%value(of_value) = points(i)%value(of_value) + (last%value(of_value) - first%value(of_value))
               end do
            end associate
            call move_alloc(points, circuit%points)
         end if
      else
         call follow(curve, reversed(start), back)
         circuit%points(1)%is_dead = sense(circuit%points)*sense(back%points) > 0
         ! The points that were followed back come before the first one.
         n = size(back%points)
         allocate (points(n - 1 + size(circuit%points)))
         do i = 1, n - 1
            points(i) = reversed(back%points(n + 1 - i))
         end do
         points(n:) = circuit%points
         call move_alloc(points, circuit%points)
         circuit%ends(1) = back%ends(2)
      end if
      circuit%rests = size(circuit%points) > 1 .and. .not. any(is_sure(circuit%points))
   end subroutine trace

   !> Follows the curve from a point in the sense of its tangent to an end, or over `max_points`. circuit%ends(2) says
   !> how it ends: end_lost also after a signal.
   subroutine follow(curve, start, circuit)
      type(curve_t), intent(inout) :: curve   !< gets another configuration
      type(curve_point_t), intent(in) :: start   !< the first point
      type(circuit_t), intent(out) :: circuit   !< from `start` on
      type(curve_point_t) :: a, b, again, change
      real(wp) :: h
      integer :: n, sure, k
      logical :: ok, closes, leaves

      allocate (circuit%points(64))
      n = 0
      sure = 0
      a = start
      leaves = .false.
      call append(a)
      if (is_sure(a)) sure = 1
      do while (n < max_points)
         leaves = leaves .and. a%room < 2.0_wp*least_step
         if (a%room >= least_step .or. leaves) then
            ! The longest certified step that Newton's method takes.
            h = a%certified_step
            do
               call step_along(curve, a, h, b, ok)
               if (ok .or. h < 0.1_wp*least_step) exit
               h = 0.5_wp*h
            end do
         else
            ok = n > 1
            if (ok) call pass_change_point(curve, circuit%points(n - 1), a, change, b, ok)
            if (ok) call append(change)
            leaves = .true.
         end if
         if (.not. ok .or. signal_received() > 0) exit

         closes = .false.
         if (n > 1) call lies_between(curve, a, step_between(curve, a, b), start%q, again, closes)
         if (closes) b = again
         if (b%value(of_cylinder) <= 0.0_wp) then
            closes = .false.
            circuit%ends(2) = end_shut
            call find_root(curve, a, b, of_cylinder, 0.0_wp, again, ok)
            if (ok) b = again
            ! Nothing is passed there.
            if (circuit%points(n)%is_change) n = n - 1
            call find_value_at_0(curve, circuit%points(:n), b)
         else if (b%value(of_size) > curve%far) then
            circuit%ends(2) = end_far
            call find_root(curve, a, b, of_size, curve%far, again, ok)
            if (ok) b = again
         end if

         ! The dead points between `b` and point `sure`, the last one at which the drive's sense is known. If these are
         ! no neighbours, the drive turns back too near to a change point to distinguish the two.
         if (sure > 0 .and. is_sure(b)) then
            if (sure == n) then
               call append_dead_points(b)
            else if (circuit%points(sure)%value(1)*b%value(1) < 0.0_wp) then
               k = sure + minloc(circuit%points(sure + 1:n)%room, dim=1)
               circuit%points(k)%is_dead = .true.
            end if
         end if
         call append(b)
         if (is_sure(b)) sure = n
         if (closes) circuit%ends(2) = end_closed
         if (circuit%ends(2) /= end_lost) exit
         a = b
      end do
      circuit%points = circuit%points(:n)

   contains

      !> Appends the dead points between the last of the `n` points and another one: one if the drive's derivative
      !> changes its sign; two, about the place at which the derivative is least, if it changes its sign and back.
      recursive subroutine append_dead_points(point)
         type(curve_point_t), intent(in) :: point   !< the next of the curve
         type(curve_point_t) :: a, p
         logical :: ok

         a = circuit%points(n)
         if (a%value(1)*point%value(1) < 0.0_wp) then
            call find_root(curve, a, point, of_slope, 0.0_wp, p, ok)
            p%is_dead = .true.
            if (ok) call append(p)
         else if (a%value(1)*a%value(2) < 0.0_wp .and. point%value(1)*point%value(2) > 0.0_wp) then
            call find_root(curve, a, point, of_bend, 0.0_wp, p, ok)
            if (ok) ok = a%value(1)*p%value(1) < 0.0_wp
            if (.not. ok) return
            call append_dead_points(p)
            call append(p)
            call append_dead_points(point)
         end if
      end subroutine append_dead_points

      !> Appends a point to the `n` points of the circuit.
      subroutine append(point)
         type(curve_point_t), intent(in) :: point   !< the next of the curve, or a dead point
         type(curve_point_t), allocatable :: more(:)

         if (n == size(circuit%points)) then
            allocate (more(2*n))
            more(:n) = circuit%points
            call move_alloc(more, circuit%points)
         end if
         n = n + 1
         circuit%points(n) = point
      end subroutine append
   end subroutine follow

   !> Passes the change point ahead of a point. The next point is as far after it as the point is before it: certified
   !> steps shrink in proportion to the distance from a change point.
   subroutine pass_change_point(curve, before, last, change, next, ok)
      type(curve_t), intent(inout) :: curve   !< gets another configuration
      type(curve_point_t), intent(in) :: before, last   !< the last two points ahead of the change point
      type(curve_point_t), intent(out) :: change, next  !< the change point, and the point after it, if `ok`
      logical, intent(out) :: ok             !< the change point is passed
      real(wp) :: shrinks, h

      change = last
      shrinks = last%room/before%room
      ok = shrinks < 1.0_wp
      if (.not. ok) return
      h = 2.0_wp*step_between(curve, before, last)*shrinks/(1.0_wp - shrinks)
      call step_along(curve, last, h, next, ok)
      if (.not. ok) return
      ok = next%room < max_step_ratio*last%room .and. last%room < max_step_ratio*next%room &
         .and. norm2(next%tangent - last%tangent) < max_tangent_turn
      if (.not. ok) return

      ! Halfway on the cubic through both with their tangents: this may be a dead point of the drive.
      call add_to_links(curve%closure, &
         0.5_wp*offset_from(curve, last%q, next%q, .false.) + 0.125_wp*h*(last%tangent - next%tangent), change%q)
      change%value(of_value) = 0.5_wp*(last%value(of_value) + next%value(of_value)) &
         + 0.125_wp*h*(last%value(of_slope) - next%value(of_slope))
      change%room = 0.0_wp
      change%is_change = .true.
   end subroutine pass_change_point

   !> Finds the drive's value at which the length of a cylinder becomes 0, by the parabola through the values at three
   !> lengths before it. The direction of the barrel is free there, and a point of the curve is known to half its
   !> digits. If the parabola cannot be made, the value stays.
   subroutine find_value_at_0(curve, points, at_0)
      type(curve_t), intent(inout) :: curve   !< gets another configuration
      type(curve_point_t), intent(in) :: points(:)   !< (any number) of the circuit so far
      type(curve_point_t), intent(inout) :: at_0     !< the end of the circuit, near the length 0; gets the value
      type(curve_point_t) :: p
      real(wp) :: x(3)
      integer :: from, k
      logical :: ok

      from = findloc(points%value(of_cylinder) > 3.0_wp*short_cylinder*curve%closure%length, .true., dim=1, back=.true.)
      if (from > 0) then
         do k = 1, 3
            call find_root(curve, points(from), at_0, of_cylinder, real(k, wp)*short_cylinder*curve%closure%length, &
               p, ok)
            if (.not. ok) return
            x(k) = p%value(of_value)
         end do
         at_0%value(of_value) = 3.0_wp*(x(1) - x(2)) + x(3)
      end if
      ! The driven cylinder itself has the length 0; another one may reach 0 before it.
      if (curve%drives_cylinder .and. abs(at_0%value(of_value)) < short_cylinder*curve%closure%length) &
         at_0%value(of_value) = 0.0_wp
   end subroutine find_value_at_0

   !> Tells whether the sense in which the drive moves is known at a point: its slope exceeds the error by rounding.
   pure elemental logical function is_sure(point)
      type(curve_point_t), intent(in) :: point   !< any point of a circuit

      is_sure = abs(point%value(1))*point%room**2 > unsure_slope
   end function is_sure

   !> Gives the sense in which the drive moves, 1 or -1, at the first of some points at which it is known; 0 if it is
   !> not known at any.
   pure integer function sense(points)
      type(curve_point_t), intent(in) :: points(:)   !< (any number) of the curve, in its order
      integer :: k

      sense = 0
      k = findloc(is_sure(points), .true., dim=1)
      if (k > 0) sense = nint(sign(1.0_wp, points(k)%value(1)))
   end function sense

   !> Finds the point between two neighbours at which one of the numbers of a position has a level, by halving the step
   !> from the first.
   subroutine find_root(curve, from, to, order, level, root, ok)
      type(curve_t), intent(inout) :: curve   !< gets another configuration
      type(curve_point_t), intent(in) :: from, to   !< the neighbours
      integer, intent(in) :: order           !< which number: of_value, ..., of_cylinder
      real(wp), intent(in) :: level          !< between the numbers of the neighbours, in their unit
      type(curve_point_t), intent(out) :: root   !< of the curve; of no use unless `ok`
      logical, intent(out) :: ok             !< the point was found
      real(wp) :: near, far
      integer :: i

      near = 0.0_wp
      far = step_between(curve, from, to)
      do i = 1, digits(1.0_wp)
         call step_along(curve, from, middle_of(near, far), root, ok)
         if (.not. ok .or. abs(far - near) <= 4.0_wp*epsilon(1.0_wp)) return
         call halve((root%value(order) - level)*(from%value(order) - level) > 0.0_wp, near, far)
      end do
   end subroutine find_root
end module circuit_trace
