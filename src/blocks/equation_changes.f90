!> How the closure equations change, to first order, with the numbers of a mechanism and with what is known already of
!> the changes of its unknowns: exactly, with their first two derivatives with respect to time.
!>
!> Equations are taken as sums of points and slides along their loops, not of the body vectors of the blocks: there
!> vectors that cancel are left out, which need not cancel after the change.
module equation_changes
   use kinds, only: wp
   use planar, only: direction, rotated, turning, turning_change, scaled, dotted, turned
   use mechanism, only: mechanism_t, pair_revolute, drive_angle, drive_relangle, drive_x, drive_y
   use number_changes, only: change_t
   use links_tree, only: tree_t, axes_t
   use loop_equations, only: equations_t
   use blocks, only: row_t
   implicit none
   private
   public :: response_t, varied_t, pair_residual, drive_residual, arm_of, gap_of, arm_change, angle_change, root_unknown

   !> A vector with its first two derivatives with respect to time, and its change.
   type :: varied_t
      real(wp) :: x(2, 0:2) = 0.0_wp, dx(2, 0:2) = 0.0_wp
   end type varied_t

   !> Lengths are in the deck's unit. Of each change, value, rate and acceleration.
   type :: response_t
      type(mechanism_t) :: m
      type(tree_t) :: tree
      type(axes_t) :: axes
      type(equations_t) :: equations             !< with the terms of their loops
      integer, allocatable :: loop_of_pair(:), loop_of_drive(:)   !< 0: it closes none
      type(change_t), allocatable :: changes(:)  !< (directions)
      real(wp), allocatable :: angle(:, :)       !< (links, directions) of its angle from that of its orientation
      real(wp), allocatable :: unit(:)           !< (0:unknowns) of a slide in the deck's; 1 of an angle
      real(wp), allocatable :: now(:, :)         !< (0:2, 0:unknowns)
      real(wp), allocatable :: u(:, :, :)        !< (0:2, 0:unknowns, directions) changes of these
      real(wp), allocatable :: links(:, :, :, :) !< (3, 0:2, links, directions) of x, y, phi
      integer, allocatable :: missing(:)         !< (0:unknowns) missing_nothing, or missing_all
      logical, allocatable :: jams(:)            !< (directions) redundant equations contradict one another by it
   end type response_t

