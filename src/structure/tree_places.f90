!> Where things are on the tree: a point in the axes of its frame, a guide's direction, and how a link hangs on
!> the link above it.
module tree_places
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_prismatic
   use links_tree, only: tree_t
   implicit none
   private
   public :: place_t, place_on_tree, point_in_drawing, guide

   !> Where a link hangs: its origin is the origin above + R(frame above) reach + s R(frame above) slide_arm
   !> - R(own frame) arm.
   type :: place_t
      real(wp) :: reach(2) = 0.0_wp, body_vector(2) = 0.0_wp, slide_body_vector(2) = 0.0_wp
      integer :: slide = 0
   end type place_t

contains

   !> How `link` hangs on the link above it.
   pure function place_on_tree(m, t, length, link) result(p)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: link
      type(place_t) :: p
      real(wp) :: sign_of

      associate (pair => m%pairs(t%parent_joint(link)))
         sign_of = merge(1.0_wp, -1.0_wp, m%points(pair%point_j)%link == link)
         p%reach = point_in_drawing(m, t, length, merge(pair%point_i, pair%point_j, sign_of > 0.0_wp))
         p%body_vector = point_in_drawing(m, t, length, merge(pair%point_j, pair%point_i, sign_of > 0.0_wp))
         if (pair%kind /= pair_prismatic) return
         p%slide = t%slide(t%parent_joint(link))
         p%slide_body_vector = sign_of*guide(m, t, t%parent_joint(link), across=.false.)
         p%reach = p%reach - sign_of*guide(m, t, t%parent_joint(link), across=.true.)*pair%offset/length
      end associate
   end function place_on_tree

   !> Direction (2) of the guide of pair `k`, or of its normal, in the axes of its frame.
   pure function guide(m, t, k, across) result(e)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      integer, intent(in) :: k
      logical, intent(in) :: across
      real(wp) :: e(2), angle

      angle = t%angle_offset(m%points(m%pairs(k)%point_i)%link) + m%pairs(k)%alpha
      e = [cos(angle), sin(angle)]
      if (across) e = [-e(2), e(1)]
   end function guide

   !> Point number `i` in the axes of its link's frame, from the link's origin; of a ground link, its place
   !> from the origin of all places.
   pure function point_in_drawing(m, t, length, i) result(v)
      type(mechanism_t), intent(in) :: m
      type(tree_t), intent(in) :: t
      real(wp), intent(in) :: length
      integer, intent(in) :: i
      real(wp) :: v(2)

      associate (link => m%points(i)%link, offset => m%points(i)%offset)
         v = turned(offset, t%angle_offset(link))/length
         if (m%links(link)%ground) v = v + (m%links(link)%position(:2) - t%origin)/length
      end associate
   end function point_in_drawing

   pure function turned(u, angle) result(w)
      real(wp), intent(in) :: u(2), angle
      real(wp) :: w(2)

      w = u
      if (abs(angle) > 0.0_wp) w = [u(1)*cos(angle) - u(2)*sin(angle), u(1)*sin(angle) + u(2)*cos(angle)]
   end function turned
end module tree_places
