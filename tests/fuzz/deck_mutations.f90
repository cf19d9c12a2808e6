!> Tests. Changes of a deck that leave it a deck: lengths, angles, order, scale, and those of `drive_mutations`
!> and `deck_surplus`. What comes of it may have no solution, but it goes through the solver.
module deck_mutations
   use kinds, only: wp
   use dice, only: dice_t, throw, chance, between, magnitude
   use deck_draft, only: draft_t, name_of, label, set_label, real_field, set_real, set_full, insert_line, drop_line, &
      find_cards, add_note
   use deck_changes, only: pick, near, put_real, is_degrees
   use drive_mutations, only: change_drive, add_term, change_time, change_at, change_method, exchange_drive
   use deck_surplus, only: double_pair, double_drive, extra_drive, far_rough, round_drive
   implicit none
   private
   public :: prepare, change_gently, max_steps

   !> So many steps of a TIME card at most: runs are to be short.
   integer, parameter :: max_steps = 40
   real(wp), parameter :: pi = 3.141592653589793_wp

contains

   !> Few instants, over the whole of the motion or with the steps as they were; mostly all rows in the tables.
   subroutine prepare(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer, allocatable :: cards(:)
      integer :: i, n, before

      cards = find_cards(d, ['TIME    '])
      do i = 1, size(cards)
         read (d%line(cards(i))(9:16), *) before
         n = throw(r, merge(4, 10, chance(r, 0.7_wp)))
         if (chance(r, 0.5_wp) .and. label(d%line(cards(i)), 2) == '') call set_real(d, cards(i), 2, real_field(d, cards(i), 1) &
            + (real_field(d, cards(i), 2) - real_field(d, cards(i), 1))*n/before)
         write (d%line(cards(i))(9:16), '(i0)') n
      end do
      if (chance(r, 0.1_wp)) return
      cards = find_cards(d, ['PRINT   '])
      do i = size(cards), 1, -1
         call drop_line(d, cards(i))
      end do
      i = size(d%line)
      if (chance(r, 0.9_wp)) then
         call insert_line(d, i, 'PRINT   ALL')
      else
         call insert_line(d, i, 'PRINT   LINKS           3')
      end if
   end subroutine prepare

   !> One change of one of the kinds below.
   subroutine change_gently(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r

      select case (throw(r, 41))
      case (1:5); call change_length(d, r)
      case (6:7); call change_rough(d, r)
      case (8); call change_real(d, r, ['GROUND  ', 'PRISM   ', 'SLOT    ', 'CYLINDER'])
      case (9:11); call change_drive(d, r)
      case (12:13); call add_term(d, r)
      case (14:15); call change_time(d, r)
      case (16); call change_method(d, r)
      case (17:18); call exchange_drive(d, r)
      case (19); call scale_lengths(d, r)
      case (20); call copy_length(d, r)
      case (21); call swap_alike(d, r)
      case (22); call swap_ends(d, r)
      case (23); call make_prism(d, r)
      case (24:27); call double_pair(d, r)
      case (28:29); call double_drive(d, r)
      case (30); call extra_drive(d, r)
      case (31:32); call far_rough(d, r)
      case (33); call round_drive(d, r)
      case (34); call make_slot(d, r)
      case (35:36); call give_length(d, r)
      case (37); call give_bar(d, r)
      case (38:39); call give_stroke(d, r)
      case (40); call count_turns(d, r)
      case default; call change_at(d, r)
      end select
   end subroutine change_gently

   subroutine change_real(d, r, names)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      character(8), intent(in) :: names(:)
      integer :: i, k

      i = pick(r, find_cards(d, names))
      if (i == 0) return
      k = throw(r, 3)
      call put_real(d, r, i, k, near(real_field(d, i, k), r))
      call add_note(d, 'REAL OF '//d%line(i)(1:16))
   end subroutine change_real

   subroutine change_length(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, k

      i = pick(r, find_cards(d, ['POINT   ', 'JOINT   ']))
      if (i == 0) return
      k = merge(1, 2, chance(r, 0.7_wp))
      call put_real(d, r, i, k, near(real_field(d, i, k), r))
      call add_note(d, 'LENGTH '//d%line(i)(9:16))
   end subroutine change_length

   subroutine change_rough(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, k

      i = pick(r, find_cards(d, ['LINK    ']))
      if (i == 0) return
      k = throw(r, 4)
      if (k == 4) then
         call put_real(d, r, i, 3, between(r, -360.0_wp, 360.0_wp)*merge(1.0_wp, pi/180.0_wp, is_degrees(d)))
      else
         call put_real(d, r, i, k, near(real_field(d, i, k), r))
      end if
      call add_note(d, 'ROUGH POSITION '//d%line(i)(9:16))
   end subroutine change_rough

   !> All lengths times one factor.
   subroutine scale_lengths(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      real(wp) :: factor
      integer :: i, k
      logical :: driven

      factor = magnitude(r, merge(3, merge(12, 150, chance(r, 0.7_wp)), chance(r, 0.5_wp)))
      driven = .false.
      do i = size(d%line), 1, -1
         select case (name_of(d%line(i)))
         case ('POINT', 'GROUND', 'LINK', 'JOINT')
            call set_full(d, i, 1, factor*real_field(d, i, 1))
            call set_full(d, i, 2, factor*real_field(d, i, 2))
         case ('LENGTH')
            call set_full(d, i, 1, factor*real_field(d, i, 1))
         case ('SLOT')
            call set_full(d, i, 2, factor*real_field(d, i, 2))
         case ('PRISM')
            call set_full(d, i, 2, factor*real_field(d, i, 2))
         case ('CYLINDER')
            do k = 1, 2
               if (abs(real_field(d, i, k)) > 0.0_wp) call set_full(d, i, k, factor*real_field(d, i, k))
            end do
         case ('DRIVE')
            driven = all(label(d%line(i), 1) /= ['ANGLE   ', 'RELANGLE'])
            if (.not. driven) cycle
            call set_full(d, i, 1, factor*real_field(d, i, 1))
            call set_full(d, i, 2, factor*real_field(d, i, 2))
            call set_full(d, i, 3, factor*real_field(d, i, 3))
         case ('ADD', 'RISE')
            if (.not. is_length_term(d, i)) cycle
            k = merge(2, 1, label(d%line(i), 1) == 'TABLE')
            if (name_of(d%line(i)) == 'RISE') k = 3
            call set_full(d, i, k, factor*real_field(d, i, k))
         end select
      end do
      call add_note(d, 'ALL LENGTHS SCALED')
   end subroutine scale_lengths

   !> The ADD or RISE card on line `i` stands under a drive of a length.
   logical function is_length_term(d, i)
      type(draft_t), intent(in) :: d
      integer, intent(in) :: i
      integer :: k

      do k = i, 1, -1
         if (name_of(d%line(k)) == 'DRIVE') exit
      end do
      is_length_term = .false.
      if (k > 0) is_length_term = all(label(d%line(k), 1) /= ['ANGLE   ', 'RELANGLE'])
   end function is_length_term

   !> Equal lengths: change points, parallelograms, links folded upon each other.
   subroutine copy_length(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer, allocatable :: cards(:)
      integer :: i, j

      cards = find_cards(d, ['POINT   '])
      i = pick(r, cards)
      j = pick(r, cards)
      if (i == 0) return
      call set_full(d, i, 1, real_field(d, j, 1))
      call add_note(d, 'LENGTH '//d%line(i)(9:16)//' AS '//d%line(min(j, size(d%line)))(9:16))
   end subroutine copy_length

   !> Two cards of one kind change places.
   subroutine swap_alike(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer, allocatable :: cards(:)
      integer :: i, j

      cards = find_cards(d, ['LINK    ', 'POINT   ', 'REVOLUTE', 'PRISM   ', 'JOINT   ', 'LENGTH  ', 'SLOT    ', 'CYLINDER'])
      i = pick(r, cards)
      if (i == 0) return
      j = pick(r, find_cards(d, [name_of(d%line(i))]))
      if (any(d%line(min([i, j] + 1, size(d%line)))(1:1) == '*')) return
      d%line([i, j]) = d%line([j, i])
      call add_note(d, 'ORDER OF '//d%line(i)(1:16)//' '//d%line(j)(1:16))
   end subroutine swap_alike

   !> The two points of a pair change places.
   subroutine swap_ends(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i
      character(8) :: first

      i = pick(r, find_cards(d, ['REVOLUTE', 'PRISM   ', 'SLOT    ', 'CYLINDER', 'LENGTH  ']))
      if (i == 0) return
      first = label(d%line(i), 1)
      call set_label(d%line(i), 1, label(d%line(i), 2))
      call set_label(d%line(i), 2, first)
      call add_note(d, 'ENDS OF '//d%line(i)(1:32))
   end subroutine swap_ends

   !> A revolute pair becomes a prismatic one, with any numbers.
   subroutine make_prism(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, k

      i = pick(r, find_cards(d, ['REVOLUTE']))
      if (i == 0) return
      d%line(i)(1:8) = 'PRISM'
      do k = 1, 3
         if (chance(r, 0.5_wp)) call set_real(d, i, k, between(r, -2.0_wp, 2.0_wp))
      end do
      call add_note(d, d%line(i)(1:32))
   end subroutine make_prism

   !> A revolute pair becomes a slot, whose slide is driven.
   subroutine make_slot(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      character(80) :: card
      integer :: i

      i = pick(r, find_cards(d, ['REVOLUTE']))
      if (i == 0) return
      d%line(i)(1:8) = 'SLOT'
      if (chance(r, 0.7_wp)) call set_real(d, i, 1, between(r, -2.0_wp, 2.0_wp))
      if (chance(r, 0.3_wp)) call set_real(d, i, 2, between(r, -0.2_wp, 0.2_wp))
      write (card, '(a, t33, 2es16.8e3)') 'DRIVE   SLIDE   '//label(d%line(i), 3), between(r, -0.3_wp, 0.3_wp), &
         between(r, -0.1_wp, 0.1_wp)
      call insert_line(d, size(d%line), card)
      call add_note(d, 'SLOT '//d%line(i)(9:32))
   end subroutine make_slot

   !> A cylinder gets a stroke, in which its drawing mostly is.
   subroutine give_stroke(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      real(wp) :: ends(2, 2), length
      integer, allocatable :: joints(:)
      integer :: i, k, j

      i = pick(r, find_cards(d, ['CYLINDER']))
      if (i == 0) return
      joints = find_cards(d, ['JOINT   ', 'POINT   '])
      ends = 0.0_wp
      do k = 1, 2
         do j = 1, size(joints)
            if (label(d%line(joints(j)), 1) == label(d%line(i), k)) &
               ends(:, k) = [real_field(d, joints(j), 1), real_field(d, joints(j), 2)]
         end do
      end do
      length = norm2(ends(:, 2) - ends(:, 1))
      if (chance(r, 0.7_wp)) call put_real(d, r, i, 1, length*between(r, 0.3_wp, 1.1_wp))
      if (chance(r, 0.7_wp)) call put_real(d, r, i, 2, length*between(r, 0.9_wp, 2.0_wp))
      call add_note(d, 'STROKE OF '//label(d%line(i), 3))
   end subroutine give_stroke

   !> The run ends after so many turns of its drive.
   subroutine count_turns(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i

      i = pick(r, find_cards(d, ['TIME    ']))
      if (i == 0) return
      call set_label(d%line(i), 2, 'TURNS')
      call put_real(d, r, i, 2, between(r, 0.01_wp, 3.0_wp))
      call add_note(d, 'TURNS')
   end subroutine count_turns

   !> Two joints of one link get a length, mostly about that of the drawing.
   subroutine give_length(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      character(80) :: card
      real(wp) :: length
      integer :: i, j

      call pick_joints(d, r, i, j)
      if (i == 0) return
      length = norm2([real_field(d, j, 1) - real_field(d, i, 1), real_field(d, j, 2) - real_field(d, i, 2)])
      if (chance(r, 0.8_wp)) length = near(length, r)
      write (card, '(a, t33, es16.8e3)') 'LENGTH  '//label(d%line(i), 1)//label(d%line(j), 1), abs(length)
      call insert_line(d, size(d%line), card)
      call add_note(d, trim(card))
   end subroutine give_length

   !> A link with two joints gets axes along the bar.
   subroutine give_bar(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer, allocatable :: cards(:)
      integer :: i, j, k

      call pick_joints(d, r, i, j)
      if (i == 0) return
      cards = find_cards(d, ['LINK    '])
      do k = 1, size(cards)
         if (all(label(d%line(cards(k)), 1) /= [label(d%line(i), 2), label(d%line(i), 3)])) cycle
         if (all(label(d%line(cards(k)), 1) /= [label(d%line(j), 2), label(d%line(j), 3)])) cycle
         call set_label(d%line(cards(k)), 2, label(d%line(i), 1))
         call set_label(d%line(cards(k)), 3, label(d%line(j), 1))
         call add_note(d, 'BAR '//d%line(cards(k))(9:32))
      end do
   end subroutine give_bar

   !> Two JOINT cards with a link in common; `i` is 0 if there are none.
   subroutine pick_joints(d, r, i, j)
      type(draft_t), intent(in) :: d
      type(dice_t), intent(inout) :: r
      integer, intent(out) :: i, j
      integer :: k

      do k = 1, 10
         i = pick(r, find_cards(d, ['JOINT   ']))
         j = pick(r, find_cards(d, ['JOINT   ']))
         if (i == 0) return
         if (i == j) cycle
         if (any(label(d%line(i), 2) == [label(d%line(j), 2), label(d%line(j), 3)])) return
         if (any(label(d%line(i), 3) == [label(d%line(j), 2), label(d%line(j), 3)])) return
      end do
      i = 0
   end subroutine pick_joints
end module deck_mutations
