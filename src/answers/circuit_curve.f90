!> The curve of all positions of a mechanism whose one drive is set free: its equations, its points, and steps from one
!> to another.
!>
!> Its pairs and its other drives, at rest, are one equation less than it has coordinates; a mechanism with more has no
!> such curve here. Lengths are those of METHOD DENSE's system.
!>
!> With the tangent t as one more row the Jacobian B = (F_q, t) of the equations is regular at dead points too; it is
!> singular at change points alone. K and D of `uniqueness_radius`, taken from B, bound how fast B^-1 B changes in any
!> direction and along t; `find_reach` takes from them how long a step cannot jump to another circuit.
module circuit_curve
   use kinds, only: wp
   use plane_vectors, only: wrap_angle
   use mechanism, only: mechanism_t, drive_x, drive_y, drive_slide
   use drive_path, only: drive_path_t
   use separations, only: separation
   use scales, only: is_length
   use linear_solver, only: factors_t, new_factors, factor, solve
   use configuration, only: system_t, configuration_t, new_system, new_configuration, set_configuration, add_to_links
   use closure_equations, only: residual, jacobian, remainder, find_drive_values
   use uniqueness_radius, only: coordinates_t, new_coordinates, measure_slides, distance, forms_by_inverse, &
      kantorovich, change_along
   use cylinders, only: cylinder_t, cylinders_of, cylinder_length
   implicit none
   private
   public :: curve_t, make_curve, is_redundant, drive_value, deck_position
   public :: of_value, of_slope, of_bend, of_size, of_gap
   public :: curve_point_t, start_point, step_along, step_between, lies_between, offset_from, &
      same_place, same, reversed

   integer, parameter :: max_iterations = 12
   !> A correction below this is rounding, and one that no longer shrinks is so below the second one.
   real(wp), parameter :: converged = 16.0_wp*epsilon(1.0_wp), stalled = sqrt(epsilon(1.0_wp))

   !> The bound of `find_reach`, less than 1/2: K of slides is taken at the start of a step, and they grow.
   real(wp), parameter :: certified = 0.25_wp
   !> The longest step, in rad and lengths, and in parts of a longer slide: a curve of such pieces looks smooth.
   real(wp), parameter :: max_step = 0.1_wp
   !> Two positions are one up to this difference, in rad and lengths.
   real(wp), parameter :: same = max(1.0e-7_wp, 1.0e2_wp*epsilon(1.0_wp))

   !> The numbers of a position on the curve: the drive's value, its first and second derivative, the largest coordinate
   !> in lengths, and the shortest length of a cylinder in the deck's unit.
   enum, bind(c)
      enumerator :: of_value = 0, of_slope, of_bend, of_size, of_gap
   end enum

   type :: curve_t
      type(system_t) :: closure               !< all pairs, and the drives that are held
      type(system_t) :: driven                !< with the drive that is free as well: its row is the last
      type(cylinder_t), allocatable :: cylinders(:)
      logical :: drives_cylinder = .false.    !< the free drive is that of the length of one
      real(wp), allocatable :: held(:)        !< (drives) the values of those that are held, and 0 of the free one
      logical :: is_angle = .true.            !< the free drive is that of an angle
      real(wp) :: first = 0.0_wp              !< its value at the first instant
      !> A slide is followed so many lengths, and farther only to assemblies of the first instant.
      real(wp) :: far = 100.0_wp
      type(configuration_t) :: configuration   !< of the position found last
      type(coordinates_t) :: nonlinear        !< in which the equations are not linear
      type(factors_t) :: factors
   end type curve_t

   !> A position on the curve; derivatives are by its length, in rad and lengths.
   type :: curve_point_t
      real(wp), allocatable :: q(:, :)        !< (3, links) x, y, phi
      real(wp), allocatable :: tangent(:)     !< (coordinates) unit vector
      real(wp), allocatable :: bend(:)        !< (coordinates) second derivative
      real(wp) :: value(of_value:of_gap) = [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, huge(1.0_wp)]
      real(wp) :: reach = 0.0_wp              !< the longest step that is certified
      real(wp) :: room = 0.0_wp               !< within it no other curve comes near, whatever the direction
      logical :: is_dead = .false.            !< the drive turns back here
      logical :: is_change = .false.          !< circuits meet here, or one crosses itself: between two points of one
   end type curve_point_t

