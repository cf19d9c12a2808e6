!> Which frames of a drawing a picture shows: the one in which the mechanism is read best, and a few others.
module picture_frames
   use kinds, only: wp
   use mechanism, only: pair_revolute
   use planar, only: cross, direction, point_of
   use drawing, only: drawing_t, snapshot_t, point_place, joint_point, picture_candidates
   use outline, only: corners_at, distance_to
   implicit none
   private
   public :: candidates, clearest, faint_frames, closes

   !> A joint is crowded if it is nearer to a bar or guide that is not its own than this part of the mechanism.
   real(wp), parameter :: clear_distance = 0.1_wp
   !> A joint in line with a bar counts as crowded by this part.
   real(wp), parameter :: in_line = 0.5_wp
   !> A later frame is taken if so many joints fewer are crowded. Reason: the first instant is what a reader expects,
   !> and rounding errors must not choose.
   real(wp), parameter :: much_clearer = 0.5_wp
   !> A mechanism of more links is drawn in its first frame: the search takes joints times links.
   integer, parameter :: max_links = 120
   !> A picture has this many faint positions at most and at least, and about this many faint links.
   integer, parameter :: max_faint = 4, min_faint = 2, faint_links = 15
   !> Positions that differ by less than this part of the mechanism would cover one another; closer than the other the
   !> motion has come back.
   real(wp), parameter :: alike = 0.03_wp, come_back = 1.0e-3_wp

contains

   !> The numbers of the frames from which a picture chooses: some of those at the deck's own instants, with the last.
   pure function candidates(d) result(list)
      type(drawing_t), intent(in) :: d
      integer, allocatable :: list(:)
      integer :: n, stride

      n = size(d%own)
      stride = max(1, 1 + (n - 2)/(picture_candidates - 1))
      list = d%own(1:n:stride)
      if (mod(n - 1, stride) /= 0) list = [list, d%own(n)]
   end function candidates

   !> The one of the frames `list` that is drawn in full: of those of which most links are known the clearest; 0 for
   !> none.
   integer function clearest(d, list) result(best)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: list(:)
      real(wp) :: crowded, least
      integer :: i, known

      best = 0
      known = -1
      least = huge(least)
      do i = 1, size(list)
         associate (s => d%frame(list(i)))
            if (count(s%known) < known) cycle
            crowded = crowded_joints(d, s)
            if (count(s%known) == known .and. crowded > least - much_clearer) cycle
            known = count(s%known)
            least = crowded
            best = list(i)
         end associate
      end do
   end function clearest

   !> How many joints are crowded at the position `s`: each by 1 on another's bar, by 0 at `clear_distance` from it.
   real(wp) function crowded_joints(d, s) result(crowded)
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      real(wp) :: extent, p(2)
      integer :: i, k, own(2), point

      crowded = 0.0_wp
      extent = extent_of(d, s)
      if (size(d%m%links) > max_links .or. .not. extent > 0.0_wp) return
      do i = 1, size(d%m%pairs)
         point = joint_point(d, s%known, i)
         if (point == 0) cycle
         own = d%m%points([d%m%pairs(i)%point_i, d%m%pairs(i)%point_j])%link
         p = point_place(d%m, s, point)/extent
         do k = 1, size(d%m%links)
            if (d%m%links(k)%ground .or. any(own == k) .or. .not. s%known(k) .or. size(d%outlines(k)%corner, 2) < 2) &
               cycle
            associate (corners => corners_at(d%outlines(k), s%place(:, k))/extent)
               crowded = crowded + max(nearness(distance_to(corners, p, 0.0_wp)), &
                  merge(in_line, 0.0_wp, size(corners, 2) == 2)*nearness(distance_to(corners, p, 1.0_wp)))
            end associate
         end do
         if (d%m%pairs(i)%kind /= pair_revolute) cycle
         do k = 1, size(d%guides)
            associate (g => d%guides(k))
               if (.not. s%known(g%carrier) .or. any(own == g%block)) cycle
               crowded = crowded + nearness(abs(cross(direction(s%place(3, g%carrier) + g%angle), &
                  p - point_of(s%place(:, g%carrier), g%foot)/extent)))
            end associate
         end do
      end do
   end function crowded_joints

   !> 1 at the distance 0, 0 at `clear_distance` and from there on.
   pure real(wp) function nearness(distance)
      real(wp), intent(in) :: distance

      nearness = max(0.0_wp, 1.0_wp - distance/clear_distance)
   end function nearness

   !> The larger side of what the known moving links cover at the position `s`.
   pure real(wp) function extent_of(d, s) result(extent)
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      real(wp) :: low(2), high(2)
      integer :: i

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do i = 1, size(d%m%links)
         if (d%m%links(i)%ground .or. .not. s%known(i)) cycle
         associate (p => corners_at(d%outlines(i), s%place(:, i)))
            low = min(low, minval(p, dim=2))
            high = max(high, maxval(p, dim=2))
         end associate
      end do
      extent = 0.0_wp
      if (all(high >= low)) extent = maxval(high - low)
   end function extent_of

   !> Those of the frames `own` that are faint beside frame `best`: evenly spaced, without those that are like it or
   !> like one another.
   function faint_frames(d, own, best) result(list)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: own(:), best
      integer, allocatable :: list(:)
      integer :: i, j, k, n

      allocate (list(0))
      n = max(min_faint, min(max_faint, faint_links/max(1, count(.not. d%m%links%ground))))
      do i = 0, n
         ! Where the motion comes back, the last frame is the first one again.
         k = own(1 + i*(size(own) - 1)/merge(n + 1, n, closes(d, own)))
         if (distance(d, k, best) < alike) cycle
         if (any([(distance(d, k, list(j)) < alike, j=1, size(list))])) cycle
         list = [list, k]
      end do
   end function faint_frames

   !> Whether the motion of the moving links through the frames `list` ends where it has begun.
   logical function closes(d, list)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: list(:)

      closes = .false.
      if (size(list) > 2) closes = distance(d, list(1), list(size(list))) < come_back
   end function closes

   !> The largest distance of a corner between frames `i` and `j`, in parts of the mechanism; 1 if one of them lacks a
   !> link.
   real(wp) function distance(d, i, j)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: i, j
      real(wp) :: extent
      integer :: k

      distance = 1.0_wp
      if (any(d%frame(i)%known .neqv. d%frame(j)%known)) return
      distance = 0.0_wp
      extent = extent_of(d, d%frame(i))
      do k = 1, size(d%m%links)
         if (d%m%links(k)%ground .or. .not. d%frame(i)%known(k)) cycle
         associate (p => corners_at(d%outlines(k), d%frame(i)%place(:, k)), &
            q => corners_at(d%outlines(k), d%frame(j)%place(:, k)))
            if (size(p) > 0) distance = max(distance, maxval(abs(p - q)))
         end associate
      end do
      if (distance > 0.0_wp) distance = distance/max(extent, distance)
   end function distance
end module picture_frames
