!> Cylinders: prismatic pairs whose slide is a length above 0, within a stroke or without one.
module cylinders
   use kinds, only: wp
   use plane_vectors, only: direction, rotated, point_of, add_rotating
   use mechanism, only: mechanism_t
   use instant_centres, only: seen_from
   use drawn_lengths, only: rounded => same_place_tolerance
   implicit none
   private
   public :: cylinder_t, cylinders_of, cylinder_length, cylinder_motion, stays_within, is_out_of_stroke

   !> A cylinder. Lengths are in the deck's unit.
   type :: cylinder_t
      integer :: pair = 0                    !< its number
      integer :: i = 0, j = 0                !< the numbers of its links
      real(wp) :: p(2) = 0.0_wp, q(2) = 0.0_wp   !< points P of link i and Q of link j, in the axes of their links
      real(wp) :: along(2) = 0.0_wp          !< unit vector from P along the guide, in the axes of link i
      real(wp) :: stroke(2) = [0.0_wp, huge(1.0_wp)]   !< its least and greatest length
      real(wp) :: bounds(2) = [0.0_wp, huge(1.0_wp)]   !< its length stays between them in a motion
   end type cylinder_t

contains

   !> Finds the cylinders (any number) of a mechanism.
   pure function cylinders_of(m, by_stroke) result(list)
      type(mechanism_t), intent(in) :: m
      logical, intent(in) :: by_stroke       !< strokes bound the lengths; otherwise lengths are only above 0
      type(cylinder_t), allocatable :: list(:)
      integer :: k

      allocate (list(0))
      do k = 1, size(m%pairs)
         if (.not. m%pairs(k)%is_cylinder) cycle
         associate (pair => m%pairs(k), p => m%points(m%pairs(k)%point_i), q => m%points(m%pairs(k)%point_j))
            list = [list, cylinder_t(k, p%link, q%link, p%offset, q%offset, direction(pair%alpha), &
               pair%stroke)]
            if (by_stroke) list(size(list))%bounds = pair%stroke
         end associate
      end do
   end function cylinders_of

   !> Finds the length of a cylinder: the slide from P to Q, in the deck's unit; below 0 if Q lies on the other side of
   !> P.
   pure real(wp) function cylinder_length(one, link_i, link_j) result(length)
      type(cylinder_t), intent(in) :: one    !< the cylinder
      real(wp), intent(in) :: link_i(3), link_j(3)     !< x, y (length), phi (rad) of links i and j

      length = dot_product(rotated(one%along, direction(link_i(3))), point_of(link_j, one%q) - point_of(link_i, one%p))
   end function cylinder_length

   !> Finds the length of a cylinder with its first two derivatives by time (0:2), in the deck's units.
   pure function cylinder_motion(one, link_i, link_j) result(length)
      type(cylinder_t), intent(in) :: one    !< the cylinder
      real(wp), intent(in) :: link_i(3, 0:2), link_j(3, 0:2) !< x, y (length), phi (rad) of the links; derivatives
      real(wp) :: length(0:2), q(2, 0:2), r(2, 0:2), pin_offset(2)

      q = link_j(:2, :)
      pin_offset = rotated(one%q, direction(link_j(3, 0)))
      call add_rotating(pin_offset(1), pin_offset(2), link_j(3, 1), link_j(3, 2), q(:, 0), q(:, 1), q(:, 2))
      r = seen_from(link_i, q)
      r(:, 0) = r(:, 0) - one%p
      length = matmul(one%along, r)
   end function cylinder_motion

   !> Tells whether the length of a cylinder stays within bounds from one instant to another, but for rounding: a
   !> cylinder may be drawn or fixed at an end of its stroke. The motion between the instants is taken as the cubic with
   !> the lengths and rates of both.
   pure logical function stays_within(bounds, first, last, time) result(stays)
      real(wp), intent(in) :: bounds(2)      !< least and greatest length, in the deck's unit
      real(wp), intent(in) :: first(0:1), last(0:1)   !< length and its rate at the first and at the last instant
      real(wp), intent(in) :: time           !< from the first to the last instant, in the deck's unit
      real(wp) :: c(0:3), u(2), discriminant
      integer :: k

      stays = last(0)*(1.0_wp + rounded) > bounds(1) .and. last(0)*(1.0_wp - rounded) < bounds(2)
      if (.not. stays) return
      c = [first(0), time*first(1), 3.0_wp*(last(0) - first(0)) - time*(2.0_wp*first(1) + last(1)), &
         2.0_wp*(first(0) - last(0)) + time*(first(1) + last(1))]
      ! The cubic has its extremes where c1 + 2 c2 u + 3 c3 u**2 = 0, solved by the form that loses no digits.
      discriminant = c(2)**2 - 3.0_wp*c(1)*c(3)
      if (discriminant < 0.0_wp) return
      discriminant = -(c(2) + sign(sqrt(discriminant), c(2)))
      u = -1.0_wp
      if (abs(c(3)) > 0.0_wp) u(1) = discriminant/(3.0_wp*c(3))
      if (abs(discriminant) > 0.0_wp) u(2) = c(1)/discriminant
      do k = 1, 2
         if (.not. (u(k) > 0.0_wp .and. u(k) < 1.0_wp)) cycle
         associate (length => c(0) + u(k)*(c(1) + u(k)*(c(2) + u(k)*c(3))))
            stays = stays .and. length*(1.0_wp + rounded) > bounds(1) .and. length*(1.0_wp - rounded) < bounds(2)
         end associate
      end do
   end function stays_within

   !> Tells whether the length of a cylinder is beyond a stroke by more than rounding.
   pure logical function is_out_of_stroke(stroke, length) result(is)
      real(wp), intent(in) :: stroke(2)      !< least and greatest length, in the deck's unit
      real(wp), intent(in) :: length         !< of the cylinder, in the deck's unit

      is = length < stroke(1)*(1.0_wp - rounded) .or. length > stroke(2) + rounded*min(stroke(2), length)
   end function is_out_of_stroke
end module cylinders
