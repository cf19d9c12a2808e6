!> Tests. Changes of a deck that leave it a deck: lengths, angles, order, scale, pairs twice (those of `random_schemes`
!> are guides side by side, whose motion is known), and those of `drive_mutations`. What comes of it may have no
!> solution, but it goes through the solver.
module deck_mutations
   use kinds, only: wp
   use plane_vectors, only: pi
   use dice, only: throw, chance, between, magnitude
   use deck_text, only: deck_text_t, name_of, label, set_label, real_field, set_real, set_full, put_real, set_off, &
      near, insert_line, drop_line, copy_card, find_cards, any_card, is_degrees, add_note
   use drive_mutations, only: change_drive, add_term, change_time, change_at, change_method, exchange_drive, &
      double_drive, extra_drive, round_drive
   implicit none
   private
   public :: prepare, change_gently, max_steps

   !> So many steps of a TIME card at most: runs are to be short.
   integer, parameter :: max_steps = 40

contains

   !> Few instants, over the whole of the motion or with the steps as they were; mostly all rows in the tables.
   subroutine prepare(d)
      type(deck_text_t), intent(inout) :: d
      integer, allocatable :: cards(:)
      integer :: i, n, before

      cards = find_cards(d, ['TIME    '])
      do i = 1, size(cards)
         read (d%line(cards(i))(9:16), *) before
         n = throw(d%dice, merge(4, 10, chance(d%dice, 0.7_wp)))
         if (chance(d%dice, 0.5_wp) .and. label(d%line(cards(i)), 2) == '') call set_real(d, cards(i), 2, &
            real_field(d, cards(i), 1) + (real_field(d, cards(i), 2) - real_field(d, cards(i), 1))*n/before)
         write (d%line(cards(i))(9:16), '(i0)') n
      end do
      if (chance(d%dice, 0.1_wp)) return
      cards = find_cards(d, ['PRINT   '])
      do i = size(cards), 1, -1
         call drop_line(d, cards(i))
      end do
      i = size(d%line)
      if (chance(d%dice, 0.9_wp)) then
         call insert_line(d, i, 'PRINT   ALL')
      else
         call insert_line(d, i, 'PRINT   LINKS           3')
      end if
   end subroutine prepare

   !> One change of one of the kinds below.
   subroutine change_gently(d)
      type(deck_text_t), intent(inout) :: d

      select case (throw(d%dice, 41))
      case (1:5); call change_length(d)
      case (6:7); call change_rough(d)
      case (8); call change_real(d, ['GROUND  ', 'PRISM   ', 'SLOT    ', 'CYLINDER'])
      case (9:11); call change_drive(d)
      case (12:13); call add_term(d)
      case (14:15); call change_time(d)
      case (16); call change_method(d)
      case (17:18); call exchange_drive(d)
      case (19); call scale_lengths(d)
      case (20); call copy_length(d)
      case (21); call swap_alike(d)
      case (22); call swap_ends(d)
      case (23); call make_prism(d)
      case (24:27); call double_pair(d)
      case (28:29); call double_drive(d)
      case (30); call extra_drive(d)
      case (31:32); call far_rough(d)
      case (33); call round_drive(d)
      case (34); call make_slot(d)
      case (35:36); call give_length(d)
      case (37); call give_bar(d)
      case (38:39); call give_stroke(d)
      case (40); call count_turns(d)
      case default; call change_at(d)
      end select
   end subroutine change_gently

   subroutine change_real(d, names)
      type(deck_text_t), intent(inout) :: d
      character(8), intent(in) :: names(:)
      integer :: i, k

      i = any_card(d, names)
      if (i == 0) return
      k = throw(d%dice, 3)
      call put_real(d, i, k, near(d, real_field(d, i, k)))
      call add_note(d, 'REAL OF '//d%line(i)(1:16))
   end subroutine change_real

   subroutine change_length(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k

      i = any_card(d, ['POINT   ', 'JOINT   '])
      if (i == 0) return
      k = merge(1, 2, chance(d%dice, 0.7_wp))
      call put_real(d, i, k, near(d, real_field(d, i, k)))
      call add_note(d, 'LENGTH '//d%line(i)(9:16))
   end subroutine change_length

   subroutine change_rough(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k

      i = any_card(d, ['LINK    '])
      if (i == 0) return
      k = throw(d%dice, 4)
      if (k == 4) then
         call put_real(d, i, 3, between(d%dice, -360.0_wp, 360.0_wp)*merge(1.0_wp, pi/180.0_wp, is_degrees(d)))
      else
         call put_real(d, i, k, near(d, real_field(d, i, k)))
      end if
      call add_note(d, 'ROUGH POSITION '//d%line(i)(9:16))
   end subroutine change_rough

   !> All lengths times one factor.
   subroutine scale_lengths(d)
      type(deck_text_t), intent(inout) :: d
      real(wp) :: factor
      integer :: i, k

      factor = magnitude(d%dice, merge(3, merge(12, 150, chance(d%dice, 0.7_wp)), chance(d%dice, 0.5_wp)))
      do i = size(d%line), 1, -1
         select case (name_of(d%line(i)))
         case ('POINT', 'GROUND', 'LINK', 'JOINT')
            call scale([1, 2])
         case ('LENGTH')
            call scale([1])
         case ('SLOT', 'PRISM')
            call scale([2])
         case ('CYLINDER')
            ! A stroke without an end has none afterwards.
            call scale(pack([1, 2], [(abs(real_field(d, i, k)) > 0.0_wp, k=1, 2)]))
         case ('DRIVE')
            if (drives_length(d, i)) call scale([1, 2, 3])
         case ('ADD')
            if (drives_length(d, i)) call scale([merge(2, 1, label(d%line(i), 1) == 'TABLE')])
         case ('RISE')
            if (drives_length(d, i)) call scale([3])
         end select
      end do
      call add_note(d, 'ALL LENGTHS SCALED')

   contains

      subroutine scale(fields)
         integer, intent(in) :: fields(:)
         integer :: n

         do n = 1, size(fields)
            call set_full(d, i, fields(n), factor*real_field(d, i, fields(n)))
         end do
      end subroutine scale
   end subroutine scale_lengths

   !> The drive on line `i`, or the one whose ADD or RISE card is there, moves a length.
   logical function drives_length(d, i)
      type(deck_text_t), intent(in) :: d
      integer, intent(in) :: i
      integer :: k

      do k = i, 1, -1
         if (name_of(d%line(k)) == 'DRIVE') exit
      end do
      drives_length = .false.
      if (k > 0) drives_length = all(label(d%line(k), 1) /= ['ANGLE   ', 'RELANGLE'])
   end function drives_length

   !> Equal lengths: change points, parallelograms, links folded upon each other.
   subroutine copy_length(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, j

      i = any_card(d, ['POINT   '])
      j = any_card(d, ['POINT   '])
      if (i == 0) return
      call set_full(d, i, 1, real_field(d, j, 1))
      call add_note(d, 'LENGTH '//d%line(i)(9:16)//' AS '//d%line(min(j, size(d%line)))(9:16))
   end subroutine copy_length

   !> Two cards of one kind change places.
   subroutine swap_alike(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, j

      i = any_card(d, ['LINK    ', 'POINT   ', 'REVOLUTE', 'PRISM   ', 'JOINT   ', 'LENGTH  ', 'SLOT    ', 'CYLINDER'])
      if (i == 0) return
      j = any_card(d, [name_of(d%line(i))])
      if (any(d%line(min([i, j] + 1, size(d%line)))(1:1) == '*')) return
      d%line([i, j]) = d%line([j, i])
      call add_note(d, 'ORDER OF '//d%line(i)(1:16)//' '//d%line(j)(1:16))
   end subroutine swap_alike

   !> The two points of a pair change places.
   subroutine swap_ends(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i
      character(8) :: first

      i = any_card(d, ['REVOLUTE', 'PRISM   ', 'SLOT    ', 'CYLINDER', 'LENGTH  '])
      if (i == 0) return
      first = label(d%line(i), 1)
      call set_label(d%line(i), 1, label(d%line(i), 2))
      call set_label(d%line(i), 2, first)
      call add_note(d, 'ENDS OF '//d%line(i)(1:32))
   end subroutine swap_ends

   !> A pair once more between the same points, or a prismatic one with another number.
   subroutine double_pair(d)
      type(deck_text_t), intent(inout) :: d
      character(8) :: name
      integer :: i, at
      logical :: other

      i = 0
      if (chance(d%dice, 0.5_wp)) i = any_card(d, ['PRISM   '])
      if (i == 0) i = any_card(d, ['REVOLUTE', 'PRISM   ', 'SLOT    ', 'CYLINDER'])
      if (i == 0) return
      ! No card has this name: lines are only added.
      write (name, '(a, i0)') 'ZZ', size(d%line)
      call copy_card(d, i, at)
      call set_label(d%line(at), 3, name)
      other = chance(d%dice, 0.3_wp)
      if (name_of(d%line(at)) == 'PRISM' .and. other) call set_off(d, at, throw(d%dice, 3))
      call add_note(d, 'PAIR '//label(d%line(i), 3)//' TWICE')
   end subroutine double_pair

   !> The rough positions of all links from far.
   subroutine far_rough(d)
      type(deck_text_t), intent(inout) :: d
      integer, allocatable :: cards(:)
      integer :: i, k, manner
      real(wp) :: quarter

      quarter = merge(90.0_wp, 0.5_wp*pi, is_degrees(d))
      cards = find_cards(d, ['LINK    '])
      manner = throw(d%dice, 5)
      do i = size(cards), 1, -1
         do k = 1, 3
            select case (manner)
            case (1)
               call set_full(d, cards(i), k, 1000.0_wp*real_field(d, cards(i), k))
            case (2)
               call set_full(d, cards(i), k, 0.0_wp)
            case (3)
               if (k == 3) call set_full(d, cards(i), k, real_field(d, cards(i), k) + quarter)
            case (4)
               if (k == 3) call set_full(d, cards(i), k, real_field(d, cards(i), k) + between(d%dice, -4.0_wp, &
                  4.0_wp)*quarter)
            case default
               if (k == 3) call set_full(d, cards(i), k, quarter*(throw(d%dice, 8) - 4))
            end select
         end do
      end do
      call add_note(d, 'ROUGH POSITIONS OF ALL LINKS')
   end subroutine far_rough

   !> A revolute pair becomes a prismatic one, with any numbers.
   subroutine make_prism(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k

      i = any_card(d, ['REVOLUTE'])
      if (i == 0) return
      d%line(i)(1:8) = 'PRISM'
      do k = 1, 3
         if (chance(d%dice, 0.5_wp)) call set_real(d, i, k, between(d%dice, -2.0_wp, 2.0_wp))
      end do
      call add_note(d, d%line(i)(1:32))
   end subroutine make_prism

   !> A revolute pair becomes a slot, whose slide is driven.
   subroutine make_slot(d)
      type(deck_text_t), intent(inout) :: d
      character(80) :: card
      integer :: i

      i = any_card(d, ['REVOLUTE'])
      if (i == 0) return
      d%line(i)(1:8) = 'SLOT'
      if (chance(d%dice, 0.7_wp)) call set_real(d, i, 1, between(d%dice, -2.0_wp, 2.0_wp))
      if (chance(d%dice, 0.3_wp)) call set_real(d, i, 2, between(d%dice, -0.2_wp, 0.2_wp))
      write (card, '(a, t33, 2es16.8e3)') 'DRIVE   SLIDE   '//label(d%line(i), 3), between(d%dice, -0.3_wp, 0.3_wp), &
         between(d%dice, -0.1_wp, 0.1_wp)
      call insert_line(d, size(d%line), card)
      call add_note(d, 'SLOT '//d%line(i)(9:32))
   end subroutine make_slot

   !> A cylinder gets a stroke, in which its drawing mostly is.
   subroutine give_stroke(d)
      type(deck_text_t), intent(inout) :: d
      real(wp) :: ends(2, 2), length
      integer, allocatable :: joints(:)
      integer :: i, k, j

      i = any_card(d, ['CYLINDER'])
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
      if (chance(d%dice, 0.7_wp)) call put_real(d, i, 1, length*between(d%dice, 0.3_wp, 1.1_wp))
      if (chance(d%dice, 0.7_wp)) call put_real(d, i, 2, length*between(d%dice, 0.9_wp, 2.0_wp))
      call add_note(d, 'STROKE OF '//label(d%line(i), 3))
   end subroutine give_stroke

   !> The run ends after so many turns of its drive.
   subroutine count_turns(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i

      i = any_card(d, ['TIME    '])
      if (i == 0) return
      call set_label(d%line(i), 2, 'TURNS')
      call put_real(d, i, 2, between(d%dice, 0.01_wp, 3.0_wp))
      call add_note(d, 'TURNS')
   end subroutine count_turns

   !> Two joints of one link get a length, mostly about that of the drawing.
   subroutine give_length(d)
      type(deck_text_t), intent(inout) :: d
      character(80) :: card
      real(wp) :: length
      integer :: i, j

      call pick_joints(d, i, j)
      if (i == 0) return
      length = norm2([real_field(d, j, 1) - real_field(d, i, 1), real_field(d, j, 2) - real_field(d, i, 2)])
      if (chance(d%dice, 0.8_wp)) length = near(d, length)
      write (card, '(a, t33, es16.8e3)') 'LENGTH  '//label(d%line(i), 1)//label(d%line(j), 1), abs(length)
      call insert_line(d, size(d%line), card)
      call add_note(d, trim(card))
   end subroutine give_length

   !> A link with two joints gets axes along the bar.
   subroutine give_bar(d)
      type(deck_text_t), intent(inout) :: d
      integer, allocatable :: cards(:)
      integer :: i, j, k

      call pick_joints(d, i, j)
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
   subroutine pick_joints(d, i, j)
      type(deck_text_t), intent(inout) :: d
      integer, intent(out) :: i, j
      integer :: k

      do k = 1, 10
         i = any_card(d, ['JOINT   '])
         j = any_card(d, ['JOINT   '])
         if (i == 0) return
         if (i == j) cycle
         if (any(label(d%line(i), 2) == [label(d%line(j), 2), label(d%line(j), 3)])) return
         if (any(label(d%line(i), 3) == [label(d%line(j), 2), label(d%line(j), 3)])) return
      end do
      i = 0
   end subroutine pick_joints
end module deck_mutations
