!> The animation of a run as SVG, without scripts. Each link is a group that moves and turns through the frames of a
!> drawing (SMIL), over the paths of points. The time is below. The browser interpolates between two frames, place and
!> angle evenly.
module animation
   use kinds, only: wp
   use plane_vectors, only: in_degrees, wrap_angle, point_of, direction, rotated
   use motion, only: flag_none
   use number_format, only: full, whole
   use drawing, only: drawing_t, max_intervals, max_positions
   use shapes, only: element_t, shapes_of, link_color, pole_name
   use canvas, only: canvas_t, label_t, make_canvas, to_pixels, draw_shape, record_shape, draw_label, draw_foot, &
      caption, line_height
   use labels, only: labels_of
   use svg, only: page_t, page_width, close_group, open_group, draw_window, draw_words, draw_circle, draw_columns, &
      pixels, attribute
   use listing, only: words_of_flag
   implicit none
   private
   public :: draw_animation

   !> The motion takes so long; then it begins again.
   character(*), parameter :: duration = '10s'
   !> A link that turns by more than this (rad) from one frame to the next is not turned in between: the links would
   !> part by more than 1 % of their lengths.
   real(wp), parameter :: max_turn = 0.3_wp
   !> The opacity of a link without a position, which stays at its last one.
   real(wp), parameter :: pale_opacity = 0.2_wp
   !> The animated attributes of a group.
   character(*), parameter :: turn_element = 'animateTransform attributeName="transform" type="rotate"', &
      shift_element = 'animateTransform attributeName="transform" type="translate"'

