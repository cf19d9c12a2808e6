!> The DRIVE and ADD cards of a set.
module deck_drives
   use kinds, only: wp
   use mechanism, only: drive_t, term_t, drive_angle, drive_relangle, drive_slide, drive_words, driven_kinds, &
      term_harmonic, term_power, term_table, term_words, pair_revolute, request_link
   use card_sets, only: card_set_t, look_up, match_word, add_card_error
   use cards, only: card_name, label_a, label_b, label_c, real_1, form_unknown, form_drive, form_add, form_end
   use input_errors, only: drive_kind, drive_ground, drive_ground_point, drive_grounds, drive_one_link, &
      drive_revolute, field_blank, field_unused, add_alone, add_kind, add_blank, table_short, table_order
   implicit none
   private
   public :: build_drives

contains

   !> Makes the drives of `set`%mechanism from the cards; its links, points and pairs are there. Drives of what cannot
   !> be driven, ADD cards without a drive and wrong tables are errors.
   subroutine build_drives(set)
      type(card_set_t), intent(inout) :: set
      type(drive_t) :: drive
      integer :: k, n, above

      allocate (set%mechanism%drives(set%number_of(form_drive)))
      n = 0
      above = form_end
      do k = 1, set%count
         if (set%cards(k)%form == form_drive) then
            n = n + 1
            call build_drive(set, k, drive)
            call build_terms(set, k, n, drive)
            set%mechanism%drives(n) = drive
         else if (set%cards(k)%form == form_add) then
            ! A card whose name is wrong may have been a DRIVE.
            if (all(above /= [form_drive, form_add, form_unknown])) call add_card_error(set, add_alone, k, card_name)
         end if
         above = set%cards(k)%form
      end do
   end subroutine build_drives

   !> The kind of the DRIVE card `k`, what it drives, and its polynomial.
   subroutine build_drive(set, k, drive)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k
      type(drive_t), intent(out) :: drive
      integer :: kind

      associate (card => set%cards(k))
         if (card%label(label_c) /= '' .and. card%label(label_a) /= drive_words(drive_relangle) .and. card%valid) &
            call add_card_error(set, field_unused, k, label_c)
         call match_word(set, k, drive_words, drive_kind, kind)
         if (kind == 0) return
         drive%kind = kind
         drive%polynomial = card%real*unit_of(set, drive)
         call look_up(set, driven_kinds(kind), k, label_b, drive%subject)
         if (kind == drive_relangle) then
            call look_up(set, request_link, k, label_c, drive%second)
            if (card%label(label_c) == '' .and. card%valid) call add_card_error(set, field_blank, k, label_c)
         end if
      end associate
      call check_subject(set, k, drive)
   end subroutine build_drive

   !> What the DRIVE card `k` drives can be driven, as far as it is known.
   subroutine check_subject(set, k, drive)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k
      type(drive_t), intent(in) :: drive
      integer :: link

      if (drive%subject == 0) return
      if (drive%kind == drive_relangle) then
         if (drive%second == drive%subject) then
            call add_card_error(set, drive_one_link, k, label_c)
         else if (drive%second > 0) then
            if (all(set%mechanism%links([drive%subject, drive%second])%ground)) &
               call add_card_error(set, drive_grounds, k, label_c)
         end if
      else if (drive%kind == drive_angle) then
         if (set%mechanism%links(drive%subject)%ground) call add_card_error(set, drive_ground, k, label_b)
      else if (drive%kind == drive_slide) then
         if (set%mechanism%pairs(drive%subject)%kind == pair_revolute) &
            call add_card_error(set, drive_revolute, k, label_b)
      else
         link = set%mechanism%points(drive%subject)%link
         if (link == 0) return
         if (set%mechanism%links(link)%ground) call add_card_error(set, drive_ground_point, k, label_b)
      end if
   end subroutine check_subject

   !> The unit of what `drive` drives: of angles in radians, or 1.
   pure real(wp) function unit_of(set, drive) result(unit)
      type(card_set_t), intent(in) :: set
      type(drive_t), intent(in) :: drive

      unit = merge(set%angle_unit, 1.0_wp, driven_kinds(drive%kind) == request_link)
   end function unit_of

   !> The terms of drive number `d`, of the ADD cards that follow its card `k`.
   subroutine build_terms(set, k, d, drive)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k, d
      type(drive_t), intent(inout) :: drive
      integer :: i, n, last

      n = 0
      do last = k + 1, set%count
         if (set%cards(last)%form /= form_add) exit
         if (.not. continues_table(set, last)) n = n + 1
      end do
      allocate (drive%terms(n))
      n = 0
      do i = k + 1, last - 1
         if (continues_table(set, i)) cycle
         n = n + 1
         set%cards(i)%drive = d
         set%cards(i)%term = n
         call build_term(set, i, unit_of(set, drive), drive%terms(n))
      end do
   end subroutine build_terms

   !> Whether the ADD card `k` is another row of the table to which the card above it belongs.
   pure logical function continues_table(set, k)
      type(card_set_t), intent(in) :: set
      integer, intent(in) :: k

      continues_table = set%cards(k - 1)%form == form_add
      if (continues_table) continues_table = all(set%cards(k - 1:k)%label(label_a) == term_words(term_table))
   end function continues_table

   !> The term that begins with the ADD card `k`. `unit`: of the driven coordinate.
   subroutine build_term(set, k, unit, term)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: k
      real(wp), intent(in) :: unit
      type(term_t), intent(inout) :: term
      integer :: kind

      call match_word(set, k, term_words, add_kind, kind)
      associate (card => set%cards(k))
         select case (kind)
         case (term_table)
            call build_table(set, k, unit, term)
            return
         case (term_harmonic)
            term%r = card%real*[unit, set%angle_unit, set%angle_unit]
         case (term_power)
            term%kind = term_power
            term%r = card%real*[unit, 1.0_wp, 1.0_wp]
         end select
         if (card%valid .and. .not. any(card%given)) call add_card_error(set, add_blank, k, card_name)
      end associate
   end subroutine build_term

   !> The table whose first row is the ADD card `first`. `unit`: of its values.
   subroutine build_table(set, first, unit, term)
      type(card_set_t), intent(inout) :: set
      integer, intent(in) :: first
      real(wp), intent(in) :: unit
      type(term_t), intent(inout) :: term
      integer :: k, last

      do last = first, set%count - 1
         if (set%cards(last + 1)%form /= form_add) exit
         if (.not. continues_table(set, last + 1)) exit
      end do
      term%kind = term_table
      term%knots = set%cards(first:last)%real(1)
      term%values = set%cards(first:last)%real(2)*unit
      do k = first, last
         if (.not. set%cards(k)%valid) cycle
         if (.not. any(set%cards(k)%given)) then
            call add_card_error(set, add_blank, k, card_name)
         else if (k > first) then
            if (set%cards(k - 1)%valid .and. set%cards(k)%real(1) <= set%cards(k - 1)%real(1)) &
               call add_card_error(set, table_order, k, real_1)
         end if
      end do
      if (last == first) call add_card_error(set, table_short, first, label_a)
   end subroutine build_table
end module deck_drives
