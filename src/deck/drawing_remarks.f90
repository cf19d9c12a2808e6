!> Remarks on a deck with JOINT cards, whose drawing is the mechanism: numbers that are as drawn, numbers that
!> contradict the drawing, and joints that may be meant as one point.
module drawing_remarks
   use kinds, only: wp
   use planar, only: in_degrees, without_turns, direction
   use drives, only: new_law, drive_motion
   use mechanism, only: mechanism_t, pair_prismatic, pair_links, driven_kinds, request_link, request_pair, instant, &
      remark_drawn_value, remark_drawn_offset, remark_open, remark_off_drawing, remark_near_joints
   use drawn_values, only: drawn_drive, drawn_opening, drawn_way
   use scales, only: solver_length
   use grouping, only: sorted_t, sorted, members
   use numerals, only: rounded
   use cards, only: label_a, label_b, label_c, form_joint, form_drive
   use card_sets, only: card_set_t, has_drawing, add_card_remark
   implicit none
   private
   public :: check_drawing, drawn_text

   !> Digits of a number as drawn, as far as its kind has them.
   integer, parameter :: drawn_text_digits = min(9, precision(1.0_wp))

   !> Coordinates measured in a drawing have some four digits: a closure error below this, in rad or in parts of the
   !> characteristic length, contradicts nothing.
   real(wp), parameter :: drawn_digits = 1.0e-4_wp
   !> Two joints of a link that are nearer than this part of the greatest distance of joints may be meant as one point.
   real(wp), parameter :: near = 0.03_wp
   !> So many such remarks are enough. Of more joints than some thousand of one link many are near one another: the
   !> search then ends early.
   integer, parameter :: max_near = 50

