!> How the closure equations change, to first order, with the numbers of a mechanism and with what is known already of
!> the changes of its unknowns: exactly, with their first two derivatives with respect to time.
!>
!> Equations are taken as sums of points and slides along their loops, not of the body vectors of the blocks: there
!> vectors that cancel are left out, which need not cancel after the change.
module equation_changes
   use kinds, only: wp
   use planar, only: direction, rotated
   use jets, only: turning, turning_change, scaled, dotted, turned
   use mechanism, only: mechanism_t, pair_revolute, drive_angle, drive_relangle, drive_x, drive_y
   use number_changes, only: change_t
   use links_tree, only: tree_t
   use loop_equations, only: equations_t
   use blocks, only: row_t
   use block_engine, only: block_engine_t
   implicit none
   private
   public :: response_t, pair_residual, drive_residual, find_arm, find_gap, arm_change, angle_change, root_unknown, &
      unit_of

   !> Lengths are in the deck's unit. Of each change, value, rate and acceleration.
   type :: response_t
      type(tree_t) :: tree
      type(equations_t) :: equations             !< with the terms of their loops
      integer, allocatable :: loop_of_pair(:), loop_of_drive(:)   !< 0: it closes none
      type(change_t), allocatable :: changes(:)  !< (directions)
      real(wp), allocatable :: angle(:, :)       !< (links, directions) of its angle from that of its orientation
      real(wp), allocatable :: u(:, :, :)        !< (0:2, 0:unknowns, directions)
      real(wp), allocatable :: links(:, :, :, :) !< (3, 0:2, links, directions) of x, y, phi
      integer, allocatable :: missing(:)         !< (0:unknowns) missing_nothing, or missing_all
      logical, allocatable :: jams(:)            !< (directions) redundant equations contradict one another by it
   end type response_t

