!> The animation of a run as SVG, without scripts: the links move through the frames of a drawing over the paths of
!> points, with the time below, and a bar on which it passes.
module animation
   use kinds, only: wp
   use planar, only: in_degrees, without_turns
   use mechanism, only: mechanism_t, instant
   use scales, only: is_length
   use drives, only: law_t, drive_motion, new_law, pole_value
   use motion, only: mark_none
   use names, only: drive_name
   use numerals, only: full, whole
   use drawing, only: drawing_t, max_positions
   use canvas, only: canvas_t, make_canvas
   use picture_frames, only: closes
   use picture_parts, only: put_flagged, put_guide, put_ground, put_block
   use picture, only: put_curves
   use picture_page, only: place_canvas, put_set_head, put_flags, put_scale, flag_lines, fitted, width, line_height
   use picture_centrodes, only: put_centrodes
   use moving_links, only: course_t, put_moving, shift, put_moving_links, put_moving_centres
   use svg, only: svg_head, put_end, put_group, put_window, put_circle, put_line, put_words, translation
   use text_output, only: output_t
   use listing, only: words_of_mark
   implicit none
   private
   public :: film_of, put_animations

   !> An animation has at most this many intervals between its frames.
   integer, parameter, public :: max_intervals = 360
   !> The time from its first to its last frame, and of the rest at its end where the motion does not come back (s).
   real(wp), parameter :: motion_seconds = 10.0_wp, pause_seconds = 1.0_wp
   !> A link that turns by more than this (rad) from one frame to the next is not turned in between: the links would
   !> part by more than 1 % of their lengths.
   real(wp), parameter :: max_turn = 0.3_wp
   !> Room for the bar of the time, its ends, the height of a mark on it, the radius of its dot.
   integer, parameter :: bar_room = 14
   real(wp), parameter :: bar_ends(2) = [14.0_wp, real(width - 24, wp)], mark_height = 5.0_wp, dot_radius = 4.0_wp
   !> The values of so many drives stand beside the time.
   integer, parameter :: max_drives = 3
   !> So near to a pole of a law, in parts of a step, no instant is computed between those of the deck.
   real(wp), parameter :: near_pole = 1.0e-2_wp
   !> What is smaller than this part of the largest value of a drive is 0: six digits are shown.
   real(wp), parameter :: not_shown = 1.0e-9_wp