contains

   !> The change (0:2) of the equation `row` of a pair in direction `d`: component `axis` of P - Q of a revolute pair;
   !> (P - Q) . n - h, or phi_j - phi_i - beta, of a prismatic pair.
   function pair_residual(r, row, axis, d) result(change)
      type(response_t), intent(in) :: r
      type(row_t), intent(in) :: row
      integer, intent(in) :: axis, d
      real(wp) :: change(0:2)
      type(varied_t) :: g, a

      associate (pair => r%m%pairs(row%pair), dp => r%changes(d)%pair(:, row%pair))
         if (row%angular) then
            change = angle_change(r, r%m%points(pair%point_j)%link, d) &
               - angle_change(r, r%m%points(pair%point_i)%link, d)
            change(0) = change(0) - dp(3)
            return
         end if
         g = loop_of(r, r%loop_of_pair(row%pair), d)
         if (pair%kind == pair_revolute) then
            change = g%dx(axis, :)
         else
            a = guide_of(r, row%pair, d)
            change = dotted(g%dx, turned(a%x)) + dotted(g%x, turned(a%dx))
            change(0) = change(0) - dp(2)
         end if
      end associate
   end function pair_residual

   !> The change (0:2) of what drive number `k` gives.
   function drive_residual(r, k, d) result(change)
      type(response_t), intent(in) :: r
      integer, intent(in) :: k, d
      real(wp) :: change(0:2)
      type(varied_t) :: g, a

      associate (drive => r%m%drives(k), i => r%m%drives(k)%subject)
         select case (drive%kind)
         case (drive_angle)
            change = angle_change(r, i, d)
         case (drive_relangle)
            change = angle_change(r, drive%second, d) - angle_change(r, i, d)
         case (drive_x, drive_y)
            g = loop_of(r, r%loop_of_drive(k), d)
            associate (axis => merge(1, 2, drive%kind == drive_x), root => r%tree%root(r%m%points(i)%link))
               change = g%dx(axis, :)
               if (root > 0) change = change + r%u(:, root_unknown(r, root) + axis - 1, d)
            end associate
         case default
            if (r%tree%slide(i) > 0) then
               change = r%u(:, r%tree%orientations + r%tree%slide(i), d)
            else
               g = loop_of(r, r%loop_of_drive(k), d)
               a = guide_of(r, i, d)
               change = -(dotted(g%dx, a%x) + dotted(g%x, a%dx))
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

   !> The sum of loop number `k` of the equations.
   type(varied_t) function loop_of(r, k, d) result(g)
      type(response_t), intent(in) :: r
      integer, intent(in) :: k, d
      type(varied_t) :: one
      integer :: i

      associate (first => r%equations%vector_loops%first_term, terms => r%equations%vector_loops%terms)
         do i = first(k), first(k + 1) - 1
            if (terms(1, i) /= 0) then
               one = arm_of(r, abs(terms(1, i)), d)
            else
               one = gap_of(r, abs(terms(2, i)), d)
            end if
            g%x = g%x + sign(1, sum(terms(:, i)))*one%x
            g%dx = g%dx + sign(1, sum(terms(:, i)))*one%dx
         end do
      end associate
   end function loop_of

   !> Point number `i` from the origin of its link, or its place if that is ground.
   type(varied_t) function arm_of(r, i, d) result(arm)
      type(response_t), intent(in) :: r
      integer, intent(in) :: i, d
      real(wp) :: f(0:2)

      associate (point => r%m%points(i), link => r%m%points(i)%link)
         f = angle_of(r, link)
         arm%x = turning(rotated(point%offset, direction(f(0))), f)
         arm%dx = arm_change(point%offset, r%changes(d)%point(:, i), f, angle_change(r, link, d))
         if (.not. r%m%links(link)%ground) return
         arm%x(:, 0) = arm%x(:, 0) + r%m%links(link)%position(:2)
         arm%dx(:, 0) = arm%dx(:, 0) + r%changes(d)%ground(:2, link)
      end associate
   end function arm_of

   !> The change (2, 0:2) of the point at `offset` from the origin of its link, which changes by `d_offset` in the
   !> link's own axes; the angle `f` (0:2) of the link changes by `df`.
   pure function arm_change(offset, d_offset, f, df) result(dx)
      real(wp), intent(in) :: offset(2), d_offset(2), f(0:2), df(0:2)
      real(wp) :: dx(2, 0:2)

      associate (e => direction(f(0)))
         dx = turning_change(rotated(offset, e), rotated(d_offset, e), f, df)
      end associate
   end function arm_change

   !> P - Q = h n - s e of prismatic pair number `k`.
   type(varied_t) function gap_of(r, k, d) result(gap)
      type(response_t), intent(in) :: r
      integer, intent(in) :: k, d
      type(varied_t) :: a

      a = guide_of(r, k, d)
      associate (u => r%tree%orientations + r%tree%slide(k), h => r%m%pairs(k)%offset, dh => r%changes(d)%pair(2, k))
         gap%x = h*turned(a%x) - scaled(r%now(:, u), a%x)
         gap%dx = dh*turned(a%x) + h*turned(a%dx) - scaled(r%u(:, u, d), a%x) - scaled(r%now(:, u), a%dx)
      end associate
   end function gap_of

   !> The direction of the guide of prismatic pair number `k`.
   type(varied_t) function guide_of(r, k, d) result(a)
      type(response_t), intent(in) :: r
      integer, intent(in) :: k, d
      real(wp) :: f(0:2), df(0:2), w(2)

      associate (link => r%m%points(r%m%pairs(k)%point_i)%link)
         f = angle_of(r, link)
         df = angle_change(r, link, d)
      end associate
      df(0) = df(0) + r%changes(d)%pair(1, k)
      w = direction(f(0) + r%m%pairs(k)%alpha)
      a%x = turning(w, f)
      a%dx = turning_change(w, [0.0_wp, 0.0_wp], f, df)
   end function guide_of

   !> The angle (0:2) of `link`.
   pure function angle_of(r, link) result(f)
      type(response_t), intent(in) :: r
      integer, intent(in) :: link
      real(wp) :: f(0:2)

      f = r%now(:, r%tree%orientation(link))
      f(0) = f(0) + r%axes%angle_offset(link)
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
