!> What can be said only at the END of a set: what is missing, what nothing uses, and whether
!> every drive exists at every instant.
module deck_checks
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use mechanism, only: mechanism_t, term_t, instant, driven_kinds, drive_relangle, term_power, term_table, &
      request_link, request_point
   use card_sets, only: card_set_t, add_card_error
   use cards, only: card_t, card_fields, card_name, label_a, form_link, form_time, form_at, form_print
   use input_errors, only: error_code_t, input_errors_t, add_field_error, link_missing, time_missing, link_unused, &
      point_unused, power_negative, power_zero, power_large, table_range
   implicit none
   private
   public :: check_missing, check_unused, check_instants

contains

   !> A set without a LINK card or an instant is an error at its END card `closing`, unless a card that could not be
   !> read may have been the missing one.
   subroutine check_missing(set, closing)
      type(card_set_t), intent(inout) :: set
      type(card_t), intent(in) :: closing

      if (.not. set%names_certain) return
      if (set%number_of(form_link) == 0) call add_field_error(set%errors, link_missing, closing, card_fields(card_name))
      if (sum(set%number_of([form_time, form_at])) == 0) &
         call add_field_error(set%errors, time_missing, closing, card_fields(card_name))
   end subroutine check_missing

   !> A link without a pair or a drive is an error, and so is a point without a pair, a drive or a PRINT card. The set
   !> has no other error.
   subroutine check_unused(set)
      type(card_set_t), intent(inout) :: set
      logical :: link(size(set%mechanism%links)), point(size(set%mechanism%points))
      integer :: i

      call find_used(set%mechanism, link, point)
      do i = 1, size(link)
         if (.not. link(i)) call add_card_error(set, link_unused, set%named(request_link)%card(i), label_a)
      end do
      if (set%number_of(form_print) > 0) then
         associate (requests => set%mechanism%requests)
            point(pack(requests%subject, requests%kind == request_point)) = .true.
         end associate
      end if
      do i = 1, size(point)
         if (.not. point(i)) call add_card_error(set, point_unused, set%named(request_point)%card(i), label_a)
      end do
   end subroutine check_unused

   !> The links and points of `m` that a pair or a drive uses.
   pure subroutine find_used(m, link, point)
      type(mechanism_t), intent(in) :: m
      logical, intent(out) :: link(:), point(:)
      integer :: i

      link = .false.
      point = .false.
      point(m%pairs%point_i) = .true.
      point(m%pairs%point_j) = .true.
      do i = 1, size(m%drives)
         associate (drive => m%drives(i))
            if (driven_kinds(drive%kind) == request_point) point(drive%subject) = .true.
            if (driven_kinds(drive%kind) == request_link) link(drive%subject) = .true.
            if (drive%kind == drive_relangle) link(drive%second) = .true.
         end associate
      end do
      link(pack(m%points%link, point)) = .true.
   end subroutine find_used

   !> A term that does not exist, with its first two derivatives, at every instant is an error. The set has no other.
   subroutine check_instants(set)
      type(card_set_t), intent(inout) :: set
      real(wp) :: first, last
      integer :: k

      call find_range(set%mechanism, first, last)
      do k = 1, set%count
         associate (card => set%cards(k), m => set%mechanism)
            if (card%term == 0) cycle
            call check_term(card%card, m%drives(card%drive)%terms(card%term), m, first, last, set%errors)
         end associate
      end do
   end subroutine check_instants

   !> The term of `card`; the instants of `m` lie between `first` and `last`. t**p exists for t < 0 if p is whole, and
   !> with two derivatives at t = 0 if p is 0, 1 or at least 2.
   subroutine check_term(card, term, m, first, last, errors)
      type(card_t), intent(in) :: card
      type(term_t), intent(in) :: term
      type(mechanism_t), intent(in) :: m
      real(wp), intent(in) :: first, last
      type(input_errors_t), intent(inout) :: errors

      select case (term%kind)
      case (term_table)
         ! As doubles: in real128 a double may lie its rounding outside.
         if (real(first, dp) < real(term%knots(1), dp)) call add_instant_error(table_range, first)
         if (real(last, dp) > real(term%knots(size(term%knots)), dp)) call add_instant_error(table_range, last)
      case (term_power)
         associate (p => term%r(2))
            if (first < 0.0_wp .and. abs(p - anint(p)) > 0.0_wp) then
               call add_instant_error(power_negative, first)
            else if (p < 2.0_wp .and. abs(p*(p - 1.0_wp)) > 0.0_wp) then
               if (meets_zero(m)) call add_instant_error(power_zero, 0.0_wp)
            end if
         end associate
         if (is_large(term, first)) call add_instant_error(power_large, first)
         if (is_large(term, last)) call add_instant_error(power_large, last)
      end select

   contains

      !> The error `code` about the instant `t`.
      subroutine add_instant_error(code, t)
         type(error_code_t), intent(in) :: code
         real(wp), intent(in) :: t
         character(24) :: text

         write (text, '(es13.5e3)') t
         call add_field_error(errors, code, card, card_fields(label_a), trim(adjustl(text)))
      end subroutine add_instant_error
   end subroutine check_term

   !> Whether the power, or a derivative of it, comes near the end of the range of reals at `t`.
   pure logical function is_large(term, t)
      type(term_t), intent(in) :: term
      real(wp), intent(in) :: t
      real(wp), parameter :: max_order = 120.0_wp

      is_large = .false.
      if (abs(t) <= 0.0_wp .or. abs(term%r(1)) <= 0.0_wp) return
      associate (p => abs(term%r(2)))
         is_large = log10(abs(term%r(1))) + 2.0_wp*log10(max(p, 1.0_wp)) + (p + 2.0_wp)*abs(log10(abs(t))) > max_order
      end associate
   end function is_large

   !> The first and the last of the instants of `m` in time.
   pure subroutine find_range(m, first, last)
      type(mechanism_t), intent(in) :: m
      real(wp), intent(out) :: first, last

      first = minval(m%at)
      last = maxval(m%at)
      if (m%steps < 1) return
      first = min(first, m%t0, m%t1)
      last = max(last, m%t0, m%t1)
   end subroutine find_range

   !> Whether one of the instants is t = 0. Those of TIME are evenly spaced, so that only those about the one step that
   !> reaches or crosses zero can be.
   pure logical function meets_zero(m)
      type(mechanism_t), intent(in) :: m
      integer :: k, near

      meets_zero = any(.not. abs(m%at) > 0.0_wp)
      if (m%steps < 1 .or. meets_zero) return
      if (min(m%t0, m%t1) > 0.0_wp .or. max(m%t0, m%t1) < 0.0_wp) return
      near = nint(m%steps*(m%t0/(m%t0 - m%t1)))
      do k = max(near - 1, 0), min(near + 1, m%steps)
         if (.not. abs(instant(m, k)) > 0.0_wp) meets_zero = .true.
      end do
   end function meets_zero
end module deck_checks
