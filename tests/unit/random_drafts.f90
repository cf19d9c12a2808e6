!> Tests. A mechanism in the making, by the dice: links where they fall, pairs whose points are put where they coincide in this
!> position, drives that begin from it.
module random_drafts
   use kinds, only: wp
   use plane_vectors, only: pi
   use mechanism, only: mechanism_t, link_t, point_t, pair_t, drive_t, term_t, request_t, pair_prismatic, &
      drive_angle, drive_x, drive_y, drive_relangle, drive_slide, term_harmonic, request_link
   use dice, only: dice_t, throw, chance, between, disorder
   implicit none
   private
   public :: draft_t, add_links, add_link, join, add_drive, add_point_drive, add_relative_angle, fair_copy

   integer, parameter :: room = 400

   !> A mechanism in the making.
   type :: draft_t
      type(dice_t) :: dice
      real(wp) :: special = 0.0_wp        !< share of right angles, whole numbers and joints on joints
      integer :: links = 0, points = 0, pairs = 0, drives = 0
      type(link_t) :: link(room)
      type(point_t) :: point(room)
      type(pair_t) :: pair(room)
      type(drive_t) :: drive(room)
   end type draft_t

contains

   !> The number of the first of `n` new links.
   integer function add_links(d, n) result(first)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: n
      integer :: k

      first = d%links + 1
      do k = 1, n
         call add_link(d, 0)
      end do
   end function add_links

   !> A link where the dice put it; in special cases parallel to link `like`.
   subroutine add_link(d, like)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: like

      d%links = d%links + 1
      associate (link => d%link(d%links))
         write (link%name, '("L", i0)') d%links
         link%position(:2) = anywhere(d)
         link%position(3) = some_angle(d)
         if (like > 0) then
            if (chance(d%dice, 0.3_wp*d%special)) link%position(3) = d%link(like)%position(3)
         end if
      end associate
   end subroutine add_link

   !> A pair of links `i` and `j`, in this or the other order.
   subroutine join(d, i, j, kind)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: i, j, kind
      real(wp) :: where(2), gap(2), angle
      integer :: link(2)

      link = merge([i, j], [j, i], chance(d%dice, 0.5_wp))
      where = joint_place(d, link)
      d%pairs = d%pairs + 1
      associate (pair => d%pair(d%pairs))
         pair%kind = kind
         write (pair%name, '("K", i0)') d%pairs
         pair%point_i = new_point(d, link(1), where)
         if (kind == pair_prismatic) then
            pair%alpha = some_angle(d)
            angle = d%link(link(1))%position(3) + pair%alpha
            ! Anywhere, or off the guide by nothing.
            gap = between(d%dice, -2.0_wp, 2.0_wp)*[cos(angle), sin(angle)]
            if (.not. chance(d%dice, d%special)) gap = gap + between(d%dice, -1.0_wp, 1.0_wp)*[-sin(angle), cos(angle)]
            where = where + gap
            pair%beta = d%link(link(2))%position(3) - d%link(link(1))%position(3)
         end if
         pair%point_j = new_point(d, link(2), where)
         if (kind == pair_prismatic) then
            gap = place(d, pair%point_i) - place(d, pair%point_j)
            pair%offset = gap(2)*cos(angle) - gap(1)*sin(angle)
         end if
      end associate
   end subroutine join

   !> Anywhere; in special cases on an old joint, or on the origin of one of the two links.
   function joint_place(d, link) result(where)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: link(2)
      real(wp) :: where(2)
      integer :: k

      where = anywhere(d)
      if (.not. chance(d%dice, d%special)) return
      if (d%points > 0 .and. chance(d%dice, 0.4_wp)) then
         k = throw(d%dice, d%points)
         if (all(d%point(k)%link /= link)) return
         where = place(d, k)
      else
         where = d%link(link(throw(d%dice, 2)))%position(:2)
      end if
   end function joint_place

   integer function new_point(d, link, where) result(k)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: link
      real(wp), intent(in) :: where(2)

      d%points = d%points + 1
      k = d%points
      associate (q => d%link(link)%position, u => where - d%link(link)%position(:2))
         write (d%point(k)%name, '("P", i0)') k
         d%point(k)%link = link
         d%point(k)%offset = [u(1)*cos(q(3)) + u(2)*sin(q(3)), -u(1)*sin(q(3)) + u(2)*cos(q(3))]
      end associate
   end function new_point

   function place(d, k) result(where)
      type(draft_t), intent(in) :: d
      integer, intent(in) :: k
      real(wp) :: where(2)

      associate (q => d%link(d%point(k)%link)%position, u => d%point(k)%offset)
         where = q(:2) + [u(1)*cos(q(3)) - u(2)*sin(q(3)), u(1)*sin(q(3)) + u(2)*cos(q(3))]
      end associate
   end function place

   subroutine add_point_drive(d, kind, link)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: kind, link

      call add_drive(d, kind, new_point(d, link, anywhere(d)), 0)
   end subroutine add_point_drive

   !> The angle between `link` and any other.
   subroutine add_relative_angle(d, link)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: link
      integer :: other

      do
         other = throw(d%dice, d%links)
         if (other /= link) exit
      end do
      if (chance(d%dice, 0.5_wp)) then
         call add_drive(d, drive_relangle, link, other)
      else
         call add_drive(d, drive_relangle, other, link)
      end if
   end subroutine add_relative_angle

   !> A drive that begins where the links are; every third with a harmonic term.
   subroutine add_drive(d, kind, subject, second)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: kind, subject, second
      type(term_t) :: term

      d%drives = d%drives + 1
      associate (drive => d%drive(d%drives))
         drive%kind = kind
         drive%subject = subject
         drive%second = second
         drive%polynomial = [value_now(d, drive), between(d%dice, -1.0_wp, 1.0_wp), between(d%dice, -1.0_wp, 1.0_wp)]
         if (chance(d%dice, 0.3_wp)) then
            term%kind = term_harmonic
            term%r = [between(d%dice, -0.5_wp, 0.5_wp), between(d%dice, 0.5_wp, 2.0_wp), between(d%dice, -pi, pi)]
            drive%polynomial(1) = drive%polynomial(1) - term%r(1)*sin(term%r(3))
            drive%terms = [term]
         end if
      end associate
   end subroutine add_drive

   !> What the drive moves, in the position of t = 0.
   real(wp) function value_now(d, drive) result(value)
      type(draft_t), intent(in) :: d
      type(drive_t), intent(in) :: drive
      real(wp) :: gap(2), angle

      value = 0.0_wp
      select case (drive%kind)
      case (drive_angle)
         value = d%link(drive%subject)%position(3)
      case (drive_relangle)
         value = d%link(drive%second)%position(3) - d%link(drive%subject)%position(3)
      case (drive_x, drive_y)
         gap = place(d, drive%subject)
         value = merge(gap(1), gap(2), drive%kind == drive_x)
      case (drive_slide)
         associate (pair => d%pair(drive%subject))
            gap = place(d, pair%point_j) - place(d, pair%point_i)
            angle = d%link(d%point(pair%point_i)%link)%position(3) + pair%alpha
            value = gap(1)*cos(angle) + gap(2)*sin(angle)
         end associate
      end select
   end function value_now

   function anywhere(d) result(where)
      type(draft_t), intent(inout) :: d
      real(wp) :: where(2)

      where(1) = between(d%dice, -3.0_wp, 3.0_wp)
      where(2) = between(d%dice, -3.0_wp, 3.0_wp)
      if (chance(d%dice, d%special)) where = anint(where)
   end function anywhere

   real(wp) function some_angle(d) result(angle)
      type(draft_t), intent(inout) :: d

      angle = between(d%dice, -pi, pi)
      if (chance(d%dice, d%special)) angle = pi/2.0_wp*anint(angle/(pi/2.0_wp))
   end function some_angle

   !> The draft as a mechanism, links and pairs in any order, tables of all links or of some.
   subroutine fair_copy(d, m)
      type(draft_t), intent(inout) :: d
      type(mechanism_t), intent(out) :: m
      integer :: link(d%links), pair(d%pairs), i

      link = disorder(d%dice, d%links)
      pair = disorder(d%dice, d%pairs)
      allocate (m%links(d%links), m%pairs(d%pairs), m%at(0))
      m%links(link) = d%link(:d%links)
      m%points = d%point(:d%points)
      m%points%link = link(m%points%link)
      m%pairs(pair) = d%pair(:d%pairs)
      allocate (m%drives(d%drives))
      do i = 1, d%drives
         m%drives(i) = d%drive(i)
         associate (drive => m%drives(i))
            if (any(drive%kind == [drive_angle, drive_relangle])) drive%subject = link(drive%subject)
            if (drive%kind == drive_relangle) drive%second = link(drive%second)
            if (drive%kind == drive_slide) drive%subject = pair(drive%subject)
         end associate
      end do
      m%requests = [(request_t(request_link, i, 1), i=1, d%links)]
      if (chance(d%dice, 0.3_wp)) m%requests = m%requests(throw(d%dice, d%links):)
   end subroutine fair_copy
end module random_drafts
