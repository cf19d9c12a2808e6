!> The equations of all positions of a mechanism whose one drive is set free, which are a curve (`circuit_curve`): its
!> pairs and its other drives, at rest, are one equation less than it has coordinates. Of more, those that are most
!> independent where the curve is at the moment are solved: every position of the curve satisfies them too, and what is
!> unique by them is unique by all. The others are looked at. Lengths are those of METHOD DENSE's system.
module curve_equations
   use kinds, only: wp
   use mechanism, only: mechanism_t, drive_x, drive_y
   use scales, only: is_length
   use linear_solver, only: factors_t, new_factors, factor, solve
   use pose, only: system_t, pose_t, new_system, new_pose, set_pose, add_to_links
   use closure_equations, only: residual, jacobian, remainder, find_drive_values
   use drives, only: law_t
   use root_distance, only: coordinates_t, new_coordinates
   implicit none
   private
   public :: curve_t, make_curve, is_redundant, move_to, correct, factor_with, second_derivative, largest_change, &
      drive_value, deck_position

   integer, parameter :: max_iterations = 12
   !> A correction below this is rounding, and one that no longer shrinks is so below the second one.
   real(wp), parameter :: converged = 16.0_wp*epsilon(1.0_wp), stalled = sqrt(epsilon(1.0_wp))
   !> Equations that are too many hold to this, in rad and lengths: twice what the engine allows.
   real(wp), parameter :: fits = max(2.0e-10_wp, 1.0e3_wp*epsilon(1.0_wp))

   type :: curve_t
      type(system_t) :: closure               !< all pairs, and the drives that are held
      type(system_t) :: driven                !< with the one drive that is free
      type(coordinates_t) :: free             !< in which the equations are not linear
      real(wp), allocatable :: held(:)        !< (drives held) their values
      integer, allocatable :: row(:)          !< (coordinates - 1) the equations that are solved
      logical :: is_held = .false.            !< at some position its pairs and other drives let nothing move
      logical :: is_angle = .true.            !< the free drive is that of an angle
      real(wp) :: first = 0.0_wp              !< its value at the first instant
      !> A slide is followed so many lengths, and farther only to assemblies of the first instant.
      real(wp) :: far = 100.0_wp
      type(pose_t) :: pose                    !< of the position found last
      type(factors_t) :: factors
   end type curve_t

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
      c%row = [(i, i=1, c%closure%n - 1)]
   end subroutine make_curve

   !> The equations: two of each pair, one of each drive that is held.
   pure integer function equations_of(c)
      type(curve_t), intent(in) :: c

      equations_of = 2*size(c%closure%pairs) + size(c%closure%laws)
   end function equations_of

   !> Some equations are too many, by count.
   pure logical function is_redundant(c)
      type(curve_t), intent(in) :: c

      is_redundant = equations_of(c) > c%closure%n - 1
   end function is_redundant

   !> Puts `c` at the position `q` (3, links).
   subroutine set_place(c, q)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :)

      c%pose%q = q
      call set_pose(c%closure, c%pose)
   end subroutine set_place

   !> Puts `c` at the position `q` (3, links), and chooses the equations that are solved there; `border`, `left`: see
   !> `choose_rows`.
   subroutine move_to(c, q, border, left)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), border(:)
      real(wp), intent(out), optional :: left(:)

      call set_place(c, q)
      call choose_rows(c, border, left)
   end subroutine move_to

   !> Chooses the equations that are solved: of more than are needed, one after another, that with the largest part
   !> across `border` (coordinates) and all those before it. `left` (coordinates): the direction across all of them.
   subroutine choose_rows(c, border, left)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: border(:)
      real(wp), intent(out), optional :: left(:)
      real(wp) :: a(equations_of(c) + c%closure%n, c%closure%n), across(c%closure%n)
      real(wp) :: along(equations_of(c) + c%closure%n)
      integer :: i, k, row

      if (.not. (is_redundant(c) .or. present(left))) return
      associate (m => equations_of(c))
         a(m + 1:, :) = 0.0_wp
         do i = 1, c%closure%n
            a(m + i, i) = 1.0_wp
         end do
         call jacobian(c%closure, c%pose, a(:m, :))
         across = border/max(tiny(1.0_wp), norm2(border))
         do i = 0, size(c%row)
            if (i > 0) across = a(row, :)/max(tiny(1.0_wp), norm2(a(row, :)))
            along = matmul(a, across)
            do k = 1, size(across)
               a(:, k) = a(:, k) - along*across(k)
            end do
            if (i > 0 .and. is_redundant(c)) c%row(i) = row
            row = maxloc(sum(a(:m, :)**2, dim=2), dim=1)
         end do
         row = m + maxloc(sum(a(m + 1:, :)**2, dim=2), dim=1)
      end associate
      if (present(left)) left = a(row, :)/max(tiny(1.0_wp), norm2(a(row, :)))
   end subroutine choose_rows

   !> Newton's method from `c%pose`, with the row `border` at rest.
   subroutine correct(c, border, ok)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: border(:)
      logical, intent(out) :: ok
      real(wp) :: r(c%closure%n), all_of_them(equations_of(c)), change, before
      integer :: i, info

      before = huge(before)
      do i = 1, max_iterations
         call residual(c%closure, c%pose, c%held, all_of_them)
         r = [all_of_them(c%row), 0.0_wp]
         call factor_with(c, border, info)
         ok = info == 0
         if (.not. ok) return
         call solve(c%factors, r)
         change = maxval(abs(r))
         ok = change <= 1.0_wp
         if (.not. ok) return
         call add_to_links(c%closure, -r, c%pose%q)
         call set_pose(c%closure, c%pose)
         ok = change <= converged*max(1.0_wp, maxval(abs(c%pose%q)))
         if (.not. ok) ok = change <= stalled .and. change > 0.5_wp*before
         if (ok) exit
         before = change
      end do
      ok = change <= stalled
      if (ok .and. is_redundant(c)) ok = maxval(abs(all_of_them)) <= fits
   end subroutine correct

   !> The factors of the equations' Jacobian with `border` as its last row.
   subroutine factor_with(c, border, info)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: border(:)
      integer, intent(out) :: info
      real(wp) :: a(equations_of(c), c%closure%n)

      call jacobian(c%closure, c%pose, a)
      c%factors%a(:c%closure%n - 1, :) = a(c%row, :)
      c%factors%a(c%closure%n, :) = border
      call factor(c%factors, info)
   end subroutine factor_with

   !> The second derivative (equations) of the equations at the position `q` (3, links) in the direction `x`
   !> (coordinates), which the Jacobian does not hold; 0 in the last row.
   subroutine second_derivative(c, q, x, f)
      type(curve_t), intent(inout) :: c
      real(wp), intent(in) :: q(:, :), x(:)
      real(wp), intent(out) :: f(:)
      real(wp) :: v(3, size(q, 2)), all_of_them(equations_of(c))

      call set_place(c, q)
      v = 0.0_wp
      call add_to_links(c%closure, x, v)
      call remainder(c%closure, c%pose, v, all_of_them)
      f = [all_of_them(c%row), 0.0_wp]
   end subroutine second_derivative

   !> By how much the equations, all of them, change along `tangent` (coordinates) at `c%pose`, at most.
   pure real(wp) function largest_change(c, tangent)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: tangent(:)
      real(wp) :: a(equations_of(c), c%closure%n)

      call jacobian(c%closure, c%pose, a)
      largest_change = maxval(abs(matmul(a, tangent)))
   end function largest_change

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

   !> The links' position (3, links) `q` in the deck's unit, counted from its origin.
   pure function deck_position(c, q) result(position)
      type(curve_t), intent(in) :: c
      real(wp), intent(in) :: q(:, :)
      real(wp) :: position(3, size(q, 2))

      position = q
      position(:2, :) = q(:2, :)*c%closure%length
   end function deck_position
end module curve_equations
