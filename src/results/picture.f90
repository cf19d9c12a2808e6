!> The picture of a run as SVG, one set below the other: the mechanism at one instant, faint at some others, the paths
!> of the points that PRINT asks for, the centrodes that POLE asks for, flagged positions, names, and a scale.
module picture
   use kinds, only: wp
   use mechanism, only: mechanism_t
   use drawing, only: drawing_t, snapshot_t
   use outline, only: is_same_place
   use picture_frames, only: clearest, faint_frames
   use canvas, only: canvas_t
   use picture_parts, only: put_body, put_outlines, put_flagged, put_guide, put_ground, put_block, put_joint, put_dot, &
      put_path, dots_of, color_of, joint_point
   use picture_drives, only: put_drives
   use picture_centrodes, only: put_centrodes, put_centres
   use picture_names, only: put_names
   use picture_page, only: choice_t, view_of, put_set_head, put_flags, put_scale, flag_lines, fitted, width, line_height
   use svg, only: svg_head, svg_end, put_group, put_group_end, put_words
   use text_output, only: output_t
   use phrases
   implicit none
   private
   public :: put_pictures, put_curves

contains

   !> Writes the picture of the `sets` as `drawings` has recorded them.
   subroutine put_pictures(o, sets, drawings)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: sets(:)
      type(drawing_t), intent(in) :: drawings(:)
      type(canvas_t) :: c(size(drawings))
      type(choice_t) :: choice(size(drawings))
      integer :: top(size(drawings) + 1), i, k

      top(1) = 0
      do i = 1, size(drawings)
         choice(i)%centrodes = .true.
         if (drawings(i)%assemblies) then
            choice(i)%best = 1
            choice(i)%faint = [(k, k=2, drawings(i)%frames)]
         else
            choice(i)%best = clearest(sets(i), drawings(i))
            choice(i)%faint = faint_frames(sets(i), drawings(i), choice(i)%best)
         end if
         call view_of(sets(i), drawings(i), choice(i), top(i), c(i), top(i + 1))
      end do
      call svg_head(o, width, max(1, top(size(top))))
      do i = 1, size(drawings)
         call put_set(o, c(i), sets(i), drawings(i), choice(i), top(i), top(i + 1))
      end do
      call svg_end(o)
   end subroutine put_pictures

   !> One set, from the pixel `top` to above `bottom`.
   subroutine put_set(o, c, m, d, choice, top, bottom)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(choice_t), intent(in) :: choice
      integer, intent(in) :: top, bottom
      type(snapshot_t) :: s
      integer :: i

      s = d%now
      if (choice%best > 0) s = d%frame(choice%best)
      call put_set_head(o, c, m, d, s%t, top)
      call put_group(o, 'class="faint"', '')
      do i = 1, size(choice%faint)
         call put_outlines(o, c, m, d, d%frame(choice%faint(i)))
      end do
      call put_group_end(o)
      call put_curves(o, c, m, d)
      call put_centrodes(o, c, m, d, s)
      do i = 1, size(d%flags)
         call put_flagged(o, c, m, d, d%flags(i)%last)
      end do
      call put_mechanism(o, c, m, d, s)
      call put_drives(o, c, m, d, s)
      call put_centres(o, c, m, d, s)
      call put_names(o, c, m, d, s)
      call put_times(o, m, d, choice, bottom)
      call put_flags(o, m, d, bottom)
      call put_scale(o, c, m)
      call put_group_end(o)
   end subroutine put_set

   !> The paths of the points.
   subroutine put_curves(o, c, m, d)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      integer :: i

      do i = 1, size(d%curves)
         if (moves(d, i)) call put_path(o, c, d%curves(i), trim(m%points(d%curves(i)%point)%name), &
            color_of(m%points(d%curves(i)%point)%link))
      end do
   end subroutine put_curves

   !> Ground, links and pairs in full at the position `s`.
   subroutine put_mechanism(o, c, m, d, s)
      type(output_t), intent(inout) :: o
      type(canvas_t), intent(inout) :: c
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(snapshot_t), intent(in) :: s
      integer, allocatable :: dots(:)
      integer :: i

      dots = dots_of(m)
      call put_ground(o, c, m, d)
      do i = 1, size(d%guides)
         call put_guide(o, c, m, d%guides(i), s)
      end do
      do i = 1, size(m%links)
         call put_body(o, c, m, d, s, i)
      end do
      do i = 1, size(d%guides)
         call put_block(o, c, m, d%guides(i), s)
      end do
      do i = 1, size(m%pairs)
         call put_joint(o, c, m, s, i, joint_point(m, s%known, i))
      end do
      do i = 1, size(dots)
         call put_dot(o, c, m, s, dots(i))
      end do
   end subroutine put_mechanism

   !> Whether curve number `i` is more than one place, and no curve before has the same places.
   pure logical function moves(d, i)
      type(drawing_t), intent(in) :: d
      integer, intent(in) :: i
      real(wp) :: extent
      integer :: k, j

      moves = .false.
      associate (curve => d%curves(i))
         if (size(curve%known) == 0) return
         extent = maxval(abs(curve%place))
         do k = 2, size(curve%known)
            moves = moves .or. (all(curve%known(k - 1:k) >= 0) .and. &
               .not. is_same_place(curve%place(:, k), curve%place(:, k - 1), extent))
         end do
         do j = 1, i - 1
            if (all(abs(d%curves(j)%place - curve%place) <= 1.0e-6_wp*extent) &
               .and. all(d%curves(j)%known == curve%known)) moves = .false.
         end do
      end associate
   end function moves

   !> At the foot: the instant that is drawn, and those, or the assemblies, that are faint.
   subroutine put_times(o, m, d, choice, bottom)
      type(output_t), intent(inout) :: o
      type(mechanism_t), intent(in) :: m
      type(drawing_t), intent(in) :: d
      type(choice_t), intent(in) :: choice
      integer, intent(in) :: bottom
      character(:), allocatable :: now, others
      real(wp) :: y
      integer :: i

      if (choice%best == 0) return
      y = real(bottom - 16 - line_height*flag_lines(d), wp)
      now = 'T = '//fitted(d%frame(choice%best)%t)//' '//trim(m%time_unit)
      call put_words(o, [14.0_wp, y], 'start', 'class="time"', now)
      others = ''
      do i = 1, size(choice%faint)
         if (i > 1) others = others//', '
         others = others//fitted(d%frame(choice%faint(i))%t)
      end do
      others = phrase(say_faint, m%polish)//' '//others
      if (d%assemblies) others = phrase(say_faint_assemblies, m%polish)
      if (size(choice%faint) > 0) &
         call put_words(o, [real(32 + 9*len(now), wp), y], 'start', 'class="between"', others)
   end subroutine put_times

end module picture