contains

   !> `m` at the instants of its animation: those of TIME and instants between them, or where there is no TIME between
   !> the first and the last of AT; none at the pole of a law. `every`: each so many of them are of the deck; 0: none
   !> but those of AT.
   subroutine film_of(m, film, every)
      type(mechanism_t), intent(in) :: m
      type(mechanism_t), intent(out) :: film
      integer, intent(out) :: every

      film = m
      every = 1
      if (m%steps < 0) then
         film%t0 = minval(m%at)
         film%t1 = maxval(m%at)
         film%steps = merge(max_intervals, 0, film%t1 > film%t0)
         every = 0
         if (meets_pole(film)) film%steps = film%steps - 1
      else if (m%steps > 0) then
         every = max(1, min(max_intervals, max_positions/size(m%links))/m%steps)
         film%steps = every*m%steps
         do while (every > 1 .and. meets_pole(film))
            every = every - 1
            film%steps = every*m%steps
         end do
      end if
   end subroutine film_of

   !> An instant of TIME of `m` is at the pole of a law, or so near that its value would mean nothing.
   pure logical function meets_pole(m)
      type(mechanism_t), intent(in) :: m
      integer :: i, k

      meets_pole = .false.
      do i = 1, size(m%drives)
         if (abs(pole_value(m%drives(i), m%t0)) <= 0.0_wp) cycle
         meets_pole = any([(abs(instant(m, k))*m%steps <= near_pole*abs(m%t1 - m%t0), k=0, m%steps)])
         return
      end do
   end function meets_pole

   !> Writes the animation of the sets that `films` have recorded, one below the other.
   subroutine put_animations(o, films)
      type(output_t), intent(inout), target :: o
      type(drawing_t), intent(in), target :: films(:)
      type(canvas_t) :: page(size(films))
      integer :: top, i, k

      top = 0
      do i = 1, size(films)
         call make_canvas(o, films(i), page(i))
         page(i)%best = min(1, films(i)%frames)
         page(i)%faint = [(k, k=1, films(i)%frames)]
         call place_canvas(page(i), top)
         top = page(i)%bottom + bar_room
      end do
      call svg_head(o, width, max(1, top))
      do i = 1, size(films)
         if (films(i)%frames > 0) call put_film(page(i))
      end do
      call put_end(o, 'svg')
   end subroutine put_animations

   !> One set, with the bar of the time below.
   subroutine put_film(c)
      type(canvas_t), intent(inout) :: c
      type(course_t) :: course
      integer :: i

      course = course_of(c%d)
      call put_set_head(c, c%d%frame(1)%t)
      call put_curves(c)
      do i = 1, size(c%d%flags)
         call put_flagged(c, c%d%flags(i)%last)
      end do
      call put_ground(c)
      do i = 1, size(c%d%guides)
         if (c%m%links(c%d%guides(i)%carrier)%ground) call put_guide(c, c%d%guides(i))
      end do
      do i = 1, size(c%m%links)
         if (c%m%links(i)%ground) call put_centrodes(c, i)
      end do
      ! A centrode in a link that moves may run through the pictures of other sets.
      if (size(c%d%centrodes) > 0) then
         call put_window(c%o, c%low, c%high - c%low)
         call put_group(c%o, translation(-c%low), '')
      end if
      call put_group(c%o, 'class="film" data-frames="'//whole(c%d%frames)//'" data-keys="'//whole(size(course%frame)) &
         //'" data-end="'//full(c%d%frame(c%d%frames)%t)//'"', '')
      call put_moving_links(c, course)
      call put_moving_centres(c, course)
      call put_end(c%o, 'g')
      if (size(c%d%centrodes) > 0) then
         call put_end(c%o, 'g')
         call put_end(c%o, 'svg')
      end if
      do i = 1, size(c%d%guides)
         if (c%m%links(c%d%guides(i)%block)%ground) call put_block(c, c%d%guides(i))
      end do
      call put_clock(c, course)
      call put_flags(c)
      call put_bar(c, course)
      call put_scale(c)
      call put_end(c%o, 'g')
   end subroutine put_film

   !> The motion begins anew after its end: at once where it has come back, otherwise after a pause. It is not shown
   !> backwards: drives do not run so.
   function course_of(d) result(course)
      type(drawing_t), intent(in) :: d
      type(course_t) :: course
      integer :: k, pause

      pause = 0
      if (.not. closes(d)) pause = nint(real(d%frames - 1, wp)*pause_seconds/motion_seconds)
      course%frame = [(min(k, d%frames), k=1, d%frames + pause)]
      course%seconds = motion_seconds*real(max(1, d%frames + pause - 1), wp)/real(max(1, d%frames - 1), wp)
      do k = 2, d%frames
         associate (now => d%frame(k), before => d%frame(k - 1))
            if (any(now%known .and. before%known .and. &
               abs(without_turns(now%place(3, :) - before%place(3, :))) > max_turn)) course%smooth = .false.
         end associate
      end do
   end function course_of

   !> The time and the values of drives, in red with its words where the instant is flagged: a column of lines behind a
   !> window of one line.
   subroutine put_clock(c, course)
      type(canvas_t), intent(in) :: c
      type(course_t), intent(in) :: course
      real(wp) :: up(2, size(course%frame))
      real(wp) :: value(min(max_drives, size(c%m%drives)), c%d%frames)
      character(:), allocatable :: words
      integer :: k, i, y

      y = c%bottom - 16 - line_height*flag_lines(c%d)
      value = drive_values(c%d)
      call put_window(c%o, real([14, y - line_height + 5], wp), real([width - 28, line_height], wp))
      call put_group(c%o, 'class="clock"', '')
      up(1, :) = 0.0_wp
      up(2, :) = -real(line_height*(course%frame - 1), wp)
      call put_moving(c%o, course, shift, up, .false.)
      do k = 1, c%d%frames
         associate (s => c%d%frame(k))
            words = 'T = '//fitted(s%t)//' '//trim(c%m%time_unit)
            do i = 1, size(value, 1)
               words = words//', '//trim(drive_name(c%m, c%m%drives(i)))//' = '//fitted(value(i, k))
            end do
            if (s%mark /= mark_none) words = words//': '//words_of_mark(s%mark, s%singularity, c%m%polish)
            call put_words(c%o, real([0, line_height*k - 5], wp), 'start', &
               trim(merge('class="time flag"', 'class="time"     ', s%mark /= mark_none)), words)
         end associate
      end do
      call put_end(c%o, 'g')
      call put_end(c%o, 'svg')
   end subroutine put_clock

   !> The values of the first drives at the frames, angles in the deck's unit. Rounding errors of a 0 are not shown.
   function drive_values(d) result(value)
      type(drawing_t), intent(in) :: d
      real(wp) :: value(min(max_drives, size(d%m%drives)), d%frames), f(0:2)
      type(law_t) :: law
      integer :: i, k

      do i = 1, size(value, 1)
         law = new_law(d%m%drives(i))
         do k = 1, d%frames
            f = drive_motion(law, d%frame(k)%t)
            value(i, k) = f(0)
         end do
         if (d%m%degrees .and. .not. is_length(d%m%drives(i))) value(i, :) = in_degrees(value(i, :))
         ! Beside a pole of its law a value may be beyond the range of reals.
         value(i, :) = max(-huge(1.0_wp), min(huge(1.0_wp), value(i, :)))
         where (abs(value(i, :)) < not_shown*maxval(abs(value(i, :)))) value(i, :) = 0.0_wp
      end do
   end function drive_values

   !> The bar on which the time passes, with red marks at flagged instants.
   subroutine put_bar(c, course)
      type(canvas_t), intent(in) :: c
      type(course_t), intent(in) :: course
      real(wp) :: x, y, last, first(2)
      integer :: k

      y = real(c%bottom, wp)
      first = [bar_ends(1), y]
      call put_line(c%o, 'polyline', reshape([first, bar_ends(2), y], [2, 2]), 'class="time"')
      last = -1.0_wp
      do k = 1, size(c%d%flagged_at)
         x = along_bar(c%d, c%d%flagged_at(k))
         if (abs(x - last) < 1.0_wp) cycle
         last = x
         call put_line(c%o, 'polyline', reshape([x, y - mark_height, x, y + mark_height], [2, 2]), 'class="mark"')
      end do
      call put_group(c%o, 'class="now"', '')
      call put_moving(c%o, course, shift, reshape([(along_bar(c%d, c%d%frame(course%frame(k))%t) - first(1), 0.0_wp, &
         k=1, size(course%frame))], [2, size(course%frame)]), course%smooth)
      call put_circle(c%o, first, dot_radius, 'class="point"')
      call put_end(c%o, 'g')
   end subroutine put_bar

   !> Where the time `t` is on the bar (pixel).
   pure real(wp) function along_bar(d, t) result(x)
      type(drawing_t), intent(in) :: d
      real(wp), intent(in) :: t
      real(wp) :: part

      part = 0.0_wp
      associate (t0 => d%frame(1)%t, t1 => d%frame(d%frames)%t)
         if (abs(t1 - t0) > 0.0_wp) part = min(1.0_wp, max(0.0_wp, (t - t0)/(t1 - t0)))
      end associate
      x = bar_ends(1) + part*(bar_ends(2) - bar_ends(1))
   end function along_bar
end module animation
