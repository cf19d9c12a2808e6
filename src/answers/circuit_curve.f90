!> The curve of all positions of a mechanism whose one drive is set free: its equations, its points, and steps from one
!> to another.
!>
!> Its pairs and its other drives, at rest, are one equation less than it has coordinates; a mechanism with more
!> equations has no such curve here. The unit of length is the one of METHOD DENSE's system.
!>
!> With the tangent t as one more row the Jacobian B = (F_q, t) of the equations is regular at dead points too; it is
!> singular only at change points. K and D of `uniqueness_radius`, taken from B, bound how fast B^-1 B changes in any
!> direction and along t. By them `find_certified_step` finds how long a step cannot jump to another circuit.
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
   public :: curve_t, make_curve, drive_value, deck_position
   public :: of_value, of_slope, of_bend, of_size, of_cylinder
   public :: curve_point_t, start_point, step_along, step_between, lies_between, offset_from, &
      same_place, same_position_tolerance, reversed

   !> The largest number of steps of Newton's method for one point.
   integer, parameter :: max_newton_steps = 12
   !> A correction below the first, relative to the largest coordinate, is rounding. A correction that no longer
   !> shrinks is rounding below the second (rad and lengths).
   real(wp), parameter :: rounding_correction = 16.0_wp*epsilon(1.0_wp), stalled_correction = sqrt(epsilon(1.0_wp))

   !> The bound of `find_certified_step`, less than 1/2, since K of slides is taken at the start of a step, and slides
   !> grow.
   real(wp), parameter :: certified_bound = 0.25_wp
   !> The longest step, in rad and lengths, and in parts of a longer slide: a curve of such pieces looks smooth.
   real(wp), parameter :: max_step = 0.1_wp
   !> Two positions are one up to this difference, in rad and lengths.
   real(wp), parameter :: same_position_tolerance = max(1.0e-7_wp, 1.0e2_wp*epsilon(1.0_wp))

   !> The numbers of a position on the curve: the drive's value, its first and second derivative, the largest coordinate
   !> in lengths, and the length of the shortest cylinder in the deck's unit.
   enum, bind(c)
      enumerator :: of_value = 0, of_slope, of_bend, of_size, of_cylinder
   end enum

   !> A curve, in lengths of its own: the unit of METHOD DENSE's system.
   type :: curve_t
      type(system_t) :: closure               !< all pairs, and the drives that are held
      type(system_t) :: driven                !< the free drive as well: its row is the last
      type(cylinder_t), allocatable :: cylinders(:)   !< (cylinders) of the mechanism
      logical :: drives_cylinder = .false.    !< the free drive is the length of a cylinder
      real(wp), allocatable :: held(:)        !< (drives) values of the held ones, rad and lengths; 0 of the free one
      logical :: is_angle = .true.            !< the free drive is an angle
      real(wp) :: first = 0.0_wp              !< the value of the free drive at the first instant, in rad and lengths
      !> A slide is followed so many lengths, and farther only to assemblies of the first instant.
      real(wp) :: far = 100.0_wp
      type(configuration_t) :: configuration   !< of the position found last
      type(coordinates_t) :: nonlinear        !< the coordinates in which the equations are not linear
      type(factors_t) :: factors          !< of the Jacobian with a row more, at a position
   end type curve_t

   !> A position on the curve; derivatives are by its length, in rad and lengths.
   type :: curve_point_t
      real(wp), allocatable :: q(:, :)        !< (3, links) x, y, phi
      real(wp), allocatable :: tangent(:)     !< (coordinates) unit vector
      real(wp), allocatable :: bend(:)        !< (coordinates) second derivative
      real(wp) :: value(of_value:of_cylinder) = [0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, huge(1.0_wp)]   !< of_value, ...
      real(wp) :: certified_step = 0.0_wp     !< the longest step that is certified
      real(wp) :: room = 0.0_wp               !< within it no other curve comes near in any direction; 0: a change point
      logical :: is_dead = .false.            !< the drive turns back here
      logical :: is_change = .false.          !< circuits meet here, or one crosses itself: between two points of one
   end type curve_point_t

