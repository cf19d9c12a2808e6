!> Small changes of the numbers of a mechanism: a direction in which its motion is asked to change.
module number_changes
   use kinds, only: wp
   use planar, only: direction, rotated
   use mechanism, only: mechanism_t, tolerance_t, number_ground, number_point, number_joint, number_pair
   implicit none
   private
   public :: change_t, new_change, change_of

   !> In the units of `mechanism_t`; those of the laws of drives, which depend on the time, are apart.
   type :: change_t
      real(wp), allocatable :: ground(:, :)   !< (3, links) x, y, phi of ground links
      real(wp), allocatable :: point(:, :)    !< (2, points) xi, eta
      real(wp), allocatable :: pair(:, :)     !< (3, pairs) alpha, h, beta of prismatic pairs
   end type change_t

contains

   !> No change of `m`.
   pure function new_change(m) result(c)
      type(mechanism_t), intent(in) :: m
      type(change_t) :: c

      allocate (c%ground(3, size(m%links)), c%point(2, size(m%points)), c%pair(3, size(m%pairs)), source=0.0_wp)
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
         case (number_ground)
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
   end function change_of
end module number_changes
