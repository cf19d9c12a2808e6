!> Small changes of the numbers of a mechanism: a direction in which its motion is asked to change. And how the law of a
!> drive changes with a number on one of its cards: the derivatives of value, rate and acceleration with respect to that
!> number, in closed form.
module number_changes
   use kinds, only: wp
   use planar, only: direction, rotated, quarter_turn, pi
   use mechanism, only: mechanism_t, tolerance_t, number_link, number_point, number_joint, number_pair, drive_t, &
      drive_angle, drive_relangle, drive_x, drive_y, pair_prismatic, pair_links, term_t, term_harmonic, term_power, &
      term_table, term_cycloid, term_345, term_cosine, term_parabola
   use drawn_values, only: drawn_way
   use drives, only: monomial, rise_shape, joint_width, joint_distance
   use splines, only: new_spline, spline_value
   implicit none
   private
   public :: change_t, new_change, change_of, law_change, smooth_order

   !> In the units of `mechanism_t`; changes of the laws of drives by their own numbers, which depend on the time, are
   !> apart.
   type :: change_t
      real(wp), allocatable :: ground(:, :)   !< (3, links) x, y, phi of ground links
      real(wp), allocatable :: point(:, :)    !< (2, points) xi, eta
      real(wp), allocatable :: pair(:, :)     !< (3, pairs) alpha, h, beta of prismatic pairs
      real(wp), allocatable :: drive(:)       !< (drives) values as drawn
   end type change_t

