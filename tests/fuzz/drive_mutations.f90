!> Tests. Changes of a deck's drives, instants and method that leave it a deck: also drives twice or one too many, which
!> agree or not, and drives that stop at round angles.
module drive_mutations
   use kinds, only: wp
   use plane_vectors, only: pi
   use dice, only: throw, chance, between, magnitude
   use deck_text, only: deck_text_t, name_of, label, set_label, real_field, set_real, set_full, put_real, set_off, &
      near, insert_line, drop_line, line_behind, copy_card, any_card, is_degrees, add_note
   use rise_laws, only: rise_words
   implicit none
   private
   public :: change_drive, add_term, change_time, change_at, change_method, exchange_drive, double_drive, &
      extra_drive, round_drive

contains

   subroutine change_drive(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k

      i = any_card(d, ['DRIVE   ', 'ADD     ', 'RISE    '])
      if (i == 0) return
      k = throw(d%dice, merge(2, 3, label(d%line(i), 1) == 'POWER' .or. label(d%line(i), 1) == 'TABLE'))
      call put_real(d, i, k, near(d, real_field(d, i, k) + merge(between(d%dice, -1.0_wp, 1.0_wp), 0.0_wp, &
         chance(d%dice, 0.3_wp))))
      if (name_of(d%line(i)) == 'DRIVE' .and. label(d%line(i), 1) == 'ANGLE' .and. chance(d%dice, 0.1_wp)) &
         call set_label(d%line(i), 3, 'RPM')
      call add_note(d, 'NUMBER OF '//d%line(i)(1:32))
   end subroutine change_drive

   !> An ADD or RISE card or a table under a drive.
   subroutine add_term(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k, rows
      real(wp) :: unit, t

      i = any_card(d, ['DRIVE   '])
      if (i == 0) return
      unit = merge(10.0_wp, 0.2_wp, is_degrees(d))
      k = line_behind(d, i)
      select case (throw(d%dice, 4))
      case (1)
         call insert_line(d, k, 'ADD     HARMONIC')
         call set_real(d, k, 1, unit*between(d%dice, -1.0_wp, 1.0_wp))
         call set_real(d, k, 2, magnitude(d%dice, 2))
         call set_real(d, k, 3, between(d%dice, -4.0_wp, 4.0_wp))
      case (2)
         call insert_line(d, k, 'ADD     POWER')
         call set_real(d, k, 1, unit*between(d%dice, -1.0_wp, 1.0_wp))
         call set_real(d, k, 2, merge(real(throw(d%dice, 6) - 1, wp), between(d%dice, 2.0_wp, 4.0_wp), &
            chance(d%dice, 0.7_wp)))
      case (3)
         call insert_line(d, k, 'RISE')
         call set_label(d%line(k), 1, trim(rise_words(throw(d%dice, 4))))
         call set_real(d, k, 1, between(d%dice, -2.0_wp, 10.0_wp))
         call set_real(d, k, 2, magnitude(d%dice, 2))
         call set_real(d, k, 3, unit*between(d%dice, -1.0_wp, 1.0_wp))
      case default
         rows = throw(d%dice, 4) + 1
         t = 50.0_wp
         do while (rows > 0)
            call insert_line(d, k, 'ADD     TABLE')
            call set_real(d, k, 1, t)
            call set_real(d, k, 2, unit*between(d%dice, -1.0_wp, 1.0_wp))
            rows = rows - 1
            t = t - between(d%dice, 5.0_wp, 60.0_wp)
            if (rows == 1) t = min(t, -10.0_wp)
         end do
      end select
      call add_note(d, d%line(k)(1:16)//' AFTER '//d%line(i)(1:24))
   end subroutine add_term

   subroutine change_time(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k

      i = any_card(d, ['TIME    '])
      if (i == 0) return
      select case (throw(d%dice, 4))
      case (1)
         call put_real(d, i, 1, between(d%dice, -20.0_wp, 20.0_wp))
      case (2)
         call put_real(d, i, 2, between(d%dice, -20.0_wp, 40.0_wp))
      case (3)
         call put_real(d, i, 2, real_field(d, i, 1) + magnitude(d%dice, 8))
      case default
         k = throw(d%dice, 2)
         call put_real(d, i, k, near(d, real_field(d, i, k)))
      end select
      call add_note(d, 'TIME')
   end subroutine change_time

   !> An AT card more, or the TIME card gone for one.
   subroutine change_at(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, k

      i = any_card(d, ['TIME    '])
      if (i == 0) i = size(d%line)
      call insert_line(d, i, 'AT')
      do k = 1, 3
         if (chance(d%dice, 0.7_wp)) call set_real(d, i, k, between(d%dice, -2.0_wp, 20.0_wp))
      end do
      if (chance(d%dice, 0.3_wp) .and. name_of(d%line(i + 1)) == 'TIME') call drop_line(d, i + 1)
      call add_note(d, 'AT')
   end subroutine change_at

   subroutine change_method(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i

      i = any_card(d, ['METHOD  '])
      if (i == 0) i = size(d%line)
      if (name_of(d%line(i)) /= 'METHOD') call insert_line(d, i, 'METHOD')
      call set_label(d%line(i), 1, trim(merge('MATRIX', 'NEWTON', chance(d%dice, 0.7_wp))))
      if (chance(d%dice, 0.4_wp)) call set_real(d, i, 1, 10.0_wp**between(d%dice, -14.9_wp, -2.1_wp))
      if (chance(d%dice, 0.4_wp)) call set_real(d, i, 2, 10.0_wp**between(d%dice, -10.5_wp, -1.5_wp))
      call add_note(d, d%line(i)(1:16))
   end subroutine change_method

   !> Another quantity is driven, from zero, near where the drive was or anywhere.
   subroutine exchange_drive(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, one, other

      i = any_card(d, ['DRIVE   '])
      if (i == 0) return
      call set_label(d%line(i), 3, '')
      select case (throw(d%dice, 4))
      case (1)
         one = any_card(d, ['LINK    '])
         call set_label(d%line(i), 1, 'ANGLE')
         if (chance(d%dice, 0.6_wp)) call put_real(d, i, 1, real_field(d, one, 3))
      case (2)
         one = any_card(d, ['POINT   '])
         if (one == 0) return
         call set_label(d%line(i), 1, merge('X', 'Y', chance(d%dice, 0.5_wp)))
      case (3)
         one = any_card(d, ['LINK    '])
         other = any_card(d, ['LINK    ', 'GROUND  '])
         call set_label(d%line(i), 1, 'RELANGLE')
         call set_label(d%line(i), 3, label(d%line(other), 1))
         if (chance(d%dice, 0.6_wp)) call put_real(d, i, 1, real_field(d, other, 3) - real_field(d, one, 3))
      case default
         one = any_card(d, ['PRISM   ', 'SLOT    ', 'CYLINDER'])
         if (one == 0) return
         call set_label(d%line(i), 1, 'SLIDE')
      end select
      call set_label(d%line(i), 2, label(d%line(one), merge(3, 1, label(d%line(i), 1) == 'SLIDE')))
      call add_note(d, d%line(i)(1:32))
   end subroutine exchange_drive
   !> A drive once more, in its own words or by the angle to a ground link, sometimes with another number.
   subroutine double_drive(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, at, ground, k
      logical :: by_ground

      i = any_card(d, ['DRIVE   '])
      if (i == 0) return
      call copy_card(d, i, at)
      ground = any_card(d, ['GROUND  '])
      by_ground = chance(d%dice, 0.5_wp)
      if (label(d%line(i), 1) == 'ANGLE' .and. ground > 0 .and. by_ground) then
         call set_label(d%line(at), 1, 'RELANGLE')
         call set_label(d%line(at), 3, label(d%line(at), 2))
         call set_label(d%line(at), 2, label(d%line(ground), 1))
         call set_full(d, at, 1, real_field(d, at, 1) - real_field(d, ground, 3))
      end if
      k = throw(d%dice, 3)
      if (chance(d%dice, 0.4_wp)) call set_off(d, at, k)
      call add_note(d, 'DRIVE '//label(d%line(i), 2)//' TWICE')
   end subroutine double_drive

   !> One drive more, of the link's or pair's angle or slide as it roughly is.
   subroutine extra_drive(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i, one

      i = any_card(d, ['DRIVE   '])
      one = any_card(d, ['LINK    ', 'PRISM   ', 'SLOT    ', 'CYLINDER'])
      if (i == 0 .or. one == 0) return
      if (name_of(d%line(one)) /= 'LINK') then
         call insert_line(d, i, 'DRIVE   SLIDE   '//label(d%line(one), 3))
      else
         call insert_line(d, i, 'DRIVE   ANGLE   '//label(d%line(one), 1))
         call set_full(d, i, 1, real_field(d, one + merge(1, 0, one >= i), 3))
      end if
      call add_note(d, 'ONE DRIVE MORE')
   end subroutine extra_drive

   !> A drive goes from one multiple of 15 degrees to others, or of 0.25 of the length: over dead points and change
   !> points exactly.
   subroutine round_drive(d)
      type(deck_text_t), intent(inout) :: d
      integer :: i
      real(wp) :: unit

      i = any_card(d, ['DRIVE   '])
      if (i == 0) return
      unit = merge(15.0_wp, pi/12.0_wp, is_degrees(d))
      if (any(label(d%line(i), 1) == ['X       ', 'Y       ', 'SLIDE   '])) unit = 0.25_wp
      call set_full(d, i, 1, unit*(throw(d%dice, 25) - 13))
      call set_full(d, i, 2, unit*(throw(d%dice, 25) - 13))
      call set_full(d, i, 3, unit*merge(throw(d%dice, 5) - 3, 0, chance(d%dice, 0.2_wp)))
      i = any_card(d, ['TIME    '])
      if (i == 0) return
      call set_full(d, i, 1, 0.0_wp)
      call set_full(d, i, 2, real(throw(d%dice, 12), wp))
      write (d%line(i)(9:16), '(i0)') throw(d%dice, 12)
      call add_note(d, 'ROUND NUMBERS')
   end subroutine round_drive
end module drive_mutations
