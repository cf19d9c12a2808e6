!> Tests. Changes of a deck that give it more equations than unknowns, consistent or not: pairs and drives twice (those
!> of `random_schemes` are guides side by side, whose motion is known); and rough positions from far, drives that stop at
!> round angles.
module deck_surplus
   use kinds, only: wp
   use dice, only: dice_t, throw, chance, between
   use deck_draft, only: draft_t, line_length, name_of, label, set_label, real_field, set_full, insert_line, &
      find_cards, add_note
   use deck_changes, only: pick, is_degrees
   implicit none
   private
   public :: double_pair, double_drive, extra_drive, far_rough, round_drive

   real(wp), parameter :: pi = 3.141592653589793_wp

contains

   !> A name that no card has: lines are only added.
   function new_name(d) result(name)
      type(draft_t), intent(in) :: d
      character(8) :: name

      write (name, '(a,i0)') 'ZZ', size(d%line)
   end function new_name

   !> The line after card `i` and what belongs to it: its `*` card and, for a drive, its terms.
   integer function line_after(d, i)
      type(draft_t), intent(in) :: d
      integer, intent(in) :: i

      do line_after = i + 1, size(d%line)
         if (d%line(line_after)(1:1) /= '*' .and. all(name_of(d%line(line_after)) /= ['ADD ', 'RISE'])) return
      end do
   end function line_after

   !> A second card like card `i`, of the pair `name`, before line `at`.
   subroutine copy_card(d, i, at)
      type(draft_t), intent(inout) :: d
      integer, intent(in) :: i, at
      character(line_length) :: lines(at - i)
      integer :: k

      lines = d%line(i:at - 1)
      do k = size(lines), 1, -1
         call insert_line(d, at, lines(k))
      end do
   end subroutine copy_card

   !> A pair once more between the same points, or a prismatic one with another number.
   subroutine double_pair(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      character(8) :: name
      integer :: i, at, k
      logical :: other

      i = 0
      if (chance(r, 0.5_wp)) i = pick(r, find_cards(d, ['PRISM   ']))
      if (i == 0) i = pick(r, find_cards(d, ['REVOLUTE', 'PRISM   ', 'SLOT    ', 'CYLINDER']))
      if (i == 0) return
      at = line_after(d, i)
      name = new_name(d)
      call copy_card(d, i, at)
      call set_label(d%line(at), 3, name)
      other = chance(r, 0.3_wp)
      if (name_of(d%line(at)) == 'PRISM' .and. other) then
         k = throw(r, 3)
         call set_full(d, at, k, real_field(d, at, k) + between(r, -1.0_wp, 1.0_wp)*10.0_wp**(-between(r, 0.0_wp, &
            15.0_wp)))
      end if
      call add_note(d, 'PAIR '//label(d%line(i), 3)//' TWICE')
   end subroutine double_pair

   !> A drive once more, in its own words or by the angle to a ground link, sometimes with another number.
   subroutine double_drive(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, at, ground, k
      logical :: by_ground

      i = pick(r, find_cards(d, ['DRIVE   ']))
      if (i == 0) return
      at = line_after(d, i)
      call copy_card(d, i, at)
      ground = pick(r, find_cards(d, ['GROUND  ']))
      by_ground = chance(r, 0.5_wp)
      if (label(d%line(i), 1) == 'ANGLE' .and. ground > 0 .and. by_ground) then
         call set_label(d%line(at), 1, 'RELANGLE')
         call set_label(d%line(at), 3, label(d%line(at), 2))
         call set_label(d%line(at), 2, label(d%line(ground), 1))
         call set_full(d, at, 1, real_field(d, at, 1) - real_field(d, ground, 3))
      end if
      k = throw(r, 3)
      if (chance(r, 0.4_wp)) call set_full(d, at, k, real_field(d, at, k) &
         + between(r, -1.0_wp, 1.0_wp)*10.0_wp**(-between(r, 0.0_wp, 15.0_wp)))
      call add_note(d, 'DRIVE '//label(d%line(i), 2)//' TWICE')
   end subroutine double_drive

   !> One drive more, of the link's or pair's angle or slide as it roughly is.
   subroutine extra_drive(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, one

      i = pick(r, find_cards(d, ['DRIVE   ']))
      one = pick(r, find_cards(d, ['LINK    ', 'PRISM   ', 'SLOT    ', 'CYLINDER']))
      if (i == 0 .or. one == 0) return
      if (name_of(d%line(one)) /= 'LINK') then
         call insert_line(d, i, 'DRIVE   SLIDE   '//label(d%line(one), 3))
      else
         call insert_line(d, i, 'DRIVE   ANGLE   '//label(d%line(one), 1))
         call set_full(d, i, 1, real_field(d, one + merge(1, 0, one >= i), 3))
      end if
      call add_note(d, 'ONE DRIVE MORE')
   end subroutine extra_drive

   !> The rough positions of all links from far.
   subroutine far_rough(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer, allocatable :: cards(:)
      integer :: i, k, manner
      real(wp) :: quarter

      quarter = merge(90.0_wp, 0.5_wp*pi, is_degrees(d))
      cards = find_cards(d, ['LINK    '])
      manner = throw(r, 5)
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
               if (k == 3) call set_full(d, cards(i), k, real_field(d, cards(i), k) + between(r, -4.0_wp, &
                  4.0_wp)*quarter)
            case default
               if (k == 3) call set_full(d, cards(i), k, quarter*(throw(r, 8) - 4))
            end select
         end do
      end do
      call add_note(d, 'ROUGH POSITIONS OF ALL LINKS')
   end subroutine far_rough

   !> A drive goes from one multiple of 15 degrees to others, or of 0.25 of the length: over dead points and change
   !> points exactly.
   subroutine round_drive(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i
      real(wp) :: unit

      i = pick(r, find_cards(d, ['DRIVE   ']))
      if (i == 0) return
      unit = merge(15.0_wp, pi/12.0_wp, is_degrees(d))
      if (any(label(d%line(i), 1) == ['X       ', 'Y       ', 'SLIDE   '])) unit = 0.25_wp
      call set_full(d, i, 1, unit*(throw(r, 25) - 13))
      call set_full(d, i, 2, unit*(throw(r, 25) - 13))
      call set_full(d, i, 3, unit*merge(throw(r, 5) - 3, 0, chance(r, 0.2_wp)))
      i = pick(r, find_cards(d, ['TIME    ']))
      if (i == 0) return
      call set_full(d, i, 1, 0.0_wp)
      call set_full(d, i, 2, real(throw(r, 12), wp))
      write (d%line(i)(9:16), '(i0)') throw(r, 12)
      call add_note(d, 'ROUND NUMBERS')
   end subroutine round_drive
end module deck_surplus
