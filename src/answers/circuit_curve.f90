!> The curve of all positions of a mechanism whose one drive is set free: its pairs and its other drives, at rest, are
!> one equation less than it has coordinates. Lengths are those of METHOD DENSE's system.
!>
!> With the tangent t as one more row the Jacobian B = (F_q, t) is regular at dead points too; it is singular at change
!> points alone. K of `root_distance`, taken from B, bounds how fast B^-1 B changes: along t, up to the distance u/K in
!> the coordinates in which the equations are not linear, Newton and Kantorovich's ratio is at most (u/(1 - u))^2/2. For
!> u < 1/2 the curve beside each place of t is unique: a step of that length cannot jump to another circuit.
module circuit_curve
   use kinds, only: wp
   use constants, only: pi, without_turns
   use mechanism, only: mechanism_t, drive_x, drive_y
   use scales, only: is_length
   use linear_solver, only: factors_t, new_factors, factor, solve, determinant_sign
   use pose, only: system_t, pose_t, new_system, new_pose, set_pose, add_to_links
   use closure_equations, only: residual, jacobian, remainder, find_drive_values, drive_residual, drive_row, &
      drive_remainder
   use drives, only: law_t
   use root_distance, only: coordinates_t, new_coordinates, kantorovich, distance
   implicit none
   private
   public :: curve_t, curve_point_t, make_curve, is_curve, start_point, find_point, step_along, step_between, &
      lies_between, passes, second_derivative, factor_at, &
      reversed, offset_from, same_place, drive_value, deck_position, curve_position

   !> u of above, less than 1/2: K of slides is taken at the start of a step, and they grow.
   real(wp), parameter :: certified = 0.25_wp
   !> The longest step, in rad and lengths: a curve of such pieces looks smooth.
   real(wp), parameter :: max_step = 0.1_wp
   integer, parameter :: max_iterations = 12
   !> A correction below this is rounding, and one that no longer shrinks is so below the second one.
   real(wp), parameter :: converged = 16.0_wp*epsilon(1.0_wp), stalled = sqrt(epsilon(1.0_wp))
   !> A drive that moves by less along the curve is near a dead point.
   real(wp), parameter :: slow = 1.0e-3_wp
   !> Two positions are one up to this difference, in rad and lengths.
   real(wp), parameter :: same = max(1.0e-7_wp, 1.0e2_wp*epsilon(1.0_wp))

   type :: curve_t
      type(system_t) :: closure               !< all pairs, and the drives that are held
      type(system_t) :: driven                !< with the one drive that is free
      type(coordinates_t) :: free             !< in which the equations are not linear
      real(wp), allocatable :: held(:)        !< (drives held) their values
      logical :: is_angle = .true.            !< the free drive is that of an angle
      real(wp) :: first = 0.0_wp              !< its value at the first instant
      type(pose_t) :: pose                    !< of the position found last
      type(factors_t) :: factors
   end type curve_t

   !> A position on the curve; derivatives are by its length, in rad and lengths.
   type :: curve_point_t
      real(wp), allocatable :: q(:, :)        !< (3, links) x, y, phi
      real(wp), allocatable :: tangent(:)     !< (coordinates) unit vector
      real(wp), allocatable :: bend(:)        !< (coordinates) second derivative
      real(wp) :: value(0:2) = 0.0_wp         !< the drive's value, its first and second derivative
      real(wp) :: reach = 0.0_wp              !< the longest step that is certified
      integer :: sign = 1                     !< of the determinant of B
      logical :: is_dead = .false.            !< the drive turns back here
   end type curve_point_t

