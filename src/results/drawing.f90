!> The record of a set for drawings, taken from its motion instant by instant. The record has frames, from which picture
!> and animation take positions, paths of points and centrodes; the range of each slide; and the first flagged instant.
!> Places are counted from the set's first ground link, in the deck's unit of length.
module drawing
   use kinds, only: wp
   use disjoint_sets, only: sorted_t, sorted, members
   use mechanism, only: mechanism_t, has_guide, has_path, is_fixed, instant_count, plane_origin
   use plane_vectors, only: pi, cross, direction, quarter_turn, point_of
   use drives, only: drive_rate
   use scales, only: is_length, latest_time
   use motion, only: known_of, flag_none, singular_unclear
   use columns, only: columns_of_rows, kinds_of_rows, column_at, cell_of, cell_number
   use points, only: row_t
   use set_motion, only: set_motion_t, is_flagged, find_row_in_set
   implicit none
   private
   public :: drawing_t, snapshot_t, guide_t, film_of, new_drawing, record_instant
   public :: point_place, moved

   !> Between the instants of a deck others are computed, so that the motion has about this many intervals. Reason: at
   !> ten degrees a step a path would have corners, and an animation would leap.
   integer, parameter, public :: max_intervals = 360
   !> If this gives more, the motion has so many intervals for each turn of a drive.
   real(wp), parameter :: intervals_a_turn = 90.0_wp
   !> All sets of a page together have at most this many intervals, or those of the deck. Reason: the text of a page is
   !> held until its last set is drawn.
   integer, parameter :: max_in_all = 18000
   !> There are at most this many frames. Reason: a picture of 800 pixels shows no more.
   integer, parameter :: max_frames = 3601
   !> The frames hold at most this many positions of links, but there are two frames at least. Reason: memory does not
   !> grow with the run.
   integer, parameter :: max_held = 200000
   !> An animation shows at most this many positions of links. Reason: it takes about 25 bytes for each.
   integer, parameter, public :: max_positions = 45000
   !> Paths that a picture shows, at most.
   integer, parameter :: max_curves = 60
   !> Places from here on are not drawn: differences of two must not overflow.
   real(wp), parameter :: max_place = 1.0e-3_wp*huge(1.0_wp)

   !> Points of a link closer than this part of the link's extent are one.
   real(wp), parameter :: same_corner_part = 1.0e-6_wp
   !> Corners whose angle has a smaller sine are collinear.
   real(wp), parameter :: collinear_sine = 1.0e-6_wp

   !> The shape of a link for the eye: the convex hull of its points, in its own axes.
   type :: outline_t
      real(wp), allocatable :: corner(:, :)  !< (2, corners) two of a bar, one of a single place, none without a point
   end type outline_t

   !> The position of all links at one instant, and why it is flagged.
   type :: snapshot_t
      real(wp) :: t = 0.0_wp                 !< the time, in the deck's unit
      real(wp), allocatable :: place(:, :)   !< (3, links) x, y, phi
      real(wp), allocatable :: rate(:)       !< (links) of phi, rad over the unit of time; 0 if it is not known
      real(wp), allocatable :: velocity(:, :)   !< (2, links) of the links' origins, for arrows; 0 if it is not known
      logical, allocatable :: known(:)       !< (links) the link has a position
      real(wp), allocatable :: centre(:, :)  !< (2, poles) the instant centres
      logical, allocatable :: has_centre(:)  !< (poles) they are not at infinity
      integer :: mark = flag_none            !< of the first part that is flagged
      integer :: singularity = singular_unclear   !< of flag_singular: the kind of the position
   end type snapshot_t

   !> The guide of a prismatic pair: a line of one link, along which a point of the other, its block, slides.
   type :: guide_t
      integer :: pair = 0                    !< number of the pair in the mechanism
      integer :: carrier = 0, block = 0      !< the links with the line, and with the block
      integer :: point = 0                   !< the point of the block on the line
      integer :: pivot = 0                   !< the point of the carrier from which the slide is counted
      real(wp) :: foot(2) = 0.0_wp           !< of the pivot on the line, in the carrier's axes
      real(wp) :: angle = 0.0_wp             !< the direction of the line there (rad)
      real(wp) :: block_angle = 0.0_wp       !< the direction of the line in the axes of the block (rad)
      integer :: sense = 1                   !< -1: the slide grows against the direction
      logical :: is_cylinder = .false.       !< the slide is the length of a cylinder, whose barrel is the carrier's
      real(wp) :: low = huge(1.0_wp), high = -huge(1.0_wp)   !< range of the block along the line, from the foot
   end type guide_t

   !> The record of the film of a set.
   type :: drawing_t
      type(mechanism_t) :: mechanism         !< the film
      real(wp) :: origin(2) = 0.0_wp         !< of the places, in the deck's coordinates
      type(outline_t), allocatable :: outlines(:)   !< (links)
      integer, allocatable :: curves(:)      !< (any number) the points whose paths PRINT asks for
      integer, allocatable :: poles(:)       !< (any number) the requests of poles
      logical :: has_centrodes = .true.      !< centrodes are drawn
      logical :: has_arrows = .false.        !< the velocities of points are drawn
      type(guide_t), allocatable :: guides(:)   !< (prismatic pairs)
      integer :: every = 1                   !< each so many instants of TIME are the deck's; 0: none
      integer :: stride = 1                  !< every so many instants of TIME, and the last, are frames
      type(snapshot_t), allocatable :: frame(:)   !< (frames) recorded so far, and room for further ones
      integer :: frames = 0                  !< how many are recorded so far
      integer :: films = 0                   !< how many of these are of TIME; they come first
      integer, allocatable :: own(:)         !< the numbers of frames that the picture may show in full
      type(snapshot_t) :: now                !< the last known position of each link
      integer :: flagged = 0                 !< how many instants are flagged
      type(snapshot_t) :: flag               !< the first of them
   end type drawing_t