contains

   !> No change of `m`.
   pure function new_change(m) result(c)
      type(mechanism_t), intent(in) :: m
      type(change_t) :: c

      allocate (c%ground(3, size(m%links)), c%point(2, size(m%points)), c%pair(3, size(m%pairs)), &
         c%drive(size(m%drives)), source=0.0_wp)
   end function new_change

   !> The change of `m` when the number of `tolerance` grows by 1.
   pure function change_of(m, tolerance) result(c)
      type(mechanism_t), intent(in) :: m
      type(tolerance_t), intent(in) :: tolerance
      type(change_t) :: c
      real(wp) :: e(2)
      integer :: i

      c = new_change(m)
      associate (k => tolerance%subject, place => tolerance%place)
         select case (tolerance%kind)
         case (number_link)
            c%ground(place, k) = 1.0_wp
         case (number_point)
            c%point(place, k) = 1.0_wp
         case (number_joint)
            ! Its place in the drawing, seen from the axes of both links, which stand there.
            e = merge([1.0_wp, 0.0_wp], [0.0_wp, 1.0_wp], place == 1)
            do i = k, k + 1
               c%point(:, i) = rotated(e, direction(-m%links(m%points(i)%link)%position(3)))
            end do
         case (number_pair)
            c%pair(place, k) = 1.0_wp
         end select
      end associate
      if (any(m%drives%drawn) .or. any([(any(m%pairs(i)%drawn), i=1, size(m%pairs))])) call add_drawn(m, c)
   end function change_of

   !> Adds to the change `c` of `m` how the numbers that are as drawn follow it: they depend on the places of points, on
   !> the angles of ground links, and on alpha. For d = Q - P, e along the guide and n across, the slide is d . e, and h
   !> is -d . n.
   pure subroutine add_drawn(m, c)
      type(mechanism_t), intent(in) :: m
      type(change_t), intent(inout) :: c
      real(wp) :: slide(size(m%pairs)), d(2), dd(2), e(2), n(2), turn
      integer :: links(2), k

      do k = 1, size(m%pairs)
         associate (pair => m%pairs(k), dp => c%pair(:, k))
            if (pair%kind /= pair_prismatic) cycle
            links = pair_links(m, pair)
            d = drawn_way(m, pair)
            dd = place_change(pair%point_j) - place_change(pair%point_i)
            e = direction(m%links(links(1))%position(3) + pair%alpha)
            n = quarter_turn(e)
            turn = c%ground(3, links(1)) + dp(1)
            if (pair%drawn(1)) turn = dot_product(dd, n)/norm2(d)
            slide(k) = dot_product(dd, e) + turn*dot_product(d, n)
            if (pair%drawn(1)) dp(1) = turn - c%ground(3, links(1))
            if (pair%drawn(2) .and. .not. pair%drawn(1)) dp(2) = dp(2) - dot_product(dd, n) + turn*dot_product(d, e)
            if (pair%drawn(3)) dp(3) = dp(3) + c%ground(3, links(2)) - c%ground(3, links(1))
         end associate
      end do
      do k = 1, size(m%drives)
         associate (drive => m%drives(k), i => m%drives(k)%subject)
            if (.not. drive%drawn) cycle
            select case (drive%kind)
            case (drive_angle)
               c%drive(k) = c%ground(3, i)
            case (drive_relangle)
               c%drive(k) = c%ground(3, drive%second) - c%ground(3, i)
            case (drive_x, drive_y)
               dd = place_change(i)
               c%drive(k) = merge(dd(1), dd(2), drive%kind == drive_x)
            case default
               c%drive(k) = slide(i)
            end select
         end associate
      end do

   contains

      !> The change (2) of the place of point number `i` in the drawing.
      pure function place_change(i) result(dp)
         integer, intent(in) :: i
         real(wp) :: dp(2)

         associate (link => m%points(i)%link, phi => m%links(m%points(i)%link)%position(3))
            dp = c%ground(:2, link) + rotated(c%point(:, i), direction(phi)) &
               + c%ground(3, link)*quarter_turn(rotated(m%points(i)%offset, direction(phi)))
         end associate
      end function place_change
   end subroutine add_drawn

   !> d/dp of value, rate and acceleration (3) of the law of `drive` at the time `t`, in its unit (length or rad), that
   !> of p and the deck's unit of time. p: number `place` (1 to 3) of the DRIVE card (`term` 0) or of the card of a
   !> term; of a table the value in row `place`. Where a derivative jumps it is that from the right.
   function law_change(drive, term, place, t) result(f)
      type(drive_t), intent(in) :: drive
      integer, intent(in) :: term, place
      real(wp), intent(in) :: t
      real(wp) :: f(3)

      if (term == 0) then
         select case (place)
         case (1)
            f = [1.0_wp, 0.0_wp, 0.0_wp]
         case (2)
            f = [t, 1.0_wp, 0.0_wp]
         case default
            f = [t**2/2.0_wp, t, 1.0_wp]
         end select
         return
      end if
      associate (one => drive%terms(term))
         select case (one%kind)
         case (term_harmonic)
            f = harmonic_change(one%r, place, t)
         case (term_power)
            f = powers(one%r(2), t)
         case (term_table)
            f = row_change(one, place, t)
         case default
            f = rise_change(one, place, t)
         end select
      end associate
   end function law_change

   !> t**p and its derivatives.
   pure function powers(p, t) result(f)
      real(wp), intent(in) :: p, t
      real(wp) :: f(3)

      f = [monomial(1.0_wp, p, t), monomial(p, p - 1.0_wp, t), monomial(p*(p - 1.0_wp), p - 2.0_wp, t)]
   end function powers

   !> Of r1 sin(r2 t + r3): with respect to r3 it is r1 cos; with respect to r2 that times t, by the product rule.
   pure function harmonic_change(r, place, t) result(f)
      real(wp), intent(in) :: r(3), t
      integer, intent(in) :: place
      real(wp) :: f(3), s, c, w

      s = sin(r(2)*t + r(3))
      c = cos(r(2)*t + r(3))
      w = r(2)
      select case (place)
      case (1)
         f = [s, w*c, -w**2*s]
      case (2)
         f = r(1)*[t*c, c - w*t*s, -w*(2.0_wp*s + w*t*c)]
      case default
         f = r(1)*[c, -w*s, -w**2*c]
      end select
   end function harmonic_change

   !> A natural spline is linear in its values: the spline through 1 in this row and 0 in the others.
   function row_change(term, row, t) result(f)
      type(term_t), intent(in) :: term
      integer, intent(in) :: row
      real(wp), intent(in) :: t
      real(wp) :: f(3), values(size(term%knots))

      values = 0.0_wp
      values(row) = 1.0_wp
      f = spline_value(new_spline(term%knots, values), t)
   end function row_change

   !> Of lift s(u), u = (t - start)/duration.
   pure function rise_change(term, place, t) result(f)
      type(term_t), intent(in) :: term
      integer, intent(in) :: place
      real(wp), intent(in) :: t
      real(wp) :: f(3), u, s(0:3)

      u = (t - term%r(1))/term%r(2)
      s(:2) = rise_shape(term%kind, u, u + joint_width(term))
      s(3) = third(term%kind, u)
      associate (unit => [1.0_wp, term%r(2), term%r(2)**2])
         select case (place)
         case (1)
            f = -term%r(3)/term%r(2)*s(1:)/unit
         case (2)
            f = -term%r(3)/term%r(2)*[u*s(1), s(1) + u*s(2), 2.0_wp*s(2) + u*s(3)]/unit
         case default
            f = s(:2)/unit
         end select
      end associate
   end function rise_change

   !> s'''(u) of the law `kind`, from the right.
   pure real(wp) function third(kind, u)
      integer, intent(in) :: kind
      real(wp), intent(in) :: u

      third = 0.0_wp
      if (u < 0.0_wp .or. u >= 1.0_wp) return
      select case (kind)
      case (term_cycloid)
         third = 4.0_wp*pi**2*cos(2.0_wp*pi*u)
      case (term_345)
         third = 60.0_wp*(1.0_wp - 6.0_wp*u*(1.0_wp - u))
      case (term_cosine)
         third = -0.5_wp*pi**3*sin(pi*u)
      end select
   end function third

   !> The highest derivative with respect to time, 0 to 2, whose own derivative with respect to a number, as in
   !> `law_change`, exists at the time `t`. At a joint of a rise the third derivative jumps, or the second: if the joint
   !> moves, the acceleration, or the velocity, of this instant has different derivatives to either side.
   pure integer function smooth_order(drive, term, place, t) result(order)
      type(drive_t), intent(in) :: drive
      integer, intent(in) :: term, place
      real(wp), intent(in) :: t
      real(wp) :: u

      order = 2
      if (term == 0) return
      associate (one => drive%terms(term))
         if (one%kind < term_cycloid .or. place == 3) return
         u = (t - one%r(1))/one%r(2)
         if (min(abs(u), abs(u - 1.0_wp)) > joint_distance(one) &
            .and. .not. (one%kind == term_parabola .and. abs(u - 0.5_wp) <= joint_distance(one))) return
         order = merge(1, 0, one%kind < term_cosine)
      end associate
   end function smooth_order
end module number_changes
