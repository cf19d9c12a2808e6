!> The deck's rough positions as values of the tree's unknowns: where the first search begins.
module estimated_positions
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use links_tree, only: tree_t
   use estimated_angles, only: estimated_directions
   implicit none
   private
   public :: estimated_values

contains

   !> Values (0:unknowns) of angles and slides, lengths in units of `length`.
   function estimated_values(m, t, length, unknowns) result(value)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: unknowns
      real(wp) :: value(0:unknowns)
      real(wp) :: phi(size(m%links))
      integer :: i, u

      value = 0.0_wp
      phi = estimated_directions(m, t)
      do i = size(m%links), 1, -1
         if (t%orientation(i) > 0) value(t%orientation(i)) = phi(i) - t%angle_offset(i)
         if (t%root(i) == 0 .or. t%parent(i) > 0) cycle
         u = t%orientations + t%slides + 2*t%root(i) - 1
         value(u:u + 1) = (m%links(i)%position(:2) - t%origin)/length
      end do
      do i = 1, size(m%pairs)
         if (t%slide(i) > 0) value(t%orientations + t%slide(i)) = estimated_slide(m, i, phi)/length
      end do
   end function estimated_values

   !> The slide of prismatic pair `i`, in the deck's unit.
   pure real(wp) function estimated_slide(m, i, phi) result(slide)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      real(wp), intent(in) :: phi(:)
      real(wp) :: closure_error(2), angle

      closure_error = estimated_place(m, m%pairs(i)%point_j, phi) - estimated_place(m, m%pairs(i)%point_i, phi)
      angle = phi(m%points(m%pairs(i)%point_i)%link) + m%pairs(i)%alpha
      slide = closure_error(1)*cos(angle) + closure_error(2)*sin(angle)
   end function estimated_slide

   !> Where point `i` is with its link at the deck's place and the angle of `phi` (links).
   pure function estimated_place(m, i, phi) result(p)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      real(wp), intent(in) :: phi(:)
      real(wp) :: p(2)

      associate (q => m%links(m%points(i)%link)%position, u => m%points(i)%offset, angle => phi(m%points(i)%link))
         p = q(:2) + [u(1)*cos(angle) - u(2)*sin(angle), u(1)*sin(angle) + u(2)*cos(angle)]
      end associate
   end function estimated_place
end module estimated_positions
