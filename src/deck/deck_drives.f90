!> The DRIVE, ADD and RISE cards of a set. A new kind of term is one case of `build_term` and, if the term does not
!> exist at all instants, one case of `check_terms`.
module deck_drives
   use, intrinsic :: iso_fortran_env, only: dp => real64
   use kinds, only: wp
   use plane_vectors, only: pi
   use mechanism
   use scales, only: is_length
   use card_reader, only: parsed_card_t, refuse_field
   use parameters, only: angle_in_radians, minute_in, turns_a_minute
   use splines, only: new_spline
   use drives, only: drive_motion
   use drawn_values, only: drawn_drive
   use card_sets, only: card_set_t, has_drawing, look_up, match_word, add_card_error, add_card_remark
   use cards
   use input_errors
   implicit none
   private
   public :: build_drives, set_turns, check_terms

contains

   !> Builds the drives of a mechanism from the cards. Links, points and pairs must have been built. Errors are a drive
   !> of a coordinate that cannot be driven, an ADD or RISE card without a drive, and wrong tables and rises.
   subroutine build_drives(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer :: k

      allocate (set%mechanism%drives(set%number_of(form_drive)))
      call number_cards()
      do k = 1, set%count
         if (set%cards(k)%form == form_drive) then
            call build_drive(set, k)
         else if (is_term(set%cards(k))) then
            if (set%cards(k)%subject > 0) then
               call build_term(set, k)
            else if (all(form_above(k) /= [form_add, form_rise, form_unknown])) then
               ! A card with a wrong name may have been a DRIVE card.
               call add_card_error(set, card_alone, k, card_name)
            end if
         end if
      end do

      ! A drive whose value at t = 0 is blank starts from the drawing, but not with a table, whose values are absolute.
      if (set%errors%count > 0 .or. .not. has_drawing(set)) return
      do k = 1, set%count
         if (set%cards(k)%form /= form_drive .or. set%cards(k)%given(1)) cycle
         associate (drive => set%mechanism%drives(set%cards(k)%subject))
            drive%drawn = .true.
            if (allocated(drive%terms)) drive%drawn = .not. any(term_kinds(drive%terms%kind)%has_rows)
            if (drive%drawn) drive%polynomial(1) = drawn_drive(set%mechanism, drive)
         end associate
      end do

   contains

      !> Numbers the drives, the terms of each drive, which follow its card, and the rows of tables, on their cards.
      !> Then makes room for all terms and rows.
      subroutine number_cards()
         integer :: n

         n = 0
         do k = 1, set%count
            associate (card => set%cards(k), above => set%cards(max(1, set%cards(k)%below)))
               if (card%form == form_drive) then
                  n = n + 1
                  card%subject = n
               else if (is_term(card) .and. any(form_above(k) == [form_drive, form_add, form_rise])) then
                  card%subject = above%subject
                  card%row = 1
                  card%term = above%term + 1
                  if (is_row(card) .and. is_row(above)) then
                     card%row = above%row + 1
                     card%term = above%term
                  end if
               end if
            end associate
         end do

         ! The last card of a drive has its last term, the last of a table its last row.
         do k = set%count, 1, -1
            associate (card => set%cards(k))
               if (card%subject == 0 .or. .not. is_term(card)) cycle
               associate (drive => set%mechanism%drives(card%subject))
                  if (.not. allocated(drive%terms)) allocate (drive%terms(card%term))
                  if (.not. is_row(card)) cycle
                  associate (term => drive%terms(card%term))
                     if (.not. allocated(term%table%x)) allocate (term%table%x(card%row), term%table%y(card%row))
                  end associate
               end associate
            end associate
         end do
      end subroutine number_cards

      !> Gives the form of the card above a card, TOLER and VARY left out; form_end if the card is the first of its set.
      pure integer function form_above(k)
         integer, intent(in) :: k            !< number of the card

         form_above = form_end
         if (set%cards(k)%below > 0) form_above = set%cards(set%cards(k)%below)%form
      end function form_above
   end subroutine build_drives

   !> Builds the drive of a DRIVE card: kind, coordinate and polynomial. Errors are an unknown kind or name, a rate in
   !> revolutions per minute in another unit of time, and a coordinate that cannot move.
   subroutine build_drive(set, k)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: k               !< number of the card
      real(wp) :: minute
      integer :: kind, links(3), label, before
      logical :: takes_rpm

      associate (card => set%cards(k), m => set%mechanism, drive => set%mechanism%drives(set%cards(k)%subject))
         call match_word(set, k, drive_words, kind)
         if (kind == 0) return
         drive%kind = kind
         drive%polynomial = card%real*unit_of(m, drive)
         takes_rpm = kind == drive_angle .and. card%label(label_c) == turns_a_minute
         if (takes_rpm) then
            minute = minute_in(m%time_unit)
            drive%turns = minute > 0.0_wp
            if (drive%turns) drive%polynomial(2) = card%real(2)*(2.0_wp*pi/minute)
            if (.not. drive%turns) call add_card_error(set, rpm_unit, k, label_c)
         end if

         before = set%errors%count
         call look_up(set, driven_kinds(kind), k, label_b, drive%subject)
         if (card%label(label_c) /= '' .and. .not. (kind == drive_relangle .or. takes_rpm) .and. card%valid .and. &
            set%errors%count == before) call refuse_field(card, label_c, set%errors)
         if (kind == drive_relangle) then
            call look_up(set, driven_kinds(kind), k, label_c, drive%second)
            if (card%label(label_c) == '' .and. card%valid) call add_card_error(set, field_blank, k, label_c)
         end if

         ! The coordinate must be able to move, as far as its links are known.
         if (drive%subject == 0) return
         label = merge(label_c, label_b, kind == drive_relangle)
         if (kind == drive_slide) then
            if (.not. has_guide(m%pairs(drive%subject)%kind)) call add_card_error(set, drive_revolute, k, label)
         else if (drive%second == drive%subject) then
            call add_card_error(set, drive_one_link, k, label)
         else
            links = drive_links(m, drive)
            if (any(links == 0) .or. (kind == drive_relangle .and. drive%second == 0)) return
            if (all(m%links(links)%ground)) call add_card_error(set, is_ground, k, label)
         end if
      end associate
   end subroutine build_drive

   !> Builds the term of an ADD or RISE card, or one row of its table. An unknown kind, a blank card, a rise without a
   !> duration, a table of one row and rows that are not in order of time are errors.
   subroutine build_term(set, k)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: k               !< number of the card
      integer :: kind

      associate (card => set%cards(k), above => set%cards(set%cards(k)%below), row => set%cards(k)%row, &
         term => set%mechanism%drives(set%cards(k)%subject)%terms(set%cards(k)%term), &
         unit => unit_of(set%mechanism, set%mechanism%drives(set%cards(k)%subject)))
         if (card%form == form_rise) then
            call match_word(set, k, pack(term_kinds%word, term_kinds%is_rise), kind)
            term%kind = term_cycloid + max(kind, 1) - 1
            term%r = card%real*[1.0_wp, 1.0_wp, unit]
            if (card%valid .and. card%real(2) <= 0.0_wp) call add_card_error(set, number_range, k, real_2, 'ABOVE 0.0')
            if (term_kinds(term%kind)%jumps) call add_card_remark(set, remark_jumps, k, label_a)
            return
         end if

         if (card%valid .and. .not. any(card%given)) call add_card_error(set, field_blank, k, real_1)
         if (is_row(card)) then
            term%kind = term_table
            term%table%x(row) = card%real(1)
            term%table%y(row) = card%real(2)*unit
            if (row > 1 .and. card%valid .and. any(card%given) .and. above%valid .and. &
                card%real(1) <= above%real(1)) call add_card_error(set, table_order, k, real_1)
            if (size(term%table%x) == 1) call add_card_error(set, table_short, k, label_a)
         else
            call match_word(set, k, pack(term_kinds%word, .not. term_kinds%is_rise), kind)
            if (kind == term_harmonic) term%r = card%real*[unit, spread(angle_in_radians(set%mechanism), 1, 2)]
            if (kind == term_power) term%r = card%real*[unit, 1.0_wp, 1.0_wp]
            if (kind == term_power) term%kind = term_power
         end if
      end associate
   end subroutine build_term

   !> Gives the deck's unit of the coordinate of a drive in the units of `mechanism_t`: of angles in rad, of lengths 1.
   pure real(wp) function unit_of(m, drive) result(unit)
      type(mechanism_t), intent(in) :: m
      type(drive_t), intent(in) :: drive     !< of `m`, with its kind

      unit = merge(angle_in_radians(m), 1.0_wp, .not. is_length(drive))
   end function unit_of

   !> Computes the last instant of a TIME card that counts turns: the drive with a rate has then made these turns.
   !> Errors are several drives with a rate or none, a drive with a rate that is no angle or has terms or an
   !> acceleration, and turns that do not change the time.
   subroutine set_turns(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer :: k, card

      card = findloc(set%cards(:set%count)%form, form_time, dim=1)
      associate (m => set%mechanism)
         if (.not. m%turns > 0.0_wp .or. set%errors%count > 0) return
         k = findloc(abs(m%drives%polynomial(2)) > 0.0_wp, .true., dim=1)
         if (count(abs(m%drives%polynomial(2)) > 0.0_wp) == 1) then
            associate (drive => m%drives(k))
               if (any(drive%kind == [drive_angle, drive_relangle]) .and. .not. allocated(drive%terms) .and. &
                   .not. abs(drive%polynomial(3)) > 0.0_wp) then
                  m%t1 = m%t0 + 2.0_wp*pi*m%turns/abs(drive%polynomial(2))
                  if (.not. m%t1 > m%t0) &
                     call add_card_error(set, number_range, card, real_1, 'A TIME THAT THE TURNS CHANGE')
                  return
               end if
            end associate
         end if
         call add_card_error(set, turns_drive, card, label_b)
      end associate
   end subroutine set_turns

   !> Tells whether a card is a term of a drive's law: ADD or RISE.
   pure logical function is_term(card)
      type(parsed_card_t), intent(in) :: card   !< of any form

      is_term = any(card%form == [form_add, form_rise])
   end function is_term

   !> Tells whether a card is a row of a table: ADD with the word TABLE.
   pure logical function is_row(card)
      type(parsed_card_t), intent(in) :: card   !< of any form

      is_row = card%form == form_add .and. card%label(label_a) == term_kinds(term_table)%word
   end function is_row

   !> Checks the terms of all drives of a set without errors, and computes the splines of tables. A term that does not
   !> exist at all instants, with its first two derivatives, is an error; a power near the end of the range of reals is
   !> an error, too.
   subroutine check_terms(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      real(wp) :: first, last, times(2)
      !> The largest decimal logarithm of a power and its derivatives: less than half of the range of real64.
      real(wp), parameter :: max_power_logarithm = 120.0_wp
      integer :: k

      call find_instants(set%mechanism, first, last)
      do k = 1, set%count
         if (set%cards(k)%row /= 1) cycle
         associate (term => set%mechanism%drives(set%cards(k)%subject)%terms(set%cards(k)%term))
            if (term_kinds(term%kind)%has_rows) then
               term%table = new_spline(term%table%x, term%table%y)
               ! Compared as doubles: in real128 a time that is a double may lie outside by its rounding.
               if (real(first, dp) < real(term%table%x(1), dp)) call add_instant_error(table_range, first)
               if (real(last, dp) > real(maxval(term%table%x), dp)) call add_instant_error(table_range, last)
            else if (term%kind == term_power) then
               ! t**p exists for t < 0 if p is a whole number, and with two derivatives at t = 0 if p is 0, 1 or at
               ! least 2. The motion passes t = 0 between instants as well.
               associate (p => term%r(2))
                  if (first < 0.0_wp .and. abs(p - anint(p)) > 0.0_wp) then
                     call add_instant_error(power_negative, first)
                  else if (p < 2.0_wp .and. abs(p*(p - 1.0_wp)) > 0.0_wp) then
                     if (first <= 0.0_wp .and. last >= 0.0_wp) call add_instant_error(power_zero, 0.0_wp)
                  end if
               end associate

               ! R1 t**R2 and its derivatives stay far from the ends of the range of reals.
               times = abs([first, last])
               where (times <= 0.0_wp) times = 1.0_wp
               associate (r => max(abs(term%r), [tiny(1.0_wp), 1.0_wp, 1.0_wp]))
                  times = log10(r(1)) + 2.0_wp*log10(r(2)) + (abs(term%r(2)) + 2.0_wp)*abs(log10(times))
               end associate
               if (any(times > max_power_logarithm)) &
                  call add_instant_error(power_large, merge(first, last, times(1) > max_power_logarithm))
            end if
         end associate
      end do
      if (set%errors%count > 0) return
      do k = 1, set%count
         if (set%cards(k)%form == form_drive) call check_cylinder(set, k)
      end do

   contains

      !> Adds an error of card `k` that ends with the time of an instant.
      subroutine add_instant_error(code, t)
         type(error_code_t), intent(in) :: code   !< number and sentence of the error
         real(wp), intent(in) :: t           !< time
         character(24) :: text

         write (text, '(es13.5e3)') t
         call add_card_error(set, code, k, label_a, trim(adjustl(text)))
      end subroutine add_instant_error
   end subroutine check_terms

   !> Checks the cylinder of a drive, if the drive moves one: a length of 0 or less at the first instant is an error.
   subroutine check_cylinder(set, k)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer, intent(in) :: k               !< number of the DRIVE card
      real(wp) :: f(3)

      associate (m => set%mechanism, drive => set%mechanism%drives(set%cards(k)%subject))
         if (drive%kind /= drive_slide) return
         if (.not. m%pairs(drive%subject)%is_cylinder) return
         f = drive_motion(drive, instant(m, 0))
         if (.not. f(1) > 0.0_wp) call add_card_error(set, cylinder_begins, k, label_b)
      end associate
   end subroutine check_cylinder
end module deck_drives
