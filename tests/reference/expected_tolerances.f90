!> Tests. What tolerances do to the rows of the decks tolerances (1), guide_tolerances (2) and landing_gear (3), from
!> their closed forms in real128 as functions of the numbers that have tolerances: sensitivities are central differences
!> of these. Numbers, tolerances and units are those of the deck, written out again by hand.
module expected_tolerances
   use mechanism, only: mechanism_t, instant_count, instant, request_link, request_point, pair_prismatic, drive_slide
   use quad_jet, only: qp, jet_t, degree_q, constant_jet, time_jet, operator(+), operator(-), operator(*), sqrt, sin, &
      cos, atan2
   use closed_forms_dyads, only: place_t, body_t, flat, origin, base, fixed_place, body, place_on, polar, direction, &
      third_corner, corner, drawn_link
   use expected_scales, only: listed_t
   use expected_numbers, only: number_by_hand, field_length
   use expected_rows, only: pair_slots
   use text_output, only: output_t, put
   implicit none
   private
   public :: tolerant_links, spread_lines, put_shares_by_hand

   type :: number_t
      character(24) :: name, tolerance, unit
      real(qp) :: value, half_width              !< in the unit of its card
   end type number_t

   !> The numbers with tolerances of either deck, in the order of their cards.
   type(number_t), parameter :: numbers_1(11) = [ &
      number_t('GROUND BASE X', '0.005', 'M', 0.0_qp, 0.005_qp), number_t('GROUND BASE PHI', '0.1', 'DEG', 0.0_qp, &
      0.1_qp), &
      number_t('POINT B0 XI', '0.01', 'M', 4.0_qp, 0.01_qp), number_t('POINT B0 ETA', '0.01', 'M', 0.0_qp, 0.01_qp), &
      number_t('POINT A-CR XI', '0.005', 'M', 1.0_qp, 0.005_qp), number_t('POINT B-CO XI', '0.01', 'M', 3.5_qp, &
      0.01_qp), &
      number_t('POINT C XI', '0.02', 'M', 1.75_qp, 0.02_qp), number_t('POINT C ETA', '0.02', 'M', 1.25_qp, 0.02_qp), &
      number_t('POINT B-RO XI', '0.01', 'M', 3.0_qp, 0.01_qp), &
      number_t('ANGLE CRANK VALUE', '0.2', 'DEG', 0.0_qp, 0.2_qp), &
      number_t('ANGLE CRANK RATE', '0.05', 'DEG/S', 30.0_qp, 0.05_qp)]
   type(number_t), parameter :: numbers_2(6) = [ &
      number_t('POINT A-CR XI', '0.005', 'MM', 30.0_qp, 0.005_qp), &
      number_t('POINT B-ROD XI', '0.01', 'MM', 90.0_qp, 0.01_qp), &
      number_t('PRISM GUIDE ALPHA', '0.0002', 'RAD', 0.0_qp, 0.0002_qp), &
      number_t('PRISM GUIDE H', '0.005', 'MM', 6.0_qp, 0.005_qp), &
      number_t('PRISM GUIDE BETA', '0.0001', 'RAD', 0.0_qp, 0.0001_qp), &
      number_t('ANGLE CRANK RATE', '0.001', 'RAD/S', 6.0_qp, 0.001_qp)]
   !> The holes are those of one link of the pin, in the order of their cards.
   type(number_t), parameter :: numbers_3(6) = [ &
      number_t('C IN BASE X', '0.5', 'MM', 0.0_qp, 0.5_qp), number_t('C IN BASE Y', '0.5', 'MM', 0.0_qp, 0.5_qp), &
      number_t('E IN LEG X', '0.5', 'MM', 0.0_qp, 0.5_qp), number_t('E IN LEG Y', '0.5', 'MM', 0.0_qp, 0.5_qp), &
      number_t('LENGTH A K', '0.2', 'MM', 740.0_qp, 0.2_qp), number_t('LENGTH D K', '0.2', 'MM', 700.0_qp, 0.2_qp)]
   !> The largest tolerance of deck 1 is about 1/200 of the whole, that of deck 2 1/5000: for four digits of what it
   !> does, one more decimal; that of deck 3 1/3000.
   integer, parameter :: more_decimals(3) = [0, 1, 1]
   !> The error of the differences is the square of this.
   real(qp), parameter :: h = 1.0e-12_qp
   !> Numbers that differ by less are alike: symmetric positions, equal shares.
   real(qp), parameter :: alike = 1.0e-9_qp, least_share = 1.0e-4_qp
   character(8), parameter :: worst_words(2) = ['WORST   ', 'NAJGOR. ']
   character(60), parameter :: share_words(2) = [character(60) :: &
      'TOLERANCES: CONTRIBUTIONS AT THE INSTANT OF LARGEST RSS', 'TOLERANCJE: UDZIALY LICZB PRZY NAJWIEKSZYM RSS']
   character(28), parameter :: small_words(2) = [character(28) :: 'CONTRIBUTIONS BELOW 0.01 %:', &
      'UDZIALY PONIZEJ 0.01 %:']
   character(6), parameter :: kind_words(3, 2) = reshape([character(6) :: 'LINK', 'POINT', 'PAIR', &
      'OGNIWO', 'PUNKT', 'PARA'], [3, 2])
   character(8), parameter :: column_words(3, 0:2, 2) = reshape([character(8) :: 'X', 'Y', 'PHI', 'VX', 'VY', 'VPHI', &
      'AX', 'AY', 'APHI', 'X', 'Y', 'FI', 'VX', 'VY', 'VFI', 'AX', 'AY', 'AFI'], [3, 3, 2])
   !> Of decks 1 and 3 pairs have angles, of deck 2 a slide.
   character(14), parameter :: pair_words(0:2, 3) = reshape([character(14) :: 'ANGLE', 'VELOCITY', 'ACCELERATION', &
      'PRZESUW', 'PREDKOSC', 'PRZYSPIESZENIE', 'ANGLE', 'VELOCITY', 'ACCELERATION'], [3, 3])