contains

   !> The unit of unknown `u` in the deck's: 1 of an angle.
   pure real(wp) function unit_of(e, u)
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: u

      unit_of = 1.0_wp
      if (u > e%blocks%orientations) unit_of = e%length*e%blocks%unit(u)
   end function unit_of

   !> The change (0:2) of the equation `row` of a pair: component `axis` of P - Q of a revolute pair; (P - Q) . n - h,
   !> or phi_j - phi_i - beta, of a prismatic pair.
   function pair_residual(r, m, e, row, axis, d) result(change)
      type(response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      type(row_t), intent(in) :: row
      integer, intent(in) :: axis, d
      real(wp) :: change(0:2), g(2, 0:2), dg(2, 0:2), a(2, 0:2), da(2, 0:2)

      associate (pair => m%pairs(row%pair), dp => r%changes(d)%pair(:, row%pair))
         if (row%angular) then
            change = angle_change(r, m%points(pair%point_j)%link, d) - angle_change(r, m%points(pair%point_i)%link, d)
            change(0) = change(0) - dp(3)
            return
         end if
         call find_loop(r, m, e, r%loop_of_pair(row%pair), d, g, dg)
         if (pair%kind == pair_revolute) then
            change = dg(axis, :)
         else
            call find_guide(r, m, e, row%pair, d, a, da)
            change = dotted(dg, turned(a)) + dotted(g, turned(da))
            change(0) = change(0) - dp(2)
         end if
      end associate
   end function pair_residual

   !> The change (0:2) of what drive number `k` gives.
   function drive_residual(r, m, e, k, d) result(change)
      type(response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: k, d
      real(wp) :: change(0:2), g(2, 0:2), dg(2, 0:2), a(2, 0:2), da(2, 0:2)

      associate (i => m%drives(k)%subject)
         select case (m%drives(k)%kind)
         case (drive_angle)
            change = angle_change(r, i, d)
         case (drive_relangle)
            change = angle_change(r, m%drives(k)%second, d) - angle_change(r, i, d)
         case (drive_x, drive_y)
            call find_loop(r, m, e, r%loop_of_drive(k), d, g, dg)
            associate (axis => merge(1, 2, m%drives(k)%kind == drive_x), root => r%tree%root(m%points(i)%link))
               change = dg(axis, :)
               if (root > 0) change = change + r%u(:, root_unknown(r, root) + axis - 1, d)
            end associate
         case default
            if (r%tree%slide(i) > 0) then
               change = r%u(:, r%tree%orientations + r%tree%slide(i), d)
            else
               call find_loop(r, m, e, r%loop_of_drive(k), d, g, dg)
               call find_guide(r, m, e, i, d, a, da)
               change = -(dotted(dg, a) + dotted(g, da))
            end if
         end select
      end associate
   end function drive_residual

   !> The unknown that is x of the root of part `root` of the tree; y is the next.
   pure integer function root_unknown(r, root)
      type(response_t), intent(in) :: r
      integer, intent(in) :: root

      root_unknown = r%tree%orientations + r%tree%slides + 2*root - 1
   end function root_unknown

   !> Loop number `k` of the equations, `g` (2, 0:2), and its change `dg` in direction `d`.
   subroutine find_loop(r, m, e, k, d, g, dg)
      type(response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: k, d
      real(wp), intent(out) :: g(2, 0:2), dg(2, 0:2)
      real(wp) :: x(2, 0:2), dx(2, 0:2)
      integer :: i

      g = 0.0_wp
      dg = 0.0_wp
      associate (first => r%equations%vector_loops%first_term, terms => r%equations%vector_loops%terms)
         do i = first(k), first(k + 1) - 1
            if (terms(1, i) /= 0) then
               call find_arm(r, m, e, abs(terms(1, i)), d, x, dx)
            else
               call find_gap(r, m, e, abs(terms(2, i)), d, x, dx)
            end if
            g = g + sign(1, sum(terms(:, i)))*x
            dg = dg + sign(1, sum(terms(:, i)))*dx
         end do
      end associate
   end subroutine find_loop

   !> Point number `i` from the origin of its link, or its place if that is ground: `x` (2, 0:2) and its change.
   subroutine find_arm(r, m, e, i, d, x, dx)
      type(response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: i, d
      real(wp), intent(out) :: x(2, 0:2), dx(2, 0:2)
      real(wp) :: f(0:2)

      associate (link => m%points(i)%link)
         f = angle_of(r, e, link)
         x = turning(rotated(m%points(i)%offset, direction(f(0))), f)
         dx = arm_change(m%points(i)%offset, r%changes(d)%point(:, i), f, angle_change(r, link, d))
         if (.not. m%links(link)%ground) return
         x(:, 0) = x(:, 0) + m%links(link)%position(:2)
         dx(:, 0) = dx(:, 0) + r%changes(d)%ground(:2, link)
      end associate
   end subroutine find_arm

   !> The change (2, 0:2) of the point at `offset` from the origin of its link, which changes by `d_offset` in the
   !> link's own axes; the angle `f` (0:2) of the link changes by `df`.
   pure function arm_change(offset, d_offset, f, df) result(dx)
      real(wp), intent(in) :: offset(2), d_offset(2), f(0:2), df(0:2)
      real(wp) :: dx(2, 0:2)

      associate (e => direction(f(0)))
         dx = turning_change(rotated(offset, e), rotated(d_offset, e), f, df)
      end associate
   end function arm_change

   !> P - Q = h n - s e of prismatic pair number `k`: `x` (2, 0:2) and its change.
   subroutine find_gap(r, m, e, k, d, x, dx)
      type(response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: k, d
      real(wp), intent(out) :: x(2, 0:2), dx(2, 0:2)
      real(wp) :: a(2, 0:2), da(2, 0:2), s(0:2)

      call find_guide(r, m, e, k, d, a, da)
      associate (u => r%tree%orientations + r%tree%slide(k), h => m%pairs(k)%offset, dh => r%changes(d)%pair(2, k))
         associate (slide => e%state%u(u))
            s = unit_of(e, u)*[slide%value, slide%rate, slide%acceleration]
         end associate
         x = h*turned(a) - scaled(s, a)
         dx = dh*turned(a) + h*turned(da) - scaled(r%u(:, u, d), a) - scaled(s, da)
      end associate
   end subroutine find_gap

   !> The direction `a` (2, 0:2) of the guide of prismatic pair number `k`, and its change.
   subroutine find_guide(r, m, e, k, d, a, da)
      type(response_t), intent(in) :: r
      type(mechanism_t), intent(in) :: m
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: k, d
      real(wp), intent(out) :: a(2, 0:2), da(2, 0:2)
      real(wp) :: f(0:2), df(0:2), w(2)

      associate (link => m%points(m%pairs(k)%point_i)%link)
         f = angle_of(r, e, link)
         df = angle_change(r, link, d)
      end associate
      df(0) = df(0) + r%changes(d)%pair(1, k)
      w = direction(f(0) + m%pairs(k)%alpha)
      a = turning(w, f)
      da = turning_change(w, [0.0_wp, 0.0_wp], f, df)
   end subroutine find_guide

   !> The angle (0:2) of `link`.
   pure function angle_of(r, e, link) result(f)
      type(response_t), intent(in) :: r
      type(block_engine_t), intent(in) :: e
      integer, intent(in) :: link
      real(wp) :: f(0:2)

      associate (u => e%state%u(r%tree%orientation(link)))
         f = [u%value + r%tree%angle_offset(link), u%rate, u%acceleration]
      end associate
   end function angle_of

   !> Its change (0:2).
   pure function angle_change(r, link, d) result(df)
      type(response_t), intent(in) :: r
      integer, intent(in) :: link, d
      real(wp) :: df(0:2)

      df = r%u(:, r%tree%orientation(link), d)
      df(0) = df(0) + r%angle(link, d)
   end function angle_change
end module equation_changes