contains

   !> Draws the animation of a set at the end of a page; nothing if the set has no frames of TIME.
   subroutine draw_animation(page, drawing)
      type(page_t), intent(inout), target :: page   !< gets the animation
      type(drawing_t), intent(in), target :: drawing   !< all frames of the set
      type(canvas_t) :: canvas
      type(element_t), allocatable :: list(:)
      logical, allocatable :: is_fixed(:)
      integer, allocatable :: frame(:)       ! (keys) at equal steps of time
      logical :: smooth                      ! places between keys are interpolated
      integer :: i

      if (drawing%films == 0) return
      call make_canvas(page, drawing, drawing%frame(1), [(i, i=1, drawing%films)], canvas)
      call find_keys()
      canvas%snapshot = drawing%now
      list = shapes_of(drawing, canvas%scale)
      is_fixed = [(list(i)%link == 0, i=1, size(list))]
      where (.not. is_fixed) is_fixed = canvas%mechanism%links(max(1, list%link))%ground
      ! A centrode may run through the pictures of other sets.
      call draw_window(canvas%output, canvas%low, canvas%high)
      do i = 1, size(list)
         if (is_fixed(i) .and. list(i)%is_below) call draw_shape(canvas, list(i))
      end do
      call open_group(canvas%output, 'class="film" data-frames="'//whole(size(frame))//'" data-end="' &
         //full(drawing%frame(drawing%films)%t)//'"', '')
      call draw_moving_links()
      call draw_centres(canvas, frame)
      call close_group(canvas%output, 'g')
      call close_group(canvas%output, 'svg')
      do i = 1, size(list)
         if (is_fixed(i) .and. .not. list(i)%is_below) call draw_shape(canvas, list(i))
      end do

      call draw_names(canvas, list, frame, smooth)
      call draw_clock(canvas, frame)
      call draw_foot(canvas)

   contains

      !> Finds the frames that are shown, at equal steps, and whether places between them are interpolated: no link
      !> turns too far. The motion is not shown backwards: drives do not run so.
      subroutine find_keys()
         integer :: k, stride

         stride = max(1, 1 + (drawing%films - 2)/max(1, &
            min(max_intervals, max_positions/size(canvas%mechanism%links) - 1)))
         frame = [(min(k, drawing%films), k=1, drawing%films + stride - 1, stride)]
         smooth = .true.
         do k = 2, size(frame)
            associate (now => drawing%frame(frame(k)), before => drawing%frame(frame(k - 1)))
               if (any(now%known .and. before%known .and. &
                  abs(wrap_angle(now%place(3, :) - before%place(3, :))) > max_turn)) smooth = .false.
            end associate
         end do
      end subroutine find_keys

      !> Draws the moving links, each with its shapes in its own axes and turned about its first corner, later ones over
      !> earlier ones.
      subroutine draw_moving_links()
         type(canvas_t) :: axes
         real(wp) :: place(2, size(frame)), angle(1, size(frame)), position(3), turned
         logical :: known(size(frame))
         character(:), allocatable :: name
         integer :: link, k, last

         axes = canvas
         axes%snapshot%place = 0.0_wp
         axes%snapshot%known = .true.
         do link = 1, size(canvas%mechanism%links)
            if (canvas%mechanism%links(link)%ground .or. canvas%mechanism%links(link)%hidden .or. &
               size(drawing%outlines(link)%corner, 2) == 0) cycle
            known = [(drawing%frame(frame(k))%known(link), k=1, size(known))]
            if (.not. any(known)) cycle
            ! The link turns about a corner of its own: its origin may be far away.
            associate (corner => drawing%outlines(link)%corner(:, 1))
               axes%shift = -canvas%scale*corner*[1.0_wp, -1.0_wp]
               last = frame(findloc(known, .true., dim=1))
               turned = 0.0_wp
               do k = 1, size(known)
                  if (known(k)) last = frame(k)
                  position = drawing%frame(last)%place(:, link)
                  place(:, k) = to_pixels(canvas, point_of(position, corner))
                  turned = turned + wrap_angle(position(3) - turned)
                  angle(1, k) = -in_degrees(turned)
               end do
            end associate

            ! Two groups: one moves, one turns.
            name = trim(canvas%mechanism%links(link)%name)
            call open_group(canvas%output, 'class="link" '//attribute('data-link', name)//' transform="translate(' &
               //pixels(place(1, 1))//' '//pixels(place(2, 1))//')"', name)
            call draw_moving(canvas, shift_element, place, smooth)
            if (.not. all(known)) call draw_moving(canvas, 'animate attributeName="opacity"', &
               reshape(merge(1.0_wp, pale_opacity, known), [1, size(known)]), .false.)
            call open_group(canvas%output, 'transform="rotate('//pixels(angle(1, 1))//')"', '')
            call draw_moving(canvas, turn_element, angle, smooth)
            do k = 1, size(list)
               if (list(k)%link == link) call draw_shape(axes, list(k))
            end do
            call close_group(canvas%output, 'g')
            call close_group(canvas%output, 'g')
         end do
      end subroutine draw_moving_links
   end subroutine draw_animation

   !> Draws the ring of each instant centre, which is hidden at frames at which the centre is at infinity or not known.
   subroutine draw_centres(canvas, frame)
      type(canvas_t), intent(in) :: canvas   !< of the set
      integer, intent(in) :: frame(:)        !< (keys) at equal steps of time
      real(wp) :: place(2, size(frame))
      logical :: has(size(frame))
      integer :: i, k

      do i = 1, size(canvas%drawing%poles)
         has = [(canvas%drawing%frame(frame(k))%has_centre(i), k=1, size(frame))]
         if (.not. any(has)) cycle
         do k = 1, size(frame)
            place(:, k) = to_pixels(canvas, canvas%drawing%frame(frame(k))%centre(:, i))
         end do
         call open_group(canvas%output, 'class="pole" transform="translate(' &
            //pixels(place(1, 1))//' '//pixels(place(2, 1))//')"', pole_name(canvas%mechanism, canvas%drawing%poles(i)))
         call draw_moving(canvas, shift_element, place, .false.)
         if (.not. all(has)) call draw_moving(canvas, 'animate attributeName="opacity"', &
            reshape(merge(1.0_wp, 0.0_wp, has), [1, size(has)]), .false.)
         call draw_circle(canvas%output, [0.0_wp, 0.0_wp], 4.0_wp, 'class="centre" style="stroke:' &
            //link_color(canvas%mechanism, canvas%mechanism%requests(canvas%drawing%poles(i))%subject)//'"')
         call close_group(canvas%output, 'g')
      end do
   end subroutine draw_centres

   !> Writes the names of points and links at their best places in the first frame. Each name keeps its distance from
   !> its point or link.
   subroutine draw_names(canvas, list, frame, smooth)
      type(canvas_t), intent(inout) :: canvas   !< of the set; shows the first frame afterwards
      type(element_t), intent(in) :: list(:)   !< (any number) all shapes
      integer, intent(in) :: frame(:)        !< (keys) at equal steps of time
      logical, intent(in) :: smooth          !< places between keys are interpolated
      type(label_t), allocatable :: labels(:)
      real(wp) :: by(2, size(frame)), offset(2)
      integer :: i, k, last

      canvas%snapshot = canvas%drawing%frame(1)
      do i = 1, size(list)
         call record_shape(canvas, list(i))
      end do
      call labels_of(canvas, labels)

      do i = 1, size(labels)
         associate (link => labels(i)%link)
            call open_group(canvas%output, 'class="label"', '')
            if (.not. canvas%mechanism%links(link)%ground) then
               ! The place of the pixel in the axes of the link.
               offset = (labels(i)%of - canvas%shift)/canvas%scale*[1.0_wp, -1.0_wp]
               associate (place => canvas%snapshot%place(:, link))
                  offset = rotated(offset - place(:2), direction(-place(3)))
               end associate
               last = 1
               do k = 1, size(frame)
                  if (canvas%drawing%frame(frame(k))%known(link)) last = frame(k)
                  by(:, k) = to_pixels(canvas, point_of(canvas%drawing%frame(last)%place(:, link), offset)) &
                     - labels(i)%of
               end do
               call draw_moving(canvas, shift_element, by, smooth)
            end if
            call draw_label(canvas, labels(i))
            call close_group(canvas%output, 'g')
         end associate
      end do
   end subroutine draw_names

   !> Writes the time, in red with the reason if the instant is flagged: a column of lines in a window of one line.
   subroutine draw_clock(canvas, frame)
      type(canvas_t), intent(in) :: canvas   !< of the set
      integer, intent(in) :: frame(:)        !< (keys) at equal steps of time
      real(wp) :: up(2, size(frame))
      character(:), allocatable :: words
      integer :: k, y

      y = nint(canvas%high(2)) + 33
      call draw_window(canvas%output, real([14, y - line_height], wp), real([page_width - 14, y], wp))
      call open_group(canvas%output, 'class="clock"', '')
      up(1, :) = 0.0_wp
      up(2, :) = [(-real(line_height*(k - 1), wp), k=1, size(frame))]
      call draw_moving(canvas, shift_element, up, .false.)
      do k = 1, size(frame)
         associate (s => canvas%drawing%frame(frame(k)))
            words = caption(canvas, s%t)
            if (s%mark /= flag_none) words = words//': '//words_of_flag(s%mark, s%singularity, canvas%mechanism%polish)
            call draw_words(canvas%output, real([14, y + line_height*(k - 1) - 5], wp), 'start', &
               trim(merge('class="time flag"', 'class="time"     ', s%mark /= flag_none)), words)
         end associate
      end do
      call close_group(canvas%output, 'g')
      call close_group(canvas%output, 'svg')
   end subroutine draw_clock

   !> Writes an animated attribute of the group that is open; nothing if the attribute has one value only.
   subroutine draw_moving(canvas, element, values, smooth)
      type(canvas_t), intent(in) :: canvas   !< of the set
      character(*), intent(in) :: element    !< of SVG, with the name of the attribute
      real(wp), intent(in) :: values(:, :)   !< (1 or 2, keys) of the attribute at each key: pixels, degrees or opacity
      logical, intent(in) :: smooth          !< values between keys are interpolated

      if (size(values, 2) < 2) return
      call draw_columns(canvas%output, element//' calcMode="' &
         //trim(merge('linear  ', 'discrete', smooth))//'" dur="'&
         //duration//'" repeatCount="indefinite" values="', values, ' ', ';')
   end subroutine draw_moving
end module animation