contains

   !> The deck of `m`: 2 if it has a guide, 3 if the guide is driven.
   pure integer function case_of(m)
      class(mechanism_t), intent(in) :: m

      case_of = merge(2, 1, any(m%pairs%kind == pair_prismatic))
      if (any(m%drives%kind == drive_slide)) case_of = 3
   end function case_of

   !> The numbers with tolerances of deck `set`.
   pure function numbers_of_set(set) result(list)
      integer, intent(in) :: set
      type(number_t), allocatable :: list(:)

      list = numbers_1
      if (set == 2) list = numbers_2
      if (set == 3) list = numbers_3
   end function numbers_of_set

   !> The links of deck `set` at the time `t`, its numbers being what the deck says.
   pure function tolerant_links(set, t) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t
      type(body_t), allocatable :: links(:)
      type(number_t), allocatable :: list(:)

      list = numbers_of_set(set)
      links = links_with(set, t, list%value)
   end function tolerant_links

   !> The same with the numbers `p`.
   pure function links_with(set, t, p) result(links)
      integer, intent(in) :: set
      real(qp), intent(in) :: t, p(:)
      type(body_t), allocatable :: links(:)
      type(place_t) :: a0, b0, a, b
      type(body_t) :: turned_base
      type(jet_t) :: phi, s, along, across

      if (set == 1) then
         a0 = fixed_place(p(1), 0.0_qp)
         turned_base = body('BASE', a0, constant_jet(p(2)*degree_q))
         b0 = place_on(turned_base, p(3), p(4))
         phi = (p(10) + p(11)*time_jet(t))*degree_q
         a = polar(a0, p(5), phi)
         b = corner(a, p(6), b0, p(9), 1.0_qp)
         links = [turned_base, body('CRANK', a0, phi), body('COUPLER', a, direction(a, b)), &
                  body('ROCKER', b0, direction(b0, b))]
      else if (set == 3) then
         links = landing_gear(t, p)
      else
         ! The pin B is on the guide, (0 - B) . n = h, at the distance of the rod from A.
         phi = p(6)*time_jet(t)
         a = polar(origin, p(1), phi)
         along = p(1)*cos(phi - p(3))
         across = p(1)*sin(phi - p(3)) + p(4)
         s = along + sqrt(p(2)**2 - across*across)
         b = place_t(s*cos(p(3)) + p(4)*sin(p(3)), s*sin(p(3)) - p(4)*cos(p(3)))
         links = [base, body('CRANK', origin, phi), body('ROD', a, direction(a, b)), &
                  body('PISTON', b, constant_jet(p(5)))]
      end if
   end function links_with

   !> A leg about (0, 0), which a cylinder from (-450, -250) to the leg's eye (0, -400) lifts to the right, 50 in a unit
   !> of time from the length drawn. A brace of two bars folds between (1000, 0) and the leg's pin (0, -995), its knee
   !> below. `p`: how far the hole of the ground for the cylinder is off, the hole of the leg for it, the lengths of the
   !> bars. The axes of all links are those of the drawing; LENGTH moves the knee (580, -560) of either bar along the
   !> drawn bar.
   pure function landing_gear(t, p) result(links)
      real(qp), intent(in) :: t, p(6)
      type(body_t) :: links(6), leg
      real(qp), parameter :: c0(2) = [-450.0_qp, -250.0_qp], e0(2) = [0.0_qp, -400.0_qp], a0(2) = [1000.0_qp, 0.0_qp], &
         d0(2) = [0.0_qp, -995.0_qp], k0(2) = [580.0_qp, -560.0_qp], drawn(2) = 0.0_qp
      type(place_t) :: a, c, d, e, knee
      type(jet_t) :: ram

      a = fixed_place(a0(1), a0(2))
      c = fixed_place(c0(1) + p(1), c0(2) + p(2))
      ram = norm2(e0 - c0) + 50.0_qp*time_jet(t)
      e = third_corner(origin, c, constant_jet(sum((e0 + p(3:4))**2)), ram*ram, 1.0_qp)
      leg = drawn_link('LEG', origin, e, drawn, e0 + p(3:4), drawn)
      d = place_on(leg, d0(1), d0(2))
      knee = corner(d, p(6), a, p(5), -1.0_qp)
      links = [base, leg, drawn_link('BARREL', c, e, c0, e0, drawn), drawn_link('ROD', e, c, e0, c0, drawn), &
         drawn_link('UPPER', a, knee, a0, k0, drawn), drawn_link('LOWER', d, knee, d0, k0, drawn)]
   end function landing_gear

   !> The numbers (3, 0:2) of the row of request number `i` of `m` at the time `t`, with the numbers `p`: of deck 1 the
   !> rocker, the point C, the angle of pair B; of deck 2 the piston, and the slide along its guide; of deck 3 the wheel
   !> and the angle of the knee.
   function row_with(m, i, t, p) result(value)
      class(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      real(qp), intent(in) :: t, p(:)
      real(qp) :: value(3, 0:2)
      type(body_t), allocatable :: b(:)
      type(place_t) :: c
      type(jet_t) :: x(3)

      b = links_with(case_of(m), t, p)
      x = constant_jet(0.0_qp)
      if (m%requests(i)%kind == request_link) then
         x = [b(4)%x, b(4)%y, b(4)%phi]
      else if (case_of(m) == 3) then
         c = place_on(b(2), 0.0_qp, -1500.0_qp)
         x(:2) = [c%x, c%y]
         if (m%requests(i)%kind /= request_point) x = [b(6)%phi - b(5)%phi, x(2:)]
      else if (m%requests(i)%kind == request_point) then
         c = place_on(b(3), p(7), p(8))
         x(:2) = [c%x, c%y]
      else if (case_of(m) == 1) then
         x(1) = b(4)%phi - b(3)%phi
      else
         x(1) = b(4)%x*cos(p(3)) + b(4)%y*sin(p(3))
      end if
      value(:, 0) = x%v
      value(:, 1) = x%d
      value(:, 2) = x%dd
   end function row_with

   !> (3, 0:2, numbers) By how much the row of request number `i` changes at the time `t` for each number with a
   !> tolerance, over the change of that.
   function sensitivities_by_hand(m, i, t) result(s)
      class(mechanism_t), intent(in) :: m
      integer, intent(in) :: i
      real(qp), intent(in) :: t
      real(qp), allocatable :: s(:, :, :)
      type(number_t), allocatable :: list(:)
      real(qp), allocatable :: p(:)
      integer :: d

      list = numbers_of_set(case_of(m))
      allocate (s(3, 0:2, size(list)))
      do d = 1, size(list)
         p = list%value
         p(d) = list(d)%value + h
         s(:, :, d) = row_with(m, i, t, p)
         p(d) = list(d)%value - h
         s(:, :, d) = (s(:, :, d) - row_with(m, i, t, p))/(2.0_qp*h)
      end do
   end function sensitivities_by_hand

   !> The lines (2) below the row of request number `i` at the time `t`: worst case, root of the sum of squares.
   function spread_lines(m, i, t) result(lines)
      type(listed_t), intent(in) :: m
      integer, intent(in) :: i
      real(qp), intent(in) :: t
      character(120) :: lines(2)
      real(qp) :: value(3, 0:2, 2)
      integer :: c, k, what, n, slot

      call find_spreads(m, sensitivities_by_hand(m, i, t), value)
      lines(1) = '  '//worst_words(m%language)
      lines(2) = '  RSS'
      do n = 1, 2
         do k = 0, 2
            do c = 1, columns_of(m, i)
               what = merge(2, 1, column_of(m, i, c) == 3)
               slot = 3*k + c
               ! Each deck asks for pairs of one kind.
               if (columns_of(m, i) == 1) slot = pair_slots(k, 1)
               lines(n)(10 + field_length*(slot - 1):9 + field_length*slot) = &
                  number_by_hand(value(c, k, n)/in_unit(m, what), 0.0_qp, m%scales%decimals(what, k) &
                  + more_decimals(case_of(m)), m%scales%power(what, k))
            end do
         end do
      end do
   end function spread_lines

   !> Worst cases and roots of the sums of squares, `value` (3, 0:2, 2), from the sensitivities `s`.
   subroutine find_spreads(m, s, value)
      class(mechanism_t), intent(in) :: m
      real(qp), intent(in) :: s(:, 0:, :)
      real(qp), intent(out) :: value(3, 0:2, 2)
      type(number_t), allocatable :: list(:)
      integer :: d

      list = numbers_of_set(case_of(m))
      value = 0.0_qp
      do d = 1, size(list)
         value(:, :, 1) = value(:, :, 1) + abs(s(:, :, d)*list(d)%half_width)
         value(:, :, 2) = value(:, :, 2) + (s(:, :, d)*list(d)%half_width)**2
      end do
      value(:, :, 2) = sqrt(value(:, :, 2))
   end subroutine find_spreads

   !> The number of columns of request number `i`.
   integer function columns_of(m, i)
      class(mechanism_t), intent(in) :: m
      integer, intent(in) :: i

      columns_of = merge(3, merge(2, 1, m%requests(i)%kind == request_point), m%requests(i)%kind == request_link)
   end function columns_of

   !> The column, 1 to 3, under which its number `c` stands: an angle of a pair under the third.
   integer function column_of(m, i, c)
      class(mechanism_t), intent(in) :: m
      integer, intent(in) :: i, c

      column_of = c
      if (columns_of(m, i) == 1 .and. case_of(m) /= 2) column_of = 3
   end function column_of

   !> The unit of lengths (1) or angles (2) in those of the forms.
   real(qp) function in_unit(m, what)
      class(mechanism_t), intent(in) :: m
      integer, intent(in) :: what

      in_unit = 1.0_qp
      if (what == 2 .and. m%degrees) in_unit = degree_q
   end function in_unit

   !> The shares behind the last instant of `m`.
   subroutine put_shares_by_hand(o, m)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      integer :: i, c, k

      call put(o, '')
      call put(o, ' '//trim(share_words(m%language)))
      do i = 1, size(m%requests)
         do k = 0, 2
            do c = 1, columns_of(m, i)
               call put_quantity(o, m, i, c, k)
            end do
         end do
      end do
   end subroutine put_shares_by_hand

   !> Those of number `c`, derivative `k`, of request number `i`, unless its root is zero in the tables.
   subroutine put_quantity(o, m, i, c, k)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      integer, intent(in) :: i, c, k
      real(qp), allocatable :: s(:, :, :), best(:)
      real(qp) :: value(3, 0:2, 2), root, worst, t
      integer :: n, what, decimals
      character(:), allocatable :: line
      character(20) :: unit

      root = -1.0_qp
      do n = 0, instant_count(m%mechanism_t) - 1
         s = sensitivities_by_hand(m, i, real(instant(m%mechanism_t, n), qp))
         call find_spreads(m, s, value)
         if (value(c, k, 2) <= root*(1.0_qp + alike)) cycle
         root = value(c, k, 2)
         worst = value(c, k, 1)
         t = instant(m%mechanism_t, n)
         ! The function's value has brought its own lower bounds.
         best = s(c, k + 1, :)
      end do
      what = merge(2, 1, column_of(m, i, c) == 3)
      decimals = m%scales%decimals(what, k) + more_decimals(case_of(m))
      if (root/in_unit(m, what)*10.0_qp**(decimals - m%scales%power(what, k)) < 0.5_qp) return
      line = ' '//trim(kind_words(m%requests(i)%kind, m%language))//' '//trim(subject())//'  '
      if (columns_of(m, i) == 1) line = line//trim(pair_words(k, case_of(m)))
      if (columns_of(m, i) > 1) line = line//trim(column_words(c, k, m%language))
      unit = merge(m%length_unit, merge('DEG', 'RAD', m%degrees)//'     ', what == 1)
      if (k > 0) unit = trim(unit)//'/'//m%time_unit
      if (k == 2) unit = trim(unit)//'**2'
      call put(o, line//'   T = '//number(t, m%scales%time_decimals, 0)//' '//trim(m%time_unit)//'   RSS = ' &
         //number(root/in_unit(m, what), decimals, m%scales%power(what, &
         k))//'   '//trim(worst_words(m%language))//' = ' &
         //number(worst/in_unit(m, what), decimals, m%scales%power(what, k))//' '//trim(unit))
      call put_numbers(o, m, best, root, in_unit(m, what))

   contains

      !> Its name.
      function subject() result(name)
         character(8) :: name

         select case (m%requests(i)%kind)
         case (request_link)
            name = m%links(m%requests(i)%subject)%name
         case (request_point)
            name = m%points(m%requests(i)%subject)%name
         case default
            name = m%pairs(m%requests(i)%subject)%name
         end select
      end function subject

      !> A number without blanks.
      function number(x, places, power) result(text)
         real(qp), intent(in) :: x
         integer, intent(in) :: places, power
         character(:), allocatable :: text

         text = trim(adjustl(number_by_hand(x, 0.0_qp, places, power)))
      end function number
   end subroutine put_quantity

   !> A line for each number with a share of note, from the sensitivities `s` of a quantity with this `root`, in units
   !> of `unit`.
   subroutine put_numbers(o, m, s, root, unit)
      type(output_t), intent(inout) :: o
      type(listed_t), intent(in) :: m
      real(qp), intent(in) :: s(:), root, unit
      type(number_t), allocatable :: list(:)
      real(qp) :: share(size(s))
      character(12) :: text
      character(36) :: name
      integer :: n, d

      list = numbers_of_set(case_of(m))
      share = (s*list%half_width/root)**2
      do n = 1, size(s)
         d = findloc(share >= maxval(share)*(1.0_qp - alike), .true., dim=1)
         if (share(d) < least_share) exit
         write (text, '(es12.4e3)') s(d)/unit
         name = list(d)%name
         call put(o, number_by_hand(100.0_qp*share(d)*(1.0_qp + alike), 0.0_qp, 2, 0)//' %  '//name//'  S = '//text &
            //'   +- '//trim(list(d)%tolerance)//' '//trim(list(d)%unit))
         share(d) = -1.0_qp
      end do
      write (text, '(i0)') size(s) - n + 1
      if (n <= size(s)) call put(o, '   '//trim(small_words(m%language))//' '//trim(text))
   end subroutine put_numbers
end module expected_tolerances