contains

   !> Makes the film of a mechanism: the mechanism at instants that are dense enough to be drawn. These are the instants
   !> of TIME and others between them, or without TIME others between the first and the last of AT.
   subroutine film_of(m, sets, film, every)
      type(mechanism_t), intent(in) :: m     !< as the deck has it
      integer, intent(in) :: sets            !< how many sets the page has
      type(mechanism_t), intent(out) :: film   !< the mechanism with the instants of the film
      integer, intent(out) :: every          !< each so many instants of the film's TIME are the deck's; 0: none
      integer :: intervals, i
      real(wp) :: turns

      film = m
      every = 1
      if (m%steps < 0) then
         film%t0 = minval(m%at)
         film%t1 = maxval(m%at)
      end if
      turns = 0.0_wp
      do i = 1, size(m%drives)
         if (.not. is_length(m%drives(i))) &
            turns = max(turns, drive_rate(m%drives(i), latest_time(m))*abs(film%t1 - film%t0)/(2.0_wp*pi))
      end do

      intervals = max(max_intervals, int(min(intervals_a_turn*turns, real(max_frames - 1, wp))))
      intervals = max(1, min(intervals, max_in_all/sets))
      if (m%steps < 0) then
         film%steps = merge(intervals, 0, film%t1 > film%t0)
         every = 0
      else if (m%steps > 0) then
         every = max(1, min(intervals, max_held/size(m%links))/m%steps)
         film%steps = every*m%steps
      end if
   end subroutine film_of

   !> Makes a drawing of a film without a frame.
   function new_drawing(m, every, has_arrows, has_centrodes) result(d)
      type(mechanism_t), intent(in) :: m     !< the film
      integer, intent(in) :: every           !< each so many instants of TIME of the film are the deck's; 0: none
      logical, intent(in) :: has_arrows      !< the velocities of points are drawn
      logical, intent(in) :: has_centrodes   !< the centrodes of poles are drawn
      type(drawing_t) :: d
      real(wp) :: angles(2)
      integer :: ends(2), i, k, most

      d%mechanism = m
      d%every = every
      d%has_arrows = has_arrows
      d%has_centrodes = has_centrodes
      d%origin = plane_origin(m)
      d%outlines = outlines_of(m)
      allocate (d%own(0), d%curves(0))
      do i = 1, size(m%requests)
         if (size(d%curves) < max_curves .and. has_path(m%requests(i)) .and. .not. is_fixed(m, m%requests(i))) &
            d%curves = [d%curves, m%requests(i)%subject]
      end do
      d%poles = pack([(i, i=1, size(m%requests))], kinds_of_rows(m%requests%kind)%has_centrode)
      allocate (d%guides(count(has_guide(m%pairs%kind))))
      d%guides%pair = pack([(i, i=1, size(m%pairs))], has_guide(m%pairs%kind))

      ! A guide belongs to link i of its pair: Q - P = s e - h n, eq. (9), lies on a line through P - h n. If link j is
      ! ground, or link i has no extent, the guide belongs to link j: P slides along the line through Q + h n.
      do i = 1, size(d%guides)
         associate (g => d%guides(i), pair => m%pairs(d%guides(i)%pair))
            ends = [pair%point_i, pair%point_j]
            angles = [pair%alpha, pair%alpha - pair%beta]
            associate (li => m%points(ends(1))%link, lj => m%points(ends(2))%link)
               k = merge(2, 1, .not. m%links(li)%ground .and. (m%links(lj)%ground .or. &
                  (size(d%outlines(li)%corner, 2) == 1 .and. size(d%outlines(lj)%corner, 2) > 1)))
            end associate
            ! Only a cylinder has its direction from the drawing.
            g%is_cylinder = pair%drawn(1)
            if (g%is_cylinder) k = 1

            g%pivot = ends(k)
            g%point = ends(3 - k)
            g%carrier = m%points(g%pivot)%link
            g%block = m%points(g%point)%link
            g%angle = angles(k)
            g%block_angle = angles(3 - k)
            g%sense = 3 - 2*k
            g%foot = m%points(g%pivot)%offset - real(g%sense, wp)*pair%offset*quarter_turn(direction(g%angle))
         end associate
      end do
      d%now = snapshot_of_ground(d)

      most = max(2, min(max_frames, max_held/size(m%links)))
      d%stride = max(1, 1 + (m%steps - 1)/(most - 1))
      allocate (d%frame(count([(is_frame(d, i), i=0, instant_count(m) - 1)])))
   end function new_drawing

   !> Tells whether an instant is a frame. The instants of AT are frames only if the deck has no TIME.
   pure logical function is_frame(drawing, k)
      type(drawing_t), intent(in) :: drawing   !< with its stride
      integer, intent(in) :: k               !< the number of the instant, from 0

      is_frame = mod(k, drawing%stride) == 0 .or. k == drawing%mechanism%steps
      if (k > drawing%mechanism%steps) is_frame = drawing%every == 0
   end function is_frame

   !> Gives the position at which only the ground links are known: they are where the deck has them.
   pure function snapshot_of_ground(drawing) result(s)
      type(drawing_t), intent(in) :: drawing   !< with its mechanism
      type(snapshot_t) :: s
      integer :: i

      allocate (s%place(3, size(drawing%mechanism%links)), s%rate(size(drawing%mechanism%links)), &
         s%centre(2, size(drawing%poles)), source=0.0_wp)
      allocate (s%has_centre(size(drawing%poles)), source=.false.)
      if (drawing%has_arrows) allocate (s%velocity(2, size(drawing%mechanism%links)), source=0.0_wp)
      s%known = drawing%mechanism%links%ground
      do i = 1, size(drawing%mechanism%links)
         if (s%known(i)) s%place(:, i) = drawing%mechanism%links(i)%position - [drawing%origin, 0.0_wp]
      end do
   end function snapshot_of_ground

   !> Records an instant of a motion: its frame, the ranges of guides, and whether it is flagged.
   subroutine record_instant(drawing, motions, k)
      type(drawing_t), intent(inout) :: drawing   !< with the instants before; gets the instant
      type(set_motion_t), intent(in) :: motions   !< at the instant
      integer, intent(in) :: k               !< the number of the instant, from 0
      type(snapshot_t) :: now
      logical :: is_own
      real(wp) :: along
      integer :: i

      is_own = k > drawing%mechanism%steps
      if (.not. is_own .and. drawing%every > 0) is_own = mod(k, drawing%every) == 0
      ! The instants of a deck without TIME are a motion of their own.
      if (drawing%every == 0 .and. k == drawing%mechanism%steps + 1) drawing%now = snapshot_of_ground(drawing)
      call find_snapshot()
      drawing%now%t = now%t
      drawing%now%centre = now%centre
      drawing%now%has_centre = now%has_centre
      do i = 1, size(now%known)
         if (now%known(i)) drawing%now%place(:, i) = now%place(:, i)
      end do
      drawing%now%known = drawing%now%known .or. now%known

      do i = 1, size(drawing%guides)
         associate (g => drawing%guides(i))
            if (.not. (now%known(g%carrier) .and. now%known(g%block))) cycle
            along = dot_product(point_place(drawing%mechanism, now, g%point) &
               - point_place(drawing%mechanism, now, g%pivot), direction(now%place(3, g%carrier) + g%angle))
            g%low = min(g%low, along)
            g%high = max(g%high, along)
         end associate
      end do

      if (is_own .and. is_flagged(motions)) then
         if (drawing%flagged == 0) drawing%flag = now
         drawing%flagged = drawing%flagged + 1
      end if

      if (.not. is_frame(drawing, k)) return
      drawing%frames = drawing%frames + 1
      drawing%frame(drawing%frames) = now
      if (k <= drawing%mechanism%steps) drawing%films = drawing%frames
      if (is_own) drawing%own = [drawing%own, drawing%frames]

   contains

      !> Finds the position of all links, and of an instant of the deck why it is flagged.
      subroutine find_snapshot()
         type(row_t) :: row
         integer :: c, i

         now = snapshot_of_ground(drawing)
         now%t = motions%motions(1)%t
         do c = motions%count, 1, -1
            associate (links => motions%cards(c)%of, q => motions%motions(c))
               if (q%flag /= flag_none .and. is_own) then
                  now%mark = q%flag
                  now%singularity = q%singularity
               end if

               do i = 1, size(links)
                  if (drawing%mechanism%links(links(i))%ground .or. known_of(q, i) < 0) cycle
                  now%place(:, links(i)) = q%position(:, i) + [q%origin - drawing%origin, 0.0_wp]
                  now%known(links(i)) = all(abs(now%place(:, links(i))) < max_place)
                  if (known_of(q, i) == 0) cycle
                  now%rate(links(i)) = q%velocity(3, i)
                  if (drawing%has_arrows) now%velocity(:, links(i)) = q%velocity(:2, i)
               end do
            end associate
         end do

         do i = 1, size(drawing%poles)
            call find_row_in_set(motions, drawing%poles(i), row)
            now%has_centre(i) = all(abs(row%value(:2, :)) < max_place) .and. cell_number &
               == cell_of(columns_of_rows(column_at(row%form, 1, 0)), row%known, row%state)
            if (now%has_centre(i)) now%centre(:, i) = row%value(:2, 0) - drawing%origin
         end do
      end subroutine find_snapshot
   end subroutine record_instant

   !> Gives the place (2) of a point at a position, in the deck's unit from the origin of the drawing.
   pure function point_place(m, snapshot, i) result(p)
      type(mechanism_t), intent(in) :: m
      type(snapshot_t), intent(in) :: snapshot   !< the position
      integer, intent(in) :: i               !< the number of the point
      real(wp) :: p(2)

      p = point_of(snapshot%place(:, m%points(i)%link), m%points(i)%offset)
   end function point_place

   !> Finds the outlines (links) of all links of a mechanism, in one pass over its points.
   pure function outlines_of(m) result(list)
      type(mechanism_t), intent(in) :: m
      type(outline_t) :: list(size(m%links))
      type(sorted_t) :: by_link
      real(wp) :: offset(2, size(m%points))
      integer :: i

      do i = 1, size(m%points)
         offset(:, i) = m%points(i)%offset
      end do
      by_link = sorted(m%points%link, size(m%links))
      do i = 1, size(m%links)
         list(i)%corner = hull(offset(:, members(by_link, i)))
      end do
   end function outlines_of

   !> Moves places (2, places) from the axes of a link to the plane.
   pure function moved(p, position) result(q)
      real(wp), intent(in) :: p(:, :)        !< (2, places) in the axes of the link
      real(wp), intent(in) :: position(3)    !< of the link: x, y (lengths), phi (rad)
      real(wp) :: q(2, size(p, 2))
      integer :: k

      do k = 1, size(p, 2)
         q(:, k) = point_of(position, p(:, k))
      end do
   end function moved

   !> Finds the corners (2, corners) of the convex hull of points, counterclockwise, by Jarvis's march; corners in line
   !> are left out. Without points there are none.
   pure function hull(p) result(corners)
      real(wp), intent(in) :: p(:, :)        !< (2, points) lengths
      real(wp), allocatable :: corners(:, :)
      integer :: order(size(p, 2)), start, last, next, i, n
      real(wp) :: near, side

      if (size(p, 2) == 0) then
         corners = p
         return
      end if
      near = same_corner_part*maxval(maxval(p, dim=2) - minval(p, dim=2))
      start = minloc(p(2, :), dim=1, mask=p(1, :) <= minval(p(1, :)))
      n = 0
      last = start
      do
         n = n + 1
         order(n) = last
         next = 0
         do i = 1, size(p, 2)
            if (all(abs(p(:, i) - p(:, last)) <= near)) cycle
            if (next == 0) then
               next = i
               cycle
            end if
            ! The sine of the angle from the next place to this one.
            associate (u => p(:, next) - p(:, last), v => p(:, i) - p(:, last))
               side = cross(u/norm2(u), v/norm2(v))
               if (side < -collinear_sine .or. (side <= collinear_sine .and. norm2(v) > norm2(u))) next = i
            end associate
         end do
         if (next == 0 .or. n == size(p, 2)) exit
         if (all(abs(p(:, next) - p(:, start)) <= near)) exit
         last = next
      end do
      corners = p(:, order(:n))
   end function hull
end module drawing
