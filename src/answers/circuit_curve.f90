!> The curve of all positions of a mechanism whose one drive is set free: its points, and steps from one to another.
!>
!> With the tangent t as one more row the Jacobian B = (F_q, t) of the equations is regular at dead points too; it is
!> singular at change points alone. K of `root_distance`, taken from B, bounds how fast B^-1 B changes: along t, up to
!> the distance u/K in the coordinates in which the equations are not linear, Newton and Kantorovich's ratio is at most
!> (u/(1 - u))^2/2. For u < 1/2 the curve beside each place of t is unique: a step of that length cannot jump to another
!> circuit.
module circuit_curve
   use kinds, only: wp
   use planar, only: without_turns
   use linear_solver, only: solve, determinant_sign
   use pose, only: add_to_links
   use closure_equations, only: drive_residual, drive_row, drive_remainder
   use root_distance, only: kantorovich, distance, measure_slots
   use curve_equations, only: curve_t, is_redundant, move_to, correct, factor_with, second_derivative, largest_change
   implicit none
   private
   public :: curve_point_t, start_point, find_point, step_along, step_between, lies_between, beside, offset_from, &
      same_place

   !> u of above, less than 1/2: K of slides is taken at the start of a step, and they grow.
   real(wp), parameter :: certified = 0.25_wp
   !> The longest step, in rad and lengths, and in parts of a longer slide: a curve of such pieces looks smooth.
   real(wp), parameter :: max_step = 0.1_wp
   !> Two positions are one up to this difference, in rad and lengths.
   real(wp), parameter :: same = max(1.0e-7_wp, 1.0e2_wp*epsilon(1.0_wp))
   !> A position off the curve by less than this part of the certified step is on it, for the curve is unique there:
   !> rounding of the dimensions, where equations are too many, makes the positions differ by more than `same`.
   real(wp), parameter :: unique = 0.1_wp
   !> Equations that are too many let the mechanism move where they change by less along the curve.
   real(wp), parameter :: moves = sqrt(same)

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

   !> The point `p` of the curve at the links' `position` (3, links), in the deck's unit and from its origin. Its
   !> tangent has the sense in which the drive grows, unless it is at rest. `ok`: it was found, and is regular.
   subroutine start_point(c, position, p, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: position(:, :)
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok
      real(wp) :: row(1, c%closure%n), q(3, size(position, 2)), along(c%closure%n)

      q = position
      q(:2, :) = q(:2, :)/c%closure%length
      row = 0.0_wp
      call move_to(c, q, row(1, :), along)
      call drive_row(c%driven, c%pose, 1, row, 1)
      call find_point(c, q, sign(1.0_wp, dot_product(row(1, :), along))*along, p, ok)
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

   !> The distance from `a` to `b` along the tangent of `a`.
   pure real(wp) function step_between(c, a, b) result(h)
      type(curve_t), intent(in) :: c
      type(curve_point_t), intent(in) :: a, b

      h = dot_product(a%tangent, offset_from(c, a%q, b%q, .false.))
   end function step_between

   !> A position so far from the curve beside its point `a` is on it, in rad and lengths.
   pure elemental real(wp) function beside(a)
      type(curve_point_t), intent(in) :: a

      beside = max(same, unique*a%reach)
   end function beside

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
      lies = along >= -same .and. along <= h + beside(a)
      if (lies) lies = maxval(abs(x - along*a%tangent)) <= h + beside(a)
      if (lies) call step_along(c, a, along, b, lies)
      if (lies) lies = maxval(abs(offset_from(c, b%q, q, .true.))) <= beside(b)
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
            if (turns_off) x(k + 2) = without_turns(x(k + 2))
         end associate
      end do
   end function offset_from

   !> Whether two positions (3, links) are one, but for whole turns.
   pure logical function same_place(c, a, b)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: a(:, :), b(:, :)

      same_place = maxval(abs(offset_from(c, a, b, .true.))) <= same
   end function same_place

   !> The point `p` near the position `q` (3, links) at which `border` (coordinates) times the difference from `q` is 0.
   !> Its tangent has the sense of `border`.
   subroutine find_point(c, q, border, p, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), border(:)
      type(curve_point_t), intent(out) :: p
      logical, intent(out) :: ok

      call move_to(c, q, border)
      call correct(c, border, ok)
      if (.not. ok) return
      p%q = c%pose%q
      call take_derivatives(c, border, p, ok)
   end subroutine find_point

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
      ! Equations that are too many may let nothing move.
      if (is_redundant(c)) ok = .not. largest_change(c, p%tangent) > moves
      c%is_held = c%is_held .or. .not. ok
      if (.not. ok) return
      along = 0.0_wp
      call add_to_links(c%closure, p%tangent, along)
      call second_derivative(c, p%q, p%tangent, x)
      x = -x
      call solve(c%factors, x)
      p%bend = x
      row = 0.0_wp
      call drive_row(c%driven, c%pose, 1, row, 1)
      p%value(0) = drive_residual(c%driven, c%pose, 1, 0.0_wp)
      p%value(1) = dot_product(row(1, :), p%tangent)
      p%value(2) = dot_product(row(1, :), p%bend) + drive_remainder(c%driven, c%pose, along, 1)
      call measure_slots(c%closure, c%free, c%pose)
      call kantorovich(c%closure, c%free, c%factors, c%pose, k, rows=c%row)
      speed = distance(c%closure, c%free, 0.0_wp*along, along)
      p%reach = max_step
      if (speed > 0.0_wp) p%reach = min(certified/max(k, tiny(k)), max_step)/speed
      p%sign = determinant_sign(c%factors)
   end subroutine take_derivatives
end module circuit_curve