contains

   !> The curve on which drive number `drive` of `m` is free; the other ones have their values of the time `t`.
   subroutine make_curve(c, m, drive, t)
      type(curve_t), intent(out) :: c
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: drive
      real(wp), intent(in) :: t
      real(wp) :: f(3, size(m%drives))
      type(law_t), allocatable :: laws(:), free(:)
      integer :: i, k

      c%closure = new_system(m)
      c%driven = c%closure
      call find_drive_values(c%closure, t, f)
      c%first = f(1, drive)
      c%is_angle = .not. is_length(m%drives(drive))
      allocate (laws(size(m%drives) - 1), free(1), c%held(size(m%drives) - 1))
      k = 0
      do i = 1, size(m%drives)
         if (i == drive) then
            free(1) = c%closure%laws(i)
         else
            k = k + 1
            laws(k) = c%closure%laws(i)
            c%held(k) = f(1, i)
         end if
      end do
      call move_alloc(laws, c%closure%laws)
      call move_alloc(free, c%driven%laws)
      c%free = new_coordinates(c%closure)
      c%pose = new_pose(c%closure, m)
      c%factors = new_factors(c%closure%n)
   end subroutine make_curve

   !> Whether the equations are one less than the coordinates: none of them is redundant by count.
   pure logical function is_curve(c)
      type(curve_t), intent(in) :: c

      is_curve = 2*size(c%closure%pairs) + size(c%closure%laws) == c%closure%n - 1
   end function is_curve

   !> The point `p` of the curve at the links' `position` (3, links), in the deck's unit and counted from its origin;
   !> `toward` (coordinates), if present: the tangent has its sense. `ok`: it was found, and is regular.
   subroutine start_point(c, position, p, ok, toward)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: position(:, :)
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok
      real(wp), intent(in), optional :: toward(:)
      real(wp) :: row(1, c%closure%n), q(3, size(position, 2))

      q = curve_position(c, position)
      c%pose%q = q
      call set_pose(c%closure, c%pose)
      row = 0.0_wp
      call drive_row(c%driven, c%pose, 1, row, 1)
      if (present(toward)) row(1, :) = toward
      call find_point(c, q, row(1, :), p, ok)
      if (.not. ok) call find_by_coordinates(c, q, p, ok)
      if (.not. ok) return
      ! Near a dead point the drive's row lets rounding move the position along the curve.
      if (abs(p%value(1)) >= slow) return
      row(1, :) = p%tangent
      call find_point(c, q, row(1, :), p, ok)
   end subroutine start_point

   !> The same, with one coordinate after the other held.
   subroutine find_by_coordinates(c, q, p, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :)
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok
      real(wp) :: row(c%closure%n)
      integer :: i

      ok = .false.
      do i = 1, c%closure%n
         row = 0.0_wp
         row(i) = 1.0_wp
         call find_point(c, q, row, p, ok)
         if (ok) return
      end do
   end subroutine find_by_coordinates

   !> The point `b` of the curve at the distance `h` from `a` along its tangent; `ok`: it is regular, and where the
   !> tangent and the bend of `a` let it be expected.
   subroutine step_along(c, a, h, b, ok)
      type(curve_t), intent(inout) :: c
      type(curve_point_t), intent(in) :: a
      real(wp), intent(in) :: h
      type(curve_point_t), intent(out) :: b
      logical, intent(out) :: ok
      real(wp) :: q(3, size(a%q, 2))

      q = a%q
      call add_to_links(c%closure, h*a%tangent + 0.5_wp*h**2*a%bend, q)
      call find_point(c, q, a%tangent, b, ok)
      if (ok) ok = maxval(abs(b%q - q)) <= max(same, 0.5_wp*abs(h))
   end subroutine step_along

   !> The distance from `a` to `b` along the tangent of `a`.
   pure real(wp) function step_between(c, a, b) result(h)
      type(curve_t), intent(in) :: c
      type(curve_point_t), intent(in) :: a, b

      h = dot_product(a%tangent, offset_from(c, a%q, b%q, .false.))
   end function step_between

   !> Whether the position `q` (3, links) is on the curve at a distance from 0 to `h` along the tangent of `a`; whole
   !> turns of links do not count. `b`: the point of the curve there.
   subroutine lies_between(c, a, h, q, b, lies)
      type(curve_t), intent(inout) :: c
      type(curve_point_t), intent(in) :: a
      real(wp), intent(in) :: h, q(:, :)
      type(curve_point_t), intent(out) :: b
      logical, intent(out) :: lies
      real(wp) :: x(c%closure%n), along

      x = offset_from(c, a%q, q, .true.)
      along = dot_product(a%tangent, x)
      lies = along >= -same .and. along <= h + same
      if (lies) lies = maxval(abs(x - along*a%tangent)) <= h + same
      if (lies) call step_along(c, a, along, b, lies)
      if (lies) lies = same_place(c, b%q, q)
   end subroutine lies_between

   !> Whether the drive has the `value`, but for whole turns, between the neighbours `a` and `b`, or nearly there.
   pure logical function passes(c, a, b, value)
      type(curve_t), intent(in) :: c
      type(curve_point_t), intent(in) :: a, b
      real(wp), intent(in) :: value
      real(wp) :: least, greatest

      least = min(a%value(0), b%value(0)) - same
      greatest = max(a%value(0), b%value(0)) + same
      passes = value >= least .and. value <= greatest
      if (c%is_angle) passes = modulo(value - least, 2.0_wp*pi) <= greatest - least
   end function passes

   !> `p`, its tangent turned round.
   pure function reversed(p) result(r)
      type(curve_point_t), intent(in) :: p
      type(curve_point_t) :: r

      r = p
      r%tangent = -p%tangent
      r%value(1) = -p%value(1)
      r%sign = -p%sign
   end function reversed

   !> The coordinates of the position `b` less those of `a` (3, links), without whole turns if `turns_off`.
   pure function offset_from(c, a, b, turns_off) result(x)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: a(:, :), b(:, :)
      logical, intent(in) :: turns_off
      real(wp) :: x(c%closure%n)
      integer :: i

      do i = 1, size(a, 2)
         associate (k => c%closure%column(i))
            if (k == 0) cycle
            x(k:k + 2) = b(:, i) - a(:, i)
            if (turns_off) x(k + 2) = without_turns(x(k + 2))
         end associate
      end do
   end function offset_from

   !> Whether two positions (3, links) are one, but for whole turns, up to `difference`, if present.
   pure logical function same_place(c, a, b, difference)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: a(:, :), b(:, :)
      real(wp), intent(in), optional :: difference
      real(wp) :: limit

      limit = same
      if (present(difference)) limit = difference
      same_place = maxval(abs(offset_from(c, a, b, .true.))) <= limit
   end function same_place

   !> The value `x` of the free drive in the deck's unit.
   pure real(wp) function drive_value(c, x) result(value)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: x

      value = x
      if (c%is_angle) return
      value = x*c%closure%length
      if (c%driven%laws(1)%drive%kind == drive_x) value = value + c%closure%origin(1)
      if (c%driven%laws(1)%drive%kind == drive_y) value = value + c%closure%origin(2)
   end function drive_value

   !> The `position` (3, links) in the deck's unit, counted from its origin, in that of the curve.
   pure function curve_position(c, position) result(q)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: position(:, :)
      real(wp) :: q(3, size(position, 2))

      q = position
      q(:2, :) = position(:2, :)/c%closure%length
   end function curve_position

   !> The links' position (3, links) `q` in the deck's unit, counted from its origin.
   pure function deck_position(c, q) result(position)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: q(:, :)
      real(wp) :: position(3, size(q, 2))

      position = q
      position(:2, :) = q(:2, :)*c%closure%length
   end function deck_position

   !> The point `p` near the position `q` (3, links) at which `border` (coordinates) times the difference from `q` is 0.
   !> Its tangent has the sense of `border`.
   subroutine find_point(c, q, border, p, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), border(:)
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok

      c%pose%q = q
      call set_pose(c%closure, c%pose)
      call correct(c, border, ok)
      if (.not. ok) return
      p%q = c%pose%q
      call take_derivatives(c, border, p, ok)
   end subroutine find_point

   !> The second derivative (equations) of the equations at the position `q` (3, links) in the direction `x`
   !> (coordinates), which the Jacobian does not hold; 0 in the last row.
   subroutine second_derivative(c, q, x, f)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), x(:)
      real(wp), intent(out) :: f(:)
      real(wp) :: v(3, size(q, 2))

      c%pose%q = q
      call set_pose(c%closure, c%pose)
      v = 0.0_wp
      call add_to_links(c%closure, x, v)
      call remainder(c%closure, c%pose, v, f)
      f(c%closure%n) = 0.0_wp
   end subroutine second_derivative

   !> Newton's method from `c%pose`, with the row `border` at rest.
   subroutine correct(c, border, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: border(:)
      logical, intent(out) :: ok
      real(wp) :: r(c%closure%n), change, before
      integer :: i, info

      before = huge(before)
      do i = 1, max_iterations
         call residual(c%closure, c%pose, c%held, r(:c%closure%n - 1))
         r(c%closure%n) = 0.0_wp
         call factor_with(c, border, info)
         ok = info == 0
         if (.not. ok) return
         call solve(c%factors, r)
         change = maxval(abs(r))
         ok = change <= 1.0_wp
         if (.not. ok) return
         call add_to_links(c%closure, -r, c%pose%q)
         call set_pose(c%closure, c%pose)
         if (change <= converged*max(1.0_wp, maxval(abs(c%pose%q)))) return
         ok = change <= stalled
         if (ok .and. change > 0.5_wp*before) return
         before = change
      end do
   end subroutine correct

   !> The factors in `c` are those at the position `q` (3, links) with `border` (coordinates) as the last row.
   subroutine factor_at(c, q, border, info)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), border(:)
      integer, intent(out) :: info

      c%pose%q = q
      call set_pose(c%closure, c%pose)
      call factor_with(c, border, info)
   end subroutine factor_at

   !> The factors of the equations' Jacobian with `border` as its last row.
   subroutine factor_with(c, border, info)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: border(:)
      integer, intent(out) :: info

      call jacobian(c%closure, c%pose, c%factors%a)
      c%factors%a(c%closure%n, :) = border
      call factor(c%factors, info)
   end subroutine factor_with

   !> Tangent, bend, the drive's derivatives, certified step and determinant at `c%pose`.
   subroutine take_derivatives(c, border, p, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: border(:)
      type(curve_point_t), intent(inout) :: p
      logical, intent(out) :: ok
      real(wp) :: x(c%closure%n), row(1, c%closure%n), along(3, size(p%q, 2)), k, speed
      integer :: info

      call factor_with(c, border, info)
      ok = info == 0
      if (.not. ok) return
      x = 0.0_wp
      x(c%closure%n) = 1.0_wp
      call solve(c%factors, x)
      p%tangent = x/norm2(x)
      call factor_with(c, p%tangent, info)
      ok = info == 0
      if (.not. ok) return
      along = 0.0_wp
      call add_to_links(c%closure, p%tangent, along)
      call remainder(c%closure, c%pose, along, x)
      x(c%closure%n) = 0.0_wp
      x = -x
      call solve(c%factors, x)
      p%bend = x
      row = 0.0_wp
      call drive_row(c%driven, c%pose, 1, row, 1)
      p%value(0) = drive_residual(c%driven, c%pose, 1, 0.0_wp)
      p%value(1) = dot_product(row(1, :), p%tangent)
      p%value(2) = dot_product(row(1, :), p%bend) + drive_remainder(c%driven, c%pose, along, 1)
      call kantorovich(c%closure, c%free, c%factors, c%pose, k)
      speed = distance(c%closure, c%free, 0.0_wp*along, along)
      p%reach = max_step
      if (speed > 0.0_wp) p%reach = min(certified/max(k, tiny(k)), max_step)/speed
      p%sign = determinant_sign(c%factors)
   end subroutine take_derivatives
end module circuit_curve