contains

   !> Makes the curve on which a drive of a mechanism is free; the other drives have their values of a time.
   subroutine make_curve(curve, m, drive, t)
      type(curve_t), intent(out) :: curve    !< at the time
      type(mechanism_t), intent(in) :: m     !< one independent mechanism
      integer, intent(in) :: drive           !< number of the free drive
      real(wp), intent(in) :: t              !< time
      real(wp) :: f(3, size(m%drives))
      integer, allocatable :: others(:)
      integer :: i

      curve%closure = new_system(m)
      curve%cylinders = cylinders_of(m, .false.)
      if (m%drives(drive)%kind == drive_slide) curve%drives_cylinder = m%pairs(m%drives(drive)%subject)%is_cylinder
      curve%driven = curve%closure
      call find_drive_values(curve%closure, drive_path_t(m%drives), t, f)
      curve%first = f(1, drive)
      curve%is_angle = .not. is_length(m%drives(drive))
      others = pack([(i, i=1, size(m%drives))], [(i /= drive, i=1, size(m%drives))])
      curve%held = [f(1, others), 0.0_wp]
      curve%driven%drives = curve%closure%drives([others, drive])
      curve%closure%drives = curve%driven%drives(:size(others))
      curve%configuration = new_configuration(curve%closure, m)
      curve%factors = new_factors(curve%closure%n)
      curve%nonlinear = new_coordinates(curve%closure)
   end subroutine make_curve

   !> Corrects curve%configuration by Newton's method, at right angles to the row `border`. curve%factors become those
   !> of the Jacobian there, with `border` in the place of the row of the free drive. If the method fails, the
   !> configuration is the last one that it tried.
   subroutine correct(curve, border, row, ok)
      type(curve_t), intent(inout) :: curve   !< with an estimated configuration
      real(wp), intent(in) :: border(:)      !< (coordinates) a row of rad and lengths
      real(wp), intent(out) :: row(:)        !< (coordinates) the row of the free drive in the Jacobian
      logical, intent(out) :: ok             !< the iteration has converged, and the Jacobian is regular
      real(wp) :: r(curve%closure%n), change, before
      integer :: i, info

      before = huge(before)
      do i = 1, max_newton_steps
         call residual(curve%driven, curve%configuration, curve%held, r)
         r(curve%closure%n) = 0.0_wp
         call factor_there()
         if (.not. ok) return
         call solve(curve%factors, r)
         change = maxval(abs(r))
         ok = change <= 1.0_wp
         if (.not. ok) return
         call add_to_links(curve%closure, -r, curve%configuration%q)
         call set_configuration(curve%closure, curve%configuration)
         ok = change <= rounding_correction*max(1.0_wp, maxval(abs(curve%configuration%q)))
         if (ok) return
         ok = change <= stalled_correction
         if (ok .and. change > 0.5_wp*before) exit
         before = change
      end do
      if (ok) call factor_there()

   contains

      !> Factors the bordered Jacobian at `curve%configuration`.
      subroutine factor_there()
         call jacobian(curve%driven, curve%configuration, curve%factors%a)
         row = curve%factors%a(curve%closure%n, :)
         curve%factors%a(curve%closure%n, :) = border
         call factor(curve%factors, info)
         ok = info == 0
      end subroutine factor_there
   end subroutine correct

   !> Converts a value of the free drive to the deck's unit.
   pure real(wp) function drive_value(curve, given) result(value)
      type(curve_t), intent(in) :: curve     !< of the value
      real(wp), intent(in) :: given          !< rad, or lengths of the curve from its origin

      value = given
      if (curve%is_angle) return
      value = given*curve%closure%length
      associate (drive => curve%driven%drives(size(curve%held)))
         if (drive%kind == drive_x) value = value + curve%closure%origin(1)
         if (drive%kind == drive_y) value = value + curve%closure%origin(2)
      end associate
   end function drive_value

   !> Converts the position (3, links) of links to the deck's unit, counted from the origin of the curve.
   pure function deck_position(curve, places) result(position)
      type(curve_t), intent(in) :: curve     !< of the position
      real(wp), intent(in) :: places(:, :)   !< (3, links) x and y in lengths of the curve, phi in rad
      real(wp) :: position(3, size(places, 2))

      position = places
      position(:2, :) = places(:2, :)*curve%closure%length
   end function deck_position

   !> Finds the point of the curve at a position of the links. Its tangent has the sense in which the drive grows,
   !> unless the drive is at rest.
   subroutine start_point(curve, position, point, ok)
      type(curve_t), intent(inout) :: curve   !< gets the configuration of the point
      real(wp), intent(in) :: position(:, :)   !< (3, links) x and y in the deck's unit from the origin, phi in rad
      type(curve_point_t), intent(out) :: point   !< with a certified step; undefined unless `ok`
      logical, intent(out) :: ok             !< the point was found, and is regular
      real(wp) :: q(3, size(position, 2)), border(curve%closure%n)
      integer :: i

      q = position
      q(:2, :) = q(:2, :)/curve%closure%length
      ! A row without a meaning, which hardly ever is at right angles to the tangent.
      border = [(cos(real(i, wp)), i=1, size(border))]
      call find_point(curve, q, border/norm2(border), point, ok)
      if (.not. ok) return
      if (point%value(of_slope) < 0.0_wp) point = reversed(point)
   end subroutine start_point

   !> Finds the point of the curve at a distance from a point along its tangent.
   subroutine step_along(curve, from, step, to, ok)
      type(curve_t), intent(inout) :: curve   !< gets the configuration of `to`
      type(curve_point_t), intent(in) :: from   !< the known point
      real(wp), intent(in) :: step           !< the distance, rad and lengths of the curve
      type(curve_point_t), intent(out) :: to   !< the point that is found; of no use unless `ok`
      logical, intent(out) :: ok             !< `to` is regular, and near the place that tangent and bend predict
      real(wp) :: q(3, size(from%q, 2))

      q = from%q
      call add_to_links(curve%closure, step*from%tangent + 0.5_wp*step**2*from%bend, q)
      call find_point(curve, q, from%tangent, to, ok)
      if (ok) ok = maxval(abs(to%q - q)) <= max(same_position_tolerance, 0.5_wp*abs(step))
   end subroutine step_along

   !> Gives a point with the opposite tangent.
   pure function reversed(point) result(r)
      type(curve_point_t), intent(in) :: point   !< any point of a curve
      type(curve_point_t) :: r

      r = point
      r%tangent = -point%tangent
      r%value(of_slope) = -point%value(of_slope)
   end function reversed

   !> Gives the distance of two points along the tangent of the first, in rad and lengths of the curve.
   pure real(wp) function step_between(curve, from, to) result(h)
      type(curve_t), intent(in) :: curve     !< of both points
      type(curve_point_t), intent(in) :: from, to   !< the first and the second point

      h = dot_product(from%tangent, offset_from(curve, from%q, to%q, .false.))
   end function step_between

   !> Finds whether a position is on the curve within a step from a point, or near the ends of the step. Whole turns of
   !> links do not count.
   subroutine lies_between(curve, from, step, position, to, lies)
      type(curve_t), intent(inout) :: curve   !< gets the configuration of `to`
      type(curve_point_t), intent(in) :: from   !< the point at which the step begins
      real(wp), intent(in) :: step           !< along the tangent of `from`, rad and lengths of the curve
      real(wp), intent(in) :: position(:, :)   !< (3, links) x and y in lengths of the curve, phi in rad
      type(curve_point_t), intent(out) :: to   !< the point of the curve at the position, if `lies`
      logical, intent(out) :: lies           !< the position is there
      real(wp) :: x(curve%closure%n), along

      x = offset_from(curve, from%q, position, .true.)
      along = dot_product(from%tangent, x)
      lies = along >= -same_position_tolerance .and. along <= step + same_position_tolerance
      if (lies) lies = maxval(abs(x - along*from%tangent)) <= step + same_position_tolerance
      if (lies) call step_along(curve, from, along, to, lies)
      if (lies) lies = same_place(to%q, position)
   end subroutine lies_between

   !> Gives the difference (coordinates) of two positions, in rad and lengths of the curve.
   pure function offset_from(curve, first, second, turns_off) result(x)
      type(curve_t), intent(in) :: curve     !< of both positions
      real(wp), intent(in) :: first(:, :), second(:, :)   !< (3, links) the first is subtracted from the second
      logical, intent(in) :: turns_off       !< whole turns of links do not count
      real(wp) :: x(curve%closure%n)
      integer :: i

      do i = 1, size(first, 2)
         associate (k => curve%closure%column(i))
            if (k == 0) cycle
            x(k:k + 2) = second(:, i) - first(:, i)
            if (turns_off) x(k + 2) = wrap_angle(x(k + 2))
         end associate
      end do
   end function offset_from

   !> Tells whether two positions are one, but for whole turns.
   pure logical function same_place(first, second)
      real(wp), intent(in) :: first(:, :), second(:, :)   !< (3, links) in lengths of the curve and rad

      same_place = maxval(separation(first, second, 1.0_wp)) <= same_position_tolerance
   end function same_place

   !> Finds the shortest length of a cylinder at a position, in the deck's unit.
   pure real(wp) function shortest(curve, places)
      type(curve_t), intent(in) :: curve     !< with at least one cylinder
      real(wp), intent(in) :: places(:, :)   !< (3, links) x and y in lengths of the curve, phi in rad
      real(wp) :: position(3, size(places, 2))
      integer :: k

      position = deck_position(curve, places)
      shortest = minval([(cylinder_length(curve%cylinders(k), position(:, curve%cylinders(k)%i), &
         position(:, curve%cylinders(k)%j)), k=1, size(curve%cylinders))])
   end function shortest

   !> Finds the point near a position at which `border` times the difference from the position is 0. Its tangent has the
   !> sense of `border`.
   subroutine find_point(curve, position, border, point, ok)
      type(curve_t), intent(inout) :: curve   !< gets the configuration of the point
      real(wp), intent(in) :: position(:, :)   !< (3, links) x and y in lengths of the curve, phi in rad
      real(wp), intent(in) :: border(:)      !< (coordinates) a row of rad and lengths
      type(curve_point_t), intent(out) :: point   !< in lengths of the curve; of no use unless `ok`
      logical, intent(out) :: ok             !< the point was found, and is regular
      real(wp) :: x(curve%closure%n), row(curve%closure%n), along(3, size(position, 2))

      curve%configuration%q = position
      call set_configuration(curve%closure, curve%configuration)
      call correct(curve, border, row, ok)
      if (.not. ok) return
      point%q = curve%configuration%q

      x = 0.0_wp
      x(curve%closure%n) = 1.0_wp
      call solve(curve%factors, x)
      point%tangent = x/norm2(x)

      along = 0.0_wp
      call add_to_links(curve%closure, point%tangent, along)
      call remainder(curve%driven, curve%configuration, along, x)
      point%value(of_bend) = x(curve%closure%n)
      x(curve%closure%n) = 0.0_wp
      call solve(curve%factors, x)
      point%bend = dot_product(point%tangent, x)*point%tangent - x

      call residual(curve%driven, curve%configuration, curve%held, x)
      point%value(of_value) = x(curve%closure%n)
      point%value(of_slope) = dot_product(row, point%tangent)
      point%value(of_bend) = point%value(of_bend) + dot_product(row, point%bend)
      point%value(of_size) = maxval(abs(point%q(:2, :)))
      if (size(curve%cylinders) > 0) point%value(of_cylinder) = shortest(curve, point%q)
      call find_certified_step(curve, along, point)
   end subroutine find_point

   !> Finds the longest certified step at a point, and the room about it, both in rad and lengths of the curve.
   !>
   !> With the bend b a step h to q + h t + h^2 b/2 leaves B^-1 F below e = h^3 (D |b|/2 + K |t|^3/4). B^-1 B has
   !> changed there by D h + K (|t|^2 + |b|/2) h^2 at most. If the sum of this and 2 K e is below 1/2, B is regular
   !> within 2 e of that place. One solution is there.
   subroutine find_certified_step(curve, along, point)
      type(curve_t), intent(inout) :: curve   !< with configuration and factors of the point
      real(wp), intent(in) :: along(:, :)    !< (3, links) the tangent of the point
      type(curve_point_t), intent(inout) :: point   !< gets `certified_step` and `room`
      real(wp), allocatable :: y(:, :)
      real(wp) :: k, change, speed, bend, powers(3), least

      call measure_slides(curve%closure, curve%configuration, curve%nonlinear)
      y = forms_by_inverse(curve%nonlinear, curve%factors, point%tangent)
      k = kantorovich(curve%closure, curve%nonlinear, y, curve%configuration)
      change = change_along(curve%closure, curve%nonlinear, y, curve%configuration, along)
      speed = distance(curve%nonlinear, point%tangent)
      bend = distance(curve%nonlinear, point%bend)
      ! If nothing turns, a step is as long as the largest coordinate.
      least = 1.0_wp/max(1.0_wp, point%value(of_size))

      powers = [change, k*(speed**2 + 0.5_wp*bend), k*(change*bend + 0.5_wp*k*speed**3)]/certified_bound
      ! The sum of powers(i) h^i is 1 at most.
      point%certified_step = 1.0_wp/max(speed/max_step, powers(1) + sqrt(powers(2)) + powers(3)**(1.0_wp/3.0_wp), least)
      point%room = 1.0_wp/max(speed/max_step, speed*k/certified_bound, least)
   end subroutine find_certified_step
end module circuit_curve
