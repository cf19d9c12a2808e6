!> The echo of a set without errors in the listing, and remarks about its cards. The echo has the cards as they were
!> understood, with the values in use. Remarks are about harmless faults and about numbers that are probably not meant:
!> names that nothing uses, degrees for radians, and in a deck with JOINT cards numbers that contradict the drawing.
module deck_remarks
   use kinds, only: wp, label_length
   use plane_vectors, only: full_turn, in_degrees, wrap_angle
   use mechanism
   use columns, only: kinds_of_rows
   use parameters, only: unit_t, parameter_unit, parameter_value, is_as_drawn
   use drawn_values, only: drawn_way, drawn_closure_error, drawn_place
   use drives, only: drive_motion, bounds_t, bounds_of, is_at_rest, middle_of
   use names, only: drive_name, listed
   use scales, only: solver_length
   use number_format, only: rounded
   use deck_variants, only: parameter_on_card
   use card_sets, only: card_set_t, has_drawing, add_card_error, add_card_remark, real_text
   use cards
   use input_errors, only: link_unused, add_remark
   use cylinders, only: is_out_of_stroke
   implicit none
   private
   public :: check_unused, check_angles, check_drives, check_drawing, build_echo, drawn_text

   !> Characters of a line of the echo: a line of the listing has 120, with the blank before the text.
   integer, parameter :: echo_length = 119
   !> Characters of a real in the echo: a field of a `*` card and a blank.
   integer, parameter :: real_width = 25
   !> Column of the first real in the echo: after the name, three labels and four blanks.
   integer, parameter :: real_column = 37
   !> The end of the line of a default.
   character(*), parameter :: default_mark = '(DEFAULT)'
   !> The words after a number that is as drawn, in English and in Polish ("according to the drawing").
   character(*), parameter :: drawn_marks(2) = ['(AS DRAWN)', '(WG RYS.) ']
   !> The words after a number that axes along a bar give, in English and in Polish.
   character(*), parameter :: bar_marks(2) = ['(FROM TO)', '(OD DO)  ']
   !> The words before the coordinates to which a length has moved a point.
   character(*), parameter :: axis_words(2) = ['X = ', 'Y = ']
   !> The numbers that the listing has of links whose axes are the axes of the drawing.
   character(*), parameter :: angles = 'PHI, VPHI, APHI'
   !> The words after these numbers if only some links have such axes.
   character(*), parameter :: of_some = ' OF THOSE WITHOUT NUMBERS'

   !> Larger angles are not degrees that someone has read from a drawing: two turns.
   real(wp), parameter :: max_degrees = 720.0_wp
   !> Digits of a number as drawn: more than a drawing has, at most as many as the reals have.
   integer, parameter :: drawn_text_digits = min(9, precision(1.0_wp))

   !> TIME is halved at most so often to find the greatest rate of a law: then a part is 1/65536 of TIME.
   integer, parameter :: rate_halvings = 16

   !> A closure error below this (rad, or parts of the characteristic length) does not contradict a drawing: coordinates
   !> measured in a drawing have some four digits.
   real(wp), parameter :: drawn_digits = 1.0e-4_wp
   !> Axes that are turned by less (rad) have the direction of the drawing: the remark would show equal angles.
   real(wp), parameter :: same_direction = 1.0e-9_wp

