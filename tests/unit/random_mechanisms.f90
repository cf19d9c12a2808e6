!> Tests. Mechanisms by the dice: from ground links outwards cranks, slides, dyads, triads, closed nets of four, cylinders and
!> floating links, each with as many drives as it has freedoms. The position comes first, so that every mechanism is assembled at
!> t = 0 as far as rounding lets it be.
module random_mechanisms
   use kinds, only: wp
   use mechanism, only: mechanism_t, pair_revolute, pair_prismatic, &
      drive_angle, drive_x, drive_y, drive_relangle, drive_slide
   use dice, only: new_dice, throw, chance
   use random_drafts, only: draft_t, add_links, add_link, join, add_drive, add_point_drive, add_relative_angle, &
      fair_copy
   implicit none
   private
   public :: random_mechanism

   integer, parameter :: r = pair_revolute, p = pair_prismatic

contains

   !> Mechanism number `seed` of `groups` groups; `special`: how often angles are right, coordinates whole and joints
   !> shared.
   function random_mechanism(seed, groups, special) result(m)
      integer, intent(in) :: seed, groups
      real(wp), intent(in) :: special
      type(mechanism_t) :: m
      type(draft_t), allocatable :: d
      integer :: k

      allocate (d)
      d%dice = new_dice(seed)
      d%special = special
      do k = 1, throw(d%dice, 3)
         call add_link(d, 0)
         d%link(d%links)%ground = .true.
      end do
      call add_driven_link(d, 1)
      do k = 2, groups
         call add_group(d)
      end do
      call fair_copy(d, m)
   end function random_mechanism

   subroutine add_group(d)
      type(draft_t), intent(inout) :: d

      select case (throw(d%dice, 16))
      case (1:3); call add_driven_link(d, throw(d%dice, 7))
      case (4:9); call add_dyad(d)
      case (10); call add_end_driven_chain(d)
      case (11); call add_triad(d)
      case (12); call add_net(d)
      case (13); call add_cylinder(d)
      case (14); call add_floating(d)
      case (15); call add_table(d)
      case default; call add_open_loop(d)
      end select
   end subroutine add_group

   !> One link on another, and its drive.
   subroutine add_driven_link(d, kind)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: kind
      integer :: base, link

      base = throw(d%dice, d%links)
      call add_link(d, base)
      link = d%links
      call join(d, base, link, merge(r, p, kind <= 4))
      select case (kind)
      case (1:2)
         call add_drive(d, drive_angle, link, 0)
      case (3)
         call add_relative_angle(d, link)
      case (4, 7)
         call add_point_drive(d, merge(drive_x, drive_y, chance(d%dice, 0.5_wp)), link)
      case default
         call add_drive(d, drive_slide, d%pairs, 0)
      end select
   end subroutine add_driven_link

   !> Two links; three prismatic pairs would leave nothing to turn.
   subroutine add_dyad(d)
      type(draft_t), intent(inout) :: d
      integer :: kind(3), e, f, first, k

      do
         kind = [(merge(r, p, chance(d%dice, 0.6_wp)), k=1, 3)]
         if (any(kind == r)) exit
      end do
      e = throw(d%dice, d%links)
      f = throw(d%dice, d%links)
      first = add_links(d, 2)
      call join(d, e, first, kind(1))
      call join(d, first, first + 1, kind(2))
      call join(d, first + 1, f, kind(3))
   end subroutine add_dyad

   !> Two links in a row, the end of the second driven along x and y.
   subroutine add_end_driven_chain(d)
      type(draft_t), intent(inout) :: d
      integer :: e, first

      e = throw(d%dice, d%links)
      first = add_links(d, 2)
      call join(d, e, first, r)
      call join(d, first, first + 1, r)
      call add_point_drive(d, drive_x, first + 1)
      call add_drive(d, drive_y, d%drive(d%drives)%subject, 0)
   end subroutine add_end_driven_chain

   !> A plate on three legs.
   subroutine add_triad(d)
      type(draft_t), intent(inout) :: d
      integer :: e(3), first, k

      do k = 1, 3
         e(k) = throw(d%dice, d%links)
      end do
      first = add_links(d, 4)
      do k = 1, 3
         select case (throw(d%dice, 4))
         case (1)
            call join(d, first, first + k, p)
            call join(d, first + k, e(k), r)
         case (2)
            call join(d, first, first + k, r)
            call join(d, first + k, e(k), p)
         case default
            call join(d, first, first + k, r)
            call join(d, first + k, e(k), r)
         end select
      end do
   end subroutine add_triad

   !> Four links in a ring, two of them on others.
   subroutine add_net(d)
      type(draft_t), intent(inout) :: d
      integer :: e, f, first, k

      e = throw(d%dice, d%links)
      f = throw(d%dice, d%links)
      first = add_links(d, 4)
      do k = 0, 3
         call join(d, first + k, first + modulo(k + 1, 4), merge(p, r, k == 2 .and. chance(d%dice, 0.3_wp)))
      end do
      call join(d, e, first, r)
      call join(d, first + 2, f, r)
   end subroutine add_net

   !> A link moved by a cylinder.
   subroutine add_cylinder(d)
      type(draft_t), intent(inout) :: d
      integer :: e, f, first

      e = throw(d%dice, d%links)
      f = throw(d%dice, d%links)
      first = add_links(d, 3)
      call join(d, e, first, r)
      call join(d, first, first + 1, r)
      call join(d, first + 2, f, r)
      call join(d, first + 1, first + 2, p)
      call add_drive(d, drive_slide, d%pairs, 0)
   end subroutine add_cylinder

   !> A link on no other: x and y of one of its points are driven, and an angle or a coordinate of another point.
   subroutine add_floating(d)
      type(draft_t), intent(inout) :: d
      integer :: link

      link = add_links(d, 1)
      call add_point_drive(d, drive_x, link)
      call add_drive(d, drive_y, d%drive(d%drives)%subject, 0)
      select case (throw(d%dice, 3))
      case (1)
         call add_drive(d, drive_angle, link, 0)
      case (2)
         call add_relative_angle(d, link)
      case default
         call add_point_drive(d, merge(drive_x, drive_y, chance(d%dice, 0.5_wp)), link)
      end select
   end subroutine add_floating

   !> Two slides one upon the other: driven as slides, or the table along x and y.
   subroutine add_table(d)
      type(draft_t), intent(inout) :: d
      integer :: e, first

      e = throw(d%dice, d%links)
      first = add_links(d, 2)
      call join(d, e, first, p)
      call join(d, first, first + 1, p)
      if (chance(d%dice, 0.5_wp)) then
         call add_drive(d, drive_slide, d%pairs - 1, 0)
         call add_drive(d, drive_slide, d%pairs, 0)
      else
         call add_point_drive(d, drive_x, first + 1)
         call add_drive(d, drive_y, d%drive(d%drives)%subject, 0)
      end if
   end subroutine add_table

   !> Three links in a row between two others, driven somewhere inside.
   subroutine add_open_loop(d)
      type(draft_t), intent(inout) :: d
      integer :: e, f, first, slider

      e = throw(d%dice, d%links)
      f = throw(d%dice, d%links)
      first = add_links(d, 3)
      slider = throw(d%dice, 6)
      call join(d, e, first, merge(p, r, slider == 1))
      call join(d, first, first + 1, merge(p, r, slider == 2))
      call join(d, first + 1, first + 2, merge(p, r, slider == 3))
      call join(d, first + 2, f, merge(p, r, slider == 4))
      select case (throw(d%dice, 4))
      case (1)
         call add_drive(d, drive_angle, first + 1, 0)
      case (2)
         call add_drive(d, drive_relangle, first, first + 2)
      case (3)
         call add_point_drive(d, drive_x, first + 1)
      case default
         if (slider <= 4) then
            call add_drive(d, drive_slide, d%pairs - 4 + slider, 0)
         else
            call add_point_drive(d, drive_y, first + throw(d%dice, 3) - 1)
         end if
      end select
   end subroutine add_open_loop
end module random_mechanisms