contains

   !> The curve on which drive number `drive` of `m` is free; the other ones have their values of the time `t`.
   subroutine make_curve(c, m, drive, t)
      type(curve_t), intent(out) :: c
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: drive
      real(wp), intent(in) :: t
      real(wp) :: f(3, size(m%drives))
      integer, allocatable :: others(:)
      integer :: i

      c%closure = new_system(m)
      c%cylinders = cylinders_of(m, .false.)
      if (m%drives(drive)%kind == drive_slide) c%drives_cylinder = m%pairs(m%drives(drive)%subject)%is_cylinder
      c%driven = c%closure
      call find_drive_values(c%closure, drive_path_t(m%drives), t, f)
      c%first = f(1, drive)
      c%is_angle = .not. is_length(m%drives(drive))
      others = pack([(i, i=1, size(m%drives))], [(i /= drive, i=1, size(m%drives))])
      c%held = [f(1, others), 0.0_wp]
      c%driven%drives = c%closure%drives([others, drive])
      c%closure%drives = c%driven%drives(:size(others))
      c%configuration = new_configuration(c%closure, m)
      c%factors = new_factors(c%closure%n)
      c%nonlinear = new_coordinates(c%closure)
   end subroutine make_curve

   !> Some equations are too many, by count: two of each pair, one of each drive that is held.
   pure logical function is_redundant(c)
      type(curve_t), intent(in) :: c

      is_redundant = 2*size(c%closure%pairs) + size(c%closure%drives) > c%closure%n - 1
   end function is_redundant

   !> Newton's method from `c%configuration`, with the row `border` at rest. `c%factors` are those of the Jacobian
   !> there, with `border` in the place of the `row` of the free drive.
   subroutine correct(c, border, row, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: border(:)
      real(wp), intent(out) :: row(:)
      logical, intent(out) :: ok
      real(wp) :: r(c%closure%n), change, before
      integer :: i, info

      before = huge(before)
      do i = 1, max_iterations
         call residual(c%driven, c%configuration, c%held, r)
         r(c%closure%n) = 0.0_wp
         call factor_there()
         if (.not. ok) return
         call solve(c%factors, r)
         change = maxval(abs(r))
         ok = change <= 1.0_wp
         if (.not. ok) return
         call add_to_links(c%closure, -r, c%configuration%q)
         call set_configuration(c%closure, c%configuration)
         ok = change <= converged*max(1.0_wp, maxval(abs(c%configuration%q)))
         if (ok) return
         ok = change <= stalled
         if (ok .and. change > 0.5_wp*before) exit
         before = change
      end do
      if (ok) call factor_there()

   contains

      !> Factors the bordered Jacobian at `c%configuration`.
      subroutine factor_there()
         call jacobian(c%driven, c%configuration, c%factors%a)
         row = c%factors%a(c%closure%n, :)
         c%factors%a(c%closure%n, :) = border
         call factor(c%factors, info)
         ok = info == 0
      end subroutine factor_there
   end subroutine correct

   !> The value `x` of the free drive in the deck's unit.
   pure real(wp) function drive_value(c, x) result(value)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: x

      value = x
      if (c%is_angle) return
      value = x*c%closure%length
      associate (drive => c%driven%drives(size(c%held)))
         if (drive%kind == drive_x) value = value + c%closure%origin(1)
         if (drive%kind == drive_y) value = value + c%closure%origin(2)
      end associate
   end function drive_value

   !> The links' position (3, links) `q` in the deck's unit, counted from its origin.
   pure function deck_position(c, q) result(position)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: q(:, :)
      real(wp) :: position(3, size(q, 2))

      position = q
      position(:2, :) = q(:2, :)*c%closure%length
   end function deck_position

   !> The point `p` of the curve at the links' `position` (3, links), in the deck's unit and from its origin. Its
   !> tangent has the sense in which the drive grows, unless it is at rest. `ok`: it was found, and is regular.
   subroutine start_point(c, position, p, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: position(:, :)
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok
      real(wp) :: q(3, size(position, 2)), border(c%closure%n)
      integer :: i

      q = position
      q(:2, :) = q(:2, :)/c%closure%length
      ! A row without a meaning: only by chance is it at right angles to the tangent.
      border = [(cos(real(i, wp)), i=1, size(border))]
      call find_point(c, q, border/norm2(border), p, ok)
      if (.not. ok) return
      if (p%value(of_slope) < 0.0_wp) p = reversed(p)
   end subroutine start_point

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

   !> `p`, its tangent turned round.
   pure function reversed(p) result(r)
      type(curve_point_t), intent(in) :: p
      type(curve_point_t) :: r

      r = p
      r%tangent = -p%tangent
      r%value(of_slope) = -p%value(of_slope)
   end function reversed

   !> The distance from `a` to `b` along the tangent of `a`.
   pure real(wp) function step_between(c, a, b) result(h)
      type(curve_t), intent(in) :: c
      type(curve_point_t), intent(in) :: a, b

      h = dot_product(a%tangent, offset_from(c, a%q, b%q, .false.))
   end function step_between

   !> Whether the position `q` (3, links) is on the curve at a distance from 0 to `h` along the tangent of `a`, or
   !> beside its end; whole turns of links do not count. `b`: the point of the curve there.
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
      if (lies) lies = same_place(b%q, q)
   end subroutine lies_between

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
            if (turns_off) x(k + 2) = wrap_angle(x(k + 2))
         end associate
      end do
   end function offset_from

   !> Whether two positions (3, links) are one, but for whole turns.
   pure logical function same_place(a, b)
      real(wp), intent(in) :: a(:, :), b(:, :)

      same_place = maxval(separation(a, b, 1.0_wp)) <= same
   end function same_place

   !> Finds the shortest length of a cylinder at the position `q` (3, links), in the deck's unit.
   pure real(wp) function shortest(c, q)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: q(:, :)
      real(wp) :: position(3, size(q, 2))
      integer :: k

      position = deck_position(c, q)
      shortest = minval([(cylinder_length(c%cylinders(k), position(:, c%cylinders(k)%i), &
         position(:, c%cylinders(k)%j)), k=1, size(c%cylinders))])
   end function shortest

   !> The point `p` near the position `q` (3, links) at which `border` (coordinates) times the difference from `q` is 0.
   !> Its tangent has the sense of `border`.
   subroutine find_point(c, q, border, p, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), border(:)
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok
      real(wp) :: x(c%closure%n), row(c%closure%n), along(3, size(q, 2))

      c%configuration%q = q
      call set_configuration(c%closure, c%configuration)
      call correct(c, border, row, ok)
      if (.not. ok) return
      p%q = c%configuration%q

      x = 0.0_wp
      x(c%closure%n) = 1.0_wp
      call solve(c%factors, x)
      p%tangent = x/norm2(x)

      along = 0.0_wp
      call add_to_links(c%closure, p%tangent, along)
      call remainder(c%driven, c%configuration, along, x)
      p%value(of_bend) = x(c%closure%n)
      x(c%closure%n) = 0.0_wp
      call solve(c%factors, x)
      p%bend = dot_product(p%tangent, x)*p%tangent - x

      call residual(c%driven, c%configuration, c%held, x)
      p%value(of_value) = x(c%closure%n)
      p%value(of_slope) = dot_product(row, p%tangent)
      p%value(of_bend) = p%value(of_bend) + dot_product(row, p%bend)
      p%value(of_size) = maxval(abs(p%q(:2, :)))
      if (size(c%cylinders) > 0) p%value(of_gap) = shortest(c, p%q)
      call find_reach(c, along, p)
   end subroutine find_point

   !> Finds the longest certified step at `p`, found last, and the room about it; `along` (3, links): its tangent.
   !>
   !> With the bend b a step h to q + h t + h^2 b/2 leaves B^-1 F below e = h^3 (D |b|/2 + K |t|^3/4). B^-1 B has
   !> changed there by D h + K (|t|^2 + |b|/2) h^2 at most. If the sum of this and 2 K e is below 1/2, B is regular
   !> within 2 e of that place, and one solution is there.
   subroutine find_reach(c, along, p)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: along(:, :)
      type(curve_point_t), intent(inout) :: p
      real(wp), allocatable :: y(:, :)
      real(wp) :: k, change, speed, bend, powers(3), least

      call measure_slides(c%closure, c%configuration, c%nonlinear)
      y = forms_by_inverse(c%nonlinear, c%factors, p%tangent)
      k = kantorovich(c%closure, c%nonlinear, y, c%configuration)
      change = change_along(c%closure, c%nonlinear, y, c%configuration, along)
      speed = distance(c%nonlinear, p%tangent)
      bend = distance(c%nonlinear, p%bend)
      ! Where nothing turns a step is as long as the mechanism is far.
      least = 1.0_wp/max(1.0_wp, p%value(of_size))

      powers = [change, k*(speed**2 + 0.5_wp*bend), k*(change*bend + 0.5_wp*k*speed**3)]/certified
      ! The sum of powers(i) h^i is 1 at most.
      p%reach = 1.0_wp/max(speed/max_step, powers(1) + sqrt(powers(2)) + powers(3)**(1.0_wp/3.0_wp), least)
      p%room = 1.0_wp/max(speed/max_step, speed*k/certified, least)
   end subroutine find_reach
end module circuit_curve
