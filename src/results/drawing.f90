!> What a picture of a set shows, taken from its motion instant by instant: positions of all links, the curves of the
!> points that PRINT asks for, the centrodes that POLE asks for, how far each slide goes, and the flagged instants.
!> Places are counted from the set's first ground link, in the deck's unit of length.
module drawing
   use kinds, only: wp
   use mechanism, only: mechanism_t, request_point, request_pole, pair_prismatic, &
      instant_count, plane_origin, is_listed_alone
   use planar, only: direction, quarter_turn, point_of
   use motion, only: known_of, mark_none, singular_unclear
   use points, only: row_t, has_number, point_motion, is_fixed
   use set_motion, only: set_motion_t, is_flagged, find_row_in_set
   use outline, only: outline_t, outlines_of
   implicit none
   private
   public :: drawing_t, snapshot_t, curve_t, centrode_t, guide_t, flag_t, new_drawing, record_instant, point_place

   !> A curve has at most this many places, a picture at most this many curves and flagged positions. Reason: a picture
   !> of 800 pixels shows no more, and memory does not grow with the run.
   integer, parameter :: max_places = 1000, max_curves = 60, max_flags = 3
   !> The frames of a drawing hold at most this many positions of links, but there are two frames at least. Reason: an
   !> animation takes about 25 bytes for each.
   integer, parameter, public :: max_positions = 45000
   !> Places from here on are not drawn: differences of two must not overflow.
   real(wp), parameter :: max_place = 1.0e-3_wp*huge(1.0_wp)

   !> The position of all links at one instant, and why it is flagged.
   type :: snapshot_t
      real(wp) :: t = 0.0_wp
      real(wp), allocatable :: place(:, :)   !< (3, links) x, y, phi
      logical, allocatable :: known(:)       !< (links)
      real(wp), allocatable :: centre(:, :)  !< (2, centrodes) the instant centres
      logical, allocatable :: has_centre(:)  !< (centrodes) they are not at infinity
      integer :: mark = mark_none            !< of the first part that is flagged
      integer :: singularity = singular_unclear   !< what the position is, of mark_singular
   end type snapshot_t

   !> The path of a point.
   type :: curve_t
      integer :: request = 0                 !< its number in the set
      integer :: point = 0
      real(wp), allocatable :: t(:)          !< (places) the instants of TIME, or some of them
      real(wp), allocatable :: place(:, :), velocity(:, :)   !< (2, places)
      integer, allocatable :: known(:)       !< (places) as in `motion_t`
   end type curve_t

   !> The centrodes of two links: where their instant centre is in the axes of either.
   type :: centrode_t
      integer :: request = 0                 !< its number in the set
      integer :: link(2) = 0                 !< link I and link J
      real(wp), allocatable :: place(:, :, :)   !< (2, places, 2) in the axes of link I, of link J
      integer, allocatable :: side(:)        !< (places) the sense of the relative turn, 1 or -1; 0: no centre
   end type centrode_t

   !> The guide of a prismatic pair: a line of one link, along which a point of the other, its block, slides.
   type :: guide_t
      integer :: pair = 0
      integer :: carrier = 0, block = 0      !< the links
      integer :: point = 0                   !< the point of the block on the line
      integer :: pivot = 0                   !< the point of the carrier from which the slide is counted
      real(wp) :: foot(2) = 0.0_wp           !< of the pivot on the line, in the carrier's axes
      real(wp) :: angle = 0.0_wp             !< the direction of the line there (rad)
      real(wp) :: block_angle = 0.0_wp       !< the same in the axes of the block (rad)
      integer :: sense = 1                   !< -1: the slide grows against the direction
      real(wp) :: low = huge(1.0_wp), high = -huge(1.0_wp)   !< range of the block along the line, from the foot
   end type guide_t

   !> A flagged instant, and the last known position of the links that it concerns.
   type :: flag_t
      real(wp) :: t = 0.0_wp
      integer :: mark = mark_none            !< why
      integer :: singularity = singular_unclear   !< what the position is, of mark_singular
      logical :: earlier = .false.           !< the position is that of an earlier instant
      type(snapshot_t) :: last               !< `known`: of the links concerned
   end type flag_t

   !> What is recorded of the set `m`.
   type :: drawing_t
      type(mechanism_t) :: m
      real(wp) :: origin(2) = 0.0_wp         !< of the places, in the deck's coordinates
      integer :: stride = 1                  !< every so many instants of TIME are in a curve
      integer :: every = 1                   !< each so many instants of TIME are the deck's; 0: none
      integer :: flagged = 0                 !< instants
      real(wp), allocatable :: flagged_at(:) !< the first of them
      type(snapshot_t) :: now                !< the last known position of each link
      type(outline_t), allocatable :: outlines(:)   !< (links)
      integer :: frames = 0                  !< recorded so far
      integer :: frame_stride = 1            !< every so many instants, and the last one, are frames
      type(snapshot_t), allocatable :: frame(:)
      logical :: assemblies = .false.        !< the frames are assemblies at one instant, the one chosen first
      type(curve_t), allocatable :: curves(:)
      type(centrode_t), allocatable :: centrodes(:)
      type(guide_t), allocatable :: guides(:)
      type(flag_t), allocatable :: flags(:)
      integer, allocatable :: mark(:)        !< (parts) of the instant before
   end type drawing_t

