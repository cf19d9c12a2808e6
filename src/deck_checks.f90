!> Level 7. What can be said only at the END of a set: what is missing, what nothing uses, and whether
!> every drive exists at every instant.
module deck_checks
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use mechanism, only: mechanism_t, term_t, instant, drive_angle, drive_x, drive_y, drive_relangle, &
                        term_power, term_table, request_point
   use card_forms, only: form_link, form_drive, form_add, form_time, form_at, form_print
   use cards, only: card_t, name_field
   use complaints, only: complaints_t, complain_field
   use deck_codes, only: code_t, link_missing, time_missing, link_unused, point_unused, power_negative, &
                         power_zero, power_large, table_range
   use drafts, only: draft_t, cards_of, next_reading, complain_label
   implicit none
   private
   public :: check_missing, check_unused, check_instants

contains

   !> A set needs a link that moves and an instant. `closing` is its END card. A card that could not be
   !> read may have been the missing one.
   subroutine check_missing(draft, closing, list)
      type(draft_t), intent(in) :: draft
      type(card_t), intent(in) :: closing
      type(complaints_t), intent(inout) :: list

      if (.not. draft%names_sure) return
      if (cards_of(draft, form_link) == 0) call complain_field(list, link_missing, closing, name_field, '')
      if (cards_of(draft, form_time) + cards_of(draft, form_at) == 0) &
         call complain_field(list, time_missing, closing, name_field, '')
   end subroutine check_missing

   !> Every link belongs to a pair or a drive, every point to a pair, a drive or a PRINT card. The set has no
   !> other error.
   subroutine check_unused(draft, set, list)
      type(draft_t), intent(in) :: draft
      type(mechanism_t), intent(in) :: set
      type(complaints_t), intent(inout) :: list
      logical :: link(size(set%links)), point(size(set%points))
      integer :: i

      call mark_used(set, link, point)
      do i = 1, size(set%links)
         if (.not. link(i)) call complain_label(list, link_unused, draft, draft%link_card(i), 1, '')
      end do
      if (cards_of(draft, form_print) > 0) then
         do i = 1, size(set%requests)
            if (set%requests(i)%kind == request_point) point(set%requests(i)%subject) = .true.
         end do
      end if
      do i = 1, size(set%points)
         if (.not. point(i)) call complain_label(list, point_unused, draft, draft%point_card(i), 1, '')
      end do
   end subroutine check_unused

   pure subroutine mark_used(set, link, point)
      type(mechanism_t), intent(in) :: set
      logical, intent(out) :: link(:), point(:)
      integer :: i

      link = .false.
      point = .false.
      do i = 1, size(set%pairs)
         point(set%pairs(i)%point_i) = .true.
         point(set%pairs(i)%point_j) = .true.
      end do
      do i = 1, size(set%drives)
         associate (drive => set%drives(i))
            if (any(drive%kind == [drive_x, drive_y])) point(drive%subject) = .true.
            if (any(drive%kind == [drive_angle, drive_relangle])) link(drive%subject) = .true.
            if (drive%kind == drive_relangle) link(drive%second) = .true.
         end associate
      end do
      do i = 1, size(set%points)
         if (point(i)) link(set%points(i)%link) = .true.
      end do
   end subroutine mark_used

   !> Every term exists, with its first two derivatives, at every instant. The set has no other error.
   subroutine check_instants(draft, set, list)
      type(draft_t), intent(in) :: draft
      type(mechanism_t), intent(in) :: set
      type(complaints_t), intent(inout) :: list
      integer :: k, i, j, rows

      i = 0
      j = 0
      k = next_reading(draft, 0)
      do while (k <= draft%count)
         if (draft%cards(k)%form == form_drive) then
            i = i + 1
            j = 0
         else if (draft%cards(k)%form == form_add) then
            j = j + 1
            call check_term(draft, k, set, set%drives(i)%terms(j), list)
            if (set%drives(i)%terms(j)%kind == term_table) then
               do rows = 2, size(set%drives(i)%terms(j)%knots)
                  k = next_reading(draft, k)
               end do
            end if
         end if
         k = next_reading(draft, k)
      end do
   end subroutine check_instants

   !> The term of card `k`. t**p exists for t < 0 if p is whole, and at t = 0 with two derivatives if p is
   !> 0, 1 or at least 2.
   subroutine check_term(draft, k, set, term, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(mechanism_t), intent(in) :: set
      type(term_t), intent(in) :: term
      type(complaints_t), intent(inout) :: list
      real(wp) :: first, last

      call range_of_instants(set, first, last)
      if (term%kind == term_table) then
         ! As doubles: in real128 a double may lie its rounding outside.
         if (real(first, dp) < real(term%knots(1), dp)) call complain_instant(draft, k, table_range, first, list)
         if (real(last, dp) > real(term%knots(size(term%knots)), dp)) &
            call complain_instant(draft, k, table_range, last, list)
      else if (term%kind == term_power) then
         associate (p => term%r(2))
            if (first < 0.0_wp .and. abs(p - anint(p)) > 0.0_wp) then
               call complain_instant(draft, k, power_negative, first, list)
            else if (p < 2.0_wp .and. abs(p*(p - 1.0_wp)) > 0.0_wp) then
               if (meets_zero(set)) call complain_instant(draft, k, power_zero, 0.0_wp, list)
            end if
         end associate
         if (is_large(term, first)) call complain_instant(draft, k, power_large, first, list)
         if (is_large(term, last)) call complain_instant(draft, k, power_large, last, list)
      end if
   end subroutine check_term

   !> The power or a derivative of it comes near the end of the range of reals at `t`.
   pure logical function is_large(term, t)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: t
      real(wp), parameter :: largest_order = 120.0_wp

      is_large = .false.
      if (abs(t) <= 0.0_wp .or. abs(term%r(1)) <= 0.0_wp) return
      associate (p => abs(term%r(2)))
         is_large = log10(abs(term%r(1))) + 2.0_wp*log10(max(p, 1.0_wp)) &
            + (p + 2.0_wp)*abs(log10(abs(t))) > largest_order
      end associate
   end function is_large

   pure subroutine range_of_instants(set, first, last)
      type(mechanism_t), intent(in) :: set
      real(wp), intent(out) :: first, last

      first = huge(first)
      last = -huge(last)
      if (size(set%at) > 0) then
         first = minval(set%at)
         last = maxval(set%at)
      end if
      if (set%steps < 1) return
      first = min(first, set%t0, set%t1)
      last = max(last, set%t0, set%t1)
   end subroutine range_of_instants

   !> Whether one of the instants is t = 0. Those of TIME are evenly spaced, so only the neighbours of one
   !> step can be.
   pure logical function meets_zero(set)
      type(mechanism_t), intent(in) :: set
      integer :: k, near

      meets_zero = any(.not. abs(set%at) > 0.0_wp)
      if (set%steps < 1 .or. meets_zero) return
      if (sign(1.0_wp, set%t0)*sign(1.0_wp, set%t1) > 0.0_wp .and. abs(set%t0) > 0.0_wp .and. &
          abs(set%t1) > 0.0_wp) return
      near = nint(set%steps*(set%t0/(set%t0 - set%t1)))
      do k = max(near - 1, 0), min(near + 1, set%steps)
         if (.not. abs(instant(set, k)) > 0.0_wp) meets_zero = .true.
      end do
   end function meets_zero

   subroutine complain_instant(draft, k, code, t, list)
      type(draft_t), intent(in) :: draft
      integer, intent(in) :: k
      type(code_t), intent(in) :: code
      real(wp), intent(in) :: t
      type(complaints_t), intent(inout) :: list
      character(24) :: text

      write (text, '(es13.5e3)') t
      call complain_label(list, code, draft, k, 1, trim(adjustl(text)))
   end subroutine complain_instant
end module deck_checks
