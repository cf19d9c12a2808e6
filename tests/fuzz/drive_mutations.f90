!> Tests. Changes of a deck's drives, instants and method that leave it a deck.
module drive_mutations
   use kinds, only: wp
   use dice, only: dice_t, throw, chance, between, magnitude
   use deck_draft, only: draft_t, name_of, label, set_label, real_field, set_real, insert_line, drop_line, find_cards, &
      add_note
   use rise_laws, only: rise_words
   use deck_changes, only: pick, near, put_real, is_degrees
   implicit none
   private
   public :: change_drive, add_term, change_time, change_at, change_method, exchange_drive

contains

   subroutine change_drive(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, k

      i = pick(r, find_cards(d, ['DRIVE   ', 'ADD     ', 'RISE    ']))
      if (i == 0) return
      k = throw(r, merge(2, 3, label(d%line(i), 1) == 'POWER' .or. label(d%line(i), 1) == 'TABLE'))
      call put_real(d, r, i, k, near(real_field(d, i, k) + merge(between(r, -1.0_wp, 1.0_wp), 0.0_wp, chance(r, &
         0.3_wp)), r))
      if (name_of(d%line(i)) == 'DRIVE' .and. label(d%line(i), 1) == 'ANGLE' .and. chance(r, 0.1_wp)) &
         call set_label(d%line(i), 3, 'RPM')
      call add_note(d, 'NUMBER OF '//d%line(i)(1:32))
   end subroutine change_drive

   !> An ADD or RISE card or a table under a drive.
   subroutine add_term(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, k, rows
      real(wp) :: unit, t

      i = pick(r, find_cards(d, ['DRIVE   ']))
      if (i == 0) return
      unit = merge(10.0_wp, 0.2_wp, is_degrees(d))
      k = i + merge(2, 1, d%line(i + 1)(1:1) == '*')
      select case (throw(r, 4))
      case (1)
         call insert_line(d, k, 'ADD     HARMONIC')
         call set_real(d, k, 1, unit*between(r, -1.0_wp, 1.0_wp))
         call set_real(d, k, 2, magnitude(r, 2))
         call set_real(d, k, 3, between(r, -4.0_wp, 4.0_wp))
      case (2)
         call insert_line(d, k, 'ADD     POWER')
         call set_real(d, k, 1, unit*between(r, -1.0_wp, 1.0_wp))
         call set_real(d, k, 2, merge(real(throw(r, 6) - 1, wp), between(r, 2.0_wp, 4.0_wp), chance(r, 0.7_wp)))
      case (3)
         call insert_line(d, k, 'RISE')
         call set_label(d%line(k), 1, trim(rise_words(throw(r, 4))))
         call set_real(d, k, 1, between(r, -2.0_wp, 10.0_wp))
         call set_real(d, k, 2, magnitude(r, 2))
         call set_real(d, k, 3, unit*between(r, -1.0_wp, 1.0_wp))
      case default
         rows = throw(r, 4) + 1
         t = 50.0_wp
         do while (rows > 0)
            call insert_line(d, k, 'ADD     TABLE')
            call set_real(d, k, 1, t)
            call set_real(d, k, 2, unit*between(r, -1.0_wp, 1.0_wp))
            rows = rows - 1
            t = t - between(r, 5.0_wp, 60.0_wp)
            if (rows == 1) t = min(t, -10.0_wp)
         end do
      end select
      call add_note(d, d%line(k)(1:16)//' AFTER '//d%line(i)(1:24))
   end subroutine add_term

   subroutine change_time(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, k

      i = pick(r, find_cards(d, ['TIME    ']))
      if (i == 0) return
      select case (throw(r, 4))
      case (1)
         call put_real(d, r, i, 1, between(r, -20.0_wp, 20.0_wp))
      case (2)
         call put_real(d, r, i, 2, between(r, -20.0_wp, 40.0_wp))
      case (3)
         call put_real(d, r, i, 2, real_field(d, i, 1) + magnitude(r, 8))
      case default
         k = throw(r, 2)
         call put_real(d, r, i, k, near(real_field(d, i, k), r))
      end select
      call add_note(d, 'TIME')
   end subroutine change_time

   !> An AT card more, or the TIME card gone for one.
   subroutine change_at(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, k

      i = pick(r, find_cards(d, ['TIME    ']))
      if (i == 0) i = size(d%line)
      call insert_line(d, i, 'AT')
      do k = 1, 3
         if (chance(r, 0.7_wp)) call set_real(d, i, k, between(r, -2.0_wp, 20.0_wp))
      end do
      if (chance(r, 0.3_wp) .and. name_of(d%line(i + 1)) == 'TIME') call drop_line(d, i + 1)
      call add_note(d, 'AT')
   end subroutine change_at

   subroutine change_method(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i

      i = pick(r, find_cards(d, ['METHOD  ']))
      if (i == 0) i = size(d%line)
      if (name_of(d%line(i)) /= 'METHOD') call insert_line(d, i, 'METHOD')
      call set_label(d%line(i), 1, trim(merge('MATRIX', 'NEWTON', chance(r, 0.7_wp))))
      if (chance(r, 0.4_wp)) call set_real(d, i, 1, 10.0_wp**between(r, -14.9_wp, -2.1_wp))
      if (chance(r, 0.4_wp)) call set_real(d, i, 2, 10.0_wp**between(r, -10.5_wp, -1.5_wp))
      call add_note(d, d%line(i)(1:16))
   end subroutine change_method

   !> Another quantity is driven, from zero, near where the drive was or anywhere.
   subroutine exchange_drive(d, r)
      type(draft_t), intent(inout) :: d
      type(dice_t), intent(inout) :: r
      integer :: i, one, other

      i = pick(r, find_cards(d, ['DRIVE   ']))
      if (i == 0) return
      call set_label(d%line(i), 3, '')
      select case (throw(r, 4))
      case (1)
         one = pick(r, find_cards(d, ['LINK    ']))
         call set_label(d%line(i), 1, 'ANGLE')
         if (chance(r, 0.6_wp)) call put_real(d, r, i, 1, real_field(d, one, 3))
      case (2)
         one = pick(r, find_cards(d, ['POINT   ']))
         if (one == 0) return
         call set_label(d%line(i), 1, merge('X', 'Y', chance(r, 0.5_wp)))
      case (3)
         one = pick(r, find_cards(d, ['LINK    ']))
         other = pick(r, find_cards(d, ['LINK    ', 'GROUND  ']))
         call set_label(d%line(i), 1, 'RELANGLE')
         call set_label(d%line(i), 3, label(d%line(other), 1))
         if (chance(r, 0.6_wp)) call put_real(d, r, i, 1, real_field(d, other, 3) - real_field(d, one, 3))
      case default
         one = pick(r, find_cards(d, ['PRISM   ', 'SLOT    ', 'CYLINDER']))
         if (one == 0) return
         call set_label(d%line(i), 1, 'SLIDE')
      end select
      call set_label(d%line(i), 2, label(d%line(one), merge(3, 1, label(d%line(i), 1) == 'SLIDE')))
      call add_note(d, d%line(i)(1:32))
   end subroutine exchange_drive
end module drive_mutations