contains

   !> Remarks on the drawing of `set`, if it is one. The set has no errors.
   subroutine check_drawing(set)
      type(card_set_t), intent(inout) :: set
      real(wp) :: length
      integer :: i

      if (.not. has_drawing(set)) return
      length = solver_length(set%mechanism)
      do i = 1, size(set%mechanism%pairs)
         call check_pair(set, i, length)
      end do
      do i = 1, set%count
         if (set%cards(i)%form == form_drive) call check_drive(set, i, length)
      end do
      call check_joints(set)
   end subroutine check_drawing

   !> Remarks on pair number `i`: an h as drawn of points that are not along the guide, and numbers or points that leave
   !> a closure error in the drawing. `length`: the characteristic one.
   subroutine check_pair(set, i, length)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: i
      real(wp), intent(in) :: length
      real(wp) :: x, turn

      associate (m => set%mechanism, pair => set%mechanism%pairs(i))
         turn = 0.0_wp
         if (pair%kind /= pair_prismatic) then
            x = norm2(drawn_way(m, pair))
         else
            x = drawn_opening(m, pair)
            if (.not. pair%drawn(3)) then
               associate (phi => m%links(pair_links(m, pair))%position(3))
                  turn = without_turns(phi(2) - phi(1) - pair%beta)
               end associate
            end if
            if (pair%drawn(2) .and. abs(pair%offset) > drawn_digits*length) &
               call remark_on_pair(remark_drawn_offset, with_unit(m, pair%offset, .false.))
         end if
         if (abs(x) > drawn_digits*length) call remark_on_pair(remark_open, with_unit(m, x, .false.))
         if (abs(turn) > drawn_digits) call remark_on_pair(remark_open, with_unit(m, turn, .true.))
      end associate

   contains

      !> Adds the remark `kind` about the pair.
      subroutine remark_on_pair(kind, value)
         integer, intent(in) :: kind
         character(*), intent(in) :: value

         associate (k => set%named(request_pair)%card(i))
            call add_card_remark(set, kind, k, merge(label_a, label_c, set%cards(k)%form == form_joint), value)
         end associate
      end subroutine remark_on_pair
   end subroutine check_pair

   !> Remarks on the drive of card `k`: its value as drawn, if it is not 0, and by how much the motion begins off the
   !> drawing at the first instant, whole turns left out. `length`: the characteristic one.
   subroutine check_drive(set, k, length)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k
      real(wp), intent(in) :: length
      real(wp) :: f(3), off
      logical :: is_angle

      associate (m => set%mechanism, drive => set%mechanism%drives(set%cards(k)%subject))
         is_angle = driven_kinds(drive%kind) == request_link
         if (drive%drawn .and. abs(drive%polynomial(1)) > 0.0_wp) &
            call add_card_remark(set, remark_drawn_value, k, label_b, with_unit(m, drive%polynomial(1), is_angle))
         f = drive_motion(new_law(drive), instant(m, 0))
         off = f(1) - drawn_drive(m, drive)
         if (is_angle) off = without_turns(off)
         if (abs(off) > drawn_digits*merge(1.0_wp, length, is_angle)) &
            call add_card_remark(set, remark_off_drawing, k, label_b, with_unit(m, off, is_angle))
      end associate
   end subroutine check_drive

   !> A remark on each JOINT card whose place is very near that of another one of the same link, but not at it. Three
   !> links at one point, with two cards of the same place, are as they should be.
   subroutine check_joints(set)
      type(card_set_t), intent(inout) :: set
      type(sorted_t) :: joints_of
      real(wp), allocatable :: place(:, :)
      logical, allocatable :: is_remarked(:)
      integer, allocatable :: cards(:), list(:)
      real(wp) :: limit, distance
      integer :: i, j, k, link, found

      cards = pack([(k, k=1, set%count)], set%cards(:set%count)%form == form_joint)
      allocate (place(2, size(cards)), is_remarked(size(cards)))
      do i = 1, size(cards)
         place(:, i) = set%cards(cards(i))%real(1:2)
      end do
      is_remarked = .false.
      found = 0
      limit = near*extent(place)
      associate (m => set%mechanism)
         joints_of = sorted([m%points(set%cards(cards)%subject)%link, m%points(set%cards(cards)%subject + 1)%link], &
            size(m%links))
      end associate
      do link = 1, size(set%mechanism%links)
         list = modulo(members(joints_of, link) - 1, size(cards)) + 1
         do i = 2, size(list)
            do j = 1, i - 1
               distance = norm2(place(:, list(i)) - place(:, list(j)))
               if (distance >= limit .or. .not. distance > 0.0_wp) cycle
               k = max(list(i), list(j))
               if (is_remarked(k)) exit
               is_remarked(k) = .true.
               found = found + 1
               call add_card_remark(set, remark_near_joints, cards(k), label_a, &
                  with_unit(set%mechanism, distance, .false.) &
                  //' ('//trim(set%cards(cards(min(list(i), list(j))))%label(label_a))//')')
               exit
            end do
            if (found == max_near) return
         end do
      end do
   end subroutine check_joints

   !> The greatest distance of the places `p` (2, :), some per thousand too small at most: the greatest extent of all of
   !> them in one of 32 directions.
   pure real(wp) function extent(p)
      real(wp), intent(in) :: p(:, :)
      integer, parameter :: directions = 32
      real(wp) :: along(size(p, 2))
      integer :: i

      extent = 0.0_wp
      do i = 1, directions
         along = matmul(direction(acos(-1.0_wp)*real(i, wp)/real(directions, wp)), p)
         extent = max(extent, maxval(along) - minval(along))
      end do
   end function extent

   !> The length or angle `x` (rad) of `m`, with its unit.
   pure function with_unit(m, x, is_angle) result(text)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: x
      logical, intent(in) :: is_angle
      character(:), allocatable :: text

      if (.not. is_angle) then
         text = drawn_text(x)//' '//trim(m%length_unit)
      else if (m%degrees) then
         text = drawn_text(in_degrees(x))//' DEG'
      else
         text = drawn_text(x)//' RAD'
      end if
   end function with_unit

   !> `x` with its digits, zeros at the end left out but for one behind the point; a very small or large one with an
   !> exponent, and two digits fewer.
   pure function drawn_text(x) result(text)
      real(wp), intent(in) :: x
      character(:), allocatable :: text
      real(wp), parameter :: small = 1.0e-3_wp, smallest = 1.0e-2_wp, largest = 1.0e8_wp

      if (abs(x) > 0.0_wp .and. (abs(x) < small .or. abs(x) >= largest)) then
         text = rounded(x, drawn_text_digits - 2, small, largest)
      else
         ! At most ten decimals.
         text = rounded(x, drawn_text_digits - merge(1, 0, abs(x) < smallest), small, largest)
         text = text(:verify(text, '0', back=.true.))
         if (text(len(text):) == '.') text = text//'0'
      end if
   end function drawn_text
end module drawing_remarks
