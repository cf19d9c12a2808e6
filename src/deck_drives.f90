!> Level 8. The DRIVE and ADD cards of a set.
module deck_drives
   use kinds, only: wp
   use mechanism, only: mechanism_t, drive_t, term_t, drive_angle, drive_x, drive_y, drive_relangle, &
                        drive_slide, term_harmonic, term_power, term_table, pair_revolute
   use card_forms, only: form_drive, form_add, form_end
   use complaints, only: complaints_t
   use deck_bodies, only: find_label
   use deck_codes, only: link_unknown, point_unknown, pair_unknown, drive_kind, drive_ground, &
                         drive_ground_point, drive_grounds, drive_one_link, drive_revolute, field_blank, &
                         field_unused, add_alone, add_kind, add_blank, table_short, table_order
   use drafts, only: draft_t, cards_of, next_reading, complain_name, complain_label, complain_choice, complain_real
   implicit none
   private
   public :: build_drives

   !> The form of a card whose name is wrong: it may have been a DRIVE.
   integer, parameter :: unknown_form = 0

contains

   !> Makes `set`%drives of the cards; links, points and pairs are there. `angle_unit`: the deck's unit of
   !> angles in radians.
   subroutine build_drives(draft, angle_unit, set, list)
      type(draft_t), intent(in) :: draft
      real(wp), intent(in) :: angle_unit
      type(mechanism_t), intent(inout) :: set
      type(complaints_t), intent(inout) :: list
      integer :: k, n, above
      real(wp) :: unit

      allocate (set%drives(cards_of(draft, form_drive)))
      n = 0
      above = form_end
      k = next_reading(draft, 0)
      do while (k <= draft%count)
         if (draft%cards(k)%form == form_drive) then
            n = n + 1
            call build_drive(draft, k, set, set%drives(n), list)
            unit = merge(angle_unit, 1.0_wp, any(set%drives(n)%kind == [drive_angle, drive_relangle]))
            set%drives(n)%polynomial = draft%cards(k)%real*unit
            call build_terms(draft, k, unit, angle_unit, set%drives(n), list)
         else if (draft%cards(k)%form == form_add) then
            if (all(above /= [form_drive, form_add, unknown_form])) &
               call complain_name(list, add_alone, draft, k, '')
         end if
         above = draft%cards(k)%form
         k = next_reading(draft, k)
      end do
   end subroutine build_drives

   subroutine build_drive(draft, k, set, drive, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(in) :: set
      type(drive_t), intent(inout) :: drive
      type(complaints_t), intent(inout) :: list

      if (draft%cards(k)%label(3) /= '' .and. draft%cards(k)%label(1) /= 'RELANGLE' .and. &
          draft%cards(k)%sound) call complain_label(list, field_unused, draft, k, 3, '')
      select case (draft%cards(k)%label(1))
      case ('ANGLE')
         drive%kind = drive_angle
         call find_label(draft, draft%links, k, 2, link_unknown, drive%subject, list)
         if (drive%subject == 0) return
         if (set%links(drive%subject)%ground) call complain_label(list, drive_ground, draft, k, 2, '')
      case ('X', 'Y')
         drive%kind = merge(drive_x, drive_y, draft%cards(k)%label(1) == 'X')
         call find_label(draft, draft%points, k, 2, point_unknown, drive%subject, list)
         if (drive%subject == 0) return
         if (set%points(drive%subject)%link == 0) return
         if (set%links(set%points(drive%subject)%link)%ground) &
            call complain_label(list, drive_ground_point, draft, k, 2, '')
      case ('RELANGLE')
         drive%kind = drive_relangle
         call build_relangle(draft, k, set, drive, list)
      case ('SLIDE')
         drive%kind = drive_slide
         call find_label(draft, draft%pairs, k, 2, pair_unknown, drive%subject, list)
         if (drive%subject == 0) return
         if (set%pairs(drive%subject)%kind == pair_revolute) &
            call complain_label(list, drive_revolute, draft, k, 2, '')
      case default
         if (draft%cards(k)%sound) call complain_choice(list, drive_kind, draft, k, 1)
      end select
   end subroutine build_drive

   subroutine build_relangle(draft, k, set, drive, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(in) :: set
      type(drive_t), intent(inout) :: drive
      type(complaints_t), intent(inout) :: list

      call find_label(draft, draft%links, k, 2, link_unknown, drive%subject, list)
      call find_label(draft, draft%links, k, 3, link_unknown, drive%second, list)
      if (draft%cards(k)%label(3) == '' .and. draft%cards(k)%sound) &
         call complain_label(list, field_blank, draft, k, 3, '')
      if (drive%subject == 0 .or. drive%second == 0) return
      if (drive%subject == drive%second) then
         call complain_label(list, drive_one_link, draft, k, 3, '')
      else if (set%links(drive%subject)%ground .and. set%links(drive%second)%ground) then
         call complain_label(list, drive_grounds, draft, k, 3, '')
      end if
   end subroutine build_relangle

   !> The ADD cards that follow the DRIVE card `k`. `unit`: of the driven coordinate.
   subroutine build_terms(draft, k, unit, angle_unit, drive, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      real(wp), intent(in) :: unit, angle_unit
      type(drive_t), intent(inout) :: drive
      type(complaints_t), intent(inout) :: list
      integer :: first, n, pass, rows

      ! The first pass counts the terms, the second one fills them.
      do pass = 1, 2
         n = 0
         first = next_reading(draft, k)
         do while (is_add(draft, first))
            n = n + 1
            rows = 1
            if (draft%cards(first)%label(1) == 'TABLE') rows = table_rows(draft, first)
            if (pass == 2) call build_term(draft, first, rows, unit, angle_unit, drive%terms(n), list)
            do rows = rows, 1, -1
               first = next_reading(draft, first)
            end do
         end do
         if (pass == 1) allocate (drive%terms(n))
      end do
   end subroutine build_terms

   pure logical function is_add(draft, k)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k

      is_add = .false.
      if (k <= draft%count) is_add = draft%cards(k)%form == form_add
   end function is_add

   !> Number of ADD TABLE cards that follow each other from card `first` on.
   pure integer function table_rows(draft, first) result(rows)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: first
      integer :: k

      rows = 0
      k = first
      do while (is_add(draft, k))
         if (draft%cards(k)%label(1) /= 'TABLE') exit
         rows = rows + 1
         k = next_reading(draft, k)
      end do
   end function table_rows

   subroutine build_term(draft, k, rows, unit, angle_unit, term, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k, rows
      real(wp), intent(in) :: unit, angle_unit
      type(term_t), intent(inout) :: term
      type(complaints_t), intent(inout) :: list

      associate (card => draft%cards(k))
         select case (card%label(1))
         case ('HARMONIC')
            term%kind = term_harmonic
            term%r = card%real*[unit, angle_unit, angle_unit]
         case ('POWER')
            term%kind = term_power
            term%r = card%real*[unit, 1.0_wp, 1.0_wp]
         case ('TABLE')
            term%kind = term_table
            call build_table(draft, k, rows, unit, term, list)
            return
         case default
            if (card%sound) call complain_choice(list, add_kind, draft, k, 1)
         end select
         if (card%sound .and. .not. any(card%given)) call complain_name(list, add_blank, draft, k, '')
      end associate
   end subroutine build_term

   subroutine build_table(draft, first, rows, unit, term, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: first, rows
      real(wp), intent(in) :: unit
      type(term_t), intent(inout) :: term
      type(complaints_t), intent(inout) :: list
      integer :: i, k
      logical :: sound

      allocate (term%knots(rows), term%values(rows))
      k = first
      sound = .true.
      do i = 1, rows
         term%knots(i) = draft%cards(k)%real(1)
         term%values(i) = draft%cards(k)%real(2)*unit
         if (draft%cards(k)%sound .and. .not. any(draft%cards(k)%given)) then
            call complain_name(list, add_blank, draft, k, '')
         else if (i > 1 .and. sound .and. draft%cards(k)%sound) then
            if (term%knots(i) <= term%knots(i - 1)) call complain_real(list, table_order, draft, k, 1, '')
         end if
         sound = draft%cards(k)%sound
         k = next_reading(draft, k)
      end do
      if (rows < 2) call complain_label(list, table_short, draft, first, 1, '')
   end subroutine build_table
end module deck_drives