contains

   !> Nothing recorded yet of the set `m`; at most `max_frames` frames will be. `every`: each so many instants of TIME
   !> are the deck's, 0: none; where others are flagged that is not noted.
   function new_drawing(m, max_frames, every) result(d)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: max_frames, every
      type(drawing_t) :: d
      type(curve_t) :: curve
      type(centrode_t) :: centrode
      integer, allocatable :: slides(:)
      integer :: i, n, places

      d%m = m
      d%every = every
      d%origin = plane_origin(m)
      d%now = snapshot_of_ground(m, d%origin)
      d%outlines = outlines_of(m)
      allocate (d%flagged_at(0), d%flags(0), d%mark(0), d%curves(0), d%centrodes(0))
      n = max(2, min(max_frames, max_positions/size(m%links)))
      d%frame_stride = max(1, 1 + (frame_instants(m) - 2)/(n - 1))
      allocate (d%frame(1 + max(0, frame_instants(m) + d%frame_stride - 2)/d%frame_stride))
      d%stride = 1 + max(0, m%steps)/max_places
      places = place_number(d, m%steps)
      do i = 1, size(m%requests)
         if (m%requests(i)%kind /= request_point .or. is_listed_alone(m%requests(i)) .or. is_fixed(m, m%requests(i))) &
            cycle
         if (any(d%curves%point == m%requests(i)%subject) .or. size(d%curves) == max_curves) cycle
         ! A function's result within a constructed array would not be freed by gfortran.
         curve = new_curve(i, m%requests(i)%subject, places)
         d%curves = [d%curves, curve]
      end do
      do i = 1, size(m%requests)
         if (m%requests(i)%kind /= request_pole) cycle
         centrode = new_centrode(m, i, places)
         d%centrodes = [d%centrodes, centrode]
      end do
      slides = pack([(i, i=1, size(m%pairs))], m%pairs%kind == pair_prismatic)
      d%guides = [(guide_of(m, d%outlines, slides(i)), i=1, size(slides))]
   end function new_drawing

   !> The number in a curve of the place at instant `k` (0, 1, ...); 0 for none: every so many of TIME and its last one
   !> have places.
   pure integer function place_number(d, k)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: k

      place_number = 0
      if (k == d%m%steps .or. (k < d%m%steps .and. mod(k, d%stride) == 0)) &
         place_number = 1 + (k + d%stride - 1)/d%stride
   end function place_number

   !> A curve with room for `places`, none known.
   pure function new_curve(request, point, places) result(c)
      integer, intent(in) :: request, point, places
      type(curve_t) :: c

      c%request = request
      c%point = point
      allocate (c%t(places), c%place(2, places), c%velocity(2, places), source=0.0_wp)
      allocate (c%known(places), source=-1)
   end function new_curve

   !> The centrodes that request number `i` of `m` asks for, with room for `places`, none known.
   pure function new_centrode(m, i, places) result(c)
      type(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, places
      type(centrode_t) :: c

      c%request = i
      c%link = [m%requests(i)%second, m%requests(i)%subject]
      allocate (c%place(2, places, 2), source=0.0_wp)
      allocate (c%side(places), source=0)
   end function new_centrode

   !> The ground links where the deck has them; the others are not known.
   pure function snapshot_of_ground(m, origin) result(s)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: origin(2)
      type(snapshot_t) :: s
      integer :: i

      allocate (s%place(3, size(m%links)), source=0.0_wp)
      s%known = m%links%ground
      allocate (s%centre(2, count(m%requests%kind == request_pole)), source=0.0_wp)
      allocate (s%has_centre(size(s%centre, 2)), source=.false.)
      do i = 1, size(m%links)
         if (s%known(i)) s%place(:, i) = m%links(i)%position - [origin, 0.0_wp]
      end do
   end function snapshot_of_ground

   !> The guide of pair number `i`. It belongs to link i of the pair: Q - P = s e - h n, eq. (9), lies on a line through
   !> P - h n. Where link j is ground, or link i has no extent, the same pair is a guide of link j: P slides along the
   !> line through Q + h n.
   pure function guide_of(m, outlines, i) result(g)
      type(mechanism_t), intent(in) :: m
      type(outline_t), intent(in) :: outlines(:)
      integer, intent(in) :: i
      type(guide_t) :: g
      integer :: ends(2), k
      real(wp) :: angles(2)

      associate (pair => m%pairs(i))
         ends = [pair%point_i, pair%point_j]
         angles = [pair%alpha, pair%alpha - pair%beta]
         associate (li => m%points(ends(1))%link, lj => m%points(ends(2))%link)
            k = 1
            if (.not. m%links(li)%ground .and. (m%links(lj)%ground .or. &
               (size(outlines(li)%corner, 2) == 1 .and. size(outlines(lj)%corner, 2) > 1))) k = 2
         end associate
         g%pair = i
         g%pivot = ends(k)
         g%point = ends(3 - k)
         g%carrier = m%points(g%pivot)%link
         g%block = m%points(g%point)%link
         g%angle = angles(k)
         g%block_angle = angles(3 - k)
         g%sense = 3 - 2*k
         g%foot = m%points(g%pivot)%offset - real(g%sense, wp)*pair%offset*quarter_turn(direction(g%angle))
      end associate
   end function guide_of

   !> Takes what the picture needs of instant number `k` (0, 1, ...) of the motion `s`.
   subroutine record_instant(d, s, k)
      type(drawing_t), intent(inout) :: d
      type(set_motion_t), intent(in) :: s
      integer, intent(in) :: k
      type(snapshot_t) :: before, now
      integer :: c, i, n

      before = d%now
      now = snapshot_of_ground(d%m, d%origin)
      now%t = s%motions(1)%t
      do c = size(s%own), 1, -1
         if (s%motions(c)%mark /= mark_none .and. is_own()) then
            now%mark = s%motions(c)%mark
            now%singularity = s%motions(c)%singularity
         end if
         associate (links => s%parts%list(c)%links, q => s%motions(c))
            do i = 1, size(links)
               if (d%m%links(links(i))%ground .or. known_of(q, i) < 0) cycle
               now%place(:, links(i)) = q%position(:, i) + [q%origin - d%origin, 0.0_wp]
               now%known(links(i)) = all(abs(now%place(:, links(i))) < max_place)
               if (.not. now%known(links(i))) cycle
               d%now%place(:, links(i)) = now%place(:, links(i))
               d%now%known(links(i)) = .true.
            end do
         end associate
      end do
      d%now%t = now%t
      n = place_number(d, k)
      call record_centres()
      call record_slides(d%guides, d%m)
      call record_curves()
      if (is_own()) call record_flags()
      if (k >= frame_instants(d%m) .or. (mod(k, d%frame_stride) /= 0 .and. k < frame_instants(d%m) - 1)) return
      d%frames = d%frames + 1
      d%frame(d%frames) = now

   contains

      !> Whether instant number `k` (0, 1, ...) is one of the deck's.
      pure logical function is_own()

         is_own = k > d%m%steps
         if (.not. is_own .and. d%every > 0) is_own = mod(k, d%every) == 0
      end function is_own

      !> Widens the ranges of the slides.
      pure subroutine record_slides(guides, m)
         type(guide_t), intent(inout) :: guides(:)
         type(mechanism_t), intent(in) :: m
         real(wp) :: along
         integer :: i

         do i = 1, size(guides)
            associate (g => guides(i))
               if (.not. (now%known(g%carrier) .and. now%known(g%block))) cycle
               along = dot_product(point_place(m, now, g%point) - point_place(m, now, g%pivot), &
                  direction(now%place(3, g%carrier) + g%angle))
               g%low = min(g%low, along)
               g%high = max(g%high, along)
            end associate
         end do
      end subroutine record_slides

      !> The places of the curves, if this instant is one of theirs.
      subroutine record_curves()
         real(wp) :: p(2, 0:2)
         integer :: i, c, local

         if (n == 0) return
         do i = 1, size(d%curves)
            associate (curve => d%curves(i))
               c = s%parts%part(curve%request)
               if (c == 0) cycle
               local = s%own(c)%requests(s%parts%number(curve%request))%subject
               curve%t(n) = s%motions(c)%t
               curve%known(n) = known_of(s%motions(c), s%own(c)%points(local)%link)
               if (curve%known(n) < 0) cycle
               p = point_motion(s%own(c), s%motions(c), local)
               curve%place(:, n) = p(:, 0) + (s%motions(c)%origin - d%origin)
               curve%velocity(:, n) = p(:, 1)
               if (any(abs(curve%place(:, n)) > max_place)) curve%known(n) = -1
            end associate
         end do
      end subroutine record_curves

      !> Puts the instant centres into `now`, and into their centrodes if this instant is one of theirs.
      subroutine record_centres()
         type(row_t) :: row
         integer :: i

         do i = 1, size(d%centrodes)
            call find_row_in_set(d%m, s, d%centrodes(i)%request, row)
            now%has_centre(i) = has_number(row, 1, 0) .and. all(abs(row%value(:2, :)) < max_place)
            if (.not. now%has_centre(i)) cycle
            now%centre(:, i) = row%value(:2, 0) - d%origin
            if (n == 0) cycle
            d%centrodes(i)%place(:, n, :) = row%value(:2, 1:2)
            d%centrodes(i)%side(n) = merge(1, -1, row%weight > 0.0_wp)
         end do
         d%now%centre = now%centre
         d%now%has_centre = now%has_centre
      end subroutine record_centres

      !> Notes the first of the instants that a part is flagged for one reason. `before`: the last known positions.
      subroutine record_flags()
         type(flag_t) :: flag
         integer :: c

         if (size(d%mark) == 0) d%mark = spread(mark_none, 1, size(s%motions))
         if (is_flagged(s)) d%flagged = d%flagged + 1
         if (is_flagged(s) .and. size(d%flagged_at) < max_places) d%flagged_at = [d%flagged_at, now%t]
         do c = 1, size(s%motions)
            if (s%motions(c)%mark /= d%mark(c) .and. s%motions(c)%mark /= mark_none &
               .and. size(d%flags) < max_flags) then
               associate (links => s%parts%list(c)%links)
                  flag%t = now%t
                  flag%mark = s%motions(c)%mark
                  flag%singularity = s%motions(c)%singularity
                  flag%earlier = .not. all(now%known(links))
                  flag%last = now
                  if (flag%earlier) flag%last = before
                  flag%last%known = .false.
                  flag%last%known(links) = merge(before%known(links), now%known(links), flag%earlier)
                  d%flags = [d%flags, flag]
               end associate
            end if
            d%mark(c) = s%motions(c)%mark
         end do
      end subroutine record_flags
   end subroutine record_instant

   !> The number of instants from which frames are taken: those of TIME, or where there is none those of AT.
   pure integer function frame_instants(m)
      type(mechanism_t), intent(in) :: m

      frame_instants = merge(m%steps + 1, instant_count(m), m%steps >= 0)
   end function frame_instants

   !> Place (2) of point number `i` at the position `s`.
   pure function point_place(m, s, i) result(p)
      type(mechanism_t), intent(in) :: m
      type(snapshot_t), intent(in) :: s
      integer, intent(in) :: i
      real(wp) :: p(2)

      p = point_of(s%place(:, m%points(i)%link), m%points(i)%offset)
   end function point_place
end module drawing