contains

   !> Adds a remark on each link without a pair or a drive, which becomes ground, and on each point without a pair,
   !> drive, measure, length or request. If no moving link is left, this is an error.
   subroutine check_unused(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      logical :: link(size(set%mechanism%links)), point(size(set%mechanism%points))
      integer :: i

      point = used_points(set%mechanism)
      link = .false.
      link(pack(set%mechanism%points%link, point)) = .true.
      do i = 1, size(set%mechanism%drives)
         link(drive_links(set%mechanism, set%mechanism%drives(i))) = .true.
      end do

      associate (m => set%mechanism, card_of_link => set%named(request_link)%card)
         if (.not. any(link .and. .not. m%links%ground)) &
            call add_card_error(set, link_unused, card_of_link(findloc(m%links%ground, .false., dim=1)), label_a)
         do i = 1, size(link)
            if (.not. link(i)) call add_card_remark(set, remark_link_unused, card_of_link(i), label_a)
         end do
         where (.not. link) m%links%ground = .true.
         point(pack(m%requests%subject, kinds_of_rows(m%requests%kind)%subject == request_point)) = .true.
         if (allocated(m%lengths)) point([m%lengths%point(1), m%lengths%point(2)]) = .true.
         do i = 1, measure_count(m)
            associate (subjects => m%measures(i)%subjects)
               point(pack(subjects%number, subjects%kind == request_point)) = .true.
            end associate
         end do
      end associate
      do i = 1, size(set%named(request_point)%card)
         if (.not. point(i)) call add_card_remark(set, remark_point_unused, set%named(request_point)%card(i), label_a)
      end do
   end subroutine check_unused

   !> Adds a remark on the first angle in radians that looks like degrees: above a turn, at most `max_degrees`, and a
   !> whole number or half of one. Numbers of ADD cards are not read from drawings, and do not count. If the set is in
   !> degrees, there is no remark.
   subroutine check_angles(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(parameter_t) :: number
      type(unit_t) :: unit
      integer :: k, i

      if (set%mechanism%degrees) return
      do k = 1, set%count
         do i = 1, 3
            associate (x => set%cards(k)%real(i))
               if (abs(x) <= full_turn .or. abs(x) > max_degrees .or. abs(2.0_wp*x - anint(2.0_wp*x)) > 0.0_wp) cycle
            end associate
            number = parameter_on_card(set, k, i)
            if (number%kind == 0 .or. set%cards(k)%form == form_add) cycle
            unit = parameter_unit(set%mechanism, number)
            if (unit%name /= 'RAD') cycle
            call add_card_remark(set, remark_radians, k, label_c + i)
            return
         end do
      end do
   end subroutine check_angles

   !> Adds a remark on all drives if none moves within TIME, and a remark on the first drive that makes a turn or more
   !> in one step of TIME. If VARY cards change a drive or TIME, all drives may rest. A set without TIME has no remarks.
   subroutine check_drives(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      !> A part of one turn that counts as one turn: one turn but for roundings.
      real(wp), parameter :: about_one = 1.0_wp - 1.0e3_wp*epsilon(1.0_wp)
      real(wp) :: step, rate
      logical :: varies
      integer :: k

      if (set%mechanism%steps < 0 .or. size(set%mechanism%drives) == 0) return
      varies = .false.
      do k = 1, set%count
         if (set%cards(k)%form == form_vary) varies = varies .or. &
            any(set%cards(set%cards(k)%below)%form == [form_drive, form_add, form_rise, form_time])
      end do

      associate (m => set%mechanism, drives => set%mechanism%drives)
         if (all([(rests(drives(k)), k=1, size(drives))]) .and. .not. varies) &
            call add_drive_remark(remark_rest, [(drive_name(m, drives(k)), k=1, size(drives))], '')
         step = abs(m%t1 - m%t0)/m%steps
         do k = 1, size(drives)
            if (driven_kinds(drives(k)%kind) /= request_link) cycle
            rate = 0.0_wp
            call find_fastest(drives(k), min(m%t0, m%t1), max(m%t0, m%t1), rate_halvings, about_one*full_turn/step, &
               rate)
            if (rate*step < about_one*full_turn) cycle
            call add_drive_remark(remark_turns, [drive_name(m, drives(k))], &
               rounded(rate*step/full_turn, 3, 1.0_wp, 1.0e8_wp))
            return
         end do
      end associate

   contains

      !> Tells whether a drive does not move within TIME. A table of equal values counts as zero: bounds of its rate
      !> would include roundings of the values.
      pure logical function rests(drive)
         type(drive_t), intent(in) :: drive  !< of the set
         type(drive_t) :: law
         integer :: i

         law = drive
         if (allocated(law%terms)) then
            do i = 1, size(law%terms)
               if (.not. term_kinds(law%terms(i)%kind)%has_rows) cycle
               associate (y => law%terms(i)%table%y)
                  if (.not. maxval(y) > minval(y)) y = 0.0_wp
               end associate
            end do
         end if
         rests = is_at_rest(law, set%mechanism%t0, set%mechanism%t1)
      end function rests

      !> Adds a remark about drives, on the card of the first of these drives.
      subroutine add_drive_remark(kind, names, value)
         integer, intent(in) :: kind         !< remark_rest or remark_turns
         character(*), intent(in) :: names(:)   !< (1 or more) the names of the drives
         character(*), intent(in) :: value   !< the end of the sentence
         integer :: card

         do card = 1, set%count
            if (set%cards(card)%form /= form_drive) cycle
            if (drive_name(set%mechanism, set%mechanism%drives(set%cards(card)%subject)) == names(1)) exit
         end do
         call add_remark(set%errors, kind, set%cards(card)%card, 1, listed(names, set%mechanism%polish), value)
      end subroutine add_drive_remark
   end subroutine check_drives

   !> Finds the greatest |rate| of a law between two times, within a thousandth or the limit of `depth`, if it is above
   !> a bound. The interval is halved again and again, and true bounds exclude parts of the interval.
   pure recursive subroutine find_fastest(law, from, to, depth, least, rate)
      type(drive_t), intent(in) :: law       !< the drive that has the law
      real(wp), intent(in) :: from, to       !< times, in their order
      real(wp), intent(in) :: least          !< smaller rates do not count; length or rad per unit of time
      integer, intent(in) :: depth           !< the interval is halved at most so often
      real(wp), intent(inout) :: rate        !< the greatest |rate| so far, in the unit of `least`
      type(bounds_t) :: b
      real(wp) :: f(3), most

      b = bounds_of(law, from, to, .false.)
      most = max(-b%low(1), b%high(1))
      if (most < least .or. (rate >= least .and. most < 1.001_wp*rate)) return
      f = drive_motion(law, middle_of(from, to))
      rate = max(rate, abs(f(2)))
      if (depth == 0) return
      call find_fastest(law, from, middle_of(from, to), depth - 1, least, rate)
      call find_fastest(law, middle_of(from, to), to, depth - 1, least, rate)
   end subroutine find_fastest

   !> Builds the echo of a set without errors: a line for each card except TITLE, as it was understood, with the values
   !> in use, and a line for each default that no card replaces.
   subroutine build_echo(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      integer :: k, n

      allocate (set%mechanism%echo(set%count + 5))
      n = 0
      do k = 1, set%count
         if (set%cards(k)%form /= form_title) call add_card(k)
      end do
      associate (m => set%mechanism)
         call add_default(form_units, [m%length_unit, 'RAD     ', m%time_unit])
         call add_default(form_method, [character(label_length) :: method_words(method_newton), '', ''])
         if (m%variants == 0 .and. .not. allocated(m%columns)) &
            call add_default(form_print, [character(label_length) :: 'LINKS', '', '1'])
         ! Of links printed by default only the angle may be printed: of all links or of some.
         if (any(m%requests%angle_alone)) m%echo(n)(real_column:real_column + len(angles//of_some) - 1) = &
            merge(angles//repeat(' ', len(of_some)), angles//of_some, &
            all(m%requests%angle_alone .or. m%requests%kind /= request_link))
         if (any(m%requests%listed)) call add_default(form_print, [character(label_length) :: 'POINTS', '', '1'])
         if (allocated(m%measures) .and. m%variants == 0 .and. .not. allocated(m%columns)) &
            call add_default(form_print, [character(label_length) :: 'MEASURES', '', '1'])
         m%echo = m%echo(1:n)
      end associate

   contains

      !> Adds the line of a card to the echo. A blank real shows the value as drawn, or 0.0, or the factor 1.0 of SUM.
      !> Blank reals of AT, VARY and CYLINDER, and the blank closing tolerance of METHOD, stay blank.
      subroutine add_card(k)
         integer, intent(in) :: k            !< number of the card
         type(parameter_t) :: number
         type(unit_t) :: unit
         character(label_length) :: labels(3)
         character(real_width) :: text
         real(wp) :: x, position(2)
         integer :: i

         associate (card => set%cards(k), m => set%mechanism)
            labels = card%label
            if (any(card%form == [form_print, form_pole, form_curve]) .and. labels(3) == '') labels(3) = '1'
            if (card%form == form_units) then
               if (labels(2) == '') labels(2) = 'RAD'
               labels = [m%length_unit, labels(2), m%time_unit]
            end if
            call add_head(card%form, labels)

            do i = 1, reals_of(card%form, card%label(label_a))
               number = parameter_on_card(set, k, i)
               if (is_as_drawn(m, number)) then
                  x = parameter_value(m, number)
                  unit = parameter_unit(m, number)
                  if (unit%name == 'DEG') x = in_degrees(x)
                  text = drawn_text(x)//' '//drawn_marks(merge(2, 1, m%polish))
               else if (card%given(i)) then
                  text = real_text(card, i)
               else
                  text = merge('0.0', '   ', all(card%form /= [form_at, form_vary]) .and. &
                     card%form /= form_cylinder .and. (card%form /= form_method .or. i == 1))
                  if (card%form == form_sum .and. i < 3) text = merge('1.0', '   ', card%label(label_a + i - 1) /= '')
               end if

               if (card%form == form_link) then
                  if (m%links(card%subject)%along(i)) then
                     x = m%links(card%subject)%position(i)
                     if (i == 3 .and. m%degrees) x = in_degrees(x)
                     text = drawn_text(x)//' '//bar_marks(merge(2, 1, m%polish))
                  end if
               end if
               call append_real(i, text)
            end do

            if (card%form == form_length) then
               position = drawn_place(m, m%lengths(card%subject)%point(2))
               do i = 1, 2
                  call append_real(i + 1, axis_words(i)//drawn_text(position(i)))
               end do
            end if
         end associate
      end subroutine add_card

      !> Puts a text into the field of a real in the last line of the echo.
      subroutine append_real(i, text)
         integer, intent(in) :: i            !< number of the real, 1 to 3
         character(*), intent(in) :: text    !< at most `real_width` characters
         integer :: column

         column = real_column + (i - 1)*real_width
         set%mechanism%echo(n)(column:column + real_width - 1) = text
      end subroutine append_real

      !> Adds a line with the defaults of a form to the echo, if no card of the set has this form.
      subroutine add_default(form, labels)
         integer, intent(in) :: form         !< form_units, ...
         character(label_length), intent(in) :: labels(3)   !< the values in use

         if (set%number_of(form) > 0) return
         call add_head(form, labels)
         set%mechanism%echo(n)(echo_length - len(default_mark) + 1:) = default_mark
      end subroutine add_default

      !> Adds a line with the name and the labels of a card to the echo.
      subroutine add_head(form, labels)
         integer, intent(in) :: form         !< of the card
         character(label_length), intent(in) :: labels(3)   !< of the card

         n = n + 1
         set%mechanism%echo(n) = form_name(form)//' '//labels(1)//' '//labels(2)//' '//labels(3)
      end subroutine add_head
   end subroutine build_echo

   !> Adds remarks on the pairs of a drawing, in a set without errors: on each pair whose numbers or points contradict
   !> the drawing, on each guide whose alpha counts from turned axes, unless these are along a bar, and on each cylinder
   !> that is drawn outside its stroke. The drawing before lengths is compared. Without JOINT cards there is no remark.
   subroutine check_drawing(set)
      type(card_set_t), intent(inout) :: set !< the cards, and the mechanism made of them
      type(mechanism_t) :: m                        ! as it is drawn
      real(wp) :: length, closure_error, turn
      character(:), allocatable :: text
      integer :: i, k

      if (.not. has_drawing(set)) return
      m = set%mechanism
      if (allocated(set%drawing)) m = set%drawing
      length = solver_length(m)
      do i = 1, size(set%named(request_pair)%card)
         k = set%named(request_pair)%card(i)
         text = ''
         associate (pair => m%pairs(i), link => m%links(m%points(m%pairs(i)%point_i)%link))
            if (.not. has_guide(pair%kind)) then
               closure_error = norm2(drawn_way(m, pair))
            else
               closure_error = drawn_closure_error(m, pair)
               associate (phi => m%links(pair_links(m, pair))%position(3))
                  turn = wrap_angle(phi(2) - phi(1) - pair%beta)
               end associate
               if (abs(turn) > drawn_digits .and. .not. pair%drawn(3)) text = angle_text(turn)

               turn = wrap_angle(link%position(3))
               if (abs(turn) > same_direction .and. set%cards(k)%form /= form_cylinder .and. .not. link%along(3)) &
                  call add_remark(set%errors, remark_alpha, set%cards(k)%card, card_fields(real_1)%first, '', &
                  angle_text(pair%alpha)//', '//angle_text(pair%alpha + turn))
            end if
            if (abs(closure_error) > drawn_digits*length) text = drawn_text(closure_error)//' '//trim(m%length_unit)
         end associate
         if (m%pairs(i)%is_cylinder) then
            if (is_out_of_stroke(m%pairs(i)%stroke, norm2(drawn_way(m, m%pairs(i))))) call add_card_remark(set, &
               remark_stroke, k, label_c, drawn_text(norm2(drawn_way(m, m%pairs(i))))//' '//trim(m%length_unit))
         end if
         if (text /= '') call add_card_remark(set, remark_open, k, merge(label_a, label_c, &
            set%cards(k)%form == form_joint), text)
      end do

   contains

      !> Gives an angle as text in the deck's unit of angles, with this unit.
      function angle_text(value) result(text)
         real(wp), intent(in) :: value       !< rad
         character(:), allocatable :: text

         if (set%mechanism%degrees) text = drawn_text(in_degrees(value))//' DEG'
         if (.not. set%mechanism%degrees) text = drawn_text(value)//' RAD'
      end function angle_text
   end subroutine check_drawing

   !> Gives a number as text with `drawn_text_digits` digits. Zeros at its end are left out, but for one after the
   !> point. A very small or large number has an exponent and two digits fewer, so that its text is not longer.
   pure function drawn_text(value) result(text)
      real(wp), intent(in) :: value          !< in the deck's unit
      character(:), allocatable :: text
      !> Smaller numbers, except 0, have an exponent: in fixed point they would have too many decimals.
      real(wp), parameter :: least_plain = 1.0e-3_wp
      !> Numbers from this on have an exponent: in fixed point no digit would be left for a decimal.
      real(wp), parameter :: most_plain = 1.0e8_wp
      !> Numbers below this have a digit less, so that they have at most ten decimals.
      real(wp), parameter :: ten_decimals = 1.0e-2_wp

      if (abs(value) > 0.0_wp .and. (abs(value) < least_plain .or. abs(value) >= most_plain)) then
         text = rounded(value, drawn_text_digits - 2, least_plain, most_plain)
      else
         text = rounded(value, drawn_text_digits - merge(1, 0, abs(value) < ten_decimals), least_plain, most_plain)
         text = text(:verify(text, '0', back=.true.))
         if (text(len(text):) == '.') text = text//'0'
      end if
   end function drawn_text
end module deck_remarks
